//! Viscoelastic bodies: a history in steps of time, each of which is one elastic contact.
//!
//! At each cell stands the pressure P with which an elastic body of the modulus E* would be displaced as the
//! viscoelastic one is: `u = K P/E*`. The true pressure follows from the history of P in the same cell,
//! `p = int E*(t - t')/E* dP(t')`, and needs no other cell. In a step of time P goes straight from one value to the
//! next, so that `p = M (P - H)`: M is a modulus of the step, and H a pressure that the history leaves. The contact
//! at the end of the step is therefore that of an elastic body of the modulus `M E*` with the heights displaced by
//! `K H/E*`, and any elastic solver finds it. Each arm of the relaxation remembers one number a cell, and no
//! integral goes over the past.
//!
//! Tangential tractions have the same history, component by component, where they displace nothing normally.
//!
//! The error of the steps is measured by a second history with steps twice as long.

mod step_law;
mod track;

use self::step_law::StepLaw;
use self::track::{TrackEnd, ViscousTrack};
use super::adhesive::{AdhesivePath, Last, bounds};
use super::load::{LoadSequence, ScaledLoad, ScaledNormal};
use super::memory::{IndentationMemory, Indented};
use super::options::NAME;
use super::prepared::PreparedSurface;
use super::sliding::over;
use crate::active_set::{Candidates, LastState};
use crate::adhesion::Attraction;
use crate::friction::TangentialControl;
use crate::geometry::{CellSet, Grid};
use crate::law::length;
use crate::real::{sum_of_pairs, update};
use contact_model::{
    Conductance, ContactState, Coupling, Error, FrictionLaw, Interrupted, Nondimensionalisation, Outputs,
    RelaxationSpectrum, Result, Rheology, Scene, Status, Stop, ViscoelasticState,
};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::sync::Arc;

/// A step of time is cut to no less than this share of the piece of the path in which it lies.
const SHORTEST_STEP: f64 = 1e-14;
/// A pull that comes off the surface in a step of this share of the piece of the path comes off.
const SHORTEST_PULL: f64 = 1e-4;
/// A step that is cut has no effect where the error of the shorter one is more than this multiple of its own. Once
/// [`USELESS_CUTS`] in a row have none, the step is as accurate as the solver is.
const NOISE: f64 = 0.7;
/// A step much longer than the times of the material may have a smaller error than a shorter one by accident.
const USELESS_CUTS: usize = 3;
/// The next step is this much shorter than the one whose error would be what is allowed.
const CAUTION: f64 = 0.8;
/// The next step over the last one, at least and at most.
const STEP_CHANGE: (f64, f64) = (0.2, 4.0);
/// The error of a step falls with its length to this power at least, until cells come into contact.
const STEP_ORDER: f64 = 2.0;

/// The part of a history on which the next step depends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct HistoryMemory {
    /// In steps half as long as those of `coarse`.
    fine: ViscousTrack,
    /// Absent as long as both are the same.
    coarse: Option<ViscousTrack>,
    /// Length of the next step, where one is known.
    step: Option<f64>,
    /// The largest response so far: force, and approach.
    largest: LoadResponse,
    /// Work of the load along the fine track, in the units of the modulus E* (over pi).
    work: f64,
}

impl HistoryMemory {
    /// That of a track before any load.
    fn new(fine: ViscousTrack) -> Self {
        Self { fine, coarse: None, step: None, largest: LoadResponse::default(), work: 0.0 }
    }
}

/// The response to a load, in the units of a surface with the modulus E*.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct LoadResponse {
    force: f64,
    /// The force with which an elastic body would be displaced as much. A step that is much longer than the times of
    /// the material can have the right force by accident, but then not this one.
    elastic_force: f64,
    /// The approach; of a periodic surface by how much the mean gap has fallen from that of the first touch.
    approach: f64,
    tangential_force: [f64; 2],
    tangential_displacement: [f64; 2],
}

