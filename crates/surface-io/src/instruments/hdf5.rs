//! HDF5: every data set of two dimensions of numbers is a channel, named by its path.
//!
//! Sources: the HDF5 File Format Specification 3.0
//! (<https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html>), for the order of the axes the
//! HDF5 Dimension Scales and the Image and Palette specifications, for packed values the NetCDF attribute
//! conventions.
//!
//! - **Order.** The attribute `DIMENSION_LABELS` of a data set decides (`y`, `x` or `x`, `y`), or
//!   `CLASS = "IMAGE"` (rows first). A data set without either has x first, as SurfaceTopography and MATLAB
//!   write it, which is noted; [`crate::Axes`] `yx` takes the first index for y. The first row is y = 0.
//! - **Unit.** The attribute `unit` or `units` of the data set, nothing else. `none` are plain numbers.
//!   Integers with a unit of length and without a scale are counts of an unknown height:
//!   [`crate::ReadOptions::height_scale`] says it.
//! - **Size.** The attribute `size` of two numbers, along x and y, beside `size_unit`; this crate writes
//!   them. HDF5 itself has no size.
//! - **Values.** `scale_factor`, `add_offset`, `_FillValue` and `missing_value` count as NetCDF defines them.
//! - **Undefined points.** NaN, fill values, chunks that were never written.
//!
//! Programs that write attributes of their own:
//!
//! - **JPK.** `encoder.scaling.multiplier`, `.offset` and `.unit.unit` of the group that holds a data set:
//!   height = multiplier x number + offset. The conversion sets are not applied.
//! - **MATLAB 7.3.** A matrix of rows and columns stands as columns and rows. Text and scalars are passed.
//! - **Zygo's DATX** (`Data/Surface/...`, after prysm's `read_zygo_datx` and `IO/DATX.py` of
//!   SurfaceTopography). Height = number in `Unit`, of `Fringes` number x `Wavelength` x
//!   `Interferometric Scale Factor` x `Obliquity Factor` in m; numbers from `No Data` on are undefined;
//!   intensities are no heights. Rows first, as prysm has it; SurfaceTopography takes the first index for x.
//!   The sides of a cell stand in `X Converter` and `Y Converter`, records of texts and of a list of numbers,
//!   which the crate hdf5-pure does not give: the size is unknown, and a note tells it.
//!
//! A data set that cannot be read is listed with its reason. Read are the layouts compact, contiguous and
//! chunked (deflate, shuffle, Fletcher-32, which is not checked); not read are other filters (LZF, SZIP,
//! scale-offset, ZFP), chunks indexed by a B-tree of version 2, data layouts of HDF5 2.0 (version 5), virtual
//! data sets and data in other files, links to which are passed.
//!
//! The crate hdf5-pure reads the metadata; its own reading of chunks allocates what a damaged header claims
//! (4 GB for a file of 4 kB), so numbers are decoded here.

mod attributes;
mod vendor;
mod write;

pub use write::hdf5;

use super::prelude::*;
use crate::channel::{FileAxes, undefined_heights};
use crate::inflate::RATIO;
use crate::options::Axes;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::source::Budget;
use attributes::{Attributes, UNIT, Values, numbers, packed, text, unit};
use flate2::read::ZlibDecoder;
use hdf5_pure::{
    AttrValue, Chunk, Dataset, Datatype, DatatypeByteOrder, File, FloatingPointLayout, Group, Layout,
    ReadSeekSource,
};
use std::collections::{HashSet, VecDeque};
use std::io::Read as _;

/// Groups inside groups, and objects, that are looked at: links may form loops.
const DEEPEST: usize = 8;
const MOST: usize = 1000;
/// Limits of the bytes that are read for the metadata of a file, per byte of the file and in addition: the
/// strings of many attributes may be the same string of a heap.
const REREAD: u64 = 4;
const LEAST: u64 = 16 << 20;
const DEFLATE: u16 = 1;
const SHUFFLE: u16 = 2;
const FLETCHER32: u16 = 3;

/// Attributes that this crate writes and reads.
const SIZE: &str = "size";
const SIZE_UNIT: &str = "size_unit";
const LABELS: &str = "DIMENSION_LABELS";

