//! State of the shards of a directory.

use super::check::{Completeness, JobState};
use super::plan::ShardPlan;
use super::shard_run::shards;
use crate::error::{Error, Result};
use crate::files;
use crate::jobs::JobList;
use crate::shard::MOST_SHARDS;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;
use std::process::{Command, Stdio};

/// State of a task, according to its engine.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum TaskState {
    Ended(String),
    Waiting,
    Running,
}

/// The finished part of a plan, and the state of the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanStatus {
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
    let text = files::read(&path, 1 << 24).unwrap_or_default();
    let text = String::from_utf8_lossy(&text).into_owned();
    let parse = |line: &str| {
        let mut words = line.split(' ');
        let (engine, job) = (words.next()?.to_owned(), words.next()?.to_owned());
        // It becomes an argument of the engine's programs.
        let plain = !job.is_empty() && job.chars().all(|c| c.is_ascii_digit());
        let count = words.next()?.parse().ok().filter(|count| (1..=MOST_SHARDS).contains(count))?;
        Some(Noted { engine, job, count }).filter(|_| plain)
    };
    text.lines().filter_map(parse).collect()
}

/// The number of shards that the plan of a directory was last submitted in.
pub fn submitted_tasks(out: &Path, plan: &ShardPlan) -> Option<usize> {
    noted(out, plan).last().map(|noted| noted.count)
}

/// The state of each shard of a division into `count`, according to the engines; of several submissions, the
/// one that runs or waits counts. There is a remark for each submission about which the engine gave no
/// answer.
fn tasks(out: &Path, plan: &ShardPlan, count: usize) -> (BTreeMap<usize, TaskState>, Vec<String>) {
    let mut all: BTreeMap<usize, TaskState> = BTreeMap::new();
    let mut silent = Vec::new();
    for noted in noted(out, plan).into_iter().filter(|noted| noted.count == count) {
        let found = noted.ask().unwrap_or_else(|reason| {
            silent.push(reason);
            Vec::new()
        });
        for (shard, state) in found.into_iter().filter(|(shard, _)| *shard < count) {
            let known = all.entry(shard).or_insert_with(|| state.clone());
            if state > *known || matches!(state, TaskState::Ended(_)) && matches!(known, TaskState::Ended(_))
            {
                *known = state;
            }
        }
    }
    (all, silent)
}

/// Shards that an engine is working on, or has in its queue.
///
/// # Errors
/// [`Error::Parameter`] where SLURM does not answer, and where shards of another division are still queued:
/// their jobs would be done twice.
pub(super) fn busy(out: &Path, plan: &ShardPlan, count: usize) -> Result<BTreeSet<usize>> {
    let live = |states: BTreeMap<usize, TaskState>| -> BTreeSet<usize> {
        let live =
            |(shard, state): (usize, TaskState)| (!matches!(state, TaskState::Ended(_))).then_some(shard);
        states.into_iter().filter_map(live).collect()
    };
    let divisions: BTreeSet<usize> =
        noted(out, plan).iter().map(|noted| noted.count).chain([count]).collect();
    let mut busy = BTreeSet::new();
    for division in divisions {
        let (states, silent) = tasks(out, plan, division);
        if let Some(reason) = silent.into_iter().next() {
            let path = ShardPlan::directory(out).join(format!("{}.submitted", plan.digest));
            let expected = format!(
                "an answer about the tasks that are submitted already ({reason}); where none of them is left, remove {}",
                path.display()
            );
            return Err(Error::parameter("engine", "no answer", expected));
        }
        let queued = live(states);
        if division == count {
            busy = queued;
        } else if !queued.is_empty() {
            let expected = format!(
                "{division}, while {} shards of a division into {division} are running or waiting; or cancel those",
                queued.len()
            );
            return Err(Error::parameter("tasks", count, expected));
        }
    }
    Ok(busy)
}

/// The output of a program, or the reason why it gave none.
fn asked(program: &str, arguments: &[&str]) -> Result<String, String> {
    let done = Command::new(program).args(arguments).stdin(Stdio::null()).output();
    let done = done.map_err(|reason| format!("{program}: {reason}"))?;
    if done.status.success() {
        return Ok(String::from_utf8_lossy(&done.stdout).into_owned());
    }
    Err(format!("{program}: {}", String::from_utf8_lossy(&done.stderr).trim()))
}

impl Noted {
    fn ask(&self) -> Result<Vec<(usize, TaskState)>, String> {
        let Self { engine, job, .. } = self;
        if engine == "slurm" {
            // `-r`: one line for each task, those that wait as well; `-t all`: those that have ended too, as
            // long as the controller knows them.
            return match asked("squeue", &["-h", "-r", "-t", "all", "-j", job, "-o", "%K %T"]) {
                Ok(text) => Ok(parse_squeue(&text)),
                // It has ended long ago.
                Err(reason) if reason.contains("Invalid job id") => Ok(Vec::new()),
                Err(reason) => Err(reason),
            };
        }
        // A server that was started anew knows nothing of the tasks of the one before.
        let text = asked("hq", &["--output-mode", "json", "task", "list", job]).unwrap_or_default();
        Ok(parse_hyperqueue(&text))
    }
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

/// The status of a plan. Where shards were submitted, the engine is queried about those that are not done.
pub fn status(found: &Completeness, jobs: &dyn JobList, out: &Path) -> PlanStatus {
    let plan = &found.plan;
    let count = submitted_tasks(out, plan);
    let ((states, silent), of) = match count {
        Some(count) => (tasks(out, plan, count), shards(jobs, count)),
        None => ((BTreeMap::new(), Vec::new()), vec![None; jobs.count()]),
    };
    let cost = |job: usize| jobs.cost(job) as f64;
    let all: f64 = (0..jobs.count()).map(cost).sum();
    let mut status = PlanStatus {
        command: plan.command(),
        digest: plan.short_digest(),
        jobs: jobs.count(),
        done: found.count(JobState::Done),
        share: 0.0,
        running: Group::default(),
        waiting: Group::default(),
        failed: Group::default(),
        reasons: BTreeSet::new(),
        missing: 0,
        remarks: found.remarks().into_iter().chain(silent).collect(),
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
            // It ended well, and its result is gone.
            TaskState::Ended(reason) if ["completed", "finished"].contains(&reason.as_str()) => {
                status.missing += 1;
                continue;
            }
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

impl PlanStatus {
    /// Whether all jobs are done.
    pub fn complete(&self) -> bool {
        self.done == self.jobs
    }
}

impl fmt::Display for PlanStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} (plan {})", self.command, self.digest)?;
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
    use crate::cluster::{ShardRun, check, run_shard};
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
        run_shard(
            &plan,
            &squares,
            Shard { index: 0, count: 2 },
            ShardRun { out: dir.path(), threads: 1, progress: &Silent, stop: &never },
        )
        .unwrap();
        let found = check(&plan, &squares, dir.path()).unwrap();
        let text = status(&found, &squares, dir.path()).to_string();
        assert!(
            text.contains("done          2 of 4 jobs, 50 %") && text.ends_with("missing       2"),
            "{text}"
        );
        // Words that are no number are not given to an engine.
        let submitted = ShardPlan::directory(dir.path()).join(format!("{}.submitted", plan.digest));
        std::fs::write(
            submitted,
            "slurm 1;reboot 2\nnonsense\nslurm  1\nslurm 1 0\nslurm 1 18446744073709551615\n",
        )
        .unwrap();
        assert!(noted(dir.path(), &plan).is_empty() && submitted_tasks(dir.path(), &plan).is_none());
    }
}
