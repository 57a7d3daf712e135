//! Which waves a grid carries, and their amplitudes.

use crate::lattice::{FEWEST, Lattice};
use contact_model::{Amplitude, Cells, Error, Result, SelfAffine, line_length};
use numerics::parallel::map;
use std::f64::consts::{PI, TAU};

/// A limit that is meant to be a multiple of the longest wave may be rounded below it: it includes waves up
/// to this much beyond.
pub(crate) const CUTOFF_SLACK: f64 = 1e-12;

/// Most cells a side of a map that the normalising sum and the indices are made for.
pub(crate) const MOST_CELLS: usize = 1 << 17;

/// Most elements of a line.
pub(crate) const MOST_ELEMENTS: usize = 1 << 31;

/// `C(q) / C(q_0)` to the power 1/2 with `q` and the roll-off in units of `q_0 = 2 pi / L`.
fn relative(q: f64, roll_off: f64, hurst: f64) -> f64 {
    (q.max(roll_off) / roll_off.max(1.0)).powf(-(hurst + 1.0))
}

/// Roll-off in units of `q_0`, no larger than the grid's last wave (beyond it the spectrum is flat either
/// way).
fn roll_off(surface: &SelfAffine, last: f64) -> f64 {
    surface.roll_off.map_or(0.0, |q| (q / TAU * surface.size.length()).min(last))
}

fn checked_scale(scale: f64, surface: &SelfAffine) -> Result<f64> {
    let (name, value) = match surface.amplitude {
        Amplitude::RmsHeight(h) => ("rms_height", h),
        Amplitude::Spectrum(c) => ("spectrum constant", c),
    };
    if scale.is_normal() { Ok(scale) } else { Err(Error::not_representable(name, value)) }
}

/// The waves of a map inside a circle, and their amplitudes. Wavenumbers are counted in `q_0 = 2 pi / L`.
#[derive(Debug, Clone)]
pub(crate) struct MapSpectrum {
    lattice: Lattice,
    /// Largest indices along x and y (a Nyquist wave has none).
    orders: [u64; 2],
    /// Largest `|q|^2`.
    limit2: f64,
    roll_off2: f64,
    half_exponent: f64,
    scale: f64,
}

impl MapSpectrum {
    pub(crate) fn new(surface: &SelfAffine, cells: Cells) -> Result<Self> {
        surface.validate()?;
        let Cells { columns, rows } = cells;
        for (name, count) in [("columns", columns), ("rows", rows)] {
            if count == 0 || count > MOST_CELLS {
                let name = if columns == rows { "cells" } else { name };
                let expected = format!("between 1 and {MOST_CELLS} cells a side");
                return Err(Error::domain(name, count as f64, expected));
            }
        }
        cells.validate(surface.size)?;
        let (lattice, length) = (Lattice::new(cells, surface.size), surface.size.length());
        let grid2 = lattice.limit().powi(2) * (1.0 + CUTOFF_SLACK);
        let short = surface.short_cutoff.map_or(f64::INFINITY, |q| q / TAU * length * (1.0 + CUTOFF_SLACK));
        let roll_off = roll_off(surface, 2.0 * lattice.limit());
        let mut spectrum = Self {
            lattice,
            orders: [columns, rows].map(|count| (count as u64 - 1) / 2),
            limit2: grid2.min(short * short),
            roll_off2: roll_off * roll_off,
            half_exponent: -0.5 * (surface.hurst + 1.0),
            scale: 1.0,
        };
        if spectrum.columns() == 1 && spectrum.reach(0) == 0 {
            return Err(no_wave("cells", columns.max(rows), surface));
        }
        let scale = match surface.amplitude {
            Amplitude::RmsHeight(h) => h / spectrum.moment(0).sqrt(),
            Amplitude::Spectrum(c) => TAU / length * c.sqrt(),
        };
        spectrum.scale = checked_scale(scale, surface)?;
        Ok(spectrum)
    }

    /// Number of columns mx = 0, 1, ... that carry waves.
    pub(crate) fn columns(&self) -> usize {
        let guess = (self.limit2 / self.square(1, 0)).sqrt();
        last(self.orders[0], guess, |mx| self.square(mx, 0) <= self.limit2) as usize + 1
    }

    /// Largest |my| of the column mx.
    pub(crate) fn reach(&self, mx: u64) -> u64 {
        let guess = ((self.limit2 - self.square(mx, 0)) / self.square(0, 1)).max(0.0).sqrt();
        last(self.orders[1], guess, |my| self.square(mx, my) <= self.limit2)
    }

    /// `|q|^2` of the wave (mx, my).
    #[inline]
    pub(crate) fn square(&self, mx: u64, my: u64) -> f64 {
        self.lattice.square(mx, my)
    }

    /// `B_2D` of a wave with `|q|^2 = square > 0`.
    #[inline]
    pub(crate) fn amplitude(&self, square: f64) -> f64 {
        self.scale * (square.max(self.roll_off2) / self.roll_off2.max(1.0)).powf(self.half_exponent)
    }

    /// `sum |q|^(2 power) B^2` over all waves: the variance of the heights for power 0.
    pub(crate) fn moment(&self, power: i32) -> f64 {
        // From short waves to long ones: small terms first.
        let column = |mx: u64| {
            let mut column = 0.0;
            for my in (0..=self.reach(mx)).rev() {
                if (mx, my) != (0, 0) {
                    let (copies, square) = (if my > 0 { 2.0 } else { 1.0 }, self.square(mx, my));
                    column += copies * self.amplitude(square).powi(2) * square.powi(power);
                }
            }
            if mx > 0 { 2.0 * column } else { column }
        };
        let columns = self.columns();
        let work = columns * self.orders[1] as usize;
        map(work, (0..columns).rev(), |mx| column(mx as u64)).iter().fold(0.0, |sum, column| sum + column)
    }
}

/// Largest index up to `order` that lies inside; those before it do too. The guess may be off by its
/// rounding.
fn last(order: u64, guess: f64, inside: impl Fn(u64) -> bool) -> u64 {
    let mut m = (guess as u64).min(order);
    while m > 0 && !inside(m) {
        m -= 1;
    }
    while m < order && inside(m + 1) {
        m += 1;
    }
    m
}

/// Errors for a number of elements that no line has.
pub(crate) fn checked_elements(elements: usize) -> Result<()> {
    if elements == 0 || elements > MOST_ELEMENTS {
        let expected = format!("between 1 and {MOST_ELEMENTS} elements");
        return Err(Error::domain("elements", elements as f64, expected));
    }
    Ok(())
}

/// Amplitudes `B_1D` of the waves m = 1, 2, ... of a line (index 0 is m = 1).
pub(crate) fn line_amplitudes(surface: &SelfAffine, elements: usize) -> Result<Vec<f64>> {
    surface.validate()?;
    checked_elements(elements)?;
    let length = line_length(surface.size.length());
    let mut last = (elements - 1) / 2;
    if let Some(q) = surface.short_cutoff {
        last = last.min((q / TAU * length * (1.0 + CUTOFF_SLACK)) as usize);
    }
    if last == 0 {
        return Err(no_wave("elements", elements, surface));
    }
    let roll_off = roll_off(surface, elements as f64);
    let unit = line_length(1.0).recip(); // the line's longest wave in units of q_0
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
    if n < FEWEST {
        let expected = format!("at least {FEWEST}: the grid carries no wave");
        return Error::domain(name, n as f64, expected);
    }
    let q = surface.short_cutoff.unwrap_or(0.0);
    Error::domain("short_cutoff", q, "at least the wavenumber of the longest wave, or no wave remains")
}
