//! Every scene of `data/scenes` is run as it stands, and says what its comment promises.

use contact_model::{HeightMap, SelfAffine, Surface};
use fractal_contact::scenes::{Options, Plan, SceneFile, SceneOutcome, run};
use runs::{CsvFile, Silent};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use surface_gen::{Anisotropy, WaveGenerator};
use surface_io::{Preprocessing, ReadOptions, Scan};

/// Two exact solutions of one contact, each good to about 1e-12.
const EXACT: f64 = 1e-9;
/// Boundary elements of 129 cells a side against a smooth body that spans a third of them: second order of
/// the cell over the contact.
const CELLS: f64 = 0.02;
/// The work of a plan is predicted within a factor of six.
const PREDICTED: f64 = 6.0;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes")
}

/// A scene of this text, whose files are beside the scene of this name.
fn scene_of(name: &str, text: String) -> SceneFile {
    let scene = SceneFile::parse(&folder().join(name), text).unwrap_or_else(|e| panic!("{e}"));
    with_grid(scene).unwrap_or_else(|e| panic!("{e}"))
}

/// A scene with the grid for its accuracy, by a pilot in a folder of its own.
fn with_grid(scene: SceneFile) -> fractal_contact::scenes::Result<SceneFile> {
    let dir = tempfile::tempdir().unwrap();
    let options = Options { out: dir.path().into(), threads: 2, fresh: false };
    scene.with_grid_for_accuracy(&options, &Silent, &contact_model::never)
}

fn solved(name: &str) -> (SceneOutcome, CsvFile, tempfile::TempDir) {
    solved_text(name, std::fs::read_to_string(folder().join(name)).unwrap())
}

/// A scene of this text, as `run` solves it.
fn solved_text(name: &str, text: String) -> (SceneOutcome, CsvFile, tempfile::TempDir) {
    let scene = scene_of(name, text);
    let plan = Plan::for_run(&scene).unwrap_or_else(|e| panic!("{e}"));
    solved_plan(name, &scene, &plan)
}

fn solved_plan(name: &str, scene: &SceneFile, plan: &Plan) -> (SceneOutcome, CsvFile, tempfile::TempDir) {
    let dir = tempfile::tempdir().unwrap();
    let options = Options { out: dir.path().into(), threads: 2, fresh: false };
    let outcome =
        run(scene, plan, &options, &Silent, &contact_model::never).unwrap_or_else(|e| panic!("{name}: {e}"));
    let file = CsvFile::read(&dir.path().join("results.csv")).unwrap();
    assert!(!outcome.stopped && outcome.states > 0);
    (outcome, file, dir)
}

/// A column of one model, by state.
fn column(file: &CsvFile, model: &str, name: &str) -> Vec<f64> {
    let models = file.texts("model").unwrap();
    let values = file.numbers(name).unwrap();
    models.iter().zip(values).filter(|(m, v)| **m == model && v.is_some()).filter_map(|(_, v)| v).collect()
}

/// What stands in an NPY file.
fn numbers(path: &Path) -> Vec<f64> {
    let declared = ReadOptions { cell: Some("1".parse().unwrap()), ..ReadOptions::default() };
    let map = Scan::read(path, &declared).unwrap().map(&Preprocessing::default()).unwrap();
    map.heights().to_vec()
}

fn assert_close(file: &CsvFile, name: &str, models: [&str; 2], tolerance: f64) {
    let [a, b] = models.map(|m| column(file, m, name));
    assert!(!a.is_empty() && a.len() == b.len(), "{name}: {a:?} {b:?}");
    for (a, b) in a.iter().zip(&b) {
        approx::assert_relative_eq!(*a, *b, max_relative = tolerance, epsilon = tolerance * 1e-12);
    }
}

