use super::super::{Control, Guess, Limits, Problem, cold_start, solve};
use super::*;
use crate::geometry::Grid;
use crate::kernel::NormalTable;
use crate::linear::Factor;
use crate::operator::{DirectSum, InfluenceOperator};
use crate::tuning::Tuning;
use approx::assert_relative_eq;
use contact_model::{Boundary, Status, never};
use proptest::prelude::*;
use std::sync::Arc;

#[cfg(feature = "faer")]
mod reference;

/// Bound of the residuals, as a share of the approach.
const TIGHT: Limits =
    Limits { tolerance: 1e-10, height: None, outer_iterations: 200, factor: true, is_guess: false };
/// Error that these residuals allow in the pressure of a few cells, relative.
const SAME: f64 = 1e-7;
/// Where a solution is nearer to a tie than this share of the hardness or of the approach, a cell may be
/// assigned to the other side of the tie.
const TIE: f64 = 1e-6;

/// A solution of the conditions on a tiny grid.
#[derive(Debug)]
struct Enumerated {
    p: Vec<f64>,
    d: f64,
    /// Nearest distance to a tie.
    tie: f64,
}

/// All solutions, by trying every assignment of open, elastic and saturated to the cells. Cost `O(3^n n^3)`.
fn every_state(grid: Grid, z: &[f64], target: Control, hardness: f64) -> Vec<Enumerated> {
    let table = NormalTable::shared(grid, Boundary::Free);
    let (n, all) = (grid.count(), CellSet::all(grid));
    let apply = |p: &[f64]| {
        let mut u = vec![0.0; n];
        DirectSum(&table).apply(&all, p, &all, &mut u);
        u
    };
    let try_one = |code: usize| {
        let digit = |i: u32| code / 3usize.pow(i) % 3;
        let cells = |kind: usize| (0..n as u32).filter(|&i| digit(i) == kind).collect::<Vec<_>>();
        let (elastic, saturated) = (cells(1), cells(2));
        let mut p = vec![0.0; n];
        for &i in &saturated {
            p[i as usize] = hardness;
        }
        let u = apply(&p);
        let set = CellSet::from_index(grid, &elastic);
        let right: Vec<f64> = elastic.iter().map(|&i| z[i as usize] + u[i as usize]).collect();
        let d = if elastic.is_empty() {
            match target {
                Control::Approach(d) => d,
                Control::Force(_) => return None,
            }
        } else {
            let (q, w) = Factor::new(&table, &set)?.solve_pair(&right);
            let d = match target {
                Control::Approach(d) => d,
                Control::Force(force) => {
                    let rest = force - hardness * saturated.len() as f64;
                    (rest + w.iter().sum::<f64>()) / q.iter().sum::<f64>()
                }
            };
            elastic.iter().zip(q.iter().zip(&w)).for_each(|(&i, (q, w))| p[i as usize] = d * q - w);
            d
        };
        let gap: Vec<f64> = apply(&p).iter().zip(z).map(|(u, z)| u + z - d).collect();
        let tie = (0..n)
            .map(|i| match digit(i as u32) {
                0 => gap[i] / d,
                1 => p[i].min(hardness - p[i]) / hardness,
                _ => -gap[i] / d,
            })
            .fold(f64::INFINITY, f64::min);
        (tie > 0.0).then_some(Enumerated { p, d, tie })
    };
    (1..3usize.pow(n as u32)).filter_map(try_one).collect()
}

/// A prepared problem with a hardness.
fn problem(grid: Grid, z: &[f64], hardness: f64) -> Problem {
    let mut problem = Problem::new(grid, Arc::new(z.to_vec()), Boundary::Free, &Tuning::DEFAULT);
    problem.bounds = Bounds::UpTo(hardness);
    problem
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn the_only_solution_of_every_assignment_is_found(
        heights in proptest::collection::vec(0f64..1.0, 6),
        stretch in prop_oneof![Just(1.0), 0.7f64..1.4],
        load in 0.05f64..8.0,
        share in 0.02f64..3.0,
        by_force in any::<bool>(),
        factor in any::<bool>(),
    ) {
        let grid = Grid { columns: 3, rows: 2, stretch };
        let highest = heights.iter().copied().fold(0.0, f64::max);
        let z: Vec<f64> = heights.iter().map(|h| highest - h).collect();
        // A force that the cells carry, or an approach.
        let hardness = share * load / 6.0 + if by_force { load / 6.0 } else { 0.0 };
        let target = if by_force { Control::Force(load) } else { Control::Approach(load) };
        let found = every_state(grid, &z, target, hardness);
        prop_assume!(found.iter().all(|one| one.tie > TIE));
        prop_assert_eq!(found.len(), 1);
        let mut problem = problem(grid, &z, hardness);
        let limits = Limits { factor, ..TIGHT };
        let guess = cold_start(&mut problem, target, limits, &never).unwrap();
        let solved = solve(&mut problem, target, guess, limits, &never).unwrap();
        prop_assert_eq!(solved.status, Status::Converged);
        let p = CellSet::all(grid).carry(&solved.contact, &solved.p);
        for (p, expected) in p.iter().zip(&found[0].p) {
            prop_assert!((p - expected).abs() <= SAME * load, "{:?} {:?}", solved.p, found[0].p);
        }
        prop_assert!((solved.d / found[0].d - 1.0).abs() <= SAME, "{} {}", solved.d, found[0].d);
    }
}

