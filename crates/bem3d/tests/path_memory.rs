//! A path that is interrupted after any step continues from its memory to the same bits as the uninterrupted
//! path.

#![allow(clippy::unwrap_used)] // Helpers of tests.

use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Boundary, ContactModel, ContactState, Friction, FrictionLaw, Hardness,
    Load, Pair, PathMemory, PreparedContact, Scene, SelfAffine, Step, Surface, Tangential,
};
use contact_model::{Error, never};
use std::cell::Cell;

fn rough(hurst: f64, rms: f64) -> Surface {
    Surface::SelfAffine(SelfAffine::new(3.0 - hurst, 1.0, rms).unwrap())
}

fn prepare(scene: &Scene, cells: usize) -> Box<dyn PreparedContact> {
    Bem3d { cells, ..Bem3d::default() }.prepare(scene, 3).unwrap()
}

/// Follows a path without interruption, and from the memory after each of its steps.
fn check(name: &str, scene: &Scene, cells: usize, path: &[Step]) {
    let mut contact = prepare(scene, cells);
    let mut memories = Vec::new();
    let mut states: Vec<ContactState> = Vec::new();
    for step in path {
        states.push(contact.advance(*step).unwrap());
        memories.push(contact.memory().unwrap().unwrap());
    }
    for (done, memory) in memories.iter().enumerate() {
        let kept = PathMemory::from_bytes(memory.bytes().to_vec());
        let mut other = prepare(scene, cells);
        // What was solved before leaves no trace.
        other.solve(path[0].load).unwrap();
        other.recall(&kept).unwrap();
        assert_eq!(other.memory().unwrap().as_ref(), Some(memory), "{name}, step {done}");
        for (i, step) in path.iter().enumerate().skip(done + 1) {
            let state = other.advance(*step).unwrap();
            assert_eq!(state, states[i], "{name}: step {i} of a path that goes on after step {done}");
            assert_eq!(other.memory().unwrap().as_ref(), Some(&memories[i]), "{name}, step {i}");
        }
    }
}

/// Solves loads that do not depend on each other without interruption, and from the memory after each of them.
fn check_loads(name: &str, scene: &Scene, cells: usize, loads: &[Load]) {
    let mut contact = prepare(scene, cells);
    let solved = |load: &Load| (contact.solve(*load).unwrap(), contact.memory().unwrap().unwrap());
    let whole: Vec<(ContactState, PathMemory)> = loads.iter().map(solved).collect();
    for (done, (_, memory)) in whole.iter().enumerate() {
        let mut other = prepare(scene, cells);
        // What was solved before leaves no trace.
        other.advance(Step::new(0.0, loads[0])).unwrap();
        other.recall(memory).unwrap();
        for (i, load) in loads.iter().enumerate().skip(done + 1) {
            assert_eq!(other.solve(*load).unwrap(), whole[i].0, "{name}: load {i} after load {done}");
            assert_eq!(other.memory().unwrap().as_ref(), Some(&whole[i].1), "{name}, load {i}");
        }
    }
}

#[test]
fn loads_without_a_path() {
    let forces = [1e-4, 4e-3, 2e-2, 1e-3, 8e-3].map(Load::force);
    let mut scene = Scene::new(rough(0.7, 0.01), 1.0);
    (scene.outputs.stiffness, scene.outputs.area) = (true, true);
    check_loads("elastic", &scene, 129, &forces);
    scene.effects.hardness = Hardness::Limit { pressure: 0.05 };
    check_loads("hardness", &scene, 65, &forces);
    scene.effects.hardness = Hardness::Off;
    let approaches = [0.004, 0.008, 0.012, 0.006].map(Load::approach);
    for adhesion in [
        Adhesion::ShortRange { work: 1e-5 },
        Adhesion::FiniteRange { work: 4e-5, range: 3e-3, law: AdhesionLaw::Exponential },
    ] {
        scene.effects.adhesion = adhesion;
        check_loads("adhesion", &scene, 49, &approaches);
    }
    scene.effects.adhesion = Adhesion::Off;
    scene.effects.boundary = Boundary::Periodic;
    scene.outputs.mean_gap = true;
    check_loads("mean gaps", &scene, 64, &[0.02, 0.012, 0.008, 0.016].map(Load::mean_gap));
}

