//! Forecast of the cores, the memory, the time and the disk space that a plan needs.

use super::shard_run::shards;
use crate::amounts::{duration, memory};
use crate::error::{Error, Result};
use crate::jobs::JobList;
use crate::shard::assign;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fmt;

/// Memory that a core of a cluster has as a rule, bytes: a task that needs more takes the cores that belong
/// to it.
const MEMORY_OF_CORE: f64 = 4e9;
/// Largest number of cores of one task: two threads in one solve were measured to be 1.45 to 1.8 times as
/// fast as one on 2049 cells a side (data/bench/threads.csv), and the memory of a core would be idle
/// otherwise.
const MOST_CORES: usize = 4;
/// Intended duration of a task in seconds: its start is then negligible, and little is lost if it fails.
const TASK: f64 = 3600.0;
/// Default limit of the number of tasks, which is SLURM's own limit of an array.
const MOST_TASKS: usize = 1000;
/// Memory of the program itself, bytes.
const PROGRAM: f64 = 200e6;
/// Ratio of the requested to the predicted time: machines differ by a factor of three, and a task that is cut
/// off loses the jobs in progress.
const MARGIN: f64 = 3.0;
/// Smallest requested time in seconds.
const LEAST_TIME: f64 = 600.0;

/// Division of a plan into tasks; defaults follow from its jobs.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct Division {
    /// Tasks that the jobs are divided into [default: one for each predicted hour of a core, at most 1000].
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", value_parser = at_least_one))]
    pub tasks: Option<usize>,
    /// Cores of a task [default: 1, and more where one solve needs the memory of several cores, 4 GB each].
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", value_parser = at_least_one))]
    pub cores: Option<usize>,
}

#[cfg(feature = "clap")]
fn at_least_one(text: &str) -> std::result::Result<usize, String> {
    let number: usize = text.parse().map_err(|_| "expected a whole number from 1".to_owned())?;
    if (1..=crate::MOST_SHARDS).contains(&number) {
        Ok(number)
    } else {
        Err(format!("expected a whole number from 1 to {}", crate::MOST_SHARDS))
    }
}

/// Resources that a plan needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// Jobs that are stored.
    pub jobs: usize,
    /// Tasks.
    pub tasks: usize,
    /// Cores of a task.
    pub cores: usize,
    /// Memory of a task, bytes.
    pub memory: f64,
    /// Processor seconds of all jobs, of the longest task and of the longest job.
    pub seconds: [f64; 3],
    /// Bytes of the results.
    pub disk: u64,
    /// Predicted seconds of each job.
    costs: Vec<f64>,
    /// How the times were found, and their accuracy.
    basis: &'static str,
}

impl Forecast {
    /// The forecast for a list of jobs.
    pub fn new(jobs: &dyn JobList, division: &Division) -> Self {
        let stored: Vec<usize> = (0..jobs.count()).filter(|&job| jobs.is_stored(job)).collect();
        let costs: Vec<u64> = stored.iter().map(|&job| jobs.cost(job)).collect();
        let total = 1e-3 * costs.iter().sum::<u64>() as f64;
        let tasks = division.tasks.unwrap_or_else(|| ((total / TASK).ceil() as usize).clamp(1, MOST_TASKS));
        let tasks = tasks.min(stored.len().max(1));
        let largest = stored.iter().map(|&job| jobs.memory(job)).fold(0.0, f64::max);
        let wanted = (largest / MEMORY_OF_CORE).ceil() as usize;
        let cores = division.cores.unwrap_or_else(|| wanted.clamp(1, MOST_CORES));
        // As many jobs side by side as have a core each, unless one takes the memory of them all.
        let in_flight = if wanted > 1 { (cores / wanted).max(1) } else { cores };
        let mut loads = vec![0; tasks];
        for (job, shard) in shards(jobs, tasks).into_iter().enumerate() {
            if let Some(shard) = shard {
                loads[shard] += jobs.cost(job);
            }
        }
        let longest = |of: &[u64]| 1e-3 * of.iter().copied().max().unwrap_or(0) as f64;
        Self {
            jobs: stored.len(),
            tasks,
            cores,
            memory: 1.2 * in_flight as f64 * largest + PROGRAM,
            seconds: [total, longest(&loads), longest(&costs)],
            disk: stored.iter().map(|&job| jobs.stored_bytes(job)).sum(),
            costs: costs.iter().map(|&cost| 1e-3 * cost as f64).collect(),
            basis: "predicted for one core of the machine of data/bench, within a factor of two; machines differ by a factor of three",
        }
    }

    /// The same forecast with a known time of all jobs together, in seconds.
    #[must_use]
    pub fn measured(mut self, total: f64, basis: &'static str) -> Self {
        let factor = total / self.seconds[0];
        if factor.is_finite() {
            self.seconds = self.seconds.map(|seconds| factor * seconds);
            self.costs.iter_mut().for_each(|seconds| *seconds *= factor);
            self.basis = basis;
        }
        self
    }

