//! Cells that reach the hardness.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, largest, pressure};
use crate::stability::maps::{hard_map, map, rough_map};
use crate::stability::plain::PlainSum;
use crate::stability::press::{forces, tight, watched};
use crate::stability::shear::{PlainShear, compliance};
use crate::stability::slide::{MU, VectorField, alike, compare, rubbed, tangential, vectors};
use crate::stability::{DensePath, DenseSurface, Prescribed};
use bem3d::Bem3d;
use contact_model::{
    ContactModel, ContactState, Error, Friction, FrictionLaw, Hardness, HeightMap, Load, Result, Scene, Step,
    Tangential,
};

pub(super) const CASES: [HardCase; 5] = [
    HardCase {
        name: "a flat punch at the hardness",
        why: "no cell ever opens: the edge saturates first, and the approach has no bound as the force reaches that of all cells",
        asserted: "the conditions by plain sums; every cell in contact; forces of all cells and more are refused with that force",
        bound: 1e-9,
        solve: flat,
    },
    HardCase {
        name: "hard maps with a hardness",
        why: "noise, steps, spikes and heights over twenty decades: sets of elastic cells are single cells and rims one cell wide, and \
              sets that follow from each other alternate",
        asserted: "the conditions by plain sums, from a hardness that few cells reach to one that nearly all do",
        bound: 1e-9,
        solve: maps,
    },
    HardCase {
        name: "two scales with a hardness",
        why: "the fine scale flows under every load, the coarse one is elastic for long: saturated cells are sprinkled over an elastic contact",
        asserted: "the conditions by plain sums; area at least F/p_s and increasing in the load",
        bound: 1e-9,
        solve: two_scales,
    },
    HardCase {
        name: "near full plasticity",
        why: "a hardness of 0.1 E*, a slope of 0.08, a mean pressure of 0.0999 E*: a few cells decide the approach, and solvers ran for ever",
        asserted: "the conditions by plain sums up to all cells but a thousandth at the hardness",
        bound: 1e-9,
        solve: full,
    },
    HardCase {
        name: "sheared where it flows",
        why: "cells at the hardness have one limit of friction, a tie of nearly all cells; the indentation moves the contact, and with it the cells that remember their slip",
        asserted: "beside dense matrices with an indentation and tractions of their own: loaded until all cells but a few flow, sheared, turned, unloaded, loaded again",
        bound: 1e-7,
        solve: sheared,
    },
];

/// The residual of the conditions of `0 <= p <= p_s`, by plain sums. Gaps are in rms heights, or in
/// approaches where there is no rms height.
fn conditions(ledger: &mut Ledger, map: &HeightMap, hardness: f64, state: &ContactState) -> Result<()> {
    ledger.meets(state, tight().tolerance);
    let (p, d) = (pressure(state)?, approach(state)?);
    let cell = map.dx() * map.dy();
    let u = PlainSum::of(map).displacement(&forces(state, map)?);
    let rms = surface_gen::rms_height(map.heights());
    let unit = if rms > 0.0 { rms } else { d };
    let mut saturated = 0;
    for (i, (&p, u)) in p.iter().zip(&u).enumerate() {
        let gap = (u + map.highest() - map.heights()[i] - d) / unit;
        // Pressures leave the solver in other units than they came.
        let full = p >= hardness * (1.0 - 1e-12);
        saturated += usize::from(full);
        ledger.must(p >= 0.0 && p <= hardness * (1.0 + 1e-12), || format!("pressure {p} of {hardness}"));
        ledger.enter(if full {
            gap.max(0.0)
        } else if p > 0.0 {
            gap.abs() * p / hardness
        } else {
            (-gap).max(0.0)
        });
    }
    let area = state.plastic.map_or(0.0, |plastic| plastic.area);
    ledger.must((area / cell - saturated as f64).abs() < 0.5, || {
        format!("{saturated} saturated cells, {area}")
    });
    Ok(())
}

/// Solves a map for forces, given as shares of the largest force that all cells carry.
fn pressed(ledger: &mut Ledger, map: &HeightMap, hardness: f64, shares: &[f64]) -> Result<Vec<ContactState>> {
    let mut scene = watched(map);
    scene.outputs.stiffness = false;
    scene.effects.hardness = Hardness::Limit { pressure: hardness };
    let capacity = hardness * map.size().x * map.size().y;
    let mut contact = tight().prepare(&scene, 0)?;
    let mut states = Vec::new();
    for share in shares {
        let state = contact.solve(Load::force(share * capacity))?;
        conditions(ledger, map, hardness, &state)?;
        states.push(state);
    }
    for beyond in [1.0, 1.5] {
        let refused = contact.solve(Load::force(beyond * capacity));
        let told = |max: f64| (max / capacity - 1.0).abs() < 1e-12;
        ledger.must(matches!(&refused, Err(Error::OutOfRange { max, .. }) if told(*max)), || {
            format!("a force of {beyond} of all cells is not refused: {}", refused.is_ok())
        });
    }
    Ok(states)
}

fn flat(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(32, 96);
    let map = map(cells, 1.0, |_, _| 0.0)?;
    let states = pressed(ledger, &map, 0.3, &[0.1, 0.5, 0.9, 0.99, 0.9999])?;
    for state in &states {
        ledger.contact_cells(state, cells * cells);
    }
    Ok(())
}

fn maps(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(24, 64);
    let noise: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.618_033_988_75).fract()).collect();
    for kind in 0..7 {
        let map = hard_map(kind, cells, &noise)?;
        for hardness in [30.0, 1.0, 0.03, 1e-4] {
            pressed(ledger, &map, hardness, &[1e-3, 0.03, 0.3, 0.7, 0.97])?;
        }
    }
    Ok(())
}

