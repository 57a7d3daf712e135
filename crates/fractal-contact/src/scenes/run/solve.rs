//! Solves one model on one surface under all loads, or along the whole path.

use crate::scenes::plan::{GridComparison, ModelOnSurface, solved_map, thresholds_of, with_interface};
use crate::scenes::read::{
    Error, FieldFormat, HEIGHTS, LoadList, LoadRequest, Numerics, PathPiece, Result, STRESS_COMPONENTS,
    STRESS_VOLUME, SceneFile, cells, distributed, step_to, words,
};
use crate::scenes::run::{
    Answer, AnsweredState, FieldFile, FieldView, Folder, Keeper, ModelResult, Refinement, SharedLines,
    StateRecord, Warning, field_pictures,
};
use contact_model::{
    ContactState, Field, FieldQuantity, LargestPull, Load, NormalLoad, Normalisation, PreparedContact,
    Status, Stop, never,
};
use std::borrow::Cow;
use std::path::Path;
use web_time::Instant;

/// Bytes of a solve below which the memory is not looked at.
const SMALL: f64 = 1e7;

impl ModelOnSurface {
    /// Solves the loads that `result` lacks, in their order, and passes the result to `keep` after each. A
    /// load that a model refuses has a row with the reason, and the others are solved. A path goes on from
    /// its checkpoint, or begins anew.
    ///
    /// # Errors
    /// [`Error::Run`] where the scene cannot be prepared, and files that cannot be written. A stop is not an
    /// error: the result is then incomplete.
    pub fn solve(
        &self,
        of: SceneInFolder<'_>,
        mut result: ModelResult,
        keeper: &mut Keeper<'_>,
        stop: Stop<'_>,
    ) -> Result<ModelResult> {
        let SceneInFolder { scene, lines, folder } = of;
        let refines = scene.requested.thresholds.is_some();
        if let LoadRequest::Loads(loads) = &scene.request
            && result.states.len() == loads.values.len()
            && (result.thresholds.is_some() || !refines)
        {
            // Each of them was solved before the run, or before it was interrupted.
            result.complete = true;
            return Ok(result);
        }
        let start = Instant::now();
        let numerics = self.numerics(scene);
        let what = || format!("{}, surface {}", numerics.name(), self.surface);
        let seed = scene.seed(self.surface);
        let physics = scene.scene(numerics, seed).map_err(runs::Error::model(what()))?;
        let before = result.seconds;
        let mut contact = match lines.model(numerics, &physics.surface).prepare_until(&physics, seed, stop) {
            // The surface was being drawn.
            Err(contact_model::Error::Stopped { .. }) => {
                result.complete = false;
                return Ok(result);
            }
            prepared => prepared.map_err(runs::Error::model(what()))?,
        };
        let is_path = matches!(scene.request, LoadRequest::Path(_));
        // Loads that were complete have lost a file; those of a contact without a memory are solved each by
        // itself.
        let goes_on = is_path || !result.complete && contact.memory().is_ok_and(|memory| memory.is_some());
        if goes_on {
            keeper.resume(&mut result, contact.as_mut(), is_path);
        }
        result.complete = false;
        let mut solving = ContactInHand {
            unit: self,
            scene,
            contact: contact.as_mut(),
            folder,
            stop,
            result,
            keeper,
            before,
            start,
        };
        match &scene.request {
            LoadRequest::Loads(loads) => solving.loads(loads)?,
            LoadRequest::Path(pieces) => solving.path(pieces)?,
        }
        let mut result = solving.result;
        result.seconds = before + start.elapsed().as_secs_f64();
        Ok(result)
    }

