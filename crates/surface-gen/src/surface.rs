//! From the description of a surface to its samples.

use crate::indenter::{axisymmetric, flat_circle, flat_square, sine};
use crate::{self_affine_line, self_affine_map};
use contact_model::{Error, HeightMap, Line, Result, Surface};
use std::sync::Arc;

/// Name in errors of this crate.
const NAME: &str = "surface-gen";

/// Heights of any surface on `cells` x `cells` cells, sampled at the cells' centres; `seed` matters for random surfaces only.
///
/// Axisymmetric bodies have their apex (height 0) in the middle of the square, between four cells when `cells` is even: the highest
/// *sample* then lies lower. A flat circular punch has height 0 where a cell's centre is on the face and -1000 sides elsewhere, deeper than
/// any approach of the linear theory. A given map is passed on, not copied.
///
/// # Errors
/// [`Error::Unsupported`] for a line; [`Error::Shape`] for a given map of another size; [`Error::Domain`] for parameters that make no sense, a sine
/// with waves shorter than two cells, a punch that misses every cell centre or does not fit in the square, and as
/// [`self_affine_map`]. Cost O(N^2), for self-affine surfaces O(N^2 log N).
///
/// ```
/// use contact_model::Surface;
/// // The corner cell's centre is at r^2 = 2 (1/3)^2 from the apex: r^2 / (2 R) = 1/9.
/// let map = surface_gen::height_map(&Surface::Sphere { radius: 1.0, side: 1.0 }, 3, 0)?;
/// assert!((map.heights()[0] + 1.0 / 9.0).abs() < 1e-15);
/// assert!(map.heights()[4] == 0.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn height_map(surface: &Surface, cells: usize, seed: u64) -> Result<Arc<HeightMap>> {
    surface.validate()?;
    let map = match *surface {
        Surface::SelfAffine(ref s) => self_affine_map(s, cells, seed)?,
        Surface::Heights(ref map) if map.cells() == cells => return Ok(Arc::clone(map)),
        Surface::Heights(ref map) => {
            return Err(Error::Shape {
                name: "heights".into(),
                found: map.heights().len(),
                expected: format!("{cells} x {cells}, the cells asked for (maps are not resampled)").into(),
            });
        }
        Surface::Sphere { radius, side } => axisymmetric(cells, side, |r| 0.5 * r * (r / radius))?,
        Surface::Cone { slope, side } => axisymmetric(cells, side, |r| slope * r)?,
        Surface::PowerLaw { coefficient, exponent, side } => {
            axisymmetric(cells, side, |r| coefficient * r.powf(exponent))?
        }
        Surface::FlatCircle { radius, side } => flat_circle(cells, side, radius)?,
        Surface::FlatSquare { side } => flat_square(cells, side)?,
        Surface::Sine { amplitude, wavelength, side } => sine(cells, side, amplitude, wavelength)?,
        _ => return Err(Error::unsupported(NAME, format!("{} as a map", surface.kind()))),
    };
    Ok(Arc::new(map))
}

/// Heights of a self-affine or given line of `elements` elements.
///
/// # Errors
/// [`Error::Unsupported`] for every other surface (an axisymmetric body has an equivalent profile, but that is a model's business, not
/// sampling); [`Error::Shape`] for a given line of another size; otherwise as [`self_affine_line`]. Cost O(n log n).
///
/// ```
/// use contact_model::{SelfAffine, Surface};
/// let surface = Surface::SelfAffine(SelfAffine::new(2.0, 1.0, 1.0)?);
/// assert_eq!(surface_gen::line(&surface, 64, 0)?.elements(), 64);
/// assert!(surface_gen::line(&Surface::FlatSquare { side: 1.0 }, 64, 0).is_err());
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
            expected: format!("{elements}, the elements asked for (lines are not resampled)").into(),
        }),
        _ => Err(Error::unsupported(NAME, format!("{} as a line", surface.kind()))),
    }
}
