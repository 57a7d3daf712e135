//! A file read from a place on, some bytes at a time.

use crate::error::{Error, Result};
use crate::fields::FixedLength;
use crate::number_type::ByteOrder;
use crate::source::OpenedFile;

/// Bytes of a file that a cursor reads at a time, and the longest name or text.
const WINDOW: u64 = 1 << 16;

/// A file read from an offset on, number by number and never beyond its end.
pub(crate) struct Cursor<'s, 'a> {
    pub(crate) source: &'s mut OpenedFile<'a>,
    order: ByteOrder,
    /// Offset of what is read next.
    pub(crate) at: u64,
    window: (u64, Vec<u8>),
}

impl<'s, 'a> Cursor<'s, 'a> {
    pub(crate) fn new(source: &'s mut OpenedFile<'a>, order: ByteOrder, at: u64) -> Self {
        Self { source, order, at, window: (0, Vec::new()) }
    }

    /// An error about what was read next.
    pub(crate) fn wrong(&self, expected: impl Into<String>) -> Error {
        self.source.wrong(self.at, expected)
    }

    /// The bytes from here on that are in memory, at least `least`.
    fn held(&mut self, least: u64) -> Result<&[u8]> {
        let (from, held) = (self.window.0, self.window.1.len() as u64);
        if self.at < from || self.at + least > from + held {
            let rest = self.source.length().saturating_sub(self.at);
            self.window = (self.at, self.source.bytes(self.at, WINDOW.min(rest).max(least))?);
        }
        Ok(&self.window.1[(self.at - self.window.0) as usize..])
    }

    /// The next bytes, 64 kB at most.
    pub(crate) fn take(&mut self, length: u64) -> Result<&[u8]> {
        if length > WINDOW {
            return Err(self.wrong("a shorter name or text"));
        }
        self.held(length)?;
        self.at += length;
        let end = (self.at - self.window.0) as usize;
        Ok(&self.window.1[end - length as usize..end])
    }

    /// The next number, text or row of them.
    pub(crate) fn get<T: FixedLength>(&mut self) -> Result<T> {
        let order = self.order;
        self.take(T::BYTES as u64).map(|bytes| T::decode(bytes, order))
    }

    /// Text up to its zero.
    pub(crate) fn name(&mut self) -> Result<String> {
        let zero = |bytes: &[u8]| bytes.iter().position(|&b| b == 0);
        let mut length = zero(self.held(1)?);
        if length.is_none() {
            // Not all of it is held.
            self.window = (0, Vec::new());
            length = zero(self.held(1)?);
        }
        let length = length.ok_or_else(|| self.wrong("a text that ends"))?;
        let text = String::from_utf8_lossy(self.take(length as u64)?).into_owned();
        self.at += 1;
        Ok(text)
    }

    /// Passes bytes that end before an offset.
    pub(crate) fn pass(&mut self, by: u64, end: u64) -> Result<()> {
        if end.saturating_sub(self.at) < by {
            return Err(
                self.wrong(format!("{by} bytes here, what they are part of ends at {end} (cut short?)"))
            );
        }
        self.at += by;
        Ok(())
    }
}