/// Follows a path that is asked to stop at some poll, for polls from the first to the last one, each later than
/// the one before by a share `1/finer` of it. The path then stands where the last finished step left it, and
/// goes on to the states of the path that nobody stopped.
fn stop_anywhere(name: &str, scene: &Scene, (cells, finer): (usize, usize), path: &[Step]) {
    let mut contact = prepare(scene, cells);
    let mut states: Vec<ContactState> = Vec::new();
    let mut memories = Vec::new();
    for step in path {
        states.push(contact.advance(*step).unwrap());
        memories.push(contact.memory().unwrap());
    }
    let (mut polls, mut stops) = (0_usize, 0);
    loop {
        let mut contact = prepare(scene, cells);
        let left = Cell::new(polls);
        let stop = || left.replace(left.get().saturating_sub(1)) == 0;
        let mut stopped = false;
        for (i, step) in path.iter().enumerate() {
            let mut found = contact.advance_until(*step, if stopped { &never } else { &stop });
            if let Err(Error::Stopped { best }) = &found {
                if let Some(best) = best {
                    let tangential = best.tangential.as_ref();
                    let certificate = &best.report.certificate;
                    let unfinished = [
                        best.stiffness,
                        best.stiffness_fixed_area,
                        best.conductance,
                        certificate.stiffness_error,
                        certificate.quotient_error,
                        certificate.force_error,
                        certificate.tangential_stiffness_error,
                    ];
                    assert_eq!(unfinished, [None; 7], "{name}: {polls}");
                    assert!(
                        tangential.is_none_or(|t| t.stiffness.is_none() && t.stiffness_stuck.is_none()),
                        "{name}: {polls}"
                    );
                }
                if i > 0 {
                    assert_eq!(contact.memory().unwrap(), memories[i - 1], "{name}: poll {polls}, step {i}");
                }
                stopped = true;
                found = contact.advance(*step);
            }
            assert_eq!(found.unwrap(), states[i], "{name}: poll {polls}, step {i}");
        }
        if !stopped {
            break;
        }
        stops += 1;
        polls += 1 + polls / finer;
    }
    assert!(stops >= path.len(), "{name}: {stops} stops in {polls} polls");
}

fn normal(loads: impl IntoIterator<Item = Load>) -> Vec<Step> {
    loads.into_iter().enumerate().map(|(i, load)| Step::new(i as f64, load)).collect()
}

#[test]
fn elastic() {
    let scene = Scene::new(rough(0.6, 0.01), 1.0);
    let forces = [1e-4, 1e-3, 2e-3, 4e-3, 2e-2, 1e-2, 1e-3, 3e-3].map(Load::force);
    check("elastic", &scene, 129, &normal(forces));
    let approaches = [0.002, 0.004, 0.02, 0.03, 0.01, 0.0, 0.02].map(Load::approach);
    check("elastic by approach", &scene, 65, &normal(approaches));
    let mut periodic = scene;
    periodic.effects.boundary = Boundary::Periodic;
    (periodic.outputs.mean_gap, periodic.outputs.area) = (true, true);
    let gaps = [0.02, 0.015, 0.01, 0.012, 0.03, 0.01].map(Load::mean_gap);
    check("elastic by mean gap", &periodic, 64, &normal(gaps));
    periodic.outputs.stiffness = true;
    stop_anywhere("elastic by mean gap", &periodic, (24, 8), &normal(gaps));
}

