//! `press` and `new`: the scene of a map from flags, and what they ask for.

use std::path::Path;
use std::process::{Command, Output};

const FLAGS: [&str; 6] = ["--unit", "nm", "--cell", "0.5 um", "--detrend", "none"];

/// A folder with a map of 8 x 8 heights, two of which are undefined in `holes.txt`.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let rows = |hole: &str| -> String {
        (0..8)
            .map(|y| {
                let row: Vec<String> = (0..8)
                    .map(|x| match (x, y) {
                        (2, 3) => hole.to_owned(),
                        _ => format!("{}", 20 - (x - 4) * (x - 4) - (y - 4) * (y - 4)),
                    })
                    .collect();
                row.join(" ") + "\n"
            })
            .collect()
    };
    std::fs::write(dir.path().join("map.txt"), rows("7")).unwrap();
    std::fs::write(dir.path().join("holes.txt"), rows("nan")).unwrap();
    dir
}

fn program(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_fractal-contact"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

#[test]
fn the_first_command_of_the_readme_prints_what_stands_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let block = |language: &str| {
        let (_, rest) = readme.split_once(&format!("```{language}\n")).unwrap();
        rest.split_once("```").unwrap().0.to_owned()
    };
    let map = root.join("data/scenes/polished.x3p");
    let arguments = [
        "press",
        map.to_str().unwrap(),
        "--bodies",
        "210 GPa 0.3, 210 GPa 0.3",
        "--pressure",
        "2 MPa,5 MPa,20 MPa",
    ];
    let command = block("sh");
    for argument in &arguments[2..] {
        assert!(command.contains(argument), "{command}");
    }
    assert!(command.contains("press data/scenes/polished.x3p"), "{command}");
    let dir = tempfile::tempdir().unwrap();
    let (code, told, notes) = program(dir.path(), &arguments);
    assert_eq!(code, Some(0), "{notes}");
    assert_eq!(told, block("text"));
}

