//! A = kappa F/(E* |grad h|).

use contact_model::SelfAffine;
use evaluation::{Claim, FLOOR_CELLS, Measured, Series};

/// Proportionality is a statement about small areas.
const LARGEST_FRACTION: f64 = 0.1;

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
        let names = [
            format!("exponent of A over F, D_f = {d:?}"),
            format!("kappa of A = kappa F/(E* |grad h|), D_f = {d:?}"),
        ];
        if points.len() < 3 {
            let reason = format!(
                "{} loads with >= {FLOOR_CELLS} contact cells everywhere and A/A0 <= {LARGEST_FRACTION}: at least 3 are needed",
                points.len()
            );
            let [a, b] = names;
            claims.push(Claim::not_tested(a, 1.0, reason.clone()));
            claims.push(Claim::not_tested(b, 2.0, reason));
            continue;
        }
        let [exponent_name, kappa_name] = names;
        let logs: Vec<(f64, f64)> = points.iter().map(|p| (p.0.ln(), p.1.ln())).collect();
        match analysis::least_squares(&logs) {
            Some((exponent, _)) => claims.push(Claim::compare(
                exponent_name,
                1.0,
                exponent,
                None,
                0.05,
                format!(
                    "\"the linear dependence of the contact area\" (Sec. IV); {} loads with A/A0 <= {LARGEST_FRACTION}; allowed: 0.05, the \
                     usual deviation of a power law from a straight line over such a range",
                    points.len()
                ),
            )),
            None => claims.push(Claim::not_tested(exponent_name, 1.0, "the areas do not vary")),
        }
        match kappa(d, measured.discretisation.size(), &points) {
            Some((kappa, slope)) => claims.push(Claim::compare(
                kappa_name,
                2.0,
                kappa,
                None,
                0.5,
                format!(
                    "\"kappa is near 2\" (Sec. I); mean over the same loads, |grad h| L/h = {slope:.1} of this grid's spectrum; allowed: 0.5, \
                     between the limits sqrt(8/pi) = 1.6 and sqrt(2 pi) = 2.5 of theory; waves down to two cells make cells touch whole: kappa is too large"
                ),
            )),
            None => claims.push(Claim::not_tested(kappa_name, 2.0, "no slope of this spectrum")),
        }
    }
    claims
}

/// Mean kappa over the loads, and the slope used (in h/L).
fn kappa(d: f64, cells: usize, points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let surface = SelfAffine::new(d, 1.0, 1.0).ok()?;
    let slope = surface_gen::MapGenerator::new(&surface, cells).ok()?.rms_slope();
    let each: Vec<f64> = points
        .iter()
        .map(|&(force, area)| analysis::kappa(area, force, 1.0, slope))
        .collect::<Result<_, _>>()
        .ok()?;
    Some((analysis::sum(each.iter().copied()) / each.len() as f64, slope))
}
