//! Surfaces from files.

use crate::errors::{of_surface, plain};
use crate::height_map::PyHeightMap;
use crate::pool;
use crate::scene::optional;
use fractal_contact::scenes;
use fractal_contact::surface_io::{
    Decimal, Detrend, Dimension, Error, Metadata, Metric, Preprocessing, Quantity, ReadOptions, Scan,
    SurfaceFile, Undefined,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

/// A word of the program's options.
fn word<T: FromStr>(of: &Bound<'_, PyDict>, name: &str) -> PyResult<Option<T>>
where
    T::Err: Display,
{
    let Some(value) = of.get_item(name)?.filter(|value| !value.is_none()) else { return Ok(None) };
    let text = value.str()?.to_string();
    text.parse()
        .map(Some)
        .map_err(|error: T::Err| PyValueError::new_err(format!("{name} = {text:?}: {error}")))
}

fn options(of: &Bound<'_, PyDict>) -> PyResult<(ReadOptions, Preprocessing)> {
    const KNOWN: &str = "format, channel, unit, lateral_unit, size, cell, height_scale, decimal, axes, border, missing, \
                         skip_lines, crop, align_lines, scars, outliers, tip_radius, undefined, fill, detrend, filter_across, \
                         cells, rows, mirror, rotate, window";
    for key in of.keys() {
        let key: String = key.extract()?;
        if KNOWN.split(", ").all(|known| known != key) {
            return Err(PyTypeError::new_err(format!("no option is called {key:?}: there are {KNOWN}")));
        }
    }
    let declared = ReadOptions {
        format: word(of, "format")?,
        channel: word(of, "channel")?,
        unit: word(of, "unit")?,
        lateral_unit: word(of, "lateral_unit")?,
        size: word(of, "size")?,
        cell: word(of, "cell")?,
        height_scale: word(of, "height_scale")?,
        decimal: word::<Decimal>(of, "decimal")?.unwrap_or_default(),
        axes: word(of, "axes")?,
        border: word(of, "border")?,
        missing: optional(of, "missing")?,
        skip_lines: optional(of, "skip_lines")?.unwrap_or(0),
        ..ReadOptions::default()
    };
    let degrees: u16 = optional(of, "rotate")?.unwrap_or(0);
    if !degrees.is_multiple_of(90) || degrees > 270 {
        return Err(PyValueError::new_err(format!("rotate = {degrees}: expected 0, 90, 180 or 270")));
    }
    let preprocessing = Preprocessing {
        crop: word(of, "crop")?,
        align_lines: word(of, "align_lines")?,
        scars: optional(of, "scars")?,
        outliers: optional(of, "outliers")?,
        tip_radius: word(of, "tip_radius")?,
        undefined: word::<Undefined>(of, "undefined")?,
        fill: word(of, "fill")?,
        detrend: word::<Detrend>(of, "detrend")?.unwrap_or_default(),
        filter_across: word(of, "filter_across")?,
        cells: optional(of, "cells")?,
        rows: optional(of, "rows")?,
        mirror: word(of, "mirror")?,
        quarter_turns: (degrees / 90) as u8,
        window: word(of, "window")?,
    };
    Ok((declared, preprocessing))
}

/// What a file says of a channel.
fn metadata<'py>(py: Python<'py>, of: &Metadata) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let metric = of.unit.as_ref().is_some_and(|unit| unit.value.dimension() == Dimension::LENGTH);
    dict.set_item("format", of.format.to_string())?;
    dict.set_item("channel", of.number)?;
    dict.set_item("name", of.name.clone())?;
    dict.set_item("shape", (of.rows, of.columns))?;
    dict.set_item("size", of.size.map(|[x, y]| (x.value(), y.value())))?;
    dict.set_item("unit", if metric { Some("m") } else { None })?;
    dict.set_item("undefined", of.undefined)?;
    dict.set_item("notes", of.notes.clone())?;
    dict.set_item("text", of.to_string())?;
    Ok(dict)
}

