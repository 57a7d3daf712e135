//! From a solution to the state that is returned.

use super::prepared::{PreparedSurface, Tangent};
use crate::active_set::{Bounds, Continuation, Solved};
use crate::geometry::CellSet;
use crate::stiffness::Stiffness;
use contact_model::{
    Boundary, Certificate, ContactResolution, ContactState, Error, Field, Fields, Patches, PlasticState,
    Result, SolveReport, Status, Stop, Work,
};
use std::f64::consts::PI;

/// A stiffness may grow by this factor over what is left open of the load: by a sixth in the worst of 900 small states at a tolerance of
/// 1e-3, near complete contact.
pub(super) const GROWTH: f64 = 1.25;

/// How far a state is from its load, and what that leaves open of the force.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoadError {
    /// Relative miss of the load.
    pub load: f64,
    /// Relative error of a force that was not prescribed.
    pub force: Option<f64>,
}

impl LoadError {
    /// Of a prescribed force, with this relative miss.
    pub fn of_force(miss: f64) -> Self {
        Self { load: miss.abs(), force: None }
    }
}

impl PreparedSurface {
    pub(super) fn state(
        &mut self,
        solved: Solved,
        tangent: Option<Tangent>,
        error: LoadError,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let force: f64 = solved.p.iter().sum();
        let mut certificate = Certificate {
            duality_gap: solved.residuals.duality_gap,
            penetration: solved.residuals.penetration,
            complementarity: solved.residuals.complementarity,
            load_error: error.load,
            stiffness_error: tangent.as_ref().map(|t| self.tangent_error(t)),
            force_error: error.force,
            ..Certificate::default()
        };
        let mut tangent = tangent;
        if self.memory.is_some() && !certificate.meets(self.options.tolerance) {
            let rest = Certificate { stiffness_error: None, ..certificate };
            if rest.meets(self.options.tolerance) {
                // It is not known which cells flow: the stiffness jumps nearby.
                (certificate, tangent) = (rest, None);
            }
        }
        let met = certificate.meets(self.options.tolerance);
        let status = match solved.status {
            Status::Converged if met => Status::Converged,
            Status::Converged if stop() => Status::Stopped,
            Status::Converged => Status::Stagnated,
            other => other,
        };
        let (saturated, depth) = plastic_depth(&solved, self.problem.bounds);
        let fields = self.fields((&solved.contact, &solved.p), solved.d, (&saturated, &depth))?;
        let units = self.nondimensional;
        let mut report = SolveReport::new(status, self.strategy(&solved));
        report.work = Work::of(std::mem::take(&mut self.problem.operators.solves), fields.as_ref());
        report.iterations = solved.steps + tangent.as_ref().map_or(0, Tangent::steps);
        report.applications = std::mem::take(&mut self.problem.operators.applications);
        report.contact_cells = Some(solved.contact.len());
        report.certificate = certificate;
        let approach = self.has_approach().then(|| units.approach(solved.d)).transpose()?;
        let mean_gap = self.outputs.mean_gap.then(|| units.approach(self.gap_of(&solved))).transpose()?;
        let dimensional = |t: &Stiffness| units.stiffness(PI * t.value * self.magnification(t.value));
        let stiffness = tangent.as_ref().map(|t| dimensional(&t.stiffness)).transpose()?;
        let fixed_area = match &tangent {
            Some(Tangent { whole: Some(whole), .. }) => Some(dimensional(whole)?),
            Some(t) if t.cells.len() == solved.contact.len() => stiffness,
            _ => None,
        };
        let again = self.flowing_again(&solved);
        let plastic = self.plastic(saturated.union(&again).len(), &depth)?;
        let area = self.outputs.area.then(|| units.area(solved.contact.len() as f64)).transpose()?;
        let state = ContactState::new(units.force(PI * force)?, report)
            .with_approach(approach)
            .with_mean_gap(mean_gap)
            .with_stiffness(stiffness)
            .with_stiffness_fixed_area(fixed_area)
            .with_area(area)
            .with_plastic(plastic)
            .with_patches(self.patches(&solved.contact)?)
            .with_resolution(self.resolution(&solved)?)
            .with_fields(fields)
            .completed(&self.outputs, self.normalisation.modulus)?;
        if status == Status::Converged {
            if let Some(memory) = &mut self.memory {
                memory.advance(force, self.options.tolerance);
            }
            self.indent(&saturated, &depth);
            self.remember(solved, tangent);
            Ok(state)
        } else if status == Status::Stopped {
            Err(Error::Stopped { best: Some(Box::new(state)) })
        } else {
            Err(Error::NotConverged { best: Box::new(state) })
        }
    }

