//! The header of an NPY file: magic, version, length, a Python dictionary of three entries.

use crate::detect::NPY;
use crate::error::{ContentError, Error, Result};
use std::fmt;
use std::io::Read;
use std::path::Path;

/// Longest dictionary that is read, in bytes; NumPy itself refuses more than 10000 of an unknown file.
const LONGEST: u64 = 10_000;

/// Most axes that are listed; NumPy has 64.
const MOST_AXES: usize = 64;

/// Type of the numbers, one that this crate reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct NumberType {
    /// `f`, `i` or `u`.
    pub(super) letter: u8,
    size: u8,
    pub(super) little: bool,
}

impl NumberType {
    pub(super) fn bytes(self) -> usize {
        usize::from(self.size)
    }

    fn of(descr: &str) -> Option<Self> {
        let [order, letter, size] = *descr.as_bytes() else { return None };
        let size = size.wrapping_sub(b'0');
        let known = match letter {
            b'f' => matches!(size, 2 | 4 | 8),
            b'i' | b'u' => matches!(size, 1 | 2 | 4 | 8),
            _ => false,
        };
        let ordered = matches!(order, b'<' | b'>') || (order == b'|' && size == 1);
        (known && ordered).then_some(Self { letter, size, little: order != b'>' })
    }
}

impl fmt::Display for NumberType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.letter {
            b'f' => "float",
            b'i' => "int",
            _ => "uint",
        };
        let order = if self.little { "little" } else { "big" };
        write!(f, "{name}{}, {order}-endian", 8 * self.size)
    }
}

/// Which index runs fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AxisOrder {
    /// The last one.
    C,
    /// The first one.
    Fortran,
}

#[derive(Debug)]
pub(super) struct NpyHeader {
    pub(super) kind: NumberType,
    pub(super) order: AxisOrder,
    pub(super) shape: Vec<u64>,
}

impl NpyHeader {
    /// Reads the header of a file of the given length; returns its own length too.
    pub(super) fn read(path: &Path, reader: &mut impl Read, length: u64) -> Result<(Self, u64)> {
        let wrong = |offset, expected| Error::content(path)(ContentError::Header { offset, expected });
        let mut exact = |bytes: &mut [u8], offset, expected| match reader.read_exact(bytes) {
            Ok(()) => Ok(()),
            Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => Err(wrong(offset, expected)),
            Err(e) => Err(Error::system("read", path)(e)),
        };
        let mut start = [0; 8];
        exact(&mut start, 0, "an NPY file, not an empty one")?;
        if !start.starts_with(NPY) {
            return Err(wrong(0, "the bytes 93 4e 55 4d 50 59 of an NPY file"));
        }
        let (size, before) = match start[6] {
            1 => {
                let mut size = [0; 2];
                exact(&mut size, 8, "the length of the header")?;
                (u64::from(u16::from_le_bytes(size)), 10)
            }
            2 | 3 => {
                let mut size = [0; 4];
                exact(&mut size, 8, "the length of the header")?;
                (u64::from(u32::from_le_bytes(size)), 12)
            }
            _ => return Err(wrong(6, "version 1, 2 or 3")),
        };
        if before + size > length {
            return Err(wrong(8, "a header that ends inside the file (cut short?)"));
        }
        if size > LONGEST {
            return Err(wrong(8, "a header of at most 10000 bytes"));
        }
        let mut text = vec![0; size as usize];
        exact(&mut text, before as usize, "the dictionary")?;
        let mut parser = Parser { text: &text, at: 0, before: before as usize };
        Ok((parser.dictionary().map_err(Error::content(path))?, before + size))
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
        NumberType::of(&descr).ok_or_else(|| ContentError::Type {
            found: format!("'{}'", descr.chars().take(32).collect::<String>()),
        })
    }

    fn order(&mut self) -> Parsed<AxisOrder> {
        self.peek();
        let rest = &self.text[self.at..];
        let (length, order) = if rest.starts_with(b"True") {
            (4, AxisOrder::Fortran)
        } else if rest.starts_with(b"False") {
            (5, AxisOrder::C)
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
