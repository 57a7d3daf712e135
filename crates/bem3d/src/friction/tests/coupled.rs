use super::*;
use crate::active_set::{Control, Limits, Problem};
use crate::friction::coupled::{self, CoupledGuess, CoupledLoad, CoupledState, CoupledSurface};
use crate::kernel::{CouplingTable, NormalTable, TangentialTable};
use contact_model::Status;
use std::sync::Arc;

/// The constants of a pair of one rigid and one elastic body.
struct RigidElasticPair {
    c: f64,
    beta: f64,
}

impl RigidElasticPair {
    /// A rigid body on an elastic one, on which the tractions act.
    fn on_rigid(nu: f64) -> Self {
        Self { c: nu / (1.0 - nu), beta: (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu)) }
    }
}

const NORMAL: Limits =
    Limits { tolerance: 1e-10, height: None, outer_iterations: 200, factor: true, is_guess: false };
const TANGENTIAL: FrictionLimits = FrictionLimits { tolerance: 1e-11, unresolved: 1e-11, iterations: 100 };

/// Undeformed gaps of a surface that is curved and rough.
fn gaps(grid: Grid) -> Vec<f64> {
    let mut next = noise(17);
    (0..grid.count())
        .map(|i| {
            let x = (i % grid.columns) as f64 - 0.5 * (grid.columns - 1) as f64;
            let y = (i / grid.columns) as f64 - 0.5 * (grid.rows - 1) as f64;
            0.05 * (x * x + y * y) + 0.2 * next().abs()
        })
        .collect()
}

struct PlainContact {
    grid: Grid,
    boundary: Boundary,
    pair: RigidElasticPair,
    z: Vec<f64>,
    problem: Problem,
    friction: FrictionSolver,
}

impl PlainContact {
    fn new(grid: Grid, boundary: Boundary, pair: RigidElasticPair, z: Vec<f64>) -> Self {
        let problem = Problem::new(grid, Arc::new(z.clone()), boundary, &Tuning::DEFAULT);
        let constants = [pair.c, pair.beta];
        let friction = FrictionSolver::new(grid, boundary, constants, &Tuning::DEFAULT, &Recorder::default());
        Self { grid, boundary, pair, z, problem, friction }
    }

    fn advance(
        &mut self,
        before: &SlipMemory,
        law: FrictionLaw,
        force: f64,
        control: TangentialControl,
    ) -> CoupledState {
        let load = CoupledLoad {
            normal: Control::Force(force),
            tangential: FrictionLoad { law, control },
            normal_limits: NORMAL,
            tangential_limits: TANGENTIAL,
        };
        let surface =
            CoupledSurface { problem: &mut self.problem, undeformed: &self.z, friction: &mut self.friction };
        coupled::advance(surface, before, load, CoupledGuess::default(), &never).unwrap()
    }

    /// Normal and tangential displacement of all cells, by pairs.
    fn displaced(&self, state: &SlipMemory) -> (Vec<f64>, Vec<[f64; 2]>) {
        let normal = NormalTable::shared(self.grid, self.boundary);
        let table = TangentialTable::shared(self.grid, self.boundary, self.pair.c);
        let cross = CouplingTable::shared(self.grid, self.boundary);
        let (places, n): (Vec<_>, usize) = (state.cells.places().collect(), state.cells.len());
        let (beta, shift) = (self.pair.beta, table.shift());
        let all = CellSet::all(self.grid);
        let sums = all.places().map(|(x, y)| {
            let (mut z, mut u) = (0.0, [0.0; 2]);
            for (j, &(xs, ys)) in places.iter().enumerate() {
                let (p, q) = (state.pressure[j], [state.traction[j], state.traction[n + j]]);
                let sign = |a: usize, b: usize| if a < b { -1.0 } else { 1.0 };
                let (lx, ly) = (x.abs_diff(xs), y.abs_diff(ys));
                let [xx, yy, xy] = table.lag(lx, ly);
                let xy = sign(x, xs) * sign(y, ys) * xy;
                let [jx, jy] = cross.lag(lx, ly);
                let (jx, jy) = (beta * sign(x, xs) * jx, beta * sign(y, ys) * jy);
                z += normal.lag(lx, ly)[0] * p + jx * q[0] + jy * q[1];
                u[0] += (xx - shift) * q[0] + xy * q[1] - jx * p;
                u[1] += xy * q[0] + (yy - shift) * q[1] - jy * p;
            }
            (z, u)
        });
        sums.unzip()
    }

