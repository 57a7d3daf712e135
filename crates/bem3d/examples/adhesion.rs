//! Paths with adhesion of finite range.
//!
//! `adhesion sphere LAW MU CELLS HALF_SIDE STEPS` draws a sphere (R = E* = 1) of Tabor's parameter MU from contact, and prints its path in
//! Maugis's units and the pull-off force over pi w R; HALF_SIDE is half of the side in units of `(pi w R^2/K)^(1/3)`, K = 4/3.
//! `adhesion heights CELLS HURST SEED FILE` writes the heights of that map, one a line.
//! `adhesion map CELLS HURST SEED WORK RANGE TOLERANCE F1,F2,...` loads a periodic self-affine map (L = E* = h = 1) along these forces.

use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Bem3dPath, Boundary, ContactState, Error, HistoryModel, Load, Scene,
    SelfAffine, Step, Surface,
};
use std::error::Error as StdError;
use std::f64::consts::PI;
use std::time::Instant;

fn main() -> Result<(), Box<dyn StdError>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["sphere", law, mu, cells, half, steps] => {
            sphere(law_of(law)?, mu.parse()?, cells.parse()?, half.parse()?, steps.parse()?)
        }
        ["jkr", cells, off, steps] => jkr(cells.parse()?, off.parse()?, steps.parse()?),
        ["punch", cells] => punch(cells.parse()?),
        ["heights", cells, hurst, seed, file] => {
            let surface = SelfAffine { hurst: hurst.parse()?, ..SelfAffine::new(2.5, 1.0, 1.0)? };
            let cells = Bem3d { cells: cells.parse()?, ..Bem3d::default() }.grid(surface.size);
            let map = surface_gen::height_map(&Surface::SelfAffine(surface), cells, seed.parse()?)?;
            let lines: Vec<String> = map.heights().iter().map(|h| format!("{h:e}")).collect();
            Ok(std::fs::write(file, lines.join("\n"))?)
        }
        ["map", cells, hurst, seed, work, range, tolerance, forces] => {
            let forces = forces.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let adhesion = (work.parse()?, range.parse()?);
            map(cells.parse()?, hurst.parse()?, seed.parse()?, adhesion, tolerance.parse()?, &forces)
        }
        _ => Err("usage: adhesion sphere LAW MU CELLS HALF_SIDE STEPS | heights CELLS HURST SEED FILE | map CELLS HURST SEED WORK RANGE TOLERANCE F1,...".into()),
    }
}

