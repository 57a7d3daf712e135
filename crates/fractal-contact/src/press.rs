//! `press` and `new`: from flags to the scene of the commonest question, how large the contact of a measured
//! map is.

use crate::arguments::{Arguments, Bodies, Command, MapArguments, PressArguments, command};
use clap::parser::ValueSource;
use clap::{ArgMatches, Args as _, FromArgMatches as _};
use fractal_contact::scenes::{Error, Result, SceneFile};
use runs::cluster::{quoted, toml};
use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};
use surface_io::{ContentError, Metadata, SurfaceFile};

/// Flags whose values are numbers in a scene.
const NUMBERS: [&str; 6] = ["missing", "skip_lines", "scars", "outliers", "rotate", "cells"];
/// A line of the scene begins its comment in this column.
const COMMENT: usize = 40;

/// Flags of a map as they were written, by the names of their keys in [scene.surface].
pub struct SurfaceKeys(Vec<(String, String)>);

impl SurfaceKeys {
    /// Those of the command that was called.
    pub fn given(matches: &ArgMatches) -> Self {
        let matches = matches.subcommand().map_or(matches, |(_, own)| own);
        let flags = MapArguments::augment_args(clap::Command::default());
        let names = flags.get_arguments().map(|flag| flag.get_id().to_string()).chain(["cells".to_owned()]);
        let given = names.filter(|name| matches.value_source(name) == Some(ValueSource::CommandLine));
        let raw = |name: String| {
            let value = matches.get_raw(&name)?.next()?.to_string_lossy().into_owned();
            Some((name, value))
        };
        Self(given.filter_map(raw).collect())
    }

    fn has(&self, keys: &[&str]) -> bool {
        keys.iter().any(|key| self.value(key).is_some())
    }

    fn value(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }
}

/// A flag that a command lacks.
struct Lacking {
    flag: &'static str,
    example: String,
    /// What the flag is, for the message.
    why: String,
    /// Another flag that can be given instead, and what it is.
    instead: Option<(&'static str, &'static str)>,
}

/// The scene of a map, at the place where it will stand.
///
/// # Errors
/// [`Error::Argument`] with all flags that are missing and the whole command with an example of each. Where a
/// flag that is given is wrong, the message begins with that and repeats no command. Other errors are those of
/// the file and of the scene.
pub fn scene(asked: &PressArguments, keys: &SurfaceKeys, at: &Path) -> Result<SceneFile> {
    if asked.map.extension().is_some_and(|ending| ending == "toml") {
        let reason =
            format!("{} is a scene and not a map: `fractal-contact run` takes it", asked.map.display());
        return Err(Error::Argument { name: "map", reason });
    }
    let (declared, _) = asked.map_options();
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
    let lacking = lacking(asked, keys, known.metadata());
    if !lacking.is_empty() {
        return Err(Error::Argument { name: "command", reason: question(&asked.map, &lacking) });
    }
    // The path of the map counts from a folder that has to exist.
    let folder = at.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    if let Some(folder) = folder {
        runs::files::create_directory(folder)?;
    }
    let scene =
        SceneFile::parse(at, text(asked, keys, at, known.metadata().profile)).map_err(|error| match error {
            // There is no such file yet.
            Error::Scene(mistake) => Error::from(mistake.told_of("the scene of these flags")),
            other => other,
        });
    if let (Err(_), Some(folder)) = (&scene, folder) {
        std::fs::remove_dir(folder).ok();
    }
    scene
}

