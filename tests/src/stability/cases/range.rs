//! Loads from first touch to far beyond full contact.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, largest, pressure, stiffness};
use crate::stability::maps::{map, rough_map};
use crate::stability::press::{SAME, press, press_again, press_both, stop_after, tight, watched};
use contact_model::{ContactModel, ContactState, HeightMap, Load, Result};

pub(super) const CASES: [HardCase; 5] = [
    HardCase {
        name: "1 to 99.99 % contact",
        why: "restarted iterations stall between 50 and 95 %; near 100 % a few holes decide",
        asserted: "k_i dd <= dF <= k_(i+1) dd between neighbours: F is convex with slope k, which never falls (excess over F)",
        bound: 1e-8,
        solve: fractions,
    },
    HardCase {
        name: "full contact",
        why: "every cell in contact: no gap left to steer by; pressures of both signs if it came too early",
        asserted: "between two loads p changes by dF q/k, the pressure of the flat square, at every cell; k of the square",
        bound: 1e-8,
        solve: full,
    },
    HardCase {
        name: "F_bar from 1e-12 to 1e4, up and down",
        why: "sixteen decades with one memory: a state remembered from far away misleads",
        asserted: "loading and unloading give the d and k of a fresh solve",
        bound: SAME,
        solve: sweep,
    },
    HardCase {
        name: "loads a million times the relief",
        why: "gaps left are a millionth of the approach, less than single precision sees",
        asserted: "full contact with its k; d - F/k is the load-free constant sum q z/k of the same surface",
        bound: 1e-4,
        solve: far_beyond,
    },
    HardCase {
        name: "misleading warm starts",
        why: "after a singleton, a full contact, or a solve that was stopped, the guess is wrong in every cell",
        asserted: "d and k of a fresh solve, whatever was solved before",
        bound: SAME,
        solve: warm,
    },
];

fn fractions(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    // 101 x 101: with one cell open 99.990 % are in contact; 129 x 129: 99.994 %.
    let cells = effort.pick(101, 129);
    let all = cells * cells;
    let count = |state: &ContactState| state.report.contact_cells.unwrap_or(0);
    for fractal_dimension in [2.0, 2.6] {
        let map = rough_map(fractal_dimension, cells, 2)?;
        let mut contact = tight().prepare(&watched(&map), 0)?;
        let mut high = 1.0;
        while count(&contact.solve(Load::approach(high))?) < all {
            high *= 2.0;
        }
        // The approach of a number of cells, by bisection: the number never falls.
        let wanted: Vec<usize> = [0.01, 0.1, 0.5, 0.9, 0.99]
            .iter()
            .map(|f| (f * all as f64) as usize)
            .chain([all - 1, all])
            .collect();
        let mut points: Vec<(f64, f64, f64)> = Vec::new();
        for &cells_wanted in &wanted {
            let near = if cells_wanted < all - 1 { all / 200 } else { 0 };
            let (mut low, mut above) = (0.0, high);
            let mut found = contact.solve(Load::approach(high))?;
            for _ in 0..40 {
                if count(&found).abs_diff(cells_wanted) <= near {
                    break;
                }
                let middle = f64::midpoint(low, above);
                found = contact.solve(Load::approach(middle))?;
                if count(&found) < cells_wanted { low = middle } else { above = middle }
            }
            ledger.must(count(&found).abs_diff(cells_wanted) <= near, || {
                format!("D_f {fractal_dimension}: {} cells where {cells_wanted} were wanted", count(&found))
            });
            let load = Load::approach(approach(&found)?);
            let state = press(ledger, &map, load)?;
            ledger.must(count(&state) == count(&found), || format!("{load:?}: {} cells", count(&state)));
            points.push((approach(&state)?, state.force, stiffness(&state)?));
        }
        for pair in points.windows(2) {
            let [(d0, f0, k0), (d1, f1, k1)] = [pair[0], pair[1]];
            let (step, rise) = (d1 - d0, f1 - f0);
            ledger.enter((k0 * step - rise).max(rise - k1 * step).max(0.0) / f1);
            ledger.must(k1 >= k0, || format!("k falls from {k0} to {k1}"));
        }
    }
    Ok(())
}