/// A sphere (R = E* = 1) with short-range adhesion, CELLS in the contact radius without load, its centre OFF cells beside a corner.
fn jkr(cells: f64, off: f64, steps: usize) -> Result<(), Box<dyn StdError>> {
    let work = 1e-4f64;
    let radius = (4.5 * PI * work).cbrt();
    let cell = radius / cells;
    let n = (2.6 * cells).ceil() as usize;
    let middle = 0.5 * n as f64 + off;
    let map = bem3d::HeightMap::from_fn(n, n as f64 * cell, |i, j| {
        let (x, y) = (cell * (i as f64 + 0.5 - middle), cell * (j as f64 + 0.5 - middle));
        -0.5 * (x * x + y * y)
    })?;
    let mut scene = Scene::new(Surface::Heights(map.into()), 1.0);
    scene.outputs.area = true;
    scene.outputs.stiffness = false;
    scene.effects.adhesion = Adhesion::ShortRange { work };
    let mut history =
        HistoryModel::prepare(&Bem3dPath(Bem3d { tolerance: 1e-6, ..Bem3d::default() }), &scene, 0)?;
    let (d0, d1) =
        (radius * radius - (2.0 * PI * work * radius).sqrt(), -0.75 * (PI * PI * work * work).cbrt());
    let mut lowest = f64::INFINITY;
    let start = Instant::now();
    let mut applications = 0;
    for i in 0..=steps {
        let clock = Instant::now();
        let approach = d0 + (1.05 * d1 - d0) * i as f64 / steps as f64;
        let state = match history.advance(Step::normal(i as f64, Load::Approach(approach))) {
            Ok(state) => state.normal,
            Err(Error::NotConverged { best }) => {
                println!("NOT CONVERGED {}", best.report.certificate);
                break;
            }
            Err(error) => return Err(error.into()),
        };
        let force = state.force / (1.5 * PI * work);
        applications += state.report.applications;
        lowest = lowest.min(force);
        println!(
            "{:.3} {force:.5} {:.4} {}",
            approach / d0,
            (state.area.unwrap_or(0.0) / PI).sqrt() / cell,
            line(&state, clock)
        );
        if state.area == Some(0.0) {
            break;
        }
    }
    println!(
        "pull-off {lowest:.5} of 1.5 pi w R, {applications} applications, {:.1} s",
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

fn punch(cells: usize) -> Result<(), Box<dyn StdError>> {
    let work = 1e-4f64;
    let n = 2 * cells + 8;
    let r = cells as f64;
    let middle = 0.5 * n as f64 - 0.1;
    let inside = |i: usize, j: usize| (i as f64 + 0.5 - middle).hypot(j as f64 + 0.5 - middle - 0.2) < r;
    let map = bem3d::HeightMap::from_fn(n, n as f64 / r, |i, j| if inside(i, j) { 0.0 } else { -1.0 })?;
    let count = (0..n * n).filter(|k| inside(k % n, k / n)).count() as f64;
    let a = (count / PI).sqrt() / r;
    let kendall = (8.0 * PI * work * a.powi(3)).sqrt();
    let mut scene = Scene::new(Surface::Heights(map.into()), 1.0);
    scene.outputs.area = true;
    scene.outputs.stiffness = false;
    scene.effects.adhesion = Adhesion::ShortRange { work };
    let mut history =
        HistoryModel::prepare(&Bem3dPath(Bem3d { tolerance: 1e-6, ..Bem3d::default() }), &scene, 0)?;
    history.advance(Step::normal(0.0, Load::Approach(0.0)))?;
    for i in 0..120 {
        let d = -kendall / (2.0 * a) * (0.5 + 0.005 * f64::from(i));
        let state = history.advance(Step::normal(f64::from(i), Load::Approach(d)))?.normal;
        println!(
            "{:.3} {:.5} {:.5} {}",
            0.5 + 0.005 * f64::from(i),
            -state.force / kendall,
            state.area.unwrap() / (PI * a * a),
            state.adhesive.unwrap().stability
        );
    }
    Ok(())
}

fn law_of(word: &str) -> Result<AdhesionLaw, Box<dyn StdError>> {
    match word {
        "exponential" => Ok(AdhesionLaw::Exponential),
        "dugdale" => Ok(AdhesionLaw::Dugdale),
        _ => Err("exponential or dugdale".into()),
    }
}

fn sphere(law: AdhesionLaw, mu: f64, cells: usize, half: f64, steps: usize) -> Result<(), Box<dyn StdError>> {
    // R = E* = 1 and range = 1e-4: w^2 = mu^3 range^3.
    let range = 1e-4f64;
    let work = (mu * range).powf(1.5);
    let k = 4.0 / 3.0;
    let unit = (PI * work / k).cbrt();
    let approach_unit = (PI * PI * work * work / (k * k)).cbrt();
    let surface = Surface::Sphere { radius: 1.0, size: (2.0 * half * unit).into() };
    let mut scene = Scene::new(surface, 1.0);
    scene.outputs.area = true;
    scene.effects.adhesion = Adhesion::FiniteRange { work, range, law };
    let model = Bem3d { cells, tolerance: 1e-5, ..Bem3d::default() };
    let mut history = HistoryModel::prepare(&Bem3dPath(model), &scene, 0)?;
    let mut lowest = f64::INFINITY;
    println!(
        "approach force radius stiffness branch stability energy cells sweep-steps applications seconds"
    );
    for i in 0..=steps {
        let approach = 1.0 - 3.5 * i as f64 / steps as f64;
        let start = Instant::now();
        let state = match history.advance(Step::normal(i as f64, Load::Approach(approach * approach_unit))) {
            Ok(state) => state.normal,
            Err(Error::NotConverged { best }) => {
                println!("NOT CONVERGED {}", best.report.certificate);
                *best
            }
            Err(error) => return Err(error.into()),
        };
        let force = state.force / (PI * work);
        lowest = lowest.min(force);
        let radius = (state.area.unwrap_or(0.0) / PI).sqrt() / unit;
        println!("{approach:.3} {force:.5} {radius:.4} {}", line(&state, start));
    }
    println!("pull-off {lowest:.5} pi w R (JKR -1.5, DMT -2)");
    Ok(())
}

fn map(
    cells: usize,
    hurst: f64,
    seed: u64,
    (work, range): (f64, f64),
    tolerance: f64,
    forces: &[f64],
) -> Result<(), Box<dyn StdError>> {
    let surface = SelfAffine { hurst, ..SelfAffine::new(2.5, 1.0, 1.0)? };
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    (scene.outputs.area, scene.outputs.stiffness) = (true, false);
    scene.effects.boundary = Boundary::Periodic;
    scene.effects.adhesion = Adhesion::FiniteRange { work, range, law: AdhesionLaw::Exponential };
    let model = Bem3d { cells, tolerance, ..Bem3d::default() };
    let mut history = HistoryModel::prepare(&Bem3dPath(model), &scene, seed)?;
    println!("force stiffness branch stability energy cells steps applications seconds");
    for (i, &force) in forces.iter().enumerate() {
        let start = Instant::now();
        match history.advance(Step::normal(i as f64, Load::Force(force))) {
            Ok(state) => println!("{force} {}", line(&state.normal, start)),
            Err(error) => println!("{force} {error}"),
        }
    }
    Ok(())
}

fn line(state: &ContactState, start: Instant) -> String {
    let Some(adhesive) = state.adhesive else { return "no adhesion".into() };
    format!(
        "{:.6e} {} {:.4e} {:.8e} {} {} {} {:.3} [{}] {}",
        state.stiffness.unwrap_or(f64::NAN),
        adhesive.branch.as_str(),
        adhesive.stability,
        adhesive.energy,
        state.report.contact_cells.unwrap_or(0),
        state.report.iterations,
        state.report.applications,
        start.elapsed().as_secs_f64(),
        state.report.strategy,
        state.report.certificate
    )
}
