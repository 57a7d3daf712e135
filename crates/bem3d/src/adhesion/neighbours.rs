//! Means over the neighbours of a cell, a weighted sum over a ring of cells.
//!
//! The sum is taken for [`LANES`] cells of a row at a time: each weight is multiplied with as many values that
//! lie side by side, and the accumulators stay in registers. The order of the terms is that of the weights,
//! whatever the width of the registers and the number of threads.

use super::pairs::Pairs;
use crate::geometry::{CellSet, Grid, Window};
use crate::real::each;
use crate::tuning::LANES;
use numerics::parallel::widest;
use std::ops::Range;

/// The mean J over the neighbours of a cell.
#[derive(Debug, Clone)]
pub struct Neighbours {
    grid: Grid,
    periodic: bool,
    /// Most columns and rows away.
    reach: (usize, usize),
    /// Weights of each row of neighbours from its first to its last that is not zero, and how many columns
    /// that first one lies before the cell; the sum of all is 1.
    rows: Vec<(usize, Vec<f64>)>,
    /// Mean distance of the neighbours along x and along y, the mean of both.
    pub distance: f64,
}

impl Neighbours {
    /// A ring, weights `1 - ((r - radius)/width)^2` where that is positive, in units of the sides of the
    /// grid's cells.
    pub fn ring(grid: Grid, periodic: bool, (radius, width): (f64, f64)) -> Self {
        let farthest = radius + width;
        let (dx, dy) = grid.cell();
        // Number of cells to one side within a distance.
        let within = |distance: f64, cell: f64| ((distance / cell).ceil() as usize).saturating_sub(1);
        let along = within(farthest, dy);
        let (mut total, mut moment) = (0.0, 0.0);
        let mut rows = Vec::with_capacity(2 * along + 1);
        for j in 0..=2 * along {
            let y = dy * (j as f64 - along as f64);
            let half = within((farthest * farthest - y * y).max(0.0).sqrt(), dx);
            let weight = |i: usize| {
                let x = dx * (i as f64 - half as f64);
                let weight = (1.0 - ((x.hypot(y) - radius) / width).powi(2)).max(0.0);
                total += weight;
                moment += 0.5 * weight * (x.abs() + y.abs());
                weight
            };
            rows.push((half, (0..=2 * half).map(weight).collect::<Vec<f64>>()));
        }
        for (_, weights) in &mut rows {
            each(weights, |w| *w /= total);
        }
        let across = within(farthest, dx);
        Self { grid, periodic, reach: (across, along), rows, distance: moment / total }
    }

    /// The matrix of the values of all pairs of a cell and its neighbours, from their numbers in the set and
    /// the weight; a value of zero is left out. `row`: cells that have a row.
    pub fn pairs(
        &self,
        cells: &CellSet,
        row: impl Fn(usize) -> bool,
        value: impl Fn(usize, usize, f64) -> f64,
    ) -> Pairs {
        const NONE: u32 = u32::MAX;
        let (columns, rows) = (self.grid.columns.cast_signed(), self.grid.rows.cast_signed());
        let mut numbers = vec![NONE; self.grid.count()];
        for (number, place) in cells.index(self.grid).enumerate() {
            numbers[place] = number as u32;
        }
        let lags: Vec<(isize, isize, f64)> = self.weights().filter(|lag| lag.2 > 0.0).collect();
        let number = |x: isize, y: isize| {
            let inside = (0..columns).contains(&x) && (0..rows).contains(&y);
            if !inside && !self.periodic {
                return NONE;
            }
            numbers[(y.rem_euclid(rows) * columns + x.rem_euclid(columns)).unsigned_abs()]
        };
        Pairs::new(cells.places().enumerate().map(|(i, (x, y))| {
            let lags = if row(i) { &lags[..] } else { &[] };
            let (number, value) = (&number, &value);
            (lags.iter())
                .map(move |&(a, b, weight)| (number(x.cast_signed() + a, y.cast_signed() + b), weight))
                .filter(|(k, _)| *k != NONE)
                .map(move |(k, weight)| (k, value(i, k as usize, weight) as f32))
                .filter(|(_, value)| *value != 0.0)
        }))
    }

