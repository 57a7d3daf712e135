//! Height differences over distances: structure function and autocorrelation.

use crate::bins::Bins;
use crate::relative::{Relative, finite};
use contact_model::{Boundary, Cells, HeightMap, Result};
use numerics::fourier::{ForwardTransform, InverseTransform, fast_length};

/// Half the mean square height difference over the distances of a curve; the values of each index belong
/// together.
///
/// `A(r) = <[h(x + r) - h(x)]^2>/2`; the structure function is `2 A`, the autocorrelation of a homogeneous
/// surface `R(r) = h_rms^2 - A(r)`, and its rms slope over the distance r is `sqrt(2 A)/r`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeightDifference {
    /// Mean distance of the pairs, a length.
    pub distance: Vec<f64>,
    /// A, in the square of a length.
    pub half_square: Vec<f64>,
    /// Number of pairs of defined points in each average; each pair counts once.
    pub pairs: Vec<f64>,
}

impl HeightDifference {
    /// The slope over each distance, `sqrt(2 A(r))/r`, dimensionless: rms over the pairs and their
    /// directions.
    ///
    /// Source: Sanner, Noehring, Thimons, Jacobs, Pastewka, Appl. Surf. Sci. Adv. 7, 100190 (2022), Eq. 14.
    pub fn slope(&self) -> Vec<f64> {
        self.half_square.iter().zip(&self.distance).map(|(a, r)| (2.0 * a).sqrt() / r).collect()
    }
}

/// Half the mean square height difference of all pairs of points of a map, by the vector between them.
#[derive(Debug, Clone)]
pub struct DifferenceMap {
    periodic: bool,
    cells: Cells,
    sides: [f64; 2],
    unit: f64,
    /// Length of the transforms.
    lengths: [usize; 2],
    /// Mean halves of squares and mean products in `unit^2` and numbers of pairs, with the lags of a
    /// transform.
    values: Vec<[f64; 3]>,
}

impl DifferenceMap {
    /// Averages over all pairs of defined points: with [`Boundary::Free`] those inside the map, with
    /// [`Boundary::Periodic`] also those across its edges.
    ///
    /// The averages follow from Fourier transforms of the heights, their squares and the pattern of defined
    /// points; free maps are padded with zeros. Cost O(N log N), memory 60 bytes for each point, 200 for free
    /// maps. Values below about 1e-14 of the mean square height are rounding errors.
    pub fn new(map: &HeightMap, boundary: Boundary) -> Self {
        let periodic = boundary == Boundary::Periodic;
        let Relative { heights, unit } = Relative::new(map);
        let cells = map.cells();
        let lengths =
            [cells.columns, cells.rows].map(|n| if periodic { n } else { fast_length(2 * n - 1, 1) });
        let [width, height] = lengths;
        let count = map.heights().len() - map.undefined();
        let mean = heights.iter().filter(|h| !h.is_nan()).sum::<f64>() / count as f64;
        let forward = ForwardTransform::new(width, height);
        let transform = |of: &dyn Fn(f64) -> f64| {
            forward.of(|iy, row| {
                let heights = heights.chunks_exact(cells.columns).nth(iy).unwrap_or_default();
                for (value, h) in row.iter_mut().zip(heights).filter(|(_, h)| !h.is_nan()) {
                    *value = of(h - mean);
                }
            })
        };
        let (pattern, plain, squares) = (transform(&|_| 1.0), transform(&|h| h), transform(&|h| h * h));
        // Even sequences have real transforms.
        let inverse = InverseTransform::new(width, height);
        let sums = |of: &(dyn Fn(usize) -> f64 + Sync)| {
            inverse.of(width / 2 + 1, |mx, column| {
                for (iy, value) in column.iter_mut().enumerate() {
                    *value = of(mx * height + iy).into();
                }
            })
        };
        let pairs = sums(&|k| pattern[k].norm_sqr());
        let halves = sums(&|k| (pattern[k].conj() * squares[k]).re - plain[k].norm_sqr());
        drop((pattern, squares));
        let products = sums(&|k| plain[k].norm_sqr());
        drop(plain);
        let scale = (pairs.len() as f64).recip();
        let value = |((pairs, half), product): ((f64, f64), f64)| {
            let pairs = (pairs * scale).round();
            if pairs > 0.0 {
                [(half * scale / pairs).max(0.0), product * scale / pairs, pairs]
            } else {
                [0.0; 3]
            }
        };
        let mut values: Vec<[f64; 3]> = pairs.into_iter().zip(halves).zip(products).map(value).collect();
        // A point and itself differ by nothing, not by rounding.
        values[0][0] = 0.0;
        Self { periodic, cells, sides: [map.dx(), map.dy()], unit, lengths, values }
    }

