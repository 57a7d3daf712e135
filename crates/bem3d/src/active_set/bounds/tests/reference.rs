//! Random states compared with a dense reference, which satisfies the contact conditions to rounding by
//! exchanging cells one at a time.

use super::super::super::{Bounds, Control, Guess, Limits, Problem, Solved, cold_start, solve};
use crate::geometry::{CellSet, Grid};
use crate::kernel::NormalTable;
use crate::linear::Factor;
use crate::operator::{DirectSum, InfluenceOperator};
use crate::tuning::Tuning;
use contact_model::{Boundary, Status, never};
use std::sync::Arc;

/// States that are compared.
const STATES: u64 = 600;
/// Bound of the residuals, in units of the heights.
const TOLERANCE: f64 = 1e-9;
/// Conditions of the reference: rounding of a few hundred additions, in units of the heights and of the
/// largest pressure.
const ROUNDING: f64 = 1e-11;
/// Largest number of exchanges of single cells.
const EXCHANGES: usize = 400;

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

/// The state of a cell in the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Open,
    Elastic,
    Saturated,
}

/// A dense problem.
struct Dense {
    grid: Grid,
    table: Arc<NormalTable>,
    z: Vec<f64>,
    hardness: f64,
    target: Control,
}

impl Dense {
    /// Pressure, gap and approach of an assignment; `None` where no elastic cell is left to carry a
    /// prescribed force.
    fn state(&self, kinds: &[Kind]) -> Option<(Vec<f64>, Vec<f64>, f64)> {
        let (n, all) = (kinds.len(), CellSet::all(self.grid));
        let of = |kind: Kind| (0..n as u32).filter(|&i| kinds[i as usize] == kind).collect::<Vec<_>>();
        let (elastic, saturated) = (of(Kind::Elastic), of(Kind::Saturated));
        let mut p = vec![0.0; n];
        for &i in &saturated {
            p[i as usize] = self.hardness;
        }
        let mut u = vec![0.0; n];
        DirectSum(&self.table).apply(&all, &p, &all, &mut u);
        let mut d = match self.target {
            Control::Approach(d) => d,
            Control::Force(_) => f64::NAN,
        };
        if !elastic.is_empty() {
            let right: Vec<f64> = elastic.iter().map(|&i| self.z[i as usize] + u[i as usize]).collect();
            let (q, w) =
                Factor::new(&self.table, &CellSet::from_index(self.grid, &elastic))?.solve_pair(&right);
            if let Control::Force(force) = self.target {
                let rest = force - self.hardness * saturated.len() as f64;
                d = (rest + w.iter().sum::<f64>()) / q.iter().sum::<f64>();
            }
            elastic.iter().zip(q.iter().zip(&w)).for_each(|(&i, (q, w))| p[i as usize] = d * q - w);
        }
        if d.is_nan() {
            return None;
        }
        DirectSum(&self.table).apply(&all, &p, &all, &mut u);
        let gap = u.iter().zip(&self.z).map(|(u, z)| u + z - d).collect();
        Some((p, gap, d))
    }

    /// The solution, from the cells of a state: the cell that violates its condition most changes its kind,
    /// until none does. `None` where saturated cells alone carry the force or the exchanges do not end.
    fn solution(&self, mut kinds: Vec<Kind>) -> Option<(Vec<f64>, f64)> {
        for _ in 0..EXCHANGES {
            let (p, gap, d) = self.state(&kinds)?;
            let own = self.table.own();
            let mut worst = (ROUNDING, None);
            for (i, &kind) in kinds.iter().enumerate() {
                let (miss, next) = match kind {
                    Kind::Open => (-gap[i], Kind::Elastic),
                    Kind::Saturated => (gap[i], Kind::Elastic),
                    Kind::Elastic if p[i] < 0.0 => (-p[i] * own, Kind::Open),
                    Kind::Elastic => ((p[i] - self.hardness) * own, Kind::Saturated),
                };
                if miss > worst.0 {
                    worst = (miss, Some((i, next)));
                }
            }
            let Some((cell, next)) = worst.1 else { return Some((p, d)) };
            kinds[cell] = next;
        }
        None
    }
}

