//! Axes and the curves on them.

use crate::axis::Axis;
use crate::drawing::{Anchor, Drawing, LabelPlace, Paint, Rectangle, polygon, polyline};
use crate::frame::{AxisSide, Frame, TickStyle};
use crate::legend::{Legend, free_place};
use crate::mark::{self, MarkLook};
use crate::style::{INK, LegendKey, LineStyle, Mark, NEUTRAL};
use crate::text::Fonts;

/// Width and height of a picture: as wide as a README shows it.
pub(crate) const SIZE: (f64, f64) = (800.0, 600.0);
/// Sizes of words in a picture of that width; narrower panels have smaller ones.
const LABEL: f64 = 20.0;
const TICK: f64 = 17.0;
pub(crate) const WORDS: f64 = 16.0;
pub(crate) const TITLE: f64 = 19.0;
const TICKS: TickStyle = TickStyle {
    size: TICK,
    long: 8.0,
    short: Some(4.5),
    inwards: true,
    below: [1.3 * TICK, 2.6 * TICK],
    beside: [0.45 * TICK, 0.45 * TICK],
};
/// Farthest coordinate, in sides of the frame.
const FAR: f64 = 1e4;
/// From the frame to the legend in it.
const MARGIN: f64 = 14.0;

/// A pair of axes with curves, points and bands. Labels may contain symbols between dollar signs:
/// `$\bar{k}$`.
#[derive(Debug, Clone)]
pub struct Picture {
    axes: [Axis; 2],
    labels: [String; 2],
    ticks: [Option<Vec<f64>>; 2],
    title: String,
    subtitle: String,
    pub(crate) size: (f64, f64),
    drawn: Vec<PlotItem>,
    legend: Legend,
    pub(crate) legend_below: bool,
}

/// In coordinates of the axes.
#[derive(Debug, Clone)]
enum PlotItem {
    Line { points: Vec<(f64, f64)>, color: String, width: f64, style: LineStyle },
    Points { points: Vec<(f64, f64)>, color: String, radius: f64, mark: Mark },
    Band { points: Vec<(f64, f64, f64)>, color: String },
    Arrows { points: Vec<(f64, f64)>, color: String },
    Zeros,
    Bars { points: Vec<(f64, f64, f64)>, color: String },
}

impl Picture {
    /// Empty axes.
    pub fn new(x: Axis, y: Axis, x_label: &str, y_label: &str) -> Self {
        Self {
            axes: [x, y],
            labels: [x_label.to_owned(), y_label.to_owned()],
            ticks: [None, None],
            title: String::new(),
            subtitle: String::new(),
            size: SIZE,
            drawn: Vec::new(),
            legend: Legend::default(),
            legend_below: false,
        }
    }

