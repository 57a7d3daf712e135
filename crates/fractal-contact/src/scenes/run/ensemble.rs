//! The jobs of several scenes in one store, for those who read states and not tables.

use crate::scenes::plan::calibration;
use crate::scenes::read::{Result, SceneFile};
use crate::scenes::run::{Answer, ModelResult, SceneJob, scene_jobs};
use contact_model::{ContactState, Normalisation, never};
use runs::{Job as _, JobRun, Ordered, Progress, Store, Threads, largest_first, run_in_order};
use std::path::Path;
use std::sync::Arc;

/// The jobs of these scenes in their order: each model of a scene on each of its surfaces. Their states go to
/// the store of `out`.
pub fn jobs_of_scenes(scenes: &[SceneFile], out: &Path) -> Vec<SceneJob> {
    let of = |(number, scene): (usize, &SceneFile)| {
        let among = move |job: SceneJob| SceneJob { among: Some(number), ..job };
        scene_jobs(scene, &out.into()).into_iter().map(among).collect::<Vec<_>>()
    };
    scenes.iter().enumerate().flat_map(of).collect()
}

/// Solves those of the jobs that the store does not hold, the most expensive first and as many at the same time
/// as fit into memory, and returns the states of all in the order of the jobs. No file is written besides the
/// store.
///
/// # Errors
/// The first error in the order of the jobs; a scene that does not fit into memory.
pub fn solve_jobs(
    what: &str,
    jobs: &[SceneJob],
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<ModelResult>> {
    let order = largest_first(jobs.len(), |job| jobs[job].cost());
    solve_jobs_in_order(
        what,
        &Ordered { jobs, order: &order, solved: &|_, _| Ok(()) },
        store,
        threads,
        progress,
    )
}

/// As [`solve_jobs`], in another order than that of the costs.
///
/// # Errors
/// As there; what [`Ordered::solved`] returns.
pub fn solve_jobs_in_order(
    what: &str,
    ordered: &Ordered<'_, SceneJob>,
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<ModelResult>> {
    let mut scenes: Vec<&Arc<SceneFile>> = Vec::new();
    for SceneJob { scene, .. } in ordered.jobs {
        if !scenes.iter().any(|other| Arc::ptr_eq(other, scene)) {
            scenes.push(scene);
        }
    }
    // The largest one first: its size is the one to name where it does not fit.
    let memory = |scene: &SceneFile| {
        scene.models.iter().map(|model| calibration::memory(scene, model)).fold(0.0, f64::max)
    };
    scenes.sort_by(|a, b| memory(b).total_cmp(&memory(a)));
    let mut in_flight = threads;
    for scene in scenes {
        in_flight = in_flight.min(calibration::jobs_in_memory(scene, threads)?);
    }
    let threads = Threads { total: threads, jobs: in_flight };
    let done = run_in_order(what, ordered, JobRun { store, threads, progress, stop: &never });
    let (mut results, mut not_begun) = (Vec::with_capacity(done.len()), None);
    for (job, result) in ordered.jobs.iter().zip(done) {
        match result {
            Some(result) => results.push(result?),
            // The reason is the error of another job.
            None => not_begun = not_begun.or(Some(job)),
        }
    }
    match not_begun {
        Some(job) => Err(runs::Error::model(job.name())(contact_model::Error::Stopped { best: None }).into()),
        None => Ok(results),
    }
}

impl SceneJob {
    /// Number of its scene among those of [`jobs_of_scenes`]; 0 for the job of a single scene.
    pub fn scene(&self) -> usize {
        self.among.unwrap_or(0)
    }

    /// Name of its model.
    pub fn model(&self) -> &'static str {
        self.unit.numerics(&self.scene).name()
    }

    /// Number of its surface.
    pub fn surface(&self) -> usize {
        self.unit.surface
    }
}

impl ModelResult {
    /// The state under a load, with the normalisation of its surface. Its status says whether the solve reached
    /// its tolerance.
    ///
    /// # Errors
    /// Why the model refused the load.
    pub fn state(&self, load: usize) -> std::result::Result<(&ContactState, &Normalisation), &str> {
        match self.states.iter().find(|record| record.index == load).map(|record| &record.answer) {
            Some(Answer::State(solved)) => Ok((&solved.state, &solved.normalisation)),
            Some(Answer::Refused(reason)) => Err(reason),
            None => Err("it is not among the loads of the scene"),
        }
    }

    /// Seconds that its states took, in all runs together.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }
}
