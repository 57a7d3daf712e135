//! [`Tabulated`]: the profile g(x) of any growing contact, from states that another model has solved.

use crate::shape::{Shape, of_power};
use contact_model::{Error, Result};

/// A monotone profile g(x) through given states of a contact, in units of `L = sqrt(Lx Ly)` of its rectangle.
///
/// A spring foundation of stiffness E* whose line has the half width `x(d) = k(d)/(2 E*)` in contact has the
/// same F, d and k as the contact with the stiffness k(d): `F = 2 E* int_0^d x`, `k = 2 E* x` (Popov, Pohrt,
/// Hess; M. Hess 2011). So any contact whose k never falls with d has an equivalent profile, `g(x(d)) = d`.
/// Between two states x is the parabola in d that meets both stiffnesses and the difference of forces; its
/// error is of third order in the spacing for x, of fourth order for F. Where that parabola would fall, two
/// straight segments take its place. From first touch to the first state x is a power of d, or a flat face
/// with a straight flank, according to F d/k.
///
/// ```
/// use contact_model::{Scene, Surface};
/// use mdr1d::{Equivalent, Mdr1d};
/// // A sphere, from its own states: g = x^2/R.
/// let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
/// let profile = Equivalent::new(Mdr1d::default()).profile(&scene, 0, 0.04)?;
/// assert!((profile.depth(0.1).expect("touched") - 0.01).abs() < 1e-6);
/// assert!((profile.half_width(0.01) - 0.1).abs() < 1e-5);
/// assert!(profile.depth(0.21).is_none());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    segments: Vec<Segment>,
    /// Number of states behind it.
    nodes: usize,
    /// At every state, the largest change of the force at it or a lower one when that state is left out.
    doubts: Vec<(f64, f64)>,
}

/// A state of the contact: lengths in L, the force in E* L^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    pub approach: f64,
    pub force: f64,
    /// `k/(2 E*)`.
    pub radius: f64,
    /// Relative tolerance of force and radius.
    pub slack: f64,
}

/// x on an interval of the depth.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Segment {
    from: f64,
    width: f64,
    /// x at the beginning, and by how much it grows.
    start: f64,
    rise: f64,
    form: TabulatedForm,
    /// F/E* at the beginning.
    force: f64,
}

/// How x grows with s from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
enum TabulatedForm {
    /// `s + c s (1 - s)`, |c| <= 1.
    Parabola(f64),
    /// `s^m`, m > 0; only in the first segment, from x = 0.
    Power(f64),
}

/// Share of an interval's rise that two straight segments leave at least on either side.
const STEEPEST: f64 = 1e-9;
/// Powers of the first segment: below the first x is constant rather.
const POWERS: (f64, f64) = (0.0625, 64.0);
/// Shares of the rise between which a parabola that meets them never falls.
const PARABOLA: (f64, f64) = (1.0 / 3.0, 2.0 / 3.0);
/// A share may lie beyond them by this much because of rounding.
const ROUNDING: f64 = 1e-9;

impl Tabulated {
    /// The profile through states in ascending order of their approach.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] where the stiffness falls with the approach, or the force is not convex, by more
    /// than the states' slack.
    pub(crate) fn new(nodes: &[Node]) -> Result<Self> {
        let mut segments = Vec::with_capacity(nodes.len() + 1);
        let mut last: Option<Node> = None;
        for node in nodes {
            let begin = last.unwrap_or(Node { approach: 0.0, force: 0.0, radius: 0.0, slack: 0.0 });
            let radius = node.radius.max(begin.radius);
            let slack = node.slack.max(begin.slack);
            if begin.radius > node.radius * (1.0 + slack) {
                return Err(shrinks("stiffness over 2 E* L", node.radius, begin.radius, f64::INFINITY));
            }
            let end = Node { radius, ..*node };
            let (low, high) = (begin.radius, radius);
            let chord = (end.force - begin.force) / (2.0 * (end.approach - begin.approach));
            let loose = slack * end.force / (end.approach - begin.approach) + ROUNDING * high;
            if !(low - loose..=high + loose).contains(&chord) {
                return Err(shrinks("slope of the chord of F(d) over 2 E* L", chord, low, high));
            }
            if last.is_some() {
                segments.extend(between(begin, end, chord));
            } else {
                segments.push(first(end, chord));
            }
            last = Some(end);
        }
        let mut largest = 0.0_f64;
        let doubts = nodes.windows(3).map(|part| {
            largest = largest.max(left_out(part));
            (part[1].approach, largest)
        });
        Ok(Self { segments, nodes: nodes.len(), doubts: doubts.collect() })
    }

