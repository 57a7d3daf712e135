//! The program itself: exit codes, resume, the same bytes.

use fractal_contact::scenes::{Options, Plan, PredictedFrom, SceneFile, run};
use runs::{Progress, Silent};
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

const SCENE: &str = "# Three surfaces by two models.\n[scene]\nunits = \"none\"\nmodels = [\"bem3d\", \"mdr1d\"]\ncontact_modulus = 1\n\
    force_bar = { from = 1e-2, to = 1, count = 3 }\n[scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.7\nrms_height = 0.01\n\
    [outputs]\nstiffness = true\ncurves = true\n[models.bem3d]\ncells = 33\n[models.mdr1d]\nelements = 1024\n\
    [sampling]\nseed = 7\nsurfaces = 3\n";

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fractal-contact")).args(arguments).output().unwrap()
}

fn texts(output: &Output) -> (String, String) {
    (String::from_utf8(output.stdout.clone()).unwrap(), String::from_utf8(output.stderr.clone()).unwrap())
}

/// Counts units, and those found on disk.
#[derive(Default)]
struct UnitCounter(AtomicUsize, AtomicUsize);

impl Progress for UnitCounter {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64, reused: bool) {
        self.0.fetch_add(1, Ordering::Relaxed);
        self.1.fetch_add(usize::from(reused), Ordering::Relaxed);
    }
    fn end(&self) {}
}

#[test]
fn a_stopped_run_goes_on_and_ends_in_the_same_bytes() {
    let scene = SceneFile::parse(Path::new("three.toml"), SCENE.into()).unwrap();
    let plan = Plan::new(&scene).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let options = |name: &str, threads| Options { out: dir.path().join(name), threads, fresh: false };
    let bytes = |name: &str| std::fs::read(dir.path().join(name).join("results.csv")).unwrap();
    run(&scene, &plan, &options("whole", 1), &Silent, &contact_model::never).unwrap();

    let counter = UnitCounter::default();
    let stop = || counter.0.load(Ordering::Relaxed) >= 2;
    let outcome = run(&scene, &plan, &options("parts", 1), &counter, &stop).unwrap();
    assert!(outcome.stopped && outcome.states >= 6 && outcome.states < 18, "{outcome:?}");
    let manifest = std::fs::read_to_string(dir.path().join("parts/manifest.json")).unwrap();
    assert!(manifest.contains("\"complete\": false"));

    let counter = UnitCounter::default();
    let outcome = run(&scene, &plan, &options("parts", 2), &counter, &contact_model::never).unwrap();
    assert!(!outcome.stopped && outcome.states == 18);
    assert_eq!((counter.0.into_inner(), counter.1.into_inner()), (6, 2));
    assert_eq!(bytes("whole"), bytes("parts"));
}

/// Small solves predict the cost of a run only where its sizes say that it is long, or say nothing.
#[test]
fn a_short_run_is_predicted_from_its_sizes() {
    let plan = |text: String| {
        let scene = SceneFile::parse(Path::new("three.toml"), text).unwrap_or_else(|error| panic!("{error}"));
        Plan::for_run(&scene).unwrap()
    };
    let short = plan(SCENE.into());
    assert_eq!(short.predicted_from, Some(PredictedFrom::Sizes));
    let seconds = short.predicted().unwrap().seconds;
    assert!(seconds > 0.0 && seconds < 1.0, "{seconds}");
    let line = short.line(2);
    let expected = "bem3d, 33 x 33 cells of 0.0303; mdr1d, a line of 1024 elements; free boundary, 3 states on each of 3 surfaces, less than 1 s";
    assert_eq!(line, expected);
    assert!(short.to_string().contains("(from the sizes and times stored in the program"), "{short}");
    let long = plan(SCENE.replace("surfaces = 3", "surfaces = 100000"));
    let adhesive = "[effects]\nadhesion = { work = 1e-6 }\n[outputs]";
    let unknown = plan(
        SCENE
            .replace("\"mdr1d\"", "")
            .replace("[models.mdr1d]\nelements = 1024\n", "")
            .replace("[outputs]", adhesive),
    );
    for measured in [long, unknown] {
        assert_eq!(measured.predicted_from, Some(PredictedFrom::SmallSolves));
        assert!(measured.predicted().unwrap().applications > 0.0);
        assert!(measured.to_string().contains("(from small solves on this machine"), "{measured}");
    }
}

