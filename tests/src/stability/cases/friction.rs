//! Friction where a solver has no set, no slip, nothing else, or no solution.

use super::few::faces;
use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, pressure};
use crate::stability::maps::{map, rough_map};
use crate::stability::slide::{
    MU, Slide, TIGHTER, VectorField, against_dragging, alike, compare, longest, rubbed, tangential, vectors,
};
use contact_model::{Body, ContactState, Error, HeightMap, Load, Pair, Result, Tangential};
use std::f64::consts::PI;

/// Bound for results by hand at [`TIGHTER`]: the error of the direction of a traction is the square root of
/// the gap.
const BY_HAND: f64 = 1e-7;
/// With a duality gap of 1e-10, the error of the tractions in the energy norm is its square root; that of
/// displacements, forces and energies is of second order.
const SECOND_ORDER: f64 = 1e-8;
/// A direction that is no axis.
const ALONG: [f64; 2] = [0.6, 0.8];

pub(super) const CASES: [HardCase; 9] = [
    HardCase {
        name: "gross slip to a billionth",
        why: "displacements grow without bound; at mu F no stick cell and no multiplier is left",
        asserted: "forces up to mu F (1 - 1e-9) and no farther (the error names mu F, the path stays); far beyond |Q| = mu F, and the energy by plain sums",
        bound: SECOND_ORDER,
        solve: gross_slip,
    },
    HardCase {
        name: "one cell, sheared",
        why: "no neighbour, one disk: every step sticks or slips as a whole",
        asserted: "an elastic and perfectly plastic spring of k = pi E* h_c/(4 ln(1 + sqrt 2) (1 + c/2)) on turning paths: forces, energies, both stiffnesses",
        bound: BY_HAND,
        solve: one_cell,
    },
    HardCase {
        name: "two cells, sheared",
        why: "the tensor's off-diagonal entry decides alone; both slip at once",
        asserted: "k = 2/(K(0) + K(1)) by the matrix of the pair, adjacent and diagonal; a higher and a lower cell by relaxation",
        bound: SECOND_ORDER,
        solve: two_cells,
    },
    HardCase {
        name: "no friction at all",
        why: "every disk is a point, the scale of all tractions is 0",
        asserted: "no traction and no energy at any displacement, slip is the displacement; no force is held, zero is",
        bound: 0.0,
        solve: frictionless,
    },
    HardCase {
        name: "a coefficient of 1000",
        why: "nothing slips but cells without pressure: limits of seven decades",
        asserted: "forces of a flat punch by elimination; full stick of a rough contact: its stiffness by elimination, and witness",
        bound: SECOND_ORDER,
        solve: stuck,
    },
    HardCase {
        name: "islands with holes between",
        why: "punches of undefined surroundings: windows almost empty, no cell between to carry a correction",
        asserted: "stiffness of full stick by elimination; partial slip, turned and reversed, by relaxation",
        bound: 1e-7,
        solve: islands,
    },
    HardCase {
        name: "a plateau, sheared",
        why: "ties: equal heights and equal pressures, cells that begin to slip together",
        asserted: "two axes of symmetry of the tractions; terraces by relaxation",
        bound: 1e-7,
        solve: plateau,
    },
    HardCase {
        name: "sheared in units at the ends of f64",
        why: "energies of 1e450 and 1e-450, lengths of 1e-100",
        asserted: "forces, displacements, energies and stiffness of the same path in ordinary units, divided",
        bound: 1e-9,
        solve: units,
    },
    HardCase {
        name: "friction on 1, 2 and 3 threads",
        why: "sums in the order in which threads finish, in two components",
        asserted: "tractions, slip, displacement, energy and both stiffnesses of a path bit for bit (numbers that differ)",
        bound: 0.0,
        solve: threads,
    },
];

fn along(size: f64) -> [f64; 2] {
    ALONG.map(|component| component * size)
}

