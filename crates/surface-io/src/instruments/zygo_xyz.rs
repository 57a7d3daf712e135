//! Zygo XYZ, the text export of MetroPro: fourteen lines of a header between lines with `#`, then a line
//! `column row height` for each point.
//!
//! No manual of the format was at hand: public readers agree on the lines of the header (the fourth has the
//! place and the shape of the phase, the eighth as its seventh number the camera's resolution in metres, 0
//! where it is not calibrated), on `No Data` for undefined points and on micrometres as MetroPro writes them;
//! one says that the later program Mx can be set to another unit, of which the file says nothing. That is
//! noted. The row 0 is y = 0.

use super::prelude::*;
use crate::channel::undefined_heights;

const MAGIC: &[u8] = b"Zygo XYZ Data File";
/// Longest header in bytes.
const LONGEST: u64 = 1 << 16;

pub(crate) const READER: Reader =
    Reader { format: Format::ZygoXyz, recognises: |start, _| start.starts_with(MAGIC), channels };

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let text = decoded(&source.start(LONGEST)?);
    let Some(end) = text.find("\n#").map(|end| end + 2) else {
        return Err(source.wrong(text.len() as u64, "a line with # at the end of the header before this"));
    };
    let line = |number: usize| text[..end].lines().nth(number).unwrap_or_default();
    let numbers =
        |number: usize| line(number).split_whitespace().map(|n| n.parse::<f64>().ok()).collect::<Vec<_>>();
    let [Some(left), Some(top), Some(columns), Some(rows)] = numbers(3)[..] else {
        return Err(
            source.wrong(0, format!("four numbers of the phase in line 4, found {:?}", short(line(3))))
        );
    };
    let (columns, rows) = (columns as usize, rows as usize);
    source.check_cells([rows, columns])?;
    // A point takes eight bytes at least.
    let most = source.length() / 8 + 1;
    if columns.checked_mul(rows).is_none_or(|count| count as u64 > most) {
        let expected =
            format!("{columns} x {rows} points, the file has {} bytes (cut short?)", source.length());
        return Err(source.wrong(0, expected));
    }
    let resolution = numbers(7).get(6).copied().flatten().unwrap_or(0.0);
    let behind = end as u64;
    let read = move |source: &mut OpenedFile<'_>| points(source, behind, [left, top], [rows, columns]);
    let (unit, extent) = (StoredUnit::written("um"), [Extent::of_cell(resolution, "m"); 2]);
    let mut channel =
        StoredChannel::deferred("points as text".to_owned(), [rows, columns], unit, extent, read);
    channel
        .note("heights are taken for micrometres, as MetroPro writes them; the file does not say its unit");
    Ok(vec![channel])
}

/// The heights, NaN where none is said.
fn points(
    source: &mut OpenedFile<'_>,
    offset: u64,
    from: [f64; 2],
    [rows, columns]: [usize; 2],
) -> Result<Vec<f64>> {
    // A file may end with its heading.
    let offset = offset.min(source.length());
    let bytes = source.bytes(offset, source.length() - offset)?;
    let mut heights = undefined_heights(source, rows, columns)?;
    let mut at = offset;
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        let begins = at;
        at += line.len() as u64;
        let text = decoded(line);
        let words: Vec<&str> = text.split_whitespace().collect();
        let (x, y, height) = match words[..] {
            // The mark that ends the points, not that of the header.
            ["#"] if begins > offset + 1 => break,
            [] | ["#"] | [_, _, "No", "Data"] => continue,
            [x, y, height] => (x, y, height),
            _ => {
                return Err(source.wrong(begins, format!("column, row and height, found {:?}", short(&text))));
            }
        };
        let place = |text: &str, from: f64, count: usize| {
            let place = text.parse::<f64>().ok()? - from;
            (place >= 0.0 && place < count as f64 && place.fract().abs() <= 0.0).then_some(place as usize)
        };
        let (Some(column), Some(row), Ok(height)) =
            (place(x, from[0], columns), place(y, from[1], rows), height.parse())
        else {
            return Err(source.wrong(
                begins,
                format!("a place in {rows} rows of {columns} and a height, found {:?}", short(&text)),
            ));
        };
        heights[row * columns + column] = height;
    }
    Ok(heights)
}

fn short(text: &str) -> String {
    text.trim().chars().take(32).collect()
}
