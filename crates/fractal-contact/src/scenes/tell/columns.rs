//! The columns of `results.csv`: the quantities that a scene asks for.

use crate::scenes::plan::grid_comparison::RMS_SLOPE;
use crate::scenes::read::entries::System;
use crate::scenes::read::loads::{LoadKind, LoadRequest};
use crate::scenes::read::scene_file::SceneFile;
use crate::scenes::run::state_result::{SolvedUnit, StateRecord};
use analysis::{Column, Value};
use contact_model::quantities::{Compared, QUANTITIES, Quantity, Question};

/// The error of a quantity that the cells leave, and the order of convergence.
const GRID_ERROR: &str = "estimated relative error of the grid, from cells twice and four times as large";
const GRID_ORDER: &str = "order of convergence as observed on these grids; empty where none is seen";
const GRID_ERROR_PERIODIC: &str = "estimated relative error of the grid, from cells twice and four times as large; empty with free boundaries, where the pressure at an \
     edge of the rectangle or a spike grows without limit";
const GRID_ORDER_PERIODIC: &str = "order of convergence as observed on these grids; empty where none is seen; empty with free boundaries, where the pressure at an edge \
     of the rectangle or a spike grows without limit";

/// The quantities that a scene asks for, in the order of the table of all.
pub(crate) fn asked(scene: &SceneFile) -> impl Iterator<Item = &'static Quantity> + '_ {
    let question = Question {
        effects: &scene.effects,
        outputs: &scene.requested.outputs,
        rough: scene.surface.is_rough(),
        path: scene.is_history(),
        prescribes_distance: scene.request.prescribes_distance(),
    };
    QUANTITIES.iter().filter(move |quantity| quantity.asked_by.holds(&question))
}

/// Those of them whose error of the grid is told.
pub(crate) fn with_grid_errors(scene: &SceneFile) -> impl Iterator<Item = &'static Quantity> + '_ {
    asked(scene).filter(|quantity| scene.requested.grid_error && quantity.compared != Compared::No)
}

/// Unit of a column of a scene: without units a dimensional number is in the scene's own, and only pure
/// numbers and texts keep theirs.
pub(crate) fn unit(scene: &SceneFile, si: &'static str) -> &'static str {
    match (scene.system, si) {
        (System::Si, si) => si,
        (System::None, "1" | "-") => si,
        (System::None, _) => "scene",
    }
}

/// The column of a quantity.
pub(crate) fn column(scene: &SceneFile, quantity: &Quantity) -> Column {
    let unit = unit(scene, quantity.unit.si(&scene.requested.outputs));
    Column { name: quantity.name, unit, meaning: quantity.meaning }
}

/// The number that a load prescribes; `None` along a path.
pub(crate) fn prescribed(scene: &SceneFile) -> Option<Column> {
    let LoadRequest::Loads(loads) = &scene.request else { return None };
    let (si, meaning) = match loads.kind {
        LoadKind::Force => ("N", "force"),
        LoadKind::ForceBar => {
            ("1", "F_bar = F/(E* h L) with this surface's measured rms height h, L = sqrt(Lx Ly)")
        }
        LoadKind::MeanPressure => ("Pa", "mean pressure, F/(Lx Ly), undefined points included"),
        LoadKind::Approach => ("m", "approach"),
        LoadKind::MeanGap => ("m", "mean gap"),
    };
    Some(Column { name: "prescribed", unit: unit(scene, si), meaning })
}

/// The columns of a scene with their units.
pub(crate) fn columns(scene: &SceneFile) -> Vec<Column> {
    let plain = |name, unit, meaning| Column { name, unit, meaning };
    let mut columns = vec![
        plain("model", "-", "who answers"),
        plain("surface", "1", "number of the surface, from 0"),
        plain("state", "1", "number of the load or step, from 0"),
    ];
    columns.extend(prescribed(scene));
    columns.extend(asked(scene).map(|quantity| column(scene, quantity)));
    if scene.requested.grid_error {
        columns.push(plain(RMS_SLOPE, "1", "of the surface on the grid that was solved"));
        for quantity in with_grid_errors(scene) {
            let [.., error, order, _, _] = quantity.columns;
            let periodic = quantity.compared == Compared::Periodic;
            columns.push(plain(error, "1", if periodic { GRID_ERROR_PERIODIC } else { GRID_ERROR }));
            columns.push(plain(order, "1", if periodic { GRID_ORDER_PERIODIC } else { GRID_ORDER }));
        }
        columns.push(plain("rms_slope_grid_error", "1", GRID_ERROR));
        columns.push(plain("rms_slope_grid_order", "1", GRID_ORDER));
    }
    columns.push(plain("note", "-", "why a model refused a load, or what to beware of"));
    columns
}

/// The row of a state, in the order of [`columns`].
pub(crate) fn row(scene: &SceneFile, unit: &SolvedUnit<'_>, record: &StateRecord) -> Vec<Value> {
    let mut row = vec![unit.model.into(), unit.surface.into(), record.index.into()];
    if let LoadRequest::Loads(loads) = &scene.request {
        row.push(loads.values[record.index].into());
    }
    row.extend(asked(scene).map(|quantity| value(record, quantity)));
    if scene.requested.grid_error {
        let grid = record.solved().and_then(|solved| solved.grid.as_ref());
        row.push(grid.map(|grid| grid.rms_slope).into());
        let names = with_grid_errors(scene).map(|quantity| quantity.name).chain([RMS_SLOPE]);
        for name in names {
            let error = grid.and_then(|grid| grid.of(name));
            row.push(error.map(|error| error.error).into());
            row.push(error.and_then(|error| error.order).into());
        }
    }
    row.push(record.note().into());
    row
}

/// A quantity of a state; of a refused load its status alone.
pub(crate) fn value(record: &StateRecord, quantity: &Quantity) -> Value {
    if quantity.name == "status" {
        return record.status().into();
    }
    let value = record.solved().map(|solved| (quantity.value)(&solved.state, &solved.normalisation));
    match value {
        // A certificate of a state that was stopped may hold infinities: absent in a table.
        Some(Value::Number(v)) if !v.is_finite() => Value::Empty,
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use crate::scenes::plan::grid_comparison::compared;

    #[test]
    fn what_is_compared_has_the_columns_of_its_name() {
        for quantity in compared() {
            let [.., error, order, _, _] = quantity.columns;
            assert_eq!(
                [error, order],
                ["_grid_error", "_grid_order"].map(|end| quantity.name.to_owned() + end)
            );
        }
    }
}
