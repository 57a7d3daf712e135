//! Numbers that are solved for a claim alone, whatever the size of the run: full contact, regions of contact,
//! rms heights.

use super::table::{ClaimRow, ClaimedNumber};
use crate::claim::Estimate;
use crate::evaluation::SEED;
use analytic::spectrum::Spectrum;
use bem3d::Bem3d;
use contact_model::{Amplitude, ContactModel, ContactState, Field, Load, Scene, SelfAffine, Surface};
use mdr1d::Mdr1d;
use runs::{Error, Result};
use std::f64::consts::{PI, TAU};
use surface_gen::{LineGenerator, MapGenerator};

/// Full contact of two grids of this many cells a side, extrapolated in 1/N (the error is of first order:
/// data/paper/VALUES.md).
const GRIDS: [usize; 2] = [64, 128];

/// k/(E* L) of a scene under a load that presses all of it flat.
fn full_contact(what: &str, model: &dyn ContactModel, scene: &Scene, force: f64) -> Result<f64> {
    let solved = model.prepare(scene, 0).and_then(|mut contact| contact.solve(Load::force(force)));
    let no_stiffness = || Error::parameter("model", model.name(), "one that gives a stiffness");
    solved.map_err(Error::model(format!("full contact of {what}")))?.stiffness.ok_or_else(no_stiffness)
}

/// The stiffness of the rigid square in the limit of small cells.
fn square() -> Result<Estimate> {
    let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
    let of = |cells: usize| {
        let model = Bem3d { cells, tolerance: 1e-9, ..Bem3d::default() };
        full_contact(&format!("{cells} x {cells} cells"), &model, &scene, 1.0)
    };
    let [n, m] = GRIDS;
    let (coarse, fine) = (of(n)?, of(m)?);
    Ok(Estimate {
        value: (m as f64 * fine - n as f64 * coarse) / (m - n) as f64,
        // Terms of higher order that the extrapolation leaves: data/paper/VALUES.md.
        half_width: 0.25 / (m as f64).powf(1.59),
    })
}

pub(super) fn plateau() -> Result<Vec<ClaimRow>> {
    let [n, m] = GRIDS;
    let remark = format!(
        "1.012 x 2/sqrt(pi) is an old value of the rigid square punch, the converged one is 1.152298; full contact of {n} and {m} cells a side, \
         extrapolated in 1/N; the continuum plateau of k_bar is 1.0091"
    );
    Ok(ClaimRow::only(Ok((square()?, remark))))
}

pub(super) fn ratio_of_plateaus() -> Result<Vec<ClaimRow>> {
    let scene = Scene::new(Surface::SelfAffine(self_affine(2.0)?), 1.0);
    // 1e6 E* h L presses every element flat.
    let line = full_contact("a line", &Mdr1d { elements: 4096 }, &scene, 1e6)?;
    let square = square()?;
    let ratio =
        Estimate { value: line / square.value, half_width: line * square.half_width / square.value.powi(2) };
    let remark =
        "a line of length (2/sqrt(pi)) L has k = 1.12838 E* L: equal areas are not equal stiffnesses";
    Ok(ClaimRow::only(Ok((ratio, remark.to_owned()))))
}

/// Elements and cells of the paper.
const SIZES: (usize, usize) = (1 << 20, 2049);

/// rms height of the line over that of the surface, both to the ends of their own spectra; 1 between equal
/// limits.
pub(super) fn ratio_of_heights(dimensions: &[f64]) -> Result<Vec<ClaimRow>> {
    let (elements, cells) = SIZES;
    let remark = format!(
        "{elements} elements, {cells} cells a side, each to the ends of its own spectrum; F_bar counts the measured rms height of each"
    );
    let row = |&d: &f64| {
        let ratio = height_ratio(d, elements, cells)?;
        Ok(ClaimRow {
            in_convention: Some(1.0),
            ..ClaimRow::at(d, Ok((Estimate::exact(ratio), remark.clone())))
        })
    };
    dimensions.iter().map(row).collect()
}

/// rms height of a surface over that of its spectrum as a continuous function, from the wave of the side to the end
/// of the grid: the few longest waves, which carry most of the height, are a sum and no integral.
pub(super) fn height_over_continuous(d: f64, cells: usize) -> Result<f64> {
    let surface = SelfAffine { amplitude: Amplitude::Spectrum(1.0), ..self_affine(d)? };
    let ratio = || {
        let continuous = SelfAffine { short_cutoff: Some(TAU * (cells / 2) as f64), ..surface };
        Ok(MapGenerator::new(&surface, cells)?.rms_height() / Spectrum::new(&continuous)?.rms_height())
    };
    ratio().map_err(Error::model(format!("rms heights at D_f = {d:?}")))
}

