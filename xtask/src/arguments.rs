//! The command line.

mod bench;
mod cluster;
mod sizes;
mod studies;
mod words;

pub use bench::BenchArguments;
pub use cluster::{PlanArguments, StudyShardsArguments, SubmitArguments};

use clap::{Parser, Subcommand};
use paper::evaluation::{AccuracyTarget, EnsembleModel, Request};
use runs::ShardChoice;
use sizes::{Both, LineSizes, Maps, ReducedSizes, Solid, SolveSizes};
use std::path::PathBuf;
pub use studies::WebArguments;
use studies::{
    AccuracyCost, Audit, BookArguments, BudgetCheck, PartialSlipArguments, Reference, StabilityArguments,
    TwoCasesArguments,
};
pub use studies::{ExponentArguments, Redraw, TuningArguments};

/// Reproduces Pohrt, Popov, Filippov, Phys. Rev. E 86, 026710 (2012): normal contact stiffness of fractal
/// rough surfaces.
///
/// Each figure is computed by real solves and written as CSV, SVG and PNG, and each number is compared with
/// the paper's own claim.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, after_long_help = AFTER)]
pub struct XtaskArguments {
    #[command(subcommand)]
    pub command: XtaskCommand,
}

const AFTER: &str = "\
Examples:
  cargo xtask reproduce-fig2                          3D curves, a few minutes on two cores
  cargo xtask reproduce-all --preset quick            everything, coarse
  cargo xtask reproduce-fig2 --cells 513 --surfaces 20 --fractal-dimensions 2.0,2.4
  cargo xtask reproduce-fig6 --forces 1e-9:20:60      60 loads, logarithmic, both ends in
  cargo xtask reproduce-fig2 --accuracy 5% --forces 0.1,1,20   settings for that, or what ten minutes leave
  cargo xtask verify                                  one line per claim of the paper
  cargo xtask reproduce-fig2 --preset paper           2049 cells, 60 surfaces: stop and resume at will
  cargo xtask reproduce-fig2 --preset extended --over data/figures/paper/fig2.csv   16385 cells, light loads
  cargo xtask submit --engine slurm --now reproduce-fig2 --preset paper --out DIR   its surfaces on a cluster; then status, merge

Results go to out/ (--out). Finished surfaces are kept in out/.units and reused by every command with the same parameters; an
interruption loses at most the surfaces in flight, and the same command resumes. The same command gives the same bytes of CSV
for any number of threads; times and the machine are in manifest.json.

Completion: alias xtask='cargo xtask'; source <(cargo xtask completions bash)

Exit codes: 0 done; 1 error; 2 bad arguments; 3 done, but some solves did not converge, stored numbers differ or a hard case fails; 130 stopped by Ctrl-C,
SIGTERM or SIGHUP; 141 nobody reads the output any more.";

const EXPAND: &str = "Run with --help for every flag.";

