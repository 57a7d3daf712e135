//! The columns of `results.csv`: those that a scene asks for.

use crate::scenes::plan::grid_comparison::{COMPARED, GridErrors};
use crate::scenes::read::entries::System;
use crate::scenes::read::loads::{Loading, Prescribed};
use crate::scenes::read::scene_file::SceneFile;
use analysis::{Column, Value};
use contact_model::{
    Adhesion, Boundary, Conductance, ContactState, Friction, Hardness, HistoryState, Normalisation,
    PlasticState, Status,
};

/// What a row is made of.
#[derive(Debug, Clone, Default)]
pub(crate) struct State {
    pub model: &'static str,
    pub surface: usize,
    pub index: usize,
    pub requested: f64,
    pub time: Option<f64>,
    pub normalisation: Option<Normalisation>,
    pub normal: Option<ContactState>,
    pub history: Option<HistoryState>,
    pub status: Option<Status>,
    /// Where it was compared with coarser grids.
    pub grid_errors: GridErrors,
    pub rms_slope: Option<f64>,
    /// Why there is no state.
    pub note: Option<String>,
}

type Value1 = fn(&State) -> Value;

/// One column: unit in SI, what it holds, where it comes from.
struct ResultColumn {
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: Value1,
}

fn normal<T: Into<Value>>(state: &State, pick: impl Fn(&ContactState) -> T) -> Value {
    state.normal.as_ref().map(pick).into()
}

fn scaled(state: &State, pick: impl Fn(&ContactState, &Normalisation) -> Option<f64>) -> Value {
    state.normal.as_ref().zip(state.normalisation.as_ref()).and_then(|(n, s)| pick(n, s)).into()
}

fn tangential(state: &State, pick: impl Fn(&contact_model::TangentialState) -> Option<f64>) -> Value {
    state.history.as_ref().and_then(|h| h.tangential.as_ref()).and_then(pick).into()
}

fn plastic_of(state: &State, pick: fn(&PlasticState) -> f64) -> Value {
    state.normal.as_ref().and_then(|n| n.plastic.as_ref()).map(pick).into()
}

/// The one sentence on the stiffness, for tables, book and Python.
const STIFFNESS: &str = "dF/dd along the branch of states (periodic: -dF/d(mean gap)): fronts of an adhesive contact move, saturated cells flow";
const STIFFNESS_FIXED_AREA: &str = "stiffness of the whole contact area, held (periodic: -dF/d(mean gap))";

