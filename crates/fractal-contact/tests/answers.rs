//! What a user reads beside the numbers: warnings with remedies, means over surfaces, the map as it was
//! solved.

use fractal_contact::scenes::{Options, Plan, SceneFile, SceneOutcome, run};
use runs::{CsvFile, Silent};
use std::path::Path;

/// Runs a scene in a folder; its results are in `out`.
fn run_scene(directory: &Path, text: &str) -> SceneOutcome {
    let path = directory.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = SceneFile::read(&path).unwrap();
    let options = Options { out: directory.join("out"), threads: 2, fresh: false };
    run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &|| false).unwrap()
}

fn results(directory: &Path, file: &str) -> CsvFile {
    CsvFile::read(&directory.join("out").join(file)).unwrap()
}

const MAP: &str = "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"100 GPa\"\nforce = \"FORCE\"\n\
    [scene.surface]\nkind = \"file\"\npath = \"map.csv\"\nunit = \"nm\"\ncell = \"1 um\"\n[outputs]\narea = true\n";

/// A wavy map of 40 x 30 cells, in nm, with something added.
fn write_map(directory: &Path, more: impl Fn(usize, usize) -> f64) {
    write_map_of(directory, 1, more);
}

/// The same waves with this many times as many cells a side.
fn write_map_of(directory: &Path, finer: usize, more: impl Fn(usize, usize) -> f64) {
    let height = |x: usize, y: usize| {
        let [x, y] = [x, y].map(|place| place as f64 / finer as f64);
        100.0 * ((x * 0.5).sin() * (y * 0.4).cos() + 0.3 * (x * 1.3 + y * 1.7).sin())
    };
    let row = |y: usize| {
        let heights = (0..40 * finer).map(|x| format!("{:.3}", height(x, y) + more(x, y)));
        heights.collect::<Vec<_>>().join(",") + "\n"
    };
    std::fs::write(directory.join("map.csv"), (0..30 * finer).map(row).collect::<String>()).unwrap();
}

#[test]
fn the_former_name_of_the_contact_modulus_is_read_with_a_note() {
    let read = |text: String| SceneFile::parse(Path::new("scene.toml"), text).unwrap();
    let (former, present) = (read(WAVES.replace("contact_modulus", "modulus")), read(WAVES.to_owned()));
    assert_eq!(former.contact_modulus.to_bits(), present.contact_modulus.to_bits());
    let notes = |scene: &SceneFile| scene.notes.iter().map(ToString::to_string).collect::<String>();
    assert!(!notes(&present).contains("modulus"), "{}", notes(&present));
    assert_eq!(
        notes(&former).matches("`modulus` is read as `contact_modulus`, which is E* of the pair").count(),
        1
    );
    // Both at once is a mistake, and so is a misspelt one, whose right name is recommended.
    let mistake = |text: String| SceneFile::parse(Path::new("scene.toml"), text).unwrap_err().to_string();
    let both = mistake(WAVES.replace("contact_modulus", "modulus = 2\ncontact_modulus"));
    assert!(both.contains("`contact_modulus` and `modulus` are both given"), "{both}");
    let misspelt = mistake(WAVES.replace("contact_modulus", "modulous"));
    assert!(misspelt.contains("contact_modulus"), "{misspelt}");
}

/// What is added to a map.
type More<'a> = &'a dyn Fn(usize, usize) -> f64;

#[test]
fn traps_are_named_with_a_remedy() {
    let spike = |x: usize, y: usize| if (x, y) == (20, 15) { 3000.0 } else { 0.0 };
    let tilt = |x: usize, _: usize| 30.0 * x as f64;
    let none = |_: usize, _: usize| 0.0;
    let cases: [(More<'_>, &str, &[&str], &[&str]); 4] = [
        (&none, "30 mN", &[], &["one cell", "few"]),
        (&spike, "1 mN", &["one cell carries most of the load", "fewer than 10", "above the hardness"], &[]),
        (&tilt, "1 mN", &["contact at the edge of the rectangle"], &["hardness"]),
        (&none, "20 N", &["above the hardness"], &["fewer than 10"]),
    ];
    for (i, (more, force, said, silent)) in cases.into_iter().enumerate() {
        let dir = tempfile::tempdir().unwrap();
        write_map(dir.path(), more);
        // 1 mN on a cell of 1 um^2 are 1 GPa: above a given hardness, below E*/10.
        let hard = if i == 1 { "hardness = \"0.5 GPa\"\nforce" } else { "force" };
        let outcome = run_scene(dir.path(), &MAP.replace("force", hard).replace("FORCE", force));
        let file = results(dir.path(), "results.csv");
        let note = file.texts("note").unwrap()[0];
        for words in said {
            assert!(note.contains(words), "{i}: {note}");
        }
        // Each has a sentence that says where, what and what to do.
        let sentences = outcome.notes.iter().filter(|line| line.starts_with("In this state "));
        assert!(sentences.clone().count() >= said.len(), "{i}: {:?}", outcome.notes);
        assert!(sentences.clone().all(|line| line.matches(". ").count() >= 1), "{i}: {:?}", outcome.notes);
        let all = outcome.notes.concat();
        for sentence in sentences_of(i) {
            assert!(all.contains(sentence), "{i}: {sentence} in {all}");
        }
        for words in silent {
            assert!(!note.contains(words), "{i}: {note}");
        }
    }
}

/// What a run says of the traps above.
fn sentences_of(case: usize) -> &'static [&'static str] {
    match case {
        1 => &[
            "In this state fewer than 10 cells are in contact. ",
            "In this state one cell carries most of the load. ",
            "In this state the pressure is above the hardness of 500 MPa (it reaches ",
        ],
        2 => &["In this state cells at the edge of the rectangle are in contact. "],
        3 => &["In this state the pressure is above a tenth of E*, 10 GPa (it reaches "],
        _ => &[],
    }
}

