//! Bits of a sweep, for the test that Python has the same: force, approach, stiffness and the sum of the pressures under 20 loads.

use fractal_contact::{Bem3d, ContactModel, Error, Load, Scene, SelfAffine, Surface, surface_gen};

fn main() -> Result<(), Error> {
    let rough = SelfAffine::new(2.4, 1.0, 0.01)?;
    let map = surface_gen::self_affine_map(&rough, 129, surface_gen::surface_seed(7, 3))?;
    let mut scene = Scene::new(Surface::Heights(map.into()), 1.0);
    scene.outputs.pressure = true;
    let mut contact = Bem3d { tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene, 0)?;
    for i in 0..20 {
        let state = contact.solve(Load::force(1e-4 * 1.5_f64.powi(i)))?;
        let pressure = state.pressure().map_or(f64::NAN, |field| field.values().iter().sum());
        let found =
            [state.force, state.approach.unwrap_or(f64::NAN), state.stiffness.unwrap_or(f64::NAN), pressure];
        println!("{}", found.map(|value| format!("{:016x}", value.to_bits())).join(" "));
    }
    Ok(())
}
