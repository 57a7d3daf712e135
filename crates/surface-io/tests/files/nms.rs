//! NMS files.

use super::Small;

pub fn files() -> Vec<Small> {
    let small = |name, intensities: Option<[u8; 6]>| Small {
        name,
        bytes: file(intensities),
        number: 0,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        // The first number of the range is 100, the last 300: -1 to 3 um.
        heights: [-1.0, 3.0, 1.0, -0.98, f64::NAN, -3.0]
            .map(|um: f64| if um.is_nan() && intensities.is_none() { -1.0e-6 } else { um * 1e-6 })
            .to_vec(),
        compressed: false,
    };
    vec![small("nms", Some([1, 255, 7, 9, 0, 3])), small("nms without intensities", None)]
}

fn file(intensities: Option<[u8; 6]>) -> Vec<u8> {
    let mut bytes = vec![0; 3468];
    let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
    for (at, n) in [(0, 2_u32), (4, 1), (8, 100), (12, 300), (1368, 3), (1372, 2)] {
        put(at, &n.to_le_bytes());
    }
    for (at, n) in [(16, -1.0_f64), (24, 3.0), (1376, 1000.0), (1384, 500.0)] {
        put(at, &n.to_le_bytes());
    }
    put(32, b"OM_MS_2.0");
    put(52, b"Confocal Height Image");
    put(1416, &[u8::from(intensities.is_some())]);
    bytes.extend([100_u16, 300, 200, 101, 100, 0].map(u16::to_le_bytes).concat());
    bytes.extend(intensities.into_iter().flatten());
    bytes
}
