//! Jobs in parallel, with ordered results; finished jobs are kept in a result store.

use crate::encoding::ResultKind;
use crate::error::Error;
use crate::progress::Progress;
use crate::shard::largest_first;
use crate::store::Store;
use crate::threads::{JOB_STACK, granted_pool};
use contact_model::Stop;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Number of threads and of jobs in progress.
///
/// Each job in progress has a thread; threads without a job help in the jobs of others whose work is large
/// enough to share. The number of jobs, their memory and the number of threads decide which jobs run at the
/// same time; the results do not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Threads {
    /// Number of all threads.
    pub total: usize,
    /// Largest number of jobs in progress, limited by the memory that they need.
    pub jobs: usize,
}

impl Threads {
    /// As many jobs in progress as there are threads.
    pub fn all(total: usize) -> Self {
        Self { total, jobs: total }
    }
}

/// Does some work on one thread, whatever the pool around it, for measurements of time.
pub fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match granted_pool(1, JOB_STACK) {
        Some(pool) => pool.install(work),
        // A system that grants no thread has one, this one.
        None => work(),
    }
}

/// Runs the jobs in the order of `order` and returns their results by number; `None` for a job that was not
/// begun.
///
/// After a failure, or when `stop` says so, no further job begins, and the closure of each job in progress
/// stops it.
///
/// One loop per thread rather than a parallel iterator: a thread that waits inside a job then never begins
/// another one (whose time would contain the first), and those without a job help the others. Where the
/// system grants fewer threads there are fewer, at worst the calling one.
pub fn run_jobs<T: Send + Sync, E: Send + Sync>(
    threads: Threads,
    order: &[usize],
    stop: &(dyn Fn() -> bool + Sync),
    job: impl Fn(usize, Stop<'_>) -> Result<T, E> + Sync,
) -> Vec<Option<Result<T, E>>> {
    let results: Vec<OnceLock<Result<T, E>>> = order.iter().map(|_| OnceLock::new()).collect();
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let halt = || failed.load(Ordering::Relaxed) || stop();
    // More threads than jobs only help where there are processors for them.
    let useful = order.len().max(std::thread::available_parallelism().map_or(1, usize::from));
    let Threads { total, jobs } = threads;
    let run = || {
        while let Some(&i) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            if halt() {
                return;
            }
            let result = job(i, &halt);
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            // Each number is taken once.
            let _ = results[i].set(result);
        }
    };
    match granted_pool(total.clamp(1, useful), JOB_STACK) {
        Some(pool) => {
            pool.broadcast(|worker| {
                if worker.index() < jobs.max(1) {
                    run();
                }
            });
        }
        None => run(),
    }
    results.into_iter().map(OnceLock::into_inner).collect()
}

/// All results in their places, or why some are missing.
///
/// # Errors
/// The first error that is not the stop of the others; [`contact_model::Error::Stopped`] where jobs were
/// stopped or never begun.
pub fn collect<T>(done: Vec<Option<Result<T, Error>>>) -> Result<Vec<T>, Error> {
    let mut results = Vec::with_capacity(done.len());
    let mut stopped = None;
    for result in done {
        match result {
            Some(Ok(result)) => results.push(result),
            // Others that were in flight were told to stop: their reason is not the reason.
            Some(Err(e @ Error::Model { source: contact_model::Error::Stopped { .. }, .. })) => {
                stopped.get_or_insert(e);
            }
            Some(Err(e)) => return Err(e),
            None => {
                let never_begun = contact_model::Error::Stopped { best: None };
                stopped.get_or_insert_with(|| Error::model("jobs that were not begun")(never_begun));
            }
        }
    }
    stopped.map_or(Ok(results), Err)
}

/// One independent piece of work, kept in a result store.
pub trait Job: Sync {
    /// Its result, which is stored as [`ResultKind::encode`] writes it.
    type Output: Serialize + DeserializeOwned + Send + Sync;
    /// Its error.
    type Error: From<Error> + Send + Sync;

    /// Name of its results in a store, with the number of their format.
    const KIND: ResultKind;