    /// The record of a state: its fields are written to files where these are requested, and binned where
    /// distributions are requested.
    fn recorded(
        &self,
        scene: &SceneFile,
        mut solved: AnsweredState,
        folder: &Folder,
        index: usize,
    ) -> Result<StateRecord> {
        let fields = solved.state.fields.take().unwrap_or_default();
        let cell = scene.surface.size();
        let cell = cell.x * cell.y / cells(scene, self.numerics(scene)).checked_count().unwrap_or(1) as f64;
        let state = (fields.pressure.as_ref(), fields.gap.as_ref(), solved.state.patches.as_ref());
        let distributions = distributed::of_state(&scene.requested.distributions, state, cell);
        let mut kept =
            StateRecord { distributions, ..StateRecord::new(index, Answer::State(Box::new(solved))) };
        let first = kept.index == 0 && !scene.requested.heights.is_empty();
        let heights = if first { self.heights(scene)? } else { None };
        for (quantity, formats) in scene.requested.fields() {
            let name = quantity.name;
            let components: &[Field] =
                if name == HEIGHTS.name { heights.as_slice() } else { (quantity.get)(&fields) };
            let Some(field) = components.first() else { continue };
            let components: Vec<Cow<'_, [f64]>> =
                components.iter().map(|component| on_defined_points(name, component, scene)).collect();
            // One component after the other, as files of numbers have them.
            let all =
                if let [values] = &components[..] { values.clone() } else { components.concat().into() };
            let shown = field_pictures::magnitude(&components);
            let (model, surface, state) = (self.numerics(scene).name(), self.surface, kept.index);
            let file = |extension| FieldFile { field: name, model, surface, state, extension };
            let drawn = scene.requested.draws(name, kept.index);
            if drawn && field_pictures::is_needed(scene, name) {
                kept.files.push(field_pictures::keep(folder, file(""), &all)?);
            }
            // Only the first surface is shown, and only fields that are written to files; a volume is no picture.
            let is_map = name != STRESS_VOLUME.name;
            if drawn && surface == 0 && !formats.is_empty() && is_map {
                let view = FieldView::new(field.cells(), &shown);
                kept.files.push(field_pictures::keep_view(folder, file(""), &view)?);
            }
            for &format in formats {
                let name = file(format.extension()).to_string();
                let values =
                    WrittenField { quantity, field, components: &components, all: &all, shown: &shown };
                if let Some(bytes) = values.bytes(format, drawn, &folder.path(&name), scene)? {
                    kept.files.push(folder.write(name, &bytes)?);
                }
            }
        }
        Ok(kept)
    }

    /// The heights that boundary elements solve, NaN where they are undefined; `None` for a model without
    /// cells.
    fn heights(&self, scene: &SceneFile) -> Result<Option<Field>> {
        let numerics = self.numerics(scene);
        if numerics.boundary_elements().is_none() {
            return Ok(None);
        }
        let draw = || {
            let map = solved_map(scene, numerics, scene.seed(self.surface), &never)?;
            let known = |h: &f64| if h.is_finite() { *h } else { f64::NAN };
            Field::new(map.cells(), map.size(), map.heights().iter().map(known).collect())
        };
        let what = || format!("heights of surface {}", self.surface);
        Ok(Some(draw().map_err(|error| runs::Error::model(what())(error))?))
    }
}

/// A scene, the lines that its models share, and the folder of its fields.
#[derive(Clone, Copy)]
pub(crate) struct SceneInFolder<'a> {
    pub scene: &'a SceneFile,
    pub lines: &'a SharedLines,
    pub folder: &'a Folder,
}

/// A model on a surface whose states are being solved.
struct ContactInHand<'a, 'k> {
    unit: &'a ModelOnSurface,
    scene: &'a SceneFile,
    contact: &'a mut dyn PreparedContact,
    /// The folder of the fields.
    folder: &'a Folder,
    stop: Stop<'a>,
    result: ModelResult,
    keeper: &'a mut Keeper<'k>,
    /// Seconds that earlier runs spent.
    before: f64,
    start: Instant,
}

impl ContactInHand<'_, '_> {
    fn keep(&mut self, interrupted: bool) {
        self.result.seconds = self.before + self.start.elapsed().as_secs_f64();
        self.keeper.keep(&mut self.result, self.contact, interrupted);
    }

