use super::*;
use approx::assert_relative_eq;
use contact_model::{
    Adhesion, Boundary, Conductance, Effects, HeightMap, Load, Nondimensionalisation, NormalLoad,
    PreparedContact, SelfAffine, line_length,
};
use std::sync::Arc;

/// Rounding of a root and a handful of products.
const ROUNDING: f64 = 1e-14;

fn scene(surface: Surface) -> Scene {
    Scene::new(surface, 2.0)
}

fn asking_for_area(surface: Surface) -> Scene {
    let mut scene = scene(surface);
    scene.outputs.area = true;
    scene
}

fn rough(fractal_dimension: f64) -> Surface {
    Surface::SelfAffine(SelfAffine::new(fractal_dimension, 3.0, 0.1).unwrap())
}

fn prepare(scene: &Scene, seed: u64) -> Box<dyn PreparedContact> {
    Mdr1d { elements: 1 << 12 }.prepare(scene, seed).unwrap()
}

#[test]
fn a_rough_line_claims_force_approach_and_stiffness() {
    let mut contact = prepare(&scene(rough(2.4)), 1);
    let normalisation = contact.normalisation();
    assert_relative_eq!(normalisation.rms_height().unwrap(), 0.1, max_relative = 1e-12);
    let s = contact.solve(Load::force(normalisation.force(0.086).unwrap())).unwrap();
    assert!(s.area.is_none() && s.fields.is_none() && s.approach.is_some());
    let cells = s.report.contact_cells.unwrap();
    assert!(cells > 10 && cells < 1 << 12);
    assert_relative_eq!(
        s.stiffness.unwrap(),
        2.0 * line_length(3.0) * cells as f64 / 4096.0,
        max_relative = ROUNDING
    );
    // The plateau of the paper's Eq. 18: k_bar = 1.128379 / 1.1419.
    let s = contact.solve(Load::force(normalisation.force(1e3).unwrap())).unwrap();
    assert_relative_eq!(normalisation.stiffness_bar(s.stiffness.unwrap()), 0.988_159, max_relative = 1e-6);
}

#[test]
fn seeds_matter_and_a_given_line_is_the_same() {
    let surface = SelfAffine::new(2.2, 1.0, 1.0).unwrap();
    let drawn = scene(Surface::SelfAffine(surface));
    let load = Load::force(0.01);
    let first = prepare(&drawn, 1).solve(load).unwrap();
    assert_eq!(first, prepare(&drawn, 1).solve(load).unwrap());
    assert_ne!(first, prepare(&drawn, 2).solve(load).unwrap());
    let line = Arc::new(surface_gen::self_affine_line(&surface, 1 << 12, 1).unwrap());
    let given = scene(Surface::Line { line, size: 1.0.into() });
    assert_eq!(first, prepare(&given, 99).solve(load).unwrap());
}

#[test]
fn what_is_not_asked_is_not_there() {
    let mut silent = scene(rough(2.0));
    silent.outputs.stiffness = false;
    assert!(prepare(&silent, 0).solve(Load::force(1.0)).unwrap().stiffness.is_none());
    let sphere = scene(Surface::Sphere { radius: 1.0, size: 1.0.into() });
    assert!(prepare(&sphere, 0).solve(Load::force(1e-3)).unwrap().area.is_none());
}

#[test]
fn bodies_in_three_dimensions() {
    let (contact_modulus, side) = (2.0, 1.0);
    for surface in [
        Surface::Sphere { radius: 3.0, size: side.into() },
        Surface::Cone { slope: 0.2, size: side.into() },
        Surface::PowerLaw { coefficient: 0.7, exponent: 0.6, size: side.into() },
        Surface::FlatCircle { radius: 0.2, size: side.into() },
    ] {
        let mut contact = prepare(&asking_for_area(surface), 0);
        assert!(contact.normalisation().height.is_none());
        let s = contact.solve(Load::force(1e-3)).unwrap();
        let radius = s.stiffness.unwrap() / (2.0 * contact_modulus);
        assert_relative_eq!(s.area.unwrap(), std::f64::consts::PI * radius * radius, max_relative = ROUNDING);
        let back = contact.solve(Load::approach(s.approach.unwrap())).unwrap();
        assert_relative_eq!(back.force, 1e-3, max_relative = ROUNDING);
        let zero = contact.solve(Load::approach(0.0)).unwrap();
        assert!(zero.force <= 0.0 && zero.stiffness.unwrap() <= 0.0 && zero.area.unwrap() <= 0.0);
    }
}

