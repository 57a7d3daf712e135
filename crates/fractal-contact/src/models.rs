//! The models of the library, one record each. Scenes, help texts, tables and Python read these records.

use analytic::{
    AdhesiveWave, CattaneoMindlin, FlatPunch, GreenwoodWilliamson, Hertz, Jkr, MaugisDugdale, Persson,
    PowerLaw, PowerLawBody, Westergaard,
};
use bem3d::Bem3d;
use contact_model::{ContactModel, Effect, LoadKind, NotCombined, Output, Paths, Scene, SurfaceKind};
use mdr1d::{Equivalent, Mdr1d, PartialSlip, Viscoelastic};
use std::fmt;

/// The description of a model, in addition to its own name, sources and abilities.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct ModelRecord {
    /// The model with its defaults.
    pub model: &'static dyn ContactModel,
    /// Its name in titles and legends.
    pub title: &'static str,
    /// Name of its class in Python.
    pub class: &'static str,
    /// A description in one sentence.
    pub about: &'static str,
    /// The accuracy to expect of its results; a model with cells says more once its grid is known.
    pub accuracy: &'static str,
    /// Whether its numerics have options; if so, it is a variant of `scenes::Numerics`.
    pub has_options: bool,
    /// Whether it uses statistics measured on a rough map instead of the map itself.
    pub is_statistical: bool,
}

impl ModelRecord {
    /// Its name, the same in code, scenes, tables and Python.
    pub fn name(&self) -> &'static str {
        self.model.name()
    }

    /// The record of a model of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        MODELS.iter().find(|record| record.name() == name)
    }
}

impl fmt::Debug for ModelRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A description and the abilities, in a few lines.
impl fmt::Display for ModelRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.name(), self.about)?;
        for (of, words) in abilities(self.model).into_iter().filter(|(_, words)| !words.is_empty()) {
            writeln!(f, "  {of:<10} {}", words.join(", "))?;
        }
        for NotCombined { effects: [first, second], reason } in self.model.abilities().not_combined {
            let words =
                |group: &[Effect]| group.iter().map(|effect| effect.words()).collect::<Vec<_>>().join(", ");
            writeln!(f, "  {:<10} {} with {}: {reason}", "never", words(first), words(second))?;
        }
        Ok(())
    }
}