fn two_scales(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(48, 128);
    let fine = rough_map(2.6, cells, 4)?;
    let round = |i: usize| (i as f64 + 0.5) / cells as f64 - 0.5;
    let map = map(cells, 1.0, |x, y| {
        0.003 * fine.heights()[y * cells + x] - 0.5 * (round(x).powi(2) + round(y).powi(2))
    })?;
    for hardness in [0.5, 0.1, 0.02] {
        let shares = [1e-3, 0.01, 0.1, 0.5, 0.9];
        let states = pressed(ledger, &map, hardness, &shares)?;
        let mut last = 0.0;
        for (state, share) in states.iter().zip(shares) {
            let area = state.area.unwrap_or(f64::NAN);
            ledger.must(area >= last && area >= share * (1.0 - 1e-9), || format!("area {area} at {share}"));
            last = area;
        }
    }
    Ok(())
}

fn full(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(64, 128);
    let rough = rough_map(2.2, cells, 9)?;
    let slope = surface_gen::rms_slope_differences(&rough);
    pressed(ledger, &rough.scaled(1.0, 0.08 / slope)?, 0.1, &[1e-3, 0.01, 0.1, 0.3, 0.6, 0.9, 0.99, 0.999])?;
    Ok(())
}

fn sheared(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(6, 9);
    let noise: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.618_033_988_75).fract()).collect();
    let (pair, coulomb) = (alike(0.3), FrictionLaw::coulomb(MU));
    // Terraces, and heights over twenty decades.
    for map in [rough_map(2.4, cells, 4)?, hard_map(1, cells, &noise)?, hard_map(6, cells, &noise)?] {
        let gaps = map.heights().iter().map(|h| map.highest() - h).collect();
        let (normal, shear) = (PlainSum::of(&map), PlainShear::of(&map, compliance(&pair)?));
        let surface =
            DenseSurface { normal: &normal, shift: 0.0, shear: &shear, gaps, area: map.dx() * map.dy() };
        for (hardness, law) in [
            (1.0, coulomb),
            (0.03, coulomb),
            (0.03, FrictionLaw { shear_strength: 0.01, limit: Some(0.015), ..coulomb }),
        ] {
            let mut scene = rubbed(&map, pair, MU);
            scene.effects.friction = Friction::of(law);
            scene.effects.hardness = Hardness::Limit { pressure: hardness };
            scene.outputs.plastic_depth = true;
            let exact = DensePath::new(surface.clone(), law, Some(hardness));
            sheared_path(ledger, &scene, exact, hardness)?;
        }
    }
    Ok(())
}

/// Follows a path of normal and tangential forces beside dense matrices.
fn sheared_path(ledger: &mut Ledger, scene: &Scene, mut exact: DensePath, hardness: f64) -> Result<()> {
    let mut contact = Bem3d { tolerance: 1e-12, ..tight() }.prepare(scene, 0)?;
    let (area, count) = (exact.cell_area(), exact.pressed.len() as f64);
    // Shares of the force of all cells, and of the sliding force along x and y.
    let path =
        [(0.5, [0.0, 0.0]), (0.9, [0.6, 0.3]), (0.99, [-0.5, 0.4]), (0.3, [0.2, 0.1]), (0.95, [0.0, -0.8])];
    for (share, [x, y]) in path {
        let force = share * hardness * area * count;
        exact.press(Prescribed::Force(force));
        let most: f64 = exact.limits().iter().sum();
        let asked = [x * most, y * most];
        exact.slide(Prescribed::Force(asked));
        let load = Load::force(force).with_tangential(Tangential::Force(asked));
        let state = contact.advance(Step::new(0.0, load))?;
        beside_dense(ledger, &state, &exact)?;
    }
    Ok(())
}

/// Compares pressures, tractions, displacement, dissipated energy and indentation with those of dense matrices.
fn beside_dense(ledger: &mut Ledger, state: &ContactState, exact: &DensePath) -> Result<()> {
    let (area, limits) = (exact.cell_area(), exact.limits());
    let most: f64 = limits.iter().sum();
    let found = tangential(state)?;
    let p: Vec<f64> = pressure(state)?.iter().map(|p| p * area).collect();
    ledger.field(&p, &exact.pressed, largest(&exact.pressed));
    // A hundredth of the deviation of the tractions: the square root of that of the energy.
    let hundredth = |q: [f64; 2]| q.map(|q| 0.01 * q);
    let q: Vec<[f64; 2]> =
        vectors(state, VectorField::Traction)?.iter().map(|q| hundredth(q.map(|q| q * area))).collect();
    let n = limits.len();
    let expected: Vec<[f64; 2]> =
        (0..n).map(|i| hundredth([exact.sheared[i], exact.sheared[n + i]])).collect();
    compare(ledger, &q, &expected, largest(&limits));
    let moved = exact.displacement[0].hypot(exact.displacement[1]).max(most);
    compare(ledger, &[hundredth(found.displacement)], &[hundredth(exact.displacement)], moved);
    ledger.enter((found.dissipated - exact.dissipated).abs() / (moved * most));
    let depth = state.fields.as_ref().and_then(|fields| fields.plastic_depth.as_ref());
    let depth = depth.map_or(&[][..], |depth| depth.values());
    ledger.field(depth, &exact.indentation, largest(&exact.indentation).max(exact.approach));
    Ok(())
}
