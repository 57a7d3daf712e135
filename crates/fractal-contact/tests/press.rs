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
fn what_is_missing_is_asked_for_at_once_and_the_command_told_does_it() {
    let dir = folder();
    let (code, _, said) = program(dir.path(), &["press", "holes.txt"]);
    assert_eq!(code, Some(2), "{said}");
    for flag in ["--unit", "--cell", "--undefined", "--contact-modulus", "--pressure"] {
        assert!(said.contains(&format!("\n  {flag}")), "{flag}: {said}");
    }
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
    assert!(scene.contains("detrend = \"plane\"") && scene.contains("undefined = \"no_contact\""), "{scene}");
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
        (&["--contact-modulus", "115"], "contact_modulus = \"115\""),
        (&["--pressure", "1 MPa,2 N"], "\"2 N\""),
        (&["--bodies", "rigid, 70 GPa 0.9"], "0.9"),
        (
            &["--contact-modulus", "1 GPa", "--friction", "0.3"],
            "'--contact-modulus <MODULUS>' cannot be used with '--bodies",
        ),
    ];
    for (wrong, told) in cases {
        let (code, _, said) = program(dir.path(), &[&["press", "map.txt"], wrong].concat());
        let (first, then) = said.split_once("map.txt and the flags do not say").unwrap();
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
        "crop = { row = 0, column = 0, cells = 6 }",
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
    let foreseen = "note: a mean pressure of 62.5 GPa is no state: at the hardness of 2 MPa every cell flows";
    assert!(said.contains(foreseen), "{said}");
}

#[test]
fn files_are_told_in_two_lines() {
    let dir = folder();
    let asked = [
        "press",
        "map.txt",
        "--contact-modulus",
        "1 GPa",
        "--pressure",
        "1 kPa,2 kPa,3 kPa",
        "--out",
        "found",
    ];
    let (code, told, said) = program(dir.path(), &[&asked[..], &FLAGS].concat());
    assert_eq!(code, Some(0), "{said}");
    let lines: Vec<&str> = told.trim_end().lines().rev().take(2).collect();
    assert_eq!(lines[1], "found/report.html");
    assert!(
        lines[0].starts_with("found: results.csv, ") && lines[0].ends_with(" pictures, 3 fields"),
        "{told}"
    );
}
