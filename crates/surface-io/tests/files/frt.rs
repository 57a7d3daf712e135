//! FRT files.

use super::Small;

pub fn files() -> Vec<Small> {
    let small = |name, bytes, first: f64| Small {
        name,
        bytes,
        number: 0,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        // The first row of the file is the last one.
        heights: [0.0, 2000.0, 10.0, first, 20.0, f64::NAN].map(|n: f64| n * 1e-9).to_vec(),
        compressed: false,
    };
    let of_16 = [7_u16, 20, 1, 0, 2000, 10].map(u16::to_le_bytes).concat();
    let of_32 = [-7_i32, 20, 1, 0, 2000, 10].map(i32::to_le_bytes).concat();
    vec![
        small("frt", file(false, 16, &of_16), 7.0),
        small("frt of version 1.01", file(true, 32, &of_32), -7.0),
    ]
}

fn file(wide: bool, bits: u32, numbers: &[u8]) -> Vec<u8> {
    let version: &[u8] = if wide { b"1.01" } else { b"1.00" };
    let blocks = [
        (0x65_u16, b":".to_vec()),
        (0x66, [3_u32, 2, bits].map(u32::to_le_bytes).concat()),
        (0x67, [[3e-6_f64, 1e-6, 5.0, 6.0, 1.0].map(f64::to_le_bytes).concat(), vec![1, 0, 0, 0]].concat()),
        (0x6c, [vec![5, 0, 0, 0], 1e-9_f64.to_le_bytes().to_vec()].concat()),
        (0x0b, numbers.to_vec()),
        (0x70, [5_u32, 65529].map(u32::to_le_bytes).concat()),
    ];
    let mut bytes = [b"FRTM_GLIDERV", version, &[6, 0]].concat();
    for (number, content) in blocks {
        bytes.extend(number.to_le_bytes());
        let length = (content.len() as u64).to_le_bytes();
        bytes.extend(&length[..if wide { 8 } else { 4 }]);
        bytes.extend(content);
    }
    bytes
}
