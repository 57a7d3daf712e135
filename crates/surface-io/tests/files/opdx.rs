//! OPDx files.

use super::Small;

pub fn files() -> Vec<Small> {
    let floats = [1.0_f32, -2.0, f32::NAN, 4.0, 0.0, 0.25].map(f32::to_le_bytes).concat();
    let shape = [2_u32, 3].map(u32::to_le_bytes).concat();
    let content = [&shape[..], &floats].concat();
    let matrix =
        item("Matrix", 0x00, &[name("float"), vec![0; 4], name("x"), length(&content), content.clone()]);
    let unnamed = item("Matrix", 0x45, &[name("float"), length(&content), content]);
    let map = |matrix: &[u8]| {
        let sides = [quantity("Dimension1Extent", 1.0), quantity("Dimension2Extent", 3.0)].concat();
        let group = [text("DataKind", "Height"), sides, quantity("DataScale", 0.5), matrix.to_vec(), end()];
        file(&[
            group_of("1D_Data", 0x7d, &end()),
            group_of("2D_Data", 0x7d, &group_of("Final", 0x47, &group.concat())),
        ])
    };
    let doubles = |numbers: &[f64]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<_>>();
    let unit = [name("Micrometer"), name("\u{b5}m"), doubles(&[1e6]), vec![0; 12]].concat();
    let places = [unit, 3_u64.to_le_bytes().to_vec(), doubles(&[0.0, 0.5, 1.0])].concat();
    let array = [vec![0x0d, 8, 0, 0, 0], doubles(&[1.0, -2.0, 4.0])].concat();
    let line = [
        item("PositionFunction", 0x7c, &[name("ArrayPosition1D"), length(&places), places]),
        item("NumPoints", 0x0b, &[3_u64.to_le_bytes().to_vec()]),
        text("DataKind", "Height"),
        quantity("Extent", 1.0),
        quantity("DataScale", 0.5),
        item("Array", 0x40, &[name("double * __ptr64"), length(&array), array]),
        end(),
    ];
    let line = file(&[group_of("1D_Data", 0x7d, &group_of("Raw", 0x46, &line.concat()))]);
    let small = |name, bytes, shape, size, heights: &[f64]| Small {
        name,
        bytes,
        number: 0,
        shape,
        size,
        heights: heights.iter().map(|h| h * 0.5e-6).collect(),
        compressed: false,
    };
    let heights = [1.0, -2.0, f64::NAN, 4.0, 0.0, 0.25];
    vec![
        small("opdx", map(&matrix), [3, 2], Some([3e-6, 1e-6]), &heights),
        small("opdx of a matrix without a name", map(&unnamed), [3, 2], Some([3e-6, 1e-6]), &heights),
        small("opdx of a line", line, [3, 1], Some([1.5e-6, 5e-7]), &[1.0, -2.0, 4.0]),
    ]
}

fn file(groups: &[Vec<u8>]) -> Vec<u8> {
    [b"VCA DATA\x01\x00\x00\x55".to_vec(), groups.concat(), end()].concat()
}

fn name(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

fn item(called: &str, kind: u8, parts: &[Vec<u8>]) -> Vec<u8> {
    [name(called), vec![kind], parts.concat()].concat()
}

fn length(content: &[u8]) -> Vec<u8> {
    let length = content.len() as u16;
    if length < 256 { vec![1, length as u8] } else { [vec![2], length.to_le_bytes().to_vec()].concat() }
}

fn group_of(called: &str, kind: u8, content: &[u8]) -> Vec<u8> {
    item(called, kind, &[length(content), content.to_vec()])
}

fn text(called: &str, text: &str) -> Vec<u8> {
    item(called, 0x12, &[length(text.as_bytes()), text.as_bytes().to_vec()])
}

fn quantity(called: &str, value: f64) -> Vec<u8> {
    let content = [value.to_le_bytes().to_vec(), name("Micrometer"), name("\u{b5}m"), vec![0; 20]].concat();
    item(called, 0x13, &[length(&content), content])
}

fn end() -> Vec<u8> {
    b"\0\0\0\0\x7f\xff\xff".to_vec()
}
