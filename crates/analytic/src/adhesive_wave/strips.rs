//! Johnson's curve without dimensions: pressures in p*, heights in D.

use crate::westergaard::gap_of_fractions;
use numerics::root;
use std::f64::consts::FRAC_PI_2;

/// The alpha from which on the pressure only falls with psi: twice the largest
/// `2 sin^(3/2) psi cos^(5/2) psi`.
pub(super) const CRITICAL: f64 = 1.065_205_656_063_280_7;

/// Strips in contact, through tan psi: it keeps its digits towards no contact and towards full contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strips {
    pub tangent: f64,
}

impl Strips {
    /// `r = sin^2 psi`.
    fn sine_squared(self) -> f64 {
        let t = self.tangent;
        if t < 1.0 { t * t / (1.0 + t * t) } else { 1.0 / (1.0 + t.recip().powi(2)) }
    }

    /// `1 - r = cos^2 psi`, without cancellation.
    fn cosine_squared(self) -> f64 {
        1.0 / (1.0 + self.tangent * self.tangent)
    }

    /// `-ln r`; infinite without contact.
    pub fn less_log(self) -> f64 {
        let t = self.tangent;
        if t < 1.0 { (t * t).ln_1p() - 2.0 * t.ln() } else { t.recip().powi(2).ln_1p() }
    }

    /// Share of the nominal area, `2 psi/pi`.
    pub fn fraction(self) -> f64 {
        self.tangent.atan() / FRAC_PI_2
    }

    /// `p/p*`.
    pub fn pressure(self, alpha: f64) -> f64 {
        self.sine_squared() - alpha * self.tangent.sqrt()
    }

    /// `p/p* - ratio`, without cancellation between 1 - r and 1 - ratio.
    fn pressure_above(self, alpha: f64, ratio: f64) -> f64 {
        let without_adhesion = if self.tangent < 1.0 {
            self.sine_squared() - ratio
        } else {
            (1.0 - ratio) - self.cosine_squared()
        };
        without_adhesion - alpha * self.tangent.sqrt()
    }

    /// `d(p/p*)/d tan psi`.
    fn rise(self, alpha: f64) -> f64 {
        2.0 * self.tangent * self.cosine_squared().powi(2) - 0.5 * alpha / self.tangent.sqrt()
    }

    /// `-d(p/p*)/d(mean gap over D)` along the curve; `1/less_log` of it is that of bonded strips.
    ///
    /// With `q = d(p/p*)/dt` of t = tan psi the gap falls by `-q ln r + 2 alpha cos^2 psi/sqrt t`: that of
    /// the bonded strips, and that of the tension on strips that grow.
    pub fn slope(self, alpha: f64) -> f64 {
        if alpha <= 0.0 || self.tangent <= 0.0 {
            return self.less_log().recip();
        }
        let rise = self.rise(alpha);
        let grown = 2.0 * alpha * self.cosine_squared() / self.tangent.sqrt();
        rise / (self.less_log() * rise + grown)
    }

    /// Mean gap over D.
    pub fn gap(self, alpha: f64) -> f64 {
        if self.tangent <= 0.0 {
            return 1.0;
        }
        gap_of_fractions(self.sine_squared(), self.cosine_squared())
            + alpha * self.tangent.sqrt() * self.less_log()
    }
}

/// The strips of the smallest and the largest pressure: roots of `4 t^(3/2)/(1 + t^2)^2 = alpha`, t = tan
/// psi.
///
/// The left side has its maximum at t^2 = 3/5. Up to there `(1 + t^2)^2` is at most 64/25, which brackets the
/// first root; the second one has nearly the same form in u = 1/t, `4 u^(5/2)/(1 + u^2)^2 = alpha`, with its
/// maximum at u^2 = 5/3, where `(1 + u^2)^2` is 64/9.
pub(super) fn limits(alpha: f64) -> Option<[Strips; 2]> {
    /// A bracket holds its root although its ends are rounded.
    const ROUNDED: f64 = 1e-12;
    if !(alpha > 0.0 && alpha < CRITICAL) {
        return None;
    }
    let root = |power: f64, most: f64| {
        let side = |t: f64| 4.0 * t.powf(power) / (1.0 + t * t).powi(2) - alpha;
        let end = |side: f64| (0.25 * side * alpha).powf(power.recip());
        root::between(end(1.0) * (1.0 - ROUNDED), end(most) * (1.0 + ROUNDED), side)
    };
    let (first, last) = (root(1.5, 64.0 / 25.0), root(2.5, 64.0 / 9.0).recip());
    // Next to the critical alpha rounding leaves nothing between them.
    (first < last).then_some([Strips { tangent: first }, Strips { tangent: last }])
}

