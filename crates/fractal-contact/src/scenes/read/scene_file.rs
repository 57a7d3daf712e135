//! A scene as it is read from a file.

use crate::scenes::EFFECT_KEYS;
use crate::scenes::read::{
    Diagnostic, Entries, Entry, LoadKind, LoadRequest, MOST_CELLS, Numerics, Read, Registry,
    RequestedAccuracy, RequestedOutputs, Result, SceneSurface, SurfaceEntry, System, outputs, read_accuracy,
    read_effects, read_models, read_outputs, read_request, read_surface, short,
};
use contact_model::{
    Adhesion, Body, Boundary, Cells, Directions, Effect, Effects, Friction, Hardness, NormalLoad, Output,
    Pair, Paths, Rheology, Scene,
};
use std::ops::Range;
use std::path::{Path, PathBuf};
use surface_io::Dimension;

/// Largest size of a scene file in bytes; a longer file is not a scene.
const LONGEST: u64 = 1 << 20;

/// Most surfaces of a scene.
const MOST_SURFACES: u64 = 1_000_000;

/// A contact problem with everything that determines its results.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Text of the file.
    pub text: String,
    /// Whether numbers carry units; without them results are in the scene's own units.
    pub system: System,
    /// The models in the order named.
    pub models: Vec<Numerics>,
    /// The surface of the contact.
    pub surface: SceneSurface,
    /// Contact modulus E* of the pair.
    pub contact_modulus: f64,
    /// Pressure above which a state has a note; E*/10 where none is given.
    pub hardness: Option<f64>,
    /// The accuracy for which the grid is chosen ([`SceneFile::with_grid_for_accuracy`]).
    pub accuracy: Option<RequestedAccuracy>,
    /// Both bodies, where they are named.
    pub pair: Option<Pair>,
    /// Effects, off unless named.
    pub effects: Effects,
    /// The loads or the path.
    pub request: LoadRequest,
    /// What is computed and stored.
    pub requested: RequestedOutputs,
    /// Seed and number of surfaces.
    pub sampling: Sampling,
    /// Metadata of the surface's file.
    pub metadata: Option<String>,
    /// The distance from which on the tip of the instrument resolves heights, where the scene gives its
    /// radius.
    pub reliable_from: Option<f64>,
    /// Remarks on the file, such as keys that have a new name.
    pub notes: Vec<Diagnostic>,
    places: Places,
}

/// `[sampling]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// The master seed.
    pub seed: u64,
    /// Number of surfaces drawn from it.
    pub surfaces: usize,
}

