//! The parameters of the study of partial slip, and the results of a surface.

use crate::evaluation::limits::{self, require, within};
use crate::evaluation::{Forces, SEED, list};
use contact_model::{Body, Boundary, Effects, Friction, Outputs, Pair, Scene, SelfAffine, Surface};
use runs::{Error, Result};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Coefficient of friction. Where normal and tangential contact are independent, it only scales tractions and
/// displacements.
pub(super) const COEFFICIENT: f64 = 0.3;
/// Waves a side at which the spectrum of periodic surfaces rolls off.
pub(super) const ROLL_OFF: f64 = 4.0;
/// Q/(mu F) at the ends of the increments of a first loading.
pub(super) const SHARES: [f64; 10] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95];
/// Largest Q/(mu F) of loops.
pub(super) const AMPLITUDES: [f64; 3] = [0.3, 0.6, 0.9];

/// The parameters of the study of partial slip.
///
/// Both bodies have the same constants, so that Dundurs' second constant is 0 and normal and tangential
/// contact are independent. Their modulus is such that E* is the same for every Poisson's ratio: pressures
/// are too.
#[derive(Debug, Clone, PartialEq)]
pub struct PartialSlipStudy {
    /// Cells a side.
    pub cells: usize,
    /// Cells of the shortest wave.
    pub cells_per_wave: usize,
    /// Cells a side of the grids on which the same surfaces are solved, each twice the one before, for the
    /// limit of small cells; empty for the study on `cells` alone. The shortest wave is that of `cells` and
    /// `cells_per_wave` on all of them.
    pub grids: Vec<usize>,
    /// Surfaces of each boundary and fractal dimension.
    pub surfaces: usize,
    /// D_f.
    pub fractal_dimensions: Vec<f64>,
    /// Poisson's ratios of both bodies, increasing from 0, where Ciavarella and Jaeger's solution is exact.
    pub poissons: Vec<f64>,
    /// Loads F_bar.
    pub forces: Forces,
    /// Increments from no tangential force to the amplitude of a loop, and half of those back.
    pub increments: usize,
    /// Bound of every certificate.
    pub tolerance: f64,
    /// Master seed.
    pub seed: u64,
    /// Surfaces solved at the same time, at least 1.
    pub threads: usize,
    /// Directory of the results.
    pub out: PathBuf,
    /// Ignore stored results.
    pub fresh: bool,
}

/// Sizes of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PartialSlipSizes {
    /// Seconds, for tests.
    Quick,
    /// 128 cells, 10 surfaces, two fractal dimensions, five Poisson's ratios, three loads.
    #[default]
    Default,
}

/// A boundary and a fractal dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SlipCase {
    pub(super) boundary: Boundary,
    pub(super) fractal_dimension: f64,
}

impl SlipCase {
    pub(super) fn is_free(self) -> bool {
        self.boundary == Boundary::Free
    }

    pub(super) fn boundary_name(self) -> &'static str {
        if self.is_free() { "free" } else { "periodic" }
    }

    pub(super) fn label(self) -> String {
        format!("{}, D_f = {:?}", self.boundary_name(), self.fractal_dimension)
    }

    /// The contact of bodies of this Poisson's ratio, with E* = 1, L = 1 and h = 1.
    pub(super) fn scene(self, study: &PartialSlipStudy, poisson: f64, outputs: Outputs) -> Result<Scene> {
        let failed = || Error::model(self.label());
        let surface = SelfAffine {
            roll_off: (!self.is_free()).then_some(TAU * ROLL_OFF),
            short_cutoff: Some(TAU * study.shortest()),
            ..SelfAffine::new(self.fractal_dimension, 1.0, 1.0).map_err(failed())?
        };
        let body = Body::Elastic { young: 2.0 * (1.0 - poisson * poisson), poisson };
        let pair = Pair { first: body, second: body };
        let mut scene = Scene::of_pair(Surface::SelfAffine(surface), pair).map_err(failed())?;
        scene.effects = Effects {
            boundary: self.boundary,
            friction: Friction::coulomb(COEFFICIENT),
            ..Effects::default()
        };
        scene.outputs = outputs;
        scene.validate().map_err(failed())?;
        Ok(scene)
    }
}

/// Mindlin's ratio of tangential to normal stiffness of a round contact of bodies that are alike, which is
/// G*/E*.
pub(super) fn mindlin(poisson: f64) -> f64 {
    (2.0 - 2.0 * poisson) / (2.0 - poisson)
}

impl PartialSlipStudy {
    /// The study at these sizes.
    ///
    /// # Errors
    /// None for the existing sizes; [`Error::Parameter`] for an invalid list of loads.
    pub fn new(sizes: PartialSlipSizes) -> Result<Self> {
        let quick = sizes == PartialSlipSizes::Quick;
        let (cells, surfaces, forces) = if quick { (32, 3, "0.2") } else { (128, 10, "0.05,0.2,1") };
        Ok(Self {
            cells,
            cells_per_wave: 4,
            grids: Vec::new(),
            surfaces,
            fractal_dimensions: if quick { vec![2.2] } else { vec![2.2, 2.8] },
            poissons: if quick { vec![0.0, 0.3, 0.5] } else { vec![0.0, 0.15, 0.3, 0.45, 0.5] },
            forces: Forces::parse(forces)?,
            increments: 2,
            tolerance: 1e-5,
            seed: SEED,
            threads: 1,
            out: "out".into(),
            fresh: false,
        })
    }

    /// Waves a side at the end of the spectrum.
    pub(super) fn shortest(&self) -> f64 {
        self.cells as f64 / self.cells_per_wave as f64
    }

