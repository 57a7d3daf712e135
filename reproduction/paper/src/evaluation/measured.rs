//! An ensemble of one model over all fractal dimensions.

use crate::evaluation::read_surfaces::ReadSurfaces;
use crate::evaluation::realisation::{
    Discretisation, EnsembleModel, Realisation, RealisationResult, of_scene, realisation_jobs,
};
use crate::evaluation::realisation_jobs::is_solved;
use crate::evaluation::run::Run;
use crate::evaluation::sample::{FLOOR_CELLS, Sample};
use crate::evaluation::so_far::SoFar;
use analysis::{CollapsePoint, Curves, EnsemblePoint, ensemble, relative_differences};
use fractal_contact::scenes::{self, ModelResult, SceneJob, solve_jobs_in_order};
use runs::amounts::duration;
use runs::{Error, Job as _, Ordered, Progress, Result, Store};
use std::sync::Arc;

/// Number of surfaces that are also solved on the coarser grids, which gives the scatter of a difference to a
/// fifth.
pub const COARSER_SURFACES: usize = 12;

/// All surfaces of one fractal dimension.
#[derive(Debug, Clone)]
pub struct Series {
    /// D_f.
    pub fractal_dimension: f64,
    /// Its surfaces and their results, in the order of their index.
    pub realisations: Vec<(Realisation, RealisationResult)>,
    /// Converged stiffnesses on common forces.
    pub curves: Curves,
    /// Their means.
    pub points: Vec<EnsemblePoint>,
}

/// An ensemble of one model, which Figs. 2 and 6 show and Figs. 3, 4 and 7 evaluate.
#[derive(Debug, Clone)]
pub struct Measured {
    /// How it was solved.
    pub discretisation: Discretisation,
    /// One series per fractal dimension, increasing.
    pub series: Vec<Series>,
    /// The first surfaces on grids half and a quarter as fine, for the discretisation error; `None` where
    /// those are too coarse.
    pub coarser: Option<Box<[Self; 2]>>,
}

/// The ensemble of a model, from the store where it is there, with its first surfaces on coarser grids.
///
/// # Errors
/// See [`crate::evaluation::solve_realisations`].
pub fn measure(model: EnsembleModel, run: &Run, store: &Store, progress: &dyn Progress) -> Result<Measured> {
    measure_showing(model, run, store, progress, &|_| Ok(()))
}

/// As [`measure`]; `show` is called now and then, from any thread, with the results so far: whole ensembles
/// of fewer surfaces or on a coarser grid, without their own coarser grids.
///
/// The coarse grids come first, then the surfaces one by one.
///
/// # Errors
/// As [`measure`], and errors of `show`.
pub fn measure_showing(
    model: EnsembleModel,
    run: &Run,
    store: &Store,
    progress: &dyn Progress,
    show: &(dyn Fn(&Measured) -> Result<()> + Sync),
) -> Result<Measured> {
    let ensembles: Vec<Vec<Realisation>> =
        grids(model, run).map(|(grid, surfaces)| realisations(grid, surfaces, run)).collect();
    if let Some(directory) = &run.samples {
        return read(&ReadSurfaces::open(directory, model, run)?, ensembles, (model, run));
    }
    let all: Vec<Realisation> = ensembles.iter().rev().flatten().cloned().collect();
    let jobs = realisation_jobs(&all, &run.out)?;
    let mut order: Vec<usize> = (0..all.len()).collect();
    for of_surface in order.chunks_mut(run.dimensions().len().max(1)) {
        of_surface.sort_by_key(|&job| std::cmp::Reverse(jobs[job].cost()));
    }
    let what = words(model, run, &ensembles, (&jobs, store));
    let measured_so_far = |realisations, results| show(&Measured::new(realisations, results, run)?);
    let so_far = SoFar::new(&ensembles, run, &measured_so_far);
    let solved = |job: usize, states: &ModelResult| -> scenes::Result<()> {
        so_far.add(job, &all[job].read(states)?)?;
        Ok(())
    };
    let ordered = Ordered { jobs: &jobs, order: &order, solved: &solved };
    let states = solve_jobs_in_order(&what, &ordered, store, run.threads, progress).map_err(of_scene)?;
    let mut results = all.iter().zip(&states).map(|(realisation, states)| realisation.read(states));
    let mut measured = Vec::new();
    for realisations in ensembles.into_iter().rev() {
        let results = results.by_ref().take(realisations.len()).collect::<Result<_>>()?;
        measured.push(Measured::new(realisations, results, run)?);
    }
    with_coarser(measured, model)
}

/// The ensembles whose surfaces a table has.
fn read(
    table: &ReadSurfaces,
    ensembles: Vec<Vec<Realisation>>,
    (model, run): (EnsembleModel, &Run),
) -> Result<Measured> {
    let of = |realisations: Vec<Realisation>| {
        let results = realisations.iter().map(|one| table.of(one)).collect::<Result<_>>()?;
        Measured::new(realisations, results, run)
    };
    with_coarser(ensembles.into_iter().rev().map(of).collect::<Result<_>>()?, model)
}

