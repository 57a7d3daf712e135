//! MetroPro files.

use super::Small;

const COUNTS: [i32; 6] = [1, -2, 2_147_483_640, 32768, 0, -32768];

pub fn files() -> Vec<Small> {
    let small = |name, format: u8, resolution: i16, cell: f32, count: f64| Small {
        name,
        bytes: file(format, resolution, cell),
        number: 0,
        shape: [3, 2],
        size: (cell > 0.0).then(|| [3.0 * f64::from(cell), 2.0 * f64::from(cell)]),
        heights: COUNTS.map(|n| if n > 1 << 30 { f64::NAN } else { f64::from(n) * count }).to_vec(),
        compressed: false,
    };
    // Interference 1/2, obliquity 1, wavelength 2^-20 m.
    let count = 0.5 * 2_f64.powi(-20);
    vec![
        small("metropro", 1, 1, 1e-6, count / 32768.0),
        small("metropro of the second format", 2, 2, 1e-6, count / 131_072.0),
        small("metropro of 4096 bytes, without a size", 3, 0, 0.0, count / 4096.0),
    ]
}

fn file(format: u8, resolution: i16, cell: f32) -> Vec<u8> {
    let length = if format == 3 { 4096 } else { 834 };
    let mut bytes = vec![0; length];
    let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
    put(0, &[0x88, 0x1b, 0x03, 0x6e + format, 0, format]);
    put(6, &(length as u32).to_be_bytes());
    // Intensities: 2 x 1 points in one bucket.
    for (at, n) in [(52, 2_u16), (54, 1), (56, 1), (68, 3), (70, 2)] {
        put(at, &n.to_be_bytes());
    }
    for (at, n) in [(60, 4_u32), (72, 24)] {
        put(at, &n.to_be_bytes());
    }
    for (at, x) in [(164, 0.5_f32), (168, 2_f32.powi(-20)), (176, 1.0), (184, cell)] {
        put(at, &x.to_be_bytes());
    }
    put(218, &resolution.to_be_bytes());
    bytes.extend([1, 2, 3, 4]);
    bytes.extend(COUNTS.iter().flat_map(|n| n.to_be_bytes()));
    bytes
}
