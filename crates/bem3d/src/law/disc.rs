//! The law of friction: the traction of a cell lies in a disc.
//!
//! Vectors are in units of about the largest limit, so that squares do not overflow and those that underflow are
//! negligible.

use super::definition::ConvexLaw;
use crate::tuning::{CHUNK, LANES};
use numerics::parallel::map;

/// Newton's steps at most to the multiplier of a force; a handful are usual, some sixty where the force is
/// within a billionth of the largest one.
const STEPS: usize = 200;
/// A force is met where it is off by less than this share of the tractions together: the rounding of a sum.
const ROUNDING: f64 = 2e-15;
/// Evaluations of a line search at most, and the share of the first slope at which it ends.
const SEARCH: usize = 30;
/// See `SEARCH`.
const FLAT: f64 = 0.3;
/// Longest step in units of the vectors and of the multiplier itself.
const LONGEST: f64 = 4.0;

/// The sum of a vector field.
pub fn total(v: &[f64]) -> [f64; 2] {
    let (x, y) = v.split_at(v.len() / 2);
    [crate::real::sum(x), crate::real::sum(y)]
}

/// Sums over the cells of `term`, which takes the vectors of two fields and a number.
pub fn sums<const N: usize>(
    (a, b): (&[f64], &[f64]),
    limit: &[f64],
    term: impl Fn([f64; 2], [f64; 2], f64) -> [f64; N] + Sync,
) -> [f64; N] {
    let n = limit.len();
    let ((ax, ay), (bx, by)) = (a.split_at(n), b.split_at(n));
    let chunks = ax.chunks(CHUNK).zip(ay.chunks(CHUNK)).zip(bx.chunks(CHUNK).zip(by.chunks(CHUNK)));
    let parts = map(n, chunks.zip(limit.chunks(CHUNK)), |(((ax, ay), (bx, by)), limit)| {
        let whole = limit.len() / LANES * LANES;
        let mut lanes = [[0.0; LANES]; N];
        for start in (0..whole).step_by(LANES) {
            let of = |v: &[f64]| -> [f64; LANES] { std::array::from_fn(|lane| v[start + lane]) };
            let (ax, ay, bx, by, limit) = (of(ax), of(ay), of(bx), of(by), of(limit));
            for lane in 0..LANES {
                let terms = term([ax[lane], ay[lane]], [bx[lane], by[lane]], limit[lane]);
                for (lanes, term) in lanes.iter_mut().zip(terms) {
                    lanes[lane] += term;
                }
            }
        }
        let mut sums = lanes.map(|lanes| lanes.iter().sum::<f64>());
        for i in whole..limit.len() {
            for (sum, term) in sums.iter_mut().zip(term([ax[i], ay[i]], [bx[i], by[i]], limit[i])) {
                *sum += term;
            }
        }
        Some(sums)
    });
    let mut sums = [0.0; N];
    for part in parts.into_iter().flatten() {
        sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
    }
    sums
}

/// The length of a vector; squares may underflow.
pub fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// `|q| <= limit`, with a limit for each cell.
#[derive(Debug, Clone, Copy)]
pub struct Discs<'a> {
    /// The largest traction of each cell.
    pub limit: &'a [f64],
}

/// A vector counts as one within its disc where it is shorter than the limit by this share.
const WITHIN: f64 = 1e-12;

impl ConvexLaw<2> for Discs<'_> {
    fn nearest(&self, i: usize, q: [f64; 2]) -> [f64; 2] {
        within(q, self.limit[i])
    }

    fn project(&self, q: &mut [f64], force: Option<[f64; 2]>) {
        let shift = force.map_or([0.0; 2], |force| self.multiplier(q, force, [0.0; 2]));
        project(q, self.limit, shift);
    }

    fn held(&self, i: usize, [x, y]: [f64; 2], [vx, vy]: [f64; 2]) -> Option<f64> {
        let (size, limit) = (length([x, y]), self.limit[i]);
        if size < limit * (1.0 - WITHIN) {
            return None;
        }
        if size <= 0.0 {
            return Some(0.0);
        }
        // Along the circle, and into the disc.
        let (along, across) = ((vy * x - vx * y) / size, (vx * x + vy * y) / size);
        Some(along.powi(2) + across.min(0.0).powi(2))
    }

    fn room(&self, i: usize, [x, y]: [f64; 2], [cx, cy]: [f64; 2]) -> f64 {
        // |q + s c| = limit, by the form of the root that does not cancel.
        let (square, half) = (cx * cx + cy * cy, x * cx + y * cy);
        let missing = (self.limit[i].powi(2) - (x * x + y * y)).max(0.0);
        let root = (half * half + square * missing).sqrt();
        if square <= 0.0 {
            f64::INFINITY
        } else if half > 0.0 {
            missing / (half + root)
        } else {
            (root - half) / square
        }
    }

    /// Nothing: what is nearer to its circle than rounding counts as on it.
    fn meet(&self, _: &mut [f64], _: &[f64]) {}

    fn excess(&self, i: usize, q: [f64; 2], v: [f64; 2]) -> f64 {
        excess(q, v, self.limit[i])
    }
}

