from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Never, final

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ._errors import Error
from ._inputs import Cells, Size
from ._models import StopToken
from .typing import Undefined

_Heights = float | NDArray[np.floating[Any] | np.integer[Any]]

VERSION: str
__all__ = [
    "VERSION",
    "Certificate",
    "Contact",
    "ContactState",
    "HeightMap",
    "Model",
    "Normalisation",
    "Scene",
    "SceneFile",
    "Surface",
    "channels",
    "check_effects",
    "check_pressed_map",
    "combinations",
    "effect_keys",
    "ensemble",
    "fields",
    "film_conductance",
    "fit_spectrum",
    "flow_rate",
    "height_difference",
    "height_map",
    "largest_von_mises",
    "leakage",
    "model",
    "models",
    "notes_of_python",
    "parameters",
    "percolation",
    "picture",
    "power_spectrum",
    "press_scene",
    "quantities",
    "read_surface",
    "run_scene",
    "scale_dependence",
    "scene",
    "self_affine_map",
    "set_threads",
    "si",
    "stress_at_depths",
    "stress_at_points",
    "surface",
    "surface_seed",
    "threads",
    "twin",
    "von_mises",
    "write_surface",
]

@final
class HeightMap:
    """Heights on a rectangle of equal cells, measured outwards from the body, so that large values touch first.

    ``np.asarray(map)`` is an array of them. Maps of the same size are added and subtracted; numbers, and arrays of
    the map's shape, are added, subtracted, multiplied and divided by. Undefined points stay undefined. Comparisons,
    ``map[row, column]``, ``map.max()`` and the functions of numpy give what they give of the array, in which
    undefined
    points are NaN; each copies the heights once. `equals` compares two maps as wholes.

    Parameters
    ----------
    heights : array_like
            Two-dimensional, ``[row, column]``: columns along x, rows along y, of any real type. A masked array has
            undefined points where it is masked. Of an array whose dimensions have names, such as one of xarray, the
        names
            ``x`` and ``y`` (or ``column`` and ``row``) decide which axis is which; ``metadata`` says what was done.
    size : float, str, or two of them
            Side of a square or sides ``(Lx, Ly)`` of the rectangle, in the unit of the heights; texts with a unit,
        such
            as ``"1 mm"`` or ``"2 mm x 1 mm"``, are metres.
    unit : str, optional
            Unit of the heights in the array, such as ``"nm"``: the map is then in metres.
    undefined : {"error", "no_contact"}
            What NaN means: an error, or a point that cannot touch. Masked points cannot touch either way.
    """
    def __new__(
        cls,
        heights: ArrayLike,
        size: Size | str | Sequence[str],
        *,
        unit: str | None = None,
        undefined: Undefined = "error",
    ) -> HeightMap: ...
    @staticmethod
    def _with_origin(map: HeightMap, axes: str | None, filled: NDArray[np.bool_] | None) -> HeightMap: ...
    @property
    def metadata(self) -> dict[str, str]:
        """dict of str: what was done with the axes of an array whose dimensions have names, under ``"axes"``; empty
        for
        other arrays, and of a map that follows from another one.
        """
    __pandas_priority__: int
    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any: ...
    def __getitem__(self, index: Any, /) -> Any: ...
    def __iter__(self) -> Iterator[NDArray[np.float64]]: ...
    def __contains__(self, value: object, /) -> bool: ...
    def __bool__(self) -> bool: ...
    @property
    def ndim(self) -> int:
        """int: 2, as of the array."""
    @property
    def dtype(self) -> np.dtype[np.float64]:
        """numpy.dtype: that of the array, double precision."""
    def max(self, axis: int | None = None, **options: Any) -> Any:
        """The largest height, as ``max`` of the array: NaN where a point is undefined.

        Parameters
        ----------
        axis : int, optional
                0 for that of each column, 1 for that of each row; of all by default.
        **options
                Other options of the array's method.

        Returns
        -------
        float or numpy.ndarray
        """
    def min(self, axis: int | None = None, **options: Any) -> Any:
        """The smallest height, as ``min`` of the array: NaN where a point is undefined.

        Parameters
        ----------
        axis : int, optional
                0 for that of each column, 1 for that of each row; of all by default.
        **options
                Other options of the array's method.

        Returns
        -------
        float or numpy.ndarray
        """
    def mean(self, axis: int | None = None, **options: Any) -> Any:
        """The mean height, as ``mean`` of the array: NaN where a point is undefined.

        Parameters
        ----------
        axis : int, optional
                0 for that of each column, 1 for that of each row; of all by default.
        **options
                Other options of the array's method.

        Returns
        -------
        float or numpy.ndarray
        """
    def equals(self, other: HeightMap) -> bool:
        """Whether another map has the same size and the same heights to the last bit, undefined points included.

        Parameters
        ----------
        other : HeightMap
                The other map.

        Returns
        -------
        bool
        """
    def __array__(self, dtype: DTypeLike | None = None, *, copy: bool | None = None) -> NDArray[Any]: ...
    def __len__(self) -> int: ...
    @property
    def filled(self) -> NDArray[np.bool_] | None:
        """numpy.ndarray or None: which points were filled when the file of the map was read with ``fill``, [row,
        column];
        None where none was. `statistics.fit_spectrum` takes them into account. Maps that follow from this one by
        their
        methods, by numbers and by arrays keep it.
        """
    @property
    def heights(self) -> NDArray[np.float64]:
        """numpy.ndarray: the heights, [row, column]; NaN at undefined points. Read-only: ``np.array(map)`` is a copy
        to
        change.
        """
    @property
    def shape(self) -> tuple[int, int]:
        """(int, int): rows and columns."""
    @property
    def size(self) -> tuple[float, float]:
        """(float, float): sides (Lx, Ly)."""
    @property
    def cell(self) -> tuple[float, float]:
        """(float, float): sides of a cell (dx, dy)."""
    @property
    def extent(self) -> tuple[float, float, float, float]:
        """(float, float, float, float): left, right, bottom and top of the rectangle, as ``imshow`` takes it with
        ``origin="lower"``.
        """
    @property
    def x(self) -> NDArray[np.float64]:
        """numpy.ndarray: places of the centres of the columns along x, shape (columns,)."""
    @property
    def y(self) -> NDArray[np.float64]:
        """numpy.ndarray: places of the centres of the rows along y, shape (rows,)."""
    @property
    def undefined(self) -> int:
        """int: number of undefined points."""
    @property
    def rms_height(self) -> float:
        """float: rms height about the mean of the defined points."""
    def transposed(self) -> HeightMap:
        """The map with x and y exchanged."""
    def mirrored(self) -> HeightMap:
        """The map with x reversed."""
    def rotated(self) -> HeightMap:
        """The map turned by a quarter from x to y."""
    def cropped(self, rows: Sequence[int], columns: Sequence[int]) -> HeightMap:
        """The map of the rows and columns from the first to before the second of each pair.

        Parameters
        ----------
        rows, columns : (int, int)
                First, and the one after the last.
        """
    def scaled(self, lateral: float, vertical: float) -> HeightMap:
        """The map with its sides and its heights multiplied.

        Parameters
        ----------
        lateral : float
                Factor > 0 of the sides.
        vertical : float
                Factor of the heights.

        Returns
        -------
        HeightMap
                A new map.
        """
    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draws the map with matplotlib: cells in their shape, the first row at the bottom, a colour bar.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
                Axes of the picture; the current ones by default.
        **options
                Options of ``imshow``.

        Returns
        -------
        matplotlib.image.AxesImage
        """
    def to_xarray(self) -> Any:
        """The map for xarray, with the dimensions y and x and their coordinates.

        Returns
        -------
        xarray.DataArray
        """
    def __add__(self, other: HeightMap | _Heights, /) -> HeightMap: ...
    def __radd__(self, other: _Heights, /) -> HeightMap: ...
    def __sub__(self, other: HeightMap | _Heights, /) -> HeightMap: ...
    def __rsub__(self, other: _Heights, /) -> HeightMap: ...
    def __mul__(self, other: _Heights, /) -> HeightMap: ...
    def __rmul__(self, other: _Heights, /) -> HeightMap: ...
    def __truediv__(self, other: _Heights, /) -> HeightMap: ...
    def __rtruediv__(self, other: Never, /) -> HeightMap: ...
    def __neg__(self) -> HeightMap: ...
    def __pos__(self) -> HeightMap: ...
    def __eq__(self, other: object, /) -> NDArray[np.bool_]: ...  # type: ignore[override]
    def __ne__(self, other: object, /) -> NDArray[np.bool_]: ...  # type: ignore[override]
    def __lt__(self, other: Any, /) -> NDArray[np.bool_]: ...
    def __le__(self, other: Any, /) -> NDArray[np.bool_]: ...
    def __gt__(self, other: Any, /) -> NDArray[np.bool_]: ...
    def __ge__(self, other: Any, /) -> NDArray[np.bool_]: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]
    def __reduce__(self) -> tuple[Any, ...]: ...
    def _repr_html_(self) -> str: ...

@final
class Certificate:
    """How exactly the contact conditions hold, measured with the exact operator in double precision.

    All numbers are relative and dimensionless.
    """
    @property
    def duality_gap(self) -> float:
        """float: duality gap of the quadratic programme over force times rms height."""
    @property
    def penetration(self) -> float:
        """float: deepest penetration over the rms height."""
    @property
    def complementarity(self) -> float:
        """float: sum of pressure times gap over force times rms height."""
    @property
    def load_error(self) -> float:
        """float: relative difference of the force from the prescribed one; of a prescribed mean gap its error over
        the rms height. With adhesion relative to a thousandth of the force of the contact pressure where that is
        larger than the prescribed force.
        """
    @property
    def stiffness_error(self) -> float | None:
        """float or None: estimated relative error of the stiffness; None where it is a difference quotient
        (`quotient_error`).
        """
    @property
    def quotient_error(self) -> float | None:
        """float or None: estimated relative error of a stiffness that is a difference quotient, with adhesion of
        short range and Dugdale's law. It depends on the cells, not on the tolerance, so it is no part of `worst`.
        """
    @property
    def force_error(self) -> float | None:
        """float or None: bound of the relative error of the force under a prescribed approach or mean gap, an
        estimate with adhesion; no part of `worst`.
        """
    @property
    def error_of_stiffness(self) -> float | None:
        """float or None: estimated relative error of the stiffness, whether it is a difference quotient or not;
        ``stiffness_error`` in tables.
        """
    @property
    def equilibrium(self) -> float | None:
        """float or None: largest difference between the traction of a cell and what the law of adhesion says of
        its gap, over work/range; None without adhesion of finite range.
        """
    @property
    def tangential_duality_gap(self) -> float | None:
        """float or None: duality gap of the last step of friction over sliding force times tangential displacement,
        without how far the contact has slid before; None without friction, and where a model does not solve it
        cell by cell.
        """
    @property
    def tangential_load_error(self) -> float | None:
        """float or None: difference of the tangential force from the prescribed one, over the sliding force."""
    @property
    def tangential_stiffness_error(self) -> float | None:
        """float or None: estimated relative error of the tangential stiffness."""
    @property
    def worst(self) -> float:
        """float: the largest of the numbers that the tolerance bounds."""
    def meets(self, tolerance: float) -> bool:
        """Whether every number that the tolerance bounds is at most `tolerance`.

        Parameters
        ----------
        tolerance : float
                Dimensionless, as that of the model.

        Returns
        -------
        bool
        """
    def to_dict(self) -> dict[str, float | None]:
        """The numbers by the names of the columns of scenes; ``stiffness_error`` is `error_of_stiffness`.

        Returns
        -------
        dict of float or None
        """
    @staticmethod
    def _of_bytes(bytes: bytes) -> Certificate: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class ContactState:
    """One contact state, alone or at the end of a step of a path.

    What was not requested, or what the model does not claim, is None. Two states compare with ``==`` as wholes: they
    are equal if all their numbers, fields and notes are, to the last bit.

    Its numbers and words are those of `quantities`. Units in brackets are those of SI; a scene in other units
    has its own.
    """
    # The numbers and words of the table of quantities: written by python/generate.py.
    @property
    def time(self) -> float | None:
        """float or None: time at the end of the step [s]."""
    @property
    def force(self) -> float:
        """float: normal force; negative where adhesion holds against a pull [N]."""
    @property
    def force_bar(self) -> float | None:
        """float or None: force, F/(E* h L), L = sqrt(Lx Ly)."""
    @property
    def approach(self) -> float | None:
        """float or None: approach, from first touch of the highest point [m]."""
    @property
    def mean_gap(self) -> float | None:
        """float or None: mean gap, distance between the mean plane of the defined heights and that of the deformed
        half-space; without undefined points the mean of the gap field; with them it may be negative [m].
        """
    @property
    def whole_approach(self) -> float | None:
        """float or None: approach with the whole layer, of the rigid body to the base from first touch: the fall of
        the mean gap and the compression of the whole layer under the mean pressure; empty under an elastic body,
        whose half-space has no approach, and of a viscoelastic layer [m].
        """
    @property
    def contact_radius(self) -> float | None:
        """float or None: contact radius, of a round contact; of an equivalent profile that of the round contact of
        the same stiffness, k/(2 E*) [m].
        """
    @property
    def tangential_force(self) -> float | None:
        """float or None: tangential force along x [N]."""
    @property
    def tangential_force_y(self) -> float | None:
        """float or None: tangential force along y [N]."""
    @property
    def tangential_displacement(self) -> float | None:
        """float or None: tangential displacement, of the bodies relative to each other along x, far from the contact
        [m].
        """
    @property
    def tangential_displacement_y(self) -> float | None:
        """float or None: tangential displacement along y, of the bodies relative to each other along y, far from the
        contact [m].
        """
    @property
    def sliding_force(self) -> float | None:
        """float or None: sliding force, tangential force at which the whole contact slips: the largest tractions of
        all cells in contact together, by Coulomb's law the coefficient of friction times the normal force [N].
        """
    @property
    def stick_area(self) -> float | None:
        """float or None: stick area, area of the contact whose traction is below the limit of friction [m^2]."""
    @property
    def slip_area(self) -> float | None:
        """float or None: slip area, area of the contact whose traction is at the limit of friction [m^2]."""
    @property
    def tangential_stiffness(self) -> float | None:
        """float or None: tangential stiffness, dQ_x/ddelta_x along the branch of states at fixed pressures: cells
        that stick continue to stick, cells that slip continue to slip; a step in which nothing moves keeps which of
        them slipped in the last one that moved [N/m].
        """
    @property
    def tangential_stiffness_xy(self) -> float | None:
        """float or None: tangential stiffness, x of y, dQ_x/ddelta_y of the same; it is dQ_y/ddelta_x too [N/m]."""
    @property
    def tangential_stiffness_y(self) -> float | None:
        """float or None: tangential stiffness along y, dQ_y/ddelta_y of the same [N/m]."""
    @property
    def tangential_stiffness_stuck(self) -> float | None:
        """float or None: tangential stiffness, sticking, dQ_x/ddelta_x with the whole contact sticking: the first
        answer after a reversal [N/m].
        """
    @property
    def tangential_stiffness_stuck_xy(self) -> float | None:
        """float or None: tangential stiffness, sticking, x of y, dQ_x/ddelta_y of the same; it is dQ_y/ddelta_x too
        [N/m].
        """
    @property
    def tangential_stiffness_stuck_y(self) -> float | None:
        """float or None: tangential stiffness along y, sticking, dQ_y/ddelta_y of the same [N/m]."""
    @property
    def stick_radius(self) -> float | None:
        """float or None: stick radius, radius inside which nothing slips [m]."""
    @property
    def dissipated(self) -> float | None:
        """float or None: energy dissipated by friction, energy lost to friction since the first step [J]."""
    @property
    def plastic_area(self) -> float | None:
        """float or None: area under the hardness [m^2]."""
    @property
    def plastic_volume(self) -> float | None:
        """float or None: volume of the plastic indentation, since the virgin surface [m^3]."""
    @property
    def plastic_work(self) -> float | None:
        """float or None: plastic work, energy dissipated in the plastic indentation, hardness times volume [J]."""
    @property
    def work(self) -> float | None:
        """float or None: work of the load, work of the normal load since the first step: what the body holds and
        what has been dissipated in it; periodic by the fall of the mean gap, without the compression of a whole
        layer [J].
        """
    @property
    def branch(self) -> str | None:
        """str or None: branch, whether the bodies were brought nearer or drawn apart."""
    @property
    def energy(self) -> float | None:
        """float or None: elastic energy less the work of adhesion done, of elastic bodies [J]."""
    @property
    def stability(self) -> float | None:
        """float or None: stability, a minimum of the energy where > 0: its least curvature over that without
        adhesion.
        """
    @property
    def pull_off(self) -> float | None:
        """float or None: largest pull of the path so far: the most negative normal force of its loads, with a
        positive sign; at most the pull-off force [N].
        """
    @property
    def pull_off_error(self) -> float | None:
        """float or None: error of the largest pull, upper bound of the remaining error: the pull-off force is at
        most pull_off + pull_off_error; empty where no load is beyond it [N].
        """
    @property
    def pull_off_approach(self) -> float | None:
        """float or None: approach at the largest pull, approach at which the path pulled most [m]."""
    @property
    def pull_off_mean_gap(self) -> float | None:
        """float or None: mean gap at the largest pull, mean gap at which the path pulled most [m]."""
    @property
    def stiffness(self) -> float | None:
        """float or None: stiffness, dF/dd along the branch of states (periodic: -dF/d(mean gap)): fronts of an
        adhesive contact move, saturated cells flow; with full coupling the tangential load is held [N/m].
        """
    @property
    def whole_stiffness(self) -> float | None:
        """float or None: stiffness with the whole layer, dF/dd of the approach with the whole layer along the branch
        of states; of an elastic layer under a rigid body [N/m].
        """
    @property
    def stiffness_bar(self) -> float | None:
        """float or None: k/(1.1419 E* L) of this stiffness, L = sqrt(Lx Ly)."""
    @property
    def stiffness_fixed_area(self) -> float | None:
        """float or None: stiffness at fixed contact area: all cells in contact stay bonded (periodic: -dF/d(mean
        gap)) [N/m].
        """
    @property
    def area(self) -> float | None:
        """float or None: real contact area [m^2]."""
    @property
    def area_corrected(self) -> float | None:
        """float or None: corrected area, area corrected for the cells at its boundary (Yastrebov et al. 2017); with
        a hardness at least the force over the hardness [m^2].
        """
    @property
    def contact_fraction(self) -> float | None:
        """float or None: contact fraction, A/(Lx Ly), undefined points included."""
    @property
    def conductance(self) -> float | None:
        """float or None: conductance, 2 k/(E* (rho_1 + rho_2)) with the stiffness at fixed contact area (Barber) [S,
        W/K].
        """
    @property
    def film_conductance(self) -> float | None:
        """float or None: conductance with the film, current through the sample per potential difference far away:
        through the contact and the film in the gap, which share the resistance of the bodies [S, W/K].
        """
    @property
    def film_conductance_per_area(self) -> float | None:
        """float or None: conductance with the film, per area, conductance of the interface per nominal area, through
        the contact and the film in the gap; the resistance of the bodies above and below adds to its own [S/m^2,
        W/(m^2 K)].
        """
    @property
    def film_conductance_along(self) -> float | None:
        """float or None: conductance of the film along the interface, current in the film between opposite edges of
        the map per potential difference, a cell conducting as its gap; the contact and the bodies carry none of it
        [S, W/K].
        """
    @property
    def leakage(self) -> float | None:
        """float or None: leakage, flow of the fluid through the network of the cells under the pressure drop; a cell
        conducts as its gap cubed [m^3/s].
        """
    @property
    def leakage_lower(self) -> float | None:
        """float or None: lower bound of the leakage, proven lower bound of the flow through the continuum with a
        constant gap in each cell [m^3/s].
        """
    @property
    def leakage_upper(self) -> float | None:
        """float or None: upper bound of the leakage, proven upper bound of the flow through the continuum with a
        constant gap in each cell [m^3/s].
        """
    @property
    def flow_factor(self) -> float | None:
        """float or None: flow factor, leakage over the flow between smooth surfaces at the mean gap, where cells in
        contact count as 0.
        """
    @property
    def open_along_x(self) -> float | None:
        """float or None: open path along x, 1 where cells with a gap, joined by edges, lead between the opposite
        edges along x, otherwise 0.
        """
    @property
    def open_along_y(self) -> float | None:
        """float or None: open path along y, 1 where cells with a gap, joined by edges, lead between the opposite
        edges along y, otherwise 0.
        """
    @property
    def contact_along_x(self) -> float | None:
        """float or None: path of contact along x, 1 where cells in contact, joined by edges, lead between the
        opposite edges along x, otherwise 0.
        """
    @property
    def contact_along_y(self) -> float | None:
        """float or None: path of contact along y, 1 where cells in contact, joined by edges, lead between the
        opposite edges along y, otherwise 0.
        """
    @property
    def constriction_x(self) -> float | None:
        """float or None: gap of the critical constriction along x, the narrowest cell of the widest path; 0 where
        the contact closes every path [m].
        """
    @property
    def constriction_x_at_x(self) -> float | None:
        """float or None: place x of the constriction along x, centre of this cell, along x; empty where the contact
        closes every path [m].
        """
    @property
    def constriction_x_at_y(self) -> float | None:
        """float or None: place y of the constriction along x, centre of this cell, along y; empty where the contact
        closes every path [m].
        """
    @property
    def constriction_y(self) -> float | None:
        """float or None: gap of the critical constriction along y, the narrowest cell of the widest path; 0 where
        the contact closes every path [m].
        """
    @property
    def constriction_y_at_x(self) -> float | None:
        """float or None: place x of the constriction along y, centre of this cell, along x; empty where the contact
        closes every path [m].
        """
    @property
    def constriction_y_at_y(self) -> float | None:
        """float or None: place y of the constriction along y, centre of this cell, along y; empty where the contact
        closes every path [m].
        """
    @property
    def largest_von_mises(self) -> float | None:
        """float or None: largest stress below the surface, largest equivalent stress of von Mises at the centres of
        cells, in the requested range of depths [Pa].
        """
    @property
    def largest_von_mises_depth(self) -> float | None:
        """float or None: depth of the largest stress, depth of this stress below the surface [m]."""
    @property
    def largest_von_mises_x(self) -> float | None:
        """float or None: place x of the largest stress, centre of the cell of this stress, along x [m]."""
    @property
    def largest_von_mises_y(self) -> float | None:
        """float or None: place y of the largest stress, centre of the cell of this stress, along y [m]."""
    @property
    def factor_until_yield(self) -> float | None:
        """float or None: factor until yield, yield stress over this stress: the factor on all pressures and
        tractions at which the body yields first.
        """
    @property
    def largest_patch(self) -> float | None:
        """float or None: area of the largest contact, area of the largest patch [m^2]."""
    @property
    def largest_pressure(self) -> float | None:
        """float or None: largest pressure, of a cell, or at a point by a closed form; that of a cell grows with
        smaller cells until they resolve the shortest wave, at an edge of the rectangle or a spike without limit
        [Pa].
        """
    @property
    def status(self) -> str:
        """str: status, how the solve ended."""
    @property
    def strategy(self) -> str:
        """str: strategy, method that the solver used."""
    @property
    def contact_cells(self) -> int | None:
        """int or None: contact cells, cells or elements in contact; with fewer than 10 the result depends on the
        grid.
        """
    @property
    def iterations(self) -> int:
        """int: iterations, of the linear solvers."""
    @property
    def applications(self) -> int:
        """int: operator applications, of the elastic operator."""
    @property
    def linear_solves(self) -> int:
        """int: linear solves, linear systems solved."""
    @property
    def time_steps(self) -> float | None:
        """float or None: steps of time, of a viscoelastic history that is solved cell by cell, since the state
        before.
        """
    @property
    def fields(self) -> int:
        """int: fields over the grid that the state holds."""
    @property
    def field_bytes(self) -> int:
        """int: bytes of fields, bytes of these fields."""
    @property
    def duality_gap(self) -> float:
        """float: duality gap, sum p (g - min g)/(F s)."""
    @property
    def penetration(self) -> float:
        """float: penetration, max(0, -min g)/s."""
    @property
    def complementarity(self) -> float:
        """float: complementarity, sum p |g|/(F s)."""
    @property
    def load_error(self) -> float:
        """float: load error, |F - F_prescribed|/F_prescribed, with adhesion at least over 1e-3 of the force of the
        contact pressure; of a mean gap its error over s.
        """
    @property
    def force_error(self) -> float | None:
        """float or None: bound of the relative error of the force under a prescribed approach or mean gap; an
        estimate with adhesion.
        """
    @property
    def force_time_error(self) -> float | None:
        """float or None: estimated relative error of the force by steps of time: its difference from that of the
        same history in steps twice as long.
        """
    @property
    def approach_time_error(self) -> float | None:
        """float or None: estimated relative error of the approach by steps of time: its difference from that of the
        same history in steps twice as long.
        """
    @property
    def mean_gap_time_error(self) -> float | None:
        """float or None: estimated relative error of the mean gap by steps of time: its difference from that of the
        same history in steps twice as long.
        """
    @property
    def area_time_error(self) -> float | None:
        """float or None: estimated relative error of the area by steps of time: the difference of the number of
        cells from that of the same history in steps twice as long.
        """
    @property
    def tangential_force_time_error(self) -> float | None:
        """float or None: estimated relative error of the tangential force by steps of time: its difference from that
        of the same history in steps twice as long.
        """
    @property
    def tangential_displacement_time_error(self) -> float | None:
        """float or None: estimated relative error of the tangential displacement by steps of time: its difference
        from that of the same history in steps twice as long.
        """
    @property
    def leakage_error(self) -> float | None:
        """float or None: error of the leakage, proven relative error of the flow through the network of the cells:
        half of the distance between its bounds, over the flow.
        """
    @property
    def film_conductance_error(self) -> float | None:
        """float or None: error of the conductance with the film, proven relative error of the conductance through
        the contact and the film on these cells: half of the distance between its bounds, over the conductance.
        """
    @property
    def film_conductance_along_error(self) -> float | None:
        """float or None: error of the conductance along the film, proven relative error of the conductance through
        the network of the cells: half of the distance between its bounds, over the conductance.
        """
    @property
    def leakage_contact_error(self) -> float | None:
        """float or None: error of the leakage by the gap, relative error of the leakage by the solve of the contact:
        half of the difference between the flows with all gaps larger and smaller by `gap_error`, over the flow;
        empty where that is not known.
        """
    @property
    def gap_error(self) -> float | None:
        """float or None: error of the gap, how far the gap of any cell is at most from that of the exact solution on
        the same cells; known for elastic half-spaces without adhesion and hardness, under a force or an approach
        [m].
        """
    @property
    def equilibrium(self) -> float | None:
        """float or None: equilibrium, largest difference of an attraction from the law of its gap, over the traction
        in contact.
        """
    @property
    def tangential_duality_gap(self) -> float | None:
        """float or None: tangential duality gap, sum (b |w| - w . q)/(B D) of the last step, solved cell by cell,
        with the largest traction b of a cell (mu p by Coulomb's law) and their sum B, the sliding force; D is the
        larger of |delta - m| and the largest |s - m|, with the mean m, weighted by b, of the displacements s from
        which the slip of the cells counts.
        """
    @property
    def tangential_load_error(self) -> float | None:
        """float or None: tangential load error, |Q - Q_prescribed| over the sliding force, solved cell by cell."""
    @property
    def tangential_stiffness_error(self) -> float | None:
        """float or None: estimated relative error of the tangential stiffness."""
    @property
    def stiffness_error(self) -> float | None:
        """float or None: estimated relative error of the stiffness; that of a difference quotient with full
        coupling, and with adhesion of short range and Dugdale's law, where the cells decide it and not the
        tolerance.
        """
    @property
    def pressure(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: pressure of each cell; negative, a tension, with adhesion only [Pa], shape (rows,
        columns). Read-only.
        """
    @property
    def gap(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: gap to the indented surface; infinite at undefined points [m], shape (rows,
        columns). Read-only.
        """
    @property
    def plastic_depth(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: depth of the plastic indentation >= 0 [m], shape (rows, columns). Read-only."""
    @property
    def displacement(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: displacement of the elastic surface [m], shape (rows, columns). Read-only."""
    @property
    def traction(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: tangential traction of each cell, along x and along y [Pa], shape (2, rows,
        columns). Read-only.
        """
    @property
    def slip(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: slip of the bodies relative to each other since the cell came into contact, along x
        and along y [m], shape (2, rows, columns). Read-only.
        """
    @property
    def stick_slip(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: 0 where there is no contact, 1 where it sticks, 2 where it slips, shape (rows,
        columns). Read-only.
        """
    # The end of the table.
    @property
    def edge_cells(self) -> int | None:
        """int or None: cells in contact at an edge of a free rectangle."""
    @property
    def rim_cells(self) -> int | None:
        """int or None: cells in contact that share an edge with an undefined point of the surface."""
    @property
    def patches(self) -> NDArray[np.float64] | None:
        """numpy.ndarray or None: areas of the connected contacts (length^2), the largest first; shape
        (patches,). Read-only.
        """
    @property
    def notes(self) -> tuple[str, ...]:
        """tuple of str: what may be wrong with the state though it is solved, such as few cells in contact or
        contact at
        the edge, and what to do about it.
        """
    @property
    def size(self) -> tuple[float, float]:
        """(float, float): sides (Lx, Ly) of the rectangle."""
    @property
    def certificate(self) -> Certificate:
        """Certificate: how exactly the contact conditions hold."""
    def to_dict(self, *, fields: bool = False) -> dict[str, Any]:
        """The numbers and words by their names, which are those of the columns of scenes.

        Arrays are there only with ``fields=True``. Those of effects and of paths are there where the state has them;
        any other that it lacks is None.
        ``patches`` is the number of connected contacts, and with ``fields=True`` the array.

        Parameters
        ----------
        fields : bool
                True to add the arrays of the fields that were requested.

        Returns
        -------
        dict
                Numbers, texts, None and arrays by their names.
        """
    @staticmethod
    def _of_bytes(bytes: bytes, fields: list[NDArray[np.float64] | None]) -> ContactState: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def _repr_html_(self) -> str: ...

@final
class Normalisation:
    """Conversion of forces and stiffnesses to the dimensionless ones of the paper."""
    @property
    def contact_modulus(self) -> float:
        """float: contact modulus E*."""
    @property
    def length(self) -> float:
        """float: L = sqrt(Lx Ly)."""
    @property
    def rms_height(self) -> float | None:
        """float or None: measured rms height of this surface."""
    def force(self, force_bar: float) -> float:
        """The force F for F_bar = F/(E* h L).

        Parameters
        ----------
        force_bar : float
                The dimensionless force.

        Returns
        -------
        float
        """
    def force_bar(self, force: float) -> float:
        """The dimensionless force F_bar = F/(E* h L) for F.

        Parameters
        ----------
        force : float
                The force, in the unit of the scene.

        Returns
        -------
        float
        """
    def stiffness_bar(self, stiffness: float) -> float:
        """The dimensionless stiffness k_bar = k/(1.1419 E* L) for k.

        Parameters
        ----------
        stiffness : float
                The stiffness, in the unit of the scene.

        Returns
        -------
        float
        """
    @staticmethod
    def _of_bytes(bytes: bytes) -> Normalisation: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Contact:
    """A planned contact: solve often, follow paths.

    It keeps tables, plans and the last state, from which the next solve starts.

    `solve` and `sweep` start each load from no contact; `advance` and `follow` continue a path of loads from
    the current state. Threads that share one contact use it one after the other, in the order of their calls.

    With a hardness `solve` begins with the virgin surface: a load smaller than one before is refused, because
    the indentation of that one would be forgotten. `advance` and `follow` keep it, along any path.
    """
    def solve(
        self,
        *,
        force: float | None = None,
        approach: float | None = None,
        mean_pressure: float | None = None,
        mean_gap: float | None = None,
        stop: StopToken | None = None,
    ) -> ContactState:
        """Solves for one load, from no contact: a path that was followed is forgotten.

        Parameters
        ----------
        force, approach, mean_pressure, mean_gap : float
                Exactly one of them. ``mean_pressure`` is over Lx Ly, ``mean_gap`` for periodic boundaries.
        stop : threading.Event, optional
                Set by another thread, it stops the solve, also within an iteration.

        Returns
        -------
        ContactState

        Raises
        ------
        DomainError, OutOfRange, Unsupported
                For a load that makes no sense or that the model does not hold for.
                With a hardness also for a load smaller than one before.
        OutOfMemory
                For contact that fills so much of a large grid that it does not fit in memory.
        NotConverged, Stopped
                With the state that was reached as ``best``.
        """
    def sweep(
        self,
        *,
        force: Iterable[float] | None = None,
        approach: Iterable[float] | None = None,
        mean_pressure: Iterable[float] | None = None,
        mean_gap: Iterable[float] | None = None,
        steps: int | None = None,
        stop: StopToken | None = None,
    ) -> Iterator[ContactState]:
        """Solves for loads in their order: an iterator that yields each state as soon as it is known.

        Parameters
        ----------
        force, approach, mean_pressure, mean_gap : iterable of float
                Exactly one of them. Increasing loads are the fastest order, and the only one with a hardness. With
                ``steps`` the first and the last load.
        steps : int, optional
                Number of states, at least 2, which are equally spaced in the logarithm of the contact area between
            those of
                the two loads, to a twentieth of a step or as the cells allow. The scene has to compute the area. The
            loads
                between are found by two to three solves each.
        stop : threading.Event, optional
                As in `solve`.

        Yields
        ------
        ContactState
        """
    def advance(
        self,
        time: float = 0.0,
        *,
        force: float | None = None,
        approach: float | None = None,
        mean_pressure: float | None = None,
        mean_gap: float | None = None,
        tangential_force: float | Sequence[float] | NDArray[np.float64] | None = None,
        tangential_displacement: float | Sequence[float] | NDArray[np.float64] | None = None,
        stop: StopToken | None = None,
    ) -> ContactState:
        """Advances to the end of the next step of a path. A step that fails leaves the contact as it was.

        Parameters
        ----------
        time : float
                Time at the end of the step; it never decreases. With friction alone it has no influence.
        force, approach, mean_pressure, mean_gap : float
                Exactly one of them. ``mean_pressure`` is over Lx Ly, ``mean_gap`` for periodic boundaries. The first
                three may be negative with adhesion.
        tangential_force, tangential_displacement : float or (float, float), optional
                At most one of them: along x, or along x (columns) and along y (rows); no tangential force otherwise.
                A force is at most ``sliding_force``; at that the displacement is the least at which the contact
                slides.
        stop : threading.Event, optional
                As in `solve`.

        Returns
        -------
        ContactState

        Raises
        ------
        DomainError, OutOfRange, Unsupported
                For a load that makes no sense or that the model does not hold for.
        NotConverged, Stopped
                With the state that was reached as ``best``; beyond pull-off that is the last stable state.
        """
    def follow(
        self,
        time: float | Iterable[float] | None = None,
        *,
        force: float | Iterable[float] | None = None,
        approach: float | Iterable[float] | None = None,
        mean_pressure: float | Iterable[float] | None = None,
        mean_gap: float | Iterable[float] | None = None,
        tangential_force: float | Iterable[float] | Iterable[tuple[float, float]] | None = None,
        tangential_displacement: float | Iterable[float] | Iterable[tuple[float, float]] | None = None,
        stop: StopToken | None = None,
    ) -> Iterator[ContactState]:
        """Follows a path: an iterator that yields the state at the end of each step as soon as it is known.

        Where a step raises, the states yielded before remain, and the contact is at the end of the step before.

        Parameters
        ----------
        time : float or iterable of float
                Time at the end of each step.
        force, approach, mean_pressure, mean_gap : float or iterable of float
                Exactly one of them, as in `advance`.
        tangential_force, tangential_displacement : float, iterable of float or of (float, float), optional
                At most one of them, along x or along x and y. Iterables have one number, or two, for each step; a
                number alone is that of every step.
        stop : threading.Event, optional
                As in `solve`.

        Yields
        ------
        ContactState
        """
    def restart(self) -> None:
        """Forgets the loads and the path before: back to no contact at time 0."""
    def memory(self) -> bytes | None:
        """The memory of the loads so far, of a path or each by itself, as bytes.

        Together with the next load it determines the next state. `recall` of a contact of the same model, scene and
        seed continues from it with identical bits, also in another process of the same version on the same kind of
        processor.

        Returns
        -------
        bytes or None
                None for models without such a memory, whose paths must be followed anew.
        """
    def recall(self, memory: bytes) -> None:
        """Restores a contact of the same model, scene and seed to where it gave its `memory`.

        The states before that are not in the memory: `last` is None.

        Parameters
        ----------
        memory : bytes
                What `memory` gave.

        Raises
        ------
        ShapeError
                For bytes of another model or surface. The contact is then as after `restart`.
        """
    def _check_order(self, kind: str, values: list[float]) -> None: ...
    @property
    def _yields(self) -> bool: ...
    @property
    def normalisation(self) -> Normalisation:
        """Normalisation: that of this surface."""
    @property
    def best(self) -> ContactState | None:
        """ContactState or None: the best state of the last solve that a signal such as Ctrl-C interrupted."""
    @property
    def last(self) -> ContactState | None:
        """ContactState or None: the state at the end of the last solve or step that was complete, where the next
        step begins; None before the first, and after a solve that failed.

        It says where the contact stands after a step that failed, or that a signal such as Ctrl-C
        interrupted.
        """

@final
class Surface:
    """The surface in contact."""

@final
class Scene:
    """Everything physical about one contact problem."""

@final
class Model:
    """A model of contact, which relates force, approach and stiffness."""
    @property
    def name(self) -> str:
        """Name of the model, as in scenes."""
    @property
    def sources(self) -> list[tuple[str, str]]:
        """Publications that it is built on: (citation, what is taken from it)."""
    @property
    def supports(self) -> dict[str, tuple[str, ...]]:
        """Its abilities, in words."""
    def prepare(self, scene: Scene, seed: int) -> Contact: ...

@final
class SceneFile:
    """A scene file: the surface, the material, the effects, the loads and the requested outputs.

    Two of them are equal where their texts are, and the folders from which relative paths count.
    """
    @staticmethod
    def read(path: str | PathLike[str]) -> SceneFile:
        """Reads a file.

        Parameters
        ----------
        path : str or path-like
                The file; relative paths in it count from its folder.

        Returns
        -------
        SceneFile
        """
    @staticmethod
    def from_toml(text: str, *, directory: str | PathLike[str] = ..., name: str = ...) -> SceneFile:
        """Reads a text.

        Parameters
        ----------
        text : str
                What a file of a scene holds.
        directory : str or path-like
                The folder from which relative paths count; the current one by default.
        name : str
                What the scene is called in titles.

        Returns
        -------
        SceneFile
        """
    @staticmethod
    def from_dict(tables: Mapping[str, Any], *, directory: str | PathLike[str] = ..., name: str = ...) -> SceneFile:
        """Makes a scene of its tables, with the keys and values of a text.

        Parameters
        ----------
        tables : dict
                The tables by their names, such as ``scene``, ``effects`` and ``outputs``.
        directory : str or path-like
                The folder from which relative paths count; the current one by default.
        name : str
                What the scene is called in titles.

        Returns
        -------
        SceneFile
        """
    def replaced(self, keys: Mapping[str, Any]) -> SceneFile:
        """Gives the same scene with other values of some keys.

        Parameters
        ----------
        keys : dict
                The values, each by its table and its name: ``scene.replaced({"scene.surface.cells": 64})``.

        Returns
        -------
        SceneFile
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def text(self) -> str:
        """str: the file itself."""
    @property
    def size(self) -> tuple[float, float]:
        """(float, float): sides (Lx, Ly) of its rectangle."""
    @property
    def models(self) -> list[str]:
        """list of str: its models."""
    def plan(self) -> str:
        """Says what will be computed, what will not and why, and what it will cost.

        Returns
        -------
        str
        """

def surface(kind: str, parameters: Mapping[str, Any]) -> Surface:
    """A surface of a kind."""

def height_map(of: Surface, cells: Cells, seed: int) -> HeightMap:
    """The height of each cell of a surface."""

def check_effects(of: Mapping[str, Any]) -> None:
    """Errors for effects whose numbers or words make no sense."""

def effect_keys() -> list[dict[str, str]]:
    """The keys of `[effects]`."""

def scene(
    surface: HeightMap | Surface,
    contact_modulus: float | None,
    bodies: Any,
    effects: Mapping[str, Any],
    outputs: Sequence[str] | None,
    conductance: tuple[str, float, float] | None,
) -> Scene:
    """A scene of the values of the Python class."""

def quantities() -> list[dict[str, str]]:
    """The quantities that are reported of a state, in the order of the columns of tables.

    Returns
    -------
    list of dict of str
            ``name``, ``words``, ``symbol`` (TeX), ``unit`` (SI; ``1`` for a pure number, ``-`` for text),
        ``meaning``,
            ``source``, ``asked_by`` (what brings it into a table), ``role`` (``answer``, ``normalised``,
        ``residual``,
            ``work`` or ``of_path``) and ``type`` in Python.
    """

def fields() -> list[dict[str, str]]:
    """The fields of states.

    Returns
    -------
    list of dict of str
            ``name``, ``words``, ``symbol``, ``unit``, ``meaning`` and ``shape``.
    """

def models() -> list[dict[str, Any]]:
    """The models of the library.

    Returns
    -------
    list of dict
            ``name`` (in scenes and tables), ``title``, ``class`` (in Python), ``about``, ``accuracy`` and
        ``has_options``.
    """

def combinations() -> list[dict[str, Any]]:
    """Which effects each model combines.

    Returns
    -------
    list of dict
            For every two effects of a model that a scene can have together: ``model`` (its name), ``effects`` (both
            in words), ``keys`` (both names in `Effects`), ``combined``, and ``reason`` (why not, or None).
    """

def model(name: str, options: Mapping[str, Any], inner: Model | None = None) -> Model:
    """A model by the name that scenes give it."""

def ensemble(
    model: Model,
    scene: Scene,
    loads: list[tuple[str, float]],
    seed: int,
    surfaces: int,
    progress: Callable[[int, int], object] | None,
    stop: StopToken | None = None,
) -> list[list[ContactState | Error]]:
    """The states of many surfaces under the same loads, surfaces in parallel.

    `progress` is called with the number of surfaces that are done and that of all.
    """

def picture(values: NDArray[np.float64], low: float, high: float) -> tuple[bytes, str]:
    """A PNG, the last row on top: viridis from `low` to `high`, values that are not finite grey. Up to 512 values
    along a side have a pixel each; of more, a pixel shows one of those that lie on it, so chosen that shares
    of areas, means and extrema are kept, and the text says so.
    """

def threads() -> int:
    """Number of threads that one solve, or one ensemble, may use.

    By default it is what the variable ``RAYON_NUM_THREADS`` of the environment says, or as many as there are
    processors.

    Returns
    -------
    int
    """

def set_threads(count: int) -> None:
    """Sets the number of threads; no bit of a result depends on it.

    Parameters
    ----------
    count : int
            At least 1.
    """

def surface_seed(seed: int, index: int) -> int:
    """Seed of surface number `index` of the ensemble of a master seed."""

def self_affine_map(
    surface: Surface,
    cells: Cells,
    seed: int,
    anisotropy: tuple[float, float] | None,
    weibull: float | None,
) -> HeightMap:
    """A self-affine map: isotropic, with a lay, with a distribution of heights."""

def twin(map: HeightMap, seed: int, rings: bool, keep_heights: bool) -> HeightMap:
    """An artificial twin of a map."""

def parameters(map: HeightMap, periodic: bool) -> dict[str, float | None]:
    """Parameters of ISO 25178-2 and of the derivatives; None where the map does not define one."""

def power_spectrum(
    map: HeightMap, direction: str, periodic: bool, per_decade: float, level: float
) -> dict[str, NDArray[np.float64]]:
    """A power spectral density with its band."""

def height_difference(
    map: HeightMap, periodic: bool, per_decade: float, level: float
) -> dict[str, NDArray[np.float64]]:
    """Half the mean square height difference over distances, with its band."""

def scale_dependence(
    map: HeightMap, of_curvature: bool, along_y: bool, periodic: bool, level: float
) -> dict[str, NDArray[np.float64]]:
    """Rms slope or curvature over distances along an axis, with its band."""

def fit_spectrum(map: HeightMap, periodic: bool, instrument: float | None) -> dict[str, Any]:
    """The fit of a self-affine spectrum: each quantity as (value, low, high), None where there is only a bound."""

def leakage(
    gap: NDArray[np.float64],
    cell: tuple[float, float],
    along_y: bool,
    repeats: tuple[bool, bool],
    tolerance: float,
    continuum: bool,
) -> dict[str, Any]:
    """Flow between opposite edges."""

def film_conductance(
    gap: NDArray[np.float64],
    cell: tuple[float, float],
    resistivities: tuple[float, float],
    repeats: tuple[bool, bool],
    tolerance: float,
) -> dict[str, Any]:
    """Conduction from one body to the other, through the contact and a film in the gap."""

def flow_rate(lower: float, upper: float, pressure_drop: float, viscosity: float) -> tuple[float, float]:
    """The bounds of the flow of a fluid under a pressure drop, of those of the conductance."""

def percolation(
    gap: NDArray[np.float64], cell: tuple[float, float], along_y: bool, repeats: tuple[bool, bool], g_min: float
) -> dict[str, Any]:
    """What leads from edge to edge."""

def stress_at_depths(load: Mapping[str, Any], depths: list[float]) -> NDArray[np.float64]:
    """The stress at the centres of all cells, `[component, depth, row, column]`."""

def stress_at_points(load: Mapping[str, Any], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The stress at points, `[component, point]`."""

def largest_von_mises(load: Mapping[str, Any], depths: list[float]) -> dict[str, Any]:
    """The largest equivalent stress of von Mises, its depth, its column and row, its place, and the stress there."""

def von_mises(stress: NDArray[np.float64]) -> tuple[NDArray[np.float64], int | None]:
    """The equivalent stress of von Mises of stresses `[component, stress]`, and the number of the first one that no
    finite
    number gives.
    """

def read_surface(
    path: Path, options: Mapping[str, Any], content: bytes | None = None
) -> tuple[HeightMap, dict[str, Any], list[str], float | None]:
    """A surface of a file, or of its content: its map, what the file says, what was done to the map, from which
    distance
    on the tip lets heights be seen.
    """

def channels(path: Path, options: Mapping[str, Any], content: bytes | None = None) -> list[dict[str, Any]]:
    """Metadata of each channel of a file; of a channel that cannot be read beside others, `error`."""

def si(text: str) -> float:
    """A text with a unit in SI units."""

def write_surface(path: Path, map: HeightMap, metres: bool) -> None:
    """Writes a map by the ending of the file's name; lengths are in metres, or without a unit."""

def notes_of_python(notes: list[str]) -> list[str]:
    """Notes on the states of a scene, with remedies in the words of Python."""

def check_pressed_map(columns: int, rows: int) -> None:
    """``OutOfMemory`` where there is no room for the heights of a map as an array, in its file and in the solver.

    The solves are looked at when the scene is run.
    """

def press_scene(keys: list[tuple[str, Any, bool]], si: bool, path: Path) -> SceneFile:
    """The scene of a map that is pressed, of its keys in their order.

    Each has its value, and whether the numbers in it have units. The whole scene is in SI units, or in any.
    """

def run_scene(
    scene: SceneFile,
    out: Path,
    threads: int | None,
    fresh: bool,
    drawn_states: list[int] | None,
    progress: Callable[[int, int], object] | None,
    stop: StopToken | None = None,
) -> dict[str, Any]:
    """Runs a scene as the program does; the files, the summary and the counts by their names."""
