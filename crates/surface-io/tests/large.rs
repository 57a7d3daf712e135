//! Memory of large maps on disk.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)] // Tests, as a whole.

use std::io::Write as _;
use surface_io::{Preprocessing, ReadOptions, Scan};

/// Most memory over that of the map.
const MOST: f64 = 1.3;

/// A kilobyte count of `/proc/self/status` or `/proc/meminfo`, in bytes.
fn bytes(file: &str, key: &str) -> f64 {
    let text = std::fs::read_to_string(file).unwrap();
    let line = text.lines().find(|line| line.starts_with(key)).unwrap();
    1024.0 * line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap()
}

/// The most memory of this process over that of the map of a file of so many bytes, which has no blocks on
/// disk.
fn share(on_disk: u64) -> f64 {
    let (rows, columns) = (1_u64 << 14, on_disk / 4 / (1 << 14));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("large.npy");
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    header.push_str(&" ".repeat(117 - header.len()));
    header.push('\n');
    let mut file = std::fs::File::create(&path).unwrap();
    file.write_all(&[&b"\x93NUMPY\x01\x00\x76\x00"[..], header.as_bytes()].concat()).unwrap();
    file.set_len(128 + on_disk).unwrap();
    let options = ReadOptions { cell: "1".parse().ok(), ..ReadOptions::default() };
    let map = Scan::read(&path, &options).unwrap().into_preprocessed(&Preprocessing::default()).unwrap().map;
    assert_eq!((map.rows() as u64, map.columns() as u64), (rows, columns));
    let share = bytes("/proc/self/status", "VmHWM:") / (8 * rows * columns) as f64;
    println!("{:.1} GB on disk, {share:.3} times the memory of the map", on_disk as f64 / 1e9);
    share
}

#[test]
fn raw_heights_take_little_more_than_their_map() {
    let share = share(1 << 28);
    assert!(share < MOST, "{share}");
}

/// `cargo test -p surface-io --test large -- --ignored`, half a minute: the same at a size that not every
/// machine holds.
#[test]
#[ignore = "takes 9 GB of memory"]
fn four_gigabytes_of_raw_heights_take_little_more_than_their_map() {
    if bytes("/proc/meminfo", "MemAvailable:") < 13e9 {
        println!("skipped: less than 13 GB of memory are free");
        return;
    }
    let share = share(4 << 30);
    assert!(share < MOST, "{share}");
}
