//! The exponent of stiffness over force, by multilevel Monte Carlo over grids.
//!
//! Pairs of the same surface on two neighbouring grids give the mean difference between them with few
//! surfaces; the mean on the finest grid is the sum of the mean on the coarsest and of all differences
//! ([`analysis::Multilevel`]). From it come local slopes with a band over all forces together, exponents over
//! fixed windows and towards zero force (a fit with a correction to scaling), and the factor between line and
//! surface, each with the discretisation error of the finest grid. The results are not extrapolated in the
//! grid: a curve counts as resolved down to the load at which this error exceeds the stated one. Hypotheses
//! that were fixed before a run are tested on it alone.
//!
//! All tables follow from `exponent-samples.csv` ([`exponent_of_samples`]).

mod correction;
mod curve;
mod families;
mod ladder;
mod laws;
mod picture;
mod plan;
mod report;
mod samples;
mod tables;

pub use ladder::Ladder;
pub use picture::draw as draw_exponent;
pub use samples::SAMPLES;

use crate::evaluation::limits::require;
use crate::evaluation::{
    Discretisation, FRACTAL_DIMENSIONS, Forces, Outcome, Realisation, SEED, Session, Workplace, header, list,
    realisation_jobs,
};
use crate::judged::Judged;
use contact_model::ContactModel as _;
use contact_model::Table;
use curve::{Convention, MeanCurve};
use fractal_contact::scenes::SceneJob;
use ladder::{GridPair, Rungs};
use report::StudyFindings;
use runs::{Header, Progress, Result, Store, files, write_csv};
use std::path::{Path, PathBuf};

/// The parameters of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct Exponent {
    /// D_f.
    pub fractal_dimensions: Vec<f64>,
    /// Boundary elements.
    pub solid: Ladder,
    /// The one-dimensional reduction.
    pub line: Ladder,
    /// Largest allowed relative discretisation error of k_bar on the finest grid.
    pub error: f64,
    /// Master seed.
    pub seed: u64,
    /// Threads.
    pub threads: usize,
    /// Directory of the results.
    pub out: PathBuf,
    /// Ignore stored results.
    pub fresh: bool,
}

/// Sizes of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExponentSizes {
    /// Seconds, for tests.
    Quick,
    /// Up to 1025 cells and 2^20 elements.
    #[default]
    Default,
    /// Up to 16385 cells and 2^26 elements.
    Full,
}

impl Exponent {
    /// The study at these sizes.
    ///
    /// # Errors
    /// None for the existing sizes; [`runs::Error::Parameter`] for an invalid list of loads.
    pub fn new(sizes: ExponentSizes) -> Result<Self> {
        let (cells, surfaces, elements, lines, solid_forces, line_forces): (&[_], &[_], &[_], &[_], _, _) =
            match sizes {
                ExponentSizes::Quick => {
                    (&[33, 65, 129], &[8, 4, 3], &[10, 11, 12], &[8, 4, 3], "2e-3:2e-1:13", "2e-3:2e-1:13")
                }
                ExponentSizes::Default => (
                    &[129, 257, 513, 1025],
                    &[256, 96, 48, 24],
                    &[14, 16, 18, 20],
                    &[400, 200, 100, 50],
                    "2e-5:2e-1:25",
                    "2e-5:2e-1:25",
                ),
                ExponentSizes::Full => (
                    &[257, 513, 1025, 2049, 4097, 8193, 16385],
                    &[400, 160, 80, 40, 20, 10, 6],
                    &[18, 20, 22, 24, 26],
                    &[800, 200, 100, 40, 16],
                    "2e-7:2e-1:37",
                    "2e-8:2e-1:43",
                ),
            };
        Ok(Self {
            fractal_dimensions: FRACTAL_DIMENSIONS.to_vec(),
            solid: Ladder {
                model: Discretisation::Bem3d { cells: 0, tolerance: 1e-3 },
                sizes: cells.to_vec(),
                surfaces: surfaces.to_vec(),
                forces: Forces::parse(solid_forces)?,
                heavy: Some((laws::LARGEST * (1.0 + 1e-9), 2049)),
            },
            line: Ladder {
                model: Discretisation::Mdr1d { elements: 0 },
                sizes: elements.iter().map(|power| 1 << power).collect(),
                surfaces: lines.to_vec(),
                forces: Forces::parse(line_forces)?,
                heavy: None,
            },
            error: 0.03,
            seed: SEED,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            out: "out".into(),
            fresh: false,
        })
    }

