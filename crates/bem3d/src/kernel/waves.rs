//! Fourier transforms of the displacements under uniform tractions on cells, at the waves of a periodic grid.

use super::alternating::{TERMS, alternating_weights};
use crate::geometry::Grid;
use std::f64::consts::{PI, TAU};

/// Chebyshev polynomials in each direction for the smooth part of the symbol of square cells: the error falls
/// as 5.8^-n.
const MODES: usize = 22;
/// From this number of polynomials on, which oblong cells need, the sums are evaluated at every wave.
const MOST_MODES: usize = 256;

/// Fourier transforms of the displacements under a point force, over `2 pi`: see [`super::cerruti`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Integrand {
    /// `1/r`: `1/|q|`.
    Normal,
    /// `x^2/r^3`: `qy^2/|q|^3`.
    AlongX,
    /// `y^2/r^3`: `qx^2/|q|^3`.
    AlongY,
    /// `x y/r^3`: `-qx qy/|q|^3`, odd in both.
    Across,
    /// `x/r^2`: `qx/|q|^2` times `-i`, odd along x.
    CouplingX,
    /// `y/r^2`: `qy/|q|^2` times `-i`, odd along y.
    CouplingY,
}

impl Integrand {
    /// The value at a wave times a factor.
    fn at(self, factor: f64, qx: f64, qy: f64) -> f64 {
        let q = qx.hypot(qy);
        match self {
            Self::Normal => factor / q,
            Self::AlongX => factor * (qy / q).powi(2) / q,
            Self::AlongY => factor * (qx / q).powi(2) / q,
            Self::Across => -factor * (qx / q) * (qy / q) / q,
            Self::CouplingX => factor * (qx / q) / q,
            Self::CouplingY => factor * (qy / q) / q,
        }
    }

    /// An odd factor, so that the rest is even.
    fn odd_factor(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Normal | Self::AlongX | Self::AlongY => 1.0,
            Self::Across => x * y,
            Self::CouplingX => x,
            Self::CouplingY => y,
        }
    }
}

/// The symbol at the waves of a grid, `[kx * (rows / 2 + 1) + ky]`, 0 at the mean.
pub(super) fn symbol(grid: Grid, integrand: Integrand) -> Vec<f64> {
    let (a, b) = grid.cell();
    let aliases = AliasSum::new(integrand, (a, b));
    let symmetric = grid.has_square_cells() && integrand == Integrand::Normal;
    let alias = |x: f64, y: f64| {
        let (x, y) = if symmetric { (x.max(y), x.min(y)) } else { (x, y) };
        let odd = integrand.odd_factor(x, y);
        if odd > 0.0 { aliases.at(x, y) / odd } else { 0.0 }
    };
    at_waves(grid, alias, |alias, x, y| first(integrand, x, y, a, b) + alias * integrand.odd_factor(x, y))
}

/// Values at the waves of a grid, `[kx * (rows / 2 + 1) + ky]`, 0 at the mean: `whole(alias, x, y)`, of a smooth even
/// part that is evaluated at few waves and interpolated.
fn at_waves(grid: Grid, alias: impl Fn(f64, f64) -> f64, whole: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
    let (a, b) = grid.cell();
    let (along_x, along_y) =
        (WaveInterpolation::new(grid.columns, a / b), WaveInterpolation::new(grid.rows, b / a));
    let values: Vec<Vec<f64>> =
        along_y.nodes.iter().map(|&y| along_x.nodes.iter().map(|&x| alias(x, y)).collect()).collect();
    let wave = |k: usize, n: usize| TAU * k as f64 / n as f64;
    let mut symbol = Vec::with_capacity((grid.columns / 2 + 1) * (grid.rows / 2 + 1));
    for kx in 0..=grid.columns / 2 {
        let line: Vec<f64> = values.iter().map(|row| along_x.at(kx, row)).collect();
        for ky in 0..=grid.rows / 2 {
            let (x, y) = (wave(kx, grid.columns), wave(ky, grid.rows));
            symbol.push(if (kx, ky) == (0, 0) { 0.0 } else { whole(along_y.at(ky, &line), x, y) });
        }
    }
    symbol
}

