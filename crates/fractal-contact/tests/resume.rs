//! What is kept is what was solved: fields of the right load, folders of one run, states that are not solved
//! twice.

use fractal_contact::scenes::{Options, Plan, Result, SceneFile, SceneOutcome, run};
use runs::Silent;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const SCENE: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nmodulus = 1\nforce_bar = [LOADS]\n\
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
    let stiffness = |out: &Path| -> Vec<f64> {
        let file = runs::CsvFile::read(&out.join("results.csv")).unwrap();
        let column = file.columns.iter().position(|c| c == "stiffness").unwrap();
        file.rows.iter().map(|row| row[column].parse().unwrap()).collect()
    };
    for (i, (a, b)) in stiffness(&out).iter().zip(stiffness(&whole)).enumerate() {
        // Kept states are the same to the bit; what is solved after an interruption is within the tolerance,
        // 1e-6 of either run.
        let bound = if i < 3 { 0.0 } else { 2e-6 };
        assert!((a / b - 1.0).abs() <= bound, "{i}: {a}, {b}");
    }
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
    let text = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nmodulus = 1\nforce = 0.01\n\
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
