"""Values: what compares, what has a hash, what does not change, and what survives a copy in another process."""

import copy
import dataclasses
import io
import math
import os
import pickle
import subprocess
import sys
import weakref

import numpy as np
import pytest

import fractal_contact as fc

ROUGH = fc.Surface.self_affine(hurst=0.6, size=(2.0, 1.0), rms_height=0.01)
BALL = fc.Surface.sphere(radius=1.0, size=1.0)


def solved(force=0.01, cells=(32, 16)):
    outputs = ["stiffness", "area", "pressure", "gap", "contact_patches"]
    scene = fc.Scene(ROUGH.height_map(cells, seed=1), contact_modulus=1.0, outputs=outputs)
    return fc.Bem3d().prepare(scene).solve(force=force)


@pytest.fixture(scope="module")
def state():
    return solved()


# Copies.


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_states_survive_buffers_out_of_band(state, kind):
    buffers = []
    data = pickle.dumps(state, protocol=5, buffer_callback=buffers.append)
    assert len(buffers) == 2  # Pressure and gap.
    again = pickle.loads(data, buffers=[kind(bytes(buffer.raw())) for buffer in buffers])
    assert again == state and not again.pressure.flags.writeable and not again.gap.flags.writeable


def test_states_survive_copies_of_copies(state):
    for again in (copy.copy(state), copy.copy(copy.copy(state)), copy.copy(pickle.loads(pickle.dumps(state)))):
        assert again == state and not again.pressure.flags.writeable
    # The arrays of the state are not those of a copy that may change.
    assert copy.copy(state).pressure is state.pressure


def test_states_survive_read_only_files(state, tmp_path):
    np.save(tmp_path / "pressure.npy", state.pressure)
    mapped = np.load(tmp_path / "pressure.npy", mmap_mode="r")
    restore, (kept, fields) = state.__reduce__()
    again = restore(kept, [mapped if field is not None else None for field in fields])
    assert np.array_equal(again.pressure, state.pressure) and not again.pressure.flags.writeable


def pressure(state):
    return float(state.pressure.max())


def large():
    """A state whose fields are so large that joblib gives them as read-only files."""
    scene = fc.Scene(ROUGH.height_map((1024, 512), seed=1), contact_modulus=1.0, outputs=["pressure"])
    return fc.Bem3d(tolerance=1e-3).prepare(scene).solve(force=1e-3)


def test_joblib_takes_and_returns_states():
    joblib = pytest.importorskip("joblib")
    state = large()
    assert state.pressure.nbytes > 1e6  # What joblib gives as a file.
    calls = [joblib.delayed(pressure)(one) for one in (state, state)]
    assert joblib.Parallel(n_jobs=2)(calls) == 2 * [pressure(state)]
    again = joblib.Parallel(n_jobs=2)(joblib.delayed(copy.copy)(one) for one in (state, state))
    assert all(one == state for one in again)


def test_dask_takes_states():
    dask = pytest.importorskip("dask")
    state = large()
    tasks = [dask.delayed(pressure)(state) for _ in range(2)]
    assert dask.compute(*tasks, scheduler="processes", num_workers=2) == 2 * (pressure(state),)


# One truth value.


def test_states_compare_as_wholes(state):
    assert state == solved() and (state == solved(0.02)) is False and state != "state"
    assert hash(state) == hash(solved()) and len({state, solved(), solved(0.02)}) == 2
    other = copy.copy(state)
    restore, (kept, fields) = other.__reduce__()
    changed = [None if field is None else field + 1e-300 for field in fields]
    changed = [None if field is None else np.where(field == field.max(), 2 * field, field) for field in changed]
    assert restore(kept, changed) != state
    assert {state.certificate: 1}[solved().certificate] == 1


def test_scenes_compare_as_wholes():
    def scene(force_factor=1.0, **options):
        map_ = ROUGH.height_map(16, seed=1)
        return fc.Scene(force_factor * map_, 1.0, **{"outputs": ["area"], "effects": {"hardness": 1.0}, **options})

    assert scene() == scene() and hash(scene()) == hash(scene()) and len({scene(), scene()}) == 1
    assert (scene() == scene(2.0)) is False and scene() != scene(outputs=["stiffness"]) and scene() != 1
    assert scene() != dataclasses.replace(scene(), contact_modulus=2.0)
    text = '[scene]\nunits = "none"\nmodels = ["hertz"]\ncontact_modulus = 1\nforce = 1\n'
    text += '[scene.body]\nkind = "sphere"\nradius = 1\nside = 4\n'
    one, other = fc.Scene.from_toml(text), fc.Scene.from_toml(text.replace("force = 1", "force = 2"))
    assert one == fc.Scene.from_toml(text) and one != other and len({one, fc.Scene.from_toml(text), other}) == 2


