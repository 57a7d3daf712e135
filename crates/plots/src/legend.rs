//! Legends: their lines, and the place where they cover no data.

use crate::drawing::{Anchor, Drawing, LabelPlace, Paint, Rectangle, polygon, polyline};
use crate::mark::{self, MarkLook};
use crate::style::{INK, LegendKey, LineStyle, Mark};
use crate::text::{Fonts, Typeset};

/// One line of a legend.
#[derive(Debug, Clone, PartialEq)]
struct LegendEntry {
    label: String,
    color: String,
    key: LegendKey,
}

/// The lines of a legend.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Legend {
    entries: Vec<LegendEntry>,
}

/// Length of the key before the words, and the space after it, in sizes of the words.
const KEY: f64 = 1.7;
const GAP: f64 = 0.55;
/// From one line to the next and from one column to the next, in sizes of the words.
const LINE: f64 = 1.38;
const COLUMN: f64 = 1.6;

impl Legend {
    /// Adds a line; the label may hold symbols between dollar signs.
    pub fn push(&mut self, label: &str, color: &str, key: LegendKey) {
        self.entries.push(LegendEntry { label: label.to_owned(), color: color.to_owned(), key });
    }

    /// Whether there is nothing to say.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// With the sizes of its words, in as many columns as fit into the width.
    pub(crate) fn set(&self, fonts: &Fonts, size: f64, width: f64) -> SetLegend<'_> {
        let lines: Vec<(&LegendEntry, Typeset)> =
            self.entries.iter().map(|e| (e, fonts.typeset(&e.label, size))).collect();
        let widths: Vec<f64> = lines.iter().map(|(e, set)| indent(e, size) + set.width).collect();
        let in_rows = |rows: usize| {
            let column = |c: &[f64]| c.iter().copied().fold(0.0, f64::max);
            widths.chunks(rows).map(column).collect::<Vec<f64>>()
        };
        let fits = |rows: &usize| total(&in_rows(*rows), size) <= width;
        let rows = (1..=lines.len()).find(fits).unwrap_or(lines.len()).max(1);
        SetLegend { lines, size, columns: in_rows(rows), rows }
    }
}

/// Where the words of a line begin.
fn indent(entry: &LegendEntry, size: f64) -> f64 {
    if entry.key == LegendKey::Words { 0.0 } else { (KEY + GAP) * size }
}

/// The width of columns with their gaps.
fn total(columns: &[f64], size: f64) -> f64 {
    columns.iter().sum::<f64>() + columns.len().saturating_sub(1) as f64 * COLUMN * size
}

/// A legend with the sizes of its words.
pub(crate) struct SetLegend<'a> {
    lines: Vec<(&'a LegendEntry, Typeset)>,
    size: f64,
    /// Their widths.
    columns: Vec<f64>,
    rows: usize,
}

