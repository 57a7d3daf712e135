//! Tolerances and iteration limits that cannot be met, and the accuracy of transforms and sums.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, stiffness};
use crate::stability::maps::{map, rough_map};
use crate::stability::plain::PlainSum;
use crate::stability::press::{
    SAME, contact_set, forces, press, press_both, press_by, stop_after, tight, watched,
};
use bem3d::love::influence;
use bem3d::{Bem3d, Method};
use contact_model::{ContactModel, Error, Field, Line, Load, Result, Scene, Status, Surface};
use mdr1d::Mdr1d;
use numerics::gauss::Gauss;
use std::sync::Arc;

/// The tolerance of figures is tighter by ten.
const LOOSE: f64 = 1e-3;

pub(super) const CASES: [HardCase; 9] = [
    HardCase {
        name: "primes, powers of two and one more",
        why: "transforms of every factorisation; a circular length one too short wraps around",
        asserted: "displacement of every cell beside the plain sum over pairs; k of full contact by its formula in 1/N",
        bound: 1e-12,
        solve: sizes,
    },
    HardCase {
        name: "far field to 1e6 cells",
        why: "Love's closed form is a second difference: at distance r it loses r^2 of its digits",
        asserted: "the kernel beside Gauss-Legendre quadrature of 1/r over the cell, and 40-digit values",
        bound: 5e-12,
        solve: |ledger, effort| {
            far_field(ledger, effort);
            Ok(())
        },
    },
    HardCase {
        name: "sums over 1e7 cells",
        why: "running sums lose digits in proportion to their length, single precision all of them",
        asserted: "rms height of -3, 1, 2 moved by 2^30 is sqrt(14/3); force and k of a ramp of 1e7 elements in closed form",
        bound: 1e-13,
        solve: long_sums,
    },
    HardCase {
        name: "beyond single precision",
        why: "operators inside the iteration have a noise floor of 2e-7",
        asserted: "gaps under pressure, by plain sums in double precision, in rms heights, at the tolerance 1e-10",
        bound: 1e-9,
        solve: noise_floor,
    },
    HardCase {
        name: "a loose tolerance",
        why: "the contact set is settled further for the sake of k: a k of the set before is plausible to a per cent",
        asserted: "at the tolerance 1e-3, k beside elimination of the state's own set and beside k of a tight solve",
        bound: LOOSE,
        solve: loose,
    },
    HardCase {
        name: "an unattainable tolerance",
        why: "1e-17 is below rounding: a loop that waits for it never ends or lies",
        asserted: "NotConverged, never called converged; the best state's certificate is near rounding all the same",
        bound: 1e-8,
        solve: unattainable,
    },
    HardCase {
        name: "a limit on outer iterations",
        why: "an interrupted active set is a plausible wrong answer",
        asserted: "NotConverged with the best state and its own certificate, or the k of the unlimited solve",
        bound: SAME,
        solve: few_rounds,
    },
    HardCase {
        name: "a deadline",
        why: "the caller stops at any moment: what is remembered may be half a state",
        asserted: "Stopped with the best state so far; the next solve gives the k of a fresh one",
        bound: SAME,
        solve: deadline,
    },
    HardCase {
        name: "no load, and loads that are none",
        why: "0/0 in every normalisation; NaN compares false with everything",
        asserted: "F = d = k = 0 exactly; negative, infinite and NaN loads are refused by every model (wrong answers)",
        bound: 0.0,
        solve: no_load,
    },
];

fn sizes(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    // 34 and 66: even 2 (N - 2) is a good length, so that one that is too short is not rounded up to one that
    // is long enough.
    let quick = [31, 34, 61, 64, 65, 66, 67];
    let thorough = [31, 34, 61, 64, 65, 66, 67, 97, 127, 128, 129];
    let sizes: &[usize] = effort.pick(&quick, &thorough);
    for &cells in sizes {
        let rough = rough_map(2.5, cells, 2)?;
        for force in [0.1, 30.0] {
            let mut scene = watched(&rough);
            scene.outputs.displacement = true;
            for method in [Method::Auto, Method::SingleLevel] {
                let model = Bem3d { method, ..tight() };
                let state = model.prepare(&scene, 0)?.solve(Load::force(force))?;
                let exact = PlainSum::of(&rough).displacement(&forces(&state, &rough)?);
                let found = state.displacement().map_or(&[][..], Field::values);
                ledger.must(found.len() == exact.len(), || format!("{} displacements", found.len()));
                for (a, b) in found.iter().zip(&exact) {
                    ledger.near("displacement", *a, *b);
                }
            }
        }
        let flat = press_both(ledger, &map(cells, 1.0, |_, _| 0.0)?, Load::force(1.0))?;
        let n = cells as f64;
        let formula = 1.152_298_5 - 0.402_5 / n + 0.12 / n.powf(1.59);
        let off = (stiffness(&flat)? / formula - 1.0).abs();
        // The formula holds to a few units of its seventh digit from 60 cells on.
        ledger.must(cells < 60 || off < 3e-6, || format!("N {cells}: k is off its formula by {off}"));
    }
    Ok(())
}