    /// Checks the conditions of both problems with sums over pairs.
    fn check(&self, before: &SlipMemory, state: &CoupledState, law: FrictionLaw, force: f64) {
        assert!(self.friction.is_coupled());
        assert_eq!(state.status(), Status::Converged, "{} rounds", state.rounds);
        let (tangential, memory) = (&state.tangential, &state.tangential.memory);
        let (z, u) = self.displaced(memory);
        let (_, u_before) = self.displaced(before);
        let d = state.normal.d;
        let cells: Vec<usize> = memory.cells.index(self.grid).collect();
        for (i, (u, z)) in z.iter().zip(&self.z).enumerate() {
            let gap = u + z - d;
            let touches = cells.contains(&i);
            assert!(if touches { gap.abs() < 1e-8 * d } else { gap > -1e-8 * d }, "{gap} {d}");
        }
        assert_relative_eq!(memory.pressure.iter().sum::<f64>(), force, max_relative = 1e-9);
        let n = cells.len();
        let size = memory.displacement[0].hypot(memory.displacement[1]).max(d);
        let limits: Vec<f64> = memory.pressure.iter().map(|&p| law.largest_traction(p)).collect();
        let most: f64 = limits.iter().sum();
        for (k, &i) in cells.iter().enumerate() {
            let (q, b) = ([memory.traction[k], memory.traction[n + k]], limits[k]);
            let w: [f64; 2] = std::array::from_fn(|c| {
                memory.displacement[c] - u[i][c] - (before.displacement[c] - u_before[i][c])
            });
            let found = [tangential.slip[k], tangential.slip[n + k]];
            close(&found, &w, 1e-9 * size);
            assert!(q[0].hypot(q[1]) <= b);
            let excess = b * w[0].hypot(w[1]) - q[0] * w[0] - q[1] * w[1];
            assert!(excess < 1e-7 * size * most, "{excess}");
        }
    }
}

#[test]
fn a_coupled_path_meets_the_conditions_of_both_problems() {
    use TangentialControl::{Displacement, Force};
    for (boundary, nu) in [(Boundary::Free, 0.0), (Boundary::Free, 0.3), (Boundary::Periodic, 0.3)] {
        let grid = Grid::square(14, 14);
        let mut contact = PlainContact::new(grid, boundary, RigidElasticPair::on_rigid(nu), gaps(grid));
        let (mu, force) = (0.4, 30.0);
        let most = mu * force;
        let mut before = SlipMemory::default();
        for (force, control) in [
            (force, Force([0.0, 0.0])),
            (force, Force([0.5 * most, 0.1 * most])),
            (1.5 * force, Force([0.5 * most, -0.3 * most])),
            (force, Displacement([0.0, 0.1])),
        ] {
            let state = contact.advance(&before, FrictionLaw::coulomb(mu), force, control);
            println!("{boundary:?} {nu}: {} rounds, contraction {:?}", state.rounds, state.contraction);
            contact.check(&before, &state, FrictionLaw::coulomb(mu), force);
            assert!(state.contraction.is_none_or(|contraction| contraction < 0.9));
            before = state.tangential.memory;
        }
    }
}

