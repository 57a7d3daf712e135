//! BCR-STM and BCRF files.

use super::Small;

pub fn files() -> Vec<Small> {
    let small = |name, bytes, heights: [f64; 6]| Small {
        name,
        bytes,
        number: 0,
        shape: [3, 2],
        size: Some([3e-9, 1e-9]),
        heights: heights.map(|nm| nm * 1e-9).to_vec(),
        compressed: false,
    };
    let nan = f64::NAN;
    let lines = |kind: &str, more: &str| {
        format!(
            "fileformat = {kind}\n# a comment = 1\n%\nxpixels = 3\nypixels = 2\nxlength = 3\nylength = 1\n\
             bit2nm = 0.5\n{more}"
        )
    };
    let integers = [4_i16, -6, 32767, 1000, 0, 1];
    let little = integers.map(i16::to_le_bytes).concat();
    let big = integers.map(i16::to_be_bytes).concat();
    let floats = [4.0_f32, -6.0, 3.402_823e38, 1000.0, 0.0, 1.0].map(f32::to_le_bytes).concat();
    let ansi = |lines: String, bytes: &[u8]| [padded(&lines, 2048).into_bytes(), bytes.to_vec()].concat();
    let wide = |lines: String, mark: &[u8], count: usize, bytes: &[u8]| {
        let text: Vec<u8> = padded(&lines, count).encode_utf16().flat_map(u16::to_le_bytes).collect();
        [mark, &text, bytes].concat()
    };
    let unicode =
        lines("bcrf_unicode", "voidpixels = 3.4e38\nheadersize = 300\n xunit = nm\nyunit = nm\nzunit = um\n");
    let void = [2.0, -3.0, nan, 500.0, 0.0, 0.5];
    vec![
        small("bcr", ansi(lines("bcrstm", "voidpixels = 1\nzmin = 9\n"), &little), void),
        small(
            "bcr without undefined points",
            ansi(lines("bcrstm", "intelmode = 0\n"), &big),
            [2.0, -3.0, 16383.5, 500.0, 0.0, 0.5],
        ),
        small("bcr of floats", ansi(lines("bcrf", "voidpixels = 1\nzunit = nm\n"), &floats), void),
        small("bcr in utf-16", wide(unicode.clone(), b"", 300, &floats), void.map(|h| h * 1e3)),
        small("bcr in utf-16 with a mark", wide(unicode, b"\xff\xfe", 300, &floats), void.map(|h| h * 1e3)),
    ]
}

fn padded(lines: &str, count: usize) -> String {
    format!("{lines:<count$}")
}