/// The difference between the symbols of a layer and of a half-space at the waves of a grid, in the order of [`symbol`]:
/// it has `excess(q)/|q|` where that has `1/|q|`. The excess falls off beyond `1/length`.
///
/// Waves that the grid does not distinguish are few where the length is a cell or more, and are summed as they are.
/// Beside larger cells the excess changes slowly from one of them to the next, and they are an alternating sum.
pub(super) fn excess_symbol(grid: Grid, excess: impl Fn(f64) -> f64, length: f64) -> Vec<f64> {
    let (a, b) = grid.cell();
    if length >= FEW_ALIASES * a.max(b) {
        return at_waves(grid, |_, _| 0.0, |_, x, y| excess_at(grid, &excess, length, (x, y)));
    }
    let aliases = AliasSum::new(Integrand::Normal, (a, b));
    at_waves(
        grid,
        |x, y| aliases.with(x, y, &excess),
        |alias, x, y| alias + first(Integrand::Normal, x, y, a, b) * excess((x / a).hypot(y / b)),
    )
}

/// Beyond this wave times the length the excess is below rounding.
const LARGEST_EXCESS: f64 = 22.0;
/// From this length over the side of a cell on, each alias is summed.
const FEW_ALIASES: f64 = 0.5;

/// The symbol `2 pi factor(q)/|q|` of a continuum at the waves of a grid, in the order of [`symbol`]: pressures are waves
/// too, and no wave stands for others.
pub(super) fn continuous_symbol(grid: Grid, factor: impl Fn(f64) -> f64) -> Vec<f64> {
    let (a, b) = grid.cell();
    at_waves(
        grid,
        |_, _| 0.0,
        |_, x, y| {
            let q = (x / a).hypot(y / b);
            TAU * factor(q) / q
        },
    )
}

/// The sum of the excess over a wave (in radians a cell) and its aliases.
fn excess_at(grid: Grid, excess: impl Fn(f64) -> f64, length: f64, (x, y): (f64, f64)) -> f64 {
    let (a, b) = grid.cell();
    let most = LARGEST_EXCESS / length;
    // Waves along one direction: `x + 2 pi m` over the side, with their factors.
    let along = |q: f64, side: f64| -> Vec<(f64, f64)> {
        let reach = ((most * side + q) / TAU).floor() as i32;
        (-reach..=reach)
            .map(|m| q + TAU * f64::from(m))
            .filter(|wave| wave.abs() <= most * side)
            .map(|wave| (wave / side, sinc(wave / 2.0)))
            .collect()
    };
    let (x, y) = (along(x, a), along(y, b));
    let mut sum = 0.0;
    for &(wy, fy) in &y {
        for &(wx, fx) in &x {
            let q = wx.hypot(wy);
            if q > 0.0 && q < most {
                sum += fx * fy * excess(q) / q;
            }
        }
    }
    TAU * sum
}

/// The symbol of a half-space and the excess at one wave, in radians a cell, with the waves that the grid does not
/// distinguish from it.
pub(super) fn symbol_at(grid: Grid, excess: impl Fn(f64) -> f64, (x, y): (f64, f64)) -> f64 {
    let (a, b) = grid.cell();
    let factor = |q: f64| 1.0 + excess(q);
    let aliases = AliasSum::new(Integrand::Normal, (a, b));
    first(Integrand::Normal, x, y, a, b) * factor((x / a).hypot(y / b)) + aliases.with(x, y, factor)
}

/// `sin(x) / x`.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

/// The continuum's share of the symbol at a wave (in radians a cell) of cells a x b: `2 pi / |q|` times the
/// transform of a cell.
fn first(integrand: Integrand, x: f64, y: f64, a: f64, b: f64) -> f64 {
    integrand.at(TAU, x / a, y / b) * sinc(x / 2.0) * sinc(y / 2.0)
}

/// From the values of an even function at a few waves between 0 and pi to those at the waves of a grid.
///
/// The contribution of the waves that the grid does not distinguish from q (aliases) is analytic for
/// `|x| < 2 pi` and `|Im x| < (a/b) pi`, so that polynomials in `2 (x/pi)^2 - 1` represent it: few of them
/// unless the cells are oblong.
struct WaveInterpolation {
    /// The nodes at which values are needed.
    nodes: Vec<f64>,
    /// Weights of the values at each wave; empty where the nodes are the waves.
    weights: Vec<Vec<f64>>,
}