/// Mean of 1/r over the cell at (x, y): the displacement under unit pressure there.
fn quadrature(gauss: &Gauss<8>, x: f64, y: f64) -> f64 {
    let along =
        |centre: f64, function: &dyn Fn(f64) -> f64| gauss.integrate(centre - 0.5, centre + 0.5, function);
    along(x, &|x| along(y, &|y| x.hypot(y).recip()))
}

fn far_field(ledger: &mut Ledger, effort: Effort) {
    for (x, y, value) in [
        (0, 0, 3.525_494_348_078_17),
        (1, 0, 1.038_049_735_904_76),
        (1, 1, 0.724_697_438_134_33),
        (10, 10, 0.070_725_435_312_116_5),
        (64, 3, 0.015_608_020_519_585_132),
        (1000, 10, 0.000_999_950_045_410_101_3),
        (16384, 5000, 5.837_725_981_587_807e-5),
        (1_000_000, 0, 1.000_000_000_000_041_7e-6),
        (1_000_000, 999_999, 7.071_071_347_400_412e-7),
    ] {
        ledger.near("40-digit value", influence(x, y), value);
        ledger.near("40-digit value", influence(y, x), value);
    }
    // Quadrature converges as (1/(4 r))^16: exact to rounding from five cells on. Lags in all directions,
    // spaced by a tenth.
    let gauss = Gauss::new();
    let steps = effort.pick(130, 1300);
    for i in 0..steps {
        let r = 6.0 * (1e6_f64 / 6.0).powf(f64::from(i) / f64::from(steps - 1));
        for j in 0..effort.pick(9, 90) {
            let angle = f64::from(j) * std::f64::consts::FRAC_PI_2 / f64::from(effort.pick(8, 89));
            let (x, y) = ((r * angle.cos()).round(), (r * angle.sin()).round());
            ledger.near("quadrature", influence(x as usize, y as usize), quadrature(&gauss, x, y));
        }
    }
}

fn long_sums(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let count = effort.pick(10_000_000_usize, 40_000_000);
    // A multiple of three.
    let heights: Vec<f64> = (0..count / 3 * 3).map(|i| 1_073_741_824.0 + [-3.0, 1.0, 2.0][i % 3]).collect();
    ledger.near("rms height", surface_gen::rms_height(&heights), (14.0_f64 / 3.0).sqrt());
    // z_i = i/n: F = E* dx sum (d - z_i) over the m elements with z_i < d.
    let heights = (0..count).map(|i| -(i as f64) / count as f64).collect();
    let line = Arc::new(Line::new(1.0, heights)?);
    let mut contact =
        Mdr1d::default().prepare(&Scene::new(Surface::Line { line, size: 1.0.into() }, 1.0), 0)?;
    let n = count as f64;
    for d in [0.25, 1.0, 3.0] {
        let state = contact.solve(Load::approach(d))?;
        let m = (d * n).min(n);
        let exact = m / n * d - m * (m - 1.0) / (2.0 * n * n);
        ledger.near("force of a ramp", state.force, exact);
        ledger.near("length of a ramp", stiffness(&state)?, m / n);
    }
    Ok(())
}

fn noise_floor(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(65, 129);
    for (fractal_dimension, force) in [(2.0, 1.0), (2.0, 20.0), (2.6, 20.0), (2.0, 300.0)] {
        let map = rough_map(fractal_dimension, cells, 4)?;
        for method in [Method::SingleLevel, Method::Iterative] {
            let state = press_by(ledger, &Bem3d { method, ..tight() }, &map, Load::force(force))?;
            let forces = forces(&state, &map)?;
            let u = PlainSum::of(&map).displacement(&forces);
            let (highest, d) = (map.highest(), approach(&state)?);
            let gap = |i: usize| u[i] + highest - map.heights()[i] - d;
            // Weighted by pressure: what the certificate is about.
            let open: f64 = forces.iter().map(|&(i, f)| f / force * gap(i).abs()).sum();
            ledger.enter(open);
        }
    }
    Ok(())
}

fn loose(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(65, 129);
    for (fractal_dimension, seed) in [(2.0, 1), (2.3, 2), (2.6, 3), (3.0, 4)] {
        let map = rough_map(fractal_dimension, cells, seed)?;
        for method in [Method::Auto, Method::SingleLevel] {
            let model = Bem3d { tolerance: LOOSE, method, ..tight() };
            let mut contact = model.prepare(&watched(&map), 0)?;
            for force in [0.01, 0.03, 0.1, 0.3, 1.0] {
                let state = contact.solve(Load::force(force))?;
                ledger.meets(&state, LOOSE);
                let set = contact_set(&state)?;
                if set.len() <= 700 {
                    ledger.near("k of its own set", stiffness(&state)?, PlainSum::of(&map).stiffness(&set));
                }
                let exact = press(ledger, &map, Load::force(force))?;
                ledger.near("k of a tight solve", stiffness(&state)?, stiffness(&exact)?);
            }
        }
    }
    Ok(())
}

