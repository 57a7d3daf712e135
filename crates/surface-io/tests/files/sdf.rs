//! Surface data files of ISO 25178-71.

use super::Small;

pub fn files() -> Vec<Small> {
    let small = |name, bytes, heights| Small {
        name,
        bytes,
        number: 0,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        heights,
        compressed: false,
    };
    let nan = f64::NAN;
    let of_16_bits = [5, -7, i16::MIN, 0, i16::MAX, 1].map(i16::to_le_bytes).concat();
    let floats = [1.5_f32, -2.0, f32::MIN, 1e3, 0.0, 4.0].map(f32::to_le_bytes).concat();
    // Of BCR: the first profile has the largest y, the largest number is undefined.
    let doubles = [1e3, nan, 4.0, 1.5, -2.0, f64::MAX].map(f64::to_le_bytes).concat();
    let text = "aISO-1.0\r\nManufacID = Tester\r\n; a comment = 3\r\nCreateDate = 010120260000\r\nNumPoints = 3\r\n\
                NumProfiles = 2\r\nXscale = 1.0E-6\r\nYscale = 5e-7\r\nZscale = 1e-9\r\nZresolution = -1\r\n\
                Compression = 0\r\nDataType = 7\r\nCheckType = 0\r\n*\r\n1.5 -2 BAD\r\n1e3\r\n0 4\r\n*\r\n\
                <PartName>none</PartName>\r\n*";
    let mut micromap =
        small("sdf as text with scales elsewhere", text.replace("Tester", "Micromap").into(), vec![]);
    micromap.size = None;
    let of_integers = text.replace("DataType = 7", "DataType = 5").replace("1e3", "-32768");
    vec![
        small("sdf", binary(b"bISO-1.0", 5, &of_16_bits), vec![5e-9, -7e-9, nan, 0.0, 32767e-9, 1e-9]),
        small("sdf of doubles", binary(b"bBCR-0.0", 7, &doubles), vec![1.5e-9, -2e-9, nan, 1e-6, nan, 4e-9]),
        small("sdf of version 2", binary(b"bISO-2.0", 3, &floats), vec![1.5e-9, -2e-9, nan, 1e-6, 0.0, 4e-9]),
        small("sdf as text", text.into(), vec![1.5e-9, -2e-9, nan, 1e-6, 0.0, 4e-9]),
        small("sdf of integers as text", of_integers.into(), vec![1.5e-9, -2e-9, nan, nan, 0.0, 4e-9]),
        micromap,
    ]
}

/// Cells of 1 um x 0.5 um, heights in nm.
fn binary(magic: &[u8], kind: u8, numbers: &[u8]) -> Vec<u8> {
    let scales = [1e-6, 0.5e-6, 1e-9, -1.0].map(f64::to_le_bytes).concat();
    let wide = magic == b"bISO-2.0";
    let count = if wide { vec![3, 0, 0, 0, 2, 0, 0, 0] } else { vec![3, 0, 2, 0] };
    [magic, b"Tester    ", b"010120260000", b"010120260000", &count, &scales, &[0, kind, 0], numbers].concat()
}
