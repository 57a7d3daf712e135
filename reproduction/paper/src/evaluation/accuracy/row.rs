//! One solution of one problem by one method: its result, cost and errors.

use super::problem::ProblemKey;
use crate::evaluation::realisation::Discretisation;
use contact_model::{ContactModel, ContactState, Field, Load, Scene, Stop};
use runs::{Error, Result, cpu_seconds, on_one_thread, peak_memory, reset_peak_memory, resident_memory};
use serde::{Deserialize, Serialize};

/// A closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Formula {
    /// Hertz's sphere.
    Hertz,
    /// Eq. 12.
    PowerLaw,
    /// The stiffness of the rigid square.
    Plateau,
}

impl Formula {
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Hertz => "hertz",
            Self::PowerLaw => "power_law",
            Self::Plateau => "plateau",
        }
    }
}

/// The method of a solution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) enum Way {
    /// Boundary elements.
    Solid {
        cells: usize,
        tolerance: f64,
        #[serde(with = "StoredMethod")]
        method: bem3d::Method,
    },
    /// The one-dimensional reduction.
    Line { elements: usize },
    /// A closed form.
    Formula(Formula),
}

/// [`bem3d::Method`] as it is stored.
#[derive(Serialize, Deserialize)]
#[serde(remote = "bem3d::Method")]
enum StoredMethod {
    Auto,
    Iterative,
    SingleLevel,
}

impl Way {
    /// The method for the surfaces of an ensemble.
    pub fn of(discretisation: Discretisation) -> Self {
        match discretisation {
            Discretisation::Bem3d { cells, tolerance } => {
                Self::Solid { cells, tolerance, method: bem3d::Method::Auto }
            }
            Discretisation::Mdr1d { elements } => Self::Line { elements },
        }
    }

    pub fn model(&self) -> &'static str {
        match self {
            Self::Solid { .. } => "bem3d",
            Self::Line { .. } => "mdr1d",
            Self::Formula(formula) => formula.as_str(),
        }
    }

    pub fn size(&self) -> Option<usize> {
        match *self {
            Self::Solid { cells, .. } => Some(cells),
            Self::Line { elements } => Some(elements),
            Self::Formula(_) => None,
        }
    }

    pub fn tolerance(&self) -> Option<f64> {
        match *self {
            Self::Solid { tolerance, .. } => Some(tolerance),
            _ => None,
        }
    }

    pub fn method(&self) -> String {
        match self {
            Self::Solid { method, .. } => method.as_str().replace('_', "-"),
            _ => String::new(),
        }
    }
}

/// Result and cost of a solution.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeasuredSolution {
    /// k in units of E* L.
    pub stiffness: Option<f64>,
    /// d in rms heights (in sides for bodies without one).
    pub approach: Option<f64>,
    /// Contact area over A0.
    pub area: Option<f64>,
    /// Compared within a job; not stored.
    #[serde(skip)]
    pub pressure: Option<Vec<f64>>,
    pub contact_cells: Option<usize>,
    pub cpu_seconds: Option<f64>,
    pub bytes: Option<u64>,
    pub iterations: usize,
    pub applications: usize,
    pub status: String,
}

/// The four contributions to the error of k, relative.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Parts {
    /// Difference to the tightest tolerance on the same grid.
    pub algebraic: Option<f64>,
    /// Difference to the limit of fine grids, including the waves that only these resolve.
    pub discretisation: Option<f64>,
    /// Difference to three dimensions.
    pub model: Option<f64>,
    /// Standard error of the mean of 60 surfaces.
    pub ensemble: Option<f64>,
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct StudyRow {
    pub problem: ProblemKey,
    pub way: Way,
    /// Surfaces in the answer.
    pub surfaces: usize,
    pub answer: MeasuredSolution,
    /// Relative errors of k, d, area, and L2 of the pressure.
    pub errors: [Option<f64>; 4],
    /// Relative uncertainty of the reference of k.
    pub reference_error: Option<f64>,
    pub parts: Parts,
    /// Whether no row of the same problem is both faster and more accurate.
    pub pareto: bool,
}

impl StudyRow {
    pub fn new(problem: ProblemKey, way: Way, answer: MeasuredSolution) -> Self {
        Self {
            problem,
            way,
            surfaces: 1,
            answer,
            errors: [None; 4],
            reference_error: None,
            parts: Parts::default(),
            pareto: false,
        }
    }

