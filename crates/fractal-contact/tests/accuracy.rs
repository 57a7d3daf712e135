//! The grid that `accuracy` chooses: the same on a busy machine, after an interruption and in every shard, and
//! with states that the run takes from the pilot.

use fractal_contact::scenes::{Options, Plan, Result, SceneFile, SceneOutcome, run};
use runs::{Progress, Silent};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The chosen grid has 256 cells a side, and 128 are tried before.
const SCENE: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nmean_pressure = [1e-3, 1e-2]\naccuracy = \"4 %\"\n\
    [scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.8\nrms_height = 0.01\nroll_off_wavelength = 0.5\n\
    shortest_wavelength = 0.2\n[effects]\nboundary = \"periodic\"\n[outputs]\nstiffness = true\narea = true\n\
    pressure = [\"npy\", \"png\"]\ngap = [\"png\"]\ncontact_patches = true\n[sampling]\nseed = 5\nsurfaces = SURFACES\n";

/// Counts the jobs that were done, without those that were found in a store.
#[derive(Default)]
struct SolvedJobs(AtomicUsize);

impl Progress for SolvedJobs {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64, reused: bool) {
        self.0.fetch_add(usize::from(!reused), Ordering::Relaxed);
    }
    fn end(&self) {}
}

impl SolvedJobs {
    fn done(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

fn scene(text: &str) -> SceneFile {
    SceneFile::parse("scene.toml".as_ref(), text.replace("SURFACES", "1")).unwrap()
}

fn options(out: &Path) -> Options {
    Options { out: out.to_owned(), threads: 2, fresh: false }
}

fn chosen(text: &str, out: &Path, progress: &dyn Progress) -> SceneFile {
    chosen_until(text, out, progress, &|| false).unwrap()
}

fn chosen_until(
    text: &str,
    out: &Path,
    progress: &dyn Progress,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<SceneFile> {
    scene(text).with_grid_for_accuracy(&options(out), progress, stop)
}

fn solved(scene: &SceneFile, out: &Path) -> SceneOutcome {
    run(scene, &Plan::new(scene).unwrap(), &options(out), &Silent, &|| false).unwrap()
}

/// Names and bytes of the tables, fields and pictures of a folder.
fn files(out: &Path) -> Vec<(String, Vec<u8>)> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = std::fs::read_dir(out).unwrap().map(name).collect();
    names.retain(|name| ["csv", "npy", "png"].iter().any(|end| name.ends_with(end)));
    names.sort();
    names.into_iter().map(|name| (name.clone(), std::fs::read(out.join(name)).unwrap())).collect()
}

#[test]
fn the_run_takes_the_states_of_the_pilot() {
    let dir = tempfile::tempdir().unwrap();
    let (out, alone) = (dir.path().join("out"), dir.path().join("alone"));
    let counter = SolvedJobs::default();
    let grid = chosen(SCENE, &out, &counter);
    // 128 and 256 cells.
    assert_eq!((grid.models[0].size(), counter.done()), (256, 2));
    assert_eq!(chosen(SCENE, &out, &counter), grid);
    // A larger budget or memory is another question with the same trials.
    let more = SCENE.replace("models", "budget = \"1 h\"\nmemory = \"1 TB\"\nmodels");
    assert_eq!(chosen(&more, &out, &counter).models, grid.models);
    assert_eq!(counter.done(), 2);
    let outcome = solved(&grid, &out);
    assert_eq!((outcome.states, outcome.kept, outcome.failed), (2, 2, 0));
    // Every field and picture is that of the grid, as if nothing had been tried.
    assert_eq!(solved(&grid, &alone).kept, 0);
    let (found, wanted) = (files(&out), files(&alone));
    assert!(found.len() >= 8, "{:?}", found.iter().map(|file| &file.0).collect::<Vec<_>>());
    assert!(found == wanted);
    assert!(!out.join(".units/accuracy").exists());
    assert_eq!(solved(&chosen(SCENE, &out, &counter), &out).kept, 2);
    assert_eq!(counter.done(), 2);
    // Of what is computed anew, the pilot is a part.
    let fresh = Options { fresh: true, ..options(&out) };
    scene(SCENE).with_grid_for_accuracy(&fresh, &counter, &|| false).unwrap();
    assert_eq!(counter.done(), 4);
}

/// A stop at any moment of the pilot: what was solved is kept, and the same grid is chosen after it.
#[test]
fn a_pilot_goes_on_after_an_interruption() {
    let dir = tempfile::tempdir().unwrap();
    let whole = dir.path().join("whole");
    solved(&chosen(SCENE, &whole, &Silent), &whole);
    // Between two grids.
    let (out, counter) = (dir.path().join("between"), SolvedJobs::default());
    let stopped = chosen_until(SCENE, &out, &counter, &|| counter.done() == 1).unwrap_err();
    assert!(stopped.to_string().contains("the pilot of `accuracy`"), "{stopped}");
    assert_eq!(counter.done(), 1);
    solved(&chosen(SCENE, &out, &counter), &out);
    // The grid that was finished before is not solved again.
    assert_eq!(counter.done(), 2);
    assert!(files(&out) == files(&whole));
    // Within the states of a grid.
    let mut interrupted = 0;
    for polls in [1, 30, 100, 300] {
        let out = dir.path().join(format!("{polls}"));
        let asked = AtomicUsize::new(0);
        let stop = || asked.fetch_add(1, Ordering::Relaxed) >= polls;
        interrupted += usize::from(chosen_until(SCENE, &out, &Silent, &stop).is_err());
        let grid = chosen(SCENE, &out, &Silent);
        assert_eq!(grid.models[0].size(), 256);
        solved(&grid, &out);
        assert!(files(&out) == files(&whole), "{polls}");
    }
    assert!(interrupted >= 2);
}

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fractal-contact")).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

/// Keeps every processor busy while some work is done.
fn on_a_busy_machine<T>(work: impl FnOnce() -> T) -> T {
    let done = AtomicBool::new(false);
    let spin = || {
        while !done.load(Ordering::Relaxed) {
            std::hint::spin_loop();
        }
    };
    let threads = 2 * std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        (0..threads).for_each(|_| {
            scope.spawn(spin);
        });
        let found = work();
        done.store(true, Ordering::Relaxed);
        found
    })
}

