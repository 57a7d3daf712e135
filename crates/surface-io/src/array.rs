//! Arrays as containers describe them (HDF5, NetCDF, TIFF), and the map that an array is.
//!
//! A container hands over what it states: names of the dimensions, coordinates along them, unit, scale,
//! marks of undefined points, signedness, a mask. [`Array::channel`] alone decides what these statements
//! mean, so that they mean the same in every format.
//!
//! - **Order.** Names of the dimensions decide (`x`, `lon`, `easting`, ... and `y`, `lat`, `northing`, ...).
//!   Without such names the custom of the format holds, which is noted.
//! - **Size.** Sides that the file states count first. Otherwise coordinates in equal steps give the side of
//!   a cell where they have a unit of length; degrees and plain numbers are noted, and the size is asked for.
//! - **Direction.** Descending coordinates turn their axis round, so that x and y ascend.
//! - **Refused** are coordinates in unequal steps, and dimensions of which only one is x or y.

use crate::channel::{Bytes, FileAxes, MaskedHeights, RawHeights, StoredChannel, StoredUnit, Undefined};
use crate::error::Result;
use crate::extent::Extent;
use crate::number_type::NumberType;
use crate::options::Axes;
use crate::source::OpenedFile;
use contact_model::units::number;

/// An array of two dimensions as its container describes it.
pub(crate) struct Array {
    pub(crate) name: String,
    /// Slower and faster index.
    pub(crate) dimensions: [ArrayDimension; 2],
    /// The order of the axes where no dimension has a name of one, and why.
    pub(crate) custom: (FileAxes, &'static str),
    pub(crate) number: NumberType,
    /// Whether integers count as unsigned ones, whatever their type: NetCDF-3 has no unsigned types.
    pub(crate) unsigned: Option<bool>,
    /// The lowest and the highest number that is a height, before the scale.
    pub(crate) valid: [Option<f64>; 2],
    pub(crate) unit: StoredUnit,
    pub(crate) scale: Option<f64>,
    pub(crate) shift: Option<f64>,
    pub(crate) undefined: Undefined,
    /// Sides along x and y that the file states.
    pub(crate) extent: [Option<Extent>; 2],
    /// Whether the first number along x, along y is that of the last column, the last row.
    pub(crate) reversed: [bool; 2],
    /// Numbers of the same shape and order, not 0 at undefined points.
    pub(crate) mask: Option<RawHeights>,
    pub(crate) notes: Vec<String>,
}

/// A dimension of an array.
#[derive(Debug, Clone, Default)]
pub(crate) struct ArrayDimension {
    /// As the file has it, empty for none.
    pub(crate) name: String,
    /// A second name, of what it is: `axis` or `standard_name` of its coordinates.
    pub(crate) role: String,
    pub(crate) length: usize,
    pub(crate) coordinates: Option<Coordinates>,
}

/// Coordinates along a dimension.
#[derive(Debug, Clone)]
pub(crate) struct Coordinates {
    /// First and last one.
    ends: [f64; 2],
    count: usize,
    /// The first that is off equal steps, and its number.
    uneven: Option<(usize, f64)>,
    /// As written, empty for none.
    unit: String,
}

/// Where the numbers of an array are.
pub(crate) enum Numbers {
    Stored(Bytes),
    /// A reader decodes them, and [`RawHeights`] makes heights of them; with a detail for people.
    Decoded(&'static str, Box<Decode>),
}

type Decode = dyn Fn(&RawHeights, &mut OpenedFile<'_>) -> Result<Vec<f64>> + Send + Sync;

/// Names of dimensions along x and along y, in lower case.
const NAMES: [&[&str]; 2] = [
    &[
        "x",
        "lon",
        "long",
        "lng",
        "longitude",
        "easting",
        "col",
        "column",
        "columns",
        "projection_x_coordinate",
    ],
    &["y", "lat", "latitude", "northing", "row", "rows", "projection_y_coordinate"],
];

/// The axis that a name says: 0 for x, 1 for y.
pub(crate) fn axis_of(name: &str) -> Option<usize> {
    let name = name.trim().to_lowercase();
    NAMES.iter().position(|names| names.contains(&name.as_str()))
}

impl Coordinates {
    /// Coordinates of a type of numbers, where there are any.
    pub(crate) fn new(values: &[f64], of: NumberType, unit: &str) -> Option<Self> {
        /// Coordinates are printed and rounded: part of a step by which one may be off.
        const PRINTED: f64 = 0.01;
        let (&first, &last) = (values.first()?, values.last()?);
        let step = (last - first) / (values.len() - 1).max(1) as f64;
        let rounding = if of.is_float() && of.bytes() < 8 { f64::from(f32::EPSILON) } else { f64::EPSILON };
        let most = PRINTED * step.abs() + rounding * first.abs().max(last.abs());
        let even = |&(i, value): &(usize, f64)| (value - first - i as f64 * step).abs() <= most;
        let uneven = values.iter().copied().enumerate().find(|of| !even(of));
        // A step below the rounding of the coordinates is none.
        let none = (values.len() > 1 && step.abs() <= 2.0 * rounding * first.abs()).then_some((1, last));
        let unit = unit.trim().chars().take(32).collect();
        Some(Self { ends: [first, last], count: values.len(), uneven: uneven.or(none), unit })
    }

    /// The side of a cell, signed.
    fn step(&self) -> f64 {
        (self.ends[1] - self.ends[0]) / (self.count - 1).max(1) as f64
    }
}

/// The attribute `_Unsigned` of a container, `true` or `false` in any case of the letters; `None` for an empty
/// text.
///
/// # Errors
/// A message that says what was expected, for other texts.
pub(crate) fn unsigned(text: &str) -> std::result::Result<Option<bool>, String> {
    match text.trim().to_lowercase().as_str() {
        "" => Ok(None),
        "true" => Ok(Some(true)),
        "false" => Ok(Some(false)),
        _ => {
            Err(format!("true or false as _Unsigned, found {:?}", text.chars().take(32).collect::<String>()))
        }
    }
}

/// The lowest and the highest number that is a height, by the attributes `valid_range`, `valid_min` and
/// `valid_max`.
///
/// # Errors
/// A message that says what was expected, where a range has not two numbers or stands beside one of its ends.
pub(crate) fn valid(
    range: Option<&[f64]>,
    ends: [Option<f64>; 2],
) -> std::result::Result<[Option<f64>; 2], String> {
    match (range, ends) {
        (None, ends) => Ok(ends),
        (Some(&[low, high]), [None, None]) => Ok([Some(low), Some(high)]),
        (Some([_, _]), _) => Err("valid_range, or valid_min and valid_max, not both".to_owned()),
        (Some(other), _) => Err(format!("two numbers as valid_range, found {}", other.len())),
    }
}

impl ArrayDimension {
    pub(crate) fn of_length(length: usize) -> Self {
        Self { length, ..Self::default() }
    }

    /// The axis that its name says: 0 for x, 1 for y.
    fn axis(&self) -> Option<usize> {
        axis_of(&self.role).or_else(|| axis_of(&self.name))
    }
}

impl Array {
    /// An array without any statement, whose axes are in an order that its format has or that is the custom.
    pub(crate) fn new(
        name: &str,
        dimensions: [ArrayDimension; 2],
        number: NumberType,
        custom: (FileAxes, &'static str),
    ) -> Self {
        Self {
            name: name.to_owned(),
            dimensions,
            custom,
            number,
            unsigned: None,
            valid: [None; 2],
            unit: StoredUnit::Unknown,
            scale: None,
            shift: None,
            undefined: Undefined::None,
            extent: [None; 2],
            reversed: [false; 2],
            mask: None,
            notes: Vec::new(),
        }
    }

    /// The order of the axes.
    fn axes(&self, source: &OpenedFile<'_>) -> Result<FileAxes> {
        let [first, second] = &self.dimensions;
        match (first.axis(), second.axis()) {
            (None, None) => Ok(self.custom.0),
            (Some(0), Some(1)) => Ok(FileAxes::Said(Axes::Xy)),
            (Some(1), Some(0)) => Ok(FileAxes::Said(Axes::Yx)),
            (Some(0), None) if second.name.is_empty() => Ok(FileAxes::Said(Axes::Xy)),
            (None, Some(1)) if first.name.is_empty() => Ok(FileAxes::Said(Axes::Xy)),
            (Some(1), None) if second.name.is_empty() => Ok(FileAxes::Said(Axes::Yx)),
            (None, Some(0)) if first.name.is_empty() => Ok(FileAxes::Said(Axes::Yx)),
            _ => {
                let (name, [a, b]) = (&self.name, [first, second].map(|dimension| &dimension.name));
                let expected = "over the dimensions x and y, or over two of other names";
                Err(source.wrong(0, format!("{name} {expected}, found {a} and {b}")))
            }
        }
    }

    /// Takes the direction of one axis from its coordinates, and the side of a cell where the file states no
    /// other and where it is known which axis this is.
    fn place(&mut self, source: &OpenedFile<'_>, index: usize, axis: usize, said: bool) -> Result<()> {
        let dimension = &self.dimensions[index];
        let (name, length) = (&dimension.name, dimension.length);
        let Some(found) = dimension.coordinates.as_ref().filter(|_| self.extent[axis].is_none()) else {
            return Ok(());
        };
        if found.count != length {
            let expected = format!("{length} coordinates {name}, found {}", found.count);
            return Err(source.wrong(0, expected));
        }
        if let Some((i, value)) = found.uneven {
            let expected = format!(
                "coordinates {name} in equal steps, number {i} is {} (unequal ones are not resampled)",
                number(value)
            );
            return Err(source.wrong(0, expected));
        }
        if length < 2 {
            return Ok(());
        }
        let (step, [from, to]) = (found.step(), found.ends);
        let unit = &found.unit;
        let all = format!("{} to {} {unit}", number(from), number(to));
        let side = Extent::of_cell(step.abs(), unit);
        let note = match side {
            Some(_) if said => format!("sides along {name} by its coordinates, {}", all.trim()),
            Some(_) => {
                format!("the file has coordinates {name}, {all}, and no name says which axis they are of")
            }
            None => {
                let kind = if unit.is_empty() { "which have no unit" } else { "which are no length" };
                format!("the file has coordinates {name}, {}, {kind}: size or cell says it", all.trim())
            }
        };
        let descending = step < 0.0;
        self.notes.push(note);
        if descending {
            self.notes.push(format!("{name} descends in the file, and ascends here"));
        }
        self.reversed[axis] ^= descending;
        self.extent[axis] = side.filter(|_| said);
        Ok(())
    }

    /// Numbers as signed or unsigned ones, as the file says.
    fn take_sign(&mut self) {
        let Some(unsigned) = self.unsigned.filter(|_| !self.number.is_float()) else { return };
        let number = self.number.with_sign(!unsigned);
        if number != self.number {
            self.notes.push(format!("the file says that its {} are {}", self.number.name(), number.name()));
            // A mark is a number of the type that it had.
            self.undefined = self.undefined.map(|mark| number.wrapped(mark));
            self.valid = self.valid.map(|end| end.map(|end| number.wrapped(end)));
            self.number = number;
        }
    }

    /// The map of this array.
    ///
    /// # Errors
    /// Where statements of the file contradict each other, or where heights would be other ones without a
    /// statement that is not understood.
    pub(crate) fn channel(mut self, source: &OpenedFile<'_>, numbers: Numbers) -> Result<StoredChannel> {
        let axes = self.axes(source)?;
        let order = axes.order();
        let said = !matches!(axes, FileAxes::Assumed(_));
        let [y, x] = order.shape([0, 1]);
        self.place(source, x, 0, said)?;
        self.place(source, y, 1, said)?;
        self.take_sign();
        let shape = order.shape([self.dimensions[0].length, self.dimensions[1].length]);
        source.check_cells(shape)?;
        let Self { reversed, undefined, extent, unit, number, valid, .. } = self;
        let valid = [valid[0].unwrap_or(f64::NEG_INFINITY), valid[1].unwrap_or(f64::INFINITY)];
        let (scale, shift) = (self.scale.unwrap_or(1.0), self.shift.unwrap_or(0.0));
        let raw = |bytes| RawHeights {
            order,
            reversed,
            scale,
            shift,
            undefined,
            valid,
            ..RawHeights::new(bytes, number)
        };
        let mut channel = match (numbers, self.mask) {
            (Numbers::Stored(bytes), None) => StoredChannel::new(source, raw(bytes), shape, unit, extent)?,
            (Numbers::Stored(bytes), Some(mask)) => {
                let mask = RawHeights { order, reversed, ..mask };
                let masked = MaskedHeights { raw: raw(bytes), mask, detail: "masked points undefined" };
                StoredChannel::masked(source, masked, shape, unit, extent)?
            }
            (Numbers::Decoded(detail, read), _) => {
                let raw = raw(Bytes::Held(Vec::new()));
                raw.check_scale(source)?;
                let (details, compared) = (format!("{}{detail}", raw.details()), raw.compared());
                let channel =
                    StoredChannel::deferred(details, shape, unit, extent, move |source| read(&raw, source));
                StoredChannel { compared, ..channel }
            }
        };
        channel.take_axes(axes, self.custom.1);
        channel.notes.extend(self.notes);
        channel.check_counts(number, self.scale.is_some());
        Ok(channel.named(&self.name))
    }
}
