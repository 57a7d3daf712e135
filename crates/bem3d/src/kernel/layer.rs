//! Normal displacement of a layer on a base, for maps with a free edge and for maps that repeat themselves.
//!
//! The kernel is that of a half-space of the layer's material, which has its closed forms, and what the base
//! changes: of a map with a free edge the flux of `super::layer_flux`, of a map that repeats itself a sum over
//! the waves that the grid does not distinguish. A body that presses on the layer adds its own compliance as a
//! half-space, so that the base changes only the layer's `share` of all of it.

use super::definition::{Coefficients, Evidence, Kernel};
use super::layer_flux::LayerFlux;
use super::layer_symbol::LayerSymbol;
use super::love::influence_row;
use super::period::Period;
use super::periodic::{PeriodicKernel, raised_above_zero};
use super::symbol::Parity;
use super::waves::{Integrand, continuous_symbol, excess_symbol, symbol, symbol_at};
use crate::geometry::Grid;
use contact_model::Boundary;
use std::f64::consts::{PI, TAU};

/// A layer in the units of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerOnGrid {
    /// Its thickness over `c = sqrt(dx dy)`.
    pub thickness: f64,
    /// Its share of the compliance of both bodies as half-spaces: E* of both over that of its material.
    pub share: f64,
    /// How it yields to waves of pressure.
    pub symbol: LayerSymbol,
}

impl LayerOnGrid {
    /// The displacement under a wave of pressure less that of two half-spaces, relative to the latter. The wave is in
    /// radians over c.
    pub fn excess(&self, wave: f64) -> f64 {
        self.share * self.symbol.excess(wave * self.thickness)
    }
}

/// A layer on its base under the pressures on a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayeredBody {
    /// The grid.
    pub grid: Grid,
    /// The boundary of the map.
    pub boundary: Boundary,
    /// The layer.
    pub layer: LayerOnGrid,
    /// The pressures for which the kernel is exact, if the map repeats itself.
    pub exact_for: PeriodicKernel,
}

/// Waves along each direction at which the smallest response is looked for.
const SAMPLED_WAVES: usize = 4;

/// Largest excess of the response to the longest waves of a map at which a kernel may be shortened. At 9 (a layer ten
/// times as hard as its base) either way took the same time (2026-11), at 99 corrections diverged.
const LONG_WAVES: f64 = 2.0;

impl LayeredBody {
    /// Adds the difference between the layer on its base and a half-space at the lags `(0 .., y)`.
    fn add_excess(&self, flux: &LayerFlux, y: usize, row: &mut [f64]) {
        let Self { grid, layer, .. } = self;
        let ((a, b), h) = (grid.cell(), layer.thickness);
        // In thicknesses.
        let (a, b) = (a / h, b / h);
        let y = y as f64 * b;
        let (low, high) = (y - 0.5 * b, y + 0.5 * b);
        // Flux through the side to the left of a cell; that of the first cell is to the right of its mirror image.
        let mut left = -0.5 * a * flux.along(0.5 * a, low, high);
        for (x, value) in row.iter_mut().enumerate() {
            let x = x as f64 * a;
            let (west, east) = (x - 0.5 * a, x + 0.5 * a);
            let right = east * flux.along(east, low, high);
            let across = |at: f64| at * flux.along(at.abs(), west, east);
            *value += layer.share * h * (right - left + across(high) - across(low));
            left = right;
        }
    }

    /// The symbol at the waves of a periodic grid, without the mean.
    fn waves(&self, grid: Grid) -> Vec<f64> {
        if self.exact_for == PeriodicKernel::Waves {
            return continuous_symbol(grid, |wave| 1.0 + self.layer.excess(wave));
        }
        let excess = excess_symbol(grid, |wave| self.layer.excess(wave), self.layer.thickness);
        symbol(grid, Integrand::Normal).into_iter().zip(excess).map(|(all, excess)| all + excess).collect()
    }

