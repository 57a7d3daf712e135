//! Measures the cost of solves: one row for each surface, tolerance and load, with the work, the time, the
//! memory and the certificate.

use crate::evaluation::forces::Forces;
use crate::evaluation::limits::{self, require, within};
use crate::evaluation::realisation::Discretisation;
use crate::evaluation::square_map::{read_map, unit_area};
use crate::evaluation::table_of::{maybe, names};
use crate::output::write_npy;
use bem3d::benchmarks::{Part, PartTime, Recorder, prepare_recorded};
use bem3d::{Bem3d, Method};
use contact_model::{
    Boundary, Cells, Certificate, ContactState, Load, Normalisation, PreparedContact, Scene, SelfAffine,
    Stop, Surface, never,
};
use runs::{
    Error, Result, Threads, collect, files, number, peak_memory, process_cpu_seconds, reset_peak_memory,
    run_jobs, threads_for_memory,
};
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};
use std::time::Instant;

/// The solves that are measured.
#[derive(Debug, Clone)]
pub struct Bench {
    /// Which surfaces.
    pub surfaces: Surfaces,
    /// Loads F_bar. They are solved in increasing order; the rows have the order in which the loads were
    /// given.
    pub forces: Forces,
    /// Tolerances, each a series of its own.
    pub tolerances: Vec<f64>,
    /// Boundary conditions at the edges of the square.
    pub boundary: Boundary,
    /// How the linear systems are solved.
    pub method: Method,
    /// Whether each load is solved from a cold start, set-up included; otherwise one prepared contact is
    /// solved under increasing loads.
    pub cold: bool,
    /// Threads, at least 1: as many series are solved at the same time, and threads without a series help
    /// inside the others.
    pub threads: usize,
    /// Directory for the pressure of each row (NPY, row-major, in units of E*).
    pub pressure: Option<PathBuf>,
}

/// The clock for the times of the parts, in nanoseconds.
pub type Clock = fn() -> u64;

/// Nanoseconds since the first call in this process.
pub fn elapsed() -> u64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_nanos() as u64
}

/// The time of some rows by the parts of a solve: a line for each part, the largest first.
pub fn parts_table(rows: &[BenchRow]) -> Vec<String> {
    let mut parts: Vec<(Part, PartTime)> = Vec::new();
    for &(part, spent) in rows.iter().flat_map(|row| &row.parts) {
        match parts.iter_mut().find(|(p, _)| *p == part) {
            Some((_, sum)) => {
                *sum = PartTime { time: sum.time + spent.time, times: sum.times + spent.times };
            }
            None => parts.push((part, spent)),
        }
    }
    parts.sort_by_key(|(_, spent)| std::cmp::Reverse(spent.time));
    let all: u64 = parts.iter().map(|(_, spent)| spent.time).sum();
    let line = |(part, spent): &(Part, PartTime)| {
        let (seconds, share) = (spent.time as f64 * 1e-9, 100.0 * spent.time as f64 / all.max(1) as f64);
        format!("{:<34} {:>8} {seconds:>10.3} {share:>6.1} %", part.name(), spent.times)
    };
    let head = format!("{:<34} {:>8} {:>10} {:>8}", "part", "times", "seconds", "share");
    std::iter::once(head).chain(parts.iter().map(line)).collect()
}

/// Surfaces of a bench.
#[derive(Debug, Clone)]
pub enum Surfaces {
    /// A map without preprocessing, with square cells and `sqrt(Lx Ly) = 1`.
    File(PathBuf),
    /// Self-affine surfaces without roll-off, every size with every fractal dimension.
    SelfAffine {
        /// Columns.
        cells: Vec<usize>,
        /// Rows of square cells on a rectangle of area 1; `None`: as many as columns.
        rows: Option<usize>,
        /// D_f.
        fractal_dimensions: Vec<f64>,
        /// Seed of the surface itself.
        seed: u64,
    },
}

