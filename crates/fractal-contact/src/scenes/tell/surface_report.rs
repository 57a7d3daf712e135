//! `report.html` of a surface: the metadata of its file, the steps of preprocessing, the map and its
//! statistics.

use crate::scenes::read::{HEIGHTS, Result, description};
use crate::scenes::run::{FieldView, field_pictures};
use crate::scenes::tell::page::{PageSection, ReportPage};
use crate::scenes::tell::{MapStatisticsTables, page};
use contact_model::HeightMap;
use maud::{Markup, html};
use plots::{Chart, Curve, FieldPicture};
use surface_io::Metadata;

/// Bins of the distribution of heights.
const BINS: usize = 60;

/// The contents of a page.
pub(crate) struct SurfaceReport<'a> {
    /// Name of the file.
    pub name: &'a str,
    pub metadata: &'a Metadata,
    /// Steps of the preprocessing, in order.
    pub steps: &'a [String],
    pub map: &'a HeightMap,
    pub statistics: &'a MapStatisticsTables,
}

impl SurfaceReport<'_> {
    /// The page.
    ///
    /// # Errors
    /// Pictures that cannot be encoded.
    pub fn page(&self) -> Result<ReportPage> {
        let head = html! { p.lead { "A surface: its map, what its file says, and statistics with their intervals." } };
        let file = html! {
            pre { (self.metadata) }
            @if self.steps.is_empty() { p { "Nothing was done to the heights." } }
            @else { h3 { "What was done to it" } ol { @for step in self.steps { li { (step) } } } }
            h3 { "The map that is described below" } pre { (description(self.map, self.statistics.system).without_fit()) }
        };
        let charts = self.statistics.charts(self.name);
        let distribution = self.distribution();
        let charts = page::figures(charts.iter().map(|(_, chart)| chart).chain([&distribution]))?;
        let statistics = html! {
            (page::statistics(self.statistics))
            p { "The map counts as a piece of a larger surface: it is not periodic, and spectra are under Hann's window. Bands and intervals are \
                 of Gaussian heights." }
        };
        let map =
            html! { @if !self.statistics.profile { p { (page::READING) } } div.fields { (self.field()?) } };
        let section = |id, name, heading, content| PageSection { id, name, heading, content };
        let sections = vec![
            section("map", "Map", "The map", map),
            section("statistics", "Statistics", "Statistics", statistics),
            section(
                "curves",
                "Curves",
                "Spectrum, differences, slopes, heights",
                html! { div.charts { (charts) } },
            ),
            section("file", "File", "What the file says", file),
            section("cite", "Sources", "Sources to cite", sources()),
        ];
        Ok(ReportPage { title: self.name.to_owned(), head, sections })
    }

    fn field(&self) -> Result<Markup> {
        let map = self.map;
        let values: Vec<f64> =
            map.heights().iter().map(|h| if h.is_finite() { *h } else { f64::NAN }).collect();
        let view = FieldView::new(map.cells(), &values);
        let unit = self.statistics.system.shown("m");
        let mut picture = FieldPicture {
            title: "Heights".into(),
            subtitle: self.name.into(),
            quantity: HEIGHTS.words.into(),
            unit,
            length_unit: unit,
            cells: map.cells(),
            size: map.size(),
            values: &[],
            white_zero: HEIGHTS.white_zero,
            signed: false,
            range: None,
            contact: &[],
            arrows: None,
            lines: &[],
            marks: &[],
            downwards: false,
            classes: &[],
        };
        if self.statistics.profile {
            picture.subtitle += &view.reduction().map_or_else(String::new, |said| format!("; {said}"));
            return page::chart(&field_pictures::row_chart(&picture, view.row(map.size().x)));
        }
        page::field(&picture, &view, page::Reading::Values)
    }

    /// Distribution of the heights, with that of the normal law.
    fn distribution(&self) -> Chart {
        let heights: Vec<f64> = self.map.defined().collect();
        let count = heights.len() as f64;
        let mean = heights.iter().sum::<f64>() / count;
        let rms = self.statistics.rms_height().unwrap_or_default();
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let width = (high - low) / BINS as f64;
        let mut counts = [0_u64; BINS];
        for h in &heights {
            let bin = if width > 0.0 { ((h - low) / width) as usize } else { 0 };
            counts[bin.min(BINS - 1)] += 1;
        }
        let z = |i: usize| (low - mean + (i as f64 + 0.5) * width) / rms;
        let shown = rms > 0.0 && width > 0.0;
        let bins = || (0..BINS).filter(|_| shown);
        let found = bins().map(|i| (z(i), counts[i] as f64 / count * (rms / width))).collect();
        let normal =
            bins().map(|i| (z(i), (-0.5 * z(i) * z(i)).exp() / std::f64::consts::TAU.sqrt())).collect();
        let curve = |label: &str, points| Curve { label: label.into(), points, ..Curve::default() };
        Chart {
            title: "Distribution of heights".into(),
            subtitle: format!("{}: about the mean", self.name),
            x_label: "height over rms height".into(),
            y_label: "probability density".into(),
            curves: vec![
                curve(if self.statistics.profile { "profile" } else { "map" }, found),
                curve("normal law", normal),
            ],
            logarithmic: false,
            ..Chart::default()
        }
    }
}

/// Where the definitions come from.
fn sources() -> Markup {
    html! { ul {
        @for (citation, what) in [
            ("ISO 25178-2:2021", "Sa to Spc"),
            ("ISO 21920-2:2021", "Pa to Pz, of profiles"),
            ("Jacobs, Junge, Pastewka, Surf. Topogr. Metrol. Prop. 5, 013001 (2017)", "power spectra; here with 1/(2 pi)^2"),
            ("Sanner, Noehring, Thimons, Jacobs, Pastewka, Appl. Surf. Sci. Adv. 7, 100190 (2022)", "slope and curvature by scale"),
            ("Nayak, J. Lubr. Technol. 93, 398 (1971)", "Nayak's parameter"),
        ] { li { (citation) ": " (what) } }
    } }
}