    /// A title above the axes.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        title.clone_into(&mut self.title);
        self
    }

    /// A line below the title, such as the origin of the points.
    #[must_use]
    pub fn with_subtitle(mut self, subtitle: &str) -> Self {
        subtitle.clone_into(&mut self.subtitle);
        self
    }

    /// Puts the legend below the axes, for long lines; otherwise it stands in the axes where it covers
    /// nothing.
    #[must_use]
    pub fn with_legend_below(mut self) -> Self {
        self.legend_below = true;
        self
    }

    /// Sets width and height, without a legend below.
    #[must_use]
    pub fn with_size(mut self, width: f64, height: f64) -> Self {
        self.size = (width, height);
        self
    }

    /// Puts labels at these values of the horizontal axis and nowhere else.
    #[must_use]
    pub fn with_x_ticks(mut self, values: &[f64]) -> Self {
        self.ticks[0] = Some(values.to_vec());
        self
    }

    /// Draws a line through the points; it is interrupted where the axes cannot show a point.
    pub fn line(&mut self, points: &[(f64, f64)], color: &str, width: f64, style: LineStyle) {
        let (points, color) = (points.to_vec(), color.to_owned());
        self.drawn.push(PlotItem::Line { points, color, width, style });
    }

    /// Draws marks at the points within the axes.
    pub fn points(&mut self, points: &[(f64, f64)], color: &str, radius: f64, mark: Mark) {
        let [x, y] = self.axes;
        let points = points.iter().copied().filter(|p| x.holds(p.0) && y.holds(p.1)).collect();
        self.drawn.push(PlotItem::Points { points, color: color.to_owned(), radius, mark });
    }

    /// Draws a shaded band through (x, lower end, upper end).
    pub fn band(&mut self, points: &[(f64, f64, f64)], color: &str) {
        self.drawn.push(PlotItem::Band { points: points.to_vec(), color: color.to_owned() });
    }

    /// Draws heads of arrows along a line through the points, in their order.
    pub fn arrows(&mut self, points: &[(f64, f64)], color: &str) {
        self.drawn.push(PlotItem::Arrows { points: points.to_vec(), color: color.to_owned() });
    }

    /// Draws thin lines through the origin, where it lies within the axes.
    pub fn zeros(&mut self) {
        self.drawn.push(PlotItem::Zeros);
    }

    /// Draws vertical bars of (x, value, half width), with short ends.
    pub fn errors(&mut self, points: &[(f64, f64, Option<f64>)], color: &str) {
        let bar = |&(x, y, e): &(f64, f64, Option<f64>)| e.map(|e| (x, y - e, y + e));
        let points = points.iter().filter_map(bar).collect();
        self.drawn.push(PlotItem::Bars { points, color: color.to_owned() });
    }

    /// Adds a line to the legend; points and lines do not do so themselves.
    pub fn legend(&mut self, label: &str, color: &str, key: LegendKey) {
        self.legend.push(label, color, key);
    }

    /// Whether nothing is drawn between the axes.
    pub fn is_empty(&self) -> bool {
        self.drawn.iter().all(
            |d| matches!(d, PlotItem::Points { points, .. } | PlotItem::Line { points, .. } | PlotItem::Arrows { points, .. } if points.is_empty()),
        )
    }

    /// The horizontal and the vertical axis.
    pub fn axes(&self) -> (Axis, Axis) {
        (self.axes[0], self.axes[1])
    }

    fn text_scale(&self) -> f64 {
        if self.size.0 < 0.7 * SIZE.0 { 0.85 } else { 1.0 }
    }

    /// Draws everything but a legend below; gives that back.
    pub(crate) fn draw(self, fonts: &Fonts, drawing: &mut Drawing, corner: (f64, f64)) {
        let frame = self.frame(fonts, corner);
        let scale = self.text_scale();
        let taken = self.draw_items(drawing, frame);
        self.draw_axes(fonts, drawing, frame, corner);
        if !self.legend_below && !self.legend.is_empty() {
            let set = self.legend.set(fonts, WORDS * scale, 0.0);
            let size = (set.width(), set.height());
            if let Some(place) = free_place(frame, size, &taken, MARGIN) {
                set.draw(drawing, place);
            }
        }
    }

    /// The legend if it stands below the axes, on request or because no place in the axes is free.
    pub(crate) fn legend_below(&self, fonts: &Fonts) -> Option<&Legend> {
        if self.legend.is_empty() || self.legend_below {
            return (!self.legend.is_empty()).then_some(&self.legend);
        }
        let frame = self.frame(fonts, (0.0, 0.0));
        let taken = self.draw_items(&mut Drawing::new(1.0, 1.0), frame);
        let set = self.legend.set(fonts, WORDS * self.text_scale(), 0.0);
        free_place(frame, (set.width(), set.height()), &taken, MARGIN).is_none().then_some(&self.legend)
    }

    /// The frame that labels and title leave.
    pub(crate) fn frame(&self, fonts: &Fonts, corner: (f64, f64)) -> Rectangle {
        let scale = self.text_scale();
        let words = |i: usize| {
            let (ticks, power) = self.axes[i].ticks(self.ticks[i].as_deref());
            let widths = ticks.iter().filter_map(|t| t.label.as_deref());
            (widths.map(|l| fonts.typeset(l, TICK * scale).width).fold(0.0, f64::max), power.is_some())
        };
        let (y_width, y_power) = words(1);
        let left = y_width + if self.labels[1].is_empty() { 18.0 } else { 24.0 + 1.25 * LABEL * scale };
        let mut top = 16.0 * scale;
        if !self.title.is_empty() {
            top += 1.4 * TITLE * scale;
        }
        if !self.subtitle.is_empty() {
            top += 1.35 * WORDS * scale;
        }
        if y_power && self.title.is_empty() {
            top += 1.2 * TICK * scale;
        }
        let below = if self.labels[0].is_empty() { 0.0 } else { 1.6 * LABEL * scale };
        let bottom = 1.55 * TICK * scale + below + 6.0;
        let right = 18.0;
        [corner.0 + left, corner.1 + top, self.size.0 - left - right, self.size.1 - top - bottom]
    }

    /// Draws lines, points and bands into the frame; returns places that a legend must not cover.
    fn draw_items(&self, drawing: &mut Drawing, frame: Rectangle) -> Vec<(f64, f64)> {
        let mut area = PlotArea { axes: self.axes, frame, drawing, taken: Vec::new() };
        for item in &self.drawn {
            area.draw(item);
        }
        area.taken
    }

    fn draw_axes(&self, fonts: &Fonts, drawing: &mut Drawing, place: Rectangle, corner: (f64, f64)) {
        let scale = self.text_scale();
        let frame = Frame { fonts, place, style: TICKS.scaled(scale) };
        for (i, side) in [AxisSide::Below, AxisSide::Left].into_iter().enumerate() {
            frame.axis(drawing, side, self.axes[i], self.ticks[i].as_deref());
        }
        frame.outline(drawing, 1.3);
        let [x, y, _, h] = place;
        let below = y + h + 1.55 * TICK * scale + 1.2 * LABEL * scale;
        frame.name_below(drawing, &self.labels[0], LABEL * scale, below);
        frame.name_beside(drawing, &self.labels[1], LABEL * scale, corner.0 + 1.15 * LABEL * scale);
        let mut above = y - 0.6 * WORDS * scale;
        let room = corner.0 + self.size.0 - x;
        if !self.subtitle.is_empty() {
            let set = fonts.fitted(&self.subtitle, WORDS * scale, room);
            drawing.label(set, LabelPlace::new((x, above), Anchor::Start), NEUTRAL);
            above -= 1.4 * WORDS * scale;
        }
        let title = fonts.fitted(&self.title, TITLE * scale, room);
        drawing.label(title, LabelPlace::new((x, above), Anchor::Start), INK);
    }
}

