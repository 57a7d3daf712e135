//! `accuracy` in `[scene]`: the grid that an accuracy asks for, instead of the other way round.
//!
//! The choice is a function of the scene, of the errors that its grids are found to have, and of the cost
//! model that is compiled in. No clock enters, and nothing of the machine: the same scene has the same grid
//! everywhere.

use crate::scenes::plan::grid_comparison::FEWEST_CELLS;
use crate::scenes::plan::{GridErrors, calibration, compared, on_grid};
use crate::scenes::read::{
    Diagnostic, LoadRequest, MOST_CELLS, Numerics, RequestedAccuracy, Result, SceneFile, cells, short, words,
};
use analysis::{AccuracyTarget, GridTrial};
use bem3d::Bem3d;
use contact_model::quantities::{AskedBy, StateQuantity};
use contact_model::{Boundary, Cells};
use runs::amounts::{memory, time};

/// Cells along the longer side of the coarsest grid that is tried; it is compared with a half and a quarter
/// of them.
const COARSEST: usize = 128;
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
    let asked = |quantity: &&StateQuantity| match quantity.asked_by {
        AskedBy::Output(output) => scene.requested.outputs.asks(output),
        _ => false,
    };
    compared().filter(asked).map(|quantity| quantity.name).filter(|name| *name != "area").collect()
}

/// The largest error of what an accuracy is about; `None` where one is unknown.
fn largest(scene: &SceneFile, errors: &GridErrors) -> Option<f64> {
    controlled(scene).into_iter().try_fold(0.0_f64, |largest, name| Some(largest.max(errors.of(name)?.error)))
}

/// A grid that may be chosen, with its cost by the model that is compiled in.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// The scene with this grid: its run is that of the chosen one.
    pub scene: SceneFile,
    /// Place of `bem3d` among its models.
    pub model: usize,
    /// Memory of one surface at most, in bytes.
    pub memory: f64,
    /// Seconds of one surface with its coarser grids, and of all surfaces.
    seconds: [f64; 2],
    /// Cells along the longer side.
    longer: usize,
    /// Whether these are all cells of a given map.
    is_own: bool,
}

impl Candidate {
    fn new(scene: &SceneFile, model: usize, numerics: &Numerics, longer: usize) -> Result<Self> {
        let failed = runs::Error::model(format!("a grid of {longer} cells along the longer side"));
        let mut on = on_grid(scene, numerics, longer).map_err(failed)?;
        let mut whole = scene.clone();
        (whole.models[model], whole.surface) = (on.models.remove(0), on.surface);
        // The run compares every state with coarser grids, and so the trial of a grid is a part of its run.
        whole.requested.grid_error = true;
        let all = calibration::of_sizes(&whole, model).seconds;
        let surfaces = whole.surfaces_of(&whole.models[model]) as f64;
        let is_own = scene.surface.own_cells().is_some_and(|own| own.columns.max(own.rows) == longer);
        let memory = calibration::largest_memory(&whole, model);
        Ok(Self { scene: whole, model, memory, seconds: [all / surfaces, all], longer, is_own })
    }

    /// Its cells.
    pub fn cells(&self) -> Cells {
        cells(&self.scene, &self.scene.models[self.model])
    }

    /// Its name in messages.
    fn words(&self) -> String {
        if self.is_own {
            "the map's own cells".to_owned()
        } else {
            format!("{} cells along the longer side", self.longer)
        }
    }
}

/// Errors of the states of surface 0 on a grid, by the number of the load; `None` where they are not known.
pub(crate) type ErrorsOfStates = Vec<Option<GridErrors>>;

