//! One picture of a few curves, for whoever has them.

use crate::axis::{Axis, linear, logarithmic};
use crate::plot::Picture;
use crate::style::{COLORS, Key, LineStyle, Mark, SHAPES};
use runs::Result;
use std::path::{Path, PathBuf};

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
    /// Below the title.
    pub subtitle: String,
    /// Below, with its unit; symbols stand between dollar signs.
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
        let axis = |values: Vec<f64>| -> Axis {
            if self.logarithmic && values.iter().all(|v| *v > 0.0 || !v.is_finite()) {
                return logarithmic(values);
            }
            linear(values)
        };
        let (x, y) = (axis(points().map(|p| p.0).collect()), axis(points().map(|p| p.1).collect()));
        let mut picture = Picture::new(x, y, &self.x_label, &self.y_label)
            .with_title(&self.title)
            .with_subtitle(&self.subtitle);
        let styles = COLORS.iter().zip(SHAPES).cycle();
        for (i, (curve, (color, shape))) in self.curves.iter().zip(styles).enumerate() {
            // Earlier curves are wider and their marks larger, so that they show where later ones lie on them.
            let above = (self.curves.len() - 1 - i).min(4) as f64;
            let mark = if i % 2 == 0 { Mark::Solid(shape) } else { Mark::Hollow(shape) };
            // Where points are dense they are the line.
            let marked = curve.scattered || curve.points.len() <= MOST_MARKS;
            if !curve.scattered {
                let wider = if marked { 0.9 } else { 1.8 };
                picture.line(&curve.points, color, 1.7 + wider * above, LineStyle::Solid);
            }
            if marked {
                picture.points(&curve.points, color, 3.4 + 1.1 * above, mark);
            }
            let key = match (curve.scattered, marked) {
                (true, _) => Key::Mark(mark),
                (false, true) => Key::Curve(mark),
                (false, false) => Key::Line(LineStyle::Solid),
            };
            picture.legend(&curve.label, color, key);
        }
        picture.save(directory, name)
    }
}

/// More points than this on one line are drawn without marks.
const MOST_MARKS: usize = 60;

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
