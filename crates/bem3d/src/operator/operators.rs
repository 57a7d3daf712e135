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
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]) {
        match self {
            Self::Kernel(kernel) => kernel.apply(sources, p, targets, u),
            Self::TwoLevel(two_level, recorder) => {
                recorder.timed(Part::TwoLevel, || two_level.apply(sources, p, targets, u));
            }
            Self::TwoTransforms(transforms, recorder) => {
                recorder.timed(Part::TwoTransforms, || transforms.apply(sources, p, targets, u));
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
    pub fn exact(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut Vec<f64>) {
        self.plans.exact(sources, p, targets, u);
    }

    /// An upper estimate of the error of [`Self::rough`] over the largest displacement; 0 where sums over
    /// pairs are cheapest.
    pub fn roughness(&self, sources: &CellSet, targets: &CellSet) -> f64 {
        let windows = sources.window().into_iter().chain(targets.window());
        windows.reduce(Window::union).map_or(0.0, |w| self.planner().fast(sources, targets, w).error())
    }

    /// `u = G p` to four digits or more, for decisions that are checked with [`Self::exact`].
    pub fn rough(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut Vec<f64>) {
        let Some(window) = self.plans.begin(sources, targets, u) else { return };
        let application = self.planner().fast(sources, targets, window);
        self.planned(application, window, None).0.apply(sources, p, targets, u);
    }

    /// The influence matrix and, where the recipe has one, the transform of its torus inverse.
    pub fn system(&mut self, recipe: Recipe) -> (PlannedPressure<'_>, Option<&mut FftConvolution<f32>>) {
        let Recipe { window, application, conditioning } = recipe;
        self.last = Some(recipe);
        let torus = match conditioning {
            Conditioning::Identity => None,
            Conditioning::Torus { lengths, .. } => Some(lengths),
        };
        self.planned(application, window, torus)
    }

    /// Plans an application in single precision and the inverse on a torus of these lengths, or reuses suitable
    /// plans.
    fn planned(
        &mut self,
        application: Application,
        window: Window,
        torus: Option<Lengths>,
    ) -> (PlannedPressure<'_>, Option<&mut FftConvolution<f32>>) {
        let Self { plans, two_level, two_transforms, .. } = self;
        let (tuning, recorder) = (*plans.tuning(), plans.recorder().clone());
        let lengths = if let Application::Fft(lengths) = application { Some(lengths) } else { None };
        let (kernel, inverse) = plans.planned(lengths, window, torus);
        let planned = match application {
            Application::Direct | Application::Fft(_) => PlannedPressure::Kernel(kernel),
            Application::TwoLevel(split) => {
                let serves = |o: &TwoLevel| o.split() == split && o.window().serves(window, &tuning);
                if !two_level.as_ref().is_some_and(serves) {
                    *two_level = None;
                }
                let make = || recorder.timed(Part::Plans, || TwoLevel::new(window, split));
                PlannedPressure::TwoLevel(two_level.get_or_insert_with(make), recorder.clone())
            }
            Application::TwoTransforms(split) => {
                let serves = |o: &TwoTransforms| o.split() == split && o.window().serves(window, &tuning);
                if !two_transforms.as_ref().is_some_and(serves) {
                    *two_transforms = None;
                }
                let make = || recorder.timed(Part::Plans, || TwoTransforms::new(window, split));
                PlannedPressure::TwoTransforms(two_transforms.get_or_insert_with(make), recorder.clone())
            }
        };
        (planned, inverse)
    }
}

#[cfg(test)]
mod tests;
