//! From the description of a surface to its samples.

use crate::indenter::{axisymmetric, flat, flat_circle, sine};
use crate::{MapGenerator, self_affine_line};
use contact_model::{Cells, Error, HeightMap, Line, Result, Stop, Surface, never};
use std::sync::Arc;

/// Name in errors of this crate.
const NAME: &str = "surface-gen";

/// Heights of any surface, sampled at the cells' centres; `seed` matters for random surfaces only.
///
/// `cells` is a number for as many rows as columns, or `[columns, rows]`; cells need not be squares.
/// Axisymmetric bodies have their apex (height 0) at the centre of the rectangle. Where the numbers of
/// columns or rows are even, it lies between cells, and the highest *sample* is lower than 0. A flat circular
/// punch has height 0 where a cell's centre is on the face and -1000 longer sides elsewhere, deeper than any
/// approach of the linear theory. A given map is shared, not copied.
///
/// # Errors
/// [`Error::Unsupported`] for a line; [`Error::Shape`] for a given map of other cells; [`Error::Domain`] for
/// parameters that make no sense, no columns or rows, cells whose sides differ by more than 1e4, a sine with
/// waves shorter than two cells, a punch that misses every cell centre or is wider than the shorter side;
/// [`Error::OutOfMemory`] for a map that does not fit in memory; and as [`crate::self_affine_map`]. Cost O(N) for N
/// cells, for self-affine surfaces O(N log N).
///
/// ```
/// use contact_model::Surface;
/// // The corner cell's centre is at r^2 = 2 (1/3)^2 from the apex: r^2 / (2 R) = 1/9.
/// let map = surface_gen::height_map(&Surface::Sphere { radius: 1.0, size: 1.0.into() }, 3, 0)?;
/// assert!((map.heights()[0] + 1.0 / 9.0).abs() < 1e-15);
/// assert!(map.heights()[4] == 0.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn height_map(surface: &Surface, cells: impl Into<Cells>, seed: u64) -> Result<Arc<HeightMap>> {
    height_map_until(surface, cells, seed, &never)
}

/// As [`height_map`], unless the stop ends it: drawing a random surface of 4097 x 4097 cells takes seconds.
///
/// # Errors
/// [`Error::Stopped`] by the stop; as [`height_map`].
pub fn height_map_until(
    surface: &Surface,
    cells: impl Into<Cells>,
    seed: u64,
    stop: Stop<'_>,
) -> Result<Arc<HeightMap>> {
    surface.validate()?;
    let (cells, size) = (cells.into(), surface.size());
    let map = match *surface {
        Surface::SelfAffine(ref s) => MapGenerator::new(s, cells)?.map_until(seed, stop)?,
        Surface::Heights(ref map) | Surface::Profile(ref map) if map.cells() == cells => {
            return Ok(Arc::clone(map));
        }
        Surface::Heights(ref map) | Surface::Profile(ref map) => {
            let Cells { columns, rows } = cells;
            return Err(Error::Shape {
                name: "heights".into(),
                found: map.heights().len(),
                expected: format!(
                    "{rows} rows x {columns} columns, the requested cells (maps are not resampled)"
                )
                .into(),
            });
        }
        Surface::Sphere { radius, .. } => axisymmetric(cells, size, |r| 0.5 * r * (r / radius))?,
        Surface::Cone { slope, .. } => axisymmetric(cells, size, |r| slope * r)?,
        Surface::PowerLaw { coefficient, exponent, .. } => {
            axisymmetric(cells, size, |r| coefficient * r.powf(exponent))?
        }
        Surface::FlatCircle { radius, .. } => flat_circle(cells, size, radius)?,
        Surface::Flat { .. } => flat(cells, size)?,
        Surface::Sine { amplitude, wavelength, .. } => sine(cells, size, amplitude, wavelength)?,
        _ => return Err(Error::unsupported(NAME, format!("{} as a map", surface.kind()))),
    };
    Ok(Arc::new(map))
}

