//! Slopes and curvatures from differences, at one cell and over distances.

use crate::relative::{Relative, finite};
use contact_model::{Boundary, Cells, Error, HeightMap, Result};
use surface_gen::MapStatistics;

/// Root mean squares of derivatives by differences of neighbouring points.
///
/// Only points with all of the needed heights count; with [`Boundary::Periodic`] neighbours lie across the
/// edges too. Differences damp the shortest waves: the slope of a wave q along x by the factor `sin(q
/// dx/2)/(q dx/2)`, its curvature by the square of that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derivatives {
    /// `sqrt(mean (dh/dx)^2 + (dh/dy)^2)` from forward differences, over the points that have a neighbour
    /// along x and one along y; dimensionless. [`surface_gen::rms_slope_differences`] averages each direction
    /// over all of its own pairs.
    pub rms_gradient: f64,
    /// Root mean square of the forward differences along x and along y over the same points; dimensionless.
    pub rms_slope: [f64; 2],
    /// Root mean square of half the Laplacian, the mean curvature of a flat surface, from second differences
    /// along both axes, in 1/length.
    pub rms_curvature: f64,
    /// Root mean square of the second differences along x and along y over the same points, in 1/length.
    pub rms_second_derivative: [f64; 2],
}

impl Derivatives {
    /// Measures a map. Cost O(N).
    ///
    /// # Errors
    /// [`Error::Domain`] where no point has the neighbours (3 columns and 3 rows are needed), and for numbers
    /// beyond the range of f64.
    ///
    /// ```
    /// use contact_model::{Boundary, HeightMap};
    /// // h = x^2/2 + y on cells of 1: second derivative 1 along x, half the Laplacian 1/2.
    /// let map = HeightMap::from_fn(4, 4.0, |ix, iy| 0.5 * (ix * ix) as f64 + iy as f64)?;
    /// let found = surface_statistics::Derivatives::new(&map, Boundary::Free)?;
    /// assert!((found.rms_curvature - 0.5).abs() < 1e-12 && (found.rms_slope[1] - 1.0).abs() < 1e-12);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(map: &HeightMap, boundary: Boundary) -> Result<Self> {
        let Relative { heights, unit } = Relative::new(map);
        let Cells { columns, rows } = map.cells();
        let [dx, dy] = [map.dx(), map.dy()];
        let periodic = boundary == Boundary::Periodic;
        let at = |ix: usize, iy: usize| heights[(iy % rows) * columns + ix % columns];
        let last = |count: usize, reach: usize| if periodic { count } else { count.saturating_sub(reach) };
        let mut slopes = [0.0; 3];
        for iy in 0..last(rows, 1) {
            for ix in 0..last(columns, 1) {
                let h = at(ix, iy);
                let (x, y) = (at(ix + 1, iy) - h, at(ix, iy + 1) - h);
                if (x + y).is_finite() {
                    add(&mut slopes, [x * x, y * y, 1.0]);
                }
            }
        }
        // Curvatures in units of 1/(dx dy).
        let (to_x, to_y) = (dy / dx, dx / dy);
        let mut curvatures = [0.0; 4];
        for iy in 0..last(rows, 2) {
            for ix in 0..last(columns, 2) {
                let h = 2.0 * at(ix + 1, iy + 1);
                let x = (at(ix, iy + 1) + at(ix + 2, iy + 1) - h) * to_x;
                let y = (at(ix + 1, iy) + at(ix + 1, iy + 2) - h) * to_y;
                if (x + y).is_finite() {
                    add(&mut curvatures, [x * x, y * y, (0.5 * (x + y)).powi(2), 1.0]);
                }
            }
        }
        if slopes[2] < 1.0 || curvatures[3] < 1.0 {
            let expected = "at least 1: derivatives need three columns and three rows of defined points";
            return Err(Error::domain("points with all neighbours", curvatures[3].min(slopes[2]), expected));
        }
        let rms = |sum: f64, count: f64| (sum / count).sqrt() * unit;
        let rms_slope = [rms(slopes[0], slopes[2]) / dx, rms(slopes[1], slopes[2]) / dy];
        let curvature = |k: usize| rms(curvatures[k], curvatures[3]) / dx / dy;
        Ok(Self {
            rms_gradient: finite("rms gradient", rms_slope[0].hypot(rms_slope[1]))?,
            rms_slope,
            rms_curvature: finite("rms curvature", curvature(2))?,
            rms_second_derivative: [
                finite("rms curvature along x", curvature(0))?,
                finite("rms curvature along y", curvature(1))?,
            ],
        })
    }
}

fn add<const N: usize>(sums: &mut [f64; N], terms: [f64; N]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += term;
    }
}

