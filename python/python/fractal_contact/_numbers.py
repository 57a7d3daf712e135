"""Numbers of users: no texts, no truth values, no masked points, though some of them convert to a number."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ._errors import DomainError
from ._plain import pair

MOST = 2**64 - 1


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


Seed = int | np.random.Generator


def seed(value: Any) -> int:
    """The seed of a surface: a whole number, or one that is drawn from a generator of numpy."""
    if isinstance(value, np.random.Generator):
        return int(value.integers(0, MOST, dtype=np.uint64, endpoint=True))
    return _whole(value, "seed", 0, "a whole number from 0 to 2^64 - 1, or a numpy.random.Generator")


def index(value: Any) -> int:
    """The number of a surface of an ensemble."""
    return _whole(value, "index", 0, "a whole number from 0 to 2^64 - 1")


def count(value: Any, name: str, least: int = 0) -> int:
    """A whole number of at least `least`."""
    return _whole(value, name, least, f"a whole number >= {least} and < 2^64")


def _whole(value: Any, name: str, least: int, expected: str) -> int:
    known = not isinstance(value, bool | np.bool_) and value is not np.ma.masked
    try:
        found = operator.index(value) if known else None
    except TypeError:
        found = None
    if found is None:
        raise TypeError(f"{name} is {value!r}: expected {expected}")
    if not least <= found <= MOST:
        error = DomainError(f"{name} = {found}: expected {expected}")
        error.quantity, error.value, error.expected = name, float(max(-MOST, min(found, MOST))), expected
        raise error
    return found


def cells(value: Any) -> int | tuple[int, int]:
    """Columns, or columns and rows."""
    given = pair(value)
    if isinstance(given, tuple):
        if len(given) != 2:
            raise TypeError(f"cells is {value!r}: expected a whole number or two, along x and along y")
        return count(given[0], "cells[0]"), count(given[1], "cells[1]")
    return count(given, "cells")


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
