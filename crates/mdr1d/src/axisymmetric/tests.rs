use super::*;
use crate::Bearing;
use approx::assert_relative_eq;
use contact_model::NormalLoad;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::f64::consts::FRAC_PI_2;

/// Digits of the values in data/paper/VALUES.md.
const PRINTED: f64 = 1e-10;
/// Rounding of a root and a handful of products.
const ROUNDING: f64 = 1e-14;

fn profile(surface: &Surface) -> Profile {
    Profile::new(surface).unwrap().unwrap()
}

fn power(coefficient: f64, exponent: f64) -> Profile {
    profile(&Surface::PowerLaw { coefficient, exponent, size: 1.0.into() })
}

#[test]
fn kappa_of_the_table() {
    let table = [
        (0.2, 1.132_308_697_5),
        (0.5, 1.311_028_777_1),
        (0.8, 1.471_637_592_2),
        (1.0, FRAC_PI_2),
        (2.0, 2.0),
        (3.0, 2.356_194_490_2),
        (4.0, 8.0 / 3.0),
    ];
    for (n, expected) in table {
        assert_relative_eq!(kappa(n).unwrap(), expected, max_relative = PRINTED);
    }
    assert_relative_eq!(kappa(4.0).unwrap(), 8.0 / 3.0, max_relative = ROUNDING);
    // Computed with 30 digits, up to where the series stands alone.
    for (n, expected) in [
        (1e-3, 1.000_692_976_244_49),
        (0.3, 1.194_235_875_743_489_5),
        (6.7, 3.367_004_550_454_965_4),
        (25.0, 6.329_533_922_494_025),
        (1e4, 125.334_547_056_054_48),
    ] {
        assert_relative_eq!(kappa(n).unwrap(), expected, max_relative = ROUNDING);
    }
}

#[test]
fn kappa_obeys_its_recurrences() {
    for i in 1..200 {
        let n = 0.17 * f64::from(i);
        assert_relative_eq!(
            kappa(n).unwrap() * kappa(n + 1.0).unwrap(),
            FRAC_PI_2 * (n + 1.0),
            max_relative = ROUNDING
        );
        assert_relative_eq!(
            kappa(n + 2.0).unwrap(),
            kappa(n).unwrap() * (n + 2.0) / (n + 1.0),
            max_relative = ROUNDING
        );
    }
}

#[test]
fn hertz_in_numbers() {
    // E* = R = L = 1 (the radius at F = 1 leaves that square; the profile itself does not know).
    let sphere = profile(&Surface::Sphere { radius: 1.0, size: 1.0.into() });
    let one = sphere.at_force(1.0);
    assert_relative_eq!(one.radius, 0.908_560_296_416, max_relative = PRINTED);
    assert_relative_eq!(one.approach, 0.825_481_812_224, max_relative = PRINTED);
    let small = sphere.at_force(1e-3);
    assert_relative_eq!(small.radius, 0.090_856_029_642, max_relative = PRINTED);
    assert_relative_eq!(small.approach, 0.008_254_818_122, max_relative = PRINTED);
}

#[test]
fn cone_and_circle_in_numbers() {
    let cone = profile(&Surface::Cone { slope: 0.1, size: 1.0.into() }).at_approach(0.1);
    assert_relative_eq!(cone.radius, 2.0 / PI, max_relative = ROUNDING);
    assert_relative_eq!(cone.force, 0.063_661_977_2, max_relative = 1e-9);
    let punch = profile(&Surface::FlatCircle { radius: 0.3, size: 1.0.into() }).at_force(0.06);
    assert_relative_eq!(punch.approach, 0.1, max_relative = ROUNDING);
    assert_relative_eq!(punch.stiffness(), 0.6, max_relative = ROUNDING);
}