/// Nayak's parameter `alpha = m0 m4/m2^2` of the profile moments of the spectrum; at least 3/2 for a random
/// isotropic surface.
///
/// Source: Nayak, J. Lubr. Technol. 93, 398 (1971). Dimensionless; the moments are those of
/// [`MapStatistics::profile_moments`], under Hann's window where the map is not periodic. It depends on the
/// shortest and longest waves of the map.
///
/// ```
/// use contact_model::SelfAffine;
/// let map = surface_gen::self_affine_map(&SelfAffine::new(2.2, 1.0, 0.01)?, 64, 1)?;
/// assert!(surface_statistics::nayak_parameter(&surface_gen::MapStatistics::new(&map)?) > 1.5);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn nayak_parameter(statistics: &MapStatistics) -> f64 {
    let [m0, m2, m4] = statistics.profile_moments();
    m0 / m2 * (m4 / m2)
}

/// Root mean squares over distances; the values of each index belong together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ScaleDependence {
    /// Length of the stencil.
    pub distance: Vec<f64>,
    /// Root mean square of the difference quotient.
    pub rms: Vec<f64>,
    /// Number of points in each average.
    pub points: Vec<usize>,
}

impl ScaleDependence {
    /// Slope along x over the distance r, `rms [h(x + r) - h(x)]/r`, dimensionless, for r of 1, 2, 3, 4, 6,
    /// 8, ... cells.
    ///
    /// Points with undefined neighbours are left out. The list ends at the longest distance between two
    /// points of a free map, or at half of the side of a periodic one. Cost O(N) for each distance. Source:
    /// Sanner, Noehring, Thimons, Jacobs, Pastewka, Appl. Surf. Sci. Adv. 7, 100190 (2022), Eqs. 7 and 14.
    ///
    /// # Errors
    /// [`Error::Domain`] for fewer than 2 columns and numbers beyond the range of f64.
    pub fn slope_along_x(map: &HeightMap, boundary: Boundary) -> Result<Self> {
        Self::of_order(map, boundary, 1)
    }

    /// Curvature along x over the distance r, `rms [h(x + r/2) - 2 h(x) + h(x - r/2)]/(r/2)^2` in 1/length,
    /// for r of 2, 4, 6, 8, 12, ... cells: r is the length of all of the stencil, as in the source.
    ///
    /// Otherwise as [`ScaleDependence::slope_along_x`]; source Eqs. 7 and 16.
    ///
    /// # Errors
    /// [`Error::Domain`] for fewer than 3 columns and numbers beyond the range of f64.
    pub fn curvature_along_x(map: &HeightMap, boundary: Boundary) -> Result<Self> {
        Self::of_order(map, boundary, 2)
    }

    /// As [`ScaleDependence::slope_along_x`], along y.
    ///
    /// # Errors
    /// As there, for rows.
    pub fn slope_along_y(map: &HeightMap, boundary: Boundary) -> Result<Self> {
        Self::of_order(&map.transposed(), boundary, 1)
    }

    /// As [`ScaleDependence::curvature_along_x`], along y.
    ///
    /// # Errors
    /// As there, for rows.
    pub fn curvature_along_y(map: &HeightMap, boundary: Boundary) -> Result<Self> {
        Self::of_order(&map.transposed(), boundary, 2)
    }

    fn of_order(map: &HeightMap, boundary: Boundary, order: usize) -> Result<Self> {
        let columns = map.columns();
        if columns <= order {
            return Err(Error::domain(
                "cells along the axis",
                columns as f64,
                format!("at least {}", order + 1),
            ));
        }
        let Relative { heights, unit } = Relative::new(map);
        let periodic = boundary == Boundary::Periodic;
        let last = if periodic { (columns / 2 / order).max(1) } else { (columns - 1) / order };
        let mut found = Self::default();
        for cells in steps(last) {
            let (mut sum, mut points) = (0.0, 0);
            for row in heights.chunks_exact(columns) {
                let starts = if periodic { columns } else { columns - order * cells };
                for i in 0..starts {
                    let at = |k: usize| row[(i + k * cells) % columns];
                    let difference = if order == 1 { at(1) - at(0) } else { at(0) - 2.0 * at(1) + at(2) };
                    if difference.is_finite() {
                        sum += difference * difference;
                        points += 1;
                    }
                }
            }
            if points > 0 {
                let spacing = cells as f64 * map.dx();
                let rms = (sum / points as f64).sqrt() * unit / spacing;
                let rms = if order == 1 { rms } else { rms / spacing };
                found.distance.push(order as f64 * spacing);
                found.rms.push(finite("rms over a distance", rms)?);
                found.points.push(points);
            }
        }
        Ok(found)
    }
}

