//! States of adhesion against their own tractions: the closed forms give force, approach and gaps; here the
//! tractions of a state are integrated, and the displacements follow from the half-space's influence
//! function.

#![allow(clippy::unwrap_used)]

use analytic::maugis_dugdale::MaugisSphere;
use analytic::{AdhesiveWave, MaugisDugdale};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use contact_model::{Adhesion, AdhesionLaw, Boundary, ContactModel, Load, Scene, Size, Surface};
use std::f64::consts::{FRAC_PI_2, PI};

/// The double exponential rule at its step is exact to rounding. Distances from the edge of the contact,
/// which are differences, and a displacement that is a difference of larger ones take four digits.
const QUADRATURE: f64 = 1e-11;
/// Step of an expansion at the edge of a contact, over the shorter of contact and gap.
const EDGE_STEP: f64 = 1e-4;
/// What two steps of Richardson's leave of that expansion: the third power of the step times numbers up to
/// 1e3, and the rounding of gaps that are 1e-3 of the amplitude.
const EDGE: f64 = 1e-8;

/// Integral by the double exponential rule of Takahasi and Mori (Publ. RIMS 9, 721 (1974)): the integrand may
/// have roots and logarithms at both ends.
fn integral(low: f64, high: f64, function: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 1.0 / 16.0;
    // The weight is 1e-22 there.
    const LAST: i32 = 56;
    let half = 0.5 * (high - low);
    let point = |i: i32| {
        let t = STEP * f64::from(i);
        let x = FRAC_PI_2 * t.sinh();
        // Distance from the nearer end.
        let distance = half * (-x.abs()).exp() / x.cosh();
        let position = if x < 0.0 { low + distance } else { high - distance };
        half * FRAC_PI_2 * t.cosh() / x.cosh().powi(2) * function(position)
    };
    STEP * (-LAST..=LAST).map(point).sum::<f64>()
}

#[test]
fn the_rule_integrates_roots_and_logarithms() {
    assert_relative_eq!(integral(0.0, 2.0, f64::sqrt), 2.0_f64.powf(1.5) / 1.5, max_relative = QUADRATURE);
    assert_relative_eq!(integral(0.0, 1.0, f64::ln), -1.0, max_relative = QUADRATURE);
    assert_relative_eq!(
        integral(0.0, 1.0, |x| (1.0 - x).max(f64::MIN_POSITIVE).ln()),
        -1.0,
        max_relative = QUADRATURE
    );
}

/// Tractions of Maugis's sphere: `s0` between a and c, and compressive ones inside a that meet them there.
struct Zone {
    contact_modulus: f64,
    radius: f64,
    attraction: f64,
    contact: f64,
    cohesive: f64,
}

impl Zone {
    /// Pressure at r (Maugis, J. Colloid Interface Sci. 150, 243 (1992), Sec. 6).
    fn pressure(&self, r: f64) -> f64 {
        let (a, c) = (self.contact, self.cohesive);
        if r >= a {
            return -self.attraction;
        }
        let (inside, outside) = (((a - r) * (a + r)).sqrt(), ((c - a) * (c + a)).sqrt());
        2.0 * self.contact_modulus / (PI * self.radius) * inside
            - 2.0 / PI * self.attraction * (outside / inside).atan()
    }

    /// Integral over the rings where there are tractions, cut at another radius.
    fn rings(&self, cut: f64, function: impl Fn(f64) -> f64) -> f64 {
        let mut ends = [0.0, self.contact, self.cohesive, cut.min(self.cohesive)];
        ends.sort_by(f64::total_cmp);
        ends.windows(2).filter(|ends| ends[0] < ends[1]).map(|e| integral(e[0], e[1], &function)).sum()
    }

    fn force(&self) -> f64 {
        self.rings(0.0, |r| 2.0 * PI * r * self.pressure(r))
    }

    /// Boussinesq's displacement at r: a ring of radius s and pressure p moves it by
    /// `4 p s ds/(pi E* (r + s)) K(4 r s/(r + s)^2)`, with K from the arithmetic-geometric mean.
    fn displacement(&self, r: f64) -> f64 {
        self.rings(r, |s| {
            let near = (r - s).abs().max(f64::MIN_POSITIVE);
            2.0 / self.contact_modulus * self.pressure(s) * s / mean_of_arithmetic_and_geometric(r + s, near)
        })
    }
}

