//! Self-affine surfaces of one seed and three fractal dimensions, with their prescribed rms height, their
//! slope and the fractal dimension that is measured on them.
//!
//! `cargo run -p surface-gen --example self_affine`
//!
//! ```text
//!   D_f rms height     slope   highest D_f back
//!   2.2   0.010000    0.1470   0.02495    2.197
//!   2.5   0.010000    0.4427   0.03174    2.497
//!   2.8   0.010000    1.3300   0.04040    2.797
//! ```

use contact_model::{Result, SelfAffine};
use surface_gen::{MapGenerator, hurst_from_spectrum, radial_spectrum, rms_height, rms_slope, surface_seed};

fn main() -> Result<()> {
    let seed = surface_seed(1, 0); // surface number 0 of the ensemble with the master seed 1
    println!("{:>5} {:>10} {:>9} {:>9} {:>8}", "D_f", "rms height", "slope", "highest", "D_f back");
    for fractal_dimension in [2.2, 2.5, 2.8] {
        let surface = SelfAffine::new(fractal_dimension, [2.0, 1.0], 0.01)?;
        // The generator keeps the plan of the transform: it is the fast way to draw many surfaces.
        let map = MapGenerator::new(&surface, [512, 256])?.map(seed)?;
        let spectrum = radial_spectrum(&map)?;
        let (first, last) = (spectrum[15].0, spectrum[spectrum.len() - 1].0);
        let back = 3.0 - hurst_from_spectrum(&spectrum, first, last)?;
        let height = rms_height(map.heights());
        println!(
            "{fractal_dimension:>5} {height:>10.6} {:>9.4} {:>9.5} {back:>8.3}",
            rms_slope(&map)?,
            map.highest()
        );
        assert!((height / 0.01 - 1.0).abs() < 1e-12);
        assert!((back - fractal_dimension).abs() < 0.01); // amplitudes are fixed, only phases are random
    }
    Ok(())
}
