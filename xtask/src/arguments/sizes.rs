//! Flags that the figures share: sizes, what to solve, where to write.

use super::cluster::Sharded;
use super::words::{Words, words};
use clap::Args;
use paper::evaluation::{AccuracyTarget, Preset, Request};
use std::path::PathBuf;

const PRESETS: Words<Preset> = &[
    ("quick", Preset::Quick, "Well under a minute: 129 cells, 8 surfaces, 2^16 elements, 40 lines"),
    ("default", Preset::Default, "A few minutes: 513 cells, 40 surfaces, 2^18 elements, 200 lines"),
    (
        "paper",
        Preset::Paper,
        "The paper's sizes: 2049 cells, 60 surfaces, 2^20 elements, 500 lines; tolerance 1e-3",
    ),
    (
        "extended",
        Preset::Extended,
        "Beyond the paper: 16385 cells, 4 surfaces, light loads; tolerance 1e-3, 5 GB for each thread",
    ),
];

/// Flags of every figure.
#[derive(Debug, Args)]
pub struct Common {
    /// Sizes to start from; the other flags override them.
    #[arg(long, value_parser = words(PRESETS), default_value = "default")]
    preset: Preset,
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
    pub(super) fn fill(&self, request: &mut Request) {
        request.preset = self.preset;
        request.fractal_dimensions.clone_from(&self.fractal_dimensions);
        request.seed = self.seed;
        request.out = Some(self.out.clone());
    }
}

/// Flags of everything that is solved.
#[derive(Debug, Args)]
pub struct SolveSizes {
    /// Loads F_bar: numbers and logarithmic ranges MIN:MAX:COUNT (both ends included), separated by commas.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    forces: Option<String>,
    /// Threads; 0 means one per core. The CSV files do not depend on it.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Ignore stored results and solve everything again.
    #[arg(long)]
    fresh: bool,
    /// Choose grid, tolerance and number of surfaces so that the relative error (half-width of the 95 %
    /// interval) of each mean k_bar is at most this, except at loads that touch about one cell: a share or
    /// per cent, such as 0.02 or 2%. Pilot solves on finer and finer grids run first.
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    accuracy: Option<f64>,
    /// Longest predicted time of one thread that --accuracy may choose, such as 90s, 10min, 2h.
    #[arg(long, value_name = "TIME", value_parser = runs::amounts::seconds, default_value = "10min", requires = "accuracy", allow_hyphen_values = true)]
    budget: f64,
    /// Read the surfaces from fig2-compact.csv and fig6-compact.csv in this directory, which an earlier run of
    /// the same sizes wrote, and solve none of them (Figs. 3, 4 and 7, verify).
    #[arg(long, value_name = "DIR", conflicts_with_all = ["accuracy", "fresh", "shard"])]
    samples: Option<PathBuf>,
    /// Draw the curves of the fig2.csv or fig6.csv of another run below those of this one (Figs. 2 and 6).
    #[arg(long, value_name = "FILE.csv")]
    over: Option<PathBuf>,
    #[command(flatten)]
    pub(super) sharded: Sharded,
}

impl SolveSizes {
    pub(super) fn target(&self) -> Option<AccuracyTarget> {
        self.accuracy.map(|share| AccuracyTarget { share, seconds: self.budget })
    }

    pub(super) fn fill(&self, request: &mut Request) {
        request.forces.clone_from(&self.forces);
        request.threads = Some(self.threads);
        request.fresh = self.fresh;
        request.over.clone_from(&self.over);
        request.samples.clone_from(&self.samples);
    }
}

/// A share: `0.02` or `2%`.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let (digits, unit) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 100.0));
    let value = digits.trim().parse::<f64>().map_err(|e| e.to_string())? / unit;
    if value > 0.0 && value < 1.0 {
        Ok(value)
    } else {
        Err("expected a share between 0 and 1, such as 0.02 or 2%".into())
    }
}

/// Sizes of ensembles.
pub trait Sizes {
    fn fill(&self, request: &mut Request);
}

/// Size of the 3D ensemble.
#[derive(Debug, Args)]
pub struct SolidSize {
    /// Number of cells N along a side of each surface (any number from 3; the paper has 2049).
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
    /// Surfaces per fractal dimension (the paper has 60).
    #[arg(long, value_name = "COUNT")]
    surfaces: Option<usize>,
    /// Tolerance of the 3D solver: it bounds the residuals of the certificate and the error of k.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    tolerance: Option<f64>,
}

impl Sizes for SolidSize {
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

impl Sizes for LineSize {
    fn fill(&self, request: &mut Request) {
        (request.elements, request.lines) = (self.elements, self.lines);
    }
}

/// Flags of Fig. 1.
#[derive(Debug, Args)]
pub struct Maps {
    #[command(flatten)]
    common: Common,
    /// Number of cells along a side of each map (the paper has 2049).
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
}

impl Maps {
    pub(super) fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        request.cells = self.cells;
    }
}

/// Flags of Fig. 5.
#[derive(Debug, Args)]
pub struct LineSizes {
    #[command(flatten)]
    common: Common,
    /// Elements of each line (the paper has 2^20 = 1048576).
    #[arg(long, value_name = "N")]
    elements: Option<usize>,
}

impl LineSizes {
    pub(super) fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        request.elements = self.elements;
    }
}

/// Sizes of both ensembles.
#[derive(Debug, Args)]
pub struct BothSizes {
    #[command(flatten)]
    solid: SolidSize,
    #[command(flatten)]
    line: LineSize,
}

impl Sizes for BothSizes {
    fn fill(&self, request: &mut Request) {
        self.solid.fill(request);
        self.line.fill(request);
    }
}

/// Flags of a figure that solves ensembles of these sizes.
#[derive(Debug, Args)]
pub struct EnsembleFlags<S: Args> {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    size: S,
    #[command(flatten)]
    pub(super) solve: SolveSizes,
}

impl<S: Args + Sizes> EnsembleFlags<S> {
    pub(super) fn fill(&self, request: &mut Request) {
        self.common.fill(request);
        self.size.fill(request);
        self.solve.fill(request);
    }
}

/// Flags of Figs. 2 and 4.
pub type Solid = EnsembleFlags<SolidSize>;
/// Flags of Fig. 6.
pub type ReducedSizes = EnsembleFlags<LineSize>;
/// Flags of everything that needs both models.
pub type Both = EnsembleFlags<BothSizes>;
