//! The tables of the study in words, for a page that includes them.

use super::curve::{Convention, MeanCurve};
use super::ladder::{Ladder, Pair, Rungs};
use super::laws::{Factor, LawRow};
use crate::claim::short;
use evaluation::markdown_table;
use std::ops::Range;

/// `0.5123 +- 0.0045`: as many digits as the error allows.
fn with_error(value: f64, half_width: f64) -> String {
    let digits =
        if half_width > 0.0 { (1.0 - half_width.log10().floor()).clamp(0.0, 6.0) as usize } else { 4 };
    format!("{value:.digits$} +- {half_width:.digits$}")
}

fn loads(forces: &Range<f64>) -> String {
    format!("{:.1e} to {:.1e}", forces.start, forces.end)
}

/// What was solved, how far each curve goes, the exponents beside the laws, and the factor between line and
/// surface.
pub fn report(
    command: &str,
    solved: &[(&Ladder, &[Rungs])],
    curves: &[MeanCurve],
    laws: &[LawRow],
    factors: &[Factor],
) -> String {
    let levels = solved.iter().flat_map(|&(ladder, rungs)| {
        ladder.sizes.iter().zip(&ladder.surfaces).enumerate().map(move |(level, (size, surfaces))| {
            let pairs = rungs.iter().flat_map(|r| &r.levels[level]);
            let hours = pairs.map(Pair::seconds).sum::<f64>() / 3600.0;
            [ladder.model.name().to_owned(), size.to_string(), surfaces.to_string(), short(hours)]
        })
    });
    let head = "| | size | surfaces for each D_f | processor hours, all D_f |\n|---|---:|---:|---:|";
    let mut text = format!("`{command}`\n\n{}", markdown_table(head, levels));
    for (model, words) in [("bem3d", "Surfaces"), ("mdr1d", "Lines")] {
        for convention in Convention::BOTH {
            let curves = curves.iter().filter(|c| c.model == model && c.convention == convention);
            text += &format!("\n{words}, {}:\n\n{}", convention.words(), exponents(curves, laws));
        }
    }
    let head =
        "| D_f | F_bar | k_1D/k_3D | slope of its logarithm over ln F | constant |\n|---|---|---|---|---|";
    let row = |f: &Factor| {
        let d = format!("{:?}", f.fractal_dimension);
        let [factor, slope] = [f.value, f.slope].map(|e| with_error(e.value, e.half_width));
        [d, loads(&f.forces), factor, slope, f.verdict().to_owned()]
    };
    for convention in Convention::BOTH {
        let rows = factors.iter().filter(|f| f.convention == convention).map(row);
        text += &format!("\nLine over surface, {}:\n\n{}", convention.words(), markdown_table(head, rows));
    }
    text
}

/// The exponents of curves beside the laws.
fn exponents<'a>(curves: impl Iterator<Item = &'a MeanCurve>, laws: &[LawRow]) -> String {
    let head = "| D_f | resolved from F_bar | window | alpha | of it the grid | most of the scatter | 0.266 D_f | 1/(1 + H) | inside |\n|---|---|---|---|---|---|---|---|---|";
    let rows = curves.flat_map(|curve| {
        let first = curve.forces.get(curve.resolved.start);
        let from = first.map_or_else(|| "nowhere".to_owned(), |f| format!("{f:.1e}"));
        laws.iter().filter(|law| law.is_of(curve)).map(move |r| {
            let share = |(size, share): (usize, f64)| format!("{size} ({:.0} %)", 100.0 * share);
            [
                format!("{:?}", curve.fractal_dimension),
                from.clone(),
                format!("{} ({})", r.window, loads(&r.forces)),
                with_error(r.alpha.value(), r.alpha.half_width()),
                format!("{:.4}", r.alpha.grid),
                r.widest.map_or_else(String::new, share),
                format!("{:.3}", r.eq6()),
                format!("{:.3}", r.power_law()),
                r.verdict().to_owned(),
            ]
        })
    });
    markdown_table(head, rows)
}
