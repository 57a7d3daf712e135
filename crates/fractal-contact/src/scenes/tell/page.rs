//! A page of HTML that needs no network and no other file: its frame, charts, fields and statistics.

use crate::scenes::read::{Result, multiple, short};
use crate::scenes::run::FieldView;
use crate::scenes::tell::MapStatisticsTables;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use contact_model::units::number;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use plots::{Chart, ColourScale, FieldPicture, Palette};

const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = include_str!("page/page.js");

/// How the values of a field are read on the page.
pub(crate) const READING: &str = "The mouse, a click or the arrow keys read the value of a cell; a double click, + and - zoom, and so does the wheel with shift or control.";

/// A page: a heading, the content below it, and its sections.
pub(crate) struct ReportPage {
    pub title: String,
    pub head: Markup,
    pub sections: Vec<PageSection>,
}

/// A section of a page.
pub(crate) struct PageSection {
    pub id: &'static str,
    /// Its name in the list of sections.
    pub name: &'static str,
    pub heading: &'static str,
    pub content: Markup,
}

impl ReportPage {
    /// The whole page, as `report.html` has it.
    pub fn html(&self) -> String {
        let Self { title, head, sections } = self;
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="generator" content=(concat!("fractal-contact ", env!("CARGO_PKG_VERSION")));
                    title { (title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    header { h1 { (title) } (head) }
                    nav aria-label="Sections" { ul {
                        @for PageSection { id, name, .. } in sections { li { a href={ "#" (id) } { (name) } } }
                    } }
                    main { (self.sections()) }
                    footer { p { "fractal-contact " (env!("CARGO_PKG_VERSION")) } }
                    script id="palette" type="application/octet-stream" { (PreEscaped(palette())) }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        page.into_string()
    }

    /// The content of the page below its title, as HTML. Another page can show it in its own frame, with the style, the
    /// script and the palettes of [`page_parts`].
    pub fn content(&self) -> String {
        html! { (self.head) (self.sections()) }.into_string()
    }

    fn sections(&self) -> Markup {
        html! {
            @for PageSection { id, heading, content, .. } in &self.sections {
                section id=(id) { h2 { (heading) } (content) }
            }
        }
    }
}

/// The colours of all palettes, three bytes each, in base 64, as [`SCRIPT`] reads them.
fn palette() -> String {
    STANDARD.encode(Palette::ALL.map(Palette::colours).as_flattened().as_flattened())
}

/// The style, the script and the palettes of reports, for another page that shows a report in its own frame. The script
/// makes fields readable, and reads the palettes from an element with the identifier `palette`.
pub fn page_parts() -> [String; 3] {
    [STYLE.to_owned(), SCRIPT.to_owned(), palette()]
}

/// A sentence in which text between backticks becomes code.
pub(crate) fn words(text: &str) -> Markup {
    html! { @for (i, part) in text.split('`').enumerate() { @if i % 2 == 1 { code { (part) } } @else { (part) } } }
}

/// A unit with its powers as superscripts, such as `µm^2`.
pub(crate) fn unit(unit: &str) -> Markup {
    let mut parts = unit.split('^');
    let first = parts.next().unwrap_or_default();
    // A power is a sign and digits; what follows stands on the line.
    let power = |part: &str| part.find(|c: char| !c.is_ascii_digit() && c != '-').unwrap_or(part.len());
    html! { (first) @for part in parts { @let (raised, rest) = part.split_at(power(part)); sup { (raised) } (rest) } }
}

/// A chart as an embedded picture, so that its identifiers do not clash with those of other charts.
pub(crate) fn chart(chart: &Chart) -> Result<Markup> {
    let svg = STANDARD.encode(chart.svg()?);
    let plain = format!("{}, {}", chart.title, chart.subtitle).replace(['$', '\\'], "");
    Ok(
        html! { figure { img src={ "data:image/svg+xml;base64," (svg) } alt=(plain) width="800" height="600"; } },
    )
}

/// Charts one after the other.
pub(crate) fn figures<'a>(charts: impl IntoIterator<Item = &'a Chart>) -> Result<Markup> {
    let drawn = charts.into_iter().map(chart).collect::<Result<Vec<_>>>()?;
    Ok(html! { @for figure in drawn { (figure) } })
}

/// The parameters of a surface with their intervals.
pub(crate) fn statistics(of: &MapStatisticsTables) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Statistics of the surface" {
            table.words.parameters {
                tr { @for h in ["parameter", "value", "95 % interval", "meaning"] { th scope="col" { (h) } } }
                @for [symbol, value, interval, meaning] in of.rows() {
                    tr { th scope="row" { (symbol) } td { (unit(&value)) } td { (interval) } td { (words(&meaning)) } }
                }
            }
        }
        @for note in &of.notes { p { "Not known: " (words(note)) } }
        @for remark in &of.remarks { p { (words(remark)) } }
    }
}

