//! The operators of pressures on one surface: the kernel, and approximations of its far field.

use super::convolution::FftConvolution;
use super::influence::InfluenceOperator;
use super::plans::{Planned, Plans};
use super::recipe::{Application, Conditioning, Planner, Recipe};
use super::two_level::TwoLevel;
use super::two_transforms::TwoTransforms;
use crate::geometry::{CellSet, Lengths, Window};
use crate::kernel::NormalTable;
use crate::parts::{Part, Recorder};
use crate::real::Real;
use crate::tuning::Tuning;
use contact_model::{Interrupted, Stop};
use std::sync::Arc;

/// The operators of pressures on one surface, each planned when it is first used, with work counters.
#[derive(Debug)]
pub struct Operators {
    /// The kernel without approximation, and the work so far.
    pub plans: Plans<1, 1>,
    two_level: Option<TwoLevel>,
    two_transforms: Option<TwoTransforms>,
    /// Whether approximations of the far field may be chosen.
    pub two_levels: bool,
    /// How the last system was solved.
    last: Option<Recipe>,
}

/// The influence matrix in the form chosen for one application or one system.
#[derive(Debug)]
pub enum PlannedPressure<'a> {
    /// Without approximation of the far field.
    Kernel(Planned<'a, 1, 1>),
    /// Smooth part on a lattice, near part by pairs.
    TwoLevel(&'a mut TwoLevel, Recorder),
    /// Smooth part on a lattice, near part by a transform.
    TwoTransforms(&'a mut TwoTransforms, Recorder),
}

impl<T: Real> InfluenceOperator<T> for PlannedPressure<'_>
where
    FftConvolution<f32>: InfluenceOperator<T>,
    TwoTransforms: InfluenceOperator<T>,
{
    fn apply_until(
        &mut self,
        sources: &CellSet,
        p: &[T],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        match self {
            Self::Kernel(kernel) => kernel.apply_until(sources, p, targets, u, stop),
            Self::TwoLevel(two_level, recorder) => {
                recorder.timed(Part::TwoLevel, || two_level.apply_until(sources, p, targets, u, stop))
            }
            Self::TwoTransforms(transforms, recorder) => {
                recorder.timed(Part::TwoTransforms, || transforms.apply_until(sources, p, targets, u, stop))
            }
        }
    }
}

impl Operators {
    /// Operators without plans; no time is charged.
    #[cfg(test)]
    pub fn new(table: Arc<NormalTable>, tuning: &Tuning) -> Self {
        Self::recorded(table, tuning, &Recorder::default())
    }

    /// Operators without plans.
    pub fn recorded(table: Arc<NormalTable>, tuning: &Tuning, recorder: &Recorder) -> Self {
        let plans = Plans::new(table, tuning, recorder);
        Self { plans, two_level: None, two_transforms: None, two_levels: true, last: None }
    }

    /// Drops all plans, as [`Plans::forget_plans`].
    pub fn forget_plans(&mut self) {
        self.plans.forget_plans();
        (self.two_level, self.two_transforms, self.last) = (None, None, None);
    }

    /// The kernel.
    pub fn table(&self) -> &NormalTable {
        self.plans.table()
    }

    /// The recorder of time.
    pub fn recorder(&self) -> &Recorder {
        self.plans.recorder()
    }

    /// The tuned constants.
    pub fn tuning(&self) -> &Tuning {
        self.plans.tuning()
    }

    /// The chooser between the operators.
    pub fn planner(&self) -> Planner<'_> {
        Planner { table: self.table(), tuning: self.tuning(), two_levels: self.two_levels }
    }

    /// How the last system was solved; `None` before the first.
    pub fn last(&self) -> Option<Recipe> {
        self.last
    }

    /// `u = G p` in double precision without approximation, as [`Plans::exact`].
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `u` is then undefined.
    pub fn exact(
        &mut self,
        sources: &CellSet,
        p: &[f64],
        targets: &CellSet,
        u: &mut Vec<f64>,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        self.plans.exact(sources, p, targets, u, stop)
    }

    /// The inverse of G on a torus around a set, of values on it; in single precision.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `z` is then undefined.
    pub fn torus_inverse(
        &mut self,
        set: &CellSet,
        r: &[f64],
        z: &mut [f64],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        match self.plans.inverse(set, stop)? {
            Some(inverse) => inverse.apply_until(set, r, set, z, stop),
            None => Ok(()),
        }
    }

    /// An upper estimate of the error of [`Self::rough`] over the largest displacement; 0 where sums over
    /// pairs are cheapest.
    pub fn roughness(&self, sources: &CellSet, targets: &CellSet) -> f64 {
        let windows = sources.window().into_iter().chain(targets.window());
        windows.reduce(Window::union).map_or(0.0, |w| self.planner().fast(sources, targets, w).error())
    }

    /// `u = G p` to four digits or more, for decisions that are checked with [`Self::exact`].
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `u` is then undefined.
    pub fn rough(
        &mut self,
        sources: &CellSet,
        p: &[f64],
        targets: &CellSet,
        u: &mut Vec<f64>,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Some(window) = self.plans.begin(sources, targets, u) else { return Ok(()) };
        let application = self.planner().fast(sources, targets, window);
        self.planned(application, window, None, stop)?.0.apply_until(sources, p, targets, u, stop)
    }

    /// The influence matrix and, where the recipe has one, the transform of its torus inverse.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop while they are planned.
    pub fn system(
        &mut self,
        recipe: Recipe,
        stop: Stop<'_>,
    ) -> Result<(PlannedPressure<'_>, Option<&mut FftConvolution<f32>>), Interrupted> {
        let Recipe { window, application, conditioning } = recipe;
        self.last = Some(recipe);
        let torus = match conditioning {
            Conditioning::Identity => None,
            Conditioning::Torus { lengths, .. } => Some(lengths),
        };
        self.planned(application, window, torus, stop)
    }

    /// Plans an application in single precision and the inverse on a torus of these lengths, or reuses suitable
    /// plans.
    fn planned(
        &mut self,
        application: Application,
        window: Window,
        torus: Option<Lengths>,
        stop: Stop<'_>,
    ) -> Result<(PlannedPressure<'_>, Option<&mut FftConvolution<f32>>), Interrupted> {
        let Self { plans, two_level, two_transforms, .. } = self;
        let (tuning, recorder) = (*plans.tuning(), plans.recorder().clone());
        let lengths = if let Application::Fft(lengths) = application { Some(lengths) } else { None };
        let room = plans.room.clone();
        let (kernel, inverse) = plans.planned(lengths, window, torus, stop)?;
        let planned = match application {
            Application::Direct | Application::Fft(_) => PlannedPressure::Kernel(kernel),
            Application::TwoLevel(split) => {
                let serves = |o: &TwoLevel| o.split() == split && o.window().serves(window, &tuning);
                if !two_level.as_ref().is_some_and(serves) {
                    *two_level = None;
                }
                let plan = match two_level {
                    Some(plan) => plan,
                    slot => slot.insert(recorder.timed(Part::Plans, || TwoLevel::new(window, split, stop))?),
                };
                PlannedPressure::TwoLevel(plan, recorder.clone())
            }
            Application::TwoTransforms(split) => {
                let serves = |o: &TwoTransforms| o.split() == split && o.window().serves(window, &tuning);
                if !two_transforms.as_ref().is_some_and(serves) {
                    *two_transforms = None;
                }
                let make = || TwoTransforms::within(&room, window, split, stop);
                let plan = match two_transforms {
                    Some(plan) => plan,
                    slot => slot.insert(recorder.timed(Part::Plans, make)?),
                };
                PlannedPressure::TwoTransforms(plan, recorder.clone())
            }
        };
        Ok((planned, inverse))
    }
}

#[cfg(test)]
mod tests;
