//! Files of Digital Surf.

use super::Small;
use flate2::{Compression, write::ZlibEncoder};
use std::io::Write;

const SURFACE: u16 = 2;
const SURFACE_WITH_INTENSITY: u16 = 11;

pub fn files() -> Vec<Small> {
    let nan = f64::NAN;
    let small = |name, bytes, number, heights, compressed| Small {
        name,
        bytes,
        number,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        heights,
        compressed,
    };
    // -12 is the lowest number less 2.
    let of_32_bits = [-10, 5, -12, 0, 70_000, 1].map(i32::to_le_bytes).concat();
    let of_16_bits = [-10, 5, -12, 0, 300, 1].map(i16::to_le_bytes).concat();
    let plain = [&object(b"DIGITAL SURF", SURFACE, 32, "nm", 4)[..], b"abcdefg", &of_32_bits].concat();
    let heights = vec![-3e-9, 4.5e-9, nan, 2e-9, 35_002e-9, 2.5e-9];
    // Two streams, cut inside a number.
    let (first, second) = (zlib(&of_16_bits[..5]), zlib(&of_16_bits[5..]));
    let directory = [2, 5, first.len(), 7, second.len()].map(|n| (n as u32).to_le_bytes()).concat();
    let packed = [&directory[..], &first, &second].concat();
    let mut head = object(b"DSCOMPRESSED", SURFACE_WITH_INTENSITY, 16, "nm", 1);
    // Two channels.
    head[80] = 2;
    let intensity =
        [&object(b"DIGITAL SURF", SURFACE_WITH_INTENSITY, 16, "", 1)[..], b"abcdefg", &of_16_bits].concat();
    let two = [&head[..], b"abcdefg", &packed, &intensity].concat();
    let of_two = vec![-3e-9, 4.5e-9, nan, 2e-9, 152e-9, 2.5e-9];
    let values = vec![-3.0, 4.5, nan, 2.0, 152.0, 2.5];
    vec![
        small("sur", plain, 0, heights, false),
        small("sur compressed", two.clone(), 0, of_two, true),
        small("sur with an intensity", two, 1, values, true),
    ]
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// A header with three columns of 1 um and two rows of 0.5 um; a height is half the number, and 2.
fn object(magic: &[u8], kind: u16, bits: u16, unit: &str, comment: u16) -> Vec<u8> {
    let mut bytes = vec![0; 512];
    let mut put = |at: usize, what: &[u8]| bytes[at..at + what.len()].copy_from_slice(what);
    put(0, magic);
    put(14, &1_u16.to_le_bytes());
    put(16, &1_u16.to_le_bytes());
    put(18, &kind.to_le_bytes());
    // There are undefined points.
    put(86, &1_u16.to_le_bytes());
    put(98, &bits.to_le_bytes());
    put(100, &[-10, 70_000, 3, 2, 6].map(i32::to_le_bytes).concat());
    put(120, &[1_f32, 0.5, 0.5].map(f32::to_le_bytes).concat());
    put(164, b"Height");
    put(180, b"\xb5m");
    put(196, b"um");
    put(212, unit.as_bytes());
    put(334, &comment.to_le_bytes());
    put(336, &(7 - comment).to_le_bytes());
    put(474, &2_f32.to_le_bytes());
    bytes
}
