//! Tables that several figures share: the curves and their samples.

use crate::measured::Measured;
use crate::realisation::Discretisation;
use crate::sample::{FLOOR_CELLS, Sample};
use analysis::{Column, Table, Value};
use runs::{Error, Result};

/// A column of a table.
pub fn column(name: &'static str, unit: &'static str, meaning: &'static str) -> Column {
    Column { name, unit, meaning }
}

/// What a column `model` holds.
pub const MODEL: &str = "bem3d: 3D boundary elements; mdr1d: 1D reduction";
/// What a column `fractal_dimension` holds.
pub const FRACTAL_DIMENSION: &str = "D_f = 3 - H of the 3D surface";
/// What a column `force_bar` holds.
pub const FORCE_BAR: &str = "F/(E* h L), h the measured rms height of each surface (Eq. 10)";

/// Mean curves: the table of Figs. 2 and 6.
///
/// # Errors
/// A row that does not fit the columns, which would be a mistake of this crate.
pub fn curves_table(title: &str, measured: &Measured) -> Result<Table> {
    let mut table = Table::new(
        title,
        vec![
            column("model", "-", MODEL),
            column("fractal_dimension", "1", FRACTAL_DIMENSION),
            column("force_bar", "1", FORCE_BAR),
            column(
                "stiffness_bar",
                "1",
                "arithmetic mean of k/(1.1419 E* L) (Eq. 8) over the converged surfaces",
            ),
            column("stiffness_bar_se", "1", "standard error of that mean; empty for one surface"),
            column("stiffness_bar_log_mean", "1", "exp(mean ln k_bar)"),
            column("surfaces", "1", "surfaces in the mean"),
            column("cells", "1", "cells a side (bem3d) or elements (mdr1d)"),
            column("not_converged", "1", "surfaces left out because the solver did not meet its tolerance"),
            column("min_contact_cells", "1", "fewest cells (elements) in contact on any surface of the mean"),
            column(
                "below_floor",
                "-",
                "true where some surface has fewer than 10 contact cells: left out of fits and lines",
            ),
            column(
                "contact_fraction",
                "1",
                "mean contact area over A0; empty where the model claims no area",
            ),
        ],
    );
    for series in &measured.series {
        for (j, point) in series.points.iter().enumerate() {
            let k = point.stiffness_bar;
            let row: Vec<Value> = vec![
                measured.discretisation.name().into(),
                series.fractal_dimension.into(),
                point.force_bar.into(),
                k.map(|k| k.mean).into(),
                k.and_then(|k| k.standard_error).into(),
                k.map(|k| k.log_mean).into(),
                k.map_or(0, |k| k.count).into(),
                measured.discretisation.size().into(),
                point.missing.into(),
                point.min_contact_cells.into(),
                point.min_contact_cells.is_some_and(|c| c < FLOOR_CELLS).into(),
                series.contact_fraction(j).into(),
            ];
            table.push(row).map_err(Error::model(title))?;
        }
    }
    Ok(table)
}

/// One row per surface and load.
///
/// # Errors
/// A row that does not fit the columns, which would be a mistake of this crate.
pub fn samples_table(title: &str, measured: &Measured) -> Result<Table> {
    let mut table = Table::new(
        title,
        vec![
            column("model", "-", MODEL),
            column("fractal_dimension", "1", FRACTAL_DIMENSION),
            column("surface", "1", "number of the surface in its ensemble"),
            column("seed", "1", "seed of this surface"),
            column("force_bar", "1", FORCE_BAR),
            column("approach_over_h", "1", "d/h, d from first touch of the highest point"),
            column("stiffness_bar", "1", "k/(1.1419 E* L) (Eq. 8)"),
            column("contact_fraction", "1", "contact area over A0; empty where the model claims no area"),
            column("iterations", "1", "iterations of the solver"),
            column("applications", "1", "applications of the elastic operator"),
            column("contact_cells", "1", "cells (elements) in contact"),
            column("contact_length", "L", "k/E* (Eq. 1)"),
            column("status", "-", "converged: every number of the certificate is within the tolerance"),
            column("duality_gap", "1", "sum p (g - min g)/(F h), the duality gap in its Frank-Wolfe form"),
            column("penetration", "1", "max(0, -min g)/h"),
            column("complementarity", "1", "sum p |g|/(F h)"),
            column("load_error", "1", "|F - F_asked|/F_asked"),
            column("stiffness_error", "1", "estimated relative error of k"),
            column("below_floor", "-", "fewer than 10 contact cells"),
            column("force", "E* L^2", "F"),
            column("rms_height", "L", "measured rms height of this surface"),
            column("cells", "1", "cells a side (bem3d) or elements (mdr1d)"),
            column("strategy", "-", "which way the solver took"),
        ],
    );
    for series in &measured.series {
        for (unit, result) in &series.units {
            for s in &result.samples {
                let row = sample_row(
                    measured.discretisation,
                    series.fractal_dimension,
                    unit.index,
                    unit.seed,
                    s,
                    result.rms_height,
                );
                table.push(row).map_err(Error::model(title))?;
            }
        }
    }
    Ok(table)
}

fn sample_row(
    discretisation: Discretisation,
    d: f64,
    index: usize,
    seed: u64,
    s: &Sample,
    rms_height: f64,
) -> Vec<Value> {
    let c = &s.certificate;
    vec![
        discretisation.name().into(),
        d.into(),
        index.into(),
        seed.into(),
        s.force_bar.into(),
        s.approach_over_h.into(),
        s.stiffness_bar.into(),
        s.contact_fraction.into(),
        s.iterations.into(),
        s.applications.into(),
        s.contact_cells.into(),
        s.contact_length.into(),
        s.status.as_str().into(),
        c.duality_gap.into(),
        c.penetration.into(),
        c.complementarity.into(),
        c.load_error.into(),
        c.stiffness_error.into(),
        s.below_floor().into(),
        s.force.into(),
        rms_height.into(),
        discretisation.size().into(),
        s.strategy.as_str().into(),
    ]
}
