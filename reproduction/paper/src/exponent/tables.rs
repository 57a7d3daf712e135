//! The tables of the study of the exponent.

use super::curve::{BandedNumber, MeanCurve};
use super::families::FamilyTest;
use super::ladder::{GridPair, GridResults, Rungs};
use super::laws::{FittedLimit, LawRow, ModelRatio, Ratio, eq6, eq24, raised};
use crate::evaluation::{FRACTAL_DIMENSION, TableOf};
use contact_model::Table;
use runs::Result;

const MODEL: &str = "bem3d: 3D boundary elements; mdr1d: 1D reduction";
const CONVENTION: &str = "rms height in which F_bar is counted: measured_rms, of each grid; fixed_spectrum, of the spectrum on 2049 x 2049 cells";

const SCATTER: &str = "95 % half-width from the scatter of the surfaces";
const GRID: &str = "remaining discretisation error, estimated from the three finest grids";
const FINEST: &str = "cells a side (bem3d) or elements (mdr1d) of the finest grid at this load";
const LOCAL_SLOPE: &str = "d ln k/d ln F through five loads; empty where one is not resolved";
const RESOLVED: &str =
    "whether the discretisation error is below the stated error here and at all larger loads";
const BAND: &str = "95 % half-width from the scatter, of all local slopes of the curve together";
const WINDOW: &str = "one decade of F_bar, the same for every curve";
const ALL_RESOLVED: &str =
    "whether the discretisation error is below the stated error at all loads of the window";
const EXPONENT: &str = "slope of ln k over ln F by least squares, loads with equal weight";
const WIDEST: &str = "size of the level that adds most to the scatter";
const INSIDE: &str = "which of them lies within the 95 % interval of this row";
const RATIO_SLOPE: &str = "of ln(k_1D/k_3D) over ln F: 0 where the factor depends on D_f alone";
const BOTH_HALF: &str = "95 %, scatter and grid of both";
const GOODNESS: &str =
    "share of curves that scatter about the law as the surfaces do and have a larger misfit";
const PLANNED: &str = "whether this fit was to be tested before the second run was drawn; else exploration";
const CONCLUSION: &str = "which of them lies within the 95 % interval of alpha, or why the fit says nothing";
const VARIANT: &str = "free: the fit that is judged; omega 0.5: omega held; to 0.06: a lower upper end";
const FAMILY: &str =
    "A: line over surface; B: a decade against Eq. 24; C: against Eq. 6; D: towards zero force";
const TOGETHER: &str = "interval, 95 % for all tests of the family together (Bonferroni)";

const LEVEL_MEAN: &str = "mean k_bar on the coarsest grid, else mean difference from the next coarser grid";

const VALUES: &str = "at the loads of the header that this level has, from the smallest up, separated by blanks; - where a solve did not meet its tolerance";

