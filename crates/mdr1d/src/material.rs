//! A linear viscoelastic material under piecewise linear loads: relaxation and creep in closed form.
//!
//! With `E*(t) = E* (e + sum w_i exp(-r_i t)) + E* v delta(t)` a load `Phi(t)` (what an elastic contact with
//! modulus 1 would carry) gives the force `F/E* = e Phi + sum w_i q_i + v Phi'` with `q_i' = Phi' - r_i q_i`:
//! Boltzmann's integral with one memory per arm. The other way round, a straight force gives Phi as a
//! parabola and exponentials whose rates are the zeros of `e + sum w_i s/(s + r_i) + v s`; they lie one
//! between each pair of neighbouring r_i, and are found once.

use contact_model::{RelaxationSpectrum, RelaxingRate};
use numerics::root;

/// A material by its relaxation, with its rates of creep.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViscoelasticMaterial {
    relaxation: RelaxationSpectrum,
    /// Rates of creep under a constant force, > 0.
    creep: Vec<f64>,
}

/// The memory of the material.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViscousMemory {
    /// Phi.
    pub load: f64,
    /// q_i.
    arms: Vec<f64>,
    /// F/E*.
    pub force: f64,
}

/// Phi on a segment, from its value at the beginning: `b s + c s^2/2 + sum m (exp(-x s) - 1)`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Creep {
    /// `Phi'(0) = b - sum m x`, without the cancellation.
    start: f64,
    b: f64,
    c: f64,
    modes: Vec<Mode>,
    /// What b and c may owe to the rounding of the force, over an epsilon: a speed.
    noise: f64,
}

/// `size (exp(-rate s) - 1)`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mode {
    size: f64,
    rate: f64,
    /// The sum of the magnitudes whose difference the size is.
    magnitude: f64,
}

impl ViscoelasticMaterial {
    /// The material with this relaxation.
    pub fn new(relaxation: RelaxationSpectrum) -> Self {
        let mut material = Self { relaxation, creep: Vec::new() };
        material.creep = material.creep_rates();
        material
    }

    /// Before any load.
    pub fn fresh(&self) -> ViscousMemory {
        ViscousMemory { load: 0.0, arms: vec![0.0; self.relaxation.arms.len()], force: 0.0 }
    }

    /// Whether a jump of the load takes an infinite force.
    pub fn is_stiff(&self) -> bool {
        self.relaxation.is_stiff()
    }

