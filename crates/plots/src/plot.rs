//! Pictures: thin words over kuva, SVG and PNG of one scene.

use kuva::backend::png::PngBackend;
use kuva::backend::svg::SvgBackend;
use kuva::plot::annotations::TextAnnotation;
use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::plot::line::{LinePlot, LineStyle};
use kuva::plot::scatter::{MarkerShape, ScatterPlot};
use kuva::render::color::Color;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, render_multiple};
use runs::files;
use runs::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Pixels of a PNG per unit of the scene.
const SCALE: f32 = 2.0;

/// Colour of a legend key that is drawn open; used for nothing else.
const OPEN: &str = "#777779";

/// A pair of axes and what is drawn on them.
#[allow(missing_debug_implementations)] // Plots of kuva have no Debug.
pub struct Picture {
    plots: Vec<Plot>,
    legend: Vec<LegendEntry>,
    range: [(f64, f64); 2],
    layout: Layout,
    corner: LegendPosition,
}

/// How far an axis goes, and whether it is logarithmic.
#[derive(Debug, Clone, Copy)]
pub enum Axis {
    /// From, to.
    Linear(f64, f64),
    /// From, to; both positive.
    Log(f64, f64),
}

impl Axis {
    fn range(self) -> (f64, f64) {
        match self {
            Self::Linear(a, b) | Self::Log(a, b) => (a, b),
        }
    }
}

/// A logarithmic axis around positive values with room for their marks; one decade around nothing.
pub fn logarithmic(values: impl IntoIterator<Item = f64>) -> Axis {
    const ROOM: f64 = 1.7;
    let (low, high) = extent(values.into_iter().filter(|v| *v > 0.0)).unwrap_or((1.0, 10.0));
    Axis::Log(low / ROOM, high * ROOM)
}

/// Smallest and largest value.
pub fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().fold(None, |e, v| match e {
        None => Some((v, v)),
        Some((a, b)) => Some((a.min(v), b.max(v))),
    })
}

impl Picture {
    /// Empty axes.
    pub fn new(x: Axis, y: Axis, x_label: &str, y_label: &str) -> Self {
        let mut layout = Layout::new(x.range(), y.range())
            .with_width(760.0)
            .with_height(600.0)
            .with_x_label(x_label)
            .with_y_label(y_label)
            .with_x_axis_min(x.range().0)
            .with_x_axis_max(x.range().1)
            .with_y_axis_min(y.range().0)
            .with_y_axis_max(y.range().1)
            .with_box_axes()
            .with_show_grid(false)
            .with_label_size(17)
            .with_tick_size(14)
            .with_body_size(14);
        if matches!(x, Axis::Log(..)) {
            layout = layout.with_log_x().with_x_tick_format(power_of_ten());
        }
        if matches!(y, Axis::Log(..)) {
            layout = layout.with_log_y().with_y_tick_format(power_of_ten());
        }
        Self {
            plots: Vec::new(),
            legend: Vec::new(),
            range: [x.range(), y.range()],
            layout,
            corner: LegendPosition::InsideTopLeft,
        }
    }

