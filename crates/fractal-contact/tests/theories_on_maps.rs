//! Theories of rough surfaces beside the solved map: what they take from it, what is said, what is refused.

use contact_model::{ContactModel, HeightMap, Load, Scene, SelfAffine, Surface};
use fractal_contact::scenes::{Options, Plan, SceneFile, run};
use runs::{CsvFile, Silent};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;
use surface_gen::{Exact, HeightDistribution, PrescribedMap, TwinSpectrum, WaveGenerator};

/// A surface of many waves: roll-off at an eighth of the side.
fn surface() -> SelfAffine {
    let paper = SelfAffine::new(2.2, 1.0, 0.01).unwrap();
    SelfAffine { roll_off: Some(8.0 * TAU), short_cutoff: Some(32.0 * TAU), ..paper }
}

fn drawn(cells: usize) -> HeightMap {
    surface_gen::self_affine_map(&surface(), cells, 1).unwrap()
}

/// Writes a map as comma-separated values, NaN where it is undefined.
fn write(dir: &Path, map: &HeightMap) {
    let mut text = String::new();
    for row in map.heights().chunks(map.columns()) {
        let row: Vec<String> =
            row.iter().map(|h| if h.is_finite() { format!("{h:e}") } else { "nan".into() }).collect();
        writeln!(text, "{}", row.join(",")).unwrap();
    }
    std::fs::write(dir.join("map.csv"), text).unwrap();
}

const PERIODIC: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\", \"persson\", \"greenwood_williamson\"]\ncontact_modulus = 1\n\
    mean_pressure = [0.002, 0.01]\n[scene.surface]\nkind = \"file\"\npath = \"map.csv\"\nsize = 1\nunit = \"none\"\n\
    [effects]\nboundary = \"periodic\"\n[outputs]\narea = true\nstiffness = true\nmean_gap = true\n";

const FREE: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\", \"mdr1d\", \"power_law\"]\ncontact_modulus = 1\n\
    force_bar = [0.01, 0.05]\n[scene.surface]\nkind = \"file\"\npath = \"map.csv\"\nsize = 1\nunit = \"none\"\n\
    [models.mdr1d]\nelements = 4096\n[sampling]\nseed = 1\nsurfaces = 3\n[outputs]\nstiffness = true\n";

/// Mean squares of a map under a window, over those of the map: of 8 to 32 waves a side, and of the window
/// itself.
const UNDER_WINDOW: f64 = 0.03;

#[test]
fn a_window_keeps_the_contact_fraction_of_theories_and_is_told() {
    let map = drawn(128);
    let windowed = PERIODIC.replace("[effects]", "window = \"hann\"\n[effects]");
    let [plain, tapered] = [PERIODIC, &windowed].map(|text| solved(&map, text));
    for model in ["persson", "greenwood_williamson"] {
        let [plain, tapered] = [&plain.1, &tapered.1].map(|file| column(file, model, "area"));
        for (plain, tapered) in plain.iter().zip(&tapered) {
            assert!((tapered / plain - 1.0).abs() < UNDER_WINDOW, "{model}: {tapered} for {plain}");
        }
    }
    let told = tapered.0.to_string();
    let step = "deviations from the mean tapered by Hann's window over its rms: rms height ";
    assert!(told.contains(step) && told.contains("note: the map is tapered to its edges"), "{told}");
    assert!(told.contains("`bem3d` presses the tapered map"), "{told}");
    assert!(!plain.0.to_string().contains("tapered"));
}

fn read(dir: &Path, text: &str) -> fractal_contact::scenes::Result<SceneFile> {
    SceneFile::parse(&dir.join("a.toml"), text.to_owned())
}

fn refused(map: &HeightMap, text: &str) -> String {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), map);
    read(dir.path(), text).and_then(|scene| Plan::new(&scene)).unwrap_err().to_string()
}

