//! Friction and rheology of contacts of any shape, by the equivalent profile from a model's states.

use analytic::{CattaneoMindlin, Hertz, PowerLaw};
use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{
    Body, ContactModel, ContactState, Effects, Friction, Load, Outputs, Pair, PreparedContact, Relaxing,
    Result, Rheology, Scene, Step, Surface, Tangential,
};
use mdr1d::{Equivalent, Viscoelastic};
use tests::{order, rough};

const MU: f64 = 0.3;
const SOLID: Rheology = Rheology::StandardSolid { arm: Relaxing { weight: 3.0, time: 2.0 } };

fn pair() -> Pair {
    Pair { first: Body::Rigid, second: Body::Elastic { young: 3.0, poisson: 0.5 } }
}

fn sliding(surface: Surface) -> Scene {
    let mut scene = Scene::of_pair(surface, pair()).unwrap();
    scene.effects.friction = Friction::coulomb(MU);
    scene
}

fn creeping(surface: Surface) -> Scene {
    let mut scene = Scene::of_pair(surface, pair()).unwrap();
    scene.effects.rheology = SOLID;
    scene.outputs = Outputs::default();
    scene
}

fn elastic(scene: &Scene) -> Scene {
    let outputs = Outputs { stiffness: true, ..Outputs::default() };
    Scene { effects: Effects::default(), outputs, ..scene.clone() }
}

fn sphere() -> Surface {
    Surface::Sphere { radius: 1.0, size: 1.0.into() }
}

fn fractal() -> Surface {
    Surface::SelfAffine(rough(2.3).unwrap())
}

/// Pressed to d = 0.04 (a = 0.2) and sheared by shares of mu F; both models.
fn sheared(model: &dyn ContactModel) -> Vec<ContactState> {
    let force = 4.0 / 3.0 * 4.0 * 0.008;
    let mut history = model.prepare(&sliding(sphere()), 0).unwrap();
    let path = [0.0, 0.25, 0.5, 0.9, -0.4, 0.6].map(|share| {
        Step::new(0.0, Load::force(force).with_tangential(Tangential::force_along_x(share * MU * force)))
    });
    history.follow(&path).unwrap()
}

/// Root mean square relative error of the displacement and of the dissipated energy against Cattaneo, Mindlin
/// and Deresiewicz.
fn errors(model: &dyn ContactModel) -> [f64; 2] {
    let exact = sheared(&CattaneoMindlin);
    let found = sheared(model);
    let mut squares = [0.0; 2];
    for (one, other) in exact.iter().zip(&found).skip(1) {
        let (one, other) = (one.tangential.unwrap(), other.tangential.unwrap());
        squares[0] += (other.displacement[0] / one.displacement[0] - 1.0).powi(2);
        squares[1] += (other.dissipated / one.dissipated - 1.0).powi(2);
    }
    squares.map(|square| (square / 5.0).sqrt())
}

#[test]
fn a_table_of_hertz_becomes_cattaneo_and_mindlin() {
    let counts = [4, 8, 16, 32];
    let all = counts.map(|per_decade| errors(&Equivalent { per_decade, ..Equivalent::new(Hertz) }));
    for which in [0, 1] {
        let pairs: Vec<(usize, f64)> =
            counts.iter().zip(&all).map(|(&n, error)| (n as usize, error[which])).collect();
        // Fourth order of F, third of x; the slip radius falls between the nodes at random.
        let found = order(&pairs).unwrap();
        assert!(found > 3.0, "{found}: {pairs:?}");
        assert!(pairs[3].1 < 2e-6, "{pairs:?}");
    }
}

#[test]
fn a_sphere_on_cells_becomes_cattaneo_and_mindlin() {
    let grids = [33, 65, 129];
    let all = grids.map(|cells| errors(&Equivalent::new(Bem3d { cells, ..Bem3d::default() })));
    for which in [0, 1] {
        let pairs: Vec<(usize, f64)> = grids.iter().zip(&all).map(|(&n, error)| (n, error[which])).collect();
        // The staircase of the edge: slip begins in the outermost springs, which come from k, of first order
        // or better.
        let found = order(&pairs).unwrap();
        assert!(found > 1.0, "{found}: {pairs:?}");
        assert!(pairs[2].1 < 1e-2, "{pairs:?}");
    }
}

