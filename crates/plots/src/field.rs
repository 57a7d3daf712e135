//! A field over a rectangle: axes, colour bar and title.

use crate::axis::Axis;
use crate::colours::ColourScale;
use crate::drawing::{Anchor, Drawing, Paint, Rectangle, polygon, polyline};
use crate::frame::{Frame, Side, TICK, TickStyle};
use crate::style::INK;
use crate::text::Fonts;
use contact_model::units::multiple;
use contact_model::{Cells, Shown, Size};
use files::{Error, Result};
use std::ops::Range;
use std::path::Path;

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
    /// The value that a pixel shows, where it covers several cells.
    pub shown: Shown,
    /// Whether the sign matters, as for pressures and tensions: a field with both signs is blue to red.
    pub signed: bool,
    /// Ends of the colour scale, so that several pictures share one; `None`: those of the values.
    pub range: Option<(f64, f64)>,
    /// Cells in contact, which are outlined; empty for none.
    pub contact: &'a [bool],
    /// Components along x and y of the vector whose magnitude the values are; arrows show its direction.
    pub arrows: Option<[&'a [f64]; 2]>,
    /// Names of the classes that the values 0, 1, ... stand for: a legend with a colour for each class takes
    /// the place of the scale. Empty for measured values.
    pub classes: &'a [&'a str],
}

