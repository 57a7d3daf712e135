//! Means on the finest of several grids, from differences between neighbouring ones.

use crate::ensemble::mean_and_deviation;
use crate::grid_error;
use contact_model::{Error, Result};
use numerics::quantile::{student, student_at, student_beyond};
use numerics::sum::sum;
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Multilevel Monte Carlo: curves on the coarsest grid, and differences between each finer grid and the next
/// coarser one on the same surfaces.
///
/// The mean on the finest grid is the sum of the mean on the coarsest one and of the mean differences. The
/// differences scatter less than the curves, so that few surfaces on the expensive grids are enough. Surfaces
/// of different levels are independent. A level may have fewer points than the coarser ones: beyond its last
/// point the next coarser grid is the finest.
///
/// Source: M. B. Giles, Oper. Res. 56, 607 (2008).
#[derive(Debug, Clone, PartialEq)]
pub struct Multilevel {
    /// Level, surface, point; from the coarsest grid to the finest.
    levels: Vec<Vec<Vec<f64>>>,
}

/// A number that is known from few surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Degrees of freedom of that error (Welch and Satterthwaite).
    pub degrees_of_freedom: f64,
}

impl Uncertain {
    /// Half-width of the 95 % interval by Student's distribution.
    pub fn half_width(&self) -> f64 {
        self.standard_error * student(self.degrees_of_freedom)
    }

    /// Half-width of the two-sided interval that misses the true value with probability `level`.
    pub fn half_width_at(&self, level: f64) -> f64 {
        self.standard_error * student_at(1.0 - 0.5 * level, self.degrees_of_freedom)
    }

    /// The difference from an independent number: variances add up, degrees of freedom by Welch and
    /// Satterthwaite.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let [a, b] = [self, other].map(|u| u.standard_error * u.standard_error);
        let spread = a * a / self.degrees_of_freedom + b * b / other.degrees_of_freedom;
        let degrees_of_freedom = if spread > 0.0 { (a + b) * (a + b) / spread } else { f64::MAX };
        Self { value: self.value - other.value, standard_error: (a + b).sqrt(), degrees_of_freedom }
    }

    /// p-value of the difference from `expected`, after the difference is reduced by `beside`, an error of
    /// another kind.
    pub fn chance_of(&self, expected: f64, beside: f64) -> f64 {
        let away = ((self.value - expected).abs() - beside).max(0.0);
        student_beyond(away / self.standard_error, self.degrees_of_freedom)
    }
}

impl Multilevel {
    /// Takes the curves of the surfaces of each level: values on the coarsest level, differences on the
    /// others.
    ///
    /// # Errors
    /// [`Error::Shape`] for no level, a level of fewer than two surfaces, surfaces of one level with unlike
    /// numbers of points, or a level that has more points than the one before; [`Error::Domain`] for a number
    /// that is not finite.
    pub fn new(levels: Vec<Vec<Vec<f64>>>) -> Result<Self> {
        let shape = |name: String, found: usize, expected: String| Error::Shape {
            name: name.into(),
            found,
            expected: expected.into(),
        };
        let mut points = levels.first().and_then(|level| level.first()).map_or(0, Vec::len);
        if points == 0 {
            return Err(shape("levels".into(), levels.len(), "at least one, with points".into()));
        }
        for (l, level) in levels.iter().enumerate() {
            if level.len() < 2 {
                let found = level.len();
                return Err(shape(format!("surfaces of level {l}"), found, "at least 2".into()));
            }
            let own = level[0].len();
            if own == 0 || own > points {
                return Err(shape(format!("points of level {l}"), own, format!("1 to {points}")));
            }
            for surface in level {
                if surface.len() != own {
                    return Err(shape(format!("points of level {l}"), surface.len(), own.to_string()));
                }
                if let Some(&value) = surface.iter().find(|value| !value.is_finite()) {
                    return Err(Error::domain("value", value, "a finite number"));
                }
            }
            points = own;
        }
        Ok(Self { levels })
    }

    /// Number of levels.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Points of the coarsest level, which has all.
    pub fn points(&self) -> usize {
        self.levels[0][0].len()
    }

    /// Levels that reach the point.
    pub fn levels_at(&self, point: usize) -> usize {
        self.levels.iter().take_while(|level| level[0].len() > point).count()
    }

    /// Mean curve, all points, of the first `levels` levels.
    pub fn means(&self, levels: usize) -> Vec<f64> {
        (0..self.points())
            .map(|j| sum(self.levels.iter().take(levels).filter_map(|level| mean_at(level, j))))
            .collect()
    }