fn notes(map: &HeightMap, text: &str) -> Vec<String> {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), map);
    let plan = Plan::new(&read(dir.path(), text).unwrap()).unwrap_or_else(|e| panic!("{e}"));
    plan.notes.iter().map(ToString::to_string).collect()
}

fn solved(map: &HeightMap, text: &str) -> (Plan, CsvFile) {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), map);
    let scene = read(dir.path(), text).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::calibrated(&scene).unwrap_or_else(|e| panic!("{e}"));
    let options = Options { out: dir.path().join("out"), threads: 2, fresh: false };
    let outcome = run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
    assert_eq!(outcome.failed, 0, "{:?}", outcome.notes);
    (plan, CsvFile::read(&outcome.files[0]).unwrap())
}

/// A column of one model; every one of its rows has a finite number.
fn column(file: &CsvFile, model: &str, name: &str) -> Vec<f64> {
    let models = file.texts("model").unwrap();
    let values = file.numbers(name).unwrap();
    let own = models.iter().zip(values).filter(|(m, _)| **m == model);
    let found: Vec<f64> = own.map(|(_, v)| v.unwrap_or(f64::NAN)).collect();
    assert!(found.iter().all(|v| v.is_finite()), "{model} {name}: {found:?}");
    found
}

#[test]
fn periodic_theories_answer_for_a_map_beside_the_solver() {
    let map = drawn(128);
    let (plan, file) = solved(&map, PERIODIC);
    assert!(plan.notes.is_empty(), "{:?}", plan.notes);
    let gradient = surface_gen::rms_slope(&map).unwrap();
    assert!(plan.models[1].accuracy.contains("of this map: rms slope"), "{}", plan.models[1].accuracy);
    assert!(plan.models[2].accuracy.contains("summits of radius"), "{}", plan.models[2].accuracy);
    for name in ["area", "stiffness", "mean_gap"] {
        for model in ["persson", "greenwood_williamson"] {
            let (theory, exact) = (column(&file, model, name), column(&file, "bem3d", name));
            println!("{model} {name}: {theory:?} over {exact:?}");
            for (theory, exact) in theory.iter().zip(exact) {
                // Theories of an infinite surface, and a grid of four cells a wave.
                assert!((0.4..1.6).contains(&(theory / exact)), "{model} {name}: {theory} {exact}");
            }
        }
    }
    // Light loads: A/A0 = sqrt(8/pi) p/(E* g) with the map's own gradient, to the second order in p.
    let area = column(&file, "persson", "area");
    let slope = (8.0 / std::f64::consts::PI).sqrt() / gradient;
    assert!((area[0] / (0.002 * slope) - 1.0).abs() < 0.01, "{area:?} {slope}");
}

/// Each seed has a twin of its own, whose spectrum differs where its heights are prescribed.
#[test]
fn theories_answer_for_the_twin_of_each_seed() {
    let map = drawn(64);
    let text = PERIODIC.replace("\"bem3d\", ", "").replace(
        "unit = \"none\"\n[effects]",
        "unit = \"none\"\ntwin = \"waves\"\nkeep_heights = true\n[effects]",
    );
    let text = text + "[sampling]\nseed = 7\nsurfaces = 3\n";
    let (_, file) = solved(&map, &text);
    let waves = WaveGenerator::twin(&map, TwinSpectrum::EachWave).unwrap();
    let heights = HeightDistribution::Of(std::sync::Arc::new(map));
    let loads = [Load::force(0.002), Load::force(0.01)];
    let models: [&dyn ContactModel; 2] =
        [&analytic::Persson::default(), &analytic::GreenwoodWilliamson::default()];
    for model in models {
        let found = column(&file, model.name(), "stiffness");
        let numbers = file.numbers("surface").unwrap();
        assert_eq!((found.len(), numbers.iter().flatten().count()), (6, 12));
        let mut wanted = Vec::new();
        for seed in (0..3).map(|surface| surface_gen::surface_seed(7, surface)) {
            let twin = PrescribedMap::new(&waves, &heights, Exact::Distribution, seed).unwrap().map;
            let mut scene = Scene::new(Surface::Heights(std::sync::Arc::new(twin)), 1.0);
            scene.effects.boundary = contact_model::Boundary::Periodic;
            (scene.outputs.stiffness, scene.outputs.area, scene.outputs.mean_gap) = (true, true, true);
            let mut contact = model.prepare(&scene, seed).unwrap();
            let solved = |load| contact.solve_until(load, &contact_model::never).unwrap();
            wanted.extend(loads.map(solved).map(|state| state.stiffness.unwrap()));
        }
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found / wanted - 1.0).abs() < 1e-12, "{}: {found} {wanted}", model.name());
        }
        assert!(found[0].to_bits() != found[2].to_bits() && found[2].to_bits() != found[4].to_bits());
    }
}

