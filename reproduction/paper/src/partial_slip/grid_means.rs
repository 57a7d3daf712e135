//! The grid study: means over surfaces on each grid, extrapolated shares that stick, and their errors.

use super::grid_job::{LoadOnGrid, SurfaceOnGrid};
use super::means::mean;
use super::study::{PartialSlipStudy, SHARES};
use crate::claim::Estimate;
use analysis::{KnownPart, Multilevel, Uncertain, mean_grid_error};

/// Safety factor of `analysis::grid_error`.
const SAFETY: f64 = 1.5;
/// The part of what was extrapolated that may be wrong.
const OF_EXTRAPOLATED: f64 = 0.5;

/// The surfaces of a fractal dimension on all grids.
#[derive(Clone, Copy)]
pub(super) struct SolvedGrids<'a> {
    pub(super) fractal_dimension: f64,
    /// By surface, then by grid from the coarsest to the finest.
    pub(super) surfaces: &'a [SurfaceOnGrid],
    pub(super) grids: usize,
}

/// A number of a first loading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GridQuantity {
    Stick,
    Corrected,
    Stiffness,
}

/// A load, a Poisson's ratio and a tangential force, by their indices.
#[derive(Debug, Clone, Copy)]
pub(super) struct CaseIndices {
    pub(super) force: usize,
    pub(super) poisson: usize,
    pub(super) share: usize,
}

impl<'a> SolvedGrids<'a> {
    fn loads(self, force: usize) -> impl Iterator<Item = Vec<Option<&'a LoadOnGrid>>> {
        let of = move |on_grids: &'a [SurfaceOnGrid]| {
            on_grids.iter().map(|grid| grid.loads.get(force)?.as_ref()).collect()
        };
        self.surfaces.chunks(self.grids).map(of)
    }

    /// Fewest cells in contact on each grid.
    pub(super) fn fewest_cells(self, force: usize) -> Vec<usize> {
        let mut fewest = vec![usize::MAX; self.grids];
        for surface in self.loads(force) {
            for (fewest, load) in fewest.iter_mut().zip(surface) {
                *fewest = load.map_or(*fewest, |load| load.contact_cells.min(*fewest));
            }
        }
        fewest
    }

    /// The number of each surface on each grid that has it; `None` for a surface that misses its tolerance on one
    /// of them.
    pub(super) fn values(self, quantity: GridQuantity, place: CaseIndices) -> Vec<Option<Vec<f64>>> {
        let one = |load: Option<&LoadOnGrid>| {
            let loading = load?.loadings.get(place.poisson)?;
            match quantity {
                GridQuantity::Stick => loading.stick.get(place.share).copied(),
                GridQuantity::Corrected => loading.stick_corrected.get(place.share).copied(),
                GridQuantity::Stiffness => loading.stiffness.get(place.share).copied(),
            }
        };
        // Friction is not solved on the finest grid.
        let grids = if place.poisson == 0 { self.grids } else { self.grids - 1 };
        let of = |surface: Vec<_>| surface.into_iter().take(grids).map(one).collect();
        self.loads(place.force).map(of).collect()
    }
}

/// `2 s(a) - s(2a)` for cells of size a: an error proportional to the size of the cells is removed.
fn extrapolated(fine: f64, half: f64) -> f64 {
    2.0 * fine - half
}

/// A mean over surfaces with its two errors.
#[derive(Debug, Clone, Copy)]
pub(super) struct GridMean {
    pub(super) mean: Uncertain,
    /// The remaining discretisation error, a half-width that is added to that of the scatter.
    pub(super) grid: f64,
    pub(super) surfaces: usize,
}

fn uncertain(values: &[f64]) -> Option<Uncertain> {
    let of = Multilevel::new(vec![values.iter().map(|v| vec![*v]).collect()]).ok()?;
    Some(of.propagated(of.means(1)[0], &[1.0]))
}

impl GridMean {
    /// The extrapolated mean. Its discretisation error is 1.5 times the change from the value that the two
    /// coarser grids extrapolate to, or half of what was extrapolated where that is larger. Of two grids there is
    /// no such change, and the error is all that was extrapolated.
    pub(super) fn extrapolated(on_grids: &[Vec<f64>]) -> Option<Self> {
        let mean_of = |values: &[f64]| analysis::sum(values.iter().copied()) / values.len() as f64;
        let limits_from = |last: usize| -> Option<Vec<f64>> {
            let of = |values: &Vec<f64>| {
                let fine = values.len().checked_sub(last)?;
                Some(extrapolated(*values.get(fine)?, *values.get(fine.checked_sub(1)?)?))
            };
            on_grids.iter().map(of).collect()
        };
        let limits = limits_from(1)?;
        let finest: Vec<f64> = on_grids.iter().filter_map(|values| values.last().copied()).collect();
        let reach = (mean_of(&limits) - mean_of(&finest)).abs();
        let grid = limits_from(2).map_or(reach, |before| {
            let change = (mean_of(&limits) - mean_of(&before)).abs();
            (SAFETY * change).max(OF_EXTRAPOLATED * reach)
        });
        Some(Self { mean: uncertain(&limits)?, grid, surfaces: limits.len() })
    }

