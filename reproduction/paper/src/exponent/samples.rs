//! Reads the table of samples, and combines several of them.

use super::ladder::{GridPair, GridResults, Rungs};
use crate::evaluation::{Discretisation, Forces, read_rows};
use runs::{CsvFile, Error, Result};
use serde::Deserialize;
use std::path::Path;

/// Table of every surface.
pub const SAMPLES: &str = "exponent-samples.csv";

#[derive(Debug, Deserialize)]
struct SampleRow {
    model: String,
    fractal_dimension: f64,
    level: usize,
    surface: usize,
    size: usize,
    stiffness_bar: String,
    coarse_size: Option<usize>,
    coarse_stiffness_bar: Option<String>,
}

/// Forces of a table differ by rounding where their ranges do.
const SAME_FORCE: f64 = 1e-9;

fn same(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < SAME_FORCE
}

/// All pairs of a table of samples, each model and fractal dimension by itself, in its order.
///
/// # Errors
/// [`Error::File`] for a file that cannot be read or is not such a table. The loads are those of the command
/// in its header.
pub fn read(path: &Path) -> Result<Vec<Rungs>> {
    let file = CsvFile::read(path)?;
    let wrong = |what: &str| Error::content(path, format!("no table {SAMPLES}: {what}"));
    let command = file.comments.iter().find_map(|line| line.strip_prefix("command: "));
    let words: Vec<&str> = command.unwrap_or_default().split_whitespace().collect();
    let loads = |flag: &str| -> Result<Vec<f64>> {
        let at = words.iter().position(|word| *word == flag);
        let spec =
            at.and_then(|at| words.get(at + 1)).ok_or_else(|| wrong(&format!("no {flag} in its command")))?;
        Ok(Forces::parse(spec)?.values().to_vec())
    };
    let [solid, line] = [loads("--forces")?, loads("--line-forces")?];
    let mut all: Vec<Rungs> = Vec::new();
    for row in read_rows::<SampleRow>(path, &file)? {
        let (model, forces) = match row.model.as_str() {
            "bem3d" => (Discretisation::Bem3d { cells: 0, tolerance: 0.0 }, &solid),
            "mdr1d" => (Discretisation::Mdr1d { elements: 0 }, &line),
            other => return Err(wrong(&format!("model {other}"))),
        };
        let d = row.fractal_dimension;
        let place =
            all.iter().position(|r| r.model.name() == row.model && r.fractal_dimension.total_cmp(&d).is_eq());
        let place = place.unwrap_or_else(|| {
            let forces = forces.clone();
            all.push(Rungs { model, fractal_dimension: d, sizes: Vec::new(), forces, levels: Vec::new() });
            all.len() - 1
        });
        let rungs = &mut all[place];
        if row.level == rungs.levels.len() {
            rungs.sizes.push(row.size);
            rungs.levels.push(Vec::new());
        }
        let below = row.level.checked_sub(1).map(|l| rungs.sizes.get(l).copied());
        if rungs.sizes.get(row.level) != Some(&row.size) || below.is_some_and(|size| size != row.coarse_size)
        {
            return Err(wrong(&format!("level {} has another size", row.level)));
        }
        let solved = |text: &str| -> Result<GridResults> {
            let number = |word: &str| match word {
                "-" => Ok(None),
                word => word.parse().map(Some).map_err(|_| wrong(&format!("{word} is no stiffness"))),
            };
            let stiffnesses: Vec<Option<f64>> = text.split(' ').map(number).collect::<Result<_>>()?;
            let forces =
                forces.get(..stiffnesses.len()).ok_or_else(|| wrong("more stiffnesses than loads"))?;
            Ok(GridResults { forces: forces.to_vec(), stiffnesses, seconds: None })
        };
        let coarse = row.coarse_stiffness_bar.as_deref().filter(|text| !text.is_empty());
        rungs.levels[row.level].push(GridPair {
            index: row.surface,
            fine: solved(&row.stiffness_bar)?,
            coarse: coarse.map(&solved).transpose()?,
        });
    }
    Ok(all)
}

