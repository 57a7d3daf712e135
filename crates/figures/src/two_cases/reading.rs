//! What the curves say about the paper's belief.

use super::study::{CaseCurve, CasePoint, TwoCases};
use analysis::{Bootstrap, Curves, FitWindow, fit_power_law};
use contact_model::Boundary;
use evaluation::{Claim, FLOOR_CELLS, plain};

/// Shares of the square in contact between which the theories of random surfaces are compared: many summits, far from full contact.
const AREAS: [f64; 2] = [0.01, 0.2];

/// A slope counts as that of a proportionality when it differs from 1 by no more.
const PROPORTIONAL: f64 = 0.1;

/// `d ln k / d ln F` at each point from its neighbours.
pub(super) fn slopes(points: &[CasePoint]) -> Vec<Option<f64>> {
    (0..points.len())
        .map(|i| {
            let (a, b) = (points.get(i.checked_sub(1)?)?, points.get(i + 1)?);
            Some((b.stiffness_bar / a.stiffness_bar).ln() / (b.force_bar / a.force_bar).ln())
        })
        .collect()
}

/// The exponent that Sec. II expects: that of Eq. 6 without a roll-off, 1 for the periodic surface with one. It names none for a free
/// square with a roll-off.
pub(super) fn claim(study: &TwoCases, curve: &CaseCurve, means: &Curves) -> Option<Claim> {
    let case = curve.case;
    let (window, expected, tolerance, why) = if !case.rolls_off {
        let expected = analytic::exponent_fit(study.fractal_dimension);
        (
            FitWindow::PAPER,
            expected,
            0.05,
            "Sec. II: a power law wherever there is no cut-off; Eq. 6".to_owned(),
        )
    } else if case.boundary == Boundary::Periodic {
        let window = loads_between(curve);
        let [low, high] = AREAS;
        let why =
            format!("Persson's proportionality, where the contact covers {low:?} to {high:?} of the square");
        (window, 1.0, 0.1, why)
    } else {
        return None;
    };
    let name = format!("exponent of k over F, {}", case.name());
    Some(match fit_power_law(means, &window, &Bootstrap::default()) {
        Ok(law) => {
            Claim::within(name, expected, law.alpha, law.alpha_se, tolerance, format!("{why}; {window}"))
        }
        Err(reason) => Claim::not_tested(name, expected, reason.to_string()),
    })
}

/// The loads at which the mean area lies within [`AREAS`].
pub(super) fn loads_between(curve: &CaseCurve) -> FitWindow {
    let inside = || {
        let [low, high] = AREAS;
        curve
            .points
            .iter()
            .filter(move |p| p.area.is_some_and(|a| (low..=high).contains(&a)))
            .map(|p| p.force_bar)
    };
    FitWindow {
        min_force_bar: inside().fold(f64::INFINITY, f64::min),
        max_force_bar: inside().fold(0.0, f64::max),
        ..FitWindow::PAPER
    }
}

/// Decades of F over which the local slope stays within [`PROPORTIONAL`] of 1, the longest run of loads above the floor.
pub(super) fn proportional(curve: &CaseCurve) -> f64 {
    let near = |i: usize, slope: Option<f64>| {
        let above = curve.points[i].min_contact_cells.is_none_or(|n| n >= FLOOR_CELLS);
        above && slope.is_some_and(|s| (s - 1.0).abs() <= PROPORTIONAL)
    };
    let (mut best, mut first) = (0.0, None);
    for (i, slope) in slopes(&curve.points).into_iter().enumerate() {
        if near(i, slope) {
            let first = *first.get_or_insert(i);
            best = f64::max(best, (curve.points[i].force_bar / curve.points[first].force_bar).log10());
        } else {
            first = None;
        }
    }
    best
}

/// Largest relative difference of k from that of the boundary elements within [`AREAS`].
pub(super) fn difference(theory: &CaseCurve, solved: &CaseCurve) -> Option<f64> {
    let window = loads_between(solved);
    let range = window.min_force_bar..=window.max_force_bar;
    let at = |f: f64| theory.points.iter().find(|p| p.force_bar.total_cmp(&f).is_eq());
    let relative = solved
        .points
        .iter()
        .filter(|p| range.contains(&p.force_bar))
        .filter_map(|p| at(p.force_bar).map(|t| (t.stiffness_bar / p.stiffness_bar - 1.0).abs()));
    relative.max_by(f64::total_cmp)
}

pub(super) fn summary(study: &TwoCases, curves: &[CaseCurve], claims: &[Claim]) -> String {
    let mut text = format!(
        "# Two cases\n\nSec. II of the paper tells two problems apart. A surface that is fractal up to the size of the system has physical \
         edges, an approach, and k ~ F^alpha; a surface whose spectrum ends at a longest wave is stood for by a periodic patch, has a mean gap, \
         and k ~ F. The authors believe that the proportionality appears only in the second problem. Here both are solved exactly, and the two mixed \
         problems with them, so that boundary and spectrum can be told apart (D_f = {:?}, {} cells a side, {} surfaces, roll-off at {:?} waves a \
         side).\n\n`{}`\n\n![k over F](two-cases.svg)\n\n![k h/F over F](two-cases-ratio.svg)\n\n",
        study.fractal_dimension,
        study.cells,
        study.surfaces,
        study.roll_off,
        study.command()
    );
    text.push_str(&format!(
        "| case | decades of F with a local slope within {PROPORTIONAL:?} of 1 |\n| --- | ---: |\n"
    ));
    for curve in curves.iter().filter(|c| c.model == "bem3d") {
        text.push_str(&format!("| {} | {:.2} |\n", curve.case.name(), proportional(curve)));
    }
    let [low, high] = AREAS;
    text.push_str(&format!(
        "\nLargest relative difference of k from boundary elements where the contact covers {low:?} to {high:?} of the square:\n\n\
         | case | theory | difference |\n| --- | --- | ---: |\n"
    ));
    for theory in curves.iter().filter(|c| c.model != "bem3d") {
        let solved = curves.iter().find(|c| c.model == "bem3d" && c.case == theory.case);
        if let Some(difference) = solved.and_then(|solved| difference(theory, solved)) {
            text.push_str(&format!("| {} | {} | {difference:.3} |\n", theory.case.name(), theory.model));
        }
    }
    text.push_str("\n```\n");
    text.push_str(&plain(claims));
    text.push_str("```\n");
    text
}
