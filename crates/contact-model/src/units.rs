//! Numbers as people read them: in the multiple of their unit that suits their size, and without digits that
//! are only rounding errors.
//!
//! Files hold plain SI; these are for tables, captions and axes.

/// Prefixes and their powers of ten.
const PREFIXES: [(&str, i32); 9] =
    [("p", -12), ("n", -9), ("µ", -6), ("m", -3), ("", 0), ("k", 3), ("M", 6), ("G", 9), ("T", 12)];

/// An SI unit with its multiples: the text before and behind the prefix, the power to which the prefix is
/// raised, and the smallest and the largest power of ten of the prefix.
struct UnitScale {
    unit: &'static str,
    head: &'static str,
    base: &'static str,
    power: i32,
    prefixes: [i32; 2],
}

const fn scale(
    unit: &'static str,
    head: &'static str,
    base: &'static str,
    power: i32,
    prefixes: [i32; 2],
) -> UnitScale {
    UnitScale { unit, head, base, power, prefixes }
}

/// Lengths have no larger unit than the metre, times none than the second.
const SCALES: [UnitScale; 16] = [
    scale("m", "", "m", 1, [-12, 0]),
    scale("m^2", "", "m^2", 2, [-9, 0]),
    scale("m^3", "", "m^3", 3, [-9, 0]),
    scale("m^4", "", "m^4", 4, [-9, 0]),
    scale("1/m", "1/", "m", -1, [-9, 0]),
    scale("1/m^2", "1/", "m^2", -2, [-9, 0]),
    scale("s", "", "s", 1, [-12, 0]),
    scale("N", "", "N", 1, [-12, 12]),
    scale("Pa", "", "Pa", 1, [-12, 12]),
    scale("1/Pa", "1/", "Pa", -1, [-12, 12]),
    scale("Pa s", "", "Pa s", 1, [-12, 12]),
    scale("J", "", "J", 1, [-12, 12]),
    scale("J/m^2", "", "J/m^2", 1, [-12, 12]),
    scale("S", "", "S", 1, [-12, 12]),
    scale("W/K", "", "W/K", 1, [-12, 12]),
    scale("N/m", "", "N/m", 1, [-12, 0]),
];

/// Stiffnesses are forces per mm and per µm, as testing machines show them.
const STIFFNESSES: [(&str, i32); 3] = [("N/mm", 3), ("N/µm", 6), ("kN/µm", 9)];

/// The multiples of a unit with their powers of ten, the smallest first; none of a unit that is left as it is.
fn multiples(unit: &str) -> Vec<(String, i32)> {
    let Some(scale) = SCALES.iter().find(|scale| scale.unit == unit) else { return Vec::new() };
    let within = |(_, power): &&(&str, i32)| (scale.prefixes[0]..=scale.prefixes[1]).contains(power);
    let named = PREFIXES.iter().filter(within);
    let mut all: Vec<(String, i32)> = named
        .map(|(prefix, power)| (format!("{}{prefix}{}", scale.head, scale.base), power * scale.power))
        .collect();
    if unit == "N/m" {
        all.extend(STIFFNESSES.map(|(name, power)| (name.to_owned(), power)));
    }
    all.sort_by_key(|(_, power)| *power);
    all
}

/// The multiple of an SI unit that suits a number, and the factor from the unit to that multiple.
///
/// The largest multiple in which the number is at least 1, of areas at least 0.01, of volumes at least 0.001;
/// zero, infinities and every other unit are left as they are. Lengths have no larger unit than the metre;
/// stiffnesses are per mm or per µm.
///
/// ```
/// use contact_model::units::multiple;
/// assert_eq!(multiple("m", 2.5e-8), ("nm".to_owned(), 1e9));
/// assert_eq!(multiple("m^2", 1.7e-10), ("µm^2".to_owned(), 1e12));
/// assert_eq!(multiple("N/m", 3.6e6), ("N/µm".to_owned(), 1e-6));
/// assert_eq!(multiple("Pa", 4e11), ("GPa".to_owned(), 1e-9));
/// assert_eq!(multiple("m", 5e4), ("m".to_owned(), 1.0));
/// assert_eq!(multiple("", 5e4), (String::new(), 1.0));
/// assert_eq!(multiple("N", 0.0), ("N".to_owned(), 1.0));
/// ```
pub fn multiple(unit: &str, value: f64) -> (String, f64) {
    let size = value.abs();
    let all = multiples(unit);
    if all.is_empty() || !(size > 0.0 && size.is_finite()) {
        return (unit.to_owned(), 1.0);
    }
    // Prefixes of a power are farther apart, so that smaller numbers of them are read.
    let power = SCALES.iter().find(|scale| scale.unit == unit).map_or(1, |scale| scale.power.abs());
    let slack = if power > 1 { power } else { 0 };
    // Four digits of 0.9999 are 1; of powers, what is below the limit has digits enough in the next one.
    let rounding = if slack > 0 { 1e-12 } else { 1e-3 };
    let fits = |exponent: i32| 10f64.powi(exponent - slack) <= size * (1.0 + rounding);
    let chosen = all.iter().rev().find(|(_, exponent)| fits(*exponent)).unwrap_or(&all[0]);
    (chosen.0.clone(), 10f64.powi(-chosen.1))
}

/// A number with its SI unit, in the multiple that suits it, with four digits and no zeros at their end. A
/// pure number (the units `1`, `-` and none) stands without a unit.
///
/// ```
/// use contact_model::units::amount;
/// assert_eq!(amount(3.1999999999999997e-4, "m"), "320 µm");
/// assert_eq!(amount(1.15e11, "Pa"), "115 GPa");
/// assert_eq!(amount(0.25, "1"), "0.25");
/// ```
pub fn amount(value: f64, unit: &str) -> String {
    to_digits(value, unit, 4)
}

