//! Flags of the commands beside the paper's figures.

use super::cluster::Sharded;
use super::sizes::{Solid, share};
use super::words::{Words, words};
use clap::Args;
use paper::TwoCases;
use paper::evaluation::{Depth, Forces, Request, Run};
use paper::{Exponent, ExponentSizes, PartialSlipSizes, PartialSlipStudy};
use std::path::PathBuf;

/// Flags of the audit.
#[derive(Debug, Args)]
pub struct Audit {
    #[command(flatten)]
    pub(super) solid: Solid,
    /// Share of all solves that are repeated.
    #[arg(long, default_value_t = 0.01, allow_hyphen_values = true)]
    pub share: f64,
    /// Tolerance of the repeated solves.
    #[arg(long = "audit-tolerance", value_name = "T", default_value_t = 1e-8, allow_hyphen_values = true)]
    pub tight: f64,
}

/// Sizes of the study of accuracy.
const DEPTHS: Words<Depth> = &[
    ("quick", Depth::Quick, "Up to 257 cells: a minute or two"),
    ("default", Depth::Default, "Up to 1025 cells: a quarter of an hour"),
    ("thorough", Depth::Thorough, "Up to 2049 cells, tolerances to 1e-10: hours"),
];

/// Flags of the study of accuracy.
#[derive(Debug, Args)]
pub struct AccuracyCost {
    /// How much is solved. It runs on one thread, so that each row has its own time.
    #[arg(long = "preset", value_name = "PRESET", value_parser = words(DEPTHS), default_value = "default")]
    pub depth: Depth,
    /// Master seed.
    #[arg(long, default_value_t = paper::evaluation::SEED)]
    pub seed: u64,
    /// Ignore stored results and measure everything again.
    #[arg(long)]
    pub fresh: bool,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub(super) sharded: Sharded,
}

/// Flags of the check of error budgets.
#[derive(Debug, Args)]
pub struct BudgetCheck {
    /// Number of random cases.
    #[arg(long, value_name = "COUNT", default_value_t = 100)]
    pub cases: usize,
    /// Master seed.
    #[arg(long, default_value_t = paper::evaluation::SEED)]
    pub seed: u64,
    /// Threads; 0 means one per core. The CSV file does not depend on it.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub(super) sharded: Sharded,
}

/// Flags of the two cases.
#[derive(Debug, Args)]
pub struct TwoCasesArguments {
    /// Number of cells along a side.
    #[arg(long, default_value_t = 512, allow_hyphen_values = true)]
    cells: usize,
    /// Number of cells in the shortest wavelength.
    #[arg(long, default_value_t = 8, allow_hyphen_values = true)]
    cells_per_wave: usize,
    /// Number of surfaces of each case.
    #[arg(long, default_value_t = 16, allow_hyphen_values = true)]
    surfaces: usize,
    /// Fractal dimensions, separated by commas.
    #[arg(
        long = "df",
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "2.2",
        allow_hyphen_values = true
    )]
    fractal_dimensions: Vec<f64>,
    /// Roll-off of the spectrum in waves per side, separated by commas; each is combined with each fractal
    /// dimension.
    #[arg(
        long = "roll-off",
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "8",
        allow_hyphen_values = true
    )]
    roll_offs: Vec<f64>,
    /// Loads F_bar: numbers and logarithmic ranges MIN:MAX:COUNT, separated by commas.
    #[arg(long, value_name = "LIST", default_value = "1e-3:20:19", allow_hyphen_values = true)]
    forces: String,
    /// Tolerance of each solve: it bounds the residuals of its certificate.
    #[arg(long, default_value_t = 1e-4, allow_hyphen_values = true)]
    tolerance: f64,
    /// Master seed.
    #[arg(long, default_value_t = paper::evaluation::SEED)]
    seed: u64,
    /// Number of surfaces solved at the same time [default: all cores].
    #[arg(long, allow_hyphen_values = true)]
    pub(super) threads: Option<usize>,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub(super) sharded: Sharded,
}

impl TwoCasesArguments {
    /// The study that these flags describe.
    ///
    /// # Errors
    /// [`runs::Error::Parameter`] for an invalid list of loads.
    pub fn study(&self) -> runs::Result<TwoCases> {
        Ok(TwoCases {
            cells: self.cells,
            cells_per_wave: self.cells_per_wave,
            surfaces: self.surfaces,
            fractal_dimensions: self.fractal_dimensions.clone(),
            roll_offs: self.roll_offs.clone(),
            forces: Forces::parse(&self.forces)?,
            tolerance: self.tolerance,
            seed: self.seed,
            threads: self
                .threads
                .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get)),
        })
    }
}

