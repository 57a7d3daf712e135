//! Axes: how far they go, where their ticks are and what stands at them.

use crate::text::number;

/// How far an axis goes, and whether it is logarithmic.
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
    /// Where, from 0 to 1 along the axis.
    pub at: f64,
    /// Long, with or without a label; others are short.
    pub major: bool,
    /// What stands at it.
    pub label: Option<String>,
}

/// Most decades with a label each, and with short ticks at 2 to 9.
const LABELLED: i32 = 12;
/// With fewer decades on the axis than this, 2 and 5 have labels as well.
const FEW: usize = 3;

impl Axis {
    /// Both ends.
    pub fn ends(self) -> (f64, f64) {
        match self {
            Self::Linear(a, b) | Self::Log(a, b) => (a, b),
        }
    }

    /// Where a value is: 0 at the start, 1 at the end; `None` where the axis has no place for it.
    pub fn place(self, value: f64) -> Option<f64> {
        let t = match self {
            Self::Linear(a, b) => (value - a) / (b - a),
            Self::Log(a, b) => (value / a).ln() / (b / a).ln(),
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
        match self {
            Self::Log(a, b) => {
                let (first, last) = (a.log10().floor() as i32, b.log10().ceil() as i32);
                let step = (last - first + LABELLED - 1) / LABELLED;
                let decades = (first..=last).filter(|e| self.holds(10_f64.powi(*e))).count();
                // One style along the axis.
                let scientific = a < 1e-3 || b >= 1e5;
                let mut ticks = Vec::new();
                for e in first..=last {
                    let decade = 10_f64.powi(e);
                    let labelled = e % step == 0;
                    let label = |digit: i32| named(digit, e, decades < FEW, scientific);
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
            Self::Linear(a, b) => {
                let (step, parts) = step(b - a);
                let largest = a.abs().max(b.abs()).log10().floor();
                let exponent = if (-2.0..4.0).contains(&largest) { 0 } else { largest as i32 };
                let scale = 10_f64.powi(exponent);
                let decimals = (-(step / scale).log10().floor()).max(0.0) as usize;
                let small = step / f64::from(parts);
                let ticks = ((a / small).ceil() as i64..=(b / small).floor() as i64).filter_map(|i| {
                    let major = i % i64::from(parts) == 0;
                    let value = i as f64 * small;
                    let text = format!("{:.decimals$}", value / scale + 0.0).replace('-', "\u{2212}");
                    tick(value, major, major.then_some(text))
                });
                (ticks.collect(), (exponent != 0).then_some(exponent))
            }
        }
    }
}

/// A digit times a power of ten; where labels are few and no number is long, as a plain number.
fn named(digit: i32, exponent: i32, few: bool, scientific: bool) -> String {
    match (digit, exponent) {
        (_, 0) => digit.to_string(),
        _ if few && !scientific => number(f64::from(digit) * 10_f64.powi(exponent)),
        (1, _) => format!("$10^{{{exponent}}}$"),
        _ => format!("${digit}×10^{{{exponent}}}$"),
    }
}

/// A step of 1, 2 or 5 in its decade for about five labels, and how many short ticks divide it.
fn step(range: f64) -> (f64, u8) {
    let rough = (range / 6.0).max(f64::MIN_POSITIVE);
    let decade = 10_f64.powf(rough.log10().floor());
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
    let (low, high) = extent(values.into_iter().filter(|v| *v > 0.0 && v.is_finite())).unwrap_or((1.0, 10.0));
    Axis::Log((low / ROOM).max(f64::MIN_POSITIVE), (high * ROOM).min(f64::MAX))
}

/// A linear axis around values with room for their marks.
pub fn linear(values: impl IntoIterator<Item = f64>) -> Axis {
    // Beyond, a difference overflows.
    let (low, high) = extent(values.into_iter().filter(|v| v.abs() < 1e300)).unwrap_or((0.0, 1.0));
    let room = match high - low {
        range if range > 0.0 => 0.06 * range,
        _ if high.abs() > 0.0 => high.abs(),
        _ => 1.0,
    };
    Axis::Linear(low - room, high + room)
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

    fn labels(axis: Axis) -> Vec<String> {
        axis.ticks(None).0.into_iter().filter_map(|t| t.label).collect()
    }

    #[test]
    fn decades_are_powers_of_ten_with_short_ticks_between() {
        let axis = Axis::Log(0.5e-3, 20.0);
        assert_eq!(labels(axis), ["$10^{-3}$", "$10^{-2}$", "$10^{-1}$", "1", "$10^{1}$"]);
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

    #[test]
    fn linear_steps_are_round_and_a_power_of_ten_stands_apart() {
        assert_eq!(labels(Axis::Linear(1.9, 3.1)), ["2.0", "2.2", "2.4", "2.6", "2.8", "3.0"]);
        assert_eq!(Axis::Linear(0.0, 5e-6).ticks(None).1, Some(-6));
        assert_eq!(labels(Axis::Linear(-1.0, 1.0))[1], "\u{2212}0.5");
        assert_eq!(labels(Axis::Linear(0.0, 5e-6))[..3], ["0", "1", "2"]);
    }
}