    /// Solves the loads that the result lacks, each by itself.
    fn loads(&mut self, requests: &LoadList) -> Result<()> {
        let normalisation = self.contact.normalisation();
        let load = |&value: &f64| requests.load(value, &normalisation);
        let loads = requests.values.iter().map(load).collect::<contact_model::Result<Vec<Load>>>();
        let numerics = self.unit.numerics(self.scene);
        let compares = self.scene.requested.grid_error && matches!(numerics, Numerics::Bem3d(_));
        if let Ok(loads) = &loads {
            self.check_memory(loads)?;
        }
        let mut comparison = None;
        if let (true, Ok(loads)) = (compares, &loads) {
            self.keeper.on_coarser_grids(true);
            comparison = self.coarser_grids(loads)?;
            self.keeper.on_coarser_grids(false);
            if comparison.is_none() {
                return Ok(());
            }
        }
        for index in 0..requests.values.len() {
            let place = self.result.states.partition_point(|state| state.index < index);
            if self.result.states.get(place).is_some_and(|state| state.index == index) {
                continue;
            }
            let found = match &loads {
                Ok(loads) => self.contact.solve_until(loads[index], self.stop).and_then(|state| {
                    with_interface(self.scene, numerics, loads[index].normal, state, self.stop)
                }),
                // A surface without an rms height has no F_bar: no load has an answer, and each row says so.
                Err(error) => Err(error.clone()),
            };
            let record = match found {
                Ok(state) => {
                    let errors = |of: &GridComparison| of.errors(index, &state, &normalisation);
                    let grid = comparison.as_ref().map(errors);
                    let warnings = Warning::of(self.scene, &state, grid.as_ref());
                    let solved = AnsweredState { state, normalisation, warnings, grid };
                    self.unit.recorded(self.scene, solved, self.folder, index)?
                }
                // A load by itself has no stable state before it.
                Err(contact_model::Error::NotConverged { best })
                    if best.report.status == Status::PulledOff =>
                {
                    StateRecord::new(index, Answer::Refused(words::no_state(self.scene, index)))
                }
                Err(contact_model::Error::NotConverged { best }) => missed(index, *best, normalisation),
                Err(contact_model::Error::Stopped { .. }) => {
                    self.keep(true);
                    return Ok(());
                }
                Err(other) => {
                    let normal = loads.as_ref().ok().map(|loads| loads[index].normal);
                    let height = normalisation.height;
                    StateRecord::new(
                        index,
                        Answer::Refused(words::refusal_of_load(self.scene, height, normal, &other)),
                    )
                }
            };
            self.result.states.insert(place, record);
            self.keep(false);
        }
        self.result.complete = self.refine_thresholds(requests, normalisation);
        Ok(())
    }

    /// Solves loads between those of the scene until each threshold is known as closely as it is asked for; false
    /// where it was stopped. A solve that fails leaves the threshold between the loads of the scene, with a note.
    fn refine_thresholds(&mut self, loads: &LoadList, normalisation: Normalisation) -> bool {
        let scene = self.scene;
        let Some(width) = scene.requested.thresholds.filter(|_| self.result.thresholds.is_none()) else {
            return true;
        };
        // What follows begins with what the contact remembers now, in a run that goes on as well.
        self.keep(true);
        let numerics = self.unit.numerics(scene);
        let refinement = Refinement { scene, numerics, loads, normalisation, width };
        let mut refined = Vec::new();
        for of in thresholds_of(scene) {
            match refinement.solve(of, &self.result.states, self.contact, self.stop) {
                Ok(found) => refined.extend(found),
                Err(contact_model::Error::Stopped { .. }) => return false,
                Err(error) => {
                    let (model, surface) = (numerics.name(), self.unit.surface);
                    let words = of.words();
                    let note = format!(
                        "{model}, surface {surface}: the load at which {words} is not refined: {error}"
                    );
                    self.result.notes.push(note);
                }
            }
        }
        self.result.thresholds = Some(refined);
        true
    }

    /// Refuses loads that need more memory than there is: a solve that is refused memory ends the process.
    ///
    /// # Errors
    /// [`Error::Run`] with both sizes.
    fn check_memory(&self, loads: &[Load]) -> Result<()> {
        let required = loads.iter().filter_map(|&load| self.contact.required_memory(load));
        let Some(most) = required.max_by(|a, b| a.bytes.total_cmp(&b.bytes)) else { return Ok(()) };
        // To ask the system would take a part of the time of a small solve.
        if most.bytes < SMALL {
            return Ok(());
        }
        let what = format!("{}, surface {}", self.unit.numerics(self.scene).name(), self.unit.surface);
        let checked = runs::check_memory(most.what, most.bytes);
        Ok(checked.map_err(runs::Error::model(what))?)
    }

