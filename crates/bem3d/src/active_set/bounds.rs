//! The upper bound of the pressure: cells at the hardness are saturated, their gap is negative by the plastic indentation.
//!
//! Open cells have p = 0 and g >= 0, elastic ones g = 0, saturated ones p = p_s and g <= 0: the conditions of `0 <= p <= p_s`. A cell is
//! saturated exactly where its pressure is p_s. Without a hardness p_s is infinite, and nothing here is called but
//! [`is_saturated`] and [`saturate`], which return at once.

use super::candidates::Candidates;
use super::residuals::Residuals;
use crate::geometry::CellSet;
use crate::real::{each, largest, sum, sum_of_pairs};
use std::borrow::Cow;

/// Rounds of scaling at most: each saturates a cell or is the last one.
const ROUNDS: usize = 100;

/// Sums of pressures that differ by less than this share differ by rounding ...
const ROUNDING: f64 = 1e-13;
/// ... and pressures by less than this one: rounding many of them leaves their sum within the other.
const CELL_ROUNDING: f64 = 2e-15;
/// A pressure is that of whole saturated cells where its cells are off by this share of the force in all.
const WHOLE: f64 = 1e-12;
/// Where saturated cells carry more than the force by at most this share, one of them gives way; by more, all of the contact does.
const SMALL: f64 = 1e-6;

/// Pressures that are at the hardness up to rounding become exactly that. Where rounding alone tells the force from that of k saturated
/// cells, and k cells carry it so, they saturate and the others open: rounding would otherwise decide which cells count as elastic.
pub fn saturate(contact: &mut CellSet, p: &mut Vec<f64>, force: Option<f64>, hardness: f64) {
    if hardness.is_infinite() || largest(p) < hardness * (1.0 - WHOLE) {
        return;
    }
    each(p, |p| {
        if (*p - hardness).abs() <= CELL_ROUNDING * hardness {
            *p = hardness;
        }
    });
    let Some(force) = force else { return };
    let cells = (force / hardness).round();
    if (cells * hardness - force).abs() > ROUNDING * force {
        return;
    }
    let carries = |p: f64| p >= 0.5 * hardness;
    let away = sum_of_pairs(p, p, |p, _| if carries(p) { (hardness - p).abs() } else { p });
    let count = p.iter().filter(|&&p| carries(p)).count();
    if away > 0.0 && away <= WHOLE * force && (count as f64 - cells).abs() < 0.5 {
        *contact = contact.filter(p, carries);
        *p = vec![hardness; count];
    }
}

/// Whether any cell is saturated.
pub fn is_saturated(p: &[f64], hardness: f64) -> bool {
    hardness.is_finite() && largest(p) >= hardness
}

/// The cells below the hardness.
pub fn elastic<'a>(contact: &'a CellSet, p: &[f64], hardness: f64) -> Cow<'a, CellSet> {
    if is_saturated(p, hardness) {
        Cow::Owned(contact.filter(p, |p| p < hardness))
    } else {
        Cow::Borrowed(contact)
    }
}

/// The saturated cells that stay so: those whose gap is no larger than `noise`.
pub fn kept(contact: &CellSet, p: &[f64], gap: &[f64], hardness: f64, noise: f64) -> CellSet {
    let values: Vec<f64> =
        p.iter().zip(gap).map(|(&p, &g)| if p >= hardness { g } else { f64::INFINITY }).collect();
    contact.filter(&values, |g| g <= noise)
}

/// The values of the cells below the hardness.
pub fn of_elastic(p: &[f64], values: &[f64], hardness: f64) -> Vec<f64> {
    p.iter().zip(values).filter(|&(&p, _)| p < hardness).map(|(_, &v)| v).collect()
}

/// Scales a positive pressure and cuts it at the hardness so that its sum is `sum`; where that is more than the cells carry, all saturate.
///
/// The sum is a concave function of the factor: Newton's method from below ends after as many steps as cells saturate in turn.
pub fn scale_to(p: &mut [f64], wanted: f64, hardness: f64) {
    let mut factor = (wanted / sum(p)).max(0.0);
    for _ in 0..ROUNDS {
        let (mut saturated, mut rest) = (0, 0.0);
        for p in p.iter() {
            if p * factor >= hardness {
                saturated += 1;
            } else {
                rest += p;
            }
        }
        let next = (wanted - f64::from(saturated) * hardness) / rest;
        if rest <= 0.0 || next.is_nan() || next <= factor {
            break;
        }
        factor = next;
    }
    each(p, |p| *p = (*p * factor).min(hardness));
}