#[test]
fn a_force_is_shared_by_hand() {
    let grid = Grid::square(5, 1);
    let candidates = Candidates::new(grid, Arc::new(vec![0.0, 0.1, 0.3, f64::INFINITY, 0.2]));
    let brought = |cells: &[u32], p: &[f64], force: f64| {
        let (mut set, mut p) = (CellSet::from_index(grid, cells), p.to_vec());
        bring_to(force, 1.0, &mut set, &mut p, &candidates);
        (set.index(grid).collect::<Vec<_>>(), p)
    };
    // One cell is saturated, the other takes the rest.
    assert_eq!(brought(&[0, 1], &[1.0, 0.25], 1.5), (vec![0, 1], vec![1.0, 0.5]));
    // The force is less than the saturated cell carries: all pressures are reduced.
    assert_eq!(brought(&[0, 1], &[1.0, 1.0], 1.0), (vec![0, 1], vec![0.5, 0.5]));
    // The lowest cells outside join; an undefined one never does.
    assert_eq!(brought(&[0], &[1.0], 1.5), (vec![0, 1], vec![1.0, 0.5]));
    let (cells, p) = brought(&[0], &[1.0], 3.5);
    assert_eq!(cells, [0, 1, 2, 4]);
    assert_relative_eq!(p.iter().sum::<f64>(), 3.5, max_relative = 1e-14);
}

#[test]
fn cells_join_saturate_and_stay_saturated_by_hand() {
    let grid = Grid::square(5, 1);
    let candidates = Candidates::new(grid, Arc::new(vec![0.0, 0.1, 0.3, f64::INFINITY, 0.2]));
    let brought = |cells: &[u32], p: &[f64], force: f64, hardness: f64| {
        let (mut set, mut p) = (CellSet::from_index(grid, cells), p.to_vec());
        let grown = bring_to(force, hardness, &mut set, &mut p, &candidates);
        (grown, set.index(grid).collect::<Vec<_>>(), p)
    };
    // As many cells join as the rest of the force needs, and share it.
    assert_eq!(brought(&[0], &[2.0], 3.0, 2.0), (true, vec![0, 1], vec![2.0, 1.0]));
    let (_, cells, p) = brought(&[0], &[2.0], 7.0, 2.0);
    assert_eq!((cells, p[0]), (vec![0, 1, 2, 4], 2.0));
    p[1..].iter().for_each(|p| assert_relative_eq!(*p, 5.0 / 3.0, max_relative = 1e-14));
    // The pressure of the other cell falls, that of the saturated one does not.
    assert_eq!(brought(&[0, 1], &[1.0, 0.8], 1.4, 1.0).2[0].to_bits(), 1f64.to_bits());
    // One cell saturates on the way: the other carries the rest.
    let (grown, _, p) = brought(&[0, 1, 2], &[1.0, 0.5, 0.25], 2.8, 1.0);
    assert!(!grown && p[1] >= 1.0);
    assert_relative_eq!(p[2], 0.8, max_relative = 1e-14);
}

#[test]
fn the_factored_way_ends_where_cells_saturate() {
    // Two summits under a force that one alone would carry above the hardness.
    let grid = Grid::square(2, 1);
    let mut problem = problem(grid, &[0.0, 1.0], 0.5);
    let guess = Guess { set: CellSet::all(grid), p: vec![0.1; 2], d: 1.0 };
    let solved = solve(&mut problem, Control::Force(0.8), guess, TIGHT, &never).unwrap();
    assert_eq!((solved.status, solved.p.len()), (Status::Converged, 2));
    assert!(solved.p[0] >= 0.5 && (solved.p[1] - 0.3).abs() < 1e-12 && solved.q.is_none(), "{:?}", solved.p);
}

#[test]
fn a_pressure_is_scaled_and_cut_by_hand() {
    let scaled = |wanted: f64| {
        let mut p = [1.0, 2.0, 3.0];
        scale_to(wanted, 1.5, &mut p);
        p.to_vec()
    };
    assert_eq!(scaled(1.5), [0.25, 0.5, 0.75]);
    // The last cell saturates at two thirds, the one before it at 5/6.
    assert_eq!(scaled(4.0), [1.0, 1.5, 1.5]);
    assert_eq!(scaled(10.0), [1.5; 3]);
    assert_eq!(scaled(-1.0), [0.0; 3]);
}

