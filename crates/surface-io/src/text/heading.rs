//! Statements in headers: `# Width: 10 um` of Gwyddion and this crate, `x-length = 5000` of SPIP, `\Scan
//! Size: 10 um` of Nanoscope, `Pixel size = 0.1 um` of profilers, in comments or in lines before the numbers.
//!
//! The words are those of the readers in <https://github.com/ContactEngineering/SurfaceTopography>
//! (`IO/Text.py`) and Gwyddion (`spip-asc.c`), and their usual variants. A length counts where it has a unit;
//! a number of pixels has none and is compared with the lines.

use super::columns::{TextColumn, names_axes};
use super::statement::{HeadingStatement, Side, key_and_value, lengths};
use crate::channel::StoredUnit;
use crate::error::ContentError;
use crate::extent::{Extent, agree};
use crate::fields::decoded;
use crate::format::Format;
use crate::quantity::{Dimension, Quantity, QuantityError, Unit};

/// The statements that count; everything else is a comment.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Heading {
    /// Lengths of a row and a column, Lx and Ly.
    sides: [Option<Side>; 2],
    /// The same without a unit, in that of x and y, which may be said later.
    plain: [Option<Side>; 2],
    /// Sides of one cell.
    cells: [Option<Side>; 2],
    /// One length for a square map.
    square: Option<Side>,
    /// Numbers of columns and rows.
    counts: [Option<u64>; 2],
    /// Unit of the heights.
    pub(crate) unit: Option<Unit>,
    /// Unit of x and y.
    pub(crate) lateral_unit: Option<Unit>,
    /// Height of one unit of a number, in `unit`.
    pub(crate) scale: Option<f64>,
    /// Nanometres of one count, where the unit of the heights is not said.
    bit_to_nm: Option<f64>,
    /// A unit of the values that is none of heights.
    other_unit: Option<OtherUnit>,
    /// The file of SPIP says lengths in nanometres without saying so.
    spip: bool,
    /// Whether it is that of an ESRI grid, whose lengths are numbers.
    grid: bool,
    /// Name of the channel.
    pub(crate) name: Option<String>,
    /// A number that stands for an undefined point.
    pub(super) missing: Option<f64>,
    /// Lines that speak of units or sizes in words that are not known, the first few.
    unused: Vec<String>,
    /// Lines about sides, cells and numbers of pixels, the first few.
    sizes: Vec<String>,
    /// Lines that may name the columns, the last few.
    pub(super) lines: Vec<String>,
    /// The columns as such a line names them; empty for none.
    pub(crate) columns: Vec<TextColumn>,
}

/// A unit that is none of heights.
#[derive(Debug, Clone, PartialEq)]
struct OtherUnit {
    /// As written.
    written: String,
    /// Whether a factor may still convert the numbers to heights.
    convertible: bool,
    /// What is wrong with it.
    problem: ContentError,
}

/// What a header says of each axis: the length of the map, and that of a cell.
type SidesAndCells = ([Option<Side>; 2], [Option<Extent>; 2]);

/// Words of units and sizes.
const ABOUT: [&str; 8] = ["unit", "size", "pixel", "scale", "length", "resolution", "spacing", "calibration"];

/// Longest line that is looked at for statements, in bytes.
const LONGEST: usize = 200;

/// Lines that are kept until the number of columns is known.
const LINES: usize = 8;

/// Most lines that are noted.
const NOTED: usize = 8;

impl Heading {
    /// Takes what a line of a header says; another statement of the same kind is an error.
    ///
    /// Width and height are words of everyday and count where they are lengths; units count or are an error.
    pub(super) fn read(&mut self, line: &[u8], number: usize) -> Result<(), ContentError> {
        let text = decoded(line);
        let names = names_axes(&text);
        if self.lines.len() == LINES {
            self.lines.remove(0);
        }
        self.lines.push(text.trim_end().to_owned());
        if names || line.len() > LONGEST {
            return Ok(());
        }
        self.spip |= text.trim() == "File Format = ASCII";
        let several: Vec<&str> = text.split_whitespace().collect();
        if several.len() > 1
            && several.iter().all(|part| part.split_once('=').is_some_and(|(_, v)| !v.is_empty()))
        {
            // h=305 w=75
            return several.into_iter().try_for_each(|part| self.statement(part, number));
        }
        self.statement(&text, number)
    }

    /// Whether a line says anything that counts.
    pub(super) fn says(line: &[u8]) -> bool {
        let mut alone = Self::default();
        let read = alone.read(line, 0);
        let names = alone.lines.iter().any(|line| names_axes(line));
        alone.unused.clear();
        alone.lines.clear();
        alone.sizes.clear();
        read.is_err() || names || alone != Self::default()
    }

