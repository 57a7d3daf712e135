//! `press` and `new`: from flags to the question that is asked most often, how large the contact of a measured
//! map is.

use crate::arguments::{LOADS, PRESS_DETREND, PressArguments, flag_of};
use contact_model::units::{amount, ascii};
use fractal_contact::scenes::{
    AskedFile, AskedSurface, Diagnostic, Error, Material, MissingKey, Numerics, Question, Result, SceneFile,
    meant_by_output, missing_keys,
};
use fractal_contact::{Coupling, Friction, Output};
use runs::cluster::{quoted, toml};
use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};
use surface_io::{ContentError, Dimension, Metadata, Quantity, SurfaceFile};

/// States of the path along which a tangential force grows.
const TANGENTIAL_STATES: usize = 8;

/// Messages name the scene of the flags in this way, because it has no file yet.
pub const WORDS: &str = "the scene of these flags";

/// A flag that a command lacks.
struct Lacking {
    flag: String,
    example: String,
    /// What the flag is, for the message.
    why: String,
    /// Another flag that can be given in its place, and what it is.
    instead: Option<(String, String)>,
}

impl Lacking {
    fn new(flag: &str, example: &str, why: &str, instead: Option<(&str, &str)>) -> Self {
        let instead = instead.map(|(flag, why)| (flag.to_owned(), why.to_owned()));
        Self { flag: flag.to_owned(), example: example.to_owned(), why: why.to_owned(), instead }
    }
}

/// The scene of a map, at the place where it will stand.
///
/// # Errors
/// [`Error::Argument`] with all flags that are missing and the whole command with an example of each. Where a
/// flag that is given is wrong, the message begins with that and repeats no command. Other errors are those of
/// the file and of the scene.
pub fn scene(asked: &PressArguments, at: &Path) -> Result<SceneFile> {
    if asked.map.extension().is_some_and(|ending| ending == "toml") {
        let reason =
            format!("{} is a scene and not a map: `fractal-contact run` takes it", asked.map.display());
        return Err(Error::Argument { name: "map", reason });
    }
    let (declared, _) = asked.file.options()?;
    let known = SurfaceFile::open(&asked.map, &declared).and_then(SurfaceFile::scan);
    let known = known.map_err(|error| match error.problem() {
        Some(ContentError::Channel { choice: None, matching: 2.., list }) => {
            let map = asked.map.display();
            let reason = format!(
                "{map} has several channels with heights: choose one with --channel. The channels are {list}"
            );
            Error::Argument { name: "channel", reason }
        }
        _ => error.into(),
    })?;
    let lacking = lacking(asked, known.metadata());
    if !lacking.is_empty() {
        return Err(Error::Argument { name: "command", reason: missing_flags(asked, &lacking) });
    }
    // The path of the map counts from a folder that has to exist.
    let folder = at.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    if let Some(folder) = folder {
        runs::files::create_directory(folder)?;
    }
    let scene = scene_of(asked, at, known.metadata().profile, WORDS);
    if let (Err(_), Some(folder)) = (&scene, folder) {
        std::fs::remove_dir(folder).ok();
    }
    scene
}

/// The scene of flags that are complete; in messages it is called `words`, because there is no such file yet.
fn scene_of(asked: &PressArguments, at: &Path, profile: bool, words: &str) -> Result<SceneFile> {
    let question = question(asked, at, profile)?;
    let heading = format!(
        "{HEADING}{}. `fractal-contact run` takes this file; \"What a scene may say\" in the book has every key.\n",
        asked.map.file_name().unwrap_or_default().to_string_lossy().escape_default()
    );
    let text = question.printed(&heading, comment);
    SceneFile::of_printed(question, at, text).map_err(|error| match error {
        Error::Scene(mistake) => Error::from(mistake.told_of(words)),
        other => other,
    })
}

