//! The certificate of a state: the error of its load, and the resulting error of the force.

use super::prepared::{PreparedSurface, Tangent};
use crate::active_set::{Continuation, Solved};
use crate::geometry::CellSet;
use contact_model::{Certificate, Status, Stop};
use std::f64::consts::PI;

/// Largest factor by which a stiffness may grow within the error of the load; the worst of 900 small states
/// at a tolerance of 1e-3, near complete contact, had an increase of a sixth.
pub(super) const GROWTH: f64 = 1.25;

/// The error of the load of a state, and the resulting error of the force.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoadError {
    /// Relative error of the load.
    pub load: f64,
    /// Relative error of a force that was not prescribed.
    pub force: Option<f64>,
}

impl LoadError {
    /// The errors for a prescribed force with this relative error.
    pub fn of_force(miss: f64) -> Self {
        Self { load: miss.abs(), force: None }
    }
}

impl PreparedSurface {
    /// How a solve ended whose state has this certificate. A solve that was asked to stop has stopped: its
    /// pressures may meet the tolerance while a stiffness that was to follow is unfinished.
    pub(super) fn ended(&self, found: Status, certificate: &Certificate, stop: Stop<'_>) -> Status {
        match found {
            _ if stop.stops() => Status::Stopped,
            Status::Converged if !certificate.meets(self.options.tolerance) => Status::Stagnated,
            other => other,
        }
    }

    /// The error of both stiffnesses.
    pub(super) fn tangent_error(&self, tangent: &Tangent) -> f64 {
        let whole = tangent.whole.as_ref().map_or(0.0, |whole| self.stiffness_error(whole));
        self.stiffness_error(&tangent.stiffness).max(whole)
    }

    /// A bound of the stiffness near a state, nondimensional: that of the state where it is known, otherwise
    /// that of a circle around the contact, which is at least as stiff (free boundaries only).
    pub(super) fn stiffest(&self, solved: &Solved, tangent: Option<&Tangent>) -> f64 {
        if let Some(Tangent { stiffness: t, .. }) = tangent {
            return t.k() * self.magnification(t.k()) * (1.0 + self.stiffness_error(t));
        }
        self.stiffest_on(&solved.contact)
    }

    /// The stiffness of a circle around a set, nondimensional.
    pub(super) fn stiffest_on(&self, set: &CellSet) -> f64 {
        let Some(window) = set.window() else { return 0.0 };
        let (dx, dy) = self.problem.grid().cell();
        (window.width as f64 * dx).hypot(window.height as f64 * dy) / PI
    }

    /// The error of the force from the residual gaps on the contact and from the error of the load, with a
    /// stiffness k.
    ///
    /// The force is that of a surface whose heights differ by at most those gaps, and it increases with every
    /// height.
    pub(super) fn force_error(&self, solved: &Solved, k: f64, miss: f64) -> LoadError {
        let bounds = self.problem.bounds;
        let Continuation { checked, gap, .. } = &solved.continuation;
        let left = (checked.carry(&solved.contact, &solved.p).iter().zip(gap))
            .map(|(&p, &g)| bounds.violation(p, g))
            .fold(0.0, f64::max);
        let force: f64 = solved.p.iter().sum();
        let known = force > 0.0 && k.is_finite();
        LoadError { load: 0.0, force: known.then(|| GROWTH * k * (left + miss) / force) }
    }
}