    pub(super) fn cases(&self) -> Vec<SlipCase> {
        let of = |boundary| {
            self.fractal_dimensions
                .iter()
                .map(move |&fractal_dimension| SlipCase { boundary, fractal_dimension })
        };
        [Boundary::Free, Boundary::Periodic].into_iter().flat_map(of).collect()
    }

    fn listed_grids(&self) -> String {
        self.grids.iter().map(usize::to_string).collect::<Vec<_>>().join(",")
    }

    pub(super) fn command(&self) -> String {
        let grids = match self.grids.as_slice() {
            [] => String::new(),
            _ => format!(" --grids {}", self.listed_grids()),
        };
        format!(
            "cargo xtask partial-slip --cells {} --cells-per-wave {}{grids} --surfaces {} --df {} --poisson {} --forces {} --increments {} --tolerance {:?} --seed {}",
            self.cells,
            self.cells_per_wave,
            self.surfaces,
            list(&self.fractal_dimensions),
            list(&self.poissons),
            self.forces.spec(),
            self.increments,
            self.tolerance,
            self.seed
        )
    }

    pub(super) fn check(&self) -> Result<()> {
        within("threads", self.threads, &(1..=runs::MOST_THREADS))?;
        within("surfaces", self.surfaces, &(2..=*limits::COUNT.end()))?;
        within("cells", self.cells, &limits::CELLS)?;
        within("increments", self.increments, &(1..=1000))?;
        limits::jobs("surfaces", self.surfaces, self.fractal_dimensions.len().saturating_mul(2))?;
        limits::tolerance(self.tolerance)?;
        require(!self.fractal_dimensions.is_empty(), "df", "nothing", "at least one number")?;
        let dimension = |d: &f64| require((2.0..=3.0).contains(d), "df", d, "numbers in [2, 3]");
        self.fractal_dimensions.iter().try_for_each(dimension)?;
        let increasing = self.poissons.first().is_some_and(|nu| nu.abs() <= 0.0)
            && self.poissons.is_sorted_by(|a, b| a < b)
            && self.poissons.iter().all(|nu| *nu <= 0.5);
        require(increasing, "poisson", list(&self.poissons), "increasing numbers from 0 to at most 0.5")?;
        require(self.poissons.len() <= 100, "poisson", self.poissons.len(), "at most 100 numbers")?;
        let (per_wave, most) = (self.cells_per_wave, self.cells / 8);
        let expected = format!("a whole number from 2 to {most}: an eighth of the cells a side");
        require((2..=most).contains(&per_wave), "cells-per-wave", per_wave, expected)?;
        let doubled = self.grids.first().is_none_or(|first| *first >= self.cells)
            && self.grids.windows(2).all(|pair| pair[1] == 2 * pair[0])
            && self.grids.iter().all(|cells| limits::CELLS.contains(cells))
            && [0, 3, 4, 5].contains(&self.grids.len());
        let expected = "three to five numbers from `cells` on, each twice the one before";
        require(doubled, "grids", self.listed_grids(), expected)
    }
}

/// One surface under one load with one Poisson's ratio.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SlippedSurface {
    /// Share of the square in contact.
    pub(super) contact: f64,
    pub(super) contact_cells: usize,
    /// Tangential stiffness of the whole contact in full stick, over the normal stiffness: xx, yy, xy.
    pub(super) stiffness: [f64; 3],
    /// At the [`SHARES`] of a first loading, mean of a force along x and one along y; empty with periodic
    /// boundaries.
    pub(super) points: Vec<SlipPoint>,
    /// Energy that a loop of each of the [`AMPLITUDES`] dissipates, over mu F and the unit of
    /// [`SlipPoint::displacement`].
    pub(super) dissipated: Vec<f64>,
}

/// A state of a first loading. Displacements are in units of mu (E*/G*) d(F), the displacement at which the
/// contact slides as a whole according to Ciavarella and Jaeger.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct SlipPoint {
    pub(super) displacement: f64,
    /// Share of the contact that sticks; for the equivalent profile (c/a)^2.
    pub(super) stick: f64,
    /// dQ/ddelta over that without tangential force; none of the equivalent profile.
    pub(super) stiffness: Option<f64>,
    /// Root mean square, over the cells in contact, of the difference of the traction from that of the
    /// bodies without Poisson's ratio, over mu times the mean pressure; none of the equivalent profile.
    pub(super) traction: Option<f64>,
}

impl SlipPoint {
    /// The mean of both.
    pub(super) fn mean(self, other: Self) -> Self {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        let both = |a: Option<f64>, b: Option<f64>| Some(mean(a?, b?));
        Self {
            displacement: mean(self.displacement, other.displacement),
            stick: mean(self.stick, other.stick),
            stiffness: both(self.stiffness, other.stiffness),
            traction: both(self.traction, other.traction),
        }
    }
}

/// The results of a surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SurfaceSlips {
    /// By force, then by Poisson's ratio; `None` where the tolerance was not met.
    pub(super) solved: Vec<Option<SlippedSurface>>,
    /// The equivalent profile by force, free boundaries alone: points and dissipated energies.
    pub(super) equivalent: Vec<Option<(Vec<SlipPoint>, Vec<f64>)>>,
}

impl SurfaceSlips {
    /// The results for a force and a Poisson's ratio, by their indices.
    pub(super) fn at(
        &self,
        study: &PartialSlipStudy,
        force: usize,
        poisson: usize,
    ) -> Option<&SlippedSurface> {
        self.solved.get(force * study.poissons.len() + poisson)?.as_ref()
    }
}