fn gross_slip(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let (map, force) = (rough_map(2.4, effort.pick(20, 48), 7)?, 0.4);
    let (normal, most) = (Load::force(force), MU * force);
    for nu in [0.0, 0.3, 0.5] {
        let mut slide = Slide::new(&map, alike(nu), MU)?;
        let mut last = 0.0;
        for below in [1e-2, 1e-4, 1e-6, 1e-8, 1e-9] {
            let state = slide.force(ledger, normal, along(most * (1.0 - below)))?;
            let moved = longest(&[tangential(&state)?.displacement]);
            ledger.must(moved >= last, || format!("{moved} at 1 - {below}, {last} before"));
            last = moved;
        }
        let before = slide.force(ledger, normal, along(0.5 * most))?;
        for above in [1.0 + 1e-8, 1.5, 1e100] {
            match slide.attempt(normal, Tangential::Force(along(most * above))) {
                Err(Error::OutOfRange { value, max, min, .. }) => {
                    ledger.near("the largest force named", max, most);
                    ledger.near("the smallest", min, -most);
                    ledger.near("the one refused", value, above * most);
                }
                other => ledger.must(false, || format!("{above} mu F: {other:?}")),
            }
        }
        let again = tangential(&slide.force(ledger, normal, along(0.5 * most))?)?;
        let before = tangential(&before)?;
        compare(ledger, &[again.displacement], &[before.displacement], last);
        ledger.near("dissipated by nothing", again.dissipated, before.dissipated);
        // Elastic displacements turn the slip by their share of it.
        let far = 1e6 * last;
        let state = tangential(&slide.displace(ledger, normal, along(far))?)?;
        compare(ledger, &[state.force], &[along(most)], most);
        ledger.must(state.stick_area.is_some_and(|area| area <= 0.0), || format!("{state:?}"));
        // Back and forth again: the whole way is dissipated.
        let back = tangential(&slide.displace(ledger, normal, along(-far))?)?;
        compare(ledger, &[back.force], &[along(-most)], most);
        let lost = back.dissipated - state.dissipated;
        ledger.must((lost / (2.0 * far * most) - 1.0).abs() < 1e-5, || {
            format!("{lost} of {}", 2.0 * far * most)
        });
    }
    Ok(())
}

fn one_cell(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let map = map(1, 1.0, |_, _| 0.7)?;
    for nu in [0.0, 0.3, 0.5] {
        let c = nu / (1.0 - nu);
        let k = PI / (4.0 * (1.0 + 2_f64.sqrt()).ln() * (1.0 + 0.5 * c));
        let mut scene = rubbed(&map, alike(nu), MU);
        (scene.outputs.tangential_stiffness, scene.outputs.tangential_stiffness_stuck) = (true, true);
        let mut slide = Slide::to(TIGHTER, &map, &scene, MU)?;
        let (mut q, mut delta, mut lost) = ([0.0_f64; 2], [0.0_f64; 2], 0.0);
        let unit = MU / k;
        // Stick, slip, a turn, a reversal at once, less and more force, apart and touched anew.
        for (force, to) in [
            (1.0, [0.5, 0.0]),
            (1.0, [1.5, 0.2]),
            (1.0, [1.5, 3.0]),
            (1.0, [1.4, 2.9]),
            (1.0, [-4.0, 0.0]),
            (0.3, [-4.0, 0.1]),
            (2.0, [-4.0, 0.5]),
            (0.0, [0.0, 5.0]),
            (1.0, [0.3, 5.0]),
        ] {
            let to = to.map(|to| to * unit);
            let found = tangential(&slide.displace(ledger, Load::force(force), to)?)?;
            let trial = [0, 1].map(|i| q[i] + k * (to[i] - delta[i]));
            let (length, most) = (trial[0].hypot(trial[1]), MU * force);
            q = if length > most { trial.map(|t| t * most / length) } else { trial };
            // Slip is what the spring does not take up.
            let slip = (length - most).max(0.0) / k;
            lost += slip * longest(&[q]);
            delta = to;
            compare(ledger, &[found.force], &[q], MU);
            ledger.enter((found.dissipated - lost).abs() / (MU * unit));
            // In slip nothing along it, and across it the spring in a row with the turning of the traction.
            let exact = if force <= 0.0 {
                [[0.0; 2]; 2]
            } else if length > most {
                let across = 1.0 / (1.0 / k + slip / most);
                let e = [-trial[1] / length, trial[0] / length];
                [0, 1].map(|i| [0, 1].map(|j| across * e[i] * e[j]))
            } else {
                [[k, 0.0], [0.0, k]]
            };
            let none = [[f64::NAN; 2]; 2];
            compare(ledger, &found.stiffness.unwrap_or(none), &exact, k);
            let stuck = if force > 0.0 { [[k, 0.0], [0.0, k]] } else { [[0.0; 2]; 2] };
            compare(ledger, &found.stiffness_stuck.unwrap_or(none), &stuck, k);
        }
    }
    Ok(())
}

