//! WSxM files.

use super::Small;

pub fn files() -> Vec<Small> {
    // The first number is that of the last column of the last row.
    let doubles: Vec<u8> =
        [-0.5_f64, 2.0, 1.0, 0.25, 0.0, 1.5].iter().flat_map(|n| n.to_le_bytes()).collect();
    let range = "    Maximum: 2\r\n    Minimum: -0.5\r\n";
    let stp = Small {
        name: "wsxm of doubles",
        bytes: file("    Image Data Type: double\r\n    Z Amplitude: 2.5 nm\r\n", range, &doubles),
        number: 0,
        shape: [3, 2],
        size: Some([600e-9, 1e-6]),
        heights: [1.5, 0.0, 0.25, 1.0, 2.0, -0.5].map(|nm: f64| nm * 1e-9).to_vec(),
        compressed: false,
    };
    let shorts: Vec<u8> = [6900_i16, 5927, -3, 0, 1, 2].iter().flat_map(|n| n.to_le_bytes()).collect();
    let count = 34.515e-9 / 6903.0;
    let top = Small {
        name: "wsxm of integers",
        bytes: file("    Z Amplitude: 34.515 nm\r\n", "    Maximum: 6900\r\n    Minimum: -3\r\n", &shorts),
        heights: [2.0, 1.0, 0.0, -3.0, 5927.0, 6900.0].map(|n: f64| n * count).to_vec(),
        ..stp.clone()
    };
    // A program that writes neither a range nor a micrometre as WSxM does, and a byte behind the numbers.
    let floats: Vec<u8> = [-0.5_f32, 2.0, 1.0, 0.25, 0.0, 1.5].iter().flat_map(|n| n.to_le_bytes()).collect();
    let plain = Small {
        name: "wsxm of floats without a range",
        bytes: file(
            "    Image Data Type: float\r\n    Z Amplitude: 2.5 \u{b5}m\r\n",
            "",
            &[&floats[..], &[0]].concat(),
        ),
        heights: stp.heights.iter().map(|height| height * 1e3).collect(),
        ..stp.clone()
    };
    vec![stp, top, plain]
}

fn file(general: &str, other: &str, data: &[u8]) -> Vec<u8> {
    let text = format!(
        "WSxM file copyright UAM\r\nSxM Image file\r\nImage header size: 99\r\n\r\n[Control]\r\n\r\n    X Amplitude: 600 nm\r\n    \
         Y Amplitude: 1 \u{b5}m\r\n\r\n[General Info]\r\n\r\n    Acquisition channel: Topography\r\n    Number of columns: 3\r\n    \
         Number of rows: 2\r\n{general}\r\n[Miscellaneous]\r\n\r\n{other}\r\n[Header end]\r\n"
    );
    text.chars().map(|c| c as u8).chain(data.iter().copied()).collect()
}
