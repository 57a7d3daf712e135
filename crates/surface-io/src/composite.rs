//! The composite surface of two rough bodies.

use crate::error::{ContentError, Error, Result};
use contact_model::{Cells, HeightMap, Size};
use std::path::Path;

/// Rounding of a quotient of lengths that were typed or multiplied.
const ROUNDED: f64 = 1e-9;

/// Least share of a cell of the result that must be defined, but for roundings.
const HALF: f64 = 0.5 - 1e-9;

/// The sum of the heights of two bodies that touch face to face. Pressing the two bodies together is
/// equivalent to pressing this sum against a flat: with heights counted outwards from each body, the
/// undeformed gap is the difference between the highest point of the sum and the sum (K. L. Johnson, Contact
/// Mechanics, 1985, Sec. 4.1).
///
/// Both maps use the directions x and y of the first. A second map that was measured from its own side must
/// be mirrored first ([`crate::Preprocessing::mirror`]). `offset` is the position of the centre of the second
/// map relative to that of the first, as lengths along x and y. The result covers the common part of both,
/// with the larger of the two cell sides along each axis; each height is a mean over the area of its cell,
/// which is exact where the grids coincide. A cell of which less than half is defined on one of the bodies is
/// undefined. Cost O(N).
///
/// # Errors
/// [`ContentError::Apart`] where both have less than one cell in common, [`ContentError::Map`] where no point
/// is defined.
///
/// ```
/// use contact_model::HeightMap;
/// use surface_io::composite;
/// let coarse = HeightMap::new([2, 1], [2.0, 1.0], vec![1.0, 2.0])?;
/// let fine = HeightMap::new([4, 2], [2.0, 1.0], vec![0.0, 2.0, 4.0, 6.0, 0.0, 2.0, 4.0, 6.0])?;
/// assert_eq!(composite(&coarse, &fine, [0.0, 0.0]).unwrap().heights(), [2.0, 7.0]);
/// // Moved by one coarse cell: half of each is left.
/// let moved = composite(&coarse, &fine, [1.0, 0.0]).unwrap();
/// assert_eq!((moved.heights(), moved.size().x), (&[3.0][..], 1.0));
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn composite(first: &HeightMap, second: &HeightMap, offset: [f64; 2]) -> Result<HeightMap> {
    summed(first, second, offset).map_err(Error::content(Path::new("the second surface")))
}

fn summed(first: &HeightMap, second: &HeightMap, offset: [f64; 2]) -> Result<HeightMap, ContentError> {
    let x = SharedAxis::common(
        [first.columns(), second.columns()],
        [first.size().x, second.size().x],
        offset[0],
    )?;
    let y = SharedAxis::common([first.rows(), second.rows()], [first.size().y, second.size().y], offset[1])?;
    let cells = Cells { columns: x.count, rows: y.count };
    let mut heights = means(first, &x.shares[0], &y.shares[0]);
    for (sum, h) in heights.iter_mut().zip(means(second, &x.shares[1], &y.shares[1])) {
        *sum += h;
    }
    let size = Size { x: x.cell * x.count as f64, y: y.cell * y.count as f64 };
    HeightMap::with_undefined(cells, size, heights).map_err(ContentError::Map)
}

/// The common part of both maps along one axis.
struct SharedAxis {
    cell: f64,
    count: usize,
    /// For each cell of the result and each map: its first cell there, and the shares of that and those
    /// behind it.
    shares: [Vec<(usize, Vec<f64>)>; 2],
}

impl SharedAxis {
    fn common(counts: [usize; 2], sides: [f64; 2], offset: f64) -> Result<Self, ContentError> {
        let cells = [sides[0] / counts[0] as f64, sides[1] / counts[1] as f64];
        let cell = cells[0].max(cells[1]);
        // Where each begins, from the beginning of the first.
        let begins = [0.0, 0.5 * (sides[0] - sides[1]) + offset];
        let from = begins[0].max(begins[1]);
        let to = (begins[0] + sides[0]).min(begins[1] + sides[1]);
        let count = ((to - from) / cell + ROUNDED).floor();
        if count.is_nan() || count < 1.0 {
            return Err(ContentError::Apart { sides, offset });
        }
        let count = count as usize;
        let shares = [0, 1].map(|map| {
            // In cells of this map; roundings are no parts of cells.
            let whole =
                |place: f64| if (place - place.round()).abs() < ROUNDED { place.round() } else { place };
            let edge = |k: usize| {
                whole((from - begins[map]) / cells[map] + k as f64 * (cell / cells[map]))
                    .clamp(0.0, counts[map] as f64)
            };
            (0..count).map(|k| parts(edge(k), edge(k + 1))).collect()
        });
        Ok(Self { cell, count, shares })
    }
}