def test_results_compare_as_wholes(tmp_path):
    map_ = ROUGH.height_map(16, seed=1)
    fc.write_surface(tmp_path / "map.x3p", map_)
    one, other = fc.read_surface(tmp_path / "map.x3p"), fc.read_surface(tmp_path / "map.x3p", detrend="plane")
    assert one == fc.read_surface(tmp_path / "map.x3p") and (one == other) is False
    with pytest.raises(TypeError, match="unhashable"):
        hash(one)
    text = '[scene]\nunits = "none"\nmodels = ["hertz"]\ncontact_modulus = 1\nforce = 1\n'
    scene = fc.Scene.from_toml(text + '[scene.body]\nkind = "sphere"\nradius = 1\nside = 4\n')
    outcome = fc.run_scene(scene, tmp_path / "out")
    assert outcome == copy.deepcopy(outcome) and outcome.pulled_off == 0
    assert outcome != dataclasses.replace(outcome, results={})


@pytest.mark.parametrize(
    "value",
    [
        BALL,
        ROUGH,
        fc.Surface.line(np.arange(4.0), length=1.0, size=1.0),
        fc.Body(1.0, 0.3),
        fc.Effects(adhesion={"work": 1.0, "range": 2.0}, rheology={"kind": "prony", "weights": [1.0], "times": [2.0]}),
        fc.Scene(BALL, 1.0, effects={"hardness": {"pressure": 1.0}}, outputs=["area"]),
        fc.Scene(ROUGH.height_map(8, 1), bodies=(fc.Body(1.0, 0.3), None)),
        fc.Bem3d(cells=16),
    ],
)
def test_what_is_frozen_has_a_hash_and_does_not_change(value):
    again = pickle.loads(pickle.dumps(value))
    assert again == value == copy.deepcopy(value) and hash(again) == hash(value) == hash(copy.deepcopy(value))
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            with pytest.raises(dataclasses.FrozenInstanceError):
                setattr(value, field.name, None)
            inner = getattr(value, field.name)
            assert not isinstance(inner, dict | list | np.ndarray), field.name
            hash(inner) if not isinstance(inner, fc.HeightMap) else None


def test_mappings_in_frozen_values_do_not_change():
    with pytest.raises(TypeError, match="does not support item assignment"):
        ROUGH.parameters["hurst"] = 5.0
    effects = fc.Effects(adhesion={"work": 1.0, "range": 2.0})
    with pytest.raises(TypeError, match="does not support item assignment"):
        effects.adhesion["work"] = 2.0
    assert effects.adhesion == {"work": 1.0, "range": 2.0} and repr(effects.adhesion) == "{'work': 1.0, 'range': 2.0}"
    replaced = dataclasses.replace(ROUGH, parameters={**ROUGH.parameters, "hurst": 0.7})
    assert replaced.parameters["hurst"] == 0.7 and replaced != ROUGH


# Maps as arrays.


def test_a_map_compares_element_by_element():
    map_ = ROUGH.height_map((8, 4), seed=1)
    h = np.array(map_)
    for found, expected in (
        (map_ == h, h == h),
        (h == map_, h == h),
        (map_ == map_, h == h),
        (map_ != 2 * map_, h != 2 * h),
        (map_ > 0, h > 0),
        (map_ <= h.mean(), h <= h.mean()),
        (map_ > 0, h > 0),
        (map_ == h[0], h == h[0]),
        (np.isfinite(map_), np.isfinite(h)),
    ):
        assert isinstance(found, np.ndarray) and found.dtype == bool and np.array_equal(found, expected)
    with pytest.raises(TypeError, match="unhashable"):
        hash(map_)
    with pytest.raises(ValueError, match="ambiguous"):
        bool(map_)
    assert map_.equals(ROUGH.height_map((8, 4), seed=1)) and not map_.equals(2 * map_)
    assert not map_.equals(fc.HeightMap(h, size=1.0))
    holes = fc.HeightMap([[1.0, np.nan]], size=1.0, undefined="no_contact")
    assert holes.equals(copy.copy(holes)) and (holes == holes).tolist() == [[True, False]]


