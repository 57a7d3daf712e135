//! What is kept is what was solved: fields of the right load, folders of one run, states that are not solved
//! twice.

use fractal_contact::scenes::{Options, Plan, Result, SceneFile, SceneOutcome, run};
use runs::Silent;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

const SCENE: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nforce_bar = [LOADS]\n\
    [scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.7\nrms_height = 0.01\n\
    [outputs]\nstiffness = true\npressure = [\"npy\"]\n[models.bem3d]\ncells = 65\n[sampling]\nseed = 3\n";

fn scene(directory: &Path, loads: &str) -> SceneFile {
    let path = directory.join("scene.toml");
    std::fs::write(&path, SCENE.replace("LOADS", loads)).unwrap();
    SceneFile::read(&path).unwrap()
}

fn run_until(scene: &SceneFile, out: &Path, stop: &(dyn Fn() -> bool + Sync)) -> Result<SceneOutcome> {
    let options = Options { out: out.to_owned(), threads: 1, fresh: false };
    run(scene, &Plan::new(scene).unwrap(), &options, &Silent, stop)
}

fn run_whole(scene: &SceneFile, out: &Path) -> SceneOutcome {
    run_until(scene, out, &|| false).unwrap()
}

fn names(directory: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    entries.map(|e| e.unwrap().file_name().into_string().unwrap()).filter(|n| n != ".units").collect()
}

fn field(out: &Path, state: usize) -> PathBuf {
    out.join(format!("pressure-bem3d-0-{state:03}.npy"))
}

#[test]
fn the_field_of_a_load_is_the_field_of_that_load() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let (first, second) = (scene(dir.path(), "0.1, 0.2"), scene(dir.path(), "0.1, 0.4"));
    run_whole(&first, &out);
    let bytes = || std::fs::read(field(&out, 1)).unwrap();
    let right = bytes();
    assert_eq!(run_whole(&first, &out).kept, 2);
    run_whole(&second, &out);
    assert_ne!(bytes(), right);
    // The first load has the same field in both, so it is kept.
    assert_eq!(run_whole(&first, &out).kept, 1);
    assert_eq!(field_of(&bytes()), field_of(&right));
    assert_eq!(run_whole(&first, &out).kept, 2);
    // Cut off, and a bit of it turned round.
    for damage in [&right[..right.len() / 2], &[&right[..900], &[right[900] ^ 1], &right[901..]].concat()] {
        std::fs::write(field(&out, 1), damage).unwrap();
        assert_eq!(run_whole(&first, &out).kept, 1);
        assert_eq!(field_of(&bytes()), field_of(&right));
        assert_eq!(run_whole(&first, &out).kept, 2);
    }
}

/// Number and rounded sum of the values of an NPY file: a state that is solved alone is not the same to the
/// bit.
fn field_of(npy: &[u8]) -> (usize, i64) {
    let values: Vec<f64> = npy[128..].as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    (values.len(), (values.iter().sum::<f64>() * 1e5).round() as i64)
}

#[test]
fn a_folder_belongs_to_one_run() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    run_whole(&scene(dir.path(), "0.1, 0.2, 0.3"), &out);
    std::fs::write(out.join("mine.txt"), "mine").unwrap();
    let three = names(&out);
    let outcome = run_whole(&scene(dir.path(), "0.1"), &out);
    assert!(
        outcome.notes.iter().any(|note| note.starts_with("2 files that an earlier run left")),
        "{outcome:?}"
    );
    let gone: Vec<String> = three.difference(&names(&out)).cloned().collect();
    assert_eq!(gone, ["pressure-bem3d-0-001.npy", "pressure-bem3d-0-002.npy"]);
    assert!(out.join("mine.txt").exists());

    // A file under the name of a result that no run wrote, beside a manifest and without one.
    std::fs::write(field(&out, 1), "mine").unwrap();
    let refused = run_until(&scene(dir.path(), "0.1, 0.2"), &out, &|| false).unwrap_err().to_string();
    assert!(refused.contains("pressure-bem3d-0-001.npy") && refused.contains("move it away"), "{refused}");
    assert_eq!(std::fs::read(field(&out, 1)).unwrap(), b"mine");
    let other = dir.path().join("other");
    std::fs::create_dir(&other).unwrap();
    std::fs::write(other.join("results.csv"), "mine").unwrap();
    assert!(run_until(&scene(dir.path(), "0.1"), &other, &|| false).is_err());
    assert_eq!(names(&other), ["results.csv".to_owned()].into());
}

