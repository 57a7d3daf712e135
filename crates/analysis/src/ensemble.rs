//! Means over surfaces and their errors.

use crate::curves::Curves;
use numerics::quantile::student;
use numerics::sum::sum;
use serde::{Deserialize, Serialize};

/// Mean, standard error and log mean of positive numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard error of the arithmetic mean, `sqrt(sum (x - mean)^2 / (n (n - 1)))`; `None` for one number.
    pub standard_error: Option<f64>,
    /// `exp(mean ln x)`.
    pub log_mean: f64,
    /// Number of numbers.
    pub count: usize,
}

/// Mean of finite numbers, and the standard deviation of one of them where there are at least two; `None` for
/// no number, or one that is not finite. The standard error of the mean is the deviation over the square root
/// of their count.
///
/// ```
/// assert_eq!(analysis::mean_and_deviation(&[0.0, 2.0]), Some((1.0, Some(2.0_f64.sqrt()))));
/// assert_eq!(analysis::mean_and_deviation(&[3.0]), Some((3.0, None)));
/// ```
pub fn mean_and_deviation(values: &[f64]) -> Option<(f64, Option<f64>)> {
    if values.is_empty() || !values.iter().all(|v| v.is_finite()) {
        return None;
    }
    let n = values.len() as f64;
    let mean = sum(values.iter().copied()) / n;
    // Two passes: no cancellation between mean square and squared mean.
    let squares = || sum(values.iter().map(|v| (v - mean) * (v - mean)));
    Some((mean, (values.len() > 1).then(|| (squares() / (n - 1.0)).sqrt())))
}

/// Half of the 95 % interval of a mean over `count` numbers, of which one has this standard deviation, by Student's
/// distribution with one degree of freedom less than there are numbers.
///
/// ```
/// // 12.706 is Student's quantile of one degree of freedom.
/// assert!((analysis::half_width_of_mean(2.0_f64.sqrt(), 2) - 12.706).abs() < 1e-3);
/// ```
pub fn half_width_of_mean(deviation: f64, count: usize) -> f64 {
    let n = count as f64;
    student(n - 1.0) * deviation / n.sqrt()
}

/// Statistics of finite positive numbers; `None` for no numbers, or where one is not finite and positive.
///
/// ```
/// let s = analysis::statistics(&[1.0, 4.0]).unwrap();
/// assert_eq!((s.mean, s.standard_error, s.count), (2.5, Some(1.5), 2));
/// assert!((s.log_mean - 2.0).abs() < 1e-15);
/// ```
pub fn statistics(values: &[f64]) -> Option<Statistics> {
    let (mean, _) = mean_and_deviation(values).filter(|_| values.iter().all(|v| *v > 0.0))?;
    let n = values.len() as f64;
    let log_mean = (sum(values.iter().map(|v| v.ln())) / n).exp();
    // One root: the last digit of stored results.
    let standard_error = (values.len() > 1)
        .then(|| (sum(values.iter().map(|v| (v - mean) * (v - mean))) / (n * (n - 1.0))).sqrt());
    Some(Statistics { mean, standard_error, log_mean, count: values.len() })
}

/// The ensemble at one force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnsemblePoint {
    /// `F_bar`.
    pub force_bar: f64,
    /// `k_bar` over the surfaces that have a sample; `None` when none has.
    pub stiffness_bar: Option<Statistics>,
    /// Surfaces without a sample at this force.
    pub missing: usize,
    /// Smallest number of contact cells among the surfaces; `None` where the model has no cells.
    pub min_contact_cells: Option<usize>,
}

/// Mean, error and log mean of k_bar at every force, over the surfaces that have a sample there.
pub fn ensemble(curves: &Curves) -> Vec<EnsemblePoint> {
    let all = curves.all();
    (curves.force_bar().iter().enumerate())
        .map(|(j, &force_bar)| {
            let samples: Vec<_> = curves.drawn(&all, j).flatten().collect();
            let k: Vec<f64> = samples.iter().map(|s| s.stiffness_bar).collect();
            EnsemblePoint {
                force_bar,
                stiffness_bar: statistics(&k),
                missing: all.len() - samples.len(),
                min_contact_cells: samples.iter().filter_map(|s| s.contact_cells).min(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StiffnessSample;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    #[test]
    fn one_surface_has_no_error_and_none_has_no_mean() {
        assert_eq!(statistics(&[]), None);
        assert_eq!(statistics(&[1.0, f64::NAN]), None);
        assert_eq!(statistics(&[0.0]), None);
        let s = statistics(&[0.5]).unwrap();
        assert_eq!((s.standard_error, s.count), (None, 1));
    }

    #[test]
    fn missing_samples_are_counted() {
        let s = |k, c| Some(StiffnessSample { stiffness_bar: k, contact_cells: Some(c) });
        let curves = Curves::new(vec![1.0, 2.0], vec![vec![s(1.0, 7), None], vec![s(2.0, 5), None]]).unwrap();
        let e = ensemble(&curves);
        assert_eq!((e[0].missing, e[0].min_contact_cells), (0, Some(5)));
        assert_relative_eq!(e[0].stiffness_bar.unwrap().mean, 1.5);
        assert_eq!((e[1].missing, e[1].stiffness_bar), (2, None));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn log_mean_is_never_above_the_mean_and_all_scales(
            values in prop::collection::vec(1e-6..1e3_f64, 1..40), factor in 1e-3..1e3_f64
        ) {
            let s = statistics(&values).unwrap();
            prop_assert!(s.log_mean <= s.mean * (1.0 + 1e-12));
            let scaled: Vec<f64> = values.iter().map(|v| v * factor).collect();
            let t = statistics(&scaled).unwrap();
            assert_relative_eq!(t.mean, s.mean * factor, max_relative = 1e-12);
            assert_relative_eq!(t.log_mean, s.log_mean * factor, max_relative = 1e-12);
        }
    }
}
