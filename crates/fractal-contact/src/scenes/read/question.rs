//! A question: everything that a scene says, as typed values. TOML and the flags of `press` are two ways to
//! write one; a [`crate::scenes::SceneFile`] is a question whose surface was read.

use crate::scenes::read::accuracy_target::ACCURACY_KEYS;
use crate::scenes::read::asked_surface::{
    AskedBody, AskedFile, AskedSecond, AskedSelfAffine, AskedSurface, BODY_KEYS, FILE_KEYS, SECOND_KEYS,
    SELF_AFFINE_KEYS,
};
use crate::scenes::read::key::{Context, Key, KeyTable, SceneKey};
use crate::scenes::read::load_kind::PrescribedLoad;
use crate::scenes::read::loads::{AskedLoads, print_loads, read_loads};
use crate::scenes::read::numerics::{self, print_options, read_models};
use crate::scenes::read::outputs::{OUTPUT_KEYS, print_outputs, set_output};
use crate::scenes::read::path::{AskedStep, PATH_KEYS, read_steps};
use crate::scenes::read::{
    Diagnostic, Distributed, EFFECT_KEYS, Entries, Entry, FieldFormat, Numerics, ReadResult, RegisteredModel,
    RequestedAccuracy, RequestedOutputs, System, nearest, other_words, printed, read_effects, read_outputs,
};
use contact_model::{Body, Effects, Friction, Output, Pair};
use std::fmt::Write as _;
use surface_io::{Dimension, Quantity};

/// Everything that a scene says. A part that a scene has to name is `None` until it is named.
///
/// ```
/// use fractal_contact::scenes::Question;
/// let text = "[scene]\nmodels = [\"hertz\"]\ncontact_modulus = \"70 GPa\"\nforce = \"1 N\"\n\
///             [scene.body]\nkind = \"sphere\"\nradius = \"10 mm\"\nside = \"2 mm\"\n";
/// let mut question = Question::parse(text)?;
/// question.effects.hardness = fractal_contact::Hardness::Limit { pressure: 1e9 };
/// assert!(question.to_toml().contains("hardness = { pressure = \"1 GPa\" }"));
/// assert_eq!(Question::parse(&question.to_toml())?, question);
/// # Ok::<(), fractal_contact::scenes::Diagnostic>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Question {
    /// Whether numbers carry units.
    pub units: System,
    /// The models in the order of the results, with their numerics.
    pub models: Vec<Numerics>,
    /// The material of the pair.
    pub material: Option<Material>,
    /// Pressure above which a state has a note.
    pub hardness: Option<f64>,
    /// The accuracy for which the grid is chosen.
    pub accuracy: Option<RequestedAccuracy>,
    /// The loads or the path.
    pub loads: Option<AskedLoads>,
    /// The surface.
    pub surface: Option<AskedSurface>,
    /// The surface of the second body, which is added to a measured one.
    pub second_surface: Option<AskedSecond>,
    /// A body, alone or added to the surface.
    pub body: Option<AskedBody>,
    /// Effects, off unless named.
    pub effects: Effects,
    /// What is computed and stored.
    pub outputs: RequestedOutputs,
    /// Seed and number of surfaces.
    pub sampling: Option<AskedSampling>,
}

/// The material of a pair of bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// E* of the pair.
    ContactModulus(f64),
    /// Both bodies.
    Bodies(Pair),
}

/// `[sampling]`, by the keys that are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AskedSampling {
    /// The master seed.
    pub seed: Option<u64>,
    /// Number of surfaces drawn from it.
    pub surfaces: Option<u64>,
}

impl Default for Question {
    /// Nothing is asked, in SI units.
    fn default() -> Self {
        Self {
            units: System::Si,
            models: Vec::new(),
            material: None,
            hardness: None,
            accuracy: None,
            loads: None,
            surface: None,
            second_surface: None,
            body: None,
            effects: Effects::default(),
            outputs: RequestedOutputs::default(),
            sampling: None,
        }
    }
}

