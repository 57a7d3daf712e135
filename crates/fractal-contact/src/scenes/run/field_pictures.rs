//! Pictures of fields. They are drawn last, when the range over all loads is known, so that all pictures of a
//! surface have one scale.

use crate::scenes::read::{
    FLUID_PRESSURE, FLUX, FieldFormat, HEIGHTS, Result, STRESS_SECTION, SceneFile, words,
};
use crate::scenes::run::{FieldFile, FieldView, Folder, ModelResult, StateRecord, StoredFile};

use contact_model::{Cells, Field, FieldQuantity, PathState, Size};
use interface::{FlowAxis, StreamFunction, stream_function};
use plots::{Chart, Curve, FieldPicture, contour_lines};
use std::borrow::Cow;
use std::path::Path;

/// The folder in which values are kept until they are drawn, beside the stored results.
const WAITING: &str = ".units/";
const EXTENSION: &str = "f64";
/// Ending of the files with the values that the report shows.
const VIEW: &str = "view";
/// The field that says where there is contact.
const PRESSURE: &str = "pressure";

/// Lines of a flow, and marked points, (x, y) in the unit of the map.
type FlowLines = (Vec<Vec<[f64; 2]>>, Vec<[f64; 2]>);

/// Lines of a flow: the same amount passes between any two of them.
const FLOW_LINES: usize = 12;

/// Whether a file of this name is for the program's own use only.
pub(crate) fn is_hidden(name: &str) -> bool {
    name.starts_with(WAITING)
}

/// Whether a field of this name is drawn, or needed for drawing another one: contacts are outlined.
pub(crate) fn is_needed(scene: &SceneFile, name: &str) -> bool {
    let drawn = scene.requested.fields().filter(|(_, formats)| formats.contains(&FieldFormat::Png));
    let mut fields = drawn.map(|(field, _)| field);
    fields.any(|field| field.name == name || name == PRESSURE && field.outlined)
}

/// The values of a field that are shown: its own, or the magnitude of its components.
pub(crate) fn magnitude<'a>(components: &[Cow<'a, [f64]>]) -> Cow<'a, [f64]> {
    match components {
        [values] => values.clone(),
        [along_x, along_y, ..] => along_x.iter().zip(along_y.iter()).map(|(x, y)| x.hypot(*y)).collect(),
        [] => Cow::Borrowed(&[]),
    }
}

/// Keeps the values of a field, little-endian, row-major, one component after the other, until it is drawn.
pub(crate) fn keep(folder: &Folder, file: FieldFile<'_>, values: &[f64]) -> Result<StoredFile> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    folder.keep(waiting(FieldFile { extension: EXTENSION, ..file }), &bytes)
}

/// Keeps the values of a field that the report shows.
pub(crate) fn keep_view(folder: &Folder, file: FieldFile<'_>, view: &FieldView) -> Result<StoredFile> {
    folder.keep(waiting(FieldFile { extension: VIEW, ..file }), &view.encode())
}

/// The values of a state that [`keep_view`] kept.
pub(crate) fn view(folder: &Folder, file: FieldFile<'_>) -> Option<FieldView> {
    FieldView::decode(&folder.read(&waiting(FieldFile { extension: VIEW, ..file }))?)
}

/// The name of a file that waits to be drawn or shown.
fn waiting(file: FieldFile<'_>) -> String {
    format!("{WAITING}{file}")
}

/// Draws the fields of all states, each quantity in one range. Once a result is complete it does not name the
/// values kept for drawing any more; the names of their files are returned, to be removed when the result is stored.
/// `drew` is called after each picture.
pub(crate) fn draw(of: FieldPictures<'_>, result: &mut ModelResult, drew: &dyn Fn()) -> Result<Vec<String>> {
    let drawn = of.scene.requested.fields().filter(|(_, formats)| formats.contains(&FieldFormat::Png));
    for (field, _) in drawn {
        let states: Vec<usize> = result.states.iter().map(|state| state.index).collect();
        let read = |&state: &usize| of.read(field.name, state, field.components);
        let ends = states.iter().filter_map(|state| Some(FieldPicture::ends(&magnitude(&read(state)?))));
        let of_all_states = FieldOfStates {
            field,
            range: ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))),
            are_several: states.len() > 1,
        };
        for state in &mut result.states {
            if let Some(components) = read(&state.index) {
                for (name, bytes) in of.pictures(&of_all_states, state, &components)? {
                    state.files.retain(|file| file.name != name);
                    state.files.push(of.folder.write(name, &bytes)?);
                }
                drew();
            }
        }
    }
    let mut drawn = Vec::new();
    for state in result.states.iter_mut().filter(|_| result.complete) {
        let waiting = state.files.extract_if(.., |file| file.name.ends_with(EXTENSION));
        drawn.extend(waiting.map(|file| file.name));
    }
    Ok(drawn)
}

