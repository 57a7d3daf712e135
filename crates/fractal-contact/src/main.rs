//! The program: arguments, progress, Ctrl-C and exit codes; no science.

mod arguments;
mod cluster;
mod press;
mod start;
mod unknown;

use arguments::{Arguments, Command, PressArguments, SurfaceArguments};
use clap::FromArgMatches as _;
use fractal_contact::models::{MODELS, ModelRecord};
use fractal_contact::scenes::{
    AskedTwin, Error, GeneratedSurface, Options, Plan, Result, SceneFile, SceneOutcome, System, info,
    info_json, info_statistics, run, write_twin,
};
use fractal_contact::surface_gen::{Anisotropy, HeightDistribution, TwinSpectrum};
use runs::cluster::Division;
use start::{stopped_by_signals, with_grid};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;

fn main() -> ExitCode {
    let matches = arguments::command().try_get_matches().unwrap_or_else(|error| {
        let words: Vec<String> =
            std::env::args_os().skip(1).map(|word| word.to_string_lossy().into()).collect();
        let Some(answer) = unknown::answer(&error, &arguments::command(), &words) else { error.exit() };
        runs::err!("{answer}");
        std::process::exit(2);
    });
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let asked = std::env::var_os(runs::THREADS_VARIABLE);
    let done = runs::with_threads(asked.as_deref(), || execute(arguments));
    match done.map_err(Error::from).and_then(|done| done) {
        Ok(code) => code,
        Err(error) => {
            runs::err!("{error}");
            let mistake = error.is_scene() || matches!(error, Error::Argument { .. });
            ExitCode::from(if mistake { 2 } else { 1 })
        }
    }
}

