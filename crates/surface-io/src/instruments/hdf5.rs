//! HDF5: every data set of two dimensions of numbers is a channel, named by its path.
//!
//! Sources: the HDF5 File Format Specification 3.0
//! (<https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html>), for the order of the axes the
//! HDF5 Dimension Scales and the Image and Palette specifications, for packed values the NetCDF attribute
//! conventions.
//!
//! - **Order.** The attribute `DIMENSION_LABELS` of a data set decides, or the names of its dimension scales,
//!   as [`crate::array`] takes them, or `CLASS = "IMAGE"` (rows first). A data set without any has x first, as
//!   SurfaceTopography and MATLAB write it, which is noted; [`crate::Axes`] `yx` takes the first index for y.
//!   The first row is y = 0.
//! - **Unit.** The attribute `unit` or `units` of the data set, nothing else. `none` are plain numbers.
//!   Integers with a unit of length and without a scale are counts of an unknown height:
//!   [`crate::ReadOptions::height_scale`] says it.
//! - **Size.** The attribute `size` of two numbers, along x and y, beside `size_unit`, which this crate
//!   writes, or the coordinates in dimension scales.
//! - **Values.** `scale_factor`, `add_offset`, `_FillValue`, `missing_value`, `_Unsigned` and `valid_range`
//!   (`valid_min`, `valid_max`) count as NetCDF defines them.
//! - **Undefined points.** NaN, fill values, chunks that were never written.
//!
//! Programs that write attributes of their own:
//!
//! - **JPK.** `encoder.scaling.multiplier`, `.offset` and `.unit.unit` of the group that holds a data set:
//!   height = multiplier x number + offset. The conversion sets are not applied. In a measurement with a grid
//!   of points (`position-pattern.grid`) a data set has a line for each point and a column for each frame, and
//!   each frame is a channel; data sets without a unit of their own (thumbnails, indices) are no heights.
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
mod scales;
mod storage;
mod vendor;
mod write;

pub use write::hdf5;

use super::prelude::*;
use crate::array::{Array, ArrayDimension, Numbers};
use crate::channel::{FileAxes, check_number};
use crate::options::Axes;
use crate::source::Budget;
use attributes::{Attributes, LABELS, SIZE, SIZE_UNIT, UNIT, describe, text, written};
use hdf5_pure::{Dataset, File, ReadSeekSource};
use scales::DimensionScale;
use std::collections::{HashSet, VecDeque};
use std::sync::Arc;
use storage::{DataLocation, layout, number_type, unreadable};
use vendor::JpkGrid;

/// Groups inside groups, and objects, that are looked at: links may form loops.
const DEEPEST: usize = 8;
const MOST: usize = 1000;
/// Limits of the bytes that are read for the metadata of a file, per byte of the file and in addition: the
/// strings of many attributes may be the same string of a heap.
const REREAD: u64 = 4;
const LEAST: u64 = 16 << 20;
/// Data sets that are named in an error.
const NAMED: usize = 20;

pub(crate) const READER: Reader =
    Reader { format: Format::Hdf5, recognises: super::magic::is_hdf5, channels };

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let budget = Budget::new(source.length().saturating_mul(REREAD).saturating_add(LEAST));
    let input = ReadSeekSource::new(source.detached(&budget)?).map_err(|e| unreadable(source, &e))?;
    let file = File::from_source(input).map_err(|e| unreadable(source, &e))?;
    let mut channels = Vec::new();
    let mut taken = HashSet::new();
    let (mut scales, mut others) = (Vec::new(), Vec::new());
    let mut seen = 0;
    // Level by level, so that what has two names gets its shorter one.
    let mut waiting: VecDeque<_> = [(String::new(), file.root(), 0, None)].into();
    while let Some((path, group, depth, grid)) = waiting.pop_front() {
        let beside = group.attrs().unwrap_or_default();
        let grid = JpkGrid::of(&beside).or(grid);
        let datasets = group.iter_datasets().map_err(|e| unreadable(source, &e))?;
        let datasets: Vec<_> = datasets.take(MOST).collect();
        for (name, dataset) in &datasets {
            scales::collect(&mut scales, source, (&path, name), dataset);
        }
        for (name, dataset) in datasets {
            seen += 1;
            let name = join(&path, &name);
            let beside = FileStatements { path: &path, attributes: &beside, scales: &scales, grid };
            match of_dataset(source, &dataset, &beside, &name, &mut taken) {
                Ok(found) if found.is_empty() && others.len() < NAMED => others.push(shown(&dataset, &name)),
                Ok(found) => channels.extend(found),
                Err(error) => channels.push(StoredChannel::listed(Some(name), Err(error))?),
            }
            check_number(source, 0, channels.len())?;
            if budget.is_spent() {
                let expected = "metadata that do not name the same bytes again and again";
                return Err(source.wrong(0, expected));
            }
        }
        if depth < DEEPEST {
            for (name, inner) in group.iter_groups().map_err(|e| unreadable(source, &e))? {
                seen += 1;
                waiting.push_back((join(&path, &name), inner, depth + 1, grid));
            }
        }
        if seen > MOST {
            return Err(source.wrong(0, format!("{MOST} groups and data sets at most")));
        }
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    if channels.is_empty() {
        let found = if others.is_empty() { "none".to_owned() } else { others.join(", ") };
        let deep = others.iter().any(|shown| shown.matches(" x ").count() > 1);
        let remedy = if deep { "; of three dimensions write one map alone, such as data[0]" } else { "" };
        let expected = format!("a data set of numbers of two dimensions, the data sets are {found}{remedy}");
        return Err(source.wrong(0, expected));
    }
    Ok(channels)
}

