//! From an accuracy target to the cheapest settings: a pilot run, its scatter and its differences between grids, a table of costs.
//!
//! The choice rests on counts and on compiled-in costs, never on a clock: the same target gives the same settings.

use crate::budget::{self, Budgeted};
use crate::grid_error::differences;
use crate::measured::{COARSER_SURFACES, Measured, Series, measure_1d, measure_3d, with_coarser};
use crate::realisation::Discretisation;
use crate::run::{Request, Run};
use crate::sample::FLOOR_CELLS;
use analysis::{least_squares, student};
use runs::{Error, Progress, Result, Store, files};

/// Cells, elements and surfaces of the pilot.
const PILOT_CELLS: usize = 129;
const PILOT_ELEMENTS: usize = 1 << 14;
const PILOT_SURFACES: usize = 16;
const PILOT_LINES: usize = 64;
/// Grids and lines to choose from.
const GRIDS: [usize; 7] = [65, 129, 257, 513, 1025, 2049, 4097];
const LINES: [usize; 6] = [1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20, 1 << 22];
/// Tolerance as a part of the target: both estimates of the algebraic part together take a fifteenth of it.
const TOLERANCE_PER_TARGET: f64 = 1.0 / 30.0;
const TOLERANCES: (f64, f64) = (1e-6, 1e-3);
/// The scatter of 16 surfaces is itself known to a fifth only.
const SAFETY: f64 = 1.15;
/// Most surfaces that are planned for.
const MOST_SURFACES: f64 = *crate::limits::COUNT.end() as f64;
/// Rows above the floor whose power law tells the contact cells of those below.
const LIGHTEST: usize = 6;
/// Steps in which a refusal looks for the accuracy that the budget buys, and the widest that is worth naming.
const STEP: f64 = 1.1;
const WIDEST: f64 = 3.0;

/// What one asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccuracyTarget {
    /// 95 % half-width of each mean k_bar above the floor, relative.
    pub accuracy: f64,
    /// Seconds that it may take.
    pub seconds: f64,
}

/// Which ensembles a command needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Requirements {
    /// Figs. 2, 4.
    pub solid: bool,
    /// Fig. 6.
    pub line: bool,
}

/// Settings that should meet a target.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyPlan {
    /// The run with its settings.
    pub run: Run,
    /// Predicted seconds.
    pub seconds: f64,
    /// Predicted accuracy.
    pub accuracy: f64,
    /// The prediction in words, one line each.
    pub lines: Vec<String>,
}

/// One ensemble as planned.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Choice {
    size: usize,
    count: usize,
    tolerance: f64,
    seconds: f64,
    accuracy: f64,
}

/// What the pilot says about one row.
#[derive(Debug, Clone, Copy)]
struct PilotRow {
    fractal_dimension: f64,
    force_bar: f64,
    /// Fewest contact cells of a surface on the pilot's grid, from the fitted law where that lies on the floor.
    cells: f64,
    /// Scatter of k from surface to surface, relative.
    scatter: f64,
    /// Mean and scatter of the relative difference between the pilot's grid and the one of half its size.
    mean: f64,
    spread: f64,
    /// Contact cells at which these differences were seen: those of the lightest row above the floor for the rows below.
    seen_at: f64,
}

/// Pilot of one model: rows, and how contact cells and differences follow the grid.
struct Pilot {
    discretisation: Discretisation,
    rows: Vec<PilotRow>,
    /// Contact cells grow like size^growth.
    growth: f64,
    /// Differences fall like (contact cells)^-fall.
    fall: f64,
}

