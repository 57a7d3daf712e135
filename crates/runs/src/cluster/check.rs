//! Completeness of a plan: which of its jobs are done, missing or damaged.

use super::plan::ShardPlan;
use crate::error::{Error, Result};
use crate::files;
use crate::jobs::JobList;
use crate::store::{Pack, Store, fnv1a_128};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// State of a job in the store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobState {
    /// The store has a whole result.
    Done,
    /// The store has data of it that are no whole result.
    Damaged,
    /// The store has nothing of it.
    Missing,
}

/// State of a plan in the store.
#[derive(Debug, Clone)]
pub struct Completeness {
    /// The plan.
    pub plan: ShardPlan,
    /// State of each job. Jobs that are never stored count as done.
    pub states: Vec<JobState>,
    /// Names of the jobs that are not done, in their order.
    pub missing: Vec<String>,
    /// Numbers of results of the plan, by the vector instructions of the processors that computed them.
    pub instructions: BTreeMap<String, usize>,
    /// Packs with bytes that belong to no result, and their number.
    pub damaged_packs: Vec<(String, u64)>,
    /// Packs of other plans, with results that do not belong to this one.
    pub foreign: Vec<String>,
}

/// Reads every result of a plan and checks that it is whole.
///
/// # Errors
/// [`Error::Parameter`] where the jobs are not those of the plan; [`Error::File`] for a directory that cannot
/// be read.
pub fn check(plan: &ShardPlan, jobs: &dyn JobList, out: &Path) -> Result<Completeness> {
    let now = ShardPlan::new(&plan.program, plan.arguments.clone(), jobs);
    if now.digest != plan.digest {
        let expected = format!(
            "the jobs that `{}` has now: its scene, a file of it or the program was changed since (this is plan {})",
            plan.command(),
            now.digest
        );
        return Err(Error::parameter("plan", &plan.digest, expected));
    }
    let store = Store::view(out)?;
    let states: Vec<JobState> = (0..jobs.count())
        .into_par_iter()
        .map(|job| {
            if !jobs.is_stored(job) || jobs.is_done(job, &store) {
                JobState::Done
            } else if store.has(&jobs.key(job)) {
                JobState::Damaged
            } else {
                JobState::Missing
            }
        })
        .collect();
    let missing = states.iter().enumerate().filter(|(_, state)| **state != JobState::Done);
    let missing = missing.map(|(job, _)| jobs.name(job)).collect();
    let mine: HashSet<u128> = (0..jobs.count()).map(|job| fnv1a_128(jobs.key(job).as_bytes())).collect();
    let mut found = Completeness {
        plan: plan.clone(),
        states,
        missing,
        instructions: BTreeMap::new(),
        damaged_packs: Vec::new(),
        foreign: Vec::new(),
    };
    for Pack { path, head, results, damaged_bytes } in Store::packs(out)? {
        let own = results.iter().filter(|hash| mine.contains(hash)).count();
        if own > 0 {
            *found.instructions.entry(head.instructions).or_default() += own;
        }
        let name = || path.display().to_string();
        if damaged_bytes > 0 {
            found.damaged_packs.push((name(), damaged_bytes));
        }
        // A run that was not sharded may share its directory with others, as ever.
        if head.plan.is_some_and(|theirs| theirs != plan.digest) && own < results.len() {
            found.foreign.push(name());
        }
    }
    Ok(found)
}

/// Names that are listed before "and N more".
const LISTED: usize = 20;

impl Completeness {
    /// Jobs in this state.
    pub fn count(&self, state: JobState) -> usize {
        self.states.iter().filter(|found| **found == state).count()
    }

    /// Remarks, one a line, on results that are whole but were computed under different conditions, and on
    /// damaged packs.
    pub fn remarks(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.instructions.len() > 1 {
            let sets = self.instructions.iter().map(|(set, count)| format!("{count} with [{set}]"));
            lines.push(format!(
                "results of processors with different vector instructions: {}; they agree within their tolerances, not to the last digit",
                sets.collect::<Vec<_>>().join(", ")
            ));
        }
        for (pack, bytes) in &self.damaged_packs {
            lines.push(format!(
                "{pack}: {bytes} bytes belong to no whole result (a task was killed, or the file is damaged)"
            ));
        }
        lines
    }

