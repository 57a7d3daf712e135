//! Planes against sums over cells, images, Hertz's contact, symmetries, and input that makes no sense.

use super::*;
use contact_model::{Boundary, Error, Field, Fields, never};
use proptest::prelude::*;
use std::f64::consts::PI;

mod hertz;
mod hostile;
mod images;

/// What a transform and a sum leave of the largest stress.
const TRANSFORM: f64 = 2e-14;

/// Numbers in [-1, 1) that look random.
fn numbers(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(next).collect()
}

/// A load of all three components on `cells` cells.
fn full_load(cells: [usize; 2], size: [f64; 2], seed: u64) -> SurfaceLoad {
    let field = |part: u64| Field::new(cells, size, numbers(cells[0] * cells[1], 3 * seed + part)).unwrap();
    SurfaceLoad::with_traction(field(0), [field(1), field(2)]).unwrap()
}

/// The centres of all cells at a depth.
fn centres(load: &SurfaceLoad, depth: f64) -> Vec<[f64; 3]> {
    let (dx, dy) = (load.pressure().dx(), load.pressure().dy());
    let rows = 0..load.cells().rows;
    let centre = |iy: usize| move |ix: usize| [(ix as f64 + 0.5) * dx, (iy as f64 + 0.5) * dy, depth];
    rows.flat_map(|iy| (0..load.cells().columns).map(centre(iy))).collect()
}

fn stresses(plane: &StressField) -> Vec<[f64; 6]> {
    let cells = plane.xx().cells();
    (0..cells.rows).flat_map(|iy| (0..cells.columns).map(move |ix| plane.at(ix, iy))).collect()
}

/// The largest difference over the largest value of the first.
fn relative_difference(a: &[[f64; 6]], b: &[[f64; 6]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = a.as_flattened().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs())) / largest
}

#[test]
fn planes_are_sums_over_cells() {
    for (cells, size) in
        [([1, 1], [1.0, 1.0]), ([9, 7], [4.0, 2.0]), ([5, 16], [0.02, 3.0]), ([1, 12], [1.0, 6.0])]
    {
        for nu in [0.0, 0.3, 0.5] {
            let load = full_load(cells, size, 1);
            let body = StressedBody::new(nu);
            let depths = [0.0, 1e-3, 0.21, 3.0, 80.0, 1e4].map(|ratio| ratio * load.pressure().dy());
            let planes = stress_at_depths(&load, body, &depths, &never).unwrap();
            for (plane, depth) in planes.iter().zip(depths) {
                let expected = stress_at_points(&load, body, &centres(&load, depth), &never).unwrap();
                let difference = relative_difference(&expected, &stresses(plane));
                assert!(difference < TRANSFORM, "{cells:?} {nu} {depth}: {difference:e}");
            }
        }
    }
}

#[test]
fn large_planes_are_sums_over_cells() {
    // Some cells only, because each of them is a sum over all.
    for (cells, size, every) in [([128, 90], [4.0, 3.0], 1201), ([10_000, 1], [100.0, 0.01], 1801)] {
        let load = full_load(cells, size, 6);
        for ratio in [0.0, 0.3, 25.0, 2000.0] {
            let depth = ratio * load.pressure().dy();
            let pick = |all: Vec<[f64; 6]>| all.into_iter().step_by(every).collect::<Vec<_>>();
            let places: Vec<[f64; 3]> = centres(&load, depth).into_iter().step_by(every).collect();
            let expected = stress_at_points(&load, StressedBody::new(0.3), &places, &never).unwrap();
            let found = pick(at_depth(&load, StressedBody::new(0.3), depth));
            let difference = relative_difference(&expected, &found);
            assert!(difference < 10.0 * TRANSFORM, "{cells:?} {depth}: {difference:e}");
        }
    }
}

