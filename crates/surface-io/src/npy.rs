//! NPY, NumPy's array file.
//!
//! Own code: `npyz` 0.9 takes a time exponential in the nesting of brackets in a header (a hundred of them do
//! not end), multiplies the lengths of the axes unchecked, and reserves the length of the header before it
//! looks at the file. It is the reference implementation in the tests.

mod header;
mod write;

pub use write::npy;

use crate::content::FileContent;
use crate::error::{ContentError, Error, Place, Result};
use crate::format::Format;
use crate::options::ReadOptions;
use header::{AxisOrder, NpyHeader, NumberType};
use std::io::Read;
use std::path::Path;

/// Numbers that are read at a time.
const CHUNK: usize = 8192;

/// Reads an array of two dimensions; `length` is that of the whole file.
pub(crate) fn read(
    path: &Path,
    reader: &mut impl Read,
    length: u64,
    declared: &ReadOptions,
) -> Result<FileContent> {
    let content = Error::content;
    if declared.lateral_unit.is_some() {
        let reason = "an array has no coordinates; give size or cell with a unit";
        return Err(content(path)(ContentError::Useless { what: "lateral_unit", reason }));
    }
    if declared.skip_lines > 0 {
        let reason = "an NPY file has no lines";
        return Err(content(path)(ContentError::Useless { what: "skip_lines", reason }));
    }
    let (header, header_bytes) = NpyHeader::read(path, reader, length)?;
    let [rows, columns] = header.shape[..] else {
        return Err(content(path)(ContentError::Shape { found: header.shape }));
    };
    if rows == 0 || columns == 0 {
        return Err(content(path)(ContentError::NoCells { rows, columns }));
    }
    let found = length - header_bytes;
    let expected = (u128::from(rows) * u128::from(columns)).saturating_mul(header.kind.bytes() as u128);
    if expected != u128::from(found) {
        return Err(content(path)(ContentError::Length { rows, columns, expected, found }));
    }
    let (rows, columns) = (rows as usize, columns as usize);
    let mut heights = Vec::new();
    let refused = |_| content(path)(ContentError::Memory { bytes: 8 * (rows * columns) as u128 });
    heights.try_reserve_exact(rows * columns).map_err(refused)?;
    heights.resize(rows * columns, 0.0);
    let size = header.kind.bytes();
    let mut buffer = vec![0; CHUNK.min(rows * columns) * size];
    let mut done = 0;
    while done < heights.len() {
        let count = CHUNK.min(heights.len() - done);
        let bytes = &mut buffer[..count * size];
        reader.read_exact(bytes).map_err(Error::system("read", path))?;
        for (i, raw) in bytes.chunks_exact(size).enumerate() {
            let i = done + i;
            let (row, column) = match header.order {
                AxisOrder::C => (i / columns, i % columns),
                AxisOrder::Fortran => (i % rows, i / rows),
            };
            heights[row * columns + column] = header.kind.decode(raw).map_err(|value| {
                content(path)(ContentError::Inexact { place: Place::Cell { row, column }, value })
            })?;
        }
        done += count;
    }
    let order = match header.order {
        AxisOrder::C => "row by row",
        AxisOrder::Fortran => "column by column",
    };
    let details = format!("{}, {order}", header.kind);
    Ok(FileContent { format: Format::Npy, details, rows, columns, heights, unit: None, extent: [None; 2] })
}

/// Doubles hold every integer up to this size.
const EXACT: i128 = 1 << 53;

impl NumberType {
    /// The number in these bytes, or the integer that no double holds.
    fn decode(self, raw: &[u8]) -> Result<f64, i128> {
        let mut word = [0; 8];
        for (i, byte) in raw.iter().enumerate() {
            word[if self.little { i } else { raw.len() - 1 - i }] = *byte;
        }
        let bits = u64::from_le_bytes(word);
        match self.letter {
            b'f' => Ok(match raw.len() {
                2 => half(bits as u16),
                4 => f64::from(f32::from_bits(bits as u32)),
                _ => f64::from_bits(bits),
            }),
            b'u' => exact(i128::from(bits)),
            _ => {
                let unused = 64 - 8 * raw.len() as u32;
                exact(i128::from((bits << unused).cast_signed() >> unused))
            }
        }
    }
}

fn exact(value: i128) -> Result<f64, i128> {
    if value.abs() <= EXACT || (value as f64) as i128 == value { Ok(value as f64) } else { Err(value) }
}

/// IEEE 754 binary16.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from((bits >> 10) & 31), f64::from(bits & 1023));
    let size = match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 if fraction <= 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}

#[cfg(test)]
mod tests;
