//! One surface of an ensemble under all its loads: the question that it belongs to, and its states as they are
//! read.

use crate::evaluation::sample::Sample;
use analysis::KnownPart;
use analytic::flat_punch::SQUARE_STIFFNESS;
use bem3d::Bem3d;
use contact_model::{
    Load, Outputs, PAPER_STIFFNESS_FACTOR, Scene, SelfAffine, Source, Stop, Surface, line_length,
};
use fractal_contact::scenes::{
    self, AskedLoads, AskedSampling, AskedSelfAffine, AskedSurface, LoadList, Material, ModelResult,
    Numerics, PrescribedLoad, Question, SceneFile, SceneJob, System, jobs_of_scenes,
};
use mdr1d::Mdr1d;
use runs::{Error, Result};
use serde::Deserialize;
use std::path::Path;
use std::sync::Arc;

/// The models of ensembles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum EnsembleModel {
    /// Boundary elements on surfaces.
    #[serde(rename = "3D")]
    Bem3d,
    /// The one-dimensional reduction on lines.
    #[serde(rename = "1D")]
    Mdr1d,
}

impl EnsembleModel {
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
    pub fn of(&self) -> EnsembleModel {
        match self {
            Self::Bem3d { .. } => EnsembleModel::Bem3d,
            Self::Mdr1d { .. } => EnsembleModel::Mdr1d,
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

    /// The model with its options.
    pub fn numerics(&self) -> Numerics {
        match *self {
            Self::Bem3d { cells, tolerance } => {
                Numerics::Bem3d(Bem3d { cells, tolerance, ..Bem3d::default() })
            }
            Self::Mdr1d { elements } => Numerics::Mdr1d(Mdr1d { elements }),
        }
    }

    /// The sources of the model.
    pub fn sources(&self) -> &'static [Source] {
        self.numerics().model().sources()
    }

    /// The requested outputs: the stiffness, and the area where the model claims one. A rough line has none.
    fn outputs(&self) -> Outputs {
        let area = matches!(self, Self::Bem3d { .. });
        Outputs { stiffness: true, area, ..Outputs::default() }
    }
}

/// Power of k over that of complete contact with which the error of a free edge sets in.
const EDGE_POWER: i32 = 8;

/// Coarsest grid and shortest line that are compared with a finer one.
const COARSEST: (usize, usize) = (17, 1 << 9);

/// One surface of an ensemble under all its loads.
#[derive(Debug, Clone)]
pub struct Realisation {
    /// Its discretisation.
    pub discretisation: Discretisation,
    /// D_f.
    pub fractal_dimension: f64,
    /// Master seed of its ensemble.
    pub master_seed: u64,
    /// Number of the surface in its ensemble.
    pub index: usize,
    /// Loads F_bar, increasing.
    pub forces: Arc<[f64]>,
}

/// The results of a realisation.
#[derive(Debug, Clone, PartialEq)]
pub struct RealisationResult {
    /// Measured rms height of this surface, by which F_bar is normalised.
    pub rms_height: f64,
    /// Wall-clock seconds of preparing and solving (goes into the manifest and the run-time claim, never into
    /// a figure).
    pub seconds: f64,
    /// One sample per load.
    pub samples: Vec<Sample>,
}

impl Realisation {
    /// The seed of its surface.
    pub fn seed(&self) -> u64 {
        surface_gen::surface_seed(self.master_seed, self.index as u64)
    }

    /// Whether another one is a surface of the same ensemble.
    fn is_beside(&self, other: &Self) -> bool {
        self.discretisation == other.discretisation
            && self.fractal_dimension.total_cmp(&other.fractal_dimension).is_eq()
            && self.master_seed == other.master_seed
            && self.forces == other.forces
    }

    /// The question of the first `surfaces` surfaces of its ensemble: each of them under all loads, without
    /// units, with E* = L = h = 1.
    pub fn question(&self, surfaces: usize) -> Question {
        let mut question = Question::default();
        question.units = System::None;
        question.models = vec![self.discretisation.numerics()];
        question.material = Some(Material::ContactModulus(1.0));
        let values = self.forces.to_vec();
        question.loads = Some(AskedLoads::Loads(LoadList { kind: PrescribedLoad::ForceBar, values }));
        let mut surface = AskedSelfAffine::default();
        surface.size = Some(1.0.into());
        surface.hurst = Some(3.0 - self.fractal_dimension);
        surface.rms_height = Some(1.0);
        question.surface = Some(AskedSurface::SelfAffine(surface));
        question.outputs.outputs = self.discretisation.outputs();
        let seed = Some(self.master_seed);
        question.sampling = Some(AskedSampling { seed, surfaces: Some(surfaces as u64) });
        question
    }

