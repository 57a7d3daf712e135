//! One surface on one grid: the share of the contact that sticks and the stiffness, as they depend on the size
//! of the cells.

use super::job::{DIRECTIONS, PressedSurface, converged};
use super::study::{COEFFICIENT, PartialSlipStudy, SHARES, SlipCase, mindlin};
use crate::evaluation::Discretisation;
use bem3d::Bem3d;
use contact_model::{
    Boundary, ContactModel as _, ContactState, Effects, Error as ModelError, Load, Outputs, PreparedContact,
    Stop,
};
use runs::{Error, Job, Result, ResultKind};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Number of the format of stored results. Raise it when [`SurfaceOnGrid`] changes, or the meaning of its
/// numbers.
const FORMAT: u32 = 1;

/// One free surface on one grid under all loads, for all Poisson's ratios.
///
/// The shortest wave has the same length on every grid, so a seed draws the same surface on all of them.
#[derive(Debug, Clone)]
pub(super) struct GridJob {
    pub(super) study: Arc<PartialSlipStudy>,
    pub(super) fractal_dimension: f64,
    pub(super) seed: u64,
    /// Cells a side.
    pub(super) cells: usize,
}

/// A first loading with one Poisson's ratio, at the [`SHARES`] of the sliding force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct FirstLoading {
    /// Share of the contact that sticks, by the number of cells.
    pub(super) stick: Vec<f64>,
    /// The same by areas corrected for the cells at their boundary; empty where friction is solved.
    pub(super) stick_corrected: Vec<f64>,
    /// dQ/ddelta over that without tangential force; empty where friction is solved.
    pub(super) stiffness: Vec<f64>,
}

/// One load on one grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LoadOnGrid {
    /// Share of the square in contact, by the number of cells.
    pub(super) contact: f64,
    pub(super) contact_cells: usize,
    /// In the order of Poisson's ratios; on the finest grid that of the first one, 0, alone.
    pub(super) loadings: Vec<FirstLoading>,
}

/// The results of a surface on a grid, by load; `None` where the tolerance was not met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SurfaceOnGrid {
    pub(super) loads: Vec<Option<LoadOnGrid>>,
}

/// Numbers of a state of the normal contact.
#[derive(Clone, Copy)]
struct NormalState {
    area: f64,
    corrected: f64,
    stiffness: f64,
    cells: usize,
    approach: f64,
}

impl NormalState {
    fn of(state: &ContactState) -> Option<Self> {
        Some(Self {
            area: state.area?,
            corrected: state.resolution?.corrected_area?,
            stiffness: state.stiffness?,
            cells: state.report.contact_cells?,
            approach: state.approach?,
        })
    }
}

impl GridJob {
    fn case(&self) -> SlipCase {
        SlipCase { boundary: Boundary::Free, fractal_dimension: self.fractal_dimension }
    }

    fn discretisation(&self) -> Discretisation {
        Discretisation::Bem3d { cells: self.cells, tolerance: self.study.tolerance }
    }

    fn prepare(&self, tolerance: f64, poisson: f64, outputs: Outputs) -> Result<Box<dyn PreparedContact>> {
        let mut scene = self.case().scene(&self.study, poisson, outputs)?;
        if poisson.abs() <= 0.0 {
            scene.effects = Effects { boundary: scene.effects.boundary, ..Effects::default() };
        }
        let model = Bem3d { cells: self.cells, tolerance, ..Bem3d::default() };
        model.prepare(&scene, self.seed).map_err(Error::model(self.name()))
    }

    /// Bodies without Poisson's ratio: cells that touch under the force F - Q/mu stick (Ciavarella 1998,
    /// Jaeger 1995), and k_t(Q)/k_t(0) is k(F - Q/mu)/k(F).
    fn without_poissons_ratio(
        normal: &mut dyn PreparedContact,
        force: f64,
        stop: Stop<'_>,
    ) -> Result<(NormalState, FirstLoading), ModelError> {
        let mut at = |share: f64| {
            let state = normal.solve_until(Load::force(force * (1.0 - share)), stop)?;
            NormalState::of(&state)
                .ok_or_else(|| ModelError::unsupported("bem3d", "a contact without an area"))
        };
        let whole = at(0.0)?;
        let mut loading =
            FirstLoading { stick: Vec::new(), stick_corrected: Vec::new(), stiffness: Vec::new() };
        for share in SHARES {
            let rest = at(share)?;
            loading.stick.push(rest.area / whole.area);
            loading.stick_corrected.push(rest.corrected / whole.corrected);
            loading.stiffness.push(rest.stiffness / whole.stiffness);
        }
        Ok((whole, loading))
    }

