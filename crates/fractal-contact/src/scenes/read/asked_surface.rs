//! The surface of a scene as a question has it: the keys of `[scene.surface]`, `[scene.second_surface]` and
//! `[scene.body]`.

use crate::scenes::read::key::{Context, Key, KeyTable};
use crate::scenes::read::{
    Diagnostic, Entries, Entry, LengthOrPair, ReadResult, System, printed, suggestion,
};
use contact_model::Size;
use std::path::PathBuf;
use std::sync::Arc;
use surface_gen::TwinSpectrum;
use surface_io::{
    AlignLines, Axes, Border, ChannelChoice, Crop, Decimal, Detrend, Dimension, Fill, Format, Mirror,
    Preprocessing, Quantity, ReadOptions, Sides, Undefined, Unit, Window,
};

/// `[scene.surface]`.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedSurface {
    /// A random surface.
    SelfAffine(AskedSelfAffine),
    /// A measured map.
    File(Box<AskedFile>),
}

/// A random self-affine surface, by the keys that are given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct AskedSelfAffine {
    /// Sides of the rectangle.
    pub size: Option<Size>,
    /// Hurst exponent, 3 less the fractal dimension.
    pub hurst: Option<f64>,
    /// Rms height.
    pub rms_height: Option<f64>,
    /// Wavelength above which the spectrum is constant.
    pub roll_off_wavelength: Option<f64>,
    /// The shortest wavelength.
    pub shortest_wavelength: Option<f64>,
    /// Ratio of the wavelengths along and across the lay.
    pub anisotropy: Option<f64>,
    /// Direction of the lay in degrees.
    pub lay: Option<f64>,
    /// Shape of Weibull's law of the heights.
    pub weibull: Option<f64>,
}

/// A measured map, by the keys that are given.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct AskedFile {
    /// Its path, from the folder of the scene.
    pub path: Option<PathBuf>,
    /// The bytes of the file, where they are in memory and are not read from `path`. No key of a scene says this.
    pub content: Option<Arc<[u8]>>,
    /// How the file is read.
    pub declared: ReadOptions,
    /// Steps of preprocessing. The field `detrend` below replaces the one in it.
    pub preprocessing: Preprocessing,
    /// The trend that is subtracted, where one is named.
    pub detrend: Option<Detrend>,
    /// A random surface with the spectrum of the map instead of the map.
    pub twin: Option<TwinSpectrum>,
    /// Whether the twin has the distribution of the map's heights.
    pub keep_heights: Option<bool>,
}

impl AskedFile {
    /// Sets a key of a file from a text, as a flag has it, for a file whose lengths may have no unit: a length
    /// without one is a plain number.
    ///
    /// # Errors
    /// A value that the key does not take, or a key that does not exist.
    pub fn set(&mut self, key: &str, text: &str) -> Result<(), Diagnostic> {
        let plain = text.parse::<Sides>().is_ok_and(|sides| sides.both()[0].dimension() == Dimension::NONE);
        let context = Context { system: if plain { System::None } else { System::Si }, own: &[] };
        Entries::of_word(key, text, |entry| {
            FILE_KEYS.set(self, entry, context).unwrap_or_else(|| {
                let known: Vec<&str> = FILE_KEYS.keys.iter().map(|key| key.name).collect();
                Err(Diagnostic::new(format!("there is no key `{key}`")).with_help(suggestion(key, &known)))
            })
        })
    }

    /// Steps of preprocessing, the detrending included.
    pub fn preprocessing(&self) -> Preprocessing {
        Preprocessing { detrend: self.detrend.unwrap_or_default(), ..self.preprocessing.clone() }
    }
}

/// `[scene.second_surface]`.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct AskedSecond {
    /// The map.
    pub file: AskedFile,
    /// The axis that is reversed, if any, where it is named.
    pub facing: Option<Option<Mirror>>,
    /// Displacement of its centre.
    pub offset: Option<[f64; 2]>,
}

