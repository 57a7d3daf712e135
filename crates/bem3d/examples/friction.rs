//! Partial slip of one self-affine surface: work and time of an increment compared with those of the normal
//! load.
//!
//! `friction CELLS:DF:SEED TOLERANCE NU MU SHARE F1,F2,...`: two bodies with the same Poisson's ratio NU,
//! coefficient of friction MU, tangential force as a share of the largest one, and the normal loads as F_bar.
//! Each increment begins without traction, then from Ciavarella and Jaeger's tractions.

use bem3d::benchmarks::{Part, PartialSlipBench, Recorder, prepare_recorded};
use bem3d::{Bem3d, Load, Scene, SelfAffine, Surface};
use std::error::Error;
use std::sync::OnceLock;
use std::time::Instant;

/// ns since the first call.
fn clock() -> u64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_nanos() as u64
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, source, tolerance, nu, mu, share, forces] = &arguments[..] else {
        return Err("usage: friction CELLS:DF:SEED TOLERANCE NU MU SHARE F1,F2,...".into());
    };
    let [cells, fractal_dimension, seed] = source.split(':').collect::<Vec<_>>()[..] else {
        return Err("CELLS:DF:SEED".into());
    };
    let (tolerance, nu, mu, share): (f64, f64, f64, f64) =
        (tolerance.parse()?, nu.parse()?, mu.parse()?, share.parse()?);
    let surface = Surface::SelfAffine(SelfAffine::new(fractal_dimension.parse()?, 1.0, 1.0)?);
    let model = Bem3d { cells: cells.parse()?, tolerance, ..Bem3d::default() };
    let mut scene = Scene::new(surface, 1.0);
    scene.outputs.pressure = true;
    let seed = seed.parse()?;
    for force in forces.split(',') {
        let force_bar: f64 = force.parse()?;
        let recorder = Recorder::new(clock);
        let mut prepared = prepare_recorded(&model, &scene, seed, &recorder)?;
        let force = prepared.normalisation().force(force_bar)?;
        let start = Instant::now();
        let normal = prepared.solve(Load::force(force))?;
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "F_bar {force_bar}: normal {} applications {seconds:.3} s, {} cells",
            normal.report.applications,
            normal.report.contact_cells.unwrap_or(0)
        );
        let pressure = normal.pressure().ok_or("no pressure")?;
        let less = prepared.solve(Load::force(force * (1.0 - share)))?;
        let less = less.pressure().ok_or("no pressure")?.values();
        let start_from: Vec<f64> =
            pressure.values().iter().zip(less).map(|(p, less)| mu * (p - less)).collect();
        let _ = recorder.take();
        let mut bench = PartialSlipBench::new(pressure, nu / (1.0 - nu), &recorder);
        for (name, guess) in [
            ("plans and all", None),
            ("from nothing", None),
            ("from Ciavarella-Jaeger", Some(&start_from[..])),
        ] {
            for stiffness in [false, true] {
                let start = Instant::now();
                let found = bench.run(mu, share, tolerance, guess, stiffness).ok_or("refused")?;
                println!("  {name}: {:.3} s, {found:?}", start.elapsed().as_secs_f64());
                let parts = recorder.take();
                let parts =
                    parts.iter().filter(|(part, spent)| spent.time > 1_000_000 || *part == Part::Other);
                let parts: Vec<String> = parts
                    .map(|(part, spent)| {
                        format!("{} {} ms/{}", part.name(), spent.time / 1_000_000, spent.times)
                    })
                    .collect();
                println!("    {}", parts.join(", "));
            }
        }
    }
    Ok(())
}
