//! NetCDF-3 (CDF-1, CDF-2, CDF-5): the variable `heights` where there is one, as contact.engineering and
//! `SurfaceTopography` write it, and else every variable of numbers over two dimensions.
//!
//! After "The NetCDF Classic Format Specification"
//! (<https://docs.unidata.ucar.edu/nug/current/file_format_specifications.html>) and `IO/NC.py` of
//! SurfaceTopography. The last index runs fastest: of `heights(x, y)` that is y, so the file goes column by
//! column. What names and coordinates of dimensions mean stands in [`crate::array`]; dimensions of other names
//! are taken for y and x, as the CF conventions order them. The attribute `length` of the variables `x` and
//! `y` is the side, their attribute `unit` (or `units`) its unit; variables without it are coordinates.
//! Undefined points are NaN, the values of the attributes `_FillValue` and `missing_value`, the library's own
//! fill value in floats without the former, and points of `heights` where a variable `mask` is not 0.
//! `scale_factor` and `add_offset` are applied after that, and `_Unsigned` before, as the conventions say.
//! Numbers outside of `valid_range` (or `valid_min` and `valid_max`) are undefined.
//!
//! Own code: `netcdf3` 0.6 reserves memory for as many dimensions as a file claims, reads whole variables and
//! no CDF-5. Not read: line scans, a dimension without a limit, NetCDF-4 (an HDF5 file).

mod write;

pub use write::netcdf;

use super::prelude::*;
use crate::array::{Array, ArrayDimension, Coordinates, Numbers, unsigned, valid};
use crate::channel::FileAxes;
use crate::options::Axes;

const MAGIC: &[u8] = b"CDF";
/// What the library writes where nothing was written, as double and as float.
const FILL: f64 = f64::from_bits(0x479e_0000_0000_0000);
/// Most variables that are looked at.
const MOST: usize = 1000;
/// Variables that are named in an error.
const NAMED: usize = 20;

pub(crate) const READER: Reader = Reader {
    format: Format::NetCdf,
    recognises: |start, _| start.starts_with(MAGIC) && matches!(start.get(3), Some(1 | 2 | 5)),
    channels,
};

/// What is kept of a variable.
#[derive(Debug, Default)]
struct Variable {
    name: String,
    /// Numbers of its dimensions; of more than two, two.
    dimensions: Vec<u64>,
    rank: u64,
    number: Option<NumberType>,
    offset: u64,
    attributes: NetcdfAttributes,
}

/// What is kept of its attributes.
#[derive(Debug, Default)]
struct NetcdfAttributes {
    unit: String,
    /// `axis` or `standard_name`: what coordinates are of.
    role: String,
    unsigned: String,
    length: Option<f64>,
    fill: Option<f64>,
    missing: Option<f64>,
    valid: [Option<f64>; 2],
    valid_range: Option<[f64; 2]>,
    scale: Option<f64>,
    shift: Option<f64>,
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let mut header = NetcdfHeader::new(source)?;
    let mut dimensions = header.dimensions()?;
    header.attributes(&mut NetcdfAttributes::default())?;
    let variables = header.variables()?;
    let over_two = |v: &&Variable| v.rank == 2 && v.number.is_some() && v.name != "mask";
    let maps: Vec<&Variable> = match variables.iter().find(|variable| variable.name == "heights") {
        Some(heights) => vec![heights],
        None => variables.iter().filter(over_two).collect(),
    };
    if maps.is_empty() {
        let named = variables.iter().take(NAMED).map(|variable| variable.shown(&dimensions));
        let found = if variables.is_empty() { vec!["none".to_owned()] } else { named.collect() };
        let expected = "a variable called heights, or one of numbers over two dimensions";
        let deep = variables.iter().any(|variable| variable.rank > 2);
        let remedy =
            if deep { "; of three dimensions write one map alone, such as isel(time=0)" } else { "" };
        return Err(source.wrong(0, format!("{expected}, its variables are {}{remedy}", found.join(", "))));
    }
    for dimension in &mut dimensions {
        let of = |v: &&Variable| v.rank == 1 && v.name == dimension.name;
        if let Some(variable) = variables.iter().find(of) {
            variable.along(source, dimension)?;
        }
    }
    let channel = |variable: &Variable| variable.channel(source, &dimensions, &variables);
    maps.into_iter()
        .map(|variable| StoredChannel::listed(Some(variable.name.clone()), channel(variable)))
        .collect()
}

impl Variable {
    /// Its name and its dimensions, for people.
    fn shown(&self, dimensions: &[ArrayDimension]) -> String {
        let named = |&number: &u64| dimensions.get(usize::try_from(number).ok()?);
        let mut names: Vec<&str> =
            self.dimensions.iter().filter_map(named).map(|d| d.name.as_str()).collect();
        if self.rank > 2 {
            names.push("...");
        }
        format!("{} ({})", self.name, names.join(", ")).chars().take(80).collect()
    }

    /// Puts the coordinates that it has into its dimension. One with a length has the size instead.
    fn along(&self, source: &mut OpenedFile<'_>, dimension: &mut ArrayDimension) -> Result<()> {
        let NetcdfAttributes { length: None, unit, role, scale, shift, .. } = &self.attributes else {
            return Ok(());
        };
        let (Some(number), 1..) = (self.number, dimension.length) else { return Ok(()) };
        let (scale, shift) = (scale.unwrap_or(1.0), shift.unwrap_or(0.0));
        let raw = RawHeights { scale, shift, ..RawHeights::at(self.offset, number) };
        let values = raw.read(source, 1, dimension.length)?;
        dimension.coordinates = Coordinates::new(&values, raw.compared(), unit);
        dimension.role.clone_from(role);
        Ok(())
    }

