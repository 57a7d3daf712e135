//! Paths of friction: reversals, turns, loads that rise and fall.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, largest, mean_gap, pressure};
use crate::stability::maps::{map, rough_map};
use crate::stability::press::{tight, watched, watched_periodic};
use crate::stability::slide::{
    MU, Slide, TIGHTER, VectorField, against_dragging, alike, compare, longest, rubbed, tangential, vectors,
};
use contact_model::{Boundary, ContactModel, Error, HeightMap, Load, Result, Scene, Step, Tangential};
use std::f64::consts::PI;

/// Bound of displacements and energies between two states at a tolerance of 1e-10 of the energy.
const SECOND_ORDER: f64 = 1e-8;
/// Bound in comparison with relaxation, which includes a tenth of the deviation of the tractions over the
/// largest one.
const RELAXED: f64 = 1e-7;

pub(super) const CASES: [HardCase; 7] = [
    HardCase {
        name: "paths of friction, nu 0.3 and 0.5",
        why: "every step begins from slip references of all steps before; sets of stick and slip cells have no order",
        asserted: "tractions, force and dissipated energy beside relaxation: reversal, turned loads, normal loads that rise and fall; witness of periodic ones",
        bound: RELAXED,
        solve: paths,
    },
    HardCase {
        name: "the normal force falls under a tangential one",
        why: "limits shrink below the tractions that are there; at F = Q/mu the contact slips as a whole",
        asserted: "witness down to F = Q/mu (1 + 1e-6); below it an error that names mu F, and the path stays",
        bound: SECOND_ORDER,
        solve: falling,
    },
    HardCase {
        name: "reversed at once",
        why: "the step after a reversal begins with the whole contact on the edge between stick and slip",
        asserted: "nu = 0, discrete: q = q_1 - 2 mu (p(F) - p(F - (Q_1 - Q)/(2 mu))), its displacement, and a loop that closes",
        bound: RELAXED,
        solve: reversed,
    },
    HardCase {
        name: "sheared under loads of sixteen decades",
        why: "one cell to full contact on one surface, and down again with slip references of either",
        asserted: "nu = 0: delta = mu (d(F) - d(F - Q/mu)) at every force; nu = 0.5: witness, up and down",
        bound: SECOND_ORDER,
        solve: range,
    },
    HardCase {
        name: "oblong cells, sheared",
        why: "tractions along the cells and across them displace differently; the preconditioner knows neither",
        asserted: "beside relaxation for sides 10 : 1 and 1 : 30 and nu = 0.5; a turned map has the turned forces",
        bound: RELAXED,
        solve: oblong,
    },
    HardCase {
        name: "a periodic surface that sticks as a whole",
        why: "in full contact nothing is displaced by the mean traction: every displacement is rounding, the stiffness no number",
        asserted: "uniform tractions, no displacement, no slip and no stiffness up to mu times the smallest pressure; beyond it witness",
        bound: 1e-7,
        solve: full_contact,
    },
    HardCase {
        name: "a periodic wave in plane strain, nu = 0.5",
        why: "one closed form that Poisson's ratio does not end: tractions along the wave and across it",
        asserted: "q = mu (p(F) - p(F - Q/mu)); delta = mu times the change of the mean gap along the wave, (1 + c) times it across",
        bound: RELAXED,
        solve: wave,
    },
];

