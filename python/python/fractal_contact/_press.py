"""The commonest question in one call: the contact of a map that is pressed, as the program's `press` answers it."""

from __future__ import annotations

import difflib
import errno
import re
import tempfile
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _core, _html
from ._columns import Columns
from ._core import HeightMap, SceneFile
from ._effects import Effects
from ._files import ReadSurface, SceneOutcome, _words, run_scene
from ._inputs import AnyBody, Body, _body
from ._models import StopToken
from ._numbers import is_iterable, number
from ._plain import check_names, same_fields, with_names
from .typing import Detrend, PressOptions

# First words of a scene that this call, or the program's `press`, has written, and the file of an array beside it.
HEADING = "# Contact of the map "
ARRAY = "heights.npy"
# States of the path along which a tangential force grows.
TANGENTIAL_STATES = 8
# Quantities whose error on the cells that were solved is a column of its own.
SOLVER_ERRORS = (
    "force",
    "stiffness",
    "tangential_stiffness",
    "tangential_stiffness_y",
    "tangential_stiffness_stuck",
    "tangential_stiffness_stuck_y",
)
LOADS = ("mean_pressure", "force", "approach", "mean_gap")

Amount = float | str
Amounts = Amount | Iterable[Amount]


@dataclass(eq=False)
class Pressed(Columns):
    """The contact of a map that was pressed, with one entry for each load, or for each state of a tangential path.

    Each line of the table that it prints is an attribute of the same name, such as ``area_corrected``, with one number
    for each state, and ``error("area_corrected")`` is what stands behind +- there, over the number. Numbers that a
    state does not have are NaN. Units are those in which the problem was given: SI units where a unit was. The table
    itself has multiples of them that are easy to read, and ``contact_fraction`` in per cent.

    ``results`` has every column of the program's ``results.csv``, so that ``pandas.DataFrame(pressed.results)`` is a
    table. Two of them compare with ``==`` as wholes, to one truth value, but for the page, which has the times of its
    run.

    Parameters
    ----------
    scene : str
        The text of the scene that was run, as the program's `press` writes it.
    results : dict of numpy.ndarray
        The columns of all quantities, of residuals, of work and of the errors of the grid, shape (states,) each.
    summary : str
        The states as a short table of text, with errors and, for SI units, with units.
    notes : list of str
        What may be wrong with the numbers though they are solved, and what to do about it.
    fields : dict of list of numpy.ndarray
        The fields by their names, each a list with an array for each state, shape (rows, columns); None where the state
        has none.
    size : (float, float)
        Sides (Lx, Ly) of the map.
    files : list of Path
        The files in the folder ``out``; empty where none was named.
    html : bytes
        The report as a page of HTML, which needs no other file.
    """

    scene: str
    results: dict[str, NDArray[Any]] = field(repr=False)
    summary: str
    notes: list[str]
    fields: dict[str, list[NDArray[np.float64] | None]] = field(repr=False)
    size: tuple[float, float]
    files: list[Path] = field(repr=False)
    html: bytes = field(repr=False)

    def __eq__(self, other: object) -> bool:
        # The page has the times of its run.
        return same_fields(self, other, but=("html",)) if isinstance(other, Pressed) else NotImplemented

    def __repr__(self) -> str:
        notes = "".join(f"note: {note}\n" for note in self.notes)
        return f"<Pressed: {len(self.results['state'])} states>\n{self.summary}{notes}"

    @property
    def mean_pressure(self) -> NDArray[np.float64]:
        """numpy.ndarray: the force over the area Lx Ly of the map, shape (states,)."""
        return self.force / (self.size[0] * self.size[1])

    @property
    def area_error(self) -> NDArray[np.float64]:
        """numpy.ndarray: estimated relative error of the area, shape (states,): that of the grid, from cells twice and
        four times as large, beside which the residuals of the solver are small. NaN where none is estimated.
        """
        return self._column("area_grid_error")

    @property
    def stiffness_error(self) -> NDArray[np.float64]:
        """numpy.ndarray: estimated relative error of the stiffness by the grid, shape (states,); NaN where none is."""
        return self._column("stiffness_grid_error")

    @property
    def pressure(self) -> list[NDArray[np.float64] | None]:
        """list of numpy.ndarray: the pressure of each state, shape (rows, columns)."""
        return self.fields["pressure"]

    @property
    def gap(self) -> list[NDArray[np.float64] | None]:
        """list of numpy.ndarray: the gap of each state, shape (rows, columns), NaN at undefined points."""
        return self.fields["gap"]

    def error(self, name: str) -> NDArray[np.float64]:
        """The estimated relative error of a quantity, which the printed table shows behind +-.

        It is the error of the grid and that of the solver together, as far as they are known.

        Parameters
        ----------
        name : str
            The quantity by its name in the table, such as ``"area"``.

        Returns
        -------
        numpy.ndarray
            Shape (states,), over the number itself; NaN where no error is estimated.
        """
        if name not in vars(Columns) or name.startswith("_"):
            known = [one for one in vars(Columns) if not one.startswith("_")]
            near = difflib.get_close_matches(str(name), known, 1)
            help_ = f"did you mean {near[0]!r}?" if near else "expected one that the table shows"
            raise ValueError(f"no quantity is called {name!r}: {help_}")
        # The contact fraction is the area over a constant.
        of_grid = self._column(f"{'area' if name == 'contact_fraction' else name}_grid_error")
        solver = re.sub(r"^(tangential_stiffness)(_stuck)?(_y)?$", r"\1", name)
        of_solver = self._column(f"{solver}_error" if name in SOLVER_ERRORS else "")
        unknown = np.isnan(of_grid) & np.isnan(of_solver)
        return np.where(unknown, np.nan, np.nan_to_num(of_grid) + np.nan_to_num(of_solver))

    def report(self, path: str | PathLike[str]) -> Path:
        """Writes the report of the program: one page of HTML with tables, pictures and sources.

        Parameters
        ----------
        path : str or path-like
            The file, which is overwritten.

        Returns
        -------
        Path
            The same path.
        """
        path = Path(path)
        path.write_bytes(self.html)
        return path

    def _repr_html_(self) -> str:
        return _html.pressed(self)


