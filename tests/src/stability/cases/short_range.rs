//! Adhesion of short range: the work of adhesion acts in the last cells of a contact.

use super::adhesion::{attracted_by, go, meets_and_is_stable, path};
use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, known, pressure};
use crate::stability::maps::{map, rough_map};
use crate::stability::plain::PlainSum;
use crate::stability::shear::{Dragged, PlainShear, compliance};
use crate::stability::slide::{VectorField, alike, rubbed, tangential, vectors};
use analytic::jkr::AdhesiveSphere;
use bem3d::Bem3d;
use contact_model::{
    Adhesion, Boundary, ContactModel, ContactState, Effects, Error, Friction, HeightMap, Load, Result, Scene,
    Status, Tangential,
};
use std::f64::consts::PI;

pub(super) const CASES: [HardCase; 3] = [
    HardCase {
        name: "a front pinned cell by cell",
        why: "a sphere drawn off under force control: its front jumps from cells to cells until none of them holds, at a fold of the path",
        asserted: "traction and gap of every cell by plain sums; radii and pull-off are JKR's within the cells; beyond the fold an error \
                   with the bits of the last stable state, from where the path goes on",
        bound: 1e-6,
        solve: pinned,
    },
    HardCase {
        name: "a map that snaps in at the first touch",
        why: "cells in contact pull in the others over the whole period: the first load passes all partial contacts in one avalanche",
        asserted: "traction and gap of every cell by plain sums; 0.85 of the area and more at F = 0, under a push \
                   that closes less than half without adhesion; what a push has closed stays; a pull is held",
        bound: 1e-6,
        solve: avalanche,
    },
    HardCase {
        name: "a front that retreats while it is dragged",
        why: "a sphere dragged by its shear strength is drawn off step by step: cells at the front are let go while they stick, and come back under the next push",
        asserted: "traction and gap of every cell by plain sums; tractions by relaxation of the plain tangential sum with the strength times each \
                   cell's attached share; sliding force and both areas; beyond the fold an error, from where the path goes on",
        bound: 3e-5,
        solve: dragged,
    },
];

/// Largest traction of a cell on a straight front, over `sqrt(E* w/a)`; a is the longer side of a cell.
const STRENGTH: f64 = 0.59;
/// Energy of a front that the factors of the neighbours compensate, over `a w` and its length.
const FRONT: f64 = 0.415;
/// Neighbours lie on a ring of this radius and half width, in units of a.
const RING: (f64, f64) = (4.0, 1.5);
const NEAR: isize = 6;
/// Share of the area in nearly full contact.
const NEARLY: f64 = 0.85;

/// A contact with adhesion of short range, on square cells.
struct ShortRangeContact<'a> {
    map: &'a HeightMap,
    /// The kernel of its boundary.
    sum: &'a PlainSum,
    boundary: Boundary,
    work: f64,
}

/// The residual of a state, by plain sums: for open cells the difference between the traction
/// and that of their gap and their neighbours, for closed ones a negative contact pressure. Tractions are
/// over the largest one of a straight front, gaps over the range.
fn conditions(ledger: &mut Ledger, of: &ShortRangeContact<'_>, state: &ContactState) -> Result<()> {
    let &ShortRangeContact { map, sum, boundary, work } = of;
    meets_and_is_stable(ledger, state);
    let (p, cell) = (pressure(state)?, map.dx());
    let forces: Vec<(usize, f64)> = p.iter().enumerate().map(|(i, p)| (i, p * cell * cell)).collect();
    let u = sum.displacement(&forces);
    let mut gap: Vec<f64> = u.iter().zip(map.heights()).map(|(u, h)| u + map.highest() - h).collect();
    let periodic = boundary == Boundary::Periodic;
    // A periodic kernel leaves the plane open: where the least gap is, the bodies touch.
    let d = if periodic { gap.iter().copied().fold(f64::INFINITY, f64::min) } else { approach(state)? };
    let largest = STRENGTH * (work / cell).sqrt();
    let range = 15.0 / 8.0 * work / largest;
    for g in &mut gap {
        *g = (*g - d) / range;
    }
    let nearness = |g: &f64| (1.0 - g.max(0.0)).max(0.0);
    let attached: Vec<f64> = gap.iter().map(nearness).map(share_of_work).collect();
    for ((p, g), factor) in p.iter().zip(&gap).zip(factors(map, periodic, &attached)) {
        ledger.enter((-g).max(0.0));
        let y = nearness(g);
        let contact = p / largest + factor * y * (0.4 + y * (2.2 - 1.6 * y));
        // Where there is contact pressure there is no gap.
        ledger.enter((-contact).max(0.0));
        ledger.enter(contact.min(g.max(0.0)).max(0.0));
    }
    Ok(())
}

