//! A scene as a list of jobs, and one shard of it.

use crate::scenes::columns;
use crate::scenes::error::Result;
use crate::scenes::manifest;
use crate::scenes::model_on_surface::ModelOnSurface;
use crate::scenes::outcome::{Options, SharedStop};
use crate::scenes::result_folder::ResultFolder;
use crate::scenes::scene_file::SceneFile;
use crate::scenes::scene_job::SceneJob;
use runs::cluster::{ShardPlan, ShardReport, run_shard};
use runs::{Failure, JobList, Progress, Shard};
use std::path::Path;

/// Every model of a scene on every surface, in the order of the tables. A theory, which is the same for every seed, has one surface.
pub(crate) fn units(scene: &SceneFile) -> Vec<ModelOnSurface> {
    let surfaces = |model: usize| {
        if scene.surface.is_random_for(&scene.models[model]) { scene.sampling.surfaces } else { 1 }
    };
    (0..scene.models.len())
        .flat_map(|model| (0..surfaces(model)).map(move |surface| ModelOnSurface { model, surface }))
        .collect()
}

/// The same as jobs that write their fields into `out`.
pub(crate) fn scene_jobs<'a>(scene: &'a SceneFile, out: &'a Path) -> Vec<SceneJob<'a>> {
    let columns = columns::columns(scene).len();
    units(scene).into_iter().map(|unit| SceneJob { unit, scene, out, columns }).collect()
}

/// The jobs of a scene whose results go to `out`: each model on each surface.
pub fn jobs<'a>(scene: &'a SceneFile, out: &'a Path) -> Box<dyn JobList + 'a> {
    Box::new(scene_jobs(scene, out))
}

/// Does one shard of a scene and writes no table; [`crate::scenes::run`] in the same directory, when all shards are done, finds their results and does.
///
/// Shards of one scene may run at the same time, here or on other machines that share the directory. A job that is interrupted goes on from its last
/// state: the states after it are then those of an undivided run within the tolerance, not to the last digit.
///
/// # Errors
/// As [`crate::scenes::run`]; the first job that fails.
pub fn run_scene_shard(
    scene: &SceneFile,
    plan: &ShardPlan,
    shard: Shard,
    options: &Options,
    progress: &dyn Progress,
    stop: SharedStop<'_>,
) -> Result<ShardReport, Failure> {
    runs::files::create_directory(&options.out)?;
    // The files of an earlier run are this one's to replace, as for a run that is not divided.
    let folder = ResultFolder::claim(&options.out, scene)?;
    manifest::write_begun(scene, options, &folder.files(scene))?;
    let jobs = scene_jobs(scene, &options.out);
    run_shard(plan, &jobs, shard, (&options.out, options.threads), progress, stop)
}