/// The columns of a scene.
#[allow(clippy::too_many_lines)] // One entry per column, nothing else.
fn kinds(scene: &SceneFile) -> Vec<ResultColumn> {
    let kind = |name, unit, meaning, value: Value1| ResultColumn { name, unit, meaning, value };
    let outputs = &scene.requested.outputs;
    let rough = scene.surface.is_rough();
    let mut list = vec![
        kind("model", "-", "who answers", |s| s.model.into()),
        kind("surface", "1", "number of the surface, from 0", |s| s.surface.into()),
        kind("state", "1", "number of the load or step, from 0", |s| s.index.into()),
    ];
    match &scene.request {
        Loading::Path(_) => list.push(kind("time", "s", "time at the end of the step", |s| s.time.into())),
        Loading::Loads(loads) => {
            let (unit, meaning) = match loads.prescribed {
                Prescribed::Force => ("N", "force"),
                Prescribed::ForceBar => {
                    ("1", "F_bar = F/(E* h L) with this surface's measured rms height h, L = sqrt(Lx Ly)")
                }
                Prescribed::MeanPressure => ("Pa", "mean pressure, F/(Lx Ly), undefined points included"),
                Prescribed::Approach => ("m", "approach"),
                Prescribed::MeanGap => ("m", "mean gap"),
            };
            list.push(kind("prescribed", unit, meaning, |s| s.requested.into()));
        }
    }
    list.push(kind("force", "N", "normal force", |s| normal(s, |n| n.force)));
    if rough {
        list.push(kind("force_bar", "1", "F/(E* h L), L = sqrt(Lx Ly)", |s| {
            scaled(s, |n, c| c.force_bar(n.force).ok())
        }));
    }
    if scene.effects.boundary == Boundary::Free {
        list.push(kind("approach", "m", "from first touch of the highest point", |s| {
            normal(s, |n| n.approach)
        }));
    }
    if scene.requested.outputs.mean_gap {
        let meaning = "distance between the mean plane of the defined heights and that of the deformed half-space; without undefined \
                       points the mean of the gap field; with them it may be negative";
        list.push(kind("mean_gap", "m", meaning, |s| normal(s, |n| n.mean_gap)));
    }
    if scene.is_history() {
        list.push(kind("contact_radius", "m", "of a round contact", |s| {
            s.history.as_ref().and_then(|h| h.contact_radius).into()
        }));
    }
    if scene.effects.friction != Friction::Off {
        list.push(kind("tangential_force", "N", "tangential force", |s| tangential(s, |t| Some(t.force))));
        list.push(kind("tangential_displacement", "m", "of the bodies far from the contact", |s| {
            tangential(s, |t| Some(t.displacement))
        }));
        list.push(kind("stick_radius", "m", "inside it nothing slips", |s| {
            tangential(s, |t| t.stick_radius)
        }));
        list.push(kind("dissipated", "J", "energy lost to friction since the first step", |s| {
            tangential(s, |t| Some(t.dissipated))
        }));
    }
    if scene.effects.hardness != Hardness::Off {
        list.push(kind("plastic_area", "m^2", "area under the hardness", |s| plastic_of(s, |p| p.area)));
        list.push(kind("plastic_volume", "m^3", "volume of the plastic indentation", |s| {
            plastic_of(s, |p| p.volume)
        }));
        list.push(kind("plastic_work", "J", "energy dissipated in it, hardness times volume", |s| {
            plastic_of(s, |p| p.dissipated)
        }));
    }
    if scene.effects.adhesion != Adhesion::Off {
        let at = "a minimum of the energy where > 0: its least curvature over that without adhesion";
        list.push(kind("branch", "-", "whether the bodies were brought nearer or drawn apart", |s| {
            normal(s, |n| n.adhesive.map(|a| a.branch.as_str()))
        }));
        list.push(kind("energy", "J", "elastic energy less the work of adhesion done", |s| {
            normal(s, |n| n.adhesive.map(|a| a.energy))
        }));
        list.push(kind("stability", "1", at, |s| normal(s, |n| n.adhesive.map(|a| a.stability))));
    }
    if outputs.stiffness {
        list.push(kind("stiffness", "N/m", STIFFNESS, |s| normal(s, |n| n.stiffness)));
        list.push(kind("stiffness_bar", "1", "k/(1.1419 E* L) of this stiffness, L = sqrt(Lx Ly)", |s| {
            scaled(s, |n, c| n.stiffness.map(|k| c.stiffness_bar(k)))
        }));
    }
    if outputs.stiffness_fixed_area {
        list.push(kind("stiffness_fixed_area", "N/m", STIFFNESS_FIXED_AREA, |s| {
            normal(s, |n| n.stiffness_fixed_area)
        }));
    }
    if outputs.area {
        list.push(kind("area", "m^2", "real contact area", |s| normal(s, |n| n.area)));
        list.push(kind(
            "area_corrected",
            "m^2",
            "area less what cells add at its boundary (Yastrebov et al. 2017)",
            |s| normal(s, |n| n.resolution.and_then(|r| r.corrected_area)),
        ));
        list.push(kind("contact_fraction", "1", "A/(Lx Ly), undefined points included", |s| {
            scaled(s, |n, c| n.area.map(|a| c.contact_fraction(a)))
        }));
    }
    let conductance = match outputs.conductance {
        Conductance::Off => None,
        Conductance::Thermal { .. } => Some("W/K"),
        _ => Some("S"),
    };
    if let Some(unit) = conductance {
        let meaning = "2 k/(E* (rho_1 + rho_2)) with the stiffness of the whole contact area, held (Barber)";
        list.push(kind("conductance", unit, meaning, |s| normal(s, |n| n.conductance)));
    }
    if outputs.contact_patches {
        list.push(kind("patches", "1", "connected contact areas, cells joined by an edge", |s| {
            normal(s, |n| n.patches.as_ref().map(contact_model::Patches::count))
        }));
        list.push(kind("largest_patch", "m^2", "area of the largest", |s| {
            normal(s, |n| n.patches.as_ref().and_then(|p| p.areas().first().copied()))
        }));
    }
    list.extend([
        kind(
            "largest_pressure",
            "Pa",
            "of a cell; grows with smaller cells until they resolve the shortest wave, at an edge of the rectangle or a spike without limit",
            |s| normal(s, |n| n.resolution.map(|r| r.largest_pressure)),
        ),
        kind("status", "-", "how the solve ended", |s| s.status.map_or("refused", Status::as_str).into()),
        kind("strategy", "-", "which way the solver took", |s| normal(s, |n| n.report.strategy.clone())),
        kind("contact_cells", "1", "cells or elements in contact; fewer than 10 are the grid's own", |s| {
            normal(s, |n| n.report.contact_cells)
        }),
        kind("iterations", "1", "of the linear solvers", |s| normal(s, |n| n.report.iterations)),
        kind("applications", "1", "of the elastic operator", |s| normal(s, |n| n.report.applications)),
        kind("linear_solves", "1", "linear systems solved", |s| normal(s, |n| n.report.work.linear_solves)),
        kind("fields", "1", "fields over the grid that the state holds", |s| {
            normal(s, |n| n.report.work.fields)
        }),
        kind("field_bytes", "1", "their bytes", |s| normal(s, |n| n.report.work.bytes)),
        kind("duality_gap", "1", "sum p (g - min g)/(F s)", |s| {
            normal(s, |n| n.report.certificate.duality_gap)
        }),
        kind("penetration", "1", "max(0, -min g)/s", |s| normal(s, |n| n.report.certificate.penetration)),
        kind("complementarity", "1", "sum p |g|/(F s)", |s| {
            normal(s, |n| n.report.certificate.complementarity)
        }),
        kind("load_error", "1", "|F - F_asked|/F_asked; of a mean gap its miss over s", |s| {
            normal(s, |n| n.report.certificate.load_error)
        }),
    ]);
    if scene.request.prescribes_distance() {
        let meaning = "bound of the relative error of the force under a prescribed approach or mean gap; an estimate with adhesion";
        list.push(kind("force_error", "1", meaning, |s| normal(s, |n| n.report.certificate.force_error)));
    }
    if scene.effects.adhesion != Adhesion::Off {
        let what =
            "largest difference of an attraction from the law of its gap, over the traction in contact";
        list.push(kind("equilibrium", "1", what, |s| normal(s, |n| n.report.certificate.equilibrium)));
    }
    if outputs.needs_stiffness() {
        let meaning = "estimated relative error of the stiffness; that of a difference quotient with adhesion of short range and Dugdale's \
                       law, where the cells decide it and not the tolerance";
        list.push(kind("stiffness_error", "1", meaning, |s| {
            normal(s, |n| n.report.certificate.error_of_stiffness())
        }));
    }
    if scene.requested.grid_error {
        list.push(kind("rms_slope", "1", "of the surface on the grid that was solved", |s| {
            s.rms_slope.into()
        }));
        let held = |name: &str| list.iter().any(|column| column.name == name);
        let compared = grid_error_columns().into_iter().filter(|(name, _)| held(name));
        list.extend(compared.flat_map(|(_, columns)| columns).collect::<Vec<_>>());
    }
    list.push(kind("note", "-", "why a model refused a load, or what to beware of", |s| {
        s.note.clone().into()
    }));
    list
}

