//! Surfaces of an ensemble that are read from a compact table, one row each, instead of solved.

use crate::evaluation::realisation::{Discretisation, EnsembleModel, Realisation, RealisationResult};
use crate::evaluation::run::Run;
use crate::evaluation::sample::Sample;
use crate::evaluation::table_of::read_rows;
use contact_model::{Certificate, Status};
use runs::{CsvFile, Error, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Measured rms height of every surface of an ensemble, whose side and contact modulus are 1 too.
const RMS_HEIGHT: f64 = 1.0;
/// Strategy of states that are read from a table.
const READ: &str = "read from a table";

/// A row of a compact table.
#[derive(Deserialize)]
struct SurfaceRow {
    size: usize,
    fractal_dimension: f64,
    seed: u64,
    stiffness_bar: String,
    approach_over_h: String,
    contact_cells: String,
}

/// The results of realisations, read from the compact table of a model in a directory, `fig2-compact.csv` or
/// `fig6-compact.csv`.
///
/// Numbers have seven digits; certificates, work and times are not in the table.
pub struct ReadSurfaces {
    path: PathBuf,
    rows: Vec<SurfaceRow>,
}

impl ReadSurfaces {
    /// The table of a model, for a run whose loads and tolerance it has.
    ///
    /// # Errors
    /// [`Error::File`] for a file that cannot be read, is no compact table, or has other loads or another
    /// tolerance.
    pub fn open(directory: &Path, model: EnsembleModel, run: &Run) -> Result<Self> {
        let name = match model {
            EnsembleModel::Bem3d => "fig2-compact.csv",
            EnsembleModel::Mdr1d => "fig6-compact.csv",
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
        if !solved.ends_with(&ends) || (model == EnsembleModel::Bem3d && !solved.contains(&tolerance)) {
            let wanted = if model == EnsembleModel::Bem3d { &tolerance[2..] } else { "" };
            let reason = format!("it has \"{solved}\"; the run asks for \"{wanted}{}\"", &ends[1..]);
            return Err(Error::content(&path, reason));
        }
        Ok(Self { rows: read_rows(&path, &file)?, path })
    }

    /// The result of a realisation.
    ///
    /// # Errors
    /// [`Error::File`] for a surface that the table has not, or a row that does not fit the loads.
    pub fn of(&self, realisation: &Realisation) -> Result<RealisationResult> {
        let wrong = |reason: String| Error::content(&self.path, reason);
        let (size, d, seed) =
            (realisation.discretisation.size(), realisation.fractal_dimension, realisation.seed());
        let same = |row: &&SurfaceRow| {
            row.size == size && row.seed == seed && row.fractal_dimension.total_cmp(&d).is_eq()
        };
        let name = || format!("surface {} (seed {seed}) of D_f = {d:?} with size {size}", realisation.index);
        let row = self.rows.iter().find(same).ok_or_else(|| wrong(format!("it has no {}", name())))?;
        let columns = [&row.stiffness_bar, &row.approach_over_h, &row.contact_cells];
        let [stiffness, approach, cells] = columns.map(|text| -> Result<Vec<Option<f64>>> {
            let number = |word: &str| match word {
                "-" => Ok(None),
                word => (word.parse().ok().filter(|v: &f64| v.is_finite()).map(Some))
                    .ok_or_else(|| wrong(format!("{word:?} is no number: {}", name()))),
            };
            let values: Vec<Option<f64>> = text.split(' ').map(number).collect::<Result<_>>()?;
            if values.len() == realisation.forces.len() {
                Ok(values)
            } else {
                let (found, loads) = (values.len(), realisation.forces.len());
                Err(wrong(format!("{found} values for {loads} loads: {}", name())))
            }
        });
        let (stiffness, approach, cells) = (stiffness?, approach?, cells?);
        let area = |cells: f64| match realisation.discretisation {
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
        let samples = realisation.forces.iter().enumerate().map(sample).collect();
        Ok(RealisationResult { rms_height: RMS_HEIGHT, seconds: 0.0, samples })
    }
}
