//! The tables of the grid study.

use super::grid_job::{FirstLoading, LoadOnGrid};
use super::grid_means::{GridRow, SolvedGrids};
use super::grid_tests::GridTest;
use super::study::PartialSlipStudy;
use super::tables::{FORCE, HALF, POISSON, SHARE, SURFACES, half, value};
use crate::evaluation::{FRACTAL_DIMENSION, TableOf, markdown_table};
use contact_model::Table;
use runs::Result;

const GRID: &str =
    "what remains of the discretisation error, in the rows without cells: a half-width to be added";

/// Means on each grid, and extrapolated.
pub(super) fn rows(rows: &[GridRow]) -> Result<Table> {
    TableOf::new("Partial slip of the same free fractal surfaces on several grids: first loading", rows)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("force_bar", "1", FORCE, |r| r.force_bar)
        .column("poisson", "1", POISSON, |r| r.poisson)
        .column("share", "1", SHARE, |r| r.share)
        .column("cells", "1", "cells a side; empty: in the limit of small cells", |r| r.cells.map(|c| c[0]))
        .column("min_contact_cells", "1", "fewest cells in contact", |r| r.cells.map(|c| c[1]))
        .column("stick", "1", "mean share of the contact that sticks; without cells 2 s(a) - s(2a)", |r| {
            value(r.stick)
        })
        .column("stick_half", "1", HALF, |r| half(r.stick))
        .column("stick_grid", "1", GRID, |r| r.stick_grid)
        .column("stick_corrected", "1", "the same of areas corrected for the cells at their boundary", |r| {
            value(r.corrected)
        })
        .column("stick_corrected_half", "1", HALF, |r| half(r.corrected))
        .column("stick_corrected_grid", "1", GRID, |r| r.corrected_grid)
        .column("stiffness", "1", "mean of k_t(Q)/k_t(0); without cells that of the finest grid", |r| {
            value(r.stiffness)
        })
        .column("stiffness_half", "1", HALF, |r| half(r.stiffness))
        .column("stiffness_grid", "1", GRID, |r| r.stiffness_grid)
        .column("surfaces", "1", SURFACES, |r| r.surfaces)
        .table()
}

/// The tests of the hypotheses.
pub(super) fn tests(tests: &[GridTest]) -> Result<Table> {
    TableOf::new("Tests of hypotheses.md, bodies without Poisson's ratio", tests)
        .column("family", "-", "family of tests", |t| t.family)
        .column("of", "1", "number of tests of the family", |t| t.of)
        .column("quantity", "-", "number and hypothesis", |t| t.quantity)
        .column("fractal_dimension", "-", "D_f, or the difference of two", |t| t.fractal_dimension.clone())
        .column("force_bar", "1", FORCE, |t| t.force_bar)
        .column("share", "1", SHARE, |t| t.share)
        .column("sample", "-", "surfaces seen before, new ones, or all; new ones decide", |t| t.sample.name())
        .column("surfaces", "1", "surfaces in the mean", |t| t.found.map(|f| f.surfaces))
        .column("expected", "1", "value under the hypothesis", |t| t.expected)
        .column("found", "1", "mean over surfaces", |t| t.found.map(|f| f.mean.value))
        .column(
            "scatter",
            "1",
            "half-width by Student's distribution, simultaneous with the family",
            GridTest::scatter,
        )
        .column("grid", "1", "half-width of the discretisation error, to be added", |t| {
            t.found.map(|f| f.grid)
        })
        .column("chance", "1", "p-value of this test alone, the difference reduced by grid", GridTest::chance)
        .column("verdict", "-", "whether the hypothesis is rejected", GridTest::verdict)
        .table()
}

/// A surface on a grid with one load and one Poisson's ratio.
struct GridSample<'a> {
    fractal_dimension: f64,
    force_bar: f64,
    poisson: f64,
    surface: usize,
    cells: usize,
    load: &'a LoadOnGrid,
    loading: &'a FirstLoading,
}

