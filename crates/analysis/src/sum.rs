//! One compensated sum for the whole crate.

/// Sum by Neumaier's compensated method: the rounding error does not grow with the number of terms.
///
/// ```
/// assert_eq!(analysis::sum([1.0, 1e100, 1.0, -1e100]), 2.0);
/// ```
pub fn sum(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut total, mut lost) = (0.0_f64, 0.0_f64);
    for v in values {
        let next = total + v;
        // The smaller of the two lost its low digits: keep them.
        lost += if total.abs() >= v.abs() { (total - next) + v } else { (v - next) + total };
        total = next;
    }
    total + lost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_million_tenths() {
        let s = sum(std::iter::repeat_n(0.1, 10_000_000));
        approx::assert_relative_eq!(s, 1e6, max_relative = 1e-15);
        approx::assert_abs_diff_eq!(sum([]), 0.0);
    }
}
