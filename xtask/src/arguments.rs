//! The command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use contact_model::Boundary;
use figures::{Bench, Depth, Forces, Method, Needs, Preset, Request, Surfaces, TwoCases, Wish};
use std::path::PathBuf;

/// Reproduces Pohrt, Popov, Filippov, Phys. Rev. E 86, 026710 (2012): normal contact stiffness of fractal rough surfaces.
///
/// Each figure is computed by real solves and written as CSV, SVG and PNG, with the paper's own claim beside each number.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, after_long_help = AFTER)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const AFTER: &str = "\
Examples:
  cargo xtask reproduce-fig2                          3D curves, a few minutes on two cores
  cargo xtask reproduce-all --preset quick            everything, coarse
  cargo xtask reproduce-fig2 --cells 513 --surfaces 20 --fractal-dimensions 2.0,2.4
  cargo xtask reproduce-fig6 --forces 1e-9:20:60      60 loads, logarithmic, both ends in
  cargo xtask reproduce-fig2 --accuracy 5% --forces 0.1,1,20   the cheapest settings for that, or what ten minutes buy
  cargo xtask verify                                  one line per claim of the paper
  cargo xtask reproduce-fig2 --preset paper           2049 cells, 60 surfaces: stop and resume at will
  cargo xtask reproduce-fig2 --preset extended --over data/figures/paper/fig2.csv   16385 cells, light loads

Results go to out/ (--out). Finished surfaces are kept in out/.units and reused by every command with the same parameters; an
interruption loses at most the surfaces in flight, and the same command resumes. The same command gives the same bytes of CSV
for any number of threads; times and the machine are in manifest.json.

Exit codes: 0 done; 1 error; 2 bad arguments; 3 done, but some solves did not converge, stored numbers differ or a hard case fails.";

const BENCH: &str = "\
Examples:
  cargo xtask bench --surface heights.npy --sweep 1e-6:20:20 --tolerance 1e-8     one map, 20 loads
  cargo xtask bench --cells 257,513,1025 --fractal-dimensions 2.4 --forces 0.1,1 --cold
  cargo xtask bench --scaling                           cost over cells and over force, with slopes
  cargo xtask bench --cells 513 --forces 1e-6:20:23 --csv cost.csv --plot cost.svg

`seconds` is wall-clock time of everything that a row took: transforms and tables, coarse grids, every look with the exact operator,
pressure and stiffness; not the reading and writing of files. The first row of a series (a surface at a tolerance) includes drawing or
scaling the surface; with --cold every row does. `cpu_seconds` is processor time of the row's thread, `peak_memory_bytes` the most
that the process held during the row, maps and all; both are empty where the system does not tell.

Loads are solved and printed from the smallest up, whatever their order; the rows of the file stand in the order asked for. The file is
whole all along: an interruption keeps the rows so far. A load that does not converge has its row with its status and the certificate
of the best state, and the others go on.

Exit codes: 0 done; 1 error; 2 bad arguments; 3 done, but some solves did not converge.";

