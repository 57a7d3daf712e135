//! Contacts with a hardness: limits, closed forms, paths.

#![allow(clippy::unwrap_used)]

use bem3d::*;
use std::sync::Arc;

const TIGHT: Bem3d = Bem3d { cells: 64, tolerance: 1e-9, ..Bem3d::DEFAULT };

/// A self-affine surface of rms height 1 with a hardness, and every output.
fn rough(hardness: Option<f64>, boundary: Boundary) -> Scene {
    let mut surface = SelfAffine::new(2.2, 1.0, 1.0).unwrap();
    surface.short_cutoff = Some(100.0);
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    scene.effects.boundary = boundary;
    scene.outputs.area = true;
    (scene.outputs.pressure, scene.outputs.gap) = (true, true);
    if let Some(pressure) = hardness {
        scene.effects.hardness = Hardness::Limit { pressure };
        scene.outputs.plastic_depth = true;
    }
    scene
}

fn solved(model: Bem3d, scene: &Scene, load: Load) -> ContactState {
    ContactModel::prepare(&model, scene, 5).unwrap().solve(load).unwrap()
}

/// Where no pressure reaches the hardness, the bits are those of the elastic state.
#[test]
fn a_large_hardness_gives_the_elastic_bits() {
    for boundary in [Boundary::Free, Boundary::Periodic] {
        for load in [0.1, 2.0, 30.0] {
            let elastic = solved(TIGHT, &rough(None, boundary), Load::force(load));
            let hard = solved(TIGHT, &rough(Some(1e6), boundary), Load::force(load));
            assert_eq!(hard.plastic, Some(PlasticState::default()));
            assert!(hard.fields.as_ref().unwrap().plastic_depth.as_ref().unwrap().integral() == 0.0);
            let bare = |state: ContactState| {
                let mut fields = state.fields.clone().unwrap();
                fields.plastic_depth = None;
                let mut state = state.with_plastic(None).with_fields(fields);
                state.report.work = Work::default();
                state
            };
            assert_eq!(bare(hard), bare(elastic), "{boundary:?} {load}");
        }
    }
}

/// A hardness far below `E*` times the slopes: the cells above a level carry the load, each with p_s.
#[test]
fn a_small_hardness_gives_the_bearing_area() {
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let (hardness, fraction) = (1e-6, 0.3);
        let scene = rough(Some(hardness), boundary);
        let force = hardness * fraction;
        let state = solved(TIGHT, &scene, Load::force(force));
        let cells = 64.0 * 64.0;
        assert!((state.area.unwrap() - fraction).abs() <= 1.0 / cells, "{:?}", state.area);
        // The correction for the boundary of elastic contacts would go below the force over the hardness.
        let corrected = state.resolution.unwrap().corrected_area.unwrap();
        assert!((corrected / fraction - 1.0).abs() < 1e-9, "{corrected}");
        let map = surface_gen::height_map(&scene.surface, TIGHT.grid(1.0.into()), 5).unwrap();
        let mut heights = map.heights().to_vec();
        heights.sort_by(|a, b| b.total_cmp(a));
        // Elastic displacements are of the order of p_s / E*.
        let level = heights[0] - heights[(fraction * cells) as usize];
        if let Some(d) = state.approach {
            assert!((d - level).abs() < 1e-2, "{d} {level}");
        }
        let volume: f64 = heights.iter().map(|h| (h - heights[0] + level).max(0.0)).sum::<f64>() / cells;
        let plastic = state.plastic.unwrap();
        assert!((plastic.volume / volume - 1.0).abs() < 1e-2, "{} {volume}", plastic.volume);
        assert!((plastic.dissipated / (hardness * plastic.volume) - 1.0).abs() < 1e-12);
    }
}

