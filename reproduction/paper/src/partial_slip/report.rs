//! The results in short tables.

use super::means::{LoopRow, SlipRow, StiffnessRow};
use super::study::PartialSlipStudy;
use crate::claim::Estimate;
use crate::evaluation::markdown_table;

/// Shares of the sliding force in the table.
const SHOWN: [f64; 3] = [0.3, 0.6, 0.9];

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// A number with as many decimals as its interval has with two digits.
fn plain(of: Option<Estimate>) -> String {
    of.map_or_else(String::new, |Estimate { value, half_width }| format!("{value:.4} ± {half_width:.4}"))
}

fn percent(of: Option<Estimate>) -> String {
    of.map_or_else(String::new, |Estimate { value, half_width }| {
        format!("{:.2} ± {:.2}", 100.0 * value, 100.0 * half_width)
    })
}

pub(super) fn text(
    study: &PartialSlipStudy,
    stiffness: &[StiffnessRow],
    slips: &[SlipRow],
    loops: &[LoopRow],
) -> String {
    let ratio = |r: &StiffnessRow| {
        [
            r.case.boundary_name().to_owned(),
            format!("{:?}", r.case.fractal_dimension),
            format!("{}", r.force_bar),
            r.contact.map_or_else(String::new, |c| format!("{:.3}", c.value)),
            format!("{}", r.poisson),
            plain(r.ratio),
            plain(r.along_x),
            plain(r.along_y),
            plain(r.anisotropy),
        ]
    };
    let head = "| boundary | D_f | F_bar | contact | nu | ratio | along x | along y | anisotropy |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |";
    let ratios = markdown_table(head, stiffness.iter().filter(|r| r.poisson > 0.0).map(ratio));
    let miss = |r: &SlipRow| {
        let of_loop = |l: &&LoopRow| {
            l.case == r.case
                && same(l.force_bar, r.force_bar)
                && same(l.poisson, r.poisson)
                && same(l.amplitude, r.share)
        };
        let of_loop = loops.iter().find(of_loop);
        [
            format!("{:?}", r.case.fractal_dimension),
            format!("{}", r.force_bar),
            format!("{}", r.poisson),
            format!("{}", r.share),
            percent(r.displacement_miss),
            percent(r.stick_miss),
            percent(r.profile_stick_miss),
            percent(of_loop.and_then(|l| l.miss)),
            percent(r.traction_miss),
        ]
    };
    let shown = |r: &&SlipRow| r.poisson > 0.0 && SHOWN.iter().any(|share| same(*share, r.share));
    let head = "| D_f | F_bar | nu | Q/(mu F) | displacement | stick area | (c/a)^2 of `equivalent` | energy of a loop | tractions |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |";
    let misses = markdown_table(head, slips.iter().filter(shown).map(miss));
    format!(
        "`{}`\n\nTangential over normal stiffness of contacts that stick, over (2 - 2 nu)/(2 - nu); means over surfaces with 95 % intervals:\n\n{ratios}\nWhat Ciavarella and Jaeger's approximation misses, in per cent of the solution (tractions: rms, of mu times the mean pressure); of `equivalent` the area:\n\n{misses}",
        study.command()
    )
}
