//! Maps that repeat themselves along one axis and are free along the other: contacts that go on along a line.

#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;
use bem3d::*;
use std::f64::consts::PI;
use std::sync::Arc;

const MODEL: Bem3d = Bem3d { tolerance: 1e-10, ..Bem3d::DEFAULT };

fn map([columns, rows]: [usize; 2], size: [f64; 2], height: impl Fn(f64, f64) -> f64) -> Surface {
    let center = |i: usize, n: usize, side: f64| (i as f64 + 0.5) / n as f64 * side;
    let heights = (0..columns * rows)
        .map(|k| height(center(k % columns, columns, size[0]), center(k / columns, rows, size[1])))
        .collect();
    Surface::Heights(Arc::new(HeightMap::new([columns, rows], size, heights).unwrap()))
}

fn scene(surface: Surface, boundary: Boundary) -> Scene {
    let mut scene = Scene::new(surface, 1.0);
    scene.effects.boundary = boundary;
    scene.outputs = Outputs { area: true, pressure: true, gap: true, ..Outputs::default() };
    scene
}

fn solved(scene: &Scene, force: f64) -> ContactState {
    MODEL.prepare(scene, 0).unwrap().solve(Load::force(force)).unwrap()
}

/// Heights across, of a map that is uniform along the line.
fn across(s: f64) -> f64 {
    -0.5 * (s - 0.5).powi(2) + 0.01 * (23.0 * s).sin()
}

/// A map that is uniform along the line is a profile on a half-plane.
#[test]
fn a_uniform_map_is_a_profile() {
    let profile =
        HeightMap::new([40, 1], [1.0, 0.3], (0..40).map(|i| across((f64::from(i) + 0.5) / 40.0)).collect());
    let mut plane = scene(Surface::Profile(Arc::new(profile.unwrap())), Boundary::Free);
    plane.outputs.pressure = true;
    for force in [1e-4, 3e-3] {
        let expected = solved(&plane, force);
        let of_profile = expected.pressure().unwrap().values();
        let largest = of_profile.iter().copied().fold(0.0, f64::max);
        // Along y the heights do not vary.
        for (cells, size, boundary, along_x) in [
            ([40, 12], [1.0, 0.3], Boundary::PeriodicAlongY, false),
            ([9, 40], [0.3, 1.0], Boundary::PeriodicAlongX, true),
        ] {
            let surface = map(cells, size, |x, y| across(if along_x { y } else { x }));
            let state = solved(&scene(surface, boundary), force);
            assert!(state.approach.is_none() && state.mean_gap.is_none() && state.stiffness.is_none());
            assert_relative_eq!(state.area.unwrap(), expected.area.unwrap(), max_relative = 1e-12);
            for (k, p) in state.pressure().unwrap().values().iter().enumerate() {
                let at = if along_x { k / cells[0] } else { k % cells[0] };
                assert!(
                    (p - of_profile[at]).abs() < 1e-9 * largest,
                    "{boundary:?} {k}: {p} {}",
                    of_profile[at]
                );
            }
        }
    }
}

/// A cylinder under a force for each length, by Hertz.
#[test]
fn a_cylinder_by_its_closed_form() {
    let (radius, length, force) = (2.0, 0.25, 2e-3);
    let surface = map([32, 256], [length, 0.5], |_, y| -0.5 * (y - 0.25).powi(2) / radius);
    let state = solved(&scene(surface, Boundary::PeriodicAlongX), force);
    let of_length = force / length;
    let half_width = (4.0 * of_length * radius / PI).sqrt();
    let largest = (of_length / (PI * radius)).sqrt();
    assert_relative_eq!(state.area.unwrap(), 2.0 * half_width * length, max_relative = 0.01);
    let resolution = state.resolution.unwrap();
    assert_relative_eq!(resolution.largest_pressure.unwrap(), largest, max_relative = 2e-3);
    assert_eq!(resolution.edge_cells, 0);
}

