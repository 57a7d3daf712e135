//! How far the gaps of open cells may still change: what decides whether a cell is open for sure.
//!
//! On a contact set C the displacement of an open cell j follows those of the contact with weights `K_jC K_CC^-1`. Where K on C is an
//! inverse M-matrix they are positive and their sum is below 1: no open gap changes by more than the largest gap left on the contact.
//! Nor does a far gap change it much. Next to a straight edge of the contact the weights beyond a distance R add up to
//! `(2 / pi) asin sqrt(1 / R)` in cells; of one open cell within the contact, to a few hundredths.

use crate::geometry::{CellSet, Grid};
use crate::tuning::Tuning;

/// Bounds of the change that an open gap can still undergo, square by square, from the gaps left on the contact.
#[derive(Debug)]
struct ChangeBound {
    square: usize,
    across: usize,
    values: Vec<f64>,
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
        Self { square, across, values: (0..across * down).map(bound).collect() }
    }

    /// At a cell.
    fn at(&self, x: usize, y: usize) -> f64 {
        self.values[y / self.square * self.across + x / self.square]
    }
}

/// The cells without contact whose gap is below what it can still change; `contact` is a subset of `checked`, `left` the gap on it.
pub fn undecided(
    grid: Grid,
    contact: &CellSet,
    left: &[f64],
    checked: &CellSet,
    gap: &[f64],
    tuning: &Tuning,
) -> CellSet {
    let bound = ChangeBound::new(grid, contact, left, tuning.undecided_square, tuning.undecided_far);
    let mut places = checked.places();
    checked.filter_beside(contact, |k, in_contact| {
        let (x, y) = places.next().unwrap_or_default();
        !in_contact && gap[k] < bound.at(x, y)
    })
}
