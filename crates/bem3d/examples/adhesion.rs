//! Paths with adhesion.
//!
//! `adhesion sphere LAW MU CELLS HALF_SIDE STEPS` withdraws a sphere (R = E* = 1) with Tabor's parameter MU
//! from contact, and prints its path in Maugis's units and the pull-off force over pi w R; HALF_SIDE is half
//! of the side in units of `(pi w R^2/K)^(1/3)`, K = 4/3. `adhesion jkr CELLS OFF STEPS` withdraws a sphere
//! with short-range adhesion from its contact at zero load, the radius of which is CELLS cells; the centre
//! lies OFF cells beside the middle of the map. `adhesion cycle LAW MU CELLS HALF_SIDE STEPS` brings that
//! sphere into contact and withdraws it again, with STEPS steps each way, and prints the energy of the cycle
//! over pi w (pi w R^2/K)^(2/3), and the share of it that is lost outside of the two jumps into and out of
//! contact. `adhesion heights CELLS HURST SEED FILE` writes the heights of that map, one a line.
//! `adhesion map CELLS HURST SEED WORK RANGE TOLERANCE F1,F2,...` loads a periodic self-affine map (L = E* =
//! h = 1) along these forces. WORK = 0 means no adhesion, RANGE = 0 adhesion of short range.
//! `adhesion challenge CELLS SIDE ROLL_OFF RANGE SEED P1,P2,...` presses a surface of the contact-mechanics
//! challenge (Müser et al., Tribol. Lett. 65, 118 (2017)) at mean pressures over E* times the rms gradient,
//! without and with adhesion; side, longest wave and range in nm.

use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Boundary, ContactModel, ContactState, Error, HeightMap, Load, Scene,
    SelfAffine, Step, Surface,
};
use std::error::Error as StdError;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn StdError>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["sphere", law, mu, cells, half, steps] => {
            sphere(law_of(law)?, mu.parse()?, cells.parse()?, half.parse()?, steps.parse()?)
        }
        ["cycle", law, mu, cells, half, steps] => {
            cycle(law_of(law)?, mu.parse()?, cells.parse()?, half.parse()?, steps.parse()?)
        }
        ["jkr", cells, off, steps] => jkr(cells.parse()?, off.parse()?, steps.parse()?),
        ["heights", cells, hurst, seed, file] => {
            let surface = SelfAffine { hurst: hurst.parse()?, ..SelfAffine::new(2.5, 1.0, 1.0)? };
            let cells = Bem3d { cells: cells.parse()?, ..Bem3d::default() }.grid(surface.size);
            let map = surface_gen::height_map(&Surface::SelfAffine(surface), cells, seed.parse()?)?;
            let lines: Vec<String> = map.heights().iter().map(|h| format!("{h:e}")).collect();
            Ok(std::fs::write(file, lines.join("\n"))?)
        }
        ["map", cells, hurst, seed, work, range, tolerance, forces] => {
            let forces = forces.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let surface = SelfAffine { hurst: hurst.parse()?, ..SelfAffine::new(2.5, 1.0, 1.0)? };
            let (work, range) = (work.parse()?, range.parse()?);
            let adhesion = if range > 0.0 {
                Adhesion::FiniteRange { work, range, law: AdhesionLaw::Exponential }
            } else {
                Adhesion::ShortRange { work }
            };
            let model = Bem3d { cells: cells.parse()?, tolerance: tolerance.parse()?, ..Bem3d::default() };
            map(model, surface, seed.parse()?, adhesion, &forces)
        }
        ["challenge", cells, side, roll_off, range, seed, pressures] => {
            let pressures = pressures.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let lengths = [side, roll_off, range].map(str::parse::<f64>);
            let [side, roll_off, range] = lengths.map(|length| length.map(|nm| nm * 1e-9));
            let lengths = ChallengeLengths { side: side?, roll_off: roll_off?, range: range? };
            challenge(cells.parse()?, lengths, seed.parse()?, &pressures)
        }
        _ => Err("usage: adhesion sphere LAW MU CELLS HALF_SIDE STEPS | cycle LAW MU CELLS HALF_SIDE STEPS | jkr CELLS OFF STEPS | heights CELLS HURST SEED FILE | map CELLS HURST SEED WORK RANGE TOLERANCE F1,... | challenge CELLS SIDE ROLL_OFF RANGE SEED P1,...".into()),
    }
}

