//! Two transforms for dense sets: the smooth far field on a coarse lattice, the near field on the window.
//!
//! The kernel is split as in [`super::two_level`]. The near part ends at the radius R, so that its
//! convolution needs a torus of n + R - 1 cells along a side instead of the 2 (n - 1) of the whole kernel.
//! That is about a quarter of the points. Since half of the rows of the whole transform are empty, and
//! interpolation takes time as well, an application takes 0.7 to 0.8 of the time (N = 512 to 2048, all cells,
//! one thread of an EPYC, 2026-11). Interpolation is separable; along rows it is done where they are read and
//! written anyway. In single precision, for square cells and the free kernel.

use super::convolution::{FftConvolution, Rounded};
use super::influence::InfluenceOperator;
use super::two_level::Split;
use crate::geometry::{CellSet, Window};
use crate::kernel::Symbol;
use crate::tasks::each;
use crate::tuning::{BAND, LANES};
use contact_model::{Interrupted, Stop};
use numerics::parallel::widest;
use std::fmt;

/// Spacing of the lattice in cells: half of it would make the lattice's transform as large as the window's,
/// twice as much is less accurate at the same radius.
const SPACING: usize = 4;

/// The targets of a band of rows, with room for a line of nodes and one of cells.
type NearBand<'u> = ((usize, &'u mut [f32]), Vec<f32>, Vec<f32>);

/// A planned operator for sets inside one window.
pub struct TwoTransforms {
    window: Window,
    split: Split,
    lattice: Window,
    interpolation: Interpolation,
    near: FftConvolution<f32>,
    far: FftConvolution<f32>,
    /// The pressure of each row of cells on the columns of nodes.
    rows: Vec<f32>,
    /// The far field on the nodes.
    potential: Vec<f32>,
    rounded: Rounded,
}

impl fmt::Debug for TwoTransforms {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "TwoTransforms({:?}, {:?})", self.window, self.split)
    }
}

impl TwoTransforms {
    /// How the kernel is split: the radius of the near part in spacings, and the points of the interpolation
    /// in each direction.
    pub const fn split_at(reach: usize, order: usize) -> Split {
        Split { spacing: SPACING, reach, order }
    }

    /// Plans for a window with a split of [`Self::split_at`].
    ///
    /// Memory: about two thirds of a transform of the whole kernel.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn new(window: Window, split: Split, stop: Stop<'_>) -> Result<Self, Interrupted> {
        let near = Symbol::of_kernel_until(split.near_lengths(window), |x, y| split.near(x, y), stop)?;
        let lattice = split.lattice(window);
        let local = Window { x: 0, y: 0, ..lattice };
        let far = split.far_symbol(local, stop)?;
        let interpolation = Interpolation::new(split, lattice.width);
        Ok(Self {
            window,
            split,
            lattice,
            near: FftConvolution::new(window, near.lengths, near.scaled()),
            far: FftConvolution::new(local, far.lengths, far.scaled()),
            rows: vec![0.0; window.height * interpolation.nodes],
            potential: vec![0.0; lattice.height * interpolation.nodes],
            interpolation,
            rounded: Rounded::default(),
        })
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The split.
    pub fn split(&self) -> Split {
        self.split
    }

    /// The pressure of each row of cells on the columns of nodes.
    fn restrict(&mut self, sources: &CellSet, p: &[f32], stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { window, lattice, interpolation, rows, .. } = self;
        let (nodes, x0) = (interpolation.nodes, lattice.x * SPACING);
        let bands = rows.chunks_mut(BAND * nodes).enumerate();
        each(window.count(), bands, stop, |(band, lines)| {
            let first = window.y + band * BAND;
            let mut cells = interpolation.cells();
            let mut phases = interpolation.phases();
            lines.fill(0.0);
            for row in sources.rows_within(first..first + BAND) {
                row.spread(p, &mut cells, x0);
                let line = &mut lines[(row.y - first) * nodes..][..nodes];
                interpolation.restrict(&cells, &mut phases, line);
                row.fill(0.0, &mut cells, x0);
            }
        })
    }

