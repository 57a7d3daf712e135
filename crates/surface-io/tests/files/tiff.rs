//! TIFF files.

use super::Small;

pub fn files() -> Vec<Small> {
    [grey_images(), images_of_instruments()].concat()
}

fn small(name: &'static str, bytes: Vec<u8>, size: Option<[f64; 2]>, heights: Vec<f64>) -> Small {
    Small { name, bytes, number: 0, shape: [3, 2], size, heights, compressed: true }
}

fn words(words: &[i16]) -> Vec<u8> {
    words.iter().flat_map(|w| w.to_le_bytes()).collect()
}

fn grey_images() -> Vec<Small> {
    let floats: Vec<u8> =
        [0.0_f32, 1.0, 2.0, f32::NAN, 4.0, 5.0].iter().flat_map(|f| f.to_be_bytes()).collect();
    // 3.5 pixels per micrometre along x, 2 along y.
    let described =
        "ImageJ=1.54f\nunit=\\u00B5m\nspacing=7.0\ncf=0\nc0=-10.0\nc1=0.5\nvunit=nm\nmin=0.0\nmax=5.0\n";
    let calibrated =
        TestImage { description: described, resolution: Some([[7, 2], [2, 1]]), ..TestImage::new(16, 1) };
    vec![
        // 72 dpi, two strips, upside down.
        small(
            "tiff",
            TestImage { dpi: true, orientation: 4, ..TestImage::new(16, 2) }
                .file(false, &[&words(&[3, 4, 5]), &words(&[0, 1, 2])]),
            None,
            (0..6).map(f64::from).collect(),
        ),
        small(
            "tiff big-endian floats",
            TestImage::new(32, 3).file(true, &[&floats[..12], &floats[12..]]),
            None,
            vec![0.0, 1.0, 2.0, f64::NAN, 4.0, 5.0],
        ),
        small(
            "tiff of ImageJ",
            calibrated.file(false, &[&words(&[0, 20, 40]), &words(&[1, 2, 3])]),
            Some([3e-6 / 3.5, 2e-6 / 2.0]),
            [-10.0, 0.0, 10.0, -9.5, -9.0, -8.5].map(|nm: f64| nm * 1e-9).to_vec(),
        ),
        // Runs of PackBits: a literal of 1 + 2 bytes, 3 + 1 equal ones.
        small(
            "tiff packed",
            TestImage { compression: 32773, ..TestImage::new(16, 1) }
                .file(false, &[&[2, 1, 0, 7, 0xff, 0, 0, 9], &[0xfd, 2, 1, 2, 2]]),
            None,
            vec![1.0, 7.0, 9.0 * 256.0, 514.0, 514.0, 514.0],
        ),
    ]
}

fn images_of_instruments() -> Vec<Small> {
    vec![
        // The first row of the file is the last one.
        small(
            "tiff of JPK",
            TestImage { private: jpk(), ..TestImage::new(16, 1) }
                .file(true, &[&[0, 1, 0, 2, 0, 3], &[0, 4, 0, 5, 0, 6]]),
            Some([3e-6, 1e-6]),
            [4.0, 5.0, 6.0, 1.0, 2.0, 3.0].map(|n: f64| n * 2e-9 - 1e-9).to_vec(),
        ),
        small(
            "tiff of Park",
            TestImage { private: park(&words(&[1, 2, 3, -4, 5, 6]), 1, 0), ..TestImage::new(8, 1) }
                .file(false, &[&[1, 2, 3], &[4, 5, 6]]),
            Some([3e-6, 1e-6]),
            [-4.0, 5.0, 6.0, 1.0, 2.0, 3.0].map(|n: f64| -0.5 * (n + 10.0) * 1e-9).to_vec(),
        ),
        small(
            "tiff of Park with float32",
            TestImage {
                private: park(&[1_f32, 2.0, 3.0, -4.0, 5.5, 6.0].map(f32::to_le_bytes).concat(), 2, 2),
                ..TestImage::new(8, 1)
            }
            .file(false, &[&[1, 2, 3], &[4, 5, 6]]),
            Some([3e-6, 1e-6]),
            [-4.0, 5.5, 6.0, 1.0, 2.0, 3.0].map(|n: f64| -0.5 * (n + 10.0) * 1e-9).to_vec(),
        ),
    ]
}

/// Tag, type, bytes of a tag of an instrument.
type Private = (u16, u16, Vec<u8>);

/// Big-endian tags of an image with two scalings, of which the second counts.
fn jpk() -> Vec<Private> {
    let text = |tag: u16, text: &str| (tag, 2, [text.as_bytes(), &[0]].concat());
    let double = |tag: u16, number: f64| (tag, 12, number.to_be_bytes().to_vec());
    vec![
        double(0x8042, 3e-6),
        double(0x8043, 1e-6),
        text(0x8050, "height"),
        text(0x8081, "nominal"),
        text(0x8090, "raw"),
        text(0x80a3, "NullScaling"),
        text(0x80c0, "nominal"),
        text(0x80d2, "m"),
        text(0x80d3, "LinearScaling"),
        double(0x80d4, 2e-9),
        double(0x80d5, -1e-9),
    ]
}