/// Largest number of ticks along the longer side of a map, and along any shorter side.
const TICKS: [f64; 2] = [6.0, 2.0];

/// The ticks of an axis from 0 to its length, with at most `most` steps: multiples of 1, 2 or 5 times a power
/// of ten.
fn ticks(length: f64, most: f64) -> Vec<f64> {
    let least = length / most;
    let power = 10f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    let step = steps.into_iter().find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(length);
    let count = (length / step * (1.0 + 1e-9)) as usize;
    (0..=count.min(most as usize)).map(|i| i as f64 * step).collect()
}

/// Whether the values of a field on the page are read by clicks and keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reading {
    Values,
    PictureAlone,
}

/// A field with axes, whose values are read by clicks and keys; where no script runs, it is a picture.
///
/// # Errors
/// A picture that cannot be encoded.
pub(crate) fn field(picture: &FieldPicture<'_>, view: &FieldView, reading: Reading) -> Result<Markup> {
    // Ends of the values that are only rounding become zero here, as in the pictures.
    let (least, most) = ColourScale::new(view.ends.unwrap_or_default(), false, false).ends();
    let own = FieldPicture { range: Some(picture.range.unwrap_or((least, most))), ..picture.clone() };
    let scale = own.scale();
    let (low, high) = scale.ends();
    let values: Vec<f64> = view.values.iter().map(|v| f64::from(*v) * view.factor).collect();
    let png = scale.encode(view.shown.columns, &values)?;
    let size = picture.size;
    let (length, per_length) = multiple(picture.length_unit, size.x.max(size.y));
    let (unit_name, per_unit) = multiple(picture.unit, high.abs().max(low.abs()));
    let words = picture.quantity.split('$').next().unwrap_or_default().trim().trim_end_matches(", magnitude");
    let data = serde_json::json!({
        "across": view.shown.columns, "down": view.shown.rows,
        "columns": view.cells.columns, "rows": view.cells.rows,
        "sides": [size.x * per_length, size.y * per_length], "length": length,
        "low": low / view.factor, "high": high / view.factor, "zero": scale.white_zero(),
        "palette": scale.palette() as usize, "quantity": words, "unit": unit_name,
        "per": per_unit * view.factor, "classes": picture.classes,
    });
    let plain = |v: f64| format!("{} {unit_name}", short(per_unit * v)).trim_end().to_owned();
    let of_cells = format!("{} columns and {} rows", view.cells.columns, view.cells.rows);
    let range = if picture.classes.is_empty() {
        format!(", from {} to {}", plain(least), plain(most))
    } else {
        String::new()
    };
    let alt = format!("{}, {}: {of_cells}{range}.", picture.title, picture.subtitle);
    let axis = |side: f64, edge: &str| axis_ticks(side, size.x.max(size.y), per_length, edge);
    let name = |axis: &str| html! { i { (axis) } @if !length.is_empty() { " (" (length) ")" } };
    let is_read = reading == Reading::Values;
    let data = is_read.then(|| data.to_string());
    Ok(html! {
        figure.field data-field=[data] {
            div.map {
                div.name aria-hidden="true" { (name("y")) }
                div.y aria-hidden="true" { (axis(size.y, "bottom")) }
                img src={ "data:image/png;base64," (STANDARD.encode(png)) } alt=(alt);
                div.x aria-hidden="true" { (axis(size.x, "left")) }
                div.name aria-hidden="true" { (name("x")) }
            }
            (colour_bar(&scale, picture.classes, (&unit_name, per_unit)))
            @if is_read {
                div.tools {
                    button type="button" aria-label={ "Enlarge: " (words) } { "+" }
                    button type="button" aria-label={ "Reduce: " (words) } { "-" }
                    button type="button" { "whole map" }
                }
            }
            figcaption {
                strong { (picture.title) } ", " (picture.subtitle)
                @if let Some(reduction) = view.reduction() { ". " (reduction) }
            }
            @if is_read {
                output aria-live="polite" {}
                (read_by_script(view))
            }
        }
    })
}

