//! Two transforms for dense sets: the smooth far field on a coarse lattice, the near field on the window.
//!
//! The kernel is split as in [`super::two_level`]. The near part ends at the radius R, so that its
//! convolution needs a torus of n + R - 1 cells along a side instead of the 2 (n - 1) of the whole kernel.
//! That is about a quarter of the points. Since half of the rows of the whole transform are empty, and
//! interpolation takes time as well, an application takes 0.7 to 0.8 of the time (N = 512 to 2048, all cells,
//! one thread of an EPYC, 2026-11). Interpolation is separable: between rows it takes whole rows of cells, and along
//! rows, where numbers have to change their places, it is done for the rows of nodes alone, which are fewer. In
//! single precision, for square cells and the free kernel.

use super::convolution::{FftConvolution, Rounded};
use super::influence::InfluenceOperator;
use super::transform::Room;
use super::two_level::Split;
use crate::geometry::{CellSet, Window};
use crate::kernel::Symbol;
use crate::tasks::each;
use crate::tuning::{BAND, LANES};
use contact_model::{Interrupted, Stop};
use numerics::parallel::widest;
use std::fmt;
use std::iter::zip;
use std::ops::Range;

/// Spacing of the lattice in cells: half of it would make the lattice's transform as large as the window's,
/// twice as much is less accurate at the same radius.
const SPACING: usize = 4;

/// Rows of nodes that a thread takes at a time; the rows of cells around the first and the last of them are spread
/// once more by its neighbours.
const NODE_BAND: usize = 2 * BAND;
/// Columns whose sums stay in registers.
const HELD: usize = 2 * LANES;
/// With less than one target in this number of cells of a row, the far field is interpolated cell by cell.
const SCATTERED: usize = 4;

