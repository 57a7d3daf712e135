//! Conversion of a load into the units of the surface.

use super::options::NAME;
use super::prepared::PreparedSurface;
use crate::friction::TangentialControl;
use contact_model::{Error, Load, NormalLoad, Result, Tangential};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Largest rounding of the force of all cells at the hardness in the conversion of units.
const CAPACITY_ROUNDING: f64 = 1e-12;

/// A load in the units of the surface; forces over pi.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct ScaledLoad {
    pub normal: ScaledNormal,
    pub tangential: ScaledTangential,
}

/// A tangential load in the units of the surface. States give it back as it was prescribed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct ScaledTangential {
    pub control: TangentialControl,
    pub prescribed: Tangential,
}

/// A normal load in the units of the surface, of either sign.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) enum ScaledNormal {
    /// Sum of the net pressure.
    Force(f64),
    /// Approach from first touch of the virgin surface.
    Approach(f64),
    /// Mean gap of a periodic surface.
    MeanGap(f64),
}

/// How loads follow from each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum LoadSequence {
    /// Each load is the first one of a virgin surface.
    Single,
    /// Each load follows the last one.
    Path,
}

impl PreparedSurface {
    /// A load of the scene in the units of the surface.
    ///
    /// # Errors
    /// [`Error::Domain`] where it overflows, [`Error::Unsupported`] for a kind of load that the surface does
    /// not have and for a tangential load without friction, [`Error::OutOfRange`] for a force that all cells
    /// at the hardness do not carry.
    pub(super) fn scaled_load(&self, load: Load) -> Result<ScaledLoad> {
        if self.sliding.is_none() {
            load.without_tangential(NAME)?;
        }
        let Load { normal, tangential: prescribed } = load;
        let tangential = ScaledTangential { control: self.scaled_tangential(prescribed)?, prescribed };
        Ok(ScaledLoad { normal: self.scaled_normal(normal)?, tangential })
    }

    fn scaled_normal(&self, load: NormalLoad) -> Result<ScaledNormal> {
        let units = self.nondimensional;
        Ok(match load {
            NormalLoad::Force(asked) => {
                let force = held("force", asked, (units.force_in(asked.abs()) / PI).copysign(asked))?;
                self.refuse_beyond_hardness(force, asked)?;
                ScaledNormal::Force(force)
            }
            NormalLoad::Approach(d) if self.has_approach() => {
                ScaledNormal::Approach(held("approach", d, units.approach_in(d))?)
            }
            NormalLoad::MeanGap(gap) if self.is_periodic() => {
                ScaledNormal::MeanGap(held("mean gap", gap, units.approach_in(gap))?)
            }
            NormalLoad::Approach(_) if !self.is_periodic() => {
                let what = "an approach of a contact that goes on along a line: its displacements have no zero at infinity; give a force or a pressure";
                return Err(Error::unsupported(NAME, what));
            }
            NormalLoad::Approach(_) => {
                let what = "an approach: a periodic contact has a mean gap in its place";
                return Err(Error::unsupported(NAME, what));
            }
            other => {
                let boundary = self.problem.operators.table().boundary();
                return Err(Error::unsupported(NAME, format!("{other} with {}", boundary.words())));
            }
        })
    }

    fn scaled_tangential(&self, load: Tangential) -> Result<TangentialControl> {
        let units = self.nondimensional;
        let each = |values: [f64; 2], name, of: &dyn Fn(f64) -> f64| -> Result<[f64; 2]> {
            let [x, y] = values.map(|value| held(name, value, of(value.abs()).copysign(value)));
            Ok([x?, y?])
        };
        match load {
            Tangential::Force(force) => {
                each(force, "tangential force", &|f| units.force_in(f) / PI).map(TangentialControl::Force)
            }
            Tangential::Displacement(delta) => {
                let displacement = each(delta, "tangential displacement", &|d| units.approach_in(d));
                displacement.map(TangentialControl::Displacement)
            }
            other => Err(Error::unsupported_load(NAME, other)),
        }
    }

    /// Errors for a force that all cells at the hardness do not carry.
    fn refuse_beyond_hardness(&self, force: f64, asked: f64) -> Result<()> {
        let capacity = self.capacity();
        // A force of all cells leaves the approach open, and so does rounding below it.
        if force < capacity * (1.0 - CAPACITY_ROUNDING) {
            return Ok(());
        }
        let max = self.nondimensional.force(PI * capacity)?;
        let name = "force (at the end of the range every cell is at the hardness)".into();
        Err(Error::OutOfRange { name, value: asked, min: 0.0, max })
    }
}

/// A load in the units of the surface, unless no f64 holds it.
pub(super) fn held(name: &'static str, value: f64, result: f64) -> Result<f64> {
    if result.is_finite() && (value == 0.0 || result != 0.0) {
        Ok(result)
    } else {
        Err(Error::domain(name, value, "a load nearer to the scales of the surface"))
    }
}
