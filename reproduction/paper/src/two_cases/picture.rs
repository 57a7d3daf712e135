//! The table of the two cases, and the pictures drawn from it.

use super::reading::slopes;
use super::study::{CaseCurve, NAME, NAMES, PairRow};
use crate::evaluation::{FLOOR_CELLS, FRACTAL_DIMENSION, TableOf, read_rows};
use crate::output::save;
use crate::words;
use contact_model::PAPER_STIFFNESS_FACTOR;
use contact_model::Table;
use plots::{LegendKey, LineStyle, Mark, MarkShape, NEUTRAL, Picture, logarithmic};
use runs::{CsvFile, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Largest stiffness in the pictures: that of a periodic square diverges towards full contact.
const HIGHEST: f64 = 300.0;

const ROLL_OFF: &str = "waves a side where the spectrum rolls off; empty for one that is fractal to the side";

pub(super) fn table(curves: &[CaseCurve]) -> Result<Table> {
    const FORCE: &str =
        "F/(E* h L), h the rms height of each surface (measured; of the spectrum for a theory)";
    const PROPORTION: &str = "k h/F: the constant of proportionality where there is one";
    const LEFT_OUT: &str = "surfaces without a stiffness: not converged, or in full contact";
    const FEWEST: &str = "fewest cells in contact on any surface of the mean";
    let points: Vec<_> = (curves.iter())
        .flat_map(|c| c.points.iter().zip(slopes(&c.points)).map(move |(p, slope)| (c, p, slope)))
        .collect();
    TableOf::new(
        "Two cases: k over F with free and periodic boundaries, with and without a roll-off of the spectrum",
        &points,
    )
    .column("case", "-", "boundary and spectrum", |(c, ..)| c.case.name())
    .column("fractal_dimension", "1", FRACTAL_DIMENSION, |(c, ..)| c.case.fractal_dimension)
    .column("roll_off", "1", ROLL_OFF, |(c, ..)| c.case.roll_off)
    .column("model", "-", "bem3d, or a theory of periodic contact", |(c, ..)| c.model)
    .column("force_bar", "1", FORCE, |(_, p, _)| p.force_bar)
    .column("stiffness_bar", "1", "mean of k/(1.1419 E* L)", |(_, p, _)| p.stiffness_bar)
    .column("stiffness_bar_se", "1", "standard error of that mean", |(_, p, _)| p.standard_error)
    .column("slope", "1", "d ln k/d ln F from the loads before and after", |(.., slope)| *slope)
    .column("k_h_over_force", "1", PROPORTION, |(_, p, _)| {
        PAPER_STIFFNESS_FACTOR * p.stiffness_bar / p.force_bar
    })
    .column("area", "1", "mean share of the square in contact", |(_, p, _)| p.area)
    .column("area_coarser", "1", "the same with cells twice as large", |(_, p, _)| p.area_coarser)
    .column("kappa", "1", "A E* |grad h|/F, |grad h| of the spectrum, A as counted", |(_, p, _)| p.kappa)
    .column("kappa_extrapolated", "1", "the same of 2 A(a) - A(2a): area and area_coarser", |(_, p, _)| {
        let (area, coarser) = (p.area?, p.area_coarser?);
        p.kappa.map(|kappa| kappa * (2.0 - coarser / area))
    })
    .column("surfaces", "1", "surfaces in the mean (0: a theory)", |(_, p, _)| p.surfaces)
    .column("left_out", "1", LEFT_OUT, |(_, p, _)| p.left_out)
    .column("min_contact_cells", "1", FEWEST, |(_, p, _)| p.min_contact_cells)
    .column("below_floor", "-", "true where some surface has fewer than 10 contact cells", |(_, p, _)| {
        p.min_contact_cells.is_some_and(|n| n < FLOOR_CELLS)
    })
    .table()
}

/// Periodic over free stiffness.
pub(super) fn pairs_table(pairs: &[PairRow]) -> Result<Table> {
    TableOf::new("Periodic over free stiffness of the same surfaces", pairs)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |p| p.fractal_dimension)
        .column("roll_off", "1", ROLL_OFF, |p| p.roll_off)
        .column("force_bar", "1", "F/(E* h L), h the measured rms height of each surface", |p| p.force_bar)
        .column(
            "ratio",
            "1",
            "mean -dF/d(mean gap) of the periodic square over mean dF/dd of the free one",
            |p| p.ratio.value,
        )
        .column("half_width", "1", "of its 95 % interval, by Student's distribution over the pairs", |p| {
            p.ratio.half_width
        })
        .column("surfaces", "1", "pairs in the means", |p| p.surfaces)
        .table()
}