/// Ciavarella and Jaeger: the tangential force of a stroke u is `mu (F(d) - F(d'))` with
/// `d - d' = u G*/(mu E*)`, the tangential stiffness G*/E* times that at d'. This holds for any shape: both
/// sides are computed by one model, once through the profile and once directly.
///
/// Returns the largest error of the force over mu F, and of the stiffness over k.
fn beside_a_difference_of_normal_contacts(model: &dyn ContactModel, depth: f64, per_decade: u32) -> [f64; 2] {
    let scene = &sliding(fractal());
    let mut direct = model.prepare(&elastic(scene), 2).unwrap();
    let height = direct.normalisation().height.unwrap();
    let shear = pair().shear_modulus().unwrap() / pair().contact_modulus().unwrap();
    let d = depth * height;
    let mut history = Equivalent { per_decade, ..Equivalent::new(model) }.prepare(scene, 2).unwrap();
    let top = direct.solve(Load::approach(d)).unwrap();
    let mut worst = [0.0_f64; 2];
    for share in [0.05, 0.3, 0.6, 0.9] {
        history.restart();
        history.advance(Step::new(0.0, Load::approach(d))).unwrap();
        let u = share * d * MU / shear;
        let step = Step::new(0.0, Load::approach(d).with_tangential(Tangential::displacement_along_x(u)));
        let state = history.advance(step).unwrap();
        // The normal part is the model's own, to its tolerance: a warm start may differ.
        assert_relative_eq!(state.force, top.force, max_relative = 1e-6);
        let tangential = state.tangential.unwrap();
        let below = direct.solve(Load::approach((1.0 - share) * d)).unwrap();
        let force = (tangential.force[0] - MU * (top.force - below.force)) / (MU * top.force);
        let held = 2.0 * scene.contact_modulus * tangential.stick_radius.unwrap();
        let stiffness = (held - below.stiffness.unwrap()) / top.stiffness.unwrap();
        worst = [worst[0].max(force.abs()), worst[1].max(stiffness.abs())];
    }
    worst
}

#[test]
fn rough_surfaces_slip_as_a_difference_of_normal_contacts() {
    // On 65 cells k grows by one cell after the other: no order, but the error follows the spacing.
    let cells = Bem3d { cells: 65, tolerance: 1e-7, ..Bem3d::default() };
    let [coarse, fine] = [16, 64].map(|n| beside_a_difference_of_normal_contacts(&cells, 1.5, n));
    assert!(coarse[0] < 2e-3 && coarse[1] < 4e-2, "{coarse:?}");
    // What the table says of itself bounds the error of the force over mu F.
    let height = cells.prepare(&elastic(&sliding(fractal())), 2).unwrap().normalisation().height.unwrap();
    let profile = Equivalent::new(cells).profile(&sliding(fractal()), 2, 1.5 * height).unwrap();
    assert!(
        coarse[0] < profile.uncertainty(1.5 * height),
        "{coarse:?} {:e}",
        profile.uncertainty(1.5 * height)
    );
    assert!(fine[0] < 0.2 * coarse[0] && fine[1] < coarse[1], "{coarse:?} {fine:?}");
    // The paper's own law is a power: smooth.
    let smooth = beside_a_difference_of_normal_contacts(&PowerLaw, 0.1, 16);
    assert!(smooth[0] < 1e-6 && smooth[1] < 1e-4, "{smooth:?}");
}

/// Energy and closure of a cycle of the tangential displacement.
fn cycle(
    history: &mut dyn PreparedContact,
    normal: Load,
    amplitude: f64,
    segments: i32,
) -> Result<(Vec<f64>, f64)> {
    let mut forces = Vec::new();
    let (mut work, mut last) = (0.0, (0.0, 0.0));
    let mut lost = 0.0;
    for i in 0..=5 * segments {
        // 0 -> 1 -> -1 -> 1.
        let t = f64::from(i) / f64::from(segments);
        let u = amplitude
            * if t <= 1.0 {
                t
            } else if t <= 3.0 {
                2.0 - t
            } else {
                t - 4.0
            };
        let step = Step::new(0.0, normal.with_tangential(Tangential::displacement_along_x(u)));
        let tangential = history.advance(step)?.tangential.unwrap();
        if t > 1.0 {
            work += 0.5 * (tangential.force[0] + last.1) * (u - last.0);
        } else {
            lost = tangential.dissipated;
        }
        last = (u, tangential.force[0]);
        forces.push(tangential.force[0]);
        if i == 5 * segments {
            lost = tangential.dissipated - lost;
        }
    }
    Ok((forces, work / lost))
}

