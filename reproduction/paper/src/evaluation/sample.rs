//! The sample of a state: one surface under one load.

use contact_model::{Certificate, ContactState, Normalisation, Result};

/// States with fewer contact cells than this are on the one-cell floor of a grid: they are kept and marked,
/// but left out of fits and lines.
pub const FLOOR_CELLS: usize = 10;

/// The numbers of one contact state, normalised as in the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// The requested F_bar (Eq. 10, with the surface's own measured rms height).
    pub force_bar: f64,
    /// F, in E* L^2 (the surface has E* = L = 1).
    pub force: f64,
    /// d/h.
    pub approach_over_h: Option<f64>,
    /// k_bar (Eq. 8).
    pub stiffness_bar: Option<f64>,
    /// Contact area over A0; `None` where the model has no area.
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
    /// The strategy of the solver.
    pub strategy: String,
    /// The certificate.
    pub certificate: Certificate,
}

impl Sample {
    /// The sample of a state.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] when the surface has no rms height to normalise by.
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
}
