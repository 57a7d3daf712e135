//! Numbers as text: lines, delimiters, comments and headers.

mod columns;
mod comment;
mod decimals;
mod delimiter;
mod heading;
mod matrix;
mod number;
mod statement;

pub(crate) use columns::{ColumnKind, TextColumn, symbol};
pub(crate) use delimiter::Delimiter;
pub(crate) use heading::Heading;
pub(crate) use matrix::matrix;

use crate::error::{ContentError, NumberKind, Place};
use crate::fields::decoded;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::options::{Decimal, ReadOptions};
use comment::without_comment;
use contact_model::units::number;
use decimals::{CommaPairs, comma_pairs};
use number::unquoted;
use std::borrow::Cow;

/// Lines of equally many numbers; NaN is an undefined point.
#[derive(Debug)]
pub(crate) struct TextTable {
    pub(crate) columns: usize,
    pub(crate) values: Vec<f64>,
    pub(crate) delimiter: Delimiter,
    pub(crate) heading: Heading,
    /// Numbers of the lines of data, from 1.
    pub(crate) lines: Vec<u32>,
    /// What is to be told of the numbers.
    pub(crate) notes: Vec<String>,
    /// Height of one unit of a number, where the header says it.
    pub(crate) scale: Option<f64>,
    /// The last line of words before the numbers.
    title: Option<String>,
    /// Whether decimal commas were found without a request for them.
    found_commas: bool,
    /// What ends a line: a line feed, or a carriage return alone.
    end: u8,
    /// Whether every line so far began, and ended, with a delimiter. The one is the habit of some programs;
    /// the other is one too, or an empty last place.
    outer: [bool; 2],
    /// Whether there is an empty line behind every line.
    spaced: bool,
}

/// Most maps of one text.
const MOST_MAPS: usize = 1000;

/// A line and its number, from 1.
type NumberedLine<'t> = (usize, &'t [u8]);

/// Two columns with at most this number of rows are a map.
const PROFILE: usize = 8;

/// A mark that some editors put before UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

impl TextTable {
    pub(crate) fn rows(&self) -> usize {
        self.values.len() / self.columns
    }

    /// Whether these are two columns, the first of which only goes up or only goes down where it is a number,
    /// as x does along a profile.
    pub(crate) fn is_profile(&self) -> bool {
        if self.columns != 2 || self.rows() <= PROFILE {
            return false;
        }
        let along: Vec<f64> = self.values.iter().step_by(2).copied().filter(|x| !x.is_nan()).collect();
        let every = |order: fn(f64, f64) -> bool| along.windows(2).all(|pair| order(pair[0], pair[1]));
        along.len() > PROFILE && (every(|a, b| a < b) || every(|a, b| a > b))
    }

    /// Number of the first line of data, from 1.
    pub(crate) fn first_line(&self) -> usize {
        self.lines.first().map_or(1, |&line| line as usize)
    }

    /// Reads all lines, map by map; with decimal commas where they are found to be nothing else.
    ///
    /// A heading between numbers ends a map, and so does an empty line: not where there is one behind every
    /// line, nor between three columns, which are points of one map unless a matrix is requested.
    ///
    /// Memory: at most 8 bytes for each byte of the text (nothing between two commas), and 4 for each line.
    pub(crate) fn read(bytes: &[u8], declared: &ReadOptions) -> Result<Vec<Self>, ContentError> {
        let end = line_end(bytes);
        check_text(bytes, end)?;
        let bytes = bytes.strip_prefix(MARK).unwrap_or(bytes);
        let mut read = Self::read_as(bytes, end, declared.decimal, declared);
        if declared.decimal == Decimal::Point || read.is_err() {
            check_commas(bytes, end, declared, &mut read)?;
        }
        let error = match read {
            Err(error) if declared.decimal == Decimal::Point => error,
            read => return read,
        };
        let kind = NumberKind::DecimalComma;
        if matches!(&error, ContentError::Number { kind: found, .. } if *found == kind || *found == NumberKind::Two)
            && has_decimal_commas(bytes, end, declared.skip_lines)
            && let Ok(maps) = Self::read_as(bytes, end, Decimal::Comma, declared)
        {
            return Ok(maps.into_iter().map(|map| Self { found_commas: true, ..map }).collect());
        }
        Err(error)
    }

