//! Time of the stress below a map with random tractions, and a number that shows whether its bits changed.
//!
//! `cargo run --release -p fractal-contact-interface --example subsurface_stress -- CELLS DEPTHS [waves]`

use contact_model::{Boundary, Field, Result, never};
use interface::stress::{PeriodicLoad, StressedBody, SubsurfaceStress, SurfaceLoad};
use std::time::Instant;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    let number =
        |i: usize, other: usize| arguments.get(i).and_then(|text| text.parse().ok()).unwrap_or(other);
    let (cells, count) = (number(1, 512), number(2, 16));
    let periodic = if arguments.get(3).is_some() { PeriodicLoad::Waves } else { PeriodicLoad::Cells };
    let field = |factor: f64| {
        let values = (0..cells * cells).map(|i| (factor * (i as f64).powi(2)).sin()).collect();
        Field::new(cells, 1.0, values)
    };
    let pressure = SurfaceLoad::new(field(0.7)?)?;
    let full = SurfaceLoad::with_traction(field(0.7)?, [field(0.3)?, field(0.4)?])?;
    // From a quarter of a cell to a quarter of the map.
    let ratio = cells as f64 / 16.0;
    let depth = |i: usize| 0.25 / cells as f64 * ratio.powf(4.0 * i as f64 / (3.0 * count as f64));
    for (name, load) in [("pressure", &pressure), ("pressure and tractions", &full)] {
        for &boundary in Boundary::ALL {
            let body = StressedBody { boundary, periodic, ..StressedBody::new(0.3) };
            let start = Instant::now();
            let plan = SubsurfaceStress::new(load, body)?;
            let (mut largest, mut bits) = (0.0_f64, 0_u64);
            for i in 0..count {
                let plane = plan.at_depth(depth(i), &never)?;
                largest = largest.max(plane.largest_von_mises().0);
                let all = plane.components().iter().flat_map(Field::values);
                bits = all.fold(bits, |bits, value| bits.rotate_left(5) ^ value.to_bits());
            }
            let (seconds, megabytes) = (start.elapsed().as_secs_f64(), 1e-6 * plan.memory());
            let words = boundary.words();
            println!(
                "{name}, {words}: {seconds:.2} s, {megabytes:.0} MB, von Mises {largest:.6}, bits {bits:016x}"
            );
        }
    }
    Ok(())
}
