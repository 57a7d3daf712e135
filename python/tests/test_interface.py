"""Leakage, paths, and the stress below the surface, of arrays."""

import copy
import math
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import fractal_contact as fc

RANDOM = np.random.default_rng(77)
GAP = RANDOM.uniform(0.2, 2.0, (5, 7))
XX, YY, ZZ, YZ, XZ, XY = range(6)


def inside(leak, value, slack=1e-12):
    """Whether the bounds contain a value that is itself rounded."""
    return leak.lower * (1.0 - slack) <= value <= leak.upper * (1.0 + slack)


# Leakage.


@pytest.mark.parametrize("along", ["x", "y"])
def test_a_series_and_strips_have_closed_forms(along):
    gaps = np.array([2.0, 0.5, 3.0, 1.0])
    series = np.tile(gaps, (3, 1))
    # Cells of 0.5 x 2: the sum of resistances length/(width gap^3), and that of conductances.
    dx, dy = 0.5, 2.0
    in_series = 3 * dy / (dx * (1.0 / gaps**3).sum())
    in_strips = dx * (gaps**3).sum() / (3 * dy)
    for map_, expected in ((series, in_series), (series.T, None)):
        turned = map_ if along == "x" else map_.T
        cell = (dx, dy) if along == "x" else (dy, dx)
        leak = fc.leakage(turned, cell, along=along)
        if expected is None:
            expected = dy * (gaps**3).sum() / (3 * dx)
        assert inside(leak, expected) and (leak.upper - leak.lower) < 1e-10 * leak.upper
        # Flow in one direction alone is the same in the continuum.
        assert leak.continuum_lower == pytest.approx(expected, rel=1e-9) == leak.continuum_upper
    across = fc.leakage(series, (dx, dy), along="y")
    assert inside(across, in_strips)


def test_fields_of_a_series():
    gaps = np.array([1.0, 0.5])
    leak = fc.leakage(np.tile(gaps, (3, 1)), 2.0)
    conductance = 3 * 2.0 / (2.0 * (1 / gaps**3).sum())
    # Half a cell lies before the first centre.
    assert leak.pressure[:, 0] == pytest.approx(1.0 - conductance / 3 * 0.5, rel=1e-9)
    assert leak.pressure[:, 1] == pytest.approx(conductance / 3 * 0.5 * 8.0, rel=1e-9)
    assert leak.flux.shape == (2, 3, 2) and leak.flux[0] == pytest.approx(conductance / 6.0, rel=1e-9)
    assert np.abs(leak.flux[1]).max() < 1e-12 and leak.reached.all() and leak.reached.dtype == bool
    assert leak.mean_gap == 0.75 and leak.flow_factor == pytest.approx(conductance / (0.75**3 * 6 / 4), rel=1e-9)


def reference(gap, dx=1.0, dy=1.0, ring=False):
    """Conductance along x of the network of cells, by a dense solve."""
    rows, columns = gap.shape
    k = np.where(gap > 0, gap, 0.0) ** 3
    number = np.arange(rows * columns).reshape(rows, columns)
    matrix, right = np.zeros((k.size, k.size)), np.zeros(k.size)

    def join(a, b, conductance):
        for i, j in ((a, b), (b, a)):
            matrix[i, i] += conductance
            matrix[i, j] -= conductance

    def mean(a, b):
        return 2 * a * b / (a + b) if a * b > 0 else 0.0

    for y in range(rows):
        for x in range(columns):
            if x + 1 < columns:
                join(number[y, x], number[y, x + 1], mean(k[y, x], k[y, x + 1]) * dy / dx)
            if y + 1 < rows or (ring and rows > 1):
                below = (y + 1) % rows
                join(number[y, x], number[below, x], mean(k[y, x], k[below, x]) * dx / dy)
        for x, potential in ((0, 1.0), (columns - 1, 0.0)):
            half = 2 * k[y, x] * dy / dx
            matrix[number[y, x], number[y, x]] += half
            right[number[y, x]] += half * potential
    pressure = np.linalg.lstsq(matrix, right, rcond=None)[0].reshape(rows, columns)
    return (2 * k[:, 0] * dy / dx * (1.0 - pressure[:, 0])).sum(), pressure


@pytest.mark.parametrize("ring", [False, True])
def test_maps_against_a_dense_solve(ring):
    boundary = {"x": "free", "y": "periodic"} if ring else "free"
    turned_boundary = {"x": "periodic", "y": "free"} if ring else "free"
    for seed in range(6):
        gap = np.random.default_rng(seed).uniform(-0.3, 2.0, (6, 9))
        flow, pressure = reference(gap, 0.5, 0.7, ring)
        leak = fc.leakage(gap, (0.5, 0.7), boundary=boundary)
        assert inside(leak, flow, 1e-9)
        through = np.abs(leak.flux).max(axis=0) > 1e-6 * np.abs(leak.flux).max()
        assert np.abs(leak.pressure - pressure)[through].max() < 1e-8
        assert leak.continuum_lower <= leak.continuum_upper and np.isfinite(leak.pressure).all()
        # The same flow through each column: half of it through each of its faces.
        assert (leak.flux[0].sum(axis=0) * 0.7) == pytest.approx(flow, rel=1e-8)
        turned = fc.leakage(gap.T, (0.7, 0.5), along="y", boundary=turned_boundary)
        assert inside(turned, flow, 1e-9)


