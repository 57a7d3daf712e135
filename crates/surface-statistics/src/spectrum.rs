//! Power spectral densities with confidence bands.

use crate::bins::Bins;
use crate::chi_square::factors;
use crate::taper::Taper;
use contact_model::{Cells, Error, HeightMap, Result};
use std::f64::consts::TAU;
use surface_gen::{defined_everywhere, hann_window, periodogram};

/// A spectrum with its degrees of freedom. The values of each index belong together; wavenumbers rise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PowerSpectrum {
    /// Mean wavenumber of the waves of a bin, in 1/length.
    pub wavenumber: Vec<f64>,
    /// Mean density of these waves, two-sided: length^4 for a map, length^3 for a profile.
    pub density: Vec<f64>,
    /// Degrees of freedom of that mean; see [`PowerSpectrum::band`].
    pub degrees_of_freedom: Vec<f64>,
}

impl PowerSpectrum {
    /// Limits between which the density of the surface lies with the probability `level`, bin by bin.
    ///
    /// `[n C/chi^2_high, n C/chi^2_low]` with the quantiles of the chi-square law for n degrees of freedom.
    /// The band assumes a constant density in each bin and Gaussian heights, whose waves are independent with
    /// exponentially distributed squares (two degrees of freedom for a wave and its conjugate). A window
    /// correlates neighbouring waves; the degrees of freedom are then those of a sum of correlated squares,
    /// fewer by a factor of up to (35/18)^2 = 3.8 for [`Taper::Hann`]. Surfaces with prescribed amplitudes,
    /// such as those of [`surface_gen::self_affine_map`], scatter less.
    ///
    /// # Errors
    /// [`Error::Domain`] for a level outside (0, 1).
    ///
    /// ```
    /// use surface_statistics::PowerSpectrum;
    /// let one = PowerSpectrum { wavenumber: vec![1.0], density: vec![1.0], degrees_of_freedom: vec![2.0] };
    /// // Exponential law: quantiles -2 ln(0.975) and -2 ln(0.025).
    /// let [low, high] = one.band(0.95)?[0];
    /// assert!((low - 1.0 / 3.688879).abs() < 1e-6 && (high - 1.0 / 0.025318).abs() < 1e-2);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn band(&self, level: f64) -> Result<Vec<[f64; 2]>> {
        let pairs = self.density.iter().zip(&self.degrees_of_freedom);
        pairs.map(|(c, &freedom)| Ok(factors(freedom, level)?.map(|factor| c * factor))).collect()
    }

    /// The spectrum along x, averaged over all rows, of a periodic map or under Hann's window along x.
    ///
    /// `C_1D(q) = Lx/(2 pi) mean |H(q)|^2`, `H = 1/columns sum h exp(-i q x)`, two-sided: the integral over q
    /// of both signs is the mean variance of the rows about their means, `C_1D = pi q C_2D` for a power law
    /// of an isotropic surface. One value for each of the waves 1, 2, ..., columns/2. Rows are correlated:
    /// their number of degrees of freedom is that of the waves (qx, qy) that make up the sum over qy, `2 (2
    /// (sum I)^2/sum I^2 - 1)` (Satterthwaite). Cost O(N log N).
    ///
    /// # Errors
    /// [`Error::Domain`] for undefined points, fewer than 3 columns, and numbers beyond the range of f64.
    pub fn along_x(map: &HeightMap, taper: Taper) -> Result<Self> {
        let columns = map.columns();
        if columns < 3 {
            return Err(Error::domain(
                "cells of a profile",
                columns as f64,
                "at least 3: fewer carry no wave",
            ));
        }
        let tapered = if taper == Taper::None { None } else { Some(rows_under_hann(map)?) };
        let map = tapered.as_ref().unwrap_or(map);
        // Sum of the variances and of their squares over qy.
        let mut sums = vec![[0.0; 2]; columns / 2 + 1];
        let unit = periodogram(map, |wave| {
            let sum = &mut sums[wave.index[0].unsigned_abs()];
            sum[0] += wave.variance;
            sum[1] += wave.variance * wave.variance;
        })?;
        let length = map.size().x;
        let mut spectrum = Self::default();
        for (m, [sum, square]) in sums.into_iter().enumerate().skip(1) {
            let independent = if square > 0.0 { (2.0 * sum * sum / square - 1.0).max(1.0) } else { 1.0 };
            // The Nyquist wave is real.
            let each = if 2 * m == columns { 1.0 } else { 2.0 };
            let density = (sum.sqrt() * unit * (length / TAU).sqrt()).powi(2);
            spectrum.push(TAU * m as f64 / length, density, each * independent)?;
        }
        Ok(spectrum)
    }

    /// The spectrum along y of the mean over all columns, as [`PowerSpectrum::along_x`].
    ///
    /// # Errors
    /// As [`PowerSpectrum::along_x`].
    pub fn along_y(map: &HeightMap, taper: Taper) -> Result<Self> {
        Self::along_x(&map.transposed(), taper)
    }

    /// The spectrum of the map averaged over rings of wave vectors; bins without waves are left out.
    ///
    /// `C_2D(q) = Lx Ly/(2 pi)^2 |H(q)|^2`, `H = 1/N sum h exp(-i q x)`, two-sided: the integral over the
    /// plane of q is the variance ([`surface_gen::radial_spectrum`] has the same convention). The program
    /// SurfaceTopography and Jacobs, Junge, Pastewka (Surf. Topogr. Metrol. Prop. 5, 013001 (2017)) have `(2
    /// pi)^2` times as much. Each wave of a bin counts the same. Cost O(N log N), memory about three times
    /// that of the map.
    ///
    /// # Errors
    /// [`Error::Domain`] for undefined points, bins without any wave, and numbers beyond the range of f64.
    ///
    /// ```
    /// use contact_model::SelfAffine;
    /// use surface_statistics::{Bins, PowerSpectrum, Taper};
    /// let map = surface_gen::self_affine_map(&SelfAffine::new(2.2, 1.0, 0.01)?, 64, 1)?;
    /// let spectrum = PowerSpectrum::radial(&map, Taper::None, &Bins::of_wavenumbers(&map, 10.0)?)?;
    /// // H = 0.8: C falls as q^-3.6.
    /// let (last, middle) = (spectrum.density.len() - 2, spectrum.density.len() / 2);
    /// let slope = (spectrum.density[last] / spectrum.density[middle]).ln()
    ///     / (spectrum.wavenumber[last] / spectrum.wavenumber[middle]).ln();
    /// assert!((slope + 3.6).abs() < 0.05);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn radial(map: &HeightMap, taper: Taper, bins: &Bins) -> Result<Self> {
        let tapered = if map.undefined() == 0 { taper.over(map)? } else { map.clone() };
        let (size, length) = (map.size(), map.length());
        let mut sums = vec![[0.0; 3]; bins.edges().len() - 1];
        let unit = periodogram(&tapered, |wave| {
            let [mx, my] = wave.index;
            let q = TAU * (mx as f64 / size.x).hypot(my as f64 / size.y);
            if let Some(bin) = bins.index(q) {
                let sum = &mut sums[bin];
                sum[0] += wave.copies;
                sum[1] += wave.copies * q;
                sum[2] += wave.copies * wave.variance;
            }
        })?;
        let pairs = correlated_pairs(map, taper, bins);
        let mut spectrum = Self::default();
        for ([count, q, variance], pairs) in sums.into_iter().zip(pairs).filter(|(sum, _)| sum[0] > 0.0) {
            let density = ((variance / count).sqrt() * unit * (length / TAU)).powi(2);
            // However wide the window's transform is, one wave is left.
            spectrum.push(q / count, density, (count * (count / pairs)).max(count.min(2.0)))?;
        }
        if spectrum.wavenumber.is_empty() {
            let last = bins.edges().last().copied().unwrap_or_default();
            return Err(Error::domain("last edge of bins", last, "bins that hold waves of the map"));
        }
        Ok(spectrum)
    }

    fn push(&mut self, wavenumber: f64, density: f64, degrees_of_freedom: f64) -> Result<()> {
        self.wavenumber.push(wavenumber);
        self.density.push(crate::relative::finite("power spectral density", density)?);
        self.degrees_of_freedom.push(degrees_of_freedom);
        Ok(())
    }
}