#[test]
fn a_pressure_alone_takes_the_same_way() {
    let load = full_load([12, 10], [1.2, 1.0], 4);
    let pressure = SurfaceLoad::new(load.pressure().clone()).unwrap();
    let none = || Field::new([12, 10], [1.2, 1.0], vec![0.0; 120]).unwrap();
    let with_zeros = SurfaceLoad::with_traction(load.pressure().clone(), [none(), none()]).unwrap();
    for &boundary in Boundary::ALL {
        for periodic in [PeriodicLoad::Cells, PeriodicLoad::Waves] {
            let body = StressedBody { boundary, periodic, ..StressedBody::new(0.3) };
            let [a, b] = [&pressure, &with_zeros].map(|load| {
                let plane = SubsurfaceStress::new(load, body).unwrap().at_depth(0.03, &never).unwrap();
                stresses(&plane)
            });
            assert!(relative_difference(&a, &b) < TRANSFORM, "{boundary:?}");
        }
    }
}

#[test]
fn waves_of_the_grid_have_their_closed_form() {
    let (cells, size, nu) = ([16, 12], [2.0, 1.0], 0.3);
    let body =
        StressedBody { boundary: Boundary::Periodic, periodic: PeriodicLoad::Waves, ..StressedBody::new(nu) };
    for (mx, my) in [(1, 0), (3, 0), (0, 2), (2, 5)] {
        let (kx, ky) = (2.0 * PI * f64::from(mx) / size[0], 2.0 * PI * f64::from(my) / size[1]);
        let q = kx.hypot(ky);
        let phase = |ix: usize, iy: usize| kx * (ix as f64 + 0.5) * 0.125 + ky * (iy as f64 + 0.5) / 12.0;
        let values = (0..192).map(|i| phase(i % 16, i / 16).cos()).collect();
        let load = SurfaceLoad::new(Field::new(cells, size, values).unwrap()).unwrap();
        for z in [0.0, 0.02, 0.3] {
            let plane = SubsurfaceStress::new(&load, body).unwrap().at_depth(z, &never).unwrap();
            let (fall, deep) = ((-q * z).exp(), q * z);
            // The stress along the wave, and across it, turned to the axes.
            let (along, across) = (-(1.0 - deep) * fall, -2.0 * nu * fall);
            let (c, s) = (kx / q, ky / q);
            let expected = |ix: usize, iy: usize| {
                let (cos, sin) = (phase(ix, iy).cos(), phase(ix, iy).sin());
                [
                    (along * c * c + across * s * s) * cos,
                    (along * s * s + across * c * c) * cos,
                    -(1.0 + deep) * fall * cos,
                    -deep * fall * s * sin,
                    -deep * fall * c * sin,
                    (along - across) * c * s * cos,
                ]
            };
            let expected: Vec<_> = (0..192).map(|i| expected(i % 16, i / 16)).collect();
            // Of the wave at the surface: rounding of longer waves, which fall more slowly, reaches further
            // down.
            let error = expected
                .iter()
                .zip(stresses(&plane))
                .flat_map(|(a, b)| std::array::from_fn::<f64, 6, _>(|i| a[i] - b[i]));
            assert!(error.into_iter().all(|error| error.abs() < TRANSFORM), "{mx} {my} {z}");
        }
    }
}

#[test]
fn a_uniform_load_on_a_periodic_map_is_one_of_a_confined_body() {
    let uniform = |value: f64| Field::new([5, 4], 1.0, vec![value; 20]).unwrap();
    let load = SurfaceLoad::with_traction(uniform(2.0), [uniform(0.5), uniform(-0.25)]).unwrap();
    let body = StressedBody { boundary: Boundary::Periodic, ..StressedBody::new(0.25) };
    for depth in [0.0, 0.1, 30.0] {
        let plane = SubsurfaceStress::new(&load, body).unwrap().at_depth(depth, &never).unwrap();
        let lateral = -2.0 * 0.25 / 0.75;
        let expected = [[lateral, lateral, -2.0, 0.25, -0.5, 0.0]; 20];
        assert!(relative_difference(&expected, &stresses(&plane)) < TRANSFORM);
    }
}

