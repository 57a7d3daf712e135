"""What a type checker finds."""

import inspect
import subprocess
import sys
import typing
from pathlib import Path

import pytest

import fractal_contact as fc
from fractal_contact import _core
from fractal_contact import typing as words

GOOD = """
import io
import threading
import numpy as np
import fractal_contact as fc
from fractal_contact.typing import EffectsDict

effects: EffectsDict = {"hardness": 0.1, "adhesion": None}
solid = fc.Effects(rheology={"kind": "prony", "weights": [1.0], "times": [1.0]})
ball = fc.Surface.sphere(radius=1.0, size=np.array([1.0, 2.0]))
rough = fc.HeightMap(np.zeros((4, 4)), size=["1 mm", "1 mm"], undefined="no_contact")
scene = fc.Scene(2 * rough - 1.0, bodies=(fc.Body(1.0, 0.3), "rigid"), effects=effects, outputs=["stiffness", "area"])
contact = fc.Bem3d(method="iterative").prepare(scene)
state = contact.solve(force=1.0, stop=threading.Event())
total: float = np.asarray(rough).sum() + len(state.notes)
for state in contact.sweep(force=(value for value in (1.0, 2.0))):
    print(state.force)
fc.read_surface("map.npy", unit="nm", detrend="plane")
fc.read_surface(io.BytesIO(b"1 2"), size="1 mm")
names = ["area", "pressure"]
values = {"hardness": 0.1}
fc.Scene(ball, 1.0, outputs=names, effects=values)
fc.Scene(ball, 1.0, outputs=(name for name in names), effects={"adhesion": {"work": 1.0}})
pressed = fc.press(np.zeros((4, 4)), "1 mm", "1 GPa", unit="nm", mean_pressure=["1 MPa"], effects=values, crop="centre")
area: float = pressed.area[0] + pressed.area_error[0]
pair = (fc.Body(1.0, 0.3), {"young": 1.0, "poisson": 0.3})
fc.press(rough, bodies=pair, force=(force for force in (1.0, 2.0)), outputs=names)
positive = rough > 0
highest: float = np.asarray(rough)[positive].sum() + rough.max() + rough[0, 0]
rough.height = 1  # type: ignore[attr-defined]
random = fc.Surface.self_affine(size=1.0, rms_height=0.1, hurst=0.5).height_map(8, np.random.default_rng(1))
list(contact.sweep(force=(1.0, 2.0), steps=10))
fc.Scene(ball, 1.0, effects={"friction": {"coefficient": 0.1, "coupling": "full"}}, conductance=("thermal", 1.0, 1.0))
lower, upper = fc.leakage(np.ones((4, 4)), cell=(1.0, 2.0), along="y", boundary="periodic").flow(1e5, 1e-3)
traction = (np.ones((4, 4)), [[0.0] * 4] * 4)
stress = fc.stress_below(rough, depths=(depth for depth in (0.1, 0.2)), poisson=0.3, traction=traction)
fc.stress_below([[1.0]], cell=1, points=[(0.0, 0.0, 1.0)], origin=[1.0, 2.0], poisson=0.3)
highest = fc.von_mises(stress).max() + fc.largest_von_mises(rough, depths=[0.1], poisson=0.3).value + lower
"""

