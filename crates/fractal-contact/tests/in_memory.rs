//! A scene that is answered in memory has the files of one that is answered in a folder, to the byte.

use fractal_contact::scenes::{AskedFile, AskedSurface};
use fractal_contact::scenes::{Options, Plan, SceneFile, describe_file, run, run_in_memory};
use std::cell::RefCell;
use std::sync::Arc;

const LOADS: &str = r#"
[scene]
models = ["bem3d", "persson"]
mean_pressure = ["1 MPa", "30 MPa"]
contact_modulus = "100 GPa"
[scene.surface]
kind = "self_affine"
side = "1 mm"
hurst = 0.8
rms_height = "1 um"
shortest_wavelength = "100 um"
[outputs]
stiffness = true
area = true
curves = true
[effects]
boundary = "periodic"
[models.bem3d]
cells = 33
[sampling]
seed = 3
surfaces = 2
"#;

const PATH: &str = r#"
[scene]
units = "none"
models = ["bem3d"]
contact_modulus = 1
[[scene.path]]
force = 0.1
states = 2
[[scene.path]]
force = 0.01
states = 2
[scene.body]
kind = "sphere"
radius = 1
side = 2
[effects]
hardness = 0.2
[outputs]
pressure = ["npy", "png"]
gap = ["vti"]
distributions = ["pressure"]
[models.bem3d]
cells = 24
"#;

#[test]
fn files_in_memory_are_those_of_a_folder() {
    for (name, text, states) in [("loads", LOADS, 6), ("path", PATH, 4)] {
        let scene =
            SceneFile::parse("scene.toml".as_ref(), text.to_owned()).unwrap_or_else(|e| panic!("{e}"));
        let plan = Plan::new(&scene).unwrap();
        let dir = tempfile::tempdir().unwrap();
        let options = Options { out: dir.path().to_owned(), threads: 2, fresh: false };
        let in_folder = run(&scene, &plan, &options, &runs::Silent, &contact_model::never).unwrap();
        let received = RefCell::new(Vec::new());
        let receive = |state: &str| received.borrow_mut().push(state.to_owned());
        let in_memory = run_in_memory(&scene, &plan, &runs::Silent, &contact_model::never, &receive).unwrap();
        assert_eq!(in_folder.results, in_memory.outcome.results, "{name}");
        assert_eq!(received.borrow().len(), states, "{name}");
        assert!(received.borrow().iter().all(|state| state.contains("<table")), "{name}");
        for path in in_folder.files.iter().filter(|path| !path.ends_with("manifest.json")) {
            let file = path.file_name().unwrap().to_str().unwrap();
            let bytes = in_memory.files.get(file).unwrap_or_else(|| panic!("{name}: no {file}"));
            // The page has the times of its run.
            assert!(file == "report.html" || **bytes == *std::fs::read(path).unwrap(), "{name}: {file}");
        }
        assert_eq!(in_memory.files.len() + 1, in_folder.files.len(), "{name}: {:?}", in_memory.files.keys());
    }
}

#[test]
fn a_map_in_memory_is_that_of_its_file() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/measured/optical.x3p");
    let text = "[scene]\nmodels = [\"bem3d\"]\ncontact_modulus = \"100 GPa\"\nforce = \"1 N\"\n[scene.surface]\nkind = \"file\"\n\
                path = \"optical.x3p\"\nundefined = \"no_contact\"\n";
    let from_file = SceneFile::parse(path.as_ref(), text.to_owned()).unwrap();
    let mut question = fractal_contact::scenes::Question::parse(text).unwrap();
    let Some(AskedSurface::File(asked)) = &mut question.surface else { panic!("no file") };
    asked.content = Some(Arc::from(std::fs::read(path).unwrap()));
    let from_bytes = SceneFile::of(question, "elsewhere/scene.toml".as_ref()).unwrap();
    assert_eq!(from_file.surface, from_bytes.surface);
}

#[test]
fn what_a_file_does_not_say_is_named() {
    let described = |text: &str, asked: &AskedFile, given: &[(&str, &str)]| {
        let value =
            |key: &str| given.iter().find(|(name, _)| *name == key).map(|(_, text)| (*text).to_owned());
        describe_file("map.csv", text.as_bytes(), asked, &value).unwrap()
    };
    let mut asked = AskedFile::default();
    let found = described("1,2,3\n4,nan,7\n", &asked, &[]);
    let keys: Vec<&str> = found.missing.iter().map(|missing| missing.key).collect();
    assert_eq!(keys, ["unit", "cell", "undefined"]);
    assert!(found.map.is_err_and(|reason| !reason.is_empty()));
    let given = [("unit", "nm"), ("cell", "1 um"), ("fill", "neighbours")];
    for (key, text) in given {
        asked.set(key, text).unwrap();
    }
    let found = described("1,2,3\n4,nan,7\n", &asked, &given);
    assert!(found.missing.is_empty(), "{:?}", found.missing);
    assert!(found.map.is_ok_and(|page| page.contains("<figure")));
}
