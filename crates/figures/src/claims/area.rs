//! A = kappa F/(E* |grad h|).

use contact_model::SelfAffine;
use evaluation::{Claim, Estimate, FLOOR_CELLS, Measured, Series, Statement};

/// Proportionality is a statement about small areas.
const LARGEST_FRACTION: f64 = 0.1;

pub(crate) const LINEAR: Statement = Statement {
    quotation: "The linear dependence of the contact area on the normal force predicted by Persson's theory was found",
    place: "Sec. IV",
    reading: "the exponent of A over F, where at most a tenth of the square touches, is 1 to 0.05",
};

pub(crate) const KAPPA: Statement = Statement {
    quotation: "A = kappa F_N/(E* grad h), where kappa is near 2",
    place: "Sec. I",
    reading: "between the limits sqrt(8/pi) = 1.6 and sqrt(2 pi) = 2.5 of theory",
};

/// Why a grid with waves down to two cells does not decide.
const CELLS: &str = "waves down to two cells: cells touch whole and the area is too large, the more the fewer cells touch; the exponent rises \
                     with finer grids, kappa falls where waves are resolved (the study of the area)";

/// Loads at which all surfaces have at least [`FLOOR_CELLS`] cells and the mean fraction is small: (F_bar, A/A0).
fn window(series: &Series) -> Vec<(f64, f64)> {
    (series.points.iter().enumerate())
        .filter(|(_, p)| p.missing == 0 && p.min_contact_cells.is_some_and(|c| c >= FLOOR_CELLS))
        .filter_map(|(j, p)| Some((p.force_bar, series.contact_fraction(j)?)))
        .filter(|p| p.1 <= LARGEST_FRACTION)
        .collect()
}

pub(super) fn proportionality(measured: &Measured) -> Vec<Claim> {
    let mut claims = Vec::new();
    for series in &measured.series {
        let d = series.fractal_dimension;
        let points = window(series);
        let logs: Vec<(f64, f64)> = points.iter().map(|p| (p.0.ln(), p.1.ln())).collect();
        let exponent = analysis::least_squares(&logs).filter(|_| points.len() >= 3).map(|line| line.0);
        let found = [exponent, kappa(d, measured.discretisation.size(), &points)];
        let names = [format!("exponent of A over F, D_f = {d:?}"), format!("kappa, D_f = {d:?}")];
        let papers = [([0.95, 1.05], LINEAR), ([1.6, 2.51], KAPPA)];
        for ((name, found), (paper, statement)) in names.into_iter().zip(found).zip(papers) {
            claims.push(if let Some(found) = found {
                // What the cells leave of an area with waves down to two cells cannot be told from one grid.
                let claim = Claim::judge(name, statement, paper, Estimate::exact(found), CELLS);
                Claim { verdict: evaluation::Verdict::Unresolved, ..claim }
            } else {
                    let reason = format!("fewer than 3 loads with {FLOOR_CELLS} contact cells everywhere and A/A_0 <= {LARGEST_FRACTION}");
                    Claim::unresolved(name, statement, paper, reason)
            });
        }
    }
    claims
}

/// Mean kappa over the loads, with the slope of this grid's spectrum.
fn kappa(d: f64, cells: usize, points: &[(f64, f64)]) -> Option<f64> {
    let surface = SelfAffine::new(d, 1.0, 1.0).ok()?;
    let slope = surface_gen::MapGenerator::new(&surface, cells).ok()?.rms_slope();
    let each: Vec<f64> = points
        .iter()
        .map(|&(force, area)| analysis::kappa(area, force, 1.0, slope))
        .collect::<Result<_, _>>()
        .ok()?;
    (each.len() >= 3).then(|| analysis::sum(each.iter().copied()) / each.len() as f64)
}
