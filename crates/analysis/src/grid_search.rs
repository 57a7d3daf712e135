//! Search of the grid for a requested accuracy: from coarse to fine, until the error is small enough or the
//! time is up.

/// A requested relative error, and the time that it may cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccuracyTarget {
    /// Largest relative error (half-width of an interval) of the quantity that the caller chooses; 0 means as
    /// small as the time allows.
    pub share: f64,
    /// Time budget in seconds, with which predicted times are compared.
    pub seconds: f64,
}

impl AccuracyTarget {
    /// Whether the target is the smallest error that the time allows.
    pub fn is_best(&self) -> bool {
        self.share <= 0.0
    }

    /// Tolerance of a solver that does not affect this accuracy: a thirtieth of it, between 1e-6 and 1e-3,
    /// rounded to one digit.
    ///
    /// ```
    /// let target = analysis::AccuracyTarget { share: 0.01, seconds: 60.0 };
    /// assert_eq!(target.tolerance(), 3e-4);
    /// ```
    pub fn tolerance(&self) -> f64 {
        let tolerance = (self.share / 30.0).clamp(1e-6, 1e-3);
        // It stands in plans and headers.
        format!("{tolerance:.0e}").parse().unwrap_or(tolerance)
    }
}

/// Results of the trial solves on one grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridTrial<T> {
    /// Largest relative discretisation error of the grid; `None` where it is not known.
    pub error: Option<f64>,
    /// Predicted seconds of the trial. A measured time would make the choice depend on what else the machine
    /// does.
    pub seconds: f64,
    /// Predicted seconds that the run takes beyond the trial; infinite where no run on this grid reaches the target.
    pub rest: f64,
    /// Predicted seconds of the run on a grid that is as expensive as this one but has no error: the least time of
    /// finer grids is estimated from it.
    pub least_rest: f64,
    /// Further data of the caller.
    pub kept: T,
}

/// The reason why no grid was chosen, with the last trial.
#[derive(Debug, Clone, PartialEq)]
pub enum NoGrid<T> {
    /// The run on the last grid, or the trial of the next one and the run on it, would take longer than the
    /// target allows.
    Time {
        /// The last grid.
        grid: usize,
        /// Its trial.
        trial: GridTrial<T>,
        /// The grid that would take too long.
        next: usize,
        /// Seconds of the whole search and of the run.
        seconds: f64,
    },
    /// There is no finer grid, or no grid at all (`None`).
    Finest(Option<(usize, GridTrial<T>)>),
}

/// A grid that meets a target, with its trial.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundGrid<T> {
    /// The grid.
    pub grid: usize,
    /// Its trial.
    pub trial: GridTrial<T>,
    /// Whether the next coarser grid confirms its error, which may be small by chance.
    pub is_confirmed: bool,
    /// The finer grid that would confirm the error, and seconds of the whole search and of the run with it; `None`
    /// where the error is confirmed or there is no finer grid.
    pub confirming: Option<(usize, f64)>,
}

/// A grid with its trial, or why there is none.
pub type ChosenGrid<T> = Result<FoundGrid<T>, NoGrid<T>>;

impl<T> NoGrid<T> {
    /// The reason in words, with the error of the last grid: `grid` names a grid, `place` says where the
    /// error is largest, `time` words a time.
    pub fn words(
        &self,
        budget: f64,
        grid: &dyn Fn(usize) -> String,
        place: &dyn Fn(&T) -> String,
        time: &dyn Fn(f64) -> String,
    ) -> String {
        let leaves = |n: usize, trial: &GridTrial<T>| match trial.error {
            Some(error) => {
                format!("{} have an error of {} ({})", grid(n), percent(error), place(&trial.kept))
            }
            None => format!(
                "{} are too few to compare with coarser ones, or every load is zero or complete contact",
                grid(n)
            ),
        };
        match self {
            Self::Time { grid: n, trial, next, seconds } => {
                let what = if next == n { "the run on them".to_owned() } else { grid(*next) };
                let (left, takes, budget) = (leaves(*n, trial), time(*seconds), time(budget));
                format!("{left}, {what} would take about {takes}, and the budget is {budget}")
            }
            Self::Finest(Some((n, trial))) => leaves(*n, trial),
            Self::Finest(None) => "there is no grid".to_owned(),
        }
    }
}

