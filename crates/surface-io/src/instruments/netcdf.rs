//! NetCDF-3 (CDF-1, CDF-2, CDF-5) as contact.engineering and `SurfaceTopography` write it: a variable
//! `heights(x, y)`.
//!
//! After "The NetCDF Classic Format Specification"
//! (<https://docs.unidata.ucar.edu/nug/current/file_format_specifications.html>) and `IO/NC.py` of
//! SurfaceTopography. The last index runs fastest: of `heights(x, y)` that is y, so the file goes column by
//! column; row j is y = j * cell; `heights(y, x)` is read too. Dimensions of other names are taken for y and
//! x, as the CF conventions order them; [`crate::Axes`] `xy` takes the first for x. The attribute `length` of
//! the variables `x` and `y` is the side, their attribute `unit` (or `units`) its unit, that of `heights` the
//! unit of the heights. Undefined points are NaN, the values of the attributes `_FillValue` and
//! `missing_value`, the library's own fill value in floats without the former, and points where a variable
//! `mask` is not 0. `scale_factor` and `add_offset` are applied after that, as the conventions say.
//!
//! Own code: `netcdf3` 0.6 reserves memory for as many dimensions as a file claims, reads whole variables and
//! no CDF-5. Not read: line scans, a dimension without a limit, NetCDF-4 (an HDF5 file).

mod write;

pub use write::netcdf;

use super::prelude::*;
use crate::channel::FileAxes;
use crate::options::Axes;

const MAGIC: &[u8] = b"CDF";
/// What the library writes where nothing was written, as double and as float.
const FILL: f64 = f64::from_bits(0x479e_0000_0000_0000);

pub(crate) const READER: Reader = Reader {
    format: Format::NetCdf,
    recognises: |start, _| start.starts_with(MAGIC) && matches!(start.get(3), Some(1 | 2 | 5)),
    channels,
};

/// What is kept of a variable.
#[derive(Debug, Default)]
struct Variable {
    /// Numbers of its dimensions; of more than two, two.
    dimensions: Vec<u64>,
    rank: u64,
    number: Option<NumberType>,
    offset: u64,
    attributes: Attributes,
}

/// What is kept of its attributes.
#[derive(Debug, Default)]
struct Attributes {
    unit: Option<String>,
    length: Option<f64>,
    fill: Option<f64>,
    missing: Option<f64>,
    scale: Option<f64>,
    shift: Option<f64>,
}

/// The variables that are looked for.
const NAMES: [&str; 4] = ["heights", "mask", "x", "y"];

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let mut header = Header::new(source)?;
    let dimensions = header.dimensions()?;
    header.attributes(&mut Attributes::default())?;
    let [heights, mask, x, y] = header.variables()?;
    let Some(heights) = heights else {
        return Err(source.wrong(0, "a variable called heights"));
    };
    let wrong = |source: &Source<'_>, expected: &str| Err(source.wrong(heights.offset, expected));
    let named = |number: &u64| {
        let at = usize::try_from(*number).ok()?;
        dimensions.get(at).map(|(name, length)| (name.as_str(), *length as usize))
    };
    let of: Vec<_> = heights.dimensions.iter().filter_map(named).collect();
    let (axes, [first, second]) = match (of.as_slice(), heights.rank) {
        ([("x", columns), ("y", rows)], 2) => (FileAxes::Said(Axes::Xy), [*columns, *rows]),
        ([("y", rows), ("x", columns)], 2) => (FileAxes::Said(Axes::Yx), [*rows, *columns]),
        ([(first, rows), (second, columns)], 2)
            if ![first, second].iter().any(|n| ["x", "y"].contains(n)) =>
        {
            (FileAxes::Assumed(Axes::Yx), [*rows, *columns])
        }
        _ => return wrong(source, "heights over the dimensions x and y, or over two of other names"),
    };
    let order = axes.order();
    let shape = order.shape([first, second]);
    let Some(number) = heights.number else {
        return wrong(source, "heights that are numbers");
    };
    let attributes = &heights.attributes;
    let (scale, shift) = (attributes.scale.unwrap_or(1.0), attributes.shift.unwrap_or(0.0));
    let own = if number.is_float() { Some(FILL) } else { None };
    let undefined = match [attributes.fill.or(own), attributes.missing] {
        [Some(fill), Some(missing)] => Undefined::Either(fill, missing),
        [Some(mark), None] | [None, Some(mark)] => Undefined::Equal(mark),
        [None, None] => Undefined::None,
    };
    let raw = RawHeights { order, scale, shift, undefined, ..RawHeights::at(heights.offset, number) };
    let side = |variable: Option<Variable>| {
        let Attributes { unit, length, .. } = variable?.attributes;
        Extent::of_side(length?, &unit?)
    };
    let unit = StoredUnit::written(heights.attributes.unit.as_deref().unwrap_or_default());
    let extent = [side(x), side(y)];
    let mut channel = match mask {
        None => StoredChannel::new(source, raw, shape, unit, extent)?,
        Some(Variable { dimensions, rank: 2, number: Some(number), offset, .. })
            if dimensions == heights.dimensions =>
        {
            let mask = RawHeights { order, ..RawHeights::at(offset, number) };
            StoredChannel::masked(source, raw, (mask, "masked points undefined"), shape, unit, extent)?
        }
        Some(_) => return wrong(source, "a mask over the same dimensions as heights"),
    };
    channel.check_counts(number, attributes.scale.is_some());
    channel.take_axes(axes, "as the conventions have it, the dimensions have other names than x and y");
    Ok(vec![channel.named("heights")])
}

