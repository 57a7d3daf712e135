//! Common code of all contacts of axisymmetric bodies: the profile in its scene, and its state under a normal
//! load without adhesion.

use crate::axisymmetric::{Profile, RoundContact, check_radius};
use contact_model::{Error, NormalLoad, Result, ScaledState, Scaling, Scene, Size};

/// An axisymmetric body on its rectangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RoundBody {
    pub profile: Profile,
    size: Size,
    pub scaling: Scaling,
}

impl RoundBody {
    /// The body of a scene; `None` where its surface is no such body.
    pub fn new(scene: &Scene) -> Result<Option<Self>> {
        let Some(profile) = Profile::new(&scene.surface)? else { return Ok(None) };
        Ok(Some(Self { profile, size: scene.surface.size(), scaling: Scaling::of_body(scene)? }))
    }

    /// The body of a scene, for a model of round contacts alone; `why` is the reason in the error.
    pub fn required(scene: &Scene, model: &'static str, why: &str) -> Result<Self> {
        let none = || Error::unsupported(model, format!("{}: {why}", scene.surface.kind()));
        Self::new(scene)?.ok_or_else(none)
    }

    /// The contact under a load >= 0.
    pub fn press(&self, load: NormalLoad, model: &'static str) -> Result<RoundContact> {
        let nondimensional = self.scaling.nondimensional;
        let (contact, asked) = match load.validated()? {
            NormalLoad::Force(force) => (self.profile.at_force(nondimensional.force_in(force)), force),
            NormalLoad::Approach(approach) => {
                (self.profile.at_approach(nondimensional.approach_in(approach)), approach)
            }
            _ => return Err(Error::unsupported_load(model, load)),
        };
        self.admit(contact)?;
        if asked > 0.0 && (contact.radius <= 0.0 || contact.approach <= 0.0 || contact.force <= 0.0) {
            return Err(out_of_f64(contact.radius));
        }
        Ok(contact)
    }

    /// Errors where the contact has left the rectangle.
    pub fn admit(&self, contact: RoundContact) -> Result<()> {
        check_radius(contact.radius, self.size)
    }
}

impl RoundContact {
    /// As a state, without its stiffness along the branch.
    pub fn scaled(self) -> ScaledState {
        ScaledState {
            force: self.force,
            approach: Some(self.approach),
            stiffness_fixed_area: Some(self.stiffness()),
            area: Some(self.area()),
            ..ScaledState::default()
        }
    }
}

/// A loaded contact of which nothing is left.
pub(crate) fn out_of_f64(radius: f64) -> Error {
    Error::not_representable("contact radius over side", radius)
}
