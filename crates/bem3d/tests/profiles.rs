//! Profiles, bodies uniform along y: Hertz's line contact, Westergaard's wave, and a dense reference in two
//! dimensions that shares no code with the solver.

#![allow(clippy::unwrap_used)] // Helpers of tests.

use bem3d::{Bem3d, ContactModel, ContactState, Hardness, Load, Method, Scene, Step, Surface};
use contact_model::{Adhesion, Boundary, Conductance, HeightMap};
use std::f64::consts::PI;
use std::sync::Arc;

const MODULUS: f64 = 2.0;

/// A scene of heights at the middles of `n` strips over a length of 1 and a width along y.
fn scene(n: usize, width: f64, boundary: Boundary, height: impl Fn(f64) -> f64) -> Scene {
    let at = |ix: usize, _| height((ix as f64 + 0.5) / n as f64);
    let map = HeightMap::from_fn([n, 1], [1.0, width], at).unwrap();
    let mut scene = Scene::new(Surface::Profile(Arc::new(map)), MODULUS);
    scene.effects.boundary = boundary;
    (scene.outputs.area, scene.outputs.pressure, scene.outputs.gap) = (true, true, true);
    scene.outputs.mean_gap = boundary == Boundary::Periodic;
    scene
}

fn solved(scene: &Scene, force: f64) -> ContactState {
    let model = Bem3d { tolerance: 1e-9, ..Bem3d::default() };
    model.prepare(scene, 0).unwrap().solve(Load::force(force)).unwrap()
}

fn pressure(state: &ContactState) -> &[f64] {
    state.pressure().unwrap().values()
}

fn rough(x: f64) -> f64 {
    let wave = |k: f64, phase: f64| (2.0 * PI * k * x + phase).cos() / k.powf(1.3);
    0.01 * [1.0, 2.0, 3.0, 5.0, 9.0, 17.0, 29.0].iter().map(|&k| wave(k, k * k)).sum::<f64>()
}

/// Half-width and largest pressure of a cylinder of radius R under the force F' per length:
/// `a^2 = 4 F' R/(pi E*)`, `p0 = 2 F'/(pi a)`.
#[test]
fn a_cylinder_is_the_line_contact_of_hertz() {
    let (radius, per_length) = (2.0, 0.01);
    let a = (4.0 * per_length * radius / (PI * MODULUS)).sqrt();
    let p0 = 2.0 * per_length / (PI * a);
    let mut errors = Vec::new();
    // The force is per length: strips of any width along y have the same pressure.
    for (n, width) in [(64, 1.0 / 64.0), (256, 0.01), (1024, 1.0), (4096, 1.0 / 4096.0)] {
        let body = scene(n, width, Boundary::Free, |x| -(x - 0.5).powi(2) / (2.0 * radius));
        let state = solved(&body, per_length * width);
        assert_eq!((state.approach, state.stiffness, state.mean_gap), (None, None, None));
        let resolution = state.resolution.unwrap();
        assert_eq!((resolution.edge_cells, resolution.corrected_area), (0, None));
        let step = 1.0 / n as f64;
        let half_width = state.area.unwrap() / width / 2.0;
        assert!((half_width - a).abs() <= 1.001 * step, "{n}: {half_width} {a}");
        let error = pressure(&state).iter().enumerate().map(|(i, p)| {
            let x = (i as f64 + 0.5) * step - 0.5;
            (p - p0 * (1.0 - (x / a).powi(2)).max(0.0).sqrt()).abs() / p0
        });
        let mean = error.sum::<f64>() * step / (2.0 * a);
        let largest = pressure(&state).iter().copied().fold(0.0, f64::max);
        println!("{n} strips: a {:.5}, p0 {:.6}, mean error {mean:.2e}", half_width / a, largest / p0);
        errors.push((mean, (largest / p0 - 1.0).abs()));
        // The gap beside the contact, whatever displacements are counted from: u(x) - u(0) outside of a
        // Hertzian strip.
        let gap = state.gap().unwrap().values();
        let outside = |x: f64| {
            let s = x / a;
            let root = (s * s - 1.0).sqrt();
            a * a / (2.0 * radius) * (s * root - (s + root).ln())
        };
        for i in [0, n / 8, n / 4] {
            let x = 0.5 - (i as f64 + 0.5) * step;
            assert!((gap[i] / outside(x) - 1.0).abs() < 60.0 * step, "{n}, {i}: {} {}", gap[i], outside(x));
        }
    }
    // Where an edge falls between two strips decides half of each error: the order shows over all grids.
    assert!(errors[3].0 < errors[0].0 / 100.0, "order of the mean error of the pressure: {errors:?}");
    assert!(errors[3].0 < 1e-5 && errors[3].1 < 1e-5, "{errors:?}");
}