#[test]
fn states_are_kept_one_by_one() {
    let dir = tempfile::tempdir().unwrap();
    let (out, whole) = (dir.path().join("out"), dir.path().join("whole"));
    let scene = scene(dir.path(), "0.02, 0.05, 0.1, 0.2, 0.4, 0.8");
    run_whole(&scene, &whole);
    // Stops in the solve that follows the third state.
    let stopped = run_until(&scene, &out, &|| field(&out, 2).exists()).unwrap();
    assert!(stopped.stopped && stopped.states == 3 && stopped.not_attempted() == 3, "{stopped:?}");
    let resumed = run_whole(&scene, &out);
    assert_eq!((resumed.states, resumed.kept, resumed.not_attempted()), (6, 3, 0));
    assert!(bytes_of(&out) == bytes_of(&whole));
    assert!(!checkpoint(&out).exists());
}

/// A run that is killed while it draws the pictures of an interrupted one in a new range has lost no state.
#[test]
fn pictures_of_an_interrupted_run_are_drawn_again() {
    let dir = tempfile::tempdir().unwrap();
    let (out, whole) = (dir.path().join("out"), dir.path().join("whole"));
    let text = SCENE.replace("LOADS", "0.02, 0.05, 0.1, 0.2").replace("[\"npy\"]", "[\"npy\", \"png\"]");
    let scene = SceneFile::parse("scene.toml".as_ref(), text).unwrap();
    run_whole(&scene, &whole);
    run_until(&scene, &out, &|| field(&out, 2).exists()).unwrap();
    let picture = out.join("pressure-bem3d-0-000.png");
    std::fs::write(&picture, [&std::fs::read(&picture).unwrap()[..], b"x"].concat()).unwrap();
    assert_eq!(run_whole(&scene, &out).kept, 3);
    assert_eq!(
        std::fs::read(&picture).unwrap(),
        std::fs::read(whole.join("pressure-bem3d-0-000.png")).unwrap()
    );
    assert!(bytes_of(&out) == bytes_of(&whole));
}

/// A name in the store that leads elsewhere is replaced, never followed; a lock that is none is refused.
#[cfg(unix)]
#[test]
fn links_in_the_store_are_not_followed() {
    let dir = tempfile::tempdir().unwrap();
    let kept = dir.path().join("kept");
    std::fs::write(&kept, "somebody else's").unwrap();
    let out = dir.path().join("out");
    std::fs::create_dir_all(out.join(".units")).unwrap();
    std::os::unix::fs::symlink(&kept, out.join(".units/pressure-bem3d-0-000.f64")).unwrap();
    // What a run that was killed kept for drawing.
    std::fs::write(out.join(".units/gap-bem3d-7-000.f64"), "old").unwrap();
    let text = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nforce = 0.01\n\
        [scene.body]\nkind = \"sphere\"\nradius = 1\nside = 1\n[outputs]\npressure = [\"png\"]\n[models.bem3d]\ncells = 17\n";
    let scene = SceneFile::parse("scene.toml".as_ref(), text.into()).unwrap();
    let options = Options { out: out.clone(), threads: 1, fresh: false };
    let plan = Plan::new(&scene).unwrap();
    assert_eq!(run(&scene, &plan, &options, &Silent, &|| false).unwrap().states, 1);
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), "somebody else's");
    let left = std::fs::read_dir(out.join(".units")).unwrap().flatten();
    assert!(left.into_iter().all(|entry| !entry.file_name().to_string_lossy().ends_with("f64")));
    std::fs::remove_file(out.join(".units/lock")).unwrap();
    std::fs::create_dir(out.join(".units/lock")).unwrap();
    let refused = run(&scene, &plan, &options, &Silent, &|| false).unwrap_err().to_string();
    assert!(refused.contains("lock") && refused.contains("not a regular file"), "{refused}");
}

