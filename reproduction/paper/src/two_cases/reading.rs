//! Compares the curves with the expectations of the paper.

use super::study::{CaseCurve, CasePoint, PairRow, Solves, SurfaceCase, TwoCases};
use crate::claim::{Claim, Estimate, plain};
use crate::claims::{self, CaseData, Cases, ClaimEntry, ClaimRow, ClaimedNumber, Data};
use crate::evaluation::{FLOOR_CELLS, list, markdown_table};
use analysis::{Bootstrap, Curves, FitWindow, Multilevel, fit_power_law, slope_weights};
use contact_model::Boundary;
use runs::{Error, Result};

/// Shares of the square in contact between which the theories of random surfaces are compared: many summits,
/// far from full contact.
const AREAS: [f64; 2] = [0.01, 0.2];

/// Largest difference of a slope from 1 that still counts as proportionality.
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

/// A case as it was solved: its means, its surfaces, and those with cells twice as large.
#[derive(Clone, Copy)]
pub(super) struct ReadCase<'a> {
    pub(super) study: &'a TwoCases,
    pub(super) curve: &'a CaseCurve,
    pub(super) means: &'a Curves,
    pub(super) surfaces: &'a [Solves],
    pub(super) coarser: &'a [Solves],
}

/// Judges the expectations of Sec. II: an exponent below 1 without a roll-off; 1, and a factor of the order
/// of unity, for the periodic surface with one, and only for that; and the statements of Secs. I and IV about
/// the area.
///
/// # Errors
/// As [`claims::entries`].
pub(super) fn judged(solved: ReadCase<'_>) -> Result<Vec<Claim>> {
    let case = solved.curve.case;
    let persson = case.roll_off.is_some() && case.boundary == Boundary::Periodic;
    let speaks_of_case = |entry: &&'static ClaimEntry| match entry.cases {
        None => true,
        Some(Cases::Fractal) => case.roll_off.is_none(),
        Some(Cases::Persson) => persson,
        Some(Cases::BesidePersson) => !persson,
    };
    let between = loads_between(solved.curve);
    let [of_area, kappa] = areas(solved);
    let found = |data: CaseData| match data {
        CaseData::ExponentBelowTheUpperLimit => exponent(solved, &FitWindow::PAPER),
        CaseData::ExponentBetweenAreas => exponent(solved, &between),
        CaseData::ConstantBetweenAreas => constant(solved.curve, &between),
        CaseData::ExponentOfArea => of_area.clone(),
        CaseData::Kappa => kappa.clone(),
    };
    let claim = |entry: &'static ClaimEntry| match entry.data {
        Data::TwoCases(data) => Some(entry.judge(ClaimRow::of(case.label(), found(data)))),
        _ => None,
    };
    Ok(claims::entries("two_cases")?.iter().filter(speaks_of_case).filter_map(claim).collect())
}

/// The exponent of k over F in a window.
fn exponent(solved: ReadCase<'_>, window: &FitWindow) -> ClaimedNumber {
    let law =
        fit_power_law(solved.means, window, &Bootstrap::default()).map_err(|reason| reason.to_string())?;
    let alpha = Estimate::normal(law.alpha, law.alpha_se).ok_or("one surface has no scatter")?;
    let cells = solved.study.cells;
    Ok((alpha, format!("{window}; {cells} cells a side; the interval holds the scatter")))
}

/// k h/F in a window; k_bar is in units of 1.1419 E* L, F_bar in units of E* h L.
fn constant(curve: &CaseCurve, window: &FitWindow) -> ClaimedNumber {
    let inside = window.min_force_bar..=window.max_force_bar;
    let points = curve.points.iter().filter(|p| inside.contains(&p.force_bar));
    let all = points.map(|p| p.stiffness_bar * contact_model::PAPER_STIFFNESS_FACTOR / p.force_bar);
    let (low, high) = plots::extent(all).ok_or("no load in the window")?;
    let range = Estimate { value: 0.5 * (low + high), half_width: 0.5 * (high - low) };
    Ok((range, format!("the interval is the range over the loads; {window}")))
}

/// Number of cells in contact from which on an area counts as resolved, and the shares of the square in contact:
/// below the smaller one a patch has so few cells that two grids do not tell the area of small cells.
const RESOLVED: (usize, [f64; 2]) = (100, [0.005, 0.1]);

/// Share of the difference from cells twice as large that the extrapolated area leaves: a cell in contact counts
/// whole, so that the error of the counted area is of first order in the side of a cell, and `2 A(a) - A(2a)`
/// is free of it. With 8 cells in the shortest wave the extrapolation left at most this share on surfaces whose
/// area was known from 32 cells a wave (`tests/tests/grid_error.rs`).
const LEFT_BY_EXTRAPOLATION: f64 = 0.5;

