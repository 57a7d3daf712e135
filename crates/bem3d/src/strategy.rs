//! Which way is the cheapest: pure functions of the work at hand with measured constants.

use crate::operator::convolution::Lengths;

/// Nanoseconds of one kernel look-up and addition of the direct sum, for scattered cells (short rows).
const PAIR_NS: f64 = 2.0;
/// Nanoseconds per point of a padded transform, per log2 of the points: one application in f64, fully populated.
const POINT_NS: f64 = 0.30;
/// The same in f32, relative to f64.
const SINGLE: f64 = 0.5;
/// Nanoseconds per multiplication of a Cholesky factorisation.
const FACTOR_NS: f64 = 0.07;
/// Applications that the iterative solution of one active set takes (pressure and stiffness).
const APPLICATIONS: f64 = 20.0;
/// Factorisations that the dense solution of one active set takes.
const FACTORS: f64 = 2.5;
/// A factor is never larger than this, whatever the rest costs (memory: 16 n^2 bytes).
const LARGEST_FACTOR: usize = 6000;
/// Sets up to this size are always factored: the result is exact and costs a millisecond or two.
const ALWAYS_FACTORED: usize = 256;
/// Share of the window in contact from which the spectral preconditioner saves more applications than it costs.
const DENSE_CONTACT: f64 = 0.02;

fn fft_ns(lengths: Lengths) -> f64 {
    let points = lengths.points() as f64;
    POINT_NS * points * points.log2()
}

/// Precision of an application that may be done by transforms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Single.
    Single,
    /// Double.
    Double,
}

/// Whether the sum over all pairs beats one FFT application.
pub fn direct_is_cheaper(sources: usize, targets: usize, lengths: Lengths, precision: Precision) -> bool {
    let share = if precision == Precision::Single { SINGLE } else { 1.0 };
    PAIR_NS * sources as f64 * targets as f64 <= share * fft_ns(lengths)
}

/// Whether an active set of `n` cells is solved by factorisation.
pub fn dense_is_cheaper(n: usize, lengths: Lengths) -> bool {
    let cells = n as f64;
    let factor = FACTORS * (FACTOR_NS * cells.powi(3) / 3.0 + 4.0 * cells * cells);
    let iterate = APPLICATIONS * (SINGLE * fft_ns(lengths)).min(PAIR_NS * cells * cells);
    n <= ALWAYS_FACTORED || (n <= LARGEST_FACTOR && factor <= iterate)
}

/// Whether conjugate gradients use the spectral preconditioner.
pub fn precondition(contact: usize, window_cells: usize) -> bool {
    contact as f64 >= DENSE_CONTACT * window_cells as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Lengths = Lengths { x: 4096, y: 4096 };

    #[test]
    fn small_sets_never_pay_for_the_grid() {
        assert!(direct_is_cheaper(300, 3000, GRID, Precision::Double));
        assert!(dense_is_cheaper(200, GRID));
        assert!(!direct_is_cheaper(100_000, 100_000, GRID, Precision::Double));
        assert!(!direct_is_cheaper(6000, 6000, GRID, Precision::Single));
        assert!(direct_is_cheaper(6000, 6000, GRID, Precision::Double));
        assert!(!dense_is_cheaper(50_000, GRID));
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
    fn the_preconditioner_is_for_dense_contact() {
        assert!(!precondition(10, 1000));
        assert!(precondition(30, 1000));
    }
}
