//! Properties that follow from mechanics for any small map with a hardness, or with adhesion of finite range.

#![allow(clippy::unwrap_used)]

use bem3d::*;
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, RngSeed};
use std::sync::Arc;

/// Tolerance of the residuals, which are relative to the rms height (here 1) and to the attraction of closed
/// cells.
const TOLERANCE: f64 = 1e-9;
/// The resulting relative error of a force, an approach or a volume: stiff cells multiply a gap by up to a
/// hundred. The error of the pressure of a cell is a gap over its side.
const SAME: f64 = 1e-7;
/// Sums over at most 144 cells, relative.
const ROUNDING: f64 = 1e-12;
/// A step of approach along a smooth branch of adhesion, in ranges: over it the force is linear up to second
/// order.
const SMALL_STEP: f64 = 1e-3;
/// Relative error of the difference of two energies and of its force: the energy is stationary, so that its
/// error is the rounding of its sums, over a step of at least 1e-4.
const ENERGY: f64 = 1e-8;
/// Steps of a loop in each direction.
const STEPS: usize = 12;

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct("tests/properties.regressions"))),
        ..ProptestConfig::with_cases(cases)
    }
}

prop_compose! {
    /// Noise, or a self-affine surface, of the rms height 1 on the unit square.
    fn any_map()(
        kind in 0_u8..3, cells in 4_usize..13, seed in 0_u64..1000, noise in prop::collection::vec(0.0_f64..1.0, 144),
    ) -> HeightMap {
        let heights = if kind == 0 {
            noise[..cells * cells].to_vec()
        } else {
            let surface = SelfAffine::new(if kind == 1 { 2.2 } else { 2.7 }, 1.0, 1.0).unwrap();
            surface_gen::self_affine_map(&surface, cells, seed).unwrap().heights().to_vec()
        };
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let rms = (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / heights.len() as f64).sqrt();
        HeightMap::new(cells, 1.0, heights.iter().map(|h| h / rms).collect()).unwrap()
    }
}

fn boundary() -> impl Strategy<Value = Boundary> {
    prop_oneof![Just(Boundary::Free), Just(Boundary::Periodic)]
}

/// One of the eight symmetries of the square.
fn turned(map: &HeightMap, (turns, mirror, transpose): (u8, bool, bool)) -> HeightMap {
    let mut map = map.clone();
    for _ in 0..turns {
        map = map.rotated();
    }
    if mirror {
        map = map.mirrored();
    }
    if transpose { map.transposed() } else { map }
}

fn symmetry() -> impl Strategy<Value = (u8, bool, bool)> {
    (0_u8..4, any::<bool>(), any::<bool>())
}

/// The elastic scene of a map with every output that the properties use; E* = 1.
fn elastic(map: &HeightMap, boundary: Boundary) -> Scene {
    let mut scene = Scene::new(Surface::Heights(Arc::new(map.clone())), 1.0);
    scene.effects.boundary = boundary;
    (scene.outputs.area, scene.outputs.pressure, scene.outputs.displacement) = (true, true, true);
    scene.outputs.mean_gap = boundary == Boundary::Periodic;
    scene.outputs.stiffness = false;
    scene
}

fn with_hardness(scene: &Scene, pressure: f64) -> Scene {
    let mut scene = scene.clone();
    scene.effects.hardness = Hardness::Limit { pressure };
    scene.outputs.plastic_depth = true;
    scene
}

fn model() -> Bem3d {
    Bem3d { tolerance: TOLERANCE, ..Bem3d::default() }
}

fn solved(scene: &Scene, load: Load) -> ContactState {
    ContactModel::prepare(&model(), scene, 0).unwrap().solve(load).unwrap()
}

fn pressures(state: &ContactState) -> &[f64] {
    state.pressure().unwrap().values()
}

fn highest(state: &ContactState) -> f64 {
    pressures(state).iter().copied().fold(0.0, f64::max)
}

/// The displacement of the plane: the approach, or the decrease of the mean gap.
fn lowered(state: &ContactState) -> f64 {
    state.approach.unwrap_or_else(|| -state.mean_gap.unwrap())
}

