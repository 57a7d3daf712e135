//! The computing time that accuracy costs, and the dominant part of the error.
//!
//! [`accuracy_cost`] solves bodies with a known solution and self-affine surfaces with every method of this
//! project, and reports the error and the cost of each. References are exact answers, or the limit of fine
//! grids at the tightest tolerance, extrapolated where the observed order is established; each comes with its
//! uncertainty, and no error is reported below it.

mod check;
mod depth;
mod every_way;
mod job;
mod limit;
mod means;
mod picture;
mod plan;
mod pressure;
mod problem;
mod random_case;
mod row;
mod sizes;
mod study;
mod table;
mod text;

pub use check::{Coverage, budget_check, budget_check_jobs};
pub use depth::Depth;
pub use job::accuracy_cost_jobs;
pub use plan::{AccuracyPlan, plan, settle};

use crate::evaluation::header::header;
use crate::evaluation::outcome::Outcome;
use crate::evaluation::session::Session;
use contact_model::ContactModel as _;
use runs::{Progress, Result, files, write_csv};
use sizes::StudySizes;
use std::path::{Path, PathBuf};

/// Name of its files.
const NAME: &str = "accuracy-cost";

/// Runs the study and writes `accuracy-cost.csv`, `accuracy-order.csv`, `accuracy-cost.svg`,
/// `accuracy-cost.png` (drawn from the CSV) and `accuracy-cost.md` into a directory. Results stored there are
/// not solved again and keep the times of the machine that solved them.
///
/// It runs on one thread, so that each row has its own processor seconds. Only these, the memory and the rows
/// on the Pareto front differ between machines.
///
/// # Errors
/// Errors of a solver, a directory that another process works in, and files that cannot be written.
pub fn accuracy_cost(
    depth: Depth,
    seed: u64,
    (out, fresh): (&Path, bool),
    progress: &dyn Progress,
) -> Result<Outcome> {
    let command = format!("cargo xtask accuracy-cost --preset {} --seed {seed}", depth.as_str());
    run(SizedStudy { sizes: &depth.sizes(), seed, command }, out, fresh, progress)
}

/// A study of any size.
struct SizedStudy<'a> {
    sizes: &'a StudySizes,
    /// Seed of the seeds of all surfaces.
    seed: u64,
    /// The command that its tables name.
    command: String,
}

fn run(sized: SizedStudy<'_>, out: &Path, fresh: bool, progress: &dyn Progress) -> Result<Outcome> {
    let SizedStudy { sizes, seed, command } = sized;
    let session = Session::open(out, fresh)?;
    let study = study::study(sizes, seed, &session.store, progress)?;
    let header = header(command)
        .with_sources(bem3d::Bem3d::default().sources())
        .with_sources(mdr1d::Mdr1d::default().sources())
        .with_sources(analytic::Hertz.sources())
        .with_note(format!(
            "references at tolerance {:?} on {:?} cells a side; band: shortest wave {} cells of the coarsest grid",
            sizes.tight,
            sizes.sequence(),
            problem::CELLS_PER_WAVE
        ))
        .with_note("spectrum: F_bar counts in the rms height on the paper's 2049 cells; mean: in each surface's own")
        .with_note(format!("seed: {seed} (surface i: surface_seed(seed, i); single surfaces are number 0)"))
        .with_note("cpu_seconds and bytes depend on the machine, everything else does not");
    let mut outcome = Outcome::new(NAME);
    let csv = out.join(format!("{NAME}.csv"));
    write_csv(&csv, &table::rows(&study)?, &header)?;
    let order = out.join("accuracy-order.csv");
    write_csv(&order, &table::orders(&study)?, &header)?;
    outcome.files = vec![csv.clone(), order.clone()];
    outcome.files.extend(redraw(&csv, &order, out)?);
    outcome.not_converged = study.rows.iter().filter(|r| !r.converged()).count();
    session.close(outcome)
}

/// Draws the picture and writes the text again from the tables that [`accuracy_cost`] left in a directory.
///
/// # Errors
/// Tables that cannot be read, files that cannot be written.
pub fn redraw_accuracy(out: &Path) -> Result<Vec<PathBuf>> {
    redraw(&out.join(format!("{NAME}.csv")), &out.join("accuracy-order.csv"), out)
}

