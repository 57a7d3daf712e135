//! Exponents over windows, towards zero force, and the factor between line and surface.

use super::correction::{Correction, Points};
use super::curve::{BandedNumber, Convention, MeanCurve};
use analysis::slope_weights;
use std::ops::Range;

/// Largest load on the finer grids, which do not solve the heavy loads.
pub const LARGEST: f64 = 2e-2;

/// Windows of one decade, each with its name: fixed, and the same for every curve.
pub const DECADES: [(&str, Range<f64>); 5] = [
    ("2e-2..2e-1", 2e-2..0.2),
    ("2e-3..2e-2", 2e-3..2e-2),
    ("2e-4..2e-3", 2e-4..2e-3),
    ("2e-5..2e-4", 2e-5..2e-4),
    ("2e-6..2e-5", 2e-6..2e-5),
];

/// An exponent over a window.
#[derive(Debug, Clone)]
pub struct LawRow {
    /// Name of the model.
    pub model: &'static str,
    /// How forces are normalised.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// Name of the window.
    pub window: &'static str,
    /// Whether the whole window is resolved.
    pub resolved: bool,
    /// The exponent.
    pub alpha: BandedNumber,
    /// Size of the level from which most of the scatter comes, and its share of the variance.
    pub widest: Option<(usize, f64)>,
}

/// Eq. 6.
pub fn eq6(d: f64) -> f64 {
    analytic::exponent_fit(d)
}

/// Eq. 24 with H = 3 - D_f.
pub fn eq24(d: f64) -> f64 {
    analytic::exponent_scaling(3.0 - d)
}

impl LawRow {
    /// Which law lies in the 95 % interval of this one row.
    pub fn inside(&self) -> &'static str {
        which(self.alpha.interval(0.05), self.fractal_dimension)
    }
}

/// Which law lies in an interval.
fn which([low, high]: [f64; 2], d: f64) -> &'static str {
    match [eq6(d), eq24(d)].map(|law| (low..=high).contains(&law)) {
        [true, true] => "both",
        [true, false] => "0.266 D_f",
        [false, true] => "1/(1 + H)",
        [false, false] => "neither",
    }
}

/// Exponents of all curves, decade by decade, as far as the curves go.
pub fn law_rows(curves: &[MeanCurve]) -> Vec<LawRow> {
    let mut rows = Vec::new();
    for curve in curves {
        for (window, forces) in DECADES {
            let Some(points) = curve.window(&forces) else { continue };
            let (resolved, widest) = (curve.resolves(&points), curve.widest_level(points.clone()));
            rows.extend(curve.slope(points).map(|alpha| LawRow {
                model: curve.model,
                convention: curve.convention,
                fractal_dimension: curve.fractal_dimension,
                window,
                resolved,
                alpha,
                widest,
            }));
        }
    }
    rows
}

/// k = zeta F^alpha (1 + c F^omega) fitted to a curve.
#[derive(Debug, Clone)]
pub struct FittedLimit {
    /// Name of the model.
    pub model: &'static str,
    /// How forces are normalised.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// The fixed omega or the shorter window of this fit, in words.
    pub variant: &'static str,
    /// The loads.
    pub forces: Range<f64>,
    /// Number of loads.
    pub points: usize,
    /// Whether all of them are resolved.
    pub resolved: bool,
    /// The law of the mean curve.
    pub law: Correction,
    /// 95 % interval of alpha, with the discretisation error.
    pub interval: [f64; 2],
    /// The same at the level of the family of hypotheses.
    pub family: [f64; 2],
    /// The discretisation error of alpha on the finest grid.
    pub grid: f64,
    /// 95 % interval of omega from the scatter.
    pub omega: [f64; 2],
    /// Goodness of fit: the share of curves that scatter about the fitted law as the surfaces do and have a
    /// larger misfit than the mean curve.
    pub goodness: f64,
}

/// A fit whose misfit is exceeded by a smaller share of curves about its law does not describe the curve.
const FITS: f64 = 0.05;

impl FittedLimit {
    /// Which law lies in the 95 % interval, or why the fit says nothing of either.
    pub fn conclusion(&self) -> &'static str {
        if !self.resolved {
            "none: not resolved"
        } else if self.variant != HELD && self.law.is_at_end() {
            "none: omega at an end of its range"
        } else if self.goodness < FITS {
            "none: the law does not fit"
        } else {
            which(self.interval, self.fractal_dimension)
        }
    }

    /// Whether it is one of the fits that were to be tested before the second run was drawn: of D_f = 2.4 to
    /// 3.0, in the paper's convention. All others are exploration.
    pub fn was_planned(&self) -> bool {
        self.convention == Convention::Measured && self.variant == FREE && self.fractal_dimension > 2.3
    }
}

/// The fit that is judged.
pub const FREE: &str = "free";
/// With fixed omega.
pub const HELD: &str = "omega 0.5";
/// With another upper end.
pub const SHORT: &str = "to 0.06";

