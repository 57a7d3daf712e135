//! Where the numbers of a data set are, and how they are decoded.

use crate::channel::undefined_heights;
use crate::inflate::RATIO;
use crate::instruments::prelude::*;
use flate2::read::ZlibDecoder;
use hdf5_pure::{Chunk, Dataset, Datatype, DatatypeByteOrder, FloatingPointLayout, Layout};
use std::io::Read as _;

const DEFLATE: u16 = 1;
const SHUFFLE: u16 = 2;
const FLETCHER32: u16 = 3;

/// The error for a file in which hdf5-pure found a fault.
pub(super) fn unreadable(source: &OpenedFile<'_>, error: &dyn std::fmt::Display) -> crate::error::Error {
    let said: String = error.to_string().chars().take(200).collect();
    source.wrong(0, format!("a file as its specification has it ({said})"))
}

/// Where the numbers of a data set are.
pub(super) enum DataLocation {
    Stored(Bytes),
    Chunked(Pieces),
    /// The reason why hdf5-pure does not give them.
    Unread(String),
}

impl DataLocation {
    /// The numbers line by line, scaled and marked as `by` has it.
    pub(super) fn read(
        &self,
        by: &RawHeights,
        source: &mut OpenedFile<'_>,
        [lines, along]: [usize; 2],
    ) -> Result<Vec<f64>> {
        let RawHeights { number, scale, shift, undefined, valid, .. } = *by;
        let raw = |bytes| RawHeights { scale, shift, undefined, valid, ..RawHeights::new(bytes, number) };
        match self {
            Self::Stored(bytes) => raw(bytes.clone()).read(source, lines, along),
            Self::Chunked(pieces) => pieces.read(&raw(Bytes::Held(Vec::new())), source),
            Self::Unread(said) => Err(unreadable(source, said)),
        }
    }
}

/// Where the numbers of a data set of one or two dimensions are, and their address where they have one;
/// `None` where they were never written, or are in other files or data sets.
pub(super) fn layout(
    source: &OpenedFile<'_>,
    dataset: &Dataset,
    name: &str,
    number: NumberType,
    shape: [u64; 2],
) -> Result<Option<(Option<u64>, DataLocation)>> {
    let most = RATIO.saturating_mul(source.length());
    if number.bytes_of(shape).is_none_or(|claimed| claimed > most) {
        let [lines, along] = shape;
        let expected = format!("{name} of {lines} x {along} numbers in at most {most} bytes");
        return Err(source.wrong(0, expected));
    }
    let [lines, along] = shape.map(|length| length as usize);
    Ok(match dataset.layout() {
        Err(e) => Some((None, DataLocation::Unread(e.to_string()))),
        Ok(Layout::Compact { .. }) => {
            let bytes = dataset.read_raw().map_err(|e| unreadable(source, &e))?;
            Some((None, DataLocation::Stored(Bytes::Held(bytes))))
        }
        Ok(Layout::Contiguous { address: Some(address), .. }) => {
            Some((Some(address), DataLocation::Stored(Bytes::File(address))))
        }
        Ok(Layout::Chunked { chunk_shape, .. }) => {
            let chunk = match chunk_shape[..] {
                [a, b] => [a, b],
                [along] => [1, along],
                _ => return Ok(None),
            };
            let chunks = dataset.chunks().map_err(|e| e.to_string().chars().take(200).collect::<String>());
            let address = chunks.as_ref().ok().and_then(|chunks| chunks.first()).map(|chunk| chunk.address);
            let flat = chunk_shape.len() == 1;
            let (name, filters) = (name.to_owned(), dataset.filters());
            Some((
                address,
                DataLocation::Chunked(Pieces { name, chunk, flat, filters, chunks, lines, along }),
            ))
        }
        Ok(_) => None,
    })
}

/// Whole IEEE floats and integers; `None` for all else.
pub(super) fn number_type(datatype: &Datatype) -> Option<NumberType> {
    let little = |order: DatatypeByteOrder| match order {
        DatatypeByteOrder::LittleEndian => Some(true),
        DatatypeByteOrder::BigEndian => Some(false),
        DatatypeByteOrder::Vax => None,
    };
    match datatype {
        Datatype::FixedPoint { size, byte_order, layout } => {
            let whole = layout.bit_offset == 0 && u32::from(layout.bit_precision) == size.checked_mul(8)?;
            let letter = if layout.signed { b'i' } else { b'u' };
            whole.then(|| NumberType::new(letter, u8::try_from(*size).ok()?, little(*byte_order)?))?
        }
        Datatype::FloatingPoint { size, byte_order, layout } => {
            let half = FloatingPointLayout {
                bit_offset: 0,
                bit_precision: 16,
                exponent_location: 10,
                exponent_size: 5,
                mantissa_location: 0,
                mantissa_size: 10,
                exponent_bias: 15,
            };
            let of_size = match size {
                2 => half,
                4 => FloatingPointLayout::IEEE754_BINARY32,
                8 => FloatingPointLayout::IEEE754_BINARY64,
                _ => return None,
            };
            (*layout == of_size).then(|| NumberType::new(b'f', *size as u8, little(*byte_order)?))?
        }
        _ => None,
    }
}