/// The grid and the tolerance that an accuracy asks for.
///
/// `errors` solves the loads on surface 0 on grids that double, from the coarsest one, and this takes the
/// first one with small enough errors of which the coarser one's were at most twice as large: nothing is
/// extrapolated. Counted are stiffness (of either kind), corrected area, conductance and mean gap, as far as
/// they are outputs. The best accuracy is that of the finest grid within the budget and the memory, for which
/// nothing is solved.
///
/// # Errors
/// [`crate::scenes::Error::Scene`] where no grid gives the accuracy or its predicted time is beyond the budget, with the
/// accuracy that is to be had; for a scene without a model, a load or an output that an accuracy could be
/// about; what `errors` returns.
pub(crate) fn choose(
    scene: &SceneFile,
    requested: RequestedAccuracy,
    errors: &mut dyn FnMut(&Candidate) -> Result<ErrorsOfStates>,
) -> Result<Candidate> {
    let RequestedAccuracy { target, memory: most } = requested;
    let model = model(scene)?;
    let mut all = candidates(scene, model, target)?;
    let fitting = all.iter().take_while(|candidate| candidate.memory <= most).count();
    let beyond = all.get(fitting).map(|candidate| {
        let needed = memory(candidate.memory);
        format!("{} need up to {needed}, and the `memory` is {}", candidate.words(), memory(most))
    });
    all.truncate(fitting);
    if all.is_empty() {
        return Err(none_found(scene, requested, &beyond.unwrap_or_default()).into());
    }
    let coarsest = &all[0];
    if coarsest.seconds[1] > target.seconds {
        let [takes, budget] = [coarsest.seconds[1], target.seconds].map(time);
        let reason = format!("{} would take about {takes}, and the budget is {budget}", coarsest.words());
        return Err(none_found(scene, requested, &reason).into());
    }
    let (mut chosen, note) = if target.is_best() {
        let finest = all.iter().rposition(|candidate| candidate.seconds[1] <= target.seconds);
        let chosen = all.swap_remove(finest.unwrap_or_default());
        let note = chosen_words(&chosen, "");
        (chosen, note)
    } else {
        let grids: Vec<usize> = all.iter().map(|candidate| candidate.longer).collect();
        let trial = |longer: usize| -> Result<GridTrial<(usize, Option<Worst>)>> {
            let place = grids.iter().position(|&grid| grid == longer).unwrap_or_default();
            let worst = Worst::of(&controlled(scene), &errors(&all[place])?);
            let [one, surfaces] = all[place].seconds;
            // The run takes the states of surface 0 from the trial.
            let rest = surfaces - one;
            let error = worst.as_ref().map(|worst| worst.error);
            Ok(GridTrial { error, seconds: one, rest, least_rest: rest, kept: (place, worst) })
        };
        let found = analysis::first_grid(&grids, target, calibration::time_exponent(scene), trial)?;
        let found = found.map_err(|none| {
            let name = |longer: usize| {
                all.iter().find(|c| c.longer == longer).map_or_else(String::new, Candidate::words)
            };
            let place = |kept: &(usize, Option<Worst>)| {
                kept.1.as_ref().map_or_else(String::new, |worst| worst.words(scene))
            };
            let mut reason = none.words(target.seconds, &name, &place, &time);
            if let (analysis::NoGrid::Finest(_), Some(beyond)) = (&none, &beyond) {
                reason += &format!("; {beyond}");
            }
            none_found(scene, requested, &reason)
        })?;
        let unconfirmed = (!found.is_confirmed)
            .then(|| unconfirmed_words(&all, found.confirming, target.seconds, beyond.as_deref()));
        let mut chosen = all.swap_remove(found.trial.kept.0);
        let error = found.trial.error.map(|error| short(100.0 * error)).unwrap_or_default();
        let mut note = chosen_words(&chosen, &format!(" with an error of {error} % on the first surface,"));
        chosen.scene.is_unconfirmed = unconfirmed.is_some();
        note += unconfirmed.as_deref().unwrap_or_default();
        (chosen, note)
    };
    let note = Diagnostic::note(format!("{}: {note}", asked(target)));
    chosen
        .scene
        .notes
        .push(note.with_help("The columns `_grid_error` of the results hold the errors of the run."));
    Ok(chosen)
}

