//! A field over a rectangle: axes, colour bar and title.

use crate::axis::Axis;
use crate::colours::ColourScale;
use crate::drawing::{Anchor, Drawing, LabelPlace, Paint, Rectangle, polygon, polyline, rectangle};
use crate::error::{Error, Result};
use crate::frame::{AxisSide, Frame, TICK, TickStyle};
use crate::inset;
use crate::mark;
use crate::pixels::{Pixels, raster, reduction};
use crate::style::{INK, NEUTRAL};
use crate::text::Fonts;
use contact_model::units::{amount, multiple};
use contact_model::{Cells, Size};
use std::borrow::Cow;
use std::ops::Range;

/// A field with its title and labels.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldPicture<'a> {
    /// Title above the map.
    pub title: String,
    /// Line below the title.
    pub subtitle: String,
    /// Label of the colour bar.
    pub quantity: String,
    /// Unit of the values, as they are given; the picture chooses a prefix. Empty for none.
    pub unit: &'a str,
    /// Unit of x and y, likewise.
    pub length_unit: &'a str,
    /// Columns and rows.
    pub cells: Cells,
    /// Sides of the rectangle.
    pub size: Size,
    /// Values on the cells, row-major; NaN where a point is undefined.
    pub values: &'a [f64],
    /// Whether zeros are white, as where there is no contact.
    pub white_zero: bool,
    /// Whether the sign matters, as for pressures and tensions: a field with both signs is blue to red.
    pub signed: bool,
    /// Ends of the colour scale, so that several pictures share one; `None`: those of the values.
    pub range: Option<(f64, f64)>,
    /// Cells in contact, which are outlined; empty for none.
    pub contact: &'a [bool],
    /// Components along x and y of the vector whose magnitude the values are; arrows show its direction.
    pub arrows: Option<[&'a [f64]; 2]>,
    /// Lines on the map, such as the paths of a flow, as points (x, y) in the unit of the sides.
    pub lines: &'a [Vec<[f64; 2]>],
    /// Points that are marked with a ring, likewise.
    pub marks: &'a [[f64; 2]],
    /// Whether the second axis is a depth: the first row is on top, and the axis is -z.
    pub downwards: bool,
    /// Names of the classes that the values 0, 1, ... stand for: a legend with a colour for each class takes
    /// the place of the scale. Empty for measured values.
    pub classes: &'a [&'a str],
}

/// Pixels along the longer side of the map, about: with more cells along it the picture is reduced.
const SIDE: usize = 1040;
/// The least length of the shorter side, as a share of the longer one.
const SHORTEST: f64 = 0.05;
/// Units of the drawing per pixel.
const PIXEL: f64 = 0.5;
const LEFT: f64 = 84.0;
const TOP: f64 = 62.0;
const RIGHT: f64 = 124.0;
const BELOW: f64 = 60.0;
const BAR: f64 = 18.0;
/// From the map to the bar of colours or the classes.
const BESIDE: f64 = 24.0;
/// Side of the enlarged largest contact, and the least side of its frame on the map.
const INSET: f64 = 220.0;
const FRAME: f64 = 16.0;
/// The bar is at least as high as its labels need.
const SHORTEST_BAR: f64 = 160.0;
/// Size of the words at an axis.
const NAME: f64 = 1.2 * TICK;
/// Outline of the contact, a white line with a black edge: on any colour one of both is seen, by colour-blind
/// readers too.
const OUTLINE: [[u8; 3]; OUTLINE_WIDTH] = [[255; 3], [0; 3]];
/// In pixels.
const OUTLINE_WIDTH: usize = 2;
/// Outside of the contact and of its outline.
const FAR: usize = usize::MAX;
/// Arrows along the longer side of the map, at most.
const ARROWS: f64 = 26.0;
/// Length of an arrow and of its head, in distances between arrows.
const ARROW: f64 = 0.85;
const ARROW_HEAD: f64 = 0.28;
/// Radius of the ring around a marked point.
const RING: f64 = 11.0;
/// Width of the line around the map; it lies outside of its pixels.
const LINE: f64 = 1.2;
/// Size of the line that says how a picture is reduced, and its room.
const NOTE: f64 = 12.0;
const NOTE_ROOM: f64 = 20.0;