/// Keys of `[scene]`.
static SCENE_KEYS: KeyTable<Question> = KeyTable {
    name: "scene",
    kind: "",
    alternatives: &[
        &["contact_modulus", "modulus", "bodies"],
        &["force", "force_bar", "mean_pressure", "approach", "mean_gap"],
    ],
    everyday: &["contact_modulus", "bodies", "mean_pressure", "force", "approach"],
    keys: &[
        Key {
            name: "units",
            takes: "`\"si\"` or `\"none\"`",
            about: "whether every dimensional number has its unit, or numbers are plain and in any consistent units",
            default: "`\"si\"`",
            read: |question, entry, _| entry.choice(&SYSTEMS).map(|units| question.units = units),
            print: |question, _| (question.units == System::None).then(|| printed::text("none")),
        },
        Key {
            name: "models",
            takes: "names",
            about: "the [models](models.md), in the order of the results",
            default: "",
            read: |question, entry, context| {
                read_models(entry, context.own).map(|models| question.models = models)
            },
            print: |question, _| {
                let names: Vec<String> =
                    question.models.iter().map(|model| printed::text(model.name())).collect();
                (!names.is_empty()).then(|| format!("[{}]", names.join(", ")))
            },
        },
        Key {
            name: "contact_modulus",
            takes: "pressure > 0",
            about: "contact modulus E* of the pair, such as `\"115 GPa\"`; it is no Young's modulus",
            default: "",
            read: read_contact_modulus,
            print: |question, system| match question.material {
                Some(Material::ContactModulus(modulus)) => {
                    Some(printed::quantity(modulus, Dimension::PRESSURE, system))
                }
                _ => None,
            },
        },
        Key {
            name: "modulus",
            takes: "pressure > 0",
            about: "",
            default: "",
            read: read_contact_modulus,
            print: |_, _| None,
        },
        Key {
            name: "bodies",
            takes: "two of `\"rigid\"`, `{ young, poisson }`; or a text",
            about: "Young's modulus and Poisson's ratio of both bodies, such as `\"210 GPa 0.3, rigid\"`; if only one is given, the other one is rigid; friction needs them",
            default: "",
            read: |question, entry, context| {
                read_pair(entry, context.system).map(|pair| question.material = Some(Material::Bodies(pair)))
            },
            print: |question, system| match question.material {
                Some(Material::Bodies(pair)) => {
                    Some(format!("[{}, {}]", print_body(pair.first, system), print_body(pair.second, system)))
                }
                _ => None,
            },
        },
        Key {
            name: "force",
            takes: "force(s)",
            about: "normal force: one value, several such as `\"1 N, 10 N\"` or `[\"1 N\", \"10 N\"]`, or `{ from, to, count, spacing }` with the `spacing` `\"log\"`, which is the default, or `\"linear\"`; other loads take the same",
            default: "another load or a path is given",
            read: |question, entry, context| {
                read_loads(PrescribedLoad::Force, entry, context).map(|loads| question.loads = Some(loads))
            },
            print: |question, system| print_loads(question.loads.as_ref()?, PrescribedLoad::Force, system),
        },
        Key {
            name: "force_bar",
            takes: "number(s)",
            about: "normal force over $`E^* h L`$, with the measured rms height $`h`$ of each surface; for rough surfaces",
            default: "another load or a path is given",
            read: |question, entry, context| {
                read_loads(PrescribedLoad::ForceBar, entry, context).map(|loads| question.loads = Some(loads))
            },
            print: |question, system| print_loads(question.loads.as_ref()?, PrescribedLoad::ForceBar, system),
        },
        Key {
            name: "mean_pressure",
            takes: "pressure(s)",
            about: "mean pressure over the nominal contact area, such as `\"1 MPa\"`, or several as in `\"1 MPa, 10 MPa\"`",
            default: "another load or a path is given",
            read: |question, entry, context| {
                read_loads(PrescribedLoad::MeanPressure, entry, context)
                    .map(|loads| question.loads = Some(loads))
            },
            print: |question, system| {
                print_loads(question.loads.as_ref()?, PrescribedLoad::MeanPressure, system)
            },
        },
        Key {
            name: "approach",
            takes: "length(s)",
            about: "approach of the bodies, counted from first touch, such as `\"10 nm, 100 nm\"`; free boundaries",
            default: "another load or a path is given",
            read: |question, entry, context| {
                read_loads(PrescribedLoad::Approach, entry, context).map(|loads| question.loads = Some(loads))
            },
            print: |question, system| print_loads(question.loads.as_ref()?, PrescribedLoad::Approach, system),
        },
        Key {
            name: "mean_gap",
            takes: "length(s)",
            about: "distance between the mean planes; periodic boundaries",
            default: "another load or a path is given",
            read: |question, entry, context| {
                read_loads(PrescribedLoad::MeanGap, entry, context).map(|loads| question.loads = Some(loads))
            },
            print: |question, system| print_loads(question.loads.as_ref()?, PrescribedLoad::MeanGap, system),
        },
        Key {
            name: "hardness",
            takes: "pressure > 0",
            about: "pressure above which a state has a note; the contact stays elastic",
            default: "E*/10",
            read: |question, entry, context| {
                let pressure = entry.positive(Dimension::PRESSURE, context.system)?;
                question.hardness = Some(pressure);
                Ok(())
            },
            print: |question, system| {
                question.hardness.map(|pressure| printed::quantity(pressure, Dimension::PRESSURE, system))
            },
        },
    ],
};

