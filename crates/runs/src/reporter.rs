//! Progress of a run on standard error: a bar with the remaining time on a terminal, plain lines otherwise.

use crate::amounts::duration;
use crate::progress::{JobInHand, Progress};
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use std::collections::BTreeMap;
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

/// Least work, in seconds, from which a remaining time is predicted.
const FIRST: f64 = 1.0;

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
    done: Done,
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

/// Work of a stage, as relative costs.
#[derive(Debug, Default)]
struct Done {
    total: f64,
    /// Of whole jobs.
    whole: f64,
    /// Of jobs under way, by their names.
    parts: BTreeMap<String, JobPart>,
    /// Costs of jobs whose states are all solved and whose pictures are drawn.
    finished: Vec<u64>,
    /// The part of it that was found on disk, which does not predict the time of the rest.
    found: f64,
}

/// Of a job under way.
#[derive(Debug, Clone, Copy)]
struct JobPart {
    cost: f64,
    /// States that are solved.
    states: usize,
    /// First residual of the state in hand.
    first: f64,
}

impl Done {
    /// A job is done.
    fn add(&mut self, cost: u64, reused: bool) {
        if let Some(place) = self.finished.iter().position(|finished| *finished == cost) {
            self.finished.swap_remove(place);
        }
        self.whole += cost as f64;
        if reused {
            self.found += cost as f64;
        }
    }

    /// A job is as far as this.
    fn set(&mut self, job: &JobInHand<'_>) {
        let of_states = job.cost.saturating_sub(job.pictures.cost) as f64;
        let of_state = of_states / job.all.max(1) as f64;
        if !self.parts.contains_key(job.name) {
            // What this run has not solved: the state that it tells of was solved by it.
            let solved_now = usize::from(job.residual.is_none());
            self.found += of_state * job.done.saturating_sub(solved_now) as f64;
        }
        if job.done >= job.all && job.pictures.drawn >= job.pictures.all {
            // The job counts as a whole when its result is stored, too.
            if self.parts.remove(job.name).is_some() {
                self.finished.push(job.cost);
            }
            return;
        }
        let new = JobPart { cost: 0.0, states: job.done, first: 0.0 };
        let part = self.parts.entry(job.name.to_owned()).or_insert(new);
        if part.states != job.done {
            *part = new;
        }
        let share = job.residual.map_or(0.0, |(residual, tolerance)| {
            part.first = if residual.is_finite() { part.first.max(residual) } else { part.first };
            of_the_way(part.first, residual, tolerance)
        });
        let of_pictures = if job.done < job.all {
            0.0
        } else {
            job.pictures.cost as f64 * job.pictures.drawn as f64 / job.pictures.all.max(1) as f64
        };
        part.cost = part.cost.max(of_state * (job.done as f64 + share) + of_pictures);
    }

    /// What is done.
    fn cost(&self) -> f64 {
        let under_way: f64 = self.parts.values().map(|part| part.cost).sum();
        let finished: f64 = self.finished.iter().map(|cost| *cost as f64).sum();
        (self.whole + finished + under_way).min(self.total)
    }

    /// Predicted seconds for the rest after `seconds`, at the rate of this run so far. `None` where the run
    /// has done too little for a prediction.
    fn left(&self, seconds: f64) -> Option<f64> {
        let (cost, solved) = (self.cost(), self.cost() - self.found);
        (solved > 0.0 && seconds >= FIRST).then(|| seconds * (self.total - cost) / solved)
    }
}

/// Share of the way of a residual from the first one to the tolerance, in orders of magnitude: iterations
/// reduce it by about the same factor each.
fn of_the_way(first: f64, residual: f64, tolerance: f64) -> f64 {
    let (all, gone) = ((first / tolerance).ln(), (first / residual).ln());
    if all > 0.0 && gone > 0.0 && all.is_finite() { (gone / all).min(1.0) } else { 0.0 }
}

