//! The operators and the parts of a solve, for benchmarks. This module is not part of the public interface
//! and may change in any version.

pub use crate::parts::{Part, PartTime, Recorder};
pub use crate::tuning::{CONSTANTS, Constant};

use crate::friction::{
    FrictionLimits, FrictionLoad, FrictionSolver, PressedCells, SlipMemory, SlipStep, TangentialControl,
};
use crate::geometry::{CellSet, Grid, Lengths};
use crate::kernel::{NormalTable, TangentialTable};
use crate::linear::Factor;
use crate::model::Bem3d;
use crate::operator::{
    DirectSum, FftConvolution, InfluenceOperator, Split, TwoLevel, TwoTransforms, VectorConvolution,
};
use crate::response::TangentialStiffness;
use crate::response::tangential::{self, StiffnessOf};
use crate::tuning::Tuning;
use contact_model::{Boundary, Field, PreparedContact, Result, Scene, Status, never};

/// A surface prepared with half, twice or another multiple of one constant.
///
/// # Errors
/// As [`contact_model::ContactModel::prepare`].
pub fn prepare_tuned(
    model: &Bem3d,
    scene: &Scene,
    seed: u64,
    constant: Constant,
    factor: f64,
) -> Result<Box<dyn PreparedContact>> {
    model.prepare_with(scene, seed, &Tuning::with_multiple(constant, factor), &Recorder::default())
}

/// A surface prepared with a recorder, to which the time of its preparation and of its solves is charged.
///
/// # Errors
/// As [`contact_model::ContactModel::prepare`].
pub fn prepare_recorded(
    model: &Bem3d,
    scene: &Scene,
    seed: u64,
    recorder: &Recorder,
) -> Result<Box<dyn PreparedContact>> {
    model.prepare_with(scene, seed, &Tuning::DEFAULT, recorder)
}

