//! k_bar of many surfaces at common forces.

use contact_model::{Error, Result};
use serde::{Deserialize, Serialize};

/// The stiffness of one surface at one force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StiffnessSample {
    /// `k_bar` (Eq. 8), dimensionless.
    pub stiffness_bar: f64,
    /// Cells (elements) in contact; `None` where the model has none.
    pub contact_cells: Option<usize>,
}

/// Stiffness of an ensemble of surfaces at common forces; a missing sample (not converged, not claimed) is
/// `None`.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    force_bar: Vec<f64>,
    surfaces: Vec<Vec<Option<StiffnessSample>>>,
}

impl Curves {
    /// Curves from increasing forces `F_bar > 0` and, for each surface, one entry per force.
    ///
    /// # Errors
    /// [`Error::Domain`] for a force that is not finite, positive and larger than the one before, or a
    /// stiffness that is not finite and positive; [`Error::Shape`] for no surface or a surface with another
    /// number of entries.
    pub fn new(force_bar: Vec<f64>, surfaces: Vec<Vec<Option<StiffnessSample>>>) -> Result<Self> {
        let mut before = 0.0;
        for &f in &force_bar {
            if !(f.is_finite() && f > before) {
                return Err(Error::domain("force_bar", f, format!("a finite number > {before:?}")));
            }
            before = f;
        }
        if surfaces.is_empty() {
            return Err(Error::Shape { name: "surfaces".into(), found: 0, expected: "at least 1".into() });
        }
        for (i, surface) in surfaces.iter().enumerate() {
            if surface.len() != force_bar.len() {
                return Err(Error::Shape {
                    name: format!("surface {i}").into(),
                    found: surface.len(),
                    expected: format!("{} (one per force)", force_bar.len()).into(),
                });
            }
            for sample in surface.iter().flatten() {
                let k = sample.stiffness_bar;
                if !(k.is_finite() && k > 0.0) {
                    return Err(Error::domain("stiffness_bar", k, "a finite number > 0"));
                }
            }
        }
        Ok(Self { force_bar, surfaces })
    }

    /// The common forces, increasing.
    pub fn force_bar(&self) -> &[f64] {
        &self.force_bar
    }

    /// The surfaces, each with one entry per force.
    pub fn surfaces(&self) -> &[Vec<Option<StiffnessSample>>] {
        &self.surfaces
    }

    /// Samples of the surfaces `draw` at force number `j` (a surface may be drawn more than once).
    pub(crate) fn drawn<'a>(
        &'a self,
        draw: &'a [usize],
        j: usize,
    ) -> impl Iterator<Item = Option<StiffnessSample>> + 'a {
        draw.iter().map(move |&i| self.surfaces[i][j])
    }

    /// Arithmetic mean of k_bar at each force over the surfaces `draw`, `None` where one of them is missing.
    ///
    /// # Panics
    /// When `draw` names a surface that does not exist.
    pub fn mean_of(&self, draw: &[usize]) -> Vec<Option<f64>> {
        (0..self.force_bar.len())
            .map(|j| {
                let k: Option<Vec<f64>> = self.drawn(draw, j).map(|s| s.map(|s| s.stiffness_bar)).collect();
                k.filter(|k| !k.is_empty()).map(|k| crate::sum(k.iter().copied()) / k.len() as f64)
            })
            .collect()
    }

    /// The ensemble of the surfaces `draw` (a surface may be drawn more than once).
    ///
    /// # Panics
    /// When `draw` names a surface that does not exist.
    #[must_use]
    pub fn resampled(&self, draw: &[usize]) -> Self {
        let surfaces = draw.iter().map(|&i| self.surfaces[i].clone()).collect();
        Self { force_bar: self.force_bar.clone(), surfaces }
    }

    /// Every surface once.
    pub fn all(&self) -> Vec<usize> {
        (0..self.surfaces.len()).collect()
    }
}

/// Value of a curve `y(x)` at `at` by straight lines in ln-ln between its points; `None` outside them.
///
/// All x and y must be positive, x increasing; points without a value are skipped.
///
/// ```
/// let y = analysis::interpolate(&[1.0, 100.0], &[Some(1.0), Some(10.0)], 10.0).unwrap();
/// assert!((y - 10f64.sqrt()).abs() < 1e-14); // y = sqrt(x)
/// assert_eq!(analysis::interpolate(&[1.0, 100.0], &[Some(1.0), Some(10.0)], 101.0), None);
/// ```
pub fn interpolate(x: &[f64], y: &[Option<f64>], at: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> =
        x.iter().zip(y).filter_map(|(&x, y)| y.filter(|&y| y > 0.0 && x > 0.0).map(|y| (x, y))).collect();
    let upper = points.iter().position(|p| p.0 >= at)?;
    let (x1, y1) = points[upper];
    // A point that is asked for itself comes back bit for bit.
    if (x1 - at).abs() <= f64::EPSILON * at.abs() {
        return Some(y1);
    }
    let (x0, y0) = points[upper.checked_sub(1)?];
    let t = (at / x0).ln() / (x1 / x0).ln();
    Some((y0.ln() + t * (y1 / y0).ln()).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_curves_are_named() {
        let s = Some(StiffnessSample { stiffness_bar: 1.0, contact_cells: None });
        assert!(Curves::new(vec![1.0], vec![]).is_err());
        assert!(Curves::new(vec![1.0, 1.0], vec![vec![s, s]]).is_err());
        assert!(Curves::new(vec![f64::NAN], vec![vec![s]]).is_err());
        assert!(Curves::new(vec![1.0], vec![vec![s, s]]).is_err());
        let bad = Some(StiffnessSample { stiffness_bar: f64::NAN, contact_cells: None });
        assert!(Curves::new(vec![1.0], vec![vec![bad]]).is_err());
        assert!(Curves::new(vec![], vec![vec![]]).is_ok());
    }

    #[test]
    fn a_missing_sample_makes_the_mean_missing() {
        let s = |k| Some(StiffnessSample { stiffness_bar: k, contact_cells: None });
        let c = Curves::new(vec![1.0, 2.0], vec![vec![s(1.0), s(2.0)], vec![s(3.0), None]]).unwrap();
        assert_eq!(c.mean_of(&c.all()), vec![Some(2.0), None]);
        assert_eq!(c.mean_of(&[]), vec![None, None]);
        assert_eq!(c.mean_of(&[0, 0]), vec![Some(1.0), Some(2.0)]);
    }

    #[test]
    fn interpolation_skips_gaps() {
        let x = [1.0, 10.0, 100.0];
        let y = interpolate(&x, &[Some(1.0), None, Some(100.0)], 10.0).unwrap();
        approx::assert_relative_eq!(y, 10.0, max_relative = 1e-14);
        assert_eq!(interpolate(&x, &[None, None, None], 10.0), None);
        assert_eq!(interpolate(&x, &[Some(1.0); 3], 0.5), None);
        assert_eq!(interpolate(&x, &[Some(1.0); 3], 1.0), Some(1.0));
    }
}
