//! The kernel of a square that repeats itself for ever.
//!
//! A mean pressure on every copy would sink an infinite half-space without limit; displacements are counted from their mean, which
//! leaves a kernel of zero mean. That kernel is no inverse M-matrix, and cells outside `z < d` may penetrate. Adding a constant c to
//! it changes neither the pressure under a given force nor the gap, only where the plane is counted from (`d + c F`), and with [`shift`] every
//! entry is positive, so that what the elimination and the candidates of the free kernel rely on holds again (`tests/tests/periodic.rs` checks the results).

use super::convolution::{Lengths, Symbol};
use std::f64::consts::{PI, TAU};

/// Terms on each side of the accelerated alternating sums: the error falls as 5.8^-n.
const TERMS: usize = 24;
/// Chebyshev polynomials in each direction for the smooth part of the symbol: the error falls as 5.8^-n.
const MODES: usize = 22;
/// `c N` of [`shift`]: above 1.61554, the depth of the kernel half a period away in both directions
/// (`(1 - sqrt 2) 4 zeta(1/2) beta(1/2)` for a point; 1.62 or less for cells).
const SHIFT: f64 = 2.0;

/// The constant c that is added to the kernel of zero mean; a larger one only loses digits of the stiffness, `1/k' = 1/k + c`.
pub fn shift(cells: usize) -> f64 {
    SHIFT / cells as f64
}

/// The kernel at the lags `0 ..= N/2` in both directions, [`shift`] added.
#[derive(Debug)]
pub struct Periodic {
    cells: usize,
    half: usize,
    quarter: Vec<f64>,
}

impl Periodic {
    /// Kernel of a square of `cells` a side. Exact to rounding: the displacement at cell centres under uniform pressure on cells.
    ///
    /// Cost: some 25 multiplications a cell and a real transform of the grid.
    pub fn new(cells: usize) -> Self {
        let half = cells / 2 + 1;
        let smooth = Smooth::new();
        let wave = |k: usize| TAU * k as f64 / cells as f64;
        let along: Vec<[f64; MODES]> = (0..half).map(|k| Smooth::polynomials(wave(k))).collect();
        let mean = shift(cells) * (cells * cells) as f64;
        let symbol = |kx: usize, ky: usize| {
            if (kx, ky) == (0, 0) {
                mean
            } else {
                first(wave(kx), wave(ky)) + smooth.at(&along[kx], &along[ky])
            }
        };
        // The transform of an even sequence is its own inverse but for the number of points.
        let mut quarter = Symbol::of_kernel(Lengths { x: cells, y: cells }, symbol).values;
        let points = (cells * cells) as f64;
        for value in &mut quarter {
            *value /= points;
        }
        Self { cells, half, quarter }
    }

    /// Kernel at a lag; lags beyond half a period are taken the other way round.
    pub fn at(&self, x: usize, y: usize) -> f64 {
        let fold = |lag: usize| (lag % self.cells).min(self.cells - lag % self.cells);
        // Ordered lags: symmetric to the last bit.
        let (x, y) = (fold(x), fold(y));
        self.quarter[x.max(y) * self.half + x.min(y)]
    }
}

/// `sin(x) / x`.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

/// The continuum's share of the symbol at a wave: `2 pi / |q|` times the transform of a cell.
fn first(qx: f64, qy: f64) -> f64 {
    TAU / qx.hypot(qy) * sinc(qx / 2.0) * sinc(qy / 2.0)
}

/// What the waves that the grid takes for q add: `sum 2 pi / |Q| sinc(Qx/2) sinc(Qy/2)` over `Q = q + 2 pi (m, n)`, without `m = n = 0`.
///
/// Even and analytic in both components for `|q| < 2 pi`, so that few polynomials in `2 (q/pi)^2 - 1` say it all.
struct Smooth {
    coefficients: [[f64; MODES]; MODES],
}

impl Smooth {
    fn new() -> Self {
        let node = |i: usize| PI * (2 * i + 1) as f64 / (2 * MODES) as f64;
        let wave = |i: usize| PI * f64::midpoint(node(i).cos(), 1.0).sqrt();
        let weights = alternating();
        let values: Vec<f64> = (0..MODES * MODES)
            .map(|i| {
                let (a, b) = (i % MODES, i / MODES);
                aliases(&weights, wave(a.max(b)), wave(a.min(b)))
            })
            .collect();
        let mut coefficients = [[0.0; MODES]; MODES];
        let norm = |j: usize| if j == 0 { 1.0 } else { 2.0 } / MODES as f64;
        for (j, line) in coefficients.iter_mut().enumerate() {
            for (k, coefficient) in line.iter_mut().enumerate() {
                for b in 0..MODES {
                    let along: f64 =
                        (0..MODES).map(|a| values[b * MODES + a] * (k as f64 * node(a)).cos()).sum();
                    *coefficient += along * (j as f64 * node(b)).cos();
                }
                *coefficient *= norm(j) * norm(k);
            }
        }
        Self { coefficients }
    }

    /// `T_j(2 (q/pi)^2 - 1)`.
    fn polynomials(q: f64) -> [f64; MODES] {
        let x = (2.0 * (q / PI).powi(2) - 1.0).clamp(-1.0, 1.0);
        let mut t = [1.0; MODES];
        t[1] = x;
        for j in 2..MODES {
            t[j] = 2.0 * x * t[j - 1] - t[j - 2];
        }
        t
    }

    fn at(&self, x: &[f64; MODES], y: &[f64; MODES]) -> f64 {
        let line = |c: &[f64; MODES]| -> f64 { c.iter().zip(x).map(|(c, t)| c * t).sum() };
        self.coefficients.iter().zip(y).map(|(c, t)| line(c) * t).sum()
    }
}