    /// All loads on coarser grids, also of a run that goes on, because each state there begins with the one
    /// before it. `None` where it was stopped.
    fn coarser_grids(&self, loads: &[Load]) -> Result<Option<GridComparison>> {
        let Self { unit, scene, stop, .. } = *self;
        match GridComparison::solve(scene, unit.numerics(scene), scene.seed(unit.surface), loads, stop) {
            Err(contact_model::Error::Stopped { .. }) => Ok(None),
            found => {
                let what = || format!("coarser grids of surface {}", unit.surface);
                Ok(Some(found.map_err(|error| runs::Error::model(what())(error))?))
            }
        }
    }

    /// Solves the steps of a path after those of the result.
    fn path(&mut self, pieces: &[PathPiece]) -> Result<()> {
        let normalisation = self.contact.normalisation();
        let numerics = self.unit.numerics(self.scene);
        let model = numerics.name();
        let step_of = |index: usize, states: &[StateRecord]| {
            step_to(index, pieces, model, |before| Some(&states.get(before)?.solved()?.state))
        };
        let mut largest = LargestPull::default();
        for (index, record) in self.result.states.iter().enumerate() {
            if let (Some(solved), Ok(step)) = (record.solved(), step_of(index, &self.result.states)) {
                let _ = largest.enter(step.load.normal, solved.state.clone());
            }
        }
        for index in self.result.states.len()..self.scene.request.count() {
            let step = step_of(index, &self.result.states);
            let normal = step.as_ref().ok().map(|step| step.load.normal);
            if let Ok(step) = &step {
                self.check_memory(&[step.load])?;
            }
            // Where a stop ends the leakage or the stress of a state, the contact goes back to before the step. Where
            // there is no room for what it remembers, they are computed to their end.
            let reads_off = !self.scene.requested.interface.outputs().is_empty();
            let (before, stop): (_, Stop<'_>) = match reads_off.then(|| self.contact.memory()) {
                Some(Ok(before)) => (before, self.stop),
                _ => (None, &never),
            };
            let advanced = step.and_then(|step| match self.contact.advance_until(step, self.stop) {
                Err(contact_model::Error::Stopped { .. }) => Ok(None),
                Ok(state) => match with_interface(self.scene, numerics, step.load.normal, state, stop) {
                    Err(contact_model::Error::Stopped { .. }) => {
                        if let Some(before) = before {
                            self.contact.recall(&before)?;
                        }
                        Ok(None)
                    }
                    state => Ok(Some((largest.enter(step.load.normal, state?), true))),
                },
                // The best state of a solve that missed its tolerance or, beyond the pull-off force, the last
                // stable state.
                Err(error) => {
                    let mut best = error.into_best()?.with_fields(None).with_patches(None);
                    if let (Status::PulledOff, NormalLoad::Force(force)) =
                        (best.report.status, step.load.normal)
                    {
                        best.report.strategy = words::pull_off(self.scene, force);
                    }
                    Ok(Some((largest.enter(step.load.normal, best), false)))
                }
            });
            let record = match advanced {
                Ok(None) => {
                    self.keep(true);
                    return Ok(());
                }
                Ok(Some((state, true))) => {
                    let warnings = Warning::of(self.scene, &state, None);
                    let solved = AnsweredState { state, normalisation, warnings, grid: None };
                    self.unit.recorded(self.scene, solved, self.folder, index)?
                }
                Ok(Some((best, false))) => missed(index, best, normalisation),
                Err(error) => StateRecord::new(
                    index,
                    Answer::Refused(words::refusal_of_load(self.scene, normalisation.height, normal, &error)),
                ),
            };
            let failed = record.converged().is_none();
            self.result.states.push(record);
            if failed {
                // The steps after one that failed would belong to another path.
                break;
            }
            self.keep(false);
        }
        self.result.complete = true;
        Ok(())
    }
}

