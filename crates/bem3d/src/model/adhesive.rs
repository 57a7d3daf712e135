//! Contacts with adhesion of finite range: a path of loads on one surface.

use super::certificate::GROWTH;
use super::load::{LoadSequence, ScaledLoad, ScaledNormal, ScaledTangential};
use super::memory::IndentationMemory;
use super::options::NAME;
use super::prepared::PreparedSurface;
use super::sliding::Slid;
use super::state::{NormalSolution, returned};
use crate::active_set::Bounds;
use crate::adhesion::{AdhesiveControl, Attraction, AttractionLaw, Ended, Equilibrium, Search, energy};
use crate::friction::PressedCells;
use crate::geometry::CellSet;
use crate::kernel::Evidence;
use crate::kernel::love::influence_of_rectangle;
use crate::response::adhesive::{Response, ResponseRequest, respond};
use contact_model::units::{number, rounded};
use contact_model::{
    Adhesion, AdhesiveState, Branch, Certificate, ContactState, Error, Interrupted, Result, Status, Stop,
};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Name of the quantity of [`Error::OutOfRange`] where cells are too large for the range of an attraction.
pub const UNRESOLVED_RANGE: &str = "side of a cell (the cohesive zone needs five of them)";

/// Largest product of the slope of the law and the own compliance of a cell. At 1 a single open cell would be
/// unstable by itself on any surface; at a fifth of it the cohesive zone, about `E* range^2/work` long, is
/// five cells long.
const RESOLVED: f64 = 0.2;
/// Admissible ranges over the height of the surface: smaller ranges are lost in the rounding of the gaps, and
/// relative to larger ones the surface is.
const RANGES: std::ops::RangeInclusive<f64> = 1e-9..=1e9;
/// A gap that has moved against the load by more than this, in ranges, has left the branch.
const ON_BRANCH: f64 = 1e-3;

/// The attraction of a surface, and where it is on its path.
#[derive(Debug)]
pub(super) struct AdhesivePath {
    pub(super) attraction: Attraction,
    pub(super) last: Option<Last>,
    /// Whether gaps move while the load rests, as those of a body with a history do.
    relaxes: bool,
}

/// A surface with its attraction.
pub(super) struct AdhesiveContact<'a> {
    pub(super) surface: &'a mut PreparedSurface,
    pub(super) attraction: &'a Attraction,
    last: &'a mut Option<Last>,
    relaxes: bool,
}

/// The end of the last step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Last {
    pub(super) equilibrium: Equilibrium,
    control: AdhesiveControl,
    branch: Branch,
    state: ContactState,
}

/// A state that was reached, with the slip and the new indentation that it leaves.
struct Reached {
    last: Last,
    slid: Option<Slid>,
    saturated: CellSet,
    depth: Vec<f64>,
}

/// An equilibrium that was found at a load.
pub(super) struct EquilibriumFound {
    pub equilibrium: Equilibrium,
    response: Response,
    control: AdhesiveControl,
    pub status: Status,
    load_error: f64,
}

impl AdhesivePath {
    /// The attraction of a surface before any load; `None` where there is none.
    ///
    /// # Errors
    /// As [`attraction`].
    pub(super) fn of(surface: &mut PreparedSurface, adhesion: Adhesion) -> Result<Option<Self>> {
        let Some(attraction) = attraction(surface, adhesion)? else { return Ok(None) };
        surface.problem.bounds = bounds(surface.hardness, Some(&attraction));
        if let (true, Some(sliding)) = (attraction.has_shares(), &mut surface.sliding) {
            sliding.act_on_shares();
        }
        Ok(Some(Self { attraction, last: None, relaxes: false }))
    }

    /// A step of a history under this attraction, from the end of the one before.
    pub(super) fn of_step(attraction: Attraction, last: Option<Last>) -> Self {
        Self { attraction, last, relaxes: true }
    }

    /// The contact of its surface.
    pub(super) fn on<'a>(&'a mut self, surface: &'a mut PreparedSurface) -> AdhesiveContact<'a> {
        let Self { attraction, last, relaxes } = self;
        AdhesiveContact { surface, attraction, last, relaxes: *relaxes }
    }
}

