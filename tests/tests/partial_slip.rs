//! Friction cell by cell: boundary elements compared with closed forms and with differences of their own
//! normal contacts.

use analytic::CattaneoMindlin;
use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{
    Body, Boundary, ContactModel, ContactState, Coupling, Effects, Error, Friction, HeightMap, Load, Outputs,
    Pair, PreparedContact, Scene, SelfAffine, Step, StickSlip, Surface, Tangential,
};

const MU: f64 = 0.3;
const TOLERANCE: f64 = 1e-9;

fn alike(poisson: f64) -> Pair {
    let body = Body::Elastic { young: 2.0, poisson };
    Pair { first: body, second: body }
}

fn scene(surface: Surface, pair: Pair, outputs: Outputs) -> Scene {
    let mut scene = Scene::of_pair(surface, pair).unwrap();
    scene.effects.friction = Friction::coulomb(MU);
    scene.outputs = outputs;
    scene
}

fn rough() -> Surface {
    Surface::SelfAffine(SelfAffine::new(2.3, 1.0, 0.02).unwrap())
}

fn model(cells: usize) -> Bem3d {
    Bem3d { cells, tolerance: TOLERANCE, ..Bem3d::default() }
}

fn step(time: f64, force: f64, tangential: [f64; 2]) -> Step {
    Step::new(time, Load::force(force).with_tangential(Tangential::Force(tangential)))
}

fn advance(contact: &mut dyn PreparedContact, step: Step) -> ContactState {
    contact.advance(step).unwrap()
}

/// Without Poisson's ratio `q = mu (p(F) - p(F - Q/mu))` and `delta = mu (d(F) - d(F - Q/mu))` hold cell by
/// cell for any surface (Ciavarella 1998, Jaeger 1998), in one step and in many.
#[test]
fn without_poissons_ratio_tractions_are_differences_of_pressures() {
    let outputs = Outputs { pressure: true, traction: true, stick_slip: true, ..Outputs::default() };
    let scene = scene(rough(), alike(0.0), outputs);
    let (force, share) = (0.02, 0.6);
    let frictionless = Scene {
        effects: Effects::default(),
        outputs: Outputs { pressure: true, ..Outputs::default() },
        ..scene.clone()
    };
    let mut normal = model(48).prepare(&frictionless, 3).unwrap();
    let [whole, rest] = [force, force * (1.0 - share)].map(|f| normal.solve(Load::force(f)).unwrap());
    for steps in [1, 3] {
        let mut contact = model(48).prepare(&scene, 3).unwrap();
        advance(&mut *contact, step(0.0, force, [0.0; 2]));
        let mut state = None;
        for i in 1..=steps {
            // Along a line that is no axis.
            let q = MU * force * share * f64::from(i) / f64::from(steps);
            state = Some(advance(&mut *contact, step(0.0, force, [0.6 * q, 0.8 * q])));
        }
        let state = state.unwrap();
        let tangential = state.tangential.unwrap();
        let delta = MU * (whole.approach.unwrap() - rest.approach.unwrap());
        assert_relative_eq!(tangential.displacement[0], 0.6 * delta, max_relative = 1e-7);
        assert_relative_eq!(tangential.displacement[1], 0.8 * delta, max_relative = 1e-7);
        assert_relative_eq!(tangential.sliding_force.unwrap(), MU * force, max_relative = 1e-12);
        let fields = state.fields.as_ref().unwrap();
        let [x, y] = fields.traction.as_ref().unwrap();
        let pressures = whole.pressure().unwrap().values().iter().zip(rest.pressure().unwrap().values());
        let largest = whole.pressure().unwrap().values().iter().copied().fold(0.0, f64::max);
        let mut slipping = 0;
        for ((p, rest), (x, y)) in pressures.zip(x.values().iter().zip(y.values())) {
            let q = MU * (p - rest);
            assert!((x - 0.6 * q).hypot(y - 0.8 * q) < 1e-6 * MU * largest, "{x} {y} for {q}");
            slipping += usize::from(*p > 0.0 && *rest <= 0.0);
        }
        let classes = fields.stick_slip.as_ref().unwrap().values();
        let slip = classes.iter().filter(|&&class| class > StickSlip::Stick.value()).count();
        assert!(
            slip.abs_diff(slipping) <= 2,
            "{slip} cells slip, {slipping} are pressed by the last of the force"
        );
    }
}

