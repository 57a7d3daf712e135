//! Axisymmetric bodies through their MDR profile g(x), which is exact for force, approach, stiffness and
//! contact radius.
//!
//! A body `f(r)` is replaced by the line `g(x) = |x| int_0^|x| f'(r) / sqrt(x^2 - r^2) dr` (Hess 2011; Popov
//! and Hess 2015), pressed into independent springs of stiffness E* per length. The half width of the line in
//! contact is the radius of the round contact.

use contact_model::{Error, Line, Result, Size, Surface, SurfaceKind};
use std::f64::consts::PI;

/// The MDR profile of an axisymmetric body, in units of `L = sqrt(Lx Ly)` of its rectangle (the side of a
/// square).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Profile {
    /// `g = slope |x|^exponent` of the body `z = c r^n`: `exponent = n`, `slope = kappa_n c L^(n - 1)`.
    Power {
        /// Exponent n.
        exponent: f64,
        /// Depth at x = L, in units of L.
        slope: f64,
    },
    /// A flat circular punch: `g = 0` for `|x| <= radius`, nothing outside.
    Flat {
        /// Radius in units of L.
        radius: f64,
    },
}

/// A state of a [`Profile`]: lengths in units of L, the force in `E* L^2`, the stiffness in `E* L`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RoundContact {
    pub force: f64,
    pub approach: f64,
    pub radius: f64,
}

impl RoundContact {
    pub const NONE: Self = Self { force: 0.0, approach: 0.0, radius: 0.0 };

    /// k = 2 E* a, the stiffness at fixed contact area, which is the length in contact. Without adhesion it
    /// equals dF/dd.
    pub fn stiffness(self) -> f64 {
        2.0 * self.radius
    }

    /// A = pi a^2.
    pub fn area(self) -> f64 {
        PI * self.radius * self.radius
    }
}

impl Profile {
    /// The kinds of surfaces that have a profile.
    pub(crate) const SURFACES: &'static [SurfaceKind] =
        &[SurfaceKind::Sphere, SurfaceKind::Cone, SurfaceKind::PowerLaw, SurfaceKind::FlatCircle];

    /// The profile of a sphere (paraboloid), cone, power-law body or flat circular punch; `None` for any
    /// other surface.
    ///
    /// # Errors
    /// [`Error::Domain`] for a body whose depth at `r = L` over `L` no `f64` holds; [`Error::OutOfRange`] for
    /// a punch wider than the shorter side.
    ///
    /// ```
    /// use contact_model::Surface;
    /// use mdr1d::Profile;
    /// // A paraboloid r^2/2 has kappa_2 = 2: g = x^2.
    /// let g = Profile::new(&Surface::Sphere { radius: 1.0, size: 1.0.into() })?.expect("a sphere is axisymmetric");
    /// assert!((g.depth(0.5).expect("inside") - 0.25).abs() < 1e-14);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(surface: &Surface) -> Result<Option<Self>> {
        surface.validate()?;
        let power = |exponent: f64, slope: f64| {
            let slope = kappa(exponent)? * slope;
            if slope.is_finite() && slope > 0.0 {
                Ok(Some(Self::Power { exponent, slope }))
            } else {
                Err(Error::not_representable("depth of the body at r = L, over L", slope))
            }
        };
        match *surface {
            Surface::Sphere { radius, size } => power(2.0, 0.5 * (size.length() / radius)),
            Surface::Cone { slope, .. } => power(1.0, slope),
            Surface::PowerLaw { coefficient, exponent, size } => {
                // L^(n-1) in two halves: the product may be moderate where the power alone overflows.
                let half = size.length().powf(0.5 * (exponent - 1.0));
                power(exponent, coefficient * half * half)
            }
            Surface::FlatCircle { radius, size } => {
                let radius = radius / size.length();
                check_radius(radius, size)?;
                Ok(Some(Self::Flat { radius }))
            }
            _ => Ok(None),
        }
    }

    /// `g(x)`, both in units of L; `None` outside a flat punch.
    pub fn depth(self, x: f64) -> Option<f64> {
        match self {
            Self::Power { exponent, slope } => Some(slope * x.abs().powf(exponent)),
            Self::Flat { radius } => (x.abs() <= radius).then_some(0.0),
        }
    }

    /// The profile sampled at the centres of an odd number of elements over `|x| <= half_width`, in units of
    /// L.
    ///
    /// It serves checks of the numerics: [`crate::Bearing`] of this line converges to the exact state, the
    /// force with order `min(2, 1 + n)` in the element, the stiffness with order 1. The number of elements is
    /// odd, so that the apex is the centre of an element and `d = 0` is first touch.
    ///
    /// # Errors
    /// [`Error::Shape`] for an even number of elements; [`Error::OutOfRange`] for a half width beyond a flat
    /// punch; errors of [`Line::new`].
    pub fn line(self, half_width: f64, elements: usize) -> Result<Line> {
        if elements.is_multiple_of(2) {
            let expected = "an odd number (the apex is an element's centre)".into();
            return Err(Error::Shape { name: "elements".into(), found: elements, expected });
        }
        let element = 2.0 * half_width / elements as f64;
        let middle = (elements / 2) as f64;
        let height = |i: usize| {
            let x = (i as f64 - middle) * element;
            let max = if let Self::Flat { radius } = self { radius } else { f64::INFINITY };
            self.depth(x).map(|g| -g).ok_or(Error::OutOfRange {
                name: "x".into(),
                value: x.abs(),
                min: 0.0,
                max,
            })
        };
        Line::new(2.0 * half_width, (0..elements).map(height).collect::<Result<_>>()?)
    }

    /// State at an approach (in L): `g(a) = d`, `F = 2 d a n / (n + 1)`.
    pub(crate) fn at_approach(self, approach: f64) -> RoundContact {
        if approach <= 0.0 {
            return RoundContact::NONE;
        }
        match self {
            Self::Power { exponent, slope } => {
                let radius = root(approach / slope, exponent);
                let force = 2.0 * approach * radius * (exponent / (exponent + 1.0));
                RoundContact { force, approach, radius }
            }
            Self::Flat { radius } => RoundContact { force: 2.0 * radius * approach, approach, radius },
        }
    }

    /// State at a force (in E* L^2): `a^(n + 1) = F (n + 1) / (2 n kappa_n c)`.
    pub(crate) fn at_force(self, force: f64) -> RoundContact {
        if force <= 0.0 {
            return RoundContact::NONE;
        }
        match self {
            Self::Power { exponent, slope } => {
                let share = exponent / (exponent + 1.0);
                let radius = root(force / (2.0 * share) / slope, exponent + 1.0);
                RoundContact { force, approach: force / (2.0 * share * radius), radius }
            }
            Self::Flat { radius } => RoundContact { force, approach: force / (2.0 * radius), radius },
        }
    }
}

