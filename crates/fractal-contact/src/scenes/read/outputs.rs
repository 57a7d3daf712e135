//! `[outputs]`: only requested outputs are computed and stored.

use crate::scenes::read::interface_outputs::{
    print_film, print_leakage, print_stress, read_film, read_leakage, read_stress,
};
use crate::scenes::read::key::{Context, Key, KeyTable};
use crate::scenes::read::{Distributed, Entries, Entry, ReadResult, RequestedInterface, System, printed};
use contact_model::{Conductance, FIELDS, FieldQuantity, Output, Outputs};
use surface_io::Dimension;

/// A file format of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldFormat {
    /// Numbers as float64.
    Npy,
    /// A picture with axes and colour bar.
    Png,
    /// A grey-scale picture with a pixel for each cell and nothing else.
    Pixels,
    /// Image data of VTK, for ParaView.
    Vti,
}

impl FieldFormat {
    /// The end of the file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Npy => "npy",
            Self::Png => "png",
            Self::Pixels => "pixels.png",
            Self::Vti => "vti",
        }
    }
}

/// The heights as they are solved: a field of the surface, not of a state.
pub(crate) static HEIGHTS: FieldQuantity = FieldQuantity {
    name: "heights",
    words: "height",
    symbol: "",
    unit: "m",
    meaning: "heights as they are solved: after crop, fill and detrend, or as drawn",
    components: 1,
    white_zero: false,
    signed: false,
    classes: &[],
    outlined: false,
    get: |_| &[],
    take: |_| Vec::new(),
};

/// The pressure of a fluid that flows through the gap.
pub(crate) static FLUID_PRESSURE: FieldQuantity = FieldQuantity {
    name: "fluid_pressure",
    words: "fluid pressure",
    symbol: "",
    unit: "Pa",
    meaning: "pressure of the fluid that leaks, above that at the last edge; 0 where no edge is connected",
    components: 1,
    white_zero: true,
    signed: false,
    classes: &[],
    outlined: true,
    get: |fields| fields.fluid_pressure.as_slice(),
    take: |fields| fields.fluid_pressure.take().into_iter().collect(),
};

/// The flow of this fluid.
pub(crate) static FLUX: FieldQuantity = FieldQuantity {
    name: "flux",
    words: "flow per width",
    symbol: "",
    unit: "m^2/s",
    meaning: "flow of the fluid that leaks, per width, along x and along y",
    components: 2,
    white_zero: true,
    signed: false,
    classes: &[],
    outlined: false,
    get: |fields| fields.flux.as_slice().as_flattened(),
    take: |fields| fields.flux.take().into_iter().flatten().collect(),
};

/// The stress below the surface.
pub(crate) static VON_MISES: FieldQuantity = FieldQuantity {
    name: "von_mises",
    words: "von Mises stress below the surface",
    symbol: "",
    unit: "Pa",
    meaning: "equivalent stress of von Mises below each cell, at the depth where the largest one is",
    components: 1,
    white_zero: true,
    signed: false,
    classes: &[],
    outlined: true,
    get: |fields| fields.von_mises.as_slice(),
    take: |fields| fields.von_mises.take().into_iter().collect(),
};

/// The stress in a vertical section. Its rows are depths, not rows of the map.
pub(crate) static STRESS_SECTION: FieldQuantity = FieldQuantity {
    name: "stress_section",
    words: "von Mises stress in a section",
    symbol: "",
    unit: "Pa",
    meaning: "equivalent stress of von Mises in a vertical section through the largest one, a row for each depth",
    components: 1,
    white_zero: false,
    signed: false,
    classes: &[],
    outlined: false,
    get: |fields| fields.stress_section.as_slice(),
    take: |fields| fields.stress_section.take().into_iter().collect(),
};

/// The six components of the stress in layers below the surface.
pub(crate) static STRESS_VOLUME: FieldQuantity = FieldQuantity {
    name: "stress_volume",
    words: "stress below the surface",
    symbol: "",
    unit: "Pa",
    meaning: "the components xx, yy, zz, yz, xz and xy of the stress in layers below the surface, tension positive",
    components: STRESS_COMPONENTS.len(),
    white_zero: false,
    signed: true,
    classes: &[],
    outlined: false,
    get: |fields| fields.stress_volume.as_deref().unwrap_or(&[]),
    take: |fields| fields.stress_volume.take().unwrap_or_default(),
};