    /// A title above the axes.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        self.layout = self.layout.with_title(title).with_title_size(17);
        self
    }

    /// The legend in the lower right corner, which rising curves leave free.
    #[must_use]
    pub fn with_legend_below(mut self) -> Self {
        self.corner = LegendPosition::InsideBottomRight;
        self
    }

    /// The legend in the lower left corner, which falling curves leave free.
    #[must_use]
    pub fn with_legend_at_lower_left(mut self) -> Self {
        self.corner = LegendPosition::InsideBottomLeft;
        self
    }

    /// Width and height of the axes.
    #[must_use]
    pub fn with_size(mut self, width: f64, height: f64) -> Self {
        self.layout = self.layout.with_width(width).with_height(height);
        self
    }

    /// Only what lies on the axes is drawn: the raster backend does not clip.
    fn visible(&self, p: (f64, f64)) -> bool {
        within(self.range[0], self.range[1], p)
    }

    /// A line through the points; it breaks where a point is missing or off the axes.
    pub fn line(&mut self, points: &[(f64, f64)], color: &str, width: f64, style: &LineStyle) {
        let [x, y] = self.range;
        let visible = |p: &(f64, f64)| within(x, y, *p);
        for run in points.chunk_by(|a, b| visible(a) && visible(b)) {
            if run.len() > 1 {
                let line = LinePlot::new()
                    .with_data(run.to_vec())
                    .with_color(color)
                    .with_stroke_width(width)
                    .with_line_style(style.clone());
                self.plots.push(line.into());
            }
        }
    }

    /// Marks at points within the axes.
    pub fn points(&mut self, points: &[(f64, f64)], color: &str, size: f64, mark: Mark) {
        let data: Vec<_> = points.iter().copied().filter(|p| self.visible(*p)).collect();
        if data.is_empty() {
            return;
        }
        let (shape, opacity) = match mark {
            Mark::Solid(shape) => (shape, 1.0),
            Mark::Hollow(shape) => (shape, 0.0),
        };
        let mut plot =
            ScatterPlot::new().with_data(data).with_color(color).with_size(size).with_marker(shape);
        plot = plot.with_marker_opacity(opacity);
        if matches!(mark, Mark::Hollow(_)) {
            plot = plot.with_marker_stroke_width(1.4);
        }
        self.plots.push(plot.into());
    }

    /// Points with vertical error bars (value, half width).
    pub fn errors(&mut self, points: &[(f64, f64, Option<f64>)], color: &str) {
        for &(x, y, e) in points {
            let Some(e) = e else { continue };
            let [_, (low, high)] = self.range;
            self.line(&[(x, (y - e).max(low)), (x, (y + e).min(high))], color, 1.2, &LineStyle::Solid);
        }
    }

    /// Words at a place.
    pub fn note(&mut self, text: &str, (x, y): (f64, f64)) {
        let note = TextAnnotation::new(text, x, y).with_color("#777777").with_font_size(13);
        self.layout.annotations.push(note);
    }

    /// A legend line; points and lines do not make one by themselves.
    pub fn legend(&mut self, label: &str, color: &str, key: Key) {
        let (shape, dash) = match key {
            Key::Line => (LegendShape::Line, None),
            // Short enough for two dashes on the key.
            Key::Dashed => (LegendShape::Line, Some("3 6".to_owned())),
            Key::Mark(shape) => (LegendShape::Marker(shape), None),
            Key::Open => (LegendShape::Circle, None),
        };
        let color = if matches!(key, Key::Open) { OPEN } else { color };
        self.legend.push(LegendEntry {
            label: label.to_owned(),
            color: color.to_owned(),
            shape,
            dasharray: dash,
        });
    }

    /// The axes with everything on them.
    pub fn parts(self) -> (Vec<Plot>, Layout) {
        let layout = if self.legend.is_empty() {
            self.layout
        } else {
            self.layout.with_legend_entries(self.legend).with_legend_position(self.corner)
        };
        (self.plots, layout)
    }

    /// Writes `NAME.svg` and `NAME.png`.
    ///
    /// # Errors
    /// [`Error::File`] when they cannot be written.
    pub fn save(self, directory: &Path, name: &str) -> Result<Vec<PathBuf>> {
        let (plots, layout) = self.parts();
        save(render_multiple(plots, layout), directory, name)
    }
}

fn within(x: (f64, f64), y: (f64, f64), p: (f64, f64)) -> bool {
    (x.0..=x.1).contains(&p.0) && (y.0..=y.1).contains(&p.1)
}

/// How a point looks.
#[derive(Debug, Clone, Copy)]
pub enum Mark {
    /// Filled.
    Solid(MarkerShape),
    /// On the one-cell floor of the grid.
    Hollow(MarkerShape),
}