/// For each quantity that is compared with coarser grids ([`COMPARED`]), the estimated error and order.
fn grid_error_columns() -> [(&'static str, [ResultColumn; 2]); COMPARED.len()] {
    macro_rules! columns {
        ($($place:literal $name:literal $free:literal),*) => { [$(($name, [
            ResultColumn {
                name: concat!($name, "_grid_error"),
                unit: "1",
                meaning: concat!("estimated relative error of the grid, from cells twice and four times as large", $free),
                value: |s| s.grid_errors[$place].map(|e| e.error).into(),
            },
            ResultColumn {
                name: concat!($name, "_grid_order"),
                unit: "1",
                meaning: concat!("order of convergence as observed on these grids; empty where none is seen", $free),
                value: |s| s.grid_errors[$place].and_then(|e| e.order).into(),
            },
        ])),*] };
    }
    columns!(
        0 "stiffness" "",
        1 "stiffness_fixed_area" "",
        2 "area" "",
        3 "area_corrected" "",
        4 "conductance" "",
        5 "mean_gap" "",
        6 "largest_pressure" "; empty with free boundaries, where the pressure at an edge of the rectangle or a spike grows without limit",
        7 "rms_slope" ""
    )
}

/// The columns of a scene with their units.
pub(crate) fn columns(scene: &SceneFile) -> Vec<Column> {
    // Without units a dimensional number is in the scene's own: only pure numbers and texts keep theirs.
    let unit = |unit| match (scene.system, unit) {
        (System::Si, unit) => unit,
        (System::None, "1" | "-") => unit,
        (System::None, _) => "scene",
    };
    kinds(scene)
        .into_iter()
        .map(|k| Column { name: k.name, unit: unit(k.unit), meaning: k.meaning })
        .collect()
}

/// The row of a state.
pub(crate) fn row(scene: &SceneFile, state: &State) -> Vec<Value> {
    kinds(scene).iter().map(|k| finite((k.value)(state))).collect()
}

/// A certificate of a state that was stopped may hold infinities: absent in a table.
fn finite(value: Value) -> Value {
    match value {
        Value::Number(v) if !v.is_finite() => Value::Empty,
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_compared_has_its_columns() {
        assert_eq!(grid_error_columns().map(|(name, _)| name), COMPARED);
    }
}