fn two_cells(ledger: &mut Ledger, _: Effort) -> Result<()> {
    for (nu, (dx, dy)) in [(0.3, (1, 0)), (0.5, (0, 1)), (0.5, (1, 1))] {
        for (cells, (x0, y0)) in [(2, (0, 0)), (7, (2, 4)), (32, (30, 0))] {
            let pair = [(x0, y0), (x0 + dx, y0 + dy)];
            let map = faces(cells, |x, y| pair.contains(&(x, y)))?;
            let mut scene = rubbed(&map, alike(nu), MU);
            scene.outputs.tangential_stiffness = true;
            let mut slide = Slide::of(&map, &scene, MU)?;
            let at = pair.map(|(x, y)| y * cells + x);
            let ([own, _, _], [xx, yy, xy]) =
                (slide.sum().between(at[0], at[0]), slide.sum().between(at[1], at[0]));
            let (a, b) = (0.5 * (own + xx), 0.5 * (own + yy));
            let xy = 0.5 * xy;
            let (normal, most) = (Load::force(1e-3), 1e-3 * MU);
            for share in [[0.4, 0.0], [0.1, 0.7], [-0.5, 0.2]] {
                let q = share.map(|share| share * most);
                let found = tangential(&slide.force(ledger, normal, q)?)?;
                let delta = [a * q[0] + xy * q[1], xy * q[0] + b * q[1]];
                compare(ledger, &[found.displacement], &[delta], a * most);
                let k = 1.0 / (a * b - xy * xy);
                let exact = [[b * k, -xy * k], [-xy * k, a * k]];
                compare(ledger, &found.stiffness.unwrap_or([[f64::NAN; 2]; 2]), &exact, 1.0 / a);
                ledger.must(found.dissipated.abs() <= 1e-9 * most * most * a, || format!("{found:?}"));
            }
            // Both carry the same, and slip at once: forces beyond are refused, displacements are friction's.
            let far = [1e7 * a * most, 0.0];
            let found = tangential(&slide.displace(ledger, normal, far)?)?;
            compare(ledger, &[found.force], &[[most, 0.0]], most);
        }
    }
    Ok(())
}

