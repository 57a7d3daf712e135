//! Which way is the cheapest: pure functions of the work at hand with measured constants.

use crate::cells::{CellSet, Window};
use crate::operator::convolution::Lengths;
use crate::operator::lattice::Split;

/// Nanoseconds of one kernel look-up and addition of the direct sum, for scattered cells (short rows).
const PAIR_NS: f64 = 2.0;
/// Nanoseconds per point of a padded transform, per log2 of the points: one application in f64, fully populated.
const POINT_NS: f64 = 0.17;
/// The same in f32, relative to f64.
const SINGLE: f64 = 0.65;
/// Nanoseconds of one close pair of the two-level operator, its short runs and misses counted in.
const CLOSE_PAIR_NS: f64 = 3.0;
/// Nanoseconds of one interpolation weight of the two-level operator.
const SPREAD_NS: f64 = 1.0;
/// Reach and order of the two-level operator: an error of 4e-5 of the largest displacement in the test of `lattice`. A direction
/// along which that makes the curvature negative ends the correction; the exact look that follows sees what is left.
const REACH: usize = 6;
const ORDER: usize = 6;
/// Two levels are for at most one contact cell in so many of the window ...
const SCATTERED: usize = 20;
/// ... and for at most so many.
const LARGEST_SCATTERED: usize = 200_000;
/// Nanoseconds per multiplication of a Cholesky factorisation.
const FACTOR_NS: f64 = 0.07;
/// Applications that the iterative solution of one active set takes (pressure and stiffness).
const APPLICATIONS: f64 = 20.0;
/// Factorisations that the dense solution of one active set takes.
const FACTORS: f64 = 2.5;
/// A factor is never larger than this, whatever the rest costs (memory: 16 n^2 bytes).
pub const LARGEST_FACTOR: usize = 6000;
/// Sets up to this size are always factored: the result is exact and costs a millisecond or two.
const ALWAYS_FACTORED: usize = 256;
/// From one contact cell in so many of the grid on, runs of cells with extended residuals take half the steps of lists, which makes up for
/// transforms of the whole grid ...
const FILLED: usize = 300;
/// ... unless the window of the contact is smaller than this share of it.
const WINDOW: f64 = 0.6;
/// Where one cell in so many will touch, no tangent is followed far.
const FILLING: f64 = 10.0;
/// Where one cell in so many will touch, the cells that a tangent promises are counted before it is followed ...
const COUNTED: f64 = 200.0;
/// ... and it is not if they are so many times what the load has grown by.
const OVERSHOOT: f64 = 2.5;
/// Ratio of loads that a tangent covers.
const NEAR: std::ops::RangeInclusive<f64> = 0.8..=1.25;
/// Share of the window in contact from which the spectral preconditioner saves more applications than it costs.
const DENSE_CONTACT: f64 = 0.02;

fn fft_ns(lengths: Lengths) -> f64 {
    let points = lengths.points() as f64;
    POINT_NS * points * points.log2()
}

/// How one application of K is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// Sum over all pairs.
    Direct,
    /// Smooth part on a lattice, near part by pairs.
    TwoLevel(Split),
    /// Transform of the window.
    Fft,
}

/// The cheaper exact way between two sets: direct sums or a transform in double precision.
pub fn exact_choice(sources: usize, targets: usize, lengths: Lengths) -> Choice {
    let direct = PAIR_NS * sources as f64 * targets as f64;
    if direct <= fft_ns(lengths) { Choice::Direct } else { Choice::Fft }
}

/// The cheapest way to five digits or more between two sets inside a window.
///
/// Cost: nothing for a dense set, a count of the cells on coarse tiles for a scattered one.
pub fn fast_choice(sources: &CellSet, targets: &CellSet, window: Window) -> Choice {
    let direct = PAIR_NS * sources.len() as f64 * targets.len() as f64;
    let fft = SINGLE * fft_ns(Lengths::free(window));
    let mut best = if direct <= fft { (direct, Choice::Direct) } else { (fft, Choice::Fft) };
    let cells = sources.len().max(targets.len());
    if cells > LARGEST_SCATTERED || cells * SCATTERED > window.width * window.height {
        return best.1;
    }
    for spacing in [4, 8, 16, 32] {
        let split = Split { spacing, reach: REACH, order: ORDER };
        let transform = fft_ns(Lengths::free(split.lattice(window)));
        let spread = SPREAD_NS * (ORDER * ORDER * (sources.len() + targets.len())) as f64;
        if transform + spread >= best.0 {
            continue;
        }
        let near = CLOSE_PAIR_NS * close_pairs(sources, targets, split.radius());
        if transform + spread + near < best.0 {
            best = (transform + spread + near, Choice::TwoLevel(split));
        }
    }
    best.1
}

/// About how many pairs lie within a radius: each tile of that size with the nine around it, by the share of a disc.
fn close_pairs(sources: &CellSet, targets: &CellSet, radius: usize) -> f64 {
    let tiles = sources.side() / radius + 3;
    let count = |set: &CellSet| {
        let mut tile = vec![0u32; tiles * tiles];
        for row in set.rows() {
            let line = (row.y / radius + 1) * tiles + 1;
            for &i in &set.index()[row.span.clone()] {
                tile[line + (i as usize - row.y * set.side()) / radius] += 1;
            }
        }
        tile
    };
    let (a, b) = (count(sources), count(targets));
    let mut pairs = 0.0;
    for y in 1..tiles - 1 {
        for x in 1..tiles - 1 {
            let here = f64::from(b[y * tiles + x]);
            if here > 0.0 {
                let around = (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| y * tiles + x));
                pairs += here * around.map(|t| f64::from(a[t])).sum::<f64>();
            }
        }
    }
    pairs * std::f64::consts::PI / 9.0
}