    /// The far field on the nodes.
    fn convolve_far(&mut self, stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { window, split, lattice, interpolation, far, rows, potential, .. } = self;
        let order = split.order;
        let (nodes, blocks) = (interpolation.nodes, lattice.height + 1 - order);
        far.forward(
            |_, _| true,
            |_, ny, out| {
                let (window, lattice, interpolation, rows) =
                    (&*window, &*lattice, &*interpolation, &rows[..]);
                widest(
                    #[inline(always)]
                    move || {
                        // The cells between which nodes this one is.
                        for block in (ny + 1).saturating_sub(order)..(ny + 1).min(blocks) {
                            for (phase, weight) in interpolation.of_nodes[ny - block].iter().enumerate() {
                                let y = (lattice.y + block) * SPACING + phase;
                                if (window.y..window.y + window.height).contains(&y) {
                                    add(out, *weight, &rows[(y - window.y) * nodes..]);
                                }
                            }
                        }
                    },
                );
            },
            stop,
        )?;
        far.multiply(|_| true, stop)?;
        let outputs = potential.chunks_mut(BAND * nodes);
        far.backward(
            |_| true,
            outputs,
            |output, _, y, row| output[y % BAND * nodes..][..row.len()].copy_from_slice(row),
            stop,
        )
    }

    /// The near field, to which the far field is added.
    fn convolve_near(
        &mut self,
        sources: &CellSet,
        p: &[f32],
        targets: &CellSet,
        u: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Self { window, lattice, interpolation, near, potential, .. } = self;
        let Window { x: x0, y: y0, width, .. } = *window;
        let (nodes, begin) = (interpolation.nodes, x0 - lattice.x * SPACING);
        let held = |y: usize| targets.row(y + y0).is_some();
        near.forward(
            |_, y| sources.row(y + y0).is_some(),
            |_, y, line| {
                if let Some(row) = sources.row(y + y0) {
                    row.spread(p, line, x0);
                }
            },
            stop,
        )?;
        near.multiply(held, stop)?;
        let outputs = targets.split(u, near.bands().map(|y| y + y0)).into_iter();
        let outputs = outputs.map(|output| (output, vec![0.0; nodes], interpolation.cells()));
        let take = |((start, u), between, cells): &mut NearBand<'_>, _: usize, y: usize, line: &mut [f32]| {
            let Some(row) = targets.row(y + y0) else { return };
            let block = row.y / SPACING - lattice.y;
            let weights = &interpolation.weights[row.y % SPACING];
            let (interpolation, potential, line) = (&*interpolation, &potential[block * nodes..], &*line);
            let (between, cells) = (&mut between[..], &mut cells[..]);
            let far = &mut *cells;
            widest(
                #[inline(always)]
                move || {
                    between.fill(0.0);
                    for (&weight, potential) in weights.iter().zip(potential.chunks_exact(nodes)) {
                        add(between, weight, potential);
                    }
                    interpolation.interpolate(between, far);
                    add(&mut far[begin..begin + width], 1.0, line);
                },
            );
            row.after(*start).collect(&cells[begin..begin + width], u, x0);
        };
        near.backward(held, outputs, take, stop)
    }
}

impl InfluenceOperator<f32> for TwoTransforms {
    /// The result is exact up to the error of the interpolation. Both sets have to lie inside the window.
    ///
    /// Cost: a transform of little more than the window and one of the lattice, and `2 order (1 + 1 /
    /// spacing)` multiplications for each cell of the window.
    fn apply_until(
        &mut self,
        sources: &CellSet,
        p: &[f32],
        targets: &CellSet,
        u: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        self.restrict(sources, p, stop)?;
        self.convolve_far(stop)?;
        self.convolve_near(sources, p, targets, u, stop)
    }
}

/// Double-precision vectors in single precision.
impl InfluenceOperator<f64> for TwoTransforms {
    fn apply_until(
        &mut self,
        sources: &CellSet,
        p: &[f64],
        targets: &CellSet,
        u: &mut [f64],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let mut rounded = std::mem::take(&mut self.rounded);
        let done = rounded.apply(p, u, |p, u| self.apply_until(sources, p, targets, u, stop));
        self.rounded = rounded;
        done
    }
}

/// `to += factor from`, as far as both go.
#[expect(clippy::inline_always, reason = "a call would lose the instructions of its caller")]
#[inline(always)]
fn add(to: &mut [f32], factor: f32, from: &[f32]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to += factor * from;
    }
}

