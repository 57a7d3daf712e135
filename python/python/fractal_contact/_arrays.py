"""Arrays of users as the compiled part takes them."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import HeightMap
from ._errors import DomainError, ShapeError, domain_error
from ._numbers import number
from ._plain import pair

# Names of dimensions along x and along y, in small letters.
NAMES = {"x": ("x", "column", "columns", "col"), "y": ("y", "row", "rows")}


def by_name(values: Any) -> tuple[Any, str | None]:
    """An array whose dimensions have names as ``[row, column]``, and what was done; any other as it is, and None.

    Names that a library gave for want of better ones (``dim_0``) say nothing: their order is that of an array.
    """
    names = getattr(values, "dims", None)
    if not isinstance(names, tuple) or len(names) != 2 or not hasattr(values, "transpose"):
        return values, None
    if all(isinstance(name, str) and name.startswith("dim_") for name in names):
        return values, None
    axes = [axis for name in names for axis, known in NAMES.items() if str(name).lower() in known]
    if sorted(axes) != ["x", "y"]:
        raise ValueError(
            f"the dimensions of the array are {names[0]!r} and {names[1]!r}: expected x and y, which say which axis is "
            "which; array.rename(...) names them, and array.values has none, for [row, column]"
        )
    if axes == ["y", "x"]:
        named, done = values, f"as given: rows along {names[0]!r}, columns along {names[1]!r}"
    else:
        named, done = (
            values.transpose(names[1], names[0]),
            (
                f"transposed by the names of the dimensions: given as ({names[0]!r}, {names[1]!r}), "
                f"rows are along {names[1]!r} and columns along {names[0]!r}"
            ),
        )
    for name in names:
        if falls(named, name):
            named = named[{name: slice(None, None, -1)}]
            done += f"; turned round along {name!r}, whose coordinates fall"
    return named, done


def falls(values: Any, name: Any) -> bool:
    """Whether the coordinates along a dimension fall; those that are in no equal steps are an error."""
    step = step_along(values, name)
    return step is not None and step < 0.0


def step_along(values: Any, name: Any) -> float | None:
    """The step of the coordinates along a dimension, None without coordinates; unequal steps are an error."""
    coordinates = getattr(values, "coords", {})
    places = np.asarray(coordinates[name]) if name in coordinates else np.empty(0)
    if places.ndim != 1 or places.size < 2 or places.dtype.kind not in "iuf":
        return None
    steps = np.diff(places.astype(np.float64))
    mean = steps.mean()
    # Coordinates in files are often rounded.
    if not (np.abs(steps - mean) <= 0.01 * abs(mean)).all() or mean == 0:
        raise ValueError(
            f"the coordinates along {name!r} are not in equal steps: expected a regular grid; "
            "array.drop_vars(...) leaves them out"
        )
    return float(mean)


def _two_dimensional(array: NDArray[Any], name: str) -> None:
    """An error for what is no map of real numbers."""
    if array.dtype.kind not in "fiub":
        raise TypeError(f"the array {name} is of the type {array.dtype}: expected real numbers")
    if array.ndim != 2:
        error = ShapeError(f"the array {name} has {array.ndim} dimensions: expected 2, [row, column]")
        error.quantity, error.value, error.expected = f"dimensions of {name}", array.ndim, "2"
        raise error
    if array.size == 0:
        error = ShapeError(f"the array {name} has the shape {array.shape}: expected at least one cell")
        error.quantity, error.value, error.expected = "cells", 0, "at least 1"
        raise error


def field(values: ArrayLike, name: str, *, undefined: float = np.nan) -> NDArray[np.float64]:
    """Two-dimensional C-ordered doubles, ``[row, column]``, with `undefined` where the array is masked.

    What makes no sense in it is refused by the compiled part, which knows the place.
    """
    named, _ = by_name(values)
    array = np.asarray(np.ma.getdata(named) if np.ma.isMaskedArray(named) else named)
    _two_dimensional(array, name)
    found = np.ascontiguousarray(array, dtype=np.float64)
    mask = np.ma.getmask(named) if np.ma.isMaskedArray(named) else np.ma.nomask
    return np.where(mask, undefined, found) if np.any(mask) else found


def sides(cell: Any, values: Any) -> tuple[float, float] | None:
    """Sides (dx, dy) of a cell: as given, of a map, or the steps of named coordinates; None where none says so."""
    if cell is not None:
        given = pair(cell)
        both = given if isinstance(given, tuple) else (given, given)
        if len(both) != 2:
            raise ValueError(f"cell is {cell!r}: expected the side of a square or two sides, (dx, dy)")
        names = ("cell[0]", "cell[1]") if isinstance(given, tuple) else ("cell", "cell")
        for side, name in zip(both, names, strict=True):
            if not 0.0 < number(side, name) < np.inf:
                raise domain_error(name, float(side), "a finite number > 0")
        return number(both[0], names[0]), number(both[1], names[1])
    if isinstance(values, HeightMap):
        return values.cell
    axes = {axis: name for name in getattr(values, "dims", ()) for axis in NAMES if str(name).lower() in NAMES[axis]}
    steps = [step_along(values, axes[axis]) for axis in NAMES if axis in axes]
    known = [abs(step) for step in steps if step is not None]
    if len(known) == 1:
        raise TypeError("cell is missing: the array has coordinates along one of its dimensions alone")
    return (known[0], known[1]) if known else None


def heights(values: ArrayLike, undefined: str) -> tuple[NDArray[np.float64], bool, str | None]:
    """Two-dimensional C-ordered doubles, whether NaN in them are undefined points, and what was done with the axes."""
    if undefined not in ("error", "no_contact"):
        raise ValueError(f'undefined is {undefined!r}: expected "error" or "no_contact"')
    named, axes = by_name(values)
    masked = np.ma.isMaskedArray(named)
    mask = np.ma.getmaskarray(np.ma.asarray(named)) if masked else None
    array = np.asarray(np.ma.getdata(named) if masked else named)
    _two_dimensional(array, "heights")
    found = np.ascontiguousarray(array, dtype=np.float64)
    if mask is not None and mask.any():
        found = np.where(mask, np.nan, found)
        if undefined == "error" and np.isnan(found[~mask]).any():
            raise _undefined(found, ~mask)
        return found, True, axes
    if undefined == "no_contact":
        return found, True, axes
    if np.isnan(found).any():
        raise _undefined(found, np.ones(found.shape, dtype=bool))
    return found, False, axes


def _undefined(found: NDArray[np.float64], among: NDArray[np.bool_]) -> DomainError:
    row, column = np.argwhere(np.isnan(found) & among)[0]
    error = DomainError(
        f"heights[{row}, {column}] is NaN: expected a finite number; mark undefined points that cannot touch by "
        'undefined="no_contact" or a masked array'
    )
    error.quantity, error.value = f"heights[{row}, {column}]", float("nan")
    error.expected = "a finite number"
    return error


def checked_map(heights: Any) -> HeightMap:
    """A map, where an array would lack its size."""
    if isinstance(heights, HeightMap):
        return heights
    raise TypeError(
        f"heights is of the type {type(heights).__name__}: expected a HeightMap, which has a size; "
        "fc.HeightMap(array, size=...) makes one of an array, fc.read_surface(...).heights is that of a file"
    )


def combined(map_: HeightMap, other: Any, operation: str, reflected: bool) -> Any:
    """The map added to a number or an array of its shape, and so on; what is neither is left to the other operand."""
    if isinstance(other, HeightMap | str | bytes | bool | complex) or (reflected and operation == "divide"):
        return NotImplemented
    if np.ma.isMaskedArray(other):
        # A masked array would take the heights for its own operation.
        raise TypeError("a map and a masked array: expected an array of numbers")
    array = np.asarray(by_name(other)[0])
    if array.dtype.kind not in "fiu":
        return NotImplemented
    if array.ndim and array.shape != map_.shape:
        error = ShapeError(f"an array of the shape {array.shape} and a map of the shape {map_.shape}")
        error.quantity, error.value, error.expected = "values", array.size, f"{map_.shape}"
        raise error
    if np.isnan(array).any():
        error_ = DomainError("NaN and a map: expected finite numbers")
        error_.quantity, error_.value, error_.expected = "values", float("nan"), "finite numbers"
        raise error_
    operands = (array, map_.heights) if reflected else (map_.heights, array)
    # What overflows, or is divided by 0, is refused with its place.
    with np.errstate(all="ignore"):
        heights = getattr(np, operation)(*operands)
    undefined = map_.undefined > 0
    if undefined and (np.isnan(heights) != np.isnan(map_.heights)).any():
        raise DomainError("a height that is no number: 0 divided by 0")
    made = HeightMap(heights, map_.size, undefined="no_contact" if undefined else "error")
    return made if map_.filled is None else HeightMap._with_origin(made, None, map_.filled)


def operand(other: Any) -> Any:
    """What a map is compared with, as arrays are."""
    return other.heights if isinstance(other, HeightMap) else by_name(other)[0]


OPERATIONS: dict[Any, str] = {np.add: "add", np.subtract: "subtract", np.multiply: "multiply", np.divide: "divide"}


def ufunc(
    map_: HeightMap, function: np.ufunc, method: str, inputs: tuple[Any, ...], options: dict[str, Any] | None
) -> Any:
    """A function of numpy of a map and others: an operation of maps where it is one, or that of the arrays."""
    operation = OPERATIONS.get(function)
    if method == "__call__" and not options and operation is not None:
        first, second = inputs
        if isinstance(first, HeightMap) and isinstance(second, HeightMap) and operation in ("add", "subtract"):
            return first + second if operation == "add" else first - second
        found = combined(map_, second if first is map_ else first, operation, first is not map_)
        if found is not NotImplemented:
            return found
        raise TypeError(f"np.{function.__name__} of a map and {type(second if first is map_ else first).__name__}")
    if method == "__call__" and not options and function in (np.negative, np.positive):
        return -map_ if function is np.negative else +map_
    return getattr(function, method)(*map(operand, inputs), **(options or {}))


def plot(map_: HeightMap, ax: Any = None, **options: Any) -> Any:
    """Draws a map with matplotlib."""
    ax = importlib.import_module("matplotlib.pyplot").gca() if ax is None else ax
    image = ax.imshow(map_.heights, **{"extent": map_.extent, "origin": "lower", **options})
    ax.set(xlabel="x", ylabel="y")
    ax.figure.colorbar(image, ax=ax, label="height")
    return image


def to_xarray(map_: HeightMap) -> Any:
    """The map with its coordinates."""
    xarray = importlib.import_module("xarray")
    return xarray.DataArray(np.array(map_), coords={"y": map_.y, "x": map_.x}, dims=("y", "x"), name="height")