const EXPAND: &str = "Run with --help for every flag.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Grey-scale maps of the six surfaces (CSV, NPY, PNG).
    #[command(after_help = EXPAND)]
    ReproduceFig1(Maps),
    /// Stiffness over force, 3D boundary elements.
    #[command(after_help = EXPAND)]
    ReproduceFig2(Solid),
    /// Exponent alpha over the fractal dimension, 3D and 1D.
    #[command(after_help = EXPAND)]
    ReproduceFig3(Both),
    /// Collapse of the 3D curves onto one.
    #[command(after_help = EXPAND)]
    ReproduceFig4(Solid),
    /// Three equivalent rough lines (CSV, NPY).
    #[command(after_help = EXPAND)]
    ReproduceFig5(Lines),
    /// Stiffness over force, 1D reduction.
    #[command(after_help = EXPAND)]
    ReproduceFig6(Reduced),
    /// Factor zeta over the fractal dimension, 3D and 1D.
    #[command(after_help = EXPAND)]
    ReproduceFig7(Both),
    /// All seven figures and the verification.
    #[command(after_help = EXPAND)]
    ReproduceAll(Both),
    /// Every claim of the paper beside what is found here, disagreements first (verify.csv, verify.md).
    #[command(after_help = EXPAND)]
    Verify(Both),
    /// What an answer costs: work, time, memory and certificate of each solve.
    #[command(after_long_help = BENCH)]
    Bench(BenchArguments),
    /// What accuracy costs in time: one family of problems in every way there is (accuracy-cost.csv, .md and picture).
    #[command(after_help = EXPAND)]
    AccuracyCost(AccuracyCost),
    /// Whether error budgets are honest: random surfaces, loads, grids and tolerances against references (budget-check.csv).
    #[command(after_help = EXPAND)]
    BudgetCheck(BudgetCheck),
    /// Sec. II's two problems side by side: free and fractal, periodic with a roll-off; with Persson's and Greenwood-Williamson's theories.
    #[command(after_help = EXPAND)]
    ReproduceTwoCases(TwoCasesArguments),
    /// A random share of the solves of Fig. 2 again, from nothing and to a tight tolerance (audit.csv).
    #[command(after_help = EXPAND)]
    Audit(Audit),
    /// A small fixed run of Figs. 2 and 6 against the numbers in data/reference (for continuous integration).
    CheckReference(Reference),
    /// Hard cases: why each is hard, what is asserted, the figure reached (stability.csv, stability.md).
    Stability(StabilityArguments),
}

