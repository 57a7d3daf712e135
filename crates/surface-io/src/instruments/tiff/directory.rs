//! Directories of a TIFF file, read before its images: their bounds, and private tags of instruments.

use crate::error::Result;
use crate::number_type::{ByteOrder, NumberType};
use crate::source::OpenedFile;

/// Images in one file that are looked at.
pub(super) const MOST: usize = 1000;

/// The entries of each image, and the byte order.
pub(super) struct Directories {
    order: ByteOrder,
    images: Vec<Vec<DirectoryEntry>>,
}

/// An entry: where its values are.
struct DirectoryEntry {
    tag: u16,
    kind: u16,
    at: u64,
    length: u64,
}

/// Types of numbers by their codes.
const TYPES: [&str; 13] = ["", "u1", "", "u2", "u4", "", "i1", "", "i2", "i4", "", "f4", "f8"];

/// Longest private text that is read, in bytes.
const LONGEST: u64 = 256;

impl Directories {
    /// Refuses lists and texts that reach beyond the end of the file, for which the other crate reserves up
    /// to 4 MB unasked.
    pub(super) fn read(source: &mut OpenedFile<'_>) -> Result<Self> {
        let start = source.bytes(0, 8)?;
        let (big, large) = (start.starts_with(b"MM"), start[2] == 43 || start[3] == 43);
        // Bytes of an entry, of the value in it, of a count of entries, and where the first offset stands.
        let (entry, held, counted, first) = if large { (20, 8, 8, 8) } else { (12, 4, 2, 4) };
        let number = |bytes: &[u8]| {
            let digit = |n: u64, &byte: &u8| n << 8 | u64::from(byte);
            if big { bytes.iter().fold(0, digit) } else { bytes.iter().rev().fold(0, digit) }
        };
        let order = if big { ByteOrder::Big } else { ByteOrder::Little };
        let mut found = Self { order, images: Vec::new() };
        let mut at = number(&source.bytes(first, held)?);
        while at != 0 && found.images.len() < MOST {
            let entries = number(&source.bytes(at, counted)?);
            let expected = || format!("{entries} entries of {entry} bytes here (cut short?)");
            let length = entries.checked_mul(entry).filter(|length| *length <= source.length());
            let length = length.ok_or_else(|| source.wrong(at, expected()))?;
            let directory = source.bytes(at + counted, length)?;
            let mut image = Vec::new();
            for (i, one) in directory.chunks_exact(entry as usize).enumerate() {
                let [tag, kind] = [0, 2].map(|from| number(&one[from..from + 2]) as u16);
                let size = match kind {
                    3 | 8 => 2,
                    4 | 9 | 11 | 13 => 4,
                    5 | 10 | 12 | 16..=18 => 8,
                    _ => 1,
                };
                let (count, value) = one[4..].split_at(held as usize);
                let length = number(count).checked_mul(size);
                let inside = at + counted + i as u64 * entry + 4 + held;
                let values = if length.is_some_and(|length| length <= held) { inside } else { number(value) };
                let end = length.and_then(|length| values.checked_add(length));
                let Some(length) = length.filter(|_| end.is_some_and(|end| end <= source.length())) else {
                    return Err(source.wrong(at, format!("the values of tag {tag} inside the file")));
                };
                image.push(DirectoryEntry { tag, kind, at: values, length });
            }
            found.images.push(image);
            at = number(&source.bytes(at + counted + length, held)?);
        }
        Ok(found)
    }

    fn entry(&self, image: usize, tag: u16) -> Option<&DirectoryEntry> {
        self.images.get(image)?.iter().find(|entry| entry.tag == tag)
    }

    /// Offset and length of the bytes of a tag.
    pub(super) fn bytes(&self, image: usize, tag: u16) -> Option<(u64, u64)> {
        self.entry(image, tag).map(|entry| (entry.at, entry.length))
    }

    /// The text of a tag, where it is one that is not long.
    pub(super) fn text(&self, source: &mut OpenedFile<'_>, image: usize, tag: u16) -> Result<Option<String>> {
        let Some(entry) = self.entry(image, tag).filter(|e| e.kind == 2 && e.length <= LONGEST) else {
            return Ok(None);
        };
        source.fields(self.order, entry.at, entry.length)?.text(entry.length as usize).map(Some)
    }

    /// All whole numbers of a tag.
    pub(super) fn whole(&self, source: &mut OpenedFile<'_>, image: usize, tag: u16) -> Result<Vec<u64>> {
        let Some(entry) = self.entry(image, tag) else { return Ok(Vec::new()) };
        let size = match entry.kind {
            3 => 2,
            4 | 13 => 4,
            16 | 18 => 8,
            _ => return Ok(Vec::new()),
        };
        let bytes = source.bytes(entry.at, entry.length)?;
        let digit = |n: u64, &byte: &u8| n << 8 | u64::from(byte);
        let number = |bytes: &[u8]| match self.order {
            ByteOrder::Big => bytes.iter().fold(0, digit),
            ByteOrder::Little => bytes.iter().rev().fold(0, digit),
        };
        Ok(bytes.chunks_exact(size).map(number).collect())
    }

    /// The first number of a tag, where it is finite.
    pub(super) fn number(&self, source: &mut OpenedFile<'_>, image: usize, tag: u16) -> Result<Option<f64>> {
        let Some(entry) = self.entry(image, tag) else { return Ok(None) };
        let Some(number) = NumberType::of_code(entry.kind.into(), &TYPES, ByteOrder::Little) else {
            return Ok(None);
        };
        let size = number.bytes() as u64;
        if entry.length < size {
            return Ok(None);
        }
        let found = source.fields(self.order, entry.at, size)?.number(number)?;
        Ok(Some(found).filter(|found| found.is_finite()))
    }
}
