//! LEXT, of Olympus' laser microscopes: a TIFF whose images are named by their descriptions. `HEIGHT` has
//! counts of heights, and the XML of the first image says how large a count and a pixel are, as numbers of
//! powers of ten of a metre (Gwyddion's `lextfile.c`). All other images have no heights.

use crate::instruments::prelude::*;
use quick_xml::events::Event;
use std::collections::HashMap;

/// How the XML begins.
const ROOT: &str = "TiffTagDescData";
/// The image of heights.
const HEIGHT: &str = "HEIGHT";

/// What the description of the first image says.
pub(super) struct Lext {
    /// Metres of a pixel along x and y, and of a count.
    steps: [Option<f64>; 3],
}

impl Lext {
    /// `None` for other files.
    pub(super) fn of(description: Option<&str>) -> Option<Self> {
        let text = description.filter(|text| text.contains(ROOT))?;
        let mut found = HashMap::new();
        let (mut reader, mut key) = (quick_xml::Reader::from_str(text), String::new());
        loop {
            match reader.read_event() {
                Ok(Event::Start(element)) => element.local_name().as_ref().clone_into(&mut key),
                Ok(Event::Text(text)) => {
                    if let Ok(number) = text.xml10_content().trim().parse::<f64>() {
                        found.entry(key.clone()).or_insert(number);
                    }
                }
                Ok(Event::Eof) | Err(_) => break,
                Ok(_) => {}
            }
        }
        let step = |axis: &str| {
            let power = found.get(&format!("HeightDataUnit{axis}"))?;
            Some(found.get(&format!("HeightDataPerPixel{axis}"))? * 10_f64.powf(*power))
        };
        Some(Self { steps: ["X", "Y", "Z"].map(step) })
    }

    /// Unit, scale and sides of a pixel of the image of this name.
    pub(super) fn image(&self, name: &str) -> (StoredUnit, Option<f64>, [Option<Extent>; 2]) {
        let [x, y, z] = self.steps;
        let extent = [x, y].map(|side| Extent::of_cell(side?, "m"));
        match z {
            Some(_) if name == HEIGHT => (StoredUnit::written("m"), z, extent),
            None if name == HEIGHT => (StoredUnit::Unknown, None, extent),
            _ => (StoredUnit::NoHeights(None), None, extent),
        }
    }
}