/// Hertz until the pressure in the middle reaches the hardness; far beyond, the area is F / p_s.
#[test]
fn a_sphere_first_yields_at_the_load_of_hertz() {
    let scene = |hardness: Option<f64>| {
        let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
        scene.outputs.area = true;
        if let Some(pressure) = hardness {
            scene.effects.hardness = Hardness::Limit { pressure };
        }
        scene
    };
    let model = Bem3d { cells: 129, ..TIGHT };
    // a = 0.1: p_0 = 2 E* a / (pi R), F = 4 E* a^3 / (3 R).
    let a = 0.1_f64;
    let (p0, force) = (2.0 * a / std::f64::consts::PI, 4.0 * a.powi(3) / 3.0);
    let at = |hardness: f64| solved(model, &scene(Some(hardness)), Load::force(force));
    // The largest pressure of a cell is that of Hertz to the square of the cell.
    assert!(at(1.001 * p0).plastic.unwrap().area <= 0.0);
    assert!(at(0.99 * p0).plastic.unwrap().area > 0.0);
    let small = at(0.05 * p0);
    let (area, plastic) = (small.area.unwrap(), small.plastic.unwrap());
    assert!(area < 1.02 * force / (0.05 * p0) && area >= force / (0.05 * p0), "{area} {plastic:?}");
    assert!(plastic.area > 0.97 * area);
    // Softer means larger in every respect.
    let mut last = at(2.0 * p0);
    for share in [0.9, 0.6, 0.3, 0.1] {
        let next = at(share * p0);
        assert!(next.area >= last.area && next.approach > last.approach, "{share}");
        assert!(next.plastic.unwrap().volume > last.plastic.unwrap().volume);
        last = next;
    }
}

/// Checks the conditions that every state must satisfy, by its fields.
fn check(state: &ContactState, hardness: f64) {
    let fields = state.fields.as_ref().unwrap();
    let (p, depth) = (fields.pressure.as_ref().unwrap(), fields.plastic_depth.as_ref().unwrap());
    for (p, depth) in p.values().iter().zip(depth.values()) {
        assert!((0.0..=hardness * (1.0 + 1e-12)).contains(p) && *depth >= 0.0);
    }
    assert!((p.integral() / state.force - 1.0).abs() < 1e-9);
    let plastic = state.plastic.unwrap();
    assert!((depth.integral() - plastic.volume).abs() <= 1e-9 * plastic.volume.max(1e-12));
}

/// Loads that rise in steps and at once lead to the same state; unloading is elastic, reloading returns to
/// the same state, and the work of a loop is the energy that the indentation dissipated.
#[test]
fn a_path_remembers_its_indentation() {
    for (boundary, hardness, loads) in
        [(Boundary::Free, 4.0, [0.3, 0.8, 1.5]), (Boundary::Periodic, 6.0, [0.5, 1.0, 2.5])]
    {
        let scene = rough(Some(hardness), boundary);
        let mut path = TIGHT.prepare(&scene, 5).unwrap();
        let mut time = 0.0;
        let mut go = |path: &mut dyn PreparedContact, force: f64| {
            time += 1.0;
            path.advance(Step::new(time, Load::force(force))).unwrap()
        };
        let mut steps = Vec::new();
        for load in loads {
            steps.push(go(path.as_mut(), load));
        }
        let at_once = solved(TIGHT, &scene, Load::force(loads[2]));
        let loaded = steps.last().unwrap();
        check(loaded, hardness);
        let close = |a: f64, b: f64, what: &str| assert!((a / b - 1.0).abs() < 1e-6, "{what} {a} {b}");
        let (stepped, direct) = (loaded.plastic.unwrap(), at_once.plastic.unwrap());
        close(stepped.volume, direct.volume, "volume");
        close(stepped.area, direct.area, "plastic area");
        close(loaded.area.unwrap(), at_once.area.unwrap(), "area");
        // Down and up again: no plastic flow, and the same state.
        for share in [0.7, 0.3, 0.05] {
            let state = go(path.as_mut(), share * loads[2]);
            check(&state, hardness);
            let plastic = state.plastic.unwrap();
            close(plastic.volume, stepped.volume, "volume on the way down");
            assert!(state.area > solved(TIGHT, &scene, Load::force(share * loads[2])).area);
        }
        let again = go(path.as_mut(), loads[2]);
        close(again.area.unwrap(), loaded.area.unwrap(), "area again");
        close(again.plastic.unwrap().volume, stepped.volume, "volume again");
        if let (Some(a), Some(b)) = (again.approach, loaded.approach) {
            close(a, b, "approach again");
        }
        let more = go(path.as_mut(), 1.2 * loads[2]);
        assert!(more.plastic.unwrap().volume > stepped.volume && more.stiffness.is_some());
        path.restart();
        let anew = path.advance(Step::new(0.0, Load::force(loads[0]))).unwrap();
        close(anew.plastic.unwrap().volume, steps[0].plastic.unwrap().volume, "after a restart");
    }
}

