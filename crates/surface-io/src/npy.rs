//! NPY, NumPy's array file.
//!
//! Own code: `npyz` 0.9 takes a time exponential in the nesting of brackets in a header (a hundred of them do
//! not end), multiplies the lengths of the axes unchecked, and reserves the length of the header before it
//! looks at the file. It is the reference implementation in the tests.

mod header;
mod write;

pub use write::npy;

use crate::channel::{RawHeights, StoredChannel, StoredUnit};
use crate::error::{ContentError, Result};
use crate::format::Format;
use crate::reader::Reader;
use crate::source::OpenedFile;
use header::{MAGIC, NpyHeader};

pub(crate) const READER: Reader =
    Reader { format: Format::Npy, recognises: |start, _| start.starts_with(MAGIC), channels };

/// An array of two dimensions.
fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let (header, header_bytes) = NpyHeader::read(source)?;
    let [rows, columns] = header.shape[..] else {
        return Err(source.content(ContentError::Shape { found: header.shape }));
    };
    let shape = [rows as usize, columns as usize];
    source.check_cells(shape)?;
    let found = source.length() - header_bytes;
    let expected = (u128::from(rows) * u128::from(columns)).saturating_mul(header.kind.bytes() as u128);
    if expected != u128::from(found) {
        return Err(source.content(ContentError::Length { rows, columns, expected, found }));
    }
    let raw = RawHeights { order: header.order, ..RawHeights::at(header_bytes, header.kind) };
    Ok(vec![StoredChannel::new(source, raw, shape, StoredUnit::Unknown, [None; 2])?])
}

#[cfg(test)]
mod tests;
