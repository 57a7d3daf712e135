//! A scene as it is read from a file.

use crate::scenes::read::key::missing;
use crate::scenes::read::loads::{AskedLoads, check_signs};
use crate::scenes::read::numerics::print_options;
use crate::scenes::read::outputs::DRAWN_STATES;
use crate::scenes::read::path::pieces;
use crate::scenes::read::question::{AskedSampling, Material, read_question};
use crate::scenes::read::scene_surface::{FoundSurface, find_surface};
use crate::scenes::read::{
    Diagnostic, Entries, Error, FilmMaterial, LoadRequest, MOST_CELLS, Numerics, Places, PrescribedLoad,
    Question, ReadResult, Registry, RequestedAccuracy, RequestedOutputs, Result, SceneSurface, System,
    nearest, short,
};
use contact_model::{
    Adhesion, Body, Boundary, Cells, Conductance, Directions, Effect, Effects, Friction, Hardness,
    InterfaceOutput, NormalLoad, Output, Pair, Paths, Rheology, Scene, Size, Surface,
};
use std::io::Read as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use surface_statistics::FilledPoints;

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
    /// The smooth body whose heights are part of those of a map; a random surface has its own.
    pub(crate) added_body: Option<Surface>,
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
    /// Points of the surface's map that were filled, where some were: statistics take them into account.
    pub filled: Option<FilledPoints>,
    /// Remarks on the file, such as keys that have a new name.
    pub notes: Vec<Diagnostic>,
    /// Whether the grid was chosen for an accuracy by an estimated error that no finer grid confirms.
    pub(crate) is_unconfirmed: bool,
    places: Places,
}

/// The mistake of a path of a scene that does not exist, where a file of nearly this name lies beside it.
fn misspelt_file(path: &Path) -> Option<Error> {
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let names: Vec<String> = entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| *name != wanted)
        .collect();
    let found = nearest(&wanted, names.iter().map(String::as_str))?;
    let reason = format!("there is no file {}: did you mean {found}, which lies there?", path.display());
    Some(Error::Argument { name: "scene", reason })
}

/// The mistake of a map or of a table of results in the place of a scene.
fn map_in_place_of_scene(path: &Path) -> Option<Diagnostic> {
    let file = path.display();
    let mut beginning = Vec::new();
    std::fs::File::open(path).ok()?.take(1 << 10).read_to_end(&mut beginning).ok()?;
    if String::from_utf8_lossy(&beginning).contains("\n# column ") {
        let help = format!("`fractal-contact info {file}` describes them");
        return Some(Diagnostic::new("these are results and no scene").with_help(help));
    }
    let scan = surface_io::SurfaceFile::open(path, &surface_io::ReadOptions::default()).ok()?.scan().ok()?;
    let about = scan.metadata();
    let message = format!("this is a map of {} x {} heights and no scene", about.columns, about.rows);
    let help = format!(
        "`fractal-contact press {file}` computes its contact and says what else it needs; `fractal-contact info {file}` describes it"
    );
    Some(Diagnostic::new(message).with_help(help))
}

/// `[sampling]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// The master seed.
    pub seed: u64,
    /// Number of surfaces drawn from it.
    pub surfaces: usize,
}

