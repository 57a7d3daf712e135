//! The body under the surface of a scene: a half-space, a half-plane or a layer on a base.

use super::options::NAME;
use crate::kernel::{LayerOnGrid, LayerSymbol, Medium, PeriodicKernel};
use contact_model::{Adhesion, Boundary, Conductance, Error, Friction, Result, Rheology, Scene, Surface};

/// The body under a scene's surface: under a profile with free boundaries a half-plane. With periodic ones
/// the kernel of one row is that of plane strain by itself, because a pressure that is periodic with one row
/// does not vary along y. Lengths of a layer are counted in `length`, the mean side of a cell.
pub(super) fn of(scene: &Scene, exact_for: PeriodicKernel, length: f64) -> Medium {
    match (&scene.surface, scene.effects.boundary, scene.effects.layer) {
        (Surface::Profile(_), Boundary::Free, _) => Medium::HalfPlane,
        (_, boundary, Some(layer)) => {
            let symbol = LayerSymbol::new(&layer);
            let share = scene.contact_modulus / layer.modulus();
            let on_grid = LayerOnGrid { thickness: layer.thickness / length, share, symbol };
            Medium::Layer(on_grid, boundary, exact_for)
        }
        (_, Boundary::Periodic, None) => Medium::Periodic(exact_for),
        (_, boundary, None) => boundary.into(),
    }
}

/// Refuses the kernel of waves where it has no meaning, or where other kernels would have to be of waves too.
///
/// # Errors
/// [`Error::Unsupported`] with free boundaries and with friction.
pub(super) fn check_kernel(scene: &Scene, exact_for: PeriodicKernel) -> Result<()> {
    if exact_for == PeriodicKernel::Cells {
        return Ok(());
    }
    if scene.effects.boundary != Boundary::Periodic {
        let what = format!("a periodic kernel of waves with {}", scene.effects.boundary.words());
        return Err(Error::unsupported(NAME, what));
    }
    if scene.effects.friction != Friction::Off {
        let what = "a periodic kernel of waves with friction, whose tangential kernel is one of cells";
        return Err(Error::unsupported(NAME, what));
    }
    Ok(())
}

/// Refuses what a contact that goes on along a line does not have.
///
/// # Errors
/// [`Error::Unsupported`] for profiles, adhesion, friction, a layer, a displacement and a conductance of a map that is
/// periodic along one axis.
pub(super) fn check_line(scene: &Scene) -> Result<()> {
    let [along_x, along_y] = scene.effects.boundary.repeats();
    if along_x == along_y {
        return Ok(());
    }
    let refused =
        |what: &str| Err(Error::unsupported(NAME, format!("{what} with {}", scene.effects.boundary.words())));
    if matches!(scene.surface, Surface::Profile(_)) {
        return refused("a profile, which is uniform along y already,");
    }
    if scene.effects.adhesion != Adhesion::Off {
        return refused("adhesion, whose neighbours of a cell are those of other boundaries,");
    }
    if scene.effects.friction != Friction::Off {
        return refused("friction, whose tangential kernels are those of other boundaries,");
    }
    if scene.effects.layer.is_some() {
        return refused("a layer, whose kernel is one of other boundaries,");
    }
    if scene.outputs.displacement {
        return refused("a displacement, which has no zero at infinity,");
    }
    if scene.outputs.conductance != Conductance::Off {
        return refused(
            "a conductance, which follows from a stiffness that depends on the place of the zero,",
        );
    }
    Ok(())
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

/// Compression per mean pressure of a whole layer that is on a rigid base under a rigid body, with periodic boundaries;
/// `None` for another scene, and for a viscoelastic layer, whose compression has a history of its own.
pub(super) fn whole_compression(scene: &Scene) -> Option<f64> {
    let layer = scene.effects.layer.filter(|layer| scene.is_pressed_by_a_rigid_body(layer))?;
    let is_elastic = scene.effects.rheology == Rheology::Elastic;
    let is_periodic = scene.effects.boundary == Boundary::Periodic;
    layer.whole_compression().filter(|_| is_elastic && is_periodic)
}

/// Smallest compliance of a layer for waves of two cells, over that of a half-space. The layer is what is left of a
/// half-space, and rounding of 1e-13 of it is then a millionth of the layer.
const LEAST_COMPLIANCE: f64 = 1e-7;

/// Refuses a layer so thin beside the cells that rounding hides it.
///
/// # Errors
/// [`Error::Domain`] with the thickness.
pub(super) fn check_thickness(scene: &Scene, medium: Medium, length: f64) -> Result<()> {
    let (Medium::Layer(on_grid, ..), Some(layer)) = (medium, scene.effects.layer) else { return Ok(()) };
    if 1.0 + on_grid.excess(std::f64::consts::PI) >= LEAST_COMPLIANCE {
        return Ok(());
    }
    let expected = format!(
        "more beside cells of {length}: on a rigid base so thin a layer yields so little that rounding hides it"
    );
    Err(Error::domain("thickness of the layer", layer.thickness, expected))
}
