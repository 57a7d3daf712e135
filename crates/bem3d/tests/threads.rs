//! No bit of a state depends on the number of threads, nor on what else they do.

use bem3d::{Bem3d, Boundary, ContactModel, ContactState, Load, Scene, SelfAffine, Surface};
use rayon::ThreadPoolBuilder;

/// Every number of some states as bits.
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
        let fields = [state.pressure(), state.gap()].into_iter().flatten().flat_map(|field| field.values());
        let all = numbers.into_iter().flatten().chain(fields.copied());
        let counts = [state.report.iterations, state.report.applications].map(|n| n as u64);
        all.map(f64::to_bits).chain(counts).collect::<Vec<_>>()
    };
    states.iter().flat_map(of).collect()
}

/// A path with fields on so many threads.
fn path(threads: usize, model: Bem3d, scene: &Scene, forces: &[f64]) -> Vec<ContactState> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut contact = model.prepare(scene, 5).unwrap();
        let normalisation = contact.normalisation();
        let load = |&f: &f64| Load::Force(normalisation.force(f).unwrap());
        forces.iter().map(|f| contact.solve(load(f)).unwrap()).collect()
    })
}

fn scene(fractal_dimension: f64, boundary: Boundary) -> Scene {
    let surface = SelfAffine::new(fractal_dimension, 1.0, 1.0).map(Surface::SelfAffine).unwrap();
    let mut scene = Scene::new(surface, 1.0);
    scene.effects.boundary = boundary;
    let outputs = &mut scene.outputs;
    (outputs.pressure, outputs.gap, outputs.area) = (true, true, true);
    outputs.mean_gap = boundary == Boundary::Periodic;
    scene
}

#[test]
fn no_bit_depends_on_the_number_of_threads() {
    let model = Bem3d { cells: 400, tolerance: 1e-7, ..Bem3d::default() };
    // Factors, two levels, transforms of a part and of the whole; transforms of the period itself.
    for (scene, forces) in [
        (scene(2.2, Boundary::Free), &[1e-3, 0.02, 0.3, 5.0][..]),
        (scene(2.8, Boundary::Free), &[0.3, 1.0][..]),
        (scene(2.4, Boundary::Periodic), &[0.05, 2.0][..]),
    ] {
        let states = path(1, model, &scene, forces);
        let strategies: Vec<&str> = states.iter().map(|s| s.report.strategy.as_str()).collect();
        let one = bits(&states);
        for threads in [2, 5] {
            assert!(one == bits(&path(threads, model, &scene, forces)), "{threads} threads: {strategies:?}");
        }
    }
}

/// Two solves at a time on two threads: each finishes, with the bits that it has alone.
#[test]
fn solves_side_by_side_do_not_disturb_each_other() {
    let model = Bem3d { cells: 300, tolerance: 1e-6, ..Bem3d::default() };
    let scenes = [scene(2.2, Boundary::Periodic), scene(2.5, Boundary::Periodic), scene(2.2, Boundary::Free)];
    let alone: Vec<_> = scenes.iter().map(|scene| bits(&path(1, model, scene, &[0.1, 3.0]))).collect();
    let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for _ in 0..3 {
        let together = pool.broadcast(|context| {
            scenes
                .iter()
                .skip(context.index())
                .map(|scene| {
                    let mut contact = model.prepare(scene, 5).unwrap();
                    let normalisation = contact.normalisation();
                    let load = |f| Load::Force(normalisation.force(f).unwrap());
                    bits(&[0.1, 3.0].map(|f| contact.solve(load(f)).unwrap()))
                })
                .collect::<Vec<_>>()
        });
        assert!(together[0] == alone && together[1] == alone[1..]);
    }
}