#[test]
fn a_tilt_that_decides_is_told_unless_the_scene_says_what_to_do() {
    let dir = tempfile::tempdir().unwrap();
    write_map(dir.path(), |x, _| 30.0 * x as f64);
    let notes = |text: &str| {
        std::fs::write(dir.path().join("scene.toml"), text).unwrap();
        let scene = SceneFile::read(&dir.path().join("scene.toml")).unwrap();
        scene.notes.iter().map(ToString::to_string).collect::<String>()
    };
    let text = MAP.replace("FORCE", "1 mN");
    assert!(notes(&text).contains("the map is tilted") && notes(&text).contains("`detrend = \"plane\"`"));
    for detrend in ["plane", "none"] {
        assert_eq!(notes(&text.replace("unit =", &format!("detrend = \"{detrend}\"\nunit ="))), "");
    }
    write_map(dir.path(), |_, _| 0.0);
    assert_eq!(notes(&text), "");
}

#[test]
fn several_surfaces_have_a_mean_and_theories_one_surface() {
    let dir = tempfile::tempdir().unwrap();
    let text = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\", \"persson\"]\ncontact_modulus = 1\nmean_pressure = [1e-4, 1e-3]\n\
        [scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.7\nrms_height = 0.01\n\
        roll_off_wavelength = 0.5\nshortest_wavelength = 0.1\n[effects]\nboundary = \"periodic\"\n\
        [outputs]\nstiffness = true\narea = true\ncurves = true\nheights = [\"npy\"]\n[models.bem3d]\ncells = 32\n\
        [sampling]\nseed = 5\nsurfaces = 3\n";
    let outcome = run_scene(dir.path(), text);
    assert_eq!((outcome.requested, outcome.states, outcome.not_attempted()), (8, 8, 0));
    let (file, means) = (results(dir.path(), "results.csv"), results(dir.path(), "ensemble.csv"));
    assert_eq!(file.texts("model").unwrap().iter().filter(|m| **m == "persson").count(), 2);
    let k = file.numbers("stiffness").unwrap();
    let of_first: Vec<f64> = (0..3).map(|surface| k[2 * surface].unwrap()).collect();
    let mean = of_first.iter().sum::<f64>() / 3.0;
    let deviation = (of_first.iter().map(|k| (k - mean).powi(2)).sum::<f64>() / 2.0).sqrt();
    let at = |name: &str, row: usize| means.numbers(name).unwrap()[row];
    assert_eq!(means.rows.len(), 4);
    approx::assert_relative_eq!(at("stiffness", 0).unwrap(), mean, max_relative = 1e-12);
    approx::assert_relative_eq!(at("stiffness_sd", 0).unwrap(), deviation, max_relative = 1e-12);
    approx::assert_relative_eq!(
        at("stiffness_se", 0).unwrap(),
        deviation / 3f64.sqrt(),
        max_relative = 1e-12
    );
    assert_eq!((at("surfaces", 0), at("surfaces", 2), at("stiffness_se", 2)), (Some(3.0), Some(1.0), None));
    assert!(outcome.summary.contains("stiffness") && outcome.summary.contains(" +- "), "{}", outcome.summary);
    let drawn = std::fs::read_to_string(dir.path().join("out/curve-stiffness.svg")).unwrap();
    assert!(drawn.contains("95 % interval by Student") && drawn.contains("t with 2 degrees of freedom"));
    // The map of each surface, once.
    let maps = std::fs::read_dir(dir.path().join("out")).unwrap().flatten();
    let maps: Vec<_> = maps.filter(|e| e.file_name().to_string_lossy().starts_with("heights-")).collect();
    assert_eq!(maps.len(), 3);
}

