//! Maps as NetCDF-3.

use crate::error::ContentError;
use crate::write::{Metric, with_nan};
use contact_model::HeightMap;

/// Types of values: byte, text and double.
const BYTE: u32 = 1;
const TEXT: u32 = 2;
const DOUBLE: u32 = 6;

/// The bytes of a NetCDF-3 file (with offsets of 64 bits, CDF-2) as `SurfaceTopography` writes it: float64
/// `heights(x, y)`, the variables `x` and `y` with the attributes `length` and `unit`; at undefined points
/// heights are NaN, which is their fill value, and `mask` is 1.
///
/// # Errors
/// [`ContentError::OutOfRange`] for a map of 4 GB or more.
///
/// ```
/// use surface_io::{Metric, ReadOptions, Scan};
/// let map = contact_model::HeightMap::new(2, [1e-6, 2e-6], vec![0.0, 1e-9, 2e-9, 3e-9])?;
/// let scan = Scan::from_bytes("a.nc", &surface_io::netcdf(&map, Metric::Metres)?, &ReadOptions::default())?;
/// assert_eq!((scan.height(1, 0), scan.metadata().size.unwrap()[1].value()), (Some(2e-9), 2e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn netcdf(map: &HeightMap, metric: Metric) -> Result<Vec<u8>, ContentError> {
    let (columns, rows) = (map.columns(), map.rows());
    let count = columns * rows;
    if 8.0 * count as f64 > f64::from(u32::MAX) - 4.0 {
        let (what, value) = ("bytes of heights", 8.0 * count as f64);
        return Err(ContentError::OutOfRange { what, value, expected: "less than 4 GB in NetCDF-3" });
    }
    let unit = match metric.unit() {
        "" => None,
        unit => Some(("unit", TEXT, unit.as_bytes().to_vec())),
    };
    let double = |name: &'static str, value: f64| (name, DOUBLE, value.to_be_bytes().to_vec());
    let axis = |name: &'static str, number: usize, count: usize, side: f64| WrittenVariable {
        name,
        dimensions: vec![number],
        kind: DOUBLE,
        bytes: 8 * count,
        attributes: [double("length", side)].into_iter().chain(unit.clone()).collect(),
    };
    let over = vec![0, 1];
    let undefined = map.undefined() > 0;
    let fill = undefined.then(|| double("_FillValue", f64::NAN));
    let mut variables = vec![WrittenVariable {
        name: "heights",
        dimensions: over.clone(),
        kind: DOUBLE,
        bytes: 8 * count,
        attributes: fill.into_iter().chain(unit.clone()).collect(),
    }];
    if undefined {
        let attributes = Vec::new();
        variables.push(WrittenVariable {
            name: "mask",
            dimensions: over,
            kind: BYTE,
            bytes: count,
            attributes,
        });
    }
    variables.push(axis("x", 0, columns, map.size().x));
    variables.push(axis("y", 1, rows, map.size().y));

    // The header is as long with other offsets in it.
    let length = header(&variables, [columns, rows], 0).len();
    let mut file = header(&variables, [columns, rows], length);
    file.reserve_exact(variables.iter().map(|v| v.bytes + 3).sum());
    let heights = with_nan(map);
    let by_columns = || (0..count).map(|i| heights[i % rows * columns + i / rows]);
    file.extend(by_columns().flat_map(f64::to_be_bytes));
    if undefined {
        file.extend(by_columns().map(|height| u8::from(height.is_nan())));
        file.resize(file.len().next_multiple_of(4), 0);
    }
    for (count, side) in [(columns, map.size().x), (rows, map.size().y)] {
        file.extend((0..count).flat_map(|i| (i as f64 / count as f64 * side).to_be_bytes()));
    }
    Ok(file)
}

/// One variable: the numbers of its dimensions, the type and bytes of its values, names, types and bytes of
/// its attributes.
struct WrittenVariable {
    name: &'static str,
    dimensions: Vec<usize>,
    kind: u32,
    bytes: usize,
    attributes: Vec<(&'static str, u32, Vec<u8>)>,
}

/// The header of a file whose data begin at an offset.
fn header(variables: &[WrittenVariable], [columns, rows]: [usize; 2], data: usize) -> Vec<u8> {
    let mut header = b"CDF\x02".to_vec();
    let words = |header: &mut Vec<u8>, numbers: &[usize]| {
        header.extend(numbers.iter().flat_map(|&number| (number as u32).to_be_bytes()));
    };
    let text = |header: &mut Vec<u8>, text: &str| {
        words(header, &[text.len()]);
        header.extend(text.bytes());
        header.resize(header.len().next_multiple_of(4), 0);
    };
    // No records; two dimensions, no attributes of the whole.
    words(&mut header, &[0, 10, 2]);
    for (name, length) in [("x", columns), ("y", rows)] {
        text(&mut header, name);
        words(&mut header, &[length]);
    }
    words(&mut header, &[0, 0, 11, variables.len()]);
    let mut offset = data as u64;
    for WrittenVariable { name, dimensions, kind, bytes, attributes } in variables {
        text(&mut header, name);
        words(&mut header, &[dimensions.len()]);
        words(&mut header, dimensions);
        words(&mut header, &[if attributes.is_empty() { 0 } else { 12 }, attributes.len()]);
        for (name, kind, value) in attributes {
            text(&mut header, name);
            let count = if *kind == TEXT { value.len() } else { 1 };
            words(&mut header, &[*kind as usize, count]);
            header.extend(value);
            header.resize(header.len().next_multiple_of(4), 0);
        }
        let padded = bytes.next_multiple_of(4);
        words(&mut header, &[*kind as usize, padded]);
        header.extend(offset.to_be_bytes());
        offset += padded as u64;
    }
    header
}
