mod coupled;
mod oracle;

use super::state::{FrictionState, NotAdvanced};
use super::*;
use crate::geometry::{CellSet, Grid};
use crate::kernel::TangentialTable;
use crate::parts::Recorder;
use crate::response::tangential::{self, StiffnessOf};
use crate::tuning::Tuning;
use crate::{Bem3d, ContactModel, Load, Scene, SelfAffine, Surface};
use approx::assert_relative_eq;
use contact_model::{Boundary, FrictionLaw, Status, never};
use oracle::Oracle;

const LIMITS: FrictionLimits = FrictionLimits { tolerance: 1e-11, unresolved: 1e-11, iterations: 100 };
const MU: f64 = 0.4;

/// Cells in contact at one load, their pressure in units of `u = sum I p`, and the approach.
struct PressedContact {
    cells: CellSet,
    pressure: Vec<f64>,
    approach: f64,
}

impl PressedContact {
    fn cells(&self) -> PressedCells<'_> {
        PressedCells { cells: &self.cells, pressure: &self.pressure }
    }

    fn friction(&self) -> f64 {
        MU * self.pressure.iter().sum::<f64>()
    }
}

/// A rough surface under some forces.
fn pressed(n: usize, seed: u64, boundary: Boundary, forces: &[f64]) -> (Grid, Vec<PressedContact>) {
    let surface = SelfAffine::new(2.4, 1.0, 1.0).map(Surface::SelfAffine).unwrap();
    let mut scene = Scene::new(surface, 1.0);
    scene.effects.boundary = boundary;
    scene.outputs.pressure = true;
    let model = Bem3d { cells: n, tolerance: 1e-12, ..Bem3d::default() };
    let mut contact = model.prepare(&scene, seed).unwrap();
    let grid = Grid::square(n, n);
    let states = forces.iter().map(|&force| {
        let state = contact.solve(Load::force(force)).unwrap();
        let unit = 1.0 / (n as f64 * std::f64::consts::PI);
        let field: Vec<f64> = state.pressure().unwrap().values().iter().map(|p| p * unit).collect();
        let cells = CellSet::of_grid(grid, &field, |p| p > 0.0);
        let pressure = field.into_iter().filter(|p| *p > 0.0).collect();
        PressedContact { cells, pressure, approach: state.approach.unwrap_or(0.0) }
    });
    (grid, states.collect())
}

fn friction(grid: Grid, boundary: Boundary, c: f64) -> FrictionSolver {
    FrictionSolver::new(grid, boundary, [c, 0.0], &Tuning::DEFAULT, &Recorder::default())
}

fn load(control: TangentialControl) -> FrictionLoad {
    FrictionLoad { law: FrictionLaw::coulomb(MU), control }
}

/// One increment, converged.
fn advance(
    friction: &mut FrictionSolver,
    before: &SlipMemory,
    pressed: &PressedContact,
    control: TangentialControl,
) -> FrictionState {
    let state = friction
        .advance(
            SlipStep { before, contact: pressed.cells(), load: load(control), guess: None, relaxes: false },
            LIMITS,
            &never,
        )
        .unwrap();
    assert_eq!(state.status, Status::Converged, "{control:?}: {:e}", state.duality_gap);
    assert!(state.load_error < 1e-12);
    let n = state.limit.len();
    for (i, limit) in state.limit.iter().enumerate() {
        let length = state.memory.traction[i].hypot(state.memory.traction[n + i]);
        assert!(length <= *limit, "{length} {limit}");
    }
    state
}

fn close(found: &[f64], expected: &[f64], epsilon: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= epsilon, "{found} {expected}");
    }
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()))
}

