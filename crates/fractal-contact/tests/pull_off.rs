//! The largest pull of a path and the interval of the pull-off force, against the closed forms of a sphere.

use fractal_contact::analytic::MaugisDugdale;
use fractal_contact::scenes::{Options, Plan, SceneFile, run};
use fractal_contact::{
    Adhesion, AdhesionLaw, Bem3d, ContactModel, Error, LargestPull, Load, NormalLoad, PullOff, Scene, Step,
    Surface,
};
use runs::{CsvFile, Silent};
use std::f64::consts::PI;

const WORK: f64 = 1e-4;
/// What the cells leave of a sphere's pull-off: as [`bem3d`] states it for some 20 cells in the radius.
const CELLS: f64 = 0.03;
/// The same of Dugdale's law, which converges to first order.
const ZONE: f64 = 0.1;

fn sphere(adhesion: Adhesion) -> Scene {
    let radius = (4.5 * PI * WORK).cbrt();
    let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: (3.2 * radius).into() }, 1.0);
    scene.effects.adhesion = adhesion;
    scene.outputs.stiffness = false;
    scene
}

/// The largest pull of a path by approach or under forces, to its end or its failure.
fn pulled(scene: &Scene, cells: usize, loads: impl IntoIterator<Item = Load>) -> PullOff {
    let mut contact = Bem3d { cells, ..Bem3d::default() }.prepare(scene, 0).unwrap();
    let mut largest = LargestPull::default();
    let mut pull = None;
    for (i, load) in loads.into_iter().enumerate() {
        let state = match contact.advance(Step::new(i as f64, load)) {
            Err(Error::NotConverged { best }) => *best,
            found => found.unwrap(),
        };
        pull = largest.enter(load.normal, state).pull_off;
    }
    pull.unwrap()
}

/// Drawn from contact to beyond pull-off.
fn drawn(steps: u32, offset: f64) -> impl Iterator<Item = Load> {
    let unit = (PI * PI * WORK * WORK).cbrt();
    (0..=steps).map(move |i| Load::approach(unit * (0.8 - 2.2 * (f64::from(i) + offset) / f64::from(steps))))
}

#[test]
fn the_interval_of_a_path_by_approach_holds_the_pull_off_force() {
    let dugdale = Adhesion::FiniteRange { work: WORK, range: 2.5e-3, law: AdhesionLaw::Dugdale };
    let maugis = {
        let mut contact = MaugisDugdale.prepare(&sphere(dugdale), 0).unwrap();
        match contact.solve(Load::force(-1.0)) {
            Err(Error::OutOfRange { min, .. }) => -min,
            other => panic!("{other:?}"),
        }
    };
    for (name, adhesion, exact, cells) in [
        ("JKR", Adhesion::ShortRange { work: WORK }, 1.5 * PI * WORK, CELLS),
        ("Maugis", dugdale, maugis, ZONE),
    ] {
        let scene = sphere(adhesion);
        let fine = pulled(&scene, 64, drawn(96, 0.0));
        assert!((fine.force / exact - 1.0).abs() < cells, "{name}: {fine:?}, exact {exact:e}");
        let mut errors = Vec::new();
        for steps in [8, 16, 32] {
            let mut worst = 0.0f64;
            for offset in [0.0, 0.4, 0.8] {
                let found = pulled(&scene, 64, drawn(steps, offset));
                let error = found.error.unwrap();
                worst = worst.max(error / exact);
                // On the same cells, so that nothing but the steps is between them; Dugdale's zone and the front of
                // a short range move by whole cells, and the force by some thousandths, which coarse steps miss.
                let most = found.force + error + 4e-3 * exact;
                assert!(
                    found.force <= fine.force + fine.error.unwrap(),
                    "{name}, {steps}: {found:?} {fine:?}"
                );
                assert!(fine.force <= most, "{name}, {steps} steps: {found:?}, {fine:?}");
                // The force is flat there: of the fine path one cell more or less in the front decides where it is
                // lowest.
                let unit = (PI * PI * WORK * WORK).cbrt();
                let off = (found.approach.unwrap() - fine.approach.unwrap()).abs();
                let step = 2.2 * unit / f64::from(steps);
                assert!(off < 1.5 * step + 0.1 * unit, "{name}: {found:?} {fine:?}");
            }
            errors.push(worst);
        }
        assert!(errors[2] < 0.7 * errors[0] && errors[2] < 0.1, "{name}: {errors:?}");
    }
}