BAD = [
    'fc.leakage([[1.0]], along="z")',
    'fc.percolation([[1.0]], boundary={"x": "periodic"})',
    "fc.stress_below([[1.0]], depths=[1.0])",
    "fc.Effects(hardnes=1)",
    'fc.Effects(hardness={"pressur": 1.0})',
    'fc.Effects(hardness="2 GPa")',
    'fc.Effects(boundary="round")',
    'fc.Effects(rheology={"kind": "maxwell"})',
    'effects: EffectsDict = {"hardnes": 1}',
    'outputs: list[Output] = ["stifness"]',
    "fc.Scene(ball, 1.0, effects=[1])",
    "fc.Scene(ball, 1.0, outputs=[1])",
    'fc.press([[1.0]], 1.0, 1.0, force=1.0, detrend="pane")',
    "fc.press([[1.0]], 1.0, 1.0, force=1.0, outlier=8)",
    "fc.press([[1.0]], 1.0, 1.0, forces=1.0)",
    'fc.Effects(adhesion={"work": 1.0, "law": "jkr"})',
    'fc.Scene(ball, 1.0, conductance={"kind": "thermal", "resistivities": (1.0, 1.0)})',
    'fc.Scene("map.npy", 1.0)',
    'fc.Bem3d(method="magic")',
    'fc.GreenwoodWilliamson(heights="normal")',
    'fc.HeightMap([[1.0]], size=1.0, undefined="perhaps")',
    'fc.read_surface("map.npy", chanel=1)',
    'fc.read_surface("map.npy", detrend="pane")',
    'fc.statistics.slope(ball.height_map(8), "z")',
    'fc.surface_gen.twin(ball.height_map(8), 1, twin="ring")',
    "fc.Hertz().prepare(fc.Scene(ball, 1.0)).sweep(force=1.0)",
    "fc.Hertz().prepare(fc.Scene(ball, 1.0)).solve(force=1.0, stop=True)",
]


def checked(tmp_path, text):
    """What mypy says of a program, by its lines."""
    pytest.importorskip("mypy")
    path = tmp_path / "program.py"
    path.write_text(text)
    command = [sys.executable, "-m", "mypy", "--strict", "--hide-error-context", "--no-error-summary", path.name]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert told.stderr == "", told.stderr
    return told.stdout.splitlines()


def test_programs_are_accepted(tmp_path):
    assert checked(tmp_path, GOOD) == []


def test_mistakes_are_found(tmp_path):
    head = [
        "import fractal_contact as fc",
        "from fractal_contact.typing import EffectsDict, Output",
        "ball = fc.Surface.sphere(radius=1.0, size=1.0)",
    ]
    told = checked(tmp_path, "\n".join([*head, *BAD, ""]))
    for number, line in enumerate(BAD, len(head) + 1):
        assert any(text.startswith(f"program.py:{number}: error") for text in told), (line, told)


def test_the_stub_is_that_of_the_module():
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "fractal_contact._core"]
    told = subprocess.run(command, capture_output=True, text=True)
    assert told.returncode == 0, told.stdout


def test_signatures_have_names_to_complete():
    for call in (
        fc.Contact.solve,
        fc.Contact.sweep,
        fc.Contact.advance,
        fc.Contact.follow,
        fc.HeightMap,
        fc.HeightMap.max,
        fc.HeightMap.cropped,
        fc.press,
        fc.read_surface,
        fc.channels,
        fc.ensemble,
        fc.Bem3d,
        fc.run_scene,
        fc.set_threads,
    ):
        parameters = inspect.signature(call).parameters.values()
        assert all(one.kind is not one.VAR_POSITIONAL for one in parameters), call
        # What is taken by name is listed.
        assert call is fc.HeightMap.max or all(one.kind is not one.VAR_KEYWORD for one in parameters), call
    for call in (fc.read_surface, fc.channels):
        assert set(inspect.signature(call).parameters) == {"path", *words.ReadOptions.__annotations__}
    assert words.PressOptions.__annotations__.keys() < inspect.signature(fc.press).parameters.keys()


def test_the_words_are_those_of_the_library():
    assert [key["name"] for key in _core.effect_keys()] == list(words.EffectsDict.__annotations__)
    with pytest.raises(ValueError, match="no output is called") as caught:
        fc.Scene(fc.Surface.flat(size=1.0), 1.0, outputs=["?"])
    listed = str(caught.value).split("there are ")[1].replace(" and ", ", ").split(", ")
    assert set(listed) == set(typing.get_args(words.Output))
    with pytest.raises(TypeError, match="no option is called") as caught:
        _core.read_surface(Path("absent.npy"), {"absent": 1})
    listed = str(caught.value).split("there are ")[1].split(", ")
    assert set(listed) == set(words.ReadOptions.__annotations__)
    with pytest.raises(ValueError, match="no surface is of the kind") as caught:
        fc.Surface("?", {})
    assert set(str(caught.value).split("there are ")[1].split(", ")) == set(typing.get_args(words.SurfaceKind))
