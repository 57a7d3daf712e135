//! Colours, marks and lines: one style for every picture.

/// Ink of frames, ticks and labels.
pub(crate) const INK: &str = "#1a1a1a";
/// Formulas and lines of the paper.
pub const REFERENCE: &str = "#333333";
/// Colour in a legend of an entry that concerns every curve of the picture.
pub const NEUTRAL: &str = "#6b6b6b";
/// Colours of curves without a fractal dimension: from Okabe and Ito, distinct for colour-blind readers and
/// in grey.
pub const COLORS: [&str; 6] = ["#0b559f", "#d55e00", "#009e73", "#8c2d7a", "#a6761d", "#3b3b3b"];
/// Shapes in the same order.
pub const SHAPES: [MarkShape; 6] = [
    MarkShape::Circle,
    MarkShape::Square,
    MarkShape::Triangle,
    MarkShape::Diamond,
    MarkShape::Down,
    MarkShape::Cross,
];

/// Dark blue to yellow over D_f = 2 .. 3: order is visible, also in grey.
pub fn color(fractal_dimension: f64) -> String {
    const STOPS: [[f64; 3]; 5] = [
        [48.0, 18.0, 110.0],
        [52.0, 94.0, 168.0],
        [29.0, 145.0, 140.0],
        [84.0, 172.0, 62.0],
        [214.0, 150.0, 10.0],
    ];
    let t = (fractal_dimension - 2.0).clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let i = (t as usize).min(STOPS.len() - 2);
    let f = t - i as f64;
    let mix = |c: usize| (STOPS[i][c] * (1.0 - f) + STOPS[i + 1][c] * f).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// The mark of a fractal dimension, so that curves can be distinguished without colour.
pub fn shape(fractal_dimension: f64) -> MarkShape {
    let i = ((fractal_dimension - 2.0) * 5.0).round().clamp(0.0, 5.0) as usize;
    [
        MarkShape::Circle,
        MarkShape::Square,
        MarkShape::Triangle,
        MarkShape::Diamond,
        MarkShape::Down,
        MarkShape::Pentagon,
    ][i]
}

/// The outline of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkShape {
    /// A circle.
    Circle,
    /// A square on its side.
    Square,
    /// A triangle on its side.
    Triangle,
    /// A triangle on its corner.
    Down,
    /// A square on its corner.
    Diamond,
    /// A pentagon.
    Pentagon,
    /// An oblique cross.
    Cross,
}

/// Style of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Filled.
    Solid(MarkShape),
    /// An outline around white.
    Hollow(MarkShape),
    /// An outline around whatever lies below.
    Ring(MarkShape),
}

impl Mark {
    pub(crate) fn shape(self) -> MarkShape {
        match self {
            Self::Solid(shape) | Self::Hollow(shape) | Self::Ring(shape) => shape,
        }
    }
}

/// Style of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LineStyle {
    /// Unbroken.
    #[default]
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// Dashes and dots in turn.
    DashDotted,
}

impl LineStyle {
    pub(crate) fn dashes(self) -> Vec<f64> {
        match self {
            Self::Solid => Vec::new(),
            Self::Dashed => vec![7.0, 4.0],
            Self::Dotted => vec![1.6, 3.2],
            Self::DashDotted => vec![8.0, 3.0, 1.6, 3.0],
        }
    }
}

/// Style of an entry of a legend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LegendKey {
    /// A line.
    Line(LineStyle),
    /// A mark.
    Mark(Mark),
    /// A mark of this size.
    Sized(Mark, f64),
    /// A mark on a solid line.
    Curve(Mark),
    /// A shaded band.
    Band,
    /// A vertical bar through a mark.
    Bar(Mark),
    /// Words alone.
    Words,
}
