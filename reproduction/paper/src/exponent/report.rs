//! The tables of the study in words, for a page that includes them.

use super::curve::Convention;
use super::families::FamilyTest;
use super::ladder::Rungs;
use super::laws::{FittedLimit, LawRow, ModelRatio, eq6, eq24, raised};
use crate::evaluation::markdown_table;

/// `0.5123 +- 0.0045`: as many digits as the error allows.
fn with_error(value: f64, half_width: f64) -> String {
    let digits =
        if half_width > 0.0 { (1.0 - half_width.log10().floor()).clamp(0.0, 6.0) as usize } else { 4 };
    format!("{value:.digits$} +- {half_width:.digits$}")
}

fn surfaces_or_lines(model: &str) -> &'static str {
    if model == "bem3d" { "surfaces" } else { "lines" }
}

/// A probability; small ones are written as a power of ten.
fn chance(of: f64) -> String {
    if of < 1e-3 { format!("{of:.0e}") } else { format!("{of:.3}") }
}

/// The number of surfaces solved on each grid for each fractal dimension.
fn solved(rungs: &[Rungs]) -> String {
    let rows = rungs.iter().map(|r| {
        let levels = r.sizes.iter().zip(&r.levels).map(|(size, pairs)| format!("{size}: {}", pairs.len()));
        let (model, d) = (surfaces_or_lines(r.model.name()), format!("{:?}", r.fractal_dimension));
        [model.to_owned(), d, levels.collect::<Vec<_>>().join(", ")]
    });
    markdown_table("| | D_f | cells a side or elements: how many |\n|---|---|---|", rows)
}

/// The exponents towards zero force that are judged.
fn towards_zero(limits: &[FittedLimit]) -> String {
    let head = "| | D_f | F_bar from | alpha towards 0, 95 % | omega | alpha, omega = 0.5 | alpha, to 0.06 | 0.266 D_f | 1/(1 + H) | fit | inside | |\n|---|---|---|---|---|---|---|---|---|---|---|---|";
    let measured: Vec<&FittedLimit> =
        limits.iter().filter(|l| l.convention == Convention::Measured).collect();
    let range = |l: &FittedLimit| format!("{:.4} [{:.4}, {:.4}]", l.law.alpha, l.interval[0], l.interval[1]);
    let rows = measured.iter().filter(|l| l.variant == super::laws::FREE).map(|l| {
        let other = |variant: &str| {
            let same = |other: &&&FittedLimit| {
                other.model == l.model
                    && other.variant == variant
                    && other.fractal_dimension.total_cmp(&l.fractal_dimension).is_eq()
            };
            measured.iter().find(same).map_or_else(String::new, |l| range(l))
        };
        let d = l.fractal_dimension;
        [
            surfaces_or_lines(l.model).to_owned(),
            format!("{d:?}"),
            format!("{:.1e}", l.forces.start),
            range(l),
            format!("{:.2} [{:.2}, {:.2}]", l.law.omega, l.omega[0], l.omega[1]),
            other(super::laws::HELD),
            other(super::laws::SHORT),
            format!("{:.3}", eq6(d)),
            format!("{:.3}", eq24(d)),
            format!("{:.2}", l.goodness),
            l.conclusion().to_owned(),
            if l.was_planned() { "planned" } else { "exploration" }.to_owned(),
        ]
    });
    markdown_table(head, rows)
}

/// The resolved exponents, decade by decade.
fn decades(laws: &[LawRow]) -> String {
    let head = "| | D_f | F_bar | alpha, 95 % | of it the grid | 0.266 D_f | 1/(1 + H) | inside |\n|---|---|---|---|---|---|---|---|";
    let rows = laws.iter().filter(|r| r.resolved && r.convention == Convention::Measured).map(|r| {
        let d = r.fractal_dimension;
        [
            surfaces_or_lines(r.model).to_owned(),
            format!("{d:?}"),
            r.window.to_owned(),
            with_error(r.alpha.value(), r.alpha.half_width()),
            format!("{:.4}", r.alpha.grid),
            format!("{:.3}", eq6(d)),
            format!("{:.3}", eq24(d)),
            r.inside().to_owned(),
        ]
    });
    markdown_table(head, rows)
}

/// Line over surface.
fn over(factors: &[ModelRatio]) -> String {
    let head = "| D_f | F_bar | k_1D/k_3D, measured rms | one spectrum | slope of its logarithm over ln F, measured rms |\n|---|---|---|---|---|";
    let text = |f: &ModelRatio| {
        let (value, half) = raised(&f.logarithm);
        with_error(value, half)
    };
    let measured = factors.iter().filter(|f| f.resolved && f.convention == Convention::Measured);
    let rows = measured.map(|f| {
        let same = |other: &&ModelRatio| {
            other.convention == Convention::FixedSpectrum
                && other.resolved
                && other.window == f.window
                && other.fractal_dimension.total_cmp(&f.fractal_dimension).is_eq()
        };
        [
            format!("{:?}", f.fractal_dimension),
            f.window.to_owned(),
            text(f),
            factors.iter().find(same).map_or_else(String::new, text),
            with_error(f.slope.value(), f.slope.half_width()),
        ]
    });
    markdown_table(head, rows)
}

/// The tests of the hypotheses.
fn hypotheses(tests: &[FamilyTest]) -> String {
    let head = "| | | D_f | F_bar | hypothesis | found | together with its family | p of this test alone | |\n|---|---|---|---|---|---|---|---|---|";
    let rows = tests.iter().map(|t| {
        [
            t.family.to_owned(),
            if t.family == "A" { "line over surface" } else { surfaces_or_lines(t.model) }.to_owned(),
            format!("{:?}", t.fractal_dimension),
            t.window.to_owned(),
            format!("{:.4}", t.expected),
            t.value.map_or_else(String::new, |v| format!("{v:.4}")),
            t.interval.map_or_else(String::new, |[low, high]| format!("[{low:.4}, {high:.4}]")),
            t.chance.map_or_else(String::new, chance),
            t.verdict().to_owned(),
        ]
    });
    markdown_table(head, rows)
}

/// What follows from the curves of a study.
pub struct StudyFindings<'a> {
    /// Exponents towards zero force.
    pub limits: &'a [FittedLimit],
    /// Exponents decade by decade.
    pub laws: &'a [LawRow],
    /// Line over surface.
    pub factors: &'a [ModelRatio],
    /// The tests of the hypotheses.
    pub tests: &'a [FamilyTest],
}

/// All tables of a page: the numbers of surfaces, exponents towards zero force and decade by decade, the
/// factor between line and surface, and the tests of the hypotheses.
pub fn report(command: &str, rungs: &[Rungs], findings: &StudyFindings<'_>) -> String {
    format!(
        "`{command}`\n\n{}\nAlpha towards zero force, F_bar by the measured rms height of each grid. The column \"fit\" is the share of curves that scatter about the fitted law as the surfaces do and have a larger misfit:\n\n{}\nDecade by decade, where all of it is resolved:\n\n{}\nLine over surface, where both are resolved:\n\n{}\nHypotheses, A to D:\n\n{}",
        solved(rungs),
        towards_zero(findings.limits),
        decades(findings.laws),
        over(findings.factors),
        hypotheses(findings.tests)
    )
}
