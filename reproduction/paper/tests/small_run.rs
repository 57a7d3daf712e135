//! Tiny runs of real solves: resumption, threads, damaged files, output files.

#![allow(clippy::unwrap_used)] // Helpers outside #[test] functions.

use paper::evaluation::{AccuracyTarget, EnsembleModel, Request, Run};
use paper::{Verdict, counts, fig1, fig2, fig3, fig4, fig5, fig6, fig7, verify};
use runs::{CsvFile, Error, Progress, Silent, Store};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

fn request(out: &Path) -> Request {
    Request {
        cells: Some(17),
        surfaces: Some(2),
        elements: Some(256),
        lines: Some(3),
        fractal_dimensions: Some(vec![2.0, 2.6]),
        forces: Some("1e-3:20:5,0.086".to_owned()),
        out: Some(out.to_owned()),
        ..Request::default()
    }
}

fn run(out: &Path) -> Run {
    Run::new(&request(out)).unwrap()
}

fn read(out: &Path, name: &str) -> Vec<u8> {
    fs::read(out.join(name)).unwrap()
}

/// Counts jobs and those found on disk.
#[derive(Default)]
struct StoredJobCounter {
    jobs: AtomicUsize,
    reused: AtomicUsize,
}

impl Progress for StoredJobCounter {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64, reused: bool) {
        self.jobs.fetch_add(1, Ordering::Relaxed);
        self.reused.fetch_add(usize::from(reused), Ordering::Relaxed);
    }
    fn end(&self) {}
}

/// The pack of a store that one run made, and its text: the head, then each result.
fn results(out: &Path) -> (PathBuf, Vec<String>) {
    let mut packs = Store::packs(out).unwrap();
    assert_eq!(packs.len(), 1);
    let path = packs.remove(0).path;
    let text = fs::read_to_string(&path).unwrap();
    let mark = "# fractal-contact result ";
    let pieces = text.split(mark).enumerate();
    (path, pieces.map(|(i, piece)| if i == 0 { piece.to_owned() } else { mark.to_owned() + piece }).collect())
}

const TABLES: [&str; 2] = ["fig2.csv", "fig2-samples.csv"];

