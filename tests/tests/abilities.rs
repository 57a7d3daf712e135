//! The declared abilities of the models are correct: each ability is tried, and everything else is refused.

use contact_model::quantities::{AskedBy, QUANTITIES, Role, StateQuantity};
use contact_model::{
    Adhesion, Body, Boundary, Conductance, ContactModel, ContactState, Effect, Effects, Error, Friction,
    HeightMap, LargestPull, Line, Load, LoadKind, Output, Pair, Paths, PreparedContact, Rheology, Scene,
    SelfAffine, Step, Surface, SurfaceKind, Tangential, Value,
};
use fractal_contact::models::MODELS;
use std::collections::BTreeSet;
use std::sync::Arc;

fn surface(kind: SurfaceKind) -> Surface {
    let size = 2.0.into();
    let wave = |ix: usize, iy: usize| 0.01 * (((7 * ix + 3 * iy) % 16) as f64).sin();
    match kind {
        SurfaceKind::SelfAffine => {
            let mut rough = SelfAffine::new(2.2, size, 0.01).unwrap();
            rough.roll_off = Some(12.0);
            rough.short_cutoff = Some(30.0);
            Surface::SelfAffine(rough)
        }
        SurfaceKind::Heights => {
            let map = surface_gen::height_map(&surface(SurfaceKind::SelfAffine), 33, 1).unwrap();
            Surface::Heights(map)
        }
        SurfaceKind::Profile => {
            Surface::Profile(Arc::new(HeightMap::from_fn([64, 1], [2.0, 0.1], wave).unwrap()))
        }
        SurfaceKind::Line => {
            let line = Line::new(2.0, (0..64).map(|i| 0.01 * f64::from(i).sin()).collect()).unwrap();
            Surface::Line { line: Arc::new(line), size }
        }
        SurfaceKind::Sphere => Surface::Sphere { radius: 1.0, size },
        SurfaceKind::Cone => Surface::Cone { slope: 0.1, size },
        SurfaceKind::PowerLaw => Surface::PowerLaw { coefficient: 0.5, exponent: 3.0, size },
        SurfaceKind::FlatCircle => Surface::FlatCircle { radius: 0.5, size },
        SurfaceKind::Flat => Surface::Flat { size },
        SurfaceKind::Sine => Surface::Sine { amplitude: 0.01, wavelength: 1.0, size },
        other => panic!("a surface of the kind {other:?} for this test"),
    }
}

fn with_effect(mut scene: Scene, effect: Option<Effect>) -> Scene {
    if let Some(effect) = effect {
        scene.effects = Effects { boundary: scene.effects.boundary, ..effect.example() };
    }
    scene
}

/// A scene of one surface, boundary and effect, without outputs.
fn scene(kind: SurfaceKind, boundary: Boundary, effect: Option<Effect>) -> Scene {
    let body = Body::Elastic { young: 1.5, poisson: 0.5 };
    let rigid = effect.is_some_and(|effect| effect.key() == "rheology");
    let pair = Pair { first: if rigid { Body::Rigid } else { body }, second: body };
    let mut scene = Scene::of_pair(surface(kind), pair).unwrap();
    if effect.is_none_or(|effect| effect.key() != "friction") {
        scene.pair = None;
    }
    scene.outputs.stiffness = false;
    scene.effects.boundary = boundary;
    with_effect(scene, effect)
}

fn ask(scene: &mut Scene, output: Output) {
    if output == Output::Conductance {
        scene.outputs.conductance = Conductance::Electrical { first: 1.0, second: 1.0 };
    } else {
        scene.outputs.ask(output, true);
    }
}