/// How a legend line looks.
#[derive(Debug, Clone, Copy)]
pub enum Key {
    /// A solid line.
    Line,
    /// A dashed line.
    Dashed,
    /// A mark.
    Mark(MarkerShape),
    /// An open circle.
    Open,
}

/// Dark blue to yellow-green over D_f = 2 .. 3: order is visible, also in grey.
pub fn color(fractal_dimension: f64) -> String {
    const STOPS: [[f64; 3]; 5] = [
        [48.0, 18.0, 110.0],
        [52.0, 94.0, 168.0],
        [29.0, 145.0, 140.0],
        [84.0, 172.0, 62.0],
        [214.0, 160.0, 20.0],
    ];
    let t = (fractal_dimension - 2.0).clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let i = (t as usize).min(STOPS.len() - 2);
    let f = t - i as f64;
    let mix = |c: usize| (STOPS[i][c] * (1.0 - f) + STOPS[i + 1][c] * f).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

fn power_of_ten() -> TickFormat {
    TickFormat::Custom(Arc::new(|v: f64| {
        let exponent = v.log10().round() as i32;
        // Ticks between the decades stay without a label.
        if (v.log10() - f64::from(exponent)).abs() > 1e-6 {
            return String::new();
        }
        if exponent == 0 {
            return "1".to_owned();
        }
        let digits: String = exponent
            .to_string()
            .chars()
            .map(|c| match c {
                '-' => '\u{207b}',
                '1' => '\u{b9}',
                '2' => '\u{b2}',
                '3' => '\u{b3}',
                c => char::from_u32(0x2070 + c.to_digit(10).unwrap_or(0)).unwrap_or(c),
            })
            .collect();
        format!("10{digits}")
    }))
}

/// Writes a scene as SVG and PNG.
///
/// # Errors
/// [`Error::File`] when they cannot be written, [`Error::Content`] where the picture cannot be drawn.
pub fn save(mut scene: Scene, directory: &Path, name: &str) -> Result<Vec<PathBuf>> {
    number_clips(&mut scene);
    open_keys(&mut scene);
    let svg = directory.join(format!("{name}.svg"));
    let png = directory.join(format!("{name}.png"));
    files::write_whole(&svg, SvgBackend::new().render_scene(&scene).as_bytes())?;
    files::write_whole(&png, &raster(&scene, &png)?)?;
    Ok(vec![svg, png])
}

/// PNG bytes of a scene.
///
/// # Errors
/// [`Error::Content`] where the picture cannot be drawn.
pub fn raster(scene: &Scene, path: &Path) -> Result<Vec<u8>> {
    PngBackend::new().with_scale(SCALE).render_scene(scene).map_err(|e| Error::content(path, e))
}

/// Pixels per unit of a scene in its PNG.
pub fn pixels_per_unit() -> usize {
    SCALE as usize
}

/// The library counts clip regions per process; counted per picture, the same picture has the same bytes.
fn number_clips(scene: &mut Scene) {
    let Scene { elements, defs, .. } = scene;
    let starts = elements.iter_mut().filter_map(|e| match e {
        Primitive::ClipStart { id, .. } => Some(id),
        _ => None,
    });
    for (i, id) in starts.enumerate() {
        let own = format!("clip-{}", i + 1);
        for def in defs.iter_mut() {
            *def = def.replace(&format!("\"{id}\""), &format!("\"{own}\""));
        }
        *id = own;
    }
}

/// The library's legend knows no open marks: empties those of the colour [`OPEN`].
fn open_keys(scene: &mut Scene) {
    for element in &mut scene.elements {
        if let Primitive::Circle { fill, stroke, stroke_width, r, .. } = element
            && *fill == Color::from(OPEN)
        {
            (*stroke, *stroke_width) = (Some(fill.clone()), Some(1.4));
            *fill = Color::None;
            *r = 4.0;
        }
    }
}
