//! What the grid does to a state: the same load on the same surface with cells twice and four times as large.

use crate::scenes::plan::with_interface;
use crate::scenes::read::{Numerics, SceneFile, cells};
use analysis::{GridError, grid_error};
use contact_model::quantities::{Compared, QUANTITIES, StateQuantity};
use contact_model::{
    Boundary, Cells, ContactState, Error, HeightMap, Load, Normalisation, Output, Result, Scene, Stop,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Grids with fewer cells along their longer side say nothing.
pub(crate) const FEWEST_CELLS: usize = 16;

/// Largest relative change of the rms slope, from cells to those twice as large, of a surface whose waves the
/// larger cells still carry. Of such waves it changes by rounding alone; of self-affine ones down to the cell by
/// 4 % and more, on up to 8192 cells a side.
const RESOLVED_SLOPE: f64 = 0.02;

/// Name of the slope of a surface in tables of what a grid does.
pub(crate) const RMS_SLOPE: &str = "rms_slope";

/// Numbers of one state on one grid, by their names; those that the model does not claim are absent.
type GridNumbers = BTreeMap<&'static str, f64>;

/// What the grid does to a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct GridErrors {
    /// Rms slope of the surface on its own grid.
    pub rms_slope: f64,
    /// Errors by the names of quantities, and of the slope.
    pub errors: BTreeMap<String, GridError>,
}

impl GridErrors {
    /// The error of a quantity, where it is known.
    pub fn of(&self, name: &str) -> Option<GridError> {
        self.errors.get(name).copied()
    }
}

/// The quantities that are compared, where a scene asks for them.
pub(crate) fn compared() -> impl Iterator<Item = &'static StateQuantity> {
    QUANTITIES.iter().filter(|quantity| quantity.compared != Compared::No)
}

fn numbers(state: &ContactState, normalisation: &Normalisation, rms_slope: f64) -> GridNumbers {
    let found = compared().filter_map(|q| Some((q.name, q.number(state, normalisation)?)));
    found.chain([(RMS_SLOPE, rms_slope)]).collect()
}

/// Their errors from three grids, where they are known to hold. The largest pressure has a limit where no edge
/// carries load and where finer cells bring no shorter waves, which the slope of the surface shows.
fn errors(
    boundary: Boundary,
    fine: &GridNumbers,
    half: &GridNumbers,
    quarter: &GridNumbers,
) -> BTreeMap<String, GridError> {
    let resolved = match (fine.get(RMS_SLOPE), half.get(RMS_SLOPE)) {
        (Some(fine), Some(half)) => (half - fine).abs() <= RESOLVED_SLOPE * fine,
        _ => false,
    };
    let limited = boundary == Boundary::Periodic && resolved;
    let unknown = |name: &str| {
        !limited && StateQuantity::named(name).is_some_and(|quantity| quantity.compared == Compared::Periodic)
    };
    let error = |(&name, &fine): (&&'static str, &f64)| {
        let error = grid_error(fine, *half.get(name)?, *quarter.get(name)?)?;
        (!unknown(name)).then(|| (name.to_owned(), error))
    };
    let mut errors: BTreeMap<String, GridError> = fine.iter().filter_map(error).collect();
    if let (Some(error), Some(least)) = (errors.get_mut("area"), least_area_error(fine)) {
        error.error = error.error.max(least);
    }
    errors
}

/// The relative difference between the counted area and the one corrected for the cells at its boundary. A few cells in
/// contact may have the same area on all three grids although the area is far from its limit.
fn least_area_error(fine: &GridNumbers) -> Option<f64> {
    let (area, corrected) = (fine.get("area")?, fine.get("area_corrected")?);
    (*area > 0.0).then(|| (1.0 - corrected / area).abs())
}

/// The states of a surface on coarser grids.
pub(crate) struct GridComparison {
    /// Of the surface on its own grid.
    pub rms_slope: f64,
    boundary: Boundary,
    /// Under each load, with cells twice and four times as large; `None` where a grid does not answer.
    coarser: Vec<Option<[GridNumbers; 2]>>,
}

impl GridComparison {
    /// Solves the loads on both coarser grids, about a quarter of the work of the grid itself.
    ///
    /// # Errors
    /// [`Error::Stopped`]; what drawing the surface or preparing it refuses.
    pub fn solve(
        scene: &SceneFile,
        numerics: &Numerics,
        seed: u64,
        loads: &[Load],
        stop: Stop<'_>,
    ) -> Result<Self> {
        let boundary = scene.effects.boundary;
        let rms_slope = rms_slope(scene, &*solved_map(scene, numerics, seed, stop)?)?;
        let Cells { columns, rows } = cells(scene, numerics);
        let longer = columns.max(rows);
        if longer.div_ceil(4) < FEWEST_CELLS {
            return Ok(Self { rms_slope, boundary, coarser: vec![None; loads.len()] });
        }
        let solved = |factor: usize| {
            let mut coarse = on_grid(scene, numerics, longer.div_ceil(factor))?;
            // Numbers are compared, not fields.
            coarse.requested.drop_fields_of_stress();
            solve(&coarse, seed, loads, stop)
        };
        let both = solved(2)?.into_iter().zip(solved(4)?);
        let coarser = both.map(|(half, quarter)| Some([half?, quarter?])).collect();
        Ok(Self { rms_slope, boundary, coarser })
    }

