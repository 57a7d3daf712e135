//! Mean curves, local slopes and fits, each with its band.

use super::ladder::{GridPair, GridResults, Rungs};
use crate::evaluation::Discretisation;
use analysis::{Multilevel, Uncertain, slope_weights};
use contact_model::{Amplitude, SelfAffine};
use runs::{Error, Result};
use std::ops::Range;
use surface_gen::{LineGenerator, MapGenerator};

/// Points on each side of a local slope: at six loads a decade the line goes through two thirds of one.
pub const SLOPE_REACH: usize = 2;

/// Number of random draws for a simultaneous band, which gives its factor to 2 %.
const BAND_DRAWS: usize = 2000;
/// Their seed.
const BAND_SEED: u64 = 48;

/// The grid whose rms height normalises the forces of a fixed spectrum: that of the paper.
pub const REFERENCE_CELLS: usize = 2049;

/// The rms height by which F_bar is normalised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// The measured rms height of each grid, as in the paper: on a finer grid the long waves have smaller
    /// amplitudes.
    Measured,
    /// The rms height of one fixed spectrum on 2049 x 2049 cells: a finer grid has the same long waves and
    /// more short ones, and the line has the same spectrum.
    FixedSpectrum,
}

impl Convention {
    /// Both, in the order of tables.
    pub const BOTH: [Self; 2] = [Self::Measured, Self::FixedSpectrum];

    /// The word in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Measured => "measured_rms",
            Self::FixedSpectrum => "fixed_spectrum",
        }
    }
}

/// A number with the two parts of its 95 % half-width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandedNumber {
    /// From the scatter of the surfaces.
    pub scatter: Uncertain,
    /// The discretisation error of the finest grid.
    pub grid: f64,
}

impl BandedNumber {
    /// The number.
    pub fn value(&self) -> f64 {
        self.scatter.value
    }

    /// Both parts together.
    pub fn half_width(&self) -> f64 {
        self.scatter.half_width() + self.grid
    }

    /// The interval that is wrong with probability `level`, two-sided. The discretisation error does not
    /// depend on the level.
    pub fn interval(&self, level: f64) -> [f64; 2] {
        let half = self.scatter.half_width_at(level) + self.grid;
        [self.value() - half, self.value() + half]
    }

    /// p-value: the probability that chance moves the number as far from `expected`, beyond the
    /// discretisation error.
    pub fn chance_of(&self, expected: f64) -> f64 {
        self.scatter.chance_of(expected, self.grid)
    }

    /// The difference from a number of independent surfaces: the variances and the discretisation errors are
    /// added.
    pub fn minus(&self, other: &Self) -> Self {
        Self { scatter: self.scatter.minus(&other.scatter), grid: self.grid + other.grid }
    }
}

/// The mean curve of one model and fractal dimension in one convention.
#[derive(Debug, Clone)]
pub struct MeanCurve {
    /// `bem3d` or `mdr1d`.
    pub model: &'static str,
    /// How forces are normalised.
    pub convention: Convention,
    /// D_f.
    pub fractal_dimension: f64,
    /// F_bar.
    pub forces: Vec<f64>,
    /// Cells a side, or elements, of each level.
    pub sizes: Vec<usize>,
    /// Stiffnesses and their differences.
    pub levels: Multilevel,
    /// Pairs left out because a solve did not meet its tolerance.
    pub left_out: usize,
    /// Points, from the top of the loads down to where the discretisation error exceeds the stated one.
    pub resolved: Range<usize>,
    /// Factor on the scatter of each local slope with which all of them together are covered with 95 %.
    pub band: f64,
}