/// A model on a surface whose fields are drawn into a folder.
#[derive(Clone, Copy)]
pub(crate) struct FieldPictures<'a> {
    pub scene: &'a SceneFile,
    pub model: &'a str,
    pub surface: usize,
    pub cells: Cells,
    pub folder: &'a Folder,
}

/// What all pictures of a field have in common.
struct FieldOfStates<'a> {
    field: &'a FieldQuantity,
    range: Option<(f64, f64)>,
    are_several: bool,
}

impl FieldPictures<'_> {
    fn file<'a>(&'a self, field: &'a str, state: usize, extension: &'a str) -> FieldFile<'a> {
        FieldFile { field, model: self.model, surface: self.surface, state, extension }
    }

    /// The components of a field that [`keep`] kept.
    fn read(&self, field: &str, state: usize, components: usize) -> Option<Vec<Cow<'static, [f64]>>> {
        let bytes = self.folder.read(&waiting(self.file(field, state, EXTENSION)))?;
        let (values, rest) = bytes.as_chunks();
        let (cells, _) = grid_of(self.scene, self.cells, field);
        let count = cells.checked_count().filter(|count| *count > 0)?;
        let whole = rest.is_empty() && Some(values.len()) == count.checked_mul(components);
        let component = |values: &[[u8; 8]]| values.iter().map(|v| f64::from_le_bytes(*v)).collect();
        whole.then(|| values.chunks_exact(count).map(component).collect())
    }

    /// Lines of the flow on a picture of the flux, and on it and on that of the pressure of the fluid the critical
    /// constriction, where paths are requested.
    fn of_flow(
        &self,
        field: &FieldQuantity,
        state: &StateRecord,
        components: &[Cow<'_, [f64]>],
    ) -> Result<FlowLines> {
        let interface = &self.scene.requested.interface;
        let Some(leakage) =
            interface.leakage.filter(|_| [FLUX.name, FLUID_PRESSURE.name].contains(&field.name))
        else {
            return Ok((Vec::new(), Vec::new()));
        };
        let paths = state.solved().and_then(|solved| solved.state.interface.percolation);
        let along_the_flow = |[along_x, along_y]: [PathState; 2]| match leakage.along {
            FlowAxis::X => along_x,
            FlowAxis::Y => along_y,
        };
        let marks = paths.and_then(|paths| along_the_flow(paths).centre).into_iter().collect();
        let [along_x, along_y] = components else { return Ok((Vec::new(), marks)) };
        let name = self.file(field.name, state.index, FieldFormat::Png.extension()).to_string();
        let failed = runs::Error::model(name.clone());
        let component = |values: &[f64]| Field::new(self.cells, self.scene.surface.size(), values.to_vec());
        let flux = component(along_x).and_then(|x| Ok([x, component(along_y)?])).map_err(failed)?;
        let StreamFunction { points, origin, step, values } =
            stream_function(&flux, leakage.along, self.scene.effects.boundary);
        let (low, high) = FieldPicture::ends(&values);
        if high <= low {
            return Ok((Vec::new(), marks));
        }
        let level = |k: usize| low + (high - low) * (k as f64 + 0.5) / FLOW_LINES as f64;
        let levels: Vec<f64> = (0..FLOW_LINES).map(level).collect();
        let mut lines = contour_lines(&name, points, &values, &levels)?;
        for at in lines.iter_mut().flatten() {
            *at = [origin[0] + step[0] * at[0], origin[1] + step[1] * at[1]];
        }
        Ok((lines, marks))
    }

    /// The pictures of a field of a state, by their names: a map, or a curve over a profile.
    fn pictures(
        &self,
        of_all: &FieldOfStates<'_>,
        state: &StateRecord,
        components: &[Cow<'_, [f64]>],
    ) -> Result<Vec<(String, Vec<u8>)>> {
        let Self { scene, cells, .. } = *self;
        let field = of_all.field;
        let values = magnitude(components);
        let name = self.file(field.name, state.index, FieldFormat::Png.extension()).to_string();
        let of_state = FieldOfState { field, model: self.model, surface: self.surface, state: Some(state) };
        let mut drawn = picture(scene, &of_state, grid_of(scene, cells, field.name).0, &values);
        if scene.surface.is_profile() {
            let step = scene.surface.size().x / cells.columns as f64;
            let points = values.iter().enumerate().map(|(i, v)| ((i as f64 + 0.5) * step, *v));
            let stem = name.strip_suffix(".png").unwrap_or(&name);
            return Ok(row_chart(&drawn, points.collect()).files(stem)?.into());
        }
        let pressure = if field.outlined { self.read(PRESSURE, state.index, 1) } else { None };
        let contact: Vec<bool> = pressure.iter().flatten().flat_map(|p| p.iter()).map(|p| *p > 0.0).collect();
        (drawn.range, drawn.contact) = (of_all.range, &contact);
        let (lines, marks) = self.of_flow(field, state, components)?;
        (drawn.lines, drawn.marks) = (&lines, &marks);
        if let ([along_x, along_y], true) = (components, lines.is_empty()) {
            drawn.arrows = Some([along_x, along_y]);
        }
        if of_all.are_several && field.name != HEIGHTS.name && field.classes.is_empty() {
            drawn.subtitle +=
                if scene.is_history() { "; one scale for all steps" } else { "; one scale for all loads" };
        }
        let path = self.folder.path(&name);
        let bytes = drawn.png(&path.display().to_string())?;
        Ok(vec![(name, bytes)])
    }
}

/// The states of a stored result whose files are all there and unchanged. A picture of an interrupted run does
/// not count among them: it is drawn again from the values kept for it, and a later run that was killed may
/// have drawn some of the pictures anew, in another range.
pub(crate) fn keep_whole_states(result: &mut ModelResult, folder: &Folder) {
    if !result.complete {
        for state in &mut result.states {
            let waiting: Vec<String> = (state.files.iter())
                .filter_map(|file| file.name.strip_prefix(WAITING)?.strip_suffix(EXTENSION))
                .flat_map(|stem| [format!("{stem}png"), format!("{stem}svg")])
                .collect();
            state.files.retain(|file| !waiting.contains(&file.name) || folder.holds(file));
        }
    }
    result.states.retain(|state| state.is_whole(folder));
}

/// Removes the values that a killed run kept for drawing.
pub(crate) fn sweep(out: &Path) {
    let entries = std::fs::read_dir(out.join(WAITING)).into_iter().flatten().flatten();
    for path in
        entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == EXTENSION))
    {
        // It is the program's own folder; what cannot be removed does no harm.
        let _ = std::fs::remove_file(path);
    }
}