/// `b |v| - q v`: the part of a cell in the duality gap.
pub fn excess([x, y]: [f64; 2], [vx, vy]: [f64; 2], limit: f64) -> f64 {
    (limit * length([vx, vy]) - x * vx - y * vy).max(0.0)
}

/// The nearest vector to one within a disc.
fn within([x, y]: [f64; 2], limit: f64) -> [f64; 2] {
    // Rounding does not lead out of the disc.
    let (length, most) = (length([x, y]), limit * (1.0 - 2.0 * f64::EPSILON));
    let scale = if length <= most { 1.0 } else { most / length };
    [x * scale, y * scale]
}

/// Moves each vector by `shift` and to the nearest one within its disc.
fn project(v: &mut [f64], limit: &[f64], shift: [f64; 2]) {
    let n = limit.len();
    let (x, y) = v.split_at_mut(n);
    let chunks = x.chunks_mut(CHUNK).zip(y.chunks_mut(CHUNK)).zip(limit.chunks(CHUNK));
    map(n, chunks, |((x, y), limit)| {
        for ((x, y), &limit) in x.iter_mut().zip(y).zip(limit) {
            [*x, *y] = within([*x + shift[0], *y + shift[1]], limit);
        }
    });
}

/// A step of Newton's method to a multiplier.
#[derive(Debug, Clone, Copy)]
struct MultiplierStep {
    /// The shift where it begins.
    shift: [f64; 2],
    step: [f64; 2],
    /// The largest share of it that may be taken.
    whole: f64,
    /// The derivatives at its beginning, where the function falls along it.
    now: [f64; 5],
}