    /// Refuses a plan with jobs that are not done, and one beside results of other plans unless it was
    /// `chosen` explicitly.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the list of jobs (a long one is in a file, which it names) and the command
    /// that computes them.
    pub fn require(&self, out: &Path, chosen: bool, again: &str) -> Result<()> {
        if !self.missing.is_empty() {
            let (damaged, missing) = (self.count(JobState::Damaged), self.count(JobState::Missing));
            let mut list = String::new();
            for name in self.missing.iter().take(LISTED) {
                list += &format!("\n  {name}");
            }
            if self.missing.len() > LISTED {
                let path = ShardPlan::directory(out).join(format!("{}.missing", self.plan.digest));
                files::write_whole(&path, (self.missing.join("\n") + "\n").as_bytes())?;
                list += &format!("\n  and {} more: {}", self.missing.len() - LISTED, path.display());
            }
            let mut expected = format!(
                "whole results of all {} jobs of `{}`; {missing} are missing and {damaged} damaged:{list}\ncompute them with: {again}",
                self.states.len(),
                self.plan.command()
            );
            for line in self.remarks() {
                expected += &format!("\nnote: {line}");
            }
            return Err(Error::parameter("out", out.display(), expected));
        }
        if !chosen && !self.foreign.is_empty() {
            let expected = format!(
                "results of the plan of `{}` alone; {} are of another plan: move them away, or choose this plan with --plan {}",
                self.plan.command(),
                self.foreign.join(", "),
                self.plan.short_digest()
            );
            return Err(Error::parameter("out", out.display(), expected));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cluster::tests_support::Squares;
    use crate::cluster::{ShardRun, run_shard};
    use crate::{Shard, Silent};
    use contact_model::never;

    #[test]
    fn gaps_damage_and_other_plans_are_told() {
        let dir = tempfile::tempdir().unwrap();
        let squares = Squares::to(6);
        let plan = ShardPlan::new("p", vec!["squares".into()], &squares);
        let work = |index| {
            run_shard(
                &plan,
                &squares,
                Shard { index, count: 2 },
                ShardRun { out: dir.path(), threads: 1, progress: &Silent, stop: &never },
            )
            .unwrap();
        };
        let found = || check(&plan, &squares, dir.path()).unwrap();
        let refused = || found().require(dir.path(), false, "p squares --shard 1/2").unwrap_err().to_string();
        work(0);
        assert_eq!((found().count(JobState::Done), found().missing.len()), (3, 3));
        let gaps = refused();
        assert!(gaps.contains("3 are missing and 0 damaged") && gaps.contains("the square of "), "{gaps}");
        assert!(gaps.contains("compute them with: p squares --shard 1/2"), "{gaps}");
        work(1);
        found().require(dir.path(), false, "").unwrap();
        assert!(found().remarks().is_empty());
        // Damage in the middle of a pack: one job is to be done again, the others stay.
        let path = Store::packs(dir.path()).unwrap().remove(0).path;
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replacen("# the square", "# the squire", 1)).unwrap();
        assert!(refused().contains("0 are missing and 1 damaged"), "{}", refused());
        work(0);
        found().require(dir.path(), false, "").unwrap();
        // A pack cut short is told, though another holds its result.
        std::fs::write(&path, &text[..text.len() - 5]).unwrap();
        assert!(refused().contains("bytes belong to no whole result"), "{}", refused());
        work(0);
        found().require(dir.path(), false, "").unwrap();
        assert_eq!(found().remarks().len(), 1);
        // Another processor.
        std::fs::write(&path, text.replacen("# instructions", "# instructions vax", 1)).unwrap();
        assert!(found().remarks()[0].contains("different vector instructions"), "{:?}", found().remarks());
        // A pack of another plan.
        let other = Squares::to(9);
        let theirs = ShardPlan::new("p", vec!["squares".into(), "9".into()], &other);
        run_shard(
            &theirs,
            &other,
            Shard { index: 0, count: 1 },
            ShardRun { out: dir.path(), threads: 1, progress: &Silent, stop: &never },
        )
        .unwrap();
        assert!(refused().contains("are of another plan"), "{}", refused());
        found().require(dir.path(), true, "").unwrap();
        // The jobs changed since.
        let changed = check(&plan, &other, dir.path()).unwrap_err().to_string();
        assert!(changed.contains("was changed since"), "{changed}");
    }
}
