//! One surface under one load: what is kept of a state.

use crate::table_of::{maybe, names};
use contact_model::{Certificate, ContactState, Normalisation, Result};
use runs::number;

/// Fewer contact cells than this are the one-cell floor of a grid: kept, marked, left out of fits and lines.
pub const FLOOR_CELLS: usize = 10;

/// What is kept of one contact state, in the dimensionless words of the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// F_bar asked for (Eq. 10, with the surface's own measured rms height).
    pub force_bar: f64,
    /// F, in E* L^2 (the surface has E* = L = 1).
    pub force: f64,
    /// d/h.
    pub approach_over_h: Option<f64>,
    /// k_bar (Eq. 8).
    pub stiffness_bar: Option<f64>,
    /// Contact area over A0; only where the model claims an area.
    pub contact_fraction: Option<f64>,
    /// Cells (elements) in contact.
    pub contact_cells: Option<usize>,
    /// Contact length k/E* (Eq. 1), in L.
    pub contact_length: Option<f64>,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Applications of the elastic operator.
    pub applications: usize,
    /// How the solve ended, as [`contact_model::Status::as_str`].
    pub status: String,
    /// Which way the solver took.
    pub strategy: String,
    /// The evidence.
    pub certificate: Certificate,
}

impl Sample {
    /// Takes from a state what is kept.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] when the surface has no relief to normalise by.
    pub fn new(force_bar: f64, state: &ContactState, normalisation: &Normalisation) -> Result<Self> {
        let report = &state.report;
        Ok(Self {
            force_bar,
            force: state.force,
            approach_over_h: state.approach.map(|d| normalisation.approach_over_h(d)).transpose()?,
            stiffness_bar: state.stiffness.map(|k| normalisation.stiffness_bar(k)),
            contact_fraction: state.area.map(|a| normalisation.contact_fraction(a)),
            contact_cells: report.contact_cells,
            contact_length: state.stiffness.map(|k| normalisation.contact_length(k) / normalisation.length),
            iterations: report.iterations,
            applications: report.applications,
            status: report.status.as_str().to_owned(),
            strategy: report.strategy.clone(),
            certificate: report.certificate,
        })
    }

    /// Whether the solver met its tolerance.
    pub fn converged(&self) -> bool {
        self.status == contact_model::Status::Converged.as_str()
    }

    /// Whether fewer than [`FLOOR_CELLS`] cells touch.
    pub fn below_floor(&self) -> bool {
        self.contact_cells.is_some_and(|c| c < FLOOR_CELLS)
    }
}

/// Name of a column of a stored unit and what stands in it; absent is empty.
type SampleColumn = (&'static str, fn(&Sample) -> String);

const COLUMNS: [SampleColumn; 16] = [
    ("force_bar", |s| number(s.force_bar)),
    ("force", |s| number(s.force)),
    ("approach_over_h", |s| maybe(s.approach_over_h)),
    ("stiffness_bar", |s| maybe(s.stiffness_bar)),
    ("contact_fraction", |s| maybe(s.contact_fraction)),
    ("contact_cells", |s| s.contact_cells.map(|c| c.to_string()).unwrap_or_default()),
    ("contact_length", |s| maybe(s.contact_length)),
    ("iterations", |s| s.iterations.to_string()),
    ("applications", |s| s.applications.to_string()),
    ("status", |s| s.status.clone()),
    ("strategy", |s| s.strategy.clone()),
    ("duality_gap", |s| number(s.certificate.duality_gap)),
    ("penetration", |s| number(s.certificate.penetration)),
    ("complementarity", |s| number(s.certificate.complementarity)),
    ("load_error", |s| number(s.certificate.load_error)),
    ("stiffness_error", |s| maybe(s.certificate.stiffness_error)),
];

/// Names of the fields of [`Sample::fields`], in order.
pub const FIELDS: [&str; COLUMNS.len()] = names(&COLUMNS);

impl Sample {
    /// Every field as text that reads back to the same bits; absent is empty.
    pub fn fields(&self) -> [String; COLUMNS.len()] {
        COLUMNS.map(|(_, field)| field(self))
    }

    /// Reads [`Sample::fields`] back; `None` for anything else, and for numbers that are not finite.
    pub fn from_fields<'a>(fields: impl IntoIterator<Item = &'a str>) -> Option<Self> {
        let fields: Vec<&str> = fields.into_iter().collect();
        let at = |i: usize| fields.get(i).copied();
        let real = |i| at(i)?.parse::<f64>().ok().filter(|v| v.is_finite());
        let maybe = |i| match at(i)? {
            "" => Some(None),
            _ => real(i).map(Some),
        };
        let count = |i| at(i)?.parse::<usize>().ok();
        if fields.len() != FIELDS.len() {
            return None;
        }
        Some(Self {
            force_bar: real(0)?,
            force: real(1)?,
            approach_over_h: maybe(2)?,
            stiffness_bar: maybe(3)?,
            contact_fraction: maybe(4)?,
            contact_cells: if at(5)?.is_empty() { None } else { Some(count(5)?) },
            contact_length: maybe(6)?,
            iterations: count(7)?,
            applications: count(8)?,
            status: at(9)?.to_owned(),
            strategy: at(10)?.to_owned(),
            certificate: Certificate {
                duality_gap: real(11)?,
                penetration: real(12)?,
                complementarity: real(13)?,
                load_error: real(14)?,
                stiffness_error: maybe(15)?,
                ..Certificate::default()
            },
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn sample(force_bar: f64) -> Sample {
        Sample {
            force_bar,
            force: force_bar / 3.0,
            approach_over_h: Some(0.1 + 0.2),
            stiffness_bar: Some(force_bar.sqrt()),
            contact_fraction: None,
            contact_cells: Some(12),
            contact_length: Some(1e-300),
            iterations: 3,
            applications: 4,
            status: "converged".into(),
            strategy: "fft 4 x 4, \"f64\"".into(),
            certificate: Certificate { duality_gap: 1e-9, stiffness_error: Some(1e-7), ..Default::default() },
        }
    }

    #[test]
    fn fields_read_back_to_the_same_bits() {
        let s = sample(1.0 / 3.0);
        let fields = s.fields();
        assert_eq!(Sample::from_fields(fields.iter().map(String::as_str)), Some(s));
        assert_eq!(Sample::from_fields(fields.iter().take(15).map(String::as_str)), None);
        let mut bad = fields;
        bad[3] = "NaN".into();
        assert_eq!(Sample::from_fields(bad.iter().map(String::as_str)), None);
    }
}
