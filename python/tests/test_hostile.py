"""Whatever is passed is an answer or an exception, never a crash."""

import contextlib
import itertools

import numpy as np
import pytest

import fractal_contact as fc

GOOD = np.arange(12.0).reshape(3, 4)


@pytest.mark.parametrize(
    "array",
    [
        GOOD.tolist(),
        GOOD.astype(np.float32),
        GOOD.astype(np.int16),
        GOOD.astype(">f8"),
        np.asfortranarray(GOOD),
        np.repeat(np.repeat(GOOD, 2, 0), 3, 1)[::2, ::3],
        GOOD[::-1, ::-1][::-1, ::-1],
        np.broadcast_to(np.arange(4.0), (3, 4)) + np.arange(0, 12, 4)[:, None],
    ],
)
def test_arrays_of_any_order_and_real_type(array):
    assert np.array_equal(fc.HeightMap(array, size=1.0).heights, GOOD)


def test_read_only_arrays_are_read():
    array = GOOD.copy()
    array.flags.writeable = False
    assert fc.HeightMap(array, size=(2.0, 1.0)).cell == (0.5, 1.0 / 3.0)


@pytest.mark.parametrize(
    ("array", "error", "words"),
    [
        (np.zeros((0, 3)), fc.ShapeError, "at least one cell"),
        (np.zeros((3, 0)), fc.ShapeError, "at least one cell"),
        ([], fc.ShapeError, "expected 2"),
        (np.zeros(3), fc.ShapeError, "1 dimensions"),
        (np.zeros((2, 2, 2)), fc.ShapeError, "3 dimensions"),
        (np.float64(1.0), fc.ShapeError, "0 dimensions"),
        (GOOD + 0j, TypeError, "complex128"),
        (GOOD.astype(str), TypeError, "expected real numbers"),
        (GOOD.astype(object), TypeError, "object"),
        (None, TypeError, "object"),
        ("heights", TypeError, "expected real numbers"),
        ([[1.0], [1.0, 2.0]], ValueError, "."),
        (np.where(GOOD == 6, np.nan, GOOD), fc.DomainError, r"heights\[1, 2\] is NaN"),
        (np.where(GOOD == 6, np.inf, GOOD), fc.DomainError, "inf"),
        (np.full((2, 2), np.nan), fc.DomainError, "NaN"),
    ],
)
def test_arrays_that_are_no_heights(array, error, words):
    with pytest.raises(error, match=words):
        fc.HeightMap(array, size=1.0)


def test_all_points_undefined():
    with pytest.raises(fc.DomainError, match="undefined"):
        fc.HeightMap(np.full((2, 2), np.nan), size=1.0, undefined="no_contact")
    with pytest.raises(ValueError, match="expected"):
        fc.HeightMap(GOOD, size=1.0, undefined="perhaps")


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf, (1.0, 0.0)])
def test_sizes_that_make_no_sense(size):
    with pytest.raises((fc.Error, TypeError)):
        fc.Bem3d().prepare(fc.Scene(fc.HeightMap(GOOD, size=size), contact_modulus=1.0)).solve(force=1e300)


@pytest.mark.parametrize("size", ["1 furlong", "1 mm x", "", ("1 mm", "2 parsnips"), "1 kPa"])
def test_sizes_that_are_no_lengths(size):
    with pytest.raises(ValueError, match="size = "):
        fc.HeightMap(GOOD, size=size)


def test_units():
    told = fc.HeightMap(GOOD, size=("2 mm", "1 mm"), unit="nm")
    assert told.size == (2e-3, 1e-3) and np.allclose(told.heights, GOOD * 1e-9, rtol=1e-15, atol=0)
    assert fc.HeightMap(GOOD, size="1 um").size == (1e-6, 1e-6)
    for unit in ("parsnip", "kPa", ""):
        with pytest.raises(ValueError, match="unit"):
            fc.HeightMap(GOOD, size=1.0, unit=unit)
    with pytest.raises(ValueError, match="lightyears"):
        fc.si("3 lightyears")


@pytest.mark.parametrize("size", [(1.0,), (1.0, 2.0, 3.0), None, 1j])
def test_sizes_of_other_types(size):
    with pytest.raises(TypeError):
        fc.HeightMap(GOOD, size=size)


NUMBERS = [0.0, -1.0, 1e-320, 1e308, np.nan, np.inf, -np.inf, None, "1", 1j, [1.0], 10**400, np.float32(1.0), True]