/// The header, read from its beginning to its end.
struct Header<'s, 'a> {
    file: Cursor<'s, 'a>,
    version: u8,
}

impl<'s, 'a> Header<'s, 'a> {
    fn new(source: &'s mut Source<'a>) -> Result<Self> {
        let version = source.get(ByteOrder::Big, 3)?;
        let mut header = Self { file: Cursor::new(source, ByteOrder::Big, 4), version };
        // The number of records.
        header.count()?;
        Ok(header)
    }

    fn u32(&mut self) -> Result<u64> {
        self.file.get::<u32>().map(u64::from)
    }

    /// How many there are of something.
    fn count(&mut self) -> Result<u64> {
        if self.version == 5 { self.file.get() } else { self.u32() }
    }

    /// The length of a list that begins with this mark, 0 where there is no list.
    fn list(&mut self, mark: u64) -> Result<u64> {
        let at = self.file.at;
        let (found, count) = (self.u32()?, self.count()?);
        if found == mark || (found, count) == (0, 0) {
            return Ok(count);
        }
        Err(self.file.source.wrong(at, format!("a list with the mark {mark}, found {found}")))
    }

    /// Passes bytes that are filled up to a multiple of four.
    fn pass(&mut self, length: u64) -> Result<()> {
        let end = self.file.source.length();
        self.file.pass(length.checked_next_multiple_of(4).unwrap_or(u64::MAX), end)
    }

    fn text(&mut self, length: u64) -> Result<String> {
        let at = self.file.at;
        let text = decoded(self.file.take(length)?);
        self.file.at = at;
        self.pass(length)?;
        Ok(text.trim_matches(['\0', ' ']).to_owned())
    }

    fn name(&mut self) -> Result<String> {
        let length = self.count()?;
        self.text(length)
    }

    fn dimensions(&mut self) -> Result<Vec<(String, u64)>> {
        let mut found = Vec::new();
        for _ in 0..self.list(10)? {
            found.push((self.name()?, self.count()?));
        }
        Ok(found)
    }

    fn attributes(&mut self, keep: &mut Attributes) -> Result<()> {
        for _ in 0..self.list(12)? {
            let name = self.name()?;
            let (kind, count) = (self.u32()?, self.count()?);
            let size = self.size(kind)?;
            let length = size.checked_mul(count).ok_or_else(|| self.file.wrong("fewer values"))?;
            if kind == 2 && matches!(name.as_str(), "unit" | "units") {
                keep.unit = Some(self.text(length)?);
                continue;
            }
            let at = self.file.at;
            let target = match name.as_str() {
                "length" => Some(&mut keep.length),
                "_FillValue" => Some(&mut keep.fill),
                "missing_value" => Some(&mut keep.missing),
                "scale_factor" => Some(&mut keep.scale),
                "add_offset" => Some(&mut keep.shift),
                _ => None,
            };
            if let Some(target) = target {
                // Left out, heights would be others than those that are meant.
                let (Some(number), 1) = (number(kind), count) else {
                    return Err(self.file.wrong(format!("one number as {name}")));
                };
                let value = number.big_endian().decode(self.file.take(size)?);
                *target = Some(
                    value.map_err(|_| self.file.wrong(format!("a number as {name} that a double holds")))?,
                );
                self.file.at = at;
            }
            self.pass(length)?;
        }
        Ok(())
    }

    /// The variables of [`NAMES`].
    fn variables(&mut self) -> Result<[Option<Variable>; 4]> {
        let mut found = [const { None }; 4];
        for _ in 0..self.list(11)? {
            let name = self.name()?;
            let mut variable = Variable { rank: self.count()?, ..Variable::default() };
            for i in 0..variable.rank {
                let dimension = self.count()?;
                if i < 2 {
                    variable.dimensions.push(dimension);
                }
            }
            self.attributes(&mut variable.attributes)?;
            let kind = self.u32()?;
            self.size(kind)?;
            variable.number = number(kind);
            self.count()?;
            variable.offset = if self.version == 1 { self.u32()? } else { self.file.get()? };
            if let Some(at) = NAMES.iter().position(|known| *known == name) {
                found[at] = Some(variable);
            }
        }
        Ok(found)
    }

    /// Bytes of one value.
    fn size(&self, kind: u64) -> Result<u64> {
        match (kind, number(kind)) {
            (2, _) => Ok(1),
            (_, Some(number)) => Ok(number.bytes() as u64),
            _ => Err(self.file.wrong(format!("a type of values from 1 to 11 before this, found {kind}"))),
        }
    }
}

/// The type of numbers; `None` for characters and what does not exist.
fn number(kind: u64) -> Option<NumberType> {
    const TYPES: [&str; 12] = ["", "i1", "", "i2", "i4", "f4", "f8", "u1", "u2", "u4", "i8", "u8"];
    NumberType::of_code(kind, &TYPES, ByteOrder::Big)
}
