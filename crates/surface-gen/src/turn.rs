//! Cosine and sine of an angle given as a fraction of a turn.

use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Bits of the table's index: 1024 entries, 16 KiB.
const BITS: u32 = 10;
/// Radians of 2^-64 turns.
const RADIANS: f64 = TAU / 18_446_744_073_709_551_616.0;

static TABLE: LazyLock<Circle> = LazyLock::new(|| {
    let steps = 1_u32 << BITS;
    let points = (0..steps).map(|i| (TAU * (f64::from(i) / f64::from(steps))).sin_cos());
    Circle { points: points.map(|(sin, cos)| [cos, sin]).collect() }
});

/// Points on the unit circle; angles in between follow from the addition theorem with short Taylor sums.
///
/// The remaining angle is below pi / 1024, where the first omitted terms are 1e-21 (sine) and 1e-18 (cosine).
#[derive(Debug)]
pub(crate) struct Circle {
    points: Vec<[f64; 2]>,
}

impl Circle {
    pub(crate) fn shared() -> &'static Self {
        &TABLE
    }

    /// `[cos, sin]` of `2 pi turn / 2^64`, to about 2e-16.
    #[inline]
    pub(crate) fn cos_sin(&self, turn: u64) -> [f64; 2] {
        let nearest = turn.wrapping_add(1 << (63 - BITS)) >> (64 - BITS);
        let [c, s] = self.points[nearest as usize];
        let rest = turn.wrapping_sub(nearest << (64 - BITS)).cast_signed();
        let a = rest as f64 * RADIANS;
        let a2 = a * a;
        let sin = a * (1.0 - a2 * (1.0 / 6.0 - a2 * (1.0 / 120.0)));
        let cos_minus_1 = -a2 * (0.5 - a2 * (1.0 / 24.0));
        [c + (c * cos_minus_1 - s * sin), s + (s * cos_minus_1 + c * sin)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::mix;
    use approx::assert_abs_diff_eq;

    /// Two roundings of numbers up to 1, and those of the library's angle up to 2 pi.
    const ROUNDING: f64 = 1.5e-15;

    #[test]
    fn agrees_with_the_library() {
        let special = (0..64).map(|k| 1_u64 << k).chain([0, u64::MAX, 1 << 62, 3 << 62]);
        for turn in special.chain((0..20_000).map(mix)) {
            let (sin, cos) = (turn as f64 * RADIANS).sin_cos();
            let [c, s] = Circle::shared().cos_sin(turn);
            assert_abs_diff_eq!(c, cos, epsilon = ROUNDING);
            assert_abs_diff_eq!(s, sin, epsilon = ROUNDING);
        }
    }
}