fn lacking(asked: &PressArguments, map: &Metadata) -> Vec<Lacking> {
    let mut lacking = lacking_of_map(asked, map);
    lacking.extend(lacking_of_bodies(asked));
    if asked.load().is_none() {
        lacking.push(Lacking::new(
            "--pressure",
            "1 MPa,10 MPa",
            "mean pressure over the area of the map, one value or several",
            Some(("--force", "normal force; or --approach, counted from first touch")),
        ));
    }
    if asked.has_friction() && asked.tangential_force.is_none() {
        let why = "tangential force along x, which friction has to hold";
        match held_by_friction(asked) {
            Some(held) => {
                let [half, held] = [0.5 * held, held].map(|force| ascii(&amount(force, "N")));
                lacking.push(Lacking::new(
                    "--tangential-force",
                    &half,
                    &format!("{why}: below {held}"),
                    None,
                ));
            }
            None => lacking.push(Lacking::new("--tangential-force", "10 mN", why, None)),
        }
    }
    lacking
}

/// The tangential force at which the whole contact slips, of Coulomb's law under one normal force.
fn held_by_friction(asked: &PressArguments) -> Option<f64> {
    let ("force", force) = asked.load()? else { return None };
    if asked.shear_strength.is_some() || asked.traction_limit.is_some() {
        return None;
    }
    let held = asked.friction? * Quantity::parse_as(force, Dimension::FORCE).ok()?;
    (held > 0.0 && held.is_finite()).then_some(held)
}

/// Flags that say what the file of the map does not hold: the unit, the size, and what undefined points are.
fn lacking_of_map(asked: &PressArguments, map: &Metadata) -> Vec<Lacking> {
    let given = |key: &str| asked.file.value(key).map(str::to_owned);
    let lacking = |MissingKey { key, example, why, instead, .. }: MissingKey| {
        let instead = instead.map(|(key, why)| (flag_of(key), why.to_owned()));
        Lacking { flag: flag_of(key), example: example.to_owned(), why, instead }
    };
    missing_keys(map, &given).into_iter().map(lacking).collect()
}

/// Flags of the bodies that are missing. Friction needs the bodies themselves and not only E*.
fn lacking_of_bodies(asked: &PressArguments) -> Vec<Lacking> {
    let bodies = asked.problem.value("bodies");
    let mut lacking = Vec::new();
    let mut add = |flag: &str, example: &str, why: &str, instead: Option<(&str, &str)>| {
        lacking.push(Lacking::new(flag, example, why, instead));
    };
    if asked.has_friction() && bodies.is_none() {
        let why = "Young's modulus and Poisson's ratio of both bodies, which friction needs";
        add("--bodies", "rigid, 210 GPa 0.3", why, None);
    }
    // A layer has a material, and the body that presses on it may be rigid.
    let has_layer = asked.set.iter().any(|set| set.trim_start().starts_with("effects.layer"));
    if !asked.has_friction() && asked.contact_modulus().is_none() && bodies.is_none() && !has_layer {
        add(
            "--bodies",
            "210 GPa 0.3, 210 GPa 0.3",
            "Young's modulus and Poisson's ratio of both bodies, here steel on steel",
            Some(("--contact-modulus", "E* of the pair, such as '115 GPa' for steel on steel")),
        );
    }
    if asked.has_friction() && bodies.is_none_or(couple) && asked.coupling.is_none() {
        add(
            "--coupling",
            "full",
            "the bodies differ, so normal and tangential tractions act on each other: full solves both, none neglects this",
            None,
        );
    }
    lacking
}

/// The first mistake in the flags that are given. Examples stand in for the missing ones, so that the scene can
/// be read.
fn mistake(asked: &PressArguments, lacking: &[Lacking]) -> Option<String> {
    let mut filled = asked.clone();
    for Lacking { flag, example, .. } in lacking {
        let text = Some(example.clone());
        match flag.as_str() {
            "--unit" => filled.file.add("unit", example),
            "--cell" => filled.file.add("cell", example),
            "--undefined" => filled.file.add("undefined", example),
            "--bodies" if asked.contact_modulus().is_some() => {
                let modulus = if asked.note().is_some() { "--modulus" } else { "--contact-modulus" };
                return Some(format!("--friction needs --bodies in the place of {modulus}"));
            }
            "--bodies" => filled.problem.add("bodies", example),
            "--coupling" => filled.coupling = text,
            "--pressure" => filled.problem.add("mean_pressure", example),
            _ => filled.tangential_force = text,
        }
    }
    // Nothing is written, and this folder exists.
    let words = "the scene of these flags, with examples of what is missing";
    match scene_of(&filled, Path::new("scene.toml"), false, words) {
        Err(Error::Scene(mistake)) => Some(mistake.to_string().trim_start_matches("error: ").to_owned()),
        _ => None,
    }
}

