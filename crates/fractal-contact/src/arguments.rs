//! The command line.

use clap::builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser};
use clap::{CommandFactory as _, Parser, Subcommand};
use fractal_contact::{Body, Coupling, Friction, Pair};
use runs::ShardChoice;
use runs::cluster::{Division, Submission};
use std::any::TypeId;
use std::error::Error;
use std::ffi::OsStr;
use std::marker::PhantomData;
use std::path::PathBuf;
use std::str::FromStr;
use surface_io::{Preprocessing, ReadOptions};

/// Contact of rough and smooth elastic bodies from a short text file: it says what is pressed, what is asked
/// and which effects count; only that is computed.
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
        command.mut_args(|argument| {
            let flag = argument.get_long().is_some() && argument.get_action().takes_values();
            let words = !argument.get_possible_values().is_empty() && !argument.is_hide_possible_values_set();
            let path = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
            argument.allow_hyphen_values(flag && !words && !path)
        })
    })
}

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
  fractal-contact press map.sur --contact-modulus '115 GPa' --pressure '1 MPa,10 MPa'    the contact of a measured map
  fractal-contact plan scene.toml              what will be computed, what not and why, what it will cost
  fractal-contact run scene.toml               results.csv, manifest.json and what the scene asks for, in out/scene/
  fractal-contact run scene.toml --out DIR --threads 2
  fractal-contact submit scene.toml --engine slurm --tasks 20 --now      its surfaces on a cluster; then status, merge
  fractal-contact models                       what each model can do
  fractal-contact info results.csv             also scenes and surfaces
  fractal-contact surface rough.txt --seed 1 --size '1 mm' --rms-height '1 um'
  fractal-contact completions bash > /etc/bash_completion.d/fractal-contact
  fractal-contact man ~/.local/share/man/man1

Exit codes: 0 done; 1 error; 2 a mistake in the scene or the arguments; 3 done, but some loads were refused or did not converge; 130 stopped
by Ctrl-C, SIGTERM or SIGHUP, with the states so far in the files (a second signal ends at once); 141 nobody reads the output any more.
The same command goes on where it was stopped: finished states are kept in .units of the folder of results, also after a kill.
A folder of results belongs to one run: files of an earlier scene are removed, files of somebody else are not overwritten.";

const SURFACE: &str = "\
Examples:
  fractal-contact surface rough.npy --seed 1
  fractal-contact surface rough.txt --seed 1 --cells 513 --size '1 mm' --rms-height '1 um' --fractal-dimension 2.2
  fractal-contact surface long.xyz --seed 1 --cells 512 --size '4 mm x 1 mm' --rms-height '1 um'

An NPY file holds heights only: a scene that reads it says `unit`, and `size` or `cell`. Text and XYZ say them themselves.";

const PRESS: &str = "\
Examples:
  fractal-contact press map.sur --contact-modulus '115 GPa' --pressure '1 MPa,10 MPa'
  fractal-contact press map.npy --unit nm --cell '0.5 um' --contact-modulus '115 GPa' --pressure '1 MPa,10 MPa'
  fractal-contact press map.sur --bodies 'rigid, 70 GPa 0.33' --force '1 N' --hardness '1 GPa' --fill neighbours
  fractal-contact press map.sur --bodies '210 GPa 0.3, 210 GPa 0.3' --force '1 N' --friction 0.3 --tangential-force '0.1 N'

