//! The figures of Pohrt, Popov and Filippov, Phys. Rev. E 86, 026710 (2012) as code: runs, tables, pictures,
//! comparison.
//!
//! How does one repeat a figure of the paper and judge it? [`fig1`] to [`fig7`] do this for one figure each.
//! Such a function takes the parameters of one command ([`evaluation::Run`]), computes, and writes a CSV. It
//! draws the picture from that CSV. It returns an [`evaluation::Outcome`], in which the claims of the paper
//! are compared with the numbers ([`Judged`], [`Claim`]).
//!
//! ```no_run
//! use paper::evaluation::{Preset, Request, Run};
//! use runs::Silent;
//! let run = Run::new(&Request { preset: Preset::Quick, ..Request::default() })?;
//! let outcome = paper::fig2(&run, &Silent)?;
//! println!("{}", paper::plain(&outcome.claims));
//! # Ok::<(), runs::Error>(())
//! ```
//!
//! | item | what it does |
//! |---|---|
//! | [`verify`] | judges all claims |
//! | [`reproduce_all`] | makes all figures and judges the claims |
//! | [`check_reference`] | compares a small run with stored numbers |
//! | [`redraw`] | draws pictures again from their tables |
//!
//! Normalisation, means and error budgets are those of the module [`evaluation`]. Jobs and the store are those of
//! scenes (`fractal_contact::scenes`): a figure asks questions and reads the states of their jobs. CSV files are
//! those of `runs`.
//!
//! # What it does not do
//!
//! It has no mechanics of its own and no parsing of arguments (see `xtask`). Beyond the figures of the paper
//! it has only [`two_cases`], the study [`exponent()`] and its sequel for friction, [`partial_slip()`].

#![allow(clippy::format_push_string, clippy::format_collect)] // Text is built once per file: clear beats one allocation less.

mod all;
mod claim;
mod claims;
mod curves;
pub mod evaluation;
mod exponent;
mod fig1;
mod fig2;
mod fig3;
mod fig4;
mod fig5;
mod fig6;
mod fig7;
mod fitted;
mod judged;
mod output;
mod partial_slip;
mod redraw;
mod reference;
mod two_cases;
mod verify;
mod words;

pub use all::reproduce_all;
pub use claim::{
    Claim, Estimate, JudgedStatement, Statement, Verdict, counts, plain, short, short_table, sort,
    statements, together,
};
pub use exponent::{
    Exponent, ExponentSizes, Ladder, draw_exponent, exponent, exponent_of_samples, exponent_plan,
};
pub use fig1::fig1;
pub use fig2::fig2;
pub use fig3::fig3;
pub use fig4::fig4;
pub use fig5::fig5;
pub use fig6::fig6;
pub use fig7::fig7;
pub use judged::Judged;
pub use partial_slip::{PartialSlipSizes, PartialSlipStudy, draw_partial_slip, partial_slip};
pub use redraw::{Beside, redraw};
pub use reference::{RELATIVE, check_reference};
pub use two_cases::{TwoCases, two_cases, two_cases_jobs};
pub use verify::verify;