#[test]
fn every_scene_is_run_and_named_in_the_readme() {
    let readme = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.extension().is_some_and(|e| e == "toml") {
            count += 1;
            assert!(readme.contains(&format!("`{name}`")), "{name} is not in the README");
            let text = std::fs::read_to_string(&path).unwrap();
            let scene = scene_of(&name, text.clone());
            let plan = Plan::calibrated(&scene).unwrap_or_else(|e| panic!("{e}"));
            assert!(!plan.shows.is_empty(), "{name} says nothing");
            let (outcome, file, dir) = solved_plan(&name, &scene, &plan);
            let predicted = plan.predicted().unwrap().applications;
            let found: f64 = file.numbers("applications").unwrap().into_iter().flatten().sum();
            assert!(
                found <= PREDICTED * predicted && predicted <= PREDICTED * found,
                "{name}: {predicted} {found}"
            );
            // The pull-off is meant to be refused, once by each of two models.
            let allowed = if name == "jkr-pull-off.toml" { 2 } else { 0 };
            assert_eq!(outcome.failed, allowed, "{name}: {:?}", outcome.notes);
            let manifest = std::fs::read_to_string(dir.path().join("manifest.json")).unwrap();
            assert!(manifest.contains("\"complete\": true") && manifest.contains("citation"));
            // Works that an effect or an output rests on are cited where a scene names it, and nowhere else.
            let slips = text.contains("bem3d") && text.contains("\nfriction");
            assert_eq!(manifest.contains("Kalker"), slips, "{name}");
            for file in &outcome.files {
                assert!(file.is_file(), "{}", file.display());
            }
        }
    }
    assert!(count >= 8);
}

/// Its table and its report have the residual of the attraction.
#[test]
fn a_sticky_ball_jumps_in_and_off_with_its_residuals() {
    let (_, file, dir) = solved("sticky-ball.toml");
    let all = |name: &str| column(&file, "bem3d", name);
    assert!(all("equilibrium").iter().all(|e| (0.0..=1e-5).contains(e)) && all("equilibrium").len() == 33);
    assert!(all("stability").iter().all(|s| *s > 0.0));
    let (force, cells) = (all("force"), all("contact_cells"));
    let touching: Vec<usize> = (0..33).filter(|&i| cells[i] > 0.0).collect();
    // It touches from one step to another, jumps at both ends, and pulls between 1.5 and 2 pi w R.
    let (first, last) = (touching[0], touching[touching.len() - 1]);
    assert_eq!(touching.len(), last + 1 - first);
    assert!(force[first] < 5.0 * force[first - 1] && force[last] < 2.0 * force[last + 1]);
    let pull = force.iter().fold(0.0f64, |most, f| most.max(-f)) / (TAU * 0.5 * 0.05 * 50e-6);
    assert!((1.5..2.0).contains(&pull), "{pull}");
    let report = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
    assert!(report.contains("equilibrium"));
}

/// A surface keeps the indentation of its largest load, and the report shows it.
#[test]
fn a_plastic_path_keeps_its_indentation() {
    let (_, file, dir) = solved("plastic-path.toml");
    let all = |name: &str| column(&file, "bem3d", name);
    let (force, volume, work) = (all("force"), all("plastic_volume"), all("plastic_work"));
    let largest = |i: usize| force[..=i].iter().copied().fold(0.0, f64::max);
    for i in 1..force.len() {
        if largest(i) > 1.001 * largest(i - 1) {
            assert!(volume[i] > volume[i - 1]);
        } else {
            approx::assert_relative_eq!(volume[i], volume[i - 1], max_relative = 1e-5);
        }
        // The hardness times the volume.
        approx::assert_relative_eq!(work[i], 1e9 * volume[i], max_relative = EXACT);
    }
    let report = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
    assert!(report.contains("Plastic indentation"));
}

