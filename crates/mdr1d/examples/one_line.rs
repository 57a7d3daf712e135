//! One rough line: force, approach and stiffness over six decades of the force, in a few milliseconds.
//!
//! `cargo run -p mdr1d --example one_line`
//!
//! ```text
//!   F/(E*hL)          d/h  k/(1.14E*L)   elements
//!       1e-5     0.029695     0.000603         40
//!       1e-4     0.080289     0.002473        164
//!       1e-3     0.177384     0.015470       1026
//!       1e-2     0.391992     0.056694       3760
//!       1e-1     0.893690     0.286454      18998
//!        1e0     2.542184     0.708008      46956
//!        1e1    10.651677     0.988159      65536
//! ```

use mdr1d::{ContactModel, Load, Mdr1d, Result, Scene, SelfAffine, Surface, rule};

fn main() -> Result<()> {
    let surface = SelfAffine::new(2.4, 1.0, 1.0)?;
    let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    let mut contact = Mdr1d::default().prepare(&scene, 7)?;
    let normalisation = contact.normalisation();
    println!("{:>10} {:>12} {:>12} {:>10}", "F/(E*hL)", "d/h", "k/(1.14E*L)", "elements");
    for exponent in -5..=1 {
        let force_bar = 10_f64.powi(exponent);
        let state = contact.solve(Load::force(normalisation.force(force_bar)?))?;
        println!(
            "{force_bar:>10.0e} {:>12.6} {:>12.6} {:>10}",
            normalisation.approach_over_h(state.approach.unwrap_or_default())?,
            normalisation.stiffness_bar(state.stiffness.unwrap_or_default()),
            state.report.contact_cells.unwrap_or_default(),
        );
    }
    // In full contact the line is as stiff as a rigid circle of the square's area.
    let full = contact.solve(Load::force(normalisation.force(100.0)?))?.stiffness.unwrap_or_default();
    assert!((full / rule::full_contact_stiffness(1.0, 1.0) - 1.0).abs() < 1e-12);
    Ok(())
}
