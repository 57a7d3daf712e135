//! Adhesion of short range on a grid compared with closed forms: the sphere of JKR, the wavy sphere of
//! Guduru, Kendall's punch and Johnson's wave.

use analytic::adhesive_wave::WavyContact;
use analytic::jkr::AdhesiveSphere;
use bem3d::Bem3d;
use contact_model::{
    Adhesion, Boundary, Branch, Cells, ContactModel, ContactState, Error, HeightMap, Load, PreparedContact,
    Scene, Size, Step, Surface,
};
use std::f64::consts::PI;
use std::sync::Arc;

const WORK: f64 = 1e-4;

fn scene(map: HeightMap) -> Scene {
    let mut scene = Scene::new(Surface::Heights(Arc::new(map)), 1.0);
    scene.effects.adhesion = Adhesion::ShortRange { work: WORK };
    scene.outputs.area = true;
    scene.outputs.stiffness = false;
    scene
}

fn path(scene: &Scene) -> Box<dyn PreparedContact> {
    Bem3d { tolerance: 1e-6, ..Bem3d::default() }.prepare(scene, 0).unwrap()
}

fn at(history: &mut dyn PreparedContact, load: Load) -> Result<ContactState, Error> {
    history.advance(Step::new(0.0, load))
}

/// Contact radius of a sphere R = E* = 1 without load.
fn unloaded_radius() -> f64 {
    (4.5 * PI * WORK).cbrt()
}

/// Positions of a centre on the grid, in cells; the first one has none of the symmetries of the grid.
const PLACES: [(f64, f64); 4] = [(0.19, 0.37), (0.0, 0.0), (0.5, 0.25), (0.5, 0.5)];

/// That sphere on cells with sides `(side, side/oblong)`, `cells` of the longer ones in its radius without
/// load, its centre at a place on the grid.
fn sphere(cells: f64, oblong: usize, place: (f64, f64)) -> Scene {
    let dx = unloaded_radius() / cells;
    let dy = dx / oblong as f64;
    let n = (2.6 * cells).ceil() as usize;
    let size = Size { x: n as f64 * dx, y: n as f64 * dx };
    let map = HeightMap::from_fn(Cells { columns: n, rows: n * oblong }, size, |i, j| {
        let (x, y) = (
            dx * (i as f64 - 0.5 * n as f64 + place.0),
            dy * (j as f64 - 0.5 * (n * oblong) as f64 + place.1),
        );
        -0.5 * (x * x + y * y)
    });
    scene(map.unwrap())
}

/// Pull-off force over that of JKR, found by withdrawing in steps around it.
fn pull_off(scene: &Scene) -> f64 {
    let exact = AdhesiveSphere::new(1.0, 1.0, WORK).unwrap().pull_off_at_force().unwrap();
    let mut history = path(scene);
    let unloaded = unloaded_radius().powi(2) / 3.0;
    at(&mut *history, Load::approach(unloaded)).unwrap();
    (0..16)
        .map(|i| exact.approach * (0.4 + 0.08 * f64::from(i)))
        .map(|d| at(&mut *history, Load::approach(d)).unwrap().force / exact.force)
        .fold(0.0, f64::max)
}

#[test]
fn a_sphere_is_pulled_off_by_one_and_a_half_pi_w_r_wherever_it_lies() {
    // Second order in the cell over the radius at pull-off, 0.63 of that without load.
    for (cells, error) in [(8.0, 0.03), (16.0, 0.01), (32.0, 0.0025)] {
        for place in PLACES {
            let found = pull_off(&sphere(cells, 1, place));
            assert!((found - 1.0).abs() < error, "{cells} {place:?}: {found}");
        }
    }
}

#[test]
fn oblong_cells_have_the_same_pull_off_force() {
    for oblong in [2, 3] {
        let found = pull_off(&sphere(12.0, oblong, PLACES[0]));
        assert!((found - 1.0).abs() < 0.012, "{oblong}: {found}");
    }
}

