"""Tests of ContactMechanics with the solver of this package in the place of its own.

ContactMechanics (L. Pastewka, A. Sanner, T. Junge and others, MIT) has tests of its contact solver: ``test_hertz``,
``test_flat_punch``, ``test_westergaard`` and ``test_periodic`` in the folder ``test`` of its repository
(github.com/ContactEngineering/ContactMechanics, version 1.8.3). Its package does not contain them. Here are the same
bodies, grids, loads and tolerances, and its own half-spaces, surfaces and exact solutions.
"""

import numpy as np
import pytest

import fractal_contact as fc

ContactMechanics = pytest.importorskip("ContactMechanics")
Hertz = pytest.importorskip("ContactMechanics.ReferenceSolutions.Hertz")
Systems = pytest.importorskip("ContactMechanics.Systems")
Westergaard = pytest.importorskip("ContactMechanics.ReferenceSolutions.Westergaard")
Generation = pytest.importorskip("SurfaceTopography.Generation")
SurfaceTopography = pytest.importorskip("SurfaceTopography")
optimize = pytest.importorskip("scipy.optimize")

TOLERANCE = 1e-8


def minimize_proxy(system, offset=None, external_force=None, **_):
    """Replaces ``NonSmoothContactSystem.minimize_proxy``; its options of the iteration have no meaning here.

    Their arrays are [x, y] and ours are [row, column]. Their offset moves the surface, so that the approach from
    first touch is the offset and the highest height. Displacements are those of their half-space under our forces.
    """
    substrate, heights = system.substrate, system.surface.heights()
    height_map = fc.HeightMap(
        np.ma.filled(np.ma.asarray(heights, dtype=float), np.nan).T,
        size=tuple(substrate.physical_sizes),
        undefined="no_contact",
    )
    periodic = not isinstance(substrate, ContactMechanics.FreeFFTElasticHalfSpace)
    scene = fc.Scene(
        height_map,
        contact_modulus=substrate.contact_modulus,
        outputs=["pressure", "mean_gap"] if periodic else ["pressure"],
        effects={"boundary": "periodic"} if periodic else {},
    )
    contact = fc.Bem3d(tolerance=TOLERANCE).prepare(scene)
    if external_force is not None:
        state = contact.solve(force=external_force)
    elif periodic:
        state = at_offset(contact, offset + heights.mean(), substrate.surface_stiffness[0, 0].real)
    else:
        state = contact.solve(approach=offset + heights.max())
    forces = np.asarray(state.pressure).T * substrate.area_per_pt
    padded = np.zeros(substrate.nb_subdomain_grid_pts)
    padded[system.comp_slice] = forces
    result = optimize.OptimizeResult(
        x=substrate.evaluate_disp(-padded),
        jac=forces,
        offset=offset if external_force is None else state.approach - heights.max(),
        success=state.certificate.worst <= TOLERANCE,
    )
    system.offset, system.disp, system.contact_zone = result.offset, result.x, forces > 0
    system.force = substrate.force = forces
    substrate.check()
    return result


def at_offset(contact, mean_height, spring):
    """The state of a periodic contact whose mean displacement is the mean pressure over the stiffness of a spring.

    Their half-space has this spring at the wave of length infinity. The mean height includes the offset.
    """

    def excess(pressure):
        return contact.solve(mean_pressure=pressure).mean_gap + mean_height - pressure / spring

    full = spring * mean_height
    if full > 0 and contact.solve(mean_pressure=full).mean_gap <= 0:
        return contact.last
    high = max(full, 0) + spring * 1e-9
    while excess(high) > 0:
        high *= 2
    low = high
    while excess(low) < 0:
        low /= 2
    return contact.solve(mean_pressure=optimize.brentq(excess, low, high, xtol=1e-12, rtol=1e-12))


@pytest.fixture(autouse=True)
def our_solver(monkeypatch):
    """Replaces the solver, and counts its solves."""
    solves = []
    monkeypatch.setattr(
        Systems.NonSmoothContactSystem, "minimize_proxy", lambda *a, **k: solves.append(0) or minimize_proxy(*a, **k)
    )
    yield
    assert solves