def test_duality_on_checkerboards_and_others():
    # Keller and Dykhne: the conductance along x of k, times that along y of 1/k, is 1 in the continuum.
    squares = np.kron(np.indices((4, 4)).sum(axis=0) % 2, np.ones((6, 6)))
    checkerboard = np.where(squares > 0, 2.0, 1.0)
    for gap in (checkerboard, GAP):
        along, across = fc.leakage(gap, (0.7, 0.9)), fc.leakage(1.0 / gap, (0.7, 0.9), along="y")
        assert along.continuum_lower * across.continuum_lower <= 1.0 <= along.continuum_upper * across.continuum_upper
    # Mirrored, the checkerboard has its conductivities exchanged, and along y it is the same: sqrt(1 x 8).
    leak = fc.leakage(checkerboard)
    assert leak.continuum_lower < math.sqrt(8.0) < leak.continuum_upper < 1.2 * leak.continuum_lower


def test_pressures_are_between_those_of_the_edges():
    for seed in range(20):
        # Conductances over fifty decades.
        gap = np.random.default_rng(seed).lognormal(sigma=10.0, size=(12, 10))
        leak = fc.leakage(gap, tolerance=1e-3)
        assert leak.pressure.min() >= 0.0 and leak.pressure.max() <= 1.0 and np.isfinite(leak.flux).all()
        assert leak.lower <= leak.upper and leak.continuum_lower <= leak.continuum_upper


def test_closed_interfaces_and_cells_that_are_not_reached():
    gap = np.ones((5, 5))
    gap[:, 2] = 0.0
    gap[1:4, 3:] = -1.0
    gap[2, 4] = 1.0
    gap[0, 3:] = 0.0
    leak = fc.leakage(gap)
    assert leak.lower == leak.upper == leak.continuum_lower == leak.continuum_upper == 0.0
    assert (leak.pressure[:, :2] == 1.0).all() and leak.reached[:, :2].all() and not leak.reached[:, 2].any()
    assert (leak.flux == 0.0).all() and leak.flow(1e5, 1e-3) == (0.0, 0.0) and leak.flow_factor == 0.0
    assert leak.mean_gap == pytest.approx(np.maximum(gap, 0).mean())
    shut = fc.leakage(np.zeros((3, 3)))
    assert shut.flow_factor is None and shut.upper == 0.0 and not shut.reached.any() and (shut.pressure == 0).all()
    island = np.zeros((5, 5))
    island[2, 2] = 1.0
    assert not fc.leakage(island).reached.any()


def test_the_flow_in_units():
    leak = fc.leakage(1e-6 * GAP, 1e-6)
    lower, upper = leak.flow(1e5, 1e-3)
    factor = 1e5 / 12e-3
    assert lower == pytest.approx(leak.lower * factor, rel=1e-15) and lower <= leak.lower * factor
    assert upper == pytest.approx(leak.upper * factor, rel=1e-15) and upper >= leak.upper * factor
    low, high = leak.flow(1e5, 1e-3, continuum=True)
    assert low == pytest.approx(leak.continuum_lower * factor) and high == pytest.approx(leak.continuum_upper * factor)
    assert leak.flow(0.0, 1.0) == (0.0, 5e-324)
    for drop, viscosity, words in (
        (-1.0, 1.0, "pressure drop = -1"),
        (1.0, 0.0, "viscosity = 0"),
        (1.0, np.nan, "visc"),
    ):
        with pytest.raises(fc.DomainError, match=words):
            leak.flow(drop, viscosity)
    with pytest.raises(fc.DomainError, match="flow"):
        fc.leakage(GAP).flow(1e300, 1e-300)
    with pytest.raises(TypeError, match=r"pressure_drop is '1 bar'.*fc.si"):
        leak.flow("1 bar", 1.0)
    alone = fc.leakage(GAP, continuum=False)
    assert alone.continuum_lower is None and alone.continuum_upper is None
    assert (alone.lower, alone.upper) == (fc.leakage(GAP).lower, fc.leakage(GAP).upper)
    with pytest.raises(ValueError, match="continuum is True"):
        alone.flow(1.0, 1.0, continuum=True)


def test_results_are_values():
    leak = fc.leakage(GAP)
    for again in (pickle.loads(pickle.dumps(leak)), copy.deepcopy(leak), fc.leakage(GAP)):
        assert again == leak and hash(again) == hash(leak)
    assert leak != fc.leakage(GAP + 1) and leak != 1 and "lower=" in repr(leak) and "array" not in repr(leak)
    for array in (leak.pressure, leak.reached, leak.flux):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    largest = fc.largest_von_mises(GAP, cell=1.0, depths=[0.5, 1.0], poisson=0.3)
    assert (
        pickle.loads(pickle.dumps(largest))
        == largest
        == fc.largest_von_mises(GAP, cell=1.0, depths=iter([1.0, 0.5]), poisson=0.3)
    )
    path = fc.percolation(GAP)
    assert pickle.loads(pickle.dumps(path)) == path == fc.percolation(GAP.tolist()) and hash(path)


def test_threads_do_not_change_a_bit():
    gap = RANDOM.uniform(-0.2, 1.0, (90, 80))
    before = fc.threads()
    found = []
    for count in (1, 3):
        fc.set_threads(count)
        found.append((fc.leakage(gap), fc.stress_below(gap, cell=1.0, depths=[0.5], poisson=0.3).tobytes()))
    fc.set_threads(before)
    assert found[0] == found[1]


