//! Solves one surface at several forces and prints the work of each load.
//!
//! `sweep MAP.npy TOLERANCE F1,F2,...` for a square float64 NPY map (L = E* = 1), or
//! `sweep CELLS:DF:SEED TOLERANCE F1,...` for a self-affine one. Forces are given as F_bar, which is formed
//! with the measured rms height.

use bem3d::Bem3d;
use contact_model::{ContactModel, Error, HeightMap, Load, Scene, SelfAffine, Surface};
use std::error::Error as StdError;
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn StdError>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, source, tolerance, forces] = &arguments[..] else {
        return Err("usage: sweep MAP.npy|CELLS:DF:SEED TOLERANCE F1,F2,...".into());
    };
    let (surface, cells, seed) = surface(source)?;
    let model = Bem3d { cells, tolerance: tolerance.parse()?, ..Bem3d::default() };
    let mut scene = Scene::new(surface, 1.0);
    scene.outputs.area = true;
    let start = Instant::now();
    let mut prepared = model.prepare(&scene, seed)?;
    let normalisation = prepared.normalisation();
    println!("prepared in {:.3} s", start.elapsed().as_secs_f64());
    println!(
        "force_bar approach_over_h stiffness_bar cells steps applications seconds strategy status certificate"
    );
    let all = Instant::now();
    for force in forces.split(',') {
        let force_bar: f64 = force.parse()?;
        let start = Instant::now();
        let state = match prepared.solve(Load::force(normalisation.force(force_bar)?)) {
            Ok(state) => state,
            Err(Error::NotConverged { best }) => *best,
            Err(error) => return Err(error.into()),
        };
        let report = &state.report;
        println!(
            "{force_bar:.3e} {:.12} {:.12} {} {} {} {:.3} {} {} {}",
            normalisation.approach_over_h(state.approach.unwrap_or(0.0))?,
            normalisation.stiffness_bar(state.stiffness.unwrap_or(0.0)),
            report.contact_cells.unwrap_or(0),
            report.iterations,
            report.applications,
            start.elapsed().as_secs_f64(),
            report.strategy,
            report.status.as_str(),
            report.certificate
        );
    }
    println!("all loads {:.3} s", all.elapsed().as_secs_f64());
    Ok(())
}

fn surface(source: &str) -> Result<(Surface, usize, u64), Box<dyn StdError>> {
    if let [cells, fractal_dimension, seed] = source.split(':').collect::<Vec<_>>()[..] {
        let surface = SelfAffine::new(fractal_dimension.parse()?, 1.0, 1.0)?;
        return Ok((Surface::SelfAffine(surface), cells.parse()?, seed.parse()?));
    }
    let bytes = std::fs::read(source)?;
    let header = bytes.get(8..10).map_or(0, |b| usize::from(u16::from_le_bytes([b[0], b[1]])));
    let data = bytes.get(10 + header..).ok_or("not an NPY file")?;
    let heights: Vec<f64> =
        data.chunks_exact(8).filter_map(|c| c.try_into().ok()).map(f64::from_le_bytes).collect();
    let cells = heights.len().isqrt();
    Ok((Surface::Heights(Arc::new(HeightMap::new(cells, 1.0, heights)?)), cells, 0))
}
