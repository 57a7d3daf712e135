//! The models by name, and their numerical options in `[models.NAME]`.

use crate::models::{MODELS, ModelRecord};
use crate::scenes::read::{Diagnostic, Entries, Entry, Read, RegisteredModel, suggestion};
use analytic::greenwood_williamson::SummitHeights;
use analytic::{GreenwoodWilliamson, Persson};
use bem3d::{Bem3d, Method};
use contact_model::{Cells, ContactModel, Size};
use mdr1d::{Equivalent, Mdr1d};
use std::sync::Arc;

/// Largest grid of a scene is the square of this many cells: 54 GB for a light load.
pub(crate) const MOST_CELLS: usize = 1 << 15;

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

/// The models of a scene in the order named, with the place of each name.
pub(crate) fn read_models<'a>(
    scene: &Entries<'a>,
    options: Option<&Entries<'a>>,
    registered: &[RegisteredModel],
) -> Read<Vec<(Numerics, Entry<'a>)>> {
    let entry = scene.require("models", "[\"bem3d\"]")?;
    let own = registered.iter().cloned().map(Numerics::Registered);
    let known: Vec<Numerics> = Numerics::all().chain(own).collect();
    let names: Vec<&str> = known.iter().map(Numerics::name).collect();
    let mut models: Vec<(Numerics, Entry<'a>)> = Vec::new();
    for item in entry.list() {
        let name = item.text()?;
        let Some(default) = known.iter().find(|m| m.name() == name) else {
            return Err(item
                .diagnostic(format!("there is no model \"{name}\""))
                .with_help(suggestion(name, &names)));
        };
        if models.iter().any(|(m, _)| m.name() == name) {
            return Err(item
                .diagnostic(format!("the model \"{name}\" is named twice"))
                .with_help("name it once"));
        }
        models.push((default.clone(), item));
    }
    if models.is_empty() {
        return Err(entry.diagnostic("`models` is empty").with_help(format!("known: {}", names.join(", "))));
    }
    let Some(options) = options else { return Ok(models) };
    for (numerics, _) in &mut models {
        if let Some(table) = options.table(numerics.name())? {
            *numerics = configured(numerics.clone(), table)?;
        }
    }
    let used: Vec<&str> = models.iter().map(|(m, _)| m.name()).collect();
    for key in options.keys() {
        if !used.contains(&key)
            && let Some(stray) = options.entry(key)
        {
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
    Ok(models)
}

fn bem3d_options(mut model: Bem3d, table: &Entries<'_>) -> Read<Bem3d> {
    table.set(&mut model.cells, "cells", |e| e.size(1))?;
    table.set(&mut model.rows, "rows", |e| e.size(1).map(Some))?;
    table.set(&mut model.tolerance, "tolerance", |e| match e.positive_number()? {
        below if below < 1.0 => Ok(below),
        large => Err(e.outside(large, "a number < 1").with_help("1e-6 gives six digits")),
    })?;
    table.set(&mut model.max_outer_iterations, "max_outer_iterations", |e| e.size(1))?;
    table.set(&mut model.method, "method", |e| e.choice(&Method::ALL.map(|m| (m.as_str(), m))))?;
    Ok(model)
}

fn configured(numerics: Numerics, table: Entries<'_>) -> Read<Numerics> {
    let result = match numerics {
        Numerics::Bem3d(model) => Numerics::Bem3d(bem3d_options(model, &table)?),
        Numerics::Equivalent(mut outer) => {
            outer.model = bem3d_options(outer.model, &table)?;
            for (key, most, value) in
                [("per_decade", 1000, &mut outer.per_decade), ("decades", 12, &mut outer.decades)]
            {
                table.set(value, key, |e| match e.count(1)? {
                    count if count <= most => Ok(count as u32),
                    count => Err(e
                        .outside(count as f64, format!("at most {most}"))
                        .with_help("16 and 3 by default")),
                })?;
            }
            Numerics::Equivalent(outer)
        }
        Numerics::Mdr1d(mut model) => {
            table.set(&mut model.elements, "elements", |e| e.size(1))?;
            Numerics::Mdr1d(model)
        }
        Numerics::Persson(mut model) => {
            table.set(&mut model.gamma, "gamma", Entry::positive_number)?;
            Numerics::Persson(model)
        }
        Numerics::GreenwoodWilliamson(mut model) => {
            let words = [("gaussian", SummitHeights::Gaussian), ("exponential", SummitHeights::Exponential)];
            table.set(&mut model.heights, "heights", |e| e.choice(&words))?;
            Numerics::GreenwoodWilliamson(model)
        }
        other => other,
    };
    table.finish()?;
    Ok(result)
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
