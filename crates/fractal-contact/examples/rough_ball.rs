//! Rough on a form: a rough ball on a flat, and from which load on it is a smooth one.
//!
//! `cargo run --release -p fractal-contact --example rough_ball`
//!
//! The heights of a rough flat piece are added to those of a ball. Light loads rest on summits; a contact
//! much wider than the waves has the stiffness of Hertz.
//!
//! ```text
//!  F in N   k/k of Hertz   A/A of Hertz   contact cells
//!   0.001         0.6116         0.1678               6
//!    0.01         0.6950         0.1687              28
//!     0.1         1.0727         0.2856             220
//!       1         0.9792         0.4592            1642
//! ```

use fractal_contact::surface_gen::height_map;
use fractal_contact::{Bem3d, ContactModel, Load, Scene, SelfAffine, Surface};
use std::error::Error;
use std::f64::consts::{PI, TAU};

fn main() -> Result<(), Box<dyn Error>> {
    let (contact_modulus, radius, size) = (100e9_f64, 10e-3_f64, 600e-6);
    // Rms height 50 nm, waves from 10 to 60 um.
    let surface = SelfAffine::new(2.2, size, 50e-9)?;
    let surface = SelfAffine { roll_off: Some(TAU / 60e-6), short_cutoff: Some(TAU / 10e-6), ..surface };
    let rough = height_map(&Surface::SelfAffine(surface), 480, 1)?;
    let ball = height_map(&Surface::Sphere { radius, size: size.into() }, rough.cells(), 0)?;
    let mut scene = Scene::new(Surface::Heights(rough.plus(&ball)?.into()), contact_modulus);
    scene.outputs.area = true;
    let mut contact = Bem3d { tolerance: 1e-5, ..Bem3d::default() }.prepare(&scene, 0)?;
    println!("{:>7} {:>14} {:>14} {:>15}", "F in N", "k/k of Hertz", "A/A of Hertz", "contact cells");
    let mut ratio = 0.0;
    for force in [1e-3, 1e-2, 0.1, 1.0] {
        let state = contact.solve(Load::force(force))?;
        let a = (0.75 * radius * force / contact_modulus).cbrt();
        let k = state.stiffness.unwrap_or(0.0) / (2.0 * contact_modulus * a);
        let area = state.area.unwrap_or(0.0) / (PI * a * a);
        println!("{force:>7} {k:>14.4} {area:>14.4} {:>15}", state.report.contact_cells.unwrap_or(0));
        ratio = k;
    }
    assert!((ratio - 1.0).abs() < 0.05);
    Ok(())
}