#[test]
fn hardness() {
    let mut scene = Scene::new(rough(0.7, 0.01), 1.0);
    scene.effects.hardness = Hardness::Limit { pressure: 0.05 };
    scene.outputs.plastic_depth = true;
    let forces = [1e-3, 4e-3, 8e-3, 2e-3, 0.0, 5e-3, 8e-3, 1.2e-2, 6e-3].map(Load::force);
    check("hardness", &scene, 129, &normal(forces));
    scene.outputs.stiffness = true;
    stop_anywhere("hardness", &scene, (33, 8), &normal(forces));
}

#[test]
fn friction() {
    let path: Vec<Step> = [
        (4e-3, [0.0, 0.0]),
        (4e-3, [1e-3, 0.0]),
        (6e-3, [2e-3, 1e-3]),
        (6e-3, [-1e-3, 0.5e-3]),
        (3e-3, [-0.5e-3, 0.5e-3]),
        (3e-3, [0.6e-3, 0.0]),
    ]
    .iter()
    .enumerate()
    .map(|(i, &(force, tangential))| {
        Step::new(i as f64, Load::force(force).with_tangential(Tangential::Force(tangential)))
    })
    .collect();
    let limited = FrictionLaw { limit: Some(0.06), ..FrictionLaw::coulomb(0.4) };
    let strong = FrictionLaw { shear_strength: 2e-3, ..limited };
    let flows = Hardness::Limit { pressure: 0.05 };
    for (name, law, hardness, full, cells) in [
        ("friction", FrictionLaw::coulomb(0.4), Hardness::Off, false, 129),
        ("friction with a shear strength", strong, Hardness::Off, false, 49),
        ("friction with a hardness", strong, flows, false, 49),
        ("friction, coupled", FrictionLaw::coulomb(0.4), Hardness::Off, true, 49),
        ("friction with a limit, coupled", limited, Hardness::Off, true, 25),
    ] {
        let pair = Pair {
            first: bem3d::Body::Rigid,
            second: bem3d::Body::Elastic { young: 0.9, poisson: if full { 0.2 } else { 0.5 } },
        };
        let mut scene = Scene::of_pair(rough(0.7, 0.01), pair).unwrap();
        scene.effects.friction = Friction::of(law).with_coupling(full.then_some(bem3d::Coupling::Full));
        scene.effects.hardness = hardness;
        scene.outputs.tangential_stiffness = !full;
        check(name, &scene, cells, &path);
        scene.outputs.tangential_stiffness = true;
        stop_anywhere(name, &scene, (if full { 13 } else { 33 }, 8), &path);
    }
}

#[test]
fn adhesion() {
    let approaches = [0.004, 0.012, 0.02, 0.012, 0.004, -0.002, -0.01].map(Load::approach);
    let forces = [1e-3, 5e-3, 1e-3, 0.0, -2e-5, 1e-3].map(Load::force);
    let gaps = [0.03, 0.02, 0.015, 0.02, 0.03, 0.05].map(Load::mean_gap);
    let (work, range) = (4e-5, 2e-3);
    for (name, adhesion) in [
        ("short range", Adhesion::ShortRange { work }),
        ("exponential", Adhesion::FiniteRange { work, range, law: AdhesionLaw::Exponential }),
        ("Dugdale", Adhesion::FiniteRange { work, range, law: AdhesionLaw::Dugdale }),
    ] {
        let mut scene = Scene::new(rough(0.8, 0.01), 1.0);
        scene.effects.adhesion = adhesion;
        scene.outputs.area = true;
        check(name, &scene, 65, &normal(approaches));
        check(name, &scene, 65, &normal(forces));
        scene.outputs.stiffness = true;
        stop_anywhere(name, &scene, (65, 1), &normal(approaches[1..3].iter().copied()));
        scene.effects.boundary = Boundary::Periodic;
        scene.outputs.mean_gap = true;
        check(name, &scene, 64, &normal(gaps));
    }
    let mut scene = Scene::new(rough(0.8, 0.01), 1.0);
    scene.effects.hardness = Hardness::Limit { pressure: 0.05 };
    for law in [AdhesionLaw::Exponential, AdhesionLaw::Dugdale] {
        scene.effects.adhesion = Adhesion::FiniteRange { work: 4e-5, range: 6e-3, law };
        (scene.outputs.area, scene.outputs.plastic_depth) = (true, true);
        check("hardness with adhesion", &scene, 33, &normal(approaches));
        check("hardness with adhesion", &scene, 33, &normal(forces));
        scene.outputs.stiffness = true;
        stop_anywhere("hardness with adhesion", &scene, (17, 5), &normal(approaches[1..4].iter().copied()));
    }
}