/// The last ensemble, which is on the finest grid, with those before it as its coarser ones.
fn with_coarser(mut measured: Vec<Measured>, model: EnsembleModel) -> Result<Measured> {
    let finest = measured.pop().ok_or_else(|| Error::parameter("model", model.name(), "a grid"))?;
    let coarser = measured.pop().zip(measured.pop()).map(|(half, quarter)| Box::new([half, quarter]));
    Ok(Measured { coarser, ..finest })
}

/// A description of the solves, with their predicted time.
fn words(
    model: EnsembleModel,
    run: &Run,
    ensembles: &[Vec<Realisation>],
    (jobs, store): (&[SceneJob], &Store),
) -> String {
    let kind = match model {
        EnsembleModel::Bem3d => "surfaces",
        EnsembleModel::Mdr1d => "lines",
    };
    let of = |realisations: &Vec<Realisation>| {
        let size = match realisations.first()?.discretisation {
            Discretisation::Bem3d { cells, .. } => format!("{cells} x {cells} cells"),
            Discretisation::Mdr1d { elements } => format!("{elements} elements"),
        };
        Some(format!("{} {kind} of {size}", realisations.len()))
    };
    let sizes: Vec<String> = ensembles.iter().filter_map(of).collect();
    let missing = jobs.iter().filter(|job| !is_solved(job, store));
    // Processor milliseconds.
    let seconds = missing.map(|job| 1e-3 * job.cost() as f64).sum::<f64>() / run.threads.max(1) as f64;
    let time = match seconds {
        s if s > 0.0 => {
            let threads = if run.threads == 1 { "1 thread" } else { &format!("{} threads", run.threads) };
            format!("; about {} on {threads}", duration(s.max(1.0)))
        }
        _ => String::new(),
    };
    let loads = run.ensemble(model).2.values().len();
    format!("{}: {}, {loads} loads{time}", model.name(), sizes.join(", "))
}

/// The grid of a model with its number of surfaces, and the two coarser ones.
fn grids(model: EnsembleModel, run: &Run) -> impl Iterator<Item = (Discretisation, usize)> {
    let (grid, surfaces, _) = run.ensemble(model);
    let coarser = grid.coarser().into_iter().flatten();
    std::iter::once((grid, surfaces)).chain(coarser.map(move |grid| (grid, surfaces.min(COARSER_SURFACES))))
}

/// Everything that the ensembles of a run solve, coarser grids included.
///
/// # Errors
/// As [`realisation_jobs`].
pub fn ensemble_jobs(run: &Run, models: &[EnsembleModel]) -> Result<Vec<SceneJob>> {
    let all = models.iter().flat_map(|&model| grids(model, run));
    let all: Vec<Realisation> = all.flat_map(|(grid, surfaces)| realisations(grid, surfaces, run)).collect();
    realisation_jobs(&all, &run.out)
}

/// Surface by surface, so that an interrupted run holds whole ensembles of fewer surfaces.
pub(crate) fn realisations(discretisation: Discretisation, surfaces: usize, run: &Run) -> Vec<Realisation> {
    let forces: Arc<[f64]> = run.ensemble(discretisation.of()).2.values().into();
    let dimensions = run.dimensions();
    let of_surface = |index: usize| {
        let of = |&fractal_dimension: &f64| Realisation {
            discretisation,
            fractal_dimension,
            master_seed: run.seed,
            index,
            forces: Arc::clone(&forces),
        };
        dimensions.iter().map(of).collect::<Vec<_>>()
    };
    (0..surfaces).flat_map(of_surface).collect()
}

impl Measured {
    /// An ensemble without coarser grids, from its surfaces and their results.
    fn new(realisations: Vec<Realisation>, results: Vec<RealisationResult>, run: &Run) -> Result<Self> {
        let dimensions = run.dimensions();
        let first = realisations.first().ok_or_else(|| Error::parameter("surfaces", 0, "at least 1"))?;
        let (discretisation, forces) = (first.discretisation, Arc::clone(&first.forces));
        let mut pairs: Vec<Vec<(Realisation, RealisationResult)>> =
            dimensions.iter().map(|_| Vec::new()).collect();
        for (i, pair) in realisations.into_iter().zip(results).enumerate() {
            pairs[i % dimensions.len()].push(pair);
        }
        let series = pairs
            .into_iter()
            .zip(&dimensions)
            .map(|(realisations, &d)| Series::new(d, realisations, &forces))
            .collect::<Result<_>>()?;
        Ok(Self { discretisation, series, coarser: None })
    }
}