    fn ladders(&self) -> [(&'static str, &Ladder); 2] {
        [("surfaces", &self.solid), ("lines", &self.line)]
    }

    fn validate(&self) -> Result<()> {
        let error = self.error;
        require(error > 0.0 && error < 1.0, "error", error, "a share above 0 and below 1")?;
        let dimensions = self.fractal_dimensions.len();
        self.solid.validate("grids", "surfaces", dimensions)?;
        self.line.validate("elements", "lines", dimensions)
    }

    /// All jobs of the study.
    ///
    /// # Errors
    /// [`runs::Error::Parameter`] for invalid sizes.
    pub fn jobs(&self) -> Result<Vec<SceneJob>> {
        self.validate()?;
        let of = |(_, ladder): (_, &Ladder)| ladder.realisations(&self.fractal_dimensions, self.seed);
        let all: Vec<Realisation> = self.ladders().into_iter().flat_map(of).collect();
        realisation_jobs(&all, &self.out)
    }

    fn command(&self) -> String {
        let join = |sizes: &[usize]| sizes.iter().map(usize::to_string).collect::<Vec<_>>().join(",");
        let Self { solid, line, .. } = self;
        format!(
            "cargo xtask exponent --grids {} --surfaces {} --elements {} --lines {} --forces {} --line-forces {} --fractal-dimensions {} --error {:?} --seed {}",
            join(&solid.sizes),
            join(&solid.surfaces),
            join(&line.sizes),
            join(&line.surfaces),
            solid.forces.spec(),
            line.forces.spec(),
            list(&self.fractal_dimensions),
            self.error,
            self.seed
        )
    }
}

/// Number of surfaces of each level that are solved first, so that the cost is known before the others are
/// solved.
const PILOT: usize = 2;

/// Lines of text with the predicted cost of the study, and with the number of surfaces that can be solved in
/// `seconds` on all threads.
///
/// Stored results count as measured. In addition, a few surfaces of the smaller grids are solved (which the
/// study uses as well), on grids that together have a thousandth of the cells of the largest one.
///
/// # Errors
/// As the study; errors of a model or of the store.
pub fn exponent_plan(study: &Exponent, seconds: f64, progress: &dyn Progress) -> Result<Vec<String>> {
    study.validate()?;
    let store = Store::open(&study.out, study.fresh)?;
    let mut lines = Vec::new();
    for (name, ladder) in study.ladders() {
        let largest = ladder.sizes.last().copied().unwrap_or(0);
        let pilot: Vec<usize> = (ladder.sizes.iter().zip(&ladder.surfaces))
            .map(|(&size, &count)| {
                let (dimensions, kept) = (&study.fractal_dimensions, (study.out.as_path(), &store));
                let stored = ladder.stored(dimensions, study.seed, size, kept)?;
                let small = size <= (largest / 16).max(ladder.sizes[0]);
                Ok(stored.max(if small { PILOT } else { 0 }).min(count))
            })
            .collect::<Result<_>>()?;
        let place = Workplace { out: &study.out, store: &store, threads: study.threads };
        let rungs = ladder.solve(&study.fractal_dimensions, study.seed, &pilot, &place, progress)?;
        let costs = plan::costs(ladder, &rungs, seconds * study.threads as f64);
        lines.extend(plan::lines(name, &ladder.forces, &costs, study.threads));
    }
    Ok(lines)
}

/// Solves everything that is not stored, and writes `exponent-samples.csv` and the files that
/// [`exponent_of_samples`] makes from it.
///
/// # Errors
/// [`runs::Error::Parameter`] for invalid sizes; errors of a model or of the file system.
pub fn exponent(study: &Exponent, progress: &dyn Progress) -> Result<Judged> {
    study.validate()?;
    let session = Session::open(&study.out, study.fresh)?;
    let place = Workplace { out: &study.out, store: &session.store, threads: study.threads };
    let mut rungs: Vec<Rungs> = Vec::new();
    // Lines first: they are cheap.
    for (_, ladder) in study.ladders().into_iter().rev() {
        let (dimensions, seed) = (&study.fractal_dimensions, study.seed);
        rungs.extend(ladder.solve(dimensions, seed, &ladder.surfaces, &place, progress)?);
    }
    let mut outcome = Outcome::new("exponent");
    outcome.not_converged = rungs.iter().flat_map(Rungs::pairs).map(GridPair::not_converged).sum();
    let heavy = study.solid.heavy.map_or(0, |heavy| heavy.1);
    let largest = laws::LARGEST;
    let header = described(study.command())
        .with_note(format!("loads above {largest:?} on grids up to {heavy:?} cells only"))
        .with_note(format!("{} solves not converged", outcome.not_converged));
    let path = study.out.join(SAMPLES);
    write_csv(&path, &tables::samples(&rungs)?, &header)?;
    outcome.files.push(path);
    outcome.files.extend(evaluate(&rungs, None, (&study.out, study.error), &header)?);
    let seconds = |model: &str| {
        let of = rungs.iter().filter(|r| r.model.name() == model);
        analysis::sum(of.flat_map(Rungs::pairs).map(GridPair::seconds))
    };
    (outcome.bem3d_seconds, outcome.mdr1d_seconds) = (Some(seconds("bem3d")), Some(seconds("mdr1d")));
    session.close(outcome).map(Judged::from)
}

/// Combines the tables of samples of runs with different seeds, and writes `exponent.csv` (curves and local
/// slopes), `exponent-levels.csv`, `exponent-laws.csv` (decades), `exponent-limit.csv` (towards zero force),
/// `exponent-ratio.csv`, `exponent-factor.csv`, the pictures of slopes and ratios, and `exponent.md` with
/// tables for a page. `exponent-tests.csv` is made from the samples of `tested` alone. Nothing is solved.
///
/// # Errors
/// [`runs::Error::File`] for a file that is not a table of samples or cannot be read or written,
/// [`runs::Error::Parameter`] for runs that cannot be combined.
pub fn exponent_of_samples(paths: &[PathBuf], tested: &[PathBuf], error: f64, out: &Path) -> Result<Judged> {
    require(error > 0.0 && error < 1.0, "error", error, "a share above 0 and below 1")?;
    let read = |paths: &[PathBuf]| -> Result<Vec<Rungs>> {
        samples::together(paths.iter().map(|path| samples::read(path)).collect::<Result<_>>()?)
    };
    files::create_directory(out)?;
    let list =
        |paths: &[PathBuf]| paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(",");
    let command =
        format!("cargo xtask exponent --samples {} --tested {} --error {error:?}", list(paths), list(tested));
    let mut outcome = Outcome::new("exponent");
    let other = if tested == paths { None } else { Some(read(tested)?) };
    outcome.files = evaluate(&read(paths)?, other.as_deref(), (out, error), &described(command))?;
    Ok(Judged::from(outcome))
}

fn described(command: String) -> Header {
    header(command)
        .with_sources(bem3d::Bem3d::default().sources())
        .with_sources(mdr1d::Mdr1d::default().sources())
        .with_note("multilevel Monte Carlo: M. B. Giles, Oper. Res. 56, 607 (2008); the surfaces of each level are independent, those of different D_f share phases")
}

/// The mean curves of pairs in both conventions.
fn curves(rungs: &[Rungs], error: f64) -> Result<Vec<MeanCurve>> {
    let both = rungs.iter().flat_map(|r| Convention::BOTH.map(|convention| (r, convention)));
    let mut curves: Vec<MeanCurve> =
        both.map(|(r, convention)| MeanCurve::new(r, convention, error)).collect::<Result<_>>()?;
    let order = |c: &MeanCurve| (c.model == "bem3d", c.convention != Convention::Measured);
    curves.sort_by(|a, b| order(a).cmp(&order(b)).then(a.fractal_dimension.total_cmp(&b.fractal_dimension)));
    Ok(curves)
}

/// All tables, pictures and texts of pairs; hypotheses are tested on `tested`, or on all.
fn evaluate(
    rungs: &[Rungs],
    tested: Option<&[Rungs]>,
    (out, error): (&Path, f64),
    header: &Header,
) -> Result<Vec<PathBuf>> {
    let curves = curves(rungs, error)?;
    let laws = laws::law_rows(&curves);
    let limits = laws::limits(&curves, families::LIMITS_TESTED);
    let tests = match tested {
        None => families::tests(&curves, &limits),
        Some(tested) => {
            let curves = self::curves(tested, error)?;
            let measured = curves.iter().filter(|c| c.convention == Convention::Measured);
            let judged = |curve| laws::judged_limit(curve, families::LIMITS_TESTED);
            families::tests(&curves, &measured.filter_map(judged).collect::<Vec<_>>())
        }
    };
    let (ratios, factors) = laws::ratios(&curves);
    let left_out: usize =
        curves.iter().filter(|c| c.convention == Convention::Measured).map(|c| c.left_out).sum();
    let header = header.clone().with_note(format!(
        "a curve is resolved where the discretisation error of its finest grid is at most {error:?} of k_bar; {left_out} pairs left out for a solve that did not converge"
    ));
    let tables: [(&str, Result<Table>); 7] = [
        (picture::CURVES, tables::curves(&curves)),
        ("exponent-levels.csv", tables::levels(&curves)),
        ("exponent-laws.csv", tables::laws(&laws)),
        ("exponent-limit.csv", tables::limits(&limits)),
        (picture::RATIOS, tables::ratios(&ratios)),
        ("exponent-factor.csv", tables::factors(&factors)),
        ("exponent-tests.csv", tables::tests(&tests)),
    ];
    let mut files = Vec::new();
    for (name, table) in tables {
        let path = out.join(name);
        write_csv(&path, &table?, &header)?;
        files.push(path);
    }
    files.extend(picture::draw(out)?);
    let text = out.join("exponent.md");
    let findings = StudyFindings { limits: &limits, laws: &laws, factors: &factors, tests: &tests };
    let report = report::report(&header.command, rungs, &findings);
    files::write_whole(&text, report.as_bytes())?;
    files.push(text);
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use runs::{CsvFile, Silent};

    fn quick(out: &std::path::Path) -> Exponent {
        Exponent {
            fractal_dimensions: vec![2.2, 2.8],
            out: out.to_owned(),
            error: 0.2,
            ..Exponent::new(ExponentSizes::Quick).unwrap()
        }
    }

    #[test]
    fn a_small_study_resumes_to_the_same_bytes() {
        let dir = tempfile::tempdir().unwrap();
        let study = quick(dir.path());
        let plan = exponent_plan(&study, 60.0, &Silent).unwrap();
        assert!(plan.iter().any(|line| line.contains("processor hours")), "{plan:?}");
        let read = || -> Vec<Vec<u8>> {
            let outcome = exponent(&study, &Silent).unwrap();
            outcome.files.iter().map(|file| std::fs::read(file).unwrap()).collect()
        };
        let first = read();
        assert_eq!(first, read());
        // Everything follows from the samples, but for the commands.
        let own = [dir.path().join(SAMPLES)];
        let other = tempfile::tempdir().unwrap();
        let again = exponent_of_samples(&own, &own, study.error, other.path()).unwrap();
        assert_eq!(again.files.len() + 1, first.len());
        for (file, before) in again.files.iter().zip(&first[1..]) {
            let rows = |text: &str| {
                let row = |line: &&str| !line.starts_with(['#', '`']);
                text.lines().filter(row).map(str::to_owned).collect::<Vec<_>>()
            };
            match (String::from_utf8(std::fs::read(file).unwrap()), String::from_utf8(before.clone())) {
                (Ok(now), Ok(before)) => assert_eq!(rows(&now), rows(&before), "{}", file.display()),
                (now, before) => assert_eq!(now.is_err(), before.is_err(), "{}", file.display()),
            }
        }
        let file = CsvFile::read(&dir.path().join("exponent.csv")).unwrap();
        let resolved = file.numbers("slope").unwrap().into_iter().flatten().count();
        assert!(resolved > 4, "{resolved} slopes");
        assert!(file.numbers("slope").unwrap().into_iter().flatten().all(|s| (0.2..1.2).contains(&s)));
    }

    #[test]
    fn sizes_that_make_no_sense_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let mut study = quick(dir.path());
        study.solid.surfaces.pop();
        let e = exponent(&study, &Silent).unwrap_err().to_string();
        assert!(e.starts_with("surfaces = 2 numbers: expected 3 numbers"), "{e}");
        let mut study = quick(dir.path());
        study.line.sizes[1] = 4;
        assert!(exponent(&study, &Silent).unwrap_err().to_string().starts_with("elements = 4"));
        assert!(exponent(&Exponent { error: f64::NAN, ..quick(dir.path()) }, &Silent).is_err());
    }
}
