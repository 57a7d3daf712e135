//! The operators of one surface, each planned when it is first used.

use super::direct::DirectSum;
use super::fft::FftConvolution;
use super::influence::InfluenceOperator;
use super::recipe::{Application, Conditioning, Planner, Recipe};
use super::two_level::TwoLevel;
use super::two_transforms::TwoTransforms;
use crate::geometry::{CellSet, Window};
use crate::kernel::KernelTable;
use crate::parts::{Part, Recorder};
use crate::real::Real;
use crate::tuning::Tuning;
use std::sync::Arc;

/// The operators of one surface, with their work counters.
#[derive(Debug)]
pub struct Operators {
    table: Arc<KernelTable>,
    tuning: Tuning,
    recorder: Recorder,
    double: Option<FftConvolution<f64>>,
    single: Option<FftConvolution<f32>>,
    shortened: Option<FftConvolution<f32>>,
    torus: Option<FftConvolution<f32>>,
    two_level: Option<TwoLevel>,
    two_transforms: Option<TwoTransforms>,
    /// Applications of the influence matrix so far, all precisions together.
    pub applications: usize,
    /// Number of linear systems so far: factorisations and runs of conjugate gradients.
    pub solves: usize,
    /// Whether approximations of the far field may be chosen.
    pub two_levels: bool,
    /// How the last system was solved.
    last: Option<Recipe>,
}

/// The influence matrix in the form chosen for one application or one system, with the recorder of its time.
#[derive(Debug)]
pub struct Planned<'a> {
    way: Way<'a>,
    part: Part,
    recorder: &'a Recorder,
}

#[derive(Debug)]
enum Way<'a> {
    /// Sum over all pairs.
    Direct(DirectSum<'a>),
    /// Smooth part on a lattice, near part by pairs.
    TwoLevel(&'a mut TwoLevel),
    /// Smooth part on a lattice, near part by a transform.
    TwoTransforms(&'a mut TwoTransforms),
    /// Transform in single precision, exact or shortened.
    Fft(&'a mut FftConvolution<f32>),
}

impl<T: Real> InfluenceOperator<T> for Planned<'_>
where
    FftConvolution<f32>: InfluenceOperator<T>,
    TwoTransforms: InfluenceOperator<T>,
{
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]) {
        let Self { way, part, recorder } = self;
        recorder.timed(*part, || match way {
            Way::Direct(direct) => direct.apply(sources, p, targets, u),
            Way::TwoLevel(two_level) => two_level.apply(sources, p, targets, u),
            Way::TwoTransforms(transforms) => transforms.apply(sources, p, targets, u),
            Way::Fft(transform) => transform.apply(sources, p, targets, u),
        });
    }
}

impl Operators {
    /// Operators without plans; no time is charged.
    #[cfg(test)]
    pub fn new(table: Arc<KernelTable>, tuning: &Tuning) -> Self {
        Self::recorded(table, tuning, &Recorder::default())
    }

    /// Operators without plans.
    pub fn recorded(table: Arc<KernelTable>, tuning: &Tuning, recorder: &Recorder) -> Self {
        Self {
            table,
            tuning: *tuning,
            recorder: recorder.clone(),
            double: None,
            single: None,
            shortened: None,
            torus: None,
            two_level: None,
            two_transforms: None,
            applications: 0,
            solves: 0,
            two_levels: true,
            last: None,
        }
    }

    /// Drops all plans. The rounding of displacements then depends only on the applications from here on, and
    /// not on earlier windows.
    pub fn forget_plans(&mut self) {
        let Self { table, tuning, recorder, applications, solves, two_levels, .. } = self;
        let (applications, solves, two_levels) = (*applications, *solves, *two_levels);
        let fresh = Self::recorded(Arc::clone(table), tuning, recorder);
        *self = Self { applications, solves, two_levels, ..fresh };
    }

    /// The kernel.
    pub fn table(&self) -> &KernelTable {
        &self.table
    }

    /// The recorder of time.
    pub fn recorder(&self) -> &Recorder {
        &self.recorder
    }

    /// The tuned constants.
    pub fn tuning(&self) -> &Tuning {
        &self.tuning
    }

    /// The chooser between the operators.
    pub fn planner(&self) -> Planner<'_> {
        Planner { table: &self.table, tuning: &self.tuning, two_levels: self.two_levels }
    }

    /// How the last system was solved; `None` before the first.
    pub fn last(&self) -> Option<Recipe> {
        self.last
    }

    /// `u = G p` in double precision without approximation: direct sums or the FFT, whichever is cheaper.
    pub fn exact(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut Vec<f64>) {
        let Some(window) = self.begin(sources, targets, u) else { return };
        if self.planner().exact(sources.len(), targets.len(), window) == Application::Direct {
            let direct = || DirectSum(&self.table).apply(sources, p, targets, u);
            return self.recorder.timed(Part::Direct, direct);
        }
        let table = &self.table;
        let transform = planned(&mut self.double, window, (&self.tuning, &self.recorder), || {
            let lengths = table.exact_lengths(window);
            FftConvolution::new(window, lengths, table.symbol_f64(lengths))
        });
        self.recorder.timed(Part::Double, || transform.apply(sources, p, targets, u));
    }

    /// An upper estimate of the error of [`Self::rough`] over the largest displacement; 0 where sums over
    /// pairs are cheapest.
    pub fn roughness(&self, sources: &CellSet, targets: &CellSet) -> f64 {
        let windows = sources.window().into_iter().chain(targets.window());
        windows.reduce(Window::union).map_or(0.0, |w| self.planner().fast(sources, targets, w).error())
    }

    /// `u = G p` to four digits or more, for decisions that are checked with [`Self::exact`].
    pub fn rough(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut Vec<f64>) {
        let Some(window) = self.begin(sources, targets, u) else { return };
        let application = self.planner().fast(sources, targets, window);
        self.application(application, window).apply(sources, p, targets, u);
    }

    /// Resizes `u` to the targets and counts an application, unless the sources or the targets are empty.
    fn begin(&mut self, sources: &CellSet, targets: &CellSet, u: &mut Vec<f64>) -> Option<Window> {
        u.resize(targets.len(), 0.0);
        let (Some(from), Some(to)) = (sources.window(), targets.window()) else {
            u.fill(0.0);
            return None;
        };
        self.applications += 1;
        Some(from.union(to))
    }

    /// The influence matrix and, where the recipe has one, the transform of its torus inverse.
    pub fn system(&mut self, recipe: Recipe) -> (Planned<'_>, Option<&mut FftConvolution<f32>>) {
        let Recipe { window, application, conditioning } = recipe;
        self.last = Some(recipe);
        let Self { table, tuning, recorder, single, shortened, two_level, two_transforms, torus, .. } = self;
        let inverse = match conditioning {
            Conditioning::Identity => None,
            Conditioning::Torus { lengths, .. } => Some(planned(torus, window, (tuning, recorder), || {
                FftConvolution::new(window, lengths, table.inverse_symbol(lengths))
            })),
        };
        (
            plan(
                application,
                window,
                table,
                (tuning, recorder),
                (single, shortened, two_level, two_transforms),
            ),
            inverse,
        )
    }

    fn application(&mut self, application: Application, window: Window) -> Planned<'_> {
        let Self { table, tuning, recorder, single, shortened, two_level, two_transforms, .. } = self;
        plan(application, window, table, (tuning, recorder), (single, shortened, two_level, two_transforms))
    }
}

