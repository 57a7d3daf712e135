//! A model of one's own under [`mdr1d::Equivalent`]: friction on a Winkler foundation, checked against its
//! closed form.
//!
//! `cargo run -p mdr1d --example winkler_friction`
//!
//! `Equivalent` needs from a model an approach, a force and a stiffness that never falls. It does not need a
//! half-space, so the model may be a Winkler foundation. On independent springs the superposition is exact:
//! `Q = mu (F(d) - F(d - delta_x G*/(mu E*)))`. Two assumptions are those of the half-space: the tangential
//! stiffness is G*/E* times the normal one, and `stick_radius` is that of the round contact of the same
//! stiffness.
//!
//! ```text
//! d/d_max     Q/mu F  closed form   dissipated
//!     0.1   0.190000     0.190000    2.3936e-8
//!     0.3   0.510000     0.510000    6.4627e-7
//!     0.6   0.840000     0.840000    5.1702e-6
//!     0.9   0.990000     0.990000    1.7449e-5
//! ```

use mdr1d::{
    Abilities, Body, ContactModel, ContactState, Equivalent, Error, Friction, Load, NormalLoad,
    Normalisation, Pair, PreparedContact, Result, Scene, SolveReport, Source, Step, Stop, Surface,
    SurfaceKind, Tangential,
};
use std::f64::consts::PI;

/// A layer of this thickness under a sphere: `F = pi E* R d^2/thickness`, `k = dF/dd`.
struct WinklerFriction {
    thickness: f64,
}

struct SlidingLayer(f64, Normalisation);

impl ContactModel for WinklerFriction {
    fn name(&self) -> &'static str {
        "winkler"
    }

    fn sources(&self) -> &'static [Source] {
        &[Source { citation: "K. L. Johnson, Contact Mechanics, Cambridge (1985)", what: "Sec. 4.3" }]
    }

    fn abilities(&self) -> Abilities {
        Abilities { surfaces: &[SurfaceKind::Sphere], ..Abilities::ELASTIC }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(self.name(), scene)?; // `Equivalent` keeps friction to itself
        let Surface::Sphere { radius, size } = scene.surface else {
            return Err(Error::unsupported(self.name(), scene.surface.kind()));
        };
        let normalisation =
            Normalisation { contact_modulus: scene.contact_modulus, length: size.length(), height: None };
        Ok(Box::new(SlidingLayer(PI * scene.contact_modulus * radius / self.thickness, normalisation)))
    }
}

impl PreparedContact for SlidingLayer {
    fn normalisation(&self) -> Normalisation {
        self.1
    }

    fn solve_until(&mut self, load: Load, _stop: Stop<'_>) -> Result<ContactState> {
        let d = match load.validated()?.without_tangential("winkler")? {
            NormalLoad::Approach(approach) => approach,
            NormalLoad::Force(force) => (force / self.0).sqrt(),
            other => return Err(Error::unsupported("winkler", format!("the load {other:?}"))),
        };
        let state = ContactState::new(self.0 * d * d, SolveReport::exact("closed form"));
        Ok(state.with_approach(d).with_elastic_stiffness(2.0 * self.0 * d))
    }
}

fn main() -> Result<()> {
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 1.0, poisson: 0.4 } };
    let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 1.0.into() }, pair)?;
    scene.effects.friction = Friction::coulomb(0.3);
    let mut contact = Equivalent::new(WinklerFriction { thickness: 0.05 }).prepare(&scene, 0)?;
    let normal = Load::approach(0.02);
    let force = contact.advance(Step::new(0.0, normal))?.force;
    // Full slip from this displacement on.
    let largest = 0.3 * 0.02 * scene.contact_modulus / pair.shear_modulus()?;
    println!("{:>7} {:>10} {:>12} {:>12}", "u/u_max", "Q/mu F", "closed form", "dissipated");
    for share in [0.1, 0.3, 0.6, 0.9] {
        let tangential = Tangential::displacement_along_x(share * largest);
        let state = contact.advance(Step::new(0.0, normal.with_tangential(tangential)))?;
        let Some(found) = state.tangential else { continue };
        let (ratio, exact) = (found.force[0] / (0.3 * force), 1.0 - (1.0_f64 - share).powi(2));
        println!("{share:>7} {ratio:>10.6} {exact:>12.6} {:>12.4e}", found.dissipated);
        assert!((ratio - exact).abs() < 1e-6); // a profile through 49 states
    }
    Ok(())
}
