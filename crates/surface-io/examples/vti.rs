//! A rough surface and its slope as a file for ParaView, its numbers in base64 and, for the eye, as decimals.
//!
//! `cargo run -p surface-io --example vti -- DIRECTORY`
//!
//! ```text
//! rough.vti: 355 kB
//! rough-ascii.vti: 721 kB
//! 129 x 129 cells of 7.752 um, highest 3.585 um
//! ```

use contact_model::SelfAffine;
use std::error::Error;
use std::path::PathBuf;
use surface_gen::self_affine_map;
use surface_io::{DataArray, Encoding, vti};

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let map = self_affine_map(&SelfAffine::new(2.3, 1e-3, 1e-6)?, 129, 1)?;
    let (n, cell) = (map.columns(), map.dx());
    let heights = map.heights();
    // The surface is periodic: the last column is followed by the first.
    let slope: Vec<f64> =
        (0..n * n).map(|i| (heights[i / n * n + (i % n + 1) % n] - heights[i]) / cell).collect();
    let fields = [
        DataArray { name: "height", unit: "m", values: heights },
        DataArray { name: "slope along x", unit: "", values: &slope },
    ];
    for (name, encoding) in [("rough.vti", Encoding::Base64), ("rough-ascii.vti", Encoding::Ascii)] {
        let bytes = vti(map.cells(), map.size(), &fields, encoding)?;
        std::fs::write(out.join(name), &bytes)?;
        println!("{name}: {} kB", bytes.len() / 1000);
        // Two doubles a cell; base64 takes four characters for three bytes.
        assert!(bytes.len() > 2 * n * n * 8 * 4 / 3);
    }
    println!("{n} x {n} cells of {:.3} um, highest {:.3} um", cell * 1e6, map.highest() * 1e6);
    Ok(())
}
