//! Lists of loads, as written on the command line.

use crate::evaluation::limits::{MOST_LOADS, require};
use runs::{Error, Result};
use std::collections::HashSet;

/// Loads F_bar, increasing, and how they were written.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces {
    spec: String,
    values: Vec<f64>,
    /// The same in the order of the text.
    asked: Vec<f64>,
}

const EXPECTED: &str = "positive numbers and logarithmic ranges MIN:MAX:COUNT, separated by commas \
                        (1e-2,1,20 or 1e-6:20:23)";

impl Forces {
    /// Reads a list such as `1e-2,1,20`, a range `MIN:MAX:COUNT` (logarithmic, with both ends exactly
    /// included), or several of both.
    ///
    /// The result is sorted; a force named twice counts once.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the entry that is not a positive finite number or a sensible range.
    ///
    /// ```
    /// let f = paper::evaluation::Forces::parse("1:100:3,0.086")?;
    /// assert_eq!(f.values(), [0.086, 1.0, 10.0, 100.0]);
    /// assert!(paper::evaluation::Forces::parse("-1").is_err());
    /// # Ok::<(), paper::evaluation::Error>(())
    /// ```
    pub fn parse(spec: &str) -> Result<Self> {
        let mut values = Vec::new();
        for item in spec.split(',').map(str::trim) {
            let parts: Vec<&str> = item.split(':').collect();
            match parts[..] {
                [value] => values.push(positive(value)?),
                [min, max, count] => values.extend(range(item, positive(min)?, positive(max)?, count)?),
                _ => return Err(Error::parameter("forces", item, EXPECTED)),
            }
            let expected = format!("at most {MOST_LOADS} loads in all, there are {}", values.len());
            require(values.len() <= MOST_LOADS, "forces", item, expected)?;
        }
        let mut seen = HashSet::new();
        let asked: Vec<f64> = values.into_iter().filter(|v| seen.insert(v.to_bits())).collect();
        let mut values = asked.clone();
        values.sort_by(f64::total_cmp);
        Ok(Self { spec: spec.split_whitespace().collect(), values, asked })
    }

    /// The loads, increasing.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The loads in the order in which they were written.
    pub fn asked(&self) -> &[f64] {
        &self.asked
    }

    /// How they were written (without blanks).
    pub fn spec(&self) -> &str {
        &self.spec
    }
}

fn positive(text: &str) -> Result<f64> {
    let value = text.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
    value.ok_or_else(|| Error::parameter("forces", text, EXPECTED))
}

fn range(item: &str, min: f64, max: f64, count: &str) -> Result<Vec<f64>> {
    let count: usize = count.trim().parse().map_err(|_| Error::parameter("forces", item, EXPECTED))?;
    let expected = format!("MIN < MAX and a COUNT of 2 to {MOST_LOADS} in MIN:MAX:COUNT");
    require(min < max && (2..=MOST_LOADS).contains(&count), "forces", item, expected)?;
    let (low, high) = (min.log10(), max.log10());
    let step = |i: usize| 10f64.powf(low + (high - low) * i as f64 / (count - 1) as f64);
    let mut values: Vec<f64> = (0..count).map(step).collect();
    // Both ends exactly as asked, free of the rounding of the logarithm.
    values[0] = min;
    values[count - 1] = max;
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn ranges_are_logarithmic_and_exact_at_both_ends() {
        let f = Forces::parse("1e-6:20:23, 0.086 ,1").unwrap();
        assert_eq!((f.values()[0], *f.values().last().unwrap(), f.values().len()), (1e-6, 20.0, 25));
        assert_eq!(f.spec(), "1e-6:20:23,0.086,1");
        assert_eq!(Forces::parse("20,1,0.1:1:2").unwrap().asked(), [20.0, 1.0, 0.1]);
        assert_relative_eq!(f.values()[1] / f.values()[0], 2e7_f64.powf(1.0 / 22.0), max_relative = 1e-12);
        assert_eq!(Forces::parse("1,1,1").unwrap().values(), [1.0]);
    }

    #[test]
    fn bad_lists_name_the_entry() {
        for bad in
            ["", "a", "-1", "0", "nan", "inf", "1:2", "2:1:5", "1:1:5", "1:2:1", "1:2:x", "1:2:3:4", "1,,2"]
        {
            let error = Forces::parse(bad).unwrap_err().to_string();
            assert!(error.starts_with("forces = ") && error.contains("expected"), "{bad}: {error}");
        }
        assert!(Forces::parse("1:2:99999999999").is_err());
        let many = ["1:2:9999"; 3].join(",");
        assert!(Forces::parse(&many).unwrap_err().to_string().contains("at most 10000 loads in all"));
    }
}