/// Interpolation between the nodes of a line and its cells, and its transpose.
#[derive(Debug)]
struct Interpolation {
    order: usize,
    /// Cells of a line over the spacing, in whole registers.
    blocks: usize,
    /// Nodes of a line, with room for whole registers.
    nodes: usize,
    /// Weights of the nodes around a cell, for each place between two nodes.
    weights: [Vec<f32>; SPACING],
    /// The same node by node.
    of_nodes: Vec<[f32; SPACING]>,
}

/// Cells that are interpolated at a time.
const GROUP: usize = 8 * SPACING;

impl Interpolation {
    fn new(split: Split, nodes: usize) -> Self {
        let order = split.order;
        let blocks = (nodes + 1 - order).next_multiple_of(LANES);
        let weights = |i| split.weights(i).into_iter().map(|w| w as f32).collect();
        let weights: [Vec<f32>; SPACING] = std::array::from_fn(weights);
        Self {
            order,
            blocks,
            nodes: (blocks + order - 1).next_multiple_of(LANES),
            of_nodes: (0..order).map(|k| weights.each_ref().map(|of_phase| of_phase[k])).collect(),
            weights,
        }
    }

    /// A line of cells.
    fn cells(&self) -> Vec<f32> {
        vec![0.0; self.blocks * SPACING]
    }

    /// Room for the cells of a line, those of each place between two nodes for themselves, with zeros on both
    /// sides.
    fn phases(&self) -> [Vec<f32>; SPACING] {
        std::array::from_fn(|_| vec![0.0; self.nodes + self.order - 1])
    }

