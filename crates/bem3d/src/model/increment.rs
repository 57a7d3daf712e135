//! Friction of a surface on its path: from the tangential load of a step to an increment, and from its tractions
//! to the tangential part of a state.

use super::load::ScaledTangential;
use super::options::{Bem3d, NAME};
use super::prepared::PreparedSurface;
use super::sliding::{Slid, SurfaceFriction};
use crate::active_set::{Candidates, Solved};
use crate::friction::{
    FrictionLimits, FrictionLoad, FrictionSolver, FrictionState, NotAdvanced, PressedCells, SlipMemory,
    SlipStep, TangentialControl,
};
use crate::geometry::CellSet;
use crate::response::TangentialStiffness;
use crate::response::tangential::{self, StiffnessOf};
use contact_model::{
    Error, Fields, Interrupted, Result, Status, StickSlip, Stop, Tangential, TangentialState,
};
use std::f64::consts::PI;
use std::sync::Arc;

/// Changes below this number of tolerances count as none: pressures that are solved anew differ by some.
const UNRESOLVED: f64 = 10.0;
/// Largest number of times that an increment is solved further for its stiffness.
pub(super) const TIGHTENINGS: usize = 4;

/// The cells of a state that press.
pub(super) fn pressed(solved: &Solved) -> PressedCells<'_> {
    PressedCells { cells: &solved.contact, pressure: &solved.p }
}

impl PreparedSurface {
    /// Resets to the surface without displacements under tractions, where the problems are coupled.
    pub(super) fn undeform(&mut self) {
        if let Some(sliding) = self.sliding.as_ref().filter(|sliding| sliding.is_coupled()) {
            self.problem.candidates = Candidates::new(self.problem.grid(), Arc::clone(&sliding.undeformed));
            self.problem.coarser = None;
        }
    }

    pub(super) fn friction_limits(&self) -> FrictionLimits {
        let Bem3d { tolerance, max_outer_iterations: iterations, .. } = self.options;
        FrictionLimits { tolerance, unresolved: UNRESOLVED * tolerance, iterations }
    }