#[test]
fn both_branches_of_a_sphere_are_jkr() {
    /// Forces over the pull-off force, radii and stiffnesses relative: cells of 1/20 of the radius.
    const SAME: f64 = 0.01;
    let exact = AdhesiveSphere::new(1.0, 1.0, WORK).unwrap();
    let unit = exact.pull_off_at_force().unwrap().force.abs();
    let unloaded = unloaded_radius().powi(2) / 3.0;
    let mut scene = sphere(20.0, 1, PLACES[0]);
    scene.outputs.stiffness_fixed_area = true;
    let mut history = path(&scene);
    let compare = |state: &ContactState, d: f64| {
        let radius = exact.radius_at_approach(d).unwrap();
        let force = exact.force(radius).unwrap();
        assert!((state.force - force).abs() < SAME * unit, "{d}: {} {force}", state.force);
        approx::assert_relative_eq!((state.area.unwrap() / PI).sqrt(), radius, max_relative = SAME);
        approx::assert_relative_eq!(state.stiffness_fixed_area.unwrap(), 2.0 * radius, max_relative = SAME);
        let adhesive = state.adhesive.unwrap();
        assert!(adhesive.stability > 0.0 && state.report.certificate.meets(1e-6));
        adhesive.branch
    };
    // It snaps in at first touch, and goes along the same curve both ways but for that.
    let apart = at(&mut *history, Load::approach(-0.9 * unloaded)).unwrap();
    assert!(apart.force.abs() < 1e-12 * unit && apart.area == Some(0.0));
    for d in [0.1, 0.5, 1.0, 2.0] {
        let state = at(&mut *history, Load::approach(d * unloaded)).unwrap();
        assert_eq!(compare(&state, d * unloaded), Branch::Approach);
    }
    let mut loss = 0.0;
    for d in [1.5, 1.0, 0.5, 0.1, -0.2, -0.4, -0.6] {
        let state = at(&mut *history, Load::approach(d * unloaded)).unwrap();
        assert_eq!(compare(&state, d * unloaded), Branch::Withdrawal);
        loss = state.force;
    }
    // Where it hung apart on the way in it holds on the way out.
    assert!(loss < -0.5 * unit);
    let off =
        at(&mut *history, Load::approach(1.2 * exact.pull_off_at_approach().unwrap().approach)).unwrap();
    assert!(off.force.abs() < 1e-12 * unit && off.area == Some(0.0));
}

#[test]
fn a_force_beyond_the_pull_off_is_an_error_with_the_last_state() {
    let exact = AdhesiveSphere::new(1.0, 1.0, WORK).unwrap();
    let unit = exact.pull_off_at_force().unwrap().force;
    let mut history = path(&sphere(16.0, 1, PLACES[0]));
    let held: Vec<ContactState> = [-1.0, 0.0, 0.5, 0.9, 0.96]
        .iter()
        .map(|f| at(&mut *history, Load::force(f * unit)).unwrap())
        .collect();
    for (state, f) in held.iter().zip([-1.0, 0.0, 0.5, 0.9, 0.96]) {
        let radius = exact.radius_at_force(f * unit).unwrap();
        // Near the pull-off the radius falls with the root of what is left of the force.
        approx::assert_relative_eq!((state.area.unwrap() / PI).sqrt(), radius, max_relative = 0.03);
    }
    let Err(Error::NotConverged { best }) = at(&mut *history, Load::force(1.03 * unit)) else {
        panic!("a force that nothing holds")
    };
    assert_eq!(best.force.to_bits(), held[4].force.to_bits());
    assert!(best.report.strategy.contains("pull-off"), "{}", best.report.strategy);
    // The path stands where it stood.
    let again = at(&mut *history, Load::force(0.9 * unit)).unwrap();
    assert!((again.area.unwrap() / held[3].area.unwrap() - 1.0).abs() < 0.03);
}

/// A sphere (R = E* = 1) with rings of waves, `z = r^2/2 + A (1 - cos(2 pi r/l))`, in contact within one
/// circle: Guduru, J. Mech. Phys. Solids 55, 445 (2007), in the form of the reduction to one dimension.
struct WavySphere {
    amplitude: f64,
    length: f64,
}

/// A contact circle in equilibrium.
#[derive(Clone, Copy)]
struct ContactCircle {
    radius: f64,
    approach: f64,
    force: f64,
}

impl WavySphere {
    fn depth(&self, r: f64) -> f64 {
        0.5 * r * r + self.amplitude * (1.0 - (2.0 * PI * r / self.length).cos())
    }