/// `[scene.body]`, by the keys that are given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct AskedBody {
    /// Its kind, by its name in a scene.
    pub kind: Option<&'static str>,
    /// Sides of the rectangle.
    pub size: Option<Size>,
    /// Radius of a sphere or a circle; of a power law, that at which it has its depth.
    pub radius: Option<f64>,
    /// Slope of a cone.
    pub slope: Option<f64>,
    /// Exponent of a power law.
    pub exponent: Option<f64>,
    /// Depth of a power law.
    pub depth: Option<f64>,
    /// Amplitude of a wave.
    pub amplitude: Option<f64>,
    /// Wavelength of a wave.
    pub wavelength: Option<f64>,
}

/// Keys of a self-affine surface.
pub(crate) static SELF_AFFINE_KEYS: KeyTable<AskedSelfAffine> = KeyTable {
    name: "scene.surface",
    kind: "kind = \"self_affine\"",
    alternatives: &[&["side", "size"], &["fractal_dimension", "hurst"]],
    everyday: &[],
    keys: &[
        Key {
            name: "kind",
            takes: "`\"self_affine\"`",
            about: "a random surface",
            default: "",
            read: |_, _, _| Ok(()),
            print: |_, _| Some("\"self_affine\"".to_owned()),
        },
        Key {
            name: "side",
            takes: "length > 0",
            about: "side of a square surface",
            default: "",
            read: |surface, entry, context| {
                read_side(entry, context.system).map(|size| surface.size = Some(size))
            },
            print: |surface, system| print_side(surface.size, system),
        },
        Key {
            name: "size",
            takes: "`[Lx, Ly]`",
            about: "sides of a rectangle along x and y",
            default: "",
            read: |surface, entry, context| {
                read_size(entry, context.system).map(|size| surface.size = Some(size))
            },
            print: |surface, system| print_size(surface.size, system),
        },
        Key {
            name: "fractal_dimension",
            takes: "2 to 3",
            about: "fractal dimension $`D_f = 3 - H`$",
            default: "",
            read: |surface, entry, _| {
                within(entry, 2.0, 3.0).map(|dimension| surface.hurst = Some(3.0 - dimension))
            },
            print: |_, _| None,
        },
        Key {
            name: "hurst",
            takes: "0 to 1",
            about: "Hurst exponent $`H`$",
            default: "",
            read: |surface, entry, _| within(entry, 0.0, 1.0).map(|hurst| surface.hurst = Some(hurst)),
            print: |surface, _| surface.hurst.map(printed::number),
        },
        Key {
            name: "rms_height",
            takes: "length > 0",
            about: "rms height of the surface",
            default: "",
            read: |surface, entry, context| {
                length(entry, context).map(|height| surface.rms_height = Some(height))
            },
            print: |surface, system| print_length(surface.rms_height, system),
        },
        Key {
            name: "roll_off_wavelength",
            takes: "length > 0",
            about: "the spectrum is constant for longer waves",
            default: "no roll-off",
            read: |surface, entry, context| {
                length(entry, context).map(|wavelength| surface.roll_off_wavelength = Some(wavelength))
            },
            print: |surface, system| print_length(surface.roll_off_wavelength, system),
        },
        Key {
            name: "shortest_wavelength",
            takes: "length > 0",
            about: "there are no shorter waves",
            default: "two cells of the grid",
            read: |surface, entry, context| {
                length(entry, context).map(|wavelength| surface.shortest_wavelength = Some(wavelength))
            },
            print: |surface, system| print_length(surface.shortest_wavelength, system),
        },
        Key {
            name: "anisotropy",
            takes: "number > 0",
            about: "ratio of the wavelengths along the lay to those [across](surfaces.md#anisotropic)",
            default: "isotropic",
            read: |surface, entry, _| entry.positive_number().map(|ratio| surface.anisotropy = Some(ratio)),
            print: |surface, _| surface.anisotropy.map(printed::number),
        },
        Key {
            name: "lay",
            takes: "angle",
            about: "direction of the lay in degrees, from x towards y",
            default: "0",
            read: |surface, entry, _| entry.angle().map(|lay| surface.lay = Some(lay)),
            print: |surface, _| surface.lay.map(printed::number),
        },
        Key {
            name: "weibull",
            takes: "number > 0",
            about: "shape of [Weibull's law](surfaces.md#skewed) of the heights; not with `accuracy`",
            default: "nearly Gaussian",
            read: |surface, entry, _| entry.positive_number().map(|shape| surface.weibull = Some(shape)),
            print: |surface, _| surface.weibull.map(printed::number),
        },
    ],
};