#[test]
fn without_poissons_ratio_it_is_the_difference_of_two_pressures() {
    for n in [16, 40] {
        for share in [0.1, 0.5, 0.9] {
            let force = 0.3;
            let (grid, states) = pressed(n, 3, Boundary::Free, &[force * (1.0 - share), force]);
            let [less, all] = &states[..] else { panic!() };
            let before = all.cells.carry(&less.cells, &less.pressure);
            let expected: Vec<f64> =
                all.pressure.iter().zip(before).map(|(p, less)| MU * (p - less)).collect();
            let delta = MU * (all.approach - less.approach);
            let total = share * all.friction();
            let (sin, cos) = 2.0_f64.sin_cos();
            for (control, [ex, ey]) in [
                (TangentialControl::Force([total, 0.0]), [1.0, 0.0]),
                (TangentialControl::Displacement([0.0, -delta]), [0.0, -1.0]),
                (TangentialControl::Force([total * cos, total * sin]), [cos, sin]),
            ] {
                let state =
                    advance(&mut friction(grid, Boundary::Free, 0.0), &SlipMemory::default(), all, control);
                let (qx, qy) = state.memory.traction.split_at(all.cells.len());
                let along: Vec<f64> = qx.iter().zip(qy).map(|(x, y)| x * ex + y * ey).collect();
                let across: Vec<f64> = qx.iter().zip(qy).map(|(x, y)| y * ex - x * ey).collect();
                close(&along, &expected, 1e-8 * largest(&state.limit));
                assert!(largest(&across) < 1e-8 * largest(&state.limit));
                let [dx, dy] = state.memory.displacement;
                assert_relative_eq!(dx * ex + dy * ey, delta, max_relative = 1e-8);
                assert_relative_eq!(state.force[0] * ex + state.force[1] * ey, total, max_relative = 1e-8);
            }
        }
    }
}

/// Loads of a path: which of the normal loads, the tangential load in units of the largest force or of a displacement.
type Path = Vec<(usize, TangentialControl)>;

#[test]
fn paths_are_those_of_the_dense_oracle() {
    use TangentialControl::{Displacement, Force};
    let forces = [0.3, 0.6, 0.15];
    let force = |x: f64, y: f64| Force([x, y]);
    let path: Path = vec![
        (0, force(0.5, 0.0)),
        // Rotation of the force, then its reversal.
        (0, force(0.35, 0.4)),
        (0, force(-0.3, 0.2)),
        // More pressure at the same force, less pressure, another turn.
        (1, force(-0.3, 0.2)),
        (2, force(-0.2, 0.1)),
        (0, force(0.1, -0.5)),
        (0, Displacement([0.8, 0.1])),
        (2, Displacement([0.8, 0.1])),
        (1, Displacement([-0.2, 0.1])),
    ];
    for (nu, boundary) in [(0.3_f64, Boundary::Free), (0.5, Boundary::Free), (0.3, Boundary::Periodic)] {
        let c = nu / (1.0 - nu);
        let (grid, states) = pressed(12, 5, boundary, &forces);
        let mut solver = friction(grid, boundary, c);
        let mut oracle = Oracle::new(&TangentialTable::shared(grid, boundary, c));
        let mut memory = SlipMemory::default();
        let unit = states[0].friction();
        for (step, &(normal, control)) in path.iter().enumerate() {
            let all = &states[normal];
            // Shares of the friction of this load; displacements of about its size.
            let control = match control {
                Force([x, y]) => Force([x, y].map(|x| x * all.friction())),
                Displacement([x, y]) => Displacement([x, y].map(|x| x * unit / 3.0)),
            };
            let state = advance(&mut solver, &memory, all, control);
            let expected = oracle.advance(&all.cells, &state.limit, control);
            let scale = largest(&state.limit);
            close(&state.memory.traction, &expected.traction, 1e-7 * scale);
            let length = largest(&expected.displacement).max(largest(&expected.slip));
            close(&state.memory.displacement, &expected.displacement, 1e-7 * length);
            let work = scale * length;
            assert!((state.dissipated - expected.dissipated).abs() < 1e-7 * work, "{nu} {step}");
            assert!(state.dissipated > -1e-9 * work);
            memory = state.memory;
        }
    }
}

/// Applies the tensor to the tractions of a state and gives the stored energy of it and of a change.
fn energies(friction: &mut FrictionSolver, [a, b]: [&SlipMemory; 2]) -> [f64; 3] {
    let cells = a.cells.union(&b.cells);
    let on_both = |memory: &SlipMemory| -> Vec<f64> {
        if memory.cells.is_empty() {
            return vec![0.0; 2 * cells.len()];
        }
        memory.traction.chunks_exact(memory.cells.len()).flat_map(|q| cells.carry(&memory.cells, q)).collect()
    };
    let (qa, qb) = (on_both(a), on_both(b));
    let change: Vec<f64> = qb.iter().zip(&qa).map(|(b, a)| b - a).collect();
    [&qa, &qb, &change].map(|q| {
        let mut u = Vec::new();
        increment::exact(&mut friction.operators, (&cells, q), &cells, &mut u, &never).unwrap();
        0.5 * q.iter().zip(&u).map(|(q, u)| q * u).sum::<f64>()
    })
}

