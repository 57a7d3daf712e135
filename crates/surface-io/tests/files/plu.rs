//! PLu files.

use super::Small;

pub fn files() -> Vec<Small> {
    let layer = [1.0_f32, -2.0, 1_000_001.0, 4.0, 0.0, 0.25];
    let heights =
        |factor: f64| layer.map(|h| if h > 1e6 { f64::NAN } else { f64::from(h) * factor * 1e-6 }).to_vec();
    let small = |name, number, layers, pictures| Small {
        name,
        bytes: file(&layer, layers, pictures),
        number,
        shape: [3, 2],
        size: Some([1.5e-6, 2e-6]),
        heights: heights(1.0),
        compressed: false,
    };
    vec![
        small("plu", 0, 1, 1),
        small("plu of two layers", 1, 2, 0),
        small("plu of two layers and a picture", 0, 2, 1),
    ]
}

fn file(heights: &[f32], layers: u8, pictures: u8) -> Vec<u8> {
    let mut bytes = vec![0; 500];
    let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
    put(0, b"Monday, 01 February 2010");
    for (at, n) in [(388, 2_u32), (392, 3), (428, 3)] {
        put(at, &n.to_le_bytes());
    }
    put(404, &0.5_f32.to_le_bytes());
    put(408, &1_f32.to_le_bytes());
    put(489, &[layers]);
    put(492, &[pictures]);
    for _ in 0..layers {
        bytes.extend([2_u32, 3].iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend(heights.iter().flat_map(|h| h.to_le_bytes()));
        bytes.extend([0; 8]);
        bytes.extend(vec![0x7f; 18 * usize::from(pictures)]);
    }
    bytes
}
