//! Statistics of a map.

use crate::errors::of_model;
use crate::height_map::PyHeightMap;
use crate::memory;
use crate::numbers::RealNumber;
use crate::pool;
use fractal_contact::surface_statistics::{
    Bins, Derivatives, DifferenceBands, DifferenceMap, FeatureParameters, FilledPoints, FunctionalParameters,
    HeightParameters, HybridParameters, Interval, PowerSpectrum, ReliableWavelengths, ScaleDependence,
    SpatialParameters, SpectrumFit, Taper, Wavelength, nayak_parameter, texture_direction,
};
use fractal_contact::{Boundary, Error, Result, surface_io};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::f64::consts::TAU;
use std::sync::Arc;

fn boundary(periodic: bool) -> Boundary {
    if periodic { Boundary::Periodic } else { Boundary::Free }
}

/// Bytes for each point of a map: of a spectrum, and of height differences with periodic and with free
/// boundaries.
const SPECTRUM: f64 = 24.0;
const DIFFERENCES: [f64; 2] = [100.0, 400.0];

/// `MemoryError` where there is less than so many bytes for each point of a map.
fn check_memory(py: Python<'_>, map: &PyHeightMap, bytes: f64) -> PyResult<()> {
    let cells = map.map.cells();
    memory::check_grid(py, "the statistics of a map", cells, cells.map_bytes() / 8.0 * bytes)
}

fn known<T>(py: Python<'_>, result: PyResult<Result<T, Error>>) -> PyResult<T> {
    result?.map_err(|error| of_model(py, error))
}

fn arrays(dict: &Bound<'_, PyDict>, of: &[(&str, Vec<f64>)]) -> PyResult<()> {
    for (name, values) in of {
        dict.set_item(*name, PyArray1::from_slice(dict.py(), values))?;
    }
    Ok(())
}

/// Parameters of ISO 25178-2 and of the derivatives; None where the map does not define one.
#[pyfunction]
pub fn parameters<'py>(py: Python<'py>, map: &PyHeightMap, periodic: bool) -> PyResult<Bound<'py, PyDict>> {
    check_memory(py, map, DIFFERENCES[1])?;
    let of = Arc::clone(&map.map);
    let found = pool::call(py, move || -> Result<Vec<(&'static str, Option<f64>)>> {
        let (of, mut all) = (&*of, Vec::new());
        let h = HeightParameters::new(of)?;
        for (name, value) in [
            ("Sa", h.sa),
            ("Sq", h.sq),
            ("Ssk", h.ssk),
            ("Sku", h.sku),
            ("Sp", h.sp),
            ("Sv", h.sv),
            ("Sz", h.sz),
        ] {
            all.push((name, Some(value)));
        }
        let hybrid = HybridParameters::new(of).ok();
        all.push(("Sdq", hybrid.as_ref().map(|h| h.sdq)));
        all.push(("Sdr", hybrid.as_ref().map(|h| h.sdr)));
        let functional = FunctionalParameters::new(of).ok();
        all.push(("Sk", functional.as_ref().map(|f| f.sk)));
        all.push(("Spk", functional.as_ref().map(|f| f.spk)));
        all.push(("Svk", functional.as_ref().map(|f| f.svk)));
        let spatial = SpatialParameters::new(of).ok();
        all.push(("Sal", spatial.as_ref().and_then(|s| s.sal)));
        all.push(("Str", spatial.as_ref().and_then(|s| s.str)));
        all.push(("Std", texture_direction(of).ok()));
        let features = FeatureParameters::new(of).ok();
        all.push(("Spd", features.as_ref().map(|f| f.spd)));
        all.push(("Spc", features.as_ref().and_then(|f| f.spc)));
        let derivatives = Derivatives::new(of, boundary(periodic)).ok();
        all.push(("rms_gradient", derivatives.as_ref().map(|d| d.rms_gradient)));
        all.push(("rms_curvature", derivatives.as_ref().map(|d| d.rms_curvature)));
        let moments = fractal_contact::surface_gen::MapStatistics::new(of).ok();
        all.push(("nayak", moments.as_ref().map(nayak_parameter).filter(|alpha| alpha.is_finite())));
        let energy = periodic.then(|| fractal_contact::surface_gen::full_contact_energy(of).ok()).flatten();
        all.push(("full_contact_energy", energy));
        Ok(all)
    });
    let dict = PyDict::new(py);
    for (name, value) in known(py, found)? {
        dict.set_item(name, value)?;
    }
    Ok(dict)
}

