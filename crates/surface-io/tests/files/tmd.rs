//! TMD files.

use super::Small;

pub fn files() -> Vec<Small> {
    let small = |name, comment: &[u8]| Small {
        name,
        bytes: file(comment),
        number: 0,
        shape: [3, 2],
        size: Some([1.5e-3, 1e-3]),
        heights: vec![1e-3, -2e-3, f64::NAN, 4e-3, 0.0, 0.25e-3],
        compressed: false,
    };
    vec![small("tmd", b"Created by TrueMap v6\r\n"), small("tmd without a comment", b"")]
}

fn file(comment: &[u8]) -> Vec<u8> {
    let shape = [3_u32, 2].map(u32::to_le_bytes).concat();
    let sides = [1.5_f32, 1.0, 7.0, 8.0].map(f32::to_le_bytes).concat();
    let heights = [1.0_f32, -2.0, f32::NAN, 4.0, 0.0, 0.25].map(f32::to_le_bytes).concat();
    [b"Binary TrueMap Data File v2.0\r\n\0", comment, b"\0", &shape, &sides, &heights].concat()
}
