"""Which values arguments take, and what the errors say of others."""

import array
import fractions
import re

import numpy as np
import pytest

import fractal_contact as fc

SPHERE = fc.Surface.sphere(radius=1.0, size=2.0)
ROUGH = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
GRID = np.arange(12.0).reshape(3, 4)
CONTACT = fc.Hertz().prepare(fc.Scene(SPHERE, contact_modulus=1.0))

NUMBERS = [
    [0.5, 1],
    (0.5, 1.0),
    iter([0.5, 1.0]),
    (value for value in (0.5, 1.0)),
    {0.5: "a", 1.0: "b"}.keys(),
    array.array("d", [0.5, 1.0]),
    np.array([0.5, 1.0]),
    np.array([0.5, 1.0], dtype=np.float32),
    np.array([0.5, 1.0], dtype=object),
    np.ma.masked_array([0.5, 1.0], [False, False]),
    [fractions.Fraction(1, 2), np.int8(1)],
    [np.array(0.5), np.float16(1.0)],
]
NO_NUMBERS = [
    "0.5",
    b"12",
    ["0.5"],
    [True],
    np.array([True, False]),
    [np.True_],
    [0.5j],
    np.array([0.5 + 0j]),
    np.array(["0.5"]),
    [None],
    [[0.5, 1.0]],
    np.ma.masked_array([0.5, 1.0], [False, True]),
    {0.5: 1.0},
    [np.timedelta64(1)],
]


@pytest.mark.parametrize("values", NUMBERS, ids=repr)
def test_any_iterable_of_numbers_is_taken(values):
    values = list(values) if not isinstance(values, np.ndarray | array.array) else values
    for of in (lambda it: it, iter, lambda it: (value for value in it)):
        assert [state.force for state in CONTACT.sweep(force=of(values))] == pytest.approx([0.5, 1.0])
        assert [state.force for state in CONTACT.follow(force=of(values))] == pytest.approx([0.5, 1.0])
        states = fc.ensemble(
            fc.PowerLaw(), fc.Scene(ROUGH, contact_modulus=1.0), seed=1, surfaces=1, force_bar=of(values)
        )
        assert len(states[0]) == 2
    assert list(CONTACT.sweep(force=[])) == []


@pytest.mark.parametrize("values", [*NO_NUMBERS, 0.5, True, None, np.array(0.5)], ids=repr)
def test_sweeps_and_ensembles_take_nothing_else(values):
    scene = fc.Scene(ROUGH, contact_modulus=1.0)
    for take in (
        lambda: CONTACT.sweep(force=values),
        lambda: fc.ensemble(fc.PowerLaw(), scene, seed=1, surfaces=1, force_bar=values),
    ):
        with pytest.raises(TypeError, match=r"expected|exactly one"):
            take()
    with pytest.raises(ValueError, match="one dimension"):
        CONTACT.sweep(force=np.ones((2, 2)))
    with pytest.raises(ValueError, match="beyond the range"):
        CONTACT.sweep(force=[10**400])


@pytest.mark.parametrize("values", [*NO_NUMBERS, True], ids=repr)
def test_paths_take_nothing_else(values):
    with pytest.raises(TypeError, match="expected"):
        CONTACT.follow(force=values)


def test_steps_of_paths():
    body = fc.Body(1.0, 0.3)
    scene = fc.Scene(fc.Surface.sphere(radius=1.0, size=1.0), bodies=(body, body), effects={"friction": 0.5})
    for pairs in ([(0.0, 0.0), (1e-4, 1e-4)], np.array([[0.0, 0.0], [1e-4, 1e-4]]), ([q, q] for q in (0.0, 1e-4))):
        path = fc.Bem3d(cells=16, tolerance=1e-4).prepare(scene)
        states = list(path.follow(force=0.01, tangential_force=pairs))
        assert states[1].tangential_force == pytest.approx(1e-4, rel=1e-2)
        assert states[1].tangential_force_y == pytest.approx(1e-4, rel=1e-2)
    for wrong, error in (([(0.0,)], ValueError), ([(0.0, "1")], TypeError), ([0.0, (0.0, 1.0)], TypeError)):
        with pytest.raises(error):
            path.follow(force=0.01, tangential_force=wrong)
    with pytest.raises(ValueError, match="force has 2, tangential_force has 1"):
        path.follow(force=[0.01, 0.02], tangential_force=[0.0])


