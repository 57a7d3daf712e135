//! Contact of a layer on a base through the common traits: closed forms, limits, stiffness and refusals.

#![allow(clippy::unwrap_used)] // Tests.

use bem3d::{
    Bem3d, Boundary, Conductance, ContactModel, ContactState, Error, Friction, Layer, LayerBase, Load,
    Outputs, Scene, SelfAffine, Surface,
};
use std::f64::consts::PI;

const ON: [LayerBase; 4] = [
    LayerBase::Rigid,
    LayerBase::Slipping,
    LayerBase::HalfSpace { young: 0.1, poisson: 0.4 },
    LayerBase::HalfSpace { young: 20.0, poisson: 0.2 },
];

fn scene(surface: Surface, layer: Layer) -> Scene {
    let mut scene = Scene::new(surface, layer.modulus());
    scene.effects.layer = Some(layer);
    scene.outputs = Outputs { area: true, stiffness: true, gap: true, ..Outputs::default() };
    scene
}

fn solve(scene: &Scene, cells: usize, load: Load) -> ContactState {
    let model = Bem3d { cells, tolerance: 1e-8, ..Bem3d::default() };
    ContactModel::prepare(&model, scene, 3).unwrap().solve(load).unwrap()
}

fn rough() -> Surface {
    let mut rough = SelfAffine::new(2.2, 1.0, 0.01).unwrap();
    rough.roll_off = Some(12.0);
    rough.short_cutoff = Some(60.0);
    Surface::SelfAffine(rough)
}

/// Force over that of a thin layer, for a ball whose contact radius would be `radius` by it.
fn over_thin(thickness: f64, poisson: f64, radius: f64, cells: usize) -> [f64; 2] {
    let layer = Layer { thickness, young: 1.0, poisson, base: LayerBase::Rigid };
    let incompressible = poisson > 0.499;
    // Of an incompressible layer the volume beside the contact is that of the indentation.
    let approach = radius.powi(2) / if incompressible { 4.0 } else { 2.0 };
    let scene = scene(Surface::Sphere { radius: 1.0, size: 1.0.into() }, layer);
    let state = solve(&scene, cells, Load::approach(approach));
    let force = if incompressible {
        PI * layer.modulus() * radius.powi(6) / (128.0 * thickness.powi(3))
    } else {
        let oedometric = (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        PI * oedometric * approach.powi(2) / thickness
    };
    [state.force / force, (state.area.unwrap() / PI).sqrt() / radius]
}

/// Closed forms of a ball on a layer that is thin beside the contact. What they leave out is of the order of the
/// thickness over the radius, so that it is halved with it.
#[test]
fn a_ball_on_a_thin_layer() {
    for poisson in [0.2, 0.5] {
        let errors = |thickness| over_thin(thickness, poisson, 0.4, 257).map(|ratio| (ratio - 1.0).abs());
        let (thick, thin) = (errors(0.04), errors(0.02));
        for (thick, thin) in thick.into_iter().zip(thin) {
            assert!(thin < 0.07 && thin < 0.75 * thick, "nu = {poisson}: {thick} {thin}");
        }
    }
}

/// A layer of the material of its base is a half-space, a thick one too, and a thin one is its base.
#[test]
fn a_layer_that_is_none() {
    let material = LayerBase::HalfSpace { young: 1.0, poisson: 0.3 };
    let soft = LayerBase::HalfSpace { young: 0.2, poisson: 0.3 };
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let force = |layer: Option<(f64, LayerBase)>, young: f64| {
            let layer = layer.map(|(thickness, base)| Layer { thickness, young: 1.0, poisson: 0.3, base });
            let mut scene = Scene::new(rough(), young / 0.91);
            scene.effects.layer = layer;
            scene.effects.boundary = boundary;
            let load = if boundary == Boundary::Free { Load::approach(0.02) } else { Load::mean_gap(0.01) };
            solve(&scene, 64, load).force
        };
        let half_space = force(None, 1.0);
        for layer in [(0.03, material), (1e4, soft)] {
            approx::assert_relative_eq!(force(Some(layer), 1.0), half_space, max_relative = 1e-4);
        }
        approx::assert_relative_eq!(force(Some((1e-6, soft)), 1.0), force(None, 0.2), max_relative = 1e-2);
    }
}

