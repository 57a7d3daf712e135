//! The checked parameters of a run.

use crate::evaluation::forces::Forces;
use crate::evaluation::limits::{self, require, within};
use crate::evaluation::realisation::{Discretisation, EnsembleModel};
use runs::Result;
use std::path::PathBuf;

/// The sizes of a run before single parameters are overridden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preset {
    /// Well under a minute; for a first test and for continuous integration.
    Quick,
    /// A few minutes on two cores; all six fractal dimensions.
    #[default]
    Default,
    /// The paper's own sizes: 2049 cells a side, 60 surfaces, 2^20 elements, 500 lines.
    Paper,
    /// Sizes that the paper considers technically impossible in three dimensions: 16385 cells a side, a few
    /// surfaces, light loads. Needs 4 to 5 GB for each surface that is being solved.
    Extended,
}

impl Preset {
    /// The word on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Default => "default",
            Self::Paper => "paper",
            Self::Extended => "extended",
        }
    }

    // At least three loads a decade, both models to F_bar = 20, and the two loads at which values are quoted.
    fn sizes(self) -> PresetSizes {
        match self {
            Self::Quick => PresetSizes {
                cells: 129,
                surfaces: 8,
                elements: 1 << 16,
                lines: 40,
                forces_3d: "1e-4:20:17,0.086,1",
                forces_1d: "1e-6:20:23,0.086,1",
                tolerance: TOLERANCE,
            },
            Self::Default => PresetSizes {
                cells: 513,
                surfaces: 40,
                elements: 1 << 18,
                lines: 200,
                forces_3d: "1e-6:20:23,0.086,1",
                forces_1d: "1e-8:20:29,0.086,1",
                tolerance: TOLERANCE,
            },
            Self::Paper => PresetSizes {
                cells: 2049,
                surfaces: 60,
                elements: 1 << 20,
                lines: 500,
                forces_3d: "1e-8:20:29,0.086,1",
                forces_1d: "1e-9:20:42,0.086,1",
                // The scatter from surface to surface is a hundred times larger.
                tolerance: 1e-3,
            },
            Self::Extended => {
                PresetSizes { cells: 16385, surfaces: 4, forces_3d: "1e-9:1e-2:22", ..Self::Paper.sizes() }
            }
        }
    }
}

struct PresetSizes {
    cells: usize,
    surfaces: usize,
    elements: usize,
    lines: usize,
    forces_3d: &'static str,
    forces_1d: &'static str,
    tolerance: f64,
}

/// The parameters that the caller gives; `None` takes the value of the preset.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// The sizes to start from.
    pub preset: Preset,
    /// Cells a side of each map.
    pub cells: Option<usize>,
    /// Surfaces per fractal dimension (3D).
    pub surfaces: Option<usize>,
    /// Elements of each line.
    pub elements: Option<usize>,
    /// Lines per fractal dimension (1D).
    pub lines: Option<usize>,
    /// Fractal dimensions.
    pub fractal_dimensions: Option<Vec<f64>>,
    /// Loads F_bar of both models, in the words of [`Forces::parse`].
    pub forces: Option<String>,
    /// Tolerance of the 3D solver.
    pub tolerance: Option<f64>,
    /// Master seed.
    pub seed: Option<u64>,
    /// Number of threads; 0 or `None` is one per core.
    pub threads: Option<usize>,
    /// Directory of the results; `out` by default.
    pub out: Option<PathBuf>,
    /// Ignore stored results.
    pub fresh: bool,
    /// A `fig2.csv` or `fig6.csv` of another run, drawn below the curves.
    pub over: Option<PathBuf>,
    /// The directory of another run whose compact tables have the surfaces; nothing is solved.
    pub samples: Option<PathBuf>,
}

/// Everything that determines the content of a figure and, at the end, the parameters that do not: threads,
/// directory, fresh.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The preset that the sizes started from.
    pub preset: Preset,
    /// Cells a side of each map, N.
    pub cells: usize,
    /// Surfaces per fractal dimension (3D).
    pub surfaces: usize,
    /// Elements of each line.
    pub elements: usize,
    /// Lines per fractal dimension (1D).
    pub lines: usize,
    /// Fractal dimensions, increasing; `None`: each figure's own.
    pub fractal_dimensions: Option<Vec<f64>>,
    /// Loads of the 3D model.
    pub forces_3d: Forces,
    /// Loads of the 1D model.
    pub forces_1d: Forces,
    /// Whether the loads were given rather than taken from the preset.
    pub forces_given: bool,
    /// Tolerance of the 3D solver (certificate and stiffness error at most this).
    pub tolerance: f64,
    /// Master seed; surface number i has the seed `surface_gen::surface_seed(seed, i)`.
    pub seed: u64,
    /// Number of threads.
    pub threads: usize,
    /// Directory of the results.
    pub out: PathBuf,
    /// Ignore stored results.
    pub fresh: bool,
    /// A table of another run that is drawn below the curves.
    pub over: Option<PathBuf>,
    /// Directory of `fig2-compact.csv` and `fig6-compact.csv`, from which surfaces are read instead of solved.
    pub samples: Option<PathBuf>,
}

