//! A chart of three closed forms, force over approach, as SVG and PNG.
//!
//! `cargo run -p fractal-contact-plots --example chart -- DIRECTORY`
//!
//! ```text
//! flat cylinder, 2 E* a d: F ~ d^1.000
//! sphere, (4/3) E* R^(1/2) d^(3/2): F ~ d^1.500
//! cone, (2/pi) E* d^2/slope: F ~ d^2.000
//! 2 files
//! ```

use plots::{Chart, Curve};
use std::error::Error;
use std::path::PathBuf;

/// The force of a body over the approach.
type ForceLaw = fn(f64) -> f64;

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    // E* = 1; a cylinder of radius 0.1, a sphere of radius 1, a cone of slope 0.5.
    let force: [(&str, ForceLaw); 3] = [
        ("flat cylinder, 2 E* a d", |d| 0.2 * d),
        ("sphere, (4/3) E* R^(1/2) d^(3/2)", |d| 4.0 / 3.0 * d.powf(1.5)),
        ("cone, (2/pi) E* d^2/slope", |d| std::f64::consts::FRAC_2_PI * d * d / 0.5),
    ];
    let approaches = (0..=40).map(|i| 10_f64.powf(-4.0 + 0.075 * f64::from(i)));
    let curve = |(label, law): &(&str, ForceLaw)| Curve {
        label: (*label).to_owned(),
        points: approaches.clone().map(|d| (d, law(d))).collect(),
        ..Curve::default()
    };
    let curves: Vec<Curve> = force.iter().map(curve).collect();
    for (curve, expected) in curves.iter().zip([1.0, 1.5, 2.0]) {
        let [(d0, f0), (d1, f1)] = [curve.points[0], curve.points[40]];
        let exponent = (f1 / f0).ln() / (d1 / d0).ln();
        println!("{}: F ~ d^{exponent:.3}", curve.label);
        assert!((exponent - expected).abs() < 1e-12);
    }
    let chart = Chart {
        title: "Force of three bodies, E* = 1".to_owned(),
        x_label: "approach d".to_owned(),
        y_label: "force F".to_owned(),
        curves,
        logarithmic: true,
        ..Chart::default()
    };
    let files = chart.files("three-bodies")?;
    println!("{} files", files.len());
    for (name, bytes) in files {
        assert!(bytes.len() > 1000);
        std::fs::write(out.join(name), bytes)?;
    }
    Ok(())
}
