//! Heights of one's own from a CSV file in micrometres: contact area and stiffness under several forces.
//!
//! `cargo run -p fractal-contact --example own_heights -- DIRECTORY`
//!
//! The file is written first: a lens of radius 50 mm, so that Hertz says what must come out.
//!
//! ```text
//! F in N   A in mm^2   of Hertz  k in N/um   of Hertz
//!     20     0.14957     1.0125     31.968     1.0021
//!     50     0.27347     1.0051     43.268     0.9993
//!    100     0.43373     1.0042     54.527     0.9996
//! ```

use fractal_contact::surface_io::{Preprocessing, ReadOptions, Scan};
use fractal_contact::{Bem3d, Body, ContactModel, Load, Pair, Scene, Surface};
use std::error::Error;
use std::f64::consts::PI;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    // 151 x 151 points, 8 um apart, heights in um.
    let radius = 50e-3_f64;
    let at = |i: i32| f64::from(i - 75) * 8e-6;
    let height = |ix, iy| -1e6 * (at(ix).powi(2) + at(iy).powi(2)) / (2.0 * radius);
    let row = |iy| (0..151).map(|ix| format!("{:.6}", height(ix, iy))).collect::<Vec<_>>().join(",") + "\n";
    let path = out.join("lens.csv");
    std::fs::write(&path, (0..151).map(row).collect::<String>())?;

    let options =
        ReadOptions { unit: Some("um".parse()?), cell: Some("8 um".parse()?), ..ReadOptions::default() };
    let map = Scan::read(&path, &options)?.map(&Preprocessing::default())?; // in metres
    let glass = Body::Elastic { young: 70e9, poisson: 0.22 };
    let pair = Pair { first: glass, second: Body::Rigid };
    let mut scene = Scene::of_pair(Surface::Heights(map.into()), pair)?;
    scene.outputs.area = true;
    let mut contact = Bem3d { tolerance: 1e-5, ..Bem3d::default() }.prepare(&scene, 0)?;
    println!("{:>6} {:>11} {:>10} {:>10} {:>10}", "F in N", "A in mm^2", "of Hertz", "k in N/um", "of Hertz");
    for force in [20.0, 50.0, 100.0] {
        let state = contact.solve(Load::force(force))?;
        let a = (0.75 * radius * force / scene.contact_modulus).cbrt();
        let (area, k) = (state.area.unwrap_or(0.0), state.stiffness.unwrap_or(0.0));
        let (area_ratio, k_ratio) = (area / (PI * a * a), k / (2.0 * scene.contact_modulus * a));
        println!("{force:>6} {:>11.5} {area_ratio:>10.4} {:>10.3} {k_ratio:>10.4}", area * 1e6, k * 1e-6);
        // Cells are counted whole: first order in the cell over the contact radius.
        assert!((area_ratio - 1.0).abs() < 0.05 && (k_ratio - 1.0).abs() < 0.02);
    }
    Ok(())
}
