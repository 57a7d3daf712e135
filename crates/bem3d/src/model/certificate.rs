//! What a state is certified by: how far it is from its load, and what that leaves open of the force.

use super::prepared::{PreparedSurface, Tangent};
use crate::active_set::{Continuation, Solved};
use crate::geometry::CellSet;
use contact_model::{Certificate, Status, Stop};
use std::f64::consts::PI;

/// A stiffness may grow by this factor over what is left open of the load: by a sixth in the worst of 900
/// small states at a tolerance of 1e-3, near complete contact.
pub(super) const GROWTH: f64 = 1.25;

/// How far a state is from its load, and what that leaves open of the force.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoadError {
    /// Relative miss of the load.
    pub load: f64,
    /// Relative error of a force that was not prescribed.
    pub force: Option<f64>,
}

impl LoadError {
    /// Of a prescribed force, with this relative miss.
    pub fn of_force(miss: f64) -> Self {
        Self { load: miss.abs(), force: None }
    }
}

impl PreparedSurface {
    /// How a solve ended whose state has this certificate.
    pub(super) fn ended(&self, found: Status, certificate: &Certificate, stop: Stop<'_>) -> Status {
        match found {
            Status::Converged if certificate.meets(self.options.tolerance) => Status::Converged,
            Status::Converged if stop.stops() => Status::Stopped,
            Status::Converged => Status::Stagnated,
            other => other,
        }
    }

    /// The error of both stiffnesses.
    pub(super) fn tangent_error(&self, tangent: &Tangent) -> f64 {
        let whole = tangent.whole.as_ref().map_or(0.0, |whole| self.stiffness_error(whole));
        self.stiffness_error(&tangent.stiffness).max(whole)
    }

    /// A bound of the stiffness near a state, nondimensional: that of the state where it is known, else that
    /// of a circle around the contact, which has no smaller one (free boundaries only).
    pub(super) fn stiffest(&self, solved: &Solved, tangent: Option<&Tangent>) -> f64 {
        if let Some(Tangent { stiffness: t, .. }) = tangent {
            return t.value * self.magnification(t.value) * (1.0 + self.stiffness_error(t));
        }
        self.stiffest_on(&solved.contact)
    }

    /// The stiffness of a circle around a set, nondimensional.
    pub(super) fn stiffest_on(&self, set: &CellSet) -> f64 {
        let Some(window) = set.window() else { return 0.0 };
        let (dx, dy) = self.problem.grid().cell();
        (window.width as f64 * dx).hypot(window.height as f64 * dy) / PI
    }

    /// What a stiffness k makes of the gaps left on the contact and of a miss of the load, as an error of the
    /// force.
    ///
    /// The force is that of a surface whose heights differ by no more than those gaps, and it grows with
    /// every height.
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