    /// Everything that decides the numbers, as text. Two jobs of a kind with the same key have the same
    /// output.
    fn key(&self) -> String;

    /// Its name for people.
    fn name(&self) -> String;

    /// Predicted processor time in milliseconds, at least 1. It decides the order of the jobs, their division
    /// into shards and the progress bar.
    fn cost(&self) -> u64;

    /// Memory that it needs, in bytes; 0 where it is negligible.
    fn memory(&self) -> f64 {
        0.0
    }

    /// Approximate number of bytes of its result on the disk.
    fn stored_bytes(&self) -> u64 {
        4096
    }

    /// Does the work; polls `stop` between iterations.
    ///
    /// # Errors
    /// Whatever ends the whole command.
    fn solve(&self, stop: Stop<'_>) -> Result<Self::Output, Self::Error>;

    /// Does the rest of the work: `stored` is what the store holds of this job and [`Job::is_whole`] refused,
    /// such as the part that was done before an interruption; `store` replaces it at any moment. A job
    /// without parts begins anew. `progress` receives notes for the user.
    ///
    /// # Errors
    /// Whatever ends the whole command.
    fn resume(
        &self,
        stored: Option<Self::Output>,
        store: &dyn Fn(&Self::Output) -> Result<(), Error>,
        progress: &dyn Progress,
        stop: Stop<'_>,
    ) -> Result<Self::Output, Self::Error> {
        let _ = (stored, store, progress);
        self.solve(stop)
    }

    /// Whether its output is stored. Otherwise it is computed again each time, also in the merge of shards.
    fn is_stored(&self) -> bool {
        true
    }

    /// Whether an output that was read back is complete for this job, with its own loads and not a part of
    /// them. Its numbers are finite.
    fn is_whole(&self, output: &Self::Output) -> bool {
        let _ = output;
        true
    }

    /// The key under which its output is stored.
    fn stored_key(&self) -> String {
        Self::KIND.stored_key(&self.key())
    }

    /// Reads an output back; `None` where the text is no whole output of this job.
    fn decode(&self, text: &str) -> Option<Self::Output> {
        Self::KIND.decode(text).filter(|output| self.is_whole(output))
    }

    /// Its whole output, where the store holds it.
    fn stored(&self, store: &Store) -> Option<Self::Output> {
        store.texts(&self.stored_key()).find_map(|text| self.decode(&text))
    }
}

/// A run of jobs: where their results are kept, how many are in progress, who is told and what stops it.
#[derive(Clone, Copy)]
pub struct JobRun<'a> {
    /// Keeps the results.
    pub store: &'a Store,
    /// Number of threads and of jobs in progress.
    pub threads: Threads,
    /// Is told of each job that is done.
    pub progress: &'a dyn Progress,
    /// Whether no further job begins, and those in progress stop.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

impl std::fmt::Debug for JobRun<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("JobRun").field("threads", &self.threads).finish_non_exhaustive()
    }
}

/// Does all jobs that the store does not hold, the most expensive first, and gives the results in the order
/// of `jobs`; `None` where a failure or `stop` came first. The results do not depend on `threads`.
///
/// Each finished job is stored at once, so that an interruption loses only the jobs in progress. Results that
/// another version of the program stored in another format are not used, and `progress` receives one note
/// about them.
///
/// Errors of single jobs are in their places.
#[allow(clippy::type_complexity)] // A list of what became of each job.
pub fn run_stored<J: Job>(
    what: &str,
    jobs: &[J],
    run: JobRun<'_>,
) -> Vec<Option<Result<J::Output, J::Error>>> {
    let order = largest_first(jobs.len(), |i| jobs[i].cost());
    let ordered = Ordered { jobs, order: &order, solved: &|_, _| Ok(()) };
    run_in_order(what, &ordered, run)
}

/// Jobs that begin in an order of their own.
pub struct Ordered<'a, J: Job> {
    /// The jobs.
    pub jobs: &'a [J],
    /// The numbers of the jobs, each once, in the order in which they begin.
    pub order: &'a [usize],
    /// Receives the number and the output of each job as soon as it is done, on the thread that did it; an
    /// error that it returns is that of the job.
    #[allow(clippy::type_complexity)] // A function of a job and its output.
    pub solved: &'a (dyn Fn(usize, &J::Output) -> Result<(), J::Error> + Sync),
}

