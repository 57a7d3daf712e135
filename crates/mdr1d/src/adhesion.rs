//! Short-range adhesion of axisymmetric bodies: the outermost spring detaches at a critical length.
//!
//! In a contact of radius a the springs at the edge are stretched by `Delta l = sqrt(2 pi a w / E*)` and no
//! further (Hess 2011; Popov and Hess 2015, Sec. 3.2). So `d = g(a) - Delta l` and
//! `F = 2 E* int_0^a (d - g) dx`: the JKR theory for any axisymmetric body.
//!
//! For `g = s x^n` both equations have the form `B t^m - c t = y` with `m > 1` exactly when `n > 1/2`: convex
//! in t, with its smallest y at a fold, where the contact pulls off. For sharper bodies, with `n <= 1/2`, the
//! attraction would pull the bodies together without limit.

use crate::axisymmetric::{Profile, RoundContact};
use contact_model::{Error, Result};
use numerics::root::newton_from_above;
use std::f64::consts::PI;

/// Exponents at and below this one have no stable contact with adhesion that grows with the load.
const SHARPEST: f64 = 0.5;

/// Slope `dd/da` over that without adhesion, below which a state is the pull-off under prescribed approach: a
/// radius that is found from an approach has half its digits there, and its `dF/dd` none.
const AT_FOLD: f64 = 1e-7;

/// A load exactly at the fold may come out a few roundings beyond it.
const ROUNDED_UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// A profile whose edge springs detach at the length `tear sqrt(a)`, in units of the side and E*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Adhesive {
    profile: Profile,
    /// `sqrt(2 pi w / (E* L))`.
    tear: f64,
}

/// The smallest load of its kind that the contact can bear, or a number that no f64 holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NoEquilibrium {
    PullsOff { smallest: f64 },
    Range(f64),
}

impl Adhesive {
    /// `work` is w/(E* L).
    ///
    /// # Errors
    /// [`Error::Domain`] for a body with exponent <= 1/2, unless w = 0.
    pub fn new(profile: Profile, work: f64) -> Result<Self> {
        match profile {
            Profile::Power { exponent, .. } if exponent <= SHARPEST && work > 0.0 => {
                let expected = "more than 1/2 with adhesion (a sharper body is drawn in without end)";
                Err(Error::domain("exponent", exponent, expected))
            }
            _ => Ok(Self { profile, tear: (2.0 * PI * work).sqrt() }),
        }
    }

    /// The stable state under a prescribed approach.
    pub fn at_approach(self, approach: f64) -> Result<RoundContact, NoEquilibrium> {
        match self.profile {
            Profile::Power { exponent, slope } => {
                let root = largest_root(slope, self.tear, 2.0 * exponent, approach)?;
                let radius = root * root;
                Ok(RoundContact { force: self.force(exponent, slope, radius), approach, radius })
            }
            Profile::Flat { radius } => self.flat(radius, approach, 1.0),
        }
    }

    /// The stable state under a prescribed force.
    pub fn at_force(self, force: f64) -> Result<RoundContact, NoEquilibrium> {
        match self.profile {
            Profile::Power { exponent, slope } => {
                let share = exponent / (exponent + 1.0);
                let root = largest_root(slope * share, self.tear, 2.0 / 3.0 * (exponent + 1.0), 0.5 * force)
                    .map_err(|failure| match failure {
                        NoEquilibrium::PullsOff { smallest } => {
                            NoEquilibrium::PullsOff { smallest: 2.0 * smallest }
                        }
                        range @ NoEquilibrium::Range(_) => range,
                    })?;
                let radius = root.cbrt().powi(2);
                let approach = slope * radius.powf(exponent) - self.tear * radius.sqrt();
                Ok(RoundContact { force, approach, radius })
            }
            Profile::Flat { radius } => self.flat(radius, force, 2.0 * radius),
        }
    }

