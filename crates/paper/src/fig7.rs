//! Fig. 7: the factor zeta over the fractal dimension.

use crate::claims;
use crate::fitted::{self, FittedFigure};
use crate::judged::Judged;
use evaluation::Run;
use plots::{Axis, Key, LineStyle, REFERENCE};
use runs::{CsvFile, Progress, Result};
use std::path::{Path, PathBuf};

pub(crate) const FIGURE: FittedFigure = FittedFigure {
    name: "fig7",
    title: "Fig. 7: factor of k_bar = zeta F_bar^alpha over the fractal dimension",
    columns: ["zeta", "zeta_se"],
    value: |law| (law.zeta, law.zeta_se),
    formulas: &[("paper_fit", "Eq. 11: 0.18/0.086^(0.266 D_f)", analytic::zeta_fit)],
    draw,
    claims: claims::factors,
};

/// Fits both ensembles (solving what is not stored) and writes `fig7.csv`, `fig7.svg`, `fig7.png`.
///
/// Source: Fig. 7 of the paper; Eq. 11 (`0.18/0.086^(0.266 D_f)`) beside.
///
/// # Errors
/// As [`crate::fig2`] and [`crate::fig6`].
pub fn fig7(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    FIGURE.reproduce(run, progress)
}

/// Draws `fig7.svg` and `fig7.png` from the table; `finer` is a table of Fig. 2 whose factors stand beside.
pub(crate) fn draw(csv: &Path, finer: Option<&Path>, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let law = fitted::formula(&file, "paper_fit", "zeta")?;
    let mut all = fitted::series(&file, "bem3d", "zeta")?;
    all.extend(fitted::series(&file, "mdr1d", "zeta")?);
    if let Some(path) = finer {
        all.extend(fitted::finer_series(path, "zeta")?);
    }
    let highest = all.iter().map(|p| p.value + p.error.unwrap_or(0.0)).fold(1.7, f64::max) + 0.05;
    let axes = (Axis::Linear(1.9, 3.1), Axis::Linear(0.4, (highest * 5.0).ceil() / 5.0));
    let title = "Fig. 7: factor of $\\bar{k} = ζ \\bar{F}^α$ over the fractal dimension";
    let mut picture = fitted::picture(axes, "factor $ζ$", title);
    picture.line(&law, REFERENCE, 1.6, LineStyle::Dashed);
    fitted::points(&mut picture, &file, finer, "zeta")?;
    let label = "paper, Eq. 11: $ζ = 0.18/0.086^{0.266 D_{\\rm{f}}}$";
    picture.legend(label, REFERENCE, Key::Line(LineStyle::Dashed));
    picture.save(out, "fig7")
}
