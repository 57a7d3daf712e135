//! One picture of a few curves, for whoever has them.

use crate::plot::{Axis, Key, Mark, Picture, extent, logarithmic};
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use runs::Result;
use std::path::{Path, PathBuf};

/// Colours of curves, dark to light, told apart in grey as well.
const COLORS: [&str; 6] = ["#30126e", "#d6731a", "#1d918c", "#54ac3e", "#8c2d5a", "#777711"];

/// A named curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Its name in the legend.
    pub label: String,
    /// Its points in their order; those that the axes cannot show are left out.
    pub points: Vec<(f64, f64)>,
    /// Points without a line, of something drawn from chance.
    pub scattered: bool,
}

/// Curves on one pair of axes. An axis is logarithmic where asked for and every value is positive.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Above the axes.
    pub title: String,
    /// Below, with its unit.
    pub x_label: String,
    /// At the left, with its unit.
    pub y_label: String,
    /// What is drawn.
    pub curves: Vec<Curve>,
    /// Whether logarithmic axes serve.
    pub logarithmic: bool,
}

impl Chart {
    /// Writes `NAME.svg` and `NAME.png`.
    ///
    /// # Errors
    /// [`crate::Error::File`] when they cannot be written.
    pub fn save(&self, directory: &Path, name: &str) -> Result<Vec<PathBuf>> {
        let points = || self.curves.iter().flat_map(|c| c.points.iter());
        let axis = |values: &dyn Fn() -> Vec<f64>| {
            let values: Vec<f64> = values().into_iter().filter(|v| v.is_finite()).collect();
            if self.logarithmic && values.iter().all(|v| *v > 0.0) {
                return logarithmic(values);
            }
            let (low, high) = extent(values).unwrap_or((0.0, 1.0));
            let room = if high > low { 0.06 * (high - low) } else { 1.0_f64.max(high.abs()) };
            Axis::Linear(low - room, high + room)
        };
        let x = axis(&|| points().map(|p| p.0).collect());
        let y = axis(&|| points().map(|p| p.1).collect());
        let mut picture = Picture::new(x, y, &self.x_label, &self.y_label).with_title(&self.title);
        for (i, (curve, color)) in self.curves.iter().zip(COLORS.iter().cycle()).enumerate() {
            // Earlier curves are wider, so that they show where later ones lie on them.
            let above = (self.curves.len() - 1 - i).min(4) as f64;
            if !curve.scattered {
                picture.line(&curve.points, color, 1.4 + 1.1 * above, &LineStyle::Solid);
            }
            picture.points(&curve.points, color, 2.6 + 1.1 * above, Mark::Solid(MarkerShape::Circle));
            picture.legend(
                &curve.label,
                color,
                if curve.scattered { Key::Mark(MarkerShape::Circle) } else { Key::Line },
            );
        }
        picture.save(directory, name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_become_a_picture_whatever_they_hold() {
        let dir = tempfile::tempdir().unwrap();
        let curve =
            |points: &[(f64, f64)]| Curve { label: "a".into(), points: points.to_vec(), scattered: false };
        for (i, points) in [&[][..], &[(1.0, 2.0)], &[(1.0, 1.0), (10.0, 5.0)], &[(-1.0, 0.0), (2.0, 0.0)]]
            .iter()
            .enumerate()
        {
            let chart = Chart { curves: vec![curve(points)], logarithmic: true, ..Chart::default() };
            let files = chart.save(dir.path(), &format!("c{i}")).unwrap();
            assert!(std::fs::read_to_string(&files[0]).unwrap().contains("</svg>"));
        }
    }
}
