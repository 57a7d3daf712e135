//! What a scene reads off the interface: leakage with its bounds, paths, and the stress below the surface.

use fractal_contact::bem3d::{Film, film_conductance};
use fractal_contact::interface::stress::von_mises;
use fractal_contact::interface::{
    FlowAxis, bracketed_force, conductance, gap_error, leakage, open_gap, percolation,
};
use fractal_contact::scenes::{Options, Plan, SceneFile, run};
use fractal_contact::{Bem3d, Boundary, ContactModel, Error, Field, Load, Scene, Surface, never};
use runs::{CsvFile, Silent};
use std::path::Path;

/// Runs a scene without units in a folder, and reads its results.
fn results(directory: &Path, text: &str) -> CsvFile {
    std::fs::create_dir_all(directory).unwrap();
    let path = directory.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = SceneFile::read(&path).unwrap();
    let options = Options { out: directory.join("out"), threads: 2, fresh: false };
    let outcome = run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &|| false).unwrap();
    assert_eq!((outcome.failed, outcome.stopped), (0, false));
    CsvFile::read(&directory.join("out/results.csv")).unwrap()
}

fn column(results: &CsvFile, name: &str) -> Vec<f64> {
    results.numbers(name).unwrap().into_iter().map(Option::unwrap).collect()
}

const ROUGH: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nmean_pressure = [0.01, 0.1]\n\
    [scene.surface]\nkind = \"self_affine\"\nhurst = 0.8\nroll_off_wavelength = 0.25\nside = 1\nrms_height = 0.01\n\
    [sampling]\nseed = 7\n[models.bem3d]\ncells = 64\n[effects]\nboundary = \"periodic\"\n\
    [outputs]\nmean_gap = true\narea = true\nleakage = { viscosity = 2, pressure_drop = 24, along = \"x\" }\npercolation = true\n";

/// The flow of a scene is that of the gap which the library finds, with 0 in contact; its bounds enclose it,
/// and more load lets less through.
#[test]
fn a_scene_leaks_as_its_gap_does() {
    let directory = tempfile::tempdir().unwrap();
    let found = results(directory.path(), ROUGH);
    let scene = SceneFile::read(&directory.path().join("scene.toml")).unwrap();
    let model = scene.models[0].model();
    let physics = scene.scene(&scene.models[0], scene.seed(0)).unwrap();
    let mut contact = model.prepare(&physics, scene.seed(0)).unwrap();
    let flow = column(&found, "leakage");
    for (i, pressure) in [0.01, 0.1].into_iter().enumerate() {
        let state = contact.solve(Load::force(pressure)).unwrap();
        let cells = state.gap().unwrap().values().iter().zip(state.pressure().unwrap().values());
        let open = cells.map(|(g, p)| if *p > 0.0 { 0.0 } else { g.max(0.0) }).collect();
        let gap = Field::new(64, 1.0, open).unwrap();
        // 24/(12 x 2) = 1.
        let leak = leakage(&gap, FlowAxis::X, Boundary::Periodic).unwrap();
        let flows = (flow[i], leak.network.middle());
        assert!((flows.0 - flows.1).abs() <= 1e-9 * flows.0, "{flows:?}");
        let [lower, upper] = ["leakage_lower", "leakage_upper"].map(|name| column(&found, name)[i]);
        // The harmonic network underestimates the continuum.
        assert!(flow[i] <= lower * (1.0 + 1e-9) && lower <= upper, "{} {lower} {upper}", flow[i]);
        assert!(column(&found, "leakage_error")[i] < 1e-10);
        let smooth = leak.mean_gap.powi(3);
        assert!((column(&found, "flow_factor")[i] - flow[i] / smooth).abs() <= 1e-9 * flow[i] / smooth);
        let open = column(&found, "open_along_x")[i] > 0.5;
        assert_eq!(open, flow[i] > 0.0);
        assert_eq!(open, column(&found, "constriction_x")[i] > 0.0);
        let place = |name: &str| found.numbers(name).unwrap()[i].map(|place| (place * 64.0) as usize);
        let [x, y] = ["constriction_x_at_x", "constriction_x_at_y"].map(place);
        assert_eq!(open, x.is_some());
        if let Some((x, y)) = x.zip(y) {
            assert!((gap.at(x, y) - column(&found, "constriction_x")[i]).abs() < 1e-9);
        }
    }
    assert!(flow[0] > flow[1]);
}

