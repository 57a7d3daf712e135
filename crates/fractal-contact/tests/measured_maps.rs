//! Measured maps in scenes and on the command line: channels, preprocessing, two bodies.

use contact_model::{HeightMap, Surface};
use fractal_contact::scenes::{Options, Plan, SceneFile, SceneSurface, run};
use runs::Silent;
use serde_json::Value;
use std::process::Command;

/// Heights in micrometres of three rows of four points.
fn heights(row: usize, column: usize) -> f64 {
    [[0.0, 3.0, 1.0, 2.0], [5.0, 4.0, 0.5, 1.5], [2.5, 0.0, 6.0, 3.5]][row][column]
}

/// A folder with that map as `lower.npy` and `upper.x3p`, its cells 1 mm, and a scene of these keys.
fn folder(keys: &str) -> (tempfile::TempDir, fractal_contact::scenes::Result<SceneFile>) {
    let dir = tempfile::tempdir().unwrap();
    let all: Vec<f64> = (0..12).map(|i| heights(i / 4, i % 4)).collect();
    std::fs::write(dir.path().join("lower.npy"), surface_io::npy(&[3, 4], &all).unwrap()).unwrap();
    let metres = all.iter().map(|h| h * 1e-6).collect();
    let map = HeightMap::new([4, 3], [4e-3, 3e-3], metres).unwrap();
    let upper = surface_io::map_file("x3p", &map, surface_io::Metric::Metres).unwrap();
    std::fs::write(dir.path().join("upper.x3p"), upper).unwrap();
    let text = format!(
        "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"1 GPa\"\nforce = \"1 N\"\n[scene.surface]\n\
         kind = \"file\"\npath = \"lower.npy\"\nunit = \"um\"\ncell = \"1 mm\"\ndetrend = \"none\"\n{keys}\n"
    );
    let scene = SceneFile::parse(&dir.path().join("a.toml"), text);
    (dir, scene)
}

fn map(scene: &SceneFile) -> &HeightMap {
    match &scene.surface {
        SceneSurface::Plain(Surface::Heights(map)) => map,
        other => panic!("{other:?}"),
    }
}

#[test]
fn two_bodies_lie_face_to_face() {
    const SECOND: &str =
        "[scene.second_surface]\nkind = \"file\"\npath = \"upper.x3p\"\ndetrend = \"none\"\n";
    // Where the point of the second body lies that is over [row, column] of the first.
    type FacingPoint = fn(usize, usize) -> [usize; 2];
    let cases: [(&str, [usize; 2], FacingPoint); 5] = [
        ("", [3, 4], |row, column| [row, 3 - column]),
        ("facing = \"y\"", [3, 4], |row, column| [2 - row, column]),
        ("facing = \"none\"", [3, 4], |row, column| [row, column]),
        // Its middle one cell farther along x: the first column has none over it.
        ("offset = [\"1 mm\", \"0 mm\"]", [3, 3], |row, column| [row, 3 - column]),
        ("facing = \"none\"\nmirror = \"x\"\nrotate = 180", [3, 4], |row, column| [2 - row, column]),
    ];
    for (keys, [rows, columns], over) in cases {
        let (_dir, scene) = folder(&format!("{SECOND}{keys}"));
        let scene = scene.unwrap_or_else(|e| panic!("{keys}: {e}"));
        let found = map(&scene);
        assert_eq!((found.rows(), found.columns()), (rows, columns), "{keys}");
        for (i, h) in found.heights().iter().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let [second_row, second_column] = over(row, column);
            let expected = heights(row, column + 4 - columns) + heights(second_row, second_column);
            approx::assert_relative_eq!(*h, expected * 1e-6, max_relative = 1e-12);
        }
    }
    for (keys, expected) in [
        ("facing = \"up\"", "`scene.second_surface.facing` is \"up\""),
        ("offset = \"1 mm\"", "`offset` has not two values"),
        ("offset = [\"9 mm\", \"0 mm\"]", "expected one cell at least that both cover"),
    ] {
        let error = folder(&format!("{SECOND}{keys}")).1.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let alone = "[scene.body]\nkind = \"sphere\"\nradius = \"1 m\"\nside = \"4 mm\"";
    let random = SceneFile::parse(
        "a.toml".as_ref(),
        format!(
            "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"1 GPa\"\nforce = \"1 N\"\n{alone}\n{SECOND}"
        ),
    );
    assert!(random.unwrap_err().to_string().contains("is added to a measured [scene.surface]"));
}

