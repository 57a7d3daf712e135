use super::*;
use proptest::prelude::*;
use std::collections::HashSet;

fn value(text: &str, dimension: Dimension) -> u64 {
    Quantity::parse_as(text, dimension).unwrap().to_bits()
}

#[test]
fn what_a_scene_writes() {
    for (text, dimension, expected) in [
        ("1 mm", Dimension::LENGTH, 1e-3),
        ("0.3um", Dimension::LENGTH, 3e-7),
        ("0.3 \u{b5}m", Dimension::LENGTH, 3e-7),
        ("0.3 \u{3bc}m", Dimension::LENGTH, 3e-7),
        (" 12.5 nm ", Dimension::LENGTH, 1.25e-8),
        ("5 \u{c5}", Dimension::LENGTH, 5e-10),
        ("-2e-3 m", Dimension::LENGTH, -2e-3),
        ("1e3 km", Dimension::LENGTH, 1e6),
        (".5 cm", Dimension::LENGTH, 5e-3),
        ("5. cm", Dimension::LENGTH, 5e-2),
        ("70 GPa", Dimension::PRESSURE, 7e10),
        ("70 N/mm^2", Dimension::PRESSURE, 7e7),
        ("2 kbar", Dimension::PRESSURE, 2e8),
        ("3 micron", Dimension::LENGTH, 3e-6),
        ("10 mN", Dimension::FORCE, 1e-2),
        ("3 kg m/s^2", Dimension::FORCE, 3.0),
        ("0.05 J/m^2", Dimension::ENERGY_PER_AREA, 0.05),
        ("50 mJ/m\u{b2}", Dimension::ENERGY_PER_AREA, 0.05),
        ("50 mJ m\u{207b}\u{b2}", Dimension::ENERGY_PER_AREA, 0.05),
        ("50 mN/m", Dimension::ENERGY_PER_AREA, 0.05),
        ("1.5 min", Dimension::TIME, 90.0),
        ("2 h", Dimension::TIME, 7200.0),
        ("3 ms", Dimension::TIME, 3e-3),
        ("10 1/s", Dimension::RATE, 10.0),
        ("10 Hz", Dimension::RATE, 10.0),
        ("1 GPa s", Dimension::VISCOSITY, 1e9),
        ("1 GPa\u{b7}s", Dimension::VISCOSITY, 1e9),
        ("17 n\u{3a9} m", Dimension::RESISTIVITY, 1.7e-8),
        ("400 W/(m K)", Dimension::THERMAL_CONDUCTIVITY, 400.0),
        ("400 W/(m*K)", Dimension::THERMAL_CONDUCTIVITY, 400.0),
        ("30 %", Dimension::NONE, 0.3),
        ("0.3", Dimension::NONE, 0.3),
        ("0.3 none", Dimension::NONE, 0.3),
        ("0 mm", Dimension::LENGTH, 0.0),
    ] {
        assert_eq!(value(text, dimension), f64::to_bits(expected), "{text}");
    }
}

#[test]
fn feet_and_pounds_are_those_of_the_definitions() {
    for (text, dimension, expected) in [
        ("30000 psi", Dimension::PRESSURE, 206_842_718.795_050_83),
        ("2 kgf", Dimension::FORCE, 19.6133),
        ("0.5 inch", Dimension::LENGTH, 0.0127),
        ("2 mil", Dimension::LENGTH, 50.8e-6),
    ] {
        let found = Quantity::parse_as(text, dimension).unwrap();
        approx::assert_relative_eq!(found, expected, max_relative = 4.0 * f64::EPSILON);
    }
}

