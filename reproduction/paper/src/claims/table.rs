//! The table `claims.toml`: its entries, and the verdict of one on a number.

use crate::claim::{Claim, Estimate, Statement};
use crate::evaluation::EnsembleModel;
use runs::{Error, Result};
use serde::Deserialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

/// An entry of the table, whose head explains each field.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClaimEntry {
    pub id: String,
    quotation: String,
    place: String,
    pub reading: String,
    quantity: String,
    pub data: Data,
    allowed: ClaimLimits,
    /// The entry to whose statement it belongs; otherwise its own.
    part_of: Option<String>,
    only: Option<Only>,
    pub cases: Option<Cases>,
    convention: Option<String>,
    #[serde(default)]
    pub alternates: bool,
    #[serde(default)]
    timed: bool,
}

/// The number that is compared with the paper.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Data {
    /// alpha of each D_f, fitted below F_bar = 0.086.
    Exponent(EnsembleModel),
    /// Slope of the straight line through the origin that fits alpha over D_f best.
    ExponentOverDimension(EnsembleModel),
    /// alpha of lines over the forces over which surfaces of the same D_f are fitted.
    ExponentOverForcesOfSurfaces,
    /// alpha of lines minus alpha of surfaces, both over the same forces.
    ExponentDifference,
    /// alpha of the upper half of the window minus that of the lower half.
    ExponentOfHalves(EnsembleModel),
    /// alpha of lines from the first load to the second minus alpha above.
    ExponentBelowMinusAbove(f64, f64),
    /// zeta of surfaces.
    Factor,
    /// F_bar of the point nearest to the fitted laws of all D_f.
    ForceWhereLawsMeet,
    /// k_bar of that point.
    StiffnessWhereLawsMeet,
    /// zeta of lines over zeta of surfaces at the D_f where both differ most.
    FarthestRatioOfFactors,
    /// The distance of that ratio from 1.
    FarthestDistanceOfFactors,
    /// rms of log10 F_tilde about its mean over D_f, up to a load.
    ScatterOfCollapse(f64),
    /// rms of log10 F_tilde/F_bar, up to a load.
    DistanceFromCollapse(f64),
    /// Decades of F_bar over which F_tilde is F_bar within a factor, for the best D_f.
    DecadesOfCollapse(f64),
    /// k_bar of surfaces at a load.
    StiffnessAt(f64),
    /// Spread of the curves over D_f at the first load over that at the second.
    Spread(f64, f64),
    /// k_bar of surfaces at a load over the fitted law.
    StiffnessOverLaw(f64),
    /// Lambda (rho_1 + rho_2)/L of surfaces at a load, mean over D_f.
    ConductanceAt(f64),
    /// F_bar at which k has a share of its plateau.
    ForceAtPlateauShare(EnsembleModel, f64),
    /// Share of the square in contact where k has a share of its plateau.
    AreaAtPlateauShare(f64),
    /// F_bar at which k has a share of its plateau, lines over surfaces.
    RatioOfForcesAtPlateauShare(f64),
    /// Relative change of the mean k of surfaces with cells twice as large, at the load where it is largest.
    ChangeWithTheGrid,
    /// rms of that change at a load, over the scatter of k between surfaces.
    ChangeOverScatter(f64),
    /// Largest k_1D/k_3D between two loads.
    LargestRatio(f64, f64),
    /// k_1D/k_3D at the smallest load at which the surface resolves its contact, over that at F_bar = 0.086.
    ChangeOfRatio,
    /// k_1D/k_3D at the load where it is farthest from 1, of those at which the surface resolves its contact.
    FarthestRatio,
    /// k/(E* L) of the square in full contact.
    Plateau,
    /// k/(E* L) of the line in full contact, over that of the square.
    RatioOfPlateaus,
    /// Share of the cells in contact that lie within a quarter of the side from their centre, at these D_f.
    ShareInOneRegion(Vec<f64>),
    /// k/E* over the sum of the diameters of all regions of a nonfractal surface.
    ContactLengthOverDiameters,
    /// rms height of the line over that of the surface, at these D_f.
    RatioOfHeights(Vec<f64>),
    /// Seconds of surfaces over seconds of lines.
    RunTimes,
    /// No number, for this reason.
    NotJudged(String),
    /// A number of the two problems: [`crate::two_cases`].
    TwoCases(CaseData),
}

