//! Closed forms on rectangles: `L = sqrt(Lx Ly)`, and a round contact may reach half the shorter side.

#![allow(clippy::unwrap_used)]

use analytic::{
    CattaneoMindlin, FlatPunch, GreenwoodWilliamson, Hertz, Jkr, Persson, PowerLaw, PowerLawBody, Westergaard,
};
use approx::assert_relative_eq;
use contact_model::{
    Adhesion, Body, Boundary, ContactModel, Error, Friction, Load, Pair, Scene, SelfAffine, Size, Step,
    Surface, Tangential,
};

/// A handful of products.
const ROUNDING: f64 = 1e-14;

/// A 4 x 1 rectangle and the square of the same area.
const SIZES: [Size; 2] = [Size { x: 4.0, y: 1.0 }, Size { x: 2.0, y: 2.0 }];

/// Both have the same normalisation and the same states.
fn same(model: &dyn ContactModel, scene: impl Fn(Size) -> Scene, load: Load) {
    let [one, other] = SIZES.map(|size| {
        let mut scene = scene(size);
        scene.outputs.area = !matches!(scene.surface, Surface::SelfAffine(_));
        let mut contact = model.prepare(&scene, 0).unwrap();
        assert_eq!(contact.normalisation().length.to_bits(), 2.0_f64.to_bits());
        contact.solve(load).unwrap()
    });
    let near = |a: f64, b: f64| assert_relative_eq!(a, b, max_relative = ROUNDING);
    near(one.force, other.force);
    near(one.stiffness.unwrap(), other.stiffness.unwrap());
    assert_eq!(
        (one.approach.is_some(), one.area.is_some()),
        (other.approach.is_some(), other.area.is_some())
    );
    near(one.approach.unwrap_or(0.0), other.approach.unwrap_or(0.0));
    near(one.area.unwrap_or(0.0), other.area.unwrap_or(0.0));
}

fn out_of_range(model: &dyn ContactModel, surface: Surface, approach: f64) {
    let outcome =
        model.prepare(&Scene::new(surface, 1.0), 0).and_then(|mut it| it.solve(Load::approach(approach)));
    match outcome {
        Err(Error::OutOfRange { max, .. }) => assert_relative_eq!(max, 0.5, max_relative = ROUNDING),
        other => panic!("{other:?}"),
    }
}

#[test]
fn round_bodies_do_not_see_the_rectangle_until_they_leave_it() {
    let sphere = |size| Surface::Sphere { radius: 1.0, size };
    let cone = |size| Surface::Cone { slope: 0.1, size };
    let punch = |radius| move |size| Surface::FlatCircle { radius, size };
    for model in [&Hertz as &dyn ContactModel, &PowerLawBody, &Jkr] {
        same(model, |size| Scene::new(sphere(size), 2.0), Load::approach(0.2));
        // a = 0.6 for R = 1: less than half the square's side, more than half the shorter one.
        let square = Scene::new(sphere(SIZES[1]), 1.0);
        assert!(model.prepare(&square, 0).unwrap().solve(Load::approach(0.36)).is_ok());
        out_of_range(model, sphere(SIZES[0]), 0.36);
        // Exactly half the shorter side is still inside.
        let edge = Scene::new(sphere(SIZES[0]), 1.0);
        assert!(model.prepare(&edge, 0).unwrap().solve(Load::approach(0.25)).is_ok());
    }
    same(&PowerLawBody, |size| Scene::new(cone(size), 2.0), Load::force(0.01));
    out_of_range(&PowerLawBody, cone(SIZES[0]), 0.1);
    same(&FlatPunch, |size| Scene::new(punch(0.4)(size), 2.0), Load::force(0.01));
    out_of_range(&FlatPunch, punch(0.6)(SIZES[0]), 0.1);
    same(
        &Jkr,
        |size| {
            let mut scene = Scene::new(sphere(size), 2.0);
            scene.effects.adhesion = Adhesion::ShortRange { work: 1e-3 };
            scene
        },
        Load::force(-1e-3),
    );
}

#[test]
fn the_constant_of_the_square_is_not_that_of_a_rectangle() {
    let e = FlatPunch.prepare(&Scene::new(Surface::Flat { size: SIZES[0] }, 1.0), 0).map(|_| ()).unwrap_err();
    let text = "the model flat_punch does not support a flat rectangle: the constant is that of a square";
    assert_eq!(e.to_string(), text);
}

#[test]
fn friction_leaves_the_shorter_side_too() {
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 1.0, poisson: 0.3 } };
    let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: SIZES[0] }, pair).unwrap();
    scene.effects.friction = Friction::coulomb(0.3);
    let step = |d| Step::new(0.0, Load::approach(d).with_tangential(Tangential::force_along_x(0.0)));
    let mut history = CattaneoMindlin.prepare(&scene, 0).unwrap();
    assert_relative_eq!(history.normalisation().length, 2.0);
    assert!(history.advance(step(0.2)).is_ok());
    let mut history = CattaneoMindlin.prepare(&scene, 0).unwrap();
    assert!(matches!(history.advance(step(0.36)), Err(Error::OutOfRange { .. })));
}

#[test]
fn a_wave_counts_along_x() {
    let scene = |size: Size| {
        let mut scene = Scene::new(Surface::Sine { amplitude: 0.01, wavelength: 0.5, size }, 2.0);
        scene.effects.boundary = Boundary::Periodic;
        scene.outputs.mean_gap = true;
        scene
    };
    same(&Westergaard, scene, Load::force(0.1));
    same(&Westergaard, scene, Load::mean_gap(0.003));
    let gap = |size| {
        Westergaard.prepare(&scene(size), 0).unwrap().solve(Load::force(0.1)).unwrap().mean_gap.unwrap()
    };
    assert_relative_eq!(gap(SIZES[0]), gap(SIZES[1]), max_relative = ROUNDING);
    // Eight and a half waves along x, whole ones along y.
    let e = Westergaard.prepare(&scene(Size { x: 4.25, y: 1.0 }), 0).map(|_| ()).unwrap_err();
    assert!(e.to_string().starts_with("side along x over wavelength = 8.5"), "{e}");
    assert!(Westergaard.prepare(&scene(Size { x: 4.0, y: 0.7 }), 0).is_ok());
}

#[test]
fn theories_of_rough_surfaces_know_the_area_alone() {
    let rough = |size: Size| {
        let surface = SelfAffine { short_cutoff: Some(200.0), ..SelfAffine::new(2.2, size, 0.01).unwrap() };
        let mut scene = Scene::new(Surface::SelfAffine(surface), 2.0);
        scene.effects.boundary = Boundary::Periodic;
        scene
    };
    same(&Persson::default(), rough, Load::force(1e-3));
    same(&GreenwoodWilliamson::default(), rough, Load::force(1e-3));
    let free = |size: Size| Scene::new(Surface::SelfAffine(SelfAffine::new(2.2, size, 0.01).unwrap()), 2.0);
    same(&PowerLaw, free, Load::force(1e-3));
}