#[derive(Debug, Subcommand)]
pub enum XtaskCommand {
    /// Grey-scale maps of the six surfaces (CSV, NPY, PNG).
    #[command(after_help = EXPAND)]
    ReproduceFig1(Maps),
    /// Stiffness over force, 3D boundary elements.
    #[command(after_help = EXPAND)]
    ReproduceFig2(Solid),
    /// Exponent alpha over the fractal dimension, 3D and 1D.
    #[command(after_help = EXPAND)]
    ReproduceFig3(Both),
    /// Collapse of the 3D curves onto one curve.
    #[command(after_help = EXPAND)]
    ReproduceFig4(Solid),
    /// Three equivalent rough lines (CSV, NPY).
    #[command(after_help = EXPAND)]
    ReproduceFig5(LineSizes),
    /// Stiffness over force, 1D reduction.
    #[command(after_help = EXPAND)]
    ReproduceFig6(ReducedSizes),
    /// Factor zeta over the fractal dimension, 3D and 1D.
    #[command(after_help = EXPAND)]
    ReproduceFig7(Both),
    /// All seven figures and the verification.
    #[command(after_help = EXPAND)]
    ReproduceAll(Both),
    /// Compares every claim of the paper with the numbers found here, disagreements first (verify.csv,
    /// verify.md).
    #[command(after_help = EXPAND)]
    Verify(Both),
    /// Measures the cost of single solves: work, time, memory and certificate.
    #[command(after_long_help = bench::HELP)]
    Bench(BenchArguments),
    /// Measures the cost of half and of twice the value of each tuned constant of the solver on this machine
    /// (tuning.csv).
    Tuning(TuningArguments),
    /// Measures the time that accuracy costs: one family of problems, solved with every method
    /// (accuracy-cost.csv, .md and picture).
    #[command(after_help = EXPAND)]
    AccuracyCost(AccuracyCost),
    /// Coverage of the error budgets: random surfaces, loads, grids and tolerances against references
    /// (budget-check.csv).
    #[command(after_help = EXPAND)]
    BudgetCheck(BudgetCheck),
    /// Compares the two problems of Sec. II of the paper, a free fractal surface and a periodic one with a
    /// roll-off, and the theories of Persson and of Greenwood and Williamson.
    #[command(after_help = EXPAND)]
    ReproduceTwoCases(TwoCasesArguments),
    /// The exponent of stiffness over force with confidence bands, from surfaces solved on neighbouring grids
    /// (exponent.csv and others).
    #[command(after_help = EXPAND)]
    Exponent(ExponentArguments),
    /// Partial slip of rough surfaces cell by cell: the ratio of tangential to normal stiffness, and the
    /// error of approximations by the normal contact (partial-slip.csv and others).
    #[command(after_help = EXPAND)]
    PartialSlip(PartialSlipArguments),
    /// Predicts what a command needs on many machines: jobs, core-hours, memory of a task, makespan, disk.
    /// Solves nothing.
    Plan(PlanArguments),
    /// Writes a batch script for SLURM or HyperQueue that runs the shards of a command and merges them; with
    /// --now submits it. Finished jobs are not run again.
    Submit(SubmitArguments),
    /// Lists which shards in a directory are done, running, failed or missing.
    Status(StudyShardsArguments),
    /// Makes tables and pictures from the shards in a directory, byte for byte those of a single process.
    /// Refuses missing or damaged shards and mixed plans.
    Merge(StudyShardsArguments),
    /// Solves a random share of the states of Fig. 2 again, from a cold start and to a tight tolerance
    /// (audit.csv).
    #[command(after_help = EXPAND)]
    Audit(Audit),
    /// Draws every picture of directories again from their tables; solves nothing and changes no table.
    Redraw(Redraw),
    /// Compares a small fixed run of Figs. 2 and 6 with the numbers in data/reference (for continuous
    /// integration).
    CheckReference(Reference),
    /// Solves the hard cases, and says why each is hard, what is asserted and which value was reached
    /// (stability.csv, stability.md).
    Stability(StabilityArguments),
    /// Prints a script that completes arguments in a shell, for the program `xtask` or an alias of that name.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Checks the links and formulas of every Markdown file, the commands and pictures of the book, and its
    /// pages where mdbook is installed.
    Book(BookArguments),
    /// Builds the page of the browser: a folder that a server of files serves, and one file that opens from a folder.
    Web(WebArguments),
}

impl XtaskCommand {
    /// The sizes of the solves of a figure, and the ensembles that it needs.
    fn solved(&self) -> Option<(&SolveSizes, &'static [EnsembleModel])> {
        Some(match self {
            Self::ReproduceFig2(a) | Self::ReproduceFig4(a) => (&a.solve, &[EnsembleModel::Bem3d]),
            Self::ReproduceFig6(a) => (&a.solve, &[EnsembleModel::Mdr1d]),
            Self::ReproduceFig3(a) | Self::ReproduceFig7(a) | Self::ReproduceAll(a) | Self::Verify(a) => {
                (&a.solve, &EnsembleModel::BOTH)
            }
            _ => return None,
        })
    }

