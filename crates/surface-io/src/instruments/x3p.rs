//! X3P, the XML container of ISO 25178-72 (before: ISO 5436-2): an archive of `main.xml`, the numbers and a
//! checksum.
//!
//! After the openGPS library (<https://github.com/aschet/x3p>: `iso5436_2_container.cxx`,
//! `valid_buffer.cxx`), Gwyddion's `opengps.c` and the notes of x3pio on the standard
//! (<https://github.com/aschet/x3pio>, `docs/format.md`). All lengths are metres. Numbers run along x first,
//! then along y: row j is y = j * increment, upwards, as in this crate. A height is increment * number +
//! offset; the increment is 1 where none is given. I and L are signed integers of 16 and 32 bits, F and D
//! floats.
//!
//! Undefined points are NaN, infinities, empty in a list of numbers in `main.xml`, or zero bits of the member
//! that `ValidPointsLink` names (lowest bit first). Read: surfaces (`SUR`) on a regular grid in one layer.
//! Not read: profiles, clouds of points, irregular grids, several layers, a third axis that points downwards;
//! another rotation is noted and not applied. An increment beside floats leaves the unit open. Damage shows
//! in the checksums of the archive; MD5 is not compared, as `SurfaceTopography` gives that of another member.

mod main_xml;
mod write;

pub use write::x3p;

use super::magic::{self, MAIN};
use super::prelude::*;
use crate::error::Error;
use crate::zip::{self, Member};
use main_xml::{Main, X3pAxis};

/// Bytes of it: a description has a few thousand, a list of a million heights as text about this many. It is
/// unpacked as a whole.
const LONGEST: u64 = 16 << 20;

pub(crate) const READER: Reader = Reader { format: Format::X3p, recognises: magic::is_archive, channels };

/// Where the numbers are.
enum X3pNumbers {
    /// In a member, with another one for the points that are defined.
    Linked { data: Member, valid: Option<Member>, number: NumberType },
    /// In `main.xml`.
    Listed(Member),
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let members = zip::members(source)?;
    let Some(main_member) = magic::main_member(&members) else {
        return Err(source.content(zip::refused(&members)));
    };
    let text = main_member.unpack_text(source, LONGEST)?;
    let Some(main) = Main::read(&text) else {
        return Err(source.content(zip::refused(&members)));
    };
    drop(text);
    let container = X3pContainer { members: &members, main_member, main };
    let (shape, number) = described(&container.main).map_err(|e| wrong(source, main_member, &e))?;
    let rotation = rotated(&container.main.rotation).map_err(|e| wrong(source, main_member, &e))?;
    let scale = container.scale(source, number)?;
    let mut details = RawHeights::new(Bytes::Held(Vec::new()), number).details();
    let numbers = container.numbers(source, shape, number)?;
    details += match &numbers {
        X3pNumbers::Listed(_) => ", as text",
        X3pNumbers::Linked { valid: Some(_), .. } => ", with a mask",
        X3pNumbers::Linked { valid: None, .. } => "",
    };
    let [x, y, _] = &container.main.axes;
    let extent = [x.cell(), y.cell()];
    let factors = (scale.scale, scale.shift);
    let read = move |source: &mut OpenedFile<'_>| numbers.read(source, shape, factors);
    let [columns, rows] = shape;
    let channel = StoredChannel::deferred(details, [rows, columns], scale.unit, extent, read);
    let notes = rotation.into_iter().chain(scale.note).collect();
    Ok(vec![StoredChannel { notes, ..channel }])
}

/// A description and the archive that it is in.
struct X3pContainer<'a> {
    members: &'a [Member],
    main_member: &'a Member,
    main: Main,
}

/// What makes heights of numbers.
struct X3pScale {
    scale: f64,
    shift: f64,
    unit: StoredUnit,
    note: Option<String>,
}

