//! Sweeps one NPY map of heights over forces and prints the work of each load: `sweep MAP.npy TOLERANCE F1,F2,...`.
#![allow(clippy::unwrap_used)]
use bem3d::Bem3d;
use contact_model::{ContactModel, HeightMap, Load, Scene, Surface};
use std::sync::Arc;
use std::time::Instant;
fn read(path: &str) -> (usize, Vec<f64>) {
    let bytes = std::fs::read(path).unwrap();
    let header = u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
    let data: Vec<f64> =
        bytes[10 + header..].chunks(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect();
    ((data.len() as f64).sqrt() as usize, data)
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (cells, heights) = read(&args[1]);
    let tolerance: f64 = args[2].parse().unwrap();
    let forces: Vec<f64> = args[3].split(',').map(|f| f.parse().unwrap()).collect();
    let model = Bem3d { cells, tolerance, ..Bem3d::default() };
    let mut scene = Scene::new(Surface::Heights(Arc::new(HeightMap::new(cells, 1.0, heights).unwrap())), 1.0);
    scene.outputs.area = true;
    let t = Instant::now();
    let mut prepared = model.prepare(&scene, 0).unwrap();
    println!("prepare {:.3}", t.elapsed().as_secs_f64());
    let all = Instant::now();
    for f in forces {
        let t = Instant::now();
        let (state, word) = match prepared.solve(Load::Force(f)) {
            Ok(s) => (s, "ok"),
            Err(contact_model::Error::NotConverged { best }) => (*best, "NOT"),
            Err(e) => panic!("{e}"),
        };
        let r = &state.report;
        println!(
            "{f:.3e} d {:.12} kbar {:.12} n {} it {} app {} {:.3}s {} {} [{}]",
            state.approach.unwrap(),
            state.stiffness.unwrap() / 1.1419,
            r.contact_cells.unwrap(),
            r.iterations,
            r.applications,
            t.elapsed().as_secs_f64(),
            r.strategy,
            word,
            r.certificate
        );
    }
    println!("total {:.3}", all.elapsed().as_secs_f64());
}