/// The number that is compared for a case of the two problems.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum CaseData {
    /// Exponent of k over F below F_bar = 0.086.
    ExponentBelowTheUpperLimit,
    /// Exponent of k over F where 1 to 20 % of the square touch.
    ExponentBetweenAreas,
    /// k h/F where 1 to 20 % of the square touch.
    ConstantBetweenAreas,
    /// Exponent of the area over F where at most 10 % of the square touch.
    ExponentOfArea,
    /// A E* |grad h|/F at the same loads.
    Kappa,
}

/// The case of the two problems to which an entry refers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(crate) enum Cases {
    #[serde(rename = "without a roll-off")]
    Fractal,
    #[serde(rename = "periodic with a roll-off")]
    Persson,
    #[serde(rename = "all but periodic with a roll-off")]
    BesidePersson,
}

/// A formula of the paper over D_f.
#[derive(Debug, Clone, Copy, Deserialize)]
enum Equation {
    #[serde(rename = "Eq. 6")]
    Eq6,
    #[serde(rename = "Eq. 11")]
    Eq11,
    #[serde(rename = "Eq. 24")]
    Eq24,
}

impl Equation {
    fn at(self, d: f64) -> f64 {
        match self {
            Self::Eq6 => analytic::exponent_fit(d),
            Self::Eq11 => analytic::zeta_fit(d),
            Self::Eq24 => analytic::exponent_scaling(3.0 - d),
        }
    }
}

/// The value of the paper for a number.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Printed {
    Number(f64),
    Equation(Equation),
}

impl Printed {
    fn at(self, d: f64) -> f64 {
        match self {
            Self::Number(value) => value,
            Self::Equation(equation) => equation.at(d),
        }
    }
}

/// The range that a reading allows.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ClaimLimits {
    Range([f64; 2]),
    Within(Printed, f64),
    Share(Printed, f64),
    Factor(Printed, f64),
    Either([f64; 2], [f64; 2]),
}

impl ClaimLimits {
    /// The limits at a D_f, for a number that may choose between two ranges.
    fn at(self, d: f64, value: f64) -> [f64; 2] {
        match self {
            Self::Range(range) => range,
            Self::Within(printed, by) => [printed.at(d) - by, printed.at(d) + by],
            Self::Share(printed, share) => [printed.at(d) * (1.0 - share), printed.at(d) * (1.0 + share)],
            Self::Factor(printed, factor) => [printed.at(d) / factor, printed.at(d) * factor],
            Self::Either(below, above) => {
                if value < 0.5 * (below[1] + above[0]) {
                    below
                } else {
                    above
                }
            }
        }
    }
}

/// The fractal dimensions to which a statement refers.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Only {
    At(f64),
    UpTo(f64),
    Above(f64),
}

/// A number with its conditions, or the reason why there is none.
pub(crate) type ClaimedNumber = std::result::Result<(Estimate, String), Reason>;

/// The reason why there is no number.
pub(crate) type Reason = Cow<'static, str>;

/// One number for an entry.
pub(crate) struct ClaimRow {
    /// D_f; NaN for a number without one.
    pub fractal_dimension: f64,
    /// The text that replaces {} in the quantity.
    pub label: String,
    pub found: ClaimedNumber,
    /// The same number in the other convention of the entry.
    pub in_convention: Option<f64>,
}

impl ClaimRow {
    /// At a fractal dimension.
    pub fn at(fractal_dimension: f64, found: ClaimedNumber) -> Self {
        Self { fractal_dimension, ..Self::of(format!("{fractal_dimension:?}"), found) }
    }

    /// A number without a fractal dimension.
    pub fn of(label: impl Into<String>, found: ClaimedNumber) -> Self {
        Self { fractal_dimension: f64::NAN, label: label.into(), found, in_convention: None }
    }

    /// The only one.
    pub fn only(found: ClaimedNumber) -> Vec<Self> {
        vec![Self::of("", found)]
    }
}

impl ClaimEntry {
    pub fn speaks_of(&self, d: f64) -> bool {
        match self.only {
            None => true,
            Some(Only::At(value)) => (d - value).abs() < 1e-9,
            Some(Only::UpTo(value)) => d <= value,
            Some(Only::Above(value)) => d > value,
        }
    }

