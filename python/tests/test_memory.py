"""What does not fit in memory is an exception with its size, before the memory is asked for."""

import os
import pickle
import subprocess
import sys

import pytest

import fractal_contact as fc

BEGIN = """
import resource
resource.setrlimit(resource.RLIMIT_AS, (6 * 10**9, 6 * 10**9))
import numpy as np
import fractal_contact as fc

rough = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
sphere = fc.Surface.sphere(radius=1.0, size=1.0)
rubbing = {"bodies": (fc.Body(1.0, 0.3), None), "effects": {"friction": 0.3}}
"""


def limited(code):
    """What a process prints whose address space ends at 6 GB."""
    told = subprocess.run([sys.executable, "-c", BEGIN + code], capture_output=True, text=True, timeout=300)
    assert told.returncode == 0, told.stderr
    return told.stdout.strip()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of Linux")
@pytest.mark.parametrize(
    ("call", "size"),
    [
        ("rough.height_map(20000, 1)", "a map of 20000 columns x 20000 rows: needs about 6.4 GB"),
        ("sphere.height_map((2**62, 2**62))", "a map of 4611686018427387904 columns x"),
        ("fc.HeightMap(np.zeros((20000, 20000)), size=1.0)", "a map of 20000 columns x 20000 rows: needs about 3.2 GB"),
        ("fc.Bem3d(cells=20000).prepare(fc.Scene(rough, 1.0))", "a contact of 20000 columns x 20000 rows: needs"),
        ("fc.Bem3d(cells=20000).prepare(fc.Scene(sphere, 1.0)).solve(force=0.01)", "a contact of 20000 columns x"),
        (
            "fc.Bem3d(cells=20000).prepare(fc.Scene(sphere, 1.0, effects={'hardness': 0.1}))",
            "a contact of 20000 columns x",
        ),
        ("fc.Equivalent(fc.Bem3d(cells=20000)).prepare(fc.Scene(sphere, **rubbing))", "a contact of 20000 columns x"),
        # There is memory for the contact, and for a light load, but not for a contact that fills the grid.
        ("fc.Bem3d(cells=8001).prepare(fc.Scene(sphere, 1.0)).solve(force=5.0)", "a solve on 8001 columns x 8001 rows"),
        (
            "fc.Bem3d(cells=8001).prepare(fc.Scene(sphere, 1.0, effects={'hardness': 9.0})).advance(force=5.0)",
            "a solve on 8001 columns x 8001 rows",
        ),
        ("fc.Mdr1d(elements=10**9).prepare(fc.Scene(rough, 1.0, outputs=[]))", "a line of 1000000000 elements: needs"),
        (
            "fc.ensemble(fc.Bem3d(cells=33), fc.Scene(rough, 1.0), seed=1, surfaces=10**9, force=[0.1, 1.0])",
            "an ensemble of 1000000000 surfaces x 2 loads: needs",
        ),
        (
            "fc.surface_gen.twin(fc.HeightMap(np.zeros((10000, 10000)), size=1.0), 1, keep_heights=True)",
            "a map of 10000 columns x",
        ),
        (
            "fc.statistics.parameters(fc.HeightMap(np.zeros((5000, 5000)), size=1.0))",
            "the statistics of a map of 5000 columns x",
        ),
    ],
)
def test_what_does_not_fit_under_six_gigabytes(call, size):
    told = limited(f"""
try:
    {call}
except MemoryError as error:
    assert isinstance(error, fc.OutOfMemory) and error.needed > error.available > 0
    print(error)
""")
    assert told.startswith(size) and told.endswith("GB are available"), told


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of Linux")
def test_what_fits_under_six_gigabytes():
    told = limited("""
map = rough.height_map(4001, 1)
assert map.transposed().cropped((0, 100), (0, 200)).shape == (100, 200)
print(fc.Bem3d(tolerance=1e-3).prepare(fc.Scene(map, contact_modulus=1.0)).solve(force=1e-5).status)
""")
    assert told == "converged"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of Linux")
@pytest.mark.parametrize("megabytes", [20, 50, 75, 90, 130])
def test_with_little_to_spare_a_solve_is_refused_or_done(megabytes):
    """About 83 MB are told for contact nearly everywhere on 601 x 601 cells."""
    code = """
import resource, sys
import fractal_contact as fc
rough = fc.Surface.self_affine(hurst=0.5, size=1.0, rms_height=0.01)
map = rough.height_map(601, 1)
fc.set_threads(1)
# Threads and their arenas are there before the limit.
fc.Bem3d().prepare(fc.Scene(rough.height_map(129, 1), 1.0)).solve(force=0.1)
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + int(sys.argv[1]) * 10**6
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
scene = fc.Scene(map, 1.0, outputs=["stiffness", "pressure", "gap", "contact_patches"])
try:
    print(fc.Bem3d(tolerance=1e-3).prepare(scene).solve(force=2.0).status)
except MemoryError as error:
    assert error.needed > error.available > 0
    print(error)
"""
    run = [sys.executable, "-c", code, str(megabytes)]
    told = subprocess.run(run, capture_output=True, text=True, timeout=300)
    assert told.returncode == 0, told.stderr
    refused = "a contact of 601 columns" if megabytes < 30 else "a solve on 601 columns"
    assert told.stdout.startswith(refused if megabytes < 80 else "converged"), told.stdout


@pytest.mark.parametrize("cells", [10**9, (10**9, 10**9), (2**40, 2**40), 2**63])
def test_absurd_numbers_of_cells(cells):
    flat, rough = fc.Surface.flat(size=1.0), fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    for surface in (flat, rough):
        with pytest.raises((MemoryError, OverflowError)):
            surface.height_map(cells)
    columns, rows = cells if isinstance(cells, tuple) else (cells, None)
    with pytest.raises((MemoryError, fc.DomainError)):
        fc.Bem3d(cells=columns, rows=rows).prepare(fc.Scene(flat, contact_modulus=1.0))


@pytest.mark.parametrize("surfaces", [-1, 2**63, 2**64, 10**30, 1.5, "many", None])
def test_absurd_numbers_of_surfaces(surfaces):
    rough = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    with pytest.raises((MemoryError, ValueError, TypeError)):
        fc.ensemble(fc.Bem3d(cells=17), fc.Scene(rough, contact_modulus=1.0), seed=1, surfaces=surfaces, force=[0.1])


def test_the_error_is_pickled():
    with pytest.raises(fc.OutOfMemory) as caught:
        fc.Surface.flat(size=1.0).height_map(10**9)
    again = pickle.loads(pickle.dumps(caught.value))
    assert isinstance(again, MemoryError) and isinstance(again, fc.Error)
    assert again.needed == 8e18 and "1000000000 columns x 1000000000 rows" in again.what
    if os.path.exists("/proc/meminfo"):
        assert 0 < again.available < 8e18


def test_no_cells_and_no_surfaces():
    rough = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    for cells in (0, (0, 5), (5, 0)):
        with pytest.raises(fc.DomainError):
            rough.height_map(cells)
    with pytest.raises(fc.DomainError):
        fc.Bem3d(cells=0).prepare(fc.Scene(rough, contact_modulus=1.0))
    assert fc.ensemble(fc.Bem3d(cells=17), fc.Scene(rough, contact_modulus=1.0), seed=1, surfaces=0, force=[0.1]) == []