/// The cheapest settings that meet a target, after a pilot of small grids that is stored with the run.
///
/// # Errors
/// [`Error::Parameter`] for sizes or a tolerance that were given beside the target, and for an accuracy outside (0, 1), a budget that is not positive, or a target beyond the budget, with the accuracy
/// that the budget buys; what the pilot's solves refuse.
pub fn plan(
    request: &Request,
    requirements: Requirements,
    target: AccuracyTarget,
    progress: &dyn Progress,
) -> Result<AccuracyPlan> {
    let given = [
        ("cells", request.cells.map(|n| n.to_string())),
        ("surfaces", request.surfaces.map(|n| n.to_string())),
        ("elements", request.elements.map(|n| n.to_string())),
        ("lines", request.lines.map(|n| n.to_string())),
        ("tolerance", request.tolerance.map(|t| format!("{t:?}"))),
    ];
    for (name, value) in given {
        if let Some(value) = value {
            return Err(Error::parameter(name, value, "nothing beside an accuracy target, which chooses it"));
        }
    }
    let run = &Run::new(request)?;
    if !(target.accuracy > 0.0 && target.accuracy < 1.0) {
        return Err(Error::parameter(
            "accuracy",
            target.accuracy,
            "a share between 0 and 1, or per cent such as 1%",
        ));
    }
    if !(target.seconds > 0.0 && target.seconds.is_finite()) {
        return Err(Error::parameter("budget", target.seconds, "a time such as 90s, 10min or 2h"));
    }
    files::create_directory(&run.out)?;
    let store = Store::open(&run.out, run.fresh)?;
    let mut pilots = Vec::new();
    if requirements.solid {
        let discretisation = Discretisation::Bem3d { cells: PILOT_CELLS, tolerance: crate::run::TOLERANCE };
        let forces = run.forces_3d.values();
        pilots.push(Pilot::new(run, discretisation, forces, PILOT_SURFACES, &store, progress)?);
    }
    if requirements.line {
        let discretisation = Discretisation::Mdr1d { elements: PILOT_ELEMENTS };
        let forces = run.forces_1d.values();
        pilots.push(Pilot::new(run, discretisation, forces, PILOT_LINES, &store, progress)?);
    }
    choose(run, &pilots, target)
}

/// Solves what a plan chose and adds surfaces until the target is met, as far as the budget goes: the pilot predicts, the run decides.
///
/// The units are stored with the run, so that the figure itself solves nothing again.
///
/// # Errors
/// What the solver refuses.
pub fn settle(
    mut plan: AccuracyPlan,
    requirements: Requirements,
    target: AccuracyTarget,
    progress: &dyn Progress,
) -> Result<AccuracyPlan> {
    let store = Store::open(&plan.run.out, false)?;
    let mut spent = plan.seconds;
    loop {
        let mut more = false;
        for solid in [true, false]
            .into_iter()
            .filter(|solid| if *solid { requirements.solid } else { requirements.line })
        {
            let run = &plan.run;
            let measured =
                if solid { measure_3d(run, &store, progress)? } else { measure_1d(run, &store, progress)? };
            let all = budget::budgets(&measured);
            let count = if solid { run.surfaces } else { run.lines };
            let wanted = surfaces_wanted(&all, target.accuracy, count);
            let seconds = plan.seconds * (wanted - count as f64) / count as f64;
            if wanted > count as f64 && wanted <= MOST_SURFACES && spent + seconds <= target.seconds {
                spent += seconds;
                plan.lines.push(format!(
                    "{}: {wanted} instead of {count}, for rows that scatter more",
                    measured.discretisation.name()
                ));
                *(if solid { &mut plan.run.surfaces } else { &mut plan.run.lines }) = wanted as usize;
                more = true;
            }
        }
        if !more {
            return Ok(plan);
        }
    }
}

