//! The study as tables.

use super::row::StudyRow;
use super::sizes::Order;
use super::study::Study;
use crate::tables::{FORCE_BAR, FRACTAL_DIMENSION, column};
use analysis::{Column, Table, Value};
use runs::{Error, Result};

const FAMILY: &str = "sphere, square: exact answers known; band: one surface of resolved waves sampled ever finer; spectrum: waves to \
    the end of each grid at a fixed constant of C(q); mean: ensembles, each surface in its own rms height";

fn problem() -> Vec<Column> {
    vec![
        column("family", "-", FAMILY),
        column("fractal_dimension", "1", FRACTAL_DIMENSION),
        column("force_bar", "1", FORCE_BAR),
    ]
}

pub(crate) fn rows(study: &Study) -> Result<Table> {
    const TITLE: &str = "What accuracy costs in time: every problem in every way";
    let mut columns = problem();
    columns.extend([
        column(
            "model",
            "-",
            "bem3d, mdr1d, or a closed form: hertz, power_law (Eq. 12), plateau (the rigid square)",
        ),
        column("size", "1", "cells a side (bem3d) or elements (mdr1d)"),
        column("tolerance", "1", "bound of the certificate and of the estimated error of k"),
        column("method", "-", "how linear systems are solved: auto, iterative, single-level"),
        column("surfaces", "1", "surfaces in the answer"),
        column("stiffness", "E* L", "k; the mean over the surfaces"),
        column(
            "approach",
            "h",
            "d in rms heights (of the paper's grid in the family spectrum), in L for sphere and square",
        ),
        column("contact_fraction", "1", "contact area over A0"),
        column("contact_cells", "1", "cells in contact"),
        column(
            "error_stiffness",
            "1",
            "relative error of k, never below that of its reference; for means with their standard error",
        ),
        column("error_approach", "1", "relative error of d, likewise"),
        column("error_area", "1", "relative error of the area, likewise"),
        column(
            "error_pressure",
            "1",
            "relative L2 distance of the pressure from Hertz's, or from that on the finest grid",
        ),
        column("reference_error", "1", "relative uncertainty of the reference of k"),
        column(
            "algebraic",
            "1",
            "part of the error of k: the tightest tolerance on the same grid changes it so much",
        ),
        column(
            "discretisation",
            "1",
            "part: the limit of fine grids, with the waves that only they carry, changes it so much",
        ),
        column("model_error", "1", "part: three dimensions change it so much"),
        column(
            "ensemble",
            "1",
            "part: standard error of the mean, of 60 surfaces (bem3d) or of all lines (mdr1d)",
        ),
        column(
            "cpu_seconds",
            "s",
            "processor seconds of one load from nothing; for means of all surfaces, each load its share",
        ),
        column("iterations", "1", "iterations of the linear solvers"),
        column("applications", "1", "applications of the elastic operator"),
        column(
            "bytes",
            "B",
            "resident memory that the row took beyond what the process held, as the system counts it",
        ),
        column("status", "-", "converged: every number of the certificate is within the tolerance"),
        column("pareto", "-", "true where no way to this number is both cheaper and nearer"),
    ]);
    let mut table = Table::new(TITLE, columns);
    for row in &study.rows {
        table.push(values(row)).map_err(Error::model(TITLE))?;
    }
    Ok(table)
}

fn values(row: &StudyRow) -> Vec<Value> {
    let a = &row.answer;
    let [k, d, area, p] = row.errors;
    vec![
        row.family.as_str().into(),
        row.fractal_dimension.into(),
        row.force_bar.into(),
        row.way.model().into(),
        row.way.size().into(),
        row.way.tolerance().into(),
        row.way.method().into(),
        row.surfaces.into(),
        a.stiffness.into(),
        a.approach.into(),
        a.area.into(),
        a.contact_cells.into(),
        k.into(),
        d.into(),
        area.into(),
        p.into(),
        row.reference_error.into(),
        row.parts.algebraic.into(),
        row.parts.discretisation.into(),
        row.parts.model.into(),
        row.parts.ensemble.into(),
        a.cpu_seconds.into(),
        a.iterations.into(),
        a.applications.into(),
        a.bytes.into(),
        a.status.as_str().into(),
        row.pareto.into(),
    ]
}

pub(crate) fn orders(study: &Study) -> Result<Table> {
    const TITLE: &str = "What accuracy costs in time: limits of fine grids and their orders";
    let mut columns = problem();
    columns.extend([
        column("quantity", "-", "stiffness, approach, area, or pressure (L2)"),
        column(
            "order",
            "1",
            "p of error ~ cell^p: of the extrapolation where established, else the slope of the errors",
        ),
        column(
            "established",
            "-",
            "true against an exact answer, or where four grids or more follow one power",
        ),
        column(
            "limit",
            "E* L, h, 1",
            "the reference: exact, extrapolated where established, else the finest grid's",
        ),
        column("limit_error", "1", "its relative uncertainty"),
        column("error_coarsest", "1", "relative error on the coarsest grid"),
        column("error_finest", "1", "relative error on the finest grid"),
    ]);
    let mut table = Table::new(TITLE, columns);
    for order in &study.orders {
        table.push(order_values(order)).map_err(Error::model(TITLE))?;
    }
    Ok(table)
}

fn order_values(o: &Order) -> Vec<Value> {
    vec![
        o.family.as_str().into(),
        o.fractal_dimension.into(),
        o.force_bar.into(),
        o.quantity.into(),
        o.power.into(),
        o.established.into(),
        o.limit.map(|l| l.value).into(),
        o.limit.map(|l| l.relative()).into(),
        o.errors[0].into(),
        o.errors[1].into(),
    ]
}
