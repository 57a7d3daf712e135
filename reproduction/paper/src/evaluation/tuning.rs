//! The effect of each tuned constant of the boundary-element solver: the time of a set of paths with half and
//! with twice its value.

use crate::evaluation::table_of::TableOf;
use bem3d::Bem3d;
use bem3d::benchmarks::{CONSTANTS, Constant, prepare_tuned};
use contact_model::{Hardness, Load, Scene, SelfAffine, Surface};
use runs::{Error, Header, Progress, Result, files, on_one_thread, write_csv};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Loads one after the other on one surface.
struct WarmPath {
    cells: usize,
    fractal_dimension: f64,
    /// Loads F_bar.
    loads: &'static [f64],
    tolerance: f64,
    /// Hardness over E* times the rms height over the side.
    hardness: Option<f64>,
}

impl WarmPath {
    const fn new(cells: usize, fractal_dimension: f64, loads: &'static [f64], tolerance: f64) -> Self {
        Self { cells, fractal_dimension, loads, tolerance, hardness: None }
    }
}

/// The paths: factors, two-level sums, transforms of scattered, half and nearly full contact; from three to
/// eight digits; one with a hardness of a tenth of E* times the rms gradient.
const PATHS: [WarmPath; 6] = [
    WarmPath::new(257, 2.4, &[1e-6, 1e-4, 1e-2, 0.1, 1.0, 20.0], 1e-8),
    WarmPath::new(513, 2.0, &[1e-3, 0.03, 0.3, 3.0, 20.0], 1e-6),
    WarmPath::new(513, 2.8, &[1e-3, 0.1, 1.0, 10.0], 1e-3),
    WarmPath::new(1025, 2.4, &[0.02, 0.2], 1e-3),
    WarmPath::new(1025, 2.7, &[0.1, 0.3], 1e-6),
    WarmPath { hardness: Some(HARDNESS), ..WarmPath::new(257, 2.4, &[1e-3, 1e-2, 0.1, 1.0], 1e-6) },
];
/// The rms gradient of that surface is 40 times its rms height over its side.
const HARDNESS: f64 = 4.0;

/// A run that takes more than this multiple of the time with the shipped value is stopped.
const LONGEST: f64 = 4.0;

/// The effect of a multiple of a constant.
#[derive(Debug, Clone, Copy)]
pub struct Multiple {
    /// Ratio of the time to that with the shipped value, of runs one after the other; the median of the
    /// repetitions.
    pub time: f64,
    /// Ratio of the applications of the influence matrix to those with the shipped value.
    pub applications: f64,
    /// Whether every load met its tolerance in time.
    pub converged: bool,
}

/// One constant.
#[derive(Debug, Clone, Copy)]
pub struct ConstantRow {
    /// Name in `bem3d`'s `tuning.rs`; `.0` and `.1` are the ends of a range.
    pub name: &'static str,
    /// With half of it.
    pub half: Multiple,
    /// With twice of it.
    pub twice: Multiple,
}

/// Time and work of the paths, and whether all loads converged.
struct PathsCost {
    seconds: f64,
    applications: usize,
    converged: bool,
}

