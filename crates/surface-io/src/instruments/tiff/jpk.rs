//! Private tags of JPK's microscopes: what the numbers of an image mean, and the size of the grid.
//!
//! After Gwyddion's `jpkscan.c` and `jpk.h`, which S. Neumann of JPK wrote, and `SurfaceTopography`'s
//! `IO/JPK.py`: of the scalings of an image, the default one makes `multiplier * number + offset` in its
//! unit, where it is linear. The first row of the file is the bottom of the image, so the last row, unless
//! the grid is reflected (Gwyddion). The sides are metres, in the first directory. Amplitudes and deflections
//! in metres are no heights. The sums of six images of AFMReader (<https://github.com/AFM-SPM/AFMReader>,
//! `tests/test_jpk.py`) agree.

use super::directory::Directories;
use crate::instruments::prelude::*;

/// Sides of the grid.
const SIDES: [u16; 2] = [0x8042, 0x8043];
const REFLECTED: u16 = 0x8045;
/// Readable name and name of an image.
const NAMES: [u16; 2] = [0x8052, 0x8050];
const RETRACE: u16 = 0x8051;
/// Name of the scaling that counts.
const DEFAULT: u16 = 0x8081;
/// Of the first scaling: name, unit, type, multiplier and offset.
const NAME: u16 = 0x8090;
const UNIT: u16 = 0x80a2;
const TYPE: u16 = 0x80a3;
const MULTIPLIER: u16 = 0x80a4;
const OFFSET: u16 = 0x80a5;
/// Tags from one scaling to the next, and most scalings.
const STRIDE: u16 = 0x30;
const MOST: u16 = 64;

/// What the tags say of one image.
pub(super) struct Jpk {
    pub(super) name: String,
    pub(super) unit: StoredUnit,
    pub(super) scale: f64,
    pub(super) shift: f64,
    pub(super) reflected: bool,
    pub(super) extent: [Option<Extent>; 2],
}

impl Jpk {
    /// `None` where the tags are not there.
    pub(super) fn of(source: &mut OpenedFile<'_>, tags: &Directories, image: usize) -> Result<Option<Self>> {
        let mut name = None;
        for tag in NAMES {
            name = if name.is_none() { tags.text(source, image, tag)? } else { name };
        }
        let (Some(mut name), Some(default)) = (name, tags.text(source, image, DEFAULT)?) else {
            return Ok(None);
        };
        let mut flag =
            |tag| Ok::<_, crate::Error>(tags.number(source, image, tag)?.is_some_and(|n| n.abs() > 0.0));
        let reflected = flag(REFLECTED)?;
        if flag(RETRACE)? {
            name += " (retrace)";
        }
        let mut calibration = (StoredUnit::NoHeights(None), 1.0, 0.0);
        for first in (0..MOST).map(|i| i * STRIDE) {
            if tags.text(source, image, first + NAME)?.as_ref() != Some(&default) {
                continue;
            }
            let unit = tags.text(source, image, first + UNIT)?.unwrap_or_default();
            let multiplier = tags.number(source, image, first + MULTIPLIER)?;
            let offset = tags.number(source, image, first + OFFSET)?;
            calibration = match (tags.text(source, image, first + TYPE)?.as_deref(), multiplier, offset) {
                (Some("LinearScaling"), Some(scale), Some(shift)) => {
                    (StoredUnit::of_signal(&name, &unit), scale, shift)
                }
                _ => (StoredUnit::NoHeights(Some("a scaling that is not linear".into())), 1.0, 0.0),
            };
            break;
        }
        let mut extent = [None; 2];
        for (side, tag) in extent.iter_mut().zip(SIDES) {
            *side = tags.number(source, 0, tag)?.and_then(|side| Extent::of_side(side, "m"));
        }
        let (unit, scale, shift) = calibration;
        Ok(Some(Self { name, unit, scale, shift, reflected, extent }))
    }
}
