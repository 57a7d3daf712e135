"""From arrays to states."""

import pickle
import re

import numpy as np
import pytest

import fractal_contact as fc


def rough(cells=65, seed=1):
    surface = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    return fc.surface_gen.self_affine_map(surface, cells, seed)


def test_first_contact_in_ten_lines():
    h = rough().heights
    scene = fc.Scene(fc.HeightMap(h, size=(1.0, 1.0)), contact_modulus=1.0, outputs=["stiffness", "pressure"])
    c = fc.Bem3d(tolerance=1e-8).prepare(scene)
    s = c.solve(force=0.1)
    assert s.force == pytest.approx(0.1, rel=1e-12)
    assert s.approach > 0 and s.stiffness > 0
    assert s.pressure.sum() / h.size == pytest.approx(0.1, rel=1e-12)
    assert s.certificate.meets(1e-8) and s.certificate.worst <= 1e-8
    assert s.status == "converged" and s.area is None and s.gap is None
    assert "stiffness=" in repr(s) and "rms height" in repr(c)


def test_rows_and_columns():
    # One summit in row 2, column 5, at x = 5.5 of 8 and y = 2.5 of 4.
    h = np.zeros((4, 8))
    h[2, 5] = 1.0
    scene = fc.Scene(fc.HeightMap(h, size=(8.0, 4.0)), contact_modulus=1.0, outputs=["pressure", "gap", "displacement"])
    s = fc.Bem3d().prepare(scene).solve(force=1e-3)
    assert s.pressure.shape == (4, 8)
    assert np.argwhere(s.pressure > 0).tolist() == [[2, 5]]
    assert s.gap[2, 5] == pytest.approx(0, abs=1e-9) and s.displacement[2, 5] == s.displacement.max()


def test_loads_are_one_of_four():
    periodic = {"boundary": "periodic"}
    scene = fc.Scene(rough(64), contact_modulus=2.0, effects=periodic, outputs=["mean_gap", "stiffness"])
    contact = fc.Bem3d().prepare(scene)
    state = contact.solve(mean_pressure=0.01)
    assert state.force == pytest.approx(0.01) and state.approach is None
    assert contact.solve(mean_gap=state.mean_gap).force == pytest.approx(0.01, rel=1e-4)
    free = fc.Bem3d().prepare(fc.Scene(rough(), contact_modulus=2.0))
    one = free.solve(force=0.01)
    assert free.solve(approach=one.approach).force == pytest.approx(0.01, rel=1e-4)
    for wrong in ({}, {"force": 1.0, "approach": 1.0}):
        with pytest.raises(TypeError, match="exactly one of"):
            free.solve(**wrong)


def test_sweep_yields_states_as_they_come():
    contact = fc.Bem3d().prepare(fc.Scene(rough(), contact_modulus=1.0, outputs=["stiffness", "area"]))
    states = contact.sweep(force=np.geomspace(1e-4, 1e-2, 5))
    first = next(states)
    rest = list(states)
    assert len(rest) == 4 and first.force < rest[0].force
    rows = fc.table([first, *rest])
    assert rows.dtype.names[0] == "force" and np.all(np.diff(rows["area"]) > 0)
    assert np.isnan(rows["mean_gap"]).all() and set(rows["status"]) == {"converged"}
    with pytest.raises(TypeError, match="exactly one of"):
        contact.sweep()
    # A load that the model refuses is an exception at its place; what comes before is there.
    before = contact.sweep(force=[1e-3, -1.0])
    assert next(before).force == pytest.approx(1e-3)
    with pytest.raises(fc.DomainError):
        next(before)


def test_arrays_stay_after_later_solves():
    contact = fc.Bem3d().prepare(fc.Scene(rough(), contact_modulus=1.0, outputs=["pressure"]))
    first = contact.solve(force=1e-3)
    kept, copy = first.pressure, first.pressure.copy()
    for force in (1e-2, 1e-1):
        contact.solve(force=force)
    assert np.array_equal(kept, copy) and first.pressure is kept
    del first, contact
    assert np.array_equal(kept, copy)


