//! The memory of a path or of single loads, which determines the next state: the last state, and the memory of
//! effects.
//!
//! The plans of transforms and the buffers of a load are dropped before the next one
//! ([`PreparedSurface::forget_plans`]), because the window for which a plan was made affects the rounding of
//! displacements. Everything else that a contact keeps from load to load follows from the surface alone. A
//! contact that is restored from a memory therefore continues to the same bits as one that was never
//! interrupted.

use super::adhesive::{AdhesivePath, Last};
use super::load::{LoadSequence, ScaledLoad};
use super::memory::Indented;
use super::prepared::PreparedSurface;
use super::viscous::{HistoryMemory, ViscousHistory};
use crate::active_set::{Candidates, LastState};
use crate::friction::SlipMemory;
use crate::geometry::{CellSet, Grid};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// All that a contact remembers of its loads.
#[derive(Serialize, Deserialize)]
pub(super) struct Remembered<'a> {
    pub place: PlaceInLoads,
    /// The start of the solve of the next load.
    last: Option<Cow<'a, LastState>>,
    hardness: Option<Indented>,
    friction: Option<Slipped<'a>>,
    /// The end of the last step, of contacts with adhesion.
    pub adhesive: Option<Cow<'a, Last>>,
    /// The history of a viscoelastic body.
    viscous: Option<Cow<'a, HistoryMemory>>,
}

/// Where a contact is in its loads.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct PlaceInLoads {
    pub loads: LoadSequence,
    /// The single load that was solved last, from which a path goes on.
    pub solved: Option<ScaledLoad>,
    /// Time of the last step of a path.
    pub time: f64,
}

/// The memory of friction.
#[derive(Serialize, Deserialize)]
struct Slipped<'a> {
    memory: Cow<'a, SlipMemory>,
    dissipated: f64,
}

impl<'a> Remembered<'a> {
    /// The memory of a surface at a place in its loads, and of its adhesion.
    pub fn of(
        place: PlaceInLoads,
        surface: &'a PreparedSurface,
        adhesive: Option<&'a Last>,
        viscous: Option<&'a ViscousHistory>,
    ) -> Self {
        let grid = surface.problem.grid();
        Self {
            place,
            last: surface.last.as_ref().map(Cow::Borrowed),
            hardness: surface.memory.as_ref().map(|memory| Indented::of(grid, memory)),
            friction: surface.sliding.as_ref().map(|sliding| Slipped {
                memory: Cow::Borrowed(&sliding.before),
                dissipated: sliding.dissipated,
            }),
            adhesive: adhesive.map(Cow::Borrowed),
            viscous: viscous.map(|history| Cow::Borrowed(history.memory())),
        }
    }

    /// Restores a surface without any state to this memory. `false`, and nothing is changed, for a memory that does
    /// not belong to this surface and its effects.
    pub fn recall(
        self,
        surface: &mut PreparedSurface,
        adhesion: &mut Option<AdhesivePath>,
        history: &mut Option<ViscousHistory>,
    ) -> bool {
        let grid = surface.problem.grid();
        let Self { place, last, hardness, friction, adhesive, viscous } = self;
        let viscous_fits = match (history.as_ref(), &viscous) {
            (Some(history), Some(memory)) => history.fits(memory, grid),
            (None, None) => true,
            _ => false,
        };
        let fits = place.time.is_finite()
            && last.as_ref().is_none_or(|last| last.fits(grid))
            && adhesive.as_ref().is_none_or(|last| last.fits(grid))
            && hardness.as_ref().is_none_or(|indented| indented.fits(grid))
            && friction.as_ref().is_none_or(|slipped| slipped.fits(grid))
            && hardness.is_some() == surface.memory.is_some()
            && friction.is_some() == surface.sliding.is_some()
            && (adhesive.is_none() || adhesion.is_some())
            && viscous_fits;
        if !fits {
            return false;
        }
        if let (Some(indented), Some(memory)) = (hardness, &mut surface.memory) {
            indented.restore(grid, memory);
            surface.problem.candidates = Candidates::new(grid, memory.indented());
        }
        if let (Some(slipped), Some(sliding)) = (friction, &mut surface.sliding) {
            (sliding.before, sliding.dissipated) = (slipped.memory.into_owned(), slipped.dissipated);
        }
        surface.last = last.map(Cow::into_owned);
        if let Some(path) = adhesion {
            path.last = adhesive.map(Cow::into_owned);
        }
        if let (Some(memory), Some(history)) = (viscous, history) {
            history.recall(memory.into_owned());
        }
        true
    }
}

impl Slipped<'_> {
    fn fits(&self, grid: Grid) -> bool {
        let SlipMemory { cells, traction, displacement, offset, slip, moved, pressure } = &*self.memory;
        cells.is_on(grid)
            && are_of(cells, 2, &[traction, offset, slip, moved])
            && are_of(cells, 1, &[pressure])
            && displacement.iter().all(|d| d.is_finite())
            && self.dissipated.is_finite()
    }
}

impl LastState {
    pub(super) fn fits(&self, grid: Grid) -> bool {
        let Self { contact, p, d, force, tangent } = self;
        contact.is_on(grid)
            && are_of(contact, 1, &[p])
            && tangent.as_ref().is_none_or(|(q, k)| k.is_finite() && are_of(contact, 1, &[q]))
            && d.is_finite()
            && force.is_finite()
    }
}

impl Last {
    pub(super) fn fits(&self, grid: Grid) -> bool {
        let of = &self.equilibrium;
        of.cells.is_on(grid)
            && are_of(&of.cells, 1, &[&of.pressure, &of.attraction, &of.gap])
            && of.d.is_finite()
    }
}

/// Whether vectors have this number of finite values for each cell.
fn are_of(cells: &CellSet, each: usize, vectors: &[&Vec<f64>]) -> bool {
    vectors.iter().all(|v| v.len() == each * cells.len() && v.iter().all(|value| value.is_finite()))
}
