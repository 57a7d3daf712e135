//! Each stopping criterion, compared with runs that end after every step and are evaluated in double
//! precision; solutions compared with those of a factor.

use super::*;
use crate::geometry::{Grid, Lengths};
use crate::kernel::NormalTable;
use crate::kernel::love::SMALLEST_EIGENVALUE;
use crate::linear::Factor;
use crate::operator::{Application, Conditioning, Split};
use crate::real::dot;
use crate::tuning::Tuning;
use approx::assert_relative_eq;
use contact_model::{Boundary, never};

/// The accuracy of one correction in single precision, relative to the norm of the solution.
const SINGLE: f64 = 1e-4;
const SQUARE: Grid = Grid { columns: 16, rows: 16, stretch: 1.0 };
const OBLONG: Grid = Grid { columns: 13, rows: 19, stretch: 1.2 };

fn operators(grid: Grid) -> Operators {
    Operators::new(NormalTable::shared(grid, Boundary::Free), &Tuning::DEFAULT)
}

fn scattered(grid: Grid) -> CellSet {
    CellSet::numbered(grid, |i| (i * i + i / 7) % 5 < 3)
}

fn right(n: usize, unit: f64) -> Vec<f64> {
    (0..n).map(|k| unit * (1.0 + 0.5 * (k as f64 * 1.3).sin())).collect()
}

fn recipe(set: &CellSet, application: Application, conditioning: Conditioning) -> Recipe {
    Recipe { window: set.window().unwrap(), application, conditioning }
}

/// Every way to solve a system on a set: exact ones first, then those of single precision and of two levels.
fn recipes(grid: Grid, set: &CellSet) -> Vec<Recipe> {
    let window = set.window().unwrap();
    let (fft, torus) = (
        Application::Fft(Lengths::free(window)),
        Conditioning::Torus { lengths: Lengths::torus(window), extended: true },
    );
    let split = Split { spacing: 2, reach: 6, order: 8 };
    let mut recipes = vec![
        recipe(set, Application::Direct, Conditioning::Identity),
        recipe(set, fft, Conditioning::Identity),
        recipe(set, Application::Direct, torus),
        recipe(set, fft, torus),
    ];
    if grid.has_square_cells() {
        recipes.push(recipe(set, Application::TwoLevel(split), Conditioning::Identity));
    }
    recipes
}

/// Without and with a preconditioner, the influence matrix by pairs.
fn both(set: &CellSet) -> [Recipe; 2] {
    let torus = Conditioning::Torus { lengths: Lengths::torus(set.window().unwrap()), extended: true };
    [Conditioning::Identity, torus].map(|conditioning| recipe(set, Application::Direct, conditioning))
}

/// Criteria that end only by the number of steps.
fn endless(steps: usize) -> StoppingCriteria {
    StoppingCriteria { reduction: 0.0, energy: None, floor: 0.0, steps }
}

struct Solution {
    x: Vec<f64>,
    /// The residual according to the workspace.
    residual: Vec<f64>,
    outcome: PcgOutcome,
}

/// Selects from a list of two by whether the sum is fixed.
fn fixed(sum: bool) -> Fixed {
    if sum { Fixed::Force } else { Fixed::Approach }
}

/// The systems of a recipe on a set.
struct SystemsOn<'a> {
    set: &'a CellSet,
    recipe: Recipe,
}

impl SystemsOn<'_> {
    /// Solves one in a new workspace.
    fn solve(
        &self,
        operators: &mut Operators,
        right: &[f64],
        fixed: Fixed,
        criteria: StoppingCriteria,
    ) -> Solution {
        let Self { set, recipe } = *self;
        let (mut workspace, mut x) = (Workspace::default(), right.to_vec());
        workspace.take(operators, set.clone(), recipe, &never).unwrap();
        assert_eq!(workspace.set(), set);
        let outcome = workspace.solve(operators, &mut x, fixed, criteria, &never).unwrap();
        // In units of the size of the right-hand side.
        let unit = largest(right);
        let residual = if recipe.is_single() {
            workspace.single.r.iter().map(|&r| unit * f64::from(r)).collect()
        } else {
            workspace.double.r.iter().map(|&r| unit * r).collect()
        };
        Solution { x, residual, outcome }
    }
}

/// Estimated energy `r' G^-1 r`, which no step is needed for.
fn energy(operators: &mut Operators, set: &CellSet, recipe: Recipe, r: &[f64]) -> f64 {
    let found = SystemsOn { set, recipe }.solve(operators, r, Fixed::Approach, endless(0));
    assert!(found.outcome.steps == 0 && found.x.iter().all(|&x| x == 0.0));
    found.outcome.energy
}

