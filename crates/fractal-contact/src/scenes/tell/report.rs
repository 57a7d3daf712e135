//! `report.html`: a run in one page, which needs no network and no other file.

use crate::scenes::plan::{Cost, Plan, PredictedFrom};
use crate::scenes::read::{FLUX, HEIGHTS, Result, STRESS_SECTION, SceneFile, number, short, words};
use crate::scenes::run::field_pictures::FieldOfState;
use crate::scenes::run::{FieldFile, FieldView, SceneOutcome, SolvedUnit, StateRecord, field_pictures};
use crate::scenes::tell::page::{PageSection, Reading, ReportPage};
use crate::scenes::tell::{MapStatisticsTables, StateTable, columns, distributions, page, pictures, summary};
use contact_model::Value;
use contact_model::quantities::{Role, StateQuantity};
use contact_model::{Boundary, FieldQuantity};
use maud::{Markup, PreEscaped, html};
use plots::{Chart, Curve, FieldPicture};
use runs::amounts::{memory, time};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Bytes that the fields of a page may take: five to thirty of 512 x 512 cells.
const MOST_BYTES: usize = 12_000_000;

/// What a page is made of.
pub(crate) struct Report<'a> {
    pub states: &'a StateTable<'a>,
    pub plan: &'a Plan,
    pub outcome: &'a SceneOutcome,
    pub statistics: Option<&'a MapStatisticsTables>,
    /// What is shown of a field, where it is known.
    pub view: &'a dyn Fn(FieldFile<'_>) -> Option<FieldView>,
    /// The picture of a field as a PNG, where it is drawn.
    pub drawn: &'a dyn Fn(FieldFile<'_>) -> Option<Arc<[u8]>>,
}

