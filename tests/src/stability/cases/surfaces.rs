//! The ends of the family of self-affine surfaces.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, stiffness};
use crate::stability::maps::{rough_map, scene};
use crate::stability::press::{against_relaxation, press, tight};
use contact_model::{Amplitude, ContactModel, Load, Result, SelfAffine, Surface};

pub(super) const CASES: [HardCase; 3] = [
    HardCase {
        name: "D_f = 3 exactly",
        why: "H = 0, a logarithmic spectrum: contact spots of one to three cells all over the grid",
        asserted: "contact set exactly, F and k by relaxation and elimination",
        bound: 1e-8,
        solve: |ledger, effort| ends(ledger, effort, 3.0),
    },
    HardCase {
        name: "D_f = 2 exactly",
        why: "H = 1: few large spots, and full contact within reach",
        asserted: "contact set exactly, F and k by relaxation and elimination",
        bound: 1e-8,
        solve: |ledger, effort| ends(ledger, effort, 2.0),
    },
    HardCase {
        name: "H just above 0 and just below 1",
        why: "exponents 2(H + 1) next to their ends: a special case for the end itself would jump",
        asserted: "d and k change by less than 1e-9 where H changes by 1e-13",
        bound: 1e-9,
        solve: beside_the_ends,
    },
];

fn ends(ledger: &mut Ledger, effort: Effort, fractal_dimension: f64) -> Result<()> {
    let cells = effort.pick(33, 49);
    for seed in 0..effort.pick(2, 6) {
        let map = rough_map(fractal_dimension, cells, seed)?;
        for d in [1e-6, 0.2, 1.0, 2.5, 6.0, 30.0] {
            against_relaxation(ledger, &map, d)?;
        }
    }
    let map = rough_map(fractal_dimension, effort.pick(65, 129), 7)?;
    for force in [1e-9, 1e-4, 0.086, 1.0, 20.0] {
        press(ledger, &map, Load::force(force))?;
    }
    Ok(())
}

fn beside_the_ends(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 65);
    let surface = |hurst: f64| {
        let amplitude = Amplitude::RmsHeight(1.0);
        let surface = SelfAffine { size: 1.0.into(), hurst, amplitude, roll_off: None, short_cutoff: None };
        surface_gen::self_affine_map(&surface, cells, 3)
    };
    for (end, beside) in [(0.0, 1e-13), (1.0, 1.0 - 1e-13)] {
        let (end, beside) = (surface(end)?, surface(beside)?);
        for force in [1e-3, 0.1, 1.0, 20.0] {
            let a = press(ledger, &end, Load::force(force))?;
            let b = press(ledger, &beside, Load::force(force))?;
            ledger.near("d", approach(&b)?, approach(&a)?);
            ledger.near("k", stiffness(&b)?, stiffness(&a)?);
        }
    }
    for outside in [-1e-300, 1.0 + f64::EPSILON, f64::NAN] {
        let amplitude = Amplitude::RmsHeight(1.0);
        let surface =
            SelfAffine { size: 1.0.into(), hurst: outside, amplitude, roll_off: None, short_cutoff: None };
        let mut refused = scene(crate::stability::map(1, 1.0, |_, _| 0.0)?);
        refused.surface = Surface::SelfAffine(surface);
        let refused = tight().prepare(&refused, 0);
        ledger.must(matches!(refused, Err(contact_model::Error::Domain { .. })), || format!("H = {outside}"));
    }
    Ok(())
}