const PATH: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nPAIR\n[scene.surface]\nkind = \"self_affine\"\nside = 1\n\
    hurst = 0.7\nrms_height = 0.01\n[outputs]\npressure = [\"npy\"]\n[effects]\nEFFECT\n[models.bem3d]\ncells = 49\n\
    [sampling]\nseed = 3\nSTEPS";

/// Leakage takes a part of the time of each step, so that a run may be stopped within it.
const LEAKAGE: &str =
    "gap = [\"npy\"]\nleakage = { viscosity = 1, pressure_drop = 1, along = \"x\" }\n[effects]";

/// Paths on which something is remembered, each of seven states.
fn paths() -> Vec<(&'static str, String)> {
    let steps = |values: [f64; 7], key: &str, tangential: bool| -> String {
        let step = |(i, value): (usize, f64)| {
            let tangential = if tangential {
                format!("tangential_force = {}\n", 1e-4 * [0.0, 1.0, 2.0, -1.0, 1.0, 0.5, -2.0][i])
            } else {
                String::new()
            };
            format!("[[scene.path]]\ntime = {i}\n{key} = {value:e}\n{tangential}")
        };
        values.into_iter().enumerate().map(step).collect()
    };
    let pressed = [1e-3, 4e-3, 8e-3, 2e-3, 6e-3, 9e-3, 1e-3];
    let pulled = [0.004, 0.012, 0.02, 0.008, 0.0, -0.002, -0.004];
    let forces = |tangential| steps(pressed, "force", tangential);
    let approaches = || steps(pulled, "approach", false);
    let pieces = |first: &str, then: &str| {
        format!(
            "[[scene.path]]\n{first} = 6e-3\n[[scene.path]]\n{then} = 1e-2\nstates = 4\n[[scene.path]]\n{first} = 1e-2\nstates = 2\n"
        )
    };
    let sheared = "[[scene.path]]\nforce = 6e-3\ntangential_force = 1e-3\n\
        [[scene.path]]\napproach = 0.015\ntangential_displacement = -1e-3\nstates = 4\n\
        [[scene.path]]\ntangential_force = 1e-3\nstates = 2\n";
    let contact_modulus = "contact_modulus = 1";
    let scene = |pair: &str, effect: &str, steps: String| {
        PATH.replace("PAIR", pair).replace("EFFECT", effect).replace("STEPS", &steps)
    };
    let bodies = "bodies = [\"rigid\", { young = 0.75, poisson = 0.5 }]";
    vec![
        ("hardness", scene(contact_modulus, "hardness = 0.05", forces(false))),
        ("friction", scene(bodies, "friction = 0.4", forces(true))),
        ("short range", scene(contact_modulus, "adhesion = { work = 4e-5 }", approaches())),
        (
            "exponential",
            scene(
                contact_modulus,
                "adhesion = { work = 4e-5, range = 3e-3, law = \"exponential\" }",
                approaches(),
            ),
        ),
        // Pieces that prescribe another quantity than the one before, interrupted inside and at their ends.
        (
            "hardness, another quantity",
            scene(contact_modulus, "hardness = 0.05", pieces("force", "approach")),
        ),
        (
            "short range, another quantity",
            scene(contact_modulus, "adhesion = { work = 4e-5 }", pieces("force", "approach")),
        ),
        (
            "mean gap, another quantity",
            scene(contact_modulus, "boundary = \"periodic\"\nhardness = 0.2", pieces("force", "mean_gap")),
        ),
        ("friction, another quantity", scene(bodies, "friction = 0.4", sheared.to_owned())),
        (
            "hardness, leakage",
            scene(contact_modulus, "hardness = 0.05", forces(false)).replace("[effects]", LEAKAGE),
        ),
    ]
}

