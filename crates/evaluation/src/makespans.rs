//! A study on many cores, replayed with the times that its surfaces were measured to take.

use crate::realisation::Realisation;
use crate::sweep::realisation_jobs;
use crate::table_of::TableOf;
use analysis::Table;
use runs::cluster::{Cluster, Makespan, makespan};
use runs::{Error, Job, JobList, Result, Store};

/// Seconds that each unit takes: its own where the store holds it, else those of the stored units of the same model, size and fractal dimension,
/// in turn; where there are none, what is predicted, times what the stored ones take over their prediction.
///
/// # Errors
/// [`Error::Parameter`] where the store holds no unit of the study.
pub fn replayed_seconds(units: &[Realisation], store: &Store) -> Result<Vec<f64>> {
    let jobs = realisation_jobs(units.to_vec());
    let measured: Vec<Option<f64>> =
        jobs.iter().map(|job| job.stored(store).map(|result| result.seconds)).collect();
    let found = || measured.iter().enumerate().filter_map(|(i, seconds)| Some((i, (*seconds)?)));
    let (seconds, predicted) =
        found().fold((0.0, 0.0), |sum, (i, seconds)| (sum.0 + seconds, sum.1 + 1e-3 * jobs[i].cost() as f64));
    if found().next().is_none() {
        let expected = "a directory with results of this study: a few of its surfaces, solved on the machine whose times count";
        return Err(Error::parameter("measured", "no surface of the study", expected));
    }
    let same = |i: usize, j: usize| {
        units[i].discretisation == units[j].discretisation
            && units[i].fractal_dimension.total_cmp(&units[j].fractal_dimension).is_eq()
    };
    let mut turn = 0;
    // Kinds follow each other in a list of units; a study has few of them.
    let mut known: Vec<(usize, Vec<f64>)> = Vec::new();
    let all = (0..units.len()).map(|i| {
        if let Some(seconds) = measured[i] {
            return seconds;
        }
        let kind = known.iter().position(|(of, _)| same(*of, i)).unwrap_or_else(|| {
            known.push((i, found().filter(|(j, _)| same(i, *j)).map(|(_, seconds)| seconds).collect()));
            known.len() - 1
        });
        let times = &known[kind].1;
        turn += 1;
        times
            .get(turn % times.len().max(1))
            .copied()
            .unwrap_or_else(|| 1e-3 * jobs[i].cost() as f64 * seconds / predicted)
    });
    Ok(all.collect())
}

/// One simulation.
#[derive(Debug, Clone)]
pub struct SimulatedRun {
    /// The machines.
    pub cluster: Cluster,
    /// Cores of each task.
    pub cores_of_task: usize,
    /// How much faster than one they solve.
    pub speed_up: f64,
    /// What was found.
    pub found: Makespan,
    /// Jobs of the study.
    pub jobs: usize,
}

impl SimulatedRun {
    /// Cores that are reserved.
    pub fn cores(&self) -> usize {
        self.cluster.cores * self.cores_of_task
    }

    /// Processor seconds of the jobs on one undisturbed core each, over what was reserved.
    pub fn efficiency(&self) -> f64 {
        self.found.efficiency(self.cluster.cores) * self.speed_up / self.cores_of_task as f64
    }

    /// What more of would make it shorter.
    pub fn limit(&self) -> &'static str {
        let Makespan { tasks, merge, longest, work, .. } = self.found;
        let shared = work / self.cluster.cores as f64;
        let operations = (self.jobs as f64).min(work) / self.cluster.operations;
        let parts = [
            (shared, "cores"),
            (longest * self.cluster.slowness, "the longest job"),
            (operations, "the file system"),
            (merge, "the merge"),
            (self.cluster.start, "the start of a task"),
        ];
        let largest = parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or("cores", |part| part.1);
        // Where none of them explains half of it, it is how the jobs are divided.
        if parts.iter().all(|part| part.0 < 0.5 * (tasks + merge)) { "the division" } else { largest }
    }
}

