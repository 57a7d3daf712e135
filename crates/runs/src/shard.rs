//! The part of the jobs that a process does.

use crate::error::{Error, Result};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fmt;
use std::str::FromStr;

/// One of `count` parts of a list of jobs, counted from 0; written `index/count`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Shard {
    /// Index of the shard, from 0.
    pub index: usize,
    /// Number of shards.
    pub count: usize,
}

/// The most shards of one plan.
pub const MOST_SHARDS: usize = 1_000_000;

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let expected = "auto, or i/N with i from 0 to N - 1, such as 0/4";
        let refused = || Error::parameter("shard", text, expected);
        let (index, count) = text.split_once('/').ok_or_else(refused)?;
        let number = |word: &str| word.parse::<usize>().map_err(|_| refused());
        let (index, count) = (number(index)?, number(count)?);
        if count == 0 || count > MOST_SHARDS {
            let expected = format!("i/N with N from 1 to {MOST_SHARDS}");
            return Err(Error::parameter("shard", text, expected));
        }
        if index >= count {
            let expected = format!("i/{count} with i from 0 to {}", count - 1);
            return Err(Error::parameter("shard", text, expected));
        }
        Ok(Self { index, count })
    }
}

/// Value of `--shard`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShardChoice {
    /// This one.
    Given(Shard),
    /// The one that the variables of SLURM or HyperQueue name.
    Auto,
}

impl FromStr for ShardChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "auto" { Ok(Self::Auto) } else { text.parse().map(Self::Given) }
    }
}

/// The environment variable with the number of tasks of an array of HyperQueue, because HyperQueue itself
/// does not provide it.
pub const TASKS: &str = "FRACTAL_CONTACT_TASKS";

impl ShardChoice {
    /// The shard; `variable` returns an environment variable.
    ///
    /// SLURM provides each task of an array with its number, the smallest and the largest number, the step
    /// and the count: `--array=3-11:4` is three shards. In a list with gaps (`--array=3,7`) the position of a
    /// task is unknown, so it is refused. HyperQueue provides the number only; [`TASKS`] must have the number
    /// of tasks, which are counted from 0.
    ///
    /// # Errors
    /// [`Error::Parameter`] where the variables of no engine are set, or contradict each other.
    pub fn resolve(self, variable: &dyn Fn(&str) -> Option<String>) -> Result<Shard> {
        if let Self::Given(shard) = self {
            return Ok(shard);
        }
        let number = |name: &'static str| -> Result<Option<usize>> {
            let Some(value) = variable(name) else { return Ok(None) };
            let refused = |_| Error::parameter(name, &value, "a whole number");
            value.parse().map(Some).map_err(refused)
        };
        let needed = |name: &'static str, with: &str| -> Result<usize> {
            number(name)?
                .ok_or_else(|| Error::parameter(name, "nothing", format!("a whole number beside {with}")))
        };
        if let Some(task) = number("SLURM_ARRAY_TASK_ID")? {
            let [first, last, count] =
                ["SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX", "SLURM_ARRAY_TASK_COUNT"]
                    .map(|name| needed(name, "SLURM_ARRAY_TASK_ID"));
            let (first, last, count) = (first?, last?, count?);
            let step = number("SLURM_ARRAY_TASK_STEP")?.unwrap_or(1).max(1);
            let (after, length) = (task.wrapping_sub(first), last.wrapping_sub(first) / step + 1);
            if task < first || task > last || after % step != 0 || length != count {
                let found = format!("task {task} of {count} from {first} to {last} in steps of {step}");
                return Err(Error::parameter(
                    "SLURM_ARRAY_TASK_ID",
                    found,
                    "an array without gaps; for another one give --shard i/N",
                ));
            }
            return format!("{}/{count}", after / step).parse();
        }
        if let Some(task) = number("HQ_TASK_ID")? {
            let count = needed(
                TASKS,
                "HQ_TASK_ID (submit with --array 0-(N-1) --env FRACTAL_CONTACT_TASKS=N, or give --shard i/N)",
            )?;
            return format!("{task}/{count}").parse();
        }
        Err(Error::parameter(
            "shard",
            "auto",
            "the variables of a SLURM array (SLURM_ARRAY_TASK_ID) or of a HyperQueue task (HQ_TASK_ID)",
        ))
    }
}

/// The numbers of jobs, the most expensive first; equal costs keep their order, so that one of each kind
/// comes early.
pub fn largest_first<C: Ord>(count: usize, cost: impl Fn(usize) -> C) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(cost(i)));
    order
}

