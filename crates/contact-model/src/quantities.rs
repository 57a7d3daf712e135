//! The one table of quantities: the outputs that can be requested of a model, and each number and word that
//! is reported of a state.
//!
//! Every table, file, picture and page that shows numbers of states iterates over [`QUANTITIES`], so a
//! quantity that stands here is reported everywhere: CSV, console, report, means over surfaces, curves,
//! Python, glossary. Units are those of SI; where a scene has no units, a dimensional number is in the
//! scene's own.

use crate::conductance::Conductance;
use crate::effects::{Boundary, Effects, Friction};
use crate::error::Result;
use crate::interface_state::{FilmState, LargestStress, LeakageState, PathState};
use crate::load::Directions;
use crate::normalisation::Normalisation;
use crate::state::ContactState;
use crate::value::Value;

macro_rules! outputs {
    ($($(#[doc = $doc:literal])+ $variant:ident $field:ident,)+) => {
        /// An output: something that is computed on request.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Output {
            $($(#[doc = $doc])+ $variant,)+
            /// Conductance through the contact; it follows from the stiffness at fixed contact area.
            Conductance,
        }

        /// The outputs that are computed besides force and approach. An output that is not requested is
        /// neither computed nor stored.
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        #[allow(clippy::struct_excessive_bools)] // A set of names, each either asked for or not.
        pub struct Outputs {
            $($(#[doc = $doc])+ pub $field: bool,)+
            /// Conductance through the contact.
            pub conductance: Conductance,
        }

        impl Output {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)+ Self::Conductance];

            /// Its name: the key in `[outputs]` of a scene, and the word in Python.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => stringify!($field),)+
                    Self::Conductance => "conductance",
                }
            }

            /// Its meaning, in a sentence.
            pub fn sentence(self) -> &'static str {
                match self {
                    $(Self::$variant => concat!($($doc),+).trim_ascii(),)+
                    Self::Conductance => "Conductance through the contact; it follows from the stiffness at fixed contact area.",
                }
            }
        }

        impl Outputs {
            /// Whether an output is requested.
            pub fn asks(&self, output: Output) -> bool {
                match output {
                    $(Output::$variant => self.$field,)+
                    Output::Conductance => self.conductance != Conductance::Off,
                }
            }

            /// Requests an output, or no longer; the conductance is requested with its bodies instead
            /// ([`Outputs::conductance`]).
            pub fn ask(&mut self, output: Output, asked: bool) {
                match output {
                    $(Output::$variant => self.$field = asked,)+
                    Output::Conductance => {}
                }
            }
        }
    };
}

// A new output: a line here; its quantities in the table below, or its field in `FIELDS`; a member of the
// state or of its fields.
outputs! {
    /// Stiffness k = dF/dd along the branch of states.
    Stiffness stiffness,
    /// Stiffness at fixed contact area: all cells in contact stay bonded.
    StiffnessFixedArea stiffness_fixed_area,
    /// Real contact area.
    Area area,
    /// Mean gap; with periodic boundaries only, where a state has no approach.
    MeanGap mean_gap,
    /// Pressure field.
    Pressure pressure,
    /// Displacement field.
    Displacement displacement,
    /// Gap field.
    Gap gap,
    /// Field of the plastic indentation; with a hardness only.
    PlasticDepth plastic_depth,
    /// Connected contact areas, their number and sizes.
    ContactPatches contact_patches,
    /// Areas of the contact that stick and that slip; with friction only.
    StickArea stick_area,
    /// Tangential stiffness dQ/ddelta along the branch of states, 2 x 2; with friction only.
    TangentialStiffness tangential_stiffness,
    /// Tangential stiffness of the whole contact, sticking, 2 x 2; with friction only.
    TangentialStiffnessStuck tangential_stiffness_stuck,
    /// Field of the tangential traction, two components; with friction only.
    Traction traction,
    /// Field of the slip, two components; with friction only.
    Slip slip,
    /// Map of the cells that stick and of those that slip; with friction only.
    StickSlip stick_slip,
}

impl Outputs {
    /// All outputs that are requested.
    pub fn asked(&self) -> impl Iterator<Item = Output> + '_ {
        Output::ALL.iter().copied().filter(|output| self.asks(*output))
    }

    /// Whether any field is requested.
    pub fn any_field(&self) -> bool {
        self.asked().any(Output::is_field)
    }

    /// Whether a stiffness of either kind has to be computed; an elastic model, where both are equal, needs
    /// no other question.
    pub fn needs_stiffness(&self) -> bool {
        self.stiffness || self.needs_fixed_area()
    }

    /// Outputs that need friction.
    pub const OF_FRICTION: &'static [Output] = &[
        Output::StickArea,
        Output::TangentialStiffness,
        Output::TangentialStiffnessStuck,
        Output::Traction,
        Output::Slip,
        Output::StickSlip,
    ];

    /// Whether the stiffness at fixed contact area has to be computed, for itself or for the conductance.
    pub fn needs_fixed_area(&self) -> bool {
        self.stiffness_fixed_area || self.conductance != Conductance::Off
    }
}

impl ContactState {
    /// The state with the quantities that follow from its stiffness at fixed contact area, and without a
    /// stiffness that was not itself requested.
    ///
    /// A model calls it last. It must have computed the stiffnesses that [`Outputs::needs_stiffness`] and
    /// [`Outputs::needs_fixed_area`] require.
    ///
    /// # Errors
    /// As [`Conductance::of`].
    pub fn completed(mut self, outputs: &Outputs, contact_modulus: f64) -> Result<Self> {
        if let Some(stiffness) = self.stiffness_fixed_area {
            self.conductance = outputs.conductance.of(stiffness, contact_modulus)?;
        }
        self.stiffness = self.stiffness.filter(|_| outputs.stiffness);
        self.stiffness_fixed_area = self.stiffness_fixed_area.filter(|_| outputs.stiffness_fixed_area);
        Ok(self)
    }
}