@pytest.mark.parametrize("value", ["0.5", True, np.True_, 0.5j, np.ma.masked, [True], {}], ids=repr)
def test_a_load_is_a_number(value):
    map_ = fc.HeightMap(GRID, size=1.0)
    for take in (
        lambda: CONTACT.solve(force=value),
        lambda: CONTACT.advance(force=value),
        lambda: CONTACT.advance(value, force=1.0),
        lambda: CONTACT.advance(force=1.0, tangential_force=value or 0.5j),
        lambda: fc.Scene(SPHERE, contact_modulus=value),
        lambda: fc.Surface.sphere(radius=value, size=1.0),
        lambda: map_.scaled(1.0, value),
        lambda: fc.statistics.power_spectrum(map_, level=value),
    ):
        with pytest.raises(TypeError, match="real number"):
            take()


PAIRS = [(2.0, 1.0), [2.0, 1.0], np.array([2.0, 1.0]), iter([2.0, 1.0]), [np.float32(2.0), 1]]


@pytest.mark.parametrize("size", PAIRS, ids=repr)
def test_sizes_are_pairs_of_any_kind(size):
    size = list(size) if not isinstance(size, np.ndarray | tuple) else size
    assert fc.HeightMap(GRID, size=size).size == (2.0, 1.0)
    sphere = fc.Surface.sphere(radius=1.0, size=size)
    assert sphere == fc.Surface.sphere(radius=1.0, size=(2.0, 1.0)) and sphere.height_map((4, 2)).size == (2.0, 1.0)


def test_sizes_cells_and_ranges_of_arrays():
    assert fc.HeightMap(GRID, size=["2 mm", "1 mm"]).size == (2e-3, 1e-3)
    assert fc.HeightMap(GRID, size=np.array(2.0)).size == fc.HeightMap(GRID, size=np.float32(2.0)).size == (2.0, 2.0)
    flat = fc.Surface.flat(size=1.0)
    for cells in ([8, 4], np.array([8, 4]), (np.int16(8), 4)):
        assert flat.height_map(cells).shape == (4, 8)
    assert fc.HeightMap(GRID, size=1.0).cropped([0, 2], np.array([1, 4])).shape == (2, 3)


@pytest.mark.parametrize(
    "size", [(1.0,), (1.0, 2.0, 3.0), None, 1j, True, [True, 1.0], ("1 mm", 2.0), {1.0: 2.0}], ids=repr
)
def test_sizes_of_other_types(size):
    for take in (lambda: fc.HeightMap(GRID, size=size), lambda: fc.Surface.sphere(radius=1.0, size=size)):
        with pytest.raises(TypeError, match="expected a number") as caught:
            take()
        assert "enum" not in str(caught.value) and "variant" not in str(caught.value)


@pytest.mark.parametrize("cells", [33.0, True, "33", (1, 2, 3), None, -3, (4, -1), [True, 1]], ids=repr)
def test_cells_of_other_types(cells):
    with pytest.raises((TypeError, ValueError), match="expected a whole number"):
        fc.Surface.flat(size=1.0).height_map(cells)


@pytest.mark.parametrize(
    ("seed", "error"), [(-1, ValueError), (2**64, ValueError), (1.5, TypeError), (True, TypeError)]
)
def test_seeds(seed, error):
    scene = fc.Scene(ROUGH, contact_modulus=1.0)
    for take in (
        lambda: fc.Bem3d(cells=17).prepare(scene, seed=seed),
        lambda: ROUGH.height_map(8, seed=seed),
        lambda: fc.surface_gen.self_affine_map(ROUGH, 8, seed),
        lambda: fc.ensemble(fc.PowerLaw(), scene, seed=seed, surfaces=1, force_bar=[1.0]),
        lambda: fc.surface_gen.surface_seed(seed, 0),
    ):
        with pytest.raises(error, match="whole number from 0 to"):
            take()


@pytest.mark.parametrize(
    ("count", "error"),
    [(-1, fc.DomainError), (2**64, fc.DomainError), (1.5, TypeError), (True, TypeError), ("3", TypeError)],
)
def test_counts_are_told_by_name(count, error, tmp_path):
    scene = fc.Scene(ROUGH, contact_modulus=1.0)
    for name, take in (
        ("surfaces", lambda: fc.ensemble(fc.PowerLaw(), scene, seed=1, surfaces=count, force_bar=[1.0])),
        ("cells", lambda: ROUGH.height_map(count)),
        ("cells", lambda: fc.surface_gen.self_affine_map(ROUGH, count, 1)),
        ("threads", lambda: fc.run_scene("absent.toml", tmp_path, threads=count)),
    ):
        with pytest.raises(error, match=f"^{name} (=|is) .*: expected a whole number >= ") as caught:
            take()
        if error is fc.DomainError:
            assert caught.value.quantity == name and caught.value.value == pytest.approx(count)


