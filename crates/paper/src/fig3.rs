//! Fig. 3: the exponent alpha over the fractal dimension.

use crate::claims;
use crate::fitted::{self, FittedFigure};
use crate::judged::Judged;
use evaluation::Run;
use plots::{Axis, Key, LineStyle, REFERENCE};
use runs::{CsvFile, Progress, Result};
use std::path::{Path, PathBuf};

pub(crate) const FIGURE: FittedFigure = FittedFigure {
    name: "fig3",
    title: "Fig. 3: exponent of k_bar = zeta F_bar^alpha over the fractal dimension",
    columns: ["alpha", "alpha_se"],
    value: |law| (law.alpha, law.alpha_se),
    formulas: &[
        ("paper_fit", "Eq. 6: 0.266 D_f", analytic::exponent_fit),
        ("scaling", "Eq. 24: 1/(1 + H)", |d| analytic::exponent_scaling(3.0 - d)),
    ],
    draw,
    claims: claims::exponents,
};

/// Fits both ensembles (solving what is not stored) and writes `fig3.csv`, `fig3.svg`, `fig3.png`.
///
/// Source: Fig. 3 of the paper; Eq. 6 (`0.266 D_f`) and Eq. 24 (`1/(1 + H)`) beside.
///
/// # Errors
/// As [`crate::fig2`] and [`crate::fig6`].
pub fn fig3(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    FIGURE.reproduce(run, progress)
}

/// Draws `fig3.svg` and `fig3.png` from the table; `finer` is a table of Fig. 2 whose exponents stand beside.
pub(crate) fn draw(csv: &Path, finer: Option<&Path>, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let axes = (Axis::Linear(1.9, 3.1), Axis::Linear(0.42, 1.05));
    let title = "Fig. 3: exponent of $\\bar{k} = ζ \\bar{F}^α$ over the fractal dimension";
    let mut picture = fitted::picture(axes, "exponent $α$", title);
    picture.line(&fitted::formula(&file, "paper_fit", "alpha")?, REFERENCE, 1.6, LineStyle::Solid);
    picture.line(&fitted::formula(&file, "scaling", "alpha")?, REFERENCE, 1.6, LineStyle::Dashed);
    fitted::points(&mut picture, &file, finer, "alpha")?;
    picture.legend("paper, Eq. 6: $α = 0.266 D_{\\rm{f}}$", REFERENCE, Key::Line(LineStyle::Solid));
    picture.legend(
        "paper, Eq. 24: $α = 1/(1 + H)$, $H = 3 - D_{\\rm{f}}$",
        REFERENCE,
        Key::Line(LineStyle::Dashed),
    );
    picture.save(out, "fig3")
}
