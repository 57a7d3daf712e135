//! Rectangular maps, rectangular cells and undefined points.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, largest, pressure, stiffness};
use crate::stability::plain::{PlainSum, relaxed_by};
use crate::stability::press::{against_relaxation, press, press_both, tight, watched_periodic};
use bem3d::love::influence;
use contact_model::{ContactModel, HeightMap, Load, Result};
use std::f64::consts::PI;

pub(super) const CASES: [HardCase; 8] = [
    HardCase {
        name: "a row of cells",
        why: "one row: transforms of length 1 or 2, coarse grids with one row, windows without height",
        asserted: "contact set by relaxation; force and k beside it; the column of the same cells gives the same",
        bound: 1e-9,
        solve: row,
    },
    HardCase {
        name: "a periodic row of cells",
        why: "the period across is one cell: its own images are nearer than its neighbours",
        asserted: "pressures beside relaxation with sums over images (of the largest), for the row and the column",
        bound: 1e-8,
        solve: periodic_row,
    },
    HardCase {
        name: "cells a hundred times as long as wide",
        why: "the kernel loses digits, its far field begins late, the periodic symbol is no smooth function of the wave",
        asserted: "force and k beside relaxation; a turned map gives the same k",
        bound: 1e-8,
        solve: oblong_cells,
    },
    HardCase {
        name: "a map a hundred times as long as wide",
        why: "coarse grids run out of rows long before columns; a square window would be a hundred times too large",
        asserted: "k of the map and of the turned map; the witness of every state",
        bound: 1e-8,
        solve: long_map,
    },
    HardCase {
        name: "a frame of undefined points",
        why: "instruments lose the edges; an infinite gap must not become a mean, a coarse height or a NaN",
        asserted: "F, d and k of the map without the frame",
        bound: 1e-9,
        solve: frame,
    },
    HardCase {
        name: "a checkerboard of undefined points",
        why: "every neighbour of a cell is missing: coarse cells average two of four, no row has two cells side by side",
        asserted: "flat: k of the checkerboard by elimination; rough: contact set, force and k beside relaxation",
        bound: 1e-9,
        solve: checkerboard,
    },
    HardCase {
        name: "all points undefined but one",
        why: "no rms height, no range of heights, one cell wherever it lies",
        asserted: "k and d of one cell alone, by force and by approach, free and periodic",
        bound: 1e-12,
        solve: one_point,
    },
    HardCase {
        name: "periodic squares of odd, prime and 7-smooth sides",
        why: "a transform of another length than the period sees other images; most lengths have no fast transform",
        asserted: "every load from first to full contact converges; pressures beside relaxation with sums over images",
        bound: 1e-8,
        solve: any_size,
    },
];

/// Two waves and a little noise of the seed.
fn waves(cells: [usize; 2], size: [f64; 2], seed: usize) -> Result<HeightMap> {
    let turn = |i: usize, n: usize| 2.0 * PI * (i as f64 + 0.5) / n as f64;
    let heights = (0..cells[0] * cells[1]).map(|i| {
        let (x, y) = (i % cells[0], i / cells[0]);
        let noise = ((x * 131 + y * 313 + seed) as f64).sin();
        turn(x, cells[0]).cos() + 0.6 * turn(y, cells[1]).sin() + 0.1 * noise
    });
    HeightMap::new(cells, size, heights.collect())
}

/// A periodic state under the force that relaxation finds at an approach.
fn against_images(ledger: &mut Ledger, map: &HeightMap, approaches: &[f64]) -> Result<()> {
    let sum = PlainSum::periodic(map);
    let mut contact = tight().prepare(&watched_periodic(map), 0)?;
    let cell = map.dx() * map.dy();
    for &d in approaches {
        let slow = relaxed_by(&sum, map, d);
        let state = contact.solve(Load::force(slow.force))?;
        ledger.meets(&state, tight().tolerance);
        let mut expected = vec![0.0; map.heights().len()];
        for (&i, force) in slow.contact.iter().zip(&slow.forces) {
            expected[i] = force / cell;
        }
        ledger.field(pressure(&state)?, &expected, largest(&expected));
    }
    Ok(())
}

fn row(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(60, 200);
    let row = waves([n, 1], [n as f64, 1.0], 1)?;
    let column = row.transposed();
    for d in [0.05, 0.4, 3.0] {
        against_relaxation(ledger, &row, d)?;
        against_relaxation(ledger, &column, d)?;
        let [a, b] = [&row, &column].map(|map| press(ledger, map, Load::approach(d)));
        ledger.near("k of the column", stiffness(&b?)?, stiffness(&a?)?);
    }
    Ok(())
}

fn periodic_row(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    for n in [7, 16, effort.pick(31, 61)] {
        let row = waves([n, 1], [n as f64, 1.0], 2)?;
        against_images(ledger, &row, &[0.1, 0.8, 20.0])?;
        against_images(ledger, &row.transposed(), &[0.1, 0.8, 20.0])?;
    }
    Ok(())
}

