//! GWY, the file of Gwyddion: named components, objects inside objects (<http://gwyddion.net/documentation/user-guide-en/gwyfile-format.html>).
//!
//! Channel N is the object `/N/data`, its name `/N/data/title`. Rows go from the top to the bottom of the picture. The points of a mask
//! (`/N/mask`) are undefined, and so are those that are no numbers.

mod write;

pub use write::gwy;

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredHeights, StoredUnit, masked};
use crate::error::Result;
use crate::extent::Extent;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::reader::Reader;
use crate::source::{Fields, Source};

const FORMAT: Format = Format::Gwy;
const MAGIC: &[u8] = b"GWYP";
/// Longest text that is read, in bytes.
const LONGEST: u32 = 1 << 16;

pub(crate) const READER: Reader =
    Reader { format: FORMAT, recognises: |start, _| start.starts_with(MAGIC), channels };

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

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let mut found = Vec::new();
    let mut at = MAGIC.len() as u64;
    let (name, end) = object(source, &mut at)?;
    if name != "GwyContainer" {
        return Err(source.wrong(FORMAT, MAGIC.len() as u64, "the object GwyContainer"));
    }
    while at < end {
        component(source, &mut at, end, &mut found)?;
    }
    found.sort_by_key(|c: &Numbered| c.number);
    found.into_iter().filter_map(|c| Some((c.data?, c.title, c.mask))).map(|c| channel(source, c)).collect()
}

/// One component of the container.
fn component(source: &mut Source<'_>, at: &mut u64, end: u64, found: &mut Vec<Numbered>) -> Result<()> {
    let key = name(source, at)?;
    let begins = *at;
    let kind = byte(source, at)?;
    let parts: Vec<&str> = key.split('/').collect();
    let number = match parts[..] {
        ["", number, ..] => number.parse::<u64>().ok(),
        _ => None,
    };
    let wanted =
        matches!((&parts[..], kind), (["", _, "data" | "mask"], b'o') | (["", _, "data", "title"], b's'));
    let Some(number) = number.filter(|_| wanted) else {
        *at = begins;
        return skip(source, at, end);
    };
    let place = found.iter().position(|c| c.number == number).unwrap_or_else(|| {
        found.push(Numbered { number, title: None, data: None, mask: None });
        found.len() - 1
    });
    if kind == b's' {
        found[place].title = Some(name(source, at)?);
        return Ok(());
    }
    let field = data_field(source, at, end)?;
    let target = if parts[2] == "data" { &mut found[place].data } else { &mut found[place].mask };
    *target = Some(field);
    Ok(())
}

/// The fields of an object `GwyDataField`; `at` stands behind its type.
fn data_field(source: &mut Source<'_>, at: &mut u64, outer: u64) -> Result<DataField> {
    let begins = *at;
    let (kind, end) = object(source, at)?;
    if kind != "GwyDataField" || end > outer {
        return Err(source.wrong(FORMAT, begins, "an object GwyDataField inside the container"));
    }
    let mut field = DataField::default();
    while *at < end {
        let key = name(source, at)?;
        let begins = *at;
        let axis = usize::from(key.starts_with('y'));
        match (key.as_str(), byte(source, at)?) {
            ("xres" | "yres", b'i') => field.shape[axis] = Some(u32::from_le_bytes(fixed(source, at)?)),
            ("xreal" | "yreal", b'd') => field.size[axis] = Some(f64::from_le_bytes(fixed(source, at)?)),
            ("si_unit_xy", b'o') => field.lateral_unit = unit(source, at, end)?,
            ("si_unit_z", b'o') => field.unit = unit(source, at, end)?,
            ("data", b'D') => {
                let count = u32::from_le_bytes(fixed(source, at)?);
                field.values = Some((*at, count));
                jump(source, at, 8 * u64::from(count), end)?;
            }
            _ => {
                *at = begins;
                skip(source, at, end)?;
            }
        }
    }
    Ok(field)
}

/// The text of an object `GwySIUnit`.
fn unit(source: &mut Source<'_>, at: &mut u64, outer: u64) -> Result<String> {
    let (_, end) = object(source, at)?;
    let mut text = String::new();
    while *at < end.min(outer) {
        let key = name(source, at)?;
        let begins = *at;
        if key == "unitstr" && byte(source, at)? == b's' {
            text = name(source, at)?;
        } else {
            *at = begins;
            skip(source, at, end)?;
        }
    }
    Ok(text)
}

