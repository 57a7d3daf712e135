//! The boundary-element model behind the common traits.

mod mean_gap;
mod prepared;
mod state;

use contact_model::{
    Boundary, Cells, ContactModel, Effects, Error, PreparedContact, Result, Scene, Size, Source, Surface,
};
use prepared::Prepared;
use std::sync::Arc;

/// Name of the model.
const NAME: &str = "bem3d";

/// Numerics of the boundary-element model.
///
/// ```
/// use bem3d::Bem3d;
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// // Two cells a side, all four in contact: k = 0.993186221 E* L (data/paper/VALUES.md).
/// let model = Bem3d { cells: 2, ..Bem3d::default() };
/// let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
/// let state = model.prepare(&scene, 0)?.solve(Load::Force(1.0))?;
/// assert!((state.stiffness.unwrap() - 0.993186221).abs() < 1e-9);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bem3d {
    /// Number of columns, N >= 1. Ignored where the scene brings its own map.
    pub cells: usize,
    /// Number of rows; `None`: as many as make the cells nearly square ([`Cells::nearly_square`]).
    pub rows: Option<usize>,
    /// Bound t of the certificate and of the estimated relative error of k ([`Certificate::meets`]).
    ///
    /// The certificate counts gaps in rms heights, so that at a prescribed force the approach is good to a few t (at worst about ten) of
    /// the rms height, not of itself: a light load on a rough surface wants a smaller t for a precise d.
    pub tolerance: f64,
    /// Outer iterations at most (each a handful of operator applications).
    pub max_outer_iterations: usize,
    /// How small sets are solved.
    pub method: Method,
}

/// How the linear systems of one contact set are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Factor small sets, iterate on large ones: whichever is cheaper.
    #[default]
    Auto,
    /// Iterate always.
    Iterative,
    /// One grid and one operator, to compare with: no factors, no two-level sums, no nested iteration.
    SingleLevel,
}

impl Bem3d {
    /// The grid on a rectangle of this size.
    pub fn grid(&self, size: Size) -> Cells {
        let nearly_square = Cells::nearly_square(self.cells, size);
        Cells { rows: self.rows.unwrap_or(nearly_square.rows), ..nearly_square }
    }
}

impl Default for Bem3d {
    fn default() -> Self {
        Self { cells: 257, rows: None, tolerance: 1e-6, max_outer_iterations: 200, method: Method::Auto }
    }
}

impl ContactModel for Bem3d {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "A. E. H. Love, Phil. Trans. R. Soc. A 228, 377 (1929)",
                what: "displacement under uniform pressure on a rectangle",
            },
            Source {
                citation: "R. Pohrt, V. L. Popov, A. E. Filippov, Phys. Rev. E 86, 026710 (2012)",
                what: "problem, surfaces, normalisation (Eqs. 2-10)",
            },
        ]
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        scene.validate()?;
        let boundary = scene.effects.boundary;
        if boundary != Boundary::Periodic {
            scene.refuse_effects(NAME)?;
        }
        Effects { boundary: Boundary::Free, ..scene.effects }.refuse(NAME)?;
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return Err(Error::domain("tolerance", self.tolerance, "a number in (0, 1)"));
        }
        let map = match &scene.surface {
            Surface::Heights(map) => Arc::clone(map),
            Surface::Line { .. } => return Err(Error::unsupported(NAME, "a line (it needs a map)")),
            surface => surface_gen::height_map(surface, self.grid(surface.size()), seed)?,
        };
        let has_rms = matches!(scene.surface, Surface::SelfAffine(_) | Surface::Heights(_));
        Ok(Box::new(Prepared::new(*self, scene, &map, has_rms)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::SelfAffine;
    use contact_model::{Load, Outputs};

    /// A rising path of one surface with and without the stiffness.
    #[test]
    fn a_path_without_stiffness_is_the_same_path() {
        let surface = SelfAffine::new(2.4, 1.0, 1.0).map(Surface::SelfAffine).unwrap();
        let scene = Scene::new(surface, 1.0);
        let bare = Scene { outputs: Outputs::default(), ..scene.clone() };
        let model = Bem3d { cells: 40, tolerance: 1e-9, method: Method::Iterative, ..Bem3d::default() };
        let (mut with, mut without) = (model.prepare(&scene, 1).unwrap(), model.prepare(&bare, 1).unwrap());
        for force in [0.01, 0.1, 0.5, 2.0, 10.0, 1.0] {
            let (a, b) =
                (with.solve(Load::Force(force)).unwrap(), without.solve(Load::Force(force)).unwrap());
            approx::assert_relative_eq!(a.approach.unwrap(), b.approach.unwrap(), max_relative = 1e-7);
            assert!(a.stiffness.is_some() && b.stiffness.is_none());
            assert!(b.report.applications < a.report.applications, "what is not asked for costs nothing");
        }
    }

    #[test]
    fn a_field_counts_as_work() {
        let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        let with = Scene { outputs: Outputs { gap: true, ..scene.outputs }, ..scene.clone() };
        let model = Bem3d { cells: 8, ..Bem3d::default() };
        let work =
            |scene| model.prepare(scene, 0).unwrap().solve(Load::Force(1.0)).unwrap().report.applications;
        assert_eq!(work(&with), work(&scene) + 1);
    }
}