/// The share of the work that is left, the integral of the law.
fn share_of_work(nearness: f64) -> f64 {
    nearness * nearness * (3.0 + nearness * (11.0 - 6.0 * nearness)) / 8.0
}

/// The factor of the traction of each cell due to its neighbours: 1 on a straight front, more inside.
fn factors(map: &HeightMap, periodic: bool, attached: &[f64]) -> Vec<f64> {
    let (columns, rows) = (map.columns().cast_signed(), map.rows().cast_signed());
    let lags = || (-NEAR..=NEAR).flat_map(|y| (-NEAR..=NEAR).map(move |x| (x, y)));
    let weight = |x: isize, y: isize| {
        (1.0 - (((x * x + y * y) as f64).sqrt() - RING.0).powi(2) / (RING.1 * RING.1)).max(0.0)
    };
    let total: f64 = lags().map(|(x, y)| weight(x, y)).sum();
    // The mean distance along x or y, in cells.
    let distance: f64 =
        lags().map(|(x, y)| 0.5 * (x.abs() + y.abs()) as f64 * weight(x, y)).sum::<f64>() / total;
    let at = |x: isize, y: isize| match (periodic, (0..columns).contains(&x) && (0..rows).contains(&y)) {
        (false, false) => 0.0,
        _ => attached[(y.rem_euclid(rows) * columns + x.rem_euclid(columns)).unsigned_abs()],
    };
    let mean = |i: isize| {
        let (x, y) = (i % columns, i / columns);
        lags().map(|(dx, dy)| weight(dx, dy) * at(x + dx, y + dy)).sum::<f64>() / total
    };
    (0..columns * rows).map(|i| 1.0 + 2.0 * FRONT / distance * (2.0 * mean(i) - 1.0)).collect()
}

/// The sphere R = 1 with this number of cells in its contact radius without load.
fn ball(exact: &AdhesiveSphere, in_radius: f64) -> Result<HeightMap> {
    let dx = exact.radius_at_force(0.0)? / in_radius;
    let cells = (2.6 * in_radius).ceil() as usize;
    // The centre lies beside all symmetries of the grid.
    let (x0, y0) = (0.5 * cells as f64 - 0.19, 0.5 * cells as f64 - 0.37);
    map(cells, cells as f64 * dx, |x, y| -0.5 * dx * dx * ((x as f64 - x0).powi(2) + (y as f64 - y0).powi(2)))
}

fn pinned(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    /// Bound for the trapping of fronts, and for cells of a tenth of the radius.
    const JKR: f64 = 0.04;
    let in_radius = effort.pick(10.0, 24.0);
    let work = 1e-4;
    let exact = AdhesiveSphere::new(1.0, 1.0, work)?;
    let unit = exact.pull_off_at_force()?.force;
    let map = ball(&exact, in_radius)?;
    let sum = PlainSum::of(&map);
    let contact = ShortRangeContact { map: &map, sum: &sum, boundary: Boundary::Free, work };
    let mut history = path(&attracted_by(&map, Adhesion::ShortRange { work }))?;
    let mut drawn = |ledger: &mut Ledger, share: f64| -> Result<ContactState> {
        let state = go(history.as_mut(), Load::force(share * unit))?;
        conditions(ledger, &contact, &state)?;
        let (area, radius) =
            (state.area.unwrap_or(f64::NAN), exact.radius_at_force((share * unit).max(unit))?);
        // Near the fold the radius goes with the root of what is left of the force.
        let within = if share < 0.9 { JKR } else { 3.0 * JKR };
        ledger.must(((area / PI).sqrt() / radius - 1.0).abs() < within, || {
            format!("{share} of the pull-off force: area {area}, radius {radius}")
        });
        Ok(state)
    };
    drawn(ledger, -0.5)?;
    let mut last = drawn(ledger, 0.0)?;
    let mut share = 0.5;
    let best = loop {
        match drawn(ledger, share) {
            Ok(state) => last = state,
            Err(Error::NotConverged { best }) => break best,
            Err(error) => return Err(error),
        }
        share += if share < 0.9 { 0.1 } else { 0.01 };
    };
    ledger.must((share - 1.0).abs() < JKR, || format!("it holds up to {share} of the pull-off force"));
    ledger.must(best.report.strategy.contains("pull-off"), || best.report.strategy.clone());
    ledger.same_bits("the last stable state", &best, &last);
    // The path stands there: a load far beyond ends with the same state, and less of one goes on from it.
    match drawn(ledger, 2.0) {
        Err(Error::NotConverged { best }) => ledger.same_bits("the last stable state again", &best, &last),
        other => ledger.must(false, || format!("twice the pull-off force: {:?}", other.is_ok())),
    }
    drawn(ledger, 0.5)?;
    drawn(ledger, 0.0)?;
    Ok(())
}