#[test]
fn what_is_missing_is_asked_for_at_once_and_the_command_told_does_it() {
    let dir = folder();
    let (code, _, said) = program(dir.path(), &["press", "holes.txt"]);
    assert_eq!(code, Some(2), "{said}");
    let flags = [
        "--unit",
        "--cell",
        "--size",
        "--undefined",
        "--fill",
        "--bodies",
        "--contact-modulus",
        "--pressure",
    ];
    let places =
        flags.map(|flag| said.find(&format!("\n  {flag}")).unwrap_or_else(|| panic!("{flag}: {said}")));
    assert!(places.is_sorted(), "{said}");
    assert!(said.contains("--bodies '210 GPa 0.3, 210 GPa 0.3'"), "{said}");
    assert!(!dir.path().join("out").exists());
    // The command to copy, as a shell takes it.
    let command = said.trim_end().lines().next_back().unwrap().trim();
    let words: Vec<&str> = command
        .split('\'')
        .enumerate()
        .flat_map(|(i, part)| if i % 2 == 1 { vec![part] } else { part.split_whitespace().collect() })
        .collect();
    let (code, told, said) = program(dir.path(), &words[1..]);
    assert_eq!(code, Some(0), "{said}");
    assert!(told.contains("results.csv"), "{told}");
    let scene = std::fs::read_to_string(dir.path().join("out/holes/scene.toml")).unwrap();
    for line in [
        "detrend = \"plane\"",
        "undefined = \"no_contact\"",
        "\n[effects]\n# \"free\": pressed by itself",
        "\nboundary = \"free\"\n",
    ] {
        assert!(scene.contains(line), "{line} in {scene}");
    }
    let page = std::fs::read_to_string(dir.path().join("out/holes/report.html")).unwrap();
    assert!(page.contains("</h1><p>The boundary is free: the surface is pressed by itself"), "{page}");
    // The scene alone gives the same table.
    let table = || std::fs::read(dir.path().join("out/holes/results.csv")).unwrap();
    let first = table();
    let (code, _, said) =
        program(dir.path(), &["run", "out/holes/scene.toml", "--out", "out/holes", "--fresh"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(table(), first);
}

#[test]
fn a_wrong_flag_is_told_before_what_is_missing_and_not_repeated() {
    let dir = folder();
    let cases: [(&[&str], &str); 5] = [
        (&["--contact-modulus", "115 Gpaa"], "unknown unit \"Gpaa\""),
        (&["--contact-modulus", "115"], "`--contact-modulus` = 115 has no unit"),
        (&["--pressure", "1 MPa,2 N"], "`--pressure` = 1 MPa,2 N: 2 N is a force"),
        (&["--bodies", "rigid, 70 GPa 0.9"], "0.9"),
        (
            &["--contact-modulus", "1 GPa", "--friction", "0.3"],
            "--friction needs --bodies in the place of --contact-modulus",
        ),
    ];
    for (wrong, told) in cases {
        let (code, _, said) = program(dir.path(), &[&["press", "map.txt"], wrong].concat());
        let (first, then) = said.split_once("some flags are missing for the contact of map.txt:").unwrap();
        assert!(code == Some(2) && first.contains(told), "{said}");
        assert!(then.contains("\n  --unit") && then.contains("\n  --cell"), "{said}");
        assert!(!then.contains("fractal-contact press"), "{said}");
        assert!(!dir.path().join("out").exists() && !dir.path().join("scene.toml").exists());
    }
}

#[test]
fn flags_are_keys_of_the_scene() {
    let dir = folder();
    let flags = ["new", "map.txt", "--bodies", "rigid, 70 GPa 0.33", "--force", "1 mN,2 mN"];
    let more = ["--hardness", "1 GPa", "--boundary", "periodic", "--crop", "0,0,6", "--rotate", "90"];
    let (code, told, said) = program(dir.path(), &[&flags[..], &FLAGS, &more].concat());
    assert_eq!((code, told.as_str()), (Some(0), "map.toml\n"), "{said}");
    let scene = std::fs::read_to_string(dir.path().join("map.toml")).unwrap();
    for line in [
        "bodies = [\"rigid\", { young = \"70 GPa\", poisson = 0.33 }]",
        "force = [\"1 mN\", \"2 mN\"]",
        "path = \"map.txt\"",
        "crop = { row = 0, column = 0, rows = 6, columns = 6 }",
        "detrend = \"none\"",
        "rotate = 90",
        "boundary = \"periodic\"",
        "hardness = { pressure = \"1 GPa\" }",
    ] {
        assert!(scene.contains(line), "{line} in {scene}");
    }
    assert_eq!(program(dir.path(), &["plan", "map.toml"]).0, Some(0));
    // It is not written over, nor is the scene taken for a map.
    let (code, _, said) = program(dir.path(), &[&flags[..], &FLAGS].concat());
    assert!(code == Some(2) && said.contains("map.toml exists"), "{said}");
    let (code, _, said) = program(dir.path(), &["press", "map.toml"]);
    assert!(code == Some(2) && said.contains("`fractal-contact run` takes it"), "{said}");
}

/// Every key of a scene is reached by `--set`, which names the value, the key and what was expected where it is
/// wrong.
#[test]
fn set_reaches_every_key() {
    let dir = folder();
    let map = ["new", "map.txt", "--contact-modulus", "1 GPa", "--force", "1 uN"];
    let sets = [
        "scene.surface.rows=4",
        "effects.adhesion={ work = \"50 mJ/m^2\" }",
        "outputs.gap = [\"vti\"]",
        "models.bem3d.tolerance=1e-5",
    ];
    let flags: Vec<&str> = sets.iter().flat_map(|set| ["--set", *set]).collect();
    let (code, _, said) = program(dir.path(), &[&map[..], &FLAGS, &flags].concat());
    assert_eq!(code, Some(0), "{said}");
    let scene = std::fs::read_to_string(dir.path().join("map.toml")).unwrap();
    for line in ["rows = 4", "adhesion = { work = \"50 mJ/m^2\" }", "gap = [\"vti\"]", "tolerance = 1e-5"] {
        assert!(scene.contains(line), "{line} in {scene}");
    }
    for (wrong, told) in [
        ("scene.surface.rows", "no equals sign"),
        ("scene.surface.rows=0", "`scene.surface.rows` = 0: expected a whole number >= 1"),
        ("scene.surface.row=4", "there is no key `scene.surface.row`"),
        ("models.hertz.cells=4", "there is no key `models.hertz.cells`"),
        ("scene.mean_pressure=1 MPa", "`force` and `mean_pressure` are both given"),
        ("effects.friction=\"much\"", "effects.friction"),
    ] {
        let (code, _, said) =
            program(dir.path(), &[&map[..], &FLAGS, &["--scene", "no.toml", "--set", wrong]].concat());
        assert!(code == Some(2) && said.contains(told), "{said}");
        assert!(!dir.path().join("no.toml").exists());
    }
    for (wrong, near) in
        [("effects.hardnes=1 GPa", "effects.hardness"), ("scene.surface.rotat=90", "scene.surface.rotate")]
    {
        let (_, _, said) =
            program(dir.path(), &[&map[..], &FLAGS, &["--scene", "no.toml", "--set", wrong]].concat());
        assert!(said.contains(&format!("did you mean `{near}`?")), "{said}");
    }
}

/// A scene that a model refuses is not written, and the results of another one beside it stay.
#[test]
fn a_refused_scene_writes_nothing() {
    let dir = folder();
    let press = |more: &[&str]| {
        let map = ["press", "map.txt", "--contact-modulus", "1 GPa", "--force", "1 uN"];
        program(dir.path(), &[&map[..], &FLAGS, more].concat())
    };
    let (code, _, said) = press(&["--set", "scene.models=hertz"]);
    assert!(code == Some(2) && said.contains("hertz does not support a height map"), "{said}");
    assert!(!dir.path().join("out/map").exists());
    assert_eq!(press(&[]).0, Some(0));
    let scene = || std::fs::read(dir.path().join("out/map/scene.toml")).unwrap();
    let first = scene();
    assert_eq!(press(&["--set", "scene.models=hertz"]).0, Some(2));
    assert_eq!(scene(), first);
}

#[test]
fn friction_is_a_path_under_a_force() {
    let dir = folder();
    let asked = ["press", "map.txt", "--friction", "0.3", "--pressure", "1 MPa"];
    let (code, _, said) = program(dir.path(), &[&asked[..], &FLAGS].concat());
    assert!(code == Some(2) && said.contains("--bodies") && said.contains("--tangential-force"), "{said}");
    // Bodies that differ: the command told takes their coupling along.
    assert!(said.contains("\n  --coupling ") && said.contains("--coupling full"), "{said}");
    let different = ["--bodies", "rigid, 210 GPa 0.3", "--tangential-force", "2 uN"];
    let (code, _, said) = program(dir.path(), &[&asked[..], &FLAGS, &different].concat());
    assert!(code == Some(2) && said.contains("--coupling") && !said.contains("\n  --bodies"), "{said}");
    let (code, told, said) =
        program(dir.path(), &[&asked[..], &FLAGS, &different, &["--coupling", "full"]].concat());
    assert!(code == Some(0) && told.contains("stick"), "{told}{said}");
    let more = ["--bodies", "210 GPa 0.3, 210 GPa 0.3", "--tangential-force", "2 uN"];
    let (code, told, said) = program(dir.path(), &[&asked[..], &FLAGS, &more].concat());
    assert_eq!(code, Some(0), "{said}");
    assert!(told.contains("stick"), "{told}");
}

#[test]
fn a_law_of_friction_has_flags_of_its_own() {
    let dir = folder();
    let press = |more: &[&str]| {
        let asked = ["press", "map.txt", "--pressure", "1 MPa", "--bodies", "210 GPa 0.3, 210 GPa 0.3"];
        program(dir.path(), &[&asked[..], &FLAGS, more].concat())
    };
    let dragged = ["--tangential-force", "2 uN"];
    for law in [
        &["--shear-strength", "100 GPa"][..],
        &["--friction", "0.3", "--traction-limit", "100 GPa"],
        &["--friction", "0.3", "--shear-strength", "10 MPa", "--traction-limit", "100 GPa"],
    ] {
        let (code, told, said) = press(&[law, &dragged].concat());
        assert!(code == Some(0) && told.contains("stick"), "{law:?} {told} {said}");
    }
    let scene = std::fs::read_to_string(dir.path().join("out/map/scene.toml")).unwrap();
    let line = "friction = { coefficient = 0.3, shear_strength = \"10 MPa\", limit = \"100 GPa\" }";
    assert!(scene.contains(line), "{scene}");
    // A limit caps a law, and a force needs one.
    for lonely in [&["--traction-limit", "1 GPa"][..], &dragged] {
        let (code, _, said) = press(lonely);
        assert!(
            code == Some(2) && said.contains("--friction") && said.contains("--shear-strength"),
            "{said}"
        );
    }
    let (code, _, said) = press(&[&["--shear-strength", "-1 MPa"], &dragged[..]].concat());
    assert!(code == Some(2) && said.contains("shear_strength"), "{said}");
}

#[test]
fn mistakes_leave_nothing_behind() {
    let dir = folder();
    let asked = ["press", "map.txt", "--contact-modulus", "1 GPx", "--pressure", "1 MPa"];
    let (code, _, said) = program(dir.path(), &[&asked[..], &FLAGS].concat());
    assert!(code == Some(2) && said.contains("unknown unit \"GPx\""), "{said}");
    assert!(!dir.path().join("out/map").exists());
    // A value with a sign is a value.
    let pulled = ["press", "map.txt", "--contact-modulus", "1 GPa", "--pressure", "-1 MPa"];
    let (code, _, said) = program(dir.path(), &[&pulled[..], &FLAGS].concat());
    assert!(code == Some(2) && said.contains("the load `mean_pressure` = -1 MPa is negative"), "{said}");
    for (flag, value) in [("--friction", "-0.3"), ("--cells", "-3"), ("--crop", "-1,0,2,2")] {
        let (code, _, said) = program(dir.path(), &["press", "map.txt", flag, value]);
        assert!(
            code == Some(2) && said.contains(&flag[2..]) && !said.contains("unexpected"),
            "{flag}: {said}"
        );
    }
    let (code, _, said) = program(dir.path(), &["press", "nowhere.txt"]);
    assert!(code == Some(1) && said.contains("cannot open nowhere.txt"), "{said}");
    let (code, _, said) = program(dir.path(), &["press", "map.txt", "--bodies", "a, b, c"]);
    assert!(code == Some(2) && said.contains("70 GPa 0.33"), "{said}");
}

#[test]
fn a_tilt_is_told_before_a_map_is_pressed() {
    let dir = folder();
    let rows = (0..8).map(|y| {
        let row: Vec<String> = (0..8).map(|x| (9 * x + (x * y) % 3).to_string()).collect();
        row.join(" ")
    });
    let tilted = rows.collect::<Vec<_>>().join("\n");
    std::fs::write(dir.path().join("tilted.txt"), tilted).unwrap();
    let asked = ["info", "tilted.txt", "--unit", "nm", "--cell", "1 um"];
    let (code, told, _) = program(dir.path(), &asked);
    assert!(code == Some(0) && told.contains("note       the map is tilted"), "{told}");
    let level = program(dir.path(), &[&asked[..], &["--detrend", "plane"]].concat()).1;
    assert!(!level.contains("tilted: "), "{level}");
}

#[test]
fn sides_that_are_exchanged_and_slopes_without_sense_are_told_by_info() {
    let dir = folder();
    let rows = (0..4).map(|y| (0..8).map(|x| ((x * y) % 3).to_string()).collect::<Vec<_>>().join(" "));
    std::fs::write(dir.path().join("wide.txt"), rows.collect::<Vec<_>>().join("\n")).unwrap();
    let info = |more: &[&str]| program(dir.path(), &[&["info", "wide.txt"], more].concat()).1;
    let exchanged = info(&["--unit", "nm", "--size", "4 um x 8 um"]);
    assert!(
        exchanged.contains("note       cells of 500 nm x 2 um: with both sides of `size` exchanged"),
        "{exchanged}"
    );
    let steep = info(&["--unit", "um", "--size", "8 um x 4 um"]);
    assert!(
        steep.contains("every model here assumes small slopes") && !steep.contains("exchanged"),
        "{steep}"
    );
}

#[test]
fn a_force_beyond_the_hardness_is_told_with_units() {
    let dir = folder();
    let asked = ["press", "map.txt", "--contact-modulus", "1 GPa", "--hardness", "2 MPa", "--force", "1 N"];
    let (code, _, said) = program(dir.path(), &[&asked[..], &FLAGS].concat());
    let told = "every cell is at the hardness) = 1 N is outside 0 N to 32 uN, the range in which the model holds; the hardness is 2 MPa";
    assert!(code == Some(3) && said.contains(told), "{said}");
    let foreseen =
        "note: a mean pressure of 62.5 GPa cannot be reached: at the hardness of 2 MPa every cell flows";
    assert!(said.contains(foreseen), "{said}");
}

const PRESSED: [&str; 5] = ["press", "map.txt", "--pressure", "1 kPa,2 kPa,3 kPa", "--out"];

#[test]
fn the_answer_comes_first_and_the_rest_with_verbose() {
    let dir = folder();
    let modulus = ["--contact-modulus", "1 GPa"];
    let (code, told, said) = program(dir.path(), &[&PRESSED[..], &["found"], &modulus, &FLAGS].concat());
    assert_eq!(code, Some(0), "{said}");
    // Standard error: what is solved, what E* means, and what to beware of.
    let mut lines = said.lines();
    assert_eq!(
        lines.next(),
        Some("bem3d, 8 x 8 cells of 500 nm, free boundary, 3 states, less than 1 s"),
        "{said}"
    );
    let modulus_line =
        "E* = 1 GPa: two like bodies with E = 1.82 GPa, or one with E = 910 MPa on a rigid one (nu = 0.3)";
    assert_eq!(lines.next(), Some(modulus_line), "{said}");
    assert!(lines.all(|line| line.starts_with("note: ")), "{said}");
    // Standard output: the states, and one line of files.
    assert!(told.starts_with("bem3d\n") && told.contains("[kPa]"), "{told}");
    let files = told.lines().next_back().unwrap();
    assert!(files.starts_with("found/report.html, and beside it scene.toml, results.csv, "), "{files}");
    assert!(files.ends_with(" pictures, 6 fields"), "{files}");
    assert!(told.lines().filter(|line| *line != files).all(|line| line.chars().count() <= 80), "{told}");
    // With both bodies E* is no question.
    let bodies = ["--bodies", "1 GPa 0.3", "--verbose"];
    let (code, told, said) = program(dir.path(), &[&PRESSED[..], &["all"], &bodies, &FLAGS].concat());
    assert_eq!(code, Some(0), "{said}");
    assert!(told.starts_with("bem3d\n") && told.contains("[kPa]"), "{told}");
    for words in [
        "all/scene.toml\n",
        "\neffects\n",
        "\nmodels\n  bem3d\n    grid       8 x 8 cells of 500 nm\n",
        "estimate    ",
        "from the sizes and times stored in the program, within a factor of ten",
        "1 job done in ",
        "  predicted  ",
        "  actual     ",
        "states       3 requested, 3 in the table (0 of them kept from an earlier run)",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let (_, _, said) = program(dir.path(), &[&PRESSED[..], &["all"], &bodies, &FLAGS].concat());
    assert!(said.contains("(3 of them kept from an earlier run)"), "{said}");
    // `plan` still solves small grids.
    let (code, told, _) = program(dir.path(), &["plan", "all/scene.toml"]);
    assert!(code == Some(0) && told.contains("from small solves on this machine"), "{told}");
}

/// The text of a cell in a table with a row for each quantity.
fn cell<'a>(table: &'a str, quantity: &str, state: usize) -> &'a str {
    let line = table.lines().find(|line| line.trim_start().starts_with(quantity)).unwrap();
    line.split("  ").filter(|part| !part.trim().is_empty()).nth(state + 1).unwrap().trim()
}

#[test]
fn a_number_stands_beside_its_error() {
    let dir = tempfile::tempdir().unwrap();
    let height =
        |x: f64, y: f64| 20.0 * ((0.3 * x).sin() * (0.25 * y).cos() + 0.4 * (0.9 * x + 1.1 * y).sin());
    let rows = (0..64).map(|y| {
        let row = (0..64).map(|x| format!("{:.4}", height(f64::from(x), f64::from(y))));
        row.collect::<Vec<_>>().join(" ") + "\n"
    });
    std::fs::write(dir.path().join("map.txt"), rows.collect::<String>()).unwrap();
    let asked = ["press", "map.txt", "--pressure", "0.5 MPa,1 MPa,2 MPa", "--out", "waves"];
    let more = ["--bodies", "1 GPa 0.3", "--boundary", "periodic"];
    let (code, told, said) = program(dir.path(), &[&asked[..], &more, &FLAGS].concat());
    assert_eq!(code, Some(0), "{said}");
    assert!(said.starts_with("bem3d, 64 x 64 cells of 500 nm, periodic boundary, 3 states, "), "{said}");
    let page = std::fs::read_to_string(dir.path().join("waves/report.html")).unwrap();
    assert!(page.contains("</h1><p>The boundary is periodic: the surface is one tile of an endless surface"));
    let file = runs::CsvFile::read(&dir.path().join("waves/results.csv")).unwrap();
    let column = |name: &str| file.numbers(name).unwrap();
    // Errors are shares in the file and have the unit of their number in the table.
    for (quantity, errors) in [
        ("stiffness", &["stiffness_grid_error", "stiffness_error"][..]),
        ("area", &["area_grid_error"]),
        ("contact_fraction", &["area_grid_error"]),
    ] {
        for state in 0..3 {
            let shown = cell(&told, &format!("{quantity} ["), state);
            let (value, error) = shown.split_once(" +- ").unwrap_or_else(|| panic!("{quantity}: {told}"));
            let [value, error] = [value, error].map(|text| text.parse::<f64>().unwrap());
            let share: f64 = errors.iter().map(|name| column(name)[state].unwrap()).sum();
            // Two digits, or one that is 3 at least; the value ends at the same decimal place.
            assert!((error / value / share - 1.0).abs() < 0.3, "{quantity}: {shown}, {share}");
        }
    }
    assert!(!told.contains("_grid_error"), "{told}");
    assert!(
        told.contains("The number behind +- is the estimated error of the grid and of the solver."),
        "{told}"
    );
    assert!(
        page.contains("The number behind ± is the estimated error of the grid"),
        "the report says what it is"
    );
}

/// `press` overwrites a file called `scene.toml` only if it is a scene that `press` has written.
#[cfg(unix)]
#[test]
fn press_overwrites_nothing_of_others() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let needed = ["press", "map.txt", "--bodies", "70 GPa 0.33", "--force", "1 uN"];
    let press = |out: &str| program(dir.path(), &[&needed[..], &FLAGS[..], &["--out", out]].concat());
    std::fs::create_dir(at("mine")).unwrap();
    std::fs::write(at("mine/scene.toml"), "# mine\n").unwrap();
    std::fs::create_dir(at("link")).unwrap();
    std::fs::write(at("precious"), "precious").unwrap();
    std::os::unix::fs::symlink(at("precious"), at("link/scene.toml")).unwrap();
    std::fs::create_dir(at("pipe")).unwrap();
    assert!(Command::new("mkfifo").arg(at("pipe/scene.toml")).status().unwrap().success());
    for (out, why) in [
        ("mine", "was not written by `press`"),
        ("link", "is a symbolic link"),
        ("pipe", "is not a regular file"),
    ] {
        let (code, _, stderr) = press(out);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains(&format!("{out}/scene.toml {why}")), "{stderr}");
    }
    assert_eq!(std::fs::read_to_string(at("mine/scene.toml")).unwrap(), "# mine\n");
    assert_eq!(std::fs::read_to_string(at("precious")).unwrap(), "precious");
    // Its own scene is, and so is one whose folder is a link: the map is the one that was named.
    assert_eq!(press("plain").0, Some(0));
    assert_eq!(press("plain").0, Some(0));
    std::fs::create_dir_all(at("far/results")).unwrap();
    std::fs::write(at("far/map.txt"), "0 1\n1 0\n").unwrap();
    std::os::unix::fs::symlink(at("far/results"), at("linked")).unwrap();
    assert_eq!(press("linked/map").0, Some(0));
    // The comments have the path of the map.
    let rows = |out: &str| -> Vec<String> {
        let table = std::fs::read_to_string(at(out).join("patches.csv")).unwrap();
        table.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect()
    };
    assert_eq!(rows("linked/map"), rows("plain"));
}

