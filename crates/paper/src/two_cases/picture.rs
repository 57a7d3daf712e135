//! The table of the two cases, and the pictures drawn from it.

use super::reading::slopes;
use super::study::{CaseCurve, NAME, NAMES, PairRow};
use crate::words;
use analysis::Table;
use contact_model::PAPER_STIFFNESS_FACTOR;
use evaluation::{FLOOR_CELLS, FRACTAL_DIMENSION, TableOf};
use plots::{Key, LineStyle, Mark, MarkShape, NEUTRAL, Picture, logarithmic};
use runs::{CsvFile, Result};
use std::path::{Path, PathBuf};

/// Stiffness above which the pictures end: towards full contact of a periodic square it has no limit.
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
    .column("kappa", "1", "A E* |grad h|/F, |grad h| of the spectrum", |(_, p, _)| p.kappa)
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
type Problem = (f64, f64);

/// The problems of a table, in its order, each with the names of its pictures of k and of k h/F.
fn problems(file: &CsvFile) -> Result<Vec<(Problem, [String; 2])>> {
    let mut all: Vec<Problem> = Vec::new();
    for (d, roll_off) in file.numbers("fractal_dimension")?.into_iter().zip(file.numbers("roll_off")?) {
        let Some(problem) = d.zip(roll_off) else { continue };
        if !all.iter().any(|known| same(*known, problem)) {
            all.push(problem);
        }
    }
    let one = all.len() == 1;
    let named = |of: Problem| {
        let suffix = if one { String::new() } else { format!("-Df{:?}-rolloff{}", of.0, of.1) };
        (of, [format!("{NAME}{suffix}"), format!("{NAME}-ratio{suffix}")])
    };
    Ok(all.into_iter().map(named).collect())
}

fn same(a: Problem, b: Problem) -> bool {
    (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9
}

/// Names of the pictures that [`draw`] makes of a table, without their endings.
pub(super) fn names(csv: &Path) -> Result<Vec<String>> {
    Ok(problems(&CsvFile::read(csv)?)?.into_iter().flat_map(|(_, names)| names).collect())
}

/// Draws two pictures of each problem from the table.
pub(crate) fn draw(csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let mut files = Vec::new();
    for (of, [stiffness, ratio]) in problems(&file)? {
        files.extend(panel(&file, of, ("stiffness_bar", words::STIFFNESS), out, &stiffness)?);
        files.extend(panel(&file, of, ("k_h_over_force", "ratio $k h/F$"), out, &ratio)?);
    }
    Ok(files)
}

fn panel(
    file: &CsvFile,
    problem: Problem,
    (quantity, label): (&str, &str),
    out: &Path,
    name: &str,
) -> Result<Vec<PathBuf>> {
    let (case, model) = (file.texts("case")?, file.texts("model")?);
    let (d, roll_off) = (file.numbers("fractal_dimension")?, file.numbers("roll_off")?);
    let of_problem = |i: usize| d[i].is_some_and(|d| same((d, roll_off[i].unwrap_or(problem.1)), problem));
    let (force, value, k) =
        (file.numbers("force_bar")?, file.numbers(quantity)?, file.numbers("stiffness_bar")?);
    let (error, floor) = (file.numbers("stiffness_bar_se")?, file.texts("below_floor")?);
    let rows: Vec<Row<'_>> = (0..case.len())
        .filter(|&i| of_problem(i) && k[i].is_some_and(|k| k <= HIGHEST))
        .filter_map(|i| {
            let (force, value) = (force[i]?, value[i]?);
            let error = error[i].map(|e| value * e / k[i].unwrap_or(1.0));
            Some(Row { case: case[i], model: model[i], force, value, error, below_floor: floor[i] == "true" })
        })
        .collect();
    let solved = || rows.iter().filter(|r| r.model == "bem3d");
    let (x, y) = (logarithmic(solved().map(|r| r.force)), logarithmic(solved().map(|r| r.value)));
    let flag = |name| words::flag(file, name).unwrap_or("?");
    let n = flag("--cells");
    let mut picture = Picture::new(x, y, words::FORCE, label)
        .with_size(800.0, 560.0)
        .with_title("Two cases: boundary and roll-off of the spectrum")
        .with_subtitle(&format!(
            "$D_{{\\rm{{f}}}} = {:?}$, {n} × {n} cells, {} surfaces for each case; roll-off at {} waves a side",
            problem.0,
            flag("--surfaces"),
            problem.1,
        ))
        .with_legend_below();
    // One above the other where two agree: the first is wide and pale, the second thin on top of it.
    let looks = [
        (3.4, Mark::Solid(MarkShape::Circle), 5.4),
        (1.6, Mark::Hollow(MarkShape::Circle), 3.2),
        (3.4, Mark::Solid(MarkShape::Square), 5.0),
        (1.6, Mark::Hollow(MarkShape::Square), 3.2),
    ];
    for ((of, color), (width, mark, radius)) in NAMES.into_iter().zip(looks) {
        let select = |name: &str, floor: bool| -> Vec<&Row<'_>> {
            let wanted = |r: &&Row<'_>| r.case == of && r.model == name && r.below_floor == floor;
            rows.iter().filter(wanted).collect()
        };
        let at = |rows: &[&Row<'_>]| rows.iter().map(|r| (r.force, r.value)).collect::<Vec<_>>();
        let inside = select("bem3d", false);
        let bars: Vec<_> = inside.iter().map(|r| (r.force, r.value, r.error.map(|e| 2.0 * e))).collect();
        picture.line(&at(&inside), color, width, LineStyle::Solid);
        picture.points(&at(&inside), color, radius, mark);
        picture.errors(&bars, color);
        picture.points(&at(&select("bem3d", true)), color, radius, Mark::Ring(mark_shape(mark)));
        picture.line(&at(&select("persson", false)), color, 1.5, LineStyle::Dashed);
        picture.line(&at(&select("greenwood_williamson", false)), color, 1.5, LineStyle::Dotted);
        let stiffness = if of.starts_with("periodic") {
            "$k = -\\rm{d}F/\\rm{d}\\bar{g}$, $\\bar{g}$ the mean gap"
        } else {
            "$k = \\rm{d}F/\\rm{d}d$, $d$ the approach"
        };
        picture.legend(&format!("{of}: {stiffness}"), color, Key::Curve(mark));
    }
    picture.legend("Persson", NEUTRAL, Key::Line(LineStyle::Dashed));
    picture.legend("Greenwood and Williamson", NEUTRAL, Key::Line(LineStyle::Dotted));
    picture.legend("bars: ± 2 standard errors", NEUTRAL, Key::Bar(Mark::Solid(MarkShape::Circle)));
    if rows.iter().any(|r| r.below_floor) {
        let label = format!("fewer than {FLOOR_CELLS} contact cells");
        picture.legend(&label, NEUTRAL, Key::Mark(Mark::Ring(MarkShape::Circle)));
    }
    if (0..k.len()).any(|i| of_problem(i) && k[i].is_some_and(|k| k > HIGHEST)) {
        picture.legend(&format!("periodic: only $\\bar{{k}}$ up to {HIGHEST} is shown"), NEUTRAL, Key::Words);
    }
    picture.save(out, name)
}

/// A mean as the pictures see it.
struct Row<'a> {
    case: &'a str,
    model: &'a str,
    force: f64,
    value: f64,
    error: Option<f64>,
    below_floor: bool,
}

fn mark_shape(mark: Mark) -> MarkShape {
    match mark {
        Mark::Solid(shape) | Mark::Hollow(shape) | Mark::Ring(shape) => shape,
    }
}
