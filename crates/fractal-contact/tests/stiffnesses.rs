//! The stiffness along the branch and that of the held contact area, what follows from them, and their
//! errors.

use fractal_contact::scenes::{Options, Plan, SceneFile, SceneOutcome, run};
use runs::{CsvFile, Silent};
use std::path::Path;

/// Rounding of a closed form, printed and read again.
const ROUNDING: f64 = 1e-12;

fn solved(directory: &Path, text: &str) -> (SceneOutcome, CsvFile) {
    let path = directory.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = SceneFile::read(&path).unwrap();
    let options = Options { out: directory.join("out"), threads: 2, fresh: false };
    let outcome = run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &|| false).unwrap();
    (outcome, CsvFile::read(&directory.join("out/results.csv")).unwrap())
}

const SPHERE: &str = "[scene]\nunits = \"none\"\nmodels = [\"jkr\", \"mdr1d\"]\ncontact_modulus = 1\nforce = [-0.03, 0, 0.1]\n\
    [scene.body]\nkind = \"sphere\"\nradius = 1\nside = 4\n[effects]\nadhesion = { work = 0.01 }\n\
    [outputs]\narea = true\nstiffness = true\nstiffness_fixed_area = true\ncurves = true\n\
    conductance = { kind = \"electrical\", resistivities = [1, 3] }\n";

#[test]
fn an_adhesive_contact_has_two_stiffnesses_and_conducts_through_its_area() {
    let dir = tempfile::tempdir().unwrap();
    let (outcome, file) = solved(dir.path(), SPHERE);
    let of = |name: &str| file.numbers(name).unwrap().into_iter().map(Option::unwrap).collect::<Vec<f64>>();
    let [along, held, area, conductance] =
        ["stiffness", "stiffness_fixed_area", "area", "conductance"].map(of);
    for i in 0..6 {
        let radius = (area[i] / std::f64::consts::PI).sqrt();
        approx::assert_relative_eq!(held[i], 2.0 * radius, max_relative = ROUNDING);
        approx::assert_relative_eq!(conductance[i], 0.5 * held[i], max_relative = ROUNDING);
        assert!(along[i] > 0.0 && along[i] < held[i]);
    }
    // Without load b = 1/2: 3/5 of 2 E* a.
    approx::assert_relative_eq!(along[1] / held[1], 0.6, max_relative = ROUNDING);
    // What was asked for is told, drawn and explained.
    for name in ["stiffness", "stiffness_fixed_area", "conductance"] {
        // Heads of columns stand in several lines.
        assert!(name.split('_').all(|word| outcome.summary.contains(word)), "{}", outcome.summary);
        assert!(dir.path().join(format!("out/curve-{name}.svg")).is_file(), "{name}");
    }
    let meanings = file.comments.join("\n");
    assert!(meanings.contains("along the branch") && meanings.contains("stiffness at fixed contact area"));
    // Under forces the force has no error of its own; under approaches and along paths it may.
    assert!(file.column("force_error").is_err());
    let (_, file) = solved(dir.path(), &SPHERE.replace("force = [-0.03, 0, 0.1]", "approach = [-0.1, 0.1]"));
    assert!(file.column("force_error").is_ok());
    // At the pull-off under a prescribed approach, -3 a^2 with a^3 = pi w/8, the slope has no bound.
    let pull_off = -3.0 * (0.01 * std::f64::consts::PI / 8.0_f64).cbrt().powi(2);
    let (_, file) =
        solved(dir.path(), &SPHERE.replace("force = [-0.03, 0, 0.1]", &format!("approach = {pull_off:?}")));
    assert_eq!(file.numbers("stiffness").unwrap(), [None, None]);
    assert!(file.numbers("conductance").unwrap().iter().all(Option::is_some));
}

const ROUGH: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nmean_pressure = [1e-3, 1e-2]\n\
    [scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.8\nrms_height = 0.01\nroll_off_wavelength = 0.5\n\
    shortest_wavelength = 0.2\n[effects]\nboundary = \"periodic\"\n[outputs]\nstiffness = true\ngrid_error = true\n\
    stiffness_fixed_area = true\nconductance = { kind = \"electrical\", resistivities = [1, 3] }\n[models.bem3d]\n\
    cells = 64\n[sampling]\nseed = 5\n";

#[test]
fn the_conductance_has_the_error_of_the_stiffness_that_it_follows_from() {
    let dir = tempfile::tempdir().unwrap();
    let (_, file) = solved(dir.path(), ROUGH);
    let errors = ["stiffness", "stiffness_fixed_area", "conductance"]
        .map(|name| file.numbers(&format!("{name}_grid_error")).unwrap());
    let [along, held, conductance] = &errors;
    for ((along, held), conductance) in along.iter().zip(held).zip(conductance) {
        approx::assert_relative_eq!(along.unwrap(), held.unwrap(), max_relative = 1e-9);
        approx::assert_relative_eq!(held.unwrap(), conductance.unwrap(), max_relative = 1e-9);
    }
    // A conductance that is asked for alone has an error too.
    let alone = ROUGH.replace("stiffness = true\n", "").replace("stiffness_fixed_area = true\n", "");
    let (_, file) = solved(dir.path(), &alone);
    assert!(file.numbers("conductance_grid_error").unwrap().iter().all(Option::is_some));
    assert!(file.column("stiffness_grid_error").is_err());
    // So it may have an accuracy, which finds the grid that it finds for the stiffness.
    let cells = |text: &str| {
        let text = text
            .replace("[models.bem3d]\ncells = 64\n", "")
            .replace("contact_modulus", "accuracy = 0.2\ncontact_modulus");
        let scene = SceneFile::parse("scene.toml".as_ref(), text).unwrap();
        let options = Options { out: dir.path().join("pilot"), threads: 2, fresh: false };
        scene.with_grid_for_accuracy(&options, &Silent, &|| false).unwrap().models[0].size()
    };
    assert_eq!(cells(&alone), cells(ROUGH));
}

/// With free edges 37 of 54 errors held that were once claimed for it: 1.5 % where 102 % were true. With waves down
/// to the cell 36 % of 480 held.
#[test]
fn the_largest_pressure_has_a_grid_error_with_periodic_boundaries_and_resolved_waves_alone() {
    let dir = tempfile::tempdir().unwrap();
    let to_the_cell = ROUGH.replace("shortest_wavelength = 0.2\n", "");
    for (scene, has_limit) in
        [(ROUGH, true), (&ROUGH.replace("periodic", "free"), false), (&to_the_cell, false)]
    {
        let (_, file) = solved(dir.path(), scene);
        for end in ["error", "order"] {
            let found = file.numbers(&format!("largest_pressure_grid_{end}")).unwrap();
            assert!(has_limit || found.iter().all(Option::is_none), "{end}: {scene}");
        }
        assert!(file.comments.join("\n").contains("empty with free boundaries"));
        let known = |name: &str| file.numbers(name).unwrap().iter().all(Option::is_some);
        assert!(known("stiffness_grid_error"));
        assert_eq!(known("largest_pressure_grid_error"), has_limit);
    }
}
