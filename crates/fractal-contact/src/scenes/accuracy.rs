//! `accuracy` in `[scene]`: the grid that an accuracy asks for, instead of the other way round.

use crate::scenes::accuracy_target::AccuracyTarget;
use crate::scenes::any_model::AnyModel;
use crate::scenes::calibration;
use crate::scenes::diagnostic::Diagnostic;
use crate::scenes::error::Result;
use crate::scenes::grid_comparison::{COMPARED, GridErrors, Quantities, on_grid, solve};
use crate::scenes::human_readable::time;
use crate::scenes::loads::Loading;
use crate::scenes::numerics::{MOST_CELLS, Numerics};
use crate::scenes::scene_file::{SceneFile, cells};
use crate::scenes::scene_surface::SceneSurface;
use analysis::{grid_error, least_squares};
use bem3d::Bem3d;
use contact_model::{Boundary, Cells, Load, Stop, Surface};

/// Tolerance of the solver as a part of the accuracy, and its limits.
const TOLERANCE_PER_ACCURACY: f64 = 1.0 / 30.0;
const TOLERANCES: (f64, f64) = (1e-6, 1e-3);
/// Cells along the longer side of the grids of the pilot: at most, and its coarsest grid.
const PILOT_CELLS: usize = 257;
const COARSEST: usize = 33;

/// Whether errors of a state are within a share, in all of what an accuracy is about.
pub(crate) fn within(scene: &SceneFile, errors: &GridErrors, share: f64) -> bool {
    largest(scene, errors).is_some_and(|error| error <= share)
}

/// Which numbers an accuracy is about: places in [`COMPARED`].
fn controlled(scene: &SceneFile) -> Vec<usize> {
    let outputs = &scene.requested.outputs;
    let asked =
        [("stiffness", outputs.stiffness), ("area_corrected", outputs.area), ("mean_gap", outputs.mean_gap)];
    let place = |name: &str| COMPARED.iter().position(|compared| *compared == name);
    asked.into_iter().filter(|(_, asked)| *asked).filter_map(|(name, _)| place(name)).collect()
}

/// The largest error of what an accuracy is about; `None` where one is unknown.
fn largest(scene: &SceneFile, errors: &GridErrors) -> Option<f64> {
    controlled(scene).into_iter().try_fold(0.0_f64, |largest, i| Some(largest.max(errors[i]?.error)))
}