/// The record of a state that missed its tolerance, without its fields.
fn missed(index: usize, best: ContactState, normalisation: Normalisation) -> StateRecord {
    let state = best.with_fields(None).with_patches(None);
    let solved = AnsweredState { state, normalisation, warnings: Vec::new(), grid: None };
    StateRecord::new(index, Answer::State(Box::new(solved)))
}

/// A field as files have it: there is no gap at an undefined point.
fn on_defined_points<'a>(name: &str, field: &'a Field, scene: &SceneFile) -> Cow<'a, [f64]> {
    match scene.surface.given_map() {
        Some(map) if map.undefined() > 0 && name == "gap" => {
            let defined = |(h, g): (&f64, &f64)| if h.is_finite() { *g } else { f64::NAN };
            map.heights().iter().zip(field.values()).map(defined).collect()
        }
        _ => Cow::Borrowed(field.values()),
    }
}

/// A field that is written to files.
struct WrittenField<'a> {
    quantity: &'a FieldQuantity,
    field: &'a Field,
    components: &'a [Cow<'a, [f64]>],
    /// One component after the other.
    all: &'a [f64],
    /// What a picture shows.
    shown: &'a [f64],
}

impl WrittenField<'_> {
    /// A format of it as the bytes of a file, which messages call `path`; `None` where there is no such file.
    /// Pictures with axes are drawn later, when all states have been solved.
    fn bytes(
        &self,
        format: FieldFormat,
        drawn: bool,
        path: &Path,
        scene: &SceneFile,
    ) -> Result<Option<Vec<u8>>> {
        let Self { quantity, field, components, all, shown } = *self;
        Ok(match format {
            FieldFormat::Npy => {
                let [rows, columns] = [field.rows(), field.columns()];
                let shape = match components.len() {
                    count if quantity.name == STRESS_VOLUME.name => {
                        let kinds = quantity.components;
                        vec![kinds, count / kinds, rows, columns]
                    }
                    1 => vec![rows, columns],
                    count => vec![count, rows, columns],
                };
                let bytes = surface_io::npy(&shape, all);
                Some(bytes.map_err(|e| runs::Error::content(path, e.to_string()))?)
            }
            FieldFormat::Png => None,
            FieldFormat::Pixels if !drawn => None,
            FieldFormat::Pixels => {
                let name = path.display().to_string();
                Some(plots::grey_png(&name, field.cells(), field.size(), shown)?)
            }
            FieldFormat::Vti => Some(vti(path, quantity, scene, field, components)?),
        })
    }
}

