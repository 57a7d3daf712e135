//! The models by name, and what `[models.NAME]` says about their numerics.

use crate::scenes::read::any_model::{AnyModel, RegisteredModel};
use crate::scenes::read::entries::{Entries, Entry, Read, suggestion};
use analytic::greenwood_williamson::SummitHeights;
use analytic::{
    AdhesiveWave, CattaneoMindlin, FlatPunch, GreenwoodWilliamson, Hertz, Jkr, MaugisDugdale, Persson,
    PowerLaw, PowerLawBody, Westergaard,
};
use bem3d::{Bem3d, Bem3dPath, Method};
use contact_model::{Cells, Size};
use mdr1d::{Equivalent, Mdr1d, PartialSlip, Viscoelastic};
use std::sync::Arc;

/// Largest grids: 54 GB for a light load (the square of this many cells), 4 GB for a line.
pub(crate) const MOST_CELLS: usize = 1 << 15;
const MOST_ELEMENTS: usize = 1 << 28;

/// Grid on which models are asked whether they can answer.
const PROBE_CELLS: usize = 33;
const PROBE_ELEMENTS: usize = 1 << 10;

/// A model with its numerics.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Numerics {
    /// Boundary elements in three dimensions.
    Bem3d(Bem3d),
    /// The same along a path, a history: what `bem3d` is in a scene with one.
    Bem3dPath(Bem3dPath),
    /// The method of reduction of dimensionality.
    Mdr1d(Mdr1d),
    /// A sphere.
    Hertz,
    /// Bodies r^n.
    PowerLawBody,
    /// Flat faces.
    FlatPunch,
    /// A sphere with adhesion.
    Jkr,
    /// A sphere with adhesion of finite range.
    MaugisDugdale,
    /// The paper's fit.
    PowerLaw,
    /// Waves.
    Westergaard,
    /// Waves with adhesion.
    AdhesiveWave,
    /// Persson's theory.
    Persson(Persson),
    /// Independent summits.
    GreenwoodWilliamson(GreenwoodWilliamson),
    /// A sphere with friction, a history.
    CattaneoMindlin,
    /// Axisymmetric bodies with friction, a history.
    PartialSlip,
    /// Axisymmetric viscoelastic bodies, a history.
    Viscoelastic,
    /// Friction or rheology of any surface that boundary elements can press, a history.
    Equivalent(Equivalent<Bem3d>),
    /// A model of the user's own.
    Registered(RegisteredModel),
}

/// The same with at most so many cells along the longer side of the grid on a rectangle of this size, in the same proportion.
fn reduced(model: Bem3d, most: usize, size: Size) -> Bem3d {
    let Cells { columns, rows } = model.grid(size);
    let longer = columns.max(rows);
    if longer <= most {
        return model;
    }
    let fewer = |count: usize| ((count as f64 * (most as f64 / longer as f64)).round() as usize).max(1);
    Bem3d { cells: fewer(columns), rows: model.rows.map(|_| fewer(rows)), ..model }
}

/// What `[models.bem3d]` says by default.
const BEM3D: Bem3d =
    Bem3d { cells: 257, rows: None, tolerance: 1e-6, max_outer_iterations: 200, method: Method::Auto };

impl Numerics {
    /// Every model with its defaults.
    pub const ALL: [Self; 16] = [
        Self::Bem3d(BEM3D),
        Self::Mdr1d(Mdr1d { elements: 1 << 16 }),
        Self::Hertz,
        Self::PowerLawBody,
        Self::FlatPunch,
        Self::Jkr,
        Self::MaugisDugdale,
        Self::PowerLaw,
        Self::Westergaard,
        Self::AdhesiveWave,
        Self::Persson(Persson { gamma: 0.45 }),
        Self::GreenwoodWilliamson(GreenwoodWilliamson { heights: SummitHeights::Gaussian }),
        Self::CattaneoMindlin,
        Self::PartialSlip,
        Self::Viscoelastic,
        Self::Equivalent(Equivalent { model: BEM3D, per_decade: 16, decades: 3 }),
    ];

    /// The model itself.
    pub fn model(&self) -> AnyModel {
        match *self {
            Self::Registered(ref own) => own.model(),
            Self::Bem3d(model) => AnyModel::Contact(Arc::new(model)),
            Self::Bem3dPath(model) => AnyModel::History(Arc::new(model)),
            Self::Mdr1d(model) => AnyModel::Contact(Arc::new(model)),
            Self::Hertz => AnyModel::Contact(Arc::new(Hertz)),
            Self::PowerLawBody => AnyModel::Contact(Arc::new(PowerLawBody)),
            Self::FlatPunch => AnyModel::Contact(Arc::new(FlatPunch)),
            Self::Jkr => AnyModel::Contact(Arc::new(Jkr)),
            Self::MaugisDugdale => AnyModel::Contact(Arc::new(MaugisDugdale)),
            Self::PowerLaw => AnyModel::Contact(Arc::new(PowerLaw)),
            Self::Westergaard => AnyModel::Contact(Arc::new(Westergaard)),
            Self::AdhesiveWave => AnyModel::Contact(Arc::new(AdhesiveWave)),
            Self::Persson(model) => AnyModel::Contact(Arc::new(model)),
            Self::GreenwoodWilliamson(model) => AnyModel::Contact(Arc::new(model)),
            Self::CattaneoMindlin => AnyModel::History(Arc::new(CattaneoMindlin)),
            Self::PartialSlip => AnyModel::History(Arc::new(PartialSlip)),
            Self::Viscoelastic => AnyModel::History(Arc::new(Viscoelastic)),
            Self::Equivalent(model) => AnyModel::History(Arc::new(model)),
        }
    }

