//! The master curve of Fig. 4.

use numerics::sum::sum;

/// One point of one curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollapsePoint {
    /// `F_bar`.
    pub force_bar: f64,
    /// `F_tilde`, the force that the law gives for the k_bar of the point.
    pub force_tilde: f64,
}

/// Residuals about the line `F_tilde = F_bar`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Root mean square of `ln(F_tilde/F_bar)`.
    pub rms: f64,
    /// Largest `|ln(F_tilde/F_bar)|`.
    pub max: f64,
    /// Scatter of the curves about their own mean: root mean square of `ln F_tilde` minus its mean over the
    /// curves at the same force. `None` where no two curves have a force in common.
    pub scatter: Option<f64>,
    /// Number of points.
    pub points: usize,
}

/// Residuals of a collapse over all points with F_bar in `min..=max`; one inner slice per curve. `None`
/// without points.
///
/// Source: Fig. 4 of the paper, `F_tilde = F_ul (k_bar/k_ul)^(1/(0.266 D_f))`.
///
/// ```
/// use analysis::{CollapsePoint, collapse};
/// let p = |force_bar, factor| CollapsePoint { force_bar, force_tilde: factor * force_bar };
/// // Two curves, a factor e above and on the line: rms of (1, 0) is 1/sqrt(2), scatter 1/2.
/// let r = collapse(&[vec![p(0.01, 1f64.exp())], vec![p(0.01, 1.0)]], 0.0, 1.0).unwrap();
/// assert!((r.rms - 0.5f64.sqrt()).abs() < 1e-12 && (r.max - 1.0).abs() < 1e-12);
/// assert!((r.scatter.unwrap() - 0.5).abs() < 1e-12);
/// ```
pub fn collapse(curves: &[Vec<CollapsePoint>], min: f64, max: f64) -> Option<Residual> {
    let mut points: Vec<(f64, f64)> = (curves.iter().flatten())
        .filter(|p| (min..=max).contains(&p.force_bar) && p.force_bar > 0.0 && p.force_tilde > 0.0)
        .map(|p| (p.force_bar, (p.force_tilde / p.force_bar).ln()))
        .filter(|p| p.1.is_finite())
        .collect();
    if points.is_empty() {
        return None;
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = points.len() as f64;
    let shared: Vec<f64> = points
        .chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq())
        .filter(|group| group.len() > 1)
        .flat_map(|group| {
            let mean = sum(group.iter().map(|p| p.1)) / group.len() as f64;
            group.iter().map(move |p| p.1 - mean)
        })
        .collect();
    Some(Residual {
        rms: (sum(points.iter().map(|p| p.1 * p.1)) / n).sqrt(),
        max: points.iter().map(|p| p.1.abs()).fold(0.0, f64::max),
        scatter: (!shared.is_empty())
            .then(|| (sum(shared.iter().map(|v| v * v)) / shared.len() as f64).sqrt()),
        points: points.len(),
    })
}

/// The longest run of consecutive points of a curve that stay within a factor `factor` of the line, in
/// decades of F_bar.
///
/// Points in increasing F_bar. 0 for a single point or none.
///
/// ```
/// use analysis::{CollapsePoint, decades_within};
/// let p = |force_bar, factor| CollapsePoint { force_bar, force_tilde: factor * force_bar };
/// let curve = [p(1e-4, 9.0), p(1e-3, 1.1), p(1e-2, 0.9), p(1e-1, 1.0), p(1.0, 2.0)];
/// assert!((decades_within(&curve, 1.2) - 2.0).abs() < 1e-12); // 1e-3 to 1e-1
/// ```
pub fn decades_within(curve: &[CollapsePoint], factor: f64) -> f64 {
    let limit = factor.ln().abs();
    let near = |p: &CollapsePoint| {
        let r = (p.force_tilde / p.force_bar).ln().abs();
        r <= limit
    };
    curve
        .chunk_by(|a, b| near(a) && near(b))
        .filter(|run| near(&run[0]))
        .map(|run| (run[run.len() - 1].force_bar / run[0].force_bar).log10())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_nothing_out() {
        assert_eq!(collapse(&[], 0.0, 1.0), None);
        let p = CollapsePoint { force_bar: 2.0, force_tilde: 1.0 };
        assert_eq!(collapse(&[vec![p]], 0.0, 1.0), None);
        assert_eq!(collapse(&[vec![CollapsePoint { force_tilde: 0.0, ..p }]], 0.0, 9.0), None);
        assert_eq!(collapse(&[vec![p]], 0.0, 9.0).unwrap().scatter, None);
        approx::assert_abs_diff_eq!(decades_within(&[], 2.0), 0.0);
        approx::assert_abs_diff_eq!(decades_within(&[p], 1.1), 0.0);
    }
}
