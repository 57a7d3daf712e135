//! Maps as grey-scale PNG.

use crate::error::{Error, Result};
use crate::pixels::Pixels;
use contact_model::{Cells, Size};

/// Most pixels along a side of a picture whose cells are oblong; one with square cells has a pixel for each.
const MOST_PIXELS: f64 = 4096.0;

/// A PNG of a map of values (row-major, columns along x and rows along y) on a rectangle of the given size, y
/// upwards: the lowest value is white, the highest black, undefined points (NaN) are transparent.
///
/// The picture has the aspect ratio of the rectangle. A pixel is a square of the shorter side of a cell, or
/// larger where cells are oblong and the picture would have more than 4096 of them along a side. A pixel on
/// several cells shows one of them, so chosen that shares of areas, the mean and the extrema are kept.
///
/// # Errors
/// [`Error`] with the name that the caller gives the picture, for another number of values than cells, no
/// cells or a size that is not positive.
pub fn grey_png(
    picture: &str,
    cells: impl Into<Cells>,
    size: impl Into<Size>,
    values: &[f64],
) -> Result<Vec<u8>> {
    let (cells, size) = (cells.into(), size.into());
    let Cells { columns, rows } = cells;
    if values.is_empty() || cells.checked_count() != Some(values.len()) {
        let message = format!("{} values are no map of {rows} rows x {columns} columns", values.len());
        return Err(Error::new(picture, message));
    }
    cells.validate(size).map_err(|e| Error::new(picture, e.to_string()))?;
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    let [width, height] = pixels(cells, size);
    let transparent = values.iter().any(|v| !v.is_finite());
    let mut bytes = Vec::with_capacity(width * height * if transparent { 2 } else { 1 });
    let reduced = Pixels::new(cells, Cells { columns: width, rows: height }, values);
    for y in (0..height).rev() {
        for x in 0..width {
            let value = values[reduced.cell(x, y)];
            let defined = value.is_finite();
            bytes.push(if defined { shade(value, low, high) } else { 255 });
            if transparent {
                bytes.push(if defined { 255 } else { 0 });
            }
        }
    }
    if transparent {
        encode(picture, width, &bytes, png::ColorType::GrayscaleAlpha, 2)
    } else {
        encode_grey(picture, width, &bytes)
    }
}

/// Width and height in pixels of a picture of these cells.
fn pixels(cells: Cells, size: Size) -> [usize; 2] {
    let (dx, dy) = (size.x / cells.columns as f64, size.y / cells.rows as f64);
    if (dx / dy - 1.0).abs() < SQUARE {
        return [cells.columns, cells.rows];
    }
    let pixel = dx.min(dy).max(size.x.max(size.y) / MOST_PIXELS);
    [size.x, size.y].map(|side| ((side / pixel).round() as usize).max(1))
}

/// Cells whose sides differ by less than this are square in a picture: a pixel over the most of them.
const SQUARE: f64 = 1.0 / MOST_PIXELS;

/// Grey values of heights, darker = higher, for optimal contrast: the lowest and highest 0.5 % are white and
/// black.
///
/// A map of equal heights is white. Cost O(n log n).
pub fn grey(heights: &[f64]) -> Vec<u8> {
    grey_between(heights, most(heights))
}

/// Grey values of heights: white at the low end and below, black at the high one and above.
pub fn grey_between(heights: &[f64], (low, high): (f64, f64)) -> Vec<u8> {
    heights.iter().map(|&h| shade(h, low, high)).collect()
}

/// The range of heights without the lowest and the highest 0.5 %; (0, 0) for no heights. Cost O(n log n).
///
/// ```
/// let heights: Vec<f64> = (0..=1000).map(f64::from).collect();
/// assert_eq!(plots::most(&heights), (5.0, 995.0));
/// ```
pub fn most(heights: &[f64]) -> (f64, f64) {
    let mut sorted = heights.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * (sorted.len().saturating_sub(1)) as f64) as usize).copied();
    (at(0.005).unwrap_or(0.0), at(0.995).unwrap_or(0.0))
}