/// Keys of a measured map.
pub(crate) static FILE_KEYS: KeyTable<AskedFile> = KeyTable {
    name: "scene.surface",
    kind: "kind = \"file\"",
    alternatives: &[&["size", "cell", "width"], &["fill", "undefined"]],
    everyday: &[
        "channel",
        "format",
        "unit",
        "lateral_unit",
        "size",
        "cell",
        "height_scale",
        "decimal",
        "missing",
        "skip_lines",
        "axes",
        "border",
        "crop",
        "align_lines",
        "scars",
        "outliers",
        "tip_radius",
        "fill",
        "undefined",
        "detrend",
        "filter_across",
        "mirror",
        "rotate",
        "window",
    ],
    keys: &[
        Key {
            name: "kind",
            takes: "`\"file\"`",
            about: "a measured map or profile",
            default: "",
            read: |_, _, _| Ok(()),
            print: |_, _| Some("\"file\"".to_owned()),
        },
        Key {
            name: "path",
            takes: "path",
            about: "the file, in one of the [formats](measured.md#formats); the path counts from the folder of the scene",
            default: "",
            read: |file, entry, _| entry.text().map(|path| file.path = Some(path.into())),
            print: |file, _| file.path.as_ref().map(|path| printed::text(&path.to_string_lossy())),
        },
        Key {
            name: "channel",
            takes: "whole number or name",
            about: "the channel of a file with several: its number, counted from 0, or its name",
            default: "the only one of heights",
            read: |file, entry, _| {
                file.declared.channel = Some(match entry.as_word() {
                    Some(name) => ChannelChoice::Name(name.into()),
                    None => ChannelChoice::Number(entry.size(0)?),
                });
                Ok(())
            },
            print: |file, _| {
                file.declared.channel.as_ref().map(|channel| match channel {
                    ChannelChoice::Number(number) => number.to_string(),
                    ChannelChoice::Name(name) => printed::text(name),
                })
            },
        },
        Key {
            name: "format",
            takes: "a [format](measured.md#formats)",
            about: "format of the file, if its name and its content do not show it",
            default: "found out",
            read: |file, entry, _| {
                let words = Format::ALL.map(|format| (format.word(), format));
                entry.choice(&words).map(|format| file.declared.format = Some(format))
            },
            print: |file, _| file.declared.format.map(|format| printed::text(format.word())),
        },
        Key {
            name: "unit",
            takes: "unit of length",
            about: "unit of the heights, such as nm",
            default: "that of the file",
            read: |file, entry, _| read_unit(entry).map(|unit| file.declared.unit = Some(unit)),
            print: |file, _| file.declared.unit.as_ref().map(print_unit),
        },
        Key {
            name: "lateral_unit",
            takes: "unit of length",
            about: "unit of x and y in a file of points, such as um",
            default: "that of the file",
            read: |file, entry, _| read_unit(entry).map(|unit| file.declared.lateral_unit = Some(unit)),
            print: |file, _| file.declared.lateral_unit.as_ref().map(print_unit),
        },
        Key {
            name: "size",
            takes: "length > 0, or two",
            about: "side of a square map, such as `\"1 mm\"`, or both sides of a rectangular one, such as `\"2 mm x 1 mm\"`",
            default: "that of the file",
            read: |file, entry, context| sides(entry, context).map(|size| file.declared.size = Some(size)),
            print: |file, system| file.declared.size.map(|size| printed::sides(size, system)),
        },
        Key {
            name: "cell",
            takes: "length > 0, or two",
            about: "side of one cell of the map, such as `\"0.5 um\"`, or both sides, such as `\"0.5 um x 0.25 um\"`",
            default: "that of the file",
            read: |file, entry, context| sides(entry, context).map(|cell| file.declared.cell = Some(cell)),
            print: |file, system| file.declared.cell.map(|cell| printed::sides(cell, system)),
        },
        Key {
            name: "width",
            takes: "length > 0",
            about: "",
            default: "",
            read: |file, entry, context| {
                positive_length(entry, context).map(|width| file.declared.width = Some(width))
            },
            print: |file, system| file.declared.width.map(|width| printed::measured(width, system)),
        },
        Key {
            name: "height_scale",
            takes: "length > 0",
            about: "height of one count, such as `\"0.25 nm\"`, in a file whose heights are counts",
            default: "that of the file",
            read: |file, entry, context| {
                positive_length(entry, context).map(|scale| file.declared.height_scale = Some(scale))
            },
            print: |file, system| file.declared.height_scale.map(|scale| printed::measured(scale, system)),
        },
        Key {
            name: "decimal",
            takes: "`\"point\"` or `\"comma\"`",
            about: "decimal separator of a text file",
            default: "`\"point\"`",
            read: |file, entry, _| {
                let words = Decimal::ALL.map(|decimal| (decimal.word(), decimal));
                entry.choice(&words).map(|decimal| file.declared.decimal = decimal)
            },
            print: |file, _| {
                (file.declared.decimal != Decimal::Point).then(|| printed::text(file.declared.decimal.word()))
            },
        },
        Key {
            name: "missing",
            takes: "number, which may be `inf`",
            about: "the number that marks an undefined point in the file, such as -9999",
            default: "none but NaN and the mark of the format",
            read: |file, entry, _| entry.any_number().map(|missing| file.declared.missing = Some(missing)),
            print: |file, _| file.declared.missing.map(printed::number),
        },
        Key {
            name: "skip_lines",
            takes: "whole number",
            about: "number of lines to skip at the beginning of a text file",
            default: "0",
            read: |file, entry, _| entry.size(0).map(|lines| file.declared.skip_lines = lines),
            print: |file, _| (file.declared.skip_lines > 0).then(|| file.declared.skip_lines.to_string()),
        },
        Key {
            name: "axes",
            takes: "`\"xy\"` or `\"yx\"`",
            about: "what the two indices of an array are, if the file does not hold it (HDF5, MATLAB, NetCDF without names)",
            default: "the convention of the format, with a note",
            read: |file, entry, _| {
                let words = Axes::ALL.map(|axes| (axes.word(), axes));
                entry.choice(&words).map(|axes| file.declared.axes = Some(axes))
            },
            print: |file, _| file.declared.axes.map(|axes| printed::text(axes.word())),
        },
        Key {
            name: "border",
            takes: "`\"axes\"` or `\"heights\"`",
            about: "what the first line and the first column of a text matrix are, where they may be coordinates",
            default: "an error where they may be",
            read: |file, entry, _| {
                let words = Border::ALL.map(|border| (border.word(), border));
                entry.choice(&words).map(|border| file.declared.border = Some(border))
            },
            print: |file, _| file.declared.border.map(|border| printed::text(border.word())),
        },
        Key {
            name: "crop",
            takes: "`\"centre\"`, `\"defined\"`, `\"row,column,rows,columns\"` or a table of these",
            about: "the part of the map that is used: the largest square, the largest rectangle without undefined points, or \
                    the given number of rows and columns from a row and a column on, counted from 0, such as `{ row = 10, column = 20, rows = 256, columns = 512 }`",
            default: "the whole map",
            read: |file, entry, _| read_crop(entry).map(|crop| file.preprocessing.crop = Some(crop)),
            print: |file, _| file.preprocessing.crop.map(print_crop),
        },
        Key {
            name: "align_lines",
            takes: "`\"median_difference\"` or `\"median\"`",
            about: "shifts scan lines (rows) to a common height ([errors of scanning](preprocessing.md#errors-of-scanning)): by the median of the differences from the line before, or by the median of each line",
            default: "no shift",
            read: |file, entry, _| {
                let words = AlignLines::ALL.map(|align| (align.word(), align));
                entry.choice(&words).map(|align| file.preprocessing.align_lines = Some(align))
            },
            print: |file, _| file.preprocessing.align_lines.map(|align| printed::text(align.word())),
        },
        Key {
            name: "scars",
            takes: "number",
            about: "removes scars (streaks along x, at most four rows high): points become undefined if they differ from the rows \
                    beside them by more than this number of robust standard deviations",
            default: "none are removed",
            read: |file, entry, _| entry.number().map(|times| file.preprocessing.scars = Some(times)),
            print: |file, _| file.preprocessing.scars.map(printed::number),
        },
        Key {
            name: "outliers",
            takes: "number",
            about: "removes outliers: points become undefined if they differ from the median of their neighbours by more than this \
                    number of robust standard deviations",
            default: "none are removed",
            read: |file, entry, _| entry.number().map(|times| file.preprocessing.outliers = Some(times)),
            print: |file, _| file.preprocessing.outliers.map(printed::number),
        },
        Key {
            name: "tip_radius",
            takes: "length > 0",
            about: "radius of the tip of the instrument, such as `\"10 nm\"`; from it follows the wavelength below which the heights are not reliable",
            default: "not known",
            read: |file, entry, context| {
                positive_length(entry, context).map(|radius| file.preprocessing.tip_radius = Some(radius))
            },
            print: |file, system| {
                file.preprocessing.tip_radius.map(|radius| printed::measured(radius, system))
            },
        },
        Key {
            name: "fill",
            takes: "`\"neighbours\"`, `\"plane\"` or a height",
            about: "gives points without a height (NaN, `missing`) a height: that of their neighbours, that of the mean plane, or one such as `\"3 nm\"`",
            default: "undefined points are an error",
            read: |file, entry, context| {
                read_fill(entry, context).map(|fill| file.preprocessing.fill = Some(fill))
            },
            print: |file, system| {
                file.preprocessing.fill.map(|fill| match fill {
                    Fill::Neighbours => printed::text("neighbours"),
                    Fill::Plane => printed::text("plane"),
                    Fill::Value(height) => printed::measured(height, system),
                })
            },
        },
        Key {
            name: "undefined",
            takes: "`\"no_contact\"`",
            about: "keeps points without a height undefined, and they cannot touch",
            default: "undefined points are an error",
            read: |file, entry, _| {
                let words = Undefined::ALL.map(|undefined| (undefined.word(), undefined));
                entry.choice(&words).map(|undefined| file.preprocessing.undefined = Some(undefined))
            },
            print: |file, _| file.preprocessing.undefined.map(|undefined| printed::text(undefined.word())),
        },
        Key {
            name: "detrend",
            takes: "`\"none\"`, `\"mean\"`, `\"plane\"`, `\"quadric\"`, `\"sphere\"`, `\"cylinder\"`",
            about: "the trend of least squares that is subtracted from the heights",
            default: "`\"none\"`",
            read: |file, entry, _| {
                let words = Detrend::ALL.map(|detrend| (detrend.word(), detrend));
                entry.choice(&words).map(|detrend| file.detrend = Some(detrend))
            },
            print: |file, _| file.detrend.map(|detrend| printed::text(detrend.word())),
        },
        Key {
            name: "filter_across",
            takes: "length > 0",
            about: "cut-off wavelength, such as `\"2 um\"`, of a Gaussian low-pass filter across the scan lines (along y); between four cells and the side",
            default: "no filter",
            read: |file, entry, context| {
                positive_length(entry, context).map(|cutoff| file.preprocessing.filter_across = Some(cutoff))
            },
            print: |file, system| {
                file.preprocessing.filter_across.map(|cutoff| printed::measured(cutoff, system))
            },
        },
        Key {
            name: "mirror",
            takes: "`\"x\"` or `\"y\"`",
            about: "the axis whose direction is reversed",
            default: "none",
            read: |file, entry, _| {
                let words = Mirror::ALL.map(|mirror| (mirror.word(), mirror));
                entry.choice(&words).map(|mirror| file.preprocessing.mirror = Some(mirror))
            },
            print: |file, _| file.preprocessing.mirror.map(|mirror| printed::text(mirror.word())),
        },
        Key {
            name: "rotate",
            takes: "0, 90, 180 or 270",
            about: "angle in degrees by which the map is then turned, from x towards y",
            default: "0",
            read: |file, entry, _| read_rotation(entry).map(|turns| file.preprocessing.quarter_turns = turns),
            print: |file, _| {
                let turns = file.preprocessing.quarter_turns;
                (turns > 0).then(|| (90 * u16::from(turns)).to_string())
            },
        },
        Key {
            name: "window",
            takes: "`\"hann\"`",
            about: "tapers the deviations from the mean towards the edges and divides them by the rms of the taper, for periodic boundaries",
            default: "no window",
            read: |file, entry, _| {
                let words = Window::ALL.map(|window| (window.word(), window));
                entry.choice(&words).map(|window| file.preprocessing.window = Some(window))
            },
            print: |file, _| file.preprocessing.window.map(|window| printed::text(window.word())),
        },
        Key {
            name: "cells",
            takes: "whole number >= 1",
            about: "number of columns, if the map is averaged over larger cells; alone it keeps the shape of the cells",
            default: "those of the file",
            read: |file, entry, _| entry.size(1).map(|cells| file.preprocessing.cells = Some(cells)),
            print: |file, _| file.preprocessing.cells.map(|cells| cells.to_string()),
        },
        Key {
            name: "rows",
            takes: "whole number >= 1",
            about: "number of rows, if the map is averaged over larger cells",
            default: "as many as keep the shape of the cells",
            read: |file, entry, _| entry.size(1).map(|rows| file.preprocessing.rows = Some(rows)),
            print: |file, _| file.preprocessing.rows.map(|rows| rows.to_string()),
        },
        Key {
            name: "twin",
            takes: "`\"waves\"` or `\"rings\"`",
            about: "instead of the map a random surface with its spectrum, [a twin](surfaces.md#twin): of each wave, or of the mean over all directions",
            default: "the map itself",
            read: |file, entry, _| entry.choice(&TWINS).map(|twin| file.twin = Some(twin)),
            print: |file, _| {
                let word =
                    |twin| TWINS.iter().find(|(_, like)| *like == twin).map(|(word, _)| printed::text(word));
                file.twin.and_then(word)
            },
        },
        Key {
            name: "keep_heights",
            takes: "`true` or `false`",
            about: "whether a twin has the distribution of the map's heights",
            default: "`false`",
            read: |file, entry, _| entry.flag().map(|keep| file.keep_heights = Some(keep)),
            print: |file, _| file.keep_heights.map(|keep| keep.to_string()),
        },
    ],
};

