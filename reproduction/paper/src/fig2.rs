//! Fig. 2: stiffness over force in three dimensions.

use crate::curves::CurveFigure;
use crate::evaluation::{EnsembleModel, Run};
use crate::judged::Judged;
use runs::{Progress, Result};

pub(crate) const FIGURE: CurveFigure = CurveFigure {
    name: "fig2",
    title: "Fig. 2: stiffness over force, 3D boundary elements",
    model: EnsembleModel::Bem3d,
};

/// Solves the 3D ensemble and writes `fig2.csv`, `fig2-samples.csv`, `fig2-budget.csv`, `fig2.svg`,
/// `fig2.png`.
///
/// The budget takes the first surfaces on a grid half as fine as well, a twentieth more work.
///
/// Source: Fig. 2 of the paper (2049 cells a side, 60 surfaces, F_bar from 1e-8 to 20).
///
/// # Errors
/// Errors of the solver, and files that cannot be written.
pub fn fig2(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    Ok(FIGURE.reproduce(run, progress)?.0)
}