fn paths(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(11, 16);
    for (seed, nu) in [(5, 0.3), (6, 0.5)] {
        let map = rough_map(2.4, n, seed)?;
        let d = 1.5;
        // Displacements of the size at which contacts slip.
        let s = 0.4 * d * MU;
        let path = [
            (d, [s, 0.0]),
            // Reversed, turned.
            (d, [-0.5 * s, 0.0]),
            (d, [-0.3 * s, s]),
            // More pressure at one displacement, and less.
            (1.3 * d, [-0.3 * s, s]),
            (0.6 * d, [-0.3 * s, s]),
            (0.6 * d, [0.2 * s, 0.5 * s]),
            // Both at once; all slips; and back.
            (1.2 * d, [s, -s]),
            (d, [5.0 * s, -s]),
            (d, [4.7 * s, -s]),
            (0.2 * d, [4.7 * s, 0.0]),
            (d, [4.7 * s, 0.1 * s]),
        ];
        let mut slide = Slide::to(TIGHTER, &map, &rubbed(&map, alike(nu), MU), MU)?;
        against_dragging(ledger, &map, &mut slide, MU, &path)?;
        // The same with periodic boundaries, for the witness.
        let mut slide = Slide::periodic(&map, alike(nu), MU)?;
        for (force, share) in [(0.3, [0.6, 0.0]), (0.3, [-0.2, 0.5]), (0.5, [-0.2, 0.2]), (0.1, [0.3, -0.9])]
        {
            slide.force(ledger, Load::force(force), share.map(|share| share * MU * force))?;
        }
    }
    Ok(())
}

fn falling(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.3, effort.pick(20, 48), 2)?;
    for nu in [0.0, 0.3, 0.5] {
        let mut slide = Slide::new(&map, alike(nu), MU)?;
        let (force, q) = (0.5, [0.3 * MU * 0.5, 0.4 * MU * 0.5]);
        let mut lost = 0.0;
        for share in [1.0, 0.9, 0.7, 0.6, 0.51, 0.5 * (1.0 + 1e-4), 0.5 * (1.0 + 1e-6)] {
            let found = tangential(&slide.force(ledger, Load::force(share * force), q)?)?;
            ledger.must(found.dissipated >= lost, || format!("{} after {lost}", found.dissipated));
            lost = found.dissipated;
        }
        ledger.must(lost > 0.0, || "nothing slipped".to_owned());
        for share in [0.499, 0.1, 1e-6] {
            match slide.attempt(Load::force(share * force), Tangential::Force(q)) {
                Err(Error::OutOfRange { max, .. }) => {
                    ledger.near("the largest force", max, MU * share * force);
                }
                other => ledger.must(false, || format!("F = {share}: {other:?}")),
            }
        }
        // The path is where it was: pressed again, nothing has been lost meanwhile.
        let found = tangential(&slide.force(ledger, Load::force(0.5 * (1.0 + 1e-6) * force), q)?)?;
        ledger.enter((found.dissipated - lost).abs() / lost);
        // Lifted off and touched again: no slip, no traction remembered.
        slide.force(ledger, Load::force(0.0), [0.0; 2])?;
        let state = slide.force(ledger, Load::force(force), [0.0; 2])?;
        ledger.enter(longest(&vectors(&state, VectorField::Traction)?) / (MU * largest(pressure(&state)?)));
    }
    Ok(())
}

/// Pressures and approaches of some forces on one surface.
fn pressed(scene: &Scene, forces: &[f64]) -> Result<Vec<(Vec<f64>, f64)>> {
    let mut contact = tight().prepare(scene, 0)?;
    let one = |&force: &f64| {
        if force <= 0.0 {
            return Ok((vec![0.0; 0], 0.0));
        }
        let state = contact.solve(Load::force(force))?;
        let d =
            if scene.effects.boundary == Boundary::Periodic { -mean_gap(&state)? } else { approach(&state)? };
        Ok((pressure(&state)?.to_vec(), d))
    };
    forces.iter().map(one).collect()
}

