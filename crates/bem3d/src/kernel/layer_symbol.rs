//! How a layer on a base yields to waves of pressure, beside a half-space of its own material.
//!
//! Under the pressure `p cos(q x)` a half-space of the layer's material sinks by `2 p/(E* q)`, and a layer of
//! thickness h by `f(q h)` times as much. With `a = 3 - 4 nu` of the base, `b = 3 - 4 nu` and `m = 1 + b` of the
//! layer, and the ratio `mu` of the shear moduli of layer and base, `f = N/D` with
//!
//! ```text
//! N = R cosh 2w + P (sinh 2w - 2w) + 2 Q w,
//! D = m^2 + S w^2 + 2 P (sinh^2 w - w^2) + R sinh 2w,
//! R = m (1 + a) mu,  P = 2 b + (1 - a)(1 - b) mu + 2 a mu^2,
//! Q = 2 (b - 1) + (3 - b)(1 - a) mu + 4 a mu^2,  S = 2 m (2 + (a - 1) mu).
//! ```
//!
//! The book derives it ("Layers"). It is the solution of Burmister (1945) and of O'Sullivan and King (1988) in a form
//! without cancellation: N and D are sums of terms that are as small as they are, for thick and thin layers, an
//! incompressible one and any ratio of the moduli. A rigid base has `mu = 0`. A layer that slips on a rigid base
//! has `f = (cosh 2w - 1)/(sinh 2w + 2w)`.

use contact_model::{Layer, LayerBase};

/// The response of a layer to waves of pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LayerSymbol {
    /// Bonded to its base.
    Bonded(Bonded),
    /// On a rigid base without friction.
    Slipping,
}

/// The constants of a bonded layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bonded {
    m: f64,
    p: f64,
    q: f64,
    r: f64,
    s: f64,
}

/// Up to this `w = q h` the closed forms are sums of series. Beyond it they are divided by `exp(2 w)`.
const THIN: f64 = 1.0;
/// Beyond this w a layer answers as a half-space, to less than the rounding of `f - 1` in all uses.
const THICK: f64 = 350.0;

impl LayerSymbol {
    /// Of a layer.
    pub fn new(layer: &Layer) -> Self {
        let (mu, a) = match layer.base {
            LayerBase::HalfSpace { poisson, .. } => (layer.shear_ratio(), 3.0 - 4.0 * poisson),
            LayerBase::Slipping => return Self::Slipping,
            _ => (0.0, 1.0),
        };
        let poisson = layer.poisson;
        // 3 - 4 nu less 1, without the rounding of the difference.
        let (b, above_one, m) = (3.0 - 4.0 * poisson, 2.0 * (1.0 - 2.0 * poisson), 4.0 * (1.0 - poisson));
        Self::Bonded(Bonded {
            m,
            p: 2.0 * b + (a - 1.0) * above_one * mu + 2.0 * a * mu * mu,
            q: 2.0 * above_one - 4.0 * poisson * (a - 1.0) * mu + 4.0 * a * mu * mu,
            r: m * (1.0 + a) * mu,
            s: 2.0 * m * (2.0 + (a - 1.0) * mu),
        })
    }

    /// f itself, for comparison: the displacement under a wave of pressure with `w = q h`, over that of a half-space of the layer's material.
    #[cfg(test)]
    pub fn ratio(&self, w: f64) -> f64 {
        if w > THICK {
            return 1.0;
        }
        let (numerator, denominator) = self.parts(w);
        numerator / denominator
    }

    /// The displacement under a wave of pressure with `w = q h`, over that of a half-space of the layer's material, less one, also where it is small: it falls as `w^2 exp(-2 w)`.
    pub fn excess(&self, w: f64) -> f64 {
        if w > THICK {
            return 0.0;
        }
        let (numerator, denominator) = self.parts(w);
        if w <= THIN {
            return (numerator - denominator) / denominator;
        }
        // Numerator and denominator are over exp(2 w).
        let fall = (-2.0 * w).exp();
        let difference = match *self {
            Self::Bonded(Bonded { m, p, q, r, s }) => {
                (r - p) * fall + p * (1.0 + 2.0 * w * (w - 1.0)) + 2.0 * q * w - m * m - s * w * w
            }
            Self::Slipping => fall - 1.0 - 2.0 * w,
        };
        fall * difference / denominator
    }

    /// N and D, for thick layers over `exp(2 w)`.
    fn parts(&self, w: f64) -> (f64, f64) {
        let x = 2.0 * w;
        if w <= THIN {
            return match *self {
                Self::Bonded(Bonded { m, p, q, r, s }) => {
                    (r * x.cosh() + p * tail(x, 3) + q * x, m * m + s * w * w + p * tail(x, 4) + r * x.sinh())
                }
                Self::Slipping => (2.0 * w.sinh().powi(2), x.sinh() + x),
            };
        }
        let fall = (-x).exp();
        let (even, odd) = (0.5 * (1.0 + fall * fall), 0.5 * (1.0 - fall * fall));
        match *self {
            Self::Bonded(Bonded { m, p, q, r, s }) => (
                r * even + p * (odd - x * fall) + q * x * fall,
                (m * m + s * w * w) * fall + p * (even - (1.0 + 0.5 * x * x) * fall) + r * odd,
            ),
            Self::Slipping => (even - fall, odd + x * fall),
        }
    }
}

/// `x^n/n! + x^(n+2)/(n+2)! + ..`: what sinh (n = 3) or cosh (n = 4) has beyond its first terms, for x up to 2.
fn tail(x: f64, n: u32) -> f64 {
    let mut term = (1..=n).fold(1.0, |term, k| term * x / f64::from(k));
    let (mut sum, mut k) = (term, f64::from(n));
    while term > f64::EPSILON * sum / 16.0 {
        term *= x * x / ((k + 1.0) * (k + 2.0));
        sum += term;
        k += 2.0;
    }
    sum
}

#[cfg(test)]
mod tests;