/// One application of the named operator (`direct`, `two levels`, `two transforms`, `f32`, `f64`, `inverse`, and of
/// tangential tractions `tangential f32`, `tangential f64`, `tangential inverse`) between every `step`-th cell of a grid.
pub fn timed(name: &str, side: usize, step: usize) -> Option<Box<dyn FnMut() -> f64>> {
    let grid = Grid { columns: side, rows: side, stretch: 1.0 };
    let set = CellSet::from_index(grid, &(0..(side * side) as u32).step_by(step).collect::<Vec<_>>());
    let p: Vec<f64> = (0..set.len()).map(|k| 1.0 + (k as f64).sin()).collect();
    let mut u = vec![0.0; set.len()];
    let window = set.window()?;
    let table = NormalTable::shared(grid, Boundary::Free);
    let (free, torus) = (Lengths::free(window), Lengths::torus(window));
    Some(match name {
        "direct" => Box::new(move || {
            DirectSum(&table).apply(&set, &p, &set, &mut u);
            u[0]
        }),
        "two levels" => {
            let mut operator =
                TwoLevel::new(window, Split { spacing: 8, reach: 6, order: 6 }, &never).ok()?;
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        "two transforms" => {
            let mut operator = TwoTransforms::new(window, TwoTransforms::split_at(12, 6), &never).ok()?;
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        "f64" => {
            let mut operator = FftConvolution::<f64>::new(window, free, table.symbol_f64(free, &never).ok()?);
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        "f32" | "inverse" => {
            let (lengths, symbol) = match name {
                "f32" => (free, table.symbol_f32(free, &never).ok()?),
                _ => (torus, table.inverse_symbol(torus, &never).ok()?),
            };
            let mut operator = FftConvolution::<f32>::new(window, lengths, symbol);
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        "tangential f64" => {
            let table = TangentialTable::shared(grid, Boundary::Free, TANGENTIAL);
            let lengths = table.exact_lengths(window);
            let mut operator =
                VectorConvolution::<f64>::new(window, lengths, table.symbol_f64(lengths, &never).ok()?);
            let (q, mut u) = ([&p[..], &p].concat(), [&u[..], &u].concat());
            Box::new(move || {
                operator.apply(&set, &q, &set, &mut u);
                u[0]
            })
        }
        "tangential f32" | "tangential inverse" => {
            let table = TangentialTable::shared(grid, Boundary::Free, TANGENTIAL);
            let (lengths, symbol) = if name == "tangential f32" {
                let lengths = table.exact_lengths(window);
                (lengths, table.symbol_f32(lengths, &never).ok()?)
            } else {
                let lengths = table.torus_lengths(window);
                (lengths, table.inverse_symbol(lengths, &never).ok()?)
            };
            let mut operator = VectorConvolution::<f32>::new(window, lengths, symbol);
            let q: Vec<f32> = p.iter().chain(&p).map(|&p| p as f32).collect();
            let mut u = vec![0.0; q.len()];
            Box::new(move || {
                operator.apply(&set, &q, &set, &mut u);
                f64::from(u[0])
            })
        }
        _ => return None,
    })
}

/// The constant of bodies of Poisson's ratio 0.3.
const TANGENTIAL: f64 = 0.3 / 0.7;

/// Factors the matrix of the first `count` cells of a grid. Returns whether it was positive definite.
pub fn factor(side: usize, count: usize) -> bool {
    let grid = Grid { columns: side, rows: side, stretch: 1.0 };
    let set = CellSet::from_index(grid, &(0..count as u32).collect::<Vec<_>>());
    Factor::new(&NormalTable::shared(grid, Boundary::Free), &set).is_some()
}

/// Work and result of one increment of friction.
#[derive(Debug, Clone, Copy)]
pub struct IncrementResult {
    /// Applications of the tangential kernel.
    pub applications: usize,
    /// Newton's steps and those of conjugate gradients.
    pub iterations: [usize; 2],
    /// Relative duality gap.
    pub duality_gap: f64,
    /// Whether it met the tolerance.
    pub converged: bool,
    /// Shares of the contact that stick, and tangential displacement over that of full stick.
    pub stick: f64,
    /// Applications of the stiffness of the branch, and its value along x with its error.
    pub stiffness: (usize, f64, f64),
}

/// One surface under a field of pressure (square cells, free boundaries), loaded tangentially from zero by a
/// share of its friction: one increment with `compliance = E* sum nu/(2 G)`, and the stiffness where
/// requested.
pub struct PartialSlipBench {
    friction: FrictionSolver,
    cells: CellSet,
    pressure: Vec<f64>,
}

impl std::fmt::Debug for PartialSlipBench {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "PartialSlipBench({} cells)", self.cells.len())
    }
}

impl PartialSlipBench {
    /// A pressure over E*.
    pub fn new(pressure: &Field, compliance: f64, recorder: &Recorder) -> Self {
        let (columns, rows) = (pressure.columns(), pressure.rows());
        let grid = Grid { columns, rows, stretch: 1.0 };
        let cells = CellSet::of_grid(grid, pressure.values(), |p| p > 0.0);
        let friction =
            FrictionSolver::new(grid, Boundary::Free, [compliance, 0.0], &Tuning::DEFAULT, recorder);
        Self { friction, cells, pressure: pressure.values().iter().copied().filter(|p| *p > 0.0).collect() }
    }

    /// The increment, from tractions that are given as a field along x or from none.
    pub fn run(
        &mut self,
        coefficient: f64,
        share: f64,
        tolerance: f64,
        guess: Option<&[f64]>,
        stiffness: bool,
    ) -> Option<IncrementResult> {
        let Self { friction, cells, pressure } = self;
        let [before, _] = friction.work();
        let force = share * coefficient * pressure.iter().sum::<f64>();
        let guess = guess.map(|field| {
            let columns = friction.grid().columns;
            let mut q: Vec<f64> = cells.places().map(|(x, y)| field[y * columns + x]).collect();
            q.resize(2 * cells.len(), 0.0);
            q
        });
        let contact = PressedCells { cells, pressure };
        let limits = FrictionLimits { tolerance, unresolved: tolerance, iterations: 100 };
        let control = TangentialControl::Force([force, 0.0]);
        let load = FrictionLoad { law: contact_model::FrictionLaw::coulomb(coefficient), control };
        let guess = guess.as_ref().map(|q| (&*cells, &q[..]));
        let state = friction
            .advance(
                SlipStep { before: &SlipMemory::default(), contact, load, guess, relaxes: false },
                limits,
                &never,
            )
            .ok()?;
        let [after, _] = friction.work();
        let k =
            stiffness.then(|| tangential::solve(friction, &state, StiffnessOf::Branch, tolerance, &never));
        let k = k.transpose().ok()?;
        let [end, _] = friction.work();
        Some(IncrementResult {
            applications: after - before,
            iterations: state.iterations,
            duality_gap: state.duality_gap,
            converged: state.status == Status::Converged,
            stick: state.stick.len() as f64 / cells.len().max(1) as f64,
            stiffness: (
                end - after,
                k.as_ref().map_or(0.0, |k| k.value[0]),
                k.as_ref().map_or(0.0, TangentialStiffness::error),
            ),
        })
    }
}