fn path_scene(directory: &Path, text: &str) -> SceneFile {
    let path = directory.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    SceneFile::read(&path).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The bytes of a table and of all fields.
fn bytes_of(out: &Path) -> Vec<Vec<u8>> {
    let fields = (0..7).map(|state| std::fs::read(field(out, state)).unwrap_or_default());
    std::iter::once(std::fs::read(out.join("results.csv")).unwrap()).chain(fields).collect()
}

fn checkpoint(out: &Path) -> PathBuf {
    out.join(".units/bem3d-0.checkpoint")
}

#[test]
fn a_path_goes_on_to_the_same_bytes() {
    for (name, text) in paths() {
        let dir = tempfile::tempdir().unwrap();
        let (out, whole) = (dir.path().join("out"), dir.path().join("whole"));
        let scene = path_scene(dir.path(), &text);
        let all = run_whole(&scene, &whole);
        assert!(all.failed == 0 && all.notes.iter().all(|note| !note.contains("anew")), "{name}: {all:?}");
        assert!(!checkpoint(&whole).exists());
        // Interrupted after one state, after four, and in the last.
        for (before, states) in [(0, 1), (1, 4), (4, 6)] {
            let stopped = run_until(&scene, &out, &|| field(&out, states - 1).exists()).unwrap();
            assert!(stopped.stopped, "{name}");
            assert_eq!((stopped.states, stopped.kept), (states, before), "{name}: {:?}", stopped.notes);
            assert!(checkpoint(&out).exists(), "{name}");
        }
        let options = Options { out: out.clone(), threads: 3, fresh: false };
        let resumed = run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &|| false).unwrap();
        assert_eq!((resumed.states, resumed.kept, resumed.failed), (7, 6, 0), "{name}: {:?}", resumed.notes);
        assert!(bytes_of(&out) == bytes_of(&whole), "{name}");
        assert!(!checkpoint(&out).exists(), "{name}");
        assert_eq!(run_whole(&scene, &out).kept, 7, "{name}");
    }
}

/// Scenes of every effect, with loads that do not depend on each other, and of models beside bem3d.
fn sweeps() -> Vec<(&'static str, String)> {
    let scene = |surface: &str, keys: &str, effects: &str, outputs: &str| {
        format!(
            "[scene]\nunits = \"none\"\n{keys}\n[scene.surface]\nside = 1\n{surface}\n[effects]\n{effects}\n\
             [outputs]\nstiffness = true\n{outputs}\nNUMERICS[sampling]\nseed = 3\nsurfaces = 2\n"
        )
        .replace("NUMERICS", if keys.contains("bem3d") { "[models.bem3d]\ncells = 33\n" } else { "" })
    };
    let rough = "kind = \"self_affine\"\nhurst = 0.7\nrms_height = 0.01";
    let bem3d = "models = [\"bem3d\"]\ncontact_modulus = 1\n";
    let forces = "force = [1e-3, 4e-3, 2e-3, 1e-2]";
    let approaches = "approach = [0.004, 0.012, 0.008, 0.02]";
    let gaps = "mean_gap = [0.02, 0.012, 0.008]";
    let fields = "area = true\ncontact_patches = true\npressure = [\"npy\"]\ngap = [\"vti\"]";
    let of = |model: &str, load: &str| format!("models = [\"{model}\"]\ncontact_modulus = 1\n{load}");
    vec![
        (
            "elastic",
            scene(
                rough,
                &format!("{bem3d}force = [1e-3, 1e-2]"),
                "",
                "area = true\npressure = [\"npy\"]\ngap = [\"png\"]\ngrid_error = true",
            ),
        ),
        ("periodic", scene(rough, &format!("{bem3d}{gaps}"), "boundary = \"periodic\"", "area = true")),
        (
            "thresholds",
            scene(
                rough,
                &format!("{bem3d}{gaps}"),
                "boundary = \"periodic\"",
                "percolation = true\nthresholds = 0.05",
            ),
        ),
        ("hardness", scene(rough, &format!("{bem3d}{forces}"), "hardness = 0.05", fields)),
        ("short range", scene(rough, &format!("{bem3d}{approaches}"), "adhesion = { work = 4e-5 }", "")),
        (
            "exponential",
            scene(
                rough,
                &format!("{bem3d}{approaches}"),
                "adhesion = { work = 4e-5, range = 3e-3, law = \"exponential\" }",
                "",
            ),
        ),
        (
            "Dugdale",
            scene(rough, &format!("{bem3d}{forces}"), "adhesion = { work = 4e-5, range = 3e-3 }", ""),
        ),
        ("mdr1d", scene(rough, &of("mdr1d", forces), "", "")),
        (
            "persson",
            scene(
                &format!("{rough}\nshortest_wavelength = 0.05"),
                &of("persson", forces),
                "boundary = \"periodic\"",
                "",
            ),
        ),
    ]
}

