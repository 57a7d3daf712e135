//! The part of a field that a report shows: at most 256 x 256 values, each that of one cell.

use contact_model::{Cells, Shown};

/// Largest number of values along a side.
const MOST: usize = 256;
const MAGIC: [u8; 4] = *b"view";

/// Which cell of a block is shown, in words.
pub(crate) fn shown_words(shown: Shown) -> &'static str {
    match shown {
        Shown::Middle => "the cell in the middle",
        Shown::Largest => "the largest value",
        Shown::Smallest => "the smallest value",
    }
}

/// Blocks of cells, each with the value of one of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FieldView {
    /// Cells of the field.
    pub cells: Cells,
    /// Cells along a side of a block; 1 shows every cell.
    pub block: usize,
    pub columns: usize,
    pub rows: usize,
    /// Row-major; NaN where points are undefined.
    pub values: Vec<f32>,
    /// The cell of its block from which each value comes: row * block + column within the block.
    pub places: Vec<u16>,
}

impl FieldView {
    /// From the values of a field, row-major, NaN where undefined.
    pub fn new(shown: Shown, cells: Cells, values: &[f64]) -> Self {
        let Cells { columns, rows } = cells;
        let block = columns.max(rows).div_ceil(MOST).max(1);
        let (across, down) = (columns.div_ceil(block), rows.div_ceil(block));
        let mut view =
            Self { cells, block, columns: across, rows: down, values: Vec::new(), places: Vec::new() };
        for i in 0..across * down {
            let (x, y) = ((i % across) * block, (i / across) * block);
            let (w, h) = (block.min(columns - x), block.min(rows - y));
            let at = |place: usize| values[(y + place / block) * columns + x + place % block];
            let inside = || (0..h).flat_map(|j| (0..w).map(move |i| j * block + i));
            let defined = || inside().filter(|place| at(*place).is_finite());
            let place = match shown {
                Shown::Middle => Some((h / 2) * block + w / 2),
                Shown::Largest => defined().max_by(|a, b| at(*a).total_cmp(&at(*b))),
                Shown::Smallest => defined().min_by(|a, b| at(*a).total_cmp(&at(*b))),
            };
            view.values.push(place.map_or(f32::NAN, |place| at(place) as f32));
            view.places.push(place.unwrap_or(0) as u16);
        }
        view
    }

    /// The smallest and the largest value; `None` where none is defined.
    pub fn ends(&self) -> Option<[f32; 2]> {
        let finite = || self.values.iter().copied().filter(|v| v.is_finite());
        Some([finite().reduce(f32::min)?, finite().reduce(f32::max)?])
    }

    /// The values of the first row over the middles of their cells.
    pub fn row(&self, length: f64) -> Vec<(f64, f64)> {
        let step = length / self.cells.columns as f64;
        let shown = self.values.iter().zip(&self.places).take(self.columns).enumerate();
        shown
            .map(|(i, (&value, &place))| {
                let column = i * self.block + usize::from(place) % self.block;
                ((column as f64 + 0.5) * step, f64::from(value))
            })
            .collect()
    }

    /// As bytes, little-endian.
    pub fn encode(&self) -> Vec<u8> {
        let head = [self.cells.columns, self.cells.rows, self.block].map(|n| (n as u64).to_le_bytes());
        let mut bytes = [&MAGIC[..], head.as_flattened()].concat();
        bytes.extend(self.values.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(self.places.iter().flat_map(|v| v.to_le_bytes()));
        bytes
    }

    /// From bytes; `None` where they are none of [`FieldView::encode`].
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let (head, rest) = bytes.strip_prefix(&MAGIC)?.split_at_checked(24)?;
        let number = |i: usize| {
            let bytes = head.get(8 * i..8 * i + 8)?.try_into().ok()?;
            usize::try_from(u64::from_le_bytes(bytes)).ok().filter(|n| (1..1 << 24).contains(n))
        };
        let (columns, rows, block) = (number(0)?, number(1)?, number(2)?);
        let (across, down) = (columns.div_ceil(block), rows.div_ceil(block));
        let count = across * down;
        if rest.len() != 6 * count || block > MOST {
            return None;
        }
        let (values, places) = rest.split_at(4 * count);
        let (values, places) = (values.as_chunks().0, places.as_chunks().0);
        Some(Self {
            cells: Cells { columns, rows },
            block,
            columns: across,
            rows: down,
            values: values.iter().map(|v| f32::from_le_bytes(*v)).collect(),
            places: places.iter().map(|v| u16::from_le_bytes(*v)).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_that_of_its_cell() {
        let cells = Cells { columns: 700, rows: 301 };
        let mut values: Vec<f64> = (0..700 * 301).map(|i| f64::from(i * 7919 % 1000)).collect();
        values[5] = f64::NAN;
        for shown in [Shown::Largest, Shown::Smallest, Shown::Middle] {
            let view = FieldView::new(shown, cells, &values);
            assert_eq!((view.block, view.columns, view.rows), (3, 234, 101));
            for (i, (&v, &place)) in view.values.iter().zip(&view.places).enumerate() {
                let (x, y) = ((i % 234) * 3 + usize::from(place) % 3, (i / 234) * 3 + usize::from(place) / 3);
                let value = values[y * 700 + x] as f32;
                assert!(value.to_bits() == v.to_bits(), "{shown:?}: {x}, {y}");
            }
            let bytes = view.encode();
            let read = FieldView::decode(&bytes).unwrap();
            assert_eq!((read.places, read.values.len()), (view.places, view.values.len()));
            for end in [0, 3, 10, 28, bytes.len() - 1] {
                assert!(FieldView::decode(&bytes[..end]).is_none());
            }
        }
        let small = FieldView::new(Shown::Smallest, [2, 1].into(), &[f64::NAN, 1.0]);
        assert_eq!((small.block, small.places.as_slice(), small.ends()), (1, &[0, 0][..], Some([1.0, 1.0])));
    }
}
