//! The checker: any model against the exact solution.

use crate::problem::ExactProblem;
use contact_model::{ContactModel, ContactState, Error, Load, Result};

/// Which of force and approach is prescribed; the other is the response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrescribedQuantity {
    /// The exact force is prescribed; the approach is the response.
    Force,
    /// The exact approach is prescribed; the force is the response.
    Approach,
}

/// Relative errors, root mean square over the cases of a [`ExactProblem`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Error of the approach at given force, or of the force at given approach.
    pub response: f64,
    /// Error of the stiffness.
    pub stiffness: f64,
    /// Error of the area.
    pub area: f64,
}

/// Solves every case of a problem with a model and compares; `None` where the model refuses the scene as
/// unsupported.
///
/// # Errors
/// Every error of the model but [`Error::Unsupported`]; [`Error::Shape`] when a state lacks a number that was
/// requested.
pub fn deviation(
    model: &dyn ContactModel,
    problem: &ExactProblem,
    prescribed: PrescribedQuantity,
) -> Result<Option<Deviation>> {
    let mut squares = [0.0; 3];
    for case in &problem.cases {
        let exact = problem.exact(case)?;
        let load = match prescribed {
            PrescribedQuantity::Force => Load::force(exact.force),
            PrescribedQuantity::Approach => Load::approach(case.approach),
        };
        let found = match model.prepare(&case.scene, 0) {
            Ok(mut contact) => contact.solve(load)?,
            Err(Error::Unsupported { .. }) => return Ok(None),
            Err(other) => return Err(other),
        };
        let (found, exact) = (numbers(&found, prescribed)?, numbers(&exact, prescribed)?);
        for (square, (found, exact)) in squares.iter_mut().zip(found.iter().zip(exact)) {
            *square += ((found - exact) / exact).powi(2);
        }
    }
    let [response, stiffness, area] = squares.map(|s| (s / problem.cases.len() as f64).sqrt());
    Ok(Some(Deviation { response, stiffness, area }))
}

/// Response, stiffness and area of a state.
fn numbers(state: &ContactState, prescribed: PrescribedQuantity) -> Result<[f64; 3]> {
    let asked = |name: &'static str, value: Option<f64>| {
        value.ok_or(Error::Shape {
            name: name.into(),
            found: 0,
            expected: "a number that was asked for".into(),
        })
    };
    let response = match prescribed {
        PrescribedQuantity::Force => asked("approach", state.approach)?,
        PrescribedQuantity::Approach => state.force,
    };
    Ok([response, asked("stiffness", state.stiffness)?, asked("area", state.area)?])
}
