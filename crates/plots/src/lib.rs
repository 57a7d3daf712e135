//! Charts and map pictures of one style, as SVG and PNG.
//!
//! | item | what it draws |
//! |---|---|
//! | [`Chart`] | a few named curves |
//! | [`Picture`] | the figures of the paper and the benchmarks |
//! | [`Panels`] | several pictures in one file |
//! | [`grey_maps`] | maps side by side |
//! | [`grey_png`] | a map of one value per cell |
//!
//! # Conventions
//!
//! * **Labels.** Symbols stand between dollar signs, such as `$\\bar{F} = F/(E^* h L)$`, and are set as
//!   formulas. Other words are upright.
//! * **Axes.** Frames have ticks inwards on four sides. Logarithmic axes have powers of ten, and ticks at 2
//!   to 9.
//! * **Letters** are outlines of the fonts in `fonts/`, so that an SVG needs nothing from the machine that
//!   shows it. Its labels are in `aria-label` as well.
//! * **SVG and PNG** come from one drawing of paths.
//! * **Colours** can be distinguished in grey as well. The same fractal dimension has the same colour in
//!   every picture ([`color`]).
//! * **Maps** have row 0 at the bottom.
//! * **Files** are returned as bytes, with their names. The caller writes them.

#![allow(clippy::format_push_string)] // Text is built once per file: clear beats one allocation less.

mod axis;
mod chart;
mod colours;
mod contour_lines;
mod drawing;
mod error;
mod field;
mod frame;
mod inset;
mod legend;
mod map;
mod maps;
mod mark;
mod panels;
mod pixels;
mod plot;
mod style;
mod text;

pub use axis::{Axis, extent, linear, logarithmic};
pub use chart::{Chart, Curve};
pub use colours::{ColourScale, Palette, encode_viridis, viridis};
pub use contour_lines::contour_lines;
pub use error::{Error, Result};
pub use field::FieldPicture;
pub use legend::Legend;
pub use map::{encode_grey, grey, grey_between, grey_png, most};
pub use maps::{GreyMap, GreyScale, grey_maps};
pub use panels::Panels;
pub use pixels::{reduction, shown_cells};
pub use plot::Picture;
pub use style::{COLORS, LegendKey, LineStyle, Mark, MarkShape, NEUTRAL, REFERENCE, SHAPES, color, shape};
pub use text::number;
