//! AL3D files.

use super::Small;

/// Heights of three columns, padded to four numbers a row.
const HEIGHTS: [f32; 6] = [1e-6, -2.5e-6, 3e-6, 4e-6, f32::NAN, 5e-6];

pub fn files() -> Vec<Small> {
    let heights = HEIGHTS.map(f64::from).to_vec();
    let small = |name, mark: &str, heights: Vec<f64>, stored: &[f32]| Small {
        name,
        bytes: file(mark, stored),
        number: 0,
        shape: [3, 2],
        size: Some([1.5e-6, 5e-7]),
        heights,
        compressed: false,
    };
    let mut marked = heights.clone();
    marked[0] = f64::NAN;
    let mut stored = HEIGHTS;
    stored[0] = -9999.9;
    vec![small("al3d", "NaN", heights, &HEIGHTS), small("al3d with a mark", "-9999.9", marked, &stored)]
}

fn file(mark: &str, heights: &[f32]) -> Vec<u8> {
    let tag = |key: &str, value: &str| {
        let mut bytes = vec![0; 52];
        bytes[..key.len()].copy_from_slice(key.as_bytes());
        bytes[20..20 + value.len()].copy_from_slice(value.as_bytes());
        bytes[50..].copy_from_slice(b"\r\n");
        bytes
    };
    let tags = [
        ("Version", "1"),
        ("TagCount", "6"),
        ("Cols", "3"),
        ("Rows", "2"),
        ("PixelSizeXMeter", "5e-7"),
        ("PixelSizeYMeter", "2.5e-7"),
        ("InvalidPixelValue", mark),
        ("DepthImageOffset", "800"),
    ];
    let mut bytes = b"AliconaImaging\0\r\n".to_vec();
    bytes.extend(tags.iter().flat_map(|(key, value)| tag(key, value)));
    bytes.resize(800, b' ');
    for row in heights.chunks(3) {
        bytes.extend(row.iter().chain([&7.0]).flat_map(|h| h.to_le_bytes()));
    }
    bytes
}
