mod oracle;

use super::*;
use crate::geometry::{CellSet, Grid};
use crate::kernel::TangentialTable;
use crate::parts::Recorder;
use crate::tuning::Tuning;
use crate::{Bem3d, ContactModel, Load, Scene, SelfAffine, Surface};
use approx::assert_relative_eq;
use contact_model::{Boundary, Status, never};
use oracle::Oracle;

const LIMITS: FrictionLimits = FrictionLimits { tolerance: 1e-11, iterations: 100 };
const MU: f64 = 0.4;

/// Pressed cells of one load, in units of `u = sum I p`, and the approach.
struct Pressed {
    cells: CellSet,
    pressure: Vec<f64>,
    approach: f64,
}

impl Pressed {
    fn cells(&self) -> PressedCells<'_> {
        PressedCells { cells: &self.cells, pressure: &self.pressure }
    }

    fn friction(&self) -> f64 {
        MU * self.pressure.iter().sum::<f64>()
    }
}

/// A rough surface under some forces.
fn pressed(n: usize, seed: u64, boundary: Boundary, forces: &[f64]) -> (Grid, Vec<Pressed>) {
    let surface = SelfAffine::new(2.4, 1.0, 1.0).map(Surface::SelfAffine).unwrap();
    let mut scene = Scene::new(surface, 1.0);
    scene.effects.boundary = boundary;
    scene.outputs.pressure = true;
    let model = Bem3d { cells: n, tolerance: 1e-12, ..Bem3d::default() };
    let mut contact = model.prepare(&scene, seed).unwrap();
    let grid = Grid::square(n, n);
    let states = forces.iter().map(|&force| {
        let state = contact.solve(Load::Force(force)).unwrap();
        let unit = 1.0 / (n as f64 * std::f64::consts::PI);
        let field: Vec<f64> = state.pressure().unwrap().values().iter().map(|p| p * unit).collect();
        let cells = CellSet::of_grid(grid, &field, |p| p > 0.0);
        let pressure = field.into_iter().filter(|p| *p > 0.0).collect();
        Pressed { cells, pressure, approach: state.approach.unwrap_or(0.0) }
    });
    (grid, states.collect())
}

fn friction(grid: Grid, boundary: Boundary, c: f64) -> Friction {
    Friction::new(grid, boundary, c, &Tuning::DEFAULT, &Recorder::default())
}

/// One increment, converged.
fn advance(
    friction: &mut Friction,
    before: &SlipMemory,
    pressed: &Pressed,
    control: TangentialControl,
) -> FrictionState {
    let state = friction.advance(before, pressed.cells(), MU, control, None, LIMITS, &never).unwrap();
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
