//! The bytes of a file, read at the places that its header names and never beyond its end.

use crate::error::{ContentError, Error, Result};
use crate::fields::{ByteFields, FixedLength};
use crate::format::Format;
use crate::number_type::ByteOrder;
use crate::subject::Subject;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom, Take};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What files and byte arrays can both do.
pub(crate) trait Input: Read + Seek {
    /// The same bytes without a lifetime, for readers of other crates that keep what they read from: a second
    /// handle of a file, a copy of bytes. The place in a file is shared with the one that it comes from, so
    /// that both go to an offset before they read.
    fn detached(&self) -> std::io::Result<Box<dyn OwnInput>>;
}

impl Input for BufReader<File> {
    fn detached(&self) -> std::io::Result<Box<dyn OwnInput>> {
        Ok(Box::new(BufReader::new(self.get_ref().try_clone()?)))
    }
}

impl Input for Cursor<&[u8]> {
    fn detached(&self) -> std::io::Result<Box<dyn OwnInput>> {
        Ok(Box::new(Cursor::new(self.get_ref().to_vec())))
    }
}

/// An input of its own.
pub(crate) trait OwnInput: Read + Seek + Send + Sync {}

impl<T: Read + Seek + Send + Sync> OwnInput for T {}

/// An input of its own with a limit of the bytes that it gives in all: a file may name the same bytes a
/// thousand times, and all of them would be kept in memory.
pub(crate) struct Detached {
    input: Box<dyn OwnInput>,
    budget: Budget,
}

/// Bytes that may still be read; 0 after a request for more.
#[derive(Debug, Clone)]
pub(crate) struct Budget(Arc<AtomicU64>);

impl Budget {
    pub(crate) fn new(bytes: u64) -> Self {
        Self(Arc::new(AtomicU64::new(bytes)))
    }

    /// Whether more was requested than is left.
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
        let read = self.input.read(buffer)?;
        self.budget.0.store(left - read as u64, Ordering::Relaxed);
        Ok(read)
    }
}

impl Seek for Detached {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.input.seek(to)
    }
}

/// An opened file of a known length.
pub(crate) struct OpenedFile<'a> {
    input: Box<dyn Input + 'a>,
    subject: Subject,
    length: u64,
}

impl<'a> OpenedFile<'a> {
    pub(crate) fn new(path: &Path, input: impl Input + 'a, length: u64) -> Self {
        Self { input: Box::new(input), subject: Subject::new(path, None), length }
    }

    /// Takes the file as one of this format.
    pub(crate) fn read_as(&mut self, format: Option<Format>) {
        self.subject = Subject::new(self.path(), format);
    }

    pub(crate) fn subject(&self) -> &Subject {
        &self.subject
    }

    pub(crate) fn path(&self) -> &Path {
        self.subject.path()
    }

    /// Bytes of the file.
    pub(crate) fn length(&self) -> u64 {
        self.length
    }

    /// The first bytes, at most `most`: fewer in a shorter file.
    pub(crate) fn start(&mut self, most: u64) -> Result<Vec<u8>> {
        self.read(0, self.length.min(most))
    }

    /// `count` bytes from an offset on; an error where the file is shorter, before anything is allocated.
    pub(crate) fn bytes(&mut self, offset: u64, count: u64) -> Result<Vec<u8>> {
        if offset.checked_add(count).is_none_or(|end| end > self.length) {
            let expected = format!("{count} bytes here, the file ends at {} (cut short?)", self.length);
            return Err(self.wrong(offset, expected));
        }
        self.read(offset, count)
    }

    /// An error where `count` bytes from an offset on are not the rest of the file.
    pub(crate) fn ends(&self, offset: u64, count: u64) -> Result<()> {
        let rest = self.length.saturating_sub(offset);
        if rest == count {
            return Ok(());
        }
        Err(self.wrong(offset, format!("{count} bytes up to the end of the file, found {rest}")))
    }

    /// The same as numbers of one byte order.
    pub(crate) fn fields(
        &mut self,
        order: ByteOrder,
        offset: u64,
        count: u64,
    ) -> Result<ByteFields<'static>> {
        Ok(ByteFields::new(self.subject.clone(), order, offset, self.bytes(offset, count)?))
    }

    /// A number or text, or several of one type, from an offset on.
    pub(crate) fn get<T: FixedLength>(&mut self, order: ByteOrder, offset: u64) -> Result<T> {
        self.fields(order, offset, T::BYTES as u64)?.get()
    }

    fn read(&mut self, offset: u64, count: u64) -> Result<Vec<u8>> {
        let mut bytes = self.room(count as usize)?;
        bytes.resize(count as usize, 0);
        self.fill(offset, &mut bytes)?;
        Ok(bytes)
    }

    /// An empty list with room for `count` numbers.
    pub(crate) fn room<T>(&self, count: usize) -> Result<Vec<T>> {
        let mut list = Vec::new();
        let bytes = size_of::<T>() as u128 * count as u128;
        list.try_reserve_exact(count).map_err(|_| self.content(ContentError::Memory { bytes }))?;
        Ok(list)
    }

    /// An error where there are no rows or no columns.
    pub(crate) fn check_cells(&self, [rows, columns]: [usize; 2]) -> Result<()> {
        if rows > 0 && columns > 0 {
            return Ok(());
        }
        Err(self.content(ContentError::NoCells { rows: rows as u64, columns: columns as u64 }))
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
            read => read.map_err(Error::system("read", self.path())),
        }
    }

    /// The whole input from its beginning, for readers of other crates.
    pub(crate) fn whole(&mut self) -> Result<&mut (dyn Input + 'a)> {
        self.input.seek(SeekFrom::Start(0)).map_err(Error::system("read", self.subject.path()))?;
        Ok(&mut *self.input)
    }

    /// The input without its lifetime, for readers of other crates that keep it.
    pub(crate) fn detached(&self, budget: &Budget) -> Result<Detached> {
        let input = self.input.detached().map_err(Error::system("read", self.path()))?;
        Ok(Detached { input, budget: budget.clone() })
    }

    /// A part of the input, for readers of other crates; the caller has compared its end with
    /// [`OpenedFile::length`].
    pub(crate) fn part(&mut self, offset: u64, length: u64) -> Result<Take<&mut (dyn Input + 'a)>> {
        self.input.seek(SeekFrom::Start(offset)).map_err(Error::system("read", self.subject.path()))?;
        Ok((&mut *self.input as &mut (dyn Input + 'a)).take(length))
    }

    /// An error about this file.
    pub(crate) fn content(&self, problem: ContentError) -> Error {
        self.subject.content(problem)
    }

    /// An error about what stands at an offset of a binary file.
    pub(crate) fn wrong(&self, offset: u64, expected: impl Into<String>) -> Error {
        self.subject.wrong(offset, expected)
    }
}
