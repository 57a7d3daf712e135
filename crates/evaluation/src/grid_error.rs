//! What the grid leaves of a number, from the same surfaces on grids half and a quarter as fine.

use crate::measured::Series;
use crate::realisation::Discretisation;
use analysis::{Bootstrap, EnsemblePoint, FitWindow, least_squares};

/// By how much differences between grids fall from one halving of the cells to the next: what was measured, within this range. A fast fall
/// seen on a dozen surfaces is mostly chance; a slow one ends somewhere.
const FALLS: (f64, f64) = (0.375, 0.75);

/// Power of k over that of complete contact with which the error of a free edge sets in.
const EDGE_POWER: i32 = 8;

/// What the edge of a free square adds to the relative differences of k between grids: known from complete contact, where there is nothing else.
///
/// It makes k too small on a coarse grid, short waves make it too large: near complete contact both can cancel in the differences, and not in
/// what is to come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgePart {
    /// In the last difference and the one before.
    differences: [f64; 2],
    /// In all differences to come.
    to_come: f64,
}

impl EdgePart {
    /// Its share at a mean k_bar: that of complete contact times `(k/k_complete)^8`, so that half the stiffness has less than a hundredth of it.
    /// A line has none.
    pub fn at(stiffness_bar: f64, discretisation: Discretisation) -> Self {
        let Some([half, quarter]) = discretisation.coarser() else { return Self::default() };
        let [fine, half, quarter] = [discretisation, half, quarter].map(Discretisation::complete_contact);
        let limit = discretisation.complete_contact_of_fine_grids();
        let share = (stiffness_bar / fine).min(1.0).powi(EDGE_POWER) / fine;
        Self {
            differences: [share * (half - fine), share * (quarter - half)],
            to_come: share * (fine - limit),
        }
    }
}

/// 95 % half-width of the distance from the limit of fine grids, for the mean over `surfaces`.
///
/// From the relative differences of single surfaces between the grid and the one half as fine, and between that and the one a quarter as fine:
/// how large the first are, by how much they fall from one halving to the next, and how far both go together. No order of convergence is
/// assumed. The part of the edge is taken out of the differences, and its own remainder added in quadrature. `None` for fewer than two surfaces.
pub fn discretisation_error(differences: &[[f64; 2]], edge: EdgePart, surfaces: usize) -> Option<f64> {
    let n = differences.len() as f64;
    if differences.len() < 2 {
        return None;
    }
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| analysis::sum(differences.iter().map(of)) / n;
    let means = [mean(&|d| d[0] - edge.differences[0]), mean(&|d| d[1] - edge.differences[1])];
    let share = n.min(surfaces as f64);
    // Second moments of the mean over the surfaces.
    let moment = |a: usize, b: usize| {
        let [a_edge, b_edge] = [a, b].map(|i| edge.differences[i] + means[i]);
        let covariance = mean(&|d| (d[a] - a_edge) * (d[b] - b_edge)) * n / (n - 1.0);
        means[a] * means[b] + covariance / share
    };
    let waves = half_width(means[0], [moment(0, 0), moment(1, 1), moment(0, 1)], n);
    Some(waves.hypot(edge.to_come))
}

/// Factor on the part of what is to come that all surfaces have in common, as in [`analysis::grid_error`].
const SAFETY: f64 = 1.5;

/// 95 % half-width of all differences to come: of their scatter by Student's t, of what they have in common by [`SAFETY`], each with its share
/// of the last difference; `mean` is that of the last one, second moments are those of [`still_to_come`].
fn half_width(mean: f64, [last, before, both]: [f64; 3], surfaces: f64) -> f64 {
    let common = if last > 0.0 { (mean * mean / last).min(1.0) } else { 0.0 };
    let scatter = analysis::student(surfaces - 1.0);
    let factor = (SAFETY * SAFETY * common + scatter * scatter * (1.0 - common)).sqrt();
    factor * still_to_come(last, before, both)
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
        half_width(found[part][0], [moment(0, 0), moment(1, 1), moment(0, 1)], surfaces as f64)
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
        assert_relative_eq!(still_to_come(1.0, 1e6, 1e3), 375.0 * 0.375 / 0.625, max_relative = 1e-12);
        assert_relative_eq!(still_to_come(1.0, 0.0, 0.0), 3.0, max_relative = 1e-12);
        assert!(still_to_come(0.0, 0.0, 0.0) < 1e-300);
    }

    #[test]
    fn surfaces_that_differ_average_out_and_a_common_difference_does_not() {
        let common = [[0.1, 0.2]; 4];
        for surfaces in [1, 60] {
            let error = discretisation_error(&common, EdgePart::default(), surfaces).unwrap();
            assert_relative_eq!(error, 0.1 * SAFETY, max_relative = 1e-9);
        }
        let scattered = [[0.1, 0.2], [-0.1, -0.2], [0.1, 0.2], [-0.1, -0.2]];
        let [one, four] = [1, 60].map(|n| discretisation_error(&scattered, EdgePart::default(), n).unwrap());
        assert_relative_eq!(one, 2.0 * four, max_relative = 1e-9);
        assert_eq!(discretisation_error(&common[..1], EdgePart::default(), 1), None);
    }
    #[test]
    fn an_edge_that_hides_in_the_differences_is_found_again() {
        let grid = Discretisation::Bem3d { cells: 129, tolerance: 1e-3 };
        let edge = EdgePart::at(grid.complete_contact(), grid);
        // k of complete contact goes up by 0.4/N/1.15 to the limit, the two differences by as much and by twice as much.
        let expected = 0.4025 / 129.0 / 1.1523;
        assert_relative_eq!(edge.to_come, -expected, max_relative = 0.02);
        assert_relative_eq!(edge.differences[0], -expected, max_relative = 0.1);
        assert_relative_eq!(edge.differences[1], -2.0 * expected, max_relative = 0.1);
        // Waves that cancel it: no difference is seen, but each part is there.
        let unseen = discretisation_error(&[[0.0; 2]; 12], edge, 1).unwrap();
        assert!(unseen > 1.5 * expected, "{unseen}");
        // It falls with the eighth power of k, and a line has no edge.
        let half = EdgePart::at(0.5 * grid.complete_contact(), grid);
        assert_relative_eq!(half.to_come, edge.to_come / 256.0, max_relative = 1e-12);
        assert_eq!(EdgePart::at(0.9, Discretisation::Mdr1d { elements: 4096 }), EdgePart::default());
    }
}