    /// Columns, rows and weights of the neighbours.
    pub fn weights(&self) -> impl Iterator<Item = (isize, isize, f64)> + '_ {
        (self.rows.iter().enumerate()).flat_map(move |(j, (half, weights))| {
            let place = move |i: usize| {
                (i.cast_signed() - half.cast_signed(), j.cast_signed() - self.reach.1.cast_signed())
            };
            weights.iter().enumerate().map(move |(i, &w)| (place(i).0, place(i).1, w))
        })
    }

    /// Means over the neighbours of the cells of a set; cells outside of it count 0.
    pub fn mean(&self, cells: &CellSet, values: &[f64]) -> Vec<f64> {
        let mut mean = vec![0.0; cells.len()];
        let Some(window) = cells.window() else { return mean };
        let (around, width) = self.values_around(cells, window, values);
        let work = cells.len() * self.rows.iter().map(|(_, weights)| weights.len()).sum::<usize>();
        cells.update(work, &mut mean, |row, mean| {
            let top = (row.y - window.y) * width;
            let mean = &mut mean[row.span()];
            widest(
                #[inline(always)]
                || {
                    let mut done = 0;
                    while done < mean.len() {
                        let x = row.columns[done] as usize;
                        let sums = self.sums(&around[top + x - window.x..], width);
                        // The cells among these columns that belong to the set.
                        for &column in &row.columns[done..] {
                            let Some(&sum) = sums.get(column as usize - x) else { break };
                            mean[done] = sum;
                            done += 1;
                        }
                    }
                },
            );
        });
        mean
    }

    /// The sums for cells side by side, whose neighbourhood begins with these values.
    #[expect(clippy::inline_always, reason = "a call would lose the instructions of its caller")]
    #[inline(always)]
    fn sums(&self, around: &[f64], width: usize) -> [f64; LANES] {
        let mut sums = [0.0; LANES];
        for (j, (half, weights)) in self.rows.iter().enumerate() {
            let line = &around[j * width + self.reach.0 - half..][..2 * half + LANES];
            for (weight, values) in weights.iter().zip(line.windows(LANES)) {
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += weight * value;
                }
            }
        }
        sums
    }

    /// The values in the window of the set and as far around it as neighbours reach, rows of the length that
    /// is returned.
    fn values_around(&self, cells: &CellSet, window: Window, values: &[f64]) -> (Vec<f64>, usize) {
        let (across, along) = self.reach;
        // Sums of cells side by side read beyond the neighbours of the last column.
        let width = window.width + 2 * across + LANES;
        let mut around = vec![0.0; width * (window.height + 2 * along)];
        for row in cells.rows() {
            let line = &mut around[(row.y + along - window.y) * width..][..width];
            row.spread(values, &mut line[across..], window.x);
        }
        if self.periodic {
            // The cells of the window that lie whole periods apart.
            let rows = images(along, window.height, self.grid.rows);
            let columns = images(across, window.width, self.grid.columns);
            for y in along..along + window.height {
                for (to, from) in &columns {
                    around[y * width + to] = around[y * width + from];
                }
            }
            for (to, from) in rows {
                around.copy_within(from * width..(from + 1) * width, to * width);
            }
        }
        (around, width)
    }
}

/// Positions beside a window of this length, up to `reach` from it, each with the positions in the window
/// that are whole periods away.
fn images(reach: usize, length: usize, period: usize) -> Vec<(usize, usize)> {
    let window: Range<usize> = reach..reach + length;
    (0..length + 2 * reach)
        .filter(|to| !window.contains(to))
        .filter_map(|to| {
            let from = reach + (to + reach * period - reach) % period;
            window.contains(&from).then_some((to, from))
        })
        .collect()
}

