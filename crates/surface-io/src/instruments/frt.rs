//! FRT, of the profilers MicroProf of Fries Research & Technology: `FRTM_GLIDERV`, a version, and numbered
//! blocks.
//!
//! After Gwyddion's `microprof.c` (from FRT's description) and the reader of `SurfaceTopography`
//! (`IO/FRT.py`). Block 0x66 has the shape and the bits of a number, 0x67 the sides in m, 0x6c the height of
//! a count in m, 0x0b the numbers row by row, uint16 or int32, the first row that of the largest y (both
//! programs turn it so). Height = count x number; the number 1 is undefined. Version 1.00 writes the length
//! of a block in four bytes, 1.01 in eight.
//!
//! Numbers below the least valid one of block 0x70 are read as heights, as both programs do; a note tells it.
//! Not read: the images of block 0x7d (the first is the map of block 0x0b again) and files that have no other
//! map, profiles, the offset of the colour scale in block 0x71.

use super::prelude::*;

const MAGIC: &[u8] = b"FRTM_GLIDERV";
const LITTLE: ByteOrder = ByteOrder::Little;
const NUMBERS: u16 = 0x0b;
const SHAPE: u16 = 0x66;
const SIDES: u16 = 0x67;
const SENSOR: u16 = 0x6c;
const VALID: u16 = 0x70;
const IMAGES: u16 = 0x7d;

pub(crate) const READER: Reader =
    Reader { format: Format::Frt, recognises: |start, _| start.starts_with(MAGIC), channels };

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let wide = match &source.get::<[u8; 4]>(LITTLE, 12)? {
        b"1.00" => false,
        b"1.01" => true,
        _ => return Err(source.wrong(12, "version 1.00 or 1.01")),
    };
    let mut file = Cursor::new(source, LITTLE, 16);
    let end = file.source.length();
    let mut blocks = Vec::new();
    for _ in 0..file.get::<u16>()? {
        // The number of blocks may count some that are not there.
        if file.at == end {
            break;
        }
        let number = file.get::<u16>()?;
        let length = if wide { file.get()? } else { file.get::<u32>()?.into() };
        blocks.push((number, file.at, length));
        file.pass(length, end)?;
    }
    let find = |wanted: u16, least: u64| {
        let found = blocks.iter().find(|(number, _, length)| *number == wanted && *length >= least);
        found.ok_or_else(|| source.wrong(18, format!("a block {wanted:#04x} of {least} bytes or more")))
    };
    let [shape, sides, sensor] = [find(SHAPE, 12)?.1, find(SIDES, 16)?.1, find(SENSOR, 12)?.1];
    let &(_, begin, length) = find(NUMBERS, 1)?;
    let images = find(IMAGES, 0).is_ok();
    let valid = find(VALID, 4).ok().map(|block| block.1);
    let [columns, rows, bits] = source.get::<[u32; 3]>(LITTLE, shape)?;
    let number = match bits {
        16 => NumberType::U16,
        32 => NumberType::I32,
        _ => return Err(source.wrong(shape + 8, format!("16 or 32 bits a number, found {bits}"))),
    };
    if number.bytes_of([rows, columns]) != Some(length) {
        let expected = format!("a block of {rows} x {columns} numbers of {bits} bits, found {length} bytes");
        return Err(source.wrong(begin, expected));
    }
    let raw = RawHeights {
        scale: source.get(LITTLE, sensor + 4)?,
        reversed: [false, true],
        undefined: Undefined::Equal(1.0),
        ..RawHeights::at(begin, number)
    };
    let extent = source.get::<[f64; 2]>(LITTLE, sides)?.map(|side| Extent::of_side(side, "m"));
    let shape = [rows as usize, columns as usize];
    let mut channel = StoredChannel::new(source, raw, shape, StoredUnit::written("m"), extent)?;
    if images {
        channel.note("the file has images in block 0x7d, which are not read; the first is mostly this map");
    }
    if let Some(at) = valid {
        let least: u32 = source.get(LITTLE, at)?;
        channel.note(format!("the file calls numbers from {least} on valid; only 1 is taken for undefined"));
    }
    Ok(vec![channel])
}