/// 1, 2, 3, 4, 6, 8, 12, ... up to `last`.
fn steps(last: usize) -> impl Iterator<Item = usize> {
    let octaves = (1..usize::BITS - 1).flat_map(|k| [1_usize << k, (1 << k) + (1 << (k - 1))]);
    std::iter::once(1).chain(octaves).take_while(move |&cells| cells <= last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::difference::DifferenceMap;
    use approx::assert_relative_eq;

    fn map() -> HeightMap {
        HeightMap::from_fn([17, 12], [3.4, 1.2], |ix, iy| ((ix * 31 + iy * iy * 17) % 23) as f64).unwrap()
    }

    #[test]
    fn steps_are_powers_of_two_and_between() {
        assert_eq!(steps(13).collect::<Vec<_>>(), [1, 2, 3, 4, 6, 8, 12]);
    }

    #[test]
    fn scale_dependent_slope_is_that_of_the_structure_function() {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let slope = ScaleDependence::slope_along_x(&map(), boundary).unwrap();
            let differences = DifferenceMap::new(&map(), boundary).along_x().unwrap();
            let wanted = differences.slope();
            for (k, r) in slope.distance.iter().enumerate() {
                let at = differences.distance.iter().position(|d| (d - r).abs() < 1e-9).unwrap();
                assert_relative_eq!(slope.rms[k], wanted[at], max_relative = 1e-10);
            }
            let derivatives = Derivatives::new(&map(), boundary).unwrap();
            if boundary == Boundary::Periodic {
                assert_relative_eq!(derivatives.rms_slope[0], slope.rms[0], max_relative = 1e-12);
                let curvature = ScaleDependence::curvature_along_x(&map(), boundary).unwrap();
                assert_relative_eq!(
                    derivatives.rms_second_derivative[0],
                    curvature.rms[0],
                    max_relative = 1e-12
                );
            }
        }
    }

    /// From SurfaceTopography 1.27.1, whose maps of two axes give the mean cell side in place of that along
    /// x, and leave out of free maps what has no neighbour along y either.
    #[test]
    fn slopes_and_curvatures_by_scale_are_those_of_an_independent_program() {
        let slopes = [
            55.133_527_751_749_54,
            26.245_914_714_783_435,
            8.978_308_403_396_056,
            14.158_374_158_904_305,
            6.162_514_058_458_376,
        ];
        let curvatures =
            [484.856_457_432_223_24, 110.497_565_628_406_1, 21.764_763_129_066_914, 32.649_425_534_687_38];
        let close = |found: &ScaleDependence, expected: &[f64]| {
            for (found, expected) in found.rms.iter().zip(expected) {
                assert_relative_eq!(*found, *expected, max_relative = 1e-10);
            }
        };
        let slope = ScaleDependence::slope_along_x(&map(), Boundary::Periodic).unwrap();
        close(&slope, &slopes);
        assert_relative_eq!(slope.distance[4], 1.2, max_relative = 1e-12);
        let curvature = ScaleDependence::curvature_along_x(&map(), Boundary::Periodic).unwrap();
        close(&curvature, &curvatures);
        assert_relative_eq!(curvature.distance[1], 0.8, max_relative = 1e-12);
        let periodic = Derivatives::new(&map(), Boundary::Periodic).unwrap();
        assert_relative_eq!(periodic.rms_gradient, 114.435_956_916_059_16, max_relative = 1e-10);
        assert_relative_eq!(periodic.rms_curvature, 1_094.548_378_081_473, max_relative = 1e-10);
        let free = Derivatives::new(&map(), Boundary::Free).unwrap();
        assert_relative_eq!(free.rms_gradient, 114.640_619_288_754_15, max_relative = 1e-10);
        assert_relative_eq!(free.rms_curvature, 1_090.986_747_551_652, max_relative = 1e-10);
        assert_relative_eq!(free.rms_slope[0], 55.143_150_485_391_58, max_relative = 1e-10);
        // The same of the spectrum along x, which has the factor 2 pi there.
        let spectrum = crate::spectrum::PowerSpectrum::along_x(&map(), crate::taper::Taper::None).unwrap();
        for (found, expected) in spectrum.density.iter().zip([
            5.308_693_907_585_837_5,
            1.859_989_638_801_829_8,
            1.510_355_029_210_193_3,
        ]) {
            assert_relative_eq!(found * std::f64::consts::TAU, expected, max_relative = 1e-10);
        }
    }

    #[test]
    fn undefined_points_are_left_out() {
        let plane: Vec<f64> =
            (0..36).map(|i| if i == 14 { f64::NAN } else { f64::from(i % 6 * 2 + i / 6) }).collect();
        let map = HeightMap::with_undefined(6, 6.0, plane).unwrap();
        let found = Derivatives::new(&map, Boundary::Free).unwrap();
        assert_relative_eq!(found.rms_gradient, 5.0_f64.sqrt(), max_relative = 1e-12);
        assert!(found.rms_curvature < 1e-12);
        let line = HeightMap::new([5, 1], [5.0, 1.0], vec![0.0; 5]).unwrap();
        assert!(Derivatives::new(&line, Boundary::Free).is_err());
        assert!(ScaleDependence::slope_along_y(&line, Boundary::Free).is_err());
    }
}