/// Simulates a study on several numbers of cores, each with one, four and as many tasks for each core as there are jobs.
///
/// `cores_of_task` cores do one job `speed_up` times as fast.
pub fn simulate(
    units: &[Realisation],
    seconds: &[f64],
    cores: &[usize],
    (cores_of_task, speed_up): (usize, f64),
    machines: &Cluster,
) -> Vec<SimulatedRun> {
    let jobs = realisation_jobs(units.to_vec());
    let costs: Vec<u64> = (0..JobList::count(&jobs)).map(|i| JobList::cost(&jobs, i)).collect();
    let seconds: Vec<f64> = seconds.iter().map(|seconds| seconds / speed_up).collect();
    let mut all = Vec::new();
    for &cores in cores {
        let at_once = (cores / cores_of_task).max(1);
        let mut divisions = [at_once, 4 * at_once, jobs.len()].map(|tasks| tasks.min(jobs.len()));
        divisions.sort_unstable();
        for (i, &tasks) in divisions.iter().enumerate() {
            if i > 0 && divisions[i - 1] == tasks {
                continue;
            }
            let cluster = Cluster { cores: at_once, tasks, ..machines.clone() };
            let found = makespan(&seconds, &costs, &cluster);
            all.push(SimulatedRun { cluster, cores_of_task, speed_up, found, jobs: jobs.len() });
        }
    }
    all
}

/// The simulations as a table.
///
/// # Errors
/// None for finite times.
pub fn makespan_table(runs: &[SimulatedRun]) -> Result<Table> {
    TableOf::new("A study on many cores: simulated with measured times", runs)
        .column("cores", "1", "reserved", SimulatedRun::cores)
        .column("cores_of_task", "1", "cores of each task", |r| r.cores_of_task)
        .column("jobs", "1", "surfaces and lines", |r| r.jobs)
        .column("tasks", "1", "shards that they are divided into", |r| r.cluster.tasks)
        .column("makespan", "s", "from the first task to the merged tables", |r| r.found.seconds())
        .column(
            "efficiency",
            "1",
            "work on one undisturbed core each over what was reserved",
            SimulatedRun::efficiency,
        )
        .column("work", "s", "of all jobs on such tasks", |r| r.found.work)
        .column("longest_job", "s", "no run is shorter", |r| r.found.longest)
        .column("merge", "s", "reading all results and making the tables", |r| r.found.merge)
        .column("failed_tasks", "1", "queued again", |r| r.found.failed)
        .column("results_per_second", "1/s", "written by all cores together, on the average", |r| {
            r.found.results
        })
        .column("limit", "-", "what more of would make it shorter", SimulatedRun::limit)
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::sweep;
    use crate::{Request, Run, run_units};
    use runs::Silent;

    #[test]
    fn measured_times_are_replayed_for_surfaces_like_them() {
        let dir = tempfile::tempdir().unwrap();
        let request = |surfaces| Request {
            cells: Some(33),
            surfaces: Some(surfaces),
            fractal_dimensions: Some(vec![2.2, 2.8]),
            forces: Some("0.1,1".into()),
            ..Request::default()
        };
        let few = run_units(&Run::new(&request(1)).unwrap(), true, false);
        let many = run_units(&Run::new(&request(20)).unwrap(), true, false);
        let store = Store::open(dir.path(), false).unwrap();
        assert!(
            replayed_seconds(&many, &store).unwrap_err().to_string().starts_with("measured = no surface")
        );
        let solved = sweep("test", &few, &store, 1, &Silent).unwrap();
        let seconds = replayed_seconds(&many, &store).unwrap();
        assert_eq!(seconds.len(), many.len());
        for (unit, time) in many.iter().zip(&seconds) {
            let like = few.iter().position(|f| {
                f.discretisation == unit.discretisation
                    && (f.fractal_dimension - unit.fractal_dimension).abs() < 1e-9
            });
            approx::assert_relative_eq!(*time, solved[like.unwrap()].seconds);
        }
        let runs = simulate(&many, &seconds, &[2, 1000], (1, 1.0), &Cluster::default());
        // Two cores: 2, 8 and all; a thousand: all.
        assert_eq!(runs.len(), 4);
        assert!(runs[0].found.efficiency(2) > 0.5 && runs[3].limit() == "the longest job", "{runs:?}");
        assert_eq!(makespan_table(&runs).unwrap().rows().len(), 4);
    }
}
