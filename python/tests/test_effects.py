"""Hardness and adhesion: states, paths, errors."""

import itertools
import os
import pickle
import re
import signal
import threading
from pathlib import Path

import numpy as np
import pytest

import fractal_contact as fc

ROOT = Path(__file__).resolve().parents[2]
WORK, RANGE = 1e-3, 0.01
EXPONENTIAL = {"work": WORK, "range": RANGE, "law": "exponential"}
DUGDALE = {"work": WORK, "range": RANGE, "law": "dugdale"}
SPHERE = fc.Surface.sphere(radius=1.0, size=1.0)
# Tabor's parameter is 1: 64 cells a side resolve the range.
COARSE = fc.Bem3d(cells=64, tolerance=1e-5)


def rough(cells=65, seed=1):
    surface = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    return fc.surface_gen.self_affine_map(surface, cells, seed)


def smooth(cells=64):
    surface = fc.Surface.self_affine(
        hurst=0.8, size=1.0, rms_height=0.01, roll_off_wavelength=0.5, shortest_wavelength=0.25
    )
    return surface.height_map(cells, seed=1)


def plastic_path(**scene):
    return fc.Bem3d().prepare(fc.Scene(rough(), contact_modulus=1.0, effects={"hardness": 0.02}, **scene))


def adhesive_path(law=EXPONENTIAL, **scene):
    return COARSE.prepare(fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": law}, **scene))


# States


def test_a_hardness_limits_the_pressure():
    outputs = ["pressure", "plastic_depth", "area", "gap"]
    scene = fc.Scene(rough(), contact_modulus=1.0, effects={"hardness": 0.02}, outputs=outputs)
    state = fc.Bem3d().prepare(scene).solve(force=1e-3)
    assert state.pressure.max() == pytest.approx(0.02) and 0 < state.plastic_area <= state.area
    assert state.plastic_volume == pytest.approx(state.plastic_depth.sum() / state.plastic_depth.size)
    assert state.plastic_work == pytest.approx(0.02 * state.plastic_volume, rel=1e-14)
    assert state.branch is None and state.certificate.equilibrium is None
    # Fields are not copied, and the gap is that to the indented surface.
    assert state.plastic_depth.shape == state.gap.shape == (65, 65) and state.plastic_depth is state.plastic_depth
    assert state.gap.min() > -1e-7 and (state.plastic_depth[state.pressure < 0.019] == 0).all()


def test_a_hardness_that_nothing_reaches_changes_no_bit():
    elastic = fc.Bem3d().prepare(fc.Scene(rough(), contact_modulus=1.0, outputs=["pressure"])).solve(force=1e-3)
    high = fc.Scene(rough(), contact_modulus=1.0, effects={"hardness": 1e6}, outputs=["pressure"])
    hard = fc.Bem3d().prepare(high).solve(force=1e-3)
    assert np.array_equal(hard.pressure, elastic.pressure)
    assert elastic.plastic_area is None and elastic.plastic_depth is None
    assert (hard.plastic_area, hard.plastic_volume, hard.plastic_work) == (0.0, 0.0, 0.0)


def test_numbers_of_effects_are_properties():
    loaded, unloaded, again = plastic_path().follow(force=[1e-3, 2e-4, 2e-4])
    assert unloaded.plastic_volume == again.plastic_volume and unloaded.plastic_area != loaded.plastic_area
    assert (
        type(loaded) is fc.ContactState and re.search(r"plastic_work=\d", repr(loaded)) and "branch" not in repr(loaded)
    )
    state = adhesive_path().advance(force=0.0)
    assert (state.branch, state.time, state.plastic_work) == ("approach", 0.0, None) and state.energy < 0
    assert "branch=approach, energy=-" in repr(state)
    with pytest.raises(AttributeError):
        state.energy = 1.0
    # One way to each number.
    assert not any(hasattr(state, name) for name in ("plastic", "adhesive", "normal"))


def test_what_attracts_is_a_tension():
    scene = fc.Scene(
        SPHERE, contact_modulus=1.0, effects={"adhesion": EXPONENTIAL}, outputs=["pressure", "gap", "area"]
    )
    state = fc.Bem3d(cells=64, tolerance=1e-7).prepare(scene).solve(approach=0.01)
    open_, cell = state.gap > 1e-6, 1.0 / 64**2
    assert state.pressure.sum() * cell == pytest.approx(state.force)
    attraction = WORK / RANGE * np.exp(-state.gap[open_] / RANGE)
    assert np.abs(state.pressure[open_] + attraction).max() < 1e-5 * WORK / RANGE
    assert state.area == pytest.approx((~open_).sum() * cell) and state.certificate.equilibrium < 1e-7
    assert state.plastic_area is None and state.certificate.worst >= state.certificate.equilibrium


def test_without_work_states_are_elastic():
    scene = fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": {"work": 0.0, "range": 0.01}})
    state = COARSE.prepare(scene).advance(force=1e-3)
    elastic = COARSE.prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(force=1e-3)
    assert state.branch is None and (state.approach, state.stiffness) == (elastic.approach, elastic.stiffness)


def test_surfaces_of_an_ensemble_yield():
    surface = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    scene = fc.Scene(surface, contact_modulus=1.0, effects=fc.Effects(hardness=0.02))
    found = fc.ensemble(fc.Bem3d(cells=33), scene, seed=5, surfaces=3, mean_pressure=[1e-3, 0.5])
    for index, (state, refused) in enumerate(found):
        contact = fc.Bem3d(cells=33).prepare(scene, seed=fc.surface_gen.surface_seed(5, index))
        assert contact.solve(mean_pressure=1e-3).plastic_work == state.plastic_work and state.plastic_area > 0
        # Beyond what all cells at the hardness carry.
        assert isinstance(refused, fc.OutOfRange) and refused.high == pytest.approx(0.02)


# Paths


def test_an_indentation_stays():
    path = plastic_path(outputs=["area", "plastic_depth"])
    loads = np.array([5e-4, 1e-3, 5e-4, 0.0, 1e-3, 2e-3])
    first, loaded, half, unloaded, again, further = path.follow(force=loads)
    assert first.plastic_volume < loaded.plastic_volume < further.plastic_volume
    # The same to the rounding of a sum.
    kept = pytest.approx(loaded.plastic_volume, rel=1e-14)
    assert half.plastic_volume == kept and unloaded.plastic_volume == kept
    assert unloaded.plastic_area == 0.0 and np.array_equal(unloaded.plastic_depth, loaded.plastic_depth)
    # Unloading follows another curve, reloading comes back.
    assert half.approach > first.approach and again.approach == pytest.approx(loaded.approach, rel=1e-5)
    path.restart()
    assert path.advance(force=0.0).plastic_volume == 0.0
    # The bits of one step after the other.
    path.restart()
    assert [path.advance(force=f).approach for f in (5e-4, 1e-3)] == [first.approach, loaded.approach]


@pytest.mark.parametrize("effects", [{"hardness": 0.05}, {"adhesion": {"work": 1e-5, "range": 0.005}}])
def test_steps_by_mean_pressure_and_mean_gap(effects):
    scene = fc.Scene(smooth(), contact_modulus=1.0, effects={"boundary": "periodic", **effects}, outputs=["mean_gap"])
    path = fc.Bem3d().prepare(scene)
    pressed = path.advance(mean_pressure=2e-3)
    assert pressed.force == pytest.approx(2e-3) and pressed.approach is None
    assert pressed.mean_gap > 0
    path.restart()
    closed = path.advance(mean_gap=pressed.mean_gap)
    assert closed.force == pytest.approx(2e-3, rel=1e-3) and closed.mean_gap == pytest.approx(pressed.mean_gap)
    with pytest.raises(fc.Unsupported, match="approach"):
        path.advance(approach=0.01)
    with pytest.raises(fc.DomainError, match="mean_gap"):
        path.advance(mean_gap=-1.0)


def test_steps_by_approach_and_mean_pressure_may_pull():
    path = adhesive_path()
    away, near, back = path.follow(approach=[-0.05, 0.01, -0.005])
    assert [state.branch for state in (away, near, back)] == ["approach", "approach", "withdrawal"]
    assert away.force < 0 and back.force < 0 and back.approach == -0.005
    pulled = path.advance(mean_pressure=-4e-3)
    assert pulled.force == pytest.approx(-4e-3) and pulled.stability > 0
    # Without adhesion nothing pulls, and the contact stays where it is.
    hard = plastic_path()
    loaded = hard.advance(force=1e-3)
    for negative in ({"force": -1e-3}, {"approach": -1e-3}, {"mean_pressure": -1e-3}):
        with pytest.raises(fc.DomainError, match="a finite number >= 0"):
            hard.advance(**negative)
    assert hard.last is loaded
    again = hard.advance(force=1e-3)
    assert again.plastic_volume == pytest.approx(loaded.plastic_volume, rel=1e-6)


def test_a_sphere_jumps_into_contact_and_off():
    # Tabor's parameter is 1.7: between a jump in and a jump off both branches are stable.
    law = {"work": WORK, "range": 0.006}
    scene = fc.Scene(
        fc.Surface.sphere(radius=1.0, size=0.8), contact_modulus=1.0, effects={"adhesion": law}, outputs=["area"]
    )
    path = fc.Bem3d(cells=128, tolerance=1e-5).prepare(scene)
    approach = np.linspace(-0.04, 0.02, 25)
    nearer, apart = (fc.table(path.follow(approach=steps)) for steps in (approach, approach[::-1]))
    assert set(nearer["branch"]) == {"approach"} and set(apart["branch"][1:]) == {"withdrawal"}
    lost = apart["force"][::-1] - nearer["force"]
    assert lost.min() < -3 * WORK and np.abs(lost[approach > 0]).max() < 1e-4 * WORK
    # Between 1.5 (JKR) and 2 (DMT) times pi w R.
    assert 1.5 < -apart["force"].min() / (np.pi * WORK) < 1.7
    assert (nearer["stability"] > 0).all() and (apart["area"][::-1] >= nearer["area"]).all()


def test_pull_off_is_that_of_maugis():
    contact = fc.MaugisDugdale().prepare(fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": DUGDALE}))
    with pytest.raises(fc.OutOfRange) as caught:
        contact.solve(force=-10 * WORK)
    errors = []
    for cells in (64, 128):
        model = fc.Bem3d(cells=cells, tolerance=1e-5)
        path = model.prepare(fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": DUGDALE}))
        found = [state.force for state in path.follow(approach=np.linspace(0.01, -0.02, 31))]
        errors.append(min(found) / caught.value.low - 1.0)
    # Of first order in the cell: whole cells enter the zone.
    assert 0.0 < errors[1] < 0.08 and errors[1] < 0.7 * errors[0], errors


def test_a_path_goes_on_from_its_memory_to_the_same_bits():
    rough = fc.Surface.self_affine(hurst=0.7, size=1.0, rms_height=0.01)
    scene = fc.Scene(rough, contact_modulus=1.0, effects={"adhesion": 4e-5}, outputs=["area"])
    steps = [0.004, 0.012, 0.02, 0.012, 0.002, -0.002, -0.006]
    model = fc.Bem3d(cells=48)
    whole = list(model.prepare(scene, seed=3).follow(approach=steps))
    begun = model.prepare(scene, seed=3)
    # Before the first load.
    begun.recall(begun.memory())
    list(begun.follow(approach=steps[:4]))
    kept = begun.memory()
    other = model.prepare(scene, seed=3)
    other.recall(kept)
    assert other.memory() == kept and other.last is None
    for state, there in zip(other.follow(approach=steps[4:]), whole[4:], strict=True):
        assert state.to_dict() == there.to_dict()
    assert whole[-1].pull_off > 0.0 and whole[0].pull_off is None
    for wrong in (b"", kept[:-1], kept + b"0", bytes(100)):
        with pytest.raises(fc.ShapeError):
            other.recall(wrong)
    with pytest.raises(fc.ShapeError):
        fc.Bem3d(cells=32).prepare(scene, seed=3).recall(kept)
    # As after `restart`.
    assert other.advance(approach=0.004).force == whole[0].force


def test_a_path_ends_at_pull_off_with_its_last_stable_state():
    path, held = adhesive_path(outputs=["area", "pressure"]), []
    with pytest.raises(fc.NotConverged, match="pull-off before the force") as caught:
        for state in path.follow(force=[1e-3, 0.0, -4e-3, -1.0, 1e-3]):
            held.append(state)
    best = caught.value.best
    assert len(held) == 3 and best.force == held[-1].force == pytest.approx(-4e-3)
    assert (
        (best.branch, best.energy) == (held[-1].branch, held[-1].energy)
        and best.branch == "withdrawal"
        and best.stability > 0
    )
    assert best.status == "pulled_off" and held[-1].status == "converged"
    assert np.array_equal(best.pressure, held[-1].pressure) and best.pressure.min() < 0
    # The largest pull lies between it and the force that was not held.
    assert best.pull_off == pytest.approx(4e-3) and best.pull_off_error == pytest.approx(1.0 - 4e-3)
    assert held[-1].pull_off == best.pull_off and held[-1].pull_off_error is None and held[0].pull_off is None
    # The contact stands where it was.
    assert path.advance(force=-4e-3).area == held[-1].area
    # A pull without a step before it: the bodies hold each other at first.
    assert adhesive_path().advance(force=-4e-3).branch == "withdrawal"
    with pytest.raises(fc.NotConverged) as caught:
        adhesive_path().advance(force=-1.0)
    assert caught.value.best.force == pytest.approx(0.0, abs=1e-9)


def test_a_single_load_is_the_path_from_no_contact():
    scene = fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": EXPONENTIAL})
    contact, path = COARSE.prepare(scene), COARSE.prepare(scene)
    for force in (1e-3, -3e-3):
        path.restart()
        one, step = contact.solve(force=force), path.advance(force=force)
        assert (one.approach, one.stiffness, one.energy) == (step.approach, step.stiffness, step.energy)


def test_tangential_loads_have_two_components():
    body = fc.Body(young=2.0, poisson=0.3)
    scene = fc.Scene(SPHERE, bodies=(body, body), effects={"friction": {"coefficient": 0.5, "coupling": "none"}})
    path = fc.CattaneoMindlin().prepare(scene)
    path.advance(force=0.01)
    # One number is along x; a pair has a component along y, which this model takes where it is 0.
    one = path.advance(force=0.01, tangential_force=0.002)
    for pair in ((0.002, 0.0), [0.002, 0], np.array([0.002, 0.0]), iter([0.002, 0.0])):
        same = path.advance(force=0.01, tangential_force=pair)
        assert (same.tangential_force, same.tangential_force_y) == (0.002, 0.0)
        assert same.tangential_displacement == one.tangential_displacement
    assert one.sliding_force == pytest.approx(0.005) and one.stick_area is None
    assert one.to_dict()["tangential_displacement_y"] == 0.0 and "stick_area" not in one.to_dict()
    loop = list(path.follow(force=0.01, tangential_force=[(0.002, 0.0), (-0.002, 0.0)]))
    assert [state.tangential_force for state in loop] == [0.002, -0.002]
    with pytest.raises(fc.Unsupported, match="along y"):
        path.advance(force=0.01, tangential_displacement=(0.0, 1e-6))
    for wrong in ((), (1.0,), (1.0, 2.0, 3.0), itertools.count(1.0)):
        with pytest.raises(ValueError, match="components"):
            path.advance(force=0.01, tangential_force=wrong)
    for wrong in ("12", (1.0, "2"), object(), {"x": 1.0, "y": 2.0}):
        with pytest.raises(TypeError):
            path.advance(force=0.01, tangential_force=wrong)
    with pytest.raises(fc.DomainError, match="tangential force along y"):
        path.advance(force=0.01, tangential_force=(0.0, float("nan")))
    shapes = {field["name"]: field["shape"] for field in fc._core.fields()}
    assert shapes["traction"] == shapes["slip"] == "(2, rows, columns)" and shapes["gap"] == "(rows, columns)"
    # Bodies that couple: a model that neglects it takes the scene, none solves it.
    coupled = {"coefficient": 0.5, "coupling": "full"}
    with pytest.raises(fc.Unsupported, match="full coupling"):
        fc.CattaneoMindlin().prepare(fc.Scene(SPHERE, bodies=(None, body), effects={"friction": coupled}))


def test_follow_is_one_step_for_each_number():
    body = fc.Body(young=2.0, poisson=0.3)
    scene = fc.Scene(SPHERE, bodies=(body, body), effects={"friction": 0.5})
    path = fc.CattaneoMindlin().prepare(scene)
    # A number alone is that of every step; any iterable will do.
    loop = list(path.follow(force=0.01, tangential_force=iter([0.002, -0.002, 0.002])))
    assert [state.tangential_force for state in loop] == [0.002, -0.002, 0.002]
    assert loop[2].dissipated > loop[1].dissipated and [state.force for state in loop] == [0.01] * 3
    path.restart()
    times = [state.time for state in fc.follow(path, np.array([1.0, 2.0]), approach=np.float32(0.01))]
    assert times == [1.0, 2.0] and list(path.follow(2.0, force=[])) == []
    assert next(path.follow(3.0, force=0.01)).time == 3.0
    for wrong in ({}, {"force": [1.0], "approach": [1.0]}):
        with pytest.raises(TypeError, match="exactly one of"):
            path.follow(**wrong)
    with pytest.raises(TypeError, match="at most one of"):
        path.follow(force=[1.0], tangential_force=[0.0], tangential_displacement=[0.0])
    with pytest.raises(ValueError, match="time has 3, force has 2"):
        path.follow([1.0, 2.0, 3.0], force=[1.0, 2.0])
    with pytest.raises(TypeError, match=r"force\[0\] is \[1\.0\]: expected a real number"):
        path.follow(force=[[1.0], [2.0]])
    with pytest.raises(ValueError, match=r"tangential_force has \[3\] components: expected two"):
        path.follow(force=1.0, tangential_force=np.zeros((2, 3)))
    # Checked at the call; a load that the model refuses raises at its place.
    steps = path.follow(3.0, force=[0.01, -0.01])
    assert next(steps).force == pytest.approx(0.01)
    with pytest.raises(fc.DomainError):
        next(steps)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_in_a_path_keeps_what_was_done():
    # Waves on all scales: many outer iterations a step.
    surface = fc.Surface.self_affine(hurst=0.3, size=1.0, rms_height=0.01).height_map(513, seed=1)
    path = fc.Bem3d().prepare(fc.Scene(surface, contact_modulus=1.0, effects={"hardness": 0.1}))
    assert path.last is None
    loads, done = np.geomspace(1e-4, 1e-2, 4000), []
    threading.Timer(0.7, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        for state in path.follow(force=loads):
            done.append(state)
    assert 0 < len(done) < len(loads) and all(state.status == "converged" for state in done)
    # A step that was complete before the signal was heard is not lost.
    last = path.last
    assert last is done[-1] or last.force == pytest.approx(loads[len(done)])
    unloaded = path.advance(force=0.0)
    assert unloaded.plastic_volume == pytest.approx(last.plastic_volume, rel=1e-14)
    assert path.last is unloaded
    path.restart()
    assert path.last is None


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_inside_of_a_step_leaves_the_contact_as_it_was():
    surface = fc.Surface.self_affine(hurst=0.3, size=1.0, rms_height=0.01).height_map(1025, seed=1)
    scene = fc.Scene(surface, contact_modulus=1.0, effects={"hardness": 0.1})
    path = fc.Bem3d(tolerance=1e-10).prepare(scene)
    loaded = path.advance(force=1e-4)
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        path.advance(force=0.05)
    assert path.last is loaded
    unloaded = path.advance(force=0.0)
    assert unloaded.plastic_volume == pytest.approx(loaded.plastic_volume, rel=1e-14)


# The same as by the scene runner


SCENE = """[scene]
models = ["bem3d"]
contact_modulus = {contact_modulus}

{surface}
{path}
[effects]
{effects}

[outputs]
stiffness = true
area = true
{fields}

[models.bem3d]
cells = 48
tolerance = 1e-5

[sampling]
seed = 3
"""


def test_a_plastic_path_has_the_bits_of_the_scene_runner(tmp_path):
    forces = [100.0, 200.0, 0.0, 300.0]
    text = SCENE.format(
        contact_modulus='"115 GPa"',
        surface='[scene.surface]\nkind = "self_affine"\nside = "1 mm"\nhurst = 0.8\nrms_height = "1 um"\n',
        path="".join(f'[[scene.path]]\nforce = "{force} N"\n' for force in forces),
        effects='hardness = { pressure = "1 GPa" }',
        fields='plastic_depth = ["npy"]',
    )
    outcome = fc.run_scene(fc.Scene.from_toml(text), tmp_path)
    surface = fc.Surface.self_affine(hurst=0.8, size=1e-3, rms_height=1e-6)
    effects = fc.Effects(hardness=fc.si("1 GPa"))
    outputs = ["stiffness", "area", "plastic_depth"]
    scene = fc.Scene(surface, contact_modulus=fc.si("115 GPa"), effects=effects, outputs=outputs)
    path = fc.Bem3d(cells=48, tolerance=1e-5).prepare(scene, fc.surface_gen.surface_seed(3, 0))
    states = list(path.follow(force=forces))
    rows = fc.table(states)
    for name in ("force", "approach", "stiffness", "area", "plastic_area", "plastic_volume", "plastic_work"):
        assert np.array_equal(rows[name], outcome.results[name], equal_nan=True), name
    assert rows["plastic_volume"][3] > 1.1 * rows["plastic_volume"][2] > 0
    depth = np.load(tmp_path / "plastic_depth-bem3d-0-003.npy")
    assert np.array_equal(depth, states[3].plastic_depth)


def test_an_adhesive_path_has_the_bits_of_the_scene_runner(tmp_path):
    approach = ["-0.9", "-0.5", "0.4", "-0.5", "-0.8", "-1.2"]
    text = SCENE.format(
        contact_modulus='"1 MPa"',
        surface='[scene.body]\nkind = "sphere"\nradius = "50 um"\nside = "36 um"\n',
        path="".join(f'[[scene.path]]\napproach = "{step} um"\n' for step in approach),
        effects='adhesion = { work = "50 mJ/m^2", range = "0.5 um", law = "exponential" }',
        fields="",
    )
    outcome = fc.run_scene(fc.Scene.from_toml(text), tmp_path)
    law = {"work": fc.si("50 mJ/m^2"), "range": fc.si("0.5 um"), "law": "exponential"}
    sphere = fc.Surface.sphere(radius=fc.si("50 um"), size=fc.si("36 um"))
    scene = fc.Scene(sphere, contact_modulus=fc.si("1 MPa"), effects={"adhesion": law}, outputs=["stiffness", "area"])
    path = fc.Bem3d(cells=48, tolerance=1e-5).prepare(scene)
    rows = fc.table(path.follow(approach=[fc.si(f"{step} um") for step in approach]))
    for name in ("force", "approach", "stiffness", "area", "energy", "stability"):
        assert np.array_equal(rows[name], outcome.results[name], equal_nan=True), name
    assert rows["branch"].tolist() == list(outcome.results["branch"]) == ["approach"] * 3 + ["withdrawal"] * 3


# Dictionaries and tables


def test_dictionaries_have_the_columns_of_scenes():
    plastic = ["plastic_area", "plastic_volume", "plastic_work"]
    adhesive = ["branch", "energy", "stability", "equilibrium"]
    path = plastic_path(outputs=["pressure", "plastic_depth", "contact_patches"])
    hard, soft = path.advance(force=1e-3), adhesive_path().advance(force=1e-3)
    told = hard.to_dict()
    assert [told[name] for name in plastic] == [getattr(hard, name) for name in plastic]
    assert not told.keys() & {*adhesive, "pressure", "tangential_force"} and told["time"] == 0.0
    fields = hard.to_dict(fields=True)
    assert fields["plastic_depth"] is hard.plastic_depth and fields["pressure"].shape == (65, 65)
    assert fields["patches"].shape == (told["patches"],) and fields["gap"] is None and fields.keys() > told.keys()
    told = soft.to_dict()
    assert [told[name] for name in adhesive] == [getattr(soft, name) for name in adhesive]
    assert not told.keys() & set(plastic)


def test_tables_have_the_columns_that_states_have():
    elastic = fc.Hertz().prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(force=1e-3)
    plain = fc.table([elastic])
    assert not {"plastic_area", "branch", "energy", "tangential_force"} & set(plain.dtype.names)
    hard, soft = plastic_path().advance(force=1e-3), adhesive_path().advance(force=1e-3)
    rows = fc.table([elastic, hard, soft])
    assert set(plain.dtype.names) | {"plastic_work", "energy", "stability"} < set(rows.dtype.names)
    assert rows["branch"].tolist() == ["", "", "approach"] and rows.dtype["branch"].kind == "U"
    assert np.isnan(rows["plastic_work"][[0, 2]]).all() and rows["plastic_work"][1] == hard.plastic_work
    assert np.isnan(rows["energy"][:2]).all() and rows["energy"][2] == soft.energy
    assert rows["status"].tolist() == ["converged"] * 3
    # Columns come in one order, whatever the first state is.
    assert fc.table([hard, elastic]).dtype.names == fc.table([elastic, hard]).dtype.names
    assert fc.table([]).shape == (0,)


# Inputs


def test_a_path_of_an_elastic_contact_is_its_loads():
    contact, alone = (fc.Bem3d().prepare(fc.Scene(rough(33), contact_modulus=1.0)) for _ in range(2))
    states = list(contact.follow([1.0, 2.0], force=[1e-3, 5e-4]))
    assert [state.approach for state in states] == [alone.solve(force=force).approach for force in (1e-3, 5e-4)]
    assert [state.time for state in states] == [1.0, 2.0] and alone.last.time is None
    for one in (contact, plastic_path()):
        with pytest.raises(fc.Unsupported, match="tangential"):
            one.advance(2.0, force=1e-3, tangential_force=1e-4)


@pytest.mark.parametrize("number", [np.float64, np.float32, np.int64, int, np.array])
def test_numbers_of_numpy_are_numbers(number):
    one = number(1)
    hard = fc.Scene(rough(17), contact_modulus=1.0, effects={"hardness": one})
    assert fc.Bem3d().prepare(hard).solve(force=0.01).plastic_area == 0.0
    sticky = fc.Scene(SPHERE, contact_modulus=1e3, effects={"adhesion": {"work": one, "range": one}})
    assert fc.Bem3d(cells=8).prepare(sticky).solve(force=one).branch == "approach"
    short = fc.Scene(SPHERE, contact_modulus=1e3, effects={"adhesion": one})
    assert fc.Jkr().prepare(short).solve(force=one).force == 1.0


def test_effects_are_values():
    law = dict(EXPONENTIAL)
    effects = fc.Effects(adhesion=law)
    assert pickle.loads(pickle.dumps(effects)) == effects == fc.Effects(adhesion=EXPONENTIAL)
    law["work"] = 2.0
    assert effects.adhesion == EXPONENTIAL and fc.Effects(hardness=1.0) != fc.Effects(hardness=2.0)
    scene = fc.Scene(SPHERE, contact_modulus=1.0, effects=effects)
    assert (
        pickle.loads(pickle.dumps(scene))
        == scene
        == fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": EXPONENTIAL})
    )


def test_the_exponential_law_is_taken_where_none_is_named():
    forces = [
        adhesive_path({"work": WORK, "range": RANGE, **law}).advance(approach=0.0).force
        for law in ({}, {"law": None}, {"law": "exponential"}, {"law": "dugdale"})
    ]
    assert forces[0] == forces[1] == forces[2] != forces[3]


# No work is no adhesion.
WRONG = [(name, value) for name in ("hardness", "work", "range") for value in (-1.0, np.nan, np.inf, -np.inf)]


@pytest.mark.parametrize(("name", "value"), [*WRONG, ("hardness", 0.0), ("range", 0.0)])
def test_numbers_that_make_no_sense(name, value):
    given = {"hardness": value} if name == "hardness" else {"adhesion": {"work": 1.0, "range": 1.0, name: value}}
    # Where the mistake is made, and in a scene.
    for make in (lambda: fc.Effects(**given), lambda: fc.Scene(SPHERE, contact_modulus=1.0, effects=given)):
        with pytest.raises(fc.DomainError, match=name) as caught:
            make()
        assert name in caught.value.quantity and np.array_equal(caught.value.value, value, equal_nan=True)


@pytest.mark.parametrize(
    ("effects", "error", "words"),
    [
        ({"hardness": True}, TypeError, "`effects.hardness` is true or false: expected a plain number"),
        ({"hardness": "1 GPa"}, TypeError, '`effects.hardness` is the text "1 GPa": expected a plain number'),
        ({"hardness": [1.0]}, TypeError, "`effects.hardness` is a list"),
        ({"hardness": {"force": 1.0}}, TypeError, r"`pressure` is missing in \[effects.hardness\]"),
        ({"hardness": 10**400}, ValueError, "effects.hardness is beyond the range"),
        ({"hardness": object()}, TypeError, "effects.hardness is <object"),
        ({"friction": True}, TypeError, "`effects.friction` is true or false"),
        ({"adhesion": -0.1}, fc.DomainError, "effects.adhesion = -0.1: expected a number >= 0"),
        ({"adhesion": np.nan}, fc.DomainError, "effects.adhesion = NaN: expected a finite number"),
        ({"adhesion": True}, TypeError, "`effects.adhesion` is true or false"),
        ({"adhesion": np.True_}, TypeError, "`effects.adhesion` is true or false"),
        ({"adhesion": "strong"}, TypeError, 'is the text "strong"'),
        ({"adhesion": {}}, TypeError, "`work` is missing"),
        ({"adhesion": {"range": 1.0}}, TypeError, "`work` is missing"),
        ({"adhesion": {"work": 0.1, "range": True}}, TypeError, "`effects.adhesion.range` is true or false"),
        ({"adhesion": {"work": 0.1, "range": "1 nm"}}, TypeError, 'range` is the text "1 nm"'),
        ({"adhesion": {"work": 0.1, "law": "dugdale"}}, ValueError, "no `range` is given"),
        ({"adhesion": {"work": 0.1, "reach": 1.0}}, ValueError, "`reach` is no key .* work, law, range"),
        ({"adhesion": {"work": 0.1, "range": 1.0, "law": "cubic"}}, ValueError, "exponential, dugdale"),
        ({"adhesion": {"work": 0.1, "range": 1.0, "law": 3}}, TypeError, "law` is a plain number: expected a word"),
        ({"adhesion": {1: 2}}, TypeError, "effects.adhesion has the key 1: expected text"),
    ],
)
def test_effects_that_make_no_sense(effects, error, words):
    with pytest.raises(error, match=words):
        fc.Effects(**effects)


# What a model lacks


@pytest.mark.parametrize(
    ("model", "surface", "effects"),
    [
        (fc.Hertz(), SPHERE, {"hardness": 1.0}),
        (fc.Hertz(), SPHERE, {"adhesion": 1e-3}),
        (fc.Hertz(), SPHERE, {"adhesion": EXPONENTIAL}),
        (fc.Jkr(), SPHERE, {"adhesion": EXPONENTIAL}),
        (fc.MaugisDugdale(), SPHERE, {"adhesion": 1e-3}),
        (fc.MaugisDugdale(), SPHERE, {"adhesion": EXPONENTIAL}),
        (fc.FlatPunch(), fc.Surface.flat_circle(radius=0.1, size=1.0), {"adhesion": DUGDALE}),
        (fc.Mdr1d(), SPHERE, {"adhesion": EXPONENTIAL}),
        (fc.Mdr1d(), SPHERE, {"hardness": 1.0}),
    ],
)
def test_models_refuse_effects_that_they_lack(model, surface, effects):
    with pytest.raises(fc.Unsupported, match=r"hardness|adhesion") as caught:
        model.prepare(fc.Scene(surface, contact_modulus=1.0, effects=effects))
    assert caught.value.model == model.name


def test_hardness_and_adhesion_of_short_range_together_are_refused():
    scene = fc.Scene(SPHERE, contact_modulus=1.0, effects={"hardness": 1.0, "adhesion": {"work": 1e-3}})
    with pytest.raises(fc.Unsupported, match="a hardness together with adhesion") as caught:
        COARSE.prepare(scene)
    # No model has both.
    assert caught.value.able == () and "models that may" not in str(caught.value)


def test_what_flows_and_is_attracted_slides_at_the_contact_pressure():
    body = fc.Body(young=2.0, poisson=0.3)
    surface = fc.Surface.sphere(radius=1.0, size=0.5)
    adhesion = {"work": 1e-3, "range": 0.02, "law": "exponential"}
    effects = {"hardness": 0.05, "adhesion": adhesion, "friction": 0.3}
    path = fc.Bem3d(cells=48).prepare(fc.Scene(surface, bodies=(body, body), effects=effects))
    states = list(path.follow(force=[2e-3, 2e-3, 0.0], tangential_force=[0.0, 3e-4, 0.0]))
    assert all(state.plastic_volume > 0.0 for state in states)
    # More than the coefficient times the force, and some of it without any force.
    assert states[1].sliding_force > 0.3 * 2e-3 and states[2].sliding_force > 0.0


def test_which_effects_go_together_is_a_table():
    rows = [row for row in fc.combinations() if row["model"] == "bem3d"]
    of_keys = {row["keys"]: row for row in rows if row["effects"][0] != row["effects"][1]}
    reasons = {row["effects"]: row["reason"] for row in rows}
    assert reasons["a hardness", "adhesion of short range"] and of_keys["hardness", "adhesion"]["combined"]
    # A coefficient needs the pressure at the edge, which a short range does not have; a shear strength does not.
    assert reasons["adhesion of short range", "friction"]
    assert reasons["adhesion of short range", "friction with a shear strength"] is None
    body = fc.Body(young=2.0, poisson=0.3)
    bodies, sphere = (body, body), fc.Surface.sphere(radius=1.0, size=0.5)
    for row in rows:
        assert row["combined"] == (row["reason"] is None)
    scene = fc.Scene(sphere, bodies=bodies, effects={"hardness": 0.05, "friction": 0.3})
    assert ("a hardness", "friction") in [row["effects"] for row in rows if row["combined"]]
    path = fc.Bem3d(cells=17).prepare(scene)
    states = list(path.follow(force=0.002, tangential_force=[0.0, 0.0003]))
    assert states[1].sliding_force == pytest.approx(0.3 * 0.002)
    assert states[1].plastic_volume >= 0.0


def test_a_layer_on_a_base():
    # A ball on a layer that is thin beside the contact: F = pi M R d^2/h with the oedometric modulus M.
    young, poisson, thickness, approach = 1.0, 0.2, 0.01, 0.05
    layer = {"thickness": thickness, "young": young, "poisson": poisson, "base": "rigid"}
    modulus = young / (1 - poisson**2)
    scene = fc.Scene(fc.Surface.sphere(radius=1.0, size=1.0), contact_modulus=modulus, effects={"layer": layer})
    state = fc.Bem3d(cells=129).prepare(scene).solve(approach=approach)
    oedometric = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
    assert state.force == pytest.approx(np.pi * oedometric * approach**2 / thickness, rel=1e-3)
    with pytest.raises(fc.DomainError, match="contact_modulus"):
        fc.Bem3d().prepare(fc.Scene(scene.surface, contact_modulus=2 * modulus, effects={"layer": layer}))
    with pytest.raises(ValueError, match="rigid, slipping"):
        fc.Effects(layer={**layer, "base": "glued"})


def test_a_shear_strength_holds_the_attached_area():
    body = fc.Body(young=2.0, poisson=0.3)
    effects = {"adhesion": {"work": 1e-4}, "friction": {"shear_strength": 0.01}}
    scene = fc.Scene(fc.Surface.sphere(radius=1.0, size=0.3), bodies=(body, body), effects=effects, outputs=["area"])
    path = fc.Bem3d(cells=33).prepare(scene)
    for state in path.follow(force=[2e-4, 0.0, -1e-4]):
        assert state.sliding_force == pytest.approx(0.01 * state.area)


def test_laws_of_friction():
    body = fc.Body(young=2.0, poisson=0.3)

    def sliding(friction):
        surface = fc.Surface.flat_circle(radius=0.2, size=0.5)
        path = fc.Bem3d(cells=16).prepare(fc.Scene(surface, bodies=(body, body), effects={"friction": friction}))
        return next(iter(path.follow(force=[1e-3]))).sliding_force

    tresca = sliding({"shear_strength": 1e-3})
    assert tresca == pytest.approx(1e-3 * np.pi * 0.2**2, rel=0.1)
    both = sliding({"shear_strength": 1e-3, "coefficient": 0.3})
    assert both == pytest.approx(tresca + 0.3 * 1e-3)
    assert sliding({"coefficient": 1e6, "limit": 1e-3}) == pytest.approx(tresca)
    with pytest.raises(ValueError, match="`limit` caps a law of friction"):
        fc.Effects(friction={"limit": 1.0})
    with pytest.raises(fc.DomainError, match="shear_strength"):
        fc.Effects(friction={"shear_strength": -1.0})


def test_a_number_alone_is_adhesion_of_short_range():
    forces = []
    for adhesion in (WORK, {"work": WORK}):
        scene = fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": adhesion})
        for model in (fc.Jkr(), fc.Mdr1d()):
            contact = model.prepare(scene)
            assert contact.solve(force=-1.49 * np.pi * WORK).force < 0
            with pytest.raises(fc.OutOfRange):
                contact.solve(force=-1.51 * np.pi * WORK)
            forces.append(contact.solve(approach=0.01).force)
    assert forces[:2] == forces[2:]


def test_closed_forms_of_adhesion():
    wave = fc.Surface.sine(amplitude=0.01, wavelength=1.0, size=1.0)
    effects = {"boundary": "periodic", "adhesion": 1e-4}
    state = fc.AdhesiveWave().prepare(fc.Scene(wave, contact_modulus=1.0, effects=effects)).solve(mean_pressure=-1e-4)
    assert state.force == pytest.approx(-1e-4) and state.branch is None
    dry = fc.Westergaard().prepare(
        fc.Scene(wave, contact_modulus=1.0, effects={"boundary": "periodic"}, outputs=["area"])
    )
    sticky = fc.AdhesiveWave().prepare(fc.Scene(wave, contact_modulus=1.0, effects=effects, outputs=["area"]))
    assert sticky.solve(mean_pressure=1e-3).area > dry.solve(mean_pressure=1e-3).area


def test_a_range_that_cells_do_not_resolve_is_refused_with_the_cell_that_would():
    scene = fc.Scene(SPHERE, contact_modulus=1.0, effects={"adhesion": {"work": WORK, "range": 1e-4}})
    with pytest.raises(fc.OutOfRange, match="the cohesive zone needs five of them") as caught:
        COARSE.prepare(scene)
    error = caught.value
    assert error.quantity.startswith("side of a cell") and error.value == 1 / 64 and 0 < error.high < error.value


def test_a_plastic_depth_needs_a_hardness():
    with pytest.raises(fc.Unsupported, match="hardness"):
        fc.Scene(rough(17), contact_modulus=1.0, outputs=["plastic_depth"])


def test_the_page_of_the_book_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = ROOT / "book/src/python.md"
    if not page.exists():
        pytest.skip("outside of the repository")
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)
    assert blocks
    for block in blocks:
        exec(block, {})


def test_a_ball_of_short_range_is_pulled_off_near_jkr():
    work, radius = 1e-4, (4.5 * np.pi * 1e-4) ** (1 / 3)
    ball = fc.Surface.sphere(radius=1.0, size=2.6 * radius)
    scene = fc.Scene(ball, contact_modulus=1.0, effects={"adhesion": work}, outputs=["area", "stiffness_fixed_area"])
    path = fc.Bem3d(cells=42, tolerance=1e-6).prepare(scene)
    unit = 1.5 * np.pi * work
    for force in (0.0, -0.5 * unit, -0.9 * unit):
        state = path.advance(force=force)
        exact = fc.Jkr().prepare(scene).solve(force=force)
        assert abs(state.area / exact.area - 1.0) < 0.05
        assert abs(state.stiffness_fixed_area / exact.stiffness_fixed_area - 1.0) < 0.05
        assert state.stability > 0.0
    with pytest.raises(fc.NotConverged) as caught:
        path.advance(force=-1.1 * unit)
    assert caught.value.best.force == state.force


FOLLOWS = r"virgin surface.*advance\(\) and follow\(\) keep it"


def yielding(**scene):
    return fc.Bem3d(cells=33).prepare(fc.Scene(rough(33), contact_modulus=1.0, effects={"hardness": 0.02, **scene}))


@pytest.mark.parametrize(
    ("kind", "first", "second", "boundary"),
    [
        ("force", 0.01, 0.005, "free"),
        ("mean_pressure", 0.01, 0.005, "periodic"),
        ("approach", 0.01, 0.005, "free"),
        ("mean_gap", 0.005, 0.01, "periodic"),
    ],
)
def test_a_smaller_load_would_forget_the_indentation(kind, first, second, boundary):
    contact = yielding(boundary=boundary)
    before = contact.solve(**{kind: first})
    with pytest.raises(fc.DomainError, match=FOLLOWS) as caught:
        contact.solve(**{kind: second})
    assert caught.value.quantity == kind and caught.value.value == second and f"{first}" in caught.value.expected
    # Nothing has changed: the same load again, and larger ones.
    assert contact.solve(**{kind: first}).plastic_volume == pytest.approx(before.plastic_volume, rel=1e-3)
    for states in (
        lambda: contact.sweep(**{kind: [second]}),
        lambda: fc.sweep(contact, **{kind: [first, second]}),
    ):
        # At the call, not at the second state.
        with pytest.raises(fc.DomainError, match=FOLLOWS):
            states()
    contact.restart()
    assert contact.solve(**{kind: second}).plastic_volume < before.plastic_volume


def test_a_smaller_load_of_another_kind():
    contact = yielding()
    reached = contact.solve(force=0.01)
    with pytest.raises(fc.DomainError, match=FOLLOWS):
        contact.solve(approach=0.5 * reached.approach)
    # The load that was reached is no smaller one, whatever its last digits.
    again = contact.solve(approach=reached.approach)
    assert contact.solve(force=0.01).approach == pytest.approx(again.approach, rel=1e-3)


def test_a_solve_does_not_forget_a_path_with_an_indentation():
    contact = yielding()
    loaded, unloaded = contact.follow([1.0, 2.0], force=[0.01, 1e-3])
    assert contact.last is unloaded
    with pytest.raises(fc.DomainError, match=FOLLOWS) as caught:
        contact.solve(force=5e-3)
    assert "0.01" in caught.value.expected and contact.last is unloaded
    # A larger load begins with the virgin surface, and the next path goes on from there, at time 0.
    solved = contact.solve(force=0.015)
    assert solved.force == pytest.approx(0.015) and contact.last is solved and solved.time is None
    back = contact.advance(0.5, force=0.01)
    assert back.time == 0.5 and back.plastic_volume == pytest.approx(solved.plastic_volume, rel=1e-3)
    assert back.plastic_volume > 1.1 * loaded.plastic_volume
    contact.restart()
    assert contact.last is None and contact.solve(force=5e-3).plastic_volume < loaded.plastic_volume


def test_a_path_goes_on_from_a_load_that_was_solved():
    contact, path = yielding(), yielding()
    solved = contact.solve(force=0.01)
    half = contact.advance(force=5e-3)
    loaded, expected = path.follow(force=[0.01, 5e-3])
    assert solved.plastic_volume == pytest.approx(loaded.plastic_volume, rel=1e-3)
    assert (half.approach, half.plastic_volume) == (expected.approach, expected.plastic_volume)
    # With adhesion, too: the bodies are drawn apart.
    sticky = adhesive_path()
    sticky.solve(approach=0.02)
    assert sticky.advance(approach=0.0).branch == "withdrawal"


def test_a_load_that_is_no_number_is_not_remembered():
    contact = yielding()
    for wrong in (np.nan, np.inf, -1.0):
        with pytest.raises(fc.DomainError):
            contact.solve(force=wrong)
    assert contact.solve(force=0.01).force == pytest.approx(0.01)
    with pytest.raises(fc.DomainError):
        contact.solve(force=np.nan)


def test_without_a_hardness_loads_come_in_any_order():
    contact = fc.Bem3d(cells=33).prepare(fc.Scene(rough(33), contact_modulus=1.0))
    assert [round(state.force, 12) for state in contact.sweep(force=[0.01, 0.005, 0.02])] == [0.01, 0.005, 0.02]
    contact.restart()


def test_an_ensemble_refuses_decreasing_loads_with_a_hardness():
    surface = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    hard = fc.Scene(surface, contact_modulus=1.0, effects={"hardness": 0.02})
    with pytest.raises(fc.DomainError, match=FOLLOWS):
        fc.ensemble(fc.Bem3d(cells=17), hard, seed=1, surfaces=2, force_bar=[0.2, 0.1])
    assert len(fc.ensemble(fc.Bem3d(cells=17), hard, seed=1, surfaces=2, force_bar=[0.1, 0.2])) == 2


# Time, and contacts along a line


RUBBER = {"kind": "prony", "weights": [1.5, 0.5], "times": [0.5, 5.0]}


def test_a_viscoelastic_body_is_followed_in_time():
    scene = fc.Scene(SPHERE, contact_modulus=1.0, effects={"rheology": RUBBER}, outputs=["area"])
    contact = fc.Bem3d(cells=48, time_tolerance=1e-3).prepare(scene)
    first, crept, unloaded, recovered = contact.follow(time=[0.0, 4.0, 4.0, 400.0], force=[0.01, 0.01, 0.0, 0.0])
    assert first.time_steps == 0 and crept.time_steps > 0
    assert crept.approach > first.approach and crept.area > first.area
    assert 0 < crept.approach_time_error < 1e-2 and crept.force_time_error == 0
    assert crept.work > first.work > unloaded.work - crept.work and unloaded.area == recovered.area == 0
    # In no time it is the glassy body.
    glassy = fc.Bem3d(cells=48).prepare(fc.Scene(SPHERE, contact_modulus=3.0)).solve(force=0.01)
    assert first.approach == pytest.approx(glassy.approach, rel=1e-6)
    with pytest.raises(fc.Unsupported, match="stiffness of a viscoelastic body"):
        fc.Bem3d().prepare(fc.Scene(SPHERE, contact_modulus=1.0, effects={"rheology": RUBBER}, outputs=["stiffness"]))
    with pytest.raises(fc.DomainError, match="time_tolerance"):
        fc.Bem3d(time_tolerance=2.0).prepare(scene)


def test_a_map_may_be_periodic_along_one_axis():
    y = (np.arange(64) + 0.5) / 64 - 0.5
    heights = np.repeat(-0.5 * y[:, None] ** 2, 16, axis=1)
    line = {"x": "periodic", "y": "free"}
    scene = fc.Scene(
        fc.HeightMap(heights, size=(0.25, 1.0)), contact_modulus=1.0, outputs=["area"], effects={"boundary": line}
    )
    state = fc.Bem3d().prepare(scene).solve(force=1e-3)
    # Hertz's half-width under a force for each length.
    half_width = np.sqrt(4 * 1e-3 / 0.25 / np.pi)
    assert state.area == pytest.approx(2 * half_width * 0.25, rel=0.1)
    assert state.approach is None and state.stiffness is None
    with pytest.raises(fc.Error, match="no zero at infinity"):
        fc.Bem3d().prepare(scene).solve(approach=1e-3)
    with pytest.raises(ValueError, match="periodc"):
        fc.Effects(boundary={"x": "periodc", "y": "free"})


def test_the_periodic_kernel_of_waves_differs_by_a_per_cent():
    scene = fc.Scene(rough(128), contact_modulus=1.0, effects={"boundary": "periodic"}, outputs=["area"])
    cells, waves = (
        fc.Bem3d(periodic_kernel=kernel).prepare(scene).solve(force=5e-3).area for kernel in ["cells", "waves"]
    )
    assert waves == pytest.approx(cells, rel=0.03) and waves != cells
