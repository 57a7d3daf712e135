//! MI files.

use super::Small;

pub fn files() -> Vec<Small> {
    // An amplitude, and heights of which 2^31 are 3 um; the first line is the last row.
    let words = [-2_147_483_648_i32, 0, 1 << 30, 3, -4, 5];
    let data: Vec<u8> = words.iter().chain(&words).flat_map(|n| n.to_le_bytes()).collect();
    let step = 3e-6 / 2_147_483_648.0;
    let wide = Small {
        name: "mi",
        bytes: file(&[("Amplitude", "nm"), ("Topography", "um")], "BINARY_32", &data),
        number: 1,
        shape: [3, 2],
        size: Some([2e-5, 1e-5]),
        heights: [3.0, -4.0, 5.0, -2_147_483_648.0, 0.0, (1 << 30).into()].map(|n: f64| n * step).to_vec(),
        compressed: false,
    };
    let shorts: Vec<u8> = [-32768_i16, 0, 1, 3, -4, 5].iter().flat_map(|n| n.to_le_bytes()).collect();
    let narrow = |name, kind: &str| Small {
        name,
        bytes: file(&[("Topography", "nm")], kind, &shorts),
        number: 0,
        heights: [3.0, -4.0, 5.0, -32768.0, 0.0, 1.0].map(|n: f64| n * 3e-9 / 32768.0).to_vec(),
        ..wide.clone()
    };
    vec![wide.clone(), narrow("mi of int16", "BINARY"), narrow("mi without a type", "")]
}

fn file(maps: &[(&str, &str)], kind: &str, data: &[u8]) -> Vec<u8> {
    let mut text = Vec::new();
    let mut line = |key: &str, value: &str| text.extend(format!("{key:14}{value}\n").into_bytes());
    for (key, value) in [
        ("fileType", "Image"),
        ("version", "PicoView 0x10c04"),
        ("zSensitivity", "1.35e-008"),
        ("reverseX", "FALSE"),
        ("xPixels", "3"),
        ("yPixels", "2"),
        ("xLength", "2.0e-005"),
        ("yLength", "1.0e-005"),
        ("", "goes on"),
    ] {
        line(key, value);
    }
    for (label, unit) in maps {
        for (key, value) in [
            ("bufferLabel", *label),
            ("direction", "Trace"),
            ("bufferRange", "3.0e+000"),
            ("bufferUnit", *unit),
        ] {
            line(key, value);
        }
    }
    line("data", kind);
    [&text[..], data].concat()
}
