//! The models by name, and their numerical options in `[models.NAME]`.

use crate::models::{MODELS, ModelRecord};
use crate::scenes::read::key::{Context, Key, KeyTable, SceneKey};
use crate::scenes::read::{
    Diagnostic, Entries, Entry, ReadResult, RegisteredModel, System, nearest, printed, suggestion,
};
use analytic::greenwood_williamson::SummitHeights;
use analytic::{GreenwoodWilliamson, Persson};
use bem3d::{Bem3d, Method, PeriodicKernel};
use contact_model::{Cells, ContactModel, Size};
use mdr1d::{Equivalent, Mdr1d};
use std::sync::Arc;

/// Largest grid of a scene is the square of this many cells: 216 GB for a light load.
pub(crate) const MOST_CELLS: usize = 1 << 16;

/// Cells of the grid on which it is tested whether models can solve a scene.
const PROBE_CELLS: usize = 33;
const PROBE_ELEMENTS: usize = 1 << 10;

/// A model with its numerics.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Numerics {
    /// Boundary elements in three dimensions.
    Bem3d(Bem3d),
    /// The method of reduction of dimensionality.
    Mdr1d(Mdr1d),
    /// Persson's theory.
    Persson(Persson),
    /// Independent summits.
    GreenwoodWilliamson(GreenwoodWilliamson),
    /// Friction and rheology on the k(d) of boundary elements.
    Equivalent(Equivalent<Bem3d>),
    /// A model without options, of [`crate::models::MODELS`].
    Formula(&'static ModelRecord),
    /// A model of the user's own.
    Registered(RegisteredModel),
}

/// The same model with at most `most` cells along the longer side of the grid on a rectangle of this size, in
/// the same proportion.
fn reduced(model: Bem3d, most: usize, size: Size) -> Bem3d {
    let Cells { columns, rows } = model.grid(size);
    let longer = columns.max(rows);
    if longer <= most {
        return model;
    }
    let fewer = |count: usize| ((count as f64 * (most as f64 / longer as f64)).round() as usize).max(1);
    Bem3d { cells: fewer(columns), rows: model.rows.map(|_| fewer(rows)), ..model }
}

impl Numerics {
    /// Every model of the library with its defaults, in the order of [`MODELS`].
    pub fn all() -> impl Iterator<Item = Self> {
        MODELS.iter().map(|record| match record.name() {
            "bem3d" => Self::Bem3d(Bem3d::default()),
            "mdr1d" => Self::Mdr1d(Mdr1d::default()),
            "persson" => Self::Persson(Persson::default()),
            "greenwood_williamson" => Self::GreenwoodWilliamson(GreenwoodWilliamson::default()),
            "equivalent" => Self::Equivalent(Equivalent::new(Bem3d::default())),
            _ => Self::Formula(record),
        })
    }