/// Three digits.
fn percent(share: f64) -> String {
    let value = 100.0 * share;
    let decimals = (2.0 - value.log10().floor()).clamp(0.0, 12.0);
    format!("{value:.*} %", if decimals.is_finite() { decimals as usize } else { 0 })
}

/// The first of several grids, from coarse to fine, that meets a target in error and time.
///
/// A grid is accepted if its error is within the target and that of the next coarser grid is at most twice
/// the target, because one small difference may be chance. Where a finer grid would exceed the time, or there is none,
/// a grid is accepted without this second condition, and its error is not confirmed. For a target of 0 the result is the finest grid whose run fits into the time. The time is
/// assumed to grow with a power of the size of the grid. No rate of convergence is assumed, so an
/// unsuccessful search continues until one more grid would exceed the time.
///
/// # Errors
/// What a trial returns.
///
/// ```
/// use analysis::{AccuracyTarget, GridTrial, NoGrid, first_grid};
/// let trial = |n: usize| {
///     let error = Some(1.0 / n as f64);
///     Ok::<_, ()>(GridTrial { error, seconds: n as f64, rest: 0.0, least_rest: 0.0, kept: () })
/// };
/// let search = |seconds| first_grid(&[8, 16, 32, 64], AccuracyTarget { share: 0.04, seconds }, 1.0, trial).unwrap();
/// // 1/32, after 1/16, which is less than twice as much.
/// assert_eq!(search(100.0).unwrap().grid, 32);
/// assert!(matches!(search(50.0), Err(NoGrid::Time { grid: 16, next: 32, .. })));
/// ```
pub fn first_grid<T, E>(
    grids: &[usize],
    target: AccuracyTarget,
    power: f64,
    mut trial: impl FnMut(usize) -> Result<GridTrial<T>, E>,
) -> Result<ChosenGrid<T>, E> {
    let AccuracyTarget { share, seconds: budget } = target;
    let mut spent = 0.0;
    let mut last: Option<(usize, GridTrial<T>)> = None;
    for (i, &grid) in grids.iter().enumerate() {
        let trial = trial(grid)?;
        spent += trial.seconds;
        let coarser = last.as_ref().and_then(|(_, coarser)| coarser.error);
        let finer = &grids[i + 1..];
        let is_confirmed = coarser.is_some_and(|coarser| coarser <= 2.0 * share);
        let enough = trial.error.is_some_and(|error| error <= share);
        let whole = spent + trial.rest;
        let each = trial.seconds + trial.least_rest;
        let next = finer.first().copied();
        let seconds = next.map(|next| spent + each * (next as f64 / grid as f64).powf(power));
        let affordable = seconds.is_some_and(|seconds| seconds <= budget);
        let is_found = enough && (is_confirmed || !affordable);
        let is_best = !affordable && target.is_best() && trial.error.is_some();
        if (is_found || is_best) && whole <= budget {
            let confirming = next.zip(seconds).filter(|_| !is_confirmed);
            return Ok(Ok(FoundGrid { grid, trial, is_confirmed, confirming }));
        }
        match (next, seconds) {
            _ if enough && !affordable => {
                return Ok(Err(NoGrid::Time { grid, trial, next: grid, seconds: whole }));
            }
            (Some(next), Some(seconds)) if !affordable => {
                return Ok(Err(NoGrid::Time { grid, trial, next, seconds }));
            }
            _ => last = Some((grid, trial)),
        }
    }
    Ok(Err(NoGrid::Finest(last)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRIDS: [usize; 4] = [8, 16, 32, 64];

    /// Errors of a power of the cell, each trial as long as the grid, runs on it as long again.
    fn search(order: i32, share: f64, seconds: f64) -> Result<usize, String> {
        let trial = |n: usize| {
            let (error, seconds) = (Some((n as f64).powi(-order)), n as f64);
            Ok::<_, ()>(GridTrial { error, seconds, rest: seconds, least_rest: seconds, kept: n })
        };
        let found = first_grid(&GRIDS, AccuracyTarget { share, seconds }, 1.0, trial).unwrap();
        let grid = |n: usize| format!("{n} cells");
        let words = |none: NoGrid<usize>| {
            none.words(seconds, &grid, &|n| format!("at {n}"), &|seconds| format!("{seconds} s"))
        };
        found.map(|found| found.grid).map_err(words)
    }

    #[test]
    fn a_grid_is_chosen_or_its_price_is_named() {
        assert_eq!(search(1, 0.04, 200.0), Ok(32));
        // 8 + 16 + 32 + 64, and the run on 64.
        assert_eq!(search(1, 0.02, 184.0), Ok(64));
        let refused = |share, seconds| search(1, share, seconds).unwrap_err();
        assert_eq!(refused(1e-3, 1e3), "64 cells have an error of 1.56 % (at 64)");
        assert_eq!(
            refused(0.02, 100.0),
            "32 cells have an error of 3.12 % (at 32), 64 cells would take about 184 s, and the budget is 100 s"
        );
        assert_eq!(
            refused(0.04, 40.0),
            "16 cells have an error of 6.25 % (at 16), 32 cells would take about 88 s, and the budget is 40 s"
        );
        assert_eq!(refused(0.01, 1e3), "64 cells have an error of 1.56 % (at 64)");
        // Errors that hardly fall at first and then do are followed as far as the time goes.
        let late = |n: usize| {
            let error = Some(if n < 64 { 0.5 } else { 0.001 });
            Ok::<_, ()>(GridTrial { error, seconds: 1.0, rest: 1.0, least_rest: 1.0, kept: n })
        };
        assert_eq!(
            first_grid(&GRIDS, AccuracyTarget { share: 0.01, seconds: 1e3 }, 1.0, late)
                .unwrap()
                .unwrap()
                .grid,
            64
        );
        // The best that the time allows: the finest grid with its run.
        let best = |seconds| search(1, 0.0, seconds);
        assert_eq!([best(184.0), best(183.0), best(40.0)], [Ok(64), Ok(32), Ok(16)]);
        assert!(best(10.0).unwrap_err().starts_with("8 cells have an error of 12.5 % (at 8), 16 cells"));
    }

    /// A small error that no finer grid confirms in time is taken, and the grid that would confirm it is named.
    #[test]
    fn an_error_that_is_not_confirmed_is_told() {
        let found = |late: usize, seconds: f64| {
            let trial = |n: usize| {
                let error = Some(if n < late { 0.5 } else { 0.008 });
                let seconds = n as f64;
                Ok::<_, ()>(GridTrial { error, seconds, rest: seconds, least_rest: seconds, kept: n })
            };
            first_grid(&GRIDS, AccuracyTarget { share: 0.01, seconds }, 1.0, trial).unwrap().unwrap()
        };
        let confirmed = found(16, 1e3);
        assert_eq!((confirmed.grid, confirmed.is_confirmed, confirmed.confirming), (32, true, None));
        // 8 + 16 + 32 and the run on 32; the trial of 64 and its run are 128 more.
        let taken = found(32, 100.0);
        assert_eq!((taken.grid, taken.is_confirmed, taken.confirming), (32, false, Some((64, 184.0))));
        let finest = found(64, 1e3);
        assert_eq!((finest.grid, finest.is_confirmed, finest.confirming), (64, false, None));
    }

    #[test]
    fn a_run_that_takes_too_long_is_no_choice() {
        let trial = |n: usize| {
            Ok::<_, ()>(GridTrial { error: Some(0.01), seconds: 1.0, rest: 100.0, least_rest: 1.0, kept: n })
        };
        let found =
            |seconds| first_grid(&GRIDS, AccuracyTarget { share: 0.05, seconds }, 0.0, trial).unwrap();
        assert_eq!(found(103.0).unwrap().grid, 16);
        // A finer grid may need less; the last one does not.
        assert!(matches!(found(50.0), Err(NoGrid::Time { grid: 64, next: 64, .. })));
        let unknown = |n: usize| Ok::<_, ()>(GridTrial { error: None, ..trial(n).unwrap() });
        let target = AccuracyTarget { share: 0.05, seconds: 1e9 };
        assert!(matches!(
            first_grid(&GRIDS, target, 1.0, unknown).unwrap(),
            Err(NoGrid::Finest(Some((64, _))))
        ));
        assert_eq!(first_grid(&GRIDS, target, 1.0, |_| Err::<GridTrial<()>, _>("stopped")), Err("stopped"));
        assert!(matches!(
            first_grid::<usize, ()>(&[], target, 1.0, |_| Err(())),
            Ok(Err(NoGrid::Finest(None)))
        ));
    }
}