/// Tags of a map of 3 x 2 points beside a picture.
fn park(data: &[u8], version: u8, number: u32) -> Vec<Private> {
    let mut header = vec![0; 580];
    let mut put = |at: usize, field: &[u8]| header[at..at + field.len()].copy_from_slice(field);
    for (at, n) in [(100, 3), (104, 2), (348, number)] {
        put(at, &n.to_le_bytes());
    }
    for (at, x) in [(140, 3.0_f64), (148, 1.0), (220, -0.5), (228, 1.0), (236, 10.0)] {
        put(at, &x.to_le_bytes());
    }
    for (at, text) in [(4, "Z Height"), (244, "nm")] {
        let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        put(at, &wide);
    }
    vec![
        (50432, 4, 0x0e03_1301_u32.to_le_bytes().to_vec()),
        (50433, 4, vec![version, 0, 0, 1]),
        (50434, 1, data.to_vec()),
        (50435, 7, header),
    ]
}

/// Tag, type, count, value or offset.
type TiffEntry = (u16, u16, u32, u32);

/// The number of values of a type in these bytes.
fn count_of(values: &[u8], kind: u16) -> u32 {
    let size = match kind {
        12 => 8,
        4 => 4,
        _ => 1,
    };
    (values.len() / size) as u32
}

/// The last field of an entry: up to four bytes stand in it, more elsewhere.
fn held_or_offset(values: &[u8], offset: [u8; 4]) -> Vec<u8> {
    if values.len() > 4 { offset.to_vec() } else { [values, &[0; 4]].concat()[..4].to_vec() }
}

/// An image of three columns and two rows, one strip each.
struct TestImage {
    bits: u16,
    sample_format: u16,
    compression: u16,
    orientation: u16,
    dpi: bool,
    description: &'static str,
    resolution: Option<[[u32; 2]; 2]>,
    private: Vec<Private>,
}

impl TestImage {
    fn new(bits: u16, sample_format: u16) -> Self {
        let (compression, orientation) = (1, 1);
        let (dpi, description, resolution, private) = (false, "", None, Vec::new());
        Self { bits, sample_format, compression, orientation, dpi, description, resolution, private }
    }

    fn file(&self, big: bool, strips: &[&[u8]; 2]) -> Vec<u8> {
        let short = |n: u16| if big { n.to_be_bytes() } else { n.to_le_bytes() };
        let long = |n: u32| if big { n.to_be_bytes() } else { n.to_le_bytes() };
        let mut bytes = [if big { &b"MM"[..] } else { b"II" }, &short(42), &[0; 4]].concat();
        let mut put = |data: &[u8]| {
            let at = bytes.len() as u32;
            bytes.extend(data);
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            at
        };
        let at = strips.map(&mut put);
        let lengths = strips.map(|strip| strip.len() as u32);
        let longs = |all: [u32; 2]| all.map(long).concat();
        let (offsets, counts) = (put(&longs(at)), put(&longs(lengths)));
        let text = [self.description.as_bytes(), &[0]].concat();
        let description = put(&text);
        let resolution = self.resolution.or(self.dpi.then_some([[72, 1]; 2])).unwrap_or_default();
        let resolution = resolution.map(|[a, b]| put(&longs([a, b])));
        let private: Vec<_> = self.private.iter().map(|(_, _, bytes)| put(bytes)).collect();
        let directory = put(&[]);
        // Type 2 is text, 3 short, 4 long, 5 a ratio.
        let mut entries: Vec<TiffEntry> = vec![
            (256, 4, 1, 3),
            (257, 4, 1, 2),
            (258, 3, 1, self.bits.into()),
            (259, 3, 1, self.compression.into()),
            (262, 3, 1, 1),
            (270, 2, text.len() as u32, description),
            (273, 4, 2, offsets),
            (274, 3, 1, self.orientation.into()),
            (277, 3, 1, 1),
            (278, 4, 1, 1),
            (279, 4, 2, counts),
            (282, 5, 1, resolution[0]),
            (283, 5, 1, resolution[1]),
            (296, 3, 1, if self.dpi { 2 } else { 1 }),
            (339, 3, 1, self.sample_format.into()),
        ];
        entries.retain(|entry| self.resolution.is_some() || self.dpi || !matches!(entry.0, 282 | 283));
        if self.description.is_empty() {
            entries.retain(|entry| entry.0 != 270);
        }
        bytes.extend(short((entries.len() + private.len()) as u16));
        for (tag, kind, count, value) in entries {
            let value = if kind == 3 { [short(value as u16), [0; 2]].concat() } else { long(value).to_vec() };
            bytes.extend([&short(tag)[..], &short(kind), &long(count), &value].concat());
        }
        for ((tag, kind, values), at) in self.private.iter().zip(private) {
            let value = held_or_offset(values, long(at));
            let count = long(count_of(values, *kind));
            bytes.extend([&short(*tag)[..], &short(*kind), &count, &value].concat());
        }
        bytes.extend([0; 4]);
        bytes[4..8].copy_from_slice(&long(directory));
        bytes
    }
}
