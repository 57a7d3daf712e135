//! The method of reduction of dimensionality (MDR): rough lines and axisymmetric bodies on a foundation of
//! independent springs.
//!
//! # What it computes
//!
//! * [`Bearing`]: force, approach and stiffness of any line at any load, exactly, by order statistics: no
//!   time step, no iteration, no tolerance.
//! * [`rule`]: the line that is equivalent to a self-affine square or rectangle (Pohrt, Popov, Filippov 2012,
//!   Eqs. 14 to 18).
//! * [`axisymmetric`]: spheres, cones, power-law bodies and flat circular punches through their profile
//!   `g(x)`, where the method is exact in three dimensions.
//! * Adhesion, friction and rheology of such bodies, each spring obeying a rule of its own.
//!
//! Behind the common traits, one file each:
//!
//! | model | surfaces | effects | claims |
//! |---|---|---|---|
//! | [`Mdr1d`] | self-affine, line | none | F, d, k |
//! | [`Mdr1d`] | [`axisymmetric`] bodies | none, or short-range adhesion: edge springs detach at `sqrt(2 pi a w / E*)` (Hess) | F, d (of either sign with adhesion), k, area, pull-off |
//! | [`PartialSlip`] (a history) | [`axisymmetric`] bodies | Coulomb's friction, any path of both loads | tangential force and displacement, stick radius, dissipated energy |
//! | [`Viscoelastic`] (a history) | [`axisymmetric`] bodies | Kelvin-Voigt, Maxwell, standard solid, Prony series, while the contact grows | F, d, area of time |
//! | [`Equivalent`] (a history) | all surfaces of a model M, rough ones too | Coulomb's friction or rheology, by the [`Tabulated`] profile of M's k(d) | tangential force and displacement, dissipated energy; F and d of time; M's own outputs |
//!
//! # Conventions
//!
//! The springs have the stiffness E* per length. `z = h_max - h`, the approach `d` counts from first touch,
//! and the contact set is `{z < d}`: an element that touches without force is outside of it, and `F = 0`
//! means `d = 0` and `k = 0` (with adhesion it means the adhered contact). A line stands for a rectangle with
//! `L = sqrt(Lx Ly)`, the side of a square, and has the length `L_1D = 2 L / sqrt(pi)`; `F_bar` and `k_bar`
//! use that L and the line's own measured rms height ([`contact_model::Normalisation`]).
//!
//! # Accuracy and speed
//!
//! The equations of the line are solved to a few units in the last place, at any load and in any units from
//! 1e-150 to 1e150. How well a *rough* line represents a rough surface is another question: the
//! mean stiffness of lines is 0.64 to 1.26 times that of surfaces, as load and fractal dimension have it. At
//! `F_bar` = 1 it is 11 to 18 % larger. Its plateau is 2 % below that of a rigid square.
//!
//! One line of 2^20 elements takes milliseconds, and each further load microseconds ([`Bearing`]). A step of
//! [`PartialSlip`] costs a microsecond by displacement and about twenty by force. One of [`Viscoelastic`]
//! costs a hundred microseconds with 16 arms, and one of [`Equivalent`] a solve of its model and up to a
//! millisecond.
//!
//! # What it does not do
//!
//! It offers no contact area, pressure or mean gap for rough surfaces: a line's length in contact is not an
//! area, and both fail even qualitatively (Lyashenko, Pastewka, Persson 2013). Such outputs are refused, as
//! are periodic boundaries, and adhesion of rough lines: that rule needs the radius of a round contact.
//! Friction and rheology of rough surfaces are the task of [`Equivalent`], which uses a model of the normal
//! contact and not a line.
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
