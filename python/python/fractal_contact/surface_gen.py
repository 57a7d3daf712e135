"""Generated maps. The same seed gives the same surface as in Rust, to the last bit."""

from __future__ import annotations

from . import _core, _numbers
from ._core import HeightMap
from ._inputs import Cells, Surface
from .typing import Waves

__all__ = ["self_affine_map", "surface_seed", "twin"]


def surface_seed(seed: int, index: int) -> int:
    """Seed of surface number `index` of the ensemble of a master seed."""
    return _core.surface_seed(_numbers.seed(seed), _numbers.seed(index, "index"))


def self_affine_map(
    surface: Surface,
    cells: Cells,
    seed: int,
    *,
    anisotropy: float | None = None,
    lay: float = 0.0,
    weibull: float | None = None,
) -> HeightMap:
    """Draws a self-affine surface.

    Parameters
    ----------
    surface : Surface
        A surface made by `Surface.self_affine`.
    cells : int or (int, int)
        Number of columns, for nearly square cells, or columns and rows.
    seed : int
        Seed of the surface; `surface_seed` gives that of a surface of an ensemble.
    anisotropy : float, optional
        Ratio > 0 of wavelengths along the lay to those across; 1 is isotropic.
    lay : float
        Direction of the lay in degrees, from x towards y.
    weibull : float, optional
        Shape > 0 of Weibull's distribution of the heights; without it the heights are nearly Gaussian.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01)
    >>> fc.surface_gen.self_affine_map(rough, 64, seed=1).shape
    (64, 64)
    """
    given = None if anisotropy is None else (anisotropy, lay)
    columns = _numbers.cells(cells)
    return _core.self_affine_map(surface._core(), columns, _numbers.seed(seed), given, weibull)


def twin(heights: HeightMap, seed: int, *, twin: Waves = "waves", keep_heights: bool = False) -> HeightMap:
    """Draws an artificial twin of a map, with its spectrum and the phases of a seed.

    Parameters
    ----------
    heights : HeightMap
        A map without undefined points.
    seed : int
        Seed of the phases.
    twin : {"waves", "rings"}
        "waves" keeps the amplitude of each wave; "rings" takes the means over rings of the spectrum and is isotropic.
    keep_heights : bool
        True to keep the distribution of the heights of the map.
    """
    if twin not in ("waves", "rings"):
        raise ValueError(f'twin is {twin!r}: expected "waves" or "rings"')
    return _core.twin(heights, _numbers.seed(seed), twin == "rings", keep_heights)