/// That no finer grid confirms an error, and what one that would takes: it is too large for the budget or, by the
/// words `beyond`, for the memory.
fn unconfirmed_words(
    all: &[Candidate],
    confirming: Option<(usize, f64)>,
    budget: f64,
    beyond: Option<&str>,
) -> String {
    let how = match (confirming, beyond) {
        (Some((longer, seconds)), _) => {
            let finer =
                all.iter().find(|finer| finer.longer == longer).map_or_else(String::new, Candidate::words);
            format!("{finer} would confirm it in about {}, and the budget is {}", time(seconds), time(budget))
        }
        (None, Some(beyond)) => format!("a finer grid would confirm it, but {beyond}"),
        (None, None) => "there is no finer grid that would confirm it".to_owned(),
    };
    format!(". The error is estimated, not confirmed: {how}")
}

fn chosen_words(chosen: &Candidate, error: &str) -> String {
    let Cells { columns, rows } = chosen.cells();
    let takes = time(chosen.seconds[1]);
    format!("bem3d on {columns} x {rows} cells,{error} in about {takes} of a thread of the reference machine")
}

fn none_found(scene: &SceneFile, requested: RequestedAccuracy, reason: &str) -> Diagnostic {
    let help = "`accuracy = \"best\"` takes what the `budget` and the `memory` reach; or ask for larger loads, fewer \
                outputs, a larger error, or a larger `budget` or `memory`";
    let message = format!("{}: {reason}", asked(requested.target));
    scene.at_accuracy(Diagnostic::new(message).with_help(help))
}

/// What was asked for.
fn asked(target: AccuracyTarget) -> String {
    if target.is_best() {
        return "the best accuracy within the budget and the memory".to_owned();
    }
    format!("an accuracy of {} %", short(100.0 * target.share))
}

/// The place of `bem3d`, in a scene for which it can choose a grid.
fn model(scene: &SceneFile) -> Result<usize> {
    let place = scene.models.iter().position(|m| matches!(m, Numerics::Bem3d(_)));
    let Some(place) = place.filter(|_| matches!(scene.request, LoadRequest::Loads(_))) else {
        let diagnostic =
            Diagnostic::new("`accuracy` chooses the grid of bem3d under loads, and there is none here")
                .with_help("remove it, or name \"bem3d\" in `models`");
        return Err(scene.at_accuracy(diagnostic).into());
    };
    if controlled(scene).is_empty() {
        let diagnostic = Diagnostic::new("`accuracy` of what? no number that it could be about is an output")
            .with_help("ask for `stiffness`, `area`, `conductance` or `mean_gap` in [outputs]");
        return Err(scene.at_accuracy(diagnostic).into());
    }
    if scene.surface.differs_by_grid() {
        let diagnostic = Diagnostic::new(
            "`accuracy` compares grids, and a surface with a prescribed distribution of heights is another one on each",
        )
        .with_help("give `cells` in [models.bem3d] and `grid_error = true`: coarser grids then sample one surface");
        return Err(scene.at_accuracy(diagnostic).into());
    }
    Ok(place)
}

/// The grids to choose from, from coarse to fine: those that have coarser ones to be compared with.
fn candidates(scene: &SceneFile, model: usize, target: AccuracyTarget) -> Result<Vec<Candidate>> {
    let numerics = with_tolerance(scene, &scene.models[model], target);
    let grids = grids(scene);
    if grids.is_empty() {
        let own = scene.surface.own_cells().map_or(0, |own| own.columns.max(own.rows));
        let diagnostic = Diagnostic::new(format!(
            "{}: the map's own cells are too few to compare with coarser ones, {own} along the longer side",
            asked(target)
        ))
        .with_help(format!("an accuracy needs at least {}; remove it", fewest_of_a_map()));
        return Err(scene.at_accuracy(diagnostic).into());
    }
    grids.into_iter().map(|longer| Candidate::new(scene, model, &numerics, longer)).collect()
}

/// The largest error of a grid.
struct Worst {
    error: f64,
    /// Name of the quantity, and number of the load.
    quantity: &'static str,
    load: usize,
}

