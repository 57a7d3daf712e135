//! Progress of a run on standard error: a bar with the remaining time on a terminal, plain lines otherwise.

use crate::amounts::duration;
use crate::progress::{JobInHand, Progress};
use crate::work_done::WorkDone;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use std::io::IsTerminal as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Steps of the bar for a unit of cost: a job may be all that there is.
const STEPS: f64 = 1000.0;

/// Without a terminal, at most one line in this time.
const EVERY: Duration = Duration::from_secs(10);

/// Time between two changes of the bar that iterations make.
const FRAME: Duration = Duration::from_millis(100);

/// Reports on standard error how far a run is: for programs.
///
/// On a terminal there is a bar. [`Reporter::new`] also prints the title of a stage, what was done in it and,
/// where there is no terminal, a line now and then; [`Reporter::quiet`] prints the bar and notes alone.
#[derive(Debug)]
pub struct Reporter {
    terminal: bool,
    quiet: bool,
    stage: Mutex<Stage>,
}

#[derive(Debug)]
struct Stage {
    bar: ProgressBar,
    /// Bits of the seconds left, for the bar, which is drawn by a thread of its own.
    left: Arc<AtomicU64>,
    work: WorkDone,
    /// Last message about a job in progress.
    words: String,
    jobs: usize,
    reused: usize,
    begun: Instant,
    told: Instant,
    shown: Instant,
}

impl Default for Reporter {
    fn default() -> Self {
        Self::new()
    }
}

impl Reporter {
    /// A reporter; it checks once whether standard error is a terminal.
    pub fn new() -> Self {
        let stage = Stage::new(ProgressBar::hidden(), 0, Instant::now());
        Self { terminal: std::io::stderr().is_terminal(), quiet: false, stage: Mutex::new(stage) }
    }

    /// Prints nothing but the bar of a terminal, which goes in the end, and notes.
    pub fn quiet() -> Self {
        Self { quiet: true, ..Self::new() }
    }

    fn with(&self, change: impl FnOnce(&mut Stage)) {
        // A poisoned lock means that another thread panicked: that is reported elsewhere.
        if let Ok(mut stage) = self.stage.lock() {
            change(&mut stage);
        }
    }
}

impl Stage {
    fn new(bar: ProgressBar, total: u64, begun: Instant) -> Self {
        Self {
            bar,
            left: Arc::new(AtomicU64::new(f64::NAN.to_bits())),
            work: WorkDone::new(total),
            words: String::new(),
            jobs: 0,
            reused: 0,
            begun,
            told: begun,
            shown: begun,
        }
    }

    /// Moves the bar, or now and then writes a line.
    fn show(&mut self, terminal: bool, quiet: bool) {
        let (gone, cost) = (self.begun.elapsed().as_secs_f64(), self.work.cost());
        let left = self.work.left(gone);
        if terminal {
            self.left.store(left.unwrap_or(f64::NAN).to_bits(), Ordering::Relaxed);
            self.bar.set_position((STEPS * cost) as u64);
            self.bar.set_message(self.words.clone());
        } else if !quiet && self.told.elapsed() >= EVERY {
            self.told = Instant::now();
            let share = 100.0 * cost / self.work.total().max(1.0);
            let left = left.map_or_else(String::new, |left| format!(", about {} left", duration(left)));
            crate::err!("{share:3.0} %  {} gone{left}  {}", duration(gone), self.words);
        }
    }
}

impl Progress for Reporter {
    fn begin(&self, what: &str, total: u64) {
        if !self.quiet {
            crate::err!("{what}");
        }
        let now = Instant::now();
        let bar = if self.terminal {
            ProgressBar::new((STEPS * total as f64) as u64)
        } else {
            ProgressBar::hidden()
        };
        let stage = Stage::new(bar.clone(), total, now);
        // With 80 columns there is room for the residual.
        let template = "{bar:10} {percent:>3} %  {elapsed} gone{left}  {wide_msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            let seconds = Arc::clone(&stage.left);
            let left = move |_: &ProgressState, text: &mut dyn std::fmt::Write| {
                let seconds = f64::from_bits(seconds.load(Ordering::Relaxed));
                if seconds.is_finite() {
                    let _ = write!(text, ", {} left", duration(seconds));
                }
            };
            bar.set_style(style.with_key("left", left));
        }
        if self.terminal {
            bar.enable_steady_tick(Duration::from_secs(1));
        }
        self.with(|s| *s = stage);
    }

    fn advance(&self, cost: u64, reused: bool) {
        self.with(|s| {
            s.work.add(cost, reused);
            s.jobs += 1;
            s.reused += usize::from(reused);
            s.show(self.terminal, self.quiet);
        });
    }

    fn states(&self, job: &JobInHand<'_>) {
        self.with(|s| {
            // Of a small contact there are thousands of iterations a second.
            if job.residual.is_some() && s.shown.elapsed() < FRAME {
                return;
            }
            s.shown = Instant::now();
            s.work.set(job);
            s.words = job.words();
            s.show(self.terminal, self.quiet);
        });
    }

    fn end(&self) {
        self.with(|s| {
            s.bar.finish_and_clear();
            if self.quiet {
                return;
            }
            let seconds = s.begun.elapsed().as_secs_f64();
            let jobs = if s.jobs == 1 { "job" } else { "jobs" };
            crate::err!("{} {jobs} done in {seconds:.1} s, {} of them found on disk", s.jobs, s.reused);
        });
    }

    fn note(&self, text: &str) {
        // A bar would be written over.
        self.with(|s| s.bar.suspend(|| crate::err!("note: {text}")));
    }
}