/// The outputs that `press` requests are those that the contact has: an error of the grid with a hardness, the mean
/// gap of a periodic map, and no stiffness of a profile with free boundaries.
#[test]
fn requested_outputs_are_those_that_the_contact_has() {
    let dir = folder();
    let map = ["press", "map.txt", "--contact-modulus", "1 GPa", "--force", "1 uN"];
    let pressed = |more: &[&str]| {
        let (code, table, said) = program(dir.path(), &[&map, &FLAGS[..], more].concat());
        assert_eq!(code, Some(0), "{said}");
        (table, std::fs::read_to_string(dir.path().join("out/map/scene.toml")).unwrap())
    };
    let (table, scene) = pressed(&["--hardness", "1 GPa"]);
    assert!(scene.contains("grid_error = true") && !scene.contains("mean_gap"), "{scene}");
    assert!(table.contains(" pictures, 2 fields\n"), "{table}");
    let (table, _) = pressed(&["--boundary", "periodic"]);
    assert!(table.contains("mean_gap") && table.contains("stiffness"), "{table}");

    let points: Vec<String> = (0..64).map(|i: i32| format!("{i} {}", -(i - 32).pow(2))).collect();
    let text = format!("# x [um]\tz [nm]\n{}\n", points.join("\n"));
    std::fs::write(dir.path().join("line.txt"), text).unwrap();
    let line =
        ["press", "line.txt", "--contact-modulus", "1 GPa", "--pressure", "1 MPa", "--detrend", "none"];
    let (code, table, said) = program(dir.path(), &line);
    assert!(code == Some(0) && !table.contains("stiffness"), "{code:?} {table}{said}");
    assert!(said.contains("a profile: the body is taken as uniform along y"), "{said}");
}

