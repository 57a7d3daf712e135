//! A chart of a few curves.

use crate::axis::{Axis, linear, logarithmic};
use crate::error::Result;
use crate::plot::Picture;
use crate::style::{COLORS, LegendKey, LineStyle, Mark, MarkShape, NEUTRAL, SHAPES};
use contact_model::units::multiple;

/// A named curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Its name in the legend.
    pub label: String,
    /// Its points in their order; points that the axes cannot show are left out.
    pub points: Vec<(f64, f64)>,
    /// A shaded band through (x, lower end, upper end), such as an error; may be empty.
    pub band: Vec<(f64, f64, f64)>,
    /// Those of its points that are to be read with care, such as contacts of few cells: each stands in a
    /// square.
    pub careful: Vec<(f64, f64)>,
}

/// Curves on one pair of axes. An axis is logarithmic on request, if every value is positive.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Title above the axes.
    pub title: String,
    /// Line below the title.
    pub subtitle: String,
    /// Label of the horizontal axis, with its unit; symbols stand between dollar signs.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Whether logarithmic axes are requested.
    pub logarithmic: bool,
    /// Whether points follow each other in time: arrows along the lines, rings at their starts, and lines
    /// through the origin.
    pub directed: bool,
    /// What the squares around points mean, in the legend.
    pub careful: String,
}

impl Chart {
    /// The chart of numbers in these units of SI along x and y, in the multiples in which its largest numbers
    /// are read; the units stand behind the labels. Without a unit, or with `1` or `-`, the numbers stay; so
    /// they do in `scene`, the units of a scene that names none.
    #[must_use]
    pub fn in_units(mut self, [x, y]: [&str; 2]) -> Self {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let largest = |sizes: &mut dyn Iterator<Item = f64>| {
            sizes.map(f64::abs).filter(|size| size.is_finite()).fold(0.0, f64::max)
        };
        let (x, per_x) = multiple(x, largest(&mut points().map(|point| point.0)));
        let (y, per_y) = multiple(y, largest(&mut points().map(|point| point.1)));
        for curve in &mut self.curves {
            let points = curve.points.iter_mut().chain(&mut curve.careful);
            points.for_each(|p| *p = (per_x * p.0, per_y * p.1));
            curve.band.iter_mut().for_each(|p| *p = (per_x * p.0, per_y * p.1, per_y * p.2));
        }
        for (label, unit) in [(&mut self.x_label, x), (&mut self.y_label, y)] {
            match unit.as_str() {
                "" | "1" | "-" => {}
                "scene" => *label += " (units of the scene)",
                unit => *label += &format!(" ($\\rm{{{unit}}}$)"),
            }
        }
        self
    }

    /// The bytes of `NAME.svg` and `NAME.png`.
    ///
    /// # Errors
    /// [`crate::Error`] where the fonts cannot be read.
    pub fn files(&self, name: &str) -> Result<[(String, Vec<u8>); 2]> {
        self.picture().files(name)
    }

    /// The SVG as text.
    ///
    /// # Errors
    /// [`crate::Error`] where the fonts cannot be read.
    pub fn svg(&self) -> Result<String> {
        self.picture().svg()
    }

    fn picture(&self) -> Picture {
        let ends =
            |c: &Curve| c.band.iter().flat_map(|&(x, low, high)| [(x, low), (x, high)]).collect::<Vec<_>>();
        // The lower end of a wide band may be negative, where a logarithmic axis has no place for it.
        let shown = |point: &(f64, f64)| !self.logarithmic || (point.0 > 0.0 && point.1 > 0.0);
        let bands: Vec<(f64, f64)> = self.curves.iter().flat_map(ends).filter(shown).collect();
        let points = || self.curves.iter().flat_map(|c| c.points.iter()).chain(&bands);
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
        if self.directed {
            picture.zeros();
        }
        let styles = COLORS.iter().zip(SHAPES).cycle();
        for (i, (curve, (color, shape))) in self.curves.iter().zip(styles).enumerate() {
            // Earlier curves are wider and their marks larger, so that they show where later ones lie on
            // them.
            let above = (self.curves.len() - 1 - i).min(4) as f64;
            let mark = if i % 2 == 0 { Mark::Solid(shape) } else { Mark::Hollow(shape) };
            // Where points are dense they are the line.
            let marked = curve.points.len() <= MOST_MARKS;
            let wider = if marked { 0.9 } else { 1.8 };
            picture.band(&curve.band, color);
            picture.line(&curve.points, color, 1.7 + wider * above, LineStyle::Solid);
            if marked {
                picture.points(&curve.points, color, 3.4 + 1.1 * above, mark);
            }
            if self.directed {
                picture.arrows(&curve.points, color);
                picture.points(
                    &curve.points[..curve.points.len().min(1)],
                    color,
                    9.0,
                    Mark::Ring(MarkShape::Circle),
                );
            }
            picture.points(&curve.careful, NEUTRAL, CAREFUL, Mark::Ring(MarkShape::Square));
            let key = if marked { LegendKey::Curve(mark) } else { LegendKey::Line(LineStyle::Solid) };
            picture.legend(&curve.label, color, key);
        }
        if self.directed && self.curves.iter().any(|curve| !curve.points.is_empty()) {
            picture.legend("start", NEUTRAL, LegendKey::Sized(Mark::Ring(MarkShape::Circle), 7.0));
        }
        if self.curves.iter().any(|curve| !curve.careful.is_empty()) {
            picture.legend(&self.careful, NEUTRAL, LegendKey::Sized(Mark::Ring(MarkShape::Square), 7.0));
        }
        picture
    }
}

