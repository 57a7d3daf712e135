//! What the curves say about the paper's belief.

use super::study::{CaseCurve, CasePoint, PairRow, Solves, SurfaceCase, TwoCases};
use crate::claim::{Claim, Estimate, Statement, plain};
use analysis::{Bootstrap, Curves, FitWindow, Multilevel, fit_power_law, slope_weights};
use contact_model::Boundary;
use evaluation::{FLOOR_CELLS, list};
use runs::{Error, Result};

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

const FRACTAL: Statement = Statement {
    quotation: "Whenever the surfaces are truly fractal with no cut-off wavelength, a power law applies",
    place: "Sec. II, Eq. 6",
    reading: "the exponent below F_bar = 0.086 is below 0.9: no proportionality",
};

const PROPORTION: Statement = Statement {
    quotation: "the proportionality found by Persson appears only in the first case",
    place: "Sec. II",
    reading: "the exponent of the periodic surface with a roll-off, where 1 to 20 % of the square touch, is 1 to 0.1",
};

const ONLY: Statement = Statement {
    reading: "only: in the three other cases the exponent in the same range of area is 1 not even to 0.1",
    ..PROPORTION
};

const EXACT: Statement = Statement {
    quotation: "this proportionality must be exact",
    place: "Sec. II, on Persson's theory",
    reading: "the same exponent is 1 to 0.02",
};

const UNITY: Statement = Statement {
    quotation: "k ≈ ξF/h, where h is the rms roughness and ξ is a constant of the order of unity",
    place: "Sec. II",
    reading: "k h/F of the periodic surface with a roll-off, in the same window, is between a third and three",
};

const LINEAR: Statement = Statement {
    quotation: "The linear dependence of the contact area on the normal force predicted by Persson's theory was found",
    place: "Sec. IV",
    reading: "the exponent of A over F, where at most a tenth of the square touches, is 1 to 0.05",
};

const KAPPA: Statement = Statement {
    quotation: "A = kappa F_N/(E* grad h), where kappa is near 2",
    place: "Sec. I",
    reading: "between the limits sqrt(8/pi) = 1.6 and sqrt(2 pi) = 2.5 of theory",
};

/// What Sec. II expects: an exponent below 1 without a roll-off; 1, and a factor of the order of unity, for the periodic surface with
/// one, and only for that.
pub(super) fn claims(study: &TwoCases, curve: &CaseCurve, means: &Curves) -> Vec<Claim> {
    let case = curve.case;
    let named = |what: &str| format!("{what}, {}", case.label());
    let exponent = |window: &FitWindow, statement: Statement, allowed: &dyn Fn(f64) -> [f64; 2]| {
        let name = named("exponent of k over F");
        let fit = fit_power_law(means, window, &Bootstrap::default());
        let paper = allowed(fit.as_ref().map_or(0.0, |law| law.alpha));
        match fit.map(|law| Estimate::normal(law.alpha, law.alpha_se)) {
            Ok(Some(alpha)) => {
                let remark =
                    format!("{window}; {} cells a side; the interval holds the scatter", study.cells);
                Claim::judge(name, statement, paper, alpha, remark)
            }
            Ok(None) => Claim::unresolved(name, statement, paper, "one surface has no scatter"),
            Err(reason) => Claim::unresolved(name, statement, paper, reason.to_string()),
        }
    };
    let window = loads_between(curve);
    // Below or above the proportionality.
    let apart = |alpha: f64| if alpha < 1.0 { [0.0, 0.9] } else { [1.1, f64::INFINITY] };
    let mut all = Vec::new();
    if case.roll_off.is_none() {
        let mut claim = exponent(&FitWindow::PAPER, FRACTAL, &|_| [0.0, 0.9]);
        claim.quantity += ", below F_bar = 0.086";
        all.push(claim);
    }
    if case.roll_off.is_none() || case.boundary != Boundary::Periodic {
        all.push(exponent(&window, ONLY, &apart));
        return all;
    }
    let inside = window.min_force_bar..=window.max_force_bar;
    // k h/F: k_bar counts 1.1419 E* L, F_bar counts E* h L.
    let factors = curve.points.iter().filter(|p| inside.contains(&p.force_bar));
    let factors: Vec<f64> =
        factors.map(|p| p.stiffness_bar * contact_model::PAPER_STIFFNESS_FACTOR / p.force_bar).collect();
    let (low, high) =
        factors.iter().fold((f64::INFINITY, 0.0), |(low, high), &x| (f64::min(low, x), f64::max(high, x)));
    let name = named("k h/F");
    let unity = if factors.is_empty() {
        Claim::unresolved(name, UNITY, [1.0 / 3.0, 3.0], "no load in the window")
    } else {
        let found = Estimate { value: 0.5 * (low + high), half_width: 0.5 * (high - low) };
        Claim::judge(
            name,
            UNITY,
            [1.0 / 3.0, 3.0],
            found,
            format!("the interval is the range over the loads; {window}"),
        )
    };
    let near_one = exponent(&window, PROPORTION, &|_| [0.9, 1.1]);
    all.extend([near_one, exponent(&window, EXACT, &|_| [0.98, 1.02]), unity]);
    all
}

