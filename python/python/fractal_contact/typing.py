"""Types of words and mappings that functions accept, for type checkers.

A mapping in a variable is checked if the variable is declared with one of these types:

>>> from fractal_contact.typing import EffectsDict
>>> effects: EffectsDict = {"hardness": 0.1}
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NotRequired, TypedDict

__all__ = [
    "Adhesion",
    "AdhesionDict",
    "Axis",
    "BodyDict",
    "Boundary",
    "BoundaryDict",
    "ConductanceDict",
    "CropDict",
    "Detrend",
    "Direction",
    "EffectsDict",
    "ElectricalDict",
    "Friction",
    "FrictionDict",
    "Hardness",
    "HardnessDict",
    "Heights",
    "Method",
    "Output",
    "PeriodicKernel",
    "PressOptions",
    "PronyDict",
    "ReadOptions",
    "Rheology",
    "StandardSolidDict",
    "SurfaceKind",
    "ThermalDict",
    "Undefined",
    "ViscousDict",
    "Waves",
]

Output = Literal[
    "stiffness",
    "stiffness_fixed_area",
    "area",
    "mean_gap",
    "pressure",
    "displacement",
    "gap",
    "plastic_depth",
    "contact_patches",
    "stick_area",
    "tangential_stiffness",
    "tangential_stiffness_stuck",
    "traction",
    "slip",
    "stick_slip",
]
SurfaceKind = Literal["self_affine", "sphere", "cone", "power_law", "flat_circle", "flat", "sine", "line"]
Method = Literal["auto", "iterative", "single_level"]
PeriodicKernel = Literal["cells", "waves"]
Heights = Literal["gaussian", "exponential"]
Undefined = Literal["error", "no_contact"]
Direction = Literal["radial", "x", "y"]
Axis = Literal["x", "y"]
Waves = Literal["waves", "rings"]


class BoundaryDict(TypedDict):
    """A boundary for each direction: `Effects.boundary`."""

    x: Literal["free", "periodic"]
    y: Literal["free", "periodic"]


Boundary = Literal["free", "periodic"] | BoundaryDict
Detrend = Literal["none", "mean", "plane", "quadric", "sphere", "cylinder"]


class HardnessDict(TypedDict):
    """Hardness."""

    pressure: float


class AdhesionDict(TypedDict):
    """Adhesion, of short range or with a range."""

    work: float
    range: NotRequired[float]
    law: NotRequired[Literal["exponential", "dugdale"]]


class FrictionDict(TypedDict):
    """Friction: a coefficient, a shear strength or both, and perhaps a limit of the traction."""

    coefficient: NotRequired[float]
    shear_strength: NotRequired[float]
    limit: NotRequired[float]
    coupling: NotRequired[Literal["none", "full"]]


class ViscousDict(TypedDict):
    """Rheology of a spring and a dashpot."""

    kind: Literal["kelvin_voigt", "maxwell"]
    viscosity: float


class StandardSolidDict(TypedDict):
    """Rheology of a standard solid."""

    kind: Literal["standard_solid"]
    weight: float
    time: float


class PronyDict(TypedDict):
    """Rheology of a Prony series."""

    kind: Literal["prony"]
    weights: Sequence[float]
    times: Sequence[float]


class BodyDict(TypedDict):
    """An elastic body."""

    young: float
    poisson: float


class LayerDict(TypedDict):
    """A layer on a base."""

    thickness: float
    young: float
    poisson: float
    base: BodyDict | Literal["rigid", "slipping"]


Hardness = float | HardnessDict
Adhesion = float | AdhesionDict
Friction = float | FrictionDict
Rheology = ViscousDict | StandardSolidDict | PronyDict
Layer = LayerDict


class EffectsDict(TypedDict, total=False):
    """Effects of a scene."""

    boundary: Boundary | None
    hardness: Hardness | None
    adhesion: Adhesion | None
    friction: Friction | None
    rheology: Rheology | None
    layer: Layer | None


class ElectricalDict(TypedDict):
    """Electrical conductance, with the resistivities of both bodies."""

    kind: Literal["electrical"]
    resistivities: Sequence[float]


class ThermalDict(TypedDict):
    """Thermal conductance, with the conductivities of both bodies."""

    kind: Literal["thermal"]
    conductivities: Sequence[float]


ConductanceDict = ElectricalDict | ThermalDict


class CropDict(TypedDict):
    """The part of a map: ``cells`` stands for as many rows as columns."""

    row: NotRequired[int]
    column: NotRequired[int]
    rows: NotRequired[int]
    columns: NotRequired[int]
    cells: NotRequired[int]


class PressOptions(TypedDict, total=False):
    """Options of `press` that say how a map is read and prepared: keys of ``[scene.surface]`` in a scene."""

    channel: int | str
    format: str
    lateral_unit: str
    height_scale: str
    decimal: str
    axes: Literal["xy", "yx"]
    border: Literal["axes", "heights"]
    missing: float
    skip_lines: int
    crop: str | CropDict
    align_lines: Literal["median_difference", "median"]
    scars: float
    outliers: float
    tip_radius: str
    undefined: Literal["no_contact"]
    fill: str
    filter_across: str
    cells: int
    rows: int
    mirror: Axis
    rotate: Literal[0, 90, 180, 270]
    window: Literal["hann"]


class ReadOptions(PressOptions, total=False):
    """Options of `read_surface`: the keys of ``[scene.surface]`` in a scene."""

    unit: str
    size: str | Sequence[str]
    cell: str | Sequence[str]
    detrend: Detrend
