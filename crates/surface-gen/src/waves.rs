//! Maps with the given amplitude of every wave: artificial twins and anisotropic surfaces.

use crate::lattice::Lattice;
use crate::measure::{homogeneous, periodogram, rms_height};
use crate::memory;
use crate::phases::{Stream, Turns};
use crate::spectrum::{CUTOFF_SLACK, MapSpectrum};
use crate::turn::Circle;
use contact_model::{Amplitude, Cells, Error, HeightMap, Result, SelfAffine, Size};
use numerics::fourier::{Complex64, ForwardTransform, InverseTransform};
use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

/// Property of the spectrum that an artificial twin shares with its map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum TwinSpectrum {
    /// The amplitude of each wave, and with it the lay.
    #[default]
    EachWave,
    /// The mean variance of the waves of each ring of [`crate::radial_spectrum`]: an isotropic twin.
    Rings,
}

/// How much longer the waves of a surface are along its lay than across.
///
/// The spectrum is that of an isotropic surface at the wavenumber `sqrt(r q_along^2 + q_across^2/r)` with the
/// ratio r: wave vectors of equal density form an ellipse of the same area as the isotropic circle, r times
/// as long across the lay as along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropy {
    /// Ratio r > 0 of wavelengths along the lay to those across; 1 is isotropic.
    pub ratio: f64,
    /// Direction of the lay in degrees, from x towards y.
    pub lay: f64,
}

/// A generator of maps whose waves have given amplitudes and random phases.
///
/// The phases are those of [`crate::map_phase`]: a twin of a [`crate::self_affine_map`] that is drawn with
/// the seed of that map is that map again. Waves that are their own conjugates (Nyquist waves of even grids)
/// have a random sign. Cheap to clone and shared between threads.
#[derive(Clone)]
pub struct WaveGenerator {
    cells: Cells,
    size: Size,
    rms: f64,
    /// `|H|` of the waves of the half plane, with the indices of [`numerics::fourier`]; 0 for the mean.
    amplitudes: Arc<[f64]>,
    inverse: InverseTransform,
}

impl fmt::Debug for WaveGenerator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WaveGenerator")
            .field("cells", &self.cells)
            .field("size", &self.size)
            .finish_non_exhaustive()
    }
}