/// A ball whose copies along the line are far away is a ball: what they change falls as the cube of the period.
#[test]
fn copies_that_are_far_away_are_not_seen() {
    let force = 2e-3;
    let ball = |columns: usize, boundary| {
        let side = columns as f64 / 40.0;
        let height = |x: f64, y: f64| -0.5 * ((x - 0.5 * side).powi(2) + (y - 0.5).powi(2));
        let state = solved(&scene(map([columns, 40], [side, 1.0], height), boundary), force);
        state.resolution.unwrap().largest_pressure.unwrap()
    };
    let free = ball(40, Boundary::Free);
    let [near, far] = [80, 160].map(|columns| (ball(columns, Boundary::PeriodicAlongX) / free - 1.0).abs());
    assert!(far < 1e-4 && near / far > 6.0, "{near} {far}");
}

/// The contact of a rough map by sums over images and dense linear systems.
#[test]
fn rough_maps_beside_dense_sums() {
    let ([columns, rows], images) = ([9_usize, 7], 3000_isize);
    let height =
        |x: f64, y: f64| 0.02 * ((40.0 * x).sin() + (31.0 * y + 3.0 * x).cos() + (57.0 * x * y).sin());
    let size = [0.9, 0.7];
    let surface = map([columns, rows], size, height);
    let Surface::Heights(heights) = &surface else { unreachable!() };
    // Displacements from the point far away, up to a constant, which the force does not see.
    let mut kernel = vec![vec![0.0; columns]; rows];
    for (y, row) in kernel.iter_mut().enumerate() {
        for (x, value) in row.iter_mut().enumerate() {
            let lag = |m: isize| (x.cast_signed() + m * columns.cast_signed()).unsigned_abs();
            let sum: f64 = (-images..=images).map(|m| love::influence_of_rectangle(lag(m), y, 1.0)).sum();
            let sum_of_ones: f64 = (1..=images).map(|m| 2.0 / (m as f64 * columns as f64)).sum();
            *value = sum - sum_of_ones + 3.0;
        }
    }
    let count = columns * rows;
    let highest = heights.heights().iter().copied().fold(f64::MIN, f64::max);
    let depth: Vec<f64> = heights.heights().iter().map(|h| highest - h).collect();
    let entry = |i: usize, j: usize| {
        kernel[(i / columns).abs_diff(j / columns)][(i % columns).abs_diff(j % columns)] * 0.1 / PI
    };
    let force = 4e-3;
    // Pressures on a set and the plane above it.
    let mut set: Vec<usize> = (0..count).collect();
    let (mut pressure, mut plane) = (Vec::new(), 0.0);
    for _ in 0..60 {
        let n = set.len();
        let mut system = vec![vec![0.0; n + 2]; n + 1];
        for (i, &cell) in set.iter().enumerate() {
            for (j, &other) in set.iter().enumerate() {
                system[i][j] = entry(cell, other);
            }
            (system[i][n], system[i][n + 1]) = (-1.0, -depth[cell]);
            system[n][i] = 0.01;
        }
        system[n][n + 1] = force;
        let found = eliminated(system);
        plane = found[n];
        if found[..n].iter().all(|p| *p >= 0.0) {
            pressure = vec![0.0; count];
            set.iter().zip(&found).for_each(|(&cell, p)| pressure[cell] = *p);
            break;
        }
        set = set.iter().zip(&found).filter(|(_, p)| **p > 0.0).map(|(cell, _)| *cell).collect();
    }
    let gap = |i: usize| (0..count).map(|j| entry(i, j) * pressure[j]).sum::<f64>() + depth[i] - plane;
    assert!((0..count).all(|i| gap(i) > -1e-9), "the dense solution penetrates");
    let state = solved(&scene(surface, Boundary::PeriodicAlongX), force);
    let largest = pressure.iter().copied().fold(0.0, f64::max);
    assert!((5..count - 5).contains(&set.len()), "{}", set.len());
    assert_eq!(state.report.contact_cells, Some(set.len()));
    for (found, expected) in state.pressure().unwrap().values().iter().zip(&pressure) {
        // The sums of images are cut.
        assert!((found - expected).abs() < 1e-6 * largest, "{found} {expected}");
    }
    for (i, found) in state.gap().unwrap().values().iter().enumerate() {
        assert!((found - gap(i)).abs() < 1e-7, "{found} {}", gap(i));
    }
}

