//! zeta and the crossing point: Eq. 11, Fig. 7.

use super::{alpha_allowed, label, twice};
use crate::claim::Claim;
use crate::laws::laws;
use crate::measured::Measured;
use analysis::{Bootstrap, Window, crossing as cross, fit};
use analytic::{F_BAR_UL, K_BAR_UL};

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
            match &law.fit {
                Ok(l) => {
                    let allowed = paper * ln_zeta_allowed(d) + twice(l.zeta_se);
                    let why = format!(
                        "allowed: that of alpha ({}) times ln(1/0.086), + 0.005 in 0.18, + 2 s.e.; F_bar counts the measured rms height \
                         (the continuum one would lower k_bar by up to 19 %)",
                        alpha_allowed(d)
                    );
                    Claim::compare(claim, paper, l.zeta, l.zeta_se, allowed, why)
                }
                Err(reason) => Claim::not_tested(claim, paper, reason.to_string()),
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
            let (a3, b1) = (a.fit.as_ref().ok()?, b.fit.as_ref().ok()?);
            let ratio = b1.zeta / a3.zeta;
            let relative = a3.zeta_se.zip(b1.zeta_se).map(|(x, y)| (x / a3.zeta).hypot(y / b1.zeta));
            Some((a.fractal_dimension, ratio, relative.map(|r| ratio * r)))
        })
        .collect();
    let farthest = pairs.iter().max_by(|a, b| a.1.ln().abs().total_cmp(&b.1.ln().abs()));
    let names =
        ["zeta 1D over 3D, farthest from 1: same order", "zeta 1D over 3D, farthest from 1: not equal"];
    let Some(&(d, ratio, error)) = farthest else {
        return names.map(|n| Claim::not_tested(n, "about 1", "no fractal dimension has both fits")).into();
    };
    let order = ratio.log10().abs() < 0.5;
    let different = error.map(|e| (ratio - 1.0).abs() > 2.0 * e);
    let mut claims = vec![Claim::judge(
        names[0],
        "1/3 to 3",
        ratio,
        error,
        order,
        format!("at D_f = {d:?}; an order of magnitude is a factor sqrt(10) either way"),
    )];
    claims.push(match different {
        Some(holds) => Claim::judge(
            names[1],
            "not 1",
            ratio,
            error,
            holds,
            format!("at D_f = {d:?}; different means by more than 2 s.e."),
        ),
        None => Claim::not_tested(names[1], "not 1", "one surface has no standard error"),
    });
    claims
}

/// Where the fitted laws of all fractal dimensions meet.
pub(super) fn crossing(solid: &Measured) -> Vec<Claim> {
    let names = ["crossing of the 3D laws: F_bar", "crossing of the 3D laws: k_bar"];
    let window = Window::default();
    let bootstrap = Bootstrap { resamples: 1, ..Bootstrap::default() };
    let law_of = |c: &analysis::Curves| fit(c, &window, &bootstrap).ok().map(|l| (l.alpha, l.zeta));
    let found: Vec<(f64, f64)> = solid.series.iter().filter_map(|s| law_of(&s.curves)).collect();
    let Some(here) = cross(&found) else {
        let reason = "fewer than two fractal dimensions have a fit of another exponent";
        return vec![
            Claim::not_tested(names[0], F_BAR_UL, reason),
            Claim::not_tested(names[1], K_BAR_UL, reason),
        ];
    };
    // All fractal dimensions are resampled with the same surfaces: they share phases.
    let surfaces = solid.series.first().map_or(0, |s| s.units.len());
    let error = |pick: fn(&analysis::Crossing) -> f64| {
        Bootstrap::default().standard_error(surfaces, |draw| {
            let drawn: Option<Vec<(f64, f64)>> =
                solid.series.iter().map(|s| law_of(&s.curves.resampled(draw))).collect();
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
        Claim::compare(
            names[0],
            F_BAR_UL,
            here.force_bar,
            force_se,
            0.38 * F_BAR_UL + twice(force_se),
            format!("{why}; allowed: 38 % = what +-0.03 in each alpha moves it, + 2 s.e."),
        ),
        Claim::compare(
            names[1],
            K_BAR_UL,
            here.stiffness_bar,
            stiffness_se,
            0.21 * K_BAR_UL + twice(stiffness_se),
            format!("{why}; allowed: 21 % = what +-0.03 in each alpha moves it, + 2 s.e."),
        ),
    ]
}