/// A hardness between the mean pressure and the largest elastic one.
fn hardness_between(elastic: &ContactState, share: f64) -> f64 {
    elastic.force + share * (highest(elastic) - elastic.force)
}

/// Every certain contact cell of `small` is a contact cell of `large`.
fn nested(small: &ContactState, large: &ContactState) -> bool {
    let surely = SAME * highest(small);
    pressures(small).iter().zip(pressures(large)).all(|(small, large)| *small <= surely || *large > 0.0)
}

/// Checks the bounds of the pressure, the balance of the force, and the plastic part by its field.
fn sound(state: &ContactState, hardness: f64, cell: f64) -> Result<(), TestCaseError> {
    let p = pressures(state);
    prop_assert!(p.iter().all(|p| (0.0..=hardness * (1.0 + ROUNDING)).contains(p)), "{:?} {}", p, hardness);
    let sum = p.iter().sum::<f64>() * cell;
    prop_assert!((sum - state.force).abs() <= ROUNDING * state.force, "{} {}", sum, state.force);
    let plastic = state.plastic.unwrap();
    prop_assert!((plastic.dissipated - hardness * plastic.volume).abs() <= ROUNDING * plastic.dissipated);
    Ok(())
}

/// Elastic energy, half of the pressure times the displacement.
fn stored(state: &ContactState, cell: f64) -> f64 {
    let u = state.displacement().unwrap().values();
    0.5 * cell * pressures(state).iter().zip(u).map(|(p, u)| p * u).sum::<f64>()
}