#[test]
fn a_line_and_the_fit_stand_for_a_map_with_free_edges() {
    let map = surface_gen::self_affine_map(&SelfAffine::new(2.3, 1.0, 0.01).unwrap(), 128, 2).unwrap();
    let (plan, file) = solved(&map, FREE);
    assert!(plan.models[2].accuracy.contains("of this map: D_f = 2."), "{}", plan.models[2].accuracy);
    let of = |model: &str| column(&file, model, "stiffness");
    // The map is one, its lines are three; a fit has no realisation.
    assert_eq!([of("bem3d").len(), of("mdr1d").len(), of("power_law").len()], [2, 6, 2]);
    let lines = of("mdr1d");
    assert!(lines[0].to_bits() != lines[2].to_bits() && lines[2].to_bits() != lines[4].to_bits());
    println!("bem3d {:?} mdr1d {lines:?} power_law {:?}", of("bem3d"), of("power_law"));
    for i in 0..2 {
        let line = (0..3).map(|n| lines[2 * n + i]).sum::<f64>() / 3.0;
        for theory in [line, of("power_law")[i]] {
            // One surface scatters by a quarter, the line is 1.2 times as stiff.
            assert!((0.5..2.0).contains(&(theory / of("bem3d")[i])));
        }
    }
}

/// Heights `h(ix, iy)` of a map of 64 cells a side.
fn changed(h: impl Fn(&HeightMap, usize, usize) -> f64) -> HeightMap {
    let map = drawn(64);
    let heights = (0..64 * 64).map(|i| h(&map, i % 64, i / 64)).collect();
    HeightMap::with_undefined(64, 1.0, heights).unwrap()
}

#[test]
fn what_a_map_lacks_is_said() {
    assert!(notes(&drawn(64), PERIODIC).is_empty());
    let of = |map: &HeightMap, words: &str| {
        let notes = notes(map, PERIODIC);
        let own = |n: &&String| n.contains("persson, greenwood_williamson: ") && n.contains("= help: ");
        assert!(notes.iter().filter(own).any(|n| n.contains(words)), "{words}: {notes:#?}");
    };
    of(
        &drawn(128).cropped(0..100, 0..100).unwrap().scaled(1.28, 1.0).unwrap(),
        "opposite edges of the map differ by",
    );
    of(
        &changed(|map, ix, iy| map.heights()[ix] + 0.1 * map.heights()[64 * iy + ix]),
        "the map is anisotropic",
    );
    of(&changed(|map, ix, iy| map.heights()[64 * iy + ix].min(0.001)), "heights are not Gaussian");
    let few = surface_gen::self_affine_map(&SelfAffine::new(2.1, 1.0, 0.01).unwrap(), 64, 1).unwrap();
    of(&few, "of the variance of heights is in the longest waves");
    // A tilt and a point that stands out are one cause each.
    let causes = |map: &HeightMap| {
        let own = |n: &String| n.contains("greenwood_williamson: ") || n.contains("the highest point");
        notes(map, PERIODIC).into_iter().filter(own).collect::<Vec<_>>()
    };
    let tilted = causes(&changed(|map, ix, iy| map.heights()[64 * iy + ix] + 5e-4 * ix as f64));
    assert!(tilted.len() == 1 && tilted[0].contains("the map is tilted: "), "{tilted:#?}");
    let spiked = causes(&changed(
        |map, ix, iy| if ix + iy == 40 && ix == 9 { 0.2 } else { map.heights()[64 * iy + ix] },
    ));
    assert!(spiked.len() == 1 && spiked[0].contains("the highest point, in row 31, column 9"), "{spiked:#?}");
    // In units the slope counts.
    let steep = PERIODIC
        .replace("units = \"none\"\n", "")
        .replace("contact_modulus = 1", "contact_modulus = \"1 GPa\"");
    let steep = steep.replace("[0.002, 0.01]", "\"1 MPa\"").replace("unit = \"none\"", "unit = \"um\"");
    let notes = notes(&drawn(64), &steep.replace("size = 1", "size = \"0.1 um\""));
    assert!(notes.iter().any(|n| n.contains("assumes small slopes")), "{notes:#?}");
}