    pub fn converged(&self) -> bool {
        self.answer.status == contact_model::Status::Converged.as_str()
    }
}

/// An error if `stop` is set. A measurement runs on its own thread, to which `stop` cannot be sent; it is
/// therefore polled before each measurement.
pub(crate) fn unless_stopped(stop: Stop<'_>) -> Result<()> {
    if stop.stops() {
        return Err(Error::model("accuracy against time")(contact_model::Error::Stopped { best: None }));
    }
    Ok(())
}

/// Prepares and solves from a cold start on one thread, and measures the cost. `None` for a model that does
/// not support this load or surface.
pub(crate) fn measure(
    model: &dyn ContactModel,
    scene: &Scene,
    load: Load,
    seed: u64,
) -> Result<Option<MeasuredSolution>> {
    on_one_thread(|| measure_here(model, scene, load, seed))
}

fn measure_here(
    model: &dyn ContactModel,
    scene: &Scene,
    load: Load,
    seed: u64,
) -> Result<Option<MeasuredSolution>> {
    reset_peak_memory();
    let before = resident_memory();
    let start = cpu_seconds();
    let found = (|| {
        let mut contact = model.prepare(scene, seed)?;
        let state = contact.solve(load).or_else(contact_model::Error::into_best)?;
        Ok((state, contact.normalisation()))
    })();
    let seconds = cpu_seconds().zip(start).map(|(end, start)| end - start);
    let bytes = peak_memory().zip(before).map(|(peak, before)| peak.saturating_sub(before));
    let (state, normalisation) = match found {
        Err(contact_model::Error::OutOfRange { .. } | contact_model::Error::Unsupported { .. }) => {
            return Ok(None);
        }
        other => other.map_err(Error::model(model.name()))?,
    };
    let ContactState { approach, stiffness, area, fields, report, .. } = state;
    Ok(Some(MeasuredSolution {
        stiffness: stiffness.map(|k| k / (normalisation.contact_modulus * normalisation.length)),
        approach,
        area: area.map(|a| normalisation.contact_fraction(a)),
        pressure: fields.and_then(|f| f.pressure).map(Field::into_values),
        contact_cells: report.contact_cells,
        cpu_seconds: seconds,
        bytes,
        iterations: report.iterations,
        applications: report.applications,
        status: report.status.as_str().to_owned(),
    }))
}

/// Marks in each problem the rows that no other beats in both seconds and error of k. Rows without a clock
/// and rows that missed their tolerance do not compete.
pub(crate) fn mark_pareto(rows: &mut [StudyRow]) {
    let candidates: Vec<(usize, f64, f64)> = rows
        .iter()
        .enumerate()
        .filter(|(_, r)| r.converged())
        .filter_map(|(i, r)| {
            // A number out of a book takes no time.
            let free = matches!(r.way, Way::Formula(_)).then_some(0.0);
            Some((i, r.answer.cpu_seconds.or(free)?, r.errors[0]?))
        })
        .collect();
    let beaten = |&(i, t, e): &(usize, f64, f64)| {
        candidates
            .iter()
            .any(|&(j, u, f)| rows[i].problem == rows[j].problem && ((u < t && f <= e) || (u <= t && f < e)))
    };
    let front: Vec<usize> = candidates.iter().filter(|c| !beaten(c)).map(|c| c.0).collect();
    for i in front {
        rows[i].pareto = true;
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::Family;
    use super::*;

    #[test]
    fn the_front() {
        let row = |seconds, error, family| {
            let answer = MeasuredSolution {
                cpu_seconds: Some(seconds),
                status: "converged".into(),
                ..MeasuredSolution::default()
            };
            let mut row = StudyRow::new(ProblemKey::body(family), Way::Formula(Formula::Hertz), answer);
            row.errors[0] = Some(error);
            row
        };
        let (a, b) = (Family::Sphere, Family::Square);
        let mut rows =
            [row(1.0, 0.1, a), row(2.0, 0.2, a), row(3.0, 0.01, a), row(9.0, 0.5, b), row(0.1, 0.0, a)];
        rows[4].answer.status = "stagnated".into();
        mark_pareto(&mut rows);
        assert_eq!(rows.map(|r| r.pareto), [true, false, true, true, false]);
    }
}