/// Withdrawal from an indented surface: the state has no force and the requested gap, and the indentation
/// remains.
#[test]
fn a_body_is_withdrawn_from_its_indentation() {
    let mut scene = rough(Some(4.0), Boundary::Periodic);
    scene.outputs.mean_gap = true;
    let mut path = Bem3d { cells: 32, ..TIGHT }.prepare(&scene, 5).unwrap();
    let mut go = |load: Load| path.advance(Step::new(0.0, load)).unwrap();
    let virgin = go(Load::force(0.0)).mean_gap.unwrap();
    let pressed = go(Load::force(2.0)).plastic.unwrap();
    let touching = go(Load::force(0.0)).mean_gap.unwrap();
    assert!(touching < virgin, "{touching} {virgin}");
    // The second lies beyond the first touch of the indented surface but not of the virgin one.
    for gap in [touching, 0.5 * (touching + virgin), 3.0 * virgin] {
        let state = go(Load::mean_gap(gap));
        assert!(state.force <= 0.0 && state.area == Some(0.0), "{gap}: {state:?}");
        // A gap goes into the units of the surface and back.
        assert!((state.mean_gap.unwrap() / gap - 1.0).abs() < 1e-13, "{gap}: {:?}", state.mean_gap);
        assert!((state.plastic.unwrap().volume / pressed.volume - 1.0).abs() < 1e-12);
        let least = state.gap().unwrap().values().iter().copied().fold(f64::INFINITY, f64::min);
        assert!((least - (gap - touching)).abs() < 1e-12 * virgin, "{gap}: {least}");
    }
    assert!(go(Load::mean_gap(0.99 * touching)).force > 0.0);
}

/// Mean gaps at which nearly every cell in contact flows: the force of a state hardly changes with its gap, and
/// its stiffness is asked for. Each gap is met, the force falls with it, and an approach by small steps of the
/// gap gives the same forces.
#[test]
fn mean_gaps_of_soft_bodies_are_found() {
    let mut surface = SelfAffine::new(2.2, 1.0, 0.01).unwrap();
    surface.short_cutoff = None;
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    scene.effects.boundary = Boundary::Periodic;
    scene.effects.hardness = Hardness::Limit { pressure: 2e-3 };
    (scene.outputs.mean_gap, scene.outputs.area) = (true, true);
    let model = Bem3d { cells: 32, ..Bem3d::default() };
    for stiffness in [false, true] {
        scene.outputs.stiffness = stiffness;
        let mut contact = model.prepare(&scene, 1).unwrap();
        let mut force = 0.0;
        for i in 0..12 {
            let gap = 0.024 - 0.002 * f64::from(i);
            let state = contact.solve(Load::mean_gap(gap)).unwrap();
            assert!((state.mean_gap.unwrap() - gap).abs() <= 1e-6 * 0.01, "{gap}: {:?}", state.mean_gap);
            assert!(state.force > force, "{gap}: {} after {force}", state.force);
            force = state.force;
            let alone = model.prepare(&scene, 1).unwrap().solve(Load::mean_gap(gap)).unwrap();
            assert!((alone.force / force - 1.0).abs() < 1e-3, "{gap}: {} {force}", alone.force);
        }
    }
}

