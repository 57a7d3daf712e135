//! Leakage through a square map of gaps.
//!
//! The arguments are a file of little-endian numbers of 64 bits, row by row, and the boundary across the
//! flow, `periodic` or `free`. The flow is along y. The program prints the bounds for a square of side 1, and
//! the time.

use contact_model::{Boundary, Field, never};
use interface::{FlowAxis, FlowOptions, leakage_until, percolation};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("expected a file of gaps")?;
    let periodic = arguments.next().is_some_and(|word| word == "periodic");
    let network_alone = arguments.next().is_some_and(|word| word == "network");
    let bytes = std::fs::read(file)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    let gap: Vec<f64> = numbers.iter().map(|&number| f64::from_le_bytes(number)).collect();
    let gap = Field::new(gap.len().isqrt(), 1.0, gap)?;
    let boundary = if periodic { Boundary::PeriodicAlongX } else { Boundary::Free };
    let start = Instant::now();
    let found = percolation(&gap, 0.0, FlowAxis::Y, boundary)?;
    println!("percolation  {found:?} in {:.2} s", start.elapsed().as_secs_f64());
    for continuum in [false, true] {
        if continuum && network_alone {
            break;
        }
        let start = Instant::now();
        let options = FlowOptions { continuum, ..FlowOptions::default() };
        let leak = leakage_until(&gap, FlowAxis::Y, boundary, options, &never)?;
        let seconds = start.elapsed().as_secs_f64();
        println!("network      {:?}, relative width {:.2e}", leak.network, leak.network.relative_width());
        println!("continuum    {:?}", leak.continuum);
        println!("flow factor  {:?}, {} steps in {seconds:.2} s", leak.flow_factor, leak.flow.iterations);
    }
    Ok(())
}
