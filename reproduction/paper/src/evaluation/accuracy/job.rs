//! One part of the study, as a stored job: a problem with every method, or an ensemble under all loads.

use super::depth::Depth;
use super::every_way::solve_problem;
use super::means::{ClosedForm, EnsembleMeans, EnsembleSurfaces, closed_forms, discretisations};
use super::problem::{CELLS_PER_WAVE, DIMENSIONS, LOADS, PAPER_CELLS, RADIUS, StudyProblem};
use super::row::{Formula, StudyRow, Way};
use super::sizes::{Order, StudySizes};
use crate::evaluation::realisation::Discretisation;
use contact_model::Stop;
use fractal_contact::scenes::{FORMAT, seconds_of_rough_sweep};
use runs::{Error, Job, JobList, Result, ResultKind};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, PoisonError};

/// Number of the format of stored parts. Raise it when [`StudyPart`] changes, or the computation of limits,
/// errors and references, or the closed forms.
const STORED: u32 = 2;

/// Predicted processor milliseconds of one load on one grid from a cold start. The problems of
/// `data/accuracy` took between 0.4 and 1.3 times this, cases of the check that are not drawn again between
/// 0.8 and 2.2 times.
pub(super) fn cold_cost(cells: usize, tolerance: f64, force_bar: f64) -> u64 {
    // Without a load before it, a rough surface takes as long as a smooth one: about what the prediction for
    // sweeps says in the middle of the fractal dimensions.
    1 + (1e3 * seconds_of_rough_sweep(cells as f64, tolerance, 2.45, &[force_bar])) as u64
}

/// A task, which is solved as a whole.
#[derive(Debug, Clone)]
enum StudyTask {
    /// One problem, with every method.
    Problem(Box<StudyProblem>),
    /// One ensemble.
    Ensemble(EnsembleSurfaces),
    /// The closed forms for the means of this fractal dimension.
    ClosedForms(f64),
}

/// The result of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum StudyPart {
    /// The result of a problem; the rows have no pressures.
    Problem(Vec<StudyRow>, Vec<Order>),
    /// The result of an ensemble.
    Ensemble(EnsembleMeans),
    /// The results of closed forms.
    ClosedForms(Vec<ClosedForm>),
}

/// One task of a study.
#[derive(Debug, Clone)]
pub(super) struct StudyJob {
    sizes: Arc<StudySizes>,
    seed: u64,
    task: StudyTask,
}

/// All tasks of a study: first the problems, then the ensembles of each fractal dimension, then the closed
/// forms of each.
pub(super) fn jobs(sizes: &StudySizes, seed: u64) -> Result<Vec<StudyJob>> {
    let problems = StudyProblem::all(sizes.grids[0])?.into_iter().map(|p| StudyTask::Problem(Box::new(p)));
    let of = |(d, n)| EnsembleSurfaces::new(n, d, sizes.surfaces, seed).map(StudyTask::Ensemble);
    let pairs = DIMENSIONS.into_iter().flat_map(|d| discretisations(sizes).into_iter().map(move |n| (d, n)));
    let ensembles = pairs.map(of).collect::<Result<Vec<_>>>()?;
    let sizes = Arc::new(sizes.clone());
    let job = |task| StudyJob { sizes: Arc::clone(&sizes), seed, task };
    let forms = DIMENSIONS.into_iter().map(StudyTask::ClosedForms);
    Ok(problems.chain(ensembles).chain(forms).map(job).collect())
}

/// The jobs of [`super::accuracy_cost`]: one job for each problem, each ensemble, and the closed forms of
/// each fractal dimension.
///
/// A job measures on one thread, and no two jobs of a process measure at the same time, whatever the threads.
/// The times are those of the machine that solved the job: they compare where all shards ran on machines of
/// one kind with nothing else to do.
///
/// # Errors
/// [`Error::Model`] where a surface cannot be generated, which no depth causes.
pub fn accuracy_cost_jobs(depth: Depth, seed: u64) -> Result<Box<dyn JobList>> {
    Ok(Box::new(jobs(&depth.sizes(), seed)?))
}

impl StudyJob {
    pub fn is_problem(&self) -> bool {
        matches!(self.task, StudyTask::Problem(_))
    }

