//! No bit of a state depends on the number of threads or on their other work.

use bem3d::{
    Adhesion, Bem3d, Boundary, ContactModel, ContactState, Field, Load, Result, Scene, SelfAffine, Surface,
};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// Every number of some states, as bits.
fn bits(states: &[ContactState]) -> Vec<u64> {
    let of = |state: &ContactState| {
        let certificate = &state.report.certificate;
        let numbers = [
            Some(state.force),
            state.approach,
            state.stiffness,
            state.area,
            state.mean_gap,
            Some(certificate.duality_gap),
            Some(certificate.penetration),
            Some(certificate.complementarity),
            certificate.stiffness_error,
        ];
        let fields = [state.pressure(), state.gap()].into_iter().flatten().flat_map(Field::values);
        let all = numbers.into_iter().flatten().chain(fields.copied());
        let counts = [state.report.iterations, state.report.applications].map(|n| n as u64);
        all.map(f64::to_bits).chain(counts).collect::<Vec<_>>()
    };
    states.iter().flat_map(of).collect()
}

/// A path with fields.
fn path(model: Bem3d, scene: &Scene, forces: &[f64]) -> Result<Vec<ContactState>> {
    let mut contact = model.prepare(scene, 5)?;
    let normalisation = contact.normalisation();
    forces.iter().map(|&f| contact.solve(Load::force(normalisation.force(f)?))).collect()
}

fn scene(fractal_dimension: f64, boundary: Boundary) -> Result<Scene> {
    let surface = SelfAffine::new(fractal_dimension, 1.0, 1.0)?;
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    scene.effects.boundary = boundary;
    let outputs = &mut scene.outputs;
    (outputs.pressure, outputs.gap, outputs.area) = (true, true, true);
    outputs.mean_gap = boundary == Boundary::Periodic;
    Ok(scene)
}

#[test]
fn no_bit_depends_on_the_number_of_threads() {
    let model = Bem3d { cells: 400, tolerance: 1e-7, ..Bem3d::default() };
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    // Factors, two levels, transforms of a part and of the whole; transforms of the period itself.
    for (scene, forces) in [
        (scene(2.2, Boundary::Free), &[1e-3, 0.02, 0.3, 5.0][..]),
        (scene(2.8, Boundary::Free), &[0.3, 1.0][..]),
        (scene(2.4, Boundary::Periodic), &[0.05, 2.0][..]),
    ] {
        let scene = scene.unwrap();
        let on = |threads| pool(threads).install(|| path(model, &scene, forces).unwrap());
        let states = on(1);
        let strategies: Vec<&str> = states.iter().map(|s| s.report.strategy.as_str()).collect();
        for threads in [2, 5] {
            assert!(bits(&states) == bits(&on(threads)), "{threads} threads: {strategies:?}");
        }
    }
}

/// Two solves at a time on two threads: each finishes with the same bits as alone.
#[test]
fn solves_side_by_side_do_not_disturb_each_other() {
    let model = Bem3d { cells: 300, tolerance: 1e-6, ..Bem3d::default() };
    let scenes = [(2.2, Boundary::Periodic), (2.5, Boundary::Periodic), (2.2, Boundary::Free)]
        .map(|(d, boundary)| scene(d, boundary).unwrap());
    let solved = |scene| bits(&path(model, scene, &[0.1, 3.0]).unwrap());
    let one = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone: Vec<_> = one.install(|| scenes.iter().map(solved).collect());
    let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for _ in 0..3 {
        let together =
            pool.broadcast(|worker| scenes.iter().skip(worker.index()).map(solved).collect::<Vec<_>>());
        assert!(together[0] == alone && together[1] == alone[1..]);
    }
}

/// A parallel iterator over surfaces of one grid, whose threads may begin another solve while they wait for
/// one.
#[test]
fn a_parallel_iterator_over_surfaces_ends() {
    let pool = ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let model = Bem3d { cells: 290, tolerance: 1e-3, ..Bem3d::default() };
    for boundary in [Boundary::Free, Boundary::Periodic] {
        // Contacts of many sizes: tables and symbols of one grid are made by whoever comes first.
        let scenes: Vec<Scene> =
            (0..16).map(|i| scene(2.0 + 0.06 * f64::from(i), boundary).unwrap()).collect();
        let solved = |scene: &Scene| bits(&path(model, scene, &[0.03, 0.5]).unwrap());
        let all: Vec<_> = pool.install(|| scenes.par_iter().with_max_len(1).map(solved).collect());
        assert!(all[7] == solved(&scenes[7]));
    }
}

#[test]
fn no_bit_of_an_adhesive_state_depends_on_the_number_of_threads() {
    let model = Bem3d { cells: 400, tolerance: 1e-6, ..Bem3d::default() };
    let mut scene = scene(2.2, Boundary::Periodic).unwrap();
    scene.effects.adhesion = Adhesion::ShortRange { work: 1e-6 };
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let on = |threads| bits(&pool(threads).install(|| path(model, &scene, &[0.1]).unwrap()));
    assert_eq!(on(1), on(3));
}
