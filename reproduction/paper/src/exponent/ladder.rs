//! Grids from coarse to fine, and pairs of the same surface on neighbouring ones.

use crate::evaluation::limits::{self, require, within};
use crate::evaluation::{
    Discretisation, Forces, Realisation, RealisationResult, Sample, Workplace, is_solved, realisation_jobs,
    solve_realisations,
};
use runs::{Progress, Result, Store};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use surface_gen::surface_seed;

/// Grids from coarse to fine, and the number of surfaces of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// The model; cells a side or elements are those of each level.
    pub model: Discretisation,
    /// Cells a side, or elements, increasing.
    pub sizes: Vec<usize>,
    /// Number of surfaces of each level.
    pub surfaces: Vec<usize>,
    /// Loads F_bar.
    pub forces: Forces,
    /// Loads above the first are solved on grids up to the second only.
    pub heavy: Option<(f64, usize)>,
}

/// The results of one surface on one grid.
#[derive(Debug, Clone)]
pub struct GridResults {
    /// F_bar, increasing.
    pub forces: Vec<f64>,
    /// k_bar at each force; `None` where a solve did not meet its tolerance. It has the five digits of the
    /// table of samples, so that all tables follow from that table bit for bit.
    pub stiffnesses: Vec<Option<f64>>,
    /// Processor seconds; `None` for results read from a table.
    pub seconds: Option<f64>,
}

/// One surface on the grid of its level, and on the next coarser one.
#[derive(Debug, Clone)]
pub struct GridPair {
    /// Number of the surface on its level.
    pub index: usize,
    /// On the grid of the level.
    pub fine: GridResults,
    /// On the next coarser grid; `None` on the coarsest.
    pub coarse: Option<GridResults>,
}

/// All pairs of one model and fractal dimension, level by level.
#[derive(Debug, Clone)]
pub struct Rungs {
    /// The model; its cells or elements are those of each level.
    pub model: Discretisation,
    /// D_f.
    pub fractal_dimension: f64,
    /// Cells a side, or elements, of each level.
    pub sizes: Vec<usize>,
    /// Loads F_bar; finer levels may end before the last.
    pub forces: Vec<f64>,
    /// Level, surface.
    pub levels: Vec<Vec<GridPair>>,
}

/// A realisation of a study and its place in it.
struct RealisationPlace {
    dimension: usize,
    level: usize,
    fine: bool,
    realisation: Realisation,
}

impl Ladder {
    /// Checks sizes and numbers.
    ///
    /// # Errors
    /// [`runs::Error::Parameter`] for sizes that do not increase, or another number of surfaces than of sizes, or fewer than two of them.
    pub fn validate(&self, sizes: &'static str, surfaces: &'static str, dimensions: usize) -> Result<()> {
        let range = match self.model {
            Discretisation::Bem3d { .. } => limits::CELLS,
            Discretisation::Mdr1d { .. } => limits::ELEMENTS,
        };
        self.sizes.iter().try_for_each(|&size| within(sizes, size, &range).map(drop))?;
        require(!self.sizes.is_empty(), sizes, "nothing", "at least one size")?;
        for pair in self.sizes.windows(2) {
            let expected = format!("sizes that increase, after {}", pair[0]);
            require(pair[1] > pair[0], sizes, pair[1], expected)?;
        }
        let [own, count] = [&self.sizes, &self.surfaces].map(Vec::len);
        let expected = format!("{own} numbers, one for each size");
        require(own == count, surfaces, format!("{count} numbers"), expected)?;
        let two = |count: &usize| require(*count >= 2, surfaces, count, "at least 2 on each grid");
        self.surfaces.iter().try_for_each(two)?;
        // Each on its own grid and on the next coarser one.
        let all = self.surfaces.iter().fold(0, |sum: usize, &count| sum.saturating_add(count));
        limits::jobs(surfaces, all, 2 * dimensions)
    }

    /// Loads on the grid of this size.
    fn forces_on(&self, size: usize) -> Arc<[f64]> {
        let all = self.forces.values();
        match self.heavy {
            Some((most, largest)) if size > largest => all.iter().copied().filter(|&f| f <= most).collect(),
            _ => all.into(),
        }
    }

    /// The jobs of each level, on its own grid and, under the same loads, on the next coarser one.
    fn places(&self, dimensions: &[f64], seed: u64, surfaces: &[usize]) -> Vec<RealisationPlace> {
        let mut places = Vec::new();
        for (level, &count) in surfaces.iter().enumerate() {
            let own = self.sizes[level];
            let forces = self.forces_on(own);
            let grids = std::iter::once(own).chain(level.checked_sub(1).map(|below| self.sizes[below]));
            for index in 0..count {
                for (dimension, &fractal_dimension) in dimensions.iter().enumerate() {
                    places.extend(grids.clone().map(|size| RealisationPlace {
                        dimension,
                        level,
                        fine: size == own,
                        realisation: Realisation {
                            discretisation: self.model.with_size(size),
                            fractal_dimension,
                            // Levels are independent: each has a master seed of its own.
                            master_seed: surface_seed(seed, level as u64),
                            index,
                            forces: Arc::clone(&forces),
                        },
                    }));
                }
            }
        }
        places
    }

