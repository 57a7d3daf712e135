//! What the paper says of the line beside its stiffness: Eq. 17, the area, experiments.

use crate::claim::{Claim, Estimate, Statement};
use contact_model::{Amplitude, SelfAffine};
use runs::{Error, Result};
use surface_gen::{LineGenerator, MapGenerator};

const MOMENTS: Statement = Statement {
    quotation: "This choice ensures that the one-dimensional rough line has the same rms roughness as well as the same moments and moments of derivatives of the surface profile as the three-dimensional original",
    place: "Sec. III, Eq. 17",
    reading: "the rms heights of line and surface are equal to 1 %",
};

const AREA: Statement = Statement {
    quotation: "engineering accuracy of several percent for dependencies of contact area on the normal force",
    place: "Sec. IV, refs. [11, 12]",
    reading: "the contact area of the line is that of the surface to 10 %",
};

const EXPERIMENTS: Statement = Statement {
    quotation: "but corresponds much better to the experimental measurements of contact stiffness reported in [23]",
    place: "Sec. II",
    reading: "measured stiffnesses follow a power law with an exponent below 1",
};

/// Elements and cells of the paper.
const SIZES: (usize, usize) = (1 << 20, 2049);

/// # Errors
/// What the generators refuse.
pub(crate) fn beside_stiffness() -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for d in [2.0, 2.4, 3.0] {
        let ratio = || {
            // One spectrum for both, not one rms height.
            let surface = SelfAffine { amplitude: Amplitude::Spectrum(1.0), ..SelfAffine::new(d, 1.0, 1.0)? };
            let line = LineGenerator::new(&surface, SIZES.0)?.rms_height();
            Ok(line / MapGenerator::new(&surface, SIZES.1)?.rms_height())
        };
        let ratio = ratio().map_err(Error::model(format!("rms heights at D_f = {d:?}")))?;
        let name = format!("rms height of the line over that of the surface, D_f = {d:?}");
        let remark = format!(
            "{} elements, {} cells a side, each to the ends of its own spectrum; F_bar counts the measured rms height of each",
            SIZES.0, SIZES.1
        );
        let claim = Claim::judge(name, MOMENTS, [0.99, 1.01], Estimate::exact(ratio), remark);
        claims.push(claim.in_convention("continuous integrals between equal limits", 1.0));
    }
    claims.push(Claim::unresolved(
        "contact area of the line over that of the surface",
        AREA,
        [0.9, 1.1],
        "no area is claimed for a rough line here: Lyashenko, Pastewka and Persson, Tribol. Lett. 52, 223 (2013), find that it fails even qualitatively",
    ));
    claims.push(Claim::unresolved(
        "exponent of measured stiffness over force",
        EXPERIMENTS,
        [0.0, 0.9],
        "the measurements of [23] are not available here; they would decide",
    ));
    Ok(claims)
}