impl SetLegend<'_> {
    pub fn width(&self) -> f64 {
        total(&self.columns, self.size)
    }

    pub fn height(&self) -> f64 {
        self.rows as f64 * LINE * self.size
    }

    /// Draws it with its upper left corner at `at`.
    pub fn draw(self, drawing: &mut Drawing, at: (f64, f64)) {
        let (size, rows) = (self.size, self.rows);
        for (i, (entry, set)) in self.lines.into_iter().enumerate() {
            let before = &self.columns[..i / rows];
            let x = at.0 + before.iter().sum::<f64>() + before.len() as f64 * COLUMN * size;
            let baseline = at.1 + ((i % rows) as f64 + 0.95) * LINE * size;
            let middle = (x + 0.5 * KEY * size, baseline - 0.3 * size);
            let half = 0.5 * KEY * size;
            let line = |drawing: &mut Drawing, style: LineStyle| {
                let ends = [(middle.0 - half, middle.1), (middle.0 + half, middle.1)];
                let paint = Paint { dashes: style.dashes(), ..Paint::stroked(&entry.color, 1.8) };
                drawing.path(polyline(&ends), paint, None);
            };
            let point = |drawing: &mut Drawing, mark: Mark, radius: f64| {
                mark::draw(drawing, middle, MarkLook { mark, color: &entry.color, radius });
            };
            match entry.key {
                LegendKey::Line(style) => line(drawing, style),
                LegendKey::Curve(mark) => {
                    line(drawing, LineStyle::Solid);
                    point(drawing, mark, 4.6);
                }
                LegendKey::Mark(mark) => point(drawing, mark, 4.6),
                LegendKey::Sized(mark, radius) => point(drawing, mark, radius),
                LegendKey::Bar(mark) => {
                    let ends = [(middle.0, middle.1 - 0.5 * size), (middle.0, middle.1 + 0.5 * size)];
                    drawing.path(polyline(&ends), Paint::stroked(&entry.color, 1.5), None);
                    point(drawing, mark, 4.6);
                }
                LegendKey::Band => {
                    let (a, b) = (middle.0 - half, middle.0 + half);
                    let (c, d) = (middle.1 - 0.3 * size, middle.1 + 0.3 * size);
                    let corners = [(a, c), (b, c), (b, d), (a, d)];
                    drawing.path(polygon(&corners), Paint::filled(&entry.color, 0.3), None);
                }
                LegendKey::Words => {}
            }
            let words = LabelPlace::new((x + indent(entry, size), baseline), Anchor::Start);
            drawing.label(set, words, INK);
        }
    }
}

/// The upper left corner of a free place of this size in the frame; `None` where every place would cover
/// something.
pub(crate) fn free_place(
    frame: Rectangle,
    size: (f64, f64),
    taken: &[(f64, f64)],
    margin: f64,
) -> Option<(f64, f64)> {
    /// Places tried in each direction.
    const STEPS: usize = 12;
    let room = (frame[2] - size.0 - 2.0 * margin, frame[3] - size.1 - 2.0 * margin);
    if room.0 < 0.0 || room.1 < 0.0 {
        return None;
    }
    let place = |i: usize, j: usize| {
        (
            frame[0] + margin + room.0 * i as f64 / STEPS as f64,
            frame[1] + margin + room.1 * j as f64 / STEPS as f64,
        )
    };
    let free = |(x, y): (f64, f64)| {
        let within = |p: &&(f64, f64)| {
            (x - 9.0..=x + size.0 + 9.0).contains(&p.0) && (y - 9.0..=y + size.1 + 9.0).contains(&p.1)
        };
        taken.iter().find(within).is_none()
    };
    let corners = [(0, 0), (STEPS, STEPS), (STEPS, 0), (0, STEPS)];
    let edges = (1..STEPS).flat_map(|i| [(0, i), (STEPS, i), (i, 0), (i, STEPS)]);
    corners.into_iter().chain(edges).map(|(i, j)| place(i, j)).find(|p| free(*p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_goes_where_nothing_is() {
        let frame = [0.0, 0.0, 400.0, 300.0];
        let size = (100.0, 80.0);
        assert_eq!(free_place(frame, size, &[], 10.0), Some((10.0, 10.0)));
        assert_eq!(free_place(frame, size, &[(50.0, 50.0)], 10.0), Some((290.0, 210.0)));
        let everywhere: Vec<(f64, f64)> =
            (0..40).flat_map(|i| (0..30).map(move |j| (10.0 * f64::from(i), 10.0 * f64::from(j)))).collect();
        assert_eq!(free_place(frame, size, &everywhere, 10.0), None);
        assert_eq!(free_place(frame, (500.0, 10.0), &[], 10.0), None);
    }

    #[test]
    fn many_lines_make_columns_where_they_fit() {
        let fonts = Fonts::load().unwrap();
        let mut legend = Legend::default();
        (0..5).for_each(|_| legend.push("word", "#000000", LegendKey::Band));
        let narrow = legend.set(&fonts, 10.0, 50.0);
        assert_eq!((narrow.columns.len(), narrow.rows), (1, 5));
        let wide = legend.set(&fonts, 10.0, 200.0);
        assert!(wide.columns.len() > 1 && wide.columns.len() * wide.rows >= 5 && wide.width() <= 200.0);
    }
}
