//! Arrays whose axes no label names, and numbers whose scale stands elsewhere or nowhere.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

#[allow(dead_code)] // Other tests use the rest.
mod files;

use surface_io::{Axes, Preprocessing, ReadOptions, Scan, SurfaceFile};

fn small(name: &str) -> files::Small {
    files::all().into_iter().find(|file| file.name == name).unwrap()
}

/// Shape and heights of a channel as they stand, or why there are none.
fn read(name: &str, axes: Option<Axes>) -> Result<([usize; 2], Vec<Option<f64>>), String> {
    let file = small(name);
    let options = ReadOptions { axes, ..ReadOptions::default() };
    let scans = SurfaceFile::from_bytes("a", &file.bytes, &options).map_err(|e| e.to_string())?.scans();
    let scan = scans.into_iter().nth(file.number).unwrap().map_err(|e| e.to_string())?;
    let (rows, columns) = (scan.metadata().rows, scan.metadata().columns);
    let heights = (0..rows * columns).map(|i| scan.height(i / columns, i % columns)).collect();
    Ok(([columns, rows], heights))
}

#[test]
fn axes_without_names_are_chosen() {
    let of = |name: &str, usual: Axes, other: Axes| {
        let plain = read(name, None).unwrap();
        assert_eq!(read(name, Some(usual)).unwrap(), plain, "{name}");
        let ([columns, rows], heights) = plain;
        let (shape, turned) = read(name, Some(other)).unwrap();
        assert_eq!(shape, [rows, columns], "{name}");
        for (i, height) in heights.iter().enumerate() {
            assert_eq!(turned[i % columns * rows + i / columns], *height, "{name}, {i}");
        }
    };
    // In a contiguous layout, in chunks, of MATLAB and Zygo, packed.
    of("hdf5 of JPK", Axes::Xy, Axes::Yx);
    of("hdf5 packed", Axes::Xy, Axes::Yx);
    of("hdf5 of MATLAB", Axes::Xy, Axes::Yx);
    of("hdf5 of Zygo", Axes::Yx, Axes::Xy);
    of("mat", Axes::Yx, Axes::Xy);
    of("mat packed", Axes::Yx, Axes::Xy);
}

#[test]
fn axes_that_are_named_are_not_chosen() {
    // Labels say y, x.
    assert!(read("hdf5 in chunks", Some(Axes::Yx)).is_ok());
    let error = read("hdf5 in chunks", Some(Axes::Xy)).unwrap_err();
    assert_eq!(error, "a: axes: yx in the file, but xy");
    let error = read("netcdf of version 1", Some(Axes::Xy)).unwrap_err();
    assert_eq!(error, "a: axes: yx in the file, but xy");
    let error = read("gsf", Some(Axes::Xy)).unwrap_err();
    assert!(error.starts_with("a: axes was given: the format has one order of axes"), "{error}");
    let text = ReadOptions { axes: Some(Axes::Xy), ..ReadOptions::default() };
    let error = Scan::from_bytes("a.txt", b"1 2\n3 4\n", &text).unwrap_err().to_string();
    assert!(error.starts_with("a.txt: axes was given"), "{error}");
}

/// Dimensions `a`, `b` instead of `y`, `x`.
#[test]
fn dimensions_of_other_names_are_rows_and_columns() {
    let file = small("netcdf of version 1");
    let mut bytes = file.bytes.clone();
    let list = bytes.windows(4).position(|word| word == [0, 0, 0, 10]).unwrap();
    for (name, other) in [(b'x', b'a'), (b'y', b'b')] {
        let entry = [0, 0, 0, 1, name, 0, 0, 0];
        let at = list + bytes[list..].windows(8).position(|part| part == entry).unwrap();
        bytes[at + 4] = other;
    }
    let scan = |axes| {
        let options = ReadOptions { axes, ..ReadOptions::default() };
        Scan::from_bytes("a.nc", &bytes, &options).unwrap()
    };
    let (plain, turned) = (scan(None), scan(Some(Axes::Xy)));
    assert_eq!((plain.metadata().columns, plain.metadata().rows), (3, 2));
    assert_eq!((turned.metadata().columns, turned.height(2, 1)), (2, plain.height(1, 2)));
}

/// Integers in nm: whether a count is 1 nm, nothing says.
#[test]
fn integers_are_no_lengths_without_a_scale() {
    let bytes = small("hdf5 of counts").bytes;
    let options = |height_scale: Option<&str>| ReadOptions {
        channel: "b".parse().ok(),
        height_scale: height_scale.map(|scale| scale.parse().unwrap()),
        cell: "1 um".parse().ok(),
        ..ReadOptions::default()
    };
    let plain = Scan::from_bytes("a.h5", &bytes, &options(None)).unwrap();
    assert_eq!(plain.metadata().unit, None);
    let error = plain.map(&Preprocessing::default()).unwrap_err().to_string();
    assert!(
        error.contains("the file has int16 in nm and no scale: a count need not be 1 nm, height_scale says"),
        "{error}"
    );
    let scaled = Scan::from_bytes("a.h5", &bytes, &options(Some("0.5 nm"))).unwrap();
    let map = scaled.map(&Preprocessing::default()).unwrap();
    for (height, expected) in map.heights().iter().zip([1.0, 3.0, 2.0, 4.0]) {
        assert!((height / (expected * 0.5e-9) - 1.0).abs() < 1e-15, "{height}");
    }
}