/// One message with everything that is missing and the command with an example of each. A command with a mistake
/// is not repeated: the mistake comes first.
fn missing_flags(asked: &PressArguments, lacking: &[Lacking]) -> String {
    let mistake = mistake(asked, lacking);
    let mut text = mistake.as_ref().map_or_else(String::new, |mistake| format!("{mistake}\n"));
    let are_missing = if lacking.len() == 1 { "a flag is missing" } else { "some flags are missing" };
    let _ = write!(text, "{are_missing} for the contact of {}:", asked.map.display());
    for Lacking { flag, why, instead, .. } in lacking {
        let _ = write!(text, "\n  {flag:<19} {why}");
        if let Some((other, why)) = instead {
            let _ = write!(text, "\n  {other:<19} {why}, instead of {flag}");
        }
    }
    if mistake.is_some() {
        return text;
    }
    let mut command = vec!["fractal-contact".to_owned()];
    command.extend(std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy())));
    for Lacking { flag, example, .. } in lacking {
        command.extend([flag.clone(), quoted(example)]);
    }
    let examples: Vec<String> = lacking.iter().map(|lacking| format!("'{}'", lacking.example)).collect();
    let _ = write!(
        text,
        "\nThe whole command, with examples that your values replace ({}):\n  {}",
        examples.join("; "),
        command.join(" ")
    );
    text
}

/// First words of a scene that `press` or `new` has written.
const HEADING: &str = "# Contact of the map ";
/// Largest scene that is looked at, in bytes.
const LARGEST_SCENE: u64 = 1 << 24;

/// Refuses to overwrite a file that `press` has not written, a symbolic link, a pipe or a device.
///
/// # Errors
/// [`Error::Argument`] that names the file.
pub fn check_place(path: &Path) -> Result<()> {
    let refused = |what: &str| {
        let reason =
            format!("{} {what}, and is not overwritten: give another directory with --out", path.display());
        Err(Error::Argument { name: "out", reason })
    };
    match std::fs::symlink_metadata(path) {
        Err(_) => Ok(()),
        Ok(about) if about.is_symlink() => refused("is a symbolic link"),
        Ok(about) if !about.is_file() => refused("is not a regular file"),
        Ok(_) if runs::files::read(path, LARGEST_SCENE)?.starts_with(HEADING.as_bytes()) => Ok(()),
        Ok(_) => refused("was not written by `press`"),
    }
}

