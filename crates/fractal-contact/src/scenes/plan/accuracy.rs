//! `accuracy` in `[scene]`: the grid that an accuracy asks for, instead of the other way round.

use crate::scenes::plan::calibration;
use crate::scenes::plan::grid_comparison::{GridErrors, Numbers, compared, on_grid, solve};
use crate::scenes::read::accuracy_target::AccuracyTarget;
use crate::scenes::read::diagnostic::Diagnostic;
use crate::scenes::read::error::Result;
use crate::scenes::read::human_readable::short;
use crate::scenes::read::human_readable::time;
use crate::scenes::read::loads::Loading;
use crate::scenes::read::numerics::{MOST_CELLS, Numerics};
use crate::scenes::read::scene_file::{SceneFile, cells};
use crate::scenes::read::words;
use analysis::grid_error;
use bem3d::Bem3d;
use contact_model::quantities::{AskedBy, Quantity};
use contact_model::{Boundary, Cells, Load};
use std::time::Instant;

/// Polled from any thread, between iterations: `true` means stop now.
pub type SharedStop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Tolerance of the solver as a part of the accuracy, and its limits.
const TOLERANCE_PER_ACCURACY: f64 = 1.0 / 30.0;
const TOLERANCES: (f64, f64) = (1e-6, 1e-3);
/// Cells along the longer side of the coarsest grid of the pilot.
const COARSEST: usize = 33;
/// The two coarser grids of a state, over the work of the state itself, and that.
const WITH_COARSER: f64 = 1.25;

/// Whether errors of a state are within a share, in all of what an accuracy is about.
pub(crate) fn within(scene: &SceneFile, errors: &GridErrors, share: f64) -> bool {
    largest(scene, errors).is_some_and(|error| error <= share)
}

/// Which numbers an accuracy is about: those asked for whose error of the grid is estimated. Of the area it is the corrected one, and
/// the largest pressure, which every scene has, is none of them.
fn controlled(scene: &SceneFile) -> Vec<&'static str> {
    let asked = |quantity: &&Quantity| match quantity.asked_by {
        AskedBy::Output(output) => scene.requested.outputs.asks(output),
        _ => false,
    };
    compared().filter(asked).map(|quantity| quantity.name).filter(|name| *name != "area").collect()
}

/// The largest error of what an accuracy is about; `None` where one is unknown.
fn largest(scene: &SceneFile, errors: &GridErrors) -> Option<f64> {
    controlled(scene).into_iter().try_fold(0.0_f64, |largest, name| Some(largest.max(errors.of(name)?.error)))
}

impl SceneFile {
    /// The scene with the grid and the tolerance that its `accuracy` asks for; itself where it asks for none.
    ///
    /// A pilot solves the loads on surface 0 with 33, 65, 129, ... cells along the longer side of the grid (of a given map: with every so many-th of
    /// its cells, at last with all of them) and estimates the errors of stiffness (of either kind), corrected area, conductance and mean gap, as
    /// far as they are outputs, from three grids each ([`analysis::grid_error`]). It stops at the first grid with small enough errors of which the coarser one's were at
    /// most twice as large: nothing is extrapolated. The run then compares every state with coarser grids itself (`grid_error`): on surface 0
    /// it finds what the pilot found, and of other surfaces it says where the accuracy is missed. For one surface the pilot takes as
    /// long as the run.
    ///
    /// # Errors
    /// [`crate::scenes::Error::Scene`] where no grid gives the accuracy or the predicted time is beyond the budget, with the accuracy that is to be had;
    /// for a scene without a model, a load or an output that an accuracy could be about; [`crate::scenes::Error::Run`] for what the pilot's
    /// solves refuse.
    pub fn with_grid_for_accuracy(mut self, stop: SharedStop<'_>) -> Result<Self> {
        let Some(target) = self.accuracy else { return Ok(self) };
        calibration::jobs_in_memory(&self, 1)?;
        let place = self.models.iter().position(|m| matches!(m, Numerics::Bem3d(_)));
        let Some(place) = place.filter(|_| matches!(self.request, Loading::Loads(_))) else {
            let diagnostic =
                Diagnostic::new("`accuracy` chooses the grid of bem3d under loads, and there is none here")
                    .with_help("remove it, or name \"bem3d\" in `models`");
            return Err(self.at_accuracy(diagnostic).into());
        };
        if controlled(&self).is_empty() {
            let diagnostic =
                Diagnostic::new("`accuracy` of what? no number that it could be about is an output")
                    .with_help("ask for `stiffness`, `area`, `conductance` or `mean_gap` in [outputs]");
            return Err(self.at_accuracy(diagnostic).into());
        }
        if self.surface.differs_by_grid() {
            let diagnostic = Diagnostic::new(
                "`accuracy` compares grids, and a surface with a prescribed distribution of heights is another one on each",
            )
            .with_help("give `cells` in [models.bem3d] and `grid_error = true`: coarser grids then sample one surface");
            return Err(self.at_accuracy(diagnostic).into());
        }
        let chosen = self.first_grid(&self.models[place], target, stop)?;
        let Cells { columns, rows } = cells(&chosen.scene, &chosen.scene.models[0]);
        let percent = |share: f64| format!("{} %", short(100.0 * share));
        let note = Diagnostic::note(format!(
            "accuracy of {}: bem3d on {columns} x {rows} cells, which leave {} on surface 0, in about {}",
            percent(target.share),
            percent(chosen.error),
            time(chosen.seconds)
        ));
        self.models[place] = chosen.scene.models[0].clone();
        self.surface = chosen.scene.surface;
        self.requested.grid_error = true;
        self.notes.push(note.with_help("`grid_error` in the results says what it came to"));
        Ok(self)
    }

