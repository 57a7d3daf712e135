//! Models refuse what they do not support, and do not compute outputs that are not requested.

use analytic::{
    CattaneoMindlin, FlatPunch, GreenwoodWilliamson, Hertz, Jkr, Persson, PowerLaw, PowerLawBody, Westergaard,
};
use bem3d::Bem3d;
use contact_model::quantities::{AskedBy, QUANTITIES};
use contact_model::{
    Adhesion, AdhesionLaw, Body, Boundary, Conductance, ContactModel, Effect, Effects, Error, Friction,
    Hardness, Line, Load, Output, Outputs, Pair, Rheology, Scene, Step, Surface,
};
use mdr1d::{Equivalent, Mdr1d, PartialSlip, Viscoelastic};
use std::sync::Arc;
use tests::{map, rough};

/// Every surface, in the order of the columns below.
fn surfaces() -> [Surface; 9] {
    let line = Arc::new(Line::new(1.128, vec![0.0, 0.3, -0.2, 0.1]).unwrap());
    [
        Surface::SelfAffine(rough(2.4).unwrap()),
        Surface::Heights(Arc::new(map(5, 1.0, |x, y| ((2 * x + 3 * y) % 5) as f64).unwrap())),
        Surface::Line { line, size: 1.0.into() },
        Surface::Sphere { radius: 1.0, size: 1.0.into() },
        Surface::Cone { slope: 0.1, size: 1.0.into() },
        Surface::PowerLaw { coefficient: 0.1, exponent: 1.5, size: 1.0.into() },
        Surface::FlatCircle { radius: 0.3, size: 1.0.into() },
        Surface::Flat { size: 1.0.into() },
        Surface::Sine { amplitude: 0.1, wavelength: 0.5, size: 1.0.into() },
    ]
}

/// A model and, for each surface, whether it takes it (`x`) or only refuses its parameters (`n`).
fn models() -> Vec<(Box<dyn ContactModel>, &'static str)> {
    vec![
        //                                                                      rough map line sphere cone power circle square sine
        (Box::new(Bem3d { cells: 17, ..Bem3d::default() }), "xx-xxxxxx"),
        (Box::new(Mdr1d { elements: 256 }), "xxxxxxx--"),
        (Box::new(Hertz), "---x-----"),
        (Box::new(Jkr), "---x-----"),
        (Box::new(PowerLawBody), "---xxx---"),
        (Box::new(FlatPunch), "------xx-"),
        (Box::new(PowerLaw), "xn-------"),
    ]
}

/// Every model with every scene that it takes; the scenes request the stiffness.
fn accepted() -> Vec<(Box<dyn ContactModel>, Vec<Scene>)> {
    models()
        .into_iter()
        .map(|(model, takes)| {
            let scenes = surfaces().into_iter().zip(takes.chars()).filter(|(_, c)| *c == 'x');
            (model, scenes.map(|(surface, _)| Scene::new(surface, 1.0)).collect())
        })
        .collect()
}

fn unsupported(model: &dyn ContactModel, scene: &Scene) -> String {
    match model.prepare(scene, 0) {
        Err(Error::Unsupported { model: name, what }) => {
            assert_eq!(name, model.name());
            what.into_owned()
        }
        Err(other) => panic!("{}: {other}", model.name()),
        Ok(_) => panic!("{} takes {scene:?}", model.name()),
    }
}

#[test]
fn surfaces_are_taken_or_refused() {
    for (model, takes) in models() {
        for (surface, taken) in surfaces().into_iter().zip(takes.chars()) {
            let scene = Scene::new(surface, 1.0);
            if taken == 'x' {
                let mut contact = model.prepare(&scene, 0).unwrap();
                let state = contact.solve(Load::force(1e-3)).unwrap();
                assert!(state.approach.unwrap() > 0.0, "{} {scene:?}", model.name());
                assert!(state.stiffness.unwrap() > 0.0);
                assert!(!model.sources().is_empty());
            } else if taken == 'n' {
                assert!(matches!(model.prepare(&scene, 0), Err(Error::Domain { .. })));
            } else {
                unsupported(&*model, &scene);
            }
        }
    }
}

