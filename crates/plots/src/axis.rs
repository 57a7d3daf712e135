//! Axes: their ends, their ticks and their labels.

use crate::text::number;

/// Ends of an axis, and whether it is logarithmic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axis {
    /// From, to.
    Linear(f64, f64),
    /// From, to; both positive.
    Log(f64, f64),
}

/// A tick.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    /// Position along the axis, from 0 to 1.
    pub at: f64,
    /// Long, with or without a label; others are short.
    pub major: bool,
    /// Its label.
    pub label: Option<String>,
}

/// Most decades with a label each, and with short ticks at 2 to 9.
const LABELLED: i32 = 12;
/// Where a label stands for more decades than this, the others have no tick: the whole range of numbers has
/// 640.
const DENSE: i32 = 9;
/// With fewer decades on the axis than this, 2 and 5 have labels as well.
const FEW: usize = 3;

impl Axis {
    /// Both ends.
    pub fn ends(self) -> (f64, f64) {
        match self {
            Self::Linear(a, b) | Self::Log(a, b) => (a, b),
        }
    }

    /// Position of a value: 0 at the start, 1 at the end; `None` where the axis cannot show it.
    pub fn place(self, value: f64) -> Option<f64> {
        let t = match self {
            Self::Linear(a, b) => {
                // Differences of the largest numbers overflow.
                let scale = if (value - a).is_finite() && (b - a).is_finite() { 1.0 } else { 0.25 };
                (scale * value - scale * a) / (scale * b - scale * a)
            }
            // A ratio may overflow where a difference of logarithms does not.
            Self::Log(a, b) => (value.ln() - a.ln()) / (b.ln() - a.ln()),
        };
        t.is_finite().then_some(t)
    }

    /// Whether a value lies between the ends.
    pub fn holds(self, value: f64) -> bool {
        let (a, b) = self.ends();
        (a..=b).contains(&value)
    }

    /// Ticks, and the power of ten that their labels leave out.
    pub(crate) fn ticks(self, given: Option<&[f64]>) -> (Vec<Tick>, Option<i32>) {
        let tick = |value: f64, major: bool, label: Option<String>| {
            let at = self.place(value)?;
            (-1e-9..=1.0 + 1e-9).contains(&at).then_some(Tick { at, major, label })
        };
        if let Some(given) = given {
            return (given.iter().filter_map(|v| tick(*v, true, Some(number(*v)))).collect(), None);
        }
        let (a, b) = self.ends();
        // Ends that are no axis have no ticks.
        if !(a < b && a.is_finite() && b.is_finite()) || matches!(self, Self::Log(..)) && a <= 0.0 {
            return (Vec::new(), None);
        }
        match self {
            Self::Log(..) => {
                let (first, last) = (a.log10().floor() as i32, b.log10().ceil() as i32);
                let step = (last - first + LABELLED - 1) / LABELLED;
                let decades = (first..=last).filter(|e| self.holds(power_of_ten(*e))).count();
                // One style along the axis.
                let scientific = a < 1e-3 || b >= 1e5;
                let mut ticks = Vec::new();
                for e in first..=last {
                    let decade = power_of_ten(e);
                    let labelled = e % step == 0;
                    if step > DENSE && !labelled {
                        continue;
                    }
                    let label = |digit: i32| named(digit, e, scientific);
                    ticks.extend(tick(decade, labelled, labelled.then(|| label(1))));
                    for digit in 2..10 {
                        let major = decades < FEW && (digit == 2 || digit == 5);
                        if step == 1 {
                            let value = f64::from(digit) * decade;
                            ticks.extend(tick(value, major, major.then(|| label(digit))));
                        }
                    }
                }
                (ticks, None)
            }
            Self::Linear(..) => {
                // The length of the axis may overflow; a power of two keeps every digit.
                let shrunk = if (b - a).is_finite() { 1.0 } else { 0.25 };
                let (a, b) = (shrunk * a, shrunk * b);
                let (step, parts) = step(b - a);
                let largest = (a.abs().max(b.abs()) / shrunk).log10().floor();
                let exponent = if (-2.0..4.0).contains(&largest) { 0 } else { largest as i32 };
                let scale = power_of_ten(exponent);
                let decimals = (-(step / shrunk / scale).log10().floor()).clamp(0.0, MOST_DECIMALS) as usize;
                let small = step / f64::from(parts);
                let ticks = ((a / small).ceil() as i64..=(b / small).floor() as i64).filter_map(|i| {
                    let major = i % i64::from(parts) == 0;
                    let value = i as f64 * small / shrunk;
                    let text = format!("{:.decimals$}", value / scale + 0.0).replace('-', "\u{2212}");
                    tick(value, major, major.then_some(text))
                });
                (ticks.collect(), (exponent != 0).then_some(exponent))
            }
        }
    }
}