/// Steps of a loop in each direction.
const STEPS: usize = 200;

/// The work done on a loop is the energy dissipated in it.
#[test]
fn a_loop_balances_its_energy() {
    let mut scene = rough(Some(2.0), Boundary::Free);
    scene.outputs = Outputs::default();
    let mut path = Bem3d { cells: 32, ..TIGHT }.prepare(&scene, 5).unwrap();
    let deepest = 1.0;
    let (mut work, mut last, mut unloaded) = (0.0, (0.0, 0.0), 0.0);
    for i in 1..=2 * STEPS {
        let d = deepest * (if i <= STEPS { i } else { 2 * STEPS - i }) as f64 / STEPS as f64;
        let state = path.advance(Step::new(i as f64, Load::approach(d))).unwrap();
        work += 0.5 * (state.force + last.0) * (d - last.1);
        last = (state.force, d);
        unloaded = state.plastic.unwrap().dissipated;
    }
    // The sum of trapezoids is good to the square of the step.
    assert!(last.0 <= 0.0 && (work / unloaded - 1.0).abs() < 1e-3, "{work} {unloaded}");
}

#[test]
fn unsupported_combinations_are_refused() {
    let scene = rough(Some(2.0), Boundary::Free);
    // All cells at the hardness carry 2.
    let refused = ContactModel::prepare(&TIGHT, &scene, 5).unwrap().solve(Load::force(2.0));
    assert!(
        matches!(refused, Err(Error::OutOfRange { max, .. }) if (max - 2.0).abs() < 1e-12),
        "{refused:?}"
    );
    for pressure in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut scene = scene.clone();
        scene.effects.hardness = Hardness::Limit { pressure };
        let refused = ContactModel::prepare(&TIGHT, &scene, 5);
        assert!(matches!(refused, Err(Error::Domain { .. })), "{pressure}");
    }
    let mut both = scene.clone();
    both.effects.adhesion = Adhesion::ShortRange { work: 1.0 };
    assert!(matches!(ContactModel::prepare(&TIGHT, &both, 5), Err(Error::Unsupported { .. })));
    let mut path = TIGHT.prepare(&scene, 5).unwrap();
    path.advance(Step::new(1.0, Load::force(0.5))).unwrap();
    for step in [
        Step::new(2.0, Load::force(0.5).with_tangential(Tangential::force_along_x(0.1))),
        Step::new(0.5, Load::force(0.5)),
        Step::new(2.0, Load::force(-0.5)),
        Step::new(2.0, Load::force(3.0)),
        Step::new(2.0, Load::mean_gap(0.5)),
    ] {
        assert!(path.advance(step).is_err(), "{step:?}");
    }
    assert!(path.advance(Step::new(1.0, Load::force(0.6))).is_ok());
}

/// ContactMechanics #68: hardness 0.1 E*, rms slope 0.08, mean pressures up to 0.0999 E*.
#[test]
fn nearly_full_plasticity_converges() {
    let cells = 64;
    let scene = rough(None, Boundary::Periodic);
    let map = surface_gen::height_map(&scene.surface, Cells::from([cells; 2]), 5).unwrap();
    let (h, n) = (map.heights(), cells);
    let slope = |i: usize| {
        let (x, y) = (i % n, i / n);
        let along = |j: usize| (h[j] - h[i]) * n as f64;
        along(y * n + (x + 1) % n).powi(2) + along((y + 1) % n * n + x).powi(2)
    };
    let rms = ((0..n * n).map(slope).sum::<f64>() / (n * n) as f64).sqrt();
    let heights = h.iter().map(|h| 0.08 / rms * h).collect();
    let mut scene =
        Scene { surface: Surface::Heights(Arc::new(HeightMap::new(cells, 1.0, heights).unwrap())), ..scene };
    scene.effects.hardness = Hardness::Limit { pressure: 0.1 };
    let mut contact = ContactModel::prepare(&TIGHT, &scene, 0).unwrap();
    let mut last = 0.0;
    for pressure in [1e-4, 1e-3, 1e-2, 0.03, 0.06, 0.09, 0.099, 0.0999] {
        let state = contact.solve(Load::force(pressure)).unwrap();
        let area = state.area.unwrap();
        assert!(area >= last && area >= pressure / 0.1 && area <= 1.0 + 1e-12, "{pressure} {area}");
        last = area;
    }
    assert!(last > 0.998);
}

