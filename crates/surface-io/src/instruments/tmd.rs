//! TMD, of the programs TrueMap (TrueGage) and GelSight: two texts, the shape, the sides in millimetres, and
//! the heights in millimetres, float32 row by row.
//!
//! After Gwyddion's `rmitmd.c`, the reader of `SurfaceTopography` (`IO/TMD.py`; its version 1.27.1 has the
//! lengths in mm) and GelSight's own `readtmd`/`writetmd`. The first text has 32 bytes; the second, a
//! comment, ends at its zero and may be empty. Height = number, in mm, upwards; the first row of the file is
//! y = 0; NaN are undefined points. The offsets of the map in x and y are not used. The numbers fill the file
//! to its end: another length is an error.
//!
//! Not read: the first version of the format (`v1.0`), the AMB files of Ambios that begin with the same
//! words.

use super::prelude::*;

const MAGIC: &[u8] = b"Binary TrueMap Data File v2.0\r\n\0";

pub(crate) const READER: Reader =
    Reader { format: Format::Tmd, recognises: |start, _| start.starts_with(MAGIC), channels };

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let mut file = Cursor::new(source, ByteOrder::Little, MAGIC.len() as u64);
    let comment = file.name()?;
    let [columns, rows] = file.get::<[u32; 2]>()?;
    let [width, height, ..] = file.get::<[f32; 4]>()?.map(f64::from);
    let begin = file.at;
    let shape = [rows as usize, columns as usize];
    let raw = RawHeights::at(begin, NumberType::F32);
    let extent = [width, height].map(|side| Extent::of_side(side, "mm"));
    let mut channel = StoredChannel::new(source, raw, shape, StoredUnit::written("mm"), extent)?;
    source.ends(begin, 4 * u64::from(rows) * u64::from(columns))?;
    if !comment.trim().is_empty() {
        channel.note(format!("the file says: {}", comment.trim()));
    }
    Ok(vec![channel])
}
