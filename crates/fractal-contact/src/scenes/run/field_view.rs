//! The part of a field that a report shows: at most 512 x 512 values, each that of one cell.

use contact_model::Cells;

/// Largest number of values along a side: about the pixels of a map on a page. A curve over x has more room.
const MOST: usize = 512;
const MOST_ALONG_A_ROW: usize = 8192;
const MAGIC: [u8; 4] = *b"map2";
/// Magnitudes that single precision holds with all its digits.
const SINGLE: [f64; 2] = [1e-30, 1e30];

/// Cells of a field: all of them, or those that keep shares, means and extrema ([`plots::shown_cells`]).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FieldView {
    /// Cells of the field.
    pub cells: Cells,
    /// Columns and rows that are shown.
    pub shown: Cells,
    /// The smallest and the largest value of the field; `None` where none is defined.
    pub ends: Option<(f64, f64)>,
    /// Factor of the values: 1, unless single precision cannot hold them.
    pub factor: f64,
    /// Row-major; NaN where points are undefined.
    pub values: Vec<f32>,
    /// The cell of each value: its column and its row, counted from the first cell on its pixel. Empty where
    /// every cell is shown.
    pub places: Vec<[u8; 2]>,
}

impl FieldView {
    /// From the values of a field, row-major, not finite where undefined.
    pub fn new(cells: Cells, values: &[f64]) -> Self {
        let most = if cells.rows == 1 { MOST_ALONG_A_ROW } else { MOST };
        let (shown, of) = plots::shown_cells(cells, most, values);
        let (low, high) = plots::FieldPicture::ends(values);
        let largest = low.abs().max(high.abs());
        let held = (SINGLE[0]..=SINGLE[1]).contains(&largest) || !(low <= high && largest > 0.0);
        let factor = if held { 1.0 } else { largest };
        let value =
            |cell: &usize| if values[*cell].is_finite() { (values[*cell] / factor) as f32 } else { f32::NAN };
        let place = |(i, cell): (usize, &usize)| {
            let at = [i % shown.columns, i / shown.columns];
            let first = [at[0] * cells.columns / shown.columns, at[1] * cells.rows / shown.rows];
            [cell % cells.columns - first[0], cell / cells.columns - first[1]].map(|offset| offset as u8)
        };
        let places = if shown == cells { Vec::new() } else { of.iter().enumerate().map(place).collect() };
        let values = of.iter().map(value).collect();
        Self { cells, shown, ends: (low <= high).then_some((low, high)), factor, values, places }
    }

    /// The sentence below its picture, where it has fewer values than cells.
    pub fn reduction(&self) -> Option<String> {
        plots::reduction(self.cells, self.shown)
    }

    /// The values of the first row over the middles of their cells.
    pub fn row(&self, length: f64) -> Vec<(f64, f64)> {
        let middle = |i: usize| {
            let first = i * self.cells.columns / self.shown.columns;
            let column = first + self.places.get(i).map_or(0, |place| usize::from(place[0]));
            (column as f64 + 0.5) / self.cells.columns as f64 * length
        };
        let values = self.values.iter().take(self.shown.columns).enumerate();
        values.map(|(i, &value)| (middle(i), f64::from(value) * self.factor)).collect()
    }

    /// As bytes, little-endian.
    pub fn encode(&self) -> Vec<u8> {
        let head = [self.cells, self.shown].map(|Cells { columns, rows }| [columns, rows].map(|n| n as u64));
        let (low, high) = self.ends.unwrap_or((f64::NAN, f64::NAN));
        let mut bytes = MAGIC.to_vec();
        bytes.extend(head.as_flattened().iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend([low, high, self.factor].iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(self.values.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend_from_slice(self.places.as_flattened());
        bytes
    }

    /// From bytes; `None` where they are none of [`FieldView::encode`].
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let (head, rest) = bytes.strip_prefix(&MAGIC)?.split_at_checked(56)?;
        let words = head.as_chunks().0;
        let number = |i: usize| {
            usize::try_from(u64::from_le_bytes(words[i])).ok().filter(|n| (1..1 << 24).contains(n))
        };
        let cells = Cells { columns: number(0)?, rows: number(1)? };
        let shown = Cells { columns: number(2)?, rows: number(3)? };
        let [low, high, factor] = [4, 5, 6].map(|i| f64::from_le_bytes(words[i]));
        let count =
            shown.checked_count().filter(|_| shown.columns <= cells.columns && shown.rows <= cells.rows)?;
        let (values, places) = rest.split_at_checked(count.checked_mul(4)?)?;
        let places = places.as_chunks().0;
        let expected = if shown == cells { 0 } else { count };
        if places.len() != expected || rest.len() != 4 * count + 2 * expected {
            return None;
        }
        let values = values.as_chunks().0.iter().map(|v| f32::from_le_bytes(*v)).collect();
        let ends = (low <= high).then_some((low, high));
        Some(Self { cells, shown, ends, factor, values, places: places.to_vec() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_that_of_its_cell() {
        let cells = Cells { columns: 1400, rows: 601 };
        let mut values: Vec<f64> = (0..1400 * 601_u64).map(|i| (i * 7919 % 1000) as f64).collect();
        values[5] = f64::NAN;
        let view = FieldView::new(cells, &values);
        assert_eq!((view.shown, view.ends), (Cells { columns: 512, rows: 220 }, Some((0.0, 999.0))));
        for (i, (&v, place)) in view.values.iter().zip(&view.places).enumerate() {
            let [x, y] = place.map(usize::from);
            let (x, y) = (i % 512 * 1400 / 512 + x, i / 512 * 601 / 220 + y);
            let value = values[y * 1400 + x] as f32;
            assert!(value.to_bits() == v.to_bits(), "{x}, {y}");
        }
        let shown =
            |of: &dyn Fn(f64) -> f64| view.values.iter().map(|v| of(f64::from(*v))).sum::<f64>() / 112_640.0;
        let mean = shown(&|v| if v.is_finite() { v } else { 0.0 });
        assert!((mean - 499.5).abs() < 1.0, "{mean}");
        let bytes = view.encode();
        let read = FieldView::decode(&bytes).unwrap();
        assert_eq!((read.places, read.ends, read.values.len()), (view.places.clone(), view.ends, 112_640));
        for end in [0, 3, 10, 28, 60, bytes.len() - 1] {
            assert!(FieldView::decode(&bytes[..end]).is_none());
        }
        let small = FieldView::new([2, 1].into(), &[f64::NAN, 1.0]);
        assert_eq!((small.shown, small.places.len(), small.ends), (small.cells, 0, Some((1.0, 1.0))));
        assert_eq!(FieldView::decode(&small.encode()).unwrap().row(4.0)[1], (3.0, 1.0));
    }

    #[test]
    fn numbers_beyond_single_precision_are_shown() {
        for scale in [1e-310, 1.0, 1.7e308] {
            let view = FieldView::new([3, 1].into(), &[0.0, -0.5 * scale, scale]);
            let values: Vec<f64> = view.row(3.0).iter().map(|(_, v)| v / scale).collect();
            assert!((values[1] + 0.5).abs() < 1e-6 && (values[2] - 1.0).abs() < 1e-6, "{values:?}");
        }
        let nothing = FieldView::new([2, 2].into(), &[f64::NAN; 4]);
        assert_eq!((nothing.ends, nothing.factor), (None, 1.0));
        assert_eq!(FieldView::new([2, 2].into(), &[0.0; 4]).ends, Some((0.0, 0.0)));
    }
}
