//! From a scene to its files: planned, solved, reported.

use crate::scenes::plan::{Cost, ModelOnSurface, ModelPlan, Plan, calibration};
use crate::scenes::read::{Result, SceneFile, System, effect_lines, number};
use crate::scenes::run::{
    Concerned, FieldFile, Folder, ModelResult, Options, SceneOutcome, SharedStop, SolvedUnit, StateRecord,
    Warning, field_pictures, is_hidden, remove_trials, scene_jobs, take_trial, units,
};
use crate::scenes::tell::{
    MapStatisticsTables, Report, ResultFolder, StateTable, columns, files, manifest, summary,
};
use contact_model::Stop;
use contact_model::units::ascii;
use runs::cluster::{ShardPlan, ShardReport, ShardRun, run_shard};
use runs::{Checkpoint, Failure, Header, Job, JobRun, Progress, Shard, Store, Threads, run_stored};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;
use web_time::Instant;

/// Answers a scene: every model on every surface under every load, and writes what is asked for.
///
/// `results.csv` and `manifest.json` always, `ensemble.csv` (means over the surfaces) where there are
/// several; `patches.csv`, fields and curves where the scene asks for them. A theory, which is the same for
/// every seed, has one surface. Finished states are kept in `OUT/.units` and reused by the next run of the
/// same scene. What was interrupted, a path or a list of loads, goes on from a checkpoint beside them to the bits
/// of an uninterrupted run. Only where files of a finished state were lost, and it is solved again, do the
/// loads after it differ, within the tolerance. Where `stop` says so, the states so far are written and
/// [`SceneOutcome::stopped`] is true.
///
/// The directory belongs to one run: what an earlier run wrote there and this one does not is removed.
///
/// # Errors
/// As [`crate::scenes::check`]; [`crate::scenes::Error::Run`] for what only shows at full size, for a
/// directory that another process is using or that holds files of somebody else under the names of results;
/// files that cannot be written.
pub fn run(
    scene: &SceneFile,
    plan: &Plan,
    options: &Options,
    progress: &dyn Progress,
    stop: SharedStop<'_>,
) -> Result<SceneOutcome> {
    let start = Instant::now();
    runs::reset_peak_memory();
    let threads =
        Threads { total: options.threads, jobs: calibration::jobs_in_memory(scene, options.threads)? };
    runs::files::create_directory(&options.out)?;
    let store = Store::open(&options.out, options.fresh)?;
    runs::files::clean(&options.out)?;
    let folder = ResultFolder::claim(&options.out, scene)?;
    manifest::write_begun(scene, options, &folder.files(scene))?;
    if options.fresh {
        Checkpoint::remove_all(&options.out);
    }
    take_trial(scene, &options.out, &store);
    let units = units(scene);
    let files = Folder::from(&*options.out);
    let jobs = scene_jobs(scene, &files);
    let run = JobRun { store: &store, threads, progress, stop };
    let done = run_stored(&title(scene), &jobs, run);
    let mut results = done.into_iter().map(Option::transpose).collect::<Result<Vec<_>>>()?;
    for (result, job) in results.iter_mut().zip(&jobs) {
        if result.is_none() {
            *result = job.stored_so_far(&store);
        }
    }
    let mut outcome =
        SceneOutcome { requested: scene.request.count() * units.len(), ..SceneOutcome::default() };
    let answers = SceneAnswers { scene, units: &units, results: &results };
    answers.tell(plan, &files, start, &mut outcome)?;
    outcome.files.push(options.out.join("manifest.json"));
    if !outcome.stopped {
        field_pictures::sweep(&options.out);
        Checkpoint::remove_all(&options.out);
        remove_trials(&options.out);
    }
    let removed = folder.remove_others(&outcome.files)?;
    if removed > 0 {
        let out = options.out.display();
        outcome.notes.push(format!("{removed} files that an earlier run left in {out} were removed."));
    }
    manifest::write(scene, plan, options, &outcome)?;
    Ok(outcome)
}

