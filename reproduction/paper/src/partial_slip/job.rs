//! One surface with one boundary, as a job that is stored.

use super::study::{
    AMPLITUDES, COEFFICIENT, PartialSlipStudy, SHARES, SlipCase, SlipPoint, SlippedSurface, SurfaceSlips,
    mindlin,
};
use crate::evaluation::Discretisation;
use bem3d::Bem3d;
use contact_model::{
    ContactModel, ContactState, Error as ModelError, Load, Outputs, PreparedContact, Step, Stop, Tangential,
};
use mdr1d::Equivalent;
use runs::{Error, Job, Result, ResultKind};
use std::sync::Arc;

/// Number of the format of stored results. Raise it when [`SurfaceSlips`] changes, or the meaning of its numbers.
const FORMAT: u32 = 1;

/// One surface with one boundary under all loads, for all Poisson's ratios.
#[derive(Debug, Clone)]
pub(super) struct SlipJob {
    pub(super) study: Arc<PartialSlipStudy>,
    pub(super) case: SlipCase,
    pub(super) seed: u64,
}

/// Tolerance of the stiffness along the branch.
const STIFFNESS_TOLERANCE: f64 = 1e-3;

/// Both components of the traction at each share, along each direction.
type ShareTractions = [Vec<[Vec<f64>; 2]>; 2];

/// Directions of the force, along x and along y: in the mean of both, the anisotropy of a surface enters only
/// with its square.
pub(super) const DIRECTIONS: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// The normal load of a surface, and the unit of its displacements.
#[derive(Clone, Copy)]
pub(super) struct PressedSurface {
    pub(super) force: f64,
    pub(super) displacement: f64,
}

impl PressedSurface {
    pub(super) fn step(self, share: f64, direction: [f64; 2]) -> Step {
        let tangential = Tangential::Force(direction.map(|e| share * COEFFICIENT * self.force * e));
        Step::new(0.0, Load::force(self.force).with_tangential(tangential))
    }

    /// The energy of a cycle between both ends, after the first loading.
    fn dissipated(
        self,
        contact: &mut dyn PreparedContact,
        direction: [f64; 2],
        (amplitude, increments): (f64, usize),
        stop: Stop<'_>,
    ) -> Result<f64, ModelError> {
        contact.restart();
        contact.advance_until(self.step(0.0, direction), stop)?;
        let mut go = |from: f64, to: f64, count: usize| {
            let mut dissipated = 0.0;
            for i in 1..=count {
                let share = amplitude * (from + (to - from) * i as f64 / count as f64);
                let state = contact.advance_until(self.step(share, direction), stop)?;
                dissipated = state.tangential.map_or(0.0, |t| t.dissipated);
            }
            Ok::<f64, ModelError>(dissipated)
        };
        let first = go(0.0, 1.0, increments)?;
        go(1.0, -1.0, 2 * increments)?;
        let cycle = go(-1.0, 1.0, 2 * increments)? - first;
        Ok(cycle / (COEFFICIENT * self.force * self.displacement))
    }
}

impl SlipJob {
    fn discretisation(&self) -> Discretisation {
        Discretisation::Bem3d { cells: self.study.cells, tolerance: self.study.tolerance }
    }

    fn model(&self) -> Bem3d {
        Bem3d { cells: self.study.cells, tolerance: self.study.tolerance, ..Bem3d::default() }
    }

    fn prepare(
        &self,
        model: &dyn ContactModel,
        poisson: f64,
        outputs: Outputs,
    ) -> Result<Box<dyn PreparedContact>> {
        let scene = self.case.scene(&self.study, poisson, outputs)?;
        model.prepare(&scene, self.seed).map_err(Error::model(self.name()))
    }

