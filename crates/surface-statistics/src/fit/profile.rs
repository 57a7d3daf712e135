//! Intervals from the profile of a likelihood.

use super::likelihood::{Likelihood, Parameters};

/// Halvings between a point inside and one outside of an interval.
const HALVINGS: usize = 9;
/// Doublings of the first step outwards.
const DOUBLINGS: usize = 24;
/// First step outwards of each parameter.
const FIRST_STEPS: [f64; 4] = [0.02, 0.05, 0.25, 2.0];
/// A profile below the minimum by more than this has found a better one.
const BETTER: f64 = 0.02;

/// How far the profile of one parameter stays within `rise` of the minimum, in one direction.
pub(super) enum End {
    At(f64),
    /// It does up to the limit of the parameter.
    Limit,
    /// A better minimum was met on the way.
    Better(Parameters),
}

/// A walk along the profile of one parameter, outwards from the minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProfileWalk {
    /// Index of the parameter.
    pub(super) index: usize,
    pub(super) upwards: bool,
    /// Rise of the profile at which the walk ends.
    pub(super) rise: f64,
}

/// Walks from the minimum to where the profile has risen, with some of the other parameters fixed.
pub(super) fn end(
    likelihood: &mut Likelihood,
    best: (Parameters, f64),
    others_fixed: &[usize],
    walk: ProfileWalk,
) -> End {
    let ProfileWalk { index, upwards, rise } = walk;
    let limit = likelihood.limits[index][usize::from(upwards)];
    let sign = if upwards { 1.0 } else { -1.0 };
    let middle = best.0.values[index];
    let fixed = [&[index], others_fixed].concat();
    let mut at = |value: f64, start: Parameters| {
        let mut start = start;
        start.values[index] = value;
        likelihood.minimum(start, &fixed)
    };
    let (mut inside, mut inside_at, mut step) = (best.0, middle, FIRST_STEPS[index]);
    let mut outside = None;
    for _ in 0..DOUBLINGS {
        let next = inside_at + sign * step;
        let beyond = sign * (next - limit) >= 0.0;
        let value = if beyond { limit } else { next };
        let found = at(value, inside);
        if found.1 < best.1 - BETTER {
            return End::Better(found.0);
        }
        if found.1 - best.1 > rise {
            outside = Some(value);
            break;
        }
        if beyond {
            return End::Limit;
        }
        (inside, inside_at, step) = (found.0, value, 2.0 * step);
    }
    let Some(mut outside) = outside else { return End::Limit };
    for _ in 0..HALVINGS {
        let value = 0.5 * (inside_at + outside);
        let found = at(value, inside);
        if found.1 < best.1 - BETTER {
            return End::Better(found.0);
        }
        if found.1 - best.1 > rise {
            outside = value;
        } else {
            (inside, inside_at) = (found.0, value);
        }
    }
    End::At(0.5 * (inside_at + outside))
}
