//! Ensembles of rough surfaces and their accuracy: error budgets, accuracy targets, benchmarks, audits.
//!
//! How accurate is a mean over random surfaces? It has errors of the solver, of the grid and of the number of
//! surfaces. This module solves ensembles and states these errors.
//!
//! | item | what it does |
//! |---|---|
//! | [`Run`] | has the parameters of one command: those of a [`Preset`], overridden by a [`Request`] and checked |
//! | [`measure`] | solves the ensemble of a [`EnsembleModel`] |
//! | [`state_budgets`] | writes the error budgets of the means |
//! | [`plan`], [`settle`] | choose the sizes that meet an accuracy target |
//! | [`accuracy_cost`] | measures the time that accuracy costs |
//! | [`budget_check`] | tests whether the budgets hold |
//! | [`audit`] | solves stored states again |
//! | [`bench()`] | measures time |
//!
//! # Conventions
//!
//! * The normalised force is `F_bar = F/(E* h L)`, with the **measured** rms height h of each surface (Eq. 10
//!   of the paper). The normalised stiffness is `k_bar = k/(1.1419 E* L)` (Eq. 8).
//! * Means are arithmetic, over the surfaces whose solve converged. The logarithmic mean is given as well. A
//!   solve that does not converge is kept in the samples with its status, but left out of the means.
//! * A state with fewer than 10 contact cells depends on the grid. Such states are marked in every CSV, and
//!   left out of lines and fits.
//!
//! # Jobs
//!
//! An ensemble asks one question (`fractal_contact::scenes::Question`): surfaces of one fractal dimension on one
//! grid under all loads. Its jobs are those of a scene, and the store of the run keeps their states under the
//! same keys, so that other commands and scenes use them again. A [`Realisation`] is one surface of an ensemble.
//! Its [`RealisationResult`] is what is read from the states of its job: a [`Sample`] for each load, with the
//! normalised numbers of the paper.
//!
//! # What it does not do
//!
//! It has no mechanics of its own and no figure of the paper, which are in the modules beside it.

mod accuracy;
mod audit;
mod bench;
mod bench_plot;
mod budget;
mod fitted_laws;
mod forces;
mod header;
pub mod limits;
mod manifest;
mod measured;
mod outcome;
mod read_surfaces;
mod realisation;
mod realisation_jobs;
mod run;
mod sample;
mod session;
mod so_far;
mod square_map;
mod table_of;
mod tables;
mod tuning;

pub use accuracy::{
    AccuracyPlan, Coverage, Depth, accuracy_cost, accuracy_cost_jobs, budget_check, budget_check_jobs, plan,
    redraw_accuracy, settle,
};
pub use analysis::AccuracyTarget;
pub use audit::audit;
pub use bench::{BENCH_COLUMNS, Bench, BenchRow, Clock, Surfaces, bench, elapsed, parts_table, write_bench};
pub use bench_plot::{BenchPlot, plot_bench, redraw_benches};
pub use budget::{Budgeted, ErrorBudget, state_budgets, write_budget};
pub use fitted_laws::{WindowedLaw, dense_dimensions, law_over_forces_of, laws, windowed_law};
pub use forces::Forces;
pub use header::{PAPER, describe, flags, header};
pub use manifest::write_manifest;
pub use measured::{
    COARSER_SURFACES, Measured, Series, ensemble_jobs, measure, measure_showing, transformed,
};
pub use outcome::Outcome;
pub use realisation::{
    Discretisation, EnsembleModel, Realisation, RealisationResult, of_scene, realisation_jobs,
};
pub use realisation_jobs::{Workplace, is_solved, solve_realisations};
pub use run::{FRACTAL_DIMENSIONS, Flag, Preset, Request, Run, SEED, TOLERANCE, distinct, list};
pub use runs::{Error, Result};
pub use sample::{FLOOR_CELLS, Sample};
pub use session::Session;
pub use table_of::{TableOf, markdown_table, read_rows};
pub use tables::{FORCE_BAR, FRACTAL_DIMENSION, MODEL, compact_table, curves_table, samples_table};
pub use tuning::{ConstantRow, Multiple, tuning};