/// Area over force: its exponent, and kappa, of areas that are extrapolated to small cells surface by surface.
///
/// Their intervals contain the scatter of the surfaces and, in quadrature, half of the difference from the
/// number of the counted areas.
fn areas(solved: ReadCase<'_>) -> [ClaimedNumber; 2] {
    let (cells, share) = RESOLVED;
    let inside = |p: &CasePoint| {
        p.left_out == 0
            && p.min_contact_cells.is_some_and(|n| n >= cells)
            && p.area.is_some_and(|a| (share[0]..=share[1]).contains(&a))
    };
    // Every load of the window has all surfaces, so that points and loads of the solves are in step.
    let points = &solved.curve.points;
    let first = points.iter().position(inside).unwrap_or(0);
    let count = points[first..].iter().take_while(|p| inside(p)).count();
    let points = &points[first..first + count];
    let found = || {
        let area = |s: &Solves, j: usize| s.get(j)?.sample().map(|s| s.1);
        let of = |area: &dyn Fn(&Solves, &Solves, usize) -> Option<f64>| {
            let pairs = solved.surfaces.iter().zip(solved.coarser);
            let each =
                pairs.map(|(s, coarser)| (first..first + count).map(|j| area(s, coarser, j)).collect());
            Multilevel::new(vec![each.collect::<Option<Vec<Vec<f64>>>>()?]).ok()
        };
        let counted = of(&|s, _, j| area(s, j)).filter(|_| count >= 3)?.means(1);
        let areas = of(&|s, coarser, j| Some(2.0 * area(s, j)? - area(coarser, j)?))?;
        let means = areas.means(1);
        if means.iter().any(|area| *area <= 0.0) {
            return None;
        }
        let weights = slope_weights(&points.iter().map(|p| p.force_bar.ln()).collect::<Vec<_>>())?;
        let exponent = |means: &[f64]| -> f64 { weights.iter().zip(means).map(|(w, a)| w * a.ln()).sum() };
        let gradient: Vec<f64> = weights.iter().zip(&means).map(|(w, a)| w / a).collect();
        // kappa is the area in other units: its mean over the loads.
        let units: Option<Vec<f64>> =
            points.iter().zip(&counted).map(|(p, a)| Some(p.kappa? / a / count as f64)).collect();
        let units = units?;
        let kappa = |means: &[f64]| -> f64 { units.iter().zip(means).map(|(u, a)| u * a).sum() };
        let (low, high) = (points[0].force_bar, points[count - 1].force_bar);
        let estimate = |of: &dyn Fn(&[f64]) -> f64, gradient: &[f64]| {
            let (value, counted) = (of(&means), of(&counted));
            let scatter = areas.propagated(value, gradient).half_width();
            let remark = format!(
                "F_bar {low:.1e} to {high:.1e}, {} to {} of the square; shortest waves of {} cells; of areas extrapolated from cells twice as large, 2 A(a) - A(2a); the interval holds the scatter and half of the difference from counted cells ({counted:.3})",
                share[0], share[1], solved.study.cells_per_wave
            );
            let left = LEFT_BY_EXTRAPOLATION * (value - counted);
            (Estimate { value, half_width: scatter }.widened(left), remark)
        };
        Some([estimate(&exponent, &gradient), estimate(&kappa, &units)])
    };
    let reason = format!(
        "fewer than 3 loads with {cells} cells and {} to {} of the square in contact",
        share[0], share[1]
    );
    let none = || [0, 1].map(|_| Err(reason.clone().into()));
    found().map_or_else(none, |both| both.map(Ok))
}

/// Ratio of periodic to free stiffness, surface by surface, for both spectra.
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

/// Decades of F over which the local slope stays within [`PROPORTIONAL`] of 1, the longest run of loads above
/// the floor.
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

/// The results in words and short tables; `pictures` are the names of the pictures.
pub(super) fn summary(
    study: &TwoCases,
    pictures: &[String],
    curves: &[CaseCurve],
    pairs: &[PairRow],
    claims: &[Claim],
) -> String {
    let solved = |c: &&CaseCurve| c.model == "bem3d";
    let pictures = pictures.iter().map(|picture| format!("![k and k h/F over F]({picture}.svg)\n\n"));
    let head =
        format!("| case | decades of F with a local slope within {PROPORTIONAL:?} of 1 |\n| --- | ---: |");
    let decades = |c: &CaseCurve| [c.case.label(), format!("{:.2}", proportional(c))];
    let difference = |theory: &CaseCurve| {
        let solved = curves.iter().filter(solved).find(|c| c.case == theory.case)?;
        let difference = difference(theory, solved)?;
        Some([theory.case.label(), theory.model.to_owned(), format!("{difference:.3}")])
    };
    let theories = curves.iter().filter(|c| !solved(c));
    let ratio = |p: &PairRow| {
        let Estimate { value, half_width } = p.ratio;
        let spectrum = p.roll_off.map_or_else(|| "none".to_owned(), |waves| waves.to_string());
        let ratio = format!("{value:.3} +- {half_width:.3}");
        [format!("{:?}", p.fractal_dimension), spectrum, format!("{:.3e}", p.force_bar), ratio]
    };
    let light = pairs.iter().filter(|p| p.force_bar <= 1.0);
    format!(
        include_str!("two-cases.md"),
        dimensions = list(&study.fractal_dimensions),
        cells = study.cells,
        surfaces = study.surfaces,
        roll_offs = list(&study.roll_offs),
        command = study.command(),
        pictures = pictures.collect::<String>(),
        decades = markdown_table(&head, curves.iter().filter(solved).map(decades)),
        low = AREAS[0],
        high = AREAS[1],
        differences = markdown_table(
            "| case | theory | difference |\n| --- | --- | ---: |",
            theories.filter_map(difference)
        ),
        ratios = markdown_table(
            "| D_f | roll-off | F_bar | ratio |\n| --- | --- | ---: | ---: |",
            light.map(ratio)
        ),
        claims = plain(claims)
    )
}
