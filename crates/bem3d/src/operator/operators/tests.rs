//! Every operator compared with the direct sum, the reuse of plans, and the counting of work.

use super::*;
use crate::geometry::{Grid, Lengths};
use crate::kernel::love::influence;
use crate::operator::DirectSum;
use crate::real::{dot, largest};
use approx::assert_relative_eq;
use contact_model::Boundary;
use contact_model::never;
use proptest::prelude::*;

/// Rounding of a double-precision transform of a few thousand points.
const DOUBLE: f64 = 1e-13;
/// Noise floor of a single-precision one.
const SINGLE: f64 = 2e-6;

fn picked(grid: Grid, picks: &[bool]) -> CellSet {
    CellSet::numbered(grid, |i| picks[i % picks.len()])
}

fn pressure(n: usize) -> Vec<f64> {
    (0..n).map(|k| 1.0 + (k as f64 * 0.7).sin()).collect()
}

fn operators(grid: Grid, boundary: Boundary) -> Operators {
    Operators::new(NormalTable::shared(grid, boundary), &Tuning::DEFAULT)
}

fn directly(table: &NormalTable, sources: &CellSet, p: &[f64], targets: &CellSet) -> Vec<f64> {
    let mut u = vec![0.0; targets.len()];
    DirectSum(table).apply(sources, p, targets, &mut u);
    u
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

fn recipe(window: Window, application: Application) -> Recipe {
    Recipe { window, application, conditioning: Conditioning::Identity }
}

#[test]
fn a_circular_length_of_twice_n_less_one_is_exact() {
    // The lag n - 1 meets its own mirror image; an odd kernel would not survive this.
    for (columns, rows) in [(2, 2), (3, 3), (5, 5), (9, 9), (33, 33), (2, 9), (33, 5), (5, 1)] {
        let grid = Grid::square(columns, rows);
        let table = NormalTable::shared(grid, Boundary::Free);
        let (all, window) = (CellSet::all(grid), grid.window());
        let lengths = Lengths::free(window);
        let shortest = |n: usize| (2 * (n - 1)).max(2);
        assert_eq!(
            (lengths.x, lengths.y),
            (shortest(columns), shortest(rows)),
            "this test is about the shortest lengths"
        );
        let p = pressure(all.len());
        let mut u = vec![0.0; p.len()];
        FftConvolution::new(window, lengths, table.symbol_f64(lengths, &never).unwrap())
            .apply(&all, &p, &all, &mut u);
        for (a, b) in directly(&table, &all, &p, &all).iter().zip(&u) {
            assert_relative_eq!(a, b, max_relative = DOUBLE);
        }
    }
}

#[test]
fn the_torus_inverse_undoes_the_operator_on_smooth_pressure() {
    // Far from the edges B G p = p up to what the wrapped kernel lacks.
    for grid in [Grid::square(48, 48), Grid::square(60, 48), Grid { columns: 54, rows: 40, stretch: 0.9 }] {
        let mut operators = operators(grid, Boundary::Free);
        let (all, (a, b)) = (CellSet::all(grid), grid.cell());
        let middle = |x: usize, n: usize, side: f64| (x as f64 - n as f64 / 2.0) * side;
        let p: Vec<f64> = all
            .places()
            .map(|(x, y)| {
                let (x, y) = (middle(x, grid.columns, a), middle(y, grid.rows, b));
                (-(x * x + y * y) / 18.0).exp()
            })
            .collect();
        let mut u = Vec::new();
        operators.exact(&all, &p, &all, &mut u, &never).unwrap();
        let conditioning =
            Conditioning::Torus { lengths: operators.table().torus_lengths(grid.window()), extended: true };
        let system = Recipe { conditioning, ..recipe(grid.window(), Application::Direct) };
        let (_, inverse) = operators.system(system, &never).unwrap();
        let mut back = vec![0.0; p.len()];
        inverse.unwrap().apply(&all, &u, &all, &mut back);
        let inner = |x: usize, n: usize| (n / 6..n - n / 6).contains(&x);
        let errors = all
            .places()
            .zip(back.iter().zip(&p))
            .filter(|((x, y), _)| inner(*x, grid.columns) && inner(*y, grid.rows));
        let error = errors.map(|(_, (back, p))| (back - p).abs()).fold(0.0, f64::max);
        assert!(error < 0.05, "{grid:?}: {error}");
        assert_eq!(operators.plans.applications, 1, "the preconditioner is not an application of K");
    }
}

#[test]
fn a_shortened_transform_is_exact_up_to_three_quarters_of_the_window_and_positive_definite() {
    for (columns, rows, expected) in [(48, 48, Lengths { x: 72, y: 72 }), (54, 48, Lengths { x: 80, y: 72 })]
    {
        let grid = Grid::square(columns, rows);
        let (all, window) = (CellSet::all(grid), grid.window());
        let mut operators = operators(grid, Boundary::Free);
        let table = Arc::clone(&operators.plans.table);
        let (short, free) = (table.shortened_lengths(window, 1.5), table.exact_lengths(window));
        assert_eq!(short, expected);
        assert!(table.symbol_f64(short, &never).unwrap().iter().all(|&[s]| s > 0.0));
        let mut apply = |lengths: Lengths, p: &[f64]| {
            let mut u = vec![0.0; p.len()];
            operators
                .system(recipe(window, Application::Fft(lengths)), &never)
                .unwrap()
                .0
                .apply(&all, p, &all, &mut u);
            u
        };
        // One pressed cell in a corner: u is the kernel itself; lags of more than half way round are taken
        // the other way.
        let mut p = vec![0.0; all.len()];
        p[0] = 1.0;
        for ((x, y), u) in all.places().zip(apply(short, &p)) {
            let expected = influence(x.min(short.x - x), y.min(short.y - y));
            assert_relative_eq!(u, expected, max_relative = SINGLE, epsilon = SINGLE);
        }
        // Corrections without a sum: what is missing is small. A plain one: it is not.
        let wave: Vec<f64> = (0..all.len()).map(|k| (k as f64 * 0.37).sin()).collect();
        let mean = wave.iter().sum::<f64>() / wave.len() as f64;
        let without_sum: Vec<f64> = wave.iter().map(|w| w - mean).collect();
        let mut lacks = |p: &[f64]| {
            let (wrapped, exact) = (apply(short, p), apply(free, p));
            difference(&wrapped, &exact) / largest(&exact)
        };
        assert!(lacks(&without_sum) < 0.02 && lacks(&vec![1.0; all.len()]) > 0.02);
    }
}

#[test]
fn a_transform_is_planned_once_and_kept_where_it_serves() {
    let grid = Grid::square(40, 30);
    let mut operators = operators(grid, Boundary::Free);
    let table = Arc::clone(&operators.plans.table);
    let window = |x, y, width, height| Window { x, y, width, height };
    let rows = |w: Window| {
        CellSet::from_rows((w.y..w.y + w.height).map(move |y| (y, w.x as u32..(w.x + w.width) as u32)))
    };
    let planned = |operators: &Operators| {
        (
            operators.plans.single.as_ref().map(FftConvolution::window),
            operators.plans.shortened.as_ref().map(FftConvolution::window),
        )
    };
    let (large, part, other) = (window(2, 3, 30, 20), window(3, 4, 27, 18), window(5, 1, 30, 20));
    // (window, short, plan of all lags, plan of short ones)
    for (w, short, single, shortened) in [
        (large, false, Some(large), None),
        (part, true, Some(large), Some(part)),
        (part, false, Some(large), Some(part)),
        (large, true, Some(large), Some(large)),
        (other, false, Some(other), Some(large)),
    ] {
        let lengths = if short { table.shortened_lengths(w, 1.5) } else { table.exact_lengths(w) };
        let set = rows(w);
        let (p, mut u) = (pressure(set.len()), vec![0.0; set.len()]);
        operators
            .system(recipe(w, Application::Fft(lengths)), &never)
            .unwrap()
            .0
            .apply(&set, &p, &set, &mut u);
        assert_eq!(planned(&operators), (single, shortened));
        // Lags are taken the shorter way round the plan that was used, which is exact for all of them where
        // it is not a short one.
        let used = if short { table.shortened_lengths(shortened.unwrap(), 1.5) } else { lengths };
        let fold = |a: usize, b: usize, period: usize| a.abs_diff(b).min(period - a.abs_diff(b));
        let exact: Vec<f64> = set
            .places()
            .map(|(x, y)| {
                let pairs = set.places().zip(&p);
                pairs.map(|((xs, ys), p)| p * influence(fold(x, xs, used.x), fold(y, ys, used.y))).sum()
            })
            .collect();
        assert!(difference(&u, &exact) <= SINGLE * largest(&exact), "{w:?} {}", difference(&u, &exact));
    }
}

#[test]
fn applications_are_counted_and_empty_sets_are_free() {
    let grid = Grid::square(64, 64);
    let mut operators = operators(grid, Boundary::Free);
    let (all, none) = (CellSet::all(grid), CellSet::default());
    let p = pressure(all.len());
    for (sources, p, targets) in [(&none, &[][..], &all), (&all, &p[..], &none)] {
        let mut u = vec![1.0; 7];
        operators.rough(sources, p, targets, &mut u, &never).unwrap();
        assert!(u.len() == targets.len() && u.iter().all(|&u| u == 0.0));
        operators.exact(sources, p, targets, &mut u, &never).unwrap();
        assert!(u.len() == targets.len() && u.iter().all(|&u| u == 0.0));
    }
    assert_eq!(operators.plans.applications, 0);
    // A few cells never pay for a transform of the grid.
    let (few, mut u) = (CellSet::from_index(grid, &[0, 65, 4095]), Vec::new());
    operators.exact(&few, &[1.0, 2.0, 3.0], &few, &mut u, &never).unwrap();
    assert!(operators.plans.double.is_none() && operators.plans.applications == 1);
    operators.exact(&all, &p, &all, &mut u, &never).unwrap();
    assert!(operators.plans.double.is_some() && operators.plans.applications == 2);
    operators.rough(&all, &p, &all, &mut u, &never).unwrap();
    assert!(operators.plans.single.is_some() && operators.plans.applications == 3);
    assert!(operators.last().is_none() && operators.plans.solves == 0, "no system was solved");
}

#[test]
fn two_levels_follow_the_sets_and_are_kept_where_they_fit() {
    /// Interpolation of order 6 at a reach of 6 (see `two_level`).
    const INTERPOLATED: f64 = 1e-4;
    // Two windows apart from each other that want the same split: a plan of one is wrong for the other.
    let grid = Grid::square(800, 750);
    let scattered = |columns: std::ops::Range<u32>| {
        let index: Vec<u32> =
            (0..grid.count() as u32).step_by(311).filter(|i| columns.contains(&(i % 800))).collect();
        CellSet::from_index(grid, &index)
    };
    let (left, right, part) = (scattered(0..390), scattered(410..800), scattered(0..380));
    let mut operators = operators(grid, Boundary::Free);
    let table = Arc::clone(&operators.plans.table);
    let mut plans = Vec::new();
    for cells in [&left, &right, &left, &part] {
        let p = pressure(cells.len());
        let (exact, mut fast) = (directly(&table, cells, &p, cells), Vec::new());
        operators.rough(cells, &p, cells, &mut fast, &never).unwrap();
        assert!(difference(&exact, &fast) <= INTERPOLATED * largest(&exact), "{}", difference(&exact, &fast));
        // A system on the same cells is solved with the same plan.
        let system = operators.planner().system(cells, cells.len(), false).unwrap();
        assert!(system.to_string().starts_with("two levels, spacing"), "{system}");
        operators.system(system, &never).unwrap().0.apply(cells, &p, cells, &mut fast);
        assert!(difference(&exact, &fast) <= INTERPOLATED * largest(&exact));
        assert_eq!(operators.last(), Some(system));
        plans.push(operators.two_level.as_ref().map(|o| (o.window(), o.split())).unwrap());
    }
    assert_eq!(plans[0].1, plans[1].1, "this test is about one split on two windows");
    assert_eq!(Some(plans[2].0), left.window());
    // Work: a slightly smaller window keeps the plan.
    assert!(part.window() != left.window());
    assert_eq!(plans[3], plans[2]);
    // Where approximations of the far field are not wanted, there are none.
    operators.two_levels = false;
    let system = operators.planner().system(&left, left.len(), false).unwrap();
    assert!(!matches!(system.application, Application::TwoLevel(_)));
}

#[test]
fn a_recipe_is_described() {
    let grid = Grid::square(64, 64);
    let operators = operators(grid, Boundary::Free);
    let described = |set: &CellSet| operators.planner().system(set, set.len(), true).unwrap().to_string();
    assert_eq!(described(&CellSet::from_index(grid, &[0, 4095])), "direct");
    // 2 (64 - 1) = 126 has a factor 7; 128 is the next good length.
    assert_eq!(described(&CellSet::all(grid)), "fft 128 x 128, f32 in f64, extended torus inverse 72 x 72");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn every_operator_agrees_with_the_direct_sum(
        columns in 1usize..40, rows in 1usize..40, stretch in prop_oneof![Just(1.0), 0.5f64..2.0],
        periodic in any::<bool>(),
        sources in prop::collection::vec(any::<bool>(), 1..90),
        targets in prop::collection::vec(any::<bool>(), 1..90),
    ) {
        let grid = Grid { columns, rows, stretch };
        let (sources, targets) = (picked(grid, &sources), picked(grid, &targets));
        prop_assume!(!sources.is_empty() && !targets.is_empty());
        let boundary = if periodic { Boundary::Periodic } else { Boundary::Free };
        let p = pressure(sources.len());
        let table = NormalTable::shared(grid, boundary);
        let exact = directly(&table, &sources, &p, &targets);
        let scale = largest(&exact);
        let window = sources.window().unwrap().union(targets.window().unwrap());
        let lengths = table.exact_lengths(window);
        let mut u = vec![0.0; targets.len()];
        FftConvolution::new(window, lengths, table.symbol_f64(lengths, &never).unwrap()).apply(&sources, &p, &targets, &mut u);
        prop_assert!(difference(&exact, &u) <= DOUBLE * scale);
        let mut single = FftConvolution::<f32>::new(window, lengths, table.symbol_f32(lengths, &never).unwrap());
        single.apply(&sources, &p, &targets, &mut u);
        prop_assert!(difference(&exact, &u) <= SINGLE * scale);
        // What is chosen, and what is planned for a larger window.
        let mut operators = operators(grid, boundary);
        let all = CellSet::all(grid);
        operators.rough(&all, &pressure(all.len()), &all, &mut Vec::new(), &never).unwrap();
        operators.rough(&sources, &p, &targets, &mut u, &never).unwrap();
        prop_assert!(difference(&exact, &u) <= 1e-4 * scale);
        operators.exact(&all, &pressure(all.len()), &all, &mut Vec::new(), &never).unwrap();
        operators.exact(&sources, &p, &targets, &mut u, &never).unwrap();
        prop_assert!(difference(&exact, &u) <= DOUBLE * scale);
    }

    #[test]
    fn reciprocity(
        columns in 2usize..30, rows in 1usize..30, periodic in any::<bool>(),
        a in prop::collection::vec(any::<bool>(), 1..60),
        b in prop::collection::vec(any::<bool>(), 1..60),
    ) {
        // Maxwell-Betti: the work of one load on the other's displacement is mutual.
        let grid = Grid { columns, rows, stretch: 1.1 };
        let (a, b) = (picked(grid, &a), picked(grid, &b));
        prop_assume!(!a.is_empty() && !b.is_empty());
        let boundary = if periodic { Boundary::Periodic } else { Boundary::Free };
        let mut operators = operators(grid, boundary);
        let (pa, pb) = (pressure(a.len()), pressure(b.len()));
        let (mut ub, mut ua) = (Vec::new(), Vec::new());
        operators.exact(&a, &pa, &b, &mut ub, &never).unwrap();
        operators.exact(&b, &pb, &a, &mut ua, &never).unwrap();
        let (one, two) = (dot(&ub, &pb), dot(&ua, &pa));
        prop_assert!((one - two).abs() <= DOUBLE * one.abs());
    }
}