/// A result that a scene computes from the fields of a state, beside the outputs of its model
/// ([`crate::InterfaceState`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InterfaceOutput {
    /// Flow of a fluid between opposite edges.
    Leakage,
    /// Paths between opposite edges, and their critical constriction.
    Percolation,
    /// The largest stress below the surface.
    StressBelow,
    /// The factor until a yield stress is reached there.
    YieldStress,
    /// Conduction through the contact and a film in the gap.
    Film,
    /// Conduction of this film between opposite edges.
    FilmAlong,
    /// The gap of each cell with its error, which leakage and paths need.
    Gap,
}

impl InterfaceOutput {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Leakage,
        Self::Percolation,
        Self::StressBelow,
        Self::YieldStress,
        Self::Film,
        Self::FilmAlong,
        Self::Gap,
    ];

    /// The key in `[outputs]` of a scene, or in a table there.
    pub fn key(self) -> &'static str {
        match self {
            Self::Leakage => "leakage",
            Self::Percolation => "percolation",
            Self::StressBelow => "stress_below",
            Self::YieldStress => "yield_stress",
            Self::Film => "film",
            Self::FilmAlong => "along",
            Self::Gap => "gap",
        }
    }
}

/// The properties of a scene that decide whether a quantity is reported of its states.
#[derive(Debug, Clone, Copy)]
pub struct SceneProperties<'a> {
    /// Effects that are on.
    pub effects: &'a Effects,
    /// Outputs that are requested.
    pub outputs: &'a Outputs,
    /// Results that are computed from the fields of a state.
    pub interface: &'a [InterfaceOutput],
    /// Whether the surface has an rms height, so that normalised forces exist.
    pub rough: bool,
    /// Whether the states lie along a path.
    pub path: bool,
    /// Whether an approach or a mean gap is prescribed.
    pub prescribes_distance: bool,
    /// Directions of tangential loads and displacements that are prescribed or that a model computes.
    pub directions: Directions,
}

/// The condition under which a quantity is in the tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AskedBy {
    /// Every scene.
    Always,
    /// Surfaces with an rms height.
    RoughSurface,
    /// Free boundaries.
    FreeBoundary,
    /// Periodic boundaries.
    PeriodicBoundary,
    /// A layer on a rigid base, with periodic boundaries.
    WholeLayer,
    /// A path.
    Path,
    /// A prescribed approach or mean gap.
    PrescribedDistance,
    /// An output.
    Output(Output),
    /// A result that is computed from the fields of a state.
    Interface(InterfaceOutput),
    /// A stiffness of either kind, or a quantity that follows from one.
    AnyStiffness,
    /// A tangential stiffness of either kind.
    AnyTangentialStiffness,
    /// Friction in two directions: a component along y is prescribed, or a model computes one.
    FrictionInPlane,
    /// An effect, by its key in `[effects]`.
    Effect(&'static str),
    /// All of these together.
    All(&'static [AskedBy]),
}

impl AskedBy {
    /// Whether the condition holds for this scene.
    pub fn holds(self, scene: &SceneProperties<'_>) -> bool {
        match self {
            Self::Always => true,
            Self::RoughSurface => scene.rough,
            Self::FreeBoundary => scene.effects.boundary == Boundary::Free,
            Self::PeriodicBoundary => scene.effects.boundary == Boundary::Periodic,
            Self::WholeLayer => {
                scene.effects.boundary == Boundary::Periodic
                    && scene.effects.layer.is_some_and(|layer| layer.whole_compression().is_some())
            }
            Self::Path => scene.path,
            Self::PrescribedDistance => scene.prescribes_distance,
            Self::Output(output) => scene.outputs.asks(output),
            Self::Interface(output) => scene.interface.contains(&output),
            Self::AnyStiffness => scene.outputs.needs_stiffness(),
            Self::AnyTangentialStiffness => {
                scene.outputs.tangential_stiffness || scene.outputs.tangential_stiffness_stuck
            }
            Self::FrictionInPlane => {
                scene.directions == Directions::Plane && scene.effects.friction != Friction::Off
            }
            Self::Effect(key) => scene.effects.named().any(|effect| effect.key() == key),
            Self::All(each) => each.iter().all(|asked| asked.holds(scene)),
        }
    }

    /// The condition in words, for documents.
    pub fn words(self) -> String {
        match self {
            Self::Always => "every scene".into(),
            Self::RoughSurface => "a rough surface".into(),
            Self::FreeBoundary => "free boundaries".into(),
            Self::PeriodicBoundary => "periodic boundaries".into(),
            Self::WholeLayer => "`layer` on a rigid base in [effects], periodic boundaries".into(),
            Self::Path => "a path".into(),
            Self::PrescribedDistance => "a prescribed approach or mean gap".into(),
            Self::Output(output) => format!("`{}` in [outputs]", output.name()),
            Self::Interface(InterfaceOutput::YieldStress) => {
                "`yield_stress` in `stress_below` of [outputs]".into()
            }
            Self::Interface(InterfaceOutput::FilmAlong) => "`along` in `film` of [outputs]".into(),
            Self::Interface(InterfaceOutput::Gap) => "`leakage` or `percolation` in [outputs]".into(),
            Self::Interface(output) => format!("`{}` in [outputs]", output.key()),
            Self::AnyStiffness => "a stiffness or the conductance in [outputs]".into(),
            Self::AnyTangentialStiffness => "a tangential stiffness in [outputs]".into(),
            Self::FrictionInPlane => {
                "`friction` in [effects] with a tangential load along y, or a model that answers one".into()
            }
            Self::Effect(key) => format!("`{key}` in [effects]"),
            Self::All(each) => each.iter().map(|asked| asked.words()).collect::<Vec<_>>().join(", "),
        }
    }
}

/// Unit of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuantityUnit {
    /// Text.
    Word,
    /// A pure number or a count.
    One,
    /// A unit of SI.
    Si(&'static str),
    /// The unit of the requested conductance, electrical or thermal.
    Conductance,
    /// The same per area.
    ConductancePerArea,
}

impl QuantityUnit {
    /// The unit in SI (`1` for a pure number, `-` for text).
    pub fn si(self, outputs: &Outputs) -> &'static str {
        match self {
            Self::Word => "-",
            Self::One => "1",
            Self::Si(unit) => unit,
            Self::Conductance if matches!(outputs.conductance, Conductance::Thermal { .. }) => "W/K",
            Self::Conductance => "S",
            Self::ConductancePerArea if matches!(outputs.conductance, Conductance::Thermal { .. }) => {
                "W/(m^2 K)"
            }
            Self::ConductancePerArea => "S/m^2",
        }
    }

    /// The unit as documents show it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Word => "-",
            Self::One => "1",
            Self::Si(unit) => unit,
            Self::Conductance => "S, W/K",
            Self::ConductancePerArea => "S/m^2, W/(m^2 K)",
        }
    }
}

