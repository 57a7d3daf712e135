//! Zip archives, as far as X3P needs them: members that are stored or deflated, below 4 GB
//! (APPNOTE.TXT of PKWARE, <https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT>).
//!
//! Own code: `zip` 9.8 reserves memory for as many members as a file claims before it reads one of them,
//! bounded by the claimed size of the directory and not by the file.

use crate::error::{ContentError, Result};
use crate::fields::{ByteFields, header};
use crate::format::EXPORT;
use crate::inflate::{Packed, Packing};
use crate::number_type::ByteOrder;
use crate::source::OpenedFile;
use flate2::Crc;

pub(crate) const MAGIC: &[u8] = b"PK\x03\x04";
const DIRECTORY: [u8; 4] = *b"PK\x01\x02";
const END: &[u8] = b"PK\x05\x06";
/// Bytes of a member's own header, of its entry in the directory and of the end, without names.
const HEADER: u64 = 30;
const ENTRY: u64 = 46;
const TAIL: u64 = 22;
/// The end has a comment of at most 65535 bytes behind it.
const LONGEST_COMMENT: u64 = 0xffff;

/// One file in an archive.
#[derive(Debug, Clone)]
pub(crate) struct Member {
    pub(crate) name: String,
    entry: ZipEntry,
}

/// The members by the directory at the end of the file.
pub(crate) fn members(source: &mut OpenedFile<'_>) -> Result<Vec<Member>> {
    let length = source.length();
    let tail = length.min(TAIL + LONGEST_COMMENT);
    let bytes = source.bytes(length - tail, tail)?;
    let Some(end) = bytes.windows(END.len()).rposition(|window| window == END) else {
        return Err(source.wrong(length, "the directory of the archive before this (cut short?)"));
    };
    let at = length - tail + end as u64;
    let mut fields = ByteFields::new(source.subject().clone(), ByteOrder::Little, length - tail, bytes);
    let (count, size, offset): (u16, u32, u32) = (fields.go(end + 10).get()?, fields.get()?, fields.get()?);
    let (size, offset) = (u64::from(size), u64::from(offset));
    if offset + size > at {
        let expected =
            format!("a directory before this, not to {} (or an archive beyond 4 GB)", offset + size);
        return Err(source.wrong(at, expected));
    }
    let mut fields = source.fields(ByteOrder::Little, offset, size)?;
    (0..count).map(|_| entry(&mut fields)).collect()
}

header! {
    /// An entry of the directory.
    struct ZipEntry {
        magic: [u8; 4] = 0,
        flags: u16 = 8,
        method: u16 = 10,
        checksum: u32 = 16,
        packed: u32 = 20,
        unpacked: u32 = 24,
        /// Bytes of the name, of what is behind it, and of a comment.
        behind: [u16; 3] = 28,
        offset: u32 = 42,
    }
}

/// One entry of the directory.
fn entry(fields: &mut ByteFields<'_>) -> Result<Member> {
    let wrong = fields.wrong("an entry of the directory of the archive");
    let entry = ZipEntry::of(&mut ByteFields::of_start(ByteOrder::Little, fields.take(ENTRY as usize)?))?;
    if entry.magic != DIRECTORY {
        return Err(wrong);
    }
    let [name, extra, comment] = entry.behind.map(usize::from);
    let name = String::from_utf8_lossy(fields.take(name)?).replace('\\', "/");
    fields.take(extra + comment)?;
    Ok(Member { name, entry })
}

impl Member {
    /// Bytes unpacked, as the directory claims.
    pub(crate) fn unpacked(&self) -> u64 {
        self.entry.unpacked.into()
    }

    /// Offset of its own header.
    pub(crate) fn offset(&self) -> u64 {
        self.entry.offset.into()
    }

    /// Where its bytes are; an error where they cannot be all there.
    pub(crate) fn packed(&self, source: &mut OpenedFile<'_>) -> Result<Packed> {
        let packing = match (self.entry.method, self.entry.flags & 1 == 1) {
            (0, false) => Packing::Stored,
            (8, false) => Packing::Deflate,
            _ => {
                let expected = "a member that is stored or deflated, without a password";
                return Err(source.wrong(self.offset(), expected));
            }
        };
        let header = source.bytes(self.offset(), HEADER)?;
        let behind: [u16; 2] = source.get(ByteOrder::Little, self.offset() + 26)?;
        let behind: u64 = behind.map(u64::from).iter().sum();
        if !header.starts_with(MAGIC) {
            return Err(source.wrong(self.offset(), "the header of a member"));
        }
        let offset = self.offset() + HEADER + behind;
        let packed = Packed { packing, offset, length: self.entry.packed.into(), unpacked: self.unpacked() };
        packed.check(source)?;
        Ok(packed)
    }

