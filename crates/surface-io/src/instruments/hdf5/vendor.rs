//! Attributes of single programs, which define the meaning of the numbers in their data sets.

use super::attributes::{Attributes, number, text};
use crate::array::Array;
use crate::channel::{FileAxes, StoredUnit, Undefined};
use crate::extent::Extent;
use crate::options::Axes;
use hdf5_pure::Dataset;

/// JPK's scaling, in the attributes of the group that holds a data set.
const JPK: &str = "encoder.scaling";

/// JPK's grid of points, in the attributes of a measurement. A data set in it has a line for each point and a
/// column for each frame of a video.
#[derive(Clone, Copy)]
pub(super) struct JpkGrid {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) extent: [Option<Extent>; 2],
    /// Whether the grid is turned or mirrored, which is not used.
    pub(super) turned: bool,
}

impl JpkGrid {
    /// `None` where a group has none.
    pub(super) fn of(attributes: &Attributes) -> Option<Self> {
        let key = |key: &str| format!("position-pattern.grid.{key}");
        let of = |name: &str| number(attributes, &key(name)).ok().flatten();
        let count =
            |name: &str| of(name).filter(|count| (1.0..1e9).contains(count)).map(|count| count as usize);
        let unit = text(attributes, &key("unit.unit")).unwrap_or_default();
        let side = |name: &str| Extent::of_side(of(name)?, unit);
        Some(Self {
            columns: count("ilength")?,
            rows: count("jlength")?,
            extent: [side("ulength"), side("vlength")],
            turned: of("theta").is_some_and(|angle| angle.abs() > 0.0)
                || text(attributes, &key("reflect")) == Some("true"),
        })
    }
}

/// Adds what a program states beside its data set to the description of an array.
pub(super) fn describe(
    array: &mut Array,
    dataset: &Dataset,
    beside: &Attributes,
    attributes: &Attributes,
) -> Result<(), String> {
    if array.name.starts_with("Data/Surface/") && attributes.contains_key("No Data") {
        return zygo(array, dataset, attributes);
    }
    if array.name.starts_with("Data/Intensity/") {
        array.unit = StoredUnit::NoHeights(None);
    } else if beside.contains_key(&format!("{JPK}.multiplier")) {
        return jpk(array, beside);
    }
    Ok(())
}

/// Height = multiplier x number + offset, in the unit of the encoder.
fn jpk(array: &mut Array, beside: &Attributes) -> Result<(), String> {
    let of = |key: &str| number(beside, &format!("{JPK}.{key}"));
    if array.scale.is_some() {
        return Err(format!("one scale of the heights, found scale_factor and {JPK}.multiplier"));
    }
    let (scale, shift) = (of("multiplier")?.unwrap_or(1.0), of("offset")?.unwrap_or(0.0));
    (array.scale, array.shift) = (Some(scale), Some(shift));
    if let Some(unit) = text(beside, &format!("{JPK}.unit.unit")) {
        array.unit = StoredUnit::written(unit);
    }
    array.notes.push(format!("heights by {JPK} of the group: {scale:e} times the number and {shift:e}"));
    Ok(())
}

/// Lengths, or fringes of a wavelength; rows first.
fn zygo(array: &mut Array, dataset: &Dataset, attributes: &Attributes) -> Result<(), String> {
    let of = |key: &str| number(attributes, key)?.ok_or_else(|| format!("one number as the attribute {key}"));
    let mut scale = 1.0;
    let unit = match text(attributes, "Unit").unwrap_or_default() {
        "Fringes" => {
            scale = of("Wavelength")? * of("Interferometric Scale Factor")? * of("Obliquity Factor")?;
            "m"
        }
        other => other,
    };
    if dataset.attr_datatypes().is_ok_and(|types| types.contains_key("X Converter")) {
        let note = "the file has the sides of a cell in X Converter and Y Converter, which are not read";
        array.notes.push(note.into());
    }
    (array.scale, array.unit) = (Some(scale), StoredUnit::written(unit));
    array.undefined = Undefined::AtLeast(of("No Data")?);
    let custom = "as prysm reads the files of Zygo, no label says it";
    array.custom = (FileAxes::Assumed(Axes::Yx), custom);
    Ok(())
}
