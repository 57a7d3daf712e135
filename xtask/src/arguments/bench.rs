//! Flags of the bench.

use super::words::{Words, words};
use bem3d::Method;
use clap::Args;
use contact_model::Boundary;
use paper::evaluation::{Bench, Forces, Surfaces};
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Examples:
  cargo xtask bench --surface heights.npy --sweep 1e-6:20:20 --tolerance 1e-8     one map, 20 loads
  cargo xtask bench --cells 257,513,1025 --fractal-dimensions 2.4 --forces 0.1,1 --cold
  cargo xtask bench --scaling                           cost over cells and over force, with slopes
  cargo xtask bench --cells 513 --forces 1e-6:20:23 --csv cost.csv --plot cost.svg

`seconds` is wall-clock time of everything that a row took: transforms and tables, coarse grids, every look with the exact operator,
pressure and stiffness; not the reading and writing of files. The first row of a series (a surface at a tolerance) includes drawing or
scaling the surface; with --cold every row does. `cpu_seconds` is processor time of all threads, empty where several
series are solved at the same time; `peak_memory_bytes` is the most that the process held during the row, maps and all. Both are empty
where the system does not tell.

Loads are solved and printed from the smallest up, whatever their order; the rows of the file stand in the order asked for. The file is
whole all along: an interruption keeps the rows so far. A load that does not converge has its row with its status and the certificate
of the best state, and the others go on.

Exit codes: 0 done; 1 error; 2 bad arguments; 3 done, but some solves did not converge.";

const BOUNDARIES: Words<Boundary> = &[
    ("free", Boundary::Free, "The half-space outside the square carries no load"),
    ("periodic", Boundary::Periodic, "The square repeats periodically"),
];

const METHODS: Words<Method> = &[
    ("auto", Method::Auto, "The method predicted to be cheapest for each contact set"),
    ("iterative", Method::Iterative, "No Cholesky factors"),
    ("single-level", Method::SingleLevel, "No Cholesky factors, no two-level operator, no coarse grids"),
];

/// Flags of the bench.
#[derive(Debug, Args)]
pub struct BenchArguments {
    /// An NPY map [row, column] of real numbers, used without preprocessing (square cells, L = sqrt(Lx Ly) =
    /// E* = 1; F_bar is formed with its measured rms height).
    #[arg(long, value_name = "FILE.npy", conflicts_with_all = ["cells", "rows", "fractal_dimensions", "seed"])]
    surface: Option<PathBuf>,
    /// Columns of generated surfaces, separated by commas [default: 257,513,1025].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    cells: Option<Vec<usize>>,
    /// Rows of generated surfaces, which have square cells on a rectangle of area 1 [default: as many as
    /// columns].
    #[arg(long, value_name = "N")]
    rows: Option<usize>,
    /// Fractal dimensions of generated surfaces, separated by commas.
    #[arg(
        long,
        visible_alias = "df",
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "2.0,2.4,2.8"
    )]
    fractal_dimensions: Vec<f64>,
    /// Seed of generated surfaces.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Loads F_bar: numbers and logarithmic ranges MIN:MAX:COUNT (both ends included), separated by commas.
    #[arg(
        long,
        visible_alias = "sweep",
        value_name = "LIST",
        allow_hyphen_values = true,
        default_value = "1e-4,1e-2,0.1,1,20"
    )]
    forces: String,
    /// Boundary conditions at the edges of the square.
    #[arg(long, value_parser = words(BOUNDARIES), default_value = "free")]
    boundary: Boundary,
    /// Tolerances, separated by commas: each bounds the residuals of the certificate and the error of k.
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_value = "1e-6"
    )]
    tolerance: Vec<f64>,
    /// How linear systems are solved.
    #[arg(long, value_parser = words(METHODS), default_value = "auto")]
    method: Method,
    /// Prepare anew for every load.
    #[arg(long)]
    cold: bool,
    /// Measure how the cost grows with the size: by default 257 to 4097 cells, every load from a cold start,
    /// table and pictures in out/bench-scaling.*.
    #[arg(long, conflicts_with = "surface")]
    scaling: bool,
    /// Threads: as many series (surface and tolerance) are solved at the same time. A thread without a series
    /// of its own helps with the others; a single series uses all threads.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Print how the time of the rows is divided among the parts of a solve.
    #[arg(long)]
    pub parts: bool,
    /// Write the pressure of every row as NPY into this directory.
    #[arg(long, value_name = "DIR")]
    pressure: Option<PathBuf>,
    /// Write the table to this file, which is complete at any time during the run.
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Draw seconds over cells and over force from the table (SVG and PNG), and print the slopes of seconds
    /// and iterations.
    #[arg(long, value_name = "FILE.svg", requires = "csv")]
    plot: Option<PathBuf>,
}

/// Sizes of generated surfaces.
const CELLS: [usize; 3] = [257, 513, 1025];
/// Sizes that show how cost grows.
pub(super) const SCALING_CELLS: [usize; 5] = [257, 513, 1025, 2049, 4097];
/// File of its table.
pub(super) const SCALING_CSV: &str = "out/bench-scaling.csv";

impl BenchArguments {
    /// Table and picture.
    pub fn files(&self) -> (Option<PathBuf>, Option<PathBuf>) {
        if !self.scaling {
            return (self.csv.clone(), self.plot.clone());
        }
        let csv = self.csv.clone().unwrap_or_else(|| SCALING_CSV.into());
        let plot = self.plot.clone().unwrap_or_else(|| csv.with_extension("svg"));
        (Some(csv), Some(plot))
    }

    /// The bench that these flags describe.
    ///
    /// # Errors
    /// [`runs::Error::Parameter`] naming the value that is invalid.
    pub fn bench(&self) -> runs::Result<Bench> {
        let surfaces = match &self.surface {
            Some(path) => Surfaces::File(path.clone()),
            None => Surfaces::SelfAffine {
                cells: self
                    .cells
                    .clone()
                    .unwrap_or_else(|| if self.scaling { SCALING_CELLS.to_vec() } else { CELLS.to_vec() }),
                rows: self.rows,
                fractal_dimensions: self.fractal_dimensions.clone(),
                seed: self.seed,
            },
        };
        Ok(Bench {
            surfaces,
            forces: Forces::parse(&self.forces)?,
            tolerances: self.tolerance.clone(),
            boundary: self.boundary,
            method: self.method,
            cold: self.cold || self.scaling,
            threads: self.threads,
            pressure: self.pressure.clone(),
        })
    }
}