fn dragged(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let (work, strength) = (1e-4, 0.01);
    let exact = AdhesiveSphere::new(1.0, 1.0, work)?;
    let unit = exact.pull_off_at_force()?.force;
    let map = ball(&exact, effort.pick(6.0, 9.0))?;
    let (sum, pair) = (PlainSum::of(&map), alike(0.3));
    let contact = ShortRangeContact { map: &map, sum: &sum, boundary: Boundary::Free, work };
    let shear = PlainShear::of(&map, compliance(&pair)?);
    let mut relaxed = Dragged::new(&shear);
    let mut scene = attracted_by(&map, Adhesion::ShortRange { work });
    scene.outputs = rubbed(&map, pair, 1.0).outputs;
    (scene.pair, scene.effects.friction) = (Some(pair), Friction::tresca(strength));
    (scene.outputs.gap, scene.outputs.area) = (true, true);
    // A duality gap bounds the square of an error of the tractions.
    let mut history = Bem3d { tolerance: 1e-11, ..Bem3d::default() }.prepare(&scene, 0)?;
    let cell = map.dx() * map.dy();
    let range = 15.0 / 8.0 * work / (STRENGTH * (work / map.dx()).sqrt());
    // Slides at about 0.03.
    let loads = [
        (-0.5, 0.0),
        (-0.5, 2e-3),
        (0.4, 2e-3),
        (0.8, 3e-3),
        (0.8, -1e-3),
        (0.2, -1e-3),
        (2.0, 0.0),
        (0.6, 0.1),
    ];
    for (share, moved) in loads {
        let displacement = [moved, 0.5 * moved];
        let load = Load::force(share * unit).with_tangential(Tangential::Displacement(displacement));
        let state = match go(history.as_mut(), load) {
            Err(Error::NotConverged { best }) if share > 1.0 => {
                ledger.must(best.report.status == Status::PulledOff, || format!("{:?}", best.report));
                continue;
            }
            found => found?,
        };
        ledger.must(share < 1.0, || "more than the pull-off force is held".into());
        conditions(ledger, &contact, &state)?;
        let gaps = known("gap", state.gap())?.values();
        let share_of = |gap: &f64| share_of_work((1.0 - gap / range).clamp(0.0, 1.0));
        let limits: Vec<(usize, f64)> = (gaps.iter().map(share_of).enumerate())
            .filter(|(_, share)| *share > 0.0)
            .map(|(i, share)| (i, strength * share * cell))
            .collect();
        relaxed.advance(&limits, displacement);
        let most: f64 = limits.iter().map(|(_, limit)| limit).sum();
        for ([x, y], [fx, fy]) in vectors(&state, VectorField::Traction)?.iter().zip(&relaxed.forces) {
            ledger.enter((x - fx / cell).hypot(y - fy / cell) / strength);
        }
        let found = tangential(&state)?;
        ledger.near("sliding force", known("sliding force", found.sliding_force)?, most);
        let areas = known("stick", found.stick_area)? + known("slip", found.slip_area)?;
        ledger.near("stick and slip", areas, most / strength);
        ledger.near("area", known("area", state.area)?, most / strength);
    }
    Ok(())
}

fn avalanche(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    /// Bound for areas, between two solves of one state.
    const LOOP: f64 = 1e-6;
    let cells = effort.pick(48, 96);
    let map = rough_map(2.2, cells, 2)?.scaled(1.0, 0.02)?;
    let (work, pushed) = (3e-3, 0.02);
    let sum = PlainSum::periodic(&map);
    let contact = ShortRangeContact { map: &map, sum: &sum, boundary: Boundary::Periodic, work };
    let mut scene = attracted_by(&map, Adhesion::ShortRange { work });
    scene.effects.boundary = Boundary::Periodic;
    let area = |state: &ContactState| state.area.unwrap_or(f64::NAN);
    let elastic = Scene { effects: Effects { adhesion: Adhesion::Off, ..scene.effects }, ..scene.clone() };
    let without = area(&path(&elastic)?.solve(Load::force(pushed))?);
    ledger.must(without < 0.5, || format!("area {without} without adhesion"));
    let mut history = path(&scene)?;
    let mut areas = Vec::new();
    // A pull opens the hollows further and is held.
    for (force, least) in [(0.0, NEARLY), (pushed, NEARLY), (0.0, NEARLY), (-0.05, 0.5)] {
        let state = go(history.as_mut(), Load::force(force))?;
        conditions(ledger, &contact, &state)?;
        let area = area(&state);
        ledger.must(area > least, || format!("F {force}: area {area}"));
        areas.push(area);
    }
    ledger.must(areas[2] > areas[0] * (1.0 - LOOP), || format!("a push lets go: {areas:?}"));
    Ok(())
}