@with_names(PressOptions)
def press(
    heights: ArrayLike | HeightMap | ReadSurface | str | PathLike[str],
    size: Amount | Sequence[Amount] | NDArray[np.float64] | None = None,
    contact_modulus: Amount | None = None,
    *,
    bodies: Sequence[AnyBody | Mapping[str, Amount]] | None = None,
    mean_pressure: Amounts | None = None,
    force: Amounts | None = None,
    approach: Amounts | None = None,
    mean_gap: Amounts | None = None,
    tangential_force: Amount | None = None,
    effects: Effects | Mapping[str, Any] | None = None,
    ball: Amount | None = None,
    outputs: Iterable[str] = (),
    accuracy: float | None = None,
    unit: str | None = None,
    cell: Amount | Sequence[Amount] | None = None,
    detrend: Detrend = "plane",
    keys: Mapping[str, Any] | None = None,
    out: str | PathLike[str] | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    stop: StopToken | None = None,
    **options: Unpack[PressOptions],
) -> Pressed:
    """Presses a map against a flat and gives the contact, as the command `press` of the program does.

    Every point of the map is a cell of boundary elements. A tilt of the map is subtracted first. The boundaries are
    free unless ``effects={"boundary": "periodic"}`` says otherwise.

    Lengths, forces and moduli are plain numbers in units of your choice that fit together. Where one of them is a text
    with a unit, or where ``unit`` or a file gives the unit of the heights, all plain numbers are in SI units.

    Parameters
    ----------
    heights : array_like, HeightMap, ReadSurface, str or path-like
        Heights ``[row, column]``, measured outwards from the body, columns along x; or a map; or the file of one. A
        masked array has undefined points, which cannot touch. Names of dimensions decide as for `HeightMap`.
    size : float, str, or two of them, optional
        Side of a square map or sides (Lx, Ly). Maps have their own, as have many files; ``cell`` may say it instead.
    contact_modulus : float or str, optional
        Contact modulus E* of the pair, such as ``"115 GPa"`` for steel on steel.
    bodies : pair of Body, mapping, "rigid" or None, optional
        Both bodies in place of ``contact_modulus``; a mapping is ``{"young": "210 GPa", "poisson": 0.3}``. Friction
        needs them.
    mean_pressure, force, approach, mean_gap : float, str or iterable of them
        Exactly one of them, for each load one number. ``mean_pressure`` is the force over Lx Ly; ``approach`` counts
        from first touch and needs free boundaries, ``mean_gap`` needs periodic ones.
    tangential_force : float or str, optional
        With friction: a force along x, which grows in eight equal steps after the one normal load.
    effects : Effects or mapping, optional
        As for `Scene`, with numbers or texts: ``{"hardness": "2 GPa"}``, ``{"boundary": "periodic"}``.
    ball : float or str, optional
        Radius of a ball that bears the map; without it the map lies on a flat.
    outputs : iterable of str
        More quantities and fields by their names. The contact area, the stiffness, the pressure, the gap and the
        connected contacts are always computed.
    accuracy : float, optional
        Accepted relative error of the grid, which then decides the number of cells.
    unit : str, optional
        Unit of the heights, such as ``"nm"``.
    cell : float, str, or two of them, optional
        Side of one cell of the map, or both sides, in place of ``size``.
    detrend : {"plane", "none", "mean", "quadric", "sphere", "cylinder"}
        The trend of least squares that is subtracted from the heights.
    keys : mapping, optional
        Any other keys of a scene by their tables and names: ``{"models.bem3d.tolerance": 1e-8}``.
    out : str or path-like, optional
        Folder in which the files of the program are kept; an interrupted run goes on from it. A scene in it that
        `press` has not written is not overwritten.
    threads : int, optional
        Number of threads; that of `threads` by default.
    progress : callable, optional
        Called with the relative cost that is done and that of all.
    stop : threading.Event, optional
        Set by another thread, it ends the run with `Stopped`.
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

    Returns
    -------
    Pressed
        Area, stiffness and other numbers of each load with their errors, the fields, and the report.

    Raises
    ------
    TypeError, ValueError, DomainError
        For what is missing, contradictory or makes no sense.
    OSError
        Where the system refuses, such as FileNotFoundError; FileExistsError for a folder with another scene.
    SceneError, ReadError
        For what only shows when the whole problem is read, such as a file without a size.
    Unsupported, OutOfMemory
        For effects that do not go together, and for a map that does not fit in memory.

    Warns
    -----
    RuntimeWarning
        Where a load was refused or did not reach its tolerance. The other loads are solved all the same. Its row has
        the ``status`` "refused" and NaN, or another ``status`` and the best numbers that were reached, and ``note`` in
        ``results`` says why.

    Notes
    -----
    The time is that of the solves, of one more solve of each load on grids with a half and a quarter of the cells a
    side for the error, and of the pictures of the report. `Bem3d` solves without errors of the grid and pictures.

    Examples
    --------
    >>> import numpy as np
    >>> import fractal_contact as fc
    >>> x = np.linspace(0, 1, 32, endpoint=False)
    >>> waves = 0.01 * np.cos(2 * np.pi * x)[None, :] * np.cos(2 * np.pi * x)[:, None]
    >>> pressed = fc.press(waves, 1.0, 1.0, mean_pressure=[0.001, 0.01], effects={"boundary": "periodic"})
    >>> pressed.force.round(9).tolist(), bool((np.diff(pressed.area) > 0).all())
    ([0.001, 0.01], True)
    """
    check_names(press, options)
    given = {"mean_pressure": mean_pressure, "force": force, "approach": approach, "mean_gap": mean_gap}
    loads = {name: _values(value, name) for name, value in given.items() if value is not None}
    if len(loads) != 1:
        raise TypeError(f"give exactly one of {', '.join(LOADS)}")
    if (contact_modulus is None) == (bodies is None):
        raise TypeError("give contact_modulus, which is E* of both bodies, or bodies, and not both")
    if isinstance(effects, Effects):
        effects = effects._values()
    effects = {name: value for name, value in (effects or {}).items() if value is not None}
    if bodies is None and "friction" in effects:
        raise TypeError(
            "friction needs Young's modulus and Poisson's ratio of both bodies: bodies= is missing, in the place of "
            "contact_modulus"
        )
    if ("friction" in effects) != (tangential_force is not None):
        raise TypeError(
            'friction and tangential_force= need each other: effects={"friction": 0.3}, tangential_force=...'
        )
    numbers = (size, cell, contact_modulus, bodies, loads, tangential_force, effects, ball, options)
    in_si = unit is not None or _is_metric(heights) or any(map(_has_unit, numbers))
    material = {"contact_modulus": contact_modulus} if bodies is None else {"bodies": _bodies(bodies)}
    problem: dict[str, Any] = {"scene.models": ["bem3d"], "scene.accuracy": accuracy}
    problem.update({f"scene.{name}": value for name, value in material.items()})
    problem.update(_loads(loads, tangential_force))
    if ball is not None:
        problem.update({"scene.body.kind": "sphere", "scene.body.radius": ball})
    problem.update({f"effects.{name}": value for name, value in {"boundary": "free", **effects}.items()})
    surface = {"unit": unit, "size": _sides(size, "size", in_si), "cell": _sides(cell, "cell", in_si)}
    known = {name: value for name, value in _words(options).items() if value is not None}
    surface.update(detrend=detrend, **known)
    with tempfile.TemporaryDirectory(prefix="fractal-contact-") as temporary:
        # The report is called by the name of its folder.
        name = Path(heights).stem if isinstance(heights, str | PathLike) else "map"
        folder = Path(temporary) / name if out is None else Path(out)
        folder.mkdir(parents=True, exist_ok=True)
        _check_folder(folder)
        surface.update(_placed(heights, surface, folder, in_si))
        of_surface = {f"scene.surface.{name}": value for name, value in {"kind": "file", **surface}.items()}
        requested = _outputs(outputs, effects, accuracy)
        # Each of these is read with its units, or as plain numbers; the others as the whole scene is.
        entries = [(name, value, _has_unit(value)) for name, value in problem.items()]
        entries += [(name, value, in_si) for name, value in {**of_surface, **requested, **(keys or {})}.items()]
        scene = _core.press_scene([entry for entry in entries if entry[1] is not None], in_si, folder / "scene.toml")
        heading = f"{HEADING}{of_surface['scene.surface.path']!r}, written by fractal_contact.press.\n"
        (folder / "scene.toml").write_text(heading + scene.text, encoding="utf-8")
        outcome = run_scene(scene, folder, threads=threads, progress=progress, stop=stop)
        pressed = _pressed(scene, outcome, folder, kept=out is not None)
    if outcome.failed:
        why = "; ".join(pressed.notes)
        warnings.warn(f"{outcome.failed} of {outcome.requested} loads failed: {why}", RuntimeWarning, stacklevel=2)
    return pressed


