//! Profiles: bodies that are uniform along y, in plane strain.

use super::options::NAME;
use crate::kernel::Kernel;
use contact_model::{Adhesion, Boundary, Conductance, Error, Friction, Outputs, Result, Scene, Surface};

/// Refuses effects and outputs that profiles do not have.
///
/// # Errors
/// [`Error::Unsupported`] for adhesion, friction and a layer, and for a displacement or a conductance of a half-plane.
pub(super) fn check(scene: &Scene) -> Result<()> {
    if !matches!(scene.surface, Surface::Profile(_)) {
        return Ok(());
    }
    if scene.effects.adhesion != Adhesion::Off {
        let what = "adhesion of a profile: its attraction is corrected for fronts in three dimensions and was not checked in two";
        return Err(Error::unsupported(NAME, what));
    }
    if scene.effects.friction != Friction::Off {
        let what = "friction of a profile: the tangential kernel is that of three dimensions";
        return Err(Error::unsupported(NAME, what));
    }
    if scene.effects.layer.is_some() {
        return Err(Error::unsupported(
            NAME,
            "a layer under a profile: its kernel is that of three dimensions",
        ));
    }
    if scene.effects.boundary != Boundary::Free {
        return Ok(());
    }
    let refused = |what: &str| {
        let why = "displacements of a half-plane have no zero at infinity";
        Err(Error::unsupported(NAME, format!("{what} of a profile with free boundaries: {why}")))
    };
    let Outputs { displacement, conductance, .. } = scene.outputs;
    if displacement {
        refused("a displacement")
    } else if conductance != Conductance::Off {
        refused("a conductance, which follows from the stiffness,")
    } else {
        Ok(())
    }
}

/// The outputs on a kernel: where the approach has no meaning, a stiffness would depend on the place from which
/// displacements are measured, unless the mean gap takes its place.
pub(super) fn outputs(outputs: Outputs, kernel: &dyn Kernel<1>) -> Outputs {
    if kernel.vanishes_far_away() || kernel.boundary() == Boundary::Periodic {
        return outputs;
    }
    Outputs { stiffness: false, stiffness_fixed_area: false, ..outputs }
}
