//! Assembles the returned state from a solution, in the same way for all effects.

use super::certificate::LoadError;
use super::load::ScaledTangential;
use super::prepared::{PreparedSurface, Tangent};
use super::sliding::Slid;
use crate::active_set::{Bounds, CERTIFIED_NS, Solved};
use crate::geometry::{CellSet, Grid};
use crate::response::NormalStiffness;
use contact_model::{
    AdhesiveState, Boundary, Certificate, ContactResolution, ContactState, Error, Field, Fields, Interrupted,
    Patches, PlasticState, Result, SolveReport, Status, Stop, WholeLayer, Work, check_stop, never,
};
use std::f64::consts::PI;

/// The part of a state that the normal load determines, in the units of the surface; forces are over pi.
#[derive(Debug)]
pub(super) struct NormalSolution<'a> {
    /// How the solve ended.
    pub status: Status,
    /// How it was found, in one short phrase.
    pub strategy: String,
    /// Steps of conjugate gradients.
    pub iterations: usize,
    /// Its certificate.
    pub certificate: Certificate,
    /// Sum of the net pressure.
    pub force: f64,
    /// Approach under the kernel with its constant.
    pub d: f64,
    /// Whether it is complete contact, which has no gap.
    pub complete: bool,
    /// The contact set.
    pub contact: &'a CellSet,
    /// Cells with their net pressure.
    pub pressure: (&'a CellSet, &'a [f64]),
    /// Cells with the depth of their new indentation.
    pub indented: (&'a CellSet, &'a [f64]),
    /// Number of cells at the hardness.
    pub yielded: usize,
    /// Contact area, in cells.
    pub area: f64,
    /// Stiffness along the branch.
    pub stiffness: Option<f64>,
    /// Stiffness at a fixed contact area.
    pub fixed_area: Option<f64>,
    /// The part of adhesion.
    pub adhesive: Option<AdhesiveState>,
    /// How well the cells resolve the contact.
    pub resolution: Option<ContactResolution>,
}

/// The state as a result: an error with the state in it unless it has converged.
pub(super) fn returned(state: ContactState) -> Result<ContactState> {
    match state.report.status {
        Status::Converged => Ok(state),
        Status::Stopped => Err(Error::Stopped { best: Some(Box::new(state)) }),
        _ => Err(Error::NotConverged { best: Box::new(state) }),
    }
}

impl PreparedSurface {
    /// The state of a normal solution and of the increment of friction under it, and that increment: with the
    /// certificate of both, and without what a stop has left unfinished.
    pub(super) fn assess(
        &mut self,
        mut normal: NormalSolution<'_>,
        mut slid: Option<Slid>,
        stop: Stop<'_>,
    ) -> Result<(ContactState, Option<Slid>)> {
        if let Some(slid) = &slid {
            slid.certify(&mut normal.certificate);
            normal.strategy = format!("{}; {}", normal.strategy, slid.strategy());
            normal.iterations += slid.steps();
        }
        if self.memory.is_some() && !normal.certificate.meets(self.options.tolerance) {
            let rest = Certificate { stiffness_error: None, ..normal.certificate };
            if rest.meets(self.options.tolerance) {
                // It is not known which cells flow: the stiffness jumps nearby.
                normal = NormalSolution { certificate: rest, stiffness: None, fixed_area: None, ..normal };
            }
        }
        normal.status = self.ended(normal.status, &normal.certificate, stop);
        if normal.status == Status::Stopped {
            // The stiffnesses, and the error that follows from one, may be unfinished.
            (normal.stiffness, normal.fixed_area) = (None, None);
            let of = &mut normal.certificate;
            (of.stiffness_error, of.quotient_error) = (None, None);
            (of.force_error, of.tangential_stiffness_error) = (None, None);
            slid = slid.map(|slid| Slid { stiffness: [None, None], normal_stiffness: None, ..slid });
        }
        Ok((self.assemble(normal, slid.as_ref(), stop)?, slid))
    }

    /// Keeps what a state leaves on a path: its new indentation and its slip.
    pub(super) fn keep(&mut self, force: f64, (saturated, depth): (&CellSet, &[f64]), slid: Option<Slid>) {
        if let Some(memory) = &mut self.memory {
            memory.advance(force, self.options.tolerance);
        }
        self.indent(saturated, depth);
        self.remember_slip(slid);
    }

