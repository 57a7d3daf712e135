//! The tangential springs of an axisymmetric contact, solved exactly: which of them stick and slip, and the
//! energy that they lose.
//!
//! A spring at x has the tangential deflection U(x). Its force is G* U, which Coulomb's law limits to
//! `mu E* (d - g(x))`. Along a straight segment of a path (d and u linear) a spring moves with the body until
//! it reaches that bound and then along the bound, so that at the end `U = clamp(U_0 + Du, -c, c)` with
//! `c = mu E*/G* (d - g)`. A spring that comes into contact on the way begins there with `U = 0`. All of this
//! is linear in `g`: with `gamma = g(x)` as the coordinate, U stays a polygon for any path and any profile,
//! and forces and losses are integrals of polynomials of gamma. Nothing is discretised.
//!
//! The polygon's slope never exceeds that of the bound, so slip begins at the edge and reaches inward to one
//! gamma.

use crate::shape::Shape;
use contact_model::{Nondimensionalisation, Result, Tangential, TangentialState};
use numerics::root;

/// A corner of the polygon.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    gamma: f64,
    u: f64,
}

/// The springs in lengths of the side and forces of E*.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Springs<P> {
    profile: P,
    /// G*/E*.
    shear: f64,
    /// mu E*/G*: the bound is this times `d - gamma`.
    bound: f64,
    approach: f64,
    /// U from gamma = 0 to gamma = d, where it is 0.
    polygon: Vec<Knot>,
    displacement: f64,
    dissipated: f64,
}

impl<P: Shape> Springs<P> {
    /// No contact yet; mu and G*/E*.
    pub fn new(profile: P, coefficient: f64, shear: f64) -> Self {
        let polygon = vec![Knot { gamma: 0.0, u: 0.0 }];
        let bound = coefficient / shear;
        Self { profile, shear, bound, approach: 0.0, polygon, displacement: 0.0, dissipated: 0.0 }
    }

    /// The same springs before any contact.
    pub fn unloaded(&self) -> Self {
        Self::new(self.profile.clone(), self.bound * self.shear, self.shear)
    }

    /// The same springs on a profile that agrees with theirs as far as they have been pressed, to its
    /// accuracy.
    pub fn on(&self, profile: P) -> Self {
        Self { profile, polygon: self.polygon.clone(), ..*self }
    }

    /// Normal approach of the last move.
    pub fn approach(&self) -> f64 {
        self.approach
    }

    /// Normal force over E* L^2 that the springs carry at an approach, `2 int_0^a (d - g) dx`.
    pub fn normal_force(&self, approach: f64) -> f64 {
        2.0 * self.profile.integral([0.0, approach], [approach, 0.5 * approach, 0.0])
    }

    /// Tangential displacement of the body.
    pub fn displacement(&self) -> f64 {
        self.displacement
    }

    /// Energy lost so far, in E* L^3.
    pub fn dissipated(&self) -> f64 {
        self.dissipated
    }

    /// `T = 2 G* int_0^a U dx`.
    pub fn force(&self) -> f64 {
        let segments = self.polygon.windows(2);
        let sum: f64 = segments
            .map(|w| {
                let [from, to] = [w[0], w[1]];
                self.profile.integral([from.gamma, to.gamma], [from.u, 0.5 * (from.u + to.u), to.u])
            })
            .sum();
        2.0 * self.shear * sum
    }

    /// The tangential part of a state, along x, what was prescribed as it was prescribed. The factor is that of
    /// forces, for springs of a profile that agrees with the contact to its accuracy.
    pub fn state(
        &self,
        prescribed: Tangential,
        factor: f64,
        units: Nondimensionalisation,
    ) -> Result<TangentialState> {
        let force = match prescribed {
            Tangential::Force([force, _]) => force,
            _ => units.force(self.force() * factor)?,
        };
        let displacement = match prescribed {
            Tangential::Displacement([displacement, _]) => displacement,
            _ => units.approach(self.displacement())?,
        };
        Ok(TangentialState::new([force, 0.0], [displacement, 0.0])
            .with_stick_radius(units.approach(self.stick_radius())?)
            // E* L^3: a force times a length.
            .with_dissipated(units.approach(units.force(self.dissipated())?)?))
    }

