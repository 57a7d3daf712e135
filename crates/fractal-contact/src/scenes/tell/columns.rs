//! The columns of `results.csv`: the quantities that a scene requests.

use crate::scenes::plan::RMS_SLOPE;
use crate::scenes::read::{LoadList, LoadRequest, Numerics, SceneFile};
use crate::scenes::run::{SolvedUnit, StateRecord};
use contact_model::quantities::{Compared, QUANTITIES, SceneProperties, StateQuantity};
use contact_model::{Column, Table, Value};
use contact_model::{Directions, Source};

/// The discretisation error of a quantity, and the order of convergence.
const GRID_ERROR: &str = "estimated relative error of the grid, from cells twice and four times as large";
const GRID_ORDER: &str = "order of convergence as observed on these grids; empty where none is seen";
const GRID_ERROR_PERIODIC: &str = "estimated relative error of the grid, from cells twice and four times as large; empty with free boundaries, where the pressure at an \
     edge of the rectangle or a spike grows without limit, and where the surface has waves that cells twice as large do not resolve";
const GRID_ORDER_PERIODIC: &str = "order of convergence as observed on these grids; empty where none is seen; empty with free boundaries, where the pressure at an edge \
     of the rectangle or a spike grows without limit, and where the surface has waves that cells twice as large do not resolve";

/// Name, unit and meaning of a column.
pub(crate) type ColumnWords = (&'static str, &'static str, &'static str);

pub(crate) const MODEL: ColumnWords = ("model", "-", "who answers");
pub(crate) const SURFACE: ColumnWords = ("surface", "1", "number of the surface, from 0");
pub(crate) const LOAD: ColumnWords = ("state", "1", "number of the load, from 0");
pub(crate) const STATE: ColumnWords = ("state", "1", "number of the load or step, from 0");

pub(crate) fn plain((name, unit, meaning): ColumnWords) -> Column {
    Column { name, unit, meaning }
}

/// A table whose rows have a value for each column. `what` names a row in errors.
///
/// # Errors
/// A number that is not finite.
pub(crate) fn table<const N: usize>(
    title: impl Into<String>,
    columns: [ColumnWords; N],
    rows: impl IntoIterator<Item = [Value; N]>,
    what: &str,
) -> runs::Result<Table> {
    let mut table = Table::new(title, columns.map(plain).into());
    for row in rows {
        table.push(row.into()).map_err(runs::Error::model(what))?;
    }
    Ok(table)
}

/// The sources of a scene's results, each with `model` or `quantity` and the name of that model or quantity.
pub(crate) fn sources(scene: &SceneFile) -> Vec<(&'static str, &'static str, Source)> {
    let of_models = scene.models.iter().flat_map(|numerics| {
        let model = numerics.model();
        let all = model.sources().iter().copied().chain(model.sources_of(&scene.effects));
        all.map(|source| ("model", numerics.name(), source)).collect::<Vec<_>>()
    });
    let of_quantities = asked(scene).filter(|quantity| !quantity.source.is_empty()).map(|quantity| {
        let source = Source { citation: quantity.source, what: quantity.words };
        ("quantity", quantity.name, source)
    });
    of_models.chain(of_quantities).collect()
}

/// The quantities that a scene requests, in the order of the table of all quantities.
pub(crate) fn asked(scene: &SceneFile) -> impl Iterator<Item = &'static StateQuantity> + '_ {
    let answers_both = |model: &Numerics| model.model().abilities().directions == Directions::Plane;
    let [_, along_y] = scene.request.shears();
    let both = along_y || scene.models.iter().any(answers_both);
    let interface = scene.requested.interface.outputs();
    QUANTITIES.iter().filter(move |quantity| {
        quantity.asked_by.holds(&SceneProperties {
            effects: &scene.effects,
            outputs: &scene.requested.outputs,
            interface: &interface,
            rough: scene.surface.is_rough(),
            path: scene.is_history(),
            prescribes_distance: scene.request.prescribes_distance(),
            directions: if both { Directions::Plane } else { Directions::AlongX },
        })
    })
}

/// Those of them whose discretisation error is reported.
pub(crate) fn with_grid_errors(scene: &SceneFile) -> impl Iterator<Item = &'static StateQuantity> + '_ {
    asked(scene).filter(|quantity| scene.requested.grid_error && quantity.compared != Compared::No)
}

/// The column of a quantity.
pub(crate) fn column(scene: &SceneFile, quantity: &StateQuantity) -> Column {
    let unit = scene.system.unit(quantity.unit.si(&scene.requested.outputs));
    Column { name: quantity.name, unit, meaning: quantity.meaning }
}

/// The number that a load prescribes; `None` along a path.
pub(crate) fn prescribed(scene: &SceneFile) -> Option<Column> {
    let LoadRequest::Loads(LoadList { kind, .. }) = &scene.request else { return None };
    Some(Column { name: "prescribed", unit: scene.system.unit(kind.unit()), meaning: kind.meaning() })
}

/// The columns of a scene with their units.
pub(crate) fn columns(scene: &SceneFile) -> Vec<Column> {
    let mut columns = [MODEL, SURFACE, STATE].map(plain).to_vec();
    columns.extend(prescribed(scene));
    columns.extend(asked(scene).map(|quantity| column(scene, quantity)));
    if scene.requested.grid_error {
        columns.push(plain((RMS_SLOPE, "1", "of the surface on the grid that was solved")));
        for quantity in with_grid_errors(scene) {
            let [.., error, order, _, _] = quantity.columns;
            let periodic = quantity.compared == Compared::Periodic;
            columns.push(plain((error, "1", if periodic { GRID_ERROR_PERIODIC } else { GRID_ERROR })));
            columns.push(plain((order, "1", if periodic { GRID_ORDER_PERIODIC } else { GRID_ORDER })));
        }
        columns.push(plain(("rms_slope_grid_error", "1", GRID_ERROR)));
        columns.push(plain(("rms_slope_grid_order", "1", GRID_ORDER)));
    }
    columns.push(plain(("note", "-", "why a model refused a load, or warnings on the state")));
    columns
}

/// The row of a state, in the order of [`columns`].
pub(crate) fn row(scene: &SceneFile, unit: &SolvedUnit<'_>, record: &StateRecord) -> Vec<Value> {
    let mut row = vec![unit.model.into(), unit.surface.into(), record.index.into()];
    row.extend(scene.request.prescribed(record.index).map(Value::from));
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

/// A quantity of a state; a refused load has only a status.
pub(crate) fn value(record: &StateRecord, quantity: &StateQuantity) -> Value {
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
    fn compared_quantities_have_columns_of_their_grid_errors() {
        for quantity in compared() {
            let [.., error, order, _, _] = quantity.columns;
            assert_eq!(
                [error, order],
                ["_grid_error", "_grid_order"].map(|end| quantity.name.to_owned() + end)
            );
        }
    }
}