/// Shards with a folder each, and one machine that has other work: the same grid and the same bytes.
#[test]
fn a_busy_machine_chooses_the_same_grid() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    for (name, accuracy) in [
        ("best", "accuracy = \"best\"\nbudget = \"1 s\""),
        ("share", "accuracy = \"4 %\"\nbudget = \"10 s\""),
    ] {
        let text = SCENE.replace("accuracy = \"4 %\"", accuracy).replace("SURFACES", "3");
        let file = path(&format!("{name}.toml"));
        std::fs::write(&file, text).unwrap();
        let shard = |out: &str, which: &str| {
            let done = program(&["run", &file, "--out", out, "--shard", which]);
            assert_eq!(done.status.code(), Some(0), "{}", said(&done));
        };
        let (quiet, busy) = (path(&format!("{name}-quiet")), path(&format!("{name}-busy")));
        shard(&quiet, "0/2");
        on_a_busy_machine(|| shard(&busy, "1/2"));
        // Each has its own pilot and half of the states; both halves make one table, and the merge of each
        // folder finds the grid that its shards had.
        for (out, rest) in [(&quiet, "1/2"), (&busy, "0/2")] {
            let gap = program(&["merge", "--out", out]);
            assert!(
                gap.status.code() == Some(1) && said(&gap).contains("compute them with"),
                "{}",
                said(&gap)
            );
            shard(out, rest);
            assert_eq!(program(&["status", "--out", out]).status.code(), Some(0));
            let merged = program(&["merge", "--out", out]);
            assert_eq!(merged.status.code(), Some(0), "{}", said(&merged));
        }
        let [quiet, busy] = [quiet, busy].map(|out| files(Path::new(&out)));
        assert!(quiet.len() >= 14 && quiet == busy, "{name}");
        let table = String::from_utf8(quiet.iter().find(|file| file.0 == "results.csv").unwrap().1.clone());
        // Three surfaces of two states of 256 x 256 cells are predicted to take half a second, of 512 x 512 two.
        assert!(table.unwrap().contains("256 x 256 cells"), "{name}");
    }
}