impl Command {
    /// Its name on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ReproduceFig1(_) => "reproduce-fig1",
            Self::ReproduceFig2(_) => "reproduce-fig2",
            Self::ReproduceFig3(_) => "reproduce-fig3",
            Self::ReproduceFig4(_) => "reproduce-fig4",
            Self::ReproduceFig5(_) => "reproduce-fig5",
            Self::ReproduceFig6(_) => "reproduce-fig6",
            Self::ReproduceFig7(_) => "reproduce-fig7",
            Self::ReproduceAll(_) => "reproduce-all",
            Self::Verify(_) => "verify",
            Self::AccuracyCost(_) => "accuracy-cost",
            Self::BudgetCheck(_) => "budget-check",
            Self::ReproduceTwoCases(_) => "reproduce-two-cases",
            Self::Audit(_) => "audit",
            Self::Bench(_) => "bench",
            Self::CheckReference(_) => "check-reference",
            Self::Stability(_) => "stability",
        }
    }

    /// The accuracy that a figure is asked for, and which ensembles it needs.
    pub fn wish(&self) -> Option<(Needs, Wish)> {
        let (solve, solid, line) = match self {
            Self::ReproduceFig2(a) | Self::ReproduceFig4(a) => (&a.solve, true, false),
            Self::ReproduceFig6(a) => (&a.solve, false, true),
            Self::ReproduceFig3(a) | Self::ReproduceFig7(a) | Self::ReproduceAll(a) | Self::Verify(a) => {
                (&a.solve, true, true)
            }
            _ => return None,
        };
        solve.wish().map(|wish| (Needs { solid, line }, wish))
    }

    /// What it asks for.
    pub fn request(&self) -> Request {
        let mut request = Request::default();
        match self {
            Self::ReproduceFig1(a) => a.fill(&mut request),
            Self::ReproduceFig2(a) | Self::ReproduceFig4(a) => a.fill(&mut request),
            Self::ReproduceFig5(a) => a.fill(&mut request),
            Self::ReproduceFig6(a) => a.fill(&mut request),
            Self::ReproduceFig3(a) | Self::ReproduceFig7(a) | Self::ReproduceAll(a) | Self::Verify(a) => {
                a.fill(&mut request);
            }
            Self::Audit(a) => a.solid.fill(&mut request),
            Self::Bench(_) => {}
            Self::BudgetCheck(a) => (request.out, request.threads) = (Some(a.out.clone()), Some(a.threads)),
            Self::ReproduceTwoCases(a) => request.out = Some(a.out.clone()),
            Self::AccuracyCost(a) => request.out = Some(a.out.clone()),
            Self::CheckReference(a) => request.out = Some(a.out.clone()),
            Self::Stability(a) => request.out = Some(a.out.clone()),
        }
        request
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum PresetName {
    /// Well under a minute: 129 cells, 8 surfaces, 2^16 elements, 40 lines.
    Quick,
    /// A few minutes: 513 cells, 40 surfaces, 2^18 elements, 200 lines.
    Default,
    /// The paper's sizes: 2049 cells, 60 surfaces, 2^20 elements, 500 lines; tolerance 1e-3.
    Paper,
    /// Beyond the paper: 16385 cells, 4 surfaces, light loads; tolerance 1e-3, 5 GB for each thread.
    Extended,
}

/// Flags of every figure.
#[derive(Debug, Args)]
pub struct Common {
    /// Sizes to start from; the other flags override them.
    #[arg(long, value_enum, default_value = "default")]
    preset: PresetName,
    /// Fractal dimensions in [2, 3], separated by commas, such as 2.0,2.2.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fractal_dimensions: Option<Vec<f64>>,
    /// Master seed: surface number i is the same for every fractal dimension and resolution.
    #[arg(long)]
    seed: Option<u64>,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

impl Common {
    fn fill(&self, request: &mut Request) {
        request.preset = match self.preset {
            PresetName::Quick => Preset::Quick,
            PresetName::Default => Preset::Default,
            PresetName::Paper => Preset::Paper,
            PresetName::Extended => Preset::Extended,
        };
        request.fractal_dimensions.clone_from(&self.fractal_dimensions);
        request.seed = self.seed;
        request.out = Some(self.out.clone());
    }
}

/// Flags of everything that is solved.
#[derive(Debug, Args)]
pub struct Solve {
    /// Loads F_bar: numbers and logarithmic ranges MIN:MAX:COUNT (both ends in), separated by commas.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    forces: Option<String>,
    /// Threads; 0 is one per core. Changes no byte of a CSV.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Ignore stored units and solve everything again.
    #[arg(long)]
    fresh: bool,
    /// Choose grid, tolerance and number of surfaces so that each mean k_bar above the one-cell floor is known to this (95 % half-width):
    /// a share or per cent, such as 0.02 or 2%. A pilot of small grids runs first.
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    accuracy: Option<f64>,
    /// Most time that --accuracy may choose, such as 90s, 10min, 2h.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "10min", requires = "accuracy", allow_hyphen_values = true)]
    budget: f64,
    /// Draw the curves of another run's fig2.csv or fig6.csv underneath (Figs. 2 and 6).
    #[arg(long, value_name = "FILE.csv")]
    over: Option<PathBuf>,
}

impl Solve {
    fn wish(&self) -> Option<Wish> {
        self.accuracy.map(|accuracy| Wish { accuracy, seconds: self.budget })
    }

    fn fill(&self, request: &mut Request) {
        request.forces.clone_from(&self.forces);
        request.threads = Some(self.threads);
        request.fresh = self.fresh;
        request.over.clone_from(&self.over);
    }
}

/// A share: `0.02` or `2%`.
fn share(text: &str) -> Result<f64, String> {
    let (digits, unit) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 100.0));
    let value = digits.trim().parse::<f64>().map_err(|e| e.to_string())? / unit;
    if value > 0.0 && value < 1.0 {
        Ok(value)
    } else {
        Err("expected a share between 0 and 1, such as 0.02 or 2%".into())
    }
}

/// A time: `90s`, `10min`, `2h`; a bare number is seconds.
fn seconds(text: &str) -> Result<f64, String> {
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    let (digits, unit) = (units.iter())
        .find_map(|(name, unit)| Some((text.strip_suffix(name)?, *unit)))
        .unwrap_or((text, 1.0));
    let value = unit * digits.trim().parse::<f64>().map_err(|e| e.to_string())?;
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err("expected a time such as 90s, 10min or 2h".into())
    }
}

