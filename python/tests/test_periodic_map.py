"""A periodic rough map whose elastic contact is known from the prototype of a solver of Tamaas.

Its continuous Green's function 2/(E* q), cut off at the grid, and cells under constant pressure are two
discretisations, which differ by 1 % in contact cells. A short solver in numpy takes either. With the former it finds
the cells of the reference, so that with the latter it is a reference for this package. The map, its loads and their
source are in data/peers/README.md.
"""

from pathlib import Path

import numpy as np
import pytest

import fractal_contact as fc

MAP = Path(__file__).resolve().parents[2] / "data/peers/surface_maxwell_N256.npy"
#: 4 G for nu = 1/2, with the shear modulus of the first step of time: G = 1 + 3 sum of tau/(tau + 1/6).
MODULUS = 4 * (1 + 3 * sum(tau / (tau + 1 / 6) for tau in np.logspace(-1, 9, 50)))
#: Aliases of a wave to each side.
ALIASES = 12


def waves(n):
    """Displacement over pressure of each wave, times E*: 2/q."""
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(n, 1 / n)[:, None], np.fft.rfftfreq(n, 1 / n))
    q[0, 0] = np.inf
    return 2 / q


def cells(n):
    """The same for the mean pressures of cells, and displacements at their centres: the sum over aliases."""
    total = np.zeros((n, n // 2 + 1))
    for i in range(-ALIASES, ALIASES + 1):
        for j in range(-ALIASES, ALIASES + 1):
            x, y = np.fft.fftfreq(n, 1 / n)[:, None] + i * n, np.fft.rfftfreq(n, 1 / n) + j * n
            q = 2 * np.pi * np.hypot(x, y)
            q[q == 0] = np.inf
            # Signs alternate with the alias: half of the last one stands for the rest of the series.
            share = 0.5 ** ((abs(i) == ALIASES) + (abs(j) == ALIASES))
            total += share * 2 / q * np.sinc(x / n) * np.sinc(y / n)
    return total


def pressures(heights, load, compliance):
    """Conjugate gradients of Polonsky and Keer (Wear 231, 206 (1999)), to 1e-9 of the rms height."""

    def displacements(p):
        return np.fft.irfft2(compliance * np.fft.rfft2(p), p.shape)

    p, direction, last = np.full_like(heights, load), np.zeros_like(heights), np.inf
    for _ in range(1000):
        contact = p > 0
        gap = displacements(p) - heights
        gap -= gap[contact].mean()
        if max(-gap.min(), np.abs(gap[contact]).max()) < 1e-9 * heights.std():
            return p
        square = (gap[contact] ** 2).sum()
        direction = np.where(contact, gap + square / last * direction, 0)
        of_direction = displacements(direction)
        of_direction -= of_direction[contact].mean()
        step = (gap * direction)[contact].sum() / (of_direction * direction)[contact].sum()
        p = np.maximum(p - step * direction, 0)
        penetrates = (p == 0) & (gap < 0)
        p[penetrates] -= step * gap[penetrates]
        p *= load / p.mean()
        last = np.inf if penetrates.any() else square
    raise AssertionError("not converged")


@pytest.mark.skipif(not MAP.exists(), reason="the map is in the repository only")
@pytest.mark.parametrize("load, reference", [(2.0, 612), (16.0, 4645)])
def test_contact_of_the_first_step(load, reference):
    heights = np.load(MAP).astype(float)
    n = len(heights)
    assert (pressures(heights, load, waves(n) / MODULUS) > 0).sum() == reference
    expected = pressures(heights, load, cells(n) / MODULUS)
    scene = fc.Scene(
        fc.HeightMap(heights, size=1.0),
        contact_modulus=MODULUS,
        outputs=["pressure"],
        effects={"boundary": "periodic"},
    )
    state = fc.Bem3d(tolerance=1e-9).prepare(scene).solve(mean_pressure=load)
    assert np.array_equal(state.pressure > 0, expected > 0)
    # The series of aliases ends.
    np.testing.assert_allclose(state.pressure, expected, atol=1e-5 * expected.max())
    assert abs(state.contact_cells / reference - 1) < 0.01