/// Surfaces that bring every mean above the floor within a target, a tenth more than the scatter found asks for; no more than there are
/// where all are within, or where the rest is not a matter of their number.
fn surfaces_wanted(all: &[Budgeted], target: f64, count: usize) -> f64 {
    let open = all
        .iter()
        .filter(|b| b.force_bar.is_some() && !b.below_floor && b.relative().is_some_and(|r| r > target));
    let factors = open.map(|b| {
        let (grid, ensemble) = (b.budget.discretisation.unwrap_or(0.0), b.budget.ensemble.unwrap_or(0.0));
        let room = (target * b.value - b.budget.algebraic).powi(2) - grid * grid;
        if room > 0.0 { 1.1 * ensemble * ensemble / room } else { 1.0 }
    });
    let factor = factors.fold(1.0, f64::max);
    // Every round adds at least one surface, or ends.
    if factor > 1.0 { (factor * count as f64).ceil().max(count as f64 + 1.0) } else { count as f64 }
}

fn choose(run: &Run, pilots: &[Pilot], target: AccuracyTarget) -> Result<AccuracyPlan> {
    let at = |accuracy: f64| {
        let choices: Option<Vec<Choice>> = pilots.iter().map(|p| p.cheapest(accuracy, run.threads)).collect();
        choices.filter(|c| c.iter().map(|c| c.seconds).sum::<f64>() <= target.seconds)
    };
    if let Some(choices) = at(target.accuracy) {
        return Ok(made(run, pilots, &choices));
    }
    let mut bought = target.accuracy;
    while bought < WIDEST && at(bought).is_none() {
        bought *= STEP;
    }
    let cost = pilots
        .iter()
        .map(|p| p.cheapest(target.accuracy, run.threads).map(|c| c.seconds))
        .sum::<Option<f64>>();
    let costs =
        cost.map_or_else(|| "more than the finest grids".to_owned(), |s| format!("about {}", duration(s)));
    let buys = if bought < WIDEST {
        format!("buys {:.2} %", 100.0 * bought)
    } else {
        "buys nothing worth a number".into()
    };
    let widest =
        pilots.iter().filter_map(Pilot::hardest).map(|r| format!("D_f = {:?}, F_bar = {:.1e}", r.0, r.1));
    let hardest = widest.collect::<Vec<_>>().join("; ");
    Err(Error::parameter(
        "accuracy",
        format!("{:.3} %", 100.0 * target.accuracy),
        format!(
            "a target within the time budget of {}: this one takes {costs}, the budget {buys}; the hardest load is {hardest}",
            duration(target.seconds)
        ),
    ))
}

fn made(run: &Run, pilots: &[Pilot], choices: &[Choice]) -> AccuracyPlan {
    let mut run = run.clone();
    let mut lines = Vec::new();
    for (pilot, choice) in pilots.iter().zip(choices) {
        let Choice { size, count, tolerance, seconds, accuracy } = *choice;
        let what = match pilot.discretisation {
            Discretisation::Bem3d { .. } => {
                (run.cells, run.surfaces, run.tolerance) = (size, count, tolerance);
                format!("{count} surfaces of {size} cells a side, tolerance {tolerance:.1e}")
            }
            Discretisation::Mdr1d { .. } => {
                (run.elements, run.lines) = (size, count);
                format!("{count} lines of {size} elements")
            }
        };
        lines.push(format!(
            "{}: {what} should give each mean to {:.2} % in about {}",
            pilot.discretisation.name(),
            100.0 * accuracy,
            duration(seconds)
        ));
    }
    let seconds = choices.iter().map(|c| c.seconds).sum();
    let accuracy = choices.iter().map(|c| c.accuracy).fold(0.0, f64::max);
    AccuracyPlan { run, seconds, accuracy, lines }
}

/// `45 s`, `12 min`, `3.5 h`.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

impl Pilot {
    fn new(
        run: &Run,
        discretisation: Discretisation,
        forces: &[f64],
        surfaces: usize,
        store: &Store,
        progress: &dyn Progress,
    ) -> Result<Self> {
        Ok(Self::of(&with_coarser(discretisation, surfaces, forces, run, store, progress)?))
    }