impl Last {
    /// The same state of a body with another modulus.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { equilibrium: self.equilibrium.scaled(factor), ..self.clone() }
    }

    /// The error of a load that pulls the bodies off each other, with this state as the last stable one.
    pub(super) fn pulled_off(&self, strategy: String) -> Error {
        let mut best = self.state.clone();
        best.report.status = Status::PulledOff;
        best.report.strategy = strategy;
        Error::NotConverged { best: Box::new(best) }
    }
}

impl AdhesiveContact<'_> {
    /// The state of a load: on a path, from the last state; otherwise on the branch of approach from no
    /// contact.
    pub(super) fn at(
        &mut self,
        load: ScaledLoad,
        loads: LoadSequence,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let ScaledLoad { normal, tangential } = load;
        let control = match normal {
            ScaledNormal::Force(force) => AdhesiveControl::Force(force),
            ScaledNormal::Approach(d) => AdhesiveControl::Plane(d),
            ScaledNormal::MeanGap(gap) => AdhesiveControl::Plane(self.surface.mean - gap),
        };
        if loads == LoadSequence::Single && !self.continues(control) {
            *self.last = None;
        }
        let next = self.next(control, tangential, loads, stop)?;
        let state = next.last.state.clone();
        self.accept(next);
        Ok(state)
    }

    /// Whether a single load may begin from the last state: one on the branch of approach, under a load of
    /// the same kind that is no larger.
    ///
    /// From there the attraction rises to the same equilibrium as from no contact, which is the nearest one
    /// above both. At a prescribed mean gap more attraction in one place opens gaps in others, so that no
    /// state lies above another, and each load begins anew.
    fn continues(&self, control: AdhesiveControl) -> bool {
        let Some(last) = self.last.as_ref().filter(|last| last.branch == Branch::Approach) else {
            return false;
        };
        match (last.control, control) {
            (AdhesiveControl::Force(before), AdhesiveControl::Force(now)) => before <= now,
            (AdhesiveControl::Plane(before), AdhesiveControl::Plane(now)) => {
                before <= now && !self.surface.is_periodic()
            }
            _ => false,
        }
    }

    /// Takes a state as the last one.
    fn accept(&mut self, Reached { last, saturated, depth, slid }: Reached) {
        self.surface.keep(last.equilibrium.force(), (&saturated, &depth), slid);
        *self.last = Some(last);
    }

    /// The next state from the last one.
    fn next(
        &mut self,
        control: AdhesiveControl,
        tangential: ScaledTangential,
        loads: LoadSequence,
        stop: Stop<'_>,
    ) -> Result<Reached> {
        match control {
            AdhesiveControl::Force(f) if f < 0.0 && self.untouched() => {
                // The segment begins without force: there the surfaces already hold each other. The tangential
                // load comes with the whole of it.
                let (before, memory) = (self.last.take(), self.surface.memory.clone());
                if memory.is_none() && self.surface.hardness.is_some() {
                    // What flows without a force stays under the pull, also of a single load.
                    self.surface.memory =
                        Some(IndentationMemory::new(self.surface.problem.candidates.shared()));
                }
                let touched = self.step_to(AdhesiveControl::Force(0.0), None, LoadSequence::Path, stop);
                let held = touched.and_then(|touched| {
                    self.accept(touched);
                    self.step_to(control, Some(tangential), LoadSequence::Path, stop)
                });
                if held.is_err() || memory.is_none() {
                    self.surface.take_memory(memory);
                }
                *self.last = before;
                held
            }
            control => self.step_to(control, Some(tangential), loads, stop),
        }
    }

    fn untouched(&self) -> bool {
        self.last.as_ref().is_none_or(|last| last.equilibrium.contact().is_empty())
    }

    /// `tangential`: `None` where the step is a part of a segment whose tangential load comes later.
    fn step_to(
        &mut self,
        control: AdhesiveControl,
        tangential: Option<ScaledTangential>,
        loads: LoadSequence,
        stop: Stop<'_>,
    ) -> Result<Reached> {
        self.surface.begin_count();
        let last = self.last.as_ref().map(|last| last.equilibrium.clone());
        let found = self.search(control, last.as_ref().map(|last| (last, loads)), self.tolerance(), stop)?;
        self.finish(found, tangential, stop)
    }

    /// The tolerance of a stiffness with attraction that follows the gaps, where one is requested.
    fn tolerance(&self) -> Option<f64> {
        let wanted = self.surface.outputs.stiffness && !self.attraction.moves_by_cells();
        wanted.then_some(self.surface.options.tolerance)
    }

    fn shift(&self) -> f64 {
        self.surface.problem.operators.table().shift()
    }

    /// Whether a load is above that of a state.
    fn rises(&self, control: AdhesiveControl, last: &Equilibrium) -> bool {
        match control {
            AdhesiveControl::Force(f) => f > last.force(),
            AdhesiveControl::Plane(plane) => plane > last.plane(self.shift()),
        }
    }

    /// The equilibrium of a load, from the last one.
    pub(super) fn search(
        &mut self,
        control: AdhesiveControl,
        before: Option<(&Equilibrium, LoadSequence)>,
        tolerance: Option<f64>,
        stop: Stop<'_>,
    ) -> Result<EquilibriumFound> {
        let last = before.map(|(last, _)| last);
        let rises = last.is_none_or(|last| self.rises(control, last));
        // Under a hardness there is one kind of update.
        let mut plain = self.surface.hardness.is_some();
        let mut spent = (0, 0);
        loop {
            let (limits, attraction) = (self.surface.limits(), self.attraction);
            let mut search =
                Search { problem: &mut self.surface.problem, attraction, control, limits, plain };
            let start = match before {
                Some((last, LoadSequence::Path)) => last.again(),
                Some((last, LoadSequence::Single)) => {
                    search.continued(last, stop).map_err(Interrupted::without_state)?
                }
                None => search.first(stop).map_err(Interrupted::without_state)?,
            };
            let ended = search.from(start, stop).map_err(|ended| *ended);
            if let Err((Ended::Interrupted, _)) = &ended {
                return Err(Interrupted.without_state());
            }
            let search_error = match &ended {
                Ok(equilibrium) | Err((_, equilibrium)) => search.load_error(equilibrium),
            };
            let again = !plain && !stop.stops();
            let (mut equilibrium, status) = match ended {
                Ok(equilibrium) => (equilibrium, Status::Converged),
                Err((Ended::PulledOff, equilibrium)) if again => {
                    spent = (spent.0 + equilibrium.steps, spent.1 + equilibrium.updates);
                    plain = true;
                    continue;
                }
                Err((Ended::PulledOff | Ended::Interrupted, _)) => return Err(self.pulled_off(control)?),
                Err((Ended::Status(status), equilibrium)) => (equilibrium, status),
            };
            let left = !self.relaxes && last.is_some_and(|last| self.left_branch(last, &equilibrium, rises));
            let mut response = Response::default();
            let sound = status == Status::Converged && !left;
            if sound || !again {
                let request = ResponseRequest { control, tolerance, stop };
                // A stopped search has no stability: nothing that is unstable was found.
                response = respond(&mut self.surface.problem, attraction, &equilibrium, request)
                    .unwrap_or_else(|Interrupted| Response { stability: 1.0, ..Response::default() });
            }
            if again && !(sound && response.stability > 0.0) {
                spent = (spent.0 + equilibrium.steps, spent.1 + equilibrium.updates);
                plain = true;
                continue;
            }
            equilibrium.steps += spent.0;
            equilibrium.updates += spent.1;
            let stable = response.stability > 0.0;
            let status = if status == Status::Converged && !stable { Status::Stagnated } else { status };
            let load_error = search_error;
            return Ok(EquilibriumFound { equilibrium, response, control, status, load_error });
        }
    }

    /// Whether a gap has moved against the load, which means that a step has gone beyond an equilibrium.
    fn left_branch(&self, last: &Equilibrium, now: &Equilibrium, rises: bool) -> bool {
        let before = now.cells.carry(&last.cells, &last.attraction);
        let known = now.cells.carry(&last.cells, &vec![1.0; last.cells.len()]);
        now.attraction.iter().zip(&before).zip(&known).any(|((now, before), known)| {
            let change = if rises { before - now } else { now - before };
            *known > 0.0 && change > ON_BRANCH * self.attraction.law.peak
        })
    }

    /// The error for a force beyond pull-off, with the last stable state.
    fn pulled_off(&self, control: AdhesiveControl) -> Result<Error> {
        let force = if let AdhesiveControl::Force(f) = control { f } else { 0.0 };
        let value = self.surface.nondimensional.force(PI * force.abs())?.copysign(force);
        Ok(match &*self.last {
            Some(last) => {
                let before = number(rounded(value, 6));
                last.pulled_off(format!("pull-off before the force {before}; the last stable state"))
            }
            None => Error::OutOfRange { name: "force".into(), value, min: 0.0, max: f64::INFINITY },
        })
    }

    /// The state that is returned.
    fn finish(
        &mut self,
        found: EquilibriumFound,
        tangential: Option<ScaledTangential>,
        stop: Stop<'_>,
    ) -> Result<Reached> {
        let EquilibriumFound { equilibrium, response, control, status, load_error } = found;
        let branch = match &*self.last {
            Some(last) if self.same_load(control, &last.equilibrium) => last.branch,
            Some(last) if !self.rises(control, &last.equilibrium) => Branch::Withdrawal,
            _ => Branch::Approach,
        };
        let (saturated, depth) = equilibrium.indented(self.surface.problem.bounds);
        let stiffness = self.stiffness(&equilibrium, &response, branch, stop);
        let force_error = self.force_error(control, &equilibrium, &response);
        let contact = equilibrium.contact();
        let slid =
            tangential.map(|load| self.slide(&equilibrium, &contact, load, stop)).transpose()?.flatten();
        let units = self.surface.nondimensional;
        let stored = PI * energy(&self.surface.problem, self.attraction, &equilibrium);
        // A force times a length.
        let stored = stored.signum() * units.approach(units.force(stored.abs())?)?;
        let stored = (!self.relaxes).then_some(stored);
        let residuals = equilibrium.residuals;
        let net = equilibrium.net();
        let normal = NormalSolution {
            status,
            strategy: format!(
                "attraction on {} cells, {} updates",
                equilibrium.cells.len(),
                equilibrium.updates
            ),
            iterations: equilibrium.steps + response.steps + stiffness.steps,
            certificate: Certificate {
                duality_gap: residuals.duality_gap,
                penetration: residuals.penetration,
                complementarity: residuals.complementarity,
                load_error,
                stiffness_error: stiffness.solve_error,
                quotient_error: stiffness.quotient_error,
                equilibrium: Some(equilibrium.mismatch),
                force_error,
                ..Certificate::default()
            },
            force: equilibrium.force(),
            d: equilibrium.d,
            complete: self.surface.is_full(&contact) && saturated.is_empty(),
            contact: &contact,
            pressure: (&equilibrium.cells, &net),
            indented: (&saturated, &depth),
            yielded: saturated.len(),
            area: self.attraction.area(&contact, &equilibrium.gap),
            stiffness: stiffness.along_the_branch.map(|k| PI * k),
            fixed_area: stiffness.fixed_area.map(|k| PI * k),
            adhesive: Some(AdhesiveState::new(branch, stored, response.stability)),
            resolution: Some(self.surface.resolution_of(&contact, &net)?),
        };
        let (state, slid) = self.surface.assess(normal, slid, stop)?;
        let last = Last { equilibrium, control, branch, state: returned(state)? };
        Ok(Reached { last, slid, saturated, depth })
    }

    /// The increment of friction under a state: its law limits the tractions by the contact pressure, which is larger
    /// than the net pressure by the attraction; with a short range by the attached share of each cell. `None` without
    /// friction.
    fn slide(
        &mut self,
        state: &Equilibrium,
        contact: &CellSet,
        load: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<Option<Slid>> {
        if self.surface.sliding.is_none() {
            return Ok(None);
        }
        let (cells, acting) = self
            .attraction
            .attached(&state.cells, &state.gap)
            .unwrap_or_else(|| (contact.clone(), contact.carry(&state.cells, &state.pressure)));
        if cells.is_empty() {
            return self.surface.slide_apart(load);
        }
        self.surface.slide(PressedCells { cells: &cells, pressure: &acting }, load, stop)
    }

    /// The error of a force that was not prescribed, relative to it, estimated: it is the sum of the residual
    /// tractions and of the residual gaps times the largest stiffness of a contact of this extent, and is
    /// larger where the state is less stable. `None` without a force, and for a state that is not stable.
    fn force_error(&self, control: AdhesiveControl, state: &Equilibrium, response: &Response) -> Option<f64> {
        let (AdhesiveControl::Plane(_), force) = (control, state.force().abs()) else { return None };
        let lack = self.attraction.imbalance(&state.cells, &state.attraction, &state.gap);
        let left = state.largest_gap_left(self.surface.problem.bounds);
        let stiffest = self.surface.stiffest_on(&state.cells);
        let error = GROWTH * (lack + stiffest * left) / response.stability;
        (force > 0.0 && response.stability > 0.0).then(|| error / force)
    }

    fn same_load(&self, control: AdhesiveControl, last: &Equilibrium) -> bool {
        let (a, b) = match control {
            AdhesiveControl::Force(f) => (f, last.force()),
            AdhesiveControl::Plane(plane) => (plane, last.plane(self.shift())),
        };
        let larger = a.abs().max(b.abs());
        let scale = match control {
            AdhesiveControl::Force(_) => last.force_scale(larger),
            AdhesiveControl::Plane(_) => larger,
        };
        (a - b).abs() <= self.surface.options.tolerance * scale
    }
}

