//! Limits of the sizes of a command: a size that is too large for any machine is refused by name before
//! memory is allocated.

use runs::{Error, Result};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// Cells a side of a surface: a map of 65536 x 65536 heights takes 34 GB by itself, and whether it fits is
/// decided by the memory.
pub const CELLS: RangeInclusive<usize> = 3..=1 << 16;
/// Elements of a line: 2^30 take 8 GB for the heights alone.
pub const ELEMENTS: RangeInclusive<usize> = 3..=1 << 30;
/// Number of surfaces, lines or cases of a study.
pub const COUNT: RangeInclusive<usize> = 1..=100_000;
/// Jobs of a command: each is held in memory with its loads and has a result in the store.
pub const MOST_JOBS: usize = 1_000_000;
/// Loads of a command.
pub const MOST_LOADS: usize = 10_000;

/// Checks a condition on the value of a parameter.
///
/// # Errors
/// [`Error::Parameter`] with its name, the value and what was expected, where it does not hold.
pub fn require(
    holds: bool,
    name: &'static str,
    value: impl Display,
    expected: impl Into<String>,
) -> Result<()> {
    if holds { Ok(()) } else { Err(Error::parameter(name, value, expected)) }
}

/// Checks that a number lies inside a range.
///
/// # Errors
/// [`Error::Parameter`] with its name, the number and both ends.
pub fn within<T: PartialOrd + Display>(name: &'static str, value: T, range: &RangeInclusive<T>) -> Result<T> {
    let expected = format!("a whole number from {} to {}", range.start(), range.end());
    require(range.contains(&value), name, &value, expected)?;
    Ok(value)
}

/// Checks a tolerance of the solver of boundary elements.
///
/// # Errors
/// [`Error::Parameter`] outside 1e-12 to 0.1.
pub fn tolerance(tolerance: f64) -> Result<()> {
    require((1e-12..=0.1).contains(&tolerance), "tolerance", tolerance, "a number from 1e-12 to 0.1")
}

/// Checks the number of jobs, `count` times `of_each`.
///
/// # Errors
/// [`Error::Parameter`] beyond [`MOST_JOBS`].
pub fn jobs(name: &'static str, count: usize, of_each: usize) -> Result<()> {
    let all = count.checked_mul(of_each);
    let expected = format!("at most {}, {MOST_JOBS} jobs of {of_each} for each", MOST_JOBS / of_each.max(1));
    require(all.is_some_and(|all| all <= MOST_JOBS), name, count, expected)
}