#[test]
fn free_cells_and_those_at_their_bound_are_told_apart() {
    let contact = CellSet::from_index(Grid::square(5, 1), &[0, 2, 3, 4]);
    let index = |set: &CellSet| set.index(Grid::square(5, 1)).collect::<Vec<_>>();
    let (p, gap) = ([1.0, 1.0, 0.5, 1.0], [-0.2, 0.3, -0.4, 0.1]);
    let [low, high] = [1.0, 1.5].map(Bounds::UpTo);
    assert_eq!(index(&low.free(&contact, &p)), [3]);
    assert_eq!(index(&high.free(&contact, &p)), [0, 2, 3, 4]);
    assert_eq!((&*low.of_free(&p, &gap), &*high.of_free(&p, &gap)), (&[-0.4][..], &gap[..]));
    // One gap is the noise, the other is larger.
    assert_eq!(index(&low.held(&contact, &p, &gap, 0.1)), [0, 4]);
    assert!(high.held(&contact, &p, &gap, 0.1).is_empty());
    assert!(low.is_reached(&p) && !high.is_reached(&p) && !Bounds::Unlimited.is_reached(&p));
}

#[test]
fn the_approach_is_that_of_elastic_cells_or_of_the_lowest_saturated_ones() {
    let approach = |p: &[f64], displaced: &[f64], everywhere: &[f64]| {
        Bounds::UpTo(1.0).approach(p, displaced, everywhere).unwrap()
    };
    assert_relative_eq!(approach(&[1.0, 0.5, 0.25], &[9.0, 0.2, 0.5], &[]), 0.3, max_relative = 1e-14);
    // One cell, then more than there are.
    assert_eq!(approach(&[1.0], &[0.1], &[0.3, 0.1, 0.2]).to_bits(), 0.2_f64.to_bits());
    assert_eq!(approach(&[1.0; 5], &[0.1; 5], &[0.3, 0.1, 0.2]).to_bits(), 0.3_f64.to_bits());
}

#[test]
fn forces_of_whole_cells_by_hand() {
    let grid = Grid::square(4, 1);
    let saturated = |p: &[f64], force: Option<f64>| {
        let (mut set, mut p) =
            (CellSet::from_index(grid, &(0..p.len() as u32).collect::<Vec<_>>()), p.to_vec());
        round_to(1.0, &mut set, &mut p, force);
        (set.index(grid).collect::<Vec<_>>(), p)
    };
    // The last digit of one cell.
    assert_eq!(saturated(&[1.0 - 1e-15, 0.5], None), (vec![0, 1], vec![1.0, 0.5]));
    assert_eq!(saturated(&[1.0 - 1e-14, 0.5], None), (vec![0, 1], vec![1.0 - 1e-14, 0.5]));
    // Two whole cells, and what rounding left to others.
    let (little, most) = (3e-14, 1.0 - 5e-14);
    let p = [1.0, most, little, 1e-14];
    assert_eq!(saturated(&p, Some(2.0)), (vec![0, 1], vec![1.0, 1.0]));
    assert_eq!(saturated(&p, Some(2.0 + 1e-13)), (vec![0, 1], vec![1.0, 1.0]));
    // With another force, without a force or on other cells the pressures are unchanged.
    for (p, force) in [(p, Some(2.0 + 1e-12)), (p, None), ([1.0, 0.5, 0.5, 1e-14], Some(2.0)), (p, Some(3.0))]
    {
        assert_eq!(saturated(&p, force), (vec![0, 1, 2, 3], p.to_vec()), "{force:?}");
    }
    let mut p = vec![0.5];
    let candidates = Candidates::new(grid, Arc::new(vec![0.0; 4]));
    Bounds::Unlimited.admit(&mut CellSet::from_index(grid, &[0]), &mut p, Some(0.5), &candidates);
    assert_eq!(p, [0.5]);
}

#[test]
fn one_cell_gives_way_where_the_saturated_ones_carry_a_little_too_much() {
    let grid = Grid::square(4, 1);
    let candidates = Candidates::new(grid, Arc::new(vec![0.0, 0.3, 0.1, 0.2]));
    let brought = |p: &[f64], force: f64| {
        let (mut set, mut p) =
            (CellSet::from_index(grid, &(0..p.len() as u32).collect::<Vec<_>>()), p.to_vec());
        bring_to(force, 1.0, &mut set, &mut p, &candidates);
        (set.index(grid).collect::<Vec<_>>(), p)
    };
    // Within rounding nothing is done; beyond, the cell with the largest gap gives way, and elastic cells
    // open.
    assert_eq!(brought(&[1.0, 1.0, 1.0], 3.0 - 3e-13), (vec![0, 1, 2], vec![1.0; 3]));
    let (cells, p) = brought(&[1.0, 1.0, 1.0, 1e-9], 3.0 - 1e-8);
    assert_eq!((cells, p[0], p[2]), (vec![0, 1, 2], 1.0, 1.0));
    assert_relative_eq!(p[1], 1.0 - 1e-8, max_relative = 1e-14);
    // A larger excess is taken from all cells.
    assert_eq!(brought(&[1.0, 1.0], 1.0).1, [0.5, 0.5]);
}

#[test]
fn no_force_comes_from_no_pressure() {
    let mut none = [0.0; 3];
    rescale(&mut none, 5.0);
    assert!(none.iter().all(|&p| p == 0.0));
    let mut some = [1.0, 3.0];
    rescale(&mut some, 2.0);
    assert_relative_eq!(some[..], [0.5, 1.5][..]);
}