    fn of(fine: &Measured) -> Self {
        let mut rows = Vec::new();
        let (mut growths, mut falls) = (Vec::new(), Vec::new());
        for series in &fine.series {
            let coarser = fine.coarser_at(series.fractal_dimension);
            let (found, growth) = series_rows(series, coarser);
            growths.extend(growth);
            let law: Vec<(f64, f64)> =
                found.iter().filter(|r| size(r) > 0.0).map(|r| (r.cells.ln(), size(r).ln())).collect();
            falls.extend(least_squares(&law).map(|l| -l.0));
            rows.extend(found);
        }
        let mean = |v: &[f64], otherwise: f64| {
            if v.is_empty() { otherwise } else { v.iter().sum::<f64>() / v.len() as f64 }
        };
        // Without any law: cells grow with the area, differences fall like one over the number of cells along a side.
        let (growth, fall) = (mean(&growths, 1.0), mean(&falls, 0.5));
        Self {
            discretisation: fine.discretisation,
            rows,
            growth: growth.clamp(0.3, 2.0),
            fall: fall.clamp(0.2, 1.0),
        }
    }

    /// Half-width of a row at a size and a number of surfaces; `None` on the floor.
    fn half_width(&self, row: &PilotRow, size: usize, count: f64, tolerance: f64) -> Option<f64> {
        let cells = row.cells * (size as f64 / self.discretisation.size() as f64).powf(self.growth);
        if cells < FLOOR_CELLS as f64 {
            return None;
        }
        let falls = (cells / row.seen_at).powf(-self.fall);
        let surfaces = count.min(COARSER_SURFACES as f64).sqrt();
        let grid = REACH * (falls * row.mean).hypot(falls * row.spread / surfaces);
        let freedom = (count - 1.0).max(1.0);
        Some(2.0 * tolerance + grid.hypot(SAFETY * student(freedom) * row.scatter / count.sqrt()))
    }

    /// The widest row at a size and a number of surfaces; `None` where all rows are floor.
    fn accuracy(&self, size: usize, count: f64, tolerance: f64) -> Option<f64> {
        self.rows.iter().filter_map(|r| self.half_width(r, size, count, tolerance)).reduce(f64::max)
    }

    fn cheapest(&self, target: f64, threads: usize) -> Option<Choice> {
        let solid = matches!(self.discretisation, Discretisation::Bem3d { .. });
        let tolerance = (target * TOLERANCE_PER_TARGET).clamp(TOLERANCES.0, TOLERANCES.1);
        let sizes: &[usize] = if solid { &GRIDS } else { &LINES };
        let algebraic = if solid { tolerance } else { 0.0 };
        let choices = sizes.iter().filter_map(|&size| {
            let enough = |count: f64| self.accuracy(size, count, algebraic).is_some_and(|a| a <= target);
            if !enough(MOST_SURFACES) {
                return None;
            }
            let (mut low, mut high) = (1.0, MOST_SURFACES);
            while high - low > 1.0 {
                let middle = f64::floor(f64::midpoint(low, high));
                if enough(middle) { high = middle } else { low = middle }
            }
            let coarser =
                if self.with(size, tolerance).coarser().is_some() { COARSER_SURFACES as f64 } else { 0.0 };
            let seconds = (high * self.surface_seconds(size, tolerance)
                + coarser.min(high)
                    * (self.surface_seconds(size.div_ceil(2), tolerance)
                        + self.surface_seconds(size.div_ceil(4), tolerance)))
                / threads.max(1) as f64;
            let accuracy = self.accuracy(size, high, algebraic)?;
            Some(Choice { size, count: high as usize, tolerance, seconds, accuracy })
        });
        choices.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }

    fn with(&self, size: usize, tolerance: f64) -> Discretisation {
        match self.discretisation {
            Discretisation::Bem3d { .. } => Discretisation::Bem3d { cells: size, tolerance },
            Discretisation::Mdr1d { .. } => Discretisation::Mdr1d { elements: size },
        }
    }

