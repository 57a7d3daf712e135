//! The bounds of the pressure: a cell is open (p = 0), free, or at its upper bound.

use super::candidates::Candidates;
use crate::geometry::CellSet;
use crate::law::{ConvexLaw, PressureRange};
use crate::real::{each, largest, smallest, sum, sum_of_pairs};
use std::borrow::Cow;

/// Largest number of rounds of scaling: each round brings a cell to its upper bound or is the last one.
const ROUNDS: usize = 100;

/// Sums of pressures whose relative difference is less than this are equal up to rounding ...
const ROUNDING: f64 = 1e-13;
/// ... and single pressures whose relative difference is less than this: many such roundings change their sum
/// by less than `ROUNDING`.
const CELL_ROUNDING: f64 = 2e-15;
/// A pressure counts as one of cells that are all open or at the upper bound where the sum of the deviations
/// is below this share of the force.
const WHOLE: f64 = 1e-12;
/// Where the cells at the upper bound carry more than the force, but by at most this share, the pressure of
/// one cell is reduced; beyond that the pressure of the whole contact is.
const SMALL: f64 = 1e-6;

/// The values that the pressure of a cell may have.
///
/// The least energy under bounds has p = 0 and g >= 0 on open cells, g = 0 on free ones, and g <= 0 on cells
/// at the upper bound, whose negative gap is the plastic indentation. A cell is at its upper bound exactly
/// where its pressure is that bound; no set is stored for it.
///
/// The outer iteration, its residuals and its certificate use only the methods of this type and those of the law
/// of a cell, [`PressureRange`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bounds {
    /// `0 <= p`.
    Unlimited,
    /// `0 <= p <= p_s`, with the same p_s on every cell.
    UpTo(f64),
}

/// The extreme gaps on all cells that could touch, under a pressure.
#[derive(Debug, Clone, Copy)]
pub struct Extremes {
    /// Largest penetration, or largest gap of a cell at its upper bound; 0 where there is neither.
    pub deepest: f64,
    /// Among all pressures q between the bounds with the same sum, the one with the least work `sum q g` is
    /// at the upper bound on the cells whose gap is below this one.
    pub level: f64,
    /// The part of that work that comes from open cells, over the sum of the pressure; gaps are measured from
    /// `level`.
    pub unfilled: f64,
}

impl Bounds {
    /// The upper bound; infinite where there is none.
    pub fn upper(self) -> f64 {
        match self {
            Self::Unlimited => f64::INFINITY,
            Self::UpTo(upper) => upper,
        }
    }

    /// The law of each cell.
    pub fn law(self) -> PressureRange {
        PressureRange { upper: self.upper() }
    }

