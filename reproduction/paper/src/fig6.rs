//! Fig. 6: stiffness over force in one dimension.

use crate::curves::CurveFigure;
use crate::evaluation::{EnsembleModel, Run};
use crate::judged::Judged;
use runs::{Progress, Result};

pub(crate) const FIGURE: CurveFigure = CurveFigure {
    name: "fig6",
    title: "Fig. 6: stiffness over force, 1D reduction",
    model: EnsembleModel::Mdr1d,
};

/// Solves the 1D ensemble and writes `fig6.csv`, `fig6-samples.csv`, `fig6-budget.csv`, `fig6.svg`,
/// `fig6.png`.
///
/// Source: Fig. 6 of the paper (2^20 elements, 500 lines).
///
/// # Errors
/// Errors of the model, and files that cannot be written.
pub fn fig6(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    Ok(FIGURE.reproduce(run, progress)?.0)
}
