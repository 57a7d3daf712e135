//! Headers of binary files: numbers and texts at offsets, as an instrument's manual lists them.

use crate::error::{Error, Result};
use crate::number_type::{ByteOrder, NumberType};
use crate::subject::Subject;
use std::borrow::Cow;
use std::ops::Deref;
use std::path::Path;

/// A part of a file that is in memory, read number by number and never beyond its end.
pub(crate) struct ByteFields<'a> {
    subject: Subject,
    order: ByteOrder,
    bytes: Cow<'a, [u8]>,
    /// Where the part begins in the file.
    base: u64,
    at: usize,
}

/// What stands in a header with a length of its own.
pub(crate) trait FixedLength: Sized {
    const BYTES: usize;

    fn decode(bytes: &[u8], order: ByteOrder) -> Self;
}

macro_rules! stored_numbers {
    ($($number:ty),*) => {$(
        impl FixedLength for $number {
            const BYTES: usize = size_of::<$number>();

            fn decode(bytes: &[u8], order: ByteOrder) -> Self {
                let mut own = [0; size_of::<$number>()];
                own.copy_from_slice(bytes);
                match order {
                    ByteOrder::Little => <$number>::from_le_bytes(own),
                    ByteOrder::Big => <$number>::from_be_bytes(own),
                }
            }
        }
    )*};
}

stored_numbers!(u8, i8, u16, i16, u32, i32, u64, i64, f32, f64);

impl<T: FixedLength, const N: usize> FixedLength for [T; N] {
    const BYTES: usize = N * T::BYTES;

    fn decode(bytes: &[u8], order: ByteOrder) -> Self {
        std::array::from_fn(|i| T::decode(&bytes[i * T::BYTES..(i + 1) * T::BYTES], order))
    }
}

/// Text in a field of N bytes, up to its first zero, without spaces around it.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Text<const N: usize>(String);

impl<const N: usize> FixedLength for Text<N> {
    const BYTES: usize = N;

    fn decode(bytes: &[u8], _: ByteOrder) -> Self {
        Self(terminated(bytes))
    }
}

impl<const N: usize> Deref for Text<N> {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

/// Text of N units of UTF-16, up to its first zero, without spaces around it.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Wide<const N: usize>(String);

impl<const N: usize> FixedLength for Wide<N> {
    const BYTES: usize = 2 * N;

    fn decode(bytes: &[u8], order: ByteOrder) -> Self {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|unit| u16::decode(unit, order)).collect();
        let text = String::from_utf16_lossy(units.split(|&unit| unit == 0).next().unwrap_or_default());
        Self(text.trim().to_owned())
    }
}

impl<const N: usize> Deref for Wide<N> {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

/// UTF-8, or else Latin-1, whose bytes are the first 256 characters.
pub(crate) fn decoded(bytes: &[u8]) -> String {
    let latin = || bytes.iter().map(|&b| char::from(b)).collect();
    std::str::from_utf8(bytes).map_or_else(|_| latin(), str::to_owned)
}

/// The text up to its first zero, without spaces around it.
fn terminated(bytes: &[u8]) -> String {
    decoded(bytes.split(|&b| b == 0).next().unwrap_or_default().trim_ascii())
}

/// Declares a header: each field with its type and its offset, read by `of`.
macro_rules! header {
    ($(#[$about:meta])* struct $name:ident { $($(#[$doc:meta])* $field:ident: $type:ty = $at:expr,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq)]
        struct $name { $($(#[$doc])* $field: $type,)* }

        impl $name {
            /// Reads the fields at their offsets from where this part of the file begins.
            fn of(fields: &mut $crate::fields::ByteFields<'_>) -> $crate::error::Result<Self> {
                Ok(Self { $($field: fields.go($at).get()?,)* })
            }
        }
    };
}
pub(crate) use header;

impl<'a> ByteFields<'a> {
    pub(crate) fn new(
        subject: Subject,
        order: ByteOrder,
        base: u64,
        bytes: impl Into<Cow<'a, [u8]>>,
    ) -> Self {
        Self { subject, order, bytes: bytes.into(), base, at: 0 }
    }

    /// Bytes of a file that may be another one.
    pub(crate) fn of_start(order: ByteOrder, bytes: &'a [u8]) -> Self {
        Self::new(Subject::new(Path::new(""), None), order, 0, bytes)
    }

    /// Offset in the file of what is read next.
    pub(crate) fn offset(&self) -> u64 {
        self.base + self.at as u64
    }

    /// Which byte of a number comes first.
    pub(crate) fn order(&self) -> ByteOrder {
        self.order
    }

    /// Offset in this part of what is read next.
    pub(crate) fn place(&self) -> usize {
        self.at
    }

    /// Bytes that are left.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Goes to an offset of this part.
    pub(crate) fn go(&mut self, at: usize) -> &mut Self {
        self.at = at.min(self.bytes.len());
        self
    }

    fn short(&self) -> Error {
        self.wrong("more of the header (cut short?)")
    }

    /// An error about what was read next.
    pub(crate) fn wrong(&self, expected: impl Into<String>) -> Error {
        self.subject.wrong(self.offset(), expected)
    }

    pub(crate) fn take(&mut self, count: usize) -> Result<&[u8]> {
        if count > self.left() {
            return Err(self.short());
        }
        self.at += count;
        Ok(&self.bytes[self.at - count..self.at])
    }

    /// The next number, text or row of them.
    pub(crate) fn get<T: FixedLength>(&mut self) -> Result<T> {
        let order = self.order;
        self.take(T::BYTES).map(|bytes| T::decode(bytes, order))
    }

    /// Text in a field of `count` bytes, up to its first zero, without spaces around it.
    pub(crate) fn text(&mut self, count: usize) -> Result<String> {
        self.take(count).map(terminated)
    }

    /// A number of a type; an integer that no double holds is an error.
    pub(crate) fn number(&mut self, number: NumberType) -> Result<f64> {
        let number = if self.order == ByteOrder::Little { number } else { number.big_endian() };
        let subject = self.subject.clone();
        let at = self.offset();
        number
            .decode(self.take(number.bytes())?)
            .map_err(|_| subject.wrong(at, "an integer that a double holds"))
    }
}