    /// The first grid that gives an accuracy, with its scene.
    fn first_grid(&self, model: &Numerics, target: AccuracyTarget, stop: SharedStop<'_>) -> Result<Chosen> {
        let AccuracyTarget { share, seconds: budget } = target;
        let percent = |share: f64| format!("{} %", short(100.0 * share));
        let failed = |error| runs::Error::model("the pilot of `accuracy`")(error);
        let refused = |message: String, help: &str| -> crate::scenes::Error {
            let message = format!("an accuracy of {}: {message}", percent(share));
            self.at_accuracy(Diagnostic::new(message).with_help(help)).into()
        };
        let given = self.surface.own_cells().is_some();
        let (model, rungs) = (with_tolerance(self, model, share), rungs(self));
        let normalised_on = if given { rungs.last() } else { rungs.first() };
        let loads = loads(self, &model, normalised_on.copied().unwrap_or(COARSEST)).map_err(failed)?;
        let runs = WITH_COARSER * self.sampling.surfaces as f64;
        let begun = Instant::now();
        let mut solved: Vec<Vec<Option<Numbers>>> = Vec::new();
        let (mut took, mut before): (f64, Option<Worst>) = (0.0, None);
        for (rung, &longer) in rungs.iter().enumerate() {
            let grown = longer as f64 / rungs[rung.saturating_sub(1)] as f64;
            let next = took * grown.powf(calibration::TIME_EXPONENT);
            let needed = begun.elapsed().as_secs_f64() + next * (1.0 + runs);
            if let (Some(worst), true) = (&before, needed > budget) {
                let (coarser, found, where_) = (rungs[rung - 1], percent(worst.error), worst.words(self));
                let message = format!(
                    "{coarser} cells along the longer side leave {found} ({where_}), {longer} would take about {}, and the budget is {}",
                    time(needed),
                    time(budget)
                );
                return Err(refused(message, "raise `budget`, such as \"2 h\", or ask for less"));
            }
            let start = Instant::now();
            let grid = on_grid(self, &model, longer).map_err(failed)?;
            let timed = || solve(&grid, self.seed(0), &loads, stop);
            solved.push(runs::on_one_thread(timed).map_err(failed)?);
            took = start.elapsed().as_secs_f64();
            let Some(worst) = Worst::of(&controlled(self), &solved) else { continue };
            // One small difference may be chance: the grid before may have had twice the error, no more.
            let coarser = before.as_ref().map(|before| before.error);
            let last = rung + 1 == rungs.len();
            if worst.error <= share && (last || coarser.is_some_and(|coarser| coarser <= 2.0 * share)) {
                return Ok(Chosen { scene: grid, error: worst.error, seconds: took * runs });
            }
            // Even if each doubling halves the error, those that the budget has room for are not enough.
            let left = (budget - begun.elapsed().as_secs_f64()).max(0.0) / (took * (1.0 + runs));
            let affordable = (left.max(1.0).log2() / calibration::TIME_EXPONENT)
                .floor()
                .min((rungs.len() - 1 - rung) as f64);
            if rung >= 3 && worst.error * 0.5_f64.powf(affordable) > share {
                let (found, where_) = (percent(worst.error), worst.words(self));
                let message = format!(
                    "{longer} cells along the longer side leave {found} ({where_}), and the {affordable} doublings that cells and \
                     budget ({}) have room for do not halve that often enough",
                    time(budget)
                );
                return Err(refused(
                    message,
                    "ask for less, for larger loads or fewer outputs, or raise `budget`",
                ));
            }
            before = Some(worst);
        }
        let cells = if given { "the map's own cells" } else { "the largest grid" };
        let message = match &before {
            Some(worst) => format!("{cells} leave {} ({})", percent(worst.error), worst.words(self)),
            None => format!(
                "{cells} are too few to compare with coarser ones, or every load is zero or complete contact"
            ),
        };
        Err(refused(
            message,
            "a contact has to be many cells wide: ask for less, for larger loads or fewer outputs, or for smaller cells",
        ))
    }
}