    /// The ensembles that a figure needs.
    pub fn models(&self) -> Option<&'static [EnsembleModel]> {
        self.solved().map(|(_, models)| models)
    }

    /// The accuracy that was requested of a figure, and the ensembles that it needs.
    pub fn target(&self) -> Option<(&'static [EnsembleModel], AccuracyTarget)> {
        let (solve, models) = self.solved()?;
        Some((models, solve.target()?))
    }

    /// The requested shard.
    pub fn shard(&self) -> Option<ShardChoice> {
        let sharded = match self {
            Self::Audit(a) => &a.solid.solve.sharded,
            Self::Exponent(a) => &a.sharded,
            Self::BudgetCheck(a) => &a.sharded,
            Self::ReproduceTwoCases(a) => &a.sharded,
            Self::AccuracyCost(a) => &a.sharded,
            figure => &figure.solved()?.0.sharded,
        };
        sharded.shard
    }

    /// Directory of the results.
    pub fn out(&self) -> PathBuf {
        self.request().out.unwrap_or_else(|| "out".into())
    }

    /// The request of these flags.
    pub fn request(&self) -> Request {
        let mut request = Request::default();
        match self {
            Self::ReproduceFig1(a) => a.fill(&mut request),
            Self::ReproduceFig2(a) | Self::ReproduceFig4(a) => a.fill(&mut request),
            Self::ReproduceFig5(a) => a.fill(&mut request),
            Self::ReproduceFig6(a) => a.fill(&mut request),
            Self::ReproduceFig3(a) | Self::ReproduceFig7(a) | Self::ReproduceAll(a) | Self::Verify(a) => {
                a.fill(&mut request);
            }
            Self::Audit(a) => a.solid.fill(&mut request),
            Self::Exponent(a) => a.fill(&mut request),
            Self::PartialSlip(a) => a.fill(&mut request),
            Self::BudgetCheck(a) => (request.out, request.threads) = (Some(a.out.clone()), Some(a.threads)),
            Self::ReproduceTwoCases(a) => (request.out, request.threads) = (Some(a.out.clone()), a.threads),
            Self::AccuracyCost(a) => (request.out, request.fresh) = (Some(a.out.clone()), a.fresh),
            Self::CheckReference(a) => request.out = Some(a.out.clone()),
            Self::Stability(a) => request.out = Some(a.out.clone()),
            _ => {}
        }
        request
    }
}

#[cfg(test)]
mod tests {
    use super::bench::{SCALING_CELLS, SCALING_CSV};
    use super::*;
    use clap::CommandFactory as _;
    use paper::evaluation::{Preset, Surfaces};

    fn parse(line: &str) -> Result<XtaskArguments, clap::Error> {
        XtaskArguments::try_parse_from(std::iter::once("xtask").chain(line.split_whitespace()))
    }

    #[test]
    fn the_command_line_is_well_formed() {
        XtaskArguments::command().debug_assert();
    }

    #[test]
    fn every_figure_has_the_same_flags() {
        let arguments = parse(
            "verify --preset paper --cells 9 --surfaces 2 --elements 64 --lines 3 --fractal-dimensions 2.0,2.2 \
             --forces 1e-2:20:4 --tolerance 1e-3 --seed 7 --threads 2 --out d --fresh",
        )
        .unwrap();
        let request = arguments.command.request();
        let expected = Request {
            preset: Preset::Paper,
            cells: Some(9),
            surfaces: Some(2),
            elements: Some(64),
            lines: Some(3),
            fractal_dimensions: Some(vec![2.0, 2.2]),
            forces: Some("1e-2:20:4".into()),
            tolerance: Some(1e-3),
            seed: Some(7),
            threads: Some(2),
            out: Some("d".into()),
            fresh: true,
            over: None,
            samples: None,
        };
        assert_eq!(request, expected);
        assert!(matches!(arguments.command, XtaskCommand::Verify(_)));
    }

