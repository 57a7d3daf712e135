//! OPD files.

use super::Small;

pub fn files() -> Vec<Small> {
    // Column by column, the last row first.
    let floats: Vec<u8> = [2.0_f32, 1.0, -1.0, 0.5, 1e38, 4.0].iter().flat_map(|h| h.to_le_bytes()).collect();
    let shorts: Vec<u8> = [20_i16, 10, -10, 5, 32767, 40].iter().flat_map(|h| h.to_le_bytes()).collect();
    let raw = |size: u16, data: &[u8]| {
        [&3_u16.to_le_bytes()[..], &2_u16.to_le_bytes(), &size.to_le_bytes(), data].concat()
    };
    let wavelength = ("Wavelength", 7_i16, 500_f32.to_le_bytes().to_vec());
    let pixel = ("Pixel_size", 7, 0.001_f32.to_le_bytes().to_vec());
    let aspect = ("Aspect", 7, 2_f32.to_le_bytes().to_vec());
    let heights = [1.0, 0.5, 4.0, 2.0, -1.0, f64::NAN];
    let first = Small {
        name: "opd",
        bytes: file(&[
            ("Title", 5, b"a title".to_vec()),
            ("Raw", 3, raw(4, &floats)),
            wavelength.clone(),
            pixel,
            aspect,
        ]),
        number: 0,
        shape: [3, 2],
        size: Some([3e-6, 4e-6]),
        heights: heights.iter().map(|h| h * 500e-9).collect(),
        compressed: false,
    };
    let mult = ("Mult", 6, 10_i16.to_le_bytes().to_vec());
    let second = Small {
        name: "opd of int16 without a size",
        bytes: file(&[wavelength, mult, ("Image", 3, vec![0; 9]), ("SAMPLE_DATA", 3, raw(2, &shorts))]),
        number: 0,
        shape: [3, 2],
        size: None,
        heights: heights.iter().map(|h| h * 500e-9).collect(),
        compressed: false,
    };
    vec![first, second]
}

fn file(blocks: &[(&str, i16, Vec<u8>)]) -> Vec<u8> {
    let entry = |name: &str, kind: i16, length: usize| {
        let mut bytes = name.as_bytes().to_vec();
        bytes.resize(16, 0);
        bytes.extend(kind.to_le_bytes());
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend([0, 0]);
        bytes
    };
    let mut bytes = vec![1, 0];
    bytes.extend(entry("Directory", 1, 24 * (blocks.len() + 1)));
    for (name, kind, data) in blocks {
        bytes.extend(entry(name, *kind, data.len()));
    }
    bytes.extend(blocks.iter().flat_map(|(_, _, data)| data));
    bytes
}