fn full(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 129);
    let flat = press(ledger, &map(cells, 1.0, |_, _| 0.0)?, Load::force(1.0))?;
    let punch = pressure(&flat)?.to_vec();
    for fractal_dimension in [2.0, 3.0] {
        let map = rough_map(fractal_dimension, cells, 6)?;
        // Roughest: h_c/h waves of the grid need about 1e3 E* h/L.
        let (light, heavy) = (4e3, 5e3);
        let one = press(ledger, &map, Load::force(light))?;
        let other = press(ledger, &map, Load::force(heavy))?;
        for state in [&one, &other] {
            ledger.contact(state, cells * cells, stiffness(&flat)?)?;
        }
        let largest = largest(&punch) * heavy;
        for ((a, b), q) in pressure(&one)?.iter().zip(pressure(&other)?).zip(&punch) {
            ledger.enter((b - a - (heavy - light) * q).abs() / largest);
        }
    }
    Ok(())
}

fn sweep(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 65);
    for fractal_dimension in [2.0, 2.7] {
        let map = rough_map(fractal_dimension, cells, 5)?;
        let mut contact = tight().prepare(&watched(&map), 0)?;
        let forces: Vec<f64> = (-12..=4).map(|e| 10_f64.powi(e)).collect();
        let mut solve = |ledger: &mut Ledger, force: f64| {
            press_again(ledger, &mut *contact, tight().tolerance, &map, Load::force(force))
        };
        let mut up = Vec::new();
        for &force in &forces {
            up.push(solve(ledger, force)?);
        }
        for (up, &force) in up.iter().zip(&forces).rev() {
            let down = solve(ledger, force)?;
            let alone = press(ledger, &map, Load::force(force))?;
            ledger.same("loading beside a fresh solve", up, &alone)?;
            ledger.same("unloading beside a fresh solve", &down, &alone)?;
        }
    }
    Ok(())
}

fn far_beyond(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 129);
    for fractal_dimension in [2.0, 2.8] {
        let map = rough_map(fractal_dimension, cells, 3)?;
        let square =
            stiffness(&press(ledger, &crate::stability::map(cells, 1.0, |_, _| 0.0)?, Load::force(1.0))?)?;
        // F/k at d and at its constant: by a load that only just fills the square.
        let near = press(ledger, &map, Load::force(3e3))?;
        let constant = approach(&near)? - 3e3 / square;
        for force in [1e5, 1e6] {
            let model = bem3d::Bem3d { tolerance: 1e-4, ..tight() };
            let state = model.prepare(&watched(&map), 0)?.solve(Load::force(force))?;
            ledger.contact(&state, cells * cells, square)?;
            // In rms heights: the approach itself is a million of them, and its last digit 1e-10.
            let excess = approach(&state)? - force / square - constant;
            ledger.must(excess.abs() < 1e-3, || format!("F {force}: d is off by {excess} rms heights"));
        }
    }
    Ok(())
}

fn warm(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 65);
    let maps: [HeightMap; 3] = [
        rough_map(2.3, cells, 9)?,
        rough_map(3.0, cells, 9)?,
        // Two plains with a step: what touches at light loads is the wrong half for the guess at heavy ones.
        map(cells, 1.0, |x, y| {
            if x < cells / 2 {
                0.01 * ((x * y) as f64).sin()
            } else {
                -1.0 + 0.5 * ((3 * x + y) as f64).cos()
            }
        })?,
    ];
    for map in &maps {
        let mut contact = tight().prepare(&watched(map), 0)?;
        let [light, middle, heavy] = [1e-10, 0.3, 3e3].map(Load::force);
        let fresh = |ledger: &mut Ledger, load| press_both(ledger, map, load);
        let exact = [fresh(ledger, light)?, fresh(ledger, middle)?, fresh(ledger, heavy)?];
        for (before, load, exact) in [
            (light, middle, &exact[1]),
            (light, heavy, &exact[2]),
            (heavy, middle, &exact[1]),
            (middle, light, &exact[0]),
            (heavy, light, &exact[0]),
        ] {
            contact.solve(before)?;
            let state = press_again(ledger, &mut *contact, tight().tolerance, map, load)?;
            ledger.same("after another load", &state, exact)?;
            // Stopped at the first question, and after a few.
            for patience in [0, 3, 40] {
                let _ = contact.solve_until(before, &stop_after(patience));
                let state = press_again(ledger, &mut *contact, tight().tolerance, map, load)?;
                ledger.same("after a stopped solve", &state, exact)?;
            }
        }
    }
    Ok(())
}
