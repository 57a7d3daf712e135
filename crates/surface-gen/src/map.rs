//! Self-affine maps (Eqs. 2-5).

use crate::memory;
use crate::phases::{Stream, Turns};
use crate::spectrum::MapSpectrum;
use crate::turn::Circle;
use contact_model::{Cells, HeightMap, Interrupted, Result, SelfAffine, Size, Stop, never};
use numerics::fourier::{Complex64, InverseTransform};
use std::fmt;
use std::sync::Arc;

/// A generator of self-affine maps of one size, with its normalised amplitudes and the plans of its
/// transforms.
///
/// Cheap to clone and shared between threads; [`MapGenerator::map`] draws as many surfaces as are wanted.
#[derive(Clone)]
pub struct MapGenerator {
    cells: Cells,
    size: Size,
    spectrum: MapSpectrum,
    /// `m / (2 N)` turns in units of 2^-64 along x and y: moves the samples from the cells' corners to their
    /// centres.
    shifts: [Arc<[u64]>; 2],
    transform: InverseTransform,
}

impl fmt::Debug for MapGenerator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MapGenerator")
            .field("cells", &self.cells)
            .field("size", &self.size)
            .field("spectrum", &self.spectrum)
            .finish_non_exhaustive()
    }
}

impl MapGenerator {
    /// Plans maps of these cells: one number for equal columns and rows, or `[columns, rows]`.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for parameters that make no sense, for 0 or more than 2^17 columns or
    /// rows, for cells whose sides differ by more than 1e4, and where no wave remains: fewer than 3 columns
    /// and 3 rows, and a `short_cutoff` below the wavenumber of the longest wave.
    pub fn new(surface: &SelfAffine, cells: impl Into<Cells>) -> Result<Self> {
        let cells = cells.into();
        let spectrum = MapSpectrum::new(surface, cells)?;
        let Cells { columns, rows } = cells;
        Ok(Self {
            cells,
            size: surface.size,
            spectrum,
            shifts: [columns, rows]
                .map(|n| (0..=(n / 2) as u128).map(|m| ((m << 63) / n as u128) as u64).collect()),
            transform: InverseTransform::new(columns, rows),
        })
    }

    /// The rms height that every surface of this generator has, from the amplitudes alone: `sqrt(sum B^2)`.
    ///
    /// Cost O(columns rows), without any transform.
    pub fn rms_height(&self) -> f64 {
        self.spectrum.moment(0).sqrt()
    }

    /// The rms slope that every surface of this generator has, from the amplitudes alone: `sqrt(sum q^2
    /// B^2)`.
    ///
    /// Cost O(columns rows), without any transform.
    pub fn rms_slope(&self) -> f64 {
        std::f64::consts::TAU / self.size.length() * self.spectrum.moment(1).sqrt()
    }

    /// Draws the surface with this seed.
    ///
    /// The bits are the same for any number of threads. Cost O(N log N) for N cells, memory twice that of the
    /// map.
    ///
    /// # Errors
    /// [`contact_model::Error::OutOfMemory`] when the map does not fit in memory,
    /// [`contact_model::Error::Domain`] when its heights overflow.
    pub fn map(&self, seed: u64) -> Result<HeightMap> {
        self.map_until(seed, &never)
    }

    /// As [`MapGenerator::map`], unless the stop ends it, which is asked between the rows of the transform.
    ///
    /// # Errors
    /// [`contact_model::Error::Stopped`] by the stop; as [`MapGenerator::map`].
    pub fn map_until(&self, seed: u64, stop: Stop<'_>) -> Result<HeightMap> {
        // Half of the waves, as complex numbers, beside the map.
        let waves = 16.0 * self.cells.rows as f64 * self.spectrum.columns() as f64;
        memory::check(self.cells, waves + self.cells.map_bytes())?;
        let fill = |mx: usize, column: &mut [Complex64]| self.fill_column(seed, mx as u64, column);
        let heights = self.transform.of_until(self.spectrum.columns(), fill, &|| stop.stops());
        HeightMap::new(self.cells, self.size, heights.ok_or_else(|| Interrupted.without_state())?)
    }

