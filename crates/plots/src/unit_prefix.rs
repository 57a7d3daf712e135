//! Units with the prefix that suits a number.

/// Prefixes and their powers of ten.
const PREFIXES: [(&str, i32); 9] =
    [("p", -12), ("n", -9), ("µ", -6), ("m", -3), ("", 0), ("k", 3), ("M", 6), ("G", 9), ("T", 12)];

/// The unit in which a number of metres, newtons or pascals has one to three digits before the point, and the
/// factor from its plain unit to that one. Lengths have no larger unit than the metre; every other unit is
/// left as it is.
///
/// ```
/// assert_eq!(plots::prefixed("m", 2.5e-8), ("nm".to_owned(), 1e9));
/// assert_eq!(plots::prefixed("Pa", 4e11), ("GPa".to_owned(), 1e-9));
/// assert_eq!(plots::prefixed("m", 5e4), ("m".to_owned(), 1.0));
/// assert_eq!(plots::prefixed("", 5e4), (String::new(), 1.0));
/// assert_eq!(plots::prefixed("N", 0.0), ("N".to_owned(), 1.0));
/// ```
pub fn prefixed(unit: &str, value: f64) -> (String, f64) {
    let largest = match unit {
        "m" => 0,
        "N" | "Pa" => 12,
        _ => return (unit.to_owned(), 1.0),
    };
    let size = value.abs();
    // A thousandth of a digit, because 1e-7 m is 99.99999999999999 nm.
    let fits = |power: i32| power <= largest && 10f64.powi(power) <= size * 1.001;
    let prefix = PREFIXES.iter().rev().find(|(_, power)| size.is_finite() && fits(*power));
    let (prefix, power) =
        *prefix.unwrap_or(if size > 0.0 && size.is_finite() { &PREFIXES[0] } else { &PREFIXES[4] });
    (format!("{prefix}{unit}"), 10f64.powi(-power))
}
