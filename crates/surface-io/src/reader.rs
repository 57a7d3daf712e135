//! The reader that each format of an instrument or a program provides.

use crate::channel::StoredChannel;
use crate::error::Result;
use crate::format::Format;
use crate::source::OpenedFile;

/// Number of bytes at the beginning of a file by which its format is recognised.
pub(crate) const SNIFF: u64 = 1024;

/// A reader of one binary format.
pub(crate) struct Reader {
    pub(crate) format: Format,
    /// Whether a file of this length that begins so is one; the beginning has [`SNIFF`] bytes, or the whole
    /// of a shorter file.
    pub(crate) recognises: fn(start: &[u8], length: u64) -> bool,
    /// The channels by the headers of the file; heights are read later.
    pub(crate) channels: fn(&mut OpenedFile<'_>) -> Result<Vec<StoredChannel>>,
}
