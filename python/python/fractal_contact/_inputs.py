"""The parts of a contact problem (surfaces, effects, bodies, scenes), as plain values to compare, copy and pickle."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _numbers
from ._core import HeightMap, SceneFile
from ._effects import Effects
from ._errors import domain_error
from ._numbers import Seed, number
from ._plain import frozen, named, pair, same_fields
from .typing import BodyDict, ConductanceDict, EffectsDict, Output, SurfaceKind

Size = float | Sequence[float] | NDArray[np.float64]
Cells = int | Sequence[int] | NDArray[np.integer[Any]]
Conductance = tuple[str, float, float]


@dataclass(frozen=True)
class Surface:
    """A surface that is no height map; one of the methods below makes it.

    Axisymmetric bodies are at the centre of the rectangle, apex up. Lengths are in one unit of your choice.

    Parameters
    ----------
    kind : {"self_affine", "sphere", "cone", "power_law", "flat_circle", "flat", "sine", "line"}
        Its kind, the name of the method that makes it.
    parameters : mapping
        What that method takes, by name. The surface keeps a copy that does not change.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> fc.Surface.sphere(radius=1.0, size=2.0)
    Surface.sphere(radius=1.0, size=2.0)
    """

    kind: SurfaceKind
    parameters: Mapping[str, Any]

    def __post_init__(self) -> None:
        # A copy that does not change, with sizes that compare.
        parameters = {name: pair(value) if name == "size" else value for name, value in self.parameters.items()}
        object.__setattr__(self, "parameters", frozen(parameters))
        self._core()

    def _core(self) -> _core.Surface:
        values = dict(self.parameters)
        if self.kind == "line":
            values["heights"] = np.asarray(values["heights"], dtype=np.float64)
        return _core.surface(self.kind, values)

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items() if value is not None)
        return f"Surface.{self.kind}({values})"

    @classmethod
    def self_affine(
        cls,
        *,
        size: Size,
        rms_height: float,
        hurst: float | None = None,
        fractal_dimension: float | None = None,
        roll_off_wavelength: float | None = None,
        shortest_wavelength: float | None = None,
    ) -> Surface:
        """Random self-affine surface, drawn from a seed.

        Parameters
        ----------
        size : float or (float, float)
            Side of a square or sides (Lx, Ly).
        rms_height : float
            Rms height of the samples, exactly (length > 0).
        hurst, fractal_dimension : float
            One of them: Hurst exponent H in [0, 1], or fractal dimension D_f = 3 - H in [2, 3].
        roll_off_wavelength, shortest_wavelength : float, optional
            The spectrum is constant for waves longer than the first and has no waves shorter than the second. By
            default there is no roll-off, and the shortest waves are those of the grid.
        """
        if (hurst is None) == (fractal_dimension is None):
            raise TypeError("give one of hurst and fractal_dimension")
        if hurst is None:
            assert fractal_dimension is not None
            hurst = 3.0 - fractal_dimension
        return cls(
            "self_affine",
            {
                "hurst": hurst,
                "rms_height": rms_height,
                "size": size,
                "roll_off_wavelength": roll_off_wavelength,
                "shortest_wavelength": shortest_wavelength,
            },
        )

    @classmethod
    def sphere(cls, *, radius: float, size: Size) -> Surface:
        """Paraboloid r^2/(2 radius): Hertz's sphere.

        Parameters
        ----------
        radius : float
            Radius of the sphere (length > 0).
        size : float or (float, float)
            Side of a square or sides (Lx, Ly).
        """
        return cls("sphere", {"radius": radius, "size": size})

    @classmethod
    def cone(cls, *, slope: float, size: Size) -> Surface:
        """Cone of depth slope * r.

        Parameters
        ----------
        slope : float
            Slope of its side, > 0, dimensionless.
        size : float or (float, float)
            Side of a square or sides (Lx, Ly).
        """
        return cls("cone", {"slope": slope, "size": size})

    @classmethod
    def power_law(
        cls,
        *,
        exponent: float,
        size: Size,
        coefficient: float | None = None,
        depth: float | None = None,
        radius: float | None = None,
    ) -> Surface:
        """Body of depth coefficient * r^exponent.

        Parameters
        ----------
        exponent : float
            The exponent, > 0.
        size : float or (float, float)
            Side of a square or sides (Lx, Ly).
        coefficient : float, optional
            The coefficient (length^(1 - exponent), > 0).
        depth, radius : float, optional
            In place of the coefficient: the depth at a radius (lengths > 0).
        """
        if (coefficient is None) == (depth is None) or (depth is None) != (radius is None):
            raise TypeError("give coefficient, or depth and radius")
        if coefficient is None:
            assert depth is not None and radius is not None
            coefficient = number(depth, "depth") / number(radius, "radius") ** number(exponent, "exponent")
        return cls("power_law", {"coefficient": coefficient, "exponent": exponent, "size": size})

    @classmethod
    def flat_circle(cls, *, radius: float, size: Size) -> Surface:
        """Flat circular punch.

        Parameters
        ----------
        radius : float
            Radius of the punch (length > 0).
        size : float or (float, float)
            Side of a square or sides (Lx, Ly).
        """
        return cls("flat_circle", {"radius": radius, "size": size})

    @classmethod
    def flat(cls, *, size: Size) -> Surface:
        """Flat rectangle: all of it touches at once.

        Parameters
        ----------
        size : float or (float, float)
            Side of a square or sides (Lx, Ly).
        """
        return cls("flat", {"size": size})

    @classmethod
    def sine(cls, *, amplitude: float, wavelength: float, size: Size) -> Surface:
        """Waves amplitude * cos(2 pi x/wavelength) along x.

        Parameters
        ----------
        amplitude : float
            Half the height from trough to crest (length > 0).
        wavelength : float
            Distance of two crests (length > 0).
        size : float or (float, float)
            Side of a square or sides (Lx, Ly).
        """
        return cls("sine", {"amplitude": amplitude, "wavelength": wavelength, "size": size})

    @classmethod
    def line(cls, heights: ArrayLike, *, length: float, size: Size) -> Surface:
        """Line with these heights of its elements, for `Mdr1d`; it represents a rectangle.

        Parameters
        ----------
        heights : array_like
            Heights of the elements, shape (elements,).
        length : float
            Length of the line (> 0).
        size : float or (float, float)
            Side of a square or sides (Lx, Ly) of the rectangle.
        """
        values = np.asarray(heights, dtype=np.float64)
        if values.ndim != 1:
            raise ValueError(f"heights of a line have {values.ndim} dimensions: expected 1")
        return cls("line", {"heights": tuple(values.tolist()), "length": length, "size": size})

    def height_map(self, cells: Cells, seed: Seed = 0) -> HeightMap:
        """The height of each cell.

        Parameters
        ----------
        cells : int or (int, int)
            Columns, with as many rows as make the cells nearly square, or columns and rows.
        seed : int or numpy.random.Generator
            Seed of a random surface. Of a generator a number from 0 to 2^64 - 1, one draw of ``integers``: the next
            call then draws another surface.

        Returns
        -------
        HeightMap
            The heights on a rectangle of the size of the surface.

        Raises
        ------
        OutOfMemory
            For a map that does not fit in memory, before it is drawn.
        """
        return _core.height_map(self._core(), _numbers.cells(cells), _numbers.seed(seed))


@dataclass(frozen=True)
class Body:
    """An isotropic and linearly elastic body.

    Parameters
    ----------
    young : float
        Young's modulus.
    poisson : float
        Poisson's ratio in [0, 1/2].
    """

    young: float
    poisson: float

    def __post_init__(self) -> None:
        # Mistakes are told where they are made.
        young, poisson = number(self.young, "young"), number(self.poisson, "poisson")
        if not 0 < young < math.inf:
            raise domain_error("young", young, "a finite number > 0")
        if not 0 <= poisson <= 0.5:
            raise domain_error("poisson", poisson, "a number in [0, 0.5]")
        object.__setattr__(self, "young", young)
        object.__setattr__(self, "poisson", poisson)


AnyBody = Body | BodyDict | Literal["rigid"] | None


def _body(body: AnyBody, name: str) -> Body | None:
    if body is None or isinstance(body, Body):
        return body
    if isinstance(body, str) and body == "rigid":
        return None
    if isinstance(body, Mapping):
        values = named(body, "number of a body", ["young", "poisson"])
        if len(values) == 2:
            return Body(**values)
    raise TypeError(f'{name} is {body!r}: expected fc.Body(young, poisson), or "rigid" or None for a rigid one')


def _both(bodies: Any) -> tuple[Body | None, Body | None]:
    if not isinstance(bodies, Sequence) or isinstance(bodies, str) or len(bodies) != 2:
        raise TypeError(f"bodies is {bodies!r}: expected two of them")
    return _body(bodies[0], "bodies[0]"), _body(bodies[1], "bodies[1]")


def _conductance(given: Any) -> Conductance:
    values_of = {"electrical": "resistivities", "thermal": "conductivities"}
    if isinstance(given, Mapping):
        known = named(given, "key of a conductance", ["kind", *values_of.values()])
        kind = known.pop("kind", None)
        if kind in values_of and list(known) == [values_of[kind]]:
            given = (kind, *pair(known[values_of[kind]]))
    if not isinstance(given, tuple | list) or len(given) != 3:
        raise TypeError(
            f"conductance is {given!r}: expected {{'kind': 'electrical', 'resistivities': (first, second)}} or "
            "{'kind': 'thermal', 'conductivities': (first, second)}"
        )
    kind, first, second = given
    if kind not in values_of:
        raise ValueError(f"no conductance is called {kind!r}: there are electrical and thermal")
    return kind, number(first, f"conductance, {values_of[kind]}"), number(second, f"conductance, {values_of[kind]}")


@dataclass(frozen=True)
class Scene:
    """Everything physical about one contact problem. Numerics are options of a model; chance is the seed.

    Parameters
    ----------
    surface : HeightMap or Surface
        The surface in contact.
    contact_modulus : float, optional
        Contact modulus E*, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.
    bodies : pair of Body, mapping, "rigid" or None, optional
        Both bodies in place of ``contact_modulus``, None or "rigid" for a rigid one: needed where E* alone is not
        sufficient (friction).
    effects : Effects or mapping
        Effects beyond elastic contact; each is off unless it is named.
    outputs : iterable of str, optional
        What is computed besides force and approach, such as "stiffness", "area" and "pressure": names of
        ``Bem3d().supports["outputs"]``, and of those of the model. "mean_gap" is for periodic boundaries,
        "plastic_depth" for a hardness, "traction", "slip", "stick_slip", "stick_area" and tangential stiffnesses for
        friction. The default is the stiffness, for models that have it.
    conductance : mapping or (str, float, float), optional
        {"kind": "electrical", "resistivities": (of the first, of the second)} or {"kind": "thermal",
        "conductivities": (...)}, or kind and both values as a tuple.
    modulus : float, optional
        The former name of ``contact_modulus``, which is read with a warning.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> scene = fc.Scene(fc.Surface.sphere(radius=1.0, size=2.0), contact_modulus=1.0)
    >>> state = fc.Hertz().prepare(scene).solve(force=4 / 3)
    >>> round(state.approach, 12)
    1.0
    """

    surface: HeightMap | Surface
    contact_modulus: float | None = None
    bodies: tuple[Body | None, Body | None] | None = None
    effects: Effects = field(default_factory=Effects)
    outputs: tuple[Output, ...] | None = None
    conductance: Conductance | None = None

    def __init__(
        self,
        surface: HeightMap | Surface,
        contact_modulus: float | None = None,
        *,
        bodies: Sequence[AnyBody] | None = None,
        effects: Effects | EffectsDict | Mapping[str, Any] | None = None,
        outputs: Iterable[Output] | Iterable[str] | None = None,
        conductance: ConductanceDict | Conductance | None = None,
        modulus: float | None = None,
    ) -> None:
        if modulus is not None:
            if contact_modulus is not None:
                raise TypeError("give contact_modulus, or modulus under its former name, not both")
            warnings.warn(
                "`modulus` is read as `contact_modulus`, which is E* of the pair: for Young's modulus and Poisson's "
                "ratio give `bodies`",
                FutureWarning,
                stacklevel=2,
            )
            contact_modulus = modulus
        if not isinstance(surface, HeightMap | Surface):
            raise TypeError(
                f"the surface is of the type {type(surface).__name__}: expected a Surface or a HeightMap; "
                "fc.HeightMap(array, size=...) makes one of heights, fc.read_surface(...).heights is that of a file"
            )
        if isinstance(outputs, str) or not isinstance(outputs, Iterable | None):
            raise TypeError(f"outputs is {outputs!r}: expected a list of names")
        put = object.__setattr__
        put(self, "surface", surface)
        put(self, "contact_modulus", None if contact_modulus is None else number(contact_modulus, "contact_modulus"))
        put(self, "bodies", None if bodies is None else _both(bodies))
        put(self, "effects", Effects() if effects is None else Effects.of(effects))
        put(self, "outputs", None if outputs is None else tuple(outputs))
        put(self, "conductance", None if conductance is None else _conductance(conductance))
        # Mistakes are told where they are made.
        self._core()

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other) if isinstance(other, Scene) else NotImplemented

    def __hash__(self) -> int:
        # A map has no hash: its shape and its sides stand for it.
        surface = self.surface if isinstance(self.surface, Surface) else (self.surface.shape, self.surface.size)
        return hash((surface, self.contact_modulus, self.bodies, self.effects, self.outputs, self.conductance))

    def _core(self) -> _core.Scene:
        surface = self.surface._core() if isinstance(self.surface, Surface) else self.surface
        bodies = self.bodies and [body and (body.young, body.poisson) for body in self.bodies]
        outputs = None if self.outputs is None else list(self.outputs)
        return _core.scene(surface, self.contact_modulus, bodies, self.effects._values(), outputs, self.conductance)

    @staticmethod
    def from_toml(text: str, *, directory: str | PathLike[str] = ".") -> SceneFile:
        """A scene file from its text, with the same keys as for the program.

        Parameters
        ----------
        text : str
            What a file of a scene holds.
        directory : str or path-like
            The folder from which relative paths count.

        Returns
        -------
        SceneFile
            The scene, which `run_scene` runs.
        """
        return SceneFile.from_toml(text, directory=Path(directory))

    @staticmethod
    def from_dict(tables: Mapping[str, Any], *, directory: str | PathLike[str] = ".") -> SceneFile:
        """A scene file from its tables, with the same keys as its text.

        Parameters
        ----------
        tables : mapping
            The tables by their names, such as ``scene``, ``effects`` and ``outputs``.
        directory : str or path-like
            The folder from which relative paths count.

        Returns
        -------
        SceneFile
            The scene, which `run_scene` runs.
        """
        return SceneFile.from_dict(dict(tables), directory=Path(directory))