/// Without Poisson's ratio the contact slides from `mu d(F)` on. A force of mu F has this displacement but for the
/// last billionth of the force, which is 1e-6 of it for a sphere (Cattaneo and Mindlin) and less on cells, of which
/// one sticks last.
#[test]
fn the_displacement_at_the_sliding_force_is_the_least_at_which_the_contact_slides() {
    let sphere = Surface::Sphere { radius: 1.0, size: 0.4.into() };
    let scene = scene(sphere, alike(0.0), Outputs::default());
    let force = 2e-3;
    let at = |q: f64| {
        let mut contact = model(64).prepare(&scene, 0).unwrap();
        let before = advance(&mut *contact, step(0.0, force, [0.0; 2]));
        let state = advance(&mut *contact, step(1.0, force, [q, 0.0]));
        (MU * before.approach.unwrap(), state.tangential.unwrap())
    };
    let (least, slides) = at(MU * force);
    assert_relative_eq!(slides.force[0], MU * force, max_relative = 1e-15);
    let missing = 1.0 - slides.displacement[0] / least;
    assert!((0.0..=1e-6).contains(&missing), "{missing:e}");
    let (_, nearly) = at(MU * force * (1.0 - 1e-9));
    assert_relative_eq!(nearly.displacement[0], slides.displacement[0], max_relative = 1e-12);
    // The closed form takes mu F itself.
    let model = CattaneoMindlin.prepare(&scene, 0);
    let mut contact = model.unwrap();
    contact.advance(step(0.0, force, [0.0; 2])).unwrap();
    let share = |q: f64, contact: &mut dyn PreparedContact| {
        contact.advance(step(1.0, force, [q, 0.0])).unwrap().tangential.unwrap().displacement[0]
    };
    let nearly = share(MU * force * (1.0 - 1e-9), &mut *contact);
    let slides = share(MU * force, &mut *contact);
    assert_relative_eq!(1.0 - nearly / slides, 1e-6, max_relative = 1e-3);
}

/// Q = 8 G a delta/(2 - nu) on one body, and the stiffness is that number.
#[test]
fn a_disc_that_sticks_has_mindlins_stiffness() {
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 3.0, poisson: 0.5 } };
    let outputs =
        Outputs { tangential_stiffness: true, tangential_stiffness_stuck: true, ..Outputs::default() };
    let errors = [32, 64, 128].map(|cells| {
        let disc = Surface::FlatCircle { radius: 0.4, size: 1.0.into() };
        let mut scene = scene(disc, pair, outputs);
        scene.effects.friction = Friction::coulomb(1e3);
        let mut contact = model(cells).prepare(&scene, 0).unwrap();
        let delta = 1e-4;
        let tangential = Tangential::Displacement([delta, 0.0]);
        let state = contact.advance(Step::new(0.0, Load::force(1.0).with_tangential(tangential))).unwrap();
        let found = state.tangential.unwrap();
        let k = found.stiffness_stuck.unwrap();
        assert_relative_eq!(found.force[0] / delta, k[0][0], max_relative = 1e-6);
        assert_relative_eq!(k[0][0], k[1][1], max_relative = 1e-6);
        assert!(k[0][1].abs() < 1e-6 * k[0][0] && found.force[1].abs() < 1e-6 * found.force[0]);
        k[0][0] / (2.0 * pair.shear_modulus().unwrap() * 0.4) - 1.0
    });
    println!("{errors:?}");
    // The number of cells whose centres lie in the disc is not monotonic.
    assert!(errors.iter().all(|error| error.abs() < 0.006), "{errors:?}");
}