    /// The increment of friction under a solved pressure; `None` without friction, and where the pressure was
    /// stopped.
    ///
    /// # Errors
    /// As [`Self::slide`].
    pub(super) fn slide_under(
        &mut self,
        solved: &Solved,
        load: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<Option<Slid>> {
        if solved.status == Status::Stopped { Ok(None) } else { self.slide(pressed(solved), load, stop) }
    }

    /// The increment of friction under a pressure; `None` without friction.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tangential force beyond the limit of friction.
    pub(super) fn slide(
        &mut self,
        contact: PressedCells<'_>,
        load: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<Option<Slid>> {
        let Some(mut sliding) = self.sliding.take() else { return Ok(None) };
        let slid = self.slide_by(&mut sliding, contact, load, stop);
        self.sliding = Some(sliding);
        slid.map(Some)
    }

    fn slide_by(
        &mut self,
        sliding: &mut SurfaceFriction,
        contact: PressedCells<'_>,
        ScaledTangential { control, prescribed }: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<Slid> {
        let SurfaceFriction { friction, law, before, relaxes, .. } = sliding;
        let relaxes = *relaxes;
        let (mut limits, tolerance) = (self.friction_limits(), self.options.tolerance);
        let work = friction.work();
        let load = FrictionLoad { law: *law, control };
        let first = friction.advance(SlipStep { before, contact, load, guess: None, relaxes }, limits, stop);
        let mut state = first.map_err(|error| self.not_advanced(control, error))?;
        // A stopped state has no stiffness.
        let mut stiffness = self.tangential_stiffness(friction, &state, stop).unwrap_or([None, None]);
        // The error of a stiffness by the cells that may stick or slip falls as the square root of the gap.
        for _ in 0..TIGHTENINGS {
            let error = branch_error(&stiffness);
            if error <= tolerance || state.status != Status::Converged || stop.stops() {
                break;
            }
            limits.tolerance = limits.tolerance.min(state.duality_gap) * further(tolerance / error);
            let guess = Some((contact.cells, &state.memory.traction[..]));
            let Ok(next) = friction.advance(SlipStep { before, contact, load, guess, relaxes }, limits, stop)
            else {
                break;
            };
            if next.duality_gap >= state.duality_gap {
                break;
            }
            state = next;
            stiffness = self.tangential_stiffness(friction, &state, stop).unwrap_or([None, None]);
        }
        self.count(work, friction.work());
        Ok(Slid { prescribed, state, stiffness, normal_stiffness: None, rounds: None })
    }

    /// The requested tangential stiffnesses; there is none for a periodic surface in full stick, which no
    /// force moves.
    pub(super) fn tangential_stiffness(
        &self,
        friction: &mut FrictionSolver,
        state: &FrictionState,
        stop: Stop<'_>,
    ) -> std::result::Result<[Option<TangentialStiffness>; 2], Interrupted> {
        let cells = &state.memory.cells;
        let (full, sticks) = (self.is_full(cells), state.stick.len() == cells.len());
        let asked = [
            (self.outputs.tangential_stiffness && !(full && sticks), StiffnessOf::Branch),
            (self.outputs.tangential_stiffness_stuck && !full, StiffnessOf::FullStick),
        ];
        let mut found = [None, None];
        for (found, (_, of)) in found.iter_mut().zip(asked).filter(|(_, (asked, _))| *asked) {
            *found = Some(tangential::solve(friction, state, of, self.options.tolerance, stop)?);
        }
        Ok(found)
    }

    /// Adds the work of friction to that of the load.
    pub(super) fn count(&mut self, [applications, solves]: [usize; 2], now: [usize; 2]) {
        self.problem.operators.plans.applications += now[0] - applications;
        self.problem.operators.plans.solves += now[1] - solves;
    }

    /// The error of a load without a state at its end.
    pub(super) fn not_advanced(&self, control: TangentialControl, error: NotAdvanced) -> Error {
        let NotAdvanced::Force { largest } = error else { return Interrupted.without_state() };
        let TangentialControl::Force([x, y]) = control else {
            return Error::unsupported(NAME, "a displacement that friction does not hold");
        };
        let unit = |force: f64| self.nondimensional.force(PI * force);
        match (unit(x.hypot(y)), unit(largest)) {
            (Ok(force), Ok(limit)) => Error::gross_slip(force, limit),
            (Err(error), _) | (_, Err(error)) => error,
        }
    }

    /// The tangential part without contact; `None` without friction.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tangential force, which no contact can carry.
    pub(super) fn slide_apart(&self, load: ScaledTangential) -> Result<Option<Slid>> {
        let Some(sliding) = &self.sliding else { return Ok(None) };
        let displacement = match load.control {
            TangentialControl::Displacement(displacement) => displacement,
            force @ TangentialControl::Force([x, y]) => {
                if x.hypot(y) > 0.0 {
                    return Err(self.not_advanced(force, NotAdvanced::Force { largest: 0.0 }));
                }
                sliding.before.displacement
            }
        };
        let state = FrictionState {
            memory: SlipMemory { displacement, ..SlipMemory::default() },
            limit: Vec::new(),
            slip: Vec::new(),
            force: [0.0; 2],
            dissipated: 0.0,
            stick: CellSet::default(),
            duality_gap: 0.0,
            load_error: 0.0,
            iterations: [0; 2],
            status: Status::Converged,
        };
        let nothing = |asked: bool| asked.then(TangentialStiffness::nothing);
        let stiffness =
            [self.outputs.tangential_stiffness, self.outputs.tangential_stiffness_stuck].map(nothing);
        Ok(Some(Slid { prescribed: load.prescribed, state, stiffness, normal_stiffness: None, rounds: None }))
    }

    /// Keeps an increment as the start of the next one.
    pub(super) fn remember_slip(&mut self, slid: Option<Slid>) {
        if let (Some(sliding), Some(Slid { state, .. })) = (&mut self.sliding, slid) {
            sliding.dissipated += state.dissipated;
            sliding.before = state.memory;
        }
    }

    /// The tangential part of a state in the units of the scene.
    pub(super) fn tangential(&self, slid: &Slid) -> Result<Option<TangentialState>> {
        let Some(sliding) = &self.sliding else { return Ok(None) };
        let (units, Slid { state, stiffness, .. }) = (self.nondimensional, slid);
        let signed = |value: f64, of: &dyn Fn(f64) -> Result<f64>| Ok(of(value.abs())?.copysign(value));
        let pair = |values: [f64; 2], of: &dyn Fn(f64) -> Result<f64>| -> Result<[f64; 2]> {
            Ok([signed(values[0], of)?, signed(values[1], of)?])
        };
        let force = |value: f64| units.force(PI * value);
        let length = |value: f64| units.approach(value);
        // What is prescribed is given back as it was.
        let (asked_force, asked_displacement) = match slid.prescribed {
            Tangential::Force(asked) => (Some(asked), None),
            Tangential::Displacement(asked) => (None, Some(asked)),
            _ => (None, None),
        };
        let found = TangentialState::new(
            asked_force.map_or_else(|| pair(state.force, &force), Ok)?,
            asked_displacement.map_or_else(|| pair(state.memory.displacement, &length), Ok)?,
        );
        let matrix = |k: &TangentialStiffness| -> Result<[[f64; 2]; 2]> {
            let of = |value: f64| signed(PI * value, &|k| units.stiffness(k));
            let [xx, yy, xy] = k.value;
            let (xx, yy, xy) = (of(xx)?, of(yy)?, of(xy)?);
            Ok([[xx, xy], [xy, yy]])
        };
        let [branch, stuck] = stiffness.each_ref().map(|k| k.as_ref().map(matrix).transpose());
        let areas = self.outputs.stick_area.then(|| -> Result<(f64, f64)> {
            let area = |cells: &CellSet| sliding.area(cells, &state.memory);
            let (stick, all) = (area(&state.stick), area(&state.memory.cells));
            Ok((units.area(stick)?, units.area((all - stick).max(0.0))?))
        });
        let (stick, slip) = areas.transpose()?.unzip();
        Ok(Some(
            found
                .with_sliding_force(force(state.limit.iter().sum())?)
                .with_areas(stick, slip)
                .with_stiffness(branch?)
                .with_stiffness_stuck(stuck?)
                .with_dissipated(length(force((sliding.dissipated + state.dissipated).max(0.0))?)?),
        ))
    }

    /// Adds the requested fields of an increment.
    pub(super) fn slip_fields(&self, slid: &Slid, fields: &mut Fields) -> Result<()> {
        let (grid, Slid { state, .. }) = (self.problem.grid(), slid);
        let cells = &state.memory.cells;
        let components = |values: &[f64], of: &dyn Fn(f64) -> Result<f64>| {
            let mut whole = [vec![0.0; grid.count()], vec![0.0; grid.count()]];
            for (whole, values) in whole.iter_mut().zip(values.chunks_exact(cells.len().max(1))) {
                for (i, value) in cells.index(grid).zip(values) {
                    whole[i] = of(value.abs())?.copysign(*value);
                }
            }
            let [x, y] = whole;
            Ok([self.field(x)?, self.field(y)?])
        };
        if self.outputs.traction {
            let pressure = |value: f64| self.nondimensional.pressure(PI * value);
            fields.traction = Some(components(&state.memory.traction, &pressure)?);
        }
        if self.outputs.slip {
            fields.slip = Some(components(&state.memory.slip, &|value| self.nondimensional.approach(value))?);
        }
        if self.outputs.stick_slip {
            let mut classes = vec![StickSlip::Open.value(); grid.count()];
            cells.index(grid).for_each(|i| classes[i] = StickSlip::Slip.value());
            state.stick.index(grid).for_each(|i| classes[i] = StickSlip::Stick.value());
            fields.stick_slip = Some(self.field(classes)?);
        }
        Ok(())
    }
}

/// The relative error of the stiffness along the branch; 0 where none was asked for.
pub(super) fn branch_error(stiffness: &[Option<TangentialStiffness>; 2]) -> f64 {
    stiffness[0].as_ref().map_or(0.0, TangentialStiffness::error)
}

/// The factor by which a duality gap is to fall for an error of the stiffness to fall by `factor`.
pub(super) fn further(factor: f64) -> f64 {
    (0.5 * factor).powi(2).clamp(1e-4, 0.1)
}