/// Keys of the second surface, besides those of a measured map.
pub(crate) static SECOND_KEYS: KeyTable<AskedSecond> = KeyTable {
    name: "scene.second_surface",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[
        Key {
            name: "facing",
            takes: "`\"x\"`, `\"y\"` or `\"none\"`",
            about: "axis that is reversed when the surface is turned over to face the first",
            default: "`\"x\"`",
            read: |second, entry, _| entry.choice(&FACES).map(|facing| second.facing = Some(facing)),
            print: |second, _| second.facing.map(|facing| printed::text(facing.map_or("none", Mirror::word))),
        },
        Key {
            name: "offset",
            takes: "`[x, y]`, lengths",
            about: "displacement of its centre from that of the first surface",
            default: "0",
            read: |second, entry, context| {
                match &entry.list()[..] {
                [x, y] => {
                    let length = |entry: &Entry<'_>| entry.quantity(Dimension::LENGTH, context.system);
                    second.offset = Some([length(x)?, length(y)?]);
                    Ok(())
                }
                _ => Err(entry.diagnostic("`offset` has not two values").with_help(
                    "of the middle of the second surface from that of the first, along x and y: [\"5 um\", \"0 um\"]",
                )),
            }
            },
            print: |second, system| {
                let length = |length| printed::quantity(length, Dimension::LENGTH, system);
                second.offset.map(|offset| printed::list(&offset.map(length)))
            },
        },
    ],
};

