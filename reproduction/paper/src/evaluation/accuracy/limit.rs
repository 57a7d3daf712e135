//! The limit of a sequence of grids with its uncertainty; it is extrapolated where the order of convergence
//! is established.

use serde::{Deserialize, Serialize};

/// Range of the orders that are searched, from 1/2 (slower convergence cannot be established with five grids)
/// to 4.
const ORDERS: (f64, f64) = (0.5, 4.0);
/// Step of the search.
const STEP: f64 = 0.02;
/// Largest extrapolation, as a share of the finest value: a number that vanishes in the limit has no relative
/// error.
const REACH: f64 = 0.5;
/// A sequence follows its order when the residual of the fit is at most this share of the error of its finest
/// grid.
const FOLLOWS: f64 = 0.25;

/// The limit of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Limit {
    /// The extrapolated value, or that of the finest grid where no order is established.
    pub value: f64,
    /// How far the limit may be from `value`: half of what was extrapolated and the residual of the fit;
    /// without an order the largest distance from the finest grid to the two before it.
    pub uncertainty: f64,
    /// Order of convergence in the cell size, where established.
    pub order: Option<f64>,
}

impl Limit {
    /// A limit that is known exactly.
    pub fn exact(value: f64) -> Self {
        Self { value, uncertainty: 0.0, order: None }
    }

    /// Relative uncertainty.
    pub fn relative(&self) -> f64 {
        self.uncertainty / self.value.abs()
    }

    /// Relative distance of a value from the limit.
    pub fn distance(&self, value: f64) -> f64 {
        ((value - self.value) / self.value).abs()
    }
}

/// `v(h) = limit + C h^p` through values on cells of size h, coarsest first, by least squares that weigh each
/// grid by 1/h; `None` for fewer than two values.
///
/// The order counts as established where four grids or more follow it, it lies inside the search, and the
/// finest grid is nearer to the limit than the one before.
pub(crate) fn limit(values: &[(f64, f64)]) -> Option<Limit> {
    let &[.., before, finest] = values else { return None };
    let spread = values.iter().rev().take(3).map(|v| (v.1 - finest.1).abs()).fold(0.0, f64::max);
    let unknown = Limit { value: finest.1, uncertainty: spread, order: None };
    if values.len() < 4 {
        return Some(unknown);
    }
    let steps = ((ORDERS.1 - ORDERS.0) / STEP).round() as usize;
    let fits = (0..=steps).map(|i| ORDERS.0 + STEP * i as f64).filter_map(|p| fit(values, p));
    let Some(best) = fits.min_by(|a, b| a.residual.total_cmp(&b.residual)) else { return Some(unknown) };
    let error = (best.limit - finest.1).abs();
    let inside = best.order > ORDERS.0 + STEP / 2.0 && best.order < ORDERS.1 - STEP / 2.0;
    let follows = best.residual <= FOLLOWS * error && error < (best.limit - before.1).abs();
    let inside = inside && error <= REACH * finest.1.abs();
    if inside && follows {
        let uncertainty = 0.5 * error + best.residual;
        return Some(Limit { value: best.limit, uncertainty, order: Some(best.order) });
    }
    Some(unknown)
}

struct LimitFit {
    order: f64,
    limit: f64,
    residual: f64,
}

/// Least squares for `limit` and C at a given order.
fn fit(values: &[(f64, f64)], order: f64) -> Option<LimitFit> {
    let finest = values.last()?;
    // Differences from the finest value and cells in its units: no digits lost.
    let rows: Vec<(f64, f64, f64)> = values
        .iter()
        .map(|&(h, v)| (finest.0 / h, (h / finest.0).powf(order), v - finest.1))
        .map(|(w, x, y)| (w * w, x, y))
        .collect();
    let sum = |of: &dyn Fn(&(f64, f64, f64)) -> f64| rows.iter().map(of).sum::<f64>();
    let w = sum(&|r| r.0);
    let (x, y) = (sum(&|r| r.0 * r.1) / w, sum(&|r| r.0 * r.2) / w);
    let (xx, xy) = (sum(&|r| r.0 * (r.1 - x).powi(2)), sum(&|r| r.0 * (r.1 - x) * (r.2 - y)));
    if xx <= 0.0 {
        return None;
    }
    let slope = xy / xx;
    let at_zero = y - slope * x;
    let residual = (sum(&|r| r.0 * (r.2 - at_zero - slope * r.1).powi(2)) / w).sqrt();
    Some(LimitFit { order, limit: finest.1 + at_zero, residual })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Half a step of the search.
    const ORDER: f64 = 0.011;

    #[test]
    fn a_power_is_extrapolated_and_noise_is_not() {
        let cells = [129.0, 257.0, 513.0, 1025.0].map(|n: f64| 1.0 / n);
        let exact = cells.map(|h| (h, 2.0 + 0.3 * h.powf(1.3)));
        let found = limit(&exact).unwrap();
        assert_relative_eq!(found.order.unwrap(), 1.3, epsilon = ORDER);
        assert!(
            found.uncertainty < 0.3 * cells[3].powf(1.3) && (found.value - 2.0).abs() <= found.uncertainty
        );
        let noisy = [1.0, -1.0, 1.0, -1.0].map(|s| 2.0 + 1e-3 * s);
        let noisy: Vec<_> = cells.into_iter().zip(noisy).collect();
        let found = limit(&noisy).unwrap();
        assert_eq!((found.value, found.order), (1.999, None));
        assert_relative_eq!(found.uncertainty, 2e-3, max_relative = 1e-9);
        assert_eq!(limit(&noisy[..1]), None);
    }
}