#[test]
fn the_bodies_of_a_state_have_opposite_tractions() {
    let load = full_load([6, 5], [1.0, 1.0], 2);
    let mut fields = Fields::default();
    assert!(matches!(SurfaceLoad::of_state(&fields, LoadedBody::First), Err(Error::Shape { found: 0, .. })));
    fields.pressure = Some(load.pressure().clone());
    let alone = SurfaceLoad::of_state(&fields, LoadedBody::Second).unwrap();
    assert!(alone.traction().is_none());
    fields.traction = load.traction().cloned();
    assert_eq!(SurfaceLoad::of_state(&fields, LoadedBody::First).unwrap(), load);
    let second = SurfaceLoad::of_state(&fields, LoadedBody::Second).unwrap();
    // Seen from the first body, whose z has the other sign, action is reaction.
    let [first, second] = [&load, &second].map(|load| {
        stress_at_depths(load, StressedBody::new(0.3), &[0.0], &never).unwrap().remove(0).into_components()
    });
    for (component, sign) in [(2, 1.0), (3, -1.0), (4, -1.0)] {
        let pairs = first[component].values().iter().zip(second[component].values());
        assert!(pairs.into_iter().all(|(a, b)| (a - sign * b).abs() < TRANSFORM));
    }
}

#[test]
fn a_section_is_a_line_of_each_plane() {
    let load = full_load([6, 4], [3.0, 1.0], 5);
    let (body, depths) = (StressedBody::new(0.2), [0.0, 0.4]);
    let planes = stress_at_depths(&load, body, &depths, &never).unwrap();
    let row = stress_section(&load, body, SectionLine::Row(2), &depths, &never).unwrap();
    let column = stress_section(&load, body, SectionLine::Column(5), &depths, &never).unwrap();
    for (i, plane) in planes.iter().enumerate() {
        let bits = |stress: [f64; 6]| stress.map(f64::to_bits);
        assert!((0..6).all(|ix| bits(row.stress[6 * i + ix]) == bits(plane.at(ix, 2))));
        assert!((0..4).all(|iy| bits(column.stress[4 * i + iy]) == bits(plane.at(5, iy))));
    }
    assert_eq!((row.positions[1], column.positions[3]), (0.75, 0.875));
}

/// Boundaries, and a load between centres, of a random case.
fn bodies() -> impl Strategy<Value = StressedBody> {
    let boundary = prop::sample::select(Boundary::ALL);
    let periodic = prop::sample::select(&[PeriodicLoad::Cells, PeriodicLoad::Waves][..]);
    (boundary, periodic, 0.0..=0.5).prop_map(|(boundary, periodic, poisson)| StressedBody {
        poisson,
        boundary,
        periodic,
    })
}

fn at_depth(load: &SurfaceLoad, body: StressedBody, depth: f64) -> Vec<[f64; 6]> {
    stresses(&SubsurfaceStress::new(load, body).unwrap().at_depth(depth, &never).unwrap())
}

