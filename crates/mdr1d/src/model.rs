//! [`Mdr1d`]: the method behind the common trait.

use crate::axisymmetric::{Profile, check_radius};
use crate::bearing::Bearing;
use contact_model::{
    ContactModel, ContactState, Error, Line, Load, Outputs, PreparedContact, Result, Scales, Scene,
    SolveReport, Source, Stop, Surface, Units,
};

const NAME: &str = "mdr1d";

/// The method of reduction of dimensionality.
///
/// Takes a [`Surface::SelfAffine`] (the line is drawn from the seed), a [`Surface::Line`], and the bodies of [`Profile`]. For
/// rough lines it claims force, approach and stiffness; for axisymmetric bodies also the area, `pi a^2`, which is exact there.
///
/// An ensemble over one spectrum is faster with one [`surface_gen::LineGenerator`] and its lines as [`Surface::Line`]: the plan
/// and the amplitudes are then made once. The states are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mdr1d {
    /// Number of elements of a line that is drawn from a seed; a given line brings its own.
    pub elements: usize,
}

impl Default for Mdr1d {
    /// 2^16 elements: a line in milliseconds, and a power law over five decades of force.
    fn default() -> Self {
        Self { elements: 1 << 16 }
    }
}

impl ContactModel for Mdr1d {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "R. Pohrt, V. L. Popov, A. E. Filippov, Phys. Rev. E 86, 026710 (2012)",
                what: "the equivalent line, Eqs. 14 to 18 (Eq. 15 with the square root over the spectrum)",
            },
            Source {
                citation: "T. Geike, V. L. Popov, Phys. Rev. E 76, 036710 (2007)",
                what: "reduction of rough three-dimensional contacts to one dimension",
            },
            Source {
                citation: "M. Hess, Ueber die exakte Abbildung ausgewaehlter dreidimensionaler Kontakte auf Systeme mit \
                           niedrigerer raeumlicher Dimension, Cuvillier, Goettingen (2011)",
                what: "exact MDR profiles g(x) of axisymmetric bodies, kappa_n",
            },
            Source {
                citation: "I. A. Lyashenko, L. Pastewka, B. N. J. Persson, Tribol. Lett. 52, 223 (2013)",
                what: "why no contact area is claimed for rough lines",
            },
        ]
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        scene.validate()?;
        scene.refuse_effects(NAME)?;
        let outputs = scene.outputs;
        if outputs.any_field() {
            return Err(Error::unsupported(NAME, "pressure, displacement and gap fields"));
        }
        let (side, modulus) = (scene.surface.side(), scene.modulus);
        if let Some(profile) = Profile::new(&scene.surface)? {
            let units = Units::new(modulus, side, side)?;
            let scales = Scales { modulus, side, height: None };
            return Ok(Box::new(Body { profile, units, scales, outputs }));
        }
        if outputs.area && matches!(scene.surface, Surface::SelfAffine(_) | Surface::Line { .. }) {
            return Err(Error::unsupported(
                NAME,
                "the area of a rough surface (a line has a length in contact only)",
            ));
        }
        match &scene.surface {
            Surface::SelfAffine(surface) => {
                let line = surface_gen::self_affine_line(surface, self.elements, seed)?;
                Ok(Box::new(Rough::new(&line, side, modulus, outputs)))
            }
            Surface::Line { line, .. } => Ok(Box::new(Rough::new(line, side, modulus, outputs))),
            other => Err(Error::unsupported(NAME, other.kind())),
        }
    }
}

/// A rough line.
struct Rough {
    bearing: Bearing,
    scales: Scales,
    outputs: Outputs,
}

impl Rough {
    fn new(line: &Line, side: f64, modulus: f64, outputs: Outputs) -> Self {
        let height = surface_gen::rms_height(line.heights());
        let scales = Scales { modulus, side, height: Some(height) };
        Self { bearing: Bearing::new(line), scales, outputs }
    }
}

impl PreparedContact for Rough {
    fn scales(&self) -> Scales {
        self.scales
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let support = self.bearing.press(load, self.scales.modulus)?;
        let mut report =
            SolveReport::exact(format!("order statistics of {} elements", self.bearing.elements()));
        report.contact_cells = Some(support.elements);
        report.certificate.stiffness_error = self.outputs.stiffness.then_some(0.0);
        Ok(ContactState {
            force: support.force,
            approach: Some(support.approach),
            stiffness: self.outputs.stiffness.then_some(support.stiffness),
            area: None,
            fields: None,
            report,
        })
    }
}

/// An axisymmetric body.
struct Body {
    profile: Profile,
    units: Units,
    scales: Scales,
    outputs: Outputs,
}

impl PreparedContact for Body {
    fn scales(&self) -> Scales {
        self.scales
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let units = self.units;
        let (contact, loaded) = match load.validated()? {
            Load::Force(force) => (self.profile.at_force(units.force_in(force)), force > 0.0),
            Load::Approach(approach) => {
                (self.profile.at_approach(units.approach_in(approach)), approach > 0.0)
            }
            _ => return Err(Error::unsupported(NAME, format!("the load {load:?}"))),
        };
        check_radius(contact.radius, self.scales.side)?;
        if loaded && (contact.radius <= 0.0 || contact.approach <= 0.0 || contact.force <= 0.0) {
            return Err(Error::domain(
                "contact radius over side",
                contact.radius,
                "a number within the range of f64",
            ));
        }
        let (force, approach) = match load {
            Load::Force(force) => (force, units.approach(contact.approach)?),
            _ => (units.force(contact.force)?, units.approach(contact.approach)?),
        };
        let stiffness = self.outputs.stiffness.then(|| units.stiffness(contact.stiffness())).transpose()?;
        let area = self.outputs.area.then(|| units.area(contact.area())).transpose()?;
        let mut report = SolveReport::exact("closed form of the profile g(x)");
        report.certificate.stiffness_error = stiffness.map(|_| 0.0);
        Ok(ContactState { force, approach: Some(approach), stiffness, area, fields: None, report })
    }
}

#[cfg(test)]
mod tests;
