//! A sphere under a suddenly applied constant force creeps into a standard solid; the contact radius follows
//! the creep function.
//!
//! `cargo run -p mdr1d --example viscoelastic`
//!
//! ```text
//!  t/tau          d          a       area  closed form
//!      0   0.001778   0.042172   0.005587     0.042172
//!      1   0.002686   0.051830   0.008439     0.051830
//!      3   0.003968   0.062992   0.012466     0.062992
//!     10   0.006314   0.079459   0.019835     0.079459
//!     30   0.008006   0.089478   0.025153     0.089478
//!    100   0.008255   0.090855   0.025933     0.090855
//! refused: the contact would shrink from t = 100 tau on
//! ```

use mdr1d::{ContactModel, Error, Load, Relaxing, Result, Rheology, Scene, Step, Surface, Viscoelastic};

fn main() -> Result<()> {
    // E*(t) = E* (1 + w exp(-t/tau)): ten times as stiff at first as in the end.
    let (contact_modulus, arm, radius, force) = (1.0, Relaxing { weight: 9.0, time: 1.0 }, 1.0_f64, 1e-3);
    let mut scene = Scene::new(Surface::Sphere { radius, size: 1.0.into() }, contact_modulus);
    scene.effects.rheology = Rheology::StandardSolid { arm };
    scene.outputs.stiffness = false; // it depends on how fast one pushes
    scene.outputs.area = true;
    let mut contact = Viscoelastic.prepare(&scene, 0)?;
    println!("{:>6} {:>10} {:>10} {:>10} {:>12}", "t/tau", "d", "a", "area", "closed form");
    for time in [0.0, 1.0, 3.0, 10.0, 30.0, 100.0] {
        let state = contact.advance(Step::new(time, Load::force(force)))?;
        // Lee and Radok (1960): a^3 = (3/4) R F J(t), J the creep function of E*.
        let w = arm.weight;
        let creep = (1.0 - w / (1.0 + w) * (-time / (arm.time * (1.0 + w))).exp()) / contact_modulus;
        let exact = (0.75 * radius * force * creep).cbrt();
        let (a, d) = (state.contact_radius.unwrap_or(0.0), state.approach.unwrap_or(0.0));
        println!("{time:>6} {d:>10.6} {a:>10.6} {:>10.6} {exact:>12.6}", state.area.unwrap_or(0.0));
        assert!((a / exact - 1.0).abs() < 1e-10);
    }
    // The theory holds while the contact grows: unloading is refused, and the history stays where it was.
    if let Err(Error::OutOfRange { max, .. }) = contact.advance(Step::new(101.0, Load::force(0.0))) {
        println!("refused: the contact would shrink from t = {max} tau on");
    }
    Ok(())
}