/// Longer side of the map, in units of the drawing; the shorter one has at least a twentieth of it.
const SIDE: f64 = 520.0;
/// Pixels of the image per unit.
const PIXELS: f64 = 2.0;
const LEFT: f64 = 84.0;
const TOP: f64 = 62.0;
const RIGHT: f64 = 124.0;
const BELOW: f64 = 60.0;
const BAR: f64 = 18.0;
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
/// Where less than this share of the pixels is under pressure, each of these is drawn three pixels wide.
const SPARSE: f64 = 0.02;

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
        ColourScale::new(range, self.shown, self.signed)
    }

    /// Writes a PNG, y upwards. The colours are those of [`FieldPicture::scale`]; undefined points are grey,
    /// the contact has a white outline with a black edge. Under [`Shown::Largest`] a field of which less than
    /// 2 % of the pixels are above zero has each of these drawn three pixels wide. Arrows have one length;
    /// each shows the sum of the vectors of a block of cells, at their centre weighted by magnitude.
    ///
    /// Cost: linear in the number of cells.
    ///
    /// # Errors
    /// [`crate::Error::Content`] for another number of values, components or cells in contact than cells, no
    /// cells or a size that is not positive, [`crate::Error::System`] when it cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        let count = self.cells.checked_count().filter(|count| *count > 0);
        if count != Some(self.values.len()) || !self.contact.is_empty() && count != Some(self.contact.len()) {
            let (values, contact, Cells { columns, rows }) =
                (self.values.len(), self.contact.len(), self.cells);
            let message = format!(
                "{values} values and {contact} cells in contact are no field of {rows} rows x {columns} columns"
            );
            return Err(Error::content(path, message));
        }
        if let Some(component) = self.arrows.into_iter().flatten().find(|c| c.len() != self.values.len()) {
            let message = format!("{} components of {} values", component.len(), self.values.len());
            return Err(Error::content(path, message));
        }
        self.cells.validate(self.size).map_err(|e| Error::content(path, e.to_string()))?;
        let fonts = Fonts::load()?;
        let size = self.size;
        let longer = size.x.max(size.y);
        let [w, h] = [size.x, size.y].map(|side| SIDE * (side / longer).max(0.05));
        let mut drawing = Drawing::new(LEFT + w + RIGHT, TOP + h.max(160.0) + BELOW);
        let frame = [LEFT, TOP, w, h];
        let scale = self.scale().widened();
        let (low, high) = scale.ends();
        let color = |v: f64| scale.colour(v);
        let [columns, rows] = [w, h].map(|side| (side * PIXELS).round() as usize);
        let image = self.image(columns, rows, color).into_flattened();
        drawing.image(frame, image, columns);
        self.draw_arrows(&mut drawing, frame);
        let (length_unit, per_length) = multiple(self.length_unit, longer);
        let map = Frame { fonts: &fonts, place: frame, style: TickStyle::OF_MAPS };
        map.axis(&mut drawing, Side::Below, Axis::Linear(0.0, per_length * size.x), None);
        map.axis(&mut drawing, Side::Left, Axis::Linear(0.0, per_length * size.y), None);
        map.outline(&mut drawing, 1.2);
        let with = |words: &str, unit: &str| {
            if unit.is_empty() { words.to_owned() } else { format!("{words} ({unit})") }
        };
        map.name_below(&mut drawing, &with("$x$", &length_unit), NAME, TOP + h + 3.2 * TICK);
        map.name_beside(&mut drawing, &with("$y$", &length_unit), NAME, 1.4 * TICK);
        let beside = LEFT + w + 24.0;
        if !self.classes.is_empty() {
            self.draw_classes(&mut drawing, &fonts, (beside, TOP), color);
            drawing.heading(&fonts, &self.title, (&self.subtitle, 15.0), LEFT);
            return files::write_whole(path, &drawing.png(&fonts, path)?);
        }
        // The bar is at least as high as its labels need.
        let bar = [beside, TOP, BAR, h.max(160.0)];
        let steps = (bar[3] * PIXELS) as usize;
        let ramp = |i: usize| {
            let t = (i as f64 + 0.5) / steps as f64;
            color(low * t + high * (1.0 - t))
        };
        drawing.image(bar, (0..steps).flat_map(ramp).collect(), 1);
        let (unit, per_unit) = multiple(self.unit, low.abs().max(high.abs()));
        let style = TickStyle { beside: [9.0, 0.5 * TICK], ..TickStyle::OF_MAPS };
        let beside = Frame { fonts: &fonts, place: bar, style };
        beside.axis(&mut drawing, Side::Right, Axis::Linear(per_unit * low, per_unit * high), None);
        beside.outline(&mut drawing, 1.2);
        let words = LEFT + w + RIGHT - 0.6 * TICK;
        beside.name_beside(&mut drawing, &with(&self.quantity, &unit), NAME, words);
        drawing.heading(&fonts, &self.title, (&self.subtitle, 15.0), LEFT);
        files::write_whole(path, &drawing.png(&fonts, path)?)
    }

    /// A square of the colour of each class with its words, the last one on top.
    fn draw_classes(
        &self,
        drawing: &mut Drawing,
        fonts: &Fonts,
        (left, top): (f64, f64),
        color: impl Fn(f64) -> [u8; 3],
    ) {
        for (line, (value, words)) in self.classes.iter().enumerate().rev().enumerate() {
            let y = top + line as f64 * 1.6 * BAR;
            drawing.image([left, y, BAR, BAR], color(value as f64).to_vec(), 1);
            let corners = [(left, y), (left + BAR, y), (left + BAR, y + BAR), (left, y + BAR)];
            drawing.path(polygon(&corners), Paint::stroked(INK, 1.2), None);
            let at = (left + BAR + 9.0, y + 0.5 * BAR + 0.35 * TICK);
            drawing.label(fonts.typeset(words, TICK), at, Anchor::Start, false, INK);
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
    fn image(&self, columns: usize, rows: usize, color: impl Fn(f64) -> [u8; 3]) -> Vec<[u8; 3]> {
        // From the lower left corner.
        let at = |i: usize| (i % columns, i / columns);
        let around = |i: usize| {
            let (x, y) = at(i);
            let (across, down) =
                (x.saturating_sub(1)..=(x + 1).min(columns - 1), y.saturating_sub(1)..=(y + 1).min(rows - 1));
            down.flat_map(move |y| across.clone().map(move |x| y * columns + x))
        };
        let all = 0..columns * rows;
        let mut values: Vec<f64> = all.clone().map(|i| self.pixel(at(i).0, columns, at(i).1, rows)).collect();
        let loaded = values.iter().filter(|v| **v > 0.0).count() as f64;
        if self.shown == Shown::Largest && loaded < SPARSE * values.len() as f64 {
            values = all.clone().map(|i| around(i).map(|j| values[j]).fold(values[i], f64::max)).collect();
        }
        let touches = |i: usize| {
            let (across, down) = self.cells_of(at(i).0, columns, at(i).1, rows);
            down.into_iter()
                .any(|row| self.contact[row * self.cells.columns..][across.clone()].contains(&true))
        };
        // Pixels from the contact: 0 in it, then 1 and 2 of the outline.
        let mut distance: Vec<usize> =
            all.clone().map(|i| if !self.contact.is_empty() && touches(i) { 0 } else { FAR }).collect();
        for ring in 1..=OUTLINE_WIDTH {
            let reached = all.clone().filter(|i| distance[*i] == ring - 1).flat_map(around);
            for i in reached.collect::<Vec<_>>() {
                distance[i] = distance[i].min(ring);
            }
        }
        let pixel = |i: usize| match distance[i] {
            ring @ 1..=OUTLINE_WIDTH => OUTLINE[ring - 1],
            _ => color(values[i]),
        };
        (0..rows).rev().flat_map(|y| (0..columns).map(move |x| y * columns + x)).map(pixel).collect()
    }

    /// Columns and rows of the cells that fall on a pixel, counted from the lower left corner.
    fn cells_of(&self, x: usize, columns: usize, y: usize, rows: usize) -> (Range<usize>, Range<usize>) {
        let range = |i: usize, pixels: usize, cells: usize| {
            let first = i * cells / pixels;
            first..((i + 1) * cells).div_ceil(pixels).clamp(first + 1, cells)
        };
        (range(x, columns, self.cells.columns), range(y, rows, self.cells.rows))
    }

    /// The value of a pixel.
    fn pixel(&self, x: usize, columns: usize, y: usize, rows: usize) -> f64 {
        let row = |iy: usize| &self.values[iy * self.cells.columns..][..self.cells.columns];
        let (across, down) = self.cells_of(x, columns, y, rows);
        let middle =
            || row(usize::midpoint(down.start, down.end - 1))[usize::midpoint(across.start, across.end - 1)];
        let values = || down.clone().flat_map(|iy| row(iy)[across.clone()].iter().copied());
        // Of numbers and NaN the number.
        match self.shown {
            Shown::Largest => values().fold(f64::NAN, f64::max),
            Shown::Smallest => values().fold(f64::NAN, f64::min),
            Shown::Middle => middle(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::Field;

    fn picture(field: &Field, shown: Shown) -> FieldPicture<'_> {
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
            shown,
            signed: false,
            range: None,
            contact,
            arrows: None,
            classes: &[],
        }
    }

    /// Colours of a PNG at points of the map, counted from its lower left corner in shares of its sides.
    fn colors(field: &Field, shown: Shown, at: &[(f64, f64)]) -> Vec<[u8; 3]> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("f.png");
        picture(field, shown).save(&path).unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let longer = field.size().x.max(field.size().y);
        let (w, h) = (SIDE * field.size().x / longer, SIDE * field.size().y / longer);
        let pixel = |&(x, y): &(f64, f64)| {
            let (x, y) = (((LEFT + x * w) * PIXELS) as usize, ((TOP + (1.0 - y) * h) * PIXELS) as usize);
            let at = 3 * (y * info.width as usize + x);
            [bytes[at], bytes[at + 1], bytes[at + 2]]
        };
        at.iter().map(pixel).collect()
    }

    #[test]
    fn y_points_upwards_and_single_cells_are_seen() {
        // A row of 2 x 1 at the bottom carries pressure at the right, the row above at the left; one point is
        // undefined.
        let field = Field::new([3, 2], [3.0, 2.0], vec![0.0, f64::NAN, 1.0, 2.0, 0.0, 0.0]).unwrap();
        let found = colors(
            &field,
            Shown::Largest,
            &[(0.15, 0.25), (0.5, 0.25), (0.85, 0.25), (0.15, 0.75), (0.5, 0.75)],
        );
        let viridis = |t| colorous::VIRIDIS.eval_continuous(t).into_array();
        assert_eq!(found, [[255; 3], crate::colours::UNDEFINED, viridis(0.5), viridis(1.0), [255; 3]]);
        // One of a million cells.
        let mut values = vec![0.0; 2000 * 2000];
        values[1000 * 2000 + 500] = 1.0;
        let large = Field::new(2000, 1.0, values).unwrap();
        let (x, y) = ((500.0 + 0.5) / 2000.0, (1000.0 + 0.5) / 2000.0);
        assert_eq!(colors(&large, Shown::Largest, &[(x, y), (0.3, 0.3)]), [viridis(1.0), [255; 3]]);
    }

    #[test]
    fn contacts_are_outlined_and_a_scale_may_be_shared() {
        // Cells of 52 x 52 pixels; the one in the middle of 5 x 5 touches.
        let values: Vec<f64> = (0..25).map(|i| if i == 12 { 0.0 } else { 1.0 }).collect();
        let field = Field::new([5, 5], [5.0, 5.0], values.clone()).unwrap();
        let touching: Vec<bool> = values.iter().map(|v| *v == 0.0).collect();
        let picture =
            FieldPicture { contact: &touching, range: Some((0.0, 2.0)), ..picture(&field, Shown::Smallest) };
        let viridis = |t| colorous::VIRIDIS.eval_continuous(t / 2.0).into_array();
        let image = picture.image(50, 50, viridis);
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
        let picture = FieldPicture { contact: &touching, ..self::picture(&field, Shown::Smallest) };
        let image = picture.image(10, 10, viridis);
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
            let picture = FieldPicture { arrows: Some([&x, &y]), ..picture(&field, Shown::Largest) };
            let mut drawing = Drawing::new(LEFT + SIDE + RIGHT, TOP + SIDE + BELOW);
            picture.draw_arrows(&mut drawing, [LEFT, TOP, SIDE, SIDE]);
            drawing.svg(&Fonts::load().unwrap(), Path::new("a picture")).unwrap()
        };
        let middle = (LEFT + 0.5 * SIDE, TOP + 0.5 * SIDE);
        let half = 0.5 * ARROW * SIDE;
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
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("c.png");
        let picture = FieldPicture { classes, ..picture(&field, Shown::Largest) };
        picture.save(&path).unwrap();
        let short = FieldPicture { arrows: Some([&[0.0; 3], &[0.0; 2]]), ..picture };
        assert!(short.save(&path).is_err());
    }

    #[test]
    fn constant_and_oblong_fields_are_drawn() {
        let flat = Field::new([2, 2], [1.0, 1.0], vec![3.0; 4]).unwrap();
        assert_ne!(colors(&flat, Shown::Middle, &[(0.5, 0.5)])[0], [255; 3]);
        let zero = Field::new([2, 2], [1.0, 1.0], vec![0.0; 4]).unwrap();
        assert_eq!(colors(&zero, Shown::Largest, &[(0.5, 0.5)])[0], [255; 3]);
        let dir = tempfile::tempdir().unwrap();
        let long = Field::new([100, 1], [100.0, 1.0], (0..100).map(f64::from).collect()).unwrap();
        picture(&long, Shown::Smallest).save(&dir.path().join("g.png")).unwrap();
    }
}