#[test]
fn what_is_done_to_a_map_is_in_its_manifest() {
    let keys = "crop = \"centre\"\nalign_lines = \"median_difference\"\nscars = 5\noutliers = 1e6\ntip_radius = \"1 mm\"\nmirror = \"y\"\nrotate = 90\nwindow = \"hann\"\n\
                [outputs]\nstiffness = true\n[models.bem3d]\ntolerance = 1e-6";
    let (dir, scene) = folder(keys);
    let scene = scene.unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&scene).unwrap();
    let out = dir.path().join("out");
    let options = Options { out: out.clone(), threads: 1, fresh: false };
    run(&scene, &plan, &options, &Silent, &|| false).unwrap();
    let manifest = std::fs::read_to_string(out.join("manifest.json")).unwrap();
    for step in [
        "cropped to 3 x 3 points from row 0, column 0 (from 0)",
        "; mean height kept",
        "0 points of scars made undefined, in 0 runs along x: beyond 5 times ",
        "0 outliers beyond 1000000 robust standard deviations made undefined",
        "with a tip of radius 1 mm, heights are reliable",
        "y reversed",
        "turned by 90 degrees",
        "deviations from the mean tapered by Hann's window",
    ] {
        assert!(manifest.contains(step), "{step}\n{manifest}");
        assert!(plan.to_string().contains(step), "{step}\n{plan}");
    }
    let error = folder("rotate = 45").1.unwrap_err().to_string();
    assert!(error.contains("`scene.surface.rotate` = 45: expected 0, 90, 180 or 270"), "{error}");
}

/// A map of 20 lines of 40 points with offsets of the lines and a streak: through scene, manifest and command
/// line.
#[test]
fn scan_lines_are_repaired_where_it_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let noise = |i: usize| ((i as f64) * 12.9898).sin() * 1e-3;
    let streak = |i: usize| if i / 40 == 6 && i % 40 < 16 { 5.0 } else { 0.0 };
    let values: Vec<f64> = (0..800).map(|i| noise(i) + streak(i) + ((i / 40) as f64).sin()).collect();
    let bytes = surface_io::npy(&[20, 40], &values).unwrap();
    std::fs::write(dir.path().join("afm.npy"), bytes).unwrap();
    let scene = |keys: &str| {
        let text = format!(
            "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"1 GPa\"\nforce = \"1 N\"\n[scene.surface]\n\
             kind = \"file\"\npath = \"afm.npy\"\nunit = \"um\"\ncell = \"1 mm\"\ndetrend = \"none\"\n{keys}\n"
        );
        SceneFile::parse(&dir.path().join("a.toml"), text)
    };
    let keys =
        "align_lines = \"median_difference\"\nscars = 6\nfill = \"neighbours\"\nfilter_across = \"5 mm\"";
    let found = scene(keys).unwrap_or_else(|e| panic!("{e}"));
    let deviation = 1e6 * surface_gen::rms_height(map(&found).heights());
    assert!(deviation < 1e-3, "{deviation}");
    let plan = Plan::new(&found).unwrap().to_string();
    for step in [
        "the median of differences to the line before is zero; mean height kept",
        "16 points of scars made undefined, in 1 run along x: beyond 6 times ",
        "16 undefined points filled",
        "filtered across the scan lines, cut-off 5 mm: rms height ",
    ] {
        assert!(plan.contains(step), "{step}\n{plan}");
    }
    for (keys, expected) in [
        ("align_lines = \"mean\"", "`scene.surface.align_lines` is \"mean\""),
        ("scars = -1", "scars = -1: expected a number > 0 of robust standard deviations"),
        ("scars = nan", "scars"),
        ("filter_across = \"-1 mm\"", "filter_across"),
        ("filter_across = \"0 mm\"", "filter_across"),
        ("filter_across = 4", "filter_across"),
        (
            "filter_across = \"3 mm\"",
            "filter_across = 0.003: expected a wavelength from 0.004, four cells, to 0.02",
        ),
        ("align_lines = \"median\"\nscars = 6", "16 of 800 points are undefined"),
    ] {
        let error = scene(keys).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(expected), "{keys}: {error}");
    }
    let info = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fractal-contact"));
        let declared = ["info", "afm.npy", "--unit", "um", "--cell", "1 mm"];
        let output = command.args(declared).args(arguments).current_dir(dir.path()).output().unwrap();
        let text = [output.stdout, output.stderr].concat();
        (output.status.code(), String::from_utf8_lossy(&text).into_owned())
    };
    let (code, text) = info(&["--align-lines", "median", "--scars", "6", "--filter-across", "5 mm"]);
    assert!(code == Some(0) && text.contains("then       16 points of scars made undefined"), "{text}");
    assert!(text.contains("all have the same median") && text.contains("cut-off 5 mm"), "{text}");
    let (code, text) = info(&["--align-lines", "up"]);
    assert!(code != Some(0) && text.contains("[possible values: median_difference, median]"), "{text}");
    let (_, text) = info(&["--filter-across", "30 mm"]);
    assert!(text.contains("filter_across = 0.03: expected"), "{text}");
}