impl Worst {
    /// Over all states; those without an error are left out: the run says so.
    fn of(quantities: &[&'static str], errors: &ErrorsOfStates) -> Option<Self> {
        let of_state = |(load, errors): (usize, &Option<GridErrors>)| {
            let one = |&quantity| Some(Self { error: errors.as_ref()?.of(quantity)?.error, quantity, load });
            quantities.iter().filter_map(one).max_by(|a, b| a.error.total_cmp(&b.error))
        };
        errors.iter().enumerate().filter_map(of_state).max_by(|a, b| a.error.total_cmp(&b.error))
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

/// The fewest cells along the longer side of a map that can be compared with coarser ones.
fn fewest_of_a_map() -> usize {
    4 * (FEWEST_CELLS - 1) + 1
}

/// Grids that double: of free squares one more than powers of two, so that a coarser grid has every second
/// point; of a given map its own cells, every second one, every fourth.
fn grids(scene: &SceneFile) -> Vec<usize> {
    if let Some(Cells { columns, rows }) = scene.surface.own_cells() {
        let coarser = |n: &usize| Some(n.div_ceil(2)).filter(|fewer| fewer < n);
        let all = std::iter::successors(Some(columns.max(rows)), coarser);
        let mut grids: Vec<usize> = all.take_while(|&n| n >= fewest_of_a_map()).collect();
        grids.reverse();
        return grids;
    }
    let odd = usize::from(scene.effects.boundary == Boundary::Free);
    let doubled = std::iter::successors(Some(COARSEST), |n| Some(2 * n));
    doubled.map(|n| n + odd).take_while(|&n| n <= MOST_CELLS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{LoadList, PrescribedLoad, SceneSurface};
    use contact_model::{SelfAffine, Surface};

    fn scene(accuracy: &str, surfaces: usize) -> SceneFile {
        let text = format!(
            "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\nmean_pressure = [1e-3, 1e-2]\n{accuracy}\n\
             [scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.8\nrms_height = 0.01\n\
             [effects]\nboundary = \"periodic\"\n[outputs]\nstiffness = true\n[sampling]\nseed = 5\nsurfaces = {surfaces}\n"
        );
        SceneFile::parse("scene.toml".as_ref(), text).unwrap()
    }

    /// The grid that is chosen, or why there is none, where the stiffness under the second load has an error
    /// of `order` over the cells, and the grids that were tried.
    fn chosen(scene: &SceneFile, error: impl Fn(usize) -> f64) -> (Result<usize, String>, Vec<usize>) {
        let mut tried = Vec::new();
        let mut errors = |candidate: &Candidate| {
            tried.push(candidate.longer);
            let of = |share: f64| {
                let mut error = analysis::grid_error(1.0, 1.1, 1.3).unwrap();
                error.error = share;
                Some(GridErrors { rms_slope: 0.1, errors: [("stiffness".to_owned(), error)].into() })
            };
            Ok(vec![of(0.1 * error(candidate.longer)), of(error(candidate.longer)), None])
        };
        let found = choose(scene, scene.accuracy.unwrap(), &mut errors);
        (found.map(|found| found.longer).map_err(|error| error.to_string()), tried)
    }

    /// A grid whose error is small enough is taken where a finer one, which would confirm it, takes too long; the
    /// note and the plan say so.
    #[test]
    fn an_error_that_no_finer_grid_confirms_is_marked() {
        let scene = scene("accuracy = 0.01\nbudget = \"4 s\"", 1);
        let mut errors = |candidate: &Candidate| {
            let mut error = analysis::grid_error(1.0, 1.1, 1.3).unwrap();
            error.error = if candidate.longer < 512 { 0.05 } else { 0.008 };
            Ok(vec![Some(GridErrors { rms_slope: 0.1, errors: [("stiffness".to_owned(), error)].into() })])
        };
        let found = choose(&scene, scene.accuracy.unwrap(), &mut errors).unwrap();
        assert_eq!((found.longer, found.scene.is_unconfirmed), (512, true));
        let note = found.scene.notes.last().unwrap().message().to_owned();
        for words in [
            "error of 0.8000 %",
            "estimated, not confirmed: 1024 cells along the longer side would confirm it in about ",
        ] {
            assert!(note.contains(words), "{note}");
        }
        let plan = crate::scenes::Plan::new(&found.scene).unwrap();
        assert!(plan.to_string().contains("estimated, not confirmed"), "{plan}");
    }

    #[test]
    fn a_table_of_errors_chooses_the_grid() {
        let first_order = |n: usize| 4.0 / n as f64;
        let asked = |keys: &str| chosen(&scene(keys, 1), first_order);
        // 4/256 is enough, and 4/128 at most twice as much.
        assert_eq!(asked("accuracy = 0.016"), (Ok(256), vec![128, 256]));
        assert_eq!(asked("accuracy = 0.015"), (Ok(512), vec![128, 256, 512]));
        assert_eq!(asked("accuracy = 0.016\nbudget = \"1 h\"\nmemory = \"1 TB\"").0, Ok(256));
        let (refused, tried) = asked("accuracy = 1e-3\nbudget = \"2 s\"");
        let refused = refused.unwrap_err();
        assert!(tried.len() < 5 && refused.contains(" and the budget is 2.0 s"), "{tried:?} {refused}");
        assert!(refused.contains("(`stiffness` under mean pressure 0.01)"), "{refused}");
        let (refused, tried) = asked("accuracy = 1e-3\nmemory = \"70 MB\"");
        let refused = refused.unwrap_err();
        assert_eq!(tried, [128, 256, 512]);
        assert!(
            refused.contains("1024 cells along the longer side need up to 236 MB, and the `memory` is 70 MB"),
            "{refused}"
        );
        assert!(asked("accuracy = 1e-3\nmemory = \"1 MB\"").1.is_empty());
    }

    /// Nothing is solved for it.
    #[test]
    fn the_best_is_the_finest_grid_within_budget_and_memory() {
        let best = |keys: &str, surfaces: usize| {
            let (found, tried) =
                chosen(&scene(&format!("accuracy = \"best\"\n{keys}"), surfaces), |_| f64::NAN);
            assert!(tried.is_empty());
            found
        };
        // Two states of 1.2 us for each cell, and a fourth more for the coarser grids.
        assert_eq!(best("budget = \"3.3 s\"", 1), Ok(1024));
        assert_eq!(best("budget = \"3.3 s\"", 4), Ok(512));
        assert_eq!(best("budget = \"1 h\"", 1), Ok(4096));
        assert_eq!(best("budget = \"1 h\"\nmemory = \"16 GB\"", 1), Ok(8192));
        assert!(best("budget = \"1 us\"", 1).unwrap_err().contains("and the budget is under 1 ms"));
    }

    #[test]
    fn adhesion_takes_longer() {
        let mut scene = scene("accuracy = \"best\"\nbudget = \"1 min\"", 1);
        assert_eq!(chosen(&scene, |_| 0.0).0, Ok(2048));
        scene.effects.adhesion = contact_model::Adhesion::ShortRange { work: 1e-3 };
        assert_eq!(chosen(&scene, |_| 0.0).0, Ok(512));
    }

    #[test]
    fn grids_have_coarser_ones_to_be_compared_with() {
        let plain = |surface| {
            let loads = LoadRequest::Loads(LoadList { kind: PrescribedLoad::Force, values: vec![1.0] });
            SceneFile::new(vec![Numerics::Bem3d(Bem3d::default())], SceneSurface::Plain(surface), 1.0, loads)
        };
        let free = plain(Surface::SelfAffine(SelfAffine::new(2.2, 1.0, 0.01).unwrap()));
        assert_eq!(grids(&free)[..3], [129, 257, 513]);
        let map = |columns: usize| {
            let heights = (0..2 * columns).map(|i| i as f64).collect();
            let map = contact_model::HeightMap::new([columns, 2], [columns as f64, 2.0], heights).unwrap();
            grids(&plain(Surface::Heights(std::sync::Arc::new(map))))
        };
        assert_eq!(map(1000), [63, 125, 250, 500, 1000]);
        assert_eq!((map(61), map(60)), (vec![61], vec![]));
    }
}
