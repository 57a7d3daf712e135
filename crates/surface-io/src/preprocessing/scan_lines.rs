//! Errors of scanning instruments: offsets between scan lines, scars, and noise across the lines. Scan lines
//! are rows.

use super::defects::GAUSSIAN;
use crate::keyword::keywords;
use contact_model::Cells;
use contact_model::units::five;

keywords! {
    /// How scan lines (rows, the fast axis along x) are shifted to a common height. The mean height of the map is
    /// kept.
    ///
    /// An instrument that scans line by line measures heights along a line within a second, and heights
    /// across the lines over minutes: drift and jumps of its sensor shift whole lines. After the alignment
    /// the map has no information on the mean slope and on long waves across the lines, whether they are due
    /// to the drift or to the surface.
    #[non_exhaustive]
    AlignLines: "align_lines";
    /// Each line is shifted so that the median of its height differences to the line before, over the columns
    /// where both are defined, is zero. A line without defined points is passed over; one that shares no
    /// defined column with the last line that has any keeps that line's shift.
    MedianDifference = "median_difference",
    /// Each line is shifted to the same median height. Where a line crosses much of a hill, the hill is
    /// lowered.
    Median = "median",
}

impl AlignLines {
    /// What is zero or equal afterwards.
    fn result(self) -> &'static str {
        match self {
            Self::MedianDifference => "the median of differences to the line before is zero",
            Self::Median => "all have the same median",
        }
    }

    /// Shifts the lines; a line for records. An error is the first shift that overflows. Cost O(N) for N
    /// points.
    pub(super) fn apply(self, cells: Cells, heights: &mut [f64], unit: &str) -> Result<String, f64> {
        let mut shifts = match self {
            Self::MedianDifference => shifts_by_differences(cells, heights),
            Self::Median => shifts_by_medians(cells, heights),
        };
        if let Some(shift) = shifts.iter().copied().find(|shift| !shift.is_finite()) {
            return Err(shift);
        }
        // The mean over all defined points is kept: shifts are counted from their mean, weighted by the
        // points of each line.
        let counts: Vec<f64> = heights
            .chunks_exact(cells.columns)
            .map(|line| line.iter().filter(|h| !h.is_nan()).count() as f64)
            .collect();
        let all = counts.iter().sum::<f64>().max(1.0);
        let mean = |shifts: &[f64]| shifts.iter().zip(&counts).map(|(s, n)| n / all * s).sum::<f64>();
        let offset = mean(&shifts);
        for shift in &mut shifts {
            *shift -= offset;
        }
        for (line, shift) in heights.chunks_exact_mut(cells.columns).zip(&shifts) {
            for h in line {
                *h -= shift;
            }
        }
        let rms = mean(&shifts.iter().map(|s| s * s).collect::<Vec<_>>()).sqrt();
        Ok(format!("scan lines shifted by {} rms: {}; mean height kept", five(rms, unit), self.result()))
    }
}

/// The shift of each line that makes its median difference to the line before zero, the first line's being 0.
fn shifts_by_differences(cells: Cells, heights: &[f64]) -> Vec<f64> {
    let mut shifts: Vec<f64> = Vec::with_capacity(cells.rows);
    // The last line that has defined points, and its shift.
    let mut last: Option<(&[f64], f64)> = None;
    for line in heights.chunks_exact(cells.columns) {
        let mut shift = last.map_or(0.0, |(_, shift)| shift);
        if let Some((before, _)) = last {
            let differences = line.iter().zip(before).map(|(h, before)| h - before);
            let mut differences: Vec<f64> = differences.filter(|d| !d.is_nan()).collect();
            if !differences.is_empty() {
                shift += central(&mut differences);
            }
        }
        shifts.push(shift);
        if line.iter().any(|h| !h.is_nan()) {
            last = Some((line, shift));
        }
    }
    shifts
}

