//! Private tags of JPK's microscopes: what the numbers of an image mean, and the size of the grid.
//!
//! After Gwyddion's `jpkscan.c`, which S. Neumann of JPK wrote, and `SurfaceTopography`'s `IO/JPK.py`: of the scalings of an image, the default
//! one makes `multiplier * number + offset` in its unit, where it is linear. The first row of the file is the bottom of the image, so the last
//! row, unless the grid is reflected (Gwyddion). The sides are metres, in the first directory.

use crate::channel::StoredUnit;
use crate::extent::Extent;
use std::io::{Read, Seek};
use tiff::decoder::Decoder;
use tiff::decoder::ifd::Value;
use tiff::tags::Tag;

/// Tags: sides of the grid, whether it is reflected; name, retrace, readable name of an image; number of its scalings, name of the default one.
const SIDES: [u16; 2] = [0x8042, 0x8043];
const REFLECTED: u16 = 0x8045;
const NAMES: [u16; 2] = [0x8052, 0x8050];
const RETRACE: u16 = 0x8051;
const SCALINGS: u16 = 0x8080;
const DEFAULT: u16 = 0x8081;
/// Of each scaling: name, unit, type, multiplier and offset.
const OF_SCALING: [u16; 5] = [0x8090, 0x80a2, 0x80a3, 0x80a4, 0x80a5];
/// Tags from one scaling to the next, and most scalings.
const STRIDE: u16 = 0x30;
const MOST: u32 = 64;

/// What the tags say of one image.
pub(super) struct Jpk {
    pub(super) name: String,
    pub(super) unit: StoredUnit,
    pub(super) scale: f64,
    pub(super) shift: f64,
    pub(super) reflected: bool,
}

/// A value of a tag that may be another program's.
fn find<R: Read + Seek>(decoder: &mut Decoder<R>, tag: u16) -> Option<Value> {
    decoder.find_tag(Tag::Unknown(tag)).ok().flatten()
}

fn text<R: Read + Seek>(decoder: &mut Decoder<R>, tag: u16) -> Option<String> {
    let text = find(decoder, tag)?.into_string().ok()?;
    Some(text.trim().chars().take(64).collect())
}

fn number<R: Read + Seek>(decoder: &mut Decoder<R>, tag: u16) -> Option<f64> {
    find(decoder, tag)?.into_f64().ok().filter(|number| number.is_finite())
}

fn flag<R: Read + Seek>(decoder: &mut Decoder<R>, tag: u16) -> bool {
    find(decoder, tag).and_then(|value| value.into_u32().ok()).is_some_and(|flag| flag != 0)
}

/// The sides of the grid, in the first directory.
pub(super) fn extent<R: Read + Seek>(decoder: &mut Decoder<R>) -> [Option<Extent>; 2] {
    SIDES.map(|tag| Extent::of_side(number(decoder, tag)?, "m"))
}

impl Jpk {
    /// `None` where the tags are not there.
    pub(super) fn of<R: Read + Seek>(decoder: &mut Decoder<R>) -> Option<Self> {
        let scalings = find(decoder, SCALINGS)?.into_u32().ok()?.min(MOST) as u16;
        let default = text(decoder, DEFAULT)?;
        let name = NAMES.into_iter().find_map(|tag| text(decoder, tag))?;
        let scaling = (0..scalings).map(|i| OF_SCALING.map(|tag| tag + i * STRIDE));
        let found = scaling.into_iter().find(|tags| text(decoder, tags[0]).as_ref() == Some(&default));
        let linear = found.filter(|tags| text(decoder, tags[2]).as_deref() == Some("LinearScaling"));
        let calibrated = linear.and_then(|[_, unit, _, multiplier, offset]| {
            Some((text(decoder, unit)?, number(decoder, multiplier)?, number(decoder, offset)?))
        });
        let (unit, scale, shift) = match calibrated {
            Some((unit, scale, shift)) => (StoredUnit::written(&unit), scale, shift),
            None => (StoredUnit::NoHeights(Some("a scaling that is not linear".into())), 1.0, 0.0),
        };
        let name = if flag(decoder, RETRACE) { format!("{name} (retrace)") } else { name };
        Some(Self { name, unit, scale, shift, reflected: flag(decoder, REFLECTED) })
    }
}