/// Places in the text, for messages.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Places {
    models: Vec<Range<usize>>,
    outputs: Vec<(&'static str, Range<usize>)>,
    effects: Vec<(&'static str, Range<usize>)>,
    accuracy: Option<Range<usize>>,
}

impl Places {
    fn of_output(&self, name: &str) -> Option<Range<usize>> {
        self.outputs.iter().find(|(key, _)| *key == name).map(|(_, span)| span.clone())
    }

    fn of_effect(&self, name: &str) -> Option<Range<usize>> {
        self.effects.iter().find(|(key, _)| *key == name).map(|(_, span)| span.clone())
    }
}

impl SceneFile {
    /// A scene built in code, in any consistent units: no effects, no outputs, one surface of seed 0.
    /// Messages then have no line.
    ///
    /// ```
    /// use contact_model::Surface;
    /// use fractal_contact::scenes::{LoadRequest, LoadList, Numerics, Plan, LoadKind, SceneFile, SceneSurface};
    /// let body = SceneSurface::Plain(Surface::Sphere { radius: 1.0, size: 4.0.into() });
    /// let loads = LoadRequest::Loads(LoadList { kind: LoadKind::Force, values: vec![0.1, 1.0] });
    /// let mut scene = SceneFile::new(vec![Numerics::named("hertz").unwrap()], body, 1.0, loads);
    /// scene.requested.outputs.stiffness = true;
    /// assert!(Plan::new(&scene).is_ok());
    /// // A closed form has no pressure field.
    /// scene.requested.outputs.pressure = true;
    /// assert!(Plan::new(&scene).is_err());
    /// ```
    pub fn new(
        models: Vec<Numerics>,
        surface: SceneSurface,
        contact_modulus: f64,
        request: LoadRequest,
    ) -> Self {
        Self {
            path: PathBuf::new(),
            text: String::new(),
            system: System::None,
            models,
            surface,
            contact_modulus,
            hardness: None,
            accuracy: None,
            pair: None,
            effects: Effects::default(),
            request,
            requested: RequestedOutputs::default(),
            sampling: Sampling { seed: 0, surfaces: 1 },
            metadata: None,
            reliable_from: None,
            notes: Vec::new(),
            places: Places::default(),
        }
    }

    /// The scene with pictures of the fields of these states only, instead of `drawn_states` in its
    /// `[outputs]`. Loads or steps are counted from 0.
    ///
    /// # Errors
    /// A [`Diagnostic`] that names the first of them that the scene does not have.
    pub fn drawing(mut self, states: Vec<usize>) -> Result<Self, Diagnostic> {
        self.requested.drawn_states = Some(states);
        check_drawn_states(&self.requested, &self.request)?;
        Ok(self)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`crate::scenes::Error::Run`] where it cannot be read, [`crate::scenes::Error::Scene`] with the place of the first mistake.
    pub fn read(path: &Path) -> Result<Self> {
        Self::read_with(path, &Registry::new())
    }

    /// Reads a file whose models may be those of a registry.
    ///
    /// # Errors
    /// As [`SceneFile::read`].
    pub fn read_with(path: &Path, registry: &Registry) -> Result<Self> {
        let about = std::fs::metadata(path).map_err(runs::Error::file("read", path))?;
        let length = about.len();
        if about.is_file() && length > LONGEST {
            let message = format!("{length} bytes: a scene is a short text of at most {LONGEST}");
            return Err(Diagnostic::new(message)
                .with_help("is this the right file?")
                .placed(path, "")
                .into());
        }
        let bytes = runs::files::read(path, LONGEST)?;
        let Ok(text) = String::from_utf8(bytes) else {
            let help = "`fractal-contact info FILE` describes a surface or a result";
            return Err(Diagnostic::new("not a text file (UTF-8)").with_help(help).placed(path, "").into());
        };
        Self::parse_with(path, text, registry)
    }

    /// Reads a text. Messages show `path` as its file, and files that it names are looked up relative to it.
    ///
    /// # Errors
    /// [`crate::scenes::Error::Scene`] with the place of the first mistake.
    ///
    /// ```
    /// let text = "[scene]\nunits = \"none\"\nmodels = [\"hertz\"]\ncontact_modulus = 1\nforce = [0.001, 1]\n\
    ///             [scene.body]\nkind = \"sphere\"\nradius = 1\nside = 4\n";
    /// let scene = fractal_contact::scenes::SceneFile::parse("hertz.toml".as_ref(), text.into())?;
    /// assert_eq!(scene.models[0].name(), "hertz");
    /// assert_eq!(scene.request.count(), 2);
    /// # Ok::<(), fractal_contact::scenes::Error>(())
    /// ```
    pub fn parse(path: &Path, text: String) -> Result<Self> {
        Self::parse_with(path, text, &Registry::new())
    }

    /// Reads a text whose models may be those of a registry: names of the library come first.
    ///
    /// # Errors
    /// As [`SceneFile::parse`].
    pub fn parse_with(path: &Path, text: String, registry: &Registry) -> Result<Self> {
        let read = |root: Entries<'_>| {
            let scene = read_scene(&root, path.parent().unwrap_or(Path::new("")), registry)?;
            root.finish()?;
            Ok(scene)
        };
        let scene = Entries::of_text("", &text, read);
        let mut scene = scene.map_err(|diagnostic| diagnostic.placed(path, &text))?;
        path.clone_into(&mut scene.path);
        scene.notes = scene.notes.into_iter().map(|note| note.placed(path, &text)).collect();
        scene.text = text;
        Ok(scene)
    }

    /// The physical problem for one model and one surface.
    ///
    /// # Errors
    /// As [`SceneSurface::for_model`].
    pub fn scene(&self, numerics: &Numerics, seed: u64) -> contact_model::Result<Scene> {
        let mut outputs = self.requested.outputs;
        // A piece that begins at the mean gap reached needs it.
        outputs.mean_gap |= self.request.begins_at_mean_gap()
            && numerics.model().abilities().outputs.contains(&Output::MeanGap);
        Ok(Scene {
            surface: self.surface.for_model(numerics, seed)?,
            contact_modulus: self.contact_modulus,
            pair: self.pair,
            effects: self.effects,
            outputs,
        })
    }

    /// Seed of surface number `index`, as in the figures of the paper.
    pub fn seed(&self, index: usize) -> u64 {
        surface_gen::surface_seed(self.sampling.seed, index as u64)
    }

    /// A mistake at the name of a model.
    pub(crate) fn at_model(&self, index: usize, diagnostic: Diagnostic) -> Diagnostic {
        self.placed(diagnostic, self.places.models.get(index).cloned())
    }

    /// A mistake of an output.
    pub(crate) fn at_output(&self, name: &str, diagnostic: Diagnostic) -> Diagnostic {
        self.placed(diagnostic, self.places.of_output(name))
    }

    /// A mistake of an effect.
    pub(crate) fn at_effect(&self, name: &str, diagnostic: Diagnostic) -> Diagnostic {
        self.placed(diagnostic, self.places.of_effect(name))
    }

    /// A mistake of the requested accuracy.
    pub(crate) fn at_accuracy(&self, diagnostic: Diagnostic) -> Diagnostic {
        self.placed(diagnostic, self.places.accuracy.clone())
    }

    fn placed(&self, diagnostic: Diagnostic, span: Option<Range<usize>>) -> Diagnostic {
        let diagnostic = diagnostic.at(span);
        if self.text.is_empty() { diagnostic } else { diagnostic.placed(&self.path, &self.text) }
    }

    /// Whether the surface of some model depends on the seed.
    pub(crate) fn is_random(&self) -> bool {
        let given = self.surface.given_map().is_some();
        self.surface.is_random() || given && self.models.iter().any(|m| self.surface.is_random_for(m))
    }

    /// Number of surfaces on which a model has results of its own: one where they do not depend on the seed.
    pub(crate) fn surfaces_of(&self, numerics: &Numerics) -> usize {
        if self.surface.is_random_for(numerics) { self.sampling.surfaces } else { 1 }
    }

    /// Whether it is a path, which needs models with a memory.
    pub fn is_history(&self) -> bool {
        matches!(self.request, LoadRequest::Path(_))
    }

    /// The comment at the head of the file, which says what the scene shows.
    pub fn comment(&self) -> String {
        let lines = self.text.lines().take_while(|l| l.starts_with('#'));
        lines.map(|l| l.trim_start_matches('#').trim()).collect::<Vec<_>>().join(" ")
    }
}