/// Size of the 3D ensemble.
#[derive(Debug, Args)]
pub struct SolidSize {
    /// Cells a side of each surface, N (any number from 3; the paper has 2049).
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
    /// Surfaces per fractal dimension (the paper has 60).
    #[arg(long, value_name = "COUNT")]
    surfaces: Option<usize>,
    /// Tolerance of the 3D solver: bound of the certificate and of the error of k.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    tolerance: Option<f64>,
}

impl SolidSize {
    fn fill(&self, request: &mut Request) {
        (request.cells, request.surfaces, request.tolerance) = (self.cells, self.surfaces, self.tolerance);
    }
}

/// Size of the 1D ensemble.
#[derive(Debug, Args)]
pub struct LineSize {
    /// Elements of each line (the paper has 2^20 = 1048576).
    #[arg(long, value_name = "N")]
    elements: Option<usize>,
    /// Lines per fractal dimension (the paper has 500).
    #[arg(long, value_name = "COUNT")]
    lines: Option<usize>,
}

impl LineSize {
    fn fill(&self, request: &mut Request) {
        (request.elements, request.lines) = (self.elements, self.lines);
    }
}

/// Flags of Fig. 1.
#[derive(Debug, Args)]
pub struct Maps {
    #[command(flatten)]
    common: Common,
    /// Cells a side of each map (the paper has 2049).
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
}

impl Maps {
    fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        request.cells = self.cells;
    }
}

/// Flags of Fig. 5.
#[derive(Debug, Args)]
pub struct Lines {
    #[command(flatten)]
    common: Common,
    /// Elements of each line (the paper has 2^20 = 1048576).
    #[arg(long, value_name = "N")]
    elements: Option<usize>,
}

impl Lines {
    fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        request.elements = self.elements;
    }
}

/// Flags of Figs. 2 and 4.
#[derive(Debug, Args)]
pub struct Solid {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    size: SolidSize,
    #[command(flatten)]
    solve: Solve,
}

impl Solid {
    fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        self.size.fill(request);
        self.solve.fill(request);
    }
}

/// Flags of Fig. 6.
#[derive(Debug, Args)]
pub struct Reduced {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    size: LineSize,
    #[command(flatten)]
    solve: Solve,
}

impl Reduced {
    fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        self.size.fill(request);
        self.solve.fill(request);
    }
}

/// Flags of everything that needs both models.
#[derive(Debug, Args)]
pub struct Both {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    solid: SolidSize,
    #[command(flatten)]
    line: LineSize,
    #[command(flatten)]
    solve: Solve,
}

impl Both {
    fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        self.solid.fill(request);
        self.line.fill(request);
        self.solve.fill(request);
    }
}

/// Flags of the second look.
#[derive(Debug, Args)]
pub struct Audit {
    #[command(flatten)]
    solid: Solid,
    /// Share of all solves.
    #[arg(long, default_value_t = 0.01, allow_hyphen_values = true)]
    pub share: f64,
    /// Tolerance of the second look.
    #[arg(long = "audit-tolerance", value_name = "T", default_value_t = 1e-8, allow_hyphen_values = true)]
    pub tight: f64,
}

/// Sizes of the study of accuracy.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum DepthName {
    /// Up to 257 cells: a minute or two.
    Quick,
    /// Up to 1025 cells: a quarter of an hour.
    Default,
    /// Up to 2049 cells, tolerances to 1e-10: hours.
    Thorough,
}

/// Flags of the study of accuracy.
#[derive(Debug, Args)]
pub struct AccuracyCost {
    /// How much is solved. One thread: the times are those of each row.
    #[arg(long, value_enum, default_value = "default")]
    preset: DepthName,
    /// Master seed.
    #[arg(long, default_value_t = figures::SEED)]
    pub seed: u64,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Solve nothing: draw the picture and write the text again from the tables in --out.
    #[arg(long)]
    pub redraw: bool,
}

impl AccuracyCost {
    /// How much is solved.
    pub fn depth(&self) -> Depth {
        match self.preset {
            DepthName::Quick => Depth::Quick,
            DepthName::Default => Depth::Default,
            DepthName::Thorough => Depth::Thorough,
        }
    }
}

