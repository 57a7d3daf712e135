//! Linear systems in the precision and with the preconditioner of their recipe.

use super::extension::Extension;
use super::pcg::{Energy, Fixed, PcgOutcome, StoppingCriteria, Vectors, pcg};
use super::preconditioner::{Identity, TorusInverse};
use crate::geometry::CellSet;
use crate::operator::{Conditioning, Operators, Recipe};
use crate::parts::{Part, timed};
use crate::real::{Real, largest, update};
use contact_model::Stop;

/// Room for linear systems, kept from one to the next.
#[derive(Debug, Default)]
pub struct Workspace {
    recipe: Option<Recipe>,
    double: Vectors<f64>,
    single: Vectors<f32>,
    extension: Extension,
}

impl Workspace {
    /// A new load: what the sums of corrections are taken from is found again.
    pub fn begin_load(&mut self) {
        self.double.forget();
        self.single.forget();
    }

    /// Takes a set and how systems on it are solved.
    pub fn take(&mut self, operators: &mut Operators, set: CellSet, recipe: Recipe) {
        if self.recipe.is_some_and(|last| last.has_preconditioner() != recipe.has_preconditioner()) {
            self.begin_load();
        }
        self.recipe = Some(recipe);
        let decay = operators.tuning().decay;
        if let (Conditioning::Torus { extended, .. }, (_, Some(torus))) =
            (recipe.conditioning, operators.system(recipe))
        {
            self.extension.set(&set, torus.window(), if extended { decay } else { 0.0 });
        }
        if recipe.is_single() {
            self.single.take(set);
        } else {
            self.double.take(set);
        }
    }

    /// The set.
    pub fn set(&self) -> &CellSet {
        if self.recipe.is_some_and(|recipe| recipe.is_single()) { &self.single.set } else { &self.double.set }
    }

    /// Solves `G x = right` on the set approximately, or what `fixed` makes of it, and writes x over `right`.
    /// Criteria and outcome are in the units of `right`.
    pub fn solve(
        &mut self,
        operators: &mut Operators,
        right: &mut [f64],
        fixed: Fixed,
        criteria: StoppingCriteria,
        stop: Stop<'_>,
    ) -> PcgOutcome {
        operators.solves += 1;
        // In units of its own size: its square neither overflows nor underflows.
        let unit = largest(right);
        let Some(recipe) = self.recipe.filter(|_| unit > 0.0) else { return PcgOutcome::default() };
        let square = unit * unit;
        let criteria = StoppingCriteria {
            floor: criteria.floor / unit,
            energy: criteria.energy.map(|e| Energy { base: e.base / square, ..e }),
            ..criteria
        };
        let mut identity = Identity { smallest_eigenvalue: operators.table().smallest_eigenvalue() };
        let (mut operator, torus) = operators.system(recipe);
        let outcome = timed(Part::Vectors, || {
            if recipe.is_single() {
                let v = &mut self.single;
                v.load(right, unit);
                let outcome = if let Some(transform) = torus {
                    let mut inverse = TorusInverse { transform, extension: &mut self.extension };
                    pcg(&mut operator, &mut inverse, v, fixed, criteria, stop)
                } else {
                    pcg(&mut operator, &mut identity, v, fixed, criteria, stop)
                };
                v.unload(right, unit);
                outcome
            } else {
                let v = &mut self.double;
                v.load(right, unit);
                let outcome = pcg(&mut operator, &mut identity, v, fixed, criteria, stop);
                v.unload(right, unit);
                outcome
            }
        });
        operators.applications += outcome.applications;
        PcgOutcome { energy: outcome.energy * square, ..outcome }
    }
}

impl<T: Real> Vectors<T> {
    fn load(&mut self, right: &[f64], unit: f64) {
        update(&mut self.r, right, |r, right| *r = T::of(right / unit));
    }

    fn unload(&self, solution: &mut [f64], unit: f64) {
        update(solution, &self.x, |solution, x| *solution = unit * x.to_f64());
    }
}

#[cfg(test)]
mod tests;