    /// Solves one load with one Poisson's ratio. The tractions of the first ratio are stored, and those of
    /// the others are compared with them.
    fn slipped(
        &self,
        [pressed, sliding, cycling, yielding]: [&mut (dyn PreparedContact + 'static); 4],
        (force, poisson): (f64, f64),
        without: &mut ShareTractions,
        stop: Stop<'_>,
    ) -> Result<SlippedSurface, ModelError> {
        pressed.restart();
        let start = pressed.advance_until(Step::new(0.0, Load::force(force)), stop)?;
        let stuck = start.tangential.and_then(|t| t.stiffness_stuck);
        let (Some(normal), Some(stuck), Some(area)) = (start.stiffness, stuck, start.area) else {
            return Err(ModelError::unsupported(self.model().name(), "a contact without a stiffness"));
        };
        let contact_cells = start.report.contact_cells.unwrap_or(0);
        let mut slipped = SlippedSurface {
            contact: area,
            contact_cells,
            stiffness: [stuck[0][0], stuck[1][1], stuck[0][1]].map(|k| k / normal),
            points: Vec::new(),
            dissipated: Vec::new(),
        };
        let Some(approach) = start.approach.filter(|_| self.case.is_free()) else { return Ok(slipped) };
        let load = PressedSurface { force, displacement: COEFFICIENT * approach / mindlin(poisson) };
        let (mut points, mut dissipated) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
        let reference = poisson.abs() <= 0.0;
        for (which, direction) in DIRECTIONS.into_iter().enumerate() {
            let k0 = stuck[which][which];
            if reference {
                without[which].clear();
            }
            sliding.restart();
            sliding.advance_until(load.step(0.0, direction), stop)?;
            let stiffness = stiffness(yielding, load, which, stop)?;
            for (i, share) in SHARES.into_iter().enumerate() {
                let state = sliding.advance_until(load.step(share, direction), stop)?;
                let Some(tangential) = state.tangential else { continue };
                let traction = traction(&state);
                if reference {
                    without[which].push(traction.clone());
                }
                let difference = without[which].get(i).map(|of| rms(&traction, of, contact_cells));
                let mean = COEFFICIENT * force / area;
                points[which].push(SlipPoint {
                    displacement: tangential.displacement[which] / load.displacement,
                    stick: tangential.stick_area.unwrap_or(0.0) / area,
                    stiffness: stiffness[i].map(|k| k / k0),
                    traction: difference.map(|of| of / mean),
                });
            }
            for amplitude in AMPLITUDES {
                let size = (amplitude, self.study.increments);
                dissipated[which].push(load.dissipated(cycling, direction, size, stop)?);
            }
        }
        let [x, y] = points;
        slipped.points = x.into_iter().zip(y).map(|(x, y)| x.mean(y)).collect();
        let [x, y] = dissipated;
        slipped.dissipated = x.into_iter().zip(y).map(|(x, y)| 0.5 * (x + y)).collect();
        Ok(slipped)
    }

    /// The equivalent profile of bodies with Poisson's ratio 0; in these units it is the same for all ratios.
    fn equivalent(
        contact: &mut dyn PreparedContact,
        force: f64,
        stop: Stop<'_>,
    ) -> Result<(Vec<SlipPoint>, Vec<f64>), ModelError> {
        contact.restart();
        let start = contact.advance_until(Step::new(0.0, Load::force(force)), stop)?;
        let (Some(approach), Some(radius)) = (start.approach, start.contact_radius) else {
            return Err(ModelError::unsupported("equivalent", "a contact without a radius"));
        };
        let load = PressedSurface { force, displacement: COEFFICIENT * approach };
        let mut points = Vec::new();
        for share in SHARES {
            let state = contact.advance_until(load.step(share, DIRECTIONS[0]), stop)?;
            let Some(tangential) = state.tangential else { continue };
            points.push(SlipPoint {
                displacement: tangential.displacement[0] / load.displacement,
                stick: (tangential.stick_radius.unwrap_or(0.0) / radius).powi(2),
                stiffness: None,
                traction: None,
            });
        }
        let loops = AMPLITUDES.map(|amplitude| load.dissipated(contact, DIRECTIONS[0], (amplitude, 1), stop));
        Ok((points, loops.into_iter().collect::<Result<_, _>>()?))
    }
}

/// Stiffness along the branch at each share; `None` where it does not meet its tolerance, because it jumps
/// where a cell begins to slip.
fn stiffness(
    contact: &mut dyn PreparedContact,
    load: PressedSurface,
    which: usize,
    stop: Stop<'_>,
) -> Result<[Option<f64>; SHARES.len()], ModelError> {
    contact.restart();
    contact.advance_until(load.step(0.0, DIRECTIONS[which]), stop)?;
    let mut all = [None; SHARES.len()];
    for (found, share) in all.iter_mut().zip(SHARES) {
        let state = converged(contact.advance_until(load.step(share, DIRECTIONS[which]), stop))?;
        *found = state.and_then(|s| Some(s.tangential?.stiffness?[which][which]));
    }
    Ok(all)
}

/// Both components of the traction.
fn traction(state: &ContactState) -> [Vec<f64>; 2] {
    let field = state.fields.as_ref().and_then(|fields| fields.traction.as_ref());
    field.map_or_else(Default::default, |of| of.each_ref().map(|c| c.values().to_vec()))
}

/// Root mean square over this number of cells of the difference of two tractions.
fn rms(a: &[Vec<f64>; 2], b: &[Vec<f64>; 2], cells: usize) -> f64 {
    let squares = a.iter().zip(b).flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)));
    (analysis::sum(squares) / cells.max(1) as f64).sqrt()
}