    /// The rates of the arms.
    pub fn rates(&self) -> impl Iterator<Item = f64> + '_ {
        self.relaxation.arms.iter().map(|arm| arm.rate)
    }

    /// After a jump of Phi (only where [`ViscoelasticMaterial::is_stiff`] is false).
    pub fn jumped(&self, memory: &ViscousMemory, by: f64) -> ViscousMemory {
        let arms = memory.arms.iter().map(|q| q + by).collect();
        self.with_force(memory.load + by, arms, 0.0)
    }

    /// After a jump of the force: elastic with all arms, or nothing where a dashpot holds everything.
    pub fn jumped_to_force(&self, memory: &ViscousMemory, force: f64) -> ViscousMemory {
        if self.is_stiff() {
            return ViscousMemory { force, ..memory.clone() };
        }
        let glassy =
            self.relaxation.equilibrium + self.relaxation.arms.iter().map(|arm| arm.weight).sum::<f64>();
        let by = (force - memory.force) / glassy;
        ViscousMemory { force, ..self.jumped(memory, by) }
    }

    /// After a segment in which Phi went to `load` and ended with the rate `speed`; `integrals` are
    /// `int exp(-r_i (D - s)) Phi'(s) ds` over it.
    pub fn relaxed(
        &self,
        memory: &ViscousMemory,
        duration: f64,
        load: f64,
        speed: f64,
        integrals: &[f64],
    ) -> ViscousMemory {
        let arms = self
            .relaxation
            .arms
            .iter()
            .zip(&memory.arms)
            .zip(integrals)
            .map(|((arm, q), integral)| q * (-arm.rate * duration).exp() + integral)
            .collect();
        self.with_force(load, arms, speed)
    }

    /// Phi during a segment of this duration in which the force goes straight from the memory's to `force`.
    pub fn creep(&self, memory: &ViscousMemory, force: f64, duration: f64) -> Creep {
        let slope = (force - memory.force) / duration;
        let moment =
            |k: i32| self.relaxation.arms.iter().map(|arm| arm.weight * arm.rate.powi(-k)).sum::<f64>();
        let first = moment(1) + self.relaxation.viscous;
        let held = |f: &dyn Fn(&RelaxingRate) -> f64| -> f64 {
            self.relaxation.arms.iter().zip(&memory.arms).map(|(arm, q)| f(arm) * q).sum()
        };
        let start = if self.relaxation.viscous > 0.0 {
            (memory.force - self.relaxation.equilibrium * memory.load - held(&|arm| arm.weight))
                / self.relaxation.viscous
        } else {
            (slope + held(&|arm| arm.weight * arm.rate)) / (self.relaxation.equilibrium + moment(0))
        };
        // How b follows the slope, what a fluid flows under the force at the beginning, and c.
        let (follows, flows, c) = if self.relaxation.equilibrium > 0.0 {
            (self.relaxation.equilibrium.recip(), 0.0, 0.0)
        } else {
            // s/E(s) = h_0 + h_1 s + ....
            let h0 = first.recip();
            (moment(2) * h0 * h0, memory.force * h0, slope * h0)
        };
        let b = slope * follows + flows;
        let modes = self
            .creep
            .iter()
            .map(|&x| {
                let s = -x;
                let derivative = self.relaxation.viscous
                    + self
                        .relaxation
                        .arms
                        .iter()
                        .map(|arm| arm.weight * arm.rate / (s + arm.rate).powi(2))
                        .sum::<f64>();
                // The transform at its pole: the force, what the arms still hold back, the dashpot.
                let (mut sum, mut magnitude) = (0.0, 0.0);
                let mut add = |term: f64| {
                    sum += term;
                    magnitude += term.abs();
                };
                add(memory.force / s);
                add(slope / (s * s));
                add(self.relaxation.viscous * memory.load);
                for (arm, q) in self.relaxation.arms.iter().zip(&memory.arms) {
                    add(arm.weight * (memory.load - q) / (s + arm.rate));
                }
                Mode { size: sum / derivative, rate: x, magnitude: magnitude / derivative }
            })
            .collect();
        let noise = memory.force.max(force) / duration * follows;
        Creep { start, b, c, modes, noise }
    }

    /// The memory at a time within such a segment.
    pub fn crept(&self, memory: &ViscousMemory, creep: &Creep, at: f64, force: f64) -> ViscousMemory {
        let integrals: Vec<f64> = self.rates().map(|rate| creep.remembered(rate, at)).collect();
        let mut end = self.relaxed(memory, at, memory.load + creep.rise(at), creep.speed(at), &integrals);
        end.force = force;
        end
    }

    /// Relative difference between the force of a memory, from its arms, and the prescribed force.
    pub fn residual(&self, memory: &ViscousMemory, speed: f64) -> f64 {
        let force = self.force(memory.load, &memory.arms, speed);
        if memory.force > 0.0 { (force / memory.force - 1.0).abs() } else { 0.0 }
    }

    fn with_force(&self, load: f64, arms: Vec<f64>, speed: f64) -> ViscousMemory {
        let force = self.force(load, &arms, speed);
        ViscousMemory { load, arms, force }
    }

    fn force(&self, load: f64, arms: &[f64], speed: f64) -> f64 {
        let held: f64 = self.relaxation.arms.iter().zip(arms).map(|(arm, q)| arm.weight * q).sum();
        self.relaxation.equilibrium * load + held + self.relaxation.viscous * speed
    }

    /// Zeros x of `E(-x) = e - sum w_i x/(r_i - x) - v x`, which falls between its poles.
    fn creep_rates(&self) -> Vec<f64> {
        let minus = |x: f64| {
            let arms = self.relaxation.arms.iter().map(|arm| arm.weight * x / (arm.rate - x));
            arms.sum::<f64>() + self.relaxation.viscous * x - self.relaxation.equilibrium
        };
        let mut edges: Vec<f64> = self.rates().collect();
        if self.relaxation.equilibrium > 0.0 {
            edges.insert(0, 0.0);
        }
        if self.relaxation.viscous > 0.0 {
            // Beyond the last pole the dashpot wins at the latest where it outweighs everything else.
            let sum =
                self.relaxation.equilibrium + self.relaxation.arms.iter().map(|arm| arm.weight).sum::<f64>();
            let last = edges.last().copied().unwrap_or(0.0);
            edges.push(2.0 * (last + 2.0 * sum / self.relaxation.viscous));
        }
        edges
            .windows(2)
            .map(|w| {
                // At a pole itself a quotient has the sign of the other side.
                root::between(w[0], w[1], |x| {
                    if x <= w[0] {
                        f64::NEG_INFINITY
                    } else if x >= w[1] {
                        f64::INFINITY
                    } else {
                        minus(x)
                    }
                })
            })
            .collect()
    }
}

