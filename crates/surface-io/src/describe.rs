//! The description of a map in numbers.

use contact_model::units::{ascii, short, to_digits};
use contact_model::{Cells, HeightMap, Size};
use std::f64::consts::TAU;
use std::fmt;
use surface_gen::{
    fit_range, hurst_from_spectrum, radial_spectrum, rms_height, rms_slope_differences, windowed,
};

/// Numbers that describe a map, in its own unit of length. If that is the metre ([`Description::in_metres`]),
/// the text has units that suit the numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Columns and rows.
    pub cells: Cells,
    /// Sides of the rectangle.
    pub size: Size,
    /// Number of undefined points; the other numbers are of the defined ones.
    pub undefined: usize,
    /// Lowest and highest height.
    pub range: [f64; 2],
    /// Root mean square of the heights about their mean.
    pub rms_height: f64,
    /// Root mean square slope from differences of neighbouring cells.
    pub rms_slope: f64,
    /// Spectrum averaged over rings of the wavenumber q: (q, C_2D), two-sided, in 1/length and length^4.
    /// Empty where points are undefined.
    pub spectrum: Vec<(f64, f64)>,
    /// Hurst exponent of the spectrum.
    pub hurst: Result<f64, Absent>,
    /// Wavenumbers from and to which the exponent was fitted.
    pub fitted: [f64; 2],
    /// `m` where lengths are in metres, else empty.
    unit: &'static str,
}

/// Why a map has no Hurst exponent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Absent {
    /// The map has undefined points, and their pattern would change the spectrum.
    Undefined,
    /// The map is a profile, whose spectrum has no rings; see `surface_statistics::ProfileFit`.
    Profile,
    /// All heights are equal.
    NoHeight,
    /// Too few rings lie in the range of the fit: fewer than about 40 cells along the shorter side, or cells
    /// far from squares.
    FewWaves,
    /// The fit was left out ([`Description::without_fit`]).
    NotFitted,
}

impl fmt::Display for Absent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Undefined => "points are undefined; fill them first",
            Self::Profile => "one row of points has the spectrum of a profile, not of a surface",
            Self::NoHeight => "all heights are equal",
            Self::FewWaves => "too few waves along one side",
            Self::NotFitted => "not requested",
        })
    }
}

impl Description {
    /// Fractal dimension D_f = 3 - H, where it lies between 2 and 3 as that of a self-affine surface does
    /// (within 0.1, the error of a fit).
    pub fn fractal_dimension(&self) -> Option<f64> {
        self.hurst.ok().map(|h| 3.0 - h).filter(|d| (1.9..=3.1).contains(d))
    }

    /// The description of a map in metres, whose text has units.
    #[must_use]
    pub fn in_metres(self) -> Self {
        Self { unit: "m", ..self }
    }

    /// The description without the straight-line fit of the exponent. Use it where another fit with an
    /// interval is reported too: the two differ wherever the spectrum rolls off.
    #[must_use]
    pub fn without_fit(self) -> Self {
        Self { hurst: Err(Absent::NotFitted), ..self }
    }
}

/// Describes a map: sides, range, rms height and slope, spectrum, Hurst exponent.
///
/// The map is not taken as periodic. Before the spectrum is computed, the mean is subtracted and the heights
/// are multiplied by Hann's window. The window keeps the jump between opposite edges out of the short waves,
/// spreads each ring over its neighbours, and is scaled so that a homogeneous surface keeps its spectrum.
/// Subtract a tilt first ([`crate::Detrend::Plane`]). The exponent is fitted by least squares in logarithms
/// from an eighth of the shorter side to waves of four of the longer cell sides. Cost O(N log N) for N
/// points, memory about three times that of the map.
///
/// ```
/// use contact_model::SelfAffine;
/// let map = surface_gen::self_affine_map(&SelfAffine::new(2.3, 1.0, 0.01)?, 256, 1)?;
/// let description = surface_io::describe(&map);
/// assert!((description.rms_height / 0.01 - 1.0).abs() < 1e-12);
/// assert!((description.fractal_dimension().unwrap() - 2.3).abs() < 0.05);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn describe(map: &HeightMap) -> Description {
    let (cells, size, undefined) = (map.cells(), map.size(), map.undefined());
    let ends = |(low, high): (f64, f64), h: f64| (low.min(h), high.max(h));
    let (low, high) = map.defined().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let whole = undefined == 0;
    let rings = || windowed(map).and_then(|map| radial_spectrum(&map)).unwrap_or_default();
    let spectrum = if cells.rows == 1 { Vec::new() } else { rings() };
    let fitted = fit_range(map);
    let hurst = if !whole {
        Err(Absent::Undefined)
    } else if high <= low {
        Err(Absent::NoHeight)
    } else if cells.rows == 1 {
        Err(Absent::Profile)
    } else {
        hurst_from_spectrum(&spectrum, fitted[0], fitted[1]).map_err(|_| Absent::FewWaves)
    };
    Description {
        cells,
        size,
        undefined,
        range: [low, high],
        rms_height: rms_height(map.heights()),
        rms_slope: rms_slope_differences(map),
        spectrum,
        hurst,
        fitted,
        unit: "",
    }
}

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.range;
        let Cells { columns, rows } = self.cells;
        let Size { x, y } = self.size;
        let length = |value: f64| ascii(&to_digits(value, self.unit, 7));
        let about = |value: f64| ascii(&to_digits(value, self.unit, 4));
        writeln!(f, "cells              {columns} x {rows} (columns x rows)")?;
        writeln!(f, "size               {} x {}", length(x), length(y))?;
        writeln!(f, "cell               {} x {}", length(x / columns as f64), length(y / rows as f64))?;
        writeln!(f, "undefined points   {} of {}", self.undefined, columns * rows)?;
        writeln!(f, "range of heights   {} to {}", about(low), about(high))?;
        writeln!(f, "rms height         {}", about(self.rms_height))?;
        write!(f, "rms slope          {}", short(self.rms_slope))?;
        let [longest, shortest] = self.fitted.map(|q| about(TAU / q));
        match (self.fractal_dimension(), self.hurst) {
            (Some(d), _) => {
                write!(f, "\nfractal dimension  {d:.3} (waves of length {longest} to {shortest})")?;
            }
            (None, Ok(h)) => write!(
                f,
                "\nfractal dimension  none: C_2D of waves of length {longest} to {shortest} goes as q^{:.1}, that of a \
                 self-affine surface as q^-4 to q^-2 where it has neither roll-off nor cut-off",
                -2.0 * (h + 1.0)
            )?,
            (None, Err(Absent::NotFitted)) => {}
            (None, Err(absent)) => write!(f, "\nfractal dimension  not determined: {absent}")?,
        }
        if !self.spectrum.is_empty() {
            write!(f, "\nspectrum           wavelength, C_2D")?;
        }
        // Rings 1, 2, 4, ...: one for each octave.
        for ring in (0..).map(|k| 1_usize << k).take_while(|&ring| ring <= self.spectrum.len()) {
            let (q, c) = self.spectrum[ring - 1];
            let density = if self.unit.is_empty() { String::new() } else { format!(" {}^4", self.unit) };
            write!(f, "\n                   {:9}  {c:.3e}{density}", about(TAU / q))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