/// Every surface on every grid: the means can be computed again from it.
pub(super) fn samples(study: &PartialSlipStudy, solved: &[SolvedGrids<'_>]) -> Result<Table> {
    let mut rows = Vec::new();
    for of in solved {
        for (i, on_grid) in of.surfaces.iter().enumerate() {
            for (load, &force_bar) in on_grid.loads.iter().zip(study.forces.values()) {
                let Some(load) = load else { continue };
                for (loading, &poisson) in load.loadings.iter().zip(&study.poissons) {
                    rows.push(GridSample {
                        fractal_dimension: of.fractal_dimension,
                        force_bar,
                        poisson,
                        surface: i / of.grids,
                        cells: study.grids[i % of.grids],
                        load,
                        loading,
                    });
                }
            }
        }
    }
    let listed = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(|v| format!("{v:.6}")).collect();
        words.join(" ")
    };
    TableOf::new("Partial slip of each surface on each grid", &rows)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.fractal_dimension)
        .column("force_bar", "1", FORCE, |r| r.force_bar)
        .column("poisson", "1", POISSON, |r| r.poisson)
        .column("surface", "1", "number of the surface", |r| r.surface)
        .column("cells", "1", "cells a side", |r| r.cells)
        .column("contact_cells", "1", "cells in contact", |r| r.load.contact_cells)
        .column("stick", "1", "share of the contact that sticks, at Q/(mu F) of the header", move |r| {
            listed(&r.loading.stick)
        })
        .column(
            "stick_corrected",
            "1",
            "the same of areas corrected for the cells at their boundary",
            move |r| listed(&r.loading.stick_corrected),
        )
        .column("stiffness", "1", "k_t(Q)/k_t(0), at Q/(mu F) of the header", move |r| {
            listed(&r.loading.stiffness)
        })
        .table()
}

/// Tangential forces in the text.
const SHOWN: [f64; 3] = [0.3, 0.5, 0.9];

/// The extrapolated shares and the tests in short tables.
pub(super) fn text(study: &PartialSlipStudy, rows: &[GridRow], tests: &[GridTest]) -> String {
    let with_errors = |of: Option<crate::claim::Estimate>, grid: Option<f64>| {
        of.zip(grid).map_or_else(String::new, |(of, grid)| {
            format!("{:.4} ± {:.4} ± {grid:.4}", of.value, of.half_width)
        })
    };
    let limit = |r: &GridRow| {
        [
            format!("{:?}", r.fractal_dimension),
            format!("{}", r.force_bar),
            format!("{}", r.poisson),
            format!("{}", r.share),
            with_errors(r.stick, r.stick_grid),
            with_errors(r.corrected, r.corrected_grid),
            with_errors(r.stiffness, r.stiffness_grid),
        ]
    };
    let shown = |r: &&GridRow| r.cells.is_none() && SHOWN.iter().any(|share| (share - r.share).abs() < 1e-9);
    let head = "| D_f | F_bar | nu | Q/(mu F) | share that sticks | of corrected areas | k_t(Q)/k_t(0) |\n| --- | --- | --- | --- | --- | --- | --- |";
    let limits = markdown_table(head, rows.iter().filter(shown).map(limit));
    let number = |of: Option<f64>| of.map_or_else(String::new, |of| format!("{of:.4}"));
    let test = |t: &GridTest| {
        [
            t.family.to_owned(),
            t.quantity.to_owned(),
            t.fractal_dimension.clone(),
            format!("{}", t.force_bar),
            format!("{}", t.share),
            t.sample.name().to_owned(),
            format!("{:.4}", t.expected),
            number(t.found.map(|f| f.mean.value)),
            number(t.scatter()),
            number(t.found.map(|f| f.grid)),
            t.chance().map_or_else(String::new, |p| format!("{p:.1e}")),
            t.verdict().to_owned(),
        ]
    };
    let head = "| family | quantity | D_f | F_bar | Q/(mu F) | surfaces | expected | found | scatter | grid | p | verdict |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |";
    let tests = markdown_table(head, tests.iter().map(test));
    format!(
        "`{}`\n\nMeans over {} surfaces in the limit of small cells, ± the half-width of the 95 % interval over surfaces ± the remaining discretisation error:\n\n{limits}\nTests of hypotheses.md; new surfaces decide:\n\n{tests}",
        study.command(),
        study.surfaces,
    )
}