#[test]
fn a_path_beyond_the_hardness_is_told_by_the_plan() {
    let text = std::fs::read_to_string(folder().join("plastic-path.toml")).unwrap();
    let notes = |text: String| {
        let scene = SceneFile::parse(&folder().join("plastic-path.toml"), text).unwrap();
        Plan::new(&scene).unwrap().notes.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(notes(text.clone()), Vec::<String>::new());
    // 1 GPa on 1 mm^2 are 1000 N.
    for load in ["force = \"2000 N\"", "mean_pressure = \"2 GPa\""] {
        let told = notes(text.replace("force = \"300 N\"", load));
        let [note] = &told[..] else { panic!("{told:?}") };
        assert!(
            note.contains("a mean pressure of 2 GPa cannot be reached: at the hardness of 1 GPa"),
            "{note}"
        );
        assert!(note.contains("The path ends before this step"), "{note}");
    }
    // The force that belongs to an approach is not known beforehand.
    assert_eq!(notes(text.replace("force = \"300 N\"", "approach = \"1 mm\"")), Vec::<String>::new());
}

#[test]
fn a_ball_is_the_same_for_four_models() {
    let (_, file, _dir) = solved("ball-on-plate.toml");
    for name in ["approach", "stiffness", "area"] {
        assert_close(&file, name, ["hertz", "power_law_body"], EXACT);
        assert_close(&file, name, ["hertz", "mdr1d"], EXACT);
    }
    assert_close(&file, "approach", ["hertz", "bem3d"], CELLS);
    assert_close(&file, "stiffness", ["hertz", "bem3d"], CELLS);
}

#[test]
fn adhesion_and_friction_agree_between_closed_forms_and_springs() {
    let (outcome, file, _dir) = solved("jkr-pull-off.toml");
    for name in ["force", "stiffness", "area"] {
        assert_close(&file, name, ["jkr", "mdr1d"], EXACT);
    }
    assert!(outcome.notes.iter().all(|n| n.contains("is below -1.119 um")), "{:?}", outcome.notes);
    let (_, file, _dir) = solved("cattaneo-mindlin-loop.toml");
    for name in ["tangential_displacement", "dissipated", "stick_radius"] {
        assert_close(&file, name, ["cattaneo_mindlin", "mdr1d_partial_slip"], 1e-8);
    }
}

#[test]
fn creep_ends_at_the_relaxed_indentation() {
    let (_, file, _dir) = solved("viscoelastic-indentation.toml");
    let d = column(&file, "mdr1d_viscoelastic", "approach");
    let hertz =
        |contact_modulus: f64| (3.0 * 2.0 / (4.0 * contact_modulus * 0.01_f64.sqrt())).powf(2.0 / 3.0);
    // Glassy: E* (1 + 1.5 + 0.8). After 30 s some per cent are left to creep.
    approx::assert_relative_eq!(d[0], hertz(4e6 * 3.3), max_relative = EXACT);
    let last = d[d.len() - 1];
    assert!(last < hertz(4e6) && last > 0.9 * hertz(4e6));
    assert!(d.windows(2).all(|w| w[1] >= w[0]));
}

#[test]
fn a_rough_ball_becomes_the_smooth_one() {
    let (_, file, _dir) = solved("rough-sphere.toml");
    let [force, area, stiffness] = ["force", "area", "stiffness"].map(|name| column(&file, "bem3d", name));
    let share = |i: usize| {
        let radius = (0.75 * force[i] * 0.01 / 60e9_f64).cbrt();
        (area[i] / (std::f64::consts::PI * radius * radius), stiffness[i] / (2.0 * 60e9 * radius))
    };
    let (light, heavy) = (share(0), share(force.len() - 1));
    assert!(light.0 < 0.2 && light.1 < 0.5 && heavy.0 > 0.7 && heavy.1 > 0.9, "{light:?} {heavy:?}");
    assert!((0..force.len()).all(|i| share(i).0 < share(i).1), "the stiffness is there before the area");
}

#[test]
fn theories_are_where_the_scene_says() {
    let (_, file, _dir) = solved("periodic-theories.toml");
    let of = |model: &str, name: &str| column(&file, model, name);
    let (force, k) = (of("bem3d", "force"), of("bem3d", "stiffness"));
    let last = force.len() - 1;
    let slope = (k[last] / k[0]).ln() / (force[last] / force[0]).ln();
    assert!((0.9..1.0).contains(&slope), "{slope}");
    let ratios = |model: &str, name: &str| -> Vec<f64> {
        of("bem3d", name).iter().zip(of(model, name)).map(|(solved, theory)| solved / theory).collect()
    };
    assert!(ratios("persson", "stiffness").iter().all(|r| (1.0..1.55).contains(r)));
    assert!(ratios("persson", "area").iter().all(|r| (1.4..1.9).contains(r)));
    assert!(ratios("greenwood_williamson", "area").iter().all(|r| (1.0..1.4).contains(r)));
}

#[test]
fn a_wave_is_that_of_westergaard() {
    let (_, file, _dir) = solved("wave.toml");
    assert_close(&file, "mean_gap", ["westergaard", "bem3d"], CELLS);
}

/// The pressure of the cells carries the force, to the tolerance of the solve and the digits of a sum.
const CARRIED: f64 = 1e-5;

#[test]
fn stored_fields_are_those_of_the_states() {
    let (_, file, dir) = solved("rough-map.toml");
    let forces = column(&file, "bem3d", "force");
    let patches = CsvFile::read(&dir.path().join("patches.csv")).unwrap();
    let states = patches.numbers("state").unwrap();
    let areas = patches.numbers("area").unwrap();
    for (state, (force, area)) in forces.iter().zip(column(&file, "bem3d", "area")).enumerate() {
        let pressure = numbers(&dir.path().join(format!("pressure-bem3d-0-{state:03}.npy")));
        let cell = 0.5e-6_f64;
        let carried: f64 = pressure.iter().sum::<f64>() * cell * cell;
        approx::assert_relative_eq!(carried, *force, max_relative = CARRIED);
        let sum: f64 = states
            .iter()
            .zip(&areas)
            .filter(|(s, _)| **s == Some(state as f64))
            .filter_map(|(_, a)| *a)
            .sum();
        approx::assert_relative_eq!(sum, area, max_relative = EXACT);
        // Where cells press, there is no gap.
        let gap = numbers(&dir.path().join(format!("gap-bem3d-0-{state:03}.npy")));
        for (p, g) in pressure.iter().zip(&gap) {
            assert!(*p <= 0.0 || g.abs() < 1e-4 * 60e-9, "{p} {g}");
        }
        let vti =
            std::fs::read_to_string(dir.path().join(format!("pressure-bem3d-0-{state:03}.vti"))).unwrap();
        assert!(vti.contains("Name=\"pressure [Pa]\""));
    }
}

#[test]
fn conductance_is_the_stiffness_by_barber() {
    let (_, file, _dir) = solved("contact-conductance.toml");
    // Not asked for: the stiffness is computed for the conductance and not told.
    assert!(file.column("stiffness").is_err());
    let text = std::fs::read_to_string(folder().join("contact-conductance.toml")).unwrap();
    let text = text.replace("curves = true", "stiffness = true");
    let scene = SceneFile::parse(&folder().join("a.toml"), text).unwrap_or_else(|e| panic!("{e}"));
    let dir = tempfile::tempdir().unwrap();
    let options = Options { out: dir.path().into(), threads: 1, fresh: false };
    run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &contact_model::never).unwrap();
    let both = CsvFile::read(&dir.path().join("results.csv")).unwrap();
    for model in ["bem3d", "mdr1d"] {
        let k = column(&both, model, "stiffness");
        let alone = column(&file, model, "conductance");
        assert_eq!(k.len(), alone.len());
        for (k, conductance) in k.iter().zip(alone) {
            approx::assert_relative_eq!(
                2.0 * k / (scene.contact_modulus * 2.0 * 17e-9),
                conductance,
                max_relative = EXACT
            );
        }
    }
}

