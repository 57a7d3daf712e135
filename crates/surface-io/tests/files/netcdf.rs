//! Files of NetCDF-3.

use super::Small;

pub fn files() -> Vec<Small> {
    let nan = f64::NAN;
    let small = |name, bytes, heights| Small {
        name,
        bytes,
        number: 0,
        shape: [3, 2],
        size: Some([3e-6, 1e-6]),
        heights,
        compressed: false,
    };
    let scaled = vec![20e-9, -4e-9, nan, 10e-9, 610e-9, 8e-9];
    vec![
        small("netcdf", file(2, &masked_doubles()), vec![1.5e-9, -2e-9, 2.5e-9, nan, 0.0, nan]),
        small("netcdf of version 1", file(1, &scaled_integers()), scaled.clone()),
        small("netcdf of version 5", file(5, &scaled_floats()), scaled),
    ]
}

/// Column by column: x runs slower. The second point of the first column is masked, the last point filled.
fn masked_doubles() -> [TestVariable; 4] {
    let doubles = [1.5, 1e3, -2.0, 0.0, 2.5, 1e20].map(f64::to_be_bytes).concat();
    let attributes = vec![double("_FillValue", 1e20), text("unit", "nm")];
    [
        TestVariable::new("heights", &[0, 1], 6, doubles, attributes),
        TestVariable::new("mask", &[0, 1], 1, vec![0, 1, 0, 0, 0, 0], vec![]),
        side("x", 0, 3.0),
        side("y", 1, 1.0),
    ]
}

/// Row by row, with a scale, an offset and a mark of its own, besides what is passed.
fn scaled_integers() -> [TestVariable; 4] {
    let of_16_bits = [5, -7, -999, 0, 300, -1].map(i16::to_be_bytes).concat();
    let attributes = vec![
        double("scale_factor", 2.0),
        double("add_offset", 10.0),
        double("missing_value", -999.0),
        text("units", "nm"),
    ];
    [
        passed(),
        side("x", 0, 3.0),
        side("y", 1, 1.0),
        TestVariable::new("heights", &[1, 0], 3, of_16_bits, attributes),
    ]
}

/// Row by row, with a scale, an offset and the fill value of the library, besides what is passed.
fn scaled_floats() -> [TestVariable; 4] {
    let fill = (0x7cf0_0000_u32).to_be_bytes();
    let floats = [
        &[5_f32, -7.0].map(f32::to_be_bytes).concat()[..],
        &fill,
        &[0.0, 300.0, -1.0].map(f32::to_be_bytes).concat(),
    ]
    .concat();
    let attributes = vec![double("scale_factor", 2e-9), double("add_offset", 10e-9), text("unit", "m")];
    [
        TestVariable::new("heights", &[1, 0], 5, floats, attributes),
        side("y", 1, 1.0),
        passed(),
        side("x", 0, 3.0),
    ]
}

/// A variable that is no map.
fn passed() -> TestVariable {
    TestVariable::new("other", &[], 2, vec![b'a'], vec![text("long_name", "nothing")])
}

type Attribute = (&'static str, u32, u32, Vec<u8>);

struct TestVariable {
    name: &'static str,
    dimensions: &'static [u32],
    kind: u32,
    values: Vec<u8>,
    attributes: Vec<Attribute>,
}

impl TestVariable {
    fn new(
        name: &'static str,
        dimensions: &'static [u32],
        kind: u32,
        values: Vec<u8>,
        attributes: Vec<Attribute>,
    ) -> Self {
        Self { name, dimensions, kind, values, attributes }
    }
}

fn double(name: &'static str, value: f64) -> Attribute {
    (name, 6, 1, value.to_be_bytes().to_vec())
}

fn text(name: &'static str, value: &str) -> Attribute {
    (name, 2, value.len() as u32, value.as_bytes().to_vec())
}

/// A coordinate with the length of its side in um.
fn side(name: &'static str, dimension: usize, length: f32) -> TestVariable {
    let dimensions: &[u32] = [&[0], &[1]][dimension];
    let count = [3, 2][dimension];
    let length = ("length", 5, 1, length.to_be_bytes().to_vec());
    TestVariable::new(
        name,
        dimensions,
        6,
        vec![0; 8 * count],
        vec![length, ("periodic", 4, 1, vec![0; 4]), text("unit", "um")],
    )
}

fn file(version: u8, variables: &[TestVariable]) -> Vec<u8> {
    let data = header(version, variables, 0).len();
    let mut file = header(version, variables, data);
    for variable in variables {
        file.extend(&variable.values);
        file.resize(file.len().next_multiple_of(4), 0);
    }
    file
}

fn header(version: u8, variables: &[TestVariable], mut data: usize) -> Vec<u8> {
    let mut header = [b"CDF", &[version][..]].concat();
    let word = |header: &mut Vec<u8>, n: u32| header.extend(n.to_be_bytes());
    let count = |header: &mut Vec<u8>, n: usize| {
        if version == 5 {
            header.extend((n as u64).to_be_bytes());
        } else {
            header.extend((n as u32).to_be_bytes());
        }
    };
    let padded = |header: &mut Vec<u8>, bytes: &[u8]| {
        header.extend(bytes);
        header.resize(header.len().next_multiple_of(4), 0);
    };
    let attributes = |header: &mut Vec<u8>, all: &[Attribute]| {
        word(header, if all.is_empty() { 0 } else { 12 });
        count(header, all.len());
        for (name, kind, values, bytes) in all {
            count(header, name.len());
            padded(header, name.as_bytes());
            word(header, *kind);
            count(header, *values as usize);
            padded(header, bytes);
        }
    };
    count(&mut header, 0);
    word(&mut header, 10);
    count(&mut header, 2);
    for (name, length) in [("x", 3), ("y", 2)] {
        count(&mut header, 1);
        padded(&mut header, name.as_bytes());
        count(&mut header, length);
    }
    attributes(&mut header, &[text("title", "a map")]);
    word(&mut header, 11);
    count(&mut header, variables.len());
    for variable in variables {
        count(&mut header, variable.name.len());
        padded(&mut header, variable.name.as_bytes());
        count(&mut header, variable.dimensions.len());
        variable.dimensions.iter().for_each(|&n| count(&mut header, n as usize));
        attributes(&mut header, &variable.attributes);
        word(&mut header, variable.kind);
        let length = variable.values.len().next_multiple_of(4);
        count(&mut header, length);
        if version == 1 {
            word(&mut header, data as u32);
        } else {
            header.extend((data as u64).to_be_bytes());
        }
        data += length;
    }
    header
}