/// The strips between two at which the pressure, which rises between them, is this share of p*.
pub(super) fn between(first: Strips, last: Strips, alpha: f64, ratio: f64) -> Strips {
    /// Bound of the relative error of exp(x) after x, |x| < 300, was rounded a few times.
    const OF_LOGARITHM: f64 = 1e-12;
    let above = |x: f64| Strips { tangent: x.exp() }.pressure_above(alpha, ratio);
    let x = root::between(first.tangent.ln(), last.tangent.ln(), above);
    let strips = Strips { tangent: x.exp() };
    // One of Newton's steps returns the digits that the logarithm took. At a limit there is no such step.
    let step = strips.pressure_above(alpha, ratio) / strips.rise(alpha);
    let tangent =
        if step.abs() < OF_LOGARITHM * strips.tangent { strips.tangent - step } else { strips.tangent };
    Strips { tangent: tangent.clamp(first.tangent, last.tangent) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use std::f64::consts::{FRAC_PI_4, PI};

    /// Every comparison here is relative at all magnitudes: `epsilon = 0.0` takes away the absolute one of
    /// `approx`. A handful of functions, and `e + r ln r`, which takes one digit where its series ends.
    const ROUNDING: f64 = 1e-14;
    /// Relative step of differences; their error is its square.
    const STEP: f64 = 1e-5;

    /// `(alpha, psi, [p/p*, mean gap over D, stiffness times w/E*])` in 60-digit arithmetic at the psi as
    /// written.
    const STATES: [(f64, f64, [f64; 3]); 12] = [
        (0.3, 1e-100, [-3e-51, 1.0, 0.006_821_881_769_209_207]),
        (0.3, 1e-8, [-2.999_999_999_99e-5, 1.001_105_240_844_633_4, 0.085_273_522_115_115_08]),
        (0.01, 0.002, [-0.000_443_213_898_976_063_1, 1.005_504_801_968_105_1, 0.252_758_682_995_294_6]),
        (0.3, 0.3, [-0.079_521_822_884_094_22, 1.106_544_884_486_183, 1.288_575_103_349_377_3]),
        (0.0, 0.7, [0.415_016_428_549_879_5, 0.220_002_696_915_527_04, 3.572_276_395_890_43]),
        (0.3, 1.2, [0.387_558_991_882_508_84, 0.076_749_929_701_570_42, 22.318_621_128_135_128]),
        (1e-3, 1.5, [0.991_241_062_559_520_7, 3.137_688_293_075_432e-5, 626.275_322_110_266_7]),
        (1e-3, 1.57, [0.964_562_582_833_974_5, 2.247_195_619_139_523e-8, 4_954_127.374_751_889]),
        (1e-6, 1.5706, [0.999_928_592_357_635_2, 2.751_608_380_680_383e-12, 81_506_213.287_640_66]),
        (1e-9, 1.570_795, [0.999_999_131_841_574_5, 1.528_291_258_039_643e-18, 1_784_605_749_768.64]),
        (0.0, 1.570_796_31, [0.999_999_999_999_999_7, 3.978_133_439_256_748e-32, 1.113_769_194_174_280_6e16]),
        (
            1e-12,
            1.570_796_31,
            [0.999_999_992_283_660_1, 2.176_536_784_343_803e-24, 1.113_769_194_174_280_6e16],
        ),
    ];

    #[test]
    fn states_are_those_of_long_arithmetic() {
        for (alpha, psi, [pressure, gap, stiffness]) in STATES {
            let strips = Strips { tangent: f64::tan(psi) };
            assert_abs_diff_eq!(
                strips.pressure(alpha),
                pressure,
                epsilon = ROUNDING * pressure.abs().min(1.0)
            );
            assert_relative_eq!(strips.gap(alpha), gap, max_relative = ROUNDING, epsilon = 0.0);
            assert_relative_eq!(PI / strips.less_log(), stiffness, max_relative = ROUNDING, epsilon = 0.0);
        }
        let apart = Strips { tangent: 0.0 };
        let state = (Some(apart.pressure(0.3)), Some(apart.gap(0.3)), Some(1.0 / apart.less_log()));
        assert_eq!(state, (Some(0.0), Some(1.0), Some(0.0)));
    }

    /// alpha, `[psi, p/p*]` at the pull-off, and `[psi, p/p*, mean gap over D, stiffness times w/E*]` at the
    /// snap-in, in 60-digit arithmetic.
    const LIMITS: [(f64, [f64; 2], [f64; 4]); 7] = [
        (
            1e-12,
            [3.968_502_629_920_499e-9, -4.724_703_937_105_774e-17],
            [
                1.570_787_223_973_881,
                0.999_999_999_585_693_2,
                3.089_701_528_251_373e-20,
                37_913_848_095.255_56,
            ],
        ),
        (
            1e-6,
            [3.968_502_636_170_499e-5, -4.724_703_939_586_088e-9],
            [
                1.568_509_795_956_499_6,
                0.999_973_859_038_519_4,
                1.230_037_430_271_653_4e-10,
                600_890.541_755_351_2,
            ],
        ),
        (
            1e-3,
            [0.003_968_565_132_523_603_5, -4.724_728_740_898_279e-5],
            [
                1.534_535_096_730_700_6,
                0.993_435_406_512_055_8,
                7.769_073_411_831_236e-6,
                2_388.744_011_131_664_5,
            ],
        ),
        (
            0.1,
            [0.086_136_196_223_586_8, -0.021_984_233_275_942_32],
            [
                1.336_152_722_876_581_7,
                0.741_414_771_487_077_5,
                0.012_853_855_442_869_748,
                56.533_573_792_547_64,
            ],
        ),
        (
            0.3,
            [0.183_999_560_890_771_24, -0.095_944_026_342_064_64],
            [
                1.190_767_482_235_089_8,
                0.387_727_760_720_551_1,
                0.080_203_330_189_633_71,
                21.221_493_702_685_95,
            ],
        ),
        (
            0.57,
            [0.298_616_710_927_824_8, -0.229_692_641_369_182_4],
            [
                1.047_135_125_243_210_8,
                -0.000_162_181_537_702_123_24,
                0.250_100_732_822_147_7,
                10.917_627_197_596_727,
            ],
        ),
        (
            1.0,
            [0.535_445_441_496_131_4, -0.509_901_992_194_916_7],
            [FRAC_PI_4, -0.5, 0.846_573_590_279_972_6, 4.532_360_141_827_194],
        ),
    ];

    #[test]
    fn limits_are_those_of_long_arithmetic() {
        for (alpha, [first_psi, least], [last_psi, largest, gap, stiffness]) in LIMITS {
            let [first, last] = limits(alpha).unwrap();
            assert_relative_eq!(first.tangent.atan(), first_psi, max_relative = ROUNDING, epsilon = 0.0);
            assert_relative_eq!(first.pressure(alpha), least, max_relative = ROUNDING, epsilon = 0.0);
            assert_relative_eq!(last.tangent.atan(), last_psi, max_relative = ROUNDING, epsilon = 0.0);
            assert_abs_diff_eq!(last.pressure(alpha), largest, epsilon = ROUNDING);
            assert_relative_eq!(last.gap(alpha), gap, max_relative = ROUNDING, epsilon = 0.0);
            assert_relative_eq!(PI / last.less_log(), stiffness, max_relative = ROUNDING, epsilon = 0.0);
        }
    }

    #[test]
    fn the_pressure_turns_at_its_limits() {
        for alpha in [1e-160, 1e-30, 1e-5, 0.3, 1.0, 1.065] {
            for strips in limits(alpha).unwrap() {
                let [low, high] = [1.0 - STEP, 1.0 + STEP].map(|by| Strips { tangent: by * strips.tangent });
                // Of the terms without and with adhesion the first is of the size of their difference.
                let unit = strips.sine_squared().min(strips.cosine_squared());
                assert!((low.rise(alpha) > 0.0) != (high.rise(alpha) > 0.0), "{alpha:e}");
                let rise = strips.rise(alpha) * strips.tangent;
                assert_abs_diff_eq!(rise, 0.0, epsilon = ROUNDING * unit);
            }
        }
        for alpha in [f64::NAN, 0.0, -1.0, CRITICAL, 2.0, f64::INFINITY] {
            assert!(limits(alpha).is_none());
        }
        assert!(limits(f64::MIN_POSITIVE).is_some());
        // Next to the critical value both limits meet or are none; they never change places.
        let mut alpha = CRITICAL;
        for _ in 0..1000 {
            alpha = alpha.next_down();
            assert!(limits(alpha).is_none_or(|[first, last]| first.tangent < last.tangent));
        }
        assert!(limits(CRITICAL * (1.0 - 1e-6)).is_some());
    }

    /// A root finds the strips that made the pressure, as well as the pressure knows them.
    #[test]
    fn strips_of_a_pressure() {
        for alpha in [1e-100, 1e-12, 1e-3, 0.3, 1.0, 1.0652] {
            let [first, last] = limits(alpha).unwrap();
            for share in (1..100).map(|percent| 0.01 * f64::from(percent)) {
                let tangent = first.tangent.powf(1.0 - share) * last.tangent.powf(share);
                let strips = Strips { tangent };
                let ratio = strips.pressure(alpha);
                let found = between(first, last, alpha, ratio);
                // Rounding of the pressure over its slope in ln t.
                let rounding = f64::EPSILON * ratio.abs().max(strips.sine_squared());
                let lost = rounding / (strips.rise(alpha) * tangent);
                assert_relative_eq!(
                    found.tangent,
                    tangent,
                    max_relative = 4.0 * (f64::EPSILON + lost),
                    epsilon = 0.0
                );
            }
        }
    }
}