    /// The error of both stiffnesses.
    pub(super) fn tangent_error(&self, tangent: &Tangent) -> f64 {
        let whole = tangent.whole.as_ref().map_or(0.0, |whole| self.stiffness_error(whole));
        self.stiffness_error(&tangent.stiffness).max(whole)
    }

    /// A bound of the stiffness near a state, nondimensional: that of the state where it is known, else that of a circle around the
    /// contact, which has no smaller one (free boundaries only).
    pub(super) fn stiffest(&self, solved: &Solved, tangent: Option<&Tangent>) -> f64 {
        if let Some(Tangent { stiffness: t, .. }) = tangent {
            return t.value * self.magnification(t.value) * (1.0 + self.stiffness_error(t));
        }
        self.stiffest_on(&solved.contact)
    }

    /// The stiffness of a circle around a set, nondimensional.
    pub(super) fn stiffest_on(&self, set: &CellSet) -> f64 {
        let Some(window) = set.window() else { return 0.0 };
        let (dx, dy) = self.problem.grid().cell();
        (window.width as f64 * dx).hypot(window.height as f64 * dy) / PI
    }

    /// What a stiffness k makes of the gaps left on the contact and of a miss of the load, as an error of the force.
    ///
    /// The force is that of a surface whose heights differ by no more than those gaps, and it grows with every height.
    pub(super) fn force_error(&self, solved: &Solved, k: f64, miss: f64) -> LoadError {
        let bounds = self.problem.bounds;
        let Continuation { checked, gap, .. } = &solved.continuation;
        let left = (checked.carry(&solved.contact, &solved.p).iter().zip(gap))
            .map(|(&p, &g)| bounds.violation(p, g))
            .fold(0.0, f64::max);
        let force: f64 = solved.p.iter().sum();
        let known = force > 0.0 && k.is_finite();
        LoadError { load: 0.0, force: known.then(|| GROWTH * k * (left + miss) / force) }
    }

    /// What has yielded, with a hardness: the number of cells at it, and the depths of new indentation.
    fn plastic(&self, saturated: usize, depth: &[f64]) -> Result<Option<PlasticState>> {
        let units = self.nondimensional;
        let Bounds::UpTo(hardness) = self.problem.bounds else { return Ok(None) };
        let area = units.area(saturated as f64)?;
        let before: f64 = self.memory.as_ref().map_or(0.0, |memory| memory.indentation.iter().sum());
        let volume = units.area(1.0)? * units.approach(before + depth.iter().sum::<f64>())?;
        Ok(Some(PlasticState::new(area, volume, units.pressure(PI * hardness)?)))
    }

