//! Attributes of single programs, which define the meaning of the numbers in their data sets.

use super::attributes::{Attributes, Values, number, packed, text, unit};
use crate::channel::{StoredUnit, Undefined};
use crate::options::Axes;
use hdf5_pure::Dataset;

/// JPK's scaling, in the attributes of the group that holds a data set.
const JPK: &str = "encoder.scaling";

/// The values as a program writes them; `None` where there are none of its attributes.
pub(super) fn values(
    dataset: &Dataset,
    beside: &Attributes,
    path: &str,
    attributes: &Attributes,
) -> Option<Result<Values, String>> {
    if path.starts_with("Data/Surface/") && attributes.contains_key("No Data") {
        return Some(zygo(dataset, attributes));
    }
    if path.starts_with("Data/Intensity/") {
        return Some(packed(attributes).map(|values| Values { unit: StoredUnit::NoHeights(None), ..values }));
    }
    beside.contains_key(&format!("{JPK}.multiplier")).then(|| jpk(beside, attributes))
}

/// Height = multiplier x number + offset, in the unit of the encoder.
fn jpk(beside: &Attributes, attributes: &Attributes) -> Result<Values, String> {
    let of = |key: &str| number(beside, &format!("{JPK}.{key}"));
    let written = match text(beside, &format!("{JPK}.unit.unit")) {
        Some(unit) => StoredUnit::written(unit),
        None => unit(attributes),
    };
    let (scale, shift) = (of("multiplier")?.unwrap_or(1.0), of("offset")?.unwrap_or(0.0));
    let note = format!("heights by {JPK} of the group: {scale:e} times the number and {shift:e}");
    let values = packed(attributes)?;
    if values.scaled {
        return Err(format!("one scale of the heights, found scale_factor and {JPK}.multiplier"));
    }
    Ok(Values { scale, shift, unit: written, scaled: true, notes: vec![note], ..values })
}

/// Lengths, or fringes of a wavelength; rows first.
fn zygo(dataset: &Dataset, attributes: &Attributes) -> Result<Values, String> {
    let of = |key: &str| number(attributes, key)?.ok_or_else(|| format!("one number as the attribute {key}"));
    let (mut scale, written) = (1.0, text(attributes, "Unit").unwrap_or_default());
    let unit = match written {
        "Fringes" => {
            scale = of("Wavelength")? * of("Interferometric Scale Factor")? * of("Obliquity Factor")?;
            "m"
        }
        "NanoMeters" => "nm",
        "MicroMeters" => "um",
        "MilliMeters" => "mm",
        "Meters" => "m",
        other => other,
    };
    let mut notes = Vec::new();
    if dataset.attr_datatypes().is_ok_and(|types| types.contains_key("X Converter")) {
        notes.push(
            "the file has the sides of a cell in X Converter and Y Converter, which are not read".into(),
        );
    }
    Ok(Values {
        scale,
        undefined: Undefined::AtLeast(of("No Data")?),
        unit: StoredUnit::written(unit),
        scaled: true,
        axes: Axes::Yx,
        custom: "as prysm reads the files of Zygo, no label says it",
        notes,
        ..packed(attributes)?
    })
}
