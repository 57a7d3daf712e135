//! A picture as paths and labels, which both files are written from.

use crate::error::{Error, Result};
use crate::map::encode_rgb;
use crate::style::{INK, NEUTRAL};
use crate::text::{Fonts, Piece, Typeset};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::collections::BTreeSet;
use tiny_skia as skia;

/// Pixels of a PNG per unit of the drawing.
const SCALE: f64 = 2.0;

/// A rectangle: left, top, width, height.
pub(crate) type Rectangle = [f64; 4];

/// A picture: paths, labels and images in their order, on white.
pub(crate) struct Drawing {
    width: f64,
    height: f64,
    items: Vec<Item>,
}

enum Item {
    Path(DrawnPath),
    Label(DrawnLabel),
    Image(DrawnImage),
}

struct DrawnPath {
    pieces: Vec<Piece>,
    paint: Paint,
    clip: Option<Rectangle>,
}

struct DrawnLabel {
    set: Typeset,
    /// Start of the baseline.
    at: (f64, f64),
    upwards: bool,
    color: String,
}

struct DrawnImage {
    place: Rectangle,
    rgb: Vec<u8>,
    columns: usize,
}

/// Style of a path.
#[derive(Debug, Clone, Default)]
pub(crate) struct Paint {
    /// Colour of the inside and its opacity.
    pub fill: Option<(String, f64)>,
    /// Colour and width of the outline.
    pub stroke: Option<(String, f64)>,
    /// Lengths drawn and left out in turn; none is a solid line.
    pub dashes: Vec<f64>,
}

impl Paint {
    pub fn filled(color: &str, opacity: f64) -> Self {
        Self { fill: Some((color.to_owned(), opacity)), ..Self::default() }
    }

    pub fn stroked(color: &str, width: f64) -> Self {
        Self { stroke: Some((color.to_owned(), width)), ..Self::default() }
    }
}

/// Which point of a label its place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Where a label stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LabelPlace {
    /// A point of its baseline.
    pub at: (f64, f64),
    /// Which point of the label that is.
    pub anchor: Anchor,
    /// Whether it is written upwards, as at a vertical axis.
    pub upwards: bool,
}

impl LabelPlace {
    /// The place of a level label.
    pub fn new(at: (f64, f64), anchor: Anchor) -> Self {
        Self { at, anchor, upwards: false }
    }
}

impl Drawing {
    /// In units of the drawing.
    pub fn width(&self) -> f64 {
        self.width
    }

    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, items: Vec::new() }
    }

    pub fn path(&mut self, pieces: Vec<Piece>, paint: Paint, clip: Option<Rectangle>) {
        self.items.push(Item::Path(DrawnPath { pieces, paint, clip }));
    }

    pub fn label(&mut self, set: Typeset, place: LabelPlace, color: &str) {
        let LabelPlace { at, anchor, upwards } = place;
        let back = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * set.width,
            Anchor::End => set.width,
        };
        let at = if upwards { (at.0, at.1 + back) } else { (at.0 - back, at.1) };
        self.items.push(Item::Label(DrawnLabel { set, at, upwards, color: color.to_owned() }));
    }

    /// A title and a line below it, of its own size, at the top from so far across.
    pub fn heading(&mut self, fonts: &Fonts, title: &str, (subtitle, size): (&str, f64), across: f64) {
        let room = self.width - across;
        let at_height = |down: f64| LabelPlace::new((across, down), Anchor::Start);
        self.label(fonts.fitted(title, 19.0, room), at_height(27.0), INK);
        self.label(fonts.fitted(subtitle, size, room), at_height(49.0), NEUTRAL);
    }

    /// An image of three bytes per colour in rows of `columns` colours, first row on top, stretched over a
    /// rectangle.
    pub fn image(&mut self, place: Rectangle, rgb: Vec<u8>, columns: usize) {
        self.items.push(Item::Image(DrawnImage { place, rgb, columns }));
    }

    /// The bytes of `NAME.svg` and `NAME.png`.
    pub fn files(&self, fonts: &Fonts, name: &str) -> Result<[(String, Vec<u8>); 2]> {
        let [svg, png] = ["svg", "png"].map(|ending| format!("{name}.{ending}"));
        let [drawn, pixels] = [self.svg(fonts, &svg)?.into_bytes(), self.png(fonts, &png)?];
        Ok([(svg, drawn), (png, pixels)])
    }

    /// The picture as an SVG; `picture` is what messages call it.
    pub fn svg(&self, fonts: &Fonts, picture: &str) -> Result<String> {
        let mut svg = SvgText { fonts, clips: Vec::new(), glyphs: BTreeSet::new(), body: String::new() };
        for item in &self.items {
            match item {
                Item::Path(path) => svg.path(path),
                Item::Label(label) => svg.label(label),
                Item::Image(image) => svg.image(image, picture)?,
            }
        }
        Ok(svg.document(self.width, self.height))
    }

    /// The picture as a PNG; `picture` is what messages call it.
    pub fn png(&self, fonts: &Fonts, picture: &str) -> Result<Vec<u8>> {
        let [width, height] = [self.width, self.height].map(|v| (v * SCALE).round() as u32);
        let mut pixels = skia::Pixmap::new(width, height)
            .ok_or_else(|| Error::new(picture, format!("no picture of {width} x {height} pixels")))?;
        pixels.fill(skia::Color::WHITE);
        let scale = skia::Transform::from_scale(SCALE as f32, SCALE as f32);
        let mut png = PixelCanvas { fonts, pixels, scale, masked: None };
        for item in &self.items {
            match item {
                Item::Path(path) => png.path(path),
                Item::Label(label) => png.label(label),
                Item::Image(image) => png.image(image),
            }
        }
        let opaque: Vec<u8> = png.pixels.data().chunks(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        encode_rgb(picture, width as usize, &opaque)
    }
}

