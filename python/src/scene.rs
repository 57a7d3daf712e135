//! Scenes from the values of the Python classes.

use crate::errors::{of_model, of_values};
use crate::height_map::PyHeightMap;
use crate::numbers::{OneOrTwo, RealNumber, Seed};
use crate::toml_text::toml_text;
use fractal_contact::scenes::{EFFECT_KEYS, EffectKey, parse_effects};
use fractal_contact::{
    Amplitude, Body, Conductance, Effects, Friction, Line, Output, Outputs, Pair, Scene as RustScene,
    SelfAffine, Surface as RustSurface,
};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A parameter as what it should be; the error names it.
fn extracted<'py, T: FromPyObjectOwned<'py>>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<T> {
    value.extract::<T>().map_err(|error| {
        let error: PyErr = error.into();
        let shown = crate::numbers::shown(value);
        let message = format!("{name} = {shown}: {}", error.value(value.py()));
        if error.is_instance_of::<PyOverflowError>(value.py()) {
            PyValueError::new_err(message)
        } else {
            PyTypeError::new_err(message)
        }
    })
}

/// A parameter that has to be there.
fn required<'py, T: FromPyObjectOwned<'py>>(of: &Bound<'py, PyDict>, name: &str) -> PyResult<T> {
    let value = of.get_item(name)?.ok_or_else(|| PyTypeError::new_err(format!("{name} is missing")))?;
    extracted(&value, name)
}

/// A parameter that may be None or absent.
pub fn optional<'py, T: FromPyObjectOwned<'py>>(of: &Bound<'py, PyDict>, name: &str) -> PyResult<Option<T>> {
    match of.get_item(name)? {
        Some(value) if !value.is_none() => extracted(&value, name).map(Some),
        _ => Ok(None),
    }
}

/// The surface in contact.
#[pyclass(name = "Surface", frozen, module = "fractal_contact._core")]
#[derive(Clone)]
pub struct PySurface(pub RustSurface);

/// The kinds of surfaces and their parameters.
const KINDS: [(&str, &[&str]); 8] = [
    ("self_affine", &["size", "hurst", "rms_height", "roll_off_wavelength", "shortest_wavelength"]),
    ("sphere", &["radius", "size"]),
    ("cone", &["slope", "size"]),
    ("power_law", &["coefficient", "exponent", "size"]),
    ("flat_circle", &["radius", "size"]),
    ("flat", &["size"]),
    ("sine", &["amplitude", "wavelength", "size"]),
    ("line", &["heights", "length", "size"]),
];

/// A surface of a kind.
#[pyfunction]
pub fn surface(py: Python<'_>, kind: &str, parameters: &Bound<'_, PyDict>) -> PyResult<PySurface> {
    let Some((_, known)) = KINDS.iter().find(|(name, _)| *name == kind) else {
        let kinds: Vec<&str> = KINDS.iter().map(|(name, _)| *name).collect();
        let message = format!("no surface is of the kind {kind:?}: there are {}", kinds.join(", "));
        return Err(PyValueError::new_err(message));
    };
    for key in parameters.keys() {
        let key: String = key.extract()?;
        if !known.contains(&key.as_str()) {
            let message = format!("a {kind} has no {key:?}: there are {}", known.join(", "));
            return Err(PyTypeError::new_err(message));
        }
    }
    let number = |name: &str| required::<RealNumber>(parameters, name).map(|RealNumber(value)| value);
    let size = crate::height_map::size(required::<OneOrTwo<f64>>(parameters, "size")?);
    let surface = match kind {
        "self_affine" => {
            let wavenumber = |name: &str| -> PyResult<Option<f64>> {
                Ok(optional::<RealNumber>(parameters, name)?.map(|RealNumber(wavelength)| TAU / wavelength))
            };
            RustSurface::SelfAffine(SelfAffine {
                size,
                hurst: number("hurst")?,
                amplitude: Amplitude::RmsHeight(number("rms_height")?),
                roll_off: wavenumber("roll_off_wavelength")?,
                short_cutoff: wavenumber("shortest_wavelength")?,
            })
        }
        "sphere" => RustSurface::Sphere { radius: number("radius")?, size },
        "cone" => RustSurface::Cone { slope: number("slope")?, size },
        "power_law" => {
            RustSurface::PowerLaw { coefficient: number("coefficient")?, exponent: number("exponent")?, size }
        }
        "flat_circle" => RustSurface::FlatCircle { radius: number("radius")?, size },
        "flat" => RustSurface::Flat { size },
        "sine" => {
            RustSurface::Sine { amplitude: number("amplitude")?, wavelength: number("wavelength")?, size }
        }
        "line" => {
            let heights = required::<PyReadonlyArray1<'_, f64>>(parameters, "heights")?;
            let values = heights.as_slice()?.to_vec();
            let line = Line::new(number("length")?, values).map_err(|error| of_model(py, error))?;
            RustSurface::Line { line: Arc::new(line), size }
        }
        other => return Err(PyValueError::new_err(format!("no surface is of the kind {other:?}"))),
    };
    surface.validate().map_err(|error| of_model(py, error))?;
    Ok(PySurface(surface))
}

