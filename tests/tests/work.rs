//! Outputs that are not requested add no work: work counters of every model, output by output.

use analytic::Hertz;
use bem3d::{Bem3d, Method};
use contact_model::{
    Body, Boundary, Conductance, ContactModel, ContactState, Effects, Friction, Load, Outputs, Pair, Scene,
    Step, Surface, Work,
};
use mdr1d::{Equivalent, Mdr1d};
use std::sync::Arc;
use tests::rough;

const CELLS: usize = 33;
/// Bytes of one field.
const FIELD: usize = CELLS * CELLS * 8;
const GRAPHITE: Conductance = Conductance::Electrical { first: 8e-6, second: 0.0 };

fn model(method: Method) -> Bem3d {
    Bem3d { cells: CELLS, method, ..Bem3d::default() }
}

fn scene(outputs: Outputs) -> Scene {
    Scene { outputs, ..Scene::new(Surface::SelfAffine(rough(2.3).unwrap()), 1.0) }
}

fn press(model: &dyn ContactModel, scene: &Scene) -> ContactState {
    let mut contact = model.prepare(scene, 3).unwrap();
    let force = contact.normalisation().force(0.3).unwrap();
    contact.solve(Load::force(force)).unwrap()
}

/// Iterations, applications, and the rest.
fn counts(state: &ContactState) -> (usize, usize, Work) {
    (state.report.iterations, state.report.applications, state.report.work)
}

#[test]
fn a_bare_scene_solves_for_the_pressure_and_stores_nothing() {
    for method in [Method::Auto, Method::Iterative, Method::SingleLevel] {
        let bare = press(&model(method), &scene(Outputs::default()));
        assert_eq!((bare.report.work.fields, bare.report.work.bytes), (0, 0));
        assert!(bare.report.work.linear_solves > 0 && bare.report.applications > 0);
        // The stiffness is one more system, and that only when asked for, by itself or by the conductance.
        let stiff = press(&model(method), &scene(Outputs { stiffness: true, ..Outputs::default() }));
        assert!(stiff.report.applications > bare.report.applications);
        assert!(stiff.report.work.linear_solves >= bare.report.work.linear_solves);
        let conducts = press(&model(method), &scene(Outputs { conductance: GRAPHITE, ..Outputs::default() }));
        assert_eq!(counts(&conducts), counts(&stiff));
        assert!(conducts.stiffness.is_none());
        let from_stiffness = GRAPHITE.of(stiff.stiffness.unwrap(), 1.0).unwrap();
        assert_eq!(conducts.conductance, from_stiffness);
    }
    // An iteration on a set of its own is counted, a factor of the contact set serves both.
    let count = |stiffness| {
        let outputs = Outputs { stiffness, ..Outputs::default() };
        press(&model(Method::Iterative), &scene(outputs)).report.work.linear_solves
    };
    assert!(count(true) > count(false));
}

#[test]
fn each_output_adds_its_own_work_and_no_other() {
    let none = Outputs::default();
    let bare = counts(&press(&model(Method::Auto), &scene(none)));
    // Applications, fields.
    for (outputs, applications, fields) in [
        (Outputs { area: true, ..none }, 0, 0),
        (Outputs { contact_patches: true, ..none }, 0, 0),
        (Outputs { pressure: true, ..none }, 0, 1),
        (Outputs { displacement: true, ..none }, 1, 1),
        (Outputs { gap: true, ..none }, 1, 1),
        // One application serves both.
        (Outputs { gap: true, displacement: true, ..none }, 1, 2),
    ] {
        let state = press(&model(Method::Auto), &scene(outputs));
        let work = Work { fields, bytes: fields * FIELD, ..bare.2 };
        assert_eq!(counts(&state), (bare.0, bare.1 + applications, work), "{outputs:?}");
    }
    // Without contact there is nothing to solve, but fields are fields.
    let mut contact = model(Method::Auto).prepare(&scene(Outputs { gap: true, ..none }), 3).unwrap();
    let state = contact.solve(Load::force(0.0)).unwrap();
    assert_eq!(counts(&state), (0, 0, Work { linear_solves: 0, fields: 1, bytes: FIELD }));
}