    /// The state in the units of the scene, with the requested outputs.
    fn assemble(
        &mut self,
        found: NormalSolution<'_>,
        slid: Option<&Slid>,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let units = self.nondimensional;
        // Of a state that was stopped a caller gets what takes little time.
        let stopped = found.status == Status::Stopped;
        let stop = if stopped { &never } else { stop };
        let window = self.problem.grid().window();
        let is_whole = !stopped || self.problem.operators.plans.nanoseconds(window) < CERTIFIED_NS;
        let mut fields = if is_whole { self.fields(&found, stop)? } else { None };
        self.raise(slid, &mut fields, stop)?;
        if let (Some(fields), Some(slid)) = (&mut fields, slid) {
            self.slip_fields(slid, fields)?;
        }
        let tangential = slid.map(|slid| self.tangential(slid)).transpose()?.flatten();
        let plans = &mut self.problem.operators.plans;
        let mut strategy = vec![found.strategy];
        match std::mem::take(&mut plans.descent) {
            0 => {}
            steps => strategy.push(format!("{steps} steps of the fall-back")),
        }
        match std::mem::take(&mut plans.limited) {
            0 => {}
            solves => strategy.push(format!("{solves} inner solves ended at their limit of steps")),
        }
        let strategy = strategy.join("; ");
        let mut report = SolveReport::new(found.status, strategy);
        report.work = Work::of(std::mem::take(&mut self.problem.operators.plans.solves), fields.as_ref());
        report.iterations = found.iterations;
        report.applications = std::mem::take(&mut self.problem.operators.plans.applications);
        report.contact_cells = Some(found.contact.len());
        report.certificate = found.certificate;
        let signed = |value: f64, of: &dyn Fn(f64) -> Result<f64>| Ok(of(value.abs())?.copysign(value));
        let length = |value: f64| signed(value, &|v| units.approach(v));
        let stiffness = |k: Option<f64>| k.map(|k| signed(k, &|v| units.stiffness(v))).transpose();
        let mean_gap = self.mean_gap(found.complete, found.d, found.force);
        let force = signed(PI * found.force, &|v| units.force(v))?;
        let along_branch = stiffness(found.stiffness)?;
        ContactState::new(force, report)
            .with_whole_layer(
                self.whole_layer((force, length(self.mean - mean_gap)?), (along_branch, found.complete))?,
            )
            .with_approach(self.has_approach().then(|| length(found.d)).transpose()?)
            .with_mean_gap(self.outputs.mean_gap.then(|| length(mean_gap)).transpose()?)
            .with_stiffness(along_branch)
            .with_stiffness_fixed_area(stiffness(found.fixed_area)?)
            .with_area(self.outputs.area.then(|| units.area(found.area)).transpose()?)
            .with_plastic(self.plastic(found.yielded, found.indented.1)?)
            .with_adhesive(found.adhesive)
            .with_tangential(tangential)
            .with_patches(if is_whole { self.patches(found.contact, stop)? } else { None })
            .with_resolution(found.resolution)
            .with_fields(fields)
            .completed(&self.outputs, self.normalisation.contact_modulus)
    }

    /// The approach to a whole layer under a force, where the mean gap has fallen by `fall`, and its stiffness where
    /// that of the mean gap was asked for; complete contact has no other compliance than the layer's.
    ///
    /// # Errors
    /// [`Error::Domain`] for an approach beyond the numbers.
    fn whole_layer(
        &self,
        (force, fall): (f64, f64),
        (stiffness, complete): (Option<f64>, bool),
    ) -> Result<Option<WholeLayer>> {
        let Some(compression) = self.whole_compression else { return Ok(None) };
        let compliance = compression / self.size.area();
        let approach = fall + compliance * force;
        if !approach.is_finite() {
            return Err(Error::domain("approach with the whole layer", approach, "a number that fits f64"));
        }
        let with_layer = |compliance_of_gap: f64| 1.0 / (compliance_of_gap + compliance);
        let stiffness = match stiffness {
            _ if !self.outputs.stiffness => None,
            None if complete => Some(with_layer(0.0)),
            Some(0.0) | None => stiffness,
            Some(k) => Some(with_layer(1.0 / k)),
        };
        Ok(Some(WholeLayer { approach, stiffness: stiffness.filter(|k| k.is_finite()) }))
    }

