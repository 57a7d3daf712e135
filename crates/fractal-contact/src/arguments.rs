//! The command line.

use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use clap::parser::ValueSource;
use clap::{CommandFactory as _, Parser, Subcommand};
use fractal_contact::scenes::{AskedFile, SceneKey, scene_keys};
use runs::ShardChoice;
use runs::cluster::{Division, Submission};
use std::any::TypeId;
use std::path::PathBuf;
use surface_io::{Preprocessing, ReadOptions, Undefined};

/// Computes the contact of rough and smooth elastic bodies. `press` answers the commonest question about a
/// measured map. For everything else a short text file, the scene, names the bodies, the loads, the effects
/// and the results that are computed.
#[derive(Debug, Parser)]
#[command(name = "fractal-contact", version, after_long_help = AFTER)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

/// The command line. A value may begin with a minus, so that a negative one is told by its name and not as an
/// unknown flag; words and paths may not.
pub fn command() -> clap::Command {
    Arguments::command().mut_subcommands(|command| {
        let presses = ["press", "new"].contains(&command.get_name());
        command.mut_args(|argument| {
            // A map that is pressed has no tilt unless somebody wants it; other commands leave a map as it
            // is.
            let argument = if presses && argument.get_id() == "detrend" {
                argument.default_value(PRESS_DETREND.word())
            } else {
                argument
            };
            let argument = if presses && argument.get_id() == "accuracy" {
                argument.conflicts_with_all(["cells", "hardness", "friction", "shear_strength"])
            } else {
                argument
            };
            let flag = argument.get_long().is_some() && argument.get_action().takes_values();
            let words = !argument.get_possible_values().is_empty() && !argument.is_hide_possible_values_set();
            let path = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
            argument.allow_hyphen_values(flag && !words && !path)
        })
    })
}

/// Name of the program.
const PROGRAM: &str = "fractal-contact";

/// The script that completes the command line in a shell.
///
/// In the script for bash a variable holds the name of the subcommand, which the branches of a `case` are
/// labelled with. `clap_complete` makes the hyphen of the program's name `__` in the variable, but another word
/// in the labels, so that no branch of a subcommand is ever taken. The labels are the names that the subcommands
/// have once they are built: here those of a program without a hyphen.
pub fn completions(shell: clap_complete::Shell) -> Vec<u8> {
    let mut command = command();
    if shell == clap_complete::Shell::Bash {
        command.set_bin_name(PROGRAM.replace('-', "__"));
        command.build();
    }
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, PROGRAM, &mut script);
    script
}

/// The default of `--detrend` in `press` and `new`: the tilt of the map is subtracted.
pub const PRESS_DETREND: surface_io::Detrend = surface_io::Detrend::Plane;

