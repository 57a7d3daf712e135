//! What becomes of the shards of a directory.

use super::check::{Completeness, JobState};
use super::plan::ShardPlan;
use super::shard_run::shards;
use crate::jobs::JobList;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;
use std::process::{Command, Stdio};

/// What an engine says of a task.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum TaskState {
    Ended(String),
    Waiting,
    Running,
}

/// What is done of a plan, and what becomes of the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    command: String,
    digest: String,
    jobs: usize,
    done: usize,
    /// Share of the predicted time that is done.
    share: f64,
    running: Group,
    waiting: Group,
    /// With what the engine said of their tasks.
    failed: Group,
    reasons: BTreeSet<String>,
    missing: usize,
    remarks: Vec<String>,
}

/// Jobs that are not done, and the shards that they are in.
#[derive(Debug, Clone, PartialEq, Default)]
struct Group {
    jobs: usize,
    shards: BTreeSet<usize>,
}

/// A submission that `submit.sh` noted.
struct Noted {
    engine: String,
    job: String,
    count: usize,
}

fn noted(out: &Path, plan: &ShardPlan) -> Vec<Noted> {
    let path = ShardPlan::directory(out).join(format!("{}.submitted", plan.digest));
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let parse = |line: &str| {
        let mut words = line.split(' ');
        let (engine, job) = (words.next()?.to_owned(), words.next()?.to_owned());
        // It becomes an argument of the engine's programs.
        let plain = job.chars().all(|c| c.is_ascii_digit());
        Some(Noted { engine, job, count: words.next()?.parse().ok()? }).filter(|_| plain)
    };
    text.lines().filter_map(parse).collect()
}

/// The number of shards that the plan of a directory was last submitted in.
pub fn submitted_tasks(out: &Path, plan: &ShardPlan) -> Option<usize> {
    noted(out, plan).last().map(|noted| noted.count)
}

/// What the engines say of each shard of a division into `count`; of several submissions, what is running or waiting counts.
fn tasks(out: &Path, plan: &ShardPlan, count: usize) -> BTreeMap<usize, TaskState> {
    let mut all: BTreeMap<usize, TaskState> = BTreeMap::new();
    for Noted { engine, job, count: divided } in noted(out, plan) {
        if divided != count {
            continue;
        }
        let found = if engine == "slurm" { slurm(&job) } else { hyperqueue(&job) };
        for (shard, state) in found.into_iter().filter(|(shard, _)| *shard < count) {
            let known = all.entry(shard).or_insert_with(|| state.clone());
            if state > *known || matches!(state, TaskState::Ended(_)) && matches!(known, TaskState::Ended(_))
            {
                *known = state;
            }
        }
    }
    all
}

/// Shards that an engine is working on, or has in its queue.
pub(super) fn busy(out: &Path, plan: &ShardPlan, count: usize) -> BTreeSet<usize> {
    let busy = |(shard, state): (usize, TaskState)| (!matches!(state, TaskState::Ended(_))).then_some(shard);
    tasks(out, plan, count).into_iter().filter_map(busy).collect()
}

