//! A sphere under a constant normal force and a tangential force to and fro: the friction loop and its
//! dissipated energy.
//!
//! `cargo run -p mdr1d --example friction_loop`
//!
//! ```text
//! Q/mu F      delta_x      c/a   dissipated
//!    0.8    1.4374e-2   0.5848    4.8415e-6
//!      0    1.7643e-3   0.8434    5.5527e-6
//!   -0.8   -1.4374e-2   0.5848    1.4524e-5
//!      0   -1.7643e-3   0.8434    1.5236e-5
//!    0.8    1.4374e-2   0.5848    2.4207e-5
//!   -0.8   -1.4374e-2   0.5848    3.3890e-5
//!    0.8    1.4374e-2   0.5848    4.3573e-5
//! energy of a loop: 1.936592e-5, of the next 1.936592e-5, closed form 1.936592e-5
//! ```

use mdr1d::{
    Body, ContactModel, Friction, Load, Pair, PartialSlip, Result, Scene, Step, Surface, Tangential,
};

fn main() -> Result<()> {
    let body = Body::Elastic { young: 2.0, poisson: 0.3 };
    let pair = Pair { first: body, second: body };
    let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 2.0.into() }, pair)?;
    let (coefficient, normal, share) = (0.5, Load::force(0.01), 0.8);
    scene.effects.friction = Friction::coulomb(coefficient);
    let mut contact = PartialSlip.prepare(&scene, 0)?;
    let limit = coefficient * 0.01; // mu F

    let mut state = contact.advance(Step::new(0.0, normal))?;
    let mut dissipated = Vec::new();
    println!("{:>6} {:>12} {:>8} {:>12}", "Q/mu F", "delta_x", "c/a", "dissipated");
    for (i, part) in [share, 0.0, -share, 0.0, share, -share, share].into_iter().enumerate() {
        let tangential = Tangential::force_along_x(part * limit);
        state = contact.advance(Step::new((i + 1) as f64, normal.with_tangential(tangential)))?;
        let (Some(a), Some(t)) = (state.contact_radius, state.tangential) else { continue };
        let stick = t.stick_radius.unwrap_or(0.0) / a;
        println!("{part:>6} {:>12.4e} {stick:>8.4} {:>12.4e}", t.displacement[0], t.dissipated);
        dissipated.push(t.dissipated);
    }

    // Mindlin and Deresiewicz (1953): the energy of one closed loop of amplitude t = T/(mu F).
    let a = state.contact_radius.unwrap_or(0.0);
    let (s, t) = (1.0 - share, share);
    let shape = 1.0 - s.powf(5.0 / 3.0) - 5.0 / 6.0 * t * (1.0 + s.powf(2.0 / 3.0));
    let exact = 18.0 / 5.0 * limit * limit / (pair.shear_modulus()? * a) * shape;
    let [second, third] = [dissipated[4] - dissipated[0], dissipated[6] - dissipated[4]];
    println!("energy of a loop: {second:.6e}, of the next {third:.6e}, closed form {exact:.6e}");
    assert!((second / exact - 1.0).abs() < 1e-10 && (third / exact - 1.0).abs() < 1e-10);
    Ok(())
}
