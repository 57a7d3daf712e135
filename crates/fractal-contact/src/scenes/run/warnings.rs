//! What may be wrong with a state though it is solved as well as it was asked for, and what to do about it.

use crate::scenes::plan::{GridErrors, within};
use crate::scenes::read::{SceneFile, SceneSurface};
use contact_model::{ContactState, Coupling, Friction, Hardness, Scene, Surface};
use serde::{Deserialize, Serialize};

/// Fewer cells in contact than this are those of the grid.
const FEW_CELLS: usize = 10;
/// A cell that carries more than this share of the load stands alone.
const ALONE: f64 = 0.5;
/// The boundary of a contact that is resolved changes its area by less than this share.
const UNRESOLVED: f64 = 0.1;
/// Pressure over E* from which metals, of hardness unknown, are beyond elasticity.
const YIELD: f64 = 0.1;

/// Whether the numbers of a state are those of the grid.
pub(crate) fn rests_on_few_cells(state: &ContactState) -> bool {
    state.report.contact_cells.is_some_and(|cells| (1..FEW_CELLS).contains(&cells))
}

/// Something to beware of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Warning {
    FewCells,
    OneCell,
    Edge,
    Yield,
    Area,
    Accuracy,
    Stiffness,
    Coupling,
}

impl Warning {
    pub const ALL: [Self; 8] = [
        Self::FewCells,
        Self::OneCell,
        Self::Edge,
        Self::Yield,
        Self::Area,
        Self::Accuracy,
        Self::Stiffness,
        Self::Coupling,
    ];

    /// What stands in the row of the state, and what to do about it.
    pub fn words(self) -> [&'static str; 2] {
        match self {
            Self::FewCells => [
                "fewer than 10 contact cells",
                "the numbers are those of the grid: a larger load or smaller cells",
            ],
            Self::OneCell => [
                "one cell carries most of the load",
                "is it a spike of the measurement? `missing = HEIGHT` (as in the file) takes it out; else smaller cells",
            ],
            Self::Edge => [
                "contact at the edge of the rectangle",
                "the edge decides too: a larger map, a smaller load, `detrend`, or `boundary = \"periodic\"`",
            ],
            Self::Yield => [
                "pressure above the hardness (E*/10 where none is given)",
                "bodies yield there, and these are elastic: take area and largest pressure as bounds",
            ],
            Self::Area => [
                "area not resolved",
                "the boundary of the contact is more than a tenth of its area: more cells, neither area is that of small cells",
            ],
            Self::Accuracy => [
                "accuracy not reached",
                "the columns `_grid_error` say what was: the grid was chosen on surface 0, others may need more cells (ask for an `accuracy` of half the share)",
            ],
            Self::Stiffness => [
                "stiffness not known",
                "complete contact has none; at a jump or a kink of the path it is not claimed: take the difference of neighbouring states",
            ],
            Self::Coupling => [
                "coupling of normal and tangential tractions neglected",
                "bodies of different compressibility have it (second Dundurs constant not 0): a model with `coupling = \"full\"` solves both together",
            ],
        }
    }

    /// All that concern a state.
    pub fn of(scene: &SceneFile, state: &ContactState, errors: Option<&GridErrors>) -> Vec<Self> {
        let circumstances = Circumstances {
            flat: matches!(scene.surface, SceneSurface::Plain(Surface::Flat { .. })),
            // Below a hardness that limits the pressure nothing is marked.
            hardness: match scene.effects.hardness {
                Hardness::Off => scene.hardness.unwrap_or(YIELD * scene.contact_modulus),
                _ => f64::INFINITY,
            },
            stiffness: scene.requested.outputs.stiffness,
            neglects_coupling: neglects_coupling(scene),
        };
        let missed = scene
            .accuracy
            .is_some_and(|target| !errors.is_some_and(|errors| within(scene, errors, target.share)));
        circumstances.warnings(state, missed)
    }

    /// All of them as one note; `None` for none.
    pub fn note(all: &[Self]) -> Option<String> {
        let texts: Vec<&str> = all.iter().map(|warning| warning.words()[0]).collect();
        (!texts.is_empty()).then(|| texts.join("; "))
    }
}

/// What decides, besides a state, whether a warning concerns it.
#[derive(Debug, Clone, Copy)]
struct Circumstances {
    /// All of a flat rectangle touches, its edges too.
    flat: bool,
    /// The pressure from which a state is marked.
    hardness: f64,
    /// Whether the stiffness is asked for.
    stiffness: bool,
    neglects_coupling: bool,
}

impl Circumstances {
    /// All warnings that concern a state, whose accuracy target was `missed` or not.
    fn warnings(&self, state: &ContactState, missed: bool) -> Vec<Warning> {
        let wanted = self.stiffness && state.report.contact_cells.is_some();
        let holds = |warning: Warning| match (warning, state.resolution) {
            (Warning::FewCells, _) => rests_on_few_cells(state),
            (Warning::Stiffness, _) => wanted && state.stiffness.is_none(),
            (Warning::Coupling, _) => self.neglects_coupling,
            (_, None) => false,
            (Warning::Accuracy, _) => missed,
            (Warning::OneCell, Some(r)) => r.largest_share > ALONE,
            (Warning::Edge, Some(r)) => r.edge_cells > 0 && !self.flat,
            (Warning::Yield, Some(r)) => r.largest_pressure > self.hardness,
            (Warning::Area, Some(r)) => {
                state.area.zip(r.corrected_area).is_some_and(|(a, corrected)| a - corrected > UNRESOLVED * a)
            }
        };
        Warning::ALL.into_iter().filter(|&warning| holds(warning)).collect()
    }
}

/// Notes on the states of a scene: those that a run of a scene file has in its results.
///
/// ```
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
/// let state = bem3d::Bem3d { cells: 17, ..Default::default() }.prepare(&scene, 0)?.solve(Load::Force(1e-4))?;
/// let notes = fractal_contact::scenes::StateNotes::new(&scene).of(&state);
/// assert!(notes[0].starts_with("fewer than 10 contact cells: "));
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct StateNotes(Circumstances);

impl StateNotes {
    /// On the states of this scene.
    pub fn new(scene: &Scene) -> Self {
        Self(Circumstances {
            flat: matches!(scene.surface, Surface::Flat { .. }),
            hardness: match scene.effects.hardness {
                Hardness::Off => YIELD * scene.contact_modulus,
                _ => f64::INFINITY,
            },
            stiffness: scene.outputs.stiffness,
            neglects_coupling: scene.coupling("") == Ok(Some(Coupling::Neglected)),
        })
    }

    /// What may be wrong with a state, and after a colon what to do about it.
    pub fn of(&self, state: &ContactState) -> Vec<String> {
        let told = |warning: Warning| warning.words().join(": ");
        self.0.warnings(state, false).into_iter().map(told).collect()
    }
}

/// Whether normal and tangential tractions of these bodies act on each other, and the friction leaves it out.
fn neglects_coupling(scene: &SceneFile) -> bool {
    let Some(pair) = scene.pair.as_ref() else { return false };
    let friction = match scene.effects.friction {
        Friction::Coulomb { coefficient, coupling: None } => {
            Friction::Coulomb { coefficient, coupling: Some(Coupling::Neglected) }
        }
        stated => stated,
    };
    friction.coupling_of(pair) == Ok(Some(Coupling::Neglected))
}