fn read_scene(root: &Entries<'_>, directory: &Path, registry: &Registry) -> Read<SceneFile> {
    let Some(scene) = root.table("scene")? else {
        return Err(Diagnostic::new("there is no [scene]")
            .with_help("a scene begins with [scene]: `models`, `contact_modulus` and a load"));
    };
    let mut system = System::Si;
    scene.set(&mut system, "units", |e| e.choice(&[("none", System::None), ("si", System::Si)]))?;
    let (contact_modulus, pair, renamed) = read_material(&scene, system)?;
    let options = root.table("models")?;
    let models = read_models(&scene, options.as_ref(), registry.models())?;
    let effects_table = root.table("effects")?;
    let effect_places = places(effects_table.as_ref(), EFFECT_KEYS.iter().map(|key| key.name));
    let effects = read_effects(effects_table, system)?;
    let outputs_table = root.table("outputs")?;
    let output_places = places(outputs_table.as_ref(), outputs::names());
    let requested = read_outputs(outputs_table, system)?;
    let hardness_entry = scene.find("hardness");
    let hardness = hardness_entry.as_ref().map(|e| e.positive(Dimension::PRESSURE, system)).transpose()?;
    if let Some(entry) = &hardness_entry
        && effects.hardness != Hardness::Off
    {
        return Err(entry.diagnostic_at_key("`hardness` is given in [scene] and in [effects]").with_help(
            "keep that of [effects], which limits the pressure; that of [scene] only marks states",
        ));
    }
    let accuracy = read_accuracy(&scene)?;
    let SurfaceEntry { surface, metadata, reliable_from, mut notes } =
        read_surface(&scene, system, directory)?;
    notes.splice(0..0, renamed);
    check_cells(options.as_ref(), &models, &surface)?;
    if accuracy.is_some() {
        check_no_grid(options.as_ref())?;
    }
    check_homogeneous(&scene, &models, &surface)?;
    let pulls = effects.adhesion != Adhesion::Off;
    let (request, request_entry) = read_request(&scene, system, pulls, surface.size())?;
    let sampling = read_sampling(root, &scene, &models, &surface, &mut notes)?;
    scene.finish()?;
    let places = Places {
        models: models.iter().map(|(_, entry)| entry.span()).collect(),
        outputs: output_places,
        effects: effect_places,
        accuracy: accuracy.as_ref().map(|(_, entry)| entry.key_span()),
    };
    check_request(&request, &request_entry, &surface, &effects)?;
    check_half_plane(&request, &request_entry, &surface, (&effects, &requested), &places)?;
    check_drawn_states(&requested, &request)
        .map_err(|error| error.at(places.of_output(outputs::DRAWN_STATES)))?;
    check_histories(&models, &request, &request_entry, &effects)?;
    check_tangential(&models, &request, &effects)?;
    check_coupling(&models, pair.as_ref(), effects.friction, places.of_effect("friction"))?;
    let models = models.into_iter().map(|(numerics, _)| numerics).collect();
    Ok(SceneFile {
        system,
        hardness,
        accuracy: accuracy.map(|(requested, _)| requested),
        pair,
        effects,
        requested,
        sampling,
        metadata,
        reliable_from,
        notes,
        places,
        ..SceneFile::new(models, surface, contact_modulus, request)
    })
}

