//! One shard of a plan.

use super::plan::ShardPlan;
use crate::error::{Error, Result};
use crate::jobs::{Failure, JobList, Threads};
use crate::meters::threads_for_memory;
use crate::progress::Progress;
use crate::shard::{Shard, assign};
use crate::store::Store;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Summary of the work of a shard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShardReport {
    /// The shard.
    pub shard: Shard,
    /// Number of its jobs.
    pub jobs: usize,
    /// Number of all jobs of the plan.
    pub of: usize,
}

impl fmt::Display for ShardReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "shard {}: {} of the {} jobs are done and stored", self.shard, self.jobs, self.of)
    }
}

/// Jobs of a shard that are stored.
pub(super) fn members(jobs: &dyn JobList, shard: Shard) -> Vec<usize> {
    let of = shards(jobs, shard.count);
    (0..jobs.count()).filter(|&job| of[job] == Some(shard.index)).collect()
}

/// The shard of each job; `None` for jobs that are not stored.
pub(super) fn shards(jobs: &dyn JobList, count: usize) -> Vec<Option<usize>> {
    let stored: Vec<usize> = (0..jobs.count()).filter(|&job| jobs.is_stored(job)).collect();
    let costs: Vec<u64> = stored.iter().map(|&job| jobs.cost(job)).collect();
    let mut of = vec![None; jobs.count()];
    for (&job, shard) in stored.iter().zip(assign(&costs, count)) {
        of[job] = Some(shard);
    }
    of
}

/// Where a shard is done, with how many threads, who is told and what stops it.
#[derive(Clone, Copy)]
pub struct ShardRun<'a> {
    /// The folder of the results, which other shards may share.
    pub out: &'a Path,
    /// Number of threads.
    pub threads: usize,
    /// Is told of each job that is done.
    pub progress: &'a dyn Progress,
    /// Whether no further job begins, and those in progress stop.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

impl fmt::Debug for ShardRun<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ShardRun")
            .field("out", &self.out)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// Does the jobs of a shard that the store of its folder does not hold, the most expensive first, as many at a
/// time as there are threads and memory. Other shards may run at the same time, here or elsewhere.
///
/// # Errors
/// The first failure; what was done before is stored.
pub fn run_shard(
    plan: &ShardPlan,
    jobs: &dyn JobList,
    shard: Shard,
    run: ShardRun<'_>,
) -> Result<ShardReport, Failure> {
    let ShardRun { out, threads, progress, stop } = run;
    let store = Store::open_shared(out, &plan.digest, shard)?;
    plan.write(out)?;
    let mine = members(jobs, shard);
    // Jobs that leave room for as many others are done together, the largest first.
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &job in &mine {
        let room = threads_for_memory(threads, jobs.memory(job), "job", jobs.name(job))?;
        groups.entry(room).or_default().push(job);
    }
    let what = format!("shard {shard}: {} of {} jobs", mine.len(), jobs.count());
    store.tell_unused(progress);
    progress.begin(&what, mine.iter().map(|&job| jobs.cost(job)).sum());
    for (room, group) in groups {
        jobs.work(&group, &store, Threads { total: threads, jobs: room }, progress, stop)?;
    }
    progress.end();
    drop(store);
    let stored = Store::open_shared(out, &plan.digest, shard)?;
    if !stop()
        && let Some(&lost) = mine.iter().find(|&&job| !stored.has(&jobs.key(job)))
    {
        let expected = "the results that this shard has just stored; somebody removed them";
        return Err(
            Error::parameter("out", format!("{}: {}", out.display(), jobs.name(lost)), expected).into()
        );
    }
    Ok(ShardReport { shard, jobs: mine.len(), of: jobs.count() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cluster::tests_support::Squares;
    use crate::{Silent, cluster};
    use contact_model::never;

    fn plan(jobs: &dyn JobList) -> ShardPlan {
        ShardPlan::new("p", vec!["squares".into()], jobs)
    }

    #[test]
    fn shards_do_every_job_once() {
        let dir = tempfile::tempdir().unwrap();
        let squares = Squares::to(7);
        for index in [2, 0, 1] {
            let shard = Shard { index, count: 3 };
            let report = run_shard(
                &plan(&squares),
                &squares,
                shard,
                ShardRun { out: dir.path(), threads: 2, progress: &Silent, stop: &never },
            )
            .unwrap();
            assert!(report.to_string().starts_with(&format!("shard {index}/3: ")), "{report}");
        }
        assert_eq!(squares[0].solved(), 7);
        // Once more, and undivided: nothing is solved again.
        for shard in [Shard { index: 1, count: 3 }, Shard { index: 0, count: 1 }] {
            run_shard(
                &plan(&squares),
                &squares,
                shard,
                ShardRun { out: dir.path(), threads: 1, progress: &Silent, stop: &never },
            )
            .unwrap();
        }
        assert_eq!(squares[0].solved(), 7);
        let found = cluster::check(&plan(&squares), &squares, dir.path()).unwrap();
        assert!(found.require(dir.path(), false, "p").is_ok());
    }

    #[test]
    fn a_stop_and_a_full_directory_lose_nothing_that_was_done() {
        let dir = tempfile::tempdir().unwrap();
        let squares = Squares::to(6);
        let one = Shard { index: 0, count: 1 };
        let stopped = || squares[0].solved() >= 2;
        run_shard(
            &plan(&squares),
            &squares,
            one,
            ShardRun { out: dir.path(), threads: 1, progress: &Silent, stop: &stopped },
        )
        .unwrap();
        assert_eq!((squares[0].solved(), Store::count(dir.path())), (2, 2));
        run_shard(
            &plan(&squares),
            &squares,
            one,
            ShardRun { out: dir.path(), threads: 1, progress: &Silent, stop: &never },
        )
        .unwrap();
        assert_eq!(squares[0].solved(), 6);
    }
}
