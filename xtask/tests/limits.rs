//! Counts that are too large for any machine, and values that are not numbers. Each is refused before
//! anything is solved or memory is allocated, by an error that names the flag and the expected values.

#![allow(clippy::unwrap_used)] // Helpers outside #[test] functions.

use std::path::Path;
use std::process::{Command, Output};

/// Counts that are too large for any machine, and values that are no counts.
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
/// Values that are no positive numbers.
const NUMBERS: [&str; 7] = ["0", "-1", "NaN", "inf", "-inf", "1e999", "x"];

/// Runs with at most 8 GB of address space where the shell can limit it: allocating more would abort the
/// program.
fn xtask(words: &[&str], directory: &Path) -> Output {
    let binary = env!("CARGO_BIN_EXE_xtask");
    let mut command = Command::new(if cfg!(unix) { "sh" } else { binary });
    if cfg!(unix) {
        command.args(["-c", "ulimit -v 8000000; exec \"$0\" \"$@\"", binary]);
    }
    command.args(words).current_dir(directory).output().unwrap()
}

/// Describes how a command that has to be refused ends otherwise than with exit code 1 or 2 and one message
/// that names the flag; `None` where it does not.
fn refused(words: &[&str], flag: &str) -> Option<String> {
    let directory = tempfile::tempdir().unwrap();
    let output = xtask(words, directory.path());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let told = said.contains(flag.trim_start_matches('-'))
        && ["expected", "invalid value", "is not in"].iter().any(|word| said.contains(word));
    let well = matches!(output.status.code(), Some(1 | 2))
        && told
        && !said.contains("panicked")
        && said.len() < 2000;
    (!well).then(|| format!("{}: {} {said}", words.join(" "), output.status))
}

/// The command, its flag, and the values of the lists that this flag accepts.
type LimitCase = (&'static [&'static str], &'static str, &'static [&'static str]);

const WITH_COUNTS: [LimitCase; 29] = [
    (&["reproduce-fig1"], "--cells", &[]),
    (&["reproduce-fig2"], "--cells", &[]),
    (&["reproduce-fig2"], "--surfaces", &[]),
    (&["reproduce-fig2"], "--threads", &["0"]),
    (&["verify"], "--lines", &[]),
    (&["reproduce-fig5"], "--elements", &[]),
    (&["reproduce-fig6"], "--elements", &[]),
    (&["reproduce-fig6"], "--lines", &[]),
    (&["reproduce-two-cases"], "--cells", &[]),
    (&["reproduce-two-cases"], "--cells-per-wave", &[]),
    (&["reproduce-two-cases"], "--surfaces", &[]),
    (&["reproduce-two-cases"], "--threads", &[]),
    (&["exponent", "--grids", "33,65", "--lines", "2,2", "--elements", "64,128"], "--surfaces", &[]),
    (&["exponent", "--surfaces", "2", "--lines", "2", "--elements", "64"], "--grids", &[]),
    (&["exponent", "--surfaces", "2", "--lines", "2", "--grids", "33"], "--elements", &[]),
    (&["exponent", "--surfaces", "2", "--grids", "33", "--elements", "64"], "--lines", &[]),
    (&["partial-slip"], "--cells", &[]),
    (&["partial-slip"], "--cells-per-wave", &[]),
    (&["partial-slip"], "--grids", &[]),
    (&["partial-slip"], "--surfaces", &[]),
    (&["partial-slip"], "--increments", &[]),
    (&["budget-check"], "--cases", &[]),
    (&["budget-check"], "--threads", &["0"]),
    (&["bench"], "--cells", &[]),
    (&["bench", "--cells", "33"], "--rows", &[]),
    (&["bench", "--cells", "33"], "--threads", &[]),
    (&["tuning"], "--repetitions", &[]),
    (&["plan", "reproduce-fig2"], "--surfaces", &[]),
    (&["plan", "reproduce-two-cases"], "--surfaces", &[]),
];

const WITH_NUMBERS: [LimitCase; 15] = [
    (&["reproduce-fig2"], "--tolerance", &[]),
    (&["reproduce-fig2"], "--accuracy", &[]),
    (&["reproduce-fig2", "--accuracy", "5%"], "--budget", &[]),
    (&["reproduce-fig2"], "--forces", &[]),
    (&["reproduce-fig2"], "--fractal-dimensions", &[]),
    (&["reproduce-two-cases"], "--tolerance", &[]),
    (&["reproduce-two-cases"], "--roll-off", &[]),
    (&["partial-slip"], "--tolerance", &[]),
    (&["partial-slip"], "--df", &[]),
    (&["partial-slip"], "--poisson", &["0"]),
    (&["exponent"], "--error", &[]),
    (&["exponent", "--plan"], "--budget", &[]),
    (&["bench", "--cells", "33"], "--tolerance", &[]),
    (&["audit"], "--share", &[]),
    (&["audit"], "--audit-tolerance", &[]),
];

/// Flags of `submit` that stand before the command.
const OF_ENGINES: [LimitCase; 5] = [
    (&["plan"], "--nodes", &[]),
    (&["plan"], "--node-cores", &[]),
    (&["plan"], "--tasks", &[]),
    (&["plan"], "--cores", &[]),
    (&["submit", "--engine", "slurm"], "--tasks", &[]),
];

#[test]
fn a_grid_beyond_the_memory_is_named_and_not_a_coarser_one() {
    // 1000 GB.
    if runs::available_memory().is_some_and(|bytes| bytes > 200_000_000_000) {
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let words = ["reproduce-fig2", "--cells", "65536", "--surfaces", "1", "--forces", "1"];
    let said = String::from_utf8_lossy(&xtask(&words, directory.path()).stderr).into_owned();
    assert!(said.contains("bem3d on 65536 x 65536 cells: needs about "), "{said}");
}

#[test]
fn counts_beyond_every_machine_are_refused_by_name() {
    let mut wrong = Vec::new();
    for (words, flag, taken) in WITH_COUNTS {
        for value in COUNTS.iter().filter(|value| !taken.contains(value)) {
            let mut line = words.to_vec();
            let joined = format!("{flag}={value}");
            line.push(&joined);
            wrong.extend(refused(&line, flag));
        }
    }
    for (words, flag, _) in OF_ENGINES {
        for value in COUNTS {
            let joined = format!("{flag}={value}");
            let line = [words, &[&joined, "reproduce-fig2", "--cells", "33", "--surfaces", "1"]].concat();
            wrong.extend(refused(&line, flag));
        }
    }
    for flag in ["--time", "--memory"] {
        for value in COUNTS.iter().filter(|value| **value != "1000000000" || flag == "--time") {
            let joined = format!("{flag}={value}");
            wrong.extend(refused(&["submit", "--engine", "slurm", &joined, "reproduce-fig2"], flag));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // A large seed is a seed like others.
    let directory = tempfile::tempdir().unwrap();
    let seed = "--seed=18446744073709551615";
    let done = xtask(&["plan", "reproduce-fig2", "--cells", "33", "--surfaces", "1", seed], directory.path());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn values_that_are_no_numbers_are_refused_by_name() {
    let mut wrong = Vec::new();
    for (words, flag, taken) in WITH_NUMBERS {
        for value in NUMBERS.iter().filter(|value| !taken.contains(value)) {
            let mut line = words.to_vec();
            let joined = format!("{flag}={value}");
            line.push(&joined);
            wrong.extend(refused(&line, flag));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