def test_whole_numbers_beyond_floats_are_refused_by_name():
    contact = fc.Hertz().prepare(fc.Scene(SPHERE, contact_modulus=1.0))
    with pytest.raises(fc.DomainError, match="force = inf: expected a finite number"):
        contact.solve(force=10**400)
    with pytest.raises(fc.DomainError, match="force = -inf: expected a finite number"):
        contact.solve(force=-(10**400))


def test_scenes_say_what_they_take():
    for surface in ("map.npy", GRID, None):
        with pytest.raises(TypeError, match=r"expected a Surface or a HeightMap; fc\.HeightMap"):
            fc.Scene(surface, contact_modulus=1.0)
    with pytest.raises(TypeError, match=r"fc\.si makes one"):
        fc.Scene(SPHERE, contact_modulus="1 GPa")
    with pytest.raises(TypeError, match=r"give contact_modulus or bodies$"):
        fc.Scene(SPHERE)
    with pytest.warns(FutureWarning, match="`modulus` is read as `contact_modulus`"):
        former = fc.Scene(SPHERE, modulus=2.0)
    assert former == fc.Scene(SPHERE, contact_modulus=2.0)
    with pytest.raises(TypeError, match="not both"):
        fc.Scene(SPHERE, contact_modulus=2.0, modulus=2.0)
    body = fc.Body(2.0, 0.3)
    with pytest.raises(TypeError, match="not both"):
        fc.Scene(SPHERE, 1.0, bodies=(body, None))
    for bodies in ((body,), body, "rigid", (body, 1.0), (body, {"young": 1.0}), (body, "soft")):
        with pytest.raises(TypeError, match="bodies"):
            fc.Scene(SPHERE, bodies=bodies)
    with pytest.raises(TypeError, match="did you mean poisson"):
        fc.Scene(SPHERE, bodies=({"young": 1.0, "poison": 0.3}, None))
    # The words of scene files.
    told = fc.Scene(SPHERE, bodies=[{"young": 2.0, "poisson": 0.3}, "rigid"])
    assert told == fc.Scene(SPHERE, bodies=(body, None))
    electrical = {"kind": "electrical", "resistivities": [1.0, 2.0]}
    assert fc.Scene(SPHERE, 1.0, conductance=electrical) == fc.Scene(SPHERE, 1.0, conductance=("electrical", 1.0, 2.0))
    for wrong in ("electrical", ("electrical", 1.0), {"kind": "thermal", "resistivities": (1.0, 2.0)}, {"knd": 1}):
        with pytest.raises(TypeError, match="conductance"):
            fc.Scene(SPHERE, 1.0, conductance=wrong)
    with pytest.raises(ValueError, match="electrical and thermal"):
        fc.Scene(SPHERE, 1.0, conductance=("magnetic", 1.0, 1.0))
    body = fc.Surface.power_law(depth=0.5, radius=2.0, exponent=2.0, size=1.0)
    assert body == fc.Surface.power_law(coefficient=0.125, exponent=2.0, size=1.0)
    with pytest.raises(TypeError, match="depth and radius"):
        fc.Surface.power_law(depth=0.5, exponent=2.0, size=1.0)


def test_unknown_keys_are_refused():
    with pytest.raises(TypeError, match=r"no effect is called 'hardnes': did you mean hardness\?"):
        fc.Scene(SPHERE, 1.0, effects={"hardnes": 1})
    with pytest.raises(TypeError, match=r"no effect is called 'x': there are boundary, .* and layer"):
        fc.Scene(SPHERE, 1.0, effects={"x": 1})
    with pytest.raises(TypeError, match="'hardness' is no mapping"):
        fc.Scene(SPHERE, 1.0, effects="hardness")
    for effects in (
        {"hardness": {"pressur": 1.0}},
        {"friction": {"coefficient": 0.1, "x": 1}},
        {"adhesion": {"wrk": 1}},
    ):
        with pytest.raises((TypeError, ValueError), match=r"pressure|`x` is no key|work"):
            fc.Effects(**effects)
    with pytest.raises(TypeError, match='a sphere has no "radiu": there are radius, size'):
        fc.Surface("sphere", {"radius": 1.0, "size": 1.0, "radiu": 2.0})
    with pytest.raises(ValueError, match='no surface is of the kind "shpere": there are self_affine'):
        fc.Surface("shpere", {"radius": 1.0, "size": 1.0})
    with pytest.raises(TypeError, match="tolerence"):
        fc.Bem3d(tolerence=1e-8)
    for kind in (fc.Model, fc.Formula):
        with pytest.raises(TypeError, match=f"{kind.__name__} is no model by itself: take one of its classes"):
            kind()
    for call in (fc.channels, fc.read_surface, fc.press):
        told = rf"^{call.__name__}\(\) got an unexpected keyword argument 'chanel'. Did you mean 'channel'\?$"
        with pytest.raises(TypeError, match=told):
            call("absent.npy", chanel=1)
        with pytest.raises(TypeError, match=rf"^{call.__name__}\(\) got an unexpected keyword argument 'qqqq'$"):
            call("absent.npy", qqqq=1)
    prony = fc.Effects(rheology={"kind": "prony", "weights": np.array([1.0]), "times": np.array([2.0])})
    assert prony == fc.Effects(rheology={"kind": "prony", "weights": [1.0], "times": [2.0]})