    /// Friction cell by cell: means of a force along x and one along y.
    fn with_friction(
        sliding: &mut dyn PreparedContact,
        load: PressedSurface,
        area: f64,
        stop: Stop<'_>,
    ) -> Result<FirstLoading, ModelError> {
        let mut sticks = [Vec::new(), Vec::new()];
        for (sticks, direction) in sticks.iter_mut().zip(DIRECTIONS) {
            sliding.restart();
            sliding.advance_until(load.step(0.0, direction), stop)?;
            for share in SHARES {
                let state = sliding.advance_until(load.step(share, direction), stop)?;
                sticks.push(state.tangential.and_then(|t| t.stick_area).unwrap_or(0.0) / area);
            }
        }
        let [x, y] = sticks;
        let stick = x.iter().zip(&y).map(|(a, b)| 0.5 * (a + b)).collect();
        Ok(FirstLoading { stick, stick_corrected: Vec::new(), stiffness: Vec::new() })
    }

    /// The Poisson's ratios of friction: none on the finest grid, where it costs too much.
    fn of_friction(&self) -> &[f64] {
        let finest = self.study.grids.last() == Some(&self.cells);
        self.study.poissons.get(1..).filter(|_| !finest).unwrap_or_default()
    }
}

impl Job for GridJob {
    type Output = SurfaceOnGrid;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("partial slip on a grid", FORMAT);

    fn key(&self) -> String {
        let Self { study, fractal_dimension, seed, cells } = self;
        format!(
            "model bem3d\nmodel_format {}\ncells {cells}\nshortest_waves {}\ntolerance {:?}\n\
             fractal_dimension {fractal_dimension:?}\nseed {seed}\nforce_bar {}\npoisson 0 {}\n",
            bem3d::FORMAT,
            study.shortest(),
            study.tolerance,
            crate::evaluation::list(study.forces.values()),
            crate::evaluation::list(self.of_friction()),
        )
    }

    fn name(&self) -> String {
        format!("{}, {} cells a side, seed {}", self.case().label(), self.cells, self.seed)
    }

    // With 128 cells a side a normal contact takes about 3 ms and an increment of friction about 15 ms.
    fn cost(&self) -> u64 {
        let cells = (self.cells as f64 / 128.0).powi(2);
        let of_friction = 2 * self.of_friction().len();
        let milliseconds = (3 + 15 * of_friction) * SHARES.len() * self.study.forces.values().len();
        (milliseconds as f64 * cells).max(1.0) as u64
    }

    fn memory(&self) -> f64 {
        5.0 * (1 + self.of_friction().len()) as f64 * self.discretisation().memory()
    }

    fn stored_bytes(&self) -> u64 {
        1000 + 1000 * (self.study.forces.values().len() * self.study.poissons.len()) as u64
    }

    fn solve(&self, stop: Stop<'_>) -> Result<SurfaceOnGrid> {
        let study = &self.study;
        let none_of_them = Outputs { stiffness: false, ..Outputs::default() };
        let of_normal = Outputs { stiffness: true, area: true, ..none_of_them };
        let of_sliding = Outputs { stick_area: true, ..none_of_them };
        let mut normal = self.prepare(study.tolerance, 0.0, of_normal)?;
        let sliding =
            self.of_friction().iter().map(|nu| Ok((*nu, self.prepare(study.tolerance, *nu, of_sliding)?)));
        let mut frictional = sliding.collect::<Result<Vec<_>>>()?;
        let normalisation = normal.normalisation();
        let mut on_load = |force_bar: f64| {
            let force = normalisation.force(force_bar)?;
            let (whole, first) = Self::without_poissons_ratio(&mut *normal, force, stop)?;
            let mut loadings = vec![first];
            for (nu, sliding) in &mut frictional {
                let load =
                    PressedSurface { force, displacement: COEFFICIENT * whole.approach / mindlin(*nu) };
                loadings.push(Self::with_friction(&mut **sliding, load, whole.area, stop)?);
            }
            Ok(LoadOnGrid { contact: whole.area, contact_cells: whole.cells, loadings })
        };
        let loads = study.forces.values().iter().map(|force_bar| converged(on_load(*force_bar)));
        let loads = loads.collect::<Result<_, ModelError>>().map_err(Error::model(self.name()))?;
        Ok(SurfaceOnGrid { loads })
    }

    fn is_whole(&self, all: &SurfaceOnGrid) -> bool {
        all.loads.len() == self.study.forces.values().len()
    }
}