/// The components of a stress, in their order.
pub(crate) const STRESS_COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];

/// Every field that a scene can write to files.
pub(crate) fn all_fields() -> impl Iterator<Item = &'static FieldQuantity> {
    [&HEIGHTS, &FLUID_PRESSURE, &FLUX, &VON_MISES, &STRESS_SECTION, &STRESS_VOLUME].into_iter().chain(FIELDS)
}

/// The requested outputs: results of the models, and files.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(clippy::struct_excessive_bools)] // Keys, each either given or not.
pub struct RequestedOutputs {
    /// Results of the models.
    pub outputs: Outputs,
    /// Fields that are written to files, with their formats.
    pub files: Vec<(Output, Vec<FieldFormat>)>,
    /// Formats of the heights as they are solved: after crop, fill and detrend, or as drawn.
    pub heights: Vec<FieldFormat>,
    /// Formats of the pressure of the fluid that leaks.
    pub fluid_pressure: Vec<FieldFormat>,
    /// Formats of its flow per width.
    pub flux: Vec<FieldFormat>,
    /// Formats of the stress at the depth of the largest one.
    pub von_mises: Vec<FieldFormat>,
    /// Formats of the stress in a section.
    pub stress_section: Vec<FieldFormat>,
    /// Formats of the stress in layers; no pictures.
    pub stress_volume: Vec<FieldFormat>,
    /// Distributions that are counted.
    pub distributions: Vec<Distributed>,
    /// Whether states of boundary elements are compared with those on coarser grids.
    pub grid_error: bool,
    /// Whether statistics of the surface are computed: parameters, spectra, height differences.
    pub statistics: bool,
    /// Leakage, percolation and the stress below the surface.
    pub interface: RequestedInterface,
    /// The width to which the loads between which something begins are refined, as a share of the larger one.
    pub thresholds: Option<f64>,
    /// Whether the law of the interface is written, for other programs.
    pub law: bool,
    /// Whether curves are drawn.
    pub curves: bool,
    /// Numbers of the loads or steps whose fields are drawn; `None` means all.
    pub drawn_states: Option<Vec<usize>>,
}

impl RequestedOutputs {
    /// The fields with their formats; the heights belong to the first state.
    pub fn fields(&self) -> impl Iterator<Item = (&'static FieldQuantity, &[FieldFormat])> {
        all_fields().map(|field| (field, self.formats(field)))
    }

    /// Whether a field of a state is drawn; the heights are those of every state.
    pub fn draws(&self, field: &str, state: usize) -> bool {
        let drawn = self.drawn_states.as_ref().is_none_or(|states| states.contains(&state));
        drawn || field == HEIGHTS.name
    }

    /// Formats of the files of a field.
    fn formats(&self, field: &FieldQuantity) -> &[FieldFormat] {
        let own = [
            (&HEIGHTS, &self.heights),
            (&FLUID_PRESSURE, &self.fluid_pressure),
            (&FLUX, &self.flux),
            (&VON_MISES, &self.von_mises),
            (&STRESS_SECTION, &self.stress_section),
            (&STRESS_VOLUME, &self.stress_volume),
        ];
        if let Some((_, formats)) = own.into_iter().find(|(own, _)| own.name == field.name) {
            return formats;
        }
        let asked = self.files.iter().find(|(output, _)| output.name() == field.name);
        asked.map_or(&[], |(_, formats)| formats)
    }