/// A state on which the outer iteration once stagnated for ever, because every step was cut at the bounds so
/// that no part of it lowered the energy. With every method its pressure satisfies the conditions of the
/// bounded problem, checked by the fields.
#[test]
fn a_state_that_jams_the_outer_iteration_is_solved() {
    let heights: Vec<f64> = include_str!("data/jammed.csv")
        .split([',', '\n'])
        .filter(|text| !text.is_empty())
        .map(|text| text.parse().unwrap())
        .collect();
    let map = HeightMap::new([27, 31], [1.35, 0.775], heights).unwrap();
    let area = map.dx() * map.dy();
    let mut scene = Scene::new(Surface::Heights(Arc::new(map)), 1.0);
    scene.effects.boundary = Boundary::Periodic;
    let (pressure, force) = (36.504_276_057_006_074, 26.405_214_017_754_37);
    scene.effects.hardness = Hardness::Limit { pressure };
    (scene.outputs.pressure, scene.outputs.gap, scene.outputs.plastic_depth) = (true, true, true);
    for method in [Method::Auto, Method::Iterative, Method::SingleLevel] {
        let state = solved(Bem3d { method, ..TIGHT }, &scene, Load::force(force));
        let depth = state.fields.as_ref().unwrap().plastic_depth.as_ref().unwrap().values();
        let (p, g) = (state.pressure().unwrap().values(), state.gap().unwrap().values());
        assert!((p.iter().sum::<f64>() * area / force - 1.0).abs() < 1e-9);
        for ((&p, &g), &depth) in p.iter().zip(g).zip(depth) {
            // Gaps are certified to 1e-9 of the rms height.
            let free = p > 0.0 && p < pressure;
            assert!((0.0..=pressure * (1.0 + 1e-12)).contains(&p) && g > -1e-8, "{p} {g}");
            assert!(!free || g.abs() < 1e-8 && depth == 0.0, "{p} {g} {depth}");
            assert!(p < pressure || g.abs() < 1e-8, "{p} {g} {depth}");
        }
        assert!(depth.iter().any(|&depth| depth > 0.0));
    }
}

/// A path that begins after a single load continues from it, as a path that reached this load in a step does.
#[test]
fn a_path_goes_on_from_a_load_that_was_solved() {
    let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
    scene.effects.hardness = Hardness::Limit { pressure: 0.1 };
    let model = Bem3d { cells: 32, ..TIGHT };
    let (mut single, mut path) = (model.prepare(&scene, 0).unwrap(), model.prepare(&scene, 0).unwrap());
    let solved = single.solve(Load::force(0.02)).unwrap();
    path.advance(Step::new(0.0, Load::force(0.02))).unwrap();
    let unload = Step::new(1.0, Load::force(0.005));
    let (after, expected) = (single.advance(unload).unwrap(), path.advance(unload).unwrap());
    assert_eq!(after, expected);
    assert!(solved.time.is_none() && after.plastic.unwrap().volume > 0.0);
    // Without the load before there is less.
    single.restart();
    let alone = single.advance(unload).unwrap();
    assert!(alone.plastic.unwrap().volume < after.plastic.unwrap().volume);
}
