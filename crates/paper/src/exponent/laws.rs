//! Which law holds where, and the factor between line and surface.

use super::curve::{Banded, Convention, MeanCurve};
use crate::claim::Estimate;
use analysis::slope_weights;
use std::ops::Range;

/// Largest load of the windows at small force: below, edges change the stiffness of a free surface by under 4
/// %, and every grid has it.
pub const LARGEST: f64 = 2e-2;

/// An exponent over a window.
#[derive(Debug, Clone)]
pub struct LawRow {
    /// Name of the model.
    pub model: &'static str,
    /// How forces are counted.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// Name of the window.
    pub window: &'static str,
    /// Its loads.
    pub forces: Range<f64>,
    /// The exponent.
    pub alpha: Banded,
    /// Size of the level from which most of the scatter comes, and its share of the variance.
    pub widest: Option<(usize, f64)>,
}

impl LawRow {
    /// Whether it was fitted to this curve.
    pub fn is_of(&self, curve: &MeanCurve) -> bool {
        self.model == curve.model
            && self.convention == curve.convention
            && (self.fractal_dimension - curve.fractal_dimension).abs() < 1e-9
    }

    /// Eq. 6.
    pub fn eq6(&self) -> f64 {
        analytic::exponent_fit(self.fractal_dimension)
    }

    /// Eq. 24 with H = 3 - D_f.
    pub fn power_law(&self) -> f64 {
        analytic::exponent_scaling(3.0 - self.fractal_dimension)
    }

    /// Which law lies in the interval.
    pub fn verdict(&self) -> &'static str {
        let inside = |law: f64| (law - self.alpha.value()).abs() <= self.alpha.half_width();
        match (inside(self.eq6()), inside(self.power_law())) {
            (true, true) => "both",
            (true, false) => "0.266 D_f",
            (false, true) => "1/(1 + H)",
            (false, false) => "neither",
        }
    }
}

/// Names of windows and the loads they ask for.
const DECADES: [(&str, Range<f64>); 5] = [
    ("2e-2..2e-1", 2e-2..0.2),
    ("2e-3..2e-2", 2e-3..2e-2),
    ("2e-4..2e-3", 2e-4..2e-3),
    ("2e-5..2e-4", 2e-5..2e-4),
    ("2e-6..2e-5", 2e-6..2e-5),
];

/// Exponents of all curves over the window that all of one model and convention resolve, over each one's own,
/// and decade by decade.
pub fn law_rows(curves: &[MeanCurve]) -> Vec<LawRow> {
    let mut rows = Vec::new();
    for curve in curves {
        let alike = |other: &&MeanCurve| other.model == curve.model && other.convention == curve.convention;
        let lowest =
            |curve: &MeanCurve| curve.forces.get(curve.resolved.start).copied().unwrap_or(f64::INFINITY);
        let common = curves.iter().filter(alike).map(lowest).fold(0.0, f64::max);
        let own = lowest(curve);
        let windows = [("common", common..LARGEST), ("own", own..LARGEST)].into_iter().chain(DECADES);
        for (window, asked) in windows {
            // A little slack for the rounding of the logarithmic range; a decade counts where all of it is
            // resolved.
            let asked = asked.start * (1.0 - 1e-9)..asked.end * (1.0 + 1e-9);
            let Some(points) = curve.points_within(&asked).filter(|_| own <= asked.start * (1.0 + 1e-8))
            else {
                continue;
            };
            let forces = curve.forces[points.start]..curve.forces[points.end - 1];
            if let Some(alpha) = curve.slope(points.clone()) {
                let (model, convention, fractal_dimension) =
                    (curve.model, curve.convention, curve.fractal_dimension);
                let widest = curve.widest_level(points);
                rows.push(LawRow { model, convention, fractal_dimension, window, forces, alpha, widest });
            }
        }
    }
    rows
}

/// k_1D/k_3D at a load.
#[derive(Debug, Clone, Copy)]
pub struct Ratio {
    /// How forces are counted.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// F_bar.
    pub force_bar: f64,
    /// k_1D/k_3D.
    pub value: Estimate,
}

/// k_1D/k_3D over the loads that both resolve.
#[derive(Debug, Clone)]
pub struct Factor {
    /// How forces are counted.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// The loads.
    pub forces: Range<f64>,
    /// exp of the mean logarithm of the ratio.
    pub value: Estimate,
    /// Slope of the logarithm of the ratio over that of the force.
    pub slope: Estimate,
}

impl Factor {
    /// Whether the interval of the slope holds 0.
    pub fn verdict(&self) -> &'static str {
        if self.slope.value.abs() <= self.slope.half_width { "yes" } else { "no" }
    }
}

/// Line over surface at every load that both resolve, and over those up to [`LARGEST`] together.
pub fn ratios(curves: &[MeanCurve]) -> (Vec<Ratio>, Vec<Factor>) {
    let (mut ratios, mut factors) = (Vec::new(), Vec::new());
    for solid in curves.iter().filter(|c| c.model == "bem3d") {
        let (convention, fractal_dimension) = (solid.convention, solid.fractal_dimension);
        let same = |c: &&MeanCurve| {
            c.model == "mdr1d"
                && c.convention == convention
                && (c.fractal_dimension - fractal_dimension).abs() < 1e-9
        };
        let Some(line) = curves.iter().find(same) else { continue };
        // Where both have a load and resolve it.
        let both: Vec<(usize, usize)> = (solid.resolved.clone())
            .filter_map(|i| {
                let close = |j: &usize| (line.forces[*j] / solid.forces[i] - 1.0).abs() < 1e-9;
                Some((i, line.resolved.clone().find(close)?))
            })
            .collect();
        // The scatter of line and surface is independent: squares add; what grids leave adds up.
        let combined = |i: Range<usize>, j: Range<usize>, weights: &[f64]| {
            let (a, b) = (line.logarithmic(j, weights)?, solid.logarithmic(i, weights)?);
            let half_width = a.scatter.half_width().hypot(b.scatter.half_width()) + a.grid + b.grid;
            Some(Estimate { value: a.value() - b.value(), half_width })
        };
        // exp of a logarithm.
        let raised = |ln: Estimate| {
            let value = ln.value.exp();
            Estimate { value, half_width: value * ln.half_width }
        };
        for &(i, j) in &both {
            let ratio = combined(i..i + 1, j..j + 1, &[1.0]).map(raised);
            let force_bar = solid.forces[i];
            ratios.extend(ratio.map(|value| Ratio { convention, fractal_dimension, force_bar, value }));
        }
        let small: Vec<(usize, usize)> =
            both.into_iter().filter(|&(i, _)| solid.forces[i] <= LARGEST * (1.0 + 1e-9)).collect();
        let (Some(&(i0, j0)), Some(&(i1, j1))) = (small.first(), small.last()) else { continue };
        let (i, j) = (i0..i1 + 1, j0..j1 + 1);
        // The loads of both are the same range: no holes.
        if i.len() != small.len() || j.len() != small.len() {
            continue;
        }
        let ln_f: Vec<f64> = solid.forces[i.clone()].iter().map(|f| f.ln()).collect();
        let mean = combined(i.clone(), j.clone(), &vec![1.0 / small.len() as f64; small.len()]);
        let slope = slope_weights(&ln_f).and_then(|weights| combined(i, j, &weights));
        let forces = solid.forces[i0]..solid.forces[i1];
        factors.extend(mean.map(raised).zip(slope).map(|(value, slope)| Factor {
            convention,
            fractal_dimension,
            forces,
            value,
            slope,
        }));
    }
    (ratios, factors)
}