def _is_metric(heights: Any) -> bool:
    """Whether a file says the unit of the heights, or has to."""
    if isinstance(heights, ReadSurface):
        return bool(heights.metadata["unit"] == "m")
    return isinstance(heights, str | PathLike)


def _check_folder(folder: Path) -> None:
    """Refuses to overwrite files that `press` has not written."""
    scene, array = folder / "scene.toml", folder / ARRAY
    for path, foreign in (
        (scene, scene.exists() and not scene.read_text(encoding="utf-8", errors="replace").startswith(HEADING)),
        (array, array.exists() and not scene.exists()),
    ):
        if foreign:
            message = "was not written by press, and is not overwritten: give another folder as out="
            raise FileExistsError(errno.EEXIST, message, str(path))


def _has_unit(value: Any) -> bool:
    """Whether a text in a value is a number with a unit, which may be misspelt, or several with " x " between them."""
    if isinstance(value, str):
        return all(map(_is_quantity, value.split(" x ")))
    if isinstance(value, Mapping):
        return any(map(_has_unit, value.values()))
    return isinstance(value, list | tuple) and any(map(_has_unit, value))


def _is_quantity(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return re.match(r"\s*[-+]?\.?\d", text) is not None
    return False


def _values(values: Any, name: str) -> list[float | str]:
    """One number or text, or several."""
    if isinstance(values, str) or not is_iterable(values):
        return [values if isinstance(values, str) else number(values, name)]
    found = [value if isinstance(value, str) else number(value, f"{name}[{i}]") for i, value in enumerate(values)]
    if not found:
        raise ValueError(f"{name} has no value: expected one or several")
    return found


def _sides(value: Any, name: str, in_si: bool) -> Any:
    """One side or two, as a scene takes them: texts with units, or plain numbers."""
    if value is None:
        return None
    found = _values(value, name)
    if len(found) > 2:
        raise ValueError(f"{name} has {len(found)} values: expected one side, or two along x and along y")
    if not in_si:
        return found if len(found) == 2 else found[0]
    return " x ".join(side if isinstance(side, str) else f"{side!r} m" for side in found)


def _bodies(bodies: Any) -> list[Any]:
    """Both bodies as a scene has them. Where one of them has units, Young's modulus of the other is in Pa."""
    if not isinstance(bodies, Sequence) or isinstance(bodies, str) or len(bodies) != 2:
        raise TypeError(f"bodies is {bodies!r}: expected two of them")
    in_si = any(map(_has_unit, bodies))
    found: list[Any] = []
    for i, given in enumerate(bodies):
        body = given if isinstance(given, Mapping) else _body(given, f"bodies[{i}]")
        if isinstance(body, Body):
            young: float | str = f"{body.young!r} Pa" if in_si else body.young
            body = {"young": young, "poisson": body.poisson}
        found.append("rigid" if body is None else dict(body))
    return found


def _loads(loads: dict[str, list[float | str]], tangential_force: Any) -> dict[str, Any]:
    """The loads one by one, or the path along which a tangential force grows."""
    ((name, found),) = loads.items()
    if tangential_force is None:
        return {f"scene.{name}": found}
    if len(found) != 1:
        raise ValueError(f"{name} has {len(found)} values: expected one load, under which the tangential force grows")
    (tangential,) = _values(tangential_force, "tangential_force")
    step = "scene.path.1"
    return {
        f"scene.path.0.{name}": found[0],
        f"{step}.tangential_force": tangential,
        f"{step}.states": TANGENTIAL_STATES,
    }


def _placed(heights: Any, surface: dict[str, Any], folder: Path, in_si: bool) -> dict[str, Any]:
    """The map's file, which is written where there is none, and what is known of it besides."""
    if isinstance(heights, str | PathLike):
        # A refusal of the system is told as such.
        with open(heights, "rb"):
            pass
        return {"path": str(Path(heights).absolute())}
    map_ = heights.heights if isinstance(heights, ReadSurface) else heights
    shape = np.shape(map_) if isinstance(map_, np.ndarray) else getattr(map_, "shape", ())
    if len(shape) == 2:
        _core.check_pressed_map(shape[1], shape[0])
    more: dict[str, Any] = {"path": ARRAY}
    if isinstance(map_, HeightMap):
        for name in ("size", "cell", "unit"):
            if surface[name] is not None:
                raise TypeError(f"{name} is given, but the heights are a map, which has its size: leave {name}= out")
        more.update(size=_sides(map_.size, "size", in_si), unit="m" if in_si else None)
        values, partly = np.array(map_), map_.undefined > 0
    else:
        if (surface["size"] is None) == (surface["cell"] is None):
            raise TypeError("give one of size, which is that of the whole map, and cell, which is that of one cell")
        if in_si and surface["unit"] is None and "height_scale" not in surface:
            raise TypeError(
                'unit= is missing: other lengths or moduli have units, and the heights have none; write unit="nm", '
                "say, or give all numbers without units"
            )
        stated = "undefined" in surface or "fill" in surface or surface.get("crop") == "defined"
        values, partly, _ = _arrays.heights(map_, "no_contact" if stated else "error")
        partly = partly and not stated
    if partly and "fill" not in surface:
        more["undefined"] = "no_contact"
    np.save(folder / ARRAY, values)
    return more


def _outputs(more: Iterable[str], effects: Mapping[str, Any], accuracy: float | None) -> dict[str, Any]:
    """What the program's `press` requests of a map."""
    if isinstance(more, str):
        raise TypeError(f"outputs is {more!r}: expected a list of names")
    files = ["npy", "png"]
    found: dict[str, Any] = {"area": True, "stiffness": True, "contact_patches": True, "pressure": files}
    if effects.get("boundary") == "periodic":
        found["mean_gap"] = True
    if "friction" in effects:
        drawn = [TANGENTIAL_STATES // 2, TANGENTIAL_STATES]
        found.update(stick_slip=files, stick_area=True, curves=True, drawn_states=drawn)
    else:
        found.update(gap=files, distributions=["pressure", "gap"], grid_error=accuracy is None)
    fields = [one["name"] for one in _core.fields()]
    found = {**{name: files if name in fields else True for name in more}, **found}
    return {f"outputs.{name}": value for name, value in found.items()}


def _pressed(scene: SceneFile, outcome: SceneOutcome, folder: Path, *, kept: bool) -> Pressed:
    """The outcome with everything that stands in its files."""
    states = len(outcome.results["state"])
    fields: dict[str, list[NDArray[np.float64] | None]] = {}
    for file in outcome.files:
        if file.suffix == ".npy":
            name, _, _, state = file.stem.rsplit("-", 3)
            fields.setdefault(name, [None] * states)[int(state)] = np.load(file)
    return Pressed(
        scene=scene.text,
        results=outcome.results,
        summary=outcome.summary,
        notes=_core.notes_of_python(outcome.notes),
        fields=fields,
        size=scene.size,
        files=outcome.files if kept else [],
        html=(folder / "report.html").read_bytes(),
    )
