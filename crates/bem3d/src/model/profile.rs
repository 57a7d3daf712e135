//! Profiles: bodies that are uniform along y, in plane strain.

use super::options::NAME;
use crate::kernel::{Kernel, LayerOnGrid, LayerSymbol, Medium};
use contact_model::{Adhesion, Boundary, Conductance, Error, Friction, Outputs, Result, Scene, Surface};

/// The body under a scene's surface: under a profile with free boundaries a half-plane. With periodic ones
/// the kernel of one row is that of plane strain by itself, because a pressure that is periodic with one row
/// does not vary along y. Lengths of a layer are counted in `length`, the mean side of a cell.
pub(super) fn medium(scene: &Scene, length: f64) -> Medium {
    match (&scene.surface, scene.effects.boundary, scene.effects.layer) {
        (Surface::Profile(_), Boundary::Free, _) => Medium::HalfPlane,
        (_, boundary, Some(layer)) => {
            let symbol = LayerSymbol::new(&layer);
            let share = scene.contact_modulus / layer.modulus();
            Medium::Layer(LayerOnGrid { thickness: layer.thickness / length, share, symbol }, boundary)
        }
        (_, boundary, None) => boundary.into(),
    }
}

/// Refuses outputs that a layer does not have.
///
/// # Errors
/// [`Error::Unsupported`] for a conductance.
pub(super) fn check_layer(scene: &Scene) -> Result<()> {
    if scene.effects.layer.is_some() && scene.outputs.conductance != Conductance::Off {
        let what =
            "a conductance of a layered body: it follows from the stiffness of homogeneous half-spaces";
        return Err(Error::unsupported(NAME, what));
    }
    Ok(())
}

/// Smallest compliance of a layer for waves of two cells, over that of a half-space. The layer is what is left of a
/// half-space, and rounding of 1e-13 of it is then a millionth of the layer.
const LEAST_COMPLIANCE: f64 = 1e-7;

/// Refuses a layer so thin beside the cells that rounding hides it.
///
/// # Errors
/// [`Error::Domain`] with the thickness.
pub(super) fn check_thickness(scene: &Scene, medium: Medium, length: f64) -> Result<()> {
    let (Medium::Layer(on_grid, _), Some(layer)) = (medium, scene.effects.layer) else { return Ok(()) };
    if 1.0 + on_grid.excess(std::f64::consts::PI) >= LEAST_COMPLIANCE {
        return Ok(());
    }
    let expected = format!(
        "more beside cells of {length}: on a rigid base so thin a layer yields so little that rounding hides it"
    );
    Err(Error::domain("thickness of the layer", layer.thickness, expected))
}

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