fn vti(
    path: &Path,
    quantity: &FieldQuantity,
    scene: &SceneFile,
    field: &Field,
    components: &[Cow<'_, [f64]>],
) -> Result<Vec<u8>> {
    let unit = scene.system.shown(quantity.unit);
    let content = |e: surface_io::ContentError| Error::Argument {
        name: "vti",
        reason: format!("{}: {e}", path.display()),
    };
    if let (true, Some(stress)) =
        (quantity.name == STRESS_VOLUME.name, &scene.requested.interface.stress_below)
    {
        let (layers, thickness) = stress.layers();
        let whole: Vec<Vec<f64>> = components.chunks(layers).map(<[_]>::concat).collect();
        let names = STRESS_COMPONENTS.map(|component| format!("stress_{component}"));
        let arrays: Vec<surface_io::DataArray<'_>> = names
            .iter()
            .zip(&whole)
            .map(|(name, values)| surface_io::DataArray { name, unit, values })
            .collect();
        let encoding = surface_io::Encoding::Base64;
        return surface_io::vti_volume(field.cells(), field.size(), layers, thickness, &arrays, encoding)
            .map_err(content);
    }
    // Two components are two arrays.
    let names: Vec<String> = match components.len() {
        1 => vec![quantity.name.to_owned()],
        _ => ["x", "y"].map(|along| format!("{}_{along}", quantity.name)).into(),
    };
    let arrays: Vec<surface_io::DataArray<'_>> = names
        .iter()
        .zip(components)
        .map(|(name, values)| surface_io::DataArray { name, unit, values })
        .collect();
    surface_io::vti(field.cells(), field.size(), &arrays, surface_io::Encoding::Base64).map_err(content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{PrescribedLoad, SceneSurface};
    use contact_model::{Fields, HeightMap, Output, SolveReport, Step};
    use std::sync::Arc;

    fn field_pictures_in<'a>(scene: &'a SceneFile, folder: &'a Folder) -> field_pictures::FieldPictures<'a> {
        field_pictures::FieldPictures { scene, model: "bem3d", surface: 0, cells: [3, 2].into(), folder }
    }

    /// Fields of 2 rows x 3 columns with oblong cells; the second point of the second row is undefined.
    #[test]
    fn fields_are_arrays_of_rows_and_columns() {
        let heights = vec![1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0];
        let map = HeightMap::with_undefined([3, 2], [6.0, 1.0], heights).unwrap();
        let surface = SceneSurface::Plain(contact_model::Surface::Heights(Arc::new(map)));
        let loads = LoadRequest::Loads(LoadList { kind: PrescribedLoad::Force, values: vec![1.0] });
        let mut scene = SceneFile::new(vec![Numerics::Bem3d(bem3d::Bem3d::default())], surface, 1.0, loads);
        let all = vec![FieldFormat::Npy, FieldFormat::Png, FieldFormat::Pixels, FieldFormat::Vti];
        scene.requested.files = vec![(Output::Pressure, all.clone()), (Output::Gap, all)];
        let pressure = vec![0.0, 1.0, 2.0, 3.0, 0.0, 5.0];
        let gap = vec![0.5, 0.0, 0.0, 0.0, f64::INFINITY, 0.0];
        let mut fields = Fields::default();
        let field = |values: &[f64]| Field::new([3, 2], [6.0, 1.0], values.to_vec()).ok();
        (fields.pressure, fields.gap) = (field(&pressure), field(&gap));
        let state = ContactState::new(1.0, SolveReport::exact("test")).with_fields(fields);
        let dir = tempfile::tempdir().unwrap();
        let folder = Folder::from(dir.path());
        let unit = ModelOnSurface { model: 0, surface: 0 };
        std::fs::create_dir(dir.path().join(".units")).unwrap();
        let normalisation = contact_model::Normalisation { contact_modulus: 1.0, length: 1.0, height: None };
        let solved = AnsweredState { state, normalisation, warnings: Vec::new(), grid: None };
        let kept = unit.recorded(&scene, solved, &folder, 0).unwrap();
        // Three files of each field, its values for the picture, and what the report shows of it.
        assert_eq!((kept.files.len(), kept.solved().unwrap().state.fields.is_none()), (10, true));
        let mut result = ModelResult { states: vec![kept], complete: true, ..ModelResult::default() };
        let pictures = field_pictures_in(&scene, &folder);
        let drawn = field_pictures::draw(pictures, &mut result, &|| ());
        let drawn = drawn.unwrap();
        let files = &result.states[0].files;
        assert_eq!(
            (files.len(), files.iter().filter(|file| field_pictures::is_hidden(&file.name)).count()),
            (10, 2)
        );
        assert!(files.iter().all(|file| folder.holds(file)), "{files:?}");
        // What the report shows, and the values that were drawn.
        assert_eq!(std::fs::read_dir(dir.path().join(".units")).unwrap().count(), 4);
        assert!(drawn.len() == 2 && drawn.iter().all(|file| dir.path().join(file).exists()), "{drawn:?}");
        let scan = |name: &str| {
            surface_io::Scan::read(dir.path().join(name), &surface_io::ReadOptions::default()).unwrap()
        };
        let read = scan("pressure-bem3d-0-000.npy");
        assert_eq!((read.metadata().rows, read.metadata().columns), (2, 3));
        let values: Vec<f64> = (0..6).filter_map(|i| read.height(i / 3, i % 3)).collect();
        assert_eq!(values, pressure);
        let read = scan("gap-bem3d-0-000.npy");
        assert_eq!((read.height(1, 1), read.height(0, 0), read.metadata().undefined), (None, Some(0.5), 1));
        let vti = std::fs::read_to_string(dir.path().join("gap-bem3d-0-000.vti")).unwrap();
        assert!(vti.contains("WholeExtent=\"0 3 0 2 0 0\" Origin=\"0 0 0\" Spacing=\"2 0.5 2\""), "{vti}");
        assert!(vti.contains("vtkGhostType"));
        // Width and height of a PNG stand after its first chunk's name; pixels are squares of 0.5.
        let png = std::fs::read(dir.path().join("gap-bem3d-0-000.pixels.png")).unwrap();
        let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        assert_eq!((side(16), side(20)), (12, 2));
    }

    /// Two components are one array of two in NPY, two arrays in VTI and arrows over their magnitude in PNG.
    #[test]
    fn fields_of_two_components_are_whole_in_every_format() {
        let surface = SceneSurface::Plain(contact_model::Surface::Flat { size: [6.0, 1.0].into() });
        let steps = LoadRequest::Path(vec![Step::new(0.0, Load::force(1.0)).into()]);
        let mut scene = SceneFile::new(vec![Numerics::Bem3d(bem3d::Bem3d::default())], surface, 1.0, steps);
        if let Numerics::Bem3d(elements) = &mut scene.models[0] {
            (elements.cells, elements.rows) = (3, Some(2));
        }
        let all = vec![FieldFormat::Npy, FieldFormat::Png, FieldFormat::Pixels, FieldFormat::Vti];
        scene.requested.files =
            [Output::Traction, Output::Slip, Output::StickSlip].map(|output| (output, all.clone())).into();
        let field = |values: [f64; 6]| Field::new([3, 2], [6.0, 1.0], values.to_vec()).unwrap();
        let (x, y) = ([0.0, 3.0, 0.0, 1.0, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0, 0.0, 2.0]);
        let mut fields = Fields::default();
        (fields.traction, fields.slip) = (Some([field(x), field(y)]), Some([field(y), field(x)]));
        fields.stick_slip = Some(field([0.0, 2.0, 0.0, 1.0, 0.0, 1.0]));
        let state = ContactState::new(1.0, SolveReport::exact("test")).with_fields(fields);
        let dir = tempfile::tempdir().unwrap();
        let folder = Folder::from(dir.path());
        std::fs::create_dir(dir.path().join(".units")).unwrap();
        let normalisation = contact_model::Normalisation { contact_modulus: 1.0, length: 1.0, height: None };
        let solved = AnsweredState { state, normalisation, warnings: Vec::new(), grid: None };
        let unit = ModelOnSurface { model: 0, surface: 0 };
        let kept = unit.recorded(&scene, solved, &folder, 0).unwrap();
        let mut result = ModelResult { states: vec![kept], complete: true, ..ModelResult::default() };
        field_pictures::draw(field_pictures_in(&scene, &folder), &mut result, &|| ()).unwrap();
        let files = &result.states[0].files;
        assert!(files.iter().all(|file| folder.holds(file)), "{files:?}");
        for name in ["traction", "slip", "stick_slip"] {
            for format in &all {
                let file = format!("{name}-bem3d-0-000.{}", format.extension());
                assert!(files.iter().any(|known| known.name == file), "{file}: {files:?}");
            }
        }
        let npy = std::fs::read(dir.path().join("traction-bem3d-0-000.npy")).unwrap();
        assert!(String::from_utf8_lossy(&npy).contains("'shape': (2, 2, 3)"));
        let numbers: Vec<f64> =
            npy[npy.len() - 96..].as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        assert_eq!(numbers, [x, y].concat());
        let vti = std::fs::read_to_string(dir.path().join("traction-bem3d-0-000.vti")).unwrap();
        assert!(vti.contains("Name=\"traction_x\"") && vti.contains("Name=\"traction_y\""), "{vti}");
        let file = |field| FieldFile { field, model: "bem3d", surface: 0, state: 0, extension: "" };
        let view = field_pictures::view(&folder, file("traction")).unwrap();
        assert_eq!(view.values, [0.0, 5.0, 0.0, 1.0, 0.0, 2.0]);
    }
}