/// Sizes of the study of the exponent.
const EXPONENT_SIZES: Words<ExponentSizes> = &[
    ("quick", ExponentSizes::Quick, "Up to 129 cells and 2^12 elements: seconds"),
    ("default", ExponentSizes::Default, "Up to 1025 cells and 2^20 elements; --plan predicts the time"),
    ("full", ExponentSizes::Full, "Up to 16385 cells and 2^26 elements; --plan predicts the time"),
];

/// Flags of the study of the exponent.
#[derive(Debug, Args)]
pub struct ExponentArguments {
    /// Sizes to start from; the other flags override them.
    #[arg(long, value_parser = words(EXPONENT_SIZES), default_value = "default")]
    preset: ExponentSizes,
    /// Number of cells along a side, from the coarsest grid to the finest, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    grids: Option<Vec<usize>>,
    /// Number of surfaces of each grid, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    surfaces: Option<Vec<usize>>,
    /// Number of elements of the lines, in increasing order, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    elements: Option<Vec<usize>>,
    /// Number of lines for each number of elements, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    lines: Option<Vec<usize>>,
    /// Loads F_bar of the surfaces: numbers and logarithmic ranges MIN:MAX:COUNT (both ends included),
    /// separated by commas.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    forces: Option<String>,
    /// Loads of the lines; the factor between lines and surfaces is computed at the loads that both have.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    line_forces: Option<String>,
    /// Fractal dimensions in [2, 3], separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fractal_dimensions: Option<Vec<f64>>,
    /// Largest discretisation error on the finest grid, as a share of k_bar: each curve ends where the error
    /// is larger.
    #[arg(long, value_name = "SHARE", value_parser = share, default_value = "3%", allow_hyphen_values = true)]
    pub error: f64,
    /// Solve nothing and make the tables again from these tables of samples (exponent-samples.csv, plain or
    /// compressed by gzip) of runs with different seeds, separated by commas.
    #[arg(long, value_name = "CSV", value_delimiter = ',')]
    pub samples: Vec<PathBuf>,
    /// The tables of --samples on which the hypotheses are tested [default: all].
    #[arg(long, value_name = "CSV", value_delimiter = ',', requires = "samples")]
    pub tested: Vec<PathBuf>,
    /// Master seed.
    #[arg(long, default_value_t = paper::evaluation::SEED)]
    seed: u64,
    /// Threads; 0 means one per core. The CSV files do not depend on it.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Ignore stored results and solve everything again.
    #[arg(long)]
    fresh: bool,
    /// Predict the cost and the number of surfaces that --budget allows, and stop.
    #[arg(long)]
    pub plan: bool,
    /// With --plan: the time for the surfaces, and the same time again for the lines, such as 90s, 10min, 2h.
    #[arg(long, value_name = "TIME", value_parser = runs::amounts::seconds, default_value = "1h", allow_hyphen_values = true)]
    pub budget: f64,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    #[command(flatten)]
    pub(super) sharded: Sharded,
}

impl ExponentArguments {
    pub(super) fn fill(&self, request: &mut Request) {
        request.fractal_dimensions.clone_from(&self.fractal_dimensions);
        (request.seed, request.threads) = (Some(self.seed), Some(self.threads));
        (request.out, request.fresh) = (Some(self.out.clone()), self.fresh);
    }

    /// The study that these flags describe; dimensions, seed, threads and directory are those of the run.
    ///
    /// # Errors
    /// [`runs::Error::Parameter`] for an invalid list of loads.
    pub fn study(&self, run: &Run) -> runs::Result<Exponent> {
        let mut study = Exponent::new(self.preset)?;
        let lists = [
            (&mut study.solid.sizes, &self.grids),
            (&mut study.solid.surfaces, &self.surfaces),
            (&mut study.line.sizes, &self.elements),
            (&mut study.line.surfaces, &self.lines),
        ];
        for (own, asked) in lists {
            if let Some(asked) = asked {
                own.clone_from(asked);
            }
        }
        for (own, asked) in
            [(&mut study.solid.forces, &self.forces), (&mut study.line.forces, &self.line_forces)]
        {
            if let Some(asked) = asked {
                *own = Forces::parse(asked)?;
            }
        }
        Ok(Exponent {
            fractal_dimensions: run.dimensions(),
            error: self.error,
            seed: run.seed,
            threads: run.threads,
            out: run.out.clone(),
            fresh: run.fresh,
            ..study
        })
    }
}

/// Sizes of the study of partial slip.
const PARTIAL_SLIP_SIZES: Words<PartialSlipSizes> = &[
    ("quick", PartialSlipSizes::Quick, "32 cells, 3 surfaces: seconds"),
    ("default", PartialSlipSizes::Default, "128 cells, 10 surfaces of two fractal dimensions"),
];

