//! Packed numbers: deflate with and without the header of zlib.

use crate::error::{ContentError, Result};
use crate::source::OpenedFile;
use flate2::read::{DeflateDecoder, ZlibDecoder};
use std::io::Read;

/// Largest compression ratio: deflate packs at most this number of bytes into one. The other compressions
/// that are read stay below it for measured maps.
pub(crate) const RATIO: u64 = 1032;
const END: u64 = 64;

/// How bytes are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    /// Not at all.
    Stored,
    /// Deflate.
    Deflate,
    /// Deflate in a stream of zlib.
    Zlib,
}

/// Bytes of a file and what they unpack to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Packed {
    pub(crate) packing: Packing,
    pub(crate) offset: u64,
    /// Bytes in the file.
    pub(crate) length: u64,
    /// Bytes unpacked, as the file claims.
    pub(crate) unpacked: u64,
}

impl Packed {
    /// An error where the file ends too early or the bytes cannot unpack to as many as claimed; called before
    /// anything is allocated.
    pub(crate) fn check(self, source: &OpenedFile<'_>) -> Result<()> {
        let Self { packing, offset, length, unpacked } = self;
        if offset.checked_add(length).is_none_or(|end| end > source.length()) {
            let expected =
                format!("{length} packed bytes here, the file ends at {} (cut short?)", source.length());
            return Err(source.wrong(offset, expected));
        }
        let most = match packing {
            Packing::Stored => length,
            Packing::Deflate | Packing::Zlib => length.saturating_mul(RATIO).saturating_add(END),
        };
        if unpacked > most {
            let expected = format!("{length} bytes to unpack to at most {most}, not {unpacked}");
            return Err(source.wrong(offset, expected));
        }
        Ok(())
    }

    /// Appends the unpacked bytes.
    pub(crate) fn unpack(self, source: &mut OpenedFile<'_>, into: &mut Vec<u8>) -> Result<()> {
        self.check(source)?;
        let Self { packing, offset, length, unpacked } = self;
        let before = into.len();
        let refused = |_| ContentError::Memory { bytes: unpacked.into() };
        into.try_reserve_exact(unpacked as usize).map_err(refused).map_err(|e| source.content(e))?;
        let part = source.part(offset, length)?;
        let read = match packing {
            Packing::Stored => part.take(unpacked).read_to_end(into),
            Packing::Deflate => DeflateDecoder::new(part).take(unpacked).read_to_end(into),
            Packing::Zlib => ZlibDecoder::new(part).take(unpacked).read_to_end(into),
        };
        let found = (into.len() - before) as u64;
        let expected = match read {
            Err(error) => format!("packed bytes that can be unpacked ({error})"),
            Ok(_) if found < unpacked => format!("{unpacked} bytes unpacked, found {found}"),
            Ok(_) => return Ok(()),
        };
        Err(source.wrong(offset, expected))
    }
}
