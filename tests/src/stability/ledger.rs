//! The findings of a case.

use contact_model::{ContactState, Error, Field, Result};

/// Largest number of broken assertions that are kept in words.
const KEPT: usize = 5;

/// Collects the findings of a case: the largest deviation, and assertions that do not hold.
#[derive(Debug, Default)]
pub struct Ledger {
    figure: f64,
    entries: usize,
    broken: Vec<String>,
}

impl Ledger {
    /// Records a deviation, dimensionless and >= 0. After a NaN the figure stays NaN.
    pub fn enter(&mut self, deviation: f64) {
        self.entries += 1;
        if deviation.is_nan() || deviation > self.figure {
            self.figure = deviation;
        }
    }

    /// Records a number of differing items.
    pub fn count(&mut self, differing: usize) {
        self.enter(differing as f64);
    }

    /// Records the relative deviation of a number from the exact one.
    pub fn near(&mut self, what: &str, found: f64, exact: f64) {
        let deviation = if exact.abs() > 0.0 { ((found - exact) / exact).abs() } else { found.abs() };
        self.must(deviation.is_finite(), || format!("{what}: {found} beside {exact}"));
        self.enter(deviation);
    }

    /// Records an assertion; `what` describes its failure in words.
    pub fn must(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds && self.broken.len() < KEPT {
            self.broken.push(what());
        }
    }

    /// Asserts the number of cells in contact of a state.
    pub fn contact_cells(&mut self, state: &ContactState, expected: usize) {
        let (force, report) = (state.force, &state.report);
        self.must(report.contact_cells == Some(expected), || {
            format!("F {force}: {:?} contact cells, expected {expected}; {report:?}", report.contact_cells)
        });
    }

    /// Asserts that a certificate is within a tolerance.
    pub fn meets(&mut self, state: &ContactState, tolerance: f64) {
        let (force, report) = (state.force, &state.report);
        self.must(report.certificate.meets(tolerance), || format!("F {force}: {report:?}"));
    }

    /// Asserts the number of cells in contact of a state, and records the relative deviation of its
    /// stiffness.
    ///
    /// # Errors
    /// [`Error::Shape`] where it has none.
    pub fn contact(&mut self, state: &ContactState, cells: usize, exact: f64) -> Result<()> {
        self.contact_cells(state, cells);
        self.near("k", stiffness(state)?, exact);
        Ok(())
    }

    /// Records the deviation of each value of a field from the exact one, over `largest`.
    pub fn field<'a>(&mut self, found: &[f64], exact: impl IntoIterator<Item = &'a f64>, largest: f64) {
        found.iter().zip(exact).for_each(|(a, b)| self.enter((a - b).abs() / largest));
    }

    /// Records the deviations of force, approach and stiffness of one state from another, and asserts that
    /// both have the same number of cells in contact.
    ///
    /// # Errors
    /// [`Error::Shape`] where a state lacks one of them.
    pub fn same(&mut self, what: &str, found: &ContactState, exact: &ContactState) -> Result<()> {
        self.near(what, found.force, exact.force);
        self.near(what, approach(found)?, approach(exact)?);
        self.near(what, stiffness(found)?, stiffness(exact)?);
        let cells = [found, exact].map(|s| s.report.contact_cells);
        self.must(cells[0] == cells[1], || format!("{what}: contact cells {cells:?}"));
        Ok(())
    }

    /// Counts which of force, approach, stiffness and pressure differ in any bit.
    pub fn same_bits(&mut self, what: &str, a: &ContactState, b: &ContactState) {
        let differing = bits(a).iter().zip(&bits(b)).filter(|(a, b)| a != b).count();
        let lengths = [a, b].map(|s| bits(s).len());
        self.must(lengths[0] == lengths[1], || format!("{what}: fields of {lengths:?} numbers"));
        self.must(differing == 0, || format!("{what}: {differing} numbers differ"));
        self.count(differing);
    }

    /// Number of entries so far.
    pub(crate) fn entries(&self) -> usize {
        self.entries
    }

    /// The figure, where it is a number, and the broken assertions.
    pub(crate) fn close(self) -> (Option<f64>, Vec<String>) {
        (Some(self.figure).filter(|f| f.is_finite()), self.broken)
    }
}

fn bits(state: &ContactState) -> Vec<u64> {
    let numbers = [Some(state.force), state.approach, state.stiffness, state.area];
    let pressure = state.pressure().map_or(&[][..], Field::values);
    numbers.iter().flatten().chain(pressure).map(|v| v.to_bits()).collect()
}

/// The approach of a state.
///
/// # Errors
/// [`Error::Shape`] where it has none.
pub fn approach(state: &ContactState) -> Result<f64> {
    known("approach", state.approach)
}

/// The stiffness of a state.
///
/// # Errors
/// [`Error::Shape`] where it has none.
pub fn stiffness(state: &ContactState) -> Result<f64> {
    known("stiffness", state.stiffness)
}

/// The mean gap of a state.
///
/// # Errors
/// [`Error::Shape`] where it has none.
pub fn mean_gap(state: &ContactState) -> Result<f64> {
    known("mean gap", state.mean_gap)
}

/// The pressure field of a state.
///
/// # Errors
/// [`Error::Shape`] where it has none.
pub fn pressure(state: &ContactState) -> Result<&[f64]> {
    known("pressure", state.pressure().map(Field::values))
}

/// The largest magnitude of a field.
pub fn largest(field: &[f64]) -> f64 {
    field.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

pub(crate) fn known<T>(name: &'static str, value: Option<T>) -> Result<T> {
    value.ok_or(Error::Shape { name: name.into(), found: 0, expected: "what was requested".into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_counts_and_nan_is_never_forgotten() {
        let mut ledger = Ledger::default();
        for d in [1e-3, 0.5, 1e-4] {
            ledger.enter(d);
        }
        assert_eq!((ledger.figure.to_bits(), ledger.entries()), (0.5_f64.to_bits(), 3));
        ledger.enter(f64::NAN);
        ledger.enter(1.0);
        assert_eq!(ledger.close().0, None);
    }

    #[test]
    fn exact_zeros_are_compared_absolutely() {
        let mut ledger = Ledger::default();
        ledger.near("x", 1e-3, 0.0);
        assert_eq!(ledger.close(), (Some(1e-3), vec![]));
    }
}
