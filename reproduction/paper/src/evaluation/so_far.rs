//! The results of an ensemble that is still being solved.

use crate::evaluation::realisation::{Realisation, RealisationResult};
use crate::evaluation::run::Run;
use runs::Result;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two calls, and before the first.
const EVERY: Duration = Duration::from_secs(5);

/// Number of surfaces on the finest grid from which on they are shown instead of the coarse ones.
const FEWEST: usize = 3;

/// Receives the jobs of a whole ensemble and their results.
type Show<'a> = dyn Fn(Vec<Realisation>, Vec<RealisationResult>) -> Result<()> + Sync + 'a;

/// Collects results and shows whole ensembles of them now and then.
pub(crate) struct SoFar<'a> {
    /// Jobs of each grid, the finest first.
    ensembles: &'a [Vec<Realisation>],
    run: &'a Run,
    show: &'a Show<'a>,
    found: Mutex<FoundSoFar>,
}

struct FoundSoFar {
    /// Results of each grid, in the order of the jobs.
    results: Vec<Vec<Option<RealisationResult>>>,
    last: Instant,
    /// What was shown last: a grid and the number of its surfaces.
    shown: Option<(usize, usize)>,
}

impl<'a> SoFar<'a> {
    pub fn new(ensembles: &'a [Vec<Realisation>], run: &'a Run, show: &'a Show<'a>) -> Self {
        let results = ensembles.iter().map(|jobs| vec![None; jobs.len()]).collect();
        Self {
            ensembles,
            run,
            show,
            found: Mutex::new(FoundSoFar { results, last: Instant::now(), shown: None }),
        }
    }

    /// Takes the result of a job; the jobs are numbered from the coarsest grid on.
    ///
    /// # Errors
    /// Errors of the function that shows the results.
    pub fn add(&self, job: usize, result: &RealisationResult) -> Result<()> {
        let Some((jobs, results)) = self.next(job, result) else { return Ok(()) };
        (self.show)(jobs, results)
    }

    /// Takes a result. Returns the jobs and results that should be shown now.
    fn next(
        &self,
        job: usize,
        result: &RealisationResult,
    ) -> Option<(Vec<Realisation>, Vec<RealisationResult>)> {
        // A poisoned lock means that another thread panicked while it only wrote results.
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        let mut place = job;
        let of_job = found.results.iter_mut().rev().find_map(|results| {
            if place >= results.len() {
                place -= results.len();
                return None;
            }
            results.get_mut(place)
        });
        *of_job? = Some(result.clone());
        if found.last.elapsed() < EVERY {
            return None;
        }
        let best = self.best(&found.results)?;
        if found.shown == Some(best) {
            return None;
        }
        (found.last, found.shown) = (Instant::now(), Some(best));
        let (grid, surfaces) = best;
        let count = surfaces * self.run.dimensions().len();
        let results: Option<Vec<_>> = found.results[grid][..count].iter().cloned().collect();
        Some((self.ensembles[grid][..count].to_vec(), results?))
    }

    /// The finest grid that can be shown, with the number of its first surfaces that are complete. `None`
    /// where there is nothing yet, or nothing is missing.
    fn best(&self, results: &[Vec<Option<RealisationResult>>]) -> Option<(usize, usize)> {
        let dimensions = self.run.dimensions().len().max(1);
        (0..results.len())
            .find_map(|grid| {
                let of_surface = results[grid].chunks(dimensions);
                let (all, whole) =
                    (of_surface.len(), of_surface.take_while(|s| s.iter().all(Option::is_some)).count());
                let fewest = if grid == 0 { FEWEST } else { all };
                (whole >= fewest && whole > 0).then_some((grid, whole))
            })
            // All of it is no news: its own figure follows.
            .filter(|&(grid, whole)| grid > 0 || whole * dimensions < results[0].len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::measured::realisations;
    use crate::evaluation::realisation::EnsembleModel;
    use crate::evaluation::run::{Preset, Request};
    use crate::evaluation::sample::tests::sample;

    #[test]
    fn coarse_grids_count_when_they_are_whole_and_the_finest_from_three_surfaces_on() {
        let request =
            Request { preset: Preset::Quick, fractal_dimensions: Some(vec![2.0, 2.6]), ..Request::default() };
        let run = Run::new(&request).unwrap().with_sizes(EnsembleModel::Bem3d, 129, 5);
        let so_far = SoFar::new(&[], &run, &|_, _| Ok(()));
        let result =
            RealisationResult { rms_height: 1.0, seconds: 0.0, samples: vec![sample(0.1), sample(1.0)] };
        let of = |counts: [usize; 3]| {
            let some = |n: usize| (0..10).map(|i| (i < n).then(|| result.clone())).collect::<Vec<_>>();
            so_far.best(&counts.map(some))
        };
        assert_eq!(of([0, 0, 9]), None);
        assert_eq!(of([0, 0, 10]), Some((2, 5)));
        assert_eq!(of([5, 9, 10]), Some((2, 5)));
        assert_eq!(of([5, 10, 10]), Some((1, 5)));
        // Three whole surfaces of two fractal dimensions, the fourth half.
        assert_eq!(of([7, 10, 10]), Some((0, 3)));
        // The figure itself follows.
        assert_eq!(of([10, 10, 10]), None);
    }

    #[test]
    fn results_go_to_their_places() {
        let request = Request { preset: Preset::Quick, ..Request::default() };
        let run = Run::new(&request).unwrap();
        let ensembles: Vec<Vec<Realisation>> = [2, 3]
            .map(|surfaces| {
                let run = run.with_sizes(EnsembleModel::Bem3d, 9, surfaces);
                realisations(run.ensemble(EnsembleModel::Bem3d).0, surfaces, &run)
            })
            .into();
        let so_far = SoFar::new(&ensembles, &run, &|_, _| Ok(()));
        let result = RealisationResult { rms_height: 1.0, seconds: 0.0, samples: Vec::new() };
        let (coarse, fine) = (ensembles[1].len(), ensembles[0].len());
        for job in [1, coarse + 2, coarse + fine] {
            so_far.add(job, &result).unwrap();
        }
        let found = so_far.found.lock().unwrap();
        let places = |grid: usize| -> Vec<usize> {
            (0..found.results[grid].len()).filter(|&i| found.results[grid][i].is_some()).collect()
        };
        assert_eq!((places(0), places(1)), (vec![2], vec![1]));
    }
}
