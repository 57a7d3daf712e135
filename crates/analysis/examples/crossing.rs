//! Laws of several fractal dimensions that meet in one point: their crossing, and the residual of their
//! collapse on one line.
//!
//! `cargo run -p fractal-contact-analysis --example crossing`
//!
//! ```text
//! crossing: F_bar = 0.0917, k_bar = 0.1878, spread 0.0191
//! collapse: 18 points, rms 0.0309, largest 0.0372, scatter 0.0309
//! ```

use analysis::{CollapsePoint, collapse, crossing};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // Eqs. 6, 8 and 11 of Pohrt, Popov and Filippov (2012): alpha = 0.266 D_f, zeta = 0.18/0.086^alpha, the
    // latter 2 % off in turn.
    let laws: Vec<(f64, f64)> = (0..6)
        .map(|i| {
            let alpha = 0.266 * (2.0 + 0.2 * f64::from(i));
            (alpha, 0.18 / 0.086_f64.powf(alpha) * if i % 2 == 0 { 1.02 } else { 0.98 })
        })
        .collect();
    let meet = crossing(&laws).ok_or("the exponents must differ")?;
    println!(
        "crossing: F_bar = {:.4}, k_bar = {:.4}, spread {:.4}",
        meet.force_bar, meet.stiffness_bar, meet.spread
    );
    assert!((meet.force_bar / 0.086 - 1.0).abs() < 0.1 && (meet.stiffness_bar / 0.18 - 1.0).abs() < 0.1);

    // F_tilde = 0.086 (k_bar/0.18)^(1/alpha) equals F_bar where the law holds exactly.
    let curve = |&(alpha, zeta): &(f64, f64)| {
        let point = |force_bar: f64| CollapsePoint {
            force_bar,
            force_tilde: 0.086 * (zeta * force_bar.powf(alpha) / 0.18).powf(1.0 / alpha),
        };
        [1e-4, 1e-3, 1e-2].map(point).to_vec()
    };
    let curves: Vec<_> = laws.iter().map(curve).collect();
    let left = collapse(&curves, 0.0, 0.086).ok_or("points in the window")?;
    let scatter = left.scatter.unwrap_or(0.0);
    println!(
        "collapse: {} points, rms {:.4}, largest {:.4}, scatter {scatter:.4}",
        left.points, left.rms, left.max
    );
    // ln F_tilde/F_bar is ln(1 +- 0.02)/alpha.
    assert!(left.max < 0.0203 / laws[0].0);
    Ok(())
}
