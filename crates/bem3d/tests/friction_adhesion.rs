//! Friction together with adhesion: Derjaguin's law, Tresca's law, limits.

#![allow(clippy::unwrap_used)] // Helpers of tests.

use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Body, Boundary, ContactModel, ContactState, Friction, FrictionLaw, Load,
    Outputs, Pair, Scene, SelfAffine, Step, Surface, Tangential,
};

const RANGE: f64 = 0.01;
const WORK: f64 = 1e-4;

/// A rough surface with sides of 1 and heights of 0.01 on 33 cells a side, of bodies that are alike, with E* = 1.
fn scene(friction: Friction, work: f64, law: AdhesionLaw, boundary: Boundary) -> Scene {
    let mut surface = SelfAffine::new(2.2, 1.0, 0.01).unwrap();
    surface.short_cutoff = Some(30.0);
    let body = Body::Elastic { young: 2.0 * (1.0 - 0.09), poisson: 0.3 };
    let mut scene = Scene::of_pair(Surface::SelfAffine(surface), Pair { first: body, second: body }).unwrap();
    scene.effects.boundary = boundary;
    scene.effects.friction = friction.with_coupling(Some(bem3d::Coupling::Neglected));
    if work > 0.0 {
        scene.effects.adhesion = Adhesion::FiniteRange { work, range: RANGE, law };
    }
    scene.outputs = Outputs { area: true, pressure: true, gap: true, traction: true, ..Outputs::default() };
    scene
}

fn path(scene: &Scene, loads: &[Load]) -> Vec<ContactState> {
    let model = Bem3d { cells: 33, tolerance: 1e-8, ..Bem3d::default() };
    let mut contact = model.prepare(scene, 2).unwrap();
    let steps = loads.iter().enumerate();
    steps.map(|(i, load)| contact.advance(Step::new(i as f64, *load)).unwrap()).collect()
}

fn pushed(normal: Load, displacement: [f64; 2]) -> Load {
    normal.with_tangential(Tangential::Displacement(displacement))
}

/// The sum of the attraction: that of open cells is their net pressure, that of closed ones the peak.
fn attraction(state: &ContactState) -> f64 {
    let net = state.pressure().unwrap().values();
    let cell = 1.0 / net.len() as f64;
    let open: f64 =
        net.iter().zip(state.gap().unwrap().values()).filter(|(_, gap)| **gap > 1e-8).map(|(p, _)| -p).sum();
    open * cell + WORK / RANGE * state.area.unwrap()
}

const LAWS: [AdhesionLaw; 2] = [AdhesionLaw::Exponential, AdhesionLaw::Dugdale];

/// Derjaguin's law: in full sliding all friction is `mu (F + sum of the attraction)`, also where the contact is
/// pulled.
#[test]
fn in_full_sliding_friction_is_that_of_force_and_attraction() {
    let mu = 0.4;
    for law in LAWS {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let scene = scene(Friction::coulomb(mu), WORK, law, boundary);
            for force in [5e-3, 1e-3, 0.0, -2e-4] {
                // Nothing breaks off before.
                let states = path(
                    &scene,
                    &[Load::force(5e-3), Load::force(force), pushed(Load::force(force), [0.5, 0.2])],
                );
                let state = states.last().unwrap();
                let found = state.tangential.as_ref().unwrap();
                let expected = mu * (state.force + attraction(state));
                let [x, y] = found.force;
                assert!(
                    (x.hypot(y) / expected - 1.0).abs() < 1e-6,
                    "{law:?} {boundary:?} {force}: {x} {y} {expected}"
                );
                assert!((found.sliding_force.unwrap() / expected - 1.0).abs() < 1e-6);
                // The direction is that of the displacement, but for what remains of the elastic one.
                assert!((y / x - 0.4).abs() < 0.05);
            }
        }
    }
}

/// A tangential load changes neither the area nor the pressure, because tractions do not change gaps here.
#[test]
fn a_tangential_load_leaves_the_normal_state_as_it_is() {
    for law in LAWS {
        let mut without = scene(Friction::Off, WORK, law, Boundary::Free);
        without.outputs.traction = false;
        let bare = path(&without, &[Load::approach(0.01), Load::approach(0.006)]);
        let with = path(
            &scene(Friction::coulomb(0.3), WORK, law, Boundary::Free),
            &[pushed(Load::approach(0.01), [1e-3, 0.0]), pushed(Load::approach(0.006), [2e-3, 1e-3])],
        );
        for (a, b) in bare.iter().zip(&with) {
            assert_eq!((a.force, a.area, a.adhesive), (b.force, b.area, b.adhesive));
            assert_eq!(a.pressure().unwrap().values(), b.pressure().unwrap().values());
        }
    }
}

