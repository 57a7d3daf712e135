"""Arrays of users as the compiled part takes them."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import HeightMap
from ._errors import DomainError, ShapeError


def heights(values: ArrayLike, undefined: str) -> tuple[NDArray[np.float64], bool]:
    """Two-dimensional C-ordered doubles, and whether NaN in them are undefined points."""
    if undefined not in ("error", "no_contact"):
        raise ValueError(f'undefined is {undefined!r}: expected "error" or "no_contact"')
    masked = np.ma.isMaskedArray(values)
    mask = np.ma.getmaskarray(np.ma.asarray(values)) if masked else None
    array = np.asarray(np.ma.getdata(values) if masked else values)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"heights are of the type {array.dtype}: expected real numbers")
    if array.ndim != 2:
        error = ShapeError(f"heights have {array.ndim} dimensions: expected 2, [row, column]")
        error.quantity, error.value, error.expected = "dimensions of heights", array.ndim, "2"
        raise error
    if array.size == 0:
        error = ShapeError(f"heights have the shape {array.shape}: expected at least one cell")
        error.quantity, error.value, error.expected = "cells", 0, "at least 1"
        raise error
    found = np.ascontiguousarray(array, dtype=np.float64)
    if mask is not None and mask.any():
        found = np.where(mask, np.nan, found)
        if undefined == "error" and np.isnan(found[~mask]).any():
            raise _undefined(found, ~mask)
        return found, True
    if undefined == "no_contact":
        return found, True
    if np.isnan(found).any():
        raise _undefined(found, np.ones(found.shape, dtype=bool))
    return found, False


def _undefined(found: NDArray[np.float64], among: NDArray[np.bool_]) -> DomainError:
    row, column = np.argwhere(np.isnan(found) & among)[0]
    error = DomainError(
        f"heights[{row}, {column}] is NaN: expected a finite number; mark undefined points that cannot touch by "
        'undefined="no_contact" or a masked array'
    )
    error.quantity, error.value = f"heights[{row}, {column}]", float("nan")
    error.expected = "a finite number"
    return error


def combined(map_: HeightMap, other: Any, operation: str, reflected: bool) -> Any:
    """The map added to a number or an array of its shape, and so on; what is neither is left to the other operand."""
    if isinstance(other, HeightMap | str | bytes | bool | complex) or (reflected and operation == "divide"):
        return NotImplemented
    if np.ma.isMaskedArray(other):
        # A masked array would take the heights for its own operation.
        raise TypeError("a map and a masked array: expected an array of numbers")
    array = np.asarray(other)
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
    return HeightMap(heights, map_.size, undefined="no_contact" if undefined else "error")


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
