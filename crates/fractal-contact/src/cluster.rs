//! Scenes on many machines: shards, their plan, submission, status and merge.

use crate::arguments::ShardsArguments;
use crate::start::{stopped_by_signals, with_grid};
use fractal_contact::scenes::{
    Error, Options, Plan, PredictedFrom, Result, SceneFile, jobs, run_scene_shard,
};
use runs::cluster::{Division, Forecast, ShardPlan, Submission, check, quoted};
use runs::{JobList, Progress, ShardChoice};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;

/// Name of the program in messages.
const PROGRAM: &str = "fractal-contact";

/// The plan of a scene. Tasks start in other directories, so the path of the scene is absolute.
fn plan_of(path: &Path, jobs: &dyn JobList) -> Result<ShardPlan> {
    let path = std::fs::canonicalize(path).map_err(runs::Error::file("find", path))?;
    let text = path.to_str().ok_or_else(|| {
        runs::Error::parameter(
            "scene",
            path.display(),
            "a path in UTF-8, where a scene is divided into shards",
        )
    })?;
    Ok(ShardPlan::new(PROGRAM, vec!["run".to_owned(), text.to_owned()], jobs))
}

/// Does one shard of a scene.
pub fn shard(
    path: &Path,
    choice: ShardChoice,
    options: &Options,
    progress: &dyn Progress,
) -> Result<ExitCode> {
    let shard = choice.resolve(&|name| std::env::var(name).ok())?;
    let (scene, stopped) = (SceneFile::read(path)?, stopped_by_signals()?);
    let Some(scene) = with_grid(scene, options, progress, &stopped)? else {
        return Ok(ExitCode::from(130));
    };
    fractal_contact::scenes::check(&scene)?;
    let plan = plan_of(path, &*jobs(&scene, &options.out))?;
    let stop = || stopped.load(Ordering::Relaxed);
    let report = run_scene_shard(&scene, &plan, shard, options, progress, &stop);
    let report = report.map_err(|failure| match failure.downcast::<Error>() {
        Ok(error) => *error,
        Err(failure) => match failure.downcast::<runs::Error>() {
            Ok(error) => Error::Run(*error),
            Err(other) => Error::Argument { name: "shard", reason: other.to_string() },
        },
    })?;
    if stop() {
        runs::err!("Stopped: the states so far are kept. The same command goes on with the others.");
        return Ok(ExitCode::from(130));
    }
    runs::out!("{report}");
    Ok(ExitCode::SUCCESS)
}

/// The forecast of a scene, with the times of its plan.
fn forecast(jobs: &dyn JobList, plan: &Plan, division: &Division) -> Forecast {
    let forecast = Forecast::new(jobs, division);
    match plan.predicted() {
        Some(cost) => forecast.measured(cost.seconds, PredictedFrom::SmallSolves.words()),
        None => forecast,
    }
}

/// Prints the prediction of what a scene needs on a number of nodes with a number of cores each.
pub fn tell(
    scene: &SceneFile,
    plan: &Plan,
    division: &Division,
    (nodes, cores): (usize, usize),
) -> Result<()> {
    let forecast = forecast(&*jobs(scene, Path::new(".")), plan, division);
    runs::out!("\n{}", forecast.on_nodes(nodes, cores, None)?);
    Ok(())
}

/// Writes the scripts of a scene, which was read from a path, and submits them with `--now`.
pub fn submit(
    (path, scene): (&Path, &SceneFile),
    out: &Path,
    submission: &Submission,
    division: &Division,
) -> Result<ExitCode> {
    let calibrated = Plan::calibrated(scene)?;
    let jobs = jobs(scene, out);
    let plan = plan_of(path, &*jobs)?;
    let forecast = |division: &Division| forecast(&*jobs, &calibrated, division);
    runs::out!("{}", submission.submit(&plan, &*jobs, out, division, &forecast)?);
    Ok(ExitCode::SUCCESS)
}

/// The plan of a directory and its scene.
fn planned(options: &ShardsArguments) -> Result<(ShardPlan, PathBuf, SceneFile)> {
    let plan = ShardPlan::only(&options.out, PROGRAM, options.plan.as_deref())?;
    let path = match plan.arguments.as_slice() {
        [run, path] if run == "run" => PathBuf::from(path),
        _ => return Err(runs::Error::parameter("plan", plan.command(), "fractal-contact run SCENE").into()),
    };
    let scene = SceneFile::read(&path)?.with_stored_grid(&options.out)?;
    Ok((plan, path, scene))
}

/// Prints the state of the shards of a directory.
pub fn status(options: &ShardsArguments) -> Result<ExitCode> {
    let (plan, _, scene) = planned(options)?;
    let jobs = jobs(&scene, &options.out);
    let status = runs::cluster::status(&check(&plan, &*jobs, &options.out)?, &*jobs, &options.out);
    runs::out!("{status}");
    Ok(if status.complete() { ExitCode::SUCCESS } else { ExitCode::from(3) })
}

/// The scene whose tables the shards of a directory make, when all of its jobs are there.
pub fn merged(options: &ShardsArguments) -> Result<PathBuf> {
    let (plan, path, scene) = planned(options)?;
    let jobs = jobs(&scene, &options.out);
    let found = check(&plan, &*jobs, &options.out)?;
    let (scene, out) = (quoted(&path.to_string_lossy()), quoted(&options.out.to_string_lossy()));
    let again = format!(
        "{PROGRAM} run {scene} --out {out} --shard 0/1, or on a cluster: {PROGRAM} submit {scene} --out {out} --engine slurm --now"
    );
    found.require(&options.out, options.plan.is_some(), &again)?;
    for remark in found.remarks() {
        runs::err!("note: {remark}");
    }
    Ok(path)
}
