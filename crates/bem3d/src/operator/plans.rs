//! The kernel of one surface without approximation: sums over pairs and convolutions, each planned when it is
//! first used.

use super::convolution::Convolution;
use super::direct::DirectSum;
use super::influence::InfluenceOperator;
use super::recipe::Costs;
use super::transform::Room;
use crate::geometry::{CellSet, Lengths, Window};
use crate::kernel::{Invertible, KernelTable, Symmetric, Tensor};
use crate::parts::{Part, Recorder};
use crate::real::Real;
use crate::tuning::Tuning;
use contact_model::{Interrupted, Stop};
use std::fmt;
use std::sync::Arc;

/// `u = K t` of N components on one surface, with work counters.
pub struct Plans<const N: usize, const E: usize> {
    pub(super) table: Arc<KernelTable<E>>,
    tuning: Tuning,
    recorder: Recorder,
    pub(super) double: Option<Convolution<f64, N, E>>,
    pub(super) single: Option<Convolution<f32, N, E>>,
    pub(super) shortened: Option<Convolution<f32, N, E>>,
    pub(super) torus: Option<Convolution<f32, N, E>>,
    /// Of the spectra in single precision.
    pub(super) room: Room<f32>,
    /// Applications of the kernel so far, all precisions together; each has N components.
    pub applications: usize,
    /// Number of linear systems so far: factorisations and runs of conjugate gradients.
    pub solves: usize,
    /// Steps of the fall-back so far, each of one of these applications.
    pub descent: usize,
    /// Inner solves of contact so far that their number of steps ended.
    pub limited: usize,
}

/// The operators of tangential tractions.
pub type TangentialOperators = Plans<2, 3>;

/// The kernel for a system, and the transform of its inverse on a torus.
pub type PlannedSystem<'a, const N: usize, const E: usize> =
    (Planned<'a, N, E>, Option<&'a mut Convolution<f32, N, E>>);

/// The kernel in the form that is cheaper for one set, in single precision, with the recorder of its time.
#[derive(Debug)]
pub enum Planned<'a, const N: usize, const E: usize> {
    /// Sum over all pairs.
    Direct(DirectSum<'a, N, E>, &'a Recorder),
    /// Transforms, exact or shortened.
    Fft(&'a mut Convolution<f32, N, E>, Part, &'a Recorder),
}

impl<T: Real, const N: usize, const E: usize> InfluenceOperator<T> for Planned<'_, N, E>
where
    [f64; E]: Symmetric<f64, N>,
    Convolution<f32, N, E>: InfluenceOperator<T>,
{
    fn apply_until(
        &mut self,
        sources: &CellSet,
        t: &[T],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        match self {
            Self::Direct(direct, recorder) => {
                recorder.timed(Part::Direct, || direct.apply_until(sources, t, targets, u, stop))
            }
            Self::Fft(transform, part, recorder) => {
                recorder.timed(*part, || transform.apply_until(sources, t, targets, u, stop))
            }
        }
    }
}

impl<const N: usize, const E: usize> fmt::Debug for Plans<N, E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Plans({:?}, {} applications)", self.table, self.applications)
    }
}

