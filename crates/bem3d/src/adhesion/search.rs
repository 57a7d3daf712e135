//! Equilibrium of contact pressure and attraction at one load: the attraction lags, the contact follows.
//!
//! With the attraction s given, the pressure of the contact solves an elastic contact problem of the gaps
//! `z - G s`; then `s <- s(g)`. Where G on every set is an inverse M-matrix this map of s is monotone: more
//! attraction here closes gaps everywhere, and never opens one. From a state whose load has risen it rises to
//! the nearest equilibrium above, from one whose load has fallen it falls to the nearest one below: the
//! branches of approach and withdrawal. Fronts of a short range would move by a cell or so in an update; they
//! are followed further at once ([`super::relaxation`]). The derivative of the map is `D^(1/2) G^ D^(1/2)` up
//! to similarity, D the slopes of the law on open cells and G^ the compliance of the open cells with the
//! contact kept closed, so that it contracts exactly where the energy has a minimum.

use super::attraction::Attraction;
use super::equilibrium::{AdhesiveControl, Equilibrium};
use super::law::LawShape;
use super::update::{SETTLED, UpdateProgress, Updated, Updates};
use crate::active_set::{
    self, Bounds, Candidates, ContactGap, Control, Guess, Limits, Problem, Residuals, Solved,
};
use crate::geometry::CellSet;
use crate::real::{each, largest_difference, smallest, sum};
use contact_model::{Interrupted, Status, Stop};
use std::sync::Arc;

// Half and twice the value of `UPDATES`, `AHEAD` and `FIRST` change the work by less than 1 % (34 paths with 65
// cells a side, at a tolerance of 1e-5). `BETWEEN` and `MOST_ACCURATE` act under a hardness only, where they
// were not varied.

/// Updates for each outer iteration allowed: the plain iteration contracts by the spectral radius only.
const UPDATES: usize = 20;
/// How far above the reach cells are still included, in ranges, so that small changes of the load keep the
/// set.
const AHEAD: f64 = 0.5;
/// Tolerance of the elastic contact that a first load begins with.
const FIRST: f64 = 1e-2;
/// Where the pressure has an upper bound, the contact under an attraction is solved to this share of what is left of
/// the state.
const BETWEEN: f64 = 0.1;
/// Smallest such share.
const MOST_ACCURATE: f64 = 1e-7;

/// Why a search ended without a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// For the same reason as in the elastic solver.
    Status(Status),
    /// The attraction cannot hold the force.
    PulledOff,
    /// It was stopped, and the state has no gap.
    Interrupted,
}

/// A search for the equilibrium at one load.
#[derive(Debug)]
pub struct Search<'a> {
    /// The surface.
    pub problem: &'a mut Problem,
    /// The attraction.
    pub attraction: &'a Attraction,
    /// The load.
    pub control: AdhesiveControl,
    /// Tolerance and length of the certificate.
    pub limits: Limits,
    /// Whether the plain iteration alone may be used.
    pub plain: bool,
}