    /// Every method with which a problem may be solved.
    fn ways(&self) -> Vec<Way> {
        let mut ways = self.sizes.solids();
        ways.extend([Way::Line { elements: self.sizes.elements[0] }, Way::Formula(Formula::Hertz)]);
        ways
    }
}

impl Job for StudyJob {
    type Output = StudyPart;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("accuracy", STORED);

    fn key(&self) -> String {
        let Self { sizes, seed, task } = self;
        match task {
            StudyTask::Problem(problem) => format!(
                "problem\nformat {FORMAT}\nmodel_format {}\nproblem {:?}\nradius {RADIUS:?}\n\
                 cells_per_wave {CELLS_PER_WAVE:?}\npaper_cells {PAPER_CELLS}\nsizes {sizes:?}\nways {:?}\nseed {seed}\n",
                bem3d::FORMAT,
                problem.key,
                self.ways(),
            ),
            StudyTask::Ensemble(surfaces) => surfaces.key(),
            StudyTask::ClosedForms(d) => {
                format!("closed forms\nfractal_dimension {d:?}\nforce_bar {LOADS:?}\n")
            }
        }
    }

    fn name(&self) -> String {
        match &self.task {
            StudyTask::Problem(problem) => {
                let number =
                    |name: &str, v: Option<f64>| v.map(|v| format!(", {name} = {v:?}")).unwrap_or_default();
                let key = problem.key;
                let (d, force) = (number("D_f", key.fractal_dimension), number("F_bar", key.force_bar));
                format!("accuracy: {}{d}{force}", key.family.as_str())
            }
            StudyTask::Ensemble(EnsembleSurfaces { fractal_dimension: d, discretisation: n, .. }) => {
                let (surfaces, size) = (self.sizes.surfaces, n.size());
                format!("accuracy: {surfaces} surfaces of D_f = {d:?}, {} {size}", n.name())
            }
            StudyTask::ClosedForms(d) => format!("accuracy: closed forms of D_f = {d:?}"),
        }
    }

    fn cost(&self) -> u64 {
        match &self.task {
            StudyTask::Problem(problem) => {
                let force_bar = problem.key.force_bar.unwrap_or(1.0);
                let cost = |way: &Way| match *way {
                    Way::Solid { cells, tolerance, .. } => cold_cost(cells, tolerance, force_bar),
                    _ => 1,
                };
                self.ways().iter().map(cost).sum()
            }
            StudyTask::Ensemble(surfaces) => surfaces.cost(),
            StudyTask::ClosedForms(_) => 1,
        }
    }

    fn memory(&self) -> f64 {
        match &self.task {
            StudyTask::Problem(_) => {
                let sizes = self.sizes.sequence().into_iter();
                let memory = |cells| Discretisation::Bem3d { cells, tolerance: self.sizes.tight }.memory();
                let largest = sizes.map(memory).fold(0.0, f64::max);
                // The pressures of all ways are compared at the end.
                let solids = self.ways().into_iter().filter(|way| matches!(way, Way::Solid { .. }));
                let cells: usize = solids.filter_map(|way| way.size()).map(|n| n * n).sum();
                largest + (size_of::<f64>() * cells) as f64
            }
            StudyTask::Ensemble(surfaces) => surfaces.discretisation.memory(),
            StudyTask::ClosedForms(_) => 0.0,
        }
    }

    fn stored_bytes(&self) -> u64 {
        // A row takes about 800 bytes, and so does a closed form of every load, or an ensemble.
        let rows = if self.is_problem() { self.ways().len() } else { 4 };
        1000 * (1 + rows as u64)
    }

    fn solve(&self, stop: Stop<'_>) -> Result<StudyPart> {
        // The peak of memory is that of the whole process, and another measurement would share the caches:
        // they take turns, also in a shard that has more threads.
        static MEASURING: Mutex<()> = Mutex::new(());
        let _turn = MEASURING.lock().unwrap_or_else(PoisonError::into_inner);
        match &self.task {
            StudyTask::Problem(problem) => {
                let (rows, orders) = solve_problem(problem, &self.sizes, self.seed, stop)?;
                Ok(StudyPart::Problem(rows, orders))
            }
            StudyTask::Ensemble(surfaces) => surfaces.solve(stop).map(StudyPart::Ensemble),
            StudyTask::ClosedForms(d) => closed_forms(*d, stop).map(StudyPart::ClosedForms),
        }
    }