fn frictionless(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.3, effort.pick(16, 48), 3)?;
    let mut slide = Slide::new(&map, alike(0.3), 0.0)?;
    let normal = Load::force(0.3);
    for delta in [[0.5, 0.0], [-1.0, 2.0], [1e12, -1e-12], [0.0, 0.0]] {
        let state = slide.attempt(normal, Tangential::Displacement(delta))?;
        let found = tangential(&state)?;
        let (p, s) = (pressure(&state)?, vectors(&state, VectorField::Slip)?);
        let q = vectors(&state, VectorField::Traction)?;
        ledger.count(q.iter().filter(|q| longest(&[**q]) > 0.0).count());
        let rounding = 1e-14 * longest(&[delta, [1e12, 0.0]]);
        let slips = |i: usize| (s[i][0] - delta[0]).hypot(s[i][1] - delta[1]) <= rounding;
        ledger.count((0..p.len()).filter(|&i| p[i] > 0.0 && !slips(i)).count());
        ledger.count(usize::from(longest(&[found.force]) > 0.0 || found.dissipated.abs() > 0.0));
        ledger.count(usize::from(found.sliding_force != Some(0.0)));
    }
    let state = slide.attempt(normal, Tangential::Force([0.0; 2]))?;
    ledger.count(usize::from(longest(&[tangential(&state)?.displacement]) > 0.0));
    for force in [1e-300, 1e-9, 1.0] {
        let refused = slide.attempt(normal, Tangential::Force([0.0, -force]));
        let named = matches!(&refused, Err(Error::OutOfRange { max, .. }) if max.abs() <= 0.0);
        ledger.must(named, || format!("a force of {force}: {refused:?}"));
        ledger.count(usize::from(!named));
    }
    Ok(())
}

fn stuck(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(9, 14);
    for nu in [0.0, 0.3, 0.5] {
        // A round flat punch, where all pressures are of one size.
        let middle = 0.5 * (n - 1) as f64;
        let face = |x: usize, y: usize| (x as f64 - middle).hypot(y as f64 - middle) <= 0.4 * n as f64;
        let punch = faces(n, face)?;
        let cells: Vec<usize> = (0..n * n).filter(|i| face(i % n, i / n)).collect();
        let mut slide = Slide::new(&punch, alike(nu), 1e3)?;
        let k = slide.sum().stiffness(&cells);
        for delta in [[1e-3, 0.0], [-0.3, 0.1], [0.0, -1.0]] {
            let found = tangential(&slide.displace(ledger, Load::force(1.0), delta)?)?;
            let exact = [0, 1].map(|i| k[i][0] * delta[0] + k[i][1] * delta[1]);
            compare(ledger, &[found.force], &[exact], longest(&[exact]));
            ledger.must(found.dissipated.abs() <= 1e-9 * longest(&[exact]), || format!("{found:?}"));
        }
        // A rough one: cells at the edges of contacts have pressures of any size.
        let rough = rough_map(2.5, n, 4)?;
        let mut scene = rubbed(&rough, alike(nu), 1e3);
        scene.outputs.tangential_stiffness_stuck = true;
        let mut slide = Slide::of(&rough, &scene, 1e3)?;
        for force in [0.01, 0.3, 3.0] {
            let state = slide.displace(ledger, Load::force(force), along(0.1))?;
            let cells: Vec<usize> =
                pressure(&state)?.iter().enumerate().filter(|(_, p)| **p > 0.0).map(|(i, _)| i).collect();
            let k = slide.sum().stiffness(&cells);
            let found = tangential(&state)?.stiffness_stuck.unwrap_or([[f64::NAN; 2]; 2]);
            compare(ledger, &found, &k, k[0][0]);
        }
    }
    Ok(())
}

