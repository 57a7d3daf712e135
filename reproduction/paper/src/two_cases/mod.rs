//! Compares the two cases of Sec. II: a free fractal square, and a periodic one whose spectrum rolls off.

mod picture;
mod reading;
mod study;

pub use study::TwoCases;

use crate::evaluation::{Outcome, Session, header, of_scene};
use crate::judged::Judged;
use analysis::{Curves, StiffnessSample, ensemble};
use analytic::{GreenwoodWilliamson, Persson};
use bem3d::Bem3d;
use contact_model::{ContactModel as _, ContactState, Status};
use fractal_contact::scenes::{ModelResult, SceneFile, SceneJob, jobs_of_scenes, solve_jobs};
pub(crate) use picture::draw;
use picture::{names, pairs_table, table};
use reading::{ReadCase, judged, pairs, summary};
use runs::{Error, JobList, Progress, Result, Store, files, write_csv};
use std::path::Path;
pub(crate) use study::NAME;
use study::{CaseCurve, CasePoint, CaseSolve, Solves, SurfaceCase};

/// Solves the two cases (and the two mixed ones) of each fractal dimension and roll-off with boundary
/// elements, Persson's and Greenwood and Williamson's theories, and writes `two-cases.csv`,
/// `two-cases-pairs.csv`, pictures and `two-cases.md` into a directory. Stored results are not solved again.
///
/// # Errors
/// [`Error::Parameter`] for invalid parameters, errors of a model, and files that cannot be written.
pub fn two_cases(study: &TwoCases, out: &Path, progress: &dyn Progress) -> Result<Judged> {
    study.check()?;
    let session = Session::open(out, false)?;
    let states = solve(study, (out, &session.store), progress)?;
    let of_coarser = solve(&study.coarser(), (out, &session.store), progress)?;
    let solved = states.iter().map(|states| solves(study, states)).collect::<Result<Vec<_>>>()?;
    let coarser = of_coarser.iter().map(|states| solves(study, states)).collect::<Result<Vec<_>>>()?;
    let (mut outcome, mut claims) = (Outcome::new(NAME), Vec::new());
    let mut curves = Vec::new();
    let pairs = pairs(study, &solved)?;
    for ((case, surfaces), coarser) in study.cases().into_iter().zip(solved).zip(coarser) {
        let slope = case.slope(study)?;
        outcome.not_converged += surfaces
            .iter()
            .chain(&coarser)
            .flatten()
            .filter(|s| matches!(s, CaseSolve::NotConverged))
            .count();
        let samples = surfaces.iter().map(|s| s.iter().map(|s| s.sample().map(|s| s.0)).collect()).collect();
        let means =
            Curves::new(study.forces.values().to_vec(), samples).map_err(Error::model(case.label()))?;
        let curve = mean_curve(case, slope, &means, [&surfaces, &coarser]);
        let solved = ReadCase { study, curve: &curve, means: &means, surfaces: &surfaces, coarser: &coarser };
        claims.extend(judged(solved)?);
        curves.push(curve);
    }
    for (case, states) in study.cases().into_iter().zip(&states) {
        for (job, states) in states.iter().filter(|(job, _)| job.model() != "bem3d") {
            curves.push(theory(study, case, (job.model(), states))?);
        }
    }
    let header = header(study.command())
        .with_sources(Bem3d::default().sources())
        .with_sources(Persson::default().sources())
        .with_sources(GreenwoodWilliamson::default().sources())
        .with_note(format!(
            "spectrum: q^(-2 (H + 1)) from 1 wave a side (fractal) or constant below the roll-off, to {} waves (shortest: {} cells)",
            study.shortest(),
            study.cells_per_wave
        ))
        .with_note("stiffness: dF/dd of the approach (free), -dF/d(mean gap) (periodic)");
    let csv = out.join(format!("{NAME}.csv"));
    write_csv(&csv, &table(&curves)?, &header)?;
    outcome.files.push(csv.clone());
    let beside = out.join(format!("{NAME}-pairs.csv"));
    write_csv(&beside, &pairs_table(&pairs)?, &header)?;
    outcome.files.push(beside);
    outcome.files.extend(draw(&csv, out)?);
    let text = out.join(format!("{NAME}.md"));
    files::write_whole(&text, summary(study, &names(&csv)?, &curves, &pairs, &claims).as_bytes())?;
    outcome.files.push(text);
    session.close(outcome).map(|outcome| Judged::new(outcome, claims))
}

/// The jobs of a study, the coarser grids included, whose results go to `out`.
///
/// # Errors
/// As [`two_cases`] before it solves.
pub fn two_cases_jobs(study: &TwoCases, out: &Path) -> Result<Box<dyn JobList>> {
    study.check()?;
    let mut all = scenes_of(study, out)?;
    all.extend(scenes_of(&study.coarser(), out)?);
    Ok(Box::new(jobs_of_scenes(&all, out)))
}

