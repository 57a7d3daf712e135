//! Directories of a TIFF file, read before its images.

use super::MOST;
use crate::error::Result;
use crate::source::Source;

/// An entry of a directory.
pub(super) struct Entry {
    pub(super) tag: u64,
    /// Offset and length of its values, where they do not stand in the entry.
    pub(super) values: (u64, u64),
}

/// Refuses lists and texts that reach beyond the end of the file, for which the other crate reserves up to 4 MB unasked; entries of the
/// first directory.
pub(super) fn check(source: &mut Source<'_>) -> Result<Vec<Entry>> {
    let start = source.bytes(0, 8)?;
    let (big, large) = (start.starts_with(b"MM"), start[2] == 43 || start[3] == 43);
    // Bytes of an entry, of the value in it, of a count of entries, and where the first offset stands.
    let (entry, held, counted, first) = if large { (20, 8, 8, 8) } else { (12, 4, 2, 4) };
    let number = |bytes: &[u8]| {
        let digit = |n: u64, &byte: &u8| n << 8 | u64::from(byte);
        if big { bytes.iter().fold(0, digit) } else { bytes.iter().rev().fold(0, digit) }
    };
    let mut found = Vec::new();
    let mut at = number(&source.bytes(first, held)?);
    for image in 0..MOST {
        if at == 0 {
            break;
        }
        let entries = number(&source.bytes(at, counted)?);
        let expected = || format!("{entries} entries of {entry} bytes here (cut short?)");
        let length = entries.checked_mul(entry).filter(|length| *length <= source.length());
        let length = length.ok_or_else(|| source.wrong(at, expected()))?;
        let directory = source.bytes(at + counted, length)?;
        for one in directory.chunks_exact(entry as usize) {
            let size = match number(&one[2..4]) {
                3 | 8 => 2,
                4 | 9 | 11 | 13 => 4,
                5 | 10 | 12 | 16..=18 => 8,
                _ => 1,
            };
            let (count, value) = one[4..].split_at(held as usize);
            let (tag, value) = (number(&one[..2]), number(value));
            let length = number(count).checked_mul(size);
            let end =
                length.and_then(|length| if length <= held { Some(0) } else { value.checked_add(length) });
            let Some((length, _)) = length.zip(end.filter(|end| *end <= source.length())) else {
                return Err(source.wrong(at, format!("the values of tag {tag} inside the file")));
            };
            if image == 0 {
                found.push(Entry { tag, values: (value, length) });
            }
        }
        at = number(&source.bytes(at + counted + length, held)?);
    }
    Ok(found)
}