/// The paper's six fractal dimensions.
pub const FRACTAL_DIMENSIONS: [f64; 6] = [2.0, 2.2, 2.4, 2.6, 2.8, 3.0];

/// Default master seed: the paper's volume and article.
pub const SEED: u64 = 86_026_710;

/// Tolerance of the 3D solver for figures of the smaller presets.
pub const TOLERANCE: f64 = 1e-4;

impl Run {
    /// Expands the preset, applies the request, and checks the result.
    ///
    /// # Errors
    /// [`runs::Error::Parameter`] naming the first invalid value.
    ///
    /// ```
    /// use paper::evaluation::{Preset, Request, Run};
    /// let run = Run::new(&Request { preset: Preset::Paper, surfaces: Some(2), ..Request::default() })?;
    /// assert_eq!((run.cells, run.surfaces), (2049, 2));
    /// let none = Run::new(&Request { cells: Some(0), ..Request::default() });
    /// assert_eq!(none.unwrap_err().to_string(), "cells = 0: expected a whole number from 3 to 65536");
    /// # Ok::<(), paper::evaluation::Error>(())
    /// ```
    pub fn new(request: &Request) -> Result<Self> {
        let sizes = request.preset.sizes();
        let forces = |preset| Forces::parse(request.forces.as_deref().unwrap_or(preset));
        let tolerance = request.tolerance.unwrap_or(sizes.tolerance);
        limits::tolerance(tolerance)?;
        let fractal_dimensions = request.fractal_dimensions.as_deref().map(dimensions).transpose()?;
        // Each fractal dimension is solved on every surface and line.
        let of_each = fractal_dimensions.as_ref().map_or(FRACTAL_DIMENSIONS.len(), Vec::len);
        let counted =
            |name, count| limits::jobs(name, within(name, count, &limits::COUNT)?, of_each).map(|()| count);
        Ok(Self {
            preset: request.preset,
            // Fewer than 3 cells a side hold no wave besides the Nyquist one, which has no phase: all heights
            // are equal.
            cells: within("cells", request.cells.unwrap_or(sizes.cells), &limits::CELLS)?,
            surfaces: counted("surfaces", request.surfaces.unwrap_or(sizes.surfaces))?,
            elements: within("elements", request.elements.unwrap_or(sizes.elements), &limits::ELEMENTS)?,
            lines: counted("lines", request.lines.unwrap_or(sizes.lines))?,
            fractal_dimensions,
            forces_3d: forces(sizes.forces_3d)?,
            forces_1d: forces(sizes.forces_1d)?,
            forces_given: request.forces.is_some(),
            tolerance,
            seed: request.seed.unwrap_or(SEED),
            threads: threads(request.threads)?,
            out: request.out.clone().unwrap_or_else(|| PathBuf::from("out")),
            fresh: request.fresh,
            over: request.over.clone(),
            samples: request.samples.clone(),
        })
    }

    /// The requested fractal dimensions, or the paper's six.
    pub fn dimensions(&self) -> Vec<f64> {
        self.fractal_dimensions.clone().unwrap_or_else(|| FRACTAL_DIMENSIONS.to_vec())
    }

    /// How the ensemble of a model is solved, the number of its surfaces, and its loads.
    pub fn ensemble(&self, model: EnsembleModel) -> (Discretisation, usize, &Forces) {
        let Self { cells, tolerance, elements, .. } = *self;
        match model {
            EnsembleModel::Bem3d => {
                (Discretisation::Bem3d { cells, tolerance }, self.surfaces, &self.forces_3d)
            }
            EnsembleModel::Mdr1d => (Discretisation::Mdr1d { elements }, self.lines, &self.forces_1d),
        }
    }

    /// The same run with this number of cells a side (elements) and of surfaces (lines) of a model.
    #[must_use]
    pub fn with_sizes(&self, model: EnsembleModel, size: usize, surfaces: usize) -> Self {
        match model {
            EnsembleModel::Bem3d => Self { cells: size, surfaces, ..self.clone() },
            EnsembleModel::Mdr1d => Self { elements: size, lines: surfaces, ..self.clone() },
        }
    }

    /// The command that makes the same files, with every parameter of `flags` written out.
    ///
    /// Parameters that do not change the files (threads, directory, fresh) are left out.
    pub fn command(&self, name: &str, flags: &[Flag]) -> String {
        let mut text = format!("cargo xtask {name} --preset {}", self.preset.as_str());
        for flag in flags {
            if let Some(value) = (flag.value)(self) {
                text += &format!(" --{} {value}", flag.name);
            }
        }
        text
    }
}

/// A parameter that changes results and is therefore written into headers.
#[derive(Debug, Clone, Copy)]
pub struct Flag {
    name: &'static str,
    /// The value of a run; `None` where that of its preset holds.
    value: fn(&Run) -> Option<String>,
}