/// Keys of `[sampling]`.
static SAMPLING_KEYS: KeyTable<AskedSampling> = KeyTable {
    name: "sampling",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[
        Key {
            name: "seed",
            takes: "whole number",
            about: "seed of random surfaces, and of the random lines that `mdr1d` draws for a file; surface i has the seed of surface i of the figures",
            default: "",
            read: |sampling, entry, _| entry.count(0).map(|seed| sampling.seed = Some(seed)),
            print: |sampling, _| sampling.seed.map(|seed| seed.to_string()),
        },
        Key {
            name: "surfaces",
            takes: "whole number >= 1",
            about: "number of surfaces",
            default: "1",
            read: |sampling, entry, _| entry.count(1).map(|surfaces| sampling.surfaces = Some(surfaces)),
            print: |sampling, _| sampling.surfaces.map(|surfaces| surfaces.to_string()),
        },
    ],
};

const SYSTEMS: [(&str, System); 2] = [("none", System::None), ("si", System::Si)];

/// Every key of a scene except those of [`EFFECT_KEYS`] and the outputs that models compute
/// ([`contact_model::Output::ALL`]), in the order in which the book lists them.
pub fn scene_keys() -> Vec<SceneKey> {
    let mut keys: Vec<SceneKey> = SCENE_KEYS.describe().collect();
    keys.extend(ACCURACY_KEYS.describe());
    keys.extend(PATH_KEYS.describe());
    keys.extend(SELF_AFFINE_KEYS.describe());
    keys.extend(FILE_KEYS.describe());
    keys.extend(SECOND_KEYS.describe());
    keys.extend(BODY_KEYS.describe());
    keys.extend(numerics::describe());
    keys.extend(SAMPLING_KEYS.describe());
    keys.extend(OUTPUT_KEYS.describe());
    keys
}

/// The mistake of a key that there is not.
fn no_such_key(path: &str) -> Diagnostic {
    let step = |table: &'static str| if table == "scene.path" { "scene.path.0" } else { table };
    let mut known: Vec<String> =
        scene_keys().iter().map(|key| format!("{}.{}", step(key.table), key.name)).collect();
    known.extend(EFFECT_KEYS.iter().map(|key| format!("effects.{}", key.name)));
    known.extend(contact_model::Output::ALL.iter().map(|output| format!("outputs.{}", output.name())));
    let meant = path.rsplit_once('.').and_then(|(table, key)| other_words::meant(table, key));
    let help = match nearest(path, known.iter().map(String::as_str)) {
        _ if meant.is_some() => meant.unwrap_or_default(),
        Some(near) => format!("did you mean `{near}`?"),
        None => "a key has the name of its table before it, such as `scene.surface.cells`; \"What a scene may say\" in the book lists all of them"
            .to_owned(),
    };
    Diagnostic::new(format!("there is no key `{path}`")).with_help(help)
}

impl Question {
    /// Reads a text.
    ///
    /// # Errors
    /// The first mistake.
    pub fn parse(text: &str) -> Result<Self, Diagnostic> {
        Entries::of_text("", text, |root| Ok(read_question(&root, &[])?.0))
    }

