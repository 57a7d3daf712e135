//! Laws of friction with a shear strength and a limit, with and without a hardness: paths of small contacts
//! compared with a dense reference implementation, Tresca's friction under a flat punch, and the limits in which
//! one law becomes another.

use bem3d::Bem3d;
use contact_model::{
    Adhesion, AdhesionLaw, Body, Boundary, ContactModel, ContactState, Coupling, Effects, Error, Friction,
    FrictionLaw, Hardness, HeightMap, Load, Outputs, Pair, Scene, Step, Surface, Tangential,
};
use std::collections::HashMap;
use std::f64::consts::PI;
use tests::rough_map;
use tests::stability::{DensePath, DenseSurface, PlainShear, PlainSum, Prescribed, compliance};

fn alike(poisson: f64) -> Pair {
    let body = Body::Elastic { young: 2.0 * (1.0 - poisson * poisson), poisson };
    Pair { first: body, second: body }
}

/// Numbers in [0, 1) of a seed.
struct Draw(u64);

impl Draw {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn index(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }
}

/// A random map of a few cells with heights up to this one, whether it is periodic, and the place of Poisson's ratio.
fn small_map(draw: &mut Draw, highest: f64) -> (HeightMap, bool, usize) {
    let (periodic, poisson) = (draw.index(2) == 1, draw.index(POISSONS.len()));
    let columns = 3 + draw.index(3);
    let rows = if periodic { columns } else { 2 + draw.index(4) };
    let heights: Vec<f64> = (0..columns * rows).map(|_| highest * draw.next()).collect();
    let map = HeightMap::new([columns, rows], [1.0, rows as f64 / columns as f64], heights).unwrap();
    (map, periodic, poisson)
}

/// Columns, rows, whether it is periodic, and the place of Poisson's ratio.
type GridKey = (usize, usize, bool, usize);
/// The normal kernel and its mean where it is periodic, and the tangential kernel.
type KernelsOfGrid = (PlainSum, f64, PlainShear);

/// Kernels of the grids, which periodic images make expensive.
#[derive(Default)]
struct Kernels(HashMap<GridKey, KernelsOfGrid>);

const POISSONS: [f64; 3] = [0.0, 0.3, 0.5];

impl Kernels {
    fn of(&mut self, map: &HeightMap, periodic: bool, poisson: usize) -> &KernelsOfGrid {
        self.0.entry((map.columns(), map.rows(), periodic, poisson)).or_insert_with(|| {
            let c = compliance(&alike(POISSONS[poisson])).unwrap();
            if periodic {
                let sum = PlainSum::periodic(map);
                let mean = sum.mean();
                (sum, mean, PlainShear::periodic(map, c))
            } else {
                (PlainSum::of(map), 0.0, PlainShear::of(map, c))
            }
        })
    }
}

/// Largest deviations over the paths, each relative to the largest value of its kind.
#[derive(Debug, Default)]
struct WorstDeviation {
    pressure: f64,
    traction: f64,
    displacement: f64,
    force: f64,
    dissipated: f64,
    indentation: f64,
    energy: f64,
    /// Scenes, steps, steps with cells at the hardness, cells that stuck and slipped.
    scenes: usize,
    steps: usize,
    flowing: usize,
    stick: usize,
    slip: usize,
    /// Paths that ended at a cell that rounding could bring into contact.
    undecided: usize,
}

/// A law of one of five kinds, for contacts of this mean pressure.
fn any_law(draw: &mut Draw, pressure: f64) -> FrictionLaw {
    let coefficient = draw.between(0.05, 1.0);
    let shear_strength = pressure * draw.between(0.05, 1.0);
    let kind = draw.index(5);
    let law = match kind {
        0 | 3 => FrictionLaw::coulomb(coefficient),
        1 => FrictionLaw::tresca(shear_strength),
        _ => FrictionLaw { coefficient, shear_strength, limit: None },
    };
    let limit = (kind >= 3).then(|| law.largest_traction(pressure) * draw.between(0.5, 1.5));
    FrictionLaw { limit, ..law }
}

/// A random contact, for the solver and for the dense reference.
struct RandomContact {
    scene: Scene,
    exact: DensePath,
    hardness: Option<f64>,
    /// Scale of the normal forces.
    force: f64,
    periodic: bool,
}

