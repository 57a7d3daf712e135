//! The bytes of a file, read where a format's header says, never beyond its end.

use crate::error::{ContentError, Error, Result};
use crate::format::Format;
use crate::number_type::NumberType;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What files and byte arrays can both do.
pub(crate) trait Input: Read + Seek {
    /// The same bytes without a lifetime, for readers of other crates that keep what they read from: a second handle of a file, a copy of
    /// bytes.
    fn detached(&self) -> std::io::Result<OwnInput>;
}

impl Input for BufReader<File> {
    fn detached(&self) -> std::io::Result<OwnInput> {
        self.get_ref().try_clone().map(|file| OwnInput::File(BufReader::new(file)))
    }
}

impl Input for Cursor<&[u8]> {
    fn detached(&self) -> std::io::Result<OwnInput> {
        Ok(OwnInput::Bytes(Cursor::new(self.get_ref().to_vec())))
    }
}

/// An input of its own; the place in a file is shared with the one that it comes from, so that both go to an offset before they read.
pub(crate) enum OwnInput {
    File(BufReader<File>),
    Bytes(Cursor<Vec<u8>>),
}

/// An input of its own that gives so many bytes in all: a file may name the same bytes a thousand times, and what is read is held.
pub(crate) struct Detached {
    input: OwnInput,
    budget: Budget,
}

/// Bytes that may still be read; none is left once more was asked for.
#[derive(Debug, Clone)]
pub(crate) struct Budget(Arc<AtomicU64>);

impl Budget {
    pub(crate) fn new(bytes: u64) -> Self {
        Self(Arc::new(AtomicU64::new(bytes)))
    }

    /// Whether more was asked for.
    pub(crate) fn is_spent(&self) -> bool {
        self.0.load(Ordering::Relaxed) == 0
    }
}

impl Read for Detached {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let left = self.budget.0.load(Ordering::Relaxed);
        if buffer.len() as u64 >= left {
            self.budget.0.store(0, Ordering::Relaxed);
            return Err(std::io::Error::other("more is read than the file can mean"));
        }
        let read = match &mut self.input {
            OwnInput::File(file) => file.read(buffer),
            OwnInput::Bytes(bytes) => bytes.read(buffer),
        }?;
        self.budget.0.store(left - read as u64, Ordering::Relaxed);
        Ok(read)
    }
}

impl Seek for Detached {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        match &mut self.input {
            OwnInput::File(file) => file.seek(to),
            OwnInput::Bytes(bytes) => bytes.seek(to),
        }
    }
}

/// An opened file of a known length.
pub(crate) struct Source<'a> {
    input: Box<dyn Input + 'a>,
    path: PathBuf,
    length: u64,
}

impl<'a> Source<'a> {
    pub(crate) fn new(path: &Path, input: impl Input + 'a, length: u64) -> Self {
        Self { input: Box::new(input), path: path.to_owned(), length }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes of the file.
    pub(crate) fn length(&self) -> u64 {
        self.length
    }

    /// The first bytes, at most so many: fewer in a shorter file.
    pub(crate) fn start(&mut self, most: u64) -> Result<Vec<u8>> {
        self.read(0, self.length.min(most))
    }

    /// So many bytes from an offset on; an error where the file is shorter, before anything is allocated.
    pub(crate) fn bytes(&mut self, format: Format, offset: u64, count: u64) -> Result<Vec<u8>> {
        if offset.checked_add(count).is_none_or(|end| end > self.length) {
            let expected = format!("{count} bytes here, the file ends at {} (cut short?)", self.length);
            return Err(self.wrong(format, offset, expected));
        }
        self.read(offset, count)
    }

    fn read(&mut self, offset: u64, count: u64) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let refused = |_| ContentError::Memory { bytes: count.into() };
        bytes.try_reserve_exact(count as usize).map_err(refused).map_err(Error::content(&self.path))?;
        bytes.resize(count as usize, 0);
        self.fill(offset, &mut bytes)?;
        Ok(bytes)
    }