    /// The model of the library of this name, with its defaults.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|numerics| numerics.name() == name)
    }

    /// Changes the options that a text names; the text has the form of `[models.NAME]` without its heading.
    ///
    /// # Errors
    /// What is wrong, as in a scene.
    ///
    /// ```
    /// let bem3d = fractal_contact::scenes::Numerics::named("bem3d").unwrap();
    /// assert_eq!(bem3d.configured("cells = 65")?.size(), 65);
    /// # Ok::<(), fractal_contact::scenes::Diagnostic>(())
    /// ```
    pub fn configured(self, options: &str) -> Result<Self, Diagnostic> {
        Entries::of_text(self.name(), options, |table| configured(self, table))
    }

    /// The model itself.
    pub fn model(&self) -> Arc<dyn ContactModel> {
        match *self {
            Self::Bem3d(model) => Arc::new(model),
            Self::Mdr1d(model) => Arc::new(model),
            Self::Persson(model) => Arc::new(model),
            Self::GreenwoodWilliamson(model) => Arc::new(model),
            Self::Equivalent(model) => Arc::new(model),
            Self::Formula(record) => Arc::new(record.model),
            Self::Registered(ref own) => own.model(),
        }
    }

    /// Its name, the same in code, CSV and README.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Registered(own) => own.name(),
            other => other.model().name(),
        }
    }

    /// The record of a model of the library.
    fn record(&self) -> Option<&'static ModelRecord> {
        ModelRecord::named(self.name())
    }

    /// Whether its results depend on the realisation of a self-affine surface and not only on its spectrum: a
    /// theory takes the spectrum and gives the same results for every seed.
    pub fn depends_on_realisation(&self) -> bool {
        matches!(self, Self::Bem3d(_) | Self::Equivalent(_) | Self::Mdr1d(_) | Self::Registered(_))
    }

    /// Whether it uses statistics measured on a rough map instead of the map itself.
    pub(crate) fn is_statistical(&self) -> bool {
        self.record().is_some_and(|record| record.is_statistical)
    }

    /// Whether its states cost enough to be kept on disk; a formula is evaluated again, so that no version
    /// has to be compared.
    pub fn is_stored(&self) -> bool {
        self.size() > 0 || matches!(self, Self::Registered(_))
    }

    /// Columns of a grid, elements of a line; 0 for a formula, and for a registered model.
    pub fn size(&self) -> usize {
        match self {
            Self::Bem3d(numerics) | Self::Equivalent(Equivalent { model: numerics, .. }) => numerics.cells,
            Self::Mdr1d(model) => model.elements,
            _ => 0,
        }
    }

    /// The options of the boundary elements, where the model uses them.
    pub fn boundary_elements(&self) -> Option<&Bem3d> {
        match self {
            Self::Bem3d(numerics) | Self::Equivalent(Equivalent { model: numerics, .. }) => Some(numerics),
            _ => None,
        }
    }

    /// The same model on a grid of at most `cells` cells along the longer side of a rectangle of this size,
    /// or with at most `elements` elements.
    #[must_use]
    pub fn reduced(self, cells: usize, elements: usize, size: Size) -> Self {
        match self {
            Self::Bem3d(model) => Self::Bem3d(reduced(model, cells, size)),
            Self::Mdr1d(model) => Self::Mdr1d(Mdr1d { elements: model.elements.min(elements) }),
            Self::Equivalent(outer) => {
                let model = reduced(outer.model, cells, size);
                Self::Equivalent(Equivalent { model, ..outer })
            }
            other => other,
        }
    }

    /// The same model on a small grid, to test whether it can solve a scene.
    #[must_use]
    pub(crate) fn probe(&self, size: Size) -> Self {
        self.clone().reduced(PROBE_CELLS, PROBE_ELEMENTS, size)
    }

    /// The accuracy to expect of its results, in a sentence. `cells` is used by models that have cells.
    pub fn accuracy(&self, cells: Cells) -> String {
        let Cells { columns, rows } = cells;
        match self {
            Self::Bem3d(numerics) => format!(
                "every state is certified to {:e} (penetration, complementarity, load, and the stiffness where it is no difference quotient) on its {columns} x {rows} cells; the cells \
                 themselves are of first order where a body has edges, and loads that touch fewer than 10 cells are the grid's own",
                numerics.tolerance
            ),
            Self::Equivalent(_) => format!(
                "the normal part is that of bem3d on {columns} x {rows} cells; tangential results are exact for round contacts within Cattaneo's and \
                 Mindlin's assumptions, a few per cent off for others; relaxation is exact while the contact grows, which is checked; the table of k(d) has four digits for smooth \
                 bodies, about two for rough ones (its uncertainty is in `strategy`)"
            ),
            Self::Registered(own) => {
                format!("that of a model of the user's own, version \"{}\"", own.version())
            }
            other => other.record().map_or_else(String::new, |record| record.accuracy.to_owned()),
        }
    }
}

