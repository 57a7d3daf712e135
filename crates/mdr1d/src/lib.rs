//! The method of reduction of dimensionality (MDR): rough lines and axisymmetric bodies on a foundation of
//! independent springs.
//!
//! # What it computes
//!
//! A round body on a half-space has the same force, approach and stiffness as a certain line on a row of
//! independent springs. The line is found from the profile of the body. For axisymmetric bodies this is
//! exact. For rough surfaces a line with a suitable spectrum is an approximation.
//!
//! * [`Bearing`] gives force, approach and stiffness of any line at any load. It sorts the heights of the
//!   line, so that there is no time step, no iteration and no tolerance.
//! * [`rule`] makes the line that stands for a self-affine square or rectangle (Pohrt, Popov, Filippov 2012,
//!   Eqs. 14 to 18).
//! * [`axisymmetric`] has spheres, cones, power-law bodies and flat circular punches. Their profile is
//!   `g(x)`, and for them the method is exact in three dimensions.
//! * Adhesion, friction and rheology of such bodies follow if each spring obeys a rule of its own.
//!
//! ```
//! use mdr1d::{ContactModel, Load, Scene, Surface};
//! // A sphere of radius 1 on a square of side 1 at d = 0.01: a = 0.1, k = 2 E* a, F = (4/3) E* a^3.
//! let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 3.0);
//! let mut contact = mdr1d::Mdr1d::default().prepare(&scene, 0)?;
//! let state = contact.solve(Load::approach(0.01))?;
//! assert!((state.force - 0.004).abs() < 1e-15);
//! assert!((state.stiffness.unwrap_or(0.0) - 0.6).abs() < 1e-14);
//! # Ok::<(), contact_model::Error>(())
//! ```
//!
//! There are four models, one in each file. F is the normal force, d the approach and k the stiffness.
//!
//! | model | surfaces | effects | what it computes |
//! |---|---|---|---|
//! | [`Mdr1d`] | self-affine, line | none | F, d, k |
//! | [`Mdr1d`] | [`axisymmetric`] bodies | none, or short-range adhesion: the springs at the edge detach at `sqrt(2 pi a w / E*)`, with the contact radius a and the work of adhesion w (Hess) | F, d (of either sign with adhesion), k, area, pull-off |
//! | [`PartialSlip`] (a history) | [`axisymmetric`] bodies | Coulomb's friction, any path of both loads | tangential force and displacement, stick radius, dissipated energy |
//! | [`Viscoelastic`] (a history) | [`axisymmetric`] bodies | Kelvin-Voigt, Maxwell, standard solid, Prony series, while the contact grows | F, d, area as functions of time |
//! | [`Equivalent`] (a history) | all surfaces of a model M, rough ones too | Coulomb's friction or rheology, by the [`Tabulated`] profile of M's k(d) | tangential force and displacement, dissipated energy; F and d as functions of time; M's own outputs |
//!
//! # Conventions
//!
//! The springs have the stiffness E* per length. With `z = h_max - h`, the approach `d` is measured from
//! first touch, and the contact set is `{z < d}`. An element that touches without force is outside of it.
//! `F = 0` means `d = 0` and `k = 0`; with adhesion it means the contact that adheres without a load.
//!
//! A line stands for a rectangle with the sides Lx and Ly. `L = sqrt(Lx Ly)` is the side of a square of the
//! same area, and the line has the length `L_1D = 2 L / sqrt(pi)`. `F_bar` and `k_bar` use this L and the
//! measured rms height of the line itself ([`contact_model::Normalisation`]).
//!
//! # Accuracy and speed
//!
//! The equations of the line are solved to a few units in the last place, at any load and in any units from
//! 1e-150 to 1e150.
//!
//! How well a *rough* line represents a rough surface is another question. The mean stiffness of lines is
//! 0.64 to 1.26 times that of surfaces, depending on load and fractal dimension. At `F_bar` = 1 it is 11 to
//! 18 % larger. Under large loads the stiffness reaches a plateau, which is 2 % below that of a rigid square.
//!
//! | what | time |
//! |---|---|
//! | one line of 2^20 elements | milliseconds |
//! | each further load ([`Bearing`]) | microseconds |
//! | a step of [`PartialSlip`] | a microsecond by displacement, about twenty by force |
//! | a step of [`Viscoelastic`] with 16 arms | a hundred microseconds |
//! | a step of [`Equivalent`] | one solve of its model, and up to a millisecond |
//!
//! # What it does not do
//!
//! It gives no contact area, pressure or mean gap of rough surfaces. The length of a line that is in contact
//! is not an area, and areas and gaps from a line are wrong even qualitatively (Lyashenko, Pastewka, Persson
//! 2013). Such outputs are refused. Periodic boundaries are refused too, and so is adhesion of rough lines,
//! because its rule needs the radius of a round contact.
//!
//! For friction and rheology of rough surfaces take [`Equivalent`]. It uses a model of the normal contact and
//! not a line.

mod adhesion;
pub mod axisymmetric;
mod bearing;
mod body;
mod equivalent;
mod material;
mod model;
mod partial_slip;
mod relaxation;
pub mod rule;
mod shape;
mod slip;
mod tabulated;
mod viscoelastic;

pub use axisymmetric::Profile;
// All that a first program needs beside the model itself: scenes, loads, states, height maps, the traits.
pub use bearing::{Bearing, Support};
#[doc(no_inline)]
pub use contact_model::*;
pub use equivalent::Equivalent;
pub use model::{BYTES_PER_ELEMENT, Ensemble, Mdr1d};
pub use partial_slip::PartialSlip;
pub use tabulated::Tabulated;
pub use viscoelastic::Viscoelastic;
