//! Rectangles, oblong cells and undefined points: scenes, results, the program.

use contact_model::{Cells, HeightMap, Size, Surface};
use fractal_contact::scenes::{Options, Plan, SceneFile, SceneSurface, run};
use runs::{CsvFile, Silent};
use std::path::Path;
use std::process::Command;

/// A few roundings.
const ROUNDING: f64 = 1e-12;

/// A scene of one file in a folder with `map.npy`: 3 rows of 4 heights, of which [1, 2] is undefined.
fn of_file(keys: &str) -> fractal_contact::scenes::Result<SceneFile> {
    let dir = tempfile::tempdir().unwrap();
    let mut heights: Vec<f64> = (0..12).map(f64::from).collect();
    heights[6] = f64::NAN;
    std::fs::write(dir.path().join("map.npy"), surface_io::npy(&[3, 4], &heights).unwrap()).unwrap();
    let text = format!(
        "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"1 GPa\"\nforce = \"1 N\"\n[scene.surface]\n\
         kind = \"file\"\npath = \"map.npy\"\nunit = \"um\"\n{keys}\n"
    );
    SceneFile::parse(&dir.path().join("a.toml"), text)
}

fn map(scene: &SceneFile) -> &HeightMap {
    match &scene.surface {
        SceneSurface::Plain(Surface::Heights(map)) => map,
        other => panic!("{other:?}"),
    }
}

#[test]
fn files_take_two_sides_or_the_sides_of_a_cell() {
    for (keys, size) in [
        ("size = [\"8 mm\", \"3 mm\"]", [8e-3, 3e-3]),
        ("cell = [\"2 mm\", \"1 mm\"]", [8e-3, 3e-3]),
        ("cell = \"2 mm x 1 mm\"", [8e-3, 3e-3]),
        ("cell = \"1 mm\"", [4e-3, 3e-3]),
        ("width = \"4 mm\"", [4e-3, 3e-3]),
    ] {
        let scene = of_file(&format!("{keys}\nundefined = \"no_contact\"")).unwrap_or_else(|e| panic!("{e}"));
        let map = map(&scene);
        assert_eq!((map.cells(), map.undefined()), ([4, 3].into(), 1), "{keys}");
        for (found, expected) in [(map.size().x, size[0]), (map.size().y, size[1])] {
            approx::assert_relative_eq!(found, expected, max_relative = ROUNDING);
        }
        // Rows along y.
        assert_eq!((map.heights()[4], map.heights()[6]), (4e-6, f64::NEG_INFINITY));
        assert!(
            scene.surface.describe(scene.system).contains("a map of 4 x 3 cells, sides "),
            "{}",
            scene.surface.describe(scene.system)
        );
        assert!(scene.surface.describe(scene.system).ends_with("1 undefined points"));
        // The map is a tilted one as well.
        assert_eq!(scene.notes.len(), 1 + usize::from(keys.starts_with("width")));
    }
    let note = of_file("width = \"4 mm\"\nfill = \"plane\"").unwrap().notes[0].to_string();
    assert!(note.starts_with("note: `width` is now `size`\n"), "{note}");
    assert!(note.contains("a.toml:9:1\n") && note.contains("9 | width = \"4 mm\"\n"), "{note}");
    assert!(note.contains("= help: write `size = [Lx, Ly]`"), "{note}");
}