/// The model on a small grid.
fn prepared(model: &dyn ContactModel, scene: &Scene) -> Result<Box<dyn PreparedContact>, Error> {
    match model.name() {
        "bem3d" => bem3d::Bem3d { cells: 33, ..bem3d::Bem3d::default() }.prepare(scene, 1),
        "equivalent" => {
            let press = bem3d::Bem3d { cells: 33, ..bem3d::Bem3d::default() };
            mdr1d::Equivalent::new(press).prepare(scene, 1)
        }
        // The spectrum of the paper goes to the end of the grid.
        "power_law" => {
            let mut scene = scene.clone();
            let paper = Surface::SelfAffine(SelfAffine::new(2.2, 2.0, 0.01).unwrap());
            scene.surface = match scene.surface {
                Surface::SelfAffine(_) => paper,
                Surface::Heights(_) => Surface::Heights(surface_gen::height_map(&paper, 129, 1).unwrap()),
                other => other,
            };
            model.prepare(&scene, 1)
        }
        "mdr1d" => mdr1d::Mdr1d { elements: 1 << 10 }.prepare(scene, 1),
        _ => model.prepare(scene, 1),
    }
}

/// A state under a light load.
fn pressed(contact: &mut dyn PreparedContact, scene: &Scene) -> Result<ContactState, Error> {
    let normal = Load::force(0.001);
    let needs_path = scene.effects.named().any(|effect| ["friction", "rheology"].contains(&effect.key()));
    if !needs_path {
        return contact.solve(normal);
    }
    // A dashpot in parallel takes no load in no time.
    contact.advance(Step::new(0.5, normal))?;
    let friction = scene.effects.friction != Friction::Off;
    let tangential = if friction { Tangential::force_along_x(1e-4) } else { Tangential::default() };
    contact.advance(Step::new(1.0, normal.with_tangential(tangential)))
}

/// Every scene that its abilities name, with one surface, boundary and effect each.
fn declared(model: &dyn ContactModel) -> impl Iterator<Item = Scene> {
    let abilities = model.abilities();
    let effects = || abilities.effects.iter().copied().map(Some).chain([None]);
    let boundaries = abilities.boundaries.iter().copied();
    abilities.surfaces.iter().flat_map(move |&kind| {
        boundaries
            .clone()
            .flat_map(move |boundary| effects().map(move |effect| scene(kind, boundary, effect)))
    })
}

/// A scene of friction between bodies that relax, of a model that declares both effects.
fn friction_that_relaxes(model: &dyn ContactModel) -> Option<Scene> {
    let abilities = model.abilities();
    let effect = |key: &str| abilities.effects.iter().copied().find(|effect| effect.key() == key);
    let (friction, rheology) = effect("friction").zip(effect("rheology"))?;
    let mut scene = scene(abilities.surfaces[0], abilities.boundaries[0], Some(rheology));
    scene.effects.friction = friction.example().friction;
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 1.5, poisson: 0.5 } };
    scene.pair = Some(pair);
    Some(scene)
}

/// Names of the quantities that a model reports for some state of the scenes that it declares.
pub fn told(model: &dyn ContactModel) -> BTreeSet<&'static str> {
    let mut told = BTreeSet::new();
    for mut scene in declared(model).chain(friction_that_relaxes(model)) {
        let outputs = model.abilities().outputs;
        let rheology = scene.effects.rheology != Rheology::Elastic;
        for &output in outputs {
            // Those that the scene itself excludes.
            let mut more = scene.clone();
            ask(&mut more, output);
            let relaxing = rheology
                && matches!(output, Output::Stiffness | Output::StiffnessFixedArea | Output::Pressure);
            if !relaxing && prepared(model, &more).is_ok() {
                scene = more;
            }
        }
        let Ok(mut contact) = prepared(model, &scene) else { continue };
        let Ok(state) = pressed(contact.as_mut(), &scene) else { continue };
        let normalisation = contact.normalisation();
        let has = |quantity: &&StateQuantity| (quantity.value)(&state, &normalisation) != Value::Empty;
        told.extend(QUANTITIES.iter().filter(has).map(|quantity| quantity.name));
        if model.abilities().paths != Paths::Forgotten {
            let step = Step::new(2.0, Load::force(0.001));
            let state = contact.advance(step);
            told.extend(state.is_ok_and(|state| state.time.is_some()).then_some("time"));
        }
        if scene.effects.adhesion != Adhesion::Off && model.abilities().paths != Paths::Forgotten {
            // Pressed, pulled, and pulled by more than it holds.
            contact.restart();
            let mut largest = LargestPull::default();
            for force in [1e-3, -1e-9, -1e3] {
                let load = Load::force(force);
                let reached = contact.advance(Step::new(0.0, load)).or_else(Error::into_best);
                let Ok(state) = reached.map(|state| largest.enter(load.normal, state)) else { break };
                let has = |quantity: &&StateQuantity| {
                    quantity.role == Role::OfPath && (quantity.value)(&state, &normalisation) != Value::Empty
                };
                told.extend(QUANTITIES.iter().filter(has).map(|quantity| quantity.name));
            }
        }
        // An error of the force is known where a distance is prescribed.
        if contact
            .solve(Load::approach(1e-4))
            .is_ok_and(|state| state.report.certificate.force_error.is_some())
        {
            told.insert("force_error");
        }
    }
    told
}

