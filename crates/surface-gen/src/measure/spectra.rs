//! Spectra of samples, as periodic fields.

use super::defined::defined_everywhere;
use crate::lattice::Lattice;
use crate::spectrum::CUTOFF_SLACK;
use contact_model::{Cells, HeightMap, Line, Result};
use numerics::fourier::{Complex64, ForwardTransform};
use numerics::range::{middle_and_half_width, range};
use std::f64::consts::TAU;

/// One wave of the transform of a map, `H = 1/N sum h exp(-2 pi i (mx ix / columns + my iy / rows))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Periods `[mx, my]` over the sides: wave vector `2 pi (mx/Lx, my/Ly)`, `0 <= mx <= columns/2`,
    /// `-rows/2 < my <= rows/2`.
    pub index: [isize; 2],
    /// Variance `|H|^2` of the heights in this wave, in the square of the unit that [`periodogram`] returns.
    pub variance: f64,
    /// Number of waves that this one represents: 2 where the conjugate wave is not visited separately (`0 <
    /// mx < columns/2`), else 1.
    pub copies: f64,
}

/// Visits every wave of the map but the mean, in a fixed order, and returns the unit of their amplitudes
/// (half the range of the heights, so that no square leaves the range of f64).
///
/// The map is taken as periodic; apply a window first where it is not. Summed with their copies, the
/// variances are the square of [`crate::rms_height`]; `C_2D = Lx Ly / (2 pi)^2 |H|^2`. Cost O(N log N),
/// memory about that of the map.
///
/// # Errors
/// [`contact_model::Error::Domain`] for a map with undefined points.
///
/// ```
/// use contact_model::Surface;
/// // h = 0.2 cos(2 pi x): |H| = 0.1 for one wave and its conjugate.
/// let sine = Surface::Sine { amplitude: 0.2, wavelength: 1.0, size: 1.0.into() };
/// let map = surface_gen::height_map(&sine, 16, 0)?;
/// let mut found = 0.0;
/// let unit = surface_gen::periodogram(&map, |wave| {
///     if wave.index == [1, 0] {
///         found = wave.copies * wave.variance;
///     }
/// })?;
/// assert!((found * unit * unit - 0.02).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn periodogram(map: &HeightMap, mut visit: impl FnMut(Wave)) -> Result<f64> {
    defined_everywhere(map, "a spectrum")?;
    let Cells { columns: nx, rows: ny } = map.cells();
    let (middle, unit) = middle_and_half_width(range(map.heights()));
    let transformed = ForwardTransform::new(nx, ny).of(|iy, row| {
        for (x, h) in row.iter_mut().zip(&map.heights()[iy * nx..]) {
            *x = (h - middle) / unit / nx as f64;
        }
    });
    for (mx, column) in transformed.chunks_exact(ny).enumerate() {
        let copies = if mx == 0 || 2 * mx == nx { 1.0 } else { 2.0 };
        for (iy, value) in column.iter().enumerate() {
            let my = iy.cast_signed() - if 2 * iy > ny { ny.cast_signed() } else { 0 };
            if (mx, my) != (0, 0) {
                let variance = value.norm_sqr() / (ny as f64).powi(2);
                visit(Wave { index: [mx.cast_signed(), my], variance, copies });
            }
        }
    }
    Ok(unit)
}

/// Calls `visit(|q|^2, |H|^2, copies, [q_x^2, q_x q_y])` for every wave but the mean, in a fixed order;
/// returns the unit of H. Wavenumbers are in units of `2 pi / L`, `L = sqrt(Lx Ly)`; `copies` counts the
/// conjugate wave.
///
/// # Errors
/// [`contact_model::Error::Domain`] for a map with undefined points.
pub(super) fn waves(
    map: &HeightMap,
    lattice: &Lattice,
    mut visit: impl FnMut(f64, f64, f64, [f64; 2]),
) -> Result<f64> {
    periodogram(map, |wave| {
        let [mx, my] = wave.index.map(|m| m.unsigned_abs() as u64);
        // (L/Lx) (L/Ly) = 1.
        let product = (wave.index[0] * wave.index[1]) as f64;
        visit(lattice.square(mx, my), wave.variance, wave.copies, [lattice.square(mx, 0), product]);
    })
}

/// Root mean square slope of a map as a periodic field, `sqrt(sum |q|^2 |H(q)|^2)`, dimensionless.
///
/// Exact for the surfaces of this crate. For a body that is not periodic the jump from one edge to the
/// opposite one counts as slope: take [`crate::rms_slope_differences`] there. Cost O(N log N) for N cells,
/// memory about that of the map.
///
/// # Errors
/// [`contact_model::Error::Domain`] for a map with undefined points.
///
/// ```
/// use contact_model::Surface;
/// // h = 0.1 cos(2 pi x): h' has the amplitude 0.2 pi, its rms is 0.2 pi / sqrt(2).
/// let sine = Surface::Sine { amplitude: 0.1, wavelength: 1.0, size: 1.0.into() };
/// let slope = surface_gen::rms_slope(&*surface_gen::height_map(&sine, 16, 0)?)?;
/// assert!((slope - 0.4442882938158366).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn rms_slope(map: &HeightMap) -> Result<f64> {
    let mut sum = 0.0;
    let lattice = Lattice::new(map.cells(), map.size());
    let unit = waves(map, &lattice, |square, power, copies, _| sum += copies * square * power)?;
    Ok(TAU * sum.sqrt() * (unit / map.length()))
}