/// One solve.
#[derive(Debug, Clone)]
pub struct BenchRow {
    /// File name, or `self-affine`.
    pub surface: String,
    /// D_f and seed of a generated surface.
    pub drawn: Option<(f64, u64)>,
    /// Columns and rows of the map.
    pub cells: Cells,
    /// F/(E* h L) with the measured rms height.
    pub force_bar: f64,
    /// The requested tolerance.
    pub tolerance: f64,
    /// The state, converged or the best that was reached.
    pub state: ContactState,
    /// Normalisation of this surface.
    pub normalisation: Normalisation,
    /// Wall-clock seconds: the first row of a prepared contact includes preparing it.
    pub seconds: f64,
    /// Processor seconds on all threads, where the platform reports them and no other series was solved at
    /// the same time.
    pub cpu_seconds: Option<f64>,
    /// The parts of the solve, with their nanoseconds and their number of calls; empty without a clock.
    pub parts: Vec<(Part, PartTime)>,
    /// Largest resident memory of the process during this row, in bytes, where the platform reports it. It
    /// includes the memory of other threads, and counts from the start of the process where the count cannot
    /// be reset.
    pub peak_memory: Option<u64>,
    /// Whether it was solved from a cold start.
    pub cold: bool,
}

/// Name of a column and its value; a missing value is empty.
type BenchColumn = (&'static str, fn(&BenchRow) -> String);

const COLUMNS: [BenchColumn; 26] = [
    ("cells", |r| r.cells.columns.to_string()),
    ("force_bar", |r| number(r.force_bar)),
    ("approach_over_h", |r| maybe(r.approach_over_h().ok().flatten())),
    ("stiffness_bar", |r| maybe(r.state.stiffness.map(|k| r.normalisation.stiffness_bar(k)))),
    ("contact_cells", |r| r.state.report.contact_cells.map(|n| n.to_string()).unwrap_or_default()),
    ("penetration", |r| number(r.certificate().penetration)),
    ("duality_gap", |r| number(r.certificate().duality_gap)),
    ("iterations", |r| r.state.report.iterations.to_string()),
    ("applications", |r| r.state.report.applications.to_string()),
    ("seconds", |r| number(r.seconds)),
    ("strategy", |r| r.state.report.strategy.clone()),
    ("status", |r| r.state.report.status.as_str().to_owned()),
    ("tolerance", |r| number(r.tolerance)),
    ("complementarity", |r| number(r.certificate().complementarity)),
    ("load_error", |r| number(r.certificate().load_error)),
    ("stiffness_error", |r| maybe(r.certificate().stiffness_error)),
    ("stiffness", |r| maybe(r.state.stiffness)),
    ("mean_gap_over_h", |r| maybe(r.height().zip(r.state.mean_gap).map(|(h, gap)| gap / h))),
    ("cpu_seconds", |r| maybe(r.cpu_seconds)),
    ("peak_memory_bytes", |r| r.peak_memory.map(|b| b.to_string()).unwrap_or_default()),
    ("start", |r| if r.cold { "cold" } else { "warm" }.to_owned()),
    ("surface", |r| r.surface.clone()),
    ("fractal_dimension", |r| maybe(r.drawn.map(|(d, _)| d))),
    ("seed", |r| r.drawn.map(|(_, seed)| seed.to_string()).unwrap_or_default()),
    ("rows", |r| r.cells.rows.to_string()),
    ("version", |_| env!("CARGO_PKG_VERSION").to_owned()),
];

/// Names of the columns of the table, in order.
pub const BENCH_COLUMNS: [&str; COLUMNS.len()] = names(&COLUMNS);

impl BenchRow {
    /// The row as text, in the order of [`BENCH_COLUMNS`]; missing values are empty.
    ///
    /// # Errors
    /// [`Error::Model`] when a value does not fit in a double.
    pub fn fields(&self) -> Result<[String; BENCH_COLUMNS.len()]> {
        self.approach_over_h()?;
        Ok(COLUMNS.map(|(_, field)| field(self)))
    }

    fn certificate(&self) -> &Certificate {
        &self.state.report.certificate
    }

    /// The rms height, where the surface has one.
    fn height(&self) -> Option<f64> {
        self.normalisation.height.filter(|h| *h > 0.0)
    }

    fn approach_over_h(&self) -> Result<Option<f64>> {
        let approach = self.state.approach.filter(|_| self.height().is_some());
        approach.map(|d| self.normalisation.approach_over_h(d)).transpose().map_err(Error::model("approach"))
    }

    /// Whether it met its tolerance.
    pub fn converged(&self) -> bool {
        self.state.report.status == contact_model::Status::Converged
    }
}

/// One surface at one tolerance.
struct BenchSeries {
    surface: String,
    drawn: Option<(f64, u64)>,
    cells: Cells,
    scene: Scene,
    seed: u64,
    model: Bem3d,
}

/// Solves everything, with increasing loads, and passes each row to `found` as soon as it is solved. The
/// returned rows are in the requested order: surfaces, tolerances, loads. With a clock each row has the times
/// of its parts.
///
/// # Errors
/// [`Error::Parameter`] or [`Error::File`] before anything is solved; [`Error::Model`] for errors of the
/// model; errors of `found`. The first error stops everything.
pub fn bench(
    bench: &Bench,
    clock: Option<Clock>,
    found: &(dyn Fn(&BenchRow) -> Result<()> + Sync),
) -> Result<Vec<BenchRow>> {
    within("threads", bench.threads, &(1..=runs::MOST_THREADS))?;
    if let Surfaces::SelfAffine { cells, rows, .. } = &bench.surfaces {
        cells.iter().try_for_each(|&cells| within("cells", cells, &limits::CELLS).map(drop))?;
        rows.iter().try_for_each(|&rows| within("rows", rows, &(1..=*limits::CELLS.end())).map(drop))?;
    }
    let expected = "numbers between 0 and 1, both excluded";
    let between = |t: &f64| require(*t > 0.0 && *t < 1.0, "tolerance", format!("{t:?}"), expected);
    bench.tolerances.iter().try_for_each(between)?;
    let series = series(bench)?;
    let largest = series.iter().map(|s| s.cells).max_by_key(|cells| cells.checked_count());
    if let Some(cells) = largest {
        let discretisation = Discretisation::Bem3d { cells: cells.columns, tolerance: 0.0 };
        let memory = discretisation.memory() * cells.rows as f64 / cells.columns.max(1) as f64;
        threads_for_memory(1, memory.max(1.0), "cells", format!("{} x {}", cells.columns, cells.rows))?;
    }
    if let Some(directory) = &bench.pressure {
        files::create_directory(directory)?;
    }
    let order: Vec<usize> = (0..series.len()).collect();
    let alone = bench.threads == 1 || series.len() == 1;
    let done = run_jobs(Threads::all(bench.threads), &order, &never, |i, stop| {
        series[i].run(bench, clock, alone, stop, found)
    });
    Ok(collect(done)?.into_iter().flatten().collect())
}

fn series(bench: &Bench) -> Result<Vec<BenchSeries>> {
    let mut surfaces = Vec::new();
    match &bench.surfaces {
        Surfaces::File(path) => {
            let map = read_map(path)?;
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            surfaces.push((name, None, map.cells(), 0, Surface::Heights(Arc::new(map))));
        }
        Surfaces::SelfAffine { cells, rows, fractal_dimensions, seed } => {
            for &d in fractal_dimensions {
                for &columns in cells {
                    let cells = Cells { columns, rows: rows.unwrap_or(columns) };
                    let surface = SelfAffine::new(d, unit_area(cells), 1.0)
                        .map_err(Error::model(format!("D_f = {d:?}")))?;
                    let surface = Surface::SelfAffine(surface);
                    surfaces.push(("self-affine".to_owned(), Some((d, *seed)), cells, *seed, surface));
                }
            }
        }
    }
    let mut all = Vec::new();
    for (name, drawn, cells, seed, surface) in surfaces {
        for &tolerance in &bench.tolerances {
            let mut scene = Scene::new(surface.clone(), 1.0);
            scene.effects.boundary = bench.boundary;
            scene.outputs.pressure = bench.pressure.is_some();
            scene.outputs.mean_gap = bench.boundary == Boundary::Periodic;
            let (columns, rows) = (cells.columns, Some(cells.rows));
            let model = Bem3d { cells: columns, rows, tolerance, method: bench.method, ..Bem3d::default() };
            all.push(BenchSeries { surface: name.clone(), drawn, cells, scene, seed, model });
        }
    }
    Ok(all)
}

impl BenchSeries {
    fn prepare(&self, recorder: &Recorder) -> Result<Box<dyn PreparedContact>> {
        prepare_recorded(&self.model, &self.scene, self.seed, recorder)
            .map_err(Error::model(format!("bem3d on {}", self.surface)))
    }

    fn run(
        &self,
        bench: &Bench,
        clock: Option<Clock>,
        alone: bool,
        stop: Stop<'_>,
        found: &(dyn Fn(&BenchRow) -> Result<()> + Sync),
    ) -> Result<Vec<BenchRow>> {
        let recorder = clock.map_or_else(Recorder::default, Recorder::new);
        let mut rows = Vec::with_capacity(bench.forces.values().len());
        let mut contact: Option<Box<dyn PreparedContact>> = None;
        for &force_bar in bench.forces.values() {
            let fresh = contact.is_none() || bench.cold;
            if fresh {
                contact = None; // Its memory first.
            }
            reset_peak_memory();
            let cpu = process_cpu_seconds().filter(|_| alone);
            let _ = recorder.take();
            let start = Instant::now();
            let prepared = match &mut contact {
                Some(prepared) => prepared,
                none => none.insert(self.prepare(&recorder)?),
            };
            let normalisation = prepared.normalisation();
            let what = || format!("bem3d on {} at F_bar = {force_bar:?}", self.surface);
            let load = Load::force(normalisation.force(force_bar).map_err(Error::model(what()))?);
            let state = prepared.solve_until(load, stop).or_else(contact_model::Error::into_best);
            let state = state.map_err(Error::model(what()))?;
            let seconds = start.elapsed().as_secs_f64();
            let mut row = BenchRow {
                surface: self.surface.clone(),
                drawn: self.drawn,
                cells: self.cells,
                force_bar,
                tolerance: self.model.tolerance,
                state,
                normalisation,
                seconds,
                cpu_seconds: cpu.zip(process_cpu_seconds()).map(|(a, b)| b - a),
                parts: recorder.take(),
                peak_memory: peak_memory(),
                cold: fresh,
            };
            if let Some(directory) = &bench.pressure {
                self.save_pressure(directory, &mut row)?;
            }
            found(&row)?;
            rows.push(row);
        }
        let place =
            |row: &BenchRow| bench.forces.asked().iter().position(|f| f.total_cmp(&row.force_bar).is_eq());
        rows.sort_by_key(place);
        Ok(rows)
    }

    /// Writes the field and drops it, since a bench of many loads would otherwise keep them all.
    fn save_pressure(&self, directory: &Path, row: &mut BenchRow) -> Result<()> {
        let Some(pressure) = row.state.fields.take().and_then(|f| f.pressure) else { return Ok(()) };
        let stem = Path::new(&self.surface)
            .file_stem()
            .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let drawn = row
            .drawn
            .map(|(d, seed)| format!("_N{}_Df{d:?}_seed{seed}", row.cells.columns))
            .unwrap_or_default();
        let name = format!("pressure_{stem}{drawn}_F{:?}_tol{:?}.npy", row.force_bar, row.tolerance);
        write_npy(&directory.join(name), &[pressure.rows(), pressure.columns()], pressure.values())
    }
}

/// The table as CSV, column names first.
///
/// # Errors
/// [`Error::File`] when it cannot be written (the file appears whole or not at all).
pub fn write_bench(path: &Path, rows: &[BenchRow]) -> Result<()> {
    let mut bytes = Vec::new();
    let mut writer = csv::Writer::from_writer(&mut bytes);
    let failed = |e: csv::Error| Error::content(path, e.to_string());
    writer.write_record(BENCH_COLUMNS).map_err(failed)?;
    for row in rows {
        writer.write_record(row.fields()?).map_err(failed)?;
    }
    writer.flush().map_err(Error::file("write", path))?;
    drop(writer);
    Ok(files::write_whole(path, &bytes)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::sync::Mutex;

    fn small() -> Bench {
        Bench {
            surfaces: Surfaces::SelfAffine {
                cells: vec![17],
                rows: None,
                fractal_dimensions: vec![2.4],
                seed: 3,
            },
            forces: Forces::parse("1,0.01").unwrap(),
            tolerances: vec![1e-6],
            boundary: Boundary::Free,
            method: Method::Auto,
            cold: false,
            threads: 1,
            pressure: None,
        }
    }

    #[test]
    fn rows_are_written_whole() {
        let dir = tempfile::tempdir().unwrap();
        let pressure = dir.path().join("fields");
        let solved = Mutex::new(Vec::new());
        let rows = bench(&Bench { pressure: Some(pressure.clone()), ..small() }, None, &|row| {
            solved.lock().unwrap().push(row.force_bar);
            Ok(())
        })
        .unwrap();
        // Asked for as "1,0.01", solved from the smallest up.
        assert_eq!(solved.into_inner().unwrap(), [0.01, 1.0]);
        assert_eq!(rows.iter().map(|r| r.force_bar).collect::<Vec<_>>(), [1.0, 0.01]);
        assert!(rows.iter().all(BenchRow::converged));
        let path = dir.path().join("bench.csv");
        write_bench(&path, &rows).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("cells,force_bar,approach_over_h,stiffness_bar,contact_cells,penetration,duality_gap,iterations,applications,seconds,strategy,status,"));
        assert_eq!(text.lines().count(), 3);
        assert_eq!(fs::read_dir(pressure).unwrap().count(), 2);
    }

    #[test]
    fn a_rectangle_has_its_rows() {
        let surfaces =
            Surfaces::SelfAffine { cells: vec![24], rows: Some(6), fractal_dimensions: vec![2.2], seed: 1 };
        for row in bench(&Bench { surfaces, ..small() }, None, &|_| Ok(())).unwrap() {
            assert!(row.converged());
            approx::assert_relative_eq!(row.normalisation.length, 1.0, max_relative = 1e-15);
            let fields = row.fields().unwrap();
            let field = |name: &str| &fields[BENCH_COLUMNS.iter().position(|c| *c == name).unwrap()];
            assert_eq!((field("cells").as_str(), field("rows").as_str()), ("24", "6"));
        }
    }

    #[test]
    fn cold_and_warm_rows_agree() {
        let warm = bench(&small(), None, &|_| Ok(())).unwrap();
        let cold = bench(&Bench { cold: true, threads: 2, ..small() }, None, &|_| Ok(())).unwrap();
        for (a, b) in warm.iter().zip(&cold) {
            approx::assert_relative_eq!(
                a.state.stiffness.unwrap(),
                b.state.stiffness.unwrap(),
                max_relative = 1e-5
            );
        }
        assert!(cold.iter().all(|r| r.cold) && !warm[0].cold && warm[1].cold);
    }

    #[test]
    fn rows_are_in_the_requested_order_for_any_number_of_threads() {
        let surfaces = Surfaces::SelfAffine {
            cells: vec![17, 9],
            rows: None,
            fractal_dimensions: vec![2.4, 2.0],
            seed: 3,
        };
        let many = Bench { surfaces, tolerances: vec![1e-6, 1e-3], ..small() };
        let numbers = |threads| {
            let rows = bench(&Bench { threads, ..many.clone() }, None, &|_| Ok(())).unwrap();
            let row = |r: &BenchRow| (r.cells, r.drawn, r.tolerance, r.force_bar, r.state.stiffness);
            rows.iter().map(row).collect::<Vec<_>>()
        };
        assert_eq!(numbers(1), numbers(3));
        assert_eq!(numbers(1).len(), 16);
    }

    #[test]
    fn a_row_that_cannot_be_kept_stops_the_rest() {
        let count = Mutex::new(0);
        let error = bench(&small(), None, &|_| {
            *count.lock().unwrap() += 1;
            Err(Error::parameter("csv", "full", "room on the disk"))
        });
        assert!(error.unwrap_err().to_string().contains("room on the disk"));
        assert_eq!(*count.lock().unwrap(), 1);
    }

    #[test]
    fn a_load_that_does_not_converge_has_a_row() {
        // Beyond double precision: reached or not, every load has its row and its certificate.
        let tired = Bench { method: Method::SingleLevel, tolerances: vec![1e-15], ..small() };
        let rows = bench(&tired, None, &|_| Ok(())).unwrap();
        assert_eq!(rows.len(), 2);
        for row in &rows {
            let fields = row.fields().unwrap();
            assert_eq!(fields[11] == "converged", row.converged());
            assert!(fields[..12].iter().all(|f| !f.is_empty()));
        }
    }

    #[test]
    fn a_periodic_square_has_mean_gaps_and_no_approach() {
        let periodic = Bench { boundary: Boundary::Periodic, ..small() };
        let rows = bench(&periodic, None, &|_| Ok(())).unwrap();
        let column = |name: &str| BENCH_COLUMNS.iter().position(|c| *c == name).unwrap();
        let (approach, gap) = (column("approach_over_h"), column("mean_gap_over_h"));
        for row in rows {
            let fields = row.fields().unwrap();
            assert!(row.converged() && fields[approach].is_empty());
            assert!(fields[gap].parse::<f64>().unwrap() > 0.0);
        }
    }
}
