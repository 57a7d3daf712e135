//! The tests of `data/exponent/hypotheses.md`, computed again from the samples of the tested run by
//! independent code: numbers, intervals, p-values, resolved windows, verdicts.

use crate::committed::{Row, number, rows};
use crate::exponent_study::{ExponentStudy, study, towards_zero};
use std::collections::BTreeMap;

/// Rounding of sums in another order, of numbers with five digits in the samples.
const ROUNDING: f64 = 1e-9;
/// Student's distribution is computed by 4000 steps of Simpson's rule here, and by a continued fraction in
/// the table.
const OF_STUDENT: f64 = 1e-6;
/// Largest relative discretisation error of k_bar with which a window counts as resolved.
const RESOLVED: f64 = 0.03;

/// Two-sided p-value of Student's t: with x = sqrt(freedom) tan(angle) its density is a power of the cosine.
fn student_beyond(t: f64, freedom: f64) -> f64 {
    // Beyond 40 standard deviations of the angle nothing counts.
    let end = std::f64::consts::FRAC_PI_2.min(40.0 / freedom.sqrt());
    let integral = |from: f64| {
        let step = (end - from) / 4000.0;
        let term = |i: i32| {
            let weight = match i {
                0 | 4000 => 1.0,
                _ if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * (from + f64::from(i) * step).cos().max(0.0).powf(freedom - 1.0)
        };
        (0..=4000).map(term).sum::<f64>() * step
    };
    integral((t / freedom.sqrt()).atan().min(end)) / integral(0.0)
}

/// The two-sided quantile t of this probability, by bisection.
fn student_at(probability: f64, freedom: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if student_beyond(middle, freedom) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The discretisation error of a number on the finest of three grids: one and a half times the geometric
/// series of the last difference, which falls by a factor of 1/2 to 3/4 from grid to grid, or by 1/2 where
/// the sign changes.
fn left_by_grids([fine, half, quarter]: [f64; 3]) -> f64 {
    let (last, before) = (half - fine, quarter - half);
    let fall = if last * before > 0.0 { (last / before).clamp(0.5, 0.75) } else { 0.5 };
    1.5 * last.abs().max(0.5 * before.abs()) * fall / (1.0 - fall)
}

impl ExponentStudy {
    /// Levels that have a load.
    fn levels_at(&self, j: usize) -> usize {
        self.levels.iter().filter(|level| level.iter().any(|surface| surface.len() > j)).count()
    }

    /// The discretisation error of a number of the mean curve at some loads, the largest of their grids.
    fn grid_part(&self, window: &[usize], of: impl Fn(&[f64]) -> f64) -> f64 {
        let mut grids: Vec<usize> = window.iter().map(|&j| self.levels_at(j)).collect();
        grids.dedup();
        let left = |levels: &usize| left_by_grids([0, 1, 2].map(|less| of(&self.mean(levels - less))));
        grids.iter().map(left).fold(0.0, f64::max)
    }

    /// Whether the discretisation error of the mean is small at the smallest load of a window and at all
    /// larger ones.
    fn resolves(&self, window: &[usize]) -> bool {
        let mean = self.mean(self.levels.len());
        (window[0]..mean.len()).all(|j| self.grid_part(&[j], |mean| mean[j]) <= RESOLVED * mean[j])
    }

    fn exponent_grid_part(&self, window: &[usize]) -> f64 {
        let middle = window.iter().map(|&j| self.forces[j].ln()).sum::<f64>() / window.len() as f64;
        let from_middle: Vec<f64> = window.iter().map(|&j| self.forces[j].ln() - middle).collect();
        let square: f64 = from_middle.iter().map(|x| x * x).sum();
        self.grid_part(window, |mean| {
            window.iter().zip(&from_middle).map(|(&j, x)| x * mean[j].ln()).sum::<f64>() / square
        })
    }

    /// Mean curves of resampled surfaces, level by level, by Knuth's linear congruential generator.
    pub(crate) fn drawn_again(&self, draws: usize) -> Vec<Vec<f64>> {
        let mut state = 1_u64;
        let mut below = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as usize * n) >> 31
        };
        let mean = self.mean(self.levels.len());
        let mut curves = vec![mean; draws];
        for level in &self.levels {
            let n = level.len() as f64;
            let widened = (n / (n - 1.0)).sqrt() / n;
            let loads = level[0].len();
            let own: Vec<f64> = (0..loads).map(|j| level.iter().map(|s| s[j]).sum::<f64>() / n).collect();
            for curve in &mut curves {
                for _ in level {
                    let surface = &level[below(level.len())];
                    for j in 0..loads {
                        curve[j] += widened * (surface[j] - own[j]);
                    }
                }
            }
        }
        curves
    }
}

