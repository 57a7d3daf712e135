//! Attributes of HDF5, which define the meaning of the numbers in a data set.

use crate::array::{Array, unsigned, valid};
use crate::channel::{StoredUnit, Undefined};
use crate::extent::Extent;
use crate::quantity::{Dimension, Quantity, Unit};
use hdf5_pure::AttrValue;
use std::collections::HashMap;

pub(super) type Attributes = HashMap<String, AttrValue>;

/// Attributes that this crate writes and reads.
pub(super) const UNIT: &str = "unit";
pub(super) const SIZE: &str = "size";
pub(super) const SIZE_UNIT: &str = "size_unit";
pub(super) const LABELS: &str = "DIMENSION_LABELS";

/// A text, alone or as the only one of an array.
pub(super) fn text<'a>(attributes: &'a Attributes, key: &str) -> Option<&'a str> {
    let value = attributes.get(key)?;
    let only = || match value.as_strings()? {
        [one] => Some(one.as_str()),
        _ => None,
    };
    value.as_str().or_else(only)
}

/// The unit as it is written.
pub(super) fn written(attributes: &Attributes) -> Option<&str> {
    text(attributes, UNIT).or_else(|| text(attributes, "units")).map(str::trim)
}

pub(super) fn unit(attributes: &Attributes) -> StoredUnit {
    match written(attributes) {
        None => StoredUnit::Unknown,
        Some("none") => StoredUnit::Heights(Unit::none()),
        Some(text) => StoredUnit::written(text),
    }
}

/// What is written as numbers of any type.
pub(super) fn numbers(attributes: &Attributes, key: &str) -> Option<Vec<f64>> {
    let value = attributes.get(key)?;
    let integers = || value.to_i64s().map(|all| all.into_iter().map(|n| n as f64).collect());
    value.to_f64s().or_else(integers)
}

/// A number, where there is one; an error says what was expected.
pub(super) fn number(attributes: &Attributes, key: &str) -> std::result::Result<Option<f64>, String> {
    if !attributes.contains_key(key) {
        return Ok(None);
    }
    // Left out, heights would be others than those that are meant.
    match numbers(attributes, key).as_deref() {
        Some(&[number]) => Ok(Some(number)),
        _ => Err(format!("one number as the attribute {key}")),
    }
}

/// Takes the attributes that every program may write: unit, size, packing and marks as NetCDF defines them.
pub(super) fn describe(array: &mut Array, attributes: &Attributes) -> std::result::Result<(), String> {
    let of = |key: &str| number(attributes, key);
    array.undefined = Undefined::either(of("_FillValue")?, of("missing_value")?);
    (array.scale, array.shift) = (of("scale_factor")?, of("add_offset")?);
    array.unsigned = unsigned(text(attributes, "_Unsigned").unwrap_or_default())?;
    let range = match (attributes.contains_key("valid_range"), numbers(attributes, "valid_range")) {
        (true, None) => return Err("two numbers as valid_range".to_owned()),
        (_, range) => range,
    };
    array.valid = valid(range.as_deref(), [of("valid_min")?, of("valid_max")?])?;
    array.unit = unit(attributes);
    array.extent = extent(attributes);
    Ok(())
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