/// As [`amount`], with `digits` significant digits.
pub fn to_digits(value: f64, unit: &str, digits: usize) -> String {
    let (unit, factor) = multiple(unit, value);
    let digits = number(rounded(factor * value, digits));
    match unit.as_str() {
        "" | "1" | "-" | "scene" => digits,
        unit => format!("{digits} {unit}"),
    }
}

/// The text of a unit in ASCII for terminals and files: `um` for `µm`, as in a scene.
pub fn ascii(text: &str) -> String {
    text.replace('µ', "u")
}

/// A height or a length with five significant digits and no zeros at the end, in ASCII: in the multiple of the unit that
/// suits it, or without one where the unit is empty because it is not known.
///
/// ```
/// use contact_model::units::five;
/// assert_eq!([6.79314, 1.0, 4.9144541e-8].map(|height| five(height, "")), ["6.7931", "1", "4.9145e-8"]);
/// assert_eq!(five(4.9144541e-8, "m"), "49.145 nm");
/// ```
pub fn five(value: f64, unit: &str) -> String {
    ascii(&to_digits(value, unit, 5))
}

/// The number rounded to `digits` significant digits, 1 to 17.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.clamp(1, 17) - 1).parse().unwrap_or(value)
}

/// A number with up to 14 digits, since later ones are rounding errors of a change of units; below 0.001 and
/// from a million on with a power of ten.
///
/// ```
/// use contact_model::units::number;
/// assert_eq!([0.25, 3.1999999999999997e-4, -3e9].map(number), ["0.25", "3.2e-4", "-3e9"]);
/// ```
pub fn number(value: f64) -> String {
    let value = rounded(value, 14);
    let size = value.abs();
    // No sign of a zero.
    if size > 0.0 && !(1e-3..1e6).contains(&size) { format!("{value:e}") } else { (value + 0.0).to_string() }
}

/// A number with four significant digits, including zeros at the end, for the cells of a table; zero is `0`.
///
/// ```
/// use contact_model::units::short;
/// assert_eq!([12.3456, 0.5, 123456.0, 0.0].map(short), ["12.35", "0.5000", "1.235e5", "0"]);
/// ```
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let value = rounded(value, 4);
    if !(1e-2..1e5).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let digits = (3 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [1e300, 2e-7, 0.25, 0.0, -0.0, -3e9, 3.199_999_999_999_999_7e-4].map(number),
            ["1e300", "2e-7", "0.25", "0", "0", "-3e9", "3.2e-4"]
        );
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1.000"),
            (0.012_345, "0.01235"),
            (999.96, "1000"),
            (98_765.4, "98770"),
            (1e5, "1.000e5"),
            (-1.5e-9, "-1.500e-9"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn units_are_those_of_an_engineer() {
        for (value, unit, text) in [
            (4.8e-5, "m", "48 µm"),
            (1e-3, "m", "1 mm"),
            (9.999_96e-4, "m", "1 mm"),
            (1.0, "m", "1 m"),
            (2e-13, "m", "0.2 pm"),
            (2.5e-12, "m^2", "2.5 µm^2"),
            (1.472e-10, "m^2", "147.2 µm^2"),
            (5e-8, "m^2", "0.05 mm^2"),
            (2.563e-14, "m^3", "25630 µm^3"),
            (2.956e5, "N/m", "295.6 N/mm"),
            (1.064e6, "N/m", "1.064 N/µm"),
            (2e9, "N/m", "2 kN/µm"),
            (0.02, "N/m", "20 mN/m"),
            (2.304e-3, "N", "2.304 mN"),
            (9.395e8, "Pa", "939.5 MPa"),
            (-4.5e-8, "J", "-45 nJ"),
            (0.05, "J/m^2", "50 mJ/m^2"),
            (2e5, "1/m", "200 1/mm"),
            (3e7, "1/m^2", "30 1/mm^2"),
            (1e-9, "1/Pa", "1 1/GPa"),
            (3600.0, "s", "3600 s"),
            (0.5, "1", "0.5"),
            (0.5, "scene", "0.5"),
            (f64::INFINITY, "m", "inf m"),
        ] {
            assert_eq!(amount(value, unit), text);
        }
    }

    /// Every unit, every power of ten: the number is the same, and short where a multiple of that size exists.
    #[test]
    fn multiples_change_no_number() {
        for scale in &SCALES {
            let all = multiples(scale.unit);
            assert!(all.windows(2).all(|pair| pair[0].1 < pair[1].1), "{}", scale.unit);
            assert!(all.iter().any(|(name, power)| *power == 0 && name == scale.unit), "{}", scale.unit);
            for exponent in -300..300 {
                for mantissa in [1.0, -3.7, 9.996] {
                    let value = mantissa * 10f64.powi(exponent);
                    let (unit, factor) = multiple(scale.unit, value);
                    let (_, power) =
                        all.iter().find(|(name, _)| *name == unit).expect("a multiple of the unit");
                    assert!((factor * 10f64.powi(*power) - 1.0).abs() < 1e-12, "{value:e} {unit}");
                    let inside = (all[0].1 + 1..all[all.len() - 1].1).contains(&exponent);
                    let read = amount(value, scale.unit);
                    // Twelve decades lie between multiples of a fourth power.
                    assert!(!inside || scale.power > 3 || !read.contains('e'), "{read}");
                    let digits: f64 = read.split(' ').next().unwrap().parse().unwrap();
                    assert!((digits / (value * factor) - 1.0).abs() < 5.1e-4, "{value:e}: {read}");
                }
            }
        }
    }
}