    /// Number of surfaces of the level of this size that the store of `out` holds completely, from the first on.
    ///
    /// # Errors
    /// As [`realisation_jobs`].
    pub fn stored(
        &self,
        dimensions: &[f64],
        seed: u64,
        size: usize,
        (out, store): (&Path, &Store),
    ) -> Result<usize> {
        let asked = self.sizes.iter().zip(&self.surfaces);
        let level: Vec<usize> = asked.map(|(&own, &count)| if own == size { count } else { 0 }).collect();
        let realisations = realisations(self.places(dimensions, seed, &level).iter());
        let jobs = realisation_jobs(&realisations, out)?;
        let surfaces = jobs.chunk_by(|a, b| a.surface() == b.surface());
        Ok(surfaces.take_while(|jobs| jobs.iter().all(|job| is_solved(job, store))).count())
    }

    /// All surfaces of a study on their grids.
    pub fn realisations(&self, dimensions: &[f64], seed: u64) -> Vec<Realisation> {
        realisations(self.places(dimensions, seed, &self.surfaces).iter())
    }

    /// Solves a number of surfaces of each level or reads them from the store, the largest grids first, each
    /// with as many threads as its memory allows.
    ///
    /// # Errors
    /// As [`solve_realisations`].
    pub fn solve(
        &self,
        dimensions: &[f64],
        seed: u64,
        surfaces: &[usize],
        place: &Workplace<'_>,
        progress: &dyn Progress,
    ) -> Result<Vec<Rungs>> {
        let places = self.places(dimensions, seed, surfaces);
        let mut by_size: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, place) in places.iter().enumerate() {
            by_size.entry(place.realisation.discretisation.size()).or_default().push(i);
        }
        let mut results: Vec<Option<RealisationResult>> = places.iter().map(|_| None).collect();
        for (size, members) in by_size.into_iter().rev() {
            let of_size = realisations(members.iter().map(|&i| &places[i]));
            let what = format!("{}: {} surfaces, size {size}", self.model.name(), of_size.len());
            let solved = solve_realisations(&what, &of_size, place, progress)?;
            for (i, result) in members.into_iter().zip(solved) {
                results[i] = Some(result);
            }
        }
        let mut rungs: Vec<Rungs> = (dimensions.iter())
            .map(|&fractal_dimension| Rungs {
                model: self.model,
                fractal_dimension,
                sizes: self.sizes.clone(),
                forces: self.forces.values().to_vec(),
                levels: surfaces.iter().map(|&count| Vec::with_capacity(count)).collect(),
            })
            .collect();
        for (place, result) in places.into_iter().zip(results.into_iter().flatten()) {
            let level = &mut rungs[place.dimension].levels[place.level];
            let result = GridResults::from(&result);
            match level.last_mut() {
                // The coarse grid follows the fine one.
                Some(pair) if !place.fine => pair.coarse = Some(result),
                _ => level.push(GridPair { index: place.realisation.index, fine: result, coarse: None }),
            }
        }
        Ok(rungs)
    }
}

fn realisations<'a>(places: impl Iterator<Item = &'a RealisationPlace>) -> Vec<Realisation> {
    places.map(|place| place.realisation.clone()).collect()
}

impl From<&RealisationResult> for GridResults {
    fn from(result: &RealisationResult) -> Self {
        let samples = &result.samples;
        let stiffness = |s: &Sample| s.stiffness_bar.filter(|_| s.converged()).and_then(five_digits);
        Self {
            forces: samples.iter().map(|s| s.force_bar).collect(),
            stiffnesses: samples.iter().map(stiffness).collect(),
            seconds: Some(result.seconds),
        }
    }
}

/// A stiffness rounded as in the table of samples.
fn five_digits(stiffness: f64) -> Option<f64> {
    format!("{stiffness:.4e}").parse().ok()
}

impl Rungs {
    /// Pairs of all levels.
    pub fn pairs(&self) -> impl Iterator<Item = &GridPair> {
        self.levels.iter().flatten()
    }
}

impl GridPair {
    /// Seconds of both solves, where known.
    pub fn seconds(&self) -> f64 {
        let seconds = |solved: &GridResults| solved.seconds.unwrap_or(0.0);
        seconds(&self.fine) + self.coarse.as_ref().map_or(0.0, seconds)
    }

    /// Number of loads at which one of the solves did not meet its tolerance.
    pub fn not_converged(&self) -> usize {
        let results = std::iter::once(&self.fine).chain(&self.coarse);
        results.flat_map(|r| &r.stiffnesses).filter(|k| k.is_none()).count()
    }
}