#[test]
fn the_work_of_a_cycle_is_dissipated_and_the_loop_closes() {
    let model = Bem3d { cells: 33, ..Bem3d::default() };
    let mut history = Equivalent::new(model).prepare(&sliding(fractal()), 2).unwrap();
    let height = history.normalisation().height.unwrap();
    let normal = Load::approach(height);
    history.advance(Step::new(0.0, normal)).unwrap();
    let segments = 60;
    let (forces, ratio) = cycle(&mut *history, normal, 0.2 * height, segments).unwrap();
    // Trapezia over 60 segments: second order.
    assert_relative_eq!(ratio, 1.0, max_relative = 1e-3);
    let at = |i: i32| forces[usize::try_from(i * segments).unwrap()];
    assert_relative_eq!(at(1), -at(3), max_relative = 1e-9);
    assert_relative_eq!(at(1), at(5), max_relative = 1e-9);
    // Masing: from a turn on, the first curve twice as large.
    for i in 0..=segments {
        let (turned, first) = (at(1) - forces[(segments + 2 * i) as usize], forces[i as usize]);
        assert_relative_eq!(turned, 2.0 * first, max_relative = 1e-9, epsilon = 1e-12 * at(1));
    }
}

#[test]
fn a_step_of_a_rough_viscoelastic_body_relaxes_to_the_models_own_force() {
    let model = Bem3d { cells: 33, ..Bem3d::default() };
    let mut scene = creeping(fractal());
    scene.outputs.area = true;
    let mut history = Equivalent::new(model).prepare(&scene, 2).unwrap();
    let elastic = Scene { outputs: scene.outputs, ..elastic(&scene) };
    let mut direct = model.prepare(&elastic, 2).unwrap();
    let d = history.normalisation().height.unwrap();
    let own = direct.solve(Load::approach(d)).unwrap();
    for time in [0.0, 0.1, 2.0, 1e6] {
        let state = history.advance(Step::new(time, Load::approach(d))).unwrap();
        // F(t) = E*(t)/E* F.
        let contact_modulus = 1.0 + 3.0 * (-time / 2.0_f64).exp();
        assert_relative_eq!(state.force, contact_modulus * own.force, max_relative = 1e-9);
        // The area is that of the elastic contact; its pressures are not those of the viscoelastic one.
        let (found, of_model) = (state.resolution.unwrap(), own.resolution.unwrap());
        assert_eq!((found.largest_pressure, state.area), (None, own.area));
        assert_eq!(found.corrected_area, of_model.corrected_area);
    }
    // Under a force: glassy at once, relaxed in the end; both are elastic states of the model.
    history.restart();
    let force = own.force;
    for (time, share) in [(0.0, 0.25), (1e6, 1.0)] {
        let state = history.advance(Step::new(time, Load::force(force))).unwrap();
        let there = direct.solve(Load::force(share * force)).unwrap();
        let scale = history.normalisation().height.unwrap();
        assert_relative_eq!(
            state.approach.unwrap(),
            there.approach.unwrap(),
            max_relative = 1e-5,
            epsilon = 1e-5 * scale
        );
    }
}

#[test]
fn a_table_of_hertz_relaxes_as_the_body() {
    let scene = creeping(sphere());
    let path = [(0.5, 0.01), (3.0, 0.012), (3.5, 0.03), (9.0, 0.031)]
        .map(|(time, d)| Step::new(time, Load::approach(d)));
    let exact = Viscoelastic.prepare(&scene, 0).unwrap().follow(&path).unwrap();
    let error = |per_decade: u32| {
        let model = Equivalent { per_decade, ..Equivalent::new(Hertz) };
        let found = model.prepare(&scene, 0).unwrap().follow(&path).unwrap();
        let errors = found.iter().zip(&exact).map(|(a, b)| (a.force / b.force - 1.0).abs());
        errors.fold(0.0, f64::max)
    };
    let pairs = [4, 8, 16].map(|n| (n as usize, error(n)));
    assert!(order(&pairs).unwrap() > 3.0 && pairs[2].1 < 1e-6, "{pairs:?}");
}

#[test]
fn a_flat_square_slips_as_a_whole_and_sticks_as_mindlin_says() {
    let model = Bem3d { cells: 16, ..Bem3d::default() };
    let scene = sliding(Surface::Flat { size: 1.0.into() });
    let mut history = Equivalent::new(model).prepare(&scene, 0).unwrap();
    let state = history.advance(Step::new(0.0, Load::force(1e-3))).unwrap();
    let shear = pair().shear_modulus().unwrap() / pair().contact_modulus().unwrap();
    // k_x/k_z = (2 - 2 nu)/(2 - nu) = 2/3, until mu F.
    assert_relative_eq!(shear, 2.0 / 3.0, max_relative = 1e-14);
    let reach = MU * 1e-3 / (shear * state.stiffness.unwrap());
    for (share, force) in [(0.5, 0.5), (0.99, 0.99), (1.5, 1.0)] {
        history.restart();
        history.advance(Step::new(0.0, Load::force(1e-3))).unwrap();
        let tangential = Tangential::displacement_along_x(share * reach);
        let step = Step::new(0.0, Load::force(1e-3).with_tangential(tangential));
        let found = history.advance(step).unwrap().tangential.unwrap();
        // The table's face has the solves' own accuracy.
        assert_relative_eq!(found.force[0], force * MU * 1e-3, max_relative = 1e-5);
        assert_relative_eq!(
            found.dissipated,
            MU * 1e-3 * reach * (share - force),
            max_relative = 1e-4,
            epsilon = 1e-6 * MU * 1e-3 * reach
        );
    }
}

