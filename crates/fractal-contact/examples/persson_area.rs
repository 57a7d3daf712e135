//! Contact area of a periodic rough surface over the pressure, solved and after Persson's theory, from the
//! same scene.
//!
//! `cargo run -p fractal-contact --example persson_area`
//!
//! ```text
//! rms slope 0.3230
//!  p/(E* g)   solved  Persson  ratio
//!      0.02   0.0543   0.0319  1.702
//!      0.05   0.1246   0.0797  1.565
//!       0.1   0.2250   0.1585  1.420
//!       0.2   0.3978   0.3108  1.280
//!       0.5   0.7434   0.6827  1.089
//!         1   0.9661   0.9545  1.012
//! ```

use fractal_contact::analytic::Persson;
use fractal_contact::analytic::spectrum::Spectrum;
use fractal_contact::{Bem3d, Boundary, ContactModel, Load, Result, Scene, SelfAffine, Surface};
use std::f64::consts::TAU;

fn main() -> Result<()> {
    // H = 0.8, a roll-off at a quarter of the side, waves down to 16 cells of 192.
    let mut surface = SelfAffine::new(2.2, 1.0, 0.01)?;
    surface.roll_off = Some(4.0 * TAU);
    surface.short_cutoff = Some(12.0 * TAU);
    let slope = Spectrum::new(&surface)?.rms_slope()?;
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    scene.effects.boundary = Boundary::Periodic;
    scene.outputs.stiffness = false;
    scene.outputs.area = true;
    let solver = Bem3d { cells: 192, tolerance: 1e-4, ..Bem3d::default() };
    let (mut solved, mut theory) = (solver.prepare(&scene, 2)?, Persson::default().prepare(&scene, 2)?);
    println!("rms slope {slope:.4}");
    println!("{:>9} {:>8} {:>8} {:>6}", "p/(E* g)", "solved", "Persson", "ratio");
    for pressure in [0.02, 0.05, 0.1, 0.2, 0.5, 1.0] {
        let load = Load::force(pressure * slope); // E* = L = 1
        let fraction = |area: Option<f64>| area.unwrap_or(0.0);
        let (here, persson) = (fraction(solved.solve(load)?.area), fraction(theory.solve(load)?.area));
        println!("{pressure:>9} {here:>8.4} {persson:>8.4} {:>6.3}", here / persson);
        // The theory is exact towards full contact. Where contact is light, the few highest summits of one
        // small surface carry more than it says, and cells that touch in part count whole.
        assert!(here / persson > 0.95 && (pressure < 0.5 || here / persson < 1.1));
    }
    Ok(())
}