What neither the file nor the flags say is asked for, with the whole command. A tilt is subtracted unless --detrend says what is.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// The contact of a map at once: writes the scene that flags describe, and runs it.
    #[command(after_help = PRESS)]
    Press {
        #[command(flatten)]
        asked: Box<PressArguments>,
        /// Directory of the results and of scene.toml [default: out/NAME of the map].
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Threads; each takes one model on one surface [default: all].
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..).map(usize::from))]
        threads: Option<usize>,
    },
    /// The scene of `press` without its run, to be edited.
    #[command(after_help = PRESS)]
    New {
        #[command(flatten)]
        asked: Box<PressArguments>,
        /// The scene [default: NAME.toml of the map]; a file that exists is left alone.
        #[arg(long, value_name = "FILE")]
        scene: Option<PathBuf>,
    },
    /// Which models and grids, which effects and outputs and why, accuracy, time and memory to expect.
    Plan {
        /// The scene.
        scene: PathBuf,
        /// Also what it takes on so many nodes: jobs, core-hours, memory of a task, makespan, disk.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
        nodes: Option<u16>,
        /// Cores of a node [default: those of this machine].
        #[arg(long, value_name = "N", requires = "nodes", value_parser = clap::value_parser!(u16).range(1..))]
        node_cores: Option<u16>,
        #[command(flatten)]
        division: Division,
    },
    /// The models, and what each can do: surfaces, boundaries, effects, loads, paths, outputs.
    Models {
        /// One of them alone.
        name: Option<String>,
    },
    /// Computes what the scene asks for.
    Run {
        /// The scene.
        scene: PathBuf,
        /// Directory of the results [default: out/NAME of the scene].
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Threads; each takes one model on one surface [default: all].
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..).map(usize::from))]
        threads: Option<usize>,
        /// Compute again what is stored.
        #[arg(long)]
        fresh: bool,
        /// Do one of N parts of the surfaces, counted from 0, store what it finds and write no table: 0/4, or
        /// auto, as the variables of a SLURM array or of a HyperQueue task say. `merge` makes the tables.
        #[arg(long, value_name = "i/N", conflicts_with = "fresh")]
        shard: Option<ShardChoice>,
    },
    /// Writes a batch script for SLURM or HyperQueue that does the shards of a scene and merges them; with
    /// --now submits it. What is done is not done again.
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
    /// What is done, running, failed and missing of the shards in a folder of results.
    Status(ShardsArguments),
    /// Tables and pictures from the shards in a folder of results. Refuses gaps, damage and mixed plans.
    Merge(ShardsArguments),
    /// What a scene, a surface or a table of results holds.
    Info {
        /// A scene (.toml), results (.csv) or a surface (files of instruments and programs, NPY, text).
        file: PathBuf,
        /// All channels of a surface's file as JSON, lengths in metres.
        #[arg(long, conflicts_with = "channel")]
        json: bool,
        /// Directory for statistics of a surface: parameters of ISO 25178, spectra with bands, height
        /// differences, fit.
        #[arg(long, value_name = "DIR", conflicts_with = "json")]
        out: Option<PathBuf>,
        #[command(flatten)]
        more: Box<MapArguments>,
    },
    /// Draws a self-affine surface into a file, by its ending: .npy, .txt (text matrix), .xyz, .vti, .h5,
    /// .x3p, .gwy or .nc.
    #[command(after_help = SURFACE)]
    Surface(Box<SurfaceArguments>),
    /// Draws an artificial twin of a map: its spectrum, the phases of a seed.
    Twin {
        /// The map: what `info` reads.
        file: PathBuf,
        /// The twin, in the format of its ending as with `surface`.
        twin: PathBuf,
        /// The same seed is the same twin.
        #[arg(long)]
        seed: u64,
        /// An isotropic twin: means over rings of the spectrum instead of each wave.
        #[arg(long)]
        rings: bool,
        /// With the distribution of the map's heights, met exactly, instead of a nearly Gaussian one.
        #[arg(long)]
        keep_heights: bool,
        #[command(flatten)]
        more: Box<MapArguments>,
    },
    /// A script that completes arguments in a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Manual pages of the program and of each command, for `man`.
    Man {
        /// Directory of the pages, such as ~/.local/share/man/man1.
        directory: PathBuf,
    },
}

/// The words of a kind, listed by help and completed by shells.
macro_rules! words {
    ($kind:ty) => {
        PossibleValuesParser::new(<$kind>::ALL.map(<$kind>::word)).try_map(|word| word.parse::<$kind>())
    };
}

/// Values with some words among them, which shells complete.
struct Open<T>(&'static [&'static str], PhantomData<fn() -> T>);

impl<T> Open<T> {
    fn new(words: &'static [&'static str]) -> Self {
        Self(words, PhantomData)
    }
}

impl<T> Clone for Open<T> {
    fn clone(&self) -> Self {
        Self::new(self.0)
    }
}

impl<T> TypedValueParser for Open<T>
where
    T: FromStr<Err: Error + Send + Sync + 'static> + Clone + Send + Sync + 'static,
{
    type Value = T;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<T, clap::Error> {
        StringValueParser::new().try_map(|text| text.parse::<T>()).parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().map(|word| PossibleValue::new(*word))))
    }
}