    /// Mean of a level and its standard deviation over the surfaces; `None` beyond its end.
    pub fn at(&self, level: usize, point: usize) -> Option<(f64, f64)> {
        let values: Option<Vec<f64>> = self.levels[level].iter().map(|s| s.get(point).copied()).collect();
        mean_and_deviation(&values?).and_then(|(mean, deviation)| Some((mean, deviation?)))
    }

    /// Surfaces of a level.
    pub fn surfaces(&self, level: usize) -> usize {
        self.levels[level].len()
    }

    /// A number that depends on the mean curve of the finest grid: its value there, and its error from the
    /// scatter of the surfaces by its derivatives (`gradient`, one for each point).
    ///
    /// # Panics
    /// Where there are fewer derivatives than points.
    pub fn propagated(&self, value: f64, gradient: &[f64]) -> Uncertain {
        let variances = self.variances(gradient);
        let variance = sum(variances.iter().copied());
        let spread =
            sum(variances.iter().zip(&self.levels).map(|(v, level)| v * v / (level.len() as f64 - 1.0)));
        let degrees_of_freedom = if spread > 0.0 { variance * variance / spread } else { f64::MAX };
        Uncertain { value, standard_error: variance.sqrt(), degrees_of_freedom }
    }

    /// Contribution of each level to the variance of a number that depends on the mean curve of the finest
    /// grid with the derivatives `gradient`.
    ///
    /// # Panics
    /// Where there are fewer derivatives than points.
    pub fn variances(&self, gradient: &[f64]) -> Vec<f64> {
        (self.levels.iter())
            .map(|level| {
                let each: Vec<f64> =
                    level.iter().map(|s| sum(s.iter().zip(gradient).map(|(v, g)| v * g))).collect();
                let deviation = mean_and_deviation(&each).and_then(|(_, deviation)| deviation).unwrap_or(0.0);
                deviation * deviation / each.len() as f64
            })
            .collect()
    }

    /// Factor on the pointwise 95 % half-widths of several numbers, given by their derivatives, so that all of
    /// them together are covered with 95 %: at least 1.
    ///
    /// The 95 % quantile of the largest of the numbers' deviations in standard errors, over the normal
    /// quantile. The deviations are drawn by changing the sign of each surface's deviation at random (wild
    /// bootstrap, Rademacher's weights), so that numbers that share surfaces keep their covariance; `draws` of
    /// them, by xoshiro256++ of this seed. Numbers that do not scatter are left out.
    ///
    /// # Panics
    /// Where there are fewer derivatives than points.
    pub fn simultaneous(&self, gradients: &[Vec<f64>], draws: usize, seed: u64) -> f64 {
        let errors: Vec<f64> = gradients.iter().map(|g| sum(self.variances(g)).sqrt()).collect();
        // Surface by surface, its part of each number in standard errors.
        let mut parts: Vec<Vec<f64>> = Vec::new();
        for level in &self.levels {
            let n = level.len() as f64;
            let each: Vec<Vec<f64>> = (gradients.iter())
                .map(|g| level.iter().map(|s| sum(s.iter().zip(g).map(|(v, g)| v * g))).collect())
                .collect();
            let means: Vec<f64> = each.iter().map(|values| sum(values.iter().copied()) / n).collect();
            let scale = 1.0 / (n * (n - 1.0)).sqrt();
            parts.extend((0..level.len()).map(|i| {
                let part = |j: usize| (each[j][i] - means[j]) * scale / errors[j];
                (0..gradients.len()).map(|j| if errors[j] > 0.0 { part(j) } else { 0.0 }).collect()
            }));
        }
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut largest: Vec<f64> = (0..draws)
            .map(|_| {
                let mut moved = vec![0.0; gradients.len()];
                for (chunk, bits) in parts.chunks(64).map(|chunk| (chunk, random.next_u64())) {
                    for (b, part) in chunk.iter().enumerate() {
                        let sign = if bits >> b & 1 == 1 { 1.0 } else { -1.0 };
                        moved.iter_mut().zip(part).for_each(|(m, p)| *m += sign * p);
                    }
                }
                moved.into_iter().fold(0.0, |most: f64, m| most.max(m.abs()))
            })
            .collect();
        largest.sort_by(f64::total_cmp);
        let at = (0.95 * draws as f64).ceil() as usize;
        let quantile = at.checked_sub(1).and_then(|at| largest.get(at)).copied().unwrap_or(0.0);
        (quantile / student(f64::MAX)).max(1.0)
    }