impl FieldPicture<'_> {
    /// The smallest and the largest finite value.
    pub fn ends(values: &[f64]) -> (f64, f64) {
        let finite = values.iter().copied().filter(|v| v.is_finite());
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    }

    /// The colours of its values: those of the range or of the classes.
    pub fn scale(&self) -> ColourScale {
        let range = match self.classes.len() {
            0 => self.range.unwrap_or_else(|| Self::ends(self.values)),
            count => (0.0, (count - 1) as f64),
        };
        ColourScale::new(range, self.white_zero, self.signed)
    }

    /// The bytes of a PNG, y upwards. The colours are those of [`FieldPicture::scale`]; undefined points are grey,
    /// the contact has a white outline with a black edge, which lies outside of it. Arrows have one length;
    /// each shows the sum of the vectors of a block of cells, at their centre weighted by magnitude.
    ///
    /// Up to 1040 cells along the longer side, a cell that is a square has a square of whole pixels. Where a
    /// pixel has several cells, it shows one of them, so chosen that shares of areas, means and extrema are
    /// those of the field, and a line below the map says so.
    ///
    /// Where less than a hundredth of the map is in contact, its largest connected contact is enlarged beside it.
    ///
    /// Cost: linear in the number of cells.
    ///
    /// # Errors
    /// [`Error`] with the name that the caller gives the picture, for another number of values, components or
    /// cells in contact than cells, no cells or a size that is not positive.
    pub fn png(&self, name: &str) -> Result<Vec<u8>> {
        self.validate(name)?;
        let fonts = Fonts::load()?;
        let pixels = raster(self.cells, self.size, SIDE, SHORTEST);
        let [w, h] = [pixels.columns, pixels.rows].map(|count| PIXEL * count as f64);
        let place = [LEFT, TOP, w, h];
        let note = reduction(self.cells, pixels);
        let bottom = TOP + h.max(SHORTEST_BAR) + BELOW;
        let inset = inset::window(self.cells, self.size, &self.touching());
        let width = LEFT + w + RIGHT + inset.as_ref().map_or(0.0, |_| INSET + 2.0 * BESIDE);
        let mut drawing = Drawing::new(width, bottom + note.as_ref().map_or(0.0, |_| NOTE_ROOM));
        let scale = self.scale().widened();
        let image = self.image(pixels, |v| scale.colour(v)).into_flattened();
        drawing.image(place, image, pixels.columns);
        if let Some(note) = note {
            let at = LabelPlace::new((LEFT, bottom + 0.5 * NOTE_ROOM), Anchor::Start);
            drawing.label(fonts.fitted(&note, NOTE, w + RIGHT), at, NEUTRAL);
        }
        self.draw_arrows(&mut drawing, place);
        self.draw_lines_and_marks(&mut drawing, place);
        let map = Frame { fonts: &fonts, place, style: TickStyle::OF_MAPS };
        self.draw_axes(&mut drawing, &map);
        if self.classes.is_empty() {
            self.draw_scale(&mut drawing, &map, scale);
        } else {
            self.draw_classes(&mut drawing, &map, scale);
        }
        if let Some(window) = inset {
            self.draw_inset(&mut drawing, &map, window, scale);
        }
        drawing.heading(&fonts, &self.title, (&self.subtitle, 15.0), LEFT);
        drawing.png(&fonts, name)
    }

    /// Refuses another number of values, components or cells in contact than cells, and sides that are not
    /// positive.
    fn validate(&self, name: &str) -> Result<()> {
        let count = self.cells.checked_count().filter(|count| *count > 0);
        if count != Some(self.values.len()) || !self.contact.is_empty() && count != Some(self.contact.len()) {
            let (values, contact, Cells { columns, rows }) =
                (self.values.len(), self.contact.len(), self.cells);
            let message = format!(
                "{values} values and {contact} cells in contact are no field of {rows} rows x {columns} columns"
            );
            return Err(Error::new(name, message));
        }
        if let Some(component) = self.arrows.into_iter().flatten().find(|c| c.len() != self.values.len()) {
            let message = format!("{} components of {} values", component.len(), self.values.len());
            return Err(Error::new(name, message));
        }
        self.cells.validate(self.size).map_err(|e| Error::new(name, e.to_string()))
    }

    /// The cells in contact: those that are given or, of a pressure, those where it is positive.
    fn touching(&self) -> Cow<'_, [bool]> {
        if self.contact.is_empty() && self.white_zero {
            return self.values.iter().map(|value| *value > 0.0).collect();
        }
        Cow::Borrowed(self.contact)
    }

    /// The axes of the map, with their names, and the line around it.
    fn draw_axes(&self, drawing: &mut Drawing, map: &Frame<'_>) {
        let Size { x, y } = self.size;
        let [left, top, w, h] = map.place;
        let (unit, per_unit) = multiple(self.length_unit, x.max(y));
        map.axis(drawing, AxisSide::Below, Axis::Linear(0.0, per_unit * x), None);
        let (second, name) = if self.downwards {
            (Axis::Linear(-per_unit * y, 0.0), "$-z$")
        } else {
            (Axis::Linear(0.0, per_unit * y), "$y$")
        };
        map.axis(drawing, AxisSide::Left, second, None);
        let around = [left - 0.5 * LINE, top - 0.5 * LINE, w + LINE, h + LINE];
        Frame { place: around, ..*map }.outline(drawing, LINE);
        map.name_below(drawing, &with_unit("$x$", &unit), NAME, top + h + 3.2 * TICK);
        map.name_beside(drawing, &with_unit(name, &unit), NAME, 1.4 * TICK);
    }

    /// The bar of colours beside the map, with its axis and its name.
    fn draw_scale(&self, drawing: &mut Drawing, map: &Frame<'_>, scale: ColourScale) {
        let [left, top, w, h] = map.place;
        let place = [left + w + BESIDE, top, BAR, h.max(SHORTEST_BAR)];
        let (low, high) = scale.ends();
        let steps = (place[3] / PIXEL) as usize;
        let ramp = |i: usize| {
            let t = (i as f64 + 0.5) / steps as f64;
            scale.colour(low * t + high * (1.0 - t))
        };
        drawing.image(place, (0..steps).flat_map(ramp).collect(), 1);
        let (unit, per_unit) = multiple(self.unit, low.abs().max(high.abs()));
        let style = TickStyle { beside: [9.0, 0.5 * TICK], ..TickStyle::OF_MAPS };
        let bar = Frame { fonts: map.fonts, place, style };
        bar.axis(drawing, AxisSide::Right, Axis::Linear(per_unit * low, per_unit * high), None);
        bar.outline(drawing, 1.2);
        let words = left + w + RIGHT - 0.6 * TICK;
        bar.name_beside(drawing, &with_unit(&self.quantity, &unit), NAME, words);
    }

    /// The largest contact, enlarged beside the bar of colours, and its place on the map.
    fn draw_inset(
        &self,
        drawing: &mut Drawing,
        map: &Frame<'_>,
        (rows, columns): (Range<usize>, Range<usize>),
        scale: ColourScale,
    ) {
        let [left, top, w, h] = map.place;
        let Cells { columns: all_columns, rows: all_rows } = self.cells;
        let (across, up) = (w / all_columns as f64, h / all_rows as f64);
        let cells = Cells { columns: columns.len(), rows: rows.len() };
        let side = |all: f64, part: usize, whole: usize| all * part as f64 / whole as f64;
        let size = Size {
            x: side(self.size.x, cells.columns, all_columns),
            y: side(self.size.y, cells.rows, all_rows),
        };
        let kept = rows.clone().flat_map(|y| columns.clone().map(move |x| y * all_columns + x));
        let kept: Vec<usize> = kept.collect();
        let values: Vec<f64> = kept.iter().map(|cell| self.values[*cell]).collect();
        let contact: Vec<bool> = kept.iter().filter_map(|cell| self.contact.get(*cell).copied()).collect();
        let enlarged = FieldPicture {
            cells,
            size,
            values: &values,
            contact: &contact,
            arrows: None,
            lines: &[],
            marks: &[],
            ..self.clone()
        };
        let pixels = raster(cells, size, (INSET / PIXEL) as usize, SHORTEST);
        let [wide, high] = [pixels.columns, pixels.rows].map(|count| PIXEL * count as f64);
        let place = [left + w + RIGHT + BESIDE, top, wide, high];
        drawing.image(place, enlarged.image(pixels, |v| scale.colour(v)).into_flattened(), pixels.columns);
        // The frame on the map hides nothing of a window of a few pixels.
        let [wide_on_map, high_on_map] = [across * cells.columns as f64, up * cells.rows as f64];
        let room = (0.5 * (FRAME - wide_on_map.min(high_on_map))).max(0.0);
        let on_map = [
            left + across * columns.start as f64 - room,
            top + h - up * rows.end as f64 - room,
            wide_on_map + 2.0 * room,
            high_on_map + 2.0 * room,
        ];
        for place in [place, on_map] {
            // Seen on dark and on light colours.
            drawing.path(rectangle(place), Paint::stroked("#ffffff", 3.0 * LINE), None);
            drawing.path(rectangle(place), Paint::stroked(INK, LINE), None);
        }
        let words = format!("The largest contact; frame {} wide", amount(size.x, self.length_unit));
        let at = LabelPlace::new((place[0], top + high + 1.4 * TICK), Anchor::Start);
        drawing.label(map.fonts.fitted(&words, TICK, INSET + BESIDE), at, INK);
    }

    /// A square of the colour of each class with its words beside the map, the last one on top.
    fn draw_classes(&self, drawing: &mut Drawing, map: &Frame<'_>, scale: ColourScale) {
        let (left, top) = (map.place[0] + map.place[2] + BESIDE, map.place[1]);
        for (line, (value, words)) in self.classes.iter().enumerate().rev().enumerate() {
            let y = top + line as f64 * 1.6 * BAR;
            drawing.image([left, y, BAR, BAR], scale.colour(value as f64).to_vec(), 1);
            let corners = [(left, y), (left + BAR, y), (left + BAR, y + BAR), (left, y + BAR)];
            drawing.path(polygon(&corners), Paint::stroked(INK, 1.2), None);
            let at = (left + BAR + 9.0, y + 0.5 * BAR + 0.35 * TICK);
            drawing.label(map.fonts.typeset(words, TICK), LabelPlace::new(at, Anchor::Start), INK);
        }
    }

    /// The lines and the rings around marked points, both seen on dark and on light colours.
    fn draw_lines_and_marks(&self, drawing: &mut Drawing, frame: Rectangle) {
        let [left, top, w, h] = frame;
        let on_map = |[x, y]: &[f64; 2]| {
            let up = y / self.size.y;
            (left + w * (x / self.size.x), top + h * if self.downwards { up } else { 1.0 - up })
        };
        for line in self.lines {
            let points: Vec<(f64, f64)> = line.iter().map(on_map).collect();
            for (color, width) in [(INK, 2.4), ("#ffffff", 1.2)] {
                drawing.path(polyline(&points), Paint::stroked(color, width), Some(frame));
            }
        }
        for point in self.marks {
            for (color, width) in [(INK, 5.0), ("#ffffff", 2.4)] {
                let ring = mark::circle(on_map(point).0, on_map(point).1, RING);
                drawing.path(ring, Paint::stroked(color, width), Some(frame));
            }
        }
    }

    /// An arrow for each block of cells, in the direction of the sum of its vectors.
    fn draw_arrows(&self, drawing: &mut Drawing, frame: Rectangle) {
        let Some([along_x, along_y]) = self.arrows else { return };
        let [left, top, w, h] = frame;
        let Cells { columns, rows } = self.cells;
        let distance = w.max(h) / ARROWS;
        // Cells of a block; no arrow is longer than a cell that is larger than the distance.
        let across = ((distance * columns as f64 / w).round() as usize).max(1);
        let up = ((distance * rows as f64 / h).round() as usize).max(1);
        let length = (across as f64 * w / columns as f64).min(up as f64 * h / rows as f64);
        for (y0, x0) in (0..rows).step_by(up).flat_map(|y| (0..columns).step_by(across).map(move |x| (y, x)))
        {
            // Components, and the magnitude with its moments.
            let (mut sum, mut weight, mut middle) = ([0.0; 2], 0.0, [0.0; 2]);
            for iy in y0..(y0 + up).min(rows) {
                for ix in x0..(x0 + across).min(columns) {
                    let i = iy * columns + ix;
                    let (x, y) = (along_x[i], along_y[i]);
                    let magnitude = x.hypot(y);
                    if magnitude.is_finite() && magnitude > 0.0 {
                        sum = [sum[0] + x, sum[1] + y];
                        weight += magnitude;
                        let at = [ix as f64 + 0.5, iy as f64 + 0.5];
                        middle = [middle[0] + magnitude * at[0], middle[1] + magnitude * at[1]];
                    }
                }
            }
            let norm = sum[0].hypot(sum[1]);
            if !(norm.is_finite() && weight.is_finite() && norm > 0.0) {
                continue;
            }
            let centre = [
                left + w * middle[0] / weight / columns as f64,
                top + h - h * middle[1] / weight / rows as f64,
            ];
            // The drawing counts y downwards.
            let (dx, dy) = (sum[0] / norm, -sum[1] / norm);
            let at = |along: f64, aside: f64| {
                let [x, y] = centre;
                (x + length * (along * dx - aside * dy), y + length * (along * dy + aside * dx))
            };
            let (tip, back) = (0.5 * ARROW, 0.5 * ARROW - ARROW_HEAD);
            let shaft = polyline(&[at(-tip, 0.0), at(tip, 0.0)]);
            let head = polyline(&[at(back, 0.6 * ARROW_HEAD), at(tip, 0.0), at(back, -0.6 * ARROW_HEAD)]);
            let pieces = [shaft, head].concat();
            // Seen on dark and on light colours.
            drawing.path(pieces.clone(), Paint::stroked("#ffffff", 3.2), Some(frame));
            drawing.path(pieces, Paint::stroked(INK, 1.3), Some(frame));
        }
    }

    /// Colours of all pixels, the upper left one first.
    fn image(&self, pixels: Cells, color: impl Fn(f64) -> [u8; 3]) -> Vec<[u8; 3]> {
        let Cells { columns, rows } = pixels;
        let reduced = Pixels::new(self.cells, pixels, self.values);
        // From the lower left corner.
        let at = |i: usize| (i % columns, i / columns);
        let around = |i: usize| {
            let (x, y) = at(i);
            let (across, down) =
                (x.saturating_sub(1)..=(x + 1).min(columns - 1), y.saturating_sub(1)..=(y + 1).min(rows - 1));
            down.flat_map(move |y| across.clone().map(move |x| y * columns + x))
        };
        let all = 0..columns * rows;
        let shown: Vec<usize> = all.clone().map(|i| reduced.cell(at(i).0, at(i).1)).collect();
        let touches = |cell: &usize| self.contact.get(*cell) == Some(&true);
        // Pixels from the contact: 0 in it, then 1 and 2 of the outline.
        let mut distance: Vec<usize> = shown.iter().map(|cell| if touches(cell) { 0 } else { FAR }).collect();
        for ring in 1..=OUTLINE_WIDTH {
            let reached = all.clone().filter(|i| distance[*i] == ring - 1).flat_map(around);
            for i in reached.collect::<Vec<_>>() {
                distance[i] = distance[i].min(ring);
            }
        }
        let pixel = |i: usize| match distance[i] {
            ring @ 1..=OUTLINE_WIDTH => OUTLINE[ring - 1],
            _ => color(self.values[shown[i]]),
        };
        let row = |down: usize| if self.downwards { down } else { rows - 1 - down };
        (0..rows).map(row).flat_map(|y| (0..columns).map(move |x| y * columns + x)).map(pixel).collect()
    }
}

