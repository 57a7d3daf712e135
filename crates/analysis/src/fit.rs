//! `k_bar = zeta F_bar^alpha` by least squares in ln-ln.

use crate::bootstrap::Bootstrap;
use crate::curves::Curves;
use numerics::regression::least_squares;
use numerics::sum::sum;
use std::fmt;

/// The range of forces to which a power law is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitWindow {
    /// Smallest F_bar.
    pub min_force_bar: f64,
    /// Largest F_bar.
    pub max_force_bar: f64,
    /// Smallest number of cells in contact that every surface must have (where the model has cells): with
    /// fewer cells the stiffness is that of single cells.
    pub min_contact_cells: usize,
}

impl FitWindow {
    /// The paper's upper limit of its power law, `F_bar <= 0.086`. The limit of at least 10 contact cells is
    /// our own choice.
    pub const PAPER: Self = Self { min_force_bar: 0.0, max_force_bar: 0.086, min_contact_cells: 10 };

    /// All forces in a range, whatever the number of cells in contact, with a small tolerance for their
    /// rounding.
    pub fn between(min: f64, max: f64) -> Self {
        Self { min_force_bar: min * (1.0 - 1e-9), max_force_bar: max * (1.0 + 1e-9), min_contact_cells: 0 }
    }
}

impl fmt::Display for FitWindow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
        if self.min_force_bar > 0.0 {
            write!(f, "{:?} <= ", digits(self.min_force_bar))?;
        }
        let Self { max_force_bar, min_contact_cells, .. } = self;
        write!(f, "F_bar <= {:?}, all surfaces >= {min_contact_cells} contact cells", digits(*max_force_bar))
    }
}

/// A fitted power law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedPowerLaw {
    /// Exponent.
    pub alpha: f64,
    /// Standard error of alpha from the bootstrap over surfaces; `None` for one surface.
    pub alpha_se: Option<f64>,
    /// Factor: k_bar of the law at F_bar = 1.
    pub zeta: f64,
    /// Standard error of zeta from the same draws.
    pub zeta_se: Option<f64>,
    /// Smallest F_bar used.
    pub force_bar_min: f64,
    /// Largest F_bar used.
    pub force_bar_max: f64,
    /// Number of forces used.
    pub points: usize,
    /// Number of surfaces.
    pub surfaces: usize,
}

/// Why there is no fit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NoFit {
    /// The window holds fewer than three forces.
    TooFewPoints {
        /// Forces in the window.
        points: usize,
        /// The window.
        window: FitWindow,
    },
}

impl fmt::Display for NoFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewPoints { points, window } => {
                write!(f, "{points} forces in the window ({window}): at least 3 are needed")
            }
        }
    }
}

impl std::error::Error for NoFit {}

/// Fits `ln k_bar = ln zeta + alpha ln F_bar` to the arithmetic mean of k_bar over the surfaces, all forces
/// of the window with equal weight; forces at which a surface is missing are left out.
///
/// Source: Eqs. 6, 8, 9 of the paper, which fits its averaged curves. Errors: standard
/// deviation over `bootstrap` resamples of the surfaces, window fixed.
///
/// # Errors
/// [`NoFit`] when the window holds fewer than three forces.
pub fn fit_power_law(
    curves: &Curves,
    window: &FitWindow,
    bootstrap: &Bootstrap,
) -> Result<FittedPowerLaw, NoFit> {
    let inside = points_inside(curves, window);
    let too_few = NoFit::TooFewPoints { points: inside.len(), window: *window };
    if inside.len() < 3 {
        return Err(too_few);
    }
    let all = curves.all();
    let (alpha, ln_zeta) = law(curves, &inside, &all).ok_or(too_few)?;
    let error = |pick: fn((f64, f64)) -> f64| {
        bootstrap.standard_error(all.len(), |draw| law(curves, &inside, draw).map(pick))
    };
    Ok(FittedPowerLaw {
        alpha,
        alpha_se: error(|l| l.0),
        zeta: ln_zeta.exp(),
        zeta_se: error(|l| l.1.exp()),
        force_bar_min: curves.force_bar()[inside[0]],
        force_bar_max: curves.force_bar()[inside[inside.len() - 1]],
        points: inside.len(),
        surfaces: all.len(),
    })
}

/// Forces of the window at which every surface counts.
fn points_inside(curves: &Curves, window: &FitWindow) -> Vec<usize> {
    let all = curves.all();
    (0..curves.force_bar().len())
        .filter(|&j| {
            let f = curves.force_bar()[j];
            (window.min_force_bar..=window.max_force_bar).contains(&f)
                && curves
                    .drawn(&all, j)
                    .all(|s| s.is_some_and(|s| s.contact_cells.is_none_or(|c| c >= window.min_contact_cells)))
        })
        .collect()
}