/// What is pressed and how.
#[derive(Debug, clap::Args)]
pub struct PressArguments {
    /// The map: files of instruments and programs, NPY, text.
    pub map: PathBuf,
    /// E* of the pair, such as "115 GPa".
    #[arg(long, value_name = "MODULUS", conflicts_with = "bodies")]
    contact_modulus: Option<String>,
    /// The name of --contact-modulus before the first release.
    #[arg(long = "modulus", value_name = "MODULUS", hide = true, conflicts_with_all = ["bodies", "contact_modulus"])]
    former_modulus: Option<String>,
    /// Young's modulus and Poisson's ratio of both bodies, such as "210 GPa 0.3, 70 GPa 0.33"; of one, and the other
    /// is rigid.
    #[arg(long)]
    pub bodies: Option<Bodies>,
    /// Mean pressures over the map, such as "1 MPa,10 MPa".
    #[arg(long, value_name = "LIST", conflicts_with_all = ["force", "approach"])]
    pressure: Option<String>,
    /// Normal forces, such as "1 N,10 N".
    #[arg(long, value_name = "LIST", conflicts_with = "approach")]
    force: Option<String>,
    /// Approaches from first touch, such as "10 nm,100 nm".
    #[arg(long, value_name = "LIST")]
    approach: Option<String>,
    /// What lies outside of the map: free (nothing that carries load) or periodic (the map again).
    #[arg(long, value_parser = ["free", "periodic"])]
    pub boundary: Option<String>,
    /// Hardness of the softer body, such as "2 GPa": the contact flows there.
    #[arg(long, value_name = "PRESSURE")]
    pub hardness: Option<String>,
    /// Coefficient of friction; with --bodies and --tangential-force.
    #[arg(long, value_name = "MU")]
    pub friction: Option<f64>,
    /// Tangential force along x, such as "0.1 N".
    #[arg(long, value_name = "FORCE", requires = "friction")]
    pub tangential_force: Option<String>,
    /// Of normal and tangential tractions where the bodies differ: none or full.
    #[arg(long, value_parser = ["none", "full"], requires = "friction")]
    pub coupling: Option<String>,
    /// Error of the cells that is allowed, such as "1 %": as few cells as reach it.
    #[arg(long, value_name = "SHARE", conflicts_with_all = ["cells", "hardness", "friction"])]
    pub accuracy: Option<String>,
    /// Columns after averaging over larger cells [default: those of the map].
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
    /// What becomes of points without a height: no_contact (they cannot touch); see --fill.
    #[arg(long, conflicts_with = "fill", value_parser = words!(surface_io::Undefined))]
    pub undefined: Option<surface_io::Undefined>,
    #[command(flatten)]
    more: MapArguments,
}

impl PressArguments {
    /// How the file is read, and what is done to its map.
    pub fn map_options(&self) -> (ReadOptions, Preprocessing) {
        self.more.clone().options()
    }

    /// E* as it was written, under the flag's name or its former one.
    pub fn contact_modulus(&self) -> Option<&str> {
        self.contact_modulus.as_deref().or(self.former_modulus.as_deref())
    }

    /// Said once where a flag was given under a former name.
    pub fn note(&self) -> Option<&'static str> {
        self.former_modulus.is_some().then_some(
            "note: `--modulus` is read as `--contact-modulus`, which is E* of the pair\n  = help: for Young's modulus and Poisson's ratio give `--bodies`",
        )
    }

    /// Key and values of the loads.
    pub fn load(&self) -> Option<(&'static str, &str)> {
        let Self { pressure, force, approach, .. } = self;
        let loads = [("mean_pressure", pressure), ("force", force), ("approach", approach)];
        loads.into_iter().find_map(|(key, values)| Some((key, values.as_deref()?)))
    }
}

/// Two elastic bodies, or one on a rigid one: Young's modulus as it was written, and Poisson's ratio.
#[derive(Debug, Clone)]
pub struct Bodies([Option<(String, f64)>; 2]);

impl Bodies {
    /// Whether normal and tangential tractions of these bodies act on each other. What is no pressure is told by
    /// the scene.
    pub fn couple(&self) -> bool {
        let body = |body: &Option<(String, f64)>| match body {
            None => Some(Body::Rigid),
            Some((young, poisson)) => {
                let young = surface_io::Quantity::parse_as(young, surface_io::Dimension::PRESSURE).ok()?;
                Some(Body::Elastic { young, poisson: *poisson })
            }
        };
        let solved = Friction::Coulomb { coefficient: 0.0, coupling: Some(Coupling::Full) };
        let coupling =
            || solved.coupling_of(&Pair { first: body(&self.0[0])?, second: body(&self.0[1])? }).ok()?;
        coupling().is_some()
    }

