//! The displacement by a point force on a layer less that on a half-space of its material, integrated over cells.
//!
//! In units of the thickness h, and of `F/(pi E* h)`, the difference at the distance r is
//! `D(r) = int (f(w) - 1) J_0(w r) dw` over all w > 0. Its integral over a cell is the flux of the field `H(r) r`
//! through the four sides, because the divergence of this field is D:
//!
//! ```text
//! H(r) = (1/r^2) int_0^r D(s) s ds = int (f(w) - 1) J_1(w r)/(w r) dw.
//! ```
//!
//! H is smooth, also at the centre of a cell, and each side is an integral over one coordinate. H is kept as
//! polynomials on intervals, from the integral over w.

use super::layer_symbol::LayerSymbol;
use numerics::gauss::Gauss;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Points of an interval on which H is a polynomial.
const POINTS: usize = 24;
/// Intervals have this length up to as many of them, and grow by half beyond: H changes over a thickness near
/// the force, and over the distance far from it.
const UNIFORM: usize = 16;
/// The integrand is cut where its factor is below rounding.
const LARGEST_WAVE: f64 = 24.0;

/// Longest part of the waves that one rule integrates: f changes over waves of about one thickness.
const LONGEST_PART: f64 = 0.5;

/// H on a range of distances.
#[derive(Debug)]
pub struct LayerFlux {
    /// Ends of the intervals, from 0.
    ends: Vec<f64>,
    /// Values at the Chebyshev points of each interval, as coefficients of its polynomials.
    polynomials: Vec<[f64; POINTS]>,
    fine: Gauss<12>,
    coarse: Gauss<4>,
}

impl LayerFlux {
    /// H up to this distance, in thicknesses. Grids of one layer share it: the same serves all cells.
    pub fn shared(symbol: &LayerSymbol, farthest: f64) -> Arc<Self> {
        static LIVE: Mutex<Vec<(LayerSymbol, Weak<LayerFlux>)>> = Mutex::new(Vec::new());
        let found = |live: &[(LayerSymbol, Weak<Self>)]| {
            let same = live.iter().filter(|(of, _)| of == symbol).filter_map(|(_, flux)| flux.upgrade());
            { same }.find(|flux| flux.farthest() >= farthest)
        };
        let lock = || LIVE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(flux) = { found(&lock()) } {
            return flux;
        }
        // Made without the lock. Coarser grids are somewhat larger.
        let made = Arc::new(Self::new(symbol, 2.0 * farthest));
        let mut live = lock();
        live.retain(|(_, flux)| flux.strong_count() > 0);
        live.push((*symbol, Arc::downgrade(&made)));
        made
    }

    /// H up to this distance.
    ///
    /// Cost: some thousand integrals of some hundred points each, a tenth of a second.
    fn new(symbol: &LayerSymbol, farthest: f64) -> Self {
        let integral = WaveIntegral::new(symbol);
        let mut ends = vec![0.0_f64];
        while ends[ends.len() - 1] < farthest {
            let last = ends[ends.len() - 1];
            ends.push(if ends.len() <= UNIFORM { last + 1.0 } else { 1.5 * last });
        }
        let angle = |i: usize| PI * (i as f64 + 0.5) / POINTS as f64;
        let polynomial = |(low, high): (f64, f64)| -> [f64; POINTS] {
            let values: [f64; POINTS] = std::array::from_fn(|i| {
                integral.at(f64::midpoint(low, high) + 0.5 * (high - low) * angle(i).cos())
            });
            std::array::from_fn(|j| {
                let norm = if j == 0 { 1.0 } else { 2.0 } / POINTS as f64;
                norm * values.iter().enumerate().map(|(i, v)| v * (j as f64 * angle(i)).cos()).sum::<f64>()
            })
        };
        let polynomials = ends.windows(2).map(|ends| polynomial((ends[0], ends[1]))).collect();
        Self { ends, polynomials, fine: Gauss::new(), coarse: Gauss::new() }
    }

