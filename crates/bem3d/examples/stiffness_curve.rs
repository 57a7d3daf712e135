//! Stiffness, contact area and number of patches of a fractal surface over four decades of the force.
//!
//! `cargo run -p bem3d --example stiffness_curve`
//!
//! ```text
//! OUT
//! ```

#![allow(clippy::wildcard_imports)] // the solver, its scenes and the traits, from one crate

use bem3d::*;

fn main() -> Result<()> {
    let surface = SelfAffine::new(2.4, 1.0, 0.01)?; // D_f, side L, rms height h
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0); // modulus E*
    scene.outputs.area = true;
    scene.outputs.contact_patches = true;
    let model = Bem3d { cells: 129, tolerance: 1e-5, ..Bem3d::default() };
    let mut contact = model.prepare(&scene, 1)?; // seed
    let normalisation = contact.normalisation();
    println!("{:>7} {:>8} {:>8} {:>8} {:>7}  certificate", "F_bar", "d/h", "k_bar", "A/A0", "patches");
    let forces = [1e-3, 1e-2, 0.1, 1.0, 10.0];
    let mut last = 0.0;
    contact.sweep(&normalisation.loads(&forces)?, &never, &mut |i, state| {
        let state = state?;
        let stiffness_bar = normalisation.stiffness_bar(state.stiffness.unwrap_or(0.0));
        println!(
            "{:>7} {:>8.4} {stiffness_bar:>8.4} {:>8.5} {:>7}  {:.0e}",
            forces[i],
            normalisation.approach_over_h(state.approach.unwrap_or(0.0))?,
            normalisation.contact_fraction(state.area.unwrap_or(0.0)),
            state.patches.map_or(0, |p| p.count()),
            state.report.certificate.worst(),
        );
        // The stiffness grows with the load, at most to that of the rigid square (1.0091 for fine cells).
        assert!(stiffness_bar > last && stiffness_bar < 1.0091);
        last = stiffness_bar;
        Ok(())
    })
}
