"""Surfaces and scenes from files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import HeightMap, SceneFile


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


def read_surface(path: str | Path, **options: Any) -> ReadSurface:
    """Reads a surface: files of instruments and programs, NPY, text.

    Parameters
    ----------
    path : str or Path
        The format is told by the content.
    **options
        As in ``[scene.surface]`` of a scene: ``channel``, ``format``, ``unit``, ``lateral_unit``, ``size``, ``cell``,
        ``height_scale``, ``decimal``, ``axes``, ``border``, ``missing``, ``skip_lines``, ``crop``, ``align_lines``,
        ``scars``, ``outliers``, ``tip_radius``, ``undefined``, ``fill``, ``detrend``, ``filter_across``, ``cells``,
        ``rows``, ``mirror``, ``rotate``, ``window``. Lengths are texts with a unit, such as ``cell="0.5 um"``.

    Raises
    ------
    ReadError
        With what is wrong with the file or stands in the way of a map.
    """
    return ReadSurface(*_core.read_surface(Path(path), options))


def si(text: str) -> float:
    """A number with a unit, in SI units.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> fc.si("115 GPa"), fc.si("1 mm")
    (115000000000.0, 0.001)
    """
    return _core.si(text)


def channels(path: str | Path, **options: Any) -> list[dict[str, Any]]:
    """What a file says of each of its channels; ``{"error": ...}`` of one that is not read beside others."""
    return _core.channels(Path(path), options)


def write_surface(path: str | Path, heights: HeightMap, *, metres: bool = True) -> None:
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
    """Columns of ``results.csv``: numbers with NaN where a state has none, or texts."""


def run_scene(
    scene: SceneFile | str | Path,
    out: str | Path,
    *,
    threads: int | None = None,
    fresh: bool = False,
    progress: Callable[[int, int], object] | None = None,
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
    progress : callable, optional
        Called with the relative cost that is done and that of all.
    """
    if not isinstance(scene, SceneFile):
        scene = SceneFile.read(Path(scene))
    found = _core.run_scene(scene, Path(out), threads, fresh, progress)
    files = [Path(file) for file in found.pop("files")]
    results = {name: np.asarray(values) for name, values in found.pop("results").items()}
    return SceneOutcome(files=files, results=results, **found)