#[test]
fn energy_is_balanced_over_a_loop() {
    use TangentialControl::{Displacement, Force};
    let (grid, states) = pressed(20, 2, Boundary::Free, &[0.3, 0.5]);
    let mut solver = friction(grid, Boundary::Free, 0.43);
    let most = states[0].friction();
    let force = |x: f64, y: f64| Force([x * most, y * most]);
    let path = [
        (0, force(0.6, 0.0)),
        (0, force(-0.6, 0.0)),
        (0, force(0.6, 0.0)),
        (1, force(0.6, 0.3)),
        (0, force(0.1, 0.8)),
        (0, Displacement([0.0, 0.0])),
        (1, Displacement([0.1, 0.0])),
    ];
    let mut before = SlipMemory::default();
    let (mut work, mut dissipated) = (0.0, 0.0);
    for (normal, control) in path {
        let state = advance(&mut solver, &before, &states[normal], control);
        let [from, to, change] = energies(&mut solver, [&before, &state.memory]);
        let moved = [0, 1].map(|k| state.memory.displacement[k] - before.displacement[k]);
        // With the force at the end of the increment: T . d(delta) = D + dU + dq'K dq/2, exactly.
        let done = state.force[0] * moved[0] + state.force[1] * moved[1];
        let expected = state.dissipated + to - from + change;
        assert!((done - expected).abs() < 1e-9 * (done.abs() + to), "{control:?}: {done} {expected}");
        work += done;
        dissipated += state.dissipated;
        assert!(state.dissipated >= -1e-10 * to, "friction takes energy: {}", state.dissipated);
        before = state.memory;
    }
    assert!(work > dissipated && dissipated > 0.0);
    // Cells that slipped, and those that did not.
    assert!(largest(&before.slip) > 0.0);
}

#[test]
fn a_turned_and_a_mirrored_surface_have_the_turned_and_mirrored_tractions() {
    let n = 17;
    let (grid, states) = pressed(n, 4, Boundary::Free, &[0.3]);
    let cells: Vec<(usize, usize)> = states[0].cells.places().collect();
    let most = states[0].friction();
    let (fx, fy) = (0.5 * most, 0.2 * most);
    let solve = |map: &dyn Fn(usize, usize) -> (usize, usize), force: [f64; 2]| {
        // The field of pressure moved, and the tractions at the places of the first one.
        let mut field = vec![0.0; n * n];
        for (&(x, y), p) in cells.iter().zip(&states[0].pressure) {
            let (x, y) = map(x, y);
            field[y * n + x] = *p;
        }
        let set = CellSet::of_grid(grid, &field, |p| p > 0.0);
        let pressure: Vec<f64> = field.iter().copied().filter(|p| *p > 0.0).collect();
        let moved = PressedContact { cells: set.clone(), pressure, approach: 0.0 };
        let mut solver = friction(grid, Boundary::Free, 0.43);
        let state = advance(&mut solver, &SlipMemory::default(), &moved, TangentialControl::Force(force));
        let q = |component: usize, (x, y): (usize, usize)| {
            let at = set.index(grid).position(|i| i == y * n + x).unwrap();
            state.memory.traction[component * set.len() + at]
        };
        let at = |&(x, y): &(usize, usize)| [q(0, map(x, y)), q(1, map(x, y))];
        (cells.iter().map(at).collect::<Vec<_>>(), state.memory.displacement)
    };
    let (plain, delta) = solve(&|x, y| (x, y), [fx, fy]);
    // A quarter turn takes (x, y) to (-y, x); a mirror x to -x.
    let (turned, turned_delta) = solve(&|x, y| (n - 1 - y, x), [-fy, fx]);
    let (mirrored, mirrored_delta) = solve(&|x, y| (n - 1 - x, y), [-fx, fy]);
    let scale = 1e-8 * MU * largest(&states[0].pressure);
    for ((q, turned), mirrored) in plain.iter().zip(&turned).zip(&mirrored) {
        close(turned, &[-q[1], q[0]], scale);
        close(mirrored, &[-q[0], q[1]], scale);
    }
    close(&turned_delta, &[-delta[1], delta[0]], 1e-8 * delta[0]);
    close(&mirrored_delta, &[-delta[0], delta[1]], 1e-8 * delta[0]);
}

