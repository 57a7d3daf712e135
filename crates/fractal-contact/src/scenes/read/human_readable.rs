//! Numbers as people read them.

/// Digits without a row of zeros.
pub(crate) fn number(value: f64) -> String {
    // What units leave behind the 14th digit is rounding.
    let value = format!("{value:.13e}").parse().unwrap_or(value);
    let size = value.abs();
    if size > 0.0 && !(1e-3..1e6).contains(&size) { format!("{value:e}") } else { value.to_string() }
}

/// Four digits.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 || (1e-2..1e5).contains(&value.abs()) {
        let digits = if value == 0.0 { 0 } else { (3 - value.abs().log10().floor() as i32).max(0) as usize };
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [
                number(1e300),
                number(2e-7),
                number(0.25),
                number(0.0),
                number(-3e9),
                number(3.199_999_999_999_999_7e-4)
            ],
            ["1e300", "2e-7", "0.25", "0", "-3e9", "3.2e-4"]
        );
    }
}
