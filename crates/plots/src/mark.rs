//! Marks as paths.

use crate::drawing::{Drawing, Paint, polygon, polyline};
use crate::style::{Mark, MarkShape};
use crate::text::Piece;

/// How a point looks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MarkLook<'a> {
    pub mark: Mark,
    pub color: &'a str,
    pub radius: f64,
}

/// Draws a mark around a point.
pub(crate) fn draw(drawing: &mut Drawing, at: (f64, f64), look: MarkLook<'_>) {
    let MarkLook { mark, color, radius } = look;
    let outline = outline(mark.shape(), at, radius);
    let paint = match mark {
        _ if mark.shape() == MarkShape::Cross => Paint::stroked(color, 1.8),
        // A thin white edge keeps neighbours apart.
        Mark::Solid(_) => Paint { stroke: Some(("#ffffff".to_owned(), 0.7)), ..Paint::filled(color, 1.0) },
        Mark::Ring(_) => Paint::stroked(color, 1.4),
        Mark::Hollow(_) => Paint { stroke: Some((color.to_owned(), 1.4)), ..Paint::filled("#ffffff", 1.0) },
    };
    drawing.path(outline, paint, None);
}

/// Shapes of the same radius look equally large.
fn outline(shape: MarkShape, (x, y): (f64, f64), r: f64) -> Vec<Piece> {
    let corners = |n: u32, turn: f64, r: f64| {
        let corner = |i: u32| {
            let angle = turn + std::f64::consts::TAU * f64::from(i) / f64::from(n);
            (x + r * angle.sin(), y - r * angle.cos())
        };
        polygon(&(0..n).map(corner).collect::<Vec<_>>())
    };
    match shape {
        MarkShape::Circle => circle(x, y, r),
        MarkShape::Square => corners(4, std::f64::consts::FRAC_PI_4, 1.25 * r),
        MarkShape::Diamond => corners(4, 0.0, 1.3 * r),
        MarkShape::Triangle => corners(3, 0.0, 1.35 * r),
        MarkShape::Down => corners(3, std::f64::consts::PI, 1.35 * r),
        MarkShape::Pentagon => corners(5, 0.0, 1.15 * r),
        MarkShape::Cross => {
            let mut both = polyline(&[(x - r, y - r), (x + r, y + r)]);
            both.extend(polyline(&[(x - r, y + r), (x + r, y - r)]));
            both
        }
    }
}

/// A circle as four cubic pieces.
pub(crate) fn circle(x: f64, y: f64, r: f64) -> Vec<Piece> {
    // The usual handle: the radius is met to 3e-4.
    let h = 0.552_284_75 * r;
    vec![
        Piece::Move([x + r, y]),
        Piece::Cubic([x + r, y + h, x + h, y + r, x, y + r]),
        Piece::Cubic([x - h, y + r, x - r, y + h, x - r, y]),
        Piece::Cubic([x - r, y - h, x - h, y - r, x, y - r]),
        Piece::Cubic([x + h, y - r, x + r, y - h, x + r, y]),
        Piece::Close,
    ]
}