    fn is_whole(&self, part: &StudyPart) -> bool {
        match (&self.task, part) {
            (StudyTask::Problem(problem), StudyPart::Problem(rows, orders)) => {
                let ways = self.ways();
                rows.iter().all(|row| row.problem == problem.key && ways.contains(&row.way))
                    && orders.iter().all(|order| order.problem == problem.key)
            }
            (StudyTask::Ensemble(surfaces), StudyPart::Ensemble(means)) => {
                means.way == Way::of(surfaces.discretisation)
                    && means.surfaces == self.sizes.surfaces
                    && [means.stiffness.len(), means.approach.len()] == [LOADS.len(); 2]
            }
            (StudyTask::ClosedForms(_), StudyPart::ClosedForms(forms)) => {
                forms.iter().all(|form| form.load < LOADS.len() && matches!(form.way, Way::Formula(_)))
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::never;

    const SIZES: StudySizes = StudySizes {
        grids: &[17, 33],
        between: &[25, 29],
        tolerances: &[1e-1],
        finest: &[1e-2],
        ladder: 33,
        tight: 1e-8,
        elements: &[256],
        surfaces: 2,
        ensembles: &[17],
    };

    /// Jobs of a sphere, a band and a spectrum, of ensembles of surfaces and lines, and of closed forms.
    fn some() -> Vec<StudyJob> {
        let all = jobs(&SIZES, 1).unwrap();
        assert_eq!((all.len(), all.partition_point(StudyJob::is_problem)), (26 + 3 * 3, 26));
        [0, 3, 20, 26, 29, 32].map(|i| all[i].clone()).into()
    }

    #[test]
    fn parts_come_back_bit_for_bit_and_damage_does_not() {
        for job in some() {
            let part = job.solve(&never).unwrap();
            let text = StudyJob::KIND.encode(&part);
            let back = job.decode(&text).unwrap();
            // The text holds every bit, the sign of a zero too.
            assert_eq!(StudyJob::KIND.encode(&back), text);
            assert_eq!(back, part);
            for cut in 0..text.len() {
                assert!(job.decode(&text[..cut]).is_none(), "{}: {cut} of {} bytes", job.name(), text.len());
            }
            let last = text.rfind(|c: char| c.is_ascii_digit()).unwrap();
            let digit = |to: &str| text[..last].to_owned() + to + &text[last + 1..];
            for bad in [digit("NaN"), digit("1e999"), digit("x"), format!("{text}-\n"), format!("-{text}")] {
                assert!(job.decode(&bad).is_none(), "{}: {bad}", job.name());
            }
            for other in some().iter().filter(|other| other.key() != job.key()) {
                assert!(other.decode(&text).is_none(), "{} as {}", job.name(), other.name());
            }
        }
    }

    #[test]
    fn keys_hold_what_decides_and_ensembles_are_shared_between_depths() {
        let all = jobs(&SIZES, 1).unwrap();
        let mut keys: Vec<String> = all.iter().map(Job::key).collect();
        let deeper = StudySizes { grids: &[17, 33, 65], ensembles: &[17, 33], ..SIZES };
        let deeper: Vec<String> = jobs(&deeper, 1).unwrap().iter().map(Job::key).collect();
        assert_eq!(keys.iter().filter(|key| deeper.contains(key)).count(), 6 + 3);
        for other in [jobs(&SIZES, 2).unwrap(), jobs(&StudySizes { surfaces: 3, ..SIZES }, 1).unwrap()] {
            // Closed forms know neither seeds nor sizes.
            assert_eq!(other.iter().filter(|job| keys.contains(&job.key())).count(), 3);
        }
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), all.len());
        assert!(all.iter().all(|job| job.cost() > 0 && job.memory() >= 0.0));
        assert_eq!(accuracy_cost_jobs(super::super::depth::Depth::Quick, 1).unwrap().count(), 26 + 3 * 7);
    }

    #[test]
    fn stopped_before_the_next_measurement() {
        for job in some() {
            let stopped = job.solve(&|| true).unwrap_err();
            assert!(matches!(stopped, Error::Model { source: contact_model::Error::Stopped { .. }, .. }));
        }
    }
}