#[test]
fn pressed_without_a_force_the_surface_is_held_back_from_moving_inwards() {
    let grid = Grid::square(15, 15);
    let z: Vec<f64> = (0..225)
        .map(|i| {
            let (x, y) = (f64::from(i % 15) - 7.0, f64::from(i / 15) - 7.0);
            0.05 * (x * x + y * y)
        })
        .collect();
    let mut contact = PlainContact::new(grid, Boundary::Free, RigidElasticPair::on_rigid(0.1), z);
    let state = contact.advance(
        &SlipMemory::default(),
        FrictionLaw::coulomb(0.2),
        30.0,
        TangentialControl::Force([0.0, 0.0]),
    );
    contact.check(&SlipMemory::default(), &state, FrictionLaw::coulomb(0.2), 30.0);
    let memory = &state.tangential.memory;
    close(&memory.displacement, &[0.0, 0.0], 1e-9 * state.normal.d);
    let n = memory.cells.len();
    for (k, (x, y)) in memory.cells.places().enumerate() {
        let outwards = (x as f64 - 7.0) * memory.traction[k] + (y as f64 - 7.0) * memory.traction[n + k];
        // The friction on the surface that moves inwards.
        assert!(outwards > 0.0 || (x, y) == (7, 7), "{x} {y}: {outwards}");
    }
    // Held by friction, it takes more force to the same approach.
    let free = {
        let mut contact = PlainContact::new(
            grid,
            Boundary::Free,
            RigidElasticPair { c: 0.1 / 0.9, beta: 0.0 },
            contact.z.clone(),
        );
        contact
            .advance(
                &SlipMemory::default(),
                FrictionLaw::coulomb(0.2),
                30.0,
                TangentialControl::Force([0.0, 0.0]),
            )
            .normal
            .d
    };
    assert!(state.normal.d < free, "{} {free}", state.normal.d);
}

/// Laws without a shear strength, whose tractions vanish with the pressure. Complete contact of a periodic surface,
/// in which the tractions act on no gap, is left out.
#[test]
fn coupled_paths_with_a_limit_meet_the_conditions_of_both_problems() {
    use TangentialControl::{Displacement, Force};
    let (mut rounds, mut contraction, mut steps) = (0, 0.0_f64, 0);
    for seed in 1..=400 {
        let mut next = noise(seed);
        let mut draw = move |low: f64, high: f64| low + (high - low) * next().abs();
        let grid = Grid::square(4 + draw(0.0, 7.0) as usize, 4 + draw(0.0, 7.0) as usize);
        let boundary = if seed % 3 == 0 { Boundary::Periodic } else { Boundary::Free };
        let nu = draw(0.0, 0.49);
        let mut contact = PlainContact::new(grid, boundary, RigidElasticPair::on_rigid(nu), gaps(grid));
        let force = draw(1.0, 30.0);
        let limit = (seed % 5 > 0).then(|| draw(0.1, 1.0));
        let law = FrictionLaw { limit, ..FrictionLaw::coulomb(draw(0.05, 0.5)) };
        let mut before = SlipMemory::default();
        for step in 0..4 {
            let force = force * if step % 2 == 0 { 1.0 } else { draw(0.5, 1.5) };
            let share = draw(0.0, 0.35);
            let (sin, cos) = draw(0.0, 7.0).sin_cos();
            let held = share * before.pressure.iter().map(|&p| law.largest_traction(p)).sum::<f64>();
            let far = 0.2 * share * held / before.cells.len().max(1) as f64;
            let control = if step % 3 == 1 {
                Force([held * cos, held * sin])
            } else {
                Displacement([far * cos, far * sin])
            };
            let state = contact.advance(&before, law, force, control);
            if boundary == Boundary::Periodic && state.normal.contact.len() == grid.count() {
                break;
            }
            contact.check(&before, &state, law, force);
            rounds = rounds.max(state.rounds);
            contraction = contraction.max(state.contraction.unwrap_or(0.0));
            steps += 1;
            before = state.tangential.memory;
        }
    }
    println!("{steps} steps, at most {rounds} rounds, contraction {contraction:.2}");
    assert!(steps > 1000, "{steps}");
}
