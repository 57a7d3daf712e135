//! A rough surface and its slope as a file for ParaView: `cargo run -p surface-io --example vti --
//! rough.vti`.

use contact_model::SelfAffine;
use surface_gen::self_affine_map;
use surface_io::{DataArray, Encoding, files, vti};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "rough.vti".into());
    let map = self_affine_map(&SelfAffine::new(2.3, 1e-3, 1e-6)?, 129, 1)?;
    let (n, cell) = (map.columns(), map.dx());
    let heights = map.heights();
    let slope: Vec<f64> =
        (0..n * n).map(|i| (heights[i / n * n + (i % n + 1) % n] - heights[i]) / cell).collect();
    let fields = [
        DataArray { name: "height", unit: "m", values: heights },
        DataArray { name: "slope along x", unit: "", values: &slope },
    ];
    files::write_whole(name.as_ref(), &vti(map.cells(), map.size(), &fields, Encoding::Base64)?)?;
    files::write_whole(
        format!("{name}.ascii.vti").as_ref(),
        &vti(map.cells(), map.size(), &fields, Encoding::Ascii)?,
    )?;
    println!("{name}: {n} x {n} cells of {cell} m, highest {} m", map.highest());
    Ok(())
}
