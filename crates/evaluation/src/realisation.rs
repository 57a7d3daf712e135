//! One surface of an ensemble under all its loads, as a stored job.

use crate::sample::Sample;
use analysis::KnownPart;
use analytic::flat_punch::SQUARE_STIFFNESS;
use bem3d::Bem3d;
use contact_model::{
    ContactModel, Outputs, PAPER_STIFFNESS_FACTOR, Scene, SelfAffine, Stop, Surface, line_length,
};
use mdr1d::{Ensemble, Mdr1d};
use runs::{Error, Job, Progress, Result, ResultKind, Silent, StatesInHand};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Number of the format of stored results. Raise it when the numbers of `surface-gen` or `mdr1d`, or the
/// fields of a [`Sample`], change; `bem3d` has its own number, which enters the key too.
pub const FORMAT: u32 = 3;

/// The models of ensembles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Model {
    /// Boundary elements on surfaces.
    #[serde(rename = "3D")]
    Bem3d,
    /// The one-dimensional reduction on lines.
    #[serde(rename = "1D")]
    Mdr1d,
}

impl Model {
    /// Surfaces first, as in the figures.
    pub const BOTH: [Self; 2] = [Self::Bem3d, Self::Mdr1d];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bem3d => "bem3d",
            Self::Mdr1d => "mdr1d",
        }
    }
}

/// The discretisation of a surface, and its model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Discretisation {
    /// Boundary elements.
    Bem3d {
        /// Cells a side.
        cells: usize,
        /// Tolerance.
        tolerance: f64,
    },
    /// The one-dimensional reduction.
    Mdr1d {
        /// Elements of the line.
        elements: usize,
    },
}

impl Discretisation {
    /// The model that it belongs to.
    pub fn of(&self) -> Model {
        match self {
            Self::Bem3d { .. } => Model::Bem3d,
            Self::Mdr1d { .. } => Model::Mdr1d,
        }
    }

    /// Name of the model.
    pub fn name(&self) -> &'static str {
        self.of().name()
    }

    /// The same with `size` cells along a side, or elements.
    #[must_use]
    pub fn with_size(self, size: usize) -> Self {
        match self {
            Self::Bem3d { tolerance, .. } => Self::Bem3d { cells: size, tolerance },
            Self::Mdr1d { .. } => Self::Mdr1d { elements: size },
        }
    }

    /// Cells a side, or elements.
    pub fn size(&self) -> usize {
        match *self {
            Self::Bem3d { cells, .. } => cells,
            Self::Mdr1d { elements } => elements,
        }
    }

    /// Lowest memory need of one surface in bytes: per cell that of light loads, per element that of
    /// generating a line.
    pub fn memory(&self) -> f64 {
        match *self {
            Self::Bem3d { cells, .. } => bem3d::BYTES_PER_CELL * (cells as f64).powi(2),
            Self::Mdr1d { elements } => mdr1d::BYTES_PER_ELEMENT * elements as f64,
        }
    }

    /// The same model on cells (elements) twice and four times as large; `None` where those are too coarse.
    pub fn coarser(self) -> Option<[Self; 2]> {
        let by = |factor: usize| {
            let (size, coarsest) = match self {
                Self::Bem3d { cells, .. } => (cells.div_ceil(factor), COARSEST.0),
                Self::Mdr1d { elements } => (elements / factor, COARSEST.1),
            };
            (size >= coarsest).then_some(self.with_size(size))
        };
        Some([by(2)?, by(4)?])
    }

    /// k_bar of complete contact on this grid (data/paper/VALUES.md for N x N cells; no grid changes that of
    /// a line).
    pub fn complete_contact(self) -> f64 {
        let edge = match self {
            Self::Bem3d { cells, .. } => {
                let n = cells as f64;
                -0.4025 / n + 0.12 / n.powf(1.59)
            }
            Self::Mdr1d { .. } => 0.0,
        };
        self.complete_contact_of_fine_grids() + edge / PAPER_STIFFNESS_FACTOR
    }

    /// The same in the limit of fine grids.
    pub fn complete_contact_of_fine_grids(self) -> f64 {
        let stiffness = match self {
            Self::Bem3d { .. } => SQUARE_STIFFNESS,
            Self::Mdr1d { .. } => line_length(1.0),
        };
        stiffness / PAPER_STIFFNESS_FACTOR
    }

    /// The part of the edge of a free square in the relative differences of k between grids, at a mean k_bar;
    /// a line has no edge.
    ///
    /// It is the difference at complete contact, where there is no other error, times `(k/k_complete)^8`: at
    /// half the stiffness it is less than a hundredth of that. The edge makes k too small on a coarse grid,
    /// short waves make it too large. Near complete contact both may cancel in the differences between these
    /// grids, but not in those to finer grids.
    pub fn edge_part(self, stiffness_bar: f64) -> KnownPart {
        let Some([half, quarter]) = self.coarser() else { return KnownPart::default() };
        let [fine, half, quarter] = [self, half, quarter].map(Self::complete_contact);
        let share = (stiffness_bar / fine).min(1.0).powi(EDGE_POWER) / fine;
        KnownPart {
            differences: [share * (half - fine), share * (quarter - half)],
            to_come: share * (fine - self.complete_contact_of_fine_grids()),
        }
    }

    /// The model itself.
    pub fn model(&self) -> Box<dyn ContactModel> {
        match *self {
            Self::Bem3d { cells, tolerance } => Box::new(Bem3d { cells, tolerance, ..Bem3d::default() }),
            Self::Mdr1d { elements } => Box::new(Mdr1d { elements }),
        }
    }
}

