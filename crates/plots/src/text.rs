//! Labels: words with symbols between dollar signs, set from glyph outlines as journals set them.
//!
//! Between dollar signs letters are italic, digits and signs upright, `_` and `^` lower and raise the next
//! character or `{group}`, `\bar{x}` and `\tilde{x}` put an accent on a symbol, `\rm{words}` is upright:
//! `$\bar{k} = k/(1.1419 E^* L)$`.

use crate::error::{Error, Result};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Size of a script beside that of its line, and how far it is raised or lowered, in sizes of the line.
const SCRIPT: f64 = 0.68;
const RAISED: f64 = 0.36;
const LOWERED: f64 = 0.17;
/// A space between symbols, in sizes of the line.
const THIN_SPACE: f64 = 0.22;
/// Thickness of a bar over a symbol and its distance, in sizes of the line.
const BAR: f64 = 0.05;
const BAR_GAP: f64 = 0.085;

/// The two faces of the one family.
pub(crate) struct Fonts {
    faces: [Face<'static>; 2],
}

/// One glyph at its place from the start of the baseline; y grows downwards.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Glyph {
    pub id: u16,
    pub italic: bool,
    pub x: f64,
    pub y: f64,
    pub size: f64,
}

/// A label as it is drawn.
#[derive(Debug, Clone, Default)]
pub(crate) struct Typeset {
    pub glyphs: Vec<Glyph>,
    /// Bars: left, top, width, height.
    pub bars: Vec<[f64; 4]>,
    pub width: f64,
    /// The label for readers without eyes for outlines: searching, screen readers, tests.
    pub plain: String,
}

/// Pieces of an outline in units of the font's em, y upwards.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Piece {
    Move([f64; 2]),
    Line([f64; 2]),
    Quad([f64; 4]),
    Cubic([f64; 6]),
    Close,
}

impl Fonts {
    pub fn load() -> Result<Self> {
        let parse = |name: &str, bytes: &'static [u8]| {
            Face::parse(bytes, 0).map_err(|e| Error::new(name, e.to_string()))
        };
        let regular = parse("STIXTwoText-Regular.ttf", include_bytes!("../fonts/STIXTwoText-Regular.ttf"))?;
        let italic = parse("STIXTwoText-Italic.ttf", include_bytes!("../fonts/STIXTwoText-Italic.ttf"))?;
        Ok(Self { faces: [regular, italic] })
    }

    fn face(&self, italic: bool) -> &Face<'static> {
        &self.faces[usize::from(italic)]
    }

    /// The outline of a glyph in ems.
    pub fn outline(&self, id: u16, italic: bool) -> Vec<Piece> {
        let face = self.face(italic);
        let mut outline = Outline { em: f64::from(face.units_per_em()), pieces: Vec::new() };
        // A space has no outline.
        let _ = face.outline_glyph(GlyphId(id), &mut outline);
        outline.pieces
    }

    /// Advance, left, right and upper end of a glyph in ems.
    fn measure(&self, id: u16, italic: bool) -> [f64; 4] {
        let face = self.face(italic);
        let em = f64::from(face.units_per_em());
        let advance = f64::from(face.glyph_hor_advance(GlyphId(id)).unwrap_or(0)) / em;
        let ends = face.glyph_bounding_box(GlyphId(id)).map_or([0.0, advance, 0.0], |b| {
            [f64::from(b.x_min) / em, f64::from(b.x_max) / em, f64::from(b.y_max) / em]
        });
        [advance, ends[0], ends[1], ends[2]]
    }

    /// The factor `×10^power` that the labels of an axis share.
    pub fn power_of_ten(&self, power: i32, size: f64) -> Typeset {
        self.typeset(&format!("$×10^{{{power}}}$"), size)
    }

    /// Sets a label in one line, smaller where it would be wider than this, down to six tenths of its size.
    pub fn fitted(&self, label: &str, size: f64, width: f64) -> Typeset {
        let set = self.typeset(label, size);
        if set.width <= width { set } else { self.typeset(label, size * (width / set.width).max(0.6)) }
    }

    /// Sets a label in one line.
    pub fn typeset(&self, label: &str, size: f64) -> Typeset {
        let mut line = LineOfText { fonts: self, set: Typeset::default(), lean: 0.0 };
        for (i, part) in label.split('$').enumerate() {
            if i % 2 == 0 {
                line.words(part, size);
            } else {
                line.symbols(&part.chars().collect::<Vec<_>>(), size, 0.0, false);
            }
        }
        line.set
    }
}

struct Outline {
    em: f64,
    pieces: Vec<Piece>,
}