    /// Name of its scene in messages.
    fn words(&self) -> String {
        let (d, size) = (self.fractal_dimension, self.discretisation.size());
        match self.discretisation.of() {
            EnsembleModel::Bem3d => format!("D_f = {d:?}, {size} cells a side"),
            EnsembleModel::Mdr1d => format!("D_f = {d:?}, {size} elements"),
        }
    }

    /// Its results, from the states of its job.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a load that the model refused.
    pub(crate) fn read(&self, states: &ModelResult) -> Result<RealisationResult> {
        let (mut rms_height, mut samples) = (0.0, Vec::with_capacity(self.forces.len()));
        for (load, &force) in self.forces.iter().enumerate() {
            let (state, normalisation) = states.state(load).map_err(|reason| {
                let expected = format!("loads that {} can solve ({reason})", self.discretisation.name());
                Error::parameter("forces", force, expected)
            })?;
            let what = || self.words();
            rms_height = normalisation.rms_height().map_err(|e| Error::model(what())(e))?;
            let sample = Sample::new(force, state, normalisation);
            samples.push(sample.map_err(|e| Error::model(what())(e))?);
        }
        Ok(RealisationResult { rms_height, seconds: states.seconds(), samples })
    }
}

/// The jobs of these realisations, in their order. Those of one ensemble are jobs of one scene. Their states go
/// to the store of `out`.
///
/// # Errors
/// [`Error::Parameter`] for an ensemble that is no scene.
pub fn realisation_jobs(realisations: &[Realisation], out: &Path) -> Result<Vec<SceneJob>> {
    let mut ensembles: Vec<(&Realisation, usize)> = Vec::new();
    let mut of = Vec::with_capacity(realisations.len());
    for realisation in realisations {
        let known = ensembles.iter().position(|(first, _)| first.is_beside(realisation));
        let place = known.unwrap_or_else(|| {
            ensembles.push((realisation, 0));
            ensembles.len() - 1
        });
        let surfaces = &mut ensembles[place].1;
        *surfaces = (*surfaces).max(realisation.index + 1);
        of.push(place);
    }
    let scene = |&(first, surfaces): &(&Realisation, usize)| {
        SceneFile::of(first.question(surfaces), &out.join(first.words())).map_err(of_scene)
    };
    let scenes = ensembles.iter().map(scene).collect::<Result<Vec<_>>>()?;
    let all = jobs_of_scenes(&scenes, out);
    let begins: Vec<usize> = ensembles
        .iter()
        .scan(0, |begin, (_, surfaces)| {
            *begin += surfaces;
            Some(*begin - surfaces)
        })
        .collect();
    Ok(realisations.iter().zip(of).map(|(r, place)| all[begins[place] + r.index].clone()).collect())
}

/// An error of scenes as one of a command.
pub fn of_scene(error: scenes::Error) -> Error {
    match error {
        scenes::Error::Run(error) => error,
        other => Error::parameter("question", other, "one that its models answer"),
    }
}

/// One load on one surface of this seed, from a cold start; nothing is stored.
///
/// # Errors
/// Errors of the model; [`contact_model::Error::Stopped`].
pub(crate) fn solve_alone(
    discretisation: Discretisation,
    fractal_dimension: f64,
    seed: u64,
    force_bar: f64,
    stop: Stop<'_>,
) -> Result<Sample> {
    let solve = || {
        let surface = SelfAffine::new(fractal_dimension, 1.0, 1.0)?;
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        scene.outputs = discretisation.outputs();
        let mut contact = discretisation.numerics().model().prepare(&scene, seed)?;
        let normalisation = contact.normalisation();
        let load = Load::force(normalisation.force(force_bar)?);
        let state = contact.solve_until(load, stop).or_else(contact_model::Error::into_best)?;
        Sample::new(force_bar, &state, &normalisation)
    };
    let what = || format!("{} at D_f = {fractal_dimension:?}, seed {seed}", discretisation.name());
    solve().map_err(|e| Error::model(what())(e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use analysis::mean_grid_error;
    use approx::assert_relative_eq;
    use contact_model::{
        Certificate, ContactModel, ContactState, NormalLoad, Normalisation, PreparedContact,
        Result as ModelAnswer, SolveReport, Status, never,
    };
    use fractal_contact::scenes::Registry;
    use runs::Job as _;

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
        fn prepare(&self, _: &Scene, _: u64) -> ModelAnswer<Box<dyn PreparedContact>> {
            Ok(Box::new(FailingContact))
        }
    }

    impl PreparedContact for FailingContact {
        fn normalisation(&self) -> Normalisation {
            Normalisation { contact_modulus: 1.0, length: 1.0, height: Some(2.0) }
        }
        fn solve_until(&mut self, load: Load, _: Stop<'_>) -> ModelAnswer<ContactState> {
            let NormalLoad::Force(force) = load.normal else { panic!("realisations prescribe forces") };
            if force > 10.0 {
                return Err(contact_model::Error::domain("force", force, "at most 10"));
            }
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

    fn realisation(discretisation: Discretisation, forces: &[f64]) -> Realisation {
        Realisation {
            discretisation,
            fractal_dimension: 2.0,
            master_seed: 1,
            index: 0,
            forces: forces.into(),
        }
    }

    #[test]
    fn a_solve_that_does_not_converge_is_read_with_its_status_and_a_refused_load_is_an_error() {
        let registry = Registry::new().with(Failing, "1").unwrap();
        let read = |forces: &[f64]| {
            let realisation = realisation(Discretisation::Mdr1d { elements: 8 }, forces);
            let mut question = realisation.question(1);
            question.models = registry.models().iter().cloned().map(Numerics::Registered).collect();
            let scene = SceneFile::of(question, Path::new("failing")).unwrap();
            let states = jobs_of_scenes(&[scene], Path::new("never-made"))[0].solve(&never).unwrap();
            realisation.read(&states)
        };
        let result = read(&[0.1, 1.0]).unwrap();
        assert_relative_eq!(result.samples[0].force, 0.2);
        assert_relative_eq!(result.rms_height, 2.0);
        assert!(result.samples[0].converged() && !result.samples[1].converged());
        assert_eq!(result.samples[1].status, "iteration_limit");
        assert_eq!(result.samples[1].approach_over_h, None);
        let refused = read(&[0.1, 10.0]).unwrap_err().to_string();
        assert!(refused.starts_with("forces = 10: expected loads that mdr1d can solve (force"), "{refused}");
    }

    #[test]
    fn every_parameter_is_in_the_key_and_surfaces_of_one_ensemble_share_a_scene() {
        let grid = |cells, tolerance| Discretisation::Bem3d { cells, tolerance };
        let first = realisation(grid(8, 1e-4), &[0.1, 1.0]);
        let others = [
            Realisation { discretisation: grid(9, 1e-4), ..first.clone() },
            Realisation { discretisation: grid(8, 1e-5), ..first.clone() },
            Realisation { discretisation: Discretisation::Mdr1d { elements: 8 }, ..first.clone() },
            Realisation { fractal_dimension: 2.2, ..first.clone() },
            Realisation { master_seed: 2, ..first.clone() },
            Realisation { forces: [0.1].into(), ..first.clone() },
            Realisation { index: 3, ..first.clone() },
        ];
        let all: Vec<Realisation> = std::iter::once(first).chain(others).collect();
        let jobs = realisation_jobs(&all, Path::new("never-made")).unwrap();
        for (i, job) in jobs.iter().enumerate().skip(1) {
            assert_ne!(jobs[0].key(), job.key());
            assert_eq!((job.scene(), job.surface()), if i == 7 { (0, 3) } else { (i, 0) });
            assert!(job.cost() > 0);
        }
        assert_eq!(jobs[4].name(), "D_f = 2.2, 8 cells a side: bem3d, surface 0");
        assert_eq!(jobs[3].name(), "D_f = 2.0, 8 elements: mdr1d, surface 0");
    }

    #[test]
    fn a_surface_alone_has_the_state_of_its_job() {
        let grid = Discretisation::Bem3d { cells: 33, tolerance: 1e-6 };
        let realisation = Realisation { index: 2, ..realisation(grid, &[0.3]) };
        let job = &realisation_jobs(std::slice::from_ref(&realisation), Path::new("never-made")).unwrap()[0];
        let read = realisation.read(&job.solve(&never).unwrap()).unwrap();
        assert_eq!(read.samples[0], solve_alone(grid, 2.0, realisation.seed(), 0.3, &never).unwrap());
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