/// A viscoelastic surface, and where it is in its history.
#[derive(Debug)]
pub(super) struct ViscousHistory {
    spectrum: RelaxationSpectrum,
    /// The units of the surface with the modulus E*.
    elastic: Nondimensionalisation,
    /// Undeformed gaps of the surface, and their mean.
    virgin: (Arc<Vec<f64>>, f64),
    /// The hardness, in the units of the modulus E*.
    hardness: Option<f64>,
    /// The law of friction, in the units of the modulus E*.
    friction: Option<FrictionLaw>,
    /// The attraction, in the units of the modulus E*.
    attraction: Option<Attraction>,
    /// Whether a mean gap takes the place of the approach.
    periodic: bool,
    /// Largest error that one step of time adds, relative.
    tolerance: f64,
    /// The law of a step; another one in comparisons with other programs.
    law: fn(&RelaxationSpectrum, f64) -> StepLaw,
    memory: HistoryMemory,
}

/// A step of time of one track.
#[derive(Clone, Copy)]
struct TimeStep<'a> {
    duration: f64,
    /// The load at its end.
    load: ScaledLoad,
    /// A contact near that at its end, with true pressures; without one that of its beginning.
    guess: Option<&'a LastState>,
}

/// A step of time, whole in one history and in halves in the other.
#[derive(Clone, Copy)]
struct StepPair {
    duration: f64,
    middle: ScaledLoad,
    end: ScaledLoad,
    /// The outputs of the state at its end, where it is one that was asked for.
    shown: Option<Outputs>,
}

/// The histories after it.
struct StepResult {
    state: ContactState,
    /// After the first half.
    first: ViscousTrack,
    fine: ViscousTrack,
    coarse: ViscousTrack,
}

/// Whether nothing holds the load of a step.
fn is_pull_off<T>(found: &Result<T>) -> bool {
    matches!(found, Err(Error::NotConverged { best }) if best.report.status == Status::PulledOff)
}

/// Refuses what a viscoelastic contact does not have.
///
/// # Errors
/// [`Error::Unsupported`] for a stiffness, a conductance, bodies of two materials, a layer on another material and
/// friction that displaces normally too.
pub(super) fn check_rheology(scene: &Scene) -> Result<()> {
    let rheology = &scene.effects.rheology;
    if *rheology == Rheology::Elastic {
        return Ok(());
    }
    let refused = |what: &'static str| Err(Error::unsupported(NAME, what));
    let outputs = scene.outputs;
    let Outputs { stiffness, stiffness_fixed_area, conductance, .. } = outputs;
    if stiffness || stiffness_fixed_area || outputs.tangential_stiffness || outputs.tangential_stiffness_stuck
    {
        return refused("the stiffness of a viscoelastic body (it depends on how fast one pushes)");
    }
    if conductance != Conductance::Off {
        return refused("the conductance of a viscoelastic body: it follows from a stiffness");
    }
    if let Some(contact_model::Layer { base: contact_model::LayerBase::HalfSpace { .. }, .. }) =
        scene.effects.layer
    {
        return refused(
            "a viscoelastic layer on a half-space, which would have to relax as the layer does (a rigid base need not)",
        );
    }
    if scene.coupling(NAME)? == Some(Coupling::Full) {
        return refused("full coupling of normal and tangential displacements of viscoelastic bodies");
    }
    scene.pair.as_ref().map_or(Ok(()), |pair| rheology.check_pair(pair, NAME))
}

impl ViscousHistory {
    /// The history of a surface before any load; `None` for an elastic one.
    ///
    /// # Errors
    /// As [`Rheology::spectrum`].
    pub(super) fn of(
        surface: &PreparedSurface,
        adhesion: Option<&AdhesivePath>,
        scene: &Scene,
    ) -> Result<Option<Self>> {
        let Some(spectrum) = scene.effects.rheology.spectrum(scene.contact_modulus)? else { return Ok(None) };
        let options = surface.options;
        let fine = ViscousTrack::new(surface, &spectrum);
        Ok(Some(Self {
            spectrum,
            elastic: surface.nondimensional,
            virgin: (surface.problem.candidates.shared(), surface.mean),
            hardness: surface.hardness,
            friction: surface.sliding.as_ref().map(|sliding| sliding.law),
            attraction: adhesion.map(|adhesion| adhesion.attraction.clone()),
            periodic: surface.is_periodic(),
            tolerance: options.time_tolerance,
            law: StepLaw::new,
            memory: HistoryMemory::new(fine),
        }))
    }

