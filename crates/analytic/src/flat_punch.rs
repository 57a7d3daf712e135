//! Rigid flat punches: the circle (Boussinesq) and the square.

use crate::closed::{self, ClosedLaw, ClosedState};
use contact_model::{
    Abilities, ContactModel, Error, PreparedContact, Result, Scene, Source, Surface, SurfaceKind,
};
use std::f64::consts::PI;

const NAME: &str = "flat_punch";

/// Stiffness of the rigid square punch, `k / (E* L)` = 1.152298.
///
/// Converged boundary-element value; the electrical capacitance of the unit square, which is the same number
/// up to a constant, agrees. The paper's 1.1419 ([`contact_model::PAPER_STIFFNESS_FACTOR`]) is 0.9 % lower
/// and not converged.
pub const SQUARE_STIFFNESS: f64 = 1.152_298;

/// Uncertainty of [`SQUARE_STIFFNESS`], one unit of its last digit.
pub const SQUARE_STIFFNESS_UNCERTAINTY: f64 = 1e-6;

/// A rigid flat punch: `F = k d`, with `k = 2 E* a` for a circle of radius a and `k = 1.152298(1) E* L` for a
/// square of side L.
///
/// Takes [`Surface::FlatCircle`] (exact) and a square [`Surface::Flat`] (with the stated uncertainty in the
/// report). The area is that of the face.
///
/// ```
/// use analytic::FlatPunch;
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// let scene = Scene::new(Surface::FlatCircle { radius: 0.25, size: 1.0.into() }, 2.0);
/// let state = FlatPunch.prepare(&scene, 0)?.solve(Load::force(0.5))?;
/// assert_eq!((state.stiffness, state.approach), (Some(1.0), Some(0.5)));
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FlatPunch;

impl ContactModel for FlatPunch {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "J. Boussinesq, Application des potentiels a l'etude de l'equilibre et du mouvement des solides elastiques, \
                           Gauthier-Villars, Paris (1885)",
                what: "circle: k = 2 E* a and the pressure",
            },
            Source {
                citation: "this project: full contact of N x N cells, extrapolated to the continuum",
                what: "square: k = 1.152298(1) E* L",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: &[SurfaceKind::FlatCircle, SurfaceKind::Flat],
            outputs: closed::WITH_AREA,
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(NAME, scene)?;
        let (law, strategy, stiffness_error) = match scene.surface {
            Surface::FlatCircle { radius, size } => {
                let radius = radius / size.length();
                closed::within(radius, size)?;
                let law = Face { stiffness: 2.0 * radius, area: PI * radius * radius };
                (law, "closed form (Boussinesq)", 0.0)
            }
            Surface::Flat { size } if !size.is_square() => {
                return Err(Error::unsupported(NAME, "a flat rectangle: the constant is that of a square"));
            }
            Surface::Flat { .. } => {
                let law = Face { stiffness: SQUARE_STIFFNESS, area: 1.0 };
                (law, "converged constant of the square", SQUARE_STIFFNESS_UNCERTAINTY / SQUARE_STIFFNESS)
            }
            ref other => return Err(Error::unsupported(NAME, other.kind())),
        };
        closed::of_body(scene, NAME, (strategy, stiffness_error), law)
    }
}

/// Stiffness and area of the face, in units of L.
struct Face {
    stiffness: f64,
    area: f64,
}

impl ClosedLaw for Face {
    fn at_force(&self, force: f64) -> Result<ClosedState> {
        let Self { stiffness, area } = *self;
        let (approach, area) = (force / stiffness, Some(area));
        Ok(ClosedState { force, approach, stiffness, area, ..ClosedState::default() })
    }

    fn at_approach(&self, approach: f64) -> Result<ClosedState> {
        let Self { stiffness, area } = *self;
        let (force, area) = (stiffness * approach, Some(area));
        Ok(ClosedState { force, approach, stiffness, area, ..ClosedState::default() })
    }
}

/// `p(r) = F / (2 pi a^2) (1 - r^2/a^2)^(-1/2)` under a flat circular punch of radius a, in the unit of
/// F/a^2; 0 outside (Boussinesq).
///
/// # Errors
/// [`Error::Domain`] at the edge itself, where the pressure is infinite, and for a force or radius that makes
/// no sense.
///
/// ```
/// // F = 2 pi, a = 1: 1 in the middle, 1.25 at r = 0.6.
/// assert!((analytic::flat_punch::pressure(std::f64::consts::TAU, 1.0, 0.6)? - 1.25).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn pressure(force: f64, radius: f64, r: f64) -> Result<f64> {
    let x = crate::round::position(force, radius, r)?;
    if x > 1.0 {
        return Ok(0.0);
    }
    let root = (1.0 - x * x).sqrt();
    if root <= 0.0 {
        return Err(Error::domain("r", r, "a place off the edge of the punch"));
    }
    Ok(0.5 * crate::round::mean_pressure(force, radius) / root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{ROUNDING, check_curve, pressed, scale_invariant};
    use approx::assert_relative_eq;
    use contact_model::{Load, PAPER_STIFFNESS_FACTOR};

    #[test]
    fn square() {
        let surface = |side: f64| Surface::Flat { size: side.into() };
        let scene = Scene::new(surface(3.0), 2.0);
        let s = pressed(&FlatPunch, &scene, Load::approach(0.1)).unwrap();
        assert_relative_eq!(s.stiffness.unwrap(), 1.152_298 * 6.0, max_relative = ROUNDING);
        assert_relative_eq!(s.area.unwrap(), 9.0, max_relative = ROUNDING);
        assert!(s.report.certificate.stiffness_error.unwrap() > 8e-7);
        // The continuum plateau of k_bar.
        let k_bar = FlatPunch.prepare(&scene, 0).unwrap().normalisation().stiffness_bar(s.stiffness.unwrap());
        assert_relative_eq!(k_bar, 1.152_298 / PAPER_STIFFNESS_FACTOR, max_relative = ROUNDING);
        assert_relative_eq!(k_bar, 1.0091, max_relative = 1e-4);
        check_curve(&FlatPunch, &scene, 0.1);
        scale_invariant(&FlatPunch, surface, 0.1, ROUNDING);
    }

    #[test]
    fn circle() {
        let surface = |side: f64| Surface::FlatCircle { radius: 0.3 * side, size: side.into() };
        let scene = Scene::new(surface(1.0), 2.0);
        let s = pressed(&FlatPunch, &scene, Load::force(0.6)).unwrap();
        assert_relative_eq!(s.approach.unwrap(), 0.5, max_relative = ROUNDING);
        assert_relative_eq!(s.area.unwrap(), PI * 0.09, max_relative = ROUNDING);
        check_curve(&FlatPunch, &scene, 0.1);
        scale_invariant(&FlatPunch, surface, 0.1, ROUNDING);
        let wide = Scene::new(Surface::FlatCircle { radius: 0.6, size: 1.0.into() }, 1.0);
        assert!(matches!(FlatPunch.prepare(&wide, 0), Err(Error::OutOfRange { .. })));
        assert!(pressure(1.0, 0.5, 0.5).is_err() && pressure(1.0, 0.5, 0.6).unwrap() <= 0.0);
    }
}