impl WaveGenerator {
    /// Plans artificial twins of a map: same sides and cells, same spectrum, other phases.
    ///
    /// The spectrum is that of the map where its opposite edges match ([`crate::MapStatistics::edge_step`] up
    /// to 1.5), elsewhere that under Hann's window ([`crate::windowed`]), scaled to the rms height of the
    /// map. A twin is periodic and its heights are about Gaussian, whatever those of the map are. Cost O(N
    /// log N).
    ///
    /// # Errors
    /// Those of [`crate::MapStatistics::new`].
    ///
    /// ```
    /// use contact_model::SelfAffine;
    /// use surface_gen::{TwinSpectrum, WaveGenerator, rms_slope, self_affine_map};
    /// let map = self_affine_map(&SelfAffine::new(2.2, 1.0, 0.01)?, 32, 1)?;
    /// let twin = WaveGenerator::twin(&map, TwinSpectrum::EachWave)?.map(2)?;
    /// assert!((rms_slope(&twin)? / rms_slope(&map)? - 1.0).abs() < 1e-12);
    /// assert_ne!(twin, map);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn twin(map: &HeightMap, like: TwinSpectrum) -> Result<Self> {
        memory::check_with_amplitudes(map.cells())?;
        let sample = homogeneous(map)?.map;
        let (cells, size) = (map.cells(), map.size());
        let (lattice, rows) = (Lattice::new(cells, size), cells.rows);
        let rings = lattice.longest() / size.length();
        let mut variances = vec![0.0; (cells.columns / 2 + 1) * rows];
        // Sum of variances and number of waves.
        let mut sums: Vec<[f64; 2]> = Vec::new();
        let mut ring_of = vec![0; variances.len()];
        periodogram(&sample, |wave| {
            let [mx, my] = wave.index;
            let at = index(cells, mx.unsigned_abs(), my);
            variances[at] = wave.variance;
            let square = lattice.square(mx.unsigned_abs() as u64, my.unsigned_abs() as u64);
            let ring = (square.sqrt() * rings).round() as usize;
            if sums.len() <= ring {
                sums.resize(ring + 1, [0.0; 2]);
            }
            ring_of[at] = ring;
            sums[ring] = [sums[ring][0] + wave.copies * wave.variance, sums[ring][1] + wave.copies];
        })?;
        if like == TwinSpectrum::Rings {
            for (variance, &ring) in variances.iter_mut().zip(&ring_of).skip(1) {
                *variance = sums[ring][0] / sums[ring][1].max(1.0);
            }
        }
        Self::of_variances(cells, size, variances, Some(rms_height(map.heights())))
    }

    /// Plans anisotropic self-affine maps: exponent, roll-off and `short_cutoff` act on the wavenumber of
    /// [`Anisotropy`], the limit of the grid on the wave vector itself, `|q| <= pi/max(dx, dy)`.
    ///
    /// A ratio of 1 gives the maps of [`crate::self_affine_map`]. With `Amplitude::Spectrum(c)`, c is the
    /// density at the wavenumber `2 pi/L`. Cost O(N).
    ///
    /// # Errors
    /// [`Error::Domain`] for a ratio that is no positive number, a lay that is not finite, and as
    /// [`crate::MapGenerator::new`].
    ///
    /// ```
    /// use contact_model::SelfAffine;
    /// use surface_gen::{Anisotropy, MapStatistics, WaveGenerator};
    /// let surface = SelfAffine::new(2.2, 1.0, 0.01)?;
    /// let grooved = WaveGenerator::anisotropic(&surface, Anisotropy { ratio: 4.0, lay: 30.0 }, 64)?;
    /// let map = grooved.map(1)?;
    /// assert!((surface_gen::rms_height(map.heights()) / 0.01 - 1.0).abs() < 1e-12);
    /// assert!(MapStatistics::new(&map)?.isotropy < 0.5);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn anisotropic(
        surface: &SelfAffine,
        anisotropy: Anisotropy,
        cells: impl Into<Cells>,
    ) -> Result<Self> {
        let (cells, size) = (cells.into(), surface.size);
        let Anisotropy { ratio, lay } = anisotropy;
        if !(ratio.is_normal() && ratio > 0.0 && ratio.recip().is_normal()) {
            return Err(Error::domain("ratio of an anisotropy", ratio, "a finite number > 0"));
        }
        if !lay.is_finite() {
            return Err(Error::domain("lay of an anisotropy", lay, "a finite number of degrees"));
        }
        let spectrum = MapSpectrum::new(surface, cells)?;
        memory::check_with_amplitudes(cells)?;
        let lattice = Lattice::new(cells, size);
        // As the phases, so that no library's sine decides.
        let [cos, sin] = Circle::shared().cos_sin((lay.rem_euclid(180.0) / 360.0 * 2f64.powi(64)) as u64);
        let unit = [size.length() / size.x, size.length() / size.y];
        let grid = lattice.limit().powi(2) * (1.0 + CUTOFF_SLACK);
        let cut_off = surface
            .short_cutoff
            .map_or(f64::INFINITY, |q| (q / TAU * size.length() * (1.0 + CUTOFF_SLACK)).powi(2));
        let Cells { columns, rows } = cells;
        let mut variances = vec![0.0; (columns / 2 + 1) * rows];
        for mx in 0..columns.div_ceil(2) {
            let last = (rows.cast_signed() - 1) / 2;
            for my in -last..=last {
                let (x, y) = (mx as f64 * unit[0], my as f64 * unit[1]);
                let (along, across) = (x * cos + y * sin, y * cos - x * sin);
                let square = ratio * along * along + across * across / ratio;
                let inside = lattice.square(mx as u64, my.unsigned_abs() as u64) <= grid;
                if (mx, my) != (0, 0) && inside && square <= cut_off {
                    variances[index(cells, mx, my)] = spectrum.amplitude(square).powi(2);
                }
            }
        }
        let rms = match surface.amplitude {
            Amplitude::RmsHeight(h) => Some(h),
            Amplitude::Spectrum(_) => None,
        };
        if variances.iter().all(|v| *v <= 0.0) {
            let q = surface.short_cutoff.unwrap_or(0.0);
            return Err(Error::domain(
                "short_cutoff",
                q,
                "at least that of the longest wave, or none remain",
            ));
        }
        Self::of_variances(cells, size, variances, rms)
    }

    fn of_variances(cells: Cells, size: Size, variances: Vec<f64>, rms: Option<f64>) -> Result<Self> {
        let mut amplitudes: Vec<f64> = variances.into_iter().map(f64::sqrt).collect();
        let found = total(cells, &amplitudes).sqrt();
        let rms = rms.unwrap_or(found);
        let scale = rms / found;
        if !(scale.is_normal() && rms.is_normal()) {
            return Err(Error::not_representable("rms height of the spectrum", rms));
        }
        for amplitude in &mut amplitudes {
            *amplitude *= scale;
        }
        let inverse = InverseTransform::new(cells.columns, cells.rows);
        Ok(Self { cells, size, rms, amplitudes: amplitudes.into(), inverse })
    }

    /// Numbers of columns and rows of its maps.
    pub fn cells(&self) -> Cells {
        self.cells
    }

    /// The rms height that every map of this generator has, from the amplitudes alone.
    pub fn rms_height(&self) -> f64 {
        self.rms
    }

    /// `|H|` of the waves of the half plane, with the indices of [`numerics::fourier`].
    pub(crate) fn amplitudes(&self) -> &[f64] {
        &self.amplitudes
    }

    /// Transforms from heights to waves, and back.
    pub(crate) fn transforms(&self) -> (ForwardTransform, &InverseTransform) {
        (ForwardTransform::new(self.cells.columns, self.cells.rows), &self.inverse)
    }

    /// Draws the map with this seed. It is the same on any number of threads, and on every machine up to the
    /// rounding of its transforms.
    ///
    /// Cost O(N log N) for N cells, memory three times that of the map.
    ///
    /// # Errors
    /// [`Error::Domain`] when the heights overflow.
    pub fn map(&self, seed: u64) -> Result<HeightMap> {
        HeightMap::new(self.cells, self.size, self.heights(seed))
    }

    pub(crate) fn heights(&self, seed: u64) -> Vec<f64> {
        let Cells { columns, rows } = self.cells;
        let circle = Circle::shared();
        // Half a cell in turns of 2^-64: phases count from the corner, heights are those at the cells'
        // centres.
        let half_cell = |m: usize, n: usize| (((m as u128) << 63) / n as u128) as u64;
        self.inverse.of(columns / 2 + 1, |mx, column| {
            let amplitudes = &self.amplitudes[mx * rows..(mx + 1) * rows];
            let own_conjugate_x = mx == 0 || 2 * mx == columns;
            let shift_x = half_cell(mx, columns);
            let mut turns = Turns::new(seed, Stream::Map, mx as u64);
            for my in 0..=rows / 2 {
                let (up, down) = (turns.next(), turns.next());
                let shift_y = half_cell(my, rows);
                let wave = |my: usize, turn: u64| {
                    let [cos, sin] = circle.cos_sin(turn);
                    Complex64::new(cos, sin) * amplitudes[my]
                };
                // Of the wave (mx, -my).
                let opposite = (rows - my) % rows;
                column[my] = wave(my, up.wrapping_add(shift_x).wrapping_add(shift_y));
                let own_conjugate_y = my == 0 || 2 * my == rows;
                if own_conjugate_x && own_conjugate_y {
                    // Half of all turns have a positive sine.
                    let sign = if up >> 63 == 0 { 1.0 } else { -1.0 };
                    column[my] = Complex64::new(sign * amplitudes[my], 0.0);
                } else if own_conjugate_x {
                    column[opposite] = column[my].conj();
                } else if !own_conjugate_y {
                    column[opposite] = wave(opposite, down.wrapping_add(shift_x).wrapping_sub(shift_y));
                }
            }
            if mx == 0 {
                column[0] = Complex64::new(0.0, 0.0);
            }
        })
    }
}

