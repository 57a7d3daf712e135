//! What a solve leaves, and its progress.

use crate::question::Mistake;
use crate::tell_progress;
use fractal_contact::scenes::{RunInMemory, SceneFile};
use runs::{JobInHand, Progress, WorkDone};
use serde_json::json;
use std::sync::{Mutex, PoisonError};
use wasm_bindgen::prelude::wasm_bindgen;

/// Tells the page the progress.
#[derive(Default)]
pub(crate) struct Told(Mutex<WorkDone>);

impl Told {
    fn with(&self, change: impl FnOnce(&mut WorkDone)) -> f64 {
        // A panic ends the worker, so nobody meets a poisoned lock.
        let mut work = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut work);
        work.cost() / work.total().max(1.0)
    }
}

impl Progress for Told {
    fn begin(&self, _: &str, total: u64) {
        self.with(|work| *work = WorkDone::new(total));
    }

    fn advance(&self, cost: u64, reused: bool) {
        self.with(|work| work.add(cost, reused));
    }

    fn states(&self, job: &JobInHand<'_>) {
        let share = (!job.on_coarser_grids).then(|| self.with(|work| work.set(job)));
        tell_progress(&json!({ "share": share, "words": job.words() }).to_string());
    }

    fn end(&self) {}

    fn note(&self, text: &str) {
        tell_progress(&json!({ "note": text }).to_string());
    }
}

/// The answer to a question.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Solved {
    scene: String,
    run: RunInMemory,
    mistake: Option<Mistake>,
}

impl Solved {
    pub(crate) fn new(solved: Result<(SceneFile, RunInMemory), Mistake>) -> Self {
        match solved {
            Ok((scene, run)) => Self { scene: scene.text, run, mistake: None },
            Err(mistake) => Self { mistake: Some(mistake), ..Self::default() },
        }
    }
}

#[wasm_bindgen]
impl Solved {
    /// The outcome as JSON: `{"mistake"}`, or the report as HTML, the scene as text, and the names of the files,
    /// `{"report", "scene", "files", "notes", "failed", "seconds"}`.
    pub fn outcome(&self) -> String {
        let Self { scene, run, mistake } = self;
        let told = match mistake {
            Some(mistake) => json!({ "mistake": mistake }),
            None => json!({
                "report": run.report,
                "scene": scene,
                "files": run.files.iter().map(|(name, bytes)| (name, bytes.len())).collect::<Vec<_>>(),
                "notes": run.outcome.notes,
                "failed": run.outcome.failed,
                "seconds": run.outcome.seconds,
            }),
        };
        told.to_string()
    }

    /// The bytes of a file; none where there is no file of this name.
    pub fn file(&self, name: &str) -> Option<Vec<u8>> {
        self.run.files.get(name).map(|bytes| bytes.to_vec())
    }
}