    /// Time limit of a task to request from an engine, in whole minutes.
    pub fn minutes(&self) -> u64 {
        ((MARGIN * self.seconds[1]).max(LEAST_TIME) / 60.0).ceil() as u64
    }

    /// Memory of a task to request from an engine, in whole megabytes.
    pub fn megabytes(&self) -> u64 {
        (self.memory / 1e6).ceil() as u64
    }

    /// Number of tasks that run at the same time on `nodes` nodes, each with `cores` cores and, where given,
    /// `memory` bytes.
    fn at_once(&self, nodes: usize, cores: usize, memory: Option<f64>) -> usize {
        let by_memory = memory.map_or(usize::MAX, |memory| (memory / self.memory) as usize);
        nodes * (cores / self.cores).min(by_memory)
    }

    /// The forecast in words, with the makespan on `nodes` nodes, each with `cores` cores and, where given,
    /// `memory` bytes.
    ///
    /// # Errors
    /// [`Error::Parameter`] for nodes that hold no task.
    pub fn on_nodes(&self, nodes: usize, cores: usize, memory: Option<f64>) -> Result<String> {
        let at_once = self.at_once(nodes, cores, memory);
        if at_once == 0 {
            let expected =
                format!("nodes that hold a task of {} cores and {} MB", self.cores, self.megabytes());
            return Err(Error::parameter("node-cores", cores, expected));
        }
        let makespan = duration(self.makespan(at_once));
        Ok(format!(
            "{self}\nmakespan    {makespan} on {nodes} nodes of {cores} cores, {at_once} tasks at a time"
        ))
    }

    /// Predicted seconds until the last of the tasks has ended, with `at_once` tasks at the same time.
    fn makespan(&self, at_once: usize) -> f64 {
        // Microseconds, because floats have no order.
        let costs: Vec<u64> = self.costs.iter().map(|seconds| (1e6 * seconds) as u64).collect();
        let mut tasks = vec![0; self.tasks.max(1)];
        for (task, cost) in assign(&costs, tasks.len()).into_iter().zip(&costs) {
            tasks[task] += cost;
        }
        // The engine gives the next task in their order to the first place that is free.
        let places = at_once.clamp(1, tasks.len());
        let mut free: BinaryHeap<Reverse<u64>> = (0..places).map(|_| Reverse(0)).collect();
        for task in tasks {
            let Some(Reverse(now)) = free.pop() else { break };
            free.push(Reverse(now + task));
        }
        free.into_iter().map(|Reverse(end)| end).max().unwrap_or(0) as f64 * 1e-6
    }
}

impl fmt::Display for Forecast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [total, task, job] = self.seconds;
        writeln!(f, "jobs        {}, the longest {}", self.jobs, duration(job))?;
        writeln!(f, "core-hours  {:.2}", total / 3600.0)?;
        writeln!(
            f,
            "tasks       {} of {} cores and {}, the longest {}",
            self.tasks,
            self.cores,
            memory(self.memory),
            duration(task)
        )?;
        writeln!(f, "disk        {}", memory(self.disk as f64))?;
        write!(f, "({})", self.basis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cluster::tests_support::Squares;

    #[test]
    fn the_makespan_by_hand() {
        // 3 + 3 against 2 + 2 + 2, and the longest job beside as many places as one likes.
        let of = |costs: &[f64], tasks: usize| Forecast {
            jobs: costs.len(),
            tasks,
            costs: costs.to_vec(),
            ..Forecast::new(&Squares::to(1), &Division::default())
        };
        approx::assert_relative_eq!(of(&[3.0, 3.0, 2.0, 2.0, 2.0], 2).makespan(2), 7.0);
        approx::assert_relative_eq!(of(&[3.0, 3.0, 2.0, 2.0, 2.0], 5).makespan(2), 7.0);
        approx::assert_relative_eq!(of(&[3.0, 3.0, 2.0], 100).makespan(100), 3.0);
    }

    #[test]
    #[allow(clippy::float_cmp)] // Sums of whole seconds.
    fn forecasts_by_hand() {
        // Seven jobs of a second.
        let squares = Squares::to(7);
        let all = Forecast::new(&squares, &Division::default());
        assert_eq!((all.jobs, all.tasks, all.cores, all.minutes(), all.megabytes()), (7, 1, 1, 10, 200));
        assert_eq!(all.seconds, [7.0, 7.0, 1.0]);
        let three = Forecast::new(&squares, &Division { tasks: Some(3), cores: Some(2) });
        assert_eq!((three.seconds, three.cores), ([7.0, 3.0, 1.0], 2));
        assert_eq!((three.makespan(1), three.makespan(2), three.makespan(100)), (7.0, 4.0, 3.0));
        assert_eq!((three.at_once(4, 64, None), three.at_once(4, 64, Some(1e9))), (128, 20));
        // No more tasks than jobs.
        assert_eq!(Forecast::new(&squares, &Division { tasks: Some(99), cores: None }).tasks, 7);
        assert!(all.to_string().starts_with("jobs        7, the longest 1 s\ncore-hours  0.00\n"), "{all}");
    }
}