/// The inside of the axes while it is drawn.
struct PlotArea<'a> {
    axes: [Axis; 2],
    frame: Rectangle,
    drawing: &'a mut Drawing,
    /// Places that a legend must not cover.
    taken: Vec<(f64, f64)>,
}

impl PlotArea<'_> {
    fn draw(&mut self, item: &PlotItem) {
        match item {
            PlotItem::Line { points, color, width, style } => {
                let paint = Paint { dashes: style.dashes(), ..Paint::stroked(color, *width) };
                self.line(points, &paint);
            }
            PlotItem::Points { points, color, radius, mark } => {
                self.points(points, MarkLook { mark: *mark, color, radius: *radius });
            }
            PlotItem::Band { points, color } => self.band(points, color),
            PlotItem::Arrows { points, color } => self.arrows(points, color),
            PlotItem::Zeros => self.zeros(),
            PlotItem::Bars { points, color } => self.bars(points, color),
        }
    }

    /// Where a point lies in the drawing; `None` where the axes cannot show it.
    fn place(&self, p: (f64, f64)) -> Option<(f64, f64)> {
        // What is drawn so far from the frame looks the same nearer to it; coordinates stay finite in single
        // precision.
        let (x, y) = (self.axes[0].place(p.0)?.clamp(-FAR, FAR), self.axes[1].place(p.1)?.clamp(-FAR, FAR));
        let [left, top, w, h] = self.frame;
        Some((left + x * w, top + (1.0 - y) * h))
    }

    /// Draws a line, in pieces where the axes cannot show all of its points.
    fn line(&mut self, points: &[(f64, f64)], paint: &Paint) {
        let places: Vec<Option<(f64, f64)>> = points.iter().map(|p| self.place(*p)).collect();
        for run in places.split(Option::is_none) {
            let run: Vec<(f64, f64)> = run.iter().copied().flatten().collect();
            if run.len() > 1 {
                self.taken.extend(run.windows(2).flat_map(|w| along(w[0], w[1])));
                self.drawing.path(polyline(&run), paint.clone(), Some(self.frame));
            }
        }
    }

    fn points(&mut self, points: &[(f64, f64)], look: MarkLook<'_>) {
        for &point in points {
            if let Some(at) = self.place(point) {
                self.taken.push(at);
                mark::draw(self.drawing, at, look);
            }
        }
    }

    /// Fills the band between lower and upper ends; what lies below a logarithmic axis ends on it.
    fn band(&mut self, points: &[(f64, f64, f64)], color: &str) {
        let floor = self.axes[1].ends().0;
        let lower = points.iter().filter_map(|p| self.place((p.0, p.1.max(floor))));
        let upper = points.iter().rev().filter_map(|p| self.place((p.0, p.2.max(floor))));
        let corners: Vec<(f64, f64)> = lower.chain(upper).collect();
        if points.len() > 1 {
            self.taken.extend(&corners);
            self.drawing.path(polygon(&corners), Paint::filled(color, 0.25), Some(self.frame));
        }
    }

    /// Draws the heads of arrows whose middles lie in the frame.
    fn arrows(&mut self, points: &[(f64, f64)], color: &str) {
        let places: Vec<(f64, f64)> = points.iter().filter_map(|p| self.place(*p)).collect();
        let [left, top, w, h] = self.frame;
        for (middle, direction) in arrow_heads(&places) {
            if (left..=left + w).contains(&middle.0) && (top..=top + h).contains(&middle.1) {
                let corners = arrow_corners(middle, direction);
                self.drawing.path(polygon(&corners), Paint::filled(color, 1.0), Some(self.frame));
            }
        }
    }

    /// Draws a line at zero of each linear axis that has both signs.
    fn zeros(&mut self) {
        let inside = |axis: Axis| matches!(axis, Axis::Linear(low, high) if low < 0.0 && high > 0.0);
        let [left, top, w, h] = self.frame;
        let mut line = |ends: [(f64, f64); 2]| {
            self.drawing.path(polyline(&ends), Paint::stroked("#b8bcc2", 1.0), Some(self.frame));
        };
        if let Some(x) = self.axes[0].place(0.0).filter(|_| inside(self.axes[0])) {
            line([(left + x * w, top), (left + x * w, top + h)]);
        }
        if let Some(y) = self.axes[1].place(0.0).filter(|_| inside(self.axes[1])) {
            line([(left, top + (1.0 - y) * h), (left + w, top + (1.0 - y) * h)]);
        }
    }

    /// Draws bars from lower to upper ends; what lies below a logarithmic axis ends on it.
    fn bars(&mut self, points: &[(f64, f64, f64)], color: &str) {
        /// Half the width of the ends.
        const END: f64 = 3.5;
        let floor = self.axes[1].ends().0;
        for &(x, low, high) in points {
            let (Some(a), Some(b)) = (self.place((x, low.max(floor))), self.place((x, high.min(f64::MAX))))
            else {
                continue;
            };
            self.taken.extend(along(a, b));
            for ends in [[a, b], [(a.0 - END, a.1), (a.0 + END, a.1)], [(b.0 - END, b.1), (b.0 + END, b.1)]] {
                self.drawing.path(polyline(&ends), Paint::stroked(color, 1.2), Some(self.frame));
            }
        }
    }
}