/// The scene of each case.
fn scenes_of(study: &TwoCases, out: &Path) -> Result<Vec<SceneFile>> {
    let scene =
        |case: SurfaceCase| SceneFile::of(case.question(study), &out.join(case.label())).map_err(of_scene);
    study.cases().into_iter().map(scene).collect()
}

/// The states of a model on a surface, with the job that they are of.
type CaseStates = (SceneJob, ModelResult);

/// Solves all surfaces of all cases, each under increasing loads, and those of the theories. The states of each
/// case are in order for any number of threads.
fn solve(
    study: &TwoCases,
    (out, store): (&Path, &Store),
    progress: &dyn Progress,
) -> Result<Vec<Vec<CaseStates>>> {
    let scenes = scenes_of(study, out)?;
    let what = format!("{} surfaces of {} cells a side", scenes.len() * study.surfaces, study.cells);
    let jobs = jobs_of_scenes(&scenes, out);
    let states = solve_jobs(&what, &jobs, store, study.threads, progress).map_err(of_scene)?;
    let mut cases: Vec<Vec<CaseStates>> = scenes.iter().map(|_| Vec::new()).collect();
    for (job, states) in jobs.into_iter().zip(states) {
        cases[job.scene()].push((job, states));
    }
    Ok(cases)
}

/// The states of the boundary elements on each surface, as they are read.
fn solves(study: &TwoCases, states: &[CaseStates]) -> Result<Vec<Solves>> {
    let of = |states: &ModelResult, load: usize, force: f64| {
        let (state, normalisation) = states.state(load).map_err(|reason| {
            Error::parameter("forces", force, format!("loads that bem3d can solve ({reason})"))
        })?;
        Ok(match state {
            ContactState { report, .. } if report.status != Status::Converged => CaseSolve::NotConverged,
            ContactState { stiffness: Some(k), area: Some(area), report, .. } => {
                let stiffness_bar = normalisation.stiffness_bar(*k);
                let sample = StiffnessSample { stiffness_bar, contact_cells: report.contact_cells };
                CaseSolve::StiffnessSample(sample, *area)
            }
            _ => CaseSolve::FullContact,
        })
    };
    let of_surface = |(_, states): &CaseStates| {
        study.forces.values().iter().enumerate().map(|(load, &force)| of(states, load, force)).collect()
    };
    states.iter().filter(|(job, _)| job.model() == "bem3d").map(of_surface).collect()
}

/// Means over the surfaces on the grid and on the coarser one.
fn mean_curve(
    case: SurfaceCase,
    slope: f64,
    means: &Curves,
    [surfaces, coarser]: [&[Solves]; 2],
) -> CaseCurve {
    let area = |surfaces: &[Solves], j: usize| {
        let areas: Vec<f64> = surfaces.iter().filter_map(|s| s[j].sample().map(|s| s.1)).collect();
        (analysis::sum(areas.iter().copied()) / areas.len() as f64, areas.len())
    };
    let points = ensemble(means)
        .into_iter()
        .enumerate()
        .filter_map(|(j, p)| {
            let k = p.stiffness_bar?;
            let (mean_area, count) = area(surfaces, j);
            Some(CasePoint {
                force_bar: p.force_bar,
                kappa: analysis::kappa(mean_area, p.force_bar, 1.0, slope).ok(),
                stiffness_bar: k.mean,
                standard_error: k.standard_error,
                surfaces: count,
                left_out: p.missing,
                area: Some(mean_area),
                area_coarser: Some(area(coarser, j).0).filter(|area| area.is_finite()),
                min_contact_cells: p.min_contact_cells,
            })
        })
        .collect();
    CaseCurve { case, model: "bem3d", points }
}

