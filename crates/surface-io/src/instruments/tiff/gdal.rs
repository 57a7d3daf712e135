//! Statements of GDAL and of the geographic tags of TIFF about an image: scale, offset and unit of its numbers, and
//! the side of a pixel.

use crate::instruments::prelude::*;
use quick_xml::events::Event;
use std::io::{Read, Seek};
use tiff::TiffResult;
use tiff::decoder::Decoder;
use tiff::decoder::ifd::Value;
use tiff::tags::Tag;

const METADATA: u16 = 42112;
const PIXEL: u16 = 33550;
const KEYS: u16 = 34735;
/// The key of the unit of a projection, and its value for metres.
const PROJECTED_UNIT: u16 = 3076;
const METRE: u16 = 9001;

/// The statements of one image.
#[derive(Default)]
pub(super) struct Gdal {
    pub(super) scale: Option<f64>,
    pub(super) shift: Option<f64>,
    pub(super) unit: Option<String>,
    /// The mark of undefined points.
    pub(super) missing: Option<f64>,
    pub(super) extent: [Option<Extent>; 2],
    pub(super) notes: Vec<String>,
    /// A scale or an offset that is no number.
    pub(super) wrong: Option<String>,
}

impl Gdal {
    pub(super) fn of<R: Read + Seek>(decoder: &mut Decoder<R>) -> TiffResult<Self> {
        let mut found = Self::default();
        if let Some(Value::Ascii(text)) = decoder.find_tag(Tag::GdalNodata)? {
            let text = text.trim_matches(['\0', ' ']);
            found.missing = text.parse().ok();
            if found.missing.is_none() {
                let text: String = text.chars().take(32).collect();
                found.notes.push(format!("the file marks undefined points by {text:?}, which is no number"));
            }
        }
        if let Some(Value::Ascii(text)) = decoder.find_tag(Tag::Unknown(METADATA))? {
            found.metadata(&text);
        }
        let pixel = decoder.find_tag(Tag::Unknown(PIXEL))?.and_then(|value| value.into_f64_vec().ok());
        let keys = decoder.find_tag(Tag::Unknown(KEYS))?.and_then(|value| value.into_u16_vec().ok());
        if let Some([x, y, ..]) = pixel.as_deref() {
            let metres = |key: &[u16]| matches!(key, [PROJECTED_UNIT, 0, _, METRE]);
            if keys.unwrap_or_default().chunks_exact(4).any(metres) {
                found.extent = [x, y].map(|side| Extent::of_cell(*side, "m"));
            } else {
                found.notes.push(format!(
                    "the file has pixels of {x} x {y} in the unit of its map projection, which it does not name: cell says it"
                ));
            }
        }
        Ok(found)
    }

    /// The items `<Item name="SCALE" sample="0" role="scale">0.01</Item>` of the first sample.
    fn metadata(&mut self, text: &str) {
        let mut reader = quick_xml::Reader::from_str(text);
        let mut role = String::new();
        loop {
            match reader.read_event() {
                Ok(Event::Start(element)) if element.local_name().as_ref() == "Item" => {
                    let attribute = |name: &str| {
                        let attribute = element.try_get_attribute(name).ok().flatten();
                        attribute.map(|attribute| attribute.value.to_string()).unwrap_or_default()
                    };
                    let first = matches!(attribute("sample").as_str(), "" | "0");
                    role = if first { attribute("role") } else { String::new() };
                }
                Ok(Event::Text(text)) => {
                    let text = text.xml10_content();
                    let text = text.trim();
                    let field = match role.as_str() {
                        "scale" => &mut self.scale,
                        "offset" => &mut self.shift,
                        "unittype" if !text.is_empty() => {
                            self.unit = Some(text.to_owned());
                            continue;
                        }
                        _ => continue,
                    };
                    *field = text.parse().ok();
                    if field.is_none() && !text.is_empty() {
                        let text: String = text.chars().take(32).collect();
                        self.wrong = Some(format!("a number as {role} of GDAL's metadata, found {text:?}"));
                    }
                }
                Ok(Event::End(_)) => role.clear(),
                Ok(Event::Eof) | Err(_) => return,
                Ok(_) => {}
            }
        }
    }
}