    /// Reads all lines with one decimal sign.
    fn read_as(
        bytes: &[u8],
        end: u8,
        decimal: Decimal,
        declared: &ReadOptions,
    ) -> Result<Vec<Self>, ContentError> {
        let mut reading = MapsInText::new(bytes, end, decimal, declared);
        for (i, line) in bytes.split(|&b| b == end).enumerate().skip(declared.skip_lines) {
            let (data, comment) = without_comment(line);
            if data.trim_ascii().is_empty() {
                reading.no_data(comment, i + 1);
            } else if decimal.is_header(data) {
                reading.header(line, data, i + 1);
            } else {
                reading.numbers(data, i + 1)?;
            }
        }
        let mut maps = reading.finish()?;
        for map in &mut maps {
            map.apply_heading()?;
        }
        Ok(maps)
    }

    /// Names the columns and marks undefined points by the whole heading.
    fn apply_heading(&mut self) -> Result<(), ContentError> {
        self.name_columns();
        self.without_first_places();
        self.heading.finish()?;
        self.scale = self.heading.scale;
        if let Some(mark) = self.heading.missing {
            // Grids of ESRI hold float32, whatever number of digits their cells and their header have.
            let marks = |h: &f64| NumberType::F32.same(*h, mark);
            self.values.iter_mut().filter(|h| marks(h)).for_each(|h| *h = f64::NAN);
        }
        Ok(())
    }

    /// Finds the columns that the heading names.
    fn name_columns(&mut self) {
        let (title, lines) = (self.title.take(), std::mem::take(&mut self.heading.lines));
        self.heading.columns = columns::named(&lines, title.as_deref(), self.delimiter, self.columns);
    }

    /// Whether the map ends before the next numbers, with a heading or an empty line between.
    fn ends(&mut self, gap: bool, heading: bool, declared: &ReadOptions) -> bool {
        let points = match declared.format {
            Some(Format::Xyz) => true,
            Some(_) => false,
            None => self.columns == 3,
        };
        self.spaced |= gap && self.rows() == 1;
        heading || (gap && !points && !self.spaced)
    }

    /// One line of numbers below as many keys says what they are: `numCols numRows pixelSize`, `4 3 1.7`.
    fn statements(&self, title: &[u8]) -> Option<Vec<String>> {
        let title = decoded(title);
        let keys: Vec<&str> = title.trim().split(char::from(self.delimiter.byte())).map(str::trim).collect();
        let lines = keys.iter().zip(&self.values).map(|(key, value)| format!("{key}: {value}"));
        let lines: Vec<String> = lines.collect();
        let known = lines.iter().any(|line| Heading::says(line.as_bytes()));
        (self.rows() == 1 && keys.len() == self.columns && known).then_some(lines)
    }

    fn new(first: &[u8], decimal: Decimal, end: u8) -> Self {
        Self {
            columns: 0,
            values: Vec::new(),
            delimiter: Delimiter::of(first.trim_ascii(), decimal),
            heading: Heading::default(),
            lines: Vec::new(),
            notes: Vec::new(),
            scale: None,
            title: None,
            found_commas: false,
            end,
            outer: [true; 2],
            spaced: false,
        }
    }

    /// Delimiter and what else was found, for people.
    pub(crate) fn details(&self) -> String {
        let commas = if self.found_commas { ", decimal commas" } else { "" };
        let first = if self.begins_with_delimiters() { ", one before every line" } else { "" };
        let scale = self.scale.map(|scale| format!(", times {}", number(scale))).unwrap_or_default();
        format!("{}{first}{commas}{scale}", self.delimiter)
    }

    /// A line before the numbers that is half of numbers, as many as there are columns, is a line of data
    /// with a slip.
    fn check_header(&self, decimal: Decimal, header: &[u8], line: usize) -> Result<(), ContentError> {
        let tokens: Vec<&[u8]> = self.delimiter.tokens(header).collect();
        let place = |value| Place::Line { line, value };
        let read = tokens.iter().filter(|t| !t.is_empty() && decimal.number(t, place(1)).is_ok()).count();
        if self.columns > 1 && tokens.len() == self.columns && 2 * read >= self.columns {
            for (i, token) in tokens.iter().enumerate() {
                decimal.number(token, place(i + 1))?;
            }
        }
        Ok(())
    }