def test_undefined_points_cannot_touch():
    h = np.array(rough())
    mask = np.zeros(h.shape, dtype=bool)
    mask[np.unravel_index(h.argmax(), h.shape)] = True
    masked = fc.HeightMap(np.ma.masked_array(h, mask), size=1.0)
    h[mask] = np.nan
    marked = fc.HeightMap(h, size=1.0, undefined="no_contact")
    assert masked.equals(marked) and masked.undefined == 1 and np.isnan(masked.heights[mask]).all()
    scene = fc.Scene(masked, contact_modulus=1.0, outputs=["pressure", "gap"])
    state = fc.Bem3d().prepare(scene).solve(force=0.01)
    assert (state.pressure[mask] == 0).all() and np.isinf(state.gap[mask]).all()


def test_not_converged_has_its_best_state():
    contact = fc.Bem3d(max_outer_iterations=1).prepare(fc.Scene(rough(), contact_modulus=1.0))
    with pytest.raises(fc.NotConverged) as caught:
        contact.solve(force=0.01)
    assert caught.value.best.status == "iteration_limit"
    assert not caught.value.best.certificate.meets(1e-6)


def test_models_refuse_what_they_lack():
    with pytest.raises(fc.Unsupported) as caught:
        fc.Hertz().prepare(fc.Scene(rough(), contact_modulus=1.0))
    assert caught.value.model == "hertz" and "height map" in caught.value.what
    assert "bem3d" in caught.value.able and "hertz" not in caught.value.able
    assert re.search(r"does not support a height map; models that may: fc\.Bem3d\b", str(caught.value))
    assert pickle.loads(pickle.dumps(caught.value)).able == caught.value.able
    both = fc.Scene(rough(), contact_modulus=1.0, effects=fc.Effects(hardness=1.0, adhesion=0.1))
    with pytest.raises(fc.Unsupported, match="together"):
        fc.Bem3d().prepare(both)


def test_maps_are_added_and_turned():
    a, b = rough(seed=1), rough(seed=2)
    assert np.array_equal((a + b).heights, a.heights + b.heights)
    assert np.array_equal((a - b).heights, a.heights - b.heights)
    assert np.array_equal(a.transposed().heights, a.heights.T)
    assert np.array_equal(a.mirrored().heights, a.heights[:, ::-1])
    assert np.array_equal(a.cropped((3, 9), (1, 4)).heights, a.heights[3:9, 1:4])
    assert a.scaled(2.0, 3.0).size == (2.0, 2.0)
    assert "data:image/png;base64" in a._repr_html_()


@pytest.mark.parametrize(
    ("model", "surface", "effects"),
    [
        (fc.Hertz(), fc.Surface.sphere(radius=1.0, size=4.0), {}),
        (fc.PowerLawBody(), fc.Surface.cone(slope=0.1, size=4.0), {}),
        (fc.PowerLawBody(), fc.Surface.power_law(coefficient=0.1, exponent=4.0, size=4.0), {}),
        (fc.FlatPunch(), fc.Surface.flat_circle(radius=0.5, size=4.0), {}),
        (fc.Mdr1d(), fc.Surface.sphere(radius=1.0, size=4.0), {}),
        (fc.Jkr(), fc.Surface.sphere(radius=1.0, size=4.0), {"adhesion": 0.001}),
        (fc.Westergaard(), fc.Surface.sine(amplitude=0.01, wavelength=1.0, size=1.0), {"boundary": "periodic"}),
    ],
)
def test_closed_forms(model, surface, effects):
    scene = fc.Scene(surface, contact_modulus=1.0, effects=effects)
    state = model.prepare(scene).solve(force=0.001)
    assert state.force == pytest.approx(0.001, rel=1e-9) and state.stiffness > 0
    assert model.sources and eval(repr(model), vars(fc)) == model


def test_theories_of_rough_contact():
    rough_surface = fc.Surface.self_affine(
        hurst=0.8, size=1.0, rms_height=0.01, roll_off_wavelength=0.25, shortest_wavelength=0.05
    )
    scene = fc.Scene(rough_surface, contact_modulus=1.0, outputs=["area"], effects={"boundary": "periodic"})
    areas = [
        model.prepare(scene, seed=1).solve(mean_pressure=1e-3).area
        for model in (fc.Persson(), fc.Persson(gamma=0.5), fc.GreenwoodWilliamson(), fc.Bem3d(cells=128))
    ]
    assert all(0.003 < area < 0.05 for area in areas), areas