impl Report<'_> {
    /// The numbers of a single state and its fields, as HTML.
    ///
    /// # Errors
    /// Pictures that cannot be encoded.
    pub fn of_one_state(&self) -> Result<String> {
        let fields = self.fields()?;
        Ok(html! { (self.tables()) (fields) }.into_string())
    }

    /// The page.
    ///
    /// # Errors
    /// Pictures that cannot be encoded.
    pub fn page(&self) -> Result<ReportPage> {
        let name = words::scene_name(self.scene());
        let (curves, fields, distributions) = (self.curves()?, self.fields()?, self.distributions()?);
        let spectrum = self.spectrum()?;
        let head = html! {
            p { (boundary(self.plan.boundary)) }
            @if !self.plan.shows.is_empty() { p.lead { (page::words(&self.plan.shows)) } }
            (self.verdict())
        };
        let first = self.first_map()?;
        let results = html! {
            div.first { div { (self.tables()) } @if let Some(map) = first { (map) } }
            (self.warnings()) div.charts { (curves) } (distributions)
        };
        let surface = html! { (self.surface()) (spectrum) };
        let scene = html! { pre { (self.scene().text) } };
        let section = |id, name, heading, content| PageSection { id, name, heading, content };
        let sections = vec![
            section("results", "Results", "Results", results),
            section("fields", "Map, pressure and gap", "Map, pressure and gap", fields),
            section("surface", "Surface", "The surface, as it was understood", surface),
            section("certificates", "How sure", "How sure the solutions are", self.certificates()),
            section("effects", "Effects", "Effects and outputs", self.effects()),
            section("work", "Work and time", "Work and time", self.work()),
            section("cite", "Sources", "Sources to cite", self.sources()),
            section("scene", "Scene", "The scene", scene),
        ];
        Ok(ReportPage { title: name, head, sections })
    }

    fn scene(&self) -> &SceneFile {
        self.states.scene
    }

    fn verdict(&self) -> Markup {
        let SceneOutcome { requested, states, failed, pulled_off, stopped, .. } = *self.outcome;
        let rest = requested - states;
        let fine = failed == 0 && rest == 0 && pulled_off == 0;
        let warnings = self.outcome.notes.len() + self.plan.notes.len();
        html! {
            p.verdict.warned[!fine] {
                @if fine && states == 1 { "The requested state was solved and is certified." }
                @else if fine { "All " (states) " requested states were solved and are certified." }
                @else {
                    (states) " of " (requested) " states were attempted"
                    @if failed > 0 { "; " (failed) " of them " (if failed == 1 { "was" } else { "were" }) " refused or missed the tolerance" }
                    "."
                    @if pulled_off > 0 { " A path ends where the bodies come apart, and its last row is the last stable state." }
                }
                @if stopped { " The run was stopped before its end." }
                @if warnings > 0 { " " a href="#beware" { (warnings) @if warnings == 1 { " thing" } @else { " things" } " to beware of" } "." }
            }
        }
    }

    /// Below the numbers that they are about.
    fn warnings(&self) -> Markup {
        html! {
            @if !self.outcome.notes.is_empty() || !self.plan.notes.is_empty() {
                div.verdict.warned id="beware" {
                    strong { "To beware of" }
                    ul {
                        @for note in &self.plan.notes { li { (page::words(note.message())) @if let Some(help) = note.help() { ". " (page::words(&sentence(help))) } } }
                        @for note in &self.outcome.notes { li { (page::words(note)) } }
                    }
                }
            }
        }
    }

    fn tables(&self) -> Markup {
        html! {
            @for model in summary::of_models(self.states) {
                div.scroll tabindex="0" role="region" aria-label={ "States of " (words::model_name(model.name)) } {
                    @let short = summary::is_short(model.heads.len(), model.rows.len());
                    table.short[short] {
                        caption { span {
                            (words::model_name(model.name))
                            @if !model.of_surfaces.is_empty() { ": " (model.of_surfaces) }
                            @if model.left_out > 0 { "; " (model.left_out) " more states are in results.csv" }
                        } }
                        @if short { (below_each_other(&model)) } @else { (in_rows(&model)) }
                    }
                }
                @if !model.same.is_empty() { p { "In all states: " (page::unit(&model.same.join(", ").replace('_', " "))) "." } }
                @if !model.errors.is_empty() { p { (page::words(model.errors)) } }
                @for line in &model.of_paths { p { (page::unit(&line.replace('_', " "))) "." } }
            }
            p { "All columns, with their meaning and in plain SI, are in results.csv." }
        }
    }

    fn curves(&self) -> Result<Markup> {
        page::figures(pictures::charts(self.states).iter().map(|(_, chart)| chart))
    }

    fn distributions(&self) -> Result<Markup> {
        let asked = &self.scene().requested.distributions;
        let charts = asked.iter().filter_map(|&of| distributions::chart(self.states, of));
        let charts: Vec<Chart> = charts.collect();
        let drawn = page::figures(&charts)?;
        Ok(html! { @if !charts.is_empty() { h3 { "Distributions" } div.charts { (drawn) } } })
    }

    fn spectrum(&self) -> Result<Markup> {
        if let Some(statistics) = self.statistics {
            let charts = statistics.charts(&words::scene_name(self.scene()));
            let drawn = page::figures(charts.iter().map(|(_, chart)| chart))?;
            return Ok(html! { h3 { "Statistics" } (page::statistics(statistics)) div.charts { (drawn) } });
        }
        let Some(map) = self.plan.prepared.as_ref().filter(|map| map.spectrum.len() > 1) else {
            return Ok(html! {});
        };
        let spectrum = Chart {
            title: "Power spectral density".into(),
            subtitle: "averaged over rings of the wavenumber, two-sided".into(),
            x_label: "wavenumber $q$".into(),
            y_label: "$C$".into(),
            curves: vec![Curve {
                label: "as solved".into(),
                points: map.spectrum.clone(),
                ..Curve::default()
            }],
            logarithmic: true,
            ..Chart::default()
        };
        let spectrum = spectrum.in_units(["1/m", "m^4"].map(|unit| self.scene().system.shown(unit)));
        Ok(html! { div.charts { (page::chart(&spectrum)?) } })
    }

    fn surface(&self) -> Markup {
        html! {
            p { (self.plan.surface) }
            @if let Some(told) = &self.plan.metadata { h3 { "What the file says, and what was done to it" } pre { (told) } }
            @if let Some(map) = self.plan.as_solved() { h3 { "As solved" } pre { (map) } }
            p { (self.plan.contact_modulus) ". Units: " (self.plan.units()) "." }
        }
    }

    /// The largest of each residual over all states, with what it means.
    fn certificates(&self) -> Markup {
        let largest = |quantity: &StateQuantity| {
            let records = self.states.units.iter().flat_map(|unit| unit.states);
            let values = records.filter_map(|record| match columns::value(record, quantity) {
                Value::Number(v) => Some(v),
                _ => None,
            });
            values.reduce(f64::max)
        };
        let proves = |quantity: &'static StateQuantity| match quantity.role {
            Role::Residual(proves) => Some((quantity.name, proves, largest(quantity)?)),
            _ => None,
        };
        let found: Vec<(&str, &str, f64)> = residuals(self.scene()).filter_map(proves).collect();
        html! {
            @if found.is_empty() {
                p { "No model here has a residual: the formulas are exact for what they assume." }
            } @else {
                p { "A certificate proves that the equations on the cells were solved. It says nothing of the cells themselves, of the \
                     heights, or of the assumptions: a linear elastic half-space, small slopes." }
                div.scroll { table.words {
                    caption { "The largest over all states" }
                    tr { th scope="col" { "residual" } th scope="col" { "largest" } th scope="col" { "what it proves" } }
                    @for (name, words, value) in found { tr { td { (name.replace('_', " ")) } td { (short(value)) } td { (words) } } }
                } }
            }
            @for model in &self.plan.models {
                p { strong { (words::model_name(model.name)) } ", " (model.grid) ": " (page::words(&model.accuracy)) "." }
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
                @for e in &self.plan.effects { tr { td { (e.name) } td { @if e.on { "on" } @else { "off" } } td { (page::words(&e.reason)) } } }
            } }
            p { "Computed: " (names(true)) ". Not requested, so neither computed nor stored: " (names(false)) "." }
        }
    }

    fn work(&self) -> Markup {
        let row = |name: &str, what: &str, cost: &Cost, counted: bool| {
            let count = |of: f64| if counted { number(of.round()) } else { "-".to_owned() };
            html! { tr {
                td { (name) } td { (what) } td { (time(cost.seconds)) } td { (count(cost.applications)) }
                td { (count(cost.linear_solves)) }
                td { (number(cost.fields.round())) @if cost.field_bytes > 0.0 { " (" (memory(cost.field_bytes)) ")" } }
            } }
        };
        let counted = self.plan.predicted_from != Some(PredictedFrom::Sizes);
        html! {
            div.scroll { table {
                caption { "Time of one thread; earlier runs included" }
                tr { @for h in ["model", "", "time", "operator applications", "linear solves", "fields"] { th scope="col" { (h) } } }
                @for (planned, (name, actual, _)) in self.plan.models.iter().zip(&self.outcome.actual) {
                    @if let Some(cost) = &planned.predicted { (row(words::model_name(name), "planned", cost, counted)) }
                    (row(words::model_name(name), "actual", actual, true))
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
            @for (_, by, source) in columns::sources(self.scene()) {
                li { (source.citation) ": " (source.what) " (" (words::model_name(by)) ")" }
            }
        } }
    }

    /// The map and the fields of the first surface as long as there is room: of the largest loads first, or
    /// of steps spread over a path; shown in the order of the loads, each quantity in one scale.
    /// Stick and slip or the pressure, beside the numbers, because people look before they read: under the largest load,
    /// or at the last step of a path in contact.
    fn first_map(&self) -> Result<Option<Markup>> {
        if self.scene().surface.is_profile() {
            return Ok(None);
        }
        let views = self.views();
        let of_field = |name: &str| {
            let mut of = views.iter().filter(|view| view.field.name == name && !view.is_zero());
            if self.scene().is_history() {
                of.max_by_key(|view| view.state.map(|state| state.index))
            } else {
                of.next()
            }
        };
        let Some(view) = of_field("stick_slip").or_else(|| of_field("pressure")) else { return Ok(None) };
        let range = ranges(&views).get(&(view.field.name, view.model)).copied();
        page::field(&self.picture(view, range), &view.shown, Reading::PictureAlone).map(Some)
    }

    fn fields(&self) -> Result<Markup> {
        let views = self.views();
        let ranges = ranges(&views);
        let mut drawn = Vec::new();
        let (mut bytes, mut zeros) = (0, 0);
        for view in &views {
            if view.is_zero() {
                zeros += 1;
                continue;
            }
            let figure = self.figure(view, ranges.get(&(view.field.name, view.model)).copied())?;
            bytes += figure.len();
            if bytes > MOST_BYTES {
                break;
            }
            drawn.push((view.is_surface(), view.state, figure));
        }
        let order = |(surface, state, _): &(bool, Option<&StateRecord>, String)| {
            (!surface, state.map_or(0.0, |state| self.load(state)))
        };
        drawn.sort_by(|a, b| {
            let (a, b) = (order(a), order(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        // The fields of one state stand on one row.
        let index = |state: Option<&StateRecord>| state.map(|state| state.index);
        let which =
            if self.scene().is_history() { "spread over the path" } else { "those of the largest loads" };
        Ok(html! {
            @if drawn.is_empty() {
                p { "No field was requested: name " code { "pressure" } ", " code { "gap" } " or " code { "heights" } " in [outputs]." }
            } @else {
                p {
                    @if !self.scene().surface.is_profile() { (page::READING) }
                    @if views.len() > 2 { " Each quantity has one scale." }
                    @if zeros > 0 { " Fields that are zero everywhere are not drawn." }
                    @if drawn.len() + zeros < views.len() { " " (drawn.len()) " of " (views.len()) " fields are shown, " (which) "; the others are files beside this page." }
                }
                @for of_state in drawn.chunk_by(|a, b| a.0 == b.0 && index(a.1) == index(b.1)) {
                    @let (is_surface, state, _) = &of_state[0];
                    @let state = state.filter(|_| !is_surface).map(|state| state.words(self.scene()));
                    div.fields data-state=[state] { @for (_, _, figure) in of_state { (PreEscaped(figure)) } }
                }
            }
        })
    }

    /// The fields of the first surface that were kept for the page, the map before all others.
    fn views(&self) -> Vec<View<'_>> {
        let mut views: Vec<View<'_>> = Vec::new();
        for &SolvedUnit { model, surface, states, .. } in
            self.states.units.iter().filter(|of| of.surface == 0)
        {
            for state in self.by_importance(states) {
                views.extend(self.scene().requested.fields().filter_map(|(field, _)| {
                    let file =
                        FieldFile { field: field.name, model, surface, state: state.index, extension: "" };
                    let view = View { shown: (self.view)(file)?, field, model, state: Some(state) };
                    // Its rows are depths, for which the page has no axis of its own.
                    (field.name != STRESS_SECTION.name || self.picture_file(&view).is_some()).then_some(view)
                }));
            }
        }
        if let (Some(map), false) = (self.scene().surface.given_map(), views.iter().any(View::is_surface)) {
            let model = self.scene().models.first().map_or("", |model| model.name());
            let shown = FieldView::new(map.cells(), map.heights());
            views.insert(0, View { shown, field: &HEIGHTS, model, state: None });
        }
        views.sort_by_key(|view| !view.is_surface());
        views
    }

    fn picture<'b>(&self, view: &'b View<'_>, range: Option<(f64, f64)>) -> FieldPicture<'b> {
        let View { shown, field, model, state } = view;
        let of_state = FieldOfState { field, model, surface: 0, state: *state };
        FieldPicture { range, ..field_pictures::picture(self.scene(), &of_state, shown.cells, &[]) }
    }

    /// The picture file of a field whose lines or whose depths only that shows.
    fn picture_file(&self, view: &View<'_>) -> Option<Arc<[u8]>> {
        let &View { field, model, state, .. } = view;
        let is_shown = [FLUX.name, STRESS_SECTION.name].contains(&field.name);
        let file = FieldFile { field: field.name, model, surface: 0, state: state?.index, extension: "png" };
        if is_shown { (self.drawn)(file) } else { None }
    }

    /// A field with its axes, or the curve of a profile.
    fn figure(&self, view: &View<'_>, range: Option<(f64, f64)>) -> Result<String> {
        let mut picture = self.picture(view, range);
        let shown = &view.shown;
        let figure = if self.scene().surface.is_profile() {
            picture.subtitle += &shown.reduction().map_or_else(String::new, |said| format!("; {said}"));
            page::chart(&field_pictures::row_chart(&picture, shown.row(self.scene().surface.size().x)))?
        } else if let Some(png) = self.picture_file(view) {
            page::picture_file(&picture, &png)
        } else {
            page::field(&picture, shown, Reading::Values)?
        };
        Ok(figure.into_string())
    }

    /// What states are sorted by: the load that is prescribed, along a path the step.
    fn load(&self, state: &StateRecord) -> f64 {
        self.scene().request.prescribed(state.index).unwrap_or(state.index as f64)
    }

    /// States in the order in which their fields are given room.
    fn by_importance<'b>(&self, states: &'b [StateRecord]) -> Vec<&'b StateRecord> {
        if self.scene().is_history() {
            return spread(states.len()).into_iter().map(|i| &states[i]).collect();
        }
        let mut sorted: Vec<&StateRecord> = states.iter().collect();
        sorted.sort_by(|a, b| self.load(b).total_cmp(&self.load(a)));
        sorted
    }
}

/// A text that begins like a sentence.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// What lies outside of the rectangle, and what that means.
fn boundary(boundary: Boundary) -> &'static str {
    match boundary {
        Boundary::Periodic => {
            "The boundary is periodic: the surface is one tile of an endless surface, and its copies carry load too."
        }
        Boundary::PeriodicAlongX => {
            "The boundary is periodic along x: the surface goes on along a line. Beyond its edges along y nothing carries load."
        }
        Boundary::PeriodicAlongY => {
            "The boundary is periodic along y: the surface goes on along a line. Beyond its edges along x nothing carries load."
        }
        _ => {
            "The boundary is free: the surface is pressed by itself, and nothing outside of its rectangle carries load."
        }
    }
}

/// What is shown of a field of a state.
struct View<'a> {
    shown: FieldView,
    field: &'static FieldQuantity,
    model: &'a str,
    /// None of the surface.
    state: Option<&'a StateRecord>,
}