/// Index of a wave in the half plane.
fn index(cells: Cells, mx: usize, my: isize) -> usize {
    mx * cells.rows + my.rem_euclid(cells.rows.cast_signed()).cast_unsigned()
}

/// Variance of all waves of the plane.
fn total(cells: Cells, amplitudes: &[f64]) -> f64 {
    let copies = |mx: usize| if mx == 0 || 2 * mx == cells.columns { 1.0 } else { 2.0 };
    let columns = amplitudes.chunks_exact(cells.rows).enumerate();
    columns.map(|(mx, column)| copies(mx) * column.iter().map(|a| a * a).sum::<f64>()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{radial_spectrum, self_affine_map};
    use approx::assert_relative_eq;

    /// Rounding of transforms, relative to the rms height.
    const ROUNDING: f64 = 1e-12;

    fn same(a: &HeightMap, b: &HeightMap) {
        let rms = rms_height(a.heights());
        assert_eq!((a.cells(), a.size()), (b.cells(), b.size()));
        for (a, b) in a.heights().iter().zip(b.heights()) {
            assert!((a - b).abs() < ROUNDING * rms, "{a} {b}");
        }
    }

    fn maps() -> Vec<(SelfAffine, [usize; 2])> {
        let surface =
            |size: [f64; 2]| SelfAffine { roll_off: Some(12.0), ..SelfAffine::new(2.3, size, 0.2).unwrap() };
        vec![
            (surface([1.0, 1.0]), [24, 24]),
            (surface([2.0, 1.0]), [31, 16]),
            (surface([1.0, 3.0]), [16, 27]),
        ]
    }

    #[test]
    fn a_twin_with_the_seed_of_its_map_is_the_map() {
        for (surface, cells) in maps() {
            let map = self_affine_map(&surface, cells, 9).unwrap();
            let twins = WaveGenerator::twin(&map, TwinSpectrum::EachWave).unwrap();
            same(&map, &twins.map(9).unwrap());
            assert_relative_eq!(twins.rms_height(), 0.2, max_relative = ROUNDING);
        }
    }

    #[test]
    fn an_isotropic_anisotropy_is_none() {
        for (surface, cells) in maps() {
            for amplitude in [Amplitude::RmsHeight(0.3), Amplitude::Spectrum(1e-4)] {
                let surface = SelfAffine { amplitude, short_cutoff: Some(40.0), ..surface };
                let none = Anisotropy { ratio: 1.0, lay: 77.0 };
                let map = WaveGenerator::anisotropic(&surface, none, cells).unwrap().map(3).unwrap();
                same(&self_affine_map(&surface, cells, 3).unwrap(), &map);
            }
        }
    }

    #[test]
    fn twins_have_the_spectrum_and_the_rms_height() {
        let height = |ix: usize, iy: usize| ((ix * ix * 7 + iy * 31 + ix * iy) % 17) as f64 + 5.0;
        for cells in [[16, 16], [15, 18], [20, 9], [12, 1]] {
            let map = HeightMap::from_fn(cells, [2.0, 1.0], height).unwrap();
            let periodic = !crate::MapStatistics::new(&map).unwrap().windowed;
            for like in [TwinSpectrum::EachWave, TwinSpectrum::Rings] {
                let twin = WaveGenerator::twin(&map, like).unwrap().map(4).unwrap();
                let rms = rms_height(map.heights());
                assert_relative_eq!(rms_height(twin.heights()), rms, max_relative = ROUNDING);
                let mean = twin.heights().iter().sum::<f64>() / twin.heights().len() as f64;
                assert!(mean.abs() < ROUNDING * rms);
                if periodic {
                    for (a, b) in radial_spectrum(&map).unwrap().iter().zip(radial_spectrum(&twin).unwrap()) {
                        assert_relative_eq!(a.1, b.1, max_relative = 1e-10, epsilon = 1e-20);
                    }
                }
            }
        }
    }

    #[test]
    fn the_slopes_are_steepest_across_the_lay() {
        for lay in [0.0, 30.0, 90.0, 135.0] {
            let surface = SelfAffine { roll_off: Some(25.0), ..SelfAffine::new(2.2, 1.0, 0.1).unwrap() };
            let anisotropy = Anisotropy { ratio: 3.0, lay };
            let map = WaveGenerator::anisotropic(&surface, anisotropy, 96).unwrap().map(1).unwrap();
            let [mut xx, mut xy, mut yy] = [0.0; 3];
            periodogram(&map, |wave| {
                let [x, y] = wave.index.map(|m| m as f64);
                let weight = wave.copies * wave.variance;
                (xx, xy, yy) = (xx + weight * x * x, xy + weight * x * y, yy + weight * y * y);
            })
            .unwrap();
            let steepest = 0.5 * (2.0 * xy).atan2(xx - yy).to_degrees();
            let off = (steepest - (lay + 90.0)).rem_euclid(180.0);
            assert!(off.min(180.0 - off) < 3.0, "{lay}: {steepest}");
        }
    }

    #[test]
    fn small_maps_and_extreme_heights_are_finite_or_refused() {
        for cells in [[1, 1], [2, 1], [1, 3], [2, 2], [3, 2], [16, 1], [5, 4]] {
            for unit in [1e-150, 1e-300, 1.0, 1e300] {
                let map = HeightMap::from_fn(cells, [2.0, 1.0], |ix, iy| (ix * 5 + iy * 3 % 4) as f64 * unit);
                for like in [TwinSpectrum::EachWave, TwinSpectrum::Rings] {
                    let Ok(waves) = WaveGenerator::twin(map.as_ref().unwrap(), like) else { continue };
                    let rms = rms_height(waves.map(1).unwrap().heights());
                    assert_relative_eq!(
                        rms,
                        rms_height(map.as_ref().unwrap().heights()),
                        max_relative = 1e-9
                    );
                    assert_relative_eq!(rms, waves.rms_height(), max_relative = 1e-9);
                }
            }
            let surface = SelfAffine::new(2.2, [2.0, 1.0], 0.1).unwrap();
            let plain = self_affine_map(&surface, cells, 1);
            let grooved = WaveGenerator::anisotropic(&surface, Anisotropy { ratio: 2.0, lay: 10.0 }, cells);
            assert_eq!(plain.is_ok(), grooved.is_ok(), "{cells:?}");
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        let surface = SelfAffine::new(2.2, 1.0, 0.1).unwrap();
        for (ratio, lay, message) in [
            (0.0, 0.0, "ratio of an anisotropy = 0: expected a finite number > 0"),
            (f64::NAN, 0.0, "ratio of an anisotropy = NaN: expected a finite number > 0"),
            (2.0, f64::INFINITY, "lay of an anisotropy = inf: expected a finite number of degrees"),
        ] {
            let error = WaveGenerator::anisotropic(&surface, Anisotropy { ratio, lay }, 16).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
        let flat = HeightMap::new(4, 1.0, vec![1.0; 16]).unwrap();
        assert!(WaveGenerator::twin(&flat, TwinSpectrum::EachWave).is_err());
    }
}