/// `x^(1/n)`, without the error of `1/n` where a function does better.
fn root(x: f64, n: f64) -> f64 {
    // The bits of the exponent pick the routine; every branch is the same function.
    match n.to_bits() {
        b if b == 1.0_f64.to_bits() => x,
        b if b == 2.0_f64.to_bits() => x.sqrt(),
        b if b == 3.0_f64.to_bits() => x.cbrt(),
        _ => x.powf(n.recip()),
    }
}

/// `kappa_n = (sqrt(pi)/2) n Gamma(n/2) / Gamma((n + 1)/2)`: the profile of `r^n` is `kappa_n |x|^n` (Hess
/// 2011).
///
/// No gamma function is needed: `kappa_n = sqrt(pi) Gamma(x + 1/2) / Gamma(x)` with `x = (n + 1)/2` obeys
/// `kappa_n = kappa_(n+2) (n + 1)/(n + 2)` and for large n has a rapidly convergent asymptotic series.
/// Relative error below 1e-14 for every n > 0.
///
/// # Errors
/// [`Error::Domain`] for an exponent that is not finite and positive.
///
/// ```
/// use mdr1d::axisymmetric::kappa;
/// assert!((kappa(1.0)? - std::f64::consts::FRAC_PI_2).abs() < 1e-14); // a cone
/// assert!((kappa(2.0)? - 2.0).abs() < 1e-14); // a sphere
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn kappa(exponent: f64) -> Result<f64> {
    /// Where the series takes over: its first neglected term is below 3e-17 of the sum.
    const LARGE: f64 = 24.0;
    /// Coefficients of `w^(-2 i)`, from Bernoulli polynomials; all are exact in binary.
    const SERIES: [f64; 7] = [
        1.0,
        1.0 / 32.0,
        -9.0 / 2048.0,
        153.0 / 65_536.0,
        -21_429.0 / 8_388_608.0,
        1_268_343.0 / 268_435_456.0,
        -227_803_437.0 / 17_179_869_184.0,
    ];
    if !(exponent.is_finite() && exponent > 0.0) {
        return Err(Error::domain("exponent", exponent, "a finite number > 0"));
    }
    let mut n = exponent;
    let mut factor = 1.0;
    while n < LARGE {
        factor *= (n + 1.0) / (n + 2.0);
        n += 2.0;
    }
    // (Gamma(w + 3/4) / Gamma(w + 1/4))^2 = w (1 + 1/(32 w^2) - ...) with w = (n + 1/2)/2: even powers of 1/w
    // only.
    let w = 0.5 * (n + 0.5);
    let y = (w * w).recip();
    let series = SERIES.iter().rev().fold(0.0, |sum, c| sum * y + c);
    Ok(factor * (PI * w * series).sqrt())
}

/// Errors where a round contact (radius in units of L) has left the rectangle, beyond which the half-space is
/// free.
pub(crate) fn check_radius(radius: f64, size: Size) -> Result<()> {
    size.admit_radius("contact radius", radius * size.length())
}

#[cfg(test)]
mod tests;