/// The kinds of bodies with the keys that each has to have.
pub(crate) const BODIES: [(&str, &[&str]); 7] = [
    ("sphere", &["radius"]),
    ("cone", &["slope"]),
    ("power_law", &["exponent", "depth", "radius"]),
    ("flat_circle", &["radius"]),
    ("flat", &[]),
    ("flat_square", &[]),
    ("sine", &["amplitude", "wavelength"]),
];

/// Keys of a body.
pub(crate) static BODY_KEYS: KeyTable<AskedBody> = KeyTable {
    name: "scene.body",
    kind: "",
    alternatives: &[&["side", "size"]],
    everyday: &[],
    keys: &[
        Key {
            name: "kind",
            takes: "`\"sphere\"`, `\"cone\"`, `\"power_law\"`, `\"flat_circle\"`, `\"flat\"` (or `\"flat_square\"`), `\"sine\"`",
            about: "a body that is added to the surface, or pressed alone",
            default: "",
            read: |body, entry, _| {
                entry.choice(&BODIES.map(|(name, _)| (name, name))).map(|kind| body.kind = Some(kind))
            },
            print: |body, _| body.kind.map(printed::text),
        },
        Key {
            name: "side",
            takes: "length > 0",
            about: "side of the square area; on a surface the body has that of the surface",
            default: "",
            read: |body, entry, context| read_side(entry, context.system).map(|size| body.size = Some(size)),
            print: |body, system| print_side(body.size, system),
        },
        Key {
            name: "size",
            takes: "`[Lx, Ly]`",
            about: "sides of the rectangular area",
            default: "",
            read: |body, entry, context| read_size(entry, context.system).map(|size| body.size = Some(size)),
            print: |body, system| print_size(body.size, system),
        },
        Key {
            name: "radius",
            takes: "length > 0",
            about: "radius of a sphere or of a flat circle; for a power law, the radius at which it has its `depth`",
            default: "other bodies have none",
            read: |body, entry, context| length(entry, context).map(|radius| body.radius = Some(radius)),
            print: |body, system| print_length(body.radius, system),
        },
        Key {
            name: "slope",
            takes: "number > 0",
            about: "slope of a cone",
            default: "other bodies have none",
            read: |body, entry, _| entry.positive_number().map(|slope| body.slope = Some(slope)),
            print: |body, _| body.slope.map(printed::number),
        },
        Key {
            name: "exponent",
            takes: "number > 0",
            about: "exponent of a power law",
            default: "other bodies have none",
            read: |body, entry, _| entry.positive_number().map(|exponent| body.exponent = Some(exponent)),
            print: |body, _| body.exponent.map(printed::number),
        },
        Key {
            name: "depth",
            takes: "length > 0",
            about: "depth of a power law at its `radius`",
            default: "other bodies have none",
            read: |body, entry, context| length(entry, context).map(|depth| body.depth = Some(depth)),
            print: |body, system| print_length(body.depth, system),
        },
        Key {
            name: "amplitude",
            takes: "length > 0",
            about: "amplitude of a sine wave",
            default: "other bodies have none",
            read: |body, entry, context| {
                length(entry, context).map(|amplitude| body.amplitude = Some(amplitude))
            },
            print: |body, system| print_length(body.amplitude, system),
        },
        Key {
            name: "wavelength",
            takes: "length > 0",
            about: "wavelength of a sine wave",
            default: "other bodies have none",
            read: |body, entry, context| {
                length(entry, context).map(|wavelength| body.wavelength = Some(wavelength))
            },
            print: |body, system| print_length(body.wavelength, system),
        },
    ],
};