impl MeanCurve {
    /// The mean curve of all pairs of a fractal dimension; `error` is the largest allowed relative
    /// discretisation error of the finest grid.
    ///
    /// # Errors
    /// [`Error::Model`] for fewer than two complete pairs on a level.
    pub fn new(rungs: &Rungs, convention: Convention, error: f64) -> Result<Self> {
        let d = rungs.fractal_dimension;
        let what = |e| Error::model(format!("the mean curve of {} at D_f = {d:?}", rungs.model.name()))(e);
        let heights = match convention {
            Convention::Measured => vec![1.0; rungs.sizes.len()],
            Convention::FixedSpectrum => spectrum_heights(rungs).map_err(what)?,
        };
        // The lowest load that every grid has solved.
        let all = &rungs.forces;
        let highest = heights.iter().copied().fold(1.0, f64::max);
        let first = all.iter().position(|f| f / highest >= all[0]).unwrap_or(0);
        let asked = &all[first..];
        let mut left_out = 0;
        let (mut levels, mut reach) = (Vec::new(), asked.len());
        for (level, pairs) in rungs.levels.iter().enumerate() {
            let mut curves = Vec::new();
            for pair in pairs {
                match difference(pair, level, asked, &heights) {
                    Some(curve) => curves.push(curve),
                    None => left_out += 1,
                }
            }
            // A level ends where one of its surfaces does, and no later than the level before.
            reach = curves.iter().map(Vec::len).min().unwrap_or(0).min(reach);
            for curve in &mut curves {
                curve.truncate(reach);
            }
            levels.push(curves);
        }
        let levels = Multilevel::new(levels).map_err(what)?;
        let forces = &asked[..levels.points()];
        let mut curve = Self {
            model: rungs.model.name(),
            convention,
            fractal_dimension: d,
            forces: forces.to_vec(),
            sizes: rungs.sizes.clone(),
            levels,
            left_out,
            resolved: 0..forces.len(),
            band: 1.0,
        };
        let fine = |j: &usize| curve.stiffness(*j).is_some_and(|k| k.grid <= error * k.value());
        let resolved = (0..forces.len()).rev().take_while(fine).count();
        curve.resolved = forces.len() - resolved..forces.len();
        let slopes: Vec<Vec<f64>> = (curve.resolved.clone())
            .filter_map(|j| curve.local_points(j))
            .filter_map(|points| {
                Some(curve.gradient(points.clone(), &slope_weights(&curve.ln_forces(points))?))
            })
            .collect();
        curve.band = curve.levels.simultaneous(&slopes, BAND_DRAWS, BAND_SEED);
        Ok(curve)
    }

    /// Cells a side, or elements, of the finest grid at a point.
    pub fn finest(&self, point: usize) -> usize {
        self.sizes[self.levels.levels_at(point) - 1]
    }

    /// Mean k_bar at a point; `None` for fewer than three grids.
    pub fn stiffness(&self, point: usize) -> Option<BandedNumber> {
        let mut gradient = vec![0.0; self.forces.len()];
        gradient[point] = 1.0;
        self.banded(point..point + 1, &gradient, |means| Some(means[point]))
    }

    /// Slope of ln k_bar over ln F_bar by least squares through the points.
    pub fn slope(&self, points: Range<usize>) -> Option<BandedNumber> {
        self.logarithmic(points.clone(), &slope_weights(&self.ln_forces(points))?)
    }

    /// ln F_bar of points.
    pub fn ln_forces(&self, points: Range<usize>) -> Vec<f64> {
        self.forces[points].iter().map(|f| f.ln()).collect()
    }

    /// Local slope: through [`SLOPE_REACH`] points on each side, where all of them are resolved.
    pub fn local_slope(&self, point: usize) -> Option<BandedNumber> {
        self.local_points(point).and_then(|points| self.slope(points))
    }

    /// The points of a local slope, where all of them are resolved.
    fn local_points(&self, point: usize) -> Option<Range<usize>> {
        let points = point.checked_sub(SLOPE_REACH)?..point + SLOPE_REACH + 1;
        (points.start >= self.resolved.start && points.end <= self.resolved.end).then_some(points)
    }

    /// The largest share of the variance of the slope through the points that comes from one level, and the
    /// size of its finer grid.
    pub fn widest_level(&self, points: Range<usize>) -> Option<(usize, f64)> {
        let gradient = self.gradient(points.clone(), &slope_weights(&self.ln_forces(points))?);
        let variances = self.levels.variances(&gradient);
        let whole = analysis::sum(variances.iter().copied());
        let (level, most) = variances.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        (whole > 0.0).then(|| (self.sizes[level], most / whole))
    }

    /// Derivatives of `sum w ln k_bar` over the points.
    fn gradient(&self, points: Range<usize>, weights: &[f64]) -> Vec<f64> {
        let means = self.levels.means(self.levels.levels());
        let mut gradient = vec![0.0; self.forces.len()];
        for (j, weight) in points.zip(weights) {
            gradient[j] = weight / means[j];
        }
        gradient
    }

    /// `sum w ln k_bar` over the points.
    pub fn logarithmic(&self, points: Range<usize>, weights: &[f64]) -> Option<BandedNumber> {
        let gradient = self.gradient(points.clone(), weights);
        let start = points.start;
        self.banded(points, &gradient, |means| {
            let terms = weights.iter().enumerate().map(|(i, w)| w * means[start + i].ln());
            Some(analysis::sum(terms)).filter(|sum| sum.is_finite())
        })
    }

    fn banded(
        &self,
        points: Range<usize>,
        gradient: &[f64],
        quantity: impl Fn(&[f64]) -> Option<f64>,
    ) -> Option<BandedNumber> {
        let value = quantity(&self.levels.means(self.levels.levels()))?;
        let grid = self.grid_part(points, &quantity)?;
        Some(BandedNumber { scatter: self.levels.propagated(value, gradient), grid })
    }