/// Sum of the squared correlations of all pairs of waves of each bin, each wave with itself among them.
fn correlated_pairs(map: &HeightMap, taper: Taper, bins: &Bins) -> Vec<f64> {
    let (Cells { columns, rows }, size) = (map.cells(), map.size());
    let [reach_x, reach_y] = [columns / 2, rows / 2];
    let width = reach_x + 1;
    // Bins of one quadrant; those of the others are the same.
    let mut quadrant = vec![None; width * (reach_y + 1)];
    for my in 0..=reach_y {
        for mx in 0..=reach_x {
            let q = TAU * (mx as f64 / size.x).hypot(my as f64 / size.y);
            quadrant[my * width + mx] = bins.index(q).filter(|_| (mx, my) != (0, 0));
        }
    }
    let bin = |mx: isize, my: isize| {
        let [x, y] = [mx.unsigned_abs(), my.unsigned_abs()];
        if x > reach_x || y > reach_y { None } else { quadrant[y * width + x] }
    };
    let correlations = taper.correlations(map.cells(), size);
    let mut sums = vec![0.0; bins.edges().len() - 1];
    for my in 0..=reach_y {
        for mx in 0..=reach_x {
            let Some(own) = quadrant[my * width + mx] else { continue };
            let copies = |m: usize, n: usize| if m == 0 || 2 * m == n { 1.0 } else { 2.0 };
            let weight = copies(mx, columns) * copies(my, rows);
            let near = correlations
                .iter()
                .filter(|([x, y], _)| bin(mx.cast_signed() + x, my.cast_signed() + y) == Some(own));
            sums[own] += weight * near.map(|(_, square)| square).sum::<f64>();
        }
    }
    sums
}