/// A number of the samples with the parts of its interval.
struct SampledNumber {
    value: f64,
    variance: f64,
    freedom: f64,
    grid: f64,
    resolved: bool,
}

fn of_window(study: &ExponentStudy, window: &[usize]) -> SampledNumber {
    let (variance, freedom) = study.exponent_variance(window);
    let (value, grid) = (study.exponent(window), study.exponent_grid_part(window));
    SampledNumber { value, variance, freedom, grid, resolved: study.resolves(window) }
}

fn check(row: &Row, found: &SampledNumber) {
    let SampledNumber { value, variance, freedom, grid, resolved } = *found;
    let [stated, low, high, chance, expected, tests] =
        ["found", "low", "high", "chance", "expected", "tests"].map(|column| number(row, column));
    assert!((value - stated).abs() < ROUNDING, "{value}: {row:?}");
    let half = student_at(0.05 / tests, freedom) * variance.sqrt() + grid;
    for (end, own) in [(low, value - half), (high, value + half)] {
        assert!((end - own).abs() < ROUNDING + OF_STUDENT * half, "{own}: {row:?}");
    }
    // The chance knows the scatter and the remaining discretisation error in another proportion than the interval.
    let away = ((value - expected).abs() - grid).max(0.0) / variance.sqrt();
    let own = student_beyond(away, freedom);
    assert!((own / chance - 1.0).abs() < OF_STUDENT, "{own}: {row:?}");
    judge(row, resolved, (value - expected).abs() <= half);
}

fn judge(row: &Row, resolved: bool, inside: bool) {
    assert_eq!(row["resolved"], resolved.to_string(), "{row:?}");
    let verdict = match (resolved, inside) {
        (true, true) => "not rejected",
        (true, false) => "rejected",
        _ => "not resolved",
    };
    assert_eq!(row["verdict"], verdict, "{row:?}");
}

/// Rows of a family.
fn family(name: &str) -> Vec<Row> {
    rows("data/exponent/exponent-tests.csv").into_iter().filter(|row| row["family"] == name).collect()
}

/// Surfaces or lines of the tested run; `None` where it has none, in which case the row has no number either.
fn tested(row: &Row, model: &str) -> Option<ExponentStudy> {
    let study = study("--tested", model, number(row, "fractal_dimension"));
    let absent = study.levels.is_empty();
    assert_eq!(row["verdict"] == "no number", absent, "{row:?}");
    assert_eq!(row["found"].is_empty(), absent, "{row:?}");
    (!absent).then_some(study)
}

fn window(row: &Row, study: &ExponentStudy) -> Vec<usize> {
    let (from, to) = row["window"].split_once("..").unwrap();
    let window = study.window(from.parse().unwrap(), to.parse().unwrap());
    assert_eq!(window.len(), 7, "{row:?}");
    window
}

#[test]
fn slopes_of_line_over_surface_and_their_verdicts_are_those_of_the_samples() {
    for row in family("A") {
        let (Some(line), Some(solid)) = (tested(&row, "mdr1d"), tested(&row, "bem3d")) else { continue };
        let [line, solid] = [line, solid].map(|study| of_window(&study, &window(&row, &study)));
        let variance = line.variance + solid.variance;
        let spread = line.variance.powi(2) / line.freedom + solid.variance.powi(2) / solid.freedom;
        let found = SampledNumber {
            value: line.value - solid.value,
            variance,
            freedom: variance * variance / spread,
            grid: line.grid + solid.grid,
            resolved: line.resolved && solid.resolved,
        };
        check(&row, &found);
    }
}

#[test]
fn exponents_of_windows_and_their_verdicts_are_those_of_the_samples() {
    for row in [family("B"), family("C")].concat() {
        if let Some(study) = tested(&row, "bem3d") {
            check(&row, &of_window(&study, &window(&row, &study)));
        }
    }
}

