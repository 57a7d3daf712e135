//! Igor binary waves.

use super::Small;

pub fn files() -> Vec<Small> {
    // Asylum: a phase and a height in one wave whose unit is a metre; the first line is the last row.
    let heights = [1e-9_f32, -2e-9, f32::NAN, 3e-9, 0.0, 7e-9];
    let asylum = Small {
        name: "ibw of Asylum",
        bytes: IbwWave { kind: 2, ..IbwWave::new(2) }
            .file(false, &heights.iter().chain(&heights).flat_map(|h| h.to_le_bytes()).collect::<Vec<_>>()),
        number: 1,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        heights: [3, 4, 5, 0, 1, 2].map(|i: usize| heights[i].into()).to_vec(),
        compressed: false,
    };
    let doubles: Vec<u8> = [1.5_f64, -2.0, 3.0, 4.0, 0.0, 7.0].iter().flat_map(|h| h.to_be_bytes()).collect();
    let plain = IbwWave { unit: "nm", program: "", labels: &[], ..IbwWave::new(0) };
    let big = Small {
        name: "ibw big-endian",
        bytes: IbwWave { kind: 4, ..plain }.file(true, &doubles),
        number: 0,
        heights: [4.0, 0.0, 7.0, 1.5, -2.0, 3.0].map(|h: f64| h * 1e-9).to_vec(),
        ..asylum.clone()
    };
    let shorts: Vec<u8> = [1_u16, 65535, 3, 4, 0, 7].iter().flat_map(|h| h.to_le_bytes()).collect();
    let long = Small {
        name: "ibw of uint16 with a long unit",
        bytes: IbwWave { kind: 0x50, unit: "angstrom", ..plain }.file(false, &shorts),
        heights: [4.0, 0.0, 7.0, 1.0, 65535.0, 3.0].map(|h: f64| h * 1e-10).to_vec(),
        ..big.clone()
    };
    vec![asylum, big, long]
}

/// A wave of three columns and two rows.
#[derive(Clone, Copy)]
struct IbwWave {
    kind: u16,
    layers: u32,
    unit: &'static str,
    labels: &'static [&'static str],
    program: &'static str,
}

impl IbwWave {
    fn new(layers: u32) -> Self {
        Self {
            kind: 2,
            layers,
            unit: "m",
            labels: &["", "PhaseTrace", "HeightRetrace"],
            program: "0506 MFP3D",
        }
    }

    fn file(self, big: bool, data: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0; 384];
        let mut put = |at: usize, field: &[u8]| {
            let field: Vec<u8> = if big { field.iter().rev().copied().collect() } else { field.to_vec() };
            bytes[at..at + field.len()].copy_from_slice(&field);
        };
        let short = self.unit.len() <= 3;
        let long = if short { 0 } else { self.unit.len() as u32 };
        for (at, n) in [
            (4, 320 + data.len() as u32),
            (8, 2),
            (12, 5),
            (16, long),
            (44, 32 * self.labels.len() as u32),
            (76, 6 * self.layers.max(1)),
            (132, 3),
            (136, 2),
            (140, self.layers),
        ] {
            put(at, &n.to_le_bytes());
        }
        put(0, &5_u16.to_le_bytes());
        put(80, &self.kind.to_le_bytes());
        for (at, step) in [(148, 1e-6_f64), (156, 5e-7)] {
            put(at, &step.to_le_bytes());
        }
        let mut text = |at: usize, text: &str| bytes[at..at + text.len()].copy_from_slice(text.as_bytes());
        text(92, "wave0");
        text(212, if short { self.unit } else { "" });
        text(216, "m");
        text(220, "m");
        let order = if big { u16::from_be_bytes } else { u16::from_le_bytes };
        let sum = bytes.chunks(2).fold(0_u16, |sum, word| sum.wrapping_add(order([word[0], word[1]])));
        let rest = sum.wrapping_neg();
        bytes[2..4].copy_from_slice(&if big { rest.to_be_bytes() } else { rest.to_le_bytes() });
        bytes.extend([data, b"f=note:"].concat());
        bytes.extend(if short { "" } else { self.unit }.bytes());
        for label in self.labels {
            bytes.extend(label.bytes().chain(std::iter::repeat_n(0, 32 - label.len())));
        }
        bytes.extend(self.program.bytes());
        bytes
    }
}
