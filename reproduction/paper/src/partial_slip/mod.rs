//! Partial slip of rough surfaces cell by cell, and the errors of approximations by the normal contact.
//!
//! The approximation of Ciavarella and Jaeger takes tractions `mu (p(F) - p(F - Q/mu))` and the displacement
//! `mu (E*/G*) (d(F) - d(F - Q/mu))`. It solves Coulomb's problem where Poisson's ratio is 0
//! (`tests/tests/partial_slip.rs`), and depends on Poisson's ratio through G*/E* alone. So the solution for a
//! Poisson's ratio of 0, in units of its tractions and of `mu (E*/G*) d(F)`, is that approximation for every
//! other ratio, and the difference of the two is its error. `equivalent` is compared in the same units.
//!
//! The study has jobs of its own beside those of scenes, for two reasons. It compares the tractions of bodies with
//! different Poisson's ratios cell by cell, and a stored state has no fields. It follows the stiffness along a
//! branch on which single states miss their tolerance, where a cell begins to slip; the path of a scene ends there.

mod grid_job;
mod grid_means;
mod grid_picture;
mod grid_tables;
mod grid_tests;
mod grids;
mod job;
mod means;
mod picture;
mod report;
mod study;
mod tables;

pub use picture::draw as draw_partial_slip;
pub use study::{PartialSlipSizes, PartialSlipStudy};

use crate::evaluation::{Outcome, Session, header, list};
use crate::judged::Judged;
use bem3d::Bem3d;
use contact_model::{ContactModel as _, never};
pub(crate) use grid_picture::{GRIDS, draw as draw_partial_slip_grids};
use job::SlipJob;
use means::SolvedCase;
pub(crate) use picture::SLIPS;
use picture::{LOOPS, STIFFNESS};
use runs::{
    Job, JobRun, Progress, Result, Threads, collect, files, run_stored, threads_for_memory, write_csv,
};
use std::sync::Arc;
use study::{AMPLITUDES, COEFFICIENT, ROLL_OFF, SHARES, SlipCase};

/// Name of the command, and of the text.
const NAME: &str = "partial-slip";

/// Solves the contacts and writes `partial-slip.csv` (first loading), `partial-slip-stiffness.csv`,
/// `partial-slip-loops.csv`, `partial-slip-samples.csv`, pictures and `partial-slip.md` into the directory of
/// the study. Stored results are not solved again. With a list of grids it solves the same surfaces on each of
/// them instead, and writes `partial-slip-grids.csv` and others.
///
/// # Errors
/// [`runs::Error::Parameter`] for invalid parameters, errors of a model, and files that cannot be written.
pub fn partial_slip(study: &PartialSlipStudy, progress: &dyn Progress) -> Result<Judged> {
    study.check()?;
    if !study.grids.is_empty() {
        return grids::grids(study, progress);
    }
    let session = Session::open(&study.out, study.fresh)?;
    let shared = Arc::new(study.clone());
    let seeds = || (0..study.surfaces).map(|i| surface_gen::surface_seed(study.seed, i as u64));
    let of = |case| seeds().map(move |seed| (case, seed));
    let all = study.cases().into_iter().flat_map(of);
    let jobs: Vec<SlipJob> =
        all.map(|(case, seed)| SlipJob { study: Arc::clone(&shared), case, seed }).collect();
    let memory = jobs.iter().map(Job::memory).fold(0.0, f64::max);
    let in_flight = threads_for_memory(study.threads, memory, "cells", study.cells)?;
    let threads = Threads { total: study.threads, jobs: in_flight };
    let what = format!("{} surfaces of {} cells a side", jobs.len(), study.cells);
    let run = JobRun { store: &session.store, threads, progress, stop: &never };
    let surfaces = collect(run_stored(&what, &jobs, run))?;
    let solved: Vec<SolvedCase<'_>> = (study.cases().into_iter())
        .zip(surfaces.chunks(study.surfaces))
        .map(|(case, surfaces)| SolvedCase { case, surfaces })
        .collect();

    let mut outcome = Outcome::new(NAME);
    outcome.not_converged = surfaces.iter().flat_map(|s| &s.solved).filter(|s| s.is_none()).count();
    let (stiffness, slips, loops) =
        (means::stiffness(study, &solved), means::slips(study, &solved), means::loops(study, &solved));
    let header = header(study.command())
        .with_sources(Bem3d::default().sources())
        .with_note(format!("Q/(mu F): {} (first loading), {} (loops)", list(&SHARES), list(&AMPLITUDES)))
        .with_note(format!(
            "bodies alike, coefficient of friction {COEFFICIENT}; shortest waves of {} cells; periodic surfaces roll off at {ROLL_OFF} waves a side, free ones are fractal to the side",
            study.cells_per_wave
        ));
    let tables = [
        (STIFFNESS, tables::stiffness(&stiffness)?),
        (SLIPS, tables::slips(&slips)?),
        (LOOPS, tables::loops(&loops)?),
        ("partial-slip-samples.csv", tables::samples(study, &solved)?),
    ];
    for (name, table) in tables {
        let path = study.out.join(name);
        write_csv(&path, &table, &header)?;
        outcome.files.push(path);
    }
    outcome.files.extend(picture::draw(&study.out)?);
    let text = study.out.join(format!("{NAME}.md"));
    files::write_whole(&text, report::text(study, &stiffness, &slips, &loops).as_bytes())?;
    outcome.files.push(text);
    session.close(outcome).map(Judged::from)
}