# Paths.


def test_paths():
    gap = np.array([[5.0, 1.0, 4.0], [6.0, 2.0, 0.0], [7.0, 0.0, 9.0]])
    path = fc.percolation(gap, cell=(2.0, 3.0), g_min=0.5)
    assert path == fc.Percolation(
        spans=True, constriction=1.0, column=1, row=0, at=(3.0, 1.5), contact_spans=False, contact_blocks=False
    )
    shut = fc.percolation(gap, g_min=1.0)
    assert not shut.spans and shut.contact_blocks and shut.constriction == 1.0 and shut.at == (1.5, 0.5)
    along_y = fc.percolation(gap, along="y")
    assert along_y.spans and along_y.constriction == 5.0 and (along_y.column, along_y.row) == (0, 0)
    assert fc.percolation(gap.T, along="y").constriction == 1.0
    # Undefined points are open.
    for undefined in (np.where(gap == 1.0, np.inf, gap), np.ma.masked_equal(gap, 1.0)):
        assert fc.percolation(undefined).constriction == 4.0
    assert fc.percolation(np.full((2, 2), np.inf)).constriction == np.inf
    bar = np.zeros((3, 4))
    assert fc.percolation(bar).contact_spans and fc.percolation(bar).contact_blocks


def test_a_path_round_the_edge():
    gap = np.ones((4, 4))
    gap[[0, 1, 2, 3], [2, 2, 2, 2]] = 0.0
    gap[0, :] = 0.0
    gap[:, 0] = [0.0, 1.0, 1.0, 1.0]
    step = np.array([[1, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 1, 1, 1]], dtype=float)
    assert not fc.percolation(step).spans
    assert fc.percolation(step, boundary="periodic").spans
    assert fc.percolation(step, boundary={"x": "free", "y": "periodic"}).spans
    assert not fc.percolation(step, boundary={"x": "periodic", "y": "free"}).spans
    assert fc.leakage(step).upper == 0.0 < fc.leakage(step, boundary="periodic").lower


def test_paths_and_leakage_agree():
    for seed in range(20):
        gap = np.random.default_rng(seed).uniform(-1.0, 1.0, (9, 9))
        path, leak = fc.percolation(gap), fc.leakage(gap, continuum=False)
        assert path.spans == (leak.lower > 0.0) == (not path.contact_blocks) == (path.constriction > 0.0)
        assert gap[path.row, path.column] == path.constriction


# Stress.


def hertz(cells, side=3.0):
    place = side * ((np.arange(cells) + 0.5) / cells - 0.5)
    return np.sqrt(np.maximum(1.0 - np.add.outer(place**2, place**2), 0.0)), side / cells


def test_below_hertz():
    pressure, cell = hertz(151)
    largest = fc.largest_von_mises(pressure, cell=cell, depths=[0.05, 0.1, 0.2, 0.4, 0.8, 1.6], poisson=0.3)
    assert largest.value == pytest.approx(0.62004, rel=1e-3) and largest.depth == pytest.approx(0.48086, rel=4e-3)
    assert (largest.column, largest.row) == (75, 75) and largest.at == pytest.approx((1.5, 1.5))
    assert float(fc.von_mises(largest.stress)) == pytest.approx(largest.value, rel=1e-14)
    # On the axis, with the closed forms of Hertz's stress.
    depths = np.array([0.3, 0.48, 1.0, 2.0])
    stress = fc.stress_below(pressure, cell=cell, depths=depths, poisson=0.3)
    assert stress.shape == (6, 4, 151, 151) and np.isfinite(stress).all()
    on_axis = stress[:, :, 75, 75]
    zz = -1.0 / (1.0 + depths**2)
    rr = -1.3 * (1.0 - depths * np.arctan(1.0 / depths)) - 0.5 * zz
    assert on_axis[ZZ] == pytest.approx(zz, abs=1e-3)
    assert on_axis[XX] == pytest.approx(rr, abs=2e-3) and on_axis[YY] == pytest.approx(on_axis[XX], abs=1e-12)
    assert np.abs(on_axis[3:]).max() < 1e-12
    equivalent = fc.von_mises(stress)
    assert equivalent.shape == (4, 151, 151) and equivalent[1].max() == pytest.approx(0.62004, rel=1e-3)
    assert equivalent[1, 75, 75] == pytest.approx(abs(on_axis[XX, 1] - on_axis[ZZ, 1]), rel=1e-12)


