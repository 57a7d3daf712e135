//! Bounds on the change of the gaps of open cells, which decide whether a cell is certainly open.
//!
//! On a contact set C the displacement of an open cell j follows those of the contact with weights
//! `G_jC G_CC^-1`. Where G on C is an inverse M-matrix they are positive and their sum is below 1: no open
//! gap changes by more than the largest gap left on the contact. Nor does a far gap change it much. Next to a
//! straight edge of the contact the weights beyond a distance R add up to `(2 / pi) asin sqrt(1 / R)` in
//! cells; of one open cell within the contact, to a few hundredths.

use super::residuals::ContactGap;
use crate::geometry::{CellSet, Grid};
use crate::tuning::Tuning;

/// Bounds of the change that an open gap can still undergo, square by square, from the gaps left on the
/// contact.
#[derive(Debug)]
struct ChangeBound {
    square: usize,
    across: usize,
    values: Vec<f64>,
    largest: f64,
}

impl ChangeBound {
    /// From the gaps left on the cells of a set.
    fn new(grid: Grid, contact: &CellSet, gap: &[f64], square: usize, share: f64) -> Self {
        let (across, down) = (grid.columns.div_ceil(square), grid.rows.div_ceil(square));
        let mut largest = vec![0.0; across * down];
        for row in contact.rows() {
            let line = &mut largest[row.y / square * across..][..across];
            for (&x, gap) in row.columns.iter().zip(&gap[row.span()]) {
                let largest = &mut line[x as usize / square];
                *largest = gap.abs().max(*largest);
            }
        }
        let far = largest.iter().fold(0.0, |m: f64, &g| m.max(g));
        // A periodic map goes on at its other side; where it does not, a few more cells count.
        let around = |i: usize, n: usize| [(i + n - 1) % n, i, (i + 1) % n];
        let bound = |i: usize| {
            let near = around(i / across, down)
                .into_iter()
                .flat_map(|y| around(i % across, across).map(|x| largest[y * across + x]))
                .fold(0.0, f64::max);
            far.min(near + share * far)
        };
        Self { square, across, values: (0..across * down).map(bound).collect(), largest: far }
    }

    /// At a cell.
    fn at(&self, x: usize, y: usize) -> f64 {
        self.values[y / self.square * self.across + x / self.square]
    }
}