    /// Mean curves of the finest grid from surfaces drawn again (bootstrap), each level by itself, with the
    /// deviation of each level widened by `sqrt(n/(n - 1))`, so that they scatter as the mean does; by
    /// xoshiro256++ of this seed.
    pub fn resampled(&self, draws: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut curves = vec![self.means(self.levels()); draws];
        for (l, level) in self.levels.iter().enumerate() {
            let n = level.len();
            let widened = (n as f64 / (n as f64 - 1.0)).sqrt() / n as f64;
            let means: Vec<f64> = (0..level[0].len()).filter_map(|j| self.at(l, j)).map(|at| at.0).collect();
            for curve in &mut curves {
                for _ in 0..n {
                    // Multiply-and-shift: the bias is below n / 2^64.
                    let i = ((u128::from(random.next_u64()) * n as u128) >> 64) as usize;
                    let deviations = level[i].iter().zip(&means).map(|(v, mean)| v - mean);
                    curve.iter_mut().zip(deviations).for_each(|(k, deviation)| *k += widened * deviation);
                }
            }
        }
        curves
    }

    /// Discretisation error, absolute, of a number that depends on the mean curve: [`grid_error`] of its
    /// values on the three finest grids. `None` for fewer than three grids, or where the number does not
    /// exist on one of them.
    pub fn bias(&self, levels: usize, quantity: impl Fn(&[f64]) -> Option<f64>) -> Option<f64> {
        let on = |levels: usize| quantity(&self.means(levels));
        let (fine, half, quarter) =
            (on(levels)?, on(levels - 1)?, on(levels.checked_sub(2).filter(|&l| l > 0)?)?);
        Some(grid_error(fine, half, quarter)?.error * fine.abs())
    }
}

fn mean_at(level: &[Vec<f64>], point: usize) -> Option<f64> {
    let values: Option<Vec<f64>> = level.iter().map(|s| s.get(point).copied()).collect();
    values.map(|values| sum(values.iter().copied()) / values.len() as f64)
}

