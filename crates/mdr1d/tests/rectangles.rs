//! Lines and profiles that stand for rectangles: `L = sqrt(Lx Ly)`, and a round contact may reach half the
//! shorter side.

#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;
use contact_model::{
    Body, ContactModel, Error, Friction, HeightMap, Line, Load, Pair, Rheology, Scene, SelfAffine, Size,
    Step, Surface, Tangential,
};
use mdr1d::{Ensemble, Equivalent, Mdr1d, PartialSlip, Viscoelastic};
use std::sync::Arc;

const RECTANGLE: Size = Size { x: 4.0, y: 1.0 };
const SQUARE: Size = Size { x: 2.0, y: 2.0 };

fn sphere(size: Size) -> Surface {
    Surface::Sphere { radius: 1.0, size }
}

#[test]
fn a_line_stands_for_the_area() {
    let model = Mdr1d { elements: 500 };
    let surface = |size| SelfAffine::new(2.4, size, 0.02).unwrap();
    let solve = |surface, load| {
        let mut contact = model.prepare(&Scene::new(surface, 3.0), 7).unwrap();
        (contact.normalisation(), contact.solve(load).unwrap())
    };
    for load in [Load::force(1e-3), Load::approach(0.05)] {
        let (scales, state) = solve(Surface::SelfAffine(surface(RECTANGLE)), load);
        let (of_square, square) = solve(Surface::SelfAffine(surface(SQUARE)), load);
        assert_eq!((scales, &state), (of_square, &square));
        assert_relative_eq!(scales.length, 2.0);
        let ensemble = Ensemble::new(&surface(RECTANGLE), 500).unwrap();
        let scene = Scene::new(Surface::SelfAffine(surface(RECTANGLE)), 3.0);
        assert_eq!(ensemble.prepare(&scene, 7).unwrap().solve(load).unwrap(), state);
        let line = Arc::new(surface_gen::self_affine_line(&surface(RECTANGLE), 500, 7).unwrap());
        assert_eq!(solve(Surface::Line { line, size: RECTANGLE }, load), (scales, state));
    }
}

#[test]
fn round_bodies_do_not_see_the_rectangle_until_they_leave_it() {
    let model = Mdr1d::default();
    let press = |surface: &Surface, d: f64| {
        model.prepare(&Scene::new(surface.clone(), 3.0), 0).and_then(|mut it| it.solve(Load::approach(d)))
    };
    let cone = |size| Surface::Cone { slope: 0.3, size };
    // The radius is sqrt(d) for the sphere, 2 d / (0.3 pi) for the cone: 0.45 and 0.55.
    for (body, inside, outside) in
        [(&sphere as &dyn Fn(Size) -> Surface, 0.2025, 0.3025), (&cone, 0.212, 0.26)]
    {
        let [one, other] = [RECTANGLE, SQUARE].map(|size| press(&body(size), inside).unwrap());
        assert_relative_eq!(one.force, other.force, max_relative = 1e-14);
        assert_relative_eq!(one.stiffness.unwrap(), other.stiffness.unwrap(), max_relative = 1e-14);
        assert!(press(&body(SQUARE), outside).is_ok());
        match press(&body(RECTANGLE), outside) {
            Err(Error::OutOfRange { max, .. }) => assert_relative_eq!(max, 0.5),
            other => panic!("{other:?}"),
        }
    }
    let punch = Surface::FlatCircle { radius: 0.6, size: RECTANGLE };
    assert!(matches!(press(&punch, 0.1), Err(Error::OutOfRange { .. })));
}

#[test]
fn histories_leave_the_shorter_side_too() {
    let step = |d| Step::new(0.0, Load::approach(d).with_tangential(Tangential::force_along_x(0.0)));
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 1.0, poisson: 0.3 } };
    let mut slides = Scene::of_pair(sphere(RECTANGLE), pair).unwrap();
    slides.effects.friction = Friction::coulomb(0.3);
    let mut creeps = Scene::new(sphere(RECTANGLE), 1.0);
    creeps.effects.rheology = Rheology::Maxwell { viscosity: 2.0 };
    creeps.outputs.stiffness = false;
    let equivalent = Equivalent::new(Mdr1d::default());
    let models: [(&dyn ContactModel, &Scene); 3] =
        [(&PartialSlip, &slides), (&Viscoelastic, &creeps), (&equivalent, &slides)];
    for (model, scene) in models {
        let mut history = model.prepare(scene, 0).unwrap();
        assert_relative_eq!(history.normalisation().length, 2.0);
        assert!(history.advance(step(0.2)).is_ok(), "{}", model.name());
        let mut history = model.prepare(scene, 0).unwrap();
        let e = history.advance(step(0.36)).unwrap_err();
        assert!(
            matches!(e, Error::OutOfRange { max, .. } if (max - 0.5).abs() < 1e-14),
            "{}: {e}",
            model.name()
        );
    }
}

#[test]
fn maps_with_undefined_points_and_negative_sides_are_refused() {
    let map = HeightMap::with_undefined([2, 1], [2.0, 1.0], vec![f64::NAN, 0.0]).unwrap();
    let scene = Scene::new(Surface::Heights(map.into()), 1.0);
    assert!(matches!(Mdr1d::default().prepare(&scene, 0), Err(Error::Domain { .. })));
    let line = Arc::new(Line::new(2.0, vec![0.0, 1.0]).unwrap());
    let negative = Surface::Line { line, size: Size { x: 1.0, y: -1.0 } };
    assert!(matches!(Mdr1d::default().prepare(&Scene::new(negative, 1.0), 0), Err(Error::Domain { .. })));
}
