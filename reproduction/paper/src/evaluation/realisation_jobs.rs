//! Solves realisations in parallel; the results are in order.

use crate::evaluation::realisation::{Realisation, RealisationResult, of_scene, realisation_jobs};
use fractal_contact::scenes::{SceneJob, solve_jobs};
use runs::{Job as _, Progress, Result, Store};
use std::path::Path;

/// Where the results of realisations are kept, and how many threads solve them.
#[derive(Debug, Clone, Copy)]
pub struct Workplace<'a> {
    /// The directory of the results.
    pub out: &'a Path,
    /// Its result store.
    pub store: &'a Store,
    /// Number of threads.
    pub threads: usize,
}

/// Solves the realisations that the store does not hold, the largest first, and returns the results in
/// the order of `realisations`. The results do not depend on the number of threads.
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
    place: &Workplace<'_>,
    progress: &dyn Progress,
) -> Result<Vec<RealisationResult>> {
    let jobs = realisation_jobs(realisations, place.out)?;
    let states = solve_jobs(what, &jobs, place.store, place.threads, progress).map_err(of_scene)?;
    realisations.iter().zip(&states).map(|(realisation, states)| realisation.read(states)).collect()
}

/// Whether the store holds all states of a job.
pub fn is_solved(job: &SceneJob, store: &Store) -> bool {
    job.stored(store).is_some()
}
