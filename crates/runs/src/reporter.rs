//! What a run tells on standard error: a bar with the time left on a terminal, plain lines otherwise.

use crate::progress::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal as _;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Without a terminal, at most one line in this time.
const EVERY: Duration = Duration::from_secs(10);

/// Tells on standard error how far a run is: for programs.
#[derive(Debug)]
pub struct Reporter {
    terminal: bool,
    stage: Mutex<Stage>,
}

#[derive(Debug)]
struct Stage {
    bar: ProgressBar,
    total: u64,
    done: u64,
    jobs: usize,
    reused: usize,
    begun: Instant,
    told: Instant,
}

impl Default for Reporter {
    fn default() -> Self {
        Self::new()
    }
}

impl Reporter {
    /// Looks once whether standard error is a terminal.
    pub fn new() -> Self {
        let now = Instant::now();
        let bar = ProgressBar::hidden();
        let stage = Stage { bar, total: 0, done: 0, jobs: 0, reused: 0, begun: now, told: now };
        Self { terminal: std::io::stderr().is_terminal(), stage: Mutex::new(stage) }
    }

    fn with(&self, change: impl FnOnce(&mut Stage)) {
        // A poisoned lock means that another thread panicked: that is reported elsewhere.
        if let Ok(mut stage) = self.stage.lock() {
            change(&mut stage);
        }
    }
}

impl Progress for Reporter {
    fn begin(&self, what: &str, total: u64) {
        crate::err!("{what}");
        let now = Instant::now();
        let bar = if self.terminal { ProgressBar::new(total) } else { ProgressBar::hidden() };
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} gone, {eta} left")
        {
            bar.set_style(style);
        }
        self.with(|s| *s = Stage { bar, total, done: 0, jobs: 0, reused: 0, begun: now, told: now });
    }

    fn advance(&self, cost: u64, reused: bool) {
        self.with(|s| {
            s.done += cost;
            s.jobs += 1;
            s.reused += usize::from(reused);
            if self.terminal {
                s.bar.inc(cost);
                if reused {
                    // What lies on disk says nothing about the time the rest takes.
                    s.bar.reset_eta();
                }
            } else if s.told.elapsed() >= EVERY {
                s.told = Instant::now();
                let share = s.done as f64 / s.total.max(1) as f64;
                let gone = s.begun.elapsed().as_secs_f64();
                let left = gone * (1.0 / share - 1.0);
                crate::err!("{:3.0} %  {gone:.0} s gone, about {left:.0} s left", 100.0 * share);
            }
        });
    }

    fn end(&self) {
        self.with(|s| {
            s.bar.finish_and_clear();
            let seconds = s.begun.elapsed().as_secs_f64();
            crate::err!("{} jobs done in {seconds:.1} s, {} of them found on disk", s.jobs, s.reused);
        });
    }

    fn note(&self, text: &str) {
        // A bar would be written over.
        self.with(|s| s.bar.suspend(|| crate::err!("note: {text}")));
    }
}