fn mean_of_arithmetic_and_geometric(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

#[test]
fn a_state_is_what_its_tractions_do() {
    let (contact_modulus, radius, work) = (2.0, 3.0, 1e-3);
    // lambda of 0.05, 0.5, 5 and 50.
    for range in [0.2, 0.02, 2e-3, 2e-4] {
        let sphere = MaugisSphere::new(radius, contact_modulus, work, range).unwrap();
        let mut scene = Scene::new(Surface::Sphere { radius, size: 20.0.into() }, contact_modulus);
        scene.effects.adhesion = Adhesion::FiniteRange { work, range, law: AdhesionLaw::Dugdale };
        scene.outputs.area = true;
        let mut model = MaugisDugdale.prepare(&scene, 0).unwrap();
        let pulled = sphere.pull_off_at_force().unwrap().force;
        for load in [0.95 * pulled, 0.5 * pulled, 0.0, 0.1].map(Load::force) {
            let state = model.solve(load).unwrap();
            let contact = (state.area.unwrap() / PI).sqrt();
            let cohesive = sphere.cohesive_radius(contact).unwrap();
            let zone = Zone { contact_modulus, radius, attraction: work / range, contact, cohesive };
            // Forces cancel to 0; heights of the state are of this size.
            let unit = PI * work * radius + state.force;
            assert_abs_diff_eq!(zone.force(), state.force, epsilon = QUADRATURE * unit.abs().max(work));
            let height = contact * contact / radius + range;
            let approach = state.approach.unwrap();
            let gap = |r: f64| r * r / (2.0 * radius) + zone.displacement(r) - approach;
            for share in [1e-6, 0.2, 0.5, 0.9, 0.999] {
                assert_abs_diff_eq!(gap(share * contact), 0.0, epsilon = QUADRATURE * height);
            }
            // The gap closes as (r - a)^(3/2): no stress is singular.
            for share in [0.01, 0.1, 0.5, 0.9] {
                let inside = gap(contact + share * (cohesive - contact));
                assert!(inside > 0.0 && inside < range, "{inside}");
            }
            assert_abs_diff_eq!(gap(cohesive), range, epsilon = QUADRATURE * height);
            for share in [1.01, 1.5, 4.0] {
                assert!(gap(share * cohesive) > range);
            }
        }
    }
}

/// Tractions of Johnson's wave: Westergaard's pressure, and those of the bonded strips under a mean tension.
struct JohnsonWave {
    amplitude: f64,
    wavelength: f64,
    contact_modulus: f64,
    /// `pi a/w`.
    psi: f64,
    tension: f64,
}

impl JohnsonWave {
    fn full(&self) -> f64 {
        PI * self.contact_modulus * self.amplitude / self.wavelength
    }

    /// Pressure at `x < a`.
    fn pressure(&self, x: f64) -> f64 {
        let angle = PI * x / self.wavelength;
        let root = ((self.psi - angle).sin() * (self.psi + angle).sin()).sqrt();
        angle.cos() * (2.0 * self.full() * root - self.tension / root)
    }

    /// `p dx/dt` with `sin(pi x/w) = sin psi sin t`, which takes the root at the edge away.
    fn pressure_by_angle(&self, t: f64) -> f64 {
        let sine = self.psi.sin() * t.sin();
        let x = self.wavelength / PI * sine.asin();
        let by_angle = self.wavelength / PI * self.psi.sin() * t.cos() / ((1.0 - sine) * (1.0 + sine)).sqrt();
        let root = self.psi.sin() * t.cos();
        let cosine = (PI * x / self.wavelength).cos();
        cosine * (2.0 * self.full() * root - self.tension / root) * by_angle
    }

    fn mean_pressure(&self) -> f64 {
        2.0 / self.wavelength * integral(0.0, FRAC_PI_2, |t| self.pressure_by_angle(t))
    }

    /// Displacement of mean 0 at x: that of a line load is `-2/(pi E*) ln|2 sin(pi x/w)|` in the period; the
    /// loads at x and -x together make `ln|4 (sin^2 - sin^2)|`.
    fn displacement(&self, x: f64) -> f64 {
        let (angle, sine) = (PI * x / self.wavelength, self.psi.sin());
        let inside = (angle < self.psi).then(|| (angle.sin() / sine).asin());
        let kernel = |t: f64| {
            let difference = match inside {
                Some(own) => sine * sine * (own - t).sin() * (own + t).sin(),
                None => (angle - self.psi).sin() * (angle + self.psi).sin() + sine * sine * t.cos().powi(2),
            };
            difference.abs().max(f64::MIN_POSITIVE)
        };
        let part = |low, high| integral(low, high, |t| self.pressure_by_angle(t) * (4.0 * kernel(t)).ln());
        let cut = inside.unwrap_or(FRAC_PI_2);
        let parts = part(0.0, cut) + if cut < FRAC_PI_2 { part(cut, FRAC_PI_2) } else { 0.0 };
        -2.0 / (PI * self.contact_modulus) * parts
    }

    fn gap(&self, mean: f64, x: f64) -> f64 {
        mean - self.amplitude * (2.0 * PI * x / self.wavelength).cos() + self.displacement(x)
    }
}

#[test]
fn a_state_is_what_its_pressure_does() {
    let (amplitude, wavelength, contact_modulus, size) = (0.02, 0.7, 3.0, Size { x: 1.4, y: 2.0 });
    // alpha of 0.01, 0.1, 0.3 and 0.9.
    for alpha in [0.01_f64, 0.1, 0.3, 0.9] {
        let full = PI * contact_modulus * amplitude / wavelength;
        let work = alpha * alpha * wavelength * full * full / (2.0 * contact_modulus);
        let mut scene = Scene::new(Surface::Sine { amplitude, wavelength, size }, contact_modulus);
        scene.effects.boundary = Boundary::Periodic;
        scene.effects.adhesion = Adhesion::ShortRange { work };
        (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
        let mut model = AdhesiveWave.prepare(&scene, 0).unwrap();
        let contact =
            analytic::adhesive_wave::WavyContact::new(amplitude, wavelength, contact_modulus, work).unwrap();
        let [first, last] = [contact.pull_off(), contact.snap_in()].map(|limit| limit.unwrap().unwrap().1);
        for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let force = (first + share * (last - first)) * size.x * size.y;
            let state = model.solve(Load::force(force)).unwrap();
            let psi = FRAC_PI_2 * state.area.unwrap() / (size.x * size.y);
            let pressure = force / (size.x * size.y);
            let wave = JohnsonWave {
                amplitude,
                wavelength,
                contact_modulus,
                psi,
                tension: full * psi.sin().powi(2) - pressure,
            };
            assert_abs_diff_eq!(wave.mean_pressure(), pressure, epsilon = QUADRATURE * full);
            let (edge, mean) = (wavelength * psi / PI, state.mean_gap.unwrap());
            for share in [1e-3, 0.3, 0.8, 0.99] {
                assert_abs_diff_eq!(wave.gap(mean, share * edge), 0.0, epsilon = QUADRATURE * amplitude);
            }
            let open = 0.5 * wavelength - edge;
            for share in [1e-3, 0.1, 0.5, 0.9, 1.0] {
                assert!(wave.gap(mean, edge + share * open) > 0.0);
            }
            // Gap and mean gap, the displacement of mean 0 between them.
            let integrated = 2.0 / wavelength * integral(edge, 0.5 * wavelength, |x| wave.gap(mean, x));
            assert_abs_diff_eq!(integrated, mean, epsilon = QUADRATURE * amplitude.max(mean));
            // Stress intensity from the traction, and from the opening `4 K/E* sqrt(r/(2 pi))`: K^2 = 2 E*
            // work.
            let extrapolated = |at: &dyn Fn(f64) -> f64| {
                let step = EDGE_STEP * edge.min(open);
                (8.0 * at(step) - 6.0 * at(2.0 * step) + at(4.0 * step)) / 3.0
            };
            let by_traction = extrapolated(&|r| -wave.pressure(edge - r) * (2.0 * PI * r).sqrt());
            assert_relative_eq!(by_traction.powi(2), 2.0 * contact_modulus * work, max_relative = EDGE);
            let by_opening =
                extrapolated(&|r| 0.25 * contact_modulus * wave.gap(mean, edge + r) * (2.0 * PI / r).sqrt());
            assert_relative_eq!(by_opening.powi(2), 2.0 * contact_modulus * work, max_relative = EDGE);
        }
    }
}
