//! Dimension scales: the names of dimensions of a data set, and the coordinates along them.
//!
//! `DIMENSION_LIST` holds references to the scales of each dimension, which the crate hdf5-pure does not give.
//! The numbers that NetCDF-4 writes in addition (`_Netcdf4Dimid`, `_Netcdf4Coordinates`) say the same. Without
//! them a scale belongs to a dimension where it alone has its length; of several nothing is taken, and a note
//! tells it.

use super::attributes::{Attributes, LABELS, describe, numbers, text, written};
use super::storage::{layout, number_type};
use crate::array::{Array, ArrayDimension, Coordinates};
use crate::channel::{Bytes, FileAxes, RawHeights};
use crate::error::Result;
use crate::options::Axes;
use crate::source::OpenedFile;
use hdf5_pure::{AttrValue, Dataset};

/// How NetCDF-4 marks a scale without coordinates.
const NO_VARIABLE: &str = "This is a netCDF dimension but not a netCDF variable";
/// Most scales that are kept.
const MOST: usize = 200;

/// A dimension with a name, and the group for which it counts.
pub(super) struct DimensionScale {
    group: String,
    /// The number that NetCDF-4 gives it.
    id: Option<f64>,
    dimension: ArrayDimension,
    /// Why its coordinates are not read.
    unread: Option<String>,
}

/// Adds a data set to the scales, where it is one that can be read.
pub(super) fn collect(
    scales: &mut Vec<DimensionScale>,
    source: &mut OpenedFile<'_>,
    (group, name): (&str, &str),
    dataset: &Dataset,
) {
    let (Ok(shape), Ok(attributes)) = (dataset.shape(), dataset.attrs()) else { return };
    let [length] = shape[..] else { return };
    if text(&attributes, "CLASS") != Some("DIMENSION_SCALE") || scales.len() == MOST {
        return;
    }
    let role = ["axis", "standard_name"].iter().find_map(|key| text(&attributes, key)).unwrap_or_default();
    let name = name.rsplit('/').next().unwrap_or(name).to_owned();
    let mut dimension =
        ArrayDimension { name, role: role.to_owned(), ..ArrayDimension::of_length(length as usize) };
    let mut unread = None;
    if !text(&attributes, "NAME").is_some_and(|name| name.starts_with(NO_VARIABLE)) {
        // One that cannot be read is a name only, and the size is asked for.
        match coordinates(source, dataset, length, &attributes) {
            Ok(found) => dimension.coordinates = found,
            Err(error) => unread = error.problem().map(ToString::to_string),
        }
    }
    let id = numbers(&attributes, "_Netcdf4Dimid").and_then(|all| all.first().copied());
    scales.push(DimensionScale { group: group.to_owned(), id, dimension, unread });
}

fn coordinates(
    source: &mut OpenedFile<'_>,
    dataset: &Dataset,
    length: u64,
    attributes: &Attributes,
) -> Result<Option<Coordinates>> {
    let Some(number) = dataset.datatype().ok().and_then(|datatype| number_type(&datatype)) else {
        return Ok(None);
    };
    let found = layout(source, dataset, "coordinates", number, [1, length])?;
    let Some((_, numbers)) = found.filter(|_| length > 0) else { return Ok(None) };
    let dimensions = [1, length as usize].map(ArrayDimension::of_length);
    let mut array = Array::new("", dimensions, number, (FileAxes::Fixed, ""));
    if describe(&mut array, attributes).is_err() {
        return Ok(None);
    }
    let (scale, shift) = (array.scale.unwrap_or(1.0), array.shift.unwrap_or(0.0));
    let raw = RawHeights { scale, shift, ..RawHeights::new(Bytes::Held(Vec::new()), number) };
    let values = numbers.read(&raw, source, [1, length as usize])?;
    Ok(Coordinates::new(&values, number, written(attributes).unwrap_or_default()))
}

/// Names the dimensions of an array by its labels and scales.
pub(super) fn name(
    array: &mut Array,
    scales: &[DimensionScale],
    group: &str,
    dataset: &Dataset,
    attributes: &Attributes,
) {
    let labels = attributes.get(LABELS).and_then(AttrValue::as_strings).filter(|labels| labels.len() == 2);
    let ids = numbers(attributes, "_Netcdf4Coordinates").filter(|ids| ids.len() == 2);
    let attached = dataset.attr_datatypes().is_ok_and(|types| types.contains_key("DIMENSION_LIST"));
    let above = |scale: &&DimensionScale| {
        let rest = group.strip_prefix(&scale.group);
        rest.is_some_and(|rest| scale.group.is_empty() || rest.is_empty() || rest.starts_with('/'))
    };
    let lengths = [0, 1].map(|i| array.dimensions[i].length);
    let mut several = attached && ids.is_none() && lengths[0] == lengths[1];
    for i in 0..2 {
        let fits = scales.iter().filter(above).filter(|scale| scale.dimension.length == lengths[i]);
        let mut fits = fits.filter(|scale| match &ids {
            Some(ids) => scale.id.is_some_and(|id| (id - ids[i]).abs() < 0.5),
            None => attached,
        });
        match (fits.next(), fits.next()) {
            (Some(scale), None) if !several => {
                array.dimensions[i] = scale.dimension.clone();
                let note = |why| format!("coordinates {} are not read: {why}", scale.dimension.name);
                array.notes.extend(scale.unread.as_ref().map(note));
            }
            (Some(_), Some(_)) => several = true,
            _ => {}
        }
        if let Some(label) = labels.map(|labels| &labels[i]).filter(|label| !label.is_empty()) {
            array.dimensions[i].name.clone_from(label);
        }
    }
    let why = if several {
        "as the conventions have it, the scales of dimensions of one length are not told apart"
    } else {
        "as the conventions have it, the dimensions have other names than x and y"
    };
    if text(attributes, "CLASS") == Some("IMAGE") {
        array.custom = (FileAxes::Said(Axes::Yx), "");
    } else if several
        || array.dimensions.iter().any(|dimension| labels.is_none() && !dimension.name.is_empty())
    {
        array.custom = (FileAxes::Assumed(Axes::Yx), why);
    }
}