/// Digits after the point of a label: a number has no more.
const MOST_DECIMALS: f64 = 17.0;

/// The number nearest to a power of ten: 0 or infinity beyond the numbers, but right among subnormal ones,
/// where `powi` gives 0.
pub(crate) fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}

/// A digit times a power of ten, or where no number of the axis is long, as a plain number.
fn named(digit: i32, exponent: i32, scientific: bool) -> String {
    match digit {
        _ if !scientific => number(f64::from(digit) * power_of_ten(exponent)),
        1 => format!("$10^{{{exponent}}}$"),
        _ => format!("${digit}×10^{{{exponent}}}$"),
    }
}

/// A step of 1, 2 or 5 in its decade for about five labels, and how many short ticks divide it.
fn step(range: f64) -> (f64, u8) {
    let rough = (range / 6.0).max(f64::MIN_POSITIVE);
    let decade = power_of_ten(rough.log10().floor() as i32);
    match rough / decade {
        r if r < 1.5 => (decade, 5),
        r if r < 3.0 => (2.0 * decade, 4),
        r if r < 7.0 => (5.0 * decade, 5),
        _ => (10.0 * decade, 5),
    }
}

/// A logarithmic axis around positive values with room for their marks; one decade around nothing.
pub fn logarithmic(values: impl IntoIterator<Item = f64>) -> Axis {
    const ROOM: f64 = 1.7;
    /// Among subnormal numbers a factor of 1.7 may round to 1.
    const SMALLEST: f64 = 5e-324;
    let (low, high) = extent(values.into_iter().filter(|v| *v > 0.0 && v.is_finite())).unwrap_or((1.0, 10.0));
    let end = (high * ROOM).min(f64::MAX).max(high + SMALLEST);
    Axis::Log((low / ROOM).max(SMALLEST), end)
}

/// A linear axis around values with room for their marks.
pub fn linear(values: impl IntoIterator<Item = f64>) -> Axis {
    /// Shorter axes have subnormal steps, which lose their digits.
    const SHORTEST: f64 = 1e-300;
    let (low, high) = extent(values.into_iter().filter(|v| v.is_finite())).unwrap_or((0.0, 1.0));
    let room = match high - low {
        range if range > 0.0 => (0.06 * high - 0.06 * low).max(SHORTEST),
        _ if high.abs() > 0.0 => high.abs().max(SHORTEST),
        _ => 1.0,
    };
    Axis::Linear((low - room).max(-f64::MAX), (high + room).min(f64::MAX))
}