const WAVES: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nmean_pressure = [1e-3, 1e-2]\n\
    [scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.8\nrms_height = 0.01\nroll_off_wavelength = 0.5\n\
    shortest_wavelength = 0.2\n[effects]\nboundary = \"periodic\"\n[outputs]\nstiffness = true\narea = true\n\
    [models.bem3d]\ncells = 64\n[sampling]\nseed = 5\n";

#[test]
fn the_error_of_the_grid_is_that_of_three_grids() {
    let dir = tempfile::tempdir().unwrap();
    let on = |cells: usize, name: &str| {
        run_scene(dir.path(), &WAVES.replace("cells = 64", &format!("cells = {cells}")));
        results(dir.path(), "results.csv").numbers(name).unwrap()
    };
    for name in ["stiffness", "area", "area_corrected", "largest_pressure"] {
        let [fine, half, quarter] = [64, 32, 16].map(|cells| on(cells, name));
        run_scene(dir.path(), &WAVES.replace("area = true", "area = true\ngrid_error = true"));
        let file = results(dir.path(), "results.csv");
        for i in 0..2 {
            let column = |end: &str| file.numbers(&format!("{name}_grid_{end}")).unwrap()[i];
            let mut expected =
                analysis::grid_error(fine[i].unwrap(), half[i].unwrap(), quarter[i].unwrap()).unwrap();
            if name == "area" {
                // At least what the correction takes away.
                let corrected = file.numbers("area_corrected").unwrap()[i].unwrap();
                expected.error = expected.error.max(1.0 - corrected / fine[i].unwrap());
            }
            // Starts of the solver differ between the runs: numbers agree within its tolerance of 1e-6.
            approx::assert_relative_eq!(column("error").unwrap(), expected.error, epsilon = 1e-5);
            assert_eq!(column("order").is_some(), expected.order.is_some());
        }
        assert!(file.numbers("rms_slope_grid_error").unwrap().iter().all(|e| e.unwrap() < 0.05));
    }
}

#[test]
fn an_accuracy_chooses_the_grid() {
    let dir = tempfile::tempdir().unwrap();
    let read = |text: &str| {
        let path = dir.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let options = Options { out: dir.path().join("pilot"), threads: 2, fresh: false };
        SceneFile::read(&path)
            .and_then(|scene| scene.with_grid_for_accuracy(&options, &Silent, &contact_model::never))
    };
    let asked = |accuracy: &str| {
        WAVES.replace("\n[models.bem3d]\ncells = 64", "").replace("contact_modulus", accuracy)
    };
    let scene = read(&asked("accuracy = \"4 %\"\ncontact_modulus")).unwrap();
    let cells = |scene: &SceneFile| scene.models[0].size();
    assert_eq!(cells(&scene), 256);
    assert!(
        cells(&scene) < cells(&read(&asked("accuracy = 0.02\nbudget = \"1 h\"\ncontact_modulus")).unwrap())
    );
    let notes: String = scene.notes.iter().map(ToString::to_string).collect();
    assert!(notes.contains("accuracy of 4.000 %: bem3d on "), "{notes}");
    // The run says what it came to; one that misses it says so.
    let options = Options { out: dir.path().join("out"), threads: 1, fresh: false };
    let answer = |scene: &SceneFile| {
        let outcome = run(scene, &Plan::new(scene).unwrap(), &options, &Silent, &|| false).unwrap();
        let error = results(dir.path(), "results.csv").numbers("stiffness_grid_error").unwrap();
        (outcome.notes.join("\n"), error[0].unwrap().max(error[1].unwrap()))
    };
    let (notes, error) = answer(&scene);
    assert!(error < 0.04 && !notes.contains("accuracy is not reached"), "{error} {notes}");
    let mut missed = scene.clone();
    missed.accuracy.as_mut().unwrap().target.share = 1e-6;
    assert!(answer(&missed).0.contains("In all 2 states the requested accuracy is not reached."));
    // Of a given map every so many-th cell; never more than there are.
    write_map_of(dir.path(), 8, |_, _| 0.0);
    let map = |accuracy: &str| {
        let accuracy = format!("accuracy = \"{accuracy}\"\nmodels");
        MAP.replace("FORCE", "5 N").replace("models", &accuracy).replace("1 um", "125 nm")
    };
    let coarse = read(&map("60 %")).unwrap();
    assert!(coarse.surface.describe(coarse.system).contains("a map of 160 x 120 cells"));
    // The best is all cells, where the budget allows them; the run does not call it missed.
    let best = read(&map("best")).unwrap();
    let all = read(&map("best").replace("accuracy = \"best\"\n", "")).unwrap();
    assert_eq!(best.surface.describe(best.system), all.surface.describe(all.system));
    let notes: String = best.notes.iter().map(ToString::to_string).collect();
    assert!(notes.contains("the best accuracy within the budget and the memory: bem3d on "), "{notes}");
    let outcome = run(&best, &Plan::new(&best).unwrap(), &options, &Silent, &|| false).unwrap();
    assert!(!outcome.notes.join("\n").contains("accuracy is not reached"), "{outcome:?}");
    std::fs::write(dir.path().join("one.csv"), "1.0\n").unwrap();
    for (text, words) in [
        (map("1 %").replace("map.csv", "one.csv"), "the map's own cells are too few to compare"),
        (map("0.01 %"), "accuracy of 0.01000 %: the map's own cells have an error of "),
        (map("0.01 %"), "(`area_corrected` under force 5 N)"),
        (asked("accuracy = 0.002\nbudget = \"1 us\"\ncontact_modulus"), "and the budget is under 1 ms"),
        (
            asked("accuracy = 0.0001\nbudget = \"2 s\"\ncontact_modulus"),
            " cells along the longer side have an error of ",
        ),
        (asked("budget = \"1 s\"\ncontact_modulus"), "`budget` is given, but no `accuracy`"),
        (asked("memory = \"1 GB\"\ncontact_modulus"), "`memory` is given, but no `accuracy`"),
        (asked("accuracy = 0.1\nmemory = 4\ncontact_modulus"), "expected an amount of memory above 0"),
        (asked("accuracy = 0.1\nmemory = \"4 g\"\ncontact_modulus"), "MB, GB or TB, such as \"4 GB\""),
        (
            asked("accuracy = 0.0001\nmemory = \"20 MB\"\ncontact_modulus"),
            "512 cells along the longer side need up to 61 MB, and the `memory` is 20 MB",
        ),
        (asked("accuracy = \"100 %\"\ncontact_modulus"), "expected a share above 0 and below 100 %"),
        (asked("accuracy = \"few\"\ncontact_modulus"), "expected a pure number"),
        (
            WAVES.replace("contact_modulus", "accuracy = 0.01\ncontact_modulus"),
            "`cells` is given together with `accuracy`",
        ),
        (
            asked("accuracy = 0.1\ncontact_modulus").replace("stiffness = true\narea = true", ""),
            "`accuracy` of what?",
        ),
        (asked("accuracy = 0.1\ncontact_modulus").replace("bem3d", "persson"), "there is none here"),
    ] {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn distributions_and_pictures_of_one_scale() {
    let dir = tempfile::tempdir().unwrap();
    let asked = "area = true\ndistributions = [\"pressure\", \"gap\", \"patches\"]\ngap = [\"png\"]\npressure = [\"png\"]";
    let outcome = run_scene(dir.path(), &WAVES.replace("area = true", asked));
    let fraction = results(dir.path(), "results.csv").numbers("contact_fraction").unwrap();
    let patches = results(dir.path(), "results.csv").numbers("patches").unwrap();
    let integral = |name: &str, state: f64| -> f64 {
        let file = results(dir.path(), &format!("distribution-{name}.csv"));
        let column = |name: &str| file.numbers(name).unwrap();
        let (lower, upper, density, of) =
            (column("lower"), column("upper"), column("density"), column("state"));
        let bins = (0..of.len()).filter(|&i| of[i] == Some(state));
        bins.map(|i| (upper[i].unwrap() - lower[i].unwrap()) * density[i].unwrap()).sum()
    };
    for i in 0..2 {
        approx::assert_relative_eq!(
            integral("pressure", i as f64),
            fraction[i].unwrap(),
            max_relative = 1e-12
        );
        // A cell may be open with a gap of zero.
        approx::assert_relative_eq!(
            integral("gap", i as f64),
            1.0 - fraction[i].unwrap(),
            max_relative = 1e-3
        );
        approx::assert_relative_eq!(integral("patches", i as f64), patches[i].unwrap(), max_relative = 1e-12);
    }
    let name = |path: &std::path::PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    let files: Vec<String> = outcome.files.iter().map(name).collect();
    for file in ["distribution-gap.svg", "gap-bem3d-0-001.png", "pressure-bem3d-0-000.png"] {
        assert!(files.contains(&file.to_owned()) && dir.path().join("out").join(file).exists(), "{files:?}");
    }
    // What they were drawn from is gone, and the second run draws nothing.
    let kept = std::fs::read_dir(dir.path().join("out/.units")).unwrap().flatten();
    assert!(kept.into_iter().all(|entry| !entry.file_name().to_string_lossy().ends_with("f64")));
    assert_eq!(run_scene(dir.path(), &WAVES.replace("area = true", asked)).kept, 2);
}