    /// The fields asked for, of a (net) pressure on a set at an approach, with the depth of the indentation of saturated cells.
    pub(super) fn fields(
        &mut self,
        (set, pressure): (&CellSet, &[f64]),
        d: f64,
        (saturated, depth): (&CellSet, &[f64]),
    ) -> Result<Option<Fields>> {
        if !self.outputs.any_field() {
            return Ok(None);
        }
        let grid = self.problem.grid();
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
            self.problem.operators.exact(set, pressure, &CellSet::all(grid), &mut u);
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
                let displacement = u.iter().map(|u| (u - shift) * height).collect();
                fields.displacement = Some(self.field(displacement)?);
            }
        }
        Ok(Some(fields))
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

    fn field(&self, values: Vec<f64>) -> Result<Field> {
        let grid = self.problem.grid();
        Field::new([grid.columns, grid.rows], self.size, values)
    }

    /// What the cells say about how well they resolve the contact.
    fn resolution(&self, solved: &Solved) -> Result<ContactResolution> {
        let (grid, contact) = (self.problem.grid(), &solved.contact);
        let largest = solved.p.iter().copied().fold(0.0, f64::max);
        // A profile goes on along y.
        let across = |y: usize| !self.is_profile && (y == 0 || y + 1 == grid.rows);
        let at_edge = |&(x, y): &(usize, usize)| x == 0 || x + 1 == grid.columns || across(y);
        let edge_cells = if self.is_periodic() { 0 } else { contact.places().filter(at_edge).count() };
        let largest_share = largest / solved.p.iter().sum::<f64>();
        let pressure = self.nondimensional.pressure(PI * largest)?;
        let resolution = ContactResolution::new(pressure, largest_share, edge_cells);
        // The correction for the boundary is one for curved boundaries; a line contact is not biased.
        if !self.outputs.area || self.is_profile {
            return Ok(resolution);
        }
        let (cells, index, boundary) = self.indexed(contact);
        let edges = surface_gen::boundary_edges(cells, &index, boundary);
        Ok(resolution.with_boundary(contact.len(), edges, self.nondimensional.area(1.0)?))
    }

    /// A contact set as indices on its grid.
    pub(super) fn indexed(&self, contact: &CellSet) -> ([usize; 2], Vec<u32>, Boundary) {
        let grid = self.problem.grid();
        let index = contact.index(grid).map(|i| i as u32).collect();
        ([grid.columns, grid.rows], index, self.problem.operators.table().boundary())
    }

    /// Connected patches of the contact set, where asked for.
    pub(super) fn patches(&self, contact: &CellSet) -> Result<Option<Patches>> {
        if !self.outputs.contact_patches {
            return Ok(None);
        }
        let (cells, index, boundary) = self.indexed(contact);
        let sizes = surface_gen::patches(cells, &index, boundary);
        let areas =
            sizes.into_iter().map(|size| self.nondimensional.area(size as f64)).collect::<Result<_>>()?;
        Ok(Some(Patches::new(areas)))
    }

    /// The state before first touch, and at it, at a nondimensional approach.
    pub(super) fn no_contact(&self, d: f64) -> Result<ContactState> {
        let zeros = || self.field(vec![0.0; self.problem.grid().count()]);
        let fields = if self.outputs.any_field() {
            let mut fields = Fields::default();
            fields.pressure = self.outputs.pressure.then(zeros).transpose()?;
            fields.displacement = self.outputs.displacement.then(zeros).transpose()?;
            let z = self.problem.candidates.z().iter();
            let gap = || self.field(z.map(|z| (z - d) * self.height).collect());
            fields.gap = self.outputs.gap.then(gap).transpose()?;
            let depth = || self.plastic_field(&CellSet::default(), &[]);
            fields.plastic_depth = self.outputs.plastic_depth.then(depth).transpose()?;
            Some(fields)
        } else {
            None
        };
        let mut report = SolveReport::exact("no contact");
        report.contact_cells = Some(0);
        report.work = Work::of(0, fields.as_ref());
        let mean_gap =
            self.outputs.mean_gap.then(|| self.nondimensional.approach(self.mean - d)).transpose()?;
        ContactState::new(0.0, report)
            .with_approach(self.has_approach().then(|| self.nondimensional.approach(d)).transpose()?)
            .with_mean_gap(mean_gap)
            .with_elastic_stiffness(self.outputs.needs_stiffness().then_some(0.0))
            .with_area(self.outputs.area.then_some(0.0))
            .with_plastic(self.plastic(0, &[])?)
            .with_patches(self.outputs.contact_patches.then(Patches::default))
            .with_fields(fields)
            .completed(&self.outputs, self.normalisation.modulus)
    }

    /// How a state was found, in one short phrase.
    fn strategy(&self, solved: &Solved) -> String {
        match (solved.q.is_some(), self.problem.operators.last()) {
            (true, _) => format!("dense {}", solved.contact.len()),
            (false, Some(recipe)) => recipe.to_string(),
            (false, None) => format!("direct {}", solved.contact.len()),
        }
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
