//! GWY, the file of Gwyddion: named components, objects inside objects
//! (<http://gwyddion.net/documentation/user-guide-en/gwyfile-format.html>).
//!
//! Channel N is the object `/N/data`, its name `/N/data/title`. Rows go from the top to the bottom of the
//! picture. The points of a mask (`/N/mask`) are undefined, and so are those that are no numbers. Sides
//! without a unit of length are noted and not used.

mod write;

pub use write::gwy;

use super::prelude::*;
use crate::channel::MaskedHeights;

const MAGIC: &[u8] = b"GWYP";

pub(crate) const READER: Reader =
    Reader { format: Format::Gwy, recognises: |start, _| start.starts_with(MAGIC), channels };

/// What is kept of a data field.
#[derive(Debug, Default)]
struct DataField {
    shape: [Option<u32>; 2],
    size: [Option<f64>; 2],
    lateral_unit: String,
    unit: String,
    /// Offset and number of the doubles.
    values: Option<(u64, u32)>,
}

/// What is known of `/N/...`.
#[derive(Debug)]
struct Numbered {
    number: u64,
    title: Option<String>,
    data: Option<DataField>,
    mask: Option<DataField>,
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let mut found = Vec::new();
    let mut file = Cursor::new(source, ByteOrder::Little, MAGIC.len() as u64);
    let (name, end) = object(&mut file)?;
    if name != "GwyContainer" {
        return Err(source.wrong(MAGIC.len() as u64, "the object GwyContainer"));
    }
    while file.at < end {
        component(&mut file, end, &mut found)?;
    }
    found.sort_by_key(|c: &Numbered| c.number);
    let of = |c: Numbered| Some((c.data?, c.title, c.mask));
    let one = |(data, title, mask): (DataField, Option<String>, Option<DataField>)| {
        let channel = channel(source, &data, mask.as_ref());
        let channel = StoredChannel::listed(None, channel)?;
        Ok(channel.named(&title.unwrap_or_default()))
    };
    found.into_iter().filter_map(of).map(one).collect()
}

/// One component of the container.
fn component(file: &mut Cursor<'_, '_>, end: u64, found: &mut Vec<Numbered>) -> Result<()> {
    let key = file.name()?;
    let begins = file.at;
    let kind: u8 = file.get()?;
    let parts: Vec<&str> = key.split('/').collect();
    let number = match parts[..] {
        ["", number, ..] => number.parse::<u64>().ok(),
        _ => None,
    };
    let wanted =
        matches!((&parts[..], kind), (["", _, "data" | "mask"], b'o') | (["", _, "data", "title"], b's'));
    let Some(number) = number.filter(|_| wanted) else {
        file.at = begins;
        return skip(file, end);
    };
    let place = found.iter().position(|c| c.number == number).unwrap_or_else(|| {
        found.push(Numbered { number, title: None, data: None, mask: None });
        found.len() - 1
    });
    if kind == b's' {
        found[place].title = Some(file.name()?);
        return Ok(());
    }
    let field = data_field(file, end)?;
    let target = if parts[2] == "data" { &mut found[place].data } else { &mut found[place].mask };
    *target = Some(field);
    Ok(())
}

/// The fields of an object `GwyDataField`; the cursor stands behind its type.
fn data_field(file: &mut Cursor<'_, '_>, outer: u64) -> Result<DataField> {
    let begins = file.at;
    let (kind, end) = object(file)?;
    if kind != "GwyDataField" || end > outer {
        return Err(file.source.wrong(begins, "an object GwyDataField inside the container"));
    }
    let mut field = DataField::default();
    while file.at < end {
        let key = file.name()?;
        let begins = file.at;
        let axis = usize::from(key.starts_with('y'));
        match (key.as_str(), file.get()?) {
            ("xres" | "yres", b'i') => field.shape[axis] = Some(file.get()?),
            ("xreal" | "yreal", b'd') => field.size[axis] = Some(file.get()?),
            ("si_unit_xy", b'o') => field.lateral_unit = unit(file, end)?,
            ("si_unit_z", b'o') => field.unit = unit(file, end)?,
            ("data", b'D') => {
                let count = file.get()?;
                field.values = Some((file.at, count));
                file.pass(8 * u64::from(count), end)?;
            }
            _ => {
                file.at = begins;
                skip(file, end)?;
            }
        }
    }
    Ok(field)
}

/// The text of an object `GwySIUnit`.
fn unit(file: &mut Cursor<'_, '_>, outer: u64) -> Result<String> {
    let (_, end) = object(file)?;
    let mut text = String::new();
    while file.at < end.min(outer) {
        let key = file.name()?;
        let begins = file.at;
        if key == "unitstr" && file.get::<u8>()? == b's' {
            text = file.name()?;
        } else {
            file.at = begins;
            skip(file, end)?;
        }
    }
    Ok(text)
}

fn channel(source: &OpenedFile<'_>, field: &DataField, mask: Option<&DataField>) -> Result<StoredChannel> {
    let ([Some(columns), Some(rows)], Some((at, count))) = (field.shape, field.values) else {
        return Err(source.wrong(0, "xres, yres and data of each data field"));
    };
    if u64::from(columns) * u64::from(rows) != u64::from(count) {
        return Err(source.wrong(at, format!("{columns} x {rows} numbers, found {count}")));
    }
    let shape = [rows as usize, columns as usize];
    let raw = RawHeights::at(at, NumberType::F64);
    let unit = StoredUnit::written(&field.unit);
    let extent = field.size.map(|side| Extent::of_side(side?, &field.lateral_unit));
    let mut channel = if let Some(mask) = mask {
        let Some((masked_at, _)) = mask.values.filter(|_| mask.shape == field.shape) else {
            return Err(source.wrong(at, "a mask of as many columns and rows as its data field"));
        };
        let mask = RawHeights::at(masked_at, NumberType::F64);
        let masked = MaskedHeights { raw, mask, detail: "masked points undefined" };
        StoredChannel::masked(source, masked, shape, unit, extent)?
    } else {
        StoredChannel::new(source, raw, shape, unit, extent)?
    };
    channel.note_sides("sides", field.size, &field.lateral_unit);
    Ok(channel)
}

/// The name of an object and the offset of its end; the cursor stands before the name, and behind the length
/// afterwards.
fn object(file: &mut Cursor<'_, '_>) -> Result<(String, u64)> {
    let name = file.name()?;
    let length: u32 = file.get()?;
    let (end, length) = (file.at + u64::from(length), file.source.length());
    if end > length {
        let expected = format!("an object that ends at {end}, the file ends at {length} (cut short?)");
        return Err(file.wrong(expected));
    }
    Ok((name, end))
}

/// Passes the value of a component; the cursor stands before its type.
fn skip(file: &mut Cursor<'_, '_>, end: u64) -> Result<()> {
    let begins = file.at;
    let kind: u8 = file.get()?;
    let size = match kind.to_ascii_lowercase() {
        b'b' | b'c' => Some(1),
        b'i' => Some(4),
        b'q' | b'd' => Some(8),
        _ => None,
    };
    let count = if kind.is_ascii_uppercase() { file.get::<u32>()? } else { 1 };
    match (kind.to_ascii_lowercase(), size) {
        (b's', _) => (0..count).try_for_each(|_| file.name().map(drop)),
        (b'o', _) => (0..count).try_for_each(|_| {
            let (_, inner) = object(file)?;
            file.pass(inner - file.at, end)
        }),
        (_, Some(size)) => file.pass(size * u64::from(count), end),
        _ => Err(file.source.wrong(begins, "the type of a component, one of bciqdsoCIQDSO")),
    }
}