    fn channel(
        &self,
        source: &OpenedFile<'_>,
        dimensions: &[ArrayDimension],
        variables: &[Self],
    ) -> Result<StoredChannel> {
        let wrong = |expected: &str| source.wrong(self.offset, format!("{} {expected}", self.name));
        let named = |&number: &u64| dimensions.get(usize::try_from(number).ok()?).cloned();
        let of: Vec<ArrayDimension> = self.dimensions.iter().filter_map(named).collect();
        let (Ok(of), 2) = (<[ArrayDimension; 2]>::try_from(of), self.rank) else {
            return Err(wrong("over the dimensions x and y, or over two of other names"));
        };
        let number = self.number.ok_or_else(|| wrong("that are numbers"))?;
        let custom = "as the conventions have it, the dimensions have other names than x and y";
        let mut array = Array::new(&self.name, of, number, (FileAxes::Assumed(Axes::Yx), custom));
        let NetcdfAttributes { unit, fill, missing, scale, shift, .. } = &self.attributes;
        let own = if number.is_float() { Some(FILL) } else { None };
        array.undefined = Undefined::either(fill.or(own), *missing);
        (array.scale, array.shift, array.unit) = (*scale, *shift, StoredUnit::written(unit));
        let said =
            unsigned(&self.attributes.unsigned).map_err(|expected| wrong(&format!("with {expected}")))?;
        array.unsigned = said;
        let range = self.attributes.valid_range;
        let ends = valid(range.as_ref().map(|range| &range[..]), self.attributes.valid);
        array.valid = ends.map_err(|expected| wrong(&format!("with {expected}")))?;
        let variable = |name: &str| variables.iter().find(|variable| variable.name == name);
        array.extent = ["x", "y"].map(|name| {
            let NetcdfAttributes { unit, length, .. } = &variable(name)?.attributes;
            Extent::of_side((*length)?, unit).filter(|_| !unit.is_empty())
        });
        array.mask = match variable("mask").filter(|_| self.name == "heights") {
            None => None,
            Some(Self { dimensions, rank: 2, number: Some(number), offset, .. })
                if *dimensions == self.dimensions =>
            {
                Some(RawHeights::at(*offset, *number))
            }
            Some(_) => return Err(wrong("with a mask over the same dimensions")),
        };
        array.channel(source, Numbers::Stored(Bytes::File(self.offset)))
    }
}

/// The header, read from its beginning to its end.
struct NetcdfHeader<'s, 'a> {
    file: Cursor<'s, 'a>,
    version: u8,
}

impl<'s, 'a> NetcdfHeader<'s, 'a> {
    fn new(source: &'s mut OpenedFile<'a>) -> Result<Self> {
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

    fn dimensions(&mut self) -> Result<Vec<ArrayDimension>> {
        let mut found = Vec::new();
        for _ in 0..self.list(10)? {
            if found.len() == MOST {
                return Err(self.file.wrong(format!("{MOST} dimensions at most")));
            }
            let (name, length) = (self.name()?, self.count()? as usize);
            found.push(ArrayDimension { name, ..ArrayDimension::of_length(length) });
        }
        Ok(found)
    }

    fn attributes(&mut self, keep: &mut NetcdfAttributes) -> Result<()> {
        for _ in 0..self.list(12)? {
            let name = self.name()?;
            let (kind, count) = (self.u32()?, self.count()?);
            let size = self.size(kind)?;
            let length = size.checked_mul(count).ok_or_else(|| self.file.wrong("fewer values"))?;
            let text = match name.as_str() {
                "unit" | "units" => Some(&mut keep.unit),
                "axis" | "standard_name" => Some(&mut keep.role),
                "_Unsigned" => Some(&mut keep.unsigned),
                _ => None,
            };
            if let (Some(text), 2) = (text, kind) {
                *text = self.text(length)?;
                continue;
            }
            let at = self.file.at;
            if name == "valid_range" {
                let (Some(number), 2) = (number(kind), count) else {
                    return Err(self.file.wrong("two numbers as valid_range"));
                };
                let decode = |bytes: &[u8]| number.big_endian().decode(bytes).unwrap_or(f64::NAN);
                let bytes = self.file.take(length)?;
                keep.valid_range = Some([decode(&bytes[..number.bytes()]), decode(&bytes[number.bytes()..])]);
                self.file.at = at;
            }
            let target = match name.as_str() {
                "length" => Some(&mut keep.length),
                "_FillValue" => Some(&mut keep.fill),
                "missing_value" => Some(&mut keep.missing),
                "valid_min" => Some(&mut keep.valid[0]),
                "valid_max" => Some(&mut keep.valid[1]),
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

    fn variables(&mut self) -> Result<Vec<Variable>> {
        let mut found = Vec::new();
        for _ in 0..self.list(11)? {
            if found.len() == MOST {
                return Err(self.file.wrong(format!("{MOST} variables at most")));
            }
            let mut variable = Variable { name: self.name()?, rank: self.count()?, ..Variable::default() };
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
            found.push(variable);
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
