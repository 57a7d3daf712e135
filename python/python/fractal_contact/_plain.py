"""Values of users as plain ones, to compare, copy and pickle."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def plain(value: Any) -> Any:
    """Mappings as dicts and arrays as lists, whatever is in them; what is nested without end stays as it is."""
    return _plain(value, 8)


def _plain(value: Any, depth: int) -> Any:
    if depth > 0 and isinstance(value, Mapping):
        return {key: _plain(item, depth - 1) for key, item in value.items()}
    if isinstance(value, np.ndarray) and not np.ma.isMaskedArray(value):
        return value.tolist()
    return value


def pair(value: Any) -> Any:
    """Two values of a list or an array as a tuple, one of an array as a number; anything else as it is."""
    value = _plain(value, 0)
    return tuple(value) if isinstance(value, list) else value


def listed(names: Sequence[str]) -> str:
    """Names as a list in words."""
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else "".join(names)


def named(values: Any, what: str, known: Sequence[str]) -> dict[str, Any]:
    """A mapping whose keys are among the known ones; the error names those."""
    if not isinstance(values, Mapping):
        raise TypeError(f"{values!r} is no mapping: expected some of {listed(known)}")
    for name in values:
        if name not in known:
            near = difflib.get_close_matches(str(name), known, 1)
            help_ = f"did you mean {near[0]}?" if near else f"there are {listed(known)}"
            raise TypeError(f"no {what} is called {name!r}: {help_}")
    return dict(values)