fn lacking(asked: &PressArguments, keys: &SurfaceKeys, map: &Metadata) -> Vec<Lacking> {
    let mut lacking = Vec::new();
    let mut add = |missing: bool, flag, example: &str, why: String, instead| {
        if missing {
            lacking.push(Lacking { flag, example: example.to_owned(), why, instead });
        }
    };
    add(
        map.unit.is_none() && !keys.has(&["unit", "height_scale"]),
        "--unit",
        "nm",
        format!("unit of the heights, which this file ({}) does not hold", map.format),
        None,
    );
    add(
        map.size.is_none() && !keys.has(&["size", "cell"]),
        "--cell",
        "0.5 um",
        format!("side of one of the {} x {} cells of the map", map.columns, map.rows),
        Some(("--size", "side of the whole map, instead of --cell")),
    );
    add(
        map.undefined > 0
            && asked.undefined.is_none()
            && !keys.has(&["fill"])
            && keys.value("crop") != Some("defined"),
        "--undefined",
        "no_contact",
        format!("{} points have no height: with no_contact they cannot touch", map.undefined),
        Some(("--fill", "gives them a height, instead of --undefined: `--fill neighbours`")),
    );
    add(
        asked.friction.is_some() && asked.bodies.is_none(),
        "--bodies",
        "rigid, 210 GPa 0.3",
        "Young's modulus and Poisson's ratio of both bodies, which friction needs".to_owned(),
        None,
    );
    add(
        asked.friction.is_none() && asked.contact_modulus().is_none() && asked.bodies.is_none(),
        "--bodies",
        "210 GPa 0.3, 210 GPa 0.3",
        "Young's modulus and Poisson's ratio of both bodies, here steel on steel".to_owned(),
        Some(("--contact-modulus", "E* of the pair, instead of --bodies: '115 GPa' is steel on steel")),
    );
    let couple = asked.bodies.as_ref().is_none_or(Bodies::couple);
    add(
        asked.friction.is_some() && couple && asked.coupling.is_none(),
        "--coupling",
        "full",
        "the bodies differ, so normal and tangential tractions act on each other: full solves both, none neglects this"
            .to_owned(),
        None,
    );
    add(
        asked.load().is_none(),
        "--pressure",
        "1 MPa,10 MPa",
        "mean pressure over the area of the map, one value or several".to_owned(),
        Some(("--force", "normal force, instead of --pressure; or --approach, counted from first touch")),
    );
    add(
        asked.friction.is_some() && asked.tangential_force.is_none(),
        "--tangential-force",
        "10 mN",
        "tangential force along x, which friction has to hold".to_owned(),
        None,
    );
    lacking
}

/// What is wrong with the flags that are given: with them and the examples the scene is read.
fn mistake(lacking: &[Lacking]) -> Option<String> {
    let examples = lacking.iter().flat_map(|lacking| [lacking.flag, &lacking.example]).map(OsString::from);
    let parsed = command()
        .try_get_matches_from(std::env::args_os().chain(examples))
        .and_then(|matches| Ok((Arguments::from_arg_matches(&matches)?.command, matches)));
    let told = match parsed {
        Ok((Command::Press { asked, .. } | Command::New { asked, .. }, matches)) => {
            // Nothing is written, and this folder exists.
            let at = Path::new("scene.toml");
            match SceneFile::parse(at, text(&asked, &SurfaceKeys::given(&matches), at, false)) {
                Err(Error::Scene(mistake)) => {
                    mistake.told_of("the scene of these flags, with examples of what is missing").to_string()
                }
                _ => return None,
            }
        }
        Ok(_) => return None,
        // Flags that exclude each other; its usage is left out.
        Err(error) => error.to_string().split("\n\n").next()?.to_owned(),
    };
    Some(told.trim_start_matches("error: ").to_owned())
}