    /// `dF/dd` along the branch, on which the edge moves, over E* L: `2 a (1 - b)/(1 - b/3)` with
    /// `b = (3/2) c sqrt(a)/(n s a^n)`.
    ///
    /// 0 at the pull-off under prescribed force, `None` at that under prescribed approach, where it has no
    /// bound. The edge of a flat punch does not move: 2 a.
    pub fn slope(self, radius: f64) -> Option<f64> {
        let held = 2.0 * radius;
        match self.profile {
            Profile::Power { exponent, slope } if self.attracts() => {
                let b = 1.5 * self.tear * radius.sqrt() / (exponent * slope * radius.powf(exponent));
                let approach = 1.0 - b / 3.0;
                (approach > AT_FOLD).then(|| held * (1.0 - b) / approach)
            }
            _ => Some(held),
        }
    }

    /// Whether there is adhesion.
    pub fn attracts(self) -> bool {
        self.tear > 0.0
    }

    /// `F = 2 (n/(n + 1) s a^(n + 1) - c a^(3/2))`.
    fn force(self, exponent: f64, slope: f64, radius: f64) -> f64 {
        let pressed = exponent / (exponent + 1.0) * slope * radius.powf(exponent);
        2.0 * radius * (pressed - self.tear * radius.sqrt())
    }

    /// A flat punch (Kendall 1971): `load` is the approach times `stiffness`; its whole edge detaches at
    /// once.
    fn flat(self, radius: f64, load: f64, stiffness: f64) -> Result<RoundContact, NoEquilibrium> {
        let least = -self.tear * radius.sqrt() * stiffness;
        if load < least * ROUNDED_UP {
            return Err(NoEquilibrium::PullsOff { smallest: least });
        }
        let approach = load / stiffness;
        Ok(RoundContact { force: 2.0 * radius * approach, approach, radius })
    }
}