fn islands(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(14, 20);
    // Squares of 2 x 2 cells, three apart, in undefined surroundings; the lower ones touch later.
    let heights = (0..n * n).map(|i| {
        let (x, y) = (i % n, i / n);
        if x % 4 < 2 && y % 4 < 2 { -0.02 * ((x / 4 + y / 4) % 2) as f64 } else { f64::NAN }
    });
    let map = HeightMap::with_undefined(n, 1.0, heights.collect())?;
    for nu in [0.3, 0.5] {
        let mut scene = rubbed(&map, alike(nu), MU);
        scene.outputs.tangential_stiffness_stuck = true;
        let mut slide = Slide::to(TIGHTER, &map, &scene, MU)?;
        against_dragging(
            ledger,
            &map,
            &mut slide,
            MU,
            &[
                (0.05, [0.01, 0.0]),
                (0.05, [0.008, 0.012]),
                (0.08, [0.0, 0.012]),
                (0.01, [0.0, 0.012]),
                (0.05, [-0.02, 0.0]),
            ],
        )?;
        let state = slide.displace(ledger, Load::approach(0.05), [0.0; 2])?;
        let cells: Vec<usize> =
            pressure(&state)?.iter().enumerate().filter(|(_, p)| **p > 0.0).map(|(i, _)| i).collect();
        let k = slide.sum().stiffness(&cells);
        let found = tangential(&state)?.stiffness_stuck.unwrap_or([[f64::NAN; 2]; 2]);
        compare(ledger, &found, &k, k[0][0]);
    }
    Ok(())
}

fn plateau(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(12, 20);
    // One plateau, and nothing else.
    let flat = map(n, 1.0, |_, _| 0.0)?;
    let mut slide = Slide::new(&flat, alike(0.5), MU)?;
    for share in [0.3, 0.9, -0.5] {
        let state = slide.force(ledger, Load::force(1.0), [share * MU, 0.0])?;
        let q = vectors(&state, VectorField::Traction)?;
        let most = longest(&q);
        // Even along both axes in q_x, odd along both in q_y.
        for (i, [x, y]) in q.iter().enumerate() {
            let (ix, iy) = (i % n, i / n);
            for (j, sign) in [(iy * n + n - 1 - ix, -1.0), ((n - 1 - iy) * n + ix, -1.0)] {
                ledger.enter((x - q[j][0]).hypot(y - sign * q[j][1]) / most * 1e-2);
            }
        }
        ledger.enter(tangential(&state)?.displacement[1].abs() / tangential(&state)?.displacement[0].abs());
    }
    // Terraces: heights in three steps.
    let terraces = map(n, 1.0, |x, y| -0.05 * ((x / 3 + 2 * (y / 4)) % 3) as f64)?;
    let mut slide = Slide::to(TIGHTER, &terraces, &rubbed(&terraces, alike(0.3), MU), MU)?;
    against_dragging(
        ledger,
        &terraces,
        &mut slide,
        MU,
        &[(0.04, [0.01, 0.0]), (0.12, [0.01, 0.01]), (0.06, [-0.02, 0.01]), (0.06, [-0.02, -0.01])],
    )
}

/// `[F, Q, delta, dissipated, k]` of both components at the end of a path.
fn numbers(state: &ContactState) -> Result<[f64; 8]> {
    let t = tangential(state)?;
    let k = t.stiffness.unwrap_or([[f64::NAN; 2]; 2]);
    Ok([
        state.force,
        t.force[0],
        t.force[1],
        t.displacement[0],
        t.displacement[1],
        t.dissipated,
        k[0][0],
        k[0][1],
    ])
}

