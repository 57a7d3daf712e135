//! The displacement of open cells beside a contact, estimated from that of the contact.
//!
//! Where the net pressure acts on the contact C alone, the displacement of an open cell is the mean of those
//! of all other cells, weighed with the magnitudes of the inverse kernel, about `1/r^3`, because `G^-1 u = 0`
//! there. Here closed cells nearby enter with their displacement, open ones nearby with that of the cell
//! itself, and cells further away with zero. With W the weights of contact cells nearby this is
//!
//! ```text
//! u_Z = E u_C,    E = diag(1/(W 1 + f)) W,
//! ```
//!
//! a rough `G_ZC G_CC^-1`. Its transpose is the pressure that takes back most of what a pressure on open
//! cells displaces the contact by.

use super::attraction::Attraction;
use super::law::LawShape;
use super::neighbours::Neighbours;
use super::pairs::Pairs;
use crate::geometry::{CellSet, Grid};
use crate::real::update;
use contact_model::Boundary;

// Half and twice the value of both constants change the work of the paths with a short range by less than 1 %.

/// Cells nearer than this count, in sides of a square cell.
const NEIGHBOURHOOD: f64 = 3.5;
/// Weight of the cells further away, as a share of the weights of all nearer ones.
const FURTHER: f64 = 0.05;

/// E and its transpose, on the cells of a set.
#[derive(Debug, Default)]
pub struct Near {
    pairs: Pairs,
    transposed: Pairs,
    /// `1/(W 1 + f)` on open cells, 0 on contact.
    scale: Vec<f32>,
}

impl Near {
    /// [`Near::new`] where the attraction is of short range: with other laws there are too many open cells
    /// for this correction to pay.
    pub fn of(
        attraction: &Attraction,
        grid: (Grid, Boundary),
        cells: &CellSet,
        is_open: &[f32],
    ) -> Option<Self> {
        (attraction.law.shape == LawShape::Smooth).then(|| Self::new(grid, cells, is_open))
    }

    /// On the cells of a set; `is_open` is 1 on open cells and 0 on closed ones.
    pub fn new((grid, boundary): (Grid, Boundary), cells: &CellSet, is_open: &[f32]) -> Self {
        let around = Neighbours::around(grid, boundary == Boundary::Periodic, NEIGHBOURHOOD);
        let of_contact = |_: usize, k: usize, weight: f64| if is_open[k] > 0.0 { 0.0 } else { weight };
        let pairs = around.pairs(cells, |i| is_open[i] > 0.0, of_contact);
        let mut scale = vec![FURTHER as f32; cells.len()];
        pairs.add_product(1.0, &vec![1.0; cells.len()], &mut scale);
        update(&mut scale, is_open, |scale, open| *scale = open / *scale);
        Self { transposed: pairs.transposed(), pairs, scale }
    }

    /// From values on contact, `E u`; 0 on contact.
    pub fn extend(&self, u: &[f32], out: &mut [f32]) {
        out.fill(0.0);
        self.pairs.add_product(1.0, u, out);
        update(out, &self.scale, |out, scale| *out *= scale);
    }

    /// Subtracts `E' p` of values on open cells from those on contact; p is changed.
    pub fn subtract_transposed(&self, p: &mut [f32], out: &mut [f32]) {
        update(p, &self.scale, |p, scale| *p *= scale);
        self.transposed.add_product(-1.0, p, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::dot;

    #[test]
    fn the_transpose_is_one_and_cells_beside_a_contact_follow_it() {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let grid = Grid { columns: 12, rows: 9, stretch: 1.2 };
            let cells = CellSet::numbered(grid, |i| i % 7 != 3);
            let open = CellSet::numbered(grid, |i| i % 12 > 5);
            let is_open: Vec<f32> = cells.carry(&open, &vec![1.0; open.len()]);
            let near = Near::new((grid, boundary), &cells, &is_open);
            let wave = |shift: f32| -> Vec<f32> {
                (0..cells.len()).map(|i| (1.3 * i as f32 + shift).sin()).collect()
            };
            let (u, p) = (wave(0.0), wave(1.0));
            let mut extended = vec![0.0; u.len()];
            near.extend(&u, &mut extended);
            let mut taken = vec![0.0; u.len()];
            near.subtract_transposed(&mut p.clone(), &mut taken);
            approx::assert_relative_eq!(dot(&p, &extended), -dot(&taken, &u), max_relative = 1e-5);
            near.extend(&vec![1.0; u.len()], &mut extended);
            for ((x, _), (u, open)) in cells.places().zip(extended.iter().zip(&is_open)) {
                // Next to the contact and far from it.
                let expected = match x {
                    _ if *open <= 0.0 => 0.0..1e-6,
                    6 => 0.6..1.0,
                    _ => 0.0..1.0,
                };
                assert!(expected.contains(u), "{x} {u}");
            }
        }
    }
}