/// The fields of a load, each by a function of its place among pressure, traction along x and along y.
fn changed(load: &SurfaceLoad, change: impl Fn(usize, &Field) -> Field) -> SurfaceLoad {
    let [x, y] = load.traction().unwrap();
    SurfaceLoad::with_traction(change(0, load.pressure()), [change(1, x), change(2, y)]).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn stresses_superpose(body in bodies(), seed in 0..100_u64, depth in 0.0..3.0_f64, factor in -3.0..3.0_f64) {
        let [a, b] = [seed, seed + 100].map(|seed| full_load([7, 6], [2.0, 1.0], seed));
        let both = |part: usize, field: &Field| {
            let other = [b.pressure(), &b.traction().unwrap()[0], &b.traction().unwrap()[1]][part];
            let values = field.values().iter().zip(other.values()).map(|(a, b)| a + factor * b);
            Field::new([7, 6], [2.0, 1.0], values.collect()).unwrap()
        };
        let found = at_depth(&changed(&a, both), body, depth);
        let parts = at_depth(&a, body, depth).into_iter().zip(at_depth(&b, body, depth));
        let expected: Vec<[f64; 6]> = parts.map(|(a, b)| std::array::from_fn(|i| a[i] + factor * b[i])).collect();
        prop_assert!(relative_difference(&expected, &found) < 50.0 * TRANSFORM);
    }

    #[test]
    fn exchanged_axes_exchange_components(body in bodies(), seed in 0..100_u64, depth in 0.0..3.0_f64) {
        let load = full_load([7, 6], [2.0, 1.0], seed);
        let turn = |field: &Field| {
            let values = (0..7).flat_map(|ix| (0..6).map(move |iy| field.at(ix, iy)));
            Field::new([6, 7], [1.0, 2.0], values.collect()).unwrap()
        };
        let [x, y] = load.traction().unwrap();
        let turned = SurfaceLoad::with_traction(turn(load.pressure()), [turn(y), turn(x)]).unwrap();
        let boundary = match body.boundary {
            Boundary::PeriodicAlongX => Boundary::PeriodicAlongY,
            Boundary::PeriodicAlongY => Boundary::PeriodicAlongX,
            other => other,
        };
        let (here, there) = (at_depth(&load, body, depth), at_depth(&turned, StressedBody { boundary, ..body }, depth));
        let back = (0..42).map(|i| {
            let [xx, yy, zz, yz, xz, xy] = there[(i % 7) * 6 + i / 7];
            [yy, xx, zz, xz, yz, xy]
        });
        prop_assert!(relative_difference(&here, &back.collect::<Vec<_>>()) < 20.0 * TRANSFORM);
    }

    #[test]
    fn a_mirrored_load_has_the_mirrored_stress(body in bodies(), seed in 0..100_u64, depth in 0.0..3.0_f64) {
        let load = full_load([7, 6], [2.0, 1.0], seed);
        let mirror = |part: usize, field: &Field| {
            let sign = if part == 1 { -1.0 } else { 1.0 };
            let values = (0..42).map(|i| sign * field.at(6 - i % 7, i / 7));
            Field::new([7, 6], [2.0, 1.0], values.collect()).unwrap()
        };
        let (here, there) = (at_depth(&load, body, depth), at_depth(&changed(&load, mirror), body, depth));
        let back = (0..42).map(|i| {
            let [xx, yy, zz, yz, xz, xy] = there[i - i % 7 + 6 - i % 7];
            [xx, yy, zz, yz, -xz, -xy]
        });
        prop_assert!(relative_difference(&here, &back.collect::<Vec<_>>()) < 20.0 * TRANSFORM);
    }

    #[test]
    fn a_moved_load_has_the_moved_stress(body in bodies(), seed in 0..100_u64, depth in 0.0..3.0_f64) {
        // Cells around the load are free, so that no boundary sees the move by one row and two columns.
        let inner = full_load([4, 3], [4.0, 3.0], seed);
        let inside = |move_x: usize, move_y: usize| {
            changed(&inner, |_, field| {
                let mut values = vec![0.0; 80];
                for i in 0..12 {
                    values[(i / 4 + move_y) * 10 + i % 4 + move_x] = field.values()[i];
                }
                Field::new([10, 8], [2.0, 1.0], values).unwrap()
            })
        };
        let (here, there) = (at_depth(&inside(1, 2), body, depth), at_depth(&inside(3, 3), body, depth));
        let overlap = (0..80).filter(|i| i % 10 < 8 && i / 10 < 7);
        let (a, b): (Vec<_>, Vec<_>) = overlap.map(|i| (here[i], there[i + 12])).unzip();
        prop_assert!(relative_difference(&a, &b) < 20.0 * TRANSFORM);
    }
}