/// Elastic energy of full contact with a periodic map, per area and over E*: `(1/4) sum |q| |H(q)|^2`, a length.
///
/// E* times it is the work per area that presses the surface flat. An adhesion whose work per area is larger pulls it
/// into full contact by itself (Persson and Tosatti, J. Chem. Phys. 115, 5597 (2001)). It is that of half-spaces, and
/// of the waves of the map. Cost O(N log N) for N cells, memory about that of the map.
///
/// # Errors
/// [`contact_model::Error::Domain`] for a map with undefined points.
///
/// ```
/// use contact_model::Surface;
/// // A wave of amplitude a is pressed flat by a mean pressure E* q a/2, whose work per area is E* q a^2/8.
/// let sine = Surface::Sine { amplitude: 0.1, wavelength: 1.0, size: 1.0.into() };
/// let energy = surface_gen::full_contact_energy(&*surface_gen::height_map(&sine, 16, 0)?)?;
/// assert!((energy - 0.007853981633974483).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn full_contact_energy(map: &HeightMap) -> Result<f64> {
    let mut sum = 0.0;
    let lattice = Lattice::new(map.cells(), map.size());
    let unit = waves(map, &lattice, |square, power, copies, _| sum += copies * square.sqrt() * power)?;
    Ok(0.25 * TAU * sum * unit * (unit / map.length()))
}

/// Spectrum of a map averaged over rings: pairs (q, C_2D) in units of 1/length and length^4, for ring 1, 2,
/// ... up to `|q| = pi / max(dx, dy)` (N/2 for a square of N x N cells).
///
/// `C_2D(q) = Lx Ly / (2 pi)^2 |H(q)|^2`, two-sided: `integral of C_2D over all of the plane of q = rms^2`
/// (the convention of Eq. 2). Rings are as wide as the longest wave, `2 pi / max(Lx, Ly)`, so that none is
/// empty and no long wave is left out: ring k holds the waves with |q| nearest to k of these, q is the mean
/// of their wavenumbers and C the arithmetic mean of theirs, zeros beyond a cut-off included. An axis of 1 or
/// 2 cells carries no wave of either sign and decides neither the width nor the last ring. On a power law
/// `q^-p` a ring's mean exceeds the value at its q by about `p (p + 1) / (24 k^2)` of it. The mean height is
/// left out. Cost O(N log N) for N cells, memory about that of the map.
///
/// # Errors
/// [`contact_model::Error::Domain`] for a map with undefined points.
///
/// ```
/// use contact_model::Surface;
/// // One wave along x of amplitude 0.2: two of the 4 waves (+-1, 0), (0, +-1) and 4 of (+-1, +-1) of ring 1 carry 0.01 each.
/// let sine = Surface::Sine { amplitude: 0.2, wavelength: 1.0, size: 1.0.into() };
/// let spectrum = surface_gen::radial_spectrum(&*surface_gen::height_map(&sine, 16, 0)?)?;
/// let tau = std::f64::consts::TAU;
/// assert!((spectrum[0].1 * tau * tau - 2.0 * 0.01 / 8.0).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn radial_spectrum(map: &HeightMap) -> Result<Vec<(f64, f64)>> {
    let (lattice, length) = (Lattice::new(map.cells(), map.size()), map.length());
    let longest = lattice.longest();
    // Longest waves in 2 pi / L.
    let rings = longest / length;
    let last = (lattice.limit() * rings * (1.0 + CUTOFF_SLACK)) as usize;
    // Count, sum of |q|, sum of |H|^2.
    let mut sums = vec![(0.0, 0.0, 0.0); last + 1];
    let unit = waves(map, &lattice, |square, power, copies, _| {
        let m = square.sqrt() * rings;
        if let Some(sum) = sums.get_mut(m.round() as usize) {
            *sum = (sum.0 + copies, sum.1 + copies * m, sum.2 + copies * power);
        }
    })?;
    let point = |&(count, m, power): &(f64, f64, f64)| {
        (TAU / longest * (m / count), ((power / count).sqrt() * unit * length / TAU).powi(2))
    };
    Ok(sums.iter().skip(1).filter(|(count, ..)| *count > 0.0).map(point).collect())
}

/// Spectrum of a line: pairs (q, C_1D) in units of 1/length and length^3, for the waves m = 1, 2, ..., n/2.
///
/// `C_1D(q) = (L_1D / 2 pi) |H(q)|^2`, two-sided: `integral of C_1D over q of both signs = rms^2`, so that
/// `C_1D = pi |q| C_2D` (Eq. 17) keeps the variance. The mean height is left out. Cost O(n log n).
///
/// ```
/// // cos(2 pi x) on 4 elements: |H| = 1/2 for m = 1.
/// let line = contact_model::Line::new(1.0, vec![1.0, 0.0, -1.0, 0.0])?;
/// let spectrum = surface_gen::line_spectrum(&line);
/// assert!((spectrum[0].1 - 0.25 / std::f64::consts::TAU).abs() < 1e-15 && spectrum[1].1 < 1e-30);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn line_spectrum(line: &Line) -> Vec<(f64, f64)> {
    let (middle, unit) = middle_and_half_width(range(line.heights()));
    let (length, elements) = (line.length(), line.elements());
    let transformed = ForwardTransform::new(elements, 1).of(|_, row| {
        for (x, h) in row.iter_mut().zip(line.heights()) {
            *x = (h - middle) / unit / elements as f64;
        }
    });
    let waves = transformed.iter().enumerate().skip(1);
    let density = |h: &Complex64| (h.norm() * unit * (length / TAU).sqrt()).powi(2);
    waves.map(|(m, h)| (TAU / length * m as f64, density(h))).collect()
}