/// The largest root t of `B t^m - c t = y`, for m > 1 (m > 0 where c = 0), B > 0, c >= 0.
///
/// Convex in t: Newton's steps from above the root only descend. Solved in the unit of whichever of `c t` and
/// `y` is the larger, so that nothing is lost as c -> 0.
fn largest_root(b: f64, c: f64, m: f64, y: f64) -> Result<f64, NoEquilibrium> {
    let range = |value: f64| if value.is_finite() { Ok(value) } else { Err(NoEquilibrium::Range(value)) };
    let loaded = if y > 0.0 { (y / b).powf(m.recip()) } else { 0.0 };
    if c <= 0.0 {
        return if y < 0.0 { Err(NoEquilibrium::PullsOff { smallest: 0.0 }) } else { range(loaded) };
    }
    if y > 0.0 && c * loaded <= y {
        // t = loaded s: s^m = 1 + e s with e in [0, 1].
        let e = c * loaded / y;
        let start = 2.0_f64.powf(m.recip()).max((2.0 * e).powf((m - 1.0).recip()));
        return range(
            loaded * newton_from_above(start, |s| (s.powf(m) - e * s - 1.0, m * s.powf(m - 1.0) - e)),
        );
    }
    let unit = (c / b).powf((m - 1.0).recip());
    if !unit.is_normal() {
        return Err(NoEquilibrium::Range(unit));
    }
    // t = unit s: s^m - s = y / (c unit).
    let load = y / (c * unit);
    let fold = m.powf(-(m - 1.0).recip());
    let least = -fold * (1.0 - m.recip());
    if load < least * ROUNDED_UP {
        return Err(NoEquilibrium::PullsOff { smallest: least * c * unit });
    }
    if load <= least {
        return range(unit * fold);
    }
    let start =
        if load > 0.0 { (2.0 * load).powf(m.recip()).max(2.0_f64.powf((m - 1.0).recip())) } else { 1.0 };
    range(unit * newton_from_above(start, |s| (s.powf(m) - s - load, m * s.powf(m - 1.0) - 1.0)).max(fold))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::Surface;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// Roots, powers and a handful of products.
    const ROUNDING: f64 = 1e-13;

    fn adhesive(surface: &Surface, work: f64) -> Adhesive {
        Adhesive::new(Profile::new(surface).unwrap().unwrap(), work).unwrap()
    }

    fn sphere(work: f64) -> Adhesive {
        adhesive(&Surface::Sphere { radius: 1.0, size: 1.0.into() }, work)
    }

    fn power(coefficient: f64, exponent: f64, work: f64) -> Adhesive {
        adhesive(&Surface::PowerLaw { coefficient, exponent, size: 1.0.into() }, work)
    }

    /// JKR in closed form, with E* = R = 1.
    fn jkr_cubed_radius(force: f64, work: f64) -> f64 {
        let w = 3.0 * PI * work;
        0.75 * (force + w + (2.0 * w * force + w * w).sqrt())
    }

    #[test]
    fn the_sphere_is_jkr() {
        for work in [1e-8, 1e-4, 0.01, 1.0] {
            let sphere = sphere(work);
            // From just above the pull-off (where a root loses half its digits in any form) to large loads.
            for force in [-1.49, -1.0, -0.3, 0.0, 0.5, 10.0, 1e4, 1e8].map(|x| x * PI * work) {
                let s = sphere.at_force(force).unwrap();
                assert_relative_eq!(s.radius, jkr_cubed_radius(force, work).cbrt(), max_relative = 1e-12);
                let d = s.radius.powi(2) - (2.0 * PI * work * s.radius).sqrt();
                assert_relative_eq!(s.approach, d, max_relative = 1e-11);
                let back = sphere.at_approach(d).unwrap();
                assert_relative_eq!(back.radius, s.radius, max_relative = 1e-12);
                assert_relative_eq!(back.force, force, max_relative = 1e-11, epsilon = 1e-13 * work);
            }
        }
    }

    #[test]
    fn the_pull_offs_of_the_sphere() {
        let work = 0.01;
        let Err(NoEquilibrium::PullsOff { smallest }) = sphere(work).at_force(-1.0) else {
            panic!("it holds")
        };
        assert_relative_eq!(smallest, -1.5 * PI * work, max_relative = ROUNDING);
        assert!(sphere(work).at_force(smallest).is_ok());
        let Err(NoEquilibrium::PullsOff { smallest }) = sphere(work).at_approach(-1.0) else {
            panic!("it holds")
        };
        let last = sphere(work).at_approach(smallest).unwrap();
        assert_relative_eq!(last.force, -5.0 / 6.0 * PI * work, max_relative = 1e-12);
        assert_relative_eq!(last.radius, (PI * work / 8.0).cbrt(), max_relative = 1e-12);
    }

    #[test]
    fn a_cone_and_a_flat_punch() {
        // Cone (Maugis and Barquins 1981): F = (pi/2) E* tan a^2 - sqrt(8 pi w E* a^3), so the pull-off is at
        // sqrt(a) = 3 c/(2 s).
        let (work, slope) = (1e-3, 0.2);
        let cone = adhesive(&Surface::Cone { slope, size: 1.0.into() }, work);
        let Err(NoEquilibrium::PullsOff { smallest }) = cone.at_force(-1.0) else { panic!("it holds") };
        let (c, s) = ((2.0 * PI * work).sqrt(), PI / 2.0 * slope);
        let a = (1.5 * c / s).powi(2);
        assert_relative_eq!(smallest, s * a * a - 2.0 * c * a.powf(1.5), max_relative = 1e-12);
        // Kendall: F = -sqrt(8 pi w E* a^3).
        let punch = adhesive(&Surface::FlatCircle { radius: 0.1, size: 1.0.into() }, work);
        let Err(NoEquilibrium::PullsOff { smallest }) = punch.at_force(-1.0) else { panic!("it holds") };
        assert_relative_eq!(smallest, -(8.0 * PI * work * 1e-3).sqrt(), max_relative = ROUNDING);
        let state = punch.at_approach(-0.01).unwrap();
        assert_relative_eq!(state.force, -0.002, max_relative = ROUNDING);
    }

    #[test]
    fn sharp_bodies_are_refused_and_bad_ranges_named() {
        let sharp = Profile::Power { exponent: 0.5, slope: 1.0 };
        assert!(Adhesive::new(sharp, 0.1).is_err() && Adhesive::new(sharp, 0.0).is_ok());
        assert!(matches!(power(1e-3, 0.501, 1e3).at_force(0.0), Err(NoEquilibrium::Range(_))));
    }

    /// The rule itself on a line of springs: an element holds unless stretched beyond the length of its own
    /// radius.
    fn springs(body: Adhesive, approach: f64, element: f64) -> f64 {
        let stretch = |x: f64| approach - body.profile.depth(x).unwrap();
        let centre = |i: usize| (i as f64 + 0.5) * element;
        // The contact reaches to the outermost element that holds.
        let count = (0..(0.5 / element) as usize)
            .rev()
            .find(|&i| stretch(centre(i)) >= -body.tear * centre(i).sqrt())
            .map_or(0, |i| i + 1);
        (0..count).map(|i| 2.0 * element * stretch(centre(i))).sum()
    }

    #[test]
    fn lines_of_springs_converge() {
        for (coefficient, exponent) in [(0.5, 2.0), (0.3, 1.0), (1.0, 3.0)] {
            let body = power(coefficient, exponent, 1e-4);
            let exact = body.at_approach(0.01).unwrap().force;
            // The edge is found to within an element, and the edge spring carries a finite force: first
            // order. The error of one spacing depends on where the edge falls in its element, so means over
            // neighbouring spacings are compared.
            let error = |n: usize| {
                let near = (0..16).map(|i| springs(body, 0.01, 1.0 / (n + 2 * i) as f64) - exact);
                near.map(f64::abs).sum::<f64>() / 16.0
            };
            let order = (error(1000) / error(16_000)).ln() / 16.0_f64.ln();
            assert!((0.8..1.3).contains(&order), "{exponent}: {order}");
            assert!(error(16_000) < 1e-3 * exact.abs());
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(48) })]

        #[test]
        fn both_loads_agree_and_satisfy_the_rule(n in 0.6_f64..6.0, c in 0.05_f64..5.0, work in 1e-9_f64..1e-3, a in 1e-2_f64..0.4) {
            let body = power(c, n, work);
            let Profile::Power { slope, .. } = body.profile else { unreachable!() };
            let d = slope * a.powf(n) - body.tear * a.sqrt();
            // dd/da > 0 by a margin: the stable branch.
            prop_assume!(n * slope * a.powf(n - 1.0) > 1.2 * 0.5 * body.tear / a.sqrt());
            let by_approach = body.at_approach(d).unwrap();
            assert_relative_eq!(by_approach.radius, a, max_relative = 1e-11);
            if n * slope * a.powf(n) > 1.2 * 1.5 * body.tear * a.sqrt() {
                let by_force = body.at_force(by_approach.force).unwrap();
                assert_relative_eq!(by_force.radius, a, max_relative = 1e-11);
            }
        }

        #[test]
        fn without_work_it_is_the_bare_profile(n in 0.2_f64..6.0, c in 0.05_f64..5.0, force in 1e-8_f64..1.0) {
            let (bare, body) = (power(c, n, 0.0).profile, power(c, n, 0.0));
            assert_relative_eq!(body.at_force(force).unwrap().radius, bare.at_force(force).radius, max_relative = ROUNDING);
            assert_relative_eq!(body.at_approach(force).unwrap().force, bare.at_approach(force).force, max_relative = ROUNDING);
            // Towards it as the root of the work.
            if n > 0.6 {
                let change = |work: f64| power(c, n, work).at_force(force).unwrap().radius / bare.at_force(force).radius - 1.0;
                let (small, smaller) = (change(1e-14 * force), change(1e-16 * force));
                prop_assert!(small > smaller && smaller >= 0.0);
            }
        }
    }
}
