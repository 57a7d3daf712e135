//! Two measured bodies face to face: what one rough body hides of the other.
//!
//! `cargo run --release -p fractal-contact --example two_bodies`
//!
//! A body pressed on its own imprint fits: the composite is flat. Moved by a few cells it does not fit any
//! more, and over independent surfaces the composite has the rms height `sqrt(2) h`.
//!
//! ```text
//! rms height of one body 1.000 um
//! on its imprint         0.000 um
//! moved by 8 um          0.777 um
//! moved by 32 um         1.411 um
//! on another body        1.456 um
//! ```

use fractal_contact::surface_gen::{height_map, rms_height};
use fractal_contact::surface_io::composite;
use fractal_contact::{HeightMap, SelfAffine, Surface};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // 512 um a side; a roll-off at an eighth of it.
    let surface = SelfAffine::new(2.2, 512e-6, 1e-6)?;
    let surface = SelfAffine { roll_off: Some(std::f64::consts::TAU / 64e-6), ..surface };
    let draw = |seed| height_map(&Surface::SelfAffine(surface), 256, seed);
    let (first, other) = (draw(1)?, draw(2)?);
    // An instrument would measure the imprint from its own side: mirrored. Laid on the first face to face it
    // is mirrored again.
    let imprint = first.scaled(1.0, -1.0)?.mirrored();
    let facing = imprint.mirrored();

    let rms = |map: &HeightMap| 1e6 * rms_height(map.heights());
    println!("rms height of one body {:.3} um", rms(&first));
    let fitting = composite(&first, &facing, [0.0; 2])?;
    println!("on its imprint         {:.3} um", rms(&fitting));
    assert!(rms(&fitting) < 1e-12);
    for offset in [8e-6, 32e-6] {
        let moved = composite(&first, &facing, [offset, 0.0])?;
        println!("moved by {:<13} {:.3} um", format!("{:.0} um", 1e6 * offset), rms(&moved));
    }
    let both = composite(&first, &other, [0.0; 2])?;
    println!("on another body        {:.3} um", rms(&both));
    assert!((rms(&both) / rms(&first).hypot(rms(&other)) - 1.0).abs() < 0.1);
    Ok(())
}