/// rms height of the line over that of the surface where both have one spectrum, and not one rms height.
pub(super) fn height_ratio(d: f64, elements: usize, cells: usize) -> Result<f64> {
    let surface = SelfAffine { amplitude: Amplitude::Spectrum(1.0), ..self_affine(d)? };
    let ratio = || {
        let line = LineGenerator::new(&surface, elements)?.rms_height();
        Ok(line / MapGenerator::new(&surface, cells)?.rms_height())
    };
    ratio().map_err(Error::model(format!("rms heights at D_f = {d:?}")))
}

/// Number of cells along a side and of surfaces; they take seconds, independent of the size of the run.
const CELLS: usize = 513;
const SURFACES: u64 = 24;

pub(super) fn share_in_one_region(dimensions: &[f64]) -> Result<Vec<ClaimRow>> {
    let row = |&d: &f64| {
        let share = mean_of(self_affine(d)?, 1e-3, "no pressure field", |state| {
            Some(share_near_the_centre(state.fields.as_ref()?.pressure.as_ref()?))
        })?;
        Ok(ClaimRow::at(d, share.map(|(share, remark)| (within_one(share), remark))))
    };
    dimensions.iter().map(row).collect()
}

pub(super) fn length_over_diameters() -> Result<Vec<ClaimRow>> {
    let smooth =
        SelfAffine { roll_off: Some(TAU * 16.0), short_cutoff: Some(TAU * 32.0), ..self_affine(2.2)? };
    let ratio = mean_of(smooth, 0.03, "no patches", |state| {
        let (k, patches) = (state.stiffness?, state.patches.as_ref()?);
        Some(k / analysis::sum(patches.areas().iter().map(|area| 2.0 * (area / PI).sqrt())))
    })?;
    Ok(ClaimRow::only(ratio.map(|(ratio, remark)| (ratio, format!("F_bar = 0.03, {remark}")))))
}

fn self_affine(d: f64) -> Result<SelfAffine> {
    SelfAffine::new(d, 1.0, 1.0).map_err(Error::model(format!("D_f = {d:?}")))
}

/// A share cannot exceed 1, and neither does its interval.
fn within_one(share: Estimate) -> Estimate {
    let (low, high) = (share.value - share.half_width, (share.value + share.half_width).min(1.0));
    Estimate { value: 0.5 * (low + high), half_width: 0.5 * (high - low) }
}

/// Mean of a number of the states of the first surfaces under one load.
fn mean_of(
    surface: SelfAffine,
    force_bar: f64,
    absent: &'static str,
    read: impl Fn(&ContactState) -> Option<f64>,
) -> Result<ClaimedNumber> {
    let model = Bem3d { cells: CELLS, tolerance: 1e-4, ..Bem3d::default() };
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    scene.outputs.stiffness = true;
    scene.outputs.contact_patches = true;
    scene.outputs.pressure = true;
    let solve = |index: u64| {
        let mut contact = model.prepare(&scene, surface_gen::surface_seed(SEED, index))?;
        let force = contact.normalisation().force(force_bar)?;
        Ok(read(&contact.solve(Load::force(force))?))
    };
    let each: contact_model::Result<Vec<Option<f64>>> = (0..SURFACES).map(solve).collect();
    let each: Vec<f64> = each.map_err(Error::model("contact regions"))?.into_iter().flatten().collect();
    let remark = format!("mean over {SURFACES} surfaces of {CELLS} cells a side, Student's interval");
    Ok(Estimate::mean(&each).map(|mean| (mean, remark)).ok_or(absent.into()))
}

/// Share of the cells in contact whose distance from their common centre is at most a quarter of the side.
fn share_near_the_centre(pressure: &Field) -> f64 {
    let (rows, columns) = (pressure.rows(), pressure.columns());
    let touching: Vec<(f64, f64)> = (pressure.values().iter().enumerate())
        .filter(|(_, p)| **p > 0.0)
        .map(|(i, _)| ((i / columns) as f64 / rows as f64, (i % columns) as f64 / columns as f64))
        .collect();
    let n = touching.len().max(1) as f64;
    let centre = |pick: fn(&(f64, f64)) -> f64| analysis::sum(touching.iter().map(pick)) / n;
    let (y, x) = (centre(|c| c.0), centre(|c| c.1));
    touching.iter().filter(|c| (c.0 - y).hypot(c.1 - x) <= 0.25).count() as f64 / n
}
