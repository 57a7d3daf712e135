//! The symbols of units.

use super::dimension::Dimension;

/// One symbol: its dimension, its power of ten and a factor that is no power of ten.
pub(super) struct UnitSymbol {
    pub(super) text: &'static str,
    pub(super) dimension: Dimension,
    pub(super) exponent: i32,
    pub(super) factor: f64,
    pub(super) prefixed: Prefixed,
}

/// Whether SI prefixes go before it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Prefixed {
    Yes,
    No,
}

const fn symbol(text: &'static str, powers: [i8; 5], exponent: i32) -> UnitSymbol {
    UnitSymbol { text, dimension: Dimension::of(powers), exponent, factor: 1.0, prefixed: Prefixed::Yes }
}

const fn other(text: &'static str, powers: [i8; 5], exponent: i32, factor: f64) -> UnitSymbol {
    UnitSymbol { text, dimension: Dimension::of(powers), exponent, factor, prefixed: Prefixed::No }
}

/// Prefixes and their powers of ten; hecto and deca are left out (h is the hour).
pub(super) const PREFIXES: [(&str, i32); 12] = [
    ("", 0),
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// No prefixed symbol equals another symbol (a test looks).
pub(super) const SYMBOLS: [UnitSymbol; 22] = [
    symbol("m", [1, 0, 0, 0, 0], 0),
    symbol("g", [0, 1, 0, 0, 0], -3),
    symbol("s", [0, 0, 1, 0, 0], 0),
    symbol("A", [0, 0, 0, 1, 0], 0),
    symbol("K", [0, 0, 0, 0, 1], 0),
    symbol("N", [1, 1, -2, 0, 0], 0),
    symbol("Pa", [-1, 1, -2, 0, 0], 0),
    symbol("J", [2, 1, -2, 0, 0], 0),
    symbol("W", [2, 1, -3, 0, 0], 0),
    symbol("V", [2, 1, -3, -1, 0], 0),
    symbol("Ohm", [2, 1, -3, -2, 0], 0),
    symbol("Hz", [0, 0, -1, 0, 0], 0),
    symbol("bar", [-1, 1, -2, 0, 0], 5),
    other("angstrom", [1, 0, 0, 0, 0], -10, 1.0),
    other("micron", [1, 0, 0, 0, 0], -6, 1.0),
    // 25.4 mm, 9.80665 m/s^2 and 0.45359237 kg by definition.
    other("inch", [1, 0, 0, 0, 0], -4, 254.0),
    other("mil", [1, 0, 0, 0, 0], -7, 254.0),
    other("psi", [-1, 1, -2, 0, 0], 0, 0.453_592_37 * 9.806_65 / (0.0254 * 0.0254)),
    other("kgf", [1, 1, -2, 0, 0], 0, 9.806_65),
    other("min", [0, 0, 1, 0, 0], 0, 60.0),
    other("h", [0, 0, 1, 0, 0], 0, 3600.0),
    other("%", [0, 0, 0, 0, 0], -2, 1.0),
];

/// The symbol and the power of ten of its prefix.
pub(super) fn find(text: &str) -> Option<(&'static UnitSymbol, i32)> {
    all()
        .find(|(_, prefix, symbol)| text.strip_prefix(*prefix).is_some_and(|rest| rest == symbol.text))
        .map(|(power, _, symbol)| (symbol, power))
}

/// Symbols that differ from the text in upper and lower case only.
pub(super) fn alike(text: &str) -> Vec<String> {
    all()
        .map(|(_, prefix, symbol)| format!("{prefix}{}", symbol.text))
        .filter(|known| known.eq_ignore_ascii_case(text))
        .collect()
}

pub(super) fn all() -> impl Iterator<Item = (i32, &'static str, &'static UnitSymbol)> {
    SYMBOLS.iter().flat_map(|symbol| {
        let allowed = move |(prefix, _): &&(&str, i32)| prefix.is_empty() || symbol.prefixed == Prefixed::Yes;
        PREFIXES.iter().filter(allowed).map(move |&(prefix, power)| (power, prefix, symbol))
    })
}
