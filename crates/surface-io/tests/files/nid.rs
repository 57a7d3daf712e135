//! NID files.

use super::Small;

pub fn files() -> Vec<Small> {
    // A deflection in newtons, and heights in 2^32 steps of the range about 0; the first line is the last
    // row.
    let words = [-2_147_483_648_i32, 0, 1 << 30, 3, -4, 5];
    let data: Vec<u8> = words.iter().chain(&words).flat_map(|n| n.to_le_bytes()).collect();
    let step = 1e-5 / 4_294_967_296.0;
    let signed = Small {
        name: "nid",
        bytes: file(&[&map("N", 1e-5, -5e-6, 32, "Signed"), &map("m", 1e-5, -5e-6, 32, "Signed")], &data),
        number: 1,
        shape: [3, 2],
        size: Some([2e-5, 1e-5]),
        heights: [3.0, -4.0, 5.0, -2_147_483_648.0, 0.0, (1 << 30).into()].map(|n: f64| n * step).to_vec(),
        compressed: false,
    };
    // Ranges that do not lie about 0.
    let shorts: Vec<u8> = [-32768_i16, 0, 1, 3, -4, 5].iter().flat_map(|n| n.to_le_bytes()).collect();
    let shifted = Small {
        name: "nid of int16 from 1 to 3 um",
        bytes: file(&[&map("um", 2.0, 1.0, 16, "Signed")], &shorts),
        number: 0,
        heights: [3.0, -4.0, 5.0, -32768.0, 0.0, 1.0].map(|n: f64| 2e-6 + n * 2e-6 / 65536.0).to_vec(),
        ..signed.clone()
    };
    let bytes = Small {
        name: "nid of uint8 from 1 to 3 um",
        bytes: file(&[&map("um", 2.0, 1.0, 8, "Unsigned")], &[0, 1, 2, 128, 255, 4]),
        heights: [128.0, 255.0, 4.0, 0.0, 1.0, 2.0].map(|n: f64| 1e-6 + n * 2e-6 / 256.0).to_vec(),
        ..shifted.clone()
    };
    vec![signed, shifted, bytes]
}

fn map(unit: &str, range: f64, low: f64, bits: u8, sign: &str) -> String {
    format!(
        "Points=3\r\nLines=2\r\nFrame=Scan forward\r\nCurLine=0\r\nDim0Unit=m\r\nDim0Range=2e-05\r\nDim1Unit=m\r\nDim1Range=1e-05\r\n\
         Dim2Name=Z-Axis\r\nDim2Unit={unit}\r\nDim2Range={range:e}\r\nDim2Min={low:e}\r\nSaveMode=Binary\r\nSaveBits={bits}\r\n\
         SaveSign={sign}\r\nSaveOrder=Intel\r\n"
    )
}

fn file(maps: &[&str], data: &[u8]) -> Vec<u8> {
    let mut text = vec!["[DataSet]\r\nVersion=2\r\nGroupCount=1\r\nGr0-Count=8\r\n".to_owned()];
    text.extend((0..maps.len()).map(|i| format!("Gr0-Ch{}=DataSet-0:{i}\r\n", 2 * i)));
    text.extend(maps.iter().enumerate().map(|(i, map)| format!("\r\n[DataSet-0:{i}]\r\n{map}")));
    [text.concat().as_bytes(), b"\r\n#!", data].concat()
}