    /// Seconds of one surface of every fractal dimension under all loads.
    fn surface_seconds(&self, size: usize, tolerance: f64) -> f64 {
        match self.discretisation {
            Discretisation::Bem3d { .. } => {
                self.rows.iter().map(|r| solid_seconds(size, r.force_bar, tolerance)).sum()
            }
            Discretisation::Mdr1d { .. } => {
                let mut dimensions: Vec<u64> =
                    self.rows.iter().map(|r| r.fractal_dimension.to_bits()).collect();
                dimensions.dedup();
                dimensions.len() as f64 * LINE_SECONDS * size as f64
            }
        }
    }

    /// The row above the floor that is known worst on the finest grid.
    fn hardest(&self) -> Option<(f64, f64)> {
        let finest =
            if matches!(self.discretisation, Discretisation::Bem3d { .. }) { GRIDS[6] } else { LINES[5] };
        let widths =
            self.rows.iter().filter_map(|r| Some((r, self.half_width(r, finest, MOST_SURFACES, 0.0)?)));
        widths.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(r, _)| (r.fractal_dimension, r.force_bar))
    }
}

/// Root mean square of the differences of a row.
fn size(r: &PilotRow) -> f64 {
    r.mean.hypot(r.spread)
}

/// Rows of one fractal dimension: those above the floor as measured, those below from the power laws of the ones above. And how contact
/// cells grew from the half-size grid to the pilot.
fn series_rows(series: &Series, coarser: Option<[&Series; 2]>) -> (Vec<PilotRow>, Option<f64>) {
    let mut above = Vec::new();
    let mut growth = Vec::new();
    for (j, point) in series.points.iter().enumerate() {
        let (Some(k), Some(cells)) = (point.stiffness_bar, point.min_contact_cells) else { continue };
        let Some([half, quarter]) = coarser else { continue };
        let differences: Vec<f64> = differences(series, [half, quarter], j).iter().map(|d| d[0]).collect();
        if cells < FLOOR_CELLS || differences.len() < 2 {
            continue;
        }
        let n = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / n;
        let spread = (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let scatter = k.relative_error().unwrap_or(0.0) * (k.count as f64).sqrt();
        if let Some(coarse) =
            half.points.get(j).and_then(|p| p.min_contact_cells).filter(|c| *c >= FLOOR_CELLS)
        {
            growth.push((cells as f64 / coarse as f64).log2());
        }
        let (force_bar, fractal_dimension) = (point.force_bar, series.fractal_dimension);
        let cells = cells as f64;
        above.push(PilotRow { fractal_dimension, force_bar, cells, scatter, mean, spread, seen_at: cells });
    }
    let growth = (!growth.is_empty()).then(|| growth.iter().sum::<f64>() / growth.len() as f64);
    // The power law of the lightest rows reaches below the floor.
    let light: Vec<(f64, f64)> =
        above.iter().take(LIGHTEST).map(|r| (r.force_bar.ln(), r.cells.ln())).collect();
    let Some((first, (slope, intercept))) = above.first().copied().zip(least_squares(&light)) else {
        return (above, growth);
    };
    let mut rows: Vec<PilotRow> = series
        .points
        .iter()
        .filter(|p| p.force_bar < first.force_bar)
        .map(|p| {
            let cells = (intercept + slope * p.force_bar.ln()).exp();
            PilotRow { force_bar: p.force_bar, cells, ..first }
        })
        .collect();
    rows.extend(above);
    (rows, growth)
}

/// 95 % half-width of what the grid leaves, in root mean squares of the last difference between grids, before the grids of the choice are
/// solved and tell: 0.88 where differences halve and are independent, 1.96 where they have one sign.
const REACH: f64 = 1.35;

/// Seconds of one element of a line, drawing, sorting and all loads.
const LINE_SECONDS: f64 = 1.6e-8;

/// Seconds of one load on N x N cells, warm, one thread of the machine of data/bench (scaling.csv there, cold, at 1e-6, is 1.4 times as
/// slow): a floor for drawing and tables, and dense work that begins near F_bar = 0.1.
fn solid_seconds(cells: usize, force_bar: f64, tolerance: f64) -> f64 {
    let n = cells as f64 / 513.0;
    let dense = (force_bar / 0.6).clamp(0.0, 1.0);
    // Decades of the tolerance, six being the table's.
    let decades = 0.25 - tolerance.log10() / 8.0;
    let transforms = if n < 1.0 { n.powf(1.9) } else { n.powf(2.6) };
    0.012 * n.powf(1.9) + dense * decades * 0.2 * transforms
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn pilot(scatter: f64, spread: f64) -> Pilot {
        let row = PilotRow {
            fractal_dimension: 2.4,
            force_bar: 1.0,
            cells: 400.0,
            scatter,
            mean: 0.0,
            spread,
            seen_at: 400.0,
        };
        let discretisation = Discretisation::Bem3d { cells: PILOT_CELLS, tolerance: 1e-4 };
        Pilot { discretisation, rows: vec![row], growth: 1.0, fall: 0.5 }
    }

    #[test]
    fn the_number_of_surfaces_by_hand() {
        // Nothing from the grid: 1.15 x 1.96 x 5 % / sqrt(n) = 1 % - 2/30 % gives n = 146, on the smallest grid above the floor.
        let choice = pilot(0.05, 0.0).cheapest(0.01, 1).unwrap();
        assert_eq!(choice.size, 65);
        assert!((140..=155).contains(&choice.count), "{choice:?}");
        assert!(choice.accuracy <= 0.01 && choice.accuracy > 0.0098);
        assert_relative_eq!(choice.tolerance, 0.01 / 30.0, max_relative = 1e-12);
        // Differences between grids ask for a finer one, and an impossible target for none.
        assert!(pilot(0.05, 0.04).cheapest(0.01, 1).unwrap().size > 65);
        assert_eq!(pilot(0.05, 9.0).cheapest(0.01, 1), None);
    }

    #[test]
    fn a_wish_beyond_the_budget_names_what_it_buys() {
        let run = Run::new(&Request { threads: Some(1), ..Request::default() }).unwrap();
        let pilots = [pilot(0.3, 0.02)];
        let plan = choose(&run, &pilots, AccuracyTarget { accuracy: 0.1, seconds: 1e5 }).unwrap();
        assert!(plan.accuracy <= 0.1 && plan.lines.len() == 1 && plan.run.surfaces > 2);
        let target = AccuracyTarget { accuracy: 1e-3, seconds: 60.0 };
        let refused = choose(&run, &pilots, target).unwrap_err().to_string();
        assert!(refused.starts_with("accuracy = 0.100 %") && refused.contains("budget buys"), "{refused}");
    }

    #[test]
    fn surfaces_are_added_where_their_scatter_is_the_reason() {
        let row = |grid, ensemble, below_floor| Budgeted {
            quantity: "stiffness_bar",
            fractal_dimension: 2.0,
            force_bar: Some(1.0),
            value: 2.0,
            budget: budget::Budget {
                algebraic: 0.0,
                discretisation: Some(grid),
                ensemble: Some(ensemble),
                window: None,
            },
            below_floor,
        };
        // Twice the target, from the scatter alone: four times the surfaces and a tenth.
        assert_relative_eq!(surfaces_wanted(&[row(0.0, 0.4, false)], 0.1, 10), 44.0);
        // Within the target, on the floor, or a matter of the grid.
        for other in [row(0.0, 0.1, false), row(0.0, 9.0, true), row(0.3, 0.4, false)] {
            assert_relative_eq!(surfaces_wanted(&[other], 0.1, 10), 10.0);
        }
    }

    #[test]
    fn words_for_times() {
        assert_eq!([30.0, 600.0, 9000.0].map(duration), ["30 s", "10 min", "2.5 h"]);
    }
}
