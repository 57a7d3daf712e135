//! A growing contact of a viscoelastic material, step by step: Boltzmann's integral over the elastic law of a
//! profile.

use crate::axisymmetric::RoundContact;
use crate::material::{ViscoelasticMaterial, ViscousMemory};
use crate::shape::Shape;
use contact_model::{Error, Result, Step};
use numerics::gauss::Gauss;

/// Current state of a history; lengths in L, forces in E* L^2.
#[derive(Debug, Clone)]
pub(crate) struct RelaxedState {
    pub time: f64,
    /// The elastic contact with this approach.
    pub contact: RoundContact,
    pub memory: ViscousMemory,
    /// Relative difference between the force from the arms and the prescribed force.
    pub residual: f64,
}

impl RelaxedState {
    /// Checks that its numbers are finite.
    pub fn check(&self) -> Result<()> {
        for value in [self.memory.force, self.memory.load, self.contact.approach] {
            if !value.is_finite() {
                return Err(Error::domain("state in units of side and modulus", value, "a finite number"));
            }
        }
        Ok(())
    }
}

/// A material and its history. The elastic law comes with each step: contacts that are numbers of another
/// model differ by its tolerance.
#[derive(Debug, Clone)]
pub(crate) struct Relaxation {
    material: ViscoelasticMaterial,
    pub at: RelaxedState,
    model: &'static str,
}

impl Relaxation {
    /// Before any contact; the name is for errors.
    pub fn new(material: ViscoelasticMaterial, model: &'static str) -> Self {
        let memory = material.fresh();
        let contact = RoundContact::NONE;
        Self { at: RelaxedState { time: 0.0, contact, memory, residual: 0.0 }, material, model }
    }

    /// A step that goes on from here, without a tangential load.
    pub fn validated(&self, step: Step) -> Result<Step> {
        let step = step.validated(self.at.time)?;
        step.load.without_tangential(self.model)?;
        Ok(step)
    }

    /// Back to no contact at time 0.
    pub fn restart(&mut self) {
        self.at = Self::new(self.material.clone(), self.model).at;
    }

    /// The history after a step by approach; `press` gives the elastic contact there and a profile that
    /// reaches so deep.
    pub fn by_approach<P: Shape>(
        &self,
        time: f64,
        approach: f64,
        press: impl FnOnce(f64) -> Result<(RoundContact, P)>,
    ) -> Result<RelaxedState> {
        let (from, duration) = (&self.at, time - self.at.time);
        if approach < from.contact.approach * (1.0 - ROUNDED_DOWN) {
            return Err(shrinks(time, from.time));
        }
        // A conversion may have rounded a constant approach down.
        let approach = approach.max(from.contact.approach);
        if duration <= 0.0 && self.material.is_stiff() && approach > from.contact.approach {
            let what = "a jump of the approach (a dashpot in parallel takes an infinite force)";
            return Err(Error::unsupported(self.model, what));
        }
        let (contact, profile) = press(approach)?;
        let memory = if duration > 0.0 {
            let speed = (approach - from.contact.approach) / duration;
            let integrals: Vec<f64> = self
                .material
                .rates()
                .map(|rate| remembered(&profile, from.contact.approach, speed, rate, duration))
                .collect();
            let end = 2.0 * contact.radius * speed;
            self.material.relaxed(&from.memory, duration, contact.force, end, &integrals)
        } else {
            self.material.jumped(&from.memory, contact.force - from.contact.force)
        };
        Ok(RelaxedState { time, contact: RoundContact { approach, ..contact }, memory, residual: 0.0 })
    }

    /// The history after a step by force; `press` gives the elastic contact under a force.
    pub fn by_force(
        &self,
        time: f64,
        force: f64,
        press: impl FnOnce(f64) -> Result<RoundContact>,
    ) -> Result<RelaxedState> {
        let (from, duration) = (&self.at, time - self.at.time);
        let (memory, residual) = if duration > 0.0 {
            let creep = self.material.creep(&from.memory, force, duration);
            if let Some(fall) = creep.first_fall(duration) {
                return Err(shrinks(time, from.time + fall));
            }
            let memory = self.material.crept(&from.memory, &creep, duration, force);
            let residual = self.material.residual(&memory, creep.speed(duration));
            (memory, residual)
        } else {
            (self.material.jumped_to_force(&from.memory, force), 0.0)
        };
        if memory.load < from.memory.load * (1.0 - ROUNDED_DOWN) {
            return Err(shrinks(time, from.time));
        }
        // Rounding, and the tolerance of whoever presses, never make the contact shrink.
        let contact = press(memory.load.max(from.memory.load))?;
        let approach = contact.approach.max(from.contact.approach);
        Ok(RelaxedState { time, contact: RoundContact { approach, ..contact }, memory, residual })
    }
}

/// Approaches and loads that fall by less are taken for constant: they have been through conversions.
const ROUNDED_DOWN: f64 = 1e-12;

fn shrinks(time: f64, from: f64) -> Error {
    Error::OutOfRange {
        name: "time (after the largest admissible one the contact would shrink)".into(),
        value: time,
        min: 0.0,
        max: from,
    }
}

/// `int_0^D exp(-r (D - s)) 2 a(d_0 + v s) v ds` by Gauss's rule.
///
/// Panels double away from the end of the segment, in units of 1/r, and in d away from 0, and end where
/// x(gamma) has a kink: the decay and the power of d are smooth on each.
fn remembered(profile: &impl Shape, from: f64, speed: f64, rate: f64, duration: f64) -> f64 {
    /// exp(-64) is nothing beside the rest.
    const DOUBLINGS: i32 = 6;
    /// Halvings of d below which d^(1 + 1/n) is nothing.
    const HALVINGS: i32 = 60;
    if speed <= 0.0 {
        return 0.0;
    }
    let to = from + speed * duration;
    // Distances from the end, as times.
    let longest = duration.min(2.0_f64.powi(DOUBLINGS) / rate);
    let mut edges = vec![0.0, longest];
    edges.extend((0..DOUBLINGS).map(|i| 2.0_f64.powi(i) / rate).filter(|edge| *edge < longest));
    edges.extend(
        (1..=HALVINGS)
            .map(|i| to * 2.0_f64.powi(-i))
            .take_while(|d| *d > from)
            .map(|d| (to - d) / speed)
            .filter(|edge| *edge < longest),
    );
    let kinks = profile.kinks(to - speed * longest, to).into_iter().map(|d| (to - d) / speed);
    edges.extend(kinks.filter(|edge| *edge > 0.0 && *edge < longest));
    edges.sort_by(f64::total_cmp);
    let gauss = Gauss::<16>::new();
    let nodes = gauss.nodes();
    edges
        .windows(2)
        .map(|w| {
            let (middle, half) = (0.5 * (w[0] + w[1]), 0.5 * (w[1] - w[0]));
            let sum: f64 = nodes
                .iter()
                .map(|(x, weight)| {
                    let back = middle + half * x;
                    weight * (-rate * back).exp() * profile.radius((to - speed * back).max(from))
                })
                .sum();
            2.0 * speed * half * sum
        })
        .sum()
}
