//! What a container states about its arrays is used, or reported. Its files are those of other programs:
//! `files/containers/make.py` writes most of them.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use surface_io::{Axes, Metadata, Quantity, ReadOptions, Scan, SurfaceFile};

/// The heights of [`file`] as `make.py` has them, row by row.
const HEIGHTS: [f64; 12] = [1.3, 2.9, 2.2, 4.1, 0.7, 5.2, 3.3, 1.8, 2.4, 0.2, 6.1, 3.7];

fn file(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/tests/files/containers/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn read_with(name: &str, options: &ReadOptions) -> surface_io::Result<Scan> {
    Scan::from_bytes(name, &file(name), options)
}

fn read(name: &str) -> Scan {
    read_with(name, &ReadOptions::default()).unwrap()
}

fn heights(scan: &Scan) -> Vec<f64> {
    let Metadata { rows, columns, .. } = *scan.metadata();
    (0..rows * columns).map(|i| scan.height(i / columns, i % columns).unwrap_or(f64::NAN)).collect()
}

/// Whether a scan of 3 rows of 4 has these heights times a factor, to the digits of float32.
#[track_caller]
fn holds(scan: &Scan, expected: &[f64], factor: f64) {
    assert_eq!((scan.metadata().rows, scan.metadata().columns), (3, 4));
    let found = heights(scan);
    for (found, expected) in found.iter().zip(expected.iter().map(|h| h * factor)) {
        let same = (found - expected).abs() <= 1e-7 * expected.abs();
        assert!(same || (found.is_nan() && expected.is_nan()), "{found} {expected}");
    }
}

fn holed() -> [f64; 12] {
    let mut heights = HEIGHTS;
    heights[6] = f64::NAN;
    heights
}

#[test]
fn marks_are_compared_as_the_numbers_are_stored() {
    for name in
        ["nodata-34.tif", "nodata-9999.9.tif", "nodata-15-digits.tif", "double-fill.h5", "double-missing.nc"]
    {
        holds(&read(name), &holed(), 1.0);
    }
    let grid =
        "ncols 2\nnrows 2\ncellsize 1\nNODATA_value -3.402823466385289e+38\n1 -3.40282346638529e+38\n2 3\n";
    let scan = Scan::from_bytes("a.asc", grid.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!((scan.metadata().undefined, scan.height(0, 1)), (1, None));
}

#[test]
fn the_mark_that_a_note_proposes_makes_points_undefined() {
    let scale = ReadOptions { height_scale: "0.3 nm".parse().ok(), ..ReadOptions::default() };
    for options in [ReadOptions::default(), scale] {
        let scan = read_with("undeclared.tif", &options).unwrap();
        let note = &scan.metadata().notes[0];
        let mark = note.split_once("missing = ").unwrap().1.split(' ').next().unwrap();
        assert_eq!(mark, "-9999.900390625", "{note}");
        // As it is stored, and as people write it.
        for mark in [mark, "-9999.9"] {
            let options = ReadOptions { missing: mark.parse().ok(), ..options.clone() };
            let scan = read_with("undeclared.tif", &options).unwrap();
            let factor = if options.height_scale.is_some() { 0.3e-9 } else { 1.0 };
            holds(&scan, &holed(), factor);
            assert!(scan.metadata().notes.is_empty());
        }
    }
    // A neighbour of the mark is a height.
    let next = f64::from(f32::from_bits((-9999.9_f32).to_bits() - 1));
    let options = ReadOptions { missing: Some(next), ..ReadOptions::default() };
    assert_eq!(read_with("undeclared.tif", &options).unwrap().metadata().undefined, 0);
}

fn sides(scan: &Scan) -> Option<[f64; 2]> {
    scan.metadata().cell.as_ref().map(|cell| cell.value.map(Quantity::value))
}

#[track_caller]
fn noted(scan: &Scan, words: &str) {
    let notes = &scan.metadata().notes;
    assert!(notes.iter().any(|note| note.contains(words)), "{words}: {notes:?}");
}

#[track_caller]
fn refused(name: &str, words: &str) {
    let error = read_with(name, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains(words), "{error}");
}

#[test]
fn names_of_dimensions_decide_the_order() {
    holds(&read("nc4-yx.nc"), &HEIGHTS, 1e-6);
    holds(&read("xy.nc"), &HEIGHTS, 1.0);
    let other = ReadOptions { axes: Some(Axes::Xy), ..ReadOptions::default() };
    let error = read_with("nc4-yx.nc", &other).unwrap_err().to_string();
    assert!(error.contains("axes: yx in the file, but xy"), "{error}");
    refused("time.nc", "found time and x");
}

#[test]
fn coordinates_give_the_size_and_the_direction() {
    let near = |scan: &Scan, cell: [f64; 2]| {
        let found = sides(scan).unwrap();
        assert!((0..2).all(|i| (found[i] / cell[i] - 1.0).abs() < 1e-6), "{found:?}");
    };
    let scan = read("nc4-yx.nc");
    near(&scan, [1e-6, 2e-6]);
    noted(&scan, "sides along x by its coordinates, 0 to 3e-6 m");
    // Without the numbers of NetCDF-4, by the lengths.
    let scan = read("scales.h5");
    holds(&scan, &HEIGHTS, 1.0);
    near(&scan, [2e-6, 2e-6]);
    // Of a square no length says it.
    noted(&read("scales-square.h5"), "scales of dimensions of one length are not told apart");
    let down: Vec<f64> = HEIGHTS.chunks(4).rev().flatten().copied().collect();
    for name in ["descending.nc", "descending-3.nc"] {
        let scan = read(name);
        holds(&scan, &down, 1.0);
        near(&scan, [1.0, 2.0]);
        noted(&scan, "lat descends in the file");
    }
    for (name, words) in [("degrees.nc", "degrees_north, which are no length"), ("plain.nc", "have no unit")]
    {
        let scan = read(name);
        holds(&scan, &HEIGHTS, 1.0);
        assert_eq!(sides(&scan), None);
        noted(&scan, words);
        let cell = ReadOptions { cell: "1 um".parse().ok(), ..ReadOptions::default() };
        near(&read_with(name, &cell).unwrap(), [1e-6, 1e-6]);
    }
    for name in ["uneven.nc", "uneven-3.nc"] {
        refused(name, "coordinates y in equal steps, number 1 is 2");
    }
    let other = ReadOptions { cell: "1 um".parse().ok(), ..ReadOptions::default() };
    assert!(read_with("nc4-yx.nc", &other).is_err());
}

#[test]
fn integers_are_unsigned_where_the_file_says_so() {
    let counts = [1.0, 2.0, 3.0, 4.0, 400.0, 500.0, 600.0, f64::NAN, 327.67, 327.68, 0.07, 0.09];
    holds(&read("nc4-unsigned.nc"), &counts, 1e-8);
    let scan = read("unsigned-3.nc");
    holds(&scan, &counts, 10.0);
    noted(&scan, "int16 are uint16");
}

#[test]
fn numbers_outside_of_the_valid_range_are_undefined() {
    let valid = [1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0, f64::NAN, 8.0, 9.0, 10.0, 11.0, 100.0];
    for name in ["valid-range.nc", "valid-ends-3.nc"] {
        holds(&read(name), &valid, 0.5);
    }
    for name in ["valid-three.nc", "valid-three-3.nc"] {
        refused(name, "two numbers as valid_range");
    }
    for name in ["unsigned-word.nc", "unsigned-word-3.nc"] {
        refused(name, "true or false as _Unsigned, found \"yes\"");
    }
}

#[test]
fn variables_of_netcdf_3_have_any_name() {
    holds(&read("nc3-z.nc"), &HEIGHTS, 1.0);
    refused("line.nc", "its variables are profile (x)");
}

#[test]
fn statements_of_a_tiff_are_used_or_reported() {
    holds(&read("mask-page.tif"), &holed(), 1.0);
    holds(&read("mask-tiles.tif"), &holed(), 1.0);
    let found = heights(&read("scale-offset.tif"));
    assert!(found.iter().zip(HEIGHTS).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    noted(&read("geotiff-utm.tif"), "pixels of 10 x 5");
    let scan = read("metres.tif");
    assert_eq!((sides(&scan), scan.metadata().unit.is_some()), (Some([10.0, 5.0]), true));
    // The image of less resolution is no second map.
    holds(&read("overview.tif"), &HEIGHTS, 1.0);
    refused("wrong-scale.tif", "a number as scale of GDAL's metadata, found \"two\"");
    refused("mask-packed.tif", "found 1 bits and compression 32773");
    noted(&read("no-number.tif"), "marks undefined points by \"none\"");
}

#[test]
fn images_of_a_lext_file_are_what_their_names_say() {
    let scan = read("pages.lext");
    assert_eq!(scan.metadata().name.as_deref(), Some("HEIGHT"));
    assert_eq!(scan.metadata().unit.as_ref().map(|unit| unit.value.to_string()).as_deref(), Some("m"));
    let cell = sides(&scan).unwrap();
    assert!(cell.iter().all(|side| (side / 0.25e-6 - 1.0).abs() < 1e-12), "{cell:?}");
}

#[test]
fn frames_of_a_scan_are_channels_and_indices_are_none() {
    let name = "jpk-two-frames.h5-jpk";
    let bytes = file(name);
    let scans = SurfaceFile::from_bytes(name, &bytes, &ReadOptions::default()).unwrap().scans();
    let scans: Vec<Scan> = scans.map(Result::unwrap).collect();
    let (maps, others): (Vec<&Scan>, Vec<&Scan>) =
        scans.iter().partition(|scan| scan.metadata().no_heights.is_none());
    assert_eq!((maps.len(), others.len()), (2, 2));
    holds(maps[0], &HEIGHTS, 1e-8);
    for scan in maps {
        assert_eq!(scan.metadata().size.map(|size| size.map(Quantity::value)), Some([2e-6, 1.5e-6]));
    }
    refused(name, "2 channels of the file have heights");
    refused(
        "volume.h5",
        "the data sets are line (3), stack (2 x 3 x 4); of three dimensions write one map alone",
    );
}

#[test]
fn damaged_containers_do_not_panic() {
    let directory = format!("{}/tests/files/containers", env!("CARGO_MANIFEST_DIR"));
    for entry in std::fs::read_dir(directory).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let whole = file(&name);
        for i in 0..300 {
            let mut bytes = whole.clone();
            // Places far apart and, in turn, several values; at last shorter and shorter files.
            let at = (i * 7919) % bytes.len();
            match i % 4 {
                0 => bytes[at] = 0xff,
                1 => bytes[at] = bytes[at].wrapping_add(1),
                2 => bytes[at] = 0,
                _ => bytes.truncate(at),
            }
            if let Ok(read) = SurfaceFile::from_bytes(&name, &bytes, &ReadOptions::default()) {
                read.scans().for_each(drop);
            }
        }
    }
}