/// Power of k over that of complete contact with which the error of a free edge sets in.
const EDGE_POWER: i32 = 8;

/// Coarsest grid and shortest line that are compared with a finer one.
const COARSEST: (usize, usize) = (17, 1 << 9);

/// Models that jobs share: the plan of an ensemble of lines is used for all its lines.
#[derive(Debug, Default)]
pub struct Models {
    /// By D_f and number of elements.
    lines: Mutex<Vec<(f64, usize, Arc<Ensemble>)>>,
}

impl Models {
    /// The model of a job.
    fn of(&self, job: &RealisationJob, surface: &SelfAffine) -> contact_model::Result<Arc<dyn ContactModel>> {
        let Discretisation::Mdr1d { elements } = job.discretisation else {
            return Ok(Arc::from(job.discretisation.model()));
        };
        let d = job.fractal_dimension;
        // A poisoned lock means that another thread panicked while it only pushed.
        let mut lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((.., ensemble)) =
            lines.iter().find(|(of, n, _)| of.total_cmp(&d).is_eq() && *n == elements)
        {
            let ensemble: Arc<dyn ContactModel> = ensemble.clone();
            return Ok(ensemble);
        }
        let ensemble = Arc::new(Ensemble::new(surface, elements)?);
        lines.push((d, elements, Arc::clone(&ensemble)));
        Ok(ensemble)
    }
}

/// One surface and its loads.
#[derive(Debug, Clone)]
pub struct RealisationJob {
    /// Its discretisation.
    pub discretisation: Discretisation,
    /// D_f.
    pub fractal_dimension: f64,
    /// Number of the surface in its ensemble.
    pub index: usize,
    /// Its own seed.
    pub seed: u64,
    /// Loads F_bar, increasing.
    pub forces: Arc<[f64]>,
    /// Data that the jobs of an ensemble share; the results do not depend on it.
    pub models: Arc<Models>,
}

/// The results of a realisation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RealisationResult {
    /// Measured rms height of this surface, by which F_bar is normalised.
    pub rms_height: f64,
    /// Wall-clock seconds of preparing and solving (goes into the manifest and the run-time claim, never into
    /// a figure).
    pub seconds: f64,
    /// One sample per load.
    pub samples: Vec<Sample>,
}

impl Job for RealisationJob {
    type Output = RealisationResult;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("realisation", FORMAT);

    /// Physics, discretisation, seed, loads, formats; not the index, as the seed says which surface it is.
    fn key(&self) -> String {
        let discretisation = match self.discretisation {
            Discretisation::Bem3d { cells, tolerance } => {
                format!(
                    "model bem3d\nmodel_format {}\ncells {cells}\ntolerance {tolerance:?}\n",
                    bem3d::FORMAT
                )
            }
            Discretisation::Mdr1d { elements } => format!("model mdr1d\nelements {elements}\n"),
        };
        let forces: Vec<String> = self.forces.iter().map(|f| format!("{f:?}")).collect();
        format!(
            "format {FORMAT}\n{discretisation}surface self-affine, no roll-off, spectrum to the end of the grid\n\
             side 1.0\nrms_height 1.0\ncontact_modulus 1.0\nfractal_dimension {:?}\nseed {}\nforce_bar {}\n",
            self.fractal_dimension,
            self.seed,
            forces.join(" "),
        )
    }

    fn name(&self) -> String {
        let Self { discretisation, fractal_dimension, index, .. } = self;
        let (model, size) = (discretisation.name(), discretisation.size());
        let kind = match discretisation.of() {
            Model::Bem3d => "cells a side",
            Model::Mdr1d => "elements",
        };
        format!("{model}, D_f = {fractal_dimension:?}, surface {index}, {size} {kind}")
    }

