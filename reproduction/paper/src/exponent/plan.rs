//! Predicts the cost of the study, and the number of surfaces for a given time.

use super::ladder::{GridPair, Ladder, Rungs};
use crate::evaluation::Forces;

/// Largest ratio of the variance of a level to that of the level before, for differences between grids that
/// are not measured yet.
const SHRINKS: f64 = 0.5;

/// One level of a ladder.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelCost {
    /// Cells a side, or elements.
    pub size: usize,
    /// Requested number of surfaces.
    pub surfaces: usize,
    /// Processor seconds of one surface for all fractal dimensions, both grids.
    pub seconds: f64,
    /// Variance of ln k_bar, or of the difference between the grids over the mean, averaged over loads and
    /// fractal dimensions.
    pub variance: f64,
    /// Whether seconds and variance were measured, or follow from the level below.
    pub measured: bool,
    /// Number of surfaces that minimises the error in the given time.
    pub best: usize,
}

/// Seconds and scatter of each level from the solved surfaces, and the best numbers of surfaces for a given
/// time, in proportion to `sqrt(variance/seconds)` (Giles 2008).
pub fn costs(ladder: &Ladder, rungs: &[Rungs], seconds: f64) -> Vec<LevelCost> {
    let mut levels: Vec<LevelCost> = Vec::with_capacity(ladder.sizes.len());
    for (level, &size) in ladder.sizes.iter().enumerate() {
        let pairs: Vec<(usize, &GridPair)> =
            rungs.iter().enumerate().flat_map(|(d, r)| r.levels[level].iter().map(move |p| (d, p))).collect();
        let found = variance(rungs, level).filter(|_| pairs.len() >= 2 * rungs.len());
        let (own, measured) = match found {
            Some(variance) => {
                let total: f64 = pairs.iter().map(|(_, pair)| pair.seconds()).sum();
                ((total * rungs.len() as f64 / pairs.len() as f64, variance), true)
            }
            None => match levels.last() {
                // Work in proportion to the cells, and a little more for the transforms.
                Some(below) => {
                    let growth = (size as f64 / below.size as f64).powf(ladder.growth());
                    ((below.seconds * growth, SHRINKS * below.variance), false)
                }
                None => ((0.0, 0.0), false),
            },
        };
        let surfaces = ladder.surfaces[level];
        levels.push(LevelCost { size, surfaces, seconds: own.0, variance: own.1, measured, best: 2 });
    }
    let sum: f64 = levels.iter().map(|l| (l.variance * l.seconds).sqrt()).sum();
    for level in &mut levels {
        if level.seconds > 0.0 && sum > 0.0 {
            level.best = ((seconds / sum * (level.variance / level.seconds).sqrt()) as usize).max(2);
        }
    }
    levels
}

/// Mean over loads and fractal dimensions of the variance of the level, relative to the mean on the fine
/// grid.
fn variance(rungs: &[Rungs], level: usize) -> Option<f64> {
    let mut all = Vec::new();
    for rung in rungs {
        let pairs = &rung.levels[level];
        for j in 0..pairs.first()?.fine.stiffnesses.len() {
            let stiffness = |pair: &GridPair| {
                let fine = pair.fine.stiffnesses[j]?;
                let coarse = pair.coarse.as_ref().map_or(Some(0.0), |c| c.stiffnesses[j])?;
                Some((fine, fine - coarse))
            };
            let values: Option<Vec<(f64, f64)>> = pairs.iter().map(stiffness).collect();
            let values = values?;
            let mean = values.iter().map(|v| v.0).sum::<f64>() / values.len() as f64;
            let differences: Vec<f64> = values.iter().map(|v| v.1 / mean).collect();
            let (_, deviation) = analysis::mean_and_deviation(&differences)?;
            all.push(deviation?.powi(2));
        }
    }
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

/// The levels as lines of text, with the time of the requested numbers of surfaces on this number of threads.
pub fn lines(name: &str, forces: &Forces, levels: &[LevelCost], threads: usize) -> Vec<String> {
    let mut lines = vec![format!(
        "{name}, loads {}: {:>9} {:>9} {:>14} {:>10} {:>14}",
        forces.spec(),
        "size",
        "surfaces",
        "seconds each",
        "deviation",
        "for the time"
    )];
    for l in levels {
        let how = if l.measured { "" } else { "  (from the level below)" };
        lines.push(format!(
            "{:>width$} {:>9} {:>14.2} {:>10.4} {:>14}{how}",
            l.size,
            l.surfaces,
            l.seconds,
            l.variance.sqrt(),
            l.best,
            width = name.len() + forces.spec().len() + 18
        ));
    }
    let total: f64 = levels.iter().map(|l| l.seconds * l.surfaces as f64).sum();
    let hours = total / 3600.0;
    lines.push(format!(
        "{name}: {hours:.2} processor hours, {:.2} h on {threads} threads",
        hours / threads as f64
    ));
    lines
}

impl Ladder {
    /// Power of the size with which work grows.
    fn growth(&self) -> f64 {
        match self.model {
            crate::evaluation::Discretisation::Bem3d { .. } => 2.1,
            crate::evaluation::Discretisation::Mdr1d { .. } => 1.1,
        }
    }
}
