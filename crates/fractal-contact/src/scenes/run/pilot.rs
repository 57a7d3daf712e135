//! The pilot of an accuracy: the states of surface 0 on the grids that are tried, kept in the store of the
//! results.
//!
//! The trial of a grid is the job of surface 0 in the run on this grid, and has its key. It is solved once for
//! all commands and shards of a folder, goes on after an interruption as a run does, and the run on the chosen
//! grid takes its states; only its pictures are left to the run. The fields of a trial are in a folder of
//! their own, because those of each grid have the same names; [`take_trial`] moves those of the chosen grid.

use crate::scenes::plan::{Candidate, ErrorsOfStates, ModelOnSurface, check, choose};
use crate::scenes::read::{Numerics, Result, SceneFile, cells};
use crate::scenes::run::{Folder, ModelResult, Options, SceneJob, scene_jobs};
use contact_model::{Cells, Stop};
use runs::amounts::memory;
use runs::{Error, Job as _, JobRun, Progress, Store, Threads, run_stored};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Polled from any thread, between iterations: `true` means stop now.
pub type SharedStop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Folder of the fields of trials in a folder of results.
const TRIALS: &str = ".units/accuracy";
/// Name of the pilot in messages.
const PILOT: &str = "the pilot of `accuracy`";

impl SceneFile {
    /// The scene with the grid and the tolerance that its `accuracy` asks for; itself where it asks for none.
    ///
    /// For an accuracy that is a share, a pilot solves the loads on surface 0 with 128, 256, ... cells along
    /// the longer side of the grid (of a given map: with every so many-th of its cells, at last with all of
    /// them), each compared with cells twice and four times as large. Its states are stored in the folder of
    /// the results, where this function finds them again, and the run takes those of the chosen grid. The
    /// best accuracy is chosen without a pilot. The choice depends on the scene alone, and neither on the
    /// speed of the machine nor on its memory.
    ///
    /// # Errors
    /// [`crate::scenes::Error::Scene`] where no grid gives the accuracy or its predicted time is beyond the
    /// budget, with the accuracy that is to be had; for a scene without a model, a load or an output that an
    /// accuracy could be about. [`crate::scenes::Error::Run`] where the machine has less memory than a grid
    /// needs, for what the pilot's solves refuse, and, with [`contact_model::Error::Stopped`], where `stop`
    /// said so.
    pub fn with_grid_for_accuracy(
        self,
        options: &Options,
        progress: &dyn Progress,
        stop: SharedStop<'_>,
    ) -> Result<Self> {
        let Some(requested) = self.accuracy else { return Ok(self) };
        // What is stored is read without a lock and leaves no trace.
        let stored = if options.fresh { None } else { self.stored_choice(&options.out)? };
        let chosen = if let Some(chosen) = stored {
            chosen
        } else {
            let mut store = None;
            let mut errors = |candidate: &Candidate| {
                if store.is_none() {
                    check(&self)?;
                    store = Some(Store::open_for_all(&options.out, options.fresh, &stop)?);
                }
                let trial = PilotJob { candidate, out: &options.out };
                let Some(store) = &store else { return Ok(Vec::new()) };
                trial.errors(store, (options.threads, progress), stop)
            };
            choose(&self, requested, &mut errors)?
        };
        // A merge solves nothing, and needs no memory for it.
        if options.fresh || !is_solved(&chosen, &options.out)? {
            check_memory(&chosen)?;
        }
        Ok(chosen.scene)
    }

    /// The same in memory: the states of the pilot are not kept.
    ///
    /// # Errors
    /// As [`SceneFile::with_grid_for_accuracy`].
    pub fn with_grid_in_memory(self, progress: &dyn Progress, stop: Stop<'_>) -> Result<Self> {
        let Some(requested) = self.accuracy else { return Ok(self) };
        check(&self)?;
        let mut errors = |candidate: &Candidate| {
            let job = PilotJob { candidate, out: Path::new("") }.job_in(Folder::in_memory());
            let result = job.go_on(ModelResult::default(), None, progress, stop)?;
            if result.states.len() < candidate.scene.request.count() {
                return Err(stopped());
            }
            Ok(errors_of(&result))
        };
        Ok(choose(&self, requested, &mut errors)?.scene)
    }

    /// The scene with the grid that [`SceneFile::with_grid_for_accuracy`] has chosen for it in a folder of
    /// results. Nothing is solved.
    ///
    /// # Errors
    /// As there, and [`crate::scenes::Error::Run`] where the folder does not hold the states of the pilot.
    pub fn with_stored_grid(self, out: &Path) -> Result<Self> {
        if self.accuracy.is_none() {
            return Ok(self);
        }
        let Some(chosen) = self.stored_choice(out)? else {
            let expected = "a folder with the states of the pilot that chooses the grid for `accuracy`: `plan`, `run`, `submit` and each \
                            shard solve them";
            return Err(Error::parameter("out", out.display(), expected).into());
        };
        Ok(chosen.scene)
    }

    /// The grid by what a folder holds; `None` where a trial is missing, and in a scene without an accuracy.
    fn stored_choice(&self, out: &Path) -> Result<Option<Candidate>> {
        let Some(requested) = self.accuracy else { return Ok(None) };
        let store = Store::view(out)?;
        let mut missing = false;
        let mut errors = |candidate: &Candidate| {
            let stored = PilotJob { candidate, out }.stored(&store);
            missing |= stored.is_none();
            stored.map(|result| errors_of(&result)).ok_or_else(stopped)
        };
        let chosen = choose(self, requested, &mut errors);
        if missing { Ok(None) } else { chosen.map(Some) }
    }
}

