//! A surface under loads, behind the common traits: one type for single loads and for paths, with and without
//! adhesion.

use super::adhesive::AdhesivePath;
use super::certificate::LoadError;
use super::load::{LoadSequence, ScaledLoad, ScaledNormal, ScaledTangential};
use super::options::Bem3d;
use super::path_memory::{PlaceInLoads, Remembered};
use super::prepared::{PreparedSurface, Tangent};
use super::sliding::SurfaceFriction;
use super::solve_memory::{factor_bytes, solve_bytes};
use super::viscous::ViscousHistory;
use crate::active_set::{self, Control, Limits, Solved};
use crate::geometry::{CellSet, Grid};
use crate::parts::{Part, Recorder};
use crate::response::normal::{self, Responding, StiffnessRequest};
use crate::tuning::Tuning;
use contact_model::{
    Cells, ContactState, Error, HeightMap, Interrupted, Load, NormalLoad, Normalisation, PathMemory,
    PreparedContact, RequiredMemory, Result, Scene, Status, Step, Stop, Watch,
};
use std::borrow::Cow;
use std::cell::Cell;
use std::f64::consts::PI;

/// One surface under loads.
///
/// Single loads begin with the virgin surface, paths go on from their last state. One surface serves both: a
/// single load ends a path, and a path that begins after single loads reaches the last of them first.
#[derive(Debug)]
pub struct PreparedBem3d {
    surface: PreparedSurface,
    /// `None` without adhesion.
    adhesion: Option<AdhesivePath>,
    /// `None` for elastic bodies.
    viscous: Option<ViscousHistory>,
    place: PlaceInLoads,
}

impl PreparedBem3d {
    /// The surface of a scene with these heights.
    pub(super) fn new(
        model: &Bem3d,
        scene: &Scene,
        map: &HeightMap,
        numerics: (&Tuning, &Recorder),
    ) -> Result<Self> {
        let mut surface = PreparedSurface::of_map(*model, scene, map, numerics)?;
        let adhesion = AdhesivePath::of(&mut surface, scene.effects.adhesion)?;
        let viscous = ViscousHistory::of(&surface, adhesion.as_ref(), scene)?;
        let place = PlaceInLoads { loads: LoadSequence::Single, solved: None, time: 0.0 };
        Ok(Self { surface, adhesion, viscous, place })
    }

    /// A load in the units of the surface; with adhesion it may pull.
    fn scaled_load(&self, load: Load) -> Result<ScaledLoad> {
        let load = match load.normal {
            _ if self.adhesion.is_some() => load.validated_with_adhesion()?,
            // Undefined points let the planes pass each other.
            NormalLoad::MeanGap(gap) if gap.is_finite() => {
                load.tangential.validated()?;
                load
            }
            _ => load.validated()?,
        };
        self.surface.scaled_load(load)
    }

    /// The state of a load, with the given relation to other loads, which it reaches in this time.
    fn at(
        &mut self,
        load: ScaledLoad,
        loads: LoadSequence,
        duration: f64,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let stop = &Heard { stop, heard: Cell::new(false) };
        if self.place.loads != loads {
            let solved = self.place.solved.take();
            self.begin(loads);
            if let (LoadSequence::Path, Some(solved)) = (loads, solved)
                && let Err(error) = self.state_at(solved, loads, 0.0, stop)
            {
                self.begin(LoadSequence::Single);
                self.place.solved = Some(solved);
                return Err(error);
            }
        }
        let state = match self.state_at(load, loads, duration, stop) {
            // What a solve finds while it is being stopped, such as a pull-off, need not be so.
            Err(error) if stop.stops() && !matches!(error, Error::Stopped { .. }) => {
                return Err(Interrupted.without_state());
            }
            found => found?,
        };
        self.place.solved = (loads == LoadSequence::Single).then_some(load);
        Ok(state)
    }

    fn state_at(
        &mut self,
        load: ScaledLoad,
        loads: LoadSequence,
        duration: f64,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        if let (Some(sliding), LoadSequence::Single) = (&mut self.surface.sliding, loads) {
            sliding.begin();
        }
        let state = match (&mut self.adhesion, &mut self.viscous) {
            (Some(adhesion), None) => adhesion.on(&mut self.surface).at(load, loads, stop),
            (_, Some(history)) => {
                if loads == LoadSequence::Single {
                    history.begin(&mut self.surface);
                }
                history.at(&mut self.surface, load, duration, stop)
            }
            (None, None) => self.surface.at(load, stop),
        };
        // Those of the next load would depend on them, and the memory is free meanwhile.
        self.surface.forget_plans();
        state
    }

