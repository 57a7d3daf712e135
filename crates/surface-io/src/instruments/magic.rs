//! Recognition of the formats that are features, with and without their readers.

use crate::zip::{self, Member};

/// The first bytes of HDF5.
pub(super) const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// The beginning of TIFF and of its kind for more than 4 GB, in either byte order.
const TIFF: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];
/// The member of an X3P file that describes the others.
pub(super) const MAIN: &str = "main.xml";

/// Other programs put up to 512 bytes of their own before the file (MATLAB).
pub(super) fn is_hdf5(start: &[u8], _length: u64) -> bool {
    start.starts_with(HDF5) || start.get(512..).is_some_and(|s| s.starts_with(HDF5))
}

pub(super) fn is_tiff(start: &[u8], _length: u64) -> bool {
    TIFF.iter().any(|magic| start.starts_with(magic))
}

/// Every archive: its members tell whether it is an X3P file.
pub(super) fn is_archive(start: &[u8], _length: u64) -> bool {
    start.starts_with(zip::MAGIC)
}

/// The member of an X3P file that describes the others; archives that were packed by hand have everything in
/// one folder.
pub(super) fn main_member(members: &[Member]) -> Option<&Member> {
    let in_folder = |m: &&Member| m.name.split_once('/').is_some_and(|(_, name)| name == MAIN);
    members.iter().find(|m| m.name == MAIN).or_else(|| members.iter().find(in_folder))
}