    /// The mean on the finest grid, with the discretisation error of `analysis::mean_grid_error`.
    pub(super) fn finest(on_grids: &[Vec<f64>]) -> Option<Self> {
        let each: Vec<[f64; 3]> = on_grids.iter().filter_map(|v| v.last_chunk::<3>().copied()).collect();
        let finest: Vec<f64> = each.iter().map(|[.., fine]| *fine).collect();
        let differences: Vec<[f64; 2]> =
            each.iter().map(|[quarter, half, fine]| [half - fine, quarter - half]).collect();
        let grid = mean_grid_error(&differences, KnownPart::default(), differences.len())?;
        Some(Self { mean: uncertain(&finest)?, grid, surfaces: finest.len() })
    }

    pub(super) fn of(quantity: GridQuantity, on_grids: &[Vec<f64>]) -> Option<Self> {
        match quantity {
            GridQuantity::Stick | GridQuantity::Corrected => Self::extrapolated(on_grids),
            GridQuantity::Stiffness => Self::finest(on_grids),
        }
    }
}

/// Means at a tangential force on one grid, or in the limit of small cells.
pub(super) struct GridRow {
    pub(super) fractal_dimension: f64,
    pub(super) force_bar: f64,
    pub(super) poisson: f64,
    pub(super) share: f64,
    /// Cells a side and fewest cells in contact; `None` for the extrapolated mean.
    pub(super) cells: Option<[usize; 2]>,
    pub(super) stick: Option<Estimate>,
    pub(super) stick_grid: Option<f64>,
    pub(super) corrected: Option<Estimate>,
    pub(super) corrected_grid: Option<f64>,
    pub(super) stiffness: Option<Estimate>,
    pub(super) stiffness_grid: Option<f64>,
    pub(super) surfaces: usize,
}

fn estimate(found: Option<GridMean>) -> Option<Estimate> {
    found.map(|found| Estimate { value: found.mean.value, half_width: found.mean.half_width() })
}

pub(super) fn rows(study: &PartialSlipStudy, solved: &[SolvedGrids<'_>]) -> Vec<GridRow> {
    let mut rows = Vec::new();
    for &of in solved {
        for (force, &force_bar) in study.forces.values().iter().enumerate() {
            let fewest = of.fewest_cells(force);
            for (poisson, &nu) in study.poissons.iter().enumerate() {
                for (i, share) in SHARES.into_iter().enumerate() {
                    let place = CaseIndices { force, poisson, share: i };
                    let all = |quantity| -> Vec<Vec<f64>> {
                        of.values(quantity, place).into_iter().flatten().collect()
                    };
                    let [stick, corrected, stiffness] =
                        [GridQuantity::Stick, GridQuantity::Corrected, GridQuantity::Stiffness].map(all);
                    let row = |cells, surfaces| GridRow {
                        fractal_dimension: of.fractal_dimension,
                        force_bar,
                        poisson: nu,
                        share,
                        cells,
                        stick: None,
                        stick_grid: None,
                        corrected: None,
                        corrected_grid: None,
                        stiffness: None,
                        stiffness_grid: None,
                        surfaces,
                    };
                    let grids = if poisson == 0 { of.grids } else { of.grids - 1 };
                    for (g, &cells) in study.grids.iter().take(grids).enumerate() {
                        let on = |values: &[Vec<f64>]| mean(values.iter().filter_map(|v| v.get(g).copied()));
                        rows.push(GridRow {
                            stick: on(&stick),
                            corrected: on(&corrected),
                            stiffness: on(&stiffness),
                            ..row(Some([cells, fewest[g]]), stick.len())
                        });
                    }
                    let limits = [
                        GridMean::extrapolated(&stick),
                        GridMean::extrapolated(&corrected),
                        GridMean::finest(&stiffness),
                    ];
                    let [stick_limit, corrected_limit, stiffness_limit] = limits;
                    rows.push(GridRow {
                        stick: estimate(stick_limit),
                        stick_grid: stick_limit.map(|f| f.grid),
                        corrected: estimate(corrected_limit),
                        corrected_grid: corrected_limit.map(|f| f.grid),
                        stiffness: estimate(stiffness_limit),
                        stiffness_grid: stiffness_limit.map(|f| f.grid),
                        ..row(None, stick.len())
                    });
                }
            }
        }
    }
    rows
}
