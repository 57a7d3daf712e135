//! Warnings on states that may be wrong although they are solved to the requested tolerance, with remedies.

use crate::scenes::plan::{GridErrors, within};
use crate::scenes::read::{SceneFile, SceneSurface};
use contact_model::{ContactState, Coupling, Friction, Hardness, Scene, Surface};
use serde::{Deserialize, Serialize};

/// With fewer cells in contact than this the results depend on the grid.
const FEW_CELLS: usize = 10;
/// A cell that carries more than this share of the load counts as a single spike.
const ALONE: f64 = 0.5;
/// The boundary cells of a resolved contact are less than this share of its area.
const UNRESOLVED: f64 = 0.1;
/// Pressure over E* above which metals of unknown hardness are assumed to yield.
const YIELD: f64 = 0.1;

/// Whether a state rests on so few cells that it depends on the grid.
pub(crate) fn rests_on_few_cells(state: &ContactState) -> bool {
    state.report.contact_cells.is_some_and(|cells| (1..FEW_CELLS).contains(&cells))
}

/// A warning on a state.
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

    /// The text in the row of the state, and the remedy.
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
                "the columns `_grid_error` have the errors reached: the grid was chosen on surface 0, and other surfaces may need more cells (request an `accuracy` of half the share)",
            ],
            Self::Stiffness => [
                "stiffness not known",
                "complete contact has no stiffness, and at a jump or a kink of the path none is given: take the difference of neighbouring states",
            ],
            Self::Coupling => [
                "coupling of normal and tangential tractions neglected",
                "bodies of different compressibility have this coupling (second Dundurs constant not 0): a model with `coupling = \"full\"` solves both together",
            ],
        }
    }

    /// All warnings that concern a state.
    pub fn of(scene: &SceneFile, state: &ContactState, errors: Option<&GridErrors>) -> Vec<Self> {
        let circumstances = Circumstances {
            flat: matches!(scene.surface, SceneSurface::Plain(Surface::Flat { .. })),
            // Where a hardness limits the pressure, no state is marked.
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

    /// All warnings as one note; `None` where there are none.
    pub fn note(all: &[Self]) -> Option<String> {
        let texts: Vec<&str> = all.iter().map(|warning| warning.words()[0]).collect();
        (!texts.is_empty()).then(|| texts.join("; "))
    }
}

/// The properties of a scene that decide, together with a state, whether a warning applies.
#[derive(Debug, Clone, Copy)]
struct Circumstances {
    /// Whether the body is a flat rectangle, which is in contact up to its edges.
    flat: bool,
    /// The pressure above which a state is marked.
    hardness: f64,
    /// Whether the stiffness is requested.
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

    /// The warnings on a state, each followed by a colon and the remedy.
    pub fn of(&self, state: &ContactState) -> Vec<String> {
        let told = |warning: Warning| warning.words().join(": ");
        self.0.warnings(state, false).into_iter().map(told).collect()
    }
}

/// Whether normal and tangential tractions of these bodies are coupled, but the scene neglects the coupling.
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