/// Weights w with `sum w y` the slope of the straight line through (x, y) by least squares; `None` for fewer
/// than two different x.
///
/// ```
/// let w = analysis::slope_weights(&[0.0, 1.0, 2.0]).unwrap();
/// assert!(w.iter().zip([-0.5, 0.0, 0.5]).all(|(a, b)| (a - b).abs() < 1e-15));
/// ```
pub fn slope_weights(x: &[f64]) -> Option<Vec<f64>> {
    let mean = sum(x.iter().copied()) / x.len() as f64;
    let square = sum(x.iter().map(|x| (x - mean) * (x - mean)));
    (square > 0.0 && square.is_finite()).then(|| x.iter().map(|x| (x - mean) / square).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A generator of even numbers in (-1, 1) by a Weyl sequence: enough for means.
    fn even(n: usize, seed: f64) -> Vec<f64> {
        (1..=n).map(|i| 2.0 * (seed + i as f64 * 0.618_033_988_749_895).fract() - 1.0).collect()
    }

    #[test]
    fn means_add_up_and_a_level_may_end_early() {
        let levels = vec![
            vec![vec![1.0, 10.0], vec![3.0, 30.0]],
            vec![vec![0.5, 1.0], vec![1.5, 3.0], vec![1.0, 2.0]],
            vec![vec![0.25], vec![0.35]],
        ];
        let m = Multilevel::new(levels).unwrap();
        assert_eq!((m.levels(), m.levels_at(0), m.levels_at(1)), (3, 3, 2));
        assert_relative_eq!(m.means(3)[0], 2.0 + 1.0 + 0.3, max_relative = 1e-15);
        assert_relative_eq!(m.means(3)[1], 22.0, max_relative = 1e-15);
        assert_eq!(m.means(1), [2.0, 20.0]);
        assert_eq!(m.at(2, 1), None);
        assert_eq!(m.at(1, 0), Some((1.0, 0.5)));
        // Variances of the means: 2/2, 0.25/3, 0.005/2.
        let first = m.propagated(3.3, &[1.0, 0.0]);
        assert_relative_eq!(first.standard_error.powi(2), 1.0 + 0.25 / 3.0 + 0.0025, max_relative = 1e-12);
        // A difference between points that move together scatters less: 10 y_0 - y_1 is 0 on both first
        // levels but for 4, 12, 8.
        let both = m.propagated(0.0, &[10.0, -1.0]);
        assert_relative_eq!(both.standard_error.powi(2), 0.0 + 16.0 / 3.0 + 0.25, max_relative = 1e-12);
    }

    #[test]
    fn one_level_is_students_interval() {
        let values = even(8, 0.1);
        let m = Multilevel::new(vec![values.iter().map(|&v| vec![v]).collect()]).unwrap();
        let u = m.propagated(m.means(1)[0], &[1.0]);
        let (_, deviation) = mean_and_deviation(&values).unwrap();
        assert_relative_eq!(u.standard_error, deviation.unwrap() / 8f64.sqrt(), max_relative = 1e-12);
        assert_relative_eq!(u.degrees_of_freedom, 7.0, max_relative = 1e-12);
        // t(0.975, 7) = 2.364624.
        assert_relative_eq!(u.half_width(), 2.364_624 * u.standard_error, max_relative = 1e-6);
    }

    #[test]
    fn a_band_over_one_number_is_its_interval_and_over_independent_ones_is_sidaks() {
        // Sixteen numbers of independent surfaces: 1 - 0.95^(1/16) two-sided is 2.948 standard errors.
        let surfaces: Vec<Vec<f64>> = (0..1024_usize)
            .map(|i| {
                (0..16).map(|j| even(1024, 0.1 * f64::from(j))[(i * (2 * j as usize + 1)) % 1024]).collect()
            })
            .collect();
        let m = Multilevel::new(vec![surfaces]).unwrap();
        let unit = |j: usize| (0..16).map(|i| if i == j { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        let one = m.simultaneous(&[unit(0)], 2000, 1);
        assert!((1.0..1.06).contains(&one), "{one}");
        let all = m.simultaneous(&(0..16).map(unit).collect::<Vec<_>>(), 2000, 1);
        assert!((all - 2.948 / 1.960).abs() < 0.08, "{all}");
        // The same number sixteen times is one number.
        let same = m.simultaneous(&vec![unit(3); 16], 2000, 1);
        assert!((1.0..1.06).contains(&same), "{same}");
    }

    #[test]
    fn resampled_means_scatter_as_their_errors_say() {
        let level = |n: usize, size: f64| even(n, 0.3).into_iter().map(|v| vec![size * v]).collect();
        let m = Multilevel::new(vec![level(40, 1.0), level(4, 0.5)]).unwrap();
        let drawn: Vec<f64> = m.resampled(4000, 5).into_iter().map(|curve| curve[0]).collect();
        let (mean, deviation) = mean_and_deviation(&drawn).unwrap();
        let exact = m.propagated(m.means(2)[0], &[1.0]);
        assert!((mean - exact.value).abs() < 0.1 * exact.standard_error, "{mean}");
        assert_relative_eq!(deviation.unwrap(), exact.standard_error, max_relative = 0.05);
    }

    #[test]
    fn an_interval_and_its_chance_agree() {
        let u = Uncertain { value: 1.0, standard_error: 0.1, degrees_of_freedom: 7.0 };
        assert_relative_eq!(u.half_width_at(0.05), u.half_width(), max_relative = 1e-9);
        let edge = 1.0 - u.half_width_at(0.01) - 0.02;
        assert_relative_eq!(u.chance_of(edge, 0.02), 0.01, max_relative = 1e-6);
        assert_relative_eq!(u.chance_of(0.99, 0.02), 1.0, max_relative = 1e-12);
    }

    #[test]
    fn the_bias_is_that_of_three_grids() {
        let level = |v: f64| vec![vec![v], vec![v]];
        let m = Multilevel::new(vec![level(4.0), level(-1.0), level(-0.5)]).unwrap();
        // 2.5, 3, 4: differences 0.5 and 1, first order.
        assert_relative_eq!(m.bias(3, |means| Some(means[0])).unwrap(), 1.5 * 0.5, max_relative = 1e-12);
        assert_eq!(m.bias(2, |means| Some(means[0])), None);
        assert_eq!(m.bias(3, |_| None), None);
    }

    #[test]
    fn bad_levels_are_named() {
        let e = |levels| Multilevel::new(levels).unwrap_err().to_string();
        assert!(e(vec![]).contains("levels"));
        assert!(e(vec![vec![vec![1.0]]]).contains("surfaces of level 0"));
        assert!(e(vec![vec![vec![1.0], vec![1.0, 2.0]]]).contains("points of level 0"));
        assert!(e(vec![vec![vec![1.0]; 2], vec![vec![1.0, 2.0]; 2]]).contains("points of level 1"));
        assert!(e(vec![vec![vec![f64::NAN], vec![1.0]]]).contains("NaN"));
    }
}
