//! The problems of the study: bodies with an exact solution and rough surfaces under four loads.

use analytic::flat_punch::SQUARE_STIFFNESS;
use contact_model::{Amplitude, Line, Load, Scene, SelfAffine, Surface, line_length};
use runs::{Error, Result};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use surface_gen::MapGenerator;

/// Contact radius of the sphere in sides: far from the edges, with 39 cells on 129.
pub(crate) const RADIUS: f64 = 0.3;

/// Cells of the coarsest grid in the shortest wave of a band-limited surface.
pub(crate) const CELLS_PER_WAVE: f64 = 16.0;

/// The paper's grid: the spectrum's constant is such that its rms height there is 1.
pub(crate) const PAPER_CELLS: usize = 2049;

/// Loads of the rough surfaces.
pub(crate) const LOADS: [f64; 4] = [1e-2, 0.1, 1.0, 20.0];
/// Their fractal dimensions.
pub(crate) const DIMENSIONS: [f64; 3] = [2.0, 2.4, 2.8];

/// Groups of problems that share a meaning of "error".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Family {
    /// Hertz's sphere, for which every quantity is known.
    Sphere,
    /// The rigid square punch.
    Square,
    /// One surface whose waves are resolved by all grids: finer grids change the discretisation error only.
    Band,
    /// Waves down to the cell of each grid, with a fixed constant of the spectrum: finer grids add waves, and
    /// so reduce the truncation error.
    Spectrum,
    /// The mean of an ensemble, with each surface normalised by its own rms height as in Figs. 2 and 6.
    Mean,
}

impl Family {
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Square => "square",
            Self::Band => "band",
            Self::Spectrum => "spectrum",
            Self::Mean => "mean",
        }
    }
}

/// The problem to which a row belongs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct ProblemKey {
    pub family: Family,
    pub fractal_dimension: Option<f64>,
    /// F_bar of a rough surface.
    pub force_bar: Option<f64>,
}

impl ProblemKey {
    pub fn body(family: Family) -> Self {
        Self { family, fractal_dimension: None, force_bar: None }
    }

    pub fn rough(family: Family, fractal_dimension: f64, force_bar: f64) -> Self {
        Self { family, fractal_dimension: Some(fractal_dimension), force_bar: Some(force_bar) }
    }
}

/// One body under one load; E* = L = 1, rough surfaces of rms height 1, so that F = F_bar.
#[derive(Debug, Clone)]
pub(crate) struct StudyProblem {
    pub key: ProblemKey,
    pub scene: Scene,
    pub load: Load,
}

impl StudyProblem {
    /// Everything that a preset with this coarsest grid solves surface by surface.
    pub fn all(coarsest: usize) -> Result<Vec<Self>> {
        let mut all = vec![Self::sphere(), Self::square()];
        for family in [Family::Band, Family::Spectrum] {
            for d in DIMENSIONS {
                let what = || format!("the surface of D_f = {d:?}");
                let surface = match family {
                    Family::Band => band(d, coarsest),
                    _ => spectrum(d),
                };
                let scene = Scene::new(Surface::SelfAffine(surface.map_err(Error::model(what()))?), 1.0);
                all.extend(LOADS.map(|force_bar| Self {
                    key: ProblemKey::rough(family, d, force_bar),
                    scene: scene.clone(),
                    load: Load::force(force_bar),
                }));
            }
        }
        for problem in &mut all {
            problem.scene.outputs.area = true;
            // At the edge of a punch the pressure has no square that could be integrated.
            problem.scene.outputs.pressure = problem.key.family != Family::Square;
        }
        Ok(all)
    }

    fn sphere() -> Self {
        let surface = Surface::Sphere { radius: 1.0, size: 1.0.into() };
        // F = (4/3) E* a^3 / R.
        let load = Load::force(4.0 / 3.0 * RADIUS.powi(3));
        let scene = Scene::new(surface, 1.0);
        Self { key: ProblemKey::body(Family::Sphere), scene, load }
    }

    fn square() -> Self {
        let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        Self { key: ProblemKey::body(Family::Square), scene, load: Load::force(1.0) }
    }

