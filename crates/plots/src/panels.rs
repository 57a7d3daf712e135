//! Several pictures in one file.

use crate::drawing::{Anchor, Drawing, LabelPlace};
use crate::error::Result;
use crate::legend::Legend;
use crate::plot::{Picture, SIZE, TITLE, WORDS};
use crate::style::INK;
use crate::text::Fonts;

/// Pictures of one size beside and below each other, with a title above and a legend below all of them.
#[derive(Debug, Clone, Default)]
pub struct Panels {
    /// The pictures, row by row.
    pub pictures: Vec<Picture>,
    /// Number of pictures in a row.
    pub columns: usize,
    /// Title above all pictures.
    pub title: String,
    /// Legend below all pictures; a single picture has its own.
    pub legend: Legend,
}

impl Panels {
    /// The bytes of `NAME.svg` and `NAME.png`.
    ///
    /// # Errors
    /// [`crate::Error`] where an image in it cannot be encoded.
    pub fn files(self, name: &str) -> Result<[(String, Vec<u8>); 2]> {
        let fonts = Fonts::load()?;
        self.drawing(&fonts).files(&fonts, name)
    }

    /// The SVG as text.
    ///
    /// # Errors
    /// [`crate::Error`] where an image in it cannot be encoded.
    pub fn svg(self) -> Result<String> {
        let fonts = Fonts::load()?;
        self.drawing(&fonts).svg(&fonts, "a picture")
    }

    pub(crate) fn drawing(mut self, fonts: &Fonts) -> Drawing {
        let (width, height) = self.pictures.first().map_or(SIZE, |p| p.size);
        let columns = self.columns.max(1);
        let rows = self.pictures.len().div_ceil(columns);
        let top = if self.title.is_empty() { 0.0 } else { 1.8 * TITLE };
        let (all_width, all_height) = (columns as f64 * width, top + rows as f64 * height);
        let mut left = 40.0;
        if let [only] = self.pictures.as_mut_slice() {
            left = only.frame(fonts, (0.0, 0.0))[0];
            if let Some(below) = only.legend_below(fonts) {
                self.legend = below.clone();
                only.legend_below = true;
            }
        }
        let set = self.legend.set(fonts, WORDS, all_width - left - 18.0);
        let legend_height = if self.legend.is_empty() { 0.0 } else { set.height() + 20.0 };
        let mut drawing = Drawing::new(all_width, all_height + legend_height);
        if !self.title.is_empty() {
            let title = fonts.typeset(&self.title, TITLE);
            drawing.label(title, LabelPlace::new((left, 1.45 * TITLE), Anchor::Start), INK);
        }
        if !self.legend.is_empty() {
            set.draw(&mut drawing, (left, all_height + 6.0));
        }
        for (i, picture) in self.pictures.into_iter().enumerate() {
            let corner = ((i % columns) as f64 * width, top + (i / columns) as f64 * height);
            picture.draw(fonts, &mut drawing, corner);
        }
        drawing
    }
}

impl Picture {
    /// The bytes of `NAME.svg` and `NAME.png`.
    ///
    /// # Errors
    /// [`crate::Error`] where an image in it cannot be encoded.
    pub fn files(self, name: &str) -> Result<[(String, Vec<u8>); 2]> {
        self.alone().files(name)
    }

    /// The SVG as text.
    ///
    /// # Errors
    /// [`crate::Error`] where an image in it cannot be encoded.
    pub fn svg(self) -> Result<String> {
        self.alone().svg()
    }

    fn alone(self) -> Panels {
        Panels { columns: 1, pictures: vec![self], ..Panels::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Axis;
    use crate::style::LegendKey;

    #[test]
    fn panels_stand_side_by_side() {
        let small = || {
            let (x, y) = (Axis::Linear(0.0, 1.0), Axis::Linear(0.0, 1.0));
            Picture::new(x, y, "x", "y").with_title("A law").with_size(400.0, 300.0)
        };
        let mut legend = Legend::default();
        legend.push("both", "#000000", LegendKey::Words);
        let panels =
            Panels { pictures: vec![small(), small(), small()], columns: 2, title: "Three".into(), legend };
        let svg = panels.svg().unwrap();
        assert!(svg.contains("width=\"800\"") && svg.contains("aria-label=\"both\""));
        assert_eq!(svg.matches("aria-label=\"A law\"").count(), 3);
    }
}