impl WaveInterpolation {
    /// For the waves `2 pi k / n`, `k = 0 ..= n/2`; `aspect` is that of the cell, along over across.
    fn new(n: usize, aspect: f64) -> Self {
        let waves: Vec<f64> = (0..=n / 2).map(|k| TAU * k as f64 / n as f64).collect();
        let modes = (MODES as f64 * (1f64.asinh() / aspect.asinh()).max(1.0)).ceil() as usize;
        if modes > MOST_MODES || modes >= waves.len() {
            return Self { nodes: waves, weights: Vec::new() };
        }
        let angle = |i: usize| PI * (2 * i + 1) as f64 / (2 * modes) as f64;
        let nodes = (0..modes).map(|i| PI * f64::midpoint(angle(i).cos(), 1.0).sqrt()).collect();
        let polynomials = |q: f64| {
            let x = (2.0 * (q / PI).powi(2) - 1.0).clamp(-1.0, 1.0);
            let mut pair = (1.0, x);
            std::iter::from_fn(move || {
                let value = pair.0;
                pair = (pair.1, 2.0 * x * pair.1 - pair.0);
                Some(value)
            })
        };
        let norm = |j: usize| if j == 0 { 1.0 } else { 2.0 } / modes as f64;
        let weight = |q: f64, i: usize| {
            polynomials(q)
                .take(modes)
                .enumerate()
                .map(|(j, t)| norm(j) * t * (j as f64 * angle(i)).cos())
                .sum()
        };
        let weights = waves.iter().map(|&q| (0..modes).map(|i| weight(q, i)).collect()).collect();
        Self { nodes, weights }
    }