/// The question that flags ask, of a map or of a profile.
fn question(asked: &PressArguments, at: &Path, profile: bool) -> Result<Question, Diagnostic> {
    let mut question = Question::default();
    question.models = Numerics::named("bem3d").into_iter().collect();
    question.surface = Some(AskedSurface::File(Box::new(file(asked, at)?)));
    let mut set = |key: &str, text: &str| {
        question.set(key, text).map_err(|mistake| mistake.of_flag(key, &flag_of(key)))
    };
    // Loads may be those of a path, and the number of cells is that of the map.
    let elsewhere = |key: &str| key == "cells" || LOADS.contains(&key);
    for (key, text) in asked.problem.given().filter(|(key, _)| !elsewhere(key)) {
        set(&format!("scene.{key}"), text)?;
    }
    if let (Some(modulus), None) = (asked.contact_modulus(), asked.problem.value("contact_modulus")) {
        set("scene.contact_modulus", modulus)?;
    }
    match asked.load() {
        Some((key, values)) if asked.has_friction() => {
            set(&format!("scene.path.0.{key}"), values)?;
            set("scene.path.1.tangential_force", asked.tangential_force.as_deref().unwrap_or_default())?;
            set("scene.path.1.states", &TANGENTIAL_STATES.to_string())?;
        }
        Some((key, values)) => set(&format!("scene.{key}"), values)?,
        None => {}
    }
    if let Some(radius) = &asked.ball {
        set("scene.body.kind", "sphere")?;
        set("scene.body.radius", radius).map_err(|mistake| mistake.of_flag("scene.body.radius", "--ball"))?;
    }
    let boundary = match &*asked.boundary {
        "periodic-along-x" => "{ x = \"periodic\", y = \"free\" }",
        "periodic-along-y" => "{ x = \"free\", y = \"periodic\" }",
        both => both,
    };
    set("effects.boundary", boundary)?;
    if let Some(hardness) = &asked.hardness {
        set("effects.hardness", hardness)?;
    }
    if asked.has_friction() {
        let keys = [
            ("coefficient", asked.friction.map(|coefficient| coefficient.to_string())),
            ("shear_strength", asked.shear_strength.as_deref().map(toml)),
            ("limit", asked.traction_limit.as_deref().map(toml)),
            ("coupling", asked.coupling.as_deref().map(toml)),
        ];
        let keys: Vec<String> =
            keys.into_iter().filter_map(|(key, value)| Some(format!("{key} = {}", value?))).collect();
        set("effects.friction", &format!("{{ {} }}", keys.join(", ")))?;
    }
    question.request_usual_outputs(profile);
    for name in &asked.outputs {
        add_output(&mut question, name.trim())?;
    }
    for assignment in &asked.set {
        let Some((key, value)) = assignment.split_once('=') else {
            let message = format!("`--set {assignment}` has no equals sign");
            return Err(Diagnostic::new(message).with_help("write --set scene.surface.cells=512"));
        };
        question.set(key.trim(), value.trim())?;
    }
    Ok(question)
}

/// The map with what the flags say of it.
fn file(asked: &PressArguments, at: &Path) -> Result<AskedFile, Diagnostic> {
    // A question of its own, in SI units: a length without a unit is a mistake.
    let mut question = Question::default();
    let mut file = AskedFile::default();
    file.path = Some(seen_from(&asked.map, at).into());
    file.detrend = Some(PRESS_DETREND);
    question.surface = Some(AskedSurface::File(Box::new(file)));
    let cells = asked.problem.given().filter(|(key, _)| *key == "cells");
    for (key, text) in asked.file.given().chain(cells) {
        let path = format!("scene.surface.{key}");
        question.set(&path, text).map_err(|mistake| mistake.of_flag(&path, &flag_of(key)))?;
    }
    match question.surface {
        Some(AskedSurface::File(file)) => Ok(*file),
        _ => Ok(AskedFile::default()),
    }
}

/// Requests a quantity, or a field as numbers and as pictures, unless it is requested already.
fn add_output(question: &mut Question, name: &str) -> Result<(), Diagnostic> {
    const HEIGHTS: &str = "heights";
    let output = Output::ALL.iter().find(|output| output.name() == name);
    if output == Some(&Output::Conductance) {
        return Err(Diagnostic::new("`--outputs conductance` does not say what flows").with_help(
            "say it with --set 'outputs.conductance={ kind = \"electrical\", resistivities = [\"1.7e-8 Ohm m\", \"1.7e-8 Ohm m\"] }', or \
             with `kind = \"thermal\"` and `conductivities`",
        ));
    }
    if question.outputs.files.iter().any(|(requested, _)| Some(requested) == output) {
        return Ok(());
    }
    let value = if name == HEIGHTS || output.is_some_and(|output| output.is_field()) {
        "[\"npy\", \"png\"]"
    } else {
        "true"
    };
    question.set(&format!("outputs.{name}"), value).map_err(|mistake| {
        if output.is_some() {
            // The name is an output, so the mistake is in its value or its keys.
            return mistake;
        }
        let names: Vec<&str> = Output::ALL.iter().map(|output| output.name()).collect();
        let help = match name {
            "force" | "approach" | "certificate" => {
                format!("`{name}` is always computed where the boundary has one")
            }
            _ => meant_by_output(name).unwrap_or_else(|| format!("outputs are {}", names.join(", "))),
        };
        mistake.of_flag(&format!("outputs.{name}"), name).with_help(help)
    })
}