    /// Requests what files and distributions need of the models: pictures outline the contact, and the gap in
    /// contact is only rounding.
    pub(crate) fn request_what_files_need(&mut self) {
        let counts = |of: Distributed| self.distributions.contains(&of);
        let read_off = [&self.fluid_pressure, &self.flux, &self.von_mises];
        let mut formats = self.files.iter().map(|(_, formats)| formats).chain(read_off);
        let outlined = formats.any(|formats| formats.contains(&FieldFormat::Png));
        let of_pressure = [Distributed::Pressure, Distributed::ContactPressure, Distributed::Gap].map(counts);
        self.outputs.pressure |= outlined || of_pressure.contains(&true);
        self.outputs.gap |= counts(Distributed::Gap) || self.interface.needs_gap();
        self.outputs.mean_gap |= self.law;
        // Contact is where there is a pressure.
        self.outputs.pressure |= !self.interface.outputs().is_empty();
        self.outputs.contact_patches |= counts(Distributed::Patches);
        for (field, _) in &self.files {
            self.outputs.ask(*field, true);
        }
    }

    /// Drops the fields of the stress below the surface, where its largest value is all that counts.
    pub(crate) fn drop_fields_of_stress(&mut self) {
        for formats in [&mut self.von_mises, &mut self.stress_section, &mut self.stress_volume] {
            formats.clear();
        }
    }

    /// Every output, with whether it is requested.
    pub fn lines(&self) -> Vec<(&'static str, bool)> {
        let of_models = Output::ALL.iter().map(|&output| (output.name(), self.outputs.asks(output)));
        let files = [
            (HEIGHTS.name, !self.heights.is_empty()),
            (FLUID_PRESSURE.name, !self.fluid_pressure.is_empty()),
            (FLUX.name, !self.flux.is_empty()),
            (VON_MISES.name, !self.von_mises.is_empty()),
            (STRESS_SECTION.name, !self.stress_section.is_empty()),
            (STRESS_VOLUME.name, !self.stress_volume.is_empty()),
            ("distributions", !self.distributions.is_empty()),
            ("grid_error", self.grid_error),
            ("leakage", self.interface.leakage.is_some()),
            ("percolation", self.interface.percolation),
            ("film", self.interface.film.is_some()),
            ("stress_below", self.interface.stress_below.is_some()),
            ("thresholds", self.thresholds.is_some()),
            ("law", self.law),
            ("curves", self.curves),
            ("statistics", self.statistics),
        ];
        of_models.chain(files).collect()
    }
}

/// The key that says which states are drawn.
pub(crate) const DRAWN_STATES: &str = "drawn_states";

/// Widths of thresholds that solves can tell from the rounding of a load.
const THRESHOLD_WIDTHS: std::ops::RangeInclusive<f64> = 1e-9..=1.0;