/// Map, metadata, steps, and the distance from which on heights are reliable.
type ReadFile<'py> = (PyHeightMap, Bound<'py, PyDict>, Vec<String>, Option<f64>);

/// The file at a path, or the content of a file of this name.
fn opened<'a>(
    path: &Path,
    content: Option<&'a [u8]>,
    declared: &ReadOptions,
) -> Result<SurfaceFile<'a>, Error> {
    content.map_or_else(
        || SurfaceFile::open(path, declared),
        |content| SurfaceFile::from_bytes(path, content, declared),
    )
}

/// A surface of a file, or of its content: its map, what the file says, what was done to the map, from which distance
/// on the tip lets heights be seen.
#[pyfunction]
#[pyo3(signature = (path, options, content=None))]
pub fn read_surface<'py>(
    py: Python<'py>,
    path: PathBuf,
    options: &Bound<'py, PyDict>,
    content: Option<&[u8]>,
) -> PyResult<ReadFile<'py>> {
    let (declared, preprocessing) = self::options(options)?;
    let (file, content) = (path.clone(), content.map(<[u8]>::to_vec));
    let read = move || -> Result<_, Error> {
        let scan = opened(&file, content.as_deref(), &declared)?.scan()?;
        let found = scan.preprocessed(&preprocessing)?;
        Ok((scan.metadata().clone(), found))
    };
    let (described, found) = pool::call(py, read)?.map_err(|error| of_surface(py, &error))?;
    if described.profile {
        let reason = "a profile x, z stands for a body uniform along y, which a HeightMap is not: run_scene presses it (a map of two columns: \
                      format=\"text\")";
        return Err(plain(py, "ReadError", &format!("{}: {reason}", path.display())));
    }
    let map = PyHeightMap::with_holes(found.map, found.holes.as_ref());
    Ok((map, metadata(py, &described)?, found.steps, found.reliable_from))
}

/// Metadata of each channel of a file; of a channel that cannot be read beside others, `error`.
#[pyfunction]
#[pyo3(signature = (path, options, content=None))]
pub fn channels<'py>(
    py: Python<'py>,
    path: PathBuf,
    options: &Bound<'py, PyDict>,
    content: Option<&[u8]>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let (declared, _) = self::options(options)?;
    let content = content.map(<[u8]>::to_vec);
    let read = move || -> Result<Vec<Result<Metadata, String>>, Error> {
        let one = |scan: Result<Scan, Error>| match scan {
            Ok(scan) => Ok(Ok(scan.metadata().clone())),
            Err(error) if error.problem().is_some() => Ok(Err(error.to_string())),
            Err(error) => Err(error),
        };
        opened(&path, content.as_deref(), &declared)?.scans().map(one).collect()
    };
    let found = pool::call(py, read)?.map_err(|error| of_surface(py, &error))?;
    let one = |of: &Result<Metadata, String>| match of {
        Ok(of) => metadata(py, of),
        Err(error) => {
            let dict = PyDict::new(py);
            dict.set_item("error", error)?;
            Ok(dict)
        }
    };
    found.iter().map(one).collect()
}

/// A text with a unit in SI units.
#[pyfunction]
pub fn si(text: &str) -> PyResult<f64> {
    let quantity: Result<Quantity, _> = text.parse();
    quantity.map(Quantity::value).map_err(|error| PyValueError::new_err(format!("{text:?}: {error}")))
}

/// Writes a map by the ending of the file's name; lengths are in metres, or without a unit.
#[pyfunction]
pub fn write_surface(py: Python<'_>, path: PathBuf, map: &PyHeightMap, metres: bool) -> PyResult<()> {
    let metric = if metres { Metric::Metres } else { Metric::Unitless };
    let map = Arc::clone(&map.map);
    pool::call(py, move || scenes::write_map(&path, &map, metric))?.map_err(|error| of_surface(py, &error))
}