/// alpha and ln zeta from the surfaces `draw` at the forces `inside`.
fn law(curves: &Curves, inside: &[usize], draw: &[usize]) -> Option<(f64, f64)> {
    let points: Vec<(f64, f64)> = inside
        .iter()
        .filter_map(|&j| {
            let k = sum(curves.drawn(draw, j).flatten().map(|s| s.stiffness_bar)) / draw.len() as f64;
            Some((curves.force_bar()[j].ln(), k.ln())).filter(|p| p.1.is_finite())
        })
        .collect();
    least_squares(&points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StiffnessSample;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// Rounding of ln and exp over a few tens of points.
    const ROUNDING: f64 = 1e-12;

    fn power(surfaces: &[f64], alpha: f64, cells: impl Fn(usize) -> Option<usize>) -> Curves {
        let force: Vec<f64> = (0..16).map(|j| 10f64.powf(-6.0 + f64::from(j) * 0.5)).collect();
        let rows = surfaces
            .iter()
            .map(|zeta| {
                (force.iter().enumerate())
                    .map(|(j, f)| {
                        Some(StiffnessSample { stiffness_bar: zeta * f.powf(alpha), contact_cells: cells(j) })
                    })
                    .collect()
            })
            .collect();
        Curves::new(force, rows).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn a_power_law_body_gives_its_exponent(n in 0.2..4.0_f64, zeta in 0.1..10.0_f64) {
            // Exactly (data/paper/VALUES.md): dlnk/dlnF = 1/(n + 1) for f = c r^n.
            let law = fit_power_law(&power(&[zeta], 1.0 / (n + 1.0), |_| None), &FitWindow::PAPER, &Bootstrap::default());
            let law = law.unwrap();
            assert_relative_eq!(law.alpha, 1.0 / (n + 1.0), max_relative = ROUNDING);
            assert_relative_eq!(law.zeta, zeta, max_relative = ROUNDING);
            prop_assert!(law.alpha_se.is_none() && law.force_bar_max <= 0.086);
        }
    }

    #[test]
    fn the_window_leaves_the_floor_out() {
        let law = fit_power_law(
            &power(&[1.0, 2.0], 0.6, |j| Some(4 * j)),
            &FitWindow::PAPER,
            &Bootstrap::default(),
        );
        let law = law.unwrap();
        assert_relative_eq!(law.force_bar_min, 10f64.powf(-4.5), max_relative = ROUNDING);
        // From j = 3 (12 cells, 10^-4.5) to j = 9 (10^-1.5 <= 0.086).
        assert_eq!(law.points, 7);
        // Surfaces that differ by a factor only: alpha is the same in every resample, zeta is not.
        assert!(law.alpha_se.unwrap() < ROUNDING && law.zeta_se.unwrap() > 0.1);
    }

    #[test]
    fn too_few_points_are_a_reason_and_not_a_nan() {
        let none = fit_power_law(&power(&[1.0], 0.5, |_| Some(9)), &FitWindow::PAPER, &Bootstrap::default());
        let reason = none.unwrap_err().to_string();
        assert!(reason.starts_with("0 forces in the window (F_bar <= 0.086, all"), "{reason}");
        let empty = Curves::new(vec![], vec![vec![]]).unwrap();
        assert!(fit_power_law(&empty, &FitWindow::PAPER, &Bootstrap::default()).is_err());
    }

    #[test]
    fn a_missing_sample_removes_its_force() {
        let full = power(&[1.0, 1.5], 0.5, |_| Some(100));
        let mut rows = full.surfaces().to_vec();
        rows[1][2] = None;
        let holed = Curves::new(full.force_bar().to_vec(), rows).unwrap();
        let points = |c| fit_power_law(c, &FitWindow::PAPER, &Bootstrap::default()).unwrap().points;
        assert_eq!(points(&holed) + 1, points(&full));
    }

    #[test]
    fn errors_are_reproducible() {
        let curves = power(&[1.0, 1.2, 0.9, 1.4], 0.55, |_| Some(50));
        let w = FitWindow::PAPER;
        let b = Bootstrap::default();
        assert_eq!(fit_power_law(&curves, &w, &b), fit_power_law(&curves, &w, &b));
        assert_ne!(
            fit_power_law(&curves, &w, &b).unwrap().zeta_se,
            fit_power_law(&curves, &w, &Bootstrap { seed: 1, ..b }).unwrap().zeta_se
        );
    }
}