#[test]
fn results_depend_on_the_seed_and_not_on_threads() {
    let (a, b, c) =
        (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let one = Run::new(&Request { threads: Some(1), ..request(a.path()) }).unwrap();
    let two = Run::new(&Request { threads: Some(2), ..request(b.path()) }).unwrap();
    let other = Run::new(&Request { seed: Some(1), ..request(c.path()) }).unwrap();
    for run in [&one, &two, &other] {
        fig2(run, &Silent).unwrap();
        fig6(run, &Silent).unwrap();
    }
    for name in TABLES.into_iter().chain(["fig6.csv", "fig6-samples.csv", "fig2.svg", "fig6.png"]) {
        assert!(read(a.path(), name) == read(b.path(), name), "{name}");
        assert!(read(a.path(), name) != read(c.path(), name), "{name}");
    }
}

#[test]
fn a_run_resumes_and_damage_is_solved_again() {
    let dir = tempfile::tempdir().unwrap();
    let run = run(dir.path());
    fig2(&run, &Silent).unwrap();
    let whole: Vec<Vec<u8>> = TABLES.iter().map(|t| read(dir.path(), t)).collect();
    let (path, text) = results(dir.path());
    assert_eq!(text.len(), 1 + 4);
    // One result lost, one cut short, one of another surface under its name, and what a kill leaves behind.
    let half = &text[2][..text[2].len() / 2];
    let (name, _) = text[3].split_once('\n').unwrap();
    let (_, other) = text[4].split_once('\n').unwrap();
    fs::write(&path, [&text[0], half, "\n", name, "\n", other, &text[4]].concat()).unwrap();
    fs::write(dir.path().join(".units/.partial-0-0-x.csv"), "half").unwrap();
    let counter = StoredJobCounter::default();
    fig2(&run, &counter).unwrap();
    assert_eq!((counter.jobs.into_inner(), counter.reused.into_inner()), (4, 1));
    assert!(TABLES.map(|t| read(dir.path(), t)).to_vec() == whole);
    assert_eq!(Store::count(dir.path()), 4);
}

#[test]
fn other_figures_reuse_results_and_other_parameters_do_not() {
    let dir = tempfile::tempdir().unwrap();
    let run = run(dir.path());
    fig2(&run, &Silent).unwrap();
    fig6(&run, &Silent).unwrap();
    let reused = |run: &Run, figure: fn(&Run, &dyn Progress) -> runs::Result<paper::Judged>| {
        let counter = StoredJobCounter::default();
        figure(run, &counter).unwrap();
        (counter.jobs.into_inner(), counter.reused.into_inner())
    };
    assert_eq!(reused(&run, fig3), (10, 10));
    assert_eq!(reused(&run, fig4), (4, 4));
    assert_eq!(reused(&run, fig7), (10, 10));
    assert_eq!(reused(&run, verify), (10, 10));
    assert_eq!(reused(&Run { fresh: true, ..run.clone() }, fig4), (4, 0));
    assert_eq!(reused(&Run { tolerance: 1e-5, ..run.clone() }, fig4), (4, 0));
    // One surface more: the others are there.
    assert_eq!(reused(&Run { surfaces: 3, ..run }, fig4), (6, 4));
}

#[test]
fn every_figure_writes_its_files() {
    let dir = tempfile::tempdir().unwrap();
    let run = run(dir.path());
    let figures = [fig1, fig2, fig3, fig4, fig5, fig6, fig7, verify];
    for figure in figures {
        let outcome = figure(&run, &Silent).unwrap();
        assert_eq!(outcome.not_converged, 0);
        for file in &outcome.files {
            let bytes = fs::read(file).unwrap();
            match file.extension().and_then(|e| e.to_str()) {
                Some("png") => {
                    let reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
                    assert!(reader.info().width >= 17, "{}", file.display());
                }
                Some("svg") => {
                    let text = String::from_utf8(bytes).unwrap();
                    assert!(text.starts_with("<svg") || text.starts_with("<?xml"), "{}", file.display());
                    assert!(text.trim_end().ends_with("</svg>") && !text.contains("NaN"));
                }
                Some("csv") => {
                    let table = CsvFile::read(file).unwrap();
                    assert!(
                        !table.rows.is_empty() && table.comments.iter().any(|c| c.starts_with("command: "))
                    );
                    assert!(!table.rows.iter().flatten().any(|f| f == "NaN" || f == "inf"));
                }
                _ => assert!(!bytes.is_empty()),
            }
        }
    }
    let columns = |name: &str| CsvFile::read(&dir.path().join(name)).unwrap().columns.join(",");
    assert!(columns("fig1.csv").starts_with("fractal_dimension,x,y,height"));
    let curves = "model,fractal_dimension,force_bar,stiffness_bar,stiffness_bar_se,stiffness_bar_log_mean,surfaces,cells";
    assert!(columns("fig2.csv").starts_with(curves) && columns("fig6.csv").starts_with(curves));
    assert!(columns("fig3.csv").starts_with("model,fractal_dimension,alpha,alpha_se"));
    assert!(columns("fig4.csv").starts_with("model,fractal_dimension,force_bar,force_tilde"));
    assert!(columns("fig5.csv").starts_with("fractal_dimension,x,height"));
    assert!(columns("fig7.csv").starts_with("model,fractal_dimension,zeta,zeta_se"));
    assert_eq!(
        columns("verify.csv"),
        "statement,quantity,quotation,place,reading,paper_min,paper_max,here,half_width,half_width_together,verdict,remark"
    );
}

#[test]
fn contradictions_stand_first_and_every_row_is_in_the_text() {
    let dir = tempfile::tempdir().unwrap();
    let claims = verify(&run(dir.path()), &Silent).unwrap().claims;
    let plateau = claims.iter().find(|c| c.quantity.starts_with("complete contact of the square")).unwrap();
    assert_eq!(plateau.verdict, Verdict::Contradicted);
    assert!(claims.is_sorted_by_key(|c| c.verdict));
    assert!(claims.iter().all(|c| !c.statement.quotation.is_empty() && !c.statement.reading.is_empty()));
    let text = fs::read_to_string(dir.path().join("verify.md")).unwrap();
    assert_eq!(text.lines().filter(|l| l.starts_with("| ")).count(), claims.len() + 1);
    assert!(text.contains(&counts(&claims)));
}

#[test]
fn an_unwritable_directory_is_named_and_nothing_is_left() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("taken");
    fs::write(&file, "a file").unwrap();
    let error = fig6(&run(&file.join("out")), &Silent).unwrap_err();
    assert!(matches!(error, Error::File { .. }) && error.to_string().contains("taken"), "{error}");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn means_have_budgets_where_the_grid_can_be_halved() {
    let dir = tempfile::tempdir().unwrap();
    let request = Request {
        cells: Some(65),
        surfaces: Some(3),
        forces: Some("1,20".to_owned()),
        fractal_dimensions: Some(vec![2.4]),
        ..request(dir.path())
    };
    let run = Run::new(&request).unwrap();
    let outcome = fig2(&run, &Silent).unwrap();
    assert!(outcome.reached[0].starts_with("fig2: accuracy reached"), "{:?}", outcome.reached);
    let file = CsvFile::read(&dir.path().join("fig2-budget.csv")).unwrap();
    let (width, ensemble) = (file.numbers("half_width").unwrap(), file.numbers("ensemble").unwrap());
    let (algebraic, grid) = (file.numbers("algebraic").unwrap(), file.numbers("discretisation").unwrap());
    assert_eq!(width.len(), 2);
    for j in 0..2 {
        let sum = algebraic[j].unwrap() + grid[j].unwrap().hypot(ensemble[j].unwrap());
        approx::assert_relative_eq!(width[j].unwrap(), sum, max_relative = 1e-12);
    }
    // Without a half-size grid there is no budget.
    let coarse = Run { cells: 17, ..run };
    assert!(fig2(&coarse, &Silent).unwrap().reached[0].contains("unknown"));
}

#[test]
fn an_accuracy_target_is_met_or_refused_with_its_cost() {
    let dir = tempfile::tempdir().unwrap();
    let request = Request {
        forces: Some("1,20".to_owned()),
        fractal_dimensions: Some(vec![2.0]),
        out: Some(dir.path().to_owned()),
        threads: Some(1),
        ..Request::default()
    };
    let models = [EnsembleModel::Bem3d];
    let plan = |share, seconds| {
        paper::evaluation::plan(&request, &models, AccuracyTarget { share, seconds }, &Silent)
    };
    let planned = plan(0.1, 600.0).unwrap();
    assert!(planned.seconds <= 600.0 && planned.run.surfaces >= 2, "{:?}", planned.lines);
    let target = AccuracyTarget { share: 0.1, seconds: 600.0 };
    let settled = paper::evaluation::settle(planned, &models, target, &Silent).unwrap();
    let counter = StoredJobCounter::default();
    fig2(&settled.run, &counter).unwrap();
    assert_eq!(counter.jobs.into_inner(), counter.reused.into_inner());
    let file = CsvFile::read(&dir.path().join("fig2-budget.csv")).unwrap();
    assert!(file.numbers("relative").unwrap().iter().all(|r| r.unwrap() <= 0.1));
    let refused = plan(1e-4, 60.0).unwrap_err().to_string();
    assert!(
        refused.starts_with("accuracy = 0.010 %") && refused.contains("and the budget is 60 s"),
        "{refused}"
    );
    let given = Request { cells: Some(65), ..request };
    let refused =
        paper::evaluation::plan(&given, &models, AccuracyTarget { share: 0.1, seconds: 1.0 }, &Silent)
            .unwrap_err();
    assert!(refused.to_string().starts_with("cells = 65"), "{refused}");
}
