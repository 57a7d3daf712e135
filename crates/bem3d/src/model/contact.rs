//! A prepared surface behind the common trait: from a load to a state.

use super::prepared::{NAME, Prepared};
use crate::active_set::Target;
use contact_model::{ContactState, Error, Load, Normalisation, PreparedContact, Result, Stop};
use std::f64::consts::PI;

impl PreparedContact for Prepared {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.gap = None;
        let units = self.nondimensional;
        let target = match load.validated()? {
            Load::Force(f) => Target::Force(held("force", f, units.force_in(f) / PI)?),
            Load::Approach(d) if !self.is_periodic() => {
                Target::Approach(held("approach", d, units.approach_in(d))?)
            }
            Load::MeanGap(gap) if self.is_periodic() => {
                let state = self.at_mean_gap(held("mean gap", gap, units.approach_in(gap))?, stop)?;
                self.gap = Some((load, gap));
                return Ok(state);
            }
            Load::Approach(_) => {
                let what = "an approach: a periodic contact has a mean gap (Load::MeanGap)";
                return Err(Error::unsupported(NAME, what));
            }
            other => return Err(Error::unsupported(NAME, format!("the load {other:?} (free boundaries)"))),
        };
        if matches!(target, Target::Force(x) | Target::Approach(x) if x <= 0.0) {
            self.gap = Some((load, units.approach(self.mean)?));
            return self.no_contact();
        }
        self.begin_count();
        let (solved, tangent) = self.settle(target, self.limits(), stop);
        self.gap = Some((load, units.approach(self.gap_of(&solved))?));
        let miss = match target {
            Target::Force(asked) => ((solved.p.iter().sum::<f64>() - asked) / asked).abs(),
            Target::Approach(_) => 0.0,
        };
        self.state(solved, tangent, miss, stop)
    }

    fn mean_gap(&mut self, load: Load) -> Result<f64> {
        if !self.is_periodic() {
            return Err(Error::unsupported(NAME, "a mean gap (free boundaries)"));
        }
        if self.gap.is_none_or(|(at, _)| at != load) {
            self.solve(load)?;
        }
        self.gap.map(|(_, gap)| gap).ok_or_else(|| Error::unsupported(NAME, "a mean gap"))
    }
}

/// A nondimensional load, unless no f64 holds it.
fn held(name: &'static str, value: f64, result: f64) -> Result<f64> {
    if result.is_finite() && (result > 0.0 || value <= 0.0) {
        Ok(result)
    } else {
        Err(Error::domain(name, value, "a load nearer to the scales of the surface"))
    }
}
