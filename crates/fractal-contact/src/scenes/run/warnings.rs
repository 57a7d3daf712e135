//! Warnings on states that may be wrong although they are solved to the requested tolerance, with remedies.

use crate::scenes::plan::{GridErrors, is_tilted, within};
use crate::scenes::read::{SceneFile, SceneSurface, amount, number};
use contact_model::units::{ascii, rounded};
use contact_model::{Body, ContactState, Coupling, Friction, Hardness, Pair, Scene, Surface};
use serde::{Deserialize, Serialize};
use surface_gen::MapEdges;

/// With fewer cells in contact than this the results depend on the grid.
const FEW_CELLS: usize = 10;
/// A cell that carries more than this share of the load counts as a single spike.
const ALONE: f64 = 0.5;
/// The boundary cells of a resolved contact are less than this share of its area.
const UNRESOLVED: f64 = 0.1;
/// Pressure drop of a leaking fluid over the mean pressure above which the fluid is taken to lift the bodies.
const LIFT: f64 = 0.1;
/// The largest stress lies at an end of the depths where it is nearer to it than this share of their range.
const END: f64 = 1e-3;
/// Poisson's ratio from which on a body is taken for a rubber.
const RUBBER: f64 = 0.49;
/// Pressure over E* above which metals of unknown hardness are assumed to yield.
const YIELD: f64 = 0.1;

/// Whether a state rests on so few cells that it depends on the grid.
pub(crate) fn rests_on_few_cells(state: &ContactState) -> bool {
    state.report.contact_cells.is_some_and(|cells| (1..FEW_CELLS).contains(&cells))
}

/// A state that a warning concerns, and its discretisation errors where they were estimated.
pub(crate) type Concerned<'a> = (&'a ContactState, Option<&'a GridErrors>);

/// A warning on a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Warning {
    /// Fewer than ten cells are in contact.
    FewCells,
    /// One cell carries most of the load.
    OneCell,
    /// Cells at the edge of the rectangle are in contact.
    Edge,
    /// The pressure is above the hardness.
    Yield,
    /// The cells are too large for the contact.
    Area,
    /// The requested accuracy is not reached.
    Accuracy,
    /// A requested stiffness is not known.
    Stiffness,
    /// The coupling of normal and tangential tractions is neglected.
    Coupling,
    /// Cells in contact border undefined points.
    Rim,
    /// The fluid that leaks would lift the bodies.
    Lift,
    /// The largest stress is at the first or last of the depths.
    Depths,
}

impl Warning {
    /// All warnings, in the order in which they are printed.
    pub const ALL: [Self; 11] = [
        Self::FewCells,
        Self::OneCell,
        Self::Edge,
        Self::Yield,
        Self::Area,
        Self::Accuracy,
        Self::Stiffness,
        Self::Coupling,
        Self::Rim,
        Self::Lift,
        Self::Depths,
    ];

    /// The remedy for contact at the edge of a map without a tilt.
    pub const EDGE_WITHOUT_TILT: &'static str = "With a free boundary the edge then decides the answer too. Use a larger map or a smaller \
        load, or choose `boundary = \"periodic\"` if the surface is a part of a larger one.";

    /// What a high pressure on a rubber means, which does not yield.
    const LARGE_STRAINS: &'static str = "This solution is one of small strains, so that its errors are about as large as these \
        strains.";

