//! How far the gaps of open cells may still move: what decides whether a cell is open for sure.
//!
//! On a contact set C the displacement of an open cell j follows those of the contact with weights `K_jC K_CC^-1`. Where K on C is an
//! inverse M-matrix they are positive and their sum is below 1: no open gap moves by more than the largest gap that is left on the contact.
//! Nor does a far gap move it much. Next to a straight edge of the contact the weights beyond a distance R add up to
//! `(2 / pi) asin sqrt(1 / R)` in cells; of one open cell within the contact, to a few hundredths.

use crate::cells::CellSet;
use std::ops::Range;

/// Cells a side of the squares in which the largest gap is kept; near a cell are its own square and the eight around.
const SQUARE: usize = 32;
/// What the weights beyond them add up to: 0.113 next to a straight edge.
const FAR: f64 = 0.125;

/// Bounds of the change that an open gap can still undergo, from the gaps left on the contact.
#[derive(Debug)]
pub struct Margin {
    square: usize,
    /// Squares a side.
    count: usize,
    largest: Vec<f64>,
}

impl Margin {
    /// Of a grid of `side^2` cells, nothing left anywhere.
    pub fn new(side: usize) -> Self {
        Self::with(side, SQUARE)
    }

    fn with(side: usize, square: usize) -> Self {
        let count = side.div_ceil(square).max(1);
        Self { square, count, largest: vec![0.0; count * count] }
    }

    /// From gaps on cells that press.
    pub fn of(side: usize, gaps: impl Iterator<Item = (u32, f64)>) -> Self {
        let mut margin = Self::new(side);
        for (cell, gap) in gaps {
            let (x, y) = (cell as usize % side, cell as usize / side);
            margin.leave(y, x..x + 1, [gap]);
        }
        margin
    }

    /// Takes the gaps left on cells of row y.
    pub fn leave(&mut self, y: usize, columns: Range<usize>, gaps: impl IntoIterator<Item = f64>) {
        let row = y / self.square * self.count;
        for (x, gap) in columns.zip(gaps) {
            let largest = &mut self.largest[row + x / self.square];
            *largest = gap.abs().max(*largest);
        }
    }

    /// The bounds, square by square.
    pub fn bounds(self) -> Bounds {
        let Self { square, count, largest } = self;
        let far = largest.iter().fold(0.0, |m: f64, &g| m.max(g));
        // A periodic square goes on at its other side; where it does not, a few more cells count.
        let around = |i: usize| [(i + count - 1) % count, i, (i + 1) % count];
        let values = (0..count * count)
            .map(|i| {
                let near = around(i / count)
                    .into_iter()
                    .flat_map(|y| around(i % count).map(|x| largest[y * count + x]))
                    .fold(0.0, f64::max);
                far.min(near + FAR * far)
            })
            .collect();
        Bounds { square, count, values }
    }
}

/// Bounds at each place.
#[derive(Debug)]
pub struct Bounds {
    square: usize,
    count: usize,
    values: Vec<f64>,
}

impl Bounds {
    /// At a cell.
    pub fn at(&self, x: usize, y: usize) -> f64 {
        self.values[y / self.square * self.count + x / self.square]
    }

    /// Those of row y: columns that share one.
    pub fn row(&self, y: usize, side: usize) -> impl Iterator<Item = (Range<usize>, f64)> + '_ {
        let row = y / self.square * self.count;
        (0..self.count)
            .map(move |i| (i * self.square..((i + 1) * self.square).min(side), self.values[row + i]))
    }
}

/// The cells of a list without pressure whose gap is below its bound.
pub fn undecided(checked: &CellSet, p: &[f64], gap: &[f64]) -> CellSet {
    let left = checked.index().iter().zip(p.iter().zip(gap)).filter(|&(_, (&p, _))| p > 0.0);
    let bounds = Margin::of(checked.side(), left.map(|(&i, (_, &gap))| (i, gap))).bounds();
    checked.filter(|k| {
        let (x, y) = checked.place(k);
        p[k] <= 0.0 && gap[k] < bounds.at(x, y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::dense::Factor;
    use crate::operator::{Operators, Table};
    use approx::assert_relative_eq;
    use contact_model::Boundary;
    use proptest::prelude::*;

    #[test]
    fn near_gaps_count_whole_far_ones_by_an_eighth() {
        let mut margin = Margin::with(12, 3);
        margin.leave(4, 4..6, [-0.5, 0.25]);
        margin.leave(10, 0..1, [2.0]);
        let bounds = margin.bounds();
        // Squares of 3 x 3 cells, 4 a side; those at opposite edges are neighbours.
        assert_relative_eq!(bounds.at(0, 0), 2.0);
        assert_relative_eq!(bounds.at(8, 8), 0.75);
        assert_relative_eq!(bounds.at(5, 5), 0.75);
        assert_relative_eq!(bounds.at(9, 8), 2.0);
        let row: Vec<_> = bounds.row(4, 11).collect();
        assert_eq!(row, [(0..3, 0.75), (3..6, 0.75), (6..9, 0.75), (9..11, 0.25)]);
        assert_relative_eq!(Margin::new(1).bounds().at(0, 0), 0.0);
    }

    #[test]
    fn undecided_by_hand() {
        let checked = CellSet::new(200, vec![0, 1, 31, 4190, 4191, 30_000]);
        let p = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        // Left over: 0.8 in the first corner, 0.1 at column 190 of row 20.
        let gap = [-0.8, 0.79, 0.81, 0.1, 0.21, -1e-9];
        assert_eq!(undecided(&checked, &p, &gap).index(), [1, 30_000]);
        let near = [-0.8, 0.79, 0.81, 0.1, 0.19, -1e-9];
        assert_eq!(undecided(&checked, &p, &near).index(), [1, 4191, 30_000]);
    }

    /// Change of all open gaps when the gaps left on the contact are made zero.
    fn moved(side: usize, contact: &CellSet, gap: &[f64]) -> Vec<f64> {
        let table = Table::shared(side, Boundary::Free);
        let factor = Factor::new(&table, contact).unwrap();
        let (_, p) = factor.solve_pair(gap);
        let all = CellSet::new(side, (0..(side * side) as u32).collect());
        Operators::new(table).exact(contact, &p, &all)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn no_open_gap_next_to_contact_moves_further(
            picks in proptest::collection::vec(0f64..1.0, 4000),
            share in 0.1f64..0.9,
        ) {
            // Contact on one half and on scattered cells of the other; what is left differs by decades from place to place.
            let (side, square) = (40, 8);
            let mut picks = picks.into_iter();
            let mut pick = || picks.next().unwrap();
            let index = (0..1600u32).filter(|i| i % 40 < 20 || pick() < share).collect();
            let contact = CellSet::new(side, index);
            let scale: Vec<f64> = (0..25).map(|_| 10f64.powf(-3.0 * pick())).collect();
            let gap: Vec<f64> = contact
                .index()
                .iter()
                .map(|&i| scale[(i as usize / 40 / 8) * 5 + i as usize % 40 / 8] * (2.0 * pick() - 1.0))
                .collect();
            let mut margin = Margin::with(side, square);
            for (&i, &gap) in contact.index().iter().zip(&gap) {
                margin.leave(i as usize / side, i as usize % side..i as usize % side + 1, [gap]);
            }
            let bounds = margin.bounds();
            for (i, change) in moved(side, &contact, &gap).into_iter().enumerate() {
                if contact.index().binary_search(&(i as u32)).is_err() {
                    let bound = bounds.at(i % side, i / side);
                    prop_assert!(change.abs() < bound, "{change} {bound} at {i}");
                }
            }
        }
    }
}
