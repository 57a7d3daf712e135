//! The project's runner: `cargo xtask reproduce-fig1` .. `reproduce-fig7`, `reproduce-all`, `verify`,
//! `audit`, `bench`, `reproduce-two-cases`, `accuracy-cost`, `budget-check`, `exponent`,
//! `partial-slip`, `redraw`, `check-reference`, `stability`, `book`.
//!
//! Argument parsing and exit codes, the table of hard cases and the check of the book; the figures are in the crate
//! `paper`.
//!
//! Exit codes: 0 done, 1 an error (its message says where), 2 bad arguments, 3 done but some solves did not
//! converge, stored numbers differ, a hard case fails, error budgets do not hold or a link or command of the
//! book is broken, 130 stopped by a signal, 141 standard output was closed by its reader.

mod arguments;
mod book;
mod cluster;
mod hard_cases;
mod web;

use arguments::{BenchArguments, ExponentArguments, Redraw, TuningArguments, XtaskArguments, XtaskCommand};
use clap::{CommandFactory as _, Parser as _};
use paper::evaluation::{BenchRow, Outcome, Run};
use paper::{Claim, Judged};
use runs::{Error, Failure, Reporter, Result, Store};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::{Duration, Instant};
use tests::stability::Effort;

fn main() -> ExitCode {
    // A path that is not valid UTF-8 is still a path.
    let typed: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let command = XtaskArguments::parse().command;
    let asked = std::env::var_os(runs::THREADS_VARIABLE);
    let done = runs::with_threads(asked.as_deref(), || execute(&command, &typed));
    match done.map_err(Failure::from).and_then(|done| done) {
        Ok(code) => code,
        Err(error) => {
            runs::err!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn execute(command: &XtaskCommand, typed: &[String]) -> Result<ExitCode, Failure> {
    if let Some(choice) = command.shard() {
        tell_what_an_interruption_leaves(command.out())?;
        return cluster::shard(command, choice, typed).map(|()| ExitCode::SUCCESS);
    }
    match command {
        XtaskCommand::Plan(options) => cluster::plan(options)?,
        XtaskCommand::Submit(options) => cluster::submit(options)?,
        XtaskCommand::Status(options) => {
            if !cluster::tell_status(options)?.complete() {
                return Ok(ExitCode::from(3));
            }
        }
        XtaskCommand::Merge(options) => {
            let (command, typed) = cluster::merged(options)?;
            return Ok(solve(&command, &typed)?);
        }
        _ => return Ok(solve(command, typed)?),
    }
    Ok(ExitCode::SUCCESS)
}

fn solve(command: &XtaskCommand, typed: &[String]) -> Result<ExitCode> {
    match command {
        XtaskCommand::CheckReference(options) => check_reference(options.bless, &options.out),
        XtaskCommand::Stability(options) => stability(options.thorough, &options.out),
        XtaskCommand::Bench(options) => bench(options),
        XtaskCommand::Tuning(options) => tuning(options),
        XtaskCommand::Redraw(options) => redraw(options),
        XtaskCommand::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut XtaskArguments::command(), "xtask", &mut script);
            runs::print(format_args!("{}", String::from_utf8_lossy(&script)));
            Ok(ExitCode::SUCCESS)
        }
        XtaskCommand::Book(options) => book::book(options.pictures),
        XtaskCommand::Web(options) => web::build(options).map(|()| ExitCode::SUCCESS),
        _ => study(command, typed),
    }
}

/// Solves what a figure or a study needs, writes its files and the manifest, and compares its numbers with the
/// paper.
fn study(command: &XtaskCommand, typed: &[String]) -> Result<ExitCode> {
    let reporter = Reporter::new();
    if let Some(out) = command.request().out {
        tell_what_an_interruption_leaves(out)?;
    }
    let run = settled_run(command, &reporter)?;
    let Some(StudyResults { mut outcomes, coverage_fails }) = results(command, &run, &reporter)? else {
        return Ok(ExitCode::SUCCESS);
    };
    if let Some((models, _)) = command.target()
        && outcomes.iter().all(|o| o.reached.is_empty())
    {
        let budgets = paper::evaluation::state_budgets(&run, models, &reporter)?;
        outcomes.push(budgets.into());
    }
    // The first word that was typed is the subcommand: no flag stands before it.
    let name = typed.first().map_or("", String::as_str);
    let claims = judged(&outcomes);
    let outcomes: Vec<Outcome> = outcomes.into_iter().map(Judged::into_outcome).collect();
    let manifest = paper::evaluation::write_manifest(
        &run,
        name,
        &format!("cargo xtask {}", typed.join(" ")),
        &outcomes,
    )?;
    let code = report(&outcomes, &claims, &manifest);
    Ok(if coverage_fails { ExitCode::from(3) } else { code })
}

/// The sizes of a command: those of its flags or, where an accuracy was requested, those that reach it.
fn settled_run(command: &XtaskCommand, reporter: &Reporter) -> Result<Run> {
    let Some((models, target)) = command.target() else { return Run::new(&command.request()) };
    let plan = paper::evaluation::plan(&command.request(), models, target, reporter)?;
    plan.lines.iter().for_each(|line| runs::out!("{line}"));
    let told = plan.lines.len();
    let settled = paper::evaluation::settle(plan, models, target, reporter)?;
    settled.lines.iter().skip(told).for_each(|line| runs::out!("{line}"));
    // The pilots have just been solved and are not solved again.
    Ok(Run { fresh: false, ..settled.run })
}

/// What a command found.
struct StudyResults {
    outcomes: Vec<Judged>,
    /// Whether error budgets do not hold.
    coverage_fails: bool,
}

/// Does the work of a figure or a study; `None` where only a plan was requested.
fn results(command: &XtaskCommand, run: &Run, reporter: &Reporter) -> Result<Option<StudyResults>> {
    let mut coverage_fails = false;
    let outcomes = match command {
        XtaskCommand::ReproduceFig1(_) => vec![paper::fig1(run, reporter)?],
        XtaskCommand::ReproduceFig2(_) => vec![paper::fig2(run, reporter)?],
        XtaskCommand::ReproduceFig3(_) => vec![paper::fig3(run, reporter)?],
        XtaskCommand::ReproduceFig4(_) => vec![paper::fig4(run, reporter)?],
        XtaskCommand::ReproduceFig5(_) => vec![paper::fig5(run, reporter)?],
        XtaskCommand::ReproduceFig6(_) => vec![paper::fig6(run, reporter)?],
        XtaskCommand::ReproduceFig7(_) => vec![paper::fig7(run, reporter)?],
        XtaskCommand::Verify(_) => vec![paper::verify(run, reporter)?],
        XtaskCommand::ReproduceAll(_) => paper::reproduce_all(run, reporter)?,
        XtaskCommand::AccuracyCost(options) => {
            let kept = (options.out.as_path(), options.fresh);
            vec![paper::evaluation::accuracy_cost(options.depth, options.seed, kept, reporter)?.into()]
        }
        XtaskCommand::ReproduceTwoCases(options) => {
            vec![paper::two_cases(&options.study()?, &options.out, reporter)?]
        }
        XtaskCommand::BudgetCheck(options) => {
            let (cases, seed) = (options.cases, options.seed);
            let (outcome, coverage) =
                paper::evaluation::budget_check(cases, seed, run.threads, &run.out, reporter)?;
            runs::out!("{coverage}");
            coverage_fails = !coverage.holds();
            vec![outcome.into()]
        }
        XtaskCommand::Exponent(options) => match exponent(options, run, reporter)? {
            Some(outcome) => vec![outcome],
            None => return Ok(None),
        },
        XtaskCommand::PartialSlip(options) => vec![paper::partial_slip(&options.study(run)?, reporter)?],
        XtaskCommand::Audit(options) => {
            let (outcome, summary) = paper::evaluation::audit(run, options.share, options.tight, reporter)?;
            runs::out!("{summary}");
            vec![outcome.into()]
        }
        // They are no studies.
        _ => Vec::new(),
    };
    Ok(Some(StudyResults { outcomes, coverage_fails }))
}

/// The study of exponents, from samples where they are given; `None` where only its plan was requested.
fn exponent(options: &ExponentArguments, run: &Run, reporter: &Reporter) -> Result<Option<Judged>> {
    if !options.samples.is_empty() {
        let tested = if options.tested.is_empty() { &options.samples } else { &options.tested };
        return paper::exponent_of_samples(&options.samples, tested, options.error, &run.out).map(Some);
    }
    let study = options.study(run)?;
    for line in paper::exponent_plan(&study, options.budget, reporter)? {
        runs::out!("{line}");
    }
    if options.plan {
        return Ok(None);
    }
    // `--fresh` has already been applied by the plan.
    paper::exponent(&paper::Exponent { fresh: false, ..study }, reporter).map(Some)
}

fn redraw(options: &Redraw) -> Result<ExitCode> {
    for directory in &options.directories {
        for file in paper::redraw(directory, &options.beside())? {
            runs::out!("{}", file.display());
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Ctrl-C, SIGTERM and SIGHUP end the process at once. Results are kept, of a surface in hand the states so far;
/// the state that is being solved is lost. Where the system grants no thread for the message, the process ends
/// without it.
fn tell_what_an_interruption_leaves(out: PathBuf) -> Result<()> {
    let tell = move || {
        let (count, units) = (Store::count(&out), out.join(".units"));
        runs::err!(
            "\nstopped: {count} results, finished or begun, are kept in {}; the same command goes on with the rest",
            units.display()
        );
        std::process::exit(130);
    };
    // A handler without its thread would swallow the signals.
    if !runs::grants_a_thread() {
        runs::err!("note: the system grants no thread: Ctrl-C ends the command without a message");
        return Ok(());
    }
    ctrlc::set_handler(tell).map_err(|e| Error::parameter("Ctrl-C", e, "a signal that can be handled"))
}

/// The claims that these outcomes can judge: those of the verification, where it is among them.
fn judged(outcomes: &[Judged]) -> Vec<Claim> {
    if let Some(verified) = outcomes.iter().find(|outcome| outcome.name == "verify") {
        return verified.claims.clone();
    }
    let mut all: Vec<Claim> = outcomes.iter().flat_map(|outcome| outcome.claims.iter().cloned()).collect();
    paper::sort(&mut all);
    all
}

/// Prints the files that were written and the comparison with the paper.
fn report(outcomes: &[Outcome], claims: &[Claim], manifest: &Path) -> ExitCode {
    for outcome in outcomes {
        for file in &outcome.files {
            runs::out!("{}", file.display());
        }
    }
    runs::out!("{}", manifest.display());
    for line in outcomes.iter().flat_map(|o| &o.reached) {
        runs::out!("{line}");
    }
    if !claims.is_empty() {
        runs::out!("\nThese numbers compared with the paper:\n\n{}", paper::plain(claims));
    }
    let seconds: f64 = outcomes.iter().map(|o| o.seconds).sum();
    let missing = outcomes.iter().map(|o| o.not_converged).max().unwrap_or(0);
    if missing == 0 {
        runs::out!("done in {seconds:.1} s");
        return ExitCode::SUCCESS;
    }
    runs::out!(
        "done in {seconds:.1} s, but {missing} solves did not converge: the samples hold them with their status, and the means leave them out"
    );
    ExitCode::from(3)
}

/// Prints each row when it is solved and keeps the file complete, so that an interruption loses nothing; at
/// the end the rows of the file are in the requested order.
fn bench(options: &BenchArguments) -> Result<ExitCode> {
    let (csv, plot) = options.files();
    if let Some(directory) = csv.as_deref().and_then(Path::parent) {
        runs::files::create_directory(directory)?;
    }
    let clock: Option<paper::evaluation::Clock> =
        if options.parts { Some(paper::evaluation::elapsed) } else { None };
    let table = Mutex::new(BenchTable::default());
    let rows = paper::evaluation::bench(&options.bench()?, clock, &|row| {
        // A poisoned lock means that another thread panicked: that is reported elsewhere.
        let Ok(mut table) = table.lock() else { return Ok(()) };
        if table.rows.is_empty() {
            runs::out!("{}", printed(row).map(|(name, width)| format!("{name:>width$}")).join(" "));
        }
        runs::out!("{}", line(row)?);
        table.rows.push(row.clone());
        csv.as_deref().map_or(Ok(()), |path| table.write(path))
    })?;
    if let Some(path) = &csv {
        paper::evaluation::write_bench(path, &rows)?;
        runs::out!("{}", path.display());
        if let Some(picture) = &plot {
            let drawn = paper::evaluation::plot_bench(path, picture)?;
            drawn.files.iter().for_each(|file| runs::out!("{}", file.display()));
            drawn.slopes.iter().for_each(|slope| runs::out!("{slope}"));
        }
    }
    if options.parts {
        for line in paper::evaluation::parts_table(&rows) {
            runs::out!("{line}");
        }
    }
    let missing = rows.iter().filter(|row| !row.converged()).count();
    if missing > 0 {
        runs::out!("{missing} of {} solves did not converge", rows.len());
        return Ok(ExitCode::from(3));
    }
    Ok(ExitCode::SUCCESS)
}

/// The rows so far and when they were written last.
#[derive(Default)]
struct BenchTable {
    rows: Vec<BenchRow>,
    /// End and length of the last writing.
    written: Option<(Instant, Duration)>,
}

impl BenchTable {
    /// Writes the rows unless that would take more than a twentieth of the time: a long table of cheap rows
    /// is written now and then.
    fn write(&mut self, path: &Path) -> Result<()> {
        let start = Instant::now();
        if self.written.is_some_and(|(end, took)| start.duration_since(end) < 20 * took) {
            return Ok(());
        }
        paper::evaluation::write_bench(path, &self.rows)?;
        self.written = Some((Instant::now(), start.elapsed()));
        Ok(())
    }
}

/// Columns on the terminal and their widths.
const PRINTED: [(&str, usize); 16] = [
    ("cells", 6),
    ("fractal_dimension", 17),
    ("tolerance", 9),
    ("force_bar", 10),
    ("approach_over_h", 16),
    ("stiffness_bar", 14),
    ("contact_cells", 13),
    ("duality_gap", 11),
    ("stiffness_error", 15),
    ("iterations", 10),
    ("applications", 12),
    ("seconds", 9),
    ("cpu_seconds", 11),
    ("peak_memory_bytes", 17),
    ("status", 10),
    ("strategy", 8),
];

/// [`PRINTED`] with the mean gap in the place of the approach where the square repeats itself.
fn printed(row: &BenchRow) -> [(&'static str, usize); PRINTED.len()] {
    let replace = |(name, width)| match name {
        "approach_over_h" if row.state.mean_gap.is_some() => ("mean_gap_over_h", width),
        _ => (name, width),
    };
    PRINTED.map(replace)
}

fn line(row: &BenchRow) -> Result<String> {
    let fields = row.fields()?;
    let field = |name: &str| {
        paper::evaluation::BENCH_COLUMNS.iter().position(|c| *c == name).map_or("", |i| &fields[i])
    };
    let short = |name: &str| match (name, field(name).parse::<f64>()) {
        ("approach_over_h" | "mean_gap_over_h" | "stiffness_bar", Ok(v)) => format!("{v:.10}"),
        ("duality_gap" | "stiffness_error" | "force_bar", Ok(v)) => format!("{v:.2e}"),
        ("seconds" | "cpu_seconds", Ok(v)) => format!("{v:.4}"),
        _ => field(name).to_owned(),
    };
    Ok(printed(row).map(|(name, width)| format!("{:>width$}", short(name))).join(" "))
}

/// Prints the measurement of each constant when it is done.
fn tuning(options: &TuningArguments) -> Result<ExitCode> {
    let TuningArguments { only, repetitions, out } = options;
    let header = std::sync::Once::new();
    let print = |row: &paper::evaluation::ConstantRow| {
        header.call_once(|| {
            let (name, time, work) = ("constant", "time, half", "applications, half");
            runs::out!("{name:<22} {time:>10} {:>10} {work:>18} {:>18}", "twice", "twice");
        });
        let paper::evaluation::ConstantRow { name, half, twice } = *row;
        let missed = if half.converged && twice.converged { "" } else { "  not all loads converged" };
        let (a, b) = (half.applications, twice.applications);
        runs::out!("{name:<22} {:>10.2} {:>10.2} {a:>18.2} {b:>18.2}{missed}", half.time, twice.time);
    };
    let path = paper::evaluation::tuning(only, usize::from(*repetitions), out, &Reporter::new(), &print)?;
    runs::out!("{}", path.display());
    Ok(ExitCode::SUCCESS)
}

/// Prints the table of hard cases; one that fails does not stop the others.
fn stability(thorough: bool, out: &Path) -> Result<ExitCode> {
    let effort = if thorough { Effort::Thorough } else { Effort::Quick };
    let (verdicts, files) =
        hard_cases::hard_cases(&tests::stability::cases(), effort, out, &Reporter::new())?;
    for v in &verdicts {
        let figure = v.figure.map_or_else(|| "no figure".to_owned(), |f| format!("{f:.1e}"));
        runs::out!("{:<6}  {:<38} {figure:>9} of {:.0e}", v.status(), v.case.name, v.case.bound);
        runs::out!("        why: {}", v.case.why);
        runs::out!("        asserted: {}", v.case.asserted);
        v.broken.iter().for_each(|line| runs::out!("        broken: {line}"));
    }
    for file in &files {
        runs::out!("{}", file.display());
    }
    let failed = verdicts.iter().filter(|v| !v.passed()).count();
    runs::out!("{} of {} hard cases pass", verdicts.len() - failed, verdicts.len());
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(3) })
}

fn check_reference(bless: bool, out: &Path) -> Result<ExitCode> {
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference");
    let differences = paper::check_reference(&reference, &out.join("reference"), bless, &Reporter::new())?;
    for line in &differences {
        runs::out!("{line}");
    }
    if differences.is_empty() {
        let relative = paper::RELATIVE;
        runs::out!("{}", if bless { "stored".to_owned() } else { format!("equal to {relative:e}") });
        return Ok(ExitCode::SUCCESS);
    }
    runs::out!("{} differences (--bless stores the new numbers)", differences.len());
    Ok(ExitCode::from(3))
}