/// A power spectral density with its band.
#[pyfunction]
pub fn power_spectrum<'py>(
    py: Python<'py>,
    map: &PyHeightMap,
    direction: &str,
    periodic: bool,
    per_decade: RealNumber,
    level: RealNumber,
) -> PyResult<Bound<'py, PyDict>> {
    check_memory(py, map, SPECTRUM)?;
    let (of, taper) = (Arc::clone(&map.map), if periodic { Taper::None } else { Taper::Hann });
    let found = match direction {
        "radial" => pool::call(py, move || {
            PowerSpectrum::radial(&of, taper, &Bins::of_wavenumbers(&of, per_decade.0)?)
        }),
        "x" => pool::call(py, move || PowerSpectrum::along_x(&of, taper)),
        "y" => pool::call(py, move || PowerSpectrum::along_y(&of, taper)),
        other => {
            return Err(PyValueError::new_err(format!(
                "direction is {other:?}: expected \"radial\", \"x\" or \"y\""
            )));
        }
    };
    let found = known(py, found)?;
    let (low, high) = known(py, Ok(found.band(level.0)))?.into_iter().map(|[low, high]| (low, high)).unzip();
    let dict = PyDict::new(py);
    arrays(
        &dict,
        &[
            ("wavenumber", found.wavenumber),
            ("density", found.density),
            ("low", low),
            ("high", high),
            ("degrees_of_freedom", found.degrees_of_freedom),
        ],
    )?;
    Ok(dict)
}

/// The limits of a band, NaN where there are none.
fn limits(bands: Option<Vec<Option<[f64; 2]>>>, count: usize) -> (Vec<f64>, Vec<f64>) {
    let nan = (f64::NAN, f64::NAN);
    let one = |band: Option<[f64; 2]>| band.map_or(nan, |[low, high]| (low, high));
    bands.unwrap_or_else(|| vec![None; count]).into_iter().map(one).unzip()
}

/// Half the mean square height difference over distances, with its band.
#[pyfunction]
pub fn height_difference<'py>(
    py: Python<'py>,
    map: &PyHeightMap,
    periodic: bool,
    per_decade: RealNumber,
    level: RealNumber,
) -> PyResult<Bound<'py, PyDict>> {
    check_memory(py, map, DIFFERENCES[usize::from(!periodic)])?;
    let of = Arc::clone(&map.map);
    let found = pool::call(py, move || -> Result<_> {
        let of = &*of;
        let found =
            DifferenceMap::new(of, boundary(periodic)).radial(&Bins::of_distances(of, per_decade.0)?)?;
        let bands = DifferenceBands::new(of, boundary(periodic)).ok();
        let bands = bands.map(|bands| bands.of_differences(&found, level.0)).transpose()?;
        Ok((found, bands))
    });
    let (found, bands) = known(py, found)?;
    let (low, high) = limits(bands, found.distance.len());
    let dict = PyDict::new(py);
    arrays(
        &dict,
        &[
            ("distance", found.distance),
            ("half_square", found.half_square),
            ("low", low),
            ("high", high),
            ("pairs", found.pairs),
        ],
    )?;
    Ok(dict)
}

/// Rms slope or curvature over distances along an axis, with its band.
#[pyfunction]
pub fn scale_dependence<'py>(
    py: Python<'py>,
    map: &PyHeightMap,
    of_curvature: bool,
    along_y: bool,
    periodic: bool,
    level: RealNumber,
) -> PyResult<Bound<'py, PyDict>> {
    check_memory(py, map, SPECTRUM)?;
    let (of, boundary, axis) = (Arc::clone(&map.map), boundary(periodic), usize::from(along_y));
    let found = pool::call(py, move || -> Result<_> {
        let of = &*of;
        let bands = DifferenceBands::new(of, boundary).ok();
        let (found, bands) = if of_curvature {
            let along = [ScaleDependence::curvature_along_x, ScaleDependence::curvature_along_y][axis];
            let found = along(of, boundary)?;
            let bands = bands.map(|bands| bands.of_curvatures(&found, axis, level.0)).transpose()?;
            (found, bands)
        } else {
            let along = [ScaleDependence::slope_along_x, ScaleDependence::slope_along_y][axis];
            let found = along(of, boundary)?;
            let bands = bands.map(|bands| bands.of_slopes(&found, axis, level.0)).transpose()?;
            (found, bands)
        };
        Ok((found, bands))
    });
    let (found, bands) = known(py, found)?;
    let (low, high) = limits(bands, found.distance.len());
    let dict = PyDict::new(py);
    arrays(&dict, &[("distance", found.distance), ("rms", found.rms), ("low", low), ("high", high)])?;
    Ok(dict)
}

