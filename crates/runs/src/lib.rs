//! Jobs, result store, CSV, manifest and progress, which all long commands share.
//!
//! # Jobs
//!
//! A [`Job`] is one independent piece of work. It has a cost, and a key of everything that decides its
//! numbers. [`run_stored`] does a list of jobs, one per thread, the most expensive first.
//!
//! The [`Store`] keeps each finished job at once, whole or not at all. It checks a result when it reads it: a
//! damaged or foreign result is computed again. Results are stored as JSON that names their [`ResultKind`]
//! and keeps every bit of their numbers. They have the same bytes for any number of threads. A job whose
//! parts depend on each other keeps a [`Checkpoint`] beside its stored part.
//!
//! # Files
//!
//! * [`files`] writes files whole or not at all.
//! * A CSV ([`write_csv`], [`CsvFile`]) begins with `#` lines: title, columns and units, sources, parameters,
//!   version, and the command that makes the same bytes. Numbers are the shortest decimals that read back to
//!   the same bits. What is absent is empty, and never NaN.
//! * Times and the machine are not in a CSV. They are in `manifest.json` ([`machine`]).
//!
//! # Terminal
//!
//! [`Reporter`] reports the progress of a run. [`out!`] and [`err!`] write lines, and do not panic when a
//! pipe is closed or a device is full. [`amounts`] writes times and memory in words.
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
pub mod files;
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
mod work_done;

pub use checkpoint::{Checkpoint, Unused};
pub use csv_file::{CsvFile, Header, csv_bytes, number, write_csv};
pub use encoding::ResultKind;
pub use error::{Error, Result};
pub use jobs::{
    Failure, Job, JobList, JobRun, Ordered, Threads, collect, on_one_thread, run_in_order, run_jobs,
    run_stored,
};
pub use manifest::{file_names, machine, write_manifest};
pub use meters::{
    available_memory, check_memory, cpu_seconds, peak_memory, process_cpu_seconds, reset_peak_memory,
    resident_memory, threads_for_memory,
};
pub use progress::{JobInHand, Pictures, Progress, Silent, StatesInHand};
pub use reporter::Reporter;
pub use shard::{MOST_SHARDS, Shard, ShardChoice, TASKS, assign, largest_first};
pub use store::{Pack, PackHead, Store, fnv1a_128};
pub use terminal::{folded, print, print_error};
pub use threads::{JOB_STACK, MOST_THREADS, THREADS_VARIABLE, granted_pool, grants_a_thread, with_threads};
pub use work_done::WorkDone;