#[cfg(test)]
mod tests {
    use super::study::SurfaceSlips;
    use super::*;
    use approx::assert_relative_eq;
    use runs::{CsvFile, Silent, Store};
    use std::path::Path;

    fn small(out: &Path) -> PartialSlipStudy {
        PartialSlipStudy { out: out.into(), ..PartialSlipStudy::new(PartialSlipSizes::Quick).unwrap() }
    }

    #[test]
    fn tables_and_pictures_are_written_and_stored_results_are_used() {
        let dir = tempfile::tempdir().unwrap();
        let study = small(dir.path());
        let outcome = partial_slip(&study, &Silent).unwrap();
        assert!(outcome.files.iter().all(|f| f.exists()) && outcome.not_converged == 0);
        let table = |name: &str| CsvFile::read(&dir.path().join(name)).unwrap();
        assert_eq!(table(STIFFNESS).numbers("ratio").unwrap().len(), 2 * 3);
        assert_eq!(table(SLIPS).numbers("displacement").unwrap().len(), 3 * SHARES.len());
        assert_eq!(table(LOOPS).numbers("miss").unwrap().len(), 3 * AMPLITUDES.len());
        // Without Poisson's ratio nothing is missed but what the profile's table leaves.
        let slips = table(SLIPS);
        let column = |name: &str| slips.numbers(name).unwrap();
        for (i, nu) in column("poisson").into_iter().enumerate().filter(|(_, nu)| *nu == Some(0.0)) {
            assert!(nu.is_some() && column("displacement_miss")[i] == Some(0.0));
            assert_eq!(column("traction_miss")[i], Some(0.0));
            let profile = column("profile_displacement_miss")[i].unwrap();
            assert!(profile.abs() < 0.02, "{profile}");
        }
        // The same small run, stored.
        let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/reference");
        for (name, columns) in
            [(SLIPS, ["displacement", "traction_miss"]), (STIFFNESS, ["ratio", "anisotropy"])]
        {
            let reference = CsvFile::read(&stored.join(format!("quick-{name}"))).unwrap();
            for column in columns {
                let (new, old) = (table(name).numbers(column).unwrap(), reference.numbers(column).unwrap());
                assert_eq!(new.len(), old.len());
                for (new, old) in new.into_iter().zip(old) {
                    assert_relative_eq!(new.unwrap(), old.unwrap(), max_relative = 1e-3, epsilon = 1e-5);
                }
            }
        }
        let (jobs, before) = (Store::count(dir.path()), std::fs::read(dir.path().join(SLIPS)).unwrap());
        assert_eq!(jobs, 2 * study.surfaces);
        partial_slip(&study, &Silent).unwrap();
        assert_eq!(std::fs::read(dir.path().join(SLIPS)).unwrap(), before);
        assert_eq!(Store::count(dir.path()), jobs);
    }