    /// The kernel at the lags of one period. Exact to rounding: the displacement at cell centres under uniform
    /// pressure on cells, measured from its mean, and a constant that makes all entries positive.
    fn period(&self) -> Period<1> {
        let grid = self.grid;
        let waves = self.waves(grid);
        let period = raised_above_zero(Period::from_waves(grid, self.parities(), [waves]), grid);
        if grid.columns == grid.rows && grid.has_square_cells() { period.symmetric() } else { period }
    }
}

impl Kernel<1> for LayeredBody {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn boundary(&self) -> Boundary {
        self.boundary
    }

    fn parities(&self) -> [[Parity; 2]; 1] {
        [[Parity::Even; 2]]
    }

    fn coefficients(&self) -> Coefficients<1> {
        if self.boundary == Boundary::Periodic {
            return Coefficients::Period(self.period());
        }
        let (body, (a, b)) = (*self, self.grid.cell());
        let farthest = ((self.grid.columns as f64) * a).hypot((self.grid.rows as f64) * b);
        let flux = LayerFlux::shared(&self.layer.symbol, farthest / self.layer.thickness);
        Coefficients::Lags(Box::new(move |_, y, row| {
            influence_row(y, body.grid.stretch, row);
            body.add_excess(&flux, y, row);
        }))
    }

    /// The response to the longest waves of a map and to some waves between them and the checkerboard, less a tenth: an
    /// estimate, which a test compares with the eigenvalues of small maps.
    fn smallest_eigenvalue(&self) -> f64 {
        let Grid { columns, rows, .. } = self.grid;
        let waves = |cells: usize| {
            let longest = PI / cells.max(2) as f64;
            (1..=SAMPLED_WAVES).map(|k| PI * k as f64 / SAMPLED_WAVES as f64).chain([0.0, longest])
        };
        let all = waves(columns).flat_map(|x| waves(rows).map(move |y| (x, y)));
        let response = |(x, y): (f64, f64)| {
            let excess = |wave: f64| self.layer.excess(wave);
            match self.exact_for {
                PeriodicKernel::Cells => symbol_at(self.grid, excess, (x, y)),
                PeriodicKernel::Waves => {
                    let (a, b) = self.grid.cell();
                    let q = (x / a).hypot(y / b);
                    TAU * (1.0 + excess(q)) / q
                }
            }
        };
        0.9 * all.filter(|&(x, y)| x + y > 0.0).map(response).fold(f64::INFINITY, f64::min)
    }

    /// Not of a layer that is harder than its base. It yields most to long waves, so that corrections by a kernel
    /// that is wrong at long lags diverge.
    fn may_be_shortened(&self) -> bool {
        let Grid { columns, rows, .. } = self.grid;
        self.layer.excess(PI / columns.max(rows) as f64) < LONG_WAVES
    }