/// The solution of a small system, the right side in the last column.
fn eliminated(mut system: Vec<Vec<f64>>) -> Vec<f64> {
    let n = system.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| system[*a][k].abs().total_cmp(&system[*b][k].abs())).unwrap();
        system.swap(k, pivot);
        let above = system[k].clone();
        for (i, row) in system.iter_mut().enumerate() {
            if i != k {
                let factor = row[k] / above[k];
                row.iter_mut().zip(&above).for_each(|(value, above)| *value -= factor * above);
            }
        }
    }
    (0..n).map(|k| system[k][n] / system[k][k]).collect()
}

/// A contact across the edge that repeats itself is one patch and no contact at an edge.
#[test]
fn contacts_wrap_along_the_line_alone() {
    let ridge = |x: f64, y: f64| -((x - 0.5).abs() - 0.5).powi(2) - (y - 0.5).powi(2);
    let surface = map([32, 32], [1.0, 1.0], ridge);
    let state = |boundary| {
        let mut scene = scene(surface.clone(), boundary);
        scene.outputs.contact_patches = true;
        solved(&scene, 1e-3)
    };
    let [along, beside] = [Boundary::PeriodicAlongX, Boundary::PeriodicAlongY].map(state);
    assert_eq!(along.patches.as_ref().map(Patches::count), Some(1));
    assert_eq!(beside.patches.as_ref().map(Patches::count), Some(2));
    assert_eq!(along.resolution.unwrap().edge_cells, 0);
    assert!(beside.resolution.unwrap().edge_cells > 0);
}

/// A change of a scene.
type ChangeOfLine = fn(&mut Scene);

/// A hardness and a viscoelastic body need no other kernel; what does is refused.
#[test]
fn effects_along_a_line() {
    let surface = map([16, 64], [0.25, 1.0], |_, y| -0.5 * (y - 0.5).powi(2));
    let mut hard = scene(surface.clone(), Boundary::PeriodicAlongX);
    hard.effects.hardness = Hardness::Limit { pressure: 0.05 };
    let state = solved(&hard, 4e-3);
    assert_relative_eq!(state.resolution.unwrap().largest_pressure.unwrap(), 0.05, max_relative = 1e-9);
    let mut viscous = scene(surface.clone(), Boundary::PeriodicAlongX);
    viscous.effects.rheology = Rheology::StandardSolid { arm: Relaxing { weight: 1.0, time: 1.0 } };
    viscous.outputs.gap = false;
    let mut contact = MODEL.prepare(&viscous, 0).unwrap();
    let areas = [0.0, 100.0].map(|t| contact.advance(Step::new(t, Load::force(2e-3))).unwrap().area.unwrap());
    for (area, modulus) in areas.into_iter().zip([2.0, 1.0]) {
        let mut elastic = scene(surface.clone(), Boundary::PeriodicAlongX);
        elastic.contact_modulus = modulus;
        assert_relative_eq!(area, solved(&elastic, 2e-3).area.unwrap(), max_relative = 1e-12);
    }
    let refused: [(ChangeOfLine, &str); 5] = [
        (|scene| scene.effects.adhesion = Adhesion::ShortRange { work: 1e-6 }, "adhesion"),
        (|scene| scene.outputs.displacement = true, "displacement"),
        (
            |scene| scene.outputs.conductance = Conductance::Electrical { first: 1.0, second: 1.0 },
            "conductance",
        ),
        (
            |scene| {
                let layer = Layer { thickness: 0.1, young: 1.0, poisson: 0.0, base: LayerBase::Rigid };
                scene.effects.layer = Some(layer);
            },
            "layer",
        ),
        (
            |scene| {
                let body = Body::Elastic { young: 2.0, poisson: 0.0 };
                scene.pair = Some(Pair { first: body, second: body });
                scene.effects.friction = Friction::coulomb(0.3);
            },
            "friction",
        ),
    ];
    for (change, word) in refused {
        let mut scene = scene(surface.clone(), Boundary::PeriodicAlongX);
        change(&mut scene);
        let error = MODEL.prepare(&scene, 0).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(word) && error.contains("periodic along x alone"), "{error}");
    }
    let mut contact = MODEL.prepare(&scene(surface, Boundary::PeriodicAlongX), 0).unwrap();
    for load in [Load::approach(0.01), Load::mean_gap(0.01)] {
        assert!(matches!(contact.solve(load), Err(Error::Unsupported { .. })));
    }
}
