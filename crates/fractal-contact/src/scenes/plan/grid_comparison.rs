//! What the grid does to a state: the same load on the same surface with cells twice and four times as large.

use crate::scenes::read::any_model::AnyModel;
use crate::scenes::read::numerics::Numerics;
use crate::scenes::read::scene_file::{SceneFile, cells};
use analysis::{GridError, grid_error};
use contact_model::{Boundary, Cells, ContactState, Error, HeightMap, Load, Result, Scene, Stop, Surface};
use std::sync::Arc;

/// Grids with fewer cells along their longer side say nothing.
const FEWEST_CELLS: usize = 16;

/// Names of what is compared, in the order of [`Quantities`]; the table has columns for those that it holds.
pub(crate) const COMPARED: [&str; 8] = [
    "stiffness",
    "stiffness_fixed_area",
    "area",
    "area_corrected",
    "conductance",
    "mean_gap",
    LARGEST_PRESSURE,
    "rms_slope",
];

/// At an edge of a free rectangle, and at a spike, this grows without limit as cells shrink: its error there is not known.
const LARGEST_PRESSURE: &str = "largest_pressure";

/// Numbers of one state on one grid.
pub(crate) type Quantities = [Option<f64>; COMPARED.len()];

/// Their errors.
pub(crate) type GridErrors = [Option<GridError>; COMPARED.len()];

fn quantities(state: &ContactState, rms_slope: f64) -> Quantities {
    let (corrected, pressure) =
        (state.resolution.and_then(|r| r.corrected_area), state.resolution.map(|r| r.largest_pressure));
    [
        state.stiffness,
        state.stiffness_fixed_area,
        state.area,
        corrected,
        state.conductance,
        state.mean_gap,
        pressure,
        Some(rms_slope),
    ]
}

/// Their errors from three grids, where they are known to hold.
fn errors(boundary: Boundary, fine: &Quantities, half: &Quantities, quarter: &Quantities) -> GridErrors {
    std::array::from_fn(|i| {
        let known = COMPARED[i] != LARGEST_PRESSURE || boundary == Boundary::Periodic;
        known.then(|| grid_error(fine[i]?, half[i]?, quarter[i]?)).flatten()
    })
}

/// The states of a surface on coarser grids.
pub(crate) struct GridComparison {
    /// Of the surface on its own grid.
    pub rms_slope: f64,
    boundary: Boundary,
    /// Under each load, with cells twice and four times as large; `None` where a grid does not answer.
    coarser: Vec<Option<[Quantities; 2]>>,
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
        let rms_slope = rms_slope(scene, &*solved_map(scene, numerics, seed)?)?;
        let Cells { columns, rows } = cells(scene, numerics);
        let longer = columns.max(rows);
        if longer.div_ceil(4) < FEWEST_CELLS {
            return Ok(Self { rms_slope, boundary, coarser: vec![None; loads.len()] });
        }
        let solved =
            |factor: usize| solve(&on_grid(scene, numerics, longer.div_ceil(factor))?, seed, loads, stop);
        let both = solved(2)?.into_iter().zip(solved(4)?);
        let coarser = both.map(|(half, quarter)| Some([half?, quarter?])).collect();
        Ok(Self { rms_slope, boundary, coarser })
    }

    /// The errors of a state under load number `index`.
    pub fn errors(&self, index: usize, state: &ContactState) -> GridErrors {
        match self.coarser.get(index) {
            Some(Some([half, quarter])) => {
                errors(self.boundary, &quantities(state, self.rms_slope), half, quarter)
            }
            _ => GridErrors::default(),
        }
    }
}

/// One model of a scene, and the scene, on a grid with so many cells along its longer side: a given map is sampled at every so many-th cell.
pub(crate) fn on_grid(scene: &SceneFile, numerics: &Numerics, longer: usize) -> Result<SceneFile> {
    let mut coarse = scene.clone();
    coarse.surface = scene.surface.coarser(cells(scene, numerics), longer)?;
    coarse.models = vec![numerics.clone().reduced(longer, usize::MAX, scene.surface.size())];
    Ok(coarse)
}

/// The numbers of one model, the first of a scene, under loads; `None` where it does not answer one.
pub(crate) fn solve(
    scene: &SceneFile,
    seed: u64,
    loads: &[Load],
    stop: Stop<'_>,
) -> Result<Vec<Option<Quantities>>> {
    let numerics = &scene.models[0];
    let slope = rms_slope(scene, &*solved_map(scene, numerics, seed)?)?;
    let mut found = vec![None; loads.len()];
    let AnyModel::Contact(model) = numerics.model() else { return Ok(found) };
    let mut outputs = scene.requested.outputs;
    (outputs.pressure, outputs.displacement, outputs.gap, outputs.contact_patches) =
        (false, false, false, false);
    let physics = Scene { outputs, ..scene.scene(numerics, seed)? };
    model.prepare(&physics, seed)?.sweep(loads, stop, &mut |i, state| {
        found[i] = state.ok().map(|state| quantities(&state, slope));
        Ok(())
    })?;
    Ok(found)
}

/// The heights that a model with cells solves.
///
/// # Errors
/// [`Error::Unsupported`] for a model without cells; what drawing a surface refuses.
pub(crate) fn solved_map(scene: &SceneFile, numerics: &Numerics, seed: u64) -> Result<Arc<HeightMap>> {
    let Some(elements) = numerics.boundary_elements() else {
        return Err(Error::unsupported(numerics.name(), "heights on cells: it has none"));
    };
    match scene.surface.for_model(numerics, seed)? {
        Surface::Heights(map) | Surface::Profile(map) => Ok(map),
        surface => surface_gen::height_map(&surface, elements.grid(surface.size()), seed),
    }
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

    /// With free edges 37 of 54 errors of the largest pressure were inside their estimates, of the other numbers 94 to 98 %.
    #[test]
    fn the_largest_pressure_has_no_error_where_its_limit_may_be_infinite() {
        let [fine, half, quarter] = [1.0, 1.1, 1.3].map(|value| [Some(value); COMPARED.len()]);
        let known = |boundary| {
            let errors = errors(boundary, &fine, &half, &quarter);
            COMPARED
                .into_iter()
                .zip(errors)
                .filter(|(_, error)| error.is_none())
                .map(|(name, _)| name)
                .collect()
        };
        let (free, periodic): (Vec<_>, Vec<_>) = (known(Boundary::Free), known(Boundary::Periodic));
        assert_eq!((free, periodic), (vec![LARGEST_PRESSURE], vec![]));
    }
}
