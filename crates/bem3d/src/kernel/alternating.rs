//! Accelerated alternating sums.

/// Terms of a sum: the error falls as 5.8^-n.
pub const TERMS: usize = 24;

/// Weights `w` with `sum_(k >= 0) (-1)^k a_k = sum_(k < TERMS) w_k a_k`.
///
/// Source: Cohen, Rodriguez Villegas, Zagier, Exp. Math. 9, 3 (2000), algorithm 1.
pub fn alternating_weights() -> [f64; TERMS] {
    let n = TERMS as f64;
    let power = (3.0 + 8.0_f64.sqrt()).powf(n);
    let d = f64::midpoint(power, power.recip());
    let (mut b, mut c) = (-1.0, -d);
    std::array::from_fn(|k| {
        let k = k as f64;
        c = b - c;
        b *= (k + n) * (k - n) / ((k + 0.5) * (k + 1.0));
        c / d
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    #[test]
    fn alternating_sums_of_the_textbook() {
        // ln 2 = 1 - 1/2 + 1/3 - .. and pi/4 = 1 - 1/3 + 1/5 - ..
        let sum = |step: f64| -> f64 {
            alternating_weights().iter().enumerate().map(|(k, w)| w / (step * k as f64 + 1.0)).sum()
        };
        assert_relative_eq!(sum(1.0), 2.0_f64.ln(), max_relative = 1e-15);
        assert_relative_eq!(sum(2.0), PI / 4.0, max_relative = 1e-15);
    }
}