/// Smallest and largest value.
pub fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().fold(None, |e, v| match e {
        None => Some((v, v)),
        Some((a, b)) => Some((a.min(v), b.max(v))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(axis: Axis) -> Vec<String> {
        axis.ticks(None).0.into_iter().filter_map(|t| t.label).collect()
    }

    #[test]
    fn decades_are_powers_of_ten_with_short_ticks_between() {
        let axis = Axis::Log(0.5e-3, 20.0);
        assert_eq!(labels(axis), ["$10^{-3}$", "$10^{-2}$", "$10^{-1}$", "$10^{0}$", "$10^{1}$"]);
        assert_eq!(labels(Axis::Log(0.5e-2, 2e3)), ["0.01", "0.1", "1", "10", "100", "1000"]);
        let (ticks, _) = axis.ticks(None);
        // 5 to 9 below 1e-3, four whole decades, 2 in the last.
        assert_eq!(ticks.iter().filter(|t| !t.major).count(), 5 + 4 * 8 + 1);
    }

    #[test]
    fn less_than_three_decades_have_more_labels() {
        assert_eq!(labels(Axis::Log(150.0, 7000.0)), ["200", "500", "1000", "2000", "5000"]);
        assert_eq!(
            labels(Axis::Log(9e-6, 3e-4)),
            ["$10^{-5}$", "$2×10^{-5}$", "$5×10^{-5}$", "$10^{-4}$", "$2×10^{-4}$"]
        );
        assert!(labels(Axis::Log(1e-30, 1e30)).len() < 14);
    }

    proptest! {
        /// Any bits, so that exponents are spread evenly from subnormal numbers to 1e308.
        #[test]
        fn axes_around_any_numbers_hold_them_and_have_a_place_for_each(
            bits in prop::collection::vec(any::<u64>(), 0..4), repeated in any::<bool>(), near in any::<bool>(),
        ) {
            let mut values: Vec<f64> = bits.into_iter().map(f64::from_bits).collect();
            if let (true, Some(&v)) = (repeated, values.first()) {
                values.push(if near { v.next_up() } else { v });
            }
            for axis in [linear(values.iter().copied()), logarithmic(values.iter().copied())] {
                let (a, b) = axis.ends();
                prop_assert!(a < b && a.is_finite() && b.is_finite(), "{axis:?}");
                prop_assert!(axis.place(a) == Some(0.0) && axis.place(b) == Some(1.0), "{axis:?}");
                let shown = |v: &&f64| v.is_finite() && (**v > 0.0 || matches!(axis, Axis::Linear(..)));
                for v in values.iter().filter(shown) {
                    prop_assert!(axis.holds(*v), "{v:e} in {axis:?}");
                    prop_assert!(axis.place(*v).is_some_and(|t| (0.0..=1.0).contains(&t)), "{v:e} in {axis:?}");
                }
                well_formed(axis)?;
            }
        }

        #[test]
        fn any_two_ends_have_ticks_within_them_or_none(a in any::<u64>(), b in any::<u64>(), equal in any::<bool>()) {
            let (a, b) = (f64::from_bits(a), f64::from_bits(if equal { a } else { b }));
            for axis in [Axis::Linear(a, b), Axis::Log(a, b)] {
                well_formed(axis)?;
            }
        }
    }

    fn well_formed(axis: Axis) -> Result<(), TestCaseError> {
        let (ticks, _) = axis.ticks(None);
        prop_assert!(ticks.len() < 150, "{} ticks on {axis:?}", ticks.len());
        for tick in &ticks {
            prop_assert!((-1e-9..=1.0 + 1e-9).contains(&tick.at), "{tick:?} on {axis:?}");
            let label = tick.label.as_deref().unwrap_or_default();
            prop_assert!(
                !label.contains("NaN") && !label.contains("inf") && label.len() < 60,
                "{label} on {axis:?}"
            );
        }
        axis.ticks(Some(&[axis.ends().0, 0.0, 5e-324, -1e308, f64::NAN]));
        Ok(())
    }

    #[test]
    fn subnormal_numbers_have_decades() {
        let axis = logarithmic([1e-320, 1e-310]);
        assert_eq!(labels(axis).first().map(String::as_str), Some("$10^{-320}$"));
        assert_eq!(labels(axis).last().map(String::as_str), Some("$10^{-310}$"));
    }

    #[test]
    fn linear_steps_are_round_and_a_power_of_ten_stands_apart() {
        assert_eq!(labels(Axis::Linear(1.9, 3.1)), ["2.0", "2.2", "2.4", "2.6", "2.8", "3.0"]);
        assert_eq!(Axis::Linear(0.0, 5e-6).ticks(None).1, Some(-6));
        assert_eq!(labels(Axis::Linear(-1.0, 1.0))[1], "\u{2212}0.5");
        assert_eq!(labels(Axis::Linear(0.0, 5e-6))[..3], ["0", "1", "2"]);
    }
}
