//! Rectangular maps, oblong cells and undefined points, compared with plain sums, exact solutions and their
//! own symmetries.

use analytic::{Hertz, Westergaard};
use approx::assert_relative_eq;
use bem3d::{Bem3d, Method};
use contact_model::{
    Adhesion, Boundary, ContactModel, ContactState, HeightMap, Load, PreparedContact, Scene, SelfAffine,
    Surface,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::f64::consts::PI;
use std::sync::Arc;
use tests::scene;
use tests::stability::{PlainSum, relaxed, relaxed_by};

/// Tolerance of the solves, and the largest relative difference of a solve from a reference.
const TOLERANCE: f64 = 1e-11;
const SAME: f64 = 1e-9;

fn solver(method: Method) -> Bem3d {
    Bem3d { tolerance: TOLERANCE, method, ..Bem3d::default() }
}

fn prepared(map: &HeightMap, boundary: Boundary, method: Method) -> Box<dyn PreparedContact> {
    let mut scene = scene(map.clone());
    (scene.outputs.pressure, scene.outputs.area) = (true, true);
    scene.effects.boundary = boundary;
    scene.outputs.mean_gap = boundary == Boundary::Periodic;
    solver(method).prepare(&scene, 0).unwrap()
}

/// Reproducible heights in [0, 1].
fn noise(seed: usize) -> impl Fn(usize, usize) -> f64 {
    move |x, y| {
        let mut state = (x as u64 * 7919 + y as u64 * 104_729 + seed as u64 * 31 + 1)
            .wrapping_mul(6_364_136_223_846_793_005);
        state ^= state >> 29;
        (state.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn map(cells: [usize; 2], size: [f64; 2], h: impl Fn(usize, usize) -> f64) -> HeightMap {
    let heights = (0..cells[0] * cells[1]).map(|i| h(i % cells[0], i / cells[0])).collect();
    HeightMap::with_undefined(cells, size, heights).unwrap()
}

/// Waves of the map and noise, in full contact at moderate loads.
fn waves(cells: [usize; 2], size: [f64; 2], seed: usize) -> HeightMap {
    let noise = noise(seed);
    map(cells, size, |x, y| {
        let turn = |i: usize, n: usize| 2.0 * PI * (i as f64 + 0.5) / n as f64;
        0.05 * (turn(x, cells[0]).cos() + 0.7 * (2.0 * turn(y, cells[1])).sin()) + 0.02 * noise(x, y)
    })
}

fn pressure(state: &ContactState) -> &[f64] {
    state.pressure().unwrap().values()
}

/// A state at an approach, compared with relaxation by plain sums: contact set, forces, stiffness, area.
fn against_plain_sums(map: &HeightMap, approach: f64) {
    let slow = relaxed(map, approach);
    let cell = map.dx() * map.dy();
    for method in [Method::Auto, Method::Iterative] {
        let state = prepared(map, Boundary::Free, method).solve(Load::approach(approach)).unwrap();
        let found: Vec<usize> = (0..map.heights().len()).filter(|&i| pressure(&state)[i] > 0.0).collect();
        assert_eq!(found, slow.contact, "{method:?}");
        assert_relative_eq!(state.force, slow.force, max_relative = SAME);
        for (&i, force) in slow.contact.iter().zip(&slow.forces) {
            assert_relative_eq!(pressure(&state)[i] * cell, force, epsilon = SAME * slow.force);
        }
        let k = PlainSum::of(map).stiffness(&slow.contact);
        assert_relative_eq!(state.stiffness.unwrap(), k, max_relative = SAME);
        assert_relative_eq!(state.area.unwrap(), cell * found.len() as f64, max_relative = 1e-12);
    }
}

#[test]
fn rectangles_and_oblong_cells_equal_plain_sums() {
    for (cells, size) in [
        ([16, 8], [2.0, 1.0]),
        ([12, 12], [2.0, 1.0]),
        ([9, 13], [0.3, 1.7]),
        ([30, 1], [30.0, 1.0]),
        ([1, 25], [0.2, 1.0]),
        ([40, 4], [1.0, 1.0]),
    ] {
        for approach in [0.02, 0.08, 0.4] {
            against_plain_sums(&waves(cells, size, cells[0]), approach);
        }
    }
}

/// A periodic state under the force that relaxation finds: pressures, stiffness, mean gap.
fn against_periodic_sums(map: &HeightMap, approaches: &[f64]) {
    let sum = PlainSum::periodic(map);
    let (cell, highest) = (map.dx() * map.dy(), map.highest());
    let mean = map.heights().iter().map(|h| highest - h).sum::<f64>() / map.heights().len() as f64;
    let mut contacts =
        [Method::Auto, Method::Iterative].map(|method| prepared(map, Boundary::Periodic, method));
    for &approach in approaches {
        let slow = relaxed_by(&sum, map, approach);
        for contact in &mut contacts {
            let load = Load::force(slow.force);
            let state = contact.solve(load).unwrap();
            let largest = slow.forces.iter().copied().fold(0.0, f64::max);
            let mut expected = vec![0.0; map.heights().len()];
            for (&i, force) in slow.contact.iter().zip(&slow.forces) {
                expected[i] = *force;
            }
            for (p, force) in pressure(&state).iter().zip(&expected) {
                assert_relative_eq!(p * cell, force, epsilon = SAME * largest);
            }
            // Under a force the kernel's constant c moves the plane by c F; 1/k' = 1/k + c.
            let gap = mean - (approach - sum.mean() * slow.force);
            assert_relative_eq!(contact.solve(load).unwrap().mean_gap.unwrap(), gap.max(0.0), epsilon = SAME);
            if slow.contact.len() < map.heights().len() {
                let k = sum.stiffness(&slow.contact);
                let expected = k / (1.0 - sum.mean() * k);
                assert_relative_eq!(state.stiffness.unwrap(), expected, max_relative = 10.0 * SAME);
            } else {
                assert!(state.stiffness.is_none(), "full contact has no finite stiffness");
            }
        }
    }
}

#[test]
fn periodic_maps_of_any_size_equal_plain_sums_over_images() {
    for n in [1, 2, 13, 15, 17] {
        against_periodic_sums(&waves([n, n], [1.0, 1.0], n), &[0.01, 0.1, 0.3, 5.0]);
    }
    for (cells, size) in [([17, 8], [2.0, 1.0]), ([6, 15], [1.0, 1.0]), ([19, 1], [19.0, 1.0])] {
        against_periodic_sums(&waves(cells, size, 3), &[0.05, 0.3, 5.0]);
    }
}

#[test]
fn a_periodic_square_of_65_cells_equals_plain_sums_over_images() {
    against_periodic_sums(&waves([65, 65], [1.0, 1.0], 65), &[0.06, 0.16]);
}

#[test]
fn odd_prime_and_smooth_sizes_converge_from_first_contact_to_full_contact() {
    // Steps of a rough surface over seven decades; the work of odd and prime sizes is that of the even
    // neighbour.
    let work = |cells: usize| -> usize {
        let surface = Surface::SelfAffine(SelfAffine::new(2.2, 1.0, 1.0).unwrap());
        let mut scene = Scene::new(surface, 1.0);
        scene.effects.boundary = Boundary::Periodic;
        let model = Bem3d { cells, tolerance: 1e-6, ..Bem3d::default() };
        let mut contact = model.prepare(&scene, 1).unwrap();
        let forces = [1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 300.0, 3000.0];
        forces.iter().map(|&f| contact.solve(Load::force(f)).unwrap().report.applications).sum()
    };
    for (even, others) in [(64, &[65, 63][..]), (96, &[97, 98, 105]), (128, &[127, 130])] {
        let expected = work(even) as f64;
        for &cells in others {
            let ratio = work(cells) as f64 / expected;
            assert!(ratio < 1.2, "{cells} cells: {ratio} of the work of {even}");
        }
    }
}

#[test]
fn pits_spikes_and_steps_converge_on_a_periodic_square_of_odd_side() {
    type HeightsOf<'a> = &'a dyn Fn(usize, usize) -> f64;
    let n = 65;
    let rough = noise(5);
    let shapes: [(&str, HeightsOf<'_>); 4] = [
        ("smooth", &|x, y| (2.0 * PI * (x + 2 * y) as f64 / n as f64).cos()),
        ("steps", &|x, y| ((x / 7 + y / 5) % 3) as f64),
        ("spikes", &|x, y| if rough(x, y) > 0.97 { 1.0 } else { 0.1 * rough(y, x) }),
        ("pits", &|x, y| if rough(x, y) > 0.97 { -1.0 } else { 0.01 * rough(y, x) }),
    ];
    for (name, shape) in shapes {
        let map = map([n, n], [1.0, 1.0], shape);
        let mut contact = prepared(&map, Boundary::Periodic, Method::Auto);
        for force in [1e-4, 1e-2, 0.3, 1.0, 3.0, 10.0, 100.0] {
            let state = contact.solve(Load::force(force));
            assert!(state.is_ok_and(|s| s.report.certificate.meets(TOLERANCE)), "{name} at {force}");
        }
    }
}

#[test]
fn a_turned_map_has_the_same_numbers() {
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let here = waves([24, 14], [1.0, 2.0], 7);
        let turned = here.transposed();
        for force in [1e-4, 0.02, 0.3] {
            let solve =
                |map: &HeightMap| prepared(map, boundary, Method::Auto).solve(Load::force(force)).unwrap();
            let (a, b) = (solve(&here), solve(&turned));
            assert_relative_eq!(a.stiffness.unwrap(), b.stiffness.unwrap(), max_relative = SAME);
            assert_eq!(a.report.contact_cells, b.report.contact_cells);
            let largest = pressure(&a).iter().copied().fold(0.0, f64::max);
            for (i, p) in pressure(&a).iter().enumerate() {
                assert_relative_eq!(*p, pressure(&b)[i % 24 * 14 + i / 24], epsilon = 1e-8 * largest);
            }
        }
    }
}

#[test]
fn hertz_on_oblong_cells() {
    // The edge of contact falls anywhere within a cell: first order, with scatter.
    let sphere = Surface::Sphere { radius: 2.0, size: [1.2, 0.8].into() };
    let scene = Scene::new(sphere, 1.5);
    let load = Load::approach(0.03);
    let exact = Hertz.prepare(&scene, 0).unwrap().solve(load).unwrap();
    for (cells, rows) in [(60, 120), (180, 60), (256, 170)] {
        let model = Bem3d { cells, rows: Some(rows), tolerance: 1e-8, ..Bem3d::default() };
        let state = model.prepare(&scene, 0).unwrap().solve(load).unwrap();
        let longer = (1.2 / cells as f64).max(0.8 / rows as f64);
        assert_relative_eq!(state.force, exact.force, max_relative = 0.2 * longer);
        assert_relative_eq!(state.stiffness.unwrap(), exact.stiffness.unwrap(), max_relative = 0.4 * longer);
    }
}

#[test]
fn oblong_cells_converge_to_the_square_cell_solution_with_first_order() {
    // Full contact of a flat square (data/paper/VALUES.md): k = 1.1522985 E* L, k_N = k - 0.4025/N for square
    // cells.
    let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
    let error = |cells: usize, rows: usize| {
        let model = Bem3d { cells, rows: Some(rows), tolerance: 1e-9, ..Bem3d::default() };
        let state = model.prepare(&scene, 0).unwrap().solve(Load::approach(1.0)).unwrap();
        1.152_298_5 - state.stiffness.unwrap()
    };
    for aspect in [2, 4] {
        let errors: Vec<f64> = [16, 32, 64].iter().map(|&n| error(n, aspect * n)).collect();
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.9..1.15).contains(&order), "aspect {aspect}: order {order}, {errors:?}");
        }
        assert!(errors[2] > 0.0 && errors[2] < 0.4025 / 64.0, "finer in one direction, no worse: {errors:?}");
    }
    // Rectangles (VALUES.md): 2 : 1 and 4 : 1, in E* sqrt(A).
    for (size, exact) in [([2.0, 1.0], 1.181_626), ([1.0, 4.0], 1.271_291)] {
        let k = |cells: usize| {
            let scene = Scene::new(Surface::Flat { size: size.into() }, 1.0);
            let model = Bem3d { cells, tolerance: 1e-9, ..Bem3d::default() };
            let state = model.prepare(&scene, 0).unwrap().solve(Load::approach(1.0)).unwrap();
            state.stiffness.unwrap() / f64::sqrt(size[0] * size[1])
        };
        let (coarse, fine) = (k(40), k(80));
        // The next term of a square, 0.12/N^1.59 (VALUES.md), leaves 0.040/N^1.59: 1.7e-4 of k on 40 x 20
        // cells.
        assert_relative_eq!(2.0 * fine - coarse, exact, max_relative = 3e-4);
    }
}

#[test]
fn a_periodic_rectangle_carries_a_wave_along_either_side() {
    // The wave runs along x in the theory; its crest is repeated along y whatever the other side.
    let amplitude = 0.01;
    let square = Surface::Sine { amplitude, wavelength: 1.0, size: 1.0.into() };
    let mut theory_scene = Scene::new(square, 1.0);
    theory_scene.effects.boundary = Boundary::Periodic;
    let mut theory = Westergaard.prepare(&theory_scene, 0).unwrap();
    let wave = |i: usize, n: usize| amplitude * (2.0 * PI * (i as f64 + 0.5) / n as f64).cos();
    for ratio in [0.3, 0.8] {
        let force = ratio * PI * amplitude;
        let exact = theory.solve(Load::force(force)).unwrap().stiffness.unwrap();
        for (cells, size, along_x) in
            [([250, 9], [1.0, 0.3], true), ([7, 250], [0.2, 1.0], false), ([250, 1], [1.0, 2.0], true)]
        {
            let map = map(cells, size, |x, y| if along_x { wave(x, cells[0]) } else { wave(y, cells[1]) });
            // Force and stiffness grow with the area.
            let area = size[0] * size[1];
            let state =
                prepared(&map, Boundary::Periodic, Method::Auto).solve(Load::force(force * area)).unwrap();
            assert_relative_eq!(state.stiffness.unwrap(), exact * area, max_relative = 6.0 / 250.0);
        }
    }
}

#[test]
fn undefined_points_do_not_touch_and_change_nothing_else() {
    // The same map with its deepest half undefined: where nothing of it touched, nothing changes.
    let whole = waves([20, 12], [1.0, 1.5], 9);
    let mut sorted: Vec<f64> = whole.heights().to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let masked = map([20, 12], [1.0, 1.5], |x, y| {
        let h = whole.heights()[y * 20 + x];
        if h < median { f64::NAN } else { h }
    });
    assert_eq!(masked.undefined(), 120);
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let mut contacts = [&whole, &masked].map(|map| prepared(map, boundary, Method::Auto));
        for force in [1e-5, 1e-3, 0.01] {
            let states = contacts.each_mut().map(|c| c.solve(Load::force(force)).unwrap());
            let [a, b] = &states;
            assert!(a.report.contact_cells.unwrap() < 100);
            assert_relative_eq!(a.stiffness.unwrap(), b.stiffness.unwrap(), max_relative = SAME);
            let largest = pressure(a).iter().copied().fold(0.0, f64::max);
            for (p, q) in pressure(a).iter().zip(pressure(b)) {
                assert_relative_eq!(p, q, epsilon = 1e-8 * largest);
            }
        }
        // Heavy loads press on the defined points alone.
        let state = contacts[1].solve(Load::force(100.0)).unwrap();
        assert_eq!(state.report.contact_cells, Some(120));
        assert_relative_eq!(state.area.unwrap(), 0.75, max_relative = 1e-12);
    }
}