/// Heights of a self-affine or given line of `elements` elements.
///
/// # Errors
/// [`Error::Unsupported`] for every other surface (an axisymmetric body has an equivalent profile, but
/// computing it is the task of a model); [`Error::Shape`] for a given line of another size; otherwise as
/// [`self_affine_line`]. Cost O(n log n).
///
/// ```
/// use contact_model::{SelfAffine, Surface};
/// let surface = Surface::SelfAffine(SelfAffine::new(2.0, 1.0, 1.0)?);
/// assert_eq!(surface_gen::line(&surface, 64, 0)?.elements(), 64);
/// assert!(surface_gen::line(&Surface::Flat { size: 1.0.into() }, 64, 0).is_err());
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn line(surface: &Surface, elements: usize, seed: u64) -> Result<Arc<Line>> {
    surface.validate()?;
    match surface {
        Surface::SelfAffine(s) => Ok(Arc::new(self_affine_line(s, elements, seed)?)),
        Surface::Line { line, .. } if line.elements() == elements => Ok(Arc::clone(line)),
        Surface::Line { line, .. } => Err(Error::Shape {
            name: "line".into(),
            found: line.elements(),
            expected: format!("{elements}, the requested elements (lines are not resampled)").into(),
        }),
        _ => Err(Error::unsupported(NAME, format!("{} as a line", surface.kind()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rms_slope_differences;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use contact_model::SelfAffine;
    use std::f64::consts::PI;

    /// A few roundings of a closed form.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;

    #[test]
    fn axisymmetric_bodies_at_known_points() {
        // Cell (0, 1) of 4 on a side of 4: r = sqrt(1.5^2 + 0.5^2) = sqrt(2.5).
        let at = |surface: Surface| height_map(&surface, 4, 0).unwrap().heights()[4];
        assert_relative_eq!(
            at(Surface::Sphere { radius: 5.0, size: 4.0.into() }),
            -0.25,
            max_relative = ROUNDING
        );
        let cone = at(Surface::Cone { slope: 0.1, size: 4.0.into() });
        assert_relative_eq!(cone, -0.1 * 2.5_f64.sqrt(), max_relative = ROUNDING);
        let power = at(Surface::PowerLaw { coefficient: 2.0, exponent: 4.0, size: 4.0.into() });
        assert_relative_eq!(power, -12.5, max_relative = ROUNDING);
    }

    #[test]
    fn bodies_have_the_symmetries_of_the_square() {
        for n in [1, 2, 5, 8] {
            let surface = Surface::PowerLaw { coefficient: 0.3, exponent: 0.7, size: 0.37.into() };
            let map = height_map(&surface, n, 0).unwrap();
            let h = |ix: usize, iy: usize| map.heights()[iy * n + ix].to_bits();
            for iy in 0..n {
                for ix in 0..n {
                    assert!(h(ix, iy) == h(iy, ix) && h(ix, iy) == h(n - 1 - ix, iy));
                }
            }
            assert!(n % 2 == 0 || map.highest() >= 0.0);
        }
    }

    #[test]
    fn a_cone_has_its_slope() {
        let map = height_map(&Surface::Cone { slope: 0.2, size: 3.0.into() }, 301, 0).unwrap();
        assert_relative_eq!(rms_slope_differences(&map), 0.2, max_relative = 2e-3); // second order, but for the apex
    }

    #[test]
    fn a_punch_covers_its_face() {
        let punch = |radius| height_map(&Surface::FlatCircle { radius, size: 2.0.into() }, 100, 0);
        let map = punch(0.9).unwrap();
        let inside = map.heights().iter().filter(|&&h| h >= 0.0).count();
        assert_relative_eq!(inside as f64 / 1e4, PI * 0.81 / 4.0, max_relative = 5e-3); // lattice points in a circle
        assert_relative_eq!(map.heights()[0], -2000.0);
        assert!(punch(1.01).is_err() && punch(0.013).is_err() && punch(0.0142).is_ok());
        let one = height_map(&Surface::FlatCircle { radius: 1e-9, size: 2.0.into() }, 3, 0).unwrap();
        assert_eq!(one.heights().iter().filter(|&&h| h >= 0.0).count(), 1);
    }

    #[test]
    fn sine_and_flat() {
        let sine =
            |wavelength| height_map(&Surface::Sine { amplitude: 2.0, wavelength, size: 1.0.into() }, 8, 0);
        let map = sine(0.5).unwrap();
        for (ix, h) in map.heights()[16..24].iter().enumerate() {
            assert_abs_diff_eq!(*h, 2.0 * (4.0 * PI * (ix as f64 + 0.5) / 8.0).cos(), epsilon = ROUNDING);
        }
        assert!(sine(0.25).is_ok() && sine(0.24).is_err());
        let flat = height_map(&Surface::Flat { size: 1.0.into() }, 3, 0).unwrap();
        assert!(flat.heights().iter().all(|&h| h.abs() <= 0.0));
    }

    #[test]
    fn given_samples_are_passed_on() {
        let map = Arc::new(HeightMap::new(2, 1.0, vec![0.0; 4]).unwrap());
        let surface = Surface::Heights(Arc::clone(&map));
        assert!(Arc::ptr_eq(&height_map(&surface, 2, 0).unwrap(), &map));
        assert!(matches!(height_map(&surface, 3, 0), Err(Error::Shape { found: 4, .. })));
        assert!(matches!(line(&surface, 3, 0), Err(Error::Unsupported { .. })));

        let given = Arc::new(Line::new(1.0, vec![0.0; 5]).unwrap());
        let surface = Surface::Line { line: Arc::clone(&given), size: 1.0.into() };
        assert!(Arc::ptr_eq(&line(&surface, 5, 0).unwrap(), &given));
        assert!(matches!(line(&surface, 4, 0), Err(Error::Shape { found: 5, .. })));
        let e = height_map(&surface, 5, 0).unwrap_err();
        assert_eq!(e.to_string(), "the model surface-gen does not support a line as a map");
    }

    #[test]
    fn random_surfaces_are_the_same_by_either_door() {
        let s = SelfAffine::new(2.4, 1.0, 1.0).unwrap();
        let surface = Surface::SelfAffine(s);
        assert_eq!(*height_map(&surface, 9, 4).unwrap(), crate::self_affine_map(&s, 9, 4).unwrap());
        assert_eq!(*line(&surface, 9, 4).unwrap(), self_affine_line(&s, 9, 4).unwrap());
    }

    #[test]
    fn bad_numbers_are_errors() {
        let side = 1.0;
        for surface in [
            Surface::Sphere { radius: 0.0, size: side.into() },
            Surface::Cone { slope: f64::NAN, size: side.into() },
            Surface::PowerLaw { coefficient: 1.0, exponent: -1.0, size: side.into() },
            Surface::FlatCircle { radius: f64::INFINITY, size: side.into() },
            Surface::Flat { size: 0.0.into() },
            Surface::Sine { amplitude: 0.0, wavelength: 1.0, size: side.into() },
            Surface::Sphere { radius: 1e-300, size: 1e200.into() },
        ] {
            assert!(matches!(height_map(&surface, 4, 0), Err(Error::Domain { .. })), "{surface:?}");
        }
        assert!(height_map(&Surface::Flat { size: side.into() }, 0, 0).is_err());
        assert!(height_map(&Surface::Flat { size: side.into() }, usize::MAX, 0).is_err());
        assert!(height_map(&Surface::FlatCircle { radius: 0.1, size: side.into() }, 0, 0).is_err());
        assert!(
            height_map(&Surface::Sine { amplitude: 1.0, wavelength: 1.0, size: side.into() }, 0, 0).is_err()
        );
    }
}
