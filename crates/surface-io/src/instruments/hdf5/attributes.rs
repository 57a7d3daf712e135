//! Attributes of HDF5, which define the meaning of the numbers in a data set.

use crate::channel::{StoredUnit, Undefined};
use crate::options::Axes;
use crate::quantity::Unit;
use hdf5_pure::AttrValue;
use std::collections::HashMap;

pub(super) type Attributes = HashMap<String, AttrValue>;

/// The attribute of the unit, which this crate writes too.
pub(super) const UNIT: &str = "unit";

/// What the numbers of a data set stand for.
pub(super) struct Values {
    pub(super) scale: f64,
    pub(super) shift: f64,
    pub(super) undefined: Undefined,
    pub(super) unit: StoredUnit,
    /// Whether the file gives a scale.
    pub(super) scaled: bool,
    /// Order of the axes where no label says it, and why.
    pub(super) axes: Axes,
    pub(super) custom: &'static str,
    pub(super) notes: Vec<String>,
}

/// A text, alone or as the only one of an array.
pub(super) fn text<'a>(attributes: &'a Attributes, key: &str) -> Option<&'a str> {
    let value = attributes.get(key)?;
    let only = || match value.as_strings()? {
        [one] => Some(one.as_str()),
        _ => None,
    };
    value.as_str().or_else(only)
}

pub(super) fn unit(attributes: &Attributes) -> StoredUnit {
    match text(attributes, UNIT).or_else(|| text(attributes, "units")).map(str::trim) {
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

/// What is packed or marked as NetCDF defines it.
pub(super) fn packed(attributes: &Attributes) -> std::result::Result<Values, String> {
    let of = |key: &str| number(attributes, key);
    let mark = of("_FillValue")?.or(of("missing_value")?);
    let scale = of("scale_factor")?;
    Ok(Values {
        scale: scale.unwrap_or(1.0),
        shift: of("add_offset")?.unwrap_or(0.0),
        undefined: mark.map_or(Undefined::None, Undefined::Equal),
        unit: StoredUnit::Unknown,
        scaled: scale.is_some(),
        axes: Axes::Xy,
        custom: "as SurfaceTopography and MATLAB write it, no label says it",
        notes: Vec::new(),
    })
}
