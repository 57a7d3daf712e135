//! The types that the crates of fractal-contact share.
//!
//! What is a contact problem, and what is its answer? Three ideas organise everything: **physics**
//! ([`Scene`]), **numerics** (the options of each model) and **chance** (the `seed` of
//! [`ContactModel::prepare`]). This crate defines the physics, and the trait that joins the three. It also
//! defines the result of a solve: a [`ContactState`], which always carries its evidence in a [`SolveReport`].
//!
//! The crate has no numerics, and no input or output. It depends on nothing but `std`. With the feature
//! `serde`, states and memories of paths can be stored.
//!
//! ```
//! use contact_model::{Load, Normalisation};
//! // A force of 0.01 on a square of side 1, modulus 1, rms height 0.5 is F_bar = 0.02 (Eq. 10).
//! let normalisation = Normalisation { contact_modulus: 1.0, length: 1.0, height: Some(0.5) };
//! assert_eq!(normalisation.force_bar(0.01)?, 0.02);
//! assert!(Load::force(-1.0).validated().is_err());
//! # Ok::<(), contact_model::Error>(())
//! ```
//!
//! # Conventions
//!
//! * **Problem.** The body is an elastic half-space of contact modulus E*. Its surface carries heights `h`,
//!   and a rigid flat presses on it. With the depth `z = h_max - h >= 0`, the elastic displacement u, the gap
//!   g and the pressure p the contact conditions are `g = u + z - d >= 0`, `p >= 0`, `p g = 0`.
//! * **Approach.** `d` is measured **from first touch of the highest point**, not from the mean plane. At
//!   `F = 0`, `d = 0` and `k = 0`.
//! * **Signs.** Pressure is compressive and not negative. The stiffness is `k = dF/dd`.
//! * **Units.** The caller chooses them. They only need to fit together: lengths in one unit, the modulus in
//!   force per length squared. Names that end in `_bar` are normalised, and [`Normalisation`] is the only
//!   place that does this.
//! * **Periodic boundaries.** There is no approach, but a mean gap. The stiffness is then the negative
//!   derivative of the force with respect to the mean gap. Only a layer on a rigid base has an approach as a
//!   whole ([`WholeLayer`]).
//! * **Paths.** With friction, rheology, a hardness or adhesion a state depends on the loads before it. Such
//!   a path is followed [`Step`] by step.
//! * **Tangential quantities** have two components: along x, the columns of a map, and along y, its rows.
//! * **Tables.** All quantities that are reported of a state are in one table ([`quantities::QUANTITIES`]).
//!   The abilities of a model are in another one ([`Abilities`]). A [`Table`] of results has named columns with
//!   units and holds no NaN.
//! * **Outputs.** Fields, patches and what follows from the stiffness (conductance) are [`Outputs`]. They are
//!   computed only if they are requested, and the [`Work`] in the report shows this.
//! * **Absence.** `None` means that the model does not give the quantity, or that it was not requested. An
//!   absent quantity is never NaN and never 0.

mod abilities;
mod cells;
mod conductance;
mod effects;
mod error;
mod escape;
mod fields;
mod height_map;
mod heights;
mod interface_state;
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
mod table;
pub mod units;
mod validation;
mod value;
mod work;

pub use abilities::{Abilities, LoadKind, NotCombined, Paths, SurfaceKind};
pub use cells::{Cells, Size};
pub use conductance::Conductance;
pub use effects::*;
pub use error::{Error, Result};
pub use escape::{Escaping, escaped};
pub use fields::{FIELDS, Field, FieldQuantity, Fields, StickSlip};
pub use height_map::HeightMap;
pub use interface_state::{FilmState, InterfaceState, LargestStress, LeakageState, PathState};
pub use line::Line;
pub use load::{Directions, Load, NormalLoad, Tangential};
pub use memory::PathMemory;
pub use model::{
    ContactModel, Interrupted, PreparedContact, RequiredMemory, Source, Stop, Watch, check_stop, never,
};
pub use nondimensionalisation::Nondimensionalisation;
pub use normalisation::{Normalisation, PAPER_STIFFNESS_FACTOR};
pub use pair::{Body, Pair};
pub use patches::Patches;
pub use pull_off::LargestPull;
pub use quantities::{InterfaceOutput, Output, Outputs};
pub use rheology::{PronySeries, RelaxationSpectrum, Relaxing, RelaxingRate, Rheology};
pub use scaling::{ScaledState, Scaling};
pub use scene::{Amplitude, Scene, SelfAffine, Surface, line_length};
pub use state::{
    AdhesiveState, Branch, Certificate, ContactResolution, ContactState, PlasticState, PullOff, SolveReport,
    Status, TangentialState, ViscoelasticState, WholeLayer,
};
pub use step::Step;
pub use table::{Column, Table};
pub use value::Value;
pub use work::Work;