    /// Depth g(x) in units of the side; `None` beyond the largest half width that was solved for.
    pub fn depth(&self, x: f64) -> Option<f64> {
        let x = x.abs();
        let segment =
            self.segments.get(self.segments.partition_point(|segment| segment.start + segment.rise < x))?;
        Some(segment.from + segment.width * segment.inverse(x))
    }

    /// Half width `x = k/(2 E*)` at a depth, both in units of the side; that of the last state beyond it.
    pub fn half_width(&self, depth: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        self.at(depth).map_or(0.0, |(segment, s)| segment.radius(s))
    }

    /// Force over `E* L^2` at a depth up to the last state.
    pub fn force(&self, depth: f64) -> f64 {
        self.at(depth.max(0.0)).map_or(0.0, |(segment, s)| segment.force_at(s))
    }

    /// Number of states that it goes through.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Estimated error of the table at a depth: the largest change of the force at any state up to it when
    /// that state is left out, over the force at the depth.
    ///
    /// It bounds the error of the table in F, and in a tangential force over mu F. For smooth bodies it is
    /// about ten times the error itself (fourth order, twice the spacing).
    pub fn uncertainty(&self, depth: f64) -> f64 {
        let below = self.doubts.partition_point(|(approach, _)| *approach <= depth);
        let change = below.checked_sub(1).map_or(0.0, |last| self.doubts[last].1);
        if change > 0.0 { change / self.force(depth) } else { 0.0 }
    }

    /// The segment at a depth, and where in it.
    fn at(&self, depth: f64) -> Option<(&Segment, f64)> {
        let k = self.segments.partition_point(|segment| segment.from <= depth).max(1) - 1;
        let segment = self.segments.get(k)?;
        Some((segment, ((depth - segment.from) / segment.width).clamp(0.0, 1.0)))
    }
}

/// From first touch to the first state.
fn first(end: Node, chord: f64) -> Segment {
    let (width, high) = (end.approach, end.radius);
    let segment =
        Segment { from: 0.0, width, start: 0.0, rise: high, form: TabulatedForm::Parabola(0.0), force: 0.0 };
    let power = high / chord - 1.0;
    if power >= POWERS.0 {
        Segment { form: TabulatedForm::Power(power.min(POWERS.1)), ..segment }
    } else {
        // A flat face and a flank.
        let face = (2.0 * chord - high).clamp(0.0, high);
        Segment { start: face, rise: high - face, ..segment }
    }
}

/// Between two states.
fn between(begin: Node, end: Node, chord: f64) -> Vec<Segment> {
    let (rise, width) = (end.radius - begin.radius, end.approach - begin.approach);
    let segment = Segment {
        from: begin.approach,
        width,
        start: begin.radius,
        rise,
        form: TabulatedForm::Parabola(0.0),
        force: begin.force,
    };
    let share = (chord - begin.radius) / rise;
    // No rise at all: NaN or infinite.
    if rise <= 0.0 || !share.is_finite() {
        return vec![segment];
    }
    if (PARABOLA.0 - ROUNDING..=PARABOLA.1 + ROUNDING).contains(&share) {
        return vec![Segment {
            form: TabulatedForm::Parabola((6.0 * share - 3.0).clamp(-1.0, 1.0)),
            ..segment
        }];
    }
    let share = share.clamp(STEEPEST, 1.0 - STEEPEST);
    // Flat and then a ramp, or a ramp and then flat.
    let turn = if share < 0.5 { 1.0 - 2.0 * share } else { 2.0 * (1.0 - share) };
    let (rises, middle) = if share < 0.5 { ([0.0, rise], begin.radius) } else { ([rise, 0.0], end.radius) };
    let one = Segment { width: turn * width, rise: rises[0], ..segment };
    let other = Segment {
        from: begin.approach + turn * width,
        width: (1.0 - turn) * width,
        start: middle,
        rise: rises[1],
        force: one.force_at(1.0),
        ..segment
    };
    vec![one, other]
}