/// The cells without contact whose gap is smaller than the change that it can still undergo.
pub fn undecided(grid: Grid, seen: ContactGap<'_>, tuning: &Tuning) -> CellSet {
    let ContactGap { contact, left, checked, gap } = seen;
    let bound = ChangeBound::new(grid, contact, left, tuning.undecided_square, tuning.undecided_far);
    // Most cells lie above every bound.
    let near = checked.filter(gap, |g| g < bound.largest).without(contact);
    let mut above = near.carry(checked, gap);
    for (g, (x, y)) in above.iter_mut().zip(near.places()) {
        *g -= bound.at(x, y);
    }
    near.filter(&above, |g| g < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::NormalTable;
    use crate::linear::Factor;
    use crate::operator::{DirectSum, InfluenceOperator};
    use approx::assert_relative_eq;
    use contact_model::Boundary;
    use proptest::prelude::*;

    #[test]
    fn near_gaps_count_whole_far_ones_by_an_eighth() {
        let grid = Grid::square(12, 12);
        let index = |x: u32, y: u32| 12 * y + x;
        let contact = CellSet::from_index(grid, &[index(4, 4), index(5, 4), index(0, 10)]);
        let bounds = ChangeBound::new(grid, &contact, &[-0.5, 0.25, 2.0], 3, 0.125);
        // Squares of 3 x 3 cells, 4 a side; those at opposite edges are neighbours.
        for (x, y, expected) in [
            (0, 0, 2.0),
            (8, 8, 0.75),
            (5, 5, 0.75),
            (9, 8, 2.0),
            (2, 4, 0.75),
            (8, 4, 0.75),
            (9, 4, 0.25),
            (11, 4, 0.25),
        ] {
            assert_relative_eq!(bounds.at(x, y), expected);
        }
        let nothing = ChangeBound::new(Grid::square(1, 1), &CellSet::default(), &[], 3, 0.125);
        assert_relative_eq!(nothing.at(0, 0), 0.0);
    }

    #[test]
    fn squares_of_a_rectangle() {
        // Squares of 3 x 3 cells, 3 across and 5 down; the last ones are cut off.
        let grid = Grid::square(8, 13);
        let contact = CellSet::from_index(grid, &[8 * 12 + 7]);
        let bounds = ChangeBound::new(grid, &contact, &[-1.0], 3, 0.125);
        for (x, y, expected) in
            [(7, 12, 1.0), (0, 0, 1.0), (3, 9, 1.0), (4, 8, 0.125), (4, 3, 0.125), (0, 2, 1.0)]
        {
            assert_relative_eq!(bounds.at(x, y), expected);
        }
    }

    #[test]
    fn undecided_by_hand() {
        let grid = Grid::square(200, 200);
        let checked = CellSet::from_index(grid, &[0, 1, 31, 4190, 4191, 30_000]);
        let contact = CellSet::from_index(grid, &[0, 4190]);
        // Gap left: 0.8 in the first corner, 0.1 at column 190 of row 20.
        let found = |gap: [f64; 6]| -> Vec<usize> {
            let left = [gap[0], gap[3]];
            let seen = ContactGap { contact: &contact, left: &left, checked: &checked, gap: &gap };
            undecided(grid, seen, &Tuning::DEFAULT).index(grid).collect()
        };
        assert_eq!(found([-0.8, 0.79, 0.81, 0.1, 0.21, -1e-9]), [1, 30_000]);
        assert_eq!(found([-0.8, 0.79, 0.81, 0.1, 0.19, -1e-9]), [1, 4191, 30_000]);
    }

    #[test]
    fn an_exact_solution_leaves_the_cells_that_penetrate() {
        let grid = Grid::square(3, 3);
        let (all, first) = (CellSet::all(grid), CellSet::from_index(grid, &[0]));
        let found = |gap: [f64; 9]| -> Vec<usize> {
            let seen = ContactGap { contact: &first, left: &gap[..1], checked: &all, gap: &gap };
            undecided(grid, seen, &Tuning::DEFAULT).index(grid).collect()
        };
        // Penetrating, touching, open by less than the gap left, open by as much.
        assert_eq!(found([-0.5, -1.0, 0.0, 0.4, 0.5, 2.0, 2.0, 2.0, 2.0]), [1, 2, 3]);
        assert_eq!(found([0.0, -1e-9, 0.0, 1e-9, 1.0, 1.0, 1.0, 1.0, 1.0]), [1]);
    }

    /// Change of all gaps when the gaps left on the contact are made zero.
    fn changes(grid: Grid, contact: &CellSet, gap: &[f64]) -> Vec<f64> {
        let table = NormalTable::shared(grid, Boundary::Free);
        let (_, p) = Factor::new(&table, contact).unwrap().solve_pair(gap);
        let mut u = vec![0.0; grid.count()];
        DirectSum(&table).apply(contact, &p, &CellSet::all(grid), &mut u);
        u
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn no_open_gap_next_to_contact_changes_more(
            picks in proptest::collection::vec(0f64..1.0, 4000),
            share in 0.1f64..0.9,
            stretch in prop_oneof![Just(1.0), 0.8f64..1.25],
        ) {
            // Contact on one half and on scattered cells of the other; what is left differs by decades from
            // place to place.
            let (grid, square) = (Grid { columns: 40, rows: 36, stretch }, 8);
            let mut picks = picks.into_iter();
            let mut pick = || picks.next().unwrap();
            let index: Vec<u32> =
                (0..grid.count() as u32).filter(|i| i % 40 < 20 || pick() < share).collect();
            let contact = CellSet::from_index(grid, &index);
            let scale: Vec<f64> = (0..25).map(|_| 10f64.powf(-3.0 * pick())).collect();
            let gap: Vec<f64> =
                contact.places().map(|(x, y)| scale[y / 8 * 5 + x / 8] * (2.0 * pick() - 1.0)).collect();
            let bounds = ChangeBound::new(grid, &contact, &gap, square, Tuning::DEFAULT.undecided_far);
            let change = changes(grid, &contact, &gap);
            let all = CellSet::all(grid);
            let open = all.without(&contact);
            for ((x, y), i) in open.places().zip(open.index(grid)) {
                prop_assert!(change[i].abs() < bounds.at(x, y), "{} {} at {i}", change[i], bounds.at(x, y));
            }
        }
    }
}