    /// What is said and not used, for people, where a unit or a size is not known.
    pub(crate) fn notes(&self, extent: [Option<Extent>; 2]) -> Vec<String> {
        let known = self.unit.is_some() && extent.iter().all(Option::is_some);
        let lines = self.unused.iter().filter(|_| !known);
        let unused = lines.map(|line| format!("the heading says {line:?}, which is not used"));
        let other = self.other_unit.as_ref().filter(|_| self.unit.is_none());
        // What the heading says of the size may still be less than a length along each axis.
        let sizes = self.sizes.iter().filter(|_| extent.iter().any(Option::is_none));
        let sizes = sizes.map(|line| format!("the heading says {line:?}, which does not give the size"));
        unused.chain(sizes).chain(other.map(|other| other.problem.to_string())).collect()
    }

    fn statement(&mut self, text: &str, line: usize) -> Result<(), ContentError> {
        let Some((statement, key, value)) = key_and_value(text) else {
            self.note_unknown(text);
            return Ok(());
        };
        self.note_size(&statement, text, &value);
        match statement {
            HeadingStatement::Channel => {
                self.name = self.name.take().or_else(|| (!value.is_empty()).then(|| value.clone()));
            }
            HeadingStatement::Side(axis, of_scan) => self.side(&key, &value, axis, of_scan, line)?,
            HeadingStatement::Size => match lengths(&value).as_deref() {
                Some([one]) => once(&mut self.square, Some(*one), &key)?,
                Some([x, y]) => both(&mut self.sides, [*x, *y], &key)?,
                _ => {}
            },
            HeadingStatement::Cell(axis) => self.cell(axis, &value, &key)?,
            HeadingStatement::Count(axis) => self.count(axis, &value, &key)?,
            HeadingStatement::HeightUnit | HeadingStatement::LateralUnit if value.is_empty() => {}
            HeadingStatement::HeightUnit => match read_unit(&value, key.clone(), line) {
                Ok(unit) => same_unit(&mut self.unit, unit, &key)?,
                Err(problem) => self.note_other_unit(value, false, problem),
            },
            HeadingStatement::LateralUnit => {
                let unit = read_unit(&value, key.clone(), line)?;
                same_unit(&mut self.lateral_unit, unit, &key)?;
            }
            HeadingStatement::DataUnit => match read_unit(&value, key, line) {
                Ok(unit) => self.unit = self.unit.take().or(Some(unit)),
                Err(problem) => self.note_other_unit(value, true, problem),
            },
            HeadingStatement::Factor(of) => {
                if let (Some(factor), Ok(unit)) = (positive(&value), unit(&of)) {
                    (self.scale, self.unit) = (Some(factor), Some(unit));
                }
            }
            HeadingStatement::Missing => self.missing = self.missing.or(value.parse().ok()),
            HeadingStatement::BitToNm => self.bit_to_nm = self.bit_to_nm.or(positive(&value)),
        }
        Ok(())
    }

    /// Keeps a line whose key is not known for the notes, where it speaks of units or sizes, or has a length.
    fn note_unknown(&mut self, text: &str) {
        let lower = text.to_lowercase();
        let between = [':', '=', '\t', ',', ';', '\u{ff1a}'];
        let value = text.split_once(between).map(|(_, value)| value.trim());
        let of_length = |value: &str| {
            let sides = lengths(value).unwrap_or_default();
            sides.iter().any(|side| side.quantity.dimension() == Dimension::LENGTH)
                || unit(value).is_ok_and(|unit| unit.dimension() == Dimension::LENGTH)
        };
        if value.is_some_and(|value| ABOUT.iter().any(|word| lower.contains(word)) || of_length(value))
            && self.unused.len() < NOTED
        {
            self.unused.push(noted(text));
        }
    }

    /// Keeps a line about sides, cells or numbers of pixels for the notes: it may not be enough for a size.
    fn note_size(&mut self, statement: &HeadingStatement, text: &str, value: &str) {
        let about_size = matches!(
            statement,
            HeadingStatement::Side(..)
                | HeadingStatement::Size
                | HeadingStatement::Cell(_)
                | HeadingStatement::Count(_)
        );
        if about_size && value.contains(|c: char| c.is_ascii_digit()) && self.sizes.len() < NOTED {
            self.sizes.push(noted(text));
        }
    }