    /// Radius inside which the springs are below their bound.
    pub fn stick_radius(&self) -> f64 {
        /// A spring within this share of its bound is at it.
        const AT_BOUND: f64 = 1.0 - 1e-11;
        // Nothing holds without contact or without friction.
        if self.approach * self.bound <= 0.0 {
            return 0.0;
        }
        let slips = |knot: &Knot| knot.u.abs() >= self.limit(knot.gamma, self.approach) * AT_BOUND;
        // From the edge inwards; the edge itself has no bound to be below of.
        let inner = self.polygon.iter().rev().skip(1).take_while(|knot| slips(knot)).last();
        self.profile.radius(inner.map_or(self.approach, |knot| knot.gamma))
    }

    /// The springs at the end of a straight segment of the path: another approach, another displacement.
    pub fn moved(&self, approach: f64, displacement: f64) -> Self {
        let by = displacement - self.displacement;
        let free = self.free(approach, by);
        let (polygon, slip) = self.clamped(&free, approach);
        let lost = self.lost_in_contact(&free, approach, by, slip) + self.lost_on_release(approach, by);
        Self {
            profile: self.profile.clone(),
            approach,
            polygon,
            displacement,
            dissipated: self.dissipated + 2.0 * self.shear * lost.max(0.0),
            ..*self
        }
    }

    /// The springs under an approach where they hold a tangential force; `None` beyond the limit mu F, at
    /// which the contact slips as a whole.
    pub fn held(&self, approach: f64, limit: f64, force: f64) -> Option<Self> {
        /// A force exactly at the limit may come out a few roundings beyond it; one that is there already
        /// does not move anything.
        const ROUNDING: f64 = 8.0 * f64::EPSILON;
        if force.abs() > limit * (1.0 + ROUNDING) {
            return None;
        }
        let stay = self.moved(approach, self.displacement);
        if (stay.force() - force).abs() <= ROUNDING * limit {
            return Some(stay);
        }
        let [low, high] = self.reach(approach);
        let displacement = root::between(low, high, |u| {
            let beyond = self.moved(approach, u).force() - force;
            if beyond.abs() <= ROUNDING * limit { 0.0 } else { beyond }
        });
        Some(self.moved(approach, displacement))
    }

    /// Displacements between which every tangential force lies, at an approach: there the whole contact
    /// slips.
    fn reach(&self, approach: f64) -> [f64; 2] {
        let centre = self.polygon.first().map_or(0.0, |knot| knot.u);
        let limit = self.limit(0.0, approach);
        [self.displacement - limit - centre, self.displacement + limit - centre]
    }

    fn limit(&self, gamma: f64, approach: f64) -> f64 {
        self.bound * (approach - gamma)
    }

    /// U without Coulomb's law.
    fn free(&self, approach: f64, by: f64) -> Vec<Knot> {
        let mut free: Vec<Knot> = self
            .polygon
            .iter()
            .take_while(|knot| knot.gamma <= approach)
            .map(|knot| Knot { u: knot.u + by, ..*knot })
            .collect();
        if approach > self.approach {
            // New springs: u from their own first touch on, linear in gamma.
            free.push(Knot { gamma: approach, u: 0.0 });
        } else if let Some(last) = free.last().copied()
            && last.gamma < approach
            && let Some(next) = self.polygon.get(free.len())
        {
            let part = (approach - last.gamma) / (next.gamma - last.gamma);
            free.push(Knot { gamma: approach, u: last.u + part * (next.u + by - last.u) });
        }
        free
    }

