//! `accuracy` in `[scene]`: the grid that an accuracy asks for, instead of the other way round.

use crate::scenes::plan::{GridErrors, Numbers, calibration, compared, on_grid, solve};
use crate::scenes::read::{
    Diagnostic, LoadRequest, MOST_CELLS, Numerics, Result, SceneFile, cells, short, words,
};
use analysis::{AccuracyTarget, GridTrial, grid_error};
use bem3d::Bem3d;
use contact_model::quantities::{AskedBy, Quantity};
use contact_model::{Boundary, Cells, Load};
use runs::amounts::time;
use std::time::Instant;

/// Polled from any thread, between iterations: `true` means stop now.
pub type SharedStop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Cells along the longer side of the coarsest grid of the pilot.
const COARSEST: usize = 33;
/// The two coarser grids of a state, over the work of the state itself, and that.
const WITH_COARSER: f64 = 1.25;
/// The largest tolerance with areas among what an accuracy is about.
const OF_AREAS: f64 = 1e-5;

/// Whether errors of a state are within a share, in all of what an accuracy is about.
pub(crate) fn within(scene: &SceneFile, errors: &GridErrors, share: f64) -> bool {
    // The best is not missed.
    share <= 0.0 || largest(scene, errors).is_some_and(|error| error <= share)
}

/// Which numbers an accuracy is about: those asked for whose error of the grid is estimated. Of the area it
/// is the corrected one, and the largest pressure, which every scene has, is none of them.
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
    /// A pilot solves the loads on surface 0 with 33, 65, 129, ... cells along the longer side of the grid
    /// (of a given map: with every so many-th of its cells, at last with all of them) and estimates the
    /// errors of stiffness (of either kind), corrected area, conductance and mean gap, as far as they are
    /// outputs, from three grids each ([`analysis::grid_error`]). It stops at the first grid with small
    /// enough errors of which the coarser one's were at most twice as large: nothing is extrapolated. The best
    /// accuracy is that of the finest grid within the budget and the memory. The run
    /// then compares every state with coarser grids itself (`grid_error`): on surface 0 it finds what the
    /// pilot found, and of other surfaces it says where the accuracy is missed. For one surface the pilot
    /// takes as long as the run.
    ///
    /// # Errors
    /// [`crate::scenes::Error::Scene`] where no grid gives the accuracy or the predicted time is beyond the budget, with the accuracy that is to be had;
    /// for a scene without a model, a load or an output that an accuracy could be about;
    /// [`crate::scenes::Error::Run`] for what the pilot's solves refuse.
    pub fn with_grid_for_accuracy(mut self, stop: SharedStop<'_>) -> Result<Self> {
        let Some(target) = self.accuracy else { return Ok(self) };
        calibration::jobs_in_memory(&self, 1)?;
        let place = self.models.iter().position(|m| matches!(m, Numerics::Bem3d(_)));
        let Some(place) = place.filter(|_| matches!(self.request, LoadRequest::Loads(_))) else {
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
            "{}: bem3d on {columns} x {rows} cells, with an error of {} on the first surface, in about {}",
            asked(target),
            percent(chosen.error),
            time(chosen.seconds)
        ));
        self.models[place] = chosen.scene.models[0].clone();
        self.surface = chosen.scene.surface;
        self.requested.grid_error = true;
        self.notes
            .push(note.with_help("The columns `_grid_error` of the results hold the errors of the run."));
        Ok(self)
    }

    /// The first grid that gives an accuracy, with its scene.
    fn first_grid(&self, model: &Numerics, target: AccuracyTarget, stop: SharedStop<'_>) -> Result<Chosen> {
        let failed = |error| runs::Error::model("the pilot of `accuracy`")(error);
        let own = self.surface.own_cells().map(|Cells { columns, rows }| columns.max(rows));
        let given = own.is_some();
        let model = with_tolerance(self, model, target);
        // What else is wrong with a grid is told by its trial.
        let fits = |longer: &usize| {
            !on_grid(self, &model, *longer).is_ok_and(|scene| calibration::jobs_in_memory(&scene, 1).is_err())
        };
        let grids: Vec<usize> = grids(self).into_iter().take_while(fits).collect();
        let normalised_on = if given { grids.last() } else { grids.first() };
        let loads = loads(self, &model, normalised_on.copied().unwrap_or(COARSEST)).map_err(failed)?;
        let runs = WITH_COARSER * self.sampling.surfaces as f64;
        let controlled = controlled(self);
        let mut solved: Vec<Vec<Option<Numbers>>> = Vec::new();
        let trial = |longer: usize| -> Result<GridTrial<(SceneFile, Option<Worst>)>> {
            let start = Instant::now();
            let scene = on_grid(self, &model, longer).map_err(failed)?;
            let timed = || solve(&scene, self.seed(0), &loads, &stop);
            solved.push(runs::on_one_thread(timed).map_err(failed)?);
            let seconds = start.elapsed().as_secs_f64();
            let worst = Worst::of(&controlled, &solved);
            let (error, rest) = (worst.as_ref().map(|worst| worst.error), seconds * runs);
            Ok(GridTrial { error, seconds, rest, least_rest: rest, kept: (scene, worst) })
        };
        let found = analysis::first_grid(&grids, target, calibration::TIME_EXPONENT, trial)?;
        let (_, GridTrial { error, rest, kept, .. }) = found.map_err(|none| {
            let grid = |longer: usize| {
                if given && Some(longer) == own {
                    "the map's own cells".to_owned()
                } else {
                    format!("{longer} cells along the longer side")
                }
            };
            let place = |kept: &(SceneFile, Option<Worst>)| {
                kept.1.as_ref().map_or_else(String::new, |worst| worst.words(self))
            };
            let reason = none.words(target.seconds, &grid, &place, &time);
            let message = format!("{}: {reason}", asked(target));
            let help = "`accuracy = \"best\"` takes what the `budget` and the memory reach; or ask for larger loads, fewer outputs, less, or a \
                        larger `budget`";
            crate::scenes::Error::from(self.at_accuracy(Diagnostic::new(message).with_help(help)))
        })?;
        Ok(Chosen { scene: kept.0, error: error.unwrap_or(0.0), seconds: rest })
    }
}

