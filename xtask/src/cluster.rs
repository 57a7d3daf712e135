//! Commands on many machines: shards, their plan, submission, status and merge.

use crate::arguments::{PlanArguments, StudyShardsArguments, SubmitArguments, XtaskArguments, XtaskCommand};
use clap::Parser as _;
use paper::evaluation::{Run, ensemble_jobs};
use runs::cluster::{
    self, Division, Forecast, PlanStatus, ShardRun, check, quoted, run_shard, status, without_flags,
};
use runs::{Error, JobList, Reporter, Result, ShardChoice};

/// Name of the program in messages.
const PROGRAM: &str = "cargo xtask";

/// The jobs of a command.
///
/// # Errors
/// [`Error::Parameter`] for a command that has no jobs, and for the values that [`Run::new`] refuses.
pub fn jobs(command: &XtaskCommand) -> Result<Box<dyn JobList>> {
    if let Some((_, target)) = command.target() {
        let expected = "no accuracy together with --shard: run --accuracy on one machine first, and give the sizes that it prints";
        return Err(Error::parameter("accuracy", target.share, expected));
    }
    let request = command.request();
    if request.fresh {
        return Err(Error::parameter("fresh", true, "no --fresh with --shard: choose another --out"));
    }
    let run = Run::new(&request)?;
    if let Some(models) = command.models() {
        return Ok(Box::new(ensemble_jobs(&run, models)?));
    }
    match command {
        XtaskCommand::Exponent(options) => Ok(Box::new(options.study(&run)?.jobs()?)),
        XtaskCommand::ReproduceTwoCases(options) => paper::two_cases_jobs(&options.study()?, &options.out),
        XtaskCommand::AccuracyCost(options) => {
            paper::evaluation::accuracy_cost_jobs(options.depth, options.seed)
        }
        XtaskCommand::BudgetCheck(options) => {
            paper::evaluation::budget_check_jobs(options.cases, options.seed)
        }
        _ => {
            let expected = "reproduce-fig2, -fig3, -fig4, -fig6, -fig7, reproduce-all, verify, reproduce-two-cases, exponent, accuracy-cost or budget-check";
            Err(Error::parameter("command", "a command without jobs to share", expected))
        }
    }
}

/// Does one shard of a command.
///
/// # Errors
/// As [`jobs`]; the first job that fails.
pub fn shard(command: &XtaskCommand, choice: ShardChoice, typed: &[String]) -> Result<(), runs::Failure> {
    let shard = choice.resolve(&|name| std::env::var(name).ok())?;
    let jobs = jobs(command)?;
    let (out, run) = (command.out(), Run::new(&command.request())?);
    runs::files::create_directory(&out)?;
    let plan = plan_of(typed, &*jobs);
    let report = run_shard(
        &plan,
        &*jobs,
        shard,
        ShardRun { out: &out, threads: run.threads, progress: &Reporter::new(), stop: &|| false },
    )?;
    runs::out!("{report}");
    Ok(())
}

fn plan_of(typed: &[String], jobs: &dyn JobList) -> cluster::ShardPlan {
    let arguments = without_flags(typed, &["out", "shard", "threads"], &["fresh"]);
    cluster::ShardPlan::new(PROGRAM, arguments, jobs)
}

fn parsed(typed: &[String]) -> Result<XtaskCommand> {
    let words = std::iter::once("cargo xtask".to_owned()).chain(typed.iter().cloned());
    match XtaskArguments::try_parse_from(words) {
        Ok(arguments) => Ok(arguments.command),
        Err(error) => {
            let error = error.to_string();
            let reason = error.trim_start_matches("error: ").trim().to_owned();
            Err(Error::parameter("command", typed.join(" "), format!("a command of cargo xtask: {reason}")))
        }
    }
}

/// Prints the prediction of what a command needs.
///
/// # Errors
/// As [`jobs`].
pub fn plan(options: &PlanArguments) -> Result<()> {
    let command = parsed(&options.command)?;
    let here = std::thread::available_parallelism().map_or(1, usize::from);
    let forecast = Forecast::new(&*jobs(&command)?, &options.division);
    let cores = options.node_cores.map_or(here.max(forecast.cores), usize::from);
    let memory = options.node_memory.map(|mb| 1e6 * mb as f64);
    runs::out!("{}", forecast.on_nodes(usize::from(options.nodes), cores, memory)?);
    Ok(())
}

/// Writes the scripts of a command, and submits them with `--now`.
///
/// # Errors
/// As [`jobs`], and errors of the engine.
pub fn submit(options: &SubmitArguments) -> Result<()> {
    let command = parsed(&options.command)?;
    let jobs = jobs(&command)?;
    let out = command.out();
    let (plan, division) = (plan_of(&options.command, &*jobs), &options.division);
    let forecast = |division: &Division| Forecast::new(&*jobs, division);
    runs::out!("{}", options.submission.submit(&plan, &*jobs, &out, division, &forecast)?);
    Ok(())
}

/// The plan of a directory, the command that it is of, and the jobs.
fn planned(options: &StudyShardsArguments) -> Result<(cluster::ShardPlan, XtaskCommand, Box<dyn JobList>)> {
    let plan = cluster::ShardPlan::only(&options.out, PROGRAM, options.plan.as_deref())?;
    let mut words = plan.arguments.clone();
    words.extend(["--out".to_owned(), options.out.to_string_lossy().into_owned()]);
    let command = parsed(&words)?;
    let jobs = jobs(&command)?;
    Ok((plan, command, jobs))
}

/// Prints the state of the shards of a directory.
///
/// # Errors
/// A directory without a plan or with several.
pub fn tell_status(options: &StudyShardsArguments) -> Result<PlanStatus> {
    let (plan, _, jobs) = planned(options)?;
    let status = status(&check(&plan, &*jobs, &options.out)?, &*jobs, &options.out);
    runs::out!("{status}");
    Ok(status)
}

/// The command whose tables the shards of a directory make, when all of its jobs are there, and what was
/// typed for it.
///
/// # Errors
/// [`Error::Parameter`] with what is missing, damaged or of another plan.
pub fn merged(options: &StudyShardsArguments) -> Result<(XtaskCommand, Vec<String>)> {
    let (plan, command, jobs) = planned(options)?;
    let found = check(&plan, &*jobs, &options.out)?;
    let out = quoted(&options.out.to_string_lossy());
    let again = format!(
        "{} --out {out} --shard 0/1, or on a cluster: {PROGRAM} submit --engine slurm --now {} --out {out}",
        plan.command(),
        plan.arguments.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
    );
    found.require(&options.out, options.plan.is_some(), &again)?;
    for remark in found.remarks() {
        runs::err!("note: {remark}");
    }
    Ok((command, plan.arguments))
}
