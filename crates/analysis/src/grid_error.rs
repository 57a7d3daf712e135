//! Discretisation errors, estimated from the same number on grids half and a quarter as fine, for one state
//! and for a mean over surfaces.

use numerics::quantile::student;
use numerics::sum::sum;

/// Safety factor on the differences, so that nine in ten true errors of resolved contacts are smaller.
const SAFETY: f64 = 1.5;
/// Slowest accepted ratio of the differences from one halving of the cells to the next: a lower order from
/// three grids is mostly chance.
const SLOWEST: f64 = 0.75;
/// Fastest accepted ratio for one number: first order.
const FASTEST: f64 = 0.5;
/// Fastest accepted ratio for the differences of a dozen surfaces: a faster one is mostly chance.
const FASTEST_OF_SURFACES: f64 = 0.375;

/// Estimated discretisation error of a number.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct GridError {
    /// Relative half-width of an interval about the number on the finest grid; an estimate, not a bound.
    pub error: f64,
    /// Observed order of convergence, negative where the differences grow; `None` where they change sign.
    pub order: Option<f64>,
}

/// The discretisation error of a number from grids whose cells are once, twice and four times as large.
///
/// The error is 1.5 times the difference of the two finer grids, or half the difference of the two coarser
/// ones where that is larger: chance can make one of them small. The order of convergence is that of the
/// differences, `log2(|q_4 - q_2|/|q_2 - q_1|)`, and never an assumed one. Where it is below 1, the remaining
/// error is the sum of all further differences, `|q_2 - q_1|/(2^order - 1)`, at most three times the last
/// one. No extrapolation makes the error smaller.
///
/// The table shows how often the interval contains the limit, counted by `tests/tests/grid_error.rs` with
/// seeds that were not used to choose these constants.
///
/// | waves of the surface | stiffness | area | largest pressure |
/// |---|---|---|---|
/// | resolved by the grid | 98 % | 95 % | all |
/// | down to the cell, 10 cells or more in contact | 93 to 96 % | 84 to 95 % | has no limit |
///
/// `None` for numbers that are not finite, and for a zero on the finest grid.
///
/// ```
/// // 1 + sqrt(h) on h = 0.01, 0.02, 0.04: the error is 0.1 of 1.1.
/// let q = |h: f64| 1.0 + h.sqrt();
/// let found = analysis::grid_error(q(0.01), q(0.02), q(0.04)).unwrap();
/// assert!((found.order.unwrap() - 0.5).abs() < 1e-12);
/// assert!((found.error - 1.5 * 0.1 / 1.1).abs() < 1e-12);
/// ```
pub fn grid_error(fine: f64, half: f64, quarter: f64) -> Option<GridError> {
    if fine == 0.0 || ![fine, half, quarter].iter().all(|q| q.is_finite()) {
        return None;
    }
    let (last, before) = (half - fine, quarter - half);
    let order = (last * before > 0.0).then(|| (before / last).log2());
    // Differences of changing sign say nothing of a fall.
    let fall = order.map_or(FASTEST, |order| (-order).exp2());
    let error = SAFETY * to_come([last, before].map(f64::abs), fall, 1.0, FASTEST) / fine.abs();
    Some(GridError { error, order })
}

/// `[(half - fine)/fine, (quarter - half)/fine]`; `None` for a number that is not positive.
pub fn relative_differences(fine: f64, half: f64, quarter: f64) -> Option<[f64; 2]> {
    (fine > 0.0).then(|| [(half - fine) / fine, (quarter - half) / fine])
}

/// A part of the relative differences between grids that is known from elsewhere, and could cancel the rest
/// of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct KnownPart {
    /// In the last difference and the one before.
    pub differences: [f64; 2],
    /// In all differences to come.
    pub to_come: f64,
}

/// 95 % half-width of the distance from the limit of fine grids, relative, for the mean over `surfaces`.
///
/// From the relative differences of single surfaces between the grid and the one half as fine, and between
/// that and the one a quarter as fine ([`relative_differences`]): how large the first are, by how much they
/// fall from one halving to the next, and how far both go together. No order of convergence is assumed. The
/// known part is taken out of the differences, and its own remainder added in quadrature. `None` for fewer
/// than two surfaces.
pub fn mean_grid_error(differences: &[[f64; 2]], known: KnownPart, surfaces: usize) -> Option<f64> {
    let n = differences.len() as f64;
    if differences.len() < 2 {
        return None;
    }
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| sum(differences.iter().map(of)) / n;
    let means = [mean(&|d| d[0] - known.differences[0]), mean(&|d| d[1] - known.differences[1])];
    let share = n.min(surfaces as f64);
    // Second moments of the mean over the surfaces.
    let moment = |a: usize, b: usize| {
        let [a_known, b_known] = [a, b].map(|i| known.differences[i] + means[i]);
        let covariance = mean(&|d| (d[a] - a_known) * (d[b] - b_known)) * n / (n - 1.0);
        means[a] * means[b] + covariance / share
    };
    let waves = error_from_moments(means[0], [moment(0, 0), moment(1, 1), moment(0, 1)], differences.len());
    Some(waves.hypot(known.to_come))
}

