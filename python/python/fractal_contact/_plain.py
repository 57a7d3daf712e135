"""Values of users as plain ones, to compare, copy and pickle."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np


class FrozenMapping(Mapping[str, Any]):
    """A mapping that does not change, so that what holds it has a hash. It equals a dict of the same items."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, Any]) -> None:
        self._items = dict(items)

    def __getitem__(self, key: str) -> Any:
        return self._items[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __hash__(self) -> int:
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        return repr(self._items)

    def __reduce__(self) -> tuple[type[FrozenMapping], tuple[dict[str, Any]]]:
        return FrozenMapping, (self._items,)


def frozen(value: Any) -> Any:
    """Mappings, lists and arrays as ones that do not change, whatever is in them; what is nested without end stays."""
    return _plain(value, 8)


def _plain(value: Any, depth: int) -> Any:
    if depth > 0 and isinstance(value, Mapping):
        return FrozenMapping({key: _plain(item, depth - 1) for key, item in value.items()})
    if isinstance(value, np.ndarray) and not np.ma.isMaskedArray(value):
        value = value.tolist()
    if depth > 0 and isinstance(value, list | tuple):
        return tuple(_plain(item, depth - 1) for item in value)
    return value


def same(one: Any, other: Any) -> bool:
    """Whether two values are the same, arrays and maps as wholes: one truth value."""
    if hasattr(one, "equals") and type(one) is type(other):
        return bool(one.equals(other))
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind in "fc")
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(same(value, other[key]) for key, value in one.items())
    if isinstance(one, list | tuple) and type(one) is type(other):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other)


def same_fields(one: Any, other: Any, but: Collection[str] = ()) -> bool:
    """The same for the fields of two dataclasses of one class, without those of some names."""
    names = [field.name for field in fields(one) if field.name not in but]
    return all(same(getattr(one, name), getattr(other, name)) for name in names)


Function = TypeVar("Function", bound=Callable[..., Any])


def with_names(options: type) -> Callable[[Function], Function]:
    """Shows the names of the options of a function, which ``**options`` would hide from `help` and completion."""

    def named_(function: Function) -> Function:
        signature = inspect.signature(function)
        known = [one for one in signature.parameters.values() if one.kind is not one.VAR_KEYWORD]
        names = [name for name in options.__annotations__ if name not in signature.parameters]
        more = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in names]
        setattr(function, "__signature__", signature.replace(parameters=[*known, *more]))  # noqa: B010
        return function

    return named_


def check_names(function: Callable[..., Any], options: Collection[str]) -> None:
    """Refuses options that the function, which shows its names, does not have, in the words of Python."""
    known = [
        one.name
        for one in inspect.signature(function).parameters.values()
        if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)
    ]
    for name in options:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            help_ = f". Did you mean {near[0]!r}?" if near else ""
            raise TypeError(f"{function.__name__}() got an unexpected keyword argument {name!r}{help_}")


def pair(value: Any) -> Any:
    """Two values of a list or an array as a tuple, one of an array as a number; anything else as it is."""
    if isinstance(value, np.ndarray) and not np.ma.isMaskedArray(value):
        value = value.tolist()
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
