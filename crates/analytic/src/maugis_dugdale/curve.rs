//! Maugis's equations in his units.

use numerics::root;
use std::f64::consts::PI;

/// Equilibrium states of one lambda, in Maugis's units: contact radius in `(pi w R^2/K)^(1/3)`, force in
/// `pi w R`, approach in `(pi^2 w^2 R/K^2)^(1/3)`.
///
/// The parameter is x = ln s with `s = sqrt(m^2 - 1)`, `m = c/a`, because the condition that the gap at c is
/// the range, `lambda a^2/2 A(s) + 4/3 lambda^2 a B(s) = 1`, is quadratic in a at a given s. A and B grow
/// with s, and a falls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MaugisCurve {
    pub lambda: f64,
}

/// One state, in the units of its [`MaugisCurve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MaugisPoint {
    /// Contact radius.
    pub a: f64,
    /// `sqrt(c^2 - a^2)`.
    pub q: f64,
    /// Outer radius of the cohesive zone.
    pub c: f64,
    /// `asec(c/a) = atan(q/a)`.
    pub theta: f64,
    /// `s - atan s` with s = q/a; infinite at a = 0.
    pub rest: f64,
}

impl MaugisCurve {
    /// Smallest x: the contact radius is near 1e98, and its cube is still a number.
    pub const LEAST: f64 = -150.0;
    /// Largest x: a is 1e-26 c, and forces and approaches are those of a = 0 to all digits.
    pub const MOST: f64 = 60.0;

    pub fn at(self, x: f64) -> MaugisPoint {
        let s = x.exp();
        let (theta, rest) = (s.atan(), s_less_atan(s));
        // A = s + (s^2 - 1) atan s, B = s atan s - (sqrt(1 + s^2) - 1), without their cancellations.
        let square = 0.5 * self.lambda * (rest + s * s * theta);
        let linear = 4.0 / 3.0 * self.lambda * self.lambda * (s * (theta - s / (1.0 + s.hypot(1.0))));
        let a = 2.0 / (linear + linear.hypot(2.0 * square.sqrt()));
        MaugisPoint { a, q: a * s, c: a * s.hypot(1.0), theta, rest }
    }

    /// The state of contact radius 0, a regular end: `pi/4 lambda c^2 + 4/3 (pi/2 - 1) lambda^2 c = 1`.
    pub fn end(self) -> MaugisPoint {
        let square = 0.25 * PI * self.lambda;
        let linear = 4.0 / 3.0 * (0.5 * PI - 1.0) * self.lambda * self.lambda;
        let c = 2.0 / (linear + linear.hypot(2.0 * square.sqrt()));
        MaugisPoint { a: 0.0, q: c, c, theta: 0.5 * PI, rest: f64::INFINITY }
    }

    /// The state of a contact radius not above that of [`MaugisCurve::LEAST`].
    pub fn at_radius(self, a: f64) -> MaugisPoint {
        if a <= self.at(Self::MOST).a {
            return MaugisPoint { a, ..self.end() };
        }
        self.at(root::between(Self::LEAST, Self::MOST, |x| (self.at(x).a / a).ln()))
    }

    /// The state where a function that is negative at `from` and grows with the contact radius vanishes;
    /// `None` beyond [`MaugisCurve::LEAST`], and for functions without a value.
    pub fn above(self, from: f64, function: impl Fn(&MaugisPoint) -> f64) -> Option<MaugisPoint> {
        let (mut low, mut step) = (from, 1.0);
        while low > Self::LEAST {
            let high = low;
            low = (low - step).max(Self::LEAST);
            step *= 2.0;
            if function(&self.at(low)) >= 0.0 {
                return Some(self.at(root::between(low, high, |x| function(&self.at(x)))));
            }
        }
        None
    }
}

impl MaugisPoint {
    /// `a^3 - lambda a^2 (s + m^2 asec m)`.
    pub fn force(&self, lambda: f64) -> f64 {
        self.a.powi(3) - lambda * (self.a * self.q + self.c * (self.c * self.theta))
    }

    /// `a^2 - 4/3 lambda a s`.
    pub fn approach(&self, lambda: f64) -> f64 {
        self.a * self.a - 4.0 / 3.0 * lambda * self.q
    }

    /// `(dF/da, dd/da)` along the curve, both over a: they are finite at a = 0.
    ///
    /// As functions of a and q the terms of the condition are `a^2 A = a q + (q^2 - a^2) theta` and
    /// `a B = q theta - c + a`, those of the force `a q + c^2 theta`, with `dtheta/da = -q/c^2` and
    /// `dtheta/dq = a/c^2`.
    pub fn rates(&self, lambda: f64) -> (f64, f64) {
        let Self { a, q, c, theta, rest } = *self;
        let (sine, cosine) = (q / c, a / c);
        // theta - sin theta cos theta, where s is small as s^3/(1 + s^2) - (s - atan s).
        let segment = if q < SERIES * a { sine * sine * (q / a) - rest } else { theta - sine * cosine };
        let by_a = lambda * segment + 4.0 / 3.0 * lambda * lambda / c * (sine * sine / (1.0 + cosine));
        let by_q = lambda * (a * sine * sine + q * theta)
            + 4.0 / 3.0 * lambda * lambda * (theta - sine * sine * sine / (1.0 + cosine));
        // (dq/da)/a.
        let moved = by_a / by_q;
        let force = 3.0 * a - 2.0 * lambda * (theta + (a + q * theta) * moved);
        (force, 2.0 - 4.0 / 3.0 * lambda * moved)
    }
}

/// Below this s the series of `s - atan s` takes the place of the difference, which has lost a tenth of s
/// there.
const SERIES: f64 = 0.5;

/// `s - atan s = s^3/3 - s^5/5 + ...`, s >= 0, to rounding.
fn s_less_atan(s: f64) -> f64 {
    /// 0.25^27 is below half of the last place.
    const TERMS: u32 = 27;
    if s >= SERIES {
        return s - s.atan();
    }
    let square = s * s;
    let sum = (1..=TERMS).rev().fold(0.0, |sum, k| 1.0 / f64::from(2 * k + 1) - square * sum);
    s * square * sum
}
