//! The operators and the parts of a solve as a benchmark sees them. Not part of the interface: nothing here
//! is kept from version to version.

pub use crate::parts::{Part, Recorder, Spent};
pub use crate::tuning::{CONSTANTS, Constant};

use crate::geometry::{CellSet, Grid, Lengths};
use crate::kernel::KernelTable;
use crate::linear::Factor;
use crate::model::Bem3d;
use crate::operator::{DirectSum, FftConvolution, InfluenceOperator, Split, TwoLevel, TwoTransforms};
use crate::tuning::Tuning;
use contact_model::{Boundary, PreparedContact, Result, Scene};

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

/// One application of the named operator (`direct`, `two levels`, `two transforms`, `f32`, `f64`, `inverse`) between every
/// `step`-th cell of a grid.
pub fn timed(name: &str, side: usize, step: usize) -> Option<Box<dyn FnMut() -> f64>> {
    let grid = Grid { columns: side, rows: side, stretch: 1.0 };
    let set = CellSet::from_index(grid, &(0..(side * side) as u32).step_by(step).collect::<Vec<_>>());
    let p: Vec<f64> = (0..set.len()).map(|k| 1.0 + (k as f64).sin()).collect();
    let mut u = vec![0.0; set.len()];
    let window = set.window()?;
    let table = KernelTable::shared(grid, Boundary::Free);
    let (free, torus) = (Lengths::free(window), Lengths::torus(window));
    Some(match name {
        "direct" => Box::new(move || {
            DirectSum(&table).apply(&set, &p, &set, &mut u);
            u[0]
        }),
        "two levels" => {
            let mut operator = TwoLevel::new(window, Split { spacing: 8, reach: 6, order: 6 });
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        "two transforms" => {
            let mut operator = TwoTransforms::new(window, TwoTransforms::split_at(12, 6));
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        "f64" => {
            let mut operator = FftConvolution::<f64>::new(window, free, table.symbol_f64(free));
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        "f32" | "inverse" => {
            let (lengths, symbol) = match name {
                "f32" => (free, table.symbol_f32(free)),
                _ => (torus, table.inverse_symbol(torus)),
            };
            let mut operator = FftConvolution::<f32>::new(window, lengths, symbol);
            Box::new(move || {
                operator.apply(&set, &p, &set, &mut u);
                u[0]
            })
        }
        _ => return None,
    })
}

/// Factors the first `count` cells of a grid; whether it was positive definite.
pub fn factor(side: usize, count: usize) -> bool {
    let grid = Grid { columns: side, rows: side, stretch: 1.0 };
    let set = CellSet::from_index(grid, &(0..count as u32).collect::<Vec<_>>());
    Factor::new(&KernelTable::shared(grid, Boundary::Free), &set).is_some()
}