/// After each number of steps: the solution and the residual that it leaves.
fn path(grid: Grid, set: &CellSet, recipe: Recipe, right: &[f64]) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut operators = operators(grid);
    let after = |steps: usize| {
        let Solution { x, residual, outcome } =
            SystemsOn { set, recipe }.solve(&mut operators, right, Fixed::Approach, endless(steps));
        assert_eq!((outcome.steps, outcome.applications), (steps, steps));
        let mut u = Vec::new();
        operators.exact(set, &x, set, &mut u, &never).unwrap();
        let left: Vec<f64> = right.iter().zip(&u).map(|(r, u)| r - u).collect();
        for (residual, left) in residual.iter().zip(&left) {
            assert_relative_eq!(*residual, *left, epsilon = SINGLE * largest(right));
        }
        (x, left)
    };
    (0..9).map(after).collect()
}

/// The first step at which something holds, or will hold after one more step that gains as much as the last
/// one.
///
/// `value(n)` is compared with `bound(n)`; an iteration ends after step n where the value expected there is
/// small enough already.
fn first_step(from: usize, value: impl Fn(usize) -> f64, bound: impl Fn(usize) -> f64) -> usize {
    (from..8)
        .find(|&n| {
            let reached = value(n) <= bound(n);
            let expected = n > 1 && value(n - 1) * (value(n - 1) / value(n - 2)) <= bound(n);
            reached || expected || (n == 1 && value(0) <= bound(1))
        })
        .unwrap()
}

#[test]
fn every_recipe_reaches_the_factored_solution() {
    for grid in [SQUARE, OBLONG] {
        let set = scattered(grid);
        let mut operators = operators(grid);
        let r: Vec<f64> = (0..set.len()).map(|k| (k as f64 * 1.3).sin() + 0.2).collect();
        let (q, w) = Factor::new(operators.table(), &set).unwrap().solve_pair(&r);
        let norm = dot(&w, &w).sqrt();
        for recipe in recipes(grid, &set) {
            for fixed_sum in [false, true] {
                let criteria = StoppingCriteria { reduction: 1e-5, ..endless(200) };
                let before = operators.plans.solves;
                let found =
                    SystemsOn { set: &set, recipe }.solve(&mut operators, &r, fixed(fixed_sum), criteria);
                assert_eq!(operators.plans.solves, before + 1);
                // With a fixed sum the approach takes up the rest: x = w - (sum w / sum q) q.
                let shift = if fixed_sum { w.iter().sum::<f64>() / q.iter().sum::<f64>() } else { 0.0 };
                for ((x, w), q) in found.x.iter().zip(&w).zip(&q) {
                    assert!((x - (w - shift * q)).abs() < SINGLE * norm, "{recipe} {fixed_sum}");
                }
                let sum = found.x.iter().sum::<f64>().abs();
                assert!(
                    !fixed_sum || sum < if recipe.is_single() { SINGLE } else { 1e-9 } * norm,
                    "{recipe}: {sum}"
                );
                // Work, not time: the preconditioner makes the number of steps small.
                let steps = found.outcome.steps;
                assert!(
                    steps <= if recipe.has_preconditioner() { 25 } else { 60 },
                    "{recipe}: {steps} steps"
                );
                // Eight times the gap asks for eight times the pressure, to the last bit, in as many steps.
                let eight: Vec<f64> = r.iter().map(|r| 8.0 * r).collect();
                let again =
                    SystemsOn { set: &set, recipe }.solve(&mut operators, &eight, fixed(fixed_sum), criteria);
                assert_eq!(again.outcome.steps, steps);
                assert!(again.x.iter().zip(&found.x).all(|(a, b)| (a - 8.0 * b).abs() <= 0.0));
            }
        }
    }
}

#[test]
fn the_position_of_a_set_in_its_grid_does_not_matter() {
    let grid = Grid::square(40, 40);
    let at = |x0: usize, y0: usize| {
        let cells = scattered(SQUARE);
        let index: Vec<u32> = cells.places().map(|(x, y)| ((y + y0) * 40 + x + x0) as u32).collect();
        CellSet::from_index(grid, &index)
    };
    let (corner, inside) = (at(0, 0), at(13, 9));
    let r = right(corner.len(), 1.0);
    for (here, there) in both(&corner).into_iter().zip(both(&inside)) {
        let [one, other] = [(&corner, here), (&inside, there)].map(|(set, recipe)| {
            SystemsOn { set, recipe }.solve(&mut operators(grid), &r, Fixed::Approach, endless(4)).x
        });
        assert_eq!(one, other, "{here}");
    }
}