    fn inverse_m_matrix(&self) -> Evidence {
        // A layer on a rigid base bulges beside a load.
        Evidence::Violated
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::{Layer, LayerBase};
    use numerics::gauss::Gauss;

    /// A layer whose thickness is counted in cells, and under a rigid body.
    fn body(grid: Grid, boundary: Boundary, thickness: f64, base: LayerBase, poisson: f64) -> LayeredBody {
        let layer = Layer { thickness, young: 1.0, poisson, base };
        let layer = LayerOnGrid { thickness, share: 1.0, symbol: LayerSymbol::new(&layer) };
        LayeredBody { grid, boundary, layer, exact_for: PeriodicKernel::Cells }
    }

    /// A base with this shear modulus, over that of the layer.
    fn half_space(layer_poisson: f64, shear_ratio: f64, poisson: f64) -> LayerBase {
        LayerBase::HalfSpace { young: (1.0 + poisson) / (1.0 + layer_poisson) / shear_ratio, poisson }
    }

    fn rows(body: &LayeredBody) -> Vec<Vec<f64>> {
        let coefficients = body.coefficients();
        (0..body.grid.rows)
            .map(|y| {
                let mut row = vec![0.0; body.grid.columns];
                coefficients.fill(0, y, &mut row);
                row
            })
            .collect()
    }

    fn bases() -> [(f64, LayerBase); 7] {
        [
            (0.3, LayerBase::Rigid),
            (0.5, LayerBase::Rigid),
            (0.2, LayerBase::Slipping),
            (0.3, half_space(0.3, 0.05, 0.4)),
            (0.25, half_space(0.25, 8.0, 0.3)),
            (0.2, half_space(0.2, 1e4, 0.5)),
            (0.5, half_space(0.5, 1e-4, 0.0)),
        ]
    }

    /// The smallest eigenvalue of the matrix of a whole map, by powers of its distance from a larger one, is not below
    /// the estimate.
    #[test]
    fn no_map_has_a_smaller_eigenvalue() {
        for (poisson, base) in bases() {
            for thickness in [0.3, 1.0, 5.0] {
                let grid = Grid { columns: 9, rows: 7, stretch: 1.2 };
                let body = body(grid, Boundary::Free, thickness, base, poisson);
                let (rows, cells) = (rows(&body), grid.count());
                let entry = |i: usize, j: usize| rows[(i / 9).abs_diff(j / 9)][(i % 9).abs_diff(j % 9)];
                let product = |v: &[f64]| -> Vec<f64> {
                    (0..cells).map(|i| (0..cells).map(|j| entry(i, j) * v[j]).sum()).collect()
                };
                let largest = (0..cells)
                    .map(|i| (0..cells).map(|j| entry(i, j).abs()).sum::<f64>())
                    .fold(0.0, f64::max);
                let mut v: Vec<f64> = (0..cells).map(|i| ((i * i) as f64).sin()).collect();
                for _ in 0..4000 {
                    let image = product(&v);
                    v.iter_mut().zip(image).for_each(|(v, image)| *v = largest * *v - image);
                    let norm = v.iter().map(|v| v * v).sum::<f64>().sqrt();
                    for v in &mut v {
                        *v /= norm;
                    }
                }
                let smallest: f64 = product(&v).iter().zip(&v).map(|(a, b)| a * b).sum();
                let estimate = body.smallest_eigenvalue();
                assert!(
                    estimate > 0.0 && estimate <= smallest,
                    "{base:?} {thickness}: {estimate} {smallest}"
                );
            }
        }
    }

    /// The point force itself, integrated over the cell in both directions.
    #[test]
    fn coefficients_are_integrals_over_a_cell() {
        let waves = Gauss::<16>::new();
        for (poisson, base) in bases() {
            for (thickness, stretch) in [(0.6, 1.0), (3.0, 1.7), (40.0, 1.0)] {
                let grid = Grid { columns: 9, rows: 6, stretch };
                let body = body(grid, Boundary::Free, thickness, base, poisson);
                let found = rows(&body);
                let point = |r: f64| {
                    let r = r / thickness;
                    // Waves are short enough for the oscillation and for a change at small ones.
                    let step = 0.4_f64.min(1.0 / r);
                    let mut ends = vec![0.0, 1e-6_f64];
                    while ends[ends.len() - 1] < 24.0 {
                        let last = ends[ends.len() - 1];
                        ends.push(last + last.min(step));
                    }
                    let integrand = |w: f64| body.layer.symbol.excess(w) * libm::j0(w * r);
                    ends.windows(2).map(|w| waves.integrate(w[0], w[1], integrand)).sum::<f64>() / thickness
                };
                let (a, b) = grid.cell();
                let gauss = Gauss::<16>::new();
                let halves = |x: f64, side: f64| [(x - 0.5 * side, x), (x, x + 0.5 * side)];
                for (x, y) in [(0, 0), (1, 0), (0, 2), (5, 3), (8, 5)] {
                    let mut half_space = vec![0.0; grid.columns];
                    influence_row(y, stretch, &mut half_space);
                    let mut expected = half_space[x];
                    for (south, north) in halves(y as f64 * b, b) {
                        for (west, east) in halves(x as f64 * a, a) {
                            expected += gauss.integrate(south, north, |v| {
                                gauss.integrate(west, east, |u| point(u.hypot(v)))
                            });
                        }
                    }
                    let scale = found[0][0].max(half_space[0]);
                    let error = (found[y][x] - expected).abs() / scale;
                    assert!(
                        error < 1e-11,
                        "{base:?} {thickness} ({x}, {y}): {} {expected}, {error:e}",
                        found[y][x]
                    );
                }
            }
        }
    }

    /// The polynomials are the integral, near and far.
    #[test]
    fn a_layer_of_the_material_of_its_base_is_none() {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            for thickness in [0.1, 2.0, 1e4] {
                let grid = Grid { columns: 12, rows: 10, stretch: 1.3 };
                let same = half_space(0.3, 1.0, 0.3);
                let layered = rows(&body(grid, boundary, thickness, same, 0.3));
                let table = super::super::NormalTable::shared(grid, boundary);
                for (y, row) in layered.iter().enumerate() {
                    for (x, value) in row.iter().enumerate() {
                        let [expected] = table.lag(x, y);
                        assert!((value - expected).abs() < 1e-12, "{boundary:?} {thickness} {x} {y}");
                    }
                }
            }
        }
    }

