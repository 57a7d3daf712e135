//! SUR, the file of Digital Surf's MountainsMap, uncompressed and compressed (zlib).
//!
//! After Gwyddion's `surffile.c`, SurfaceTopography's `IO/SUR.py`, surfalize's `file/sur.py` and
//! RosettaSciIO's `digitalsurf/_api.py` (<https://github.com/hyperspy/rosettasciio>). Little-endian; an
//! object is a header of 512 bytes, a comment, a private part and integers of 16 or 32 bits, row by row; row
//! j is y = j * step, as SurfaceTopography and surfalize have it. A height is `Z step * number + Z offset` in
//! the unit of the Z step, as in Gwyddion and surfalize; RosettaSciIO counts numbers from `Zmin`,
//! SurfaceTopography leaves out the offset: the difference is one constant for all heights. With
//! `special points` the number `Zmin - 2` is an undefined point.
//!
//! Several objects (a surface and its intensity, series) are several channels; images are no heights. Not
//! read: profiles, force curves, spectra, files of a Macintosh, and surfaces that the header calls inverted:
//! SurfaceTopography 1.27 and Gwyddion invert the numbers then, surfalize and RosettaSciIO do not, and hills
//! would be taken for valleys.

use super::prelude::*;
use crate::inflate::{Packed, Packing};

const PLAIN: &[u8; 12] = b"DIGITAL SURF";
const COMPRESSED: &[u8; 12] = b"DSCOMPRESSED";
const HEADER: u64 = 512;
/// Streams of one object; MountainsMap writes up to 8.
const STREAMS: u32 = 1024;

pub(crate) const READER: Reader = Reader {
    format: Format::Sur,
    recognises: |start, _| start.starts_with(PLAIN) || start.starts_with(COMPRESSED),
    channels,
};

header! {
    /// What is kept of a header.
    struct SurHeader {
        magic: [u8; 12] = 0,
        machine: u16 = 12,
        objects: u16 = 14,
        kind: u16 = 18,
        name: Text<30> = 20,
        channels: u16 = 80,
        /// 1 where numbers mark undefined points.
        special: u16 = 86,
        bits: u16 = 98,
        lowest: i32 = 100,
        /// Columns and rows, and their product.
        count: [i32; 2] = 108,
        total: u32 = 116,
        /// Along x, y and z.
        step: [f32; 3] = 120,
        z_axis: Text<16> = 164,
        unit: [Text<16>; 3] = 180,
        inverted: u16 = 290,
        /// Bytes of a comment and of a private part.
        behind: [u16; 2] = 334,
        z_offset: f32 = 474,
    }
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let mut found = Vec::new();
    let (mut at, mut most, mut first_kind) = (0, 1, 0);
    // Older writers have the code of a material where newer ones have the number of channels: what follows
    // decides.
    while found.len() < most && source.length() - at >= HEADER {
        let header = SurHeader::of(&mut source.fields(ByteOrder::Little, at, HEADER)?)?;
        if header.magic != *PLAIN && header.magic != *COMPRESSED {
            break;
        }
        if found.is_empty() {
            most = usize::from(header.objects.max(1)) * usize::from(header.channels.max(1));
            first_kind = header.kind;
        }
        // Of a surface with an image, the surface is first.
        let image = matches!(header.kind, 3 | 10 | 12 | 18)
            || (matches!(first_kind, 11 | 13 | 16) && !found.is_empty());
        let (channel, end) = object(source, at, &header, image)?;
        found.push(channel);
        at = end;
    }
    if found.is_empty() {
        let expected = format!("a header of {HEADER} bytes (cut short?)");
        return Err(source.wrong(source.length(), expected));
    }
    Ok(found)
}

/// The channel of an object and the offset of its end.
fn object(
    source: &mut OpenedFile<'_>,
    at: u64,
    header: &SurHeader,
    image: bool,
) -> Result<(StoredChannel, u64)> {
    let number = number_type(source, at, header)?;
    let shape = shape(source, at, header)?;
    check_heights(source, at, header, image)?;
    let data = at + HEADER + header.behind.map(u64::from).iter().sum::<u64>();
    let mark = f64::from(header.lowest) - 2.0;
    let undefined = if header.special == 1 { Undefined::Equal(mark) } else { Undefined::None };
    let [x, y, z] = header.step.map(f64::from);
    let shift = header.z_offset.into();
    let raw = move |bytes| RawHeights { scale: z, shift, undefined, ..RawHeights::new(bytes, number) };
    let plain = raw(Bytes::File(data));
    let unit = unit_of_values(header, image);
    let extent = [Extent::of_cell(x, &header.unit[0]), Extent::of_cell(y, &header.unit[1])];
    let length = u64::from(header.total) * number.bytes() as u64;
    let (mut channel, end) = if header.magic == *COMPRESSED {
        let details = format!("{}, compressed", plain.details());
        let (streams, end) = streams(source, data, length)?;
        let read = move |source: &mut OpenedFile<'_>| {
            let mut bytes = Vec::new();
            for stream in &streams {
                stream.unpack(source, &mut bytes)?;
            }
            raw(Bytes::Held(bytes)).read(source, shape[0], shape[1])
        };
        (StoredChannel::deferred(details, shape, unit, extent, read), end)
    } else {
        (StoredChannel::new(source, plain, shape, unit, extent)?, data + length)
    };
    channel.note_sides("cells of", [Some(x), Some(y)], &header.unit[0]);
    let name = [&*header.name, &*header.z_axis].into_iter().find(|name| !name.is_empty()).unwrap_or_default();
    Ok((channel.named(name), end))
}