    /// Writes `B exp(i phi)` of all waves (mx, my); index my, negative ones from the end.
    fn fill_column(&self, seed: u64, mx: u64, column: &mut [Complex64]) {
        let circle = Circle::shared();
        let wave = |amplitude: f64, turn: u64| {
            let [cos, sin] = circle.cos_sin(turn);
            Complex64::new(amplitude * cos, amplitude * sin)
        };
        let mut turns = Turns::new(seed, Stream::Map, mx);
        let [shifts_x, shifts_y] = &self.shifts;
        let shift_x = shifts_x[mx as usize];
        for my in 0..=self.spectrum.reach(mx) {
            let (up, down) = (turns.next(), turns.next());
            if (mx, my) == (0, 0) {
                continue;
            }
            let amplitude = self.spectrum.amplitude(self.spectrum.square(mx, my));
            let shift_y = shifts_y[my as usize];
            let positive = wave(amplitude, up.wrapping_add(shift_x).wrapping_add(shift_y));
            column[my as usize] = positive;
            if my > 0 {
                column[self.cells.rows - my as usize] = if mx == 0 {
                    positive.conj()
                } else {
                    wave(amplitude, down.wrapping_add(shift_x).wrapping_sub(shift_y))
                };
            }
        }
    }
}

/// A self-affine map: `h(x) = sum over all q of B_2D(q) cos(q x + phi(q))`, `B_2D = (2 pi / L) sqrt(C_2D)`,
/// `L = sqrt(Lx Ly)`.
///
/// `cells` is a number for as many rows as columns, or `[columns, rows]`; cells need not be squares. Heights
/// are in the unit of the amplitude, sampled at the cells' centres. Wave vectors are `q = 2 pi (i/Lx, j/Ly)`;
/// roll-off, cut-off and exponent act on |q|, so the surface is isotropic on any rectangle. Amplitudes are
/// fixed, phases uniform functions of (seed, i, j) ([`crate::map_phase`]). Waves fill the circle `|q| <= pi /
/// max(dx, dy)` (or the shorter `short_cutoff`) except the Nyquist ones. An axis of 1 or 2 cells carries no
/// wave and does not limit the circle: a map of one row has waves along x alone. With
/// `Amplitude::RmsHeight(h)` the rms of the samples is h for every seed; the mean is 0.
///
/// # Errors
/// As [`MapGenerator::new`] and [`MapGenerator::map`]. Cost O(N log N) for N cells.
///
/// Source: Pohrt, Popov, Filippov 2012, Eqs. 2-5. Differs from the printed form by `phi(-q) = -phi(q)`
/// (printed: `phi(q) = phi(-q)`) and by being a sum over the grid's waves.
///
/// ```
/// let surface = contact_model::SelfAffine::new(2.4, 1.0, 0.5)?;
/// let map = surface_gen::self_affine_map(&surface, 33, 1)?;
/// let rms = surface_gen::rms_height(map.heights());
/// assert!((rms - 0.5).abs() < 1e-14);
/// // 4 x 1, on 64 x 16 square cells.
/// let surface = contact_model::SelfAffine::new(2.4, [4.0, 1.0], 0.5)?;
/// assert_eq!(surface_gen::self_affine_map(&surface, [64, 16], 1)?.rows(), 16);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn self_affine_map(surface: &SelfAffine, cells: impl Into<Cells>, seed: u64) -> Result<HeightMap> {
    MapGenerator::new(surface, cells)?.map(seed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{hurst_from_spectrum, map_phase, radial_spectrum, rms_height, rms_slope};
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use contact_model::{Amplitude, Error};
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    /// Rounding of a transform and of sums over up to 1e6 waves, relative to the rms.
    const ROUNDING: f64 = 1e-12;

    fn unit(fractal_dimension: f64) -> SelfAffine {
        SelfAffine::new(fractal_dimension, 1.0, 1.0).unwrap()
    }

    /// `C_2D` as the paper writes it, with the constant at q_0 = 2 pi / L.
    fn density(surface: &SelfAffine, constant: f64, q: f64) -> f64 {
        let q0 = TAU / surface.size.length();
        let floor = surface.roll_off.unwrap_or(0.0);
        constant * (q.max(floor) / q0.max(floor)).powf(-2.0 * (surface.hurst + 1.0))
    }

    /// The reference: Eq. 4 wave by wave, both half-planes, in the plain words of the formula.
    fn direct(surface: &SelfAffine, constant: f64, cells: Cells, seed: u64) -> Vec<f64> {
        let Cells { columns, rows } = cells;
        let [nx, ny] = [columns, rows].map(|n| i32::try_from(n).unwrap());
        let Size { x: lx, y: ly } = surface.size;
        let (dx, dy) = (lx / columns as f64, ly / rows as f64);
        // An axis of 1 or 2 cells carries no wave.
        let coarsest =
            [(nx, dx), (ny, dy)].iter().filter(|axis| axis.0 > 2).fold(0.0, |d: f64, axis| d.max(axis.1));
        let cutoff = surface.short_cutoff.unwrap_or(f64::INFINITY).min(PI / coarsest) * (1.0 + 1e-12);
        let mut heights = vec![0.0; columns * rows];
        for mx in -nx / 2..=nx / 2 {
            for my in -ny / 2..=ny / 2 {
                let (qx, qy) = (TAU / lx * f64::from(mx), TAU / ly * f64::from(my));
                let q = qx.hypot(qy);
                let nyquist = 2 * mx.abs() == nx || 2 * my.abs() == ny;
                if (mx, my) == (0, 0) || nyquist || q > cutoff {
                    continue;
                }
                let amplitude = TAU / (lx * ly).sqrt() * density(surface, constant, q).sqrt();
                let phase = map_phase(seed, mx, my);
                for (i, h) in heights.iter_mut().enumerate() {
                    let x = ((i % columns) as f64 + 0.5) * dx;
                    let y = ((i / columns) as f64 + 0.5) * dy;
                    *h += amplitude * (qx * x + qy * y + phase).cos();
                }
            }
        }
        heights
    }

    fn spectral(size: [f64; 2], hurst: f64, roll_off: Option<f64>, short_cutoff: Option<f64>) -> SelfAffine {
        SelfAffine { size: size.into(), hurst, amplitude: Amplitude::Spectrum(0.3), roll_off, short_cutoff }
    }

    fn check_against_the_sum(cells: Cells, surface: &SelfAffine) {
        let map = self_affine_map(surface, cells, 11).unwrap();
        let expected = direct(surface, 0.3, cells, 11);
        let rms = rms_height(&expected);
        assert_eq!((map.cells(), map.size()), (cells, surface.size));
        for (h, e) in map.heights().iter().zip(&expected) {
            assert_abs_diff_eq!(h, e, epsilon = ROUNDING * rms);
        }
        let generator = MapGenerator::new(surface, cells).unwrap();
        assert_relative_eq!(generator.rms_height(), rms, max_relative = ROUNDING);
        assert_relative_eq!(generator.rms_slope(), rms_slope(&map).unwrap(), max_relative = ROUNDING);
    }

    #[test]
    fn transform_is_the_sum_over_waves() {
        let q0 = PI; // 2 pi / 2
        for (cells, hurst, roll_off, short_cutoff) in [
            (3, 0.5, None, None),
            (4, 0.0, None, None),
            (7, 1.0, None, Some(2.0 * q0)),
            (16, 0.6, Some(2.5 * q0), None),
            (17, 0.2, Some(2.0 * q0), Some(6.1 * q0)),
            (24, 0.8, Some(100.0 * q0), None),
        ] {
            check_against_the_sum(cells.into(), &spectral([2.0, 2.0], hurst, roll_off, short_cutoff));
        }
    }

    #[test]
    fn transform_is_the_sum_over_waves_of_a_rectangle() {
        let q0 = PI; // 2 pi / sqrt(4 x 1)
        for (cells, size, roll_off, short_cutoff) in [
            ([24, 6], [4.0, 1.0], None, None),                      // square cells
            ([7, 20], [4.0, 1.0], None, None),                      // oblong ones
            ([20, 7], [1.0, 4.0], Some(2.5 * q0), None),            // roll-off
            ([25, 16], [1.0, 4.0], Some(0.3 * q0), Some(4.2 * q0)), // longest wave below q_0, cut-off
            ([32, 9], [2.0, 2.0], None, None),                      // oblong cells on a square
            ([1, 12], [2.0, 2.0], None, None),                      // waves along y alone
            ([13, 1], [4.0, 1.0], None, Some(3.1 * q0)),            // waves along x alone
            ([2, 11], [0.5, 8.0], None, None),
            ([30, 7], [10.0 / 3.0, 0.7], None, None), // sides that no f64 holds
        ] {
            check_against_the_sum(cells.into(), &spectral(size, 0.6, roll_off, short_cutoff));
        }
    }

    #[test]
    fn variance_is_the_integral_of_the_spectrum() {
        for fractal_dimension in [2.0, 2.5, 3.0] {
            let surface = SelfAffine { amplitude: Amplitude::Spectrum(1e-3), ..unit(fractal_dimension) };
            let map = self_affine_map(&surface, 40, 5).unwrap();
            let mut variance = 0.0;
            for mx in -19_i32..=19 {
                for my in -19_i32..=19 {
                    let m2 = mx * mx + my * my;
                    if m2 > 0 && m2 <= 400 {
                        variance += density(&surface, 1e-3, TAU * f64::from(m2).sqrt()) * TAU * TAU;
                    }
                }
            }
            assert_relative_eq!(rms_height(map.heights()).powi(2), variance, max_relative = ROUNDING);
        }
    }

    #[test]
    fn rms_is_exact_and_mean_is_zero() {
        for cells in [3, 4, 5, 31, 64, 97, 129] {
            for fractal_dimension in [2.0, 2.4, 3.0] {
                let surface = SelfAffine::new(fractal_dimension, 3.0, 0.02).unwrap();
                let map = self_affine_map(&surface, cells, 1).unwrap();
                assert_relative_eq!(rms_height(map.heights()), 0.02, max_relative = ROUNDING);
                let mean = map.heights().iter().sum::<f64>() / (cells * cells) as f64;
                assert_abs_diff_eq!(mean, 0.0, epsilon = 0.02 * ROUNDING);
            }
        }
    }

    /// Independent values for N = 2048 (circular cut-off, L = h = 1), printed with four digits.
    #[test]
    fn slopes_of_the_papers_grid() {
        let expected = [(2.0, 17.38), (2.2, 37.29), (2.4, 99.39), (2.6, 283.4), (2.8, 764.5), (3.0, 1679.0)];
        for (fractal_dimension, slope) in expected {
            let generator = MapGenerator::new(&unit(fractal_dimension), 2048).unwrap();
            assert_relative_eq!(generator.rms_slope(), slope, max_relative = 3e-4);
            assert_relative_eq!(generator.rms_height(), 1.0, max_relative = ROUNDING);
        }
    }

    #[test]
    fn amplitude_sums_are_what_is_measured() {
        for fractal_dimension in [2.0, 2.6, 3.0] {
            let generator = MapGenerator::new(&unit(fractal_dimension), 256).unwrap();
            let map = generator.map(2).unwrap();
            assert_relative_eq!(rms_height(map.heights()), generator.rms_height(), max_relative = ROUNDING);
            assert_relative_eq!(rms_slope(&map).unwrap(), generator.rms_slope(), max_relative = ROUNDING);
        }
    }

    #[test]
    fn the_hurst_exponent_comes_back() {
        /// What is left of the rings' finite width from ring 8 on.
        const RINGS: f64 = 0.01;
        for hurst in [0.0, 0.3, 0.8, 1.0] {
            let map = self_affine_map(&unit(3.0 - hurst), 256, 2).unwrap();
            let fitted =
                hurst_from_spectrum(&radial_spectrum(&map).unwrap(), 8.0 * TAU, 120.0 * TAU).unwrap();
            assert_abs_diff_eq!(fitted, hurst, epsilon = RINGS);
        }
    }

    #[test]
    fn the_field_is_not_point_symmetric() {
        let n = 64;
        let map = self_affine_map(&unit(2.4), n, 3).unwrap();
        // The origin of the waves is the corner: the printed phases would make h(-x) = h(x), index n - 1 - i.
        let mirrored: Vec<f64> = map.heights().iter().rev().copied().collect();
        let difference: Vec<f64> = map.heights().iter().zip(&mirrored).map(|(a, b)| a - b).collect();
        assert!(rms_height(&difference) > 0.5);
    }

    /// Amplitude of the wave (mx, my) about the corner of the square, `mean of h exp(-i q x)`.
    fn project(map: &HeightMap, mx: f64, my: f64) -> Complex64 {
        let n = map.columns();
        let sum: Complex64 = (0..n * n)
            .map(|i| {
                let x = ((i % n) as f64 + 0.5) / n as f64;
                let y = ((i / n) as f64 + 0.5) / n as f64;
                Complex64::from_polar(map.heights()[i], -TAU * (mx * x + my * y))
            })
            .sum();
        sum / (n * n) as f64
    }

    #[test]
    fn long_waves_are_the_same_at_every_resolution() {
        let fixed = SelfAffine { amplitude: Amplitude::Spectrum(1e-2), ..unit(2.4) };
        let [coarse, odd, fine] = [32, 33, 64].map(|n| self_affine_map(&fixed, n, 9).unwrap());
        let normed = self_affine_map(&unit(2.4), 64, 9).unwrap();
        let ratio = project(&normed, 1.0, 0.0).norm() / project(&fine, 1.0, 0.0).norm();
        for (mx, my) in [(1.0, 0.0), (0.0, 1.0), (2.0, -3.0), (-5.0, -7.0), (11.0, 11.0), (15.0, 0.0)] {
            let wave = project(&coarse, mx, my);
            assert!(wave.norm() > 1e-4);
            for other in [project(&odd, mx, my), project(&fine, mx, my), project(&normed, mx, my) / ratio] {
                assert_abs_diff_eq!(wave.re, other.re, epsilon = ROUNDING);
                assert_abs_diff_eq!(wave.im, other.im, epsilon = ROUNDING);
            }
        }
    }

    #[test]
    fn nyquist_waves_and_corners_are_empty() {
        let map = self_affine_map(&unit(3.0), 16, 4).unwrap();
        for (mx, my) in [(8.0, 0.0), (0.0, 8.0), (8.0, 3.0), (8.0, 8.0), (6.0, 6.0), (7.0, -4.0), (0.0, 0.0)]
        {
            assert_abs_diff_eq!(project(&map, mx, my).norm(), 0.0, epsilon = ROUNDING);
        }
        assert!(project(&map, 7.0, 3.0).norm() > 1e-3);
        // An odd grid keeps its last wave.
        assert!(project(&self_affine_map(&unit(3.0), 15, 4).unwrap(), 7.0, 0.0).norm() > 1e-3);
    }

    #[cfg(feature = "rayon")]
    #[test]
    fn threads_change_no_byte() {
        let generator = MapGenerator::new(&unit(2.2), 500).unwrap();
        let map = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| generator.map(6)).unwrap()
        };
        let alone = map(1);
        for threads in [2, 4] {
            assert!(
                alone.heights().iter().zip(map(threads).heights()).all(|(a, b)| a.to_bits() == b.to_bits())
            );
        }
    }

    #[test]
    fn what_cannot_be_made_is_named() {
        for cells in [0, 1, 2, MOST + 1, usize::MAX] {
            let e = self_affine_map(&unit(2.4), cells, 0).unwrap_err();
            assert!(matches!(e, Error::Domain { ref name, .. } if name == "cells"), "{e}");
        }
        let e = self_affine_map(&SelfAffine { short_cutoff: Some(6.0), ..unit(2.4) }, 64, 0).unwrap_err();
        assert!(e.to_string().starts_with("short_cutoff = 6: expected"), "{e}");
        for hurst in [-0.1, 1.1, f64::NAN] {
            assert!(self_affine_map(&SelfAffine { hurst, ..unit(2.4) }, 8, 0).is_err());
        }
        let huge = SelfAffine { amplitude: Amplitude::RmsHeight(1e308), ..unit(2.4) };
        assert!(self_affine_map(&huge, 8, 0).is_err());
        let steep = SelfAffine { size: 1e-300.into(), amplitude: Amplitude::Spectrum(1e300), ..unit(2.4) };
        assert!(self_affine_map(&steep, 8, 0).is_err());
    }

    const MOST: usize = crate::spectrum::MOST_CELLS;

    #[test]
    fn extreme_units_change_nothing() {
        let plain = self_affine_map(&unit(2.4), 16, 0).unwrap();
        for length in [1e-150, 1e150] {
            let surface = SelfAffine::new(2.4, length, length).unwrap();
            let map = self_affine_map(&surface, 16, 0).unwrap();
            for (a, b) in map.heights().iter().zip(plain.heights()) {
                assert_relative_eq!(a / length, b, max_relative = ROUNDING);
            }
            assert_relative_eq!(
                rms_slope(&map).unwrap(),
                rms_slope(&plain).unwrap(),
                max_relative = ROUNDING
            );
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn any_grid_any_hurst_exponent(
            cells in 3_usize..70,
            hurst in 0.0..=1.0_f64,
            seed: u64,
            roll_off in proptest::option::of(0.1..200.0_f64),
            cutoff in proptest::option::of(200.0..500.0_f64),
        ) {
            let surface = SelfAffine { hurst, roll_off, short_cutoff: cutoff, ..unit(2.0) };
            let generator = MapGenerator::new(&surface, cells).unwrap();
            let map = generator.map(seed).unwrap();
            assert_relative_eq!(rms_height(map.heights()), 1.0, max_relative = ROUNDING);
            assert_relative_eq!(rms_slope(&map).unwrap(), generator.rms_slope(), max_relative = ROUNDING);
            prop_assert!(map.heights() != self_affine_map(&surface, cells, seed ^ 1).unwrap().heights());
        }
    }
}