/// What was asked for.
fn asked(target: AccuracyTarget) -> String {
    if target.is_best() {
        return "the best accuracy within the budget".to_owned();
    }
    format!("an accuracy of {} %", short(100.0 * target.share))
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
    /// Of the last grid, compared with the two before it; loads that a grid refuses are left out: the run
    /// says so.
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
fn with_tolerance(scene: &SceneFile, model: &Numerics, target: AccuracyTarget) -> Numerics {
    match model {
        Numerics::Bem3d(numerics) => {
            // Cells at the boundary of a contact settle late, and differences of areas hold what is left of them.
            let areas = controlled(scene).iter().any(|name| name.contains("area"));
            let tolerance = if areas { target.tolerance().min(OF_AREAS) } else { target.tolerance() };
            let cells = largest_cells(scene);
            Numerics::Bem3d(Bem3d { cells, rows: None, tolerance, ..*numerics })
        }
        other => other.clone(),
    }
}

/// Cells along x of the largest grid.
fn largest_cells(scene: &SceneFile) -> usize {
    let size = scene.surface.size();
    ((MOST_CELLS as f64 * (size.x / size.x.max(size.y))).round() as usize).max(1)
}

/// Grids that double: of free squares one more than powers of two, so that a coarser grid has every second
/// point; of a given map its own cells, every second one, every fourth.
fn grids(scene: &SceneFile) -> Vec<usize> {
    if let Some(Cells { columns, rows }) = scene.surface.own_cells() {
        let own = columns.max(rows);
        let coarser = |n: &usize| Some(n.div_ceil(2)).filter(|&fewer| fewer >= COARSEST / 4 && fewer < *n);
        let mut grids: Vec<usize> = std::iter::successors(Some(own), coarser).collect();
        grids.reverse();
        return grids;
    }
    let odd = usize::from(scene.effects.boundary == Boundary::Free);
    let doubled = std::iter::successors(Some(COARSEST - 1), |n| Some(2 * n));
    doubled.map(|n| n + odd).take_while(|&n| n <= MOST_CELLS).collect()
}

/// The loads of a scene for surface 0 on a grid, in its own normalisation.
fn loads(scene: &SceneFile, model: &Numerics, longer: usize) -> contact_model::Result<Vec<Load>> {
    let grid = on_grid(scene, model, longer)?;
    let LoadRequest::Loads(loads) = &scene.request else { return Ok(Vec::new()) };
    let seed = scene.seed(0);
    let normalisation =
        grid.models[0].model().prepare(&grid.scene(&grid.models[0], seed)?, seed)?.normalisation();
    loads.values.iter().map(|&value| loads.load(value, &normalisation)).collect()
}