fn places(
    table: Option<&Entries<'_>>,
    names: impl Iterator<Item = &'static str>,
) -> Vec<(&'static str, Range<usize>)> {
    let Some(table) = table else { return Vec::new() };
    names.filter_map(|name| Some((name, table.entry(name)?.key_span()))).collect()
}

/// E*, given directly or by both bodies, and a note where it has its former name.
fn read_material(scene: &Entries<'_>, system: System) -> Read<(f64, Option<Pair>, Option<Diagnostic>)> {
    match scene.one_of(&["contact_modulus", "modulus", "bodies"])? {
        Some(("contact_modulus", entry)) => Ok((entry.positive(Dimension::PRESSURE, system)?, None, None)),
        Some(("modulus", entry)) => {
            let note = Diagnostic::note("`modulus` is read as `contact_modulus`, which is E* of the pair")
                .at(entry.key_span())
                .with_help("To give Young's modulus and Poisson's ratio, write `bodies`.");
            Ok((entry.positive(Dimension::PRESSURE, system)?, None, Some(note)))
        }
        Some((_, entry)) => {
            let values = entry.list();
            let [first, second] = &values[..] else {
                return Err(entry
                    .diagnostic(format!("`bodies` names {}", values.len()))
                    .with_help("two: `bodies = [\"rigid\", { young = \"70 GPa\", poisson = 0.33 }]`"));
            };
            let pair = Pair { first: read_body(first, system)?, second: read_body(second, system)? };
            let contact_modulus = pair.contact_modulus().map_err(|e| entry.diagnostic(e.to_string()))?;
            Ok((contact_modulus, Some(pair), None))
        }
        None => Err(scene.misspelt_or(&["contact_modulus", "bodies"], scene.diagnostic("[scene] has no material").with_help(
            "add `contact_modulus = \"70 GPa\"` (E* of the pair), or `bodies = [\"rigid\", { young = \"70 GPa\", poisson = 0.33 }]`",
        ))),
    }
}

fn read_body(entry: &Entry<'_>, system: System) -> Read<Body> {
    if entry.is_text() {
        return entry.choice(&[("rigid", Body::Rigid)]);
    }
    let table = entry.table()?;
    let young = table.require("young", "\"70 GPa\"")?.positive(Dimension::PRESSURE, system)?;
    let ratio = table.require("poisson", "0.33")?;
    let poisson = ratio.number()?;
    table.finish()?;
    if !(0.0..=0.5).contains(&poisson) {
        return Err(ratio
            .diagnostic(format!("`poisson` = {poisson}: expected a number in [0, 0.5]"))
            .with_help("0.5 is incompressible"));
    }
    Ok(Body::Elastic { young, poisson })
}