def test_points_are_where_the_cells_are():
    pressure = RANDOM.uniform(0.0, 1.0, (6, 5))
    traction = RANDOM.uniform(-1.0, 1.0, (2, 6, 5))
    depths, (dx, dy) = [0.0, 0.3, 2.0], (0.5, 0.8)
    planes = fc.stress_below(pressure, cell=(dx, dy), depths=depths, poisson=0.25, traction=traction)
    corner = (10.0, -20.0)
    points = [
        (corner[0] + (column + 0.5) * dx, corner[1] + (row + 0.5) * dy, depth)
        for depth in depths
        for row in range(6)
        for column in range(5)
    ]
    given = {"cell": (dx, dy), "poisson": 0.25, "traction": list(traction), "origin": corner}
    found = fc.stress_below(pressure, points=points, **given).reshape(6, 3, 6, 5)
    # The places of the points are rounded where the corner is far away.
    assert np.abs(found - planes)[:, 1:].max() < 1e-13
    assert np.abs(found - planes)[:, 0].max() < 1e-11
    # At the surface the load itself.
    assert planes[ZZ, 0] == pytest.approx(-pressure, abs=1e-13)
    assert planes[XZ, 0] == pytest.approx(-traction[0], abs=1e-13)
    assert planes[YZ, 0] == pytest.approx(-traction[1], abs=1e-13)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_wave(axis):
    cells, side = 64, 2.0
    q = 2 * np.pi / side
    wave = np.tile(np.cos(q * side * (np.arange(cells) + 0.5) / cells), (4, 1))
    # Cells of constant load have the wave of the grid times this, and waves shorter than two cells.
    share = np.sinc(1.0 / cells)
    pressure, cell = (wave, (side / cells, 0.1)) if axis == "x" else (wave.T, (0.1, side / cells))
    depths = np.array([0.2, 0.5, 1.0])
    stress = fc.stress_below(pressure, cell=cell, depths=depths, poisson=0.3, boundary="periodic")
    expected = -(1 + q * depths) * np.exp(-q * depths) * share
    lateral = -(1 - q * depths) * np.exp(-q * depths) * share
    along, across = (XX, YY) if axis == "x" else (YY, XX)
    for i in range(3):
        assert stress[ZZ, i] == pytest.approx(expected[i] * pressure, abs=3e-3 * np.exp(-40 * q * depths[i]) + 1e-12)
        assert stress[along, i] == pytest.approx(lateral[i] * pressure, abs=3e-3 * np.exp(-40 * q * depths[i]) + 1e-12)
        # Plane strain.
        assert stress[across, i] == pytest.approx(0.3 * (stress[along, i] + stress[ZZ, i]), abs=1e-12)
    assert stress[ZZ].max() <= share


def test_mean_loads_of_maps_that_repeat_themselves():
    ones = np.ones((4, 6))
    stress = fc.stress_below(ones, cell=1.0, depths=[0.0, 3.0], poisson=0.3, boundary="periodic")
    assert stress[ZZ] == pytest.approx(-1.0, abs=1e-13) and stress[XX] == pytest.approx(-0.3 / 0.7, abs=1e-13)
    sheared = fc.stress_below(
        0 * ones, cell=1.0, depths=[3.0], poisson=0.3, traction=(ones, 2 * ones), boundary="periodic"
    )
    assert sheared[XZ] == pytest.approx(-1.0, abs=1e-13) and sheared[YZ] == pytest.approx(-2.0, abs=1e-13)
    # Along x alone as a line load; a turn exchanges the axes.
    load = RANDOM.uniform(0.0, 1.0, (5, 3))
    words = {"x": "periodic", "y": "free"}
    line = fc.stress_below(load, cell=(0.5, 0.4), depths=[0.7], poisson=0.2, boundary=words)
    turned = fc.stress_below(
        load.T, cell=(0.4, 0.5), depths=[0.7], poisson=0.2, boundary={"x": "free", "y": "periodic"}
    )
    order = [YY, XX, ZZ, XZ, YZ, XY]
    assert turned[order].transpose(0, 1, 3, 2) == pytest.approx(line, abs=1e-13)


def test_tractions_by_symmetry():
    q = np.zeros((9, 9))
    q[3:6, 2:7] = 1.0
    given = {"cell": 0.5, "depths": [0.4, 1.5], "poisson": 0.3}
    none = np.zeros_like(q)
    x = fc.stress_below(none, traction=(q, none), **given)
    # Mirrored in x: xx, yy, zz and yz change their sign, and xz and xy do not; what acts along x does so as well.
    signs = np.array([-1, -1, -1, -1, 1, 1]).reshape(6, 1, 1, 1)
    assert x[..., ::-1] == pytest.approx(signs * x, abs=1e-13)
    # In y: components with one y change their sign.
    signs = np.array([1, 1, 1, -1, 1, -1]).reshape(6, 1, 1, 1)
    assert x[..., ::-1, :] == pytest.approx(signs * x, abs=1e-13)
    # The same along y, turned.
    y = fc.stress_below(none, traction=(none, q.T), **given)
    assert y[[YY, XX, ZZ, XZ, YZ, XY]].transpose(0, 1, 3, 2) == pytest.approx(x, abs=1e-13)
    # On the other body, and beside a pressure.
    assert fc.stress_below(none, traction=(-q, none), **given) == pytest.approx(-x, abs=1e-13)
    both = fc.stress_below(q, traction=(q, none), **given)
    assert both == pytest.approx(fc.stress_below(q, **given) + x, abs=1e-13)