#[test]
fn treatments_of_rectangles() {
    let cropped =
        of_file("cell = \"1 mm\"\ncrop = { row = 0, column = 1, rows = 2, columns = 3 }\nfill = \"-1 um\"");
    let cropped = cropped.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(map(&cropped).cells(), Cells { columns: 3, rows: 2 });
    assert_eq!(map(&cropped).heights(), [1e-6, 2e-6, 3e-6, 5e-6, -1e-6, 7e-6]);
    let old = of_file("cell = \"1 mm\"\ncrop = { row = 0, column = 0, cells = 2 }").unwrap();
    assert_eq!(map(&old).heights(), [0.0, 1e-6, 4e-6, 5e-6]);
    let coarse = of_file("cell = \"1 mm\"\nundefined = \"no_contact\"\ncells = 2\nrows = 3").unwrap();
    assert_eq!(map(&coarse).cells(), Cells { columns: 2, rows: 3 });
    assert_eq!(map(&coarse).heights()[2..4], [4.5e-6, 7e-6]);
    let error = of_file("cell = \"1 mm\"\ncrop = { row = 0, column = 0, cells = 2, rows = 2 }").unwrap_err();
    assert!(error.to_string().contains("`cells` and `rows` are both given"), "{error}");
    // The body on it has its rectangle, and the undefined point stays.
    let text = "size = [\"8 mm\", \"3 mm\"]\nundefined = \"no_contact\"\n[scene.body]\nkind = \"sphere\"\nradius = \"1 m\"";
    let sum = of_file(text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(map(&sum).undefined(), 1);
    approx::assert_relative_eq!(map(&sum).heights()[0], -(9e-6 + 1e-6) / 2.0, max_relative = ROUNDING);
}

fn generated(keys: &str) -> SceneFile {
    let text = format!("[scene]\nunits = \"none\"\n{keys}");
    SceneFile::parse("a.toml".as_ref(), text).unwrap_or_else(|e| panic!("{e}"))
}

fn results(scene: &SceneFile) -> CsvFile {
    let dir = tempfile::tempdir().unwrap();
    let options = Options { out: dir.path().into(), threads: 1, fresh: true };
    let plan = Plan::new(scene).unwrap_or_else(|e| panic!("{e}"));
    run(scene, &plan, &options, &Silent, &contact_model::never).unwrap_or_else(|e| panic!("{e}"));
    CsvFile::read(&dir.path().join("results.csv")).unwrap()
}

fn number(file: &CsvFile, name: &str) -> f64 {
    file.numbers(name).unwrap()[0].unwrap_or_else(|| panic!("no {name}"))
}

/// L is sqrt(Lx Ly), areas are counted over Lx Ly.
#[test]
fn results_of_a_rectangle() {
    let scene = generated(
        "models = [\"hertz\"]\ncontact_modulus = 2\nmean_pressure = 1e-3\n[scene.body]\nkind = \"sphere\"\nradius = 1\n\
         size = [9, 1]\n[outputs]\nstiffness = true\narea = true\n",
    );
    assert_eq!(scene.surface.size(), Size { x: 9.0, y: 1.0 });
    let file = results(&scene);
    approx::assert_relative_eq!(number(&file, "force"), 9e-3, max_relative = ROUNDING);
    let (k, area) = (number(&file, "stiffness"), number(&file, "area"));
    approx::assert_relative_eq!(
        number(&file, "stiffness_bar"),
        k / (1.1419 * 2.0 * 3.0),
        max_relative = ROUNDING
    );
    approx::assert_relative_eq!(number(&file, "contact_fraction"), area / 9.0, max_relative = ROUNDING);
    let plan = Plan::new(&scene).unwrap().to_string();
    assert!(plan.contains("a sphere on a rectangle of sides 9 x 1"), "{plan}");

    let rough = "models = [\"mdr1d\"]\ncontact_modulus = 1\nforce_bar = 0.1\n[scene.surface]\nkind = \"self_affine\"\nhurst = 0.7\n\
                 rms_height = 0.01\nSIZE\n[models.mdr1d]\nelements = 256\n[sampling]\nseed = 1\n";
    let force = |size: &str| number(&results(&generated(&rough.replace("SIZE", size))), "force");
    approx::assert_relative_eq!(force("size = [4, 1]"), force("side = 2"), max_relative = ROUNDING);
    assert_eq!(force("size = 2").to_bits(), force("side = 2").to_bits());
    assert_eq!(force("size = [2, 2]").to_bits(), force("side = 2").to_bits());

    // The table had another name.
    let old = generated(&rough.replace("SIZE", "side = 2").replace("[sampling]", "[chance]"));
    assert_eq!((old.sampling.seed, old.notes.len()), (1, 1));
    assert!(old.notes[0].to_string().starts_with("note: `[chance]` is now `[sampling]`"), "{}", old.notes[0]);
}

#[test]
fn columns_and_rows_of_boundary_elements() {
    let of = |options: &str| {
        generated(&format!(
            "models = [\"bem3d\"]\ncontact_modulus = 1\nforce = 1\n[scene.surface]\nkind = \"self_affine\"\nhurst = 0.7\n\
             rms_height = 0.01\nsize = [4, 1]\n[scene.body]\nkind = \"sphere\"\nradius = 3\n[models.bem3d]\n{options}\n\
             [sampling]\nseed = 1\n"
        ))
    };
    for (options, cells) in [("cells = 64", [64, 16]), ("cells = 64\nrows = 64", [64, 64])] {
        let scene = of(options);
        let elements = scene.models[0].boundary_elements().unwrap();
        assert_eq!(elements.grid(scene.surface.size()), cells.into());
        // A sum of a rough surface and a body is drawn on these cells.
        match scene.scene(&scene.models[0], 1).unwrap().surface {
            Surface::Heights(map) => assert_eq!((map.cells(), map.size()), (cells.into(), [4.0, 1.0].into())),
            other => panic!("{other:?}"),
        }
    }
}

fn program(arguments: &[&str]) -> (bool, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_fractal-contact")).args(arguments).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8(text).unwrap())
}

#[test]
fn the_program_makes_and_tells_rectangles() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    let told = [
        "cells              64 x 16",
        "size               4 mm x 1 mm",
        "cell               62.5 um x 62.5 um",
    ];
    for name in ["s.txt", "s.xyz", "s.npy", "s.vti"] {
        let made = program(&[
            "surface",
            &path(name),
            "--seed",
            "1",
            "--cells",
            "64",
            "--size",
            "4 mm x 1 mm",
            "--rms-height",
            "1 um",
        ]);
        assert!(made.0 && told.iter().all(|line| made.1.contains(line)), "{made:?}");
    }
    for file in ["s.txt", "s.xyz"] {
        let (done, info) = program(&["info", &path(file)]);
        assert!(done && told.iter().all(|line| info.contains(line)), "{info}");
        assert!(info.contains("size       4 mm x 1 mm (from the file)"), "{info}");
        assert!(info.contains("rms height         1 um"), "{info}");
    }
    let (_, info) = program(&["info", &path("s.npy"), "--unit", "m", "--size", "4 mm x 1 mm"]);
    assert!(told.iter().all(|line| info.contains(line)) && info.contains("(as given)"), "{info}");
    let (_, info) = program(&["info", &path("s.npy"), "--unit", "m", "--cell", "1 um x 2 um"]);
    assert!(info.contains("cell               1 um x 2 um"), "{info}");
    let (done, text) = program(&["info", &path("s.npy"), "--size", "4 mm", "--unit", "m"]);
    assert!(!done && text.contains("there are 16 rows of 64"), "{text}");
    let oblong = program(&[
        "surface",
        &path("o.txt"),
        "--seed",
        "1",
        "--cells",
        "64",
        "--rows",
        "64",
        "--size",
        "4 x 1",
    ]);
    assert!(oblong.0 && oblong.1.contains("cell               0.0625 x 0.015625"), "{oblong:?}");
    let mixed = program(&["surface", &path("m.txt"), "--seed", "1", "--size", "4 mm x 1"]);
    assert!(!mixed.0 && mixed.1.contains("all lengths"), "{mixed:?}");
    std::fs::write(path("u.txt"), "# Width: 3 um\n# Height: 2 um\n# Value units: nm\n1 2 3\n4 nan 6\n")
        .unwrap();
    let (done, info) = program(&["info", &path("u.txt")]);
    assert!(done && info.contains("undefined points   1 of 6"), "{info}");
    assert!(
        info.contains("fractal dimension  not determined: points are undefined; fill them first"),
        "{info}"
    );
}

