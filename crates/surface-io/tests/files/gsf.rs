//! Gwyddion simple fields.

use super::Small;

pub fn files() -> Vec<Small> {
    let lines = "XRes = 3\nYRes = 2\nXReal = 3e-06\nYReal = 1e-06\nXYUnits = m\nZUnits = m\nTitle = made\n";
    let small = |name, lines: &str, size| Small {
        name,
        bytes: file(lines),
        number: 0,
        shape: [3, 2],
        size,
        heights: vec![1.0, -2.0, f64::NAN, 4.0, 0.0, 0.25],
        compressed: false,
    };
    let bare = lines.replace("XYUnits = m\nZUnits = m\n", "Author: none\n");
    vec![small("gsf", lines, Some([3e-6, 1e-6])), small("gsf without units", &bare, None)]
}

fn file(lines: &str) -> Vec<u8> {
    let mut bytes = [b"Gwyddion Simple Field 1.0\n", lines.as_bytes(), b"\0"].concat();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes.extend([1.0_f32, -2.0, f32::NAN, 4.0, 0.0, 0.25].map(f32::to_le_bytes).concat());
    bytes
}
