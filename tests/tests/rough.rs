//! Properties that hold for every rough surface.

use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{ContactModel, ContactState, HeightMap, Load, Outputs, PreparedContact, Scene, Surface};
use tests::{map, rough, rough_map, scene};

/// Tolerance of the solves here.
const TOLERANCE: f64 = 1e-10;
/// Bound of the difference between two solves of one state: each certificate bounds gaps relative to the rms
/// height, and k relatively; small approaches are shares of the rms height.
const SAME: f64 = 1e-7;

fn model(cells: usize) -> Bem3d {
    Bem3d { cells, tolerance: TOLERANCE, ..Bem3d::default() }
}

fn prepared(fractal_dimension: f64, cells: usize, seed: u64) -> Box<dyn PreparedContact> {
    let scene = Scene::new(Surface::SelfAffine(rough(fractal_dimension).unwrap()), 1.0);
    model(cells).prepare(&scene, seed).unwrap()
}

fn logarithmic(from: f64, to: f64, count: i32) -> Vec<f64> {
    (0..count).map(|i| from * (to / from).powf(f64::from(i) / f64::from(count - 1))).collect()
}

/// `E* = h = L = 1`: F_bar is the force.
fn sweep(contact: &mut dyn PreparedContact, loads: impl IntoIterator<Item = Load>) -> Vec<ContactState> {
    loads.into_iter().map(|load| contact.solve(load).unwrap()).collect()
}

#[test]
fn no_state_exceeds_the_plateau_of_its_grid() {
    let flat = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
    for cells in [33, 65] {
        let plateau =
            model(cells).prepare(&flat, 0).unwrap().solve(Load::force(1.0)).unwrap().stiffness.unwrap();
        for fractal_dimension in [2.0, 2.8] {
            let mut contact = prepared(fractal_dimension, cells, 3);
            let forces = [1e-3, 0.1, 1.0, 5.0, 20.0, 1e2, 1e3, 1e4];
            let states = sweep(&mut *contact, forces.map(Load::force));
            for state in &states {
                assert!(state.stiffness.unwrap() <= plateau * (1.0 + SAME), "{state:?}");
            }
            let last = &states[7];
            assert_eq!(last.report.contact_cells, Some(cells * cells));
            assert_relative_eq!(last.stiffness.unwrap(), plateau, max_relative = SAME);
        }
    }
}

/// Far beyond full contact the residual gaps are a millionth of the approach, which is below the resolution
/// of single precision.
#[test]
fn loads_a_million_times_that_of_full_contact() {
    for (cells, fractal_dimension) in [(33, 2.0), (129, 2.0), (65, 2.8)] {
        let model = Bem3d { cells, tolerance: 1e-4, ..Bem3d::default() };
        let scene = Scene::new(Surface::SelfAffine(rough(fractal_dimension).unwrap()), 1.0);
        let mut contact = model.prepare(&scene, 3).unwrap();
        for force in [1e5, 1e6, 1e3] {
            let state = contact.solve(Load::force(force)).unwrap();
            assert_eq!(state.report.contact_cells, Some(cells * cells), "{force}");
        }
    }
}

/// F(d) is convex and piecewise linear with slope k: `k_i dd <= dF <= k_(i+1) dd`, and the slope itself while
/// the set stays.
#[test]
fn the_force_is_the_integral_of_the_stiffness() {
    let mut contact = prepared(2.4, 65, 5);
    let approaches = logarithmic(0.01, 6.0, 400);
    let states = sweep(&mut *contact, approaches.into_iter().map(Load::approach));
    let (mut trapezoid, mut unchanged) = (0.0, 0);
    for pair in states.windows(2) {
        let [(d0, f0, k0), (d1, f1, k1)] =
            [0, 1].map(|i| (pair[i].approach.unwrap(), pair[i].force, pair[i].stiffness.unwrap()));
        let (step, rise) = (d1 - d0, f1 - f0);
        let slack = SAME * f1;
        assert!(k1 >= k0 * (1.0 - SAME), "k falls from {k0} to {k1} at d {d1}");
        assert!(rise >= k0 * step - slack && rise <= k1 * step + slack, "{k0} {} {k1}", rise / step);
        trapezoid += 0.5 * (k0 + k1) * step;
        if pair[0].report.contact_cells == pair[1].report.contact_cells {
            // Sets are nested, so as many cells are the same cells.
            unchanged += 1;
            assert_relative_eq!(rise, k1 * step, epsilon = slack);
            assert_relative_eq!(k0, k1, max_relative = SAME);
        }
    }
    assert!(unchanged >= 20, "only {unchanged} pairs of states share their contact set");
    let rise = states[399].force - states[0].force;
    // Trapezoids of a step function on 400 points.
    assert_relative_eq!(trapezoid, rise, max_relative = 1e-4);
}