fn channel(
    source: &Source<'_>,
    (field, title, mask): (DataField, Option<String>, Option<DataField>),
) -> Result<StoredChannel> {
    let wrong = |expected: &str| source.wrong(FORMAT, 0, expected);
    let ([Some(columns), Some(rows)], Some((at, count))) = (field.shape, field.values) else {
        return Err(wrong("xres, yres and data of each data field"));
    };
    if u64::from(columns) * u64::from(rows) != u64::from(count) {
        return Err(source.wrong(FORMAT, at, format!("{columns} x {rows} numbers, found {count}")));
    }
    let (columns, rows) = (columns as usize, rows as usize);
    let raw = RawHeights::new(FORMAT, Bytes::File(at), NumberType::F64);
    raw.check(source, rows, columns)?;
    let mut details = raw.details();
    let heights = match mask {
        None => StoredHeights::Raw(raw),
        Some(DataField { shape, values: Some((at, _)), .. }) if shape == field.shape => {
            details += ", masked points undefined";
            let mask = RawHeights::new(FORMAT, Bytes::File(at), NumberType::F64);
            mask.check(source, rows, columns)?;
            masked(raw, mask, rows, columns)
        }
        Some(_) => {
            return Err(source.wrong(FORMAT, at, "a mask of as many columns and rows as its data field"));
        }
    };
    let lateral: Option<Unit> =
        field.lateral_unit.parse().ok().filter(|u: &Unit| u.dimension() == Dimension::LENGTH);
    let side = |side: Option<f64>| -> Option<Extent> {
        let length = lateral.as_ref()?.to_si(side?);
        let length = Quantity::new(length, Dimension::LENGTH).ok();
        length.filter(|l| l.value() > 0.0).map(Extent::Side)
    };
    Ok(StoredChannel {
        name: title,
        details,
        rows,
        columns,
        unit: StoredUnit::written(&field.unit),
        extent: field.size.map(side),
        heights,
    })
}

/// The name of an object and the offset of its end; `at` stands before the name, and behind the length afterwards.
fn object(source: &mut Source<'_>, at: &mut u64) -> Result<(String, u64)> {
    let name = name(source, at)?;
    let length = u32::from_le_bytes(fixed(source, at)?);
    let end = *at + u64::from(length);
    if end > source.length() {
        let expected =
            format!("an object of {length} bytes, the file ends at {} (cut short?)", source.length());
        return Err(source.wrong(FORMAT, *at, expected));
    }
    Ok((name, end))
}

/// Passes the value of a component; `at` stands before its type.
fn skip(source: &mut Source<'_>, at: &mut u64, end: u64) -> Result<()> {
    let begins = *at;
    let kind = byte(source, at)?;
    let size = |kind: u8| match kind.to_ascii_lowercase() {
        b'b' | b'c' => Some(1),
        b'i' => Some(4),
        b'q' | b'd' => Some(8),
        _ => None,
    };
    let count = |source: &mut Source<'_>, at: &mut u64| fixed(source, at).map(u32::from_le_bytes);
    match (kind, size(kind)) {
        (b's', _) => name(source, at).map(drop),
        (b'o', _) => {
            let (_, inner) = object(source, at)?;
            jump(source, at, inner - *at, end)
        }
        (b'S', _) => {
            for _ in 0..count(source, at)? {
                name(source, at)?;
            }
            Ok(())
        }
        (b'O', _) => {
            for _ in 0..count(source, at)? {
                let (_, inner) = object(source, at)?;
                jump(source, at, inner - *at, end)?;
            }
            Ok(())
        }
        (kind, Some(size)) if kind.is_ascii_uppercase() => {
            let count = count(source, at)?;
            jump(source, at, size * u64::from(count), end)
        }
        (_, Some(size)) => jump(source, at, size, end),
        _ => Err(source.wrong(FORMAT, begins, "the type of a component, one of bciqdsoCIQDSO")),
    }
}

fn jump(source: &Source<'_>, at: &mut u64, by: u64, end: u64) -> Result<()> {
    if end - (*at).min(end) < by {
        return Err(source.wrong(FORMAT, *at, format!("{by} bytes inside this object, it ends at {end}")));
    }
    *at += by;
    Ok(())
}

fn byte(source: &mut Source<'_>, at: &mut u64) -> Result<u8> {
    fixed::<1>(source, at).map(|[byte]| byte)
}

fn fixed<const N: usize>(source: &mut Source<'_>, at: &mut u64) -> Result<[u8; N]> {
    let mut bytes = [0; N];
    bytes.copy_from_slice(&source.bytes(FORMAT, *at, N as u64)?);
    *at += N as u64;
    Ok(bytes)
}

/// A text up to its zero.
fn name(source: &mut Source<'_>, at: &mut u64) -> Result<String> {
    let left = source.length().saturating_sub(*at).min(u64::from(LONGEST));
    let mut length = 64.min(left);
    loop {
        let bytes = source.bytes(FORMAT, *at, length)?;
        let mut fields = Fields::little(&bytes, *at);
        match fields.until(0) {
            Ok(text) => {
                *at += text.len() as u64 + 1;
                return Ok(String::from_utf8_lossy(text).into_owned());
            }
            Err(_) if length == left => {
                return Err(source.wrong(FORMAT, *at, "a text that ends"));
            }
            Err(_) => length = (4 * length).min(left),
        }
    }
}