proptest! {
    #![proptest_config(config(96))]

    /// Under a given force, a softer surface has more cells in contact, more saturated cells and a larger
    /// approach.
    #[test]
    fn a_softer_surface_gives_way(
        map in any_map(), boundary in boundary(), exponent in -2.0_f64..1.0, shares in (0.02_f64..0.5, 0.5_f64..0.98),
    ) {
        let scene = elastic(&map, boundary);
        let (load, cell) = (Load::force(10_f64.powf(exponent)), map.dx() * map.dx());
        let never_flows = solved(&scene, load);
        prop_assume!(highest(&never_flows) > 1.01 * never_flows.force);
        let mut harder = never_flows.clone();
        for share in [shares.1, shares.0] {
            let hardness = hardness_between(&never_flows, share);
            let state = solved(&with_hardness(&scene, hardness), load);
            sound(&state, hardness, cell)?;
            prop_assert!(nested(&harder, &state));
            prop_assert!(lowered(&state) >= lowered(&harder) - SAME, "{} {}", lowered(&state), lowered(&harder));
            let (plastic, before) = (state.plastic.unwrap(), harder.plastic.unwrap_or_default());
            prop_assert!(plastic.area > 0.0 && plastic.area >= before.area);
            prop_assert!(plastic.volume >= before.volume * (1.0 - SAME), "{:?} {:?}", plastic, before);
            harder = state;
        }
    }

    #[test]
    fn more_load_means_more_plastic_flow(
        map in any_map(), boundary in boundary(), exponent in -2.0_f64..0.5, share in 0.05_f64..0.95,
        ratios in prop::collection::vec(1.02_f64..1.6, 3),
    ) {
        let (scene, cell) = (elastic(&map, boundary), map.dx() * map.dx());
        let mut force = 10_f64.powf(exponent);
        let first = solved(&scene, Load::force(force));
        // The largest of the loads is carried too.
        let hardness = hardness_between(&first, share).max(1.01 * force * ratios.iter().product::<f64>());
        let scene = with_hardness(&scene, hardness);
        let mut contact = ContactModel::prepare(&model(), &scene, 0).unwrap();
        let mut before = contact.solve(Load::force(force)).unwrap();
        sound(&before, hardness, cell)?;
        for ratio in ratios {
            force *= ratio;
            let state = contact.solve(Load::force(force)).unwrap();
            sound(&state, hardness, cell)?;
            prop_assert!(nested(&before, &state) && lowered(&state) >= lowered(&before) - SAME);
            let (now, old) = (state.plastic.unwrap(), before.plastic.unwrap());
            prop_assert!(now.area >= old.area && now.volume >= old.volume * (1.0 - SAME), "{:?} {:?}", old, now);
            before = state;
        }
    }

    /// A hardness that no pressure reaches during the iteration does not change the bits of the elastic
    /// state; one above the pressures of the solution does not change the solution.
    #[test]
    fn a_hardness_that_is_not_reached_changes_nothing(
        map in any_map(), boundary in boundary(), exponent in -3.0_f64..1.5, above in 1e-6_f64..1.0,
    ) {
        let scene = elastic(&map, boundary);
        let load = Load::force(10_f64.powf(exponent));
        let expected = solved(&scene, load);
        let same_bits = solved(&with_hardness(&scene, 1e3 * highest(&expected)), load);
        prop_assert_eq!(same_bits.plastic, Some(PlasticState::default()));
        prop_assert_eq!(pressures(&same_bits), pressures(&expected));
        prop_assert_eq!((same_bits.approach, same_bits.area), (expected.approach, expected.area));
        prop_assert!((lowered(&same_bits) - lowered(&expected)).abs() <= ROUNDING * (1.0 + lowered(&expected).abs()));
        let near = solved(&with_hardness(&scene, (1.0 + above) * highest(&expected)), load);
        prop_assert_eq!(near.plastic, Some(PlasticState::default()));
        for (a, b) in pressures(&near).iter().zip(pressures(&expected)) {
            prop_assert!((a - b).abs() <= SAME * highest(&expected), "{} {}", a, b);
        }
    }

    /// Loading, unloading and loading again. In each step the work of the load lies between the lower and the
    /// higher force times the change of approach, and equals the stored and dissipated energy.
    #[test]
    fn a_loop_stores_and_dissipates_the_work(map in any_map(), deepest in 0.1_f64..1.5, share in 0.05_f64..0.9) {
        let (scene, cell) = (elastic(&map, Boundary::Free), map.dx() * map.dx());
        let hardness = share * highest(&solved(&scene, Load::approach(deepest)));
        let mut path = model().prepare(&with_hardness(&scene, hardness), 0).unwrap();
        let depths: Vec<f64> = (0..=3 * STEPS)
            .map(|i| deepest * (if i <= STEPS { i } else { i.abs_diff(2 * STEPS) }) as f64 / STEPS as f64)
            .collect();
        let states: Vec<ContactState> = depths[1..].iter().enumerate()
            .map(|(i, d)| path.advance(Step::new(i as f64, Load::approach(*d))).unwrap())
            .collect();
        let (mut force, mut energy, mut dissipated) = (0.0, 0.0, 0.0);
        for (state, d) in states.iter().zip(depths.windows(2)) {
            let plastic = state.plastic.unwrap();
            sound_or_unloaded(state, hardness, cell)?;
            let now = stored(state, cell) + plastic.dissipated;
            let (low, high) = ((d[1] - d[0]) * force, (d[1] - d[0]) * state.force);
            let slack = SAME * now.max(energy);
            prop_assert!(now - energy >= low.min(high) - slack && now - energy <= low.max(high) + slack,
                "{} {} {} {}", d[1], low, now - energy, high);
            prop_assert!(plastic.dissipated >= dissipated - slack);
            (force, energy, dissipated) = (state.force, now, plastic.dissipated);
        }
        let peak = &states[STEPS - 1];
        prop_assert!(peak.plastic.unwrap().dissipated > 0.0);
        // On the way down nothing flows, and on the way up again every state is met again.
        for i in 0..=STEPS {
            let (down, up) = (&states[STEPS - 1 + i], &states[3 * STEPS - 1 - i]);
            let same = |a: f64, b: f64, scale: f64| (a - b).abs() <= SAME * scale;
            prop_assert!(same(down.plastic.unwrap().volume, peak.plastic.unwrap().volume, peak.plastic.unwrap().volume));
            prop_assert!(same(down.force, up.force, peak.force), "{} {} {}", i, down.force, up.force);
            prop_assert!(pressures(down).iter().zip(pressures(up)).all(|(a, b)| same(*a, *b, hardness + map.dx().recip())));
        }
    }

    #[test]
    fn a_turned_map_flows_as_the_map_does(
        map in any_map(), symmetry in symmetry(), boundary in boundary(), exponent in -2.0_f64..1.0, share in 0.05_f64..0.95,
    ) {
        let (scene, load) = (elastic(&map, boundary), Load::force(10_f64.powf(exponent)));
        let hardness = hardness_between(&solved(&scene, load), share);
        let here = solved(&with_hardness(&scene, hardness), load);
        let there = solved(&with_hardness(&elastic(&turned(&map, symmetry), boundary), hardness), load);
        prop_assert!((lowered(&here) - lowered(&there)).abs() <= SAME * lowered(&here).abs().max(1.0));
        let field = HeightMap::new(map.columns(), 1.0, pressures(&here).to_vec()).unwrap();
        for (a, b) in turned(&field, symmetry).heights().iter().zip(pressures(&there)) {
            prop_assert!((a - b).abs() <= SAME * hardness, "{} {}", a, b);
        }
        let (here, there) = (here.plastic.unwrap(), there.plastic.unwrap());
        prop_assert!((here.volume - there.volume).abs() <= SAME * here.volume, "{:?} {:?}", here, there);
    }
}

