//! The two problems and their results.

use crate::claim::Estimate;
use crate::evaluation::limits::{self, require, within};
use crate::evaluation::{Forces, list};
use analysis::StiffnessSample;
use bem3d::Bem3d;
use contact_model::{Boundary, Scene, SelfAffine, Surface};
use fractal_contact::scenes::{
    AskedLoads, AskedSampling, AskedSelfAffine, AskedSurface, LoadList, Material, Numerics, PrescribedLoad,
    Question, System,
};
use runs::{Error, Result};
use std::f64::consts::TAU;

pub(crate) const NAME: &str = "two-cases";

/// The parameters of the study.
///
/// Sec. II of the paper distinguishes two problems. One is fractal up to the size of the system and has free
/// edges; there it expects `k ~ F^alpha`. In the other the spectrum ends at a longest wave and a periodic
/// patch represents the whole surface; there Persson finds `k ~ F`.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoCases {
    /// Cells a side.
    pub cells: usize,
    /// Number of cells in the shortest wave: the theories need a spectrum with an end, which the grid
    /// resolves. The same surfaces are also solved with half as many cells.
    pub cells_per_wave: usize,
    /// Surfaces of each case.
    pub surfaces: usize,
    /// D_f.
    pub fractal_dimensions: Vec<f64>,
    /// Waves a side at the roll-off.
    pub roll_offs: Vec<f64>,
    /// Loads F_bar.
    pub forces: Forces,
    /// Bound of every certificate.
    pub tolerance: f64,
    /// Master seed.
    pub seed: u64,
    /// Surfaces solved at the same time, at least 1.
    pub threads: usize,
}

/// A boundary and a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SurfaceCase {
    pub(super) boundary: Boundary,
    pub(super) fractal_dimension: f64,
    /// Waves a side at the roll-off; `None` for a spectrum that is fractal to the side.
    pub(super) roll_off: Option<f64>,
}

/// The paper's two cases, and the two others that separate the effects of boundary and spectrum: name and
/// colour in the table and the pictures.
pub(super) const NAMES: [(&str, &str); 4] = [
    ("free, fractal", "#30126e"),
    ("free, roll-off", "#8c2d5a"),
    ("periodic, fractal", "#1a8f89"),
    ("periodic, roll-off", "#d6731a"),
];

impl SurfaceCase {
    pub(super) fn name(self) -> &'static str {
        let row = 2 * usize::from(self.boundary == Boundary::Periodic) + usize::from(self.roll_off.is_some());
        NAMES[row].0
    }

    /// The name with its numbers.
    pub(super) fn label(self) -> String {
        let d = self.fractal_dimension;
        match self.roll_off {
            Some(waves) => format!("{} at {waves} waves a side, D_f = {d:?}", self.name()),
            None => format!("{}, D_f = {d:?}", self.name()),
        }
    }

    pub(super) fn scene(self, study: &TwoCases) -> Result<Scene> {
        let d = self.fractal_dimension;
        let surface = SelfAffine::new(d, 1.0, 1.0).map_err(Error::model(format!("D_f = {d:?}")))?;
        let surface = SelfAffine {
            roll_off: self.roll_off.map(|waves| TAU * waves),
            short_cutoff: Some(TAU * study.shortest()),
            ..surface
        };
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        scene.effects.boundary = self.boundary;
        scene.validate().map_err(Error::model(format!("the case {}", self.label())))?;
        Ok(scene)
    }
}

impl SurfaceCase {
    /// The question of all surfaces of the case under all loads; theories answer it where the boundary is
    /// periodic.
    pub(super) fn question(self, study: &TwoCases) -> Question {
        let mut question = Question::default();
        let bem3d = Bem3d { cells: study.cells, tolerance: study.tolerance, ..Bem3d::default() };
        question.units = System::None;
        question.models = vec![Numerics::Bem3d(bem3d)];
        question.effects.boundary = self.boundary;
        if self.boundary == Boundary::Periodic {
            question
                .models
                .extend(["persson", "greenwood_williamson"].into_iter().filter_map(Numerics::named));
        }
        question.material = Some(Material::ContactModulus(1.0));
        let values = study.forces.values().to_vec();
        question.loads = Some(AskedLoads::Loads(LoadList { kind: PrescribedLoad::ForceBar, values }));
        let mut surface = AskedSelfAffine::default();
        surface.size = Some(1.0.into());
        surface.hurst = Some(3.0 - self.fractal_dimension);
        surface.rms_height = Some(1.0);
        surface.roll_off_wavelength = self.roll_off.map(|waves| 1.0 / waves);
        surface.shortest_wavelength = Some(1.0 / study.shortest());
        question.surface = Some(AskedSurface::SelfAffine(surface));
        (question.outputs.outputs.stiffness, question.outputs.outputs.area) = (true, true);
        question.sampling =
            Some(AskedSampling { seed: Some(study.seed), surfaces: Some(study.surfaces as u64) });
        question
    }

    /// Rms slope of the spectrum, in h/L.
    pub(super) fn slope(self, study: &TwoCases) -> Result<f64> {
        let Surface::SelfAffine(surface) = self.scene(study)?.surface else { return Ok(0.0) };
        let generator =
            surface_gen::MapGenerator::new(&surface, study.cells).map_err(Error::model(self.label()))?;
        Ok(generator.rms_slope())
    }
}