    /// Sets a key from a text, as the flag `--set` has it: a value of TOML such as `512`, `true` or
    /// `["1 N", "2 N"]`, or else a text such as `0.5 um`. A step of a path is named by its number, counted from
    /// 0: `scene.path.1.force`.
    ///
    /// # Errors
    /// What is wrong with the value; that there is no such key, or that another one is given in its place.
    ///
    /// ```
    /// # use fractal_contact::scenes::Question;
    /// let mut question = Question::default();
    /// question.set("scene.models", "bem3d")?;
    /// question.set("models.bem3d.cells", "512")?;
    /// question.set("effects.hardness", "2 GPa")?;
    /// assert!(question.set("effects.hardnes", "2 GPa").is_err());
    /// # Ok::<(), fractal_contact::scenes::Diagnostic>(())
    /// ```
    pub fn set(&mut self, path: &str, text: &str) -> Result<(), Diagnostic> {
        Entries::of_word(path, text, |entry| {
            let context = Context { system: self.units, own: &[] };
            self.set_entry(path, entry, context).unwrap_or_else(|| Err(no_such_key(path)))
        })
    }

    /// `None` where there is no such key.
    fn set_entry(&mut self, path: &str, entry: &Entry<'_>, context: Context<'_>) -> Option<ReadResult<()>> {
        let (table, key) = path.rsplit_once('.')?;
        match table {
            "scene" => SCENE_KEYS
                .set(self, entry, context)
                .or_else(|| ACCURACY_KEYS.set(&mut self.accuracy, entry, context)),
            "scene.surface" if key == "kind" => Some(self.choose_surface(entry)),
            "scene.surface" => match self.surface.as_mut()? {
                AskedSurface::SelfAffine(surface) => SELF_AFFINE_KEYS.set(surface, entry, context),
                AskedSurface::File(file) => FILE_KEYS.set(file, entry, context),
            },
            "scene.second_surface" => {
                let second = self.second_surface.get_or_insert_default();
                SECOND_KEYS
                    .set(second, entry, context)
                    .or_else(|| FILE_KEYS.set(&mut second.file, entry, context))
            }
            "scene.body" => BODY_KEYS.set(self.body.get_or_insert_default(), entry, context),
            "sampling" => SAMPLING_KEYS.set(self.sampling.get_or_insert_default(), entry, context),
            "outputs" => set_output(&mut self.outputs, entry, context),
            "effects" => {
                let effect = EFFECT_KEYS.iter().find(|effect| effect.name == key)?;
                Some((effect.read)(entry, context.system, &mut self.effects))
            }
            _ => {
                if let Some(step) = table.strip_prefix("scene.path.") {
                    return self.set_step(step.parse().ok()?, entry, context);
                }
                let name = table.strip_prefix("models.")?;
                let model = self.models.iter_mut().find(|model| model.name() == name)?;
                numerics::set_option(model, entry)
            }
        }
    }

    fn choose_surface(&mut self, entry: &Entry<'_>) -> ReadResult<()> {
        self.surface = Some(if read_is_file(entry)? {
            AskedSurface::File(Box::default())
        } else {
            AskedSurface::SelfAffine(AskedSelfAffine::default())
        });
        Ok(())
    }

    /// Sets a key of a step of the path, which is the next one at most; `None` where there is no such key.
    fn set_step(&mut self, index: usize, entry: &Entry<'_>, context: Context<'_>) -> Option<ReadResult<()>> {
        let loads = self.loads.get_or_insert_with(|| AskedLoads::Path(Vec::new()));
        let AskedLoads::Path(steps) = loads else {
            return Some(Err(entry
                .diagnostic("loads one by one and a path are both given")
                .with_help("keep one of them")));
        };
        if index == steps.len() {
            steps.push(AskedStep::default());
        }
        let Some(step) = steps.get_mut(index) else {
            let message = format!("step {index} of a path of {} steps", steps.len());
            return Some(Err(entry
                .diagnostic(message)
                .with_help("steps are counted from 0 and set in their order")));
        };
        PATH_KEYS.set(step, entry, context)
    }