def test_outputs_default_to_what_the_model_can():
    solid = {"kind": "maxwell", "viscosity": 1.0}
    creeping = fc.Scene(SPHERE, contact_modulus=1.0, effects={"rheology": solid})
    assert creeping.outputs is None
    for model in (fc.Viscoelastic(), fc.Equivalent(fc.Mdr1d())):
        assert model.prepare(creeping).advance(force=0.01).stiffness is None
    assert fc.Bem3d(cells=16).prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(force=0.01).stiffness > 0
    # What is asked for is not left out.
    with pytest.raises(fc.Unsupported, match="stiffness"):
        fc.Viscoelastic().prepare(
            fc.Scene(SPHERE, contact_modulus=1.0, effects={"rheology": solid}, outputs=["stiffness"])
        )
    # Another lack is told as it is.
    with pytest.raises(fc.Unsupported, match="rheology of Maxwell"):
        fc.Hertz().prepare(creeping)
    states = fc.ensemble(
        fc.Equivalent(fc.Bem3d(cells=17)),
        fc.Scene(ROUGH, contact_modulus=1.0, effects={"rheology": solid}),
        seed=1,
        surfaces=2,
        force_bar=[0.1],
    )
    assert all(row[0].stiffness is None and row[0].force > 0 for row in states)


def test_states_have_notes():
    periodic = {"boundary": "periodic"}
    few = fc.Bem3d(cells=17).prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(force=1e-5)
    assert [note.split(":")[0] for note in few.notes][:2] == [
        "fewer than 10 contact cells",
        "one cell carries most of the load",
    ]
    assert "notes: fewer than 10 contact cells; one cell" in repr(few)
    edge = fc.Bem3d(cells=17).prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(force=3.0)
    assert any(note.startswith("contact at the edge of the rectangle: ") for note in edge.notes)
    smooth = fc.Surface.sine(amplitude=0.001, wavelength=1.0, size=1.0)
    good = fc.Bem3d(cells=64).prepare(fc.Scene(smooth, contact_modulus=1.0, effects=periodic)).solve(mean_pressure=1e-3)
    assert good.notes == () and "notes" not in repr(good)
    flat = fc.Bem3d(cells=17).prepare(fc.Scene(fc.Surface.flat(size=1.0), contact_modulus=1.0)).solve(force=1e-3)
    assert not any("edge" in note for note in flat.notes)
    assert fc.Hertz().prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(force=1e-5).notes == ()


def test_counts_in_tables_are_whole_numbers():
    contact = fc.Bem3d(cells=17).prepare(fc.Scene(SPHERE, contact_modulus=1.0, outputs=["area", "contact_patches"]))
    rows = fc.table(contact.sweep(force=[1e-3, 1e-2]))
    for name in ("contact_cells", "iterations", "patches", "fields"):
        assert rows[name].dtype == np.int64, name
    assert rows["area"].dtype == np.float64
    # A state without the count: NaN says so.
    both = fc.table([contact.solve(force=1e-3), CONTACT.solve(force=1.0)])
    assert both["contact_cells"].dtype == np.float64 and np.isnan(both["contact_cells"][1])
    with pytest.raises(TypeError, match=r"states\[1\] is ValueError\('x'\): expected a ContactState"):
        fc.table([CONTACT.solve(force=1.0), ValueError("x")])