    fn line(&mut self, decimal: Decimal, data: &[u8], line: usize, all: &[u8]) -> Result<(), ContentError> {
        let before = self.values.len();
        let push = |token: &[u8], value: usize, values: &mut Vec<f64>| -> Result<(), ContentError> {
            values.push(decimal.number(token, Place::Line { line, value })?);
            Ok(())
        };
        if self.delimiter == Delimiter::Whitespace {
            for (i, token) in self.delimiter.tokens(data).enumerate() {
                push(token, i + 1, &mut self.values)?;
            }
        } else {
            let byte = self.delimiter.byte();
            // Tabs at the ends are delimiters there, so only the line break and spaces go.
            let end = data.iter().rposition(|&b| b != b'\r').map_or(0, |at| at + 1);
            let data = if byte == b'\t' { &data[..end] } else { data.trim_ascii() };
            self.outer[0] &= data.first() == Some(&byte);
            // One delimiter behind the last number is the habit of some programs; with a number less than in
            // other lines, the last place is empty.
            let (data, open) = data.strip_suffix(&[byte]).map_or((data, false), |data| (data, true));
            for (i, token) in self.delimiter.tokens(data).enumerate() {
                push(token, i + 1, &mut self.values)?;
            }
            let found = self.values.len() - before;
            if open && found + 1 == self.columns {
                self.values.push(f64::NAN);
            } else if self.outer[1] && !open && self.columns > 0 && found == self.columns + 1 {
                self.close(found);
                return self.finish_line(line, self.values.len() - found, all);
            }
            self.outer[1] &= open;
        }
        self.finish_line(line, before, all)
    }

    /// All lines before the last one get an undefined last place.
    fn close(&mut self, columns: usize) {
        let rows = self.lines.len();
        let last = self.values.split_off(rows * self.columns);
        let mut values = Vec::with_capacity(self.values.capacity().max((rows + 1) * columns));
        for row in self.values.chunks(self.columns) {
            values.extend_from_slice(row);
            values.push(f64::NAN);
        }
        values.extend(last);
        (self.values, self.columns, self.outer[1]) = (values, columns, false);
    }

    /// Whether every line begins with a delimiter, before which there is no place then.
    fn begins_with_delimiters(&self) -> bool {
        self.outer[0] && self.delimiter != Delimiter::Whitespace
    }

    /// Drops the empty places before the first delimiters of all lines.
    fn without_first_places(&mut self) {
        if self.begins_with_delimiters() && self.columns > 1 {
            let columns = self.columns;
            let mut place = 0;
            self.values.retain(|_| {
                place += 1;
                (place - 1) % columns > 0
            });
            self.columns -= 1;
            self.heading.columns.drain(..self.heading.columns.len().min(1));
        }
    }

    /// Where the second and the third line agree with each other, the first one is the one to look at.
    fn odd_one_out(&self, error: ContentError, all: &[u8]) -> ContentError {
        let (ContentError::Ragged { line, found, expected, first }, 2) = (&error, self.lines.len()) else {
            return error;
        };
        let count = |line: &[u8]| {
            let data = without_comment(line).0.trim_ascii();
            let most = data.strip_suffix(&[self.delimiter.byte()]).unwrap_or(data);
            if data.is_empty() { 0 } else { self.delimiter.tokens(most).count() }
        };
        let third = all.split(|&b| b == self.end).skip(*line).map(count).find(|&count| count > 0);
        if third == Some(*found) {
            return ContentError::Ragged { line: *first, found: *expected, expected: *found, first: *line };
        }
        error
    }

    /// Counts a line whose values stand behind the first `before`.
    fn finish_line(&mut self, line: usize, before: usize, all: &[u8]) -> Result<(), ContentError> {
        let found = self.values.len() - before;
        // Files of more than 2^32 lines are beyond what is read by default.
        self.lines.push(line as u32);
        if self.columns == 0 {
            self.columns = found;
            // All lines of the first map at once, and never more than there can be values in these bytes.
            let lines = all.split(|&b| b == self.end).count();
            let most = (all.len() + 1).min(found.saturating_mul(lines));
            let refused = |_| ContentError::Memory { bytes: 8 * most as u128 };
            self.values.try_reserve_exact(most - before.min(most)).map_err(refused)?;
            self.lines.try_reserve_exact(lines).map_err(refused)?;
        } else if found != self.columns {
            let (expected, first) = (self.columns, self.first_line());
            return Err(ContentError::Ragged { line, found, expected, first });
        }
        Ok(())
    }
}