    /// U with Coulomb's law, and where slip begins with its sign.
    fn clamped(&self, free: &[Knot], approach: f64) -> (Vec<Knot>, Option<(f64, f64)>) {
        let edge = Knot { gamma: approach, u: 0.0 };
        let excess = |knot: &Knot, sign: f64| sign * knot.u - self.limit(knot.gamma, approach);
        if approach <= 0.0 {
            return (vec![Knot { gamma: 0.0, u: 0.0 }], None);
        }
        for (k, knot) in free.iter().enumerate() {
            let sign = if knot.u < 0.0 { -1.0 } else { 1.0 };
            let over = excess(knot, sign);
            if over <= 0.0 {
                continue;
            }
            let mut polygon = free[..k].to_vec();
            let begin = match polygon.last() {
                None => 0.0,
                Some(last) => {
                    let under = excess(last, sign);
                    last.gamma + (knot.gamma - last.gamma) * (-under / (over - under)).clamp(0.0, 1.0)
                }
            };
            if polygon.last().is_some_and(|last| last.gamma >= begin) {
                polygon.pop();
            }
            polygon.push(Knot { gamma: begin, u: sign * self.limit(begin, approach) });
            if begin < approach {
                polygon.push(edge);
            }
            return (polygon, Some((begin, sign)));
        }
        let mut polygon = free.to_vec();
        match polygon.last_mut() {
            Some(last) if last.gamma >= approach => last.u = 0.0,
            _ => polygon.push(edge),
        }
        (polygon, None)
    }

    /// `int (slip x force) dx / G*` of the springs that are in contact at the end, on one side.
    ///
    /// A spring that ends e beyond its bound has slipped for the share `e/rate` of the segment, against a
    /// bound that grew by `growth` in all of it.
    fn lost_in_contact(&self, free: &[Knot], approach: f64, by: f64, slip: Option<(f64, f64)>) -> f64 {
        let Some((begin, sign)) = slip else { return 0.0 };
        let growth = self.bound * (approach - self.approach);
        let rate = sign * by - growth;
        if rate <= 0.0 {
            return 0.0;
        }
        let lost = |gamma: f64, u: f64| {
            let limit = self.limit(gamma, approach);
            let beyond = (sign * u - limit).max(0.0);
            beyond * (limit - 0.5 * growth * (beyond / rate).min(1.0))
        };
        self.sum(free, begin, approach, lost)
    }

    /// The same of the springs that have left contact: they slip until nothing holds them.
    fn lost_on_release(&self, approach: f64, by: f64) -> f64 {
        let fall = self.approach - approach;
        if fall <= 0.0 {
            return 0.0;
        }
        let growth = self.bound * fall;
        // The free position when the spring lets go, linear in gamma like U itself.
        let end: Vec<Knot> = self
            .polygon
            .iter()
            .map(|knot| Knot { u: knot.u + by * (self.approach - knot.gamma) / fall, ..*knot })
            .collect();
        let lost = |_: f64, u: f64| {
            let rate = growth + if u < 0.0 { -by } else { by };
            if rate > 0.0 { u.abs() * 0.5 * growth * (u.abs() / rate).min(1.0) } else { 0.0 }
        };
        self.sum(&end, approach, self.approach, lost)
    }

    /// Integral over x of a function of gamma and the polygon, quadratic wherever the polygon is straight and
    /// keeps its sign.
    fn sum(&self, polygon: &[Knot], from: f64, to: f64, function: impl Fn(f64, f64) -> f64) -> f64 {
        let mut total = 0.0;
        for w in polygon.windows(2) {
            let at = |gamma: f64| {
                let part = (gamma - w[0].gamma) / (w[1].gamma - w[0].gamma);
                w[0].u + part * (w[1].u - w[0].u)
            };
            let (low, high) = (w[0].gamma.max(from), w[1].gamma.min(to));
            if low >= high {
                continue;
            }
            // Where the polygon changes sign, two segments.
            let zero = low + (high - low) * (at(low) / (at(low) - at(high)));
            let cuts = if zero > low && zero < high { vec![low, zero, high] } else { vec![low, high] };
            for cut in cuts.windows(2) {
                let middle = 0.5 * (cut[0] + cut[1]);
                let values = [cut[0], middle, cut[1]].map(|gamma| function(gamma, at(gamma)));
                total += self.profile.integral([cut[0], cut[1]], values);
            }
        }
        total
    }
}

#[cfg(test)]
mod tests;