    /// The bounds of a multiple of the pressure.
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Unlimited => self,
            Self::UpTo(upper) => Self::UpTo(factor * upper),
        }
    }

    /// Whether any cell is at its upper bound.
    pub fn is_reached(self, p: &[f64]) -> bool {
        matches!(self, Self::UpTo(upper) if largest(p) >= upper)
    }

    /// The free cells of a contact set.
    pub fn free<'a>(self, contact: &'a CellSet, p: &[f64]) -> Cow<'a, CellSet> {
        if self.is_reached(p) {
            Cow::Owned(contact.filter(p, |p| p < self.upper()))
        } else {
            Cow::Borrowed(contact)
        }
    }

    /// The values of the free cells of a contact set.
    pub fn of_free<'a>(self, p: &[f64], values: &'a [f64]) -> Cow<'a, [f64]> {
        if self.is_reached(p) {
            let free = p.iter().zip(values).filter(|&(&p, _)| p < self.upper());
            Cow::Owned(free.map(|(_, &v)| v).collect())
        } else {
            Cow::Borrowed(values)
        }
    }

    /// The cells that stay at the upper bound: those whose gap is no larger than `noise`.
    pub fn held(self, contact: &CellSet, p: &[f64], gap: &[f64], noise: f64) -> CellSet {
        if !self.is_reached(p) {
            return CellSet::default();
        }
        let at_bound = |(&p, &g): (&f64, &f64)| if p >= self.upper() { g } else { f64::INFINITY };
        let values: Vec<f64> = p.iter().zip(gap).map(at_bound).collect();
        contact.filter(&values, |g| g <= noise)
    }

    /// Brings a pressure between its bounds and, where a force is prescribed, to that force. Returns whether
    /// cells were added to the contact set to carry it.
    ///
    /// Cost: a few passes over the contact set; the whole grid where cells join.
    pub fn admit(
        self,
        contact: &mut CellSet,
        p: &mut Vec<f64>,
        force: Option<f64>,
        candidates: &Candidates,
    ) -> bool {
        if let Self::UpTo(upper) = self {
            round_to(upper, contact, p, force);
        }
        if let Some(force) = force
            && !self.is_reached(p)
        {
            rescale(p, force);
        }
        if !self.is_reached(p) {
            return false;
        }
        let upper = self.upper();
        each(p, |p| *p = p.min(upper));
        force.is_some_and(|force| bring_to(force, upper, contact, p, candidates))
    }

    /// The pressure after a correction on a set: cells in tension open, cells beyond the upper bound are
    /// brought back to it, and the `held` cells, which are not in the set, stay at it. Where a force is
    /// prescribed, the free cells carry the rest of it.
    pub fn corrected(
        self,
        set: &CellSet,
        mut p: Vec<f64>,
        held: &CellSet,
        force: Option<f64>,
    ) -> (CellSet, Vec<f64>) {
        let mut contact = set.filter(&p, |p| p > 0.0);
        p.retain(|&p| p > 0.0);
        if held.is_empty() && !self.is_reached(&p) {
            return (contact, p);
        }
        let upper = self.upper();
        if let Some(force) = force {
            scale_to(force - held.len() as f64 * upper, upper, &mut p);
            contact = contact.filter(&p, |p| p > 0.0);
            p.retain(|&p| p > 0.0);
        } else {
            each(&mut p, |p| *p = p.min(upper));
        }
        if held.is_empty() {
            return (contact, p);
        }
        let all = contact.union(held);
        p = all.carry(&contact, &p);
        all.add_carried(held, &vec![upper; held.len()], &mut p);
        (all, p)
    }

    /// The approach at which the mean gap of the free cells, weighted by their pressure, vanishes. Without
    /// free cells it is the approach up to which the lowest cells, all at their bound, carry the force.
    /// `displaced` is u + z on the contact set, `everywhere` on all cells that could touch. `None` without
    /// pressure.
    pub fn approach(self, p: &[f64], displaced: &[f64], everywhere: &[f64]) -> Option<f64> {
        let (upper, reached) = (self.upper(), self.is_reached(p));
        let carried =
            if reached { sum_of_pairs(p, p, |p, _| if p < upper { p } else { 0.0 }) } else { sum(p) };
        if carried > 0.0 {
            let share = |p, g| if p < upper { p / carried * g } else { 0.0 };
            return Some(sum_of_pairs(p, displaced, share));
        }
        reached.then(|| nth(everywhere.to_vec(), p.len()))
    }

    /// By how much the gap of a cell with this pressure violates the contact condition.
    pub fn violation(self, p: f64, gap: f64) -> f64 {
        if p >= self.upper() {
            gap.max(0.0)
        } else if p > 0.0 {
            gap.abs()
        } else {
            (-gap).max(0.0)
        }
    }

    /// The extremes of the gap on `everywhere` under a pressure of this sum on a part of it.
    ///
    /// Where no cell is at its upper bound, the bound is ignored: the duality gap is then that of the same
    /// pressure without a bound, which is an upper estimate.
    pub fn extremes(
        self,
        force: f64,
        (contact, p): (&CellSet, &[f64]),
        (everywhere, gap): (&CellSet, &[f64]),
    ) -> Extremes {
        if !self.is_reached(p) {
            let lowest = smallest(gap);
            return Extremes { deepest: (-lowest).max(0.0), level: lowest, unfilled: 0.0 };
        }
        let upper = self.upper();
        let shares = PressureRange { upper: upper / force };
        let level = nth(gap.to_vec(), (force / upper) as usize);
        let p = everywhere.carry(contact, p);
        let (mut deepest, mut unfilled) = (0.0_f64, 0.0);
        for (&p, &g) in p.iter().zip(gap) {
            deepest = deepest.max(if p >= upper { g } else { -g });
            if p <= 0.0 {
                unfilled += shares.excess(0, [0.0], [level - g]);
            }
        }
        Extremes { deepest, level, unfilled }
    }
}

/// The value that has `count` smaller ones, or the largest value.
fn nth(mut values: Vec<f64>, count: usize) -> f64 {
    let last = count.min(values.len() - 1);
    *values.select_nth_unstable_by(last, f64::total_cmp).1
}

/// Brings a pressure to a force.
fn rescale(p: &mut [f64], force: f64) {
    let sum = sum(p);
    if sum > 0.0 {
        let factor = force / sum;
        each(p, |p| *p *= factor);
    }
}

