//! Confidence bands of height differences, slopes and curvatures over distances.

use crate::chi_square::factors;
use crate::derivatives::ScaleDependence;
use crate::difference::HeightDifference;
use crate::taper::Taper;
use contact_model::{Boundary, Error, HeightMap, Result, Size};
use std::f64::consts::{PI, TAU};
use surface_gen::periodogram;

/// Rings of wavenumbers in a fundamental wavenumber: between two of them the phase over half a side changes
/// by less than 1/2.
const RINGS: f64 = 8.0;

/// Confidence bands of mean squares over distances, from the spectrum of the map itself.
///
/// A mean square over the distance r is a sum `sum_q w(q r) |H(q)|^2` over independent waves with
/// exponentially distributed squares, where heights are Gaussian. With
/// `n = 2 (2 (sum w |H|^2)^2/sum (w |H|^2)^2 - 1)` over the waves, each with its conjugate (Satterthwaite), n
/// times the mean square over the expected one is about chi-square distributed with n degrees of freedom.
/// Weights: `1 - J_0(q r)` for height differences in all directions, `1 - cos(q_x r)` for slopes along x,
/// `(1 - cos(q_x r/2))^2` for curvatures. Free maps are taken under Hann's window for the spectrum, and n is
/// multiplied by the share of pairs of points at r that lie inside of the map.
///
/// The bands assume Gaussian heights. They end at half of the shorter side of a free map, because such a map
/// has no information about waves much longer than itself.
///
/// ```
/// use contact_model::{Boundary, SelfAffine};
/// use surface_statistics::{Bins, DifferenceBands, DifferenceMap};
/// let surface = SelfAffine { roll_off: Some(60.0), ..SelfAffine::new(2.2, 1.0, 0.01)? };
/// let map = surface_gen::self_affine_map(&surface, 64, 1)?;
/// let found = DifferenceMap::new(&map, Boundary::Periodic).radial(&Bins::of_distances(&map, 10.0)?)?;
/// let bands = DifferenceBands::new(&map, Boundary::Periodic)?.of_differences(&found, 0.95)?;
/// let [low, high] = bands[3].unwrap();
/// assert!(low < found.half_square[3] && found.half_square[3] < high);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct DifferenceBands {
    free: bool,
    size: Size,
    /// By rings of |q|, then by waves along x and along y.
    waves: [Vec<Waves>; 3],
}

/// Waves of about one wavenumber.
#[derive(Debug, Clone, Copy, Default)]
struct Waves {
    wavenumber: f64,
    /// Sums of their variances and of the squares of these.
    sums: [f64; 2],
}

/// Pairs of points of a map at one distance.
#[derive(Debug, Clone, Copy)]
struct DistantPairs {
    distance: f64,
    /// Side of the map along which they lie, the shorter one for all directions.
    side: f64,
    /// Share of them that lies inside of a free map.
    inside: f64,
}

impl DifferenceBands {
    /// Computes the spectrum of a map. Cost O(N log N), memory about three times that of the map.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for undefined points, and for sides so short that wavenumbers are no
    /// finite numbers.
    pub fn new(map: &HeightMap, boundary: Boundary) -> Result<Self> {
        let free = boundary == Boundary::Free;
        let tapered = if free && map.undefined() == 0 { Some(Taper::Hann.over(map)?) } else { None };
        let (size, cells) = (map.size(), map.cells());
        let fundamental = TAU / size.x.max(size.y);
        let shortest = (size.x / cells.columns as f64).min(size.y / cells.rows as f64);
        if !(RINGS * TAU / shortest).is_finite() {
            let expected = "longer, so that wavenumbers are finite (choose other units)";
            return Err(Error::domain("side of a cell", shortest, expected));
        }
        let mut waves: [Vec<Waves>; 3] = std::array::from_fn(|_| Vec::new());
        periodogram(tapered.as_ref().unwrap_or(map), |wave| {
            let [mx, my] = wave.index;
            // Of a wave and its conjugate one counts, with the variance of both.
            let own = mx == 0 || 2 * mx.unsigned_abs() == cells.columns;
            if own && my < 0 {
                return;
            }
            let real = own && (my == 0 || 2 * my.unsigned_abs() == cells.rows);
            let variance = wave.variance * if real { 1.0 } else { 2.0 };
            let [qx, qy] = [TAU * mx as f64 / size.x, TAU * my.unsigned_abs() as f64 / size.y];
            let q = qx.hypot(qy);
            let places = [(q * RINGS / fundamental).round() as usize, mx.unsigned_abs(), my.unsigned_abs()];
            for ((group, place), wavenumber) in waves.iter_mut().zip(places).zip([q, qx, qy]) {
                if group.len() <= place {
                    group.resize(place + 1, Waves::default());
                }
                let found = &mut group[place];
                found.wavenumber = wavenumber;
                found.sums[0] += variance;
                found.sums[1] += variance * variance;
            }
        })?;
        Ok(Self { free, size, waves })
    }

