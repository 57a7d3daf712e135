//! Solves every problem with every method and compares the results.

use super::job::{StudyJob, StudyPart, jobs};
use super::means;
use super::row::{StudyRow, mark_pareto};
use super::sizes::{Order, StudySizes};
use contact_model::never;
use runs::{JobRun, Progress, Result, Store, Threads, collect, run_stored};

/// All results of the study.
#[derive(Debug, Default)]
pub(crate) struct Study {
    pub rows: Vec<StudyRow>,
    pub orders: Vec<Order>,
}

/// Solves everything that the store does not hold, one job at a time and on one thread, because the study
/// measures times.
pub(crate) fn study(sizes: &StudySizes, seed: u64, store: &Store, progress: &dyn Progress) -> Result<Study> {
    let jobs = jobs(sizes, seed)?;
    // Jobs that measure memory come first, because memory is measured from what the process already holds.
    let (problems, means) = jobs.split_at(jobs.partition_point(StudyJob::is_problem));
    let run = JobRun { store, threads: Threads::all(1), progress, stop: &never };
    let solve = |what, jobs| collect(run_stored(what, jobs, run));
    let mut study = Study::default();
    let (mut ensembles, mut forms) = (Vec::new(), Vec::new());
    let mut parts = solve("accuracy against time: single surfaces", problems)?;
    parts.extend(solve("accuracy against time: ensembles", means)?);
    for part in parts {
        match part {
            StudyPart::Problem(rows, orders) => {
                study.rows.extend(rows);
                study.orders.extend(orders);
            }
            StudyPart::Ensemble(found) => ensembles.push(found),
            StudyPart::ClosedForms(found) => forms.push(found),
        }
    }
    study.rows.extend(means::means(sizes, &ensembles, &forms, &mut study.orders));
    mark_pareto(&mut study.rows);
    Ok(study)
}
