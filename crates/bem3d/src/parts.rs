//! Where the time of a solve goes. A solver reads no clock: a benchmark that wants to know brings one.

use std::cell::{Cell, RefCell};
use std::sync::OnceLock;

/// A part of a solve that is timed by itself; what belongs to none is `Other`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// What has no name of its own: preparing, vectors of the outer iteration, guesses.
    Other,
    /// Tables and symbols of the kernel, plans of transforms.
    Plans,
    /// Transforms in double precision: the exact gap, the residual of the stiffness.
    Double,
    /// Transforms in single precision, exact at every lag.
    Single,
    /// The same on a shorter torus.
    Shortened,
    /// The preconditioner.
    Preconditioner,
    /// Two-level sums.
    TwoLevel,
    /// Direct sums.
    Direct,
    /// Cholesky factors.
    Factor,
    /// Vectors of conjugate gradients.
    Vectors,
    /// Sets of cells: candidates, contact, undecided cells, and values carried between them.
    Sets,
    /// Residuals of the contact conditions.
    Residuals,
    /// The state that is returned: area, patches, resolution, fields.
    Results,
}

impl Part {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 13] = [
        Self::Other,
        Self::Plans,
        Self::Double,
        Self::Single,
        Self::Shortened,
        Self::Preconditioner,
        Self::TwoLevel,
        Self::Direct,
        Self::Factor,
        Self::Vectors,
        Self::Sets,
        Self::Residuals,
        Self::Results,
    ];

    /// Name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Other => "other",
            Self::Plans => "kernel tables and plans",
            Self::Double => "transforms, double precision",
            Self::Single => "transforms, single precision",
            Self::Shortened => "transforms, single, shortened",
            Self::Preconditioner => "preconditioner",
            Self::TwoLevel => "two-level sums",
            Self::Direct => "direct sums",
            Self::Factor => "factors",
            Self::Vectors => "vectors of conjugate gradients",
            Self::Sets => "sets of cells",
            Self::Residuals => "residuals",
            Self::Results => "results",
        }
    }
}

/// Time of one part, and how often it was entered.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Spent {
    /// Units of the clock.
    pub time: u64,
    /// Number of times.
    pub times: u64,
}

static CLOCK: OnceLock<fn() -> u64> = OnceLock::new();

thread_local! {
    static SPENT: RefCell<[Spent; Part::ALL.len()]> = const { RefCell::new([Spent { time: 0, times: 0 }; Part::ALL.len()]) };
    /// The part that runs, and since when.
    static NOW: Cell<(Part, u64)> = const { Cell::new((Part::Other, 0)) };
}

/// Times all parts from now on, in every solve of the process, in units of this clock. The first clock stays.
pub fn measure(clock: fn() -> u64) {
    let _ = CLOCK.set(clock);
    let _ = take();
}

/// What the thread that asks has spent since it asked last.
pub fn take() -> Vec<(Part, Spent)> {
    if let Some(clock) = CLOCK.get() {
        switch(NOW.get().0, clock());
    }
    let spent = SPENT.take();
    Part::ALL.into_iter().zip(spent).filter(|(_, spent)| *spent != Spent::default()).collect()
}

/// Does some work as a part of its own, which the part around it does not count.
pub fn timed<R>(part: Part, work: impl FnOnce() -> R) -> R {
    let Some(clock) = CLOCK.get() else { return work() };
    let around = switch(part, clock());
    SPENT.with_borrow_mut(|spent| spent[part as usize].times += 1);
    let result = work();
    switch(around, clock());
    result
}

/// Charges the part that runs, and begins another one.
fn switch(part: Part, now: u64) -> Part {
    let (last, since) = NOW.replace((part, now));
    SPENT.with_borrow_mut(|spent| spent[last as usize].time += now.saturating_sub(since));
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_inside_another_is_counted_by_itself() {
        thread_local!(static TICKS: Cell<u64> = const { Cell::new(0) });
        measure(|| {
            TICKS.set(TICKS.get() + 1);
            TICKS.get()
        });
        let _ = take();
        // A tick at the beginning and at the end of each.
        timed(Part::Double, || timed(Part::Plans, || ()));
        let spent = take();
        let of = |part| spent.iter().find(|(p, _)| *p == part).map(|(_, s)| (s.time, s.times));
        assert_eq!((of(Part::Double), of(Part::Plans)), (Some((2, 1)), Some((1, 1))));
        assert_eq!(of(Part::Single), None);
        assert!(take().iter().all(|(part, _)| *part == Part::Other));
        for (i, part) in Part::ALL.into_iter().enumerate() {
            assert_eq!(part as usize, i, "{}", part.name());
        }
    }
}
