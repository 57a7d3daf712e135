//! Repeats some stored solves from a cold start and to a tight tolerance.

use crate::evaluation::header::{flags, header};
use crate::evaluation::limits::require;
use crate::evaluation::measured::measure;
use crate::evaluation::outcome::Outcome;
use crate::evaluation::realisation::{
    Discretisation, EnsembleModel, Realisation, RealisationResult, solve_alone,
};
use crate::evaluation::run::Run;
use crate::evaluation::session::Session;
use crate::evaluation::table_of::TableOf;
use crate::evaluation::tables::{FORCE_BAR, FRACTAL_DIMENSION};
use contact_model::Table;
use contact_model::{Stop, never};
use runs::{Progress, Result, Threads, collect, run_jobs, write_csv};

/// One solve and its repetition to a tight tolerance.
struct SolvePair {
    fractal_dimension: f64,
    index: usize,
    force_bar: f64,
    /// k_bar as stored and from the tight solve.
    stiffness_bar: [f64; 2],
    /// Error of k as stored.
    claimed: f64,
}

impl SolvePair {
    fn difference(&self) -> f64 {
        (self.stiffness_bar[0] / self.stiffness_bar[1] - 1.0).abs()
    }
}

/// Solves a random share of the 3D ensemble of a run again, each from a cold start to the given tolerance,
/// and writes `audit.csv`.
///
/// The choice of the solves depends only on the master seed. Returns the outcome and one line with the
/// differences between the stored k and the tight ones.
///
/// # Errors
/// [`runs::Error::Parameter`] for a share outside (0, 1] or a tolerance that is not tighter than the run's;
/// errors of the solver.
pub fn audit(run: &Run, share: f64, tolerance: f64, progress: &dyn Progress) -> Result<(Outcome, String)> {
    require(share > 0.0 && share <= 1.0, "share", share, "a number above 0, at most 1")?;
    let expected = format!("a number from 1e-12 to below the run's {:?}", run.tolerance);
    require((1e-12..run.tolerance).contains(&tolerance), "audit-tolerance", tolerance, expected)?;
    let session = Session::open(&run.out, run.fresh)?;
    let measured = measure(EnsembleModel::Bem3d, run, &session.store, progress)?;
    let realisations: Vec<&(Realisation, RealisationResult)> =
        measured.series.iter().flat_map(|s| &s.realisations).collect();
    let loads = measured.force_bar().len();
    let wanted = ((share * (realisations.len() * loads) as f64).ceil() as usize).max(1);
    // The smallest hashes: a sample without replacement that does not depend on any order.
    let mut all: Vec<(u64, usize, usize)> = (0..realisations.len())
        .flat_map(|u| (0..loads).map(move |j| (u, j)))
        .map(|(u, j)| (surface_gen::surface_seed(run.seed ^ 0xa0d1, (u * loads + j) as u64), u, j))
        .collect();
    all.sort_unstable();
    all.truncate(wanted);
    progress.begin(&format!("{wanted} solves again, to {tolerance:?}"), wanted as u64);
    let order: Vec<usize> = (0..all.len()).collect();
    let done = run_jobs(Threads::all(run.threads), &order, &never, |i, stop| {
        let (_, u, j) = all[i];
        let pair = again(realisations[u], j, tolerance, stop)?;
        progress.advance(1, false);
        Ok(pair)
    });
    progress.end();
    let pairs: Vec<SolvePair> = collect(done)?.into_iter().flatten().collect();
    let largest = pairs.iter().map(SolvePair::difference).fold(0.0, f64::max);
    let inside = pairs.iter().filter(|p| p.difference() <= p.claimed + tolerance).count();
    let summary = format!(
        "{} solves again to {tolerance:?}: largest relative difference of k {largest:.1e}, {inside} within their own claim",
        pairs.len()
    );
    let mut outcome = Outcome::new("audit");
    let path = run.out.join("audit.csv");
    let header = header(format!(
        "{} --share {share} --audit-tolerance {tolerance}",
        run.command("audit", flags(EnsembleModel::Bem3d))
    ))
    .with_note(summary.clone());
    write_csv(&path, &table(&pairs)?, &header)?;
    outcome.files.push(path);
    Ok((session.close(outcome)?, summary))
}

/// Solves one load of one surface from a cold start. `None` where the stored or the tight solve has no
/// stiffness to compare.
fn again(
    (realisation, result): &(Realisation, RealisationResult),
    load: usize,
    tolerance: f64,
    stop: Stop<'_>,
) -> Result<Option<SolvePair>> {
    let stored = &result.samples[load];
    let (d, seed) = (realisation.fractal_dimension, realisation.seed());
    let grid = Discretisation::Bem3d { cells: realisation.discretisation.size(), tolerance };
    let tight = solve_alone(grid, d, seed, stored.force_bar, stop)?;
    let tight = tight.stiffness_bar.filter(|_| tight.converged());
    Ok(stored.stiffness_bar.zip(tight).filter(|_| stored.converged()).map(|(a, b)| SolvePair {
        fractal_dimension: realisation.fractal_dimension,
        index: realisation.index,
        force_bar: stored.force_bar,
        stiffness_bar: [a, b],
        claimed: stored.certificate.stiffness_error.unwrap_or(0.0),
    }))
}

fn table(pairs: &[SolvePair]) -> Result<Table> {
    TableOf::new("Stored stiffnesses beside tight solves", pairs)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |p| p.fractal_dimension)
        .column("surface", "1", "number of the surface in its ensemble", |p| p.index)
        .column("force_bar", "1", FORCE_BAR, |p| p.force_bar)
        .column("stiffness_bar", "1", "k/(1.1419 E* L) as in fig2-samples.csv (Eq. 8)", |p| {
            p.stiffness_bar[0]
        })
        .column("stiffness_bar_tight", "1", "the same from nothing to the tight tolerance", |p| {
            p.stiffness_bar[1]
        })
        .column("relative_difference", "1", "of the two", SolvePair::difference)
        .column("claimed_error", "1", "estimated relative error of the first", |p| p.claimed)
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::{Preset, Request};
    use runs::{CsvFile, Silent};

    #[test]
    fn loose_solves_are_within_their_claimed_errors() {
        let dir = tempfile::tempdir().unwrap();
        let request = Request {
            preset: Preset::Quick,
            cells: Some(65),
            surfaces: Some(2),
            fractal_dimensions: Some(vec![2.2, 2.8]),
            forces: Some("1e-2:20:5".into()),
            tolerance: Some(1e-3),
            out: Some(dir.path().to_owned()),
            ..Request::default()
        };
        let run = Run::new(&request).unwrap();
        let (outcome, summary) = audit(&run, 0.5, 1e-9, &Silent).unwrap();
        assert!(summary.starts_with("10 solves again"), "{summary}");
        let file = CsvFile::read(&outcome.files[0]).unwrap();
        for difference in file.numbers("relative_difference").unwrap().into_iter().flatten() {
            assert!(difference < 1e-3, "{difference}");
        }
        assert!(audit(&run, 0.0, 1e-9, &Silent).is_err());
        assert!(audit(&run, 0.1, 1e-2, &Silent).is_err());
    }
}
