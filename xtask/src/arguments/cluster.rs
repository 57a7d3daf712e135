//! Flags of commands on many machines.

use clap::Args;
use runs::ShardChoice;
use runs::cluster::{Division, Submission};
use std::path::PathBuf;

/// The part of a command's jobs that one process does.
#[derive(Debug, Args)]
pub struct Sharded {
    /// Do one of N parts of the jobs, counted from 0, store what it finds and write no table: 0/4, or auto, as the variables of a SLURM array or
    /// of a HyperQueue task say. `merge` makes the tables.
    #[arg(long, value_name = "i/N")]
    pub shard: Option<ShardChoice>,
}

/// Flags of the forecast.
#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    pub division: Division,
    /// Nodes that the makespan is told for.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub nodes: u16,
    /// Cores of a node [default: those of this machine, or of a task where that has more].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub node_cores: Option<u16>,
    /// Memory of a node in megabytes [default: enough].
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

/// Flags of what reads a directory of shards.
#[derive(Debug, Args)]
pub struct ShardsArguments {
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// The plan, by the beginning of its digest, where the directory holds several.
    #[arg(long, value_name = "DIGEST")]
    pub plan: Option<String>,
}

/// Flags of the simulation.
#[derive(Debug, Args)]
pub struct MakespanArguments {
    /// Directory with a few surfaces of the study, whose times are replayed for the others.
    #[arg(long, value_name = "DIR")]
    pub measured: PathBuf,
    /// Numbers of cores, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "100,1000,10000,100000", value_parser = number)]
    pub cores: Vec<usize>,
    /// Cores of each task.
    #[arg(long, value_name = "N", default_value = "1", value_parser = number)]
    pub cores_of_task: usize,
    /// How much faster than one core they solve.
    #[arg(long, default_value_t = 1.0)]
    pub speed_up: f64,
    /// Seconds until a task has begun its first job.
    #[arg(long, default_value_t = 2.0)]
    pub start: f64,
    /// Share of the cores that are slow.
    #[arg(long, default_value_t = 0.05)]
    pub slow_share: f64,
    /// How much longer those take.
    #[arg(long, default_value_t = 1.5)]
    pub slowness: f64,
    /// Failures of a core in an hour: its task is queued again.
    #[arg(long, default_value_t = 1e-3)]
    pub failures: f64,
    /// Operations a second that the file system does for all.
    #[arg(long, default_value_t = 1e4)]
    pub operations: f64,
    /// Seconds that the merge takes for each result.
    #[arg(long, default_value_t = 6e-4)]
    pub merge: f64,
    /// Of what is drawn.
    #[arg(long, default_value_t = evaluation::SEED)]
    pub seed: u64,
    /// Table of the simulation [default: none, it is only printed].
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// The command, such as reproduce-fig2 --preset extended --surfaces 60.
    #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true)]
    pub command: Vec<String>,
}

fn number(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number) if (1..=10_000_000).contains(&number) => Ok(number),
        _ => Err("expected a whole number from 1 to 10000000".into()),
    }
}