#[test]
fn exit_codes_say_how_it_went() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("good.toml"), SCENE).unwrap();
    std::fs::write(path("bad.toml"), SCENE.replace("hurst = 0.7", "hurst = 1.7")).unwrap();
    // The fit of the paper ends at F_bar = 0.086.
    let beyond = SCENE.replace("\"mdr1d\"", "\"power_law\"").replace("[models.mdr1d]\nelements = 1024\n", "");
    std::fs::write(path("beyond.toml"), beyond).unwrap();
    let out =
        |name: &str| program(&["run", &path(name), "--out", &path("out"), "--threads", "2", "--verbose"]);
    let good = out("good.toml");
    assert_eq!(good.status.code(), Some(0), "{}", texts(&good).1);
    assert!(texts(&good).0.contains("results.csv") && texts(&good).1.contains("predicted"));
    let bad = out("bad.toml");
    assert_eq!(bad.status.code(), Some(2));
    assert!(texts(&bad).1.contains("hurst = 1.7") && texts(&bad).1.contains("^^^"), "{}", texts(&bad).1);
    let beyond = out("beyond.toml");
    assert_eq!(beyond.status.code(), Some(3), "{}", texts(&beyond).1);
    assert!(texts(&beyond).1.contains("is outside [0, 0.086]"));
    // What failed is said without the rest, too.
    let beyond = program(&["run", &path("beyond.toml"), "--out", &path("out")]);
    let (_, said) = texts(&beyond);
    assert_eq!(beyond.status.code(), Some(3), "{said}");
    assert!(
        said.contains("is outside [0, 0.086]") && said.contains(" states were refused or did not "),
        "{said}"
    );
    assert!(!said.contains("predicted") && !said.contains("jobs done"), "{said}");
    assert_eq!(program(&["run", &path("nowhere.toml")]).status.code(), Some(1));
}

#[test]
fn plans_surfaces_results_and_completions_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("a.toml"), SCENE).unwrap();
    let (plan, _) = texts(&program(&["plan", &path("a.toml")]));
    for words in [
        "adhesion   off",
        "33 x 33 cells",
        "a line of 1024 elements",
        "not requested",
        "estimate",
        "of memory",
    ] {
        assert!(plan.contains(words), "{words}: {plan}");
    }
    for file in ["s.npy", "s.txt", "s.xyz", "s.vti"] {
        let made = program(&[
            "surface",
            &path(file),
            "--seed",
            "1",
            "--cells",
            "48",
            "--side",
            "1 mm",
            "--rms-height",
            "1 um",
        ]);
        assert!(
            made.status.success() && texts(&made).0.contains("rms height         1 um"),
            "{:?}",
            texts(&made)
        );
    }
    let (info, _) = texts(&program(&["info", &path("s.txt")]));
    assert!(info.contains("48") && info.contains("fractal dimension"), "{info}");
    assert!(info.contains("spectrum"), "{info}");
    let (info, _) = texts(&program(&["info", &path("s.npy")]));
    assert!(info.contains("no map without further options"), "{info}");
    let (info, _) = texts(&program(&["info", &path("s.npy"), "--unit", "m", "--cell", "1 um"]));
    assert!(info.contains("rms height         1 um"), "{info}");
    program(&["run", &path("a.toml"), "--out", &path("out")]);
    let (info, _) = texts(&program(&["info", &path("out/results.csv")]));
    assert!(
        info.contains("18 rows") && info.contains("column force [scene]") && info.contains("converged"),
        "{info}"
    );
    let mixed = program(&["surface", &path("t.npy"), "--seed", "1", "--side", "1 mm"]);
    assert!(!mixed.status.success() && texts(&mixed).1.contains("all lengths"), "{:?}", texts(&mixed));
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (script, _) = texts(&program(&["completions", shell]));
        assert!(script.contains("fractal-contact") && script.contains("detrend"), "{shell}");
    }
    let (help, _) = texts(&program(&["--help"]));
    assert!(help.contains("Examples:"));
}

/// What bash offers after these words, the last of which is begun; sorted.
fn offered(script: &Path, words: &[&str]) -> Vec<String> {
    // As bash calls the function: the name of the program, the word that is begun, and the one before it.
    const ASK: &str = "source \"$1\"; shift; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); \
        function=$(complete -p fractal-contact | sed 's/.*-F \\([^ ]*\\).*/\\1/'); \
        \"$function\" fractal-contact \"${COMP_WORDS[COMP_CWORD]}\" \"${COMP_WORDS[COMP_CWORD - 1]}\"; \
        printf '%s\\n' \"${COMPREPLY[@]}\"";
    let asked = Command::new("bash")
        .args(["--norc", "-c", ASK, "bash"])
        .arg(script)
        .arg("fractal-contact")
        .args(words)
        .output()
        .unwrap();
    let (offered, error) = texts(&asked);
    assert!(asked.status.success() && error.is_empty(), "{words:?}: {error}");
    let mut offered: Vec<String> = offered.lines().filter(|l| !l.is_empty()).map(Into::into).collect();
    offered.sort();
    offered
}