const AFTER: &str = "\
A scene:
  # A steel ball on a plate of aluminium: Hertz and boundary elements side by side.
  [scene]
  models = [\"hertz\", \"bem3d\"]
  bodies = [{ young = \"210 GPa\", poisson = 0.3 }, { young = \"70 GPa\", poisson = 0.33 }]
  force = { from = \"1 N\", to = \"100 N\", count = 5 }
  [scene.body]
  kind = \"sphere\"
  radius = \"10 mm\"
  side = \"2 mm\"
  [outputs]
  stiffness = true
  [models.bem3d]
  cells = 129

Examples:
  fractal-contact press map.sur --bodies '210 GPa 0.3, 210 GPa 0.3' --pressure '1 MPa,10 MPa'     the contact of a measured map
  fractal-contact plan scene.toml              what will be computed, how accurately, and how long it takes
  fractal-contact run scene.toml               writes report.html, results.csv and the requested fields into out/scene/
  fractal-contact run scene.toml --out DIR --threads 2
  fractal-contact submit scene.toml --engine slurm --tasks 20 --now      its surfaces on a cluster; then status and merge
  fractal-contact models                       what each model can do
  fractal-contact info results.csv             also for scenes and surfaces
  fractal-contact surface rough.txt --seed 1 --size '1 mm' --rms-height '1 um'
  fractal-contact completions bash > /etc/bash_completion.d/fractal-contact
  fractal-contact man ~/.local/share/man/man1

Exit codes:
  0    Everything was computed.
  1    An error ended the command.
  2    There is a mistake in the scene or in the arguments.
  3    The command ran to its end, but some loads were refused, could not be held (pull-off), or did not converge.
  130  Ctrl-C, SIGTERM or SIGHUP stopped the run. The states so far are in the files. A second signal ends the program at once.
  141  Nobody reads the output any more.

A run that was stopped or killed goes on with the same command: finished states are kept in the folder .units of the results.
A folder of results belongs to one run: the files of an earlier scene are removed, and files of other programs are never overwritten.";

const SURFACE: &str = "\
Examples:
  fractal-contact surface rough.npy --seed 1
  fractal-contact surface rough.txt --seed 1 --cells 513 --size '1 mm' --rms-height '1 um' --fractal-dimension 2.2
  fractal-contact surface long.xyz --seed 1 --cells 512 --size '4 mm x 1 mm' --rms-height '1 um'

An NPY file holds heights only, so a scene that reads it has to name `unit`, and `size` or `cell`. Text and XYZ files hold these too.";

const PRESS: &str = "\
Examples:
  fractal-contact press map.sur --bodies '210 GPa 0.3, 210 GPa 0.3' --pressure '1 MPa,10 MPa'
  fractal-contact press map.npy --unit nm --cell '0.5 um' --bodies 'rigid, 70 GPa 0.33' --pressure '1 MPa,10 MPa'
  fractal-contact press map.sur --bodies 'rigid, 70 GPa 0.33' --force '1 N' --hardness '1 GPa' --fill neighbours
  fractal-contact press map.sur --bodies '210 GPa 0.3, 210 GPa 0.3' --force '1 N' --friction 0.3 --tangential-force '0.1 N'
  fractal-contact press map.sur --contact-modulus '115 GPa' --pressure '1 MPa,10 MPa'

Bodies, a load, and the unit and size of a map whose file does not hold them are needed. If something is missing, the program asks for it and
prints the whole command with an example. A tilt of the map is subtracted: --detrend none keeps it.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Computes the contact of a measured map: writes a scene from the flags, and runs it.
    #[command(after_help = PRESS)]
    Press {
        #[command(flatten)]
        asked: Box<PressArguments>,
        /// Directory of the results and of the scene that is run (scene.toml) [default: out/NAME of the map].
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Number of threads. Each one solves one model on one surface [default: all].
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..).map(usize::from))]
        threads: Option<usize>,
        /// Also prints the whole plan before the run, and time, work and memory after it.
        #[arg(long, short)]
        verbose: bool,
    },
    /// Writes the scene that `press` would run, so that it can be edited first.
    #[command(after_help = PRESS)]
    New {
        #[command(flatten)]
        asked: Box<PressArguments>,
        /// File of the scene, which is never overwritten [default: NAME.toml of the map].
        #[arg(long, value_name = "FILE")]
        scene: Option<PathBuf>,
    },
    /// Prints what a scene will compute and what it leaves out, how accurate it will be, and how long it will
    /// take.
    Plan {
        /// The scene.
        scene: PathBuf,
        /// Directory of the results, in which the states are kept that `accuracy` solves to choose the grid
        /// [default: out/NAME of the scene].
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Also predicts jobs, core-hours, memory of a task, duration and disk space on N nodes of a cluster.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
        nodes: Option<u16>,
        /// Cores of each node [default: those of this machine].
        #[arg(long, value_name = "N", requires = "nodes", value_parser = clap::value_parser!(u16).range(1..))]
        node_cores: Option<u16>,
        #[command(flatten)]
        division: Division,
    },
    /// Lists the models and what each can do: surfaces, boundaries, effects, loads, paths, outputs.
    Models {
        /// The name of one model, which is then listed alone.
        name: Option<String>,
    },
    /// Computes a scene and writes its results.
    Run {
        /// The scene.
        scene: PathBuf,
        /// Directory of the results [default: out/NAME of the scene].
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Number of threads. Each one solves one model on one surface [default: all].
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..).map(usize::from))]
        threads: Option<usize>,
        /// Computes everything anew, also the states that an earlier run has stored.
        #[arg(long)]
        fresh: bool,
        /// Computes part i of N parts of the surfaces, counted from 0 (such as 0/4), and stores it without
        /// tables. `auto` takes i and N from the variables of a SLURM array or of a HyperQueue task. `merge`
        /// then writes the tables.
        #[arg(long, value_name = "i/N", conflicts_with = "fresh")]
        shard: Option<ShardChoice>,
        /// Also prints the whole plan before the run, and time, work and memory after it.
        #[arg(long, short)]
        verbose: bool,
    },
    /// Writes a batch script for SLURM or HyperQueue that computes the shards of a scene and merges them.
    /// With
    /// --now it is submitted. Shards that are done are not computed again.
    Submit {
        /// The scene.
        scene: PathBuf,
        /// Directory of the results [default: out/NAME of the scene].
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        #[command(flatten)]
        submission: Submission,
        #[command(flatten)]
        division: Division,
    },
    /// Prints which shards in a folder of results are done, running, failed or missing.
    Status(ShardsArguments),
    /// Writes tables and pictures from the shards in a folder of results. It refuses missing and damaged
    /// shards and those of different plans.
    Merge {
        #[command(flatten)]
        options: ShardsArguments,
        /// Also prints the whole plan before the tables, and time, work and memory after them.
        #[arg(long, short)]
        verbose: bool,
    },
    /// Prints what a scene, a surface or a table of results holds.
    Info {
        /// A scene (.toml), results (.csv) or a surface (a file of an instrument or program, NPY or text).
        file: PathBuf,
        /// Prints all channels of the file of a surface as JSON, with lengths in metres, after the steps of the
        /// preprocessing that is asked for.
        #[arg(long, conflicts_with = "channel")]
        json: bool,
        /// Writes statistics of a surface into this directory: parameters of ISO 25178, spectra with their
        /// intervals, height differences, and a self-affine fit.
        #[arg(long, value_name = "DIR", conflicts_with = "json")]
        out: Option<PathBuf>,
        #[command(flatten)]
        more: Box<MapFlags>,
    },
    /// Generates a random self-affine surface. The ending of the file chooses its format: .npy, .txt (text
    /// matrix), .xyz, .vti, .h5, .x3p, .gwy or .nc.
    #[command(after_help = SURFACE)]
    Surface(Box<SurfaceArguments>),
    /// Generates an artificial twin of a map: a surface with the same spectrum and random phases.
    Twin {
        /// The map, in any format that `info` reads.
        file: PathBuf,
        /// The file of the twin. Its ending chooses the format, as for `surface`.
        twin: PathBuf,
        /// Seed of the random phases. The same seed gives the same twin.
        #[arg(long)]
        seed: u64,
        /// Makes the twin isotropic: it has the mean of the spectrum over all directions.
        #[arg(long)]
        rings: bool,
        /// Gives the twin exactly the height distribution of the map. Without it the heights are nearly
        /// Gaussian.
        #[arg(long)]
        keep_heights: bool,
        #[command(flatten)]
        more: Box<MapFlags>,
    },
    /// Prints a script with which a shell completes the arguments of this program.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Writes the manual pages of the program and of each command.
    Man {
        /// Directory of the pages, such as ~/.local/share/man/man1.
        directory: PathBuf,
    },
}