    /// Requests the quantities and pictures that one looks at first, of a map or of a profile: the contact area, the
    /// stiffness, connected contacts, pressure and gap, and the error of the grid, or with friction the cells that
    /// stick. The effects, the loads and the accuracy are to be set before.
    pub fn request_usual_outputs(&mut self, profile: bool) {
        let [along_x, along_y] = self.effects.boundary.repeats();
        let periodic = along_x && along_y;
        let requested = &mut self.outputs;
        requested.outputs.area = true;
        // A contact that goes on along a line has no approach and no stiffness, because its displacements have no zero at
        // infinity: that of a profile, or of a map that is periodic along one axis.
        requested.outputs.stiffness = periodic || along_x == along_y && !profile;
        requested.outputs.mean_gap = periodic;
        requested.outputs.contact_patches = true;
        let both = || vec![FieldFormat::Npy, FieldFormat::Png];
        requested.files = vec![(Output::Pressure, both()), (Output::Gap, both())];
        if self.effects.friction == Friction::default() {
            requested.distributions = vec![Distributed::Pressure, Distributed::Gap];
            requested.grid_error = self.accuracy.is_none();
        } else {
            requested.files = vec![(Output::Pressure, both()), (Output::StickSlip, both())];
            requested.outputs.stick_area = true;
            requested.curves = true;
            // Half and all of the last piece of the path, where the tangential load grows: the pressure changes little
            // meanwhile.
            if let Some(AskedLoads::Path(steps)) = &self.loads {
                let states = |step: &AskedStep| step.states.unwrap_or(1) as usize;
                let end = steps.iter().map(states).fold(0, usize::saturating_add).saturating_sub(1);
                let last = steps.last().map_or(1, states);
                requested.drawn_states = Some(vec![end.saturating_sub(last / 2), end]);
            }
        }
    }

    /// As the text of a scene, which is read as the same question.
    pub fn to_toml(&self) -> String {
        self.printed("", |_| "")
    }

    /// The same with a heading, and with comments on some keys, by their path such as `scene.bodies`.
    pub fn printed<'c>(&self, heading: &str, comment: impl Fn(&str) -> &'c str) -> String {
        let mut lines = TomlLines { text: heading.to_owned(), comment };
        let system = self.units;
        let mut scene = SCENE_KEYS.print(self, system);
        scene.extend(ACCURACY_KEYS.print(&self.accuracy, system));
        lines.table("scene", "[scene]", scene);
        if let Some(AskedLoads::Path(steps)) = &self.loads {
            for step in steps {
                lines.table("scene.path", "[[scene.path]]", PATH_KEYS.print(step, system));
            }
        }
        match &self.surface {
            Some(AskedSurface::SelfAffine(surface)) => {
                lines.table("scene.surface", "[scene.surface]", SELF_AFFINE_KEYS.print(surface, system));
            }
            Some(AskedSurface::File(file)) => {
                lines.table("scene.surface", "[scene.surface]", FILE_KEYS.print(file, system));
            }
            None => {}
        }
        if let Some(second) = &self.second_surface {
            let mut keys = FILE_KEYS.print(&second.file, system);
            keys.extend(SECOND_KEYS.print(second, system));
            lines.table("scene.second_surface", "[scene.second_surface]", keys);
        }
        if let Some(body) = &self.body {
            lines.table("scene.body", "[scene.body]", BODY_KEYS.print(body, system));
        }
        let effects =
            EFFECT_KEYS.iter().filter_map(|key| Some((key.name, (key.print)(&self.effects, system)?)));
        lines.table_unless_empty("effects", effects.collect());
        lines.table_unless_empty("outputs", print_outputs(&self.outputs, system));
        for model in &self.models {
            let name = format!("models.{}", model.name());
            lines.table_unless_empty(&name, print_options(model));
        }
        if let Some(sampling) = &self.sampling {
            lines.table("sampling", "[sampling]", SAMPLING_KEYS.print(sampling, system));
        }
        lines.text
    }
}

/// Lines of TOML.
struct TomlLines<F> {
    text: String,
    comment: F,
}

/// A line of a printed scene begins its comment in this column.
const COMMENT: usize = 40;

