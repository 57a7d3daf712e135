//! The loads between which an interface closes and a body yields first, and further solves between them.

use crate::scenes::plan::{RefinedThreshold, Threshold, with_interface};
use crate::scenes::read::{LoadList, Numerics, RequestedInterface, SceneFile};
use crate::scenes::run::StateRecord;
use contact_model::{Normalisation, PreparedContact, Result, Stop};
use interface::bracketed;

/// The last state before a threshold and the first one after it, in the order of the forces. `None` stands for a
/// load smaller or larger than those of the scene.
pub(crate) fn bracket(states: &[StateRecord], of: Threshold) -> [Option<usize>; 2] {
    let mut states: Vec<(usize, f64, bool)> = states
        .iter()
        .filter_map(|record| {
            let state = &record.converged()?.state;
            Some((record.index, state.force, of.is_reached(state)?))
        })
        .collect();
    states.sort_by(|a, b| a.1.total_cmp(&b.1));
    let reached = states.iter().rposition(|state| !state.2).map_or(0, |last| last + 1);
    let before = reached.checked_sub(1).map(|place| states[place].0);
    [before, states.get(reached).map(|state| state.0)]
}

/// A scene whose thresholds are refined on one surface, with one model.
pub(crate) struct Refinement<'a> {
    pub scene: &'a SceneFile,
    pub numerics: &'a Numerics,
    pub loads: &'a LoadList,
    pub normalisation: Normalisation,
    /// The largest distance of both loads, as a share of the larger one.
    pub width: f64,
}

impl Refinement<'_> {
    /// Halves the loads between which a threshold lies until they are close enough. `None` where it does not lie
    /// between two loads of the scene.
    ///
    /// # Errors
    /// Those of the solves; [`contact_model::Error::Stopped`].
    pub fn solve(
        &self,
        of: Threshold,
        states: &[StateRecord],
        contact: &mut dyn PreparedContact,
        stop: Stop<'_>,
    ) -> Result<Option<RefinedThreshold>> {
        let [Some(before), Some(after)] = bracket(states, of) else { return Ok(None) };
        let force = |index: usize| {
            let record = states.iter().find(|record| record.index == index)?;
            Some(record.converged()?.state.force)
        };
        let mut solved: Vec<(f64, f64)> = [before, after]
            .into_iter()
            .filter_map(|index| Some((self.loads.values.get(index).copied()?, force(index)?)))
            .collect();
        let [(before, _), (after, _)] = solved[..] else { return Ok(None) };
        let scene = self.scene_of(of);
        let prescribed = bracketed([before, after], self.width, |value| {
            let load = self.loads.load(value, &self.normalisation)?;
            let state = contact.solve_until(load, stop)?;
            let state = with_interface(&scene, self.numerics, load.normal, state, stop)?;
            solved.push((value, state.force));
            // A body without stress has not yielded.
            Ok(of.is_reached(&state).unwrap_or(false))
        })?;
        let force_at = |value: f64| solved.iter().find(|known| known.0.to_bits() == value.to_bits());
        let [Some(before), Some(after)] = prescribed.map(force_at) else { return Ok(None) };
        Ok(Some(RefinedThreshold { of, prescribed, forces: [before.1, after.1] }))
    }

    /// The scene with nothing but what decides on this threshold.
    fn scene_of(&self, of: Threshold) -> SceneFile {
        let mut scene = self.scene.clone();
        let asked = std::mem::take(&mut scene.requested.interface);
        scene.requested.interface = match of {
            Threshold::ClosesAlongX | Threshold::ClosesAlongY => {
                RequestedInterface { percolation: true, ..RequestedInterface::default() }
            }
            Threshold::Yields => {
                RequestedInterface { stress_below: asked.stress_below, ..RequestedInterface::default() }
            }
        };
        scene.requested.drop_fields_of_stress();
        scene
    }
}