    /// The displacement, the stick area and the loop without Poisson's ratio from normal contacts alone.
    #[test]
    fn without_poissons_ratio_it_is_ciavarella_and_jaegers_approximation() {
        let study = PartialSlipStudy { surfaces: 2, tolerance: 1e-9, ..small(Path::new("never-made")) };
        let case = study.cases()[0];
        let job = SlipJob { study: Arc::new(study.clone()), case, seed: 5 };
        let SurfaceSlips { solved, .. } = job.solve(&never).unwrap();
        let slipped = solved[0].as_ref().unwrap();
        let outputs = contact_model::Outputs { area: true, ..Default::default() };
        let mut scene = case.scene(&study, 0.0, outputs).unwrap();
        scene.effects.friction = contact_model::Friction::default();
        let model = Bem3d { cells: study.cells, tolerance: study.tolerance, ..Bem3d::default() };
        let mut normal = model.prepare(&scene, 5).unwrap();
        let force = normal.normalisation().force(study.forces.values()[0]).unwrap();
        let mut at = |share: f64| {
            let state = normal.solve(contact_model::Load::force(force * (1.0 - share))).unwrap();
            (state.approach.unwrap(), state.area.unwrap())
        };
        let (whole, area) = at(0.0);
        for (point, share) in slipped.points.iter().zip(SHARES) {
            let (rest, stick) = at(share);
            assert_relative_eq!(point.displacement, (whole - rest) / whole, max_relative = 1e-6);
            assert!((point.stick - stick / area).abs() < 0.05, "{} {}", point.stick, stick / area);
        }
        // By Masing's rule a cycle costs 4 Q delta(Q) - 8 times the integral of delta over Q.
        for (found, amplitude) in slipped.dissipated.iter().zip(AMPLITUDES) {
            let mut displacement = |i: usize| (whole - at(amplitude * i as f64 / 80.0).0) / whole;
            let points: Vec<f64> = (0..=80).map(&mut displacement).collect();
            // Simpson's rule.
            let inner: f64 = (1..80).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * points[i]).sum();
            let simpson = points[0] + inner + points[80];
            let integral = simpson * amplitude / 240.0;
            assert_relative_eq!(*found, 4.0 * amplitude * points[80] - 8.0 * integral, max_relative = 1e-3);
        }
    }

    #[test]
    fn invalid_parameters_are_named() {
        let small = || small(Path::new("never-made"));
        for (study, name) in [
            (PartialSlipStudy { threads: 0, ..small() }, "threads"),
            (PartialSlipStudy { surfaces: 1, ..small() }, "surfaces"),
            (PartialSlipStudy { cells: 2, ..small() }, "cells"),
            (PartialSlipStudy { cells_per_wave: 5, ..small() }, "cells-per-wave"),
            (PartialSlipStudy { increments: 0, ..small() }, "increments"),
            (PartialSlipStudy { poissons: vec![0.1, 0.3], ..small() }, "poisson"),
            (PartialSlipStudy { poissons: vec![0.0, 0.6], ..small() }, "poisson"),
            (PartialSlipStudy { poissons: vec![0.0, f64::NAN], ..small() }, "poisson"),
            (PartialSlipStudy { fractal_dimensions: vec![3.5], ..small() }, "df"),
            (PartialSlipStudy { grids: vec![32, 64, 96], ..small() }, "grids"),
            (PartialSlipStudy { grids: vec![32, 64], ..small() }, "grids"),
            (PartialSlipStudy { grids: vec![16, 32, 64], ..small() }, "grids"),
        ] {
            let error = partial_slip(&study, &Silent).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
    }
}
