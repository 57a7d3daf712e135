//! The line search of the outer iteration where cells reach their upper bound.

/// Where a step began.
#[derive(Debug, Clone, Copy)]
pub struct StepStart<'a> {
    /// The pressure.
    pub pressure: &'a [f64],
    /// The gap under it, on the same cells.
    pub gap: &'a [f64],
    /// Its approach.
    pub approach: f64,
}

/// Shortens a step where the energy `p (u/2 + z)` has its minimum before the share `whole` of the step: the
/// new pressure `p` and its u + z become those of the minimum. All are on the same cells. Returns the share of
/// the step that is taken, if it was shortened.
///
/// Without it the iteration may alternate between contact sets for ever. Both pressures obey the bounds and
/// have the same force, and so has every pressure between them; u is linear. A step that was cut at the
/// bounds need not begin downhill, though: a step whose minimum is at its beginning has length zero, and the
/// next one is the same again. See [`crate::law::descend`].
pub fn shorten(start: StepStart<'_>, p: &mut [f64], displaced: &mut [f64], whole: f64) -> Option<f64> {
    let StepStart { pressure: before, gap, approach: d } = start;
    let (mut first, mut last) = (0.0, 0.0);
    for i in 0..p.len() {
        let change = p[i] - before[i];
        if change != 0.0 {
            first += change * gap[i];
            last += change * (displaced[i] - d);
        }
    }
    let share = first / (first - last);
    // The energy is convex. Errors of the gaps can make it look concave: the share is then negative, and the
    // step would go back.
    if !(first < 0.0 && last > 0.0 && share < whole) {
        return None;
    }
    for i in 0..p.len() {
        p[i] = before[i] + share * (p[i] - before[i]);
        displaced[i] = gap[i] + d + share * (displaced[i] - (gap[i] + d));
    }
    Some(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_two_cells_is_shortened_by_hand() {
        // Changes of 1/2 and -1/2; the slope of the energy is -3/4 before and 1/4 after it: three quarters
        // are left.
        let start = StepStart { pressure: &[1.0, 2.0], gap: &[-1.0, 0.5], approach: 0.5 };
        let (mut p, mut displaced) = ([1.5, 1.5], [1.0, 0.5]);
        assert_eq!(shorten(start, &mut p, &mut displaced, 0.9), Some(0.75));
        assert_eq!((p, displaced), ([1.375, 1.625], [0.625, 0.625]));
    }

    #[test]
    fn a_step_is_shortened_to_the_minimum_on_its_way_and_never_turned_back() {
        // One cell whose pressure rises by 1: slopes of the energy from -1 to `last`, with d = 0.
        let shortened = |last: f64| {
            let (mut p, mut displaced) = ([2.0], [last]);
            let start = StepStart { pressure: &[1.0], gap: &[-1.0], approach: 0.0 };
            let was = shorten(start, &mut p, &mut displaced, 0.9);
            (was.is_some(), p[0], displaced[0])
        };
        // Half of the way, where the slope is zero.
        assert_eq!(shortened(1.0), (true, 1.5, 0.0));
        // The minimum lies beyond nine tenths of the step, or beyond all of it.
        assert_eq!(shortened(0.1), (false, 2.0, 0.1));
        assert_eq!(shortened(-0.5), (false, 2.0, -0.5));
        // A gap with an error in it can make the energy look concave: the share would be negative.
        assert_eq!(shortened(-1.5), (false, 2.0, -1.5));
    }
}
