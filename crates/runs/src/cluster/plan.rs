//! The command to which the shards of a directory belong.

use super::words::quoted;
use crate::error::{Error, Result};
use crate::files;
use crate::jobs::JobList;
use crate::store::fnv1a_128;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A sharded command: `DIR/.units/plans/DIGEST.json`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardPlan {
    /// The arguments of the program, without the directory, the shard and the threads.
    pub arguments: Vec<String>,
    /// Hash of the keys of all jobs in their order: two commands with the same jobs have the same plan.
    pub digest: String,
    /// Number of jobs.
    pub jobs: usize,
    /// Name of the program.
    pub program: String,
}

impl ShardPlan {
    /// The plan of a list of jobs.
    pub fn new(program: &str, arguments: Vec<String>, jobs: &dyn JobList) -> Self {
        let hash = |job| fnv1a_128(jobs.key(job).as_bytes()).to_be_bytes();
        let hashes: Vec<[u8; 16]> = (0..jobs.count()).into_par_iter().map(hash).collect();
        let digest = format!("{:032x}", fnv1a_128(hashes.as_flattened()));
        Self { digest, program: program.to_owned(), arguments, jobs: jobs.count() }
    }

    /// The command as it was typed.
    pub fn command(&self) -> String {
        let words: Vec<String> = self.arguments.iter().map(|word| quoted(word)).collect();
        format!("{} {}", self.program, words.join(" "))
    }

    /// The beginning of the digest, for people.
    pub fn short_digest(&self) -> String {
        self.digest.chars().take(12).collect()
    }

    /// Folder of the plans of a directory.
    pub(super) fn directory(out: &Path) -> PathBuf {
        out.join(".units/plans")
    }

    /// Writes the plan unless another shard has written it. Where several commands have the same jobs, the
    /// plan records the last one.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be written.
    pub fn write(&self, out: &Path) -> Result<()> {
        let directory = Self::directory(out);
        files::create_directory(&directory)?;
        let path = directory.join(format!("{}.json", self.digest));
        if Self::read(&path).as_ref() == Some(self) {
            return Ok(());
        }
        // A pipe would wait for its other end.
        if path.symlink_metadata().is_ok_and(|about| !about.is_file()) {
            return Err(Error::content(&path, "not a regular file: remove it"));
        }
        let text = serde_json::to_string_pretty(self).map_err(|e| Error::content(&path, e.to_string()))?;
        Ok(files::write_whole(&path, (text + "\n").as_bytes())?)
    }

    fn read(path: &Path) -> Option<Self> {
        serde_json::from_slice(&files::read(path, 1 << 24).ok()?).ok()
    }

    /// All plans of a directory, by digest.
    pub fn all(out: &Path) -> Vec<Self> {
        let entries = std::fs::read_dir(Self::directory(out)).into_iter().flatten().flatten();
        let mut plans: Vec<Self> = entries.filter_map(|entry| Self::read(&entry.path())).collect();
        plans.sort_by(|a, b| a.digest.cmp(&b.digest));
        plans
    }

    /// The one plan of a directory, or the one that was chosen by the beginning of its digest.
    ///
    /// # Errors
    /// [`Error::Parameter`] where there is none, where there are several, with their commands, and for one of
    /// another program.
    pub fn only(out: &Path, program: &str, chosen: Option<&str>) -> Result<Self> {
        let mut plans = Self::all(out);
        let list = |plans: &[Self]| {
            let line = |p: &Self| format!("\n  {}  {}", p.short_digest(), p.command());
            plans.iter().map(line).collect::<Vec<_>>().concat()
        };
        if let Some(chosen) = chosen {
            let there = list(&plans);
            plans.retain(|plan| plan.digest.starts_with(chosen));
            if plans.len() != 1 {
                let expected = format!("the beginning of the digest of one plan; there are:{there}");
                return Err(Error::parameter("plan", chosen, expected));
            }
        }
        match plans.len() {
            0 => {
                let expected = "a directory in which shards were run (--shard or submit); where its plan was lost or damaged, run one of them again";
                Err(Error::parameter("out", out.display(), expected))
            }
            1 => {
                let plan = plans.remove(0);
                if plan.program == program {
                    return Ok(plan);
                }
                let expected = format!("shards of {program}; these are of: {}", plan.command());
                Err(Error::parameter("out", out.display(), expected))
            }
            several => {
                let expected = format!(
                    "the shards of one plan, and there are {several}. If the command or its scene was changed between shards, run all of them \
                     again into another directory; to take one plan as it is, choose it with --plan:{}",
                    list(&plans)
                );
                Err(Error::parameter("out", out.display(), expected))
            }
        }
    }
}

/// Arguments without these flags: `with_value` are followed by a value, `alone` are not.
pub fn without_flags(arguments: &[String], with_value: &[&str], alone: &[&str]) -> Vec<String> {
    let mut kept = Vec::with_capacity(arguments.len());
    let mut rest = arguments.iter();
    while let Some(word) = rest.next() {
        let Some(flag) = word.strip_prefix("--") else {
            kept.push(word.clone());
            continue;
        };
        let name = flag.split('=').next().unwrap_or(flag);
        if alone.contains(&name) {
            continue;
        }
        if with_value.contains(&name) {
            if !flag.contains('=') {
                rest.next();
            }
            continue;
        }
        kept.push(word.clone());
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cluster::tests_support::Squares;

    fn words(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn flags_are_left_out_with_their_values() {
        let arguments = words("reproduce-fig2 --out a b --shard=0/4 --fresh --cells 9 --threads 2");
        let left = without_flags(&arguments, &["out", "shard", "threads"], &["fresh"]);
        assert_eq!(left, words("reproduce-fig2 b --cells 9"));
    }

    #[test]
    fn one_plan_is_found_and_several_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let none = ShardPlan::only(dir.path(), "p", None).unwrap_err().to_string();
        assert!(none.contains("a directory in which shards were run"), "{none}");
        let plan = ShardPlan::new("p", words("squares --to 3"), &Squares::to(3));
        plan.write(dir.path()).unwrap();
        plan.write(dir.path()).unwrap();
        assert_eq!(ShardPlan::only(dir.path(), "p", None).unwrap(), plan);
        let foreign = ShardPlan::only(dir.path(), "q", None).unwrap_err().to_string();
        assert!(foreign.contains("shards of q; these are of: p squares --to 3"), "{foreign}");
        let other = ShardPlan::new("p", words("squares --to 4"), &Squares::to(4));
        assert_ne!(plan.digest, other.digest);
        other.write(dir.path()).unwrap();
        let mixed = ShardPlan::only(dir.path(), "p", None).unwrap_err().to_string();
        assert!(
            mixed.contains("there are 2") && mixed.contains("p squares --to 3") && mixed.contains("--plan"),
            "{mixed}"
        );
        assert_eq!(ShardPlan::only(dir.path(), "p", Some(&plan.digest[..8])).unwrap(), plan);
        assert!(
            ShardPlan::only(dir.path(), "p", Some("zz")).unwrap_err().to_string().starts_with("plan = zz")
        );
    }
}