def test_von_mises():
    stress = RANDOM.normal(size=(6, 3, 4))
    xx, yy, zz, yz, xz, xy = stress
    expected = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (yz**2 + xz**2 + xy**2))
    assert fc.von_mises(stress) == pytest.approx(expected, rel=1e-14)
    # Any order in memory, and more than one piece of the work.
    moved = np.moveaxis(np.moveaxis(stress, 0, -1).copy(), -1, 0)
    assert not moved.flags.c_contiguous and np.array_equal(fc.von_mises(moved), fc.von_mises(stress))
    many = RANDOM.normal(size=(6, 140_000))
    assert np.array_equal(fc.von_mises(many)[-5:], fc.von_mises(many[:, -5:]))
    assert fc.von_mises([1e300, -1e300, 0, 0, 0, 0]) == pytest.approx(math.sqrt(3.0) * 1e300)
    assert fc.von_mises(np.full(6, -7, dtype=np.int8)).shape == () and fc.von_mises(np.zeros((6, 0, 2))).shape == (0, 2)
    assert fc.von_mises(np.zeros((6, 2))).tolist() == [0.0, 0.0]
    for value in (np.nan, np.inf):
        wrong = stress.copy()
        wrong[4, 2, 1] = value
        with pytest.raises(fc.DomainError, match=rf"stress\[:, 2, 1\] = {value}: expected finite"):
            fc.von_mises(wrong)
    with pytest.raises(fc.DomainError, match=r"stress\[:\] = 1.5e\+308"):
        fc.von_mises([1.5e308, -1.5e308, 0, 0, 0, 0])
    for shape in ((), (5,), (3, 6), (0,)):
        with pytest.raises(fc.ShapeError, match=r"expected \(6, ...\)"):
            fc.von_mises(np.zeros(shape))
    for wrong in ("stress", [None] * 6, np.zeros(6, dtype=complex)):
        with pytest.raises(TypeError, match="real numbers"):
            fc.von_mises(wrong)


# Arrays of other libraries and of the package.


def test_names_of_dimensions_and_coordinates():
    xarray = pytest.importorskip("xarray")
    x, y = 0.5 * (np.arange(7) + 0.5), 0.25 * (np.arange(5) + 0.5)
    named = xarray.DataArray(GAP, dims=("y", "x"), coords={"y": y, "x": x})
    plain = fc.leakage(GAP, (0.5, 0.25))
    pressure = fc.stress_below(GAP, cell=(0.5, 0.25), depths=[0.3], poisson=0.3)
    for given in (named, named.transpose(), named.isel(x=slice(None, None, -1)), named.isel(y=slice(None, None, -1))):
        assert fc.leakage(given) == plain
        assert fc.percolation(given) == fc.percolation(GAP, (0.5, 0.25))
        assert np.array_equal(fc.stress_below(given, depths=[0.3], poisson=0.3), pressure)
    # What is given counts more than coordinates, and an array without these has squares.
    assert fc.leakage(named, 1.0) == fc.leakage(GAP) == fc.leakage(named.drop_vars(["x", "y"]))
    shear = xarray.DataArray(np.array([GAP, -GAP]), dims=("component", "y", "x"), coords={"y": y, "x": x})
    given = {"depths": [0.3], "poisson": 0.3}
    assert np.array_equal(
        fc.stress_below(named, traction=shear.isel(x=slice(None, None, -1)), **given),
        fc.stress_below(GAP, cell=(0.5, 0.25), traction=(GAP, -GAP), **given),
    )
    with pytest.raises(TypeError, match="cell is missing"):
        fc.leakage(named.drop_vars("x"))
    with pytest.raises(TypeError, match="cell is missing"):
        fc.stress_below(named.drop_vars(["x", "y"]), depths=[0.3], poisson=0.3)
    with pytest.raises(ValueError, match="expected x and y"):
        fc.leakage(named.rename(x="z"))
    with pytest.raises(ValueError, match="not in equal steps"):
        fc.leakage(named.assign_coords(x=x**2))


def test_maps_have_cells():
    map_ = fc.HeightMap(GAP, size=(3.5, 1.25))
    assert fc.leakage(map_) == fc.leakage(GAP, (0.5, 0.25)) != fc.leakage(GAP)
    assert np.array_equal(
        fc.stress_below(map_, depths=[0.3], poisson=0.3),
        fc.stress_below(GAP, cell=map_.cell, depths=[0.3], poisson=0.3),
    )
    for given in (GAP.tolist(), np.asfortranarray(GAP), GAP.astype(">f8"), np.repeat(GAP, 2, 0)[::2]):
        assert fc.leakage(given) == fc.leakage(GAP)
    whole = np.arange(1, 7).reshape(2, 3)
    assert fc.leakage(whole).lower == fc.leakage(whole.astype(float)).lower
    assert fc.leakage(GAP, np.float32(2.0)) == fc.leakage(GAP, [2, 2]) == fc.leakage(GAP, np.array([2.0, 2.0]))
    before = GAP.copy()
    fc.leakage(GAP)
    assert np.array_equal(GAP, before)


