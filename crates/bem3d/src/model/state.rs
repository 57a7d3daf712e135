//! From a solution to the state that is returned.

use super::prepared::PreparedBem3d;
use crate::active_set::Solved;
use crate::geometry::CellSet;
use crate::stiffness::Stiffness;
use contact_model::{
    Boundary, Certificate, ContactResolution, ContactState, Error, Field, Fields, Patches, Result,
    SolveReport, Status, Stop, Work,
};
use std::f64::consts::PI;

impl PreparedBem3d {
    pub(super) fn state(
        &mut self,
        solved: Solved,
        tangent: Option<Stiffness>,
        load_error: f64,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let force: f64 = solved.p.iter().sum();
        let periodic = self.is_periodic();
        let certificate = Certificate {
            duality_gap: solved.residuals.duality_gap,
            penetration: solved.residuals.penetration,
            complementarity: solved.residuals.complementarity,
            load_error,
            stiffness_error: tangent.as_ref().map(|t| self.stiffness_error(t)),
            equilibrium: None,
        };
        let met = certificate.meets(self.options.tolerance);
        let status = match solved.status {
            Status::Converged if met => Status::Converged,
            Status::Converged if stop() => Status::Stopped,
            Status::Converged => Status::Stagnated,
            other => other,
        };
        let fields = self.fields(&solved.contact, &solved.p, solved.d)?;
        let units = self.nondimensional;
        let mut report = SolveReport::new(status, self.strategy(&solved));
        report.work = Work::of(std::mem::take(&mut self.problem.operators.solves), fields.as_ref());
        report.iterations = solved.steps + tangent.as_ref().map_or(0, |t| t.steps);
        report.applications = std::mem::take(&mut self.problem.operators.applications);
        report.contact_cells = Some(solved.contact.len());
        report.certificate = certificate;
        let approach = (!periodic).then(|| units.approach(solved.d)).transpose()?;
        let mean_gap = self.outputs.mean_gap.then(|| units.approach(self.gap_of(&solved))).transpose()?;
        let stiffness = (tangent.as_ref())
            .map(|t| units.stiffness(PI * t.value * self.magnification(t.value)))
            .transpose()?;
        let area = self.outputs.area.then(|| units.area(solved.contact.len() as f64)).transpose()?;
        let state = ContactState::new(units.force(PI * force)?, report)
            .with_approach(approach)
            .with_mean_gap(mean_gap)
            .with_stiffness(stiffness)
            .with_area(area)
            .with_patches(self.patches(&solved.contact)?)
            .with_resolution(self.resolution(&solved)?)
            .with_fields(fields)
            .completed(&self.outputs, self.normalisation.modulus)?;
        if status == Status::Converged {
            self.remember(solved, tangent);
            Ok(state)
        } else if status == Status::Stopped {
            Err(Error::Stopped { best: Some(Box::new(state)) })
        } else {
            Err(Error::NotConverged { best: Box::new(state) })
        }
    }

    /// The fields asked for, of a (net) pressure on a set at an approach.
    pub(super) fn fields(&mut self, set: &CellSet, pressure: &[f64], d: f64) -> Result<Option<Fields>> {
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
        if self.outputs.displacement || self.outputs.gap {
            let mut u = Vec::new();
            self.problem.operators.exact(set, pressure, &CellSet::all(grid), &mut u);
            // What the constant in the kernel adds to every displacement.
            let shift = self.problem.operators.table().shift() * pressure.iter().sum::<f64>();
            let height = self.height;
            if self.outputs.gap {
                let z = self.problem.candidates.z();
                let gap = u.iter().zip(z).map(|(u, z)| (u + z - d) * height).collect();
                fields.gap = Some(self.field(gap)?);
            }
            if self.outputs.displacement {
                let displacement = u.iter().map(|u| (u - shift) * height).collect();
                fields.displacement = Some(self.field(displacement)?);
            }
        }
        Ok(Some(fields))
    }

    fn field(&self, values: Vec<f64>) -> Result<Field> {
        let grid = self.problem.grid();
        Field::new([grid.columns, grid.rows], self.size, values)
    }

    /// What the cells say about how well they resolve the contact.
    fn resolution(&self, solved: &Solved) -> Result<ContactResolution> {
        let (grid, contact) = (self.problem.grid(), &solved.contact);
        let largest = solved.p.iter().copied().fold(0.0, f64::max);
        let at_edge =
            |&(x, y): &(usize, usize)| x == 0 || y == 0 || x + 1 == grid.columns || y + 1 == grid.rows;
        let edge_cells = if self.is_periodic() { 0 } else { contact.places().filter(at_edge).count() };
        let largest_share = largest / solved.p.iter().sum::<f64>();
        let pressure = self.nondimensional.pressure(PI * largest)?;
        let resolution = ContactResolution::new(pressure, largest_share, edge_cells);
        if !self.outputs.area {
            return Ok(resolution);
        }
        let (cells, index, boundary) = self.indexed(contact);
        let edges = surface_gen::boundary_edges(cells, &index, boundary);
        Ok(resolution.with_boundary(contact.len(), edges, self.nondimensional.area(1.0)?))
    }

    /// A contact set as indices on its grid.
    fn indexed(&self, contact: &CellSet) -> ([usize; 2], Vec<u32>, Boundary) {
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

    /// The state before first touch, and at it.
    pub(super) fn no_contact(&self) -> Result<ContactState> {
        let zeros = || self.field(vec![0.0; self.problem.grid().count()]);
        let fields = if self.outputs.any_field() {
            let mut fields = Fields::default();
            fields.pressure = self.outputs.pressure.then(zeros).transpose()?;
            fields.displacement = self.outputs.displacement.then(zeros).transpose()?;
            let z = self.problem.candidates.z().iter();
            let gap = || self.field(z.map(|z| z * self.height).collect());
            fields.gap = self.outputs.gap.then(gap).transpose()?;
            Some(fields)
        } else {
            None
        };
        let mut report = SolveReport::exact("no contact");
        report.contact_cells = Some(0);
        report.work = Work::of(0, fields.as_ref());
        let mean_gap = self.outputs.mean_gap.then(|| self.nondimensional.approach(self.mean)).transpose()?;
        ContactState::new(0.0, report)
            .with_approach((!self.is_periodic()).then_some(0.0))
            .with_mean_gap(mean_gap)
            .with_stiffness(self.outputs.needs_stiffness().then_some(0.0))
            .with_area(self.outputs.area.then_some(0.0))
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