/// One message with everything that is missing and the command with an example of each. A command with a mistake
/// is not repeated: the mistake comes first.
fn question(map: &Path, lacking: &[Lacking]) -> String {
    let mistake = mistake(lacking);
    let mut text = mistake.as_ref().map_or_else(String::new, |mistake| format!("{mistake}\n"));
    let _ = write!(text, "some flags are missing for the contact of {}:", map.display());
    for Lacking { flag, why, instead, .. } in lacking {
        for (flag, why) in std::iter::once((*flag, why.as_str())).chain(*instead) {
            let _ = write!(text, "\n  {flag:<19} {why}");
        }
    }
    if mistake.is_some() {
        return text;
    }
    let mut command = vec!["fractal-contact".to_owned()];
    command.extend(std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy())));
    for Lacking { flag, example, .. } in lacking {
        command.extend([(*flag).to_owned(), quoted(example)]);
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

/// The scene as TOML with comments, of a map or of a profile.
fn text(asked: &PressArguments, keys: &SurfaceKeys, at: &Path, profile: bool) -> String {
    let mut scene = Lines::default();
    let _ = writeln!(
        scene.text,
        "{HEADING}{}. `fractal-contact run` takes this file; \"What a scene may say\" in the book has every key.",
        asked.map.file_name().unwrap_or_default().to_string_lossy().escape_default()
    );
    scene.table("scene");
    scene.line("models", "[\"bem3d\"]", "boundary elements: every cell of the map");
    match (&asked.bodies, asked.contact_modulus()) {
        (Some(bodies), _) => scene.line("bodies", &bodies.toml(), "Young's modulus, Poisson's ratio"),
        (None, Some(contact_modulus)) => {
            scene.line(
                "contact_modulus",
                &toml(contact_modulus),
                "E*: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2",
            );
        }
        (None, None) => {}
    }
    if let Some(accuracy) = &asked.accuracy {
        scene.line(
            "accuracy",
            &toml(accuracy),
            "accepted error of the grid, which decides the number of cells",
        );
    }
    if let Some((key, values)) = asked.load() {
        let comment = match key {
            "mean_pressure" => "force over the area of the map",
            "approach" => "from first touch",
            _ => "",
        };
        match asked.friction {
            Some(_) => {
                scene.array_of_tables("scene.path");
                scene.line(key, &value_or_list(values), comment);
                scene.array_of_tables("scene.path");
                let force = asked.tangential_force.as_deref().unwrap_or_default();
                scene.line("tangential_force", &toml(force), "along x, in equal parts");
                scene.line("states", "8", "");
            }
            None => scene.line(key, &value_or_list(values), comment),
        }
    }
    scene.table("scene.surface");
    scene.line("kind", "\"file\"", "");
    scene.line("path", &toml(&seen_from(&asked.map, at)), "from the folder of this file");
    for (key, value) in &keys.0 {
        scene.line(key, &surface_value(key, value), "");
    }
    if let Some(undefined) = &asked.undefined {
        scene.line("undefined", &toml(undefined.word()), "points without a height cannot touch");
    }
    if !keys.has(&["detrend"]) {
        scene.line("detrend", &toml(asked.detrend()), "subtracts a tilt; \"none\" keeps it");
    }
    scene.table("effects");
    scene.comment("\"free\": pressed by itself, nothing outside of the map carries load.");
    scene.comment("\"periodic\": one tile of an endless surface, as many other programs assume.");
    scene.line("boundary", &toml(&asked.boundary), "");
    let effects = [
        (
            "hardness",
            asked.hardness.as_deref().map(|pressure| format!("{{ pressure = {} }}", toml(pressure))),
        ),
        (
            "friction",
            asked.friction.map(|coefficient| match &asked.coupling {
                Some(coupling) => format!("{{ coefficient = {coefficient}, coupling = {} }}", toml(coupling)),
                None => format!("{{ coefficient = {coefficient} }}"),
            }),
        ),
    ];
    for (key, value) in effects {
        if let Some(value) = value {
            scene.line(key, &value, "");
        }
    }
    outputs(&mut scene, asked, profile);
    scene.text
}

/// The table [outputs] of a map or of a profile.
fn outputs(scene: &mut Lines, asked: &PressArguments, profile: bool) {
    scene.table("outputs");
    scene.line("area", "true", "only named outputs are computed");
    let periodic = asked.boundary == "periodic";
    // A half-plane has no approach and no stiffness, because its displacements have no zero at infinity.
    if periodic || !profile {
        scene.line("stiffness", "true", "");
    }
    if periodic {
        scene.line("mean_gap", "true", "distance between the mean planes, in the place of an approach");
    }
    scene.line("contact_patches", "true", "");
    scene.line("pressure", "[\"npy\", \"png\"]", "field of each load");
    scene.line("gap", "[\"png\"]", "");
    if asked.friction.is_some() {
        scene.line("stick_area", "true", "");
        scene.line("curves", "true", "");
    } else {
        scene.line("distributions", "[\"pressure\", \"gap\"]", "");
        if asked.accuracy.is_none() {
            scene.line(
                "grid_error",
                "true",
                "the error of the grid, from cells twice and four times as large",
            );
        }
    }
}

/// Lines of TOML.
#[derive(Default)]
struct Lines {
    text: String,
}

impl Lines {
    fn table(&mut self, name: &str) {
        let _ = write!(self.text, "\n[{name}]\n");
    }

    fn array_of_tables(&mut self, name: &str) {
        let _ = write!(self.text, "\n[[{name}]]\n");
    }

    fn comment(&mut self, text: &str) {
        let _ = writeln!(self.text, "# {text}");
    }

    fn line(&mut self, key: &str, value: &str, comment: &str) {
        let line = format!("{key} = {value}");
        let _ = match comment {
            "" => writeln!(self.text, "{line}"),
            comment => writeln!(self.text, "{line:COMMENT$} # {comment}"),
        };
    }
}

/// One value or, with commas, a list.
fn value_or_list(text: &str) -> String {
    let values: Vec<String> = text.split(',').map(|value| toml(value.trim())).collect();
    match &values[..] {
        [value] => value.clone(),
        _ => format!("[{}]", values.join(", ")),
    }
}

/// The value of a key of [scene.surface], from the flag of the same name.
fn surface_value(key: &str, value: &str) -> String {
    let is_number = value.parse::<f64>().is_ok();
    match (key, value.split_once('x')) {
        ("size" | "cell", Some((x, y))) => format!("[{}, {}]", toml(x.trim()), toml(y.trim())),
        ("crop", _) if value.contains(',') => {
            let numbers: Vec<&str> = value.split(',').map(str::trim).collect();
            match numbers[..] {
                [row, column, rows, columns] => {
                    format!("{{ row = {row}, column = {column}, rows = {rows}, columns = {columns} }}")
                }
                [row, column, cells] => format!("{{ row = {row}, column = {column}, cells = {cells} }}"),
                _ => toml(value),
            }
        }
        ("channel", _) if value.parse::<u32>().is_ok() => value.to_owned(),
        _ if NUMBERS.contains(&key) && is_number => value.to_owned(),
        _ => toml(value),
    }
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

    #[test]
    fn a_path_is_seen_from_the_folder_of_the_scene() {
        let seen = |map: &str, at: &str| seen_from(Path::new(map), Path::new(at));
        assert_eq!(seen("map.npy", "map.toml"), "map.npy");
        assert_eq!(seen("data/map.npy", "out/map/scene.toml"), "../../data/map.npy");
        assert_eq!(seen("map.npy", "./out/scene.toml"), "../map.npy");
        assert_eq!(seen("/a/map.npy", "out/scene.toml"), "/a/map.npy");
        assert!(Path::new(&seen("map.npy", "/elsewhere/scene.toml")).is_absolute());
    }

    #[test]
    fn values_are_those_of_a_scene() {
        assert_eq!(surface_value("size", "2 mm x 1 mm"), "[\"2 mm\", \"1 mm\"]");
        assert_eq!(surface_value("cell", "0.5 um"), "\"0.5 um\"");
        assert_eq!(surface_value("crop", "1,2,30,40"), "{ row = 1, column = 2, rows = 30, columns = 40 }");
        assert_eq!(surface_value("crop", "1,2,30"), "{ row = 1, column = 2, cells = 30 }");
        assert_eq!(surface_value("crop", "centre"), "\"centre\"");
        assert_eq!(surface_value("channel", "2"), "2");
        assert_eq!(surface_value("channel", "Height \"up\""), "\"Height \\\"up\\\"\"");
        assert_eq!(surface_value("missing", "-9999"), "-9999");
        assert_eq!(surface_value("fill", "3 nm"), "\"3 nm\"");
        assert_eq!(value_or_list("1 MPa, 10 MPa"), "[\"1 MPa\", \"10 MPa\"]");
        assert_eq!(value_or_list("1 MPa"), "\"1 MPa\"");
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
        SceneFile::parse(at, text(&asked, &SurfaceKeys::given(&matches), at, false))
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
                    ("cells", "those of the map") => "8",
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
            assert_eq!(compared, ["boundary", "cells", "decimal", "detrend", "rotate", "skip_lines"]);
        }
        // Other commands leave a map as it is.
        for name in ["info", "twin"] {
            let detrend =
                shown_defaults(name).into_iter().find(|(argument, _)| argument.get_id() == "detrend");
            assert_eq!(detrend.unwrap().1, "none");
        }
    }
}
