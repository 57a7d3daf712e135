//! Containers of ISO 25178-72.

use super::Small;
use flate2::{Compression, Crc, write::DeflateEncoder};
use std::io::Write;

const LINKED: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";
const MASKED: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink>\
                      <ValidPointsLink>bindata\\valid.bin</ValidPointsLink></DataLink>";
const LISTED: &str = "<DataList><Datum>5</Datum><Datum>1;-7</Datum><Datum/><Datum> 0 </Datum><Datum>3e2</Datum><Datum>-1</Datum></DataList>";

pub fn files() -> Vec<Small> {
    [files_of_floats(), files_of_integers()].concat()
}

fn small(name: &'static str, bytes: Vec<u8>, heights: Vec<f64>) -> Small {
    Small { name, bytes, number: 0, shape: [3, 2], size: Some([3e-6, 1e-6]), heights, compressed: true }
}

fn files_of_floats() -> Vec<Small> {
    let nan = f64::NAN;
    let floats = [1.5_f32, -2.0, f32::NAN, 1e3, 0.0, 4.0].map(f32::to_le_bytes).concat();
    let doubles = [1.5e-9, -2e-9, nan, 1e-6, 0.0, 4e-9].map(f64::to_le_bytes).concat();
    let of_doubles = main("D", "", LINKED).into_bytes();
    let of_floats = main("F", "<Increment>1e-9</Increment>", LINKED).into_bytes();
    vec![
        small(
            "x3p",
            zip(&[("main.xml", of_doubles), ("bindata/data.bin", doubles)], false),
            vec![1.5e-9, -2e-9, nan, 1e-6, 0.0, 4e-9],
        ),
        small(
            "x3p of floats packed",
            zip(&[("bindata/data.bin", floats), ("main.xml", of_floats)], true),
            // An increment beside floats: whether it counts is not known.
            vec![1.5, -2.0, nan, 1e3, 0.0, 4.0],
        ),
    ]
}

fn files_of_integers() -> Vec<Small> {
    let nan = f64::NAN;
    let of_16_bits = [5, -7, 0, 0, 300, -1].map(i16::to_le_bytes).concat();
    let of_32_bits = [5, -7, 0, 0, 70_000, -1].map(i32::to_le_bytes).concat();
    let of = |kind: &str, z: &str, data: &str| main(kind, z, data).into_bytes();
    // The third point is undefined.
    let valid = vec![0b1111_1011];
    vec![
        small(
            "x3p of integers in a folder, with a mask and an offset",
            zip(
                &[
                    ("a/main.xml", of("I", "<Increment>2e-9</Increment><Offset>1e-8</Offset>", MASKED)),
                    ("a/bindata/data.bin", of_16_bits),
                    ("a/bindata/valid.bin", valid.clone()),
                ],
                true,
            ),
            vec![20e-9, -4e-9, nan, 10e-9, 610e-9, 8e-9],
        ),
        small(
            "x3p of wide integers",
            zip(
                &[
                    ("main.xml", of("L", "<Increment>1E-009</Increment>", MASKED)),
                    ("bindata/data.bin", of_32_bits),
                    ("bindata/valid.bin", valid),
                ],
                false,
            ),
            vec![5e-9, -7e-9, nan, 0.0, 70_000e-9, -1e-9],
        ),
        small(
            "x3p as text",
            zip(&[("main.xml", of("I", "<Increment>1e-9</Increment>", LISTED))], true),
            vec![5e-9, -7e-9, nan, 0.0, 300e-9, -1e-9],
        ),
    ]
}

/// Descriptions with numbers elsewhere and in them.
pub fn descriptions() -> [String; 2] {
    let masked =
        "<DataLink><PointDataLink>data.bin</PointDataLink><ValidPointsLink>b</ValidPointsLink></DataLink>";
    let listed = "<DataList><Datum>5</Datum><Datum>-7</Datum><Datum/><Datum>0</Datum><Datum>3</Datum><Datum>1</Datum></DataList>";
    [main("F", "<Increment>1e-9</Increment>", masked), main("I", "", listed)]
}

/// A file with this description.
pub fn described(main: &[u8], packed: bool) -> Vec<u8> {
    zip(&[("main.xml", main.to_vec()), ("data.bin", vec![1; 24]), ("b", vec![0x2f])], packed)
}

/// Cells of 1 um x 0.5 um.
fn main(kind: &str, z: &str, data: &str) -> String {
    format!(
        "\u{feff}<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- a comment -->\n<p:ISO5436_2 xmlns:p=\"a\">\
         <Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>\
         <CX><AxisType>I</AxisType><DataType>L</DataType><Increment>1.0e-6</Increment><Offset>7</Offset></CX>\
         <CY><AxisType>I</AxisType><Increment>5e-007</Increment></CY>\
         <CZ><AxisType>A</AxisType><DataType>{kind}</DataType>{z}</CZ></Axes></Record1>\
         <Record3><MatrixDimension><SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ></MatrixDimension>{data}</Record3>\
         <Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4></p:ISO5436_2>"
    )
}

/// An archive of these members.
pub fn zip(members: &[(&str, Vec<u8>)], packed: bool) -> Vec<u8> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in members {
        let mut sum = Crc::new();
        sum.update(bytes);
        let data = if packed {
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        } else {
            bytes.clone()
        };
        let method = if packed { 8_u16 } else { 0 };
        let mut about = [20, 0, method, 0, 33].map(u16::to_le_bytes).concat();
        about.extend([sum.sum(), data.len() as u32, bytes.len() as u32].map(u32::to_le_bytes).concat());
        about.extend((name.len() as u16).to_le_bytes());
        let offset = (archive.len() as u32).to_le_bytes();
        // An extra field of four bytes in the directory, none before the data.
        directory.extend([b"PK\x01\x02", &[20, 0][..], &about, &[4, 0], &[0; 10], &offset].concat());
        directory.extend([name.as_bytes(), &[0xfe, 0xca, 0, 0]].concat());
        archive.extend([b"PK\x03\x04", &about[..], &[0, 0], name.as_bytes(), &data].concat());
    }
    let (offset, size, count) = (archive.len() as u32, directory.len() as u32, members.len() as u16);
    archive.extend(directory);
    archive.extend([b"PK\x05\x06", &[0; 4][..], &[count; 2].map(u16::to_le_bytes).concat()].concat());
    archive.extend([size, offset].map(u32::to_le_bytes).concat());
    // A comment.
    archive.extend(b"\x03\0abc");
    archive
}
