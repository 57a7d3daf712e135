//! The tangential operators of one surface, each planned when it is first used.

use super::influence::InfluenceOperator;
use super::vector::{DirectVectorSum, VectorConvolution};
use crate::geometry::{CellSet, Lengths, Window};
use crate::kernel::TangentialTable;
use crate::parts::{Part, Recorder};
use crate::real::Real;
use crate::tuning::Tuning;
use std::sync::Arc;

/// Number of products for a pair of cells, over that of normal contact.
const PAIR: f64 = 3.0;
/// Number of transforms of a field, over that of normal contact.
const TRANSFORMS: f64 = 2.0;

/// `u = K q` on one surface, with work counters.
#[derive(Debug)]
pub struct TangentialOperators {
    table: Arc<TangentialTable>,
    tuning: Tuning,
    recorder: Recorder,
    double: Option<VectorConvolution<f64>>,
    single: Option<VectorConvolution<f32>>,
    shortened: Option<VectorConvolution<f32>>,
    torus: Option<VectorConvolution<f32>>,
    /// Number of applications so far in all precisions; each has two components.
    pub applications: usize,
    /// Linear systems so far.
    pub solves: usize,
}

/// The kernel in the form that is cheaper for one set.
#[derive(Debug)]
pub enum PlannedVector<'a> {
    /// Sum over all pairs.
    Direct(DirectVectorSum<'a>, &'a Recorder),
    /// Transforms in single precision, with the recorder of their time.
    Fft(&'a mut VectorConvolution<f32>, Part, &'a Recorder),
}

impl InfluenceOperator<f32> for PlannedVector<'_> {
    fn apply(&mut self, sources: &CellSet, q: &[f32], targets: &CellSet, u: &mut [f32]) {
        match self {
            Self::Direct(direct, recorder) => {
                recorder.timed(Part::Direct, || direct.apply(sources, q, targets, u));
            }
            Self::Fft(transform, part, recorder) => {
                recorder.timed(*part, || transform.apply(sources, q, targets, u));
            }
        }
    }
}

impl TangentialOperators {
    /// Operators without plans.
    pub fn new(table: Arc<TangentialTable>, tuning: &Tuning, recorder: &Recorder) -> Self {
        Self {
            table,
            tuning: *tuning,
            recorder: recorder.clone(),
            double: None,
            single: None,
            shortened: None,
            torus: None,
            applications: 0,
            solves: 0,
        }
    }

    /// Drops all plans, as [`super::Operators::forget_plans`].
    pub fn forget_plans(&mut self) {
        let fresh = Self::new(Arc::clone(&self.table), &self.tuning, &self.recorder);
        *self = Self { applications: self.applications, solves: self.solves, ..fresh };
    }

    /// The kernel.
    pub fn table(&self) -> &TangentialTable {
        &self.table
    }

    /// The tuned constants.
    pub fn tuning(&self) -> &Tuning {
        &self.tuning
    }

    /// The recorder of time.
    pub fn recorder(&self) -> &Recorder {
        &self.recorder
    }

    /// Whether the sum over pairs is cheaper than transforms of this number of points.
    fn is_direct(&self, sources: usize, targets: usize, lengths: Lengths, share: f64) -> bool {
        let points = lengths.points() as f64;
        let transforms = TRANSFORMS * share * self.tuning.point_ns * points * points.log2();
        PAIR * self.tuning.pair_ns * sources as f64 * targets as f64 <= transforms
    }

    /// `u = K q` in double precision without approximation; two numbers a cell, those along x first.
    pub fn exact(&mut self, sources: &CellSet, q: &[f64], targets: &CellSet, u: &mut Vec<f64>) {
        u.resize(2 * targets.len(), 0.0);
        let (Some(from), Some(to)) = (sources.window(), targets.window()) else { return u.fill(0.0) };
        self.applications += 1;
        let window = from.union(to);
        let lengths = self.table.exact_lengths(window);
        if self.is_direct(sources.len(), targets.len(), lengths, 1.0) {
            let direct = || DirectVectorSum(&self.table).apply(sources, q, targets, u);
            return self.recorder.timed(Part::Direct, direct);
        }
        let table = &self.table;
        let transform = planned(&mut self.double, window, (&self.tuning, &self.recorder), || {
            VectorConvolution::new(window, lengths, table.symbol_f64(lengths))
        });
        self.recorder.timed(Part::Double, || transform.apply(sources, q, targets, u));
    }

    /// The kernel on a set in single precision, and the transform of its torus inverse; `None` on no cells.
    ///
    /// `every_lag`: whether the kernel must be exact at every lag, as for a stiffness, or may be that of a shorter
    /// torus, as for corrections that the exact displacement is evaluated after.
    pub fn system(
        &mut self,
        set: &CellSet,
        every_lag: bool,
    ) -> Option<(PlannedVector<'_>, &mut VectorConvolution<f32>)> {
        let window = set.window()?;
        let exact = self.table.exact_lengths(window);
        let lengths =
            if every_lag { exact } else { self.table.shortened_lengths(window, self.tuning.shortened) };
        let direct = self.is_direct(set.len(), set.len(), lengths, self.tuning.single);
        let Self { table, tuning, recorder, single, shortened, torus, .. } = self;
        let inverse = planned(torus, window, (tuning, recorder), || {
            let lengths = table.torus_lengths(window);
            VectorConvolution::new(window, lengths, table.inverse_symbol(lengths))
        });
        let kernel = if direct {
            PlannedVector::Direct(DirectVectorSum(table), recorder)
        } else if lengths == exact {
            let transform = planned(single, window, (tuning, recorder), || {
                VectorConvolution::new(window, lengths, table.symbol_f32(lengths))
            });
            PlannedVector::Fft(transform, Part::Single, recorder)
        } else {
            let transform = planned(shortened, window, (tuning, recorder), || {
                VectorConvolution::new(window, lengths, table.shortened_symbol(lengths))
            });
            PlannedVector::Fft(transform, Part::Shortened, recorder)
        };
        Some((kernel, inverse))
    }
}

/// The convolution of `slot` where it can be used for the window, otherwise a new one.
fn planned<'a, T: Real>(
    slot: &'a mut Option<VectorConvolution<T>>,
    window: Window,
    (tuning, recorder): (&Tuning, &Recorder),
    make: impl FnOnce() -> VectorConvolution<T>,
) -> &'a mut VectorConvolution<T> {
    if !slot.as_ref().is_some_and(|c| c.window().serves(window, tuning)) {
        *slot = None;
    }
    slot.get_or_insert_with(|| recorder.timed(Part::Plans, make))
}