impl<'c, F: Fn(&str) -> &'c str> TomlLines<F> {
    fn table(&mut self, name: &str, title: &str, keys: Vec<(&'static str, String)>) {
        let empty = if self.text.is_empty() { "" } else { "\n" };
        let _ = writeln!(self.text, "{empty}{title}");
        for (key, value) in keys {
            let line = format!("{key} = {value}");
            let comment = (self.comment)(&format!("{name}.{key}"));
            let _ = match comment {
                "" => writeln!(self.text, "{line}"),
                // Several lines stand before the key.
                _ if comment.contains('\n') => {
                    writeln!(self.text, "# {}\n{line}", comment.replace('\n', "\n# "))
                }
                comment => writeln!(self.text, "{line:COMMENT$} # {comment}"),
            };
        }
    }

    fn table_unless_empty(&mut self, name: &str, keys: Vec<(&'static str, String)>) {
        if !keys.is_empty() {
            self.table(name, &format!("[{name}]"), keys);
        }
    }
}

/// The tables that have a key of this name.
fn tables_of(name: &str) -> Vec<&'static str> {
    let keys = scene_keys().into_iter().filter(|key| key.name == name).map(|key| key.table);
    let effects = EFFECT_KEYS.iter().filter(|key| key.name == name).map(|_| "effects");
    let outputs = contact_model::Output::ALL.iter().filter(|output| output.name() == name).map(|_| "outputs");
    keys.chain(effects).chain(outputs).collect()
}

/// Says of keys that their table does not have which tables have them.
fn with_other_tables(mistake: Diagnostic) -> Diagnostic {
    let untold = mistake.unknown();
    let place = |name: &String| {
        let mut tables = tables_of(name);
        tables.dedup();
        let tables: Vec<String> = tables.iter().map(|table| format!("[{table}]")).collect();
        (!tables.is_empty()).then(|| format!("`{name}` belongs into {}", tables.join(" or ")))
    };
    let places: Vec<String> = untold.iter().filter_map(place).collect();
    if places.is_empty() {
        return mistake;
    }
    let all = places.len() == untold.len();
    let lines = mistake.help().unwrap_or_default().lines();
    let lines = lines.filter(|line| !all || !line.starts_with("known here:")).map(str::to_owned);
    let help: Vec<String> = places.into_iter().chain(lines).collect();
    mistake.with_help(help.join("\n"))
}

/// Returns advice for a flag that `press` does not have: the flag or the key that it stands for, or what there is
/// instead of it.
pub fn meant_by_flag(flag: &str) -> Option<String> {
    let name = flag.trim_start_matches('-').replace('-', "_");
    let set = || {
        let table = tables_of(&name).into_iter().next()?;
        let table = if table == "scene.path" { "scene.path.0" } else { table };
        Some(format!("a scene has a key of this name: `--set '{table}.{name}=VALUE'`"))
    };
    other_words::meant_by_flag(flag).or_else(set)
}

/// Advice for a name that is no output: the output that it probably means, or that there is no such output.
pub fn meant_by_output(name: &str) -> Option<String> {
    other_words::meant("outputs", name)
}

/// Reads a whole scene, with remarks on former names.
pub(crate) fn read_question(
    root: &Entries<'_>,
    own: &[RegisteredModel],
) -> ReadResult<(Question, Vec<Diagnostic>)> {
    read_tables(root, own).map_err(with_other_tables)
}

fn read_tables(root: &Entries<'_>, own: &[RegisteredModel]) -> ReadResult<(Question, Vec<Diagnostic>)> {
    let mut question = Question::default();
    let mut notes = Vec::new();
    let Some(scene) = root.table("scene")? else {
        return Err(Diagnostic::new("there is no [scene]")
            .with_help("a scene begins with [scene]: `models`, `contact_modulus` and a load"));
    };
    if let Some(units) = scene.entry("units") {
        question.units = units.choice(&SYSTEMS)?;
    }
    let context = Context { system: question.units, own };
    SCENE_KEYS.read(&mut question, &scene, context)?;
    ACCURACY_KEYS.read(&mut question.accuracy, &scene, context)?;
    if let Some(entry) = scene.entry("modulus") {
        let note = Diagnostic::note("`modulus` is read as `contact_modulus`, which is E* of the pair");
        let help = "To give Young's modulus and Poisson's ratio, write `bodies`.";
        notes.push(note.at(entry.key_span()).with_help(help));
    }
    read_path(&mut question, &scene, context)?;
    read_surfaces(&mut question, &scene, context, &mut notes)?;
    scene.finish()?;
    let effects = root.table("effects")?;
    question.effects = read_effects(effects, context.system)?;
    question.outputs = read_outputs(root.table("outputs")?, context)?;
    if let Some(options) = root.table("models")? {
        numerics::read_options(&mut question.models, &options)?;
    }
    if let Some((name, entry)) = root.one_of(&["sampling", "chance"])? {
        let table = entry.table()?;
        if name == "chance" {
            let note = Diagnostic::note("`[chance]` is now `[sampling]`").at(entry.key_span());
            notes.push(note.with_help("rename the table; its keys are the same"));
        }
        let mut sampling = AskedSampling::default();
        SAMPLING_KEYS.read(&mut sampling, &table, context)?;
        table.finish()?;
        question.sampling = Some(sampling);
    }
    root.known_only()?;
    Ok((question, notes))
}

/// `[[scene.path]]`.
fn read_path(question: &mut Question, scene: &Entries<'_>, context: Context<'_>) -> ReadResult<()> {
    let Some(path) = scene.find("path") else { return Ok(()) };
    if let Some(AskedLoads::Loads(loads)) = &question.loads {
        let key = loads.kind.key();
        return Err(path
            .diagnostic_at_key(format!("`{key}` and `path` are both given in [scene]"))
            .with_help(format!("loads one by one are `{key}`; a history (friction, rheology, indentation, adhesion) is `path`: keep one of them")));
    }
    question.loads = Some(AskedLoads::Path(read_steps(&path, context)?));
    Ok(())
}

/// `[scene.surface]`, `[scene.second_surface]` and `[scene.body]`.
fn read_surfaces(
    question: &mut Question,
    scene: &Entries<'_>,
    context: Context<'_>,
    notes: &mut Vec<Diagnostic>,
) -> ReadResult<()> {
    let is_file = |table: &Entries<'_>| read_is_file(&table.require("kind", "\"self_affine\"")?);
    let mut file = |table: &Entries<'_>| -> ReadResult<AskedFile> {
        let mut file = AskedFile::default();
        FILE_KEYS.read(&mut file, table, context)?;
        if let Some(entry) = table.entry("width") {
            let note = Diagnostic::note("`width` is now `size`").at(entry.key_span());
            notes.push(note.with_help(
                "write `size = [Lx, Ly]`, or one value where the map is square; `width` is Lx, with square cells",
            ));
        }
        Ok(file)
    };
    if let Some(table) = scene.table("surface")? {
        question.surface = Some(if is_file(&table)? {
            AskedSurface::File(Box::new(file(&table)?))
        } else {
            let mut surface = AskedSelfAffine::default();
            SELF_AFFINE_KEYS.read(&mut surface, &table, context)?;
            AskedSurface::SelfAffine(surface)
        });
        table.finish()?;
    }
    if let Some(table) = scene.table("second_surface")? {
        let is_file = is_file(&table)?;
        if !(is_file && matches!(question.surface, Some(AskedSurface::File(_)))) {
            return Err(table.diagnostic("[scene.second_surface] is added to a measured [scene.surface]").with_help(
                "say `kind = \"file\"` in both; two independent random surfaces are one of the rms height sqrt(h1^2 + h2^2)",
            ));
        }
        let mut second = AskedSecond { file: file(&table)?, ..AskedSecond::default() };
        SECOND_KEYS.read(&mut second, &table, context)?;
        table.finish()?;
        question.second_surface = Some(second);
    }
    if let Some(table) = scene.table("body")? {
        let mut body = AskedBody::default();
        BODY_KEYS.read(&mut body, &table, context)?;
        table.finish()?;
        question.body = Some(body);
    }
    Ok(())
}