    /// Its text, whose checksum is right: what is no UTF-8 is a question mark. An error where it is longer
    /// than `most` bytes, before it is unpacked.
    pub(crate) fn unpack_text(&self, source: &mut OpenedFile<'_>, most: u64) -> Result<String> {
        if self.unpacked() > most {
            let expected = format!("{} of at most {most} bytes, it has {}", self.name, self.unpacked());
            return Err(source.wrong(self.offset(), expected));
        }
        Ok(text_in_place(self.unpack(source)?))
    }

    /// Its bytes, whose checksum is right.
    pub(crate) fn unpack(&self, source: &mut OpenedFile<'_>) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.packed(source)?.unpack(source, &mut bytes)?;
        let mut sum = Crc::new();
        sum.update(&bytes);
        if sum.sum() != self.entry.checksum {
            let expected = format!("{} with the checksum of the directory (damaged)", self.name);
            return Err(source.wrong(self.offset(), shortened(&expected, 120)));
        }
        Ok(bytes)
    }
}

/// Bytes as text without a copy of them.
fn text_in_place(mut bytes: Vec<u8>) -> String {
    let mut right = 0;
    while let Err(error) = std::str::from_utf8(&bytes[right..]) {
        right += error.valid_up_to();
        let wrong = error.error_len().unwrap_or(bytes.len() - right);
        bytes[right..right + wrong].fill(b'?');
        right += wrong;
    }
    // Now it is.
    String::from_utf8(bytes).unwrap_or_default()
}

/// The error for an archive without a file of heights that is known.
pub(crate) fn refused(members: &[Member]) -> ContentError {
    const SHOWN: usize = 8;
    const SHEET: &str = "save the sheet as CSV";
    for (member, what, remedy) in [
        ("header.properties", "a JPK file (in an archive)", EXPORT),
        ("index.xml", "a PLUX file of Sensofar", EXPORT),
        ("xl/workbook.xml", "a workbook of Excel (XLSX)", SHEET),
        ("content.xml", "a document of LibreOffice (ODS)", SHEET),
        ("word/document.xml", "a document of Word", "save the numbers as text"),
    ] {
        if members.iter().any(|m| m.name == member) {
            return ContentError::Foreign { what, remedy };
        }
    }
    let mut names: Vec<String> = members.iter().take(SHOWN).map(|m| shortened(&m.name, 64)).collect();
    if members.len() > SHOWN {
        names.push(format!("{} more", members.len() - SHOWN));
    }
    let members = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    ContentError::Archive { members }
}

fn shortened(text: &str, most: usize) -> String {
    text.chars().filter(|c| !c.is_control()).take(most).collect()
}

/// An archive of stored members; `None` where it would be 4 GB or longer.
pub(crate) fn archive(members: &[(&str, Vec<u8>)]) -> Option<Vec<u8>> {
    // 1 January 1980, the first day that archives know: the same map gives the same bytes.
    const DAY: u32 = 0x21 << 16;
    let total: usize = members.iter().map(|(name, bytes)| bytes.len() + 2 * name.len() + 76).sum();
    u32::try_from(total + TAIL as usize).ok()?;
    let (mut archive, mut directory) = (Vec::with_capacity(total + TAIL as usize), Vec::new());
    for (name, bytes) in members {
        let mut sum = Crc::new();
        sum.update(bytes);
        // Version 2.0 reads it; no flags, stored.
        let mut about = [20_u16, 0, 0].map(u16::to_le_bytes).concat();
        let length = bytes.len() as u32;
        about.extend([DAY, sum.sum(), length, length].map(u32::to_le_bytes).concat());
        about.extend([name.len() as u16, 0].map(u16::to_le_bytes).concat());
        directory.extend([&DIRECTORY[..], &20_u16.to_le_bytes(), &about, &[0; 10]].concat());
        directory.extend((archive.len() as u32).to_le_bytes());
        directory.extend(name.bytes());
        archive.extend([MAGIC, &about, name.as_bytes()].concat());
        archive.extend(bytes);
    }
    let (offset, size, count) = (archive.len() as u32, directory.len() as u32, members.len() as u16);
    archive.extend(directory);
    archive.extend([END, &[0; 4], &[count; 2].map(u16::to_le_bytes).concat()].concat());
    archive.extend([size, offset].map(u32::to_le_bytes).concat());
    archive.extend([0; 2]);
    Some(archive)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_become_text_where_they_are() {
        let text = |bytes: &[u8]| text_in_place(bytes.to_vec());
        assert_eq!(text("µm".as_bytes()), "µm");
        assert_eq!(text(b"a\xb5m\xff\xfe \xe2\x82"), "a?m?? ??");
        assert_eq!(text(b""), "");
    }
}