/// Fields, pictures and numbers of a solved rectangle with oblong cells and an undefined point.
#[test]
fn a_rectangle_is_pressed() {
    let dir = tempfile::tempdir().unwrap();
    let (columns, rows) = (24, 8);
    let height = |i: usize| ((i * 37) % 101) as f64;
    let mut heights: Vec<f64> = (0..columns * rows).map(height).collect();
    heights[30] = f64::NAN;
    let bytes = surface_io::npy(&[rows, columns], &heights).unwrap();
    std::fs::write(dir.path().join("map.npy"), bytes).unwrap();
    let text = "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"1 GPa\"\nmean_pressure = \"1 MPa\"\n[scene.surface]\nkind = \"file\"\n\
                path = \"map.npy\"\nunit = \"nm\"\nsize = [\"24 um\", \"4 um\"]\nundefined = \"no_contact\"\n[outputs]\narea = true\n\
                stiffness = true\npressure = [\"npy\", \"png\", \"vti\"]\ngap = [\"npy\", \"png\", \"vti\"]\n";
    let scene = SceneFile::parse(&dir.path().join("a.toml"), text.into()).unwrap_or_else(|e| panic!("{e}"));
    let options = Options { out: dir.path().into(), threads: 1, fresh: true };
    let plan = Plan::calibrated(&scene).unwrap_or_else(|e| panic!("{e}"));
    assert!(plan.to_string().contains("24 x 8 cells of 1 um x 500 nm"), "{plan}");
    run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
    let file = CsvFile::read(&dir.path().join("results.csv")).unwrap();
    let force = number(&file, "force");
    approx::assert_relative_eq!(force, 1e6 * 24e-6 * 4e-6, max_relative = 1e-5);
    approx::assert_relative_eq!(
        number(&file, "contact_fraction"),
        number(&file, "area") / (24e-6 * 4e-6),
        max_relative = ROUNDING
    );
    let read = |name: &str| {
        let declared = surface_io::ReadOptions { cell: "1 x 0.5".parse().ok(), ..Default::default() };
        surface_io::Scan::read(dir.path().join(name), &declared).unwrap()
    };
    let pressure = read("pressure-bem3d-0-000.npy");
    assert_eq!((pressure.metadata().rows, pressure.metadata().columns), (rows, columns));
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let sum: f64 = cells.map(|(row, column)| pressure.height(row, column).unwrap()).sum();
    approx::assert_relative_eq!(sum * 1e-6 * 0.5e-6, force, max_relative = 1e-5);
    let gap = read("gap-bem3d-0-000.npy");
    assert_eq!((gap.height(1, 6), gap.metadata().undefined), (None, 1));
    assert!(pressure.height(1, 6).is_some_and(|p| p <= 0.0));
    assert!(Path::new(&dir.path().join("gap-bem3d-0-000.png")).is_file());
}