/// 95 % half-width of all differences to come, from the mean of the last difference and from the second
/// moments of the last one, of the one before, and of both.
///
/// What surfaces have in common gets the factor 1.5 of [`grid_error`], their scatter that of Student's t,
/// each with its share of the last difference.
pub fn error_from_moments(mean: f64, [last, before, both]: [f64; 3], surfaces: usize) -> f64 {
    if last.max(before) <= 0.0 {
        return 0.0;
    }
    let fall = if before > 0.0 { (last / before).sqrt() } else { SLOWEST };
    let together = if last.min(before) > 0.0 { both / (last * before).sqrt() } else { 1.0 };
    let all = to_come([last, before].map(f64::sqrt), fall, together.clamp(0.0, 1.0), FASTEST_OF_SURFACES);
    let common = if last > 0.0 { (mean * mean / last).min(1.0) } else { 0.0 };
    let scatter = student(surfaces as f64 - 1.0);
    (SAFETY * SAFETY * common + scatter * scatter * (1.0 - common)).sqrt() * all
}

/// Root mean square of the sum of all differences to come, from those of the last difference and of the one
/// before.
///
/// Differences that fall by r from one grid to the next and go together with the correlation c add up to the
/// variance `m r^2/(1 - r^2) (1 + c r)/(1 - c r)`. A last difference that fell faster than any sequence does
/// (where its sign changes, or by chance) counts as one that fell by the fastest.
fn to_come([last, before]: [f64; 2], fall: f64, together: f64, fastest: f64) -> f64 {
    let fall = fall.clamp(fastest, SLOWEST);
    let (square, product) = (fall * fall, together * fall);
    last.max(fastest * before) * (square / (1.0 - square) * (1.0 + product) / (1.0 - product)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn differences_and_their_order_make_the_error() {
        let close = |[fine, half, quarter]: [f64; 3], error: f64, order: Option<f64>| {
            let found = grid_error(fine, half, quarter).unwrap();
            assert!((found.error - error).abs() < 1e-14, "{found:?}");
            match (found.order, order) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 1e-12, "{found:?}"),
                (a, b) => assert_eq!(a, b, "{found:?}"),
            }
        };
        // First order, second order: nothing is gained by an order above 1.
        close([2.0, 2.25, 2.75], 0.1875, Some(1.0));
        close([-2.0, -2.25, -3.25], 0.375, Some(2.0));
        // Differences of 2 and 3: what remains is 2 / (3/2 - 1); of 4 and 5, and of growing ones, three times
        // the last.
        close([2.0, 4.0, 7.0], 3.0, Some(1.5f64.log2()));
        close([2.0, 6.0, 11.0], 9.0, Some(1.25f64.log2()));
        close([2.0, 2.5, 3.0], 1.125, Some(0.0));
        close([2.0, 3.0, 3.5], 2.25, Some(-1.0));
        // Of changing sign; and nothing changes.
        close([2.0, 1.0, 2.0], 0.75, None);
        close([2.0, 2.0, 5.0], 1.125, None);
        close([2.0, 2.0, 2.0], 0.0, None);
        for [fine, half, quarter] in [[0.0, 1.0, 2.0], [f64::NAN, 1.0, 2.0], [1.0, f64::INFINITY, 2.0]] {
            assert_eq!(grid_error(fine, half, quarter), None);
        }
    }

    #[test]
    fn what_is_to_come_follows_from_what_was() {
        let to_come = |[last, before, both]: [f64; 3]| {
            let together = both / (last * before).sqrt();
            to_come([last, before].map(f64::sqrt), (last / before).sqrt(), together, FASTEST_OF_SURFACES)
        };
        // Halved each time, all of one sign: 1/2 + 1/4 + ... = 1.
        assert_relative_eq!(to_come([1.0, 4.0, 2.0]), 1.0, max_relative = 1e-12);
        // Halved and independent: 1/4 + 1/16 + ... = 1/3 in variance.
        assert_relative_eq!(to_come([1.0, 4.0, 0.0]), (1.0_f64 / 3.0).sqrt(), max_relative = 1e-12);
        // Growing ones and very fast ones are taken at the ends of the range.
        assert_relative_eq!(to_come([1.0, 0.25, 0.5]), 3.0, max_relative = 1e-12);
        assert_relative_eq!(to_come([1.0, 1e6, 1e3]), 375.0 * 0.375 / 0.625, max_relative = 1e-12);
        // One difference alone falls at the slowest, with what it has in common; none is none.
        assert_relative_eq!(error_from_moments(1.0, [1.0, 0.0, 0.0], 12), 1.5 * 3.0, max_relative = 1e-12);
        assert!(error_from_moments(0.0, [0.0; 3], 12).abs() < 1e-300);
    }

    #[test]
    fn surfaces_that_differ_average_out_and_a_common_difference_does_not() {
        let common = [[0.1, 0.2]; 4];
        for surfaces in [1, 60] {
            let error = mean_grid_error(&common, KnownPart::default(), surfaces).unwrap();
            assert_relative_eq!(error, 0.1 * SAFETY, max_relative = 1e-9);
        }
        let scattered = [[0.1, 0.2], [-0.1, -0.2], [0.1, 0.2], [-0.1, -0.2]];
        let [one, four] = [1, 60].map(|n| mean_grid_error(&scattered, KnownPart::default(), n).unwrap());
        assert_relative_eq!(one, 2.0 * four, max_relative = 1e-9);
        assert_eq!(mean_grid_error(&common[..1], KnownPart::default(), 1), None);
    }
}
