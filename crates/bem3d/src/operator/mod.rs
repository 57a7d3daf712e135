//! The elastic operator `u = K p` between sets of cells, in scaled units (`u_i = sum_j I(i - j) p_j`).
//!
//! [`direct`] is the exact sum over pairs of cells, [`convolution`] the FFT on a window, [`lattice`] two levels for scattered
//! cells, [`dense`] the factor of a small set.
//! [`Operators`] holds the ones that a surface needs and makes each when it is first asked for.

pub mod convolution;
pub mod dense;
pub mod direct;
pub mod lattice;
mod periodic;
mod table;

pub use table::Table;

use crate::cells::{CellSet, Window};
use crate::strategy::{Choice, exact_choice, fast_choice};
use contact_model::Boundary;
use convolution::{Convolution, Lengths};
use lattice::TwoLevel;
use std::sync::Arc;

/// The operators of one surface, with the count of what they did.
#[derive(Debug)]
pub struct Operators {
    table: Arc<Table>,
    exact: Option<Convolution<f64>>,
    fast: Option<Convolution<f32>>,
    two_level: Option<TwoLevel>,
    inverse: Option<Convolution<f32>>,
    wrapped: Option<Convolution<f32>>,
    /// Applications of K so far, all precisions together.
    pub applications: usize,
    /// Linear systems so far: factors and runs of conjugate gradients.
    pub solves: usize,
    /// Whether the two-level operator may be chosen (it knows the free kernel alone).
    pub two_levels: bool,
    /// What the last fast application was done with.
    last: Option<Choice>,
}

impl Operators {
    /// Nothing is built yet.
    pub fn new(table: Arc<Table>) -> Self {
        // The far field of two levels is that of 1/r.
        let free = table.boundary() == Boundary::Free;
        Self {
            table,
            exact: None,
            fast: None,
            two_level: None,
            inverse: None,
            wrapped: None,
            applications: 0,
            solves: 0,
            two_levels: free,
            last: None,
        }
    }

    /// The kernel table.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// `u = K p` in double precision without approximation: direct sums or the FFT, whichever is cheaper.
    pub fn exact(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet) -> Vec<f64> {
        let mut u = vec![0.0; targets.len()];
        if sources.is_empty() || targets.is_empty() {
            return u;
        }
        self.applications += 1;
        let window = union(sources, targets);
        if exact_choice(sources.len(), targets.len(), self.table.lengths(window)) == Choice::Direct {
            direct::apply(&self.table, sources, p, targets, &mut u);
        } else {
            let table = &self.table;
            let operator = planned(&mut self.exact, window, table, |t, w| {
                let lengths = t.lengths(w);
                Convolution::new(w, lengths, t.symbol_f64(lengths))
            });
            operator.apply(sources, p, targets, &mut u);
        }
        u
    }

    /// `u = K p` to five digits or more, for use inside an iteration that is checked with [`Self::exact`].
    pub fn fast(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut [f64]) {
        self.single(sources, p, targets, u, true);
    }

    /// `u = K p` on one set for corrections: as [`Self::fast`] where `exact`, else by a transform, where one is used, on a torus too small
    /// for the farthest lags ([`Lengths::wrapped`]).
    ///
    /// At a prescribed force a correction has no sum, so that the far lags count for little; what they lack is seen by the look that
    /// follows in any case. Half the cost.
    pub fn correcting(&mut self, set: &CellSet, p: &[f64], u: &mut [f64], exact: bool) {
        self.single(set, p, set, u, exact);
    }

