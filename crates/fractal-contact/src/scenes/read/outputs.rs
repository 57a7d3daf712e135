//! `[outputs]`: only requested outputs are computed and stored.

use crate::scenes::read::{Distributed, Entries, Entry, Read, System};
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

/// The requested outputs: results of the models, and files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RequestedOutputs {
    /// Results of the models.
    pub outputs: Outputs,
    /// Fields that are written to files, with their formats.
    pub files: Vec<(Output, Vec<FieldFormat>)>,
    /// Formats of the heights as they are solved: after crop, fill and detrend, or as drawn.
    pub heights: Vec<FieldFormat>,
    /// Distributions that are counted.
    pub distributions: Vec<Distributed>,
    /// Whether states of boundary elements are compared with those on coarser grids.
    pub grid_error: bool,
    /// Whether statistics of the surface are computed: parameters, spectra, height differences.
    pub statistics: bool,
    /// Whether curves are drawn.
    pub curves: bool,
    /// Numbers of the loads or steps whose fields are drawn; `None` means all.
    pub drawn_states: Option<Vec<usize>>,
}

impl RequestedOutputs {
    /// The fields with their formats; the heights belong to the first state.
    pub fn fields(&self) -> impl Iterator<Item = (&'static FieldQuantity, &[FieldFormat])> {
        [(&HEIGHTS, &self.heights[..])]
            .into_iter()
            .chain(FIELDS.iter().map(|field| (field, self.formats(field))))
    }

    /// Whether a field of a state is drawn; the heights are those of every state.
    pub fn draws(&self, field: &str, state: usize) -> bool {
        let drawn = self.drawn_states.as_ref().is_none_or(|states| states.contains(&state));
        drawn || field == HEIGHTS.name
    }

    /// Formats of the files of a field.
    fn formats(&self, field: &FieldQuantity) -> &[FieldFormat] {
        let asked = self.files.iter().find(|(output, _)| output.name() == field.name);
        asked.map_or(&[], |(_, formats)| formats)
    }

    /// Every output, with whether it is requested.
    pub fn lines(&self) -> Vec<(&'static str, bool)> {
        let of_models = Output::ALL.iter().map(|&output| (output.name(), self.outputs.asks(output)));
        let files = [
            (HEIGHTS.name, !self.heights.is_empty()),
            ("distributions", !self.distributions.is_empty()),
            ("grid_error", self.grid_error),
            ("curves", self.curves),
            ("statistics", self.statistics),
        ];
        of_models.chain(files).collect()
    }
}

/// The key that says which states are drawn.
pub(crate) const DRAWN_STATES: &str = "drawn_states";

/// The keys of `[outputs]`.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    RequestedOutputs::default().lines().into_iter().map(|(name, _)| name).chain([DRAWN_STATES])
}

/// Reads `[outputs]`.
pub(crate) fn read_outputs(table: Option<Entries<'_>>, system: System) -> Read<RequestedOutputs> {
    let mut requested = RequestedOutputs::default();
    let Some(table) = table else { return Ok(requested) };
    let flag = |key: &'static str| table.find(key).map_or(Ok(false), |e| e.flag());
    let formats = |key: &'static str| table.find(key).map_or(Ok(Vec::new()), |e| read_formats(&e));
    for &output in Output::ALL {
        match output {
            Output::Conductance => {
                if let Some(entry) = table.find("conductance") {
                    requested.outputs.conductance = read_conductance(&entry, system)?;
                }
            }
            field if field.is_field() => {
                let formats = formats(field.name())?;
                if !formats.is_empty() {
                    requested.files.push((field, formats));
                }
            }
            number => requested.outputs.ask(number, flag(number.name())?),
        }
    }
    requested.grid_error = flag("grid_error")?;
    requested.curves = flag("curves")?;
    requested.statistics = flag("statistics")?;
    requested.heights = formats(HEIGHTS.name)?;
    if let Some(entry) = table.find(DRAWN_STATES) {
        let states = entry.list().iter().map(|state| state.size(0)).collect::<Read<_>>()?;
        requested.drawn_states = Some(states);
    }
    if let Some(entry) = table.find("distributions") {
        for item in entry.list() {
            let of = item.choice(&Distributed::ALL)?;
            if !requested.distributions.contains(&of) {
                requested.distributions.push(of);
            }
        }
    }
    let counted = |of: Distributed| requested.distributions.contains(&of);
    // Pictures outline the contact; the gap in contact is only rounding.
    let outlined = requested.files.iter().any(|(_, formats)| formats.contains(&FieldFormat::Png));
    let pressure = outlined || counted(Distributed::Pressure) || counted(Distributed::Gap);
    let gap = counted(Distributed::Gap);
    let patches = counted(Distributed::Patches);
    for (field, _) in &requested.files {
        requested.outputs.ask(*field, true);
    }
    requested.outputs.pressure |= pressure;
    requested.outputs.gap |= gap;
    requested.outputs.contact_patches |= patches;
    table.finish()?;
    Ok(requested)
}

/// `["npy", "png"]`, one of them, or `false`.
fn read_formats(entry: &Entry<'_>) -> Read<Vec<FieldFormat>> {
    if !entry.is_list() && !entry.is_text() {
        return if entry.flag()? {
            Err(entry
                .diagnostic("a field is requested without a format")
                .with_help("name its files: `[\"npy\"]`, `[\"npy\", \"png\", \"vti\"]`"))
        } else {
            Ok(Vec::new())
        };
    }
    let mut formats = Vec::new();
    for item in entry.list() {
        let format = item.choice(&[
            ("npy", FieldFormat::Npy),
            ("png", FieldFormat::Png),
            ("pixels", FieldFormat::Pixels),
            ("vti", FieldFormat::Vti),
        ])?;
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    Ok(formats)
}

fn read_conductance(entry: &Entry<'_>, system: System) -> Read<Conductance> {
    let table = entry.table()?;
    let electrical =
        table.require("kind", "\"electrical\"")?.choice(&[("electrical", true), ("thermal", false)])?;
    let (key, example, dimension) = if electrical {
        ("resistivities", "[\"1.7e-8 ohm m\", \"1.7e-8 ohm m\"]", Dimension::RESISTIVITY)
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