fn units(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.4, effort.pick(16, 32), 5)?;
    // (E*, lateral, vertical): forces are their product, energies the vertical once more.
    let run = |contact_modulus: f64, lateral: f64, vertical: f64| -> Result<Vec<[f64; 8]>> {
        let there = map.scaled(lateral, vertical)?;
        let Pair { first, second } = alike(0.3);
        let pair = |body| match body {
            Body::Elastic { young, poisson } => Body::Elastic { young: young * contact_modulus, poisson },
            other => other,
        };
        let pair = Pair { first: pair(first), second: pair(second) };
        let mut scene = rubbed(&there, pair, MU);
        scene.contact_modulus = pair.contact_modulus()?;
        scene.outputs.tangential_stiffness = true;
        let mut slide = Slide::of(&there, &scene, MU)?;
        let unit = contact_modulus * lateral * vertical;
        let (force, most) = (0.3 * unit, 0.3 * MU * unit);
        [
            (force, Tangential::Force(along(0.7 * most))),
            (force, Tangential::Force(along(-0.4 * most))),
            (0.8 * force, Tangential::Displacement([0.1 * vertical, -0.2 * vertical])),
        ]
        .into_iter()
        .map(|(force, load)| {
            let [f, q_x, q_y, x, y, lost, kxx, kxy] = numbers(&slide.attempt(Load::force(force), load)?)?;
            let (energy, k) = (unit * vertical, contact_modulus * lateral);
            Ok([
                f / unit,
                q_x / unit,
                q_y / unit,
                x / vertical,
                y / vertical,
                lost / energy,
                kxx / k,
                kxy / k,
            ])
        })
        .collect()
    };
    let here = run(1.0, 1.0, 1.0)?;
    for (contact_modulus, lateral, vertical) in [
        (1e100, 1e100, 1e-150),
        (1e-100, 1e-100, 1e150),
        (1e-12, 1e12, 1.0),
        (1.0, 1e-150, 1.0),
        (1e-200, 1.0, 1e60),
        (1.0, 1.0, 1e140),
        (1.0, 1.0, 1e-140),
    ] {
        let there = run(contact_modulus, lateral, vertical)?;
        for (here, there) in here.iter().zip(&there) {
            for (i, (a, b)) in here.iter().zip(there).enumerate() {
                // The entry across is small beside the diagonal one.
                let unit = if i == 7 { here[6] } else { *a };
                ledger.enter((a - b).abs() / unit.abs());
            }
        }
    }
    Ok(())
}

fn threads(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    // Above the size from which sums and transforms are shared among threads.
    let map = rough_map(2.3, effort.pick(140, 180), 6)?;
    let mut scene = rubbed(&map, alike(0.3), MU);
    (scene.outputs.tangential_stiffness, scene.outputs.tangential_stiffness_stuck) = (true, true);
    let path = |threads: usize| -> Result<Vec<u64>> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|_| Error::domain("threads", threads as f64, "threads that the system grants"))?;
        pool.install(|| {
            let mut slide = Slide::to(1e-6, &map, &scene, MU)?;
            let mut bits = Vec::new();
            for share in [along(0.6), [0.5, -0.5]] {
                let state =
                    slide.attempt(Load::force(20.0), Tangential::Force(share.map(|s| s * MU * 20.0)))?;
                let t = tangential(&state)?;
                let fields = [VectorField::Traction, VectorField::Slip].map(|of| vectors(&state, of));
                let k = [t.stiffness, t.stiffness_stuck].into_iter().flatten().flatten();
                let scalars = [t.force, t.displacement, [t.dissipated, approach(&state)?]];
                for vector in scalars
                    .into_iter()
                    .chain(k)
                    .chain(fields.into_iter().collect::<Result<Vec<_>>>()?.concat())
                {
                    bits.extend(vector.map(f64::to_bits));
                }
            }
            Ok(bits)
        })
    };
    let alone = path(1)?;
    for threads in [2, 3] {
        let bits = path(threads)?;
        ledger.must(bits.len() == alone.len(), || format!("{} numbers, {}", bits.len(), alone.len()));
        ledger.count(alone.iter().zip(&bits).filter(|(a, b)| a != b).count());
    }
    Ok(())
}

/// With a Poisson's ratio of 0 the kernel is that of the reference implementation of normal contact.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::plain::PlainSum;

    #[test]
    fn a_plain_shear_without_poissons_ratio_is_the_plain_sum() {
        let map = rough_map(2.4, 8, 1).unwrap();
        let normal = PlainSum::of(&map).stiffness(&[3, 4, 12, 20]);
        let k = crate::stability::PlainShear::of(&map, 0.0).stiffness(&[3, 4, 12, 20]);
        assert!((k[0][0] / normal - 1.0).abs() < 1e-12 && (k[1][1] / normal - 1.0).abs() < 1e-12);
        assert!(k[0][1].abs() < 1e-15 * normal);
    }
}
