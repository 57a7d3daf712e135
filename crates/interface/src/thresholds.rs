//! The load at which something begins: the interface closes, or a body yields.
//!
//! A sweep of loads has a last state before it and a first one after it. [`bracketed_force`] solves loads between
//! them, by halving, until the bracket is as narrow as requested. It needs a prepared contact of any model.

use contact_model::{ContactState, Error, Load, PreparedContact, Result, Stop};

/// Two normal forces between which something begins.
///
/// `is_reached` says of a state whether it has begun. It has to be false at the first of the `forces` and true at
/// the second one; between them it is expected to change once. The bracket is halved until it is not wider than
/// `share` of its upper end. For an elastic contact the gap falls everywhere as the force grows, so that the
/// interface opens and closes at one force.
///
/// The states need the fields that `is_reached` looks at. For the closing of the gap:
///
/// ```no_run
/// # use contact_model::{Boundary, PreparedContact, never};
/// # use interface::{FlowAxis, bracketed_force, open_gap, percolation};
/// # fn example(mut contact: Box<dyn PreparedContact>) -> contact_model::Result<()> {
/// let closing = bracketed_force(contact.as_mut(), [0.01, 0.1], 1e-3, &never, |state| {
///     Ok(!percolation(&open_gap(state)?, 0.0, FlowAxis::X, Boundary::Periodic)?.spans)
/// })?;
/// assert!(closing[1] - closing[0] <= 1e-3 * closing[1]);
/// # Ok(())
/// # }
/// ```
///
/// Cost: two solves at the ends, and one for each halving, about `log2(1/share)`.
///
/// # Errors
/// [`Error::Domain`] for forces that are not finite or not in this order, a share that is not positive, and where
/// `is_reached` is not false at the first force and true at the second; errors of the solves and of `is_reached`.
pub fn bracketed_force(
    contact: &mut dyn PreparedContact,
    forces: [f64; 2],
    share: f64,
    stop: Stop<'_>,
    is_reached: impl Fn(&ContactState) -> Result<bool>,
) -> Result<[f64; 2]> {
    let [below, above] = forces;
    if !(below.is_finite() && above.is_finite() && below < above) {
        return Err(Error::domain(
            "second force",
            above,
            format!("a number larger than the first force {below}"),
        ));
    }
    let mut reached = |force: f64| is_reached(&contact.solve_until(Load::force(force), stop)?);
    if reached(below)? {
        return Err(Error::domain("first force", below, "a force at which it has not begun"));
    }
    if !reached(above)? {
        return Err(Error::domain("second force", above, "a force at which it has begun"));
    }
    bracketed(forces, share, reached)
}

/// Two numbers between which something begins: it has not begun at the first of `ends`, and it has at the second
/// one, which may be the smaller of both, as a mean gap is. `is_reached` says so of a number between them, and the
/// bracket is halved until it is not wider than `share` of its larger end.
///
/// # Errors
/// [`Error::Domain`] for a share that is not positive; errors of `is_reached`.
///
/// ```
/// let root = interface::bracketed([1.0, 2.0], 1e-6, |x| Ok(x * x >= 2.0))?;
/// assert!(root[0] * root[0] < 2.0 && root[1] * root[1] >= 2.0 && root[1] - root[0] <= 2e-6);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn bracketed(
    ends: [f64; 2],
    share: f64,
    mut is_reached: impl FnMut(f64) -> Result<bool>,
) -> Result<[f64; 2]> {
    if share.is_nan() || share <= 0.0 {
        return Err(Error::of_positive("share", share));
    }
    let [mut before, mut after] = ends;
    while (after - before).abs() > share * before.abs().max(after.abs()) {
        let middle = f64::midpoint(before, after);
        // Neighbouring numbers have no other one between them.
        if [before, after].map(f64::to_bits).contains(&middle.to_bits()) {
            break;
        }
        *(if is_reached(middle)? { &mut after } else { &mut before }) = middle;
    }
    Ok([before, after])
}