    /// Mean gap of a state with this approach and force: the distance between the mean plane of the defined
    /// heights and that of the deformed half-space, whose mean displacement vanishes with the kernel of zero
    /// mean. With undefined points or a plastic indentation the mean gap may be negative.
    pub(super) fn mean_gap(&self, complete: bool, d: f64, force: f64) -> f64 {
        // What is left of complete contact is rounding.
        if complete { 0.0 } else { self.mean - (d - self.problem.operators.table().shift() * force) }
    }

    /// The state before first touch, and at it, at a nondimensional approach.
    pub(super) fn no_contact(&mut self, d: f64, load: ScaledTangential) -> Result<ContactState> {
        self.begin_count();
        let nothing = CellSet::default();
        let stiffness = self.outputs.needs_stiffness().then_some(0.0);
        let slid = self.slide_apart(load)?;
        let nothing = NormalSolution {
            status: Status::Converged,
            strategy: "no contact".to_owned(),
            iterations: 0,
            certificate: Certificate::default(),
            force: 0.0,
            d,
            complete: false,
            contact: &nothing,
            pressure: (&nothing, &[]),
            indented: (&nothing, &[]),
            yielded: 0,
            area: 0.0,
            stiffness,
            fixed_area: stiffness,
            adhesive: None,
            resolution: None,
        };
        let (state, slid) = self.assess(nothing, slid, &never)?;
        self.remember_slip(slid);
        Ok(state)
    }

    /// The state of a contact without adhesion, from which the next load starts.
    pub(super) fn state(
        &mut self,
        solved: Solved,
        tangent: Option<Tangent>,
        error: LoadError,
        slid: Option<Slid>,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let force: f64 = solved.p.iter().sum();
        let (saturated, depth) = plastic_depth(&solved, self.problem.bounds);
        let k = |t: &NormalStiffness| PI * t.k() * self.magnification(t.k());
        let of_pressures = tangent.as_ref().map(|t| k(&t.stiffness));
        let fixed_area = match &tangent {
            Some(Tangent { whole: Some(whole), .. }) => Some(k(whole)),
            Some(t) if t.cells.len() == solved.contact.len() => of_pressures,
            _ => None,
        };
        let stiffness = match &slid {
            Some(slid) if slid.rounds.is_some() => slid.normal_stiffness.map(|(slope, _)| PI * slope),
            _ => of_pressures,
        };
        let normal = NormalSolution {
            status: solved.status,
            strategy: self.strategy(&solved),
            iterations: solved.steps + tangent.as_ref().map_or(0, Tangent::steps),
            certificate: Certificate {
                duality_gap: solved.residuals.duality_gap,
                penetration: solved.residuals.penetration,
                complementarity: solved.residuals.complementarity,
                load_error: error.load,
                stiffness_error: tangent.as_ref().map(|t| self.tangent_error(t)),
                force_error: error.force,
                ..Certificate::default()
            },
            force,
            d: solved.d,
            complete: self.is_complete(&solved),
            contact: &solved.contact,
            pressure: (&solved.contact, &solved.p),
            indented: (&saturated, &depth),
            yielded: saturated.union(&self.flowing_again(&solved)).len(),
            area: solved.contact.len() as f64,
            stiffness,
            fixed_area,
            adhesive: None,
            resolution: Some(self.resolution(&solved)?),
        };
        let (state, slid) = self.assess(normal, slid, stop)?;
        if state.report.status == Status::Converged {
            self.keep(force, (&saturated, &depth), slid);
            let certified = state.report.certificate.stiffness_error.is_some();
            self.remember(solved, tangent.filter(|_| certified));
        }
        returned(state)
    }

    /// How a contact was solved, in one short phrase.
    fn strategy(&self, solved: &Solved) -> String {
        match (solved.q.is_some(), self.problem.operators.last()) {
            (true, _) => format!("dense {}", solved.contact.len()),
            (false, Some(recipe)) => recipe.to_string(),
            (false, None) => format!("direct {}", solved.contact.len()),
        }
    }

