//! Moments of samples.

/// Below this many values a plain sum is as good as a pairwise one.
const PLAIN: usize = 128;

/// Sum of `term` over the values, pairwise: the rounding error grows with log n only.
pub(crate) fn pairwise(values: &[f64], term: &impl Fn(f64) -> f64) -> f64 {
    if values.len() <= PLAIN {
        return values.iter().map(|&v| term(v)).sum();
    }
    let (left, right) = values.split_at(values.len() / 2);
    pairwise(left, term) + pairwise(right, term)
}

/// Root mean square of the heights about their mean, `sqrt(mean (h - mean h)^2)`, in the unit of the heights.
///
/// Two passes with pairwise sums, on heights divided by their largest deviation from the middle of their range: nothing overflows or underflows for heights of 1e-150
/// or 1e150, and an offset costs its own rounding only. 0 for no heights or equal ones; not finite if a height is not.
///
/// ```
/// // Deviations from the mean 3 are -2, 0, 2: mean square 8/3.
/// let rms = surface_gen::rms_height(&[1.0, 3.0, 5.0]);
/// assert!((rms - (8.0_f64 / 3.0).sqrt()).abs() < 1e-15);
/// ```
pub fn rms_height(heights: &[f64]) -> f64 {
    let (low, high) =
        heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &h| (low.min(h), high.max(h)));
    let (middle, unit) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    if heights.is_empty() || unit <= 0.0 {
        return 0.0;
    }
    let n = heights.len() as f64;
    let mean = pairwise(heights, &|h| (h - middle) / unit) / n;
    let square = pairwise(heights, &|h| ((h - middle) / unit - mean).powi(2)) / n;
    unit * square.sqrt()
}