/// The bounds of the contact pressure of each cell.
///
/// The solid bears the net pressure: a cell in contact, which is attracted by the peak of the law, touches with as
/// much more. Where it flows its gap is zero or less, so that this is the bound of each cell.
pub(super) fn bounds(hardness: Option<f64>, attraction: Option<&Attraction>) -> Bounds {
    let peak = attraction.map_or(0.0, |attraction| attraction.law.peak);
    hardness.map_or(Bounds::Unlimited, |hardness| Bounds::UpTo(hardness + peak))
}

/// The attraction in the units of the surface, where there is any: tractions over pi E* times the height over
/// the side of a cell, so that `u = sum I p`.
///
/// # Errors
/// Cells that do not resolve the range; numbers that overflow.
fn attraction(surface: &PreparedSurface, adhesion: Adhesion) -> Result<Option<Attraction>> {
    let units = surface.nondimensional;
    let unit = PI * units.pressure(1.0)?;
    let (dx, dy) = surface.cell();
    let (name, value, attraction) = match adhesion {
        Adhesion::Off => return Ok(None),
        // Without work the states without adhesion, bit by bit.
        Adhesion::ShortRange { work } | Adhesion::FiniteRange { work, .. } if work <= 0.0 => return Ok(None),
        Adhesion::FiniteRange { work, range, law } => {
            let law = AttractionLaw {
                peak: work / range / unit,
                range: units.approach_in(range),
                shape: law.into(),
            };
            ("range of adhesion", range, Attraction::of(law))
        }
        Adhesion::ShortRange { work } => {
            let table = surface.problem.operators.table();
            let work_in = units.approach_in(work / unit);
            ("work of adhesion", work, Attraction::short(work_in, surface.problem.grid(), table.boundary()))
        }
        other => return Err(Error::unsupported(NAME, format!("the adhesion {other:?}"))),
    };
    if surface.problem.operators.table().kernel().inverse_m_matrix() == Evidence::Violated {
        let what = "adhesion of a body whose contacts need not shrink when they are unloaded: its branches are not ordered";
        return Err(Error::unsupported(NAME, what));
    }
    let law = attraction.law;
    let own = law.peak / law.range * influence_of_rectangle(0, 0, surface.problem.grid().stretch);
    if !(own.is_finite() && own > 0.0) {
        return Err(Error::domain(name, value, "a value nearer to the scales of the surface"));
    }
    if !RANGES.contains(&law.range) {
        // The range of a short one grows with the root of the work.
        let power = if matches!(adhesion, Adhesion::ShortRange { .. }) { 2 } else { 1 };
        let bound = |range: f64| value * (range / law.range).powi(power);
        let (least, most) = (bound(*RANGES.start()), bound(*RANGES.end()));
        let name = format!("{name} (by the heights of the surface)").into();
        return Err(Error::OutOfRange { name, value, min: least, max: most });
    }
    if own > RESOLVED && matches!(adhesion, Adhesion::FiniteRange { .. }) {
        let value = dx.max(dy);
        let max = value * RESOLVED / own;
        return Err(Error::OutOfRange { name: UNRESOLVED_RANGE.into(), value, min: 0.0, max });
    }
    Ok(Some(attraction))
}