#[test]
fn hertz_in_any_units() {
    // F = 1e-3 E* R^2 is a = 0.090856 R, whatever E* and R are.
    for (contact_modulus, radius) in [(1.0, 1.0), (1e150, 1e-150), (1e-150, 1e150), (1e11, 1e-3)] {
        let scene = Scene::new(Surface::Sphere { radius, size: radius.into() }, contact_modulus);
        let force = Nondimensionalisation::new(contact_modulus, radius, radius).unwrap().force(1e-3).unwrap();
        let s = prepare(&scene, 0).solve(Load::force(force)).unwrap();
        assert_relative_eq!(
            s.stiffness.unwrap() / contact_modulus / radius,
            2.0 * 0.090_856_029_642,
            max_relative = 1e-10
        );
        assert_relative_eq!(s.approach.unwrap() / radius, 0.008_254_818_122, max_relative = 1e-9);
    }
}

#[test]
fn a_contact_that_leaves_the_square_is_refused() {
    let mut contact = prepare(&scene(Surface::Sphere { radius: 1.0, size: 1.0.into() }), 0);
    assert!(contact.solve(Load::approach(0.25)).is_ok());
    let e = contact.solve(Load::approach(0.36)).unwrap_err();
    assert!(matches!(e, Error::OutOfRange { value, max, .. } if value > 0.59 && max < 0.51), "{e}");
    assert!(contact.solve(Load::approach(-1.0)).is_err());
    assert!(contact.solve(Load::force(f64::INFINITY)).is_err());
}

#[test]
fn what_the_model_lacks_is_refused() {
    let model = Mdr1d::default();
    let refused = |scene: &Scene| matches!(model.prepare(scene, 0), Err(Error::Unsupported { .. }));
    assert!(refused(&asking_for_area(rough(2.0))));
    assert!(refused(&scene(Surface::Flat { size: 1.0.into() })));
    assert!(refused(&scene(Surface::Sine { amplitude: 0.1, wavelength: 1.0, size: 1.0.into() })));
    let rough_map = HeightMap::from_fn(8, 1.0, |x, y| ((3 * x + 5 * y) % 7) as f64).unwrap();
    assert!(refused(&asking_for_area(Surface::Heights(Arc::new(rough_map)))));
    let map = Arc::new(HeightMap::new(2, 1.0, vec![0.0; 4]).unwrap());
    let flat = model.prepare(&scene(Surface::Heights(map)), 0).map(|_| ()).unwrap_err();
    assert!(flat.to_string().starts_with("rms height of the map = 0"), "{flat}");
    for effects in [
        Effects { boundary: Boundary::Periodic, ..Effects::default() },
        Effects { adhesion: Adhesion::ShortRange { work: 0.1 }, ..Effects::default() },
    ] {
        assert!(refused(&Scene { effects, ..scene(rough(2.0)) }));
    }
    for field in 0..3 {
        let mut scene = scene(Surface::Sphere { radius: 1.0, size: 1.0.into() });
        scene.outputs.pressure = field == 0;
        scene.outputs.displacement = field == 1;
        scene.outputs.gap = field == 2;
        assert!(refused(&scene));
    }
    assert!(Mdr1d { elements: 0 }.prepare(&scene(rough(2.0)), 0).is_err());
    let mut stopped = prepare(&scene(rough(2.0)), 0);
    assert!(matches!(stopped.solve_until(Load::force(1.0), &|| true), Err(Error::Stopped { best: None })));
}

#[test]
fn an_ensemble_gives_the_same_bits_with_memory_used_before() {
    let surface = SelfAffine::new(2.4, 1.0, 1.0).unwrap();
    let ensemble = Ensemble::new(&surface, 4097).unwrap();
    let scene = Scene::new(Surface::SelfAffine(surface), 2.0);
    for seed in 0..4 {
        let mut kept = ensemble.prepare(&scene, seed).unwrap();
        let mut fresh = Mdr1d { elements: 4097 }.prepare(&scene, seed).unwrap();
        for force in [1e-6, 1e-2, 3.0] {
            let [a, b] = [&mut kept, &mut fresh].map(|c| c.solve(Load::force(force)).unwrap());
            assert_eq!((a.approach, a.stiffness), (b.approach, b.stiffness));
        }
        assert_eq!(kept.normalisation(), fresh.normalisation());
    }
    // Another surface is none of its own, and an area is refused as ever.
    let other = Scene::new(Surface::SelfAffine(SelfAffine::new(2.0, 1.0, 1.0).unwrap()), 2.0);
    assert!(ensemble.prepare(&other, 1).is_ok());
    let mut area = scene;
    area.outputs.area = true;
    assert!(ensemble.prepare(&area, 1).is_err());
}

