//! Means over ensembles: the scatter of surfaces, and the errors of lines and closed forms as estimates of
//! the mean.

use super::limit::limit;
use super::problem::{DIMENSIONS, Family, LOADS, ProblemKey};
use super::row::{Formula, MeasuredSolution, Parts, StudyRow, Way, measure, unless_stopped};
use super::sizes::{Order, SequenceErrors, SizeQuantity, StudySizes};
use crate::evaluation::realisation::{Discretisation, Realisation, of_scene, realisation_jobs};
use analysis::{Statistics, statistics};
use analytic::PowerLaw;
use analytic::flat_punch::SQUARE_STIFFNESS;
use contact_model::{Load, PAPER_STIFFNESS_FACTOR, Scene, SelfAffine, Status, Stop, Surface, never};
use fractal_contact::scenes::SceneJob;
use runs::{Error, Job as _, Result, cpu_seconds, on_one_thread};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// Tolerance of the ensembles: far below their scatter.
const TOLERANCE: f64 = crate::evaluation::run::TOLERANCE;
/// Surfaces of the paper, for the ensemble part.
const PAPER_SURFACES: f64 = 60.0;

/// One ensemble: statistics of k/(E* L) and mean approach at each load, with the cost of all its surfaces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct EnsembleMeans {
    pub way: Way,
    pub stiffness: Vec<Option<Statistics>>,
    pub approach: Vec<Option<f64>>,
    pub answer: MeasuredSolution,
    pub surfaces: usize,
}

/// How the ensembles of one fractal dimension are solved.
pub(crate) fn discretisations(sizes: &StudySizes) -> Vec<Discretisation> {
    let solids = sizes.ensembles.iter().map(|&cells| Discretisation::Bem3d { cells, tolerance: TOLERANCE });
    let lines = sizes.elements.iter().map(|&elements| Discretisation::Mdr1d { elements });
    solids.chain(lines).collect()
}

/// The value of a closed form for a mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClosedForm {
    /// Number of the load.
    pub load: usize,
    pub way: Way,
    pub answer: MeasuredSolution,
}

/// Rows of all ensembles, references and closed forms. The ensembles of each fractal dimension follow one
/// another; its closed forms are in the order of the loads.
pub(crate) fn means(
    sizes: &StudySizes,
    found: &[EnsembleMeans],
    forms: &[Vec<ClosedForm>],
    orders: &mut Vec<Order>,
) -> Vec<StudyRow> {
    let mut rows = Vec::new();
    let found = found.chunks(discretisations(sizes).len());
    for ((d, found), forms) in DIMENSIONS.into_iter().zip(found).zip(forms) {
        for j in 0..LOADS.len() {
            rows.extend(at_load(d, j, found, forms, orders));
        }
    }
    rows
}

/// The surfaces of an ensemble with their jobs, which are measured one after the other.
#[derive(Debug, Clone)]
pub(crate) struct EnsembleSurfaces {
    pub discretisation: Discretisation,
    pub fractal_dimension: f64,
    realisations: Vec<Realisation>,
    jobs: Vec<SceneJob>,
}

impl EnsembleSurfaces {
    /// # Errors
    /// As [`realisation_jobs`].
    pub fn new(
        discretisation: Discretisation,
        fractal_dimension: f64,
        surfaces: usize,
        master_seed: u64,
    ) -> Result<Self> {
        let forces = Arc::from(LOADS);
        let of = |index| Realisation {
            discretisation,
            fractal_dimension,
            master_seed,
            index,
            forces: Arc::clone(&forces),
        };
        let realisations: Vec<Realisation> = (0..surfaces).map(of).collect();
        // Nothing is stored besides the means.
        let jobs = realisation_jobs(&realisations, Path::new(""))?;
        Ok(Self { discretisation, fractal_dimension, realisations, jobs })
    }

    /// Everything that decides its numbers: the first surface stands for all, as their seeds follow from the
    /// master seed.
    pub fn key(&self) -> String {
        let first = self.jobs.first().map_or_else(String::new, runs::Job::key);
        format!("ensemble\nsurfaces {}\n{first}", self.jobs.len())
    }

    /// As [`runs::Job::cost`].
    pub fn cost(&self) -> u64 {
        self.jobs.iter().map(runs::Job::cost).sum()
    }