fn stopped() -> crate::scenes::Error {
    Error::model(PILOT)(contact_model::Error::Stopped { best: None }).into()
}

/// Refuses a grid that needs more memory than the machine has. It has been chosen by the scene: another one
/// would give other numbers on another machine.
fn check_memory(candidate: &Candidate) -> Result<()> {
    let Cells { columns, rows } = candidate.cells();
    if runs::threads_for_memory(1, candidate.memory, "memory", "").is_ok() {
        return Ok(());
    }
    let most = candidate.scene.accuracy.map_or(candidate.memory, |requested| requested.memory);
    let available = runs::available_memory().map_or(0.0, |bytes| bytes as f64);
    let expected = format!(
        "no more than this machine has: the grid of {columns} x {rows} cells for `accuracy` needs up to {}, and {} are available. The grid does not \
         depend on the machine; a smaller `memory` in [scene] excludes it",
        memory(candidate.memory),
        memory(available)
    );
    Err(Error::parameter("memory", memory(most), expected).into())
}

/// Whether a folder holds the states of all surfaces on a grid.
fn is_solved(chosen: &Candidate, out: &Path) -> Result<bool> {
    let store = Store::view(out)?;
    let solved = |job: &SceneJob| {
        let mut results = store.texts(&job.stored_key()).filter_map(|text| SceneJob::KIND.decode(&text));
        results.any(|result: ModelResult| result.complete)
    };
    let jobs = scene_jobs(&chosen.scene, &out.into());
    Ok(jobs.iter().filter(|job| job.unit.model == chosen.model).all(solved))
}

/// Errors of the states of a trial.
fn errors_of(result: &ModelResult) -> ErrorsOfStates {
    result.states.iter().map(|state| state.solved()?.grid.clone()).collect()
}

/// The job of surface 0 on a grid that is tried.
struct PilotJob<'a> {
    candidate: &'a Candidate,
    /// Folder of the results.
    out: &'a Path,
}

impl PilotJob<'_> {
    fn job(&self, folder: &Path) -> SceneJob {
        self.job_in(folder.into())
    }

    fn job_in(&self, folder: Folder) -> SceneJob {
        let unit = ModelOnSurface { model: self.candidate.model, surface: 0 };
        let scene = Arc::new(self.candidate.scene.clone());
        SceneJob { draws: false, ..SceneJob::new(scene, unit, folder) }
    }

    /// Its states, where all of them are stored. Their fields may be anywhere.
    fn stored(&self, store: &Store) -> Option<ModelResult> {
        let count = self.candidate.scene.request.count();
        let job = self.job(self.out);
        let mut results = store.texts(&job.stored_key()).filter_map(|text| SceneJob::KIND.decode(&text));
        results.find(|result: &ModelResult| result.states.len() == count)
    }

    /// The errors of its states, which are solved where they are not stored.
    fn errors(
        &self,
        store: &Store,
        (threads, progress): (usize, &dyn Progress),
        stop: SharedStop<'_>,
    ) -> Result<ErrorsOfStates> {
        if let Some(stored) = self.stored(store) {
            return Ok(errors_of(&stored));
        }
        check_memory(self.candidate)?;
        let folder = trial_folder(self.out, self.candidate.cells());
        runs::files::create_directory(&folder.join(".units"))?;
        let Cells { columns, rows } = self.candidate.cells();
        let what = format!("{PILOT}: {columns} x {rows} cells");
        let threads = Threads { total: threads, jobs: 1 };
        let run = JobRun { store, threads, progress, stop };
        let done = run_stored(&what, &[self.job(&folder)], run);
        let result = done.into_iter().next().flatten().ok_or_else(stopped)??;
        if result.states.len() < self.candidate.scene.request.count() {
            return Err(stopped());
        }
        Ok(errors_of(&result))
    }
}

/// The folder of the fields of a trial.
fn trial_folder(out: &Path, Cells { columns, rows }: Cells) -> PathBuf {
    out.join(format!("{TRIALS}/{columns}x{rows}"))
}

/// Moves the fields of the trial of the grid that was chosen to where the run has them, so that it finds all
/// states of surface 0 solved. Nothing is moved where there is no trial.
pub(crate) fn take_trial(scene: &SceneFile, out: &Path, store: &Store) {
    let bem3d = |numerics: &Numerics| matches!(numerics, Numerics::Bem3d(_));
    let Some(model) = scene.models.iter().position(bem3d).filter(|_| scene.accuracy.is_some()) else {
        return;
    };
    let trial = trial_folder(out, cells(scene, &scene.models[model]));
    let [from, to] = [&*trial, out].map(Folder::from);
    let unit = ModelOnSurface { model, surface: 0 };
    let scene = Arc::new(scene.clone());
    let job = SceneJob::new(scene, unit, to.clone());
    let results = store.texts(&job.stored_key()).filter_map(|text| SceneJob::KIND.decode(&text));
    for file in results.flat_map(|result: ModelResult| result.states).flat_map(|state| state.files) {
        // A file that cannot be moved is missing in the run, which then solves its state.
        if from.holds(&file) && !to.holds(&file) {
            let _ = std::fs::rename(from.path(&file.name), to.path(&file.name));
        }
    }
}

/// Removes the fields of all trials.
pub(crate) fn remove_trials(out: &Path) {
    // It is the program's own folder; what cannot be removed does no harm.
    let _ = std::fs::remove_dir_all(out.join(TRIALS));
}