/// Weights `w` with `sum_(k >= 0) (-1)^k a_k = sum_(k < TERMS) w_k a_k`.
///
/// Source: Cohen, Rodriguez Villegas, Zagier, Exp. Math. 9, 3 (2000), algorithm 1.
fn alternating() -> [f64; TERMS] {
    let n = TERMS as f64;
    let power = (3.0 + 8.0_f64.sqrt()).powf(n);
    let d = f64::midpoint(power, power.recip());
    let (mut b, mut c) = (-1.0, -d);
    std::array::from_fn(|k| {
        let k = k as f64;
        c = b - c;
        b *= (k + n) * (k - n) / ((k + 0.5) * (k + 1.0));
        c / d
    })
}

/// The sum of [`Smooth`] at one wave, `0 <= q <= pi`.
fn aliases(weights: &[f64; TERMS], qx: f64, qy: f64) -> f64 {
    // sin((q + 2 pi m)/2) = (-1)^m sin(q/2): alternating sums over m = 1, 2, .. and m = -1, -2, ..
    let terms = |q: f64| {
        let sine = 2.0 * (q / 2.0).sin();
        let side = move |sign: f64| {
            weights.iter().enumerate().map(move |(k, w)| {
                let wave = q + sign * TAU * (k + 1) as f64;
                (wave, -w * sine / wave)
            })
        };
        std::iter::once((q, sinc(q / 2.0))).chain(side(1.0)).chain(side(-1.0)).collect::<Vec<_>>()
    };
    let (x, y) = (terms(qx), terms(qy));
    let mut sum = 0.0;
    for (i, &(wy, fy)) in y.iter().enumerate() {
        for &(wx, fx) in &x[usize::from(i == 0)..] {
            sum += fx * fy / wx.hypot(wy);
        }
    }
    TAU * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::love::{SMALLEST_EIGENVALUE, influence};
    use approx::assert_relative_eq;

    /// The whole symbol.
    fn symbol(qx: f64, qy: f64) -> f64 {
        Smooth::new().at(&Smooth::polynomials(qx), &Smooth::polynomials(qy)) + first(qx, qy)
    }

    #[test]
    fn sine_over_its_argument_on_both_sides_of_its_series() {
        for x in [1e-8, 9e-5, -9e-5, 1.1e-4, 0.5, PI / 2.0] {
            assert_relative_eq!(sinc(x), f64::sin(x) / x, max_relative = 1e-15);
        }
        assert_relative_eq!(sinc(0.0), 1.0);
    }

    #[test]
    fn alternating_sums_of_the_textbook() {
        // ln 2 = 1 - 1/2 + 1/3 - .. and pi/4 = 1 - 1/3 + 1/5 - ..
        let sum = |step: f64| -> f64 {
            alternating().iter().enumerate().map(|(k, w)| w / (step * k as f64 + 1.0)).sum()
        };
        assert_relative_eq!(sum(1.0), 2.0_f64.ln(), max_relative = 1e-15);
        assert_relative_eq!(sum(2.0), PI / 4.0, max_relative = 1e-15);
    }

    #[test]
    fn polynomials_say_what_the_sums_say() {
        let weights = alternating();
        for (qx, qy) in [(0.0, 0.0), (PI, 0.0), (0.3, 3.0), (PI, PI), (1e-3, 2.0), (2.2, 1.1)] {
            let sum = aliases(&weights, qx, qy);
            let smooth = Smooth::new().at(&Smooth::polynomials(qx), &Smooth::polynomials(qy));
            assert!((sum - smooth).abs() < 2e-14, "{qx} {qy}: {sum} {smooth}");
        }
        assert_relative_eq!(symbol(PI, PI), SMALLEST_EIGENVALUE, max_relative = 1e-6);
    }

    #[test]
    fn a_cell_and_its_images() {
        // Differences of the kernel are sums of Love's kernel over images; what images beyond m periods add falls as 1/m.
        for cells in [3_usize, 8] {
            let kernel = Periodic::new(cells);
            let images = |(x, y): (isize, isize), m: isize| -> f64 {
                let lag = |a: isize, i: isize| (a + i * cells.cast_signed()).unsigned_abs();
                (-m..=m)
                    .flat_map(|i| (-m..=m).map(move |j| (i, j)))
                    .map(|(i, j)| influence(lag(x, i), lag(y, j)))
                    .sum()
            };
            for to in [(1, 0), (1, 1), (cells.cast_signed() / 2, 1)] {
                let difference = |m| images((0, 0), m) - images(to, m);
                let expected = 2.0 * difference(80) - difference(40);
                let found = kernel.at(0, 0) - kernel.at(to.0.unsigned_abs(), to.1.unsigned_abs());
                assert!((found - expected).abs() < 3e-5, "{cells} {to:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn mean_and_sign() {
        for cells in [1, 2, 3, 4, 5, 16, 33] {
            let kernel = Periodic::new(cells);
            let all: Vec<f64> = (0..cells * cells).map(|i| kernel.at(i % cells, i / cells)).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            assert_relative_eq!(mean, shift(cells), max_relative = 1e-13);
            assert!(all.iter().all(|&k| k > 0.0), "{cells}: {all:?}");
        }
    }

    #[test]
    fn own_image_of_a_point() {
        // N (I(0) - I_free(0)) - c N -> 4 zeta(1/2) beta(1/2) = -3.9002649, the square lattice of point charges on their background;
        // cells add a term of second order.
        let change = |cells| (Periodic::new(cells).at(0, 0) - influence(0, 0)) * cells as f64 - SHIFT;
        let limit = change(64) + (change(64) - change(32)) / 3.0;
        assert_relative_eq!(limit, -3.900_264_9, max_relative = 1e-8);
    }
}