    fn at(&self, k: usize, values: &[f64]) -> f64 {
        self.weights.get(k).map_or_else(|| values[k], |weights| dot(weights, values))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Sums over the aliases of waves on cells of the sides a and b.
struct AliasSum {
    integrand: Integrand,
    cell: (f64, f64),
    /// Weights of the terms of an alternating sum.
    weights: [f64; TERMS],
}

impl AliasSum {
    fn new(integrand: Integrand, cell: (f64, f64)) -> Self {
        Self { integrand, cell, weights: alternating_weights() }
    }

    /// The aliases of the wave (x, y): `sum 2 pi / |Q| sinc(X/2) sinc(Y/2)` over `X = x + 2 pi m`,
    /// `Y = y + 2 pi n`, `Q = (X/a, Y/b)`, without `m = n = 0`; `0 <= x, y <= pi`. For other integrands than
    /// [`Integrand::Normal`] their factor replaces `1 / |Q|`.
    fn at(&self, x: f64, y: f64) -> f64 {
        self.with(x, y, |_| 1.0)
    }

    /// The same with a factor that depends on |Q|.
    fn with(&self, x: f64, y: f64, factor: impl Fn(f64) -> f64) -> f64 {
        let (a, b) = self.cell;
        let (x, y) = (self.terms(x, a), self.terms(y, b));
        let mut sum = 0.0;
        for (i, &(wy, fy)) in y.iter().enumerate() {
            for &(wx, fx) in &x[usize::from(i == 0)..] {
                sum += self.integrand.at(fx * fy * factor(wx.hypot(wy)), wx, wy);
            }
        }
        TAU * sum
    }

    /// Waves over the side of a cell, and their factors, along one direction.
    ///
    /// `sin((q + 2 pi m)/2) = (-1)^m sin(q/2)`: alternating sums over m = 1, 2, .. and m = -1, -2, ..
    fn terms(&self, q: f64, side: f64) -> Vec<(f64, f64)> {
        let sine = 2.0 * (q / 2.0).sin();
        let half = |sign: f64| {
            self.weights.iter().enumerate().map(move |(k, w)| {
                let wave = q + sign * TAU * (k + 1) as f64;
                (wave / side, -w * sine / wave)
            })
        };
        std::iter::once((q / side, sinc(q / 2.0))).chain(half(1.0)).chain(half(-1.0)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::love::{SMALLEST_EIGENVALUE, smallest_eigenvalue};
    use approx::assert_relative_eq;

    #[test]
    fn sine_over_its_argument_on_both_sides_of_its_series() {
        for x in [1e-8, 9e-5, -9e-5, 1.1e-4, 0.5, PI / 2.0] {
            assert_relative_eq!(sinc(x), f64::sin(x) / x, max_relative = 1e-15);
        }
        assert_relative_eq!(sinc(0.0), 1.0);
    }

    #[test]
    fn interpolation_finds_the_sums() {
        for aspect in [1.0f64, 4.0, 0.1] {
            let (a, b) = (aspect.sqrt(), aspect.sqrt().recip());
            let (nx, ny) = (2000, 600);
            let (along_x, along_y) = (WaveInterpolation::new(nx, a / b), WaveInterpolation::new(ny, b / a));
            assert!(!along_x.weights.is_empty() && !along_y.weights.is_empty());
            let aliases = AliasSum::new(Integrand::Normal, (a, b));
            let value = |y: f64| -> Vec<f64> { along_x.nodes.iter().map(|&x| aliases.at(x, y)).collect() };
            let values: Vec<Vec<f64>> = along_y.nodes.iter().map(|&y| value(y)).collect();
            for (kx, ky) in [(0, 0), (1000, 0), (100, 290), (1000, 300), (3, 111), (700, 150)] {
                let line: Vec<f64> = values.iter().map(|row| along_x.at(kx, row)).collect();
                let (x, y) = (TAU * kx as f64 / nx as f64, TAU * ky as f64 / ny as f64);
                let (sum, smooth) = (aliases.at(x, y), along_y.at(ky, &line));
                assert!((sum - smooth).abs() < 1e-13, "aspect {aspect}, {kx} {ky}: {sum} {smooth}");
            }
        }
    }

    /// A layer of any thickness: few aliases, each by itself, and many as an alternating sum that is interpolated.
    #[test]
    fn the_excess_of_a_layer_is_the_sum_over_all_aliases() {
        use contact_model::{Layer, LayerBase};
        for (base, stretch) in
            [(LayerBase::Rigid, 1.0_f64), (LayerBase::HalfSpace { young: 0.2, poisson: 0.3 }, 1.4)]
        {
            let symbol =
                crate::kernel::LayerSymbol::new(&Layer { thickness: 1.0, young: 1.0, poisson: 0.3, base });
            let grid = Grid { columns: 130, rows: 140, stretch };
            for thickness in [3.0, 0.6, 0.4, 0.1, 0.02] {
                let excess = |q: f64| symbol.excess(q * thickness);
                let found = excess_symbol(grid, excess, thickness);
                for (kx, ky) in [(1, 0), (0, 1), (17, 40), (65, 70), (3, 69)] {
                    let waves = (TAU * kx as f64 / 130.0, TAU * ky as f64 / 140.0);
                    let (found, exact) = (found[kx * 71 + ky], excess_at(grid, excess, thickness, waves));
                    assert!((found - exact).abs() < 1e-11, "{base:?} {thickness} {kx} {ky}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn the_symbol_of_oblong_cells_is_the_sum_over_the_waves() {
        for stretch in [3.0f64, 0.4] {
            let grid = Grid { columns: 420, rows: 390, stretch };
            let ((a, b), symbol) = (grid.cell(), symbol(grid, Integrand::Normal));
            let aliases = AliasSum::new(Integrand::Normal, (a, b));
            for (kx, ky) in [(1, 0), (0, 1), (7, 190), (210, 195), (209, 3), (100, 100)] {
                let (x, y) = (TAU * kx as f64 / 420.0, TAU * ky as f64 / 390.0);
                let sum = first(Integrand::Normal, x, y, a, b) + aliases.at(x, y);
                assert_relative_eq!(symbol[kx * 196 + ky], sum, max_relative = 1e-12);
            }
        }
    }

    #[test]
    fn no_wave_is_softer_than_the_checkerboard() {
        for (columns, rows, stretch) in [(40, 40, 1.0), (30, 42, 2.0), (31, 8, 0.4), (12, 13, 5.0)] {
            let grid = Grid { columns, rows, stretch };
            let lowest = symbol(grid, Integrand::Normal)[1..].iter().copied().fold(f64::INFINITY, f64::min);
            let expected = smallest_eigenvalue(stretch);
            assert!(lowest >= (1.0 - 1e-6) * expected, "{grid:?}: {lowest} {expected}");
            if columns % 2 == 0 && rows % 2 == 0 {
                assert_relative_eq!(lowest, expected, max_relative = 1e-6);
            }
        }
        assert_relative_eq!(smallest_eigenvalue(1.0), SMALLEST_EIGENVALUE);
    }
}