/// `k = dF/dd`, and of periodic boundaries `-dF/dg`, on every base.
#[test]
fn the_stiffness_is_the_slope_of_the_force() {
    for base in ON {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let layer = Layer { thickness: 0.1, young: 1.0, poisson: 0.3, base };
            let mut scene = scene(rough(), layer);
            scene.effects.boundary = boundary;
            let load = |at: f64| {
                if boundary == Boundary::Free { Load::approach(at) } else { Load::mean_gap(0.03 - at) }
            };
            let (at, step) = (0.02, 1e-5);
            let k = solve(&scene, 48, load(at)).stiffness.unwrap();
            let slope = (solve(&scene, 48, load(at + step)).force - solve(&scene, 48, load(at - step)).force)
                / (2.0 * step);
            approx::assert_relative_eq!(k, slope, max_relative = 1e-2);
        }
    }
}

/// The approach of a rigid body to the base of a periodic layer, and its stiffness, against difference quotients and
/// against the compression of a slab that cannot spread.
#[test]
fn a_whole_layer_yields_below_the_rough_surface() {
    for (base, poisson) in [(LayerBase::Rigid, 0.3), (LayerBase::Slipping, 0.1), (LayerBase::Rigid, 0.5)] {
        let layer = Layer { thickness: 0.2, young: 1.0, poisson, base };
        let mut scene = scene(rough(), layer);
        scene.effects.boundary = Boundary::Periodic;
        scene.outputs.mean_gap = true;
        let model = Bem3d { cells: 32, tolerance: 1e-10, ..Bem3d::default() };
        let mut contact = ContactModel::prepare(&model, &scene, 3).unwrap();
        let mut at = |force: f64| contact.solve(Load::force(force)).unwrap();
        let force = 0.01;
        let (state, touching) = (at(force), at(1e-12 * force));
        let whole = state.whole_layer.unwrap();
        let [below, above] = [1.0 - 1e-5, 1.0 + 1e-5].map(|factor| {
            let state = at(factor * force);
            (state.force, state.whole_layer.unwrap().approach)
        });
        let slope = (above.0 - below.0) / (above.1 - below.1);
        assert!((whole.stiffness.unwrap() / slope - 1.0).abs() < 1e-4, "{whole:?} {slope}");
        let modulus = (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let slab = force * layer.thickness / modulus;
        let fall = touching.mean_gap.unwrap() - state.mean_gap.unwrap();
        assert!((whole.approach - fall - slab).abs() < 1e-6 * fall, "{whole:?} {fall} {slab}");
        assert!(whole.stiffness.unwrap() <= state.stiffness.unwrap());
        // Complete contact is a slab between rigid plates.
        let full = at(1e3);
        assert!((full.area.unwrap() - 1.0).abs() < 1e-12);
        let stiffness = full.whole_layer.unwrap().stiffness;
        let of_slab = (poisson < 0.5).then_some(modulus / layer.thickness);
        assert_eq!(stiffness.is_some(), of_slab.is_some());
        assert!(stiffness.zip(of_slab).is_none_or(|(k, of_slab)| (k / of_slab - 1.0).abs() < 1e-12));
    }
}

/// A half-space below the layer, or above it, falls without limit under the mean pressure.
#[test]
fn there_is_no_approach_to_a_half_space() {
    let rigid = Layer { thickness: 0.2, young: 1.0, poisson: 0.3, base: LayerBase::Rigid };
    let elastic = Layer { base: LayerBase::HalfSpace { young: 2.0, poisson: 0.3 }, ..rigid };
    for (layer, share) in [(rigid, 1.0), (rigid, 0.5), (elastic, 1.0)] {
        let mut scene = scene(rough(), layer);
        scene.effects.boundary = Boundary::Periodic;
        scene.contact_modulus *= share;
        let whole = solve(&scene, 16, Load::force(1e-3)).whole_layer;
        assert_eq!(whole.is_some(), layer == rigid && share > 0.9);
        scene.effects.boundary = Boundary::Free;
        assert_eq!(solve(&scene, 16, Load::force(1e-3)).whole_layer, None);
    }
}

/// Cells of other sides, as the same problem turned by a right angle.
#[test]
fn oblong_cells_and_their_turned_copy() {
    for base in ON {
        let layer = Layer { thickness: 0.06, young: 1.0, poisson: 0.4, base };
        let force = |columns: usize, rows: usize, turned: bool| {
            let map = bem3d::HeightMap::from_fn([columns, rows], [1.0, 1.0], |ix, iy| {
                let (x, y) = ((ix as f64 + 0.5) / columns as f64, (iy as f64 + 0.5) / rows as f64);
                let (x, y) = if turned { (y, x) } else { (x, y) };
                0.01 * ((9.0 * x).sin() + (14.0 * y).cos())
            });
            let scene = scene(Surface::Heights(std::sync::Arc::new(map.unwrap())), layer);
            solve(&scene, 64, Load::approach(0.01)).force
        };
        let (one, two) = (force(40, 24, false), force(24, 40, true));
        approx::assert_relative_eq!(one, two, max_relative = 1e-6);
    }
}

/// A body that presses on the layer adds its compliance as a half-space.
#[test]
fn the_body_that_presses_adds_its_compliance() {
    let layer = Layer { thickness: 1e5, young: 1.0, poisson: 0.3, base: LayerBase::Rigid };
    let mut pressed = scene(rough(), layer);
    pressed.contact_modulus = 0.4 * layer.modulus();
    let thick = solve(&pressed, 48, Load::approach(0.02)).force;
    let half_space = solve(&Scene::new(rough(), pressed.contact_modulus), 48, Load::approach(0.02)).force;
    approx::assert_relative_eq!(thick, half_space, max_relative = 1e-3);
    // More than the layer alone cannot be.
    pressed.contact_modulus = 1.1 * layer.modulus();
    assert!(matches!(ContactModel::prepare(&Bem3d::default(), &pressed, 0), Err(Error::Domain { .. })));
}

#[test]
fn what_a_layer_cannot_do_is_refused_by_name() {
    let layer = Layer { thickness: 0.1, young: 1.0, poisson: 0.3, base: LayerBase::Rigid };
    let refused = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene(rough(), layer);
        change(&mut scene);
        match ContactModel::prepare(&Bem3d { cells: 16, ..Bem3d::default() }, &scene, 0) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("not refused"),
        }
    };
    let refused = |words: &str, change: &dyn Fn(&mut Scene)| {
        let error = refused(change);
        assert!(error.contains(words), "{error}");
    };
    refused("layer", &|scene| scene.effects.friction = Friction::tresca(0.1));
    refused("conductance of a layered body", &|scene| {
        scene.outputs.conductance = Conductance::Electrical { first: 1.0, second: 1.0 };
    });
    for (words, change) in [
        ("thickness", Layer { thickness: 0.0, ..layer }),
        ("rounding", Layer { thickness: 1e-4, poisson: 0.5, young: 0.75 / 0.91, ..layer }),
        ("Poisson", Layer { poisson: 0.6, ..layer }),
        ("Young", Layer { young: f64::NAN, ..layer }),
        ("shear modulus", Layer { base: LayerBase::HalfSpace { young: 1e-9, poisson: 0.3 }, ..layer }),
    ] {
        refused(words, &|scene| scene.effects.layer = Some(change));
    }
}