impl PartialEq for ModelRecord {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// The record of a closed form, which has no options and measures nothing.
const fn formula(
    model: &'static dyn ContactModel,
    (title, class): (&'static str, &'static str),
    about: &'static str,
    accuracy: &'static str,
) -> ModelRecord {
    ModelRecord { model, title, class, about, accuracy, has_options: false, is_statistical: false }
}

const EXACT: &str = "exact, to about 1e-13";
/// Every model of the library. A closed form is one entry here; a model with options has a variant of
/// `scenes::Numerics` too.
pub static MODELS: &[ModelRecord] = &[
    ModelRecord {
        has_options: true,
        ..formula(
            &Bem3d::DEFAULT,
            ("3D boundary elements", "Bem3d"),
            "Exact contact in three dimensions by boundary elements, free or periodic.",
            "every state is certified to its tolerance; the cells themselves are of first order where a body has edges",
        )
    },
    ModelRecord {
        has_options: true,
        is_statistical: true,
        ..formula(
            &Mdr1d { elements: 1 << 16 },
            ("1D reduction", "Mdr1d"),
            "The reduction to one dimension (method of dimensionality reduction).",
            "exact for round bodies, to about 1e-13; a rough surface becomes a line with 0.64 to 1.26 times its mean stiffness (D_f from \
             2.0 to 3.0)",
        )
    },
    formula(&Hertz, ("Hertz", "Hertz"), "Hertz's contact of a sphere.", EXACT),
    formula(&PowerLawBody, ("Galin", "PowerLawBody"), "Bodies of revolution r^n (Sneddon, Galin).", EXACT),
    formula(
        &FlatPunch,
        ("flat punch", "FlatPunch"),
        "Flat circular punch, or flat square.",
        "exact for the circle; the square's constant to 1e-6",
    ),
    formula(
        &Jkr,
        ("Johnson, Kendall and Roberts", "Jkr"),
        "Short-range adhesion of a sphere (Johnson, Kendall, Roberts).",
        EXACT,
    ),
    formula(
        &MaugisDugdale,
        ("Maugis-Dugdale", "MaugisDugdale"),
        "A sphere with Dugdale's law of adhesion, between JKR and DMT, in closed form (Maugis).",
        EXACT,
    ),
    ModelRecord {
        is_statistical: true,
        ..formula(
            &PowerLaw,
            ("power law of the paper", "PowerLaw"),
            "The power law of the paper for self-affine surfaces.",
            "a fit: within the scatter of surfaces, 8 to 28 % at F_bar = 0.086",
        )
    },
    formula(&Westergaard, ("Westergaard", "Westergaard"), "Periodic contact of a wave.", EXACT),
    formula(
        &AdhesiveWave,
        ("Johnson", "AdhesiveWave"),
        "Short-range adhesion of a periodic wave in closed form (Johnson).",
        EXACT,
    ),
    ModelRecord {
        has_options: true,
        is_statistical: true,
        ..formula(
            &Persson { gamma: 0.45 },
            ("Persson", "Persson"),
            "Persson's theory of rough contact.",
            "a theory of an infinite random surface: beside the solved one of data/scenes/periodic-theories.toml its stiffness is up to a \
             third low, its area 38 to 44 % below that of the cells in contact and 29 to 35 % below the corrected one",
        )
    },
    ModelRecord {
        has_options: true,
        is_statistical: true,
        ..formula(
            &GreenwoodWilliamson { heights: analytic::greenwood_williamson::SummitHeights::Gaussian },
            ("Greenwood and Williamson", "GreenwoodWilliamson"),
            "Greenwood and Williamson's theory of rough contact.",
            "a theory of independent summits, for light loads: beside the solved surface of data/scenes/periodic-theories.toml its \
             stiffness is off by up to 25 %, its area by up to 23 % of that of the cells in contact and 13 % of the corrected one",
        )
    },
    formula(
        &CattaneoMindlin,
        ("Cattaneo and Mindlin", "CattaneoMindlin"),
        "Partial slip of a sphere in closed form.",
        "exact within Cattaneo's and Mindlin's assumptions (no coupling, slip along the load)",
    ),
    formula(
        &PartialSlip,
        ("1D reduction with partial slip", "PartialSlip"),
        "Partial slip of round bodies by reduction to one dimension.",
        "exact within Cattaneo's and Mindlin's assumptions (no coupling, slip along the load)",
    ),
    formula(
        &Viscoelastic,
        ("viscoelastic 1D reduction", "Viscoelastic"),
        "Viscoelastic contact of round bodies by reduction to one dimension.",
        "exact while the contact grows, which is checked; 1e-12",
    ),
    ModelRecord {
        has_options: true,
        ..formula(
            &Equivalent { model: Bem3d::DEFAULT, per_decade: 16, decades: 3 },
            ("equivalent profile", "Equivalent"),
            "Friction or rheology of any surface, on the stiffness over approach of another model.",
            "the normal part is that of the model that presses; friction of round contacts is exact within Cattaneo's and Mindlin's \
             assumptions (no coupling, slip along the load), that of others a few per cent off",
        )
    },
];

/// The models whose abilities cover everything that a scene requests.
pub fn able(scene: &Scene) -> impl Iterator<Item = &'static ModelRecord> + '_ {
    MODELS.iter().filter(|record| record.model.abilities().lacks(scene).next().is_none())
}

/// The abilities of a model as rows of a table: the name of a row, and its entries.
pub fn abilities(model: &dyn ContactModel) -> Vec<(&'static str, Vec<&'static str>)> {
    let abilities = model.abilities();
    let paths = match abilities.paths {
        Paths::Forgotten => "followed load by load: nothing is remembered",
        Paths::Remembered => "remembered",
        Paths::Needed => "needed",
    };
    vec![
        ("surfaces", abilities.surfaces.iter().map(|kind: &SurfaceKind| kind.name()).collect()),
        (
            "boundaries",
            abilities
                .boundaries
                .iter()
                .map(|boundary| match boundary.repeats() {
                    [false, false] => "free",
                    [true, true] => "periodic",
                    [true, false] => "periodic along x",
                    [false, true] => "periodic along y",
                })
                .collect(),
        ),
        ("effects", abilities.effects.iter().map(|effect: &Effect| effect.words()).collect()),
        ("needs", if abilities.needs_effect { vec!["one of its effects"] } else { Vec::new() }),
        ("loads", abilities.loads.iter().map(|load: &LoadKind| load.name()).collect()),
        ("paths", vec![paths]),
        ("outputs", abilities.outputs.iter().map(|output: &Output| output.name()).collect()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_classes_stand_once() {
        for key in
            [ModelRecord::name, |record: &ModelRecord| record.class, |record: &ModelRecord| record.title]
        {
            let mut keys: Vec<&str> = MODELS.iter().map(key).collect();
            keys.sort_unstable();
            keys.dedup();
            assert_eq!(keys.len(), MODELS.len());
        }
    }
}
