//! Two levels: the smooth far field on a coarse lattice, the near field by sums over close pairs.
//!
//! The kernel is split at a radius R into a part that is smooth everywhere and a part that ends at R:
//! `I(r) = S(r) + (I(r) - S(r))`. For `r >= R`, S is the kernel's own far field; inside it is continued by an
//! even polynomial in r (multi-level summation; Brandt and Lubrecht, J. Comput. Phys. 90, 348 (1990); Hardy
//! et al., J. Chem. Theory Comput. 11, 766 (2015)). S is interpolated from a lattice of a few cells' spacing,
//! where an FFT of that much smaller size sums it; the rest is exact for each close pair. The cost follows
//! the number of cells and of close pairs; the window matters only by the size of its lattice. It is made for
//! square cells and the free kernel.

use super::convolution::FftConvolution;
use super::influence::InfluenceOperator;
use crate::geometry::{CellSet, Lengths, Window};
use crate::kernel::Symbol;
use crate::kernel::love::influence;
use crate::real::Real;
use crate::tasks::each;
use contact_model::{Interrupted, Stop};
use std::fmt;

/// Spacing, reach and order of a two-level operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Split {
    /// Lattice spacing in cells.
    pub spacing: usize,
    /// Radius of the near part in lattice spacings.
    pub reach: usize,
    /// Points of the Lagrange interpolation in each direction, even.
    pub order: usize,
}

impl Split {
    /// Radius of the near part in cells.
    pub fn radius(self) -> usize {
        self.spacing * self.reach
    }

    /// Upper estimate of the error over the largest displacement with six points: 1e-4 at a reach of six
    /// spacings, 4e-6 at twelve.
    pub fn error(self) -> f64 {
        (self.reach as f64).powi(-5)
    }

    /// Window of the lattice that serves a window of cells.
    pub fn lattice(self, window: Window) -> Window {
        let nodes = |first: usize, count: usize| {
            let (low, high) = (first / self.spacing, (first + count - 1) / self.spacing);
            (low, high - low + self.order)
        };
        let ((x, width), (y, height)) = (nodes(window.x, window.width), nodes(window.y, window.height));
        Window { x, y, width, height }
    }

    /// Circular lengths that leave the near part free of wrap-around on a window.
    pub fn near_lengths(self, window: Window) -> Lengths {
        Lengths::reaching(window, self.radius())
    }

    /// Interpolation weights of a cell at this number of cells behind a node.
    pub fn weights(self, cell: usize) -> Vec<f64> {
        lagrange(cell as f64 / self.spacing as f64, self.order)
    }

    /// Symbol of the smooth kernel between the nodes of a lattice.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn far_symbol(self, lattice: Window, stop: Stop<'_>) -> Result<Symbol, Interrupted> {
        let (spacing, radius) = (self.spacing as f64, self.radius() as f64);
        let far = |x: usize, y: usize| smooth(distance(x, y) * spacing, radius);
        Symbol::of_kernel_until(Lengths::free(lattice), far, stop)
    }

    /// The near part of the kernel at a lag, `I - S`: 0 from the radius on.
    pub fn near(self, x: usize, y: usize) -> f64 {
        let (r, radius) = (distance(x, y), self.radius() as f64);
        if r < radius { influence(x, y) - smooth(r, radius) } else { 0.0 }
    }
}

/// A planned two-level operator for sets inside one window.
pub struct TwoLevel {
    window: Window,
    split: Split,
    lattice: Window,
    /// Interpolation weights of each position between two nodes.
    weights: Vec<Vec<f64>>,
    /// `I - S` at the lags `0 .. radius` in both directions.
    near: Vec<f64>,
    nodes: CellSet,
    charge: Vec<f64>,
    potential: Vec<f64>,
    far: FftConvolution<f64>,
}

impl fmt::Debug for TwoLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "TwoLevel({:?}, {:?})", self.window, self.split)
    }
}