@pytest.mark.parametrize("offset, force", [(0.1, None), (None, 15.0)])
@pytest.mark.parametrize("cells", [(512, 512), (512, 511), (511, 512)])
def test_hertz(cells, offset, force):
    radius, modulus, size = 20.0, 102.0, (5.0, 5.0)
    substrate = ContactMechanics.FreeFFTElasticHalfSpace(cells, modulus, size)
    system = Systems.NonSmoothContactSystem(substrate, SurfaceTopography.make_sphere(radius, cells, size))
    result = system.minimize_proxy(offset=offset, external_force=force)
    assert result.success
    total = result.jac.sum()
    if force is None:
        np.testing.assert_allclose(result.offset, offset, rtol=1e-7)
        np.testing.assert_allclose(total, Hertz.normal_load(offset, radius, modulus), rtol=1e-2)
        energy = Hertz.elastic_energy(offset, radius, modulus)
    else:
        np.testing.assert_allclose(total, force, rtol=1e-7)
        penetration = Hertz.penetration(force, radius, modulus)
        np.testing.assert_allclose(result.offset, penetration, rtol=1e-2)
        energy = Hertz.elastic_energy(penetration, radius, modulus)
    np.testing.assert_allclose(system.compute_normal_force(), total, rtol=1e-7)
    a, p0 = Hertz.radius_and_pressure(total, radius, modulus)
    np.testing.assert_allclose(system.compute_contact_area(), np.pi * a**2, rtol=1e-1)
    for forces in (False, True):
        np.testing.assert_allclose(substrate.evaluate(result.x, pot=True, forces=forces)[0], energy, rtol=1e-2)
    x, y = (np.arange(n) * length / n - length / 2 for n, length in zip(cells, size, strict=True))
    r = np.hypot(x[:, None], y)
    inside = r < 0.99 * a
    exact = p0 * np.sqrt(1 - (r[inside] / a) ** 2)
    assert np.abs(exact - result.jac[inside] / substrate.area_per_pt).max() / modulus < 1e-3


@pytest.mark.parametrize("nx", [255, 256])
@pytest.mark.parametrize("ny", [255, 256])
@pytest.mark.parametrize("offset, force", [(None, 15), (0.1, None)])
def test_flat_punch(nx, ny, offset, force):
    radius, modulus = 20.0, 3.56
    size = 2.5 * radius
    substrate = ContactMechanics.FreeFFTElasticHalfSpace((nx, ny), modulus, (size, size))
    x, y = (size / n * (np.arange(n) - n // 2) for n in (nx, ny))
    outside = x[:, None] ** 2 + y**2 > radius**2
    punch = SurfaceTopography.Topography(np.ma.masked_where(outside, np.zeros((nx, ny))), (size, size))
    result = ContactMechanics.make_system(substrate=substrate, surface=punch).minimize_proxy(
        offset=offset, external_force=force
    )
    assert result.success
    if force is None:
        np.testing.assert_almost_equal(result.offset, offset)
    else:
        np.testing.assert_almost_equal(result.jac.sum(), force)
    np.testing.assert_almost_equal(result.jac.sum() / result.offset / (2 * radius * modulus), 1.0, decimal=2)


@pytest.mark.parametrize("offset", [-0.9, -0.1])
def test_westergaard(offset):
    nx, ny, sx, sy, modulus = 256, 16, 30.0, 1.0, 3.56
    substrate = ContactMechanics.PeriodicFFTElasticHalfSpace((nx, ny), modulus, (sx, sy))
    x = np.arange(nx) / nx
    wave = SurfaceTopography.Topography(np.tile(np.cos(2 * np.pi * x)[:, None], ny), (sx, sy))
    result = ContactMechanics.make_system(substrate=substrate, surface=wave).minimize_proxy(offset=offset)
    assert result.success
    pressure = result.jac / substrate.area_per_pt
    mean = pressure.mean()
    exact = mean * Westergaard._pressure(x, mean_pressure=sx * mean / modulus)
    assert np.allclose(pressure[: nx // 2, 0], exact[: nx // 2], atol=1e-2)


def test_periodic():
    cells, size = (512, 512), (1.0, 1.0)
    np.random.seed(999)
    rough = Generation.fourier_synthesis(cells, size, 0.8, rms_slope=0.1)
    substrate = ContactMechanics.PeriodicFFTElasticHalfSpace(cells, 1, size)
    result = ContactMechanics.make_system(substrate=substrate, surface=rough).minimize_proxy(offset=0.1)
    # Their test asserts nothing further.
    assert result.success