#[test]
fn friction_with_adhesion() {
    let body = bem3d::Body::Elastic { young: 2.0, poisson: 0.0 };
    let path: Vec<Step> = [(5e-3, 0.0), (5e-3, 2e-5), (1e-3, 2e-5), (0.0, -1e-5), (-1e-5, 0.0), (3e-3, 1e-5)]
        .iter()
        .enumerate()
        .map(|(i, &(force, tangential))| {
            let load = Load::force(force).with_tangential(Tangential::Force([tangential, 0.5 * tangential]));
            Step::new(i as f64, load)
        })
        .collect();
    let (work, range) = (4e-5, 6e-3);
    for (name, adhesion, friction) in [
        ("a shear strength with a short range", Adhesion::ShortRange { work }, Friction::tresca(0.05)),
        (
            "a coefficient with a range",
            Adhesion::FiniteRange { work, range, law: AdhesionLaw::Exponential },
            Friction::coulomb(0.5),
        ),
    ] {
        let mut scene = Scene::of_pair(rough(0.8, 0.01), Pair { first: body, second: body }).unwrap();
        (scene.effects.adhesion, scene.effects.friction) = (adhesion, friction);
        (scene.outputs.area, scene.outputs.stick_area) = (true, true);
        scene.outputs.tangential_stiffness = true;
        check(name, &scene, 49, &path);
        stop_anywhere(name, &scene, (25, 5), &path[..4]);
    }
}

#[test]
fn memories_that_are_not_of_the_surface_are_refused() {
    let mut scene = Scene::new(rough(0.7, 0.01), 1.0);
    let path = normal([1e-3, 4e-3].map(Load::force));
    let memory = |scene: &Scene, cells: usize| {
        let mut contact = prepare(scene, cells);
        contact.follow(&path).unwrap();
        contact.memory().unwrap().unwrap()
    };
    let elastic = memory(&scene, 65);
    let larger = memory(&scene, 129);
    scene.effects.hardness = Hardness::Limit { pressure: 0.05 };
    let plastic = memory(&scene, 65);
    scene.effects.hardness = Hardness::Off;
    scene.effects.adhesion = Adhesion::ShortRange { work: 1e-5 };
    let adhesive = memory(&scene, 65);
    scene.effects.adhesion = Adhesion::Off;
    let mut contact = prepare(&scene, 65);
    for other in [&larger, &plastic, &adhesive] {
        assert!(contact.recall(other).is_err());
    }
    for cut in 0..elastic.bytes().len().min(400) {
        assert!(contact.recall(&PathMemory::from_bytes(elastic.bytes()[..cut].to_vec())).is_err());
    }
    // Any change of a byte is refused, or another memory; nothing ends the program.
    for at in 0..elastic.bytes().len().min(2000) {
        let mut bytes = elastic.bytes().to_vec();
        bytes[at] ^= 0xff;
        if contact.recall(&PathMemory::from_bytes(bytes)).is_ok() {
            let _ = contact.advance(path[1]);
        }
    }
    // Afterwards the contact is at the beginning of a path.
    let _ = contact.recall(&larger);
    let whole = prepare(&scene, 65).follow(&path).unwrap();
    assert_eq!(contact.follow(&path).unwrap(), whole);
}