impl RandomContact {
    fn new(draw: &mut Draw, flows: bool, kernels: &mut Kernels) -> Self {
        let (map, periodic, poisson) = small_map(draw, 1.0);
        let area = map.dx() * map.dy();
        let force = 10_f64.powf(draw.between(-1.5, 0.3));
        let kernels = kernels.of(&map, periodic, poisson);
        let gaps: Vec<f64> = map.heights().iter().map(|h| map.highest() - h).collect();
        let dense = |law, hardness| DensePath::new(dense_surface(kernels, &map, gaps.clone()), law, hardness);
        // The pressures of the elastic contact give the scale of the law and of the hardness.
        let mut elastic = dense(FrictionLaw::coulomb(0.0), None);
        elastic.press(Prescribed::Force(force));
        let touching = elastic.pressed.iter().filter(|p| **p > 0.0).count();
        let (mean, largest) = (
            force / (touching as f64 * area),
            elastic.pressed.iter().fold(0.0, |a: f64, b| a.max(*b)) / area,
        );
        let least = force / (gaps.len() as f64 * area);
        let hardness = flows.then(|| (largest * draw.between(0.4, 1.2)).max(1.05 * least));
        let law = any_law(draw, mean);
        let exact = dense(law, hardness);
        let mut scene = Scene { pair: Some(alike(POISSONS[poisson])), ..tests::scene(map.clone()) };
        scene.effects = Effects {
            boundary: if periodic { Boundary::Periodic } else { Boundary::Free },
            hardness: hardness.map_or(Hardness::Off, |pressure| Hardness::Limit { pressure }),
            friction: Friction::of(law),
            ..Effects::default()
        };
        scene.outputs = Outputs {
            pressure: true,
            traction: true,
            stick_area: true,
            plastic_depth: flows,
            mean_gap: periodic,
            ..Outputs::default()
        };
        Self { scene, exact, hardness, force, periodic }
    }
}

/// A surface for the dense reference.
fn dense_surface<'a>(kernels: &'a KernelsOfGrid, map: &HeightMap, gaps: Vec<f64>) -> DenseSurface<'a> {
    let (normal, shift, shear) = kernels;
    DenseSurface { normal, shift: *shift, shear, gaps, area: map.dx() * map.dy() }
}

/// A tangential load below the sliding force.
fn tangential_load(draw: &mut Draw, sliding_force: f64) -> Prescribed<[f64; 2]> {
    let (share, (sin, cos)) = (draw.between(0.0, 0.9), draw.between(0.0, 2.0 * PI).sin_cos());
    if draw.index(2) == 0 {
        Prescribed::Force([share * sliding_force * cos, share * sliding_force * sin])
    } else {
        Prescribed::Displacement([2.0 * share * sliding_force * cos, 2.0 * share * sliding_force * sin])
    }
}

/// A step of a path, by the solver and by the reference.
struct PathStep<'a> {
    seed: u64,
    hardness: Option<f64>,
    state: &'a ContactState,
    exact: &'a DensePath,
    /// The reference at the end of the step before.
    before: Option<&'a DensePath>,
}