    /// Its name, the same in code, CSV and README.
    pub fn name(&self) -> &'static str {
        match self.model() {
            AnyModel::Contact(model) => model.name(),
            AnyModel::History(model) => model.name(),
        }
    }

    /// Whether it follows a path rather than answers loads.
    pub fn is_history(&self) -> bool {
        match self {
            Self::Registered(own) => own.is_history(),
            _ => matches!(
                self,
                Self::CattaneoMindlin
                    | Self::PartialSlip
                    | Self::Viscoelastic
                    | Self::Equivalent(_)
                    | Self::Bem3dPath(_)
            ),
        }
    }

    /// The same along a path, where the model has an effect that depends on it.
    #[must_use]
    pub(crate) fn along_path(self) -> Self {
        match self {
            Self::Bem3d(model) => Self::Bem3dPath(Bem3dPath(model)),
            other => other,
        }
    }

    /// Whether it answers for one surface rather than for the spectrum that it was drawn from: a theory gives the same for every seed.
    pub fn depends_on_realisation(&self) -> bool {
        self.is_stored()
    }

    /// Whether it takes of a rough map what is measured on it, not the map.
    pub(crate) fn is_statistical(&self) -> bool {
        matches!(self, Self::Persson(_) | Self::GreenwoodWilliamson(_) | Self::PowerLaw | Self::Mdr1d(_))
    }

    /// Whether its states cost enough to be kept on disk; a formula is evaluated again, so that no version
    /// has to be compared.
    pub fn is_stored(&self) -> bool {
        self.size() > 0 || matches!(self, Self::Registered(_))
    }

    /// Columns of a grid, elements of a line; 0 for a formula, and for a registered model.
    pub fn size(&self) -> usize {
        match self {
            Self::Bem3d(numerics)
            | Self::Bem3dPath(Bem3dPath(numerics))
            | Self::Equivalent(Equivalent { model: numerics, .. }) => numerics.cells,
            Self::Mdr1d(model) => model.elements,
            _ => 0,
        }
    }

    /// The numerics of boundary elements, where they press.
    pub fn boundary_elements(&self) -> Option<&Bem3d> {
        match self {
            Self::Bem3d(numerics)
            | Self::Bem3dPath(Bem3dPath(numerics))
            | Self::Equivalent(Equivalent { model: numerics, .. }) => Some(numerics),
            _ => None,
        }
    }

    /// The same on a grid of at most these cells along the longer side of a rectangle of this size, or
    /// elements.
    #[must_use]
    pub fn reduced(self, cells: usize, elements: usize, size: Size) -> Self {
        match self {
            Self::Bem3d(model) => Self::Bem3d(reduced(model, cells, size)),
            Self::Bem3dPath(Bem3dPath(model)) => Self::Bem3dPath(Bem3dPath(reduced(model, cells, size))),
            Self::Mdr1d(model) => Self::Mdr1d(Mdr1d { elements: model.elements.min(elements) }),
            Self::Equivalent(outer) => {
                let model = reduced(outer.model, cells, size);
                Self::Equivalent(Equivalent { model, ..outer })
            }
            other => other,
        }
    }

    /// The same on a grid that is only asked whether it can answer.
    #[must_use]
    pub(crate) fn probe(&self, size: Size) -> Self {
        self.clone().reduced(PROBE_CELLS, PROBE_ELEMENTS, size)
    }

    /// What one may expect of its numbers, in a sentence; `cells` of models that have them.
    pub fn accuracy(&self, rough: bool, cells: Cells) -> String {
        let Cells { columns, rows } = cells;
        match self {
            Self::Bem3d(numerics) | Self::Bem3dPath(Bem3dPath(numerics)) => format!(
                "every state is certified to {:e} (penetration, complementarity, load, and the stiffness where it is no difference quotient) on its {columns} x {rows} cells; the cells \
                 themselves are of first order where a body has edges, and loads that touch fewer than 10 cells are the grid's own",
                numerics.tolerance
            ),
            Self::Mdr1d(_) if rough => "exact for its line; against three dimensions 7 to 18 % too stiff near F_bar = 1, exponents as 1/(1+H)".into(),
            Self::Mdr1d(_) | Self::Hertz | Self::PowerLawBody | Self::Westergaard | Self::Jkr | Self::MaugisDugdale | Self::AdhesiveWave => "exact, to about 1e-13".into(),
            Self::FlatPunch => "exact for the circle; the square's constant to 1e-6".into(),
            Self::PowerLaw => "a fit: within the scatter of surfaces, 8 to 28 % at F_bar = 0.086".into(),
            Self::Persson(_) => "a theory of an infinite random surface: beside the solved one of data/scenes/periodic-theories.toml its stiffness is up \
                to a third low, its area 30 to 45 % low"
                .into(),
            Self::GreenwoodWilliamson(_) => "a theory of independent summits, for light loads: beside the solved surface of \
                data/scenes/periodic-theories.toml its stiffness and area are off by up to 30 %"
                .into(),
            Self::CattaneoMindlin | Self::PartialSlip => {
                "exact within Cattaneo's and Mindlin's assumptions (no coupling, slip along the load)".into()
            }
            Self::Equivalent(_) => format!(
                "the normal part is that of bem3d on {columns} x {rows} cells; tangential results are exact for round contacts, a few per cent off for \
                 others; relaxation is exact while the contact grows, which is checked; the table of k(d) has four digits for smooth \
                 bodies, about two for rough ones (its uncertainty is in `strategy`)"
            ),
            Self::Viscoelastic => "exact while the contact grows, which is checked; 1e-12".into(),
            Self::Registered(own) => format!("that of a model of the user's own, version \"{}\"", own.version()),
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
    let known: Vec<Numerics> = Numerics::ALL.into_iter().chain(own).collect();
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

/// A count from 1 that memory can hold.
fn at_most(entry: &Entry<'_>, most: usize, help: &str) -> Read<usize> {
    let count = entry.count(1)?;
    if count <= most as u64 {
        Ok(count as usize)
    } else {
        Err(entry.diagnostic(format!("{count}: expected at most {most}")).with_help(help))
    }
}

fn bem3d_options(mut model: Bem3d, table: &Entries<'_>) -> Read<Bem3d> {
    if let Some(entry) = table.find("cells") {
        model.cells = at_most(&entry, MOST_CELLS, "a light load takes 50 bytes a cell")?;
    }
    if let Some(entry) = table.find("rows") {
        model.rows = Some(at_most(&entry, MOST_CELLS, "a light load takes 50 bytes a cell")?);
    }
    if let Some(entry) = table.find("tolerance") {
        model.tolerance = entry.positive_number()?;
        if model.tolerance >= 1.0 {
            return Err(entry.diagnostic("`tolerance` is not below 1").with_help("1e-6 gives six digits"));
        }
    }
    if let Some(entry) = table.find("max_outer_iterations") {
        model.max_outer_iterations = entry.count(1)? as usize;
    }
    if let Some(entry) = table.find("method") {
        let words =
            [("auto", Method::Auto), ("iterative", Method::Iterative), ("single_level", Method::SingleLevel)];
        model.method = entry.choice(&words)?;
    }
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
                if let Some(entry) = table.find(key) {
                    let count = entry.count(1)?;
                    if count > most {
                        return Err(entry
                            .diagnostic(format!("`{key}` = {count}: expected at most {most}"))
                            .with_help("16 and 3 by default"));
                    }
                    *value = count as u32;
                }
            }
            Numerics::Equivalent(outer)
        }
        Numerics::Mdr1d(mut model) => {
            if let Some(entry) = table.find("elements") {
                model.elements = at_most(&entry, MOST_ELEMENTS, "the paper has 2^20")?;
            }
            Numerics::Mdr1d(model)
        }
        Numerics::Persson(mut model) => {
            if let Some(entry) = table.find("gamma") {
                model.gamma = entry.positive_number()?;
            }
            Numerics::Persson(model)
        }
        Numerics::GreenwoodWilliamson(mut model) => {
            if let Some(entry) = table.find("heights") {
                let words =
                    [("gaussian", SummitHeights::Gaussian), ("exponential", SummitHeights::Exponential)];
                model.heights = entry.choice(&words)?;
            }
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
    fn the_list_of_all_models_has_their_defaults() {
        assert!(Numerics::ALL.contains(&Numerics::Bem3d(Bem3d::default())));
        let Equivalent { per_decade, decades, .. } = Equivalent::new(Bem3d::default());
        assert!(Numerics::ALL.contains(&Numerics::Equivalent(Equivalent {
            model: BEM3D,
            per_decade,
            decades
        })));
        assert!(Numerics::ALL.contains(&Numerics::Mdr1d(Mdr1d::default())));
        assert!(Numerics::ALL.contains(&Numerics::Persson(Persson::default())));
        assert!(Numerics::ALL.contains(&Numerics::GreenwoodWilliamson(GreenwoodWilliamson::default())));
        for numerics in Numerics::ALL {
            assert_eq!(numerics.is_history(), matches!(numerics.model(), AnyModel::History(_)));
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