/// Flags of the study of partial slip.
#[derive(Debug, Args)]
pub struct PartialSlipArguments {
    /// Sizes to start from; the other flags override them.
    #[arg(long, value_parser = words(PARTIAL_SLIP_SIZES), default_value = "default")]
    preset: PartialSlipSizes,
    /// Number of cells along a side.
    #[arg(long, allow_hyphen_values = true)]
    cells: Option<usize>,
    /// Number of cells in the shortest wavelength.
    #[arg(long, allow_hyphen_values = true)]
    cells_per_wave: Option<usize>,
    /// Grids of the same surfaces, in cells along a side, each twice the one before: the limit of small cells
    /// instead of the tables of one grid.
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    grids: Option<Vec<usize>>,
    /// Number of surfaces of each boundary and fractal dimension.
    #[arg(long, allow_hyphen_values = true)]
    surfaces: Option<usize>,
    /// Fractal dimensions, separated by commas.
    #[arg(long = "df", value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    fractal_dimensions: Option<Vec<f64>>,
    /// Poisson's ratios, increasing from 0, separated by commas.
    #[arg(long = "poisson", value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    poissons: Option<Vec<f64>>,
    /// Loads F_bar: numbers and logarithmic ranges MIN:MAX:COUNT, separated by commas.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    forces: Option<String>,
    /// Increments from no tangential force to the end of a loop, and half of those back.
    #[arg(long, allow_hyphen_values = true)]
    increments: Option<usize>,
    /// Tolerance of each solve: it bounds the residuals of its certificate.
    #[arg(long, allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// Master seed.
    #[arg(long, default_value_t = paper::evaluation::SEED)]
    seed: u64,
    /// Threads; 0 means one per core. The CSV files do not depend on it.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Ignore stored results and solve everything again.
    #[arg(long)]
    fresh: bool,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

impl PartialSlipArguments {
    pub(super) fn fill(&self, request: &mut Request) {
        (request.seed, request.threads) = (Some(self.seed), Some(self.threads));
        (request.out, request.fresh) = (Some(self.out.clone()), self.fresh);
    }

    /// The study that these flags describe; seed, threads and directory are those of the run.
    ///
    /// # Errors
    /// [`runs::Error::Parameter`] for an invalid list of loads.
    pub fn study(&self, run: &Run) -> runs::Result<PartialSlipStudy> {
        let sizes = PartialSlipStudy::new(self.preset)?;
        let forces = self.forces.as_deref().map(Forces::parse).transpose()?;
        Ok(PartialSlipStudy {
            cells: self.cells.unwrap_or(sizes.cells),
            cells_per_wave: self.cells_per_wave.unwrap_or(sizes.cells_per_wave),
            grids: self.grids.clone().unwrap_or(sizes.grids),
            surfaces: self.surfaces.unwrap_or(sizes.surfaces),
            fractal_dimensions: self.fractal_dimensions.clone().unwrap_or(sizes.fractal_dimensions),
            poissons: self.poissons.clone().unwrap_or(sizes.poissons),
            forces: forces.unwrap_or(sizes.forces),
            increments: self.increments.unwrap_or(sizes.increments),
            tolerance: self.tolerance.unwrap_or(sizes.tolerance),
            seed: run.seed,
            threads: run.threads,
            out: run.out.clone(),
            fresh: run.fresh,
        })
    }
}

/// Flags of `redraw`.
#[derive(Debug, Args)]
pub struct Redraw {
    /// Directories with the tables of figures, two-cases, accuracy-cost or benches.
    #[arg(required = true, value_name = "DIR")]
    pub directories: Vec<PathBuf>,
    /// A table of the same figure on a coarser grid, drawn below the curves of Figs. 2 and 6.
    #[arg(long, value_name = "CSV")]
    over: Option<PathBuf>,
    /// A table of Fig. 2 on a finer grid, whose exponents and factors are drawn beside those of Figs. 3 and
    /// 7.
    #[arg(long, value_name = "CSV")]
    finer: Option<PathBuf>,
}

impl Redraw {
    /// The tables that are drawn for comparison.
    pub fn beside(&self) -> paper::Beside {
        paper::Beside { over: self.over.clone(), finer: self.finer.clone() }
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
    /// Use larger grids, more surfaces and more loads: minutes instead of seconds.
    #[arg(long)]
    pub thorough: bool,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Flags of the tuned constants.
#[derive(Debug, Args)]
pub struct TuningArguments {
    /// Measure only the constants whose names contain this.
    #[arg(long, value_name = "NAME", default_value = "")]
    pub only: String,
    /// Number of runs of each value, of which the median is reported.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub repetitions: u16,
    /// Directory of the table.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Flags of the book.
#[derive(Debug, Args)]
pub struct BookArguments {
    /// Only draw the pictures of the book again (book/pictures.sh).
    #[arg(long)]
    pub pictures: bool,
}

/// Flags of the page of the browser.
#[derive(Debug, Args)]
pub struct WebArguments {
    /// Folder of the page.
    #[arg(long, default_value = "web/dist")]
    pub out: PathBuf,
    /// Compile the standard library too, from its sources, where the target cannot be installed.
    #[arg(long)]
    pub build_std: bool,
}
