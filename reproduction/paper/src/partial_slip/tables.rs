//! The tables of the study of partial slip.

use super::means::{LoopRow, SlipRow, StiffnessRow};
use super::study::{PartialSlipStudy, SlipPoint, mindlin};
use super::{SlipCase, SolvedCase};
use crate::claim::Estimate;
use crate::evaluation::{FRACTAL_DIMENSION, TableOf};
use contact_model::Table;
use runs::Result;

pub(super) const FORCE: &str = "F/(E* h L), h the measured rms height of each surface";
pub(super) const POISSON: &str = "Poisson's ratio of both bodies";
pub(super) const SHARE: &str = "Q/(mu F)";
pub(super) const HALF: &str = "half-width of its 95 % interval, by Student's distribution over the surfaces";
pub(super) const SURFACES: &str = "surfaces in the means";

pub(super) fn value(of: Option<Estimate>) -> Option<f64> {
    of.map(|estimate| estimate.value)
}

pub(super) fn half(of: Option<Estimate>) -> Option<f64> {
    of.map(|estimate| estimate.half_width)
}

/// Tangential over normal stiffness.
pub(super) fn stiffness(rows: &[StiffnessRow]) -> Result<Table> {
    const ALONG: &str = "the same along one direction";
    const ANISOTROPY: &str = "mean of (largest - smallest)/mean of the tangential stiffness over directions";
    TableOf::new("Tangential over normal stiffness of contacts that stick, over Mindlin's ratio", rows)
        .column("boundary", "-", "free, or periodic with a roll-off", |r| r.case.boundary_name())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.case.fractal_dimension)
        .column("force_bar", "1", FORCE, |r| r.force_bar)
        .column("poisson", "1", POISSON, |r| r.poisson)
        .column("contact", "1", "mean share of the square in contact", |r| value(r.contact))
        .column("min_contact_cells", "1", "fewest cells in contact", |r| r.min_contact_cells)
        .column("mindlin", "1", "(2 - 2 nu)/(2 - nu)", |r| mindlin(r.poisson))
        .column("ratio", "1", "mean of (k_xx + k_yy)/(2 k) over that", |r| value(r.ratio))
        .column("ratio_half", "1", HALF, |r| half(r.ratio))
        .column("ratio_x", "1", ALONG, |r| value(r.along_x))
        .column("ratio_x_half", "1", HALF, |r| half(r.along_x))
        .column("ratio_y", "1", ALONG, |r| value(r.along_y))
        .column("ratio_y_half", "1", HALF, |r| half(r.along_y))
        .column("anisotropy", "1", ANISOTROPY, |r| value(r.anisotropy))
        .column("anisotropy_half", "1", HALF, |r| half(r.anisotropy))
        .column("surfaces", "1", SURFACES, |r| r.surfaces)
        .column("left_out", "1", "surfaces that missed their tolerance", |r| r.left_out)
        .table()
}

/// First loading, free boundaries.
pub(super) fn slips(rows: &[SlipRow]) -> Result<Table> {
    const DISPLACEMENT: &str = "mean of delta/(mu (E*/G*) d(F))";
    const STICK: &str = "mean share of the contact that sticks";
    const STIFFNESS: &str = "mean of dQ/ddelta over that without tangential force";
    const TRACTION: &str = "rms difference of tractions from Ciavarella and Jaeger's over mu times the mean pressure, mean over surfaces";
    TableOf::new(
        "Partial slip of free fractal surfaces: first loading, means of a force along x and one along y",
        rows,
    )
    .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.case.fractal_dimension)
    .column("force_bar", "1", FORCE, |r| r.force_bar)
    .column("poisson", "1", POISSON, |r| r.poisson)
    .column("share", "1", SHARE, |r| r.share)
    .column("displacement", "1", DISPLACEMENT, |r| value(r.displacement))
    .column("displacement_half", "1", HALF, |r| half(r.displacement))
    .column("stick", "1", STICK, |r| value(r.stick))
    .column("stick_half", "1", HALF, |r| half(r.stick))
    .column("stiffness", "1", STIFFNESS, |r| value(r.stiffness))
    .column("stiffness_half", "1", HALF, |r| half(r.stiffness))
    .column("traction_miss", "1", TRACTION, |r| value(r.traction_miss))
    .column("traction_miss_half", "1", HALF, |r| half(r.traction_miss))
    .column("displacement_miss", "1", "delta of Ciavarella and Jaeger over the solution's less 1", |r| {
        value(r.displacement_miss)
    })
    .column("displacement_miss_half", "1", HALF, |r| half(r.displacement_miss))
    .column("stick_miss", "1", "their stick area over the solution's less 1", |r| value(r.stick_miss))
    .column("stick_miss_half", "1", HALF, |r| half(r.stick_miss))
    .column("profile_displacement_miss", "1", "delta of equivalent, likewise", |r| {
        value(r.profile_displacement_miss)
    })
    .column("profile_displacement_miss_half", "1", HALF, |r| half(r.profile_displacement_miss))
    .column("profile_stick_miss", "1", "(c/a)^2 of equivalent over the share that sticks, less 1", |r| {
        value(r.profile_stick_miss)
    })
    .column("profile_stick_miss_half", "1", HALF, |r| half(r.profile_stick_miss))
    .column("surfaces", "1", SURFACES, |r| r.surfaces)
    .table()
}