/// The maps of a text, read line by line.
struct MapsInText<'t> {
    bytes: &'t [u8],
    end: u8,
    decimal: Decimal,
    declared: &'t ReadOptions,
    maps: Vec<TextTable>,
    /// Whether the next numbers may go on with the last map.
    open: bool,
    /// The line before the numbers of the map that is open.
    title: Option<&'t [u8]>,
    /// Lines of the heading of the next map.
    heading: Vec<(usize, Cow<'t, [u8]>)>,
    /// The first line of a heading without the mark of a comment.
    first: Option<NumberedLine<'t>>,
    /// The last one since the last numbers.
    last: Option<NumberedLine<'t>>,
    /// Whether there is an empty line since the last numbers.
    gap: bool,
}

impl<'t> MapsInText<'t> {
    fn new(bytes: &'t [u8], end: u8, decimal: Decimal, declared: &'t ReadOptions) -> Self {
        Self {
            bytes,
            end,
            decimal,
            declared,
            maps: Vec::new(),
            open: false,
            title: None,
            heading: Vec::new(),
            first: None,
            last: None,
            gap: false,
        }
    }

    /// Takes an empty line or a comment.
    fn no_data(&mut self, comment: Option<&'t [u8]>, line: usize) {
        self.gap |= comment.is_none();
        self.heading.extend(comment.map(|comment| (line, Cow::from(comment))));
    }

    /// Takes a line of words.
    fn header(&mut self, text: &'t [u8], data: &'t [u8], line: usize) {
        self.heading.push((line, text.trim_ascii().into()));
        self.first = self.first.or(Some((line, data)));
        self.last = Some((line, data));
    }

    /// Takes a line of numbers, which goes on with the open map or begins one.
    fn numbers(&mut self, data: &'t [u8], line: usize) -> Result<(), ContentError> {
        self.close_ended_map(line);
        let begins = !self.open;
        if begins {
            self.open_map(data, line)?;
        }
        // The first map reserves memory for all lines.
        let all = if self.maps.len() == 1 { self.bytes } else { &[] };
        let Some(map) = self.maps.last_mut() else { return Err(ContentError::Empty) };
        map.line(self.decimal, data, line, all).map_err(|error| map.odd_one_out(error, self.bytes))?;
        if begins {
            if let Some((number, header)) = self.last
                && !Heading::says(header)
            {
                map.check_header(self.decimal, header, number)?;
            }
            self.title = self.last.map(|(_, header)| header);
        }
        self.heading.clear();
        (self.open, self.gap, self.last) = (true, false, None);
        Ok(())
    }

    /// Closes the open map where it ends before the numbers of this line. One that is a line of statements is
    /// none, but part of the heading of the next.
    fn close_ended_map(&mut self, line: usize) {
        let Some(map) = self.maps.last_mut().filter(|_| self.open) else { return };
        let heading = self.last.is_some() || self.heading.iter().any(|(_, line)| Heading::says(line));
        if !map.ends(self.gap, heading, self.declared) {
            return;
        }
        self.open = false;
        if let Some(stated) = self.title.and_then(|title| map.statements(title)) {
            let stated = stated.into_iter().map(|text| (line - 1, text.into_bytes().into()));
            self.heading.splice(0..0, stated);
            self.maps.pop();
        } else {
            map.values.shrink_to_fit();
            map.lines.shrink_to_fit();
        }
    }

    /// Begins a map with the heading so far.
    fn open_map(&mut self, data: &[u8], line: usize) -> Result<(), ContentError> {
        if self.maps.len() == MOST_MAPS {
            return Err(ContentError::TooManyMaps { most: MOST_MAPS, line });
        }
        let mut map = TextTable::new(data, self.decimal, self.end);
        map.title = self.last.map(|(_, header)| decoded(header));
        self.heading.drain(..).try_for_each(|(line, text)| map.heading.read(&text, line))?;
        self.maps.push(map);
        Ok(())
    }

