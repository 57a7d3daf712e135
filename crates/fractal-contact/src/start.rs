//! The beginning of every command that solves: the grid of a scene, and the signals that stop it.

use fractal_contact::scenes::{Error, Options, Result, SceneFile};
use runs::Progress;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Chooses the grid of a scene that requests an accuracy; `None` where `stopped` became true meanwhile.
pub fn with_grid(
    scene: SceneFile,
    options: &Options,
    progress: &dyn Progress,
    stopped: &AtomicBool,
) -> Result<Option<SceneFile>> {
    match scene.with_grid_for_accuracy(options, progress, &|| stopped.load(Ordering::Relaxed)) {
        Err(_) if stopped.load(Ordering::Relaxed) => {
            runs::err!("Stopped: the states so far are kept. The same command goes on with the others.");
            Ok(None)
        }
        chosen => chosen.map(Some),
    }
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
