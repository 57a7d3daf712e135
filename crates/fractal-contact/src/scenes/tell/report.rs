//! `report.html`: a run in one page, which needs no network and no other file.

use crate::scenes::plan::{Cost, Plan};
use crate::scenes::read::{HEIGHTS, Result, SceneFile, System, human_readable, number, words};
use crate::scenes::run::{FieldFile, FieldView, SceneOutcome, SolvedUnit, field_pictures};
use crate::scenes::tell::{MapStatisticsTables, Mean, columns, distributions, page, pictures, summary};
use analysis::Value;
use contact_model::FieldQuantity;
use contact_model::quantities::{Quantity, Role};
use maud::{Markup, PreEscaped, html};
use plots::{Chart, Curve};
use runs::amounts::{memory, time};
use std::path::{Path, PathBuf};

/// Bytes that the fields of a page may take: it stays below 5 MB.
const MOST_BYTES: usize = 4_000_000;

/// What a page is made of.
pub(crate) struct Report<'a> {
    pub scene: &'a SceneFile,
    pub plan: &'a Plan,
    pub outcome: &'a SceneOutcome,
    pub means: &'a [Mean],
    pub units: &'a [SolvedUnit<'a>],
    pub statistics: Option<&'a MapStatisticsTables>,
}

impl Report<'_> {
    /// Writes the page.
    ///
    /// # Errors
    /// Pictures that cannot be encoded, and a file that cannot be written.
    pub fn write(&self, out: &Path) -> Result<PathBuf> {
        let name = words::scene_name(self.scene);
        let (curves, fields, distributions) = (self.curves()?, self.fields(out)?, self.distributions()?);
        let spectrum = self.spectrum()?;
        let head = html! {
            @if !self.plan.shows.is_empty() { p.lead { (self.plan.shows) } }
            (self.verdict())
        };
        let results = html! { (self.states()) div.charts { (curves) } (distributions) };
        let surface = html! { (self.surface()) (spectrum) };
        let scene = html! { pre { (self.scene.text) } };
        let sections = [
            ("results", "Results", "Results", results),
            ("fields", "Map, pressure and gap", "Map, pressure and gap", fields),
            ("surface", "Surface", "The surface, as it was understood", surface),
            ("certificates", "How sure", "How sure the solutions are", self.certificates()),
            ("effects", "Effects", "Effects and outputs", self.effects()),
            ("work", "Work and time", "Work and time", self.work()),
            ("cite", "Sources", "Sources to cite", self.sources()),
            ("scene", "Scene", "The scene", scene),
        ];
        page::write(out, &name, &head, &sections)
    }

    fn verdict(&self) -> Markup {
        let SceneOutcome { requested, states, failed, stopped, .. } = *self.outcome;
        let rest = requested - states;
        let fine = failed == 0 && rest == 0;
        html! {
            p.verdict.warned[!fine] {
                @if fine { "All " (states) " states asked for were answered and are certified." }
                @else { (states) " of " (requested) " states were attempted; " (failed) " of them were refused or missed their tolerance." }
                @if stopped { " The run was stopped before its end." }
            }
            @if !self.outcome.notes.is_empty() || !self.plan.notes.is_empty() {
                div.verdict.warned {
                    strong { "To beware of" }
                    ul {
                        @for note in &self.plan.notes { li { (note.message()) @if let Some(help) = note.help() { ": " (help) } } }
                        @for note in &self.outcome.notes { li { (note) } }
                    }
                }
            }
        }
    }

    fn states(&self) -> Markup {
        html! {
            @for model in summary::of_models(self.scene, self.units, self.means) {
                div.scroll tabindex="0" role="region" aria-label={ "States of " (words::model_name(model.name)) } {
                    table {
                        caption {
                            (words::model_name(model.name))
                            @if !self.means.is_empty() { ": means over surfaces (standard error)" }
                            @if model.left_out > 0 { ": " (model.left_out) " more states are in results.csv" }
                        }
                        @for (i, line) in model.lines.iter().enumerate() {
                            tr { @for cell in line { @if i == 0 { th scope="col" { (cell.replace('_', " ")) } } @else { td { (cell) } } } }
                        }
                    }
                }
                @for line in &model.of_paths { p { (line.replace('_', " ")) "." } }
            }
            p { "All columns, with their meaning and unit, are in results.csv." }
        }
    }

    fn curves(&self) -> Result<Markup> {
        page::figures(pictures::charts(self.scene, self.units, self.means).iter().map(|(_, chart)| chart))
    }

    fn distributions(&self) -> Result<Markup> {
        let asked = &self.scene.requested.distributions;
        let charts = asked.iter().filter_map(|&of| distributions::chart(self.scene, of, self.units));
        let charts: Vec<Chart> = charts.collect();
        let drawn = page::figures(&charts)?;
        Ok(html! { @if !charts.is_empty() { h3 { "Distributions" } div.charts { (drawn) } } })
    }

    fn spectrum(&self) -> Result<Markup> {
        if let Some(statistics) = self.statistics {
            let charts = statistics.charts(&words::scene_name(self.scene));
            let drawn = page::figures(charts.iter().map(|(_, chart)| chart))?;
            return Ok(html! { h3 { "Statistics" } (page::statistics(statistics)) div.charts { (drawn) } });
        }
        let Some(map) = self.plan.prepared.as_ref().filter(|map| map.spectrum.len() > 1) else {
            return Ok(html! {});
        };
        let [m, m4] = if self.scene.system == System::Si { [" (1/m)", " ($\\rm{m^4}$)"] } else { [""; 2] };
        let spectrum = Chart {
            title: "Power spectral density".into(),
            subtitle: "averaged over rings of the wavenumber, two-sided".into(),
            x_label: format!("wavenumber $q${m}"),
            y_label: format!("$C${m4}"),
            curves: vec![Curve { label: "as solved".into(), points: map.spectrum.clone(), band: Vec::new() }],
            logarithmic: true,
        };
        Ok(html! { div.charts { (page::chart(&spectrum)?) } })
    }

    fn surface(&self) -> Markup {
        html! {
            p { (self.plan.surface) }
            @if let Some(told) = &self.plan.metadata { h3 { "What the file says, and what was done to it" } pre { (told) } }
            @if let Some(map) = self.plan.as_solved() { h3 { "As solved" } pre { (map) } }
            p { "Modulus E*: " (number(self.plan.modulus)) "; units: " (self.plan.units) "." }
        }
    }

    /// The largest of each residual over all states, with what it means.
    fn certificates(&self) -> Markup {
        let largest = |quantity: &Quantity| {
            let records = self.units.iter().flat_map(|unit| unit.states);
            let values = records.filter_map(|record| match columns::value(record, quantity) {
                Value::Number(v) => Some(v),
                _ => None,
            });
            values.reduce(f64::max)
        };
        let proves = |quantity: &'static Quantity| match quantity.role {
            Role::Residual(proves) => Some((quantity.name, proves, largest(quantity)?)),
            _ => None,
        };
        let found: Vec<(&str, &str, f64)> = residuals(self.scene).filter_map(proves).collect();
        html! {
            @if found.is_empty() {
                p { "No model here has a residual: the formulas are exact for what they assume." }
            } @else {
                p { "A certificate proves that the equations on the cells were solved. It says nothing of the cells themselves, of the \
                     heights, or of the assumptions: a linear elastic half-space, small slopes." }
                div.scroll { table.words {
                    caption { "The largest over all states" }
                    tr { th scope="col" { "residual" } th scope="col" { "largest" } th scope="col" { "what it proves" } }
                    @for (name, words, value) in found { tr { td { (name.replace('_', " ")) } td { (human_readable::short(value)) } td { (words) } } }
                } }
            }
            @for model in &self.plan.models {
                p { strong { (words::model_name(model.name)) } ", " (model.grid) ": " (model.accuracy) "." }
            }
        }
    }

    fn effects(&self) -> Markup {
        let names = |requested: bool| {
            let of: Vec<&str> =
                self.plan.outputs.iter().filter(|(_, r)| *r == requested).map(|(n, _)| *n).collect();
            if of.is_empty() { "none".to_owned() } else { of.join(", ").replace('_', " ") }
        };
        html! {
            div.scroll { table.words {
                tr { th scope="col" { "effect" } th scope="col" { "" } th scope="col" { "why" } }
                @for e in &self.plan.effects { tr { td { (e.name) } td { @if e.on { "on" } @else { "off" } } td { (e.reason) } } }
            } }
            p { "Computed: " (names(true)) ". Not asked for, so neither computed nor stored: " (names(false)) "." }
        }
    }

    fn work(&self) -> Markup {
        let row = |name: &str, what: &str, cost: &Cost| {
            html! { tr {
                td { (name) } td { (what) } td { (time(cost.seconds)) } td { (number(cost.applications.round())) }
                td { (number(cost.linear_solves.round())) }
                td { (number(cost.fields.round())) @if cost.field_bytes > 0.0 { " (" (memory(cost.field_bytes)) ")" } }
            } }
        };
        html! {
            div.scroll { table {
                caption { "Time of one thread; earlier runs included" }
                tr { @for h in ["model", "", "time", "operator applications", "linear solves", "fields"] { th scope="col" { (h) } } }
                @for (planned, (name, actual, _)) in self.plan.models.iter().zip(&self.outcome.actual) {
                    @if let Some(cost) = &planned.predicted { (row(words::model_name(name), "planned", cost)) }
                    (row(words::model_name(name), "actual", actual))
                }
            } }
            p {
                "The run took " (time(self.outcome.seconds)) @if self.outcome.kept > 0 { "; " (self.outcome.kept) " states were kept from an earlier one" }
                @if let Some(bytes) = self.outcome.peak_memory { "; " (memory(bytes as f64)) " of memory at the peak" } "."
            }
        }
    }

    fn sources(&self) -> Markup {
        html! { ul {
            @for model in &self.scene.models { @for source in model.model().sources() {
                li { (source.citation) ": " (source.what) " (" (words::model_name(model.name())) ")" }
            } }
        } }
    }

    /// The map and the fields of the first surface as long as there is room: of the largest loads first, or
    /// of steps spread over a path.
    fn fields(&self, out: &Path) -> Result<Markup> {
        let mut views: Vec<(FieldView, &'static FieldQuantity, &str, usize)> = Vec::new();
        for &SolvedUnit { model, surface, states } in self.units.iter().filter(|of| of.surface == 0) {
            let order = if self.scene.is_history() {
                spread(states.len())
            } else {
                (0..states.len()).rev().collect()
            };
            for state in order.into_iter().map(|i| &states[i]) {
                views.extend(self.scene.requested.fields().filter_map(|(field, _)| {
                    let file =
                        FieldFile { field: field.name, model, surface, state: state.index, extension: "" };
                    Some((field_pictures::view(out, file)?, field, model, state.index))
                }));
            }
        }
        let of_surface = |view: &(_, &FieldQuantity, _, _)| view.1.name == HEIGHTS.name;
        if let (Some(map), false) = (self.scene.surface.given_map(), views.iter().any(of_surface)) {
            let model = self.scene.models.first().map_or("", |model| model.name());
            views.insert(0, (FieldView::new(HEIGHTS.shown, map.cells(), map.heights()), &HEIGHTS, model, 0));
        }
        // The map first.
        views.sort_by_key(|view| !of_surface(view));
        let count = views.len();
        let mut drawn = Vec::new();
        let mut bytes = 0;
        for view in &views {
            let (view, field, model, state) = view;
            let picture = field_pictures::picture(self.scene, field, model, (0, *state), view.cells, &[]);
            let figure = if self.scene.surface.is_profile() {
                page::chart(&field_pictures::row_chart(&picture, view.row(self.scene.surface.size().x)))?
            } else {
                page::field(&picture, view)?
            };
            let figure = figure.into_string();
            bytes += figure.len();
            if bytes > MOST_BYTES {
                break;
            }
            drawn.push((*state, figure));
        }
        if self.scene.is_history() {
            drawn.sort_by_key(|(state, _)| *state);
        }
        let which =
            if self.scene.is_history() { "spread over the path" } else { "those of the largest loads" };
        Ok(html! {
            @if drawn.is_empty() {
                p { "No field was asked for: name `pressure`, `gap` or `heights` in [outputs]." }
            } @else {
                p { @if !self.scene.surface.is_profile() { (page::READING) } @if drawn.len() < count { " " (drawn.len()) " of " (count) " fields are shown, " (which) "; the \
                     others are files beside this page." } }
                div.fields { @for (_, figure) in &drawn { (PreEscaped(figure)) } }
            }
        })
    }
}

/// The residuals that a scene has.
pub(crate) fn residuals(scene: &SceneFile) -> impl Iterator<Item = &'static Quantity> + '_ {
    columns::asked(scene).filter(|quantity| matches!(quantity.role, Role::Residual(_)))
}

/// The numbers below `count` in an order whose beginnings are spread over all of them: strides of falling
/// powers of 2.
fn spread(count: usize) -> Vec<usize> {
    let mut order = Vec::with_capacity(count);
    let mut stride = count.next_power_of_two();
    while stride > 0 {
        // Multiples of twice the stride are there.
        let fresh = (0..count).step_by(stride).filter(|i| order.is_empty() || i % (2 * stride) != 0);
        let fresh: Vec<usize> = fresh.collect();
        order.extend(fresh);
        stride /= 2;
    }
    order
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn beginnings_of_an_order_are_spread() {
        assert_eq!(spread(0), [0usize; 0]);
        assert_eq!(spread(1), [0]);
        assert_eq!(spread(7), [0, 4, 2, 6, 1, 3, 5]);
        let mut order = spread(61);
        order.sort_unstable();
        assert_eq!(order, (0..61).collect::<Vec<_>>());
    }
}