impl Stage {
    fn new(bar: ProgressBar, total: u64, begun: Instant) -> Self {
        Self {
            bar,
            left: Arc::new(AtomicU64::new(f64::NAN.to_bits())),
            done: Done { total: total as f64, ..Done::default() },
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
        let (gone, cost) = (self.begun.elapsed().as_secs_f64(), self.done.cost());
        let left = self.done.left(gone);
        if terminal {
            self.left.store(left.unwrap_or(f64::NAN).to_bits(), Ordering::Relaxed);
            self.bar.set_position((STEPS * cost) as u64);
            self.bar.set_message(self.words.clone());
        } else if !quiet && self.told.elapsed() >= EVERY {
            self.told = Instant::now();
            let share = 100.0 * cost / self.done.total.max(1.0);
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
            s.done.add(cost, reused);
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
            s.done.set(job);
            s.words = words(job);
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

/// A job under way in words.
fn words(job: &JobInHand<'_>) -> String {
    let JobInHand { name, done, all, pictures, residual, .. } = job;
    match residual {
        _ if done >= all && pictures.drawn < pictures.all => {
            format!("picture {} of {} of {name}", pictures.drawn + 1, pictures.all)
        }
        _ if done >= all => format!("files of {name}"),
        None => format!("{done} of {all} states of {name}"),
        Some((residual, tolerance)) => {
            let state = done + 1;
            format!("state {state} of {all}, residual {residual:.0e} of {tolerance:.0e}, {name}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Pictures;

    #[test]
    fn time_left_follows_from_what_this_run_has_done() {
        let mut done = Done { total: 100.0, ..Done::default() };
        done.add(40, true);
        assert_eq!(done.left(5.0), None);
        done.add(10, false);
        // Ten took five seconds, fifty are left.
        assert_eq!(done.left(5.0), Some(25.0));
        assert_eq!(done.left(0.5), None);
        // A path of four states with two of them on disk, the third half way to its tolerance.
        let pictures = Pictures::default();
        let residual = Some((1e-2, 1e-6));
        let mut job = JobInHand { name: "path", cost: 40, done: 2, all: 4, pictures, residual };
        done.set(&job);
        assert_eq!((done.cost(), done.found), (70.0, 60.0));
        job.residual = Some((1e-4, 1e-6));
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 75.0, max_relative = 1e-12);
        approx::assert_relative_eq!(done.left(15.0).unwrap(), 15.0 * 25.0 / 15.0, max_relative = 1e-12);
        // Residuals that rise take nothing back.
        job.residual = Some((1e-1, 1e-6));
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 75.0, max_relative = 1e-12);
        // The whole job is counted when it is done.
        done.set(&JobInHand { done: 4, residual: None, ..job });
        // It is no less while its files are written.
        assert_eq!((done.cost(), done.parts.len()), (90.0, 0));
        done.add(40, false);
        assert_eq!((done.cost(), done.finished.len()), (90.0, 0));
    }

    #[test]
    fn a_job_is_not_done_before_its_pictures_are_drawn() {
        let mut done = Done { total: 50.0, ..Done::default() };
        let pictures = Pictures { cost: 20, drawn: 0, all: 4 };
        let mut job = JobInHand { name: "map", cost: 50, done: 2, all: 3, pictures, residual: None };
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 20.0, max_relative = 1e-12);
        job.done = 3;
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 30.0, max_relative = 1e-12);
        job.pictures.drawn = 1;
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 35.0, max_relative = 1e-12);
        assert_eq!(words(&job), "picture 2 of 4 of map");
        job.pictures.drawn = 4;
        done.set(&job);
        assert_eq!((done.cost(), words(&job)), (50.0, "files of map".to_owned()));
        done.add(50, false);
        assert_eq!((done.cost(), done.finished.len()), (50.0, 0));
    }

    #[test]
    fn words_of_a_job_name_its_state_and_residual() {
        let pictures = Pictures::default();
        let mut job = JobInHand { name: "bem3d", cost: 1, done: 3, all: 10, pictures, residual: None };
        assert_eq!(words(&job), "3 of 10 states of bem3d");
        job.residual = Some((3.2e-5, 1e-8));
        assert_eq!(words(&job), "state 4 of 10, residual 3e-5 of 1e-8, bem3d");
        job.done = 10;
        assert_eq!(words(&job), "files of bem3d");
    }

    #[test]
    fn the_way_to_the_tolerance_is_counted_in_orders() {
        let way = |residual| of_the_way(1.0, residual, 1e-8);
        let none = |share: f64| share.abs() < 1e-300;
        assert!(none(way(2.0)) && none(way(1.0)) && none(of_the_way(1e-9, 1e-9, 1e-8)));
        assert!(none(way(1e-9) - 1.0));
        approx::assert_relative_eq!(way(1e-2), 0.25, max_relative = 1e-12);
        for unknown in [f64::INFINITY, f64::NAN] {
            assert!(none(of_the_way(unknown, 1.0, 1e-8)) && none(of_the_way(1.0, unknown, 1e-8)));
        }
    }
}
