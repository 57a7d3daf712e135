//! The table of quantities as properties of a class, as values of a state, and as a list.

use crate::state::PyContactState;
use fractal_contact::quantities::{AskedBy, QUANTITIES, QuantityUnit, Role, StateQuantity};
use fractal_contact::{
    ContactState as RustState, FIELDS, FieldQuantity, Normalisation, Outputs, Patches, SolveReport, Value,
};
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyString};

/// A value as one of Python.
pub fn object(py: Python<'_>, value: Value) -> PyResult<Bound<'_, PyAny>> {
    Ok(match value {
        Value::Text(text) => PyString::new(py, &text).into_any(),
        Value::Number(number) => number.into_pyobject(py)?.into_any(),
        Value::Count(count) => count.into_pyobject(py)?.into_any(),
        Value::Flag(flag) => flag.into_pyobject(py)?.to_owned().into_any(),
        Value::Empty => py.None().into_bound(py),
    })
}

/// Whether a state that lacks it does not name it: the quantities of effects and of paths.
pub fn is_named_where_known(quantity: &StateQuantity) -> bool {
    match quantity.asked_by {
        AskedBy::Effect(_)
        | AskedBy::Path
        | AskedBy::FrictionInPlane
        | AskedBy::AnyTangentialStiffness
        | AskedBy::All(_) => true,
        AskedBy::Output(output) => Outputs::OF_FRICTION.contains(&output),
        _ => false,
    }
}

/// Its type in Python, and whether a state may lack it.
fn kind(quantity: &StateQuantity) -> (&'static str, bool) {
    let normalisation = Normalisation { contact_modulus: 1.0, length: 1.0, height: None };
    let value = |state: &RustState| (quantity.value)(state, &normalisation);
    let bare = RustState::new(1.0, SolveReport::exact(""));
    let mut counted = bare.clone().with_patches(Patches::default());
    counted.report.contact_cells = Some(1);
    let kind = match value(&counted) {
        Value::Text(_) => "str",
        Value::Count(_) => "int",
        Value::Flag(_) => "bool",
        Value::Empty if quantity.unit == QuantityUnit::Word => "str",
        Value::Number(_) | Value::Empty => "float",
    };
    (kind, value(&bare) == Value::Empty)
}

/// Whether a quantity of this name is a number of things.
pub fn is_count(name: &str) -> bool {
    QUANTITIES.iter().any(|quantity| quantity.name == name && kind(quantity).0 == "int")
}

/// What a property says of itself.
fn sentence(quantity: &StateQuantity) -> String {
    let (kind, optional) = kind(quantity);
    let StateQuantity { words, meaning, unit, .. } = *quantity;
    let of = if meaning.contains(words) { String::new() } else { format!("{words}, ") };
    let unit = match unit {
        QuantityUnit::Word | QuantityUnit::One => String::new(),
        unit => format!(" [{}]", unit.words()),
    };
    format!("{kind}{}: {of}{meaning}{unit}.", if optional { " or None" } else { "" })
}

/// Gives the class of states a documented property for each quantity that it does not have as something else.
pub fn make_properties(py: Python<'_>) -> PyResult<()> {
    let class = py.get_type::<PyContactState>();
    let property = py.import("builtins")?.getattr("property")?;
    for quantity in QUANTITIES {
        if class.hasattr(quantity.name)? {
            continue;
        }
        let get = PyCFunction::new_closure(py, None, None, move |args, _| -> PyResult<Py<PyAny>> {
            let state = args.get_item(0)?.cast_into::<PyContactState>()?;
            Ok(object(args.py(), state.get().value(quantity))?.unbind())
        })?;
        class.setattr(quantity.name, property.call1((get, py.None(), py.None(), sentence(quantity)))?)?;
    }
    for quantity in FIELDS {
        let get = PyCFunction::new_closure(py, None, None, move |args, _| -> PyResult<_> {
            let state = args.get_item(0)?.cast_into::<PyContactState>()?;
            Ok(state.get().field(args.py(), quantity))
        })?;
        let FieldQuantity { name, meaning, unit, .. } = quantity;
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let sentence =
            format!("numpy.ndarray or None: {meaning}{unit}, shape {}. Read-only.", shape(quantity));
        class.setattr(*name, property.call1((get, py.None(), py.None(), sentence))?)?;
    }
    Ok(())
}

/// Shape of the array of a field.
fn shape(field: &FieldQuantity) -> &'static str {
    if field.components == 1 { "(rows, columns)" } else { "(2, rows, columns)" }
}

/// The quantities that are reported of a state, in the order of the columns of tables.
///
/// Returns
/// -------
/// list of dict of str
///     ``name``, ``words``, ``symbol`` (TeX), ``unit`` (SI; ``1`` for a pure number, ``-`` for text), ``meaning``,
///     ``source``, ``asked_by`` (what brings it into a table), ``role`` (``answer``, ``normalised``, ``residual``,
///     ``work`` or ``of_path``) and ``type`` in Python.
#[pyfunction]
pub fn quantities(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |quantity: &StateQuantity| {
        let (kind, optional) = kind(quantity);
        let role = match quantity.role {
            Role::Answer => "answer",
            Role::Normalised => "normalised",
            Role::OfPath => "of_path",
            Role::Residual(_) => "residual",
            Role::Work => "work",
        };
        let row = PyDict::new(py);
        row.set_item("name", quantity.name)?;
        row.set_item("words", quantity.words)?;
        row.set_item("symbol", quantity.symbol)?;
        row.set_item("unit", quantity.unit.words())?;
        row.set_item("meaning", quantity.meaning)?;
        row.set_item("source", quantity.source)?;
        row.set_item("asked_by", quantity.asked_by.words())?;
        row.set_item("role", role)?;
        row.set_item("type", if optional { format!("{kind} | None") } else { kind.to_owned() })?;
        Ok(row)
    };
    QUANTITIES.iter().map(row).collect()
}

/// The fields of states.
///
/// Returns
/// -------
/// list of dict of str
///     ``name``, ``words``, ``symbol``, ``unit``, ``meaning`` and ``shape``.
#[pyfunction]
pub fn fields(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |field: &FieldQuantity| {
        let row = PyDict::new(py);
        row.set_item("name", field.name)?;
        row.set_item("words", field.words)?;
        row.set_item("symbol", field.symbol)?;
        row.set_item("unit", field.unit)?;
        row.set_item("meaning", field.meaning)?;
        row.set_item("shape", shape(field))?;
        Ok(row)
    };
    FIELDS.iter().map(row).collect()
}