/// The picture file of a field, which has its title and its axes.
pub(crate) fn picture_file(picture: &FieldPicture<'_>, png: &[u8]) -> Markup {
    let alt = format!("{}, {}", picture.title, picture.subtitle);
    html! {
        figure.field {
            img src={ "data:image/png;base64," (STANDARD.encode(png)) } alt=(alt);
        }
    }
}

/// The numbers beside an axis of a map, placed from `edge`; `per_length` is the shown unit's in the scene's.
fn axis_ticks(side: f64, longest: f64, per_length: f64, edge: &str) -> Markup {
    let most = (TICKS[0] * (side / longest)).max(TICKS[1]);
    let side = side * per_length;
    html! {
        @for tick in ticks(side, most) {
            span style=(format!("{edge}:{:.3}%", 100.0 * (tick / side))) {
                (number(contact_model::units::rounded(tick, 12)))
            }
        }
    }
}

/// The colours of a map: from its lowest to its highest value in a unit, or one of each class.
fn colour_bar(scale: &ColourScale, classes: &[&str], (unit_name, per_unit): (&str, f64)) -> Markup {
    let end = |value: f64| html! { (short(per_unit * value)) " " (unit(unit_name)) };
    let (low, high) = scale.ends();
    let mut ramp = "linear-gradient(to right".to_owned();
    for [r, g, b] in scale.palette().colours().into_iter().step_by(17) {
        ramp += &format!(",rgb({r},{g},{b})");
    }
    let colour = |value: usize| {
        let [r, g, b] = scale.colour(value as f64);
        format!("background:rgb({r},{g},{b})")
    };
    html! {
        div.bar aria-hidden="true" {
            @if classes.is_empty() {
                span { (end(low)) } i style={ "background:" (ramp) ")" } {} span { (end(high)) }
            } @else {
                @for (value, words) in classes.iter().enumerate() {
                    b style=(colour(value)) {} span { (words) }
                }
            }
        }
    }
}

/// The values of a map and the places of their cells, which the page's script reads.
fn read_by_script(view: &FieldView) -> Markup {
    let values: Vec<u8> = view.values.iter().flat_map(|v| v.to_le_bytes()).collect();
    html! {
        script.values type="application/octet-stream" { (PreEscaped(STANDARD.encode(values))) }
        script.places type="application/octet-stream" {
            (PreEscaped(STANDARD.encode(view.places.as_flattened())))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_words_become_marks() {
        assert_eq!(unit("N/µm^2 x").into_string(), "N/µm<sup>2</sup> x");
        assert_eq!(unit("1/m").into_string(), "1/m");
        assert_eq!(words("a `b < c` d").into_string(), "a <code>b &lt; c</code> d");
    }

    #[test]
    fn ticks_are_few_and_round() {
        assert_eq!(ticks(12.0, 2.0), [0.0, 10.0]);
        assert_eq!(ticks(48.0, 6.0), [0.0, 10.0, 20.0, 30.0, 40.0]);
        assert_eq!(ticks(1.0, 6.0), [0.0, 0.2, 0.4, 3.0 * 0.2, 0.8, 1.0]);
        for i in 1..400 {
            let length = 1.037_f64.powi(i - 200);
            let found = ticks(length, 6.0);
            assert!(
                (3..=7).contains(&found.len()) && found.last().unwrap() <= &(length * 1.000_001),
                "{length}: {found:?}"
            );
        }
    }
}
