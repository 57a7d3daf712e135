"""The models, by the names that they have in Rust."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from . import _core, _numbers
from ._core import Contact, ContactState, HeightMap
from ._errors import Error, OutOfMemory, Stopped, domain_error
from ._inputs import Scene
from ._numbers import Seed, numbers, steps
from .typing import Heights, Method, PeriodicKernel

LOADS = ("force", "approach", "mean_pressure", "mean_gap")


class StopToken(Protocol):
    """A signal by which another thread stops a solve: a `threading.Event`."""

    def is_set(self) -> bool:
        """Whether it was set."""
        ...


class Model:
    """A model of contact, which relates force, approach and stiffness. It plans a contact once for many solves.

    Each model of the library is a class; `models` lists them.

    Parameters
    ----------
    **options
        The options of the class, by name; None leaves one at its default.
    """

    _name: ClassVar[str]

    def __init__(self, **options: Any) -> None:
        if not hasattr(type(self), "_name"):
            raise TypeError(f"{type(self).__name__} is no model by itself: take one of its classes, such as fc.Bem3d")
        self._options = {name: value for name, value in options.items() if value is not None}
        # Mistakes are told where they are made.
        self._core()

    def _core(self) -> _core.Model:
        return _core.model(self._name, self._options)

    @property
    def name(self) -> str:
        """Name of the model, the same in scenes and tables."""
        return self._name

    @property
    def sources(self) -> list[tuple[str, str]]:
        """Publications that it is built on: (citation, what is taken from it)."""
        return self._core().sources

    @property
    def supports(self) -> dict[str, tuple[str, ...]]:
        """Words for its ``surfaces``, ``boundaries``, ``effects``, ``needs``, ``loads``, ``paths`` and ``outputs``.

        A scene that requests more is `Unsupported`. A model may also refuse what depends on several of them together,
        or on numbers.

        Examples
        --------
        >>> import fractal_contact as fc
        >>> fc.Jkr().supports["effects"]
        ('adhesion of short range',)
        """
        return self._core().supports

    def prepare(self, scene: Scene, seed: Seed = 0) -> Contact:
        """Checks the scene against what this model can do, and plans.

        Parameters
        ----------
        scene : Scene
            The contact problem.
        seed : int or numpy.random.Generator
            Seed of the surface, where it is random; of a generator a number from 0 to 2^64 - 1, one draw of
            ``integers``.

        Returns
        -------
        Contact
            ``solve`` and ``sweep`` start each load from no contact; ``advance`` and ``follow`` continue a path.

        Raises
        ------
        Unsupported
            For a surface, effect or output that the model lacks; it names the models that may have it.
        OutOfMemory
            For a grid that does not fit in memory, before anything is drawn or planned.
        """
        self._check(scene)
        return self._core().prepare(scene._core(), _numbers.seed(seed))

    def _check(self, scene: Scene) -> None:
        """Refuses what is no scene, and numerics that the scene leaves no use for."""
        if not isinstance(scene, Scene):
            raise TypeError(
                f"scene is of the type {type(scene).__name__}: expected fc.Scene(surface, contact_modulus), which says "
                "what is pressed and what is computed"
            )

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in self._options.items())})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.__dict__ == other.__dict__

    def __hash__(self) -> int:
        return hash(repr(self))


class Formula(Model):
    """A model without options: a closed form, a theory, a reduction. Each has a class of its own."""

    def __init__(self) -> None:
        super().__init__()


class Bem3d(Model):
    """Exact contact in three dimensions by boundary elements, free or periodic.

    With a hardness or adhesion a state depends on the loads before it: `Contact.advance` and `Contact.follow` remember
    them. The indentation of a hardness stays from step to step; adhesion has a branch of approach and one of
    withdrawal, and forces may be negative. A force below that of pull-off is `NotConverged` with the last stable state
    as ``best``.

    Parameters
    ----------
    cells : int
        Number of columns, 257 by default; a height map has its own.
    rows : int, optional
        Number of rows; by default the number that makes the cells nearly square.
    tolerance : float
        Bound of the residuals of the certificate and of the estimated relative error of the stiffness, dimensionless,
        1e-6 by default.
    max_outer_iterations : int
        Largest number of outer iterations.
    method : {"auto", "iterative", "single_level"}
        Method by which small linear systems are solved.
    periodic_kernel : {"cells", "waves"}
        What the kernel of periodic boundaries is exact for: pressures that are uniform on cells, or waves, as in other
        programs.
    time_tolerance : float
        Largest error that one step of time of a viscoelastic history may add, relative, 1e-3 by default.

    Examples
    --------
    >>> import numpy as np, fractal_contact as fc
    >>> x = np.linspace(0, 1, 64, endpoint=False)
    >>> h = 0.01 * np.cos(2 * np.pi * x)[None, :] * np.ones((64, 1))
    >>> scene = fc.Scene(fc.HeightMap(h, size=1.0), contact_modulus=1.0, outputs=["stiffness", "pressure"])
    >>> state = fc.Bem3d(tolerance=1e-8).prepare(scene).solve(force=0.01)
    >>> state.pressure.shape, state.certificate.meets(1e-8)
    ((64, 64), True)
    >>> sphere = fc.Surface.sphere(radius=1.0, size=1.0)
    >>> contact = fc.Bem3d(cells=32).prepare(fc.Scene(sphere, contact_modulus=1.0, effects={"hardness": 0.1}))
    >>> loaded, unloaded = contact.follow(force=[0.02, 0.0])
    >>> loaded.plastic_area > 0.0, unloaded.plastic_area, unloaded.plastic_volume == loaded.plastic_volume
    (True, 0.0, True)
    """

    _name = "bem3d"

    def __init__(
        self,
        *,
        cells: int | None = None,
        rows: int | None = None,
        tolerance: float | None = None,
        max_outer_iterations: int | None = None,
        method: Method | None = None,
        periodic_kernel: PeriodicKernel | None = None,
        time_tolerance: float | None = None,
    ) -> None:
        super().__init__(
            cells=cells,
            rows=rows,
            tolerance=tolerance,
            max_outer_iterations=max_outer_iterations,
            method=method,
            periodic_kernel=periodic_kernel,
            time_tolerance=time_tolerance,
        )

    def _check(self, scene: Scene) -> None:
        super()._check(scene)
        if not isinstance(scene.surface, HeightMap):
            return
        for name, of_map in zip(("rows", "cells"), scene.surface.shape, strict=True):
            if (given := self._options.get(name, of_map)) != of_map:
                raise ValueError(
                    f"{name} = {given}, but the map has {of_map} {name.replace('cells', 'columns')}, and each of its "
                    f"points is a cell: leave {name}= out, or take a map with fewer points "
                    "(fc.read_surface(..., cells=...))"
                )


class Mdr1d(Model):
    """The reduction to one dimension (method of dimensionality reduction).

    Parameters
    ----------
    elements : int
        Number of elements of a rough line.
    """

    _name = "mdr1d"

    def __init__(self, *, elements: int | None = None) -> None:
        super().__init__(elements=elements)


class Persson(Model):
    """Persson's theory of rough contact.

    Parameters
    ----------
    gamma : float
        Ratio of the elastic energy to that of full contact of the same waves, in (0, 1]; 0.45 by default.
    """

    _name = "persson"

    def __init__(self, *, gamma: float | None = None) -> None:
        super().__init__(gamma=gamma)


class GreenwoodWilliamson(Model):
    """Greenwood and Williamson's theory of rough contact.

    Parameters
    ----------
    heights : {"gaussian", "exponential"}
        Distribution of the heights of the summits.
    """

    _name = "greenwood_williamson"

    def __init__(self, *, heights: Heights | None = None) -> None:
        super().__init__(heights=heights)


class Equivalent(Model):
    """Friction or rheology of any surface, on the stiffness over approach of another model.

    Parameters
    ----------
    model : Model
        The model of the normal contact.
    per_decade, decades : int
        Nodes per decade of the approach (1 to 1000), and decades below the first load (1 to 12).
    """

    _name = "equivalent"

    def __init__(self, model: Model, *, per_decade: int | None = None, decades: int | None = None) -> None:
        self.model = model
        super().__init__(per_decade=per_decade, decades=decades)

    def _core(self) -> _core.Model:
        return _core.model(self._name, self._options, self.model._core())

    def _check(self, scene: Scene) -> None:
        self.model._check(scene)

    def __repr__(self) -> str:
        options = "".join(f", {k}={v!r}" for k, v in self._options.items())
        return f"Equivalent({self.model!r}{options})"


def _one_of(given: Mapping[str, Iterable[float] | None]) -> tuple[str, list[float]]:
    named = [(name, values) for name, values in given.items() if values is not None]
    if len(named) != 1:
        raise TypeError(f"give exactly one of {', '.join(given)}")
    name, values = named[0]
    return name, numbers(values, name)


def sweep(
    contact: Contact,
    *,
    force: Iterable[float] | None = None,
    approach: Iterable[float] | None = None,
    mean_pressure: Iterable[float] | None = None,
    mean_gap: Iterable[float] | None = None,
    steps: int | None = None,
    stop: StopToken | None = None,
) -> Iterator[ContactState]:
    """Solves for loads in their order, and yields each state as soon as it is known.

    Parameters
    ----------
    contact : Contact
        A planned contact. Increasing loads are the fastest order, and the only one with a hardness: each load is solved
        from the virgin surface, and a smaller one after a larger one is a `DomainError`. `follow` goes along a path.
    force, approach, mean_pressure, mean_gap : iterable of float
        Exactly one of them; with ``steps`` the first and the last load.
    steps : int, optional
        Number of states, at least 2, which are equally spaced in the logarithm of the contact area between those of the
        two loads, to a twentieth of a step or as the cells allow. The scene has to compute the area. The loads between
        are found by two to three solves each.
    stop : threading.Event, optional
        Set by another thread, it stops the solve, also within an iteration: `Stopped`.

    Returns
    -------
    iterator of ContactState
        The states, each as soon as it is known. A load that is refused, or that does not reach its tolerance, raises
        its error; the loads behind it can still be taken from the iterator, as `table` does.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> contact = fc.Hertz().prepare(fc.Scene(fc.Surface.sphere(radius=1.0, size=2.0), contact_modulus=1.0))
    >>> [round(state.approach, 3) for state in fc.sweep(contact, force=[0.0, 4 / 3])]
    [0.0, 1.0]
    """
    given = {"force": force, "approach": approach, "mean_pressure": mean_pressure, "mean_gap": mean_gap}
    name, values = _one_of(given)
    if steps is not None:
        steps = _numbers.count(steps, "steps", 2)
        if len(values) != 2:
            raise ValueError(
                f"steps = {steps}, but {name} has {len(values)} loads: expected the first and the last one"
            )
        return _by_area(contact, name, (values[0], values[1]), steps, stop)
    # Checked at the call, not at the first state.
    contact._check_order(name, values)
    return Loads(contact, name, values, stop)


class Loads(Iterator[ContactState]):
    """Solves of loads one after the other. Unlike a generator it goes on behind a load that raised an error.

    Parameters
    ----------
    contact : Contact
        A planned contact.
    name : str
        The keyword of the loads in `Contact.solve`.
    values : list of float
        The loads.
    stop : threading.Event, optional
        As in `sweep`.
    """

    def __init__(self, contact: Contact, name: str, values: list[float], stop: StopToken | None) -> None:
        self._contact, self._name, self._values, self._stop = contact, name, iter(values), stop

    def __next__(self) -> ContactState:
        """Solves the next load."""
        load: dict[str, Any] = {self._name: next(self._values)}
        return self._contact.solve(**load, stop=self._stop)


# Largest distance of a state from its place, in steps of the logarithm of the area.
OFF_PLACE = 0.05
# Most solves for the place of one state: on a coarse grid no load may lead to its area.
MOST_SOLVES = 8


def _by_area(
    contact: Contact, name: str, ends: tuple[float, float], steps: int, stop: StopToken | None
) -> Iterator[ContactState]:
    """States from the first load to the last one, equally spaced in the logarithm of the area.

    Each load is found by the secant in the logarithms of load and area (a gap, which may be negative, as it is),
    between the nearest states that are known.
    """

    def solved(load: float) -> tuple[float, float, ContactState]:
        if contact._yields:
            # Each load begins with the virgin surface, and the order of the solves is that of the search.
            contact.restart()
        state = contact.solve(**{name: load}, stop=stop)
        if state.area is None:
            raise ValueError(
                'steps= spaces the states by their area, which this contact does not compute: outputs=["area"]'
            )
        if state.area <= 0:
            raise ValueError(
                f"{name} = {load:g} gives no contact area: steps= needs one at the first and the last load"
            )
        return (load if name == "mean_gap" else math.log(load)), math.log(state.area), state

    for load in ends:
        if not (load > 0 or name == "mean_gap"):
            raise domain_error(name, load, "a load > 0 with steps=")
    first, last = solved(ends[0]), solved(ends[1])
    known = sorted([first, last], key=lambda found: found[1])
    if first[1] == last[1]:
        raise ValueError(f"{name} = {ends[0]:g} and {ends[1]:g} give the same area: expected two different ones")
    yield first[2]
    step = (last[1] - first[1]) / (steps - 1)
    for number in range(1, steps - 1):
        place = first[1] + number * step
        for _ in range(MOST_SOLVES):
            nearest = min(known, key=lambda found: abs(found[1] - place))
            if abs(nearest[1] - place) <= OFF_PLACE * abs(step):
                break
            below = max((found for found in known if found[1] <= place), key=lambda found: found[1])
            above = min((found for found in known if found[1] > place), key=lambda found: found[1])
            share = (place - below[1]) / (above[1] - below[1])
            load = below[0] + share * (above[0] - below[0])
            known.append(solved(load if name == "mean_gap" else math.exp(load)))
        yield min(known, key=lambda found: abs(found[1] - place))[2]
    yield last[2]


def follow(
    contact: Contact,
    time: float | Iterable[float] | None = None,
    *,
    force: float | Iterable[float] | None = None,
    approach: float | Iterable[float] | None = None,
    mean_pressure: float | Iterable[float] | None = None,
    mean_gap: float | Iterable[float] | None = None,
    tangential_force: float | Iterable[float] | Iterable[tuple[float, float]] | None = None,
    tangential_displacement: float | Iterable[float] | Iterable[tuple[float, float]] | None = None,
    stop: StopToken | None = None,
) -> Iterator[ContactState]:
    """Follows a path, and yields the state at the end of each step as soon as it is known.

    Parameters
    ----------
    contact : Contact
        A planned contact; the path continues from its current state.
    time : float or iterable of float
        Time at the end of each step, 0 by default.
    force, approach, mean_pressure, mean_gap : float or iterable of float
        Exactly one of them, as in `Contact.advance`.
    tangential_force, tangential_displacement : float, iterable of float or of (float, float), optional
        At most one of them, along x or along x and y. Iterables have one number, or two, for each step; a number
        alone is that of every step.
    stop : threading.Event, optional
        As in `sweep`.

    Returns
    -------
    iterator of ContactState
        The states, each as soon as it is known.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> solid = {"kind": "standard_solid", "weight": 1.0, "time": 1.0}
    >>> sphere = fc.Surface.sphere(radius=1.0, size=2.0)
    >>> scene = fc.Scene(sphere, contact_modulus=1.0, effects={"rheology": solid}, outputs=[])
    >>> creep = fc.Viscoelastic().prepare(scene)
    >>> [round(state.approach, 4) for state in fc.follow(creep, time=[0.0, 1.0, 10.0], force=0.01)]
    [0.0241, 0.0301, 0.0382]
    """
    normal = {"force": force, "approach": approach, "mean_pressure": mean_pressure, "mean_gap": mean_gap}
    if sum(value is not None for value in normal.values()) != 1:
        raise TypeError(f"give exactly one of {', '.join(normal)}")
    if tangential_force is not None and tangential_displacement is not None:
        raise TypeError("give at most one of tangential_force and tangential_displacement")
    given = {"time": time, **normal, "tangential_force": tangential_force}
    given["tangential_displacement"] = tangential_displacement
    found = {
        name: steps(values, name, pairs=name.startswith("tangential_"))
        for name, values in given.items()
        if values is not None
    }
    counts = {name: len(values) for name, values in found.items() if isinstance(values, list)}
    if len(set(counts.values())) > 1:
        told = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise ValueError(f"expected one number for each step, or one for all: {told}")
    count = next(iter(counts.values()), 1)
    columns = [values if isinstance(values, list) else count * [values] for values in found.values()]
    # Checked at the call, not at the first state.
    return (contact.advance(**dict(zip(found, step, strict=True)), stop=stop) for step in zip(*columns, strict=True))


def ensemble(
    model: Model,
    scene: Scene,
    *,
    seed: Seed,
    surfaces: int,
    force: Iterable[float] | None = None,
    approach: Iterable[float] | None = None,
    mean_pressure: Iterable[float] | None = None,
    mean_gap: Iterable[float] | None = None,
    force_bar: Iterable[float] | None = None,
    progress: Callable[[int, int], object] | None = None,
    stop: StopToken | None = None,
) -> list[list[ContactState | Error]]:
    """The same loads on many surfaces of a seed, on all threads (`set_threads`).

    Parameters
    ----------
    model : Model
        The model that solves each surface.
    scene : Scene
        A scene with a random surface.
    seed : int or numpy.random.Generator
        The master seed; of a generator a number from 0 to 2^64 - 1, one draw of ``integers``. Surface number i has the
        seed ``surface_gen.surface_seed(seed, i)``, as in scenes and figures.
    surfaces : int
        Number of surfaces, >= 0.
    force, approach, mean_pressure, mean_gap, force_bar : iterable of float
        Exactly one of them; the unit of ``force_bar`` is E* h L of each surface. With a hardness the order must be
        increasing, as in `sweep`.
    progress : callable, optional
        Called with the number of surfaces that are done and that of all.
    stop : threading.Event, optional
        Set by another thread, it ends the ensemble: `Stopped`.

    Returns
    -------
    list of list of ContactState
        ``[surface][load]``. A load that the model refused, or that did not reach its tolerance, is the exception in its
        place, and the others are solved; `table` makes a row of each. An exception that ends it early, such as
        KeyboardInterrupt or `Stopped`, has the surfaces that were finished as ``finished``, a dict by their number.

    Raises
    ------
    OutOfMemory
        Where the states of all surfaces, which are kept until the end, do not fit in memory.
    """
    given = {
        "force": force,
        "approach": approach,
        "mean_pressure": mean_pressure,
        "mean_gap": mean_gap,
        "force_bar": force_bar,
    }
    name, values = _one_of(given)
    model._check(scene)
    loads = [(name, value) for value in values]
    seed, surfaces = _numbers.seed(seed), _numbers.count(surfaces, "surfaces")
    return _core.ensemble(model._core(), scene._core(), loads, seed, surfaces, progress, stop)


def quantities() -> list[dict[str, str]]:
    """The quantities that are reported of a state: properties of `ContactState`, columns of `table` and of scenes.

    Returns
    -------
    list of dict
        In the order of columns: ``name``, ``words``, ``symbol`` (TeX), ``unit`` (SI; ``1`` for a pure number, ``-`` for
        text), ``meaning``, ``source``, ``asked_by``, ``role`` (``answer``, ``normalised``, ``residual``, ``work``,
        ``of_path``) and ``type``.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> [quantity["unit"] for quantity in fc.quantities() if quantity["name"] == "stiffness"]
    ['N/m']
    """
    return _core.quantities()


def models() -> list[dict[str, Any]]:
    """The models of the library.

    Returns
    -------
    list of dict
        ``name`` (in scenes and tables), ``title``, ``class`` (in this package), ``about``, ``accuracy`` and
        ``has_options``.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> [model["class"] for model in fc.models() if model["name"] == "bem3d"]
    ['Bem3d']
    """
    return _core.models()


def combinations() -> list[dict[str, Any]]:
    """Which effects each model combines.

    Returns
    -------
    list of dict
        For every two effects of a model that a scene can have together: ``model`` (its name), ``effects`` (both in
        words), ``keys`` (both names in `Effects`), ``combined``, and ``reason`` (why not, or None).

    Examples
    --------
    >>> import fractal_contact as fc
    >>> [row["combined"] for row in fc.combinations() if row["effects"] == ("a hardness", "friction")]
    [True]
    """
    return _core.combinations()


def _with_refused(states: Iterable[ContactState | Error]) -> Iterator[ContactState | Error]:
    """The states, with the error of each load of a sweep that is refused in its place."""
    loads = iter(states)
    while True:
        try:
            state = next(loads)
        except StopIteration:
            return
        except (Stopped, OutOfMemory):
            raise
        except Error as error:
            if not isinstance(loads, Loads):
                raise
            state = error
        yield state


def table(states: Iterable[ContactState | Error]) -> NDArray[np.void]:
    """States as a structured array with a row for each, which pandas and xarray can read.

    Columns are the names of ``to_dict()`` in the order of `quantities`, which are those of the tables of scenes.
    Columns of an effect or of a path (such as ``plastic_area``, ``branch``, ``tangential_force``, ``time``) are present
    where a state has them. Columns of counts that all states have are whole numbers; other missing numbers are NaN, and
    missing texts are empty.

    A load that a model refuses has a row too, as in `press`, `ensemble` and the tables of the program: its ``status``
    is "refused", its numbers are NaN, and the column ``note`` has the reason. A load that did not reach its tolerance
    has the best numbers that were reached. The other loads are solved all the same.

    Parameters
    ----------
    states : iterable of ContactState
        A sweep, the states of a path, or the states of one surface of an `ensemble`, with its errors. An error that a
        path raises ends the path, and is raised here too.

    Returns
    -------
    numpy.ndarray
        Shape (states,), with the names as fields.

    Warns
    -----
    RuntimeWarning
        Where a load was refused or did not reach its tolerance.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> contact = fc.Hertz().prepare(fc.Scene(fc.Surface.sphere(radius=1.0, size=2.0), contact_modulus=1.0))
    >>> rows = fc.table(contact.sweep(force=[0.5, 1.0]))
    >>> rows["force"].tolist()
    [0.5, 1.0]
    """
    rows: list[dict[str, Any]] = []
    failed = []
    for i, state in enumerate(_with_refused(states)):
        if isinstance(state, Error):
            best = getattr(state, "best", None)
            found = {"status": "refused"} if best is None else best.to_dict()
            failed.append(str(state))
            rows.append({**found, "note": str(state)})
        elif isinstance(state, ContactState):
            rows.append(state.to_dict())
        else:
            raise TypeError(f"states[{i}] is {state!r}: expected a ContactState, or an error of a load")
    if failed:
        # The column `note` has them all.
        distinct = list(dict.fromkeys(failed))
        more = f"; and {len(distinct) - 3} other reasons" if len(distinct) > 3 else ""
        reasons = "; ".join(distinct[:3]) + more
        warnings.warn(f"{len(failed)} of {len(rows)} loads failed: {reasons}", RuntimeWarning, stacklevel=2)
    known = {name for row in rows for name in row} or {"force"}
    names = [name for name in [*(quantity["name"] for quantity in quantities()), "note"] if name in known]
    longest = {
        name: max(len(v) if isinstance(v := row.get(name), str) else 0 for row in rows) for name in known if rows
    }
    texts = {name for name, length in longest.items() if length}
    counts = {name for name in known if rows and all(type(row.get(name)) is int for row in rows)}
    kinds = [(name, f"U{longest[name]}" if name in texts else "i8" if name in counts else "f8") for name in names]

    def value(row: Mapping[str, Any], name: str) -> Any:
        found = row.get(name)
        return found if found is not None else "" if name in texts else np.nan

    return np.array([tuple(value(row, name) for name in names) for row in rows], dtype=kinds)