fn unattainable(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.2, effort.pick(65, 257), 4)?;
    for method in [Method::Auto, Method::Iterative, Method::SingleLevel] {
        let model = Bem3d { tolerance: 1e-17, method, ..tight() };
        for force in [0.1, 1.0, 20.0] {
            match model.prepare(&watched(&map), 0)?.solve(Load::force(force)) {
                Err(Error::NotConverged { best }) => {
                    let report = &best.report;
                    ledger.must(report.status != Status::Converged, || format!("{report:?}"));
                    ledger.must(!report.certificate.meets(1e-17), || format!("{report:?}"));
                    ledger.enter(report.certificate.worst());
                }
                other => {
                    ledger.must(false, || format!("{method:?}, F {force}: {:?}", other.map(|s| s.report)));
                }
            }
        }
    }
    Ok(())
}

fn few_rounds(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let map = rough_map(2.2, 65, 4)?;
    let exact = press(ledger, &map, Load::force(1.0))?;
    let mut refused = 0;
    for rounds in 0..12 {
        let model = Bem3d { max_outer_iterations: rounds, ..tight() };
        match model.prepare(&watched(&map), 0)?.solve(Load::force(1.0)) {
            Ok(state) => {
                ledger.meets(&state, model.tolerance);
                ledger.near("k", stiffness(&state)?, stiffness(&exact)?);
            }
            Err(Error::NotConverged { best }) => {
                refused += 1;
                ledger.must(best.report.status != Status::Converged, || {
                    format!("{rounds} outer iterations: {:?}", best.report)
                });
                ledger.must(!best.report.certificate.meets(model.tolerance), || {
                    format!("{rounds} outer iterations: {} is good enough", best.report.certificate)
                });
            }
            Err(other) => return Err(other),
        }
    }
    ledger.must(refused > 0, || "no limit was ever met: the case tests nothing".to_owned());
    Ok(())
}

fn deadline(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.2, effort.pick(65, 129), 4)?;
    let exact = press(ledger, &map, Load::force(1.0))?;
    let mut contact = tight().prepare(&watched(&map), 0)?;
    let (mut stopped, mut with_state) = (0, 0);
    for patience in (0..20).chain((20..400).step_by(20)) {
        match contact.solve_until(Load::force(1.0), &stop_after(patience)) {
            Err(Error::Stopped { best }) => {
                stopped += 1;
                if let Some(best) = best {
                    with_state += 1;
                    ledger.must(best.report.status == Status::Stopped, || format!("{:?}", best.report));
                    ledger.must(best.force.is_finite() && best.approach.is_some(), || format!("{best:?}"));
                }
            }
            Ok(state) => ledger.near("k", stiffness(&state)?, stiffness(&exact)?),
            Err(other) => return Err(other),
        }
        if patience % 7 == 0 {
            let state = contact.solve(Load::force(1.0))?;
            ledger.near("k of the next solve", stiffness(&state)?, stiffness(&exact)?);
        }
    }
    ledger.must(stopped > 0 && with_state > 0, || format!("{stopped} stopped, {with_state} with a state"));
    Ok(())
}

fn no_load(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let rough =
        || -> Result<Scene> { Ok(Scene::new(Surface::SelfAffine(crate::stability::rough(2.4)?), 1.0)) };
    let bem = Bem3d { cells: 33, ..tight() };
    let mdr = Mdr1d::default();
    let sphere = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
    let models: [(&dyn ContactModel, Scene); 3] =
        [(&bem, rough()?), (&mdr, rough()?), (&analytic::Hertz, sphere)];
    for (model, scene) in models {
        let mut contact = model.prepare(&scene, 0)?;
        for load in [Load::force(0.0), Load::approach(0.0), Load::force(-0.0)] {
            let state = contact.solve(load)?;
            let numbers = [Some(state.force), state.approach, state.stiffness];
            ledger.count(numbers.iter().filter(|v| !v.is_some_and(|v| v.abs() <= 0.0)).count());
            let next = contact.solve(Load::force(1e-3))?;
            ledger
                .must(next.stiffness.is_some_and(|k| k > 0.0), || format!("{} after {load:?}", model.name()));
        }
        for value in [-1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for load in [Load::force(value), Load::approach(value)] {
                let refused = matches!(contact.solve(load), Err(Error::Domain { .. }));
                ledger.count(usize::from(!refused));
                ledger.must(refused, || format!("{} takes {load:?}", model.name()));
            }
        }
    }
    Ok(())
}