    /// Takes the virgin surface again.
    fn begin(&mut self, loads: LoadSequence) {
        self.place = PlaceInLoads { loads, solved: None, time: 0.0 };
        self.surface.begin(loads == LoadSequence::Path);
        if let Some(adhesion) = &mut self.adhesion {
            adhesion.last = None;
        }
        if let Some(history) = &mut self.viscous {
            history.begin(&mut self.surface);
        }
    }
}

/// A stop that goes on to say so once it has: what was left unfinished is then never taken for finished.
struct Heard<'a> {
    stop: Stop<'a>,
    heard: Cell<bool>,
}

impl Watch for Heard<'_> {
    fn stops(&self) -> bool {
        let stops = self.heard.get() || self.stop.stops();
        self.heard.set(stops);
        stops
    }

    fn residual(&self, residual: f64, tolerance: f64) {
        self.stop.residual(residual, tolerance);
    }
}

impl PreparedContact for PreparedBem3d {
    fn normalisation(&self) -> Normalisation {
        self.surface.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        let load = self.scaled_load(load)?;
        self.at(load, LoadSequence::Single, 0.0, stop)
    }

    /// Cost O(N).
    fn required_memory(&self, load: Load) -> Option<RequiredMemory> {
        let surface = &self.surface;
        let Grid { columns, rows, .. } = surface.problem.grid();
        let contact = surface.expected_contact(load.normal);
        let bytes = solve_bytes(&surface.effects, &surface.outputs, Cells { columns, rows }, contact);
        let bytes = bytes + factor_bytes(surface.largest_factor(load.normal, contact), contact);
        Some(RequiredMemory { what: format!("a solve on {columns} columns x {rows} rows").into(), bytes })
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
        let time = self.place.time;
        let step =
            if self.adhesion.is_some() { step.validated_with_adhesion(time)? } else { step.validated(time)? };
        if stop.stops() {
            return Err(Error::Stopped { best: None });
        }
        let load = self.scaled_load(step.load)?;
        let state = match self.at(load, LoadSequence::Path, step.time - time, stop) {
            Err(Error::NotConverged { best }) => {
                // The last stable state is that of the step before.
                let time = if best.report.status == Status::PulledOff { self.place.time } else { step.time };
                return Err(Error::NotConverged { best: Box::new(best.with_time(time)) });
            }
            found => found?,
        };
        self.place.time = step.time;
        Ok(state.with_time(step.time))
    }

    fn restart(&mut self) {
        self.begin(LoadSequence::Path);
    }

    fn memory(&self) -> Result<Option<PathMemory>> {
        let adhesive = self.adhesion.as_ref().and_then(|adhesion| adhesion.last.as_ref());
        let viscous = self.viscous.as_ref();
        PathMemory::of(&Remembered::of(self.place, &self.surface, adhesive, viscous)).map(Some)
    }

    fn recall(&mut self, memory: &PathMemory) -> Result<()> {
        self.restart();
        let remembered: Remembered<'_> = memory.read()?;
        let place = remembered.place;
        self.begin(place.loads);
        if !remembered.recall(&mut self.surface, &mut self.adhesion, &mut self.viscous) {
            self.restart();
            return Err(PathMemory::unreadable(memory.bytes().len()));
        }
        self.place = place;
        Ok(())
    }
}

impl PreparedSurface {
    /// The state of a load without adhesion. A load that was stopped leaves the surface where it was.
    pub(super) fn at(&mut self, load: ScaledLoad, stop: Stop<'_>) -> Result<ContactState> {
        let last = self.last.clone();
        let found = self.solved_at(load, stop);
        if matches!(found, Err(Error::Stopped { .. })) {
            self.last = last;
        }
        found
    }

    fn solved_at(&mut self, load: ScaledLoad, stop: Stop<'_>) -> Result<ContactState> {
        self.undeform();
        // 0 but for an indented surface.
        let first = self.problem.candidates.range().first;
        let ScaledLoad { normal, tangential } = load;
        let state = match normal {
            ScaledNormal::Force(force) if force <= 0.0 => self.no_contact(first, tangential),
            ScaledNormal::Approach(d) if d <= first => self.no_contact(d, tangential),
            ScaledNormal::MeanGap(gap) => self.at_mean_gap(gap, tangential, stop),
            ScaledNormal::Force(force) => self.at_target(Control::Force(force), tangential, stop),
            ScaledNormal::Approach(d) => self.at_target(Control::Approach(d), tangential, stop),
        }?;
        if let Some(memory) = self.memory.as_mut().filter(|_| state.force <= 0.0) {
            memory.advance(0.0, 0.0);
        }
        Ok(state)
    }

    fn at_target(
        &mut self,
        target: Control,
        tangential: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        self.begin_count();
        if self.sliding.as_ref().is_some_and(SurfaceFriction::is_coupled) {
            return self.at_coupled(target, tangential, stop);
        }
        let (solved, tangent) =
            self.settle(target, self.limits(), stop).map_err(Interrupted::without_state)?;
        let error = self.load_error(target, &solved, tangent.as_ref());
        let slid = self.slide_under(&solved, tangential, stop)?;
        let recorder = self.problem.operators.recorder().clone();
        recorder.timed(Part::Results, || self.state(solved, tangent, error, slid, stop))
    }

