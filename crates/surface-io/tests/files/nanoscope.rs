//! Nanoscope files.

use super::Small;

pub fn files() -> Vec<Small> {
    // Counts of two bytes: 10 V over 65536 counts at 20 nm/V; the first line is the last row.
    let image = "\\Data offset: 4096\r\n\\Data length: 12\r\n\\Bytes/pixel: 2\r\n\\Samps/line: 3\r\n\\Number of lines: 2\r\n\\Scan Size: 3 1 ~m\r\n\
                 \\@2:Image Data: S [Height] \"Height\"\r\n\\@2:Z scale: V [Sens. Zsens] (0.005 V/LSB) 10.0 V\r\n";
    let phase = "\\Data offset: 4108\r\n\\Data length: 12\r\n\\Samps/line: 3\r\n\\Number of lines: 2\r\n\\Scan Size: 3 1 ~m\r\n\
                 \\@2:Image Data: S [Phase] \"Phase\"\r\n\\@2:Z scale: V [Sens. Phase] (0.005 \u{b0}/LSB) 360 \u{b0}\r\n";
    let counts: Vec<u8> = [1_i16, -2, 3, 32767, -32768, 0].iter().flat_map(|n| n.to_le_bytes()).collect();
    let count = 10.0 * 20e-9 / 65536.0;
    let two = Small {
        name: "nanoscope with two channels",
        bytes: file("0x07200000", &[image, phase], &[&counts[..], &counts].concat()),
        number: 0,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        heights: [32767.0, -32768.0, 0.0, 1.0, -2.0, 3.0].map(|n| n * count).to_vec(),
        compressed: false,
    };
    // From version 9.2 on four bytes, whatever the entry says; the scale is still that of two.
    let wide: Vec<u8> = [100_000_i32, -2, 3, 0, 7, 1].iter().flat_map(|n| n.to_le_bytes()).collect();
    let new = Small {
        name: "nanoscope of version 9.4",
        bytes: file(
            "0x09400000",
            &[&image.replace("length: 12", "length: 24").replace("3 1 ~m", "3 nm")],
            &wide,
        ),
        number: 0,
        shape: [3, 2],
        size: Some([3e-9, 3e-9]),
        heights: [0.0, 7.0, 1.0, 100_000.0, -2.0, 3.0].map(|n| n * count).to_vec(),
        compressed: false,
    };
    // Sides of another ratio than the header says of them are left open.
    let oblong =
        image.replace("3 1 ~m\r\n", "3 3 ~m\r\n\\Aspect Ratio: 3:1\r\n\\Line Direction: Retrace\r\n");
    let oblong = Small {
        name: "nanoscope of an oblong map",
        bytes: file("0x05300001", &[&oblong], &counts),
        size: None,
        ..two.clone()
    };
    vec![two, new, oblong]
}

fn file(version: &str, images: &[&str], data: &[u8]) -> Vec<u8> {
    let mut text = format!(
        "\\*File list\r\n\\Version: {version}\r\n\\Data length: 4096\r\n\\*Scanner list\r\n\\@Sens. Zsens: V 20.0 nm/V\r\n\
         \\*Ciao scan list\r\n\\@Sens. Phase: V 1.0 \r\n"
    );
    for image in images {
        text = [&text, "\\*Ciao image list\r\n", image].concat();
    }
    text += "\\*File list end\r\n\u{1a}";
    let mut bytes: Vec<u8> = text.chars().map(|c| c as u8).collect();
    bytes.resize(4096, 0);
    bytes.extend(data);
    bytes
}
