//! The program: arguments, progress, Ctrl-C and exit codes; no science.

mod arguments;

use arguments::{Arguments, Command};
use clap::{CommandFactory as _, Parser as _};
use fractal_contact::scenes::{Error, GeneratedSurface, Options, Plan, Result, SceneFile, info, run};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

fn main() -> ExitCode {
    match execute(Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(if error.is_scene() { 2 } else { 1 })
        }
    }
}

fn execute(arguments: Arguments) -> Result<ExitCode> {
    match arguments.command {
        Command::Plan { scene } => {
            print!("{}", Plan::calibrated(&SceneFile::read(&scene)?)?);
            Ok(ExitCode::SUCCESS)
        }
        Command::Run { scene, out, threads, fresh } => {
            let out = out.unwrap_or_else(|| default_directory(&scene));
            let threads =
                threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
            run_scene(&scene, &Options { out, threads, fresh })
        }
        Command::Info { file, format, unit, size, cell } => {
            let declared =
                surface_io::ReadOptions { format, unit, size, cell, ..surface_io::ReadOptions::default() };
            print!("{}", info(&file, &declared)?);
            Ok(ExitCode::SUCCESS)
        }
        Command::Surface {
            file,
            cells,
            rows,
            size,
            fractal_dimension,
            rms_height,
            roll_off_wavelength,
            shortest_wavelength,
            seed,
        } => {
            let make = GeneratedSurface {
                cells,
                rows,
                size,
                fractal_dimension,
                rms_height,
                roll_off_wavelength,
                shortest_wavelength,
                seed,
            };
            print!("{}", make.write(&file)?);
            Ok(ExitCode::SUCCESS)
        }
        Command::Completions { shell } => {
            clap_complete::generate(
                shell,
                &mut Arguments::command(),
                "fractal-contact",
                &mut std::io::stdout(),
            );
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// `out/NAME` beside where the program is called.
fn default_directory(scene: &Path) -> std::path::PathBuf {
    Path::new("out").join(scene.file_stem().unwrap_or_default())
}

fn run_scene(path: &Path, options: &Options) -> Result<ExitCode> {
    let scene = SceneFile::read(path)?;
    let plan = Plan::calibrated(&scene)?;
    eprint!("{plan}");
    let stopped = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stopped);
    // The first Ctrl-C asks the solvers to stop, the second ends the process.
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        eprintln!("stopping: the states so far are written; once more ends at once");
    })
    .map_err(|e| Error::Argument { name: "Ctrl-C", reason: e.to_string() })?;
    let outcome = run(&scene, &plan, options, &runs::Reporter::new(), &|| stopped.load(Ordering::Relaxed))?;
    for (planned, (name, actual, bytes)) in plan.models.iter().zip(&outcome.actual) {
        if let Some(predicted) = &planned.predicted {
            eprintln!("{name}\n  predicted  {predicted}");
        }
        eprintln!("  actual     {actual}, {bytes} bytes of field files");
    }
    if let Some(peak) = outcome.peak_memory {
        eprintln!("memory       {} MB at the peak, the program itself included", peak / 1_000_000);
    }
    for note in &outcome.notes {
        eprintln!("note: {note}");
    }
    for file in &outcome.files {
        println!("{}", file.display());
    }
    if outcome.stopped {
        eprintln!("stopped: the states so far are in the files; the same command goes on");
        return Ok(ExitCode::from(130));
    }
    if outcome.failed > 0 {
        eprintln!(
            "{} of {} states were refused or did not reach their tolerance",
            outcome.failed, outcome.states
        );
        return Ok(ExitCode::from(3));
    }
    Ok(ExitCode::SUCCESS)
}