def test_of_a_state():
    """The recipe of the book has the numbers that a scene reads off the interface, to the last bit."""
    rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01).height_map(64, seed=3)
    depths = (rough.cell[0] * np.geomspace(0.5, 16.0, 6)).tolist()
    pressed = fc.press(
        rough,
        bodies=(None, fc.Body(0.91, 0.3)),
        mean_pressure=0.004,
        effects={"boundary": "periodic"},
        outputs=["gap", "pressure"],
        detrend="none",
        keys={
            "outputs.leakage": {"viscosity": 2.0, "pressure_drop": 24.0, "along": "y"},
            "outputs.percolation": True,
            "outputs.stress_below": {"depths": depths},
        },
    )
    gap, pressure = pressed.gap[0], pressed.pressure[0]
    touching = pressure > 0
    gap = np.where(touching | (gap <= np.abs(gap[touching]).max()), 0.0, gap)
    leak = fc.leakage(gap, rough.cell, along="y", boundary="periodic")
    lower, upper = leak.flow(24.0, 2.0)
    assert lower <= pressed.leakage[0] <= upper and pressed.leakage[0] == lower + 0.5 * (upper - lower)
    assert leak.flow(24.0, 2.0, continuum=True) == (pressed.leakage_lower[0], pressed.leakage_upper[0])
    assert leak.flow_factor == pressed.flow_factor[0] and (leak.flux[:, touching] == 0.0).all()
    path = fc.percolation(gap, rough.cell, along="y", boundary="periodic")
    assert path.spans and path.constriction == pressed.constriction_y[0]
    assert path.at == (pressed.constriction_y_at_x[0], pressed.constriction_y_at_y[0])
    given = {"cell": rough.cell, "poisson": 0.3, "boundary": "periodic"}
    largest = fc.largest_von_mises(pressure, depths=depths, **given)
    assert (largest.value, largest.depth) == (pressed.largest_von_mises[0], pressed.largest_von_mises_depth[0])
    assert largest.at == (pressed.largest_von_mises_x[0], pressed.largest_von_mises_y[0])
    stress = fc.stress_below(pressure, depths=[largest.depth], **given)
    assert fc.von_mises(stress).max() == fc.von_mises(stress)[0, largest.row, largest.column] == largest.value


# What makes no sense.

NAN, INF = GAP.copy(), GAP.copy()
NAN[1, 2], INF[1, 2] = np.nan, np.inf


@pytest.mark.parametrize("function", [fc.leakage, fc.percolation])
@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"gap": NAN}, fc.DomainError, r"gap\[1, 2\]"),
        ({"gap": np.zeros((0, 3))}, fc.ShapeError, "gap has the shape .* at least one cell"),
        ({"gap": []}, fc.ShapeError, "gap has 1 dimensions"),
        ({"gap": np.zeros((2, 2, 2))}, fc.ShapeError, "gap has 3 dimensions"),
        ({"gap": GAP + 0j}, TypeError, "gap is of the type complex128"),
        ({"gap": "gap"}, TypeError, "gap is of the type"),
        ({"gap": None}, TypeError, "gap is of the type"),
        ({"along": "z"}, ValueError, "along is 'z'"),
        ({"along": 1}, ValueError, "along is 1"),
        ({"along": None}, ValueError, "along is None"),
        ({"boundary": "round"}, ValueError, "boundary is 'round'.*periodic"),
        ({"boundary": {"x": "periodic"}}, ValueError, "boundary is {'x'"),
        ({"boundary": {"x": "periodic", "y": 1}}, ValueError, "boundary is"),
        ({"boundary": None}, ValueError, "boundary is None"),
        ({"cell": 0.0}, fc.DomainError, "cell = 0"),
        ({"cell": -1.0}, fc.DomainError, "cell = -1"),
        ({"cell": (1.0, np.nan)}, fc.DomainError, r"cell\[1\] = nan"),
        ({"cell": (1.0, np.inf)}, fc.DomainError, r"cell\[1\] = inf"),
        ({"cell": (1.0, 2.0, 3.0)}, ValueError, "cell is"),
        ({"cell": "1 um"}, TypeError, "cell is '1 um'.*fc.si"),
        ({"cell": True}, TypeError, "cell is True"),
        ({"cell": (1e-5, 1e5)}, fc.DomainError, "ratio of the sides"),
        ({"cell": 1e308}, fc.DomainError, "size|side"),
    ],
)
def test_gaps_that_make_no_sense(function, given, error, words):
    with pytest.raises(error, match=words):
        function(**{"gap": GAP, **given})


@pytest.mark.parametrize("gap", [INF, np.ma.masked_equal(GAP, GAP[1, 2])])
def test_undefined_points_do_not_leak(gap):
    with pytest.raises(fc.DomainError, match=r"gap\[1, 2\] = inf: .*undefined points") as caught:
        fc.leakage(gap)
    assert caught.value.quantity == "gap[1, 2]" and caught.value.value == np.inf


def test_numbers_that_make_no_sense():
    for tolerance in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(fc.DomainError, match="tolerance"):
            fc.leakage(GAP, tolerance=tolerance)
    with pytest.raises(TypeError, match="tolerance is '1'"):
        fc.leakage(GAP, tolerance="1")
    with pytest.raises(fc.DomainError, match="g_min"):
        fc.percolation(GAP, g_min=np.nan)
    with pytest.raises(TypeError, match="g_min is None"):
        fc.percolation(GAP, g_min=None)
    with pytest.raises(fc.DomainError, match="conductance"):
        fc.leakage(1e150 * GAP)
    with pytest.raises(fc.DomainError, match="flux"):
        fc.leakage(GAP, 1e-310)
    tiny = fc.leakage(np.full((2, 2), 1e-100))
    assert tiny.lower == pytest.approx(1e-300) and tiny.upper == pytest.approx(1e-300)


