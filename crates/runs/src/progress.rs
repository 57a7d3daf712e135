//! Progress of a run.

use contact_model::{Stop, Watch};
use std::cell::Cell;

/// Receives the progress of a run. All methods may be called from any thread.
pub trait Progress: Sync {
    /// A stage begins; `total` is its relative cost.
    fn begin(&self, what: &str, total: u64);
    /// A job of this relative cost is done; `reused` when it was found on disk.
    fn advance(&self, cost: u64, reused: bool);
    /// A job is under way.
    fn states(&self, job: &JobInHand<'_>) {
        let _ = job;
    }
    /// The stage is over.
    fn end(&self);
    /// A note to the user, in whole sentences.
    fn note(&self, text: &str) {
        let _ = text;
    }
}

/// Ignores the progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64, _: bool) {}
    fn end(&self) {}
}

/// Progress of a job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JobInHand<'a> {
    /// Its name.
    pub name: &'a str,
    /// Relative cost of all of it: of its states and of its pictures.
    pub cost: u64,
    /// Number of states that are solved.
    pub done: usize,
    /// Number of all of its states.
    pub all: usize,
    /// Its pictures, which are drawn when all states are solved.
    pub pictures: Pictures,
    /// Largest residual of the state that is being solved, and the tolerance that ends its solve.
    pub residual: Option<(f64, f64)>,
    /// Whether its loads are being solved on the coarser grids that tell the error of the grid.
    pub on_coarser_grids: bool,
}

impl JobInHand<'_> {
    /// What is being done, in words.
    pub fn words(&self) -> String {
        let Self { name, done, all, pictures, residual, on_coarser_grids, .. } = self;
        let residual =
            residual.map(|(residual, tolerance)| format!("residual {residual:.0e} of {tolerance:.0e}"));
        match residual {
            _ if done >= all && pictures.drawn < pictures.all => {
                format!("picture {} of {} of {name}", pictures.drawn + 1, pictures.all)
            }
            _ if done >= all => format!("files of {name}"),
            None => format!("{done} of {all} states of {name}"),
            Some(residual) if *on_coarser_grids => format!("coarser grids, {residual}, {name}"),
            Some(residual) => format!("state {} of {all}, {residual}, {name}", done + 1),
        }
    }
}

/// The pictures of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pictures {
    /// Part of the cost of the job that drawing them takes.
    pub cost: u64,
    /// Number of pictures that are drawn.
    pub drawn: usize,
    /// Number of all pictures.
    pub all: usize,
}

/// Reports the residuals of the states of a job, and passes on a request to stop.
pub struct StatesInHand<'a> {
    name: String,
    cost: u64,
    all: usize,
    done: Cell<usize>,
    pictures: Cell<Pictures>,
    on_coarser_grids: Cell<bool>,
    progress: &'a dyn Progress,
    stop: Stop<'a>,
}

impl<'a> StatesInHand<'a> {
    /// A job of this name and relative cost with `done` of its `all` states solved before, and no pictures.
    pub fn new(
        (name, cost): (String, u64),
        [done, all]: [usize; 2],
        progress: &'a dyn Progress,
        stop: Stop<'a>,
    ) -> Self {
        let (pictures, on_coarser_grids) = (Cell::default(), Cell::default());
        Self { name, cost, all, done: Cell::new(done), pictures, on_coarser_grids, progress, stop }
    }

    /// The same job with as many pictures, whose drawing takes `cost` of the cost of the whole job.
    #[must_use]
    pub fn with_pictures(self, all: usize, cost: u64) -> Self {
        self.pictures.set(Pictures { cost, drawn: 0, all });
        self
    }

    /// From now on its loads are solved on coarser grids, or on its own.
    pub fn on_coarser_grids(&self, are: bool) {
        self.on_coarser_grids.set(are);
    }

    /// Reports that `done` states are solved.
    pub fn solved(&self, done: usize) {
        self.done.set(done);
        self.tell(None);
    }

    /// Reports that one more picture is drawn.
    pub fn drew(&self) {
        let pictures = self.pictures.get();
        self.pictures.set(Pictures { drawn: pictures.all.min(pictures.drawn + 1), ..pictures });
        self.tell(None);
    }

    /// Reports that nothing is left to be done. A path may end before its last state, and a state may have no picture;
    /// without this report their share of the cost would be missing.
    pub fn finished(&self) {
        let pictures = self.pictures.get();
        if self.done.get() < self.all || pictures.drawn < pictures.all {
            self.done.set(self.all);
            self.pictures.set(Pictures { drawn: pictures.all, ..pictures });
            self.tell(None);
        }
    }

    fn tell(&self, residual: Option<(f64, f64)>) {
        let Self { name, cost, all, done, pictures, .. } = self;
        let (done, pictures, on_coarser_grids) = (done.get(), pictures.get(), self.on_coarser_grids.get());
        let job = JobInHand { name, cost: *cost, done, all: *all, pictures, residual, on_coarser_grids };
        self.progress.states(&job);
    }
}

impl std::fmt::Debug for StatesInHand<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { name, done, all, .. } = self;
        write!(f, "{name}: {} of {all} states", done.get())
    }
}

impl Watch for StatesInHand<'_> {
    fn stops(&self) -> bool {
        self.stop.stops()
    }

    fn residual(&self, residual: f64, tolerance: f64) {
        self.tell(Some((residual, tolerance)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// Numbers of states and of pictures that are done.
    #[derive(Default)]
    struct Told(Mutex<Vec<[usize; 2]>>);

    impl Progress for Told {
        fn begin(&self, _: &str, _: u64) {}
        fn advance(&self, _: u64, _: bool) {}
        fn states(&self, job: &JobInHand<'_>) {
            self.0.lock().unwrap().push([job.done, job.pictures.drawn]);
        }
        fn end(&self) {}
    }

    #[test]
    fn a_job_without_some_states_or_pictures_ends_as_a_whole() {
        let told = Told::default();
        let job = |name: &str| {
            StatesInHand::new((name.to_owned(), 10), [0, 3], &told, &contact_model::never).with_pictures(2, 4)
        };
        let short = job("a path of two states with one picture");
        short.solved(2);
        short.drew();
        short.finished();
        let whole = job("all states and pictures");
        whole.solved(3);
        whole.drew();
        whole.drew();
        // There is nothing new to report.
        whole.finished();
        assert_eq!(*told.0.lock().unwrap(), [[2, 0], [2, 1], [3, 2], [3, 0], [3, 1], [3, 2]]);
    }
}