/// An SVG while it is written.
struct SvgText<'a> {
    fonts: &'a Fonts,
    /// Rectangles that paths are clipped to; a path names its rectangle by number.
    clips: Vec<Rectangle>,
    /// Glyphs that labels use, italic or not.
    glyphs: BTreeSet<(bool, u16)>,
    /// Everything drawn so far.
    body: String,
}

impl SvgText<'_> {
    fn path(&mut self, path: &DrawnPath) {
        let clipped = path.clip.map(|clip| self.number_of_clip(clip));
        let clip = clipped.map_or_else(String::new, |i| format!(" clip-path=\"url(#c{i})\""));
        let style = svg_paint(&path.paint);
        self.body += &format!("<path d=\"{}\"{style}{clip}/>\n", svg_path(&path.pieces, 1.0, 1.0));
    }

    fn number_of_clip(&mut self, clip: Rectangle) -> usize {
        let known = self.clips.iter().position(|k| same(k, &clip));
        known.unwrap_or_else(|| {
            self.clips.push(clip);
            self.clips.len() - 1
        })
    }

    /// Writes a label as uses of its glyphs; its words are for readers who cannot see them.
    fn label(&mut self, label: &DrawnLabel) {
        let DrawnLabel { set, at, upwards, color } = label;
        let turn = if *upwards { " rotate(-90)" } else { "" };
        self.body += &format!(
            "<g role=\"img\" aria-label=\"{}\" fill=\"{color}\" transform=\"translate({} {}){turn}\">",
            escaped(&set.plain),
            short(at.0),
            short(at.1)
        );
        for g in &set.glyphs {
            let outline = !self.fonts.outline(g.id, g.italic).is_empty();
            if outline {
                self.glyphs.insert((g.italic, g.id));
                self.body += &format!(
                    "<use href=\"#{}\" transform=\"translate({} {})scale({})\"/>",
                    glyph_name(g.italic, g.id),
                    short(g.x),
                    short(g.y),
                    format_args!("{:.4}", g.size / 100.0)
                );
            }
        }
        for [x, y, w, h] in &set.bars {
            let (x, y, w, h) = (short(*x), short(*y), short(*w), short(*h));
            self.body += &format!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>");
        }
        self.body += "</g>\n";
    }

    fn image(&mut self, image: &DrawnImage, picture: &str) -> Result<()> {
        let [x, y, w, h] = image.place;
        let data = STANDARD.encode(encode_rgb(picture, image.columns, &image.rgb)?);
        self.body += &format!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" style=\"image-rendering:pixelated\" \
             href=\"data:image/png;base64,{data}\"/>\n"
        );
        Ok(())
    }

    /// The whole file: clips and glyphs are defined before what uses them.
    fn document(self, width: f64, height: f64) -> String {
        let (w, h) = (short(width), short(height));
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\">\n<defs>\n"
        );
        for (i, [x, y, w, h]) in self.clips.iter().enumerate() {
            let (x, y, w, h) = (short(*x), short(*y), short(*w), short(*h));
            text += &format!(
                "<clipPath id=\"c{i}\"><rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/></clipPath>\n"
            );
        }
        // Each glyph once, 100 units to the em.
        for (italic, id) in self.glyphs {
            let outline = svg_path(&self.fonts.outline(id, italic), 100.0, -100.0);
            text += &format!("<path id=\"{}\" d=\"{outline}\"/>\n", glyph_name(italic, id));
        }
        let body = self.body;
        text += &format!("</defs>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{body}</svg>\n");
        text
    }
}