#[test]
fn formulas_and_lines_count_no_such_work() {
    let outputs = Outputs { stiffness: true, conductance: GRAPHITE, ..Outputs::default() };
    let sphere = Scene { outputs, ..Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0) };
    for (model, scene) in [
        (&Hertz as &dyn ContactModel, sphere.clone()),
        (&Mdr1d::default(), sphere),
        (&Mdr1d { elements: 512 }, scene(outputs)),
    ] {
        let mut contact = model.prepare(&scene, 3).unwrap();
        let state = contact.solve(Load::force(1e-3)).unwrap();
        assert_eq!(counts(&state), (0, 0, Work::default()));
        assert!(state.conductance.unwrap() > 0.0);
    }
}

#[test]
fn patches_are_the_area_in_pieces() {
    let outputs = Outputs { area: true, contact_patches: true, pressure: true, ..Outputs::default() };
    let state = press(&model(Method::Auto), &scene(outputs));
    let patches = state.patches.unwrap();
    let sum: f64 = patches.areas().iter().sum();
    approx::assert_relative_eq!(sum, state.area.unwrap(), max_relative = 1e-14);
    assert!(patches.count() > 1 && patches.count() < state.report.contact_cells.unwrap());
    // Beside the pressure map.
    let pressure = state.fields.unwrap().pressure.unwrap();
    let index: Vec<u32> = (0..).zip(pressure.values()).filter(|(_, p)| **p > 0.0).map(|(i, _)| i).collect();
    let sizes = surface_gen::patches(CELLS, &index, Boundary::Free);
    assert_eq!(sizes.len(), patches.count());
    let cell = sum / index.len() as f64;
    let largest = sizes.into_iter().max().unwrap() as f64 * cell;
    approx::assert_relative_eq!(patches.areas()[0], largest, max_relative = 1e-12);
}

#[test]
fn a_summit_cut_by_the_edges_is_one_patch_where_they_are_one() {
    // The highest point is in the corner of the square: four quarters, or one summit.
    let cells = 16;
    let wave = |i: usize| (std::f64::consts::TAU * (i as f64 + 0.5) / cells as f64).cos();
    let map = tests::map(cells, 1.0, |x, y| wave(x) + wave(y)).unwrap();
    let outputs = Outputs { contact_patches: true, ..Outputs::default() };
    for (boundary, count) in [(Boundary::Free, 4), (Boundary::Periodic, 1)] {
        let mut scene = Scene { outputs, ..Scene::new(Surface::Heights(Arc::new(map.clone())), 1.0) };
        scene.effects.boundary = boundary;
        let state = Bem3d::default().prepare(&scene, 0).unwrap().solve(Load::force(0.01)).unwrap();
        let patches = state.patches.unwrap();
        assert_eq!(patches.count(), count, "{boundary:?}");
        let cells_in_contact = state.report.contact_cells.unwrap() as f64 / (cells * cells) as f64;
        approx::assert_relative_eq!(
            patches.areas()[0] * count as f64,
            cells_in_contact,
            max_relative = 1e-12
        );
    }
}

/// A path over a rough surface needs the table once, then one solve per step; fields are computed only where
/// requested, and not for the table.
#[test]
fn a_path_computes_its_table_once() {
    let body = Body::Elastic { young: 2.0, poisson: 0.3 };
    let surface = Surface::SelfAffine(rough(2.3).unwrap());
    let mut scene = Scene::of_pair(surface, Pair { first: body, second: body }).unwrap();
    scene.outputs = Outputs::default();
    scene.effects.friction = Friction::coulomb(0.3);
    let model = Equivalent { per_decade: 4, decades: 2, model: model(Method::Auto) };
    let run = |outputs: Outputs| {
        let mut contact = model.prepare(&Scene { outputs, ..scene.clone() }, 3).unwrap();
        let force = contact.normalisation().force(0.3).unwrap();
        let step = Step::new(0.0, Load::force(force));
        [contact.advance(step).unwrap(), contact.advance(step).unwrap()].map(|state| counts(&state))
    };
    let [first, second] = run(Outputs::default());
    assert!(first.1 > 5 * second.1 && second.1 > 0, "{first:?} {second:?}");
    let [with, again] = run(Outputs { gap: true, ..Outputs::default() });
    assert_eq!((with.2.fields, again.2.fields), (1, 1), "the nodes have no fields");
    assert_eq!(with.2.bytes, FIELD);
    // Effects that are off cost nothing: the same scene without friction is the bare solver.
    let elastic = Scene { effects: Effects::default(), ..scene.clone() };
    let bare = press(&model.model, &Scene { pair: None, contact_modulus: 1.0, ..elastic.clone() });
    let paired = press(&model.model, &elastic);
    assert_eq!(counts(&bare).2, counts(&paired).2);
}
