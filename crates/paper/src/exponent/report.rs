//! The tables of the study in words, for a page that includes them.

use super::curve::{Convention, MeanCurve};
use super::ladder::{Ladder, Pair, Rungs};
use super::laws::{Factor, LawRow};
use crate::claim::short;
use std::fmt::Write as _;

/// `0.5123 +- 0.0045`: as many digits as the error allows.
fn with_error(value: f64, half_width: f64) -> String {
    let digits =
        if half_width > 0.0 { (1.0 - half_width.log10().floor()).clamp(0.0, 6.0) as usize } else { 4 };
    format!("{value:.digits$} +- {half_width:.digits$}")
}

/// What was solved, how far each curve goes, the exponents beside the laws, and the factor between line and surface.
pub fn report(
    command: &str,
    solved: &[(&Ladder, &[Rungs])],
    curves: &[MeanCurve],
    laws: &[LawRow],
    factors: &[Factor],
) -> String {
    let mut text = format!("`{command}`\n\n");
    text += "| | size | surfaces for each D_f | processor hours, all D_f |\n|---|---:|---:|---:|\n";
    for (ladder, rungs) in solved {
        let name = ladder.model.name();
        for (level, size) in ladder.sizes.iter().enumerate() {
            let pairs = rungs.iter().flat_map(|r| &r.levels[level]);
            let hours = pairs.map(Pair::seconds).sum::<f64>() / 3600.0;
            // Writing to a string does not fail.
            let _ = writeln!(text, "| {name} | {size} | {} | {} |", ladder.surfaces[level], short(hours));
        }
    }
    for (model, words) in [("bem3d", "Surfaces"), ("mdr1d", "Lines")] {
        for convention in [Convention::Measured, Convention::FixedSpectrum] {
            exponents(&mut text, (model, words), convention, curves, laws);
        }
    }
    for convention in [Convention::Measured, Convention::FixedSpectrum] {
        let _ = writeln!(
            text,
            "\nLine over surface, {}:\n\n| D_f | F_bar | k_1D/k_3D | slope of its logarithm over ln F | constant |\n|---|---|---|---|---|",
            words_of(convention)
        );
        for f in factors.iter().filter(|f| f.convention == convention) {
            let _ = writeln!(
                text,
                "| {:?} | {:.1e} to {:.1e} | {} | {} | {} |",
                f.fractal_dimension,
                f.forces.start,
                f.forces.end,
                with_error(f.value, f.half_width),
                with_error(f.slope, f.slope_half_width),
                f.verdict()
            );
        }
    }
    text
}

fn words_of(convention: Convention) -> &'static str {
    match convention {
        Convention::Measured => "F_bar by the measured rms height of each grid",
        Convention::FixedSpectrum => "F_bar by the rms height of the spectrum on 2049 x 2049 cells",
    }
}

fn exponents(
    text: &mut String,
    (model, words): (&str, &str),
    convention: Convention,
    curves: &[MeanCurve],
    laws: &[LawRow],
) {
    let _ = writeln!(
        text,
        "\n{words}, {}:\n\n| D_f | resolved from F_bar | window | alpha | of it the grid | most of the scatter | 0.266 D_f | 1/(1 + H) | inside |\n|---|---|---|---|---|---|---|---|---|",
        words_of(convention)
    );
    for curve in curves.iter().filter(|c| c.model == model && c.convention == convention) {
        let d = curve.fractal_dimension;
        let from = curve
            .forces
            .get(curve.resolved.start)
            .map_or_else(|| "nowhere".to_owned(), |f| format!("{f:.1e}"));
        let own = laws.iter().filter(|r| {
            r.model == model && r.convention == convention && (r.fractal_dimension - d).abs() < 1e-9
        });
        for r in own {
            let widest =
                r.widest.map_or_else(String::new, |(size, share)| format!("{size} ({:.0} %)", 100.0 * share));
            let _ = writeln!(
                text,
                "| {d:?} | {from} | {} ({:.1e} to {:.1e}) | {} | {:.4} | {widest} | {:.3} | {:.3} | {} |",
                r.window,
                r.forces.start,
                r.forces.end,
                with_error(r.alpha.value(), r.alpha.half_width()),
                r.alpha.grid,
                r.eq6(),
                r.power_law(),
                r.verdict()
            );
        }
    }
}