    /// The discretisation error of the finest grid in a number of the mean curve at these points.
    pub fn grid_part(&self, points: Range<usize>, quantity: impl Fn(&[f64]) -> Option<f64>) -> Option<f64> {
        // Points on unlike grids: the larger of what they leave.
        let mut grids: Vec<usize> = points.map(|j| self.levels.levels_at(j)).collect();
        grids.dedup();
        let mut grid = 0.0_f64;
        for levels in grids {
            grid = grid.max(self.levels.bias(levels, &quantity)?);
        }
        Some(grid)
    }

    /// The points with loads in a range, its ends rounded to the loads; `None` where a load nearest to an end
    /// is farther from it than half a step of the loads, or there are fewer than `2 SLOPE_REACH + 1`.
    pub fn window(&self, forces: &Range<f64>) -> Option<Range<usize>> {
        let nearest = |end: f64| {
            let away = |j: &usize| (self.forces[*j] / end).ln().abs();
            let at = (0..self.forces.len()).min_by(|a, b| away(a).total_cmp(&away(b)))?;
            let step =
                (self.forces.last()? / self.forces[0]).ln() / (self.forces.len() as f64 - 1.0).max(1.0);
            (away(&at) <= 0.5 * step).then_some(at)
        };
        let points = nearest(forces.start)?..nearest(forces.end)? + 1;
        (points.len() > 2 * SLOPE_REACH).then_some(points)
    }

    /// Whether all of these points are resolved.
    pub fn resolves(&self, points: &Range<usize>) -> bool {
        self.resolved.start <= points.start && points.end <= self.resolved.end
    }
}

/// Rms heights of one spectrum on the grids of the levels, over that of the reference grid.
fn spectrum_heights(rungs: &Rungs) -> contact_model::Result<Vec<f64>> {
    let surface = SelfAffine {
        amplitude: Amplitude::Spectrum(1.0),
        ..SelfAffine::new(rungs.fractal_dimension, 1.0, 1.0)?
    };
    let reference = MapGenerator::new(&surface, REFERENCE_CELLS)?.rms_height();
    let height = |&size: &usize| {
        Ok(match rungs.model {
            Discretisation::Bem3d { .. } => MapGenerator::new(&surface, size)?.rms_height(),
            Discretisation::Mdr1d { .. } => LineGenerator::new(&surface, size)?.rms_height(),
        } / reference)
    };
    rungs.sizes.iter().map(height).collect()
}

/// k_bar of a pair at the forces, or its difference; as far as the loads go. `None` where a solve did not
/// meet its tolerance.
fn difference(pair: &GridPair, level: usize, forces: &[f64], heights: &[f64]) -> Option<Vec<f64>> {
    let fine = stiffnesses(&pair.fine, forces, heights[level])?;
    let Some(coarse) = &pair.coarse else { return Some(fine) };
    let coarse = stiffnesses(coarse, forces, heights[level - 1])?;
    Some(fine.iter().zip(&coarse).map(|(fine, coarse)| fine - coarse).collect())
}

/// k_bar at forces that are normalised by another rms height, which is `height` times the surface's own; up
/// to the last load that was solved.
fn stiffnesses(solved: &GridResults, forces: &[f64], height: f64) -> Option<Vec<f64>> {
    let points: Option<Vec<(f64, f64)>> =
        solved.forces.iter().zip(&solved.stiffnesses).map(|(f, k)| Some((f.ln(), (*k)?.ln()))).collect();
    let points = points?;
    // ln 1 is 0: with its own height a load is found bit for bit.
    let asked = forces.iter().map(|f| f.ln() - height.ln());
    Some(asked.map_while(|x| cubic(&points, x)).map(f64::exp).collect())
}

/// Cubic interpolation between points (x, y), x increasing; `None` outside.
fn cubic(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let upper = points.iter().position(|p| p.0 >= x - 1e-12 * x.abs())?;
    if (points[upper].0 - x).abs() <= 1e-12 * x.abs() {
        return Some(points[upper].1);
    }
    let lower = upper.checked_sub(1)?;
    let first = lower.saturating_sub(1).min(points.len().saturating_sub(4));
    let near = &points[first..points.len().min(first + 4)];
    let term = |(i, &(xi, yi)): (usize, &(f64, f64))| {
        let others = near.iter().enumerate().filter(|(j, _)| *j != i);
        yi * others.map(|(_, &(xj, _))| (x - xj) / (xi - xj)).product::<f64>()
    };
    Some(near.iter().enumerate().map(term).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_exact_and_end_where_the_points_end() {
        let y = |x: f64| 1.0 + x - 0.5 * x * x + 0.25 * x * x * x;
        let points: Vec<(f64, f64)> = (0..6).map(|i| (f64::from(i), y(f64::from(i)))).collect();
        for x in [0.0, 0.3, 2.5, 4.9, 5.0] {
            assert!((cubic(&points, x).unwrap() - y(x)).abs() < 1e-12, "{x}");
        }
        assert_eq!(cubic(&points, 5.1), None);
        assert_eq!(cubic(&points, -0.1), None);
    }
}
