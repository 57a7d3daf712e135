//! Which waves a grid carries, and their amplitudes.

use contact_model::{Amplitude, Error, Result, SelfAffine, line_length};
use std::f64::consts::{PI, TAU};

/// A cut-off that is meant to be a multiple of the longest wave may be rounded below it: it includes waves up to this much beyond.
const CUTOFF_SLACK: f64 = 1e-12;

/// Most cells a side of a map that the normalising sum and the indices are made for.
pub(crate) const MOST_CELLS: usize = 1 << 17;

/// Most elements of a line.
pub(crate) const MOST_ELEMENTS: usize = 1 << 31;

/// `C(q) / C(q_0)` to the power 1/2 with `q` and the roll-off in units of the square's longest wave `q_0`.
fn relative(q: f64, roll_off: f64, hurst: f64) -> f64 {
    (q.max(roll_off) / roll_off.max(1.0)).powf(-(hurst + 1.0))
}

/// Roll-off in units of `q_0`, no larger than the grid's last wave (beyond it the spectrum is flat either way).
fn roll_off(surface: &SelfAffine, last: f64) -> f64 {
    surface.roll_off.map_or(0.0, |q| (q / TAU * surface.size.length()).min(last))
}

fn checked_scale(scale: f64, surface: &SelfAffine) -> Result<f64> {
    let (name, value) = match surface.amplitude {
        Amplitude::RmsHeight(h) => ("rms_height", h),
        Amplitude::Spectrum(c) => ("spectrum constant", c),
    };
    if scale.is_normal() {
        Ok(scale)
    } else {
        Err(Error::domain(name, value, "amplitudes within the range of f64 (choose other units)"))
    }
}

/// The waves of a map: integers (mx, my), `q = (2 pi / L) (mx, my)`, inside a circle.
#[derive(Debug, Clone)]
pub(crate) struct MapSpectrum {
    /// Largest index in either direction (a Nyquist wave has none).
    order: u64,
    /// Largest `mx^2 + my^2`.
    limit2: u64,
    roll_off2: f64,
    half_exponent: f64,
    scale: f64,
}

impl MapSpectrum {
    pub(crate) fn new(surface: &SelfAffine, cells: usize) -> Result<Self> {
        surface.validate()?;
        if cells == 0 || cells > MOST_CELLS {
            let expected = format!("between 1 and {MOST_CELLS} cells a side");
            return Err(Error::domain("cells", cells as f64, expected));
        }
        let n = cells as u64;
        let grid2 = n * n / 4; // |q| <= pi / cell
        let short2 = surface.short_cutoff.map_or(f64::INFINITY, |q| {
            let last = q / TAU * surface.size.length() * (1.0 + CUTOFF_SLACK);
            (last * last).floor()
        });
        let limit2 = if short2 < grid2 as f64 { short2 as u64 } else { grid2 };
        let order = (n - 1) / 2;
        if order == 0 || limit2 == 0 {
            return Err(no_wave("cells", cells, surface));
        }
        let roll_off = roll_off(surface, n as f64);
        let mut spectrum = Self {
            order,
            limit2,
            roll_off2: roll_off * roll_off,
            half_exponent: -0.5 * (surface.hurst + 1.0),
            scale: 1.0,
        };
        let scale = match surface.amplitude {
            Amplitude::RmsHeight(h) => h / spectrum.moment(0).sqrt(),
            Amplitude::Spectrum(c) => TAU / surface.size.length() * c.sqrt(),
        };
        spectrum.scale = checked_scale(scale, surface)?;
        Ok(spectrum)
    }

    /// Number of columns mx = 0, 1, ... that carry waves.
    pub(crate) fn columns(&self) -> usize {
        self.order.min(self.limit2.isqrt()) as usize + 1
    }

    /// Largest |my| of the column mx.
    pub(crate) fn reach(&self, mx: u64) -> u64 {
        self.order.min((self.limit2 - mx * mx).isqrt())
    }

    /// `B_2D` of a wave with `m2 = mx^2 + my^2 > 0`.
    #[inline]
    pub(crate) fn amplitude(&self, m2: u64) -> f64 {
        self.scale * ((m2 as f64).max(self.roll_off2) / self.roll_off2.max(1.0)).powf(self.half_exponent)
    }

    /// `sum |m|^(2 power) B^2` over all waves: the variance of the heights for power 0.
    pub(crate) fn moment(&self, power: i32) -> f64 {
        let mut sum = 0.0;
        // From short waves to long ones: small terms first.
        for mx in (0..self.columns() as u64).rev() {
            let mut column = 0.0;
            for my in (0..=self.reach(mx)).rev() {
                let m2 = mx * mx + my * my;
                if m2 > 0 {
                    let copies = if my > 0 { 2.0 } else { 1.0 };
                    column += copies * self.amplitude(m2).powi(2) * (m2 as f64).powi(power);
                }
            }
            sum += if mx > 0 { 2.0 * column } else { column };
        }
        sum
    }
}

/// Amplitudes `B_1D` of the waves m = 1, 2, ... of a line (index 0 is m = 1).
pub(crate) fn line_amplitudes(surface: &SelfAffine, elements: usize) -> Result<Vec<f64>> {
    surface.validate()?;
    if elements == 0 || elements > MOST_ELEMENTS {
        let expected = format!("between 1 and {MOST_ELEMENTS} elements");
        return Err(Error::domain("elements", elements as f64, expected));
    }
    let length = line_length(surface.size.length());
    let mut last = (elements - 1) / 2;
    if let Some(q) = surface.short_cutoff {
        last = last.min((q / TAU * length * (1.0 + CUTOFF_SLACK)) as usize);
    }
    if last == 0 {
        return Err(no_wave("elements", elements, surface));
    }
    let roll_off = roll_off(surface, elements as f64);
    let unit = line_length(1.0).recip(); // the line's longest wave in units of the square's
    let mut amplitudes: Vec<f64> = (1..=last)
        .map(|m| (PI * m as f64).sqrt() * relative(m as f64 * unit, roll_off, surface.hurst))
        .collect();
    let scale = match surface.amplitude {
        Amplitude::RmsHeight(h) => {
            let variance: f64 = amplitudes.iter().rev().map(|b| 2.0 * b * b).sum();
            h / variance.sqrt()
        }
        Amplitude::Spectrum(c) => TAU / length * c.sqrt(),
    };
    let scale = checked_scale(scale, surface)?;
    for b in &mut amplitudes {
        *b *= scale;
    }
    Ok(amplitudes)
}

fn no_wave(name: &'static str, n: usize, surface: &SelfAffine) -> Error {
    if n < 3 {
        return Error::domain(
            name,
            n as f64,
            "at least 3: a relief cannot be made, the grid carries no wave",
        );
    }
    let q = surface.short_cutoff.unwrap_or(0.0);
    Error::domain("short_cutoff", q, "at least the longest wave: a relief cannot be made, no wave is left")
}