    /// Far below the cells the base is what is pressed; far above them it is not seen.
    #[test]
    fn thin_and_thick_layers() {
        let grid = Grid { columns: 20, rows: 1, stretch: 1.0 };
        let base = half_space(0.25, 5.0, 0.25);
        let [thin, thinner, thick] =
            [1e-5, 1e-7, 1e9].map(|h| rows(&body(grid, Boundary::Free, h, base, 0.25)).remove(0));
        let mut half_space = vec![0.0; 20];
        influence_row(0, 1.0, &mut half_space);
        for x in 0..20 {
            assert!((thinner[x] - 5.0 * half_space[x]).abs() < 1e-5 * half_space[0], "{x}");
            assert!((thick[x] - half_space[x]).abs() < 1e-8);
        }
        let difference = |row: &[f64]| row[0] - 5.0 * half_space[0];
        assert!((difference(&thin) / difference(&thinner) - 100.0).abs() < 0.1);
    }

    /// Copies of a map on a layer that decays: their sum is the periodic kernel, up to its mean.
    #[test]
    fn a_cell_and_its_images() {
        for (poisson, base) in bases().into_iter().take(3) {
            for thickness in [0.3, 0.8, 1.3] {
                let (columns, rows_of) = (6, 5);
                let grid = Grid { columns, rows: rows_of, stretch: 1.2 };
                let periodic = rows(&body(grid, Boundary::Periodic, thickness, base, poisson));
                let times = 14;
                let wide = Grid { columns: columns * times, rows: rows_of * times, stretch: 1.2 };
                let free = rows(&body(wide, Boundary::Free, thickness, base, poisson));
                let images = |x: usize, y: usize| -> f64 {
                    let lags = |at: usize, n: usize| {
                        let most = times.cast_signed() - 1;
                        (-most..most).map(move |i| (at.cast_signed() + i * n.cast_signed()).unsigned_abs())
                    };
                    lags(y, rows_of)
                        .flat_map(|y| lags(x, columns).map(move |x| (x, y)))
                        .map(|(x, y)| free[y][x])
                        .sum()
                };
                let constant = images(0, 0) - periodic[0][0];
                for (x, y) in [(1, 0), (0, 1), (3, 2), (5, 4)] {
                    let (found, expected) = (periodic[y][x], images(x, y) - constant);
                    assert!(
                        (found - expected).abs() < 1e-10,
                        "{base:?} {thickness} {x} {y}: {found} {expected}"
                    );
                }
            }
        }
    }
}
