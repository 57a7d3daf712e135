//! The thresholds of a scene: the loads at which the interface closes and a body yields first.

use crate::scenes::read::{LoadRequest, SceneFile};
use contact_model::ContactState;
use serde::{Deserialize, Serialize};

/// Something that happens at some load, and goes on under larger ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Threshold {
    ClosesAlongX,
    ClosesAlongY,
    Yields,
}

impl Threshold {
    pub(crate) const ALL: [Self; 3] = [Self::ClosesAlongX, Self::ClosesAlongY, Self::Yields];

    /// Its name in the file.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ClosesAlongX => "closes_along_x",
            Self::ClosesAlongY => "closes_along_y",
            Self::Yields => "yields",
        }
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::ClosesAlongX => "the gap closes along x",
            Self::ClosesAlongY => "the gap closes along y",
            Self::Yields => "the body yields first",
        }
    }

    pub(crate) fn is_requested(self, scene: &SceneFile) -> bool {
        let interface = &scene.requested.interface;
        match self {
            Self::ClosesAlongX | Self::ClosesAlongY => interface.percolation,
            Self::Yields => interface.stress_below.as_ref().is_some_and(|of| of.yield_stress.is_some()),
        }
    }

    /// Whether it has happened in a state.
    pub(crate) fn is_reached(self, state: &ContactState) -> Option<bool> {
        let closed = |axis: usize| state.interface.percolation.map(|paths| !paths[axis].open);
        match self {
            Self::ClosesAlongX => closed(0),
            Self::ClosesAlongY => closed(1),
            Self::Yields => {
                state.interface.stress.and_then(|s| s.factor_until_yield).map(|factor| factor <= 1.0)
            }
        }
    }
}

/// The thresholds that a scene asks for: it has single loads and asks for what depends on them.
pub(crate) fn thresholds_of(scene: &SceneFile) -> Vec<Threshold> {
    let has_loads = matches!(scene.request, LoadRequest::Loads(_));
    Threshold::ALL.into_iter().filter(|of| has_loads && of.is_requested(scene)).collect()
}

/// Loads between which a threshold lies, closer together than those of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct RefinedThreshold {
    pub of: Threshold,
    /// The prescribed values before it and after it.
    pub prescribed: [f64; 2],
    /// The normal forces of both.
    pub forces: [f64; 2],
}

/// Solves at most that bring the loads of all thresholds as close together as the scene asks for.
pub(crate) fn refining_solves(scene: &SceneFile) -> f64 {
    let halvings = scene.requested.thresholds.map_or(0.0, |width| (1.0 / width).log2().ceil());
    halvings * thresholds_of(scene).len() as f64
}