#[test]
fn channels_are_told_and_chosen() {
    let (dir, _) = folder("");
    let info = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fractal-contact"));
        let output = command.arg("info").args(arguments).current_dir(dir.path()).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let (code, text, _) = info(&["upper.x3p", "--json"]);
    let found: Value = serde_json::from_str(&text).unwrap();
    let channel = &found["channels"][0];
    assert_eq!((code, found["channels"].as_array().unwrap().len()), (Some(0), 1));
    assert_eq!(
        (&channel["columns"], &channel["rows"], &channel["unit"]),
        (&4.into(), &3.into(), &"m".into())
    );
    let number = |value: &Value| value.as_f64().unwrap();
    approx::assert_relative_eq!(number(&channel["size"][0]), 4e-3, max_relative = 1e-12);
    approx::assert_relative_eq!(number(&channel["maximum"]), 6e-6, max_relative = 1e-12);
    assert!(number(&channel["minimum"]).abs() < 1e-18 && number(&channel["undefined"]).abs() < 1e-18);
    // What the file does not say is null.
    let (_, text, _) = info(&["lower.npy", "--json"]);
    let found: Value = serde_json::from_str(&text).unwrap();
    assert!(found["channels"][0]["size"].is_null() && found["channels"][0]["unit"].is_null(), "{text}");
    // Each step is done, whether or not the size is known.
    for (file, known) in [("upper.x3p", true), ("lower.npy", false)] {
        let (code, text, said) = info(&[file, "--json", "--crop", "1,1,2,2", "--detrend", "mean"]);
        let found: Value =
            serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}{said}"));
        let channel = &found["channels"][0];
        assert_eq!((code, &channel["columns"], &channel["rows"]), (Some(0), &2.into(), &2.into()), "{text}");
        assert_eq!(
            (channel["size"].is_null(), channel["steps"].as_array().unwrap().len()),
            (!known, 2),
            "{text}"
        );
        assert!(number(&channel["maximum"]) > 0.0 && number(&channel["minimum"]) < 0.0, "{text}");
    }
    let (code, _, said) = info(&["upper.x3p", "--channel", "3"]);
    assert!(code == Some(1) && said.contains("channel 3 is not in the file: the channels are 0"), "{said}");
    let (code, text, _) = info(&["upper.x3p", "--channel", "0", "--rotate", "90"]);
    assert!(code == Some(0) && text.contains("then       turned by 90 degrees"), "{text}");
    assert!(info(&["upper.x3p", "--rotate", "45"]).2.contains("`--rotate` = 45: expected 0, 90, 180 or 270"));
    assert!(info(&["nowhere.x3p", "--json"]).2.contains("nowhere.x3p"));
    // A single channel without heights is described all the same.
    let phase = "# Channel: Phase\n# Width: 2 um\n# Height: 1 um\n# Value units: deg\n1 2 3 4\n5 6 7 8\n";
    std::fs::write(dir.path().join("phase.txt"), phase).unwrap();
    let (code, text, said) = info(&["phase.txt"]);
    assert!(code == Some(0) && text.contains("1 channel, whose values are no heights"), "{text}{said}");
    assert!(text.contains("Phase"), "{text}");
}