    /// The approach and the force with which each circle is in equilibrium: `d = g(a) - sqrt(2 pi a w)` and
    /// `F = 2 (d a - int_0^a g)`, with `g(x) = x int_0^(pi/2) z'(x sin t) dt`.
    fn circles(&self, largest: f64) -> Vec<ContactCircle> {
        const RADII: usize = 10_000;
        const ANGLES: usize = 200;
        let k = 2.0 * PI / self.length;
        let slope = |r: f64| r + self.amplitude * k * (k * r).sin();
        let (step, angle) = (largest / RADII as f64, 0.5 * PI / ANGLES as f64);
        let (mut below, mut integral) = (0.0, 0.0);
        (1..=RADII)
            .map(|i| {
                let radius = step * i as f64;
                let sum: f64 = (0..ANGLES).map(|j| slope(radius * (angle * (j as f64 + 0.5)).sin())).sum();
                let g = radius * angle * sum;
                integral += 0.5 * (below + g) * step;
                below = g;
                let approach = g - (2.0 * PI * radius * WORK).sqrt();
                ContactCircle { radius, approach, force: 2.0 * (approach * radius - integral) }
            })
            .collect()
    }
}

/// Waves make this sphere hold on by 1.7 times the pull-off force of the smooth one.
#[test]
fn a_wavy_sphere_sticks_and_comes_off_ring_by_ring() {
    /// Cells in a wave, waves in the radius of the smooth sphere without load.
    const WAVE: usize = 12;
    const WAVES: f64 = 5.0;
    /// Energies and radii, relative; forces over the pull-off force of the smooth sphere.
    const SAME: f64 = 0.02;
    /// The same for forces, which change fast before the contact snaps in.
    const FORCE: f64 = 0.025;
    let length = unloaded_radius() / WAVES;
    let wavy = WavySphere { amplitude: 4e-4, length };
    let cell = length / WAVE as f64;
    let n = (2.6 * WAVES * WAVE as f64) as usize;
    let place = |i: usize, off: f64| cell * (i as f64 + off - 0.5 * n as f64);
    let depth = |i, j| wavy.depth(place(i, 0.69).hypot(place(j, 0.87)));
    let map = HeightMap::from_fn(n, n as f64 * cell, |i, j| -depth(i, j)).unwrap();
    let mut history = path(&scene(map));
    let circles = wavy.circles(0.5 * n as f64 * cell);
    let unit = 1.5 * PI * WORK;
    let step = 0.08 * unloaded_radius().powi(2) / 3.0;
    let radius = |state: &ContactState| (state.area.unwrap() / PI).sqrt();
    // It has snapped in at a smaller approach, to the ring that the closed form is followed from.
    let state = at(&mut *history, Load::approach(0.0)).unwrap();
    let mut edge = circles.iter().position(|c| c.radius > radius(&state) - 0.5 * length);
    let mut last: Option<(f64, f64, f64)> = None;
    let (mut pull, mut loss) = ((0.0f64, 0.0f64), (0.0, 0.0));
    // The next ring is within reach at 14.56 steps; it snaps in by half a step too early.
    for (i, inwards) in (0..=13).map(|i| (i, true)).chain((-14..13).rev().map(|i| (i, false))) {
        let d = step * f64::from(i);
        let state = at(&mut *history, Load::approach(d)).unwrap();
        // The edge advances to the first circle with so large an approach, and recedes to the first with so
        // small a one.
        edge = edge.and_then(|edge| {
            if inwards {
                (edge..circles.len()).find(|&k| circles[k].approach >= d)
            } else {
                (0..=edge).rfind(|&k| circles[k].approach <= d)
            }
        });
        let none = ContactCircle { radius: 0.0, approach: d, force: 0.0 };
        let exact = edge.map_or(none, |k| circles[k]);
        assert!((state.force - exact.force).abs() < FORCE * unit, "{i}: {} {}", state.force, exact.force);
        assert!((radius(&state) - exact.radius).abs() <= SAME * exact.radius, "{i}: {}", radius(&state));
        pull = (pull.0.max(-state.force), pull.1.max(-exact.force));
        if let Some((before, found, expected)) = last {
            loss.0 += 0.5 * (state.force + found) * (d - before);
            loss.1 += 0.5 * (exact.force + expected) * (d - before);
        }
        last = Some((d, state.force, exact.force));
    }
    assert!(last.unwrap().1.abs() < 1e-12 * unit);
    assert!(pull.1 > 1.7 * unit);
    approx::assert_relative_eq!(pull.0, pull.1, max_relative = SAME);
    approx::assert_relative_eq!(loss.0, loss.1, max_relative = SAME);
}