/// What is pressed and how.
#[derive(Debug, Clone, clap::Args)]
#[command(group(clap::ArgGroup::new("law_of_friction").args(["friction", "shear_strength"]).multiple(true)))]
pub struct PressArguments {
    /// The measured map: a file of an instrument or program, NPY or text.
    pub map: PathBuf,
    #[command(flatten)]
    pub problem: ProblemFlags,
    /// The name of --contact-modulus before the first release.
    #[arg(long = "modulus", value_name = "MODULUS", hide = true, conflicts_with_all = ["bodies", "contact_modulus"])]
    former_modulus: Option<String>,
    /// Boundary of the map. With a free boundary nothing outside the map carries load. With a periodic
    /// boundary the map is one tile of an endless surface. Periodic along x or along y alone, it goes on along a line,
    /// and nothing outside of its other edges carries load.
    #[arg(long, default_value = "free", value_parser = ["free", "periodic", "periodic-along-x", "periodic-along-y"])]
    pub boundary: String,
    /// Hardness of the softer body, such as "2 GPa". The contact flows where the pressure reaches it.
    #[arg(long, value_name = "PRESSURE")]
    pub hardness: Option<String>,
    /// Coefficient of friction. Alone it is Coulomb's law. It needs --bodies and --tangential-force.
    #[arg(long, value_name = "MU")]
    pub friction: Option<f64>,
    /// Shear strength of the contact without pressure, such as "20 MPa". Alone it is Tresca's law; the coefficient
    /// of friction times the pressure adds to it. It needs --bodies and --tangential-force.
    #[arg(long, value_name = "PRESSURE")]
    pub shear_strength: Option<String>,
    /// Largest traction that friction holds at any pressure, such as "200 MPa".
    #[arg(long, value_name = "PRESSURE", requires = "law_of_friction")]
    pub traction_limit: Option<String>,
    /// Tangential force along x, such as "0.1 N", applied after the normal load. It is at most what friction
    /// holds: by Coulomb's law the coefficient times the force.
    #[arg(long, value_name = "FORCE", requires = "law_of_friction")]
    pub tangential_force: Option<String>,
    /// Whether normal and tangential tractions act on each other if the bodies differ: full solves both
    /// together, none neglects the coupling.
    #[arg(long, value_parser = ["none", "full"], requires = "law_of_friction")]
    pub coupling: Option<String>,
    /// Radius of a ball that bears the map, such as "10 mm". Without it the map lies on a flat.
    #[arg(long, value_name = "RADIUS")]
    pub ball: Option<String>,
    /// More quantities and fields by their names in a scene, such as displacement,stiffness_fixed_area. Fields are
    /// written as NPY and PNG.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub outputs: Vec<String>,
    /// Any other key of a scene, such as scene.surface.rows=128 or outputs.displacement=npy. It may be given
    /// several times. The book lists the keys in "What a scene may say".
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub file: MapFlags,
}

