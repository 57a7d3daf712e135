//! The tuned constants of a solve: meaning, unit and value.
//!
//! Those of adhesion are defined beside their iterations (`adhesion`, `model/adhesive_stiffness`). The book's
//! page on tuned constants lists all numeric constants of this crate and, of those in [`Tuning`], the
//! measured cost of half and of twice the value.
//!
//! None of these numbers changes the limit of a result: they choose between equivalent methods and decide
//! when an iteration evaluates the exact gap. Results that are compared bit by bit need the same values.
//! `cargo xtask tuning` measures the cost of half and of twice each constant on your machine. Most were set
//! between 2026-11-20 and 2026-11-22 on two-core machines (AMD EPYC of 2024, Intel Xeon with AVX-512).

/// Constants that a solve reads; [`Tuning::DEFAULT`] has the shipped values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuning {
    // Cost model of one application of the influence matrix.
    /// Time (ns) of one look-up and addition of the direct sum between scattered cells.
    pub pair_ns: f64,
    /// Time (ns) of one application in double precision per point of a padded transform and log2 of their
    /// number.
    pub point_ns: f64,
    /// Ratio of the times of an application in single and in double precision.
    pub single: f64,
    /// Time (ns) of one close pair of the two-level operator, including short runs and cache misses.
    pub close_pair_ns: f64,
    /// Time (ns) of one interpolation weight of the two-level operator.
    pub spread_ns: f64,
    /// Radius of the near part of the two-level operator, in spacings, and points of its interpolation in
    /// each direction: an error of 4e-5 of the largest displacement in the test of `two_level`.
    pub reach: usize,
    /// See `reach`.
    pub order: usize,
    /// Radius of the near part of the two transforms, in spacings, and points of their interpolation in each
    /// direction: an error below 1e-6 of the largest displacement for smooth pressures and 5e-6 for random
    /// ones in the test of `two_transforms`.
    pub dense_reach: usize,
    /// See `dense_reach`.
    pub dense_order: usize,
    /// Time (ns) of a cell and a point of the interpolation of the two transforms, both directions.
    pub filter_ns: f64,
    /// The two-level operator is used for at most one contact cell in this number of cells of the window ...
    pub scattered: usize,
    /// ... and for at most this number of contact cells.
    pub largest_scattered: usize,
    /// A plan for a window is reused for a smaller one with at least this share of its cells: a new plan
    /// costs about three applications.
    pub kept_window: f64,
    /// Length of the torus of pressure corrections, in window sides: exact up to lags of half of it.
    pub shortened: f64,

    // Factor or iterate.
    /// Time (ns) of one multiplication of a Cholesky factorisation (faer, one thread).
    pub factor_ns: f64,
    /// Number of applications of the iterative solution on one contact set, for pressure and stiffness.
    pub applications: f64,
    /// Number of factorisations of the direct solution on one contact set.
    pub factors: f64,
    /// Largest set that is factored (memory: 8 n^2 bytes).
    pub largest_factor: usize,
    /// Sets up to this size are always factored: the result is exact and costs a millisecond or two.
    pub always_factored: usize,
    /// Share of the window in contact from which the preconditioner saves more applications than it costs.
    pub preconditioned: f64,
    /// The same for sets too large to factor, where it costs less than the steps that it saves.
    pub preconditioned_large: f64,
    /// Factor by which the preconditioner reduces the number of steps on sets between both shares: 1.6 to 1.8
    /// for N = 1024 and 2048, D_f = 2.4 and 2.8, F_bar = 0.1 and 0.3, 1e-3 and 1e-8 (2026-11, Xeon,
    /// applications counted).
    pub preconditioner_saves: f64,
    /// From this number of cells on, residuals are extended into the gaps between contacts; for smaller sets
    /// an extension by zeros takes fewer steps. 2026-11, Xeon, five sweeps (`examples/sweep`) at N = 257 and
    /// 513, D_f = 2.0 to 2.8, 1e-8: applications counted, no other set of surfaces tried.
    pub extended: usize,
    /// Factor of a value of the next coarser level in a gap between contacts, in the preconditioner. 2026-11,
    /// Xeon, sweeps of 20 loads at N = 512 and 1024, D_f = 2.4, 1e-8: 0.7 to 0.85 within 6 % of each other.
    /// Steps on a given set are fewest with 0.7 at 3 % contact and 0.85 at 45 %.
    pub decay: f32,

    // Contact set.
    /// Range of the reduction of the error by an inner solve, which is half of the reduction that is still
    /// required. A weaker one restarts too often, a stronger one solves accurately on a set that will change.
    pub reduction: (f64, f64),
    /// The same while the residuals are above `early`: the set still changes a lot.
    pub early_reduction: f64,
    /// See `early_reduction`; relative, as the residuals.
    pub early: f64,
    /// Largest number of steps of an inner solve.
    pub inner_steps: usize,
    /// Residual gap, as a share of the tolerance, below which an inner solve need not go.
    pub floor: f64,
    /// Residuals count as better when they fall by this factor.
    pub better: f64,
    /// Outer iterations without better residuals after which the solve has stagnated.
    pub patience: usize,
    /// The next gap is evaluated in single precision where the present residual gap exceeds the noise of
    /// single precision, this share of the approach ...
    pub single_noise: f64,
    /// ... and only its change where it exceeds this multiple of the error bound of the present gap.
    pub resolved: f64,
    /// Residuals below this multiple of the tolerance are expected to be within it after the next inner solve, whose
    /// gap is evaluated in double precision at once.
    pub expected: f64,
    /// A cell is added when it penetrates by more than this multiple of the rms gap left on the contact:
    /// penetrations below are within the error of the inner solve, and adding those cells would enlarge the
    /// set again.
    pub noise: f64,
    /// With a hardness: the share of a step above which the whole step is taken ...
    pub whole_step: f64,
    /// ... and the largest number of steps of the next inner solve after a step that was shortened: long ones
    /// change the sets too much at once. 2 solved every load of N = 257 and 1025, periodic and free, p_s = 1
    /// to 0.01 of E* times the rms gradient (2026-11); without a limit some stagnated.
    pub short_steps: usize,
    /// With a hardness: the share of a step below which it counts as zero, and the fall-back takes over.
    pub jammed: f64,
    /// Outer iterations without better residuals, shortened ones among them, after which the fall-back takes
    /// over ...
    pub stalled: usize,
    /// The same on a kernel that bulges, where sets rather alternate.
    pub stalled_bulging: usize,
    /// ... for this many steps between two evaluations ...
    pub fall_back_steps: usize,
    /// ... until the residuals have fallen by this factor, by its square the second time, and so on.
    pub fall_back: f64,
    /// Gaps below this share of the approach may be due to rounding: no fall-back is begun for them.
    pub rounding: f64,
    /// Candidates reach up to this multiple of the approach; a final approach beyond it costs one more outer
    /// iteration.
    pub candidates: f64,
    /// Candidates up to one approach are reused for another one of at least this share of it. Chosen without
    /// a measurement.
    pub kept_candidates: f64,
    /// Penetration that a factored solution leaves by rounding, relative to the approach.
    pub factor_rounding: f64,
    /// Number of cells along a side of the squares whose largest residual gap is kept; the near squares of a
    /// cell are its own and the eight around it.
    pub undecided_square: usize,
    /// The sum of the weights beyond these squares: 0.113 next to a straight edge (see `undecided`).
    pub undecided_far: f64,

    // Stiffness.
    /// Largest number of corrections; each reduces the error by a factor of ten or more.
    pub stiffness_rounds: usize,
    /// Largest number of steps of one correction.
    pub stiffness_steps: usize,
    /// Tolerance, over the square of the error of single precision or of two levels, from which on the
    /// residual of a guess of q is evaluated in this way; the residual of the result is evaluated in double
    /// precision.
    pub stiffness_single: f64,
    /// Share of the tolerance that the linear solve may use up; the rest is left to undecided cells.
    pub stiffness_share: f64,
    /// Share of the tolerance that the iteration aims at: its own estimate is not yet checked in double
    /// precision.
    pub stiffness_aim: f64,
    /// Strongest reduction of the residual in one correction, which is the limit of single precision.
    pub stiffness_reduction: f64,
    /// Largest number of times that the contact set is solved further for the stiffness ...
    pub tightenings: usize,
    /// ... by factors of the residuals in this range ...
    pub tighter: (f64, f64),
    /// ... aiming at this share of the tolerance.
    pub tight_aim: f64,
    /// A periodic stiffness is solved again when its error magnification is larger than the expected one by
    /// this factor.
    pub misjudged: f64,

    // Initial guess.
    /// Loads within this ratio of the last one start from its state ...
    pub warm: f64,
    /// ... and within this ratio from its tangent, without further checks.
    pub near: (f64, f64),
    /// Where more than one cell in this number will be in contact, a tangent is not followed far.
    pub filling: f64,
    /// Where more than one cell in this number will be in contact, the cells that a tangent predicts are
    /// counted before it is followed ...
    pub counted: f64,
    /// ... and it is not followed if their number has grown by more than this factor relative to the load.
    pub overshoot: f64,
    /// How far the secant between two loads is extrapolated beyond the last tangent for the initial guess of
    /// q. If the secant were exact at the middle between the loads, the value would be 2.
    pub extrapolation: f64,
    /// Grids of at most this number of cells squared are solved without a coarser one.
    pub coarsest: usize,
    /// Tolerance and outer iterations on coarse grids: an initial guess, not a result.
    pub coarse_tolerance: f64,
    /// See `coarse_tolerance`.
    pub coarse_iterations: usize,
}