/// A fractal dimension and a roll-off: the four curves of a picture.
type PicturePanel = (f64, f64);

/// A mean of the table.
#[derive(Deserialize)]
struct CaseRow {
    case: String,
    fractal_dimension: f64,
    roll_off: Option<f64>,
    model: String,
    force_bar: f64,
    stiffness_bar: f64,
    stiffness_bar_se: Option<f64>,
    k_h_over_force: f64,
    below_floor: bool,
}

/// The problems of a table, in its order, each with the names of its pictures of k and of k h/F.
fn problems(rows: &[CaseRow]) -> Vec<(PicturePanel, [String; 2])> {
    let mut all: Vec<PicturePanel> = Vec::new();
    for problem in rows.iter().filter_map(|r| Some((r.fractal_dimension, r.roll_off?))) {
        if !all.iter().any(|known| same(*known, problem)) {
            all.push(problem);
        }
    }
    let one = all.len() == 1;
    let named = |of: PicturePanel| {
        let suffix = if one { String::new() } else { format!("-Df{:?}-rolloff{}", of.0, of.1) };
        (of, [format!("{NAME}{suffix}"), format!("{NAME}-ratio{suffix}")])
    };
    all.into_iter().map(named).collect()
}

fn same(a: PicturePanel, b: PicturePanel) -> bool {
    (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9
}

/// Names of the pictures that [`draw`] makes of a table, without their endings.
pub(super) fn names(csv: &Path) -> Result<Vec<String>> {
    Ok(problems(&read_rows(csv, &CsvFile::read(csv)?)?).into_iter().flat_map(|(_, names)| names).collect())
}

/// Draws two pictures of each problem from the table.
pub(crate) fn draw(csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let rows: Vec<CaseRow> = read_rows(csv, &file)?;
    let mut files = Vec::new();
    for (of, [stiffness, ratio]) in problems(&rows) {
        let panel = |value| CasePanel::new(&file, &rows, of, value);
        files.extend(save(panel(|r| r.stiffness_bar).picture(words::STIFFNESS).files(&stiffness), out)?);
        files.extend(save(panel(|r| r.k_h_over_force).picture("ratio $k h/F$").files(&ratio), out)?);
    }
    Ok(files)
}

/// A picture of one problem.
struct CasePanel<'a> {
    file: &'a CsvFile,
    /// Those of the problem.
    rows: Vec<&'a CaseRow>,
    problem: PicturePanel,
    /// The quantity that it shows over the force.
    value: fn(&CaseRow) -> f64,
}

/// How the curve of a case looks.
struct CaseLook {
    color: &'static str,
    width: f64,
    mark: Mark,
    radius: f64,
}

impl<'a> CasePanel<'a> {
    fn new(
        file: &'a CsvFile,
        rows: &'a [CaseRow],
        problem: PicturePanel,
        value: fn(&CaseRow) -> f64,
    ) -> Self {
        // A spectrum that is fractal to the side belongs to every roll-off.
        let of_problem = |r: &&CaseRow| same((r.fractal_dimension, r.roll_off.unwrap_or(problem.1)), problem);
        Self { file, rows: rows.iter().filter(of_problem).collect(), problem, value }
    }

