//! Every surface of an ensemble in one row: the table from which means, errors and fits follow, and from which an
//! ensemble is read again instead of solved.

use crate::measured::Measured;
use crate::realisation::{Discretisation, Model, RealisationJob, RealisationResult};
use crate::run::Run;
use crate::sample::Sample;
use crate::table_of::{TableOf, read_rows};
use crate::tables::{CELLS, FRACTAL_DIMENSION};
use analysis::Table;
use contact_model::{Certificate, Status};
use runs::{CsvFile, Error, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Measured rms height of every surface of an ensemble, whose side and contact modulus are 1 too.
const RMS_HEIGHT: f64 = 1.0;
/// Strategy of states that are read from a table.
const READ: &str = "read from a table";

fn seven_digits(value: f64) -> String {
    format!("{value:.6e}")
}

/// One row for each surface on its grid and, of the first surfaces, on the two coarser ones, with seven digits.
///
/// # Errors
/// As [`TableOf::table`].
pub fn compact_table(title: &str, measured: &Measured) -> Result<Table> {
    const LOADS: &str =
        "at the loads of the curves' table, from the smallest up, separated by blanks; - where there is none";
    let coarser = measured.coarser.iter().flat_map(|both| both.iter());
    let grids = std::iter::once(measured).chain(coarser);
    let realisations: Vec<_> = grids.flat_map(|m| &m.series).flat_map(|s| &s.realisations).collect();
    let values = |result: &RealisationResult, of: fn(&Sample) -> Option<String>| {
        let each =
            result.samples.iter().map(|s| of(s).filter(|_| s.converged()).unwrap_or_else(|| "-".to_owned()));
        each.collect::<Vec<_>>().join(" ")
    };
    TableOf::new(title, &realisations)
        .column("size", "1", CELLS, |(u, _)| u.discretisation.size())
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |(u, _)| u.fractal_dimension)
        .column("surface", "1", "number of the surface in its ensemble", |(u, _)| u.index)
        .column("seed", "1", "seed of this surface", |(u, _)| u.seed)
        .column("stiffness_bar", "1", LOADS, |(_, r)| values(r, |s| s.stiffness_bar.map(seven_digits)))
        .column("approach_over_h", "1", LOADS, |(_, r)| values(r, |s| s.approach_over_h.map(seven_digits)))
        .column("contact_cells", "1", LOADS, |(_, r)| values(r, |s| s.contact_cells.map(|c| c.to_string())))
        .table()
}

/// A row of a compact table.
#[derive(Deserialize)]
struct Row {
    size: usize,
    fractal_dimension: f64,
    seed: u64,
    stiffness_bar: String,
    approach_over_h: String,
    contact_cells: String,
}

/// The results of jobs, read from the compact table of a model in a directory, `fig2-compact.csv` or
/// `fig6-compact.csv`.
///
/// Numbers have seven digits; certificates, work and times are not in the table.
pub struct ReadSurfaces {
    path: PathBuf,
    rows: Vec<Row>,
}

impl ReadSurfaces {
    /// The table of a model, for a run whose loads and tolerance it has.
    ///
    /// # Errors
    /// [`Error::File`] for a file that cannot be read, is no compact table, or has other loads or another
    /// tolerance.
    pub fn open(directory: &Path, model: Model, run: &Run) -> Result<Self> {
        let name = match model {
            Model::Bem3d => "fig2-compact.csv",
            Model::Mdr1d => "fig6-compact.csv",
        };
        let path = directory.join(name);
        let file = CsvFile::read(&path)?;
        let (_, _, forces) = run.ensemble(model);
        let begin = format!("{}: ", model.name());
        let solved = file.comments.iter().find(|line| line.starts_with(&begin) && line.contains(", loads "));
        let solved =
            solved.ok_or_else(|| Error::content(&path, format!("no line {begin}... with its loads")))?;
        let ends = format!(", loads {}", forces.spec());
        let tolerance = format!(", tolerance {:?},", run.tolerance);
        if !solved.ends_with(&ends) || (model == Model::Bem3d && !solved.contains(&tolerance)) {
            let wanted = if model == Model::Bem3d { &tolerance[2..] } else { "" };
            let reason = format!("it has \"{solved}\"; the run asks for \"{wanted}{}\"", &ends[1..]);
            return Err(Error::content(&path, reason));
        }
        Ok(Self { rows: read_rows(&path, &file)?, path })
    }

