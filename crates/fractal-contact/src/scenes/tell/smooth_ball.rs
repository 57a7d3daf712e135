//! The smooth ball that a rough one is compared with: Hertz's formula under the same loads.

use crate::scenes::read::{LoadRequest, PrescribedLoad, SceneFile};
use contact_model::{ContactModel as _, ContactState, Effects, Normalisation, Outputs, Scene, Surface};

/// Label of its curve.
pub(crate) const LABEL: &str = "smooth ball, Hertz";

/// States of the ball without its roughness, with the number of the load. There are none for other bodies,
/// for paths, for loads that are normalised by the rms height, and with an effect that the formula lacks.
pub(crate) fn states(scene: &SceneFile) -> Vec<(usize, ContactState, Normalisation)> {
    let Some(body @ Surface::Sphere { .. }) = scene.body().filter(|_| scene.surface.is_rough()) else {
        return Vec::new();
    };
    let LoadRequest::Loads(requests) = &scene.request else { return Vec::new() };
    if requests.kind == PrescribedLoad::ForceBar || scene.effects != Effects::default() {
        return Vec::new();
    }
    let asked = &scene.requested.outputs;
    let outputs = Outputs { stiffness: asked.stiffness, area: asked.area, ..Outputs::default() };
    let smooth = Scene { outputs, ..Scene::new(body.clone(), scene.contact_modulus) };
    let Ok(mut contact) = analytic::Hertz.prepare(&smooth, 0) else { return Vec::new() };
    let normalisation = contact.normalisation();
    // A contact larger than the rectangle has no state.
    let state = |(index, value): (usize, &f64)| {
        let state = requests.load(*value, &normalisation).and_then(|load| contact.solve(load)).ok()?;
        Some((index, state, normalisation))
    };
    requests.values.iter().enumerate().filter_map(state).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rough_ball_has_hertz_beside_it() {
        let text = std::fs::read_to_string(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../data/scenes/rough-sphere.toml"
        ));
        let mut scene = SceneFile::parse(std::path::Path::new("rough-sphere.toml"), text.unwrap()).unwrap();
        let found = states(&scene);
        assert_eq!(found.len(), scene.request.count());
        // k^3 = 6 E*^2 R F.
        for (_, state, _) in &found {
            let stiffness = (6.0 * 60e9_f64.powi(2) * 10e-3 * state.force).cbrt();
            assert!((state.stiffness.unwrap() / stiffness - 1.0).abs() < 1e-9, "{state:?}");
        }
        // A map on a ball, whose heights are one map.
        let path = std::path::Path::new(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../data/scenes/diamond-on-ball.toml"
        ));
        let on_ball = SceneFile::read(path).unwrap();
        let found = states(&on_ball);
        let (_, largest, _) = found.last().unwrap();
        let modulus = on_ball.contact_modulus;
        let stiffness = (6.0 * modulus * modulus * 200e-9 * largest.force).cbrt();
        assert!((largest.stiffness.unwrap() / stiffness - 1.0).abs() < 1e-9, "{largest:?}");
        let plastic = contact_model::Hardness::Limit { pressure: 1e9 };
        scene.effects.hardness = plastic;
        assert!(states(&scene).is_empty());
    }
}
