//! The grid study: the same surfaces on several grids, for the limit of small cells.

use super::grid_job::{GridJob, SurfaceOnGrid};
use super::grid_means::{self, SolvedGrids};
use super::grid_picture::{self, GRIDS};
use super::study::{PartialSlipStudy, SHARES};
use super::{grid_tables, grid_tests};
use crate::evaluation::{Outcome, Session, header, list};
use crate::judged::Judged;
use bem3d::Bem3d;
use contact_model::{ContactModel as _, never};
use runs::{
    Job, JobRun, Progress, Result, Threads, collect, files, run_stored, threads_for_memory, write_csv,
};
use std::sync::Arc;

/// Solves the surfaces on all grids and writes `partial-slip-grids.csv`, `partial-slip-grid-tests.csv`,
/// `partial-slip-grid-samples.csv`, a picture and `partial-slip-grids.md`.
pub(super) fn grids(study: &PartialSlipStudy, progress: &dyn Progress) -> Result<Judged> {
    let session = Session::open(&study.out, study.fresh)?;
    let shared = Arc::new(study.clone());
    let mut jobs = Vec::new();
    for &fractal_dimension in &study.fractal_dimensions {
        for i in 0..study.surfaces {
            let seed = surface_gen::surface_seed(study.seed, i as u64);
            for &cells in &study.grids {
                jobs.push(GridJob { study: Arc::clone(&shared), fractal_dimension, seed, cells });
            }
        }
    }
    let memory = jobs.iter().map(Job::memory).fold(0.0, f64::max);
    let finest = study.grids.last().copied().unwrap_or_default();
    let in_flight = threads_for_memory(study.threads, memory, "grids", finest)?;
    let threads = Threads { total: study.threads, jobs: in_flight };
    let what = format!("{} surfaces on {} grids", jobs.len() / study.grids.len(), study.grids.len());
    let run = JobRun { store: &session.store, threads, progress, stop: &never };
    let surfaces: Vec<SurfaceOnGrid> = collect(run_stored(&what, &jobs, run))?;
    let solved: Vec<SolvedGrids<'_>> = (study.fractal_dimensions.iter())
        .zip(surfaces.chunks(study.surfaces * study.grids.len()))
        .map(|(d, surfaces)| SolvedGrids { fractal_dimension: *d, surfaces, grids: study.grids.len() })
        .collect();

    let mut outcome = Outcome::new("partial-slip-grids");
    outcome.not_converged = surfaces.iter().flat_map(|s| &s.loads).filter(|load| load.is_none()).count();
    let (rows, tests) = (grid_means::rows(study, &solved), grid_tests::tests(study, &solved));
    let header = header(study.command())
        .with_sources(Bem3d::default().sources())
        .with_note(format!("Q/(mu F): {}", list(&SHARES)))
        .with_note(format!(
            "bodies alike, free boundaries, fractal to the side; shortest waves of 1/{} of the side on every grid; without Poisson's ratio from normal contacts under F - Q/mu, otherwise means of a force along x and one along y",
            study.shortest()
        ));
    let tables = [
        (GRIDS, grid_tables::rows(&rows)?),
        ("partial-slip-grid-tests.csv", grid_tables::tests(&tests)?),
        ("partial-slip-grid-samples.csv", grid_tables::samples(study, &solved)?),
    ];
    for (name, table) in tables {
        let path = study.out.join(name);
        write_csv(&path, &table, &header)?;
        outcome.files.push(path);
    }
    outcome.files.extend(grid_picture::draw(&study.out)?);
    let text = study.out.join("partial-slip-grids.md");
    files::write_whole(&text, grid_tables::text(study, &rows, &tests).as_bytes())?;
    outcome.files.push(text);
    session.close(outcome).map(Judged::from)
}

#[cfg(test)]
mod tests {
    use super::super::study::{PartialSlipSizes, SlipCase};
    use super::super::{PartialSlipStudy, partial_slip};
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::{Boundary, Outputs};
    use runs::{CsvFile, Silent, Store};
    use std::f64::consts::TAU;
    use std::path::Path;

    fn small(out: &Path) -> PartialSlipStudy {
        let quick = PartialSlipStudy::new(PartialSlipSizes::Quick).unwrap();
        PartialSlipStudy {
            grids: vec![32, 64, 128],
            fractal_dimensions: vec![2.2, 2.8],
            poissons: vec![0.0, 0.3],
            surfaces: 2,
            out: out.into(),
            ..quick
        }
    }

