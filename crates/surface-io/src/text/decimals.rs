//! Commas that are decimal signs and separators at once.

use super::comment::without_comment;
use crate::options::Decimal;

/// Fewest pairs of fields, and fewest lines of data, from which a text is told by its own marks.
const MARKED: [usize; 2] = [4, 2];

/// Fewest pairs of fields, and fewest lines of data, from which equal lengths alone are a suspicion.
const SUSPECTED: [usize; 2] = [16, 3];

/// What the fields between the commas of a text may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CommaPairs {
    /// Numbers.
    Numbers,
    /// Perhaps whole numbers and their decimals in turn: those in even places have no sign and equally many
    /// digits. Heights in a narrow range may have this too.
    Suspected,
    /// Whole numbers and their decimals in turn: some in even places begin with 0 (`05`), or some in odd
    /// places are `-0`, which no program writes for a whole number.
    Certain,
}

/// Whether the commas of a text separate numbers, or are their decimal signs too, as a spreadsheet with decimal
/// commas writes CSV. Every line then has equally many fields, an even number: `0,10,6,68` for 0.10 and 6.68.
///
/// The first field that contradicts this ends the search, which in most texts is in the first line.
pub(super) fn comma_pairs(bytes: &[u8], end: u8, skip: usize) -> CommaPairs {
    let mut found = FieldPairs::default();
    for line in bytes.split(|&b| b == end).skip(skip) {
        let data = without_comment(line).0.trim_ascii();
        if data.is_empty() || Decimal::Point.is_header(data) {
            continue;
        }
        if !found.take(data.strip_suffix(b",").unwrap_or(data)) {
            return CommaPairs::Numbers;
        }
    }
    found.judged()
}

/// Pairs of fields so far, all of which may be whole numbers and decimals.
#[derive(Default)]
struct FieldPairs {
    lines: usize,
    /// Pairs of all lines, and those of one line.
    pairs: usize,
    of_line: usize,
    /// Digits of every field in an even place.
    decimals: usize,
    /// Fields that only decimals, or only the whole part of a number with decimals, are written as.
    marks: usize,
    /// Whether a field in an odd place has a sign, or another number of digits than those in even places.
    differ: bool,
}

impl FieldPairs {
    /// Takes a line; `false` where it contradicts.
    fn take(&mut self, data: &[u8]) -> bool {
        let mut fields = data.split(|&b| b == b',').map(bare);
        let mut pairs = 0;
        while let Some(whole) = fields.next() {
            let Some(decimals) = fields.next() else { return false };
            let digits = whole.strip_prefix(b"-").or_else(|| whole.strip_prefix(b"+")).unwrap_or(whole);
            if !is_digits(digits) || !is_digits(decimals) || (digits.len() > 1 && digits[0] == b'0') {
                return false;
            }
            if self.decimals == 0 {
                self.decimals = decimals.len();
            } else if self.decimals != decimals.len() {
                return false;
            }
            self.marks +=
                usize::from(whole == b"-0") + usize::from(decimals.len() > 1 && decimals[0] == b'0');
            self.differ |= whole.len() != decimals.len();
            pairs += 1;
        }
        if self.lines > 0 && self.of_line != pairs {
            return false;
        }
        self.of_line = pairs;
        self.pairs += pairs;
        self.lines += 1;
        true
    }

    fn judged(&self) -> CommaPairs {
        let at_least = |[pairs, lines]: [usize; 2]| self.pairs >= pairs && self.lines >= lines;
        if self.marks > 0 && at_least(MARKED) {
            CommaPairs::Certain
        } else if self.of_line > 1 && self.differ && at_least(SUSPECTED) {
            CommaPairs::Suspected
        } else {
            CommaPairs::Numbers
        }
    }
}

fn is_digits(field: &[u8]) -> bool {
    !field.is_empty() && field.iter().all(u8::is_ascii_digit)
}

/// A field without the quotes that stand around it, or around the number that it is a part of.
fn bare(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    let field = field.strip_prefix(b"\"").unwrap_or(field);
    field.strip_suffix(b"\"").unwrap_or(field).trim_ascii()
}
