"""The exceptions; each holds the numbers that its message names."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._core import ContactState


class Error(Exception):
    """What can go wrong between a scene and a state."""


class DomainError(Error, ValueError):
    """A number lies outside the range of meaningful values.

    Attributes
    ----------
    quantity : str
        The quantity.
    value : float
        The value found.
    expected : str
        What was expected instead.
    """

    quantity: str
    value: float
    expected: str


def domain_error(quantity: str, value: float, expected: str) -> DomainError:
    """The error of a number, with what it names."""
    error = DomainError(f"{quantity} = {value:g}: expected {expected}")
    error.quantity, error.value, error.expected = quantity, value, expected
    return error


class ShapeError(Error, ValueError):
    """An array does not have the expected number of values; attributes as of `DomainError`."""

    quantity: str
    value: int
    expected: str


class Unsupported(Error):
    """The model does not support this surface, effect, load or output.

    Attributes
    ----------
    model : str
        Name of the model.
    what : str
        What was requested of it.
    able : tuple of str
        Names of the models that can do everything that a refused scene requests; they may still refuse what depends on
        several things together, or on numbers.
    """

    model: str
    what: str
    able: tuple[str, ...] = ()


class OutOfRange(Error, ValueError):
    """A load lies outside the range in which the model holds.

    Attributes
    ----------
    quantity : str
        The quantity that left its range.
    value, low, high : float
        The value that was prescribed or reached, and the ends of the range.
    """

    quantity: str
    value: float
    low: float
    high: float


class OutOfMemory(Error, MemoryError):
    """Something does not fit in memory; the work was not begun.

    Attributes
    ----------
    what : str
        What it is for, with its size in cells, elements or surfaces.
    needed : float
        Bytes that it needs, approximately.
    available : float or None
        Bytes that are available below the limits of the process and its control group.
    """

    what: str
    needed: float
    available: float | None


class NotConverged(Error):
    """The solver stopped before its tolerance was met.

    Attributes
    ----------
    best : ContactState
        The best state reached, with its certificate: evidence, not an answer. Beyond pull-off the last stable state of
        the path, whose ``branch`` says on which branch it lies.
    """

    best: ContactState


class Stopped(Error):
    """The solve was stopped.

    Attributes
    ----------
    best : ContactState or None
        The best state so far. It has no stiffness, and no conductance or error that follows from one.
    finished : dict
        For an ensemble: the states of the surfaces that were finished, by their number.
    """

    best: ContactState | None
    finished: dict[int, list[ContactState | Error]]


class SceneError(Error, ValueError):
    """A mistake in a scene file; the message shows the place."""


class ReadError(Error, ValueError):
    """A file has no surface that can be read, or cannot contain one; a refusal by the system is an `OSError`."""