/// Length of the head of an arrow, and from one to the next along a line.
const HEAD: f64 = 13.0;
const BETWEEN: f64 = 130.0;

/// Middles and directions of arrow heads along a line: the first after half the distance between two, each in
/// the middle of its straight piece where that is shorter.
fn arrow_heads(places: &[(f64, f64)]) -> Vec<((f64, f64), (f64, f64))> {
    let mut heads = Vec::new();
    let mut rest = 0.5 * BETWEEN;
    for pair in places.windows(2) {
        let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        let length = dx.hypot(dy);
        let mut at = rest;
        while at < length {
            // Beside the marks at the ends of a piece.
            let along =
                at.clamp((1.2 * HEAD).min(0.5 * length), (length - 1.2 * HEAD).max(0.5 * length)) / length;
            heads.push(((pair[0].0 + along * dx, pair[0].1 + along * dy), (dx / length, dy / length)));
            at += BETWEEN;
        }
        rest = at - length;
    }
    heads
}

/// The triangle of the head of an arrow with this middle and direction.
fn arrow_corners(middle: (f64, f64), (dx, dy): (f64, f64)) -> [(f64, f64); 3] {
    let corner =
        |along: f64, aside: f64| (middle.0 + along * dx - aside * dy, middle.1 + along * dy + aside * dx);
    [corner(0.5 * HEAD, 0.0), corner(-0.5 * HEAD, 0.4 * HEAD), corner(-0.5 * HEAD, -0.4 * HEAD)]
}