/// Number of bootstrap samples of a fit that is judged (an end at the level of the family then rests on six
/// of them or more), and of a fit for comparison.
const DRAWS: [usize; 2] = [2000, 500];
/// Their seed.
const DRAW_SEED: u64 = 0x48;

/// Lower end of the fits of a curve, fixed before the second run (`data/exponent/hypotheses.md`).
fn first_force(model: &str, d: f64) -> f64 {
    let tenths = (10.0 * d).round() as u32;
    match (model, tenths) {
        ("bem3d", ..=20) => 2.0e-5,
        ("bem3d", 21..=22) => 6.3e-5,
        ("bem3d", 23..=24) => 4.3e-4,
        ("bem3d", 25..=26) => 2.0e-3,
        ("bem3d", 27..=28) => 4.3e-3,
        ("bem3d", _) => 6.3e-3,
        (_, ..=26) => 2.0e-7,
        _ => 1.4e-5,
    }
}

/// One way to fit the law to a curve.
struct LimitVariant {
    /// In words.
    name: &'static str,
    forces: Range<f64>,
    /// The fixed omega; `None` where it is fitted too.
    omega: Option<f64>,
    /// Number of bootstrap samples.
    draws: usize,
}

/// Fits of all curves: the one that is judged ([`judged_limit`]) and, for forces normalised by the measured
/// rms height, further fits for comparison.
pub fn limits(curves: &[MeanCurve], family: usize) -> Vec<FittedLimit> {
    let mut limits = Vec::new();
    let [_, draws] = DRAWS;
    for curve in curves {
        let start = first_force(curve.model, curve.fractal_dimension);
        if curve.convention == Convention::Measured {
            let held = LimitVariant { name: HELD, forces: start..0.2, omega: Some(0.5), draws };
            let short = LimitVariant { name: SHORT, forces: start..0.06, omega: None, draws };
            limits.extend(judged_limit(curve, family));
            limits.extend(limit(curve, &held, family));
            limits.extend(limit(curve, &short, family));
        } else {
            let free = LimitVariant { name: FREE, forces: start..0.2, omega: None, draws };
            limits.extend(limit(curve, &free, family));
        }
    }
    limits
}

/// The fit of a curve that is judged, with an interval for this number of tests in its family.
pub fn judged_limit(curve: &MeanCurve, family: usize) -> Option<FittedLimit> {
    let start = first_force(curve.model, curve.fractal_dimension);
    let free = LimitVariant { name: FREE, forces: start..0.2, omega: None, draws: DRAWS[0] };
    limit(curve, &free, family)
}

fn limit(curve: &MeanCurve, variant: &LimitVariant, family: usize) -> Option<FittedLimit> {
    let points = curve.window(&variant.forces)?;
    let levels = &curve.levels;
    let means = levels.means(levels.levels());
    let loads = WeightedLoads::new(curve, points.clone(), &means);
    let law = loads.fit(&means, variant.omega)?;
    // A free omega on coarse grids would tell of its scatter and not of the grid.
    let grid = curve.grid_part(points.clone(), |means| Some(loads.fit(means, Some(law.omega))?.alpha))?;
    let curves = levels.resampled(variant.draws, DRAW_SEED);
    let drawn: Vec<Correction> = curves.iter().filter_map(|means| loads.fit(means, variant.omega)).collect();
    if 2 * drawn.len() < variant.draws {
        return None;
    }
    let alphas = sorted(drawn.iter().map(|law| law.alpha));
    let omegas = sorted(drawn.iter().map(|law| law.omega));
    let with_grid = |[low, high]: [f64; 2]| [low - grid, high + grid];
    Some(FittedLimit {
        model: curve.model,
        convention: curve.convention,
        fractal_dimension: curve.fractal_dimension,
        variant: variant.name,
        forces: curve.forces[points.start]..curve.forces[points.end - 1],
        points: points.len(),
        resolved: curve.resolves(&points),
        law,
        interval: with_grid(middle_of(&alphas, 0.05)),
        family: with_grid(middle_of(&alphas, 0.05 / family as f64)),
        grid,
        omega: middle_of(&omegas, 0.05),
        goodness: loads.goodness(&law, variant.omega, &means, &curves),
    })
}

/// The loads of a fit.
struct WeightedLoads {
    points: Range<usize>,
    ln_forces: Vec<f64>,
    /// One over the variance of ln k at each load.
    weights: Vec<f64>,
}

impl WeightedLoads {
    fn new(curve: &MeanCurve, points: Range<usize>, means: &[f64]) -> Self {
        let weight = |j: usize| {
            let mut gradient = vec![0.0; means.len()];
            gradient[j] = 1.0 / means[j];
            1.0 / analysis::sum(curve.levels.variances(&gradient))
        };
        Self {
            ln_forces: curve.ln_forces(points.clone()),
            weights: points.clone().map(weight).collect(),
            points,
        }
    }

    /// ln k at the loads.
    fn logarithms(&self, means: &[f64]) -> Vec<f64> {
        means[self.points.clone()].iter().map(|k| k.ln()).collect()
    }