/// [`sound`], or no contact at all.
fn sound_or_unloaded(state: &ContactState, hardness: f64, cell: f64) -> Result<(), TestCaseError> {
    if state.force > 0.0 {
        return sound(state, hardness, cell);
    }
    prop_assert!(pressures(state).iter().all(|p| *p <= 0.0));
    Ok(())
}

/// The strongest attraction that is accepted: `1.122 w dx/(E* range^2)` is a fifth.
fn strongest(map: &HeightMap, range: f64) -> f64 {
    0.178 * range * range / map.dx()
}

fn with_adhesion(scene: &Scene, work: f64, range: f64) -> Scene {
    let mut scene = scene.clone();
    scene.effects.adhesion = Adhesion::FiniteRange { work, range, law: AdhesionLaw::Exponential };
    scene
}

fn path(scene: &Scene) -> Box<dyn PreparedContact> {
    ContactModel::prepare(&model(), scene, 0).unwrap()
}

fn at(path: &mut dyn PreparedContact, d: f64) -> ContactState {
    path.advance(Step::new(0.0, Load::approach(d))).unwrap()
}

proptest! {
    #![proptest_config(config(64))]

    /// On the way back the contact and the attraction are at least as large, and the force is at most as
    /// large. Without hysteresis both branches are equal.
    #[test]
    fn withdrawal_has_more_contact_than_approach(
        map in any_map(), range in 0.05_f64..1.0, strength in 0.1_f64..0.99, deepest in -0.2_f64..0.8,
    ) {
        let scene = with_adhesion(&elastic(&map, Boundary::Free), strength * strongest(&map, range), range);
        let mut path = path(&scene);
        let start = -2.0 * range;
        let depths: Vec<f64> = (0..=STEPS).map(|i| start + (deepest - start).max(range) * i as f64 / STEPS as f64).collect();
        let rising: Vec<ContactState> = depths.iter().map(|d| at(&mut *path, *d)).collect();
        let falling: Vec<ContactState> = depths.iter().rev().skip(1).map(|d| at(&mut *path, *d)).collect();
        for pair in rising.windows(2) {
            prop_assert!(pair[1].report.contact_cells >= pair[0].report.contact_cells);
        }
        for (up, down) in rising.iter().rev().skip(1).zip(&falling) {
            let scale = up.force.abs().max(pressures(up).iter().map(|p| p.abs()).sum::<f64>() * map.dx() * map.dx());
            prop_assert!(down.report.contact_cells >= up.report.contact_cells);
            prop_assert!(down.force <= up.force + SAME * scale, "{} {}", down.force, up.force);
            for state in [up, down] {
                let sum = pressures(state).iter().sum::<f64>() * map.dx() * map.dx();
                prop_assert!((sum - state.force).abs() <= ROUNDING * scale);
                prop_assert!(state.adhesive.unwrap().stability > 0.0);
            }
        }
    }

    /// At an approach the attraction lowers the force, by no more than the largest traction on all cells, and
    /// the contact contains at least the elastic one; both differences vanish with the work of adhesion.
    #[test]
    fn a_small_attraction_has_a_small_effect(
        map in any_map(), range in 0.05_f64..1.0, exponent in -8.0_f64..0.0, d in 0.01_f64..1.0,
    ) {
        let scene = elastic(&map, Boundary::Free);
        let work = 10_f64.powf(exponent) * strongest(&map, range);
        let (without, attracted) = (solved(&scene, Load::approach(d)), solved(&with_adhesion(&scene, work, range), Load::approach(d)));
        let less = without.force - attracted.force;
        let slack = SAME * without.force;
        prop_assert!(less >= -slack && less <= work / range + slack, "{} {}", less, work / range);
        prop_assert!(attracted.report.contact_cells >= without.report.contact_cells);
        // The attraction raises no cell by more than the same traction on the whole square does in its
        // middle.
        let raised = 4.0 * (1.0 + 2_f64.sqrt()).ln() / std::f64::consts::PI * work / range;
        let closer = solved(&scene, Load::approach(d + raised * (1.0 + SAME)));
        prop_assert!(attracted.report.contact_cells <= closer.report.contact_cells);
    }

    /// Along a branch dE = F dd, of either direction; the energy of a step lies between those of its lower
    /// and its higher force.
    #[test]
    fn the_energy_is_the_work_along_a_branch(
        map in any_map(), range in 0.1_f64..1.0, strength in 0.05_f64..0.9, from in -1.5_f64..1.0, falls in any::<bool>(),
    ) {
        let scene = with_adhesion(&elastic(&map, Boundary::Free), strength * strongest(&map, range), range);
        let mut path = path(&scene);
        if falls {
            at(&mut *path, (from + 1.0) * range);
        }
        let step = if falls { -SMALL_STEP } else { SMALL_STEP } * range;
        let states = [0.0, 1.0, 2.0].map(|i| at(&mut *path, from * range + i * step));
        for pair in states.windows(2) {
            let (a, b) = (pair[0].force, pair[1].force);
            let [e0, e1] = [&pair[0], &pair[1]].map(|state| state.adhesive.unwrap().energy.unwrap());
            let slope = (e1 - e0) / step;
            let slack = ENERGY * (e0.abs() + e1.abs()) + SAME * (a.abs() + b.abs());
            prop_assert!(slope >= a.min(b) - slack && slope <= a.max(b) + slack, "{} {} {}", a, slope, b);
        }
    }

    /// A turned map on the way in and back.
    #[test]
    fn a_turned_map_sticks_as_the_map_does(
        map in any_map(), symmetry in symmetry(), range in 0.05_f64..1.0, strength in 0.1_f64..0.9, depths in (0.0_f64..0.8, 0.1_f64..2.0),
    ) {
        let both = [map.clone(), turned(&map, symmetry)].map(|map| {
            let mut path = path(&with_adhesion(&elastic(&map, Boundary::Free), strength * strongest(&map, range), range));
            [depths.0, depths.0 - depths.1 * range].map(|d| at(&mut *path, d))
        });
        for (here, there) in both[0].iter().zip(&both[1]) {
            let scale = pressures(here).iter().fold(strength * strongest(&map, range) / range, |m: f64, p| m.max(p.abs()));
            prop_assert_eq!(here.report.contact_cells, there.report.contact_cells);
            prop_assert!((here.force - there.force).abs() <= SAME * scale);
            let field = HeightMap::new(map.columns(), 1.0, pressures(here).to_vec()).unwrap();
            for (a, b) in turned(&field, symmetry).heights().iter().zip(pressures(there)) {
                prop_assert!((a - b).abs() <= SAME * scale, "{} {}", a, b);
            }
        }
    }
}
