//! Regions of contact: one at small force, and diameters that add up to the contact length.

use super::common::mean_of;
use crate::claim::{Claim, Estimate, Statement};
use bem3d::Bem3d;
use contact_model::{ContactModel as _, ContactState, Field, Load, Scene, SelfAffine, Surface};
use evaluation::SEED;
use runs::{Error, Result};
use std::f64::consts::{PI, TAU};

/// Cells a side, and surfaces: seconds, whatever the size of the run.
const CELLS: usize = 513;
const SURFACES: u64 = 24;

const ONE_REGION: Statement = Statement {
    quotation: "On the largest scale, there is only one contact region visible, although it may be subdivided into smaller sections when magnified",
    place: "Sec. IV",
    reading: "at F_bar = 0.001 and D_f up to 2.4, 90 % of the cells in contact lie within a quarter of the side from their centre",
};

const DIAMETERS: Statement = Statement {
    quotation: "this quantity really can be interpreted as the sum of the diameters of all contact regions",
    place: "Sec. I, Eq. 1",
    reading: "of a nonfractal surface (waves of a sixteenth to a thirty-second of the side), where 1 % touches: k/E* over the sum of diameters of circles of equal areas is 1 to 0.15",
};

/// Both statements, on surfaces of their own.
///
/// # Errors
/// What the solver refuses.
pub(crate) fn regions() -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for d in [2.0, 2.2, 2.4] {
        let each = surfaces(self_affine(d)?, 1e-3, |state| {
            let pressure = state.fields.as_ref()?.pressure.as_ref()?;
            Some(share_near_the_centre(pressure))
        })?;
        let name = format!("share of the contact in one region, D_f = {d:?}");
        let remark = format!("mean over {SURFACES} surfaces of {CELLS} cells a side, Student's interval");
        claims.push(match mean_of(&each) {
            Some(share) => Claim::judge(name, ONE_REGION, [0.9, 1.0 + 1e-9], within_one(share), remark),
            None => Claim::unresolved(name, ONE_REGION, [0.9, 1.0], "no pressure field"),
        });
    }
    let smooth =
        SelfAffine { roll_off: Some(TAU * 16.0), short_cutoff: Some(TAU * 32.0), ..self_affine(2.2)? };
    let each = surfaces(smooth, 0.03, |state| {
        let (k, patches) = (state.stiffness?, state.patches.as_ref()?);
        Some(k / analysis::sum(patches.areas().iter().map(|area| 2.0 * (area / PI).sqrt())))
    })?;
    let name = "contact length over the sum of diameters, nonfractal surface";
    let paper = [0.85, 1.15];
    claims.push(match mean_of(&each) {
        Some(found) => {
            let remark = format!(
                "F_bar = 0.03, mean over {SURFACES} surfaces of {CELLS} cells a side, Student's interval"
            );
            Claim::judge(name, DIAMETERS, paper, found, remark)
        }
        None => Claim::unresolved(name, DIAMETERS, paper, "no patches"),
    });
    Ok(claims)
}

fn self_affine(d: f64) -> Result<SelfAffine> {
    SelfAffine::new(d, 1.0, 1.0).map_err(Error::model(format!("D_f = {d:?}")))
}

/// A share cannot exceed 1, and neither does its interval.
fn within_one(share: Estimate) -> Estimate {
    let (low, high) = (share.value - share.half_width, (share.value + share.half_width).min(1.0));
    Estimate { value: 0.5 * (low + high), half_width: 0.5 * (high - low) }
}

/// Solves the first surfaces under one load and reads a number from each state.
fn surfaces(
    surface: SelfAffine,
    force_bar: f64,
    read: impl Fn(&ContactState) -> Option<f64>,
) -> Result<Vec<f64>> {
    let model = Bem3d { cells: CELLS, tolerance: 1e-4, ..Bem3d::default() };
    let solve = |index: u64| {
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        scene.outputs.stiffness = true;
        scene.outputs.contact_patches = true;
        scene.outputs.pressure = true;
        let mut contact = model.prepare(&scene, surface_gen::surface_seed(SEED, index))?;
        let force = contact.normalisation().force(force_bar)?;
        Ok(read(&contact.solve(Load::Force(force))?))
    };
    let each: Vec<Option<f64>> = (0..SURFACES)
        .map(|index| solve(index).map_err(Error::model("contact regions")))
        .collect::<Result<_>>()?;
    Ok(each.into_iter().flatten().collect())
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