#[test]
fn what_is_refused_says_why() {
    for (text, expected) in [
        ("", "empty: expected a number and a unit, such as \"1 mm\""),
        ("  ", "empty: expected a number and a unit, such as \"1 mm\""),
        ("mm", "\"mm\" does not begin with a number: expected a number and a unit, such as \"1 mm\""),
        ("nan m", "\"nan m\" does not begin with a number: expected a number and a unit, such as \"1 mm\""),
        ("- m", "\"- m\" does not begin with a number: expected a number and a unit, such as \"1 mm\""),
        ("1,5 mm", "\"1,5 mm\" has a decimal comma: write a point"),
        ("1e400 m", "1e400 m: beyond the range of double precision"),
        ("1e-400 m", "1e-400 m: beyond the range of double precision"),
        ("1e99999999999999999999 m", "1e99999999999999999999 m: beyond the range of double precision"),
        ("70 Gpa", "unknown unit \"Gpa\": upper and lower case differ, is it GPa?"),
        ("70 mpa", "unknown unit \"mpa\": upper and lower case differ, is it mPa or MPa?"),
        ("1 W/m K", "unit \"W/m K\": expected products and one quotient, such as \"J/m^2\" or \"W/(m K)\""),
        ("1 m/s/s", "unknown unit \"s/s\""),
        ("1 m^x", "unit \"m^x\": expected"),
        ("1 m^0", "unit \"m^0\": expected"),
        ("1 m^99", "unit \"m^99\": expected"),
        ("1 /", "unit \"/\": expected"),
        ("1 m/()", "unit \"m/()\": expected"),
        ("1 furlong", "unknown unit \"furlong\": expected m, g, s"),
        ("1 2 m", "unknown unit \"2\""),
        ("70 GPa", "70 GPa is a pressure: expected a length, such as \"1 mm\""),
        ("7", "7 is a number without a unit: expected a length, such as \"1 mm\""),
        ("7 m^3/s", "7 m^3/s is a quantity in m^3 s^-1: expected a length, such as \"1 mm\""),
    ] {
        let error = Quantity::parse_as(text, Dimension::LENGTH).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{text:?}: {error}");
    }
    assert!(Quantity::new(f64::NAN, Dimension::LENGTH).is_err());
    assert!(Quantity::of(1e308, &"km".parse().unwrap()).is_err());
    assert!("m".repeat(1000).parse::<Unit>().is_err());
}

#[test]
fn no_two_symbols_are_written_alike() {
    let mut seen = HashSet::new();
    for (_, prefix, symbol) in symbols::all() {
        assert!(seen.insert(format!("{prefix}{}", symbol.text)), "{prefix}{}", symbol.text);
    }
}

#[test]
fn quantities_are_shown_with_the_prefix_that_suits_them() {
    for (text, shown) in [
        ("0.001 m", "1 mm"),
        ("70e9 Pa", "70 GPa"),
        ("0.0002345 m", "234.5 um"),
        ("-0.25 N", "-250 mN"),
        ("0.05 J/m^2", "50 mJ/m^2"),
        ("2 mm^2", "2 mm^2"),
        ("2e-12 m^2", "2 um^2"),
        ("3 kg", "3 kg"),
        ("3", "3"),
        ("0 nm", "0 m"),
        ("1e-30 m", "1e-18 pm"),
    ] {
        assert_eq!(text.parse::<Quantity>().unwrap().to_string(), shown);
    }
    assert_eq!("um".parse::<Unit>().unwrap().to_string(), "um");
    assert_eq!("none".parse::<Unit>().unwrap().to_string(), "no unit");
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,40}") {
        if let Ok(quantity) = text.parse::<Quantity>() {
            prop_assert!(quantity.value().is_finite());
        }
        let _ = text.parse::<Unit>();
    }

    #[test]
    fn almost_quantities_are_read_or_refused(text in "[-+]?[0-9.,]{0,5}(e[-+]?[0-9]{0,4})? ?[mMkGuNPa/^0-9 ()*-]{0,12}") {
        if let Ok(quantity) = text.parse::<Quantity>() {
            prop_assert!(quantity.value().is_finite());
        }
    }

    #[test]
    fn what_is_shown_is_read_again(value in -1e12..1e12f64) {
        let quantity = Quantity::new(value, Dimension::PRESSURE).unwrap();
        prop_assert_eq!(quantity.to_string().parse::<Quantity>().unwrap(), quantity);
    }

    #[test]
    fn a_number_and_its_unit_are_one_number(value in 0.0..1e6f64) {
        let written: Quantity = format!("{value} um").parse().unwrap();
        let once: f64 = format!("{value}e-6").parse().unwrap();
        prop_assert_eq!(written.value().to_bits(), once.to_bits());
    }
}