/// Probability of a worse fit below which a fit means nothing.
const DOUBTFUL: f64 = 0.01;

/// What has to be known beside the numbers of a fit.
fn notes_on(fit: &SpectrumFit, points: &FilledPoints) -> Vec<String> {
    let (mut notes, filled) = (Vec::new(), points.count());
    if filled > 0 {
        let (all, shortest) = (points.of_all(), TAU / fit.fitted[1]);
        notes.push(format!(
            "{filled} of {all} points have heights between those of their neighbours. The fit takes into account which waves are missing \
             there, and ends at a wavelength of {shortest:.4e}."
        ));
    }
    if fit.goodness < DOUBTFUL {
        let remedy = if filled > 0 {
            "Points that were filled change short waves: crop=\"defined\" of fc.read_surface uses a part of the map without them."
        } else {
            "Heights that were filled or smoothed before are a common reason: a map with undefined points in their place \
             (undefined=\"no_contact\", or a masked array) has a fit that takes them into account. Another one is a lay."
        };
        notes.push(format!(
            "The spectrum is not that of an isotropic self-affine surface: a Gaussian one fits worse with a probability of only {:.0e}. \
             The exponent and both wavelengths have no meaning. {remedy}",
            fit.goodness
        ));
    } else if fit.hurst.low > 1.0 || fit.hurst.high < 0.0 {
        notes.push(format!(
            "The exponent {:.2} is not between 0 and 1: the surface is not self-affine between the wavelengths of the fit.",
            fit.hurst.value
        ));
    }
    notes
}

/// The fit of a self-affine spectrum: each quantity as (value, low, high), None where there is only a bound.
#[pyfunction]
#[pyo3(signature = (map, periodic, instrument))]
pub fn fit_spectrum<'py>(
    py: Python<'py>,
    map: &PyHeightMap,
    periodic: bool,
    instrument: Option<RealNumber>,
) -> PyResult<Bound<'py, PyDict>> {
    check_memory(py, map, SPECTRUM)?;
    let (map, boundary) = (map.clone(), boundary(periodic));
    let instrument = instrument.map(|RealNumber(wavelength)| wavelength);
    let found = pool::call(py, move || {
        let points = FilledPoints::new(map.holes().as_ref().unwrap_or(&map.map));
        let reliable = ReliableWavelengths::new(&map.map, boundary, instrument)?;
        let whole = surface_io::filled(&map.map)?;
        SpectrumFit::of_filled(&whole, &points, &reliable.fit_options(boundary)).map(|fit| (fit, points))
    });
    let (fit, points) = known(py, found)?;
    let interval = |of: &Interval| (Some(of.value), Some(of.low), Some(of.high));
    let wavelength = |of: &Wavelength| match of {
        Wavelength::Interval(of) => interval(of),
        Wavelength::AtLeast(bound) => (None, Some(*bound), None),
        Wavelength::AtMost(bound) => (None, None, Some(*bound)),
        _ => (None, None, None),
    };
    let dict = PyDict::new(py);
    dict.set_item("hurst", interval(&fit.hurst))?;
    dict.set_item("roll_off", wavelength(&fit.roll_off))?;
    dict.set_item("cut_off", wavelength(&fit.cut_off))?;
    dict.set_item("goodness", fit.goodness)?;
    dict.set_item("fitted", (fit.fitted[0], fit.fitted[1]))?;
    dict.set_item("filled", points.count())?;
    dict.set_item("notes", notes_on(&fit, &points))?;
    Ok(dict)
}
