//! Solves realisations in parallel; the results are in order.

use crate::evaluation::realisation::{Realisation, RealisationResult, of_scene, realisation_jobs};
use fractal_contact::scenes::{SceneJob, solve_jobs};
use runs::{Job as _, Progress, Result, Store};
use std::path::Path;

/// Solves the realisations that the store of `out` does not hold, the largest first, and returns the results in
/// the order of `realisations`. The results do not depend on `threads`.
///
/// Each finished surface is stored at once, and the states of the surfaces in hand now and then. No more
/// surfaces are solved at the same time than fit in memory; threads without a surface help the others.
///
/// # Errors
/// [`runs::Error::Parameter`] for a size that does not fit in memory; the first error in the order of
/// `realisations`; surfaces that finished before remain stored.
pub fn solve_realisations(
    what: &str,
    realisations: &[Realisation],
    (out, store): (&Path, &Store),
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<RealisationResult>> {
    let jobs = realisation_jobs(realisations, out)?;
    let states = solve_jobs(what, &jobs, store, threads, progress).map_err(of_scene)?;
    realisations.iter().zip(&states).map(|(realisation, states)| realisation.read(states)).collect()
}

/// Whether the store holds all states of a job.
pub fn is_solved(job: &SceneJob, store: &Store) -> bool {
    job.stored(store).is_some()
}