/// Flags of the check of error budgets.
#[derive(Debug, Args)]
pub struct BudgetCheck {
    /// Random cases.
    #[arg(long, value_name = "COUNT", default_value_t = 100)]
    pub cases: usize,
    /// Master seed.
    #[arg(long, default_value_t = figures::SEED)]
    pub seed: u64,
    /// Threads; 0 is one per core. Changes no byte of the CSV.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Flags of the two cases.
#[derive(Debug, Args)]
pub struct TwoCasesArguments {
    /// Cells a side.
    #[arg(long, default_value_t = 512, allow_hyphen_values = true)]
    cells: usize,
    /// Surfaces of each case.
    #[arg(long, default_value_t = 16, allow_hyphen_values = true)]
    surfaces: usize,
    /// Fractal dimension.
    #[arg(long = "df", value_name = "D_F", default_value_t = 2.2, allow_hyphen_values = true)]
    fractal_dimension: f64,
    /// Waves a side at which the spectrum rolls off.
    #[arg(long, value_name = "WAVES", default_value_t = 8.0, allow_hyphen_values = true)]
    roll_off: f64,
    /// Loads F_bar: numbers and logarithmic ranges MIN:MAX:COUNT.
    #[arg(long, value_name = "LIST", default_value = "1e-3:20:19", allow_hyphen_values = true)]
    forces: String,
    /// Tolerance of every certificate.
    #[arg(long, default_value_t = 1e-4, allow_hyphen_values = true)]
    tolerance: f64,
    /// Master seed.
    #[arg(long, default_value_t = figures::SEED)]
    seed: u64,
    /// Surfaces solved at the same time (default: all cores).
    #[arg(long, allow_hyphen_values = true)]
    threads: Option<usize>,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

impl TwoCasesArguments {
    /// What it asks for.
    ///
    /// # Errors
    /// [`figures::Error::Parameter`] for a list of loads that is none.
    pub fn study(&self) -> figures::Result<TwoCases> {
        Ok(TwoCases {
            cells: self.cells,
            surfaces: self.surfaces,
            fractal_dimension: self.fractal_dimension,
            roll_off: self.roll_off,
            forces: Forces::parse(&self.forces)?,
            tolerance: self.tolerance,
            seed: self.seed,
            threads: self
                .threads
                .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get)),
        })
    }
}

/// Edges of the square.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum BoundaryName {
    /// Nothing presses outside the square.
    Free,
    /// The square repeats.
    Periodic,
}

/// How linear systems are solved.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum MethodName {
    /// The cheapest way for each set.
    Auto,
    /// No factors.
    Iterative,
    /// No factors, no two-level sums, no coarse grids.
    SingleLevel,
}

/// Flags of the bench.
#[derive(Debug, Args)]
pub struct BenchArguments {
    /// A square float64 NPY map, taken as it is (L = E* = 1, F_bar by its measured rms height).
    #[arg(long, value_name = "FILE.npy", conflicts_with_all = ["cells", "fractal_dimensions", "seed"])]
    surface: Option<PathBuf>,
    /// Cells a side of generated surfaces, separated by commas [default: 257,513,1025].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    cells: Option<Vec<usize>>,
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
    /// Loads F_bar: numbers and logarithmic ranges MIN:MAX:COUNT (both ends in), separated by commas.
    #[arg(
        long,
        visible_alias = "sweep",
        value_name = "LIST",
        allow_hyphen_values = true,
        default_value = "1e-4,1e-2,0.1,1,20"
    )]
    forces: String,
    /// Edges of the square.
    #[arg(long, value_enum, default_value = "free")]
    boundary: BoundaryName,
    /// Tolerances, separated by commas: bound of the certificate and of the error of k.
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_value = "1e-6"
    )]
    tolerance: Vec<f64>,
    /// How linear systems are solved.
    #[arg(long, value_enum, default_value = "auto")]
    method: MethodName,
    /// Prepare anew for every load.
    #[arg(long)]
    cold: bool,
    /// Cost as the work grows: 257 to 4097 cells and every load from nothing unless said otherwise, table and pictures in
    /// out/bench-scaling.* unless named.
    #[arg(long, conflicts_with = "surface")]
    scaling: bool,
    /// Series (surface and tolerance) solved at the same time; one solve runs on one thread.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Write the pressure of every row as NPY into this directory.
    #[arg(long, value_name = "DIR")]
    pressure: Option<PathBuf>,
    /// Write the table; it is whole all along.
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Draw seconds over cells and over force from the table (SVG and PNG), and print the slopes of seconds and iterations.
    #[arg(long, value_name = "FILE.svg", requires = "csv")]
    plot: Option<PathBuf>,
}