impl<J: Job> std::fmt::Debug for Ordered<'_, J> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ordered").field("order", &self.order).finish_non_exhaustive()
    }
}

/// As [`run_stored`], in another order than that of the costs.
#[allow(clippy::type_complexity)] // As there.
pub fn run_in_order<J: Job>(
    what: &str,
    ordered: &Ordered<'_, J>,
    run: JobRun<'_>,
) -> Vec<Option<Result<J::Output, J::Error>>> {
    let Ordered { jobs, order, solved } = ordered;
    let JobRun { store, threads, progress, stop } = run;
    store.tell_unused(progress);
    progress.begin(what, jobs.iter().map(Job::cost).sum());
    let done = run_jobs(threads, order, stop, |i, stop| {
        let output = solve_stored(&jobs[i], store, progress, stop)?;
        solved(i, &output)?;
        Ok(output)
    });
    progress.end();
    done
}

/// The output of a job, from the store where it is there.
fn solve_stored<J: Job>(
    job: &J,
    store: &Store,
    progress: &dyn Progress,
    stop: Stop<'_>,
) -> Result<J::Output, J::Error> {
    let key = job.stored_key();
    let mut newest_part = None;
    for output in store.texts(&key).filter_map(|text| J::KIND.decode(&text)) {
        if job.is_whole(&output) {
            progress.advance(job.cost(), true);
            return Ok(output);
        }
        newest_part.get_or_insert(output);
    }
    let save = |output: &J::Output| store.save(&key, &J::KIND.encode(output));
    let output = job.resume(newest_part, &save, progress, stop)?;
    if job.is_stored() {
        save(&output)?;
    }
    progress.advance(job.cost(), false);
    Ok(output)
}