    /// As `bodies` in a scene.
    pub fn toml(&self) -> String {
        let one = |body: &Option<(String, f64)>| match body {
            Some((young, poisson)) => {
                format!("{{ young = {}, poisson = {poisson:?} }}", runs::cluster::toml(young))
            }
            None => "\"rigid\"".to_owned(),
        };
        format!("[{}, {}]", one(&self.0[0]), one(&self.0[1]))
    }
}

impl std::str::FromStr for Bodies {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected Young's modulus and Poisson's ratio of both bodies, such as \"210 GPa 0.3, 70 GPa 0.33\" or \"rigid, 70 GPa 0.33\"";
        let body = |text: &str| match text.trim() {
            "rigid" => Ok(None),
            other => other
                .rsplit_once(char::is_whitespace)
                .and_then(|(young, poisson)| Some(Some((young.trim().to_owned(), poisson.parse().ok()?))))
                .ok_or_else(|| format!("`{other}`: {expected}")),
        };
        match text.split(',').collect::<Vec<_>>()[..] {
            [one] => Ok(Self([None, body(one)?])),
            [first, second] => Ok(Self([body(first)?, body(second)?])),
            _ => Err(expected.to_owned()),
        }
    }
}

/// Flags of a surface that is drawn.
#[derive(Debug, clap::Args)]
pub struct SurfaceArguments {
    /// The file.
    pub file: PathBuf,
    /// Cells along x: columns.
    #[arg(long, default_value_t = 257)]
    pub cells: usize,
    /// Cells along y [default: as many as make the cells nearest to squares].
    #[arg(long)]
    pub rows: Option<usize>,
    /// Side of a square, such as "1 mm" or a plain number, or both of a rectangle, "2 mm x 1 mm".
    #[arg(long, visible_alias = "side", default_value = "1")]
    pub size: String,
    /// Fractal dimension in [2, 3] [default: 2.4].
    #[arg(long)]
    pub fractal_dimension: Option<f64>,
    /// Hurst exponent in [0, 1], instead of the fractal dimension: 3 minus it.
    #[arg(long, conflicts_with = "fractal_dimension")]
    pub hurst: Option<f64>,
    /// Rms height of the samples, such as "1 um", or a plain number.
    #[arg(long, default_value = "0.01")]
    pub rms_height: String,
    /// Longer waves have a constant spectrum [default: none].
    #[arg(long, value_name = "LENGTH")]
    pub roll_off_wavelength: Option<String>,
    /// The shortest wave [default: two cells].
    #[arg(long, value_name = "LENGTH")]
    pub shortest_wavelength: Option<String>,
    /// Ratio of wavelengths along the lay to those across [default: 1, isotropic].
    #[arg(long, value_name = "RATIO")]
    pub anisotropy: Option<f64>,
    /// Direction of the lay in degrees, from x towards y.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, requires = "anisotropy")]
    pub lay: f64,
    /// Shape of Weibull's law of the heights [default: nearly Gaussian].
    #[arg(long, value_name = "SHAPE")]
    pub weibull: Option<f64>,
    /// The same seed is the same surface, here and in a scene.
    #[arg(long)]
    pub seed: u64,
}

/// Flags of what reads a folder of shards.
#[derive(Debug, clap::Args)]
pub struct ShardsArguments {
    /// Directory of the results.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The plan, by the beginning of its digest, where the directory holds several.
    #[arg(long, value_name = "DIGEST")]
    pub plan: Option<String>,
}