    /// Forgets all loads.
    pub(super) fn begin(&mut self, surface: &mut PreparedSurface) {
        self.rest(surface);
        let fine = ViscousTrack::new(surface, &self.spectrum);
        self.memory = HistoryMemory::new(fine);
    }

    /// The memory from which the next step follows.
    pub(super) fn memory(&self) -> &HistoryMemory {
        &self.memory
    }

    /// Whether a memory belongs to this history.
    pub(super) fn fits(&self, memory: &HistoryMemory, grid: Grid) -> bool {
        let HistoryMemory { fine, coarse, step, largest, work } = memory;
        let arms = self.spectrum.arms.len();
        fine.fits(grid, arms)
            && coarse.as_ref().is_none_or(|coarse| coarse.fits(grid, arms))
            && step.is_none_or(|step| step.is_finite() && step > 0.0)
            && largest.force.is_finite()
            && largest.elastic_force.is_finite()
            && largest.approach.is_finite()
            && largest.tangential_force.into_iter().chain(largest.tangential_displacement).all(f64::is_finite)
            && work.is_finite()
    }

    /// Goes on from a memory that fits.
    pub(super) fn recall(&mut self, memory: HistoryMemory) {
        self.memory = memory;
    }

    /// The surface without its history, in the units of the modulus E*.
    fn rest(&self, surface: &mut PreparedSurface) {
        let (virgin, mean) = &self.virgin;
        surface.nondimensional = self.elastic;
        surface.problem.candidates = Candidates::new(surface.problem.grid(), Arc::clone(virgin));
        surface.problem.coarser = None;
        (surface.mean, surface.last, surface.memory) = (*mean, None, None);
        surface.crept = Vec::new();
        surface.limit_pressure(self.hardness, self.attraction.as_ref());
        if let (Some(sliding), Some(law)) = (&mut surface.sliding, self.friction) {
            sliding.begin();
            sliding.law = law;
        }
    }

    /// The surface at the beginning of a step of a track, and what the history leaves of pressures and tractions.
    ///
    /// # Errors
    /// [`Error::Stopped`] by the stop; [`Error::Domain`] where no `f64` holds the modulus of the step.
    fn begin_step(
        &self,
        surface: &mut PreparedSurface,
        track: &ViscousTrack,
        (law, guess): (&StepLaw, Option<&LastState>),
        stop: Stop<'_>,
    ) -> Result<[Vec<f64>; 2]> {
        self.rest(surface);
        surface.nondimensional = self.elastic.with_modulus_times(law.modulus)?;
        let guess = guess.or(track.last.as_ref());
        surface.last = guess.map(|last| last.scaled(law.modulus.recip()));
        if let Some(hardness) = self.hardness {
            let attraction = self.attraction.as_ref().map(|attraction| attraction.over(law.modulus));
            surface.limit_pressure(Some(hardness / law.modulus), attraction.as_ref());
            let mut memory = IndentationMemory::new(Arc::clone(&self.virgin.0));
            if let Some(indented) = &track.indented {
                indented.restore(surface.problem.grid(), &mut memory);
                surface.problem.candidates = Candidates::new(surface.problem.grid(), memory.indented());
            }
            surface.memory = Some(memory);
        }
        let left = track.pressures.left(law);
        surface.creep(&track.pressures.cells, &left, stop)?;
        let mut of_tractions = Vec::new();
        if let (Some(sliding), Some(slid), Some(friction)) =
            (&mut surface.sliding, &track.slid, self.friction)
        {
            sliding.law = over(friction, law.modulus);
            sliding.relaxes = true;
            of_tractions = slid.tractions.left(law);
            slid.begin(law, &of_tractions, sliding);
        }
        Ok([left, of_tractions])
    }