/// The first whole cell under an interval of cells, and the shares of it and those behind it, which add up to
/// 1.
fn parts(from: f64, to: f64) -> (usize, Vec<f64>) {
    let (first, last) = (from.floor() as usize, (to.ceil() as usize).max(from.floor() as usize + 1));
    let share = |i: usize| ((i + 1) as f64).min(to) - (i as f64).max(from);
    (first, (first..last).map(|i| share(i) / (to - from)).collect())
}

/// Means over the cells of the result, NaN where less than half is defined.
fn means(map: &HeightMap, x: &[(usize, Vec<f64>)], y: &[(usize, Vec<f64>)]) -> Vec<f64> {
    let mut heights = Vec::with_capacity(x.len() * y.len());
    for (top, down) in y {
        for (left, across) in x {
            let (mut sum, mut defined) = (0.0, 0.0);
            for (row, height) in down.iter().enumerate() {
                let line = &map.heights()[(top + row) * map.columns() + left..];
                for (h, width) in line.iter().zip(across) {
                    if h.is_finite() {
                        sum += height * width * h;
                        defined += height * width;
                    }
                }
            }
            heights.push(if defined < HALF { f64::NAN } else { sum / defined });
        }
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn map(cells: [usize; 2], size: [f64; 2], f: impl Fn(usize, usize) -> f64) -> HeightMap {
        HeightMap::from_fn(cells, size, f).unwrap()
    }

    #[test]
    fn equal_grids_add_to_the_bit() {
        let a = map([5, 3], [0.5, 0.3], |i, j| (i * 7 + j) as f64 / 3.0);
        let b = map([5, 3], [0.5, 0.3], |i, j| (j * 5 + i) as f64 / 7.0);
        assert_eq!(composite(&a, &b, [0.0; 2]).unwrap(), a.plus(&b).unwrap());
        // Moved by two columns and one row.
        let moved = composite(&a, &b, [0.2, -0.1]).unwrap();
        assert_eq!((moved.columns(), moved.rows()), (3, 2));
        let expected = a.heights()[2] + b.heights()[5];
        assert_relative_eq!(moved.heights()[0], expected, max_relative = 1e-14);
        assert_relative_eq!(moved.dx(), 0.1, max_relative = 1e-12);
    }

    #[test]
    fn a_plane_is_itself_on_every_grid() {
        let plane = |cells: [usize; 2], size: [f64; 2], x0: f64| {
            map(cells, size, move |i, j| {
                let (dx, dy) = (size[0] / cells[0] as f64, size[1] / cells[1] as f64);
                2.0 * (x0 + (i as f64 + 0.5) * dx) - 3.0 * (j as f64 + 0.5) * dy
            })
        };
        // The second is half as wide and lies 1/8 farther than the middle: it begins at 1/4 + 1/8.
        let sum =
            composite(&plane([10, 6], [1.0, 1.0], 0.0), &plane([7, 24], [0.5, 1.0], 0.375), [0.125, 0.0])
                .unwrap();
        assert_eq!((sum.columns(), sum.rows()), (5, 6));
        for (k, h) in sum.heights().iter().enumerate() {
            let (x, y) = (0.375 + ((k % 5) as f64 + 0.5) * 0.1, ((k / 5) as f64 + 0.5) / 6.0);
            // Means over cells of a plane are exact where whole cells count; parts of cells are constant.
            assert!((h - 2.0 * (2.0 * x - 3.0 * y)).abs() < 0.1, "{k}");
        }
        let mean = sum.heights().iter().sum::<f64>() / 30.0;
        assert_relative_eq!(mean, 2.0 * (2.0 * 0.625 - 1.5), max_relative = 0.02);
    }

    #[test]
    fn holes_stay_and_bodies_apart_are_refused() {
        let a = HeightMap::with_undefined([2, 1], [2.0, 1.0], vec![f64::NAN, 1.0]).unwrap();
        let b = map([2, 1], [2.0, 1.0], |i, _| i as f64);
        let sum = composite(&a, &b, [0.0; 2]).unwrap();
        assert_eq!((sum.undefined(), sum.heights()[1]), (1, 2.0));
        let error = composite(&b, &b, [0.0, 3.0]).unwrap_err().to_string();
        assert!(error.contains("1 and 1 long, the second moved by 3"), "{error}");
        assert!(composite(&b, &b, [f64::NAN, 0.0]).is_err());
    }
}
