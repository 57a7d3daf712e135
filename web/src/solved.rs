//! What a solve leaves, and its progress.

use crate::question::Mistake;
use crate::tell_progress;
use fractal_contact::scenes::{RunInMemory, SceneFile};
use runs::{JobInHand, Progress};
use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

/// Tells the page the progress.
pub(crate) struct Told;

impl Progress for Told {
    fn begin(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64, _: bool) {}

    fn states(&self, job: &JobInHand<'_>) {
        let JobInHand { name, done, all, pictures, residual, .. } = *job;
        let drawn = [pictures.drawn, pictures.all];
        let told = json!({ "job": name, "done": done, "all": all, "pictures": drawn, "residual": residual });
        tell_progress(&told.to_string());
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