/// The kind of a surface.
fn read_is_file(entry: &Entry<'_>) -> ReadResult<bool> {
    entry.choice(&[("self_affine", false), ("file", true)])
}

fn read_contact_modulus(question: &mut Question, entry: &Entry<'_>, context: Context<'_>) -> ReadResult<()> {
    let modulus = entry.positive(Dimension::PRESSURE, context.system)?;
    question.material = Some(Material::ContactModulus(modulus));
    Ok(())
}

fn read_pair(entry: &Entry<'_>, system: System) -> ReadResult<Pair> {
    let pair = if let Some(words) = entry.as_word() {
        match words.split(',').collect::<Vec<_>>()[..] {
            [one] => Pair { first: Body::Rigid, second: body_of_words(one, entry, system)? },
            [first, second] => Pair {
                first: body_of_words(first, entry, system)?,
                second: body_of_words(second, entry, system)?,
            },
            _ => return Err(no_bodies(entry, words)),
        }
    } else {
        let values = entry.list();
        let [first, second] = &values[..] else {
            let found = if entry.is_list() {
                format!("`bodies` names {}", values.len())
            } else {
                format!("`bodies` = {}: this is no body", entry.shown())
            };
            return Err(entry
                .diagnostic(found)
                .with_help("two: `bodies = [\"rigid\", { young = \"70 GPa\", poisson = 0.33 }]`"));
        };
        Pair { first: read_body(first, system)?, second: read_body(second, system)? }
    };
    // A rigid body may press on a layer, which is the other one.
    if pair.first != Body::Rigid || pair.second != Body::Rigid {
        pair.contact_modulus().map_err(|error| entry.diagnostic(error.to_string()))?;
    }
    Ok(pair)
}