/// Points every few units of a straight line, for what must not be covered.
fn along(a: (f64, f64), b: (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let length = (b.0 - a.0).hypot(b.1 - a.1);
    let steps = (length / 6.0).ceil().clamp(1.0, 1000.0) as usize;
    (0..=steps).map(move |i| {
        let t = i as f64 / steps as f64;
        (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::MarkShape;

    fn picture() -> Picture {
        let mut picture = Picture::new(
            Axis::Log(1e-3, 1e2),
            Axis::Log(1e-2, 1.0),
            "force $\\bar{F}$",
            "stiffness $\\bar{k}$",
        )
        .with_title("A law")
        .with_subtitle("2049 × 2049 cells");
        picture.line(&[(1e-3, 1e-2), (1e2, 1.0)], "#000000", 1.0, LineStyle::Dashed);
        picture.points(&[(1.0, 0.1), (1e5, 0.1)], "#aa0000", 4.0, Mark::Solid(MarkShape::Circle));
        picture.band(&[(0.1, 0.0, 0.1), (1.0, 0.1, 0.2)], "#aa0000");
        picture.legend("$D_f$ = 2", "#aa0000", LegendKey::Curve(Mark::Solid(MarkShape::Circle)));
        picture
    }

    #[test]
    fn arrows_are_spread_along_a_line() {
        // Two sides of a square to the right and down.
        let heads = arrow_heads(&[(0.0, 0.0), (400.0, 0.0), (400.0, 400.0)]);
        assert_eq!(heads.len(), 6);
        assert!(heads[..3].iter().all(|head| head.1 == (1.0, 0.0) && head.0.1 == 0.0));
        assert!(heads[3..].iter().all(|head| head.1 == (0.0, 1.0) && (head.0.0 - 400.0).abs() < 1e-9));
        assert_eq!(heads[0].0, (0.5 * BETWEEN, 0.0));
        // Short pieces have one in their middle, now and then; points upon each other none.
        let short: Vec<(f64, f64)> = (0..50).map(|i| (10.0 * f64::from(i), 0.0)).collect();
        let heads = arrow_heads(&short);
        assert_eq!(heads.len(), 4);
        assert!(heads.iter().all(|head| (head.0.0 % 10.0 - 5.0).abs() < 1e-9), "{heads:?}");
        assert!(arrow_heads(&[(1.0, 1.0); 3]).is_empty() && arrow_heads(&[]).is_empty());
    }

    #[test]
    fn both_files_are_whole_and_hold_the_labels() {
        let [(drawn, svg), (pixels, png)] = picture().files("p").unwrap();
        assert_eq!([drawn, pixels], ["p.svg", "p.png"]);
        let svg = String::from_utf8(svg).unwrap();
        for label in ["force F\u{304}", "stiffness k\u{304}", "A law", "2049 × 2049 cells", "D_f = 2", "0.01"]
        {
            assert!(svg.contains(&format!("aria-label=\"{label}\"")), "{label}");
        }
        assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("<text") && !svg.contains("NaN"));
        // The point beyond the axes is not drawn: one in the picture, one in the legend.
        assert_eq!(svg.matches("fill=\"#aa0000\" stroke").count(), 2);
        assert!(
            png.starts_with(b"\x89PNG") && png.ends_with(&[0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82])
        );
        // The same picture has the same bytes.
        assert_eq!(picture().files("q").unwrap()[1], ("q.png".to_owned(), png));
    }
}
