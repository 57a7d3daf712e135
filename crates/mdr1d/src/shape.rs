//! Properties of a profile that springs need: the place of each spring, and integrals over springs.

use crate::axisymmetric::Profile;
use numerics::gauss::Gauss;
use std::sync::LazyLock;

static GAUSS: LazyLock<Gauss<5>> = LazyLock::new(Gauss::new);

/// A profile g(x) as seen from its depth: x(gamma), which never falls.
pub(crate) trait Shape: Clone {
    /// x(gamma): half the length of the line that is less than gamma deep; 0 for gamma <= 0.
    fn radius(&self, gamma: f64) -> f64;

    /// `int q dx` over the x of an interval of gamma, for the quadratic q of gamma with these values at the
    /// ends and in the middle.
    fn integral(&self, interval: [f64; 2], values: [f64; 3]) -> f64;

    /// The gamma between two others at which x(gamma) is not smooth, in any order; 0 goes without saying.
    fn kinks(&self, from: f64, to: f64) -> Vec<f64>;
}

impl Shape for Profile {
    fn radius(&self, gamma: f64) -> f64 {
        self.at_approach(gamma).radius
    }

    /// A flat punch has all its springs at gamma = 0.
    fn integral(&self, [low, high]: [f64; 2], values: [f64; 3]) -> f64 {
        match *self {
            Self::Flat { radius } if low <= 0.0 && high > 0.0 => values[0] * radius,
            Self::Flat { .. } => 0.0,
            Self::Power { exponent, .. } => {
                of_power(exponent, |gamma| self.radius(gamma), [low, high], values)
            }
        }
    }

    fn kinks(&self, _from: f64, _to: f64) -> Vec<f64> {
        Vec::new()
    }
}

/// [`Shape::integral`] of a power, `x ~ gamma^(1/exponent)`.
///
/// By moments where the interval is wide; these cancel where it is narrow, and there dx/dgamma is smooth and
/// five points of Gauss are exact to the last place.
pub(crate) fn of_power(
    exponent: f64,
    position: impl Fn(f64) -> f64,
    [low, high]: [f64; 2],
    [first, middle, last]: [f64; 3],
) -> f64 {
    /// `low/high` above which an interval is narrow: the singularity at 0 is then 19 half widths away, and
    /// the rule's error 1e-16.
    const NARROW: f64 = 0.9;
    let width = high - low;
    if width <= 0.0 {
        return 0.0;
    }
    // In s = (gamma - low)/width: q = first + s (slope + s curve).
    let curve = 2.0 * (first - 2.0 * middle + last);
    let slope = last - first - curve;
    if low > NARROW * high {
        // dx/dgamma = x/(n gamma).
        let sum: f64 = GAUSS
            .on(0.0, 1.0)
            .map(|(s, weight)| {
                let gamma = low + s * width;
                weight * (first + s * (slope + s * curve)) * (position(gamma) / gamma)
            })
            .sum();
        return sum * width / exponent;
    }
    let (a, b) = (position(low), position(high));
    // Moments of gamma^k dx = d(gamma^k x)/(k n + 1).
    let m0 = b - a;
    let m1 = (high * b - low * a) / (exponent + 1.0);
    let m2 = (high * high * b - low * low * a) / (2.0 * exponent + 1.0);
    let s1 = (m1 - low * m0) / width;
    let s2 = ((m2 - low * m1) / width - low * s1) / width;
    first * m0 + slope * s1 + curve * s2
}