/// The comment on a key in the scene of a map.
fn comment(key: &str) -> &'static str {
    match key {
        "scene.models" => "boundary elements: every cell of the map",
        "scene.bodies" => "Young's modulus, Poisson's ratio",
        "scene.contact_modulus" => "E*: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2",
        "scene.accuracy" => "accepted error of the grid, which decides the number of cells",
        "scene.mean_pressure" | "scene.path.mean_pressure" => "force over the area of the map",
        "scene.approach" | "scene.path.approach" => "from first touch",
        "scene.path.tangential_force" => "along x, in equal parts",
        "scene.body.kind" => "a ball that bears the map",
        "scene.surface.path" => "from the folder of this file",
        "scene.surface.undefined" => "points without a height cannot touch",
        "scene.surface.detrend" => "\"plane\" subtracts a tilt; \"none\" keeps it",
        "effects.boundary" => {
            "\"free\": pressed by itself, nothing outside of the map carries load.\n\
             \"periodic\": one tile of an endless surface, as many other programs assume."
        }
        "outputs.area" => "only named outputs are computed",
        "outputs.mean_gap" => "distance between the mean planes, in the place of an approach",
        "outputs.pressure" => "field of each load",
        "outputs.grid_error" => "the error of the grid, from cells twice and four times as large",
        _ => "",
    }
}

/// Whether normal and tangential tractions of these bodies act on each other.
fn couple(bodies: &str) -> bool {
    let mut question = Question::default();
    if question.set("scene.bodies", bodies).is_err() {
        // The mistake is named when the scene is made.
        return false;
    }
    let Some(Material::Bodies(pair)) = question.material else { return false };
    let solved = Friction::coulomb(0.0).with_coupling(Some(Coupling::Full));
    solved.coupling_of(&pair).ok().flatten().is_some()
}