fn reversed(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.4, effort.pick(24, 64), 4)?;
    let force = 0.5;
    let (first, then) = (0.7, [0.699_999, 0.5, -0.1, -0.6, -0.7]);
    // mu is 1 in these: p(F - Q/mu), p(F - (Q_1 - Q)/(2 mu)).
    let halves = then.map(|q| force * (1.0 - 0.5 * (first - q)));
    let shares: Vec<f64> = [force, force * (1.0 - first)].into_iter().chain(halves).collect();
    let states = pressed(&watched(&map), &shares)?;
    let ((all, d), (rest, d_rest)) = (&states[0], &states[1]);
    let most = MU * largest(all);
    let unit = MU * (d - d_rest);
    let along = [0.8, -0.6];
    for (q, (half, d_half)) in then.iter().zip(&states[2..]) {
        let mut slide = Slide::new(&map, alike(0.0), MU)?;
        let at = |share: f64| along.map(|a| a * share * MU * force);
        slide.force(ledger, Load::force(force), at(first))?;
        let state = slide.force(ledger, Load::force(force), at(*q))?;
        let exact: Vec<[f64; 2]> = (0..all.len())
            .map(|i| MU * ((all[i] - rest[i]) - 2.0 * (all[i] - half[i])))
            .map(|q| along.map(|a| 0.1 * a * q))
            .collect();
        let tractions: Vec<[f64; 2]> =
            vectors(&state, VectorField::Traction)?.iter().map(|q| q.map(|q| 0.1 * q)).collect();
        compare(ledger, &tractions, &exact, most);
        let delta = MU * ((d - d_rest) - 2.0 * (d - d_half));
        let found = tangential(&state)?;
        compare(ledger, &[found.displacement], &[along.map(|a| a * delta)], unit);
        // Up again: the loop closes.
        let closed = tangential(&slide.force(ledger, Load::force(force), at(first))?)?;
        if *q > -first {
            compare(ledger, &[closed.displacement], &[along.map(|a| a * unit)], unit);
        }
    }
    Ok(())
}

fn range(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.4, effort.pick(24, 48), 8)?;
    let forces = [1e-12, 1e-8, 1e-5, 1e-3, 0.1, 1.0, 10.0, 1e4];
    let share = 0.6;
    let all: Vec<f64> = forces.iter().flat_map(|f| [*f, f * (1.0 - share)]).collect();
    let states = pressed(&watched(&map), &all)?;
    let mut slide = Slide::new(&map, alike(0.0), MU)?;
    for (force, states) in forces.iter().zip(states.chunks_exact(2)) {
        let expected = MU * (states[0].1 - states[1].1);
        slide.restart();
        let state = slide.force(ledger, Load::force(*force), [0.0, share * MU * force])?;
        ledger.enter((tangential(&state)?.displacement[1] / expected - 1.0).abs() * 1e-1);
    }
    let mut slide = Slide::new(&map, alike(0.5), MU)?;
    for force in forces.iter().chain(forces.iter().rev()) {
        slide.force(ledger, Load::force(*force), [share * MU * force, 0.1 * MU * force])?;
    }
    Ok(())
}

fn oblong(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(9, 14);
    let wavy = |size: [f64; 2]| {
        let heights = (0..n * n).map(|i| {
            let (x, y) = ((i % n) as f64, (i / n) as f64);
            (1.1 * x).cos() + 0.7 * (0.9 * y).sin() + 0.2 * (3.1 * x + 5.3 * y).sin()
        });
        HeightMap::new([n, n], size, heights.collect())
    };
    for size in [[10.0, 1.0], [1.0, 30.0]] {
        let map = wavy(size)?;
        let s = 0.2;
        let path = [(0.8, [s, 0.0]), (0.8, [0.3 * s, s]), (1.2, [-s, s]), (0.5, [-s, 0.0])];
        let mut slide = Slide::to(TIGHTER, &map, &rubbed(&map, alike(0.5), MU), MU)?;
        against_dragging(ledger, &map, &mut slide, MU, &path)?;
        let turned = map.rotated();
        let (mut here, mut there) = (Slide::new(&map, alike(0.5), MU)?, Slide::new(&turned, alike(0.5), MU)?);
        for (d, [x, y]) in path {
            let one = tangential(&here.displace(ledger, Load::approach(d), [x, y])?)?;
            let other = tangential(&there.displace(ledger, Load::approach(d), [-y, x])?)?;
            let most = one.sliding_force.unwrap_or(f64::NAN);
            compare(ledger, &[other.force], &[[-one.force[1], one.force[0]]], most);
        }
    }
    Ok(())
}

