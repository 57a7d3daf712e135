//! Problems with exact solutions.

use analytic::{FlatPunch, Hertz, PowerLawBody};
use contact_model::{ContactModel, ContactState, Load, Outputs, Result, Scene, Surface};

/// One scene and an approach at which its exact solution is known.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactCase {
    /// The scene; it requests stiffness and area.
    pub scene: Scene,
    /// The approach.
    pub approach: f64,
}

/// A body, the theory that solves it exactly, and a few states.
///
/// There are several states, because the error of a single one depends on the position of the edge of the
/// contact relative to the cells; their mean does not.
pub struct ExactProblem {
    /// Short name.
    pub name: &'static str,
    /// The exact solution.
    pub theory: Box<dyn ContactModel>,
    /// The states.
    pub cases: Vec<ExactCase>,
}

impl ExactProblem {
    /// The exact state of a case.
    ///
    /// # Errors
    /// Those of the theory.
    pub fn exact(&self, case: &ExactCase) -> Result<ContactState> {
        self.theory.prepare(&case.scene, 0)?.solve(Load::approach(case.approach))
    }
}

impl std::fmt::Debug for ExactProblem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Problem")
            .field("name", &self.name)
            .field("cases", &self.cases)
            .finish_non_exhaustive()
    }
}

/// Side of the square and modulus: neither is 1, so that a missing factor is detected.
const SIDE: f64 = 2.0;
const MODULUS: f64 = 3.0;

/// Contact radii over the side: all inside the square, none a simple fraction of it.
const RADII: [f64; 6] = [0.263, 0.291, 0.317, 0.349, 0.377, 0.411];

/// Hertz's sphere, the cone, power-law bodies with n = 1/2 and 3, the flat circle and the flat square.
///
/// # Errors
/// None with the numbers written here; those of [`analytic::power_law_body::kappa`] in general.
pub fn problems() -> Result<Vec<ExactProblem>> {
    let power = |coefficient, exponent| Surface::PowerLaw { coefficient, exponent, size: SIDE.into() };
    Ok(vec![
        round("sphere", Box::new(Hertz), &Surface::Sphere { radius: 5.0, size: SIDE.into() }, 2.0, 0.1)?,
        round("cone", Box::new(PowerLawBody), &Surface::Cone { slope: 0.1, size: SIDE.into() }, 1.0, 0.1)?,
        round("power law n = 1/2", Box::new(PowerLawBody), &power(0.2, 0.5), 0.5, 0.2)?,
        round("power law n = 3", Box::new(PowerLawBody), &power(0.05, 3.0), 3.0, 0.05)?,
        ExactProblem {
            name: "flat circle",
            theory: Box::new(FlatPunch),
            cases: (RADII.iter())
                .map(|r| case(Surface::FlatCircle { radius: r * SIDE, size: SIDE.into() }, 0.01))
                .collect(),
        },
        ExactProblem {
            name: "flat square",
            theory: Box::new(FlatPunch),
            cases: vec![case(Surface::Flat { size: SIDE.into() }, 0.01)],
        },
    ])
}

/// `z = c r^n` pressed to the contact radii [`RADII`]: `d = kappa_n c a^n`.
fn round(
    name: &'static str,
    theory: Box<dyn ContactModel>,
    body: &Surface,
    n: f64,
    c: f64,
) -> Result<ExactProblem> {
    let kappa = analytic::power_law_body::kappa(n)?;
    let cases = RADII.iter().map(|r| case(body.clone(), kappa * c * (r * SIDE).powf(n))).collect();
    Ok(ExactProblem { name, theory, cases })
}

fn case(surface: Surface, approach: f64) -> ExactCase {
    let mut scene = Scene::new(surface, MODULUS);
    scene.outputs = Outputs { area: true, ..scene.outputs };
    ExactCase { scene, approach }
}