/// A run in memory.
#[derive(Debug, Clone, Default)]
pub struct RunInMemory {
    /// The outcome, as of a run in a folder. The paths of its files are their names alone.
    pub outcome: SceneOutcome,
    /// The bytes of its files by their names: tables, pictures, fields and the report.
    pub files: BTreeMap<String, Arc<[u8]>>,
    /// The report without the frame of its page, for a page that has another one.
    pub report: String,
}

/// Answers a scene in memory: nothing is read from a file system or written to one, so that a scene can be answered
/// where there is none. The jobs are solved one after the other on this thread, to the same numbers as [`run`].
///
/// `solved` receives each state as soon as it is solved, as HTML: its numbers and its fields as the report shows
/// them.
///
/// # Errors
/// As [`crate::scenes::check`]; [`crate::scenes::Error::Run`] for what only shows at full size.
pub fn run_in_memory(
    scene: &SceneFile,
    plan: &Plan,
    progress: &dyn Progress,
    stop: Stop<'_>,
    solved: &dyn Fn(&str),
) -> Result<RunInMemory> {
    let start = Instant::now();
    let folder = Folder::in_memory();
    let units = units(scene);
    let jobs = scene_jobs(scene, &folder);
    progress.begin(&title(scene), jobs.iter().map(Job::cost).sum());
    let mut results = Vec::with_capacity(jobs.len());
    for (unit, job) in units.iter().zip(&jobs) {
        let known = Cell::new(0);
        let newest = |result: &ModelResult| {
            // A job that is complete is kept once more.
            if result.states.len() == known.replace(result.states.len()) {
                return Ok(());
            }
            let states = &result.states[result.states.len().saturating_sub(1)..];
            let unit = SolvedUnit {
                model: unit.numerics(scene).name(),
                surface: unit.surface,
                states,
                thresholds: &[],
            };
            let states = StateTable::new(scene, vec![unit], title(scene));
            let view = |file: FieldFile<'_>| field_pictures::view(&folder, file);
            let outcome = SceneOutcome::default();
            // Pictures are drawn last.
            let drawn = |_: FieldFile<'_>| None;
            let report = Report {
                states: &states,
                plan,
                outcome: &outcome,
                statistics: None,
                view: &view,
                drawn: &drawn,
            };
            // A picture that cannot be encoded is an error of the report at the end.
            solved(&report.of_one_state().unwrap_or_default());
            Ok(())
        };
        results.push(if stop.stops() {
            None
        } else {
            Some(job.go_on(ModelResult::default(), Some(&newest), progress, stop)?)
        });
        progress.advance(job.cost(), false);
    }
    progress.end();
    let mut outcome =
        SceneOutcome { requested: scene.request.count() * units.len(), ..SceneOutcome::default() };
    let answers = SceneAnswers { scene, units: &units, results: &results };
    let report = answers.tell(plan, &folder, start, &mut outcome)?;
    let files = folder.into_files().into_iter().filter(|(name, _)| !is_hidden(name)).collect();
    Ok(RunInMemory { outcome, files, report })
}

/// The result of each model on each surface; `None` where it was not begun.
struct SceneAnswers<'a> {
    scene: &'a SceneFile,
    units: &'a [ModelOnSurface],
    results: &'a [Option<ModelResult>],
}

/// Does one shard of a scene and writes no table; [`crate::scenes::run`] in the same directory, when all
/// shards are done, finds their results and does.
///
/// Shards of one scene may run at the same time, here or on other machines that share the directory. A job
/// that is interrupted goes on from its checkpoint to the bits of an undivided run.
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
    if scene.accuracy.is_some() {
        take_trial(scene, &options.out, &Store::view(&options.out)?);
    }
    let jobs = scene_jobs(scene, &Folder::from(&*options.out));
    run_shard(plan, &jobs, shard, ShardRun { out: &options.out, threads: options.threads, progress, stop })
}

impl<'a> SceneAnswers<'a> {
    fn begun(&self) -> impl Iterator<Item = (&'a ModelOnSurface, &'a ModelResult)> {
        let Self { units, results, .. } = *self;
        units.iter().zip(results).filter_map(|(unit, result)| Some((unit, result.as_ref()?)))
    }