/// The path of a map as the scene at `at` has to say it. Where a folder of the scene is a symbolic link, `..` leads
/// to a place above its target, so that the path is absolute.
fn seen_from(map: &Path, at: &Path) -> String {
    let folder = at.parent().unwrap_or(Path::new(""));
    let below = folder.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        && !folder.ancestors().any(Path::is_symlink);
    let steps = folder.components().filter(|part| matches!(part, Component::Normal(_))).count();
    let path = if map.is_absolute() {
        map.to_owned()
    } else if below {
        let up: PathBuf = std::iter::repeat_n("..", steps).collect();
        up.join(map)
    } else {
        std::path::absolute(map).unwrap_or_else(|_| map.to_owned())
    };
    path.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::{Arguments, Command, command};
    use clap::FromArgMatches as _;

    #[test]
    fn a_path_is_seen_from_the_folder_of_the_scene() {
        let seen = |map: &str, at: &str| seen_from(Path::new(map), Path::new(at));
        assert_eq!(seen("map.npy", "map.toml"), "map.npy");
        assert_eq!(seen("data/map.npy", "out/map/scene.toml"), "../../data/map.npy");
        assert_eq!(seen("map.npy", "./out/scene.toml"), "../map.npy");
        assert_eq!(seen("/a/map.npy", "out/scene.toml"), "/a/map.npy");
        assert!(Path::new(&seen("map.npy", "/elsewhere/scene.toml")).is_absolute());
    }

    /// A tilted map of 8 x 8 heights that has decimals.
    fn tilted_map(folder: &Path) -> PathBuf {
        let height = |x: usize, y: usize| format!("{}.5", 9 * x + (x * y) % 5);
        let row = |y: usize| (0..8).map(|x| height(x, y)).collect::<Vec<_>>().join(" ");
        let path = folder.join("map.txt");
        std::fs::write(&path, (0..8).map(row).collect::<Vec<_>>().join("\n")).unwrap();
        path
    }

    /// What a command with these flags writes, read.
    fn scene_of(name: &str, map: &Path, flags: &[String]) -> Result<SceneFile> {
        let map = map.to_str().unwrap();
        let needed = ["--unit", "nm", "--cell", "1 um", "--bodies", "70 GPa 0.33", "--force", "1 uN"];
        let words = ["fractal-contact", name, map].into_iter().chain(needed).map(str::to_owned);
        let matches = command().try_get_matches_from(words.chain(flags.iter().cloned())).unwrap();
        let asked = match Arguments::from_arg_matches(&matches).unwrap().command {
            Command::Press { asked, .. } | Command::New { asked, .. } => asked,
            other => panic!("{other:?}"),
        };
        let at = Path::new("scene.toml");
        super::scene_of(&asked, at, false, "")
    }

    /// Whether two scenes solve the same, whatever their texts are.
    fn same(a: &SceneFile, b: &SceneFile) -> bool {
        a.system == b.system
            && a.models == b.models
            && a.surface == b.surface
            && a.contact_modulus.to_bits() == b.contact_modulus.to_bits()
            && (a.hardness, a.accuracy, a.pair) == (b.hardness, b.accuracy, b.pair)
            && a.effects == b.effects
            && a.request == b.request
            && a.requested == b.requested
            && a.sampling == b.sampling
            && a.reliable_from == b.reliable_from
            && a.filled == b.filled
    }

    /// Each argument whose help shows a default, with that.
    fn shown_defaults(name: &str) -> Vec<(clap::Arg, String)> {
        let mut whole = command();
        whole.build();
        let arguments = whole.find_subcommand(name).unwrap().get_arguments();
        let shown = |argument: &clap::Arg| {
            let default =
                argument.get_default_values().first().map(|word| word.to_string_lossy().into_owned());
            let default = default.filter(|_| !argument.is_hide_default_value_set());
            let help = [argument.get_help(), argument.get_long_help()]
                .into_iter()
                .flatten()
                .map(ToString::to_string);
            let in_help = help
                .collect::<String>()
                .split_once("[default: ")
                .map(|(_, rest)| rest.split(']').next().unwrap().to_owned());
            Some((argument.clone(), default.or(in_help)?))
        };
        arguments.filter(|argument| argument.get_action().takes_values()).filter_map(shown).collect()
    }

    #[test]
    fn every_default_in_the_help_is_what_the_scene_has() {
        let folder = tempfile::tempdir().unwrap();
        let map = tilted_map(folder.path());
        for name in ["press", "new"] {
            let scene = |flags: &[String]| scene_of(name, &map, flags);
            let plain = scene(&[]).unwrap();
            let mut compared = Vec::new();
            for (argument, shown) in shown_defaults(name) {
                let flag = |value: &str| [format!("--{}", argument.get_long().unwrap()), value.to_owned()];
                let id = argument.get_id().as_str();
                let default = match (id, shown.as_str()) {
                    ("out", "out/NAME of the map") => {
                        assert_eq!(crate::default_directory(&map), Path::new("out/map"));
                        continue;
                    }
                    ("scene", "NAME.toml of the map") => {
                        assert_eq!(crate::default_scene(&map), Path::new("map.toml"));
                        continue;
                    }
                    // `Options` has no default of its own.
                    ("threads", "all") => continue,
                    (_, shown) => shown,
                };
                assert!(same(&scene(&flag(default)).unwrap(), &plain), "{name} --{id} {default}");
                // Another value is another scene, or a mistake: the comparison sees the flag.
                let values = argument.get_possible_values();
                let other =
                    values.iter().map(clap::builder::PossibleValue::get_name).find(|value| *value != default);
                let other = scene(&flag(other.unwrap_or("4")));
                assert!(other.is_err() || !same(&other.unwrap(), &plain), "{name} --{id}");
                compared.push(id.to_owned());
            }
            compared.sort_unstable();
            assert_eq!(compared, ["boundary", "decimal", "detrend", "rotate", "skip_lines"]);
        }
        // Other commands leave a map as it is.
        for name in ["info", "twin"] {
            let detrend =
                shown_defaults(name).into_iter().find(|(argument, _)| argument.get_id() == "detrend");
            assert_eq!(detrend.unwrap().1, "none");
        }
    }
}
