//! What all theories of periodic contact share: a law in the mean pressure becomes a [`PreparedContact`].

use contact_model::{
    ContactState, Error, Load, LoadKind, Nondimensionalisation, Normalisation, Outputs, PreparedContact,
    Result, SolveReport, Stop,
};

/// A theory of a periodic contact in the mean pressure p, in units of `E* h / L`: h is the unit of heights of its [`Periodic`].
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

/// A periodic law with its normalisation and what is asked of it.
pub(crate) struct Periodic<L> {
    pub model: &'static str,
    pub law: L,
    pub nondimensional: Nondimensionalisation,
    pub normalisation: Normalisation,
    pub outputs: Outputs,
    /// For [`SolveReport::strategy`].
    pub strategy: &'static str,
}

impl<L: PeriodicLaw> Periodic<L> {
    /// The mean pressure under a load, in units.
    fn press(&self, load: Load) -> Result<f64> {
        let (asked, pressure) = match load.validated()? {
            Load::Force(force) => (force > 0.0, self.nondimensional.force_in(force)),
            Load::MeanGap(gap) => (false, self.law.pressure(self.nondimensional.approach_in(gap))?),
            Load::Approach(_) => {
                let what = "an approach: a periodic contact has a mean gap (Load::MeanGap)";
                return Err(Error::unsupported(self.model, what));
            }
            _ => return Err(Error::unsupported(self.model, format!("the load {load:?}"))),
        };
        if !pressure.is_finite() || (asked && pressure <= 0.0) {
            let expected = "a number within the range of f64";
            return Err(Error::domain("mean pressure over E* h/L", pressure, expected));
        }
        if pressure > 0.0 {
            self.law.admit(pressure)?;
        }
        Ok(pressure)
    }
}

impl<L: PeriodicLaw> PreparedContact for Periodic<L> {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let pressure = self.press(load)?;
        let or_none = |f: &dyn Fn(f64) -> Result<f64>| if pressure > 0.0 { f(pressure) } else { Ok(0.0) };
        let nondimensional = self.nondimensional;
        let force = match load {
            Load::Force(force) => force,
            _ => nondimensional.force(pressure)?,
        };
        let stiffness = match self.outputs.needs_stiffness() {
            true if pressure > 0.0 => self.law.stiffness(pressure)?,
            asked => asked.then_some(0.0),
        };
        let stiffness = stiffness.map(|stiffness| nondimensional.stiffness(stiffness)).transpose()?;
        let area = self
            .outputs
            .area
            .then(|| nondimensional.area(or_none(&|p| self.law.fraction(p))?))
            .transpose()?;
        let mut report = SolveReport::exact(self.strategy);
        report.certificate.stiffness_error = stiffness.map(|_| self.law.stiffness_error());
        let gap = |p: f64| self.law.gap(p).and_then(|gap| nondimensional.approach(gap));
        let mean_gap = match load {
            _ if !self.outputs.mean_gap => None,
            Load::MeanGap(gap) => Some(gap),
            // Some theories have none without load.
            _ => gap(pressure).ok(),
        };
        ContactState::new(force, report)
            .with_mean_gap(mean_gap)
            .with_elastic_stiffness(stiffness)
            .with_area(area)
            .completed(&self.outputs, self.normalisation.modulus)
    }
}

/// What may be prescribed: a periodic contact has a mean gap and no approach.
pub(crate) const LOADS: &[LoadKind] = &[LoadKind::Force, LoadKind::MeanGap];
