"""Numbers of users: no texts, no truth values, no masked points, though some of them convert to a number."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


def number(value: Any, name: str) -> float:
    """A real number as a float."""
    if type(value) is float:
        return value
    kind = getattr(getattr(value, "dtype", None), "kind", "f")
    known = hasattr(value, "__float__") or hasattr(value, "__index__")
    if not known or isinstance(value, bool | complex) or kind not in "fiuO" or value is np.ma.masked:
        help_ = "; fc.si makes one of a text with a unit" if isinstance(value, str) else ""
        raise TypeError(f"{name} is {value!r}: expected a real number{help_}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} is beyond the range of a float") from None


def is_iterable(values: Any) -> bool:
    """Whether there are values to take one by one."""
    return isinstance(values, Iterable) and not (isinstance(values, np.ndarray) and values.ndim == 0)


def numbers(values: Any, name: str) -> list[float]:
    """The numbers of any iterable."""
    if not is_iterable(values) or isinstance(values, str | bytes | bytearray | Mapping):
        raise TypeError(f"{name} is {values!r}: expected an iterable of numbers, such as a list or an array")
    if isinstance(values, np.ndarray) and values.ndim > 1:
        raise ValueError(f"{name} has the shape {values.shape}: expected one dimension")
    if type(values) is np.ndarray and values.dtype.kind in "fiu":
        return [float(value) for value in values.tolist()]
    return [number(value, f"{name}[{i}]") for i, value in enumerate(values)]


def steps(values: Any, name: str, *, pairs: bool) -> float | list[float] | list[tuple[float, float]]:
    """A number for all steps, or one for each; where there may be pairs, also two for each."""
    if not is_iterable(values):
        return number(values, name)
    if not pairs or isinstance(values, str | bytes | bytearray | Mapping):
        return numbers(values, name)
    found = list(values)
    if not any(is_iterable(value) for value in found):
        return numbers(found, name)
    rows = [numbers(value, f"{name}[{i}]") for i, value in enumerate(found)]
    if any(len(row) != 2 for row in rows):
        raise ValueError(f"{name} has {sorted({len(row) for row in rows})} components: expected two for each step")
    return [(x, y) for x, y in rows]