def test_a_map_has_items_and_numbers_of_arrays():
    map_ = ROUGH.height_map((8, 4), seed=1)
    h = np.array(map_)
    assert map_[0, 1] == h[0, 1] and np.array_equal(map_[1], h[1]) and np.array_equal(map_[:, ::2], h[:, ::2])
    assert map_.max() == h.max() and map_.min() == h.min() and map_.mean() == h.mean()
    assert np.array_equal(map_.max(axis=0), h.max(axis=0)) and np.array_equal(np.mean(map_, axis=1), h.mean(axis=1))
    assert np.max(map_) == h.max() and np.std(map_) == h.std() and np.median(map_) == np.median(h)
    assert [row.tolist() for row in map_] == h.tolist() and h[0, 1] in map_ and 5.0 not in map_
    assert (map_.ndim, map_.dtype, np.ndim(map_)) == (2, h.dtype, 2)
    with pytest.raises(ValueError, match="read-only"):
        map_[0][0] = 1.0
    with pytest.raises(IndexError):
        map_[4]


def test_functions_of_numpy_take_maps():
    map_ = ROUGH.height_map((8, 4), seed=1)
    h = np.array(map_)
    for found, expected in (
        (np.add(map_, 1), h + 1),
        (np.multiply(h, map_), h * h),
        (np.subtract(map_, map_ / 2), h / 2),
        (np.negative(map_), -h),
    ):
        assert isinstance(found, fc.HeightMap) and np.array_equal(found.heights, expected) and found.size == (2.0, 1.0)
    for found, expected in (
        (np.abs(map_), abs(h)),
        (np.exp(map_), np.exp(h)),
        (np.maximum(map_, 0), np.maximum(h, 0)),
        (np.add.reduce(map_), h.sum(axis=0)),
        (np.gradient(map_)[0], np.gradient(h)[0]),
        (np.fft.fft2(map_), np.fft.fft2(h)),
    ):
        assert isinstance(found, np.ndarray) and np.array_equal(found, expected)
    out = np.empty_like(h)
    assert np.add(h, map_, out=out) is out and np.array_equal(out, 2 * h)
    h += map_
    assert np.array_equal(h, 2 * np.array(map_))


def test_data_frames_and_maps():
    pandas = pytest.importorskip("pandas")
    map_ = ROUGH.height_map((8, 4), seed=1)
    h = np.array(map_)
    for found in (map_ + pandas.DataFrame(h), pandas.DataFrame(h) + map_):
        assert isinstance(found, fc.HeightMap) and np.array_equal(found.heights, 2 * h)


def test_objects_can_be_referred_to_weakly(state):
    contact = fc.Hertz().prepare(fc.Scene(BALL, 1.0))
    for value in (state, contact, ROUGH.height_map(8, seed=1)):
        assert weakref.ref(value)() is value


# Names of dimensions.


def test_names_of_dimensions_decide():
    xarray = pytest.importorskip("xarray")
    h = np.arange(12.0).reshape(3, 4)
    for dims, transposed in ((("y", "x"), False), (("x", "y"), True), (("Row", "Column"), False)):
        given = xarray.DataArray(h.T if transposed else h, dims=dims)
        map_ = fc.HeightMap(given, size=(4.0, 3.0))
        assert np.array_equal(map_.heights, h)
        assert ("transposed" in map_.metadata["axes"]) == transposed and str(dims[0]) in map_.metadata["axes"]
        for again in (pickle.loads(pickle.dumps(map_)), copy.copy(map_)):
            assert again.metadata == map_.metadata
        assert np.array_equal((map_ + given).heights, 2 * h) and (map_ == given).all()
    plain = fc.HeightMap(xarray.DataArray(h), size=(4.0, 3.0))
    assert np.array_equal(plain.heights, h) and plain.metadata == {} == fc.HeightMap(h, size=1.0).metadata
    for dims in (("x", "z"), ("x", "column"), ("lat", "lon")):
        with pytest.raises(ValueError, match=f"'{dims[0]}' and '{dims[1]}': expected x and y"):
            fc.HeightMap(xarray.DataArray(h, dims=dims), size=1.0)
    # Coordinates that fall, as those of images do, and that are no grid.
    falling = xarray.DataArray(h[::-1], dims=("y", "x"), coords={"y": [2.5, 1.5, 0.5], "x": [0.5, 1.5, 2.5, 3.5]})
    map_ = fc.HeightMap(falling, size=(4.0, 3.0))
    assert np.array_equal(map_.heights, h) and "turned round along 'y'" in map_.metadata["axes"]
    with pytest.raises(ValueError, match="the coordinates along 'y' are not in equal steps"):
        fc.HeightMap(falling.assign_coords(y=[0.0, 1.0, 3.0]), size=1.0)
    # There and back.
    map_ = ROUGH.height_map((8, 4), seed=1)
    for given in (map_.to_xarray(), map_.to_xarray().transpose("x", "y")):
        assert fc.HeightMap(given, size=map_.size).equals(map_)