def test_a_refused_load_does_not_end_the_others():
    # A pressure that the hardness cannot carry, between two that it can.
    rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01)
    pressures = [1e-3, 0.5, 1e-2]
    effects = {"hardness": 0.1}
    scene = fc.Scene(rough, contact_modulus=1.0, effects=effects, outputs=["area"])
    model = fc.Bem3d(cells=32)
    seed = fc.surface_gen.surface_seed(5, 0)
    contact = model.prepare(scene, seed=seed)
    with pytest.warns(RuntimeWarning, match="1 of 3 loads failed: .*0.5"):
        rows = fc.table(contact.sweep(mean_pressure=[1e-3, 1e-2, 0.5]))
    assert rows["status"].tolist() == ["converged", "converged", "refused"]
    assert np.isnan(rows["area"][2]) and "0.5" in rows["note"][2] and rows["note"][0] == ""
    # A list raises the error at its place, and the iterator goes on behind it.
    [states] = fc.ensemble(model, scene, seed=5, surfaces=1, mean_pressure=[1e-3, 1e-2, 0.5])
    assert [type(state).__name__ for state in states] == ["ContactState", "ContactState", "OutOfRange"]
    with pytest.warns(RuntimeWarning, match="1 of 3 loads failed"):
        same = fc.table(states)
    assert same.dtype == rows.dtype and np.array_equal(same["area"], rows["area"], equal_nan=True)
    with pytest.warns(RuntimeWarning, match="1 of 3 loads failed"):
        pressed = fc.press(
            np.array(rough.height_map(32, seed)),
            1.0,
            1.0,
            mean_pressure=pressures,
            detrend="none",
            effects=effects,
        )
    assert pressed.results["status"].tolist() == ["converged", "refused", "converged"]
    assert np.array_equal(pressed.area, rows["area"][[0, 2, 1]], equal_nan=True)
    assert [bool(note) for note in pressed.results["note"]][1] and "0.5" in pressed.results["note"][1]
    # Along a sweep without a hardness too, where any order is taken; loads behind the refused one are solved.
    hertz = fc.Hertz().prepare(fc.Scene(SPHERE, contact_modulus=1.0))
    with pytest.warns(RuntimeWarning, match="1 of 3 loads failed: force = -1"):
        rows = fc.table(hertz.sweep(force=[0.1, -1.0, 0.2]))
    assert rows["status"].tolist() == ["converged", "refused", "converged"]
    # Of many reasons the warning has three.
    with pytest.warns(RuntimeWarning, match="9 of 9 loads failed: .*force = -3.*; and 6 other reasons$"):
        fc.table(hertz.sweep(force=-np.arange(1.0, 10.0)))
    with pytest.raises(fc.DomainError):
        list(hertz.sweep(force=[0.1, -1.0, 0.2]))


def test_a_load_that_misses_its_tolerance_has_the_best_numbers():
    rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01).height_map(32, seed=1)
    contact = fc.Bem3d(tolerance=1e-300).prepare(fc.Scene(rough, contact_modulus=1.0, outputs=["area"]))
    with pytest.warns(RuntimeWarning, match="2 of 2 loads failed"):
        rows = fc.table(contact.sweep(force=[1e-3, 1e-2]))
    assert (rows["area"] > 0).all() and "converged" not in rows["status"].tolist()


def test_a_table_ends_with_what_stops_it():
    class Set:
        def is_set(self):
            return True

    with pytest.raises(fc.Stopped):
        fc.table(CONTACT.sweep(force=[1.0, 2.0], stop=Set()))

    def loads():
        yield CONTACT.solve(force=1.0)
        raise fc.Error("of a generator")

    with pytest.raises(fc.Error, match="of a generator"):
        fc.table(loads())


def test_messages_are_not_those_of_rust():
    body = fc.Body(1.0, 0.3)
    told = []
    for take in (
        lambda: fc.Hertz().prepare(fc.Scene(SPHERE, bodies=(body, body), effects={"friction": 0.5})),
        lambda: fc.PartialSlip().prepare(fc.Scene(SPHERE, contact_modulus=1.0, outputs=["pressure"])),
        lambda: fc.Bem3d(cells=17).prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(mean_gap=0.1),
        lambda: fc.Hertz().prepare(fc.Scene(SPHERE, contact_modulus=1.0, effects={"boundary": "periodic"})),
        lambda: CONTACT.solve(mean_gap=0.1),
        lambda: fc.Equivalent(fc.Mdr1d()).prepare(
            fc.Scene(
                SPHERE,
                bodies=(body, body),
                effects={"friction": 0.5, "rheology": {"kind": "maxwell", "viscosity": 1.0}},
            )
        ),
        lambda: fc.Mdr1d().prepare(
            fc.Scene(fc.Surface.flat_circle(radius=0.1, size=1.0), contact_modulus=1.0, effects={"adhesion": 0.1})
        ),
    ):
        try:
            take()
        except fc.Error as error:
            told.append(str(error))
    assert len(told) >= 6
    for message in told:
        assert not re.search(r"::|\{ |\benum\b|MeanGap|Maxwell \{|ShortRange|Periodic\b", message), message
