//! Generated maps.

use crate::errors::of_model;
use crate::height_map::PyHeightMap;
use crate::memory;
use crate::numbers::{OneOrTwo, RealNumber, Seed};
use crate::pool;
use crate::scene::PySurface;
use fractal_contact::scenes::{RandomSpectrum, RandomSurface};
use fractal_contact::surface_gen::{self, Anisotropy, HeightDistribution, TwinSpectrum};
use fractal_contact::{Cells, HeightMap as RustMap, Result, Size, Surface as RustSurface};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::Arc;

/// Columns, with nearly square cells, or columns and rows.
pub fn cells(given: OneOrTwo<usize>, size: Size) -> Cells {
    match given {
        OneOrTwo::One(columns) => Cells::nearly_square(columns, size),
        OneOrTwo::Two([columns, rows]) => Cells { columns, rows },
    }
}

fn drawn(py: Python<'_>, random: RandomSurface, cells: Cells, seed: u64) -> PyResult<PyHeightMap> {
    memory::check_grid(py, "a map", cells, random.memory(cells))?;
    let map: Result<RustMap> = pool::call(py, move || random.map(cells, seed))?;
    map.map(PyHeightMap::from).map_err(|error| of_model(py, error))
}

/// Seed of surface number `index` of the ensemble of a master seed.
#[pyfunction]
pub fn surface_seed(seed: Seed, index: Seed) -> u64 {
    surface_gen::surface_seed(seed.0, index.0)
}

/// A self-affine map: isotropic, with a lay, with a distribution of heights.
#[pyfunction]
#[pyo3(signature = (surface, cells, seed, anisotropy, weibull))]
pub fn self_affine_map(
    py: Python<'_>,
    surface: &PySurface,
    cells: OneOrTwo<usize>,
    seed: Seed,
    anisotropy: Option<(RealNumber, RealNumber)>,
    weibull: Option<RealNumber>,
) -> PyResult<PyHeightMap> {
    let RustSurface::SelfAffine(described) = &surface.0 else {
        return Err(PyTypeError::new_err("the surface is not self-affine"));
    };
    let spectrum = RandomSpectrum::SelfAffine {
        surface: *described,
        anisotropy: anisotropy.map(|(RealNumber(ratio), RealNumber(lay))| Anisotropy { ratio, lay }),
    };
    let heights = weibull.map(|RealNumber(shape)| HeightDistribution::Weibull { shape });
    let random = RandomSurface::new(spectrum, heights);
    let cells = self::cells(cells, random.size());
    drawn(py, random, cells, seed.0)
}

/// An artificial twin of a map.
#[pyfunction]
#[pyo3(signature = (map, seed, rings, keep_heights))]
pub fn twin(
    py: Python<'_>,
    map: &PyHeightMap,
    seed: Seed,
    rings: bool,
    keep_heights: bool,
) -> PyResult<PyHeightMap> {
    let of = Arc::clone(&map.map);
    let (cells, like) = (of.cells(), if rings { TwinSpectrum::Rings } else { TwinSpectrum::EachWave });
    let heights = keep_heights.then(|| HeightDistribution::Of(Arc::clone(&of)));
    let random = RandomSurface::new(RandomSpectrum::Twin { of, like }, heights);
    drawn(py, random, cells, seed.0)
}