# Seeds, files, bodies.


def test_a_generator_is_a_seed():
    expected = int(np.random.default_rng(7).integers(0, 2**64 - 1, dtype=np.uint64, endpoint=True))
    draws = np.random.default_rng(7)
    assert ROUGH.height_map(8, np.random.default_rng(7)).equals(ROUGH.height_map(8, expected))
    assert not ROUGH.height_map(8, draws).equals(ROUGH.height_map(8, draws))
    force = [fc.Bem3d(cells=8).prepare(fc.Scene(ROUGH, 1.0), seed).solve(approach=0.01).force for seed in (expected,)]
    generator = np.random.default_rng(7)
    assert force == [fc.Bem3d(cells=8).prepare(fc.Scene(ROUGH, 1.0), generator).solve(approach=0.01).force]
    assert fc.surface_gen.surface_seed(np.random.default_rng(7), 3) == fc.surface_gen.surface_seed(expected, 3)
    options = {"surfaces": 1, "force": [1e-4]}
    one, other = (
        fc.ensemble(fc.Bem3d(cells=8), fc.Scene(ROUGH, 1.0), seed=s, **options)
        for s in (np.random.default_rng(7), expected)
    )
    assert one[0] == other[0]
    with pytest.raises(TypeError, match=r"numpy\.random\.Generator"):
        ROUGH.height_map(8, np.random.RandomState(0))
    with pytest.raises(TypeError, match="index is"):
        fc.surface_gen.surface_seed(1, np.random.default_rng(7))


def test_surfaces_are_read_from_bytes(tmp_path):
    map_ = ROUGH.height_map((8, 4), seed=1)
    path = tmp_path / "map.x3p"
    fc.write_surface(path, map_)
    content = path.read_bytes()
    expected = fc.read_surface(path)
    with path.open("rb") as file:
        sources = [content, bytearray(content), memoryview(content), io.BytesIO(content), file]
        for source in sources:
            found = fc.read_surface(source, detrend="none")
            assert found.heights.equals(expected.heights) and found.metadata["format"] == expected.metadata["format"]
    assert fc.channels(io.BytesIO(content)) == fc.channels(path)
    text = io.BytesIO(b"# Width: 3 um\n# Height: 2 um\n# Value units: nm\n1 2 3\n4 5 6\n")
    assert fc.read_surface(text).heights.max() == pytest.approx(6e-9)
    with pytest.raises(TypeError, match="binary mode"):
        fc.read_surface(io.StringIO("1 2 3"))
    with pytest.raises(fc.ReadError, match="bytes"):
        fc.read_surface(b"\x00\x01")


@pytest.mark.parametrize(
    ("young", "poisson", "quantity"),
    [
        (-1.0, 0.3, "young"),
        (0.0, 0.3, "young"),
        (math.inf, 0.3, "young"),
        (math.nan, 0.3, "young"),
        (1.0, 0.6, "poisson"),
    ],
)
def test_bodies_that_make_no_sense(young, poisson, quantity):
    with pytest.raises(fc.DomainError, match=f"{quantity} = ") as caught:
        fc.Body(young, poisson)
    assert caught.value.quantity == quantity


def test_what_would_be_ignored_is_refused():
    map_ = ROUGH.height_map((8, 4), seed=1)
    scene = fc.Scene(map_, 1.0)
    for model in (fc.Bem3d(cells=16), fc.Equivalent(fc.Bem3d(cells=16))):
        with pytest.raises(ValueError, match="cells = 16, but the map has 8 columns"):
            model.prepare(scene)
    with pytest.raises(ValueError, match="rows = 3, but the map has 4 rows"):
        fc.Bem3d(rows=3).prepare(scene)
    fc.Bem3d(cells=8, rows=4).prepare(scene)
    with pytest.raises(TypeError, match="anisotropy= is missing"):
        fc.surface_gen.self_affine_map(ROUGH, 8, 1, lay=30.0)
    with pytest.raises(TypeError, match=r"expected fc\.Scene"):
        fc.Bem3d().prepare(map_)
    for call in (
        fc.statistics.parameters,
        fc.statistics.power_spectrum,
        fc.statistics.slope,
        fc.statistics.fit_spectrum,
    ):
        with pytest.raises(TypeError, match=r"expected a HeightMap.*fc\.HeightMap\(array, size"):
            call(np.array(map_))
    with pytest.raises(TypeError, match="expected a HeightMap"):
        fc.surface_gen.twin(np.array(map_), 1)


