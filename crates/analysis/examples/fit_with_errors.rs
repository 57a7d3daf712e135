//! An ensemble of stiffness curves whose law is known: means, the fitted law and the errors of its exponent
//! and factor.
//!
//! `cargo run -p fractal-contact-analysis --example fit_with_errors`
//!
//! ```text
//! F_bar 1e-4: k_bar = 0.00256 +- 0.00013, 40 surfaces
//! F_bar 1e-3: k_bar = 0.01083 +- 0.00044, 40 surfaces
//! F_bar 1e-2: k_bar = 0.04606 +- 0.00144, 40 surfaces
//! F_bar 1e-1: k_bar = 0.19681 +- 0.00464, 40 surfaces
//! alpha = 0.6284 +- 0.0049 (0.638 put in)
//! zeta  = 0.8329 +- 0.0173 (0.86 put in)
//! 11 of 13 forces in the window, F_bar <= 0.086, all surfaces >= 10 contact cells
//! ```

use analysis::{Bootstrap, Curves, FitWindow, StiffnessSample, ensemble, fit_power_law};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // k_bar = zeta F_bar^alpha, each surface with a factor and an exponent of its own.
    let (alpha, zeta, surfaces) = (0.638, 0.86, 40);
    let forces: Vec<f64> = (0..=12).map(|i| 10_f64.powf(-4.0 + 0.25 * f64::from(i))).collect();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut even = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
    let one_surface = |_| {
        let (own_alpha, own_zeta) = (alpha + 0.1 * even(), zeta * (1.0 + 0.4 * even()));
        let sample =
            |f: &f64| StiffnessSample { stiffness_bar: own_zeta * f.powf(own_alpha), contact_cells: None };
        forces.iter().map(|f| Some(sample(f))).collect()
    };
    let mut all: Vec<Vec<Option<StiffnessSample>>> = (0..surfaces).map(one_surface).collect();
    all[3][5] = None; // a solve that did not converge

    let curves = Curves::new(forces.clone(), all)?;
    for point in ensemble(&curves).iter().step_by(4) {
        let Some(k) = point.stiffness_bar else { continue };
        let error = k.standard_error.unwrap_or(0.0);
        println!("F_bar {:.0e}: k_bar = {:.5} +- {error:.5}, {} surfaces", point.force_bar, k.mean, k.count);
    }
    let law = fit_power_law(&curves, &FitWindow::PAPER, &Bootstrap::default())?;
    let (alpha_se, zeta_se) = (law.alpha_se.unwrap_or(0.0), law.zeta_se.unwrap_or(0.0));
    println!("alpha = {:.4} +- {alpha_se:.4} ({alpha} put in)", law.alpha);
    println!("zeta  = {:.4} +- {zeta_se:.4} ({zeta} put in)", law.zeta);
    println!("{} of {} forces in the window, {}", law.points, forces.len(), FitWindow::PAPER);
    assert!((law.alpha - alpha).abs() < 3.0 * alpha_se && (law.zeta - zeta).abs() < 3.0 * zeta_se);
    Ok(())
}
