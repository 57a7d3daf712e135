//! Several grey maps side by side.

use crate::axis::Axis;
use crate::drawing::{Anchor, Drawing, LabelPlace, Paint, rectangle};
use crate::error::{Error, Result};
use crate::frame::{AxisSide, Frame, TICK, TickStyle};
use crate::style::INK;
use crate::text::Fonts;

/// A square map of grey values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GreyMap {
    /// Label above the map; symbols stand between dollar signs.
    pub label: String,
    /// Grey values, row by row from the top.
    pub shades: Vec<u8>,
    /// Number of rows and of columns.
    pub side: usize,
}

/// Scale of the grey values of all maps.
#[derive(Debug, Clone, PartialEq)]
pub struct GreyScale {
    /// The values that are white and black.
    pub ends: (f64, f64),
    /// Label of the scale, with the unit; symbols stand between dollar signs.
    pub label: String,
}

/// Side of one map (two pixels for each of the 257 values that a table of Fig. 1 keeps), the space around it
/// and for its label.
const MAP: f64 = 257.0;
const GAP: f64 = 10.0;
const LABEL: f64 = 28.0;
const TITLE: f64 = 54.0;
/// The bar of grey values, with its ticks and label.
const BAR: f64 = 14.0;
const BELOW: f64 = 58.0;

/// The bytes of `NAME.svg` and `NAME.png`, with at most three maps in a row, a title, a line below it, and the scale
/// of all maps below them.
///
/// # Errors
/// [`Error`] for a map that is no square of at least one value.
pub fn grey_maps(
    maps: Vec<GreyMap>,
    scale: &GreyScale,
    (title, subtitle): (&str, &str),
    name: &str,
) -> Result<[(String, Vec<u8>); 2]> {
    let square = |map: &GreyMap| map.side > 0 && map.side.checked_mul(map.side) == Some(map.shades.len());
    if let Some(map) = maps.iter().find(|map| !square(map)) {
        let message = format!("{} values are no map of {} rows and columns", map.shades.len(), map.side);
        return Err(Error::new(name, message));
    }
    let fonts = Fonts::load()?;
    let columns = maps.len().clamp(1, 3);
    let rows = maps.len().div_ceil(columns);
    let width = GAP + columns as f64 * (MAP + GAP);
    let bottom = TITLE + rows as f64 * (MAP + LABEL) + GAP;
    let mut drawing = Drawing::new(width, bottom + GAP + BAR + BELOW);
    drawing.heading(&fonts, title, (subtitle, 16.0), GAP);
    for (i, map) in maps.into_iter().enumerate() {
        let x = GAP + (i % columns) as f64 * (MAP + GAP);
        let y = TITLE + LABEL + (i / columns) as f64 * (MAP + LABEL);
        let label = fonts.typeset(&map.label, 18.0);
        drawing.label(label, LabelPlace::new((x + 0.5 * MAP, y - 8.0), Anchor::Middle), INK);
        let rgb = map.shades.iter().flat_map(|&shade| [shade; 3]).collect();
        drawing.image([x, y, MAP, MAP], rgb, map.side);
        drawing.path(rectangle([x, y, MAP, MAP]), Paint::stroked(INK, 1.0), None);
    }
    let bar = [GAP + 0.15 * (width - 2.0 * GAP), bottom + GAP, 0.7 * (width - 2.0 * GAP), BAR];
    let (low, high) = scale.ends;
    drawing.image(bar, (0..=u8::MAX).rev().flat_map(|shade| [shade; 3]).collect(), 1 + usize::from(u8::MAX));
    let frame = Frame { fonts: &fonts, place: bar, style: TickStyle::OF_MAPS };
    frame.axis(&mut drawing, AxisSide::Below, Axis::Linear(low, high), None);
    frame.outline(&mut drawing, 1.0);
    frame.name_below(&mut drawing, &scale.label, 1.2 * TICK, bottom + GAP + BAR + 3.2 * TICK);
    drawing.files(&fonts, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_inside_both_files() {
        let map = |label: &str| GreyMap { label: label.into(), shades: vec![0, 80, 160, 255], side: 2 };
        let scale = GreyScale { ends: (-2.0, 3.0), label: "height".into() };
        let maps = vec![map("$D_f$ = 2"), map("$D_f$ = 3")];
        let [(_, svg), (_, png)] = grey_maps(maps, &scale, ("t", "s"), "m").unwrap();
        let svg = String::from_utf8(svg).unwrap();
        assert_eq!(svg.matches("<image").count(), 3);
        assert!(
            ["height", "3", "\u{2212}2"].iter().all(|label| svg.contains(&format!("aria-label=\"{label}\"")))
        );
        assert!(svg.contains("aria-label=\"D_f = 3\"") && svg.contains("data:image/png;base64,"));
        assert!(png.len() > 1000);
        for side in [0, 1, usize::MAX] {
            let wrong = GreyMap { side, ..map("m") };
            assert!(grey_maps(vec![wrong], &scale, ("t", "s"), "n").is_err(), "{side}");
        }
    }
}