const TWINS: [(&str, TwinSpectrum); 2] = [("waves", TwinSpectrum::EachWave), ("rings", TwinSpectrum::Rings)];
const FACES: [(&str, Option<Mirror>); 3] = [("x", Some(Mirror::X)), ("y", Some(Mirror::Y)), ("none", None)];

fn length(entry: &Entry<'_>, context: Context<'_>) -> ReadResult<f64> {
    entry.positive(Dimension::LENGTH, context.system)
}

fn print_length(length: Option<f64>, system: System) -> Option<String> {
    length.map(|length| printed::quantity(length, Dimension::LENGTH, system))
}

fn read_side(entry: &Entry<'_>, system: System) -> ReadResult<Size> {
    if entry.is_list() {
        return Err(entry
            .diagnostic(format!("`side` has {} values: it is the one of a square", entry.list().len()))
            .with_help("both sides of a rectangle are `size = [Lx, Ly]`"));
    }
    entry.positive(Dimension::LENGTH, system).map(Size::from)
}

fn read_size(entry: &Entry<'_>, system: System) -> ReadResult<Size> {
    Ok(match entry.lengths(system)? {
        LengthOrPair::One(side) => side.into(),
        LengthOrPair::Two(sides) => sides.into(),
    })
}

fn print_side(size: Option<Size>, system: System) -> Option<String> {
    print_length(size.filter(|size| size.is_square()).map(|size| size.x), system)
}