/// Solves the set `repetitions` times with half, with twice and with the shipped value of each constant whose
/// name contains `only`. Writes `tuning.csv` into `out` and passes on each row as soon as it is measured.
///
/// # Errors
/// [`Error::Parameter`] where no constant has such a name; errors of the model; [`Error::File`] where the
/// table cannot be written.
pub fn tuning(
    only: &str,
    repetitions: usize,
    out: &Path,
    progress: &dyn Progress,
    found: &dyn Fn(&ConstantRow),
) -> Result<PathBuf> {
    let constants: Vec<Constant> = CONSTANTS.into_iter().filter(|(name, _)| name.contains(only)).collect();
    if constants.is_empty() {
        let names = CONSTANTS.map(|(name, _)| name).join(", ");
        return Err(Error::parameter("only", format!("\"{only}\""), format!("a part of one of {names}")));
    }
    files::create_directory(out)?;
    let repetitions = repetitions.max(1);
    progress.begin("tuned constants", (constants.len() * repetitions) as u64);
    // What is touched for the first time is slower.
    on_one_thread(|| run(CONSTANTS[0], 1.0, f64::INFINITY))?;
    let mut rows = Vec::with_capacity(constants.len());
    for constant in constants {
        let mut pairs: [Vec<Multiple>; 2] = Default::default();
        for _ in 0..repetitions {
            let shipped = on_one_thread(|| run(constant, 1.0, f64::INFINITY))?;
            for (factor, pairs) in [0.5, 2.0].into_iter().zip(&mut pairs) {
                let other = on_one_thread(|| run(constant, factor, LONGEST * shipped.seconds))?;
                pairs.push(Multiple {
                    time: other.seconds / shipped.seconds,
                    applications: other.applications as f64 / shipped.applications.max(1) as f64,
                    converged: other.converged,
                });
            }
            progress.advance(1, false);
        }
        let [half, twice] = pairs.map(|mut pairs| {
            pairs.sort_by(|a, b| a.time.total_cmp(&b.time));
            pairs[pairs.len() / 2]
        });
        let row = ConstantRow { name: constant.0, half, twice };
        found(&row);
        rows.push(row);
    }
    progress.end();
    let path = out.join("tuning.csv");
    let command = format!("cargo xtask tuning --repetitions {repetitions}");
    let header = Header { command, ..Header::default() }.with_note(paths());
    write_csv(&path, &table(&rows)?, &header)?;
    Ok(path)
}

/// The paths in words.
fn paths() -> String {
    let one = |path: &WarmPath| {
        let WarmPath { cells, fractal_dimension: d, loads, tolerance, hardness } = path;
        let hardness = hardness.map_or_else(String::new, |p| format!(", hardness {p:?} E* h/L"));
        format!("N = {cells}, D_f = {d:?}, F_bar = {loads:?}, tolerance {tolerance:e}{hardness}")
    };
    format!("one thread; seed 1; each a warm path: {}", PATHS.iter().map(one).collect::<Vec<_>>().join("; "))
}

fn table(rows: &[ConstantRow]) -> Result<contact_model::Table> {
    const TIME: &str = "time over that with the value shipped";
    const WORK: &str = "applications of the influence matrix over those with the value shipped";
    const MET: &str = "whether every load met its tolerance within four times the time";
    TableOf::new("What half and twice of each tuned constant cost", rows)
        .column("constant", "-", "name in bem3d/src/tuning.rs; .0 and .1 are the ends of a range", |r| r.name)
        .column("time_half", "1", TIME, |r| r.half.time)
        .column("time_twice", "1", TIME, |r| r.twice.time)
        .column("applications_half", "1", WORK, |r| r.half.applications)
        .column("applications_twice", "1", WORK, |r| r.twice.applications)
        .column("converged_half", "-", MET, |r| if r.half.converged { "yes" } else { "no" })
        .column("converged_twice", "-", MET, |r| if r.twice.converged { "yes" } else { "no" })
        .table()
}

/// All paths with a multiple of a constant, until the time is up.
fn run((name, multiply): Constant, factor: f64, longest: f64) -> Result<PathsCost> {
    let start = Instant::now();
    let stop = || start.elapsed().as_secs_f64() > longest;
    let mut cost = PathsCost { seconds: 0.0, applications: 0, converged: true };
    let failed = |e| Error::model(format!("{factor} x {name}"))(e);
    for WarmPath { cells, fractal_dimension, loads, tolerance, hardness } in PATHS {
        let surface = SelfAffine::new(fractal_dimension, 1.0, 1.0).map_err(failed)?;
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        if let Some(pressure) = hardness {
            scene.effects.hardness = Hardness::Limit { pressure };
        }
        let model = Bem3d { cells, tolerance, ..Bem3d::default() };
        let mut contact = prepare_tuned(&model, &scene, 1, (name, multiply), factor).map_err(failed)?;
        for &force_bar in loads {
            let force = contact.normalisation().force(force_bar).map_err(failed)?;
            let state =
                contact.solve_until(Load::force(force), &stop).or_else(contact_model::Error::into_best);
            match state {
                Ok(state) => {
                    cost.applications += state.report.applications;
                    cost.converged &= state.report.status == contact_model::Status::Converged;
                }
                Err(contact_model::Error::Stopped { .. }) => cost.converged = false,
                Err(e) => return Err(failed(e)),
            }
        }
    }
    cost.seconds = start.elapsed().as_secs_f64();
    Ok(cost)
}