#[test]
fn a_force_is_held_up_to_gross_slip() {
    let (grid, states) = pressed(20, 6, Boundary::Free, &[0.3]);
    let (all, most) = (&states[0], states[0].friction());
    let mut last = 0.0;
    for share in [0.99, 1.0 - 1e-6, 1.0 - 1e-9, 1.0] {
        let mut solver = friction(grid, Boundary::Free, 0.43);
        let (sin, cos) = 0.7_f64.sin_cos();
        let control = TangentialControl::Force([share * most * cos, share * most * sin]);
        let limits = FrictionLimits { tolerance: 1e-9, ..LIMITS };
        let state = solver
            .advance(
                SlipStep {
                    before: &SlipMemory::default(),
                    contact: all.cells(),
                    load: load(control),
                    guess: None,
                    relaxes: false,
                },
                limits,
                &never,
            )
            .unwrap();
        assert_eq!(state.status, Status::Converged, "{share}: {:e}", state.duality_gap);
        let held = state.force[0].hypot(state.force[1]);
        assert!((held / (share * most) - 1.0).abs() < 1.1e-9, "{share}: {held}");
        assert!(state.load_error < 1.1e-9);
        let moved = state.memory.displacement[0].hypot(state.memory.displacement[1]);
        assert!(moved.is_finite() && moved >= last);
        last = moved;
    }
    let beyond = TangentialControl::Force([0.0, -1.001 * most]);
    let refused = friction(grid, Boundary::Free, 0.43).advance(
        SlipStep {
            before: &SlipMemory::default(),
            contact: all.cells(),
            load: load(beyond),
            guess: None,
            relaxes: false,
        },
        LIMITS,
        &never,
    );
    let Err(NotAdvanced::Force { largest }) = refused else { panic!("{refused:?}") };
    assert_relative_eq!(largest, most, max_relative = 1e-14);
    // With the displacement prescribed gross slip is a state: all cells slip, and the force is that of friction
    // but for the angles between the tractions.
    let mut solver = friction(grid, Boundary::Free, 0.43);
    let far = TangentialControl::Displacement([100.0 * last, 0.0]);
    let state = advance(&mut solver, &SlipMemory::default(), all, far);
    assert!(state.stick.is_empty());
    assert!(state.force[0] <= most && state.force[0] > 0.999 * most);
}

/// The first increment with this coefficient of friction, converged.
fn first_with(
    solver: &mut FrictionSolver,
    mu: f64,
    pressed: &PressedContact,
    control: TangentialControl,
) -> FrictionState {
    let load = FrictionLoad { law: FrictionLaw::coulomb(mu), control };
    let before = SlipMemory::default();
    let step = SlipStep { before: &before, contact: pressed.cells(), load, guess: None, relaxes: false };
    let state = solver.advance(step, LIMITS, &never).unwrap();
    assert_eq!(state.status, Status::Converged, "{mu} {control:?}: {:e}", state.duality_gap);
    state
}

#[test]
fn without_a_load_and_without_friction_there_is_no_traction() {
    use TangentialControl::{Displacement, Force};
    let (grid, states) = pressed(14, 6, Boundary::Free, &[0.3]);
    let all = &states[0];
    let mut solver = friction(grid, Boundary::Free, 0.43);
    let none = first_with(&mut solver, MU, all, Force([0.0, 0.0]));
    assert!(largest(&none.memory.traction) == 0.0 && none.duality_gap == 0.0);
    let none = first_with(&mut solver, 0.0, all, Displacement([0.3, 0.1]));
    assert!(none.force == [0.0, 0.0] && (none.slip[0] - 0.3).abs() < 1e-15 && none.dissipated == 0.0);
    let none = first_with(&mut solver, 0.0, all, Force([0.0, 0.0]));
    close(&none.memory.displacement, &[0.0, 0.0], 0.0);
    let load = FrictionLoad { law: FrictionLaw::coulomb(0.0), control: Force([1e-9, 0.0]) };
    let before = SlipMemory::default();
    let step = SlipStep { before: &before, contact: all.cells(), load, guess: None, relaxes: false };
    let refused = solver.advance(step, LIMITS, &never).map(|_| ());
    assert_eq!(refused.unwrap_err(), NotAdvanced::Force { largest: 0.0 });
}