fn print_size(size: Option<Size>, system: System) -> Option<String> {
    let length = |length| printed::quantity(length, Dimension::LENGTH, system);
    size.filter(|size| !size.is_square()).map(|size| printed::list(&[size.x, size.y].map(length)))
}

fn within(entry: &Entry<'_>, low: f64, high: f64) -> ReadResult<f64> {
    let value = entry.number()?;
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    Err(entry
        .diagnostic(format!("{value} is outside [{low}, {high}]"))
        .with_help("D_f = 3 - H lies in [2, 3], H in [0, 1]"))
}

fn read_unit(entry: &Entry<'_>) -> ReadResult<Unit> {
    entry.text()?.parse().map_err(|error| {
        entry
            .diagnostic(format!("`{}`: {error}", entry.name()))
            .with_help("a unit of length in quotes, such as \"nm\"")
    })
}

fn print_unit(unit: &Unit) -> String {
    let text = unit.to_string();
    printed::text(if text == "no unit" { "none" } else { &text })
}

/// One length or two: sides of the map or of a cell.
fn sides(entry: &Entry<'_>, context: Context<'_>) -> ReadResult<Sides> {
    let length = |value| measured(entry, value, context);
    Ok(match entry.lengths(context.system)? {
        LengthOrPair::One(side) => Sides::One(length(side)?),
        LengthOrPair::Two([x, y]) => Sides::Two([length(x)?, length(y)?]),
    })
}