/// Withdraws a sphere (R = E* = 1) with short-range adhesion from its contact at zero load. The contact
/// radius at zero load is CELLS cells, and the centre lies OFF cells beside the middle of the map.
fn jkr(cells: f64, off: f64, steps: u32) -> Result<(), Box<dyn StdError>> {
    let work = 1e-4f64;
    let radius = (4.5 * PI * work).cbrt();
    let cell = radius / cells;
    let n = (2.6 * cells).ceil() as usize;
    let middle = 0.5 * n as f64 + off;
    let place = |i: usize| cell * (i as f64 + 0.5 - middle);
    let map = HeightMap::from_fn(n, n as f64 * cell, |i, j| -0.5 * (place(i).powi(2) + place(j).powi(2)))?;
    let mut scene = Scene::new(Surface::Heights(map.into()), 1.0);
    (scene.outputs.area, scene.outputs.stiffness) = (true, false);
    scene.effects.adhesion = Adhesion::ShortRange { work };
    let model = Bem3d { tolerance: 1e-6, ..Bem3d::default() };
    let mut history = ContactModel::prepare(&model, &scene, 0)?;
    let (first, last) = (radius * radius / 3.0, -0.75 * (PI * PI * work * work).cbrt());
    let (mut lowest, mut applications) = (0.0f64, 0);
    let start = Instant::now();
    println!(
        "approach force cells-in-radius stiffness branch stability energy cells steps applications seconds"
    );
    for i in 0..=steps {
        let clock = Instant::now();
        let approach = first + (1.05 * last - first) * f64::from(i) / f64::from(steps);
        let state = history.advance(Step::new(0.0, Load::approach(approach)))?;
        let force = state.force / (1.5 * PI * work);
        let in_radius = (state.area.unwrap_or(0.0) / PI).sqrt() / cell;
        lowest = lowest.min(force);
        applications += state.report.applications;
        println!("{:.3} {force:.5} {in_radius:.3} {}", approach / first, line(&state, clock));
        if in_radius <= 0.0 {
            break;
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("pull-off {lowest:.5} of 1.5 pi w R; {applications} applications, {seconds:.1} s");
    Ok(())
}

fn law_of(word: &str) -> Result<AdhesionLaw, Box<dyn StdError>> {
    match word {
        "exponential" => Ok(AdhesionLaw::Exponential),
        "dugdale" => Ok(AdhesionLaw::Dugdale),
        _ => Err("exponential or dugdale".into()),
    }
}

/// A sphere (R = E* = 1) with Tabor's parameter `mu`, and Maugis's units for it.
struct Sphere {
    scene: Scene,
    work: f64,
    /// Unit of lengths along the surface, and of approaches.
    unit: f64,
    approach_unit: f64,
}

impl Sphere {
    fn new(law: AdhesionLaw, mu: f64, half: f64) -> Self {
        // Range = 1e-4: w^2 = mu^3 range^3.
        let range = 1e-4f64;
        let work = (mu * range).powf(1.5);
        let k = 4.0 / 3.0;
        let unit = (PI * work / k).cbrt();
        let approach_unit = (PI * PI * work * work / (k * k)).cbrt();
        let surface = Surface::Sphere { radius: 1.0, size: (2.0 * half * unit).into() };
        let mut scene = Scene::new(surface, 1.0);
        scene.outputs.area = true;
        scene.effects.adhesion = Adhesion::FiniteRange { work, range, law };
        Self { scene, work, unit, approach_unit }
    }
}

/// The energy of a cycle of that sphere, and how much of it is lost outside of the jumps in and out of contact.
fn cycle(law: AdhesionLaw, mu: f64, cells: usize, half: f64, steps: usize) -> Result<(), Box<dyn StdError>> {
    let Sphere { mut scene, work, approach_unit, .. } = Sphere::new(law, mu, half);
    scene.outputs.stiffness = false;
    let model = Bem3d { cells, tolerance: 1e-5, ..Bem3d::default() };
    let mut history = ContactModel::prepare(&model, &scene, 0)?;
    let way = (0..=steps).map(|i| 1.0 - 4.0 * (i as f64 / steps as f64));
    let there: Vec<f64> = way.clone().collect();
    let path = there.iter().rev().copied().chain(way.skip(1));
    let (mut before, mut lost, mut jumped) = (None, 0.0, 0.0);
    for (i, approach) in path.enumerate() {
        let state = history.advance(Step::new(i as f64, Load::approach(approach * approach_unit)))?;
        let energy = state.adhesive.and_then(|adhesive| adhesive.energy).unwrap_or(0.0);
        let now = (approach * approach_unit, state.force, energy, state.area.unwrap_or(0.0) > 0.0);
        if let Some((d, force, stored, touched)) = before {
            let done = 0.5 * (force + now.1) * (now.0 - d);
            let dissipated: f64 = done - (energy - stored);
            lost += dissipated;
            jumped += if touched == now.3 { 0.0 } else { dissipated };
        }
        before = Some(now);
    }
    let unit = PI * work * approach_unit;
    println!(
        "energy of the cycle {:.4}, of the jumps in and out of contact {:.4}, rest {:.1} %",
        lost / unit,
        jumped / unit,
        100.0 * (1.0 - jumped / lost)
    );
    Ok(())
}

fn sphere(law: AdhesionLaw, mu: f64, cells: usize, half: f64, steps: usize) -> Result<(), Box<dyn StdError>> {
    let Sphere { scene, work, unit, approach_unit } = Sphere::new(law, mu, half);
    let model = Bem3d { cells, tolerance: 1e-5, ..Bem3d::default() };
    let mut history = ContactModel::prepare(&model, &scene, 0)?;
    let mut lowest = f64::INFINITY;
    println!(
        "approach force radius stiffness branch stability energy cells sweep-steps applications seconds"
    );
    for i in 0..=steps {
        let approach = 1.0 - 3.5 * i as f64 / steps as f64;
        let start = Instant::now();
        let state = match history.advance(Step::new(i as f64, Load::approach(approach * approach_unit))) {
            Ok(state) => state,
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
    model: Bem3d,
    surface: SelfAffine,
    seed: u64,
    adhesion: Adhesion,
    forces: &[f64],
) -> Result<(), Box<dyn StdError>> {
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    (scene.outputs.area, scene.outputs.stiffness) = (true, false);
    scene.effects.boundary = Boundary::Periodic;
    scene.effects.adhesion = adhesion;
    let mut history = ContactModel::prepare(&model, &scene, seed)?;
    println!("force stiffness branch stability energy cells steps applications seconds");
    for (i, &force) in forces.iter().enumerate() {
        let start = Instant::now();
        match history.advance(Step::new(i as f64, Load::force(force))) {
            Ok(state) => println!("{force} {}", line(&state, start)),
            Err(error) => println!("{force} {error}"),
        }
    }
    Ok(())
}

/// E*, work of adhesion and shortest wave of the challenge, SI; its rms gradient is 1.
const CHALLENGE: (f64, f64, f64) = (25e6, 0.05, 1e-7);
/// Width and number of the bins of pressure over E* times the rms gradient, and where the first one begins.
/// The first and the last bin also hold all lower and higher pressures; cells with a pressure below 1e-9 E*
/// are in no bin.
const BINS: (f64, usize, f64) = (0.1, 42, -1.0);

/// Lengths of a surface of the challenge, and the range of its attraction, in m.
#[derive(Clone, Copy)]
struct ChallengeLengths {
    side: f64,
    /// The longest wave.
    roll_off: f64,
    range: f64,
}

fn challenge(
    cells: usize,
    lengths: ChallengeLengths,
    seed: u64,
    pressures: &[f64],
) -> Result<(), Box<dyn StdError>> {
    let ChallengeLengths { side, roll_off, range } = lengths;
    let (contact_modulus, work, shortest) = CHALLENGE;
    let mut surface = SelfAffine { hurst: 0.8, ..SelfAffine::new(2.2, side, side)? };
    (surface.roll_off, surface.short_cutoff) = (Some(TAU / roll_off), Some(TAU / shortest));
    let map = surface_gen::self_affine_map(&surface, cells, seed)?;
    let scale = surface_gen::rms_slope(&map)?.recip();
    let map = HeightMap::new(cells, side, map.heights().iter().map(|h| h * scale).collect())?;
    println!(
        "rms height {:.4e} m, cell {:.4e} m",
        surface_gen::rms_height(map.heights()),
        side / cells as f64
    );
    let mut scene = Scene::new(Surface::Heights(Arc::new(map)), contact_modulus);
    scene.effects.boundary = Boundary::Periodic;
    (scene.outputs.stiffness, scene.outputs.area, scene.outputs.pressure) = (false, true, true);
    scene.outputs.mean_gap = true;
    let model = Bem3d { cells, tolerance: 1e-5, ..Bem3d::default() };
    let mut elastic = ContactModel::prepare(&model, &scene, seed)?;
    for &pressure in pressures {
        let start = Instant::now();
        let state = elastic.solve(Load::force(pressure * contact_modulus * side * side))?;
        row("elastic", pressure, &state, &scene, start);
    }
    drop(elastic);
    scene.effects.adhesion = Adhesion::FiniteRange { work, range, law: AdhesionLaw::Exponential };
    // Each load from no contact: a path of rising loads leads to the same state of the branch of approach.
    let mut adhesive = ContactModel::prepare(&model, &scene, seed)?;
    for &pressure in pressures {
        let start = Instant::now();
        match adhesive.solve(Load::force(pressure * contact_modulus * side * side)) {
            Ok(state) => row("adhesive", pressure, &state, &scene, start),
            Err(Error::NotConverged { best }) => row("NOT CONVERGED", pressure, &best, &scene, start),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

/// Relative area, mean gap, certificate, time, and the share of the cells in each bin of the pressure.
fn row(what: &str, pressure: f64, state: &ContactState, scene: &Scene, start: Instant) {
    let (width, count, first) = BINS;
    let cells = state.pressure().map_or(&[][..], |p| p.values());
    let mut bins = vec![0u64; count];
    for p in cells.iter().filter(|p| p.abs() > 1e-9 * scene.contact_modulus) {
        bins[(((p / scene.contact_modulus - first) / width).max(0.0) as usize).min(count - 1)] += 1;
    }
    println!(
        "{what} p {pressure} area {:.5} mean-gap {:.5e} m, {} applications, {:.1} s [{}] {}",
        state.area.unwrap_or(f64::NAN) / scene.surface.size().area(),
        state.mean_gap.unwrap_or(f64::NAN),
        state.report.applications,
        start.elapsed().as_secs_f64(),
        state.report.strategy,
        state.report.certificate
    );
    if let Some(adhesive) = state.adhesive {
        println!("  branch {} stability {:.3e}", adhesive.branch.as_str(), adhesive.stability);
    }
    let shares: Vec<String> = (bins.iter().enumerate().filter(|(_, n)| **n > 0))
        .map(|(i, n)| format!("({:.1}, {:.5})", first + width * i as f64, *n as f64 / cells.len() as f64))
        .collect();
    println!("  pressure/E* from, share: {}", shares.join(" "));
}

fn line(state: &ContactState, start: Instant) -> String {
    let adhesive = state.adhesive.map_or("elastic 1 0".into(), |adhesive| {
        format!(
            "{} {:.4e} {:.8e}",
            adhesive.branch.as_str(),
            adhesive.stability,
            adhesive.energy.unwrap_or(0.0)
        )
    });
    format!(
        "{:.6e} {adhesive} {} {} {} {:.3} [{}] {}",
        state.stiffness.unwrap_or(f64::NAN),
        state.report.contact_cells.unwrap_or(0),
        state.report.iterations,
        state.report.applications,
        start.elapsed().as_secs_f64(),
        state.report.strategy,
        state.report.certificate
    )
}