/// `plan`, two shards at the same time, `status` and `merge` of one folder: the pilot is solved once.
#[test]
fn a_pilot_is_solved_once_for_all_commands() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    let (file, out) = (path("scene.toml"), path("out"));
    std::fs::write(&file, SCENE.replace("SURFACES", "2")).unwrap();
    let planned = program(&["plan", &file, "--out", &out]);
    assert!(said(&planned).contains("bem3d on 256 x 256 cells, with an error of "), "{}", said(&planned));
    let results = |out: &str| {
        // A result that is written again while it grows counts once.
        let of_pack = |pack: runs::Pack| pack.results.into_iter().collect::<BTreeSet<u128>>().len();
        runs::Store::packs(Path::new(out)).unwrap().into_iter().map(of_pack).sum::<usize>()
    };
    // The two grids that were tried.
    assert_eq!(results(&out), 2);
    let shards = |out: &str| {
        let begun = ["0/2", "1/2"].map(|which| {
            let arguments = ["run", &file, "--out", out, "--shard", which];
            let quiet = std::process::Stdio::null;
            let mut command = Command::new(env!("CARGO_BIN_EXE_fractal-contact"));
            command.args(arguments).stdout(quiet()).stderr(quiet()).spawn().unwrap()
        });
        assert!(begun.into_iter().all(|mut shard| shard.wait().unwrap().success()));
    };
    shards(&out);
    // Surface 0, now with pictures, and surface 1.
    assert_eq!(results(&out), 4);
    // Shards that begin at the same time solve the pilot once, too.
    let together = path("together");
    shards(&together);
    assert_eq!(results(&together), 4);
    for out in [&out, &together] {
        assert_eq!(program(&["status", "--out", out]).status.code(), Some(0));
        let merged = program(&["merge", "--out", out]);
        assert_eq!(merged.status.code(), Some(0), "{}", said(&merged));
        assert_eq!(results(out), 4);
    }
    assert_eq!(program(&["run", &file, "--out", &path("one")]).status.code(), Some(0));
    assert!(files(Path::new(&together)) == files(Path::new(&path("one"))));
    assert!(files(Path::new(&out)) == files(Path::new(&path("one"))));
    // Without the states of the pilot nobody knows which grid the results have.
    for entry in std::fs::read_dir(Path::new(&out).join(".units")).unwrap().map(|entry| entry.unwrap().path())
    {
        if entry.extension().is_some_and(|end| end == "pack") {
            std::fs::remove_file(entry).unwrap();
        }
    }
    for command in ["status", "merge"] {
        let refused = program(&[command, "--out", &out]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(said(&refused).contains("the states of the pilot"), "{}", said(&refused));
    }
}

/// Ctrl-C while the grid is being chosen.
#[cfg(unix)]
#[test]
fn an_interrupt_of_the_pilot_ends_with_the_code_of_a_stop() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    // Finer grids than can be solved before the signal comes.
    let text = SCENE.replace("SURFACES", "1").replace("\"4 %\"", "1e-6\nbudget = \"1000 h\"");
    std::fs::write(path("scene.toml"), text.replace("1e-2]", "1e-2, 2e-2, 4e-2, 8e-2]")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_fractal-contact"))
        .args(["run", &path("scene.toml"), "--out", &path("out")])
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    while runs::Store::count(&dir.path().join("out")) < 2 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130));
    assert!(said(&ended).contains("Stopped: the states so far are kept."), "{}", said(&ended));
    assert!(runs::Store::count(&dir.path().join("out")) >= 2);
}

/// The memory of a machine refuses a grid, and does not choose another one.
#[cfg(target_os = "linux")]
#[test]
fn a_machine_with_less_memory_refuses_the_grid() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    let text = SCENE.replace("SURFACES", "1").replace("\"4 %\"", "\"best\"\nbudget = \"10 min\"");
    std::fs::write(path("scene.toml"), &text).unwrap();
    let run = |command: &str| {
        let limited = "ulimit -v 3000000; exec \"$0\" \"$@\"";
        let words = [command, &path("scene.toml"), "--out", &path("out")];
        let program = env!("CARGO_BIN_EXE_fractal-contact");
        Command::new("sh").args(["-c", limited, program]).args(words).output().unwrap()
    };
    for command in ["run", "plan"] {
        let refused = run(command);
        let text = said(&refused);
        assert_eq!(refused.status.code(), Some(1), "{text}");
        for words in ["memory = 4.0 GB", "4096 x 4096 cells", "needs up to 3.7 GB", " are available"] {
            assert!(text.contains(words), "{words}: {text}");
        }
    }
    assert!(!dir.path().join("out").exists());
    std::fs::write(path("scene.toml"), text.replace("10 min", "2 s")).unwrap();
    assert_eq!(run("run").status.code(), Some(0));
}