    /// The verdict on a number.
    pub fn judge(&'static self, row: ClaimRow) -> Claim {
        let d = row.fractal_dimension;
        let Self { quotation, place, reading, .. } = self;
        let name = self.part_of.as_ref().unwrap_or(&self.id);
        let statement = Statement { name, quotation, place, reading };
        let quantity = self.quantity.replace("{}", &row.label);
        let limits = |value: f64| self.allowed.at(d, value);
        let mut claim = match row.found {
            Ok((found, remark)) => Claim::judge(quantity, statement, limits(found.value), found, remark),
            Err(reason) => Claim::unresolved(quantity, statement, limits(0.0), reason),
        };
        if let Some((convention, value)) = self.convention.as_ref().zip(row.in_convention) {
            claim = claim.in_convention(convention, value);
        }
        Claim { timed: self.timed, ..claim }
    }
}

/// The table, by commands.
type ClaimTable = BTreeMap<String, Vec<ClaimEntry>>;

static TABLE: LazyLock<std::result::Result<ClaimTable, String>> =
    LazyLock::new(|| read(include_str!("../../claims.toml")).map_err(|error| error.to_string()));

fn read(text: &str) -> std::result::Result<ClaimTable, toml::de::Error> {
    let mut commands: BTreeMap<String, Vec<toml::Table>> = toml::from_str(text)?;
    let all: Vec<toml::Table> = commands.values().flatten().cloned().collect();
    for entry in commands.values_mut().flatten() {
        let Some(like) = entry.remove("like") else { continue };
        let same_words = !entry.contains_key("quotation");
        let model = all.iter().find(|other| other.get("id") == Some(&like));
        for (field, value) in model.into_iter().flatten() {
            entry.entry(field).or_insert_with(|| value.clone());
        }
        if same_words {
            entry.entry("part_of").or_insert(like);
        }
    }
    let whole = |entries: Vec<toml::Table>| -> std::result::Result<Vec<ClaimEntry>, _> {
        entries.into_iter().map(toml::Table::try_into).collect()
    };
    commands.into_iter().map(|(command, entries)| Ok((command, whole(entries)?))).collect()
}

/// The entries that a command judges.
///
/// # Errors
/// A table that cannot be read, which would be an error of this crate.
pub(crate) fn entries(command: &str) -> Result<&'static [ClaimEntry]> {
    let table = TABLE.as_ref().map_err(|error| wrong(error))?;
    Ok(table.get(command).ok_or_else(|| wrong(&format!("no claims of {command}")))?)
}

/// A table that does not fit the code.
pub(super) fn wrong(reason: &str) -> Error {
    Error::content(Path::new("claims.toml"), reason)
}

/// The commands that have entries.
#[cfg(test)]
pub(super) fn commands() -> std::collections::BTreeSet<&'static str> {
    TABLE.as_ref().unwrap().keys().map(String::as_str).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_has_its_words() {
        for entry in TABLE.as_ref().unwrap().values().flatten() {
            for text in [&entry.quotation, &entry.place, &entry.reading, &entry.quantity] {
                assert!(!text.trim().is_empty(), "{}", entry.id);
            }
        }
    }

    #[test]
    fn limits_follow_from_what_is_printed() {
        let half = Printed::Number(0.5);
        for (limits, low, high) in [
            (ClaimLimits::Within(half, 0.25), 0.25, 0.75),
            (ClaimLimits::Share(half, 0.5), 0.25, 0.75),
            (ClaimLimits::Factor(half, 2.0), 0.25, 1.0),
            (ClaimLimits::Within(Printed::Equation(Equation::Eq24), 0.0), 1.0 / 1.5, 1.0 / 1.5),
        ] {
            approx::assert_relative_eq!(limits.at(2.5, 0.0)[0], low);
            approx::assert_relative_eq!(limits.at(2.5, 0.0)[1], high);
        }
        let either = ClaimLimits::Either([0.0, 0.9], [1.1, f64::INFINITY]);
        approx::assert_relative_eq!(either.at(2.5, 0.95)[1], 0.9);
        approx::assert_relative_eq!(either.at(2.5, 1.05)[0], 1.1);
    }
}
