//! The form of the page: every key of a scene, and what the models can do.

use contact_model::{FIELDS, Output};
use fractal_contact::scenes::{EFFECT_KEYS, Numerics, scene_keys};
use serde_json::{Value, json};

/// The form as JSON: `{"version", "keys", "effects", "outputs", "models"}`.
pub(crate) fn form() -> Value {
    let keys = scene_keys().into_iter().map(|key| {
        json!({
            "table": key.table, "kind": key.kind, "name": key.name, "takes": key.takes, "about": key.about,
            "default": key.default, "insteadOf": key.instead_of, "everyday": key.everyday,
        })
    });
    let effects = EFFECT_KEYS.iter().map(|effect| {
        json!({ "name": effect.name, "takes": effect.takes, "about": effect.about, "off": effect.off })
    });
    let outputs = Output::ALL.iter().map(|output| {
        let name = output.name();
        let field = FIELDS.iter().find(|field| field.name == name);
        json!({ "name": name, "field": output.is_field(), "about": field.map(|field| field.words) })
    });
    let models = Numerics::all().map(|model| {
        let abilities = model.model().abilities();
        json!({
            "name": model.name(),
            "effects": abilities.effects.iter().map(|effect| effect.key()).collect::<Vec<_>>(),
            "periodic": abilities.boundaries.contains(&contact_model::Boundary::Periodic),
            "outputs": abilities.outputs.iter().map(|output| output.name()).collect::<Vec<_>>(),
        })
    });
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "keys": keys.collect::<Vec<_>>(),
        "effects": effects.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
        "models": models.collect::<Vec<_>>(),
    })
}
