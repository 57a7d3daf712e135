//! The tables of the study of the exponent.

use super::curve::{Banded, MeanCurve};
use super::ladder::{Ladder, Pair, Rungs};
use super::laws::{Factor, LawRow, Ratio};
use analysis::Table;
use evaluation::{FRACTAL_DIMENSION, RealisationResult, Sample, TableOf};
use runs::Result;

const MODEL: &str = "bem3d: 3D boundary elements; mdr1d: 1D reduction";
const CONVENTION: &str = "rms height in which F_bar is counted: measured_rms, of each grid; fixed_spectrum, of the spectrum on 2049 x 2049 cells";

const SCATTER: &str = "95 % half-width from the scatter of the surfaces";
const GRID: &str = "what the grid leaves, from the three finest";
const FINEST: &str = "cells a side (bem3d) or elements (mdr1d) of the finest grid at this load";
const LOCAL_SLOPE: &str = "d ln k/d ln F through five loads; empty where one is not resolved";
const RESOLVED: &str = "whether here and at all larger loads the grid leaves less than the stated error";
const WINDOW: &str = "common: resolved for every D_f of the model; own: all that is resolved; else a decade";
const EXPONENT: &str = "slope of ln k over ln F by least squares, loads with equal weight";
const WIDEST: &str = "size of the level that adds most to the scatter";
const RATIO_SLOPE: &str = "of ln(k_1D/k_3D) over ln F: 0 where the factor depends on D_f alone";
const BOTH_HALF: &str = "95 %, scatter and grid of both";

const LEVEL_MEAN: &str = "mean k_bar on the coarsest grid, else mean difference from the next coarser grid";

const VALUES: &str = "at the loads of the header that this level has, from the smallest up, separated by blanks; - where a solve did not meet its tolerance";

/// Mean curves and local slopes.
pub fn curves(curves: &[MeanCurve]) -> Result<Table> {
    struct Row<'a> {
        curve: &'a MeanCurve,
        point: usize,
        stiffness: Option<Banded>,
        slope: Option<Banded>,
    }
    let mut rows = Vec::new();
    for curve in curves {
        for point in 0..curve.forces.len() {
            let (stiffness, slope) = (curve.stiffness(point), curve.local_slope(point));
            rows.push(Row { curve, point, stiffness, slope });
        }
    }
    TableOf::new("Stiffness over force on the finest grids, and its local slope", &rows)
        .column("model", "-", MODEL, |r| r.curve.model)
        .column("convention", "-", CONVENTION, |r| r.curve.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.curve.fractal_dimension)
        .column("force_bar", "1", "F/(E* h L)", |r| r.curve.forces[r.point])
        .column("size", "1", FINEST, |r| r.curve.finest(r.point))
        .column("stiffness_bar", "1", "mean k/(1.1419 E* L) on that grid", |r| r.stiffness.map(|b| b.value()))
        .column("stiffness_scatter", "1", SCATTER, |r| r.stiffness.map(|b| b.scatter.half_width()))
        .column("stiffness_grid", "1", GRID, |r| r.stiffness.map(|b| b.grid))
        .column("slope", "1", LOCAL_SLOPE, |r| r.slope.map(|b| b.value()))
        .column("slope_scatter", "1", SCATTER, |r| r.slope.map(|b| b.scatter.half_width()))
        .column("slope_grid", "1", GRID, |r| r.slope.map(|b| b.grid))
        .column("resolved", "-", RESOLVED, |r| r.curve.resolved.contains(&r.point))
        .table()
}

/// Mean differences between neighbouring grids and their scatter.
pub fn levels(curves: &[MeanCurve]) -> Result<Table> {
    let mut rows = Vec::new();
    for curve in curves {
        for point in 0..curve.forces.len() {
            for level in 0..curve.levels.levels_at(point) {
                rows.extend(curve.levels.at(level, point).map(|at| (curve, point, level, at)));
            }
        }
    }
    TableOf::new("Mean stiffness on the coarsest grid and mean differences between grids", &rows)
        .column("model", "-", MODEL, |r| r.0.model)
        .column("convention", "-", CONVENTION, |r| r.0.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.0.fractal_dimension)
        .column("force_bar", "1", "F/(E* h L)", |r| r.0.forces[r.1])
        .column("size", "1", "cells a side or elements of the finer grid", |r| r.0.sizes[r.2])
        .column("surfaces", "1", "surfaces of this level", |r| r.0.levels.surfaces(r.2))
        .column("mean", "1", LEVEL_MEAN, |r| r.3.0)
        .column("deviation", "1", "standard deviation over the surfaces", |r| r.3.1)
        .table()
}