/// A PNG while it is drawn.
struct PixelCanvas<'a> {
    fonts: &'a Fonts,
    pixels: skia::Pixmap,
    /// From units of the drawing to pixels.
    scale: skia::Transform,
    /// The last clip: neighbours in the order of drawing share theirs.
    masked: Option<(Rectangle, skia::Mask)>,
}

impl PixelCanvas<'_> {
    fn path(&mut self, path: &DrawnPath) {
        let DrawnPath { pieces, paint, clip } = path;
        if let Some(clip) = clip {
            self.mask_to(*clip);
        }
        let mask = self.masked.as_ref().filter(|_| clip.is_some()).map(|(_, mask)| mask);
        let Some(shape) = skia_path(pieces, |p| p) else { return };
        if let Some((color, opacity)) = &paint.fill {
            let paint = skia_paint(color, *opacity);
            self.pixels.fill_path(&shape, &paint, skia::FillRule::Winding, self.scale, mask);
        }
        if let Some((color, width)) = &paint.stroke {
            let dash = paint.dashes.iter().map(|v| *v as f32).collect();
            let stroke = skia::Stroke {
                width: *width as f32,
                line_join: skia::LineJoin::Round,
                dash: skia::StrokeDash::new(dash, 0.0),
                ..skia::Stroke::default()
            };
            self.pixels.stroke_path(&shape, &skia_paint(color, 1.0), &stroke, self.scale, mask);
        }
    }

    /// Makes the mask of a clip, unless it is the last one.
    fn mask_to(&mut self, clip: Rectangle) {
        if self.masked.as_ref().is_none_or(|(known, _)| !same(known, &clip)) {
            let size = [self.pixels.width(), self.pixels.height()];
            self.masked = mask(clip, size, self.scale).map(|mask| (clip, mask));
        }
    }

    fn label(&mut self, label: &DrawnLabel) {
        let DrawnLabel { set, at, upwards, color } = label;
        let place = |x: f64, y: f64| if *upwards { [at.0 + y, at.1 - x] } else { [at.0 + x, at.1 + y] };
        let paint = skia_paint(color, 1.0);
        let mut fill = |shape: Option<skia::Path>| {
            if let Some(shape) = shape {
                self.pixels.fill_path(&shape, &paint, skia::FillRule::Winding, self.scale, None);
            }
        };
        for g in &set.glyphs {
            let outline = self.fonts.outline(g.id, g.italic);
            fill(skia_path(&outline, |[x, y]| place(g.x + x * g.size, g.y - y * g.size)));
        }
        for bar in &set.bars {
            fill(skia_path(&rectangle(*bar), |[x, y]| place(x, y)));
        }
    }

    /// Gives each pixel of the place the colour of the image there.
    fn image(&mut self, image: &DrawnImage) {
        let [left, top, w, h] = image.place.map(|v| (v * SCALE).round() as usize);
        let (columns, rows) = (image.columns, image.rgb.len() / 3 / image.columns);
        let width = self.pixels.width() as usize;
        let data = self.pixels.data_mut();
        for row in 0..h {
            for column in 0..w {
                let from = 3 * ((row * rows / h) * columns + column * columns / w);
                let at = ((top + row) * width + left + column) * 4;
                if let Some(pixel) = data.get_mut(at..at + 3) {
                    pixel.copy_from_slice(&image.rgb[from..from + 3]);
                }
            }
        }
    }
}

/// A closed path through the corners.
pub(crate) fn polygon(corners: &[(f64, f64)]) -> Vec<Piece> {
    let mut pieces = polyline(corners);
    pieces.push(Piece::Close);
    pieces
}

/// A closed rectangle.
pub(crate) fn rectangle([x, y, w, h]: Rectangle) -> Vec<Piece> {
    polygon(&[(x, y), (x + w, y), (x + w, y + h), (x, y + h)])
}