/// Mean curves and local slopes.
pub fn curves(curves: &[MeanCurve]) -> Result<Table> {
    struct ExponentRow<'a> {
        curve: &'a MeanCurve,
        point: usize,
        stiffness: Option<BandedNumber>,
        slope: Option<BandedNumber>,
    }
    let mut rows = Vec::new();
    for curve in curves {
        for point in 0..curve.forces.len() {
            let (stiffness, slope) = (curve.stiffness(point), curve.local_slope(point));
            rows.push(ExponentRow { curve, point, stiffness, slope });
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
        .column("slope_band", "1", BAND, |r| r.slope.map(|b| r.curve.band * b.scatter.half_width()))
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

/// Exponents over decades, compared with the laws.
pub fn laws(rows: &[LawRow]) -> Result<Table> {
    TableOf::new("Exponents decade by decade, and the laws that lie in their intervals", rows)
        .column("model", "-", MODEL, |r| r.model)
        .column("convention", "-", CONVENTION, |r| r.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("window", "-", WINDOW, |r| r.window)
        .column("resolved", "-", ALL_RESOLVED, |r| r.resolved)
        .column("alpha", "1", EXPONENT, |r| r.alpha.value())
        .column("scatter", "1", SCATTER, |r| r.alpha.scatter.half_width())
        .column("grid", "1", "the remaining discretisation error", |r| r.alpha.grid)
        .column("widest_level", "1", WIDEST, |r| r.widest.map(|w| w.0))
        .column("widest_share", "1", "its share of the variance", |r| r.widest.map(|w| w.1))
        .column("eq6", "1", "0.266 D_f", |r| eq6(r.fractal_dimension))
        .column("eq24", "1", "1/(1 + H) = 1/(4 - D_f)", |r| eq24(r.fractal_dimension))
        .column("inside", "-", INSIDE, LawRow::inside)
        .table()
}

/// Exponents towards zero force.
pub fn limits(rows: &[FittedLimit]) -> Result<Table> {
    const TITLE: &str = "k_bar = zeta F_bar^alpha (1 + c F_bar^omega), weighted least squares of ln k_bar; intervals by bootstrap samples of whole surfaces, 2000 of the fits that are judged, 500 of others";
    TableOf::new(TITLE, rows)
        .column("model", "-", MODEL, |r| r.model)
        .column("convention", "-", CONVENTION, |r| r.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("variant", "-", VARIANT, |r| r.variant)
        .column("force_bar_min", "1", "smallest load", |r| r.forces.start)
        .column("force_bar_max", "1", "largest load", |r| r.forces.end)
        .column("loads", "1", "how many", |r| r.points)
        .column("resolved", "-", ALL_RESOLVED, |r| r.resolved)
        .column("alpha", "1", "exponent towards zero force", |r| r.law.alpha)
        .column("alpha_low", "1", "lower end of its 95 % interval, grid included", |r| r.interval[0])
        .column("alpha_high", "1", "upper end", |r| r.interval[1])
        .column("grid", "1", "remaining discretisation error of alpha, with omega fixed", |r| r.grid)
        .column("zeta", "1", "factor", |r| r.law.zeta)
        .column("c", "1", "factor of the correction", |r| r.law.c)
        .column("omega", "1", "power of the correction, 0.25 to 2", |r| r.law.omega)
        .column("omega_low", "1", "lower end of its 95 % interval from the scatter", |r| r.omega[0])
        .column("omega_high", "1", "upper end", |r| r.omega[1])
        .column("misfit", "1", "weighted sum of squares", |r| r.law.misfit)
        .column("goodness", "1", GOODNESS, |r| r.goodness)
        .column("planned", "-", PLANNED, FittedLimit::was_planned)
        .column("eq6", "1", "0.266 D_f", |r| eq6(r.fractal_dimension))
        .column("eq24", "1", "1/(1 + H) = 1/(4 - D_f)", |r| eq24(r.fractal_dimension))
        .column("conclusion", "-", CONCLUSION, FittedLimit::conclusion)
        .table()
}

/// 1D over 3D at common loads.
pub fn ratios(rows: &[Ratio]) -> Result<Table> {
    TableOf::new("Stiffness of the line over that of the surface", rows)
        .column("convention", "-", CONVENTION, |r| r.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("force_bar", "1", "F/(E* h L)", |r| r.force_bar)
        .column("ratio", "1", "k_1D/k_3D", |r| raised(&r.logarithm).0)
        .column("half_width", "1", BOTH_HALF, |r| raised(&r.logarithm).1)
        .table()
}

/// Whether the factor between them depends on the force.
pub fn factors(rows: &[ModelRatio]) -> Result<Table> {
    TableOf::new("The factor between line and surface, decade by decade", rows)
        .column("convention", "-", CONVENTION, |r| r.convention.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("window", "-", WINDOW, |r| r.window)
        .column("resolved", "-", ALL_RESOLVED, |r| r.resolved)
        .column("factor", "1", "exp of the mean of ln(k_1D/k_3D) over the loads", |r| raised(&r.logarithm).0)
        .column("factor_half_width", "1", BOTH_HALF, |r| raised(&r.logarithm).1)
        .column("slope", "1", RATIO_SLOPE, |r| r.slope.value())
        .column("slope_scatter", "1", SCATTER, |r| r.slope.scatter.half_width())
        .column("slope_grid", "1", "what the grids leave", |r| r.slope.grid)
        .table()
}

/// The tests of the hypotheses.
pub fn tests(rows: &[FamilyTest]) -> Result<Table> {
    TableOf::new("Hypotheses of data/exponent/hypotheses.md and what was found of them", rows)
        .column("family", "-", FAMILY, |r| r.family)
        .column("tests", "1", "tests of the family", |r| r.of)
        .column("quantity", "-", "what is tested", |r| r.quantity)
        .column("model", "-", MODEL, |r| r.model)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("window", "-", "loads F_bar, or those of the fit", |r| r.window)
        .column("hypothesis", "-", "what it says", |r| r.hypothesis)
        .column("expected", "1", "the number that it says", |r| r.expected)
        .column("found", "1", "the number found", |r| r.value)
        .column("low", "1", TOGETHER, |r| r.interval.map(|i| i[0]))
        .column("high", "1", "its upper end", |r| r.interval.map(|i| i[1]))
        .column("chance", "1", "of such a distance, this test alone; empty for the bootstrap", |r| r.chance)
        .column("resolved", "-", ALL_RESOLVED, |r| r.resolved)
        .column("verdict", "-", "rejected, not rejected, not resolved", FamilyTest::verdict)
        .table()
}

/// Every stiffness, one row for a surface on a grid.
pub fn samples(rungs: &[Rungs]) -> Result<Table> {
    let mut rows = Vec::new();
    for rung in rungs {
        for (level, pairs) in rung.levels.iter().enumerate() {
            rows.extend(pairs.iter().map(move |pair| (rung, level, pair)));
        }
    }
    let text = |solved: &GridResults| {
        let stiffness = |k: &Option<f64>| k.map_or_else(|| "-".to_owned(), |k| format!("{k:.4e}"));
        solved.stiffnesses.iter().map(stiffness).collect::<Vec<_>>().join(" ")
    };
    let coarser =
        |&(rung, level, _): &(&Rungs, usize, &GridPair)| level.checked_sub(1).map(|l| rung.sizes[l]);
    let title =
        "Stiffness k/(1.1419 E* L) of every surface on its two grids, F_bar by the measured rms height";
    TableOf::new(title, &rows)
        .column("model", "-", MODEL, |r| r.0.model.name())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.0.fractal_dimension)
        .column("level", "1", "0: the coarsest grid", |r| r.1)
        .column("surface", "1", "number on its level", |r| r.2.index)
        .column("size", "1", "cells a side or elements", |r| r.0.sizes[r.1])
        .column("stiffness_bar", "1", VALUES, |r| text(&r.2.fine))
        .column("coarse_size", "1", "cells a side or elements of the coarser grid", coarser)
        .column("coarse_stiffness_bar", "1", VALUES, |r| r.2.coarse.as_ref().map(text))
        .table()
}