    /// The relative error of the load of a state.
    pub(super) fn load_error(
        &self,
        target: Control,
        solved: &Solved,
        tangent: Option<&Tangent>,
    ) -> LoadError {
        match target {
            Control::Force(asked) => LoadError::of_force((solved.p.iter().sum::<f64>() - asked) / asked),
            Control::Approach(_) => self.force_error(solved, self.stiffest(solved, tangent), 0.0),
        }
    }

    /// The largest set of cells that a solve may factor, where a share of the cells touches; `None` where that is
    /// too many.
    fn largest_factor(&self, load: NormalLoad, contact: f64) -> Option<usize> {
        let (problem, tuning) = (&self.problem, self.problem.operators.tuning());
        let (planner, window) = (problem.operators.planner(), problem.grid().window());
        let (mut low, mut high) = (0, tuning.largest_factor);
        while low < high {
            let middle = (low + high).div_ceil(2);
            (low, high) = if planner.factors(middle, window) { (middle, high) } else { (low, middle - 1) };
        }
        if contact * problem.grid().count() as f64 > 2.0 * low as f64 {
            return None;
        }
        // The first guess of a light load: the cells below a plane that one cell alone would hold.
        let NormalLoad::Force(force) = load else { return Some(low) };
        let force = self.nondimensional.force_in(force) / PI;
        let reach = problem.candidates.range().first + force * problem.operators.table().own();
        Some(problem.candidates.z().iter().filter(|z| **z < reach).take(low).count())
    }