#[test]
fn history_in_time_and_in_load_give_the_same_rough_contact() {
    // A force held constant and the approach that it makes, prescribed: the same forces, to the order of the
    // segments of the path.
    let model = Bem3d { cells: 17, tolerance: 1e-9, ..Bem3d::default() };
    let scene = creeping(fractal());
    let mut by_force = Equivalent::new(model).prepare(&scene, 2).unwrap();
    let force = by_force.normalisation().force(0.1).unwrap();
    let error = |segments: u32| {
        let mut by_force = Equivalent::new(model).prepare(&scene, 2).unwrap();
        let mut by_approach = Equivalent::new(model).prepare(&scene, 2).unwrap();
        let mut last = 0.0;
        for i in 0..=segments {
            let time = 4.0 * f64::from(i) / f64::from(segments);
            let d = by_force.advance(Step::new(time, Load::force(force))).unwrap().approach.unwrap();
            last = by_approach.advance(Step::new(time, Load::approach(d))).unwrap().force;
        }
        (last / force - 1.0).abs()
    };
    assert!(by_force.advance(Step::new(0.0, Load::force(force))).is_ok());
    let (coarse, fine) = (error(10), error(40));
    assert!(fine < 0.1 * coarse && fine < 1e-3, "{coarse:e} {fine:e}");
}

/// Surfaces with ties, faces, steps, needles and pits, on which k(d) jumps or is constant, still have a
/// profile.
#[test]
fn hard_surfaces_have_profiles() {
    let cells = 12;
    let from_middle = |x: usize, y: usize| (x as f64 - 5.5).hypot(y as f64 - 5.5);
    let heights: [&dyn Fn(usize, usize) -> f64; 9] = [
        &|_, _| 0.0,
        &|x, _| if x < 6 { 0.0 } else { -0.01 },
        &|x, y| if (x, y) == (5, 7) { -10.0 } else { 0.0 },
        &|x, y| if (x, y) == (5, 7) { 1.0 } else { 0.0 },
        &|x, y| if (x + y) % 2 == 0 { 0.0 } else { -1e-3 },
        &|x, y| -(((x * 7 + y * 13) % 11) as f64) * 0.01,
        &|x, y| -(from_middle(x, y) / 2.0).floor() * 0.01,
        &|x, _| x as f64 * 0.01,
        &|x, y| 1e-6 * ((x * 31 + y * 17) % 29) as f64,
    ];
    let model = Equivalent { per_decade: 8, ..Equivalent::new(Bem3d::default()) };
    for (which, height) in heights.into_iter().enumerate() {
        let surface = Surface::Heights(std::sync::Arc::new(tests::map(cells, 1.0, height).unwrap()));
        for force in [1e-6, 1e-3, 0.1] {
            let mut slides = model.prepare(&sliding(surface.clone()), 0).unwrap();
            for (normal, share) in [(1.0, 0.5), (3.0, -0.9), (2.0, 1.0), (0.0, 0.0), (1.0, 0.3)] {
                let step = Step::new(
                    0.0,
                    Load::force(normal * force)
                        .with_tangential(Tangential::force_along_x(share * MU * normal * force)),
                );
                let state =
                    slides.advance(step).unwrap_or_else(|error| panic!("{which} {force} {normal}: {error}"));
                assert!(state.tangential.unwrap().displacement[0].is_finite());
            }
            let mut creeps = model.prepare(&creeping(surface.clone()), 0).unwrap();
            let mut last = 0.0;
            for (time, share) in [(0.0, 1.0), (1.0, 1.0), (10.0, 2.0), (1e3, 2.0)] {
                let state = creeps.advance(Step::new(time, Load::force(share * force))).unwrap();
                let d = state.approach.unwrap();
                assert!(d >= last, "{which} {force} {time}");
                last = d;
            }
        }
    }
}
