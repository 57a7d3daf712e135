use super::step_law::ArmStep;
use super::*;
use crate::kernel::PeriodicKernel;
use crate::model::options::Bem3d;
use crate::parts::Recorder;
use crate::tuning::Tuning;
use contact_model::{Boundary, HeightMap, Load, PronySeries, Relaxing, Surface, never};
use std::sync::Arc;

/// The step of the other program: each arm by the implicit rule of Euler.
fn euler(spectrum: &RelaxationSpectrum, duration: f64) -> StepLaw {
    let arms: Vec<_> = (spectrum.arms.iter())
        .map(|arm| {
            let share = 1.0 / (1.0 + arm.rate * duration);
            ArmStep { weight: arm.weight, decay: share, rise: share }
        })
        .collect();
    let modulus = spectrum.equilibrium + arms.iter().map(|arm| arm.weight * arm.rise).sum::<f64>();
    StepLaw { modulus, kept: 0.0, arms }
}

/// The map of another program and the material of its example: E = 3, nu = 1/2, and 50 branches.
fn maxwell_map() -> Scene {
    let bytes = std::fs::read("../../data/peers/surface_maxwell_N256.npy").unwrap();
    let heights: Vec<f64> = bytes[bytes.len() - 4 * 256 * 256..]
        .chunks_exact(4)
        .map(|bytes| f64::from(f32::from_le_bytes(bytes.try_into().unwrap())))
        .collect();
    let map = HeightMap::new([256, 256], [1.0, 1.0], heights).unwrap();
    let mut scene = Scene::new(Surface::Heights(Arc::new(map)), 4.0);
    scene.effects.boundary = Boundary::Periodic;
    let arms: Vec<_> = (0..50)
        .map(|i| Relaxing { weight: 3.0, time: 10_f64.powf(-1.0 + 10.0 * f64::from(i) / 49.0) })
        .collect();
    scene.effects.rheology = Rheology::Prony(PronySeries::new(&arms).unwrap());
    scene.outputs = Outputs { area: true, ..Outputs::default() };
    scene
}

fn prepared(model: &Bem3d, scene: &Scene) -> PreparedSurface {
    let map = model.heights(scene, 0).unwrap();
    PreparedSurface::of_map(*model, scene, &map, (&Tuning::DEFAULT, &Recorder::default())).unwrap()
}

/// Cells in contact after each step of the other program, as it stores them: the column of a mean pressure.
fn cells_of_the_other(column: usize) -> Vec<usize> {
    let rows = std::fs::read_to_string("../../data/peers/maxwell-areas.csv").unwrap();
    rows.lines().skip(1).map(|row| row.split(',').nth(column).unwrap().parse().unwrap()).collect()
}

/// All 300 areas of the other program at two pressures, with its rule of time: with waves as it has them the number of
/// cells differs by at most one, and with the kernel of cells by about a per cent.
#[test]
fn areas_of_another_program() {
    let scene = maxwell_map();
    // The largest difference with waves, in cells, and with cells, relative: of few cells more.
    for (column, pressure, of_cells) in [(1, 2.0, 0.024), (2, 16.0, 0.0115)] {
        for periodic_kernel in PeriodicKernel::ALL {
            let mut surface = prepared(&Bem3d { periodic_kernel, ..Bem3d::DEFAULT }, &scene);
            let mut history = ViscousHistory::of(&surface, None, &scene).unwrap().unwrap();
            history.law = euler;
            let load = surface.scaled_load(Load::force(pressure)).unwrap();
            let mut track = ViscousTrack::new(&surface, &history.spectrum);
            let mut work = StepWork::default();
            for (step, cells) in cells_of_the_other(column).into_iter().enumerate() {
                let time_step = TimeStep { duration: 1.0 / 6.0, load, guess: None };
                track = history.step(&mut surface, &track, time_step, &mut work, &never).unwrap().1;
                let found = track.reached.cells;
                let allowed = match periodic_kernel {
                    PeriodicKernel::Waves => 1,
                    PeriodicKernel::Cells => (of_cells * cells as f64) as usize,
                };
                assert!(found.abs_diff(cells) <= allowed, "{pressure} {step}: {found} {cells}");
            }
        }
    }
}

/// The energy of the springs of a history over E*, and the power that the dashpots take, by sums over pairs.
fn energies(surface: &PreparedSurface, spectrum: &RelaxationSpectrum, track: &ViscousTrack) -> [f64; 2] {
    let places: Vec<_> = track.pressures.cells.places().collect();
    let table = surface.problem.operators.table();
    let product = |v: &[f64]| -> f64 {
        let pairs =
            places.iter().zip(v).flat_map(|(a, p)| places.iter().zip(v).map(move |(b, q)| (a, p, b, q)));
        pairs.map(|(a, p, b, q)| p * q * table.lag(a.0.abs_diff(b.0), a.1.abs_diff(b.1))[0]).sum()
    };
    let mut stored = 0.5 * spectrum.equilibrium * product(&track.pressures.elastic);
    let mut power = 0.0;
    for (arm, q) in spectrum.arms.iter().zip(&track.pressures.arms) {
        let of_arm = arm.weight * product(q);
        stored += 0.5 * of_arm;
        power += arm.rate * of_arm;
    }
    [stored, power]
}

/// The work of the load is what springs hold and dashpots take, to the error of the steps.
#[test]
fn work_is_stored_or_dissipated() {
    let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 4.0);
    let arms = [Relaxing { weight: 2.0, time: 0.5 }, Relaxing { weight: 1.0, time: 4.0 }];
    scene.effects.rheology = Rheology::Prony(PronySeries::new(&arms).unwrap());
    scene.outputs = Outputs::default();
    let model = Bem3d { cells: 16, tolerance: 1e-9, ..Bem3d::DEFAULT };
    let residual = |count: u32| {
        let mut surface = prepared(&model, &scene);
        let history = ViscousHistory::of(&surface, None, &scene).unwrap().unwrap();
        let mut track = ViscousTrack::new(&surface, &history.spectrum);
        let mut work = StepWork::default();
        let (mut of_load, mut dissipated, mut last, mut power) = (0.0, 0.0, 0.0, 0.0);
        for k in 1..=count {
            let share = f64::from(k) / f64::from(count);
            history.rest(&mut surface);
            // Up, down and up.
            let d = 0.06 * (share.min(0.7 - 0.4 * share)).max(1.2 * share - 0.6);
            let load = surface.scaled_load(Load::approach(d)).unwrap();
            let step = TimeStep { duration: 3.0 / f64::from(count), load, guess: None };
            let next = history.step(&mut surface, &track, step, &mut work, &never).unwrap().1;
            of_load += work_between(&mut surface, &track, &next, &mut work, &never).unwrap();
            let [stored, now_power] = energies(&surface, &history.spectrum, &next);
            dissipated += 0.5 * (power + now_power) * step.duration;
            (track, power, last) = (next, now_power, stored);
        }
        assert!(dissipated > 0.1 * of_load && last > 0.1 * of_load, "{dissipated} {last} {of_load}");
        (of_load - last - dissipated) / of_load
    };
    let [coarse, fine] = [32, 128].map(residual);
    assert!(fine.abs() < 2e-3 && fine.abs() < 0.15 * coarse.abs(), "{coarse} {fine}");
}