/// Opposite edges that do not fit are told of a periodic map whatever else it lacks: with holes, and tilted.
#[test]
fn edges_are_told_of_a_map_with_holes_and_of_a_tilted_one() {
    let solver = PERIODIC.replace(", \"persson\", \"greenwood_williamson\"", "");
    let kept = solver.replace("size = 1\n", "size = 1\nundefined = \"no_contact\"\n");
    let part = drawn(128).cropped(0..100, 0..100).unwrap().scaled(1.28, 1.0).unwrap();
    let with = |map: &HeightMap, height: &dyn Fn(usize, f64) -> f64| {
        let heights = map.heights().iter().enumerate().map(|(i, h)| height(i, *h)).collect();
        HeightMap::with_undefined(map.cells(), map.size(), heights).unwrap()
    };
    let hole = |i: usize, h: f64| if i == 1234 { f64::NAN } else { h };
    let edges = "opposite edges of the map differ by";
    for (map, text, expected) in [
        (part.clone(), &solver, edges),
        (with(&part, &hole), &kept, edges),
        (with(&part, &|i, h| h + 0.01 * (i % 100) as f64), &solver, "the map is tilted: "),
        (with(&part, &|i, h| hole(i, h + 0.01 * (i % 100) as f64)), &kept, "the map is tilted: "),
    ] {
        let notes = notes(&map, text);
        assert!(
            notes.iter().filter(|n| n.contains("bem3d: ") && n.contains(expected)).count() == 1,
            "{notes:#?}"
        );
    }
    // A map that fits is told nothing, with a hole or without.
    for (map, text) in [(drawn(64), &solver), (with(&drawn(64), &hole), &kept)] {
        let notes = notes(&map, text);
        assert!(notes.iter().all(|n| !n.contains("edges")), "{notes:#?}");
    }
}

