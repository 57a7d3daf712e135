"""Surfaces and scenes from files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import HeightMap, SceneFile
from ._models import StopToken
from ._numbers import count, is_iterable
from ._plain import named
from .typing import ReadOptions


@dataclass(frozen=True)
class ReadSurface:
    """A surface of a file."""

    heights: HeightMap
    """The map, in metres where the file has a unit of length."""
    metadata: dict[str, Any]
    """What the file says: format, channel, name, shape, size, unit, undefined, notes, text."""
    steps: list[str]
    """What was done to the heights, in order."""
    reliable_from: float | None
    """From which distance on the tip lets heights be seen, where it is known."""


def read_surface(path: str | PathLike[str], **options: Unpack[ReadOptions]) -> ReadSurface:
    """Reads a surface: files of instruments and programs, NPY, text.

    Parameters
    ----------
    path : str or path-like
        The format is told by the content.
    **options
        As in ``[scene.surface]`` of a scene (`fractal_contact.typing.ReadOptions`): ``channel``, ``format``, ``unit``,
        ``lateral_unit``, ``size``, ``cell``, ``height_scale``, ``decimal``, ``axes``, ``border``, ``missing``,
        ``skip_lines``, ``crop``, ``align_lines``, ``scars``, ``outliers``, ``tip_radius``, ``undefined``, ``fill``,
        ``detrend``, ``filter_across``, ``cells``, ``rows``, ``mirror``, ``rotate``, ``window``. Lengths are texts with
        a unit, such as ``cell="0.5 um"``.

    Raises
    ------
    OSError
        Where the system refuses, such as FileNotFoundError.
    ReadError
        With what is wrong with the file or stands in the way of a map.
    """
    return ReadSurface(*_core.read_surface(Path(path), _words(options)))


def _words(options: ReadOptions) -> dict[str, Any]:
    """The options as the program takes them: pairs of lengths and the window of a crop as texts."""
    given: dict[str, Any] = dict(options)
    crop = given.get("crop")
    if isinstance(crop, Mapping):
        window = named(crop, "key of crop", ["row", "column", "rows", "columns", "cells"])
        cells = window.pop("cells", None)
        window = {"row": 0, "column": 0, **({} if cells is None else {"rows": cells, "columns": cells}), **window}
        if len(window) != 4:
            raise TypeError(f"crop is {crop!r}: expected rows and columns, or cells, and where they begin: row, column")
        given["crop"] = ",".join(str(window[key]) for key in ("row", "column", "rows", "columns"))
    for name in ("size", "cell"):
        lengths = given.get(name)
        if isinstance(lengths, list | tuple) and len(lengths) == 2:
            given[name] = f"{lengths[0]} x {lengths[1]}"
    return given


def si(text: str) -> float:
    """A number with a unit, in SI units.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> fc.si("115 GPa"), fc.si("1 mm")
    (115000000000.0, 0.001)
    """
    return _core.si(text)


def channels(path: str | PathLike[str], **options: Unpack[ReadOptions]) -> list[dict[str, Any]]:
    """What a file says of each of its channels; ``{"error": ...}`` of one that is not read beside others."""
    return _core.channels(Path(path), _words(options))


def write_surface(path: str | PathLike[str], heights: HeightMap, *, metres: bool = True) -> None:
    """Writes a map by the ending of the name: .npy, .txt, .xyz, .vti, .h5, .x3p, .gwy or .nc."""
    _core.write_surface(Path(path), heights, metres)


@dataclass(frozen=True)
class SceneOutcome:
    """What a run of a scene gave."""

    files: list[Path]
    """In the order written, ``report.html`` among them."""
    summary: str
    """The states as a short table."""
    notes: list[str]
    """What an answer may hide."""
    requested: int
    """States asked for."""
    states: int
    """States in ``results.csv``."""
    failed: int
    """How many of these were refused or did not reach their tolerance."""
    kept: int
    """How many an earlier run had kept."""
    seconds: float
    """Wall-clock time."""
    results: dict[str, NDArray[Any]] = field(repr=False)
    """Columns of ``results.csv``: whole numbers, numbers with NaN where a state has none, or texts."""


def run_scene(
    scene: SceneFile | str | PathLike[str],
    out: str | PathLike[str],
    *,
    threads: int | None = None,
    fresh: bool = False,
    drawn_states: Iterable[int] | None = None,
    progress: Callable[[int, int], object] | None = None,
    stop: StopToken | None = None,
) -> SceneOutcome:
    """Runs a scene as the program does: the same files with the same numbers; an interrupted run goes on.

    Parameters
    ----------
    scene : SceneFile, str or Path
        The scene, or its file.
    out : str or Path
        Folder of the results.
    threads : int, optional
        All of `threads` by default.
    fresh : bool
        Whether stored results are computed again.
    drawn_states : iterable of int, optional
        Numbers of the loads or steps, from 0, whose fields become pictures, in files and in the report; by default
        those that the scene names in ``[outputs]``, or all.
    progress : callable, optional
        Called with the relative cost that is done and that of all.
    stop : threading.Event, optional
        Set by another thread, it ends the run with `Stopped`; the next run goes on from what was finished.
    """
    if threads is not None:
        threads = count(threads, "threads", 1)
    drawn = drawn_states
    if drawn is not None:
        if not is_iterable(drawn) or isinstance(drawn, str | bytes):
            raise TypeError(f"drawn_states is {drawn!r}: expected numbers of loads or steps, such as [3, 9]")
        drawn = [count(state, f"drawn_states[{i}]") for i, state in enumerate(drawn)]
    if not isinstance(scene, SceneFile):
        scene = SceneFile.read(Path(scene))
    found = _core.run_scene(scene, Path(out), threads, fresh, drawn, progress, stop)
    files = [Path(file) for file in found.pop("files")]
    results = {name: np.asarray(values) for name, values in found.pop("results").items()}
    return SceneOutcome(files=files, results=results, **found)