/// The keys of [scene.surface] in a scene: how a file is meant, and what is done to the map before it is
/// described.
#[derive(Debug, Default, Clone, clap::Args)]
pub struct MapArguments {
    /// Number, from 0, or name of the channel of a file with several.
    #[arg(long)]
    channel: Option<surface_io::ChannelChoice>,
    /// Format of a surface, where its name and content do not tell.
    #[arg(long, value_parser = words!(surface_io::Format))]
    format: Option<surface_io::Format>,
    /// Unit of its heights, such as nm.
    #[arg(long)]
    unit: Option<surface_io::Unit>,
    /// Side of a square map, such as "1 mm", or both of a rectangle, "2 mm x 1 mm".
    #[arg(long, conflicts_with = "cell")]
    size: Option<surface_io::Sides>,
    /// Side of one cell, such as "0.5 um", or both, "0.5 um x 0.25 um".
    #[arg(long)]
    cell: Option<surface_io::Sides>,
    /// Unit of x and y of points, such as um.
    #[arg(long)]
    lateral_unit: Option<surface_io::Unit>,
    /// Height of one count of a file of counts, such as "0.25 nm".
    #[arg(long, value_name = "LENGTH")]
    height_scale: Option<surface_io::Quantity>,
    /// How decimals are written.
    #[arg(long, default_value = "point", value_parser = words!(surface_io::Decimal))]
    decimal: surface_io::Decimal,
    /// What the two indices of an array are, where its file does not say: xy (the first is x) or yx.
    #[arg(long, value_parser = words!(surface_io::Axes))]
    axes: Option<surface_io::Axes>,
    /// What the first line and the first column of a text matrix are, where they may be coordinates: axes or
    /// heights.
    #[arg(long, value_parser = words!(surface_io::Border))]
    border: Option<surface_io::Border>,
    /// A number that stands for an undefined point, such as -9999.
    #[arg(long)]
    missing: Option<f64>,
    /// Lines of text to leave out at the beginning.
    #[arg(long, default_value_t = 0)]
    skip_lines: usize,
    /// Part of the map: centre, defined (the largest rectangle without undefined points), or
    /// "row,column,rows,columns".
    #[arg(long, value_parser = Open::<surface_io::Crop>::new(&["centre", "defined"]), hide_possible_values = true)]
    crop: Option<surface_io::Crop>,
    /// Shifts scan lines (rows) to a common height: median_difference (to the line before) or median.
    #[arg(long, value_name = "HOW", value_parser = words!(surface_io::AlignLines))]
    align_lines: Option<surface_io::AlignLines>,
    /// Streaks along x, at most four rows tall, become undefined beyond so many robust standard deviations of
    /// the differences between rows.
    #[arg(long, value_name = "TIMES")]
    scars: Option<f64>,
    /// Heights farther from their neighbours than so many robust standard deviations become undefined.
    #[arg(long, value_name = "TIMES")]
    outliers: Option<f64>,
    /// Radius of the instrument's tip, such as "10 nm": says from which distance on heights are reliable.
    #[arg(long, value_name = "LENGTH")]
    tip_radius: Option<surface_io::Quantity>,
    /// Heights for undefined points: neighbours, plane or one height [default: they stay undefined].
    #[arg(long, value_name = "HEIGHTS", value_parser = Open::<surface_io::Fill>::new(&["neighbours", "plane"]), hide_possible_values = true)]
    fill: Option<surface_io::Fill>,
    /// What is subtracted.
    #[arg(long, default_value = "none", value_parser = words!(surface_io::Detrend))]
    detrend: surface_io::Detrend,
    /// Cut-off wavelength of a Gaussian low-pass filter across the scan lines, along y, such as "2 nm".
    #[arg(long, value_name = "LENGTH")]
    filter_across: Option<surface_io::Quantity>,
    /// Which axis is reversed.
    #[arg(long, value_parser = words!(surface_io::Mirror))]
    mirror: Option<surface_io::Mirror>,
    /// Degrees by which the map is turned.
    #[arg(long, default_value = "0", value_parser = ["0", "90", "180", "270"])]
    rotate: String,
    /// Taper towards the edges.
    #[arg(long, value_parser = words!(surface_io::Window))]
    window: Option<surface_io::Window>,
}

impl MapArguments {
    /// How the file is read, and what is done to its map.
    pub fn options(self) -> (ReadOptions, Preprocessing) {
        let preprocessing = Preprocessing {
            crop: self.crop,
            align_lines: self.align_lines,
            scars: self.scars,
            outliers: self.outliers,
            tip_radius: self.tip_radius,
            undefined: self.fill.is_none().then_some(surface_io::Undefined::NoContact),
            fill: self.fill,
            detrend: self.detrend,
            filter_across: self.filter_across,
            mirror: self.mirror,
            // One of four words.
            quarter_turns: self.rotate.parse::<u16>().map_or(0, |degrees| (degrees / 90) as u8),
            window: self.window,
            ..Preprocessing::default()
        };
        let declared = ReadOptions {
            format: self.format,
            channel: self.channel,
            unit: self.unit,
            height_scale: self.height_scale,
            lateral_unit: self.lateral_unit,
            size: self.size,
            cell: self.cell,
            decimal: self.decimal,
            axes: self.axes,
            border: self.border,
            missing: self.missing,
            skip_lines: self.skip_lines,
            ..ReadOptions::default()
        };
        (declared, preprocessing)
    }
}
