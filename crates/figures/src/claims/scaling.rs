//! Eq. 7 and the zoom argument of Eqs. 19 to 24, as small solves under scaling.

use bem3d::Bem3d;
use contact_model::{ContactModel, ContactState, Load, Scene, SelfAffine, Surface};
use evaluation::Claim;
use mdr1d::Mdr1d;
use runs::{Error, Result};

/// Tolerance of the solves here; differences may be ten times that.
const TOLERANCE: f64 = 1e-8;
const ALLOWED: f64 = 1e-7;

const SEED: u64 = 20_120_829;

fn models() -> [Box<dyn ContactModel>; 2] {
    [
        Box::new(Bem3d { cells: 65, tolerance: TOLERANCE, ..Bem3d::default() }),
        Box::new(Mdr1d { elements: 1 << 12 }),
    ]
}

fn solve(model: &dyn ContactModel, surface: Surface, modulus: f64, force: f64) -> Result<ContactState> {
    model
        .prepare(&Scene::new(surface, modulus), SEED)
        .and_then(|mut contact| contact.solve(Load::Force(force)))
        .map_err(Error::model(format!("a scaling test of {}", model.name())))
}

fn stiffness(state: &ContactState) -> f64 {
    // A model that gives none fails every comparison below.
    state.stiffness.unwrap_or(f64::INFINITY)
}

fn rough(height: f64, side: f64) -> Result<Surface> {
    SelfAffine::new(2.4, side, height).map(Surface::SelfAffine).map_err(Error::model("a scaled surface"))
}

pub(crate) fn scaling() -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for model in models() {
        claims.extend(vertical(&*model)?);
    }
    claims.extend(zoom()?);
    Ok(claims)
}

/// Heights, force and approach times c leave k alone; so delta = -alpha/2 (Eq. 7).
fn vertical(model: &dyn ContactModel) -> Result<Vec<Claim>> {
    let name = model.name();
    let (force, c, modulus) = (0.5, 3.0, 5.0);
    let base = solve(model, rough(1.0, 1.0)?, 1.0, force)?;
    let scaled = solve(model, rough(c, 1.0)?, 1.0, c * force)?;
    let harder = solve(model, rough(1.0, 1.0)?, modulus, modulus * force)?;
    let k = stiffness(&base);
    let approach = |s: &ContactState| s.approach.unwrap_or(f64::INFINITY);
    let off = [
        stiffness(&scaled) / k - 1.0,
        approach(&scaled) / (c * approach(&base)) - 1.0,
        stiffness(&harder) / (modulus * k) - 1.0,
        approach(&harder) / approach(&base) - 1.0,
    ];
    let worst = off.iter().map(|v| v.abs()).fold(0.0, f64::max);
    // Eq. 7, k ~ F^alpha (h^2)^delta, by two central differences of the same step.
    let step = 0.5_f64.exp();
    let log = |height: f64, force: f64| -> Result<f64> {
        Ok(stiffness(&solve(model, rough(height, 1.0)?, 1.0, force)?).ln())
    };
    let alpha = (log(1.0, force * step)? - log(1.0, force / step)?) / (2.0 * step.ln());
    let delta = (log(step, force)? - log(1.0 / step, force)?) / (4.0 * step.ln());
    Ok(vec![
        Claim::compare(
            format!("{name}: change of k when heights, F and d are scaled together"),
            0.0,
            worst,
            None,
            ALLOWED,
            format!(
                "the strict scaling before Eq. 8 (heights x {c}, E* x {modulus}; d normalisation as the heights); allowed: ten times the solver's tolerance"
            ),
        ),
        Claim::compare(
            format!("{name}: delta of Eq. 7"),
            -alpha / 2.0,
            delta,
            None,
            ALLOWED / step.ln(),
            format!(
                "delta = -alpha/2 with the local alpha = {alpha:.4} of this surface (D_f = 2.4, F_bar = {force}); allowed: ten times the solver's tolerance over the step"
            ),
        ),
    ])
}

/// A larger window around the same contact changes nothing (Eqs. 19 to 21); the exponent of a body z ~ r^H is 1/(1 + H) (Eq. 24).
fn zoom() -> Result<Vec<Claim>> {
    let hurst = 0.6;
    let body = |side: f64| Surface::PowerLaw { coefficient: 1.0, exponent: hurst, size: side.into() };
    let mut claims = Vec::new();
    // The same contact, in a square of side L and of side C L = 2 L with the same cells.
    let force = 0.05;
    let one = Bem3d { cells: 32, tolerance: TOLERANCE, ..Bem3d::default() };
    let two = Bem3d { cells: 64, ..one };
    let (a, b) = (solve(&one, body(1.0), 1.0, force)?, solve(&two, body(2.0), 1.0, force)?);
    claims.push(Claim::compare(
        "bem3d: change of k when the same contact is seen in a square of twice the side",
        0.0,
        stiffness(&b) / stiffness(&a) - 1.0,
        None,
        ALLOWED,
        "Eqs. 19 to 21: F' = F, k' = k; z = r^0.6 with the same cells in a square of side 1 and 2; allowed: ten times the solver's tolerance",
    ));
    // Eqs. 22 to 24: with h' = C^H h, k_bar' = k_bar/C and F_bar' = F_bar/C^(H+1).
    let alpha = analytic::exponent_scaling(hurst);
    let line = Mdr1d { elements: 64 };
    let fine = Bem3d { cells: 129, tolerance: 1e-6, ..Bem3d::default() };
    for (model, forces, allowed, why) in [
        (&line as &dyn ContactModel, [1e-4, 1e-2], 1e-9, "closed form: rounding"),
        (
            &fine,
            [0.02, 0.1],
            0.02,
            "2 %: the edge of a contact of 10 to 30 cells across is a staircase (first order in 1/N)",
        ),
    ] {
        let low = stiffness(&solve(model, body(1.0), 1.0, forces[0])?);
        let high = stiffness(&solve(model, body(1.0), 1.0, forces[1])?);
        claims.push(Claim::compare(
            format!("{}: exponent of a body z = r^H, H = {hurst}", model.name()),
            alpha,
            (high / low).ln() / (forces[1] / forces[0]).ln(),
            None,
            allowed,
            format!("Eqs. 22 to 24 where they are exact: alpha = 1/(1 + H); allowed: {why}"),
        ));
    }
    Ok(claims)
}
