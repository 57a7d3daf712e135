//! Flags of commands on many machines.

use clap::Args;
use runs::ShardChoice;
use runs::cluster::{Division, Submission};
use std::path::PathBuf;

/// The part of a command's jobs that one process does.
#[derive(Debug, Args)]
pub struct Sharded {
    /// Do one of N parts of the jobs, counted from 0, store the results and write no table, such as 0/4; auto
    /// takes i and N from the variables of a SLURM array or of a HyperQueue task. `merge` makes the tables.
    #[arg(long, value_name = "i/N")]
    pub shard: Option<ShardChoice>,
}

/// Flags of the forecast.
#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    pub division: Division,
    /// Number of nodes for which the makespan is predicted.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub nodes: u16,
    /// Cores of a node [default: those of this machine, or those of a task if that is more].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub node_cores: Option<u16>,
    /// Memory of a node in megabytes [default: no limit].
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub node_memory: Option<u64>,
    /// The command, such as reproduce-fig2 --preset paper.
    #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true)]
    pub command: Vec<String>,
}

/// Flags of a submission.
#[derive(Debug, Args)]
pub struct SubmitArguments {
    #[command(flatten)]
    pub submission: Submission,
    #[command(flatten)]
    pub division: Division,
    /// The command, such as reproduce-fig2 --preset paper --out DIR.
    #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true)]
    pub command: Vec<String>,
}

/// Flags of the commands that read a directory of shards.
#[derive(Debug, Args)]
pub struct StudyShardsArguments {
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// The beginning of the digest of the plan, where the directory holds several plans.
    #[arg(long, value_name = "DIGEST")]
    pub plan: Option<String>,
}