pub(crate) const READER: Reader =
    Reader { format: Format::Hdf5, recognises: super::magic::is_hdf5, channels };

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let budget = Budget::new(source.length().saturating_mul(REREAD).saturating_add(LEAST));
    let input = ReadSeekSource::new(source.detached(&budget)?).map_err(|e| unreadable(source, &e))?;
    let file = File::from_source(input).map_err(|e| unreadable(source, &e))?;
    let mut channels = Vec::new();
    let mut taken = HashSet::new();
    let mut seen = 0;
    // Level by level, so that what has two names gets its shorter one.
    let mut waiting: VecDeque<(String, Group, usize)> = [(String::new(), file.root(), 0)].into();
    while let Some((path, group, depth)) = waiting.pop_front() {
        let beside = group.attrs().unwrap_or_default();
        for (name, dataset) in group.iter_datasets().map_err(|e| unreadable(source, &e))? {
            seen += 1;
            let name = join(&path, &name);
            if let Some(channel) = channel(source, &dataset, &beside, &name, &mut taken).transpose() {
                channels.push(StoredChannel::listed(Some(name), channel)?);
            }
            if budget.is_spent() {
                let expected = "metadata that do not name the same bytes again and again";
                return Err(source.wrong(0, expected));
            }
        }
        if depth < DEEPEST {
            for (name, inner) in group.iter_groups().map_err(|e| unreadable(source, &e))? {
                seen += 1;
                waiting.push_back((join(&path, &name), inner, depth + 1));
            }
        }
        if seen > MOST {
            return Err(source.wrong(0, format!("{MOST} groups and data sets at most")));
        }
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    if channels.is_empty() {
        return Err(source.wrong(0, "a data set of numbers of two dimensions"));
    }
    Ok(channels)
}

fn join(path: &str, name: &str) -> String {
    let joined = if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
    joined.chars().take(200).collect()
}

/// What the other crate says about the file.
fn unreadable(source: &Source<'_>, error: &dyn std::fmt::Display) -> crate::error::Error {
    let said: String = error.to_string().chars().take(200).collect();
    source.wrong(0, format!("a file as its specification has it ({said})"))
}

/// The channel of a data set; `None` for those that are no map.
fn channel(
    source: &Source<'_>,
    dataset: &Dataset,
    beside: &Attributes,
    name: &str,
    taken: &mut HashSet<u64>,
) -> Result<Option<StoredChannel>> {
    let shape = dataset.shape().map_err(|e| unreadable(source, &e))?;
    let [first, second] = shape[..] else { return Ok(None) };
    let datatype = dataset.datatype().map_err(|e| unreadable(source, &e))?;
    let Some(number) = number_type(&datatype) else { return Ok(None) };
    if first == 0 || second == 0 {
        return Ok(None);
    }
    let attributes = dataset.attrs().map_err(|e| unreadable(source, &e))?;
    let matlab = text(&attributes, "MATLAB_class");
    if matlab == Some("char") || (matlab.is_some() && (first, second) == (1, 1)) {
        return Ok(None);
    }
    let packed = packed(&attributes).map_err(|expected| source.wrong(0, expected))?;
    let values = match vendor::values(dataset, beside, name, &attributes) {
        Some(values) => values.map_err(|expected| source.wrong(0, expected))?,
        None => Values { unit: unit(&attributes), ..packed },
    };
    let axes = axes(&attributes).unwrap_or(FileAxes::Assumed(values.axes));
    let order = axes.order();
    let (lines, along) = (first, second);
    let claimed = number.bytes_of([lines, along]);
    let most = RATIO.saturating_mul(source.length());
    if claimed.is_none_or(|claimed| claimed > most) {
        let expected = format!("{name} of {first} x {second} numbers in at most {most} bytes");
        return Err(source.wrong(0, expected));
    }
    let (lines, along) = (lines as usize, along as usize);
    let shape = order.shape([lines, along]);
    let Values { scale, shift, undefined, .. } = values;
    let raw = |bytes| RawHeights { order, scale, shift, undefined, ..RawHeights::new(bytes, number) };
    let held = raw(Bytes::Held(Vec::new()));
    held.check_scale(source)?;
    let (unit, extent, compared) = (values.unit, extent(&attributes), held.compared());
    let mut channel = match dataset.layout() {
        Err(e) => {
            // The other channels of the file are read all the same.
            let said = e.to_string();
            let read = move |source: &mut Source<'_>| Err(unreadable(source, &said));
            StoredChannel::deferred(held.details(), shape, unit, extent, read)
        }
        Ok(Layout::Compact { .. }) => {
            let bytes = dataset.read_raw().map_err(|e| unreadable(source, &e))?;
            StoredChannel::new(source, raw(Bytes::Held(bytes)), shape, unit, extent)?
        }
        Ok(Layout::Contiguous { address: Some(address), .. }) => {
            if !taken.insert(address) {
                return Ok(None);
            }
            StoredChannel::new(source, raw(Bytes::File(address)), shape, unit, extent)?
        }
        Ok(Layout::Chunked { chunk_shape, .. }) => {
            let chunks = dataset.chunks().map_err(|e| e.to_string().chars().take(200).collect::<String>());
            if let Ok(Some(chunk)) = chunks.as_ref().map(|chunks| chunks.first())
                && !taken.insert(chunk.address)
            {
                return Ok(None);
            }
            let details = format!("{}, in chunks", held.details());
            let [a, b] = chunk_shape[..] else { return Ok(None) };
            let (name, filters) = (name.to_owned(), dataset.filters());
            let pieces = Pieces { name, raw: held, chunk: [a, b], filters, chunks, lines, along };
            StoredChannel::deferred(details, shape, unit, extent, move |source| pieces.read(source))
        }
        // Never written, in other files, or mapped from other data sets.
        Ok(_) => return Ok(None),
    };
    channel.compared = compared;
    channel.take_axes(axes, values.custom);
    channel.notes.extend(values.notes);
    channel.check_counts(number, values.scaled);
    Ok(Some(channel.named(name)))
}