    /// A and the number of pairs for the vector `lag`, in cells along x and y; `None` for a vector that is
    /// longer than the map or has no pair of defined points.
    pub fn at(&self, lag: [isize; 2]) -> Option<[f64; 2]> {
        let [value, _, pairs] = self.found(lag)?;
        let root = value.sqrt() * self.unit;
        Some([root * root, pairs])
    }

    /// The autocorrelation `<h(x) h(x + r)>/<h^2>` of the heights about the mean of the map, over the pairs
    /// of defined points at the vector `lag`, in cells; `None` as in [`DifferenceMap::at`], and where all
    /// heights are equal. It is 1 for the vector 0.
    ///
    /// The value of each vector is the mean over its own pairs (the unbiased estimate); long vectors have few
    /// pairs. Cost O(1).
    pub fn autocorrelation(&self, lag: [isize; 2]) -> Option<f64> {
        let [_, product, _] = self.found(lag)?;
        let [_, square, _] = self.found([0, 0])?;
        if square > 0.0 { Some(product / square) } else { None }
    }

    fn found(&self, lag: [isize; 2]) -> Option<[f64; 3]> {
        let mut index = [0; 2];
        for axis in 0..2 {
            let cells = [self.cells.columns, self.cells.rows][axis].cast_signed();
            if lag[axis].abs() >= cells {
                return None;
            }
            index[axis] = lag[axis].rem_euclid(self.lengths[axis].cast_signed()).cast_unsigned();
        }
        let value = self.values[index[1] * self.lengths[0] + index[0]];
        if value[2] > 0.0 { Some(value) } else { None }
    }

    /// A for distances along x of 1, 2, ... cells: up to half of the side of a periodic map, all of a free
    /// one.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for values beyond the range of f64.
    pub fn along_x(&self) -> Result<HeightDifference> {
        self.along(0)
    }

    /// A for distances along y, as [`DifferenceMap::along_x`].
    ///
    /// # Errors
    /// As [`DifferenceMap::along_x`].
    pub fn along_y(&self) -> Result<HeightDifference> {
        self.along(1)
    }

    fn along(&self, axis: usize) -> Result<HeightDifference> {
        let cells = [self.cells.columns, self.cells.rows][axis];
        let last = if self.periodic { cells / 2 } else { cells - 1 };
        let mut found = HeightDifference::default();
        for k in 1..=last {
            let lag = if axis == 0 { [k.cast_signed(), 0] } else { [0, k.cast_signed()] };
            if let Some([value, pairs]) = self.at(lag) {
                found.distance.push(k as f64 * self.sides[axis]);
                found.half_square.push(finite("mean square height difference", value)?);
                found.pairs.push(pairs);
            }
        }
        Ok(found)
    }

