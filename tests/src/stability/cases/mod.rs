//! The registry of hard cases.

mod adhesion;
mod chance;
mod few;
mod friction;
mod friction_paths;
mod hardness;
mod interface;
mod kernels;
mod limits;
mod periodic;
mod range;
mod rectangles;
mod shapes;
mod short_range;
mod surfaces;
mod ties;
mod units;

use crate::stability::case::HardCase;

/// Every hard case, in the order of the table.
///
/// ```
/// assert!(tests::stability::cases().iter().all(|c| !c.why.is_empty() && !c.asserted.is_empty()));
/// ```
pub fn cases() -> Vec<HardCase> {
    [
        &few::CASES[..],
        &ties::CASES,
        &surfaces::CASES,
        &shapes::CASES,
        &range::CASES,
        &units::CASES,
        &periodic::CASES,
        &rectangles::CASES,
        &limits::CASES,
        &hardness::CASES,
        &adhesion::CASES,
        &short_range::CASES,
        &friction::CASES,
        &friction_paths::CASES,
        &kernels::CASES,
        &interface::CASES,
        &chance::CASES,
    ]
    .concat()
}