def test_friction_says_that_bodies_are_missing():
    with pytest.raises(TypeError, match=r"bodies= is missing; write bodies=\(fc\.Body\(young, poisson\), None\)"):
        fc.Scene(BALL, 1.0, effects={"friction": 0.3})


def test_hertz_has_its_radius_and_its_largest_pressure():
    state = fc.Hertz().prepare(fc.Scene(BALL, 3.0)).solve(approach=0.01)
    # a = sqrt(R d), p0 = 2 E* a/(pi R).
    assert state.contact_radius == pytest.approx(0.1, rel=1e-14)
    assert state.largest_pressure == pytest.approx(2 * 3.0 * 0.1 / math.pi, rel=1e-14)
    assert state.edge_cells is None
    cells = fc.Bem3d(cells=256).prepare(fc.Scene(BALL, 3.0)).solve(approach=0.01)
    # The largest mean over a cell is below the maximum by the order of the square of cells over the radius.
    assert state.largest_pressure == pytest.approx(cells.largest_pressure, rel=2e-3)
    assert fc.Jkr().prepare(fc.Scene(BALL, 3.0, effects={"adhesion": 1e-4})).solve(force=0.0).contact_radius > 0


def test_notes_speak_of_python():
    scene = fc.Scene(ROUGH.height_map((32, 16), seed=1), contact_modulus=1.0, outputs=["area", "stiffness"])
    body = fc.Body(1.0, 0.0)
    effects = {"friction": {"coefficient": 0.3, "coupling": "none"}}
    coupled = fc.Scene(ROUGH.height_map((32, 16), seed=1), bodies=(body, None), effects=effects, outputs=[])
    contact = fc.Bem3d().prepare(scene)
    notes = [note for force in (1e-8, 1e-4, 0.3) for note in contact.solve(force=force).notes]
    notes += fc.Bem3d().prepare(coupled).advance(force=1e-4).notes
    assert len({note.split(":")[0] for note in notes}) >= 6
    for note in notes:
        assert "[effects]" not in note and ' = "' not in note and "outliers = " not in note, note
    assert any('effects={"hardness"' in note for note in notes) and any('"coupling": "full"' in note for note in notes)


# Equal steps of the logarithm of the area.


def spacing(states):
    steps = np.diff(np.log([state.area for state in states]))
    return steps / steps.mean()


def test_a_sweep_is_equally_spaced_in_the_area():
    hertz = fc.Hertz().prepare(fc.Scene(BALL, 1.0, outputs=["area"]))
    states = list(hertz.sweep(force=(1e-4, 1e-2), steps=10))
    assert len(states) == 10 and (states[0].force, states[-1].force) == (1e-4, 1e-2)
    # The area grows as F^(2/3): the loads are equally spaced in their logarithm too.
    assert np.allclose([state.force for state in states], np.geomspace(1e-4, 1e-2, 10), rtol=1e-10)
    rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01).height_map(128, seed=1)
    scene = fc.Scene(rough, 1.0, effects={"boundary": "periodic"}, outputs=["area", "mean_gap"])
    contact = fc.Bem3d().prepare(scene)
    for loads in ({"mean_pressure": (1e-4, 0.1)}, {"mean_gap": (0.03, 0.001)}):
        states = list(fc.sweep(contact, **loads, steps=6))
        assert np.allclose(spacing(states), 1.0, atol=0.15), loads
        # Far from what equal steps of the load would give.
        ((name, ends),) = loads.items()
        even = np.geomspace(*ends, 6) if name == "mean_pressure" else np.linspace(*ends, 6)
        assert not np.allclose(spacing(list(contact.sweep(**{name: even}))), 1.0, atol=0.15)
    yields = fc.Bem3d().prepare(fc.Scene(rough, 1.0, effects={"hardness": 0.05}, outputs=["area"]))
    assert np.allclose(spacing(list(yields.sweep(force=(1e-3, 1e-2), steps=4))), 1.0, atol=0.15)


