//! Frames: the ticks and the labels around a rectangle of a picture.

use crate::axis::Axis;
use crate::drawing::{Anchor, Drawing, LabelPlace, Paint, Rectangle, polyline, rectangle};
use crate::style::INK;
use crate::text::Fonts;

/// Where an axis stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AxisSide {
    Below,
    Left,
    Right,
}

/// Style of ticks and their labels, in units of the drawing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TickStyle {
    /// Size of the labels.
    pub size: f64,
    /// Length of long ticks.
    pub long: f64,
    /// Length of short ticks; `None`: they are left out.
    pub short: Option<f64>,
    /// Whether ticks point inwards, at the opposite side too, or outwards at their side alone.
    pub inwards: bool,
    /// From the frame down to the baseline of labels, and to that of the power of ten that they share.
    pub below: [f64; 2],
    /// From the frame to labels beside it, and up to the baseline of their power of ten.
    pub beside: [f64; 2],
}

/// Size of the labels of [`TickStyle::OF_MAPS`].
pub(crate) const TICK: f64 = 14.0;

impl TickStyle {
    /// Around maps and bars of colours.
    pub const OF_MAPS: Self = Self {
        size: TICK,
        long: 5.0,
        short: None,
        inwards: false,
        below: [5.0 + 1.1 * TICK, 3.2 * TICK],
        beside: [8.0, 0.5 * TICK],
    };

    /// Larger or smaller.
    pub fn scaled(self, scale: f64) -> Self {
        Self {
            size: self.size * scale,
            long: self.long * scale,
            short: self.short.map(|length| length * scale),
            inwards: self.inwards,
            below: self.below.map(|distance| distance * scale),
            beside: self.beside.map(|distance| distance * scale),
        }
    }
}

/// A rectangle with its axes.
pub(crate) struct Frame<'a> {
    pub fonts: &'a Fonts,
    pub place: Rectangle,
    pub style: TickStyle,
}

impl Frame<'_> {
    /// Ticks and labels of an axis, labels at these values where they are given; the power of ten that labels
    /// share stands at the end.
    pub fn axis(&self, drawing: &mut Drawing, side: AxisSide, axis: Axis, given: Option<&[f64]>) {
        let style = self.style;
        let [x, y, w, h] = self.place;
        let (right, bottom) = (x + w, y + h);
        let (ticks, power) = axis.ticks(given);
        for tick in ticks {
            let Some(length) = (if tick.major { Some(style.long) } else { style.short }) else { continue };
            let inward = if style.inwards { length } else { -length };
            let (along, up) = (x + tick.at * w, y + (1.0 - tick.at) * h);
            let at_left = [(x, up), (x + inward, up)];
            let at_right = [(right, up), (right - inward, up)];
            let [own, opposite] = match side {
                AxisSide::Below => {
                    [[(along, bottom), (along, bottom - inward)], [(along, y), (along, y + inward)]]
                }
                AxisSide::Left => [at_left, at_right],
                AxisSide::Right => [at_right, at_left],
            };
            for line in [Some(own), style.inwards.then_some(opposite)].into_iter().flatten() {
                drawing.path(polyline(&line), Paint::stroked(INK, 1.1), None);
            }
            let Some(label) = tick.label else { continue };
            let set = self.fonts.typeset(&label, style.size);
            let middle = up + 0.33 * style.size;
            let (at, anchor) = match side {
                // A label that would leave the picture is left out.
                AxisSide::Below if along + 0.5 * set.width >= drawing.width() => continue,
                AxisSide::Below => ((along, bottom + style.below[0]), Anchor::Middle),
                AxisSide::Left => ((x - style.beside[0], middle), Anchor::End),
                AxisSide::Right => ((right + style.beside[0], middle), Anchor::Start),
            };
            drawing.label(set, LabelPlace::new(at, anchor), INK);
        }
        if let Some(power) = power {
            let (at, anchor) = match side {
                AxisSide::Below => ((right, bottom + style.below[1]), Anchor::End),
                AxisSide::Left => ((x - style.beside[0], y - style.beside[1]), Anchor::End),
                AxisSide::Right => ((x, y - style.beside[1]), Anchor::Start),
            };
            drawing.label(self.fonts.power_of_ten(power, style.size), LabelPlace::new(at, anchor), INK);
        }
    }

    /// The line around it.
    pub fn outline(&self, drawing: &mut Drawing, width: f64) {
        drawing.path(rectangle(self.place), Paint::stroked(INK, width), None);
    }

    /// What the horizontal axis shows, with its baseline so far down the picture.
    pub fn name_below(&self, drawing: &mut Drawing, words: &str, size: f64, down: f64) {
        let at = (self.place[0] + 0.5 * self.place[2], down);
        drawing.label(self.fonts.typeset(words, size), LabelPlace::new(at, Anchor::Middle), INK);
    }

    /// What a vertical axis shows, written upwards, with its baseline so far across the picture.
    pub fn name_beside(&self, drawing: &mut Drawing, words: &str, size: f64, across: f64) {
        let at = (across, self.place[1] + 0.5 * self.place[3]);
        let place = LabelPlace { upwards: true, ..LabelPlace::new(at, Anchor::Middle) };
        drawing.label(self.fonts.typeset(words, size), place, INK);
    }
}