/// The height of each cell of a surface.
#[pyfunction]
pub fn height_map(
    py: Python<'_>,
    of: &PySurface,
    cells: OneOrTwo<usize>,
    seed: Seed,
) -> PyResult<PyHeightMap> {
    let cells = crate::surface_gen::cells(cells, of.0.size());
    let surface = of.0.clone();
    let bytes = fractal_contact::surface_gen::height_map_memory(&surface, cells);
    crate::memory::check_grid(py, "a map", cells, bytes)?;
    let map =
        crate::pool::call(py, move || fractal_contact::surface_gen::height_map(&surface, cells, seed.0))?;
    map.map(PyHeightMap::from).map_err(|error| of_model(py, error))
}

/// Everything physical about one contact problem.
#[pyclass(name = "Scene", frozen, module = "fractal_contact._core")]
#[derive(Clone)]
pub struct PyScene {
    pub scene: RustScene,
    /// Whether the caller named no outputs: the scene then asks for the stiffness.
    pub default_outputs: bool,
}

#[derive(FromPyObject)]
pub enum AnySurface {
    Map(Py<PyHeightMap>),
    Described(Py<PySurface>),
}

fn body(of: Option<(RealNumber, RealNumber)>) -> Body {
    of.map_or(Body::Rigid, |(RealNumber(young), RealNumber(poisson))| Body::Elastic { young, poisson })
}

/// The output of this name. The conductance is none of them: it needs what it is of.
fn output(name: &str) -> PyResult<Output> {
    let mut known = Output::ALL.iter().filter(|output| **output != Output::Conductance);
    known.clone().find(|output| output.name() == name).copied().ok_or_else(|| {
        let last = known.next_back().map_or("", |output| output.name());
        let others: Vec<&str> = known.map(|output| output.name()).collect();
        PyValueError::new_err(format!(
            "no output is called {name:?}: there are {} and {last}",
            others.join(", ")
        ))
    })
}

/// A scene of the values of the Python class.
#[pyfunction]
#[pyo3(signature = (surface, contact_modulus, bodies, effects, outputs, conductance))]
pub fn scene(
    py: Python<'_>,
    surface: AnySurface,
    contact_modulus: Option<RealNumber>,
    bodies: Option<[Option<(RealNumber, RealNumber)>; 2]>,
    effects: &Bound<'_, PyDict>,
    outputs: Option<Vec<String>>,
    conductance: Option<(String, RealNumber, RealNumber)>,
) -> PyResult<PyScene> {
    let surface = match surface {
        AnySurface::Map(map) => RustSurface::Heights(Arc::clone(&map.get().map)),
        AnySurface::Described(surface) => surface.get().0.clone(),
    };
    let pair = bodies.map(|[first, second]| Pair { first: body(first), second: body(second) });
    let made = match (contact_modulus, pair) {
        (Some(RealNumber(contact_modulus)), None) => Ok(RustScene::new(surface, contact_modulus)),
        (None, Some(pair)) => RustScene::of_pair(surface, pair),
        (None, None) => return Err(PyTypeError::new_err("give contact_modulus or bodies")),
        (Some(_), Some(_)) => return Err(PyTypeError::new_err("give contact_modulus or bodies, not both")),
    };
    let mut scene = made.map_err(|error| of_model(py, error))?;
    scene.effects = self::effects(py, effects)?;
    if scene.pair.is_none() && scene.effects.friction != Friction::Off {
        return Err(PyTypeError::new_err(
            "friction needs Young's modulus and Poisson's ratio of both bodies, and contact_modulus does not say them: bodies= is \
             missing; write bodies=(fc.Body(young, poisson), None) in the place of contact_modulus, None for a rigid body",
        ));
    }
    let default_outputs = outputs.is_none();
    if let Some(names) = outputs {
        scene.outputs = Outputs::default();
        for name in &names {
            scene.outputs.ask(output(name)?, true);
        }
    }
    scene.outputs.conductance = match conductance {
        None => Conductance::Off,
        Some((kind, RealNumber(first), RealNumber(second))) if kind == "electrical" => {
            Conductance::Electrical { first, second }
        }
        Some((kind, RealNumber(first), RealNumber(second))) if kind == "thermal" => {
            Conductance::Thermal { first, second }
        }
        Some((kind, ..)) => {
            return Err(PyValueError::new_err(format!(
                "no conductance is called {kind:?}: there are electrical and thermal"
            )));
        }
    };
    scene.validate().map_err(|error| of_model(py, error))?;
    Ok(PyScene { scene, default_outputs })
}

/// Errors for effects whose numbers or words make no sense.
#[pyfunction]
pub fn check_effects(py: Python<'_>, of: &Bound<'_, PyDict>) -> PyResult<()> {
    effects(py, of).map(drop)
}

/// Effects of the values of the Python class, which are those of `[effects]` in a scene.
fn effects(py: Python<'_>, of: &Bound<'_, PyDict>) -> PyResult<Effects> {
    let effects = parse_effects(&toml_text(of, "effects")?).map_err(|error| of_values(py, &error))?;
    effects.validate().map_err(|error| of_model(py, error))?;
    Ok(effects)
}

/// The keys of `[effects]`.
#[pyfunction]
pub fn effect_keys(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |key: &EffectKey| {
        let row = PyDict::new(py);
        row.set_item("name", key.name)?;
        row.set_item("takes", key.takes)?;
        row.set_item("about", key.about)?;
        row.set_item("off", key.off)?;
        Ok(row)
    };
    EFFECT_KEYS.iter().map(row).collect()
}