    /// Keeps the first unit that is none of heights.
    fn note_other_unit(&mut self, written: String, convertible: bool, problem: ContentError) {
        let other = OtherUnit { written, convertible, problem };
        self.other_unit = self.other_unit.take().or(Some(other));
    }

    /// Takes the side of a cell along an axis, or along both. A plain number along an axis is a number of
    /// pixels.
    fn cell(&mut self, axis: Option<usize>, value: &str, key: &str) -> Result<(), ContentError> {
        let said = lengths(&without_pixels(value)).unwrap_or_default();
        let of_length = |side: &Side| side.quantity.dimension() == Dimension::LENGTH;
        self.grid |= key == "cellsize";
        match (axis, said.as_slice()) {
            (_, []) => Ok(()),
            (Some(axis), [plain]) if !of_length(plain) => self.count(axis, value, key),
            (Some(axis), [one, ..]) => once(&mut self.cells[axis], Some(*one), key),
            (None, [x, y]) => both(&mut self.cells, [*x, *y], key),
            (None, [one, ..]) => both(&mut self.cells, [*one; 2], key),
        }
    }

    fn side(
        &mut self,
        key: &str,
        value: &str,
        axis: usize,
        of_scan: bool,
        line: usize,
    ) -> Result<(), ContentError> {
        let mut side = lengths(value).and_then(|all| (all.len() == 1).then(|| all[0]));
        let negative = |s: &Side| s.quantity.value() <= 0.0;
        if let Some(Side { quantity, .. }) = side.filter(negative)
            && quantity.dimension() == Dimension::LENGTH
        {
            return Err(ContentError::Side { line, key: key.to_owned(), value: quantity });
        }
        side = side.filter(|s| !negative(s));
        if of_scan && side.is_some_and(|s| s.quantity.dimension() == Dimension::NONE) {
            return once(&mut self.plain[axis], side, key);
        }
        once(&mut self.sides[axis], side, key)
    }

    fn count(&mut self, axis: usize, value: &str, key: &str) -> Result<(), ContentError> {
        let Ok(count) = value.parse::<u64>() else { return Ok(()) };
        if let Some(first) = self.counts[axis].filter(|&first| first != count) {
            return Err(two_lines(key, &first, &count));
        }
        self.counts[axis] = Some(count);
        Ok(())
    }

    /// What follows from all lines together.
    pub(super) fn finish(&mut self) -> Result<(), ContentError> {
        if let (None, None, Some(scale), true) = (&self.unit, self.scale, self.bit_to_nm, self.spip) {
            (self.scale, self.unit) = (Some(scale), "nm".parse().ok());
        }
        // A length in the unit of x and y, or of SPIP; without either it may be a number of pixels.
        let nanometres = self.spip.then(|| "nm".parse().ok()).flatten();
        let unit = self.lateral_unit.clone().or(nanometres);
        for axis in 0..2 {
            if let (Some(side), Some(unit)) = (self.plain[axis], &unit)
                && let Ok(quantity) = Quantity::of(side.quantity.value(), unit)
            {
                once(&mut self.sides[axis], Some(Side { quantity, ..side }), ["x length", "y length"][axis])?;
            }
        }
        match &self.other_unit {
            Some(other) if self.unit.is_some() && !other.convertible => Err(other.problem.clone()),
            _ => Ok(()),
        }
    }

    /// The columns that the heading names, in words, where it names any.
    pub(crate) fn named(&self) -> Option<String> {
        let names: Vec<String> = self.columns.iter().map(ToString::to_string).collect();
        (!names.is_empty()).then(|| format!("the heading names the columns {}", names.join(", ")))
    }

    /// The unit of the values: a length, or one of no heights.
    pub(crate) fn stored_unit(&self) -> StoredUnit {
        match (&self.unit, &self.other_unit) {
            (Some(unit), _) => StoredUnit::Heights(unit.clone()),
            (None, Some(other)) => StoredUnit::NoHeights(Some(other.written.chars().take(32).collect())),
            (None, None) => StoredUnit::Unknown,
        }
    }

    /// The format that the header is that of: points have a unit of x and y, a matrix has a width and a
    /// height.
    pub(crate) fn format(&self) -> Option<Format> {
        let matrix = (self.sides[0].is_some() && self.sides[1].is_some()) || self.counts[0] == Some(3);
        let points = self.lateral_unit.is_some() && self.counts[0].is_none();
        if points { Some(Format::Xyz) } else { matrix.then_some(Format::Text) }
    }

