//! The types that the crates of fractal-contact share.
//!
//! Three ideas organise everything: **physics** ([`Scene`]), **numerics** (each model's own options) and
//! **chance** (the `seed` of [`ContactModel::prepare`]). This crate defines the physics, the trait that joins
//! the three, and the result of a solve: a [`ContactState`] that always carries its evidence in a
//! [`SolveReport`]. It has no numerics, no input or output, and no dependency besides `std` (with the feature
//! `serde`, states and memories of paths can be stored).
//!
//! # Conventions
//!
//! * The body is an elastic half-space of contact modulus E* whose surface carries heights `h`; a rigid
//!   flat presses on it. With `z = h_max - h >= 0` the contact conditions are `g = u + z - d >= 0`, `p >= 0`,
//!   `p g = 0`.
//! * The approach `d` is counted **from first touch of the highest point**, not from the mean plane. At
//!   `F = 0`, `d = 0` and `k = 0`.
//! * Pressure is compressive and non-negative; stiffness is `k = dF/dd`.
//! * Units are the caller's own and only need to be consistent: lengths in one unit, modulus in force per
//!   length squared. Names that end in `_bar` are normalised ([`Normalisation`] is the only place that does
//!   it).
//! * With periodic boundaries there is no approach but a mean gap; the stiffness is then the negative
//!   derivative of the force in it.
//! * What depends on the path of the loads (friction, rheology, indentation, adhesion) is followed [`Step`]
//!   by step.
//! * Tangential quantities have two components: along x, the columns of a map, and along y, its rows.
//! * The quantities that are reported of a state stand in one table ([`quantities::QUANTITIES`]), the
//!   abilities of a model in another ([`Abilities`]).
//! * Fields, patches and what follows from the stiffness (conductance) are [`Outputs`]: they are computed
//!   only on request, and the [`Work`] in the report shows it.
//! * `None` means that the model does not claim the quantity or that it was not requested. An absent quantity
//!   is never NaN and never a silent 0.
//!
//! ```
//! use contact_model::{Load, Normalisation};
//! // A force of 0.01 on a square of side 1, modulus 1, rms height 0.5 is F_bar = 0.02 (Eq. 10).
//! let normalisation = Normalisation { contact_modulus: 1.0, length: 1.0, height: Some(0.5) };
//! assert_eq!(normalisation.force_bar(0.01)?, 0.02);
//! assert!(Load::force(-1.0).validated().is_err());
//! # Ok::<(), contact_model::Error>(())
//! ```

mod abilities;
mod cells;
mod conductance;
mod effects;
mod error;
mod fields;
mod height_map;
mod heights;
mod line;
mod load;
mod memory;
mod model;
mod nondimensionalisation;
mod normalisation;
mod pair;
mod patches;
mod pull_off;
pub mod quantities;
mod rheology;
mod scaling;
mod scene;
mod state;
mod step;
pub mod units;
mod validation;
mod value;
mod work;

pub use abilities::{Abilities, LoadKind, Paths, SurfaceKind};
pub use cells::{Cells, Size};
pub use conductance::Conductance;
pub use effects::*;
pub use error::{Error, Result};
pub use fields::{FIELDS, Field, FieldQuantity, Fields, StickSlip};
pub use height_map::HeightMap;
pub use line::Line;
pub use load::{Directions, Load, NormalLoad, Tangential};
pub use memory::PathMemory;
pub use model::{ContactModel, PreparedContact, RequiredMemory, Source, Stop, Watch, check_stop, never};
pub use nondimensionalisation::Nondimensionalisation;
pub use normalisation::{Normalisation, PAPER_STIFFNESS_FACTOR};
pub use pair::{Body, Pair};
pub use patches::Patches;
pub use pull_off::LargestPull;
pub use quantities::{Output, Outputs};
pub use rheology::{PronySeries, Relaxing, Rheology};
pub use scaling::{ScaledState, Scaling};
pub use scene::{Amplitude, Scene, SelfAffine, Surface, line_length};
pub use state::{
    AdhesiveState, Branch, Certificate, ContactResolution, ContactState, PlasticState, PullOff, SolveReport,
    Status, TangentialState,
};
pub use step::Step;
pub use value::Value;
pub use work::Work;