    /// On the machine of `data/bench`, within a factor of two of what was measured there.
    fn cost(&self) -> u64 {
        let n = self.discretisation.size() as f64;
        let seconds = match self.discretisation {
            // One load on a 512 x 512 grid takes a few ms where little is in contact and a second where much
            // is (data/bench/single.csv); in a sweep each begins where the one before ended, which leaves a
            // fifth of it at a tolerance of 1e-3.
            Discretisation::Bem3d { tolerance, .. } => {
                let filled = |force: &f64| force.powf(0.9) / (force.powf(0.9) + 0.5);
                let loads: f64 = self.forces.iter().map(|force| 0.005 + 1.2 * filled(force)).sum();
                let digits = 1.0 + 0.2 * (-tolerance.log10() - 3.0);
                // Of one load the contact of a rougher surface has fewer cells.
                let rough = 2_f64.powf(1.3 * (2.45 - self.fractal_dimension));
                0.2 * digits * rough * (n / 512.0).powf(2.2) * loads
            }
            // One sort and one transform; the loads cost nothing beside them.
            Discretisation::Mdr1d { .. } => 1e-9 * n * n.log2(),
        };
        // Costs are added up.
        1 + (1e3 * seconds).min(1e15) as u64
    }

    fn memory(&self) -> f64 {
        self.discretisation.memory()
    }

    fn stored_bytes(&self) -> u64 {
        1000 + 500 * self.forces.len() as u64
    }

    fn solve(&self, stop: Stop<'_>) -> Result<RealisationResult> {
        self.resume(None, &|_| Ok(()), &Silent, stop)
    }

    /// From the smallest load upwards with one prepared contact. A solve that does not converge is recorded
    /// with its status. Nothing is stored before the end.
    fn resume(
        &self,
        _: Option<RealisationResult>,
        _: &dyn Fn(&RealisationResult) -> Result<()>,
        progress: &dyn Progress,
        stop: Stop<'_>,
    ) -> Result<RealisationResult> {
        let what = || format!("{} at D_f = {:?}", self.discretisation.name(), self.fractal_dimension);
        let surface = self.surface().map_err(|e| Error::model(what())(e))?;
        let model = self.models.of(self, &surface).map_err(|e| Error::model(what())(e))?;
        let states = [0, self.forces.len()];
        self.solve_with(&*model, &StatesInHand::new((self.name(), self.cost()), states, progress, stop))
    }

    /// The loads are part of the key; the samples must be of those loads.
    fn is_whole(&self, result: &RealisationResult) -> bool {
        let solved = result.samples.iter().map(|sample| sample.force_bar.to_bits());
        solved.eq(self.forces.iter().map(|force| force.to_bits()))
    }
}

impl RealisationJob {
    fn surface(&self) -> contact_model::Result<SelfAffine> {
        SelfAffine::new(self.fractal_dimension, 1.0, 1.0)
    }

