//! Numbers as bytes: types and byte orders.

use std::fmt;

/// Which byte of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    /// The lowest byte.
    Little,
    /// The highest byte.
    Big,
}

/// Type and byte order of a number in a binary file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NumberType {
    kind: NumberTypeKind,
    size: u8,
    little: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NumberTypeKind {
    Float,
    Signed,
    Unsigned,
}

/// Doubles hold every integer up to this size.
const EXACT: i128 = 1 << 53;

impl NumberType {
    pub(crate) const U8: Self = Self { kind: NumberTypeKind::Unsigned, size: 1, little: true };
    pub(crate) const U16: Self = Self { size: 2, ..Self::U8 };
    pub(crate) const I16: Self = Self { kind: NumberTypeKind::Signed, ..Self::U16 };
    pub(crate) const I32: Self = Self { size: 4, ..Self::I16 };
    pub(crate) const F32: Self = Self { kind: NumberTypeKind::Float, ..Self::I32 };
    pub(crate) const F64: Self = Self { size: 8, ..Self::F32 };

    /// By its code in a format, its place in a list of types as numpy calls them: `i2`, `f8`, empty for what
    /// is not read.
    pub(crate) fn of_code(code: u64, types: &[&str], order: ByteOrder) -> Option<Self> {
        let [letter, size] = *types.get(usize::try_from(code).ok()?)?.as_bytes() else { return None };
        Self::new(letter, size - b'0', order == ByteOrder::Little)
    }

    /// By the letter of numpy (`f`, `i`, `u`) and the number of bytes; `None` for what is not read.
    pub(crate) fn new(letter: u8, size: u8, little: bool) -> Option<Self> {
        let (kind, sizes): (NumberTypeKind, &[u8]) = match letter {
            b'f' => (NumberTypeKind::Float, &[2, 4, 8]),
            b'i' => (NumberTypeKind::Signed, &[1, 2, 4, 8]),
            b'u' => (NumberTypeKind::Unsigned, &[1, 2, 4, 8]),
            _ => return None,
        };
        sizes.contains(&size).then_some(Self { kind, size, little })
    }

    /// The same number with its first byte the highest.
    pub(crate) const fn big_endian(self) -> Self {
        Self { little: false, ..self }
    }

    /// The integer of as many bytes with a sign or without.
    pub(crate) fn with_sign(self, signed: bool) -> Self {
        Self { kind: if signed { NumberTypeKind::Signed } else { NumberTypeKind::Unsigned }, ..self }
    }

    /// The integer of this type with the bytes of one of the other sign, such as 65535 for -1.
    pub(crate) fn wrapped(self, number: f64) -> f64 {
        match self.kind {
            NumberTypeKind::Unsigned if number < 0.0 => number + self.values(),
            NumberTypeKind::Signed if number >= 0.5 * self.values() => number - self.values(),
            _ => number,
        }
    }

    /// Whether it is a float, which NaN is one of.
    pub(crate) fn is_float(self) -> bool {
        self.kind == NumberTypeKind::Float
    }

    /// Whether it is an integer with a sign.
    pub(crate) fn is_signed(self) -> bool {
        self.kind == NumberTypeKind::Signed
    }

    /// Type and bits, such as float32.
    pub(crate) fn name(self) -> String {
        let name = match self.kind {
            NumberTypeKind::Float => "float",
            NumberTypeKind::Signed => "int",
            NumberTypeKind::Unsigned => "uint",
        };
        format!("{name}{}", 8 * self.size)
    }

    /// How many values a number of this size has.
    pub(crate) fn values(self) -> f64 {
        256_f64.powi(self.size.into())
    }

    /// Whether two numbers are one where this type holds them: a header prints more or fewer digits than a
    /// number has, and a double beside float32 has more of them. What is beyond the range of the type is none
    /// of its numbers.
    pub(crate) fn same(self, a: f64, b: f64) -> bool {
        let one = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a - b).abs() <= 0.0;
        let [x, y] = [a, b].map(|number| self.nearest(number));
        one(a, b) || (x.is_finite() && one(x, y))
    }

    /// The nearest float of this type; integers stay as they are.
    fn nearest(self, number: f64) -> f64 {
        match (self.kind, self.size) {
            (NumberTypeKind::Float, 2) => {
                // Ten bits behind the first one, down to 2^-24.
                let digit = 2_f64.powi((number.abs().log2().floor().clamp(-14.0, 15.0) as i32) - 10);
                let nearest = (number / digit).round_ties_even() * digit;
                if nearest.abs() > 65504.0 { f64::INFINITY.copysign(number) } else { nearest }
            }
            (NumberTypeKind::Float, 4) => f64::from(number as f32),
            _ => number,
        }
    }

    /// Bytes of one number.
    pub(crate) fn bytes(self) -> usize {
        usize::from(self.size)
    }

    /// Bytes of a map of this shape; `None` beyond 2^64.
    pub(crate) fn bytes_of<N: TryInto<u64>>(self, shape: [N; 2]) -> Option<u64> {
        let [rows, columns] = shape.map(|count| count.try_into().ok());
        rows?.checked_mul(columns?)?.checked_mul(self.bytes() as u64)
    }

    /// The number in the first of these bytes, or the integer that no double holds.
    pub(crate) fn decode(self, raw: &[u8]) -> Result<f64, i128> {
        let raw = &raw[..self.bytes()];
        let mut word = [0; 8];
        for (i, byte) in raw.iter().enumerate() {
            word[if self.little { i } else { raw.len() - 1 - i }] = *byte;
        }
        let bits = u64::from_le_bytes(word);
        match self.kind {
            NumberTypeKind::Float => Ok(match raw.len() {
                2 => half(bits as u16),
                4 => f64::from(f32::from_bits(bits as u32)),
                _ => f64::from_bits(bits),
            }),
            NumberTypeKind::Unsigned => exact(i128::from(bits)),
            NumberTypeKind::Signed => {
                let unused = 64 - 8 * raw.len() as u32;
                exact(i128::from((bits << unused).cast_signed() >> unused))
            }
        }
    }
}

impl fmt::Display for NumberType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}-endian", self.name(), if self.little { "little" } else { "big" })
    }
}

/// The integer as a double, or the integer that no double holds.
pub(crate) fn exact(value: i128) -> Result<f64, i128> {
    if value.abs() <= EXACT || (value as f64) as i128 == value { Ok(value as f64) } else { Err(value) }
}

/// IEEE 754 binary16.
pub(crate) fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from((bits >> 10) & 31), f64::from(bits & 1023));
    let size = match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 if fraction <= 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}