#[test]
fn earlier_contents_of_a_workspace_do_not_matter() {
    let (set, mut operators) = (scattered(SQUARE), operators(SQUARE));
    let r = right(set.len(), 1.0);
    for fixed_sum in [false, true] {
        let mut used = Workspace::default();
        for recipe in recipes(SQUARE, &set) {
            let criteria = StoppingCriteria { reduction: 1e-3, ..endless(50) };
            let fresh = SystemsOn { set: &set, recipe }.solve(&mut operators, &r, fixed(fixed_sum), criteria);
            used.begin_load();
            used.take(&mut operators, CellSet::from_index(SQUARE, &[3, 77, 200]), recipe, &never).unwrap();
            used.solve(&mut operators, &mut [1.0, -2.0, 9.0], fixed(fixed_sum), endless(2), &never).unwrap();
            used.begin_load();
            used.take(&mut operators, set.clone(), recipe, &never).unwrap();
            let mut x = r.clone();
            used.solve(&mut operators, &mut x, fixed(fixed_sum), criteria, &never).unwrap();
            assert_eq!(x, fresh.x, "{recipe}");
        }
    }
}

#[test]
fn weights_of_another_set_lead_to_the_same_solution() {
    // The weights of the first set of a load are carried to the next: they change the way, not the end of it.
    let (set, mut operators) = (scattered(SQUARE), operators(SQUARE));
    let order: Vec<usize> = (0..set.len()).collect();
    let part = set.filter(&order, |k| k % 4 != 0);
    let r = right(part.len(), 1.0);
    let (q, w) = Factor::new(operators.table(), &part).unwrap().solve_pair(&r);
    let (norm, shift) = (dot(&w, &w).sqrt(), w.iter().sum::<f64>() / q.iter().sum::<f64>());
    for recipe in recipes(SQUARE, &set) {
        let mut workspace = Workspace::default();
        workspace.take(&mut operators, set.clone(), recipe, &never).unwrap();
        workspace
            .solve(&mut operators, &mut right(set.len(), 1.0), Fixed::Force, endless(3), &never)
            .unwrap();
        workspace.take(&mut operators, part.clone(), recipe, &never).unwrap();
        let mut x = r.clone();
        let criteria = StoppingCriteria { reduction: 1e-5, ..endless(200) };
        workspace.solve(&mut operators, &mut x, Fixed::Force, criteria, &never).unwrap();
        for ((x, w), q) in x.iter().zip(&w).zip(&q) {
            assert!((x - (w - shift * q)).abs() < SINGLE * norm, "{recipe}: {x} {}", w - shift * q);
        }
    }
}

#[test]
fn the_energy_estimates_bound_the_energy() {
    for grid in [SQUARE, OBLONG] {
        let (set, mut operators) = (scattered(grid), operators(grid));
        let wave: Vec<f64> = (0..set.len()).map(|k| (k as f64 * 1.3).sin()).collect();
        let smooth: Vec<f64> = set.places().map(|(x, _)| 1.0 + 0.1 * x as f64).collect();
        for r in [wave, smooth] {
            let (_, w) = Factor::new(operators.table(), &set).unwrap().solve_pair(&r);
            let exact = dot(&r, &w);
            for recipe in recipes(grid, &set) {
                let estimate = energy(&mut operators, &set, recipe, &r);
                assert!(estimate >= exact, "{recipe}: {estimate} {exact}");
                // In the units of the right-hand side.
                let large: Vec<f64> = r.iter().map(|r| 1e100 * r).collect();
                let scaled = energy(&mut operators, &set, recipe, &large);
                assert_relative_eq!(scaled, 1e200 * estimate, max_relative = 1e-4);
            }
        }
    }
}

#[test]
fn the_energy_of_the_error_is_compared_with_the_value_gained() {
    // r'G^-1 r of what is left, at most |r|^2 / eigenvalue or 2 r'M r, against a share of base + r'x, in any
    // unit.
    let set = scattered(SQUARE);
    for unit in [1.0, 1e3] {
        let right = right(set.len(), unit);
        for recipe in both(&set) {
            let path = path(SQUARE, &set, recipe, &right);
            let mut operators = operators(SQUARE);
            let left: Vec<f64> = path.iter().map(|(_, r)| energy(&mut operators, &set, recipe, r)).collect();
            let mut found = Vec::new();
            for share in [3e-1, 3e-2, 3e-3, 3e-4] {
                for base in [0.0, 200.0 * unit * unit] {
                    let bound = |n: usize| share * (base + dot(&path[n].0, &right));
                    let expected = if left[0] <= bound(0) { 0 } else { first_step(1, |n| left[n], bound) };
                    let criteria = StoppingCriteria { energy: Some(Energy { share, base }), ..endless(50) };
                    let got = SystemsOn { set: &set, recipe }
                        .solve(&mut operators, &right, Fixed::Approach, criteria)
                        .outcome
                        .steps;
                    assert_eq!(got, expected, "{unit} {recipe} {share} {base}");
                    found.push(got);
                }
            }
            assert!(found.iter().max().unwrap() >= &3, "this test is about several steps: {found:?}");
        }
    }
}

