//! Stiffness, contact area and number of patches of a fractal surface over four decades of the force.
//!
//! `cargo run -p bem3d --example stiffness_curve`
//!
//! ```text
//!   F_bar      d/h    k_bar     A/A0 patches  certificate
//!   0.001   0.1448   0.0060  0.00006       1  0e0
//!    0.01   0.5172   0.0396  0.00096       5  1e-16
//!     0.1   1.5417   0.1182  0.00721       7  8e-16
//!       1   3.8969   0.6529  0.07494     152  7e-6
//!      10  12.4299   0.9915  0.51704     150  8e-6
//! ```

use bem3d::{Bem3d, ContactModel, Result, Scene, SelfAffine, Surface, never};

fn main() -> Result<()> {
    let surface = SelfAffine::new(2.4, 1.0, 0.01)?; // D_f, side L, rms height h
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0); // contact modulus E*
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