/// Keys of `[outputs]` that the program itself computes; those of the models are [`Output::ALL`].
pub(crate) static OUTPUT_KEYS: KeyTable<RequestedOutputs> = KeyTable {
    name: "outputs",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[
        Key {
            name: DRAWN_STATES,
            takes: "list of whole numbers",
            about: "numbers of the loads or steps (from 0) whose fields are drawn, in files and in the report",
            default: "all",
            read: |requested, entry, _| {
                let states = entry.list().iter().map(|state| state.size(0)).collect::<ReadResult<_>>()?;
                requested.drawn_states = Some(states);
                Ok(())
            },
            print: |requested, _| requested.drawn_states.as_ref().map(|states| format!("{states:?}")),
        },
        Key {
            name: "heights",
            takes: "formats",
            about: "the map as `bem3d` solved it, after crop, fill and detrend",
            default: "none",
            read: |requested, entry, _| read_formats(entry).map(|formats| requested.heights = formats),
            print: |requested, _| print_formats(&requested.heights),
        },
        Key {
            name: "fluid_pressure",
            takes: "formats",
            about: "pressure of the fluid of `leakage` in each cell, above that at the last edge",
            default: "none",
            read: |requested, entry, _| read_formats(entry).map(|formats| requested.fluid_pressure = formats),
            print: |requested, _| print_formats(&requested.fluid_pressure),
        },
        Key {
            name: "flux",
            takes: "formats",
            about: "flow per width of the fluid of `leakage` in each cell, along x and along y; pictures have lines, between any two of which the same amount flows, and a ring at the critical constriction of `percolation`",
            default: "none",
            read: |requested, entry, _| read_formats(entry).map(|formats| requested.flux = formats),
            print: |requested, _| print_formats(&requested.flux),
        },
        Key {
            name: "von_mises",
            takes: "formats",
            about: "equivalent stress below each cell, at the depth at which `stress_below` finds the largest one",
            default: "none",
            read: |requested, entry, _| read_formats(entry).map(|formats| requested.von_mises = formats),
            print: |requested, _| print_formats(&requested.von_mises),
        },
        Key {
            name: "stress_section",
            takes: "formats",
            about: "equivalent stress in a vertical section through the largest one of `stress_below`, down to the largest of its `depths`; along x, or along y with `section = \"y\"` in `stress_below`",
            default: "none",
            read: |requested, entry, _| read_formats(entry).map(|formats| requested.stress_section = formats),
            print: |requested, _| print_formats(&requested.stress_section),
        },
        Key {
            name: "stress_volume",
            takes: "formats",
            about: "the six components of the stress in layers of the same thickness, from the surface down to the largest of the `depths` of `stress_below`, as `\"vti\"` (a volume for ParaView) or `\"npy\"` (component, layer, row, column); `layers` in `stress_below` is the number of layers",
            default: "none",
            read: |requested, entry, _| {
                let formats = read_formats(entry)?;
                if formats.iter().any(|format| [FieldFormat::Png, FieldFormat::Pixels].contains(format)) {
                    return Err(entry
                        .diagnostic("a picture of `stress_volume`, which is a volume")
                        .with_help(
                            "`[\"vti\"]` or `[\"npy\"]`; pictures are `stress_section` and `von_mises`",
                        ));
                }
                requested.stress_volume = formats;
                Ok(())
            },
            print: |requested, _| print_formats(&requested.stress_volume),
        },
        Key {
            name: "thresholds",
            takes: "number",
            about: "`thresholds.csv` names two loads between which the interface closes (with `percolation`) and the body yields first (with a `yield_stress`); further loads are solved between them until they differ by no more than this share of the larger one, such as 0.01",
            default: "loads of the scene",
            read: |requested, entry, _| {
                let width = entry.positive_number()?;
                if !THRESHOLD_WIDTHS.contains(&width) {
                    return Err(entry
                        .diagnostic(format!("`thresholds` refined to {width} of the load"))
                        .with_help("a share of the load from 1e-9 to 1, such as 0.01"));
                }
                requested.thresholds = Some(width);
                Ok(())
            },
            print: |requested, _| requested.thresholds.map(|width| format!("{width:?}")),
        },
        Key {
            name: "law",
            takes: "`true` or `false`",
            about: "`law.csv`, which other programs take: mean gap, contact fraction, stiffness, conductance and flow factor over the mean pressure, as far as they are requested, each with its error and over all surfaces; of periodic boundaries",
            default: "`false`",
            read: |requested, entry, _| entry.flag().map(|law| requested.law = law),
            print: |requested, _| requested.law.then(|| "true".to_owned()),
        },
        Key {
            name: "curves",
            takes: "`true` or `false`",
            about: "curves over the load as SVG and PNG",
            default: "`false`",
            read: |requested, entry, _| entry.flag().map(|curves| requested.curves = curves),
            print: |requested, _| requested.curves.then(|| "true".to_owned()),
        },
        Key {
            name: "distributions",
            takes: "of `\"pressure\"`, `\"contact_pressure\"`, `\"gap\"`, `\"patches\"`",
            about: "distributions of these, as CSV and picture, over the nominal area; `contact_pressure` is the pressure over the contact area, `patches` are areas of connected contacts",
            default: "none",
            read: |requested, entry, _| {
                for item in entry.list() {
                    let of = item.choice(&Distributed::ALL)?;
                    if !requested.distributions.contains(&of) {
                        requested.distributions.push(of);
                    }
                }
                Ok(())
            },
            print: |requested, _| {
                let names = requested.distributions.iter().map(|of| printed::text(of.name()));
                let names: Vec<String> = names.collect();
                (!names.is_empty()).then(|| format!("[{}]", names.join(", ")))
            },
        },
        Key {
            name: "grid_error",
            takes: "`true` or `false`",
            about: "`bem3d` compares each state with cells twice and four times as large",
            default: "`false`",
            read: |requested, entry, _| entry.flag().map(|compared| requested.grid_error = compared),
            print: |requested, _| requested.grid_error.then(|| "true".to_owned()),
        },
        Key {
            name: "leakage",
            takes: "table",
            about: "flow of an incompressible fluid through the gap between opposite edges, with proven bounds: `{ viscosity = \"1 mPa s\", pressure_drop = \"1 bar\", along = \"x\" }`; the contact is impermeable, and so are the sides of a map that does not repeat across the flow",
            default: "none",
            read: |requested, entry, context| {
                requested.interface.leakage = Some(read_leakage(entry, context.system)?);
                Ok(())
            },
            print: |requested, system| requested.interface.leakage.map(|of| print_leakage(&of, system)),
        },
        Key {
            name: "percolation",
            takes: "`true` or `false`",
            about: "whether cells with a gap, and cells in contact, lead between opposite edges along x and along y, and the critical constriction, the narrowest cell of the widest path",
            default: "`false`",
            read: |requested, entry, _| entry.flag().map(|asked| requested.interface.percolation = asked),
            print: |requested, _| requested.interface.percolation.then(|| "true".to_owned()),
        },
        Key {
            name: "film",
            takes: "table",
            about: "a film that fills the gap and conducts, beside the `conductance` of the contact: `{ resistivity = \"0.2 Ohm m\" }`, or `{ conductivity = \"0.6 W/(m K)\" }` of heat; with `along = \"x\"` its conductance between opposite edges too",
            default: "none",
            read: |requested, entry, context| {
                requested.interface.film = Some(read_film(entry, context.system)?);
                Ok(())
            },
            print: |requested, system| requested.interface.film.map(|of| print_film(&of, system)),
        },
        Key {
            name: "stress_below",
            takes: "table",
            about: "the largest equivalent stress of von Mises below the surface, and its place: `{ depths = [\"1 um\", \"2 um\", \"5 um\"], yield_stress = \"1 GPa\", body = \"second\", section = \"x\", layers = 16 }`. The depth is refined between the neighbours of the best of `depths`. With `yield_stress` there is the factor on all tractions until yield. `body` is needed where two elastic bodies differ",
            default: "none",
            read: |requested, entry, context| {
                requested.interface.stress_below = Some(read_stress(entry, context.system)?);
                Ok(())
            },
            print: |requested, system| {
                requested.interface.stress_below.as_ref().map(|of| print_stress(of, system))
            },
        },
        Key {
            name: "statistics",
            takes: "`true` or `false`",
            about: "parameters of ISO 25178, spectra, height differences, fit of the surface: [tables and pictures](surfaces.md)",
            default: "`false`",
            read: |requested, entry, _| entry.flag().map(|computed| requested.statistics = computed),
            print: |requested, _| requested.statistics.then(|| "true".to_owned()),
        },
    ],
};