/// The scene in `--help` can be run.
#[test]
fn the_scene_of_the_help_is_a_scene() {
    let help =
        std::process::Command::new(env!("CARGO_BIN_EXE_fractal-contact")).arg("--help").output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let text = help.split("A scene:\n").nth(1).unwrap().split("Examples:").next().unwrap();
    let scene = SceneFile::parse("help.toml".as_ref(), text.to_owned()).unwrap_or_else(|e| panic!("{e}"));
    assert!(Plan::new(&scene).is_ok() && scene.models.len() == 2);
}

#[test]
fn an_accuracy_is_what_the_run_finds() {
    let (outcome, file, _dir) = solved("accuracy.toml");
    for name in ["stiffness_grid_error", "area_corrected_grid_error"] {
        assert!(column(&file, "bem3d", name).iter().all(|error| *error <= 0.03), "{name}");
    }
    assert!(outcome.notes.iter().all(|note| !note.contains("accuracy")), "{:?}", outcome.notes);
}

/// The numbers of a line of a table.
fn stated(line: &str) -> Vec<&str> {
    line.split(['|', '±', ',', '%']).map(str::trim).filter(|word| word.parse::<f64>().is_ok()).collect()
}

/// Each number as it is stated, with as many decimals.
fn assert_stated(line: &str, found: &[f64]) {
    let stated = stated(line);
    assert_eq!(stated.len(), found.len(), "{line}");
    for (stated, found) in stated.iter().zip(found) {
        let decimals = stated.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        assert_eq!(**stated, format!("{found:.decimals$}"), "{line}");
    }
}