    fn solve_with(&self, model: &dyn ContactModel, told: &StatesInHand<'_>) -> Result<RealisationResult> {
        let start = Instant::now();
        let what =
            || format!("{} at D_f = {:?}, surface {}", model.name(), self.fractal_dimension, self.index);
        let surface = self.surface().map_err(|e| Error::model(what())(e))?;
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        // A rough line has no area to claim.
        let area = matches!(self.discretisation, Discretisation::Bem3d { .. });
        scene.outputs = Outputs { stiffness: true, area, ..Outputs::default() };
        let solve = || {
            let mut contact = model.prepare(&scene, self.seed)?;
            let normalisation = contact.normalisation();
            let loads = normalisation.loads(&self.forces)?;
            let mut samples = Vec::with_capacity(loads.len());
            contact.sweep(&loads, told, &mut |i, state| {
                let state = state.or_else(contact_model::Error::into_best)?;
                samples.push(Sample::new(self.forces[i], &state, &normalisation)?);
                told.solved(samples.len());
                Ok(())
            })?;
            Ok((normalisation.rms_height()?, samples))
        };
        let (rms_height, samples) = solve().map_err(|e| Error::model(what())(e))?;
        Ok(RealisationResult { rms_height, seconds: start.elapsed().as_secs_f64(), samples })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use analysis::mean_grid_error;
    use approx::assert_relative_eq;
    use contact_model::{
        Certificate, ContactState, Load, NormalLoad, Normalisation, PreparedContact, Result as ModelResult,
        SolveReport, Source, Status,
    };

    /// k = sqrt(F); gives up above F = 1.
    struct Failing;
    struct FailingContact;

    impl ContactModel for Failing {
        fn name(&self) -> &'static str {
            "tired"
        }
        fn sources(&self) -> &'static [Source] {
            &[]
        }
        fn abilities(&self) -> contact_model::Abilities {
            contact_model::Abilities::ELASTIC
        }
        fn prepare(&self, _: &Scene, _: u64) -> ModelResult<Box<dyn PreparedContact>> {
            Ok(Box::new(FailingContact))
        }
    }

    impl PreparedContact for FailingContact {
        fn normalisation(&self) -> Normalisation {
            Normalisation { contact_modulus: 1.0, length: 1.0, height: Some(2.0) }
        }
        fn solve_until(&mut self, load: Load, _: Stop<'_>) -> ModelResult<ContactState> {
            let NormalLoad::Force(force) = load.normal else { panic!("jobs prescribe forces") };
            let mut report = SolveReport::exact("closed form");
            report.certificate = Certificate { duality_gap: 0.5, ..Default::default() };
            let stiffness = Some(force.sqrt());
            let mut state = ContactState::new(force, report).with_stiffness(stiffness);
            if force > 1.0 {
                state.report.status = Status::IterationLimit;
                return Err(contact_model::Error::NotConverged { best: Box::new(state) });
            }
            Ok(state)
        }
    }

    #[test]
    fn a_solve_that_does_not_converge_is_recorded_with_its_status() {
        let job = RealisationJob {
            discretisation: Discretisation::Mdr1d { elements: 8 },
            fractal_dimension: 2.0,
            index: 0,
            seed: 1,
            forces: [0.1, 1.0].into(),
            models: Arc::default(),
        };
        let told = StatesInHand::new((job.name(), job.cost()), [0, 2], &Silent, &contact_model::never);
        let result = job.solve_with(&Failing, &told).unwrap();
        approx::assert_relative_eq!(result.samples[0].force, 0.2);
        assert!(result.samples[0].converged() && !result.samples[1].converged());
        assert_eq!(result.samples[1].status, "iteration_limit");
        assert_eq!(result.samples[1].approach_over_h, None);
    }

    #[test]
    fn every_parameter_is_in_the_key() {
        let job = RealisationJob {
            discretisation: Discretisation::Bem3d { cells: 8, tolerance: 1e-4 },
            fractal_dimension: 2.0,
            index: 0,
            seed: 1,
            forces: [0.1, 1.0].into(),
            models: Arc::default(),
        };
        let others = [
            RealisationJob {
                discretisation: Discretisation::Bem3d { cells: 9, tolerance: 1e-4 },
                ..job.clone()
            },
            RealisationJob {
                discretisation: Discretisation::Bem3d { cells: 8, tolerance: 1e-5 },
                ..job.clone()
            },
            RealisationJob { discretisation: Discretisation::Mdr1d { elements: 8 }, ..job.clone() },
            RealisationJob { fractal_dimension: 2.2, ..job.clone() },
            RealisationJob { seed: 2, ..job.clone() },
            RealisationJob { forces: [0.1].into(), ..job.clone() },
        ];
        for other in &others {
            assert_ne!(job.key(), other.key());
            assert!(other.cost() > 0);
        }
    }

    #[test]
    fn coarser_grids_are_half_and_a_quarter_as_fine() {
        let solid = |cells| Discretisation::Bem3d { cells, tolerance: 1e-3 };
        let line = |elements| Discretisation::Mdr1d { elements };
        assert_eq!(solid(2049).coarser(), Some([solid(1025), solid(513)]));
        assert_eq!(solid(64).coarser(), None);
        assert_eq!(line(1 << 20).coarser(), Some([line(1 << 19), line(1 << 18)]));
        assert_eq!(line(1024).coarser(), None);
    }

    #[test]
    fn an_edge_error_that_cancels_in_the_differences_is_found() {
        let grid = Discretisation::Bem3d { cells: 129, tolerance: 1e-3 };
        let edge = grid.edge_part(grid.complete_contact());
        // k of complete contact goes up by 0.4/N/1.15 to the limit, the two differences by as much and by
        // twice as much.
        let expected = 0.4025 / 129.0 / 1.1523;
        assert_relative_eq!(edge.to_come, -expected, max_relative = 0.02);
        assert_relative_eq!(edge.differences[0], -expected, max_relative = 0.1);
        assert_relative_eq!(edge.differences[1], -2.0 * expected, max_relative = 0.1);
        // Waves that cancel it: no difference is seen, but each part is there.
        let unseen = mean_grid_error(&[[0.0; 2]; 12], edge, 1).unwrap();
        assert!(unseen > 1.5 * expected, "{unseen}");
        // It falls with the eighth power of k, and a line has no edge.
        let half = grid.edge_part(0.5 * grid.complete_contact());
        assert_relative_eq!(half.to_come, edge.to_come / 256.0, max_relative = 1e-12);
        assert_eq!(Discretisation::Mdr1d { elements: 4096 }.edge_part(0.9), KnownPart::default());
    }
}