    /// The state after a piece of the path in which the load goes straight to this one. A load that was stopped, or
    /// was not solved, leaves the history where it was.
    pub(super) fn at(
        &mut self,
        surface: &mut PreparedSurface,
        load: ScaledLoad,
        duration: f64,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let outputs = surface.outputs;
        let found = self.piece(surface, load, duration, stop);
        surface.outputs = outputs;
        self.rest(surface);
        let pulled_off = is_pull_off(&found);
        let (state, memory) = match (found, &self.memory.fine.adhesive) {
            // Not that of a step on the way.
            (Err(Error::NotConverged { best }), Some(last)) if pulled_off => {
                return Err(last.pulled_off(best.report.strategy));
            }
            (found, _) => found?,
        };
        self.memory = memory;
        Ok(state)
    }

    /// The state at the end of a piece of the path, and the memory there.
    fn piece(
        &self,
        surface: &mut PreparedSurface,
        load: ScaledLoad,
        duration: f64,
        stop: Stop<'_>,
    ) -> Result<(ContactState, HistoryMemory)> {
        let wanted = surface.outputs;
        let hidden = Outputs::default();
        let mut memory = self.memory.clone();
        let mut work = StepWork::default();
        if duration <= 0.0 {
            if self.spectrum.is_stiff() {
                let what = "a load in no time on a body of Kelvin and Voigt, whose dashpot does not move at once: give the \
                            load a time";
                return Err(Error::unsupported(NAME, what));
            }
            let jump = TimeStep { duration: 0.0, load, guess: None };
            if let Some(coarse) = &mut memory.coarse {
                surface.outputs = hidden;
                *coarse = self.step(surface, coarse, jump, &mut work, stop)?.1;
            }
            surface.outputs = wanted;
            let (state, fine) = self.step(surface, &memory.fine, jump, &mut work, stop)?;
            memory.work += work_between(surface, &memory.fine, &fine, &mut work, stop)?;
            memory.fine = fine;
            memory.largest = self.largest(&memory, memory.largest);
            return Ok((self.finished(surface, state, &memory, load, work)?, memory));
        }
        let start = memory.fine.reached;
        let at = |share: f64| start.towards(load, share);
        // The largest response that any attempt has shown: what errors are relative to.
        let mut scale = memory.largest;
        let (mut done, mut step) = (0.0, memory.step.unwrap_or(duration));
        // The error of the step that was cut last, and how often that had no effect.
        let (mut cut, mut useless) = (f64::INFINITY, 0);
        loop {
            let left = duration - done;
            // No short rest is left to the last step.
            let now = if step >= left {
                left
            } else if 2.0 * step > left {
                0.5 * left
            } else {
                step
            };
            let ends = now >= left;
            let (middle, end) = ((done + 0.5 * now) / duration, (done + now) / duration);
            let end = if ends { 1.0 } else { end };
            let pair =
                StepPair { duration: now, middle: at(middle), end: at(end), shown: ends.then_some(wanted) };
            let found = self.both(surface, &memory, pair, &mut work, stop);
            if is_pull_off(&found) && now > SHORTEST_PULL * duration {
                // Held by what has not relaxed yet, or not at all.
                step = 0.25 * now;
                continue;
            }
            let StepResult { state, first, fine, coarse } = found?;
            let next =
                HistoryMemory { fine, coarse: Some(coarse), step: None, largest: scale, work: memory.work };
            scale = self.largest(&next, scale);
            let added = (self.error(&next, load, scale) - self.error(&memory, load, scale)).abs();
            let ratio = (self.tolerance / added).powf(STEP_ORDER.recip()) * CAUTION;
            let better = now * ratio.clamp(STEP_CHANGE.0, STEP_CHANGE.1);
            useless = if added > NOISE * cut { useless + 1 } else { 0 };
            let is_noise = useless >= USELESS_CUTS;
            if added > self.tolerance && now > SHORTEST_STEP * duration && !is_noise {
                (step, cut) = (better.min(0.5 * now), added);
                continue;
            }
            // Noise does not grow with the step.
            let better = if is_noise { STEP_CHANGE.1 * now } else { better };
            (cut, useless) = (f64::INFINITY, 0);
            work.steps += 1;
            done += now;
            // A step that the end of the piece cut short says little about the longest possible one.
            let kept = if ends { better.max(step.min(STEP_CHANGE.1 * now)) } else { better };
            let of_load = work_between(surface, &memory.fine, &first, &mut work, stop)?
                + work_between(surface, &first, &next.fine, &mut work, stop)?;
            memory = HistoryMemory {
                step: Some(kept),
                largest: self.largest(&next, memory.largest),
                work: memory.work + of_load,
                ..next
            };
            step = kept;
            if ends {
                return Ok((self.finished(surface, state, &memory, load, work)?, memory));
            }
        }
    }