impl TwoLevel {
    /// Plans for a window: the near table and the symbol of the smooth kernel on the lattice.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn new(window: Window, split: Split, stop: Stop<'_>) -> Result<Self, Interrupted> {
        let box_of_nodes = split.lattice(window);
        let local = Window { x: 0, y: 0, ..box_of_nodes };
        let symbol = split.far_symbol(local, stop)?;
        let nodes = CellSet::from_rows((0..local.height).map(|y| (y, 0..local.width as u32)));
        let radius = split.radius();
        Ok(Self {
            window,
            split,
            lattice: box_of_nodes,
            weights: (0..split.spacing).map(|i| split.weights(i)).collect(),
            near: (0..radius * radius).map(|i| split.near(i % radius, i / radius)).collect(),
            charge: vec![0.0; nodes.len()],
            potential: vec![0.0; nodes.len()],
            far: FftConvolution::new(local, symbol.lengths, symbol.scaled()),
            nodes,
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

    /// First node of a cell in the local lattice and its weights.
    fn node(&self, cell: usize, first: usize) -> (usize, &[f64]) {
        (cell / self.split.spacing - first, &self.weights[cell % self.split.spacing])
    }

    /// Pressure to the nodes: the transpose of [`Self::interpolate`]. A row of nodes gathers from the rows of
    /// cells around it.
    fn restrict<T: Real>(&mut self, sources: &CellSet, p: &[T], stop: Stop<'_>) -> Result<(), Interrupted> {
        let mut charge = std::mem::take(&mut self.charge);
        let (Split { spacing, order, .. }, lattice) = (self.split, self.lattice);
        let rows = charge.chunks_mut(lattice.width).enumerate();
        let restricted = each(sources.len() * order * order, rows, stop, |(ny, line)| {
            line.fill(0.0);
            let last = ny + lattice.y;
            let cells = (last + 1).saturating_sub(order) * spacing..(last + 1) * spacing;
            for row in sources.rows_within(cells) {
                let (first, wy) = self.node(row.y, lattice.y);
                let wy = wy[ny - first];
                for (&x, p) in row.columns.iter().zip(&p[row.span()]) {
                    let (nx, wx) = self.node(x as usize, lattice.x);
                    let weighted = p.to_f64() * wy;
                    for (c, &wx) in line[nx..].iter_mut().zip(wx) {
                        *c += weighted * wx;
                    }
                }
            }
        });
        self.charge = charge;
        restricted
    }

    fn interpolate<T: Real>(&self, targets: &CellSet, u: &mut [T]) {
        let (width, order) = (self.lattice.width, self.split.order);
        targets.update(targets.len() * order * order, u, |row, u| {
            let (ny, wy) = self.node(row.y, self.lattice.y);
            for (&x, u) in row.columns.iter().zip(&mut u[row.span()]) {
                let (nx, wx) = self.node(x as usize, self.lattice.x);
                let mut sum = 0.0;
                for (j, &wy) in wy.iter().enumerate() {
                    let line = &self.potential[(ny + j) * width + nx..][..wx.len()];
                    sum += wy * line.iter().zip(wx).map(|(c, w)| c * w).sum::<f64>();
                }
                *u = T::of(sum);
            }
        });
    }

    fn add_near<T: Real>(
        &self,
        sources: &CellSet,
        p: &[T],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let radius = self.split.radius();
        // Contact comes in clusters: most cells have others all around.
        let work = targets.len() * sources.len().min(radius * radius);
        targets.update_until(work, u, stop, |target, u| {
            for source in sources.rows_within((target.y + 1).saturating_sub(radius)..target.y + radius) {
                let line = &self.near[source.y.abs_diff(target.y) * radius..][..radius];
                let (columns, p) = (source.columns, &p[source.span()]);
                let (mut low, mut high) = (0, 0);
                for (&x, u) in target.columns.iter().zip(&mut u[target.span()]) {
                    while low < columns.len() && columns[low] as usize + radius <= x as usize {
                        low += 1;
                    }
                    while high < columns.len() && (columns[high] as usize) < x as usize + radius {
                        high += 1;
                    }
                    let close = columns[low..high].iter().zip(&p[low..high]);
                    let sum: f64 = close.map(|(&xs, p)| line[x.abs_diff(xs) as usize] * p.to_f64()).sum();
                    *u += T::of(sum);
                }
            }
        })
    }
}

impl<T: Real> InfluenceOperator<T> for TwoLevel {
    /// The result is exact up to the error of the interpolation. Both sets have to lie inside the window.
    ///
    /// Cost: order^2 for each cell, one for each close pair, and the transform of the lattice.
    fn apply_until(
        &mut self,
        sources: &CellSet,
        p: &[T],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        self.restrict(sources, p, stop)?;
        self.far.apply_until(&self.nodes, &self.charge, &self.nodes, &mut self.potential, stop)?;
        self.interpolate(targets, u);
        self.add_near(sources, p, targets, u, stop)
    }
}

/// Distance of two places of a lattice: its square is exact.
fn distance(x: usize, y: usize) -> f64 {
    ((x * x + y * y) as f64).sqrt()
}

/// The smooth part of the kernel: `1/r + 1/(24 r^3)` from `radius` on, inside its Taylor series in r^2 about
/// `radius`.
fn smooth(r: f64, radius: f64) -> f64 {
    if r >= radius {
        return (1.0 + 1.0 / (24.0 * r * r)) / r;
    }
    let s = (r / radius).powi(2) - 1.0;
    let (mut power, mut first, mut third) = (1.0, 1.0, 1.0);
    let (mut a, mut b) = (1.0, 1.0);
    for j in 1..=SMOOTHNESS {
        // Binomial series of (1 + s)^(-1/2) and (1 + s)^(-3/2).
        let j = f64::from(j);
        power *= s;
        a *= (-0.5 - (j - 1.0)) / j;
        b *= (-1.5 - (j - 1.0)) / j;
        first += a * power;
        third += b * power;
    }
    first / radius + third / (24.0 * radius.powi(3))
}

/// Continuous derivatives of the smooth kernel at the radius.
const SMOOTHNESS: i32 = 5;

/// Weights of Lagrange interpolation at `t` in [0, 1) between the two middle nodes of `order`.
fn lagrange(t: f64, order: usize) -> Vec<f64> {
    let at = t + (order / 2 - 1) as f64;
    let weight = |i: usize| -> f64 {
        let others = (0..order).filter(|&j| j != i);
        others.map(|j| (at - j as f64) / (i as f64 - j as f64)).product()
    };
    (0..order).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::kernel::NormalTable;
    use crate::operator::DirectSum;
    use approx::assert_relative_eq;
    use contact_model::Boundary;
    use contact_model::never;

    const SIDE: usize = 200;
    const GRID: Grid = Grid { columns: SIDE, rows: SIDE, stretch: 1.0 };

    fn exactly(set: &CellSet, p: &[f64]) -> Vec<f64> {
        let mut u = vec![0.0; set.len()];
        DirectSum(&NormalTable::shared(GRID, Boundary::Free)).apply(set, p, set, &mut u);
        u
    }

    fn scattered() -> CellSet {
        // Clusters and loners.
        let keep = |i: u32| {
            let (x, y) = (i % SIDE as u32, i / SIDE as u32);
            (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) % 97 < 3
                || ((x / 9) * (y / 11)) % 13 == 5
        };
        CellSet::from_index(GRID, &(0..(SIDE * SIDE) as u32).filter(|&i| keep(i)).collect::<Vec<_>>())
    }

    /// Largest error relative to the largest displacement.
    fn error(split: Split) -> f64 {
        let set = scattered();
        let p: Vec<f64> = (0..set.len()).map(|k| 1.0 + (k as f64).sin()).collect();
        let (exact, mut fast) = (exactly(&set, &p), vec![0.0; set.len()]);
        TwoLevel::new(set.window().unwrap(), split, &never).unwrap().apply(&set, &p, &set, &mut fast);
        let scale = exact.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        exact.iter().zip(&fast).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
    }

    #[test]
    fn the_smooth_kernel_is_the_far_field_to_sixth_order_at_the_radius() {
        // A radius so small that the term 1/(24 r^3) is a fair part of it.
        let radius = 2.0;
        let far = |r: f64| 1.0 / r + 1.0 / (24.0 * r.powi(3));
        for r in [2.0, 2.5, 40.0] {
            assert_relative_eq!(smooth(r, radius), far(r), max_relative = 1e-15);
        }
        for t in [0.99, 0.97, 0.9] {
            // Taylor in s = t^2 - 1: the first coefficients left out are 0.226 and 2.93 of s^6.
            let (s, r) = (t * t - 1.0_f64, t * radius);
            let left_out = far(r) - smooth(r, radius);
            let first = s.powi(6) * (0.225_585_937_5 / radius + 2.932_617_187_5 / (24.0 * radius.powi(3)));
            assert!((left_out / first - 1.0).abs() < 1.5 * s.abs() + 1e-4, "{t}: {left_out} {first}");
        }
        // At the origin s = -1: the sums of (1, 1/2, 3/8, 5/16, 35/128, 63/256) and of (1, 3/2, 15/8, 35/16,
        // 315/128, 693/256).
        let origin = 2.707_031_25 / radius + 11.730_468_75 / (24.0 * radius.powi(3));
        assert_relative_eq!(smooth(0.0, radius), origin, max_relative = 1e-15);
    }

    #[test]
    fn interpolation_is_centred() {
        let expect = |t: f64, weights: &[f64]| {
            for (found, expected) in lagrange(t, weights.len()).iter().zip(weights) {
                assert_relative_eq!(found, expected, epsilon = 1e-15, max_relative = 1e-14);
            }
        };
        // Midway between the middle nodes: 9/16 of each and -1/16 of the outer ones.
        expect(0.5, &[-0.0625, 0.5625, 0.5625, -0.0625]);
        expect(0.25, &[0.75, 0.25]);
        expect(0.0, &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn a_window_anywhere_has_the_nodes_that_its_cells_interpolate_from() {
        // Spacing 4: cells 9 to 14 lie between nodes 2 and 4, cells 4 to 7 between 1 and 2; order 6 takes
        // four nodes more than that.
        let split = Split { spacing: 4, reach: 6, order: 6 };
        assert_eq!(
            split.lattice(Window { x: 9, y: 4, width: 6, height: 4 }),
            Window { x: 2, y: 1, width: 7, height: 6 }
        );
        // Wherever the cells lie, the lattice lies under them.
        let moved = |by: u32| {
            let place = |i: u32| by + 7 * (i % 9) + SIDE as u32 * (by + 11 * (i / 9));
            let set = CellSet::from_index(GRID, &(0..45).map(place).collect::<Vec<_>>());
            let p: Vec<f64> = (0..set.len()).map(|k| 1.0 + (k as f64).sin()).collect();
            (set, p)
        };
        for by in [0, 5, 60] {
            let (set, p) = moved(by);
            let (exact, mut fast) = (exactly(&set, &p), vec![0.0; p.len()]);
            let mut operator = TwoLevel::new(set.window().unwrap(), split, &never).unwrap();
            operator.apply(&set, &p, &set, &mut fast);
            for (a, b) in exact.iter().zip(&fast) {
                assert_relative_eq!(a, b, max_relative = 1e-3);
            }
            assert!(format!("{operator:?}").starts_with("TwoLevel(Window"));
        }
    }

    #[test]
    fn the_error_falls_with_the_order_and_with_the_reach() {
        let mut last = f64::INFINITY;
        for order in [2, 4, 6, 8] {
            let e = error(Split { spacing: 4, reach: 6, order });
            println!("spacing 4, reach 6, order {order}: {e:.1e}");
            assert!(e < 0.4 * last, "order {order}: {e}");
            last = e;
        }
        let mut last = f64::INFINITY;
        for reach in [3, 6, 12] {
            let e = error(Split { spacing: 4, reach, order: 6 });
            println!("spacing 4, reach {reach}, order 6: {e:.1e}");
            assert!(e < 0.2 * last, "reach {reach}: {e}");
            last = e;
        }
    }
}
