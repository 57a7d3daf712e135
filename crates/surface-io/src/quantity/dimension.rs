//! Dimensions of quantities.

use std::fmt;

/// Powers of metre, kilogram, second, ampere and kelvin.
///
/// ```
/// use surface_io::Dimension;
/// assert_eq!(Dimension::PRESSURE.to_string(), "a pressure");
/// assert_eq!(Dimension::PRESSURE.symbol(), "Pa");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Dimension {
    powers: [i8; 5],
}

/// Names, symbols and an example of the dimensions of this field.
const KNOWN: [(Dimension, &str, &str, &str); 12] = [
    (Dimension::NONE, "a number without a unit", "1", "0.3"),
    (Dimension::LENGTH, "a length", "m", "1 mm"),
    (Dimension::TIME, "a time", "s", "10 s"),
    (Dimension::FORCE, "a force", "N", "10 mN"),
    (Dimension::PRESSURE, "a pressure", "Pa", "70 GPa"),
    (Dimension::ENERGY_PER_AREA, "an energy per area", "J/m^2", "50 mJ/m^2"),
    (Dimension::VISCOSITY, "a viscosity", "Pa s", "1 GPa s"),
    (Dimension::AREA, "an area", "m^2", "1 mm^2"),
    (Dimension::RESISTIVITY, "a resistivity", "Ohm m", "17 nOhm m"),
    (Dimension::THERMAL_CONDUCTIVITY, "a thermal conductivity", "W/(m K)", "400 W/(m K)"),
    (Dimension::RATE, "a rate", "1/s", "10 1/s"),
    (Dimension::VELOCITY, "a velocity", "m/s", "1 um/s"),
];

impl Dimension {
    /// A number.
    pub const NONE: Self = Self::of([0, 0, 0, 0, 0]);
    /// Length.
    pub const LENGTH: Self = Self::of([1, 0, 0, 0, 0]);
    /// Area.
    pub const AREA: Self = Self::of([2, 0, 0, 0, 0]);
    /// Time.
    pub const TIME: Self = Self::of([0, 0, 1, 0, 0]);
    /// One over time.
    pub const RATE: Self = Self::of([0, 0, -1, 0, 0]);
    /// Length per time.
    pub const VELOCITY: Self = Self::of([1, 0, -1, 0, 0]);
    /// Force.
    pub const FORCE: Self = Self::of([1, 1, -2, 0, 0]);
    /// Force per area: pressures and moduli.
    pub const PRESSURE: Self = Self::of([-1, 1, -2, 0, 0]);
    /// Energy per area (the work of adhesion), which is also force per length (a stiffness).
    pub const ENERGY_PER_AREA: Self = Self::of([0, 1, -2, 0, 0]);
    /// Pressure times time.
    pub const VISCOSITY: Self = Self::of([-1, 1, -1, 0, 0]);
    /// Electrical resistance times length.
    pub const RESISTIVITY: Self = Self::of([3, 1, -3, -2, 0]);
    /// Power per length and temperature.
    pub const THERMAL_CONDUCTIVITY: Self = Self::of([1, 1, -3, 0, -1]);

    pub(super) const fn of(powers: [i8; 5]) -> Self {
        Self { powers }
    }

    /// The product with another one raised to a power; `None` beyond the range of the powers.
    pub(super) fn times(self, other: Self, power: i8) -> Option<Self> {
        let mut powers = self.powers;
        for (p, o) in powers.iter_mut().zip(other.powers) {
            *p = p.checked_add(o.checked_mul(power)?)?;
        }
        Some(Self { powers })
    }

    /// The SI unit: `Pa`, `J/m^2`, else a product such as `m^2 s^-1`.
    pub fn symbol(self) -> String {
        if let Some((_, _, symbol, _)) = KNOWN.iter().find(|known| known.0 == self) {
            return (*symbol).to_owned();
        }
        let factor = |(power, base): (&i8, &str)| match power {
            0 => None,
            1 => Some(base.to_owned()),
            power => Some(format!("{base}^{power}")),
        };
        let factors: Vec<String> =
            self.powers.iter().zip(["m", "kg", "s", "A", "K"]).filter_map(factor).collect();
        factors.join(" ")
    }

    /// A quantity of this dimension as it may be written; `None` for dimensions without a name.
    pub fn example(self) -> Option<&'static str> {
        KNOWN.iter().find(|known| known.0 == self).map(|known| known.3)
    }
}

impl fmt::Display for Dimension {
    /// In words, with an article: `a length`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match KNOWN.iter().find(|known| known.0 == *self) {
            Some((_, name, _, _)) => f.write_str(name),
            None => write!(f, "a quantity in {}", self.symbol()),
        }
    }
}