impl Creep {
    /// Whether a time is so short that the modes nearly cancel `b`: then from the speed at the beginning,
    /// else from b.
    fn is_short(&self, s: f64) -> bool {
        self.modes.iter().all(|mode| mode.rate * s < 1.0)
    }

    /// `Phi(s) - Phi(0)`.
    pub fn rise(&self, s: f64) -> f64 {
        let modes = self.modes.iter();
        let rest: f64 = if self.is_short(s) {
            self.start * s + modes.map(|mode| mode.size * bend(mode.rate * s)).sum::<f64>()
        } else {
            self.b * s + modes.map(|mode| mode.size * (-mode.rate * s).exp_m1()).sum::<f64>()
        };
        rest + 0.5 * self.c * s * s
    }

    /// `Phi'(s)`.
    pub fn speed(&self, s: f64) -> f64 {
        let modes = self.modes.iter();
        let rest: f64 = if self.is_short(s) {
            self.start - modes.map(|mode| mode.size * mode.rate * (-mode.rate * s).exp_m1()).sum::<f64>()
        } else {
            self.b - modes.map(|mode| mode.size * mode.rate * (-mode.rate * s).exp()).sum::<f64>()
        };
        rest + self.c * s
    }

    /// Whether Phi falls at a time, beyond what rounding explains.
    fn falls(&self, s: f64) -> bool {
        /// Some hundred roundings.
        const ROUNDING: f64 = 1e-13;
        let modes: f64 =
            self.modes.iter().map(|mode| mode.magnitude * mode.rate * (-mode.rate * s).exp()).sum();
        self.speed(s) < -ROUNDING * (self.noise + self.b.abs() + self.c.abs() * s + modes)
    }

    /// The first time within the segment from which Phi falls, beyond rounding; found between samples that
    /// resolve every rate.
    pub fn first_fall(&self, duration: f64) -> Option<f64> {
        /// Samples per octave of time, and octaves below the shortest time.
        const PER_OCTAVE: i32 = 8;
        const OCTAVES: i32 = 12;
        if self.falls(0.0) {
            return Some(0.0);
        }
        let fastest = self.modes.iter().fold(duration.recip(), |fastest, mode| fastest.max(mode.rate));
        let octaves = (duration * fastest).log2().ceil() as i32 + OCTAVES;
        let steps = octaves * PER_OCTAVE;
        let mut last = 0.0;
        for i in 0..=steps {
            let s = duration * 2.0_f64.powf(f64::from(i - steps) / f64::from(PER_OCTAVE));
            if self.falls(s) {
                return Some(root::between(last, s, |s| -self.speed(s)));
            }
            last = s;
        }
        None
    }

    /// `int_0^D exp(-r (D - s)) Phi'(s) ds`.
    fn remembered(&self, rate: f64, duration: f64) -> f64 {
        let z = rate * duration;
        let constant = duration * mean_decay(z);
        // int exp(-r (D - s)) s ds = D^2 (z - 1 + exp(-z))/z^2.
        let linear =
            if z > SMALL { (duration - constant) / rate } else { duration * duration * bend_over_square(z) };
        let modes: f64 = self
            .modes
            .iter()
            .map(|mode| {
                // int exp(-r (D - s)) exp(-x s) ds, from the slower of the two.
                let slow = mode.rate.min(rate);
                let apart = (mode.rate - rate).abs() * duration;
                mode.size * mode.rate * duration * (-slow * duration).exp() * mean_decay(apart)
            })
            .sum();
        self.b * constant + self.c * linear - modes
    }
}

/// `exp(-z) - 1 + z`.
fn bend(z: f64) -> f64 {
    if z > SMALL { (-z).exp_m1() + z } else { z * z * bend_over_square(z) }
}

/// Below it `exp(-z) - 1 + z` is summed as a series.
const SMALL: f64 = 0.1;