    fn single(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut [f64], exact: bool) {
        if sources.is_empty() || targets.is_empty() {
            return u.fill(0.0);
        }
        self.applications += 1;
        let window = union(sources, targets);
        let choice = if self.two_levels {
            fast_choice(sources, targets, window)
        } else {
            exact_choice(sources.len(), targets.len(), self.table.lengths(window))
        };
        match choice {
            Choice::Direct => direct::apply(&self.table, sources, p, targets, u),
            Choice::TwoLevel(split) => {
                if !self.two_level.as_ref().is_some_and(|o| o.split() == split && fits(o.window(), window)) {
                    self.two_level = None;
                }
                let operator = self.two_level.get_or_insert_with(|| TwoLevel::new(window, split));
                operator.apply(sources, p, targets, u);
            }
            Choice::Fft => self.transform(window, exact).apply(sources, p, targets, u),
        }
        self.last = Some(choice);
    }

    /// The single-precision transform of a window, exact or wrapped.
    fn transform(&mut self, window: Window, exact: bool) -> &mut Convolution<f32> {
        let slot = if exact { &mut self.fast } else { &mut self.wrapped };
        planned(slot, window, &self.table, |table, window| {
            let lengths = table.lengths(window);
            let lengths = if exact { lengths } else { lengths.wrapped(window) };
            Convolution::new(window, lengths, table.symbol_f32(lengths))
        })
    }

    /// `u = K p` in double precision over the whole grid: `fill` writes row y, `take` reads row y of the result.
    pub fn exact_rows(
        &mut self,
        side: usize,
        fill: impl FnMut(usize, &mut [f64]),
        take: impl FnMut(usize, &[f64]),
    ) {
        self.applications += 1;
        let operator = planned(&mut self.exact, whole(side), &self.table, |t, w| {
            let lengths = t.lengths(w);
            Convolution::new(w, lengths, t.symbol_f64(lengths))
        });
        operator.rows(|_| true, fill, |_| true, take);
    }

    /// The same in single precision.
    pub fn fast_rows(
        &mut self,
        side: usize,
        fill: impl FnMut(usize, &mut [f32]),
        take: impl FnMut(usize, &[f32]),
    ) {
        self.correcting_rows(side, true, fill, take);
    }

    /// [`Self::correcting`] over the whole grid.
    pub fn correcting_rows(
        &mut self,
        side: usize,
        exact: bool,
        fill: impl FnMut(usize, &mut [f32]),
        take: impl FnMut(usize, &[f32]),
    ) {
        self.applications += 1;
        self.last = Some(Choice::Fft);
        self.transform(whole(side), exact).rows(|_| true, fill, |_| true, take);
    }

    /// [`Self::inverse`] over the whole grid.
    pub fn inverse_rows(
        &mut self,
        side: usize,
        fill: impl FnMut(usize, &mut [f32]),
        take: impl FnMut(usize, &[f32]),
    ) {
        let operator = planned(&mut self.inverse, whole(side), &self.table, |t, w| {
            let lengths = Lengths::torus(w);
            Convolution::new(w, lengths, t.inverse_symbol(lengths))
        });
        operator.rows(|_| true, fill, |_| true, take);
    }

    /// `out = B r` on the same set: the inverse of the kernel wrapped on a torus around the set (about |q| / 2 pi).
    ///
    /// Positive definite. A quarter of the cost of K or less.
    pub fn inverse(&mut self, set: &CellSet, r: &[f64], out: &mut [f64]) {
        let Some(window) = set.window() else { return };
        let operator = planned(&mut self.inverse, window, &self.table, |t, w| {
            let lengths = Lengths::torus(w);
            Convolution::new(w, lengths, t.inverse_symbol(lengths))
        });
        operator.apply(set, r, set, out);
    }
}

impl Operators {
    /// What was used for a state, in one short phrase.
    pub fn describe(&self, solved: &crate::active_set::Solved) -> String {
        if solved.q.is_some() {
            return format!("dense {}", solved.contact.len());
        }
        match (self.last, self.fast.as_ref().or(self.wrapped.as_ref())) {
            (Some(Choice::Fft), Some(fast)) => {
                format!("fft {} x {}, f32 in f64", fast.lengths().x, fast.lengths().y)
            }
            (Some(Choice::TwoLevel(split)), _) => {
                format!("two levels, spacing {} reach {} order {}", split.spacing, split.reach, split.order)
            }
            _ => format!("direct {}", solved.contact.len()),
        }
    }
}