impl<const N: usize, const E: usize> Plans<N, E>
where
    [f64; E]: Symmetric<f64, N> + Invertible,
    [f32; E]: Tensor<f32, N>,
{
    /// No plans yet.
    pub fn new(table: Arc<KernelTable<E>>, tuning: &Tuning, recorder: &Recorder) -> Self {
        Self {
            table,
            tuning: *tuning,
            recorder: recorder.clone(),
            double: None,
            single: None,
            shortened: None,
            torus: None,
            room: Room::default(),
            applications: 0,
            solves: 0,
            descent: 0,
            limited: 0,
        }
    }

    /// Drops all plans. The rounding of displacements then depends only on the applications from here on, and
    /// not on earlier windows.
    pub fn forget_plans(&mut self) {
        let fresh = Self::new(Arc::clone(&self.table), &self.tuning, &self.recorder);
        let Self { applications, solves, descent, limited, .. } = *self;
        *self = Self { applications, solves, descent, limited, ..fresh };
    }

    /// The kernel.
    pub fn table(&self) -> &KernelTable<E> {
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

    fn costs(&self) -> Costs<'_> {
        Costs::new(&self.tuning, N, E)
    }

    /// The time of an application in double precision in a window by the cost model, ns.
    pub fn nanoseconds(&self, window: Window) -> f64 {
        self.costs().transforms(self.table.exact_lengths(window))
    }

    /// Resizes `u` to the targets and counts an application. Returns the window of both sets, `None` where the
    /// sources or the targets are empty.
    pub fn begin(&mut self, sources: &CellSet, targets: &CellSet, u: &mut Vec<f64>) -> Option<Window> {
        u.resize(N * targets.len(), 0.0);
        let (Some(from), Some(to)) = (sources.window(), targets.window()) else {
            u.fill(0.0);
            return None;
        };
        self.applications += 1;
        Some(from.union(to))
    }

    /// `u = K t` in double precision without approximation: direct sums or the FFT, whichever is cheaper.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `u` is then undefined.
    pub fn exact(
        &mut self,
        sources: &CellSet,
        t: &[f64],
        targets: &CellSet,
        u: &mut Vec<f64>,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Some(window) = self.begin(sources, targets, u) else { return Ok(()) };
        let lengths = self.table.exact_lengths(window);
        if self.costs().direct(sources.len(), targets.len()) <= self.costs().transforms(lengths) {
            let direct = || DirectSum(&self.table).apply_until(sources, t, targets, u, stop);
            return self.recorder.timed(Part::Direct, direct);
        }
        let table = &self.table;
        let transform = planned(&mut self.double, window, (&self.tuning, &self.recorder), || {
            Ok(Convolution::new(window, lengths, table.symbol_f64(lengths, stop)?))
        })?;
        self.recorder.timed(Part::Double, || transform.apply_until(sources, t, targets, u, stop))
    }

    /// The kernel on a set in single precision, and the transform of its torus inverse; `None` on no cells.
    ///
    /// `every_lag`: whether the kernel must be exact at every lag, as for a stiffness, or may be that of a shorter
    /// torus, as for corrections that the exact displacement is evaluated after.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop while symbols are made.
    pub fn system(
        &mut self,
        set: &CellSet,
        every_lag: bool,
        stop: Stop<'_>,
    ) -> Result<Option<(Planned<'_, N, E>, &mut Convolution<f32, N, E>)>, Interrupted> {
        let Some(window) = set.window() else { return Ok(None) };
        let lengths = if every_lag {
            self.table.exact_lengths(window)
        } else {
            self.table.shortened_lengths(window, self.tuning.shortened)
        };
        let transforms = self.tuning.single * self.costs().transforms(lengths);
        let direct = self.costs().direct(set.len(), set.len()) <= transforms;
        let torus = self.table.torus_lengths(window);
        let (kernel, inverse) = self.planned((!direct).then_some(lengths), window, Some(torus), stop)?;
        Ok(inverse.map(|inverse| (kernel, inverse)))
    }

    /// The inverse on a torus around a set, in single precision; `None` on no cells.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop while its symbol is made.
    pub fn inverse(
        &mut self,
        set: &CellSet,
        stop: Stop<'_>,
    ) -> Result<Option<&mut Convolution<f32, N, E>>, Interrupted> {
        let Some(window) = set.window() else { return Ok(None) };
        let lengths = self.table.torus_lengths(window);
        Ok(self.planned(None, window, Some(lengths), stop)?.1)
    }

    /// The kernel in single precision by transforms of these lengths, by sums over pairs where there are none;
    /// and the transform of its inverse on a torus, where that has lengths.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop while symbols are made.
    pub fn planned(
        &mut self,
        lengths: Option<Lengths>,
        window: Window,
        torus_lengths: Option<Lengths>,
        stop: Stop<'_>,
    ) -> Result<PlannedSystem<'_, N, E>, Interrupted> {
        let Self { table, tuning, recorder, single, shortened, torus, room, .. } = self;
        let inverse = torus_lengths.map(|lengths| {
            planned(torus, window, (tuning, recorder), || {
                Ok(Convolution::within(room, window, lengths, table.inverse_symbol(lengths, stop)?))
            })
        });
        let inverse = inverse.transpose()?;
        let Some(lengths) = lengths else {
            return Ok((Planned::Direct(DirectSum(table), recorder), inverse));
        };
        let exact = lengths == table.exact_lengths(window);
        let (slot, part) = if exact { (single, Part::Single) } else { (shortened, Part::Shortened) };
        let transform = planned(slot, window, (tuning, recorder), || {
            let symbol =
                if exact { table.symbol_f32(lengths, stop) } else { table.shortened_symbol(lengths, stop) };
            Ok(Convolution::within(room, window, lengths, symbol?))
        })?;
        Ok((Planned::Fft(transform, part, recorder), inverse))
    }
}

/// The convolution of `slot` where it can be used for the window, otherwise a new one.
fn planned<'a, T: Real, const N: usize, const E: usize>(
    slot: &'a mut Option<Convolution<T, N, E>>,
    window: Window,
    (tuning, recorder): (&Tuning, &Recorder),
    make: impl FnOnce() -> Result<Convolution<T, N, E>, Interrupted>,
) -> Result<&'a mut Convolution<T, N, E>, Interrupted>
where
    [T; E]: Tensor<T, N>,
{
    if !slot.as_ref().is_some_and(|c| c.window().serves(window, tuning)) {
        *slot = None;
    }
    match slot {
        Some(plan) => Ok(plan),
        slot => Ok(slot.insert(recorder.timed(Part::Plans, make)?)),
    }
}