    /// Fills the buffer from an offset on.
    pub(crate) fn fill(&mut self, offset: u64, buffer: &mut [u8]) -> Result<()> {
        let read = self.input.seek(SeekFrom::Start(offset)).and_then(|_| self.input.read_exact(buffer));
        match read {
            Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
                // The length was taken when the file was opened.
                let found = offset;
                Err(self.content(ContentError::Changed { expected: self.length, found }))
            }
            read => read.map_err(Error::system("read", &self.path)),
        }
    }

    /// The whole input from its beginning, for readers of other crates.
    pub(crate) fn whole(&mut self) -> Result<&mut (dyn Input + 'a)> {
        self.input.seek(SeekFrom::Start(0)).map_err(Error::system("read", &self.path))?;
        Ok(&mut *self.input)
    }

    /// The input without its lifetime, for readers of other crates that keep it.
    pub(crate) fn detached(&self, budget: &Budget) -> Result<Detached> {
        let input = self.input.detached().map_err(Error::system("read", &self.path))?;
        Ok(Detached { input, budget: budget.clone() })
    }

    /// A part of the input, for readers of other crates; the caller has compared its end with [`Source::length`].
    pub(crate) fn part(&mut self, offset: u64, length: u64) -> Result<Take<&mut (dyn Input + 'a)>> {
        self.input.seek(SeekFrom::Start(offset)).map_err(Error::system("read", &self.path))?;
        Ok((&mut *self.input as &mut (dyn Input + 'a)).take(length))
    }

    /// An error about this file.
    pub(crate) fn content(&self, problem: ContentError) -> Error {
        Error::content(&self.path)(problem)
    }

    /// An error about what stands at an offset of a binary file.
    pub(crate) fn wrong(&self, format: Format, offset: u64, expected: impl Into<String>) -> Error {
        self.content(ContentError::Binary { format, offset, expected: expected.into() })
    }
}

/// A part of a file that is in memory, read number by number and never beyond its end.
pub(crate) struct Fields<'a> {
    bytes: &'a [u8],
    /// Where the part begins in the file.
    base: u64,
    at: usize,
    little: bool,
}

/// Too short; the offset in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct EndOfFields(u64);

impl EndOfFields {
    /// The error of a file whose header ends too early.
    pub(crate) fn of(self, source: &Source<'_>, format: Format) -> Error {
        source.wrong(format, self.0, "more of the header (cut short?)")
    }
}

impl<'a> Fields<'a> {
    pub(crate) fn little(bytes: &'a [u8], base: u64) -> Self {
        Self { bytes, base, at: 0, little: true }
    }

    pub(crate) fn big(bytes: &'a [u8], base: u64) -> Self {
        Self { bytes, base, at: 0, little: false }
    }

    /// Offset in the file of what is read next.
    pub(crate) fn offset(&self) -> u64 {
        self.base + self.at as u64
    }

    /// Goes to an offset of this part.
    pub(crate) fn go(&mut self, at: usize) -> &mut Self {
        self.at = at.min(self.bytes.len());
        self
    }

    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], EndOfFields> {
        let rest = &self.bytes[self.at..];
        let found = rest.get(..count).ok_or(EndOfFields(self.offset()))?;
        self.at += count;
        Ok(found)
    }

    /// Bytes up to a mark, which is left out and passed.
    pub(crate) fn until(&mut self, mark: u8) -> Result<&'a [u8], EndOfFields> {
        let rest = &self.bytes[self.at..];
        let count = rest.iter().position(|&b| b == mark).ok_or(EndOfFields(self.offset()))?;
        self.at += count + 1;
        Ok(&rest[..count])
    }

    /// Text in a field of so many bytes, up to its first zero, without spaces around it; bytes that are no UTF-8 are Latin-1.
    pub(crate) fn text(&mut self, count: usize) -> Result<String, EndOfFields> {
        let field = self.take(count)?;
        let field = field.split(|&b| b == 0).next().unwrap_or_default().trim_ascii();
        let latin = || field.iter().map(|&b| char::from(b)).collect();
        Ok(std::str::from_utf8(field).map_or_else(|_| latin(), str::to_owned))
    }

    /// A number of a type of at most four bytes, or of a double.
    pub(crate) fn number(&mut self, number: NumberType) -> Result<f64, EndOfFields> {
        let number = if self.little { number } else { number.big_endian() };
        let at = EndOfFields(self.offset());
        number.decode(self.take(number.bytes())?).map_err(|_| at)
    }

    pub(crate) fn u8(&mut self) -> Result<u8, EndOfFields> {
        Ok(self.take(1)?[0])
    }

    pub(crate) fn u16(&mut self) -> Result<u16, EndOfFields> {
        self.integer().map(|n| n as u16)
    }

    pub(crate) fn i16(&mut self) -> Result<i16, EndOfFields> {
        self.u16().map(u16::cast_signed)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, EndOfFields> {
        self.wide::<4>().map(|n| n as u32)
    }

    pub(crate) fn i32(&mut self) -> Result<i32, EndOfFields> {
        self.u32().map(u32::cast_signed)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, EndOfFields> {
        self.wide::<8>()
    }

    pub(crate) fn f32(&mut self) -> Result<f64, EndOfFields> {
        self.number(NumberType::F32)
    }

    pub(crate) fn f64(&mut self) -> Result<f64, EndOfFields> {
        self.number(NumberType::F64)
    }

    fn integer(&mut self) -> Result<u64, EndOfFields> {
        self.wide::<2>()
    }

    fn wide<const N: usize>(&mut self) -> Result<u64, EndOfFields> {
        let mut word = [0; 8];
        for (i, byte) in self.take(N)?.iter().enumerate() {
            word[if self.little { i } else { N - 1 - i }] = *byte;
        }
        Ok(u64::from_le_bytes(word))
    }
}