#[test]
fn without_slip_the_force_is_linear_in_the_displacement() {
    let (grid, states) = pressed(14, 6, Boundary::Free, &[0.3]);
    let all = &states[0];
    let mut solver = friction(grid, Boundary::Free, 0.43);
    let total = all.friction();
    let control = TangentialControl::Force([0.3 * total, 0.1 * total]);
    let stuck = first_with(&mut solver, 1e3, all, control);
    assert!(stuck.stick.len() > all.cells.len() / 2);
    // The stiffness of full stick is that of the force.
    let k = tangential::solve(&mut solver, &stuck, StiffnessOf::FullStick, 1e-9, &never).unwrap();
    let [dx, dy] = stuck.memory.displacement;
    let [xx, yy, xy] = k.value;
    assert!(k.solve_error < 1e-9);
    assert_relative_eq!(xx * dx + xy * dy, 0.3 * total, max_relative = 1e-3);
    assert_relative_eq!(xy * dx + yy * dy, 0.1 * total, max_relative = 1e-3);
}

#[test]
fn without_contact_bodies_slide_and_touch_where_they_lie() {
    let (grid, states) = pressed(14, 6, Boundary::Free, &[0.3]);
    let all = &states[0];
    let mut solver = friction(grid, Boundary::Free, 0.43);
    let control = TangentialControl::Displacement([1.0, 0.0]);
    let nothing = PressedContact { cells: CellSet::default(), pressure: Vec::new(), approach: 0.0 };
    let state = first_with(&mut solver, MU, &nothing, control);
    assert!(state.force == [0.0, 0.0] && state.memory.traction.is_empty());
    close(
        &tangential::solve(&mut solver, &state, StiffnessOf::Branch, 1e-6, &never).unwrap().value,
        &[0.0; 3],
        0.0,
    );
    let again = SlipStep {
        before: &state.memory,
        contact: all.cells(),
        load: load(control),
        guess: None,
        relaxes: false,
    };
    let again = solver.advance(again, LIMITS, &never).unwrap();
    assert!(largest(&again.memory.traction) < 1e-10 * all.friction(), "touched where it lies");
}

#[test]
fn one_and_two_cells_by_hand() {
    let grid = Grid::square(6, 6);
    let c = 0.6;
    let table = TangentialTable::shared(grid, Boundary::Free, c);
    for cells in [vec![14], vec![14, 21], vec![14, 16]] {
        let set = CellSet::from_index(grid, &cells);
        let pressure = vec![1.0; cells.len()];
        let pressed = PressedContact { cells: set, pressure, approach: 0.0 };
        let (x, y) = ((cells.last().unwrap() % 6) - 2, cells.last().unwrap() / 6 - 2);
        let ([own, _, _], [xx, yy, xy]) = (table.lag(0, 0), table.lag(x as usize, y as usize));
        let pair = if cells.len() == 1 { [own, own, 0.0] } else { [own + xx, own + yy, xy] };
        // Both cells carry the same traction by symmetry, however it is directed.
        for (fx, fy) in [(0.1, 0.0), (0.2, -0.1), (0.0, 0.3)] {
            let count = cells.len() as f64;
            let control = TangentialControl::Force([fx * count, fy * count]);
            let mut solver = friction(grid, Boundary::Free, c);
            let state = advance(&mut solver, &SlipMemory::default(), &pressed, control);
            close(&state.memory.traction[..1], &[fx], 1e-9);
            let expected = [pair[0] * fx + pair[2] * fy, pair[2] * fx + pair[1] * fy];
            close(&state.memory.displacement, &expected, 1e-8);
            let k = tangential::solve(&mut solver, &state, StiffnessOf::Branch, 1e-10, &never).unwrap();
            let determinant = pair[0] * pair[1] - pair[2] * pair[2];
            let inverse = [pair[1], pair[0], -pair[2]].map(|k| count * k / determinant);
            close(&k.value, &inverse, 1e-8);
        }
    }
}