/// Each surface, boundary, effect and output that a model declares is part of a scene that it solves, and the
/// state has the requested outputs.
#[test]
fn declared_abilities_are_provided() {
    for record in MODELS {
        let (model, name) = (record.model, record.name());
        let abilities = model.abilities();
        let answers = |wanted: &dyn Fn(&Scene) -> bool| {
            declared(model).filter(|scene| wanted(scene)).any(|scene| {
                prepared(model, &scene).and_then(|mut contact| pressed(contact.as_mut(), &scene)).is_ok()
            })
        };
        for &kind in abilities.surfaces {
            assert!(answers(&|scene| SurfaceKind::of(&scene.surface) == kind), "{name}: {kind:?}");
        }
        for &boundary in abilities.boundaries {
            assert!(answers(&|scene| scene.effects.boundary == boundary), "{name}: {boundary:?}");
        }
        for &effect in abilities.effects {
            assert!(
                answers(&|scene| scene.effects.named().any(|named| named == effect)),
                "{name}: {effect:?}"
            );
        }
        for &output in abilities.outputs {
            let tells = declared(model).any(|mut scene| {
                ask(&mut scene, output);
                let Ok(mut contact) = prepared(model, &scene) else { return false };
                let Ok(state) = pressed(contact.as_mut(), &scene) else { return false };
                let normalisation = contact.normalisation();
                let mut told =
                    QUANTITIES.iter().filter(|quantity| quantity.asked_by == AskedBy::Output(output));
                if output.is_field() {
                    return state.fields.as_ref().is_some_and(|fields| !fields.get(output).is_empty());
                }
                assert!(told.clone().next().is_some(), "{}: the table has no quantity of it", output.name());
                // A closed form has no cells whose boundary could be corrected.
                told.all(|quantity| {
                    quantity.name == "area_corrected" || quantity.number(&state, &normalisation).is_some()
                })
            });
            assert!(tells, "{name}: nothing is told of `{}`, which it declares", output.name());
        }
    }
}

/// An effect that a model declares changes some state in comparison with the same contact without it.
#[test]
fn declared_effects_change_the_state() {
    for record in MODELS {
        let (model, abilities) = (record.model, record.model.abilities());
        for &effect in abilities.effects {
            let differs = abilities.surfaces.iter().any(|&kind| {
                let mut with = scene(kind, abilities.boundaries[0], Some(effect));
                with.outputs.area = abilities.outputs.contains(&Output::Area);
                let mut without = scene(kind, abilities.boundaries[0], None);
                (without.pair, without.outputs) = (with.pair, with.outputs);
                let state = |scene: &Scene| pressed(prepared(model, scene).ok()?.as_mut(), scene).ok();
                let Some(found) = state(&with) else { return false };
                let numbers =
                    |state: &ContactState| (state.force, state.approach, state.area, state.tangential);
                // A model that is about the effect alone answers nothing without it.
                state(&without).is_none_or(|elastic| numbers(&elastic) != numbers(&found))
            });
            assert!(differs, "{record:?}: {effect:?} changes no state");
        }
    }
}