/// Follows one random path in both ways and notes the deviations.
fn follow(seed: u64, flows: bool, kernels: &mut Kernels, worst: &mut WorstDeviation) {
    let mut draw = Draw::new(seed);
    let RandomContact { scene, mut exact, hardness, force, periodic } =
        RandomContact::new(&mut draw, flows, kernels);
    let mut contact = Bem3d { tolerance: 1e-12, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
    worst.scenes += 1;
    let mut before: Option<DensePath> = None;
    let mut at = force;
    for leg in 0..4 {
        let cells = exact.pressed.len() as f64;
        let capacity = hardness.map_or(f64::INFINITY, |hardness| hardness * cells * exact.cell_area());
        if leg > 0 && draw.index(3) > 0 {
            at = (force * draw.between(0.3, 1.6)).min(0.95 * capacity);
        }
        let by_approach = !periodic && draw.index(3) == 0;
        exact.press(Prescribed::Force(at));
        if exact.decided < 1e-6 {
            worst.undecided += 1;
            return;
        }
        let load = tangential_load(&mut draw, exact.limits().iter().sum());
        exact.slide(load);
        let normal = if by_approach { Load::approach(exact.approach) } else { Load::force(at) };
        let tangential = match load {
            Prescribed::Force(force) => Tangential::Force(force),
            Prescribed::Displacement(displacement) => Tangential::Displacement(displacement),
        };
        let state = contact
            .advance(Step::new(0.0, normal.with_tangential(tangential)))
            .unwrap_or_else(|error| panic!("{seed} {leg}: {error}"));
        let step = PathStep { seed, hardness, state: &state, exact: &exact, before: before.as_ref() };
        note(worst, &step);
        balance(worst, &step);
        before = Some(exact.clone());
    }
}

/// Notes the deviations of a state.
fn note(worst: &mut WorstDeviation, step: &PathStep<'_>) {
    let PathStep { seed, state, exact, .. } = *step;
    let area = exact.cell_area();
    let found = state.tangential.unwrap();
    let fields = state.fields.as_ref().unwrap();
    let n = exact.pressed.len();
    let compare = |worst: &mut f64, found: &[f64], exact: &[f64], scale: f64, what: &str, bound: f64| {
        let off = found.iter().zip(exact).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
        let off = if off > 0.0 { off / scale } else { 0.0 };
        assert!(off <= bound, "{seed}: {what} {off:e}: {found:?} {exact:?}");
        *worst = worst.max(off);
    };
    let p: Vec<f64> = fields.pressure.as_ref().unwrap().values().iter().map(|p| p * area).collect();
    let largest = exact.pressed.iter().fold(0.0, |a: f64, b| a.max(*b));
    compare(&mut worst.pressure, &p, &exact.pressed, largest, "pressure", 1e-7);
    let [x, y] = fields.traction.as_ref().unwrap();
    let q: Vec<f64> = x.values().iter().chain(y.values()).map(|q| q * area).collect();
    let limits = exact.limits();
    let largest = limits.iter().fold(0.0, |a: f64, b| a.max(*b));
    compare(&mut worst.traction, &q, &exact.sheared, largest, "traction", 1e-4);
    let most: f64 = limits.iter().sum();
    compare(&mut worst.force, &found.force, &exact.force(), most, "force", 1e-5);
    compare(&mut worst.force, &[found.sliding_force.unwrap()], &[most], most, "sliding force", 1e-8);
    // The displacement at which all of it would slip is of the order of the sliding force.
    let reach = exact.displacement[0].hypot(exact.displacement[1]).max(most);
    compare(&mut worst.displacement, &found.displacement, &exact.displacement, reach, "displacement", 1e-5);
    let work = most * reach + exact.dissipated;
    compare(&mut worst.dissipated, &[found.dissipated], &[exact.dissipated], work, "dissipated", 1e-5);
    if let Some(depth) = &fields.plastic_depth {
        let deepest = exact.indentation.iter().fold(exact.approach.abs(), |a: f64, b| a.max(*b));
        compare(&mut worst.indentation, depth.values(), &exact.indentation, deepest, "indentation", 1e-7);
        worst.flowing += usize::from(state.plastic.unwrap().area > 0.0);
    }
    worst.steps += 1;
    for i in (0..n).filter(|&i| exact.pressed[i] > 0.0) {
        let sticks = exact.sheared[i].hypot(exact.sheared[n + i]) < (1.0 - 1e-9) * limits[i];
        *(if sticks { &mut worst.stick } else { &mut worst.slip }) += 1;
    }
}

/// The work of both loads is stored, dissipated by friction, or done on the indentation. With the loads at the end of
/// a step it also holds half the product of its changes, and what the pressures did across the gaps that closed.
fn balance(worst: &mut WorstDeviation, step: &PathStep<'_>) {
    let PathStep { seed, hardness, state, exact, before } = *step;
    let found = state.tangential.unwrap();
    let Some(before) = before else { return };
    // The loads of the solver, and its indentation; energies of the reference.
    let moved = [0, 1].map(|k| found.displacement[k] - before.displacement[k]);
    let work = found.force[0] * moved[0] + found.force[1] * moved[1];
    let [stored, sheared] = exact.energies();
    let [stored_before, sheared_before] = before.energies();
    let mut change = exact.clone();
    for (a, b) in [(&mut change.pressed, &before.pressed), (&mut change.sheared, &before.sheared)] {
        a.iter_mut().zip(b).for_each(|(a, b)| *a -= b);
    }
    let [excess, sheared_excess] = change.energies();
    let dissipated = found.dissipated - before.dissipated;
    let expected = dissipated + sheared - sheared_before + sheared_excess;
    // Beside the work of sliding where nothing moves.
    let least = 1e-6 * found.sliding_force.unwrap().powi(2);
    let scale = work.abs() + sheared + sheared_before + dissipated.abs() + least;
    let off = (work - expected).abs() / scale;
    assert!(off <= 1e-5, "{seed}: tangential work {work} {expected}");
    worst.energy = worst.energy.max(off);
    let (Some(hardness), Some(plastic), Some(approach)) = (hardness, state.plastic, state.approach) else {
        return;
    };
    let work = state.force * (approach - before.approach);
    let closed: f64 = exact.pressed.iter().zip(before.open_gaps()).map(|(p, gap)| p * gap).sum();
    let volume = plastic.volume - before.indentation.iter().sum::<f64>() * exact.cell_area();
    let expected = stored - stored_before + excess + hardness * volume + closed;
    let scale = work.abs() + stored + stored_before + hardness * plastic.volume;
    let off = (work - expected).abs() / scale;
    assert!(off <= 1e-6, "{seed}: normal work {work} {expected}");
    worst.energy = worst.energy.max(off);
}

#[test]
fn paths_under_any_law_are_those_of_the_dense_reference() {
    let (mut kernels, mut worst) = (Kernels::default(), WorstDeviation::default());
    for seed in 1..=400 {
        follow(seed, false, &mut kernels, &mut worst);
    }
    println!("{worst:?}");
    assert!(worst.steps > 1200 && worst.stick > 1000 && worst.slip > 1000, "{worst:?}");
}

/// The largest deviation of a traction, over the largest limit.
fn traction_error(state: &ContactState, exact: &DensePath, area: f64) -> f64 {
    let [x, y] = state.fields.as_ref().unwrap().traction.as_ref().unwrap();
    let found = x.values().iter().chain(y.values()).map(|q| q * area);
    let off = found.zip(&exact.sheared).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
    let largest = exact.limits().iter().fold(0.0, |a: f64, b| a.max(*b));
    if off > 0.0 { off / largest } else { 0.0 }
}

/// Numbers of cells of the reference that stick and slip.
fn sticking_and_slipping(exact: &DensePath) -> [usize; 2] {
    let (limits, n) = (exact.limits(), exact.pressed.len());
    let held = |i: &usize| exact.sheared[*i].hypot(exact.sheared[n + i]) < (1.0 - 1e-9) * limits[*i];
    let (stick, slip): (Vec<usize>, Vec<usize>) = (0..n).filter(|&i| limits[i] > 0.0).partition(held);
    [stick.len(), slip.len()]
}

/// Friction under adhesion of finite range: the reference has the contact pressures of the solver, which other tests
/// compare, and solves for the tractions.
#[test]
fn friction_with_adhesion_is_that_of_the_dense_reference() {
    let (mut kernels, mut worst) = (Kernels::default(), 0.0_f64);
    let (mut steps, mut pulled, mut stick, mut slip) = (0, 0, 0, 0);
    for seed in 2001..=2400 {
        let mut draw = Draw::new(seed);
        let (map, periodic, poisson) = small_map(&mut draw, 0.1);
        let (area, n) = (map.dx() * map.dy(), map.heights().len());
        let range = draw.between(0.02, 0.05);
        // At most what the cells resolve.
        let work = draw.between(0.1, 1.0) * 0.12 * range * range / map.dx();
        let (peak, force) = (work / range, 10_f64.powf(draw.between(-2.5, -1.0)));
        let law = any_law(&mut draw, peak + force);
        let surface = dense_surface(kernels.of(&map, periodic, poisson), &map, vec![0.0; n]);
        let mut exact = DensePath::new(surface, law, None);
        let mut scene = Scene { pair: Some(alike(POISSONS[poisson])), ..tests::scene(map.clone()) };
        scene.effects = Effects {
            boundary: if periodic { Boundary::Periodic } else { Boundary::Free },
            adhesion: Adhesion::FiniteRange {
                work,
                range,
                law: if draw.index(2) == 0 { AdhesionLaw::Dugdale } else { AdhesionLaw::Exponential },
            },
            friction: Friction::of(law),
            ..Effects::default()
        };
        scene.outputs = Outputs { pressure: true, gap: true, traction: true, ..Outputs::default() };
        let mut contact = Bem3d { tolerance: 1e-11, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
        for leg in 0..4 {
            // The last normal load pulls.
            let at = if leg == 3 { -0.2 * peak * area } else { force * draw.between(0.3, 1.0) };
            let (sin, cos) = draw.between(0.0, 2.0 * PI).sin_cos();
            let far = 0.3 * draw.next().powi(2) * (peak + force);
            let delta = [far * cos, far * sin];
            let load = Load::force(at).with_tangential(Tangential::Displacement(delta));
            let Ok(state) = contact.advance(Step::new(0.0, load)) else {
                assert!(leg == 3, "{seed} {leg}");
                break;
            };
            let net = state.pressure().unwrap().values();
            let gaps = state.gap().unwrap().values();
            let closed = |i: usize| gaps[i] < 1e-9 && net[i] + peak > 1e-7 * peak;
            exact.pressed = (0..n).map(|i| if closed(i) { (net[i] + peak) * area } else { 0.0 }).collect();
            exact.slide(Prescribed::Displacement(delta));
            let off = traction_error(&state, &exact, area);
            assert!(off <= 1e-4, "{seed} {leg}: {off}");
            worst = worst.max(off);
            (steps, pulled) = (steps + 1, pulled + usize::from(at < 0.0));
            let [sticking, slipping] = sticking_and_slipping(&exact);
            (stick, slip) = (stick + sticking, slip + slipping);
        }
    }
    println!("{steps} steps, {pulled} pulled, {stick} stick, {slip} slip, worst {worst:.1e}");
    assert!(steps > 1200 && pulled > 100 && stick > 1000 && slip > 1000);
}

/// The share of the work of adhesion that a cell of this gap still holds with a short range; see
/// `bem3d/src/adhesion/attraction.rs` for the law. E* = 1.
fn attached(gap: f64, work: f64, side: f64) -> f64 {
    let range = 15.0 / 8.0 * work / (0.59 * (work / side).sqrt());
    let y = (1.0 - gap / range).clamp(0.0, 1.0);
    // The law y (0.4 + 2.2 y - 1.6 y^2), integrated.
    15.0 / 8.0 * (0.2 * y.powi(2) + 2.2 / 3.0 * y.powi(3) - 0.4 * y.powi(4))
}

/// A shear strength under adhesion of short range holds the attached share of each cell: the reference has the shares
/// of the solver's gaps, and solves for the tractions.
#[test]
fn a_shear_strength_on_attached_shares_is_that_of_the_dense_reference() {
    let (mut kernels, mut worst) = (Kernels::default(), 0.0_f64);
    let (mut steps, mut pulled, mut partly, mut stick, mut slip) = (0, 0, 0, 0, 0);
    for seed in 3001..=3400 {
        let mut draw = Draw::new(seed);
        let (map, periodic, poisson) = small_map(&mut draw, 0.1);
        let (area, n, side) = (map.dx() * map.dy(), map.heights().len(), map.dx().max(map.dy()));
        let work = 10_f64.powf(draw.between(-5.0, -3.0));
        let (strength, force) =
            (10_f64.powf(draw.between(-2.5, -0.5)), 10_f64.powf(draw.between(-2.5, -1.0)));
        let surface = dense_surface(kernels.of(&map, periodic, poisson), &map, vec![0.0; n]);
        let mut exact = DensePath::new(surface, FrictionLaw::coulomb(strength), None);
        let mut scene = Scene { pair: Some(alike(POISSONS[poisson])), ..tests::scene(map.clone()) };
        scene.effects = Effects {
            boundary: if periodic { Boundary::Periodic } else { Boundary::Free },
            adhesion: Adhesion::ShortRange { work },
            friction: Friction::tresca(strength),
            ..Effects::default()
        };
        scene.outputs =
            Outputs { gap: true, traction: true, area: true, stick_area: true, ..Outputs::default() };
        let mut contact = Bem3d { tolerance: 1e-11, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
        for leg in 0..4 {
            // The last normal load pulls.
            let at = if leg == 3 { -0.3 * work } else { force * draw.between(0.3, 1.0) };
            let (sin, cos) = draw.between(0.0, 2.0 * PI).sin_cos();
            let far = 0.3 * draw.next().powi(2) * strength;
            let delta = [far * cos, far * sin];
            let load = Load::force(at).with_tangential(Tangential::Displacement(delta));
            let Ok(state) = contact.advance(Step::new(0.0, load)) else {
                assert!(leg == 3, "{seed} {leg}");
                break;
            };
            let gaps = state.gap().unwrap().values();
            exact.pressed = gaps.iter().map(|gap| attached(*gap, work, side) * area).collect();
            partly += exact.pressed.iter().filter(|share| **share > 0.0 && **share < area).count();
            exact.slide(Prescribed::Displacement(delta));
            let off = traction_error(&state, &exact, area);
            assert!(off <= 1e-4, "{seed} {leg}: {off}");
            worst = worst.max(off);
            // What slides is the strength times the contact area, of which a part sticks.
            let tangential = state.tangential.unwrap();
            let slides = tangential.sliding_force.unwrap();
            assert!((slides - strength * state.area.unwrap()).abs() <= 1e-9 * slides, "{seed} {leg}");
            let parts = tangential.stick_area.unwrap() + tangential.slip_area.unwrap();
            assert!((parts - state.area.unwrap()).abs() <= 1e-9 * parts, "{seed} {leg}");
            (steps, pulled) = (steps + 1, pulled + usize::from(at < 0.0));
            let [sticking, slipping] = sticking_and_slipping(&exact);
            (stick, slip) = (stick + sticking, slip + slipping);
        }
    }
    println!(
        "{steps} steps, {pulled} pulled, {partly} partly attached, {stick} stick, {slip} slip, worst {worst:.1e}"
    );
    assert!(steps > 1200 && pulled > 100 && partly > 500 && stick > 1000 && slip > 1000);
}

#[test]
fn friction_with_a_hardness_is_that_of_the_dense_reference() {
    let (mut kernels, mut worst) = (Kernels::default(), WorstDeviation::default());
    for seed in 1001..=1400 {
        follow(seed, true, &mut kernels, &mut worst);
    }
    println!("{worst:?}");
    assert!(
        worst.steps > 1200 && worst.flowing > 800 && worst.stick > 1000 && worst.slip > 1000,
        "{worst:?}"
    );
}

/// The errors of the force and of the share that sticks under a flat punch that has moved until the ring outside of
/// c slips, by Tresca's law.
///
/// Without a Poisson's ratio the tangential problem is the normal one: the traction tau on the ring has the line load
/// `2 tau sqrt(a^2 - x^2)` (Abel), which is constant, `G* delta`, within c. So `delta = 2 tau sqrt(a^2 - c^2)/G*`, and
/// the integral of the line load is `T = 2 tau (a^2 acos(c/a) + c sqrt(a^2 - c^2))`. At c = a the punch sticks, with
/// the stiffness `2 G* a`; at c = 0 it slides at `pi tau a^2`.
fn under_a_punch(cells: usize, stick: f64) -> [f64; 4] {
    let (tau, pair) = (3e-4, alike(0.0));
    let surface = Surface::FlatCircle { radius: 0.4, size: 1.0.into() };
    let mut scene = Scene::of_pair(surface, pair).unwrap();
    scene.effects.friction = Friction::tresca(tau);
    scene.outputs =
        Outputs { area: true, stick_area: true, tangential_stiffness_stuck: true, ..Outputs::default() };
    let mut contact = Bem3d { cells, tolerance: 1e-9, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
    // The radius of the cells of the punch.
    let first = contact.advance(Step::new(0.0, Load::force(1e-3))).unwrap();
    let a = (first.area.unwrap() / PI).sqrt();
    let (shear, c) = (pair.shear_modulus().unwrap(), stick * a);
    let root = (a * a - c * c).sqrt();
    let delta = 2.0 * tau * root / shear;
    let step = Step::new(0.0, Load::force(1e-3).with_tangential(Tangential::Displacement([0.0, -delta])));
    let found = contact.advance(step).unwrap().tangential.unwrap();
    let force = 2.0 * tau * (a * a * stick.acos() + c * root);
    [
        -found.force[1] / force - 1.0,
        found.stick_area.unwrap() / (PI * c * c) - 1.0,
        found.sliding_force.unwrap() / (PI * tau * a * a) - 1.0,
        found.stiffness_stuck.unwrap()[1][1] / (2.0 * shear * a) - 1.0,
    ]
}

#[test]
fn tresca_under_a_flat_punch_is_the_closed_form() {
    for stick in [0.9, 0.6, 0.3] {
        let mut errors = Vec::new();
        for cells in [33, 65, 129] {
            let [force, area, sliding, stiffness] = under_a_punch(cells, stick);
            println!(
                "c/a {stick} N {cells}: force {force:.1e}, stick area {area:.1e}, stiffness {stiffness:.1e}"
            );
            // By the cells of the same area.
            assert!(sliding.abs() < 1e-12, "{sliding}");
            errors.push([force.abs(), area.abs(), stiffness.abs()]);
        }
        let [coarse, _, fine] = errors[..] else { panic!() };
        assert!(fine[0] < 2e-3 && fine[1] < 0.03 && fine[2] < 0.01, "{fine:?}");
        assert!(fine[0] < 0.5 * coarse[0] && fine[2] < 0.5 * coarse[2], "{coarse:?} {fine:?}");
    }
}

/// A rough surface with friction and perhaps a hardness, loaded, dragged, unloaded.
fn rough_path(law: FrictionLaw, hardness: Option<f64>, boundary: Boundary) -> Vec<ContactState> {
    let mut scene = Scene { pair: Some(alike(0.3)), ..tests::scene(rough_map(2.3, 24, 3).unwrap()) };
    scene.effects = Effects {
        boundary,
        hardness: hardness.map_or(Hardness::Off, |pressure| Hardness::Limit { pressure }),
        friction: Friction::of(law),
        ..Effects::default()
    };
    scene.outputs = Outputs { pressure: true, traction: true, slip: true, ..Outputs::default() };
    let mut contact = Bem3d { tolerance: 1e-9, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
    let path = [
        (0.2, [0.0, 0.0]),
        (0.2, [0.04, 0.0]),
        (0.4, [0.05, 0.03]),
        (0.3, [-0.03, 0.02]),
        (0.1, [0.0, 0.01]),
    ];
    path.iter()
        .map(|&(force, tangential)| {
            let load = Load::force(force).with_tangential(Tangential::Force(tangential));
            contact.advance(Step::new(0.0, load)).unwrap()
        })
        .collect()
}

/// Every number of a path by its bits.
fn bits(states: &[ContactState]) -> Vec<u64> {
    let numbers = |state: &ContactState| {
        let (found, fields) = (state.tangential.unwrap(), state.fields.as_ref().unwrap());
        let [x, y] = fields.traction.as_ref().unwrap();
        let [sx, sy] = fields.slip.as_ref().unwrap();
        let maps = [fields.pressure.as_ref().unwrap(), x, y, sx, sy];
        let scalars =
            [found.displacement[0], found.displacement[1], found.dissipated, state.approach.unwrap_or(0.0)];
        maps.into_iter()
            .flat_map(|map| map.values().to_vec())
            .chain(scalars)
            .map(f64::to_bits)
            .collect::<Vec<_>>()
    };
    states.iter().flat_map(numbers).collect()
}

#[test]
fn laws_become_one_another_in_their_limits() {
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let coulomb = FrictionLaw::coulomb(0.4);
        let expected = bits(&rough_path(coulomb, None, boundary));
        // A limit that nothing reaches, a strength that adds nothing, and a hardness beyond all pressures.
        for (law, hardness) in [
            (FrictionLaw { limit: Some(1e9), ..coulomb }, None),
            (FrictionLaw { shear_strength: 1e-300, limit: Some(1e9), ..coulomb }, None),
            (coulomb, Some(1e9)),
        ] {
            assert_eq!(
                bits(&rough_path(law, hardness, boundary)),
                expected,
                "{law:?} {hardness:?} {boundary:?}"
            );
        }
        // A limit below every other traction is Tresca's law.
        let capped = FrictionLaw { coefficient: 1e9, shear_strength: 1.0, limit: Some(1.0) };
        let tresca = bits(&rough_path(FrictionLaw::tresca(1.0), None, boundary));
        assert_eq!(bits(&rough_path(capped, None, boundary)), tresca);
        // A large strength sticks, as a large coefficient does; only cells without pressure differ.
        let stuck =
            [FrictionLaw::tresca(1e6), FrictionLaw::coulomb(1e9)].map(|law| rough_path(law, None, boundary));
        for (a, b) in stuck[0].iter().zip(&stuck[1]) {
            let (a, b) = (a.tangential.unwrap(), b.tangential.unwrap());
            for k in 0..2 {
                let size = a.displacement[0].hypot(a.displacement[1]);
                assert!((a.displacement[k] - b.displacement[k]).abs() <= 1e-3 * size, "{a:?} {b:?}");
            }
        }
    }
}

/// A force beyond the strength of all cells in contact is refused with the sliding force.
#[test]
fn the_sliding_force_is_the_sum_of_the_largest_tractions() {
    let law = FrictionLaw { coefficient: 0.3, shear_strength: 0.2, limit: Some(1.0) };
    let (map, pair) = (rough_map(2.3, 24, 3).unwrap(), alike(0.3));
    let area = map.dx() * map.dy();
    for hardness in [None, Some(4.0)] {
        let mut scene = Scene { pair: Some(pair), ..tests::scene(map.clone()) };
        scene.effects.friction = Friction::of(law);
        scene.effects.hardness = hardness.map_or(Hardness::Off, |pressure| Hardness::Limit { pressure });
        scene.outputs = Outputs { pressure: true, ..Outputs::default() };
        let mut contact = Bem3d::default().prepare(&scene, 0).unwrap();
        let state = contact.advance(Step::new(0.0, Load::force(0.3))).unwrap();
        let p = state.pressure().unwrap().values();
        let of_cells: f64 = p.iter().filter(|p| **p > 0.0).map(|&p| law.largest_traction(p) * area).sum();
        let sliding = state.tangential.unwrap().sliding_force.unwrap();
        assert!((sliding / of_cells - 1.0).abs() < 1e-12, "{sliding} {of_cells}");
        let beyond = Load::force(0.3).with_tangential(Tangential::Force([0.0, 1.01 * sliding]));
        let refused = contact.advance(Step::new(0.0, beyond)).unwrap_err();
        assert!(
            matches!(refused, Error::OutOfRange { max, .. } if (max / sliding - 1.0).abs() < 1e-9),
            "{refused}"
        );
    }
}

/// Every number of a law that makes no sense is named, and so are models and effects that do not go with it.
#[test]
fn laws_that_make_no_sense_or_are_not_solved_are_refused() {
    let sphere = Surface::Sphere { radius: 1.0, size: 0.5.into() };
    let scene = |friction| {
        let mut scene = Scene::of_pair(sphere.clone(), alike(0.3)).unwrap();
        scene.effects.friction = friction;
        scene
    };
    let model = Bem3d { cells: 9, ..Bem3d::default() };
    let refused = |model: &dyn ContactModel, friction| {
        model.prepare(&scene(friction), 0).map(|_| ()).unwrap_err().to_string()
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
        let strength = refused(&model, Friction::tresca(bad));
        assert!(strength.starts_with(&format!("shear strength of friction = {bad}:")), "{strength}");
        let law = FrictionLaw { limit: Some(bad), ..FrictionLaw::coulomb(0.3) };
        let limit = refused(&model, Friction::of(law));
        assert!(limit.starts_with(&format!("limit of friction = {bad}:")), "{limit}");
    }
    let none = FrictionLaw { limit: Some(0.0), ..FrictionLaw::coulomb(0.3) };
    assert!(refused(&model, Friction::of(none)).starts_with("limit of friction = 0:"));
    // A strength that is no number in the units of the surface.
    let large = refused(&model, Friction::tresca(f64::MAX));
    assert!(large.starts_with("shear strength of friction = ") && large.contains("nearer to E*"), "{large}");
    let limited = Friction::of(FrictionLaw { limit: Some(0.1), ..FrictionLaw::coulomb(0.3) });
    let equivalent = mdr1d::Equivalent::new(model);
    let others: [&dyn ContactModel; 3] = [&mdr1d::PartialSlip, &equivalent, &analytic::CattaneoMindlin];
    for other in others {
        assert!(other.prepare(&scene(Friction::coulomb(0.3)), 0).is_ok());
        let text = refused(other, Friction::tresca(0.1));
        assert!(text.contains(other.name()) && text.contains("shear strength"), "{text}");
        let text = refused(other, limited);
        assert!(text.contains(other.name()) && text.contains("limit of the traction"), "{text}");
    }
    let text = refused(&model, Friction::tresca(0.1).with_coupling(Some(Coupling::Full)));
    assert!(text.contains("together with") && text.contains("vanishing pressure"), "{text}");
    assert!(model.prepare(&scene(limited.with_coupling(Some(Coupling::Full))), 0).is_ok());
    let mut flows = scene(Friction::coulomb(0.3).with_coupling(Some(Coupling::Full)));
    flows.effects.hardness = Hardness::Limit { pressure: 0.1 };
    let text = model.prepare(&flows, 0).map(|_| ()).unwrap_err().to_string();
    assert!(text.contains("a hardness together with") && text.contains("not solved"), "{text}");
}