#[test]
fn one_cell_is_the_floor() {
    for cells in [3, 16, 33, 65] {
        let mut contact = prepared(2.6, cells, 8);
        let normalisation = contact.normalisation();
        let state = contact.solve(Load::force(1e-12)).unwrap();
        assert_eq!(state.report.contact_cells, Some(1));
        // 0.891106989/1.1419, six digits.
        let floor = normalisation.stiffness_bar(state.stiffness.unwrap()) * cells as f64;
        assert_relative_eq!(floor, 0.780_372, max_relative = 1e-6);
        assert_relative_eq!(state.approach.unwrap(), 1e-12 / state.stiffness.unwrap(), max_relative = 1e-12);
    }
}

/// Every field of a state on N = 33.
fn with_fields(map: HeightMap, load: Load) -> ContactState {
    let mut scene = scene(map);
    let (area, pressure, displacement, gap) = (true, true, true, true);
    scene.outputs = Outputs { area, pressure, displacement, gap, ..scene.outputs };
    model(1).prepare(&scene, 0).unwrap().solve(load).unwrap()
}

#[test]
fn contact_sets_are_nested() {
    for fractal_dimension in [2.0, 2.5, 3.0] {
        let map = rough_map(fractal_dimension, 33, 12).unwrap();
        let mut before = vec![0.0; 33 * 33];
        for d in logarithmic(0.05, 20.0, 12) {
            let now =
                with_fields(map.clone(), Load::approach(d)).fields.unwrap().pressure.unwrap().into_values();
            // A cell may leave only if it was never surely in.
            assert!(before.iter().zip(&now).all(|(b, n)| *b < SAME || *n > 0.0), "a cell left at d = {d}");
            before = now;
        }
    }
}

#[test]
fn the_fields_satisfy_the_contact_conditions() {
    let map = rough_map(2.3, 33, 4).unwrap();
    for force in [1e-3, 0.1, 1.0, 20.0] {
        let state = with_fields(map.clone(), Load::force(force));
        let fields = state.fields.unwrap();
        let [p, u, g] = [fields.pressure, fields.displacement, fields.gap].map(|f| f.unwrap().into_values());
        let d = state.approach.unwrap();
        let area = map.dx() * map.dx();
        assert_relative_eq!(p.iter().sum::<f64>() * area, force, max_relative = 1e-12);
        let touching = p.iter().filter(|p| **p > 0.0).count();
        assert_eq!(state.report.contact_cells, Some(touching));
        assert_relative_eq!(state.area.unwrap(), touching as f64 * area, max_relative = 1e-12);
        let highest = map.highest();
        // The displacement by the plain sum over pairs.
        let sum = |i: usize| -> f64 {
            let k = |j: usize| bem3d::love::influence((i % 33).abs_diff(j % 33), (i / 33).abs_diff(j / 33));
            (0..p.len()).map(|j| k(j) * p[j]).sum::<f64>() * map.dx() / std::f64::consts::PI
        };
        for i in 0..p.len() {
            assert!(p[i] >= 0.0 && g[i] >= -TOLERANCE);
            assert!(p[i] <= 0.0 || g[i].abs() <= SAME, "p {} with gap {}", p[i], g[i]);
            assert_relative_eq!(u[i], sum(i), max_relative = 1e-11);
            assert_relative_eq!(g[i], u[i] + (highest - map.heights()[i]) - d, epsilon = 1e-11 * d.max(1.0));
        }
    }
}

