//! Names of scenes, loads, units and models in titles and labels.

use crate::models::ModelRecord;
use crate::scenes::read::{LoadRequest, PrescribedLoad, SceneFile, System, amount, short};
use contact_model::units::{ascii, to_digits};
use contact_model::{Body, Error, Hardness, NormalLoad, Rheology};
use std::path::Path;

/// The scene's name in a title: that of its file or, for `NAME/scene.toml`, that of its folder.
pub(crate) fn scene_name(scene: &SceneFile) -> String {
    let folder = scene.path.parent().and_then(Path::file_name).filter(|_| scene.path.ends_with("scene.toml"));
    let name = folder.or_else(|| scene.path.file_stem());
    name.map_or_else(String::new, |n| n.to_string_lossy().replace(['-', '_'], " "))
}

/// A load in words, with its unit; a step of a path by its number.
pub(crate) fn load(scene: &SceneFile, state: usize) -> String {
    match &scene.request {
        LoadRequest::Loads(loads) => {
            let unit = if loads.kind == PrescribedLoad::ForceBar {
                ""
            } else {
                scene.system.shown(loads.kind.unit())
            };
            format!("{} {}", loads.kind.key().replace('_', " "), amount(loads.values[state], unit))
        }
        LoadRequest::Path(_) => format!("step {state}"),
    }
}

/// Poisson's ratio of the examples that say what a contact modulus means.
const EXAMPLE_POISSON: f64 = 0.3;

/// E* of a scene with its bodies: the two that are given, or else examples of bodies with this E*, because E*
/// is easily mistaken for a Young's modulus.
pub(crate) fn contact_modulus(scene: &SceneFile) -> String {
    let unit = scene.system.shown("Pa");
    let modulus = ascii(&amount(scene.contact_modulus, unit));
    let body = |body: Body| match body {
        Body::Elastic { young, poisson } => {
            format!("a body with E = {}, nu = {}", ascii(&amount(young, unit)), short(poisson))
        }
        _ => "a rigid body".to_owned(),
    };
    match (&scene.pair, scene.system) {
        (Some(pair), _) => format!("E* = {modulus}: {} on {}", body(pair.first), body(pair.second)),
        (None, System::None) => format!("E* = {modulus}"),
        // Viscosities are those of an incompressible body.
        (None, System::Si) if scene.effects.rheology != Rheology::Elastic => {
            let young = ascii(&to_digits(0.75 * scene.contact_modulus, unit, 3));
            format!("E* = {modulus}: an incompressible body with E = {young} on a rigid one")
        }
        (None, System::Si) => {
            let plane_strain = 1.0 - EXAMPLE_POISSON * EXAMPLE_POISSON;
            let [alike, on_rigid] = [2.0, 1.0]
                .map(|bodies| ascii(&to_digits(bodies * plane_strain * scene.contact_modulus, unit, 3)));
            format!(
                "E* = {modulus}: two like bodies with E = {alike}, or one with E = {on_rigid} on a rigid one (nu = {EXAMPLE_POISSON})"
            )
        }
    }
}

/// That the bodies come apart on the way to a force.
pub(crate) fn pull_off(scene: &SceneFile, force: f64) -> String {
    let force = ascii(&amount(force, scene.system.shown("N")));
    format!("pull-off before the force {force}; the last stable state")
}

/// That the bodies come apart under a load by itself.
pub(crate) fn no_state(scene: &SceneFile, state: usize) -> String {
    format!(
        "no state under the {}: the attraction cannot hold it, and the bodies come apart",
        ascii(&load(scene, state))
    )
}

/// Why a model refuses a load, with the units of the scene.
pub(crate) fn refusal(scene: &SceneFile, error: &Error) -> String {
    /// Beginnings of the names of quantities, with their SI units.
    const UNITS: [(&str, &str); 9] = [
        ("force", "N"),
        ("tangential force", "N"),
        ("approach", "m"),
        ("mean gap", "m"),
        ("contact radius", "m"),
        ("mean pressure", "Pa"),
        ("hardness", "Pa"),
        ("side of a cell", "m"),
        ("work of adhesion", "J/m^2"),
    ];
    let (Error::OutOfRange { name, .. } | Error::Domain { name, .. }) = error else {
        return error.to_string();
    };
    let of = |(quantity, _): &&(&str, &str)| {
        name.strip_prefix(quantity).is_some_and(|rest| rest.is_empty() || rest.starts_with(" ("))
    };
    let Some((_, unit)) = UNITS.iter().find(of) else { return error.to_string() };
    let unit = scene.system.shown(unit);
    let (value, min, max) = match error {
        Error::OutOfRange { value, min, max, .. } => (value, min, max),
        // A number in the text would lack the unit.
        Error::Domain { value, expected, .. } if !expected.contains(|c: char| c.is_ascii_digit()) => {
            return format!("{name} = {}: expected {expected}", ascii(&amount(*value, unit)));
        }
        _ => return error.to_string(),
    };
    // As many digits as are needed to distinguish the value from the limits.
    let told = |digits| [value, min, max].map(|v| ascii(&to_digits(*v, unit, digits)));
    let apart = |digits: &usize| {
        let [value, min, max] = told(*digits);
        value != min && value != max
    };
    let [value, low, high] = told((4..17).find(apart).unwrap_or(17));
    let range = match (min.is_finite(), max.is_finite()) {
        (true, false) => format!("below {low}, the smallest value for which the model holds"),
        (false, true) => format!("above {high}, the largest value for which the model holds"),
        _ => format!("outside {low} to {high}, the range in which the model holds"),
    };
    let hardness = match scene.effects.hardness {
        Hardness::Limit { pressure } if name.contains("hardness") => {
            format!("; the hardness is {}", ascii(&amount(pressure, scene.system.shown("Pa"))))
        }
        _ => String::new(),
    };
    format!("{name} = {value} is {range}{hardness}")
}

/// Why a model refuses this load of a surface with this rms height. A theory counts it over a scale of the surface;
/// the load itself and the largest or smallest one of the theory stand beside that number.
pub(crate) fn refusal_of_load(
    scene: &SceneFile,
    rms_height: Option<f64>,
    load: Option<NormalLoad>,
    error: &Error,
) -> String {
    let told = refusal(scene, error);
    let Error::OutOfRange { name, value, min, max } = error else { return told };
    let size = scene.surface.size();
    let (load, scale, unit) = match (load, rms_height) {
        // The scale of a pressure follows from the load itself; a load of zero is not beyond a largest one.
        (Some(NormalLoad::Force(force)), _) if name.starts_with("mean pressure over") && *value > 0.0 => {
            let pressure = force / (size.x * size.y);
            (pressure, pressure / value, "Pa")
        }
        (Some(NormalLoad::MeanGap(gap)), Some(height)) if name.starts_with("mean gap over rms height") => {
            (gap, height, "m")
        }
        _ => return told,
    };
    let (bound, end) = if value > max { ("at most", max) } else { ("at least", min) };
    let [load, end] = [load, scale * end].map(|v| ascii(&amount(v, scene.system.shown(unit))));
    format!("{told}: here {load}, and {bound} {end} in this model")
}

/// A unit with its powers as superscripts, such as `m^2` and `W/K`.
pub(crate) fn unit_label(unit: &str) -> String {
    format!("$\\rm{{{unit}}}$")
}

/// Name of a model in titles and texts.
pub(crate) fn model_name(name: &str) -> &str {
    ModelRecord::named(name).map_or(name, |record| record.title)
}