impl X3pContainer<'_> {
    /// The increment and the offset along z.
    fn scale(&self, source: &OpenedFile<'_>, number: NumberType) -> Result<X3pScale> {
        let [.., z] = &self.main.axes;
        let (scale, shift) = (length(&z.increment, 1.0), length(&z.offset, 0.0));
        let (Some(scale), Some(shift)) = (scale.filter(|scale| scale.abs() > 0.0), shift) else {
            let expected = "an increment along z other than 0, and an offset";
            return Err(wrong(source, self.main_member, expected));
        };
        // The schema gives an increment to integers only, and readers disagree whether floats are multiplied
        // by it.
        let disputed = number.is_float() && (scale - 1.0).abs() > 0.0;
        if !disputed {
            return Ok(X3pScale { scale, shift, unit: StoredUnit::written("m"), note: None });
        }
        let increment = &z.increment;
        let note = format!(
            "heights are floats, which are metres, beside an increment of {increment}, by which some readers multiply them: say \
             height_scale = \"1 m\" or height_scale = \"{increment} m\""
        );
        Ok(X3pScale { scale: 1.0, shift, unit: StoredUnit::Unknown, note: Some(note) })
    }

    /// Where the numbers are, and as many of them as there are points.
    fn numbers(
        &self,
        source: &mut OpenedFile<'_>,
        [columns, rows]: [usize; 2],
        number: NumberType,
    ) -> Result<X3pNumbers> {
        let count = rows as u64 * columns as u64;
        if self.main.data.is_empty() {
            if self.main.listed != count {
                let found = self.main.listed;
                let expected = format!("{columns} x {rows} numbers or a link to them, found {found}");
                return Err(wrong(source, self.main_member, &expected));
            }
            return Ok(X3pNumbers::Listed(self.main_member.clone()));
        }
        let Some(data) = self.member(&self.main.data) else {
            return Err(wrong(source, self.main_member, "PointDataLink with the name of a member"));
        };
        sized(source, &data, count.checked_mul(number.bytes() as u64))?;
        if self.main.valid.is_empty() {
            return Ok(X3pNumbers::Linked { data, valid: None, number });
        }
        let Some(bits) = self.member(&self.main.valid) else {
            return Err(wrong(source, self.main_member, "ValidPointsLink with the name of a member"));
        };
        sized(source, &bits, Some(count.div_ceil(8)))?;
        Ok(X3pNumbers::Linked { data, valid: Some(bits), number })
    }

    /// The member of a link, which counts from the folder of the description.
    fn member(&self, link: &str) -> Option<Member> {
        let folder = &self.main_member.name[..self.main_member.name.len() - MAIN.len()];
        let name = format!("{folder}{}", link.replace('\\', "/").trim_start_matches("./"));
        self.members.iter().find(|member| member.name == name).cloned()
    }
}

fn wrong(source: &OpenedFile<'_>, main: &Member, expected: &str) -> Error {
    source.wrong(main.offset(), format!("in main.xml {expected}"))
}

/// Columns, rows and the type of numbers of a surface that is read.
fn described(main: &Main) -> Result<([usize; 2], NumberType), String> {
    let is = |what: &str, found: &str, expected: &str| {
        let same = found.eq_ignore_ascii_case(expected);
        same.then_some(()).ok_or_else(|| format!("{what} {expected}, found {found:?}"))
    };
    is("a surface, FeatureType", &main.feature, "SUR")?;
    let [x, y, z] = &main.axes;
    is("a regular grid, AxisType of x", &x.kind, "I")?;
    is("a regular grid, AxisType of y", &y.kind, "I")?;
    is("AxisType of z", &z.kind, "A")?;
    let number = match z.number.as_str() {
        "I" => NumberType::I16,
        "L" => NumberType::I32,
        "F" => NumberType::F32,
        "D" => NumberType::F64,
        other => return Err(format!("DataType of z I, L, F or D, found {other:?}")),
    };
    is("one layer, SizeZ", &main.sizes[2], "1")?;
    let size = |text: &String| text.parse::<usize>().map_err(|_| format!("SizeX and SizeY, found {text:?}"));
    let [columns, rows] = [size(&main.sizes[0])?, size(&main.sizes[1])?];
    match columns.checked_mul(rows) {
        None | Some(0) => Err(format!("a surface of at least one point, found {columns} x {rows}")),
        Some(_) => Ok(([columns, rows], number)),
    }
}

