//! A page of HTML that needs no network and no other file: its frame, charts, fields and statistics.

use crate::scenes::read::{Result, human_readable};
use crate::scenes::run::{FieldView, shown_words};
use crate::scenes::tell::MapStatisticsTables;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use contact_model::Shown;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use plots::{Chart, FieldPicture, prefixed};
use std::path::{Path, PathBuf};

const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = include_str!("page/page.js");

/// How a field is read.
pub(crate) const READING: &str = "A click, or the arrow keys, read the value of a cell; a double click, + and - zoom, and so does the wheel with shift or control.";

/// Writes `report.html`: a heading, what stands below it, and sections of (id, name in the list, heading,
/// content).
pub(crate) fn write(
    out: &Path,
    title: &str,
    head: &Markup,
    sections: &[(&str, &str, &str, Markup)],
) -> Result<PathBuf> {
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
                    @for (id, name, ..) in sections { li { a href={ "#" (id) } { (name) } } }
                } }
                main { @for (id, _, heading, content) in sections { section id=(id) { h2 { (heading) } (content) } } }
                footer { p { "fractal-contact " (env!("CARGO_PKG_VERSION")) } }
                script id="palette" type="application/octet-stream" { (PreEscaped(STANDARD.encode(plots::viridis().as_flattened()))) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    let path = out.join("report.html");
    runs::files::write_whole(&path, page.into_string().as_bytes())?;
    Ok(path)
}

/// A chart as a picture that keeps its names to itself.
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
                    tr { th scope="row" { (symbol) } td { (value) } td { (interval) } td { (meaning) } }
                }
            }
        }
        @for note in &of.notes { p { "Not known: " (note) } }
        @for remark in &of.remarks { p { (remark) } }
    }
}

/// A field that is read by clicks and keys, with a picture in its place where no script runs.
///
/// # Errors
/// A picture that cannot be encoded.
pub(crate) fn field(picture: &FieldPicture<'_>, view: &FieldView) -> Result<Markup> {
    let [low, high] = view.ends().unwrap_or_default();
    let zero = picture.shown == Shown::Largest;
    let low_end = if zero { low.min(0.0) } else { low };
    let png = plots::encode_viridis(view.columns, &view.values, [low_end, high], zero)?;
    let size = picture.size;
    let (length, scale) = prefixed(picture.length_unit, size.x.max(size.y));
    let (unit, per_unit) = prefixed(picture.unit, f64::from(high.abs().max(low.abs())));
    let end =
        |v: f32| format!("{} {unit}", human_readable::short(per_unit * f64::from(v))).trim_end().to_owned();
    let words = picture.quantity.split('$').next().unwrap_or_default().trim();
    let shown = shown_words(picture.shown);
    let data = serde_json::json!({
        "across": view.columns, "down": view.rows, "block": view.block, "picked": shown,
        "dx": size.x / view.cells.columns as f64, "dy": size.y / view.cells.rows as f64,
        "low": low_end, "high": high, "zero": zero,
        "quantity": words, "unit": picture.unit, "length": length, "scale": scale,
    });
    let alt = format!(
        "{}, {}: {} columns and {} rows, from {} to {}.",
        picture.title,
        picture.subtitle,
        view.cells.columns,
        view.cells.rows,
        end(low),
        end(high)
    );
    let mut ramp = "linear-gradient(to right".to_owned();
    for [r, g, b] in plots::viridis().into_iter().step_by(17) {
        ramp += &format!(",rgb({r},{g},{b})");
    }
    Ok(html! {
        figure.field data-field=(data.to_string()) {
            img src={ "data:image/png;base64," (STANDARD.encode(png)) } alt=(alt);
            div.bar aria-hidden="true" { span { (end(low_end)) } i style={ "background:" (ramp) ")" } {} span { (end(high)) } }
            div.tools {
                button type="button" aria-label={ "Enlarge: " (words) } { "+" }
                button type="button" aria-label={ "Reduce: " (words) } { "-" }
                button type="button" { "whole map" }
            }
            figcaption {
                strong { (picture.title) } ", " (picture.subtitle)
                @for (value, words) in picture.classes.iter().enumerate() { (if value == 0 { "; " } else { ", " }) (value) " " (words) }
                @if view.block > 1 { "; each pixel is " (shown) " of " (view.block) " x " (view.block) " cells" }
            }
            output aria-live="polite" {}
            script.values type="application/octet-stream" {
                (PreEscaped(STANDARD.encode(view.values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())))
            }
            script.places type="application/octet-stream" {
                (PreEscaped(STANDARD.encode(view.places.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())))
            }
        }
    })
}
