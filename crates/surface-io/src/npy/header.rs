//! The header of an NPY file: magic, version, length, a Python dictionary of three entries.

use crate::channel::AxisOrder;
use crate::error::{ContentError, Result};
use crate::number_type::NumberType;
use crate::source::OpenedFile;

/// First bytes of the file.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Longest dictionary that is read, in bytes; NumPy itself refuses more than 10000 of an unknown file.
const LONGEST: u64 = 10_000;

/// Most axes that are listed; NumPy has 64.
const MOST_AXES: usize = 64;

/// Type of numbers as numpy writes it, such as `<f8`.
fn number_type(descr: &str) -> Option<NumberType> {
    let [order, letter, size] = *descr.as_bytes() else { return None };
    let size = size.wrapping_sub(b'0');
    let ordered = matches!(order, b'<' | b'>') || (order == b'|' && size == 1);
    NumberType::new(letter, size, order != b'>').filter(|_| ordered)
}

#[derive(Debug)]
pub(super) struct NpyHeader {
    pub(super) kind: NumberType,
    pub(super) order: AxisOrder,
    pub(super) shape: Vec<u64>,
}

impl NpyHeader {
    /// Reads the header; returns its own length too.
    pub(super) fn read(source: &mut OpenedFile<'_>) -> Result<(Self, u64)> {
        let start = source.start(12)?;
        let wrong = |offset, expected| source.content(ContentError::Header { offset, expected });
        let byte = |i: usize| start.get(i).copied().ok_or_else(|| wrong(i, "the length of the header"));
        let (size, before) = match byte(6)? {
            1 => (u64::from(u16::from_le_bytes([byte(8)?, byte(9)?])), 10),
            2 | 3 => (u64::from(u32::from_le_bytes([byte(8)?, byte(9)?, byte(10)?, byte(11)?])), 12),
            _ => return Err(wrong(6, "version 1, 2 or 3")),
        };
        if before + size > source.length() {
            return Err(wrong(8, "a header that ends inside the file (cut short?)"));
        }
        if size > LONGEST {
            return Err(wrong(8, "a header of at most 10000 bytes"));
        }
        let text = source.bytes(before, size)?;
        let mut parser = Parser { text: &text, at: 0, before: before as usize };
        let header = parser.dictionary().map_err(|e| source.content(e))?;
        Ok((header, before + size))
    }
}

/// Reads the dictionary from left to right; nothing in it nests.
struct Parser<'a> {
    text: &'a [u8],
    at: usize,
    before: usize,
}

type Parsed<T> = Result<T, ContentError>;

impl Parser<'_> {
    fn wrong<T>(&self, expected: &'static str) -> Parsed<T> {
        Err(ContentError::Header { offset: self.before + self.at, expected })
    }

    fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    fn take(&mut self, byte: u8, expected: &'static str) -> Parsed<()> {
        if self.peek() == Some(byte) {
            self.at += 1;
            Ok(())
        } else {
            self.wrong(expected)
        }
    }

    fn dictionary(&mut self) -> Parsed<NpyHeader> {
        let (mut descr, mut order, mut shape) = (None, None, None);
        self.take(b'{', "{")?;
        while self.peek() != Some(b'}') {
            let key = self.string()?;
            self.take(b':', "a colon after the key")?;
            match key.as_str() {
                "descr" if descr.is_none() => descr = Some(self.descr()?),
                "fortran_order" if order.is_none() => order = Some(self.order()?),
                "shape" if shape.is_none() => shape = Some(self.shape()?),
                _ => return self.wrong("the keys descr, fortran_order and shape, each once"),
            }
            if self.peek() == Some(b',') {
                self.at += 1;
            } else if self.peek() != Some(b'}') {
                return self.wrong("a comma or }");
            }
        }
        self.at += 1;
        if self.peek().is_some() {
            return self.wrong("nothing but spaces after }");
        }
        let (Some(kind), Some(order), Some(shape)) = (descr, order, shape) else {
            return self.wrong("the keys descr, fortran_order and shape before }");
        };
        Ok(NpyHeader { kind, order, shape })
    }

    fn string(&mut self) -> Parsed<String> {
        let Some(quote @ (b'\'' | b'"')) = self.peek() else { return self.wrong("a string in quotes") };
        let from = self.at + 1;
        let Some(length) = self.text[from..].iter().position(|&b| b == quote) else {
            return self.wrong("a string that ends");
        };
        self.at = from + length + 1;
        Ok(String::from_utf8_lossy(&self.text[from..from + length]).into_owned())
    }

    fn descr(&mut self) -> Parsed<NumberType> {
        if self.peek() == Some(b'[') {
            return Err(ContentError::Type { found: "a structure".into() });
        }
        let descr = self.string()?;
        number_type(&descr).ok_or_else(|| ContentError::Type {
            found: format!("'{}'", descr.chars().take(32).collect::<String>()),
        })
    }

    fn order(&mut self) -> Parsed<AxisOrder> {
        self.peek();
        let rest = &self.text[self.at..];
        let (length, order) = if rest.starts_with(b"True") {
            (4, AxisOrder::Columns)
        } else if rest.starts_with(b"False") {
            (5, AxisOrder::Rows)
        } else {
            return self.wrong("True or False");
        };
        self.at += length;
        Ok(order)
    }

    fn shape(&mut self) -> Parsed<Vec<u64>> {
        let mut shape = Vec::new();
        self.take(b'(', "a shape in brackets ( )")?;
        while self.peek() != Some(b')') {
            if shape.len() == MOST_AXES {
                return self.wrong("at most 64 axes");
            }
            let digits = self.text[self.at..].iter().take_while(|b| b.is_ascii_digit()).count();
            let number =
                std::str::from_utf8(&self.text[self.at..self.at + digits]).ok().and_then(|t| t.parse().ok());
            let Some(number) = number else { return self.wrong("the length of an axis below 2^64") };
            shape.push(number);
            self.at += digits;
            // Python 2 wrote long integers with an L.
            if self.text.get(self.at) == Some(&b'L') {
                self.at += 1;
            }
            if self.peek() == Some(b',') {
                self.at += 1;
            } else if self.peek() != Some(b')') {
                return self.wrong("a comma or ) after the length of an axis");
            }
        }
        self.at += 1;
        Ok(shape)
    }
}
