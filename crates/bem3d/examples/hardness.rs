//! What a hardness costs beside the elastic solve of the same load: `cargo run --release -p bem3d --example hardness -- [CELLS ...]`.
//!
//! A periodic self-affine surface of rms gradient 0.1 (H = 0.8, roll-off at a quarter of the side) at the mean pressure 0.01 E*: the elastic
//! state, then a hardness of 0.05 E*, about the rms pressure of the elastic contact, and one of 0.02 E*. Each is solved from nothing on one
//! thread and on two.

use bem3d::{
    Bem3d, Boundary, ContactModel, Error, Hardness, HeightMap, Load, Outputs, Scene, SelfAffine, Surface,
};
use rayon::ThreadPoolBuilder;
use std::sync::Arc;
use std::time::Instant;

const GRADIENT: f64 = 0.1;
const PRESSURE: f64 = 0.01;
const TOLERANCE: f64 = 1e-6;

/// A map whose rms gradient is [`GRADIENT`].
fn surface(cells: usize) -> Result<HeightMap, Error> {
    let mut surface = SelfAffine::new(2.2, 1.0, 1.0)?;
    surface.roll_off = Some(4.0 * std::f64::consts::TAU);
    let map = surface_gen::self_affine_map(&surface, cells, 3)?;
    let scale = GRADIENT / surface_gen::rms_slope_differences(&map);
    HeightMap::new(cells, 1.0, map.heights().iter().map(|h| h * scale).collect())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<usize> = std::env::args().skip(1).map(|cells| cells.parse()).collect::<Result<_, _>>()?;
    let sizes = if given.is_empty() { vec![257, 513, 1025, 2049] } else { given };
    println!(
        "cells, hardness/E*, area, plastic area, applications, one thread (s), over elastic, two threads (s)"
    );
    for cells in sizes {
        let map = Arc::new(surface(cells)?);
        let mut elastic = 0.0;
        for hardness in [None, Some(0.05), Some(0.02)] {
            let mut scene = Scene::new(Surface::Heights(Arc::clone(&map)), 1.0);
            scene.outputs = Outputs { area: true, ..Outputs::default() };
            scene.effects.boundary = Boundary::Periodic;
            if let Some(pressure) = hardness {
                scene.effects.hardness = Hardness::Limit { pressure };
            }
            let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
            let mut times = Vec::new();
            let mut found = None;
            for threads in [1, 2] {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
                let mut best = f64::INFINITY;
                for _ in 0..2 {
                    let start = Instant::now();
                    found = Some(pool.install(|| model.prepare(&scene, 0)?.solve(Load::Force(PRESSURE)))?);
                    best = best.min(start.elapsed().as_secs_f64());
                }
                times.push(best);
            }
            let Some(state) = found else { continue };
            if hardness.is_none() {
                elastic = times[0];
            }
            println!(
                "{cells}, {}, {:.4}, {:.4}, {}, {:.3}, {:.2}, {:.3}",
                hardness.map_or("elastic".to_owned(), |p| p.to_string()),
                state.area.unwrap_or(f64::NAN),
                state.plastic.map_or(0.0, |plastic| plastic.area),
                state.report.applications,
                times[0],
                times[0] / elastic,
                times[1],
            );
        }
    }
    Ok(())
}