/// A ball that bears the map, more quantities by their names, and pictures of stick and slip at half and at all of a
/// tangential force.
#[test]
fn a_ball_more_outputs_and_stick_and_slip_are_asked_for_by_flags() {
    let dir = folder();
    let map = ["press", "map.txt", "--force", "1 uN"];
    let pressed = |more: &[&str]| program(dir.path(), &[&map, &FLAGS[..], more].concat());
    let scene = || std::fs::read_to_string(dir.path().join("out/map/scene.toml")).unwrap();
    let bodies = ["--bodies", "1 GPa 0.3, 1 GPa 0.3"];
    let more = ["--ball", "10 mm", "--outputs", "stiffness_fixed_area,displacement,pressure"];
    let (code, told, said) = pressed(&[&bodies[..], &more].concat());
    assert_eq!(code, Some(0), "{said}");
    assert!(told.contains("stiffness_fixed_area"), "{told}");
    let text = scene();
    for line in ["radius = \"10 mm\"", "displacement = [\"npy\", \"png\"]", "stiffness_fixed_area = true"] {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(dir.path().join("out/map/displacement-bem3d-0-000.npy").exists());
    let (code, _, said) = pressed(&[&bodies[..], &["--outputs", "wetness"]].concat());
    assert!(code == Some(2) && said.contains("wetness") && said.contains("outputs are stiffness"), "{said}");
    let (code, _, said) =
        pressed(&[&bodies[..], &["--friction", "0.3", "--tangential-force", "0.2 uN"]].concat());
    assert_eq!(code, Some(0), "{said}");
    let drawn = |name: &str| -> Vec<usize> {
        let exists =
            |state: &usize| dir.path().join(format!("out/map/{name}-bem3d-0-{state:03}.png")).exists();
        (0..9).filter(exists).collect()
    };
    assert_eq!((drawn("stick_slip"), drawn("pressure")), (vec![4, 8], vec![4, 8]));
}