/// The type of the numbers of an object, which is that of a PC.
fn number_type(source: &OpenedFile<'_>, at: u64, header: &SurHeader) -> Result<NumberType> {
    if header.machine != 0 {
        let expected = format!("0, the format of a PC, found {}", header.machine);
        return Err(source.wrong(at + 12, expected));
    }
    match header.bits {
        16 => Ok(NumberType::I16),
        32 => Ok(NumberType::I32),
        bits => Err(source.wrong(at + 98, format!("16 or 32 bits for a number, found {bits}"))),
    }
}

/// Rows and columns of an object, which is a surface or an image.
fn shape(source: &OpenedFile<'_>, at: u64, header: &SurHeader) -> Result<[usize; 2]> {
    let [Ok(columns), Ok(rows)] = header.count.map(usize::try_from) else {
        return Err(source.wrong(at + 108, "numbers of columns and rows"));
    };
    // Gwyddion calls surfaces profiles.
    let is_surface = matches!(header.kind, 1 | 2 | 3 | 5 | 8 | 10 | 11 | 12 | 13 | 16 | 18);
    if !is_surface || (header.kind == 1 && rows == 1) {
        let expected =
            format!("a surface or an image, found {} of type {}", kind_name(header.kind), header.kind);
        return Err(source.wrong(at + 18, expected));
    }
    if columns as u64 * rows as u64 != u64::from(header.total) {
        let expected = format!("{columns} x {rows} numbers, found {}", header.total);
        return Err(source.wrong(at + 116, expected));
    }
    source.check_cells([rows, columns])?;
    Ok([rows, columns])
}

/// Refuses numbers that make no heights, or whose heights may be inverted.
fn check_heights(source: &OpenedFile<'_>, at: u64, header: &SurHeader, image: bool) -> Result<()> {
    let z = f64::from(header.step[2]);
    if !(z.is_finite() && z.abs() > 0.0 && header.z_offset.is_finite()) {
        let expected = format!("a step along z other than 0 and an offset, found {z}");
        return Err(source.wrong(at + 128, expected));
    }
    if header.inverted != 0 && !image {
        let expected = "no mark of an inversion: readers disagree whether the numbers are inverted already; export X3P or text";
        return Err(source.wrong(at + 290, expected));
    }
    Ok(())
}

/// The unit of an object; an image has no heights.
fn unit_of_values(header: &SurHeader, image: bool) -> StoredUnit {
    match StoredUnit::written(&header.unit[2]) {
        StoredUnit::NoHeights(unit) => StoredUnit::NoHeights(unit),
        _ if image => StoredUnit::NoHeights(None),
        unit => unit,
    }
}

/// The streams of a compressed object that unpack to `length` bytes, and the offset of their end.
fn streams(source: &mut OpenedFile<'_>, data: u64, length: u64) -> Result<(Vec<Packed>, u64)> {
    let count: u32 = source.get(ByteOrder::Little, data)?;
    if !(1..=STREAMS).contains(&count) {
        return Err(source.wrong(data, format!("1 to {STREAMS} streams, found {count}")));
    }
    let mut fields = source.fields(ByteOrder::Little, data + 4, 8 * u64::from(count))?;
    let mut end = data + 4 + 8 * u64::from(count);
    let (mut found, mut total) = (Vec::new(), 0);
    for _ in 0..count {
        let [unpacked, packed] = fields.get::<[u32; 2]>()?.map(u64::from);
        let stream = Packed { packing: Packing::Zlib, offset: end, length: packed, unpacked };
        stream.check(source)?;
        found.push(stream);
        end += packed;
        total += unpacked;
    }
    if total != length {
        return Err(source.wrong(data, format!("streams of {length} bytes unpacked, found {total}")));
    }
    Ok((found, end))
}

/// Names of types that are not read.
fn kind_name(kind: u16) -> &'static str {
    match kind {
        1 => "a profile",
        4 => "a series of profiles",
        6 | 9 => "a disc",
        7 => "a profile of several layers",
        14 | 15 => "force curves",
        17 => "a contour",
        20 | 21 => "spectra",
        _ => "an object",
    }
}