    /// Both histories through one step of time.
    fn both(
        &self,
        surface: &mut PreparedSurface,
        memory: &HistoryMemory,
        pair: StepPair,
        work: &mut StepWork,
        stop: Stop<'_>,
    ) -> Result<StepResult> {
        let StepPair { duration, middle, end, shown } = pair;
        surface.outputs = Outputs::default();
        let coarse = memory.coarse.as_ref().unwrap_or(&memory.fine);
        let coarse = self.step(surface, coarse, TimeStep { duration, load: end, guess: None }, work, stop)?.1;
        // Both histories are close to each other: the end of one is the guess of the other.
        let between = memory.fine.last.as_ref().zip(coarse.last.as_ref());
        let between = between.map(|(start, end)| start.halfway_to(end));
        let half = TimeStep { duration: 0.5 * duration, load: middle, guess: between.as_ref() };
        let first = self.step(surface, &memory.fine, half, work, stop)?.1;
        surface.outputs = shown.unwrap_or_default();
        let half = TimeStep { load: end, guess: coarse.last.as_ref(), ..half };
        let (state, fine) = self.step(surface, &first, half, work, stop)?;
        Ok(StepResult { state, first, fine, coarse })
    }

    /// The largest of a response and of those at the ends of both histories, so that their difference is no more than
    /// twice as large.
    fn largest(&self, memory: &HistoryMemory, before: LoadResponse) -> LoadResponse {
        [Some(&memory.fine), memory.coarse.as_ref()].into_iter().flatten().fold(before, |largest, track| {
            let now = self.response(track);
            let larger = |a: [f64; 2], b: [f64; 2]| if length(a) >= length(b) { a } else { b };
            LoadResponse {
                force: largest.force.max(now.force.abs()),
                elastic_force: largest.elastic_force.max(now.elastic_force.abs()),
                approach: largest.approach.max(now.approach.abs()),
                tangential_force: larger(largest.tangential_force, now.tangential_force),
                tangential_displacement: larger(largest.tangential_displacement, now.tangential_displacement),
            }
        })
    }

    fn response(&self, track: &ViscousTrack) -> LoadResponse {
        let TrackEnd { force, elastic_force, approach, mean_gap, .. } = track.reached;
        let TrackEnd { tangential_force, tangential_displacement, .. } = track.reached;
        // The approach of a periodic surface contains the constant in its kernel.
        let approach = if self.periodic { self.virgin.1 - mean_gap } else { approach };
        LoadResponse { force, elastic_force, approach, tangential_force, tangential_displacement }
    }