/// Whatever ends a job.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Jobs of one kind with any output, as plans, shards and merges use them.
pub trait JobList: Sync {
    /// Their number.
    fn count(&self) -> usize;
    /// As [`Job::stored_key`].
    fn key(&self, job: usize) -> String;
    /// As [`Job::name`].
    fn name(&self, job: usize) -> String;
    /// As [`Job::cost`], at least 1.
    fn cost(&self, job: usize) -> u64;
    /// As [`Job::memory`].
    fn memory(&self, job: usize) -> f64;
    /// As [`Job::stored_bytes`].
    fn stored_bytes(&self, job: usize) -> u64;
    /// As [`Job::is_stored`].
    fn is_stored(&self, job: usize) -> bool;
    /// Whether the store holds the whole output of this job.
    fn is_done(&self, job: usize, store: &Store) -> bool;
    /// Does those of `which` that the store does not hold, and keeps no output in memory.
    ///
    /// # Errors
    /// The first failure that is not the stop of the others; a stop.
    fn work(
        &self,
        which: &[usize],
        store: &Store,
        threads: Threads,
        progress: &dyn Progress,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<(), Failure>;
}

impl<J: Job> JobList for Vec<J>
where
    J::Error: Into<Failure>,
{
    fn count(&self) -> usize {
        self.len()
    }

    fn key(&self, job: usize) -> String {
        self[job].stored_key()
    }

    fn name(&self, job: usize) -> String {
        self[job].name()
    }

    fn cost(&self, job: usize) -> u64 {
        self[job].cost().max(1)
    }

    fn memory(&self, job: usize) -> f64 {
        self[job].memory()
    }

    fn stored_bytes(&self, job: usize) -> u64 {
        self[job].stored_bytes()
    }

    fn is_stored(&self, job: usize) -> bool {
        self[job].is_stored()
    }

    fn is_done(&self, job: usize, store: &Store) -> bool {
        self[job].stored(store).is_some()
    }

    fn work(
        &self,
        which: &[usize],
        store: &Store,
        threads: Threads,
        progress: &dyn Progress,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<(), Failure> {
        let order = largest_first(which.len(), |i| self[which[i]].cost());
        let done = run_jobs(threads, &order, stop, |i, stop| {
            solve_stored(&self[which[i]], store, progress, stop).map(drop)
        });
        let mut failures: Vec<Failure> =
            done.into_iter().flatten().filter_map(Result::err).map(Into::into).collect();
        // Others that were in flight were told to stop: their reason is not the reason.
        failures.sort_by_key(|failure| is_stop(&**failure));
        failures.into_iter().next().map_or(Ok(()), Err)
    }
}

/// Whether a failure is that of a solve that was stopped.
fn is_stop(failure: &(dyn std::error::Error + 'static)) -> bool {
    let mut chain = std::iter::successors(Some(failure), |error| error.source());
    chain.any(|error| {
        matches!(error.downcast_ref::<contact_model::Error>(), Some(contact_model::Error::Stopped { .. }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::never;

    #[test]
    fn results_are_in_their_places_for_any_number_of_threads() {
        let order = largest_first(7, |i| i % 3);
        assert_eq!(order, [2, 5, 1, 4, 0, 3, 6]);
        for threads in [0, 1, 2, 4] {
            let squares = run_jobs::<_, ()>(Threads::all(threads), &order, &never, |i, _| Ok(i * i));
            assert_eq!(squares.into_iter().flatten().flatten().collect::<Vec<_>>(), [0, 1, 4, 9, 16, 25, 36]);
        }
    }

    #[test]
    fn no_more_jobs_in_flight_than_there_is_memory_for() {
        let (flying, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let order = largest_first(12, |_| 0);
        let done = run_jobs::<_, ()>(Threads { total: 4, jobs: 2 }, &order, &never, |i, _| {
            most.fetch_max(flying.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            std::thread::sleep(std::time::Duration::from_millis(2));
            flying.fetch_sub(1, Ordering::SeqCst);
            Ok((i, rayon::current_num_threads()))
        });
        let threads = 4.min(order.len().max(std::thread::available_parallelism().map_or(1, usize::from)));
        let expected: Vec<_> = (0..12).map(|i| (i, threads)).collect();
        assert_eq!(done.into_iter().flatten().flatten().collect::<Vec<_>>(), expected);
        assert!(most.into_inner() <= 2);
        assert_eq!(on_one_thread(rayon::current_num_threads), 1);
    }

    #[test]
    fn all_results_or_the_reason_why_not() {
        let stopped = || Error::model("a job")(contact_model::Error::Stopped { best: None });
        let wrong = || Error::parameter("cells", 0, "at least 1");
        assert_eq!(collect(vec![Some(Ok(1)), Some(Ok(2))]).unwrap(), [1, 2]);
        let reason = |done| collect::<i32>(done).unwrap_err().to_string();
        assert!(reason(vec![Some(Err(stopped())), Some(Err(wrong())), None]).starts_with("cells = 0"));
        // A shorter list would no longer be in step with the jobs.
        assert!(reason(vec![Some(Ok(1)), None]).starts_with("jobs that were not begun"));
        let failures: [Failure; 2] = [stopped().into(), wrong().into()];
        assert_eq!(failures.map(|failure| is_stop(&*failure)), [true, false]);
    }

    /// Twice its number; stops being worth storing at 2.
    struct Doubled(usize);

    impl Job for Doubled {
        type Output = usize;
        type Error = Error;

        const KIND: ResultKind = ResultKind::new("double", 1);

        fn key(&self) -> String {
            format!("double {}\n", self.0)
        }

        fn name(&self) -> String {
            format!("the double of {}", self.0)
        }

        fn cost(&self) -> u64 {
            1
        }

        fn solve(&self, _: Stop<'_>) -> Result<usize, Error> {
            Ok(2 * self.0)
        }

        fn is_stored(&self) -> bool {
            self.0 < 2
        }

        fn is_whole(&self, output: &usize) -> bool {
            output.is_multiple_of(2)
        }
    }

    /// Counts jobs and those taken from the store.
    #[derive(Default)]
    struct JobCounter(AtomicUsize, AtomicUsize);

    impl Progress for JobCounter {
        fn begin(&self, _: &str, _: u64) {}
        fn advance(&self, _: u64, stored: bool) {
            self.0.fetch_add(1, Ordering::Relaxed);
            self.1.fetch_add(usize::from(stored), Ordering::Relaxed);
        }
        fn end(&self) {}
    }

    #[test]
    fn stored_results_are_taken_and_damaged_ones_computed_again() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path(), false).unwrap();
        let jobs: Vec<Doubled> = (0..3).map(Doubled).collect();
        let run = || {
            let counter = JobCounter::default();
            let run = JobRun { store: &store, threads: Threads::all(2), progress: &counter, stop: &never };
            let done = collect(run_stored("doubles", &jobs, run)).unwrap();
            assert_eq!(done, [0, 2, 4]);
            (counter.0.into_inner(), counter.1.into_inner())
        };
        assert_eq!([run(), run()], [(3, 0), (3, 2)]);
        let text = Doubled::KIND.encode(&2);
        let damaged = ["no number\n".to_owned(), text.replace('1', "2"), text.repeat(2)];
        for bad in damaged.into_iter().chain([Doubled::KIND.encode(&3)]) {
            store.save(&jobs[1].stored_key(), &bad).unwrap();
            assert_eq!([run(), run()], [(3, 1), (3, 2)], "{bad}");
        }
    }

    /// Counts to its number, two steps in a run.
    struct Counted(usize);

    impl Job for Counted {
        type Output = Vec<usize>;
        type Error = Error;

        const KIND: ResultKind = ResultKind::new("count", 1);

        fn key(&self) -> String {
            self.0.to_string()
        }

        fn name(&self) -> String {
            format!("to {}", self.0)
        }

        fn cost(&self) -> u64 {
            1
        }

        fn solve(&self, stop: Stop<'_>) -> Result<Vec<usize>, Error> {
            self.resume(None, &|_| Ok(()), &JobCounter::default(), stop)
        }

        fn resume(
            &self,
            stored: Option<Vec<usize>>,
            store: &dyn Fn(&Vec<usize>) -> Result<(), Error>,
            _: &dyn Progress,
            _: Stop<'_>,
        ) -> Result<Vec<usize>, Error> {
            let mut counted = stored.unwrap_or_default();
            for number in (counted.len()..self.0).take(2) {
                counted.push(number);
                store(&counted)?;
            }
            if self.is_whole(&counted) {
                return Ok(counted);
            }
            Err(Error::model("a count")(contact_model::Error::Stopped { best: None }))
        }

        fn is_whole(&self, counted: &Vec<usize>) -> bool {
            counted.len() == self.0
        }
    }

    #[test]
    fn a_job_goes_on_with_the_part_that_is_stored() {
        let dir = tempfile::tempdir().unwrap();
        let jobs = vec![Counted(5)];
        let run = || {
            let store = Store::open(dir.path(), false).unwrap();
            let counter = JobCounter::default();
            let run = JobRun { store: &store, threads: Threads::all(1), progress: &counter, stop: &never };
            let done = run_stored("counts", &jobs, run);
            (collect(done).ok(), JobList::is_done(&jobs, 0, &store))
        };
        let counted = Some(vec![vec![0, 1, 2, 3, 4]]);
        assert_eq!(
            [(); 4].map(|()| run()),
            [(None, false), (None, false), (counted.clone(), true), (counted, true)]
        );
    }

    #[test]
    fn a_failure_and_a_stop_begin_nothing_more() {
        let order = largest_first(3, |_| 0);
        let failing = run_jobs(Threads::all(1), &order, &never, |i, halt| {
            assert!(!halt.stops());
            if i == 1 { Err("no") } else { Ok(i) }
        });
        assert_eq!(failing, [Some(Ok(0)), Some(Err("no")), None]);
        let stopped = run_jobs::<usize, ()>(Threads::all(1), &order, &|| true, |i, _| Ok(i));
        assert_eq!(stopped, [None, None, None]);
    }
}