    /// The result of a job.
    ///
    /// # Errors
    /// [`Error::File`] for a surface that the table has not, or a row that does not fit the loads.
    pub fn of(&self, job: &RealisationJob) -> Result<RealisationResult> {
        let wrong = |reason: String| Error::content(&self.path, reason);
        let (size, d, seed) = (job.discretisation.size(), job.fractal_dimension, job.seed);
        let same =
            |row: &&Row| row.size == size && row.seed == seed && row.fractal_dimension.total_cmp(&d).is_eq();
        let name = || format!("surface {} (seed {seed}) of D_f = {d:?} with size {size}", job.index);
        let row = self.rows.iter().find(same).ok_or_else(|| wrong(format!("it has no {}", name())))?;
        let columns = [&row.stiffness_bar, &row.approach_over_h, &row.contact_cells];
        let [stiffness, approach, cells] = columns.map(|text| -> Result<Vec<Option<f64>>> {
            let number = |word: &str| match word {
                "-" => Ok(None),
                word => (word.parse().ok().filter(|v: &f64| v.is_finite()).map(Some))
                    .ok_or_else(|| wrong(format!("{word:?} is no number: {}", name()))),
            };
            let values: Vec<Option<f64>> = text.split(' ').map(number).collect::<Result<_>>()?;
            if values.len() == job.forces.len() {
                Ok(values)
            } else {
                let (found, loads) = (values.len(), job.forces.len());
                Err(wrong(format!("{found} values for {loads} loads: {}", name())))
            }
        });
        let (stiffness, approach, cells) = (stiffness?, approach?, cells?);
        let area = |cells: f64| match job.discretisation {
            Discretisation::Bem3d { .. } => Some(cells / (size as f64).powi(2)),
            Discretisation::Mdr1d { .. } => None,
        };
        let sample = |(i, &force_bar): (usize, &f64)| Sample {
            force_bar,
            force: force_bar * RMS_HEIGHT,
            approach_over_h: approach[i],
            stiffness_bar: stiffness[i],
            contact_fraction: cells[i].and_then(area),
            contact_cells: cells[i].map(|cells| cells as usize),
            contact_length: stiffness[i].map(|k| k * contact_model::PAPER_STIFFNESS_FACTOR),
            iterations: 0,
            applications: 0,
            status: match stiffness[i] {
                Some(_) => Status::Converged,
                None => Status::Stagnated,
            }
            .as_str()
            .to_owned(),
            strategy: READ.to_owned(),
            certificate: Certificate::default(),
        };
        let samples = job.forces.iter().enumerate().map(sample).collect();
        Ok(RealisationResult { rms_height: RMS_HEIGHT, seconds: 0.0, samples })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header::{describe, header};
    use crate::{Request, Session, measure};
    use approx::assert_relative_eq;
    use runs::{Silent, write_csv};

    #[test]
    fn an_ensemble_is_read_from_its_table() {
        let dir = tempfile::tempdir().unwrap();
        let request = Request {
            cells: Some(65),
            surfaces: Some(3),
            elements: Some(1024),
            lines: Some(3),
            fractal_dimensions: Some(vec![2.2, 2.6]),
            forces: Some("1e-2:20:3".to_owned()),
            out: Some(dir.path().to_owned()),
            ..Request::default()
        };
        let run = Run::new(&request).unwrap();
        let store = Session::open(&run.out, false).unwrap().store;
        let samples = Some(dir.path().to_owned());
        let read = |request: Request, model| {
            let run = Run::new(&Request { samples: samples.clone(), ..request }).unwrap();
            measure(model, &run, &store, &Silent).map_err(|error| error.to_string())
        };
        for (model, name) in [(Model::Bem3d, "fig2-compact.csv"), (Model::Mdr1d, "fig6-compact.csv")] {
            let solved = measure(model, &run, &store, &Silent).unwrap();
            assert!(read(request.clone(), model).unwrap_err().contains(name));
            let header = describe(header("command".to_owned()), &run, &[&solved]);
            write_csv(&dir.path().join(name), &compact_table("surfaces", &solved).unwrap(), &header).unwrap();
            let again = read(request.clone(), model).unwrap();
            let grids = |m: &Measured| -> Vec<Measured> {
                std::iter::once(m.clone())
                    .chain(m.coarser.clone().into_iter().flat_map(|both| *both))
                    .collect()
            };
            assert_eq!(grids(&again).len(), 3);
            for (again, solved) in grids(&again).iter().zip(grids(&solved)) {
                assert_eq!(again.discretisation, solved.discretisation);
                for (again, solved) in again.series.iter().zip(&solved.series) {
                    assert_eq!(again.curves.force_bar(), solved.curves.force_bar());
                    for (again, solved) in again.means().into_iter().zip(solved.means()) {
                        assert_relative_eq!(again.unwrap(), solved.unwrap(), max_relative = 1e-6);
                    }
                    for j in 0..again.points.len() {
                        assert_eq!(again.points[j].min_contact_cells, solved.points[j].min_contact_cells);
                        assert_eq!(again.contact_fraction(j).is_some(), model == Model::Bem3d);
                    }
                }
            }
            // What the table has not is named.
            let other = read(Request { forces: Some("1e-2:20:4".to_owned()), ..request.clone() }, model);
            assert!(other.unwrap_err().contains("loads 1e-2:20:4"));
            let more = Request { surfaces: Some(4), lines: Some(4), ..request.clone() };
            let missing = read(more, model).unwrap_err();
            assert!(missing.contains("it has no surface 3 (seed "), "{missing}");
        }
        let tight = read(Request { tolerance: Some(1e-6), ..request }, Model::Bem3d).unwrap_err();
        assert!(tight.contains("tolerance 1e-6"), "{tight}");
    }
}