impl Flag {
    /// `--cells`
    pub const CELLS: Self = Self::new("cells", |run| Some(run.cells.to_string()));
    /// `--surfaces`
    pub const SURFACES: Self = Self::new("surfaces", |run| Some(run.surfaces.to_string()));
    /// `--elements`
    pub const ELEMENTS: Self = Self::new("elements", |run| Some(run.elements.to_string()));
    /// `--lines`
    pub const LINES: Self = Self::new("lines", |run| Some(run.lines.to_string()));
    /// `--fractal-dimensions`
    pub const FRACTAL_DIMENSIONS: Self =
        Self::new("fractal-dimensions", |run| run.fractal_dimensions.as_deref().map(list));
    /// `--forces`
    pub const FORCES: Self =
        Self::new("forces", |run| run.forces_given.then(|| run.forces_3d.spec().to_owned()));
    /// `--tolerance`
    pub const TOLERANCE: Self = Self::new("tolerance", |run| Some(format!("{:?}", run.tolerance)));
    /// `--seed`
    pub const SEED: Self = Self::new("seed", |run| Some(run.seed.to_string()));
    /// `--samples`
    pub const SAMPLES: Self =
        Self::new("samples", |run| run.samples.as_ref().map(|path| path.display().to_string()));
    /// All of them, in the order of a command.
    pub const ALL: [Self; 9] = [
        Self::CELLS,
        Self::SURFACES,
        Self::ELEMENTS,
        Self::LINES,
        Self::FRACTAL_DIMENSIONS,
        Self::FORCES,
        Self::TOLERANCE,
        Self::SEED,
        Self::SAMPLES,
    ];

    const fn new(name: &'static str, value: fn(&Run) -> Option<String>) -> Self {
        Self { name, value }
    }
}

/// `2.0,2.2`: shortest digits that read back to the same numbers.
pub fn list(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(",")
}

/// The distinct values, increasing.
pub fn distinct(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.into_iter().collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| a.total_cmp(b).is_eq());
    all
}

fn dimensions(asked: &[f64]) -> Result<Vec<f64>> {
    let name = "fractal-dimensions";
    require(!asked.is_empty(), name, "(nothing)", "at least one number in [2, 3]")?;
    asked.iter().try_for_each(|d| require((2.0..=3.0).contains(d), name, d, "numbers in [2, 3]"))?;
    Ok(distinct(asked.iter().copied()))
}

fn threads(asked: Option<usize>) -> Result<usize> {
    match asked {
        None | Some(0) => Ok(std::thread::available_parallelism().map_or(1, usize::from)),
        Some(n) => within("threads", n, &(1..=runs::MOST_THREADS)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_expand_and_are_overridden() {
        for preset in [Preset::Quick, Preset::Default, Preset::Paper] {
            let run = Run::new(&Request { preset, ..Request::default() }).unwrap();
            for forces in [run.forces_3d.values(), run.forces_1d.values()] {
                assert_eq!(forces.last(), Some(&20.0));
                assert!(forces.contains(&0.086) && forces.contains(&1.0));
                let decades = (20.0 / forces[0]).log10();
                assert!(forces.len() as f64 >= 3.0 * decades, "{preset:?}");
            }
        }
        let paper = Run::new(&Request { preset: Preset::Paper, ..Request::default() }).unwrap();
        assert_eq!((paper.cells, paper.surfaces, paper.elements, paper.lines), (2049, 60, 1 << 20, 500));
        assert_eq!((paper.forces_3d.values()[0], paper.forces_1d.values()[0]), (1e-8, 1e-9));
        assert_eq!(paper.dimensions(), FRACTAL_DIMENSIONS);
    }

    #[test]
    fn bad_values_are_named() {
        let bad = |r: Request| Run::new(&r).unwrap_err().to_string();
        let base = Request::default;
        assert!(bad(Request { surfaces: Some(0), ..base() }).starts_with("surfaces = 0: expected"));
        assert!(bad(Request { lines: Some(0), ..base() }).starts_with("lines = 0"));
        assert!(bad(Request { elements: Some(0), ..base() }).starts_with("elements = 0"));
        assert!(bad(Request { tolerance: Some(f64::NAN), ..base() }).starts_with("tolerance = NaN"));
        let d = |v| Request { fractal_dimensions: Some(v), ..base() };
        assert_eq!(bad(d(vec![1.9])), "fractal-dimensions = 1.9: expected numbers in [2, 3]");
        assert!(bad(d(vec![])).contains("at least one"));
        assert!(bad(d(vec![f64::NAN])).contains("NaN"));
        assert!(bad(Request { forces: Some("-1".into()), ..base() }).starts_with("forces = -1"));
    }

    #[test]
    fn the_command_has_the_parameters_that_change_results_and_no_others() {
        let request = Request {
            fractal_dimensions: Some(vec![2.4, 2.0, 2.4]),
            forces: Some("1e-2, 1".into()),
            threads: Some(3),
            ..Request::default()
        };
        let run = Run::new(&request).unwrap();
        assert_eq!(
            run.command("reproduce-fig2", &[Flag::CELLS, Flag::FRACTAL_DIMENSIONS, Flag::FORCES, Flag::SEED]),
            "cargo xtask reproduce-fig2 --preset default --cells 513 --fractal-dimensions 2.0,2.4 \
             --forces 1e-2,1 --seed 86026710"
        );
    }
}
