//! Maps as GWY.

use crate::error::ContentError;
use crate::write::{Metric, with_nan};
use contact_model::HeightMap;

/// The bytes of a Gwyddion file of one channel: float64 heights and sides with their unit, or without one.
///
/// Gwyddion has no undefined points: theirs is the mean height, under a mask, which is read as undefined
/// again.
///
/// # Errors
/// [`ContentError::OutOfRange`] for a map of 4 GB or more.
///
/// ```
/// use surface_io::{Metric, ReadOptions, Scan};
/// let map = contact_model::HeightMap::new(2, [1e-6, 2e-6], vec![0.0, 1e-9, 2e-9, 3e-9])?;
/// let scan = Scan::from_bytes("a.gwy", &surface_io::gwy(&map, Metric::Metres)?, &ReadOptions::default())?;
/// assert_eq!((scan.height(1, 0), scan.metadata().size.unwrap()[1].value()), (Some(2e-9), 2e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn gwy(map: &HeightMap, metric: Metric) -> Result<Vec<u8>, ContentError> {
    let mut heights = with_nan(map);
    let fields = if map.undefined() > 0 { 2 } else { 1 };
    let value = 8.0 * heights.len() as f64 * f64::from(fields);
    // The length of an object is a number of 32 bits; names and units take some hundred bytes.
    if value > f64::from(u32::MAX) - 1000.0 {
        let expected = "less than 4 GB in GWY";
        return Err(ContentError::OutOfRange { what: "bytes of heights", value, expected });
    }
    let unit = metric.unit();
    let mut components = component("/0/data/title", b"sTopography\0");
    if map.undefined() > 0 {
        let mask: Vec<f64> = heights.iter().map(|h| f64::from(u8::from(h.is_nan()))).collect();
        let defined = heights.len() - map.undefined();
        let mean = heights.iter().filter(|h| !h.is_nan()).map(|h| h / defined.max(1) as f64).sum::<f64>();
        heights.iter_mut().filter(|h| h.is_nan()).for_each(|h| *h = mean);
        components.extend(component("/0/data", &field(map, &heights, [unit, unit])));
        components.extend(component("/0/mask", &field(map, &mask, [unit, ""])));
    } else {
        components.extend(component("/0/data", &field(map, &heights, [unit, unit])));
    }
    Ok([super::MAGIC, &object("GwyContainer", &components)].concat())
}

/// A name and a value that begins with its type.
fn component(name: &str, value: &[u8]) -> Vec<u8> {
    [name.as_bytes(), &[0], value].concat()
}

fn object(name: &str, components: &[u8]) -> Vec<u8> {
    [name.as_bytes(), &[0], &(components.len() as u32).to_le_bytes(), components].concat()
}

fn field(map: &HeightMap, values: &[f64], [lateral, of_values]: [&str; 2]) -> Vec<u8> {
    let int = |n: usize| [&b"i"[..], &(n as u32).to_le_bytes()].concat();
    let double = |x: f64| [&b"d"[..], &x.to_le_bytes()].concat();
    let unit = |text: &str| {
        let text = component("unitstr", &[b"s", text.as_bytes(), &[0]].concat());
        [&b"o"[..], &object("GwySIUnit", &text)].concat()
    };
    let mut data = Vec::with_capacity(5 + 8 * values.len());
    data.push(b'D');
    data.extend((values.len() as u32).to_le_bytes());
    data.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    let components = [
        component("xres", &int(map.columns())),
        component("yres", &int(map.rows())),
        component("xreal", &double(map.size().x)),
        component("yreal", &double(map.size().y)),
        component("xoff", &double(0.0)),
        component("yoff", &double(0.0)),
        component("si_unit_xy", &unit(lateral)),
        component("si_unit_z", &unit(of_values)),
        component("data", &data),
    ];
    [&b"o"[..], &object("GwyDataField", &components.concat())].concat()
}
