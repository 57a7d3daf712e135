//! Potentials of waves of tractions, and of the grid of waves that a load constant in each cell consists of.
//!
//! A load that is constant in each cell has waves of any length. Those that differ by whole numbers of waves
//! per cell have the same values at the centres of cells, and add up to one number for each wave of the grid.
//! With `k` a wave of the grid, the sum over its aliases `k + G` is
//!
//! `sinc(kx dx/2) sinc(ky dy/2) sum_mn (-1)^(m + n) kx/(kx + Gx) ky/(ky + Gy) S(k + G)`
//!
//! with the stress S under a wave of amplitude 1, and `G = 2 pi (m/dx, n/dy)`. The terms alternate in sign,
//! so that some twenty of them in each direction give the sum to rounding at any depth, 0 included, although
//! near the surface they fall as 1/(m n) only.
//!
//! Without the wave itself the sum is an analytic function of the wave. It is computed at Chebyshev nodes and
//! interpolated to all waves of the grid.

use super::potentials::{KERNELS, ODD, Potentials};
use contact_model::{Interrupted, Stop};
use numerics::parallel::{for_each_until, threads_for, widest};
use std::f64::consts::PI;

/// Terms of an alternating sum that are added as they are, before those with weights.
const PLAIN: usize = 4;
/// Terms with weights: the error falls as 5.8^-n.
const WEIGHTED: usize = 24;
/// Waves that have fallen by more than exp(-this) are left out.
const LARGEST_EXPONENT: f64 = 42.0;
/// `-ln` of the error of interpolation.
const DIGITS: f64 = 37.0;

/// The potentials under a wave of amplitude 1 whose numbers are not both 0.
///
/// A derivative that is odd in kx, or in ky, is that of a wave a quarter of its length further: it has no
/// factor i here.
pub fn wave([kx, ky]: [f64; 2], z: f64) -> Potentials {
    let q = kx.hypot(ky);
    let (x, y, depth) = (kx / q, ky / q, q * z);
    let fall = (-depth).exp();
    let deep = depth * fall;
    let scaled = [
        x * fall,
        y * fall,
        -fall,
        x * x * fall,
        y * y * fall,
        -x * y * fall,
        -x * x * deep,
        -y * y * deep,
        x * y * deep,
        -x * deep,
        -y * deep,
        x * x * y * deep,
        x * y * y * deep,
        -x * x * y * fall,
        -x * y * y * fall,
    ];
    // What integrals over a load have as a factor.
    Potentials(scaled.map(|derivative| derivative * std::f64::consts::TAU))
}

/// Weights of the terms m = 0, 1, 2, ... of a sum over m of both signs, signs included.
///
/// Source: Cohen, Rodriguez Villegas, Zagier, Exp. Math. 9, 3 (2000), algorithm 1, after a few plain terms.
fn alternating_weights() -> [f64; PLAIN + WEIGHTED] {
    let n = WEIGHTED as f64;
    let power = (3.0 + 8.0_f64.sqrt()).powf(n);
    let d = f64::midpoint(power, power.recip());
    let (mut b, mut c) = (-1.0, -d);
    let sign = |m: usize| if m.is_multiple_of(2) { 1.0 } else { -1.0 };
    let mut weights = std::array::from_fn(sign);
    for (k, weight) in weights[PLAIN..].iter_mut().enumerate() {
        let k = k as f64;
        c = b - c;
        b *= (k + n) * (k - n) / ((k + 0.5) * (k + 1.0));
        *weight = sign(PLAIN) * c / d;
    }
    weights
}

/// The waves of a load that is constant in cells of the sides a and b.
#[derive(Debug, Clone, Copy)]
pub struct CellWaves {
    sides: [f64; 2],
    poisson: f64,
    weights: [f64; PLAIN + WEIGHTED],
}

/// The other aliases of the waves of a grid.
#[derive(Debug)]
pub struct Aliases {
    along_x: NodeInterpolation,
    /// Number of influence functions.
    count: usize,
    /// `values[(node * rows + my) * count + kernel]` at the nodes along x and the waves along y.
    values: Vec<f64>,
    rows: usize,
}

impl CellWaves {
    pub fn new(sides: [f64; 2], poisson: f64) -> Self {
        Self { sides, poisson, weights: alternating_weights() }
    }

    /// The product of `sin(k d/2)/(k d/2)` along both axes.
    pub fn mean_over_cell(&self, k: [f64; 2]) -> f64 {
        let sinc = |phase: f64| if phase.abs() > 0.0 { phase.sin() / phase } else { 1.0 };
        sinc(0.5 * k[0] * self.sides[0]) * sinc(0.5 * k[1] * self.sides[1])
    }

    /// The influence functions of the other aliases of a wave of the grid, without the factor
    /// [`CellWaves::mean_over_cell`]. Cost: 3249 waves at the surface, fewer below it.
    pub fn other_aliases(&self, k: [f64; 2], z: f64) -> [f64; KERNELS] {
        let mut sum = Potentials::default();
        for (m, wave_x, weight_x) in self.along([k[0], self.sides[0]], z) {
            for (n, wave_y, weight_y) in self.along([k[1], self.sides[1]], z) {
                let weight = weight_x * weight_y;
                let other = (m, n) != (0, 0) && weight.abs() > 0.0;
                if other && wave_x.hypot(wave_y) * z < LARGEST_EXPONENT {
                    sum.add(weight, &wave([wave_x, wave_y], z));
                }
            }
        }
        sum.kernels(self.poisson)
    }