/// The tables of the book's page on the diamond film.
#[test]
fn diamond_scenes_give_the_numbers_of_their_page() {
    let page = std::fs::read_to_string(folder().join("../../book/src/diamond-film.md")).unwrap();
    let runs = ["diamond-on-flat.toml", "diamond-two-bodies.toml"].map(|name| solved(name).1);
    for (state, pressure) in [(0, "10 MPa"), (2, "100 MPa"), (4, "1 GPa"), (6, "10 GPa")] {
        let start = format!("| {pressure} | ");
        let line = page.lines().find(|line| line.starts_with(&start) && line.contains('±')).unwrap();
        let of = |run: usize, name: &str| column(&runs[run], "bem3d", name)[state];
        let area = |run: usize| [1e18 * of(run, "area"), 1.0 + of(run, "area_grid_error")];
        let stiffness = |run: usize| [of(run, "stiffness"), 100.0 * of(run, "stiffness_grid_error")];
        let conductance = [0, 1].map(|run| 1e9 * of(run, "conductance"));
        let found = [stiffness(0), stiffness(1), conductance, area(0), area(1)].concat();
        assert_stated(line, &found);
    }
    let scene = std::fs::read_to_string(folder().join("diamond-on-flat.toml")).unwrap();
    let drawn = ["curves = true\n", "heights = [\"png\"]\n", "pressure = [\"png\"]\n", "gap = [\"png\"]\n"];
    let scene = drawn.iter().fold(scene, |scene, output| scene.replace(output, ""));
    let scene = scene.replace("{ from = \"10 MPa\", to = \"10 GPa\", count = 7 }", "[\"1 GPa\", \"10 GPa\"]");
    let filter = scene.lines().find(|line| line.starts_with("filter_across")).unwrap();
    let aligned = "align_lines = \"median_difference\"";
    let scars = "scars = 3\nfill = \"neighbours\"";
    for (row, [old, new]) in [
        ("as measured", [filter, ""]),
        ("scars taken out", [filter, scars]),
        ("lines aligned", [filter, aligned]),
        ("filtered, 3 nm", [filter, "filter_across = \"3 nm\""]),
        ("filtered, 6 nm (the scene)", ["", ""]),
        ("filtered, 12 nm", [filter, "filter_across = \"12 nm\""]),
        ("aligned, scars taken out, filtered, 6 nm", [filter, &format!("{filter}\n{aligned}\n{scars}")]),
        ("filtered, 6 nm, `cells = 128`", [filter, &format!("{filter}\ncells = 128")]),
        ("filtered, 6 nm, a quadric subtracted", ["detrend = \"plane\"", "detrend = \"quadric\""]),
        ("filtered, 6 nm, the second scan", ["channel = 0", "channel = 1"]),
    ] {
        let (_, file, _dir) = solved_text("diamond-on-flat.toml", scene.replacen(old, new, 1));
        let of = |name: &str| <[f64; 2]>::try_from(column(&file, "bem3d", name)).unwrap();
        let [stiffness, area, factor] = ["stiffness", "area", "area_grid_error"].map(of);
        let areas = [0, 1].map(|state| [1e18 * area[state], 1.0 + factor[state]]).concat();
        let rest = [of("patches")[1], 1e-12 * of("largest_pressure")[1]];
        let found = [&of("rms_slope")[..1], &stiffness, &areas, &rest].concat();
        let start = format!("| {row} | ");
        let line =
            page.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("{row} {found:?}"));
        assert_stated(&line[start.len() - 2..], &found);
    }
}

