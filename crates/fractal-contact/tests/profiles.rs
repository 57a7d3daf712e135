//! Profiles x, z of a file in scenes and on the command line.

use fractal_contact::scenes::{Plan, SceneFile};
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

const LINE: &str = "path = \"line.txt\"\nunit = \"nm\"\nlateral_unit = \"um\"\n";

fn program(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fractal-contact"))
        .current_dir(directory)
        .args(arguments)
        .output()
        .unwrap()
}

fn texts(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// A folder with the profile of these heights in nm at steps of 0.5 um.
fn folder(heights: impl IntoIterator<Item = f64>) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for (i, h) in heights.into_iter().enumerate() {
        writeln!(text, "{}\t{h}", 0.5 * i as f64).unwrap();
    }
    std::fs::write(dir.path().join("line.txt"), text).unwrap();
    dir
}

fn rough(i: usize) -> f64 {
    let wave = |k: f64| 40.0 * k.powf(-1.3) * (2.0 * PI * k * i as f64 / 400.0 + k * k).cos();
    (1..100).map(|k| wave(f64::from(k))).sum()
}

/// The text of a scene of that profile.
fn text(scene: &str, surface: &str, rest: &str) -> String {
    format!(
        "[scene]\ncontact_modulus = \"10 GPa\"\n{scene}\n[scene.surface]\nkind = \"file\"\n{LINE}{surface}\n{rest}\n"
    )
}

fn parsed(directory: &Path, scene: &str, surface: &str, rest: &str) -> Result<Plan, String> {
    let text = text(scene, surface, rest);
    let scene = SceneFile::parse(&directory.join("a.toml"), text).map_err(|e| e.to_string())?;
    Plan::new(&scene).map_err(|e| e.to_string())
}

/// Rows of a table by name of the column.
fn column(path: &Path, name: &str) -> Vec<Option<f64>> {
    runs::CsvFile::read(path).unwrap().numbers(name).unwrap()
}

#[test]
fn a_stylus_line_is_answered_in_one_step() {
    let dir = folder((0..400).map(rough));
    let rest = "[outputs]\narea = true\nmean_gap = true\nstiffness = true\npressure = [\"png\", \"npy\"]\ncurves = true\n\
                statistics = true\n[effects]\nboundary = \"periodic\"\n";
    let scene = "models = [\"bem3d\"]\nmean_pressure = [\"1 MPa\", \"10 MPa\"]";
    std::fs::write(dir.path().join("a.toml"), text(scene, "", rest)).unwrap();
    let output = program(dir.path(), &["run", "a.toml", "--out", "out"]);
    let said = texts(&output);
    assert!(output.status.success(), "{said}");
    let plan = texts(&program(dir.path(), &["plan", "a.toml"]));
    assert!(plan.contains("uniform along y") && plan.contains("plane strain"), "{plan}");
    let results = dir.path().join("out/results.csv");
    let areas = column(&results, "area");
    assert!(areas.iter().all(|area| area.is_some_and(|a| a > 0.0)), "{areas:?}");
    assert!(column(&results, "stiffness").iter().all(Option::is_some));
    let page = std::fs::read_to_string(dir.path().join("out/report.html")).unwrap();
    assert!(page.contains("uniform along y") && page.contains("Pq"), "the report says what it is");
    for file in ["pressure-bem3d-0-000.png", "pressure-bem3d-0-001.npy"] {
        assert!(dir.path().join("out").join(file).is_file(), "{file}");
    }
    let parameters = std::fs::read_to_string(dir.path().join("out/statistics.csv")).unwrap();
    assert!(parameters.contains("\nPa,") && !parameters.contains("\nSa,"), "{parameters}");
}