impl Tuning {
    /// The shipped values.
    pub const DEFAULT: Self = Self {
        pair_ns: 2.0,
        point_ns: 0.17,
        single: 0.65,
        close_pair_ns: 3.0,
        spread_ns: 1.0,
        reach: 6,
        order: 6,
        dense_reach: 12,
        dense_order: 6,
        filter_ns: 0.15,
        scattered: 20,
        largest_scattered: 200_000,
        kept_window: 0.6,
        shortened: 1.5,
        factor_ns: 0.07,
        applications: 20.0,
        factors: 2.5,
        largest_factor: 6000,
        always_factored: 256,
        preconditioned: 0.02,
        preconditioned_large: 1.0 / 300.0,
        preconditioner_saves: 1.75,
        extended: 2000,
        decay: 0.75,
        reduction: (0.1, 0.3),
        early_reduction: 0.3,
        early: 0.02,
        inner_steps: 40,
        floor: 0.2,
        better: 0.9,
        patience: 12,
        single_noise: 1e-4,
        resolved: 100.0,
        expected: 8.0,
        noise: 1.0,
        whole_step: 0.9,
        short_steps: 2,
        jammed: 1e-6,
        stalled: 30,
        stalled_bulging: 10,
        fall_back_steps: 20,
        fall_back: 0.1,
        rounding: 1e-11,
        candidates: 1.05,
        kept_candidates: 0.9,
        factor_rounding: 1e-12,
        undecided_square: 32,
        undecided_far: 0.125,
        stiffness_rounds: 40,
        stiffness_steps: 60,
        stiffness_single: 100.0,
        stiffness_share: 0.5,
        stiffness_aim: 0.3,
        stiffness_reduction: 1e-4,
        tightenings: 5,
        tighter: (0.1, 0.5),
        tight_aim: 0.7,
        misjudged: 1.5,
        warm: 30.0,
        near: (0.8, 1.25),
        filling: 10.0,
        counted: 200.0,
        overshoot: 2.5,
        extrapolation: 1.5,
        coarsest: 48,
        coarse_tolerance: 1e-2,
        coarse_iterations: 20,
    };
}