impl SceneFile {
    /// A scene built in code, in any consistent units: no effects, no outputs, one surface of seed 0.
    /// Messages then have no line.
    ///
    /// ```
    /// use contact_model::Surface;
    /// use fractal_contact::scenes::{LoadRequest, LoadList, Numerics, Plan, PrescribedLoad, SceneFile, SceneSurface};
    /// let body = SceneSurface::Plain(Surface::Sphere { radius: 1.0, size: 4.0.into() });
    /// let loads = LoadRequest::Loads(LoadList { kind: PrescribedLoad::Force, values: vec![0.1, 1.0] });
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
            added_body: None,
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
            filled: None,
            notes: Vec::new(),
            is_unconfirmed: false,
            places: Places::default(),
        }
    }

    /// The smooth body, alone or below the roughness.
    pub(crate) fn body(&self) -> Option<&Surface> {
        match &self.surface {
            SceneSurface::Drawn { body, .. } => body.as_ref(),
            SceneSurface::Plain(Surface::Heights(_)) => self.added_body.as_ref(),
            SceneSurface::Plain(Surface::SelfAffine(_) | Surface::Profile(_) | Surface::Line { .. }) => None,
            SceneSurface::Plain(body) => Some(body),
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
        let about = match std::fs::metadata(path) {
            Ok(about) => about,
            Err(reason) => {
                return Err(
                    misspelt_file(path).unwrap_or_else(|| runs::Error::file("read", path)(reason).into())
                );
            }
        };
        if path.extension().is_none_or(|ending| ending != "toml")
            && about.is_file()
            && let Some(map) = map_in_place_of_scene(path)
        {
            return Err(map.placed(path, "").into());
        }
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
            let (question, mut notes) = read_question(&root, registry.models())?;
            let scene = Self::answered(question, path, root.places())?;
            notes.extend(scene.notes);
            Ok(Self { notes, ..scene })
        };
        let scene = Entries::of_text("", &text, read);
        scene
            .map_err(|diagnostic| diagnostic.placed(path, &text).into())
            .map(|scene| scene.of_text(path, text))
    }

    /// The scene of a question; files that it names are looked up from the folder of `path`, where the scene is
    /// said to stand. Its text is that of [`Question::to_toml`].
    ///
    /// # Errors
    /// As [`SceneFile::parse`].
    pub fn of(question: Question, path: &Path) -> Result<Self> {
        let text = question.to_toml();
        Self::of_printed(question, path, text)
    }

    /// The same of a question that was printed with comments ([`Question::printed`]).
    ///
    /// # Errors
    /// As [`SceneFile::parse`].
    pub fn of_printed(question: Question, path: &Path, text: String) -> Result<Self> {
        // The places of its keys in this text, for messages.
        let places = Entries::of_text("", &text, |root| Ok(root.places())).unwrap_or_default();
        let scene = Self::answered(question, path, places);
        scene
            .map_err(|diagnostic| diagnostic.placed(path, &text).into())
            .map(|scene| scene.of_text(path, text))
    }

    /// With its file and the text of that.
    fn of_text(mut self, path: &Path, text: String) -> Self {
        path.clone_into(&mut self.path);
        self.notes = self.notes.into_iter().map(|note| note.placed(path, &text)).collect();
        self.text = text;
        self
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
        let place = self.places.value(&format!("scene.models.{index}"));
        self.placed(diagnostic, place.or_else(|| self.places.value("scene.models")))
    }

    /// A mistake of an output.
    pub(crate) fn at_output(&self, name: &str, diagnostic: Diagnostic) -> Diagnostic {
        self.placed(diagnostic, self.places.key(&format!("outputs.{name}")))
    }

    /// A mistake of an effect.
    pub(crate) fn at_effect(&self, name: &str, diagnostic: Diagnostic) -> Diagnostic {
        self.placed(diagnostic, self.places.key(&format!("effects.{name}")))
    }

    /// A mistake of the requested accuracy.
    pub(crate) fn at_accuracy(&self, diagnostic: Diagnostic) -> Diagnostic {
        self.placed(diagnostic, self.places.key("scene.accuracy"))
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

/// The material of both bodies. The second one is that of a layer, where there is one, and the first the one that
/// presses on it.
fn with_layer(
    material: Option<Material>,
    effects: &Effects,
    places: &Places,
) -> ReadResult<Option<Material>> {
    let Some(layer) = effects.layer else { return Ok(material) };
    let second = Body::Elastic { young: layer.young, poisson: layer.poisson };
    let first = match material {
        None => Body::Rigid,
        Some(Material::Bodies(Pair { first: Body::Rigid, second: pressing })) => pressing,
        Some(Material::Bodies(_)) => {
            let wrong = places.at_value("scene.bodies", "`bodies` names two elastic bodies beside a `layer`");
            return Err(wrong.with_help(
                "name the one that presses on the layer; the other one is the layer on its base",
            ));
        }
        Some(Material::ContactModulus(_)) => {
            let wrong = places.at_key("scene.contact_modulus", "`contact_modulus` is given beside a `layer`");
            return Err(wrong.with_help(
                "remove it: E* follows from the layer, and from the body in `bodies` if that is not rigid",
            ));
        }
    };
    Ok(Some(Material::Bodies(Pair { first, second })))
}

impl SceneFile {
    /// The scene of a question, checked as far as that is possible without a model.
    fn answered(question: Question, path: &Path, places: Places) -> ReadResult<Self> {
        let Question { units: system, material, accuracy, effects, hardness, .. } = question;
        if question.models.is_empty() {
            return Err(missing("scene", "models", "[\"bem3d\"]", &places));
        }
        let (contact_modulus, pair) = match with_layer(material, &effects, &places)? {
            Some(Material::ContactModulus(modulus)) => (modulus, None),
            Some(Material::Bodies(pair)) => {
                let wrong = |error: contact_model::Error| places.at_value("scene.bodies", error.to_string());
                (pair.contact_modulus().map_err(wrong)?, Some(pair))
            }
            None => {
                return Err(places.at_key("scene", "[scene] has no material").with_help(
                    "add `contact_modulus = \"70 GPa\"` (E* of the pair), or `bodies = [\"rigid\", { young = \"70 GPa\", poisson = 0.33 }]`",
                ));
            }
        };
        if hardness.is_some() && effects.hardness != Hardness::Off {
            return Err(places
                .at_key("scene.hardness", "`hardness` is given in [scene] and in [effects]")
                .with_help(
                    "keep that of [effects], which limits the pressure; that of [scene] only marks states",
                ));
        }
        let directory = path.parent().unwrap_or(Path::new(""));
        let FoundSurface { surface, added_body, metadata, reliable_from, filled, notes } =
            find_surface(&question, directory, &places)?;
        check_cells(&question, &surface, &places)?;
        if accuracy.is_some() {
            check_no_grid(&question, &places)?;
        }
        check_homogeneous(&question, &surface, &places)?;
        let request = request(&question, surface.size(), &places)?;
        let sampling = sampling(&question, &surface, &places)?;
        let mut requested = question.outputs;
        requested.request_what_files_need();
        requested.outputs.traction |=
            requested.interface.stress_below.is_some() && effects.friction != Friction::Off;
        let mut scene = Self {
            system,
            added_body,
            hardness,
            accuracy,
            pair,
            effects,
            requested,
            sampling,
            metadata,
            reliable_from,
            filled,
            notes,
            ..Self::new(question.models, surface, contact_modulus, request)
        };
        check_request(&scene, &places)?;
        check_half_plane(&scene, &places)?;
        check_drawn_states(&scene.requested, &scene.request)
            .map_err(|error| error.at(places.key(&format!("outputs.{DRAWN_STATES}"))))?;
        check_histories(&scene, &places)?;
        check_tangential(&scene, &places)?;
        check_coupling(&scene, &places)?;
        check_interface(&scene, &places)?;
        check_thresholds_and_law(&scene, &places)?;
        scene.places = places;
        Ok(scene)
    }
}

/// The loads or the path.
fn request(question: &Question, size: Size, places: &Places) -> ReadResult<LoadRequest> {
    let pulls = question.effects.adhesion != Adhesion::Off;
    match &question.loads {
        Some(AskedLoads::Loads(loads)) => {
            check_signs(loads, question.units, pulls, places)?;
            Ok(LoadRequest::Loads(loads.clone()))
        }
        Some(AskedLoads::Path(steps)) => Ok(LoadRequest::Path(pieces(steps, pulls, size, places)?)),
        None => Err(places
            .at_key("scene", "nothing is pressed: [scene] has no load")
            .with_help("add `force = \"1 N\"`, `approach = [...]`, `force_bar = { from = 1e-4, to = 1, count = 9 }`, or [[scene.path]] for a history")),
    }
}

/// The key of the loads or of the path.
fn request_key(request: &LoadRequest) -> String {
    match request {
        LoadRequest::Loads(loads) => format!("scene.{}", loads.kind.key()),
        LoadRequest::Path(_) => "scene.path".to_owned(),
    }
}

/// A mistake at the name of a model.
fn at_model(places: &Places, index: usize, message: String) -> Diagnostic {
    let item = places.value(&format!("scene.models.{index}"));
    Diagnostic::new(message).at(item.or_else(|| places.value("scene.models")))
}

fn sampling(question: &Question, surface: &SceneSurface, places: &Places) -> ReadResult<Sampling> {
    const SURFACES: &str = "sampling.surfaces";
    let is_line = |model: &Numerics| surface.given_map().is_some() && surface.is_random_for(model);
    let line = question.models.iter().position(is_line);
    let is_random = surface.is_random() || line.is_some();
    let Some(AskedSampling { seed, surfaces }) = question.sampling else {
        if let Some(model) = line {
            let message = "the line that stands for the map is random and no seed is given".to_owned();
            return Err(at_model(places, model, message)
                .with_help("add [sampling] with `seed = 1`; with `surfaces = 60` there are as many lines"));
        }
        if is_random {
            return Err(places
                .at_key("scene", "the surface is random and no seed is given")
                .with_help("add [sampling] with `seed = 1`: the same seed is the same surface"));
        }
        return Ok(Sampling { seed: 0, surfaces: 1 });
    };
    let seed = seed.ok_or_else(|| missing("sampling", "seed", "1", places))?;
    if surfaces.is_some() && !is_random {
        return Err(places
            .at_key(SURFACES, "`surfaces` is given, but nothing here is random")
            .with_help("remove it: there is one surface"));
    }
    let count = surfaces.unwrap_or(1);
    if count > MOST_SURFACES {
        return Err(places
            .at_value(SURFACES, format!("{count} surfaces: expected at most {MOST_SURFACES}"))
            .with_help("the mean of 1000 surfaces is good to a per cent"));
    }
    Ok(Sampling { seed, surfaces: count as usize })
}

/// Whether a key of the numerics of a model is given: in the text, or with another value than its default.
fn is_given(model: &Numerics, key: &str, places: &Places) -> bool {
    places.has(&format!("models.{}.{key}", model.name()))
        || print_options(model).iter().any(|(name, _)| *name == key)
}

/// Checks that the grid is not given where an accuracy chooses it.
fn check_no_grid(question: &Question, places: &Places) -> ReadResult<()> {
    let Some(model) = question.models.iter().find(|model| matches!(model, Numerics::Bem3d(_))) else {
        return Ok(());
    };
    match ["cells", "rows", "tolerance"].into_iter().find(|key| is_given(model, key, places)) {
        Some(key) => {
            let message = format!("`{key}` is given together with `accuracy`, which chooses it");
            Err(places.at_key(&format!("models.bem3d.{key}"), message).with_help("keep one of them"))
        }
        None => Ok(()),
    }
}

/// Checks that no cells are given for a map, which has its own, and that a generated surface has not too
/// many.
fn check_cells(question: &Question, surface: &SceneSurface, places: &Places) -> ReadResult<()> {
    for (index, numerics) in question.models.iter().enumerate() {
        let Some(elements) = numerics.boundary_elements() else { continue };
        let name = numerics.name();
        let Some(own) = surface.own_cells() else {
            let cells = elements.grid(surface.size());
            if cells.checked_count().is_none_or(|count| count as f64 > (MOST_CELLS as f64).powi(2)) {
                let (columns, rows, most) = (cells.columns, cells.rows, MOST_CELLS);
                let message = format!("{columns} x {rows} cells: expected at most {most} x {most}");
                return Err(at_model(places, index, message).with_help(format!(
                    "give fewer `cells` (columns) or `rows` in [models.{name}]; without `rows` cells are nearly square"
                )));
            }
            continue;
        };
        for (key, own) in [("cells", own.columns), ("rows", own.rows)] {
            if is_given(numerics, key, places) {
                return Err(places
                    .at_key(
                        &format!("models.{name}.{key}"),
                        format!("`{key}` is given, but the map brings its own {own}"),
                    )
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
fn check_homogeneous(question: &Question, surface: &SceneSurface, places: &Places) -> ReadResult<()> {
    if surface.own_cells().is_none() || question.body.is_none() {
        return Ok(());
    }
    let Some(model) = question.models.iter().position(Numerics::is_statistical) else { return Ok(()) };
    let name = question.models[model].name();
    let message = format!("the model {name} does not support a map on a body (it takes one or the other)");
    Err(at_model(places, model, message).with_help("remove [scene.body], or the model from `models`"))
}

/// Checks that the loads do not contradict the boundary or the surface.
fn check_request(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let SceneFile { request, surface, effects, .. } = scene;
    let key = request_key(request);
    let periodic = effects.boundary == Boundary::Periodic;
    let prescribes = |kind: PrescribedLoad, of_step: fn(&NormalLoad) -> bool| match request {
        LoadRequest::Loads(loads) => loads.kind == kind,
        LoadRequest::Path(_) => request.ends().any(|step| of_step(&step.load.normal)),
    };
    if periodic && prescribes(PrescribedLoad::Approach, |load| matches!(load, NormalLoad::Approach(_))) {
        return Err(places
            .at_key(&key, "an approach with periodic boundaries: there is no first touch to count from")
            .with_help(
                "prescribe `force`, `mean_pressure` or `mean_gap`, or remove `boundary = \"periodic\"`",
            ));
    }
    if !periodic && prescribes(PrescribedLoad::MeanGap, |load| matches!(load, NormalLoad::MeanGap(_))) {
        return Err(places
            .at_key(&key, "a mean gap with free boundaries")
            .with_help("prescribe `force` or `approach`, or add `boundary = \"periodic\"` to [effects]"));
    }
    let LoadRequest::Loads(loads) = request else { return Ok(()) };
    match loads.kind {
        PrescribedLoad::ForceBar
            if !surface.is_rough() || matches!(surface, SceneSurface::Drawn { body: Some(_), .. }) =>
        {
            Err(places
                .at_key(
                    &key,
                    "`force_bar` is normalised by the rms height of a rough surface, which this body does not have",
                )
                .with_help("prescribe `force` or `approach`"))
        }
        _ => Ok(()),
    }
}

/// Checks that nothing is requested of a contact that goes on along a line, of a profile with free boundaries or of a
/// map that is periodic along one direction, that depends on the zero of the displacements.
fn check_half_plane(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let SceneFile { request, surface, effects, requested, .. } = scene;
    let is_line = match effects.boundary.repeats() {
        [true, true] => false,
        [false, false] => surface.is_profile(),
        _ => true,
    };
    if !is_line {
        return Ok(());
    }
    let what = if surface.is_profile() {
        "a profile with free boundaries"
    } else {
        "a map that is periodic along one direction"
    };
    let why = "displacements under a contact that goes on along a line have no zero at infinity";
    let help = "prescribe `force` or `mean_pressure` and ask for area, pressure or gap; or add `boundary = \"periodic\"` to [effects], where a mean \
                gap and its stiffness have a meaning";
    let by_approach = match request {
        LoadRequest::Loads(loads) => loads.kind == PrescribedLoad::Approach,
        LoadRequest::Path(_) => {
            request.ends().any(|step| matches!(step.load.normal, NormalLoad::Approach(_)))
        }
    };
    if by_approach {
        let message = format!("an approach of {what}: {why}");
        return Err(places.at_key(&request_key(request), message).with_help(help));
    }
    let outputs = &requested.outputs;
    let asked = [
        ("stiffness", outputs.stiffness),
        ("stiffness_fixed_area", outputs.stiffness_fixed_area),
        ("displacement", outputs.displacement),
    ];
    let Some((name, _)) = asked.iter().find(|(_, asked)| *asked) else { return Ok(()) };
    let message = format!("{name} of {what}: {why}");
    Err(places.at_key(&format!("outputs.{name}"), message).with_help(help))
}

/// Checks that the states to be drawn exist in the scene.
fn check_drawn_states(requested: &RequestedOutputs, request: &LoadRequest) -> ReadResult<()> {
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
fn check_histories(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let SceneFile { models, request, effects, .. } = scene;
    let key = request_key(request);
    let remembers = effects.friction != Friction::Off
        || effects.rheology != Rheology::Elastic
        || depends_on_path(effects);
    let path = matches!(request, LoadRequest::Path(_));
    if path && !remembers {
        return Err(places
            .at_key(&key, "a path, but no effect that depends on it")
            .with_help(
                "add `hardness`, `adhesion`, `friction` or `rheology` to [effects], or prescribe `force` or `approach`",
            ));
    }
    // Time and tangential loads are part of a path only.
    let needs_path = effects.friction != Friction::Off || effects.rheology != Rheology::Elastic;
    for (index, numerics) in models.iter().enumerate() {
        let follows = |numerics: &Numerics| numerics.model().abilities().paths != Paths::Forgotten;
        if follows(numerics) && needs_path && !path {
            let message = format!("\"{}\" follows a path, and here are loads one by one", numerics.name());
            return Err(places
                .at_key(&key, message)
                .with_help("write [[scene.path]] with `time`, `force` (or `approach`) and `tangential_force` for each step"));
        }
        if !follows(numerics) && path {
            let has_effects = |m: &Numerics| {
                let abilities = m.model().abilities();
                effects.named().all(|effect| abilities.effects.contains(&effect))
            };
            let known: Vec<&str> =
                Numerics::all().filter(|m| follows(m) && has_effects(m)).map(|m| m.name()).collect();
            let message = format!("\"{}\" answers loads one by one and follows no path", numerics.name());
            return Err(at_model(places, index, message)
                .with_help(format!("models that follow a path with these effects: {}", known.join(", "))));
        }
    }
    Ok(())
}

/// Checks that a tangential load along y is given only to models that take both directions.
fn check_tangential(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let SceneFile { models, request, effects, .. } = scene;
    let both = |numerics: &Numerics| numerics.model().abilities().directions == Directions::Plane;
    let Some(model) = models.iter().position(|numerics| !both(numerics)) else { return Ok(()) };
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
    let message = format!("\"{}\" takes tangential loads along x alone", models[model].name());
    Err(at_model(places, model, message).with_help(help))
}

/// Checks that the coupling of normal and tangential tractions is given, where these bodies couple and a
/// model can either neglect or solve it.
fn check_coupling(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let SceneFile { models, pair, effects, .. } = scene;
    let asks = |numerics: &&Numerics| numerics.model().abilities().effects.contains(&Effect::FullCoupling);
    let (Some(pair), Some(numerics)) = (pair, models.iter().find(asks)) else { return Ok(()) };
    match effects.friction.coupling_of(pair) {
        Err(contact_model::Error::Domain { value, .. }) => {
            let message = format!(
                "normal and tangential tractions of these bodies act on each other (second Dundurs constant {}), and {} can neglect it or solve it",
                short(value),
                numerics.name()
            );
            Err(places.at_key("effects.friction", message).with_help(
                "`coupling = \"none\"` in `friction` neglects it, `coupling = \"full\"` solves both together",
            ))
        }
        _ => Ok(()),
    }
}

const LEAKAGE_EXAMPLE: &str =
    "add `leakage = { viscosity = \"1 mPa s\", pressure_drop = \"1 bar\", along = \"x\" }` to [outputs]";
const FILM_EXAMPLE: &str = "add `conductance = { kind = \"electrical\", resistivities = [\"1e-7 Ohm m\", \"1e-7 Ohm m\"] }` to [outputs]";
const FILM_EXAMPLE_OF_HEAT: &str = "add `conductance = { kind = \"thermal\", conductivities = [\"50 W/(m K)\", \"50 W/(m K)\"] }` to [outputs]";
const STRESS_EXAMPLE: &str = "add `stress_below = { depths = [\"1 um\", \"2 um\", \"5 um\"] }` to [outputs]";

/// Checks that the loads at which something begins, and the law of the interface, can be found in the scene.
fn check_thresholds_and_law(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let (outputs, requested) = (&scene.requested, &scene.requested.interface);
    let refused = |key: &str, message: String, help: &str| {
        Err(places.at_key(&format!("outputs.{key}"), message).with_help(help.to_owned()))
    };
    if outputs.thresholds.is_some() {
        let yields = requested.stress_below.as_ref().is_some_and(|stress| stress.yield_stress.is_some());
        if !requested.percolation && !yields {
            let message = "`thresholds` without anything that begins at some load".to_owned();
            return refused(
                "thresholds",
                message,
                "add `percolation = true`, or a `yield_stress` to `stress_below`",
            );
        }
        if matches!(scene.request, LoadRequest::Path(_)) {
            let message =
                "`thresholds` along a path: further loads between its steps would change it".to_owned();
            return refused("thresholds", message, "prescribe loads in a list, such as `mean_pressure`");
        }
    }
    if outputs.law {
        if scene.effects.boundary != Boundary::Periodic {
            let message = "the law of an interface with free boundaries: it has no mean gap".to_owned();
            return refused("law", message, "add `boundary = \"periodic\"` to [effects]");
        }
        if matches!(scene.request, LoadRequest::Path(_)) {
            let message = "the law of an interface along a path: it would depend on the path".to_owned();
            return refused("law", message, "prescribe `mean_pressure` or `mean_gap` in a list");
        }
    }
    Ok(())
}

/// Checks that leakage, paths and the stress below the surface can be computed in the scene.
fn check_interface(scene: &SceneFile, places: &Places) -> ReadResult<()> {
    let (outputs, requested) = (&scene.requested, &scene.requested.interface);
    let refused = |key: &str, message: String, help: &str| {
        Err(places.at_key(&format!("outputs.{key}"), message).with_help(help.to_owned()))
    };
    for output in requested.outputs() {
        let needed: &[Output] = match output {
            InterfaceOutput::StressBelow | InterfaceOutput::YieldStress => &[Output::Pressure],
            _ => &[Output::Pressure, Output::Gap],
        };
        let lacking = |numerics: &Numerics| {
            let known = numerics.model().abilities().outputs;
            Some((numerics.name(), needed.iter().find(|field| !known.contains(field))?.name()))
        };
        if let Some((model, field)) = scene.models.iter().find_map(lacking) {
            let key = output.key();
            let message =
                format!("`{key}` needs the {field} of each cell, which the model {model} does not compute");
            return refused(key, message, "boundary elements do: `models = [\"bem3d\"]`");
        }
    }
    let (no_fluid, no_stress) = (requested.leakage.is_none(), requested.stress_below.is_none());
    for (key, formats, lacks, missing, example) in [
        ("fluid_pressure", &outputs.fluid_pressure, no_fluid, "leakage", LEAKAGE_EXAMPLE),
        ("flux", &outputs.flux, no_fluid, "leakage", LEAKAGE_EXAMPLE),
        ("von_mises", &outputs.von_mises, no_stress, "stress_below", STRESS_EXAMPLE),
        ("stress_section", &outputs.stress_section, no_stress, "stress_below", STRESS_EXAMPLE),
        ("stress_volume", &outputs.stress_volume, no_stress, "stress_below", STRESS_EXAMPLE),
    ] {
        if lacks && !formats.is_empty() {
            return refused(key, format!("`{key}` is requested without `{missing}`"), example);
        }
    }
    if let Some(film) = requested.film {
        let (key, help) = match film.material {
            FilmMaterial::Resistivity(_) => ("resistivity", FILM_EXAMPLE),
            FilmMaterial::Conductivity(_) => ("conductivity", FILM_EXAMPLE_OF_HEAT),
        };
        let has_bodies = matches!(
            (film.material, outputs.outputs.conductance),
            (FilmMaterial::Resistivity(_), Conductance::Electrical { .. })
                | (FilmMaterial::Conductivity(_), Conductance::Thermal { .. })
        );
        if !has_bodies {
            let message =
                format!("a film with a {key} without the `conductance` of the same kind of both bodies");
            return refused("film", message, help);
        }
    }
    let undefined = scene.surface.given_map().map_or(0, |map| map.undefined());
    for (key, is_requested) in [("leakage", requested.leakage.is_some()), ("film", requested.film.is_some())]
    {
        if is_requested && undefined > 0 {
            let message =
                format!("`{key}` of a map with {undefined} undefined points, whose gap is not known");
            return refused(key, message, "fill them with `fill` in [scene.surface], or crop the map");
        }
    }
    if scene.surface.is_profile() && !requested.outputs().is_empty() {
        let key = requested.outputs()[0].key();
        let message = format!("`{key}` of a profile: it needs a map with several rows");
        return refused(key, message, "remove it, or press a map");
    }
    let Some(stress) = &requested.stress_below else { return Ok(()) };
    if scene.effects.layer.is_some() {
        let message = "the stress below the surface of a layer is not known here".to_owned();
        return refused("stress_below", message, "remove `layer` or `stress_below`");
    }
    for (key, what, formats) in [
        ("stress_section", "section", &outputs.stress_section),
        ("stress_volume", "volume", &outputs.stress_volume),
    ] {
        if !formats.is_empty() && !stress.depths.iter().any(|depth| *depth > 0.0) {
            let message = format!("a {what} down to the depth 0: `stress_below` names no other one");
            return refused(key, message, "add the depth down to which it goes to `depths`");
        }
    }
    let body = stress.of_body(scene.pair, scene.effects.friction);
    body.map(|_| ()).map_err(|wrong| wrong.at(places.key("outputs.stress_below")))
}

/// Columns and rows of boundary elements, elements of a line: a given map brings its own cells.
pub(crate) fn cells(scene: &SceneFile, numerics: &Numerics) -> Cells {
    match (scene.surface.own_cells(), numerics.boundary_elements()) {
        (Some(own), _) => own,
        (None, Some(elements)) => elements.grid(scene.surface.size()),
        (None, None) => Cells { columns: numerics.size(), rows: 1 },
    }
}