impl Discs<'_> {
    /// The shift with which the projections of some vectors add up to a force.
    ///
    /// It is where the gradient of a convex function vanishes: `sum h(v + shift) - force . shift`, where `h(z)` is
    /// `z^2/2` within the disc and `b |z| - b^2/2` outside. Newton's method finds it, with a line search on the
    /// slope, which rounding leaves more digits than the value. A force of more than the sum of the limits has none;
    /// there and just below it the last shift is given.
    ///
    /// Cost: O(n) a step.
    pub fn multiplier(&self, v: &[f64], force: [f64; 2], start: [f64; 2]) -> [f64; 2] {
        let limit = self.limit;
        let [tractions] = sums((v, v), limit, |v, _, b| [length(v).min(b)]);
        let rounding = ROUNDING * tractions.max(force[0].hypot(force[1]));
        let size = crate::real::largest(v) + crate::real::largest(limit);
        let mut shift = start;
        let mut now = self.evaluate(v, force, shift);
        for _ in 0..STEPS {
            let [gx, gy, xx, yy, xy] = now;
            if gx.hypot(gy) <= rounding {
                break;
            }
            // A tiny share of the trace keeps directions without resistance finite.
            let hair = 1e-14 * (xx + yy) + f64::MIN_POSITIVE;
            let (xx, yy) = (xx + hair, yy + hair);
            let determinant = xx * yy - xy * xy;
            let step = [(xy * gy - yy * gx) / determinant, (xy * gx - xx * gy) / determinant];
            let longest = LONGEST * (size + shift[0].hypot(shift[1]));
            let whole = (longest / step[0].hypot(step[1])).min(1.0);
            if !whole.is_finite() {
                break;
            }
            let (share, next) = self.share_of_step(v, force, MultiplierStep { shift, step, whole, now });
            shift = [shift[0] + share * step[0], shift[1] + share * step[1]];
            if share * step[0].hypot(step[1]) <= f64::EPSILON * shift[0].hypot(shift[1]) {
                break;
            }
            now = next;
        }
        shift
    }

    /// Gradient `[x, y]` and second derivatives `[xx, yy, xy]` of the function at a shift.
    fn evaluate(&self, v: &[f64], force: [f64; 2], [sx, sy]: [f64; 2]) -> [f64; 5] {
        let mut all = sums((v, v), self.limit, |[x, y], _, b| {
            let (x, y) = (x + sx, y + sy);
            let length = length([x, y]);
            let outside = length > b;
            let share = if outside { b / length } else { 1.0 };
            let (ex, ey) = if outside { (x / length, y / length) } else { (0.0, 0.0) };
            [share * x, share * y, share * (1.0 - ex * ex), share * (1.0 - ey * ey), -share * ex * ey]
        });
        all[0] -= force[0];
        all[1] -= force[1];
        all
    }

    /// The share of a step at which the slope along it has nearly vanished, and the derivatives there.
    fn share_of_step(&self, v: &[f64], force: [f64; 2], from: MultiplierStep) -> (f64, [f64; 5]) {
        let MultiplierStep { shift, step, whole, now } = from;
        let begin = now[0] * step[0] + now[1] * step[1];
        // The slope rises along the step, from `begin < 0`.
        let (mut low, mut high) = ((0.0, begin), None);
        let mut share = whole;
        let mut next = now;
        for _ in 0..SEARCH {
            next = self.evaluate(v, force, [shift[0] + share * step[0], shift[1] + share * step[1]]);
            let slope = next[0] * step[0] + next[1] * step[1];
            if slope <= FLAT * begin.abs() && (slope >= -FLAT * begin.abs() || share >= whole) {
                break;
            }
            if slope > 0.0 {
                high = Some((share, slope));
            } else {
                low = (share, slope);
            }
            let Some(high) = high else { break };
            let (width, weight) = (high.0 - low.0, low.1 / (low.1 - high.1));
            share = low.0 + width * weight.clamp(0.1, 0.9);
        }
        (share, next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projections_by_hand() {
        // 3-4-5: the vector of length 5 in a disc of radius 2.5, one that is inside, and one that is moved there.
        let mut v = [3.0, 0.1, -1.0, 4.0, 0.2, 0.0];
        project(&mut v, &[2.5, 1.0, 1.0], [0.0, 0.0]);
        approx::assert_relative_eq!(v[..], [1.5, 0.1, -1.0, 2.0, 0.2, 0.0], max_relative = 1e-15);
        let mut v = [1.5, 0.1, -1.0, 2.0, 0.2, 0.0];
        project(&mut v, &[0.0, 10.0, 10.0], [1.0, -2.0]);
        approx::assert_relative_eq!(v[..], [0.0, 1.1, 0.0, -0.0, -1.8, -2.0], max_relative = 1e-15);
        // Never outside, whatever the rounding.
        for k in 0..1000 {
            let angle = f64::from(k) * 0.7;
            let [x, y] = within([angle.cos() * 7.3, angle.sin() * 1.9], 0.3);
            assert!(x.hypot(y) <= 0.3);
        }
    }

    #[test]
    fn the_way_to_the_circle_by_hand() {
        let law = Discs { limit: &[5.0] };
        // Outwards from the middle, outwards and inwards from 3, and along the other axis: 3-4-5.
        assert!((law.room(0, [0.0, 0.0], [0.0, 2.0]) - 2.5).abs() < 1e-15);
        assert!((law.room(0, [3.0, 0.0], [1.0, 0.0]) - 2.0).abs() < 1e-15);
        assert!((law.room(0, [3.0, 0.0], [-1.0, 0.0]) - 8.0).abs() < 1e-15);
        assert!((law.room(0, [3.0, 0.0], [0.0, 1.0]) - 4.0).abs() < 1e-15);
        // From the circle itself across the disc, where the other form of the root is 0/0.
        assert!((law.room(0, [5.0, 0.0], [-1.0, 0.0]) - 10.0).abs() < 1e-14);
        assert!(law.room(0, [3.0, 0.0], [0.0, 0.0]).is_infinite());
    }

    #[test]
    fn projections_add_up_to_the_force() {
        let n = 50;
        let limit: Vec<f64> = (0..n).map(|k| (0.3 * f64::from(k)).sin().powi(2) + 0.01).collect();
        let v: Vec<f64> = (0..2 * n).map(|k| (1.7 * f64::from(k)).cos()).collect();
        let most = crate::real::sum(&limit);
        for share in [0.0, 0.3, -0.7, 0.99, 1.0 - 1e-6, 1.0 - 1e-9] {
            for angle in [0.0_f64, 1.0, 2.5] {
                let force = [share * most * angle.cos(), share * most * angle.sin()];
                let mut q = v.clone();
                Discs { limit: &limit }.project(&mut q, Some(force));
                let [x, y] = total(&q);
                let off = (x - force[0]).hypot(y - force[1]);
                assert!(off < 1e-13 * most, "{share} {angle}: {off}");
            }
        }
    }
}