/// The name of a quantity with its unit, where it has one.
fn with_unit(words: &str, unit: &str) -> String {
    match unit {
        "" => words.to_owned(),
        // A power is set as such.
        unit if unit.contains('^') => format!("{words} ($\\rm{{{unit}}}$)"),
        unit => format!("{words} ({unit})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::Field;

    fn picture(field: &Field, white_zero: bool) -> FieldPicture<'_> {
        let (title, subtitle, quantity) = ("t".into(), "s".into(), "p".into());
        let (cells, size, values) = (field.cells(), field.size(), field.values());
        let contact = &[];
        FieldPicture {
            title,
            subtitle,
            quantity,
            unit: "Pa",
            length_unit: "m",
            cells,
            size,
            values,
            white_zero,
            signed: false,
            range: None,
            contact,
            arrows: None,
            lines: &[],
            marks: &[],
            downwards: false,
            classes: &[],
        }
    }

    /// Colours of a PNG at points of the map, counted from its lower left corner in shares of its sides.
    fn colors(field: &Field, white_zero: bool, at: &[(f64, f64)]) -> Vec<[u8; 3]> {
        let (pixels, map) = read_map(picture(field, white_zero).png("f").unwrap(), field);
        let pixel = |&(x, y): &(f64, f64)| {
            let (x, y) = ((x * pixels.columns as f64) as usize, (y * pixels.rows as f64) as usize);
            map[y * pixels.columns + x]
        };
        at.iter().map(pixel).collect()
    }

    /// The pixels inside the frame of a picture of a field, from the lower left corner.
    fn read_map(file: Vec<u8>, field: &Field) -> (Cells, Vec<[u8; 3]>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let samples = info.color_type.samples();
        let pixels = raster(field.cells(), field.size(), SIDE, SHORTEST);
        let (left, top) = ((LEFT / PIXEL) as usize, (TOP / PIXEL) as usize);
        let pixel = |i: usize| {
            let (x, y) = (left + i % pixels.columns, top + pixels.rows - 1 - i / pixels.columns);
            let at = samples * (y * info.width as usize + x);
            [0, 1, 2].map(|channel| bytes[at + channel.min(samples - 1)])
        };
        (pixels, (0..pixels.columns * pixels.rows).map(pixel).collect())
    }

    /// How far shares of the area and means of a reduced picture may be from those of its field, in parts of
    /// the whole and for one pixel: at most as with a random choice of the cells, about twice its standard
    /// deviation.
    const REDUCTION: f64 = 0.7;
    /// Of sums over 1e5 cells.
    const ROUNDING: f64 = 1e-10;

    /// A rough rectangle pressed to some share of its area, with holes: a pressure, undefined in the holes.
    fn pressed(cells: [usize; 2], size: [f64; 2], seed: u64) -> Field {
        let surface = contact_model::SelfAffine::new(2.2, size, 1.0).unwrap();
        let map = surface_gen::self_affine_map(&surface, cells, seed).unwrap();
        let hole = |i: usize| (i % cells[0] / 7 + i / cells[0] / 5).is_multiple_of(11);
        let pressure = |(i, h): (usize, &f64)| if hole(i) { f64::NAN } else { (h - 0.7).max(0.0) };
        Field::new(cells, size, map.heights().iter().enumerate().map(pressure).collect()).unwrap()
    }

    /// Cells, sides, and whether every cell has pixels of its own. The maps are small, at the limit and beyond it;
    /// rectangles, strips and oblong cells.
    const PRESSED: [([usize; 2], [f64; 2], bool); 7] = [
        ([64, 16], [4.0, 1.0], true),
        ([512, 128], [4.0, 1.0], true),
        ([1040, 130], [8.0, 1.0], true),
        ([1100, 275], [4.0, 1.0], false),
        ([2049, 683], [3.0, 1.0], false),
        ([300, 100], [4.0, 1.0], false),
        ([4000, 40], [100.0, 1.0], false),
    ];

    /// A pressed rectangle, whose pictures are read back.
    struct PressedField {
        field: Field,
        pixels: Cells,
        /// How far shares and means of a picture may be from those of the field.
        tolerance: f64,
    }

    impl PressedField {
        fn all() -> impl Iterator<Item = Self> {
            PRESSED.into_iter().map(|(cells, size, whole)| {
                let field = pressed(cells, size, 7);
                let pixels = raster(field.cells(), field.size(), SIDE, SHORTEST);
                let count = pixels.columns as f64 * pixels.rows as f64;
                let tolerance = if whole { ROUNDING } else { REDUCTION / count.sqrt() };
                Self { field, pixels, tolerance }
            })
        }

        /// A field on the same cells.
        fn with(&self, value: impl Fn(f64) -> f64) -> Field {
            let values = self.field.values().iter().map(|v| value(*v)).collect();
            Field::new(self.field.cells(), self.field.size(), values).unwrap()
        }

        /// The share of the cells whose pressure is of this kind.
        fn share(&self, of: impl Fn(f64) -> bool) -> f64 {
            let values = self.field.values();
            values.iter().filter(|v| of(**v)).count() as f64 / values.len() as f64
        }

        fn near(&self, found: f64, expected: f64, what: &str) {
            let (cells, off) = (self.field.cells(), (found - expected).abs());
            println!("{cells:?} {what}: {expected:.5} in the field, off by {off:.1e}");
            assert!(off <= self.tolerance, "{cells:?} {what}: {found} for {expected}");
        }
    }

    fn share_of_pixels(map: &[[u8; 3]], color: [u8; 3]) -> f64 {
        map.iter().filter(|p| **p == color).count() as f64 / map.len() as f64
    }

    #[test]
    fn pictures_of_pressures_have_the_shares_of_their_fields() {
        for pressed in PressedField::all() {
            let (low, high) = FieldPicture::ends(pressed.field.values());
            let drawn = picture(&pressed.field, true);
            assert_eq!(drawn.scale().ends(), (0.0, high), "{low}");
            let (_, map) = read_map(drawn.png("a").unwrap(), &pressed.field);
            pressed.near(share_of_pixels(&map, [255; 3]), pressed.share(|v| v == 0.0), "open");
            let undefined = share_of_pixels(&map, crate::colours::UNDEFINED);
            pressed.near(undefined, pressed.share(f64::is_nan), "undefined");
            // The largest pressure has its colour.
            assert!(share_of_pixels(&map, crate::viridis()[255]) > 0.0);
        }
    }

    /// The mean colour, by channel, and with it the mean pressure.
    #[test]
    fn pictures_of_pressures_have_the_means_of_their_fields() {
        for pressed in PressedField::all() {
            let PressedField { field, pixels, .. } = &pressed;
            let (drawn, count) = (picture(field, true), field.values().len() as f64);
            let (_, map) = read_map(drawn.png("a").unwrap(), field);
            let scale = drawn.scale();
            let sum = |sum: [f64; 3], c: [u8; 3]| [0, 1, 2].map(|i| sum[i] + f64::from(c[i]) / 255.0);
            let of_cells = field.values().iter().map(|v| scale.colour(*v)).fold([0.0; 3], sum);
            let of_pixels = map.iter().copied().fold([0.0; 3], sum);
            for (found, expected) in of_pixels.into_iter().zip(of_cells) {
                pressed.near(found / map.len() as f64, expected / count, "colour");
            }
            let reduced = Pixels::new(field.cells(), *pixels, field.values());
            let shown =
                (0..map.len()).map(|i| field.values()[reduced.cell(i % pixels.columns, i / pixels.columns)]);
            let mean = shown.filter(|v| v.is_finite()).sum::<f64>() / map.len() as f64;
            let expected = field.values().iter().filter(|v| v.is_finite()).sum::<f64>() / count;
            let (_, high) = FieldPicture::ends(field.values());
            pressed.near(mean / high, expected / high, "pressure");
        }
    }

    /// Of a contact, of which the harder pressed half sticks.
    #[test]
    fn pictures_of_classes_have_the_shares_of_their_fields() {
        let class = |v: f64| {
            if v > 0.4 {
                1.0
            } else if v > 0.0 {
                2.0
            } else {
                0.0
            }
        };
        for pressed in PressedField::all() {
            let classes = pressed.with(class);
            let drawn = FieldPicture { classes: &["open", "stick", "slip"], ..picture(&classes, true) };
            let (_, map) = read_map(drawn.png("a").unwrap(), &classes);
            for value in [0.0, 1.0, 2.0] {
                let found = share_of_pixels(&map, drawn.scale().colour(value));
                pressed.near(found, pressed.share(|v| (class(v) - value).abs() < 0.5), "class");
            }
        }
    }

    #[test]
    fn the_outline_of_a_contact_lies_outside_of_it() {
        for pressed in PressedField::all() {
            let gap = pressed.with(|v| if v > 0.0 { 0.0 } else { 1.0 });
            let contact: Vec<bool> = pressed.field.values().iter().map(|v| *v > 0.0).collect();
            let drawn = FieldPicture { contact: &contact, ..picture(&gap, false) };
            let (_, map) = read_map(drawn.png("a").unwrap(), &gap);
            let inside = share_of_pixels(&map, drawn.scale().colour(0.0));
            pressed.near(inside, pressed.share(|v| v > 0.0), "outlined");
        }
    }

    #[test]
    fn y_points_upwards_and_single_cells_are_seen() {
        // A row of 2 x 1 at the bottom carries pressure at the right, the row above at the left; one point is
        // undefined.
        let field = Field::new([3, 2], [3.0, 2.0], vec![0.0, f64::NAN, 1.0, 2.0, 0.0, 0.0]).unwrap();
        let found =
            colors(&field, true, &[(0.15, 0.25), (0.5, 0.25), (0.85, 0.25), (0.15, 0.75), (0.5, 0.75)]);
        let viridis = |t| colorous::VIRIDIS.eval_continuous(t).into_array();
        assert_eq!(found, [[255; 3], crate::colours::UNDEFINED, viridis(0.5), viridis(1.0), [255; 3]]);
        // One of a million cells.
        let mut values = vec![0.0; 2000 * 2000];
        values[1000 * 2000 + 500] = 1.0;
        let large = Field::new(2000, 1.0, values).unwrap();
        let (x, y) = ((500.0 + 0.5) / 2000.0, (1000.0 + 0.5) / 2000.0);
        assert_eq!(colors(&large, true, &[(x, y), (0.3, 0.3)]), [viridis(1.0), [255; 3]]);
    }

    #[test]
    fn contacts_are_outlined_and_a_scale_may_be_shared() {
        // Cells of 52 x 52 pixels; the one in the middle of 5 x 5 touches.
        let values: Vec<f64> = (0..25).map(|i| if i == 12 { 0.0 } else { 1.0 }).collect();
        let field = Field::new([5, 5], [5.0, 5.0], values.clone()).unwrap();
        let touching: Vec<bool> = values.iter().map(|v| *v == 0.0).collect();
        let picture = FieldPicture { contact: &touching, range: Some((0.0, 2.0)), ..picture(&field, false) };
        let viridis = |t| colorous::VIRIDIS.eval_continuous(t / 2.0).into_array();
        let image = picture.image([50, 50].into(), viridis);
        let count = |color| image.iter().filter(|pixel| **pixel == color).count();
        // The contact has 10 x 10 pixels, with its outline 14 x 14.
        let [line, edge] = OUTLINE;
        assert_eq!([count(viridis(0.0)), count(line), count(edge)], [100, 44, 52]);
        assert_eq!(count(viridis(1.0)), 2500 - 14 * 14);
        assert_eq!([20, 19, 18].map(|i| image[i * 50 + i]), [viridis(0.0), line, edge]);
        // More cells than pixels: one cell of 10^4 is seen.
        let mut values = vec![1.0; 10_000];
        values[5050] = 0.0;
        let field = Field::new(100, 1.0, values.clone()).unwrap();
        let touching: Vec<bool> = values.iter().map(|v| *v == 0.0).collect();
        let picture = FieldPicture { contact: &touching, ..self::picture(&field, false) };
        let image = picture.image([10, 10].into(), viridis);
        let count = |color| image.iter().filter(|pixel| **pixel == color).count();
        assert_eq!(OUTLINE.map(count), [8, 16]);
    }

    /// Contrast of WCAG 2.1 between linear colours, as a protanope sees them: the projection of Vienot,
    /// Brettel and Mollon (Color Res. Appl. 24, 243, 1999), with the luminance of what is left.
    fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
        let luminance = |color: [u8; 3]| {
            let [r, g, b] = color.map(|c| {
                let c = f64::from(c) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            });
            let yellow = 0.11238 * r + 0.88762 * g;
            let blue = 0.00401 * r - 0.00401 * g + b;
            0.2126 * yellow + 0.7152 * yellow + 0.0722 * blue
        };
        let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
        a.max(b) / a.min(b)
    }

    #[test]
    fn outlines_are_seen_by_protanopes_on_every_colour() {
        for color in crate::Palette::ALL.into_iter().flat_map(crate::Palette::colours) {
            let seen = OUTLINE.map(|line| contrast(line, color)).into_iter().fold(0.0, f64::max);
            assert!(seen >= 3.0, "{color:?}: {seen}");
        }
        // What was there before: red on the dark end of viridis.
        assert!(contrast([228, 26, 28], crate::viridis()[0]) < 2.5);
    }

    #[test]
    fn arrows_point_where_the_vectors_do_and_classes_have_a_legend() {
        // One arrow in the middle of one cell, to the right and to the upper left.
        let drawn = |x: f64, y: f64| {
            let values = [x.hypot(y)];
            let field = Field::new(1, 1.0, values.to_vec()).unwrap();
            let (x, y) = ([x], [y]);
            let picture = FieldPicture { arrows: Some([&x, &y]), ..picture(&field, true) };
            let side = PIXEL * SIDE as f64;
            let mut drawing = Drawing::new(LEFT + side + RIGHT, TOP + side + BELOW);
            picture.draw_arrows(&mut drawing, [LEFT, TOP, side, side]);
            drawing.svg(&Fonts::load().unwrap(), "a picture").unwrap()
        };
        let side = PIXEL * SIDE as f64;
        let middle = (LEFT + 0.5 * side, TOP + 0.5 * side);
        let half = 0.5 * ARROW * side;
        let shaft = |dx: f64, dy: f64| {
            let ends = [-half, half].map(|along| (middle.0 + along * dx, middle.1 - along * dy));
            format!("d=\"M{} {}L{} {}", ends[0].0, ends[0].1, ends[1].0, ends[1].1)
        };
        let right = drawn(2.0, 0.0);
        assert!(right.contains(&shaft(1.0, 0.0)), "{right}");
        let upwards = drawn(0.0, 3.0);
        assert!(upwards.contains(&shaft(0.0, 1.0)), "{upwards}");
        assert!(!drawn(0.0, 0.0).contains("<path d") && !drawn(f64::NAN, 1.0).contains("<path d"));
        let field = Field::new([3, 1], [3.0, 1.0], vec![0.0, 1.0, 2.0]).unwrap();
        let classes = &["open", "stick", "slip"][..];
        let picture = FieldPicture { classes, ..picture(&field, true) };
        picture.png("c").unwrap();
        let short = FieldPicture { arrows: Some([&[0.0; 3], &[0.0; 2]]), ..picture };
        let error = short.png("c").unwrap_err().to_string();
        assert_eq!(error, "c: 2 components of 3 values");
    }

    #[test]
    fn constant_and_oblong_fields_are_drawn() {
        let flat = Field::new([2, 2], [1.0, 1.0], vec![3.0; 4]).unwrap();
        assert_ne!(colors(&flat, false, &[(0.5, 0.5)])[0], [255; 3]);
        let zero = Field::new([2, 2], [1.0, 1.0], vec![0.0; 4]).unwrap();
        assert_eq!(colors(&zero, true, &[(0.5, 0.5)])[0], [255; 3]);
        let long = Field::new([100, 1], [100.0, 1.0], (0..100).map(f64::from).collect()).unwrap();
        picture(&long, false).png("g").unwrap();
        // The largest and the smallest numbers, as sides and as values.
        for side in [1.7e308, 1e-300, 1e-307, 1e-318] {
            let values: Vec<f64> = (0..12).map(|i| f64::from(i) / 12.0 * side).collect();
            for (cells, sides) in [([4, 3], [side, 0.75 * side]), ([3, 4], [side, side])] {
                let field = Field::new(cells, sides, values.clone()).unwrap();
                let (_, map) = read_map(picture(&field, false).png("h").unwrap(), &field);
                assert_eq!([map[0], map[map.len() - 1]], [0, 255].map(|i| crate::viridis()[i]), "{side:e}");
                crate::grey_png("h", cells, sides, field.values()).unwrap();
            }
        }
    }
}
