//! Values as colours.

use crate::map::encode_rgb;
use files::Result;
use std::path::Path;

/// Undefined points.
pub(crate) const UNDEFINED: [u8; 3] = [205, 205, 205];

/// 256 colours of viridis, which is even to the eye and to that of the colour-blind, from the lowest to the
/// highest value.
///
/// ```
/// assert_eq!(plots::viridis()[0], [68, 1, 84]);
/// ```
pub fn viridis() -> [[u8; 3]; 256] {
    std::array::from_fn(|i| colorous::VIRIDIS.eval_rational(i, 256).into_array())
}

/// A PNG with a pixel for each value, the last row on top: viridis from the lowest to the highest of the
/// range, undefined points grey, and white at 0 where `zero_is_white`.
///
/// # Errors
/// [`crate::Error::Content`] where the encoder refuses.
pub fn encode_viridis(
    columns: usize,
    values: &[f32],
    [low, high]: [f32; 2],
    zero_is_white: bool,
) -> Result<Vec<u8>> {
    let colours = viridis();
    let colour = |v: &f32| match *v {
        v if !v.is_finite() => UNDEFINED,
        v if zero_is_white && v.abs() <= 0.0 => [255; 3],
        v if high > low => colours[(256.0 * ((v - low) / (high - low)).clamp(0.0, 1.0)).min(255.0) as usize],
        _ => colours[128],
    };
    let pixels: Vec<[u8; 3]> = values.chunks(columns.max(1)).rev().flatten().map(colour).collect();
    encode_rgb(Path::new("a picture"), columns, &pixels.into_flattened())
}