/// A data set in chunks.
pub(super) struct Pieces {
    name: String,
    /// Lines and numbers along them of one chunk.
    chunk: [u64; 2],
    /// Whether the data set has one dimension: one line.
    flat: bool,
    /// In the order in which they were applied.
    filters: Vec<u16>,
    chunks: std::result::Result<Vec<Chunk>, String>,
    lines: usize,
    along: usize,
}

impl Pieces {
    pub(super) fn read(&self, raw: &RawHeights, source: &mut OpenedFile<'_>) -> Result<Vec<f64>> {
        let chunks = self.chunks.as_ref().map_err(|e| unreadable(source, e))?;
        if let Some(filter) = self.filters.iter().find(|f| !matches!(**f, DEFLATE | SHUFFLE | FLETCHER32)) {
            let expected = format!("{} packed by deflate or not at all, it has filter {filter}", self.name);
            return Err(source.wrong(0, expected));
        }
        let size = raw.number.bytes();
        let [tall, wide] = self.chunk;
        let most = RATIO.saturating_mul(source.length());
        let bytes = tall.checked_mul(wide).and_then(|n| n.checked_mul(size as u64)).unwrap_or(u64::MAX);
        // All of them together: they may share their bytes, and reach far beyond the data set.
        let count = |all: usize, of_one: u64| (all as u64).div_ceil(of_one.max(1));
        let count = u128::from(count(self.lines, tall)) * u128::from(count(self.along, wide));
        if bytes == 0 || count.checked_mul(bytes.into()).is_none_or(|all| all > most.into()) {
            let expected = format!("chunks of {tall} x {wide} numbers in {} bytes", source.length());
            return Err(source.wrong(0, expected));
        }
        if chunks.len() as u128 > count {
            return Err(source.wrong(0, format!("{count} chunks at most, found {}", chunks.len())));
        }
        let shape @ [rows, columns] = raw.order.shape([self.lines, self.along]);
        let mut heights = undefined_heights(source, rows, columns)?;
        let wide = wide as usize;
        for chunk in chunks {
            let (line, at) = match chunk.offset[..] {
                [at, ..] if self.flat => (0, at),
                [line, at, ..] => (line, at),
                _ => return Err(source.wrong(chunk.address, "coordinates of a chunk")),
            };
            if line >= self.lines as u64 || at >= self.along as u64 {
                // Left over from before the data set was made smaller.
                continue;
            }
            let (line, at) = (line as usize, at as usize);
            let unpacked = self.unpacked(source, chunk, bytes, size)?;
            let taken = wide.min(self.along - at);
            for (i, row) in unpacked.chunks_exact(wide * size).take(self.lines - line).enumerate() {
                for (k, number) in row.chunks_exact(size).take(taken).enumerate() {
                    let place = [line + i, at + k];
                    let (cell, height) = raw.placed(source, shape, place, number)?;
                    heights[cell] = height;
                }
            }
        }
        Ok(heights)
    }

    /// The numbers of a chunk.
    fn unpacked(
        &self,
        source: &mut OpenedFile<'_>,
        chunk: &Chunk,
        bytes: u64,
        size: usize,
    ) -> Result<Vec<u8>> {
        let mut data = source.bytes(chunk.address, chunk.storage_size)?;
        for (i, filter) in self.filters.iter().enumerate().rev() {
            if i < 32 && chunk.filter_mask >> i & 1 == 1 {
                continue;
            }
            match *filter {
                FLETCHER32 => data.truncate(data.len().saturating_sub(4)),
                SHUFFLE => data = unshuffled(&data, size),
                _ => {
                    let mut plain = Vec::new();
                    // A checksum may stand behind the numbers.
                    let read = ZlibDecoder::new(&data[..]).take(bytes + 4).read_to_end(&mut plain);
                    read.map_err(|_| source.wrong(chunk.address, "a chunk packed by deflate"))?;
                    data = plain;
                }
            }
        }
        if data.len() as u64 != bytes {
            let expected = format!("a chunk of {bytes} bytes, it has {}", data.len());
            return Err(source.wrong(chunk.address, expected));
        }
        Ok(data)
    }
}

/// The bytes of each number together again: first come the first bytes of all, then the second ones.
fn unshuffled(data: &[u8], size: usize) -> Vec<u8> {
    let count = data.len() / size;
    let mut plain = vec![0; data.len()];
    for (i, &byte) in data.iter().enumerate() {
        let (of, which) = (i / count.max(1), i % count.max(1));
        // What does not fill a number stays at the end.
        let to = if of < size { which * size + of } else { i };
        plain[to] = byte;
    }
    plain
}