/// A body as `210 GPa 0.3` or `rigid`.
fn body_of_words(words: &str, entry: &Entry<'_>, system: System) -> ReadResult<Body> {
    let words = words.trim();
    if words == "rigid" {
        return Ok(Body::Rigid);
    }
    let (young, ratio) = words.rsplit_once(char::is_whitespace).ok_or_else(|| no_bodies(entry, words))?;
    let dimension = if system == System::Si { Dimension::PRESSURE } else { Dimension::NONE };
    let wrong = |reason: surface_io::QuantityError| {
        entry.diagnostic(format!("`bodies`: {reason}")).with_help(BODIES_HELP)
    };
    let young = Quantity::parse_as(young, dimension).map_err(wrong)?;
    let poisson = ratio.parse().map_err(|_| no_bodies(entry, words))?;
    if young > 0.0 { checked_body(young, poisson, entry) } else { Err(no_bodies(entry, words)) }
}

const BODIES_HELP: &str = "Young's modulus and Poisson's ratio of both bodies, such as \"210 GPa 0.3, 70 GPa 0.33\" or \"rigid, 70 GPa 0.33\"; the \
                           other one of a single body is rigid";

fn no_bodies(entry: &Entry<'_>, words: &str) -> Diagnostic {
    let wrong = entry.diagnostic(format!("`bodies`: \"{words}\" is no body"));
    let has_decimal_comma =
        words.split(',').skip(1).any(|part| part.starts_with(|c: char| c.is_ascii_digit()));
    wrong.with_help(if has_decimal_comma {
        "a comma is between two bodies; write a decimal point, such as \"210 GPa 0.3, 70 GPa 0.33\""
    } else {
        BODIES_HELP
    })
}

fn checked_body(young: f64, poisson: f64, ratio: &Entry<'_>) -> ReadResult<Body> {
    if (0.0..=0.5).contains(&poisson) {
        return Ok(Body::Elastic { young, poisson });
    }
    Err(ratio
        .diagnostic(format!("`poisson` = {poisson}: expected a number in [0, 0.5]"))
        .with_help("0.5 is incompressible"))
}

fn read_body(entry: &Entry<'_>, system: System) -> ReadResult<Body> {
    if entry.is_text() {
        return entry.choice(&[("rigid", Body::Rigid)]);
    }
    let table = entry.table()?;
    let young = table.require("young", "\"70 GPa\"")?;
    let ratio = table.require("poisson", "0.33")?;
    if let (Ok(_), Some(pressure)) = (young.number(), ratio.as_word())
        && Quantity::parse_as(pressure, Dimension::PRESSURE).is_ok()
    {
        let exchanged = ratio.diagnostic(format!("`poisson` is \"{pressure}\", a pressure"));
        return Err(exchanged.with_help("exchange the values of `young` and `poisson`"));
    }
    let young = young.positive(Dimension::PRESSURE, system)?;
    let poisson = ratio.number()?;
    table.finish()?;
    checked_body(young, poisson, &ratio)
}

fn print_body(body: Body, system: System) -> String {
    match body {
        Body::Elastic { young, poisson } => {
            let young = printed::quantity(young, Dimension::PRESSURE, system);
            format!("{{ young = {young}, poisson = {} }}", printed::number(poisson))
        }
        _ => printed::text("rigid"),
    }
}

#[cfg(test)]
mod tests;