/// Exponents over stated windows beside the laws.
pub fn laws(rows: &[LawRow]) -> Result<Table> {
    TableOf::new("Exponents over stated windows, and the laws that lie in their intervals", rows)
        .column("model", "-", MODEL, |r| r.model)
        .column("convention", "-", CONVENTION, |r| r.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("window", "-", WINDOW, |r| r.window)
        .column("force_bar_min", "1", "smallest load", |r| r.forces.start)
        .column("force_bar_max", "1", "largest load", |r| r.forces.end)
        .column("alpha", "1", EXPONENT, |r| r.alpha.value())
        .column("scatter", "1", SCATTER, |r| r.alpha.scatter.half_width())
        .column("grid", "1", "what the grid leaves", |r| r.alpha.grid)
        .column("widest_level", "1", WIDEST, |r| r.widest.map(|w| w.0))
        .column("widest_share", "1", "its share of the variance", |r| r.widest.map(|w| w.1))
        .column("eq6", "1", "0.266 D_f", LawRow::eq6)
        .column("one_over_one_plus_hurst", "1", "1/(1 + H) = 1/(4 - D_f)", LawRow::power_law)
        .column("inside", "-", "which of them lies within scatter and grid together", LawRow::verdict)
        .table()
}

/// 1D over 3D at common loads.
pub fn ratios(rows: &[Ratio]) -> Result<Table> {
    TableOf::new("Stiffness of the line over that of the surface", rows)
        .column("convention", "-", CONVENTION, |r| r.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("force_bar", "1", "F/(E* h L)", |r| r.force_bar)
        .column("ratio", "1", "k_1D/k_3D", |r| r.value.value)
        .column("half_width", "1", BOTH_HALF, |r| r.value.half_width)
        .table()
}

/// Whether the factor between them depends on the force.
pub fn factors(rows: &[Factor]) -> Result<Table> {
    TableOf::new("The factor between line and surface at small loads", rows)
        .column("convention", "-", CONVENTION, |r| r.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("force_bar_min", "1", "smallest load at which both are resolved", |r| r.forces.start)
        .column("force_bar_max", "1", "largest load", |r| r.forces.end)
        .column("factor", "1", "exp of the mean of ln(k_1D/k_3D) over the loads", |r| r.value.value)
        .column("factor_half_width", "1", BOTH_HALF, |r| r.value.half_width)
        .column("slope", "1", RATIO_SLOPE, |r| r.slope.value)
        .column("slope_half_width", "1", BOTH_HALF, |r| r.slope.half_width)
        .column("constant", "-", "yes: 0 lies inside the slope's interval; no: it does not", Factor::verdict)
        .table()
}

/// Every stiffness, one row for a surface on a grid.
pub fn samples(ladders: &[(&Ladder, &[Rungs])]) -> Result<Table> {
    struct Row<'a> {
        model: &'static str,
        d: f64,
        level: usize,
        pair: &'a Pair,
        sizes: (usize, Option<usize>),
    }
    let mut rows = Vec::new();
    for (ladder, rungs) in ladders {
        for rung in *rungs {
            for (level, pairs) in rung.levels.iter().enumerate() {
                let sizes = (ladder.sizes[level], level.checked_sub(1).map(|below| ladder.sizes[below]));
                let row =
                    |pair| Row { model: ladder.model.name(), d: rung.fractal_dimension, level, pair, sizes };
                rows.extend(pairs.iter().map(row));
            }
        }
    }
    let text = |result: &RealisationResult| {
        let stiffness = |sample: &Sample| match sample.stiffness_bar.filter(|_| sample.converged()) {
            Some(k) => format!("{k:.4e}"),
            None => "-".to_owned(),
        };
        result.samples.iter().map(stiffness).collect::<Vec<_>>().join(" ")
    };
    let title =
        "Stiffness k/(1.1419 E* L) of every surface on its two grids, F_bar by the measured rms height";
    TableOf::new(title, &rows)
        .column("model", "-", MODEL, |r| r.model)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.d)
        .column("level", "1", "0: the coarsest grid", |r| r.level)
        .column("surface", "1", "number on its level", |r| r.pair.index)
        .column("size", "1", "cells a side or elements", |r| r.sizes.0)
        .column("stiffness_bar", "1", VALUES, |r| text(&r.pair.fine))
        .column("coarse_size", "1", "cells a side or elements of the coarser grid", |r| r.sizes.1)
        .column("coarse_stiffness_bar", "1", VALUES, |r| r.pair.coarse.as_ref().map(text))
        .table()
}