/// Cells and sides of a field: those of the map but for a vertical section.
fn grid_of(scene: &SceneFile, cells: Cells, field: &str) -> (Cells, Size) {
    let size = scene.surface.size();
    match &scene.requested.interface.stress_below {
        Some(stress) if field == STRESS_SECTION.name => stress.section_grid(cells, size),
        _ => (cells, size),
    }
}

/// A field of a state on a surface; the heights need no state.
pub(crate) struct FieldOfState<'a> {
    pub field: &'a FieldQuantity,
    pub model: &'a str,
    pub surface: usize,
    pub state: Option<&'a StateRecord>,
}

/// The picture of a field, with its title and its units.
pub(crate) fn picture<'a>(
    scene: &SceneFile,
    of: &FieldOfState<'_>,
    cells: Cells,
    values: &'a [f64],
) -> FieldPicture<'a> {
    let FieldOfState { field, model, surface, state } = *of;
    let &FieldQuantity { name, words, symbol, unit, components, white_zero, signed, classes, .. } = field;
    let load = match state {
        Some(state) if name != HEIGHTS.name => state.words(scene),
        _ => "as solved".to_owned(),
    };
    let mut title = format!("{words}, {}", words::model_name(model));
    title[..1].make_ascii_uppercase();
    let number = if scene.sampling.surfaces > 1 { format!(", surface {surface}") } else { String::new() };
    let subtitle = format!("{}{number}: {load}", words::scene_name(scene));
    let [unit, length_unit] = [unit, "m"].map(|unit| scene.system.shown(unit));
    let (_, size) = grid_of(scene, cells, name);
    let downwards = name == STRESS_SECTION.name;
    FieldPicture {
        title,
        subtitle,
        quantity: match symbol {
            "" => words.to_owned(),
            symbol if components > 1 => format!("{words}, magnitude $|{symbol}|$"),
            symbol => format!("{words} ${symbol}$"),
        },
        unit,
        length_unit,
        cells,
        size,
        values,
        white_zero,
        signed,
        range: None,
        contact: &[],
        arrows: None,
        lines: &[],
        marks: &[],
        downwards,
        classes,
    }
}

/// A field of one row as a curve over x, instead of a picture one cell high; the points are (x, value), x in
/// the scene's unit.
pub(crate) fn row_chart(picture: &FieldPicture<'_>, points: Vec<(f64, f64)>) -> Chart {
    Chart {
        title: picture.title.replace("3D boundary elements", "boundary elements in plane strain"),
        subtitle: picture.subtitle.clone(),
        x_label: "$x$".into(),
        y_label: picture.quantity.clone(),
        curves: vec![Curve { label: "profile".into(), points, ..Curve::default() }],
        logarithmic: false,
        ..Chart::default()
    }
    .in_units([picture.length_unit, picture.unit])
}