/// Cells in contact from which an area counts as resolved, and the largest share of the square.
const RESOLVED: (usize, f64) = (100, 0.1);

/// Area over force: its exponent, and kappa.
///
/// Their intervals hold the scatter of the surfaces and, in quadrature, the difference from cells twice as large: an area counted in cells
/// is too large by a part that falls with the first order, so that as much is left.
pub(super) fn areas(study: &TwoCases, curve: &CaseCurve, [surfaces, coarser]: [&[Solves]; 2]) -> Vec<Claim> {
    let inside = |p: &CasePoint| {
        p.left_out == 0
            && p.min_contact_cells.is_some_and(|n| n >= RESOLVED.0)
            && p.area.is_some_and(|a| a <= RESOLVED.1)
    };
    // Every load of the window has all surfaces, so that points and loads of the solves are in step.
    let first = curve.points.iter().position(inside);
    let count = first.map_or(0, |first| curve.points[first..].iter().take_while(|p| inside(p)).count());
    let names = ["exponent of A over F", "kappa"].map(|what| format!("{what}, {}", curve.case.label()));
    let papers = [(LINEAR, [0.95, 1.05]), (KAPPA, [1.6, 2.51])];
    let found = first.filter(|_| count >= 3).and_then(|first| {
        let points = &curve.points[first..first + count];
        let of = |surfaces: &[Solves]| {
            let area = |s: &Solves, j: usize| s.get(j)?.sample().map(|s| s.1);
            let each = surfaces.iter().map(|s| (first..first + count).map(|j| area(s, j)).collect());
            Multilevel::new(vec![each.collect::<Option<Vec<Vec<f64>>>>()?]).ok()
        };
        let areas = of(surfaces)?;
        let (means, coarse) = (areas.means(1), of(coarser)?.means(1));
        let weights = slope_weights(&points.iter().map(|p| p.force_bar.ln()).collect::<Vec<_>>())?;
        let exponent = |means: &[f64]| -> f64 { weights.iter().zip(means).map(|(w, a)| w * a.ln()).sum() };
        let gradient: Vec<f64> = weights.iter().zip(&means).map(|(w, a)| w / a).collect();
        // kappa is the area in other units: its mean over the loads.
        let units: Option<Vec<f64>> =
            points.iter().zip(&means).map(|(p, a)| Some(p.kappa? / a / count as f64)).collect();
        let units = units?;
        let kappa = |means: &[f64]| -> f64 { units.iter().zip(means).map(|(u, a)| u * a).sum() };
        let estimate = |[value, coarse]: [f64; 2], gradient: &[f64]| {
            let found = areas.propagated(value, gradient);
            (Estimate { value, half_width: found.half_width().hypot(value - coarse) }, coarse)
        };
        let both = |of: &dyn Fn(&[f64]) -> f64| [of(&means), of(&coarse)];
        let loads = [points[0].force_bar, points[count - 1].force_bar];
        Some(([estimate(both(&exponent), &gradient), estimate(both(&kappa), &units)], loads))
    });
    let mut claims = Vec::new();
    for (i, (name, (statement, paper))) in names.into_iter().zip(papers).enumerate() {
        claims.push(if let Some((found, [low, high])) = &found {
                let remark = format!(
                    "F_bar {low:.1e} to {high:.1e}, at most {} of the square; shortest waves of {} cells; the interval holds the scatter and the difference from cells twice as large ({:.3})",
                    RESOLVED.1, study.cells_per_wave, found[i].1
                );
                Claim::judge(name, statement, paper, found[i].0, remark)
            } else {
                let reason = format!("fewer than 3 loads with {} cells in contact and at most {} of the square", RESOLVED.0, RESOLVED.1);
                Claim::unresolved(name, statement, paper, reason)
        });
    }
    claims
}

