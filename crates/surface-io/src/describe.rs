//! What a map holds.

use contact_model::HeightMap;
use std::f64::consts::{PI, TAU};
use std::fmt;
use surface_gen::{hurst_from_spectrum, radial_spectrum, rms_height, rms_slope_differences};

/// First ring of the fit: the first ones bend it (see [`surface_gen::radial_spectrum`]), and a window smears each over its neighbours.
const FIRST_RING: f64 = 8.0;

/// The fit ends at this share of the shortest wave's wavenumber: instruments damp what is next to it.
const LAST_SHARE: f64 = 0.5;

/// Mean square of Hann's window sin^2 along one axis, 3/8, for both axes: the square root of `(3/8)^2`.
const WINDOW: f64 = 0.375;

/// Numbers that describe a map, in its own unit of length.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Cells a side.
    pub cells: usize,
    /// Side of the square.
    pub side: f64,
    /// Lowest and highest height.
    pub range: [f64; 2],
    /// Root mean square of the heights about their mean.
    pub rms_height: f64,
    /// Root mean square slope from differences of neighbouring cells.
    pub rms_slope: f64,
    /// Spectrum averaged over rings 1 to N/2: (q, C_2D), two-sided, in 1/length and length^4.
    pub spectrum: Vec<(f64, f64)>,
    /// Hurst exponent of the spectrum; `None` where too few rings lie in the range of the fit (below 40 cells a side) or the map is flat.
    pub hurst: Option<f64>,
    /// Wavenumbers from and to which the exponent was fitted.
    pub fitted: [f64; 2],
}

impl Description {
    /// Effective fractal dimension D_f = 3 - H, whether or not it lies between 2 and 3 as that of a self-affine surface does.
    pub fn fractal_dimension(&self) -> Option<f64> {
        self.hurst.map(|h| 3.0 - h)
    }
}

/// Describes a map: range, rms height and slope, spectrum, Hurst exponent.
///
/// The map is not taken as periodic: its mean is subtracted and Hann's window laid over it before the spectrum, which keeps the jump between
/// opposite edges out of the short waves, smears each ring over its neighbours, and is scaled so that a homogeneous surface keeps its spectrum. Subtract a
/// tilt first ([`crate::Detrend::Plane`]). The exponent is fitted by least squares in logarithms from ring 8 to half of the shortest wave's
/// wavenumber. Cost O(N^2 log N), memory about three times that of the map.
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
    let (cells, side) = (map.columns(), map.length());
    let ends = |(low, high): (f64, f64), &h: &f64| (low.min(h), high.max(h));
    let (low, high) = map.heights().iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let spectrum = windowed(map, 0.5 * low + 0.5 * high)
        .map_or_else(Vec::new, |map| radial_spectrum(&map).unwrap_or_default());
    let fitted = [TAU / side * FIRST_RING, LAST_SHARE * PI * cells as f64 / side];
    let hurst = hurst_from_spectrum(&spectrum, fitted[0], fitted[1]).ok();
    Description {
        cells,
        side,
        range: [low, high],
        rms_height: rms_height(map.heights()),
        rms_slope: rms_slope_differences(map),
        spectrum,
        hurst,
        fitted,
    }
}

/// The map about its mean under Hann's window; `None` where the mean is not representable, which finite reliefs exclude.
fn windowed(map: &HeightMap, middle: f64) -> Option<HeightMap> {
    let cells = map.columns();
    let window: Vec<f64> = (0..cells).map(|i| (PI * (i as f64 + 0.5) / cells as f64).sin().powi(2)).collect();
    let about: Vec<f64> = map.heights().iter().map(|h| h - middle).collect();
    let count = about.len() as f64;
    let mean: f64 = about.chunks_exact(cells).map(|row| row.iter().map(|h| h / count).sum::<f64>()).sum();
    let heights = about
        .iter()
        .enumerate()
        .map(|(i, h)| (h - mean) * window[i % cells] * window[i / cells] / WINDOW)
        .collect();
    HeightMap::new(cells, map.length(), heights).ok()
}

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.range;
        writeln!(f, "cells              {} x {}", self.cells, self.cells)?;
        writeln!(f, "side               {:e}", self.side)?;
        writeln!(f, "range of heights   {low:e} to {high:e}")?;
        writeln!(f, "rms height         {:.6e}", self.rms_height)?;
        writeln!(f, "rms slope          {:.6e}", self.rms_slope)?;
        match self.fractal_dimension() {
            Some(d) => {
                let [longest, shortest] = self.fitted.map(|q| TAU / q);
                write!(
                    f,
                    "fractal dimension  {d:.3} (fitted to waves of length {longest:.3e} to {shortest:.3e})"
                )?;
                let outside =
                    if (2.0..=3.0).contains(&d) { "" } else { "; outside 2 to 3: not self-affine there" };
                f.write_str(outside)?;
            }
            None => write!(f, "fractal dimension  not determined: too few waves, or no relief")?,
        }
        if !self.spectrum.is_empty() {
            write!(f, "\nspectrum           wavelength, C_2D")?;
        }
        // Rings 1, 2, 4, ...: one for each octave.
        for ring in (0..).map(|k| 1_usize << k).take_while(|&ring| ring <= self.spectrum.len()) {
            let (q, c) = self.spectrum[ring - 1];
            write!(f, "\n                   {:.3e}  {c:.3e}", TAU / q)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