    /// Counts the states, writes tables, curves and the report, and completes the outcome by all of them. The report
    /// is returned without the frame of its page.
    fn tell(
        &self,
        plan: &Plan,
        folder: &Folder,
        start: Instant,
        outcome: &mut SceneOutcome,
    ) -> Result<String> {
        self.count(folder, outcome);
        let scene = self.scene;
        let states = self.table();
        let statistics =
            scene.requested.statistics.then(|| MapStatisticsTables::of_scene(scene)).transpose()?;
        if let Some(statistics) = &statistics {
            let said = statistics.notes.iter().chain(&statistics.remarks);
            outcome.notes.extend(said.map(|note| format!("statistics: {note}")));
        }
        let mut written = Vec::new();
        let mut write = |name: &str, bytes: Vec<u8>| -> Result<()> {
            folder.write(name.to_owned(), &bytes)?;
            written.push(folder.path(name));
            Ok(())
        };
        let results = states.results()?;
        files::make(&states, &results, statistics.as_ref(), &header(scene, plan), &mut write)?;
        outcome.results = Some(results);
        outcome.summary = summary::summary(&states);
        outcome.actual = self.actual();
        outcome.peak_memory = runs::peak_memory();
        outcome.seconds = start.elapsed().as_secs_f64();
        let view = |file: FieldFile<'_>| field_pictures::view(folder, file);
        let statistics = statistics.as_ref();
        let drawn = |file: FieldFile<'_>| folder.read(&file.to_string());
        let report = Report { states: &states, plan, outcome, statistics, view: &view, drawn: &drawn };
        let report = report.page()?;
        write("report.html", report.html().into_bytes())?;
        outcome.files.extend(written);
        Ok(report.content())
    }

    /// The states of all results.
    fn table(&self) -> StateTable<'a> {
        let solved = self.begun().map(|(unit, result)| SolvedUnit {
            model: unit.numerics(self.scene).name(),
            surface: unit.surface,
            states: result.states.as_slice(),
            thresholds: result.thresholds.as_deref().unwrap_or(&[]),
        });
        StateTable::new(self.scene, solved.collect(), title(self.scene))
    }

    /// Adds counts, notes and files of all results to the outcome.
    fn count(&self, folder: &Folder, outcome: &mut SceneOutcome) {
        outcome.stopped |= self.results.iter().any(|result| result.as_ref().is_none_or(|r| !r.complete));
        let mut missed: Vec<String> = Vec::new();
        for (unit, result) in self.begun() {
            let model = unit.numerics(self.scene).name();
            outcome.kept += result.kept;
            outcome.notes.extend(result.notes.iter().cloned());
            for record in &result.states {
                outcome.states += 1;
                outcome.pulled_off += usize::from(record.is_pulled_off());
                outcome.failed += usize::from(record.converged().is_none() && !record.is_pulled_off());
                if record.solved().is_none() || record.is_pulled_off() {
                    let why = record.note().map(|note| format!("{model}: {note}"));
                    outcome.notes.extend(why.filter(|note| !outcome.notes.contains(note)));
                } else if let Some(error) = self.not_converged(record) {
                    missed.push(error);
                }
                let shown = record.files.iter().filter(|file| !is_hidden(&file.name));
                outcome.files.extend(shown.map(|file| folder.path(&file.name)));
            }
        }
        outcome.notes.extend(note_on_missed(&missed));
        outcome.notes.extend(self.warnings());
    }

    /// The error of a state that has not converged.
    fn not_converged(&self, record: &StateRecord) -> Option<String> {
        let solved = record.solved().filter(|_| record.converged().is_none())?;
        let error = contact_model::Error::NotConverged { best: Box::new(solved.state.clone()) };
        Some(format!("{}: {error}", record.words(self.scene)))
    }

    /// One sentence for each kind of warning, about all states that it concerns.
    fn warnings(&self) -> impl Iterator<Item = String> {
        let mut warned: [Vec<Concerned<'_>>; Warning::ALL.len()] = Default::default();
        // A formula has no cells that a warning could be about.
        let mut counted = 0;
        for (unit, result) in self.begun() {
            counted += if unit.numerics(self.scene).size() > 0 { result.states.len() } else { 0 };
            for solved in result.states.iter().filter_map(StateRecord::solved) {
                for &warning in &solved.warnings {
                    warned[warning as usize].push((&solved.state, solved.grid.as_ref()));
                }
            }
        }
        let concerned = Warning::ALL.into_iter().zip(warned).filter(|(_, states)| !states.is_empty());
        concerned.map(move |(warning, states)| warning.sentence(self.scene, &states, counted))
    }

    /// The cost of each model and the bytes of its files, summed over its states.
    fn actual(&self) -> Vec<(&'static str, Cost, u64)> {
        let models = self.scene.models.iter();
        let mut list: Vec<_> = models.map(|model| (model.name(), Cost::default(), 0)).collect();
        for (unit, result) in self.begun() {
            let Some((_, cost, bytes)) = list.get_mut(unit.model) else { continue };
            cost.seconds += result.seconds;
            for record in &result.states {
                *bytes += record.files.iter().map(|file| file.bytes).sum::<u64>();
                let Some(solved) = record.solved() else { continue };
                let report = &solved.state.report;
                cost.applications += report.applications as f64;
                cost.linear_solves += report.work.linear_solves as f64;
                cost.fields += report.work.fields as f64;
                cost.field_bytes += report.work.bytes as f64;
            }
        }
        list
    }
}