/// Periodic over free stiffness, surface by surface, for both spectra.
pub(super) fn pairs(study: &TwoCases, solved: &[Vec<Solves>]) -> Result<Vec<PairRow>> {
    let mut rows = Vec::new();
    let cases = study.cases();
    for (free, case) in cases.iter().enumerate().filter(|(_, c)| c.boundary == Boundary::Free) {
        let other = SurfaceCase { boundary: Boundary::Periodic, ..*case };
        let Some(periodic) = cases.iter().position(|c| *c == other) else { continue };
        for (j, &force_bar) in study.forces.values().iter().enumerate() {
            let stiffness = |solves: &Solves| solves[j].sample().map(|s| s.0.stiffness_bar);
            let pairs: Vec<Vec<f64>> = (solved[free].iter().zip(&solved[periodic]))
                .filter_map(|(a, b)| Some(vec![stiffness(a)?, stiffness(b)?]))
                .collect();
            if pairs.len() < 2 {
                continue;
            }
            let surfaces = pairs.len();
            let means = Multilevel::new(vec![pairs]).map_err(Error::model("pairs of surfaces"))?;
            let [a, b] = [means.means(1)[0], means.means(1)[1]];
            let half_width = means.propagated(b / a, &[-b / (a * a), 1.0 / a]).half_width();
            rows.push(PairRow {
                fractal_dimension: case.fractal_dimension,
                roll_off: case.roll_off,
                force_bar,
                ratio: Estimate { value: b / a, half_width },
                surfaces,
            });
        }
    }
    Ok(rows)
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

/// What was found, in words and short tables; `pictures` are the names of what is drawn.
pub(super) fn summary(
    study: &TwoCases,
    pictures: &[String],
    curves: &[CaseCurve],
    pairs: &[PairRow],
    claims: &[Claim],
) -> String {
    let mut text = format!(
        "# Two cases\n\nSec. II of the paper tells two problems apart. A surface that is fractal up to the size of the system has physical \
         edges, an approach, and k ~ F^alpha; a surface whose spectrum ends at a longest wave is stood for by a periodic patch, has a mean gap, \
         and k ~ F. The authors believe that the proportionality appears only in the second problem. Here both are solved exactly, and the two mixed \
         problems with them, so that boundary and spectrum can be told apart (D_f = {}, {} cells a side, {} surfaces, roll-off at {} waves a \
         side).\n\n`{}`\n\n",
        list(&study.fractal_dimensions),
        study.cells,
        study.surfaces,
        list(&study.roll_offs),
        study.command()
    );
    for picture in pictures {
        text.push_str(&format!("![k and k h/F over F]({picture}.svg)\n\n"));
    }
    text.push_str(&format!(
        "| case | decades of F with a local slope within {PROPORTIONAL:?} of 1 |\n| --- | ---: |\n"
    ));
    for curve in curves.iter().filter(|c| c.model == "bem3d") {
        text.push_str(&format!("| {} | {:.2} |\n", curve.case.label(), proportional(curve)));
    }
    let [low, high] = AREAS;
    text.push_str(&format!(
        "\nLargest relative difference of k from boundary elements where the contact covers {low:?} to {high:?} of the square:\n\n\
         | case | theory | difference |\n| --- | --- | ---: |\n"
    ));
    for theory in curves.iter().filter(|c| c.model != "bem3d") {
        let solved = curves.iter().find(|c| c.model == "bem3d" && c.case == theory.case);
        if let Some(difference) = solved.and_then(|solved| difference(theory, solved)) {
            text.push_str(&format!("| {} | {} | {difference:.3} |\n", theory.case.label(), theory.model));
        }
    }
    text.push_str("\nPeriodic over free stiffness of the same surfaces, with 95 % half-width:\n\n| D_f | roll-off | F_bar | ratio |\n| --- | --- | ---: | ---: |\n");
    for p in pairs.iter().filter(|p| p.force_bar <= 1.0) {
        let Estimate { value, half_width } = p.ratio;
        let spectrum = p.roll_off.map_or_else(|| "none".to_owned(), |waves| waves.to_string());
        text.push_str(&format!(
            "| {:?} | {spectrum} | {:.3e} | {value:.3} +- {half_width:.3} |\n",
            p.fractal_dimension, p.force_bar
        ));
    }
    text.push_str("\n```\n");
    text.push_str(&plain(claims));
    text.push_str("```\n");
    text
}
