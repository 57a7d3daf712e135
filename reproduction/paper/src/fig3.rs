//! Fig. 3: the exponent alpha over the fractal dimension.

use crate::evaluation::Run;
use crate::fitted::{FittedFigure, FittedFormula};
use crate::judged::Judged;
use plots::{Axis, LineStyle};
use runs::{Progress, Result};

pub(crate) const FIGURE: FittedFigure = FittedFigure {
    name: "fig3",
    title: "Fig. 3: exponent of k_bar = zeta F_bar^alpha over the fractal dimension",
    columns: ["alpha", "alpha_se"],
    value: |law| (law.alpha, law.alpha_se),
    estimate: |law| law.alpha,
    formulas: &[
        FittedFormula {
            name: "paper_fit",
            note: "Eq. 6: 0.266 D_f",
            of: analytic::exponent_fit,
            legend: "paper, Eq. 6: $α = 0.266 D_{\\rm{f}}$",
            style: LineStyle::Solid,
        },
        FittedFormula {
            name: "scaling",
            note: "Eq. 24: 1/(1 + H)",
            of: |d| analytic::exponent_scaling(3.0 - d),
            legend: "paper, Eq. 24: $α = 1/(1 + H)$, $H = 3 - D_{\\rm{f}}$",
            style: LineStyle::Dashed,
        },
    ],
    words: ["Fig. 3: exponent of $\\bar{k} = ζ \\bar{F}^α$ over the fractal dimension", "exponent $α$"],
    axis: |_| Axis::Linear(0.42, 1.05),
};

/// Fits both ensembles (solving what is not stored) and writes `fig3.csv`, `fig3.svg`, `fig3.png`.
///
/// Source: Fig. 3 of the paper; Eq. 6 (`0.266 D_f`) and Eq. 24 (`1/(1 + H)`) are shown for comparison.
///
/// # Errors
/// As [`crate::fig2`] and [`crate::fig6`].
pub fn fig3(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    FIGURE.reproduce(run, progress)
}
