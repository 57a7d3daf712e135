"""Statistics of a map: parameters of ISO 25178-2, spectra and differences with bands, the fit of a spectrum."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import checked_map
from ._core import HeightMap
from .typing import Axis, Direction

Curves = dict[str, NDArray[np.float64]]


def parameters(heights: HeightMap, *, periodic: bool = False) -> dict[str, float | None]:
    """Parameters of ISO 25178-2, rms gradient and curvature, Nayak's parameter, the energy of full contact.

    Those of the standard are Sa, Sq, Ssk, Sku, Sp, Sv, Sz, Sdq, Sdr, Sk, Spk, Svk, Sal, Str, Std, Spd and Spc.
    ``full_contact_energy`` is the elastic energy per area that presses a periodic map flat, over the contact modulus
    E*: the sum of |q| |H(q)|^2/4.

    Parameters
    ----------
    heights : HeightMap
        The map; undefined points are left out where the parameter allows it.
    periodic : bool
        Whether the map is periodic, for the gradient, the curvature and the energy of full contact.

    Returns
    -------
    dict of float or None
        The parameters by their names, None where the map does not define one. Lengths are in the unit of the map, Std
        in degrees.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01).height_map(64, seed=1)
    >>> round(fc.statistics.parameters(rough)["Sq"], 12)
    0.01
    """
    return _core.parameters(checked_map(heights), periodic)


def power_spectrum(
    heights: HeightMap,
    direction: Direction = "radial",
    *,
    periodic: bool = False,
    per_decade: float = 10.0,
    level: float = 0.95,
) -> Curves:
    """Two-sided power spectral density over q = 2 pi/wavelength.

    For a periodic map with N cells on Lx x Ly, let ``H(q) = 1/N sum h(x) exp(-i q x)``: the sum of ``|H(q)|^2`` over
    all waves of both signs, without the mean, is the variance of the heights. The densities are

    - of a map ``C(q) = Lx Ly/(2 pi)^2 |H(q)|^2`` (length^4): the integral of C over the plane of wavenumbers is the
      variance;
    - of profiles along x ``C(q) = Lx/(2 pi) mean |H(q)|^2`` (length^3), the mean over rows: the integral over q of both
      signs is the mean variance of the rows. For an isotropic power law it is ``pi q`` times the density of the map.

    Without ``periodic`` the deviations from the mean are first multiplied by Hann's window and divided by its rms. The
    program SurfaceTopography and Jacobs, Junge and Pastewka (2017) have ``(2 pi)^2`` times the density of a map.

    Parameters
    ----------
    heights : HeightMap
        A map without undefined points.
    direction : {"radial", "x", "y"}
        Average over rings (length^4), or over profiles along x or y (length^3).
    periodic : bool
        Whether the map is periodic; otherwise it is taken under Hann's window.
    per_decade : float
        Number of rings in a decade of wavenumbers, > 0.
    level : float
        Confidence level of the band, between 0 and 1.

    Returns
    -------
    dict of numpy.ndarray
        Arrays ``wavenumber``, ``density``, ``low``, ``high`` and ``degrees_of_freedom``.
    """
    return _core.power_spectrum(checked_map(heights), direction, periodic, per_decade, level)


def height_difference(
    heights: HeightMap, *, periodic: bool = False, per_decade: float = 10.0, level: float = 0.95
) -> Curves:
    """Half the mean square of h(x + r) - h(x): the variance less the autocorrelation.

    Parameters
    ----------
    heights : HeightMap
        A map without undefined points.
    periodic : bool
        Whether the map is periodic.
    per_decade : float
        Number of rings in a decade of distances, > 0.
    level : float
        Confidence level of the band, between 0 and 1.

    Returns
    -------
    dict of numpy.ndarray
        Arrays ``distance``, ``half_square``, ``low``, ``high`` and ``pairs``; no band (NaN) beyond half the side of a
        map that is not periodic.
    """
    return _core.height_difference(checked_map(heights), periodic, per_decade, level)


def slope(heights: HeightMap, axis: Axis = "x", *, periodic: bool = False, level: float = 0.95) -> Curves:
    """Rms slope over distances along an axis.

    Parameters
    ----------
    heights : HeightMap
        A map without undefined points.
    axis : {"x", "y"}
        The axis along which differences are taken.
    periodic : bool
        Whether the map is periodic.
    level : float
        Confidence level of the band, between 0 and 1.

    Returns
    -------
    dict of numpy.ndarray
        Arrays ``distance``, ``rms``, ``low`` and ``high``.
    """
    return _core.scale_dependence(checked_map(heights), False, _along_y(axis), periodic, level)


def curvature(heights: HeightMap, axis: Axis = "x", *, periodic: bool = False, level: float = 0.95) -> Curves:
    """Rms curvature over distances along an axis.

    Parameters
    ----------
    heights : HeightMap
        A map without undefined points.
    axis : {"x", "y"}
        The axis along which differences are taken.
    periodic : bool
        Whether the map is periodic.
    level : float
        Confidence level of the band, between 0 and 1.

    Returns
    -------
    dict of numpy.ndarray
        Arrays ``distance``, ``rms`` (one over a length), ``low`` and ``high``.
    """
    return _core.scale_dependence(checked_map(heights), True, _along_y(axis), periodic, level)


def fit_spectrum(heights: HeightMap, *, periodic: bool = False, instrument: float | None = None) -> dict[str, Any]:
    """Fits a self-affine spectrum.

    Undefined points get heights between those of their neighbours, as `read_surface` gives them with
    ``fill="neighbours"``. Short waves are missing there. The fit takes this into account, and ends at a longer wave
    where it is not known well enough.

    Parameters
    ----------
    heights : HeightMap
        The map. Its undefined points, and those that were ``filled`` when it was read, count as not measured.
    periodic : bool
        Whether the map is periodic.
    instrument : float, optional
        Shortest wavelength that the instrument resolves, in the unit of the map.

    Returns
    -------
    dict
        The fit: ``hurst``, ``roll_off`` and ``cut_off`` (wavelengths) as (value, low, high) with 95 % limits, None
        where there is only a bound; ``goodness``, which is below 0.01 for a surface that is not self-affine;
        ``fitted``, the smallest and the largest wavenumber 2 pi/wavelength of the fit; ``filled``, the number of points
        that are not measured; ``notes``, a list of texts that say what to beware of, such as that H has no meaning.

    Examples
    --------
    >>> import numpy as np
    >>> import fractal_contact as fc
    >>> rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01).height_map(128, seed=1)
    >>> spots = np.add.outer(np.arange(128) % 32 // 3, np.arange(128) % 32 // 3) == 0
    >>> holes = fc.HeightMap(np.ma.array(rough, mask=spots), size=1.0)
    >>> fit = fc.statistics.fit_spectrum(holes, periodic=True)
    >>> fit["hurst"][1] < 0.8 < fit["hurst"][2], fit["filled"], len(fit["notes"])
    (True, 144, 1)
    """
    return _core.fit_spectrum(checked_map(heights), periodic, instrument)


def _along_y(axis: Axis) -> bool:
    if axis not in ("x", "y"):
        raise ValueError(f'axis is {axis!r}: expected "x" or "y"')
    return axis == "y"