    /// An estimate of the share of the cells that a load brings into contact.
    fn expected_contact(&self, load: NormalLoad) -> f64 {
        let z = self.problem.candidates.z();
        if self.problem.operators.table().kernel().may_bulge() {
            // The gap is evaluated on all cells.
            return 1.0;
        }
        match load {
            // Contact lies within the bearing area.
            NormalLoad::Approach(d) => {
                let d = self.nondimensional.approach_in(d);
                z.iter().filter(|z| **z < d).count() as f64 / z.len() as f64
            }
            // Rough contact has an area of about 2 F/(E* g), g the rms gradient.
            NormalLoad::Force(force) => {
                let gradient = *self.gradient.get_or_init(|| self.rms_gradient());
                let share = 2.0 * force / (self.normalisation.contact_modulus * self.size.area() * gradient);
                // Of a flat surface all.
                if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 }
            }
            _ => 1.0,
        }
    }

    /// The rms gradient of the heights, from differences along x.
    fn rms_gradient(&self) -> f64 {
        let z = self.problem.candidates.z();
        let squares = z.chunks_exact(self.problem.grid().columns).flat_map(|row| row.windows(2));
        let squares = squares.map(|pair| (pair[1] - pair[0]).powi(2)).filter(|square| square.is_finite());
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        self.height / self.cell().0 * (2.0 * sum / f64::max(count, 1.0)).sqrt()
    }

    /// Solves for the pressure and, where requested, for the stiffness. The stiffness may need a more
    /// accurate pressure than the certificate does: as long as undecided cells could change it by more than
    /// the tolerance, the contact set is solved further. A pressure that was found before a stop has none.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop before a pressure was found.
    pub(super) fn settle(
        &mut self,
        target: Control,
        mut limits: Limits,
        stop: Stop<'_>,
    ) -> std::result::Result<(Solved, Option<Tangent>), Interrupted> {
        let tuning = *self.problem.operators.tuning();
        let guess = self.guess(target, limits, stop)?;
        let mut solved = active_set::solve(&mut self.problem, target, guess, limits, stop)?;
        let has_tangent = solved.status != Status::Stopped && !self.is_complete(&solved);
        if !has_tangent || !self.outputs.needs_stiffness() {
            return Ok((solved, None));
        }
        // The last state is not needed any more, and as large as the contact.
        let last = self.last.take();
        let k = last.as_ref().and_then(|last| last.tangent.as_ref()).map(|&(_, k)| k);
        let q = last.and_then(|last| last.tangent_at(&solved, &self.responding(&solved).cells, &tuning));
        let Ok(mut tangent) = self.tangent(&solved, (q, None), k, stop) else { return Ok((solved, None)) };
        for _ in 0..tuning.tightenings {
            let (error, before) = (self.tangent_error(&tangent), solved.residuals.worst());
            if solved.status != Status::Converged || error <= self.options.tolerance || stop.stops() {
                break;
            }
            // The state may be better than it was asked to be: begin there.
            limits.tolerance =
                tuning.tightened(self.options.tolerance / error) * limits.tolerance.min(before);
            let continuation = std::mem::take(&mut solved.continuation);
            let again = Solved { continuation, ..solved.clone() };
            let Ok(next) = active_set::resume(&mut self.problem, target, again, limits, stop) else { break };
            solved.steps += next.steps;
            if next.residuals.worst() >= before {
                solved.continuation = next.continuation;
                break;
            }
            // The tighter state counts as converged when it meets the tolerance that was asked for.
            let converged = next.residuals.worst() <= self.options.tolerance;
            let status = if converged { Status::Converged } else { next.status };
            let q = self.responding(&next).cells.carry(&tangent.cells, tangent.stiffness.q());
            let whole = tangent.whole.map(|whole| next.contact.carry(&solved.contact, whole.q()));
            let steps = solved.steps + tangent.stiffness.steps;
            solved = Solved { steps, status, ..next };
            tangent = match self.tangent(&solved, (Some(q), whole), k, stop) {
                Ok(tangent) => tangent,
                Err(Interrupted) => return Ok((solved, None)),
            };
        }
        Ok((solved, Some(tangent)))
    }

    /// The stiffnesses of a state from guesses of q, along the branch and of the whole contact, and of k.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub(super) fn tangent(
        &mut self,
        solved: &Solved,
        (q, of_whole): (Option<Vec<f64>>, Option<Vec<f64>>),
        k: Option<f64>,
        stop: Stop<'_>,
    ) -> std::result::Result<Tangent, Interrupted> {
        let responding = self.responding(solved);
        let (problem, tolerance) = (&mut self.problem, self.options.tolerance);
        let wanted = StiffnessRequest { tolerance, q, expected: k };
        let stiffness = normal::solve_of_zero_mean(problem, solved, &responding, wanted, stop)?;
        let another = responding.cells.len() != solved.contact.len();
        let wanted = another && self.outputs.needs_fixed_area() && !self.is_full(&solved.contact);
        let whole = if wanted {
            let whole = Responding::whole(solved, self.problem.bounds);
            let wanted = StiffnessRequest { tolerance, q: of_whole, expected: None };
            Some(normal::solve_of_zero_mean(&mut self.problem, solved, &whole, wanted, stop)?)
        } else {
            None
        };
        Ok(Tangent { stiffness, cells: responding.cells.into_owned(), whole })
    }

    /// An upper estimate of the stiffness to a few per cent; infinite where the contact is complete.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub(super) fn rough_stiffness(
        &mut self,
        solved: &Solved,
        stop: Stop<'_>,
    ) -> std::result::Result<f64, Interrupted> {
        const ROUGH: f64 = 0.02;
        if self.is_complete(solved) {
            return Ok(f64::INFINITY);
        }
        let responding = self.responding(solved);
        let wanted = StiffnessRequest { tolerance: ROUGH, ..StiffnessRequest::default() };
        let found = normal::solve(&mut self.problem, solved, &responding, wanted, stop)?;
        let k = found.k() * (1.0 + found.solve_error.min(1.0));
        Ok(k * self.magnification(k))
    }

    /// The cells that follow a small change of the load as it goes on: those below the hardness. On a path,
    /// cells of the indentation that are at the hardness again flow when the load grows, and do not when it
    /// falls.
    pub(super) fn responding<'a>(&self, solved: &'a Solved) -> Responding<'a> {
        let bounds = self.problem.bounds;
        let mut responding = Responding::free(solved, bounds);
        let Some(memory) = &self.memory else { return responding };
        let decided = self.flowing_again(solved);
        if !decided.is_empty() {
            let rises = memory.rises_to(solved.p.iter().sum(), self.options.tolerance);
            let cells = &*responding.cells;
            let cells = if rises { cells.without(&decided) } else { cells.union(&decided) };
            responding = Responding { cells: Cow::Owned(cells), bounds, decided };
        }
        responding
    }

    /// On a path, the cells of the indentation whose pressure is the hardness, and which have flowed no
    /// further, within what the tolerance leaves open.
    pub(super) fn flowing_again(&self, solved: &Solved) -> CellSet {
        let Some(memory) = &self.memory else { return CellSet::default() };
        let (table, hardness) = (self.problem.operators.table(), self.problem.bounds.upper());
        let accuracy = self.options.tolerance * self.limits().height.unwrap_or(solved.d);
        let margin = 2.0 * accuracy / table.smallest_eigenvalue();
        let (left, grid) = (solved.gap_on(&solved.contact), self.problem.grid());
        let again: Vec<bool> = (solved.contact.index(grid).zip(&solved.p).zip(&left))
            .map(|((i, &p), &gap)| {
                memory.indentation[i] > 0.0 && p >= hardness - margin && gap >= -2.0 * accuracy
            })
            .collect();
        solved.contact.filter(&again, |again| again)
    }
}