    /// Fourier coefficients of all waves of the spectrum agree, and there are no others: the sum of their
    /// squares is the mean square.
    #[test]
    fn a_surface_is_the_same_function_on_every_grid() {
        let study = small(Path::new("never-made"));
        let case = SlipCase { boundary: Boundary::Free, fractal_dimension: 2.8 };
        let scene = case.scene(&study, 0.0, Outputs::default()).unwrap();
        let waves = study.shortest() as isize;
        let coefficients = |cells: usize| {
            let map = surface_gen::height_map(&scene.surface, cells, 5).unwrap();
            let mut all = Vec::new();
            let at = |i: usize| (i as f64 + 0.5) / cells as f64;
            for (p, q) in (-waves..=waves).flat_map(|p| (0..=waves).map(move |q| (p, q))) {
                let (mut re, mut im) = (0.0, 0.0);
                for (i, h) in map.heights().iter().enumerate() {
                    let phase = TAU * (p as f64 * at(i % cells) + q as f64 * at(i / cells));
                    (re, im) = (re + h * phase.cos(), im + h * phase.sin());
                }
                all.push([re, im].map(|sum| sum / (cells * cells) as f64));
            }
            (all, surface_gen::rms_height(map.heights()))
        };
        let (coarse, rms) = coefficients(study.grids[0]);
        let (fine, rms_fine) = coefficients(study.grids[1]);
        for (a, b) in coarse.iter().flatten().zip(fine.iter().flatten()) {
            assert_relative_eq!(a, b, epsilon = 1e-12);
        }
        assert_relative_eq!(rms, rms_fine, max_relative = 1e-12);
        // Waves with q > 0 stand for those with q < 0 too.
        let twice = |n: usize| if n.is_multiple_of(waves as usize + 1) { 1.0 } else { 2.0 };
        let squares = fine.iter().enumerate().map(|(n, [re, im])| twice(n) * (re * re + im * im));
        assert_relative_eq!(squares.sum::<f64>(), rms * rms, max_relative = 1e-9);
    }

    #[test]
    fn tables_and_pictures_are_written_and_stored_results_are_used() {
        let dir = tempfile::tempdir().unwrap();
        let study = small(dir.path());
        let outcome = partial_slip(&study, &Silent).unwrap();
        assert!(outcome.files.iter().all(|f| f.exists()) && outcome.not_converged == 0);
        let table = CsvFile::read(&dir.path().join(GRIDS)).unwrap();
        // Two fractal dimensions, without Poisson's ratio on three grids and with it on two, and in the limit.
        assert_eq!(table.numbers("stick").unwrap().len(), 2 * (4 + 3) * SHARES.len());
        let samples = CsvFile::read(&dir.path().join("partial-slip-grid-samples.csv")).unwrap();
        assert_eq!(samples.numbers("contact_cells").unwrap().len(), 2 * 2 * (3 + 2));
        let jobs = Store::count(dir.path());
        assert_eq!(jobs, 2 * 2 * 3);
        partial_slip(&study, &Silent).unwrap();
        assert_eq!(Store::count(dir.path()), jobs);
    }

    /// Friction cell by cell without Poisson's ratio is the difference of normal contacts: the share that sticks
    /// and the stiffness of this study are those of the other one.
    #[test]
    fn shares_from_normal_contacts_are_those_of_friction() {
        use super::super::job::SlipJob;
        let study = Arc::new(PartialSlipStudy { tolerance: 1e-8, ..small(Path::new("never-made")) });
        let (fractal_dimension, cells) = (2.2, study.cells);
        let case = SlipCase { boundary: Boundary::Free, fractal_dimension };
        let solved = SlipJob { study: Arc::clone(&study), case, seed: 5 }.solve(&never).unwrap();
        let on_grid = GridJob { study: Arc::clone(&study), fractal_dimension, seed: 5, cells };
        let on_grid = on_grid.solve(&never).unwrap();
        let load = on_grid.loads[0].as_ref().unwrap();
        for (loading, poisson) in load.loadings.iter().zip(0..) {
            let points = &solved.at(&study, 0, poisson).unwrap().points;
            assert_eq!(points.len(), loading.stick.len());
            for (point, stick) in points.iter().zip(&loading.stick) {
                // A cell at the edge of the stick area may count on either side.
                assert!((point.stick - stick).abs() < 0.05, "{} {stick}", point.stick);
            }
            for (point, stiffness) in points.iter().zip(&loading.stiffness) {
                assert!((point.stiffness.unwrap() - stiffness).abs() < 0.05, "{point:?} {stiffness}");
            }
        }
    }
}