/// More points than this on one line are drawn without marks.
const MOST_MARKS: usize = 60;
/// Half the side of the square around a point that is to be read with care.
const CAREFUL: f64 = 10.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panels::Panels;
    use proptest::prelude::*;

    #[test]
    fn curves_become_a_picture_whatever_they_hold() {
        let curve = |points: &[(f64, f64)]| Curve {
            label: "a".into(),
            points: points.to_vec(),
            band: vec![(1.0, -1.0, 2.0)],
            careful: points.to_vec(),
        };
        for (i, points) in [&[][..], &[(1.0, 2.0)], &[(1.0, 1.0), (10.0, 5.0)], &[(-1.0, 0.0), (2.0, 0.0)]]
            .iter()
            .enumerate()
        {
            let chart = Chart { curves: vec![curve(points)], logarithmic: true, ..Chart::default() };
            let [(name, svg), _] = chart.files(&format!("c{i}")).unwrap();
            assert_eq!(name, format!("c{i}.svg"));
            assert!(String::from_utf8(svg).unwrap().contains("</svg>"));
        }
    }

    /// Any bits, so that exponents are spread evenly from subnormal numbers to 1e308; infinities and NaN
    /// among them.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            any::<u64>().prop_map(f64::from_bits),
            prop_oneof![
                Just(0.0),
                Just(5e-324),
                Just(1e-310),
                Just(1e-308),
                Just(1.0),
                Just(f64::MAX),
                Just(-f64::MAX)
            ],
        ]
    }

    proptest! {
        // Each case draws two pictures.
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn charts_of_any_numbers_have_finite_coordinates(
            points in prop::collection::vec((number(), number()), 0..5),
            band in prop::collection::vec((number(), number(), number()), 0..4),
            logarithmic in any::<bool>(),
            directed in any::<bool>(),
        ) {
            let errors: Vec<(f64, f64, Option<f64>)> = band.iter().map(|&(x, y, e)| (x, y, Some(e))).collect();
            let curve = Curve { label: "a".into(), careful: points.clone(), points, band };
            let chart = Chart { curves: vec![curve], logarithmic, directed, ..Chart::default() };
            let mut picture = chart.picture();
            picture.errors(&errors, "#000000");
            let fonts = crate::text::Fonts::load().unwrap();
            let drawing = Panels { columns: 1, pictures: vec![picture], ..Panels::default() }.drawing(&fonts);
            let svg = drawing.svg(&fonts, "a picture").unwrap();
            prop_assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            prop_assert!(drawing.png(&fonts, "a picture").is_ok());
        }
    }

    #[test]
    fn axes_have_units_that_suit_their_numbers() {
        let curve = Curve {
            points: vec![(1e6, 2e-12), (1e8, 1.7e-10)],
            band: vec![(1e8, 1e-10, 2e-10)],
            careful: vec![(1e6, 2e-12)],
            ..Curve::default()
        };
        let chart =
            Chart { x_label: "p".into(), y_label: "A".into(), curves: vec![curve], ..Chart::default() };
        let shown = chart.clone().in_units(["Pa", "m^2"]);
        assert_eq!((shown.x_label.as_str(), shown.y_label.as_str()), ("p ($\\rm{MPa}$)", "A ($\\rm{µm^2}$)"));
        let near =
            |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
        near(shown.curves[0].points[1].0, 100.0);
        near(shown.curves[0].points[1].1, 170.0);
        near(shown.curves[0].band[0].2, 200.0);
        assert_eq!(shown.curves[0].careful, shown.curves[0].points[..1]);
        assert_eq!(chart.clone().in_units(["1", ""]), chart);
        assert_eq!(chart.in_units(["scene", "-"]).x_label, "p (units of the scene)");
    }

    #[test]
    fn numbers_below_the_normal_ones_are_drawn() {
        let points = vec![(1e-320, 1e-310), (1e-315, 3e-309), (5e-324, 2e-308)];
        let curve = Curve { label: "a".into(), points, ..Curve::default() };
        let chart = Chart { curves: vec![curve], logarithmic: true, ..Chart::default() };
        let svg = chart.svg().unwrap();
        assert!(svg.contains("aria-label=\"10^\u{2212}310\""), "{svg}");
    }
}
