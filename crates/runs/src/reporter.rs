//! What a run tells on standard error: a bar with the time left on a terminal, plain lines otherwise.

use crate::progress::Progress;
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Steps of the bar for a unit of cost: a job may be all that there is.
const STEPS: f64 = 1000.0;

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
    /// Cost of what is done of jobs under way, by their names.
    parts: BTreeMap<String, f64>,
    /// What was told last of a job under way.
    words: String,
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
        Self { terminal: std::io::stderr().is_terminal(), stage: Mutex::new(Stage::new(bar, 0, now)) }
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
        let (parts, words) = (BTreeMap::new(), String::new());
        Self { bar, total, done: 0, parts, words, jobs: 0, reused: 0, begun, told: begun }
    }

    /// Cost of what is done, of the total.
    fn cost(&self) -> f64 {
        (self.done as f64 + self.parts.values().sum::<f64>()).min(self.total as f64)
    }

    /// Moves the bar, or now and then writes a line.
    fn show(&mut self, terminal: bool) {
        if terminal {
            self.bar.set_position((STEPS * self.cost()) as u64);
            self.bar.set_message(self.words.clone());
        } else if self.told.elapsed() >= EVERY && self.cost() > 0.0 {
            self.told = Instant::now();
            let share = self.cost() / self.total.max(1) as f64;
            let gone = self.begun.elapsed().as_secs_f64();
            let left = gone * (1.0 / share - 1.0);
            crate::err!("{:3.0} %  {gone:.0} s gone, about {left:.0} s left  {}", 100.0 * share, self.words);
        }
    }
}

impl Progress for Reporter {
    fn begin(&self, what: &str, total: u64) {
        crate::err!("{what}");
        let now = Instant::now();
        let bar = if self.terminal {
            ProgressBar::new((STEPS * total as f64) as u64)
        } else {
            ProgressBar::hidden()
        };
        let template = "{bar:16} {percent:>3} %  {elapsed} gone{left}  {wide_msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            // Of nothing done no time follows.
            let left = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
                if state.pos() > 0 {
                    let _ = write!(text, ", {:#} left", HumanDuration(state.eta()));
                }
            };
            bar.set_style(style.with_key("left", left));
        }
        if self.terminal {
            bar.enable_steady_tick(Duration::from_secs(1));
        }
        self.with(|s| *s = Stage::new(bar, total, now));
    }

    fn advance(&self, cost: u64, reused: bool) {
        self.with(|s| {
            s.done += cost;
            s.jobs += 1;
            s.reused += usize::from(reused);
            s.show(self.terminal);
            if reused {
                // What lies on disk says nothing about the time the rest takes.
                s.bar.reset_eta();
            }
        });
    }

    fn states(&self, job: &str, cost: u64, done: usize, all: usize) {
        self.with(|s| {
            if done < all {
                s.parts.insert(job.to_owned(), cost as f64 * done as f64 / all as f64);
                s.words = format!("{job}: {done} of {all} states");
            } else {
                // The whole job counts in a moment.
                s.parts.remove(job);
                s.words.clear();
            }
            s.show(self.terminal);
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