/// A note on the states that have not converged, by the words of the first one.
fn note_on_missed(missed: &[String]) -> Option<String> {
    let first = missed.first()?;
    let others = match missed.len() - 1 {
        0 => String::new(),
        1 => " (and one more state)".to_owned(),
        count => format!(" (and {count} more states)"),
    };
    Some(format!(
        "{first}{others}. The largest of these numbers has to be below `tolerance` in [models.NAME]: a larger tolerance accepts the state."
    ))
}

/// What the tables are called.
pub(crate) fn title(scene: &SceneFile) -> String {
    let name = scene.path.file_stem().map_or_else(|| "scene".into(), |n| n.to_string_lossy().into_owned());
    format!("{name}: {}", ascii(&scene.surface.describe(scene.system)))
}

fn header(scene: &SceneFile, plan: &Plan) -> Header {
    let file =
        scene.path.file_name().map_or_else(|| "scene.toml".into(), |n| n.to_string_lossy().into_owned());
    let mut header = Header { command: format!("fractal-contact run {file}"), ..Header::default() };
    for (_, _, source) in columns::sources(scene) {
        header = header.with_sources(&[source]);
    }
    if !scene.comment().is_empty() {
        header = header.with_note(scene.comment());
    }
    header = header.with_note(match scene.system {
        System::Si => "units: SI",
        System::None => "units: none; lengths, forces and moduli in the scene's own",
    });
    // Which file, and what was done to it.
    let tables = scene.text.lines().skip_while(|line| line.trim() != "[scene.surface]").skip(1);
    let surface = tables.take_while(|line| !line.trim_start().starts_with('['));
    for line in surface.map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        header = header.with_note(format!("surface: {line}"));
    }
    let size = scene.surface.size();
    header = header.with_note(format!(
        "E*: {}; size: {} x {}",
        number(scene.contact_modulus),
        number(size.x),
        number(size.y)
    ));
    for ModelPlan { name, grid, accuracy, .. } in &plan.models {
        header = header.with_note(format!("model {name}: grid: {grid}; {accuracy}"));
    }
    for line in effect_lines(&scene.effects, scene.system) {
        header = header.with_note(format!(
            "effect {}: {} ({})",
            line.name,
            if line.on { "on" } else { "off" },
            line.reason
        ));
    }
    if scene.is_random() {
        header = header.with_note(format!("seed: {}", scene.sampling.seed));
    }
    header
}
