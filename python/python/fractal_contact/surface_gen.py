"""Generated maps. The same seed gives the same surface as in Rust, to the last bit."""

from __future__ import annotations

from . import _core, _numbers
from ._arrays import checked_map
from ._core import HeightMap
from ._inputs import Cells, Surface
from ._numbers import Seed
from .typing import Waves

__all__ = ["self_affine_map", "surface_seed", "twin"]


def surface_seed(seed: Seed, index: int) -> int:
    """Gives the seed of a surface of the ensemble of a master seed.

    Parameters
    ----------
    seed : int or numpy.random.Generator
        The master seed; of a generator a number from 0 to 2^64 - 1, one draw of ``integers``.
    index : int
        Number of the surface, from 0.

    Returns
    -------
    int
        From 0 to 2^64 - 1.
    """
    return _core.surface_seed(_numbers.seed(seed), _numbers.index(index))


def self_affine_map(
    surface: Surface,
    cells: Cells,
    seed: Seed,
    *,
    anisotropy: float | None = None,
    lay: float | None = None,
    weibull: float | None = None,
) -> HeightMap:
    """Draws a self-affine surface.

    Parameters
    ----------
    surface : Surface
        A surface made by `Surface.self_affine`.
    cells : int or (int, int)
        Number of columns, for nearly square cells, or columns and rows.
    seed : int or numpy.random.Generator
        Seed of the surface; `surface_seed` gives that of a surface of an ensemble. Of a generator a number from 0 to
        2^64 - 1, one draw of ``integers``: the next call then draws another surface.
    anisotropy : float, optional
        Ratio > 0 of wavelengths along the lay to those across; 1 is isotropic.
    lay : float, optional
        Direction of the lay in degrees, from x towards y, 0 by default; only with ``anisotropy``, because an isotropic
        surface has no lay.
    weibull : float, optional
        Shape > 0 of Weibull's distribution of the heights; without it the heights are nearly Gaussian.

    Returns
    -------
    HeightMap
        The map, on a rectangle of the size of the surface.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01)
    >>> fc.surface_gen.self_affine_map(rough, 64, seed=1).shape
    (64, 64)
    """
    if lay is not None and anisotropy is None:
        raise TypeError(f"lay is {lay!r}, but an isotropic surface has no lay: anisotropy= is missing")
    given = None if anisotropy is None else (anisotropy, 0.0 if lay is None else lay)
    columns = _numbers.cells(cells)
    return _core.self_affine_map(surface._core(), columns, _numbers.seed(seed), given, weibull)


def twin(heights: HeightMap, seed: Seed, *, twin: Waves = "waves", keep_heights: bool = False) -> HeightMap:
    """Draws an artificial twin of a map, with its spectrum and the phases of a seed.

    Parameters
    ----------
    heights : HeightMap
        A map without undefined points.
    seed : int or numpy.random.Generator
        Seed of the phases; of a generator a number from 0 to 2^64 - 1, one draw of ``integers``.
    twin : {"waves", "rings"}
        "waves" keeps the amplitude of each wave; "rings" takes the means over rings of the spectrum and is isotropic.
    keep_heights : bool
        True to keep the distribution of the heights of the map.

    Returns
    -------
    HeightMap
        A map of the same cells and size.
    """
    if twin not in ("waves", "rings"):
        raise ValueError(f'twin is {twin!r}: expected "waves" or "rings"')
    return _core.twin(checked_map(heights), _numbers.seed(seed), twin == "rings", keep_heights)