    /// Solves them; polls `stop` between the surfaces.
    ///
    /// # Errors
    /// Errors of the model.
    pub fn solve(&self, stop: Stop<'_>) -> Result<EnsembleMeans> {
        let mut answer =
            MeasuredSolution { status: Status::Converged.as_str().to_owned(), ..MeasuredSolution::default() };
        let mut k: Vec<Vec<f64>> = vec![Vec::new(); LOADS.len()];
        let mut approach = k.clone();
        let mut seconds = Some(0.0);
        for (realisation, job) in self.realisations.iter().zip(&self.jobs) {
            unless_stopped(stop)?;
            let (states, taken) = on_one_thread(|| {
                let start = cpu_seconds();
                let states = job.solve(&never);
                (states, cpu_seconds().zip(start).map(|(end, start)| end - start))
            });
            seconds = seconds.zip(taken).map(|(all, one)| all + one);
            let result = realisation.read(&states.map_err(of_scene)?)?;
            for (j, s) in result.samples.iter().enumerate().filter(|(_, s)| s.converged()) {
                k[j].extend(s.stiffness_bar.map(|k| k * PAPER_STIFFNESS_FACTOR));
                approach[j].extend(s.approach_over_h);
                answer.iterations += s.iterations;
                answer.applications += s.applications;
            }
        }
        // The loads of one surface are solved together: each has its share.
        answer.cpu_seconds = seconds.map(|seconds| seconds / LOADS.len() as f64);
        answer.iterations /= LOADS.len();
        answer.applications /= LOADS.len();
        let stiffness = k.iter().map(|k| statistics(k)).collect();
        let approach = approach.iter().map(|d| statistics(d).map(|s| s.mean)).collect();
        let (way, surfaces) = (Way::of(self.discretisation), self.jobs.len());
        Ok(EnsembleMeans { way, stiffness, approach, answer, surfaces })
    }
}

fn at_load(
    d: f64,
    j: usize,
    found: &[EnsembleMeans],
    forms: &[ClosedForm],
    orders: &mut Vec<Order>,
) -> Vec<StudyRow> {
    let solids: Vec<(f64, Statistics)> = found
        .iter()
        .filter(|e| matches!(e.way, Way::Solid { .. }))
        .filter_map(|e| Some((1.0 / e.way.size()? as f64, e.stiffness[j]?)))
        .collect();
    let sequence: Vec<(f64, f64)> = solids.iter().map(|s| (s.0, s.1.mean)).collect();
    let Some(&(_, finest)) = solids.last() else { return Vec::new() };
    let Some(mut reference) = limit(&sequence) else { return Vec::new() };
    // What the number of surfaces leaves open stays open on any grid.
    let scatter = finest.standard_error.unwrap_or(finest.mean);
    let deviation = scatter * (solids.last().map_or(1.0, |s| s.1.count as f64)).sqrt();
    let sixty = deviation / PAPER_SURFACES.sqrt() / finest.mean;
    let problem = ProblemKey::rough(Family::Mean, d, LOADS[j]);
    let errors: Vec<(f64, f64)> = sequence.iter().map(|&(h, v)| (h, reference.distance(v))).collect();
    let errors = SequenceErrors { exact: false, all: &errors, far: &errors[..errors.len() - 1] };
    orders.push(Order::new(problem, SizeQuantity::Stiffness, Some(reference), &errors));
    reference.uncertainty = reference.uncertainty.hypot(scatter);
    let mut rows = Vec::new();
    let mut add = |way: Way, surfaces: usize, answer: MeasuredSolution, own: Option<f64>| {
        let Some(k) = answer.stiffness else { return };
        let mut row = StudyRow::new(problem, way, answer);
        let distance = reference.distance(k);
        row.surfaces = surfaces;
        row.reference_error = Some(reference.relative());
        if matches!(way, Way::Solid { .. }) {
            // The same surfaces on every grid: their scatter is common and not an error of the grid.
            row.errors[0] = Some(distance.hypot(own.unwrap_or(0.0)).max(reference.relative()));
            let (algebraic, discretisation) = (Some(TOLERANCE), Some(distance));
            row.parts = Parts { algebraic, discretisation, ensemble: Some(sixty), model: None };
        } else {
            row.errors[0] = Some(distance.max(reference.relative()));
            row.parts = Parts { model: Some(distance), ensemble: own, ..Parts::default() };
        }
        rows.push(row);
    };
    for e in found {
        let Some(k) = e.stiffness[j] else { continue };
        let answer =
            MeasuredSolution { stiffness: Some(k.mean), approach: e.approach[j], ..e.answer.clone() };
        add(e.way, e.surfaces, answer, k.relative_error());
    }
    for form in forms.iter().filter(|form| form.load == j) {
        add(form.way, 0, form.answer.clone(), None);
    }
    rows
}

/// Eq. 12 in the range in which the paper claims it, and the plateau of the rigid square under the largest
/// load.
pub(crate) fn closed_forms(d: f64, stop: Stop<'_>) -> Result<Vec<ClosedForm>> {
    let surface = SelfAffine::new(d, 1.0, 1.0).map_err(Error::model("Eq. 12"))?;
    let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    let [law, plateau] = [Formula::PowerLaw, Formula::Plateau].map(Way::Formula);
    let mut all = Vec::new();
    for (load, force_bar) in LOADS.into_iter().enumerate() {
        unless_stopped(stop)?;
        let answer = measure(&PowerLaw, &scene, Load::force(force_bar), 0)?;
        all.extend(answer.map(|answer| ClosedForm { load, way: law, answer }));
        if force_bar > 1.0 {
            let status = Status::Converged.as_str().to_owned();
            let answer =
                MeasuredSolution { stiffness: Some(SQUARE_STIFFNESS), status, ..MeasuredSolution::default() };
            all.push(ClosedForm { load, way: plateau, answer });
        }
    }
    Ok(all)
}