/// Tresca's law: the contact slides at its strength times its area, whatever the force.
#[test]
fn a_shear_strength_acts_on_the_area() {
    let strength = 0.01;
    for law in LAWS {
        let scene = scene(Friction::tresca(strength), WORK, law, Boundary::Free);
        for force in [3e-3, 0.0, -2e-4] {
            let states = path(
                &scene,
                &[Load::force(5e-3), Load::force(force), pushed(Load::force(force), [0.9, 0.0])],
            );
            let state = states.last().unwrap();
            let found = state.tangential.as_ref().unwrap();
            let expected = strength * state.area.unwrap();
            assert!((found.force[0] / expected - 1.0).abs() < 1e-4, "{force}: {:?} {expected}", found.force);
            assert!((found.sliding_force.unwrap() / expected - 1.0).abs() < 1e-12);
        }
    }
}

/// A sphere by Tresca's law: in full stick the stiffness is that of the area, `2 E* a` without a Poisson's ratio, and in
/// full sliding the force is the strength times the area, which is that of the sphere without friction.
#[test]
fn a_sphere_that_is_attracted_sticks_and_slides_with_its_area() {
    let body = Body::Elastic { young: 2.0, poisson: 0.0 };
    let surface = Surface::Sphere { radius: 1.0, size: 0.5.into() };
    let mut scene = Scene::of_pair(surface, Pair { first: body, second: body }).unwrap();
    let (work, strength) = (2e-4, 0.005);
    scene.effects.adhesion = Adhesion::FiniteRange { work, range: 5e-3, law: AdhesionLaw::Dugdale };
    scene.outputs = Outputs { area: true, ..Outputs::default() };
    let model = Bem3d { cells: 129, tolerance: 1e-6, ..Bem3d::default() };
    let bare = model.prepare(&scene, 0).unwrap().solve(Load::force(5e-4)).unwrap();
    scene.effects.friction = Friction::tresca(strength);
    scene.outputs.tangential_stiffness_stuck = true;
    let mut contact = model.prepare(&scene, 0).unwrap();
    let state = contact.advance(Step::new(0.0, Load::force(5e-4))).unwrap();
    assert_eq!(state.area, bare.area);
    let area = state.area.unwrap();
    let radius = (area / std::f64::consts::PI).sqrt();
    let stuck = state.tangential.unwrap().stiffness_stuck.unwrap()[0][0];
    // Of first order in the cell over the radius.
    println!("{} cells a radius, stiffness {:e}", radius * 129.0 / 0.5, stuck / (2.0 * radius) - 1.0);
    assert!((stuck / (2.0 * radius) - 1.0).abs() < 0.01, "{stuck} {radius}");
    let slid = contact.advance(Step::new(1.0, pushed(Load::force(5e-4), [0.1, 0.0]))).unwrap();
    let found = slid.tangential.unwrap();
    assert!((found.force[0] / (strength * area) - 1.0).abs() < 1e-6);
    assert_eq!(slid.area, bare.area);
}