fn measured(entry: &Entry<'_>, value: f64, context: Context<'_>) -> ReadResult<Quantity> {
    let dimension = if context.system == System::Si { Dimension::LENGTH } else { Dimension::NONE };
    Quantity::new(value, dimension).map_err(|error| entry.diagnostic(error.to_string()))
}

fn positive_length(entry: &Entry<'_>, context: Context<'_>) -> ReadResult<Quantity> {
    measured(entry, length(entry, context)?, context)
}

fn read_crop(entry: &Entry<'_>) -> ReadResult<Crop> {
    if !entry.is_table() {
        // As a flag has it: row, column, rows, columns.
        if let Some(word) = entry.as_word().filter(|word| word.contains(',')) {
            return word.parse().map_err(|error: surface_io::KeywordError| {
                entry.diagnostic(format!("`{}`: {error}", entry.name())).with_help(
                    "row and column of the first cell, counted from 0, then the numbers of rows and of columns",
                )
            });
        }
        return entry.choice(&[("centre", Crop::Centre), ("defined", Crop::Defined)]);
    }
    let window = entry.table()?;
    let number = |key: &'static str, least: u64| window.require(key, "0")?.size(least);
    let (rows, columns) = match window.one_of(&["cells", "rows"])? {
        Some(("cells", cells)) => cells.size(1).map(|cells| (cells, cells))?,
        _ => (number("rows", 1)?, number("columns", 1)?),
    };
    let crop = Crop::Window { row: number("row", 0)?, column: number("column", 0)?, rows, columns };
    window.finish()?;
    Ok(crop)
}

fn print_crop(crop: Crop) -> String {
    match crop {
        Crop::Centre => printed::text("centre"),
        Crop::Defined => printed::text("defined"),
        Crop::Window { row, column, rows, columns } => {
            format!("{{ row = {row}, column = {column}, rows = {rows}, columns = {columns} }}")
        }
    }
}

fn read_fill(entry: &Entry<'_>, context: Context<'_>) -> ReadResult<Fill> {
    match entry.as_word() {
        Some("neighbours") => Ok(Fill::Neighbours),
        Some("plane") => Ok(Fill::Plane),
        _ => {
            let with_help = |diagnostic: Diagnostic| {
                diagnostic
                    .with_help("how undefined points are filled: \"neighbours\", \"plane\" or one height")
            };
            let value = entry.quantity(Dimension::LENGTH, context.system).map_err(with_help)?;
            measured(entry, value, context).map(Fill::Value)
        }
    }
}

fn read_rotation(entry: &Entry<'_>) -> ReadResult<u8> {
    match entry.count(0)? {
        degrees @ (0 | 90 | 180 | 270) => Ok((degrees / 90) as u8),
        degrees => {
            let outside = entry.outside(degrees as f64, "0, 90, 180 or 270");
            Err(outside.with_help("these are degrees, from x towards y"))
        }
    }
}