    /// The difference between both histories in what the load leaves free, relative to the largest.
    fn error(&self, memory: &HistoryMemory, load: ScaledLoad, scale: LoadResponse) -> f64 {
        let Some(coarse) = &memory.coarse else { return 0.0 };
        let (fine, coarse) = (self.response(&memory.fine), self.response(coarse));
        let relative = |difference: f64, of: f64| if difference == 0.0 { 0.0 } else { difference.abs() / of };
        let normal = match load.normal {
            ScaledNormal::Force(_) => relative(fine.approach - coarse.approach, scale.approach),
            _ => relative(fine.force - coarse.force, scale.force),
        };
        let apart = |a: [f64; 2], b: [f64; 2]| length([a[0] - b[0], a[1] - b[1]]);
        let tangential = match load.tangential.control {
            TangentialControl::Force(_) => relative(
                apart(fine.tangential_displacement, coarse.tangential_displacement),
                length(scale.tangential_displacement),
            ),
            TangentialControl::Displacement(_) => relative(
                apart(fine.tangential_force, coarse.tangential_force),
                length(scale.tangential_force),
            ),
        };
        let elastic = relative(fine.elastic_force - coarse.elastic_force, scale.elastic_force);
        normal.max(elastic).max(tangential)
    }

    /// The relative differences between both histories in the tangential force and in the tangential displacement; 0 in
    /// the one that is prescribed. `None` without friction.
    fn tangential_errors(&self, memory: &HistoryMemory, load: ScaledLoad) -> Option<[f64; 2]> {
        self.friction?;
        let Some(coarse) = &memory.coarse else { return Some([0.0; 2]) };
        let (fine, coarse) = (memory.fine.reached, coarse.reached);
        let relative = |fine: [f64; 2], coarse: [f64; 2]| {
            let difference = length([fine[0] - coarse[0], fine[1] - coarse[1]]);
            if difference > 0.0 { difference / length(fine).max(length(coarse)) } else { 0.0 }
        };
        Some(match load.tangential.control {
            TangentialControl::Force(_) => {
                [0.0, relative(fine.tangential_displacement, coarse.tangential_displacement)]
            }
            TangentialControl::Displacement(_) => {
                [relative(fine.tangential_force, coarse.tangential_force), 0.0]
            }
        })
    }

    /// The state at the end of a piece, with the error of its steps.
    ///
    /// # Errors
    /// [`Error::Domain`] where no `f64` holds the work of the load.
    fn finished(
        &self,
        surface: &PreparedSurface,
        mut state: ContactState,
        memory: &HistoryMemory,
        load: ScaledLoad,
        work: StepWork,
    ) -> Result<ContactState> {
        let errors = memory.coarse.as_ref().map_or([0.0; 3], |coarse| {
            let (fine, coarse) = (memory.fine.reached, coarse.reached);
            let relative = |fine: f64, coarse: f64| {
                let difference = (fine - coarse).abs();
                if difference > 0.0 { difference / fine.abs().max(coarse.abs()) } else { 0.0 }
            };
            let prescribed = |error: f64, is_free: bool| if is_free { error } else { 0.0 };
            let distance = if surface.is_periodic() {
                relative(fine.mean_gap, coarse.mean_gap)
            } else {
                relative(fine.approach, coarse.approach)
            };
            let by_force = matches!(load.normal, ScaledNormal::Force(_));
            [
                prescribed(relative(fine.force, coarse.force), !by_force),
                prescribed(distance, by_force),
                relative(fine.cells as f64, coarse.cells as f64),
            ]
        });
        state.report.iterations = work.iterations;
        state.report.applications = work.applications;
        state.report.work.linear_solves = work.linear_solves;
        // A force times a length; what has flowed is displaced too.
        let of_load =
            self.elastic.approach(self.elastic.force(PI * memory.work.abs())?)?.copysign(memory.work);
        let of_load = of_load + state.plastic.map_or(0.0, |plastic| plastic.dissipated);
        // Without a zero of the displacements the work has none.
        let has_zero = surface.has_approach() || surface.is_periodic();
        let of_load = (has_zero && self.attraction.is_none()).then_some(of_load);
        let found = ViscoelasticState::new(errors, work.steps).with_work(of_load);
        Ok(state.with_viscoelastic(found.with_tangential_errors(self.tangential_errors(memory, load))))
    }