/// The role of a quantity, which decides where it is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A result: shown wherever states are.
    Answer,
    /// A result in other units or divided by another quantity: in files, not in short tables.
    Normalised,
    /// A result about the path up to a state: that of its end is shown once, below the states.
    OfPath,
    /// A residual: how exactly the equations hold, with a text that says what it proves when it is small.
    Residual(&'static str),
    /// How the result was found, and its cost.
    Work,
}

/// How a quantity is averaged over surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Average {
    /// Arithmetic mean, with its standard error and the standard deviation of one surface.
    Mean,
    /// The same on every surface.
    Same,
    /// It is not averaged.
    No,
}

/// Whether the discretisation error of a quantity can be estimated from coarser grids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compared {
    /// With any boundary.
    Yes,
    /// With periodic boundaries and resolved waves only: elsewhere it may have no limit as cells shrink.
    Periodic,
    /// Not compared.
    No,
}

/// One quantity, with everything that tables, files and pictures need to know about it.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct StateQuantity {
    /// Its name in code, CSV, JSON and Python.
    pub name: &'static str,
    /// Its name in titles.
    pub words: &'static str,
    /// Its symbol, in the commands of TeX; may be empty.
    pub symbol: &'static str,
    /// Its unit.
    pub unit: QuantityUnit,
    /// Its meaning, in one sentence.
    pub meaning: &'static str,
    /// The publication that defines it, where it is not common knowledge; may be empty.
    pub source: &'static str,
    /// The condition under which it is in the tables.
    pub asked_by: AskedBy,
    /// Its role.
    pub role: Role,
    /// How it is averaged.
    pub average: Average,
    /// Whether its discretisation error is estimated.
    pub compared: Compared,
    /// Whether charts show it over the load.
    pub drawn: bool,
    /// Its value of a state; empty where the model does not claim it.
    pub value: fn(&ContactState, &Normalisation) -> Value,
    /// Names of the columns that belong to it: standard error of the mean, standard deviation of one surface;
    /// discretisation error, order of convergence; standard error and deviation of the mean discretisation
    /// error.
    pub columns: [&'static str; 6],
}

impl StateQuantity {
    /// The quantity of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        QUANTITIES.iter().find(|quantity| quantity.name == name)
    }

    /// Its value of a state, where that is a number.
    pub fn number(&self, state: &ContactState, normalisation: &Normalisation) -> Option<f64> {
        match (self.value)(state, normalisation) {
            Value::Number(number) => Some(number),
            Value::Count(count) => Some(count as f64),
            _ => None,
        }
    }

    /// Names of all columns of tables that belong to it.
    pub fn column_names(&self) -> impl Iterator<Item = &'static str> {
        std::iter::once(self.name).chain(self.columns)
    }
}

macro_rules! quantities {
    ($($name:literal $words:literal $symbol:literal $unit:expr; $asked:expr; $meaning:literal
       $({ $($field:ident: $setting:expr),+ $(,)? })?
       => $value:expr;)+) => {
        [$(StateQuantity {
            $($($field: $setting,)+)?
            ..StateQuantity {
                name: $name,
                words: $words,
                symbol: $symbol,
                unit: $unit,
                meaning: $meaning,
                source: "",
                asked_by: $asked,
                role: Role::Answer,
                average: Average::Mean,
                compared: Compared::No,
                drawn: true,
                value: $value,
                columns: [
                    concat!($name, "_se"),
                    concat!($name, "_sd"),
                    concat!($name, "_grid_error"),
                    concat!($name, "_grid_order"),
                    concat!($name, "_grid_error_se"),
                    concat!($name, "_grid_error_sd"),
                ],
            }
        },)+]
    };
}

use AskedBy::{
    All, Always, AnyStiffness, AnyTangentialStiffness, Effect, FreeBoundary, FrictionInPlane, Path,
    PrescribedDistance, RoughSurface,
};
use QuantityUnit::{One, Si, Word};

/// A path with adhesion.
const PULLED: &[AskedBy] = &[Path, Effect("adhesion")];

/// A viscoelastic history.
const VISCOELASTIC: AskedBy = Effect("rheology");

const LEAKAGE: AskedBy = AskedBy::Interface(InterfaceOutput::Leakage);
const PERCOLATION: AskedBy = AskedBy::Interface(InterfaceOutput::Percolation);
const STRESS_BELOW: AskedBy = AskedBy::Interface(InterfaceOutput::StressBelow);
const YIELD_STRESS: AskedBy = AskedBy::Interface(InterfaceOutput::YieldStress);
const FILM: AskedBy = AskedBy::Interface(InterfaceOutput::Film);
const FILM_ALONG: AskedBy = AskedBy::Interface(InterfaceOutput::FilmAlong);

/// A number of the leakage.
fn of_leakage(state: &ContactState, number: impl Fn(LeakageState) -> Option<f64>) -> Value {
    state.interface.leakage.and_then(number).into()
}

/// A number of the conduction through a film.
fn of_film(state: &ContactState, number: impl Fn(FilmState) -> Option<f64>) -> Value {
    state.interface.film.and_then(number).into()
}

/// A number of the paths along x or along y.
fn of_path(state: &ContactState, axis: usize, number: impl Fn(PathState) -> Option<f64>) -> Value {
    state.interface.percolation.and_then(|paths| number(paths[axis])).into()
}

/// A number of the largest stress.
fn of_stress(state: &ContactState, number: impl Fn(LargestStress) -> Option<f64>) -> Value {
    state.interface.stress.and_then(number).into()
}

