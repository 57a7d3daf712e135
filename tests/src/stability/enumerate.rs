//! The slow and simple reference implementation: it tries every contact set.

use crate::stability::plain::{PlainSum, eliminate};
use contact_model::{HeightMap, NormalLoad};

/// A solution of the contact conditions on a small map with modulus 1.
#[derive(Debug, Clone, PartialEq)]
pub struct SmallContact {
    /// Contact cells, ascending indices into the map.
    pub contact: Vec<usize>,
    /// Force on each of them.
    pub forces: Vec<f64>,
    /// Sum of the forces.
    pub force: f64,
    /// Approach from first touch.
    pub approach: f64,
    /// `1' K^-1 1` on the contact set.
    pub stiffness: f64,
    /// Distance from a tie: the smallest of the positive forces over the mean one and of the positive gaps
    /// over the approach.
    pub margin: f64,
}

/// All contact sets among the `cells` (at most 16; all others must be out of reach) that satisfy `p > 0`
/// inside and `g > 0` outside, by trying every one of them with Gauss's elimination. Exactly one should be
/// found.
///
/// Cost O(2^n n^3).
///
/// # Panics
/// For more than 16 cells.
pub fn every_contact_set(map: &HeightMap, cells: &[usize], load: NormalLoad) -> Vec<SmallContact> {
    assert!(cells.len() <= 16, "every set of {} cells is too many", cells.len());
    (1..1_u32 << cells.len())
        .filter_map(|mask| {
            let (inside, outside): (Vec<_>, Vec<_>) = (0..cells.len()).partition(|bit| mask >> bit & 1 == 1);
            let of = |bits: Vec<usize>| bits.into_iter().map(|b| cells[b]).collect::<Vec<_>>();
            one_set(map, of(inside), &of(outside), load)
        })
        .collect()
}

fn one_set(
    map: &HeightMap,
    contact: Vec<usize>,
    outside: &[usize],
    load: NormalLoad,
) -> Option<SmallContact> {
    let plain = PlainSum::of(map);
    let highest = map.highest();
    let z = |i: usize| highest - map.heights()[i];
    let k = |i: usize, j: usize| plain.between(i, j);
    let matrix: Vec<Vec<f64>> = contact.iter().map(|&i| contact.iter().map(|&j| k(i, j)).collect()).collect();
    // f = d q - r with K q = 1, K r = z.
    let q = eliminate(matrix.clone(), vec![1.0; contact.len()]);
    let r = eliminate(matrix, contact.iter().map(|&i| z(i)).collect());
    let stiffness: f64 = q.iter().sum();
    let approach = match load {
        NormalLoad::Force(force) => (force + r.iter().sum::<f64>()) / stiffness,
        NormalLoad::Approach(d) => d,
        _ => return None,
    };
    let forces: Vec<f64> = q.iter().zip(&r).map(|(q, r)| approach * q - r).collect();
    let force: f64 = forces.iter().sum();
    let gap =
        |i: usize| contact.iter().zip(&forces).map(|(&j, f)| k(i, j) * f).sum::<f64>() + z(i) - approach;
    let mean = force / contact.len() as f64;
    let margin = (forces.iter().map(|f| f / mean))
        .chain(outside.iter().map(|&i| gap(i) / approach))
        .fold(f64::INFINITY, f64::min);
    (margin > 0.0 && force > 0.0).then_some(SmallContact {
        contact,
        forces,
        force,
        approach,
        stiffness,
        margin,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use bem3d::love::influence;
    use std::f64::consts::PI;

    #[test]
    fn two_cells_of_which_one_is_out_of_reach_until_it_is_not() {
        let map = HeightMap::new(2, 2.0, vec![0.0, -1.0, -1e3, -1e3]).unwrap();
        let one = every_contact_set(&map, &[0, 1], NormalLoad::Approach(1.0));
        assert_eq!(one.len(), 1);
        assert_eq!(one[0].contact, [0]);
        assert_relative_eq!(one[0].stiffness, PI / influence(0, 0), max_relative = 1e-14);
        let both = every_contact_set(&map, &[0, 1], NormalLoad::Approach(10.0));
        assert_eq!((both.len(), both[0].contact.len()), (1, 2));
        assert_relative_eq!(
            both[0].stiffness,
            2.0 * PI / (influence(0, 0) + influence(1, 0)),
            max_relative = 1e-14
        );
    }
}
