//! The largest connected contact of a map, enlarged beside it where the contact is so small that it is hardly seen.

use contact_model::{Cells, Size};
use std::ops::Range;

/// Share of the map in contact below which its largest contact is enlarged.
const SMALL: f64 = 0.01;
/// The window over the longer side of the contact in it, and the fewest cells along a side of the window.
const ROOM: f64 = 1.6;
const FEWEST: usize = 12;
/// A window of more than this share of a side of the map would enlarge nothing.
const LARGEST: f64 = 0.5;

/// The rows and columns that hold the largest connected contact (cells that share an edge), as near to a square as the
/// map allows; `None` where no contact is small enough, or there is none.
///
/// Cost: linear in the number of cells.
pub(crate) fn window(cells: Cells, size: Size, contact: &[bool]) -> Option<(Range<usize>, Range<usize>)> {
    let count = contact.iter().filter(|touches| **touches).count();
    if count == 0 || count as f64 >= SMALL * contact.len() as f64 {
        return None;
    }
    let [across, up] = largest(cells, contact);
    let (dx, dy) = (size.x / cells.columns as f64, size.y / cells.rows as f64);
    let longer = (across.len() as f64 * dx).max(up.len() as f64 * dy);
    let side = (ROOM * longer).max(FEWEST as f64 * dx.max(dy));
    let around = |of: &Range<usize>, step: f64, all: usize| {
        let wide = (side / step * (1.0 - 1e-9)).ceil() as usize;
        let first = ((of.start + of.end).saturating_sub(wide) / 2).min(all.saturating_sub(wide));
        (wide as f64 <= LARGEST * all as f64).then(|| first..first + wide)
    };
    Some((around(&up, dy, cells.rows)?, around(&across, dx, cells.columns)?))
}

/// The columns and the rows of the largest connected contact.
fn largest(cells: Cells, contact: &[bool]) -> [Range<usize>; 2] {
    let Cells { columns, rows } = cells;
    let mut left = contact.to_vec();
    let mut found = (0, [0..0, 0..0]);
    for first in 0..left.len() {
        if !std::mem::take(&mut left[first]) {
            continue;
        }
        let (mut waiting, mut count) = (vec![first], 0);
        let mut ends = [[usize::MAX, 0], [usize::MAX, 0]];
        while let Some(cell) = waiting.pop() {
            count += 1;
            let (x, y) = (cell % columns, cell / columns);
            for (end, at) in ends.iter_mut().zip([x, y]) {
                *end = [end[0].min(at), end[1].max(at + 1)];
            }
            let neighbours = [
                (x > 0).then(|| cell - 1),
                (x + 1 < columns).then(|| cell + 1),
                (y > 0).then(|| cell - columns),
                (y + 1 < rows).then(|| cell + columns),
            ];
            waiting.extend(neighbours.into_iter().flatten().filter(|next| std::mem::take(&mut left[*next])));
        }
        if count > found.0 {
            found = (count, ends.map(|[from, to]| from..to));
        }
    }
    found.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_holds_the_largest_connected_contact() {
        let cells = Cells { columns: 100, rows: 80 };
        let size = Size { x: 10.0, y: 8.0 };
        let with = |touching: &[(usize, usize)]| {
            let mut contact = vec![false; 8000];
            for (x, y) in touching {
                contact[y * 100 + x] = true;
            }
            contact
        };
        // Five cells in a corner, which belong together by edges, and six that meet at corners alone.
        let mut touching: Vec<(usize, usize)> = (0..5).map(|x| (x, 1)).collect();
        touching.extend((0..6).map(|i| (60 + i, 60 + i)));
        assert_eq!(window(cells, size, &with(&touching)), Some((0..12, 0..12)));
        let long: Vec<(usize, usize)> = (30..50).map(|x| (x, 40)).collect();
        assert_eq!(window(cells, size, &with(&long)), Some((24..56, 24..56)));
        // One per cent and more, nothing, and a contact as long as the map.
        assert_eq!(window(cells, size, &with(&(0..80).map(|i| (i, 3)).collect::<Vec<_>>())), None);
        assert_eq!(window(cells, size, &with(&[])), None);
        assert_eq!(window(cells, size, &with(&(0..70).map(|y| (9, y)).collect::<Vec<_>>())), None);
        // Cells that are twice as long along x.
        let (rows, columns) = window(cells, Size { x: 20.0, y: 8.0 }, &with(&[(50, 40)])).unwrap();
        assert_eq!((rows, columns), (28..52, 44..56));
    }
}