/// What is said of the rotation of the axes, which is not applied.
///
/// # Errors
/// What is expected instead of a third axis that does not point out of the surface.
fn rotated(rotation: &[String; 9]) -> Result<Option<String>, String> {
    let of =
        |i: usize, j: usize| length(&rotation[3 * i + j], if i == j { 1.0 } else { 0.0 }).unwrap_or(f64::NAN);
    let off =
        (0..9).map(|k| (of(k / 3, k % 3) - if k % 4 == 0 { 1.0 } else { 0.0 }).abs()).fold(0.0, f64::max);
    if of(2, 2).is_nan() || of(2, 2) < 0.5 {
        return Err(format!(
            "a third axis that points out of the surface, r33 is {} (hills would be valleys: turn the surface and write it anew)",
            of(2, 2)
        ));
    }
    let angle = of(1, 0).atan2(of(0, 0)).to_degrees();
    let said = format!(
        "the file says that its axes are rotated (by {angle:.4} degrees from x to y), which is not applied"
    );
    Ok((off > 1e-6 || off.is_nan()).then_some(said))
}

/// A number, or what is meant where there is none; `None` where it is no number.
fn length(text: &str, absent: f64) -> Option<f64> {
    let number = if text.is_empty() { Some(absent) } else { text.parse().ok() };
    number.filter(|number: &f64| number.is_finite())
}

impl X3pAxis {
    /// The side of a cell, where the increment is one.
    fn cell(&self) -> Option<Extent> {
        Extent::of_cell(length(&self.increment, 0.0)?, "m")
    }
}

/// An error where a member has another length, or cannot have it.
fn sized(source: &mut OpenedFile<'_>, member: &Member, bytes: Option<u64>) -> Result<()> {
    if bytes != Some(member.unpacked()) {
        let bytes = bytes.map_or("more".to_owned(), |bytes| bytes.to_string());
        let expected =
            format!("a member of {bytes} bytes for these rows and columns, found {}", member.unpacked());
        return Err(source.wrong(member.offset(), expected));
    }
    member.packed(source).map(drop)
}

impl X3pNumbers {
    /// `height = scale * number + shift`, row by row.
    fn read(
        &self,
        source: &mut OpenedFile<'_>,
        [columns, rows]: [usize; 2],
        (scale, shift): (f64, f64),
    ) -> Result<Vec<f64>> {
        match self {
            Self::Linked { data, valid, number } => {
                let bytes = Bytes::Held(data.unpack(source)?);
                let raw = RawHeights { scale, shift, ..RawHeights::new(bytes, *number) };
                let mut heights = raw.read(source, rows, columns)?;
                drop(raw);
                // Writers put infinities where nothing was measured.
                heights.iter_mut().filter(|h| h.is_infinite()).for_each(|h| *h = f64::NAN);
                let Some(valid) = valid else { return Ok(heights) };
                let bits = valid.unpack(source)?;
                for (i, height) in heights.iter_mut().enumerate() {
                    if bits.get(i / 8).is_none_or(|byte| byte >> (i % 8) & 1 == 0) {
                        *height = f64::NAN;
                    }
                }
                Ok(heights)
            }
            Self::Listed(main) => {
                let text = main.unpack_text(source, LONGEST)?;
                let (mut heights, mut others) = (source.room(rows * columns)?, 0);
                main_xml::listed(&text, &mut |number| match number {
                    Some(number) => heights.push(scale * number + shift),
                    None => others += 1,
                });
                if others > 0 {
                    return Err(wrong(source, main, &format!("numbers only, {others} are none")));
                }
                Ok(heights)
            }
        }
    }
}
