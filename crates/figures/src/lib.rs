//! The figures of Pohrt, Popov and Filippov, Phys. Rev. E 86, 026710 (2012) as code: runs, tables, pictures, comparison.
//!
//! A [`Run`] holds the plain parameters of one command: a [`Preset`], overridden by a [`Request`] and checked. [`fig1`] .. [`fig7`]
//! take it, compute, write their CSV, draw their picture from that CSV, and give an [`Outcome`] with the paper's own claims beside
//! the numbers ([`Claim`]). [`verify`] judges them all, [`reproduce_all`] makes everything, [`check_reference`] compares a small run
//! with stored numbers.
//!
//! # Conventions
//!
//! * `F_bar = F/(E* h L)` with the **measured** rms height h of each surface; `k_bar = k/(1.1419 E* L)` (Eqs. 8, 10).
//! * Means are arithmetic over the surfaces whose solve converged; the logarithmic mean stands beside. A solve that does not
//!   converge is in the samples with its status, and in no mean.
//! * Fewer than 10 contact cells are the one-cell floor of the grid: kept in every CSV, marked, left out of lines and fits.
//! * CSV: `#` lines with title, columns and units, sources, parameters, version and the command that makes the same bytes; shortest
//!   decimals that read back to the same bits; absent is empty, never NaN. No times and no machine: those are in `manifest.json`.
//!
//! # Units, resume, threads
//!
//! The unit of work is one surface under all its loads ([`Unit`]), solved from the smallest load upwards with one prepared contact.
//! Finished units are stored in `DIR/.units/` under a hash of everything that decides their numbers, whole or not at all, and
//! checked on reading: a damaged or foreign unit is solved again. Figs. 3, 4, 7 and [`verify`] reuse the units of Figs. 2 and 6. Units
//! run in parallel, one per thread, the largest first; the results have the same bytes for any number of threads.
//!
//! # What it does not do
//!
//! No mechanics of its own, no argument parsing (that is `xtask`), no figure beyond the paper's but [`two_cases`] and [`accuracy_cost`].
//!
//! ```no_run
//! use figures::{Preset, Request, Run, Silent, fig2};
//! let run = Run::new(&Request { preset: Preset::Quick, ..Request::default() })?;
//! let outcome = fig2(&run, &Silent)?;
//! println!("{}", figures::plain(&outcome.claims));
//! # Ok::<(), figures::Error>(())
//! ```

#![allow(clippy::format_push_string, clippy::format_collect)] // Text is built once per file: clear beats one allocation less.

mod accuracy;
mod all;
mod arrays;
mod audit;
mod bench;
mod bench_plot;
mod budget;
mod chart;
mod claim;
mod claims;
mod csv_file;
mod curves;
mod error;
mod fig1;
mod fig2;
mod fig3;
mod fig4;
mod fig5;
mod fig6;
mod fig7;
mod files;
mod forces;
mod hard_cases;
mod job_queue;
mod laws;
mod manifest;
mod measured;
mod meters;
mod npy;
mod outcome;
mod plot;
mod progress;
mod reference;
mod reporter;
mod run;
mod sample;
mod session;
mod store;
mod sweep;
mod tables;
mod two_cases;
mod unit;
mod verify;

pub use accuracy::{
    AccuracyTarget, Coverage, Depth, Plan, Requirements, accuracy_cost, budget_check, plan, redraw_accuracy,
    settle,
};
pub use all::reproduce_all;
pub use arrays::{write_grey, write_npy};
pub use audit::audit;
pub use bem3d::Method;
pub use bench::{BENCH_COLUMNS, Bench, BenchRow, Surfaces, bench, write_bench};
pub use bench_plot::{BenchPlot, plot_bench};
pub use budget::{Budget, Budgeted, state_budgets};
pub use chart::{Chart, Curve};
pub use claim::{Claim, Verdict, markdown, plain, readme_table, sort};
pub use csv_file::{CsvFile, Header, PAPER, write_csv};
pub use error::{Error, Result};
pub use fig1::fig1;
pub use fig2::fig2;
pub use fig3::fig3;
pub use fig4::fig4;
pub use fig5::fig5;
pub use fig6::fig6;
pub use fig7::fig7;
pub use files::{clean, create_directory, write_whole};
pub use forces::Forces;
pub use hard_cases::hard_cases;
pub use job_queue::{largest_first, run_jobs};
pub use laws::{Law, laws};
pub use manifest::{machine, write_manifest};
pub use measured::{Measured, Series, measure_1d, measure_3d};
pub use meters::{peak_memory, reset_peak_memory};
pub use npy::read_map;
pub use outcome::Outcome;
pub use progress::{Progress, Silent};
pub use reference::{RELATIVE, check_reference};
pub use reporter::Reporter;
pub use run::{FRACTAL_DIMENSIONS, Flag, Preset, Request, Run, SEED, TOLERANCE};
pub use sample::{FIELDS, FLOOR_CELLS, Sample};
pub use stability::{Case, Effort, Verdict as CaseVerdict, cases};
pub use store::{Store, fnv1a_128};
pub use sweep::sweep;
pub use two_cases::{TwoCases, two_cases};
pub use unit::{FORMAT, Models, Numerics, Unit, UnitResult};
pub use verify::verify;