/// What the page says of the heights of both scans of the diamond film.
#[test]
fn scans_of_the_diamond_film_agree_as_their_page_says() {
    let page = std::fs::read_to_string(folder().join("../../book/src/diamond-film.md")).unwrap();
    let states = |sentence: &str| {
        let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(page.contains(sentence), "{sentence}");
    };
    let map = |channel: usize, preprocessing: &Preprocessing| {
        let options = surface_io::ReadOptions {
            channel: Some(surface_io::ChannelChoice::Number(channel)),
            ..Default::default()
        };
        let path = folder().join("../measured/uncd-afm.001");
        let scan = surface_io::Scan::read(&path, &options).unwrap();
        scan.map(&Preprocessing { detrend: surface_io::Detrend::Plane, ..preprocessing.clone() }).unwrap()
    };
    let both = |preprocessing: &Preprocessing| [0, 1].map(|channel| map(channel, preprocessing));
    let difference = |a: &[HeightMap; 2], b: &[HeightMap; 2]| {
        [0, 1].map(|i| a[i].heights().iter().zip(b[i].heights()).map(|(a, b)| a - b).collect::<Vec<f64>>())
    };
    // Of the second scan the point 8 columns before that of the first.
    let (n, shift) = (512, 8);
    let inner = |heights: &[f64], from: usize| -> Vec<f64> {
        heights.chunks_exact(n).flat_map(|line| line[from..from + n - shift].to_vec()).collect()
    };
    let pair = |heights: [Vec<f64>; 2]| [inner(&heights[0], shift), inner(&heights[1], 0)];
    let rms = |heights: &[f64]| 1e9 * surface_gen::rms_height(heights);
    let correlation = |[a, b]: [Vec<f64>; 2]| {
        let mean = |heights: &[f64]| heights.iter().sum::<f64>() / heights.len() as f64;
        let (mean_a, mean_b) = (mean(&a), mean(&b));
        let product: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b)).collect();
        mean(&product) * 1e18 / (rms(&a) * rms(&b))
    };
    let plain = both(&Preprocessing::default());
    let filtered = |cut_off: &str| {
        both(&Preprocessing { filter_across: cut_off.parse().ok(), ..Preprocessing::default() })
    };
    let [three, six, twelve] = ["3 nm", "6 nm", "12 nm"].map(filtered);
    let heights = six.clone().map(|map| map.heights().to_vec());
    states(&format!("passes the filter has a correlation of {:.3} between", correlation(pair(heights))));
    let noise = difference(&plain, &six);
    states(&format!("what is removed, {:.2} nm rms, one of {:.2}", rms(&noise[0]), correlation(pair(noise))));
    states(&format!(
        "Between cut-offs of 3 and 6 nm it is {:.2}, between 6 and 12 nm {:.2}",
        correlation(pair(difference(&three, &six))),
        correlation(pair(difference(&six, &twelve)))
    ));
    let lines = plain.clone().map(|map| {
        let h = map.heights();
        (n..h.len()).map(|i| h[i] - h[i - n]).collect::<Vec<f64>>()
    });
    let points = plain[0].heights().windows(2).enumerate().filter(|(i, _)| (i + 1) % n > 0);
    let points = rms(&points.map(|(_, pair)| pair[1] - pair[0]).collect::<Vec<f64>>());
    states(&format!(
        "lines differ by {:.2} nm rms, neighbouring points of a line by {points:.2}",
        rms(&lines[0])
    ));
    let medians = lines.map(|lines| {
        let median = |line: &[f64]| {
            let mut line = line.to_vec();
            line.sort_by(f64::total_cmp);
            0.5 * line[n / 2 - 1] + 0.5 * line[n / 2]
        };
        lines.chunks_exact(n).map(median).collect::<Vec<f64>>()
    });
    states(&format!(
        "medians of the differences between lines are {:.2} nm rms, with a correlation of {:.2} between",
        rms(&medians[0]),
        correlation(medians)
    ));
    let aligned = both(&Preprocessing {
        align_lines: Some(surface_io::AlignLines::MedianDifference),
        ..Preprocessing::default()
    });
    let removed = difference(&plain, &aligned);
    states(&format!(
        "alignment removes, {:.1} nm rms, has a correlation of {:.2}",
        rms(&removed[0]),
        correlation(pair(removed))
    ));
}

/// The heights of a scene's first surface that a model with cells solves.
fn drawn(scene: &SceneFile) -> Arc<HeightMap> {
    match scene.scene(&scene.models[0], scene.seed(0)).unwrap().surface {
        Surface::Heights(map) => map,
        other => panic!("{other:?}"),
    }
}

fn parsed(text: &str) -> Result<SceneFile, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    std::fs::copy(folder().join("rough-map.npy"), dir.path().join("rough-map.npy")).unwrap();
    let scene = SceneFile::read(&path).map_err(|e| e.to_string())?;
    Plan::new(&scene).map_err(|e| e.to_string())?;
    Ok(scene)
}