/// `None` for a state that missed its tolerance.
pub(super) fn converged<T>(solved: Result<T, ModelError>) -> Result<Option<T>, ModelError> {
    match solved {
        Ok(solved) => Ok(Some(solved)),
        Err(ModelError::NotConverged { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

impl Job for SlipJob {
    type Output = SurfaceSlips;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("partial slip", FORMAT);

    fn key(&self) -> String {
        let Self { study, case, seed } = self;
        format!(
            "model bem3d\nmodel_format {}\ncells {}\ncells_per_wave {}\ntolerance {:?}\nboundary {:?}\n\
             fractal_dimension {:?}\nseed {seed}\nforce_bar {}\npoisson {}\nincrements {}\n",
            bem3d::FORMAT,
            study.cells,
            study.cells_per_wave,
            study.tolerance,
            case.boundary,
            case.fractal_dimension,
            crate::evaluation::list(study.forces.values()),
            crate::evaluation::list(&study.poissons),
            study.increments,
        )
    }

    fn name(&self) -> String {
        format!("{}, {} cells a side, seed {}", self.case.label(), self.study.cells, self.seed)
    }

    // An increment takes about 15 ms with 128 cells a side.
    fn cost(&self) -> u64 {
        let study = &self.study;
        let loops = AMPLITUDES.len() * 5 * study.increments;
        let increments = if self.case.is_free() { 2 * (SHARES.len() + loops) } else { 2 };
        let cells = (study.cells as f64 / 128.0).powi(2);
        let states = study.forces.values().len() * study.poissons.len() * increments;
        (15.0 * cells * states as f64).max(1.0) as u64
    }

    // Four contacts for each Poisson's ratio, each with the kernel of the tractions beside that of pressures.
    fn memory(&self) -> f64 {
        10.0 * self.study.poissons.len() as f64 * self.discretisation().memory()
    }

    fn stored_bytes(&self) -> u64 {
        let states = self.study.forces.values().len() * (self.study.poissons.len() + 1);
        1000 + 2000 * states as u64
    }

    fn solve(&self, stop: Stop<'_>) -> Result<SurfaceSlips> {
        let study = &self.study;
        let none_of_them = Outputs { stiffness: false, ..Outputs::default() };
        let of_pressed =
            Outputs { stiffness: true, area: true, tangential_stiffness_stuck: true, ..none_of_them };
        let of_sliding = Outputs { stick_area: true, traction: true, ..none_of_them };
        let of_yielding = Outputs { tangential_stiffness: true, ..none_of_them };
        let model = self.model();
        let loose = Bem3d { tolerance: STIFFNESS_TOLERANCE.max(study.tolerance), ..model };
        let prepare = |model: Bem3d, outputs: Outputs| {
            let each = study.poissons.iter().map(move |nu| self.prepare(&model, *nu, outputs));
            each.collect::<Result<Vec<_>>>()
        };
        let mut contacts = [
            prepare(model, of_pressed)?,
            prepare(model, of_sliding)?,
            prepare(model, none_of_them)?,
            prepare(loose, of_yielding)?,
        ];
        let mut profile = if self.case.is_free() {
            Some(self.prepare(&Equivalent::new(model), 0.0, none_of_them)?)
        } else {
            None
        };
        let mut all = SurfaceSlips { solved: Vec::new(), equivalent: Vec::new() };
        let mut solve = || {
            let normalisation = contacts[0][0].normalisation();
            for force_bar in study.forces.values() {
                let force = normalisation.force(*force_bar)?;
                let mut without = ShareTractions::default();
                for (i, nu) in study.poissons.iter().enumerate() {
                    let of_ratio = contacts.each_mut().map(|of| &mut *of[i]);
                    let solved = self.slipped(of_ratio, (force, *nu), &mut without, stop);
                    all.solved.push(converged(solved)?);
                }
                if let Some(profile) = &mut profile {
                    all.equivalent.push(converged(Self::equivalent(&mut **profile, force, stop))?);
                }
            }
            Ok(())
        };
        solve().map_err(Error::model(self.name()))?;
        Ok(all)
    }

    fn is_whole(&self, all: &SurfaceSlips) -> bool {
        let (forces, ratios) = (self.study.forces.values().len(), self.study.poissons.len());
        all.solved.len() == forces * ratios
            && all.equivalent.len() == if self.case.is_free() { forces } else { 0 }
    }
}
