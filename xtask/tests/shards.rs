//! Commands divided into shards: the merged files equal those of a single process, and merging solves
//! nothing.

#![allow(clippy::unwrap_used)] // Helpers outside #[test] functions.

use std::path::Path;
use std::process::{Command, Output};

fn xtask(words: &str, out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    // The environment of an engine has no effect without --shard.
    command.env("SLURM_ARRAY_TASK_ID", "7").env("HQ_TASK_ID", "7");
    command.args(words.split(' ')).arg("--out").arg(out).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

/// Number of jobs, and number of those whose result was stored.
fn work(output: &Output) -> (usize, usize) {
    let text = said(output);
    let lines = text.lines().filter(|line| line.contains("jobs done"));
    let first = |part: &str| part.split(' ').next().unwrap().parse::<usize>().unwrap();
    let count = |line: &str| {
        let (jobs, found) = line.split_once(" s, ").unwrap();
        (first(jobs), first(found))
    };
    lines.map(count).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

/// Every file of a directory except those that hold times and machines.
fn files(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<(String, Vec<u8>)> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file() && !path.ends_with("manifest.json") && !path.ends_with("exponent.md"))
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap()))
        .collect();
    all.sort();
    all
}

#[test]
fn merged_shards_are_the_undivided_command() {
    // Formulas are evaluated again: two theories for each of two periodic cases, on two grids.
    for (command, formulas) in [
        ("reproduce-fig2 --cells 65 --surfaces 2 --fractal-dimensions 2.0,2.6 --forces 1e-3:20:5,0.086", 0),
        ("reproduce-fig6 --elements 4096 --lines 3 --fractal-dimensions 2.0,2.6 --forces 1e-3:20:5,0.086", 0),
        ("verify --cells 33 --surfaces 2 --elements 2048 --lines 3 --forces 1e-3:20:7,0.086,1", 0),
        ("exponent --preset quick --fractal-dimensions 2.2,2.8 --error 20%", 0),
        ("reproduce-two-cases --cells 64 --surfaces 2 --roll-off 3 --forces 1e-2:10:5 --tolerance 1e-3", 8),
    ] {
        let (one, many) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let whole = xtask(command, one.path());
        assert!(whole.status.success(), "{}", said(&whole));
        for shard in ["2/3", "0/3", "1/3"] {
            let part = xtask(&format!("{command} --shard {shard} --threads 1"), many.path());
            assert!(part.status.success(), "{}", said(&part));
        }
        let status = xtask("status", many.path());
        assert!(status.status.success() && said(&status).contains("100 % of the predicted time"));
        let merged = xtask("merge", many.path());
        assert!(merged.status.success(), "{}", said(&merged));
        let (jobs, found) = work(&merged);
        assert!(jobs > 0 && jobs == found + formulas, "{command}: {found} of {jobs}");
        let (a, b) = (files(one.path()), files(many.path()));
        let names = |files: &[(String, Vec<u8>)]| files.iter().map(|f| f.0.clone()).collect::<Vec<_>>();
        assert_eq!(names(&a), names(&b), "{command}");
        for ((name, bytes), (_, theirs)) in a.iter().zip(&b) {
            assert!(bytes == theirs, "{command}: {name}");
        }
    }
}

#[test]
fn commands_that_cannot_be_divided_are_errors() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |words: &str, expected: &str| {
        let output = xtask(words, dir.path());
        let text = said(&output);
        assert!(!output.status.success() && text.contains(expected), "{words}: {text}");
        assert!(!text.contains("panicked"), "{text}");
    };
    refused("reproduce-fig2 --accuracy 5% --shard 0/2", "accuracy = 0.05: expected no accuracy");
    refused("reproduce-fig2 --fresh --shard 0/2", "fresh = true");
    refused("audit --preset quick --shard 0/2", "command = a command without jobs to share");
    refused("reproduce-fig2 --shard 2/2", "i/2 with i from 0 to 1");
    refused("reproduce-fig2 --shard auto", "SLURM_ARRAY_TASK_MIN = nothing");
    refused("reproduce-fig1 --shard 0/2", "unexpected argument '--shard'");
    refused("reproduce-fig2 --cells 2 --shard 0/2", "cells = 2");
    refused("merge", "a directory in which shards were run");
    refused("status --plan zz", "there are:");
    refused("submit --engine pbs reproduce-fig2", "slurm or hyperqueue");
    refused("submit --engine slurm reproduce-fig9", "unrecognized subcommand");
    refused("submit --engine slurm --time 0 reproduce-fig2", "--time");
    refused(
        "plan --nodes 1 --node-cores 1 --cores 4 reproduce-fig2",
        "expected nodes that hold a task of 4 cores",
    );
}

/// With several commands in one directory, `merge` needs the choice of one, and each can be chosen.
#[test]
fn a_chosen_plan_is_merged_beside_another() {
    let (both, one) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let figure = |number, of| format!("reproduce-fig{number} {of} --fractal-dimensions 2.0 --forces 0.1,1");
    let (solid, line) = (figure(2, "--cells 33 --surfaces 2"), figure(6, "--elements 1024 --lines 2"));
    for command in [&solid, &line] {
        assert!(xtask(&format!("{command} --shard 0/1"), both.path()).status.success());
    }
    let mixed = said(&xtask("merge", both.path()));
    assert!(mixed.contains("there are 2"), "{mixed}");
    assert!(xtask(&solid, one.path()).status.success());
    let digest =
        mixed.lines().find(|l| l.contains("reproduce-fig2")).unwrap().trim().split(' ').next().unwrap();
    let merged = xtask(&format!("merge --plan {digest}"), both.path());
    assert!(merged.status.success(), "{}", said(&merged));
    let read = |dir: &Path| std::fs::read(dir.join("fig2.csv")).unwrap();
    assert!(read(both.path()) == read(one.path()) && !both.path().join("fig6.csv").exists());
}

/// The error for a missing shard names the command that computes it, and that command does.
#[test]
fn the_command_that_is_named_closes_the_gap() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out of the way");
    let command = "reproduce-fig2 --cells 33 --surfaces 2 --fractal-dimensions 2.0 --forces 0.1,1";
    assert!(xtask(&format!("{command} --shard 0/2"), &out).status.success());
    let refused = xtask("merge", &out);
    let text = said(&refused);
    assert_eq!(refused.status.code(), Some(1), "{text}");
    assert!(
        text.contains("jobs of `cargo xtask reproduce-fig2 --cells 33")
            && text.contains("33 cells a side: bem3d, surface 1"),
        "{text}"
    );
    assert_eq!(xtask("status", &out).status.code(), Some(3));
    let named =
        text.split("compute them with: cargo xtask ").nth(1).unwrap().split(", or on").next().unwrap();
    let closed =
        Command::new("bash").arg("-c").arg(format!("{} {named}", env!("CARGO_BIN_EXE_xtask"))).output();
    assert!(closed.unwrap().status.success());
    assert!(xtask("merge", &out).status.success());
}