/// Reads `[outputs]`.
pub(crate) fn read_outputs(table: Option<Entries<'_>>, context: Context<'_>) -> ReadResult<RequestedOutputs> {
    let mut requested = RequestedOutputs::default();
    let Some(table) = table else { return Ok(requested) };
    for &output in Output::ALL {
        if let Some(entry) = table.find(output.name()) {
            read_output(&mut requested, output, &entry, context.system)?;
        }
    }
    OUTPUT_KEYS.read(&mut requested, &table, context)?;
    table.finish()?;
    requested.request_what_files_need();
    Ok(requested)
}

/// Sets an output; `None` where there is none of this name.
pub(crate) fn set_output(
    requested: &mut RequestedOutputs,
    entry: &Entry<'_>,
    context: Context<'_>,
) -> Option<ReadResult<()>> {
    match Output::ALL.iter().find(|output| output.name() == entry.name()) {
        Some(output) => Some(read_output(requested, *output, entry, context.system)),
        None => OUTPUT_KEYS.set(requested, entry, context),
    }
}

fn read_output(
    requested: &mut RequestedOutputs,
    output: Output,
    entry: &Entry<'_>,
    system: System,
) -> ReadResult<()> {
    match output {
        Output::Conductance => requested.outputs.conductance = read_conductance(entry, system)?,
        field if field.is_field() => {
            let formats = read_formats(entry)?;
            requested.files.retain(|(other, _)| *other != field);
            if !formats.is_empty() {
                requested.files.push((field, formats));
            }
        }
        number => requested.outputs.ask(number, entry.flag()?),
    }
    Ok(())
}