impl PressArguments {
    /// E* as it was written, under the flag's name or its former one.
    pub fn contact_modulus(&self) -> Option<&str> {
        self.problem.value("contact_modulus").or(self.former_modulus.as_deref())
    }

    /// Whether a law of friction is given.
    pub fn has_friction(&self) -> bool {
        self.friction.is_some() || self.shear_strength.is_some()
    }

    /// Said once where a flag was given under a former name.
    pub fn note(&self) -> Option<&'static str> {
        self.former_modulus.is_some().then_some(
            "note: `--modulus` is read as `--contact-modulus`, which is E* of the pair\n  = help: To give Young's modulus and Poisson's ratio, use `--bodies`.",
        )
    }

    /// Key and values of the loads.
    pub fn load(&self) -> Option<(&'static str, &str)> {
        LOADS.into_iter().find_map(|key| Some((key, self.problem.value(key)?)))
    }
}

/// The loads that are flags.
pub const LOADS: [&str; 3] = ["mean_pressure", "force", "approach"];

/// Flags of a random surface.
#[derive(Debug, clap::Args)]
pub struct SurfaceArguments {
    /// The file of the surface.
    pub file: PathBuf,
    /// Number of cells along x, the columns.
    #[arg(long, default_value_t = 257)]
    pub cells: usize,
    /// Number of cells along y, the rows [default: the number that makes the cells as square as possible].
    #[arg(long)]
    pub rows: Option<usize>,
    /// Side of a square surface, such as "1 mm" or a plain number, or both sides of a rectangle, such as "2
    /// mm x 1 mm".
    #[arg(long, visible_alias = "side", default_value = "1")]
    pub size: String,
    /// Fractal dimension in [2, 3] [default: 2.4].
    #[arg(long)]
    pub fractal_dimension: Option<f64>,
    /// Hurst exponent in [0, 1], instead of the fractal dimension, which is 3 minus the Hurst exponent.
    #[arg(long, conflicts_with = "fractal_dimension")]
    pub hurst: Option<f64>,
    /// Rms height of the surface, such as "1 um" or a plain number.
    #[arg(long, default_value = "0.01")]
    pub rms_height: String,
    /// Roll-off wavelength: the spectrum of longer waves is constant [default: none].
    #[arg(long, value_name = "LENGTH")]
    pub roll_off_wavelength: Option<String>,
    /// Wavelength of the shortest wave [default: two cells].
    #[arg(long, value_name = "LENGTH")]
    pub shortest_wavelength: Option<String>,
    /// Ratio of the wavelengths along the lay to those across it [default: 1, an isotropic surface].
    #[arg(long, value_name = "RATIO")]
    pub anisotropy: Option<f64>,
    /// Direction of the lay in degrees, from x towards y.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, requires = "anisotropy")]
    pub lay: f64,
    /// Shape parameter of a Weibull distribution of the heights [default: heights are nearly Gaussian].
    #[arg(long, value_name = "SHAPE")]
    pub weibull: Option<f64>,
    /// Seed of the random surface. The same seed gives the same surface, here and in a scene.
    #[arg(long)]
    pub seed: u64,
}

