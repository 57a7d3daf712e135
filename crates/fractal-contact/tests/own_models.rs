//! Models written by the user in scenes, and the example that shows one.

use fractal_contact::scenes::{Numerics, Options, Plan, Registry, SceneFile, run};
use runs::Silent;
use std::f64::consts::PI;
use std::path::Path;

#[allow(dead_code)] // Its `main`.
#[path = "../examples/own_model.rs"]
mod own_model;

use own_model::{SCENE, Winkler, answer};

const LAYER: Winkler = Winkler { thickness: 1e-4, cells: 257 };

/// The sum over cells against the integral: their share of the contact.
const CELLS: f64 = 0.02;

#[test]
fn a_layer_answers_beside_a_half_space() {
    let dir = tempfile::tempdir().unwrap();
    let table = answer(dir.path(), LAYER).unwrap();
    let models = table.texts("model").unwrap();
    let [force, stiffness] = ["force", "stiffness"].map(|name| table.numbers(name).unwrap());
    assert_eq!(models, ["bem3d", "bem3d", "winkler", "winkler"]);
    for (i, d) in [(2, 2e-6_f64), (3, 8e-6)] {
        // F = pi R (E*/t) d^2, k = 2 pi R (E*/t) d.
        let unit = PI * 1e-3 * (1e8 / 1e-4) * d;
        approx::assert_relative_eq!(force[i].unwrap(), unit * d, max_relative = CELLS);
        approx::assert_relative_eq!(stiffness[i].unwrap(), 2.0 * unit, max_relative = CELLS);
    }
    let hertz = 4.0 / 3.0 * 1e8 * 1e-3_f64.sqrt() * 8e-6_f64.powf(1.5);
    approx::assert_relative_eq!(force[1].unwrap(), hertz, max_relative = CELLS);
    let manifest = std::fs::read_to_string(dir.path().join("manifest.json")).unwrap();
    assert!(manifest.contains("Johnson"));
    let csv = std::fs::read_to_string(dir.path().join("results.csv")).unwrap();
    assert!(csv.contains("a model of the user's own, version \"1: 0.0001 m, 257 cells\""), "{csv}");

    // The same folder: what is stored is found by the version, and no other one takes it.
    let again = |version: &str, thickness: f64| {
        let registry = Registry::new().with(Winkler { thickness, ..LAYER }, version).unwrap();
        let scene = SceneFile::parse_with("layer.toml".as_ref(), SCENE.into(), &registry).unwrap();
        let options = Options { out: dir.path().into(), threads: 1, fresh: false };
        run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &contact_model::never).unwrap().kept
    };
    assert_eq!(again("1: 0.0001 m, 257 cells", 1e-4), 4);
    assert_eq!(again("2", 2e-4), 2);
}

#[test]
fn names_are_resolved_or_refused() {
    let registry = Registry::new().with(LAYER, "1").unwrap();
    let read = |text: String| SceneFile::parse_with(Path::new("a.toml"), text, &registry);
    let message = |text: String| read(text).unwrap_err().to_string();
    let unknown = message(SCENE.replace("\"winkler\"", "\"winkle\""));
    assert!(unknown.contains("did you mean `winkler`?") && unknown.contains("bem3d, mdr1d"), "{unknown}");
    let keys = message(SCENE.to_owned() + "[models.winkler]\nthickness = 1\n");
    assert!(keys.contains("[models.winkler]"), "{keys}");
    let scene = read(SCENE.to_owned()).unwrap();
    assert_eq!(scene.models[1], Numerics::Registered(registry.models()[0].clone()));
    assert!(scene.models[1].is_stored());
    // What it lacks is said at its name.
    let lacking = read(SCENE.replace("stiffness = true", "contact_patches = true")).unwrap();
    let refused = Plan::new(&lacking).unwrap_err().to_string();
    assert!(refused.contains("the model winkler does not support the output `contact_patches`"), "{refused}");
    assert!(refused.contains("--> a.toml:3:20"), "{refused}");

    let twice = registry.clone().with(LAYER, "2").unwrap_err().to_string();
    assert!(twice.contains("\"winkler\" is registered twice"), "{twice}");
    let clash = Registry::new().with(analytic::Hertz, "1").unwrap_err().to_string();
    assert!(clash.contains("\"hertz\" is the name of a model of the library"), "{clash}");
    let history = Registry::new().with(analytic::CattaneoMindlin, "1").unwrap_err().to_string();
    assert!(history.contains("\"cattaneo_mindlin\" is the name of a model"), "{history}");
    assert!(Registry::new().with(LAYER, "").unwrap_err().to_string().contains("has no version"));
}