/// Loading, reversal and a smaller loop of a sphere, compared with Cattaneo, Mindlin and Deresiewicz, who
/// neglect the displacements across the direction of the tractions: exact for a Poisson's ratio of 0.
#[test]
fn a_sphere_follows_cattaneo_mindlin_and_deresiewicz() {
    let shares = [0.5, 0.8, -0.2, 0.3, -0.9];
    let run = |model: &dyn ContactModel| -> Vec<[f64; 2]> {
        let sphere = Surface::Sphere { radius: 1.0, size: 0.25.into() };
        let mut contact = model.prepare(&scene(sphere, alike(0.0), Outputs::default()), 0).unwrap();
        let force = 1e-3;
        contact.advance(Step::new(0.0, Load::force(force))).unwrap();
        let along = |share: f64| {
            let state = contact.advance(step(0.0, force, [share * MU * force, 0.0])).unwrap();
            let tangential = state.tangential.unwrap();
            [tangential.displacement[0], tangential.dissipated]
        };
        shares.map(along).to_vec()
    };
    let exact = run(&CattaneoMindlin);
    let errors: Vec<[f64; 2]> = [32, 64, 128]
        .map(|cells| {
            let found = run(&model(cells));
            [0, 1].map(|i| {
                let scale = exact.iter().map(|e| e[i].abs()).fold(0.0, f64::max);
                found.iter().zip(&exact).map(|(f, e)| (f[i] - e[i]).abs() / scale).fold(0.0, f64::max)
            })
        })
        .to_vec();
    println!("{errors:?}");
    assert!(
        errors[2].iter().zip(&errors[0]).all(|(fine, coarse)| *fine < 0.01 && fine < coarse),
        "{errors:?}"
    );
}

#[test]
fn a_force_beyond_friction_is_an_error_and_a_displacement_gross_slip() {
    let outputs = Outputs { stick_area: true, ..Outputs::default() };
    let mut contact = model(32).prepare(&scene(rough(), alike(0.3), outputs), 1).unwrap();
    let force = 0.01;
    let before = advance(&mut *contact, step(0.0, force, [0.5 * MU * force, 0.0]));
    let refused = contact.advance(step(1.0, force, [1.01 * MU * force, 0.0])).unwrap_err();
    assert!(
        matches!(refused, Error::OutOfRange { max, .. } if (max / (MU * force) - 1.0).abs() < 1e-8),
        "{refused}"
    );
    // The path is where it was.
    let again = advance(&mut *contact, step(1.0, force, [0.5 * MU * force, 0.0]));
    let [one, other] = [&before, &again].map(|state| state.tangential.unwrap());
    assert_relative_eq!(one.displacement[0], other.displacement[0], max_relative = 1e-7);
    let far = Tangential::Displacement([0.5, 0.0]);
    let state = contact.advance(Step::new(2.0, Load::force(force).with_tangential(far))).unwrap();
    let sliding = state.tangential.unwrap();
    // Elastic displacements across turn the slip of single cells by some 1e-4.
    assert_relative_eq!(sliding.force[0], MU * force, max_relative = 1e-6);
    assert!(sliding.stick_area.unwrap() <= 0.0 && sliding.slip_area.unwrap() > 0.0);
    assert!(sliding.dissipated > 0.9 * MU * force * 0.5 * 0.9, "{sliding:?}");
    // Lifted off, nothing holds a force.
    assert!(contact.advance(step(3.0, 0.0, [1e-6, 0.0])).is_err());
    let apart = advance(&mut *contact, step(3.0, 0.0, [0.0; 2]));
    assert!(apart.tangential.unwrap().sliding_force.unwrap() <= 0.0);
}

#[test]
fn bodies_with_coupling_need_the_choice_of_it() {
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 3.0, poisson: 0.2 } };
    let mut scene = scene(rough(), pair, Outputs::default());
    let asked = model(24).prepare(&scene, 1).err().unwrap().to_string();
    assert!(asked.contains("Dundurs"), "{asked}");
    let force = 0.01;
    let mut displacements = Vec::new();
    for coupling in [Coupling::Neglected, Coupling::Full] {
        scene.effects.friction = Friction::coulomb(MU).with_coupling(Some(coupling));
        let mut contact = model(24).prepare(&scene, 1).unwrap();
        advance(&mut *contact, step(0.0, force, [0.0; 2]));
        let mut dissipated = 0.0;
        // A loop: friction never gives energy back.
        for (i, share) in [0.4, -0.3, 0.4, 0.1].into_iter().enumerate() {
            let state = advance(&mut *contact, step(i as f64, force, [share * MU * force, 0.0]));
            let tangential = state.tangential.unwrap();
            assert!(tangential.dissipated >= dissipated, "{tangential:?}");
            assert!(state.report.certificate.meets(TOLERANCE));
            dissipated = tangential.dissipated;
            displacements.push(tangential.displacement[0]);
        }
    }
    let (neglected, full) = displacements.split_at(4);
    let change = full.iter().zip(neglected).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    assert!(change > 1e-4 && change < 0.5, "coupling changes displacements by {change}");
}