#[test]
fn adhesion_of_a_sphere_behind_the_trait() {
    // data/paper/VALUES.md: E* = R = 1, w = 0.01. In other units too.
    for (contact_modulus, length) in [(1.0, 1.0), (1e150, 1e-150), (1e-150, 1e150), (1e11, 1e-3)] {
        let mut scene =
            Scene::new(Surface::Sphere { radius: length, size: (2.0 * length).into() }, contact_modulus);
        scene.effects.adhesion = Adhesion::ShortRange { work: 0.01 * (contact_modulus * length) };
        scene.outputs.stiffness_fixed_area = true;
        let mut contact = prepare(&scene, 0);
        let s = contact.solve(Load::force(0.0)).unwrap();
        // Of the held area 2 E* a, along the branch 3/5 of it.
        let [held, along] =
            [s.stiffness_fixed_area, s.stiffness].map(|k| k.unwrap() / contact_modulus / length);
        assert_relative_eq!(held, 2.0 * 0.520_939_707_9, max_relative = 1e-9);
        assert_relative_eq!(along, 1.2 * 0.520_939_707_9, max_relative = 1e-9);
        let nondimensional = Nondimensionalisation::new(contact_modulus, length, length).unwrap();
        let pull_off = -nondimensional.force(0.015 * std::f64::consts::PI).unwrap();
        assert!(contact.solve(Load::force(0.999 * pull_off)).is_ok());
        let e = contact.solve(Load::force(1.001 * pull_off)).unwrap_err();
        let Error::OutOfRange { min, ref name, .. } = e else { panic!("{e}") };
        assert!(name.contains("pulls off"));
        assert_relative_eq!(min, pull_off, max_relative = 1e-13);
        assert!(contact.solve(Load::approach(-length)).is_err());
    }
}

/// dF/dd of a state is that of its neighbours, and its stiffness at fixed contact area is 2 E* a; the
/// conductance follows from the latter.
#[test]
fn the_stiffness_of_an_adhesive_body_is_the_slope_of_its_branch() {
    /// Relative step of loads; the error of a central difference is its square times third derivatives, which
    /// grow towards a fold.
    const STEP: f64 = 1e-5;
    const DIFFERENCES: f64 = 1e-6;
    let size = 20.0.into();
    let mut bodies: Vec<Surface> = [0.6, 0.8, 1.0, 1.5, 2.0, 3.7]
        .map(|exponent| Surface::PowerLaw { coefficient: 0.3, exponent, size })
        .into();
    bodies.push(Surface::Sphere { radius: 2.0, size });
    bodies.push(Surface::Cone { slope: 0.2, size });
    for surface in bodies {
        let mut scene = asking_for_area(surface.clone());
        scene.effects.adhesion = Adhesion::ShortRange { work: 1e-3 };
        scene.outputs.stiffness_fixed_area = true;
        scene.outputs.conductance = Conductance::Electrical { first: 1.0, second: 3.0 };
        let mut contact = prepare(&scene, 0);
        let mut pull_off = |load: Load| match contact.solve(load) {
            Err(Error::OutOfRange { min, .. }) => min,
            other => panic!("{other:?}"),
        };
        let by_force = pull_off(Load::force(-1e3));
        let by_approach = pull_off(Load::approach(-1e3));
        let shares = [-0.95, -0.5, -0.1, 0.2, 3.0];
        let forces = shares.map(|share| Load::force(share * by_force.abs()));
        let approaches = shares.map(|share| Load::approach(share * by_approach.abs()));
        for load in forces.into_iter().chain(approaches) {
            let here = contact.solve(load).unwrap();
            let mut at = |by: f64| match load.normal {
                NormalLoad::Force(force) => contact.solve(Load::force(by * force)).unwrap(),
                NormalLoad::Approach(approach) => contact.solve(Load::approach(by * approach)).unwrap(),
                other => panic!("{other:?}"),
            };
            let (low, high) = (at(1.0 - STEP), at(1.0 + STEP));
            let slope = (high.force - low.force) / (high.approach.unwrap() - low.approach.unwrap());
            let held = 2.0 * scene.contact_modulus * (here.area.unwrap() / std::f64::consts::PI).sqrt();
            let unit = slope.abs().max(held);
            assert!((here.stiffness.unwrap() - slope).abs() < DIFFERENCES * unit, "{surface:?} {load:?}");
            assert_relative_eq!(here.stiffness_fixed_area.unwrap(), held, max_relative = ROUNDING);
            let conductance = scene.outputs.conductance.of(held, scene.contact_modulus).unwrap().unwrap();
            assert_relative_eq!(here.conductance.unwrap(), conductance, max_relative = ROUNDING);
        }
        let fold = contact.solve(Load::force(by_force)).unwrap();
        let ratio = fold.stiffness.unwrap() / fold.stiffness_fixed_area.unwrap();
        assert!(ratio.abs() < 1e-6, "{surface:?} {ratio}");
        let fold = contact.solve(Load::approach(by_approach)).unwrap();
        assert!(fold.stiffness.is_none() && fold.stiffness_fixed_area.unwrap() > 0.0, "{surface:?}");
        // Between the two pull-offs the force falls with the approach.
        let drawn = contact.solve(Load::approach(0.99 * by_approach)).unwrap();
        assert!(drawn.stiffness.unwrap() < 0.0, "{surface:?}");
    }
}

