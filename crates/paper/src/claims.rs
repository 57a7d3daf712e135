//! The statements of the paper, one function per group; each compares and none tunes.
//!
//! What a fair reading allows is fixed in each group, beforehand: the digits that the paper prints, the width of a line of its plots, or the
//! distance between its own numbers for one thing. What was found has a 95 % interval, and the verdict follows from both
//! ([`Claim::judge`], [`Claim::beside`] for rival laws, [`Claim::in_convention`]). Identities that only test code (Eqs. 7, 19 to 23, full
//! contact of a line) are tests, not claims. Area over force is judged where waves are resolved: [`crate::two_cases`].

mod common;
mod curve;
mod exponent;
mod factor;
mod line;
mod plateau;
mod regions;
mod speed;

use crate::claim::Claim;
use evaluation::Measured;

pub(crate) use curve::collapse;
pub(crate) use line::beside_stiffness;
pub(crate) use plateau::plateaus;
pub(crate) use regions::regions;
pub(crate) use speed::speed;

/// What Fig. 2 can judge.
pub(crate) fn curves_3d(solid: &Measured) -> Vec<Claim> {
    let mut claims = exponent::straightness(solid);
    claims.extend(curve::near_the_crossing(solid));
    claims.extend(curve::narrowest(solid));
    claims.extend(curve::upper_limit(solid));
    claims.extend(curve::conductance(solid));
    claims.extend(curve::saturation(solid));
    claims.extend(curve::small_area(solid));
    claims.extend(exponent::size_effects(solid));
    claims
}

/// What Fig. 6 can judge.
pub(crate) fn curves_1d(line: &Measured) -> Vec<Claim> {
    let mut claims = exponent::straightness(line);
    claims.extend(curve::saturation(line));
    claims.extend(exponent::down_to_small_forces(line));
    claims
}

/// What Fig. 3 can judge.
pub(crate) fn exponents(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let mut claims = Vec::new();
    for measured in [solid, line] {
        claims.extend(exponent::ends(measured));
        claims.extend(exponent::laws_of_each(measured));
    }
    claims.extend(exponent::coefficient(solid));
    claims.extend(exponent::below_one(solid));
    claims.extend(exponent::line_against_solid(solid, line));
    claims
}

/// What Fig. 7 can judge.
pub(crate) fn factors(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let mut claims = factor::against_the_fit(solid);
    claims.extend(factor::crossing(solid));
    claims.extend(factor::line_against_solid(solid, line));
    claims
}

/// What both models together can judge.
pub(crate) fn together(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let mut claims = curve::line_above_solid(solid, line);
    claims.extend(exponent::below_the_crossover(solid, line));
    claims.extend(exponent::at_every_load(solid, line));
    claims
}