/// Contact width `(2/pi) asin sqrt(r)`, mean gap `D (1 - r + r ln r)`, stiffness per area `pi E*/(w ln(1/r))`
/// with `r = p/p*`.
#[test]
fn a_periodic_wave_is_that_of_westergaard() {
    let (amplitude, width) = (0.01, 0.3);
    let full = PI * MODULUS * amplitude;
    for r in [0.05_f64, 0.3, 0.7, 0.95] {
        let mut errors = Vec::new();
        for n in [64, 256, 1024, 4096] {
            let wave = scene(n, width, Boundary::Periodic, |x| amplitude * (2.0 * PI * x).cos());
            let state = solved(&wave, r * full * width);
            let fraction = state.area.unwrap() / width;
            let half = r.sqrt().asin() / PI;
            assert!((fraction - 2.0 * half).abs() <= 2.001 / n as f64, "{fraction}");
            let gap = amplitude * (1.0 - r + r * r.ln());
            let stiffness = width * PI * MODULUS / (1.0 / r).ln();
            let error = |found: f64, exact: f64| (found / exact - 1.0).abs();
            let p = |x: f64| {
                let (s, b) = ((PI * x).sin(), (PI * half).sin());
                2.0 * full * (PI * x).cos() * (b * b - s * s).max(0.0).sqrt()
            };
            let misses = pressure(&state).iter().enumerate().map(|(i, found)| {
                let x = (i as f64 + 0.5) / n as f64;
                (found - p(x.min(1.0 - x))).abs() / full
            });
            errors.push([
                misses.sum::<f64>() / n as f64,
                error(state.mean_gap.unwrap(), gap),
                error(state.stiffness.unwrap(), stiffness),
            ]);
        }
        println!("r = {r}: pressure, mean gap, stiffness {errors:?}");
        let [pressure, gap, stiffness] = errors[3];
        assert!(pressure < 1e-4 && gap < 2e-4 && stiffness < 5e-3, "{errors:?}");
        assert!(errors.windows(2).all(|pair| pair[1][0] < pair[0][0] / 2.0), "{errors:?}");
    }
}

/// Displacement between two strips of width a at a distance x under unit pressure, by quadrature of the
/// logarithm, times pi E*.
fn influence(x: f64, a: f64, periodic: bool) -> f64 {
    // -2 ln|x|, and for a period of 1 the sum over images without its mean: -2 ln|2 sin(pi x)|.
    let smooth = |x: f64| {
        if !periodic {
            return 0.0;
        }
        let angle = PI * x;
        -2.0 * if angle.abs() < 1e-8 { (2.0 * PI).ln() } else { (2.0 * angle.sin() / x).abs().ln() }
    };
    let integral = |u: f64| if u.abs() > 0.0 { u * u.abs().ln() - u } else { 0.0 };
    let singular = -2.0 * (integral(x + a / 2.0) - integral(x - a / 2.0));
    // Gauss's three points for the smooth rest.
    let at = (0.6_f64).sqrt() * a / 2.0;
    singular + a * (5.0 * smooth(x - at) + 8.0 * smooth(x) + 5.0 * smooth(x + at)) / 18.0
}