    /// A step of one track: its state, and the track at its end.
    fn step(
        &self,
        surface: &mut PreparedSurface,
        track: &ViscousTrack,
        step: TimeStep<'_>,
        work: &mut StepWork,
        stop: Stop<'_>,
    ) -> Result<(ContactState, ViscousTrack)> {
        let law = (self.law)(&self.spectrum, step.duration);
        let modulus = law.modulus;
        let left = self.begin_step(surface, track, (&law, step.guess), stop)?;
        let load = step.load.over(modulus);
        let (state, end) = self.solved(surface, track, (load, modulus), stop)?;
        work.add(&state);
        let StepEnd { cells, net, contact, force, approach, adhesive, last } = end;
        let [of_pressures, of_tractions] = left;
        let slid = track.slid.as_ref().zip(surface.sliding.as_ref());
        let mean_gap = surface.mean_gap(surface.is_full(&contact), approach, force);
        let pressures = track.pressures.advanced(&law, &of_pressures, &cells, &net);
        let reached = TrackEnd {
            force: modulus * force,
            elastic_force: pressures.elastic.iter().sum(),
            approach,
            mean_gap,
            cells: contact.len(),
            ..TrackEnd::default()
        };
        let grid = surface.problem.grid();
        let next = ViscousTrack {
            pressures,
            slid: slid.map(|(slid, sliding)| slid.advanced(&law, &of_tractions, sliding)),
            adhesive: adhesive.map(|last| last.scaled(modulus)),
            last: last.map(|last| last.scaled(modulus)),
            indented: surface.memory.as_ref().map(|memory| Indented::of(grid, memory)),
            reached: reached.with_slip(modulus, surface.sliding.as_ref()),
        };
        Ok((state, next))
    }

    /// The elastic contact at the end of a step, in the units of its modulus.
    fn solved(
        &self,
        surface: &mut PreparedSurface,
        track: &ViscousTrack,
        (load, modulus): (ScaledLoad, f64),
        stop: Stop<'_>,
    ) -> Result<(ContactState, StepEnd)> {
        if let Some(attraction) = &self.attraction {
            let last = track.adhesive.as_ref().map(|last| last.scaled(modulus.recip()));
            let mut path = AdhesivePath::of_step(attraction.over(modulus), last);
            let state = path.on(surface).at(load, LoadSequence::Path, stop)?;
            let equilibrium = path.last.as_ref().map(|last| last.equilibrium.clone()).unwrap_or_default();
            let end = StepEnd {
                net: equilibrium.net(),
                contact: equilibrium.contact(),
                force: equilibrium.force(),
                approach: equilibrium.d,
                cells: equilibrium.cells,
                adhesive: path.last,
                last: None,
            };
            return Ok((state, end));
        }
        let state = surface.at(load, stop)?;
        let last = surface.last.take().filter(|_| state.force > 0.0);
        let approach = match (&last, load.normal) {
            (Some(last), _) => last.d,
            (None, ScaledNormal::Approach(d)) => d,
            (None, ScaledNormal::MeanGap(gap)) => surface.mean - gap,
            (None, ScaledNormal::Force(_)) => surface.problem.candidates.range().first,
        };
        let contact = last.as_ref().map_or_else(CellSet::default, |last| last.contact.clone());
        let end = StepEnd {
            cells: contact.clone(),
            contact,
            net: last.as_ref().map_or_else(Vec::new, |last| last.p.clone()),
            force: last.as_ref().map_or(0.0, |last| last.force),
            approach,
            adhesive: None,
            last,
        };
        Ok((state, end))
    }
}

/// The contact at the end of a step, in the units of its modulus.
struct StepEnd {
    /// The cells with a traction, and the net pressures on them.
    cells: CellSet,
    net: Vec<f64>,
    contact: CellSet,
    force: f64,
    approach: f64,
    adhesive: Option<Last>,
    last: Option<LastState>,
}