impl View<'_> {
    fn is_surface(&self) -> bool {
        self.field.name == HEIGHTS.name
    }

    /// A traction before anything was moved, for example.
    fn is_zero(&self) -> bool {
        !self.is_surface() && self.shown.ends == Some((0.0, 0.0))
    }
}

/// The smallest and the largest value of each quantity in all states of a model.
fn ranges<'a>(views: &[View<'a>]) -> BTreeMap<(&'static str, &'a str), (f64, f64)> {
    let mut ranges = BTreeMap::new();
    for View { shown, field, model, .. } in views {
        let Some((low, high)) = shown.ends else { continue };
        let range = ranges.entry((field.name, *model)).or_insert((low, high));
        *range = (low.min(range.0), high.max(range.1));
    }
    ranges
}

fn head(head: &summary::Head) -> Markup {
    html! { (head.name.replace('_', " ")) @if !head.unit.is_empty() { " " span.unit { "(" (page::unit(&head.unit)) ")" } } }
}

/// A row for each state.
fn in_rows(model: &summary::ModelStates) -> Markup {
    html! {
        thead { tr { @for name in &model.heads { th scope="col" { (head(name)) } } } }
        tbody { @for row in &model.rows { tr {
            @for (i, cell) in row.iter().enumerate() { @if i == 0 { th scope="row" { (cell) } } @else { td { (cell) } } }
        } } }
    }
}

/// A row for each quantity, a column for each of a few states.
fn below_each_other(model: &summary::ModelStates) -> Markup {
    html! {
        @for (i, name) in model.heads.iter().enumerate() {
            @let cells = html! { th scope="row" { (head(name)) } @for row in &model.rows { td { (row[i]) } } };
            tr { (cells) }
        }
    }
}

/// The residuals that a scene has.
pub(crate) fn residuals(scene: &SceneFile) -> impl Iterator<Item = &'static StateQuantity> + '_ {
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