/// Whole IEEE floats and integers; `None` for all else.
fn number_type(datatype: &Datatype) -> Option<NumberType> {
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

/// The order of the axes, where the file says it.
fn axes(attributes: &Attributes) -> Option<FileAxes> {
    if let Some([first, second]) = attributes.get(LABELS).and_then(AttrValue::as_strings) {
        match (first.as_str(), second.as_str()) {
            ("x", "y") => return Some(FileAxes::Said(Axes::Xy)),
            ("y", "x") => return Some(FileAxes::Said(Axes::Yx)),
            _ => {}
        }
    }
    (text(attributes, "CLASS") == Some("IMAGE")).then_some(FileAxes::Said(Axes::Yx))
}

fn extent(attributes: &Attributes) -> [Option<Extent>; 2] {
    let sides = || {
        let unit = attributes.get(SIZE_UNIT)?.as_str()?.parse::<Unit>().ok()?;
        let [x, y] = numbers(attributes, SIZE)?[..] else { return None };
        let known = unit.dimension() == Dimension::LENGTH || unit == Unit::none();
        let side = |side: f64| Quantity::of(side, &unit).ok().filter(|q| known && q.value() > 0.0);
        Some([Extent::Side(side(x)?), Extent::Side(side(y)?)])
    };
    sides().map_or([None; 2], |[x, y]| [Some(x), Some(y)])
}

/// A data set in chunks.
struct Pieces {
    name: String,
    raw: RawHeights,
    /// Lines and numbers along them of one chunk.
    chunk: [u64; 2],
    /// In the order in which they were applied.
    filters: Vec<u16>,
    chunks: std::result::Result<Vec<Chunk>, String>,
    lines: usize,
    along: usize,
}

impl Pieces {
    fn read(&self, source: &mut Source<'_>) -> Result<Vec<f64>> {
        let chunks = self.chunks.as_ref().map_err(|e| unreadable(source, e))?;
        if let Some(filter) = self.filters.iter().find(|f| !matches!(**f, DEFLATE | SHUFFLE | FLETCHER32)) {
            let expected = format!("{} packed by deflate or not at all, it has filter {filter}", self.name);
            return Err(source.wrong(0, expected));
        }
        let size = self.raw.number.bytes();
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
        let shape @ [rows, columns] = self.raw.order.shape([self.lines, self.along]);
        let mut heights = undefined_heights(source, rows, columns)?;
        let wide = wide as usize;
        for chunk in chunks {
            let (Some(&line), Some(&at)) = (chunk.offset.first(), chunk.offset.get(1)) else {
                return Err(source.wrong(chunk.address, "two coordinates of a chunk"));
            };
            if line >= self.lines as u64 || at >= self.along as u64 {
                // Left over from before the data set was made smaller.
                continue;
            }
            let (line, at) = (line as usize, at as usize);
            let unpacked = self.unpacked(source, chunk, bytes)?;
            let taken = wide.min(self.along - at);
            for (i, row) in unpacked.chunks_exact(wide * size).take(self.lines - line).enumerate() {
                for (k, raw) in row.chunks_exact(size).take(taken).enumerate() {
                    let place = [line + i, at + k];
                    let (cell, height) = self.raw.placed(source, shape, place, raw)?;
                    heights[cell] = height;
                }
            }
        }
        Ok(heights)
    }

    /// The numbers of a chunk.
    fn unpacked(&self, source: &mut Source<'_>, chunk: &Chunk, bytes: u64) -> Result<Vec<u8>> {
        let mut data = source.bytes(chunk.address, chunk.storage_size)?;
        for (i, filter) in self.filters.iter().enumerate().rev() {
            if i < 32 && chunk.filter_mask >> i & 1 == 1 {
                continue;
            }
            match *filter {
                FLETCHER32 => data.truncate(data.len().saturating_sub(4)),
                SHUFFLE => data = unshuffled(&data, self.raw.number.bytes()),
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
