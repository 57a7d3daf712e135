//! A line on independent springs, with exact force, approach and stiffness at any load.

use contact_model::{Error, Line, Nondimensionalisation, NormalLoad, Result};
use numerics::range::range;
use numerics::sum::Sum;

/// Elements per bin: small enough that sorting one bin costs microseconds, large enough that the bins stay in
/// cache.
const ELEMENTS_PER_BIN: usize = 512;
/// Most bins: as many write positions as the first two cache levels and their page tables follow.
const MOST_BINS: usize = 4096;
/// Independent partial sums and maxima: what a core computes side by side.
const LANES: usize = 8;

/// A line pressed by a rigid flat: `F(d)` and `k(d)` of independent springs of stiffness E* per length (Eq.
/// 16).
///
/// With `z = h_max - h` and elements of length `dx` the contact set is `{z < d}`, and
///
/// ```text
/// F = E* dx S(d),   S(d) = sum (d - z)+,   k = E* dx #(z < d).
/// ```
///
/// `S` is convex and piecewise linear with its kinks at the sorted `z`, so either of `F` and `d` follows from
/// the other by order statistics and prefix sums, without iteration. Only positive terms are summed: the
/// relative error of `S`, and of `d` from `F`, is a few units in the last place. An offset of the heights
/// cancels in `z`.
///
/// Building it costs O(n): one pass finds the highest element, one counts the elements per depth bin and one
/// groups them. A load then costs O(log n), and the first load that falls inside a bin also the sort of that
/// bin, about n/2048 elements. A line most of whose heights fall into one bin (a flat with one deep pit)
/// costs one full sort, O(n log n).
#[derive(Debug, Clone)]
pub struct Bearing {
    element: f64,
    /// `z` of all elements, grouped by bin, ascending from bin to bin; sorted inside a bin once `knots` of
    /// that bin are there.
    depths: Vec<f64>,
    bins: Vec<DepthBin>,
}

/// Elements of neighbouring depths.
#[derive(Debug, Clone)]
struct DepthBin {
    /// First and one past the last element in `depths`; `start` is the number of elements above this bin.
    start: usize,
    end: usize,
    /// Smallest and largest depth.
    low: f64,
    high: f64,
    /// `S` at these two.
    sum_low: f64,
    sum_high: f64,
    /// `S` at the depth of each element, ascending. Empty until a load falls inside the bin.
    knots: Vec<f64>,
}

/// One state of a [`Bearing`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Force F.
    pub force: f64,
    /// Approach d from first touch.
    pub approach: f64,
    /// Stiffness k = dF/dd on the contact set `{z < d}`.
    pub stiffness: f64,
    /// Number of elements in the contact set.
    pub elements: usize,
}

impl Bearing {
    /// Groups the elements of a line by depth.
    ///
    /// Cost: O(n); for 2^20 elements three passes and 8 MB.
    pub fn new(line: &Line) -> Self {
        let mut bearing = Self::empty();
        bearing.rebuild(line);
        bearing
    }

    /// An empty start for [`Bearing::rebuild`]; it must not be pressed.
    pub(crate) fn empty() -> Self {
        Self { element: 0.0, depths: Vec::new(), bins: Vec::new() }
    }

    /// As [`Bearing::new`] for another line, in the memory of this one.
    ///
    /// This saves time in a loop over long lines: fresh memory for 2^20 elements costs as much as grouping
    /// them.
    pub fn rebuild(&mut self, line: &Line) {
        let heights = line.heights();
        let (lowest, highest) = range(heights);
        let height = highest - lowest;
        let count = (heights.len() / ELEMENTS_PER_BIN).clamp(1, MOST_BINS);
        // Monotone in z, which is all that the grouping needs. Equal heights: 0 * inf is NaN, which the cast
        // turns into bin 0.
        let per_depth = count as f64 / height;
        let bin_of = |z: f64| ((z * per_depth) as usize).min(count - 1);

        let mut ends = vec![0_usize; count];
        for &h in heights {
            ends[bin_of(highest - h)] += 1;
        }
        let mut next = 0;
        let mut place = vec![0_usize; count];
        for (end, place) in ends.iter_mut().zip(&mut place) {
            *place = next;
            next += *end;
            *end = next;
        }
        self.depths.resize(heights.len(), 0.0);
        let depths = &mut self.depths;
        for &h in heights {
            let z = highest - h;
            let place = &mut place[bin_of(z)];
            depths[*place] = z;
            *place += 1;
        }
        self.bins = bins(depths, &ends);
        self.element = line.element();
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.depths.len()
    }