/// Whether an active set of `n` cells is solved by factorisation.
pub fn dense_is_cheaper(n: usize, lengths: Lengths) -> bool {
    let cells = n as f64;
    let factor = FACTORS * (FACTOR_NS * cells.powi(3) / 3.0 + 4.0 * cells * cells);
    let iterate = APPLICATIONS * (SINGLE * fft_ns(lengths)).min(PAIR_NS * cells * cells);
    n <= ALWAYS_FACTORED || (n <= LARGEST_FACTOR && factor <= iterate)
}

/// Whether the contact fills the grid so far that runs of cells over the whole grid are cheaper than lists in a window.
pub fn fills(contact: &CellSet) -> bool {
    let cells = contact.side() * contact.side();
    contact.len() > LARGEST_FACTOR
        && contact.len() * FILLED >= cells
        && contact.window_cells() as f64 >= WINDOW * cells as f64
}

/// Whether a load that is `ratio` times the last one begins on coarse grids although a state is known.
///
/// The tangent overshoots (the stiffness grows with every cell that joins); where it promises far more cells than the load
/// has grown by, eliminating them costs more than a coarse solution at a third of the price. `promised` counts them with one
/// application; where a good part of the grid will touch, the answer is known without.
pub fn start_anew(last: &CellSet, ratio: f64, promised: impl FnOnce() -> usize) -> bool {
    let (expected, all) = (last.len() as f64 * ratio, (last.side() as f64).powi(2));
    !NEAR.contains(&ratio)
        && (expected * FILLING >= all
            || (expected * COUNTED >= all && promised() as f64 > OVERSHOOT * expected))
}

/// Whether conjugate gradients use the spectral preconditioner.
pub fn precondition(contact: usize, window_cells: usize) -> bool {
    contact as f64 >= DENSE_CONTACT * window_cells as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Lengths = Lengths { x: 4096, y: 4096 };
    const WINDOW: Window = Window { x: 0, y: 0, width: 2049, height: 2049 };

    /// One cell in `step`, all over the grid.
    fn every(step: usize) -> CellSet {
        CellSet::new(2049, (0..2049 * 2049_u32).step_by(step).collect())
    }

    #[test]
    fn small_sets_never_pay_for_the_grid() {
        assert_eq!(exact_choice(300, 3000, GRID), Choice::Direct);
        assert_eq!(exact_choice(100_000, 100_000, GRID), Choice::Fft);
        assert!(dense_is_cheaper(200, GRID));
        assert!(!dense_is_cheaper(50_000, GRID));
    }

    #[test]
    fn direct_two_levels_and_transform_in_this_order() {
        let choice = |set: &CellSet| fast_choice(set, set, WINDOW);
        assert_eq!(choice(&every(200_000)), Choice::Direct);
        assert!(matches!(choice(&every(400)), Choice::TwoLevel(_)));
        assert_eq!(choice(&every(3)), Choice::Fft);
    }

    #[test]
    fn close_pairs_are_counted_well_enough() {
        let set = every(41);
        let estimate = close_pairs(&set, &set, 48);
        let uniform = set.len() as f64 * std::f64::consts::PI * 48.0 * 48.0 / 41.0;
        assert!((0.8..1.1).contains(&(estimate / uniform)), "{}", estimate / uniform);
    }

    #[test]
    fn the_choice_is_monotone_in_the_size_of_the_set() {
        let small = Lengths { x: 64, y: 64 };
        for lengths in [small, GRID] {
            let dense: Vec<bool> = (1..9000).step_by(50).map(|n| dense_is_cheaper(n, lengths)).collect();
            assert!(dense.windows(2).all(|w| w[0] || !w[1]), "once too large, always too large");
        }
        assert!(!dense_is_cheaper(LARGEST_FACTOR + 1, Lengths { x: 1 << 20, y: 1 << 20 }));
    }

    #[test]
    fn arrays_are_for_contact_that_fills_the_grid() {
        let full = |side: usize| CellSet::new(side, (0..(side * side) as u32).collect());
        assert!(!fills(&full(77)) && fills(&full(78)), "small sets are factored");
        assert!(fills(&every(FILLED - 10)) && !fills(&every(FILLED + 10)));
        // A window of little more than half of the grid is cheaper by itself.
        let rows = |count: u32| CellSet::new(2049, (0..2049 * count).collect());
        assert!(fills(&rows(1300)) && !fills(&rows(1100)));
    }

    #[test]
    fn a_tangent_is_followed_unless_it_overshoots() {
        let (few, many) = (every(20_000), every(8));
        let count = |n: usize| move || n;
        assert!(!start_anew(&few, 2.0, count(usize::MAX)), "few cells: nothing to save");
        assert!(!start_anew(&many, 1.1, count(usize::MAX)), "a small step");
        assert!(start_anew(&many, 2.0, || unreachable!("much will touch: no need to count")));
        let scattered = every(200);
        assert!(start_anew(&scattered, 2.0, count(20 * scattered.len())));
        assert!(!start_anew(&scattered, 2.0, count(3 * scattered.len())));
    }

    #[test]
    fn the_preconditioner_is_for_dense_contact() {
        assert!(!precondition(10, 1000));
        assert!(precondition(30, 1000));
    }
}
