//! The claims of the paper, one function per group; each compares and none tunes.
//!
//! What counts as agreement is fixed here, beforehand, from the uncertainty that data/paper/VALUES.md states for independent values
//! (alpha: 0.03, and 0.08 at D_f = 3, where the exponent is logarithmic), the digits the paper prints, and twice the standard
//! error of this run.

mod area;
mod common;
mod curve;
mod exponent;
mod factor;
mod paper;
mod plateau;
mod scaling;
mod speed;

use evaluation::{Claim, Measured};

pub(crate) use curve::{collapse, line_above_solid};
pub(crate) use paper::paper_against_itself;
pub(crate) use plateau::plateaus;
pub(crate) use scaling::scaling;
pub(crate) use speed::speed;

/// What Fig. 2 can judge.
pub(crate) fn curves_3d(solid: &Measured) -> Vec<Claim> {
    let mut claims = curve::near_the_crossing(solid);
    claims.extend(curve::conductance(solid));
    claims.extend(curve::saturation(solid));
    claims.extend(area::proportionality(solid));
    claims
}

/// What Fig. 6 can judge.
pub(crate) fn curves_1d(line: &Measured) -> Vec<Claim> {
    let mut claims = curve::saturation(line);
    claims.extend(exponent::down_to_small_forces(line));
    claims
}

/// What Fig. 3 can judge.
pub(crate) fn exponents(solid: &Measured, line: &Measured) -> Vec<Claim> {
    let mut claims = exponent::against_the_fit(solid);
    claims.extend(exponent::against_the_scaling(solid));
    claims.extend(exponent::against_the_fit(line));
    claims.extend(exponent::against_the_scaling(line));
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