#[test]
fn a_twin_has_the_heights_and_the_spectrum_of_its_map() {
    let text = std::fs::read_to_string(folder().join("twin.toml")).unwrap();
    let kept = |line: &&str| {
        !line.starts_with("twin") && !line.starts_with("keep_heights") && !line.starts_with("surfaces")
    };
    let own = text.lines().filter(kept).collect::<Vec<_>>().join("\n");
    let (twin, map) = (parsed(&text).unwrap(), drawn(&parsed(&own).unwrap()));
    let heights = |map: &HeightMap| -> Vec<f64> {
        let mean = map.heights().iter().sum::<f64>() / map.heights().len() as f64;
        let mut heights: Vec<f64> = map.heights().iter().map(|h| h - mean).collect();
        heights.sort_by(f64::total_cmp);
        heights
    };
    let found = drawn(&twin);
    let rms = surface_gen::rms_height(map.heights());
    for (a, b) in heights(&found).iter().zip(heights(&map)) {
        assert!((a - b).abs() < 1e-9 * rms, "{a} {b}");
    }
    assert_ne!(found, map);
    let slopes = [&found, &map].map(|map| surface_gen::rms_slope_differences(map));
    approx::assert_relative_eq!(slopes[0], slopes[1], max_relative = 0.01);
    for (wrong, message) in [
        (text.replace("twin = \"waves\"", "twin = \"wave\""), "waves"),
        (text.replace("twin = \"waves\"        #", "#"), "`keep_heights` is given, but no `twin`"),
        (text.replace("[sampling]\nseed = 1\nsurfaces = 8", ""), "no seed is given"),
        (text.replace("[sampling]", "[models.bem3d]\ncells = 48\n[sampling]"), "the map brings its own 96"),
    ] {
        let error = parsed(&wrong).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn a_lay_is_the_one_that_the_program_draws() {
    let text = std::fs::read_to_string(folder().join("anisotropic.toml")).unwrap();
    let scene = parsed(&text).unwrap();
    let surface = SelfAffine {
        roll_off: Some(TAU / 2e-4),
        short_cutoff: Some(TAU / 62.5e-6),
        ..SelfAffine::new(2.2, 1e-3, 1e-6).unwrap()
    };
    let lay = Anisotropy { ratio: 4.0, lay: 30.0 };
    let waves = WaveGenerator::anisotropic(&surface, lay, 128).unwrap();
    let wanted = waves.map(surface_gen::surface_seed(1, 0)).unwrap();
    for (a, b) in drawn(&scene).heights().iter().zip(wanted.heights()) {
        assert!((a - b).abs() < 1e-15, "{a} {b}");
    }
    for (wrong, message) in [
        (text.replace("\nanisotropy = 4", ""), "`lay` is given, but no `anisotropy`"),
        (text.replace("anisotropy = 4", "anisotropy = -1"), "anisotropy"),
        (
            text.replace("\"bem3d\"]", "\"bem3d\", \"mdr1d\"]")
                .replace("[effects]\nboundary = \"periodic\"", ""),
            "it draws no map",
        ),
        (text.replace("anisotropy = 4", "anisotropy = 4\nweibull = 0"), "weibull"),
    ] {
        let error = parsed(&wrong).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn an_accuracy_is_not_asked_of_surfaces_that_differ_by_grid() {
    let text = std::fs::read_to_string(folder().join("skewed.toml")).unwrap();
    let text = text.replace("weibull = 6", "weibull = 6\n").replace("[models.bem3d]\ncells = 128\n", "");
    let asked = text.replace("[scene]\n", "[scene]\naccuracy = \"5 %\"\n");
    let error = with_grid(parsed(&asked).unwrap()).unwrap_err().to_string();
    assert!(error.contains("is another one on each") && error.contains("grid_error"), "{error}");
}

#[test]
fn weibull_heights_have_their_skewness() {
    let map = drawn(&SceneFile::read(&folder().join("skewed.toml")).unwrap());
    let rms = surface_gen::rms_height(map.heights());
    let skewness = map.heights().iter().map(|h| (h / rms).powi(3)).sum::<f64>() / map.heights().len() as f64;
    // Of Weibull's law with the shape 6.
    assert!((skewness + 0.3733).abs() < 0.005, "{skewness}");
}