/// The median of each line; 0 without defined points.
fn shifts_by_medians(cells: Cells, heights: &[f64]) -> Vec<f64> {
    let median_of = |line: &[f64]| {
        let mut defined: Vec<f64> = line.iter().copied().filter(|h| !h.is_nan()).collect();
        if defined.is_empty() { 0.0 } else { central(&mut defined) }
    };
    heights.chunks_exact(cells.columns).map(median_of).collect()
}

/// The median, of an even number of values the mean of the middle two; of at least one value. Shifts of lines
/// add up: the lower one of two would tilt a map.
fn central(values: &mut [f64]) -> f64 {
    let even = values.len().is_multiple_of(2);
    let middle = values.len() / 2;
    let (below, &mut upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    if even {
        let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        0.5 * lower + 0.5 * upper
    } else {
        upper
    }
}

/// Rows that a scar may be tall.
const TALLEST: usize = 4;

/// Points along a row that a scar has at least.
const SHORTEST: usize = 16;

/// Makes NaN of scars, the short bright or dark streaks along scan lines that an error of the feedback
/// leaves; a line for records.
///
/// A point belongs to a bright streak where it lies in one to [`TALLEST`] consecutive rows of its column that
/// are all higher than both the row before them and the row after them, by more than `times` the robust
/// standard deviation of the height differences between neighbouring rows (1.4826 times the median of their
/// distances from their median, which no tilt changes); a dark streak is as much lower. A scar is a run of
/// [`SHORTEST`] points or more of one kind in a row. Rows beyond the edges and undefined points are no
/// neighbours. A ridge of the surface that is as narrow and as long and lies along x cannot be distinguished
/// from a scar. Cost O(N) for N points.
pub(super) fn remove_scars(cells: Cells, times: f64, heights: &mut [f64], unit: &str) -> String {
    let Cells { columns, rows } = cells;
    let differences = heights.iter().zip(heights.iter().skip(columns)).map(|(a, b)| b - a);
    let deviation = robust_deviation(&mut differences.filter(|d| !d.is_nan()).collect::<Vec<_>>());
    let limit = times * deviation;
    let mut scars = vec![false; heights.len()];
    let mut runs = 0;
    for sign in [1.0, -1.0] {
        let mut streaks = vec![false; heights.len()];
        for before in 0..rows {
            for tall in 1..=TALLEST.min((rows - before).saturating_sub(2)) {
                for column in 0..columns {
                    let height = |row: usize| sign * heights[row * columns + column];
                    let (first, after) = (before + 1, before + 1 + tall);
                    // A comparison with an undefined point is false.
                    let above = |row: usize| {
                        height(row) - height(before) > limit && height(row) - height(after) > limit
                    };
                    if (first..after).all(above) {
                        (first..after).for_each(|row| streaks[row * columns + column] = true);
                    }
                }
            }
        }
        for (streaks, scars) in streaks.chunks_exact(columns).zip(scars.chunks_exact_mut(columns)) {
            let mut from = 0;
            for run in streaks.chunk_by(|a, b| a == b) {
                if run[0] && run.len() >= SHORTEST {
                    scars[from..from + run.len()].fill(true);
                    runs += 1;
                }
                from += run.len();
            }
        }
    }
    let removed = scars.iter().filter(|scar| **scar).count();
    for (h, _) in heights.iter_mut().zip(scars).filter(|(_, scar)| *scar) {
        *h = f64::NAN;
    }
    format!(
        "{removed} points of scars made undefined, in {runs} {} along x: beyond {times} times {}, the \
         robust standard deviation of differences between lines",
        if runs == 1 { "run" } else { "runs" },
        five(deviation, unit)
    )
}

/// 1.4826 times the median distance from the median, which is the standard deviation of Gaussian values; 0 of
/// none.
fn robust_deviation(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = central(values);
    for value in values.iter_mut() {
        *value = (*value - middle).abs();
    }
    GAUSSIAN * central(values)
}

/// The cut-off in cells from which on weights at the cells have the transmission of the Gaussian: 50.2 % at a
/// cut-off of four cells, 56 % at three, 89 % at two.
pub(super) const LEAST_CUT_OFF: f64 = 4.0;

/// The Gaussian low-pass filter of ISO 16610-21 along y: weights `exp(-pi (y/(alpha c))^2)` with
/// `alpha = sqrt(ln 2/pi)`, to a distance of the cut-off c, given in cells; the sum of the weights over the
/// defined points is one. A wave of wavelength w along y is transmitted by `2^(-(c/w)^2)`, half of it at the
/// cut-off; along x nothing changes.
///
/// Undefined points stay undefined. Cost O(N c) for N points.
pub(super) fn filter_across(cells: Cells, cut_off: f64, heights: &mut [f64]) {
    let Cells { columns, rows } = cells;
    // exp(-pi (y/(alpha c))^2) = 2^(-(pi y/(ln 2 c))^2).
    let scale = std::f64::consts::PI / (std::f64::consts::LN_2 * cut_off);
    let reach = (cut_off as usize).min(rows - 1);
    let weights: Vec<f64> = (0..=reach).map(|k| (-(scale * k as f64).powi(2)).exp2()).collect();
    // Half of one in sum, so that the sum over heights cannot overflow.
    let sum = 2.0 * (2.0 * weights.iter().sum::<f64>() - 1.0);
    let before = heights.to_vec();
    let (mut weighted, mut share) = (vec![0.0; columns], vec![0.0; columns]);
    for (row, line) in heights.chunks_exact_mut(columns).enumerate() {
        weighted.fill(0.0);
        share.fill(0.0);
        for other in row.saturating_sub(reach)..(row + reach + 1).min(rows) {
            let weight = weights[other.abs_diff(row)] / sum;
            for (column, &h) in before[other * columns..][..columns].iter().enumerate() {
                if !h.is_nan() {
                    weighted[column] += weight * h;
                    share[column] += weight;
                }
            }
        }
        for (column, h) in line.iter_mut().enumerate().filter(|(_, h)| !h.is_nan()) {
            *h = weighted[column] / share[column];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    /// Sums of a few hundred terms of size 1.
    const ROUNDING: f64 = 1e-12;

    /// Heights `f(column, row)`.
    fn heights(cells: Cells, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let place = |i: usize| ((i % cells.columns) as f64, (i / cells.columns) as f64);
        (0..cells.columns * cells.rows).map(place).map(|(x, y)| f(x, y)).collect()
    }

    fn mean(heights: &[f64]) -> f64 {
        let defined = || heights.iter().filter(|h| !h.is_nan());
        defined().sum::<f64>() / defined().count() as f64
    }

    /// A line of a map that is as high at a place as the line before has no other shift than its offset.
    #[test]
    fn offsets_of_lines_are_recovered() {
        let cells = Cells { columns: 40, rows: 30 };
        let offset = |y: f64| (y * y * 7.3).sin() + 0.2 * y;
        // Waves along x; hills that cover less than half of every line have no part in the median of
        // differences.
        let height = |x: f64, y: f64| {
            let hill = if (5.0..20.0).contains(&x) { 3.0 * (0.7 * y).sin() } else { 0.0 };
            (0.4 * x).sin() + hill
        };
        // Undefined: points, the whole of line 7, all but one point of line 12.
        let gone = |x: f64, y: f64| {
            (x * 3.0 + y) % 11.0 < 1.0
                || (y - 7.0).abs() < 0.5
                || ((y - 12.0).abs() < 0.5 && (x - 34.0).abs() > 0.5)
        };
        for holes in [false, true] {
            let clean = heights(cells, |x, y| if holes && gone(x, y) { f64::NAN } else { height(x, y) });
            let mut found: Vec<f64> =
                clean.iter().enumerate().map(|(i, h)| h + offset((i / cells.columns) as f64)).collect();
            let kept = mean(&found);
            AlignLines::MedianDifference.apply(cells, &mut found, "").unwrap();
            assert_abs_diff_eq!(mean(&found), kept, epsilon = ROUNDING);
            let constant = kept - mean(&clean);
            for (found, clean) in found.iter().zip(&clean) {
                assert_eq!(found.is_nan(), clean.is_nan());
                if !clean.is_nan() {
                    assert_abs_diff_eq!(*found, clean + constant, epsilon = ROUNDING);
                }
            }
        }
    }

    #[test]
    fn lines_without_a_common_column_keep_the_shift() {
        let cells = Cells { columns: 2, rows: 4 };
        let nan = f64::NAN;
        let mut found = [1.0, nan, 4.0, nan, nan, 9.0, nan, 10.0];
        AlignLines::MedianDifference.apply(cells, &mut found, "").unwrap();
        // Shifts 0, 3, 3, 4, of mean 2.5.
        let expected = [3.5, nan, 3.5, nan, nan, 8.5, nan, 8.5];
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.to_bits() == expected.to_bits(), "{found} {expected}");
        }
        for align in AlignLines::ALL {
            let mut one = [3.0, 5.0, nan, 1.0];
            assert!(align.apply(Cells { columns: 4, rows: 1 }, &mut one, "").is_ok());
            assert_eq!(one[..2], [3.0, 5.0]);
            let mut column = [3.0, 5.0, nan, 1.0];
            align.apply(Cells { columns: 1, rows: 4 }, &mut column, "").unwrap();
            assert!(column[2].is_nan() && [0, 1, 3].iter().all(|&i| (column[i] - 3.0).abs() < ROUNDING));
            let mut none = [nan; 4];
            assert!(align.apply(Cells { columns: 2, rows: 2 }, &mut none, "").is_ok());
            let mut huge = [1.5e308, 1.5e308, -1.5e308, -1.5e308];
            let refused = align.apply(Cells { columns: 2, rows: 2 }, &mut huge, "").is_err();
            assert_eq!(refused, align == AlignLines::MedianDifference);
        }
    }

    #[test]
    fn medians_of_lines_are_made_equal() {
        let cells = Cells { columns: 9, rows: 6 };
        let mut found = heights(cells, |x, y| x * x + 10.0 * y);
        let kept = mean(&found);
        let step = AlignLines::Median.apply(cells, &mut found, "").unwrap();
        assert_abs_diff_eq!(mean(&found), kept, epsilon = ROUNDING * kept);
        for line in found.chunks_exact(9) {
            assert_abs_diff_eq!(line[4], found[4], epsilon = ROUNDING * kept);
        }
        // Shifts of -25 to 25 in steps of 10.
        assert!(step.starts_with("scan lines shifted by 17.078 rms: all have the same median"), "{step}");
    }

    proptest! {
        /// The definition, and that a second alignment finds nothing.
        #[test]
        fn medians_of_differences_are_zero(values in any::<[i16; 60]>(), columns in 1..7_usize) {
            let cells = Cells { columns, rows: 60 / columns };
            let mut found: Vec<f64> = values.iter().map(|&v| f64::from(v)).take(columns * cells.rows).collect();
            AlignLines::MedianDifference.apply(cells, &mut found, "").unwrap();
            for pair in found.chunks_exact(columns).collect::<Vec<_>>().windows(2) {
                let mut differences: Vec<f64> = pair[1].iter().zip(pair[0]).map(|(b, a)| b - a).collect();
                differences.sort_by(f64::total_cmp);
                let middle = 0.5 * (differences[(columns - 1) / 2] + differences[columns / 2]);
                prop_assert!(middle.abs() < 1e-8, "{middle}");
            }
        }

        #[test]
        fn a_filtered_height_lies_in_the_range(values in any::<[i16; 60]>(), holes in any::<[bool; 60]>(), cut_off in 4.0..12.0) {
            let cells = Cells { columns: 5, rows: 12 };
            let mut found: Vec<f64> =
                values.iter().zip(holes).map(|(&v, hole)| if hole { f64::NAN } else { 5e303 * f64::from(v) }).collect();
            let before = found.clone();
            filter_across(cells, cut_off, &mut found);
            for (i, (found, before)) in found.iter().zip(&before).enumerate() {
                prop_assert_eq!(found.is_nan(), before.is_nan());
                let column = range_of_column(&values, i);
                prop_assert!(found.is_nan() || column.contains(found), "{:?} {}", column, found);
            }
        }
    }

    /// The range of a column of five, with rounding.
    fn range_of_column(values: &[i16; 60], i: usize) -> std::ops::RangeInclusive<f64> {
        let column = values.iter().skip(i % 5).step_by(5).map(|&v| 5e303 * f64::from(v));
        let (low, high) = column.fold((f64::MAX, f64::MIN), |(low, high), h| (low.min(h), high.max(h)));
        low - 1e296..=high + 1e296
    }

    /// Gentle heights with noise of rms 0.01, `noise` of which depends on x and y.
    fn rough(x: f64, y: f64) -> f64 {
        let noise = ((x * 12.9898 + y * 78.233).sin() * 43758.547).fract();
        (x / 15.0).sin() + (y / 12.0).cos() + 0.02 * noise
    }

    #[test]
    fn scars_go_and_ridges_stay() {
        let cells = Cells { columns: 64, rows: 64 };
        // Bright, one row tall; dark, three rows; one that ends beside an undefined point.
        let scar = |x: f64, y: f64| match (x as usize, y as usize) {
            (10..=40, 8) | (0..=15, 30) => 1.0,
            (30..=63, 20..=22) => -1.0,
            _ => 0.0,
        };
        // A ridge along x of five rows, one of one row but 15 points, one across the lines, one of 45
        // degrees.
        let ridge = |x: f64, y: f64| match (x as usize, y as usize) {
            (.., 50..=54) | (5..=19, 40) | (50..=52, 24..=48) => 1.0,
            (x, y @ 24..=48) if (x + 20).abs_diff(y + 40) < 2 && x < 45 => 1.0,
            _ => 0.0,
        };
        let mut found = heights(cells, |x, y| rough(x, y) + scar(x, y) + ridge(x, y));
        found[30 * 64 + 16] = f64::NAN;
        let before = found.clone();
        let step = remove_scars(cells, 8.0, &mut found, "");
        for (i, (found, before)) in found.iter().zip(&before).enumerate() {
            let (x, y) = ((i % 64) as f64, (i / 64) as f64);
            let gone = scar(x, y).abs() > 0.0 || before.is_nan();
            assert_eq!(found.is_nan(), gone, "{x} {y}");
        }
        let expected = "149 points of scars made undefined, in 5 runs along x: beyond 8 times ";
        assert!(step.starts_with(expected), "{step}");
        // The same of a tilted map, with the sign of the heights or the order of the rows reversed.
        let mut tilted: Vec<f64> =
            before.iter().enumerate().map(|(i, h)| h + 0.01 * (i / 64) as f64).collect();
        assert_eq!(remove_scars(cells, 8.0, &mut tilted, "")[..expected.len()], step[..expected.len()]);
        let mut negative: Vec<f64> = before.iter().map(|h| -h).collect();
        assert_eq!(remove_scars(cells, 8.0, &mut negative, ""), step);
        let mut reversed: Vec<f64> = before.chunks_exact(64).rev().flatten().copied().collect();
        assert_eq!(remove_scars(cells, 8.0, &mut reversed, ""), step);
    }

    #[test]
    fn scars_need_a_row_on_both_sides() {
        for rows in 1..4 {
            let cells = Cells { columns: 20, rows };
            let mut found = heights(cells, |_, y| if y < 1.0 { 1.0 } else { 0.0 });
            let step = remove_scars(cells, 2.0, &mut found, "");
            assert!(step.starts_with("0 points of scars") && found.iter().all(|h| !h.is_nan()), "{step}");
        }
        let cells = Cells { columns: 16, rows: 3 };
        let mut flat = heights(cells, |_, y| if (y - 1.0).abs() < 0.5 { 1.0 } else { 0.0 });
        // A tilt across the lines is no deviation of their differences.
        assert!(remove_scars(cells, 0.6, &mut flat, "").starts_with("16 points"));
        assert!(flat[16..32].iter().all(|h| h.is_nan()));
        assert!(remove_scars(cells, 0.6, &mut [f64::NAN; 48], "").starts_with("0 points"));
    }

    #[test]
    fn the_cut_off_has_half_of_the_transmission() {
        let cells = Cells { columns: 12, rows: 4000 };
        // Far from the edges, the amplitude of a cosine of this wavelength across the lines.
        let transmission = |cut_off: f64, wavelength: f64| {
            let mut found = heights(cells, |_, y| (TAU * (y - 2000.0) / wavelength).cos());
            filter_across(cells, cut_off, &mut found);
            found[2000 * cells.columns]
        };
        for cut_off in [5.0, 8.7, 20.0, 333.0] {
            for ratio in [0.6_f64, 1.0, 1.7, 4.0] {
                let expected = 0.5_f64.powf(ratio.powi(-2));
                // Truncated weights: 1e-7. Sampled weights: images at the sampling frequency, below five
                // cells 1e-3.
                let tolerance = if cut_off < 6.0 { 4e-2 } else { 1e-6 };
                let wavelength = ratio * cut_off;
                assert_abs_diff_eq!(transmission(cut_off, wavelength), expected, epsilon = tolerance);
            }
        }
        assert_abs_diff_eq!(transmission(LEAST_CUT_OFF, LEAST_CUT_OFF), 0.502, epsilon = 5e-4);
        assert_abs_diff_eq!(transmission(3.0, 3.0), 0.56, epsilon = 5e-3);
        assert_abs_diff_eq!(transmission(2.0, 2.0), 0.89, epsilon = 5e-3);
        // Along x nothing changes, at the edges neither.
        let cells = Cells { columns: 50, rows: 20 };
        let before = heights(cells, |x, _| (1.3 * x).cos());
        let mut found = before.clone();
        filter_across(cells, 6.0, &mut found);
        for (found, before) in found.iter().zip(&before) {
            assert_abs_diff_eq!(*found, *before, epsilon = ROUNDING);
        }
    }

    /// Against the sum as it is written, over defined points only.
    #[test]
    fn weights_of_defined_points_have_the_sum_one() {
        let cells = Cells { columns: 7, rows: 11 };
        let gone = |x: f64, y: f64| (x * 5.0 + y * 3.0) % 7.0 < 2.0;
        let before = heights(cells, |x, y| if gone(x, y) { f64::NAN } else { rough(x, 3.0 * y) });
        let mut found = before.clone();
        let cut_off = 4.6;
        filter_across(cells, cut_off, &mut found);
        let alpha = (std::f64::consts::LN_2 / std::f64::consts::PI).sqrt();
        for (i, h) in found.iter().enumerate() {
            let (mut sum, mut weights) = (0.0, 0.0);
            for row in 0..cells.rows {
                let distance = row as f64 - (i / cells.columns) as f64;
                let other = before[row * cells.columns + i % cells.columns];
                if distance.abs() <= cut_off && !other.is_nan() {
                    let weight = (-std::f64::consts::PI * (distance / (alpha * cut_off)).powi(2)).exp();
                    (sum, weights) = (sum + weight * other, weights + weight);
                }
            }
            assert_eq!(h.is_nan(), before[i].is_nan());
            if !h.is_nan() {
                assert_relative_eq!(*h, sum / weights, max_relative = 1e-12, epsilon = ROUNDING);
            }
        }
        // One row is its own mean.
        let mut row = [1.0, f64::NAN, 3.0];
        filter_across(Cells { columns: 3, rows: 1 }, 5.0, &mut row);
        assert!(
            row[0].to_bits() == 1.0_f64.to_bits() && row[1].is_nan() && row[2].to_bits() == 3.0_f64.to_bits()
        );
    }
}