#[test]
fn maps_that_theories_have_no_meaning_for_are_refused() {
    let tilted = changed(|map, ix, iy| map.heights()[64 * iy + ix] + 0.01 * ix as f64);
    for text in [PERIODIC, FREE] {
        let message = refused(&tilted, text);
        assert!(message.contains("the map is tilted, subtract it (`detrend = \"plane\"`)"), "{message}");
    }
    // Without the tilt it is taken.
    let level = PERIODIC.replace("size = 1\n", "size = 1\ndetrend = \"plane\"\n");
    assert!(notes(&tilted, &level).iter().all(|n| n.contains("opposite edges")));
    let holes =
        changed(|map, ix, iy| if (ix, iy) == (3, 5) { f64::NAN } else { map.heights()[64 * iy + ix] });
    let kept = PERIODIC.replace("size = 1\n", "size = 1\nundefined = \"no_contact\"\n");
    let message = refused(&holes, &kept);
    assert!(message.contains("undefined points = 1: expected 0") && message.contains("`fill`"), "{message}");
    assert!(notes(&holes, &PERIODIC.replace("size = 1\n", "size = 1\nfill = \"neighbours\"\n")).is_empty());
    // A roll-off, and too few waves.
    let message = refused(&drawn(256), FREE);
    assert!(
        message.contains("expected") && message.contains("of a self-affine surface without roll-off"),
        "{message}"
    );
    let message = refused(&drawn(64), FREE);
    assert!(message.contains("about 128 cells along the shorter side"), "{message}");
    let line = FREE.replace(", \"power_law\"", "");
    let message = refused(&drawn(64), &line.replace("[sampling]\nseed = 1\nsurfaces = 3\n", ""));
    assert!(message.contains("the line that stands for the map is random"), "{message}");
    let message = refused(&drawn(64), &(line + "[scene.body]\nkind = \"sphere\"\nradius = 1\n"));
    assert!(message.contains("the model mdr1d does not support a map on a body"), "{message}");
    let only = PERIODIC.replace(", \"persson\", \"greenwood_williamson\"", "")
        + "[sampling]\nseed = 1\nsurfaces = 2\n";
    assert!(refused(&drawn(64), &only).contains("nothing here is random"));
}

/// The notes of two theories on a random surface with an rms height of 2 um under such loads.
fn notes_under(loads: &str) -> String {
    let text = format!(
        "[scene]\nmodels = [\"persson\", \"greenwood_williamson\"]\ncontact_modulus = \"1 GPa\"\n{loads}\n[scene.surface]\n\
         kind = \"self_affine\"\nhurst = 0.8\nside = \"1 mm\"\nrms_height = \"2 um\"\nroll_off_wavelength = \"0.2 mm\"\n\
         shortest_wavelength = \"20 um\"\n[effects]\nboundary = \"periodic\"\n[outputs]\narea = true\n[sampling]\nseed = 1\n"
    );
    let scene = SceneFile::parse("scene.toml".as_ref(), text).unwrap_or_else(|e| panic!("{e}"));
    let dir = tempfile::tempdir().unwrap();
    let options = Options { out: dir.path().into(), threads: 1, fresh: false };
    let outcome = run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &contact_model::never).unwrap();
    outcome.notes.join("\n")
}

/// The refusal of a mean gap of zero gives the smallest mean gap in metres, although no ratio of the two exists.
#[test]
fn a_mean_gap_of_zero_is_refused_in_metres() {
    let told = |gap: &str| notes_under(&format!("mean_gap = [\"6 um\", \"{gap}\"]"));
    let (zero, one) = (told("0 m"), told("1 nm"));
    assert!(zero.contains("persson: mean gap = 0 m: expected a positive number"), "{zero}");
    assert!(!zero.contains("inf]") && !zero.contains("NaN"), "{zero}");
    let smallest = |notes: &str, gap: &str| {
        let refusal =
            notes.lines().find(|line| line.starts_with("greenwood_williamson: mean gap over rms height"));
        let (_, smallest) = refusal?.split_once(&format!(": here {gap}, and at least "))?;
        Some(smallest.to_owned())
    };
    assert_eq!(smallest(&zero, "0 m").as_deref(), Some("1.392 um in this model"), "{zero}");
    assert_eq!(smallest(&one, "1 nm"), smallest(&zero, "0 m"), "{one}");
}

/// The refusal of a pressure beyond a theory gives it both in the theory's dimensionless number and in pascals.
#[test]
fn a_pressure_beyond_a_theory_is_told_in_pascals() {
    let notes = notes_under("mean_pressure = [\"1 kPa\", \"1 TPa\"]");
    assert!(notes.contains("persson: mean pressure over E* g/sqrt(2)"), "{notes}");
    let (_, limit) = notes.split_once(": here 1 TPa, and at most ").unwrap_or_else(|| panic!("{notes}"));
    assert!(limit.split(" in this model").next().is_some_and(|limit| limit.ends_with(" GPa")), "{notes}");
}