#[test]
fn the_discretised_profile_converges_with_its_order() {
    // The radius is an element's edge on all three grids (1/3 of the half width at odd multiples of 81), so
    // that the force error is the smooth one of the midpoint rule.
    for (exponent, order) in [(0.5, 1.5), (0.8, 1.8), (1.0, 2.0), (2.0, 2.0), (3.0, 2.0)] {
        let body = power(0.7, exponent);
        let exact = body.at_approach(body.depth(0.1).unwrap());
        let errors: Vec<f64> = [81, 243, 729]
            .iter()
            .map(|&elements| {
                let mut bearing = Bearing::new(&body.line(0.3, elements).unwrap());
                let s = bearing.press(NormalLoad::Approach(exact.approach), 1.0).unwrap();
                assert_relative_eq!(s.stiffness, exact.stiffness(), max_relative = 1e-12);
                (s.force / exact.force - 1.0).abs()
            })
            .collect();
        for pair in errors.windows(2) {
            let found = (pair[0] / pair[1]).ln() / 3.0_f64.ln();
            assert!((found - order).abs() < 0.1, "n = {exponent}: order {found}, expected {order}");
        }
        // Anywhere else the stiffness is off by at most two elements: order 1.
        for elements in [101, 1001, 10_001] {
            let mut bearing = Bearing::new(&body.line(0.3, elements).unwrap());
            let s = bearing.press(NormalLoad::Force(exact.force), 1.0).unwrap();
            assert!((s.stiffness - exact.stiffness()).abs() <= 2.0 * 0.6 / elements as f64);
        }
    }
    let mut punch = Bearing::new(&Profile::Flat { radius: 0.2 }.line(0.2, 9).unwrap());
    assert_relative_eq!(
        punch.press(NormalLoad::Force(1.0), 1.0).unwrap().approach,
        2.5,
        max_relative = ROUNDING
    );
}

#[test]
fn bad_bodies() {
    let wide = Surface::FlatCircle { radius: 0.6, size: 1.0.into() };
    assert!(matches!(Profile::new(&wide), Err(Error::OutOfRange { .. })));
    let steep = Surface::PowerLaw { coefficient: 1e300, exponent: 3.0, size: 1e150.into() };
    assert!(matches!(Profile::new(&steep), Err(Error::Domain { .. })));
    assert!(Profile::new(&Surface::Cone { slope: 0.0, size: 1.0.into() }).is_err());
    assert!(Profile::new(&Surface::Flat { size: 1.0.into() }).unwrap().is_none());
    assert!(kappa(-1e300).is_err() && kappa(f64::NAN).is_err());
    assert!(power(1.0, 1.0).line(0.5, 10).is_err());
    assert!(Profile::Flat { radius: 0.1 }.line(0.5, 11).is_err());
    // L^(n - 1) = 1e350 alone overflows; the body does not.
    let tall = Surface::PowerLaw { coefficient: 1e-300, exponent: 8.0, size: 1e50.into() };
    assert!(Profile::new(&tall).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(64) })]

    #[test]
    fn exponent_round_trip_and_tangent(n in 0.1_f64..6.0, c in 0.01_f64..10.0, d in 1e-6_f64..1e-1) {
        let body = power(c, n);
        let s = body.at_approach(d);
        let back = body.at_force(s.force);
        assert_relative_eq!(back.approach, d, max_relative = ROUNDING * 10.0);
        assert_relative_eq!(back.radius, s.radius, max_relative = ROUNDING * 10.0);
        // dlnk/dlnF = 1/(n + 1) exactly.
        let (low, high) = (body.at_force(s.force / 8.0), body.at_force(s.force * 8.0));
        let alpha = (high.stiffness() / low.stiffness()).ln() / 64.0_f64.ln();
        assert_relative_eq!(alpha, 1.0 / (n + 1.0), max_relative = 1e-12);
        // k = dF/dd: central difference of relative step e, error of order e^2 / n^3.
        let e = 1e-4 * n.min(1.0);
        let (low, high) = (body.at_approach(d * (1.0 - e)), body.at_approach(d * (1.0 + e)));
        assert_relative_eq!((high.force - low.force) / (2.0 * e * d), s.stiffness(), max_relative = 1e-6);
        prop_assert!(low.force < s.force && s.force < high.force);
        prop_assert!(2.0 * s.force <= low.force + high.force);
    }
}