def test_paths():
    body = fc.Body(young=2.0, poisson=0.3)
    sphere = fc.Surface.sphere(radius=1.0, size=2.0)
    scene = fc.Scene(sphere, bodies=(body, body), effects={"friction": 0.5})
    ratios = []
    for model in (fc.CattaneoMindlin(), fc.PartialSlip(), fc.Equivalent(fc.Mdr1d())):
        path = model.prepare(scene)
        path.advance(force=0.01)
        state = path.advance(force=0.01, tangential_force=0.0025)
        ratios.append(state.stick_radius / state.contact_radius)
        assert state.dissipated > 0 and state.force == pytest.approx(0.01)
        with pytest.raises(fc.OutOfRange):
            path.advance(force=0.01, tangential_force=1.0)
        path.restart()
        assert path.advance(force=0.0).force == 0.0
    # Cattaneo and Mindlin: (1 - 1/2)^(1/3).
    assert ratios == pytest.approx([0.5 ** (1 / 3)] * 3, rel=1e-3)
    solid = {"kind": "standard_solid", "weight": 1.0, "time": 1.0}
    creeping = fc.Viscoelastic().prepare(fc.Scene(sphere, contact_modulus=1.0, effects={"rheology": solid}, outputs=[]))
    depths = [creeping.advance(time, force=0.01).approach for time in (0.0, 1.0, 10.0)]
    assert depths[0] < depths[1] < depths[2]
    # A single load is reached from no contact, and the path goes on from there.
    friction = fc.PartialSlip().prepare(scene)
    assert friction.solve(force=0.01).contact_radius == friction.advance(force=0.01).contact_radius


def test_ensembles_are_the_surfaces_of_rust():
    surface = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    scene = fc.Scene(surface, contact_modulus=1.0)
    told = []
    found = fc.ensemble(
        fc.Bem3d(cells=33), scene, seed=5, surfaces=4, force_bar=[0.1, 1.0], progress=lambda *n: told.append(n)
    )
    assert told[-1] == (4, 4) and [len(states) for states in found] == [2] * 4
    for index, states in enumerate(found):
        contact = fc.Bem3d(cells=33).prepare(scene, seed=fc.surface_gen.surface_seed(5, index))
        force = contact.normalisation.force(0.1)
        assert contact.solve(force=force).stiffness == states[0].stiffness


def test_conductance_and_patches():
    scene = fc.Scene(
        rough(), contact_modulus=1.0, outputs=["area", "contact_patches"], conductance=("electrical", 1.0, 1.0)
    )
    state = fc.Bem3d().prepare(scene).solve(force=0.01)
    assert state.patches.sum() == pytest.approx(state.area) and np.all(np.diff(state.patches) <= 0)
    assert state.conductance > 0 and state.stiffness is None


def test_an_adhesive_contact_has_two_stiffnesses():
    sphere = fc.Surface.sphere(radius=1.0, size=4.0)
    outputs = ["stiffness", "stiffness_fixed_area", "area"]
    scene = fc.Scene(
        sphere, contact_modulus=2.0, effects={"adhesion": 0.02}, outputs=outputs, conductance=("electrical", 1.0, 3.0)
    )
    contact = fc.Jkr().prepare(scene)
    state = contact.solve(force=0.0)
    # Without load 3/5 of 2 E* a; 2 k/(E* (1 + 3)) of the held area.
    held = 4.0 * np.sqrt(state.area / np.pi)
    assert state.stiffness_fixed_area == pytest.approx(held, rel=1e-12)
    assert state.stiffness == pytest.approx(0.6 * held, rel=1e-12)
    assert state.conductance == pytest.approx(0.25 * held, rel=1e-12)
    assert "stiffness_fixed_area=" in repr(state)
    told = state.to_dict()
    assert told["stiffness_fixed_area"] == state.stiffness_fixed_area and told["stiffness_error"] == 0.0
    # A force has an error where it is a result.
    certificate = state.certificate
    assert (certificate.force_error, certificate.quotient_error, certificate.error_of_stiffness) == (None, None, 0.0)
    assert contact.solve(approach=0.1).certificate.force_error == told["load_error"] == 0.0


def test_lines_stand_for_rectangles():
    heights = 0.01 * np.cos(2 * np.pi * np.arange(256) / 64)
    line = fc.Surface.line(heights, length=2 / np.sqrt(np.pi), size=1.0)
    state = fc.Mdr1d().prepare(fc.Scene(line, contact_modulus=1.0)).solve(force=1e-3)
    assert state.stiffness > 0 and line == fc.Surface.line(heights.tolist(), length=2 / np.sqrt(np.pi), size=1.0)
    with pytest.raises(ValueError, match="2 dimensions"):
        fc.Surface.line(np.zeros((2, 2)), length=1.0, size=1.0)
