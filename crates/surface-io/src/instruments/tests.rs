//! Notes of channels.

#![cfg(all(feature = "hdf5", feature = "tiff", feature = "x3p"))]
#![allow(clippy::unwrap_used)] // Tests, as a whole.

use super::{READERS, mat, opdx};
use crate::channel::StoredChannel;
use crate::source::OpenedFile;
use std::io::Cursor;
use std::path::Path;

fn channels(bytes: &[u8]) -> Vec<StoredChannel> {
    let mut source = OpenedFile::new(Path::new("a"), Cursor::new(bytes), bytes.len() as u64);
    let reader = READERS.iter().find(|reader| (reader.recognises)(bytes, bytes.len() as u64)).unwrap();
    source.read_as(Some(reader.format));
    (reader.channels)(&mut source).unwrap()
}

fn notes(channel: &StoredChannel) -> String {
    channel.notes.join("; ")
}

#[test]
fn what_is_assumed_or_not_used_is_noted() {
    let counts = channels(include_bytes!("../../tests/files/hdf5/counts.h5"));
    let said: Vec<String> = counts.iter().map(notes).collect();
    assert!(
        said[0].starts_with("the first index is taken for x (as SurfaceTopography and MATLAB write it"),
        "{}",
        said[0]
    );
    assert!(
        said[0].contains("axes = \"yx\" takes the other; heights by encoder.scaling of the group: 1.5e-15")
    );
    assert!(said[1].contains("the file has int16 in nm and no scale"), "{}", said[1]);
    let zygo = channels(include_bytes!("../../tests/files/hdf5/fringes.datx"));
    let said = notes(&zygo[0]);
    assert!(said.starts_with("the first index is taken for y (as prysm"), "{said}");
    assert!(said.ends_with("sides of a cell in X Converter and Y Converter, which are not read"), "{said}");
    let matlab = channels(include_bytes!("../../tests/files/mat/scipy.mat"));
    assert_eq!(
        notes(&matlab[0]),
        "the first index is taken for y (MATLAB draws rows along y); axes = \"xy\" takes the other"
    );
    // The labels y and x.
    let labelled = channels(include_bytes!("../../tests/files/hdf5/chunks.h5"));
    assert_eq!(notes(&labelled[1]), "");
}

/// No file is recognised by its first words alone.
#[test]
fn beginnings_of_other_versions_are_not_taken() {
    let mut header = b"MATLAB 5.0 MAT-file, Platform: nt".to_vec();
    header.resize(128, b' ');
    assert!(!(mat::READER.recognises)(&header, 128));
    header[124..].copy_from_slice(b"\x00\x02IM");
    assert!(!(mat::READER.recognises)(&header, 128));
    assert!(!(opdx::READER.recognises)(b"VCA DATA\x02\x00\x00\x55", 12));
}