    /// Limits of half the mean square height difference over each distance; `None` beyond half the shorter
    /// side of a free map.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for a level outside (0, 1).
    pub fn of_differences(&self, found: &HeightDifference, level: f64) -> Result<Vec<Option<[f64; 2]>>> {
        let Size { x, y } = self.size;
        // Over all directions, of rectangles of Lx - |rx| and Ly - |ry|.
        let inside = |r: f64| 1.0 - 2.0 / PI * r * (1.0 / x + 1.0 / y) + r * r / (PI * x * y);
        let limits = found.distance.iter().zip(&found.half_square).map(|(&r, a)| {
            let pairs = DistantPairs { distance: r, side: x.min(y), inside: inside(r) };
            let factors = self.factors(0, pairs, level, &|phase| 1.0 - libm::j0(phase))?;
            Ok(factors.map(|limits| limits.map(|factor| a * factor)))
        });
        limits.collect()
    }

    /// Limits of the rms slope over each distance along x (axis 0) or y; otherwise as
    /// [`DifferenceBands::of_differences`].
    ///
    /// # Errors
    /// As there.
    pub fn of_slopes(
        &self,
        found: &ScaleDependence,
        axis: usize,
        level: f64,
    ) -> Result<Vec<Option<[f64; 2]>>> {
        self.along(found, axis, level, &|phase| 1.0 - phase.cos())
    }

    /// Limits of the rms curvature over each distance, as [`DifferenceBands::of_slopes`].
    ///
    /// # Errors
    /// As there.
    pub fn of_curvatures(
        &self,
        found: &ScaleDependence,
        axis: usize,
        level: f64,
    ) -> Result<Vec<Option<[f64; 2]>>> {
        self.along(found, axis, level, &|phase| (1.0 - (0.5 * phase).cos()).powi(2))
    }

    fn along(
        &self,
        found: &ScaleDependence,
        axis: usize,
        level: f64,
        weight: &dyn Fn(f64) -> f64,
    ) -> Result<Vec<Option<[f64; 2]>>> {
        let (side, group) = if axis == 0 { (self.size.x, 1) } else { (self.size.y, 2) };
        let limits = found.distance.iter().zip(&found.rms).map(|(&r, rms)| {
            let pairs = DistantPairs { distance: r, side, inside: 1.0 - r / side };
            let factors = self.factors(group, pairs, level, weight)?;
            Ok(factors.map(|limits| limits.map(|factor| rms * factor.sqrt())))
        });
        limits.collect()
    }

    /// Limits of a mean square over one distance, relative to its value.
    fn factors(
        &self,
        group: usize,
        pairs: DistantPairs,
        level: f64,
        weight: &dyn Fn(f64) -> f64,
    ) -> Result<Option<[f64; 2]>> {
        if self.free && pairs.distance > 0.5 * pairs.side {
            return Ok(None);
        }
        let mut sums = [0.0; 2];
        for waves in &self.waves[group] {
            let w = weight(waves.wavenumber * pairs.distance);
            sums[0] += w * waves.sums[0];
            sums[1] += w * w * waves.sums[1];
        }
        if sums[1].is_nan() || sums[1] <= 0.0 {
            return Ok(None);
        }
        let share = if self.free { pairs.inside } else { 1.0 };
        let freedom = 2.0 * (2.0 * share * sums[0] / sums[1] * sums[0] - 1.0).max(1.0);
        factors(freedom, level).map(Some)
    }
}
