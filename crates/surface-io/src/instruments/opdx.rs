//! OPDx, of the stylus profilers Dektak of Bruker (`VCA DATA`): a tree of items, each with a name, a type and
//! a length.
//!
//! After Gwyddion's `dektakvca.c` and the reader of `SurfaceTopography` (`IO/OPDx.py`). A name has its length
//! in four bytes before it; the length of most types is a number of one, two or four bytes behind a byte that
//! says which. Read are the groups of `1D_Data` (a line of doubles, `Array`) and of `2D_Data` (a map of
//! floats row by row, `Matrix`; the first row is y = 0). Height = number x `DataScale`, whose unit is that of
//! the heights; NaN are undefined. A group is called by its name and its `DataKind`.
//!
//! - **Lines** are channels of one row, of which only the length along x is known. The cell is that of the
//!   places in `PositionFunction`, which must be equally spaced. `Extent` is the distance of the first from
//!   the last point, one cell less than the length that n cells have: a file of 3001 points has the places 0
//!   to 49.96669 µm and the `Extent` 49.96669 µm.
//! - **Maps**: `Dimension2Extent` is the side along x, `Dimension1Extent` that along y, as both programs have
//!   it.
//!
//! Not read: the settings of the measurement (`MetaData`), arrays of other numbers.

use super::prelude::*;

const MAGIC: &[u8] = b"VCA DATA\x01\x00\x00\x55";
const LITTLE: ByteOrder = ByteOrder::Little;
/// Differences of a place from its own on the grid, in cells.
const UNEVEN: f64 = 1e-3;

/// Most items of a group that are kept.
const MOST: usize = 1000;
const DATA: [&str; 2] = ["1D_Data", "2D_Data"];
/// Items of a group of data.
const WANTED: [&str; 8] = [
    "DataScale",
    "DataKind",
    "Array",
    "NumPoints",
    "PositionFunction",
    "Matrix",
    "Dimension1Extent",
    "Dimension2Extent",
];

const MATRIX: u8 = 0x00;
const UINT64: u8 = 0x0b;
const STRING: u8 = 0x12;
const QUANTITY: u8 = 0x13;
const DOUBLES: u8 = 0x40;
const UNNAMED_MATRIX: u8 = 0x45;
const LINE: u8 = 0x46;
const MAP: u8 = 0x47;
const POSITIONS: u8 = 0x7c;
const GROUP: u8 = 0x7d;
const END: u8 = 0x7f;

pub(crate) const READER: Reader =
    Reader { format: Format::Opdx, recognises: |start, _| start.starts_with(MAGIC), channels };

/// An item of the tree, and where its content is.
struct OpdxItem {
    name: String,
    kind: u8,
    begin: u64,
    end: u64,
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let mut found = Vec::new();
    let all = [MAGIC.len() as u64, source.length()];
    for data in items(source, all, |name, kind| kind == GROUP && DATA.contains(&name))? {
        for group in items(source, [data.begin, data.end], |_, kind| matches!(kind, GROUP | LINE | MAP))? {
            let channel = channel(source, &group);
            found.push(StoredChannel::listed(Some(group.name), channel)?);
            if found.len() > MOST {
                return Err(source.wrong(data.begin, format!("{MOST} groups of data at most")));
            }
        }
    }
    Ok(found)
}

/// The items that are wanted from an offset up to another one or to a mark of the end.
fn items(
    source: &mut OpenedFile<'_>,
    [begin, end]: [u64; 2],
    keep: impl Fn(&str, u8) -> bool,
) -> Result<Vec<OpdxItem>> {
    let mut found = Vec::new();
    let mut file = Cursor::new(source, LITTLE, begin);
    while file.at < end {
        let name = text(&mut file)?;
        let kind = file.get()?;
        if kind == END {
            break;
        }
        if matches!(kind, MATRIX | 0x0e | DOUBLES | 0x42 | UNNAMED_MATRIX | POSITIONS) {
            // The name of a type.
            text(&mut file)?;
        }
        if kind == MATRIX {
            file.get::<u32>()?;
            text(&mut file)?;
        }
        let length = match kind {
            0x01 => 1,
            0x04 | 0x05 => 2,
            0x06 | 0x07 | 0x0c => 4,
            0x0a | UINT64 | 0x0d => 8,
            0x15 => 9,
            STRING | QUANTITY | 0x18 | LINE | MAP | GROUP | MATRIX | 0x0e | DOUBLES | 0x42
            | UNNAMED_MATRIX | POSITIONS => length(&mut file)?,
            _ => {
                return Err(
                    file.wrong(format!("a type of items that is known before this, found {kind:#04x}"))
                );
            }
        };
        let begin = file.at;
        file.pass(length, end)?;
        if keep(&name, kind) {
            if found.len() == MOST {
                return Err(file.wrong(format!("{MOST} items in a group at most")));
            }
            found.push(OpdxItem { name, kind, begin, end: file.at });
        }
    }
    Ok(found)
}

fn text(file: &mut Cursor<'_, '_>) -> Result<String> {
    let length: u32 = file.get()?;
    file.take(length.into()).map(decoded)
}