/// The shard of each job: the most expensive job first, each to the shard with the least work (Graham's rule:
/// no shard is longer than 4/3 of the best division). It depends on the costs and the count alone.
pub fn assign(costs: &[u64], count: usize) -> Vec<usize> {
    let mut shards: BinaryHeap<Reverse<(u64, usize)>> =
        (0..count.max(1)).map(|shard| Reverse((0, shard))).collect();
    let mut of = vec![0; costs.len()];
    for job in largest_first(costs.len(), |i| costs[i]) {
        if let Some(mut least) = shards.peek_mut() {
            let Reverse((load, shard)) = *least;
            of[job] = shard;
            // A job that costs nothing is still one.
            *least = Reverse((load.saturating_add(costs[job].max(1)), shard));
        }
    }
    of
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn shards_are_written_from_0() {
        assert_eq!("3/4".parse::<Shard>().unwrap(), Shard { index: 3, count: 4 });
        assert_eq!("auto".parse::<ShardChoice>().unwrap(), ShardChoice::Auto);
        for (bad, expected) in [
            ("4/4", "i/4 with i from 0 to 3"),
            ("0/0", "N from 1"),
            ("1", "auto, or i/N"),
            ("-1/4", "auto, or i/N"),
            ("", "auto, or i/N"),
            ("1/2/3", "auto, or i/N"),
            ("0/99999999", "N from 1 to 1000000"),
        ] {
            let refused = bad.parse::<ShardChoice>().unwrap_err().to_string();
            assert!(
                refused.starts_with(&format!("shard = {bad}: expected")) && refused.contains(expected),
                "{refused}"
            );
        }
    }

    #[test]
    fn engines_are_asked_by_their_variables() {
        let auto = |variables: &[(&str, &str)]| {
            let list: Vec<(String, String)> =
                variables.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
            ShardChoice::Auto
                .resolve(&move |name| list.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone()))
        };
        let slurm = |id, min, max, step, count| {
            auto(&[
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", min),
                ("SLURM_ARRAY_TASK_MAX", max),
                ("SLURM_ARRAY_TASK_STEP", step),
                ("SLURM_ARRAY_TASK_COUNT", count),
            ])
        };
        assert_eq!(slurm("2", "0", "3", "1", "4").unwrap(), Shard { index: 2, count: 4 });
        // --array=3-11:4 and --array=1-4.
        assert_eq!(slurm("7", "3", "11", "4", "3").unwrap(), Shard { index: 1, count: 3 });
        assert_eq!(slurm("4", "1", "4", "1", "4").unwrap(), Shard { index: 3, count: 4 });
        // SLURM tells the end of the range as it was written: --array=0-10:4 is 0, 4, 8.
        assert_eq!(slurm("8", "0", "8", "4", "3").unwrap(), Shard { index: 2, count: 3 });
        // --array=3,7: which of them is which is not told.
        let refused = slurm("7", "3", "7", "1", "2").unwrap_err().to_string();
        assert!(refused.contains("task 7 of 2 from 3 to 7") && refused.contains("--shard i/N"), "{refused}");
        assert!(
            slurm("x", "3", "7", "1", "2").unwrap_err().to_string().starts_with("SLURM_ARRAY_TASK_ID = x")
        );
        assert!(slurm("2", "3", "7", "1", "5").is_err());
        let lone = auto(&[("SLURM_ARRAY_TASK_ID", "2")]).unwrap_err().to_string();
        assert!(lone.starts_with("SLURM_ARRAY_TASK_MIN = nothing"), "{lone}");
        assert_eq!(auto(&[("HQ_TASK_ID", "1"), (TASKS, "2")]).unwrap(), Shard { index: 1, count: 2 });
        assert!(auto(&[("HQ_TASK_ID", "1")]).unwrap_err().to_string().starts_with(TASKS));
        assert!(auto(&[]).unwrap_err().to_string().starts_with("shard = auto"));
        // A shard that was given asks nobody.
        let given = ShardChoice::Given(Shard { index: 0, count: 1 });
        assert_eq!(given.resolve(&|_| panic!("asked")).unwrap().count, 1);
    }

    proptest! {
        #[test]
        fn every_job_has_one_shard_and_none_has_much_more_than_another(
            costs in proptest::collection::vec(0_u64..1000, 0..200),
            count in 1_usize..40,
        ) {
            let of = assign(&costs, count);
            prop_assert_eq!(of.len(), costs.len());
            let mut loads = vec![0; count];
            for (job, &shard) in of.iter().enumerate() {
                loads[shard] += costs[job].max(1);
            }
            let (least, most) = (loads.iter().min().unwrap(), loads.iter().max().unwrap());
            prop_assert!(most - least <= costs.iter().copied().max().unwrap_or(0).max(1));
            prop_assert_eq!(of, assign(&costs, count));
        }
    }

    #[test]
    fn more_shards_than_jobs_leave_some_empty() {
        assert_eq!(assign(&[5, 1, 3], 4), [0, 2, 1]);
        assert_eq!(assign(&[], 4), [0_usize; 0]);
    }
}