/// The effects that a model has for a surface.
fn has(model: &str, surface: &Surface, effect: &str) -> bool {
    let round = !matches!(surface, Surface::SelfAffine(_) | Surface::Heights(_) | Surface::Line { .. });
    match effect {
        // A range that the cells resolve.
        "boundaries" | "hardness" | "exponential" | "rheology" => model == "bem3d",
        "adhesion" => model == "bem3d" || model == "jkr" || (model == "mdr1d" && round),
        _ => false,
    }
}

/// An example of each effect, with a word of its refusal.
fn each_effect() -> [(&'static str, Effects); 6] {
    let range = Adhesion::FiniteRange { work: 1e-3, range: 0.5, law: AdhesionLaw::Exponential };
    [
        ("boundaries", Effects { boundary: Boundary::Periodic, ..Effects::default() }),
        ("adhesion", Effects { adhesion: Adhesion::ShortRange { work: 0.1 }, ..Effects::default() }),
        ("hardness", Effects { hardness: Hardness::Limit { pressure: 0.1 }, ..Effects::default() }),
        ("exponential", Effects { adhesion: range, ..Effects::default() }),
        ("friction", Effects { friction: Friction::coulomb(0.3), ..Effects::default() }),
        ("rheology", Effects { rheology: Rheology::KelvinVoigt { viscosity: 1.0 }, ..Effects::default() }),
    ]
}

/// An effect that a model lacks is refused by its name, never solved as if it were off.
#[test]
fn effects_are_refused() {
    for (model, scenes) in accepted() {
        for mut scene in scenes {
            // A viscoelastic body has none.
            scene.outputs.stiffness = false;
            for (name, effects) in each_effect() {
                if has(model.name(), &scene.surface, name) {
                    let scene = Scene { effects, ..scene.clone() };
                    assert!(model.prepare(&scene, 0).is_ok(), "{} {scene:?}", model.name());
                    continue;
                }
                let what = unsupported(&*model, &Scene { effects, ..scene.clone() });
                assert!(what.contains(name), "{}: {what}", model.name());
            }
        }
    }
}

/// Two effects at once are taken as the table of the model says: refused by the reason that stands there, prepared
/// otherwise.
#[test]
fn two_effects_together_are_as_the_table_says() {
    let body = Body::Elastic { young: 2.0, poisson: 0.3 };
    let sphere = Surface::Sphere { radius: 1.0, size: 0.5.into() };
    let scene = Scene::of_pair(sphere.clone(), Pair { first: body, second: body }).unwrap();
    let incompressible = Body::Elastic { young: 2.0, poisson: 0.5 };
    let one_body = Scene::of_pair(sphere, Pair { first: Body::Rigid, second: incompressible }).unwrap();
    let (mut refused, mut taken) = (0, 0);
    for record in fractal_contact::models::MODELS {
        let abilities = record.model.abilities();
        for (&one, &other) in
            Effect::ALL.iter().enumerate().flat_map(|(i, a)| Effect::ALL[i + 1..].iter().map(move |b| (a, b)))
        {
            let Some(effects) = one.with(other) else { continue };
            let mut scene = Scene { effects, ..scene.clone() };
            if effects.rheology != Rheology::Elastic {
                // One body is rigid, and there is no stiffness.
                if effects.friction == Friction::Off {
                    scene.pair = None;
                } else {
                    scene = Scene { effects, ..one_body.clone() };
                }
                scene.outputs.stiffness = false;
            }
            if !abilities.effects.contains(&one) || !abilities.effects.contains(&other) {
                unsupported(record.model, &scene);
                continue;
            }
            if let Some(reason) = abilities.reason_against(one, other) {
                let what = unsupported(record.model, &scene);
                assert!(what.contains("together with") && what.contains(reason), "{what}");
                refused += 1;
            } else {
                let prepared = record.model.prepare(&scene, 0).map(|_| ());
                assert!(prepared.is_ok(), "{}: {one:?} {other:?}: {prepared:?}", record.model.name());
                taken += 1;
            }
        }
    }
    // Those of the boundary elements and of equivalent profiles.
    assert!(refused >= 10 && taken >= 5, "{refused} {taken}");
}

/// Theories of periodic contact take only scenes with periodic boundaries, and no other effect; their states
/// have a mean gap and no approach.
#[test]
fn periodic_theories() {
    let mut with_cutoff = rough(2.4).unwrap();
    with_cutoff.short_cutoff = Some(32.0 * std::f64::consts::TAU);
    let random = Surface::SelfAffine(with_cutoff);
    let sine = Surface::Sine { amplitude: 0.1, wavelength: 0.5, size: 1.0.into() };
    let models: [(&dyn ContactModel, &Surface); 3] =
        [(&Persson::default(), &random), (&GreenwoodWilliamson::default(), &random), (&Westergaard, &sine)];
    for (model, surface) in models {
        let [periodic, rest @ ..] = each_effect();
        let mut scene = Scene::new(surface.clone(), 1.0);
        assert!(unsupported(model, &scene).contains("boundaries"));
        scene.effects = periodic.1;
        scene.outputs.mean_gap = true;
        for (name, mut effects) in rest {
            effects.boundary = Boundary::Periodic;
            let what = unsupported(model, &Scene { effects, ..scene.clone() });
            assert!(what.contains(name), "{}: {what}", model.name());
        }
        let [_, _, _, _, cells @ ..] = each_output();
        for outputs in cells {
            unsupported(model, &Scene { outputs, ..scene.clone() });
        }
        for other in surfaces().into_iter().filter(|other| other.kind() != surface.kind()) {
            let scene = Scene { surface: other, ..scene.clone() };
            // A map has statistics, but no wave of its own.
            if matches!(scene.surface, Surface::Heights(_)) && model.name() != "westergaard" {
                assert!(model.prepare(&scene, 0).is_ok());
                continue;
            }
            unsupported(model, &scene);
        }
        let mut contact = model.prepare(&scene, 0).unwrap();
        let state = contact.solve(Load::force(1e-3)).unwrap();
        assert!(state.approach.is_none() && state.area.is_none() && state.stiffness.unwrap() > 0.0);
        let gap = state.mean_gap.unwrap();
        let back = contact.solve(Load::mean_gap(gap)).unwrap().force;
        assert!((back / 1e-3 - 1.0).abs() < 1e-9, "{}", model.name());
        assert!(matches!(contact.solve(Load::approach(1e-3)), Err(Error::Unsupported { .. })));
    }
    // Where there is an approach there is no mean gap.
    for (model, scenes) in accepted() {
        for scene in scenes {
            let mut gap = scene.clone();
            gap.outputs.mean_gap = true;
            assert!(matches!(model.prepare(&gap, 0), Err(Error::Unsupported { .. })));
            let mut contact = model.prepare(&scene, 0).unwrap();
            assert!(matches!(contact.solve(Load::mean_gap(1e-3)), Err(Error::Unsupported { .. })));
        }
    }
}

/// Models of paths have one effect at a time; they refuse scenes without it and scenes with another effect.
#[test]
fn histories() {
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 0.75, poisson: 0.5 } };
    let cells = Equivalent::new(Bem3d { cells: 9, ..Bem3d::default() });
    let springs = Equivalent::new(Mdr1d { elements: 64 });
    let models: [(&dyn ContactModel, &[&str], &str); 5] = [
        //                            rough map line sphere cone power circle square sine
        (&CattaneoMindlin, &["friction"], "---x-----"),
        (&PartialSlip, &["friction"], "---xxxx--"),
        (&Viscoelastic, &["rheology"], "---xxxx--"),
        // What their models press.
        (&cells, &["friction", "rheology"], "xx-xxxxxx"),
        (&springs, &["friction", "rheology"], "xxxxxxx--"),
    ];
    for (model, own, takes) in models {
        let refused = |scene: &Scene| matches!(model.prepare(scene, 0), Err(Error::Unsupported { .. }));
        for (surface, taken) in surfaces().into_iter().zip(takes.chars()) {
            for (name, effects) in each_effect() {
                let mut scene = Scene { effects, ..Scene::of_pair(surface.clone(), pair).unwrap() };
                scene.outputs = Outputs::default();
                if !own.contains(&name) || taken == '-' {
                    assert!(refused(&scene), "{} {name} {scene:?}", model.name());
                    continue;
                }
                assert!(refused(&Scene { effects: Effects::default(), ..scene.clone() }));
                let mut both = scene.clone();
                both.effects.boundary = Boundary::Periodic;
                assert!(refused(&both));
                let mut contact = model.prepare(&scene, 0).unwrap();
                let state = contact.advance(Step::new(1.0, Load::force(1e-3))).unwrap();
                assert!(state.stiffness.is_none() && state.area.is_none());
                assert!(state.contact_radius.unwrap() > 0.0 && !model.sources().is_empty());
                assert_eq!(state.tangential.is_some(), name == "friction");
            }
        }
    }
}