/// Reads the names of the models, in their order.
pub(crate) fn read_models(entry: &Entry<'_>, own: &[RegisteredModel]) -> ReadResult<Vec<Numerics>> {
    let own = own.iter().cloned().map(Numerics::Registered);
    let known: Vec<Numerics> = Numerics::all().chain(own).collect();
    let names: Vec<&str> = known.iter().map(Numerics::name).collect();
    let mut models: Vec<Numerics> = Vec::new();
    let mut unknown: Vec<(Entry<'_>, &str)> = Vec::new();
    for item in entry.list() {
        let name = item.text()?;
        let Some(default) = known.iter().find(|m| m.name() == name) else {
            unknown.push((item, name));
            continue;
        };
        if models.iter().any(|m| m.name() == name) {
            return Err(item
                .diagnostic(format!("the model \"{name}\" is named twice"))
                .with_help("name it once"));
        }
        models.push(default.clone());
    }
    match &unknown[..] {
        [] => {}
        [(item, name)] => {
            let message = format!("there is no model \"{name}\"");
            return Err(item.diagnostic(message).with_help(suggestion(name, &names)));
        }
        [(item, _), ..] => {
            let quoted: Vec<String> = unknown.iter().map(|(_, name)| format!("\"{name}\"")).collect();
            let near = unknown.iter().filter_map(|(_, name)| nearest(name, names.iter().copied()));
            let near: Vec<String> = near.map(|name| format!("\"{name}\"")).collect();
            let meant =
                if near.is_empty() { String::new() } else { format!("did you mean {}? ", near.join(", ")) };
            let message = format!("there are no models {}", quoted.join(", "));
            return Err(item.diagnostic(message).with_help(format!("{meant}Known: {}", names.join(", "))));
        }
    }
    if models.is_empty() {
        return Err(entry.diagnostic("`models` is empty").with_help(format!("known: {}", names.join(", "))));
    }
    Ok(models)
}

/// Reads `[models.NAME]` of the models that are named.
pub(crate) fn read_options(models: &mut [Numerics], options: &Entries<'_>) -> ReadResult<()> {
    for numerics in models.iter_mut() {
        if let Some(table) = options.table(numerics.name())? {
            *numerics = configured(numerics.clone(), table)?;
        }
    }
    let used: Vec<&str> = models.iter().map(Numerics::name).collect();
    for key in options.keys() {
        if !used.contains(&key)
            && let Some(stray) = options.entry(key)
        {
            let known = || Numerics::all().map(|model| model.name()).chain(used.iter().copied());
            if !known().any(|name| name == key) {
                let near = nearest(key, used.iter().copied()).or_else(|| nearest(key, known()));
                let help = near.map_or_else(
                    || format!("named in `models`: {}", used.join(", ")),
                    |near| format!("did you mean [models.{near}]?"),
                );
                return Err(stray
                    .diagnostic_at_key(format!("[models.{key}] is of no model"))
                    .with_help(help));
            }
            return Err(stray
                .diagnostic_at_key(format!(
                    "[models.{key}] says how to compute with a model that `models` does not name"
                ))
                .with_help(format!(
                    "remove the table, or name \"{key}\" in `models` (named: {})",
                    used.join(", ")
                )));
        }
    }
    Ok(())
}

/// Keys of the boundary elements.
static BEM3D_KEYS: KeyTable<Bem3d> = KeyTable {
    name: "models.bem3d",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[
        Key {
            name: "cells",
            takes: "whole number >= 1",
            about: "number of columns of the grid",
            default: "257",
            read: |model, entry, _| entry.size(1).map(|cells| model.cells = cells),
            print: |model, _| (model.cells != Bem3d::default().cells).then(|| model.cells.to_string()),
        },
        Key {
            name: "rows",
            takes: "whole number >= 1",
            about: "number of rows of the grid",
            default: "as many as make cells nearly square",
            read: |model, entry, _| entry.size(1).map(|rows| model.rows = Some(rows)),
            print: |model, _| model.rows.map(|rows| rows.to_string()),
        },
        Key {
            name: "tolerance",
            takes: "number > 0 and < 1",
            about: "tolerance of the solver: relative errors of a state on its grid",
            default: "1e-6",
            read: |model, entry, _| match entry.positive_number()? {
                below if below < 1.0 => {
                    model.tolerance = below;
                    Ok(())
                }
                large => Err(entry.outside(large, "a number < 1").with_help("1e-6 gives six digits")),
            },
            print: |model, _| {
                let is_default = model.tolerance.to_bits() == Bem3d::default().tolerance.to_bits();
                (!is_default).then(|| printed::number(model.tolerance))
            },
        },
        Key {
            name: "max_outer_iterations",
            takes: "whole number >= 1",
            about: "largest number of outer iterations of the solver",
            default: "200",
            read: |model, entry, _| entry.size(1).map(|most| model.max_outer_iterations = most),
            print: |model, _| {
                let most = model.max_outer_iterations;
                (most != Bem3d::default().max_outer_iterations).then(|| most.to_string())
            },
        },
        Key {
            name: "method",
            takes: "`\"auto\"`, `\"iterative\"` or `\"single_level\"`",
            about: "method of solution",
            default: "`\"auto\"`",
            read: |model, entry, _| {
                entry
                    .choice(&Method::ALL.map(|method| (method.as_str(), method)))
                    .map(|method| model.method = method)
            },
            print: |model, _| (model.method != Method::Auto).then(|| printed::text(model.method.as_str())),
        },
        Key {
            name: "periodic_kernel",
            takes: "`\"cells\"` or `\"waves\"`",
            about: "pressures for which the periodic kernel is exact: uniform on cells, or waves as in other programs",
            default: "`\"cells\"`",
            read: |model, entry, _| {
                entry
                    .choice(&PeriodicKernel::ALL.map(|kernel| (kernel.as_str(), kernel)))
                    .map(|kernel| model.periodic_kernel = kernel)
            },
            print: |model, _| {
                let kernel = model.periodic_kernel;
                (kernel != PeriodicKernel::Cells).then(|| printed::text(kernel.as_str()))
            },
        },
        Key {
            name: "time_tolerance",
            takes: "number > 0 and <= 1",
            about: "largest relative error that one step of time of a viscoelastic history adds",
            default: "1e-3",
            read: |model, entry, _| match entry.positive_number()? {
                error if error <= 1.0 => {
                    model.time_tolerance = error;
                    Ok(())
                }
                large => Err(entry
                    .outside(large, "a number <= 1")
                    .with_help("1e-3 is the default; 1 takes the longest steps")),
            },
            print: |model, _| {
                let is_default = model.time_tolerance.to_bits() == Bem3d::DEFAULT.time_tolerance.to_bits();
                (!is_default).then(|| printed::number(model.time_tolerance))
            },
        },
    ],
};

/// Keys of the equivalent profile, besides those of the boundary elements.
static EQUIVALENT_KEYS: KeyTable<Equivalent<Bem3d>> = KeyTable {
    name: "models.equivalent",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[
        Key {
            name: "per_decade",
            takes: "whole number, 1 to 1000",
            about: "number of approaches per decade in the table of k(d); the keys of `bem3d` are those of this model too",
            default: "16",
            read: |model, entry, _| read_up_to(entry, 1000).map(|count| model.per_decade = count),
            print: |model, _| {
                let default = Equivalent::new(Bem3d::default()).per_decade;
                (model.per_decade != default).then(|| model.per_decade.to_string())
            },
        },
        Key {
            name: "decades",
            takes: "whole number, 1 to 12",
            about: "number of decades of the approach in the table",
            default: "3",
            read: |model, entry, _| read_up_to(entry, 12).map(|count| model.decades = count),
            print: |model, _| {
                let default = Equivalent::new(Bem3d::default()).decades;
                (model.decades != default).then(|| model.decades.to_string())
            },
        },
    ],
};

/// Keys of the reduction to one dimension.
static MDR1D_KEYS: KeyTable<Mdr1d> = KeyTable {
    name: "models.mdr1d",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[Key {
        name: "elements",
        takes: "whole number >= 1",
        about: "number of elements of a rough line",
        default: "65536",
        read: |model, entry, _| entry.size(1).map(|elements| model.elements = elements),
        print: |model, _| (model.elements != Mdr1d::default().elements).then(|| model.elements.to_string()),
    }],
};

/// Keys of Persson's theory.
static PERSSON_KEYS: KeyTable<Persson> = KeyTable {
    name: "models.persson",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[Key {
        name: "gamma",
        takes: "number > 0",
        about: "elastic energy over that of full contact",
        default: "0.45",
        read: |model, entry, _| entry.positive_number().map(|gamma| model.gamma = gamma),
        print: |model, _| {
            let is_default = model.gamma.to_bits() == Persson::default().gamma.to_bits();
            (!is_default).then(|| printed::number(model.gamma))
        },
    }],
};

/// Keys of Greenwood and Williamson's theory.
static GREENWOOD_WILLIAMSON_KEYS: KeyTable<GreenwoodWilliamson> = KeyTable {
    name: "models.greenwood_williamson",
    kind: "",
    alternatives: &[],
    everyday: &[],
    keys: &[Key {
        name: "heights",
        takes: "`\"gaussian\"` or `\"exponential\"`",
        about: "distribution of the heights of summits",
        default: "`\"gaussian\"`",
        read: |model, entry, _| entry.choice(&SUMMITS).map(|heights| model.heights = heights),
        print: |model, _| {
            let word = SUMMITS.iter().find(|(_, heights)| *heights == model.heights);
            word.filter(|_| model.heights != SummitHeights::Gaussian).map(|(word, _)| printed::text(word))
        },
    }],
};

const SUMMITS: [(&str, SummitHeights); 2] =
    [("gaussian", SummitHeights::Gaussian), ("exponential", SummitHeights::Exponential)];

fn read_up_to(entry: &Entry<'_>, most: u64) -> ReadResult<u32> {
    match entry.count(1)? {
        count if count <= most => Ok(count as u32),
        count => {
            let outside = entry.outside(count as f64, format!("at most {most}"));
            Err(outside.with_help("16 and 3 by default"))
        }
    }
}

fn configured(numerics: Numerics, table: Entries<'_>) -> ReadResult<Numerics> {
    // No key of numerics has a unit or names a model.
    let context = Context { system: System::None, own: &[] };
    let result = match numerics {
        Numerics::Bem3d(mut model) => {
            BEM3D_KEYS.read(&mut model, &table, context)?;
            Numerics::Bem3d(model)
        }
        Numerics::Equivalent(mut outer) => {
            BEM3D_KEYS.read(&mut outer.model, &table, context)?;
            EQUIVALENT_KEYS.read(&mut outer, &table, context)?;
            Numerics::Equivalent(outer)
        }
        Numerics::Mdr1d(mut model) => {
            MDR1D_KEYS.read(&mut model, &table, context)?;
            Numerics::Mdr1d(model)
        }
        Numerics::Persson(mut model) => {
            PERSSON_KEYS.read(&mut model, &table, context)?;
            Numerics::Persson(model)
        }
        Numerics::GreenwoodWilliamson(mut model) => {
            GREENWOOD_WILLIAMSON_KEYS.read(&mut model, &table, context)?;
            Numerics::GreenwoodWilliamson(model)
        }
        other => other,
    };
    table.finish()?;
    Ok(result)
}

/// Sets an option of a model; `None` where it has none of this name.
pub(crate) fn set_option(numerics: &mut Numerics, entry: &Entry<'_>) -> Option<ReadResult<()>> {
    let context = Context { system: System::None, own: &[] };
    match numerics {
        Numerics::Bem3d(model) => BEM3D_KEYS.set(model, entry, context),
        Numerics::Equivalent(outer) => BEM3D_KEYS
            .set(&mut outer.model, entry, context)
            .or_else(|| EQUIVALENT_KEYS.set(outer, entry, context)),
        Numerics::Mdr1d(model) => MDR1D_KEYS.set(model, entry, context),
        Numerics::Persson(model) => PERSSON_KEYS.set(model, entry, context),
        Numerics::GreenwoodWilliamson(model) => GREENWOOD_WILLIAMSON_KEYS.set(model, entry, context),
        Numerics::Formula(_) | Numerics::Registered(_) => None,
    }
}

/// The keys of a model that differ from their defaults, with their values as TOML.
pub(crate) fn print_options(numerics: &Numerics) -> Vec<(&'static str, String)> {
    let system = System::None;
    match numerics {
        Numerics::Bem3d(model) => BEM3D_KEYS.print(model, system),
        Numerics::Equivalent(outer) => {
            let mut keys = BEM3D_KEYS.print(&outer.model, system);
            keys.extend(EQUIVALENT_KEYS.print(outer, system));
            keys
        }
        Numerics::Mdr1d(model) => MDR1D_KEYS.print(model, system),
        Numerics::Persson(model) => PERSSON_KEYS.print(model, system),
        Numerics::GreenwoodWilliamson(model) => GREENWOOD_WILLIAMSON_KEYS.print(model, system),
        Numerics::Formula(_) | Numerics::Registered(_) => Vec::new(),
    }
}

/// The keys of all models.
pub(crate) fn describe() -> Vec<SceneKey> {
    let mut keys: Vec<SceneKey> = BEM3D_KEYS.describe().collect();
    keys.extend(MDR1D_KEYS.describe());
    keys.extend(EQUIVALENT_KEYS.describe());
    keys.extend(PERSSON_KEYS.describe());
    keys.extend(GREENWOOD_WILLIAMSON_KEYS.describe());
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_with_options_are_variants_and_have_the_numbers_of_their_records() {
        for (numerics, record) in Numerics::all().zip(MODELS) {
            assert_eq!(numerics.name(), record.name());
            assert_eq!(matches!(numerics, Numerics::Formula(_)), !record.has_options, "{record:?}");
            assert_eq!(numerics.model().abilities(), record.model.abilities());
        }
    }

    #[test]
    fn grids_of_rectangles() {
        let grid = |cells, rows| Bem3d { cells, rows, ..Bem3d::default() };
        let wide = Size { x: 4.0, y: 1.0 };
        assert_eq!(grid(64, None).grid(wide), [64, 16].into());
        assert_eq!(grid(64, Some(64)).grid(wide), 64.into());
        assert_eq!(reduced(grid(64, Some(64)), 16, wide), grid(16, Some(16)));
        assert_eq!(reduced(grid(64, Some(8)), 16, wide), grid(16, Some(2)));
        assert_eq!(reduced(grid(16, None), 16, wide), grid(16, None));
        // The longer side of the grid counts, and no side vanishes.
        assert_eq!(reduced(grid(64, None), 16, Size { x: 1.0, y: 4.0 }), grid(4, None));
        assert_eq!(reduced(grid(64, None), 16, Size { x: 1.0, y: 1e4 }), grid(1, None));
    }
}
