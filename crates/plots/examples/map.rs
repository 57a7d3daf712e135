//! A rough surface on an oblong grid with a hole as a grey picture: high is dark, undefined points are
//! transparent.
//!
//! `cargo run -p fractal-contact-plots --example map -- DIRECTORY`
//!
//! ```text
//! 384 x 128 pixels, 2056 of them transparent
//! ```

use contact_model::SelfAffine;
use plots::grey_png;
use std::error::Error;
use std::path::PathBuf;
use surface_gen::self_affine_map;

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let draw = || self_affine_map(&SelfAffine::new(2.3, [3.0, 1.0], 1.0)?, [384, 128], 5);
    let map = draw()?;
    // A round hole in the middle: NaN is "no value here".
    let inside = |ix: usize, iy: usize| {
        let (x, y) = ((ix as f64 + 0.5) * map.dx() - 1.5, (iy as f64 + 0.5) * map.dy() - 0.5);
        x.hypot(y) < 0.2
    };
    let values: Vec<f64> = map
        .heights()
        .iter()
        .enumerate()
        .map(|(i, &h)| if inside(i % map.columns(), i / map.columns()) { f64::NAN } else { h })
        .collect();
    let bytes = grey_png("rough.png", map.cells(), map.size(), &values)?;
    std::fs::write(out.join("rough.png"), &bytes)?;
    // Width and height stand at bytes 16 to 23 of a PNG.
    let side = |at: usize| bytes[at..at + 4].iter().fold(0, |n, b| (n << 8) | u32::from(*b));
    println!(
        "{} x {} pixels, {} of them transparent",
        side(16),
        side(20),
        values.iter().filter(|v| v.is_nan()).count()
    );
    assert_eq!([side(16), side(20)], [384, 128]);
    Ok(())
}