/// Name and shape of a data set, for people.
fn shown(dataset: &Dataset, name: &str) -> String {
    let shape: Vec<String> = dataset.shape().unwrap_or_default().iter().map(u64::to_string).collect();
    format!("{name} ({})", shape.join(" x ")).chars().take(80).collect()
}

fn join(path: &str, name: &str) -> String {
    let joined = if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
    joined.chars().take(200).collect()
}

/// The statements of the file outside of a data set that concern it.
struct FileStatements<'a> {
    /// Path and attributes of its group.
    path: &'a str,
    attributes: &'a Attributes,
    /// Those of its group and of the groups before.
    scales: &'a [DimensionScale],
    /// JPK's, of its group or of one before.
    grid: Option<JpkGrid>,
}

/// The channels of a data set: none for those that are no map, several of a video.
fn of_dataset(
    source: &OpenedFile<'_>,
    dataset: &Dataset,
    beside: &FileStatements<'_>,
    name: &str,
    taken: &mut HashSet<u64>,
) -> Result<Vec<StoredChannel>> {
    let shape = dataset.shape().map_err(|e| unreadable(source, &e))?;
    let [first, second] = shape[..] else { return Ok(Vec::new()) };
    let datatype = dataset.datatype().map_err(|e| unreadable(source, &e))?;
    let Some(number) = number_type(&datatype) else { return Ok(Vec::new()) };
    if first == 0 || second == 0 {
        return Ok(Vec::new());
    }
    let attributes = dataset.attrs().map_err(|e| unreadable(source, &e))?;
    let matlab = text(&attributes, "MATLAB_class");
    if matlab == Some("char") || (matlab.is_some() && (first, second) == (1, 1)) {
        return Ok(Vec::new());
    }
    let dimensions = [first, second].map(|length| ArrayDimension::of_length(length as usize));
    let custom = "as SurfaceTopography and MATLAB write it, no label says it";
    let mut array = Array::new(name, dimensions, number, (FileAxes::Assumed(Axes::Xy), custom));
    let described = describe(&mut array, &attributes)
        .and_then(|()| vendor::describe(&mut array, dataset, beside.attributes, &attributes));
    described.map_err(|expected| source.wrong(0, expected))?;
    scales::name(&mut array, beside.scales, beside.path, dataset, &attributes);
    let Some((address, found)) = layout(source, dataset, name, number, [first, second])? else {
        return Ok(Vec::new());
    };
    if address.is_some_and(|address| !taken.insert(address)) {
        return Ok(Vec::new());
    }
    if let Some(grid) = beside.grid {
        if written(&attributes).is_none() {
            array.unit = StoredUnit::NoHeights(None);
        } else if grid.columns.checked_mul(grid.rows) == Some(array.dimensions[0].length) {
            return frames(source, &array, found, grid);
        }
    }
    let numbers = match found {
        DataLocation::Stored(bytes) => Numbers::Stored(bytes),
        DataLocation::Chunked(pieces) => {
            Numbers::Decoded(", in chunks", Box::new(move |raw, source| pieces.read(raw, source)))
        }
        DataLocation::Unread(said) => {
            // The other channels of the file are read all the same.
            Numbers::Decoded("", Box::new(move |_, source| Err(unreadable(source, &said))))
        }
    };
    Ok(vec![array.channel(source, numbers)?])
}

/// A channel of each frame of a scan, whose points stand one below the other.
fn frames(
    source: &OpenedFile<'_>,
    array: &Array,
    found: DataLocation,
    grid: JpkGrid,
) -> Result<Vec<StoredChannel>> {
    let JpkGrid { columns, rows, extent, turned } = grid;
    let found = Arc::new(found);
    let [points, count] = [0, 1].map(|i| array.dimensions[i].length);
    check_number(source, 0, count)?;
    let dimension = |(name, length): (&str, usize)| ArrayDimension {
        name: name.to_owned(),
        ..ArrayDimension::of_length(length)
    };
    let frame = |frame: usize| {
        let name = if count > 1 { format!("{} frame {frame}", array.name) } else { array.name.clone() };
        let dimensions = [("y", rows), ("x", columns)].map(dimension);
        let mut notes = array.notes.clone();
        if turned {
            notes.push("the grid of the scan is turned or reflected, which is not used".into());
        }
        let (unit, undefined) = (array.unit.clone(), array.undefined);
        let Array { number, custom, scale, shift, unsigned, valid, .. } = *array;
        let plain = Array::new(&name, dimensions, number, custom);
        let one = Array { unsigned, valid, unit, scale, shift, undefined, extent, notes, ..plain };
        let found = Arc::clone(&found);
        let read = move |raw: &RawHeights, source: &mut OpenedFile<'_>| {
            let all = found.read(raw, source, [points, count])?;
            Ok(all.into_iter().skip(frame).step_by(count).collect())
        };
        one.channel(source, Numbers::Decoded(", of points of frames", Box::new(read)))
    };
    (0..count).map(frame).collect()
}
