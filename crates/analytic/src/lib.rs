//! Closed forms, one theory per file, each a [`contact_model::ContactModel`] that names its sources.
//!
//! Is there a formula for your contact? These models evaluate the formulas and theories of the literature.
//! They take the same scenes and loads as the numerical models, so that the results can stand in one table.
//! In the last column F is the normal force, d the approach and k the stiffness.
//!
//! | model | surfaces | what it computes |
//! |---|---|---|
//! | [`Hertz`] | sphere | F, d, k, area |
//! | [`PowerLawBody`] | power law, cone, sphere | F, d, k, area |
//! | [`FlatPunch`] | flat circle, flat square | F, d, k, area |
//! | [`Jkr`] | sphere, [`contact_model::Adhesion::ShortRange`] | F, d (of either sign), k, area, pull-off |
//! | [`MaugisDugdale`] | sphere, [`contact_model::Adhesion::FiniteRange`] of Dugdale's law | F, d (of either sign), k, area, pull-off; no attraction without contact |
//! | [`Westergaard`] | sine, periodic | F, mean gap, k, area |
//! | [`AdhesiveWave`] | sine, periodic, [`contact_model::Adhesion::ShortRange`] | F (of either sign), mean gap, k, area, pull-off and snap-in |
//! | [`Persson`] | self-affine with cut-off or map, periodic | F, mean gap, k, area |
//! | [`GreenwoodWilliamson`] | self-affine with cut-off or map, periodic | F, mean gap, k, area up to half of the summits |
//! | [`CattaneoMindlin`] (a history) | sphere, friction by Coulomb's law | tangential force and displacement, stick radius, dissipated energy |
//! | [`PowerLaw`] | self-affine or map, `k_bar <= 0.18` | k of F (Eq. 12 of Pohrt, Popov, Filippov 2012), d by integration |
//!
//! The other fits of that paper are plain functions: [`exponent_fit`] (Eq. 6), [`zeta_fit`] (Eq. 11),
//! [`conductance_fit`] (Eq. 13), [`exponent_scaling`] (Eq. 24) and [`force_tilde`] (Fig. 4). The product of
//! two waves has no closed form. Its limits for small and for nearly full contact are functions of
//! [`westergaard`].
//!
//! Theories of rough surfaces need statistics of the surface. They are in [`spectrum`] for a random surface.
//! For a given map they are in [`surface_gen::MapStatistics`] and [`surface_gen::SelfAffineFit`].
//!
//! # Conventions
//!
//! The conventions are those of [`contact_model`]: `d` is measured from first touch, pressure is compressive,
//! and the caller chooses the units.
//!
//! * Round contacts are at the centre of the rectangle. If the radius of the contact exceeds half of the
//!   shorter side, the load is out of range, because the half-space outside of the rectangle carries no
//!   pressure.
//! * `L = sqrt(Lx Ly)` is the side of a square. Theories of rough surfaces depend on the nominal area `L^2`
//!   alone.
//! * Periodic contacts have a mean gap ([`contact_model::ContactState::mean_gap`],
//!   [`contact_model::Load::mean_gap`]) and no approach.
//!
//! # Accuracy and speed
//!
//! These numbers are for the evaluation of a formula. How well the formula describes a contact is another
//! question: theories of rough surfaces are approximations, and [`PowerLaw`] is a fit.
//!
//! Exact formulas are evaluated to about 1e-14, and to 1e-13 for small exponents, in any units from 1e-150 to
//! 1e150. The constant of the flat square is known to 1e-6, and its report says so.
//!
//! | model | time of a state |
//! |---|---|
//! | most models | well below 1 us |
//! | [`MaugisDugdale`], which needs a root | 1 to 2 us |
//! | [`GreenwoodWilliamson`] and [`Persson`], which need quadratures to 1e-11 | tens of us; a few hundred with the mean gap |
//!
//! # What it does not do
//!
//! It has no fields, because a closed form has no cells. Pressures that are known as formulas are functions
//! of r ([`hertz::pressure`], [`flat_punch::pressure`]). Effects that are not in the table are refused.

pub mod adhesive_wave;
pub mod cattaneo_mindlin;
mod closed;
pub mod flat_punch;
mod gamma;
pub mod greenwood_williamson;
pub mod hertz;
pub mod jkr;
pub mod maugis_dugdale;
mod memory;
mod periodic;
pub mod persson;
pub mod power_law;
pub mod power_law_body;
mod round;
mod special;
pub mod spectrum;
#[cfg(test)]
mod testing;
pub mod westergaard;

pub use adhesive_wave::AdhesiveWave;
pub use cattaneo_mindlin::CattaneoMindlin;
// All that a first program needs beside the model itself: scenes, loads, states, height maps, the traits.
#[doc(no_inline)]
pub use contact_model::*;
pub use flat_punch::FlatPunch;
pub use greenwood_williamson::GreenwoodWilliamson;
pub use hertz::Hertz;
pub use jkr::Jkr;
pub use maugis_dugdale::MaugisDugdale;
pub use persson::Persson;
pub use power_law::{
    F_BAR_UL, K_BAR_UL, PowerLaw, conductance_fit, exponent_fit, exponent_scaling, force_tilde, zeta_fit,
};
pub use power_law_body::PowerLawBody;
pub use westergaard::Westergaard;
