//! A sphere with JKR adhesion that is pulled off: the states of negative force and the load at which the
//! contact breaks.
//!
//! `cargo run -p fractal-contact-analytic --example jkr_pull_off`
//!
//! ```text
//!  F in mN   d in um  a in mm k in N/mm
//!   5.0000   13.6545   0.5134    1.0267
//!   2.0000    9.2707   0.4617    0.9233
//!   0.0000    5.6986   0.4135    0.8269
//!  -1.0000    3.4832   0.3795    0.7590
//!  -2.0000    0.4199   0.3242    0.6485
//!  -2.3560   -2.2009   0.2622    0.5244
//! refused: the smallest force is -2.3562 mN
//! breaks at -2.3562 mN by force, at -4.7041 um by approach
//! ```

use analytic::jkr::AdhesiveSphere;
use analytic::{Adhesion, ContactModel, Error, Jkr, Load, Result, Scene, Surface};
use std::f64::consts::PI;

fn main() -> Result<()> {
    // Rubber against glass: R = 10 mm, E* = 1 MPa, w = 50 mJ/m^2, in newtons and metres.
    let (radius, contact_modulus, work) = (0.01, 1e6, 0.05);
    let mut scene = Scene::new(Surface::Sphere { radius, size: 0.01.into() }, contact_modulus);
    scene.effects.adhesion = Adhesion::ShortRange { work };
    scene.outputs.area = true;
    let mut contact = Jkr.prepare(&scene, 0)?;
    println!("{:>8} {:>9} {:>8} {:>9}", "F in mN", "d in um", "a in mm", "k in N/mm");
    let pull_off = -1.5 * PI * work * radius;
    for force in [5e-3, 2e-3, 0.0, -1e-3, -2e-3, 0.9999 * pull_off] {
        let state = contact.solve(Load::force(force))?;
        let a = (state.area.unwrap_or(0.0) / PI).sqrt();
        let (d, k) = (state.approach.unwrap_or(0.0), state.stiffness.unwrap_or(0.0));
        println!("{:>8.4} {:>9.4} {:>8.4} {:>9.4}", force * 1e3, d * 1e6, a * 1e3, k * 1e-3);
        // F = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3)
        let exact = 4.0 * contact_modulus * a.powi(3) / (3.0 * radius)
            - (8.0 * PI * work * contact_modulus * a.powi(3)).sqrt();
        assert!((force - exact).abs() < 1e-9 * pull_off.abs());
    }
    if let Err(Error::OutOfRange { min, .. }) = contact.solve(Load::force(1.0001 * pull_off)) {
        println!("refused: the smallest force is {:.4} mN", min * 1e3);
        assert!((min / pull_off - 1.0).abs() < 1e-12);
    }

    // Under a prescribed approach the contact is stable further: down to -5/6 pi w R.
    let sphere = AdhesiveSphere::new(radius, contact_modulus, work)?;
    let [soft, hard] = [sphere.pull_off_at_force()?, sphere.pull_off_at_approach()?];
    println!("breaks at {:.4} mN by force, at {:.4} um by approach", soft.force * 1e3, hard.approach * 1e6);
    assert!((soft.force / pull_off - 1.0).abs() < 1e-12 && (hard.force / pull_off - 5.0 / 9.0).abs() < 1e-12);
    Ok(())
}