/// Hertz: 0.62 of the largest pressure at 0.48 of the radius, below the middle (nu = 0.3).
#[test]
fn the_largest_stress_below_a_ball() {
    let ball = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nbodies = [\"rigid\", { young = 0.91, poisson = 0.3 }]\n\
        force = 0.0013333333333333\n[scene.body]\nkind = \"sphere\"\nradius = 1\nside = 0.3\n[models.bem3d]\ncells = 129\n\
        [outputs]\nstress_below = { depths = [0.02, 0.04, 0.06, 0.08], yield_stress = 0.02 }\n";
    let directory = tempfile::tempdir().unwrap();
    let found = results(directory.path(), ball);
    let number = |name: &str| column(&found, name)[0];
    // E* = 1, a = 0.1, p0 = 2 E* a/(pi R).
    let (radius, pressure) = (0.1, 0.2 / std::f64::consts::PI);
    let [stress, depth] = ["largest_von_mises", "largest_von_mises_depth"].map(number);
    assert!((stress / pressure - 0.62004).abs() < 1e-3, "{}", stress / pressure);
    assert!((depth / radius - 0.48086).abs() < 3e-3, "{}", depth / radius);
    for name in ["largest_von_mises_x", "largest_von_mises_y"] {
        assert!((number(name) - 0.15).abs() < 1e-9);
    }
    assert!((number("factor_until_yield") - 0.02 / stress).abs() < 1e-12);
}

/// A ball yields where 0.62 of its largest pressure is the yield stress: F = (p0 pi R)^3/(6 E*^2 R) with nu = 0.3.
#[test]
fn the_load_of_first_yield() {
    let ball = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nbodies = [\"rigid\", { young = 0.91, poisson = 0.3 }]\n\
        force = [1e-3, 2e-3]\n[scene.body]\nkind = \"sphere\"\nradius = 1\nside = 0.3\n[models.bem3d]\ncells = 65\n\
        [outputs]\nstress_below = { depths = [0.02, 0.04, 0.06, 0.08], yield_stress = 0.04 }\nthresholds = 1e-3\n";
    let directory = tempfile::tempdir().unwrap();
    results(directory.path(), ball);
    let table = CsvFile::read(&directory.path().join("out/thresholds.csv")).unwrap();
    let [before, after] =
        ["force_before", "force_after"].map(|name| table.numbers(name).unwrap()[0].unwrap());
    // E* = 1.
    let exact = (0.04 / 0.62004 * std::f64::consts::PI).powi(3) / 6.0;
    assert!(after - before <= 1e-3 * after, "{before} {after}");
    // The error of 65 cells on the stress, three times over in the force.
    assert!((before / exact - 1.0).abs() < 0.01, "{before} {after} {exact}");
    let summary = std::fs::read_to_string(directory.path().join("out/report.html")).unwrap();
    assert!(summary.contains("the body yields first at a force between"));
}

/// The volume of all components: its layer at the depth of the largest stress has that stress, and its files are those
/// of a box.
#[test]
fn all_components_in_layers() {
    let ball = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nbodies = [\"rigid\", { young = 0.91, poisson = 0.3 }]\n\
        force = 0.0013333333333333\n[scene.body]\nkind = \"sphere\"\nradius = 1\nsize = [0.3, 0.2]\n[models.bem3d]\ncells = 48\n\
        [outputs]\nstress_volume = [\"npy\", \"vti\"]\nstress_below = { depths = [0.048, 0.096], layers = 12 }\n";
    let directory = tempfile::tempdir().unwrap();
    let found = results(directory.path(), ball);
    let largest = column(&found, "largest_von_mises")[0];
    let file = |ending: &str| {
        std::fs::read(directory.path().join(format!("out/stress_volume-bem3d-0-000.{ending}"))).unwrap()
    };
    let npy = file("npy");
    let (layers, rows, columns) = (12, 32, 48);
    assert!(String::from_utf8_lossy(&npy).contains("'shape': (6, 12, 32, 48)"));
    let cells = rows * columns;
    let numbers = npy[npy.len() - 8 * 6 * layers * cells..].as_chunks().0.iter();
    let values: Vec<f64> = numbers.map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let at = |layer: usize, cell: usize| {
        std::array::from_fn(|component| values[(component * layers + layer) * cells + cell])
    };
    let stress = |layer: usize| (0..cells).map(|cell| von_mises(&at(layer, cell))).fold(0.0_f64, f64::max);
    let most = (0..layers).map(stress).fold(0.0, f64::max);
    // Layers are 0.008 thick: the largest stress lies between their middles.
    assert!(most <= largest * (1.0 + 1e-9) && most > 0.99 * largest, "{most} {largest}");
    // Under the middle the pressure pushes down and the shear stresses vanish.
    let [xx, yy, zz, yz, xz, _]: [f64; 6] = at(0, 16 * columns + 24);
    assert!(zz < 0.0 && xx < 0.0 && yy < 0.0 && yz.abs().max(xz.abs()) < 0.1 * zz.abs());
    let vti = String::from_utf8_lossy(&file("vti")).into_owned();
    for part in
        ["WholeExtent=\"0 48 0 32 0 12\"", "0.00625 0.008\"", "Name=\"stress_xx\"", "Name=\"stress_xy\""]
    {
        assert!(vti.contains(part), "{part}: {}", &vti[..400]);
    }
}

/// A path that is interrupted goes on to the same numbers.
#[test]
fn a_path_leaks_too() {
    let path = ROUGH
        .replace("mean_pressure = [0.01, 0.1]\n", "")
        .replace("[sampling]", "[[scene.path]]\nforce = 0.05\n[[scene.path]]\nforce = 0.01\n[sampling]");
    let path = path.replace("boundary = \"periodic\"", "boundary = \"periodic\"\nhardness = 0.2");
    let directory = tempfile::tempdir().unwrap();
    let flow = column(&results(directory.path(), &path), "leakage");
    assert!(flow[1] > flow[0] && flow[0] > 0.0, "{flow:?}");
}

/// The load at which the gap closes lies between two states, and a bracket that is refined lies inside.
#[test]
fn the_gap_closes_between_two_loads() {
    let directory = tempfile::tempdir().unwrap();
    let text = ROUGH.replace("[0.01, 0.1]", "[0.1, 0.01, 0.03]");
    results(directory.path(), &text);
    let table = CsvFile::read(&directory.path().join("out/thresholds.csv")).unwrap();
    let [before, after] =
        ["force_before", "force_after"].map(|name| table.numbers(name).unwrap()[0].unwrap());
    assert!(before < after && after <= 0.1, "{before} {after}");
    let scene = SceneFile::read(&directory.path().join("scene.toml")).unwrap();
    let physics = scene.scene(&scene.models[0], scene.seed(0)).unwrap();
    let mut contact = scene.models[0].model().prepare(&physics, scene.seed(0)).unwrap();
    let is_closed = |state: &fractal_contact::ContactState| {
        Ok(!percolation(&open_gap(state)?, 0.0, FlowAxis::X, Boundary::Periodic)?.spans)
    };
    let found = bracketed_force(contact.as_mut(), [before, after], 0.01, &never, is_closed).unwrap();
    assert!(before <= found[0] && found[1] <= after && found[1] - found[0] <= 0.01 * found[1]);
    // A scene refines it too, whatever it prescribes.
    let width = "percolation = true\nthresholds = 0.01\n";
    for (name, text) in [
        ("force", text.replace("percolation = true\n", width)),
        (
            "gap",
            text.replace("mean_pressure = [0.1, 0.01, 0.03]", "mean_gap = [0.02, 0.003, 0.008]")
                .replace("percolation = true\n", width),
        ),
    ] {
        results(&directory.path().join(name), &text);
        let table = CsvFile::read(&directory.path().join(name).join("out/thresholds.csv")).unwrap();
        let ends = |kind: &str| {
            ["before", "after"].map(|end| table.numbers(&format!("{kind}_{end}")).unwrap()[0].unwrap())
        };
        let (prescribed, forces) = (ends("prescribed"), ends("force"));
        let width = (prescribed[1] - prescribed[0]).abs();
        assert!(width > 0.0 && width <= 0.01 * prescribed[0].max(prescribed[1]), "{name} {prescribed:?}");
        assert_eq!(prescribed[0] < prescribed[1], name == "force", "a gap falls");
        // The same threshold, as far as the brackets say.
        assert!(forces[0] < found[1] && found[0] < forces[1], "{name} {forces:?} {found:?}");
    }
    let wrong = bracketed_force(contact.as_mut(), [after, 2.0 * after], 0.01, &never, is_closed);
    assert!(matches!(wrong, Err(Error::Domain { .. })), "{wrong:?}");
}

/// The gap of a solve with a large tolerance is as near to that of one with a small tolerance as its error says.
#[test]
fn the_error_of_the_gap_holds() {
    let heights = fractal_contact::surface_gen::height_map(
        &Surface::SelfAffine(fractal_contact::SelfAffine::new(2.2, 1.0, 0.01).unwrap()),
        64,
        5,
    )
    .unwrap();
    let mut scene = Scene::new(Surface::Heights(heights), 1.0);
    (scene.outputs.gap, scene.outputs.pressure, scene.outputs.stiffness) = (true, true, false);
    let mut largest = 0.0_f64;
    for boundary in [Boundary::Free, Boundary::Periodic, Boundary::PeriodicAlongX] {
        scene.effects.boundary = boundary;
        for load in [Load::force(0.003), Load::force(0.03), Load::approach(0.02)] {
            if boundary != Boundary::Free && load == Load::approach(0.02) {
                continue;
            }
            let exact = Bem3d { tolerance: 1e-12, ..Bem3d::default() };
            let exact = exact.prepare(&scene, 0).unwrap().solve(load).unwrap();
            for tolerance in [0.1, 1e-2, 1e-3, 1e-4] {
                let rough = Bem3d { tolerance, ..Bem3d::default() };
                let state = rough.prepare(&scene, 0).unwrap().solve(load).unwrap();
                let bound = gap_error(&state, load.normal).unwrap().unwrap();
                let gaps = state.gap().unwrap().values().iter().zip(exact.gap().unwrap().values());
                let error = gaps.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(error <= bound + 1e-12, "{boundary:?} {load:?} {tolerance}: {error} {bound}");
                largest = largest.max(error / bound);
            }
        }
    }
    // The bound is not far from what happens.
    assert!(largest > 0.2, "{largest}");
}

/// The law of the interface has the numbers of the states in the order of growing pressures, per nominal area, and
/// a second run into the same folder replaces it.
#[test]
fn the_law_has_the_numbers_of_the_states() {
    let directory = tempfile::tempdir().unwrap();
    let text = ROUGH
        .replace("[0.01, 0.1]", "[0.1, 0.01]")
        .replace("mean_gap = true", "law = true\nstiffness = true");
    // The area of the square is 4.
    let text = text.replace("side = 1\n", "side = 2\n");
    let states = results(directory.path(), &text);
    let law = CsvFile::read(&directory.path().join("out/law.csv")).unwrap();
    for (here, there) in [(0, 1), (1, 0)] {
        for (of_law, of_state, area) in [
            ("mean_pressure", "force", 4.0),
            ("mean_gap", "mean_gap", 1.0),
            ("contact_fraction", "contact_fraction", 1.0),
            ("stiffness_per_area", "stiffness", 4.0),
            ("flow_factor", "flow_factor", 1.0),
        ] {
            let [law, state] = [column(&law, of_law)[here], column(&states, of_state)[there] / area];
            assert!((law - state).abs() <= 1e-12 * state.abs(), "{of_law}: {law} {state}");
        }
        let error = column(&law, "stiffness_per_area_error")[here];
        let state = column(&states, "stiffness")[there] * column(&states, "stiffness_error")[there] / 4.0;
        assert!((error - state).abs() <= 1e-12 * state, "{error} {state}");
    }
    let without = text.replace("law = true\n", "");
    results(directory.path(), &without);
    assert!(!directory.path().join("out/law.csv").exists());
}

/// The field of the stress has the largest one where the columns say, and states whose depths end too early and
/// fluids that would lift the bodies have notes.
#[test]
fn the_field_of_the_stress_and_the_notes() {
    let ball = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nbodies = [\"rigid\", { young = 0.91, poisson = 0.3 }]\n\
        force = 0.0013\n[scene.body]\nkind = \"sphere\"\nradius = 1\nside = 0.3\n[models.bem3d]\ncells = 65\n\
        [outputs]\nstress_below = { depths = [0.01, 0.02] }\nvon_mises = \"npy\"\n";
    let directory = tempfile::tempdir().unwrap();
    let found = results(directory.path(), ball);
    let file = directory.path().join("out/von_mises-bem3d-0-000.npy");
    let values = std::fs::read(file).unwrap();
    let values =
        values[values.len() - 8 * 65 * 65..].chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap()));
    let largest = values.fold(0.0_f64, f64::max);
    assert!((largest / column(&found, "largest_von_mises")[0] - 1.0).abs() < 1e-12);
    assert!(found.texts("note").unwrap()[0].contains("largest stress at an end of the depths"));
    let deep = ball.replace("[0.01, 0.02]", "[0.01, 0.03, 0.05, 0.1]");
    assert!(!results(directory.path(), &deep).texts("note").unwrap()[0].contains("depths"));
    let lifted = results(directory.path(), ROUGH);
    assert!(lifted.texts("note").unwrap()[0].contains("fluid pressure not small beside the mean pressure"));
}

/// A film adds to the conductance of the contact: of the interface per area where the map repeats, of the sample where
/// it ends.
#[test]
fn a_scene_conducts_through_its_film() {
    let directory = tempfile::tempdir().unwrap();
    let outputs = "conductance = { kind = \"electrical\", resistivities = [0.4, 0.6] }\nfilm = { resistivity = 50, along = \"y\" }\n";
    let periodic =
        ROUGH.split("[outputs]").next().unwrap().to_owned() + "[outputs]\ngap = [\"npy\"]\n" + outputs;
    for (boundary, name) in [("periodic", "film_conductance_per_area"), ("free", "film_conductance")] {
        let text = periodic.replace("\"periodic\"", &format!("\"{boundary}\""));
        let found = results(directory.path(), &text);
        let scene = SceneFile::read(&directory.path().join("scene.toml")).unwrap();
        let physics = scene.scene(&scene.models[0], scene.seed(0)).unwrap();
        let mut contact = scene.models[0].model().prepare(&physics, scene.seed(0)).unwrap();
        for (i, pressure) in [0.01, 0.1].into_iter().enumerate() {
            let gap = open_gap(&contact.solve(Load::force(pressure)).unwrap()).unwrap();
            let film = Film { resistivity: 50.0, bodies: 1.0 };
            let through = film_conductance(&gap, film, physics.effects.boundary).unwrap().middle();
            assert!((column(&found, name)[i] / through - 1.0).abs() < 1e-6);
            // More than the contact alone, and both grow with the load.
            assert!(through > column(&found, "conductance")[i]);
            assert!(column(&found, "film_conductance_error")[i] < 1e-8);
            let sheet = gap.values().iter().map(|g| g / 50.0).collect();
            let sheet = Field::new(64, 1.0, sheet).unwrap();
            let along = conductance(&sheet, FlowAxis::Y, physics.effects.boundary).unwrap().network.middle();
            assert!((column(&found, "film_conductance_along")[i] - along).abs() <= 1e-8 * along);
        }
        assert!(column(&found, name)[0] < column(&found, name)[1]);
        assert!(column(&found, "film_conductance_along")[0] > column(&found, "film_conductance_along")[1]);
        std::fs::remove_dir_all(directory.path().join("out")).unwrap();
    }
}

/// Leakage and stress of the same load on coarser grids give the error of the grid of both.
#[test]
fn grids_are_compared_in_leakage_and_stress() {
    let directory = tempfile::tempdir().unwrap();
    let asked = "grid_error = true\nstress_below = { depths = [0.05, 0.1] }\n";
    let text =
        ROUGH.replace("contact_modulus = 1", "bodies = [\"rigid\", { young = 0.75, poisson = 0.5 }]") + asked;
    let fine = results(directory.path(), &text);
    std::fs::remove_dir_all(directory.path().join("out")).unwrap();
    let on = |cells: &str| {
        let text = text.replace("cells = 64", cells).replace("grid_error = true\n", "");
        let found = results(directory.path(), &text);
        std::fs::remove_dir_all(directory.path().join("out")).unwrap();
        found
    };
    let (half, quarter) = (on("cells = 32"), on("cells = 16"));
    for name in ["leakage", "flow_factor", "largest_von_mises", "mean_gap"] {
        let errors = fine.numbers(&format!("{name}_grid_error")).unwrap();
        for (i, error) in errors.into_iter().enumerate() {
            let [fine, half, quarter] = [&fine, &half, &quarter].map(|on| column(on, name)[i]);
            let expected = analysis::grid_error(fine, half, quarter).map(|found| found.error);
            let same = match (error, expected) {
                (Some(a), Some(b)) => (a - b).abs() <= 1e-4 * b,
                (a, b) => a.is_none() && b.is_none(),
            };
            assert!(same, "{name} {error:?} {expected:?}");
        }
    }
}

/// A section passes through the largest stress, has the surface in its first row and the stress of the library.
#[test]
fn a_section_through_the_largest_stress() {
    let ball = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nbodies = [\"rigid\", { young = 0.91, poisson = 0.3 }]\n\
        force = 0.0013333333333333\n[scene.body]\nkind = \"sphere\"\nradius = 1\nsize = [0.3, 0.2]\n[models.bem3d]\ncells = 96\n\
        [outputs]\nstress_section = [\"npy\", \"png\", \"vti\"]\nstress_below = { depths = [0.02, 0.04, 0.06, 0.16], section = \"y\" }\n";
    let directory = tempfile::tempdir().unwrap();
    let found = results(directory.path(), ball);
    let largest = column(&found, "largest_von_mises")[0];
    let depth = column(&found, "largest_von_mises_depth")[0];
    let file = |ending: &str| {
        std::fs::read(directory.path().join(format!("out/stress_section-bem3d-0-000.{ending}")))
    };
    let npy = file("npy").unwrap();
    assert!(String::from_utf8_lossy(&npy).contains("'shape': (64, 64)"));
    let values: Vec<f64> =
        npy[npy.len() - 8 * 64 * 64..].as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let most = values.iter().copied().fold(0.0, f64::max);
    let row = values.iter().position(|v| (v - most).abs() < 1e-15).unwrap() / 64;
    assert!((most / largest - 1.0).abs() < 1e-3 && most <= largest * (1.0 + 1e-9), "{most} {largest}");
    // Rows are 0.16/64 apart.
    assert!(((row as f64 + 0.5) * 0.0025 - depth).abs() < 0.003, "{row} {depth}");
    assert!(file("png").is_ok());
    let vti = String::from_utf8_lossy(&file("vti").unwrap()).into_owned();
    assert!(
        vti.contains("WholeExtent=\"0 64 0 64 0 0\"") && vti.contains("Spacing=\"0.003125 0.0025"),
        "{}",
        &vti[..300]
    );
    let report = std::fs::read_to_string(directory.path().join("out/report.html")).unwrap();
    assert!(report.contains("Von Mises stress in a section"));
}
