//! Likelihood of a self-affine spectrum.

use super::minimise::minimise;
use super::rings::{REACH, Rings};

/// Value of the likelihood to which minima are found: intervals end where it has changed by about 2.
const TOLERANCE: f64 = 2e-4;
/// Penalty for each unit beyond a limit.
const STEEP: f64 = 1e4;

/// What a spectrum is made of, wavenumbers in rings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parameters {
    /// Hurst exponent, ln of the roll-off wavenumber, wavenumber of the cut-off, ln of the noise.
    pub(super) values: [f64; 4],
}

/// Indices of the parameters.
pub(super) const HURST: usize = 0;
pub(super) const ROLL_OFF: usize = 1;
pub(super) const CUT_OFF: usize = 2;
pub(super) const NOISE: usize = 3;

/// Rings that a window fills from one edge of the spectrum hold the same information: the weight of each.
const AT_THE_EDGE: f64 = 0.2;

/// First steps of a search.
const STEPS: [f64; 4] = [0.1, 0.2, 1.0, 3.0];

/// `-ln` of the likelihood of a periodogram: its rings have gamma laws about their expectations.
#[derive(Debug)]
pub(super) struct Likelihood {
    rings: Rings,
    /// Wavenumber at which the power law is 1, its logarithm.
    reference: f64,
    /// Limits of the parameters.
    pub(super) limits: [[f64; 2]; 4],
    spectrum: Vec<f64>,
    expected: Vec<f64>,
    counts: Vec<f64>,
}

impl Likelihood {
    pub(super) fn new(rings: Rings) -> Self {
        let [from, to] = rings.range;
        let limits = [
            [-0.95, 4.0],
            // A roll-off at the first limit is none, and so is a cut-off at the last.
            [(0.5 * from).ln(), to.ln()],
            [from + 2.0, to + if rings.windowed { REACH as f64 } else { 1.0 }],
            [-75.0, 10.0],
        ];
        let nodes = rings.nodes.len();
        let count = rings.all.len();
        let counts = rings.all.iter().map(|ring| ring.independent).collect();
        let reference = 0.5 * (from * to).ln();
        Self { rings, reference, limits, spectrum: vec![0.0; nodes], expected: vec![0.0; count], counts }
    }

    pub(super) fn rings(&self) -> &Rings {
        &self.rings
    }

    /// Expected powers of the rings, but for a factor.
    pub(super) fn expect(&mut self, parameters: Parameters) -> &[f64] {
        let [hurst, roll_off, cut_off, noise] = parameters.values;
        let power = -2.0 * (hurst + 1.0);
        // A node stands for wavenumbers of the width of a quarter of a ring.
        let last = cut_off * 4.0;
        for (k, (value, q)) in self.spectrum.iter_mut().zip(&self.rings.nodes).enumerate() {
            let inside = (last - k as f64).clamp(0.0, 1.0);
            *value =
                if inside > 0.0 { inside * (power * (q.max(roll_off) - self.reference)).exp() } else { 0.0 };
        }
        let noise = noise.exp();
        for (value, ring) in self.expected.iter_mut().zip(&self.rings.all) {
            let sum: f64 =
                ring.weights.iter().zip(&self.spectrum[ring.first..]).map(|(weight, c)| weight * c).sum();
            *value = sum + noise;
        }
        &self.expected
    }

    /// Takes all waves of all rings.
    pub(super) fn count_all(&mut self) {
        for (value, ring) in self.counts.iter_mut().zip(&self.rings.all) {
            *value = ring.independent;
        }
    }

    /// Takes fewer independent waves where the window fills several rings from the edge of the spectrum.
    pub(super) fn share_edge(&mut self, cut_off: f64) {
        for (value, ring) in self.counts.iter_mut().zip(&self.rings.all) {
            *value = ring.independent;
            if self.rings.windowed {
                // Distance to the rings from one and a half below the edge to one and a half beyond the
                // window's reach.
                let middle = cut_off + 0.5 * REACH as f64;
                let outside = (ring.wavenumber - middle).abs() - 0.5 * REACH as f64 - 0.5;
                *value *= AT_THE_EDGE + (1.0 - AT_THE_EDGE) * outside.clamp(0.0, 1.0);
            }
        }
    }

    /// The factor of the expected powers at which the likelihood is largest.
    pub(super) fn factor(&mut self, parameters: Parameters) -> f64 {
        self.expect(parameters);
        let (mut sum, mut all) = (0.0, 0.0);
        for ((m, ring), n) in self.expected.iter().zip(&self.rings.all).zip(&self.counts) {
            sum += n * (ring.power / m);
            all += n;
        }
        sum / all
    }