/// A data set that cannot be read is in the list with its reason, and keeps no other from being read.
#[test]
fn unreadable_data_sets_are_listed() {
    let bytes = small("hdf5 of counts").bytes;
    let error = Scan::from_bytes("a.h5", &bytes, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("2 channels of the file have heights"), "{error}");
    assert!(
        error.contains("2 c (not read: HDF5, offset 0: expected one number as the attribute scale_factor)")
    );
    let error =
        Scan::from_bytes("a.mat", &small("mat").bytes, &ReadOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("complex (not read: MATLAB, offset ") && error.contains("real numbers"),
        "{error}"
    );
}

/// A small file with other bytes from an offset on.
fn changed(name: &str, at: usize, to: &[u8]) -> Vec<u8> {
    let mut bytes = small(name).bytes;
    bytes[at..at + to.len()].copy_from_slice(to);
    bytes
}

/// A small file with four bytes behind its end.
fn longer(name: &str) -> Vec<u8> {
    [small(name).bytes, vec![0; 4]].concat()
}

/// A small file with other bytes in the place of the first ones that are `from`.
fn replaced(name: &str, from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut bytes = small(name).bytes;
    let at = bytes.windows(from.len()).position(|part| part == from).unwrap();
    bytes.splice(at..at + from.len(), to.iter().copied());
    bytes
}

/// One byte makes another map: contradictions between header and length, versions and types that are not
/// read.
#[test]
fn contradictions_are_told_with_their_place() {
    for (bytes, expected) in [
        (longer("tmd"), "TMD (TrueMap), offset 80: expected 24 bytes up to the end of the file, found 28"),
        (changed("tmd", 56, &[2]), "TMD (TrueMap), offset 80: expected 16 bytes up to the end of the file"),
        (
            longer("nms"),
            "NMS (Nanofocus), offset 3468: expected 18 bytes up to the end of the file, found 22",
        ),
        (changed("nms", 0, &[3]), "NMS (Nanofocus), offset 0: expected a map of uint16 (2, 1), found 3, 1"),
        (changed("nms", 12, &[100, 0]), "NMS (Nanofocus), offset 3468: expected a factor other than 0"),
        (longer("gsf"), "GSF (Gwyddion simple field), offset 112: expected 24 bytes up to the end"),
        (
            replaced("gsf", b"XRes = 3", b"XRes = z"),
            "GSF (Gwyddion simple field), offset 26: expected a whole number as xres, found \"z\"",
        ),
        (longer("bcr"), "BCR-STM (Image Metrology), offset 2048: expected 12 bytes up to the end"),
        (
            replaced("bcr", b"bit2nm", b"bit2no"),
            "BCR-STM (Image Metrology), offset 0: expected the height of a count as bit2nm, found nothing",
        ),
        (
            replaced("bcr", b"bcrstm\n", b"bcrunk\n"),
            "BCR-STM (Image Metrology), offset 0: expected bcrstm or bcrf",
        ),
        (changed("frt", 15, b"2"), "FRT (MicroProf), offset 12: expected version 1.00 or 1.01"),
        (
            replaced("frt", &[3, 0, 0, 0, 2, 0, 0, 0, 16], &[3, 0, 0, 0, 2, 0, 0, 0, 12]),
            "FRT (MicroProf), offset 39: expected 16 or 32 bits a number, found 12",
        ),
        (
            replaced("frt", &[3, 0, 0, 0, 2, 0, 0, 0, 16], &[3, 0, 0, 0, 3, 0, 0, 0, 16]),
            "FRT (MicroProf), offset 117: expected a block of 3 x 3 numbers of 16 bits, found 12 bytes",
        ),
        (
            replaced("opdx of a line", b"\x0b\x03", b"\x0b\x04"),
            "OPDx (Dektak), offset 167: expected 3 points as in Array, found 4",
        ),
        (
            replaced("opdx of a line", &0.5_f64.to_le_bytes(), &0.6_f64.to_le_bytes()),
            "OPDx (Dektak), offset 137: expected places every 5e-1 \u{b5}m, found 0.6",
        ),
        (
            changed("mat of bytes in the other order", 167, &[1]),
            "MATLAB, offset 128: expected 2 x 1 numbers of 1 bytes, found 4 bytes",
        ),
    ] {
        let found = match SurfaceFile::from_bytes("a", &bytes, &ReadOptions::default()) {
            Err(error) => error.to_string(),
            Ok(file) => file.scans().find_map(Result::err).unwrap().to_string(),
        };
        assert!(found.starts_with(&format!("a: {expected}")), "{found}\n{expected}");
    }
}