/// Pressure and position of the plane by Gauss-Seidel, with each pressure between 0 and `hardness`, and
/// bisection in the position until the pressures carry the force.
fn reference(heights: &[f64], periodic: bool, per_length: f64, hardness: f64) -> Vec<f64> {
    let n = heights.len();
    let a = 1.0 / n as f64;
    // Lags the shorter way round. The constant makes every entry positive; it only moves the plane.
    let entry: Vec<f64> = (0..n)
        .map(|lag| {
            let lag = if periodic { lag.min(n - lag) } else { lag };
            (influence(lag as f64 * a, a, periodic) + 8.0 * a) / (PI * MODULUS)
        })
        .collect();
    let top = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut p = vec![0.0; n];
    let mut settle = |plane: f64| {
        for _ in 0..20_000 {
            let mut change = 0.0f64;
            for i in 0..n {
                let u: f64 = p.iter().enumerate().map(|(j, p)| entry[i.abs_diff(j)] * p).sum();
                let gap = u + top - heights[i] - plane;
                let next = (p[i] - gap / entry[0]).clamp(0.0, hardness);
                change = change.max((next - p[i]).abs());
                p[i] = next;
            }
            if change < 1e-11 * MODULUS {
                break;
            }
        }
        (p.iter().sum::<f64>() * a, p.clone())
    };
    let (mut low, mut high) = (0.0, 1.0);
    let mut found = Vec::new();
    for _ in 0..50 {
        let plane = f64::midpoint(low, high);
        let (force, p) = settle(plane);
        if force < per_length {
            low = plane;
        } else {
            high = plane;
        }
        found = p;
        if (force / per_length - 1.0).abs() < 1e-9 {
            break;
        }
    }
    found
}