#[cfg(test)]
#[allow(clippy::cast_possible_wrap)] // Small numbers.
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_the_sum_over_all_pairs() {
        let sparse = |i: usize| i % 4 != 1;
        let in_runs = |i: usize| i / 7 % 3 != 1;
        for (grid, periodic, ring) in [
            (Grid::square(9, 7), false, (2.5, 1.5)),
            (Grid::square(9, 7), true, (6.0, 1.5)),
            (Grid::square(5, 3), true, (4.0, 1.5)),
            (Grid::square(60, 5), false, (4.0, 1.5)),
            (Grid { columns: 4, rows: 14, stretch: 1.7 }, true, (6.8, 2.5)),
        ] {
            for cells in [CellSet::numbered(grid, sparse), CellSet::numbered(grid, in_runs)] {
                let neighbours = Neighbours::ring(grid, periodic, ring);
                let values: Vec<f64> = (0..cells.len()).map(|i| (i as f64).sin()).collect();
                let expected = by_pairs(&neighbours, &cells, &values);
                let found = neighbours.mean(&cells, &values);
                // Of all rows, and of each second one.
                let whole = neighbours.pairs(&cells, |_| true, |_, _, weight| weight);
                let half = neighbours.pairs(&cells, |i| i % 2 == 0, |_, _, weight| weight);
                let (mut twice, mut rows) = (vec![0.0; values.len()], vec![0.0; values.len()]);
                whole.add_product(2.0, &values, &mut twice);
                half.add_product(1.0, &values, &mut rows);
                for (i, expected) in expected.iter().enumerate() {
                    approx::assert_relative_eq!(found[i], *expected, epsilon = 1e-14);
                    approx::assert_relative_eq!(twice[i], 2.0 * expected, epsilon = 1e-6);
                    let row = if i % 2 == 0 { *expected } else { 0.0 };
                    approx::assert_relative_eq!(rows[i], row, epsilon = 1e-6);
                }
            }
        }
    }

    /// The definition, with the weights from the distance of each cell from each image of each other.
    fn by_pairs(neighbours: &Neighbours, cells: &CellSet, values: &[f64]) -> Vec<f64> {
        let Neighbours { grid, periodic, .. } = *neighbours;
        let (columns, rows) = (grid.columns as isize, grid.rows as isize);
        let weights: Vec<(isize, isize, f64)> = neighbours.weights().collect();
        let at = |(x, y): (usize, usize), (a, b): (usize, usize)| {
            let (i, j) = (a as isize - x as isize, b as isize - y as isize);
            let same = |k: &&(isize, isize, f64)| {
                let (p, q) = (k.0 - i, k.1 - j);
                if periodic { p % columns == 0 && q % rows == 0 } else { p == 0 && q == 0 }
            };
            weights.iter().filter(same).map(|k| k.2).sum::<f64>()
        };
        cells
            .places()
            .map(|cell| cells.places().zip(values).map(|(other, v)| v * at(cell, other)).sum())
            .collect()
    }

    /// `cargo test --release -p bem3d cost_of_the_mean -- --ignored --nocapture`: nanoseconds per cell, for
    /// all cells and for a rough contact, compared with the sum of one cell after the other.
    #[test]
    #[ignore = "a time"]
    fn cost_of_the_mean() {
        let grid = Grid::square(1024, 1024);
        for (name, cells) in [
            ("all", CellSet::all(grid)),
            (
                "scattered runs",
                CellSet::numbered(grid, |i| (0.1 * i as f64).sin() + (1e-4 * i as f64).cos() > 0.5),
            ),
            ("every seventh", CellSet::numbered(grid, |i| i % 7 == 0)),
        ] {
            for radius in [2.5, 4.0, 6.5] {
                let neighbours = Neighbours::ring(grid, false, (radius, 1.5));
                let values = vec![1.0; cells.len()];
                let time = |mean: &dyn Fn() -> Vec<f64>| {
                    let start = std::time::Instant::now();
                    let sum: f64 = mean().iter().sum();
                    (start.elapsed().as_secs_f64() * 1e9 / cells.len() as f64, sum)
                };
                let (fast, a) = time(&|| neighbours.mean(&cells, &values));
                let (slow, b) = time(&|| cell_by_cell(&neighbours, &cells, &values));
                println!("{name} radius {radius}: {fast:.1} ns, one by one {slow:.1} ns");
                approx::assert_relative_eq!(a, b, max_relative = 1e-12);
            }
        }
    }

    /// The sums of a dense square of weights for one cell after the other.
    fn cell_by_cell(neighbours: &Neighbours, cells: &CellSet, values: &[f64]) -> Vec<f64> {
        let (across, along) = neighbours.reach;
        let row = 2 * across + 1;
        let mut dense = vec![0.0; row * (2 * along + 1)];
        for (i, j, weight) in neighbours.weights() {
            dense[(j + along as isize) as usize * row + (i + across as isize) as usize] = weight;
        }
        let window = cells.window().unwrap();
        let (around, width) = neighbours.values_around(cells, window, values);
        let mean = |(x, y): (usize, usize)| {
            (dense.chunks_exact(row).enumerate())
                .map(|(j, weights)| {
                    let from = (y - window.y + j) * width + x - window.x;
                    weights.iter().zip(&around[from..from + row]).map(|(w, v)| w * v).sum::<f64>()
                })
                .sum()
        };
        cells.places().map(mean).collect()
    }
}