impl Series {
    fn new(
        fractal_dimension: f64,
        realisations: Vec<(Realisation, RealisationResult)>,
        forces: &[f64],
    ) -> Result<Self> {
        let rows = realisations
            .iter()
            .map(|(_, result)| {
                let sample = |s: &Sample| {
                    let stiffness_bar = s.stiffness_bar.filter(|_| s.converged())?;
                    Some(analysis::StiffnessSample { stiffness_bar, contact_cells: s.contact_cells })
                };
                result.samples.iter().map(sample).collect()
            })
            .collect();
        let what = || format!("the ensemble at D_f = {fractal_dimension:?}");
        let curves = Curves::new(forces.to_vec(), rows).map_err(|e| Error::model(what())(e))?;
        let points = ensemble(&curves);
        Ok(Self { fractal_dimension, realisations, curves, points })
    }

    /// The same curves of the surfaces `draw` (a surface may be drawn more than once); its realisations stay
    /// those of the whole.
    #[must_use]
    pub fn redrawn(&self, draw: &[usize]) -> Self {
        let curves = self.curves.resampled(draw);
        Self { points: ensemble(&curves), curves, ..self.clone() }
    }

    /// k_bar of surface `i` under load number `j`, where it converged.
    fn stiffness(&self, i: usize, j: usize) -> Option<f64> {
        let sample = self.realisations.get(i)?.1.samples.get(j)?;
        sample.stiffness_bar.filter(|_| sample.converged())
    }

    /// Relative differences of k of each surface under load number `j`, between its grid and the one half as
    /// fine, and between that and the one a quarter as fine, all converged.
    pub fn grid_differences(&self, [half, quarter]: [&Self; 2], j: usize) -> Vec<[f64; 2]> {
        let of = |i: usize| {
            relative_differences(self.stiffness(i, j)?, half.stiffness(i, j)?, quarter.stiffness(i, j)?)
        };
        (0..self.realisations.len()).filter_map(of).collect()
    }

    /// Arithmetic mean of k_bar over the converged surfaces at each force.
    pub fn means(&self) -> Vec<Option<f64>> {
        self.points.iter().map(|p| p.stiffness_bar.map(|s| s.mean)).collect()
    }

    /// Mean contact fraction over the converged surfaces at force number `j`, where the model claims an area.
    pub fn contact_fraction(&self, j: usize) -> Option<f64> {
        self.mean_at(j, |s| s.contact_fraction)
    }

    /// Mean d/h over the converged surfaces at force number `j`.
    pub fn approach_over_h(&self, j: usize) -> Option<f64> {
        self.mean_at(j, |s| s.approach_over_h)
    }

    fn mean_at(&self, j: usize, of: impl Fn(&Sample) -> Option<f64>) -> Option<f64> {
        let samples = self.realisations.iter().map(|(_, r)| &r.samples[j]).filter(|s| s.converged());
        let values: Vec<f64> = samples.filter_map(of).collect();
        (!values.is_empty()).then(|| analysis::sum(values.iter().copied()) / values.len() as f64)
    }
}

impl Measured {
    /// Solves that did not meet their tolerance.
    pub fn not_converged(&self) -> usize {
        let samples = self.series.iter().flat_map(|s| &s.realisations).flat_map(|(_, r)| &r.samples);
        samples.filter(|s| !s.converged()).count()
    }

    /// Seconds of all its jobs together, whenever they were solved.
    pub fn seconds(&self) -> f64 {
        analysis::sum(self.series.iter().flat_map(|s| &s.realisations).map(|(_, r)| r.seconds))
    }

    /// The series of this fractal dimension.
    pub fn at(&self, fractal_dimension: f64) -> Option<&Series> {
        self.series.iter().find(|s| (s.fractal_dimension - fractal_dimension).abs() < 1e-9)
    }

    /// The series of one fractal dimension on both coarser grids.
    pub fn coarser_at(&self, fractal_dimension: f64) -> Option<[&Series; 2]> {
        let [half, quarter] = self.coarser.as_deref()?;
        Some([half.at(fractal_dimension)?, quarter.at(fractal_dimension)?])
    }

    /// The common forces.
    pub fn force_bar(&self) -> &[f64] {
        self.series.first().map_or(&[], |s| s.curves.force_bar())
    }
}
/// The transformed mean curve of one fractal dimension: each point and whether it lies on the one-cell floor.
pub fn transformed(series: &Series) -> Vec<(CollapsePoint, bool)> {
    series
        .points
        .iter()
        .filter_map(|p| {
            let k = p.stiffness_bar?.mean;
            let force_tilde = analytic::force_tilde(k, series.fractal_dimension).ok()?;
            let floor = p.min_contact_cells.is_some_and(|c| c < FLOOR_CELLS);
            Some((CollapsePoint { force_bar: p.force_bar, force_tilde }, floor))
        })
        .collect()
}