def test_steps_that_make_no_sense():
    contact = fc.Hertz().prepare(fc.Scene(BALL, 1.0, outputs=["area"]))
    with pytest.raises(ValueError, match="steps = 5, but force has 3 loads"):
        contact.sweep(force=[1e-4, 1e-3, 1e-2], steps=5)
    with pytest.raises(ValueError, match="steps = 1: expected"):
        contact.sweep(force=(1e-4, 1e-2), steps=1)
    with pytest.raises(fc.DomainError, match="force = 0: expected a load > 0"):
        list(contact.sweep(force=(0.0, 1e-2), steps=5))
    bare = fc.Hertz().prepare(fc.Scene(BALL, 1.0, outputs=["stiffness"]))
    with pytest.raises(ValueError, match=r'outputs=\["area"\]'):
        list(bare.sweep(force=(1e-4, 1e-2), steps=5))


# Forks.


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_child_that_was_forked_during_a_solve_is_told_of_spawn():
    program = """
import os, threading, time
import fractal_contact as fc

rough = fc.Surface.self_affine(hurst=0.3, size=1.0, rms_height=0.01)
contact = fc.Bem3d(tolerance=1e-12).prepare(fc.Scene(rough.height_map(1025, 1), 1.0))
stop, begun = threading.Event(), threading.Event()

def solve():
    begun.set()
    try:
        contact.solve(force=2.0, stop=stop)
    except fc.Stopped:
        pass

thread = threading.Thread(target=solve)
thread.start()
begun.wait()
time.sleep(0.3)
child = os.fork()
if child == 0:
    try:
        contact.solve(force=0.1)
    except RuntimeError as error:
        print(error, flush=True)
    # Another contact is none of the parent's.
    print(fc.Bem3d(cells=16).prepare(fc.Scene(rough, 1.0), 1).solve(approach=0.1).approach, flush=True)
    os._exit(0)
print(os.waitpid(child, 0)[1], flush=True)
stop.set()
thread.join()
"""
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    told = ran.stdout.splitlines()
    assert "forked" in told[0] and 'get_context("spawn")' in told[0], (ran.stdout, ran.stderr)
    assert told[1:] == ["0.1", "0"]


@pytest.mark.parametrize(("thickness", "poisson"), [(0.1, 0.3), (0.02, 0.0), (1.5, 0.49)])
def test_a_layer_on_a_rigid_base(thickness, poisson):
    """ContactMechanics' half-space of a finite thickness under the same pressures: the same displacements of waves.

    Its mean is the uniform compression of the layer, which the displacement here, measured from its mean, does not
    contain.
    """
    ContactMechanics = pytest.importorskip("ContactMechanics")
    cells, young, force = 64, 1.0, 0.02
    random = np.random.default_rng(3)
    waves = np.fft.fftfreq(cells) * cells
    length = np.hypot(*np.meshgrid(waves, waves))
    spectrum = np.where((length > 0) & (length < 12), np.maximum(length, 1) ** -1.8, 0)
    heights = np.fft.ifft2(spectrum * np.exp(2j * np.pi * random.random((cells, cells)))).real
    heights *= 0.02 / heights.std()
    scene = fc.Scene(
        fc.HeightMap(heights, size=1.0),
        contact_modulus=young / (1 - poisson**2),
        outputs=["pressure", "displacement", "area"],
        effects={
            "boundary": "periodic",
            "layer": {"thickness": thickness, "young": young, "poisson": poisson, "base": "rigid"},
        },
    )
    theirs = ContactMechanics.PeriodicFFTElasticHalfSpace(
        (cells, cells), young, (1.0, 1.0), thickness=thickness, poisson=poisson
    )
    for kernel, bound in [("waves", 1e-8), ("cells", 0.03)]:
        state = fc.Bem3d(tolerance=1e-8, periodic_kernel=kernel).prepare(scene).solve(force=force)
        assert 0.05 < state.area < 0.9
        displacement = theirs.evaluate_disp(-np.asarray(state.pressure).T / cells**2)
        ours = np.asarray(state.displacement).T
        difference = (displacement - displacement.mean()) - (ours - ours.mean())
        assert np.abs(difference).max() < bound * np.abs(ours).max()
        compression = thickness * (1 + poisson) * (1 - 2 * poisson) / (young * (1 - poisson))
        assert abs(displacement.mean()) == pytest.approx(force * compression, rel=1e-6)
