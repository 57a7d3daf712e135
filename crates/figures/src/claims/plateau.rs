//! Both plateaus, by solving full contact.

use bem3d::Bem3d;
use contact_model::{ContactModel as _, Load, PAPER_STIFFNESS_FACTOR, Scene, SelfAffine, Surface};
use evaluation::Claim;
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
    let [n, m] = GRIDS;
    let (coarse, fine) = (square(n)?, square(m)?);
    let limit = (m as f64 * fine - n as f64 * coarse) / (m - n) as f64;
    let line = line()?;
    Ok(vec![
        Claim::compare(
            "plateau 3D: k_s/(E* L)",
            PAPER_STIFFNESS_FACTOR,
            limit,
            None,
            PRINTED,
            format!(
                "1.1419 = 1.012 x 2/sqrt(pi) is an old value for the rigid square punch and not the converged one, 1.152298 (the capacitance of the \
                 unit square agrees); here full contact of {n} and {m} cells a side, extrapolated in 1/N; so the continuum plateau of k_bar is \
                 1.0091; allowed: the last printed digit"
            ),
        ),
        Claim::compare(
            "plateau 1D over plateau 3D",
            1.0,
            line / limit,
            None,
            PRINTED,
            "\"exactly the same in the 1D and 3D cases\" (Sec. III); a line of length (2/sqrt(pi)) L has k = 1.12838 E* L, 2 % below the square: \
             equal areas are not equal stiffnesses; allowed: the last printed digit of 1.1419",
        ),
    ])
}