    fn shown(&self) -> impl Iterator<Item = &'a CaseRow> {
        self.rows.iter().copied().filter(|r| r.stiffness_bar <= HIGHEST)
    }

    fn picture(&self, label: &str) -> Picture {
        let mut picture = self.axes(label);
        // One above the other where two agree: the first is wide and pale, the second thin on top of it.
        let looks = [
            (3.4, Mark::Solid(MarkShape::Circle), 5.4),
            (1.6, Mark::Hollow(MarkShape::Circle), 3.2),
            (3.4, Mark::Solid(MarkShape::Square), 5.0),
            (1.6, Mark::Hollow(MarkShape::Square), 3.2),
        ];
        for ((case, color), (width, mark, radius)) in NAMES.into_iter().zip(looks) {
            self.curves(&mut picture, case, &CaseLook { color, width, mark, radius });
        }
        self.legend(&mut picture);
        picture
    }

    /// Empty axes with their titles.
    fn axes(&self, label: &str) -> Picture {
        let solved = || self.shown().filter(|r| r.model == "bem3d");
        let (x, y) = (logarithmic(solved().map(|r| r.force_bar)), logarithmic(solved().map(self.value)));
        let flag = |name| words::flag(self.file, name).unwrap_or("?");
        let n = flag("--cells");
        Picture::new(x, y, words::FORCE, label)
            .with_size(800.0, 560.0)
            .with_title("Two cases: boundary and roll-off of the spectrum")
            .with_subtitle(&format!(
                "$D_{{\\rm{{f}}}} = {:?}$, {n} × {n} cells, {} surfaces for each case; roll-off at {} waves a side",
                self.problem.0,
                flag("--surfaces"),
                self.problem.1,
            ))
            .with_legend_below()
    }

    /// Draws a case, solved and of the theories, with its line of the legend.
    fn curves(&self, picture: &mut Picture, case: &str, look: &CaseLook) {
        let &CaseLook { color, width, mark, radius } = look;
        let value = self.value;
        let select = |model: &str, floor: bool| -> Vec<&CaseRow> {
            self.shown().filter(|r| r.case == case && r.model == model && r.below_floor == floor).collect()
        };
        let at = |rows: &[&CaseRow]| rows.iter().map(|r| (r.force_bar, value(r))).collect::<Vec<_>>();
        let inside = select("bem3d", false);
        let bar = |r: &&CaseRow| {
            let error = r.stiffness_bar_se.map(|e| 2.0 * (value(r) * e / r.stiffness_bar));
            (r.force_bar, value(r), error)
        };
        let bars: Vec<_> = inside.iter().map(bar).collect();
        picture.line(&at(&inside), color, width, LineStyle::Solid);
        picture.points(&at(&inside), color, radius, mark);
        picture.errors(&bars, color);
        picture.points(&at(&select("bem3d", true)), color, radius, Mark::Ring(mark_shape(mark)));
        picture.line(&at(&select("persson", false)), color, 1.5, LineStyle::Dashed);
        picture.line(&at(&select("greenwood_williamson", false)), color, 1.5, LineStyle::Dotted);
        let stiffness = if case.starts_with("periodic") {
            "$k = -\\rm{d}F/\\rm{d}\\bar{g}$, $\\bar{g}$ the mean gap"
        } else {
            "$k = \\rm{d}F/\\rm{d}d$, $d$ the approach"
        };
        picture.legend(&format!("{case}: {stiffness}"), color, LegendKey::Curve(mark));
    }

    /// The lines of the legend that all cases share.
    fn legend(&self, picture: &mut Picture) {
        picture.legend("Persson", NEUTRAL, LegendKey::Line(LineStyle::Dashed));
        picture.legend("Greenwood and Williamson", NEUTRAL, LegendKey::Line(LineStyle::Dotted));
        picture.legend("bars: ± 2 standard errors", NEUTRAL, LegendKey::Bar(Mark::Solid(MarkShape::Circle)));
        if self.shown().any(|r| r.below_floor) {
            let label = format!("fewer than {FLOOR_CELLS} contact cells");
            picture.legend(&label, NEUTRAL, LegendKey::Mark(Mark::Ring(MarkShape::Circle)));
        }
        if self.rows.iter().any(|r| r.stiffness_bar > HIGHEST) {
            picture.legend(
                &format!("periodic: only $\\bar{{k}}$ up to {HIGHEST} is shown"),
                NEUTRAL,
                LegendKey::Words,
            );
        }
    }
}

fn mark_shape(mark: Mark) -> MarkShape {
    match mark {
        Mark::Solid(shape) | Mark::Hollow(shape) | Mark::Ring(shape) => shape,
    }
}