/// The window of a whole grid.
fn whole(side: usize) -> Window {
    Window { x: 0, y: 0, width: side, height: side }
}

/// The convolution of `slot` where its window holds the wanted one without waste, else a new one.
fn planned<'a, T: convolution::Real>(
    slot: &'a mut Option<Convolution<T>>,
    window: Window,
    table: &Table,
    plan: impl Fn(&Table, Window) -> Convolution<T>,
) -> &'a mut Convolution<T> {
    if !slot.as_ref().is_some_and(|c| fits(c.window(), window)) {
        *slot = None;
    }
    slot.get_or_insert_with(|| plan(table, window))
}

fn fits(planned: Window, wanted: Window) -> bool {
    holds(planned, wanted) && !wasteful(planned, wanted)
}

fn holds(outer: Window, inner: Window) -> bool {
    outer.x <= inner.x
        && outer.y <= inner.y
        && outer.x + outer.width >= inner.x + inner.width
        && outer.y + outer.height >= inner.y + inner.height
}

/// Making a new plan costs about three applications, so a window that is only a little too large is kept.
fn wasteful(outer: Window, inner: Window) -> bool {
    10 * inner.width * inner.height < 6 * outer.width * outer.height
}

fn union(a: &CellSet, b: &CellSet) -> Window {
    match (a.window(), b.window()) {
        (Some(a), Some(b)) => {
            let (x, y) = (a.x.min(b.x), a.y.min(b.y));
            let width = (a.x + a.width).max(b.x + b.width) - x;
            let height = (a.y + a.height).max(b.y + b.height) - y;
            Window { x, y, width, height }
        }
        (Some(w), None) | (None, Some(w)) => w,
        (None, None) => Window { x: 0, y: 0, width: 1, height: 1 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// Rounding of a double-precision transform of a few thousand points.
    const DOUBLE: f64 = 1e-13;
    /// Noise floor of a single-precision one.
    const SINGLE: f64 = 2e-6;

    fn set(side: usize, picks: &[bool]) -> CellSet {
        let index = (0..(side * side) as u32).filter(|&i| picks[i as usize % picks.len()]).collect();
        CellSet::new(side, index)
    }

    fn largest(values: &[f64]) -> f64 {
        values.iter().fold(0.0, |m, v| m.max(v.abs()))
    }

    fn free(table: &Table, window: Window) -> Convolution<f64> {
        let lengths = Lengths::free(window);
        Convolution::new(window, lengths, table.symbol_f64(lengths))
    }

    fn pressure(n: usize) -> Vec<f64> {
        (0..n).map(|k| 1.0 + (k as f64 * 0.7).sin()).collect()
    }

    #[test]
    fn a_circular_length_of_twice_n_less_one_is_exact() {
        // The lag n - 1 meets its own mirror image; an odd kernel would not survive this.
        for side in [2, 3, 5, 9, 33] {
            let table = Table::shared(side, Boundary::Free);
            let all = set(side, &[true]);
            let window = all.window().unwrap();
            assert_eq!(Lengths::free(window).x, 2 * (side - 1), "this test is about the shortest length");
            let p = pressure(all.len());
            let (mut direct, mut fft) = (vec![0.0; p.len()], vec![0.0; p.len()]);
            direct::apply(&table, &all, &p, &all, &mut direct);
            free(&table, window).apply(&all, &p, &all, &mut fft);
            for (a, b) in direct.iter().zip(&fft) {
                assert_relative_eq!(a, b, max_relative = DOUBLE);
            }
        }
    }

    #[test]
    fn the_factor_inverts_the_direct_sum() {
        let side = 12;
        let table = Table::shared(side, Boundary::Free);
        let cells = set(side, &[true, false, true, true, false, true, false]);
        let z = pressure(cells.len());
        let (q, w) = dense::Factor::new(&table, &cells).unwrap().solve_pair(&z);
        let mut back = vec![0.0; z.len()];
        direct::apply(&table, &cells, &q, &cells, &mut back);
        for b in &back {
            assert_relative_eq!(*b, 1.0, max_relative = DOUBLE);
        }
        direct::apply(&table, &cells, &w, &cells, &mut back);
        for (b, z) in back.iter().zip(&z) {
            assert_relative_eq!(b, z, max_relative = DOUBLE);
        }
    }

    #[test]
    fn the_torus_inverse_undoes_the_operator_on_smooth_pressure() {
        // Far from the edges B K p = p up to what the wrapped kernel lacks.
        let side = 48;
        let mut operators = Operators::new(Table::shared(side, Boundary::Free));
        let all = set(side, &[true]);
        let bump = |k: usize| {
            let (x, y) = all.place(k);
            (-((x as f64 - 24.0).powi(2) + (y as f64 - 24.0).powi(2)) / 18.0).exp()
        };
        let p: Vec<f64> = (0..all.len()).map(bump).collect();
        let u = operators.exact(&all, &p, &all);
        let mut back = vec![0.0; p.len()];
        operators.inverse(&all, &u, &mut back);
        let error: Vec<f64> = back.iter().zip(&p).map(|(a, b)| a - b).collect();
        assert!(largest(&error) < 0.05, "{}", largest(&error));
        assert_eq!(operators.applications, 1, "the preconditioner is not an application of K");
    }

    #[test]
    fn a_wrapped_transform_is_exact_up_to_three_quarters_of_the_window_and_positive_definite() {
        let side = 48;
        let mut operators = Operators::new(Table::shared(side, Boundary::Free));
        let all = set(side, &[true]);
        let lengths = Lengths::free(all.window().unwrap()).wrapped(all.window().unwrap());
        assert_eq!((lengths.x, lengths.y), (72, 72));
        let symbol = operators.table.symbol_f64(lengths);
        assert!(symbol.iter().all(|&s| s > 0.0));
        // One pressed cell in a corner: u is the kernel itself; what is farther than half way round is what is nearer.
        let mut p = vec![0.0; all.len()];
        p[0] = 1.0;
        let mut u = vec![0.0; all.len()];
        operators.two_levels = false;
        operators.transform(whole(side), false).apply(&all, &p, &all, &mut u);
        for (k, u) in u.iter().enumerate() {
            let near = |lag: usize| lag.min(72 - lag);
            let expected = crate::love::influence(near(k % side), near(k / side));
            assert_relative_eq!(*u, expected, max_relative = SINGLE, epsilon = SINGLE);
        }
        // Corrections without a sum: what is missing is small. A plain one: it is not.
        let wave: Vec<f64> = (0..all.len()).map(|k| (k as f64 * 0.37).sin()).collect();
        let mean = wave.iter().sum::<f64>() / wave.len() as f64;
        let without_sum: Vec<f64> = wave.iter().map(|w| w - mean).collect();
        let mut lacks = |p: &[f64]| {
            let (mut wrapped, mut exact) = (vec![0.0; p.len()], vec![0.0; p.len()]);
            operators.transform(whole(side), false).apply(&all, p, &all, &mut wrapped);
            operators.transform(whole(side), true).apply(&all, p, &all, &mut exact);
            let difference: Vec<f64> = wrapped.iter().zip(&exact).map(|(a, b)| a - b).collect();
            largest(&difference) / largest(&exact)
        };
        assert!(lacks(&without_sum) < 0.02 && lacks(&vec![1.0; all.len()]) > 0.02);
    }

    fn window(x: usize, y: usize, width: usize, height: usize) -> Window {
        Window { x, y, width, height }
    }

    #[test]
    fn a_plan_serves_what_lies_inside_it() {
        // Columns 2 to 11, rows 3 to 10.
        let planned = window(2, 3, 10, 8);
        for inside in [planned, window(3, 4, 9, 7), window(11, 10, 1, 1)] {
            assert!(holds(planned, inside), "{inside:?}");
        }
        // One side sticks out at a time.
        for outside in [window(1, 3, 3, 3), window(2, 2, 3, 3), window(11, 3, 2, 1), window(2, 10, 1, 2)] {
            assert!(!holds(planned, outside), "{outside:?}");
            assert!(!fits(planned, outside), "{outside:?}");
        }
        // Kept for six tenths of its area, not for half of it.
        let planned = window(0, 0, 10, 10);
        assert!(!wasteful(planned, window(0, 0, 10, 6)) && fits(planned, window(0, 0, 10, 6)));
        assert!(wasteful(planned, window(0, 0, 10, 5)) && !fits(planned, window(0, 0, 10, 5)));
    }

    #[test]
    fn the_window_of_two_sets_is_the_smallest_that_holds_both() {
        let one = |x: u32, y: u32| CellSet::new(12, vec![y * 12 + x]);
        assert_eq!(union(&one(3, 9), &one(7, 4)), window(3, 4, 5, 6));
        assert_eq!(union(&one(7, 4), &CellSet::new(12, vec![])), window(7, 4, 1, 1));
    }

    #[test]
    fn applications_are_counted_and_empty_sets_are_free() {
        let side = 64;
        let mut operators = Operators::new(Table::shared(side, Boundary::Free));
        let (all, none) = (set(side, &[true]), CellSet::new(side, vec![]));
        let p = pressure(all.len());
        for (sources, p, targets) in [(&none, &[][..], &all), (&all, &p[..], &none)] {
            let mut u = vec![1.0; targets.len()];
            operators.fast(sources, p, targets, &mut u);
            assert!(u.iter().all(|&u| u == 0.0));
            assert!(operators.exact(sources, p, targets).iter().all(|&u| u == 0.0));
        }
        assert_eq!(operators.applications, 0);
        // A few cells never pay for a transform of the grid.
        let few = CellSet::new(side, vec![0, 65, 4095]);
        operators.exact(&few, &[1.0, 2.0, 3.0], &few);
        assert!(operators.exact.is_none() && operators.applications == 1);
        operators.exact(&all, &p, &all);
        assert!(operators.exact.is_some() && operators.applications == 2);
        operators.exact_rows(side, |_, row| row.fill(1.0), |_, _| {});
        operators.fast_rows(side, |_, row| row.fill(1.0), |_, _| {});
        operators.fast(&all, &p, &all, &mut vec![0.0; p.len()]);
        assert_eq!(operators.applications, 5);
    }

    /// A state of which only the contact set counts.
    fn state(contact: &CellSet, q: Option<Vec<f64>>) -> crate::active_set::Solved {
        let look = crate::active_set::Look {
            checked: contact.clone(),
            p: Vec::new(),
            gap: Vec::new(),
            evidence: crate::certificate::Evidence::default(),
        };
        let (contact, status) = (contact.clone(), contact_model::Status::Converged);
        crate::active_set::Solved { contact, p: Vec::new(), d: 0.0, q, look, steps: 0, status }
    }

    #[test]
    fn two_levels_follow_the_sets_and_are_kept_where_they_fit() {
        // Two windows apart from each other that want the same split: a plan of one is wrong for the other.
        /// Interpolation of order 6 at a reach of 6 (see `lattice`).
        const INTERPOLATED: f64 = 1e-4;
        let side = 800;
        let scattered = |columns: std::ops::Range<u32>| {
            let index =
                (0..(side * side) as u32).step_by(311).filter(|i| columns.contains(&(i % side as u32)));
            CellSet::new(side, index.collect())
        };
        let (left, right, part) = (scattered(0..390), scattered(410..800), scattered(0..380));
        let table = Table::shared(side, Boundary::Free);
        let mut operators = Operators::new(Arc::clone(&table));
        let plan = |operators: &Operators| operators.two_level.as_ref().map(|o| (o.window(), o.split()));
        let mut plans = Vec::new();
        for cells in [&left, &right, &left, &part] {
            let p = pressure(cells.len());
            let (mut exact, mut fast) = (vec![0.0; p.len()], vec![0.0; p.len()]);
            direct::apply(&table, cells, &p, cells, &mut exact);
            operators.fast(cells, &p, cells, &mut fast);
            let error: Vec<f64> = exact.iter().zip(&fast).map(|(a, b)| a - b).collect();
            assert!(largest(&error) <= INTERPOLATED * largest(&exact), "{}", largest(&error));
            assert!(operators.describe(&state(cells, None)).starts_with("two levels, spacing"));
            plans.push(plan(&operators).unwrap());
        }
        assert_eq!(plans[0].1, plans[1].1, "this test is about one split on two windows");
        assert_eq!(plans[2].0, left.window().unwrap());
        // Work: a slightly smaller window keeps the plan.
        assert!(part.window() != left.window());
        assert_eq!(plans[3], plans[2]);
    }

    #[test]
    fn what_was_used_is_said() {
        let side = 64;
        let mut operators = Operators::new(Table::shared(side, Boundary::Free));
        let (all, few) = (set(side, &[true]), CellSet::new(side, vec![0, 4095]));
        operators.fast(&few, &[1.0, 1.0], &few, &mut [0.0; 2]);
        assert_eq!(operators.describe(&state(&few, None)), "direct 2");
        assert_eq!(operators.describe(&state(&few, Some(vec![1.0; 2]))), "dense 2");
        operators.fast(&all, &pressure(all.len()), &all, &mut vec![0.0; all.len()]);
        // 2 (64 - 1) = 126 has a factor 7; 128 is the next good length.
        assert_eq!(operators.describe(&state(&all, None)), "fft 128 x 128, f32 in f64");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

        #[test]
        fn every_operator_agrees_with_the_direct_sum(
            side in 1usize..40,
            sources in prop::collection::vec(any::<bool>(), 1..90),
            targets in prop::collection::vec(any::<bool>(), 1..90),
        ) {
            let (sources, targets) = (set(side, &sources), set(side, &targets));
            prop_assume!(!sources.is_empty() && !targets.is_empty());
            let table = Table::shared(side, Boundary::Free);
            let p = pressure(sources.len());
            let mut direct = vec![0.0; targets.len()];
            direct::apply(&table, &sources, &p, &targets, &mut direct);
            let window = union(&sources, &targets);
            let mut fft = vec![0.0; targets.len()];
            free(&table, window).apply(&sources, &p, &targets, &mut fft);
            let scale = largest(&direct);
            for (a, b) in direct.iter().zip(&fft) {
                prop_assert!((a - b).abs() <= DOUBLE * scale);
            }
            let lengths = Lengths::free(window);
            let mut single = Convolution::<f32>::new(window, lengths, table.symbol_f32(lengths));
            single.apply(&sources, &p, &targets, &mut fft);
            for (a, b) in direct.iter().zip(&fft) {
                prop_assert!((a - b).abs() <= SINGLE * scale);
            }
        }

        #[test]
        fn reciprocity(
            side in 2usize..30,
            a in prop::collection::vec(any::<bool>(), 1..60),
            b in prop::collection::vec(any::<bool>(), 1..60),
        ) {
            // Maxwell-Betti: the work of one load on the other's displacement is mutual.
            let (a, b) = (set(side, &a), set(side, &b));
            prop_assume!(!a.is_empty() && !b.is_empty());
            let mut operators = Operators::new(Table::shared(side, Boundary::Free));
            let (pa, pb) = (pressure(a.len()), pressure(b.len()));
            let ub = operators.exact(&a, &pa, &b);
            let ua = operators.exact(&b, &pb, &a);
            let (one, two) = (crate::cg::dot(&ub, &pb), crate::cg::dot(&ua, &pa));
            prop_assert!((one - two).abs() <= DOUBLE * one.abs());
        }
    }
}
