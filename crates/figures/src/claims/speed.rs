//! How long both models took.

use evaluation::Claim;
use evaluation::Measured;

/// "Several weeks" over "a few seconds": three weeks over ten seconds, to the nearest power of ten.
const PAPER: f64 = 1e5;

/// Times of the stored units, whenever they were solved. Depends on the machine: never part of a figure.
pub(crate) fn speed(solid: &Measured, line: &Measured) -> Claim {
    let claim = "run time of 3D over 1D";
    let (t3, t1) = (solid.seconds(), line.seconds());
    let count = |m: &Measured| m.series.iter().map(|s| s.units.len()).sum::<usize>();
    let sizes = format!(
        "{t3:.1} s for {} surfaces of {} cells a side, {t1:.1} s for {} lines of {} elements (sum over units; depends on the machine)",
        count(solid),
        solid.discretisation.size(),
        count(line),
        line.discretisation.size()
    );
    let mut claim = if solid.discretisation.size() < 2049 || line.discretisation.size() < 1 << 20 {
        Claim::not_tested(
            claim,
            PAPER,
            format!("here {:.3e}: {sizes}; the claim is for 2049 cells and 2^20 elements", t3 / t1),
        )
    } else {
        Claim::compare(
            claim,
            PAPER,
            t3 / t1,
            None,
            0.9 * PAPER,
            format!(
                "\"several weeks\" over \"a few seconds\" (Sec. IV); {sizes}; allowed: one order of magnitude below"
            ),
        )
    };
    claim.timed = true;
    claim
}
