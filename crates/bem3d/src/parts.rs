//! The time of the parts of a solve. A solver itself reads no clock: a benchmark passes a recorder that has
//! one.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A part of a solve that is timed separately; everything else is `Other`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Everything without a part of its own: preparation, vectors of the outer iteration, guesses.
    Other,
    /// Tables and symbols of the kernel, plans of transforms.
    Plans,
    /// Transforms in double precision: the exact gap, the residual of the stiffness.
    Double,
    /// Transforms in single precision, exact at every lag.
    Single,
    /// The same on a shorter torus.
    Shortened,
    /// The smooth part on a lattice, the rest on little more than the window.
    TwoTransforms,
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
    pub const ALL: [Self; 14] = [
        Self::Other,
        Self::Plans,
        Self::Double,
        Self::Single,
        Self::Shortened,
        Self::TwoTransforms,
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
            Self::TwoTransforms => "transforms, single, two levels",
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
pub struct PartTime {
    /// Units of the clock.
    pub time: u64,
    /// Number of times.
    pub times: u64,
}

/// Charges time to the parts of a solve; clones share one account. By default it is off, and no time is read
/// or stored.
#[derive(Debug, Clone, Default)]
pub struct Recorder(Option<Arc<Account>>);

#[derive(Debug)]
struct Account {
    clock: fn() -> u64,
    entries: Mutex<Timings>,
}

#[derive(Debug)]
struct Timings {
    spent: [PartTime; Part::ALL.len()],
    /// The part that runs, and since when.
    now: (Part, u64),
}

impl Recorder {
    /// Charges time in units of this clock from now on.
    pub fn new(clock: fn() -> u64) -> Self {
        let entries = Timings { spent: [PartTime::default(); Part::ALL.len()], now: (Part::Other, clock()) };
        Self(Some(Arc::new(Account { clock, entries: Mutex::new(entries) })))
    }

    /// The time since the last call, or since the beginning; empty when off.
    pub fn take(&self) -> Vec<(Part, PartTime)> {
        let Some(account) = &self.0 else { return Vec::new() };
        let mut entries = account.entries();
        let now = entries.now.0;
        entries.switch(now, (account.clock)());
        let spent = std::mem::replace(&mut entries.spent, [PartTime::default(); Part::ALL.len()]);
        Part::ALL.into_iter().zip(spent).filter(|(_, spent)| *spent != PartTime::default()).collect()
    }

    /// Runs some work as a separate part, whose time is not counted in the surrounding part.
    pub fn timed<R>(&self, part: Part, work: impl FnOnce() -> R) -> R {
        let Some(account) = &self.0 else { return work() };
        let around = account.enter(part);
        let result = work();
        account.entries().switch(around, (account.clock)());
        result
    }
}

impl Account {
    /// The entries, including those of a thread that panicked.
    fn entries(&self) -> MutexGuard<'_, Timings> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a part; returns the one around it.
    fn enter(&self, part: Part) -> Part {
        let mut entries = self.entries();
        entries.spent[part as usize].times += 1;
        entries.switch(part, (self.clock)())
    }
}

impl Timings {
    /// Charges the part that runs, and begins another one.
    fn switch(&mut self, part: Part, now: u64) -> Part {
        let (last, since) = std::mem::replace(&mut self.now, (part, now));
        self.spent[last as usize].time += now.saturating_sub(since);
        last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_part_inside_another_is_counted_by_itself() {
        thread_local!(static TICKS: Cell<u64> = const { Cell::new(0) });
        let recorder = Recorder::new(|| {
            TICKS.set(TICKS.get() + 1);
            TICKS.get()
        });
        // A tick at the beginning and at the end of each; a clone has the same account.
        recorder.timed(Part::Double, || recorder.clone().timed(Part::Plans, || ()));
        let spent = recorder.take();
        let of = |part| spent.iter().find(|(p, _)| *p == part).map(|(_, s)| (s.time, s.times));
        assert_eq!((of(Part::Double), of(Part::Plans)), (Some((2, 1)), Some((1, 1))));
        assert_eq!(of(Part::Single), None);
        assert!(recorder.take().iter().all(|(part, _)| *part == Part::Other));
        for (i, part) in Part::ALL.into_iter().enumerate() {
            assert_eq!(part as usize, i, "{}", part.name());
        }
    }

    #[test]
    fn without_a_clock_nothing_is_counted() {
        let recorder = Recorder::default();
        assert_eq!(recorder.timed(Part::Double, || 3), 3);
        assert!(recorder.take().is_empty());
    }
}