impl ScaledLoad {
    /// The load in the units of a body with another modulus.
    fn over(mut self, modulus: f64) -> Self {
        if let ScaledNormal::Force(force) = &mut self.normal {
            *force /= modulus;
        }
        if let TangentialControl::Force(force) = &mut self.tangential.control {
            *force = force.map(|force| force / modulus);
        }
        self
    }
}

/// The work of a piece of a path.
#[derive(Debug, Clone, Copy, Default)]
struct StepWork {
    steps: usize,
    iterations: usize,
    applications: usize,
    linear_solves: usize,
}

impl StepWork {
    fn add(&mut self, state: &ContactState) {
        self.iterations += state.report.iterations;
        self.applications += state.report.applications;
        self.linear_solves += state.report.work.linear_solves;
    }
}

/// Work of the load between two states of a track, in the units of the modulus E* (over pi): the true pressures on
/// the mean times the displacement of their cells. Exact in no time, of second order in the step.
///
/// # Errors
/// [`Error::Stopped`] by the stop.
///
/// Cost: one application of the kernel.
fn work_between(
    surface: &mut PreparedSurface,
    before: &ViscousTrack,
    after: &ViscousTrack,
    work: &mut StepWork,
    stop: Stop<'_>,
) -> Result<f64> {
    let mut pressed = CellSet::default();
    let ends = [before, after].map(|track| track.last.as_ref());
    for last in ends.into_iter().flatten() {
        pressed = pressed.union(&last.contact);
    }
    if pressed.is_empty() {
        return Ok(0.0);
    }
    let [before, after] = [before, after].map(|track| &track.pressures);
    let mut change = after.cells.carry(&before.cells, &before.elastic);
    for (change, now) in change.iter_mut().zip(&after.elastic) {
        *change = now - *change;
    }
    let (mut moved, operators) = (Vec::new(), &mut surface.problem.operators);
    operators.exact(&after.cells, &change, &pressed, &mut moved, stop).map_err(Interrupted::without_state)?;
    work.applications += 1;
    // What the constant in the kernel adds is no displacement.
    let shift = operators.table().shift() * change.iter().sum::<f64>();
    for u in &mut moved {
        *u -= shift;
    }
    let mut sum = vec![0.0; pressed.len()];
    for last in ends.into_iter().flatten() {
        pressed.add_carried(&last.contact, &last.p, &mut sum);
    }
    Ok(0.5 * sum_of_pairs(&sum, &moved, |p, u| p * u))
}

impl PreparedSurface {
    /// Bounds the pressure by a hardness and an attraction in the present units.
    fn limit_pressure(&mut self, hardness: Option<f64>, attraction: Option<&Attraction>) {
        self.hardness = hardness;
        self.problem.bounds = bounds(hardness, attraction);
    }

    /// Displaces the heights by a pressure that a history has left.
    ///
    /// # Errors
    /// [`Error::Stopped`] by the stop.
    fn creep(&mut self, cells: &CellSet, left: &[f64], stop: Stop<'_>) -> Result<()> {
        if cells.is_empty() {
            return Ok(());
        }
        let (grid, mut crept) = (self.problem.grid(), Vec::new());
        let all = CellSet::all(grid);
        self.problem
            .operators
            .exact(cells, left, &all, &mut crept, stop)
            .map_err(Interrupted::without_state)?;
        let mut z = self.problem.candidates.z().to_vec();
        update(&mut z, &crept, |z, u| *z += u);
        let of_defined = sum_of_pairs(&z, &crept, |z, u| if z.is_finite() { u } else { 0.0 });
        self.mean += of_defined / self.defined as f64;
        self.problem.candidates = Candidates::new(grid, Arc::new(z));
        // What the constant in the kernel adds is no displacement.
        let shift = self.problem.operators.table().shift() * left.iter().sum::<f64>();
        for u in &mut crept {
            *u -= shift;
        }
        self.crept = crept;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