    /// The aliases of a wave along one axis that have not decayed at a depth: number, wave number and weight.
    /// Those of both signs have the same number.
    fn along(&self, [k, side]: [f64; 2], z: f64) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        let others = self.weights.iter().enumerate().skip(1);
        let both = others.flat_map(|(m, weight)| [(m, -1.0, weight), (m, 1.0, weight)]);
        let aliases = both.filter_map(move |(m, sign, weight)| {
            let alias = k + sign * 2.0 * PI * m as f64 / side;
            (alias.abs() * z < LARGEST_EXPONENT).then_some((m, alias, weight * k / alias))
        });
        std::iter::once((0, k, 1.0)).chain(aliases)
    }

    /// The first `count` influence functions of the other aliases of all waves of a grid at one depth, with
    /// the wave numbers >= 0 along each axis; `None` where they are smaller than the rounding of the waves
    /// themselves.
    pub fn aliases(
        &self,
        waves: [&[f64]; 2],
        z: f64,
        count: usize,
        stop: Stop<'_>,
    ) -> Result<Option<Aliases>, Interrupted> {
        let shortest = self.sides.map(|side| PI / side);
        if shortest[0].min(shortest[1]) * z > LARGEST_EXPONENT {
            return Ok(None);
        }
        let [a, b] = self.sides;
        let along_x = NodeInterpolation::new(0, waves[0], shortest[0], a / b);
        let along_y = NodeInterpolation::new(1, waves[1], shortest[1], b / a);
        let (nodes, rows) = (along_y.nodes.len(), waves[1].len());
        let mut values = vec![0.0; along_x.nodes.len() * rows * count];
        let mut at_nodes = vec![vec![[0.0; KERNELS]; nodes]; threads_for(usize::MAX)];
        let tasks = along_x.nodes.iter().zip(values.chunks_exact_mut(rows * count));
        let all = for_each_until(&mut at_nodes, tasks, &|| stop.stops(), |at_nodes, (&kx, column)| {
            for (to, &ky) in at_nodes.iter_mut().zip(&along_y.nodes) {
                *to = self.other_aliases([kx, ky], z);
            }
            for (my, to) in column.chunks_exact_mut(count).enumerate() {
                along_y.add_at(my, |node| &at_nodes[node][..count], count, to);
            }
        });
        if all { Ok(Some(Aliases { along_x, count, values, rows })) } else { Err(Interrupted) }
    }
}

impl Aliases {
    /// Adds the influence functions at all waves along y, `[my * count + kernel]`, for wave mx along x.
    pub fn add(&self, mx: usize, to: &mut [f64]) {
        let length = self.rows * self.count;
        let from = |node: usize| &self.values[node * length..][..length];
        widest(|| self.along_x.add_at(mx, from, self.count, to));
    }
}

/// Interpolation of functions that are even or odd from nodes in [0, k] to waves there.
#[derive(Debug)]
struct NodeInterpolation {
    /// The axis along which the parity of the influence functions counts.
    axis: usize,
    nodes: Vec<f64>,
    /// Of each wave the weights of the nodes, for even functions and for odd ones; none where the nodes are
    /// the waves.
    weights: Option<[Vec<f64>; 2]>,
}

impl NodeInterpolation {
    /// `oblong` is the side of a cell along this axis over the other one. The functions have poles at the
    /// nearest alias, two half intervals from 0. They have branch points where the other wave number, at
    /// least `pi` over the other side, is i times this one: `oblong` half intervals from the real axis. The
    /// nearer ones decide how the error falls with the number of nodes.
    fn new(axis: usize, waves: &[f64], shortest: f64, oblong: f64) -> Self {
        // Half of the degree, because the nodes of the other sign follow.
        let count = (0.5 * DIGITS / oblong.asinh().min(2.0_f64.acosh())).ceil();
        if count >= waves.len() as f64 {
            return Self { axis, nodes: waves.to_vec(), weights: None };
        }
        let count = count as usize;
        let angles: Vec<f64> = (0..count).map(|j| PI * (j as f64 + 0.5) / (2 * count) as f64).collect();
        let nodes = angles.iter().map(|angle| shortest * angle.cos()).collect();
        // Chebyshev polynomials of even and of odd degree.
        let polynomials =
            |angle: f64, odd: usize| (0..count).map(move |k| ((2 * k + odd) as f64 * angle).cos());
        let weights = [0, 1].map(|odd| {
            let at_nodes: Vec<f64> = angles.iter().flat_map(|angle| polynomials(*angle, odd)).collect();
            let mut weights = Vec::with_capacity(waves.len() * count);
            for wave in waves {
                let mut at_wave: Vec<f64> = polynomials((wave / shortest).min(1.0).acos(), odd).collect();
                if odd == 0 {
                    at_wave[0] *= 0.5;
                }
                for at_node in at_nodes.chunks_exact(count) {
                    let product: f64 = at_wave.iter().zip(at_node).map(|(a, b)| a * b).sum();
                    weights.push(2.0 / count as f64 * product);
                }
            }
            weights
        });
        Self { axis, nodes, weights: Some(weights) }
    }

    /// Adds the values at a wave, for one or many sets of `count` influence functions.
    #[inline]
    fn add_at<'a>(&self, wave: usize, values: impl Fn(usize) -> &'a [f64], count: usize, to: &mut [f64]) {
        let Some(weights) = &self.weights else {
            for (to, value) in to.iter_mut().zip(values(wave)) {
                *to += value;
            }
            return;
        };
        for node in 0..self.nodes.len() {
            let both = [0, 1].map(|odd| weights[odd][wave * self.nodes.len() + node]);
            let of_kernels = ODD.map(|odd| both[usize::from(odd[self.axis])]);
            for (to, from) in to.chunks_exact_mut(count).zip(values(node).chunks_exact(count)) {
                for ((to, value), weight) in to.iter_mut().zip(from).zip(&of_kernels) {
                    *to += weight * value;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