    /// `-ln` of the likelihood at its best factor, over that of the measured powers themselves.
    pub(super) fn value(&mut self, parameters: Parameters) -> f64 {
        let (mut beyond, mut inside) = (0.0, parameters);
        for (value, [low, high]) in inside.values.iter_mut().zip(self.limits) {
            let kept = value.clamp(low, high);
            beyond += (*value - kept).abs();
            *value = kept;
        }
        let factor = self.factor(inside);
        let mut sum = 0.0;
        for ((m, ring), n) in self.expected.iter().zip(&self.rings.all).zip(&self.counts) {
            sum += n * (factor * m / ring.power).ln();
        }
        sum + STEEP * beyond
    }

    /// The minimum with the parameters of `fixed` held, from a start.
    pub(super) fn minimum(&mut self, start: Parameters, fixed: &[usize]) -> (Parameters, f64) {
        let free: Vec<usize> = (0..4).filter(|i| !fixed.contains(i)).collect();
        let mut best = (start, f64::INFINITY);
        // A simplex may collapse: it is set up again until that gains nothing.
        for _ in 0..4 {
            let start: Vec<f64> = free.iter().map(|&i| best.0.values[i]).collect();
            let steps: Vec<f64> = free
                .iter()
                .map(|&i| {
                    let room = self.limits[i][1] - best.0.values[i];
                    if room < STEPS[i] { -STEPS[i] } else { STEPS[i] }
                })
                .collect();
            let mut parameters = best.0;
            let (x, value) = minimise(
                &mut |x| {
                    for (&i, v) in free.iter().zip(x) {
                        parameters.values[i] = *v;
                    }
                    self.value(parameters)
                },
                &start,
                &steps,
                TOLERANCE,
            );
            let gain = best.1 - value;
            if gain > 0.0 {
                for (&i, v) in free.iter().zip(&x) {
                    best.0.values[i] = v.clamp(self.limits[i][0], self.limits[i][1]);
                }
                best.1 = value;
            }
            if gain < 10.0 * TOLERANCE {
                break;
            }
        }
        best
    }

    /// The noise that the rings beyond the cut-off have on average, or a thousandth of the last ring's.
    fn noise_beyond(&mut self, parameters: Parameters) -> f64 {
        let cut_off = parameters.values[CUT_OFF];
        let mut silent = parameters;
        silent.values[NOISE] = self.limits[NOISE][0];
        self.expect(silent);
        let (mut inside, mut beyond, mut last) = ([0.0; 2], [0.0; 2], 0.0);
        for (m, ring) in self.expected.iter().zip(&self.rings.all) {
            let n = ring.independent;
            if ring.wavenumber < cut_off - 1.0 {
                inside = [inside[0] + n, inside[1] + n * ring.power / m];
                last = 1e-3 * ring.power;
            } else if ring.wavenumber > cut_off + 2.0 {
                beyond = [beyond[0] + n, beyond[1] + n * ring.power];
            }
        }
        let power = if beyond[0] > 0.0 { beyond[1] / beyond[0] } else { last };
        (power / (inside[1] / inside[0].max(1.0))).ln().clamp(self.limits[NOISE][0], 0.0)
    }

    /// The minimum over all parameters, from a grid of starts.
    pub(super) fn best(&mut self) -> (Parameters, f64) {
        let [from, to] = self.rings.range;
        let none = self.limits[CUT_OFF][1];
        let mut cut_offs = vec![none];
        let mut q = to;
        while q > self.limits[CUT_OFF][0] {
            cut_offs.push(q);
            q = (q / 1.12).min(q - 1.0);
        }
        let mut found: Vec<(Parameters, f64)> = Vec::new();
        for cut_off in cut_offs {
            for share in [0.0, 0.3, 0.6] {
                let roll_off = if share > 0.0 {
                    from.ln() + share * (cut_off.min(to) / from).ln()
                } else {
                    self.limits[ROLL_OFF][0] + 0.1
                };
                let mut start = Parameters { values: [0.7, roll_off, cut_off, -25.0] };
                start.values[NOISE] = self.noise_beyond(start);
                for hurst in [0.1, 0.4, 1.0] {
                    let mut other = start;
                    other.values[HURST] = hurst;
                    other.values[NOISE] = self.noise_beyond(other);
                    if self.value(other) < self.value(start) {
                        start = other;
                    }
                }
                let value = self.value(start);
                found.push((start, value));
            }
        }
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut best = found[0];
        for start in found.iter().take(6) {
            let minimum = self.minimum(start.0, &[]);
            if minimum.1 < best.1 {
                best = minimum;
            }
        }
        best
    }
}