const COPPER: Conductance = Conductance::Electrical { first: 1.7e-8, second: 1.7e-8 };

/// The outputs that every model has, those that only some have, and those that need cells, one at a time.
fn each_output() -> [Outputs; 8] {
    let none = Outputs::default();
    [
        Outputs { stiffness: true, ..none },
        Outputs { stiffness_fixed_area: true, ..none },
        Outputs { conductance: COPPER, ..none },
        Outputs { area: true, ..none },
        Outputs { contact_patches: true, ..none },
        Outputs { pressure: true, ..none },
        Outputs { displacement: true, ..none },
        Outputs { gap: true, ..none },
    ]
}

/// Checks that a model computes exactly the requested outputs or refuses them, with and without load.
#[test]
fn only_requested_outputs_are_computed() {
    for (model, scenes) in accepted() {
        for scene in scenes {
            for outputs in [Outputs::default()].into_iter().chain(each_output()) {
                let scene = Scene { outputs, ..scene.clone() };
                let place = format!("{} {scene:?}", model.name());
                let mut contact = match model.prepare(&scene, 0) {
                    Ok(contact) => contact,
                    Err(Error::Unsupported { .. }) => {
                        assert!(outputs.area || outputs.contact_patches || outputs.any_field(), "{place}");
                        assert_ne!(model.name(), "bem3d", "{place}");
                        continue;
                    }
                    Err(other) => panic!("{place}: {other}"),
                };
                for load in [Load::force(1e-3), Load::force(0.0)] {
                    let state = contact.solve(load).unwrap();
                    let normalisation = contact.normalisation();
                    let told = |output: &Output| {
                        let field =
                            state.fields.as_ref().is_some_and(|fields| !fields.get(*output).is_empty());
                        let mut of_it = QUANTITIES.iter().filter(|q| q.asked_by == AskedBy::Output(*output));
                        field || of_it.any(|quantity| quantity.number(&state, &normalisation).is_some())
                    };
                    let given: Vec<Output> = Output::ALL.iter().copied().filter(told).collect();
                    assert_eq!(given, outputs.asked().collect::<Vec<_>>(), "{place} {load:?}");
                }
            }
        }
    }
}

/// A line has no area and closed forms have no cells.
#[test]
fn which_outputs_are_refused() {
    let [_, _, _, area, cells @ ..] = each_output();
    for (model, scenes) in accepted().into_iter().filter(|(model, _)| model.name() != "bem3d") {
        for scene in scenes {
            for outputs in cells {
                unsupported(&*model, &Scene { outputs, ..scene.clone() });
            }
            if matches!(scene.surface, Surface::SelfAffine(_) | Surface::Line { .. }) {
                unsupported(&*model, &Scene { outputs: area, ..scene.clone() });
            }
        }
    }
}