/// Sizes of generated surfaces.
const CELLS: [usize; 3] = [257, 513, 1025];
/// Sizes that show how cost grows.
const SCALING_CELLS: [usize; 5] = [257, 513, 1025, 2049, 4097];
/// Where its table goes.
const SCALING_CSV: &str = "out/bench-scaling.csv";

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

    /// What it asks for.
    ///
    /// # Errors
    /// [`figures::Error::Parameter`] naming the value that makes no sense.
    pub fn bench(&self) -> figures::Result<Bench> {
        let surfaces = match &self.surface {
            Some(path) => Surfaces::File(path.clone()),
            None => Surfaces::SelfAffine {
                cells: self
                    .cells
                    .clone()
                    .unwrap_or_else(|| if self.scaling { SCALING_CELLS.to_vec() } else { CELLS.to_vec() }),
                fractal_dimensions: self.fractal_dimensions.clone(),
                seed: self.seed,
            },
        };
        Ok(Bench {
            surfaces,
            forces: Forces::parse(&self.forces)?,
            tolerances: self.tolerance.clone(),
            boundary: match self.boundary {
                BoundaryName::Free => Boundary::Free,
                BoundaryName::Periodic => Boundary::Periodic,
            },
            method: match self.method {
                MethodName::Auto => Method::Auto,
                MethodName::Iterative => Method::Iterative,
                MethodName::SingleLevel => Method::SingleLevel,
            },
            cold: self.cold || self.scaling,
            threads: self.threads,
            pressure: self.pressure.clone(),
        })
    }
}

/// Flags of the comparison with stored numbers.
#[derive(Debug, Args)]
pub struct Reference {
    /// Store the numbers of this run as the new reference.
    #[arg(long)]
    pub bless: bool,
    /// Directory of the results; the run works in its folder reference/.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Flags of the hard cases.
#[derive(Debug, Args)]
pub struct StabilityArguments {
    /// Larger grids, more surfaces and loads: minutes instead of seconds.
    #[arg(long)]
    pub thorough: bool,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    fn parse(line: &str) -> Result<Arguments, clap::Error> {
        Arguments::try_parse_from(std::iter::once("xtask").chain(line.split_whitespace()))
    }

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn the_same_words_for_every_figure() {
        let arguments = parse(
            "verify --preset paper --cells 9 --surfaces 2 --elements 64 --lines 3 --fractal-dimensions 2.0,2.2 \
             --forces 1e-2:20:4 --tolerance 1e-3 --seed 7 --threads 2 --out d --fresh",
        )
        .unwrap();
        let request = arguments.command.request();
        let expected = Request {
            preset: Preset::Paper,
            cells: Some(9),
            surfaces: Some(2),
            elements: Some(64),
            lines: Some(3),
            fractal_dimensions: Some(vec![2.0, 2.2]),
            forces: Some("1e-2:20:4".into()),
            tolerance: Some(1e-3),
            seed: Some(7),
            threads: Some(2),
            out: Some("d".into()),
            fresh: true,
            over: None,
        };
        assert_eq!(request, expected);
        assert_eq!(arguments.command.name(), "verify");
    }

