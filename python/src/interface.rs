//! What an interface lets through and what the bodies bear, of arrays.

use crate::errors::of_model;
use crate::memory;
use crate::numbers::RealNumber;
use crate::pool;
use crate::state;
use fractal_contact::bem3d::{Film, film_conductance_until, film_memory};
use fractal_contact::interface::stress::{self, StressedBody, SubsurfaceStress, SurfaceLoad, stress_memory};
use fractal_contact::interface::{self, FlowAxis, FlowBounds, FlowOptions, Leakage, SheetFlow};
use fractal_contact::runs::check_memory;
use fractal_contact::{Boundary, Cells, Error, Field, Result, Stop};
use numpy::{PyArray1, PyArray2, PyArray4, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bytes for each cell of paths: the order of the cells, and disjoint sets.
const PATHS: f64 = 20.0;
/// Stresses of which one task finds the equivalent stress. Between two tasks Ctrl-C is heard.
const CHUNK: usize = 1 << 16;

/// Two-dimensional C-ordered doubles, as `fractal_contact._arrays` prepares them.
type MapArray<'py> = PyReadonlyArray2<'py, f64>;

fn cells(map: &MapArray<'_>) -> Cells {
    let [rows, columns] = map.shape() else { unreachable!("two dimensions") };
    Cells { columns: *columns, rows: *rows }
}

/// A copy of a map, whose cells have these sides.
fn field(py: Python<'_>, map: &MapArray<'_>, (dx, dy): (f64, f64)) -> PyResult<Field> {
    let cells = cells(map);
    let size = [dx * cells.columns as f64, dy * cells.rows as f64];
    Field::new(cells, size, map.to_vec()?).map_err(|error| of_model(py, error))
}

fn axis(along_y: bool) -> FlowAxis {
    if along_y { FlowAxis::Y } else { FlowAxis::X }
}

/// The boundary of a map that repeats itself along x, along y, along both or along neither.
fn boundary(repeats: [bool; 2]) -> Boundary {
    match repeats {
        [false, false] => Boundary::Free,
        [true, true] => Boundary::Periodic,
        [true, false] => Boundary::PeriodicAlongX,
        [false, true] => Boundary::PeriodicAlongY,
    }
}

/// Says stop to work whose caller is gone.
struct StopOnDrop(Arc<AtomicBool>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs what can be stopped. Where the handler of a signal raises, the caller has that exception at once, and the work
/// ends where it looks next: transforms of large maps take seconds in between.
fn run<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(Stop<'_>) -> Result<R> + Send + 'static,
) -> PyResult<R> {
    let stopped = Arc::new(AtomicBool::new(false));
    let _caller = StopOnDrop(Arc::clone(&stopped));
    let result = pool::call(py, move || work(&|| stopped.load(Ordering::Relaxed)))?;
    result.map_err(|error| of_model(py, error))
}

/// Flow between opposite edges.
#[pyfunction]
pub fn leakage<'py>(
    py: Python<'py>,
    gap: MapArray<'py>,
    cell: (f64, f64),
    along_y: bool,
    repeats: [bool; 2],
    tolerance: RealNumber,
    continuum: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (options, cells) = (FlowOptions { tolerance: tolerance.0, continuum }, cells(&gap));
    memory::check_grid(
        py,
        "the flow through a map",
        cells,
        interface::flow_memory(cells, options) + cells.map_bytes(),
    )?;
    let gap = field(py, &gap, cell)?;
    let found =
        run(py, move |stop| interface::leakage_until(&gap, axis(along_y), boundary(repeats), options, stop))?;
    let dict = PyDict::new(py);
    dict.set_item("lower", found.network.lower)?;
    dict.set_item("upper", found.network.upper)?;
    dict.set_item("continuum_lower", found.continuum.map(|bounds| bounds.lower))?;
    dict.set_item("continuum_upper", found.continuum.map(|bounds| bounds.upper))?;
    dict.set_item("mean_gap", found.mean_gap)?;
    dict.set_item("flow_factor", found.flow_factor.map(FlowBounds::middle))?;
    let SheetFlow { potential, reached, flux, iterations, .. } = found.flow;
    dict.set_item("pressure", state::array(py, vec![potential])?)?;
    dict.set_item("reached", PyArray1::from_vec(py, reached).reshape([cells.rows, cells.columns])?)?;
    dict.set_item("flux", state::array(py, flux.into())?)?;
    dict.set_item("iterations", iterations)?;
    Ok(dict)
}

/// Conduction from one body to the other, through the contact and a film in the gap.
#[pyfunction]
pub fn film_conductance<'py>(
    py: Python<'py>,
    gap: MapArray<'py>,
    cell: (f64, f64),
    resistivities: (RealNumber, RealNumber),
    repeats: [bool; 2],
    tolerance: RealNumber,
) -> PyResult<Bound<'py, PyDict>> {
    let cells = cells(&gap);
    memory::check_grid(py, "the film of a map", cells, film_memory(cells))?;
    let gap = field(py, &gap, cell)?;
    let film = Film { resistivity: resistivities.0.0, bodies: resistivities.1.0 };
    let found =
        run(py, move |stop| film_conductance_until(&gap, film, boundary(repeats), tolerance.0, stop))?;
    let dict = PyDict::new(py);
    dict.set_item("lower", found.lower)?;
    dict.set_item("upper", found.upper)?;
    dict.set_item("current_density", state::array(py, vec![found.current_density])?)?;
    dict.set_item("iterations", found.steps)?;
    Ok(dict)
}

