"""Normal contact of elastic bodies with rough surfaces, each result with its error.

>>> import numpy as np
>>> import fractal_contact as fc
>>> rough = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01).height_map(65, seed=1)
>>> scene = fc.Scene(rough, contact_modulus=1.0, outputs=["stiffness", "pressure"])
>>> contact = fc.Bem3d(tolerance=1e-8).prepare(scene)
>>> state = contact.solve(force=0.001)
>>> state.pressure.shape
(65, 65)
>>> bool(np.isclose(state.pressure.sum() / 65**2, 0.001))
True

Arrays are ``[row, column]``: columns along x, rows along y. Lengths, forces and moduli are in consistent units of your
choice; files have metres and pascals. Names have the same meaning as in Rust and in scene files.
"""

from . import _formulas, statistics, surface_gen, typing
from ._core import (
    VERSION as __version__,
)
from ._core import (
    Certificate,
    Contact,
    ContactState,
    HeightMap,
    Normalisation,
    SceneFile,
    set_threads,
    threads,
)
from ._effects import Effects
from ._errors import (
    DomainError,
    Error,
    NotConverged,
    OutOfMemory,
    OutOfRange,
    ReadError,
    SceneError,
    ShapeError,
    Stopped,
    Unsupported,
)
from ._files import ReadSurface, SceneOutcome, channels, read_surface, run_scene, si, write_surface
from ._formulas import *  # noqa: F403
from ._inputs import Body, Scene, Surface
from ._interface import (
    FilmConductance,
    LargestVonMises,
    Leakage,
    Percolation,
    film_conductance,
    largest_von_mises,
    leakage,
    percolation,
    stress_below,
    von_mises,
)
from ._models import (
    Bem3d,
    Equivalent,
    Formula,
    GreenwoodWilliamson,
    Mdr1d,
    Model,
    Persson,
    combinations,
    ensemble,
    follow,
    models,
    quantities,
    sweep,
    table,
)
from ._press import Pressed, press

__all__ = [
    "Bem3d",
    "Body",
    "Certificate",
    "Contact",
    "ContactState",
    "DomainError",
    "Effects",
    "Equivalent",
    "Error",
    "FilmConductance",
    "Formula",
    "GreenwoodWilliamson",
    "HeightMap",
    "LargestVonMises",
    "Leakage",
    "Mdr1d",
    "Model",
    "Normalisation",
    "NotConverged",
    "OutOfMemory",
    "OutOfRange",
    "Percolation",
    "Persson",
    "Pressed",
    "ReadError",
    "ReadSurface",
    "Scene",
    "SceneError",
    "SceneFile",
    "SceneOutcome",
    "ShapeError",
    "Stopped",
    "Surface",
    "Unsupported",
    "__version__",
    "channels",
    "combinations",
    "ensemble",
    "film_conductance",
    "follow",
    "largest_von_mises",
    "leakage",
    "models",
    "percolation",
    "press",
    "quantities",
    "read_surface",
    "run_scene",
    "set_threads",
    "si",
    "statistics",
    "stress_below",
    "surface_gen",
    "sweep",
    "table",
    "threads",
    "typing",
    "von_mises",
    "write_surface",
]
__all__ += _formulas.__all__