impl Search<'_> {
    /// The elastic state of the load without attraction, where the load presses: where a first load begins.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn first(&mut self, stop: Stop<'_>) -> Result<Equilibrium, Interrupted> {
        let first = self.problem.candidates.range().first;
        let target = match self.control {
            AdhesiveControl::Force(f) if f > 0.0 => Control::Force(f),
            // Of a periodic surface the approach under which the plane begins.
            AdhesiveControl::Plane(plane) if plane > first => Control::Approach(plane),
            AdhesiveControl::Force(_) => return Ok(Equilibrium { d: first, ..Equilibrium::default() }),
            AdhesiveControl::Plane(d) => return Ok(Equilibrium { d, ..Equilibrium::default() }),
        };
        let limits = Limits { tolerance: FIRST, ..self.limits };
        // Without its attraction it is no state of the load.
        let unheard = || stop.stops();
        let guess = active_set::cold_start(self.problem, target, limits, &unheard)?;
        let solved = active_set::solve(self.problem, target, guess, limits, &unheard)?;
        let reach = solved.d + self.attraction.law.reach();
        let cells = self.problem.candidates.below(reach).union(&solved.contact);
        let pressure = cells.carry(&solved.contact, &solved.p);
        let zeros = vec![0.0; cells.len()];
        let (attraction, gap) = (zeros.clone(), zeros);
        let steps = solved.steps;
        let d = solved.d;
        Ok(Equilibrium { d, cells, reach, pressure, attraction, gap, steps, ..Equilibrium::default() })
    }

    /// Iterates from a state to the equilibrium of the load.
    ///
    /// # Errors
    /// Why it ended without one, with the state reached.
    pub fn from(
        &mut self,
        mut state: Equilibrium,
        stop: Stop<'_>,
    ) -> Result<Equilibrium, Box<(Ended, Equilibrium)>> {
        let tolerance = self.limits.tolerance;
        let (mut progress, mut accuracy) = (UpdateProgress::default(), BETWEEN);
        if self.evaluate(&mut state, stop).is_err() {
            return Err(Box::new((Ended::Interrupted, state)));
        }
        for _ in 0..self.limits.outer_iterations * UPDATES {
            let worst = state.residuals.worst().max(state.mismatch).max(self.load_error(&state));
            stop.residual(worst, tolerance);
            if worst <= tolerance {
                return Ok(state);
            }
            if stop.stops() {
                return Err(Box::new((Ended::Status(Status::Stopped), state)));
            }
            let updated = if self.problem.bounds == Bounds::Unlimited {
                let Self { problem, attraction, control, limits, plain } = self;
                let (control, tolerance, plain) = (*control, limits.tolerance, *plain);
                let mut updates = Updates { problem, attraction, control, tolerance, plain };
                updates.update(&mut state, &mut progress, stop)
            } else {
                self.update_between_bounds(&mut state, worst, &mut accuracy, stop)
            };
            match updated {
                Ok(Updated::Taken) => {}
                Ok(Updated::PulledOff) => return Err(Box::new((Ended::PulledOff, state))),
                // The state is that of the evaluation before.
                Err(Interrupted) => return Err(Box::new((Ended::Status(Status::Stopped), state))),
            }
            if self.evaluate(&mut state, stop).is_err() {
                return Err(Box::new((Ended::Interrupted, state)));
            }
            state.updates += 1;
        }
        Err(Box::new((Ended::Status(Status::IterationLimit), state)))
    }

    /// One update where the pressure has an upper bound: the attraction of the present gaps, where these are those
    /// of a contact, and then the whole contact under it.
    ///
    /// More attraction still closes gaps everywhere, so that this plain iteration follows the branches as it does
    /// without a bound. The other updates stay on them because gaps are convex in the attraction, which a bound
    /// ends.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; the state is then as it was.
    ///
    /// Cost: a solve of the contact, which becomes more accurate as the attraction comes to rest.
    fn update_between_bounds(
        &mut self,
        state: &mut Equilibrium,
        worst: f64,
        accuracy: &mut f64,
        stop: Stop<'_>,
    ) -> Result<Updated, Interrupted> {
        let (range, before) = (self.attraction.law.range, state.clone());
        let left = state.largest_gap_left(self.problem.bounds);
        // A gap that is wrong by a share of the range changes the attraction by as much. The tolerance of a contact
        // allows larger gaps where the pressure is small. Gaps that keep the attraction from being updated are always
        // too large: otherwise neither they nor the attraction would change any more.
        let misses = left > (BETWEEN * worst).min(SETTLED) * range;
        // As long as the contact can be solved more accurately, the attraction waits for its gaps: both could change
        // in turn for ever.
        let waits = left > SETTLED * range || misses && *accuracy > MOST_ACCURATE;
        if !waits {
            state.attraction.clone_from(&state.lawful);
        }
        if let AdhesiveControl::Force(asked) = self.control
            && asked + sum(&state.attraction) <= 0.0
        {
            return Ok(Updated::PulledOff);
        }
        let length = self.limits.height.unwrap_or_else(|| state.d.abs().max(range));
        let wanted = worst.min(SETTLED).max(self.limits.tolerance);
        *accuracy = if misses { (BETWEEN * *accuracy).max(MOST_ACCURATE) } else { *accuracy };
        let tolerance = *accuracy * wanted * (range / length).min(1.0);
        let contact = state.contact();
        let p = contact.carry(&state.cells, &state.pressure);
        let guess = (!contact.is_empty()).then_some(Guess { set: contact, p, d: state.d });
        let solved = self.contact_under(state, guess, tolerance, stop);
        if solved.is_err() || stop.stops() {
            *state = before;
            return Err(Interrupted);
        }
        Ok(Updated::Taken)
    }

    /// Where a load begins that follows a smaller one on the branch of approach: with the attraction of that
    /// state, which lies below the one to come. Under a prescribed force its contact is brought to the force by
    /// the updates; under an approach it is solved anew, as the step of the plane is no pressure.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn continued(&mut self, last: &Equilibrium, stop: Stop<'_>) -> Result<Equilibrium, Interrupted> {
        let mut state = last.again();
        if let AdhesiveControl::Plane(_) = self.control {
            self.contact_under(&mut state, None, FIRST, stop)?;
        }
        Ok(state)
    }

    /// The contact under the present attraction: the problem of the gaps `z - G s` without attraction, from a guess
    /// or by nested iteration.
    fn contact_under(
        &mut self,
        state: &mut Equilibrium,
        guess: Option<Guess>,
        tolerance: f64,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let grid = self.problem.grid();
        let mut lifted = Vec::new();
        self.problem.operators.exact(
            &state.cells,
            &state.attraction,
            &CellSet::all(grid),
            &mut lifted,
            stop,
        )?;
        lifted.iter_mut().zip(self.problem.candidates.z()).for_each(|(u, z)| *u = z - *u);
        // The plane of first touch is that of these gaps.
        let first = smallest(&lifted);
        // Under an upper bound of the pressure the mean plane is held, elsewhere it is a first guess.
        let shift = self.problem.operators.table().shift();
        let holds_plane = shift > 0.0 && self.problem.bounds != Bounds::Unlimited;
        let pulled = sum(&state.attraction);
        let target = match self.control {
            AdhesiveControl::Force(asked) => Control::Force(asked + pulled),
            AdhesiveControl::Plane(plane) if holds_plane => Control::Approach(plane - first - shift * pulled),
            AdhesiveControl::Plane(plane) => Control::Approach(plane - first),
        };
        let (Control::Force(load) | Control::Approach(load)) = target;
        if load <= 0.0 {
            // The plane does not reach the surface, which an indentation may have lowered.
            if self.problem.bounds != Bounds::Unlimited {
                state.pressure.fill(0.0);
            }
            return Ok(());
        }
        each(&mut lifted, |z| *z -= first);
        let lifted = Candidates::new(grid, Arc::new(lifted));
        let candidates = std::mem::replace(&mut self.problem.candidates, lifted);
        let coarser = self.problem.coarser.take();
        let limits = Limits { tolerance, ..self.limits };
        // A contact under an attraction that is not its own yet.
        let unheard = || stop.stops();
        let guess = match guess {
            Some(guess) => Ok(Guess { d: guess.d - first, ..guess }),
            None => active_set::cold_start(self.problem, target, limits, &unheard),
        };
        let solved = guess.and_then(|guess| match target {
            Control::Approach(plane) if holds_plane => self.contact_at_plane(plane, guess, limits, &unheard),
            target => active_set::solve(self.problem, target, guess, limits, &unheard),
        });
        (self.problem.candidates, self.problem.coarser) = (candidates, coarser);
        let solved = solved?;
        let cells = state.cells.union(&solved.contact);
        state.take_cells(cells, state.reach);
        state.pressure = state.cells.carry(&solved.contact, &solved.p);
        state.d = solved.d + first;
        state.steps += solved.steps;
        Ok(())
    }

    /// The contact at a mean plane, which is the approach less the displacement by the constant in the kernel. The
    /// plane rises with the approach, but more slowly.
    ///
    /// Cost: some five solves of the contact, each from the one before.
    fn contact_at_plane(
        &mut self,
        plane: f64,
        guess: Guess,
        limits: Limits,
        stop: Stop<'_>,
    ) -> Result<Solved, Interrupted> {
        let shift = self.problem.operators.table().shift();
        let length = limits.height.unwrap_or(plane);
        let (mut low, mut high) = (plane, f64::INFINITY);
        let mut before = None;
        let mut guess = Guess { d: guess.d.max(plane), ..guess };
        let mut steps = 0;
        loop {
            let d = guess.d;
            let mut solved = active_set::solve(self.problem, Control::Approach(d), guess, limits, stop)?;
            steps += solved.steps;
            let miss = d - shift * sum(&solved.p) - plane;
            *(if miss > 0.0 { &mut high } else { &mut low }) = d;
            // The approach has to move by the miss at least.
            let slope = before.map_or(1.0, |(at, missed)| (miss - missed) / (d - at));
            let next = d - miss / slope;
            let next = match next > low && next < high {
                true => next,
                false if high.is_finite() => f64::midpoint(low, high),
                false => d - 2.0 * miss,
            };
            let is_met = miss.abs() <= limits.tolerance * length;
            let is_narrow = next <= low || next >= high;
            if is_met || is_narrow || !next.is_finite() || stop.stops() {
                solved.steps = steps;
                return Ok(solved);
            }
            before = Some((d, miss));
            guess = Guess { set: solved.contact, p: solved.p, d: next };
        }
    }

    /// How far the force of a state is from the one prescribed, relative to [`Equilibrium::force_scale`].
    pub fn load_error(&self, state: &Equilibrium) -> f64 {
        let AdhesiveControl::Force(asked) = self.control else { return 0.0 };
        let miss = (state.force() - asked).abs();
        if miss > 0.0 { miss / state.force_scale(asked) } else { 0.0 }
    }

    /// Evaluates the gap with the exact operator on all cells within reach, and how far the state is from an
    /// equilibrium.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; the gap is then undefined.
    fn evaluate(&mut self, state: &mut Equilibrium, stop: Stop<'_>) -> Result<(), Interrupted> {
        self.evaluate_gap(state, stop)?;
        self.measure(state);
        Ok(())
    }

    fn evaluate_gap(&mut self, state: &mut Equilibrium, stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { problem, attraction, control, .. } = self;
        let law = attraction.law;
        let shift = problem.operators.table().shift();
        if let AdhesiveControl::Plane(plane) = *control {
            state.d = plane + shift * state.force();
        }
        if state.reach < state.d + law.reach() {
            let reach = state.d + law.reach() + AHEAD * law.range;
            state.take_cells(problem.candidates.below(reach).union(&state.contact()), reach);
        }
        loop {
            let net = state.net();
            problem.operators.exact(&state.cells, &net, &state.cells, &mut state.gap, stop)?;
            let lowest = smallest(&state.gap).min(0.0);
            problem.candidates.add_to(&state.cells, &mut state.gap);
            let force = sum(&state.pressure);
            match *control {
                AdhesiveControl::Plane(plane) => state.d = plane + shift * sum(&net),
                AdhesiveControl::Force(_) if force > 0.0 && problem.bounds.is_reached(&state.pressure) => {
                    let contact = state.contact();
                    let on_contact = |values: &[f64]| contact.carry(&state.cells, values);
                    let (p, left) = (on_contact(&state.pressure), on_contact(&state.gap));
                    state.d = problem.bounds.approach(&p, &left, &state.gap).unwrap_or(state.d);
                }
                AdhesiveControl::Force(_) if force > 0.0 => {
                    state.d = state.pressure.iter().zip(&state.gap).map(|(p, g)| p / force * g).sum();
                }
                // No cell is in contact yet: the plane moves to the highest point.
                AdhesiveControl::Force(_) if !state.gap.is_empty() => state.d = smallest(&state.gap),
                AdhesiveControl::Force(_) => {}
            }
            let d = state.d;
            each(&mut state.gap, |g| *g -= d);
            // The attraction displaces no cell outside by more than the largest displacement inside.
            let reach = d + law.reach() - lowest;
            if reach <= state.reach {
                break;
            }
            let reach = reach + AHEAD * law.range;
            let cells = problem.candidates.below(reach).union(&state.cells);
            let before = state.cells.len();
            state.take_cells(cells, reach);
            if state.cells.len() == before {
                break;
            }
        }
        Ok(())
    }

    /// Residuals and mismatch of a state whose gap is evaluated.
    fn measure(&self, state: &mut Equilibrium) {
        let Self { attraction, limits, .. } = self;
        let law = attraction.law;
        let contact = state.contact();
        let (p, left) =
            (contact.carry(&state.cells, &state.pressure), contact.carry(&state.cells, &state.gap));
        let length = limits.height.unwrap_or_else(|| state.d.abs().max(law.range));
        let under = ContactGap { contact: &contact, left: &left, checked: &state.cells, gap: &state.gap };
        state.residuals = Residuals::measure(self.problem.bounds, &p, under, length);
        state.lawful = attraction.tractions(&state.cells, &state.gap);
        state.mismatch = match law.shape {
            LawShape::Uniform => attraction.mismatch(&state.cells, &state.attraction, &state.gap),
            _ => largest_difference(&state.attraction, &state.lawful) / law.peak,
        };
    }
}
