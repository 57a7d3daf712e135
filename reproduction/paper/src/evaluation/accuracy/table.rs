//! The study as tables.

use super::problem::ProblemKey;
use super::study::Study;
use crate::evaluation::table_of::TableOf;
use crate::evaluation::tables::{FORCE_BAR, FRACTAL_DIMENSION};
use contact_model::Table;
use runs::Result;

const FAMILY: &str = "sphere, square: exact answers known; band: one surface of resolved waves sampled ever finer; spectrum: waves to \
    the end of each grid at a fixed constant of C(q); mean: ensembles, each surface in its own rms height";

/// A table whose first columns name the problem of each row.
fn of_problems<'a, T>(
    title: &'static str,
    items: &'a [T],
    problem: impl Fn(&T) -> ProblemKey,
) -> TableOf<'a, T> {
    TableOf::new(title, items)
        .column("family", "-", FAMILY, |item| problem(item).family.as_str())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |item| problem(item).fractal_dimension)
        .column("force_bar", "1", FORCE_BAR, |item| problem(item).force_bar)
}

pub(crate) fn rows(study: &Study) -> Result<Table> {
    const TITLE: &str = "What accuracy costs in time: every problem in every way";
    const MODEL: &str =
        "bem3d, mdr1d, or a closed form: hertz, power_law (Eq. 12), plateau (the rigid square)";
    const TOLERANCE: &str = "bound of the certificate and of the estimated error of k";
    const METHOD: &str = "how linear systems are solved: auto, iterative, single-level";
    const APPROACH: &str =
        "d in rms heights (of the paper's grid in the family spectrum), in L for sphere and square";
    const ERROR: &str =
        "relative error of k, never below that of its reference; for means with their standard error";
    const PRESSURE: &str =
        "relative L2 distance of the pressure from Hertz's, or from that on the finest grid";
    const ALGEBRAIC: &str =
        "part of the error of k: the tightest tolerance on the same grid changes it so much";
    const GRID: &str =
        "part: the limit of fine grids, with the waves that only they carry, changes it so much";
    const ENSEMBLE: &str = "part: standard error of the mean, of 60 surfaces (bem3d) or of all lines (mdr1d)";
    const SECONDS: &str =
        "processor seconds of one load from nothing; for means of all surfaces, each load its share";
    const BYTES: &str =
        "resident memory that the row took beyond what the process held, as the system counts it";
    const STATUS: &str = "converged: every number of the certificate is within the tolerance";
    const PARETO: &str = "true where no way to this number is both cheaper and nearer";
    of_problems(TITLE, &study.rows, |r| r.problem)
        .column("model", "-", MODEL, |r| r.way.model())
        .column("size", "1", "cells a side (bem3d) or elements (mdr1d)", |r| r.way.size())
        .column("tolerance", "1", TOLERANCE, |r| r.way.tolerance())
        .column("method", "-", METHOD, |r| r.way.method())
        .column("surfaces", "1", "surfaces in the answer", |r| r.surfaces)
        .column("stiffness", "E* L", "k; the mean over the surfaces", |r| r.answer.stiffness)
        .column("approach", "h", APPROACH, |r| r.answer.approach)
        .column("contact_fraction", "1", "contact area over A0", |r| r.answer.area)
        .column("contact_cells", "1", "cells in contact", |r| r.answer.contact_cells)
        .column("error_stiffness", "1", ERROR, |r| r.errors[0])
        .column("error_approach", "1", "relative error of d, likewise", |r| r.errors[1])
        .column("error_area", "1", "relative error of the area, likewise", |r| r.errors[2])
        .column("error_pressure", "1", PRESSURE, |r| r.errors[3])
        .column("reference_error", "1", "relative uncertainty of the reference of k", |r| r.reference_error)
        .column("algebraic", "1", ALGEBRAIC, |r| r.parts.algebraic)
        .column("discretisation", "1", GRID, |r| r.parts.discretisation)
        .column("model_error", "1", "part: three dimensions change it so much", |r| r.parts.model)
        .column("ensemble", "1", ENSEMBLE, |r| r.parts.ensemble)
        .column("cpu_seconds", "s", SECONDS, |r| r.answer.cpu_seconds)
        .column("iterations", "1", "iterations of the linear solvers", |r| r.answer.iterations)
        .column("applications", "1", "applications of the elastic operator", |r| r.answer.applications)
        .column("bytes", "B", BYTES, |r| r.answer.bytes)
        .column("status", "-", STATUS, |r| r.answer.status.as_str())
        .column("pareto", "-", PARETO, |r| r.pareto)
        .table()
}

pub(crate) fn orders(study: &Study) -> Result<Table> {
    const TITLE: &str = "What accuracy costs in time: limits of fine grids and their orders";
    const ORDER: &str =
        "p of error ~ cell^p: of the extrapolation where established, else the slope of the errors";
    const ESTABLISHED: &str = "true against an exact answer, or where four grids or more follow one power";
    const LIMIT: &str = "the reference: exact, extrapolated where established, else the finest grid's";
    of_problems(TITLE, &study.orders, |o| o.problem)
        .column("quantity", "-", "stiffness, approach, area, or pressure (L2)", |o| o.quantity.as_str())
        .column("order", "1", ORDER, |o| o.power)
        .column("established", "-", ESTABLISHED, |o| o.established)
        .column("limit", "E* L, h, 1", LIMIT, |o| o.limit.map(|l| l.value))
        .column("limit_error", "1", "its relative uncertainty", |o| o.limit.map(|l| l.relative()))
        .column("error_coarsest", "1", "relative error on the coarsest grid", |o| o.errors[0])
        .column("error_finest", "1", "relative error on the finest grid", |o| o.errors[1])
        .table()
}