/// Rows about their means under Hann's window along x, scaled to keep their spectrum.
fn rows_under_hann(map: &HeightMap) -> Result<HeightMap> {
    defined_everywhere(map, "a spectrum")?;
    let window = hann_window(map.columns());
    let count = map.columns() as f64;
    let scale = (window.iter().map(|w| w * w).sum::<f64>() / count).sqrt().recip();
    let mut heights = Vec::with_capacity(map.heights().len());
    for row in map.heights().chunks_exact(map.columns()) {
        let mean: f64 = row.iter().map(|h| h / count).sum();
        heights.extend(row.iter().zip(&window).map(|(h, w)| (h - mean) * w * scale));
    }
    HeightMap::new(map.cells(), map.size(), heights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::SelfAffine;
    use surface_gen::{radial_spectrum, self_affine_map};

    #[test]
    fn integrals_are_variances_and_rings_those_of_surface_gen() {
        let map = self_affine_map(&SelfAffine::new(2.4, [2.0, 1.0], 0.3).unwrap(), [48, 32], 3).unwrap();
        let rows: f64 = {
            let of = |row: &[f64]| surface_gen::rms_height(row).powi(2);
            map.heights().chunks(48).map(of).sum::<f64>() / 32.0
        };
        let along = PowerSpectrum::along_x(&map, Taper::None).unwrap();
        // Both signs of q; the Nyquist wave (empty here) would count once.
        let sum: f64 = along.density.iter().map(|c| 2.0 * c * TAU / 2.0).sum();
        assert_relative_eq!(sum, rows, max_relative = 1e-12);
        let rings = radial_spectrum(&map).unwrap();
        let edges = (0..=rings.len()).map(|k| TAU / 2.0 * (k as f64 + 0.5)).collect();
        let mine = PowerSpectrum::radial(&map, Taper::None, &Bins::new(edges).unwrap()).unwrap();
        for (k, (q, c)) in rings.into_iter().enumerate() {
            assert_relative_eq!(mine.wavenumber[k], q, max_relative = 1e-12);
            assert_relative_eq!(mine.density[k], c, max_relative = 1e-12);
        }
    }

    #[test]
    fn a_profile_has_the_mean_spectrum_of_its_rows() {
        let height = |ix: usize, iy: usize| ((ix * ix * 3 + iy * 11 + ix * iy) % 13) as f64;
        for columns in [14, 15] {
            let map = HeightMap::from_fn([columns, 6], [2.8, 1.0], height).unwrap();
            let found = PowerSpectrum::along_x(&map, Taper::None).unwrap();
            let mut mean = vec![0.0; columns / 2];
            for row in map.heights().chunks(columns) {
                let line = contact_model::Line::new(2.8, row.to_vec()).unwrap();
                for (sum, (_, c)) in mean.iter_mut().zip(surface_gen::line_spectrum(&line)) {
                    *sum += c / 6.0;
                }
            }
            for (a, b) in found.density.iter().zip(mean) {
                assert_relative_eq!(*a, b, max_relative = 1e-10);
            }
            let across = PowerSpectrum::along_y(&map.transposed(), Taper::None).unwrap();
            assert_eq!(across, found);
        }
    }
}
