//! Numbers of arguments and of the environment that no machine has room for, and those that are none: refused
//! by name, before memory is asked for; and a machine that grants no threads.

use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_fractal-contact");

const COUNTS: [&str; 9] = [
    "0",
    "1000000000",
    "1000000000000",
    "2147483648",
    "9223372036854775808",
    "18446744073709551615",
    "-1",
    "NaN",
    "1e9",
];

const SCENE: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nforce_bar = [0.01, 0.1]\n[scene.surface]\nkind = \"self_affine\"\n\
    side = 1\nhurst = 0.7\nrms_height = 0.01\n[outputs]\nstiffness = true\n[models.bem3d]\ncells = 33\n[sampling]\nseed = 7\nsurfaces = 3\n";

/// With at most 8 GB of addresses where the shell limits them: what asks for more would be an abort.
fn limited(limit: &str, words: &[&str]) -> Command {
    let mut command = Command::new(if cfg!(unix) { "sh" } else { PROGRAM });
    if cfg!(unix) {
        command.args(["-c", &format!("{limit}; exec \"$0\" \"$@\""), PROGRAM]);
    }
    command.args(words);
    command
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

/// The threads of jobs have stacks of their own size, whatever the environment asks for.
#[test]
fn the_environment_does_not_take_the_stack() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("scene.toml"), SCENE).unwrap();
    let arguments = ["run", &path("scene.toml"), "--out", &path("out"), "--threads", "2"];
    let output = Command::new(PROGRAM).args(arguments).env("RUST_MIN_STACK", "1").output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
}

#[test]
fn numbers_beyond_every_machine_are_refused_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("scene.toml"), SCENE).unwrap();
    let (scene, out) = (path("scene.toml"), path("drawn.npy"));
    let counts: [(&[&str], &str); 9] = [
        (&["surface", &out, "--seed", "1"], "cells"),
        (&["surface", &out, "--seed", "1"], "rows"),
        (&["run", &scene], "threads"),
        (&["plan", &scene], "nodes"),
        (&["plan", &scene, "--nodes", "2"], "node-cores"),
        (&["plan", &scene], "tasks"),
        (&["plan", &scene], "cores"),
        (&["submit", &scene, "--engine", "slurm"], "tasks"),
        (&["submit", &scene, "--engine", "slurm"], "time"),
    ];
    let numbers: [(&[&str], &str); 6] = [
        (&["surface", &out, "--seed", "1"], "fractal-dimension"),
        (&["surface", &out, "--seed", "1"], "hurst"),
        (&["surface", &out, "--seed", "1"], "anisotropy"),
        (&["surface", &out, "--seed", "1"], "weibull"),
        (&["surface", &out, "--seed", "1"], "rms-height"),
        (&["surface", &out, "--seed", "1"], "size"),
    ];
    let no_numbers = ["-1", "NaN", "inf", "-inf", "1e999", "x", ""];
    let counts = counts.into_iter().map(|case| (case, &COUNTS[..]));
    let numbers = numbers.into_iter().map(|case| (case, &no_numbers[..]));
    let mut wrong = Vec::new();
    for ((words, flag), values) in counts.chain(numbers) {
        for value in values {
            let joined = format!("--{flag}={value}");
            let output = limited("ulimit -v 8000000", &[words, &[&joined]].concat()).output().unwrap();
            let (text, line) = (said(&output), format!("{} {joined}", words[0]));
            let end = matches!(output.status.code(), Some(1 | 2));
            // The size of a square is its side.
            let side = if flag == "size" { "side" } else { flag };
            let named = [flag, side, &flag.replace('-', "_"), &flag.replace('-', " ")].map(str::to_owned);
            let told = named.iter().any(|name| text.to_lowercase().contains(name));
            if !end || !told || text.contains("panicked") {
                wrong.push(format!("{line}: {} {text}", output.status));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_number_of_threads_in_the_environment_is_one_or_is_refused() {
    let run = |threads: &str| {
        let mut command = limited("true", &["info", "nowhere.txt"]);
        said(&command.env("RAYON_NUM_THREADS", threads).output().unwrap())
    };
    for threads in ["1", "2", "0", ""] {
        assert!(run(threads).contains("nowhere.txt"), "{}", run(threads));
    }
    for threads in ["999999", "-1", "two", "1e3", "18446744073709551616"] {
        let text = run(threads);
        assert!(text.contains(&format!("RAYON_NUM_THREADS = {threads}: expected a whole number")), "{text}");
        assert!(!text.contains("panicked"), "{text}");
    }
}

/// Stacks of many threads do not fit into a limited address space: there are fewer threads then, and the same
/// bytes.
#[cfg(target_os = "linux")]
#[test]
fn fewer_threads_than_asked_for_give_the_same_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("scene.toml"), SCENE).unwrap();
    let run = |limit: &str, out: &str, asked: &str| {
        let words = ["run", &path("scene.toml"), "--out", &path(out), "--threads", "3"];
        let output = limited(limit, &words).env("RAYON_NUM_THREADS", asked).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{limit}, {asked} threads: {}", said(&output));
        (std::fs::read(dir.path().join(out).join("results.csv")).unwrap(), said(&output))
    };
    let (all, _) = run("true", "all", "2");
    // 4096 stacks of 8 MB are 34 GB.
    assert_eq!(run("ulimit -v 3000000", "fewer", "4096").0, all);
}

/// A limit of processes binds everybody but root, who becomes somebody else for this where the system lets
/// it.
#[cfg(target_os = "linux")]
#[test]
fn a_machine_without_threads_has_the_calling_one() {
    use std::os::unix::fs::PermissionsExt as _;
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("scene.toml"), SCENE).unwrap();
    std::fs::set_permissions(dir.path(), std::fs::Permissions::from_mode(0o777)).unwrap();
    let root = std::fs::metadata("/proc/self").is_ok_and(|of| std::os::unix::fs::MetadataExt::uid(&of) == 0);
    let command = |binary: &str, words: &[&str]| {
        let mut command = Command::new(if root { "setpriv" } else { "prlimit" });
        if root {
            command.args(["--reuid", "65534", "--regid", "65534", "--clear-groups", "prlimit"]);
        }
        command.args(["--nproc=1", binary]).args(words);
        command
    };
    let can = command(PROGRAM, &["--version"]).output().is_ok_and(|output| output.status.success());
    // A second process is refused where the limit holds.
    let holds = command("sh", &["-c", "true & wait"]).output().is_ok_and(|output| !output.status.success());
    if !can || !holds {
        eprintln!("not tried: this system does not limit processes, or not for somebody else");
        return;
    }
    let run = |out: &str, threads: &str| {
        let words = ["run", &path("scene.toml"), "--out", &path(out), "--threads", threads];
        let output = command(PROGRAM, &words).output().unwrap();
        let text = said(&output);
        assert_eq!(output.status.code(), Some(0), "{text}");
        assert!(text.contains("the system grants no thread"), "{text}");
        std::fs::read(dir.path().join(out).join("results.csv")).unwrap()
    };
    let free = ["run", &path("scene.toml"), "--out", &path("free"), "--threads", "2"];
    let output = Command::new(PROGRAM).args(free).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let expected = std::fs::read(path("free/results.csv")).unwrap();
    assert_eq!(run("one", "1"), expected);
    assert_eq!(run("three", "3"), expected);
}
