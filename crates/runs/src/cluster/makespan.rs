//! How long a plan takes on many cores: its jobs replayed with the times that they were measured to take.

use crate::shard::assign;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The machines of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Cores; each does one task at a time.
    pub cores: usize,
    /// Tasks that the jobs are divided into.
    pub tasks: usize,
    /// Seconds from the moment that a core is free to the first job of the next task: the engine's, and the program's own start.
    pub start: f64,
    /// Share of the cores that are slow.
    pub slow_share: f64,
    /// How much longer those take.
    pub slowness: f64,
    /// Failures of a core in an hour of its work: the task is queued again and loses the job in hand.
    pub failures: f64,
    /// Operations a second that the file system does for all cores together: a task brings its results to the disk after each, but at most once a
    /// second.
    pub operations: f64,
    /// Seconds that the merge takes for each result.
    pub merge: f64,
    /// Of what is drawn: which cores are slow, when they fail.
    pub seed: u64,
}

impl Default for Cluster {
    /// One core that starts at once, works evenly, never fails, and has a file system without bounds.
    fn default() -> Self {
        Self {
            cores: 1,
            tasks: 1,
            start: 0.0,
            slow_share: 0.0,
            slowness: 1.0,
            failures: 0.0,
            operations: f64::INFINITY,
            merge: 0.0,
            seed: 1,
        }
    }
}

/// What a simulation found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Makespan {
    /// Seconds from the first task to the end of the last one.
    pub tasks: f64,
    /// Seconds of the merge after it.
    pub merge: f64,
    /// Seconds of work on undisturbed cores.
    pub work: f64,
    /// Seconds of the longest job.
    pub longest: f64,
    /// Tasks that failed and were queued again.
    pub failed: usize,
    /// Results a second, on the average.
    pub results: f64,
}

impl Makespan {
    /// From the first task to the merged tables.
    pub fn seconds(&self) -> f64 {
        self.tasks + self.merge
    }

    /// Work over what the cores were reserved for.
    pub fn efficiency(&self, cores: usize) -> f64 {
        self.work / (self.seconds() * cores as f64)
    }
}

/// Replays jobs that take these `seconds`, divided into tasks by predicted `costs`.
///
/// The engine gives the next task in their order to the first core that is free. O(jobs log tasks).
pub fn makespan(seconds: &[f64], costs: &[u64], cluster: &Cluster) -> Makespan {
    let tasks = cluster.tasks.max(1);
    let mut jobs: Vec<Vec<f64>> = vec![Vec::new(); tasks];
    // As a shard does them: the most expensive first.
    let of = assign(costs, tasks);
    for job in crate::largest_first(costs.len(), |i| costs[i]) {
        jobs[of[job]].push(seconds[job]);
    }
    let mut waiting: std::collections::VecDeque<Vec<f64>> =
        jobs.into_iter().filter(|task| !task.is_empty()).collect();
    let mut random = Random(cluster.seed);
    // More cores than tasks stay idle, but any of them may be the slow ones.
    let used = cluster.cores.max(1).min(waiting.len().max(1));
    let slowness: Vec<f64> = (0..used)
        .map(|_| if random.uniform() < cluster.slow_share { cluster.slowness } else { 1.0 })
        .collect();
    // Microseconds, because floats have no order.
    let mut free: BinaryHeap<Reverse<(u64, usize)>> = (0..used).map(|core| Reverse((0, core))).collect();
    let micro = |seconds: f64| (seconds * 1e6) as u64;
    let (mut end, mut failed) = (0, 0);
    while let Some(mut task) = waiting.pop_front() {
        let Some(Reverse((now, core))) = free.pop() else { break };
        let mut left = if cluster.failures > 0.0 {
            -(1.0 - random.uniform()).ln() * 3600.0 / cluster.failures
        } else {
            f64::INFINITY
        };
        let mut gone = cluster.start;
        let mut done = 0;
        for job in &task {
            let time = job * slowness[core];
            if time > left {
                gone += left;
                break;
            }
            left -= time;
            gone += time;
            done += 1;
        }
        task.drain(..done);
        if !task.is_empty() {
            failed += 1;
            waiting.push_back(task);
        }
        let then = now + micro(gone);
        end = end.max(then);
        free.push(Reverse((then, core)));
    }
    let (work, count) = (seconds.iter().sum::<f64>(), seconds.len() as f64);
    // The file system serves all cores: no run is shorter than its operations.
    let tasks = (end as f64 * 1e-6).max(count.min(work) / cluster.operations);
    Makespan {
        tasks,
        merge: cluster.merge * count,
        work,
        longest: seconds.iter().copied().fold(0.0, f64::max),
        failed,
        results: if tasks > 0.0 { count / tasks } else { 0.0 },
    }
}

/// Sebastiano Vigna's `SplitMix64`.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn ideal(cores: usize, tasks: usize) -> Cluster {
        Cluster { cores, tasks, ..Cluster::default() }
    }

    #[test]
    fn by_hand() {
        // 3 + 3 against 2 + 2 + 2.
        let found = makespan(&[3.0, 3.0, 2.0, 2.0, 2.0], &[3, 3, 2, 2, 2], &ideal(2, 2));
        assert_relative_eq!(found.tasks, 7.0);
        assert_relative_eq!(found.efficiency(2), 12.0 / 14.0);
        // A task for each job: the same rule, at run time.
        assert_relative_eq!(makespan(&[3.0, 3.0, 2.0, 2.0, 2.0], &[3, 3, 2, 2, 2], &ideal(2, 5)).tasks, 7.0);
        // Nothing is shorter than the longest job, however many cores there are.
        assert_relative_eq!(makespan(&[3.0, 3.0, 2.0], &[3, 3, 2], &ideal(100, 100)).tasks, 3.0);
        let slow = Cluster { start: 1.0, merge: 0.5, slow_share: 1.0, slowness: 2.0, ..ideal(3, 3) };
        assert_relative_eq!(makespan(&[3.0, 3.0, 2.0], &[3, 3, 2], &slow).seconds(), 7.0 + 1.5);
        let disk = Cluster { operations: 0.25, ..ideal(3, 3) };
        assert_relative_eq!(makespan(&[3.0, 3.0, 2.0], &[3, 3, 2], &disk).tasks, 12.0);
    }

    #[test]
    fn failures_cost_time_and_lose_no_job() {
        let (seconds, costs) = (vec![60.0; 400], vec![60; 400]);
        let whole = makespan(&seconds, &costs, &ideal(10, 40));
        assert_relative_eq!(whole.tasks, 2400.0);
        let failing = makespan(&seconds, &costs, &Cluster { failures: 2.0, ..ideal(10, 40) });
        assert!(
            failing.failed > 5 && failing.tasks > whole.tasks && failing.tasks < 1.3 * whole.tasks,
            "{failing:?}"
        );
    }
}
