//! A list of jobs with a result store: an interrupted run resumes where it stopped, and a finished one
//! computes nothing.
//!
//! `cargo run -p fractal-contact-runs --example resume -- DIRECTORY`
//!
//! ```text
//! first run: 3 results, 3 solved
//! second run: 8 results, 5 solved
//! third run: 8 results, 0 solved
//! summits at 2.425, 3.743, 2.946, ... rms heights
//! ```

use contact_model::{SelfAffine, Stop};
use runs::{Error, Job, JobRun, Result, ResultKind, Silent, Store, Threads, collect, run_stored};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use surface_gen::self_affine_map;

/// The highest point of one surface, in rms heights.
struct Summit<'a> {
    seed: u64,
    solved: &'a AtomicUsize,
}

impl Job for Summit<'_> {
    type Output = f64;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("example summit", 1);

    fn key(&self) -> String {
        format!("D_f 2.4, 129 cells, seed {}", self.seed)
    }

    fn name(&self) -> String {
        format!("surface {}", self.seed)
    }

    fn cost(&self) -> u64 {
        1
    }

    fn solve(&self, _stop: Stop<'_>) -> Result<f64> {
        self.solved.fetch_add(1, Ordering::Relaxed);
        let draw = || self_affine_map(&SelfAffine::new(2.4, 1.0, 1.0)?, 129, self.seed);
        Ok(draw().map_err(Error::model(format!("surface {}", self.seed)))?.highest())
    }
}

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let out = out.join(format!("resume-{}", std::process::id()));
    let (store, solved) = (Store::open(&out, false)?, AtomicUsize::new(0));
    let jobs: Vec<Summit<'_>> = (0..8).map(|seed| Summit { seed, solved: &solved }).collect();
    let mut before = 0;
    let mut count =
        || solved.load(Ordering::Relaxed) - std::mem::replace(&mut before, solved.load(Ordering::Relaxed));

    // Stopped after three jobs, as by Ctrl-C.
    let enough = || solved.load(Ordering::Relaxed) >= 3;
    let first = JobRun { store: &store, threads: Threads::all(1), progress: &Silent, stop: &enough };
    let interrupted = run_stored("summits", &jobs, first);
    println!("first run: {} results, {} solved", interrupted.iter().flatten().count(), count());
    let second = JobRun { stop: &|| false, ..first };
    let resumed = collect(run_stored("summits", &jobs, second))?;
    println!("second run: {} results, {} solved", resumed.len(), count());
    let third = JobRun { threads: Threads::all(2), ..second };
    let again = collect(run_stored("summits", &jobs, third))?;
    println!("third run: {} results, {} solved", again.len(), count());
    println!("summits at {:.3}, {:.3}, {:.3}, ... rms heights", again[0], again[1], again[2]);
    assert_eq!(resumed, again); // to the bit
    assert_eq!(solved.load(Ordering::Relaxed), jobs.len());
    std::fs::remove_dir_all(&out).map_err(Error::file("remove", &out))
}