    /// The maps, with what stands behind the last numbers in the heading of the last one.
    ///
    /// # Errors
    /// Where words without numbers end the text: what was expected instead of them.
    fn finish(mut self) -> Result<Vec<TextTable>, ContentError> {
        if let (Some((number, line)), true) = (self.last.and(self.first), self.last.is_some()) {
            let (number, line) =
                if self.maps.is_empty() { (number, line) } else { self.last.unwrap_or((number, line)) };
            let mut none = TextTable::new(line, self.decimal, self.end);
            return none.line(self.decimal, line, number, line).and(Err(ContentError::Empty));
        }
        let Some(map) = self.maps.last_mut() else { return Err(ContentError::Empty) };
        self.heading.into_iter().try_for_each(|(line, text)| map.heading.read(&text, line))?;
        Ok(self.maps)
    }
}

/// What ends the lines: a carriage return where there is no line feed at all, as on old Macintoshes.
fn line_end(bytes: &[u8]) -> u8 {
    if !bytes.contains(&b'\n') && bytes.contains(&b'\r') { b'\r' } else { b'\n' }
}

/// Refuses bytes that text does not have: control characters, and carriage returns alone where lines end
/// otherwise.
fn check_text(bytes: &[u8], end: u8) -> Result<(), ContentError> {
    let bad = |&(i, b): &(usize, &u8)| match *b {
        b'\t' | b'\n' | 0x0c => false,
        // Some programs end lines with CR CR LF.
        b'\r' => end == b'\n' && !matches!(bytes[i + 1..], [] | [b'\n', ..] | [b'\r', b'\n', ..]),
        b => b < b' ' || b == 0x7f,
    };
    match bytes.iter().enumerate().find(bad) {
        Some((offset @ (0 | 1), 0)) if bytes.get(offset + 2) == Some(&0) => {
            let (what, remedy) = ("text in UTF-16 without a mark of it", "save it as UTF-8");
            Err(ContentError::Foreign { what, remedy })
        }
        Some((offset, &byte)) => Err(ContentError::NoText { offset, byte }),
        None => Ok(()),
    }
}

/// Refuses commas that are decimal signs and separators at once. Where they may be that and are not certainly,
/// the maps get a note.
fn check_commas(
    bytes: &[u8],
    end: u8,
    declared: &ReadOptions,
    read: &mut Result<Vec<TextTable>, ContentError>,
) -> Result<(), ContentError> {
    match (comma_pairs(bytes, end, declared.skip_lines), read) {
        (CommaPairs::Numbers, _) => {}
        (CommaPairs::Certain, _) if declared.format != Some(Format::Text) => {
            return Err(ContentError::Commas);
        }
        (_, Ok(maps)) => {
            let note = "every second number of all lines has no sign and equally many digits, as decimals have: if commas are \
                        decimal signs and separators at once, export the file with semicolons or tabs as separators and say \
                        decimal = \"comma\"";
            for map in maps {
                map.notes.push(note.to_owned());
            }
        }
        (_, Err(_)) => return Err(ContentError::Commas),
    }
    Ok(())
}

/// Whether every comma in the numbers is one of decimals, and one of them at least can be nothing else: no
/// point anywhere, another delimiter between numbers, at most one comma in each.
fn has_decimal_commas(bytes: &[u8], end: u8, skip: usize) -> bool {
    let mut certain = false;
    let mut begun = false;
    for line in bytes.split(|&b| b == end).skip(skip) {
        let data = without_comment(line).0.trim_ascii();
        if data.is_empty() || (!begun && Decimal::Comma.is_header(data)) {
            continue;
        }
        begun = true;
        for token in data.split(|b| matches!(b, b' ' | b'\t' | b';' | b'\r')).filter(|t| t.contains(&b',')) {
            let Ok(text) = std::str::from_utf8(unquoted(token)) else { return false };
            certain |= statement::is_decimal_comma(text);
            let grouped = text.split_once(',').is_some_and(|(_, rest)| {
                !rest.contains(',') && rest.starts_with(|c: char| c.is_ascii_digit())
            });
            if !grouped {
                return false;
            }
        }
        if data.contains(&b'.') {
            return false;
        }
    }
    certain
}

#[cfg(test)]
mod tests;