/// The stiffness of the branch is accurate to the tolerance, and equals the difference quotient of two steps.
#[test]
fn the_stiffness_of_the_branch_is_a_difference_quotient() {
    let outputs = Outputs { tangential_stiffness: true, ..Outputs::default() };
    let scene = scene(rough(), alike(0.3), outputs);
    let model = Bem3d { cells: 48, tolerance: 1e-6, ..Bem3d::default() };
    let force = 0.02;
    let mut contact = model.prepare(&scene, 3).unwrap();
    advance(&mut *contact, step(0.0, force, [0.0; 2]));
    let at = |contact: &mut dyn PreparedContact, share: f64| {
        let state = advance(contact, step(0.0, force, [share * MU * force, 0.0]));
        assert!(state.report.certificate.meets(1e-6), "{}", state.report.certificate);
        state.tangential.unwrap()
    };
    let (before, h) = (at(&mut *contact, 0.5), 1e-3);
    let after = at(&mut *contact, 0.5 + h);
    let k = before.stiffness.unwrap();
    let moved = [0, 1].map(|i| after.displacement[i] - before.displacement[i]);
    let found = [0, 1].map(|i| k[i][0] * moved[0] + k[i][1] * moved[1]);
    assert_relative_eq!(found[0], h * MU * force, max_relative = 0.01);
    assert!(found[1].abs() < 0.01 * h * MU * force, "{found:?}");
}

/// The force after a reversal of 40 nm is the same whether the ball has slid 10 mm before or 0.1 mm: the
/// accuracy of an increment does not depend on what lies behind.
#[test]
fn a_reversal_forgets_how_far_the_contact_has_slid() {
    let steel = Body::Elastic { young: 210e9, poisson: 0.3 };
    let ball = Surface::Heights(
        HeightMap::from_fn(65, 200e-6, |ix, iy| {
            let [x, y] = [ix, iy].map(|i| (i as f64 - 32.0) * 200e-6 / 65.0);
            -(x * x + y * y) / (2.0 * 10e-3)
        })
        .unwrap()
        .into(),
    );
    let scene = scene(ball, Pair { first: steel, second: steel }, Outputs::default());
    let model = Bem3d { cells: 65, ..Bem3d::default() };
    let forces = [1e-4, 1e-2].map(|slid: f64| {
        let mut contact = model.prepare(&scene, 0).unwrap();
        let mut found = None;
        for (time, delta) in [(0.0, 0.0), (1.0, slid), (2.0, slid - 40e-9)] {
            let tangential = Tangential::Displacement([delta, 0.0]);
            let state = advance(&mut *contact, Step::new(time, Load::force(1.0).with_tangential(tangential)));
            found = Some(state.tangential.unwrap().force[0]);
        }
        found.unwrap()
    });
    assert!(forces[0] > 0.0 && forces[0] < MU);
    assert_relative_eq!(forces[0], forces[1], max_relative = 1e-5);
}

/// In full contact with periodic boundaries a uniform traction causes no displacement: there is nothing to
/// solve but rounding, and no stiffness.
#[test]
fn a_periodic_surface_that_sticks_as_a_whole_does_not_move() {
    let outputs = Outputs {
        tangential_stiffness: true,
        tangential_stiffness_stuck: true,
        traction: true,
        ..Outputs::default()
    };
    let mut scene = scene(rough(), alike(0.3), outputs);
    scene.effects.boundary = Boundary::Periodic;
    let mut contact = model(8).prepare(&scene, 3).unwrap();
    let force = 5.0;
    advance(&mut *contact, step(0.0, force, [0.0; 2]));
    for share in [0.3, 0.5, -0.5] {
        let q = share * MU * force;
        let state = advance(&mut *contact, step(0.0, force, [q, 0.5 * q]));
        let found = state.tangential.unwrap();
        assert!(found.displacement.iter().all(|d| d.abs() < 1e-12), "{found:?}");
        assert!(found.stiffness.is_none() && found.stiffness_stuck.is_none(), "{found:?}");
        // The side is 1: the force is the mean traction.
        let [x, y] = state.fields.as_ref().unwrap().traction.as_ref().unwrap();
        for (x, y) in x.values().iter().zip(y.values()) {
            assert_relative_eq!(*x, q, max_relative = 1e-9);
            assert_relative_eq!(*y, 0.5 * q, max_relative = 1e-9);
        }
    }
}