/// Combines the pairs of several runs with different seeds, at the loads that they have in common.
///
/// # Errors
/// [`Error::Parameter`] for a model and fractal dimension whose levels have different sizes, or that have no
/// load in common.
pub fn together(runs: Vec<Vec<Rungs>>) -> Result<Vec<Rungs>> {
    let mut all: Vec<Rungs> = Vec::new();
    for next in runs.into_iter().flatten() {
        let alike = |r: &&mut Rungs| {
            r.model.name() == next.model.name()
                && r.fractal_dimension.total_cmp(&next.fractal_dimension).is_eq()
        };
        let Some(own) = all.iter_mut().find(alike) else {
            all.push(next);
            continue;
        };
        if own.sizes.iter().zip(&next.sizes).any(|(a, b)| a != b) {
            let sizes = format!("{:?} and {:?}", own.sizes, next.sizes);
            return Err(Error::parameter("samples", sizes, "the same sizes of each level"));
        }
        own.forces.retain(|f| next.forces.iter().any(|other| same(*f, *other)));
        if own.forces.is_empty() {
            return Err(Error::parameter("samples", "no load in common", "runs that share loads"));
        }
        if next.sizes.len() > own.sizes.len() {
            own.sizes.clone_from(&next.sizes);
            own.levels.resize_with(next.levels.len(), Vec::new);
        }
        for (level, pairs) in next.levels.into_iter().enumerate() {
            own.levels[level].extend(pairs);
        }
        let forces = own.forces.clone();
        for pair in own.levels.iter_mut().flatten() {
            pair.fine.keep(&forces);
            if let Some(coarse) = &mut pair.coarse {
                coarse.keep(&forces);
            }
        }
    }
    Ok(all)
}

impl GridResults {
    /// Keeps these loads, where it has them.
    fn keep(&mut self, forces: &[f64]) {
        let own = |f: &f64| {
            let at = self.forces.iter().position(|other| same(*f, *other))?;
            Some((*f, self.stiffnesses[at]))
        };
        (self.forces, self.stiffnesses) = forces.iter().filter_map(own).unzip();
    }
}

#[cfg(test)]
mod tests {
    use super::super::tables;
    use super::*;
    use crate::evaluation::header;
    use runs::write_csv;

    fn solved(forces: &[f64], of: impl Fn(f64) -> f64) -> GridResults {
        let stiffnesses = forces.iter().map(|f| Some(of(*f))).collect();
        GridResults { forces: forces.to_vec(), stiffnesses, seconds: None }
    }

    fn rungs(forces: &[f64], offset: f64) -> Rungs {
        let pair = |index: usize, coarse: bool| {
            let k = offset + index as f64;
            GridPair {
                index,
                fine: solved(forces, |f| k + f),
                coarse: coarse.then(|| solved(forces, |f| k + 2.0 * f)),
            }
        };
        Rungs {
            model: Discretisation::Bem3d { cells: 0, tolerance: 0.0 },
            fractal_dimension: 2.4,
            sizes: vec![33, 65],
            forces: forces.to_vec(),
            levels: vec![vec![pair(0, false), pair(1, false)], vec![pair(0, true)]],
        }
    }

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(SAMPLES);
        let mut written = rungs(&[0.25, 0.5, 1.0], 1.0);
        written.levels[0][1].fine.stiffnesses[2] = None;
        let header = header("cargo xtask exponent --forces 0.25,0.5,1 --line-forces 1,2".to_owned());
        write_csv(&path, &tables::samples(std::slice::from_ref(&written)).unwrap(), &header).unwrap();
        let read = read(&path).unwrap();
        assert_eq!(read.len(), 1);
        assert_eq!(read[0].sizes, [33, 65]);
        assert_eq!(read[0].levels[0][1].fine.stiffnesses, written.levels[0][1].fine.stiffnesses);
        let coarse = read[0].levels[1][0].coarse.as_ref().unwrap();
        assert_eq!(coarse.stiffnesses, [Some(1.5), Some(2.0), Some(3.0)]);
        std::fs::write(&path, "model\nbem3d\n").unwrap();
        assert!(super::read(&path).unwrap_err().to_string().contains("no --forces"));
    }

    #[test]
    fn runs_together_have_the_loads_of_both() {
        let both = together(vec![
            vec![rungs(&[0.125, 0.25, 0.5], 1.0)],
            vec![rungs(&[0.25 * (1.0 + 1e-12), 0.5, 1.0], 5.0)],
        ]);
        let both = both.unwrap();
        assert_eq!(both[0].forces, [0.25, 0.5]);
        assert_eq!(both[0].levels.iter().map(Vec::len).collect::<Vec<_>>(), [4, 2]);
        let of_second: Vec<f64> = both[0].levels[0][2].fine.stiffnesses.iter().flatten().copied().collect();
        assert!(
            of_second.iter().zip([5.25, 5.5]).all(|(k, exact)| (k - exact).abs() < 1e-9),
            "{of_second:?}"
        );
        let other = Rungs { sizes: vec![33, 129], ..rungs(&[0.25], 0.0) };
        assert!(together(vec![vec![rungs(&[0.25], 0.0)], vec![other]]).is_err());
        assert!(together(vec![vec![rungs(&[0.25], 0.0)], vec![rungs(&[0.5], 0.0)]]).is_err());
    }
}