    /// What stands in the row of the state.
    pub fn label(self) -> &'static str {
        match self {
            Self::FewCells => "fewer than 10 contact cells",
            Self::OneCell => "one cell carries most of the load",
            Self::Edge => "contact at the edge of the rectangle",
            Self::Yield => "pressure above the hardness (E*/10 where none is given)",
            Self::Area => "area not resolved",
            Self::Accuracy => "accuracy not reached",
            Self::Stiffness => "stiffness not known",
            Self::Coupling => "coupling of normal and tangential tractions neglected",
            Self::Rim => "contact beside undefined points",
            Self::Lift => "fluid pressure not small beside the mean pressure",
            Self::Depths => "largest stress at an end of the depths",
        }
    }

    /// What it means and what to do about it, in full sentences with the keys of a scene.
    pub fn advice(self) -> &'static str {
        match self {
            Self::FewCells => {
                "The numbers are then those of the grid and not of the surface. Use a larger load or smaller cells."
            }
            Self::OneCell => {
                "If it is a spike of the measurement, remove it (`outliers = 8`, or `missing = HEIGHT` with its height as in the file). \
                 Otherwise use smaller cells."
            }
            Self::Edge => {
                "With a free boundary the edge then decides the answer too. Use a larger map or a smaller load, subtract a tilt \
                 (`detrend = \"plane\"`), or choose `boundary = \"periodic\"` if the surface is a part of a larger one."
            }
            Self::Yield => {
                "The bodies flow there, but this solution is elastic: the true area is larger and the true pressure is smaller. Give \
                 the `hardness` in [effects], which limits the pressure."
            }
            Self::Area => {
                "Neither `area` nor `area_corrected` is the area that small cells would give. Use smaller cells; for a measured map \
                 this means a measurement with smaller pixels."
            }
            Self::Accuracy => {
                "The grid was chosen on the first surface, and other surfaces may need more cells. Request half of the `accuracy`; \
                 the columns `_grid_error` hold the errors of this grid."
            }
            Self::Stiffness => {
                "Complete contact has none, and at a jump or a kink of a path it is not defined. Take the difference of two \
                 neighbouring states."
            }
            Self::Coupling => {
                "These bodies differ in their compressibility, so the tractions act on each other (the second Dundurs constant is not 0). \
                 Use `coupling = \"full\"`, which solves both together."
            }
            Self::Rim => {
                "Where the surface goes on below undefined points, these cells carry too much, and the area is too small. Compare with \
                 `fill = \"neighbours\"` in the place of `undefined`, which gives these points heights."
            }
            Self::Lift => {
                "A fluid under pressure lifts the bodies and widens the gap, which is not computed: the true leakage is larger. Use a \
                 smaller `pressure_drop`, or take the pressure of the fluid from that of the load."
            }
            Self::Depths => {
                "It may be larger outside of their range. Add smaller or larger `depths` to `stress_below`."
            }
        }
    }

    /// What a run says of all states that it concerns: how many of the `counted` ones, the worst number among
    /// them, and what to do.
    pub(crate) fn sentence(self, scene: &SceneFile, concerned: &[Concerned<'_>], counted: usize) -> String {
        let states = match (concerned.len(), counted) {
            (1, 1) => "In this state".to_owned(),
            (count, all) if count == all => format!("In all {all} states"),
            (count, all) => format!("In {count} of {all} states"),
        };
        let worst = |number: &dyn Fn(&Concerned<'_>) -> Option<f64>| {
            concerned.iter().filter_map(number).reduce(f64::max)
        };
        let percent = |share: f64| format!("{} %", number(rounded(100.0 * share, 2)));
        let pressure = |value: f64| ascii(&amount(value, scene.system.shown("Pa")));
        let what = match self {
            Self::FewCells => format!("{states} fewer than 10 cells are in contact."),
            Self::OneCell => format!("{states} one cell carries most of the load."),
            Self::Edge => format!("{states} cells at the edge of the rectangle are in contact."),
            Self::Yield => {
                let largest = worst(&|(state, _)| state.resolution?.largest_pressure);
                let largest =
                    largest.map_or_else(String::new, |value| format!(" (it reaches {})", pressure(value)));
                if let Some(hardness) = scene.hardness {
                    format!("{states} the pressure is above the hardness of {}{largest}.", pressure(hardness))
                } else {
                    let limit = pressure(YIELD * scene.contact_modulus);
                    let meaning = if has_rubber(scene.pair) {
                        "A rubber then has large strains."
                    } else {
                        "No hardness is given; many materials yield at less."
                    };
                    format!("{states} the pressure is above a tenth of E*, {limit}{largest}. {meaning}")
                }
            }
            Self::Area => {
                let error = worst(&|(_, errors)| Some(errors.as_ref()?.of("area")?.error));
                let boundary = worst(&|(state, _)| {
                    let (area, corrected) = (state.area?, state.resolution?.corrected_area?);
                    Some((area - corrected) / area)
                });
                let words = match (error, boundary) {
                    (Some(error), _) => {
                        format!("the area has an estimated error of up to {}", percent(error))
                    }
                    (None, Some(share)) => {
                        format!(
                            "cells at the boundary of the contact are up to {} of its area",
                            percent(share)
                        )
                    }
                    (None, None) => "the boundary of the contact is more than a tenth of its area".to_owned(),
                };
                format!("{states} the grid is too coarse for the contact: {words}.")
            }
            Self::Accuracy => format!("{states} the requested accuracy is not reached."),
            Self::Stiffness => format!("{states} the stiffness is not known."),
            Self::Rim => {
                let share = worst(&|(state, _)| {
                    Some(state.resolution?.rim_cells as f64 / state.report.contact_cells? as f64)
                });
                let share =
                    share.map_or_else(String::new, |share| format!(", up to {} of them", percent(share)));
                format!("{states} cells in contact border undefined points{share}.")
            }
            Self::Lift => {
                let drop = scene.requested.interface.leakage.map_or(0.0, |leakage| leakage.pressure_drop);
                format!(
                    "{states} the pressure drop of the fluid, {}, is not small beside the mean pressure.",
                    pressure(drop)
                )
            }
            Self::Depths => format!("{states} the largest stress lies at the first or last of the depths."),
            Self::Coupling => {
                format!("{states} the coupling of normal and tangential tractions is neglected.")
            }
        };
        let advice = match self {
            Self::Edge if !has_tilted_map(scene) => Self::EDGE_WITHOUT_TILT,
            Self::Yield if scene.hardness.is_none() && has_rubber(scene.pair) => Self::LARGE_STRAINS,
            other => other.advice(),
        };
        format!("{what} {advice}")
    }

    /// All warnings that concern a state.
    pub(crate) fn of(scene: &SceneFile, state: &ContactState, errors: Option<&GridErrors>) -> Vec<Self> {
        let circumstances = Circumstances {
            flat: matches!(scene.surface, SceneSurface::Plain(Surface::Flat { .. })),
            // Where a hardness limits the pressure, no state is marked.
            hardness: match scene.effects.hardness {
                Hardness::Off => scene.hardness.unwrap_or(YIELD * scene.contact_modulus),
                _ => f64::INFINITY,
            },
            stiffness: scene.requested.outputs.stiffness,
            neglects_coupling: neglects_coupling(scene),
            lifting_force: scene.requested.interface.leakage.map(|leakage| {
                let size = scene.surface.size();
                leakage.pressure_drop * size.x * size.y
            }),
            depths: scene.requested.interface.stress_below.as_ref().map(|stress| {
                let depths = stress.depths.iter().copied();
                [depths.clone().fold(f64::INFINITY, f64::min), depths.fold(0.0, f64::max)]
            }),
        };
        let missed = scene.accuracy.is_some_and(|requested| {
            !errors.is_some_and(|errors| within(scene, errors, requested.target.share))
        });
        circumstances.warnings(state, missed)
    }

    /// All warnings as one note; `None` where there are none.
    pub(crate) fn note(all: &[Self]) -> Option<String> {
        let texts: Vec<&str> = all.iter().map(|warning| warning.label()).collect();
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
    /// The pressure drop of a leaking fluid times the nominal area.
    lifting_force: Option<f64>,
    /// The smallest and the largest depth at which the stress is computed.
    depths: Option<[f64; 2]>,
}

impl Circumstances {
    /// All warnings that concern a state, whose accuracy target was `missed` or not.
    fn warnings(&self, state: &ContactState, missed: bool) -> Vec<Warning> {
        let wanted = self.stiffness && state.report.contact_cells.is_some();
        let holds = |warning: Warning| match (warning, state.resolution) {
            (Warning::FewCells, _) => rests_on_few_cells(state),
            (Warning::Stiffness, _) => wanted && state.stiffness.is_none(),
            (Warning::Coupling, _) => self.neglects_coupling,
            (Warning::Lift, _) => self.lifting_force.is_some_and(|lift| lift > LIFT * state.force),
            (Warning::Depths, _) => state.interface.stress.zip(self.depths).is_some_and(|(stress, ends)| {
                let [first, last] = ends;
                let near = |end: f64| (stress.depth - end).abs() <= END * (last - first);
                // At the surface itself there is nothing above.
                stress.von_mises > 0.0 && (near(last) || first > 0.0 && near(first))
            }),
            (_, None) => false,
            (Warning::Accuracy, _) => missed,
            (Warning::OneCell, Some(r)) => r.largest_share > ALONE,
            (Warning::Edge, Some(r)) => r.edge_cells > 0 && !self.flat,
            (Warning::Rim, Some(r)) => r.rim_cells > 0,
            (Warning::Yield, Some(r)) => r.largest_pressure.is_some_and(|largest| largest > self.hardness),
            (Warning::Area, Some(r)) => {
                state.area.zip(r.corrected_area).is_some_and(|(a, corrected)| a - corrected > UNRESOLVED * a)
            }
        };
        Warning::ALL.into_iter().filter(|&warning| holds(warning)).collect()
    }
}

/// Notes on the states of a scene, as a run of a scene file has them in its results. A program puts the remedies
/// ([`Warning::advice`]) into the words of its own user.
///
/// ```
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
/// let state = bem3d::Bem3d { cells: 17, ..Default::default() }.prepare(&scene, 0)?.solve(Load::force(1e-4))?;
/// let notes = fractal_contact::scenes::StateNotes::new(&scene).of(&state);
/// assert_eq!(notes[0].label(), "fewer than 10 contact cells");
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
            lifting_force: None,
            depths: None,
        })
    }

    /// The warnings on a state.
    pub fn of(&self, state: &ContactState) -> Vec<Warning> {
        self.0.warnings(state, false)
    }
}

/// Whether a body is a rubber, which does not yield.
fn has_rubber(pair: Option<Pair>) -> bool {
    let is_rubber = |body: Body| matches!(body, Body::Elastic { poisson, .. } if poisson >= RUBBER);
    pair.is_some_and(|Pair { first, second }| is_rubber(first) || is_rubber(second))
}

/// Whether the map of a scene is tilted, as far as it has one.
fn has_tilted_map(scene: &SceneFile) -> bool {
    let edges = scene.surface.given_map().and_then(|map| MapEdges::new(map).ok());
    edges.is_some_and(|edges| is_tilted(&edges))
}

/// Whether normal and tangential tractions of these bodies are coupled, but the scene neglects the coupling.
fn neglects_coupling(scene: &SceneFile) -> bool {
    let Some(pair) = scene.pair.as_ref() else { return false };
    let friction = match scene.effects.friction {
        silent @ Friction::Slip { coupling: None, .. } => silent.with_coupling(Some(Coupling::Neglected)),
        stated => stated,
    };
    friction.coupling_of(pair) == Ok(Some(Coupling::Neglected))
}