STRESS = {"pressure": GAP, "cell": 1.0, "depths": [0.5], "poisson": 0.3}
POINTS = {**STRESS, "depths": None}


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({**STRESS, "points": [(0, 0, 1)]}, TypeError, "exactly one of depths and points, not both"),
        (POINTS, TypeError, "exactly one of depths and points, not none"),
        ({**STRESS, "pressure": NAN}, fc.DomainError, r"pressure\[1, 2\]"),
        ({**STRESS, "pressure": INF}, fc.DomainError, r"pressure\[1, 2\] = inf"),
        ({**STRESS, "pressure": np.ma.masked_equal(GAP, GAP[1, 2])}, fc.DomainError, r"pressure\[1, 2\]"),
        ({**STRESS, "pressure": np.zeros((3, 0))}, fc.ShapeError, "at least one cell"),
        ({**STRESS, "pressure": np.zeros(3)}, fc.ShapeError, "pressure has 1 dimensions"),
        ({**STRESS, "pressure": [["1"]]}, TypeError, "pressure is of the type"),
        ({**STRESS, "cell": None}, TypeError, "cell is missing"),
        ({**STRESS, "cell": 0.0}, fc.DomainError, "cell = 0"),
        ({**STRESS, "depths": []}, fc.ShapeError, "at least one depth"),
        ({**STRESS, "depths": 0.5}, TypeError, "depths is 0.5"),
        ({**STRESS, "depths": "0.5"}, TypeError, "depths is '0.5'"),
        ({**STRESS, "depths": [0.5, -0.1]}, fc.DomainError, r"depths\[1\] = -0.1: expected a finite number >= 0"),
        ({**STRESS, "depths": [0.5, np.nan]}, fc.DomainError, r"depths\[1\] = NaN"),
        ({**STRESS, "depths": [0.5, np.inf]}, fc.DomainError, r"depths\[1\] = inf"),
        ({**STRESS, "depths": [0.5, 1e80]}, fc.DomainError, r"depths\[1\] = .*1e60"),
        ({**STRESS, "depths": np.zeros((2, 2))}, ValueError, "depths has the shape"),
        ({**STRESS, "depths": [None]}, TypeError, r"depths\[0\] is None"),
        ({**STRESS, "poisson": 0.6}, fc.DomainError, "oisson"),
        ({**STRESS, "poisson": np.nan}, fc.DomainError, "oisson"),
        ({**STRESS, "poisson": None}, TypeError, "poisson is None"),
        ({**STRESS, "boundary": "round"}, ValueError, "boundary is 'round'"),
        ({**STRESS, "traction": GAP}, ValueError, "traction: expected two arrays"),
        ({**STRESS, "traction": (GAP,)}, ValueError, "traction: expected two arrays"),
        ({**STRESS, "traction": 1.0}, ValueError, "traction: expected two arrays"),
        ({**STRESS, "traction": "ab"}, ValueError, "traction: expected two arrays"),
        (
            {**STRESS, "traction": (GAP, GAP.T)},
            fc.ShapeError,
            r"traction\[1\] has the shape \(7, 5\): expected \(5, 7\)",
        ),
        ({**STRESS, "traction": (GAP, NAN)}, fc.DomainError, r"traction along y\[1, 2\]"),
        ({**STRESS, "traction": np.zeros((2, 5))}, fc.ShapeError, r"traction\[0\] has 1 dimensions"),
        ({**STRESS, "origin": (1.0, 0.0)}, TypeError, "origin goes with points"),
        ({**POINTS, "points": [(0, 0, -1)]}, fc.DomainError, r"points\[0\].z = -1"),
        ({**POINTS, "points": [(0, 0, 1), (0, np.nan, 1)]}, fc.DomainError, r"points\[1\].y = NaN"),
        ({**POINTS, "points": [(1e80, 0, 1)]}, fc.DomainError, r"points\[0\].x = .*1e60"),
        ({**POINTS, "points": (0, 0, 1)}, fc.ShapeError, r"points has the shape \(3,\): expected \(points, 3\)"),
        ({**POINTS, "points": []}, fc.ShapeError, "at least one point"),
        ({**POINTS, "points": np.zeros((2, 2))}, fc.ShapeError, "points has the shape"),
        ({**POINTS, "points": [["a", "b", "c"]]}, TypeError, "points are of the type"),
        ({**POINTS, "points": [(0, 0, 1)], "origin": (0, 0, 0)}, ValueError, "origin has 3 numbers"),
        ({**POINTS, "points": [(0, 0, 1)], "origin": (0, np.nan)}, fc.DomainError, r"origin\[1\] = nan"),
        ({**POINTS, "points": [(0, 0, 1)], "origin": 0}, TypeError, "origin is 0"),
        ({**POINTS, "points": [(0, 0, 1)], "boundary": "periodic"}, fc.Unsupported, "stress at points"),
        ({**STRESS, "pressure": 1.7e308 * np.ones((9, 9)), "depths": [0.1], "poisson": 0.5}, fc.DomainError, "."),
    ],
)
def test_loads_that_make_no_sense(given, error, words):
    if words == ".":
        # Answers or exceptions, and none that is not finite.
        try:
            assert np.isfinite(fc.stress_below(**given)).all()
        except error:
            return
    else:
        with pytest.raises(error, match=words):
            fc.stress_below(**given)


