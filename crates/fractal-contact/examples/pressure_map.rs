//! The pressure under a rough surface as a picture (PNG) and for ParaView (VTI).
//!
//! `cargo run -p fractal-contact --example pressure_map -- DIRECTORY`
//!
//! ```text
//! 720 contact cells, highest pressure 4.77 GPa
//! force 50.000000 N, integral of the pressure 50.000000 N
//! pressure.png, pressure.vti
//! ```

use fractal_contact::runs::files;
use fractal_contact::surface_io::{DataArray, Encoding, vti};
use fractal_contact::{Bem3d, ContactModel, Load, Scene, SelfAffine, Surface};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    // Steel-like: E* = 115 GPa, 1 mm x 1 mm, rms height 1 um, F = 50 N.
    let surface = Surface::SelfAffine(SelfAffine::new(2.3, 1e-3, 1e-6)?);
    let mut scene = Scene::new(surface, 115e9);
    scene.outputs.pressure = true;
    scene.outputs.gap = true;
    let model = Bem3d { cells: 128, tolerance: 1e-5, ..Bem3d::default() };
    let state = model.prepare(&scene, 4)?.solve(Load::force(50.0))?;
    let (pressure, gap) = (state.pressure().ok_or("no pressure")?, state.gap().ok_or("no gap")?);

    let highest = pressure.values().iter().copied().fold(0.0, f64::max);
    println!(
        "{} contact cells, highest pressure {:.2} GPa",
        state.report.contact_cells.unwrap_or(0),
        highest * 1e-9
    );
    println!("force {:.6} N, integral of the pressure {:.6} N", state.force, pressure.integral());
    assert!((pressure.integral() / 50.0 - 1.0).abs() < 1e-5);

    let png = plots::grey_png("pressure.png", pressure.cells(), pressure.size(), pressure.values())?;
    files::write_whole(&out.join("pressure.png"), &png)?;
    let fields = [
        DataArray { name: "pressure", unit: "Pa", values: pressure.values() },
        DataArray { name: "gap", unit: "m", values: gap.values() },
    ];
    let bytes = vti(pressure.cells(), pressure.size(), &fields, Encoding::Base64)?;
    files::write_whole(&out.join("pressure.vti"), &bytes)?;
    println!("pressure.png, pressure.vti");
    Ok(())
}