    /// Width and height. Without a unit they count only where the heights are said to have none: elsewhere
    /// they are numbers of pixels.
    pub(crate) fn sides(&self) -> [Option<Side>; 2] {
        let plain = self.unit.as_ref().is_some_and(|u| u.dimension() == Dimension::NONE);
        let counts = |side: &Side| plain || side.quantity.dimension() == Dimension::LENGTH;
        self.sides.map(|side| side.filter(counts))
    }

    /// Width and height of a matrix with `count` columns and rows, and the sides of its cells where the
    /// header states them.
    ///
    /// # Errors
    /// [`ContentError::Contradiction`] where the header says another number of columns or rows, or where two
    /// of its lengths differ.
    pub(super) fn of_matrix(&self, count: [usize; 2]) -> Result<SidesAndCells, ContentError> {
        let mut sides = self.sides();
        let mut cells = [None; 2];
        for axis in 0..2 {
            if let Some(stated) = self.counts[axis].filter(|&stated| stated != count[axis] as u64) {
                let what = ["number of columns", "number of rows"][axis];
                let (first, second) =
                    (format!("{stated} in the header"), format!("{} in the lines", count[axis]));
                return Err(ContentError::Contradiction { what, first, second });
            }
            let of_length =
                |side: &Side| side.quantity.dimension() == Dimension::LENGTH && side.quantity.value() > 0.0;
            let square = self.square.filter(of_length).filter(|_| count[0] == count[1]);
            // A cell without a unit is a number beside heights without one.
            let cell =
                self.cells[axis].filter(|cell| of_length(cell) || (self.grid && cell.quantity.value() > 0.0));
            if let (Some(side), Some(square)) = (sides[axis], square)
                && !agree(side.quantity, square.quantity)
            {
                return Err(two_lines("size", &side.quantity, &square.quantity));
            }
            sides[axis] = sides[axis].or(square);
            if let Some(cell) = cell {
                let cell = Extent::Cell(cell.quantity);
                if let Some(side) = sides[axis]
                    && !agree(side.quantity, cell.side(count[axis])?)
                {
                    return Err(two_lines("size", &side.quantity, &cell.side(count[axis])?));
                }
                cells[axis] = Some(cell);
            }
        }
        Ok((sides, cells))
    }
}

/// Takes a statement about both axes.
fn both(fields: &mut [Option<Side>; 2], sides: [Side; 2], key: &str) -> Result<(), ContentError> {
    fields.iter_mut().zip(sides).try_for_each(|(field, side)| once(field, Some(side), key))
}

/// Takes a statement, or finds it to be another one than before.
fn once(field: &mut Option<Side>, side: Option<Side>, key: &str) -> Result<(), ContentError> {
    if let (Some(first), Some(second)) = (&field, &side)
        && first.quantity.dimension() == second.quantity.dimension()
        && first.quantity.value().to_bits() != second.quantity.value().to_bits()
    {
        return Err(two_lines(key, &first.quantity, &second.quantity));
    }
    *field = field.or(side);
    Ok(())
}

fn two_lines(key: &str, first: &dyn std::fmt::Display, second: &dyn std::fmt::Display) -> ContentError {
    let (first, second) = (format!("{key}: {first}"), format!("{key}: {second}"));
    ContentError::Contradiction { what: "two lines of the header", first, second }
}

/// Takes the unit of a line, or finds it to be another one than before.
fn same_unit(field: &mut Option<Unit>, unit: Unit, key: &str) -> Result<(), ContentError> {
    if let Some(first) = field.as_ref().filter(|first| !first.same(&unit)) {
        return Err(two_lines(key, first, &unit));
    }
    field.get_or_insert(unit);
    Ok(())
}

/// The unit that a line states.
fn read_unit(value: &str, key: String, line: usize) -> Result<Unit, ContentError> {
    unit(value).map_err(|source| ContentError::Heading { line, key, source })
}

/// The beginning of a line, for notes.
fn noted(text: &str) -> String {
    text.trim().chars().take(80).collect()
}

/// A length for each pixel, `7413 nm/pixel`, as a length.
fn without_pixels(value: &str) -> String {
    let mut value = value.replace(" / ", "/");
    for pixel in ["/pixel", "/pix", "/px"] {
        value = value.replace(pixel, "");
    }
    value
}

fn positive(value: &str) -> Option<f64> {
    value.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0)
}

fn unit(text: &str) -> Result<Unit, QuantityError> {
    let unit: Unit = text.parse()?;
    if unit.dimension() == Dimension::LENGTH || unit == Unit::none() {
        Ok(unit)
    } else {
        let (text, found) = (unit.to_string(), unit.dimension());
        Err(QuantityError::Dimension { text, found, expected: Dimension::LENGTH })
    }
}