def test_depths_of_the_largest_stress_that_make_no_sense():
    for depths, error, words in (
        ([], fc.ShapeError, "at least one depth"),
        ([0.1, -1.0], fc.DomainError, r"depths\[1\] = -1"),
        (1.0, TypeError, "depths is 1.0"),
    ):
        with pytest.raises(error, match=words):
            fc.largest_von_mises(GAP, cell=1.0, depths=depths, poisson=0.3)
    none = fc.largest_von_mises(0 * GAP, cell=1.0, depths=[0.5, 1.0], poisson=0.3)
    assert none.value == 0.0 and (none.stress == 0.0).all()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of Linux")
@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("fc.leakage(huge)", "the flow through a map of 20000 columns x 2000 rows: needs about 22"),
        ("fc.leakage(huge, continuum=False)", "the flow through a map of 20000 columns x 2000 rows: needs about 12"),
        ("fc.stress_below(huge, cell=1.0, depths=[1.0], poisson=0.3)", "the stress below a map of 20000 columns"),
        ("fc.stress_below(huge[:99], cell=1.0, depths=range(9999), poisson=0.3)", "the stress below a map of"),
        (
            "fc.stress_below(1 + huge[:99], cell=1.0, points=np.zeros((99999, 3)), poisson=0.3)",
            "the stress below a map of 20000 columns x 99 rows",
        ),
        ("fc.largest_von_mises(huge, cell=1.0, depths=[1.0], poisson=0.3)", "the stress below a map of 20000 columns"),
        (
            "fc.stress_below(huge[:1], cell=1.0, depths=[1.0], poisson=0.3, boundary={'x': 'periodic', 'y': 'free'})",
            "the stress below a map of 20000 columns x 1 rows",
        ),
    ],
)
def test_what_does_not_fit_under_six_gigabytes(call, words):
    code = f"""
import resource
resource.setrlimit(resource.RLIMIT_AS, (6 * 10**9, 6 * 10**9))
import numpy as np
import fractal_contact as fc
huge = np.broadcast_to(np.zeros(1), (2000, 20000))
try:
    {call}
except MemoryError as error:
    assert isinstance(error, fc.OutOfMemory) and error.needed > 6e9 / 2
    print(error)
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert told.returncode == 0, told.stderr
    assert told.stdout.startswith(words), told.stdout


# Ctrl-C, and other threads.


def test_a_film_between_the_contact_alone_and_more():
    gap = np.array([[0.0, 0.0, 0.02], [0.01, 0.0, 0.03], [0.05, 0.02, np.inf]])
    contact = fc.film_conductance(gap, 0.5, film=1e12, bodies=2.0)
    before = contact.upper
    for film in (100.0, 1.0, 0.01):
        found = fc.film_conductance(gap, 0.5, film=film, bodies=2.0)
        assert before < found.lower <= found.upper <= found.lower * (1 + 1e-8)
        np.testing.assert_allclose(found.current_density.sum() * 0.25, found.lower, rtol=1e-6)
        assert found.current_density[2, 2] == 0.0
        assert not found.current_density.flags.writeable
        before = found.upper
    # The same gap turned by a right angle, with cells of other sides.
    found, turned = (
        fc.film_conductance(g, cell, film=3.0, bodies=2.0) for g, cell in ((gap, (0.5, 0.7)), (gap.T, (0.7, 0.5)))
    )
    assert found.lower == pytest.approx(turned.lower, rel=1e-8)
    assert found == fc.film_conductance(gap, (0.5, 0.7), film=3.0, bodies=2.0)
    # One cell alone conducts as a square of uniform current, whose potential at its centre is 4 asinh(1)/(2 pi).
    alone = fc.film_conductance([[0.0]], 1.0, film=1.0, bodies=1.0)
    assert alone.lower == pytest.approx(2 * np.pi / (4 * np.arcsinh(1.0)), rel=1e-9)


def test_films_that_make_no_sense():
    for wrong in ({"film": 0.0}, {"film": np.nan}, {"bodies": -1.0}, {"tolerance": 0.0}):
        with pytest.raises(fc.DomainError):
            fc.film_conductance([[1.0]], **{"film": 1.0, "bodies": 1.0, **wrong})
    with pytest.raises(fc.DomainError, match="gap"):
        fc.film_conductance([[-1.0]], film=1.0, bodies=1.0)
    with pytest.raises(fc.DomainError, match="full contact"):
        fc.film_conductance(np.zeros((4, 4)), film=1.0, bodies=1.0, boundary="periodic")
    with pytest.raises(fc.Unsupported):
        fc.film_conductance(np.ones((4, 4)), film=1.0, bodies=1.0, boundary={"x": "periodic", "y": "free"})


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize(
    "work",
    [
        lambda big: fc.leakage(big),
        lambda big: fc.film_conductance(big, film=1e-3, bodies=1.0, tolerance=1e-13),
        lambda big: fc.stress_below(big, cell=1.0, depths=range(1, 400), poisson=0.3),
        lambda big: fc.stress_below(big, cell=1.0, points=np.ones((10_000, 3)), poisson=0.3),
        lambda big: fc.largest_von_mises(big, cell=1.0, depths=range(1, 400), poisson=0.3),
    ],
    ids=["leakage", "film", "depths", "points", "largest"],
)
def test_ctrl_c(work):
    big = np.random.default_rng(1).lognormal(sigma=2.0, size=(1000, 1000))
    # A second thread counts while the first one computes without the interpreter's lock.
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    sender = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    other.start()
    sender.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            work(big)
    finally:
        sender.join()
        done.set()
        other.join()
    assert counted[0] > 10