/// The bounds of the flow of a fluid under a pressure drop, of those of the conductance.
#[pyfunction]
pub fn flow_rate(
    py: Python<'_>,
    lower: f64,
    upper: f64,
    pressure_drop: RealNumber,
    viscosity: RealNumber,
) -> PyResult<(f64, f64)> {
    let told = |error| of_model(py, error);
    let none = || Field::new(1, 1.0, vec![0.0]);
    let network = FlowBounds { lower, upper };
    // Fields have no part in it.
    let flow = SheetFlow {
        network,
        continuum: None,
        potential: none().map_err(told)?,
        reached: Vec::new(),
        flux: [none().map_err(told)?, none().map_err(told)?],
        iterations: 0,
    };
    let leakage = Leakage { network, continuum: None, mean_gap: 0.0, flow_factor: None, flow };
    let FlowBounds { lower, upper } = leakage.flow_rate(pressure_drop.0, viscosity.0).map_err(told)?.network;
    Ok((lower, upper))
}

/// What leads from edge to edge.
#[pyfunction]
pub fn percolation<'py>(
    py: Python<'py>,
    gap: MapArray<'py>,
    cell: (f64, f64),
    along_y: bool,
    repeats: [bool; 2],
    g_min: RealNumber,
) -> PyResult<Bound<'py, PyDict>> {
    let cells = cells(&gap);
    memory::check_grid(py, "the paths through a map", cells, cells.map_bytes() / 8.0 * (PATHS + 8.0))?;
    let gap = field(py, &gap, cell)?;
    let (dx, dy) = (gap.dx(), gap.dy());
    let found =
        pool::call(py, move || interface::percolation(&gap, g_min.0, axis(along_y), boundary(repeats)))?;
    let found = found.map_err(|error| of_model(py, error))?;
    let narrowest = found.constriction;
    let dict = PyDict::new(py);
    dict.set_item("spans", found.spans)?;
    dict.set_item("constriction", narrowest.gap)?;
    dict.set_item("column", narrowest.column)?;
    dict.set_item("row", narrowest.row)?;
    dict.set_item("at", ((narrowest.column as f64 + 0.5) * dx, (narrowest.row as f64 + 0.5) * dy))?;
    dict.set_item("contact_spans", found.contact_spans)?;
    dict.set_item("contact_blocks", found.contact_blocks)?;
    Ok(dict)
}

/// What acts on a body, and the body.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct GivenLoad<'py> {
    pressure: MapArray<'py>,
    traction: Option<(MapArray<'py>, MapArray<'py>)>,
    cell: (f64, f64),
    poisson: RealNumber,
    repeats: [bool; 2],
}

impl GivenLoad<'_> {
    /// `MemoryError` where this load, what plans its stress and so many further bytes are more than there are.
    fn check_memory(&self, py: Python<'_>, more: f64) -> PyResult<()> {
        let (cells, tractions) = (cells(&self.pressure), self.traction.is_some());
        let bytes = stress_memory(cells, boundary(self.repeats), tractions);
        check(cells, bytes + more).map_err(|error| of_model(py, error))
    }

    fn load(&self, py: Python<'_>) -> PyResult<(SurfaceLoad, StressedBody)> {
        let pressure = field(py, &self.pressure, self.cell)?;
        let load = match &self.traction {
            None => SurfaceLoad::new(pressure),
            Some((x, y)) => {
                SurfaceLoad::with_traction(pressure, [field(py, x, self.cell)?, field(py, y, self.cell)?])
            }
        };
        let body = StressedBody { boundary: boundary(self.repeats), ..StressedBody::new(self.poisson.0) };
        Ok((load.map_err(|error| of_model(py, error))?, body))
    }
}

fn check(cells: Cells, bytes: f64) -> Result<()> {
    let Cells { columns, rows } = cells;
    check_memory(format!("the stress below a map of {columns} columns x {rows} rows"), bytes)
}

/// Checks all depths before the first one is begun.
fn check_depths(py: Python<'_>, depths: &[f64]) -> PyResult<()> {
    let wrong = depths.iter().position(|depth| !(depth.is_finite() && *depth >= 0.0));
    wrong.map_or(Ok(()), |i| Err(of_model(py, Error::of_non_negative(format!("depths[{i}]"), depths[i]))))
}

