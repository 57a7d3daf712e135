//! How large the numbers of a command may be: what costs more than any machine has is refused by name before
//! memory is asked for.

use runs::{Error, Result};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// Cells a side of a surface: a map of 65536 x 65536 heights takes 34 GB by itself, and what fits is asked of
/// the memory.
pub const CELLS: RangeInclusive<usize> = 3..=1 << 16;
/// Elements of a line: 2^30 take 8 GB for the heights alone.
pub const ELEMENTS: RangeInclusive<usize> = 3..=1 << 30;
/// Surfaces, lines or cases of a study.
pub const COUNT: RangeInclusive<usize> = 1..=100_000;
/// Jobs of a command: each is held in memory with its loads and has a result in the store.
pub const MOST_JOBS: usize = 1_000_000;
/// Loads of a command.
pub const MOST_LOADS: usize = 10_000;

/// A number inside a range.
///
/// # Errors
/// [`Error::Parameter`] with its name, the number and both ends.
pub fn within<T: PartialOrd + Display>(name: &'static str, value: T, range: &RangeInclusive<T>) -> Result<T> {
    if range.contains(&value) {
        return Ok(value);
    }
    Err(Error::parameter(name, value, format!("a whole number from {} to {}", range.start(), range.end())))
}

/// So many jobs in all, of `count` surfaces, lines or cases.
///
/// # Errors
/// [`Error::Parameter`] beyond [`MOST_JOBS`].
pub fn jobs(name: &'static str, count: usize, of_each: usize) -> Result<()> {
    match count.checked_mul(of_each) {
        Some(jobs) if jobs <= MOST_JOBS => Ok(()),
        _ => {
            let most = MOST_JOBS / of_each.max(1);
            let expected = format!("at most {most}, {MOST_JOBS} jobs of {of_each} for each");
            Err(Error::parameter(name, count, expected))
        }
    }
}