/// A grid that was chosen.
struct Chosen {
    /// With one model.
    scene: SceneFile,
    /// Error on surface 0.
    error: f64,
    /// Seconds of the run on one thread.
    seconds: f64,
}

/// The largest error of a grid.
struct Worst {
    error: f64,
    /// Name of the quantity, and number of the load.
    quantity: &'static str,
    load: usize,
}

impl Worst {
    /// Of the last grid, compared with the two before it; loads that a grid refuses are left out: the run says so.
    fn of(quantities: &[&'static str], solved: &[Vec<Option<Numbers>>]) -> Option<Self> {
        let [.., quarter, half, fine] = solved else { return None };
        let one = |(load, quantity): (usize, &'static str)| {
            let number = |grid: &Vec<Option<Numbers>>| grid[load].as_ref()?.get(quantity).copied();
            let error = grid_error(number(fine)?, number(half)?, number(quarter)?)?.error;
            Some(Self { error, quantity, load })
        };
        let all = (0..fine.len()).flat_map(|load| quantities.iter().map(move |&quantity| (load, quantity)));
        all.filter_map(one).max_by(|a, b| a.error.total_cmp(&b.error))
    }

    fn words(&self, scene: &SceneFile) -> String {
        format!("`{}` under {}", self.quantity, words::load(scene, self.load))
    }
}

/// The model with a tolerance that an accuracy does not notice, and with no cells given.
fn with_tolerance(scene: &SceneFile, model: &Numerics, share: f64) -> Numerics {
    let tolerance = (share * TOLERANCE_PER_ACCURACY).clamp(TOLERANCES.0, TOLERANCES.1);
    // One digit: it stands in the plan and in every header.
    let tolerance = format!("{tolerance:.0e}").parse().unwrap_or(tolerance);
    match model {
        Numerics::Bem3d(numerics) => {
            Numerics::Bem3d(Bem3d { cells: largest_cells(scene), rows: None, tolerance, ..*numerics })
        }
        other => other.clone(),
    }
}

/// Cells along x of the largest grid.
fn largest_cells(scene: &SceneFile) -> usize {
    let size = scene.surface.size();
    ((MOST_CELLS as f64 * (size.x / size.x.max(size.y))).round() as usize).max(1)
}

/// Grids that double: of free squares one more than powers of two, so that a coarser grid has every second point; of a given map its own
/// cells, every second one, every fourth.
fn rungs(scene: &SceneFile) -> Vec<usize> {
    if let Some(Cells { columns, rows }) = scene.surface.own_cells() {
        let own = columns.max(rows);
        let coarser = |n: &usize| Some(n.div_ceil(2)).filter(|&fewer| fewer >= COARSEST / 4 && fewer < *n);
        let mut rungs: Vec<usize> = std::iter::successors(Some(own), coarser).collect();
        rungs.reverse();
        return rungs;
    }
    let odd = usize::from(scene.effects.boundary == Boundary::Free);
    let doubled = std::iter::successors(Some(COARSEST - 1), |n| Some(2 * n));
    doubled.map(|n| n + odd).take_while(|&n| n <= MOST_CELLS).collect()
}

/// The loads of a scene for surface 0 on a grid, in its own normalisation.
fn loads(scene: &SceneFile, model: &Numerics, longer: usize) -> contact_model::Result<Vec<Load>> {
    let grid = on_grid(scene, model, longer)?;
    let Loading::Loads(loads) = &scene.request else { return Ok(Vec::new()) };
    let seed = scene.seed(0);
    let normalisation =
        grid.models[0].model().prepare(&grid.scene(&grid.models[0], seed)?, seed)?.normalisation();
    loads.values.iter().map(|&value| loads.load(value, &normalisation)).collect()
}