    /// The errors of a state under load number `index`.
    pub fn errors(&self, index: usize, state: &ContactState, normalisation: &Normalisation) -> GridErrors {
        let errors = match self.coarser.get(index) {
            Some(Some([half, quarter])) => {
                errors(self.boundary, &numbers(state, normalisation, self.rms_slope), half, quarter)
            }
            _ => BTreeMap::new(),
        };
        GridErrors { rms_slope: self.rms_slope, errors }
    }
}

/// One model of a scene, and the scene, on a grid with so many cells along its longer side: a given map is
/// sampled at every so many-th cell.
pub(crate) fn on_grid(scene: &SceneFile, numerics: &Numerics, longer: usize) -> Result<SceneFile> {
    let mut coarse = scene.clone();
    coarse.surface = scene.surface.coarser(cells(scene, numerics), longer)?;
    coarse.models = vec![numerics.clone().reduced(longer, usize::MAX, scene.surface.size())];
    Ok(coarse)
}

/// The numbers of one model, the first of a scene, under loads; `None` where it does not answer one.
fn solve(scene: &SceneFile, seed: u64, loads: &[Load], stop: Stop<'_>) -> Result<Vec<Option<GridNumbers>>> {
    let numerics = &scene.models[0];
    let slope = rms_slope(scene, &*solved_map(scene, numerics, seed, stop)?)?;
    let mut found = vec![None; loads.len()];
    let interface = !scene.requested.interface.outputs().is_empty();
    let mut outputs = scene.requested.outputs;
    // Leakage and stress are read off the fields.
    let dropped = |output: &Output| output.is_field() && !interface || *output == Output::ContactPatches;
    for &output in Output::ALL.iter().filter(|output| dropped(output)) {
        outputs.ask(output, false);
    }
    let physics = Scene { outputs, ..scene.scene(numerics, seed)? };
    let mut contact = numerics.model().prepare_until(&physics, seed, stop)?;
    let normalisation = contact.normalisation();
    contact.sweep(loads, stop, &mut |i, state| {
        let state = state.and_then(|state| with_interface(scene, numerics, loads[i].normal, state, stop));
        found[i] = match state {
            Err(Error::Stopped { best }) => return Err(Error::Stopped { best }),
            state => state.ok().map(|state| numbers(&state, &normalisation, slope)),
        };
        Ok(())
    })?;
    Ok(found)
}

/// The heights that a model with cells solves.
///
/// # Errors
/// [`Error::Unsupported`] for a model without cells; [`Error::Stopped`]; what drawing a surface refuses.
pub(crate) fn solved_map(
    scene: &SceneFile,
    numerics: &Numerics,
    seed: u64,
    stop: Stop<'_>,
) -> Result<Arc<HeightMap>> {
    let Some(elements) = numerics.boundary_elements() else {
        return Err(Error::unsupported(numerics.name(), "heights on cells: it has none"));
    };
    elements.heights_until(&scene.scene(numerics, seed)?, seed, stop)
}

fn rms_slope(scene: &SceneFile, map: &HeightMap) -> Result<f64> {
    if scene.effects.boundary == Boundary::Periodic && map.undefined() == 0 {
        surface_gen::rms_slope(map)
    } else {
        Ok(surface_gen::rms_slope_differences(map))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With free edges 37 of 54 errors of the largest pressure were inside their estimates, of the other
    /// numbers 94 to 98 %; of periodic surfaces with waves down to the cell 36 % of 480.
    #[test]
    fn the_largest_pressure_has_no_error_where_its_limit_may_be_infinite() {
        let all = || compared().map(|quantity| quantity.name).chain([RMS_SLOPE]);
        let unknown = |boundary, slope_of_half| {
            let [fine, mut half, quarter]: [GridNumbers; 3] =
                [1.0, 1.1, 1.3].map(|value| all().map(|name| (name, value)).collect());
            half.insert(RMS_SLOPE, slope_of_half);
            let errors = errors(boundary, &fine, &half, &quarter);
            all().filter(|name| !errors.contains_key(*name)).collect::<Vec<_>>()
        };
        assert_eq!(unknown(Boundary::Free, 1.0), ["largest_pressure"]);
        assert_eq!(unknown(Boundary::Periodic, 0.96), ["largest_pressure"]);
        assert!(unknown(Boundary::Periodic, 0.99).is_empty());
    }

    #[test]
    fn an_area_that_is_the_same_on_three_grids_by_chance_has_an_error() {
        let on_a_grid = |corrected| -> GridNumbers { [("area", 39.0), ("area_corrected", corrected)].into() };
        let of = |fine: f64| {
            let [fine, half, quarter] = [fine, 14.0, 13.0].map(on_a_grid);
            errors(Boundary::Free, &fine, &half, &quarter)["area"]
        };
        assert!((of(13.0).error - 2.0 / 3.0).abs() < 1e-12);
        // Full contact has no boundary, and its area no error.
        assert!(of(39.0).error.abs() < 1e-12);
    }
}