/// The same without a range: JKR's sphere slides at the strength times JKR's area, pressed and pulled (Menga, Carbone
/// and Dini, J. Mech. Phys. Solids 112, 145 (2018), for a uniform shear stress). In full stick it has Savkoor and
/// Briggs's stiffness `8 G* a = 2 E* a` to first order in the cell: cells that are attached in part stick as a whole.
#[test]
fn a_sphere_with_adhesion_of_short_range_slides_with_jkr_s_area() {
    let body = Body::Elastic { young: 2.0, poisson: 0.0 };
    let (work, strength, size) = (2e-4, 0.005, 0.36);
    let pull_off: f64 = 1.5 * std::f64::consts::PI * work;
    let mut too_stiff = Vec::new();
    for cells in [65, 129] {
        let surface = Surface::Sphere { radius: 1.0, size: size.into() };
        let mut scene = Scene::of_pair(surface, Pair { first: body, second: body }).unwrap();
        scene.effects.adhesion = Adhesion::ShortRange { work };
        scene.effects.friction = Friction::tresca(strength);
        scene.outputs =
            Outputs { area: true, stick_area: true, tangential_stiffness_stuck: true, ..Outputs::default() };
        let mut contact = Bem3d { cells, tolerance: 1e-6, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
        for (i, share) in [1.0, 0.0, -0.5].into_iter().enumerate() {
            let force = share * pull_off;
            // JKR: a^3 = 3 R/(4 E*) (F + 3 pi w R + sqrt(6 pi w R F + (3 pi w R)^2)).
            let unit = 2.0 * pull_off;
            let radius = (0.75 * (force + unit + (2.0 * unit * force + unit * unit).sqrt())).cbrt();
            let step =
                |time: usize, delta: f64| Step::new(time as f64, pushed(Load::force(force), [delta, 0.0]));
            let stuck = contact.advance(step(2 * i, 0.1 * i as f64)).unwrap();
            let area = stuck.area.unwrap();
            let found = (area / std::f64::consts::PI).sqrt();
            assert!((found / radius - 1.0).abs() < 0.02, "{cells} {share}: {found} {radius}");
            let stiffness = stuck.tangential.unwrap().stiffness_stuck.unwrap()[0][0];
            too_stiff.push((stiffness / (2.0 * radius) - 1.0) * radius * cells as f64 / size);
            let slides = contact.advance(step(2 * i + 1, 0.1 * (i + 1) as f64)).unwrap();
            let found = slides.tangential.unwrap();
            assert!((found.force[0] / (strength * area) - 1.0).abs() < 1e-4, "{cells} {share}: {found:?}");
            assert_eq!(slides.area, stuck.area);
        }
    }
    println!("too stiff by these numbers of cells over the radius: {too_stiff:?}");
    assert!(too_stiff.iter().all(|cells| (0.0..2.5).contains(cells)), "{too_stiff:?}");
}

/// Without work of adhesion the states are those of friction alone, and tend to them.
#[test]
fn without_work_the_tractions_are_those_of_friction_alone() {
    let loads =
        [Load::force(5e-3), pushed(Load::force(5e-3), [2e-3, 0.0]), pushed(Load::force(4e-3), [1e-3, 1e-3])];
    let forces = |work: f64| -> Vec<f64> {
        let scene = scene(Friction::coulomb(0.3), work, AdhesionLaw::Exponential, Boundary::Free);
        path(&scene, &loads).iter().flat_map(|state| state.tangential.as_ref().unwrap().force).collect()
    };
    let alone = forces(0.0);
    let far =
        |work: f64| forces(work).iter().zip(&alone).fold(0.0, |far: f64, (a, b)| far.max((a - b).abs()));
    let (one, two) = (far(1e-6), far(1e-8));
    assert!(
        two < 3e-2 * one && one < 0.1 * alone.iter().fold(0.0, |a: f64, b| a.max(b.abs())),
        "{one} {two}"
    );
}

#[test]
fn what_is_not_solved_is_refused() {
    let refused = |scene: &Scene| Bem3d::default().prepare(scene, 0).err().unwrap().to_string();
    let mut short = scene(Friction::coulomb(0.3), WORK, AdhesionLaw::Dugdale, Boundary::Free);
    short.effects.adhesion = Adhesion::ShortRange { work: WORK };
    assert!(refused(&short).contains("give the adhesion a range"), "{}", refused(&short));
    short.effects.friction = Friction::of(FrictionLaw { shear_strength: 0.1, ..FrictionLaw::coulomb(0.3) });
    assert!(refused(&short).contains("a shear strength alone"), "{}", refused(&short));
    let mut coupled = scene(Friction::coulomb(0.3), WORK, AdhesionLaw::Dugdale, Boundary::Free);
    coupled.pair = Some(Pair { first: Body::Rigid, second: Body::Elastic { young: 0.91, poisson: 0.3 } });
    coupled.effects.friction =
        Friction::of(FrictionLaw::coulomb(0.3)).with_coupling(Some(bem3d::Coupling::Full));
    assert!(refused(&coupled).contains("not solved"), "{}", refused(&coupled));
}