/// `(exp(-z) - 1 + z)/z^2` for z up to [`SMALL`].
fn bend_over_square(z: f64) -> f64 {
    // 1/2 - z/3! + z^2/4!...
    let mut term = 0.5;
    let mut sum = 0.5;
    for k in 3..13 {
        term *= -z / f64::from(k);
        sum += term;
    }
    sum
}

/// `(1 - exp(-z))/z`.
fn mean_decay(z: f64) -> f64 {
    if z > 0.0 { -(-z).exp_m1() / z } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::{PronySeries, Relaxing, Rheology};

    const ROUNDING: f64 = 1e-12;

    fn prony(arms: &[(f64, f64)]) -> ViscoelasticMaterial {
        let arms: Vec<Relaxing> = arms.iter().map(|&(weight, time)| Relaxing { weight, time }).collect();
        let series = PronySeries::new(&arms).unwrap();
        of(&Rheology::Prony(series), 1.0)
    }

    fn of(rheology: &Rheology, modulus: f64) -> ViscoelasticMaterial {
        ViscoelasticMaterial::new(rheology.spectrum(modulus).unwrap().unwrap())
    }

    #[test]
    fn creep_rates_of_known_materials() {
        // Standard solid: 1/(tau (1 + w)). Kelvin-Voigt: G/eta = E*/(4 eta). Maxwell: none, it flows.
        let solid = prony(&[(3.0, 2.0)]);
        assert_relative_eq!(solid.creep[0], 1.0 / 8.0, max_relative = ROUNDING);
        let voigt = of(&Rheology::KelvinVoigt { viscosity: 0.5 }, 4.0);
        assert_relative_eq!(voigt.creep[0], 2.0, max_relative = ROUNDING);
        let maxwell = of(&Rheology::Maxwell { viscosity: 1.0 }, 1.0);
        assert!(maxwell.creep.is_empty());
        // Equal times are one arm, arms without weight are none; zeros and poles alternate.
        assert_eq!(prony(&[(1.0, 2.0), (0.0, 5.0), (2.0, 2.0)]), solid);
        let many = prony(&[(1.0, 1e-3), (0.2, 1.0), (5.0, 1.1), (1e-9, 30.0), (2.0, 1e4)]);
        for (x, arm) in many.creep.iter().zip(&many.relaxation.arms) {
            assert!(*x < arm.rate);
        }
        for (x, arm) in many.creep.iter().skip(1).zip(&many.relaxation.arms) {
            assert!(*x > arm.rate);
        }
    }

    #[test]
    fn a_force_and_its_creep_fit_each_other() {
        // Over segments of any length the arms give back the force that was asked for, at the end and on the
        // way.
        for material in [
            prony(&[(3.0, 2.0)]),
            prony(&[(1.0, 1e-2), (0.5, 1.0), (2.0, 70.0)]),
            of(&Rheology::Maxwell { viscosity: 0.3 }, 1.0),
            of(&Rheology::KelvinVoigt { viscosity: 0.3 }, 1.0),
        ] {
            let mut memory = material.fresh();
            for (force, duration) in [(1.0, 1e-6), (1.5, 0.1), (2.0, 30.0), (1.9, 1e-3), (4.0, 1e4)] {
                let creep = material.creep(&memory, force, duration);
                for part in [1e-3, 0.5, 1.0] {
                    let at = part * duration;
                    let expected = memory.force + part * (force - memory.force);
                    let state = material.crept(&memory, &creep, at, expected);
                    let residual = material.residual(&state, creep.speed(at));
                    assert!(residual < ROUNDING, "{material:?} {duration} {part}: {residual}");
                }
                memory = material.crept(&memory, &creep, duration, force);
            }
        }
    }

    #[test]
    fn a_fall_is_found_where_the_speed_changes_sign() {
        // Phi' = 1 - 2 (1 - exp(-s)) = 2 exp(-s) - 1: ln 2.
        let mode = Mode { size: -2.0, rate: 1.0, magnitude: 2.0 };
        let creep = Creep { start: 1.0, b: -1.0, c: 0.0, modes: vec![mode], noise: 1.0 };
        assert_relative_eq!(creep.speed(0.0), 1.0);
        assert_relative_eq!(creep.first_fall(10.0).unwrap(), 2.0_f64.ln(), max_relative = 1e-12);
        assert!(creep.first_fall(0.6).is_none());
        assert_relative_eq!(Creep { start: -1.0, modes: vec![], ..creep }.first_fall(1.0).unwrap(), 0.0);
    }
}