/// Brings a pressure to a force: the cells below the hardness are scaled, those that pass it saturate. Where the contact set cannot carry
/// the force, the next lowest cells join it. Whether any did. Where the saturated cells alone carry a little more than the force, the one
/// with the largest undeformed gap gives way.
///
/// Cost: a few passes over the contact set; the whole grid where cells join.
pub fn bring_to(
    contact: &mut CellSet,
    p: &mut Vec<f64>,
    force: f64,
    hardness: f64,
    candidates: &Candidates,
) -> bool {
    let mut grown = false;
    for _ in 0..ROUNDS {
        let saturated = p.iter().filter(|&&p| p >= hardness).count();
        let total = sum(p);
        let rest = if saturated == 0 { total } else { total - saturated as f64 * hardness };
        let wanted = force - saturated as f64 * hardness;
        if wanted.abs() <= 2.0 * ROUNDING * force && total - force <= 2.0 * ROUNDING * force {
            return grown;
        }
        if wanted <= 0.0 && -wanted <= SMALL * force {
            // Scaled down, no cell would stay saturated.
            let z = candidates.gaps(contact);
            let above = |a: &usize, b: &usize| z[*a].total_cmp(&z[*b]);
            if let Some(highest) = (0..p.len()).filter(|&i| p[i] >= hardness).max_by(above) {
                each(p, |p| *p = if *p < hardness { 0.0 } else { *p });
                p[highest] = (hardness + wanted).max(0.0);
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
        if saturated == p.len() || rest <= 0.0 {
            let joined = candidates.lowest_outside(contact, 1 + (wanted / hardness) as usize);
            if joined.is_empty() {
                return grown;
            }
            grown = true;
            let share = (wanted / joined.len() as f64).min(hardness);
            let all = contact.union(&joined);
            let mut pressure = all.carry(contact, p);
            all.add_carried(&joined, &vec![share; joined.len()], &mut pressure);
            (*contact, *p) = (all, pressure);
            continue;
        }
        let factor = wanted / rest;
        each(p, |p| {
            if *p < hardness {
                *p = (*p * factor).min(hardness);
            }
        });
        if p.iter().filter(|&&p| p >= hardness).count() == saturated {
            return grown;
        }
    }
    grown
}

/// Shortens a step where the energy `p (u/2 + z)` passes its minimum on the way, before the share `whole` of it: the new pressure and its u + z become those of the minimum.
/// The old ones are a pressure, the gap under it and its approach, all on the same cells. The share that is left, if it was shortened.
///
/// Sets that follow from each other may alternate for ever without it. Both pressures obey the bounds and have the same force, and so has
/// every pressure between them; u is linear. A step that was cut at the bounds need not begin downhill, though: nothing is left of a step
/// that begins at its minimum, and the next one is the same again. See [`super::descent`].
pub fn shorten(old: (Vec<f64>, &[f64], f64), new: (&mut [f64], &mut [f64]), whole: f64) -> Option<f64> {
    let ((before, gap, d), (p, displaced)) = (old, new);
    let (mut first, mut last) = (0.0, 0.0);
    for i in 0..p.len() {
        let change = p[i] - before[i];
        if change != 0.0 {
            first += change * gap[i];
            last += change * (displaced[i] - d);
        }
    }
    let share = first / (first - last);
    // The energy is convex. Errors of the gaps can make it look concave: the share is then negative, and the step would go back.
    if !(first < 0.0 && last > 0.0 && share < whole) {
        return None;
    }
    for i in 0..p.len() {
        p[i] = before[i] + share * (p[i] - before[i]);
        displaced[i] = gap[i] + d + share * (displaced[i] - (gap[i] + d));
    }
    Some(share)
}

/// The approach under which the gaps of the cells below the hardness vanish on average, weighted by their pressure. Without such cells the
/// one up to which the lowest cells carry the force at the hardness. `displaced` is u + z on the contact set, `everywhere` on all cells that
/// could touch.
pub fn approach(p: &[f64], displaced: &[f64], everywhere: &[f64], hardness: f64) -> f64 {
    let below = || p.iter().zip(displaced).filter(|&(&p, _)| p < hardness);
    let total: f64 = below().map(|(p, _)| p).sum();
    if total > 0.0 {
        return below().map(|(p, g)| p / total * g).sum();
    }
    let mut values = everywhere.to_vec();
    let last = p.len().min(values.len() - 1);
    *values.select_nth_unstable_by(last, f64::total_cmp).1
}

/// Residuals of a pressure p with the gap g on all cells that could touch, both on the same cells.
///
/// The duality gap is `sum p g - min sum q g` over all `0 <= q <= p_s` of the same sum: the lowest cells at p_s.
pub fn residuals(p: &[f64], gap: &[f64], hardness: f64, s: f64) -> Residuals {
    let force = sum(p);
    let (mut deepest, mut weighted) = (0.0_f64, 0.0);
    for (&p, &g) in p.iter().zip(gap) {
        if p >= hardness {
            deepest = deepest.max(g);
            weighted += p / force * g.max(0.0);
        } else {
            deepest = deepest.max(-g);
            weighted += p / force * g.abs();
        }
    }
    let mut cells: Vec<(f64, f64)> = gap.iter().copied().zip(p.iter().copied()).collect();
    let full = ((force / hardness) as usize).min(cells.len().saturating_sub(1));
    let mut duality = 0.0;
    if !cells.is_empty() {
        cells.select_nth_unstable_by(full, |a, b| a.0.total_cmp(&b.0));
        for (i, &(g, p)) in cells.iter().enumerate() {
            let q = match i.cmp(&full) {
                std::cmp::Ordering::Less => hardness,
                std::cmp::Ordering::Equal => force - full as f64 * hardness,
                std::cmp::Ordering::Greater => 0.0,
            };
            // Gaps of cells without pressure may be infinite.
            if p - q != 0.0 {
                duality += (p - q) / force * g;
            }
        }
    }
    Residuals {
        duality_gap: duality.max(0.0) / s,
        penetration: deepest / s,
        complementarity: weighted / s,
        deepest,
    }
}

#[cfg(test)]
mod tests;