impl SceneFile {
    /// The scene with the grid and the tolerance that its `accuracy` asks for; itself where it asks for none.
    ///
    /// A pilot solves the loads on surface 0 with 33 to 257 cells along the longer side of the grid (a given map: every so many-th of its cells)
    /// and estimates the errors of stiffness, corrected area and mean gap, as far as they are outputs, from three grids each
    /// ([`analysis::grid_error`]). Where 257 cells are not enough, the differences are carried on with the order that their median over the
    /// loads shows. The run then
    /// compares every state with coarser grids itself (`grid_error`), and says where the accuracy is missed.
    ///
    /// # Errors
    /// [`crate::scenes::Error::Scene`] where no grid gives the accuracy or the predicted time is beyond the budget, with the accuracy that is to be had;
    /// for a scene without a model, a load or an output that an accuracy could be about; [`crate::scenes::Error::Run`] for what the pilot's
    /// solves refuse.
    pub fn with_grid_for_accuracy(mut self, stop: Stop<'_>) -> Result<Self> {
        let Some(target) = self.accuracy else { return Ok(self) };
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
                    .with_help("ask for `stiffness`, `area` or `mean_gap` in [outputs]");
            return Err(self.at_accuracy(diagnostic).into());
        }
        // A theory beside it says what a map is good for on its own grid; only bem3d has another one.
        if self.models.iter().enumerate().any(|(i, m)| i != place && m.boundary_elements().is_some()) {
            let diagnostic =
                Diagnostic::new("`accuracy` with two models that have cells").with_help("name one of them");
            return Err(self.at_accuracy(diagnostic).into());
        }
        let pilot = Pilot::solve(&self, &self.models[place], target, stop)?;
        let chosen = pilot.choose(&self, target).map_err(|diagnostic| self.at_accuracy(*diagnostic))?;
        let Cells { columns, rows } = cells(&chosen.scene, &chosen.scene.models[0]);
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let note = Diagnostic::note(format!(
            "accuracy of {}: bem3d on {columns} x {rows} cells, where {} is expected, in about {}",
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
}

/// A grid that was chosen.
struct Chosen {
    /// With one model.
    scene: SceneFile,
    /// Error that is expected.
    error: f64,
    /// Seconds of one thread.
    seconds: f64,
}

/// Solves on grids that double, and what they say about finer ones.
struct Pilot {
    model: Numerics,
    /// Cells along the longer side, from the coarsest grid.
    rungs: Vec<usize>,
    /// Of each quantity that the accuracy is about, under each load, on each rung that was solved.
    solved: Vec<Vec<Vec<f64>>>,
}

impl Pilot {
    fn solve(scene: &SceneFile, model: &Numerics, target: AccuracyTarget, stop: Stop<'_>) -> Result<Self> {
        let tolerance = (target.share * TOLERANCE_PER_ACCURACY).clamp(TOLERANCES.0, TOLERANCES.1);
        // One digit: it stands in the plan and in every header.
        let tolerance = format!("{tolerance:.0e}").parse().unwrap_or(tolerance);
        let model = match model {
            Numerics::Bem3d(numerics) => {
                Numerics::Bem3d(Bem3d { cells: largest_cells(scene), rows: None, tolerance, ..*numerics })
            }
            other => other.clone(),
        };
        let rungs = rungs(scene);
        let tried =
            rungs.iter().take_while(|&&n| n <= PILOT_CELLS).count().clamp(3.min(rungs.len()), rungs.len());
        let refused = |error| runs::Error::model("the pilot of `accuracy`")(error);
        let loads = loads(scene, &model, rungs[tried - 1]).map_err(refused)?;
        let mut found: Vec<Vec<Option<Quantities>>> = Vec::new();
        for &longer in &rungs[..tried] {
            let coarse = on_grid(scene, &model, longer).map_err(refused)?;
            found.push(solve(&coarse, scene.seed(0), &loads, stop).map_err(refused)?);
        }
        // A load that a grid refuses is no part of it: the run says so.
        let number = |i: usize, load: usize| -> Option<Vec<f64>> {
            found.iter().map(|rung| rung[load].as_ref().and_then(|quantities| quantities[i])).collect()
        };
        let of = |i: usize| (0..loads.len()).filter_map(|load| number(i, load)).collect();
        let solved = controlled(scene).into_iter().map(of).collect();
        Ok(Self { model, rungs, solved })
    }

    /// The largest error to expect on a rung, over loads and quantities; `None` where nothing can be said of one.
    fn expected(&self, rung: usize) -> Option<f64> {
        let each = self.solved.iter().map(|loads| expected(loads, rung));
        each.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
    }

    /// The coarsest grid that should do.
    fn choose(
        &self,
        scene: &SceneFile,
        target: AccuracyTarget,
    ) -> std::result::Result<Chosen, Box<Diagnostic>> {
        let AccuracyTarget { share, seconds } = target;
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let refused = |message: String, help: String| Box::new(Diagnostic::new(message).with_help(help));
        let candidates: Vec<(usize, f64)> =
            (2..self.rungs.len()).filter_map(|rung| Some((rung, self.expected(rung)?))).collect();
        let given = matches!(scene.surface, SceneSurface::Plain(Surface::Heights(_)));
        let finest = match self.rungs.last() {
            Some(_) if given => "the map's own cells".to_owned(),
            Some(cells) => format!("the largest grid, {cells} cells a side,"),
            None => "no grid".to_owned(),
        };
        let Some(&(rung, error)) = candidates.iter().find(|(_, error)| *error <= share) else {
            let best = candidates.iter().map(|c| c.1).reduce(f64::min);
            let message = match best {
                Some(best) => {
                    format!("an accuracy of {}: {finest} should give {}", percent(share), percent(best))
                }
                None => {
                    format!(
                        "an accuracy of {}: there are too few cells, or loads, to compare grids",
                        percent(share)
                    )
                }
            };
            let help = "a contact has to be many cells wide: ask for less, for larger loads, for fewer outputs, for a surface with a \
                        `shortest_wavelength`, or measure it with smaller cells; `grid_error = true` shows which state is worst";
            return Err(refused(message, help.into()));
        };
        let made = |rung: usize| -> Option<(SceneFile, f64)> {
            let mut grid = on_grid(scene, &self.model, self.rungs[rung]).ok()?;
            grid.requested.grid_error = true;
            let cost = calibration::predict(&grid, &grid.models[0]);
            Some((grid, cost.seconds))
        };
        match made(rung) {
            Some((scene, cost)) if cost <= seconds => Ok(Chosen { scene, error, seconds: cost }),
            found => {
                let costs = found
                    .map_or_else(|| "more than can be told".to_owned(), |f| format!("about {}", time(f.1)));
                let bought = candidates
                    .iter()
                    .rev()
                    .filter(|c| c.0 < rung)
                    .find(|c| made(c.0).is_some_and(|m| m.1 <= seconds));
                let buys = bought.map_or_else(
                    || "buys no grid of which the error is known".to_owned(),
                    |c| format!("buys {}", percent(c.1)),
                );
                let message = format!(
                    "an accuracy of {} takes {costs} with {} cells a side: the budget of {} {buys}",
                    percent(share),
                    self.rungs[rung],
                    time(seconds)
                );
                Err(refused(message, "raise `budget`, such as \"2 h\", or ask for less".into()))
            }
        }
    }
}

/// The largest error over loads of a quantity on a rung; the numbers of each load are those of the first rungs. Where the rung was solved with
/// the two before it, its error is that of these; else the middle order of all loads carries on the differences.
fn expected(loads: &[Vec<f64>], rung: usize) -> Option<f64> {
    let solved = loads.first()?.len();
    if rung < solved {
        let last = rung.checked_sub(2)?;
        let errors = loads.iter().map(|q| grid_error(q[rung], q[rung - 1], q[last]).map(|found| found.error));
        return errors.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max);
    }
    // Relative differences between rungs i and i + 1.
    let difference = |q: &Vec<f64>, i: usize| (q[i + 1] - q[i]).abs() / q[solved - 1].abs();
    let middle = |i: usize| {
        let mut all: Vec<f64> = loads.iter().map(|q| difference(q, i)).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let falls: Vec<(f64, f64)> = (0..solved - 1).map(|i| (i as f64, middle(i).log2())).collect();
    let order = -least_squares(&falls)?.0;
    if order.is_nan() || order <= 0.0 {
        return None;
    }
    let carried = |q: &Vec<f64>, i: usize| difference(q, i) * (-order * (rung - 1 - i) as f64).exp2();
    let last = |q: &Vec<f64>| (0..solved - 1).map(|i| carried(q, i)).fold(0.0, f64::max);
    let errors = loads.iter().map(|q| {
        let last = last(q);
        Some(grid_error(1.0, 1.0 + last, 1.0 + last + last * order.exp2())?.error)
    });
    errors.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
}

/// Cells along x of the largest grid.
fn largest_cells(scene: &SceneFile) -> usize {
    let size = scene.surface.size();
    ((MOST_CELLS as f64 * (size.x / size.x.max(size.y))).round() as usize).max(1)
}

/// Grids that double: of free squares one more than powers of two, so that a coarser grid has every second point; of a given map its own
/// cells, every second one, every fourth.
fn rungs(scene: &SceneFile) -> Vec<usize> {
    if let SceneSurface::Plain(Surface::Heights(map)) = &scene.surface {
        let own = map.columns().max(map.rows());
        let halves = std::iter::successors(Some(own), |n| Some(n.div_ceil(2)));
        let mut rungs: Vec<usize> = halves.take_while(|&n| n == own || n >= COARSEST / 4).collect();
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
    let (Loading::Loads(loads), AnyModel::Contact(model)) = (&scene.request, grid.models[0].model()) else {
        return Ok(Vec::new());
    };
    let seed = scene.seed(0);
    let normalisation = model.prepare(&grid.scene(&grid.models[0], seed)?, seed)?.normalisation();
    loads.values.iter().map(|&value| loads.load(value, &normalisation)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_carried_on_with_their_order() {
        // First order: 1 + h on h = 8, 4, 2, 1 hundredths, and twice that.
        let loads: Vec<Vec<f64>> =
            [1.0, 2.0].map(|slope| [0.08, 0.04, 0.02, 0.01].map(|h| 1.0 + slope * h).to_vec()).to_vec();
        let near = |found: Option<f64>, error: f64| {
            assert!((found.unwrap() / error - 1.0).abs() < 0.03, "{found:?} of {error}");
        };
        // 1.5 times the difference of the larger slope, then half of it for each rung.
        near(expected(&loads, 3), 1.5 * 0.02 / 1.02);
        near(expected(&loads, 4), 0.75 * 0.02 / 1.02);
        near(expected(&loads, 6), 1.5 * 0.02 / 1.02 / 8.0);
        assert_eq!(expected(&loads, 1), None);
        // Differences that grow have no order to carry on, but errors on the rungs that were solved.
        let grow = [vec![1.0, 1.1, 1.3, 1.7]];
        assert_eq!((expected(&grow, 4), expected(&grow, 3).is_some()), (None, true));
        assert_eq!(expected(&[], 3), None);
    }
}