/// Coatings up to ten thousand times as stiff as their base are solved at any thickness, and a single force comes to
/// the state that the approach of it comes to.
#[test]
fn hard_coatings_are_solved() {
    let mut fell_back = 0;
    for young in [1e-2, 1e-4] {
        for thickness in [0.004, 0.04, 0.4] {
            for boundary in [Boundary::Free, Boundary::Periodic] {
                let base = LayerBase::HalfSpace { young, poisson: 0.3 };
                let mut scene = scene(rough(), Layer { thickness, young: 1.0, poisson: 0.3, base });
                scene.effects.boundary = boundary;
                let mut contact =
                    ContactModel::prepare(&Bem3d { cells: 64, ..Bem3d::default() }, &scene, 3).unwrap();
                for force in [1e-7, 1e-6, 1e-5] {
                    let state = contact.solve(Load::force(force));
                    let state =
                        state.unwrap_or_else(|e| panic!("{young} {thickness} {boundary:?} {force}: {e}"));
                    assert!(state.report.certificate.duality_gap <= 1e-6);
                    fell_back += usize::from(state.report.strategy.contains("fall-back"));
                    if let Some(approach) = state.approach {
                        let again = contact.solve(Load::approach(approach)).unwrap();
                        approx::assert_relative_eq!(again.force, force, max_relative = 1e-4);
                    }
                }
            }
        }
    }
    assert!(fell_back > 0, "the test is too easy");
}

/// The response of a bonded layer of the thickness 1 on a rigid base to waves, beside a half-space, in its usual form.
fn bonded(wave: f64, poisson: f64) -> f64 {
    let (x, b) = (2.0 * wave, 3.0 - 4.0 * poisson);
    2.0 * (b * x.sinh() - x) / (2.0 * b * x.cosh() + 1.0 + b * b + x * x)
}