#[test]
fn rough_lines_are_those_of_a_dense_reference() {
    let n = 48;
    let heights: Vec<f64> = (0..n).map(|i| rough((i as f64 + 0.5) / n as f64)).collect();
    for boundary in [Boundary::Free, Boundary::Periodic] {
        for (mean, hardness) in [(0.002, None), (0.02, None), (0.02, Some(0.12))] {
            let mut body = scene(n, 0.7, boundary, rough);
            if let Some(pressure) = hardness {
                body.effects.hardness = Hardness::Limit { pressure };
            }
            let state = solved(&body, mean * 0.7);
            let limit = hardness.unwrap_or(f64::INFINITY);
            let expected = reference(&heights, boundary == Boundary::Periodic, mean, limit);
            let scale = expected.iter().copied().fold(0.0, f64::max);
            for (i, (found, expected)) in pressure(&state).iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).abs() < 2e-6 * scale,
                    "{boundary:?} {mean} {hardness:?} {i}: {found} {expected}"
                );
            }
            if hardness.is_some() {
                let yielded = expected.iter().filter(|&&p| p >= limit).count();
                assert!(yielded > 0, "some cells are at the hardness");
                let area = yielded as f64 / n as f64 * 0.7;
                assert!((state.plastic.unwrap().area - area).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn every_method_and_a_long_line_agree() {
    for n in [257, 5000] {
        let body = scene(n, 1.0, Boundary::Free, rough);
        for mean in [1e-4, 0.01, 0.05] {
            let by = |method| {
                let model = Bem3d { tolerance: 1e-9, method, ..Bem3d::default() };
                model.prepare(&body, 0).unwrap().solve(Load::force(mean)).unwrap()
            };
            let (auto, single, iterative) =
                (by(Method::Auto), by(Method::SingleLevel), by(Method::Iterative));
            assert_eq!(auto.area, single.area, "{n} {mean}");
            for other in [&single, &iterative] {
                let scale = pressure(&auto).iter().copied().fold(0.0, f64::max);
                let miss = pressure(&auto).iter().zip(pressure(other)).map(|(a, b)| (a - b).abs());
                assert!(miss.fold(0.0, f64::max) < 1e-5 * scale, "{n} {mean}");
            }
        }
    }
}

#[test]
fn a_warm_start_is_a_cold_one() {
    let body = scene(400, 1.0, Boundary::Free, rough);
    let model = Bem3d { tolerance: 1e-9, ..Bem3d::default() };
    let mut warm = model.prepare(&body, 0).unwrap();
    for force in [1e-4, 3e-4, 1e-3, 1e-2, 5e-2, 1e-3] {
        let state = warm.solve(Load::force(force)).unwrap();
        assert_eq!(state.area, solved(&body, force).area, "{force}");
        assert!(state.report.certificate.meets(1e-9));
    }
}

#[test]
fn outputs_that_a_half_plane_lacks_are_refused_with_the_reason() {
    let body = scene(32, 1.0, Boundary::Free, rough);
    let refused = |scene: &Scene| Bem3d::default().prepare(scene, 0).map(|_| ()).unwrap_err().to_string();
    let mut contact = Bem3d::default().prepare(&body, 0).unwrap();
    let error = contact.solve(Load::approach(0.01)).unwrap_err().to_string();
    assert!(error.contains("no zero at infinity"), "{error}");
    assert!(contact.solve(Load::mean_gap(0.01)).is_err());
    let mut displaced = body.clone();
    displaced.outputs.displacement = true;
    assert!(refused(&displaced).contains("no zero at infinity"));
    let mut conducting = body.clone();
    conducting.outputs.conductance = Conductance::Electrical { first: 1.0, second: 0.0 };
    assert!(refused(&conducting).contains("conductance"));
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let mut sticky = scene(32, 1.0, boundary, rough);
        sticky.effects.adhesion = Adhesion::ShortRange { work: 1e-3 };
        assert!(refused(&sticky).contains("adhesion of a profile"));
        assert!(Bem3d::default().prepare(&sticky, 0).is_err());
    }
    // A profile has one row.
    let map = HeightMap::new([2, 2], 1.0, vec![0.0; 4]).unwrap();
    assert!(refused(&Scene::new(Surface::Profile(Arc::new(map)), 1.0)).contains("rows of a profile"));
}

#[test]
fn a_path_with_hardness_keeps_its_indentation() {
    let mut body = scene(200, 1.0, Boundary::Free, |x| -(x - 0.5).powi(2));
    body.effects.hardness = Hardness::Limit { pressure: 0.1 };
    let mut path = Bem3d::default().prepare(&body, 0).unwrap();
    let loaded = path.advance(Step::new(1.0, Load::force(0.02))).unwrap();
    let unloaded = path.advance(Step::new(2.0, Load::force(0.0))).unwrap();
    assert!(loaded.plastic.unwrap().area > 0.0 && loaded.approach.is_none());
    assert!((unloaded.plastic.unwrap().volume / loaded.plastic.unwrap().volume - 1.0).abs() < 1e-12);
}

#[test]
fn two_points_one_point_and_undefined_points() {
    for boundary in [Boundary::Free, Boundary::Periodic] {
        for n in [1, 2, 3] {
            let state = solved(&scene(n, 1.0, boundary, |x| -0.01 * x), 0.01);
            assert!(
                (pressure(&state).iter().sum::<f64>() / n as f64 - 0.01).abs() < 1e-12,
                "{boundary:?} {n}"
            );
        }
        let heights: Vec<f64> =
            (0..64).map(|i| if i % 7 == 0 { f64::NAN } else { rough((f64::from(i) + 0.5) / 64.0) }).collect();
        let map = HeightMap::with_undefined([64, 1], [1.0, 1.0], heights).unwrap();
        let mut holed = scene(64, 1.0, boundary, rough);
        holed.surface = Surface::Profile(Arc::new(map));
        let state = solved(&holed, 0.02);
        assert!((0..64).step_by(7).all(|i| pressure(&state)[i] == 0.0));
    }
}