/// A state by its number.
fn state(number: u64) -> (Dense, Boundary) {
    let mut seed = number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut draw = |low: f64, high: f64| low + (high - low) * random(&mut seed);
    draw(0.0, 1.0);
    let side = |x: f64| x as usize;
    let (columns, rows) = (side(draw(2.0, 15.0)), side(draw(2.0, 15.0)));
    let stretch = if draw(0.0, 1.0) < 0.5 { 1.0 } else { draw(0.7, 1.4) };
    let grid = Grid { columns, rows, stretch };
    let waves: Vec<[f64; 4]> = (0..6).map(|_| [0; 4].map(|_| draw(0.0, 1.0))).collect();
    let (white, scale) = (draw(0.0, 1.0), 10f64.powf(draw(-1.0, 1.0)));
    let mut z: Vec<f64> = (0..grid.count())
        .map(|i| {
            let (x, y) = ((i % columns) as f64 / columns as f64, (i / columns) as f64 / rows as f64);
            let smooth = |[kx, ky, phase, height]: &[f64; 4]| {
                let turns = (3.0 * kx).floor() * x + (3.0 * ky).floor() * y + phase;
                height * (std::f64::consts::TAU * turns).cos()
            };
            scale * (white * draw(-1.0, 1.0) + waves.iter().map(smooth).sum::<f64>())
        })
        .collect();
    if draw(0.0, 1.0) < 0.3 {
        let share = draw(0.0, 0.4);
        z.iter_mut().skip(1).for_each(|z| {
            if draw(0.0, 1.0) < share {
                *z = f64::INFINITY;
            }
        });
    }
    let lowest = z.iter().copied().fold(f64::INFINITY, f64::min);
    for z in &mut z {
        *z -= lowest;
    }
    let boundary = if draw(0.0, 1.0) < 0.5 { Boundary::Free } else { Boundary::Periodic };
    let table = NormalTable::shared(grid, boundary);
    let defined = z.iter().filter(|z| z.is_finite()).count() as f64;
    let hardness = scale * 10f64.powf(draw(-2.5, 1.0)) / table.own();
    let target = if draw(0.0, 1.0) < 0.3 {
        Control::Approach(scale * draw(0.1, 3.0))
    } else {
        Control::Force(hardness * defined * draw(0.001, 0.999))
    };
    (Dense { grid, table, z, hardness, target }, boundary)
}

/// The kind of each cell of a solved state, as the reference counts it.
fn kinds(dense: &Dense, solved: &Solved) -> Vec<Kind> {
    let p = CellSet::all(dense.grid).carry(&solved.contact, &solved.p);
    let kind = |p: f64| {
        if p >= dense.hardness {
            Kind::Saturated
        } else if p > 0.0 {
            Kind::Elastic
        } else {
            Kind::Open
        }
    };
    p.into_iter().map(kind).collect()
}

#[test]
fn random_states_are_those_of_a_dense_reference() {
    let (mut compared, mut saturated) = (0, 0);
    for number in 0..STATES {
        let (dense, boundary) = state(number);
        let Dense { grid, hardness, target, .. } = dense;
        let mut problem = Problem::new(grid, Arc::new(dense.z.clone()), boundary, &Tuning::DEFAULT);
        problem.bounds = Bounds::UpTo(hardness);
        let limits = Limits {
            tolerance: TOLERANCE,
            height: Some(1.0),
            outer_iterations: 200,
            factor: number % 2 == 0,
            is_guess: false,
        };
        let guess: Guess = cold_start(&mut problem, target, limits, &never).unwrap();
        let solved = solve(&mut problem, target, guess, limits, &never).unwrap();
        assert_eq!(solved.status, Status::Converged, "{number}: {target:?} {:?}", solved.residuals);
        let Some((p, d)) = dense.solution(kinds(&dense, &solved)) else { continue };
        compared += 1;
        saturated += u64::from(p.iter().any(|&p| p >= hardness));
        let found = CellSet::all(grid).carry(&solved.contact, &solved.p);
        // The energy of the difference is below its bound from the residual gaps: twice the duality gap and
        // the complementarity residual.
        let change: Vec<f64> = found.iter().zip(&p).map(|(a, b)| a - b).collect();
        let mut u = vec![0.0; p.len()];
        DirectSum(&dense.table).apply(&CellSet::all(grid), &change, &CellSet::all(grid), &mut u);
        let energy: f64 = change.iter().zip(&u).map(|(p, u)| p * u).sum();
        let force: f64 = p.iter().sum();
        let bound = (TOLERANCE * (1.0 + d) * (force + hardness * p.len() as f64)).max(f64::MIN_POSITIVE);
        assert!(energy <= bound, "{number}: {energy} {bound}");
        let elastic = p.iter().filter(|&&p| p > 0.0 && p < hardness).count();
        if elastic > 0 {
            assert!((solved.d - d).abs() <= 1e-6 * (1.0 + d), "{number}: {} {d}", solved.d);
        }
    }
    println!("{compared} of {STATES} compared, {saturated} with saturated cells");
    assert!(compared * 10 >= STATES * 9 && saturated * 2 > compared, "{compared} {saturated}");
}