#[test]
fn the_interval_under_a_force_lies_between_what_was_held_and_what_was_not() {
    let scene = sphere(Adhesion::ShortRange { work: WORK });
    let exact = 1.5 * PI * WORK;
    let forces =
        |steps: u32| (0..=steps).map(move |i| Load::force(-1.3 * exact * f64::from(i) / f64::from(steps)));
    for steps in [5, 20] {
        // The path ends at the first force that is not held.
        let loads = forces(steps).take_while(|load| match load.normal {
            NormalLoad::Force(force) => -force < exact * (1.0 + CELLS) + 1.3 * exact / f64::from(steps),
            _ => false,
        });
        let found = pulled(&scene, 64, loads);
        let step = 1.3 * exact / f64::from(steps);
        let error = found.error.unwrap();
        assert!(error > 0.0 && error <= 2.0 * step * (1.0 + 1e-6), "{found:?}");
        assert!(
            found.force <= exact * (1.0 + CELLS) && exact * (1.0 - CELLS) <= found.force + error,
            "{found:?}"
        );
    }
}

/// Paths of three surfaces that pull off at different loads: the mean at the end is over all of them.
#[test]
fn means_are_over_the_ends_of_all_paths() {
    let dir = tempfile::tempdir().unwrap();
    let mut steps = vec![1e-3, 0.0];
    steps.extend((0..40).map(|i| -3e-5 * 1.15f64.powi(i)));
    let step = |(i, force)| format!("[[scene.path]]\ntime = {i}\nforce = {force:e}\n");
    let text = format!(
        "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\n[scene.surface]\nkind = \"self_affine\"\nside = 1\n\
         hurst = 0.8\nrms_height = 0.01\n[effects]\nadhesion = {{ work = 1e-4 }}\n[models.bem3d]\ncells = 33\n[sampling]\n\
         surfaces = 3\nseed = 1\n{}",
        steps.iter().enumerate().map(step).collect::<Vec<_>>().concat()
    );
    let (path, out) = (dir.path().join("scene.toml"), dir.path().join("out"));
    std::fs::write(&path, text).unwrap();
    let scene = SceneFile::read(&path).unwrap();
    let options = Options { out: out.clone(), threads: 1, fresh: false };
    let outcome = run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &|| false).unwrap();
    let read = |name: &str| CsvFile::read(&out.join(name)).unwrap();
    let number = |file: &CsvFile, row: &[String], name: &str| -> f64 {
        row[file.columns.iter().position(|c| c == name).unwrap()].parse().unwrap()
    };
    let (states, means) = (read("results.csv"), read("ensemble.csv"));
    let ends: Vec<f64> = (0..3)
        .map(|surface| {
            let of = |row: &&Vec<String>| row[1] == surface.to_string();
            let end = states.rows.iter().rfind(of).unwrap();
            assert!(end.iter().any(|word| word == "pulled_off"), "{end:?}");
            number(&states, end, "pull_off")
        })
        .collect();
    let lengths: Vec<usize> =
        (0..3).map(|s| states.rows.iter().filter(|row| row[1] == s.to_string()).count()).collect();
    assert!(lengths.iter().any(|length| *length != lengths[0]), "{lengths:?}: all end at one load");
    let (mean, end) = (ends.iter().sum::<f64>() / 3.0, means.rows.last().unwrap());
    assert!((number(&means, end, "pull_off") / mean - 1.0).abs() < 1e-12, "{ends:?} {end:?}");
    let squares: f64 = ends.iter().map(|pull| (pull - mean).powi(2)).sum();
    let error = (squares / 2.0 / 3.0).sqrt();
    assert!((number(&means, end, "pull_off_se") / error - 1.0).abs() < 1e-9, "{ends:?} {end:?}");
    assert!(outcome.summary.contains("path as a whole: pull_off"), "{}", outcome.summary);
}

/// Where the attraction of a hard, small ball reaches across its gaps, the plan says that it is not of short range.
#[test]
fn a_small_parameter_of_tabor_is_told() {
    let notes = |modulus: &str, adhesion: &str| {
        let text = format!(
            "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"{modulus}\"\nforce = \"-1 nN\"\n[scene.body]\nkind = \"sphere\"\n\
             radius = \"200 nm\"\nside = \"20 nm\"\n[effects]\nadhesion = {{ work = \"50 mJ/m^2\"{adhesion} }}\n[models.bem3d]\ncells = 17\n"
        );
        let scene = SceneFile::parse("scene.toml".as_ref(), text).unwrap_or_else(|e| panic!("{e}"));
        let notes = Plan::new(&scene).unwrap().notes;
        notes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    // (200 nm (50 mJ/m^2)^2/((70 GPa)^2 (0.3 nm)^3))^(1/3).
    let told = notes("70 GPa", "");
    assert!(told.contains("Tabor's parameter of the ball is 0.16 where"), "{told}");
    assert!(told.contains("`maugis_dugdale`"), "{told}");
    assert!(!notes("100 MPa", "").contains("Tabor"));
    assert!(!notes("70 GPa", ", range = \"2 nm\"").contains("Tabor"));
}