/// The stress at the centres of all cells, `[component, depth, row, column]`.
#[pyfunction]
pub fn stress_at_depths<'py>(
    py: Python<'py>,
    load: GivenLoad<'py>,
    depths: Vec<f64>,
) -> PyResult<Bound<'py, PyArray4<f64>>> {
    check_depths(py, &depths)?;
    let cells = cells(&load.pressure);
    let bytes = 6.0 * depths.len() as f64 * cells.map_bytes();
    load.check_memory(py, bytes)?;
    let (load, body) = load.load(py)?;
    let (count, planes) = (cells.columns * cells.rows, depths.len());
    let values = run(py, move |stop| {
        let plan = SubsurfaceStress::new(&load, body)?;
        // That of a map which repeats itself along one axis depends on its shape.
        check(cells, plan.memory() + bytes)?;
        let mut values = vec![0.0; 6 * planes * count];
        for (i, depth) in depths.iter().enumerate() {
            let plane = plan.at_depth(*depth, stop).map_err(|error| of_depth(error, i))?;
            for (component, field) in plane.components().iter().enumerate() {
                values[(component * planes + i) * count..][..count].copy_from_slice(field.values());
            }
        }
        Ok(values)
    })?;
    PyArray1::from_vec(py, values).reshape([6, planes, cells.rows, cells.columns])
}

/// The error of a depth by its place among all of them.
fn of_depth(error: Error, i: usize) -> Error {
    match error {
        Error::Domain { name, value, expected } if name == "depths[0]" => {
            Error::domain(format!("depths[{i}]"), value, expected)
        }
        other => other,
    }
}

/// The stress at points, `[component, point]`.
#[pyfunction]
pub fn stress_at_points<'py>(
    py: Python<'py>,
    load: GivenLoad<'py>,
    points: MapArray<'py>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let points = points.as_slice()?.as_chunks().0.to_vec();
    let cells = cells(&load.pressure);
    // The load and its loaded cells; one sum for each thousand of these.
    let sums = cells.map_bytes() / 8.0 / 1024.0 + 4.0;
    let loads = cells.map_bytes() * if load.traction.is_some() { 8.0 } else { 6.0 };
    check(cells, loads + 48.0 * points.len() as f64 * sums).map_err(|error| of_model(py, error))?;
    let (load, body) = load.load(py)?;
    let found = run(py, move |stop| stress::stress_at_points(&load, body, &points, stop))?;
    let values = (0..6).flat_map(|component| found.iter().map(move |stress| stress[component])).collect();
    PyArray1::from_vec(py, values).reshape([6, found.len()])
}

/// The largest equivalent stress of von Mises, its depth, its column and row, its place, and the stress there.
#[pyfunction]
pub fn largest_von_mises<'py>(
    py: Python<'py>,
    load: GivenLoad<'py>,
    depths: Vec<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    load.check_memory(py, 6.0 * cells(&load.pressure).map_bytes())?;
    let (load, body) = load.load(py)?;
    let found = run(py, move |stop| stress::largest_von_mises(&load, body, &depths, stop))?;
    let dict = PyDict::new(py);
    dict.set_item("value", found.value)?;
    dict.set_item("depth", found.depth)?;
    dict.set_item("column", found.cell[0])?;
    dict.set_item("row", found.cell[1])?;
    dict.set_item("at", (found.centre[0], found.centre[1]))?;
    dict.set_item("stress", PyArray1::from_slice(py, &found.stress))?;
    Ok(dict)
}

/// The equivalent stress of von Mises of stresses `[component, stress]`, and the number of the first one that no finite
/// number gives.
#[pyfunction]
pub fn von_mises<'py>(
    py: Python<'py>,
    stress: MapArray<'py>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Option<usize>)> {
    let count = cells(&stress).columns;
    memory::check(py, format!("the equivalent stress of {count} stresses"), 8.0 * count as f64)?;
    let components = stress.as_slice()?;
    let mut found = Vec::with_capacity(count);
    while found.len() < count {
        py.check_signals()?;
        let begun = found.len();
        // A copy: while the interpreter's lock is released, the caller may write into the array.
        let part: Vec<[f64; 6]> = (begun..count.min(begun + CHUNK))
            .map(|i| std::array::from_fn(|component| components[component * count + i]))
            .collect();
        py.detach(|| found.extend(part.iter().map(of_finite)));
    }
    let wrong = found.iter().position(|value: &f64| !value.is_finite());
    Ok((PyArray1::from_vec(py, found), wrong))
}

/// The equivalent stress; not a number where a component is not finite.
fn of_finite(components: &[f64; 6]) -> f64 {
    if components.iter().all(|component| component.is_finite()) {
        stress::von_mises(components)
    } else {
        f64::NAN
    }
}
