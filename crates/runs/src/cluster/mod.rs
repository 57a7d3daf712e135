//! A command on many machines: its plan, its shards, their merge, and the engines that run them (SLURM,
//! HyperQueue).
//!
//! A command is a list of independent jobs ([`crate::JobList`]). Every task of an engine runs the same
//! command with another `--shard i/N`: it makes the list, takes its part of it by predicted cost
//! ([`crate::assign`]) and adds its results to the store of the common directory ([`crate::Store`]). Tasks do
//! not communicate. The first of them writes the plan, which records the command. [`check`] reports which
//! jobs are done, missing or damaged. A merge is the command itself, which finds all of its jobs in the
//! store.

mod check;
mod forecast;
mod plan;
mod shard_run;
mod status;
mod submission;
#[cfg(test)]
mod tests_support;
mod words;

pub use check::{Completeness, JobState, check};
pub use forecast::{Division, Forecast};
pub use plan::{ShardPlan, without_flags};
pub use shard_run::{ShardReport, ShardRun, run_shard};
pub use status::{PlanStatus, status, submitted_tasks};
pub use submission::{Engine, Submission, Submitted};
pub use words::{quoted, toml};