#[test]
fn time_follows_the_number_of_cells_not_the_longer_side() {
    // Work, not time: a strip takes about the applications of a square with as many cells.
    let work = |cells: [usize; 2], size: [f64; 2]| -> usize {
        let map = map(cells, size, noise(2));
        let mut contact = prepared(&map, Boundary::Free, Method::Auto);
        [0.01, 1.0, 30.0].iter().map(|&f| contact.solve(Load::force(f)).unwrap().report.applications).sum()
    };
    let (square, strip) = (work([64, 64], [1.0, 1.0]), work([512, 8], [8.0, 0.125]));
    assert!(strip as f64 <= 1.5 * square as f64, "{strip} {square}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, rng_seed: RngSeed::Fixed(13), ..ProptestConfig::default() })]

    #[test]
    fn random_rectangles_with_undefined_points_equal_plain_sums(
        columns in 1usize..12, rows in 1usize..12,
        aspect in -2.0..2.0_f64, seed in 0usize..1000,
        undefined in 0.0..0.7_f64, approach in 0.02..1.5_f64,
    ) {
        let rough = noise(seed);
        let size = [aspect.exp2() * columns as f64, rows as f64];
        let mask = noise(seed + 7000);
        let drawn = map([columns, rows], size, |x, y| {
            if (x, y) != (columns / 2, rows / 2) && mask(x, y) < undefined { f64::NAN } else { rough(x, y) }
        });
        let slow = relaxed(&drawn, approach);
        let state = prepared(&drawn, Boundary::Free, Method::Iterative).solve(Load::approach(approach)).unwrap();
        prop_assert!((state.force / slow.force - 1.0).abs() < 1e-7, "{} {}", state.force, slow.force);
        let undefined_pressed = pressure(&state).iter().zip(drawn.heights()).any(|(p, h)| *p > 0.0 && !h.is_finite());
        prop_assert!(!undefined_pressed);
    }
}

/// The reported resolution of a flat rectangle in full contact, compared with numbers by hand.
#[test]
fn resolution_of_a_full_rectangle() {
    let mut scene = Scene::new(Surface::Flat { size: [2.0, 1.5].into() }, 1.0);
    (scene.outputs.area, scene.outputs.pressure) = (true, true);
    let solve = |scene: &Scene| {
        let model = Bem3d { cells: 5, rows: Some(3), ..Bem3d::default() };
        model.prepare(scene, 0).unwrap().solve(Load::force(1.0)).unwrap()
    };
    let state = solve(&scene);
    let (found, pressure) = (state.resolution.unwrap(), state.pressure().unwrap());
    let largest = pressure.values().iter().copied().fold(0.0, f64::max);
    assert_relative_eq!(found.largest_pressure.unwrap(), largest, max_relative = 1e-12);
    // Cells of 0.4 x 0.5.
    assert_relative_eq!(found.largest_share, 0.2 * largest, max_relative = 1e-9);
    // All but the three in the middle; 2 (5 + 3) edges of cells around.
    assert_eq!(found.edge_cells, 12);
    let per_edge = contact_model::ContactResolution::AREA_PER_EDGE;
    assert_relative_eq!(found.corrected_area.unwrap(), 0.2 * (15.0 - 16.0 * per_edge), max_relative = 1e-12);
    assert_relative_eq!(per_edge, 0.118_114, max_relative = 1e-5);
    // Around a period there is no edge, and an area that nobody asked for is not corrected.
    scene.effects.boundary = Boundary::Periodic;
    let periodic = solve(&scene).resolution.unwrap();
    assert_eq!(periodic.edge_cells, 0);
    assert_relative_eq!(periodic.corrected_area.unwrap(), 3.0, max_relative = 1e-12);
    scene.outputs.area = false;
    assert_eq!(solve(&scene).resolution.unwrap().corrected_area, None);
}

/// Cells in contact that border an undefined point, and the largest pressure with adhesion, compared with the field.
#[test]
fn the_rim_of_undefined_points_and_the_largest_pressure_with_adhesion() {
    const CELLS: usize = 21;
    // A paraboloid with a hole of two cells at its summit and one at the edge of the map.
    let height = |i: usize| {
        let (column, row) = (i % CELLS, i / CELLS);
        let (x, y) = (column as f64 - 10.0, row as f64 - 10.0);
        let is_hole = row == 10 && (column == 10 || column == 11) || i == 0;
        if is_hole { f64::NAN } else { -1e-3 * (x * x + y * y) }
    };
    let heights = (0..CELLS * CELLS).map(height).collect();
    let map = HeightMap::with_undefined([CELLS, CELLS], [1.0, 1.0], heights).unwrap();
    let mut scene = Scene::new(Surface::Heights(Arc::new(map)), 1.0);
    (scene.outputs.area, scene.outputs.pressure) = (true, true);
    let solve = |scene: &Scene, force: f64| {
        let model = Bem3d { cells: CELLS, ..Bem3d::default() };
        model.prepare(scene, 0).unwrap().solve(Load::force(force)).unwrap()
    };
    let compare = |state: &ContactState, rim: usize| {
        let (found, pressure) = (state.resolution.unwrap(), state.pressure().unwrap());
        let largest = pressure.values().iter().copied().fold(0.0, f64::max);
        assert_relative_eq!(found.largest_pressure.unwrap(), largest, max_relative = 1e-12);
        assert_eq!(found.rim_cells, rim, "{found:?}");
    };
    // The six cells around the hole, and two more at the corner once everything touches.
    compare(&solve(&scene, 0.02), 6);
    compare(&solve(&scene, 3.0), 8);
    scene.effects.adhesion = Adhesion::ShortRange { work: 1e-4 };
    compare(&solve(&scene, 0.02), 6);
    let pulled = solve(&scene, -1e-4);
    compare(&pulled, 6);
    assert!(pulled.resolution.unwrap().edge_cells == 0 && pulled.resolution.unwrap().largest_share > 0.0);
}