    /// The state under a load, on a foundation of stiffness `contact_modulus` per length.
    ///
    /// At a kink (`d` equal to some `z`) the elements at this depth touch without force and are not in the
    /// contact set. Without load `d = 0` and `k = 0`.
    ///
    /// # Errors
    /// [`Error::Domain`] for a load that is negative or not finite, a modulus that is not positive, or a
    /// result that no `f64` holds.
    ///
    /// ```
    /// use contact_model::{Line, NormalLoad};
    /// use mdr1d::Bearing;
    /// // Three springs of length 1 and modulus 2, at depths 0, 1 and 2. At d = 1.5 two of them carry 2 (1.5 + 0.5) = 4.
    /// let mut bearing = Bearing::new(&Line::new(3.0, vec![1.0, 2.0, 0.0])?);
    /// let s = bearing.press(NormalLoad::Approach(1.5), 2.0)?;
    /// assert_eq!((s.force, s.stiffness, s.elements), (4.0, 4.0, 2));
    /// assert_eq!(bearing.press(NormalLoad::Force(4.0), 2.0)?.approach, 1.5);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn press(&mut self, load: NormalLoad, contact_modulus: f64) -> Result<Support> {
        let nondimensional = Nondimensionalisation::new(contact_modulus, self.element, 1.0)?;
        let (force, approach, elements) = match load.validated()? {
            NormalLoad::Approach(d) => {
                let (sum, elements) = self.at_approach(d);
                (nondimensional.force(sum)?, d, elements)
            }
            NormalLoad::Force(force) => {
                let sum = nondimensional.force_in(force);
                if force > 0.0 && sum <= 0.0 {
                    return Err(Error::not_representable("approach", 0.0));
                }
                let (approach, elements) = self.at_sum(sum);
                (force, nondimensional.approach(approach)?, elements)
            }
            _ => return Err(Error::unsupported_load("mdr1d", load)),
        };
        let stiffness = nondimensional.stiffness(elements as f64)?;
        Ok(Support { force, approach, stiffness, elements })
    }

    /// `S(d)` and the number of elements with `z < d`.
    fn at_approach(&mut self, d: f64) -> (f64, usize) {
        let Some(b) = self.bins.partition_point(|bin| bin.low < d).checked_sub(1) else {
            return (0.0, 0);
        };
        if d > self.bins[b].high {
            let bin = &self.bins[b];
            return (bin.sum_high + bin.end as f64 * (d - bin.high), bin.end);
        }
        let (start, depths, knots) = self.sorted(b);
        let inside = depths.partition_point(|&z| z < d).max(1);
        let elements = start + inside;
        (knots[inside - 1] + elements as f64 * (d - depths[inside - 1]), elements)
    }

    /// `d` with `S(d) = sum`, and the number of elements with `z < d`.
    fn at_sum(&mut self, sum: f64) -> (f64, usize) {
        if sum <= 0.0 {
            return (0.0, 0);
        }
        let b = self.bins.partition_point(|bin| bin.sum_low < sum).max(1) - 1;
        if sum > self.bins[b].sum_high {
            let bin = &self.bins[b];
            return (bin.high + (sum - bin.sum_high) / bin.end as f64, bin.end);
        }
        let (start, depths, knots) = self.sorted(b);
        let inside = knots.partition_point(|&s| s < sum).max(1);
        let elements = start + inside;
        (depths[inside - 1] + (sum - knots[inside - 1]) / elements as f64, elements)
    }

    /// Elements above the bin, its sorted depths and its knots; sorts at the first call.
    fn sorted(&mut self, b: usize) -> (usize, &[f64], &[f64]) {
        let bin = &mut self.bins[b];
        let depths = &mut self.depths[bin.start..bin.end];
        if bin.knots.is_empty() {
            depths.sort_unstable_by(f64::total_cmp);
            let mut sum = Sum::from(bin.sum_low);
            let mut last = bin.low;
            bin.knots = (bin.start..)
                .zip(&*depths)
                .map(|(above, &z)| {
                    sum.add(above as f64 * (z - last));
                    last = z;
                    sum.value()
                })
                .collect();
        }
        (bin.start, depths, &bin.knots)
    }
}

/// Depth range and `S` at both ends of every bin that is not empty: `S` grows by `m (z' - z)` where `m`
/// elements bear from `z` to `z'`, and by `sum (high - z)` for those that lie in the bin itself. Every term
/// is positive.
fn bins(depths: &[f64], ends: &[usize]) -> Vec<DepthBin> {
    let mut sum = Sum::from(0.0);
    let (mut start, mut last) = (0, 0.0);
    let mut bins = Vec::with_capacity(ends.len());
    for &end in ends {
        let inside = &depths[start..end];
        if inside.is_empty() {
            continue;
        }
        let (low, high) = range(inside);
        sum.add(start as f64 * (low - last));
        let sum_low = sum.value();
        sum.add(start as f64 * (high - low));
        // Short partial sums first, then compensated: also a bin that holds the whole line loses nothing.
        for part in inside.chunks(ELEMENTS_PER_BIN) {
            let mut lanes = [0.0; LANES];
            let (groups, rest) = part.as_chunks::<LANES>();
            for group in groups {
                for (lane, z) in lanes.iter_mut().zip(group) {
                    *lane += high - z;
                }
            }
            sum.add(lanes.iter().sum::<f64>() + rest.iter().map(|z| high - z).sum::<f64>());
        }
        bins.push(DepthBin { start, end, low, high, sum_low, sum_high: sum.value(), knots: Vec::new() });
        (start, last) = (end, high);
    }
    bins
}

#[cfg(test)]
mod tests;
