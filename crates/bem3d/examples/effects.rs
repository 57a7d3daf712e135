//! The cost of hardness and of adhesion compared with the elastic solve of the same load:
//! `cargo run --release -p bem3d --example effects -- [CELLS ...]`.
//!
//! A periodic self-affine surface of rms gradient 0.1 (H = 0.8, roll-off at a quarter of the side) at the
//! mean pressure 0.01 E*: the elastic state; a hardness of 0.05 E*, about the rms pressure of the elastic
//! contact, and one of 0.02 E*; a work of adhesion of 4e-4 and 1.6e-3 E* times the side of a cell, of short
//! range and with the exponential law over a fifth of a cell. Each is solved from a cold start on one thread
//! and on two. Solves of less than two seconds are run twice, and the shorter time is reported.
//! `effects CELLS EFFECT THREADS`, EFFECT from 0 to 6 in the order of the table, solves one of them once and
//! prints area, applications and seconds, and where the time went, so that its memory can be measured from
//! outside.

use bem3d::benchmarks::{Recorder, prepare_recorded};
use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Boundary, ContactModel, ContactState, Effects, Error, Hardness, HeightMap,
    Load, Outputs, Scene, SelfAffine, Surface,
};
use rayon::ThreadPoolBuilder;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

const GRADIENT: f64 = 0.1;
const PRESSURE: f64 = 0.01;
const TOLERANCE: f64 = 1e-6;

/// ns since the first call.
fn clock() -> u64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_nanos() as u64
}

/// A map whose rms gradient is [`GRADIENT`].
fn surface(cells: usize) -> Result<HeightMap, Error> {
    let mut surface = SelfAffine::new(2.2, 1.0, 1.0)?;
    surface.roll_off = Some(4.0 * std::f64::consts::TAU);
    let map = surface_gen::self_affine_map(&surface, cells, 3)?;
    let scale = GRADIENT / surface_gen::rms_slope_differences(&map);
    HeightMap::new(cells, 1.0, map.heights().iter().map(|h| h * scale).collect())
}

/// Name and effects of each row for cells of side `cell`.
fn effects(cell: f64) -> Vec<(String, Effects)> {
    let periodic = Effects { boundary: Boundary::Periodic, ..Effects::default() };
    let mut rows = vec![("elastic".to_owned(), periodic)];
    for pressure in [0.05, 0.02] {
        let hardness = Hardness::Limit { pressure };
        rows.push((format!("hardness {pressure}"), Effects { hardness, ..periodic }));
    }
    let (law, range) = (AdhesionLaw::Exponential, 0.2 * cell);
    for share in [4e-4, 1.6e-3] {
        let work = share * cell;
        let adhesion = Adhesion::ShortRange { work };
        rows.push((format!("short range {share:e}"), Effects { adhesion, ..periodic }));
        let adhesion = Adhesion::FiniteRange { work, range, law };
        rows.push((format!("exponential {share:e}"), Effects { adhesion, ..periodic }));
    }
    rows
}

fn scene(map: &Arc<HeightMap>, effects: &Effects) -> Scene {
    let mut scene = Scene::new(Surface::Heights(Arc::clone(map)), 1.0);
    scene.outputs = Outputs { area: true, ..Outputs::default() };
    scene.effects = *effects;
    scene
}

fn model() -> Bem3d {
    Bem3d { tolerance: TOLERANCE, ..Bem3d::default() }
}

fn solve(map: &Arc<HeightMap>, effects: &Effects) -> Result<ContactState, Error> {
    model().prepare(&scene(map, effects), 0)?.solve(Load::force(PRESSURE))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<usize> = std::env::args().skip(1).map(|cells| cells.parse()).collect::<Result<_, _>>()?;
    if let [cells, effect @ 0..7, threads @ 1..64] = given[..] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
        let map = Arc::new(surface(cells)?);
        let (name, effects) = effects(1.0 / cells as f64).swap_remove(effect);
        let recorder = Recorder::new(clock);
        let start = Instant::now();
        let state = pool.install(|| {
            prepare_recorded(&model(), &scene(&map, &effects), 0, &recorder)?.solve(Load::force(PRESSURE))
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let (area, report) = (state.area.unwrap_or(f64::NAN), state.report);
        println!("{cells}, {name}, {area:.4}, {}, {seconds:.3}", report.applications);
        println!("{} iterations, {}", report.iterations, report.strategy);
        for (part, spent) in recorder.take().into_iter().filter(|(_, spent)| spent.time > 1_000_000) {
            println!("{}: {} times, {:.3} s", part.name(), spent.times, spent.time as f64 * 1e-9);
        }
        return Ok(());
    }
    let sizes = if given.is_empty() { vec![257, 513, 1025, 2049] } else { given };
    println!(
        "cells, effect, area, plastic area, applications, one thread (s), over elastic, two threads (s)"
    );
    for cells in sizes {
        let map = Arc::new(surface(cells)?);
        let mut elastic = None;
        for (name, effects) in effects(1.0 / cells as f64) {
            let timed = |threads| -> Result<(f64, ContactState), Box<dyn std::error::Error>> {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
                let once = || -> Result<(f64, ContactState), Error> {
                    let start = Instant::now();
                    let state = pool.install(|| solve(&map, &effects))?;
                    Ok((start.elapsed().as_secs_f64(), state))
                };
                let (first, state) = once()?;
                Ok(if first < 2.0 { (first.min(once()?.0), state) } else { (first, state) })
            };
            let ((one, state), (two, _)) = (timed(1)?, timed(2)?);
            println!(
                "{cells}, {name}, {:.4}, {:.4}, {}, {one:.3}, {:.2}, {two:.3}",
                state.area.unwrap_or(f64::NAN),
                state.plastic.map_or(0.0, |plastic| plastic.area),
                state.report.applications,
                one / *elastic.get_or_insert(one),
            );
        }
    }
    Ok(())
}
