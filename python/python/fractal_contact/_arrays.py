"""Arrays of users as the compiled part takes them."""

from __future__ import annotations

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
        f"heights[{row}, {column}] is NaN: expected a finite number; undefined points that cannot touch are said by "
        'undefined="no_contact" or a masked array'
    )
    error.quantity, error.value = f"heights[{row}, {column}]", float("nan")
    error.expected = "a finite number"
    return error


def restored(values: NDArray[np.float64], size: tuple[float, float], undefined: str) -> HeightMap:
    """Unpickles a map."""
    return HeightMap(values, size, undefined=undefined)