/// Pull-off force of a flat punch over Kendall's `sqrt(8 pi w E* a^3)`, a the radius of the disc with its
/// area.
fn punch(cells: usize) -> f64 {
    let n = 2 * cells + 8;
    let middle = 0.5 * n as f64 - 0.1;
    let inside = |i: usize, j: usize| (i as f64 + 0.5 - middle).hypot(j as f64 + 0.3 - middle) < cells as f64;
    let side = n as f64 / cells as f64;
    let map = HeightMap::from_fn(n, side, |i, j| if inside(i, j) { 0.0 } else { -1.0 }).unwrap();
    let count = (0..n * n).filter(|k| inside(k % n, k / n)).count() as f64;
    let a = (count / PI).sqrt() / cells as f64;
    let kendall = (8.0 * PI * WORK * a.powi(3)).sqrt();
    let mut history = path(&scene(map));
    at(&mut *history, Load::approach(0.0)).unwrap();
    let mut largest = 0.0f64;
    for i in 0..60 {
        let d = -kendall / (2.0 * a) * (0.7 + 0.006 * f64::from(i));
        let state = at(&mut *history, Load::approach(d)).unwrap();
        // It holds on with nearly all of its area, or not at all.
        let area = state.area.unwrap() / (PI * a * a);
        assert!(area > 0.8 || area == 0.0, "{cells} {i}: {area}");
        largest = largest.max(-state.force / kendall);
    }
    largest
}

#[test]
fn a_flat_punch_comes_off_at_once() {
    // Where a front is held by an edge the attraction reaches w only after its last cells have begun to open:
    // first order in the cell.
    let (coarse, fine) = (punch(16), punch(32));
    assert!((0.85..0.88).contains(&coarse) && (0.91..0.94).contains(&fine), "{coarse} {fine}");
    assert!((2.0 * fine - coarse - 1.0).abs() < 0.02, "{coarse} {fine}");
}

/// Johnson's wave of length 1 with p periods across and q down the given number of cells, shifted by a part
/// of a cell, and the sides of its map.
fn oblique_wave(cells: usize, (p, q): (u32, u32), place: f64) -> (Scene, Size) {
    let (p, q) = (f64::from(p), f64::from(q));
    let rows = if q > 0.0 { cells } else { 4 };
    let cell = p.hypot(q) / cells as f64;
    let size = Size { x: cells as f64 * cell, y: rows as f64 * cell };
    let map = HeightMap::from_fn(Cells { columns: cells, rows }, size, |i, j| {
        AMPLITUDE * (2.0 * PI * (i as f64 * p + j as f64 * q + place) / cells as f64).cos()
    });
    let mut scene = scene(map.unwrap());
    scene.effects.boundary = Boundary::Periodic;
    (scene, size)
}

/// Amplitude of [`oblique_wave`].
const AMPLITUDE: f64 = 0.02;

/// Shares of Johnson's pressures at which that wave comes off and snaps into full contact, to 1e-3.
fn limits(cells: usize, direction: (u32, u32), place: f64) -> [f64; 2] {
    const STEP: f64 = 1e-3;
    let wave = WavyContact::new(AMPLITUDE, 1.0, 1.0, WORK).unwrap();
    let (_, pull) = wave.pull_off().unwrap().unwrap();
    let (_, snap) = wave.snap_in().unwrap().unwrap();
    let (scene, size) = oblique_wave(cells, direction, place);
    let force = |pressure: f64| Load::force(pressure * size.x * size.y);
    let mut history = path(&scene);
    at(&mut *history, force(0.0)).unwrap();
    at(&mut *history, force(0.7 * pull)).unwrap();
    // A force that nothing holds leaves the path where it was.
    let (mut held, mut lost) = (0.96, 1.06);
    at(&mut *history, force(held * pull)).unwrap();
    while lost - held > STEP {
        let share = if lost > 1.05 { held + 0.01 } else { f64::midpoint(held, lost) };
        match at(&mut *history, force(share * pull)) {
            Ok(_) => held = share,
            Err(Error::NotConverged { .. }) => lost = share,
            Err(other) => panic!("{other}"),
        }
    }
    let mut history = path(&scene);
    at(&mut *history, force(0.9 * snap)).unwrap();
    let mut share = 0.97;
    loop {
        let area = at(&mut *history, force(share * snap)).unwrap().area.unwrap() / (size.x * size.y);
        if area > 0.98 {
            break;
        }
        share += STEP;
        assert!(share < 1.1);
    }
    [f64::midpoint(held, lost), share - 0.5 * STEP]
}