    /// The law of a curve, with this omega or a fitted one.
    fn fit(&self, means: &[f64], omega: Option<f64>) -> Option<Correction> {
        self.fit_logarithms(self.logarithms(means), omega)
    }

    fn fit_logarithms(&self, logarithms: Vec<f64>, omega: Option<f64>) -> Option<Correction> {
        Points::new(self.ln_forces.clone(), logarithms, self.weights.clone())?.fit(omega)
    }

    /// The share of drawn curves about the law of the mean curve that have a larger misfit than the mean curve.
    ///
    /// Loads of one surface go up and down together, so that the misfit of curves about the law is not that of
    /// independent points: it is found by moving the law by the deviations of the drawn curves.
    fn goodness(&self, law: &Correction, omega: Option<f64>, means: &[f64], drawn: &[Vec<f64>]) -> f64 {
        let of_law: Vec<f64> = self.ln_forces.iter().map(|&x| law.ln_stiffness(x)).collect();
        let found = self.logarithms(means);
        let misfit_about_law = |drawn: &Vec<f64>| {
            let drawn = self.logarithms(drawn);
            let moved = drawn.into_iter().zip(&found).zip(&of_law).map(|((drawn, k), of)| of + drawn - k);
            Some(self.fit_logarithms(moved.collect(), omega)?.misfit)
        };
        let misfits: Vec<f64> = drawn.iter().filter_map(misfit_about_law).collect();
        let larger = misfits.iter().filter(|misfit| **misfit >= law.misfit).count();
        larger as f64 / misfits.len().max(1) as f64
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The interval that leaves out a share `level` of sorted values, half of it at each end.
fn middle_of(sorted: &[f64], level: f64) -> [f64; 2] {
    let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
    [at(0.5 * level), at(1.0 - 0.5 * level)]
}

/// k_1D/k_3D at a load.
#[derive(Debug, Clone, Copy)]
pub struct Ratio {
    /// How forces are normalised.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// F_bar.
    pub force_bar: f64,
    /// ln(k_1D/k_3D).
    pub logarithm: BandedNumber,
}

/// k_1D/k_3D over a window that both models resolve.
#[derive(Debug, Clone)]
pub struct ModelRatio {
    /// How forces are normalised.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// Name of the window.
    pub window: &'static str,
    /// Whether both models resolve it.
    pub resolved: bool,
    /// Mean of ln(k_1D/k_3D) over the loads.
    pub logarithm: BandedNumber,
    /// Slope of that logarithm over that of the force.
    pub slope: BandedNumber,
}

/// exp of a logarithm, and half the width of its interval.
pub fn raised(logarithm: &BandedNumber) -> (f64, f64) {
    let value = logarithm.value().exp();
    (value, value * logarithm.half_width())
}

/// The ratio of line to surface at every load that both resolve, and over decades below [`LARGEST`].
pub fn ratios(curves: &[MeanCurve]) -> (Vec<Ratio>, Vec<ModelRatio>) {
    let (mut ratios, mut factors) = (Vec::new(), Vec::new());
    for solid in curves.iter().filter(|c| c.model == "bem3d") {
        let (convention, fractal_dimension) = (solid.convention, solid.fractal_dimension);
        let same = |c: &&MeanCurve| {
            c.model == "mdr1d"
                && c.convention == convention
                && (c.fractal_dimension - fractal_dimension).abs() < 1e-9
        };
        let Some(line) = curves.iter().find(same) else { continue };
        // Line and surface have seeds of their own: independent.
        let over = |[i, j]: [Range<usize>; 2], weights: &[f64]| {
            Some(line.logarithmic(j, weights)?.minus(&solid.logarithmic(i, weights)?))
        };
        for i in solid.resolved.clone() {
            let close = |j: &usize| (line.forces[*j] / solid.forces[i] - 1.0).abs() < 1e-9;
            let Some(j) = line.resolved.clone().find(close) else { continue };
            let force_bar = solid.forces[i];
            let ratio = over([i..i + 1, j..j + 1], &[1.0]);
            ratios.extend(ratio.map(|logarithm| Ratio {
                convention,
                fractal_dimension,
                force_bar,
                logarithm,
            }));
        }
        for (window, forces) in DECADES.into_iter().filter(|(_, forces)| forces.end <= LARGEST) {
            let (Some(i), Some(j)) = (solid.window(&forces), line.window(&forces)) else { continue };
            if i.len() != j.len() {
                continue;
            }
            let resolved = solid.resolves(&i) && line.resolves(&j);
            let both = [i.clone(), j];
            let mean = over(both.clone(), &vec![1.0 / i.len() as f64; i.len()]);
            let slope = slope_weights(&solid.ln_forces(i)).and_then(|weights| over(both, &weights));
            factors.extend(mean.zip(slope).map(|(logarithm, slope)| ModelRatio {
                convention,
                fractal_dimension,
                window,
                resolved,
                logarithm,
                slope,
            }));
        }
    }
    (ratios, factors)
}