/// Every model of the model crates is in the table.
#[test]
fn no_model_is_left_out() {
    // The surfaces of one ensemble, by the 1D reduction.
    let apart = ["Ensemble"];
    let crates = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let mut found = Vec::new();
    for folder in ["analytic/src", "bem3d/src/model", "mdr1d/src"] {
        for entry in std::fs::read_dir(crates.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let Ok(text) = std::fs::read_to_string(&path) else { continue };
            let implemented = text.lines().filter_map(|line| line.split_once(" ContactModel for "));
            let names = implemented.map(|(_, rest)| rest.split([' ', '<']).next().unwrap_or(rest).to_owned());
            found.extend(names.filter(|name| !apart.contains(&name.as_str())));
        }
    }
    for name in &found {
        assert!(MODELS.iter().any(|record| record.class == name), "{name} is not among MODELS");
    }
    assert_eq!(found.len(), MODELS.len());
}

/// A scene with a single feature that is not among the abilities is refused, and the error names that
/// feature.
#[test]
fn undeclared_abilities_are_refused_by_name() {
    for record in MODELS {
        let (model, name) = (record.model, record.name());
        let abilities = model.abilities();
        let base = || scene(abilities.surfaces[0], abilities.boundaries[0], None);
        let refused = |scene: &Scene, word: &str| match model.prepare(scene, 1).map(|_| ()) {
            Err(Error::Unsupported { model, what }) => {
                assert!(model == name && what.contains(word), "{name}: {what:?} does not name {word:?}");
            }
            other => panic!("{name}: {word} is not refused: {other:?}"),
        };
        for &kind in SurfaceKind::ALL.iter().filter(|kind| !abilities.surfaces.contains(kind)) {
            let other = Scene { surface: surface(kind), ..base() };
            refused(&other, if kind == SurfaceKind::Profile { "profile" } else { other.surface.kind() });
        }
        for &effect in Effect::ALL.iter().filter(|effect| !abilities.effects.contains(effect)) {
            let word = if name == "equivalent" { "" } else { effect.words() };
            refused(&with_effect(base(), Some(effect)), word);
        }
        for &output in Output::ALL.iter().filter(|output| !abilities.outputs.contains(output)) {
            let mut scene = base();
            ask(&mut scene, output);
            // Those that no model can answer in this scene at all.
            if scene.validate().is_err() {
                continue;
            }
            refused(&scene, if name == "mdr1d_viscoelastic" { "" } else { output.name() });
        }
    }
}

/// Loads of a declared kind are solved, others are refused.
#[test]
fn only_declared_kinds_of_loads_are_taken() {
    for record in MODELS {
        let (model, abilities) = (record.model, record.model.abilities());
        let Some((mut contact, scene)) = declared(model).find_map(|scene| {
            let contact = prepared(model, &scene).ok()?;
            Some((contact, scene))
        }) else {
            panic!("{record:?} prepares nothing")
        };
        let gap = pressed(contact.as_mut(), &scene).ok().and_then(|state| state.mean_gap).unwrap_or(0.01);
        for &kind in LoadKind::ALL {
            let load = match kind {
                LoadKind::Force => Load::force(0.001),
                LoadKind::Approach => Load::approach(1e-4),
                LoadKind::MeanGap => Load::mean_gap(gap),
                other => panic!("a load of the kind {other:?}"),
            };
            // Of the two distances the boundary decides which there is.
            let periodic = scene.effects.boundary == Boundary::Periodic;
            if kind != LoadKind::Force && periodic != (kind == LoadKind::MeanGap) {
                continue;
            }
            // Of what relaxes a jump may have no answer.
            let answered = if abilities.paths == Paths::Needed {
                contact.restart();
                contact.advance(Step::new(1.0, load))
            } else {
                contact.solve(load)
            };
            match answered {
                Err(Error::Unsupported { .. }) => {
                    assert!(!abilities.loads.contains(&kind), "{record:?}: {load:?}");
                }
                _ => assert!(abilities.loads.contains(&kind), "{record:?}: {load:?}"),
            }
        }
    }
}
