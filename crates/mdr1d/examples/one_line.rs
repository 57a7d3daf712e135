//! One rough line: force, approach and stiffness over six decades, in a few milliseconds.
//!
//! `cargo run --release -p mdr1d --example one_line`

use contact_model::{ContactModel, Load, Scene, SelfAffine, Surface};
use mdr1d::Mdr1d;

fn main() -> contact_model::Result<()> {
    let surface = SelfAffine::new(2.4, 1.0, 1.0)?;
    let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    let mut contact = Mdr1d::default().prepare(&scene, 7)?;
    let normalisation = contact.normalisation();
    println!("{:>10} {:>12} {:>12} {:>10}", "F/(E*hL)", "d/h", "k/(1.1419E*L)", "elements");
    for exponent in -10..=3 {
        let force_bar = 10_f64.powf(0.5 * f64::from(exponent));
        let state = contact.solve(Load::Force(normalisation.force(force_bar)?))?;
        println!(
            "{force_bar:>10.2e} {:>12.6} {:>12.6} {:>10}",
            normalisation.approach_over_h(state.approach.unwrap_or_default())?,
            normalisation.stiffness_bar(state.stiffness.unwrap_or_default()),
            state.report.contact_cells.unwrap_or_default(),
        );
    }
    Ok(())
}
