//! Gwyddion files.

use super::Small;

pub fn files() -> Vec<Small> {
    let heights = vec![1e-9, -2e-9, 3e-9, 0.5e-9, f64::NAN, 1e-8];
    let plain = Small {
        name: "gwy",
        bytes: file(&[("/0/data/title", string("Topography")), ("/0/data", field(&heights, "m", "m"))]),
        number: 0,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        heights: heights.clone(),
        compressed: false,
    };
    // Components that are passed, a channel that is no height, a mask.
    let mask = field(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0], "m", "");
    let other = [
        ("/1/data", field(&heights, "m", "V")),
        ("/3/show", [vec![b'S'], 2_u32.to_le_bytes().to_vec(), b"a\0bc\0".to_vec()].concat()),
        ("/3/mask", mask),
        ("/3/data", field(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "um", "nm")),
        ("/3/visible", vec![b'b', 1]),
        ("/3/numbers", [vec![b'I'], 1_u32.to_le_bytes().to_vec(), vec![0; 4]].concat()),
    ];
    let masked = Small {
        name: "gwy with a mask",
        bytes: file(&other),
        number: 1,
        shape: [3, 2],
        size: Some([3e-12, 1e-12]),
        heights: vec![1e-9, f64::NAN, 3e-9, 4e-9, 5e-9, 6e-9],
        compressed: false,
    };
    vec![plain, masked]
}

fn file(components: &[(&str, Vec<u8>)]) -> Vec<u8> {
    [&b"GWYP"[..], &object("GwyContainer", components)].concat()
}

fn object(name: &str, components: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let inner: Vec<u8> =
        components.iter().flat_map(|(key, value)| [key.as_bytes(), &[0], value].concat()).collect();
    [name.as_bytes(), &[0], &(inner.len() as u32).to_le_bytes(), &inner].concat()
}

fn string(text: &str) -> Vec<u8> {
    [b"s", text.as_bytes(), &[0]].concat()
}

fn unit(text: &str) -> Vec<u8> {
    [&b"o"[..], &object("GwySIUnit", &[("unitstr", string(text))])].concat()
}

/// Three columns over 3e-6 and two rows over 1e-6 of a unit.
fn field(heights: &[f64], lateral: &str, of_heights: &str) -> Vec<u8> {
    let int = |n: u32| [&b"i"[..], &n.to_le_bytes()].concat();
    let double = |x: f64| [&b"d"[..], &x.to_le_bytes()].concat();
    let data: Vec<u8> = heights.iter().flat_map(|h| h.to_le_bytes()).collect();
    let components = [
        ("xres", int(3)),
        ("yres", int(2)),
        ("xreal", double(3e-6)),
        ("yreal", double(1e-6)),
        ("xoff", double(0.0)),
        ("si_unit_xy", unit(lateral)),
        ("si_unit_z", unit(of_heights)),
        ("data", [&b"D"[..], &(heights.len() as u32).to_le_bytes(), &data].concat()),
    ];
    [&b"o"[..], &object("GwyDataField", &components)].concat()
}