type Slots<'a> = (
    &'a mut Option<FftConvolution<f32>>,
    &'a mut Option<FftConvolution<f32>>,
    &'a mut Option<TwoLevel>,
    &'a mut Option<TwoTransforms>,
);

/// Plans an application in single precision, or reuses a suitable plan.
fn plan<'a>(
    application: Application,
    window: Window,
    table: &'a KernelTable,
    (tuning, recorder): (&Tuning, &'a Recorder),
    (single, shortened, two_level, two_transforms): Slots<'a>,
) -> Planned<'a> {
    let (way, part) = match application {
        Application::Direct => (Way::Direct(DirectSum(table)), Part::Direct),
        Application::TwoLevel(split) => {
            if !two_level.as_ref().is_some_and(|o| o.split() == split && o.window().serves(window, tuning)) {
                *two_level = None;
            }
            let make = || recorder.timed(Part::Plans, || TwoLevel::new(window, split));
            (Way::TwoLevel(two_level.get_or_insert_with(make)), Part::TwoLevel)
        }
        Application::TwoTransforms(split) => {
            let serves = |o: &TwoTransforms| o.split() == split && o.window().serves(window, tuning);
            if !two_transforms.as_ref().is_some_and(serves) {
                *two_transforms = None;
            }
            let make = || recorder.timed(Part::Plans, || TwoTransforms::new(window, split));
            (Way::TwoTransforms(two_transforms.get_or_insert_with(make)), Part::TwoTransforms)
        }
        Application::Fft(lengths) => {
            let exact = lengths == table.exact_lengths(window);
            let (slot, part) = if exact { (single, Part::Single) } else { (shortened, Part::Shortened) };
            let transform = planned(slot, window, (tuning, recorder), || {
                let symbol = if exact { table.symbol_f32(lengths) } else { table.shortened_symbol(lengths) };
                FftConvolution::new(window, lengths, symbol)
            });
            (Way::Fft(transform), part)
        }
    };
    Planned { way, part, recorder }
}

/// The convolution of `slot` where it can be used for the window, otherwise a new one.
fn planned<'a, T: Real>(
    slot: &'a mut Option<FftConvolution<T>>,
    window: Window,
    (tuning, recorder): (&Tuning, &Recorder),
    make: impl FnOnce() -> FftConvolution<T>,
) -> &'a mut FftConvolution<T> {
    if !slot.as_ref().is_some_and(|c| c.window().serves(window, tuning)) {
        *slot = None;
    }
    slot.get_or_insert_with(|| recorder.timed(Part::Plans, make))
}

#[cfg(test)]
mod tests;
