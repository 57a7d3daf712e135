//! Common code of all theories of periodic contact: a law in the mean pressure becomes a state.

use crate::closed::LoadLaw;
use contact_model::{
    Abilities, Boundary, ContactState, Error, LoadKind, NormalLoad, Output, Result, ScaledState, Scaling,
    SolveReport, SurfaceKind,
};

/// A theory of a periodic contact in the mean pressure p, in units of `E* h / L`: h is the unit of heights of
/// its
/// [`Scaling`].
pub(crate) trait PeriodicLaw: Send {
    /// Errors for a pressure > 0 beyond what the theory holds for.
    fn admit(&self, pressure: f64) -> Result<()>;
    /// `A/A0` at p > 0.
    fn fraction(&self, pressure: f64) -> Result<f64>;
    /// `-dp/d(mean gap)` at p > 0, in `E* / L`; `None` where the contact is full and the gap does not change.
    fn stiffness(&self, pressure: f64) -> Result<Option<f64>>;
    /// Mean gap at p >= 0, in h.
    fn gap(&self, pressure: f64) -> Result<f64>;
    /// The pressure at a mean gap >= 0, 0 where the surfaces are apart.
    fn pressure(&self, gap: f64) -> Result<f64>;
    /// Relative uncertainty of the stiffness from quadratures and the like.
    fn stiffness_error(&self) -> f64 {
        0.0
    }
}

/// A theory of a periodic contact.
pub(crate) struct Periodic<L> {
    pub model: &'static str,
    pub law: L,
    /// For [`SolveReport::strategy`].
    pub strategy: &'static str,
}

impl<L: PeriodicLaw> Periodic<L> {
    /// The mean pressure under a load, in units.
    fn press(&self, load: NormalLoad, scaling: &Scaling) -> Result<f64> {
        let (asked, pressure) = match load.validated()? {
            NormalLoad::Force(force) => (force > 0.0, scaling.nondimensional.force_in(force)),
            NormalLoad::MeanGap(gap) => (false, self.law.pressure(scaling.nondimensional.approach_in(gap))?),
            NormalLoad::Approach(_) => {
                let what = "an approach: a periodic contact has a mean gap in its place";
                return Err(Error::unsupported(self.model, what));
            }
            _ => return Err(Error::unsupported_load(self.model, load)),
        };
        if !pressure.is_finite() || (asked && pressure <= 0.0) {
            return Err(Error::not_representable("mean pressure over E* h/L", pressure));
        }
        if pressure > 0.0 {
            self.law.admit(pressure)?;
        }
        Ok(pressure)
    }
}

impl<L: PeriodicLaw> LoadLaw for Periodic<L> {
    fn state(&self, load: NormalLoad, scaling: &Scaling) -> Result<ContactState> {
        let pressure = self.press(load, scaling)?;
        let outputs = scaling.outputs;
        let stiffness = match outputs.needs_stiffness() {
            true if pressure > 0.0 => self.law.stiffness(pressure)?,
            asked => asked.then_some(0.0),
        };
        let fraction = || if pressure > 0.0 { self.law.fraction(pressure) } else { Ok(0.0) };
        let scaled = ScaledState {
            force: pressure,
            area: outputs.area.then(fraction).transpose()?,
            stiffness_error: self.law.stiffness_error(),
            ..ScaledState::default()
        };
        let report = SolveReport::formula(self.strategy, load);
        let state = scaling.state(scaled.with_elastic_stiffness(stiffness), load, report)?;
        let gap = |p: f64| self.law.gap(p).and_then(|gap| scaling.nondimensional.approach(gap));
        Ok(state.with_mean_gap(match load {
            _ if !outputs.mean_gap => None,
            NormalLoad::MeanGap(gap) => Some(gap),
            // Some theories have none without load.
            _ => gap(pressure).ok(),
        }))
    }
}

/// A periodic contact, which has a mean gap and no approach: no surface yet.
const PERIODIC: Abilities = Abilities {
    boundaries: &[Boundary::Periodic],
    loads: &[LoadKind::Force, LoadKind::MeanGap],
    outputs: &[
        Output::Stiffness,
        Output::StiffnessFixedArea,
        Output::Conductance,
        Output::Area,
        Output::MeanGap,
    ],
    ..Abilities::ELASTIC
};

/// That of a wave.
pub(crate) const WAVE: Abilities = Abilities { surfaces: &[SurfaceKind::Sine], ..PERIODIC };

/// That of theories of random surfaces.
pub(crate) const RANDOM: Abilities =
    Abilities { surfaces: &[SurfaceKind::SelfAffine, SurfaceKind::Heights], ..PERIODIC };
