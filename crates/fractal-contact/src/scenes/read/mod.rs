//! Reads a scene from TOML into typed values, and reports each mistake with its place.

pub(crate) mod accuracy_target;
pub(crate) mod asked_surface;
pub(crate) mod diagnostic;
pub(crate) mod distributed;
pub(crate) mod effects;
pub(crate) mod entries;
pub(crate) mod error;
pub(crate) mod generated_surface;
pub(crate) mod interface_outputs;
pub(crate) mod key;
pub(crate) mod load_kind;
pub(crate) mod loads;
pub(crate) mod missing_keys;
pub(crate) mod numerics;
pub(crate) mod other_words;
pub(crate) mod outputs;
pub(crate) mod path;
pub(crate) mod places;
pub(crate) mod printed;
pub(crate) mod question;
pub(crate) mod random_surface;
pub(crate) mod registered_model;
pub(crate) mod registry;
pub(crate) mod sampled;
pub(crate) mod scan;
pub(crate) mod scene_file;
pub(crate) mod scene_surface;
pub(crate) mod words;

pub(crate) use accuracy_target::RequestedAccuracy;
pub(crate) use contact_model::units::{amount, multiple, number, short};
pub(crate) use diagnostic::Diagnostic;
pub(crate) use distributed::{Bin, Distributed};
pub(crate) use effects::{EFFECT_KEYS, EffectLine, effect_lines, read_effects};
pub(crate) use entries::{Entries, Entry, LengthOrPair, ReadResult, System, nearest, suggestion};
pub(crate) use error::{Error, Result};
pub(crate) use interface_outputs::{
    FilmMaterial, RequestedFilm, RequestedInterface, RequestedLeakage, RequestedStress, SECTION_DEPTHS,
};
pub(crate) use load_kind::PrescribedLoad;
pub(crate) use loads::{LoadList, LoadRequest};
pub(crate) use numerics::{MOST_CELLS, Numerics};
pub(crate) use outputs::{
    FLUID_PRESSURE, FLUX, FieldFormat, HEIGHTS, RequestedOutputs, STRESS_COMPONENTS, STRESS_SECTION,
    STRESS_VOLUME, all_fields, read_outputs,
};
pub(crate) use path::{PathPiece, cycles, step_to};
pub(crate) use places::Places;
pub(crate) use question::Question;
pub(crate) use random_surface::{
    Drawn, RandomSpectrum, RandomSurface, describe_self_affine, describe_sides, map_key,
};
pub(crate) use registered_model::RegisteredModel;
pub(crate) use registry::Registry;
pub(crate) use sampled::{sampled, sampled_cells};
pub(crate) use scan::{Remark, description, exchanged_sides, remarks, spike};
pub(crate) use scene_file::{SceneFile, cells, depends_on_path};
pub(crate) use scene_surface::SceneSurface;