/// The same of a layer that slips on its base.
fn slipping(wave: f64) -> f64 {
    let x = 2.0 * wave;
    (x.cosh() - 1.0) / (x.sinh() + x)
}

/// Solves a small system by elimination; each row ends with its right-hand side.
fn eliminate(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for i in 0..n {
        let pivot = rows[i].clone();
        for (k, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let factor = row[i] / pivot[i];
            assert!(factor.is_finite(), "{k}");
            row.iter_mut().zip(&pivot).for_each(|(value, pivot)| *value -= factor * pivot);
        }
    }
    rows.iter().enumerate().map(|(i, row)| row[n] / row[i]).collect()
}

/// The approach and the force of a paraboloid of curvature radius 1 that touches a layer of the thickness and the
/// contact modulus 1 on a circle.
///
/// With the pressure's Hankel transform `int_0^a g(t) cos(q t) dt` the contact is the integral equation
/// `pi g(s) + 2 int_0^a g(t) int_0^inf (f - 1) cos(q s) cos(q t) dq dt = d - s^2` with `g(a) = 0`, and the force is
/// `2 pi int g` (Lebedev, Ufliand, J. Appl. Math. Mech. 22, 442 (1958); Hayes et al., J. Biomech. 5, 541 (1972)). It is
/// solved on the midpoints of equal strips.
fn paraboloid(radius: f64, response: &dyn Fn(f64) -> f64) -> [f64; 2] {
    const STRIPS: usize = 100;
    let width = radius / STRIPS as f64;
    let s: Vec<f64> = (0..STRIPS).map(|i| (i as f64 + 0.5) * width).chain([radius]).collect();
    // The integrand falls as w^2 exp(-2 w).
    let waves: Vec<f64> = (0..800).map(|k| (f64::from(k) + 0.5) * 0.025).collect();
    let excess: Vec<f64> = waves.iter().map(|&q| 0.025 * (response(q) - 1.0)).collect();
    let cosines: Vec<Vec<f64>> = s.iter().map(|s| waves.iter().map(|q| (q * s).cos()).collect()).collect();
    let kernel = |i: usize, k: usize| -> f64 {
        excess.iter().zip(&cosines[i]).zip(&cosines[k]).map(|((excess, a), b)| excess * a * b).sum()
    };
    // The last unknown is the approach, and the last equation that of the edge, where g vanishes.
    let row = |(i, &s_i): (usize, &f64)| {
        let mut row: Vec<f64> = (0..STRIPS).map(|k| 2.0 * width * kernel(i, k)).collect();
        if i < STRIPS {
            row[i] += PI;
        }
        row.extend([-1.0, -s_i * s_i]);
        row
    };
    let solution = eliminate(s.iter().enumerate().map(row).collect());
    [solution[STRIPS], 2.0 * PI * width * solution[..STRIPS].iter().sum::<f64>()]
}

/// A ball on layers beside the integral equation of the axisymmetric contact. The error of the grid is of second
/// order in the cell over the radius of the contact: with 40 cells in it, it is 4e-5 to 1.2e-4 of the force. The area
/// counts cells.
#[test]
fn a_ball_on_a_layer_of_any_thickness() {
    let half_space = paraboloid(1.0, &|_| 1.0);
    approx::assert_relative_eq!(half_space[0], 1.0, max_relative = 1e-3);
    approx::assert_relative_eq!(half_space[1], 4.0 / 3.0, max_relative = 1e-3);
    for (base, poisson) in [
        (LayerBase::Rigid, 0.5),
        (LayerBase::Rigid, 0.3),
        (LayerBase::Rigid, 0.0),
        (LayerBase::Slipping, 0.3),
    ] {
        for radius in [0.2, 0.7, 2.0] {
            let response = |w: f64| if base == LayerBase::Rigid { bonded(w, poisson) } else { slipping(w) };
            let [approach, force] = paraboloid(radius, &response);
            let layer = Layer { thickness: 1.0, young: 1.0 - poisson * poisson, poisson, base };
            let surface = Surface::Sphere { radius: 1.0, size: (3.0 * radius).into() };
            let state = solve(&scene(surface, layer), 121, Load::approach(approach));
            let found = (state.area.unwrap() / PI).sqrt();
            assert!(
                (state.force / force - 1.0).abs() < 3e-4 && (found / radius - 1.0).abs() < 5e-3,
                "{base:?} {poisson} {radius}: {} {}",
                state.force / force,
                found / radius
            );
        }
    }
}
