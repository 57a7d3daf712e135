//! A deterministic surface of two waves, written as text, and the spectrum that is measured on it.
//!
//! `cargo run -p surface-gen --example wave_spectrum -- DIRECTORY`
//!
//! ```text
//! rms height 0.728869, rms slope 28.448331
//! ring 4: q = 25.639, C_2D = 3.958e-4
//! ring 20: q = 125.712, C_2D = 7.068e-6
//! ```

use contact_model::HeightMap;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;
use surface_gen::{radial_spectrum, rms_height, rms_slope};

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    // Amplitude 1 with 4 waves along x and 0.25 with 20 waves along y, on a square of side 1.
    let (cells, waves) = (128_usize, [(1.0_f64, 4_u32), (0.25, 20)]);
    let wave = |i: usize, (amplitude, count): (f64, u32)| {
        amplitude * (TAU * f64::from(count) * (i as f64 + 0.5) / cells as f64).cos()
    };
    let map = HeightMap::from_fn(cells, 1.0, |ix, iy| wave(ix, waves[0]) + wave(iy, waves[1]))?;
    let rows: Vec<String> = map
        .heights()
        .chunks(cells)
        .map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" "))
        .collect();
    std::fs::write(out.join("waves.txt"), rows.join("\n") + "\n")?;

    // The mean square of a wave is half its amplitude squared; its slope has the factor q.
    let mean_square = |factor: fn(f64) -> f64| {
        waves.iter().map(|(a, n)| 0.5 * (a * factor(TAU * f64::from(*n))).powi(2)).sum::<f64>()
    };
    println!("rms height {:.6}, rms slope {:.6}", rms_height(map.heights()), rms_slope(&map)?);
    assert!((rms_height(map.heights()) - mean_square(|_| 1.0).sqrt()).abs() < 1e-12);
    assert!((rms_slope(&map)? - mean_square(|q| q).sqrt()).abs() < 1e-10);

    // One line per ring of the spectrum. Only the two rings of the waves hold something.
    let spectrum = radial_spectrum(&map)?;
    let lines: Vec<String> = spectrum.iter().map(|(q, c)| format!("{q} {c}\n")).collect();
    std::fs::write(out.join("waves-spectrum.txt"), lines.concat())?;
    let rings: Vec<_> = spectrum.iter().enumerate().filter(|(_, (_, c))| *c > 1e-20).collect();
    for (ring, (q, c)) in &rings {
        println!("ring {}: q = {q:.3}, C_2D = {c:.3e}", ring + 1);
    }
    assert_eq!(rings.iter().map(|(ring, _)| ring + 1).collect::<Vec<_>>(), [4, 20]);
    Ok(())
}
