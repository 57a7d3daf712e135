//! GSF, Gwyddion's simple field: lines `Key = value`, zeros up to a multiple of four bytes, the heights as
//! float32 row by row.
//!
//! After the specification (<http://gwyddion.net/documentation/user-guide-en/gsf.html>) and Gwyddion's
//! `gsffile.c`. Height = number in `ZUnits`; rows go from the top to the bottom of the picture; NaN are
//! undefined points. `XReal` and `YReal` are the sides in `XYUnits`; sides without a unit of length are noted
//! and not used. The numbers fill the file to its end: another length is an error. The offsets are not used.

use super::prelude::*;
use crate::entries::{HeaderLine, TextHeader};

const MAGIC: &[u8] = b"Gwyddion Simple Field 1.0\n";
/// Longest header that is read.
const LONGEST: u64 = 1 << 20;

pub(crate) const READER: Reader =
    Reader { format: Format::Gsf, recognises: |start, _| start.starts_with(MAGIC), channels };

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let start = source.start(LONGEST)?;
    let Some(end) = start.iter().position(|&b| b == 0) else {
        return Err(source.wrong(start.len() as u64, "a zero behind the header before this (cut short?)"));
    };
    let (header, _) = TextHeader::read(source.subject(), &start[..end], |line| HeaderLine::entry(line, '='))?;
    let header = header.section("");
    let [rows, columns] = [header.whole("yres")?, header.whole("xres")?];
    let begin = end as u64 / 4 * 4 + 4;
    let sides = [header.number("xreal")?, header.number("yreal")?];
    let lateral = header.text("xyunits").unwrap_or_default();
    let extent = sides.map(|side| Extent::of_side(side?, lateral));
    let unit = StoredUnit::written(header.text("zunits").unwrap_or_default());
    let raw = RawHeights::at(begin, NumberType::F32);
    let mut channel = StoredChannel::new(source, raw, [rows, columns], unit, extent)?;
    source.ends(begin, 4 * rows as u64 * columns as u64)?;
    channel.note_sides("sides", sides, lateral);
    Ok(vec![channel.named(header.text("title").unwrap_or_default())])
}
