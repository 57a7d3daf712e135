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

/// A time in words.
pub(crate) fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => "under 1 ms".into(),
        s if s < 1.0 => format!("{:.0} ms", 1e3 * s),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A number of bytes in words.
pub(crate) fn memory(bytes: f64) -> String {
    match bytes {
        b if b < 1e3 => format!("{b:.0} bytes"),
        b if b < 1e6 => format!("{:.0} kB", b / 1e3),
        b if b < 1e9 => format!("{:.0} MB", b / 1e6),
        b => format!("{:.1} GB", b / 1e9),
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
        assert_eq!(
            [time(0.0), time(0.5), time(60.0), time(600.0), time(36000.0)],
            ["under 1 ms", "500 ms", "60.0 s", "10 min", "10.0 h"]
        );
        assert_eq!(
            [memory(12.0), memory(5e4), memory(3e6), memory(4.2e9)],
            ["12 bytes", "50 kB", "3 MB", "4.2 GB"]
        );
    }
}