/// Ratio of periodic to free stiffness of the same surfaces.
pub(super) struct PairRow {
    pub(super) fractal_dimension: f64,
    /// Waves a side at the roll-off; `None` for a spectrum that is fractal to the side.
    pub(super) roll_off: Option<f64>,
    pub(super) force_bar: f64,
    /// Mean of one over mean of the other, and the half-width of its 95 % interval.
    pub(super) ratio: Estimate,
    pub(super) surfaces: usize,
}

impl TwoCases {
    /// The paper's two cases and the two mixed ones for each fractal dimension: first those that are fractal
    /// up to the side, which all roll-offs have in common.
    pub(super) fn cases(&self) -> Vec<SurfaceCase> {
        let spectra = || std::iter::once(None).chain(self.roll_offs.iter().copied().map(Some));
        let of = |&fractal_dimension: &f64| {
            [Boundary::Free, Boundary::Periodic].into_iter().flat_map(move |boundary| {
                spectra().map(move |roll_off| SurfaceCase { boundary, fractal_dimension, roll_off })
            })
        };
        self.fractal_dimensions.iter().flat_map(of).collect()
    }

    /// The same surfaces with cells twice as large.
    pub(super) fn coarser(&self) -> Self {
        Self { cells: self.cells / 2, cells_per_wave: self.cells_per_wave / 2, ..self.clone() }
    }

    /// Waves a side at the end of the spectrum.
    pub(super) fn shortest(&self) -> f64 {
        (self.cells / self.cells_per_wave) as f64
    }

    pub(super) fn command(&self) -> String {
        format!(
            "cargo xtask reproduce-two-cases --cells {} --cells-per-wave {} --surfaces {} --df {} --roll-off {} --forces {} --tolerance {:?} --seed {}",
            self.cells,
            self.cells_per_wave,
            self.surfaces,
            list(&self.fractal_dimensions),
            list(&self.roll_offs),
            self.forces.spec(),
            self.tolerance,
            self.seed
        )
    }

    pub(super) fn check(&self) -> Result<()> {
        within("threads", self.threads, &(1..=runs::MOST_THREADS))?;
        within("surfaces", self.surfaces, &limits::COUNT)?;
        within("cells", self.cells, &limits::CELLS)?;
        // Four cases of each pair, on two grids.
        let pairs = self.fractal_dimensions.len().saturating_mul(self.roll_offs.len());
        limits::jobs("surfaces", self.surfaces, pairs.saturating_mul(8))?;
        limits::tolerance(self.tolerance)?;
        let dimension = |d: &f64| require((2.0..=3.0).contains(d), "df", d, "numbers in [2, 3]");
        self.fractal_dimensions.iter().try_for_each(dimension)?;
        let (cells, per_wave, most) = (self.cells, self.cells_per_wave, limits::CELLS.end() / 4);
        let even = (4..=most).contains(&per_wave) && per_wave.is_multiple_of(2);
        require(even, "cells-per-wave", per_wave, format!("an even number from 4 to {most}"))?;
        let expected = format!("a multiple of the {per_wave} cells of the shortest wave");
        require(cells.is_multiple_of(per_wave), "cells", cells, expected)?;
        require(cells / 4 >= per_wave, "cells", cells, "at least four of the shortest waves a side")?;
        for (name, given) in [("df", &self.fractal_dimensions), ("roll-off", &self.roll_offs)] {
            require(!given.is_empty(), name, "nothing", "at least one number")?;
        }
        let shortest = self.shortest();
        let expected = format!("between 1 and {shortest} waves a side (cells / {per_wave})");
        for &waves in &self.roll_offs {
            require(waves > 1.0 && waves < shortest, "roll-off", waves, expected.as_str())?;
        }
        Ok(())
    }
}

/// The result of one solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CaseSolve {
    /// A stiffness and the share of the square in contact.
    StiffnessSample(StiffnessSample, f64),
    /// Full contact of a periodic square, which has no stiffness.
    FullContact,
    /// A solve that did not meet its tolerance.
    NotConverged,
}

impl CaseSolve {
    pub(super) fn sample(self) -> Option<(StiffnessSample, f64)> {
        match self {
            Self::StiffnessSample(sample, area) => Some((sample, area)),
            Self::FullContact | Self::NotConverged => None,
        }
    }
}

pub(super) type Solves = Vec<CaseSolve>;

/// One curve: k_bar over F_bar.
pub(super) struct CaseCurve {
    pub(super) case: SurfaceCase,
    pub(super) model: &'static str,
    pub(super) points: Vec<CasePoint>,
}

#[derive(Default)]
pub(super) struct CasePoint {
    pub(super) force_bar: f64,
    pub(super) stiffness_bar: f64,
    pub(super) standard_error: Option<f64>,
    pub(super) surfaces: usize,
    pub(super) left_out: usize,
    pub(super) area: Option<f64>,
    /// The area with cells twice as large.
    pub(super) area_coarser: Option<f64>,
    /// A E* |grad h|/F.
    pub(super) kappa: Option<f64>,
    pub(super) min_contact_cells: Option<usize>,
}