/// A parabola of radius R under free boundaries: `a = sqrt(4 F' R/(pi E*))`, `p0 = 2 F'/(pi a)`.
#[test]
fn a_roller_is_a_line_contact() {
    // R = 1 mm: z = x^2/(2 R) in nm with x in um is x^2/2.
    let dir = folder((0..400).map(|i| -0.5 * (0.5 * f64::from(i) - 99.75).powi(2)));
    let rest = "[outputs]\narea = true\n";
    let scene = "models = [\"bem3d\"]\nforce = \"1 mN\"";
    std::fs::write(dir.path().join("a.toml"), text(scene, "", rest)).unwrap();
    let output = program(dir.path(), &["run", "a.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", texts(&output));
    let results = dir.path().join("out/results.csv");
    let (width, contact_modulus, radius) = (0.5e-6, 1e10, 1e-3);
    let per_length = 1e-3 / width;
    let a = (4.0 * per_length * radius / (PI * contact_modulus)).sqrt();
    let (found, area) =
        (column(&results, "largest_pressure")[0].unwrap(), column(&results, "area")[0].unwrap());
    assert!((found / (2.0 * per_length / (PI * a)) - 1.0).abs() < 2e-3, "{found}");
    assert!((area / width / 2.0 - a).abs() < 0.5e-6, "{area} {a}");
    assert!(column(&results, "approach")[0].is_none());
}

#[test]
fn what_a_profile_is_not_asked_is_refused_with_the_reason() {
    let dir = folder((0..400).map(rough));
    let periodic = "[effects]\nboundary = \"periodic\"\n";
    let loads = "mean_pressure = \"1 MPa\"";
    let seed = "[sampling]\nseed = 1\n";
    let bem = format!("models = [\"bem3d\"]\n{loads}");
    for (scene, surface, rest, expected) in [
        (format!("models = [\"mdr1d\"]\n{loads}"), "", seed.to_owned(), "is not that line"),
        (
            format!("models = [\"persson\"]\n{loads}"),
            "",
            periodic.to_owned(),
            "theory is one of isotropic surfaces",
        ),
        (
            format!("models = [\"greenwood_williamson\"]\n{loads}"),
            "",
            periodic.to_owned(),
            "isotropic surfaces",
        ),
        (format!("models = [\"power_law\"]\n{loads}"), "", String::new(), "isotropic surfaces"),
        (format!("models = [\"hertz\"]\n{loads}"), "", String::new(), "a profile (a body uniform along y)"),
        ("models = [\"bem3d\"]\napproach = \"10 nm\"".into(), "", String::new(), "no zero at infinity"),
        (
            bem.clone(),
            "",
            "[outputs]\nstiffness = true\n".into(),
            "stiffness of a profile with free boundaries",
        ),
        (bem.clone(), "", "[outputs]\ndisplacement = [\"npy\"]\n".into(), "no zero at infinity"),
        (bem.clone(), "", format!("{periodic}adhesion = {{ work = \"1 mJ/m^2\" }}\n"), "adhesion"),
        (bem.clone(), "twin = \"waves\"", seed.to_owned(), "`twin` of a profile"),
        (bem.clone(), "rotate = 90", String::new(), "a profile has one row"),
        (
            bem.clone(),
            "",
            "[scene.body]\nkind = \"sphere\"\nradius = \"1 m\"\n".into(),
            "[scene.body] beside a profile",
        ),
        (
            bem.clone(),
            "",
            format!("[scene.second_surface]\nkind = \"file\"\n{LINE}"),
            "[scene.second_surface] beside a profile",
        ),
        (bem.clone(), "size = \"1 mm\"", String::new(), "one value"),
    ] {
        let error = parsed(dir.path(), &scene, surface, &rest).map(|plan| plan.to_string()).unwrap_err();
        assert!(error.contains(expected), "{scene} {surface} {rest}\n{error}");
    }
    let plan = parsed(dir.path(), &bem, "", "[outputs]\narea = true\n").unwrap().to_string();
    assert!(plan.contains("a profile: the body is taken as uniform along y"), "{plan}");
    // A width along y of one's own.
    let plan = parsed(dir.path(), &bem, "size = [\"200 um\", \"1 mm\"]", "").unwrap().to_string();
    assert!(plan.contains("forces are those on 1 mm") || plan.contains("0.001"), "{plan}");
}

#[test]
fn info_gives_the_parameters_of_a_profile() {
    let dir = folder((0..400).map(rough));
    let arguments = ["info", "line.txt", "--unit", "nm", "--lateral-unit", "um"];
    let output = program(dir.path(), &arguments);
    let said = texts(&output);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("a profile of 400 points") && said.contains("uniform along y"), "{said}");
    let with = [&arguments[..], &["--out", "found"]].concat();
    let said = texts(&program(dir.path(), &with));
    assert!(said.contains("Pq") && said.contains("ISO 21920") && !said.contains("Sq "), "{said}");
    let found = runs::CsvFile::read(&dir.path().join("found/statistics.csv")).unwrap();
    let at = found.texts("quantity").unwrap().iter().position(|name| *name == "H").unwrap();
    let hurst = found.numbers("value").unwrap()[at].unwrap();
    assert!((hurst - 0.8).abs() < 0.1, "{hurst}");
    let spectrum = runs::CsvFile::read(&dir.path().join("found/spectrum.csv")).unwrap();
    assert!(spectrum.texts("direction").unwrap().iter().all(|direction| *direction == "x"));
    assert!(
        dir.path().join("found/report.html").is_file() && dir.path().join("found/spectrum.png").is_file()
    );
}

#[test]
fn lines_that_are_no_profile_are_named() {
    let dir = folder((0..400).map(rough));
    let write = |text: &str| std::fs::write(dir.path().join("line.txt"), text).unwrap();
    let bem = "models = [\"bem3d\"]\nmean_pressure = \"1 MPa\"";
    let many = |of: &dyn Fn(usize) -> String| (0..20).map(of).collect::<String>();
    for (text, surface, expected) in [
        (many(&|i| format!("{i} {}\n", if i == 9 { "nan".into() } else { i.to_string() })), "", "undefined"),
        (many(&|i| format!("{} 1\n", if i == 9 { 9.4 } else { i as f64 })), "", "off the grid"),
        (many(&|i| format!("{}e307 {i}\n", i * 3)), "", ""),
        ("0 1\n1 2\n".into(), "format = \"profile\"\nsize = [\"9 um\", \"1 um\"]", "size along x"),
    ] {
        write(&text);
        let error = parsed(dir.path(), bem, surface, "").map(|plan| plan.to_string()).unwrap_err();
        assert!(error.contains(expected), "{text}\n{error}");
    }
    // Descending x is the same line; two points are one where the format is said; holes may stay undefined.
    for (text, surface) in [
        (many(&|i| format!("{} {}\n", 20 - i, i % 3)), ""),
        ("0 1\n1 2\n".into(), "format = \"profile\""),
        (
            many(&|i| format!("{i} {}\n", if i == 9 { "nan".into() } else { i.to_string() })),
            "undefined = \"no_contact\"",
        ),
        (
            many(&|i| format!("{i} {}\n", if i == 9 { "nan".into() } else { i.to_string() })),
            "fill = \"neighbours\"",
        ),
    ] {
        write(&text);
        let plan = parsed(dir.path(), bem, surface, "").unwrap_or_else(|e| panic!("{text}\n{e}")).to_string();
        assert!(plan.contains("uniform along y"), "{plan}");
    }
}