/// Smallest value, mean and largest value of a wave's limits over eight positions of its fronts on the grid.
fn over_places(cells: usize, direction: (u32, u32)) -> [[f64; 3]; 2] {
    let found: Vec<[f64; 2]> =
        (0..8).map(|k| limits(cells, direction, 0.02 + 0.125 * f64::from(k))).collect();
    [0, 1].map(|which| {
        let of = || found.iter().map(|limits| limits[which]);
        [of().fold(f64::INFINITY, f64::min), of().sum::<f64>() / 8.0, of().fold(0.0, f64::max)]
    })
}

/// The contact is 6, 12 and 24 cells wide where it comes off.
#[test]
fn waves_come_off_and_snap_in_at_johnsons_pressures_at_all_places_of_their_fronts() {
    for cells in [64, 128, 256] {
        for [least, mean, most] in over_places(cells, (1, 0)) {
            assert!(least > 0.99 && most < 1.01, "{cells}: {least} {most}");
            assert!((mean - 1.0).abs() < if cells == 64 { 6e-3 } else { 5e-3 }, "{cells}: {mean}");
        }
    }
}

#[test]
fn waves_in_other_directions_pull_off_and_snap_in_alike() {
    // The last are 64 cells in a wave.
    for (cells, direction) in [(128, (1, 1)), (143, (1, 2))] {
        for share in limits(cells, direction, 0.23) {
            assert!((share - 1.0).abs() < 0.01, "{direction:?}: {share}");
        }
    }
}

/// The table of the book's page on adhesion of short range:
/// `cargo test --release -p tests trapping_of_straight_fronts -- --ignored --nocapture`.
#[test]
#[ignore = "a table, minutes"]
fn trapping_of_straight_fronts() {
    for (cells, direction) in [
        (64, (1, 0)),
        (128, (1, 0)),
        (256, (1, 0)),
        (512, (1, 0)),
        (1024, (1, 0)),
        (91, (1, 1)),
        (181, (1, 1)),
        (143, (1, 2)),
    ] {
        let length = cells as f64 / f64::from(direction.0).hypot(f64::from(direction.1));
        let [pull, snap] = over_places(cells, direction);
        println!("{length:.0} {direction:?}: pull-off {pull:.4?}, snap-in {snap:.4?}");
    }
}

#[test]
fn a_wave_pulls_off_and_snaps_in_as_johnson_says() {
    let (cells, rows, amplitude) = (128, 4, 0.02);
    let wave = WavyContact::new(amplitude, 1.0, 1.0, WORK).unwrap();
    let (_, pull) = wave.pull_off().unwrap().unwrap();
    let (_, snap) = wave.snap_in().unwrap().unwrap();
    let side = rows as f64 / cells as f64;
    let map = HeightMap::from_fn(Cells { columns: cells, rows }, Size { x: 1.0, y: side }, |i, _| {
        amplitude * (2.0 * PI * (i as f64 + 0.23) / cells as f64).cos()
    });
    let mut scene = scene(map.unwrap());
    scene.effects.boundary = Boundary::Periodic;
    let force = |p: f64| Load::force(p * side);
    let mut history = path(&scene);
    assert!(at(&mut *history, force(0.0)).unwrap().area.unwrap() < 0.5 * side);
    at(&mut *history, force(0.99 * pull)).unwrap();
    assert!(matches!(at(&mut *history, force(1.01 * pull)), Err(Error::NotConverged { .. })));
    let mut history = path(&scene);
    let partial = at(&mut *history, force(0.99 * snap)).unwrap();
    let psi = wave.stable(0.99 * snap).unwrap().unwrap();
    approx::assert_relative_eq!(partial.area.unwrap() / side, 2.0 * psi / PI, max_relative = 0.03);
    let full = at(&mut *history, force(1.01 * snap)).unwrap();
    approx::assert_relative_eq!(full.area.unwrap(), side, max_relative = 1e-6);
    // Full contact stays full under tension: only what the cells can bear ends it.
    let held = at(&mut *history, force(0.5 * pull)).unwrap();
    approx::assert_relative_eq!(held.area.unwrap(), side, max_relative = 1e-6);
}
