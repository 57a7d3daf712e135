//! Values as TOML, so that they are read as the same numbers.

use crate::scenes::read::System;
use runs::cluster::toml;
use surface_io::{Dimension, Quantity, Sides};

/// A number with all its digits.
pub(crate) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A word or a text.
pub(crate) fn text(text: &str) -> String {
    toml(text)
}

/// A list; one value stands alone.
pub(crate) fn list(values: &[String]) -> String {
    match values {
        [value] => value.clone(),
        _ => format!("[{}]", values.join(", ")),
    }
}

/// A quantity: with its unit, such as `"0.5 um"`, or as a plain number where the scene has no units.
pub(crate) fn quantity(value: f64, dimension: Dimension, system: System) -> String {
    match system {
        System::None => number(value),
        System::Si => text(&in_units(value, dimension)),
    }
}

/// The value of a quantity of a scene of this system.
pub(crate) fn measured(quantity: Quantity, system: System) -> String {
    self::quantity(quantity.value(), quantity.dimension(), system)
}

/// One side, or both.
pub(crate) fn sides(sides: Sides, system: System) -> String {
    match sides {
        Sides::One(side) => measured(side, system),
        Sides::Two(both) => list(&both.map(|side| measured(side, system))),
    }
}

/// A quantity with its unit.
fn in_units(value: f64, dimension: Dimension) -> String {
    Quantity::new(value, dimension).map_or_else(|_| number(value), |quantity| quantity.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quantities_have_the_unit_that_suits_them() {
        let shown = |value, dimension| quantity(value, dimension, System::Si);
        assert_eq!(shown(5e-7, Dimension::LENGTH), "\"500 nm\"");
        assert_eq!(shown(1.5e-6, Dimension::LENGTH), "\"1.5 um\"");
        assert_eq!(shown(1e6, Dimension::PRESSURE), "\"1 MPa\"");
        assert_eq!(shown(2.1e11, Dimension::PRESSURE), "\"210 GPa\"");
        assert_eq!(shown(-0.25, Dimension::FORCE), "\"-250 mN\"");
        assert_eq!(shown(0.05, Dimension::ENERGY_PER_AREA), "\"50 mJ/m^2\"");
        assert_eq!(shown(0.0, Dimension::TIME), "\"0 s\"");
        assert_eq!(quantity(0.1, Dimension::LENGTH, System::None), "0.1");
    }

    proptest! {
        #[test]
        fn they_are_read_as_the_same_numbers(value in proptest::num::f64::NORMAL) {
            for dimension in [Dimension::LENGTH, Dimension::PRESSURE, Dimension::TIME, Dimension::VISCOSITY] {
                prop_assert_eq!(Quantity::parse_as(&in_units(value, dimension), dimension), Ok(value));
            }
        }
    }
}
