//! Both plateaus, by solving full contact.

use crate::claim::{Claim, Estimate, Statement};
use bem3d::Bem3d;
use contact_model::{ContactModel as _, Load, PAPER_STIFFNESS_FACTOR, Scene, SelfAffine, Surface};
use mdr1d::Mdr1d;
use runs::{Error, Result};

/// Half a unit of the last digit of 1.1419.
const PRINTED: f64 = 5e-5;

/// Full contact of two grids of this many cells a side, extrapolated in 1/N (the error is of first order: data/paper/VALUES.md).
const GRIDS: [usize; 2] = [64, 128];

/// k/(E* L) of a rigid square of N x N cells, all in contact.
fn square(cells: usize) -> Result<f64> {
    let model = Bem3d { cells, tolerance: 1e-9, ..Bem3d::default() };
    let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
    model
        .prepare(&scene, 0)
        .and_then(|mut contact| contact.solve(Load::Force(1.0)))
        .map_err(Error::model(format!("full contact of {cells} x {cells} cells")))?
        .stiffness
        .ok_or_else(|| Error::parameter("cells", cells, "a model that gives a stiffness"))
}

/// k/(E* L) of a whole line in contact.
fn line() -> Result<f64> {
    let scene = SelfAffine::new(2.0, 1.0, 1.0).map(|s| Scene::new(Surface::SelfAffine(s), 1.0));
    scene
        .and_then(|scene| Mdr1d { elements: 4096 }.prepare(&scene, 0))
        // 1e6 E* h L presses every element flat.
        .and_then(|mut contact| contact.solve(Load::Force(1e6)))
        .map_err(Error::model("full contact of a line"))?
        .stiffness
        .ok_or_else(|| Error::parameter("elements", 4096, "a model that gives a stiffness"))
}

pub(crate) fn plateaus() -> Result<Vec<Claim>> {
    const SQUARE: Statement = Statement {
        quotation: "the stiffness at complete contact is saturated at k_s = 1.012 × 2E* sqrt(A_0)/pi = 1.1419 E* sqrt(A_0)",
        place: "Sec. II, from Popov's textbook",
        reading: "the value of the continuum, to the digits printed",
    };
    const EQUAL: Statement = Statement {
        quotation: "The values of the stiffness at the plateau are exactly the same in the 1D and 3D cases",
        place: "Sec. III, Eq. 18",
        reading: "equal to the digits of 1.1419",
    };
    let [n, m] = GRIDS;
    let (coarse, fine) = (square(n)?, square(m)?);
    let limit = Estimate {
        value: (m as f64 * fine - n as f64 * coarse) / (m - n) as f64,
        // Terms of higher order that the extrapolation leaves: data/paper/VALUES.md.
        half_width: 0.25 / (m as f64).powf(1.59),
    };
    let line = line()?;
    let paper = [PAPER_STIFFNESS_FACTOR - PRINTED, PAPER_STIFFNESS_FACTOR + PRINTED];
    Ok(vec![
        Claim::judge(
            "complete contact of the square: k/(E* L)",
            SQUARE,
            paper,
            limit,
            format!(
                "1.012 x 2/sqrt(pi) is an old value of the rigid square punch, the converged one is 1.152298; full contact of {n} and {m} cells \
                 a side, extrapolated in 1/N; the continuum plateau of k_bar is 1.0091"
            ),
        ),
        Claim::judge(
            "complete contact, line over square",
            EQUAL,
            [1.0 - PRINTED, 1.0 + PRINTED],
            Estimate { value: line / limit.value, half_width: line * limit.half_width / limit.value.powi(2) },
            "a line of length (2/sqrt(pi)) L has k = 1.12838 E* L: equal areas are not equal stiffnesses",
        ),
    ])
}