    /// With a hardness: the number of cells at the hardness, and the depths of new indentation.
    fn plastic(&self, saturated: usize, depth: &[f64]) -> Result<Option<PlasticState>> {
        let units = self.nondimensional;
        let Some(hardness) = self.hardness else { return Ok(None) };
        let area = units.area(saturated as f64)?;
        let before: f64 = self.memory.as_ref().map_or(0.0, |memory| memory.indentation.iter().sum());
        let volume = units.area(1.0)? * units.approach(before + depth.iter().sum::<f64>())?;
        Ok(Some(PlasticState::new(area, volume, units.pressure(PI * hardness)?)))
    }

    /// The requested fields.
    ///
    /// # Errors
    /// [`contact_model::Error::Stopped`] by the stop.
    fn fields(&mut self, found: &NormalSolution<'_>, stop: Stop<'_>) -> Result<Option<Fields>> {
        if !self.outputs.any_field() {
            return Ok(None);
        }
        let grid = self.problem.grid();
        let NormalSolution { pressure: (set, pressure), d, indented: (saturated, depth), .. } = *found;
        let mut fields = Fields::default();
        if self.outputs.pressure {
            let mut p = vec![0.0; grid.count()];
            for (i, &value) in set.index(grid).zip(pressure) {
                p[i] = self.nondimensional.pressure(PI * value.abs())?.copysign(value);
            }
            fields.pressure = Some(self.field(p)?);
        }
        if self.outputs.plastic_depth {
            fields.plastic_depth = Some(self.plastic_field(saturated, depth)?);
        }
        if self.outputs.displacement || self.outputs.gap {
            let mut u = Vec::new();
            let done = self.problem.operators.exact(set, pressure, &CellSet::all(grid), &mut u, stop);
            done.map_err(Interrupted::without_state)?;
            // What the constant in the kernel adds to every displacement.
            let shift = self.problem.operators.table().shift() * pressure.iter().sum::<f64>();
            let height = self.height;
            if self.outputs.gap {
                let z = self.problem.candidates.z();
                let mut gap: Vec<f64> = u.iter().zip(z).map(|(u, z)| (u + z - d) * height).collect();
                for (i, depth) in saturated.index(grid).zip(depth) {
                    gap[i] += depth * height;
                }
                fields.gap = Some(self.field(gap)?);
            }
            if self.outputs.displacement {
                let mut displacement: Vec<f64> = u.iter().map(|u| (u - shift) * height).collect();
                for (u, crept) in displacement.iter_mut().zip(&self.crept) {
                    *u += crept * height;
                }
                fields.displacement = Some(self.field(displacement)?);
            }
        }
        Ok(Some(fields))
    }

    /// Adds what tractions displace to the displacement, where both problems are coupled. The gap has it already.
    fn raise(&mut self, slid: Option<&Slid>, fields: &mut Option<Fields>, stop: Stop<'_>) -> Result<()> {
        let (Some(sliding), Some(slid)) = (&mut self.sliding, slid) else { return Ok(()) };
        let Some(Fields { displacement: Some(displacement), .. }) = fields else { return Ok(()) };
        let raised = sliding.friction.normal_displacement(&slid.state.memory, stop);
        let Some(raised) = raised.map_err(Interrupted::without_state)? else { return Ok(()) };
        let height = self.height;
        let values = displacement.values().iter().zip(&raised).map(|(u, raised)| u + raised * height);
        *displacement = self.field(values.collect())?;
        Ok(())
    }

    /// The indentation of a path and of the saturated cells.
    fn plastic_field(&self, saturated: &CellSet, depth: &[f64]) -> Result<Field> {
        let grid = self.problem.grid();
        let mut depths =
            self.memory.as_ref().map_or_else(|| vec![0.0; grid.count()], |memory| memory.indentation.clone());
        for (i, depth) in saturated.index(grid).zip(depth) {
            depths[i] += depth;
        }
        for depth in &mut depths {
            *depth *= self.height;
        }
        self.field(depths)
    }

    pub(super) fn field(&self, values: Vec<f64>) -> Result<Field> {
        let grid = self.problem.grid();
        Field::new([grid.columns, grid.rows], self.size, values)
    }