fn read_sampling(
    root: &Entries<'_>,
    scene: &Entries<'_>,
    models: &[(Numerics, Entry<'_>)],
    surface: &SceneSurface,
    notes: &mut Vec<Diagnostic>,
) -> Read<Sampling> {
    let line = models.iter().find(|(m, _)| surface.given_map().is_some() && surface.is_random_for(m));
    let is_random = surface.is_random() || line.is_some();
    let Some((name, entry)) = root.one_of(&["sampling", "chance"])? else {
        if let Some((_, model)) = line {
            return Err(model
                .diagnostic("the line that stands for the map is random and no seed is given")
                .with_help("add [sampling] with `seed = 1`; with `surfaces = 60` there are as many lines"));
        }
        if is_random {
            return Err(scene
                .diagnostic("the surface is random and no seed is given")
                .with_help("add [sampling] with `seed = 1`: the same seed is the same surface"));
        }
        return Ok(Sampling { seed: 0, surfaces: 1 });
    };
    let table = entry.table()?;
    if name == "chance" {
        let note = Diagnostic::note("`[chance]` is now `[sampling]`").at(entry.key_span());
        notes.push(note.with_help("rename the table; its keys are the same"));
    }
    let seed = table.require("seed", "1")?.count(0)?;
    let surfaces = table.find("surfaces");
    if let (Some(entry), false) = (&surfaces, is_random) {
        return Err(entry
            .diagnostic_at_key("`surfaces` is given, but nothing here is random")
            .with_help("remove it: there is one surface"));
    }
    let count = surfaces.as_ref().map_or(Ok(1), |e| e.count(1))?;
    if let (Some(entry), true) = (&surfaces, count > MOST_SURFACES) {
        return Err(entry
            .diagnostic(format!("{count} surfaces: expected at most {MOST_SURFACES}"))
            .with_help("the mean of 1000 surfaces is good to a per cent"));
    }
    table.finish()?;
    Ok(Sampling { seed, surfaces: count as usize })
}

/// Checks that the grid is not given where an accuracy chooses it.
fn check_no_grid(options: Option<&Entries<'_>>) -> Read<()> {
    let Some(entry) = options.and_then(|options| options.entry("bem3d")) else { return Ok(()) };
    let table = entry.table()?;
    for key in ["cells", "rows", "tolerance"] {
        if let Some(given) = table.entry(key) {
            return Err(given
                .diagnostic_at_key(format!("`{key}` is given together with `accuracy`, which chooses it"))
                .with_help("keep one of them"));
        }
    }
    Ok(())
}

/// Checks that no cells are given for a map, which has its own, and that a generated surface has not too
/// many.
fn check_cells(
    options: Option<&Entries<'_>>,
    models: &[(Numerics, Entry<'_>)],
    surface: &SceneSurface,
) -> Read<()> {
    let Some(own) = surface.own_cells() else {
        for (numerics, name) in models {
            let Some(elements) = numerics.boundary_elements() else { continue };
            let cells = elements.grid(surface.size());
            if cells.checked_count().is_none_or(|count| count > MOST_CELLS * MOST_CELLS) {
                let (columns, rows, most) = (cells.columns, cells.rows, MOST_CELLS);
                return Err(name
                    .diagnostic(format!("{columns} x {rows} cells: expected at most {most} x {most}"))
                    .with_help(format!(
                        "give fewer `cells` (columns) or `rows` in [models.{}]; without `rows` cells are nearly square",
                        numerics.name()
                    )));
            }
        }
        return Ok(());
    };
    let Some(options) = options else { return Ok(()) };
    for model in ["bem3d", "equivalent"] {
        let Some(table) = options.entry(model) else { continue };
        for (key, own) in [("cells", own.columns), ("rows", own.rows)] {
            if let Some(cells) = table.table()?.entry(key) {
                return Err(cells
                    .diagnostic_at_key(format!("`{key}` is given, but the map brings its own {own}"))
                    .with_help(
                        "remove it here; `cells` in [scene.surface] averages the map over larger cells",
                    ));
            }
        }
    }
    Ok(())
}

/// Checks that theories of rough surfaces have no body added to a map: its heights are not part of the
/// statistics.
fn check_homogeneous(
    scene: &Entries<'_>,
    models: &[(Numerics, Entry<'_>)],
    surface: &SceneSurface,
) -> Read<()> {
    if surface.own_cells().is_none() || scene.entry("body").is_none() {
        return Ok(());
    }
    let Some((numerics, name)) = models.iter().find(|(m, _)| m.is_statistical()) else { return Ok(()) };
    let message =
        format!("the model {} does not support a map on a body (it takes one or the other)", numerics.name());
    Err(name.diagnostic(message).with_help("remove [scene.body], or the model from `models`"))
}

/// Checks that the loads do not contradict the boundary or the surface.
fn check_request(
    request: &LoadRequest,
    entry: &Entry<'_>,
    surface: &SceneSurface,
    effects: &Effects,
) -> Read<()> {
    let periodic = effects.boundary == Boundary::Periodic;
    let prescribes = |kind: LoadKind, of_step: fn(&NormalLoad) -> bool| match request {
        LoadRequest::Loads(loads) => loads.kind == kind,
        LoadRequest::Path(_) => request.ends().any(|step| of_step(&step.load.normal)),
    };
    if periodic && prescribes(LoadKind::Approach, |load| matches!(load, NormalLoad::Approach(_))) {
        return Err(entry
            .diagnostic_at_key("an approach with periodic boundaries: there is no first touch to count from")
            .with_help(
                "prescribe `force`, `mean_pressure` or `mean_gap`, or remove `boundary = \"periodic\"`",
            ));
    }
    if !periodic && prescribes(LoadKind::MeanGap, |load| matches!(load, NormalLoad::MeanGap(_))) {
        return Err(entry
            .diagnostic_at_key("a mean gap with free boundaries")
            .with_help("prescribe `force` or `approach`, or add `boundary = \"periodic\"` to [effects]"));
    }
    let LoadRequest::Loads(loads) = request else { return Ok(()) };
    match loads.kind {
        LoadKind::ForceBar
            if !surface.is_rough() || matches!(surface, SceneSurface::Drawn { body: Some(_), .. }) =>
        {
            Err(entry
                .diagnostic_at_key(
                    "`force_bar` is normalised by the rms height of a rough surface, which this body does not have",
                )
                .with_help("prescribe `force` or `approach`"))
        }
        _ => Ok(()),
    }
}

/// Checks that nothing is requested of a profile with free boundaries that depends on the zero of the
/// displacements of a half-plane.
fn check_half_plane(
    request: &LoadRequest,
    entry: &Entry<'_>,
    surface: &SceneSurface,
    (effects, requested): (&Effects, &RequestedOutputs),
    places: &Places,
) -> Read<()> {
    if !surface.is_profile() || effects.boundary == Boundary::Periodic {
        return Ok(());
    }
    let why = "displacements under a body uniform along y have no zero at infinity";
    let help = "prescribe `force` or `mean_pressure` and ask for area, pressure or gap; or add `boundary = \"periodic\"` to [effects], where a mean \
                gap and its stiffness have a meaning";
    let by_approach = match request {
        LoadRequest::Loads(loads) => loads.kind == LoadKind::Approach,
        LoadRequest::Path(_) => {
            request.ends().any(|step| matches!(step.load.normal, NormalLoad::Approach(_)))
        }
    };
    if by_approach {
        let message = format!("an approach of a profile with free boundaries: {why}");
        return Err(entry.diagnostic_at_key(message).with_help(help));
    }
    let outputs = &requested.outputs;
    let asked = [
        ("stiffness", outputs.stiffness),
        ("stiffness_fixed_area", outputs.stiffness_fixed_area),
        ("displacement", outputs.displacement),
    ];
    let Some((name, _)) = asked.iter().find(|(_, asked)| *asked) else { return Ok(()) };
    let message = format!("{name} of a profile with free boundaries: {why}");
    Err(Diagnostic::new(message).at(places.of_output(name)).with_help(help))
}

/// Checks that the states to be drawn exist in the scene.
fn check_drawn_states(requested: &RequestedOutputs, request: &LoadRequest) -> Read<()> {
    let count = request.count();
    let Some(state) = requested.drawn_states.iter().flatten().find(|state| **state >= count) else {
        return Ok(());
    };
    Err(Diagnostic::new(format!("state {state} is to be drawn, but there are {count} states"))
        .with_help(format!("numbers of loads or steps from 0 to {}", count.saturating_sub(1))))
}

/// Whether an effect of the boundary elements depends on the path.
pub(crate) fn depends_on_path(effects: &Effects) -> bool {
    effects.hardness != Hardness::Off || effects.adhesion != Adhesion::Off
}

/// Checks that effects with a memory have a path and models that can follow one.
fn check_histories(
    models: &[(Numerics, Entry<'_>)],
    request: &LoadRequest,
    entry: &Entry<'_>,
    effects: &Effects,
) -> Read<()> {
    let remembers = effects.friction != Friction::Off
        || effects.rheology != Rheology::Elastic
        || depends_on_path(effects);
    let path = matches!(request, LoadRequest::Path(_));
    if path && !remembers {
        return Err(entry
            .diagnostic_at_key("a path, but no effect that depends on it")
            .with_help(
                "add `hardness`, `adhesion`, `friction` or `rheology` to [effects], or prescribe `force` or `approach`",
            ));
    }
    // Time and tangential loads are part of a path only.
    let needs_path = effects.friction != Friction::Off || effects.rheology != Rheology::Elastic;
    for (numerics, model) in models {
        let follows = |numerics: &Numerics| numerics.model().abilities().paths != Paths::Forgotten;
        if follows(numerics) && needs_path && !path {
            return Err(entry
                .diagnostic_at_key(format!("\"{}\" follows a path, and here are loads one by one", numerics.name()))
                .with_help("write [[scene.path]] with `time`, `force` (or `approach`) and `tangential_force` for each step"));
        }
        if !follows(numerics) && path {
            let has_effects = |m: &Numerics| {
                let abilities = m.model().abilities();
                effects.named().all(|effect| abilities.effects.contains(&effect))
            };
            let known: Vec<&str> =
                Numerics::all().filter(|m| follows(m) && has_effects(m)).map(|m| m.name()).collect();
            return Err(model
                .diagnostic(format!("\"{}\" answers loads one by one and follows no path", numerics.name()))
                .with_help(format!("models that follow a path with these effects: {}", known.join(", "))));
        }
    }
    Ok(())
}

/// Checks that a tangential load along y is given only to models that take both directions.
fn check_tangential(models: &[(Numerics, Entry<'_>)], request: &LoadRequest, effects: &Effects) -> Read<()> {
    let both = |numerics: &Numerics| numerics.model().abilities().directions == Directions::Plane;
    let Some((numerics, model)) = models.iter().find(|(numerics, _)| !both(numerics)) else { return Ok(()) };
    let [_, along_y] = request.shears();
    if !along_y {
        return Ok(());
    }
    let has_effects = |numerics: &Numerics| {
        let abilities = numerics.model().abilities();
        effects.named().all(|effect| abilities.effects.contains(&effect))
    };
    let known: Vec<&str> = Numerics::all().filter(|m| both(m) && has_effects(m)).map(|m| m.name()).collect();
    let help = match &known[..] {
        [] => "give one value along x: no model has both components with these effects".to_owned(),
        known => format!("give one value along x; models with both components: {}", known.join(", ")),
    };
    Err(model
        .diagnostic(format!("\"{}\" takes tangential loads along x alone", numerics.name()))
        .with_help(help))
}

/// Checks that the coupling of normal and tangential tractions is given, where these bodies couple and a
/// model can either neglect or solve it.
fn check_coupling(
    models: &[(Numerics, Entry<'_>)],
    pair: Option<&Pair>,
    friction: Friction,
    place: Option<Range<usize>>,
) -> Read<()> {
    let asks = |(numerics, _): &&(Numerics, Entry<'_>)| {
        numerics.model().abilities().effects.contains(&Effect::FullCoupling)
    };
    let (Some(pair), Some((numerics, _))) = (pair, models.iter().find(asks)) else { return Ok(()) };
    match friction.coupling_of(pair) {
        Err(contact_model::Error::Domain { value, .. }) => {
            let message = format!(
                "normal and tangential tractions of these bodies act on each other (second Dundurs constant {}), and {} can neglect it or solve it",
                short(value),
                numerics.name()
            );
            Err(Diagnostic::new(message).at(place).with_help(
                "`coupling = \"none\"` in `friction` neglects it, `coupling = \"full\"` solves both together",
            ))
        }
        _ => Ok(()),
    }
}

/// Columns and rows of boundary elements, elements of a line: a given map brings its own cells.
pub(crate) fn cells(scene: &SceneFile, numerics: &Numerics) -> Cells {
    match (scene.surface.own_cells(), numerics.boundary_elements()) {
        (Some(own), _) => own,
        (None, Some(elements)) => elements.grid(scene.surface.size()),
        (None, None) => Cells { columns: numerics.size(), rows: 1 },
    }
}
