//! Fig. 7: the factor zeta over the fractal dimension.

use crate::evaluation::Run;
use crate::fitted::{FittedFigure, FittedFormula};
use crate::judged::Judged;
use plots::{Axis, LineStyle};
use runs::{Progress, Result};

pub(crate) const FIGURE: FittedFigure = FittedFigure {
    name: "fig7",
    title: "Fig. 7: factor of k_bar = zeta F_bar^alpha over the fractal dimension",
    columns: ["zeta", "zeta_se"],
    value: |law| (law.zeta, law.zeta_se),
    estimate: |law| law.zeta,
    formulas: &[FittedFormula {
        name: "paper_fit",
        note: "Eq. 11: 0.18/0.086^(0.266 D_f)",
        of: analytic::zeta_fit,
        legend: "paper, Eq. 11: $ζ = 0.18/0.086^{0.266 D_{\\rm{f}}}$",
        style: LineStyle::Dashed,
    }],
    words: ["Fig. 7: factor of $\\bar{k} = ζ \\bar{F}^α$ over the fractal dimension", "factor $ζ$"],
    axis: |highest| Axis::Linear(0.4, ((highest.max(1.7) + 0.05) * 5.0).ceil() / 5.0),
};

/// Fits both ensembles (solving what is not stored) and writes `fig7.csv`, `fig7.svg`, `fig7.png`.
///
/// Source: Fig. 7 of the paper; Eq. 11 (`0.18/0.086^(0.266 D_f)`) is shown for comparison.
///
/// # Errors
/// As [`crate::fig2`] and [`crate::fig6`].
pub fn fig7(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    FIGURE.reproduce(run, progress)
}