/// `int F dd = (1/2) p' u`, the elastic energy, and `int d dF = F d - int F dd = (1/2) p' u + p' z`.
#[test]
fn the_work_is_the_elastic_energy() {
    let map = rough_map(2.4, 33, 4).unwrap();
    let mut contact = model(1).prepare(&scene(map.clone()), 0).unwrap();
    let approaches = logarithmic(1e-3, 5.0, 1000);
    let states = sweep(&mut *contact, approaches.into_iter().map(Load::approach));
    // Before the first state one cell: a triangle.
    let mut work = 0.5 * states[0].force * states[0].approach.unwrap();
    for pair in states.windows(2) {
        let step = pair[1].approach.unwrap() - pair[0].approach.unwrap();
        let bend = pair[1].stiffness.unwrap() - pair[0].stiffness.unwrap();
        work += step * 0.5 * (pair[0].force + pair[1].force) - step * step * bend / 12.0;
    }
    let last = with_fields(map.clone(), Load::approach(5.0));
    let fields = last.fields.unwrap();
    let [p, u] = [fields.pressure, fields.displacement].map(|f| f.unwrap().into_values());
    let area = map.dx() * map.dx();
    let highest = map.highest();
    let elastic = 0.5 * area * p.iter().zip(&u).map(|(p, u)| p * u).sum::<f64>();
    let of_heights = area * p.iter().zip(map.heights()).map(|(p, h)| p * (highest - h)).sum::<f64>();
    // Trapezoids with end correction on 1000 states of a piecewise linear force.
    let quadrature = 1e-6;
    assert_relative_eq!(work, elastic, max_relative = quadrature);
    assert_relative_eq!(last.force * 5.0 - work, elastic + of_heights, max_relative = quadrature);
}

#[test]
fn force_to_approach_and_back() {
    for fractal_dimension in [2.0, 2.4, 2.8] {
        for force in [1e-5, 1e-2, 0.5, 20.0] {
            let there = prepared(fractal_dimension, 65, 1).solve(Load::force(force)).unwrap();
            let back =
                prepared(fractal_dimension, 65, 1).solve(Load::approach(there.approach.unwrap())).unwrap();
            assert_relative_eq!(back.force, force, max_relative = SAME);
            assert_relative_eq!(back.stiffness.unwrap(), there.stiffness.unwrap(), max_relative = SAME);
        }
    }
}

#[test]
fn loading_and_unloading_meet_the_same_states() {
    for fractal_dimension in [2.0, 2.8] {
        let forces = logarithmic(1e-4, 50.0, 12);
        let mut contact = prepared(fractal_dimension, 65, 6);
        let up = sweep(&mut *contact, forces.iter().map(|&f| Load::force(f)));
        let down = sweep(&mut *contact, forces.iter().rev().map(|&f| Load::force(f)));
        for (up, down) in up.iter().zip(down.iter().rev()) {
            let alone = prepared(fractal_dimension, 65, 6).solve(Load::force(up.force)).unwrap();
            for other in [down, &alone] {
                assert_relative_eq!(up.approach.unwrap(), other.approach.unwrap(), max_relative = SAME);
                assert_relative_eq!(up.stiffness.unwrap(), other.stiffness.unwrap(), max_relative = SAME);
                assert_eq!(up.report.contact_cells, other.report.contact_cells);
            }
        }
    }
}

#[test]
fn randomness_comes_from_the_seed_alone() {
    let solve = |seed: u64| sweep(&mut *prepared(2.4, 65, seed), [1e-2, 1.0, 20.0].map(Load::force));
    let in_pool = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(seed))
    };
    let here = solve(1);
    for threads in [1, 2] {
        assert_eq!(here, in_pool(threads, 1));
    }
    assert_ne!(here[0].approach, solve(2)[0].approach);
}

/// An offset that the heights represent exactly changes no bit.
#[test]
fn the_zero_of_heights_is_arbitrary() {
    // Multiples of 2^-20 below 16 in size.
    let drawn = rough_map(2.4, 33, 9).unwrap();
    let exact = |offset: f64| {
        let heights = drawn.heights();
        map(33, 1.0, |x, y| (heights[y * 33 + x] * 1_048_576.0).round() / 1_048_576.0 + offset).unwrap()
    };
    for force in [1e-3, 0.3, 20.0] {
        let at = |offset: f64| with_fields(exact(offset), Load::force(force));
        for offset in [1024.0, -4096.0, 65_536.0] {
            assert_eq!(at(0.0), at(offset));
        }
    }
}