/// Flags of the commands that read a folder of shards.
#[derive(Debug, clap::Args)]
pub struct ShardsArguments {
    /// Directory of the results.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The beginning of the digest of a plan, if the directory holds shards of several plans.
    #[arg(long, value_name = "DIGEST")]
    pub plan: Option<String>,
}

/// Keys of a scene that are flags, as they were written.
#[derive(Debug, Default, Clone)]
pub struct KeyFlags<const OF_MAP: bool>(Vec<(&'static str, String)>);

/// How the file of a map is read, and what is done to the map: everyday keys of `[scene.surface]`.
pub type MapFlags = KeyFlags<true>;

/// The material, the loads and the grid: everyday keys of `[scene]`, and the number of cells.
pub type ProblemFlags = KeyFlags<false>;

impl<const OF_MAP: bool> KeyFlags<OF_MAP> {
    /// The flags that were given, by the names of their keys.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.0.iter().map(|(key, text)| (*key, text.as_str()))
    }

    /// Adds a flag that was not given.
    pub fn add(&mut self, key: &'static str, text: &str) {
        self.0.push((key, text.to_owned()));
    }

    /// The value of a flag.
    pub fn value(&self, key: &str) -> Option<&str> {
        self.given().find(|(name, _)| *name == key).map(|(_, text)| text)
    }
}

impl<const OF_MAP: bool> clap::Args for KeyFlags<OF_MAP> {
    fn augment_args(command: clap::Command) -> clap::Command {
        keys(OF_MAP).fold(command, |command, key| command.arg(flag(&key)))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl<const OF_MAP: bool> clap::FromArgMatches for KeyFlags<OF_MAP> {
    fn from_arg_matches(matches: &clap::ArgMatches) -> Result<Self, clap::Error> {
        let typed = |key: &SceneKey| matches.value_source(key.name) == Some(ValueSource::CommandLine);
        let value = |key: SceneKey| {
            Some((key.name, matches.get_raw(key.name)?.next()?.to_string_lossy().into_owned()))
        };
        Ok(Self(keys(OF_MAP).filter(typed).filter_map(value).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &clap::ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl MapFlags {
    /// How the file is read, and what is done to its map. Points without a height stay undefined, unless they are
    /// given one.
    ///
    /// # Errors
    /// The first flag whose value is wrong.
    pub fn options(&self) -> fractal_contact::scenes::Result<(ReadOptions, Preprocessing)> {
        let mut file = AskedFile::default();
        for (key, text) in self.given() {
            file.set(key, text).map_err(|mistake| mistake.of_flag(key, &flag_of(key)))?;
        }
        let mut preprocessing = file.preprocessing();
        if preprocessing.fill.is_none() {
            preprocessing.undefined = Some(Undefined::NoContact);
        }
        Ok((file.declared, preprocessing))
    }
}

/// The keys of a measured map that are flags, or those of the material, the loads and the grid.
fn keys(of_map: bool) -> impl Iterator<Item = SceneKey> {
    let is = move |key: &SceneKey| match (of_map, key.table) {
        (true, "scene.surface") | (false, "scene") => key.everyday,
        (false, "scene.surface") => key.name == "cells",
        _ => false,
    };
    scene_keys().into_iter().filter(is)
}

/// The flag that sets a key.
pub fn flag_of(key: &str) -> String {
    match key.rsplit('.').next().unwrap_or(key) {
        "mean_pressure" => "--pressure".to_owned(),
        name => format!("--{}", name.replace('_', "-")),
    }
}

/// A flag for a key, with its words and its default.
fn flag(key: &SceneKey) -> clap::Arg {
    let codes: Vec<&str> = key.takes.split('`').skip(1).step_by(2).collect();
    let quoted: Vec<&str> =
        codes.iter().filter_map(|code| code.strip_prefix('"')?.strip_suffix('"')).collect();
    // Values are words alone where nothing else stands in the table.
    let rest: String = key.takes.split('`').step_by(2).collect();
    let alone = rest.split([',', ' ']).all(|word| ["", "or"].contains(&word));
    let words = !quoted.is_empty() && quoted.len() == codes.len() && alone;
    // Kinds of values are shown by their names, and all others in full.
    let kinds = [
        ("length(s)", "LENGTHS"),
        ("length", "LENGTH"),
        ("whole number", "N"),
        ("number", "NUMBER"),
        ("unit", "UNIT"),
        ("pressure(s)", "PRESSURES"),
        ("pressure", "PRESSURE"),
        ("force(s)", "FORCES"),
        ("share", "SHARE"),
        ("two", "BODIES"),
    ];
    let kind =
        kinds.into_iter().find(|(words, _)| key.takes.starts_with(words)).map_or("VALUE", |(_, name)| name);
    let is_clear = quoted.is_empty() || words || kind != "VALUE";
    let takes = if is_clear { String::new() } else { format!(" [values: {}]", plain(key.takes)) };
    let mut help = format!("{}{takes}", plain(key.about));
    help[..1].make_ascii_uppercase();
    let code = key.default.strip_prefix('`').and_then(|rest| rest.strip_suffix('`'));
    let default = code
        .map(|code| code.trim_matches('"'))
        .or_else(|| Some(key.default).filter(|d| d.parse::<f64>().is_ok()));
    let argument = clap::Arg::new(key.name)
        .long(flag_of(key.name).trim_start_matches('-').to_owned())
        .value_name(kind)
        .help(help);
    let argument = match default {
        Some(default) => argument.default_value(default.to_owned()),
        None => argument,
    };
    let argument = argument.conflicts_with_all(key.instead_of.iter().copied().filter(|other| is_flag(other)));
    if words {
        argument.value_parser(PossibleValuesParser::new(quoted.into_iter().map(str::to_owned)))
    } else {
        argument
    }
}

fn is_flag(name: &str) -> bool {
    keys(true).chain(keys(false)).any(|key| key.name == name)
}

/// Markdown as plain text: without quotation marks of code, and with the words of a link alone.
fn plain(markdown: &str) -> String {
    let mut text = String::new();
    let mut rest = markdown;
    while let Some((before, after)) = rest.split_once("](") {
        let (before, words) = before.rsplit_once('[').unwrap_or((before, ""));
        text += before;
        text += words;
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    (text + rest).replace(['`', '$'], "")
}
