"""What an interface lets through and what the bodies bear, of arrays: leakage, paths, stress below the surface."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core, _numbers
from ._core import HeightMap
from ._errors import ShapeError, domain_error
from ._numbers import number
from ._plain import same_fields
from .typing import Axis, Boundary

Cell = float | Sequence[float] | NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Leakage:
    """The flow of a fluid between opposite edges of a gap, with bounds on both sides; `leakage` makes it.

    Bounds and flux are those of the conductivity ``gap**3`` under a pressure drop of 1: the flow of a fluid is
    ``pressure_drop/(12 viscosity)`` times as large, and `flow` gives it. Arrays are ``[row, column]`` and read-only.
    Two of them compare with ``==`` as wholes.

    Parameters
    ----------
    lower, upper : float
        Bounds of the flow through the network of the cells, a length cubed. They are proven for the network: rounding
        is in them.
    continuum_lower, continuum_upper : float or None
        Bounds of the flow through the continuum with a constant gap in each cell. How far they are apart is the error
        of the discretisation. None where they were not requested.
    mean_gap : float
        Mean gap over all cells, where those in contact count as 0.
    flow_factor : float or None
        The flow through the network over that through a smooth gap of the mean gap, the pressure flow factor of Patir
        and Cheng (1978); its relative error is that of the bounds. None for an interface without any gap.
    pressure : numpy.ndarray
        Pressure of the fluid at the centre of each cell, from 1 at the first edge to 0 at the last, shape (rows,
        columns). In cells that no edge is connected to it is 0 and means nothing. Where next to nothing flows beside
        what flows elsewhere, it is only known to be between 0 and 1.
    reached : numpy.ndarray
        Whether open cells connect a cell to an edge, bool, shape (rows, columns).
    flux : numpy.ndarray
        Flux along x and along y at the centre of each cell, per unit of width, a length squared, shape (2, rows,
        columns); 0 where nothing flows.
    iterations : int
        Steps of conjugate gradients.
    """

    lower: float
    upper: float
    continuum_lower: float | None
    continuum_upper: float | None
    mean_gap: float
    flow_factor: float | None
    pressure: NDArray[np.float64] = field(repr=False)
    reached: NDArray[np.bool_] = field(repr=False)
    flux: NDArray[np.float64] = field(repr=False)
    iterations: int

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other) if isinstance(other, Leakage) else NotImplemented

    def __hash__(self) -> int:
        return hash((self.lower, self.upper, self.mean_gap, self.pressure.shape))

    def flow(self, pressure_drop: float, viscosity: float, *, continuum: bool = False) -> tuple[float, float]:
        """Gives bounds of the flow, volume per time: m^3/s for a gap in m, Pa and Pa s.

        Parameters
        ----------
        pressure_drop : float
            Pressure at the first edge less that at the last, >= 0.
        viscosity : float
            Viscosity of the fluid, > 0.
        continuum : bool
            True for the bounds of the continuum in place of those of the network.

        Returns
        -------
        (float, float)
            The lower and the upper bound.

        Raises
        ------
        DomainError
            For numbers out of these ranges, and where the flow overflows.
        ValueError
            For a continuum that was not requested of `leakage`.
        """
        lower, upper = (self.continuum_lower, self.continuum_upper) if continuum else (self.lower, self.upper)
        if lower is None or upper is None:
            raise ValueError("continuum is True: expected False, because leakage was called with continuum=False")
        drop, viscosity = number(pressure_drop, "pressure_drop"), number(viscosity, "viscosity")
        return _core.flow_rate(lower, upper, drop, viscosity)


def leakage(
    gap: ArrayLike | HeightMap,
    cell: Cell | None = None,
    along: Axis = "x",
    boundary: Boundary = "free",
    tolerance: float = 1e-10,
    continuum: bool = True,
) -> Leakage:
    """Leakage of an incompressible fluid through a gap, between opposite edges.

    A cell conducts as the cube of its gap (Reynolds), and cells with a gap <= 0 are in contact and carry nothing. A
    solver leaves small gaps in contact: set them to 0 where the pressure is positive.

    Parameters
    ----------
    gap : array_like
        The gap of each cell, a length, shape (rows, columns), with columns along x. Dimensions with names are put into
        this order, as by `HeightMap`.
    cell : float or (float, float), optional
        Side of a square cell or sides (dx, dy), in the unit of the gap. By default the steps of the coordinates of an
        array of xarray, the cell of a HeightMap, or squares of side 1. Bounds depend on dx/dy alone, and the flux is
        per unit of this length.
    along : {"x", "y"}
        Whether the fluid flows from the first to the last column, or from the first to the last row.
    boundary : {"free", "periodic"} or mapping
        Boundaries as in `Effects`. Where the map repeats itself across the flow, cells are neighbours round the edge;
        elsewhere its sides are impermeable. The flow leads from edge to edge whatever the boundary along it.
    tolerance : float
        Relative distance of the bounds of the network at which the solver ends, > 0. Where rounding does not allow it,
        they are farther apart.
    continuum : bool
        False to leave out the bounds of the continuum, which take as long again.

    Returns
    -------
    Leakage
        The bounds, and the pressure and the flux of the fluid.

    Raises
    ------
    DomainError
        For a gap that is infinite, as at undefined points, or not a number, and where the flow overflows or underflows.
    ShapeError
        For an array that has not two dimensions, or no cells.
    OutOfMemory
        For a map that does not fit in memory: about 560 bytes for each cell, and 310 without the continuum.

    Notes
    -----
    The time grows as the number of cells: about 1 s for 512 x 512 of a rough gap. Ctrl-C ends it.

    Examples
    --------
    Three cells one behind the other, in metres. Their resistances 1/gap^3 add, and water leaks under 1 bar:

    >>> import fractal_contact as fc
    >>> leak = fc.leakage([[2e-6, 1e-6, 2e-6]])
    >>> leak.lower <= 1 / (2 / 8e-18 + 1 / 1e-18) <= leak.upper
    True
    >>> lower, upper = leak.flow(pressure_drop=1e5, viscosity=1e-3)
    >>> f"{lower:.6e} {upper:.6e}"
    '6.666667e-12 6.666667e-12'
    """
    values = _arrays.field(gap, "gap", undefined=np.inf)
    along_y, repeats = _along_y(along), _repeats(boundary)
    sides = _arrays.sides(cell, gap) or (1.0, 1.0)
    found = _core.leakage(values, sides, along_y, repeats, number(tolerance, "tolerance"), bool(continuum))
    found["reached"].setflags(write=False)
    return Leakage(**found)


@dataclass(frozen=True, eq=False)
class FilmConductance:
    """Conduction from one body to the other, with bounds on both sides; `film_conductance` makes it.

    The array is ``[row, column]`` and read-only. Two of them compare with ``==`` as wholes.

    Parameters
    ----------
    lower, upper : float
        Bounds of the current per potential difference on these cells: of the sample with free boundaries; with periodic
        ones of the interface alone, whose resistance adds to that of the bodies above and below it.
    current_density : numpy.ndarray
        Current density in each cell for a potential difference of 1, shape (rows, columns).
    iterations : int
        Steps of conjugate gradients.
    """

    lower: float
    upper: float
    current_density: NDArray[np.float64] = field(repr=False)
    iterations: int

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other) if isinstance(other, FilmConductance) else NotImplemented

    def __hash__(self) -> int:
        return hash((self.lower, self.upper, self.current_density.shape))


def film_conductance(
    gap: ArrayLike | HeightMap,
    cell: Cell | None = None,
    *,
    film: float,
    bodies: float,
    boundary: Boundary = "free",
    tolerance: float = 1e-8,
) -> FilmConductance:
    """Conductance through the contact and a film that fills the gap around it.

    Cells whose gap is 0 are in contact and pass a current without resistance; elsewhere it crosses a film of the
    thickness of the gap. Both share the resistance of the bodies, which are half-spaces. For heat take thermal
    resistivities, the inverse of conductivities. A solver leaves small gaps in contact: set them to 0 where the
    pressure is positive.

    Parameters
    ----------
    gap : array_like
        The gap of each cell, >= 0, a length, shape (rows, columns), with columns along x; infinite where nothing
        conducts. Dimensions with names are put into this order, as by `HeightMap`.
    cell : float or (float, float), optional
        Side of a square cell or sides (dx, dy), in the unit of the gap. By default the steps of the coordinates of an
        array of xarray, the cell of a HeightMap, or squares of side 1.
    film : float
        Resistivity of the film, > 0.
    bodies : float
        Sum of the resistivities of both bodies, > 0, in the same unit.
    boundary : {"free", "periodic"}
        Whether the map ends, or repeats itself along both axes.
    tolerance : float
        Relative distance of the bounds at which the solver ends. Where it needs too many steps, they are farther apart.

    Returns
    -------
    FilmConductance
        The bounds and the current density.

    Raises
    ------
    DomainError
        For a gap that is negative or not a number, and a periodic map that touches everywhere.
    Unsupported
        For a map that repeats itself along one axis only.
    OutOfMemory
        For a map that does not fit in memory.

    Examples
    --------
    A film of constant thickness has the resistance film * gap/area, and a periodic interface no other one:

    >>> import fractal_contact as fc
    >>> found = fc.film_conductance([[0.1, 0.1], [0.1, 0.1]], film=3.0, bodies=1.0, boundary="periodic")
    >>> round(found.lower, 6)
    13.333333
    """
    values = _arrays.field(gap, "gap", undefined=np.inf)
    sides = _arrays.sides(cell, gap) or (1.0, 1.0)
    resistivities = (number(film, "film"), number(bodies, "bodies"))
    found = _core.film_conductance(values, sides, resistivities, _repeats(boundary), number(tolerance, "tolerance"))
    return FilmConductance(**found)


@dataclass(frozen=True)
class Percolation:
    """What leads from one edge of an interface to the opposite one; `percolation` makes it.

    Parameters
    ----------
    spans : bool
        Whether open cells, whose gap exceeds ``g_min``, lead from edge to edge: neighbours share an edge.
    constriction : float
        Gap of the critical constriction, the narrowest cell of the widest path. Cells with at least this gap lead from
        edge to edge, and cells with a larger gap do not. It does not depend on ``g_min``.
    column, row : int
        Its cell.
    at : (float, float)
        Centre (x, y) of this cell, from the corner where the first row and the first column begin.
    contact_spans : bool
        Whether cells in contact, whose gap is at most ``g_min``, lead from edge to edge along the same axis: neighbours
        share an edge.
    contact_blocks : bool
        Whether the contact closes the way across the axis, where cells that touch at a corner are neighbours as well;
        the opposite of ``spans``.
    """

    spans: bool
    constriction: float
    column: int
    row: int
    at: tuple[float, float]
    contact_spans: bool
    contact_blocks: bool


def percolation(
    gap: ArrayLike | HeightMap,
    cell: Cell | None = None,
    along: Axis = "x",
    boundary: Boundary = "free",
    g_min: float = 0.0,
) -> Percolation:
    """Finds whether a path leads through the gap, and its critical constriction.

    Parameters
    ----------
    gap : array_like
        The gap of each cell, a length, shape (rows, columns), with columns along x. Points that are infinite or masked
        are undefined, and open. A solver leaves small gaps in contact: set them to 0 where the pressure is positive.
    cell : float or (float, float), optional
        Side of a square cell or sides (dx, dy), of which only the place of the constriction depends. By default the
        steps of the coordinates of an array of xarray, the cell of a HeightMap, or squares of side 1.
    along : {"x", "y"}
        Whether paths lead from the first to the last column, or from the first to the last row.
    boundary : {"free", "periodic"} or mapping
        Boundaries as in `Effects`. Where the map repeats itself across the paths, cells are neighbours round the edge.
    g_min : float
        Cells with a larger gap are open.

    Returns
    -------
    Percolation
        Whether open cells and cells in contact lead through, and the constriction.

    Raises
    ------
    DomainError
        For a gap or a ``g_min`` that is not a number.
    ShapeError
        For an array that has not two dimensions, or no cells.
    OutOfMemory
        For a map that does not fit in memory: 28 bytes for each cell.

    Notes
    -----
    The cells are sorted by their gap, which takes O(N log N) for N of them.

    Examples
    --------
    In the first row the way leads over a gap of 1, in the second one it is closed:

    >>> import fractal_contact as fc
    >>> path = fc.percolation([[5.0, 1.0, 4.0], [6.0, 2.0, 0.0]])
    >>> path.spans, path.constriction, path.column, path.row, path.at
    (True, 1.0, 1, 0, (1.5, 0.5))
    """
    values = _arrays.field(gap, "gap", undefined=np.inf)
    along_y, repeats = _along_y(along), _repeats(boundary)
    sides = _arrays.sides(cell, gap) or (1.0, 1.0)
    return Percolation(**_core.percolation(values, sides, along_y, repeats, number(g_min, "g_min")))


def stress_below(
    pressure: ArrayLike | HeightMap,
    *,
    cell: Cell | None = None,
    depths: Iterable[float] | None = None,
    points: ArrayLike | None = None,
    origin: Sequence[float] | NDArray[np.float64] = (0.0, 0.0),
    poisson: float,
    traction: Sequence[ArrayLike] | NDArray[np.float64] | None = None,
    boundary: Boundary = "free",
) -> NDArray[np.float64]:
    """The stress below the surface of a body under a pressure and tangential tractions.

    Components are xx, yy, zz, yz, xz and xy, in this order, and tension is positive. z points into the body from its
    surface, so that each body has its own axes. The load is constant in each cell.

    Parameters
    ----------
    pressure : array_like
        The pressure on each cell, positive where it pushes the body in, shape (rows, columns), with columns along x.
        Dimensions with names are put into this order, as by `HeightMap`.
    cell : float or (float, float)
        Side of a square cell or sides (dx, dy). It may be left out for an array of xarray with coordinates and for a
        HeightMap, which have it.
    depths : iterable of float
        Depths >= 0 at which the stress at the centres of all cells is wanted.
    points : array_like
        In place of depths: points (x, y, z) with z >= 0 anywhere in the body, shape (points, 3); for free boundaries
        alone.
    origin : (float, float)
        Place (x, y) of the corner of the map where its first row and its first column begin, in the axes of the points.
    poisson : float
        Poisson's ratio of the body, in [0, 1/2].
    traction : two array_like, optional
        Tangential tractions along x and along y on the body whose stress is wanted, of the shape of the pressure.
        ``state.traction`` acts on the first body, and ``-state.traction`` on the second.
    boundary : {"free", "periodic"} or mapping
        Boundaries as in `Effects`. Where the map repeats itself, the body cannot expand laterally as a whole.

    Returns
    -------
    numpy.ndarray
        The stress, in the unit of the pressure: shape (6, depths, rows, columns) for depths, and (6, points) for
        points.

    Raises
    ------
    TypeError
        Unless there is exactly one of depths and points.
    DomainError
        For Poisson's ratio, a load that is not finite, a depth or point above the surface, and a stress that overflows.
    ShapeError
        For arrays of other shapes, and without any depth or point.
    Unsupported
        For points below a map that repeats itself.
    OutOfMemory
        For what does not fit in memory: 48 bytes for each cell and depth, and about 240 for each cell beside it, or 500
        with tractions.

    Notes
    -----
    Depths take fast Fourier transforms: about 0.2 s for each one of 512 x 512 cells with free boundaries. Points take a
    sum over the loaded cells: about 0.3 us for each of them and each point. Errors are about 1e-14 of the largest
    stress. Ctrl-C ends it.

    Examples
    --------
    Boussinesq's force, seen from ten sides of its cell: ``zz = -3/(2 pi z**2)``.

    >>> import numpy as np
    >>> import fractal_contact as fc
    >>> stress = fc.stress_below([[1.0]], cell=1.0, points=[(0.5, 0.5, 10.0)], poisson=0.3)
    >>> stress.shape, round(float(stress[2, 0] * -200 * np.pi / 3), 2)
    ((6, 1), 1.0)
    >>> fc.stress_below(np.ones((4, 8)), cell=1.0, depths=[0.5, 1.0], poisson=0.3).shape
    (6, 2, 4, 8)
    """
    if (depths is None) == (points is None):
        raise TypeError(f"give exactly one of depths and points, not {'both' if depths is not None else 'none'}")
    load = _load(pressure, cell, traction, poisson, boundary)
    corner = _numbers.numbers(origin, "origin")
    if len(corner) != 2:
        raise ValueError(f"origin has {len(corner)} numbers: expected two, (x, y)")
    for name, place in zip(("origin[0]", "origin[1]"), corner, strict=True):
        if not np.isfinite(place):
            raise domain_error(name, place, "a finite number")
    if depths is not None:
        if any(corner):
            raise TypeError("origin goes with points: depths have the stress at the centres of the cells")
        return _core.stress_at_depths(load, _depths(depths))
    return _core.stress_at_points(load, _points(points) - [*corner, 0.0])


@dataclass(frozen=True, eq=False)
class LargestVonMises:
    """The largest equivalent stress of von Mises below a map; `largest_von_mises` makes it.

    Two of them compare with ``==`` as wholes.

    Parameters
    ----------
    value : float
        The equivalent stress; 0 without a load. All tractions may grow by the factor yield stress/value until the body
        yields.
    depth : float
        Its depth.
    column, row : int
        Its cell.
    at : (float, float)
        Centre (x, y) of this cell, from the corner where the first row and the first column begin.
    stress : numpy.ndarray
        The components xx, yy, zz, yz, xz and xy there, shape (6,).
    """

    value: float
    depth: float
    column: int
    row: int
    at: tuple[float, float]
    stress: NDArray[np.float64]

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other) if isinstance(other, LargestVonMises) else NotImplemented

    def __hash__(self) -> int:
        return hash((self.value, self.depth, self.column, self.row))


def largest_von_mises(
    pressure: ArrayLike | HeightMap,
    *,
    cell: Cell | None = None,
    depths: Iterable[float],
    poisson: float,
    traction: Sequence[ArrayLike] | NDArray[np.float64] | None = None,
    boundary: Boundary = "free",
) -> LargestVonMises:
    """The largest equivalent stress of von Mises below the surface, at the centres of cells.

    The stress is computed at the depths given, and the depth is then refined between the neighbours of the best one.
    Depths have to be dense enough for the maximum that matters: that of a patch of radius a is near 0.5 a.

    Parameters
    ----------
    pressure : array_like
        The pressure on each cell, as for `stress_below`.
    cell : float or (float, float)
        Side of a square cell or sides (dx, dy), as for `stress_below`.
    depths : iterable of float
        Depths >= 0, at least one; the order does not matter.
    poisson : float
        Poisson's ratio of the body, in [0, 1/2].
    traction : two array_like, optional
        Tangential tractions on this body, as for `stress_below`.
    boundary : {"free", "periodic"} or mapping
        Boundaries as in `Effects`.

    Returns
    -------
    LargestVonMises
        The stress and its place.

    Raises
    ------
    DomainError
        For Poisson's ratio, a load that is not finite, a negative depth, and a stress that overflows.
    ShapeError
        For arrays of other shapes, and without any depth.
    OutOfMemory
        For a map that does not fit in memory: about 300 bytes for each cell, or 560 with tractions.

    Notes
    -----
    It takes the time of `stress_below` for these depths and for ten to twenty more. One depth is kept.

    Examples
    --------
    Below Hertz's pressure, with radius and largest pressure 1, it is 0.620 at the depth 0.481:

    >>> import numpy as np
    >>> import fractal_contact as fc
    >>> place = (np.arange(45) + 0.5) / 15 - 1.5
    >>> pressure = np.sqrt(np.maximum(1 - np.add.outer(place**2, place**2), 0))
    >>> largest = fc.largest_von_mises(pressure, cell=1 / 15, depths=[0.1, 0.2, 0.4, 0.8], poisson=0.3)
    >>> round(largest.value, 2), round(largest.depth, 2), largest.row
    (0.62, 0.48, 22)
    """
    load = _load(pressure, cell, traction, poisson, boundary)
    return LargestVonMises(**_core.largest_von_mises(load, _depths(depths)))


def von_mises(stress: ArrayLike) -> NDArray[np.float64]:
    """Von Mises' equivalent stress, ``sqrt(((xx-yy)**2 + (yy-zz)**2 + (zz-xx)**2)/2 + 3 (yz**2 + xz**2 + xy**2))``.

    Parameters
    ----------
    stress : array_like
        Stresses with the components xx, yy, zz, yz, xz and xy along their first axis, shape (6, ...).

    Returns
    -------
    numpy.ndarray
        The equivalent stresses, shape (...); nothing overflows on the way.

    Raises
    ------
    DomainError
        For a stress that is not finite, or whose equivalent stress overflows.
    ShapeError
        For a first axis that has not six components.

    Examples
    --------
    Uniaxial tension, and pure shear:

    >>> import fractal_contact as fc
    >>> fc.von_mises([[2, 0], [0, 0], [0, 0], [0, 0], [0, 0], [0, 1]]).round(3).tolist()
    [2.0, 1.732]
    """
    array = np.asarray(stress)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"stress is of the type {array.dtype}: expected real numbers")
    if array.ndim == 0 or array.shape[0] != 6:
        raise _shape_error("stress", array.shape, "(6, ...), with xx, yy, zz, yz, xz and xy")
    flat = np.ascontiguousarray(array, dtype=np.float64).reshape(6, -1) if array.size else np.empty((6, 0))
    found, wrong = _core.von_mises(flat)
    if wrong is not None:
        place = ", ".join([":", *(str(int(i)) for i in np.unravel_index(wrong, array.shape[1:]))])
        components = flat[:, wrong]
        value = next((float(one) for one in components if not np.isfinite(one)), float(components[0]))
        raise domain_error(f"stress[{place}]", value, "finite components whose equivalent stress is finite")
    return found.reshape(array.shape[1:])


def _load(pressure: Any, cell: Any, traction: Any, poisson: Any, boundary: Any) -> dict[str, Any]:
    """What acts on a body, and the body, as the compiled part takes them."""
    values = _arrays.field(pressure, "pressure")
    sides = _arrays.sides(cell, pressure)
    if sides is None:
        raise TypeError("cell is missing: expected the side of a square cell or its sides (dx, dy)")
    known = {"poisson": number(poisson, "poisson"), "repeats": _repeats(boundary)}
    return {"pressure": values, "traction": _both(traction, values.shape), "cell": sides, **known}


def _both(traction: Any, shape: tuple[int, ...]) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """The components of a traction along x and along y."""
    if traction is None:
        return None
    if isinstance(traction, str | Mapping) or not hasattr(traction, "__len__") or len(traction) != 2:
        raise ValueError("traction: expected two arrays of the shape of the pressure, along x and along y")
    found = [_arrays.field(traction[i], f"traction[{i}]") for i in (0, 1)]
    for i, one in enumerate(found):
        if one.shape != shape:
            raise _shape_error(f"traction[{i}]", one.shape, f"{shape}, that of the pressure")
    return found[0], found[1]


def _depths(depths: Any) -> list[float]:
    found = _numbers.numbers(depths, "depths")
    if not found:
        raise _shape_error("depths", (0,), "at least one depth")
    return found


def _points(points: Any) -> NDArray[np.float64]:
    array = np.asarray(points)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"points are of the type {array.dtype}: expected real numbers")
    if array.ndim != 2 or array.shape[1] != 3 or not array.size:
        raise _shape_error("points", array.shape, "(points, 3), with x, y and z of at least one point")
    return np.ascontiguousarray(array, dtype=np.float64)


def _shape_error(name: str, shape: tuple[int, ...], expected: str) -> ShapeError:
    error = ShapeError(f"{name} has the shape {shape}: expected {expected}")
    error.quantity, error.value, error.expected = name, int(np.prod(shape)), expected
    return error


def _along_y(along: Any) -> bool:
    if not isinstance(along, str) or along not in ("x", "y"):
        raise ValueError(f'along is {along!r}: expected "x" or "y"')
    return along == "y"


def _repeats(boundary: Any) -> tuple[bool, bool]:
    """Whether a map repeats itself along x, and along y."""
    ways = dict(boundary) if isinstance(boundary, Mapping) else {"x": boundary, "y": boundary}
    words = ("free", "periodic")
    if ways.keys() != {"x", "y"} or not all(isinstance(way, str) and way in words for way in ways.values()):
        raise ValueError(
            f'boundary is {boundary!r}: expected "free", "periodic", or one of them for each direction, '
            'such as {"x": "periodic", "y": "free"}'
        )
    return ways["x"] == "periodic", ways["y"] == "periodic"