#[test]
fn stiffnesses_are_difference_quotients() {
    use TangentialControl::Displacement;
    for (boundary, seed) in [(Boundary::Free, 3), (Boundary::Periodic, 8)] {
        let (grid, states) = pressed(20, seed, boundary, &[0.3]);
        let all = &states[0];
        let mut solver = friction(grid, boundary, 0.43);
        let most = all.friction();
        let limits = FrictionLimits { tolerance: 1e-14, ..LIMITS };
        let advance = |solver: &mut FrictionSolver, before: &SlipMemory, control| {
            solver
                .advance(
                    SlipStep {
                        before,
                        contact: all.cells(),
                        load: load(control),
                        guess: None,
                        relaxes: false,
                    },
                    limits,
                    &never,
                )
                .unwrap()
        };
        let begin = SlipMemory::default();
        let state = advance(&mut solver, &begin, TangentialControl::Force([0.45 * most, 0.2 * most]));
        let [dx, dy] = state.memory.displacement;
        let size = dx.hypot(dy);
        let branch = tangential::solve(&mut solver, &state, StiffnessOf::Branch, 1e-8, &never).unwrap();
        let stuck = tangential::solve(&mut solver, &state, StiffnessOf::FullStick, 1e-8, &never).unwrap();
        assert!(branch.solve_error < 1e-8 && stuck.solve_error < 1e-8);
        println!("{boundary:?} {branch:?} {stuck:?} stick {} of {}", state.stick.len(), all.cells.len());
        // From the beginning of the increment to displacements on both sides.
        let h = 1e-5 * size;
        for (ex, ey) in [(1.0, 0.0), (0.0, 1.0)] {
            let mut at = |h: f64| {
                let control = Displacement([dx + h * ex, dy + h * ey]);
                advance(&mut solver, &begin, control).force
            };
            let (up, down) = (at(h), at(-h));
            let quotient = [0, 1].map(|k| (up[k] - down[k]) / (2.0 * h));
            let [xx, yy, xy] = branch.value;
            let expected = [xx * ex + xy * ey, xy * ex + yy * ey];
            close(&quotient, &expected, 1e-4 * xx);
        }
        // Back from the end by a little: all cells stick.
        let h = 1e-7 * size;
        let (ex, ey) = (-dx / size, -dy / size);
        let control = Displacement([dx + h * ex, dy + h * ey]);
        let back = advance(&mut solver, &state.memory, control).force;
        let quotient = [0, 1].map(|k| (back[k] - state.force[k]) / h);
        let [xx, yy, xy] = stuck.value;
        close(&quotient, &[xx * ex + xy * ey, xy * ex + yy * ey], 1e-3 * xx);
    }
}

/// Numbers in (-1, 1) of a seed.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[test]
fn every_increment_converges() {
    // Limits and references without order, from tractions without order: sets of cells of all densities, oblong
    // cells, limits of twelve decades.
    let mut most = (0, 0);
    for seed in 1..=200 {
        let mut next = noise(seed);
        let grid = Grid {
            columns: 3 + (next().abs() * 22.0) as usize,
            rows: 1 + (next().abs() * 22.0) as usize,
            stretch: if seed % 3 == 0 { next().exp() } else { 1.0 },
        };
        let boundary = if seed % 4 == 0 { Boundary::Periodic } else { Boundary::Free };
        let (share, decades) = (next().abs(), 6.0 * next().abs());
        let keep: Vec<bool> = (0..grid.count()).map(|_| next().abs() <= share).collect();
        let cells = CellSet::numbered(grid, |i| keep[i] || i == 0);
        let n = cells.len();
        let limit: Vec<f64> = (0..n).map(|_| 10f64.powf(decades * next())).collect();
        let sum: f64 = limit.iter().sum();
        let size = 10f64.powf(2.0 * next()) * sum / n as f64;
        let reference: Vec<f64> = (0..2 * n).map(|_| size * next()).collect();
        let start: Vec<f64> = (0..2 * n).map(|_| sum * next()).collect();
        let (angle, part) = (3.0 * next(), next().abs());
        let control = if seed % 2 == 0 {
            TangentialControl::Force([part * sum * angle.cos(), part * sum * angle.sin()])
        } else {
            TangentialControl::Displacement([size * 3.0 * next(), size * 3.0 * next()])
        };
        let increment = increment::Increment {
            cells: &cells,
            limit: &limit,
            reference: &reference,
            control,
            displacement: [0.0; 2],
        };
        let c = next().abs();
        let mut solver = friction(grid, boundary, c);
        let limits = FrictionLimits { tolerance: 1e-9, iterations: 300, ..LIMITS };
        let found = increment::solve(solver.systems(), increment, start, limits, &never).unwrap();
        assert_eq!(
            found.status,
            Status::Converged,
            "seed {seed}: {n} cells of {grid:?}, {control:?}, gap {:e}, {} steps",
            found.duality_gap,
            found.iterations
        );
        most = (most.0.max(found.iterations), most.1.max(solver.work()[0]));
    }
    println!("at most {} steps, {} applications", most.0, most.1);
}

