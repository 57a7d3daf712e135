//! Persson against Greenwood and Williamson: area and mean gap of the same random surface under the same
//! pressures.
//!
//! `cargo run -p fractal-contact-analytic --example rough_theories`
//!
//! ```text
//! rms slope 0.0290
//!                  model p in MPa      A/A0     kappa   gap in um
//!                persson     0.01  0.000551    1.5958      3.2122
//!                persson     0.10  0.005509    1.5958      2.1100
//!                persson     1.00  0.055049    1.5945      0.9455
//!   greenwood_williamson     0.01  0.000392    1.1340      3.0937
//!   greenwood_williamson     0.10  0.003588    1.0394      2.3930
//!   greenwood_williamson     1.00  0.031708    0.9184      1.5235
//! ```

use analytic::spectrum::Spectrum;
use analytic::{
    Boundary, ContactModel, GreenwoodWilliamson, Load, Persson, Result, Scene, SelfAffine, Surface,
};
use std::f64::consts::{PI, TAU};

fn main() -> Result<()> {
    // H = 0.8, rms height 1 um on 1 mm x 1 mm, waves down to 10 um; E* = 1 GPa.
    let mut surface = SelfAffine::new(2.2, 1e-3, 1e-6)?;
    surface.short_cutoff = Some(100.0 * TAU / 1e-3);
    let slope = Spectrum::new(&surface)?.rms_slope()?;
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1e9);
    scene.effects.boundary = Boundary::Periodic;
    scene.outputs.area = true;
    scene.outputs.mean_gap = true;
    let (persson, summits) = (Persson::default(), GreenwoodWilliamson::default());
    let models: [&dyn ContactModel; 2] = [&persson, &summits];
    println!("rms slope {slope:.4}");
    println!("{:>22} {:>8} {:>9} {:>9} {:>11}", "model", "p in MPa", "A/A0", "kappa", "gap in um");
    for model in models {
        for pressure in [0.01e6, 0.1e6, 1e6] {
            let mut contact = model.prepare(&scene, 0)?;
            let state = contact.solve(Load::force(pressure * 1e-6))?;
            let fraction = contact.normalisation().contact_fraction(state.area.unwrap_or(0.0));
            let kappa = fraction * 1e9 * slope / pressure;
            let gap = state.mean_gap.unwrap_or(0.0) * 1e6;
            let (name, megapascal) = (model.name(), pressure * 1e-6);
            println!("{name:>22} {megapascal:>8.2} {fraction:>9.6} {kappa:>9.4} {gap:>11.4}");
            // Persson's area is linear in a small pressure: kappa = sqrt(8/pi).
            assert!(model.name() != "persson" || (kappa / (8.0 / PI).sqrt() - 1.0).abs() < 1e-3);
        }
    }
    Ok(())
}