#[test]
fn the_edge_of_an_adhesive_punch_stays_where_it_is() {
    let mut scene = scene(Surface::FlatCircle { radius: 0.1, size: 1.0.into() });
    scene.effects.adhesion = Adhesion::ShortRange { work: 1e-3 };
    scene.outputs.stiffness_fixed_area = true;
    for load in [Load::force(-1e-4), Load::force(1e-3), Load::approach(-1e-4)] {
        let state = prepare(&scene, 0).solve(load).unwrap();
        assert_relative_eq!(state.stiffness.unwrap(), 0.4, max_relative = ROUNDING);
        assert_eq!(state.stiffness, state.stiffness_fixed_area);
    }
}

#[test]
fn adhesion_where_the_rule_has_no_radius_is_refused() {
    let effects = Effects { adhesion: Adhesion::ShortRange { work: 0.1 }, ..Effects::default() };
    let refusal = |surface| {
        let scene = Scene { effects, ..scene(surface) };
        Mdr1d::default().prepare(&scene, 0).map(|_| ()).unwrap_err().to_string()
    };
    let line = Arc::new(Line::new(1.0, vec![0.0, 0.1]).unwrap());
    let map = Arc::new(HeightMap::new(2, 1.0, vec![0.0; 4]).unwrap());
    for surface in [rough(2.2), Surface::Line { line, size: 1.0.into() }, Surface::Heights(map)] {
        let text = refusal(surface);
        assert!(text.contains("adhesion") && text.contains("round contact"), "{text}");
    }
    assert!(
        refusal(Surface::PowerLaw { coefficient: 1.0, exponent: 0.5, size: 1.0.into() }).contains("exponent")
    );
}

/// A map has a line of its own: the rms height of the map, another line for another seed, and the plateau of
/// Eq. 18.
#[test]
fn a_map_is_pressed_through_its_line() {
    let surface = SelfAffine::new(2.3, [2.0, 1.0], 0.01).unwrap();
    let map = Arc::new(surface_gen::self_affine_map(&surface, [128, 64], 1).unwrap());
    let model = Mdr1d { elements: 4096 };
    let on_map = scene(Surface::Heights(map));
    let mut contacts = [1, 1, 2].map(|seed| model.prepare(&on_map, seed).unwrap());
    let normalisation = contacts[0].normalisation();
    assert_relative_eq!(normalisation.height.unwrap(), 0.01, max_relative = 1e-11);
    assert_relative_eq!(normalisation.length, 2.0_f64.sqrt());
    let force = normalisation.force(0.01).unwrap();
    let [one, same, other] =
        contacts.each_mut().map(|c| c.solve(Load::force(force)).unwrap().stiffness.unwrap());
    assert!(one.to_bits() == same.to_bits() && one.to_bits() != other.to_bits());
    let full = contacts[0].solve(Load::force(normalisation.force(1e3).unwrap())).unwrap();
    let plateau = crate::rule::full_contact_stiffness(on_map.contact_modulus, normalisation.length);
    assert_relative_eq!(full.stiffness.unwrap(), plateau, max_relative = 1e-12);
}