/// Loops, free boundaries.
pub(super) fn loops(rows: &[LoopRow]) -> Result<Table> {
    const DISSIPATED: &str = "mean of the energy of a cycle between -Q and Q over mu F times mu (E*/G*) d(F)";
    TableOf::new("Partial slip of free fractal surfaces: loops, means of both directions", rows)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.case.fractal_dimension)
        .column("force_bar", "1", FORCE, |r| r.force_bar)
        .column("poisson", "1", POISSON, |r| r.poisson)
        .column("share", "1", "largest Q/(mu F)", |r| r.amplitude)
        .column("dissipated", "1", DISSIPATED, |r| value(r.dissipated))
        .column("dissipated_half", "1", HALF, |r| half(r.dissipated))
        .column("miss", "1", "that of Ciavarella and Jaeger over the solution's less 1", |r| value(r.miss))
        .column("miss_half", "1", HALF, |r| half(r.miss))
        .column("profile_miss", "1", "that of equivalent, likewise", |r| value(r.profile_miss))
        .column("profile_miss_half", "1", HALF, |r| half(r.profile_miss))
        .column("surfaces", "1", SURFACES, |r| r.surfaces)
        .table()
}

/// A surface with one load and one Poisson's ratio, or its equivalent profile.
struct LoadedSurface<'a> {
    case: SlipCase,
    surface: usize,
    force_bar: f64,
    poisson: Option<f64>,
    contact: Option<(f64, usize, [f64; 3])>,
    points: &'a [SlipPoint],
    dissipated: &'a [f64],
}

/// All surfaces, each solved with every load and Poisson's ratio, and its equivalent profile with every load.
fn loaded_surfaces<'a>(study: &PartialSlipStudy, solved: &[SolvedCase<'a>]) -> Vec<LoadedSurface<'a>> {
    let mut rows = Vec::new();
    for &SolvedCase { case, surfaces } in solved {
        for (surface, slips) in surfaces.iter().enumerate() {
            for (j, &force_bar) in study.forces.values().iter().enumerate() {
                let sample = |poisson, contact, points, dissipated| LoadedSurface {
                    case,
                    surface,
                    force_bar,
                    poisson,
                    contact,
                    points,
                    dissipated,
                };
                for (i, &nu) in study.poissons.iter().enumerate() {
                    if let Some(s) = slips.at(study, j, i) {
                        let contact = Some((s.contact, s.contact_cells, s.stiffness));
                        rows.push(sample(Some(nu), contact, &s.points, &s.dissipated));
                    }
                }
                if let Some((points, dissipated)) = slips.equivalent.get(j).and_then(Option::as_ref) {
                    rows.push(sample(None, None, points, dissipated));
                }
            }
        }
    }
    rows
}

/// Numbers with a space between them, and a dash for a missing one.
fn listed(values: impl Iterator<Item = Option<f64>>) -> String {
    let words = values.map(|v| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.6e}")));
    words.collect::<Vec<_>>().join(" ")
}

/// Every surface: the means can be computed again from it.
pub(super) fn samples(study: &PartialSlipStudy, solved: &[SolvedCase<'_>]) -> Result<Table> {
    let rows = loaded_surfaces(study, solved);
    let of = |r: &LoadedSurface<'_>, value: fn(&SlipPoint) -> Option<f64>| listed(r.points.iter().map(value));
    let stiffness = |r: &LoadedSurface<'_>, which: usize| r.contact.map(|(.., k)| k[which]);
    TableOf::new("Partial slip of each surface", &rows)
        .column("model", "-", "bem3d, or equivalent, which is the same for every Poisson's ratio", |r| {
            if r.poisson.is_some() { "bem3d" } else { "equivalent" }
        })
        .column("boundary", "-", "free, or periodic with a roll-off", |r| r.case.boundary_name())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |r| r.case.fractal_dimension)
        .column("force_bar", "1", FORCE, |r| r.force_bar)
        .column("poisson", "1", POISSON, |r| r.poisson)
        .column("surface", "1", "number of the surface", |r| r.surface)
        .column("contact", "1", "share of the square in contact", |r| r.contact.map(|(area, ..)| area))
        .column("contact_cells", "1", "cells in contact", |r| r.contact.map(|(_, cells, _)| cells))
        .column("k_xx", "1", "tangential over normal stiffness", move |r| stiffness(r, 0))
        .column("k_yy", "1", "likewise", move |r| stiffness(r, 1))
        .column("k_xy", "1", "likewise", move |r| stiffness(r, 2))
        .column("displacement", "1", "delta/(mu (E*/G*) d(F)), at Q/(mu F) of the header", move |r| {
            of(r, |p| Some(p.displacement))
        })
        .column(
            "stick",
            "1",
            "share of the contact that sticks, (c/a)^2 of equivalent, at Q/(mu F) of the header",
            move |r| of(r, |p| Some(p.stick)),
        )
        .column(
            "stiffness",
            "1",
            "dQ/ddelta over that without tangential force, at Q/(mu F) of the header",
            move |r| of(r, |p| p.stiffness),
        )
        .column(
            "traction",
            "1",
            "rms difference from Ciavarella and Jaeger's, at Q/(mu F) of the header",
            move |r| of(r, |p| p.traction),
        )
        .column("dissipated", "1", "energy of loops, as in the table of loops", move |r| {
            listed(r.dissipated.iter().map(|d| Some(*d)))
        })
        .table()
}