/// The keys of `[outputs]` that are requested, with their values as TOML.
pub(crate) fn print_outputs(requested: &RequestedOutputs, system: System) -> Vec<(&'static str, String)> {
    let of_model = |output: &Output| {
        let value = match output {
            Output::Conductance => print_conductance(requested.outputs.conductance, system),
            field if field.is_field() => {
                let files = requested.files.iter().find(|(of, _)| of == field);
                files.and_then(|(_, formats)| print_formats(formats))
            }
            number => requested.outputs.asks(*number).then(|| "true".to_owned()),
        };
        Some((output.name(), value?))
    };
    let mut keys: Vec<(&'static str, String)> = Output::ALL.iter().filter_map(of_model).collect();
    keys.extend(OUTPUT_KEYS.print(requested, system));
    keys
}

const FORMATS: [(&str, FieldFormat); 4] = [
    ("npy", FieldFormat::Npy),
    ("png", FieldFormat::Png),
    ("pixels", FieldFormat::Pixels),
    ("vti", FieldFormat::Vti),
];

fn print_formats(formats: &[FieldFormat]) -> Option<String> {
    let word =
        |format| FORMATS.iter().find(|(_, known)| *known == format).map(|(word, _)| printed::text(word));
    let words: Vec<String> = formats.iter().filter_map(|format| word(*format)).collect();
    (!words.is_empty()).then(|| format!("[{}]", words.join(", ")))
}

fn print_conductance(conductance: Conductance, system: System) -> Option<String> {
    let print = |kind: &str, key: &str, values: [f64; 2], dimension| {
        let [first, second] = values.map(|value| printed::quantity(value, dimension, system));
        Some(format!("{{ kind = \"{kind}\", {key} = [{first}, {second}] }}"))
    };
    match conductance {
        Conductance::Electrical { first, second } => {
            print("electrical", "resistivities", [first, second], Dimension::RESISTIVITY)
        }
        Conductance::Thermal { first, second } => {
            print("thermal", "conductivities", [first, second], Dimension::THERMAL_CONDUCTIVITY)
        }
        _ => None,
    }
}

/// `["npy", "png"]`, one of them, or `false`.
fn read_formats(entry: &Entry<'_>) -> ReadResult<Vec<FieldFormat>> {
    if !entry.is_list() && !entry.is_text() {
        return if entry.flag()? {
            Err(entry
                .diagnostic(format!("the field `{}` is requested without a format", entry.name()))
                .with_help("name its files: `[\"npy\"]`, `[\"npy\", \"png\", \"vti\"]`"))
        } else {
            Ok(Vec::new())
        };
    }
    let mut formats = Vec::new();
    for item in entry.list() {
        let format = item.choice(&FORMATS)?;
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    Ok(formats)
}

fn read_conductance(entry: &Entry<'_>, system: System) -> ReadResult<Conductance> {
    let table = entry.table()?;
    let electrical =
        table.require("kind", "\"electrical\"")?.choice(&[("electrical", true), ("thermal", false)])?;
    let (key, example, dimension) = if electrical {
        ("resistivities", "[\"1.7e-8 Ohm m\", \"1.7e-8 Ohm m\"]", Dimension::RESISTIVITY)
    } else {
        ("conductivities", "[\"400 W/(m K)\", \"400 W/(m K)\"]", Dimension::THERMAL_CONDUCTIVITY)
    };
    let both = table.require(key, example)?;
    let values = both.list();
    let [first, second] = &values[..] else {
        return Err(both
            .diagnostic(format!("`{key}` has {} values", values.len()))
            .with_help(format!("two, one for each body: {example}")));
    };
    let (first, second) = (first.positive(dimension, system)?, second.positive(dimension, system)?);
    table.finish()?;
    Ok(if electrical {
        Conductance::Electrical { first, second }
    } else {
        Conductance::Thermal { first, second }
    })
}