fn redraw(csv: &Path, order: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let mut written = picture::draw(csv, out, NAME)?;
    let text = out.join(format!("{NAME}.md"));
    files::write_whole(&text, text::text(csv, order)?.as_bytes())?;
    written.push(text);
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;
    use runs::{CsvFile, JobList as _, Silent, Store};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A quarter of the finest quick grid, which takes a second.
    const TINY: StudySizes = StudySizes {
        grids: &[17, 33, 65],
        between: &[25, 49],
        tolerances: &[1e-1],
        finest: &[1e-2],
        ladder: 33,
        tight: 1e-8,
        elements: &[256, 1024],
        surfaces: 3,
        ensembles: &[17, 33],
    };
    /// Hertz on 65 cells: the contact is 39 of them wide, errors are of second order in theirs.
    const HERTZ: f64 = 0.01;

    #[test]
    fn a_tiny_study_is_complete() {
        let dir = tempfile::tempdir().unwrap();
        let study = SizedStudy { sizes: &TINY, seed: 1, command: "tiny".into() };
        let outcome = run(study, dir.path(), false, &Silent).unwrap();
        assert_eq!(outcome.files.len(), 5);
        assert!(outcome.files.iter().all(|f| f.exists()));
        assert_eq!(outcome.not_converged, 0);
        let file = CsvFile::read(&dir.path().join("accuracy-cost.csv")).unwrap();
        let column = |name: &str| file.numbers(name).unwrap();
        let (family, model) = (file.texts("family").unwrap(), file.texts("model").unwrap());
        let (error, tolerance, size) = (column("error_stiffness"), column("tolerance"), column("size"));
        let (algebraic, reference) = (column("algebraic"), column("reference_error"));
        for i in 0..family.len() {
            assert!(error[i].unwrap() >= reference[i].unwrap() * (1.0 - 1e-12), "row {i}");
            match (family[i], model[i]) {
                ("sphere", "hertz" | "mdr1d") => assert!(error[i].unwrap() < 1e-12),
                // 2/sqrt(pi) for 1.1523: the line of Eq. 18 is 2.08 % short of the square.
                ("square", "mdr1d") => assert!((error[i].unwrap() - 0.0208).abs() < 1e-4),
                ("sphere", "bem3d") if size[i] == Some(65.0) && tolerance[i] == Some(1e-8) => {
                    assert!(error[i].unwrap() < HERTZ && algebraic[i] == Some(0.0));
                }
                _ => {}
            }
        }
        let drawn = std::fs::read(dir.path().join("accuracy-cost.png")).unwrap();
        assert_eq!(redraw_accuracy(dir.path()).unwrap().len(), 3);
        assert!(std::fs::read(dir.path().join("accuracy-cost.png")).unwrap() == drawn);
        let text = std::fs::read_to_string(dir.path().join("accuracy-cost.md")).unwrap();
        assert!(text.contains("## Which part dominates") && !text.contains("NaN") && !text.contains("inf"));
    }

    /// An even smaller study.
    const SMALL: StudySizes = StudySizes {
        grids: &[17, 33],
        between: &[25],
        ladder: 17,
        elements: &[256],
        surfaces: 2,
        ensembles: &[17, 33],
        ..TINY
    };

    /// Counts the jobs that were taken from the store.
    #[derive(Default)]
    struct Stored(AtomicUsize);

    impl Progress for Stored {
        fn begin(&self, _: &str, _: u64) {}
        fn advance(&self, _: u64, stored: bool) {
            self.0.fetch_add(usize::from(stored), Ordering::Relaxed);
        }
        fn end(&self) {}
    }

    /// The tables of a directory, and the same without what is measured.
    fn tables(dir: &Path) -> [Vec<Vec<String>>; 2] {
        let files =
            ["accuracy-cost.csv", "accuracy-order.csv"].map(|name| CsvFile::read(&dir.join(name)).unwrap());
        let measured = ["cpu_seconds", "bytes", "pareto"];
        let rest = |file: &CsvFile| {
            let kept = |row: &Vec<String>| {
                let entries = row.iter().zip(&file.columns).filter(|e| !measured.contains(&e.1.as_str()));
                entries.map(|e| e.0.clone()).collect()
            };
            file.rows.iter().map(kept).collect::<Vec<Vec<String>>>()
        };
        let rest = files.iter().flat_map(rest).collect();
        [files.into_iter().flat_map(|file| file.rows).collect(), rest]
    }

    #[test]
    fn a_study_that_was_interrupted_gives_the_same_tables() {
        let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let run = |dir: &Path| {
            let stored = Stored::default();
            let study = SizedStudy { sizes: &SMALL, seed: 1, command: "small".into() };
            run(study, dir, false, &stored).unwrap();
            (tables(dir), stored.0.into_inner())
        };
        let ([_, expected], found) = run(whole.path());
        assert_eq!(found, 0);
        // As in a shard with two threads, stopped inside the jobs.
        let jobs = job::jobs(&SMALL, 1).unwrap();
        let (all, polls) = ((0..jobs.len()).collect::<Vec<_>>(), AtomicUsize::new(0));
        let stop = || polls.fetch_add(1, Ordering::Relaxed) >= 80;
        let store = Store::open(parts.path(), false).unwrap();
        let stopped = jobs.work(&all, &store, runs::Threads::all(2), &Silent, &stop).unwrap_err();
        assert!(stopped.to_string().contains("stopped"), "{stopped}");
        drop(store);
        let done = Store::count(parts.path());
        assert!(done > 0 && done < jobs.len(), "{done} of {}", jobs.len());
        let ([all, resumed], found) = run(parts.path());
        assert_eq!((resumed, found), (expected, done));
        // Once more, everything comes from the store, times too.
        let ([again, _], found) = run(parts.path());
        assert_eq!((again, found), (all, jobs.len()));
    }
}
