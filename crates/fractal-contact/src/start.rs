//! The beginning of every command that solves: it reads a scene with its grid, and installs the signals that
//! stop it.

use fractal_contact::scenes::{Error, Result, SceneFile};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Reads a scene and chooses its grid where it requests an accuracy.
pub fn read_scene(path: &Path) -> Result<SceneFile> {
    SceneFile::read(path)?.with_grid_for_accuracy(&|| false)
}

/// Becomes true with the first Ctrl-C, SIGTERM or SIGHUP; the second ends the process.
pub fn stopped_by_signals() -> Result<Arc<AtomicBool>> {
    let stopped = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stopped);
    // A handler without its thread would swallow the signals; their default action leaves the finished states
    // in the store.
    if !runs::grants_a_thread() {
        runs::err!(
            "note: the system grants no thread. Ctrl-C therefore ends the run at once and writes no tables."
        );
        return Ok(stopped);
    }
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        runs::err!(
            "Stopping: the states so far are being written. A second Ctrl-C ends the program at once."
        );
    })
    .map_err(|e| Error::Argument { name: "Ctrl-C", reason: e.to_string() })?;
    Ok(stopped)
}