/// A path through the points.
pub(crate) fn polyline(points: &[(f64, f64)]) -> Vec<Piece> {
    let piece = |(i, p): (usize, &(f64, f64))| match i {
        0 => Piece::Move([p.0, p.1]),
        _ => Piece::Line([p.0, p.1]),
    };
    points.iter().enumerate().map(piece).collect()
}

fn same(a: &Rectangle, b: &Rectangle) -> bool {
    a.iter().zip(b).all(|(a, b)| a.total_cmp(b).is_eq())
}

/// Two decimals at most: a hundredth of a unit is less than anyone sees.
fn short(v: f64) -> String {
    let text = format!("{v:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn glyph_name(italic: bool, id: u16) -> String {
    format!("{}{id}", if italic { "i" } else { "r" })
}

fn escaped(text: &str) -> String {
    // XML has no place for control characters.
    text.replace(char::is_control, "\u{fffd}")
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

fn svg_path(pieces: &[Piece], sx: f64, sy: f64) -> String {
    let write = |letter: char, values: &[f64]| {
        let place = |(i, v): (usize, &f64)| short(v * if i % 2 == 0 { sx } else { sy });
        let numbers: Vec<String> = values.iter().enumerate().map(place).collect();
        format!("{letter}{}", numbers.join(" "))
    };
    let piece = |p: &Piece| match p {
        Piece::Move(v) => write('M', v),
        Piece::Line(v) => write('L', v),
        Piece::Quad(v) => write('Q', v),
        Piece::Cubic(v) => write('C', v),
        Piece::Close => "Z".to_owned(),
    };
    pieces.iter().map(piece).collect()
}

fn svg_paint(paint: &Paint) -> String {
    let mut text = match &paint.fill {
        Some((color, opacity)) if *opacity < 1.0 => {
            format!(" fill=\"{color}\" fill-opacity=\"{}\"", short(*opacity))
        }
        Some((color, _)) => format!(" fill=\"{color}\""),
        None => " fill=\"none\"".to_owned(),
    };
    if let Some((color, width)) = &paint.stroke {
        text += &format!(" stroke=\"{color}\" stroke-width=\"{}\" stroke-linejoin=\"round\"", short(*width));
    }
    if !paint.dashes.is_empty() {
        let lengths: Vec<String> = paint.dashes.iter().map(|v| short(*v)).collect();
        text += &format!(" stroke-dasharray=\"{}\"", lengths.join(" "));
    }
    text
}

fn skia_path(pieces: &[Piece], place: impl Fn([f64; 2]) -> [f64; 2]) -> Option<skia::Path> {
    let mut path = skia::PathBuilder::new();
    let at = |x: f64, y: f64| place([x, y]).map(|v| v as f32);
    for piece in pieces {
        match *piece {
            Piece::Move([x, y]) => {
                let [x, y] = at(x, y);
                path.move_to(x, y);
            }
            Piece::Line([x, y]) => {
                let [x, y] = at(x, y);
                path.line_to(x, y);
            }
            Piece::Quad([a, b, x, y]) => {
                let ([a, b], [x, y]) = (at(a, b), at(x, y));
                path.quad_to(a, b, x, y);
            }
            Piece::Cubic([a, b, c, d, x, y]) => {
                let ([a, b], [c, d], [x, y]) = (at(a, b), at(c, d), at(x, y));
                path.cubic_to(a, b, c, d, x, y);
            }
            Piece::Close => path.close(),
        }
    }
    path.finish()
}

fn mask([x, y, w, h]: Rectangle, pixels: [u32; 2], scale: skia::Transform) -> Option<skia::Mask> {
    let mut mask = skia::Mask::new(pixels[0], pixels[1])?;
    let inside = skia::Rect::from_xywh(x as f32, y as f32, w as f32, h as f32)?;
    mask.fill_path(&skia::PathBuilder::from_rect(inside), skia::FillRule::Winding, true, scale);
    Some(mask)
}

fn skia_paint(color: &str, opacity: f64) -> skia::Paint<'static> {
    let channel = |i: usize| {
        color.get(i..i + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok()).unwrap_or_default()
    };
    let mut paint = skia::Paint::default();
    paint.set_color_rgba8(channel(1), channel(3), channel(5), (255.0 * opacity).round() as u8);
    paint.anti_alias = true;
    paint
}