    /// The resolution of a contact with these pressures: the largest of them, its share of all pressures, and the
    /// cells at an edge of the rectangle or of an undefined point. Attraction counts as no pressure.
    pub(super) fn resolution_of(&self, contact: &CellSet, pressure: &[f64]) -> Result<ContactResolution> {
        let grid = self.problem.grid();
        let largest = pressure.iter().copied().fold(0.0, f64::max);
        let [along_x, along_y] = self.problem.operators.table().boundary().repeats();
        // A profile goes on along y.
        let across = |y: usize| !self.is_profile && !along_y && (y == 0 || y + 1 == grid.rows);
        let along = |x: usize| !along_x && (x == 0 || x + 1 == grid.columns);
        let edge_cells = contact.places().filter(|&(x, y)| along(x) || across(y)).count();
        let sum: f64 = pressure.iter().filter(|p| **p > 0.0).sum();
        let largest_share = if sum > 0.0 { largest / sum } else { 0.0 };
        let largest = self.nondimensional.pressure(PI * largest)?;
        Ok(ContactResolution::new(largest, largest_share, edge_cells).with_rim(self.rim_cells(contact)))
    }

    /// The number of cells in contact that share an edge with an undefined point.
    fn rim_cells(&self, contact: &CellSet) -> usize {
        let Grid { columns, rows, .. } = self.problem.grid();
        let z = self.problem.candidates.z();
        let [along_x, along_y] = self.problem.operators.table().boundary().repeats();
        let is_undefined = |x: usize, y: usize| z[y * columns + x].is_infinite();
        let beside = |at: usize, count: usize, repeats: bool| {
            let before = if at > 0 { Some(at - 1) } else { repeats.then(|| count - 1) };
            let after = if at + 1 < count { Some(at + 1) } else { repeats.then_some(0) };
            before.into_iter().chain(after)
        };
        let at_rim = |&(x, y): &(usize, usize)| {
            beside(x, columns, along_x).any(|x| is_undefined(x, y))
                || beside(y, rows, along_y).any(|y| is_undefined(x, y))
        };
        contact.places().filter(at_rim).count()
    }

    /// The measures of how well the cells resolve the contact.
    fn resolution(&self, solved: &Solved) -> Result<ContactResolution> {
        let contact = &solved.contact;
        let resolution = self.resolution_of(contact, &solved.p)?;
        // The correction for the boundary is one for curved boundaries; a line contact is not biased.
        if !self.outputs.area || self.is_profile {
            return Ok(resolution);
        }
        let (cells, index, boundary) = self.indexed(contact);
        let edges = surface_gen::boundary_edges(cells, &index, boundary);
        let mut resolution = resolution.with_boundary(contact.len(), edges, self.nondimensional.area(1.0)?);
        // No contact under this force is smaller than the one whose pressure is the hardness everywhere.
        let least = solved.p.iter().sum::<f64>() / self.problem.bounds.upper();
        let least = if least > 0.0 { self.nondimensional.area(least)? } else { 0.0 };
        resolution.corrected_area = resolution.corrected_area.map(|area| area.max(least));
        Ok(resolution)
    }

    /// A contact set as indices on its grid.
    pub(super) fn indexed(&self, contact: &CellSet) -> ([usize; 2], Vec<u32>, Boundary) {
        let grid = self.problem.grid();
        let index = contact.index(grid).map(|i| i as u32).collect();
        ([grid.columns, grid.rows], index, self.problem.operators.table().boundary())
    }

    /// Connected patches of the contact set, where requested.
    ///
    /// # Errors
    /// [`contact_model::Error::Stopped`] by the stop, which is asked before.
    pub(super) fn patches(&self, contact: &CellSet, stop: Stop<'_>) -> Result<Option<Patches>> {
        if !self.outputs.contact_patches {
            return Ok(None);
        }
        check_stop(stop)?;
        let (cells, index, boundary) = self.indexed(contact);
        let sizes = surface_gen::patches(cells, &index, boundary);
        let areas =
            sizes.into_iter().map(|size| self.nondimensional.area(size as f64)).collect::<Result<_>>()?;
        Ok(Some(Patches::new(areas)))
    }
}

/// The saturated cells and the depth of their indentation.
fn plastic_depth(solved: &Solved, bounds: Bounds) -> (CellSet, Vec<f64>) {
    if !bounds.is_reached(&solved.p) {
        return (CellSet::default(), Vec::new());
    }
    let saturated = solved.contact.filter(&solved.p, |p| p >= bounds.upper());
    let mut depth = solved.gap_on(&saturated);
    for g in &mut depth {
        *g = (-*g).max(0.0);
    }
    (saturated, depth)
}