/// A planned operator for sets inside one window.
pub struct TwoTransforms {
    window: Window,
    split: Split,
    lattice: Window,
    interpolation: Interpolation,
    near: FftConvolution<f32>,
    far: FftConvolution<f32>,
    /// The pressure on the nodes.
    charges: Vec<f32>,
    /// The far field at the cells of a row, for each row of nodes.
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
        Self::within(&Room::default(), window, split, stop)
    }

    /// The same with its spectra in a room that other transforms use too.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn within(
        room: &Room<f32>,
        window: Window,
        split: Split,
        stop: Stop<'_>,
    ) -> Result<Self, Interrupted> {
        let near = Symbol::of_kernel_until(split.near_lengths(window), |x, y| split.near(x, y), stop)?;
        let lattice = split.lattice(window);
        let local = Window { x: 0, y: 0, ..lattice };
        let far = split.far_symbol(local, stop)?;
        let interpolation = Interpolation::new(split, lattice.width);
        Ok(Self {
            window,
            split,
            lattice,
            near: FftConvolution::within(room, window, near.lengths, near.scaled()),
            far: FftConvolution::within(room, local, far.lengths, far.scaled()),
            charges: vec![0.0; lattice.height * interpolation.nodes],
            potential: vec![0.0; lattice.height * interpolation.cells()],
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

    /// The pressure on the nodes.
    fn restrict(&mut self, sources: &CellSet, p: &[f32], stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { window, lattice, interpolation, charges, .. } = self;
        let (nodes, width) = (interpolation.nodes, interpolation.cells());
        let bands = charges.chunks_mut(NODE_BAND * nodes).enumerate();
        each(window.count(), bands, stop, |(band, lines)| {
            let mut around = RowsAround::new(interpolation.order, width);
            let (mut sum, mut phases) = (vec![0.0; width], interpolation.phases());
            for (i, line) in lines.chunks_exact_mut(nodes).enumerate() {
                let node = lattice.y + band * NODE_BAND + i;
                around.advance(node, |y, cells| {
                    sources.row(y).inspect(|row| row.spread(p, cells, lattice.x * SPACING)).is_some()
                });
                let weighted: Vec<_> = around.weighted(node, &interpolation.of_nodes).collect();
                sum.fill(0.0);
                add_weighted(weighted.iter().copied(), &mut sum);
                interpolation.restrict(&sum, &mut phases, line);
            }
        })
    }

    /// The far field at the cells of a row, for each row of nodes.
    fn convolve_far(&mut self, stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { lattice, interpolation, far, charges, potential, .. } = self;
        let (interpolation, charges, width) = (&*interpolation, &charges[..], interpolation.cells());
        let nodes = interpolation.nodes;
        far.forward(
            |_, _| true,
            |_, y, out| out.copy_from_slice(&charges[y * nodes..][..lattice.width]),
            stop,
        )?;
        far.multiply(|_| true, stop)?;
        let outputs = potential.chunks_mut(BAND * width).map(|lines| (lines, vec![0.0; nodes]));
        far.backward(
            |_| true,
            outputs,
            |(lines, padded): &mut (&mut [f32], Vec<f32>), _, y, row| {
                padded[..row.len()].copy_from_slice(row);
                let (padded, cells) = (&padded[..], &mut lines[y % BAND * width..][..width]);
                widest(
                    #[inline(always)]
                    move || interpolation.interpolate(padded, cells),
                );
            },
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
        let (cells, begin) = (interpolation.cells(), x0 - lattice.x * SPACING);
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
        let take = |(start, u): &mut (usize, &mut [f32]), _: usize, y: usize, line: &mut [f32]| {
            let Some(row) = targets.row(y + y0) else { return };
            let lines = potential[(row.y / SPACING - lattice.y) * cells..].chunks_exact(cells);
            let weighted = zip(&interpolation.weights[row.y % SPACING], lines);
            let weighted = weighted.map(|(&weight, far)| (weight, &far[begin..begin + width]));
            if row.columns.len() * SCATTERED < width {
                for &x in row.columns {
                    let x = x as usize - x0;
                    line[x] += weighted.clone().map(|(weight, far)| weight * far[x]).sum::<f32>();
                }
            } else {
                add_weighted(weighted, line);
            }
            row.after(*start).collect(line, u, x0);
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

/// Adds lines of the same length, each with its weight: a few columns of all lines at a time, whose sums stay in
/// registers.
fn add_weighted<'l>(lines: impl Iterator<Item = (f32, &'l [f32])> + Clone, to: &mut [f32]) {
    widest(
        #[inline(always)]
        move || {
            let (chunks, rest) = to.as_chunks_mut::<HELD>();
            let whole = chunks.len() * HELD;
            for (i, chunk) in chunks.iter_mut().enumerate() {
                let mut sums = *chunk;
                for (weight, line) in lines.clone() {
                    for (sum, value) in sums.iter_mut().zip(&line[i * HELD..][..HELD]) {
                        *sum += weight * value;
                    }
                }
                *chunk = sums;
            }
            for (weight, line) in lines {
                for (sum, value) in rest.iter_mut().zip(&line[whole..]) {
                    *sum += weight * value;
                }
            }
        },
    );
}

/// The rows of cells around a row of nodes, which go on with it: row y at place y modulo their number.
struct RowsAround {
    order: usize,
    width: usize,
    cells: Vec<f32>,
    /// Which of them have a pressure.
    pressed: Vec<bool>,
    /// The rows before this one are known.
    next: usize,
}

impl RowsAround {
    fn new(order: usize, width: usize) -> Self {
        let count = order * SPACING;
        Self { order, width, cells: vec![0.0; count * width], pressed: vec![false; count], next: 0 }
    }

    /// The blocks of rows between whose nodes a node is.
    fn blocks(&self, node: usize) -> Range<usize> {
        (node + 1).saturating_sub(self.order)..node + 1
    }

    /// Goes on to the rows around a node: `fill` writes row y, which is zero before, and says whether it has a
    /// pressure.
    fn advance(&mut self, node: usize, fill: impl Fn(usize, &mut [f32]) -> bool) {
        let blocks = self.blocks(node);
        for y in self.next.max(blocks.start * SPACING)..blocks.end * SPACING {
            let place = y % self.pressed.len();
            let cells = &mut self.cells[place * self.width..][..self.width];
            if self.pressed[place] {
                cells.fill(0.0);
            }
            self.pressed[place] = fill(y, cells);
        }
        self.next = blocks.end * SPACING;
    }

    /// The rows with a pressure around a node, each with its weight.
    fn weighted<'r>(
        &'r self,
        node: usize,
        of_nodes: &'r [[f32; SPACING]],
    ) -> impl Iterator<Item = (f32, &'r [f32])> {
        let rows = self.blocks(node).flat_map(move |block| zip(block * SPACING.., of_nodes[node - block]));
        rows.filter_map(|(y, weight)| {
            let place = y % self.pressed.len();
            self.pressed[place].then(|| (weight, &self.cells[place * self.width..][..self.width]))
        })
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

    /// Cells of a line.
    fn cells(&self) -> usize {
        self.blocks * SPACING
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
        let mut cells = vec![0.0; interpolation.cells()];
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