fn execute(arguments: Arguments) -> Result<ExitCode> {
    match arguments.command {
        Command::Press { asked, out, threads, verbose } => press_map(&asked, out, threads, verbose),
        Command::New { asked, scene } => write_scene(&asked, scene),
        Command::Plan { scene, out, nodes, node_cores, division } => {
            let cores = node_cores.map_or_else(all_threads, usize::from);
            let nodes = nodes.map(|nodes| (nodes.into(), cores));
            print_plan(&scene, out, nodes, &division)
        }
        Command::Run { scene, out, threads, fresh, shard, verbose } => {
            let out = out.unwrap_or_else(|| default_directory(&scene));
            let options = Options { out, threads: threads.unwrap_or_else(all_threads), fresh };
            match shard {
                Some(choice) => cluster::shard(&scene, choice, &options, &reporter(verbose)),
                None => run_scene(SceneFile::read(&scene)?, &options, verbose, &|| Ok(())),
            }
        }
        Command::Submit { scene, out, submission, division } => {
            let out = out.unwrap_or_else(|| default_directory(&scene));
            let Some(read) = read_to_plan(&scene, out.clone())? else { return Ok(STOPPED.into()) };
            cluster::submit((&scene, &read), &out, &submission, &division)
        }
        Command::Status(options) => cluster::status(&options),
        Command::Merge { options, verbose } => {
            let scene = cluster::merged(&options)?;
            let options = Options { out: options.out, threads: all_threads(), fresh: false };
            run_scene(SceneFile::read(&scene)?, &options, verbose, &|| Ok(()))
        }
        Command::Info { file, json, out, more } => {
            let (declared, preprocessing) = more.options()?;
            Ok(printed(&match out {
                None if json => info_json(&file, &declared, &preprocessing)?,
                None => info(&file, &declared, &preprocessing)?,
                Some(out) => info_statistics(&file, &declared, &preprocessing, &out)?,
            }))
        }
        Command::Surface(asked) => Ok(printed(&generated_surface(&asked)?.write(&asked.file)?)),
        Command::Twin { file, twin, seed, rings, keep_heights, more } => {
            let (declared, preprocessing) = more.options()?;
            let like = if rings { TwinSpectrum::Rings } else { TwinSpectrum::EachWave };
            let (declared, preprocessing) = (&declared, &preprocessing);
            let asked = AskedTwin { declared, preprocessing, like, keep_heights, seed };
            Ok(printed(&write_twin(&file, &asked, &twin)?))
        }
        Command::Models { name } => Ok(printed(&models(name.as_deref())?)),
        Command::Completions { shell } => {
            Ok(printed(&String::from_utf8_lossy(&arguments::completions(shell))))
        }
        Command::Man { directory } => {
            runs::files::create_directory(&directory)?;
            let unwritten = runs::Error::file("write the pages of", &directory);
            clap_mangen::generate_to(arguments::command(), &directory).map_err(unwritten)?;
            runs::out!("{}", directory.join("fractal-contact.1").display());
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Prints a text, which is all that a command does.
fn printed(text: &str) -> ExitCode {
    runs::print(format_args!("{text}"));
    ExitCode::SUCCESS
}

/// Prints what a scene will compute, and how it divides over `nodes`: their number, and the cores of each.
fn print_plan(
    scene: &Path,
    out: Option<PathBuf>,
    nodes: Option<(usize, usize)>,
    division: &Division,
) -> Result<ExitCode> {
    let out = out.unwrap_or_else(|| default_directory(scene));
    let Some(scene) = read_to_plan(scene, out)? else { return Ok(STOPPED.into()) };
    let plan = Plan::calibrated(&scene)?;
    runs::print(format_args!("{}", shown(plan.to_string(), std::io::stdout().is_terminal())));
    if let Some(nodes) = nodes {
        cluster::tell(&scene, &plan, division, nodes)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The surface that the flags of `surface` describe.
fn generated_surface(asked: &SurfaceArguments) -> Result<GeneratedSurface> {
    if let Some(hurst) = asked.hurst.filter(|hurst| !(0.0..=1.0).contains(hurst)) {
        return Err(runs::Error::parameter("hurst", hurst, "a number in [0, 1]").into());
    }
    let fractal_dimension = asked.fractal_dimension.or_else(|| Some(3.0 - asked.hurst?));
    Ok(GeneratedSurface {
        cells: asked.cells,
        rows: asked.rows,
        size: asked.size.clone(),
        fractal_dimension: fractal_dimension.unwrap_or(2.4),
        rms_height: asked.rms_height.clone(),
        roll_off_wavelength: asked.roll_off_wavelength.clone(),
        shortest_wavelength: asked.shortest_wavelength.clone(),
        anisotropy: asked.anisotropy.map(|ratio| Anisotropy { ratio, lay: asked.lay }),
        heights: asked.weibull.map(|shape| HeightDistribution::Weibull { shape }),
        seed: asked.seed,
    })
}

/// Writes the scene that flags describe beside its results, and runs it.
fn press_map(
    asked: &PressArguments,
    out: Option<PathBuf>,
    threads: Option<usize>,
    verbose: bool,
) -> Result<ExitCode> {
    let out = out.unwrap_or_else(|| default_directory(&asked.map));
    let path = out.join("scene.toml");
    press::check_place(&path)?;
    let scene = press::scene(asked, &path)?;
    let text = scene.text.clone();
    let is_written = std::cell::Cell::new(false);
    let begin = || {
        runs::files::write_whole(&path, text.as_bytes())?;
        is_written.set(true);
        if let Some(note) = asked.note() {
            runs::err!("{note}");
        }
        if verbose {
            runs::err!("{}", path.display());
        }
        Ok(())
    };
    let options = Options { out, threads: threads.unwrap_or_else(all_threads), fresh: false };
    let done = run_scene(scene, &options, verbose, &begin);
    if done.is_err() {
        // A folder that was made for this scene and is still empty.
        std::fs::remove_dir(&options.out).ok();
    }
    done.map_err(|error| match error {
        Error::Scene(mistake) if !is_written.get() => Error::from(mistake.told_of(press::WORDS)),
        other => other,
    })
}

/// Writes the scene that flags describe.
fn write_scene(asked: &PressArguments, scene: Option<PathBuf>) -> Result<ExitCode> {
    let path = scene.unwrap_or_else(|| default_scene(&asked.map));
    if path.exists() {
        let reason = format!("{} exists: move it away, or give another name with --scene", path.display());
        return Err(Error::Argument { name: "scene", reason });
    }
    let scene = press::scene(asked, &path)?;
    runs::files::write_whole(&path, scene.text.as_bytes())?;
    if let Some(note) = asked.note() {
        runs::err!("{note}");
    }
    runs::out!("{}", path.display());
    runs::err!("fractal-contact run {}", runs::cluster::quoted(&path.to_string_lossy()));
    Ok(ExitCode::SUCCESS)
}

/// The models of the library, or one of them, with their abilities.
fn models(name: Option<&str>) -> Result<String> {
    let chosen: Vec<&ModelRecord> =
        MODELS.iter().filter(|record| name.is_none_or(|name| record.name() == name)).collect();
    if let (Some(name), true) = (name, chosen.is_empty()) {
        let known: Vec<&str> = MODELS.iter().map(ModelRecord::name).collect();
        let reason = format!("there is no model \"{name}\": there are {}", known.join(", "));
        return Err(Error::Argument { name: "model", reason });
    }
    Ok(chosen.into_iter().map(ToString::to_string).collect())
}

fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// `out/NAME` beside where the program is called.
fn default_directory(scene: &Path) -> PathBuf {
    Path::new("out").join(scene.file_stem().unwrap_or_default())
}

/// `NAME.toml` where the program is called.
fn default_scene(map: &Path) -> PathBuf {
    Path::new(map.file_name().unwrap_or_default()).with_extension("toml")
}

/// Text as a terminal has room for it; in files and pipes lines stay whole.
fn shown(text: String, terminal: bool) -> String {
    if terminal { runs::folded(&text) } else { text }
}

/// The report, to be opened, and what else is in its folder, in one line: pictures and fields are counted,
/// there may be thousands.
fn written(folder: &Path, files: &[PathBuf]) -> String {
    const REPORT: &str = "report.html";
    let (mut named, mut pictures, mut fields) = (Vec::new(), 0, 0);
    for file in files {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        match file.extension().and_then(|ending| ending.to_str()) {
            Some("png" | "svg") => pictures += 1,
            Some("npy" | "vti") => fields += 1,
            _ if name == REPORT => {}
            _ => named.push(name.into_owned()),
        }
    }
    for (count, one) in [(pictures, "picture"), (fields, "field")] {
        let ending = if count == 1 { "" } else { "s" };
        named.extend((count > 0).then(|| format!("{count} {one}{ending}")));
    }
    format!("{}, and beside it {}\n", folder.join(REPORT).display(), named.join(", "))
}

/// The progress of a run, on the terminal or not at all.
fn reporter(verbose: bool) -> runs::Reporter {
    if verbose { runs::Reporter::new() } else { runs::Reporter::quiet() }
}

/// Writes to standard error, folded on a terminal.
fn say(text: String) {
    runs::print_error(format_args!("{}\n", shown(text, std::io::stderr().is_terminal())));
}

/// Exit code of a command that a signal stopped.
const STOPPED: u8 = 130;

/// Reads a scene and chooses its grid; `None` where a signal came first. Where no grid is chosen a signal ends
/// the program at once.
fn read_to_plan(path: &Path, out: PathBuf) -> Result<Option<SceneFile>> {
    let scene = SceneFile::read(path)?;
    if scene.accuracy.is_none() {
        return Ok(Some(scene));
    }
    let options = Options { out, threads: all_threads(), fresh: false };
    with_grid(scene, &options, &reporter(false), &*stopped_by_signals()?)
}

/// Runs a scene and prints its answer: a line on what is solved, the states, what to beware of, and the
/// report. `verbose` prints the whole plan before, and what the run took after. `begin` is called once the scene
/// is planned, so that it has no effect where a model refuses the scene.
fn run_scene(
    scene: SceneFile,
    options: &Options,
    verbose: bool,
    begin: &dyn Fn() -> Result<()>,
) -> Result<ExitCode> {
    let (stopped, reporter) = (stopped_by_signals()?, reporter(verbose));
    let Some(scene) = with_grid(scene, options, &reporter, &stopped)? else { return Ok(STOPPED.into()) };
    let plan = Plan::for_run(&scene)?;
    begin()?;
    if verbose {
        say(plan.to_string());
    } else {
        say(plan.line(options.threads));
        if scene.pair.is_none() && scene.system == System::Si {
            say(plan.contact_modulus.clone());
        }
        plan.notes.iter().for_each(|note| say(note.to_string()));
    }
    let outcome = run(&scene, &plan, options, &reporter, &|| stopped.load(Ordering::Relaxed))?;
    runs::print(format_args!("{}", outcome.summary));
    for note in &outcome.notes {
        say(format!("note: {note}"));
    }
    // The scene that `press` has written stands beside its results.
    let own = Some(scene.path.clone()).filter(|path| path.parent() == Some(&options.out));
    let files: Vec<PathBuf> = own.into_iter().chain(outcome.files.iter().cloned()).collect();
    runs::print(format_args!("{}", written(&options.out, &files)));
    if verbose {
        say_costs(&plan, &outcome);
    }
    Ok(how_it_went(&outcome))
}

/// The cost of a run: time, work and memory, beside the prediction.
fn say_costs(plan: &Plan, outcome: &SceneOutcome) {
    for (planned, (name, actual, bytes)) in plan.models.iter().zip(&outcome.actual) {
        runs::err!("{name}");
        if let Some(predicted) = plan.predicted_words(planned) {
            say(format!("  predicted  {predicted}"));
        }
        say(format!("  actual     {actual} (earlier runs included), {bytes} bytes of field files"));
    }
    if let Some(peak) = outcome.peak_memory {
        runs::err!("memory       {} MB at the peak, with the program itself", peak / 1_000_000);
    }
    let SceneOutcome { requested, states, kept, .. } = outcome;
    runs::err!(
        "states       {requested} requested, {states} in the table ({kept} of them kept from an earlier run)"
    );
}

/// Says what was refused, missed its tolerance or was not attempted, and gives the exit code.
fn how_it_went(outcome: &SceneOutcome) -> ExitCode {
    let SceneOutcome { requested, states, failed, .. } = *outcome;
    let not_attempted = outcome.not_attempted();
    let were = |count: usize| if count == 1 { "was" } else { "were" };
    if failed > 0 {
        say(format!(
            "{failed} of {requested} states {} refused or did not reach the tolerance: see the column `status` of results.csv.",
            were(failed)
        ));
    }
    if outcome.pulled_off > 0 {
        say(
            "A path ends where the bodies come apart: the attraction cannot hold the force of its next step."
                .to_owned(),
        );
    }
    if outcome.stopped {
        say(format!(
            "Stopped: {states} of {requested} states are kept. The same command goes on with the others."
        ));
        return STOPPED.into();
    }
    if not_attempted > 0 {
        say(format!(
            "{not_attempted} of {requested} states {} not attempted, because {} after {}.",
            were(not_attempted),
            if not_attempted == 1 { "it comes" } else { "they come" },
            if failed == 0 { "the pull-off" } else { "a step that failed" }
        ));
    }
    if failed + outcome.pulled_off > 0 { ExitCode::from(3) } else { ExitCode::SUCCESS }
}