fn full_contact(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(8, 12);
    for nu in [0.0, 0.3, 0.5] {
        let map = rough_map(2.2, n, 3)?;
        let force = 40.0;
        let mut scene = rubbed(&map, alike(nu), MU);
        scene.effects.boundary = Boundary::Periodic;
        (scene.outputs.tangential_stiffness, scene.outputs.tangential_stiffness_stuck) = (true, true);
        let mut slide = Slide::of(&map, &scene, MU)?;
        let state = slide.force(ledger, Load::force(force), [0.0; 2])?;
        let p = pressure(&state)?.to_vec();
        let least = p.iter().copied().fold(f64::INFINITY, f64::min);
        ledger.must(least > 0.0, || format!("no full contact: {least}"));
        let unit = MU * force / (map.size().x * PI);
        for share in [0.5, 0.999, -0.999] {
            // The sides are 1: forces are mean tractions.
            let q = share * MU * least;
            let state = slide.force(ledger, Load::force(force), [0.6 * q, 0.8 * q])?;
            let exact = vec![[0.6 * q, 0.8 * q]; p.len()];
            compare(ledger, &vectors(&state, VectorField::Traction)?, &exact, MU * least);
            let found = tangential(&state)?;
            compare(ledger, &[found.displacement], &[[0.0; 2]], unit);
            ledger.enter(longest(&vectors(&state, VectorField::Slip)?) / unit);
            ledger.enter(found.dissipated / (unit * MU * force));
            let absent = found.stiffness.is_none() && found.stiffness_stuck.is_none();
            ledger.must(absent, || format!("what does not move has a stiffness: {found:?}"));
        }
        // Some cells slip: what resists is friction alone.
        for share in [0.95, -0.8] {
            let found = tangential(&slide.force(ledger, Load::force(force), [share * MU * force, 0.0])?)?;
            let slips = found.stiffness.is_some_and(|k| k[0][0] > 0.0) && found.stiffness_stuck.is_none();
            ledger.must(slips, || format!("{found:?}"));
        }
    }
    Ok(())
}

fn wave(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(24, 64);
    let wavy = map(n, 1.0, |x, _| (2.0 * PI * (x as f64 + 0.5) / n as f64).cos())?;
    let force = 0.8;
    let share = 0.6;
    let states = pressed(
        &{
            let mut scene = watched_periodic(&wavy);
            (scene.outputs.mean_gap, scene.outputs.stiffness) = (true, false);
            scene
        },
        &[force, force * (1.0 - share)],
    )?;
    let ((all, d), (rest, d_rest)) = (&states[0], &states[1]);
    for nu in [0.0, 0.3, 0.5] {
        let c = nu / (1.0 - nu);
        for (along, factor) in [([1.0, 0.0], 1.0), ([0.0, -1.0], 1.0 + c)] {
            let mut scene = rubbed(&wavy, alike(nu), MU);
            scene.effects.boundary = Boundary::Periodic;
            let mut contact = tight().prepare(&scene, 0)?;
            let tangential_load = Tangential::Force(along.map(|a| a * share * MU * force));
            let state =
                contact.advance(Step::new(0.0, Load::force(force).with_tangential(tangential_load)))?;
            ledger.meets(&state, tight().tolerance);
            let exact: Vec<[f64; 2]> =
                all.iter().zip(rest).map(|(p, rest)| along.map(|a| 0.1 * a * MU * (p - rest))).collect();
            let tractions: Vec<[f64; 2]> =
                vectors(&state, VectorField::Traction)?.iter().map(|q| q.map(|q| 0.1 * q)).collect();
            compare(ledger, &tractions, &exact, MU * largest(all));
            let delta = factor * MU * (d - d_rest);
            compare(ledger, &[tangential(&state)?.displacement], &[along.map(|a| a * delta)], delta.abs());
        }
    }
    Ok(())
}