/// alpha of the law zeta F^alpha (1 + c F^omega) that fits best: the best of 33 values of omega, each with
/// the c of golden sections. It is coarser than [`towards_zero`], but fast enough for every draw.
fn alpha_of_scan(x: &[f64], y: &[f64], weights: &[f64]) -> f64 {
    let all: f64 = weights.iter().sum();
    let mean = |v: &[f64]| v.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>() / all;
    let middle = mean(x);
    let from_middle: Vec<f64> = x.iter().map(|x| x - middle).collect();
    let square: f64 = from_middle.iter().zip(weights).map(|(x, w)| w * x * x).sum();
    let top = x[x.len() - 1];
    let mut best = (f64::INFINITY, 0.0);
    for i in 0..=32 {
        let omega = 0.25 * 8_f64.powf(f64::from(i) / 32.0);
        let powers: Vec<f64> = x.iter().map(|x| (omega * (x - top)).exp()).collect();
        let mut z = vec![0.0; x.len()];
        let mut line = |c: f64| {
            z.iter_mut().zip(y).zip(&powers).for_each(|((z, y), power)| *z = y - (c * power).ln_1p());
            let z0 = mean(&z);
            let (mut xz, mut zz) = (0.0, 0.0);
            for ((x, z), w) in from_middle.iter().zip(&z).zip(weights) {
                xz += w * x * (z - z0);
                zz += w * (z - z0) * (z - z0);
            }
            (zz - xz * xz / square, xz / square)
        };
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (-0.9999, 1.0);
        for _ in 0..25 {
            let (left, right) = (high - golden * (high - low), low + golden * (high - low));
            if line(left).0 < line(right).0 { high = right } else { low = left }
        }
        let found = line(0.5 * (low + high));
        if found.0 < best.0 {
            best = found;
        }
    }
    best.1
}

/// Where the fits of surfaces and of lines begin (hypotheses.md).
const FITS: [(&str, f64, f64); 8] = [
    ("bem3d", 2.4, 4.3e-4),
    ("bem3d", 2.6, 2.0e-3),
    ("bem3d", 2.8, 4.3e-3),
    ("bem3d", 3.0, 6.3e-3),
    ("mdr1d", 2.4, 2.0e-7),
    ("mdr1d", 2.6, 2.0e-7),
    ("mdr1d", 2.8, 1.4e-5),
    ("mdr1d", 3.0, 1.4e-5),
];

#[test]
fn exponents_towards_zero_force_and_their_verdicts_are_those_of_the_samples() {
    // Both ends of an interval are about the seventh of 2000 draws. The share of a law beyond it scatters by
    // 1/sqrt(7), with other random numbers here by sqrt(2/7); the logarithm of a normal tail falls by 3.1 a
    // standard error there, so that an end moves by 0.17 of the 2.7 standard errors of a half-width, and the
    // farthest of 16 ends by three times as much.
    const OF_DRAWS: f64 = 0.2;
    // Both searches end at omega to about 1e-4 of itself, and alpha moves by up to 0.3 times that.
    const OF_SEARCH: f64 = 1e-4;
    let rows = family("D");
    assert_eq!(rows.len(), FITS.len());
    for (row, (model, d, start)) in rows.iter().zip(FITS) {
        assert!(row["model"] == model && (number(row, "fractal_dimension") - d).abs() < 1e-9, "{row:?}");
        let Some(study) = tested(row, model) else { continue };
        let window = study.window(start, 0.2);
        let mean = study.mean(study.levels.len());
        let x: Vec<f64> = window.iter().map(|&j| study.forces[j].ln()).collect();
        let logarithms = |mean: &[f64]| window.iter().map(|&j| mean[j].ln()).collect::<Vec<f64>>();
        let weights: Vec<f64> =
            (window.iter()).map(|&j| 1.0 / study.variance(&BTreeMap::from([(j, 1.0 / mean[j])])).0).collect();
        let fit = |mean: &[f64], held| towards_zero(&x, &logarithms(mean), &weights, held);
        let (alpha, omega) = fit(&mean, None);
        let [stated, low, high, expected] =
            ["found", "low", "high", "expected"].map(|column| number(row, column));
        assert!((alpha - stated).abs() < OF_SEARCH, "{alpha}: {row:?}");
        let grid = study.grid_part(&window, |mean| fit(mean, Some(omega)).0);
        let mut draws: Vec<f64> = (study.drawn_again(2000).iter())
            .map(|mean| alpha_of_scan(&x, &logarithms(mean), &weights))
            .collect();
        draws.sort_by(f64::total_cmp);
        let outside = (0.5 * 0.05 / 8.0 * 1999.0_f64).round() as usize;
        let (own_low, own_high) = (draws[outside] - grid, draws[1999 - outside] + grid);
        for (own, end) in [(own_low, low), (own_high, high)] {
            assert!((own - end).abs() < OF_DRAWS * 0.5 * (high - low) + OF_SEARCH, "{own}: {row:?}");
        }
        judge(row, study.resolves(&window), (low..=high).contains(&expected));
    }
}