/// Pressures that are at the upper bound up to rounding become exactly that. Where the force equals that of k
/// cells at the bound up to rounding, and k cells carry it in this way, these are set to the bound and the
/// others are opened: otherwise rounding would decide which cells count as free.
fn round_to(upper: f64, contact: &mut CellSet, p: &mut Vec<f64>, force: Option<f64>) {
    if largest(p) < upper * (1.0 - WHOLE) {
        return;
    }
    each(p, |p| {
        if (*p - upper).abs() <= CELL_ROUNDING * upper {
            *p = upper;
        }
    });
    let Some(force) = force else { return };
    let cells = (force / upper).round();
    if (cells * upper - force).abs() > ROUNDING * force {
        return;
    }
    let carries = |p: f64| p >= 0.5 * upper;
    let away = sum_of_pairs(p, p, |p, _| if carries(p) { (upper - p).abs() } else { p });
    let count = p.iter().filter(|&&p| carries(p)).count();
    if away > 0.0 && away <= WHOLE * force && (count as f64 - cells).abs() < 0.5 {
        *contact = contact.filter(p, carries);
        *p = vec![upper; count];
    }
}

/// Scales a positive pressure and cuts it at the upper bound so that its sum is `wanted`. Where that is more
/// than the cells can carry, all are set to the bound.
///
/// The sum is a concave function of the factor: Newton's method from below takes at most one step for each
/// cell that reaches its bound.
fn scale_to(wanted: f64, upper: f64, p: &mut [f64]) {
    let mut factor = (wanted / sum(p)).max(0.0);
    for _ in 0..ROUNDS {
        let (mut full, mut rest) = (0, 0.0);
        for p in p.iter() {
            if p * factor >= upper {
                full += 1;
            } else {
                rest += p;
            }
        }
        let next = (wanted - f64::from(full) * upper) / rest;
        if rest <= 0.0 || next.is_nan() || next <= factor {
            break;
        }
        factor = next;
    }
    each(p, |p| *p = (*p * factor).min(upper));
}

/// Brings a pressure to a force: the free cells are scaled, those that pass the upper bound are left at it.
/// Where the contact set cannot carry the force, the next lowest cells are added. Where the cells at the
/// bound alone carry a little more than the force, the pressure of the one with the largest undeformed gap is
/// reduced. Returns whether cells were added.
fn bring_to(
    force: f64,
    upper: f64,
    contact: &mut CellSet,
    p: &mut Vec<f64>,
    candidates: &Candidates,
) -> bool {
    let mut grown = false;
    for _ in 0..ROUNDS {
        let full = p.iter().filter(|&&p| p >= upper).count();
        let total = sum(p);
        let rest = if full == 0 { total } else { total - full as f64 * upper };
        let wanted = force - full as f64 * upper;
        if wanted.abs() <= 2.0 * ROUNDING * force && total - force <= 2.0 * ROUNDING * force {
            return grown;
        }
        if wanted <= 0.0 && -wanted <= SMALL * force {
            // Scaled down, no cell would stay at its bound.
            let z = candidates.gaps(contact);
            let above = |a: &usize, b: &usize| z[*a].total_cmp(&z[*b]);
            if let Some(highest) = (0..p.len()).filter(|&i| p[i] >= upper).max_by(above) {
                each(p, |p| *p = if *p < upper { 0.0 } else { *p });
                p[highest] = (upper + wanted).max(0.0);
                *contact = contact.filter(p, |p| p > 0.0);
                p.retain(|&p| p > 0.0);
            }
            return grown;
        }
        if wanted <= 0.0 {
            let factor = force / total;
            each(p, |p| *p *= factor);
            return grown;
        }
        if full == p.len() || rest <= 0.0 {
            let joined = candidates.lowest_outside(contact, 1 + (wanted / upper) as usize);
            if joined.is_empty() {
                return grown;
            }
            grown = true;
            let share = (wanted / joined.len() as f64).min(upper);
            let all = contact.union(&joined);
            let mut pressure = all.carry(contact, p);
            all.add_carried(&joined, &vec![share; joined.len()], &mut pressure);
            (*contact, *p) = (all, pressure);
            continue;
        }
        let factor = wanted / rest;
        each(p, |p| {
            if *p < upper {
                *p = (*p * factor).min(upper);
            }
        });
        if p.iter().filter(|&&p| p >= upper).count() == full {
            return grown;
        }
    }
    grown
}

#[cfg(test)]
mod tests;