@pytest.mark.parametrize(
    ("kind", "value"), list(itertools.product(["force", "approach", "mean_pressure", "mean_gap"], NUMBERS))
)
def test_loads(kind, value):
    contact = fc.Bem3d().prepare(fc.Scene(fc.HeightMap(GOOD, size=1.0), contact_modulus=1.0))
    try:
        state = contact.solve(**{kind: value})
    except (fc.Error, TypeError, OverflowError):
        return
    assert np.isfinite(state.force)


@pytest.mark.parametrize("value", NUMBERS)
def test_moduli_and_options(value):
    for make in (
        lambda: fc.Scene(fc.HeightMap(GOOD, size=1.0), contact_modulus=value),
        lambda: fc.Scene(fc.HeightMap(GOOD, size=1.0), bodies=(fc.Body(value, 0.3), None)),
        lambda: fc.Scene(fc.HeightMap(GOOD, size=1.0), bodies=(fc.Body(1.0, value), None)),
        lambda: fc.Bem3d(tolerance=value),
        lambda: fc.Bem3d(cells=value),
        lambda: fc.Mdr1d(elements=value),
        lambda: fc.Persson(gamma=value),
        lambda: fc.Surface.sphere(radius=value, size=1.0),
        lambda: fc.Surface.self_affine(hurst=value, size=1.0, rms_height=0.1),
        lambda: fc.Surface.self_affine(hurst=0.5, size=1.0, rms_height=value),
        lambda: fc.Effects(friction=value) and fc.Scene(fc.HeightMap(GOOD, 1.0), 1.0, effects={"friction": value}),
    ):
        with contextlib.suppress(ValueError, fc.Error, TypeError, OverflowError):
            make()


def test_huge_maps_are_refused_before_they_are_drawn():
    flat = fc.Surface.flat(size=1.0)
    for cells in (10**7, (2**40, 2**40)):
        with pytest.raises((fc.Error, OverflowError)):
            flat.height_map(cells)
    with pytest.raises(fc.Error):
        fc.Bem3d(cells=10**7).prepare(fc.Scene(flat, contact_modulus=1.0))


def test_mappings_that_hold_themselves():
    endless = {"work": 1.0}
    endless["range"] = endless
    arms = []
    arms.append(arms)
    for effects in ({"adhesion": endless}, {"rheology": {"kind": "prony", "weights": arms, "times": [1.0]}}):
        with pytest.raises(ValueError, match="nested more than 8 deep"):
            fc.Effects(**effects)
    with pytest.raises(ValueError, match="nested more than 8 deep"):
        fc.Bem3d(cells=endless)


def test_words_that_nothing_is_called():
    map_ = fc.HeightMap(GOOD, size=1.0)
    with pytest.raises(ValueError, match='no output is called "stifness"'):
        fc.Scene(map_, contact_modulus=1.0, outputs=["stifness"])
    with pytest.raises(TypeError, match="expected a list of names"):
        fc.Scene(map_, contact_modulus=1.0, outputs="stiffness")
    with pytest.raises(ValueError, match="boundary"):
        fc.Scene(map_, contact_modulus=1.0, effects={"boundary": "round"})
    with pytest.raises(TypeError, match="adhesiom"):
        fc.Scene(map_, contact_modulus=1.0, effects={"adhesiom": 1.0})
    with pytest.raises(ValueError, match="rheology"):
        fc.Scene(map_, contact_modulus=1.0, effects={"rheology": {"kind": "jelly"}})
    with pytest.raises(TypeError, match="`viscosity` is missing"):
        fc.Scene(map_, contact_modulus=1.0, effects={"rheology": {"kind": "maxwell"}})
    with pytest.raises(TypeError, match="give contact_modulus or bodies"):
        fc.Scene(map_)
    with pytest.raises(ValueError, match="method"):
        fc.Bem3d(method="magic")
    with pytest.raises(TypeError):
        fc.Bem3d(tolerence=1e-8)
    with pytest.raises(fc.DomainError, match="expected a whole number >= 1"):
        fc.Bem3d(cells=-3)
    with pytest.raises(TypeError, match="elements` is text"):
        fc.Mdr1d(elements="many")
    with pytest.raises(TypeError, match="radius = None"):
        fc.Surface.sphere(radius=None, size=1.0)
