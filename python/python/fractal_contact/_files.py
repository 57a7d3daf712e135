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
    """A surface that was read from a file."""

    heights: HeightMap
    """The map, in metres where the file has a unit of length."""
    metadata: dict[str, Any]
    """Statements of the file: format, channel, name, shape, size, unit, undefined, notes, text."""
    steps: list[str]
    """Steps of the preprocessing of the heights, in order."""
    reliable_from: float | None
    """Lateral resolution that the tip allows: heights are reliable from this distance on; None where it is unknown."""


def read_surface(path: str | PathLike[str], **options: Unpack[ReadOptions]) -> ReadSurface:
    """Reads a surface: files of instruments and programs, NPY, text.

    Parameters
    ----------
    path : str or path-like
        The file; its format is recognised by its content.
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
        With the problem in the file, or the reason why it gives no map.
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
    """Metadata of each channel of a file; ``{"error": ...}`` for a channel that cannot be read beside others."""
    return _core.channels(Path(path), _words(options))


def write_surface(path: str | PathLike[str], heights: HeightMap, *, metres: bool = True) -> None:
    """Writes a map in the format of the ending of its name: .npy, .txt, .xyz, .vti, .h5, .x3p, .gwy or .nc."""
    _core.write_surface(Path(path), heights, metres)


@dataclass(frozen=True)
class SceneOutcome:
    """Results of a run of a scene."""

    files: list[Path]
    """Paths of the files in the order in which they were written, ``report.html`` among them."""
    summary: str
    """The states as a short table."""
    notes: list[str]
    """Notes on possible errors that the numbers alone do not show."""
    requested: int
    """Number of states that were requested."""
    states: int
    """Number of states in ``results.csv``."""
    failed: int
    """Number of these that were refused or did not reach their tolerance."""
    kept: int
    """Number of these that were taken from an earlier run."""
    seconds: float
    """Wall-clock time in seconds."""
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
    """Runs a scene as the program does, with the same files and the same numbers. An interrupted run can be continued.

    Parameters
    ----------
    scene : SceneFile, str or Path
        The scene, or its file.
    out : str or Path
        Folder of the results.
    threads : int, optional
        Number of threads; that of `threads` by default.
    fresh : bool
        True to compute stored results again.
    drawn_states : iterable of int, optional
        Numbers of the loads or steps, from 0, whose fields become pictures, in files and in the report; by default
        those that the scene names in ``[outputs]``, or all.
    progress : callable, optional
        Called with the relative cost that is done and that of all. Where the scene requests an ``accuracy``, each
        grid that is tried for it counts by itself before the run.
    stop : threading.Event, optional
        Set by another thread, it ends the run with `Stopped`; the next run continues from the finished parts.
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