    /// Cells to nodes: the transpose of [`Self::interpolate`].
    fn restrict(&self, cells: &[f32], phases: &mut [Vec<f32>; SPACING], nodes: &mut [f32]) {
        let (first, (blocks, _)) = (self.order - 1, cells.as_chunks());
        widest(
            #[inline(always)]
            move || {
                let [a, b, c, d] = phases;
                let (a, b, c, d) = (&mut a[first..], &mut b[first..], &mut c[first..], &mut d[first..]);
                for ((((a, b), c), d), block) in a.iter_mut().zip(b).zip(c).zip(d).zip(blocks) {
                    [*a, *b, *c, *d] = *block;
                }
                for (n, nodes) in nodes.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
                    let mut sum = [0.0; LANES];
                    for (k, weights) in self.of_nodes.iter().enumerate() {
                        for (phase, weight) in phases.iter().zip(weights) {
                            for (sum, value) in sum.iter_mut().zip(&phase[n * LANES + first - k..][..LANES]) {
                                *sum += weight * value;
                            }
                        }
                    }
                    *nodes = sum;
                }
            },
        );
    }

    /// Nodes to cells.
    #[expect(clippy::inline_always, reason = "a call would lose the instructions of its caller")]
    #[inline(always)]
    fn interpolate(&self, nodes: &[f32], cells: &mut [f32]) {
        let (cells, _) = cells.as_chunks_mut::<GROUP>();
        for (n, cells) in cells.iter_mut().enumerate() {
            let mut sums = [0.0; GROUP];
            for (k, weights) in self.of_nodes.iter().enumerate() {
                let nodes = &nodes[n * GROUP / SPACING + k..][..GROUP / SPACING];
                for (sums, node) in sums.as_chunks_mut::<SPACING>().0.iter_mut().zip(nodes) {
                    for (sum, weight) in sums.iter_mut().zip(weights) {
                        *sum += weight * node;
                    }
                }
            }
            *cells = sums;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Grid, Lengths};
    use crate::kernel::NormalTable;
    use crate::operator::DirectSum;
    use contact_model::Boundary;
    use contact_model::never;

    /// Largest error over the largest displacement on cells of a grid, against the whole kernel in double
    /// precision.
    fn error(grid: Grid, set: &CellSet, p: &[f64], split: Split) -> f64 {
        let table = NormalTable::shared(grid, Boundary::Free);
        let (window, targets) = (grid.window(), CellSet::all(grid));
        let lengths = Lengths::free(window);
        let (mut exact, mut fast) = (vec![0.0; grid.count()], vec![0.0; grid.count()]);
        FftConvolution::new(window, lengths, table.symbol_f64(lengths, &never).unwrap())
            .apply(set, p, &targets, &mut exact);
        TwoTransforms::new(window, split, &never).unwrap().apply(set, p, &targets, &mut fast);
        let largest = exact.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        exact.iter().zip(&fast).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
    }

    /// A set with many holes, a smooth pressure and a random one.
    fn pressures(grid: Grid) -> (CellSet, [Vec<f64>; 2]) {
        let set = CellSet::numbered(grid, |i| i * i % 7 < 3);
        let wave = |(x, y): (usize, usize)| 2.0 + (x as f64 / 9.0).sin() * (y as f64 / 14.0).cos();
        let noise = |k: usize| ((k as f64 * 12.9898).sin() * 43_758.545).fract();
        let p = [set.places().map(wave).collect(), (0..set.len()).map(noise).collect()];
        (set, p)
    }

    #[test]
    fn the_error_falls_with_the_reach_and_with_the_order() {
        let grid = Grid::square(200, 180);
        let (set, pressures) = pressures(grid);
        for (p, bounds) in pressures.iter().zip([[1e-3, 1e-5, 1e-6], [1e-2, 1e-4, 5e-6]]) {
            for ((reach, order), bound) in [(4, 4), (8, 6), (12, 6)].into_iter().zip(bounds) {
                let error = error(grid, &set, p, TwoTransforms::split_at(reach, order));
                println!("reach {reach}, order {order}: {error:.1e}");
                assert!(error < bound, "reach {reach}, order {order}: {error}");
            }
        }
    }

    #[test]
    fn wherever_the_window_begins_it_is_the_whole_kernel() {
        // Windows that begin and end at every place between two nodes, thin ones among them.
        let grid = Grid::square(140, 150);
        for (x, y, width, height) in [(0, 0, 140, 150), (1, 2, 90, 81), (7, 5, 66, 100), (3, 49, 101, 7)] {
            let window = Window { x, y, width, height };
            let rows = |step: usize| {
                (y..y + height).step_by(step).map(move |y| (y, (x as u32..(x + width) as u32).step_by(2)))
            };
            // Rows without sources and rows without targets.
            let (sources, targets) = (CellSet::from_rows(rows(3)), CellSet::from_rows(rows(2)));
            let p: Vec<f64> = (0..sources.len()).map(|k| 1.5 + (k as f64).sin()).collect();
            let table = NormalTable::shared(grid, Boundary::Free);
            let (mut exact, mut fast) = (vec![0.0; targets.len()], vec![1.0; targets.len()]);
            DirectSum(&table).apply(&sources, &p, &targets, &mut exact);
            let mut operator = TwoTransforms::new(window, TwoTransforms::split_at(12, 6), &never).unwrap();
            for _ in 0..2 {
                operator.apply(&sources, &p, &targets, &mut fast);
                let largest = exact.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
                let error = exact.iter().zip(&fast).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
                assert!(error < 5e-6, "{window:?}: {error}");
            }
            assert!(format!("{operator:?}").starts_with("TwoTransforms(Window"));
        }
    }

    #[test]
    fn restriction_is_the_transpose_of_interpolation() {
        let interpolation = Interpolation::new(TwoTransforms::split_at(12, 6), 40);
        let value = |i: usize, seed: f32| (seed * i as f32).sin();
        let mut cells = interpolation.cells();
        let mut nodes: Vec<f32> = (0..interpolation.nodes).map(|i| value(i, 0.7)).collect();
        // Nodes beyond those of the line see no cell.
        nodes[interpolation.blocks + interpolation.order - 1..].fill(0.0);
        let p: Vec<f32> = (0..cells.len()).map(|i| value(i, 1.3)).collect();
        interpolation.interpolate(&nodes, &mut cells);
        let mut charges = vec![1.0; interpolation.nodes];
        interpolation.restrict(&p, &mut interpolation.phases(), &mut charges);
        let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum::<f64>();
        let (one, two) = (dot(&cells, &p), dot(&nodes, &charges));
        assert!((one - two).abs() < 1e-4 * one.abs().max(1.0), "{one} {two}");
        // A constant is interpolated by itself.
        interpolation.interpolate(&vec![1.0; interpolation.nodes], &mut cells);
        assert!(cells.iter().all(|u| (u - 1.0).abs() < 1e-6));
    }
}