impl Outline {
    fn ems<const N: usize>(&self, values: [f32; N]) -> [f64; N] {
        values.map(|v| f64::from(v) / self.em)
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.pieces.push(Piece::Move(self.ems([x, y])));
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.pieces.push(Piece::Line(self.ems([x, y])));
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.pieces.push(Piece::Quad(self.ems([x1, y1, x, y])));
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.pieces.push(Piece::Cubic(self.ems([x1, y1, x2, y2, x, y])));
    }
    fn close(&mut self) {
        self.pieces.push(Piece::Close);
    }
}

/// A line while it is set.
struct LineOfText<'a> {
    fonts: &'a Fonts,
    set: Typeset,
    /// How far the last glyph, if italic, leans over its advance.
    lean: f64,
}

impl LineOfText<'_> {
    /// Appends one character; returns its glyph's [left, right, top] in the picture's units.
    fn push(&mut self, c: char, italic: bool, size: f64, y: f64) {
        let id = self.fonts.face(italic).glyph_index(c).map_or(0, |g| g.0);
        let [advance, _, right, _] = self.fonts.measure(id, italic);
        if !italic {
            self.set.width += self.lean;
        }
        self.set.glyphs.push(Glyph { id, italic, x: self.set.width, y, size });
        self.set.width += advance * size;
        self.lean = if italic { ((right - advance).max(0.0) + 0.02) * size } else { 0.0 };
        self.set.plain.push(c);
    }

    /// Words with numbers: what stands before a digit and behind no letter or digit is a minus, not a hyphen.
    fn words(&mut self, words: &str, size: f64) {
        let mut before = ' ';
        let mut chars = words.chars().peekable();
        while let Some(c) = chars.next() {
            let sign =
                c == '-' && !before.is_alphanumeric() && chars.peek().is_some_and(char::is_ascii_digit);
            self.push(if sign { '\u{2212}' } else { c }, false, size, 0.0);
            before = c;
        }
    }

    fn symbols(&mut self, chars: &[char], size: f64, y: f64, upright: bool) {
        let mut i = 0;
        while i < chars.len() {
            let c = chars[i];
            i += 1;
            match c {
                '_' | '^' => {
                    let (group, end) = group(chars, i);
                    i = end;
                    // The asterisk of the font is raised by itself.
                    let raised = if group == ['*'] { 0.1 } else { RAISED };
                    let (shift, scale) = if c == '_' { (LOWERED, SCRIPT) } else { (-raised, SCRIPT) };
                    let scale = if group == ['*'] { 0.9 } else { scale };
                    if c == '^' {
                        self.set.width += self.lean;
                    }
                    self.lean = 0.0;
                    self.set.plain.push_str(if c == '^' && group != ['*'] { "^" } else { "" });
                    self.set.plain.push_str(if c == '_' { "_" } else { "" });
                    self.symbols(group, size * scale, y + shift * size, upright);
                }
                '\\' => {
                    let name: String = chars[i..].iter().take_while(|c| c.is_ascii_alphabetic()).collect();
                    if name == "delta" {
                        i += name.len();
                        self.symbols(&['δ'], size, y, upright);
                        continue;
                    }
                    let (inner, end) = group(chars, i + name.len());
                    i = end;
                    match name.as_str() {
                        "rm" => self.symbols(inner, size, y, true),
                        accent @ ("bar" | "tilde") => self.accent(accent, inner, size, y),
                        // Seen in the picture, not left out.
                        unknown => {
                            for c in "\\".chars().chain(unknown.chars()) {
                                self.push(c, false, size, y);
                            }
                            self.symbols(inner, size, y, upright);
                        }
                    }
                }
                ' ' if upright => self.push(' ', false, size, y),
                ' ' => {
                    self.set.width += THIN_SPACE * size + self.lean;
                    self.lean = 0.0;
                    self.set.plain.push(' ');
                }
                '-' => self.push('\u{2212}', false, size, y),
                _ => self.push(c, c.is_alphabetic() && !upright, size, y),
            }
        }
    }

    /// A symbol under a bar or a tilde.
    fn accent(&mut self, accent: &str, symbol: &[char], size: f64, y: f64) {
        let first = self.set.glyphs.len();
        self.symbols(symbol, size, y, false);
        let Some(glyph) = self.set.glyphs.get(first).copied() else { return };
        let [_, left, right, top] = self.fonts.measure(glyph.id, glyph.italic);
        let top = y - (top + BAR_GAP) * size;
        // Over the upper half of a slanted letter.
        let (from, to) = (glyph.x + (left + 0.09) * size, glyph.x + (right + 0.01) * size);
        if accent == "tilde" {
            let id = self.fonts.face(false).glyph_index('~').map_or(0, |g| g.0);
            let [_, left, right, height] = self.fonts.measure(id, false);
            let x = 0.5 * (from + to) - 0.5 * (left + right) * 0.8 * size;
            self.set.glyphs.push(Glyph {
                id,
                italic: false,
                x,
                y: top + (height - 0.12) * 0.8 * size,
                size: 0.8 * size,
            });
            self.set.plain.push('\u{303}');
        } else {
            self.set.bars.push([from, top - BAR * size, to - from, BAR * size]);
            self.set.plain.push('\u{304}');
        }
    }
}