/// White at the low end, black at the high one; white where all heights are equal.
fn shade(value: f64, low: f64, high: f64) -> u8 {
    let t = if high > low { share(value, low, high).clamp(0.0, 1.0) } else { 0.0 };
    (255.0 * (1.0 - t)).round() as u8
}

/// How far a value is from the low end to the high one.
pub(crate) fn share(value: f64, low: f64, high: f64) -> f64 {
    // Halves, because the range of finite numbers may overflow.
    (0.5 * value - 0.5 * low) / (0.5 * high - 0.5 * low)
}

/// Encodes a grey-scale picture, first row on top.
///
/// # Errors
/// [`Error`] with the name that the caller gives the picture, where the encoder refuses.
pub fn encode_grey(picture: &str, width: usize, pixels: &[u8]) -> Result<Vec<u8>> {
    encode(picture, width, pixels, png::ColorType::Grayscale, 1)
}

/// Encodes a picture of three bytes a pixel, first row on top; one without colours with one byte a pixel.
pub(crate) fn encode_rgb(picture: &str, width: usize, pixels: &[u8]) -> Result<Vec<u8>> {
    if pixels.chunks(3).all(|p| p[0] == p[1] && p[0] == p[2]) {
        let grey: Vec<u8> = pixels.iter().copied().step_by(3).collect();
        return encode_grey(picture, width, &grey);
    }
    encode(picture, width, pixels, png::ColorType::Rgb, 3)
}

fn encode(
    picture: &str,
    width: usize,
    pixels: &[u8],
    color: png::ColorType,
    channels: usize,
) -> Result<Vec<u8>> {
    let failed = |e: png::EncodingError| Error::new(picture, e.to_string());
    let height = pixels.len() / channels / width.max(1);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine as _;
    use base64::engine::general_purpose::STANDARD;

    #[test]
    fn base64_of_the_rfc() {
        for (plain, coded) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(STANDARD.encode(plain), coded);
        }
    }

    #[test]
    fn higher_is_darker() {
        let g = grey(&[0.0, 1.0, 2.0]);
        assert!(g[0] > g[1] && g[1] >= g[2]);
        assert_eq!(grey(&[1.0, 1.0]), [255, 255]);
        assert_eq!(grey(&[]), [0_u8; 0]);
        assert_eq!(grey(&[-1.7e308, 0.0, 1.7e308, 1.7e308]), [255, 128, 0, 0]);
    }

    #[test]
    fn pictures_keep_the_shape_of_the_rectangle() {
        let image = |cells: [usize; 2], size: [f64; 2], values: &[f64]| {
            let file = grey_png("a.png", cells, size, values).unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            (info.width, info.height, pixels)
        };
        // Row 0 is at y = 0, at the bottom.
        assert_eq!(image([2, 1], [2.0, 1.0], &[0.0, 1.0]), (2, 1, vec![255, 0]));
        assert_eq!(image([1, 2], [1.0, 2.0], &[0.0, 1.0]), (1, 2, vec![0, 255]));
        // Cells of 2 x 1: four pixels across, two up.
        assert_eq!(
            image([2, 2], [4.0, 2.0], &[0.0, 1.0, 1.0, 0.0]),
            (4, 2, vec![0, 0, 255, 255, 255, 255, 0, 0])
        );
        // An undefined point is transparent.
        assert_eq!(image([2, 1], [2.0, 1.0], &[f64::NAN, 1.0]), (2, 1, vec![255, 0, 255, 255]));
        assert_eq!(image([2, 1], [2.0, 1.0], &[f64::NAN; 2]).2, [255, 0, 255, 0]);
        // Long rectangles do not become large files.
        let (width, height, _) = image([1, 2], [5e3, 1.0], &[0.0, 1.0]);
        assert_eq!((width, height), (4096, 1));
        let error = grey_png("a.png", [2, 2], 1.0, &[0.0; 3]).unwrap_err().to_string();
        assert_eq!(error, "a.png: 3 values are no map of 2 rows x 2 columns");
        assert!(grey_png("a.png", 0, 1.0, &[]).is_err());
        assert!(grey_png("a.png", [1, 2], [1.0, 1e9], &[0.0; 2]).is_err());
    }
}