    /// Stiffness, approach and area from formulas: `a = RADIUS`, `d = a^2 / R`, `k = 2 E* a`; `d = F/k` of
    /// the punch.
    pub fn exact(&self) -> [Option<f64>; 3] {
        match self.key.family {
            Family::Sphere => [2.0 * RADIUS, RADIUS * RADIUS, PI * RADIUS * RADIUS].map(Some),
            Family::Square => [SQUARE_STIFFNESS, 1.0 / SQUARE_STIFFNESS, 1.0].map(Some),
            _ => [None; 3],
        }
    }

    /// Hertz's pressure at the cells' centres, in units of E*: `p = (2/pi) (E*/R) sqrt(a^2 - r^2)`.
    pub fn exact_pressure(&self, cells: usize) -> Option<Vec<f64>> {
        if self.key.family != Family::Sphere {
            return None;
        }
        let at = |i: usize| (i as f64 + 0.5) / cells as f64 - 0.5;
        let pressure = |x: f64, y: f64| 2.0 / PI * (RADIUS * RADIUS - x * x - y * y).max(0.0).sqrt();
        Some((0..cells * cells).map(|i| pressure(at(i % cells), at(i / cells))).collect())
    }

    /// The scene of the one-dimensional model where it differs: a flat line of the length that replaces the
    /// square.
    pub fn line(&self, elements: usize) -> Result<Scene> {
        let mut scene = self.scene.clone();
        scene.outputs.pressure = false;
        if self.key.family == Family::Square {
            let line =
                Line::new(line_length(1.0), vec![0.0; elements]).map_err(Error::model("a flat line"))?;
            scene.surface = Surface::Line { line: Arc::new(line), size: 1.0.into() };
            scene.outputs.area = false;
        }
        Ok(scene)
    }
}

/// Waves of at least 16 cells of the coarsest grid; the same amplitudes on every finer one.
fn band(d: f64, coarsest: usize) -> contact_model::Result<SelfAffine> {
    let mut surface = SelfAffine::new(d, 1.0, 1.0)?;
    surface.short_cutoff = Some(TAU * (coarsest as f64 / CELLS_PER_WAVE).floor());
    Ok(surface)
}

/// Waves to the end of the grid; the constant gives the paper's grid the rms height 1.
fn spectrum(d: f64) -> contact_model::Result<SelfAffine> {
    let surface = SelfAffine { amplitude: Amplitude::Spectrum(1.0), ..SelfAffine::new(d, 1.0, 1.0)? };
    let rms = MapGenerator::new(&surface, PAPER_CELLS)?.rms_height();
    Ok(SelfAffine { amplitude: Amplitude::Spectrum(rms.powi(-2)), ..surface })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use surface_gen::height_map;

    #[test]
    fn the_two_families_are_what_they_say() {
        // Sampled at the cells' centres, a band-limited surface has its rms on every grid.
        let band = Surface::SelfAffine(band(2.4, 129).unwrap());
        for n in [129, 257] {
            let map = height_map(&band, n, 1).unwrap();
            assert_relative_eq!(surface_gen::rms_height(map.heights()), 1.0, max_relative = 1e-12);
        }
        // Waves to the grid's end: finer grids add some, the paper's reaches 1.
        let surface = spectrum(2.4).unwrap();
        let rms = |n| MapGenerator::new(&surface, n).unwrap().rms_height();
        assert!(rms(129) < rms(257) && rms(257) < 1.0);
        assert_relative_eq!(rms(PAPER_CELLS), 1.0, max_relative = 1e-12);
    }

    #[test]
    fn hertz_by_hand() {
        let problem = StudyProblem::sphere();
        let exact = problem.exact();
        // F = (4/3) a^3 = 0.036; the mean pressure times the area is the force.
        assert_eq!(exact[..2], [Some(0.6), Some(0.09)]);
        let p = problem.exact_pressure(301).unwrap();
        assert_relative_eq!(p.iter().sum::<f64>() / (301.0 * 301.0), 0.036, max_relative = 1e-4);
        assert_eq!(StudyProblem::all(65).unwrap().len(), 26);
    }
}
