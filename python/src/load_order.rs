//! The order of loads on a contact with a hardness.
//!
//! A solve begins with the virgin surface. A smaller load than one before would forget the indentation of
//! that one without a word, so it is refused.

use crate::errors::of_model;
use fractal_contact::{ContactState, Error, Load, NormalLoad};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

/// How far a load may lie below a state that was solved for a load of another kind: what was not prescribed is
/// known within the tolerance of a solve.
const WITHIN_TOLERANCE: f64 = 1e-2;

const REMEDY: &str = "with a hardness each load is solved from the virgin surface, and the indentation of a larger one would be \
                      forgotten: advance() and follow() keep it, restart() and a new contact begin again";

/// The highest load of a contact, and what it led to.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Highest {
    load: NormalLoad,
    force: f64,
    approach: Option<f64>,
    mean_gap: Option<f64>,
}

impl Highest {
    /// The higher of one before and a load that led to this state. Of equal ones the later.
    pub fn of(before: Option<Self>, load: NormalLoad, state: &ContactState) -> Self {
        let found = Self { load, force: state.force, approach: state.approach, mean_gap: state.mean_gap };
        before.filter(|before| before.force > found.force).unwrap_or(found)
    }

    /// An error where `load` is smaller; `area` where it was given as a mean pressure.
    pub fn check(&self, py: Python<'_>, load: NormalLoad, area: Option<f64>) -> PyResult<()> {
        let same = std::mem::discriminant(&load) == std::mem::discriminant(&self.load);
        let reached = match load {
            NormalLoad::Force(_) => Some(NormalLoad::Force(self.force)),
            NormalLoad::Approach(_) => self.approach.map(NormalLoad::Approach),
            NormalLoad::MeanGap(_) => self.mean_gap.map(NormalLoad::MeanGap),
            _ => None,
        };
        match (same, reached) {
            (true, _) => check(py, [self.load, load], area, 0.0),
            (false, Some(before)) => check(py, [before, load], area, WITHIN_TOLERANCE),
            (false, None) => Ok(()),
        }
    }
}

/// An error where one of the loads is smaller than that before it; `area` where they were given as mean
/// pressures.
pub fn check_rising(py: Python<'_>, loads: &[Load], area: Option<f64>) -> PyResult<()> {
    loads.windows(2).try_for_each(|pair| check(py, [pair[0].normal, pair[1].normal], area, 0.0))
}

/// An error where the second load is smaller than the first, which is of its kind, by more than a share of
/// it.
fn check(py: Python<'_>, loads: [NormalLoad; 2], area: Option<f64>, slack: f64) -> PyResult<()> {
    let (name, before, value, sign) = match loads {
        [NormalLoad::Force(before), NormalLoad::Force(value)] => ("force", before, value, 1.0),
        [NormalLoad::Approach(before), NormalLoad::Approach(value)] => ("approach", before, value, 1.0),
        [NormalLoad::MeanGap(before), NormalLoad::MeanGap(value)] => ("mean_gap", before, value, -1.0),
        _ => return Ok(()),
    };
    if sign * (before - value) > slack * before.abs() {
        let (name, area) = area.map_or((name, 1.0), |area| ("mean_pressure", area));
        let least = if sign > 0.0 { "at least" } else { "at most" };
        let expected = format!("{least} {:?}, the load before it; {REMEDY}", before / area);
        return Err(of_model(py, Error::domain(name, value / area, expected)));
    }
    Ok(())
}