/// All files of a folder but those that tell times: the report, the manifest and the store.
fn files(out: &Path) -> Vec<(String, Vec<u8>)> {
    let results = |name: &String| !["report.html", "manifest.json"].contains(&name.as_str());
    let read = |name: String| (name.clone(), std::fs::read(out.join(name)).unwrap());
    names(out).into_iter().filter(results).map(read).collect()
}

/// A stop at some poll of a run, from the first to the last one, each later than the one before by a third; with
/// `EVERY_POLL` in the environment at each. The run that goes on ends with the bytes of one
/// that nobody stopped.
#[test]
fn a_run_that_is_stopped_at_any_poll_ends_with_the_same_bytes() {
    let every = std::env::var_os("EVERY_POLL").is_some();
    for (name, text) in sweeps().into_iter().chain(paths()) {
        let dir = tempfile::tempdir().unwrap();
        let text = text.replace("cells = 49", "cells = 25");
        let (scene, whole) = (path_scene(dir.path(), &text), dir.path().join("whole"));
        run_whole(&scene, &whole);
        let wanted = files(&whole);
        let mut polls = 0;
        loop {
            let (out, asked) = (dir.path().join("out"), AtomicUsize::new(0));
            let stop = || asked.fetch_add(1, Ordering::Relaxed) >= polls;
            let stopped = run_until(&scene, &out, &stop).unwrap().stopped;
            // A run that is stopped before it begins leaves what there is.
            let before = names(&out);
            run_until(&scene, &out, &|| true).unwrap();
            assert_eq!(names(&out), before, "{name}: {polls}");
            let resumed = run_whole(&scene, &out);
            assert!(resumed.notes.iter().all(|note| !note.contains("anew")), "{name}: {:?}", resumed.notes);
            for ((file, found), (_, wanted)) in files(&out).iter().zip(&wanted) {
                assert!(found == wanted, "{name}, stopped at poll {polls}: {file}");
            }
            assert_eq!(names(&out), names(&whole), "{name}: {polls}");
            if !stopped {
                break;
            }
            std::fs::remove_dir_all(&out).unwrap();
            polls += if every { 1 } else { 1 + polls / 3 };
        }
        assert!(polls > 0, "{name}: {polls}");
    }
}

#[test]
fn a_path_whose_checkpoint_is_not_whole_begins_anew_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let (out, whole) = (dir.path().join("out"), dir.path().join("whole"));
    let texts = paths();
    let scene = path_scene(dir.path(), &texts[2].1);
    run_whole(&scene, &whole);
    let interrupt = || {
        let _ = std::fs::remove_dir_all(&out);
        run_until(&scene, &out, &|| field(&out, 2).exists()).unwrap();
        std::fs::read(checkpoint(&out)).unwrap()
    };
    let right = interrupt();
    let mut turned = right.clone();
    *turned.last_mut().unwrap() ^= 1;
    for (bytes, reason) in [
        (Vec::new(), "damaged or cut off"),
        (right[..right.len() / 2].to_vec(), "damaged or cut off"),
        (turned, "damaged or cut off"),
        (b"# fractal-contact checkpoint 1\n".repeat(300), "damaged or cut off"),
        (right[..20].iter().chain(b"\n\n").copied().collect(), "damaged or cut off"),
        (String::from_utf8_lossy(&right).replacen("# build 0", "# build 9", 1).into_bytes(), "another build"),
    ] {
        interrupt();
        std::fs::write(checkpoint(&out), bytes).unwrap();
        let outcome = run_whole(&scene, &out);
        let note = outcome.notes.iter().find(|note| note.contains("begins anew"));
        assert!(note.is_some_and(|note| note.contains(reason)), "{reason}: {outcome:?}");
        assert_eq!(outcome.kept, 0);
        assert!(bytes_of(&out) == bytes_of(&whole), "{reason}");
        assert!(!checkpoint(&out).exists());
    }
    // A field of a state before it was changed.
    interrupt();
    std::fs::write(field(&out, 1), "changed").unwrap();
    let outcome = run_whole(&scene, &out);
    assert!(outcome.notes.iter().any(|note| note.contains("missing or were changed")), "{outcome:?}");
    assert!(bytes_of(&out) == bytes_of(&whole));
    // Another scene in the same directory, and the first one again.
    interrupt();
    let other = path_scene(dir.path(), &texts[2].1.replace("4e-5", "3e-5"));
    let outcome = run_whole(&other, &out);
    assert!(outcome.notes.iter().any(|note| note.contains("another scene")), "{outcome:?}");
    run_whole(&scene, &out);
    assert!(bytes_of(&out) == bytes_of(&whole));
    // A fresh run begins anew without a word.
    interrupt();
    let options = Options { out: out.clone(), threads: 1, fresh: true };
    let outcome = run(&scene, &Plan::new(&scene).unwrap(), &options, &Silent, &|| false).unwrap();
    assert!(outcome.kept == 0 && outcome.notes.iter().all(|note| !note.contains("anew")), "{outcome:?}");
    // A checkpoint that cannot be written is reported, and the run goes on.
    let _ = std::fs::remove_dir_all(&out);
    std::fs::create_dir_all(checkpoint(&out)).unwrap();
    let outcome = run_until(&scene, &out, &|| field(&out, 2).exists()).unwrap();
    assert!(
        outcome.notes.iter().any(|note| note.contains("goes on; an interruption would lose")),
        "{outcome:?}"
    );
    assert_eq!(outcome.states, 3);
    std::fs::remove_dir(checkpoint(&out)).unwrap();
    run_whole(&scene, &out);
    assert!(bytes_of(&out) == bytes_of(&whole));
}