/// Change of the force at the second of three states when it is left out.
fn left_out(nodes: &[Node]) -> f64 {
    let [begin, node, end] = [nodes[0], nodes[1], nodes[2]];
    let chord = (end.force - begin.force) / (2.0 * (end.approach - begin.approach));
    let without = Tabulated { segments: between(begin, end, chord), nodes: 2, doubts: Vec::new() };
    (without.force(node.approach) - node.force).abs()
}

fn shrinks(name: &'static str, value: f64, min: f64, max: f64) -> Error {
    let name = format!("{name} (an equivalent profile needs a contact that grows with the approach)");
    Error::OutOfRange { name: name.into(), value, min, max }
}

impl Segment {
    fn radius(&self, s: f64) -> f64 {
        let share = match self.form {
            TabulatedForm::Parabola(c) => s * (1.0 + c * (1.0 - s)),
            TabulatedForm::Power(m) => s.powf(m),
        };
        self.start + self.rise * share
    }

    /// `F/E*` at s.
    fn force_at(&self, s: f64) -> f64 {
        let share = match self.form {
            TabulatedForm::Parabola(c) => s * s * (0.5 + c * (0.5 - s / 3.0)),
            TabulatedForm::Power(m) => s.powf(m + 1.0) / (m + 1.0),
        };
        self.force + 2.0 * self.width * (self.start * s + self.rise * share)
    }

    /// The first s at which x is reached.
    fn inverse(&self, x: f64) -> f64 {
        if x <= self.start || self.rise <= 0.0 {
            return 0.0;
        }
        let share = ((x - self.start) / self.rise).min(1.0);
        match self.form {
            // The smaller root of c s^2 - (1 + c) s + share = 0.
            TabulatedForm::Parabola(c) => {
                let b = 1.0 + c;
                2.0 * share / (b + (b * b - 4.0 * c * share).max(0.0).sqrt())
            }
            TabulatedForm::Power(m) => share.powf(m.recip()),
        }
    }

    /// `int q dx` over a part of the segment, q being a quadratic of gamma.
    fn integral(&self, [low, high]: [f64; 2], q: impl Fn(f64) -> f64) -> f64 {
        let middle = 0.5 * (low + high);
        match self.form {
            TabulatedForm::Parabola(c) => {
                // q dx/ds is a cubic: Simpson's rule is exact.
                let slope = |gamma: f64| {
                    let s = (gamma - self.from) / self.width;
                    q(gamma) * (1.0 + c * (1.0 - 2.0 * s))
                };
                let sum = slope(low) + 4.0 * slope(middle) + slope(high);
                self.rise * ((high - low) / self.width) * sum / 6.0
            }
            TabulatedForm::Power(m) => {
                let position = |gamma: f64| self.radius(gamma / self.width);
                of_power(m.recip(), position, [low, high], [low, middle, high].map(q))
            }
        }
    }
}

impl Shape for std::sync::Arc<Tabulated> {
    fn radius(&self, gamma: f64) -> f64 {
        self.half_width(gamma)
    }

    fn integral(&self, [low, high]: [f64; 2], [first, middle, last]: [f64; 3]) -> f64 {
        let width = high - low;
        if width <= 0.0 {
            return 0.0;
        }
        let curve = 2.0 * (first - 2.0 * middle + last);
        let slope = last - first - curve;
        let q = |gamma: f64| {
            let s = (gamma - low) / width;
            first + s * (slope + s * curve)
        };
        // A flat face: all its springs touch at once.
        let face = if low <= 0.0 { self.segments.first().map_or(0.0, |segment| segment.start) } else { 0.0 };
        let from = self.segments.partition_point(|segment| segment.from + segment.width <= low);
        let segments = self.segments[from..].iter().take_while(|segment| segment.from < high);
        let sum: f64 = segments
            .filter(|segment| segment.rise > 0.0)
            .map(|segment| {
                let part = [low.max(segment.from), high.min(segment.from + segment.width)];
                if part[0] < part[1] { segment.integral(part, q) } else { 0.0 }
            })
            .sum();
        face * first + sum
    }

    fn kinks(&self, from: f64, to: f64) -> Vec<f64> {
        let begin = self.segments.partition_point(|segment| segment.from <= from);
        self.segments[begin..].iter().map(|segment| segment.from).take_while(|gamma| *gamma < to).collect()
    }
}

#[cfg(test)]
mod tests;
