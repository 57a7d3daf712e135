//! The Python package `fractal_contact`: classes and functions of the Rust crates, without logic of their
//! own.
//!
//! What a user sees is in `fractal_contact/*.py`, which call this module `_core`.

#![allow(clippy::needless_pass_by_value)] // Arguments of Python functions come as values.
#![allow(clippy::unnecessary_wraps)]
#![allow(clippy::format_push_string)]
#![allow(missing_debug_implementations)] // Python prints its objects by their `__repr__`.

mod contact;
mod ensemble;
mod errors;
mod exclusive;
mod height_map;
mod interface;
mod io;
mod load_order;
mod loads;
mod memory;
mod model;
mod notes;
mod numbers;
mod picture;
mod pool;
mod quantities;
mod scene;
mod scenes;
mod state;
mod statistics;
mod surface_gen;
mod toml_text;

/// The compiled part of `fractal_contact`.
#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::state::look_up_arrays(module.py())?;
        crate::quantities::make_properties(module.py())
    }

    #[pymodule_export]
    use crate::contact::{PyContact, PyNormalisation};
    #[pymodule_export]
    use crate::ensemble::ensemble;
    #[pymodule_export]
    use crate::height_map::PyHeightMap;
    #[pymodule_export]
    use crate::interface::{
        film_conductance, flow_rate, largest_von_mises, leakage, percolation, stress_at_depths,
        stress_at_points, von_mises,
    };
    #[pymodule_export]
    use crate::io::{channels, read_surface, si, write_surface};
    #[pymodule_export]
    use crate::model::{PyModel, combinations, model, models};
    #[pymodule_export]
    use crate::notes::notes_of_python;
    #[pymodule_export]
    use crate::picture::picture;
    #[pymodule_export]
    use crate::pool::{set_threads, threads};
    #[pymodule_export]
    use crate::quantities::{fields, quantities};
    #[pymodule_export]
    use crate::scene::{PyScene, PySurface, check_effects, effect_keys, height_map, scene, surface};
    #[pymodule_export]
    use crate::scenes::{PySceneFile, check_pressed_map, press_scene, run_scene};
    #[pymodule_export]
    use crate::state::{PyCertificate, PyContactState};
    #[pymodule_export]
    use crate::statistics::{fit_spectrum, height_difference, parameters, power_spectrum, scale_dependence};
    #[pymodule_export]
    use crate::surface_gen::{self_affine_map, surface_seed, twin};

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