    #[test]
    fn flags_that_do_not_apply_are_refused() {
        for line in [
            "reproduce-fig1 --surfaces 2",
            "reproduce-fig1 --threads 2",
            "reproduce-fig2 --elements 64",
            "reproduce-fig5 --cells 9",
            "reproduce-fig6 --tolerance 1e-3",
            "reproduce-fig2 --preset huge",
            "reproduce-fig2 --cells -3",
            "reproduce-fig2 --fractal-dimensions 2.0,x",
            "reproduce-fig8",
            "bench --boundary clamped",
            "bench --surface a.npy --cells 9",
            "bench --surface a.npy --seed 2",
            "bench --surface a.npy --scaling",
            "bench --plot a.svg",
            "bench --cells 9,x",
            "bench --threads -1",
            "bench --method magic",
            "bench --preset paper",
            "stability --preset quick",
            "reproduce-fig2 --unknown",
            "",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
        // A negative force reaches the run, which names it.
        assert!(parse("reproduce-fig2 --forces -1").is_ok());
    }

    fn bench(line: &str) -> BenchArguments {
        match parse(line).unwrap().command {
            Command::Bench(options) => options,
            other => panic!("{}", other.name()),
        }
    }

    #[test]
    fn benches_say_what_is_solved_and_where_it_goes() {
        let asked = bench(
            "bench --surface a.npy --sweep 1:100:3,20 --tolerance 1e-8,1e-3 --csv d/t.csv --pressure p",
        );
        assert_eq!(asked.files(), (Some("d/t.csv".into()), None));
        let asked = asked.bench().unwrap();
        assert_eq!(asked.forces.values(), [1.0, 10.0, 20.0, 100.0]);
        assert_eq!(asked.forces.asked(), [1.0, 10.0, 100.0, 20.0]);
        assert_eq!((asked.tolerances.len(), asked.cold, asked.threads), (2, false, 1));
        assert_eq!(asked.pressure, Some("p".into()));
        assert!(matches!(asked.surfaces, Surfaces::File(_)));

        let scaling = bench("bench --scaling --df 2.4");
        assert_eq!(scaling.files(), (Some(SCALING_CSV.into()), Some("out/bench-scaling.svg".into())));
        let scaling = scaling.bench().unwrap();
        let Surfaces::SelfAffine { cells, fractal_dimensions, .. } = scaling.surfaces else { panic!() };
        assert_eq!((cells, fractal_dimensions, scaling.cold), (SCALING_CELLS.to_vec(), vec![2.4], true));

        // Values that the words allow and the bench refuses.
        for line in ["bench --forces -1", "bench --forces 1:2"] {
            assert!(bench(line).bench().unwrap_err().to_string().starts_with("--forces"), "{line}");
        }
    }

    #[test]
    fn a_wish_is_a_share_and_a_time() {
        let wish = |line: &str| parse(line).unwrap().command.wish();
        let (needs, asked) = wish("reproduce-fig2 --accuracy 1% --budget 2h").unwrap();
        assert_eq!(
            (needs, asked),
            (Needs { solid: true, line: false }, Wish { accuracy: 0.01, seconds: 7200.0 })
        );
        let (needs, asked) = wish("verify --accuracy 0.05").unwrap();
        assert_eq!(
            (needs, asked),
            (Needs { solid: true, line: true }, Wish { accuracy: 0.05, seconds: 600.0 })
        );
        assert!(wish("reproduce-fig6").is_none() && wish("bench").is_none());
        for line in [
            "reproduce-fig2 --accuracy 0",
            "reproduce-fig2 --accuracy 100%",
            "reproduce-fig2 --accuracy many",
            "reproduce-fig2 --accuracy 1% --budget 0s",
            "reproduce-fig2 --accuracy 1% --budget 5d",
            "reproduce-fig2 --budget 5s",
            "reproduce-fig1 --accuracy 1%",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
    }

    #[test]
    fn no_flags_is_the_default_run() {
        let request = parse("reproduce-fig2").unwrap().command.request();
        assert_eq!(request, Request { threads: Some(0), out: Some("out".into()), ..Request::default() });
    }
}