/// The row at which a path under a force ends holds the last stable state, and the largest pull is bounded from
/// both sides.
#[test]
fn a_path_that_pulls_off_ends_with_its_last_stable_state() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let forces = [1e-3, 0.0, -1e-4, -2e-4, -4e-4, -8e-4, -1.6e-3, -3.2e-3];
    let step = |(i, force)| format!("[[scene.path]]\ntime = {i}\nforce = {force:e}\n");
    let steps = forces.iter().enumerate().map(step).collect::<Vec<_>>().concat();
    let text = format!(
        "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\n[scene.body]\nkind = \"sphere\"\nradius = 1\n\
         side = 0.3\n[effects]\nadhesion = {{ work = 1e-4 }}\n[models.bem3d]\ncells = 49\n{steps}"
    );
    let scene = path_scene(dir.path(), &text);
    let outcome = run_whole(&scene, &out);
    let file = runs::CsvFile::read(&out.join("results.csv")).unwrap();
    let column = |name: &str| file.columns.iter().position(|c| c == name).unwrap();
    let exact = 1.5 * std::f64::consts::PI * 1e-4;
    let (last, before) = (&file.rows[file.rows.len() - 1], &file.rows[file.rows.len() - 2]);
    let number = |row: &[String], name: &str| row[column(name)].parse::<f64>().unwrap();
    assert_eq!((&*last[column("status")], &*before[column("status")]), ("pulled_off", "converged"));
    assert!(last[column("note")].contains("pull-off before the force -8e-4"), "{last:?}");
    let note = format!("bem3d: {}", last[column("note")]);
    assert!(outcome.notes.contains(&note), "{outcome:?}");
    for name in ["time", "force", "approach", "energy", "stability"] {
        assert_eq!(last[column(name)], before[column(name)], "{name}");
    }
    assert!((number(last, "force") + 4e-4).abs() < 1e-9);
    let (pull, error) = (number(last, "pull_off"), number(last, "pull_off_error"));
    assert!((pull - 4e-4).abs() < 1e-9 && (error - 4e-4).abs() < 1e-9, "{pull} {error}");
    assert!(pull <= exact && exact <= pull + error);
    assert_eq!(before[column("pull_off_error")], "", "nothing is beyond it yet");
    assert_eq!(file.rows[1][column("pull_off")], "", "no pull: absent");
    assert!(outcome.summary.contains("path as a whole: pull_off 4e-4"), "{}", outcome.summary);
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("path as a whole: pull off 4e-4"));
}
