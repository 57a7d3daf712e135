//! Nondimensionalisation, and a caller's choice of units and of the zero of heights.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, stiffness};
use crate::stability::maps::{map, rough_map};
use crate::stability::press::{tight, watched};
use contact_model::{ContactModel, ContactState, Error, HeightMap, Load, Result};

/// A few roundings from the conversion into the solver's units and back, times their amplification in a
/// solve.
const NEUTRAL: f64 = 1e-11;

pub(super) const CASES: [HardCase; 5] = [
    HardCase {
        name: "heights moved by 2^20 and -2^40",
        why: "d - h from raw heights loses every digit; z = h_max - h loses none",
        asserted: "heights in steps of rms/4096 moved by 2^20 and -2^40: F, d, k and p bit for bit",
        bound: 0.0,
        solve: moved,
    },
    HardCase {
        name: "heights times powers of two",
        why: "2^500 and 2^-500: squares of heights overflow or vanish",
        asserted: "F, d, k and p bit for bit after division",
        bound: 0.0,
        solve: powers_of_two,
    },
    HardCase {
        name: "heights of 1e-150 and 1e150",
        why: "forces of 1e-150, products of heights beyond f64",
        asserted: "F, d, k of the same map in ordinary nondimensional, divided",
        bound: NEUTRAL,
        solve: |ledger, effort| neutral(ledger, effort, &[(1.0, 1.0, 1e-150), (1.0, 1.0, 1e150)]),
    },
    HardCase {
        name: "E* and L of 1e-12 and 1e12",
        why: "stiffness and force differ by forty decades between scenes",
        asserted: "F, d, k of the same map with E* = L = 1, divided",
        bound: NEUTRAL,
        solve: |ledger, effort| {
            let all = [(1e-12, 1e-12, 1.0), (1e-12, 1e12, 1.0), (1e12, 1e-12, 1.0), (1e12, 1e12, 1e-9)];
            neutral(ledger, effort, &all)
        },
    },
    HardCase {
        name: "outputs beyond f64",
        why: "the solve in scaled units is sound, but force or stiffness has no number",
        asserted: "an error with the quantity (Domain), neither infinity nor 0; what can be held is returned (wrong answers)",
        bound: 0.0,
        solve: beyond,
    },
];

fn solve(map: &HeightMap, contact_modulus: f64, load: Load) -> Result<ContactState> {
    let mut scene = watched(map);
    scene.contact_modulus = contact_modulus;
    tight().prepare(&scene, 0)?.solve(load)
}

fn moved(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 129);
    let drawn = rough_map(2.4, cells, 9)?;
    let shifted = |offset: f64| {
        map(cells, 1.0, |x, y| (drawn.heights()[y * cells + x] * 4096.0).round() / 4096.0 + offset)
    };
    let here = shifted(0.0)?;
    for offset in [1_048_576.0, -1_099_511_627_776.0] {
        let there = shifted(offset)?;
        for load in [Load::force(1e-9), Load::force(0.3), Load::force(20.0), Load::approach(1.0)] {
            let (a, b) = (solve(&here, 1.0, load)?, solve(&there, 1.0, load)?);
            ledger.same_bits("moved", &a, &b);
        }
    }
    Ok(())
}

/// With cells of 2^-5 or 2^-7 the units contain only one number that is not a power of two, so that every
/// product is rounded once.
fn powers_of_two(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let here = rough_map(2.4, effort.pick(32, 128), 9)?;
    for exponent in [-500, 500] {
        let factor = 2_f64.powi(exponent);
        let there = here.scaled(1.0, factor)?;
        for size in [1e-6, 0.3, 20.0] {
            for (here_load, there_load) in [
                (Load::force(size), Load::force(size * factor)),
                (Load::approach(size), Load::approach(size * factor)),
            ] {
                let (a, b) = (solve(&here, 1.0, here_load)?, solve(&there, 1.0, there_load)?);
                ledger.same_bits("in other units", &a, &divided(b, factor, factor, 1.0, factor));
            }
        }
    }
    Ok(())
}

fn neutral(ledger: &mut Ledger, effort: Effort, normalisation: &[(f64, f64, f64)]) -> Result<()> {
    let here = rough_map(2.4, effort.pick(33, 129), 5)?;
    for &(contact_modulus, lateral, vertical) in normalisation {
        let there = here.scaled(lateral, vertical)?;
        for size in [1e-6, 0.1, 20.0] {
            let force = contact_modulus * lateral * vertical;
            for (here_load, there_load) in [
                (Load::force(size), Load::force(size * force)),
                (Load::approach(size), Load::approach(size * vertical)),
            ] {
                let a = solve(&here, 1.0, here_load)?;
                let b = solve(&there, contact_modulus, there_load)?;
                ledger.meets(&b, tight().tolerance);
                let b = divided(
                    b,
                    force,
                    vertical,
                    contact_modulus * lateral,
                    contact_modulus * vertical / lateral,
                );
                ledger.same(
                    &format!("{here_load:?} in units of {contact_modulus:e}, {lateral:e}, {vertical:e}"),
                    &b,
                    &a,
                )?;
            }
        }
    }
    Ok(())
}

fn divided(mut state: ContactState, force: f64, height: f64, stiffness: f64, pressure: f64) -> ContactState {
    state.force /= force;
    state.approach = state.approach.map(|d| d / height);
    state.stiffness = state.stiffness.map(|k| k / stiffness);
    if let Some(p) = state.fields.as_mut().and_then(|f| f.pressure.as_mut()) {
        for p in p.values_mut() {
            *p /= pressure;
        }
    }
    state
}

fn beyond(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let map = rough_map(2.4, 17, 5)?;
    // (E*, lateral, vertical): a force of 1e450, of 1e-450; a stiffness of 1e320.
    for (contact_modulus, lateral, vertical) in
        [(1e150, 1e150, 1e150), (1e-150, 1e-150, 1e-150), (1e160, 1e160, 1e-160), (1e300, 1e20, 1.0)]
    {
        let there = map.scaled(lateral, vertical)?;
        let found = solve(&there, contact_modulus, Load::approach(vertical));
        let honest = match &found {
            Err(Error::Domain { value, .. }) => !value.is_finite() || value.abs() <= 0.0,
            _ => false,
        };
        ledger.must(honest, || format!("{contact_modulus:e} {lateral:e} {vertical:e}: {found:?}"));
        ledger.count(usize::from(!honest));
    }
    // The force alone is beyond f64 where the stiffness is not asked for; d and k of a light one are fine.
    let there = map.scaled(1e100, 1e100)?;
    let state = solve(&there, 1e100, Load::force(1e295))?;
    let here = solve(&map, 1.0, Load::force(1e-5))?;
    let same = (approach(&state)? / 1e100 / approach(&here)? - 1.0).abs() < NEUTRAL
        && (stiffness(&state)? / 1e200 / stiffness(&here)? - 1.0).abs() < NEUTRAL;
    ledger.must(same, || "a light load in units of 1e100".to_owned());
    ledger.count(usize::from(!same));
    Ok(())
}
