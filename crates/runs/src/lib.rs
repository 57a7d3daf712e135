//! Jobs, result store, CSV, manifest and progress, which all long commands share.
//!
//! # Jobs
//!
//! A [`Job`] is one independent piece of work with a key (everything that decides its numbers) and a cost.
//! [`run_stored`] does a list of them, one per thread, the most expensive first. Each finished job is kept in
//! the [`Store`] at once, whole or not at all, and checked on reading: a damaged or foreign result is
//! computed again. Results have the same bytes for any number of threads. They are stored as JSON that names
//! their [`ResultKind`] and keeps every bit of their numbers. A job whose parts depend on each other keeps a
//! [`Checkpoint`] beside its stored part.
//!
//! # Files
//!
//! * [`files`]: written whole or not at all.
//! * CSV ([`write_csv`], [`CsvFile`]): `#` lines with title, columns and units, sources, parameters, version
//!   and the command that makes the same bytes; shortest decimals that read back to the same bits; absent is
//!   empty, never NaN. No times and no machine: those are in `manifest.json` ([`machine`]).
//!
//! # Terminal
//!
//! [`Reporter`] reports the progress of a run. [`out!`] and [`err!`] write lines, and a closed pipe or a full
//! device does not cause a panic.
//!
//! [`amounts`] writes times and memory in words.
//!
//! # What it does not do
//!
//! It has no mechanics, no pictures and no parsing of arguments.

#![allow(clippy::format_push_string)] // Text is built once per file: clear beats one allocation less.

pub mod amounts;
mod cgroup;
mod checkpoint;
pub mod cluster;
mod csv_file;
mod encoding;
mod error;
mod finite;
mod jobs;
mod manifest;
mod meters;
mod progress;
mod reporter;
mod shard;
mod store;
mod terminal;
mod threads;

pub use checkpoint::{Checkpoint, Unused};
pub use csv_file::{CsvFile, Header, number, write_csv};
pub use encoding::ResultKind;
pub use error::{Error, Result};
pub use files;
pub use jobs::{
    Failure, Job, JobList, Ordered, Threads, collect, on_one_thread, run_in_order, run_jobs, run_stored,
};
pub use manifest::{file_names, machine, write_manifest};
pub use meters::{
    available_memory, check_memory, cpu_seconds, peak_memory, process_cpu_seconds, reset_peak_memory,
    resident_memory, threads_for_memory,
};
pub use progress::{JobInHand, Progress, Silent, StatesInHand};
pub use reporter::Reporter;
pub use shard::{MOST_SHARDS, Shard, ShardChoice, TASKS, assign, largest_first};
pub use store::{Pack, PackHead, Store, fnv1a_128};
pub use terminal::{folded, print, print_error};
pub use threads::{JOB_STACK, MOST_THREADS, THREADS_VARIABLE, granted_pool, grants_a_thread, with_threads};
