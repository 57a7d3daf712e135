//! zeta and the crossing point: Eq. 11, Fig. 7.

use super::common::{alpha_allowed, label, usable};
use analysis::{Bootstrap, FitWindow, FittedPowerLaw, crossing as cross, fit_power_law};
use analytic::{F_BAR_UL, K_BAR_UL};
use evaluation::{Claim, Measured, Series, laws};

/// 0.18 is printed with two digits: +-0.005 is 2.8 %.
const PRINTED: f64 = 0.028;

/// Uncertainty of ln zeta: that of alpha turns the line about the crossing, ln(1/0.086) = 2.45 away from F_bar = 1.
fn ln_zeta_allowed(d: f64) -> f64 {
    alpha_allowed(d) * (1.0 / F_BAR_UL).ln() + PRINTED
}

pub(super) fn against_the_fit(measured: &Measured) -> Vec<Claim> {
    laws(measured)
        .iter()
        .map(|law| {
            let d = law.fractal_dimension;
            let claim = format!("zeta {} at D_f = {d:?}, Eq. 11", label(measured));
            let paper = analytic::zeta_fit(d);
            match usable(law) {
                Ok(l) => {
                    let why = format!(
                        "that of alpha ({}) times ln(1/0.086), and 0.005 in 0.18; F_bar counts the measured rms height (the continuum one \
                         would lower k_bar by up to 19 %)",
                        alpha_allowed(d)
                    );
                    Claim::within(claim, paper, l.zeta, l.zeta_se, paper * ln_zeta_allowed(d), why)
                }
                Err(reason) => Claim::not_tested(claim, paper, reason),
            }
        })
        .collect()
}

/// "The same order of magnitude in both cases, but does not coincide exactly."
pub(super) fn line_against_solid(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let pairs: Vec<(f64, f64, Option<f64>)> = laws(solid)
        .iter()
        .zip(&laws(line))
        .filter_map(|(a, b)| {
            let (a3, b1) = (usable(a).ok()?, usable(b).ok()?);
            let ratio = b1.zeta / a3.zeta;
            let relative = a3.zeta_se.zip(b1.zeta_se).map(|(x, y)| (x / a3.zeta).hypot(y / b1.zeta));
            Some((a.fractal_dimension, ratio, relative.map(|r| ratio * r)))
        })
        .collect();
    let distance = |p: &(f64, f64, Option<f64>)| p.1.ln().abs();
    let sure = |p: &(f64, f64, Option<f64>)| p.2.map(|e| (p.1 - 1.0).abs() / e);
    let names = [
        "zeta 1D over 3D: same order (the farthest from 1)",
        "zeta 1D over 3D: not equal (the surest difference)",
    ];
    let Some(&(d, ratio, error)) = pairs.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))) else {
        let reason = "no fractal dimension has two fits over a decade or more";
        return vec![
            Claim::not_tested(names[0], "1/3 to 3", reason),
            Claim::not_tested(names[1], "not 1", reason),
        ];
    };
    let why = format!("at D_f = {d:?}; an order of magnitude is a factor sqrt(10) either way");
    let order = Claim::judge(names[0], "1/3 to 3", ratio, error, ratio.log10().abs() < 0.5, why);
    let surest = (pairs.iter().filter_map(|p| Some((p, sure(p)?)))).max_by(|a, b| a.1.total_cmp(&b.1));
    let unequal = match surest {
        Some((&(d, ratio, error), times)) if times > 2.0 => {
            let why = format!("at D_f = {d:?}, {times:.1} s.e. from 1; more than 2 counts as different");
            Claim::judge(names[1], "not 1", ratio, error, true, why)
        }
        Some((&(d, ratio, _), times)) => {
            let reason = format!(
                "{ratio:.3} at D_f = {d:?} is {times:.1} s.e. from 1: more surfaces are needed to tell them apart"
            );
            Claim::not_tested(names[1], "not 1", reason)
        }
        None => Claim::not_tested(names[1], "not 1", "one surface has no standard error"),
    };
    vec![order, unequal]
}

/// Where the fitted laws of all fractal dimensions meet.
pub(super) fn crossing(solid: &Measured) -> Vec<Claim> {
    let names = ["crossing of the 3D laws: F_bar", "crossing of the 3D laws: k_bar"];
    let fitted = laws(solid);
    let used: Vec<(&Series, &FittedPowerLaw)> =
        solid.series.iter().zip(&fitted).filter_map(|(s, l)| Some((s, usable(l).ok()?))).collect();
    let found: Vec<(f64, f64)> = used.iter().map(|(_, l)| (l.alpha, l.zeta)).collect();
    let Some(here) = cross(&found).filter(|_| found.len() >= 3) else {
        let reason = format!(
            "{} fractal dimensions have a fit over a decade or more: three of different exponents are needed",
            found.len()
        );
        return vec![
            Claim::not_tested(names[0], F_BAR_UL, reason.clone()),
            Claim::not_tested(names[1], K_BAR_UL, reason),
        ];
    };
    // All fractal dimensions are resampled with the same surfaces: they share phases. The forces of each fit stay.
    let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
    let redrawn = |s: &Series, l: &FittedPowerLaw, draw: &[usize]| {
        let window = FitWindow {
            min_force_bar: l.force_bar_min,
            max_force_bar: l.force_bar_max,
            min_contact_cells: 0,
        };
        fit_power_law(&s.curves.resampled(draw), &window, &once).ok().map(|l| (l.alpha, l.zeta))
    };
    let surfaces = solid.series.first().map_or(0, |s| s.units.len());
    let error = |pick: fn(&analysis::Crossing) -> f64| {
        Bootstrap::default().half_width(surfaces, |draw| {
            let drawn: Option<Vec<(f64, f64)>> = used.iter().map(|(s, l)| redrawn(s, l, draw)).collect();
            cross(&drawn?).map(|c| pick(&c))
        })
    };
    // +-0.03 in each of six alpha, spread over 0.532..0.798, moves the intersection by a factor exp(0.32) in F_bar and, along the
    // mean slope 0.66, exp(0.21) in k_bar.
    let (force_se, stiffness_se) = (error(|c| c.force_bar), error(|c| c.stiffness_bar));
    let why = format!(
        "intersection of {} fitted laws (least spread of ln k_bar: {:.3}); the lines cross at a small angle",
        found.len(),
        here.spread
    );
    vec![
        Claim::within(
            names[0],
            F_BAR_UL,
            here.force_bar,
            force_se,
            0.38 * F_BAR_UL,
            format!("{why}; 38 %: what +-0.03 in each alpha moves it"),
        ),
        Claim::within(
            names[1],
            K_BAR_UL,
            here.stiffness_bar,
            stiffness_se,
            0.21 * K_BAR_UL,
            format!("{why}; 21 %: what +-0.03 in each alpha moves it"),
        ),
    ]
}