/// The next character or `{group}` from `at`, and where it ends.
fn group(chars: &[char], at: usize) -> (&[char], usize) {
    if chars.get(at) != Some(&'{') {
        let end = (at + 1).min(chars.len());
        return (&chars[at.min(end)..end], end);
    }
    let mut depth = 0;
    for (i, c) in chars.iter().enumerate().skip(at) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return (&chars[at + 1..i], i + 1);
        }
    }
    (&chars[at + 1..], chars.len())
}

/// Digits of a number for a label: whole numbers without a point, very large and small ones as powers of ten.
///
/// ```
/// assert_eq!(plots::number(0.086), "0.086");
/// assert_eq!(plots::number(2.0e-5), "$2×10^{-5}$");
/// ```
pub fn number(value: f64) -> String {
    let exponent = if value.abs() > 0.0 { value.abs().log10().floor() } else { 0.0 };
    if (-3.0..5.0).contains(&exponent) {
        return format!("{value}").replace('-', "\u{2212}");
    }
    // In halves: the powers of ten of subnormal numbers have few digits or none.
    let half = 10_f64.powf(0.5 * exponent);
    let digits = if exponent.abs() < 300.0 { value / 10_f64.powf(exponent) } else { value / half / half };
    let digits = (digits * 100.0).round() / 100.0;
    let power = format!("10^{{{exponent:.0}}}");
    if (digits - 1.0).abs() < 1e-9 { format!("${power}$") } else { format!("${digits}×{power}$") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_italic_digits_are_not() {
        let fonts = Fonts::load().unwrap();
        let set = fonts.typeset("force $\\bar{F} = F/(E^* h L_{10})$", 20.0);
        assert_eq!(set.plain, "force F\u{304} = F/(E* h L_10)");
        assert_eq!(set.bars.len(), 1);
        let italic = set.glyphs.iter().filter(|g| g.italic).count();
        assert_eq!(italic, "FFEhL".len());
        // Everything has an outline but the space of the words.
        let empty = set.glyphs.iter().filter(|g| fonts.outline(g.id, g.italic).is_empty()).count();
        assert_eq!(empty, 1);
        assert!(set.glyphs.iter().all(|g| g.id != 0));
    }

    #[test]
    fn scripts_are_smaller_and_apart_from_the_line() {
        let fonts = Fonts::load().unwrap();
        let set = fonts.typeset("$10^{-3}D_f$", 20.0);
        assert!(set.glyphs[2].y < 0.0 && set.glyphs[2].size < 20.0);
        assert!(set.glyphs[5].y > 0.0 && set.glyphs[4].size >= 20.0);
        assert!(set.width > 20.0 && set.plain == "10^\u{2212}3D_f");
    }

    #[test]
    fn a_minus_is_not_a_hyphen() {
        let fonts = Fonts::load().unwrap();
        let plain = |label| fonts.typeset(label, 20.0).plain;
        assert_eq!(
            plain("half-space, force = -1.5 µN, 2-3 -x"),
            "half-space, force = \u{2212}1.5 µN, 2-3 -x"
        );
        assert_eq!(plain("$\\delta_x$"), "δ_x");
    }

    #[test]
    fn broken_groups_end_with_the_label() {
        let fonts = Fonts::load().unwrap();
        for label in ["$x^$", "$x_{1$", "$\\bar$", "$\\bar{", "$", ""] {
            assert!(fonts.typeset(label, 10.0).width >= 0.0, "{label}");
        }
    }

    #[test]
    fn unknown_names_are_seen() {
        let fonts = Fonts::load().unwrap();
        assert_eq!(fonts.typeset("$\\kappa x$", 20.0).plain, "\\kappa x");
    }

    #[test]
    fn numbers_of_labels() {
        assert_eq!([1.0, 0.01, 2049.0].map(number), ["1", "0.01", "2049"]);
        assert_eq!(number(1e-6), "$10^{-6}$");
        assert_eq!(number(2.148e-5), "$2.15×10^{-5}$");
        assert_eq!(number(1e308), "$10^{308}$");
        assert_eq!(number(-2e-310), "$-2×10^{-310}$");
        assert_eq!(number(5e-324), "$4.94×10^{-324}$");
    }
}