#[test]
fn bash_completes_subcommands_flags_and_values() {
    if Command::new("bash").arg("--version").output().is_err() {
        println!("skipped: there is no bash");
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let script = dir.path().join("fractal-contact.bash");
    let (text, _) = texts(&program(&["completions", "bash"]));
    std::fs::write(&script, &text).unwrap();
    let of = |words: &[&str]| offered(&script, words);
    assert_eq!(of(&["pr"]), ["press"]);
    assert_eq!(of(&["press", "--b"]), ["--ball", "--bodies", "--border", "--boundary"]);

    assert_eq!(of(&["press", "map.csv", "--und"]), ["--undefined"]);
    assert_eq!(of(&["press", "map.csv", "--detrend", "pl"]), ["plane"]);
    let trends = of(&["press", "map.csv", "--detrend", ""]);
    assert!(["none", "mean", "plane"].iter().all(|trend| trends.contains(&(*trend).into())), "{trends:?}");
    assert_eq!(of(&["completions", "z"]), ["zsh"]);
    // Every subcommand offers its own flags.
    for subcommand in of(&[""]).iter().filter(|word| !word.starts_with('-') && *word != "help") {
        let flags = of(&[subcommand, "--"]);
        assert!(
            flags.contains(&"--help".into()) && !flags.contains(&"--version".into()),
            "{subcommand}: {flags:?}"
        );
    }
}

/// Every place to which the script for zsh goes on is in it, and the one for fish asks for subcommands by the
/// names that the program has. These shells need not be there.
#[test]
fn scripts_of_zsh_and_fish_name_what_they_have() {
    let (zsh, _) = texts(&program(&["completions", "zsh"]));
    let names = zsh.split(|c: char| !(c.is_alphanumeric() || "_-".contains(c)));
    let called: Vec<&str> = names.filter(|w| w.starts_with("_fractal") && w.ends_with("_commands")).collect();
    assert!(!called.is_empty());
    for function in called {
        assert!(zsh.contains(&format!("{function}() {{")), "{function}");
    }
    assert!(zsh.starts_with("#compdef fractal-contact"));
    for command in ["press", "run", "info"] {
        assert!(zsh.lines().any(|line| line.trim() == format!("({command})")), "{command}");
    }
    let (fish, _) = texts(&program(&["completions", "fish"]));
    assert!(
        fish.lines()
            .filter(|l| l.starts_with("complete "))
            .all(|l| l.starts_with("complete -c fractal-contact "))
    );
    let asked = fish.lines().find(|line| line.contains("-l detrend")).unwrap();
    let condition: Vec<&str> = asked.split('"').nth(1).unwrap().split_whitespace().collect();
    assert!(condition[1] == "press" && fish.contains(&format!("function {}\n", condition[0])), "{asked}");
}

/// Ctrl-C, as the shell sends it.
#[cfg(unix)]
#[test]
fn an_interrupt_keeps_the_states_so_far() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    // Far more surfaces than can be solved before the signal comes.
    std::fs::write(path("long.toml"), SCENE.replace("surfaces = 3", "surfaces = 100000")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_fractal-contact"))
        .args(["run", &path("long.toml"), "--out", &path("out"), "--threads", "1"])
        .stderr(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let out = dir.path().join("out");
    while runs::Store::count(&out) < 3 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let file = runs::CsvFile::read(&dir.path().join("out/results.csv")).unwrap();
    assert!(file.rows.len() >= 9);
    assert!(std::fs::read_to_string(path("out/manifest.json")).unwrap().contains("\"complete\": false"));
}

/// Shards of a scene with fields, one of them killed and begun again; then the tables of one process.
#[test]
fn shards_of_a_scene_are_merged_into_its_tables() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    let scene = path("a scene.toml");
    let fields = SCENE
        .replace("[\"bem3d\", \"mdr1d\"]", "[\"bem3d\"]")
        .replace("[models.mdr1d]\nelements = 1024\n", "")
        .replace("[outputs]\n", "[outputs]\npressure = [\"npy\"]\n");
    std::fs::write(&scene, &fields).unwrap();
    assert_eq!(program(&["run", &scene, "--out", &path("one")]).status.code(), Some(0));
    let out = path("many shards");
    let shard = |which: &str| program(&["run", &scene, "--out", &out, "--shard", which]);
    assert!(texts(&shard("1/2")).0.starts_with("shard 1/2: "));
    // Not all of them yet.
    let gap = program(&["merge", "--out", &out]);
    let (_, said) = texts(&gap);
    assert!(
        gap.status.code() == Some(1) && said.contains("compute them with: fractal-contact run '"),
        "{said}"
    );
    assert_eq!(program(&["status", "--out", &out]).status.code(), Some(3));
    assert_eq!(shard("0/2").status.code(), Some(0));
    assert_eq!(program(&["status", "--out", &out]).status.code(), Some(0));
    assert_eq!(program(&["merge", "--out", &out]).status.code(), Some(0));
    let files = |of: &str| {
        let all = std::fs::read_dir(path(of)).unwrap().map(|entry| entry.unwrap().path());
        let kept =
            |path: &std::path::PathBuf| path.extension().is_some_and(|end| end == "csv" || end == "npy");
        let mut all: Vec<_> = all
            .filter(kept)
            .map(|p| (p.file_name().unwrap().to_owned(), std::fs::read(&p).unwrap()))
            .collect();
        all.sort();
        all
    };
    assert!(files("one").len() >= 4 && files("one") == files("many shards"));
    // A field that was changed since is a damaged result of its surface.
    let field =
        files("many shards").into_iter().find(|(name, _)| name.to_string_lossy().ends_with("npy")).unwrap().0;
    std::fs::write(Path::new(&out).join(field), "x").unwrap();
    let (_, said) = texts(&program(&["merge", "--out", &out]));
    assert!(said.contains("0 are missing and 1 damaged"), "{said}");
    // The scene is another one now.
    std::fs::write(&scene, fields.replace("surfaces = 3", "surfaces = 4")).unwrap();
    let (_, said) = texts(&program(&["merge", "--out", &out]));
    assert!(said.contains("was changed since"), "{said}");
}

#[test]
fn lays_laws_of_heights_and_twins_are_drawn() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).display().to_string();
    let drawn = |name: &str, more: &[&str]| {
        let file = path(name);
        let common = [
            "surface",
            &file,
            "--seed",
            "4",
            "--cells",
            "64",
            "--hurst",
            "0.8",
            "--roll-off-wavelength",
            "0.25",
        ];
        program(&[&common[..], more].concat())
    };
    let parameter = |name: &str, quantity: &str| -> f64 {
        let out = path(&format!("{name}-statistics"));
        let told = program(&["info", &path(name), "--unit", "none", "--size", "1", "--out", &out]);
        assert!(told.status.success(), "{}", texts(&told).1);
        let table = runs::CsvFile::read(&Path::new(&out).join("statistics.csv")).unwrap();
        let row = table.texts("quantity").unwrap().iter().position(|q| *q == quantity).unwrap();
        table.numbers("value").unwrap()[row].unwrap()
    };
    assert!(drawn("lay.npy", &["--anisotropy", "4", "--lay", "30"]).status.success());
    // Waves are across the lay.
    assert!((parameter("lay.npy", "Std") - 120.0).abs() < 10.0);
    let weibull = drawn("weibull.npy", &["--weibull", "1.5"]);
    assert!(texts(&weibull).0.contains("heights            as prescribed; amplitudes of the waves within"));
    assert!((parameter("weibull.npy", "Ssk") - 1.07).abs() < 0.05);
    // The twin of a surface with its own seed is that surface.
    assert!(drawn("surface.npy", &[]).status.success());
    let reading = ["--unit", "none", "--size", "1", "--seed"];
    let values = |name: &str| -> Vec<f64> {
        let bytes = std::fs::read(path(name)).unwrap();
        let (_, values) = bytes.split_at(bytes.len() - 8 * 64 * 64);
        values.chunks_exact(8).map(|v| f64::from_le_bytes(v.try_into().unwrap())).collect()
    };
    let difference = |seed: &str| {
        let twin =
            program(&[&["twin", &path("surface.npy"), &path("twin.npy")][..], &reading, &[seed]].concat());
        assert!(twin.status.success(), "{}", texts(&twin).1);
        let pairs = values("surface.npy").into_iter().zip(values("twin.npy"));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(difference("4") < 1e-12 && difference("5") > 1e-3);
    assert!((parameter("twin.npy", "Sq") - 0.01).abs() < 1e-12);
    let [from, to] = [path("weibull.npy"), path("skewed.npy")];
    let skewed = [&["twin", &from, &to, "--keep-heights"][..], &reading, &["5"]];
    assert!(program(&skewed.concat()).status.success());
    assert!((parameter("skewed.npy", "Ssk") - parameter("weibull.npy", "Ssk")).abs() < 1e-9);
    for (wrong, named) in [
        (&["--anisotropy", "0"][..], "ratio of an anisotropy"),
        (&["--anisotropy", "NaN"], "ratio of an anisotropy"),
        (&["--weibull=-1"], "shape"),
        (&["--lay", "3"], "--anisotropy"),
        (&["--fractal-dimension", "2.2"], "--hurst"),
    ] {
        let refused = drawn("wrong.npy", wrong);
        assert!(
            !refused.status.success() && texts(&refused).1.contains(named),
            "{wrong:?}: {}",
            texts(&refused).1
        );
    }
    assert!(!Path::new(&path("wrong.npy")).exists());
}
