"""Surfaces and scenes from files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO, Unpack

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import checked_map
from ._core import HeightMap, SceneFile
from ._models import StopToken
from ._numbers import count, is_iterable
from ._plain import check_names, named, same_fields, with_names
from .typing import PressOptions, ReadOptions


@dataclass(eq=False)
class ReadSurface:
    """A surface that was read from a file.

    Two of them compare with ``==`` as wholes, to one truth value.

    Parameters
    ----------
    heights : HeightMap
        The map, in metres where the file has a unit of length.
    metadata : dict
        Statements of the file: format, channel, name, shape, size, unit, undefined, notes, text.
    steps : list of str
        Steps of the preprocessing of the heights, in order.
    reliable_from : float or None
        Lateral resolution that the tip allows: heights are reliable from this distance on; None where it is unknown.
    """

    heights: HeightMap
    metadata: dict[str, Any]
    steps: list[str]
    reliable_from: float | None

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other) if isinstance(other, ReadSurface) else NotImplemented


Source = str | PathLike[str] | bytes | bytearray | memoryview | BinaryIO


def _source(source: Any) -> tuple[Path, bytes | None]:
    """The path of a file, or a name for it and its content."""
    if isinstance(source, bytes | bytearray | memoryview):
        return Path("bytes"), bytes(source)
    if hasattr(source, "read"):
        content = source.read()
        if not isinstance(content, bytes | bytearray | memoryview):
            raise TypeError(f"path is {source!r}, which gives {type(content).__name__}: open it in binary mode")
        name = getattr(source, "name", None)
        return Path(name) if isinstance(name, str) else Path("bytes"), bytes(content)
    return Path(source), None


@with_names(ReadOptions)
def read_surface(path: Source, **options: Unpack[ReadOptions]) -> ReadSurface:
    """Reads a surface: files of instruments and programs, NPY, text.

    Parameters
    ----------
    path : str, path-like, bytes or binary file
        The file; its format is recognised by its content. Bytes are the content of a file, as is what an open file or
        an `io.BytesIO` holds from its position on.
    channel : int or str, optional
        The channel of a file with several: its number from 0, or its name; the only one of heights by default.
    format, lateral_unit, height_scale, decimal, axes, border, missing, skip_lines : optional
        How the file is read where it does not say so itself: its format, the unit of x and y in a file of points, the
        height of one count such as ``"0.25 nm"``, ``"point"`` or ``"comma"``, the order of the axes, whether it has
        places in its first row and column, the number that marks an undefined point, and lines before the heights.
    crop : str or mapping, optional
        The part that is used: ``"centre"``, ``"defined"``, or ``{"row": 0, "column": 0, "cells": 256}``.
    align_lines, scars, outliers, tip_radius : optional
        Errors of scanning: how lines are shifted, from how many robust standard deviations on scars and outliers are
        removed, and the radius of the tip such as ``"10 nm"``.
    undefined, fill : str, optional
        ``undefined="no_contact"`` keeps undefined points, which cannot touch; ``fill`` gives them a height:
        ``"neighbours"``, ``"plane"``, or one such as ``"3 nm"``.
    filter_across : str, optional
        Cut-off wavelength of a low-pass filter across the lines.
    cells, rows : int, optional
        Numbers of columns and rows of larger cells over which the map is averaged.
    mirror, rotate, window : optional
        The axis that is reversed, the angle of a turn (0, 90, 180, 270), and ``"hann"`` for a taper towards the edges.
    unit : str, optional
        Unit of the heights, such as ``"nm"``.
    size, cell : str, optional
        Side of a square map or both sides, such as ``"2 mm x 1 mm"``, or of one of its cells.
    detrend : {"none", "mean", "plane", "quadric", "sphere", "cylinder"}, optional
        The trend of least squares that is subtracted from the heights; none by default.

    Returns
    -------
    ReadSurface
        The map, what the file says, and what was done to the heights.

    Raises
    ------
    OSError
        Where the system refuses, such as FileNotFoundError.
    ReadError
        With the problem in the file, or the reason why it gives no map.
    """
    check_names(read_surface, options)
    named, content = _source(path)
    return ReadSurface(*_core.read_surface(named, _words(options), content))


def _words(options: PressOptions) -> dict[str, Any]:
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
    """Converts a text with a unit into a number in SI units.

    Parameters
    ----------
    text : str
        A number and a unit, such as ``"115 GPa"``.

    Returns
    -------
    float
        The number in SI units.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> fc.si("115 GPa"), fc.si("1 mm")
    (115000000000.0, 0.001)
    """
    return _core.si(text)


@with_names(ReadOptions)
def channels(path: Source, **options: Unpack[ReadOptions]) -> list[dict[str, Any]]:
    """Reads what a file says of each of its channels, without the heights.

    Parameters
    ----------
    path : str, path-like, bytes or binary file
        As in `read_surface`.
    channel, format, lateral_unit, height_scale, decimal, axes, border, missing, skip_lines : optional
        As in `read_surface`.
    crop, align_lines, scars, outliers, tip_radius, undefined, fill, filter_across, cells, rows, mirror : optional
        Taken, and without influence.
    rotate, window : optional
        Taken, and without influence.
    unit, size, cell : str, optional
        As in `read_surface`.
    detrend : str, optional
        Taken, and without influence.

    Returns
    -------
    list of dict
        For each channel the metadata of `ReadSurface`; ``{"error": ...}`` for one that cannot be read beside others.
    """
    check_names(channels, options)
    named, content = _source(path)
    return _core.channels(named, _words(options), content)


def write_surface(path: str | PathLike[str], heights: HeightMap, *, metres: bool = True) -> None:
    """Writes a map in the format of the ending of its name.

    Parameters
    ----------
    path : str or path-like
        The file, with the ending .npy, .txt, .xyz, .vti, .h5, .x3p, .gwy or .nc.
    heights : HeightMap
        The map. A file of the ending .npy has its heights alone, and no size.
    metres : bool
        Whether its lengths are metres; otherwise they have no unit.
    """
    _core.write_surface(Path(path), checked_map(heights), metres)


@dataclass(eq=False)
class SceneOutcome:
    """Results of a run of a scene.

    Two of them compare with ``==`` as wholes, to one truth value.

    Parameters
    ----------
    files : list of Path
        Paths of the files in the order in which they were written, ``report.html`` among them.
    summary : str
        The states as a short table.
    notes : list of str
        Notes on possible errors that the numbers alone do not show.
    requested : int
        Number of states that were requested.
    states : int
        Number of states in ``results.csv``.
    failed : int
        Number of these that were refused or did not reach their tolerance.
    pulled_off : int
        Number of these that are the last stable state of a path that was pulled off; none of them counts as failed.
    kept : int
        Number of these that were taken from an earlier run.
    seconds : float
        Wall-clock time in seconds.
    results : dict of numpy.ndarray
        Columns of ``results.csv``: whole numbers, numbers with NaN where a state has none, or texts.
    """

    files: list[Path]
    summary: str
    notes: list[str]
    requested: int
    states: int
    failed: int
    pulled_off: int
    kept: int
    seconds: float
    results: dict[str, NDArray[Any]] = field(repr=False)

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other) if isinstance(other, SceneOutcome) else NotImplemented


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

    Returns
    -------
    SceneOutcome
        The columns of ``results.csv``, counts, notes and the paths of the files.
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
