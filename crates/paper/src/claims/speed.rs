//! How long both models took.

use crate::claim::{Claim, Estimate, Statement};
use evaluation::Measured;

const SPEED: Statement = Statement {
    quotation: "The mapping onto a one-dimensional problem drastically decreases the computation time",
    place: "abstract; Sec. IV (several weeks against a few seconds)",
    reading: "a factor of 100 or more",
};

/// Times of the stored units, whenever they were solved. Depends on the machine: never part of a file.
pub(crate) fn speed(solid: &Measured, line: &Measured) -> Claim {
    let (name, paper) = ("run time of 3D over 1D", [100.0, f64::INFINITY]);
    let (t3, t1) = (solid.seconds(), line.seconds());
    let count = |m: &Measured| m.series.iter().map(|s| s.units.len()).sum::<usize>();
    let sizes = format!(
        "{t3:.1} s for {} surfaces of {} cells a side, {t1:.1} s for {} lines of {} elements (sum over surfaces and lines; depends on the \
         machine); the solver here takes seconds for a surface",
        count(solid),
        solid.discretisation.size(),
        count(line),
        line.discretisation.size()
    );
    let claim = if solid.discretisation.size() < 2049 || line.discretisation.size() < 1 << 20 {
        let remark =
            format!("here {:.3e}: {sizes}; the statement is about 2049 cells and 2^20 elements", t3 / t1);
        Claim::unresolved(name, SPEED, paper, remark)
    } else {
        Claim::judge(name, SPEED, paper, Estimate::exact(t3 / t1), sizes)
    };
    Claim { timed: true, ..claim }
}
