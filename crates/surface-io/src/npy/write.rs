//! Arrays as NPY.

use crate::error::ContentError;

/// Header and data of NumPy's files begin at multiples of this.
const ALIGNED: usize = 64;

/// The bytes of an NPY file: little-endian float64, row-major.
///
/// # Errors
/// [`ContentError::OutOfRange`] where the shape does not hold that many values.
///
/// ```
/// let bytes = surface_io::npy(&[2, 2], &[1.0, 2.0, 3.0, 4.0])?;
/// assert_eq!(bytes.len(), 128 + 4 * 8);
/// assert!(surface_io::npy(&[2, 3], &[1.0]).is_err());
/// # Ok::<(), surface_io::ContentError>(())
/// ```
pub fn npy(shape: &[usize], values: &[f64]) -> Result<Vec<u8>, ContentError> {
    let product = shape.iter().try_fold(1_usize, |n, &axis| n.checked_mul(axis));
    if product != Some(values.len()) {
        let (what, expected) = ("number of values", "the product of the shape");
        return Err(ContentError::out_of_range(what, values.len() as f64, expected));
    }
    let axes: Vec<String> = shape.iter().map(usize::to_string).collect();
    // Python's tuple of one number has a comma.
    let axes = axes.join(", ") + if shape.len() == 1 { "," } else { "" };
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({axes}), }}");
    // Magic, version and length take 10 bytes, the line break 1.
    let padding = (ALIGNED - (text.len() + 11) % ALIGNED) % ALIGNED;
    text.extend(std::iter::repeat_n(' ', padding));
    text.push('\n');
    let mut bytes = Vec::with_capacity(10 + text.len() + 8 * values.len());
    bytes.extend(super::header::MAGIC);
    bytes.extend([1, 0]);
    let too_many = |_| ContentError::out_of_range("number of axes", shape.len() as f64, "a few");
    let length = u16::try_from(text.len()).map_err(too_many)?;
    bytes.extend(length.to_le_bytes());
    bytes.extend(text.bytes());
    for value in values {
        bytes.extend(value.to_le_bytes());
    }
    Ok(bytes)
}
