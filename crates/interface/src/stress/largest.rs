//! The largest equivalent stress below the surface.

use super::load::{StressedBody, SurfaceLoad, scaled_depths};
use super::plan::SubsurfaceStress;
use contact_model::{Error, Result, Stop};

/// Width of the last bracket of the depth, over the first one. A maximum is flat, so that its value is good
/// to about the square of it.
const BRACKET: f64 = 1e-4;
/// Steps that a search may take; golden sections alone need 20.
const MOST_STEPS: usize = 40;

/// The largest equivalent stress of von Mises below a map, and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestVonMises {
    /// Its value; 0 without a load.
    pub value: f64,
    /// Its depth.
    pub depth: f64,
    /// Column and row of the cell.
    pub cell: [usize; 2],
    /// The centre of the cell, (x, y).
    pub centre: [f64; 2],
    /// The stress there: xx, yy, zz, yz, xz, xy.
    pub stress: [f64; 6],
}

impl LargestVonMises {
    /// The factor on all tractions at which this stress is a yield stress Y; `None` without a load, and where
    /// no `f64` holds it.
    ///
    /// It is the factor on the load of a contact only if all tractions grow alike. Those of most contacts do
    /// not: the largest pressure of Hertz's contact, for instance, grows with the cube root of its force.
    ///
    /// # Errors
    /// [`Error::Domain`] for a yield stress that is not positive.
    pub fn factor_until_yield(&self, yield_stress: f64) -> Result<Option<f64>> {
        if !(yield_stress.is_finite() && yield_stress > 0.0) {
            return Err(Error::of_positive("yield stress", yield_stress));
        }
        let factor = yield_stress / self.value;
        Ok((self.value > 0.0 && factor.is_finite() && factor > 0.0).then_some(factor))
    }
}

/// The largest equivalent stress of von Mises over all cells and depths.
///
/// The stress is computed at the depths given, and the depth is then refined between the neighbours of the
/// best one. The result is therefore the largest value at the centres of cells, of the maximum in the range
/// of depths that the samples point to. Samples have to be dense enough for the maximum that matters: that of
/// a patch of radius a is near 0.5 a, and rough contacts have patches of many sizes. Between centres the
/// stress may be larger by a share of the order of `(d/a)^2` for cells of side d.
///
/// Cost: that of one depth for each depth and for each of ten to twenty steps of the refinement. One depth is
/// kept.
///
/// # Errors
/// Those of [`SubsurfaceStress::new`] and [`SubsurfaceStress::at_depth`]; [`Error::Shape`] without depths.
///
/// ```
/// use contact_model::{Field, never};
/// use interface::stress::{StressedBody, SurfaceLoad, largest_von_mises};
/// // A uniform pressure on a square of side 1 in the middle of the map.
/// let square = (0..256).map(|i| f64::from((4..12).contains(&(i % 16)) && (4..12).contains(&(i / 16))));
/// let load = SurfaceLoad::new(Field::new(16, 2.0, square.collect())?)?;
/// let largest = largest_von_mises(&load, StressedBody::new(0.3), &[0.1, 0.2, 0.4, 0.8], &never)?;
/// assert!((0.2..0.6).contains(&largest.depth) && (0.5..0.8).contains(&largest.value));
/// assert_eq!(largest.factor_until_yield(2.0 * largest.value)?, Some(2.0));
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn largest_von_mises(
    load: &SurfaceLoad,
    body: StressedBody,
    depths: &[f64],
    stop: Stop<'_>,
) -> Result<LargestVonMises> {
    scaled_depths(load, depths)?;
    let plan = SubsurfaceStress::new(load, body)?;
    let mut sorted = depths.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let mut best = None;
    for (i, depth) in sorted.iter().enumerate() {
        let at_depth = largest_at(&plan, *depth, stop)?;
        if best.is_none_or(|(_, largest): (usize, LargestVonMises)| at_depth.value > largest.value) {
            best = Some((i, at_depth));
        }
    }
    let Some((i, largest)) = best else {
        return Err(Error::Shape { name: "depths".into(), found: 0, expected: "at least one depth".into() });
    };
    let bracket = [sorted[i.saturating_sub(1)], sorted[(i + 1).min(sorted.len() - 1)]];
    if largest.value > 0.0 && bracket[0] < bracket[1] {
        refined(largest, bracket, |depth| largest_at(&plan, depth, stop))
    } else {
        Ok(largest)
    }
}