fn length(file: &mut Cursor<'_, '_>) -> Result<u64> {
    Ok(match file.get()? {
        1_u8 => file.get::<u8>()?.into(),
        2 => file.get::<u16>()?.into(),
        4 => file.get::<u32>()?.into(),
        _ => return Err(file.wrong("a length of 1, 2 or 4 bytes before this")),
    })
}

fn channel(source: &mut OpenedFile<'_>, group: &OpdxItem) -> Result<StoredChannel> {
    let items = items(source, [group.begin, group.end], |name, _| WANTED.contains(&name))?;
    let find = |name: &str, kinds: &[u8]| items.iter().find(|i| i.name == name && kinds.contains(&i.kind));
    let wanted = |name: &str, kinds: &[u8]| {
        find(name, kinds)
            .ok_or_else(|| source.wrong(group.begin, format!("an item {name} in {:?}", group.name)))
    };
    let scale = wanted("DataScale", &[QUANTITY])?;
    let matrix = find("Matrix", &[MATRIX, UNNAMED_MATRIX]);
    let array = if matrix.is_none() { Some(wanted("Array", &[DOUBLES])?) } else { None };
    let (scale, unit) = quantity(source, scale)?;
    let raw = |at: u64, number| RawHeights { scale, ..RawHeights::at(at, number) };
    let (raw, shape, extent) = if let Some(matrix) = matrix {
        let [rows, columns] = source.get::<[u32; 2]>(LITTLE, matrix.begin)?;
        let (at, bytes) = (matrix.begin + 8, 4 * u64::from(rows) * u64::from(columns));
        if at + bytes != matrix.end {
            let found = (matrix.end - matrix.begin).saturating_sub(8);
            return Err(source.wrong(at, format!("{rows} x {columns} floats, {bytes} bytes, found {found}")));
        }
        let mut side = |name| match find(name, &[QUANTITY]) {
            Some(item) => quantity(source, item).map(|(side, unit)| Extent::of_side(side, &unit)),
            None => Ok(None),
        };
        let extent = [side("Dimension2Extent")?, side("Dimension1Extent")?];
        (raw(at, NumberType::F32), [rows as usize, columns as usize], extent)
    } else if let Some(array) = array {
        // A type of numbers, their bytes, and the numbers.
        let (kind, size) =
            (source.get::<u8>(LITTLE, array.begin)?, source.get::<u32>(LITTLE, array.begin + 1)?);
        let (at, bytes) = (array.begin + 5, (array.end - array.begin).saturating_sub(5));
        if (kind, size) != (0x0d, 8) || bytes % 8 != 0 {
            let expected =
                format!("doubles (type 0x0d of 8 bytes), found type {kind:#04x} of {size}, {bytes} bytes");
            return Err(source.wrong(array.begin, expected));
        }
        let count = bytes / 8;
        if let Some(points) = find("NumPoints", &[UINT64]) {
            let stated: u64 = source.get(LITTLE, points.begin)?;
            if stated != count {
                return Err(source.wrong(points.begin, format!("{count} points as in Array, found {stated}")));
            }
        }
        let cell = match find("PositionFunction", &[POSITIONS]) {
            Some(places) => cell(source, places, count)?,
            None => None,
        };
        (raw(at, NumberType::F64), [1, count as usize], [cell, None])
    } else {
        return Err(source.wrong(group.begin, "an item Array or Matrix"));
    };
    let channel = StoredChannel::new(source, raw, shape, StoredUnit::written(&unit), extent)?;
    let kind = match find("DataKind", &[STRING]) {
        Some(item) => decoded(&source.bytes(item.begin, (item.end - item.begin).min(256))?),
        None => String::new(),
    };
    Ok(channel.named(&format!("{} {kind}", group.name)))
}

/// A number and the sign of its unit.
fn quantity(source: &mut OpenedFile<'_>, item: &OpdxItem) -> Result<(f64, String)> {
    let mut file = Cursor::new(source, LITTLE, item.begin);
    let value = file.get()?;
    text(&mut file)?;
    Ok((value, text(&mut file)?))
}

/// The distance of the places of points, which must be equally spaced.
fn cell(source: &mut OpenedFile<'_>, places: &OpdxItem, count: u64) -> Result<Option<Extent>> {
    let mut file = Cursor::new(source, LITTLE, places.begin);
    text(&mut file)?;
    let unit = text(&mut file)?;
    // The unit in metres, and what is not known.
    file.get::<[u8; 20]>()?;
    let (stated, at): (u64, u64) = (file.get()?, file.at);
    if stated != count || at.checked_add(8 * count) != Some(places.end) {
        return Err(source.wrong(
            at,
            format!("{count} places as in Array, found {stated} in {} bytes", places.end.saturating_sub(at)),
        ));
    }
    let bytes = source.bytes(at, 8 * count)?;
    let place = |i: u64| NumberType::F64.decode(&bytes[8 * i as usize..]).unwrap_or(f64::NAN);
    if count < 2 {
        return Ok(None);
    }
    let (first, cell) = (place(0), (place(count - 1) - place(0)) / (count - 1) as f64);
    let even = |i: u64| (place(i) - first - i as f64 * cell).abs() <= UNEVEN * cell;
    match (1..count).find(|&i| !even(i)) {
        Some(i) => Err(source.wrong(at + 8 * i, format!("places every {cell:e} {unit}, found {}", place(i)))),
        None => Ok(Extent::of_cell(cell, &unit)),
    }
}