/// The results of a theory in its range of validity.
fn theory(
    study: &TwoCases,
    case: SurfaceCase,
    (model, states): (&'static str, &ModelResult),
) -> Result<CaseCurve> {
    let slope = case.slope(study)?;
    let point = |(load, &force_bar): (usize, &f64)| {
        // A theory refuses the loads beyond its range of validity.
        let (state, normalisation) = states.state(load).ok()?;
        Some(CasePoint {
            force_bar,
            stiffness_bar: normalisation.stiffness_bar(state.stiffness?),
            area: state.area,
            kappa: state.area.and_then(|area| analysis::kappa(area, force_bar, 1.0, slope).ok()),
            ..CasePoint::default()
        })
    };
    let points = study.forces.values().iter().enumerate().filter_map(point).collect();
    Ok(CaseCurve { case, model, points })
}

#[cfg(test)]
mod tests {
    use super::reading::{difference, loads_between, proportional, slopes};
    use super::*;
    use crate::evaluation::Forces;
    use contact_model::Boundary;
    use runs::CsvFile;
    use runs::Silent;

    fn small() -> TwoCases {
        TwoCases {
            cells: 64,
            cells_per_wave: 8,
            surfaces: 2,
            fractal_dimensions: vec![2.2],
            roll_offs: vec![3.0],
            forces: Forces::parse("1e-2:10:7").unwrap(),
            tolerance: 1e-3,
            seed: 1,
            threads: 2,
        }
    }

    #[test]
    fn all_cases_and_theories_have_rows() {
        let dir = tempfile::tempdir().unwrap();
        let outcome = two_cases(&small(), dir.path(), &Silent).unwrap();
        assert!(outcome.files.iter().all(|f| f.exists()));
        for entry in crate::claims::entries("two_cases").unwrap() {
            let judged = outcome.claims.iter().any(|claim| claim.statement.reading == entry.reading);
            assert!(judged, "{}", entry.id);
        }
        let file = CsvFile::read(&dir.path().join("two-cases.csv")).unwrap();
        let (case, model) = (file.texts("case").unwrap(), file.texts("model").unwrap());
        for of in small().cases() {
            let rows =
                |name: &str| (0..case.len()).filter(|&i| case[i] == of.name() && model[i] == name).count();
            assert_eq!(rows("bem3d"), 7, "{}", of.label());
            assert_eq!(rows("persson") > 0, of.boundary == Boundary::Periodic);
        }
        // The largest loads of a periodic square are far stiffer than a free one can be.
        let k = file.numbers("stiffness_bar").unwrap();
        assert!(k[6].unwrap() < 1.1 && k[4 * 7 - 1].unwrap() > 3.0);
    }

    #[test]
    fn a_load_that_the_boundary_elements_refuse_ends_the_study() {
        let dir = tempfile::tempdir().unwrap();
        let study = TwoCases { forces: Forces::parse("0.1,1e308").unwrap(), ..small() };
        let error = two_cases(&study, dir.path(), &Silent).unwrap_err().to_string();
        assert!(error.starts_with("forces = 1e308: expected loads that bem3d can solve ("), "{error}");
    }

    #[test]
    fn more_problems_share_what_is_solved() {
        let dir = tempfile::tempdir().unwrap();
        let read = |study: &TwoCases| {
            two_cases(study, dir.path(), &Silent).unwrap();
            std::fs::read_to_string(dir.path().join("two-cases.csv")).unwrap()
        };
        let jobs = || Store::count(dir.path());
        let first = read(&small());
        assert_eq!(jobs(), 2 * 4 * 2);
        // One more roll-off: two cases of two surfaces on two grids; the others come from the store, and
        // their numbers stay.
        let study = TwoCases { roll_offs: vec![3.0, 5.0], ..small() };
        let both = read(&study);
        assert_eq!(jobs(), 2 * 6 * 2);
        for row in first.lines().filter(|line| line.contains("bem3d,")) {
            assert!(both.contains(row), "{row}");
        }
        assert!(dir.path().join("two-cases-ratio-Df2.2-rolloff5.svg").exists());
        assert_eq!(read(&small()), first);
    }

    #[test]
    fn slopes_and_ranges_by_hand() {
        // k = F from the second load on.
        let points =
            [(1.0, 3.0), (10.0, 10.0), (100.0, 100.0), (1000.0, 1000.0), (10000.0, 1e4)].map(|(f, k)| {
                CasePoint {
                    force_bar: f,
                    stiffness_bar: k,
                    surfaces: 1,
                    area: Some(f / 1e4),
                    ..CasePoint::default()
                }
            });
        let curve = CaseCurve { case: small().cases()[3], model: "bem3d", points: points.into() };
        let slopes = slopes(&curve.points);
        assert!(slopes[0].is_none() && slopes[4].is_none() && (slopes[2].unwrap() - 1.0).abs() < 1e-12);
        approx::assert_relative_eq!(proportional(&curve), 1.0, max_relative = 1e-12);
        let window = loads_between(&curve);
        approx::assert_relative_eq!(window.min_force_bar, 100.0);
        approx::assert_relative_eq!(window.max_force_bar, 1000.0);
        approx::assert_relative_eq!(difference(&curve, &curve).unwrap(), 0.0);
    }

    #[test]
    fn invalid_parameters_are_named() {
        let out = Path::new("never-made");
        for (study, name) in [
            (TwoCases { threads: 0, ..small() }, "threads"),
            (TwoCases { surfaces: 0, ..small() }, "surfaces"),
            (TwoCases { cells: 9, ..small() }, "cells"),
            (TwoCases { cells_per_wave: 7, ..small() }, "cells-per-wave"),
            (TwoCases { cells: 66, ..small() }, "cells"),
            (TwoCases { cells_per_wave: usize::MAX, ..small() }, "cells"),
            (TwoCases { roll_offs: vec![3.0, f64::NAN], ..small() }, "roll-off"),
            (TwoCases { roll_offs: vec![9.0], ..small() }, "roll-off"),
            (TwoCases { fractal_dimensions: Vec::new(), ..small() }, "df"),
        ] {
            let error = two_cases(&study, out, &Silent).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
        let error =
            two_cases(&TwoCases { fractal_dimensions: vec![3.5], ..small() }, &std::env::temp_dir(), &Silent);
        assert!(error.unwrap_err().to_string().contains("3.5"));
    }
}
