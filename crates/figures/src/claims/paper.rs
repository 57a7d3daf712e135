//! Where the paper disagrees with itself.

use evaluation::Claim;

/// The abstract prints two digits of each exponent.
const PRINTED: f64 = 0.005;

/// The abstract's exponents against the paper's own fit. Here `here` is Eq. 6, not a computation.
pub(crate) fn paper_against_itself() -> Vec<Claim> {
    [(2.0, 0.50), (3.0, 0.85)]
        .map(|(d, abstract_)| {
            Claim::compare(
                format!("alpha of the abstract at D_f = {d:?} against Eq. 6"),
                abstract_,
                analytic::exponent_fit(d),
                None,
                PRINTED,
                "the abstract says 0.50 to 0.85, Eq. 6 gives 0.532 to 0.798 (the column `here`), a companion Letter 0.51 to 0.77; what is \
                 computed stands in the rows of alpha 3D; allowed: the last printed digit",
            )
        })
        .into()
}