#[test]
fn projected_gradients_alone_converge() {
    // What takes over where Newton's steps come to nothing, on a path with a reversal.
    let (grid, states) = pressed(12, 5, Boundary::Free, &[0.3]);
    let (all, most) = (&states[0], states[0].friction());
    let limit: Vec<f64> = all.pressure.iter().map(|p| MU * p).collect();
    let mut solver = friction(grid, Boundary::Free, 0.43);
    let first =
        advance(&mut solver, &SlipMemory::default(), all, TangentialControl::Force([0.6 * most, 0.0]));
    for control in [
        TangentialControl::Force([-0.3 * most, 0.2 * most]),
        TangentialControl::Displacement([0.3 * first.memory.displacement[0], 0.0]),
    ] {
        let expected = advance(&mut solver, &first.memory, all, control);
        let increment = increment::Increment {
            cells: &all.cells,
            limit: &limit,
            reference: &first.memory.offset,
            control,
            displacement: first.memory.displacement,
        };
        let limits = FrictionLimits { tolerance: 1e-9, iterations: 0, ..LIMITS };
        let start = vec![0.0; 2 * limit.len()];
        let found = increment::by_gradients(solver.systems(), increment, start, limits, 2000).unwrap();
        assert!(found.duality_gap < 1e-9, "{:e}", found.duality_gap);
        close(&found.traction, &expected.memory.traction, 1e-4 * largest(&limit));
    }
}

#[test]
fn the_error_of_a_stiffness_holds_its_true_error() {
    // Loads solved roughly: stiffnesses of sets with cells on the wrong side, against those of tight solves.
    let (mut worst, mut largest_error) = (0.0_f64, 0.0_f64);
    for seed in 1..=4 {
        let (grid, states) = pressed(32, seed, Boundary::Free, &[0.6]);
        let (all, most) = (&states[0], states[0].friction());
        let mut solver = friction(grid, Boundary::Free, 0.43);
        for share in [0.2, 0.5, 0.8] {
            let mut stiffness = |tolerance: f64| {
                let control = TangentialControl::Force([share * most, 0.1 * most]);
                let limits = FrictionLimits { tolerance, ..LIMITS };
                let begin = SlipMemory::default();
                let state = solver
                    .advance(
                        SlipStep {
                            before: &begin,
                            contact: all.cells(),
                            load: load(control),
                            guess: None,
                            relaxes: false,
                        },
                        limits,
                        &never,
                    )
                    .unwrap();
                tangential::solve(&mut solver, &state, StiffnessOf::Branch, tolerance, &never).unwrap()
            };
            let exact = stiffness(1e-13).value;
            for tolerance in [1e-2, 1e-3, 1e-4, 1e-6] {
                let found = stiffness(tolerance);
                let off = (0..3).map(|k| (found.value[k] - exact[k]).abs()).fold(0.0, f64::max) / exact[0];
                let claimed = found.solve_error + found.set_error;
                println!(
                    "{seed} {share} {tolerance:.0e}: off {off:.1e}, {:.1e} + {:.1e}",
                    found.solve_error, found.set_error
                );
                worst = worst.max(off / (claimed + 1e-9));
                if tolerance <= 1e-6 {
                    largest_error = largest_error.max(claimed);
                }
            }
        }
    }
    println!("worst {worst}, at 1e-6 at most {largest_error:e}");
    assert!(worst < 1.0 && largest_error < 1e-4, "{worst} {largest_error:e}");
}
