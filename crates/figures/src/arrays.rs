//! Arrays as NPY and grey-scale PNG.

use crate::error::{Error, Result};
use crate::files;
use npyz::WriterBuilder as _;
use std::path::Path;

/// Writes numbers as an NPY array of the given shape (float64, row-major).
///
/// # Errors
/// [`Error::File`] when it cannot be written.
pub fn write_npy(path: &Path, shape: &[u64], values: &[f64]) -> Result<()> {
    let mut bytes = Vec::with_capacity(8 * values.len() + 128);
    npyz::WriteOptions::new()
        .default_dtype()
        .shape(shape)
        .writer(&mut bytes)
        .begin_nd()
        .and_then(|mut writer| {
            writer.extend(values.iter().copied())?;
            writer.finish()
        })
        .map_err(Error::file("write", path))?;
    files::write_whole(path, &bytes)
}

/// Writes a square map of `side` x `side` values as a grey-scale PNG, y upwards: the lowest value is white, the highest black.
///
/// # Errors
/// [`Error::Content`] for values that are no square, [`Error::File`] when it cannot be written.
pub fn write_grey(path: &Path, side: usize, values: &[f64]) -> Result<()> {
    if side == 0 || side.checked_mul(side) != Some(values.len()) {
        return Err(Error::content(path, format!("{} values are no map of {side} x {side}", values.len())));
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let shade = |v: &f64| {
        let t = if high > low { ((v - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        (255.0 * (1.0 - t)).round() as u8
    };
    let pixels: Vec<u8> = values.chunks(side).rev().flatten().map(shade).collect();
    files::write_whole(path, &encode_grey(path, side, &pixels)?)
}

/// Grey values of heights, darker = higher, for optimal contrast: the lowest and highest 0.5 % are white and black.
///
/// A map without relief is white. Cost O(n log n).
pub(crate) fn grey(heights: &[f64]) -> Vec<u8> {
    let mut sorted = heights.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * (sorted.len().saturating_sub(1)) as f64) as usize).copied();
    let (low, high) = (at(0.005).unwrap_or(0.0), at(0.995).unwrap_or(0.0));
    let shade = |h: &f64| {
        let t = if high > low { ((h - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        (255.0 * (1.0 - t)).round() as u8
    };
    heights.iter().map(shade).collect()
}

/// Encodes a grey-scale picture, first row on top.
pub(crate) fn encode_grey(path: &Path, width: usize, pixels: &[u8]) -> Result<Vec<u8>> {
    encode(path, width, pixels, png::ColorType::Grayscale, 1)
}

fn encode(
    path: &Path,
    width: usize,
    pixels: &[u8],
    color: png::ColorType,
    channels: usize,
) -> Result<Vec<u8>> {
    let failed = |e: png::EncodingError| Error::content(path, e.to_string());
    let height = pixels.len() / channels / width.max(1);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

/// An 8-bit picture in memory.
pub(crate) struct Image {
    pub(crate) width: usize,
    channels: usize,
    color: png::ColorType,
    pixels: Vec<u8>,
}

impl Image {
    /// Decodes an 8-bit PNG.
    pub(crate) fn decode(path: &Path, bytes: &[u8]) -> Result<Self> {
        let failed = |e: png::DecodingError| Error::content(path, e.to_string());
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().map_err(failed)?;
        let size = reader.output_buffer_size().ok_or_else(|| Error::content(path, "picture too large"))?;
        let mut pixels = vec![0; size];
        let info = reader.next_frame(&mut pixels).map_err(failed)?;
        pixels.truncate(info.buffer_size());
        let (width, color) = (info.width as usize, info.color_type);
        Ok(Self { width, channels: color.samples(), color, pixels })
    }

    /// Paints a square grey map of `side` x `side` values (first row on top) over the pixel square at (x, y), nearest value.
    pub(crate) fn paint(&mut self, x: usize, y: usize, size: usize, grey: &[u8], side: usize) {
        for row in 0..size {
            for column in 0..size {
                let value = grey[(row * side / size) * side + column * side / size];
                let at = ((y + row) * self.width + x + column) * self.channels;
                if let Some(pixel) = self.pixels.get_mut(at..at + self.channels) {
                    pixel.fill(255);
                    let colors = if self.channels > 2 { 3 } else { 1 };
                    pixel[..colors].fill(value);
                }
            }
        }
    }

    pub(crate) fn encode(&self, path: &Path) -> Result<Vec<u8>> {
        encode(path, self.width, &self.pixels, self.color, self.channels)
    }
}

/// Base64 (RFC 4648), for pictures inside an SVG.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().fold(0_u32, |w, b| (w << 8) | u32::from(*b)) << (8 * (3 - chunk.len()));
        for i in 0..4 {
            if i <= chunk.len() {
                text.push(char::from(LETTERS[(word >> (18 - 6 * i)) as usize & 63]));
            } else {
                text.push('=');
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_rfc() {
        for (plain, coded) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn higher_is_darker() {
        let g = grey(&[0.0, 1.0, 2.0]);
        assert!(g[0] > g[1] && g[1] >= g[2]);
        assert_eq!(grey(&[1.0, 1.0]), [255, 255]);
        assert_eq!(grey(&[]), [0_u8; 0]);
    }

    #[test]
    fn pictures_and_arrays_come_back() {
        let path = Path::new("p.png");
        let bytes = encode_grey(path, 2, &[0, 50, 100, 150]).unwrap();
        let mut image = Image::decode(path, &bytes).unwrap();
        image.paint(1, 0, 1, &[7], 1);
        let again = Image::decode(path, &image.encode(path).unwrap()).unwrap();
        assert_eq!((again.width, again.pixels), (2, vec![0, 7, 100, 150]));
        assert!(Image::decode(path, b"no picture").is_err());

        let dir = tempfile::tempdir().unwrap();
        let npy = dir.path().join("a.npy");
        write_npy(&npy, &[2, 2], &[1.0, 2.0, 3.0, 1.0 / 3.0]).unwrap();
        let bytes = std::fs::read(npy).unwrap();
        let array = npyz::NpyFile::new(&bytes[..]).unwrap();
        assert_eq!(array.shape(), [2, 2]);
        assert_eq!(array.into_vec::<f64>().unwrap()[3].to_bits(), (1.0_f64 / 3.0).to_bits());
    }
}