#[test]
fn it_ends_at_the_first_step_with_the_requested_reduction() {
    let set = scattered(SQUARE);
    let right = right(set.len(), 1.0);
    for recipe in both(&set) {
        let path = path(SQUARE, &set, recipe, &right);
        let mut operators = operators(SQUARE);
        let left: Vec<f64> = path.iter().map(|(_, r)| energy(&mut operators, &set, recipe, r)).collect();
        for reduction in [2.0f64, 0.3, 0.1, 0.03] {
            // The first step is always taken.
            let expected = first_step(1, |n| left[n], |_| reduction.powi(2) * left[0]);
            let criteria = StoppingCriteria { reduction, ..endless(50) };
            let got = SystemsOn { set: &set, recipe }
                .solve(&mut operators, &right, Fixed::Approach, criteria)
                .outcome
                .steps;
            assert_eq!(got, expected, "{recipe} reduction {reduction}");
        }
        assert!(left[8] < 1e-3 * left[0], "eight steps gain something");
    }
}

#[test]
fn the_floor_is_the_largest_residual() {
    let set = scattered(SQUARE);
    for unit in [1.0, 1e-3] {
        let right = right(set.len(), unit);
        for recipe in both(&set) {
            let path = path(SQUARE, &set, recipe, &right);
            for share in [2.0, 0.3, 0.1, 0.03] {
                let floor = share * unit;
                let expected = path.iter().position(|(_, r)| largest(r) <= floor).unwrap();
                let criteria = StoppingCriteria { floor, ..endless(50) };
                let got = SystemsOn { set: &set, recipe }.solve(
                    &mut operators(SQUARE),
                    &right,
                    Fixed::Approach,
                    criteria,
                );
                assert_eq!(got.outcome.steps, expected, "{recipe} {floor}");
            }
        }
    }
}

#[test]
fn work_is_counted_and_a_uniform_gap_needs_none_under_a_given_force() {
    let (set, mut operators) = (scattered(SQUARE), operators(SQUARE));
    let uniform = vec![1.0; set.len()];
    let [identity, torus] = both(&set);
    let got =
        SystemsOn { set: &set, recipe: identity }.solve(&mut operators, &uniform, Fixed::Force, endless(5));
    assert!(got.outcome.steps == 0 && got.x.iter().all(|&x| x == 0.0));
    assert_eq!((operators.plans.applications, operators.plans.solves), (0, 1));
    SystemsOn { set: &set, recipe: torus }.solve(&mut operators, &uniform, Fixed::Approach, endless(5));
    assert_eq!((operators.plans.applications, operators.plans.solves), (5, 2));
    assert_eq!(operators.last(), Some(torus));
    // Nothing is asked for.
    let got = SystemsOn { set: &set, recipe: torus }.solve(
        &mut operators,
        &vec![0.0; set.len()],
        Fixed::Approach,
        endless(5),
    );
    assert!(got.outcome.steps == 0 && got.x.iter().all(|&x| x == 0.0));
    // Stopped at once.
    let (mut workspace, mut x) = (Workspace::default(), uniform);
    workspace.take(&mut operators, set.clone(), torus, &never).unwrap();
    let stopped = workspace.solve(&mut operators, &mut x, Fixed::Approach, endless(5), &|| true);
    assert!(stopped.is_err() && x == vec![1.0; x.len()], "the right-hand side is as it was");
    assert_eq!(operators.plans.applications, 5);
}

#[test]
fn the_eigenvalue_bounds_the_energy_by_hand() {
    let mut operators = operators(SQUARE);
    let pair = CellSet::from_index(SQUARE, &[0, 1]);
    let [identity, _] = both(&pair);
    let found = energy(&mut operators, &pair, identity, &[1.0, -2.0]);
    assert_relative_eq!(found, 5.0 / SMALLEST_EIGENVALUE, max_relative = 1e-14);
    // The checkerboard on a full grid comes close to its eigenvalue, the smallest one.
    let all = CellSet::all(SQUARE);
    let board: Vec<f64> =
        all.places().map(|(x, y)| if (x + y).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
    let mut u = Vec::new();
    operators.exact(&all, &board, &all, &mut u, &never).unwrap();
    let eigenvalue = dot(&board, &u) / dot(&board, &board);
    assert!((1.0..1.1).contains(&(eigenvalue / SMALLEST_EIGENVALUE)), "{eigenvalue}");
}
