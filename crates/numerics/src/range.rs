//! Smallest and largest of many values.

use crate::parallel::map;

/// Values compared side by side, so that the compiler compares several at once.
const LANES: usize = 8;

/// Number of values in one task of a thread.
const CHUNK: usize = 1 << 15;

/// Smallest and largest value, NaN ignored; (inf, -inf) for none. Shared by threads where there are many
/// values.
///
/// ```
/// assert_eq!(numerics::range::range(&[2.0, f64::NAN, -1.0]), (-1.0, 2.0));
/// ```
pub fn range(values: &[f64]) -> (f64, f64) {
    if values.len() <= CHUNK {
        return range_alone(values);
    }
    let chunks = map(values.len(), values.chunks(CHUNK), range_alone);
    chunks
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), range| (low.min(range.0), high.max(range.1)))
}

fn range_alone(values: &[f64]) -> (f64, f64) {
    let (groups, rest) = values.as_chunks::<LANES>();
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for group in groups {
        for ((low, high), &v) in low.iter_mut().zip(&mut high).zip(group) {
            *low = if v < *low { v } else { *low };
            *high = if v > *high { v } else { *high };
        }
    }
    let low = low.iter().chain(rest).fold(f64::INFINITY, |a, &b| a.min(b));
    (low, high.iter().chain(rest).fold(f64::NEG_INFINITY, |a, &b| a.max(b)))
}

/// Middle of the range and half its width, or 1 where the width is 0. `(value - middle)/half width` lies
/// between -1 and 1, so that no square of it leaves the range of f64 and an offset costs only its own
/// rounding. The caller must leave out undefined values (not finite ones) first.
///
/// ```
/// assert_eq!(numerics::range::middle_and_half_width((1.0, 5.0)), (3.0, 2.0));
/// assert_eq!(numerics::range::middle_and_half_width((4.0, 4.0)), (4.0, 1.0));
/// ```
pub fn middle_and_half_width((low, high): (f64, f64)) -> (f64, f64) {
    let half = 0.5 * high - 0.5 * low;
    (0.5 * low + 0.5 * high, if half > 0.0 { half } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_any_length() {
        assert_eq!(range(&[]), (f64::INFINITY, f64::NEG_INFINITY));
        for n in [1, 7, 8, 9, CHUNK + 3] {
            let values: Vec<f64> = (0..n).map(|k| (k * 7 % n) as f64).collect();
            let expected = values.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &v| (a.min(v), b.max(v)));
            assert_eq!(range(&values), expected, "{n}");
        }
        assert_eq!(range(&[f64::NEG_INFINITY, 1.0]), (f64::NEG_INFINITY, 1.0));
    }
}
