//! The figures of Pohrt, Popov and Filippov, Phys. Rev. E 86, 026710 (2012) as code: runs, tables, pictures,
//! comparison.
//!
//! [`fig1`] .. [`fig7`] take the parameters of one command ([`evaluation::Run`]), compute, write their CSV,
//! draw their picture from that CSV, and return an [`evaluation::Outcome`] with the paper's own claims
//! compared with the numbers ([`Judged`], [`Claim`]). [`verify`] judges all claims, [`reproduce_all`] makes
//! all figures and judges the claims, [`check_reference`] compares a small run with stored numbers, and
//! [`redraw`] draws pictures again from their tables.
//!
//! Normalisation, means, jobs and the store are those of `evaluation`; CSV files those of `runs`.
//!
//! # What it does not do
//!
//! It has no mechanics of its own, no argument parsing (see `xtask`), and no figures beyond those of the
//! paper except [`two_cases`], [`exponent()`] and its sequel for friction, [`partial_slip()`].
//!
//! ```no_run
//! use evaluation::{Preset, Request, Run};
//! use runs::Silent;
//! let run = Run::new(&Request { preset: Preset::Quick, ..Request::default() })?;
//! let outcome = paper::fig2(&run, &Silent)?;
//! println!("{}", paper::plain(&outcome.claims));
//! # Ok::<(), runs::Error>(())
//! ```

#![allow(clippy::format_push_string, clippy::format_collect)] // Text is built once per file: clear beats one allocation less.

mod all;
mod claim;
mod claims;
mod curves;
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
pub use partial_slip::{PartialSlip, PartialSlipSizes, draw_partial_slip, partial_slip};
pub use redraw::{Beside, redraw};
pub use reference::{RELATIVE, check_reference};
pub use two_cases::{TwoCases, two_cases, two_cases_jobs};
pub use verify::verify;