fn largest_at(plan: &SubsurfaceStress<'_>, depth: f64, stop: Stop<'_>) -> Result<LargestVonMises> {
    let plane = plan.at_depth(depth, stop)?;
    let (value, [ix, iy]) = plane.largest_von_mises();
    if !value.is_finite() {
        return Err(Error::not_representable("von Mises' stress", value));
    }
    let (dx, dy) = (plan.load().pressure().dx(), plan.load().pressure().dy());
    let centre = [(ix as f64 + 0.5) * dx, (iy as f64 + 0.5) * dy];
    Ok(LargestVonMises { value, depth, cell: [ix, iy], centre, stress: plane.at(ix, iy) })
}

/// The largest value between two depths by Brent's method: parabolas through the last three depths, and
/// golden sections where they do not help (Brent, Algorithms for Minimization without Derivatives, 1973,
/// chapter 5).
fn refined(
    start: LargestVonMises,
    [mut low, mut high]: [f64; 2],
    mut at: impl FnMut(f64) -> Result<LargestVonMises>,
) -> Result<LargestVonMises> {
    /// `(3 - sqrt 5)/2`.
    const GOLDEN: f64 = 0.381_966_011_250_105;
    let tolerance = BRACKET * (high - low);
    let (mut best, mut second, mut third) = (start, start, start);
    let (mut step, mut last) = (0.0_f64, 0.0_f64);
    for _ in 0..MOST_STEPS {
        let (x, middle) = (best.depth, f64::midpoint(low, high));
        if (x - middle).abs() <= 2.0 * tolerance - 0.5 * (high - low) {
            break;
        }
        let parabola = {
            let (w, v) = (second.depth - x, third.depth - x);
            let (fw, fv) = (best.value - second.value, best.value - third.value);
            let (p, q) = (w * w * fv - v * v * fw, 2.0 * (w * fv - v * fw));
            p / q
        };
        let inside = low < x + parabola && x + parabola < high;
        let next = if inside && parabola.abs() < 0.5 * last.abs() {
            parabola
        } else {
            let far = if x < middle { high } else { low };
            step = far - x;
            GOLDEN * step
        };
        (last, step) = (step, next);
        let moved = if next.abs() < tolerance { tolerance.copysign(next) } else { next };
        let moved = (x + moved).clamp(low, high);
        let tried = at(moved)?;
        if tried.value >= best.value {
            *(if moved >= x { &mut low } else { &mut high }) = x;
            (third, second, best) = (second, best, tried);
        } else {
            *(if moved < x { &mut low } else { &mut high }) = moved;
            if tried.value >= second.value || second.depth.to_bits() == x.to_bits() {
                (third, second) = (second, tried);
            } else if tried.value >= third.value || third.depth.to_bits() == x.to_bits() {
                third = tried;
            }
        }
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(function: impl Fn(f64) -> f64, start: f64, bracket: [f64; 2]) -> (f64, usize) {
        let at = |depth: f64| LargestVonMises {
            value: function(depth),
            depth,
            cell: [0, 0],
            centre: [0.0; 2],
            stress: [0.0; 6],
        };
        let mut steps = 0;
        let best = refined(at(start), bracket, |depth| {
            assert!((bracket[0]..=bracket[1]).contains(&depth));
            steps += 1;
            Ok(at(depth))
        });
        (best.unwrap().depth, steps)
    }

    #[test]
    fn maxima_inside_at_kinks_and_at_ends() {
        for start in [0.5, 0.9, 2.0] {
            let (depth, steps) = found(|z| z * (-z).exp(), start, [0.3, 2.5]);
            assert!((depth - 1.0).abs() < 2.0 * BRACKET * 2.2 && steps <= 18, "{start}: {depth} in {steps}");
            let (depth, steps) = found(|z| 3.0 - (z - 1.2).abs(), start, [0.3, 2.5]);
            assert!((depth - 1.2).abs() < 2.0 * BRACKET * 2.2 && steps <= 30, "{start}: {depth} in {steps}");
        }
        let (depth, _) = found(|z| -z, 0.0, [0.0, 1.0]);
        assert!(depth <= 0.0);
        let (depth, _) = found(|z| z, 1.0, [0.0, 1.0]);
        assert!(depth >= 1.0);
        // A value that is the same everywhere ends too.
        assert!(found(|_| 1.0, 0.5, [0.0, 1.0]).1 <= MOST_STEPS);
    }
}
