//! Memory that a call will take, compared with what there is before it is asked for: a system that refuses
//! memory later ends the process.

use crate::errors::of_model;
use fractal_contact::runs::check_memory;
use fractal_contact::{Cells, Load, PreparedContact, RequiredMemory, Result};
use pyo3::prelude::*;
use std::borrow::Cow;

/// `MemoryError` where `bytes` are more than there are; `what` names the size.
pub fn check(py: Python<'_>, what: impl Into<Cow<'static, str>>, bytes: f64) -> PyResult<()> {
    check_memory(what, bytes).map_err(|error| of_model(py, error))
}

/// Bytes of a contact, those of 200 cells a side, or of a solve, below which it is not looked at: to ask the system
/// would take a part of its time.
const SMALL: f64 = 2e6;

/// Number of small answers after which the memory is looked at: their caller may keep them all.
pub const MANY: u32 = 1024;
/// Bytes that are to be there then. So many answers without fields take a tenth of it.
const RESERVE: f64 = 32e6;

/// `MemoryError` where many small answers have left next to nothing.
pub fn check_many(py: Python<'_>) -> PyResult<()> {
    check(py, "1024 further states", RESERVE)
}

/// Whether contacts that need this much at least are looked at before each solve.
pub fn is_large(least: Option<&RequiredMemory>) -> bool {
    least.is_some_and(|least| least.bytes > SMALL)
}

/// `MemoryError` where a solve with a contact, which may be used by one thread at a time, needs more than
/// there is.
pub fn check_solve<C: Send + ?Sized>(
    py: Python<'_>,
    contact: &mut C,
    required: impl FnOnce(&mut C) -> Option<RequiredMemory> + Send,
) -> PyResult<()> {
    match py.detach(|| required(contact)) {
        Some(RequiredMemory { what, bytes }) if bytes > SMALL => check(py, what, bytes),
        _ => Ok(()),
    }
}

/// An error where one of these loads on a contact needs more than there is. As with [`check_solve`], small solves are
/// not looked at.
pub fn check_loads(contact: &dyn PreparedContact, loads: &[Load]) -> Result<()> {
    let required = loads.iter().filter_map(|&load| contact.required_memory(load));
    match required.max_by(|a, b| a.bytes.total_cmp(&b.bytes)) {
        Some(RequiredMemory { what, bytes }) if bytes > SMALL => check_memory(what, bytes),
        _ => Ok(()),
    }
}

/// The same for work on a grid.
pub fn check_grid(py: Python<'_>, what: &str, cells: Cells, bytes: f64) -> PyResult<()> {
    let Cells { columns, rows } = cells;
    check(py, format!("{what} of {columns} columns x {rows} rows"), bytes)
}