fn oblong_cells(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(12, 20);
    let map = waves([n, n], [100.0, 1.0], 3)?;
    for d in [0.2, 1.0, 3.0] {
        against_relaxation(ledger, &map, d)?;
        let k = stiffness(&press_both(ledger, &map, Load::approach(d))?)?;
        let turned = stiffness(&press(ledger, &map.transposed(), Load::approach(d))?)?;
        ledger.near("k of the turned map", turned, k);
    }
    Ok(())
}

fn long_map(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let rows = effort.pick(8, 24);
    let map = waves([100 * rows, rows], [100.0, 1.0], 4)?;
    for force in [1e-3, 1.0, 50.0] {
        let one = press(ledger, &map, Load::force(force))?;
        let turned = press(ledger, &map.transposed(), Load::force(force))?;
        ledger.near("k of the turned map", stiffness(&turned)?, stiffness(&one)?);
        ledger.must(one.report.contact_cells == turned.report.contact_cells, || {
            format!("contact cells {:?} and {:?}", one.report.contact_cells, turned.report.contact_cells)
        });
    }
    Ok(())
}

fn frame(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(20, 60);
    let inner = waves([n, n - 6], [1.0, 0.7], 5)?;
    let (columns, rows, width) = (n + 10, n + 4, 5);
    let heights = (0..columns * rows).map(|i| {
        let (x, y) = ((i % columns).wrapping_sub(width), (i / columns).wrapping_sub(width));
        if x < n && y < n - 6 { inner.heights()[y * n + x] } else { f64::NAN }
    });
    let size = [inner.dx() * columns as f64, inner.dy() * rows as f64];
    let framed = HeightMap::with_undefined([columns, rows], size, heights.collect())?;
    for load in [Load::force(1e-3), Load::force(0.3), Load::approach(0.5), Load::force(30.0)] {
        let (one, other) = (press_both(ledger, &inner, load)?, press_both(ledger, &framed, load)?);
        ledger.near("k", stiffness(&other)?, stiffness(&one)?);
        ledger.near("force", other.force, one.force);
        ledger.near("approach", approach(&other)?, approach(&one)?);
    }
    Ok(())
}

fn checkerboard(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(14, 20);
    let masked = |h: &dyn Fn(usize) -> f64| {
        let heights =
            (0..n * n).map(|i: usize| if (i % n + i / n).is_multiple_of(2) { h(i) } else { f64::NAN });
        HeightMap::with_undefined(n, 1.0, heights.collect())
    };
    let flat = masked(&|_| 0.0)?;
    let black: Vec<usize> = (0..n * n).filter(|i| (i % n + i / n).is_multiple_of(2)).collect();
    let state = press_both(ledger, &flat, Load::approach(1.0))?;
    ledger.near("k of a flat board", stiffness(&state)?, PlainSum::of(&flat).stiffness(&black));
    let waves = waves([n, n], [1.0, 1.0], 6)?;
    let rough = masked(&|i| waves.heights()[i])?;
    for d in [0.2, 1.0, 4.0] {
        against_relaxation(ledger, &rough, d)?;
    }
    Ok(())
}

fn one_point(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let k = PI / influence(0, 0) / 5.0;
    for at in [0, 7, 12, 24] {
        let heights = (0..25).map(|i| if i == at { 0.3 } else { f64::NAN });
        let map = HeightMap::with_undefined(5, 1.0, heights.collect())?;
        let state = press_both(ledger, &map, Load::force(2.0))?;
        ledger.near("k of one cell", stiffness(&state)?, k);
        ledger.near("approach of one cell", approach(&state)?, 2.0 / k);
        let state = press_both(ledger, &map, Load::approach(0.1))?;
        ledger.near("force of one cell", state.force, 0.1 * k);
        let state = tight().prepare(&watched_periodic(&map), 0)?.solve(Load::force(2.0))?;
        ledger.contact_cells(&state, 1);
        ledger.enter((pressure(&state)?[at] / 50.0 - 1.0).abs());
    }
    Ok(())
}

fn any_size(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    for n in [1, 13, 14, 15, 17, effort.pick(21, 33)] {
        against_images(ledger, &waves([n, n], [1.0, 1.0], n)?, &[0.05, 0.6, 2.0, 40.0])?;
    }
    let largest = effort.pick(97, 513);
    for n in [63, 65, 70, 97, largest] {
        let map = crate::stability::maps::rough_map(2.2, n, 3)?;
        let mut contact = tight().prepare(&watched_periodic(&map), 0)?;
        for force in [1e-4, 0.01, 0.3, 1.0, 3.0, 10.0, 100.0, 1e4] {
            let state = contact.solve(Load::force(force))?;
            ledger.meets(&state, tight().tolerance);
        }
    }
    Ok(())
}
