//! What the grid leaves of a number, from the same surfaces on grids half and a quarter as fine.

use crate::measured::Series;
use analysis::{Bootstrap, EnsemblePoint, FitWindow, least_squares};

/// By how much differences between grids fall from one halving of the cells to the next: what was measured, within this range. A fast fall
/// seen on a dozen surfaces is mostly chance; a slow one ends somewhere.
const FALLS: (f64, f64) = (0.35, 0.75);

/// 95 % half-width of the distance from the limit of fine grids, for the mean over `surfaces`.
///
/// From the relative differences of single surfaces between the grid and the one half as fine, and between that and the one a quarter as fine:
/// how large the first are, by how much they fall from one halving to the next, and how far both go together. No order of convergence is
/// assumed. `None` for fewer than two surfaces.
pub fn discretisation_error(differences: &[[f64; 2]], surfaces: usize) -> Option<f64> {
    let n = differences.len() as f64;
    if differences.len() < 2 {
        return None;
    }
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| analysis::sum(differences.iter().map(of)) / n;
    let means = [mean(&|d| d[0]), mean(&|d| d[1])];
    let share = n.min(surfaces as f64);
    // Second moments of the mean over the surfaces.
    let moment = |a: usize, b: usize| {
        let covariance = mean(&|d| (d[a] - means[a]) * (d[b] - means[b])) * n / (n - 1.0);
        means[a] * means[b] + covariance / share
    };
    Some(analysis::student(n - 1.0) * still_to_come(moment(0, 0), moment(1, 1), moment(0, 1)))
}

/// Root mean square of all differences to come, from second moments of the last difference, the one before, and both.
///
/// Differences that fall by r from one grid to the next and go together with the correlation c add up to the variance
/// `m r^2/(1 - r^2) (1 + c r)/(1 - c r)`. A last difference that fell faster than any sequence does (where its sign changes, or by chance)
/// counts as one that fell by the fastest.
fn still_to_come(last: f64, before: f64, both: f64) -> f64 {
    if last.max(before) <= 0.0 {
        return 0.0;
    }
    let fall = if before > 0.0 { (last / before).sqrt() } else { FALLS.1 }.clamp(FALLS.0, FALLS.1);
    let together = if last.min(before) > 0.0 { both / (last * before).sqrt() } else { 1.0 }.clamp(0.0, 1.0);
    let last = last.max(FALLS.0.powi(2) * before);
    let (square, product) = (fall * fall, together * fall);
    (last * square / (1.0 - square) * (1.0 + product) / (1.0 - product)).sqrt()
}

/// Relative differences of k of each surface between its grid and the one half as fine, and between that and the one a quarter as fine, all
/// converged.
pub fn differences(series: &Series, [half, quarter]: [&Series; 2], j: usize) -> Vec<[f64; 2]> {
    let k = |s: &Series, i: usize| {
        let (_, result) = s.units.get(i)?;
        result.samples.get(j).filter(|s| s.converged()).and_then(|s| s.stiffness_bar)
    };
    let of = |i: usize| relative_differences(k(series, i)?, k(half, i)?, k(quarter, i)?);
    (0..series.units.len()).filter_map(of).collect()
}

/// `[(half - fine)/fine, (quarter - half)/fine]`; `None` for a number that is not positive.
pub fn relative_differences(fine: f64, half: f64, quarter: f64) -> Option<[f64; 2]> {
    (fine > 0.0).then(|| [(half - fine) / fine, (quarter - half) / fine])
}

/// 95 % half-widths of alpha and of ln zeta from the coarser grids, over the forces that the finest resolves. Where a coarser one does not, its
/// difference is too large, and so is the half-width.
pub fn law_error(series: &Series, [half, quarter]: [&Series; 2]) -> Option<(f64, f64)> {
    let window = FitWindow::PAPER;
    let all = [series, half, quarter];
    let resolved = |p: &EnsemblePoint| {
        p.force_bar <= window.max_force_bar
            && p.min_contact_cells.is_none_or(|c| c >= window.min_contact_cells)
    };
    let inside: Vec<usize> = (0..series.points.len()).filter(|&j| resolved(&series.points[j])).collect();
    let law = |s: &Series, draw: &[usize]| {
        let (means, forces) = (s.curves.mean_of(draw), s.curves.force_bar());
        let points: Vec<(f64, f64)> =
            inside.iter().filter_map(|&j| Some((forces[j].ln(), means[j]?.ln()))).collect();
        least_squares(&points).filter(|_| points.len() >= 3)
    };
    // Differences of alpha and of ln zeta between neighbouring grids.
    let differences = |draw: &[usize]| {
        let [fine, half, quarter] = [law(all[0], draw)?, law(all[1], draw)?, law(all[2], draw)?];
        Some([[half.0 - fine.0, quarter.0 - half.0], [half.1 - fine.1, quarter.1 - half.1]])
    };
    let surfaces = all.iter().map(|s| s.units.len()).min().unwrap_or(0);
    let whole: Vec<usize> = (0..surfaces).collect();
    let found = differences(&whole)?;
    let draws: Vec<[[f64; 2]; 2]> =
        Bootstrap::default().draws(surfaces).iter().filter_map(|draw| differences(draw)).collect();
    if surfaces < 2 || draws.len() < 2 {
        return None;
    }
    let error = |part: usize| {
        let moment = |a: usize, b: usize| {
            let [x, y] = [found[part][a], found[part][b]];
            let scatter = draws.iter().map(|d| (d[part][a] - x) * (d[part][b] - y));
            x * y + analysis::sum(scatter) / draws.len() as f64
        };
        analysis::student(surfaces as f64 - 1.0) * still_to_come(moment(0, 0), moment(1, 1), moment(0, 1))
    };
    Some((error(0), error(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn what_is_to_come_follows_from_what_was() {
        // Halved each time, all of one sign: 1/2 + 1/4 + ... = 1.
        assert_relative_eq!(still_to_come(1.0, 4.0, 2.0), 1.0, max_relative = 1e-12);
        // Halved and independent: 1/4 + 1/16 + ... = 1/3 in variance.
        assert_relative_eq!(still_to_come(1.0, 4.0, 0.0), (1.0_f64 / 3.0).sqrt(), max_relative = 1e-12);
        // Growing ones and very fast ones are taken at the ends of the range.
        assert_relative_eq!(still_to_come(1.0, 0.25, 0.5), 3.0, max_relative = 1e-12);
        assert_relative_eq!(still_to_come(1.0, 1e6, 1e3), 350.0 * 0.35 / 0.65, max_relative = 1e-12);
        assert_relative_eq!(still_to_come(1.0, 0.0, 0.0), 3.0, max_relative = 1e-12);
        assert!(still_to_come(0.0, 0.0, 0.0) < 1e-300);
    }

    #[test]
    fn surfaces_that_differ_average_out_and_a_common_difference_does_not() {
        let t = analysis::student(3.0);
        let common = [[0.1, 0.2]; 4];
        for surfaces in [1, 60] {
            let error = discretisation_error(&common, surfaces).unwrap();
            assert_relative_eq!(error, 0.1 * t, max_relative = 1e-9);
        }
        let scattered = [[0.1, 0.2], [-0.1, -0.2], [0.1, 0.2], [-0.1, -0.2]];
        let [one, four] = [1, 60].map(|n| discretisation_error(&scattered, n).unwrap());
        assert_relative_eq!(one, 2.0 * four, max_relative = 1e-9);
        assert_eq!(discretisation_error(&common[..1], 1), None);
    }
}