    /// The largest distance.
    fn farthest(&self) -> f64 {
        self.ends.last().copied().unwrap_or_default()
    }

    /// H at a distance.
    fn at(&self, r: f64) -> f64 {
        let index =
            if r < UNIFORM as f64 { r as usize } else { self.ends.partition_point(|end| *end <= r) - 1 };
        let index = index.min(self.polynomials.len() - 1);
        let (low, high) = (self.ends[index], self.ends[index + 1]);
        let x = (2.0 * r - low - high) / (high - low);
        // Clenshaw's recurrence.
        let (mut last, mut value) = (0.0, 0.0);
        for c in self.polynomials[index][1..].iter().rev() {
            (last, value) = (value, 2.0 * x * value - last + c);
        }
        x * value - last + self.polynomials[index][0]
    }

    /// The integral of H along a side of a cell from `low` to `high`, at this distance from the line of the force.
    pub fn along(&self, distance: f64, low: f64, high: f64) -> f64 {
        let nearest = if low * high < 0.0 { 0.0 } else { low.abs().min(high.abs()) };
        // H changes over a thickness, or over the distance.
        let steps = (high - low) / distance.hypot(nearest).max(1.0);
        let value = |s: f64| self.at(distance.hypot(s));
        if steps < 0.1 {
            return self.coarse.integrate(low, high, value);
        }
        let count = steps.ceil().max(1.0);
        let step = (high - low) / count;
        let from = |i: usize| low + step * i as f64;
        (0..count as usize).map(|i| self.fine.integrate(from(i), from(i) + step, value)).sum()
    }
}

/// The integral over the waves.
struct WaveIntegral<'a> {
    symbol: &'a LayerSymbol,
    gauss: Gauss<16>,
}

impl<'a> WaveIntegral<'a> {
    /// Waves below it are a single interval: a ratio of the moduli of 1e4 changes f over as small ones.
    const SMALLEST: f64 = 1e-7;
    /// Half waves whose partial sums are averaged.
    const AVERAGED: usize = 24;

    fn new(symbol: &'a LayerSymbol) -> Self {
        Self { symbol, gauss: Gauss::new() }
    }

    /// H at a distance.
    fn at(&self, r: f64) -> f64 {
        // J_1(x)/x.
        let bessel = |x: f64| if x < 1e-4 { 0.5 - x * x / 16.0 } else { libm::j1(x) / x };
        let part =
            |low: f64, high: f64| self.gauss.integrate(low, high, |w| self.symbol.excess(w) * bessel(w * r));
        // Up to the first zero of J_1, and where f changes, intervals double.
        let half_wave = PI / r;
        let longest = half_wave.min(LONGEST_PART);
        let (mut low, mut sum) = (0.0, 0.0);
        let mut high = Self::SMALLEST.min(longest);
        while high < longest && low < LARGEST_WAVE {
            sum += part(low, high);
            (low, high) = (high, 2.0 * high);
        }
        // The integrand alternates from one half wave to the next; means of partial sums end what is smooth.
        let mut sums = vec![sum];
        let mut previous = f64::INFINITY;
        let from = low;
        let mut index = 0_u32;
        loop {
            let (low, high) = (from + longest * f64::from(index), from + longest * f64::from(index + 1));
            if low >= LARGEST_WAVE {
                return sum;
            }
            sum += part(low, high);
            sums.push(sum);
            index += 1;
            if half_wave <= LONGEST_PART && sums.len() % Self::AVERAGED == 0 {
                let mean = repeated_mean(&sums[sums.len() - Self::AVERAGED..]);
                let scale = sums.iter().fold(0.0_f64, |most, sum| most.max(sum.abs()));
                if (mean - previous).abs() <= 2.0 * f64::EPSILON * scale {
                    return mean;
                }
                previous = mean;
            }
        }
    }
}

/// The limit of partial sums of an alternating series, by means of neighbours of means of neighbours.
fn repeated_mean(sums: &[f64]) -> f64 {
    let mut means = sums.to_vec();
    while means.len() > 1 {
        means = means.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
    }
    means[0]
}
