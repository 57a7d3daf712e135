//! Times and memory as people read and write them.

/// A predicted time: `45 s`, `12 min`, `3.5 h`.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < LONG => format!("{s:.0} s"),
        s if s < 60.0 * LONG => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A time that may be short: `under 1 ms`, `500 ms`, `45.2 s`, then as [`duration`].
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => "under 1 ms".into(),
        s if s < 1.0 => format!("{:.0} ms", 1e3 * s),
        s if s < LONG => format!("{s:.1} s"),
        s => duration(s),
    }
}

/// Number of seconds from which on a time is in minutes, and number of minutes from which on it is in hours.
const LONG: f64 = 120.0;

/// `12 bytes`, `45 kB`, `12 MB`, `3.5 GB`.
pub fn memory(bytes: f64) -> String {
    match bytes {
        b if b < 1e3 => format!("{b:.0} bytes"),
        b if b < 1e6 => format!("{:.0} kB", b / 1e3),
        b if b < 1e9 => format!("{:.0} MB", b / 1e6),
        b => format!("{:.1} GB", b / 1e9),
    }
}

/// Reads a time such as `90s`, `10min` or `2h` in seconds; a number without a unit is seconds. It has the
/// form of a parser of arguments.
///
/// # Errors
/// What was expected, for anything else and for a time that is not positive or beyond ten years.
///
/// ```
/// assert_eq!(["90s", "10min", "2h", "7"].map(|text| runs::amounts::seconds(text).unwrap()), [90.0, 600.0, 7200.0, 7.0]);
/// assert!(runs::amounts::seconds("0s").is_err());
/// ```
pub fn seconds(text: &str) -> Result<f64, String> {
    /// Ten years.
    const LONGEST: f64 = 3.2e8;
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    let (digits, unit) = (units.iter())
        .find_map(|(name, unit)| Some((text.strip_suffix(name)?, *unit)))
        .unwrap_or((text, 1.0));
    let value = unit * digits.trim().parse::<f64>().map_err(|e| e.to_string())?;
    if value > 0.0 && value <= LONGEST {
        Ok(value)
    } else {
        Err("expected a time such as 90s, 10min or 2h, at most ten years".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_short() {
        assert_eq!([30.0, 600.0, 9000.0].map(duration), ["30 s", "10 min", "2.5 h"]);
        assert_eq!(
            [0.0, 0.5, 60.0, 600.0, 36000.0].map(time),
            ["under 1 ms", "500 ms", "60.0 s", "10 min", "10.0 h"]
        );
        assert_eq!([12.0, 5e4, 3e6, 4.2e9].map(memory), ["12 bytes", "50 kB", "3 MB", "4.2 GB"]);
    }
}