/// 1 where it holds, so that the mean over surfaces is the share of them where it does.
fn as_number(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// Every quantity, in the order of the columns of tables.
pub static QUANTITIES: &[StateQuantity] = &quantities! {
    "time" "time" "t" Si("s"); Path; "time at the end of the step"
        { average: Average::Same, drawn: false }
        => |s, _| s.time.into();
    "force" "force" "F" Si("N"); Always; "normal force; negative where adhesion holds against a pull"
        => |s, _| s.force.into();
    "force_bar" "force" "\\bar{F}" One; RoughSurface; "F/(E* h L), L = sqrt(Lx Ly)"
        { role: Role::Normalised, source: "Pohrt, Popov, Filippov, Phys. Rev. E 86, 026710 (2012), Eq. 10", drawn: false }
        => |s, n| n.force_bar(s.force).ok().into();
    "approach" "approach" "d" Si("m"); FreeBoundary; "from first touch of the highest point"
        => |s, _| s.approach.into();
    "mean_gap" "mean gap" "\\bar{g}" Si("m"); AskedBy::Output(Output::MeanGap);
        "distance between the mean plane of the defined heights and that of the deformed half-space; without undefined points the mean \
         of the gap field; with them it may be negative"
        { compared: Compared::Yes }
        => |s, _| s.mean_gap.into();
    "whole_approach" "approach with the whole layer" "d" Si("m"); AskedBy::WholeLayer;
        "of the rigid body to the base from first touch: the fall of the mean gap and the compression of the whole layer under the mean \
         pressure; empty under an elastic body, whose half-space has no approach, and of a viscoelastic layer"
        => |s, _| s.whole_layer.map(|whole| whole.approach).into();
    "contact_radius" "contact radius" "a" Si("m"); Path;
        "of a round contact; of an equivalent profile that of the round contact of the same stiffness, k/(2 E*)"
        => |s, _| s.contact_radius.into();
    "tangential_force" "tangential force" "Q_x" Si("N"); Effect("friction"); "tangential force along x"
        => |s, _| s.tangential.map(|t| t.force[0]).into();
    "tangential_force_y" "tangential force along y" "Q_y" Si("N"); FrictionInPlane; "tangential force along y"
        => |s, _| s.tangential.map(|t| t.force[1]).into();
    "tangential_displacement" "tangential displacement" "\\delta_x" Si("m"); Effect("friction");
        "of the bodies relative to each other along x, far from the contact"
        => |s, _| s.tangential.map(|t| t.displacement[0]).into();
    "tangential_displacement_y" "tangential displacement along y" "\\delta_y" Si("m"); FrictionInPlane;
        "of the bodies relative to each other along y, far from the contact"
        => |s, _| s.tangential.map(|t| t.displacement[1]).into();
    "sliding_force" "sliding force" "" Si("N"); Effect("friction");
        "tangential force at which the whole contact slips: the largest tractions of all cells in contact together, by Coulomb's law \
         the coefficient of friction times the normal force"
        { drawn: false }
        => |s, _| s.tangential.and_then(|t| t.sliding_force).into();
    "stick_area" "stick area" "" Si("m^2"); AskedBy::Output(Output::StickArea);
        "area of the contact whose traction is below the limit of friction"
        => |s, _| s.tangential.and_then(|t| t.stick_area).into();
    "slip_area" "slip area" "" Si("m^2"); AskedBy::Output(Output::StickArea);
        "area of the contact whose traction is at the limit of friction"
        => |s, _| s.tangential.and_then(|t| t.slip_area).into();
    "tangential_stiffness" "tangential stiffness" "k_{xx}" Si("N/m"); AskedBy::Output(Output::TangentialStiffness);
        "dQ_x/ddelta_x along the branch of states at fixed pressures: cells that stick continue to stick, cells that slip continue to slip; \
         a step in which nothing moves keeps which of them slipped in the last one that moved"
        => |s, _| s.tangential.and_then(|t| t.stiffness).map(|k| k[0][0]).into();
    "tangential_stiffness_xy" "tangential stiffness, x of y" "k_{xy}" Si("N/m"); AskedBy::Output(Output::TangentialStiffness);
        "dQ_x/ddelta_y of the same; it is dQ_y/ddelta_x too"
        { drawn: false }
        => |s, _| s.tangential.and_then(|t| t.stiffness).map(|k| k[0][1]).into();
    "tangential_stiffness_y" "tangential stiffness along y" "k_{yy}" Si("N/m"); AskedBy::Output(Output::TangentialStiffness);
        "dQ_y/ddelta_y of the same"
        => |s, _| s.tangential.and_then(|t| t.stiffness).map(|k| k[1][1]).into();
    "tangential_stiffness_stuck" "tangential stiffness, sticking" "k_{xx}" Si("N/m"); AskedBy::Output(Output::TangentialStiffnessStuck);
        "dQ_x/ddelta_x with the whole contact sticking: the first answer after a reversal"
        => |s, _| s.tangential.and_then(|t| t.stiffness_stuck).map(|k| k[0][0]).into();
    "tangential_stiffness_stuck_xy" "tangential stiffness, sticking, x of y" "k_{xy}" Si("N/m");
        AskedBy::Output(Output::TangentialStiffnessStuck);
        "dQ_x/ddelta_y of the same; it is dQ_y/ddelta_x too"
        { drawn: false }
        => |s, _| s.tangential.and_then(|t| t.stiffness_stuck).map(|k| k[0][1]).into();
    "tangential_stiffness_stuck_y" "tangential stiffness along y, sticking" "k_{yy}" Si("N/m");
        AskedBy::Output(Output::TangentialStiffnessStuck);
        "dQ_y/ddelta_y of the same"
        => |s, _| s.tangential.and_then(|t| t.stiffness_stuck).map(|k| k[1][1]).into();
    "stick_radius" "stick radius" "c" Si("m"); Effect("friction"); "radius inside which nothing slips"
        => |s, _| s.tangential.and_then(|t| t.stick_radius).into();
    "dissipated" "energy dissipated by friction" "" Si("J"); Effect("friction"); "energy lost to friction since the first step"
        => |s, _| s.tangential.map(|t| t.dissipated).into();
    "plastic_area" "area under the hardness" "" Si("m^2"); Effect("hardness"); "area under the hardness"
        => |s, _| s.plastic.map(|p| p.area).into();
    "plastic_volume" "volume of the plastic indentation" "" Si("m^3"); Effect("hardness");
        "volume of the plastic indentation, since the virgin surface"
        => |s, _| s.plastic.map(|p| p.volume).into();
    "plastic_work" "plastic work" "" Si("J"); Effect("hardness"); "energy dissipated in the plastic indentation, hardness times volume"
        => |s, _| s.plastic.map(|p| p.dissipated).into();
    "work" "work of the load" "W" Si("J"); VISCOELASTIC;
        "work of the normal load since the first step: what the body holds and what has been dissipated in it; periodic by the fall of \
         the mean gap, without the compression of a whole layer"
        => |s, _| s.viscoelastic.and_then(|v| v.work).into();
    "branch" "branch" "" Word; Effect("adhesion"); "whether the bodies were brought nearer or drawn apart"
        { average: Average::No, drawn: false }
        => |s, _| s.adhesive.map(|a| a.branch.as_str()).into();
    "energy" "energy" "" Si("J"); Effect("adhesion"); "elastic energy less the work of adhesion done, of elastic bodies"
        => |s, _| s.adhesive.and_then(|a| a.energy).into();
    "stability" "stability" "" One; Effect("adhesion");
        "a minimum of the energy where > 0: its least curvature over that without adhesion"
        { drawn: false }
        => |s, _| s.adhesive.map(|a| a.stability).into();
    "pull_off" "largest pull" "" Si("N"); All(PULLED);
        "largest pull of the path so far: the most negative normal force of its loads, with a positive sign; at most the pull-off force"
        { role: Role::OfPath, drawn: false }
        => |s, _| s.pull_off.map(|p| p.force).into();
    "pull_off_error" "error of the largest pull" "" Si("N"); All(PULLED);
        "upper bound of the remaining error: the pull-off force is at most pull_off + pull_off_error; empty where no load is beyond it"
        { role: Role::OfPath, drawn: false }
        => |s, _| s.pull_off.and_then(|p| p.error).into();
    "pull_off_approach" "approach at the largest pull" "" Si("m"); All(&[Path, Effect("adhesion"), FreeBoundary]);
        "approach at which the path pulled most"
        { role: Role::OfPath, drawn: false }
        => |s, _| s.pull_off.and_then(|p| p.approach).into();
    "pull_off_mean_gap" "mean gap at the largest pull" "" Si("m");
        All(&[Effect("adhesion"), AskedBy::Output(Output::MeanGap), Path]);
        "mean gap at which the path pulled most"
        { role: Role::OfPath, drawn: false }
        => |s, _| s.pull_off.and_then(|p| p.mean_gap).into();
    "stiffness" "stiffness" "k" Si("N/m"); AskedBy::Output(Output::Stiffness);
        "dF/dd along the branch of states (periodic: -dF/d(mean gap)): fronts of an adhesive contact move, saturated cells flow; \
         with full coupling the tangential load is held"
        { compared: Compared::Yes }
        => |s, _| s.stiffness.into();
    "whole_stiffness" "stiffness with the whole layer" "k" Si("N/m"); All(&[AskedBy::WholeLayer, AskedBy::Output(Output::Stiffness)]);
        "dF/dd of the approach with the whole layer along the branch of states; of an elastic layer under a rigid body"
        => |s, _| s.whole_layer.and_then(|whole| whole.stiffness).into();
    "stiffness_bar" "stiffness" "\\bar{k}" One; AskedBy::Output(Output::Stiffness);
        "k/(1.1419 E* L) of this stiffness, L = sqrt(Lx Ly)"
        { role: Role::Normalised, source: "Pohrt, Popov, Filippov, Phys. Rev. E 86, 026710 (2012), Eq. 8", drawn: false }
        => |s, n| s.stiffness.map(|k| n.stiffness_bar(k)).into();
    "stiffness_fixed_area" "stiffness at fixed contact area" "k" Si("N/m"); AskedBy::Output(Output::StiffnessFixedArea);
        "stiffness at fixed contact area: all cells in contact stay bonded (periodic: -dF/d(mean gap))"
        { compared: Compared::Yes }
        => |s, _| s.stiffness_fixed_area.into();
    "area" "contact area" "A" Si("m^2"); AskedBy::Output(Output::Area); "real contact area"
        { compared: Compared::Yes }
        => |s, _| s.area.into();
    "area_corrected" "corrected area" "A" Si("m^2"); AskedBy::Output(Output::Area);
        "area corrected for the cells at its boundary (Yastrebov et al. 2017); with a hardness at least the force over the hardness"
        { compared: Compared::Yes, source: "Yastrebov, Anciaux, Molinari, Tribol. Int. 114, 161 (2017)", drawn: false }
        => |s, _| s.resolution.and_then(|r| r.corrected_area).into();
    "contact_fraction" "contact fraction" "A/A_0" One; AskedBy::Output(Output::Area); "A/(Lx Ly), undefined points included"
        { drawn: false }
        => |s, n| s.area.map(|a| n.contact_fraction(a)).into();
    "conductance" "conductance" "Λ" QuantityUnit::Conductance; AskedBy::Output(Output::Conductance);
        "2 k/(E* (rho_1 + rho_2)) with the stiffness at fixed contact area (Barber)"
        { compared: Compared::Yes, source: "Barber, Proc. R. Soc. A 459, 53 (2003)" }
        => |s, _| s.conductance.into();
    "film_conductance" "conductance with the film" "Λ" QuantityUnit::Conductance; All(&[FILM, FreeBoundary]);
        "current through the sample per potential difference far away: through the contact and the film in the gap, which share the \
         resistance of the bodies"
        { compared: Compared::Yes }
        => |s, _| of_film(s, |f| Some(f.through));
    "film_conductance_per_area" "conductance with the film, per area" "Λ/A_0" QuantityUnit::ConductancePerArea;
        All(&[FILM, AskedBy::PeriodicBoundary]);
        "conductance of the interface per nominal area, through the contact and the film in the gap; the resistance of the bodies above \
         and below adds to its own"
        { compared: Compared::Yes }
        => |s, _| of_film(s, |f| Some(f.through));
    "film_conductance_along" "conductance of the film along the interface" "Λ" QuantityUnit::Conductance; FILM_ALONG;
        "current in the film between opposite edges of the map per potential difference, a cell conducting as its gap; the contact and the \
         bodies carry none of it"
        { compared: Compared::Yes }
        => |s, _| of_film(s, |f| f.along.map(|(along, _)| along));
    "leakage" "leakage" "Q" Si("m^3/s"); LEAKAGE;
        "flow of the fluid through the network of the cells under the pressure drop; a cell conducts as its gap cubed"
        { compared: Compared::Yes }
        => |s, _| of_leakage(s, |l| Some(l.flow));
    "leakage_lower" "lower bound of the leakage" "Q" Si("m^3/s"); LEAKAGE;
        "proven lower bound of the flow through the continuum with a constant gap in each cell"
        { drawn: false }
        => |s, _| of_leakage(s, |l| Some(l.continuum[0]));
    "leakage_upper" "upper bound of the leakage" "Q" Si("m^3/s"); LEAKAGE;
        "proven upper bound of the flow through the continuum with a constant gap in each cell"
        { drawn: false }
        => |s, _| of_leakage(s, |l| Some(l.continuum[1]));
    "flow_factor" "flow factor" "" One; LEAKAGE;
        "leakage over the flow between smooth surfaces at the mean gap, where cells in contact count as 0"
        { compared: Compared::Yes, source: "Patir and Cheng, J. Lubr. Technol. 100, 12 (1978)" }
        => |s, _| of_leakage(s, |l| l.flow_factor);
    "open_along_x" "open path along x" "" One; PERCOLATION;
        "1 where cells with a gap, joined by edges, lead between the opposite edges along x, otherwise 0"
        { drawn: false }
        => |s, _| of_path(s, 0, |p| Some(as_number(p.open)));
    "open_along_y" "open path along y" "" One; PERCOLATION;
        "1 where cells with a gap, joined by edges, lead between the opposite edges along y, otherwise 0"
        { drawn: false }
        => |s, _| of_path(s, 1, |p| Some(as_number(p.open)));
    "contact_along_x" "path of contact along x" "" One; PERCOLATION;
        "1 where cells in contact, joined by edges, lead between the opposite edges along x, otherwise 0"
        { drawn: false }
        => |s, _| of_path(s, 0, |p| Some(as_number(p.contact)));
    "contact_along_y" "path of contact along y" "" One; PERCOLATION;
        "1 where cells in contact, joined by edges, lead between the opposite edges along y, otherwise 0"
        { drawn: false }
        => |s, _| of_path(s, 1, |p| Some(as_number(p.contact)));
    "constriction_x" "critical constriction along x" "g_c" Si("m"); PERCOLATION;
        "gap of the critical constriction along x, the narrowest cell of the widest path; 0 where the contact closes every path"
        => |s, _| of_path(s, 0, |p| Some(p.constriction));
    "constriction_x_at_x" "place x of the constriction along x" "" Si("m"); PERCOLATION;
        "centre of this cell, along x; empty where the contact closes every path"
        { average: Average::No, drawn: false }
        => |s, _| of_path(s, 0, |p| p.centre.map(|centre| centre[0]));
    "constriction_x_at_y" "place y of the constriction along x" "" Si("m"); PERCOLATION;
        "centre of this cell, along y; empty where the contact closes every path"
        { average: Average::No, drawn: false }
        => |s, _| of_path(s, 0, |p| p.centre.map(|centre| centre[1]));
    "constriction_y" "critical constriction along y" "g_c" Si("m"); PERCOLATION;
        "gap of the critical constriction along y, the narrowest cell of the widest path; 0 where the contact closes every path"
        => |s, _| of_path(s, 1, |p| Some(p.constriction));
    "constriction_y_at_x" "place x of the constriction along y" "" Si("m"); PERCOLATION;
        "centre of this cell, along x; empty where the contact closes every path"
        { average: Average::No, drawn: false }
        => |s, _| of_path(s, 1, |p| p.centre.map(|centre| centre[0]));
    "constriction_y_at_y" "place y of the constriction along y" "" Si("m"); PERCOLATION;
        "centre of this cell, along y; empty where the contact closes every path"
        { average: Average::No, drawn: false }
        => |s, _| of_path(s, 1, |p| p.centre.map(|centre| centre[1]));
    "largest_von_mises" "largest stress below the surface" "" Si("Pa"); STRESS_BELOW;
        "largest equivalent stress of von Mises at the centres of cells, in the requested range of depths"
        { compared: Compared::Yes }
        => |s, _| of_stress(s, |l| Some(l.von_mises));
    "largest_von_mises_depth" "depth of the largest stress" "z" Si("m"); STRESS_BELOW;
        "depth of this stress below the surface"
        => |s, _| of_stress(s, |l| Some(l.depth));
    "largest_von_mises_x" "place x of the largest stress" "" Si("m"); STRESS_BELOW;
        "centre of the cell of this stress, along x"
        { average: Average::No, drawn: false }
        => |s, _| of_stress(s, |l| Some(l.centre[0]));
    "largest_von_mises_y" "place y of the largest stress" "" Si("m"); STRESS_BELOW;
        "centre of the cell of this stress, along y"
        { average: Average::No, drawn: false }
        => |s, _| of_stress(s, |l| Some(l.centre[1]));
    "factor_until_yield" "factor until yield" "" One; YIELD_STRESS;
        "yield stress over this stress: the factor on all pressures and tractions at which the body yields first"
        => |s, _| of_stress(s, |l| l.factor_until_yield);
    "patches" "number of contacts" "" One; AskedBy::Output(Output::ContactPatches); "connected contact areas, cells joined by an edge"
        => |s, _| s.patches.as_ref().map(crate::Patches::count).into();
    "largest_patch" "area of the largest contact" "" Si("m^2"); AskedBy::Output(Output::ContactPatches); "area of the largest patch"
        => |s, _| s.patches.as_ref().and_then(|p| p.areas().first().copied()).into();
    "largest_pressure" "largest pressure" "p_{\\rm{max}}" Si("Pa"); Always;
        "of a cell, or at a point by a closed form; that of a cell grows with smaller cells until they resolve the shortest wave, at an edge of \
         the rectangle or a spike without limit"
        { compared: Compared::Periodic }
        => |s, _| s.resolution.and_then(|r| r.largest_pressure).into();
    "status" "status" "" Word; Always; "how the solve ended"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.report.status.as_str().into();
    "strategy" "strategy" "" Word; Always; "method that the solver used"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.report.strategy.as_str().into();
    "contact_cells" "contact cells" "" One; Always; "cells or elements in contact; with fewer than 10 the result depends on the grid"
        { average: Average::No, drawn: false }
        => |s, _| s.report.contact_cells.into();
    "iterations" "iterations" "" One; Always; "of the linear solvers"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.report.iterations.into();
    "applications" "operator applications" "" One; Always; "of the elastic operator"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.report.applications.into();
    "linear_solves" "linear solves" "" One; Always; "linear systems solved"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.report.work.linear_solves.into();
    "time_steps" "steps of time" "" One; VISCOELASTIC; "of a viscoelastic history that is solved cell by cell, since the state before"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.viscoelastic.map(|v| v.time_steps).into();
    "fields" "fields" "" One; Always; "fields over the grid that the state holds"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.report.work.fields.into();
    "field_bytes" "bytes of fields" "" One; Always; "bytes of these fields"
        { role: Role::Work, average: Average::No, drawn: false }
        => |s, _| s.report.work.bytes.into();
    "duality_gap" "duality gap" "" One; Always; "sum p (g - min g)/(F s)"
        { role: Role::Residual("the pressure minimises the elastic energy: by how much it could still fall, over force times rms height"),
          average: Average::No, drawn: false }
        => |s, _| s.report.certificate.duality_gap.into();
    "penetration" "penetration" "" One; Always; "max(0, -min g)/s"
        { role: Role::Residual("no cell penetrates the other body: the deepest, over the rms height"), average: Average::No, drawn: false }
        => |s, _| s.report.certificate.penetration.into();
    "complementarity" "complementarity" "" One; Always; "sum p |g|/(F s)"
        { role: Role::Residual("where there is pressure there is no gap"), average: Average::No, drawn: false }
        => |s, _| s.report.certificate.complementarity.into();
    "load_error" "load error" "" One; Always;
        "|F - F_prescribed|/F_prescribed, with adhesion at least over 1e-3 of the force of the contact pressure; of a mean gap its error over s"
        { role: Role::Residual("the force, or the mean gap, is the prescribed one"), average: Average::No, drawn: false }
        => |s, _| s.report.certificate.load_error.into();
    "force_error" "error of the force" "" One; PrescribedDistance;
        "bound of the relative error of the force under a prescribed approach or mean gap; an estimate with adhesion"
        { role: Role::Residual("a bound of the relative error of the force under a prescribed approach or mean gap; an estimate with adhesion"),
          average: Average::No, drawn: false }
        => |s, _| s.report.certificate.force_error.into();
    "force_time_error" "error of the force by steps of time" "" One; VISCOELASTIC;
        "estimated relative error of the force by steps of time: its difference from that of the same history in steps twice as long"
        { role: Role::Residual("steps of time are short enough for the force: its relative difference from that of steps twice as long"),
          average: Average::No, drawn: false }
        => |s, _| s.viscoelastic.map(|v| v.force_time_error).into();
    "approach_time_error" "error of the approach by steps of time" "" One; AskedBy::All(&[FreeBoundary, VISCOELASTIC]);
        "estimated relative error of the approach by steps of time: its difference from that of the same history in steps twice as long"
        { role: Role::Residual("steps of time are short enough for the approach: its relative difference from that of steps twice as long"),
          average: Average::No, drawn: false }
        => |s, _| s.approach.and(s.viscoelastic).map(|v| v.distance_time_error).into();
    "mean_gap_time_error" "error of the mean gap by steps of time" "" One;
        AskedBy::All(&[AskedBy::Output(Output::MeanGap), VISCOELASTIC]);
        "estimated relative error of the mean gap by steps of time: its difference from that of the same history in steps twice as long"
        { role: Role::Residual("steps of time are short enough for the mean gap: its relative difference from that of steps twice as long"),
          average: Average::No, drawn: false }
        => |s, _| s.mean_gap.and(s.viscoelastic).map(|v| v.distance_time_error).into();
    "area_time_error" "error of the area by steps of time" "" One; AskedBy::All(&[AskedBy::Output(Output::Area), VISCOELASTIC]);
        "estimated relative error of the area by steps of time: the difference of the number of cells from that of the same history in steps twice as long"
        { role: Role::Residual("steps of time are short enough for the area: the relative difference of the number of cells from that of steps twice as long"),
          average: Average::No, drawn: false }
        => |s, _| s.viscoelastic.map(|v| v.area_time_error).into();
    "tangential_force_time_error" "error of the tangential force by steps of time" "" One; AskedBy::All(&[FrictionInPlane, VISCOELASTIC]);
        "estimated relative error of the tangential force by steps of time: its difference from that of the same history in steps twice as long"
        { role: Role::Residual("steps of time are short enough for the tangential force: its relative difference from that of steps twice as long"),
          average: Average::No, drawn: false }
        => |s, _| s.viscoelastic.and_then(|v| v.tangential_time_errors).map(|[force, _]| force).into();
    "tangential_displacement_time_error" "error of the tangential displacement by steps of time" "" One;
        AskedBy::All(&[FrictionInPlane, VISCOELASTIC]);
        "estimated relative error of the tangential displacement by steps of time: its difference from that of the same history in steps \
         twice as long"
        { role: Role::Residual("steps of time are short enough for the tangential displacement: its relative difference from that of steps \
                                twice as long"),
          average: Average::No, drawn: false }
        => |s, _| s.viscoelastic.and_then(|v| v.tangential_time_errors).map(|[_, displacement]| displacement).into();
    "leakage_error" "error of the leakage" "" One; LEAKAGE;
        "proven relative error of the flow through the network of the cells: half of the distance between its bounds, over the flow"
        { role: Role::Residual("the flow through the network of the cells lies between two proven bounds: half of their distance, over the flow"),
          average: Average::No, drawn: false }
        => |s, _| of_leakage(s, |l| Some(l.error));
    "film_conductance_error" "error of the conductance with the film" "" One; FILM;
        "proven relative error of the conductance through the contact and the film on these cells: half of the distance between its bounds, \
         over the conductance"
        { role: Role::Residual("the conductance of the equations on the cells lies between two proven bounds: half of their distance, over the \
                                conductance"),
          average: Average::No, drawn: false }
        => |s, _| of_film(s, |f| Some(f.error));
    "film_conductance_along_error" "error of the conductance along the film" "" One; FILM_ALONG;
        "proven relative error of the conductance through the network of the cells: half of the distance between its bounds, over the \
         conductance"
        { role: Role::Residual("the conductance of the network of the cells lies between two proven bounds: half of their distance, over the \
                                conductance"),
          average: Average::No, drawn: false }
        => |s, _| of_film(s, |f| f.along.map(|(_, error)| error));
    "leakage_contact_error" "error of the leakage by the gap" "" One; LEAKAGE;
        "relative error of the leakage by the solve of the contact: half of the difference between the flows with all gaps larger and smaller by `gap_error`, over the flow; empty where that is not known"
        { role: Role::Residual("the contact is solved well enough for the leakage: what the error of the gap changes in it, over the flow"),
          average: Average::No, drawn: false }
        => |s, _| of_leakage(s, |l| l.contact_error);
    "gap_error" "error of the gap" "" Si("m"); AskedBy::Interface(InterfaceOutput::Gap);
        "how far the gap of any cell is at most from that of the exact solution on the same cells; known for elastic half-spaces \
         without adhesion and hardness, under a force or an approach"
        { role: Role::Residual("the gap of each cell is that of the exact solution on these cells: the largest difference that is possible"),
          average: Average::No, drawn: false }
        => |s, _| s.interface.gap_error.into();
    "equilibrium" "equilibrium" "" One; Effect("adhesion");
        "largest difference of an attraction from the law of its gap, over the traction in contact"
        { role: Role::Residual("the attraction of each cell is what the law says of its gap: the largest difference, over the largest traction"),
          average: Average::No, drawn: false }
        => |s, _| s.report.certificate.equilibrium.into();
    "tangential_duality_gap" "tangential duality gap" "" One; FrictionInPlane;
        "sum (b |w| - w . q)/(B D) of the last step, solved cell by cell, with the largest traction b of a cell (mu p by Coulomb's law) \
         and their sum B, the sliding force; D is the larger of |delta - m| and the largest |s - m|, with the mean m, weighted by b, \
         of the displacements s from which the slip of the cells counts"
        { role: Role::Residual("the tractions minimise the elastic energy of the step of friction: by how much it could still fall, over sliding force \
                                times tangential displacement, without how far the contact has slid before"),
          average: Average::No, drawn: false }
        => |s, _| s.report.certificate.tangential_duality_gap.into();
    "tangential_load_error" "tangential load error" "" One; FrictionInPlane; "|Q - Q_prescribed| over the sliding force, solved cell by cell"
        { role: Role::Residual("the tangential force is the prescribed one, relative to the sliding force"),
          average: Average::No, drawn: false }
        => |s, _| s.report.certificate.tangential_load_error.into();
    "tangential_stiffness_error" "error of the tangential stiffness" "" One; AnyTangentialStiffness;
        "estimated relative error of the tangential stiffness"
        { role: Role::Residual("an estimate of the relative error of the tangential stiffness, on these cells"),
          average: Average::No, drawn: false }
        => |s, _| s.report.certificate.tangential_stiffness_error.into();
    "stiffness_error" "error of the stiffness" "" One; AnyStiffness;
        "estimated relative error of the stiffness; that of a difference quotient with full coupling, and with adhesion of \
         short range and Dugdale's law, where the cells decide it and not the tolerance"
        { role: Role::Residual("an estimate of the relative error of the stiffness, on these cells"), average: Average::No, drawn: false }
        => |s, _| s.report.certificate.error_of_stiffness().into();
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effect as NamedEffect;

    #[test]
    fn names_are_words_and_stand_once() {
        let mut names: Vec<&str> = QUANTITIES.iter().flat_map(StateQuantity::column_names).collect();
        let letter = |c: char| c.is_ascii_lowercase() || c == '_';
        assert!(names.iter().all(|name| name.chars().all(letter)), "{names:?}");
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn every_quantity_says_what_it_is_and_is_asked_for_by_something() {
        for quantity in QUANTITIES {
            assert!(!quantity.meaning.is_empty() && !quantity.words.is_empty(), "{}", quantity.name);
            if let Effect(key) = quantity.asked_by {
                assert!(NamedEffect::ALL.iter().any(|effect| effect.key() == key), "{key}");
            }
            // A text is neither averaged nor drawn.
            let text = quantity.unit == Word;
            assert!(!text || quantity.average == Average::No && !quantity.drawn, "{}", quantity.name);
        }
    }

    #[test]
    fn every_output_but_a_field_has_a_quantity() {
        for &output in Output::ALL.iter().filter(|output| !output.is_field()) {
            assert!(
                QUANTITIES.iter().any(|quantity| quantity.asked_by == AskedBy::Output(output)),
                "{}: no quantity in the table is asked for by it",
                output.name()
            );
        }
        let mut outputs = Outputs::default();
        for &output in Output::ALL {
            assert!(!outputs.asks(output));
            outputs.ask(output, true);
            assert_eq!(outputs.asks(output), output != Output::Conductance);
        }
    }
}
