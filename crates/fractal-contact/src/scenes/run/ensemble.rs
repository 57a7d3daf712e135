//! The states of several scenes in one store, for those who read states and not tables.

use crate::scenes::plan::calibration;
use crate::scenes::read::{Result, SceneFile};
use crate::scenes::run::{Answer, ModelResult, SceneJob, StateRecord, scene_jobs};
use contact_model::{ContactState, Normalisation, never};
use runs::{Job as _, JobList, Progress, Store, Threads, run_stored};
use std::path::Path;

/// The states of a model on a surface, one for each load.
#[derive(Debug, Clone)]
pub struct SurfaceStates {
    /// Name of the model.
    pub model: &'static str,
    /// Number of the surface.
    pub surface: usize,
    /// Seconds that they took, in all runs together.
    pub seconds: f64,
    states: Vec<StateRecord>,
}

impl SurfaceStates {
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
}

/// The jobs of these scenes: each model on each surface.
pub fn jobs_of_scenes(scenes: &[SceneFile], out: &Path) -> Box<dyn JobList> {
    Box::new(all_jobs(scenes, out))
}

fn all_jobs(scenes: &[SceneFile], out: &Path) -> Vec<SceneJob> {
    let of = |(number, scene): (usize, &SceneFile)| {
        let among = move |job: SceneJob| SceneJob { among: Some(number), ..job };
        scene_jobs(scene, out).into_iter().map(among).collect::<Vec<_>>()
    };
    scenes.iter().enumerate().flat_map(of).collect()
}

/// Solves what the store of `out` does not hold of these scenes, the most expensive jobs first, and returns the
/// states of each scene in the order of its models and surfaces. No file is written besides the store.
///
/// # Errors
/// Those of the models, in the order of the jobs; a scene that does not fit into memory.
pub fn solve_scenes(
    what: &str,
    scenes: &[SceneFile],
    (out, store): (&Path, &Store),
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<Vec<SurfaceStates>>> {
    let mut in_flight = threads;
    for scene in scenes {
        in_flight = in_flight.min(calibration::jobs_in_memory(scene, threads)?);
    }
    let jobs = all_jobs(scenes, out);
    let threads = Threads { total: threads, jobs: in_flight };
    let mut done = run_stored(what, &jobs, store, threads, progress, &never).into_iter().zip(jobs);
    let mut states = |scene: &SceneFile| -> Result<Vec<SurfaceStates>> {
        let count = crate::scenes::run::units(scene).len();
        done.by_ref().take(count).map(|(result, job)| states_of(result, &job)).collect()
    };
    scenes.iter().map(&mut states).collect()
}

fn states_of(result: Option<Result<ModelResult>>, job: &SceneJob) -> Result<SurfaceStates> {
    let not_begun = || runs::Error::model(job.name())(contact_model::Error::Stopped { best: None });
    let ModelResult { seconds, states, .. } = result.ok_or_else(not_begun)??;
    let model = job.unit.numerics(&job.scene).name();
    Ok(SurfaceStates { model, surface: job.unit.surface, seconds, states })
}