    /// A averaged over all vectors with lengths in a bin, with their numbers of pairs as weights; bins
    /// without pairs are left out. In a periodic map the shortest of the vectors between two points counts.
    ///
    /// Cost: one pass over the vectors.
    ///
    /// # Errors
    /// As [`DifferenceMap::along_x`].
    ///
    /// ```
    /// use contact_model::{Boundary, HeightMap};
    /// use surface_statistics::{Bins, DifferenceMap};
    /// // Rows of a checkerboard of heights 0 and 1: neighbours differ by 1, diagonal neighbours by 0.
    /// let map = HeightMap::from_fn(4, 4.0, |ix, iy| ((ix + iy) % 2) as f64)?;
    /// let found = DifferenceMap::new(&map, Boundary::Free).radial(&Bins::new(vec![0.5, 1.1, 1.5])?)?;
    /// assert!((found.half_square[0] - 0.5).abs() < 1e-14 && found.half_square[1] < 1e-14);
    /// assert_eq!(found.pairs, [24.0, 18.0]);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn radial(&self, bins: &Bins) -> Result<HeightDifference> {
        let reach = [self.cells.columns, self.cells.rows]
            .map(|n| if self.periodic { n.cast_signed() / 2 } else { n.cast_signed() - 1 });
        let mut sums = vec![[0.0; 3]; bins.edges().len() - 1];
        for y in -reach[1]..=reach[1] {
            for x in 0..=reach[0] {
                // Of a vector and its opposite one counts; of half a period, one.
                let half = |axis: usize, lag: isize| {
                    self.periodic && 2 * lag.unsigned_abs() == [self.cells.columns, self.cells.rows][axis]
                };
                if (x == 0 && y <= 0) || (half(1, y) && y < 0) || (half(0, x) && y < 0) {
                    continue;
                }
                let r = (x as f64 * self.sides[0]).hypot(y as f64 * self.sides[1]);
                let (Some(bin), Some([value, mut pairs])) = (bins.index(r), self.at([x, y])) else {
                    continue;
                };
                // Half of a period in both directions, or along an axis, reaches each pair from both of its
                // points.
                if (half(0, x) || x == 0) && (half(1, y) || y == 0) {
                    pairs *= 0.5;
                }
                let sum = &mut sums[bin];
                sum[0] += pairs;
                sum[1] += pairs * r;
                sum[2] += pairs * (value / self.unit / self.unit);
            }
        }
        let mut found = HeightDifference::default();
        for [pairs, r, value] in sums.into_iter().filter(|[pairs, ..]| *pairs > 0.0) {
            found.distance.push(r / pairs);
            let root = (value / pairs).sqrt() * self.unit;
            found.half_square.push(finite("mean square height difference", root * root)?);
            found.pairs.push(pairs);
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// The reference implementation: all pairs.
    fn pairs(map: &HeightMap, boundary: Boundary) -> BTreeMap<[isize; 2], (f64, usize)> {
        let [nx, ny] = [map.columns().cast_signed(), map.rows().cast_signed()];
        let at = |x: isize, y: isize| map.heights()[(y * nx + x).cast_unsigned()];
        let mut found: BTreeMap<[isize; 2], (f64, usize)> = BTreeMap::new();
        for i in 0..nx * ny {
            for lag_y in 1 - ny..ny {
                for lag_x in 1 - nx..nx {
                    let (x, y) = (i % nx + lag_x, i / nx + lag_y);
                    let inside = (0..nx).contains(&x) && (0..ny).contains(&y);
                    if !inside && boundary == Boundary::Free {
                        continue;
                    }
                    let other = at(x.rem_euclid(nx), y.rem_euclid(ny));
                    let step = other - at(i % nx, i / nx);
                    if step.is_finite() && other.is_finite() {
                        let entry = found.entry([lag_x, lag_y]).or_default();
                        entry.0 += 0.5 * step * step;
                        entry.1 += 1;
                    }
                }
            }
        }
        found
    }

    #[test]
    fn transforms_are_sums_over_pairs() {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            for holes in [0, 3] {
                let height = |i: usize| {
                    if holes > 0 && i % 7 == 2 { f64::NAN } else { ((i * i * 37) % 101) as f64 * 0.1 }
                };
                let map =
                    HeightMap::with_undefined([6, 5], [6.0, 2.5], (0..30).map(height).collect()).unwrap();
                let fast = DifferenceMap::new(&map, boundary);
                for (lag, (sum, count)) in pairs(&map, boundary) {
                    let [value, found] = fast.at(lag).unwrap();
                    assert_eq!(found as usize, count, "{lag:?}");
                    assert!((value - sum / count as f64).abs() < 1e-11, "{lag:?} {boundary:?}");
                }
                assert!(fast.at([6, 0]).is_none());
            }
        }
    }

    #[test]
    fn every_pair_counts_once() {
        let map = HeightMap::from_fn([6, 4], [6.0, 4.0], |ix, iy| (ix * iy) as f64).unwrap();
        let all = Bins::new(vec![0.0, 100.0]).unwrap();
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let found = DifferenceMap::new(&map, boundary).radial(&all).unwrap();
            assert!((found.pairs[0] - 24.0 * 23.0 / 2.0).abs() < 1e-9, "{boundary:?} {:?}", found.pairs);
        }
    }
}
