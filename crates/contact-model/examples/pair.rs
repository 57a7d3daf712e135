//! From two materials to the numbers of their contact: E*, G*, normalised loads, and the conductance that
//! follows from a stiffness.
//!
//! `cargo run -p contact-model --example pair`
//!
//! ```text
//! E* = 85.45 GPa, G* = 68.82 GPa
//! F_bar = 0.01: F = 0.427 N, mean pressure 0.43 MPa
//! F_bar = 0.1: F = 4.272 N, mean pressure 4.27 MPa
//! F_bar = 1: F = 42.723 N, mean pressure 42.72 MPa
//! a = 10 um: k = 1.709 N/um, resistance 3.925 mOhm
//! ```

use contact_model::{Body, Conductance, Normalisation, Pair, Result};

fn main() -> Result<()> {
    // Steel on copper, in newtons and metres.
    let steel = Body::Elastic { young: 210e9, poisson: 0.30 };
    let copper = Body::Elastic { young: 120e9, poisson: 0.34 };
    let pair = Pair { first: steel, second: copper };
    let contact_modulus = pair.contact_modulus()?;
    let by_hand = 1.0 / ((1.0 - 0.09) / 210e9 + (1.0 - 0.1156) / 120e9);
    assert!((contact_modulus / by_hand - 1.0).abs() < 1e-14);
    println!("E* = {:.2} GPa, G* = {:.2} GPa", contact_modulus * 1e-9, pair.shear_modulus()? * 1e-9);

    // A square of 1 mm with an rms height of 0.5 um: F_bar = F/(E* h L), k_bar = k/(1.1419 E* L).
    let normalisation = Normalisation { contact_modulus, length: 1e-3, height: Some(0.5e-6) };
    for force_bar in [0.01, 0.1, 1.0] {
        let force = normalisation.force(force_bar)?;
        println!("F_bar = {force_bar}: F = {force:.3} N, mean pressure {:.2} MPa", force * 1e6 * 1e-6);
        assert!((normalisation.force_bar(force)? / force_bar - 1.0).abs() < 1e-14);
    }

    // A single round contact, a = 10 um: k = 2 E* a, and Holm's constriction Lambda = 4 a/(rho_1 + rho_2).
    let (a, steel, copper) = (10e-6, 1.4e-7, 1.7e-8);
    let stiffness = 2.0 * contact_modulus * a;
    let electrical = Conductance::Electrical { first: steel, second: copper };
    let conductance = electrical.of(stiffness, contact_modulus)?.unwrap_or(0.0);
    println!("a = 10 um: k = {:.3} N/um, resistance {:.3} mOhm", stiffness * 1e-6, 1e3 / conductance);
    assert!((conductance / (4.0 * a / (steel + copper)) - 1.0).abs() < 1e-14);
    Ok(())
}