    #[test]
    fn flags_that_do_not_apply_are_refused() {
        for line in [
            "verify --samples d --fresh",
            "verify --samples d --accuracy 2%",
            "verify --samples d --shard 0/2",
            "reproduce-fig1 --surfaces 2",
            "reproduce-fig1 --threads 2",
            "reproduce-fig2 --elements 64",
            "reproduce-fig5 --cells 9",
            "reproduce-fig6 --tolerance 1e-3",
            "reproduce-fig2 --preset huge",
            "reproduce-fig2 --cells -3",
            "reproduce-fig2 --fractal-dimensions 2.0,x",
            "reproduce-fig8",
            "bench --boundary clamped",
            "bench --surface a.npy --cells 9",
            "bench --surface a.npy --seed 2",
            "bench --surface a.npy --scaling",
            "bench --plot a.svg",
            "bench --cells 9,x",
            "bench --threads -1",
            "bench --method magic",
            "bench --preset paper",
            "stability --preset quick",
            "redraw",
            "accuracy-cost --redraw",
            "reproduce-fig2 --unknown",
            "",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
        // The parser lets a negative force through; the run then refuses it by name.
        assert!(parse("reproduce-fig2 --forces -1").is_ok());
    }

    fn bench(line: &str) -> BenchArguments {
        match parse(line).unwrap().command {
            XtaskCommand::Bench(options) => options,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn flags_of_the_bench_give_its_loads_and_files() {
        let asked = bench(
            "bench --surface a.npy --sweep 1:100:3,20 --tolerance 1e-8,1e-3 --csv d/t.csv --pressure p",
        );
        assert_eq!(asked.files(), (Some("d/t.csv".into()), None));
        let asked = asked.bench().unwrap();
        assert_eq!(asked.forces.values(), [1.0, 10.0, 20.0, 100.0]);
        assert_eq!(asked.forces.asked(), [1.0, 10.0, 100.0, 20.0]);
        assert_eq!((asked.tolerances.len(), asked.cold, asked.threads), (2, false, 1));
        assert_eq!(asked.pressure, Some("p".into()));
        assert!(matches!(asked.surfaces, Surfaces::File(_)));

        let scaling = bench("bench --scaling --df 2.4");
        assert_eq!(scaling.files(), (Some(SCALING_CSV.into()), Some("out/bench-scaling.svg".into())));
        let scaling = scaling.bench().unwrap();
        let Surfaces::SelfAffine { cells, fractal_dimensions, .. } = scaling.surfaces else { panic!() };
        assert_eq!((cells, fractal_dimensions, scaling.cold), (SCALING_CELLS.to_vec(), vec![2.4], true));

        // Values that the parser allows and the bench refuses.
        for line in ["bench --forces -1", "bench --forces 1:2"] {
            assert!(bench(line).bench().unwrap_err().to_string().starts_with("forces = "), "{line}");
        }
    }

    #[test]
    fn an_accuracy_target_is_a_share_and_a_time() {
        let target = |line: &str| parse(line).unwrap().command.target();
        let (models, asked) = target("reproduce-fig2 --accuracy 1% --budget 2h").unwrap();
        assert_eq!(
            (models, asked),
            (&[EnsembleModel::Bem3d][..], AccuracyTarget { share: 0.01, seconds: 7200.0 })
        );
        let (models, asked) = target("verify --accuracy 0.05").unwrap();
        assert_eq!(
            (models, asked),
            (&EnsembleModel::BOTH[..], AccuracyTarget { share: 0.05, seconds: 600.0 })
        );
        assert!(target("reproduce-fig6").is_none() && target("bench").is_none());
        for line in [
            "reproduce-fig2 --accuracy 0",
            "reproduce-fig2 --accuracy 100%",
            "reproduce-fig2 --accuracy many",
            "reproduce-fig2 --accuracy 1% --budget 0s",
            "reproduce-fig2 --accuracy 1% --budget 5d",
            "reproduce-fig2 --budget 5s",
            "reproduce-fig1 --accuracy 1%",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
    }

    #[test]
    fn no_flags_is_the_default_run() {
        let request = parse("reproduce-fig2").unwrap().command.request();
        assert_eq!(request, Request { threads: Some(0), out: Some("out".into()), ..Request::default() });
    }
}