/// A constant by its name, and what multiplies it.
pub type Constant = (&'static str, fn(&mut Tuning, f64));

/// Names of constants, and of the ends of those that are ranges, with what multiplies them.
macro_rules! constants {
    ($($name:ident $(. $end:tt)?),+ $(,)?) => {
        [$((
            concat!(stringify!($name) $(, ".", stringify!($end))?),
            |tuning, factor| tuning.$name $(. $end)?.multiply(factor),
        )),+]
    };
}

/// Every constant of `Tuning`, for a study of the effect of each.
pub const CONSTANTS: [Constant; 70] = constants![
    pair_ns,
    point_ns,
    single,
    close_pair_ns,
    spread_ns,
    reach,
    order,
    dense_reach,
    dense_order,
    filter_ns,
    scattered,
    largest_scattered,
    kept_window,
    shortened,
    factor_ns,
    applications,
    factors,
    largest_factor,
    always_factored,
    preconditioned,
    preconditioned_large,
    preconditioner_saves,
    extended,
    decay,
    reduction.0,
    reduction.1,
    early_reduction,
    early,
    inner_steps,
    floor,
    better,
    patience,
    single_noise,
    resolved,
    expected,
    noise,
    whole_step,
    short_steps,
    jammed,
    stalled,
    stalled_bulging,
    fall_back_steps,
    fall_back,
    rounding,
    candidates,
    kept_candidates,
    factor_rounding,
    undecided_square,
    undecided_far,
    stiffness_rounds,
    stiffness_steps,
    stiffness_single,
    stiffness_share,
    stiffness_aim,
    stiffness_reduction,
    tightenings,
    tighter.0,
    tighter.1,
    tight_aim,
    misjudged,
    warm,
    near.0,
    near.1,
    filling,
    counted,
    overshoot,
    extrapolation,
    coarsest,
    coarse_tolerance,
    coarse_iterations,
];

impl Tuning {
    /// The shipped values with one constant multiplied; a torus is never shorter than its window, an order
    /// never odd, a count never 0.
    pub fn with_multiple((_, multiply): Constant, factor: f64) -> Self {
        let mut tuning = Self::DEFAULT;
        multiply(&mut tuning, factor);
        Self {
            shortened: tuning.shortened.max(1.1),
            order: tuning.order.next_multiple_of(2),
            dense_order: tuning.dense_order.next_multiple_of(2),
            ..tuning
        }
    }

    /// Factor of the residuals to which the contact set is solved further, from the tolerance over the error of the
    /// stiffness.
    pub(crate) fn tightened(&self, share: f64) -> f64 {
        (self.tight_aim * share).clamp(self.tighter.0, self.tighter.1)
    }
}

trait Multiply {
    fn multiply(&mut self, factor: f64);
}

impl Multiply for f64 {
    fn multiply(&mut self, factor: f64) {
        *self *= factor;
    }
}

impl Multiply for f32 {
    fn multiply(&mut self, factor: f64) {
        *self *= factor as Self;
    }
}

impl Multiply for usize {
    fn multiply(&mut self, factor: f64) {
        *self = ((*self as f64 * factor).round() as Self).max(1);
    }
}

// Layout: constants of the compiled code.

/// Number of rows that a thread takes at a time; it is even, like the blocks of the extension. This and the
/// next were chosen without a measurement of other values.
pub const BAND: usize = 32;
/// Bytes of a row in one stripe of a spectrum: four cache lines, so that a stripe of some thousand rows lies
/// in the second cache.
pub const STRIPE_BYTES: usize = 256;
/// Pairs of rows that are written to a stripe, or read from it, one after the other, in spectra of at least ...
pub const GROUP: usize = 4;
/// ... this number of bytes, which the second cache does not hold: a stripe then takes 2 kB at a time instead of 512 bytes.
pub const GROUPED_BYTES: usize = 3 << 20;
/// Bytes of a cache line.
pub const CACHE_LINE: usize = 64;
/// Side of the squares in which columns and rows are exchanged: it divides the columns of a cache line.
pub const SQUARE: usize = 4;
/// Number of waves of a row that are separated or combined at a time: two registers of single precision.
pub const WAVES: usize = 8;
/// Accumulators side by side in a sum: one 512-bit register of single precision.
pub const LANES: usize = 16;
/// Numbers that they take in before a sum goes on in double precision.
pub const BLOCK: usize = 2048;
/// Chunks that are counted before a count that is large enough ends.
pub const COUNTED_CHUNKS: usize = 32;
/// Number of values of a vector that a thread takes at a time, a multiple of [`BLOCK`].
pub const CHUNK: usize = 8 * BLOCK;
/// From this number of cells per run on, values are copied run by run; below it, cell by cell is faster.
pub const LONG_RUN: usize = 8;
/// Cells that are passed one by one in a search for the next one of another set, which then goes on by
/// halving.
pub const PASSED_SINGLY: usize = 8;
/// Largest number of levels of the preconditioner's extension: contributions below `decay^8` are negligible.
pub const EXTENSION_LEVELS: usize = 8;
/// Largest number of values kept in the symbols of one kind: 134 MB of f64, four times the largest symbol of
/// 2049 cells a side.
pub const KEPT_SYMBOLS: usize = 1 << 24;
/// The list of candidates is filled up to this multiple of the requested approach, so that a path of loads
/// does not scan the grid each time ...
pub const CANDIDATES_AHEAD: f64 = 2.0;
/// ... unless it would hold more than one cell in this number.
pub const LISTED_CANDIDATES: usize = 8;
/// Largest factor from the error of `1' G^-1 1` with the shifted kernel to that of k; beyond it k has no
/// valid digit.
pub const MAGNIFIED: f64 = 1e10;
/// Largest number of loads in the search for a mean gap.
pub const GAP_LOADS: usize = 60;
/// Number of these loads under which cells flow, before the search goes on in the approach.
pub const FLOWING_GAP_LOADS: usize = 10;
/// Largest number of loads that meet a mean gap and are followed by another one ...
pub const POLISHING_LOADS: usize = 3;
/// ... because they do not meet it to this share of its tolerance.
pub const POLISHED_GAP: f64 = 0.01;
/// Largest step of ln F between two of these loads.
pub const GAP_STEP: f64 = 3.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_name_is_one_constant() {
        for (i, constant) in CONSTANTS.into_iter().enumerate() {
            let name = constant.0;
            assert_ne!(Tuning::with_multiple(constant, 2.0), Tuning::DEFAULT, "{name}");
            assert_eq!(Tuning::with_multiple(constant, 1.0), Tuning::DEFAULT, "{name}");
            assert!(CONSTANTS[i + 1..].iter().all(|(other, _)| *other != name), "{name} twice");
        }
    }
}