/// What a program prints; nothing where it cannot be asked.
fn asked(program: &str, arguments: &[&str]) -> String {
    let done = Command::new(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output();
    done.map(|done| String::from_utf8_lossy(&done.stdout).into_owned()).unwrap_or_default()
}

fn slurm(job: &str) -> Vec<(usize, TaskState)> {
    // `-r`: one line for each task, those that wait as well; `-t all`: those that have ended too, as long as the controller knows them.
    parse_squeue(&asked("squeue", &["-h", "-r", "-t", "all", "-j", job, "-o", "%K %T"]))
}

fn parse_squeue(text: &str) -> Vec<(usize, TaskState)> {
    let state = |word: &str| match word {
        "PENDING" | "REQUEUED" | "SUSPENDED" => TaskState::Waiting,
        "RUNNING" | "COMPLETING" | "CONFIGURING" => TaskState::Running,
        ended => TaskState::Ended(ended.to_lowercase()),
    };
    let parse = |line: &str| {
        let (task, word) = line.trim().split_once(' ')?;
        Some((task.parse().ok()?, state(word)))
    };
    text.lines().filter_map(parse).collect()
}

fn hyperqueue(job: &str) -> Vec<(usize, TaskState)> {
    parse_hyperqueue(&asked("hq", &["--output-mode", "json", "task", "list", job]))
}

/// Tasks are objects with `id` and `state`, in lists by job or in one.
fn parse_hyperqueue(text: &str) -> Vec<(usize, TaskState)> {
    fn collect(value: &serde_json::Value, all: &mut Vec<(usize, TaskState)>) {
        if let (Some(id), Some(state)) = (value["id"].as_u64(), value["state"].as_str()) {
            let state = match state.to_lowercase().as_str() {
                "running" => TaskState::Running,
                "waiting" => TaskState::Waiting,
                other => TaskState::Ended(other.to_owned()),
            };
            all.push((usize::try_from(id).unwrap_or(usize::MAX), state));
            return;
        }
        if let Some(list) = value.as_array() {
            for value in list {
                collect(value, all);
            }
        }
        if let Some(object) = value.as_object() {
            for value in object.values() {
                collect(value, all);
            }
        }
    }
    let mut all = Vec::new();
    if let Ok(value) = serde_json::from_str(text) {
        collect(&value, &mut all);
    }
    all
}

/// What is done of a plan; where shards were submitted, the engine is asked what becomes of the others.
pub fn status(found: &Completeness, jobs: &dyn JobList, out: &Path) -> Status {
    let plan = &found.plan;
    let count = submitted_tasks(out, plan);
    let (states, of) = match count {
        Some(count) => (tasks(out, plan, count), shards(jobs, count)),
        None => (BTreeMap::new(), vec![None; jobs.count()]),
    };
    let cost = |job: usize| jobs.cost(job) as f64;
    let all: f64 = (0..jobs.count()).map(cost).sum();
    let mut status = Status {
        command: plan.command(),
        digest: plan.digest.clone(),
        jobs: jobs.count(),
        done: found.count(JobState::Done),
        share: 0.0,
        running: Group::default(),
        waiting: Group::default(),
        failed: Group::default(),
        reasons: BTreeSet::new(),
        missing: 0,
        remarks: found.remarks(),
    };
    for (job, shard) in of.into_iter().enumerate() {
        if found.states[job] == JobState::Done {
            status.share += cost(job) / all;
            continue;
        }
        let Some((shard, state)) = shard.and_then(|shard| Some((shard, states.get(&shard)?))) else {
            status.missing += 1;
            continue;
        };
        let group = match state {
            TaskState::Running => &mut status.running,
            TaskState::Waiting => &mut status.waiting,
            TaskState::Ended(reason) => {
                status.reasons.insert(reason.clone());
                &mut status.failed
            }
        };
        group.jobs += 1;
        group.shards.insert(shard);
    }
    status
}

impl Status {
    /// Whether all jobs are done.
    pub fn complete(&self) -> bool {
        self.done == self.jobs
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} (plan {})", self.command, &self.digest[..12.min(self.digest.len())])?;
        writeln!(
            f,
            "  done     {:>6} of {} jobs, {:.0} % of the predicted time",
            self.done,
            self.jobs,
            100.0 * self.share
        )?;
        for (name, group) in
            [("running", &self.running), ("waiting", &self.waiting), ("failed", &self.failed)]
        {
            let list: Vec<String> = group.shards.iter().take(20).map(usize::to_string).collect();
            let more = if group.shards.len() > 20 { ", ..." } else { "" };
            let shards =
                if list.is_empty() { String::new() } else { format!("  shards {}{more}", list.join(", ")) };
            let reasons: Vec<&str> = self.reasons.iter().map(String::as_str).collect();
            let why = if name == "failed" && !reasons.is_empty() {
                format!(" ({})", reasons.join(", "))
            } else {
                String::new()
            };
            writeln!(f, "  {name:<8} {:>6}{shards}{why}", group.jobs)?;
        }
        write!(f, "  missing  {:>6}", self.missing)?;
        for remark in &self.remarks {
            write!(f, "\n  note: {remark}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cluster::tests_support::Squares;
    use crate::cluster::{check, run_shard};
    use crate::{Shard, Silent};
    use contact_model::never;

    #[test]
    fn engines_are_understood() {
        assert_eq!(
            parse_squeue("3 PENDING\n0 RUNNING\nN/A PENDING\n1 TIMEOUT\n"),
            [(3, TaskState::Waiting), (0, TaskState::Running), (1, TaskState::Ended("timeout".into()))]
        );
        let hq = r#"{"1": [{"id": 0, "state": "running"}, {"id": 1, "state": "FAILED"}, {"id": 2, "state": "waiting"}]}"#;
        assert_eq!(
            parse_hyperqueue(hq),
            [(0, TaskState::Running), (1, TaskState::Ended("failed".into())), (2, TaskState::Waiting)]
        );
        assert_eq!((parse_hyperqueue("no json").len(), parse_squeue("").len()), (0, 0));
    }

    #[test]
    fn without_an_engine_there_is_done_and_missing() {
        let dir = tempfile::tempdir().unwrap();
        let squares = Squares::to(4);
        let plan = ShardPlan::new("p", vec!["squares".into()], &squares);
        run_shard(&plan, &squares, Shard { index: 0, count: 2 }, (dir.path(), 1), &Silent, &never).unwrap();
        let found = check(&plan, &squares, dir.path()).unwrap();
        let text = status(&found, &squares, dir.path()).to_string();
        assert!(
            text.contains("done          2 of 4 jobs, 50 %") && text.ends_with("missing       2"),
            "{text}"
        );
        // Words that are no number are not given to an engine.
        let submitted = ShardPlan::directory(dir.path()).join(format!("{}.submitted", plan.digest));
        std::fs::write(submitted, "slurm 1;reboot 2\nnonsense\n").unwrap();
        assert!(noted(dir.path(), &plan).is_empty() && submitted_tasks(dir.path(), &plan).is_none());
    }
}
