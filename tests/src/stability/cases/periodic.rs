//! Periodic boundaries.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, largest, mean_gap, pressure, stiffness};
use crate::stability::maps::{map, rough_map};
use crate::stability::press::{tight, watched_periodic};
use contact_model::{ContactModel, HeightMap, Load, PreparedContact, Result};

pub(super) const CASES: [HardCase; 2] = [
    HardCase {
        name: "a periodic square from any origin",
        why: "a contact cut by the edge of the array is one contact: windows, boxes and neighbours must wrap around",
        asserted: "p, k and the mean gap of the same square rolled by any number of cells (of the largest p, of k, of rms heights)",
        bound: 1e-8,
        solve: any_origin,
    },
    HardCase {
        name: "a periodic square in full contact",
        why: "the kernel has no constant: k is infinite, and nothing but the force fixes the mean pressure",
        asserted: "no k claimed, mean gap 0; between two loads p changes by dF/A at every cell (of the largest p)",
        bound: 1e-9,
        solve: full,
    },
];

fn prepare(map: &HeightMap) -> Result<Box<dyn PreparedContact>> {
    let mut scene = watched_periodic(map);
    scene.outputs.mean_gap = true;
    tight().prepare(&scene, 0)
}

fn any_origin(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    for (cells, fractal_dimension) in [(32, 2.0), (33, 2.7), effort.pick((16, 2.4), (128, 2.4))] {
        let here = rough_map(fractal_dimension, cells, 12)?;
        let rolled = |of: &[f64], dx: usize, dy: usize| {
            map(cells, 1.0, |x, y| of[(y + dy) % cells * cells + (x + dx) % cells])
        };
        let mut contact = prepare(&here)?;
        for force in [1e-4, 0.03, 0.3, 1.5] {
            let state = contact.solve(Load::force(force))?;
            ledger.meets(&state, tight().tolerance);
            let gap = mean_gap(&state)?;
            let largest = largest(pressure(&state)?);
            for (dx, dy) in [(1, 0), (7, 13), (cells / 2, cells / 2)] {
                let mut other = prepare(&rolled(here.heights(), dx, dy)?)?;
                let there = other.solve(Load::force(force))?;
                ledger.near("k", stiffness(&there)?, stiffness(&state)?);
                ledger.enter((mean_gap(&there)? - gap).abs());
                let expected = rolled(pressure(&state)?, dx, dy)?;
                ledger.field(pressure(&there)?, expected.heights(), largest);
            }
        }
    }
    Ok(())
}

fn full(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    for (cells, fractal_dimension) in [(32, 2.0), effort.pick((33, 2.8), (129, 2.8))] {
        let map = rough_map(fractal_dimension, cells, 12)?;
        let mut contact = prepare(&map)?;
        let [light, heavy] = [3e3, 5e3];
        let mut press = |force: f64| -> Result<Vec<f64>> {
            let state = contact.solve(Load::force(force))?;
            ledger.meets(&state, tight().tolerance);
            ledger.contact_cells(&state, cells * cells);
            ledger.must(state.stiffness.is_none(), || format!("k {:?} in full contact", state.stiffness));
            ledger.enter(mean_gap(&state)?);
            Ok(pressure(&state)?.to_vec())
        };
        let (one, other) = (press(light)?, press(heavy)?);
        let largest = largest(&other);
        for (a, b) in one.iter().zip(&other) {
            ledger.enter((b - a - (heavy - light)).abs() / largest);
        }
    }
    Ok(())
}
