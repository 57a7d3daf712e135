"""The tables of the library in Python: quantities of states, models, and the files that are written from them."""

import ast
import importlib.util
import inspect
import re
from pathlib import Path

import numpy as np
import pytest

import fractal_contact as fc
from fractal_contact import _core

PYTHON = Path(__file__).resolve().parents[1]
PACKAGE = Path(fc.__file__).parent
SPHERE = fc.Surface.sphere(radius=1.0, size=1.0)


@pytest.fixture(scope="module")
def generate():
    spec = importlib.util.spec_from_file_location("generate", PYTHON / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def state(**outputs):
    surface = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)
    scene = fc.Scene(surface, contact_modulus=2.0, outputs=["stiffness", "area", "contact_patches"], **outputs)
    contact = fc.Bem3d(cells=33).prepare(scene, seed=1)
    return contact, contact.solve(force=1e-3)


def test_every_quantity_is_a_property_and_in_the_stub(generate):
    module = ast.parse((PACKAGE / "_core.pyi").read_text())
    [state_class] = [node for node in module.body if getattr(node, "name", None) == "ContactState"]
    members = [node for node in state_class.body if isinstance(node, ast.FunctionDef) and node.name[0] != "_"]
    in_stub = {node.name: ast.unparse(node.returns) for node in members}
    for quantity in fc.quantities():
        name = quantity["name"]
        member = vars(fc.ContactState)[name]
        assert inspect.getdoc(member), name
        line = generate.properties().get(name)
        if line is None:
            # An array of this name stands in its place.
            assert name in in_stub
            continue
        assert isinstance(member, property) and quantity["meaning"] in member.__doc__
        assert in_stub.get(name) == quantity["type"], f"python generate.py adds to the stub of ContactState:\n{line}"
    known = {*(quantity["name"] for quantity in fc.quantities()), *vars(fc.ContactState)}
    assert in_stub.keys() <= known, f"python generate.py removes {in_stub.keys() - known}"


def test_written_files_follow_from_the_tables(generate):
    for name, expected in (
        ("_formulas.py", generate.formulas()),
        ("_effects.py", generate.effects()),
        ("_columns.py", generate.columns()),
        ("_core.pyi", generate.stub((PACKAGE / "_core.pyi").read_text())),
    ):
        assert (PACKAGE / name).read_text() == expected, f"{name} is out of date: python generate.py writes it"


def test_quantities_have_values_of_their_types():
    contact, found = state(conductance=("thermal", 1.0, 2.0))
    types = {"float": float, "int": int, "str": str}
    for quantity in fc.quantities():
        name, told = quantity["name"], found.to_dict()
        kind, _, optional = quantity["type"].partition(" | ")
        assert quantity["role"] in ("answer", "normalised", "residual", "work", "of_path")
        assert quantity["symbol"] is not None
        if told.get(name) is None:
            assert optional == "None", name
            continue
        assert type(told[name]) is types[kind], name
        if name != "patches":
            assert getattr(found, name) == told[name]
    normalisation = contact.normalisation
    assert found.force_bar == normalisation.force_bar(found.force)
    assert found.stiffness_bar == normalisation.stiffness_bar(found.stiffness)
    assert found.contact_fraction == found.area and found.largest_patch == found.patches[0]
    residuals = [quantity["name"] for quantity in fc.quantities() if quantity["role"] == "residual"]
    assert found.certificate.to_dict() == {name: getattr(found, name) for name in residuals}
    # The best state of an error has its contact's normalisation, too.
    failing = fc.Bem3d(cells=33, max_outer_iterations=1).prepare(
        fc.Scene(fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01), contact_modulus=2.0), seed=1
    )
    with pytest.raises(fc.NotConverged) as caught:
        failing.solve(force=1e-2)
    assert caught.value.best.force_bar == failing.normalisation.force_bar(caught.value.best.force)


def test_tables_have_the_order_of_the_quantities():
    names = [quantity["name"] for quantity in fc.quantities()]
    _, found = state()
    for told in (list(found.to_dict()), list(fc.table([found]).dtype.names)):
        assert told == [name for name in names if name in told]
    rows = fc.table([found])
    assert rows["patches"][0] == len(found.patches) and rows["strategy"][0] == found.strategy
    # What no effect and no path asks for is there for every state.
    hertz = fc.Hertz().prepare(fc.Scene(SPHERE, contact_modulus=1.0)).solve(force=1e-3)
    assert hertz.to_dict().keys() == found.to_dict().keys() | {"contact_radius"} and np.isnan(
        fc.table([hertz])["force_bar"][0]
    )


def test_a_state_tells_the_answers_that_it_has():
    _, found = state()
    answers = [quantity["name"] for quantity in fc.quantities() if quantity["role"] == "answer"]
    told = re.findall(r"(\w+)=", repr(found))
    assert told == [name for name in answers if found.to_dict().get(name) is not None]
    assert "approach=" in repr(found) and "converged" in repr(found) and "duality_gap" in repr(found)


def test_every_model_is_a_class():
    for record in fc.models():
        kind = getattr(fc, record["class"])
        assert record["class"] in fc.__all__ and issubclass(kind, fc.Model)
        assert issubclass(kind, fc.Formula) != record["has_options"]
        model = kind(fc.Bem3d()) if kind is fc.Equivalent else kind()
        assert model.name == record["name"] and model.sources and eval(repr(model), vars(fc)) == model
        assert kind.__doc__.startswith(record["about"].split(".")[0]), record
    assert fc.PartialSlip().name == "mdr1d_partial_slip"


def test_models_say_what_they_support():
    keys = ["surfaces", "boundaries", "effects", "needs", "loads", "paths", "outputs"]
    for model in (fc.Bem3d(), fc.Hertz(), fc.Equivalent(fc.Mdr1d())):
        assert list(model.supports) == keys and all(isinstance(words, tuple) for words in model.supports.values())
    assert "periodic" in fc.Bem3d().supports["boundaries"] and fc.Hertz().supports["effects"] == ()
    assert fc.Bem3d().supports["paths"] == ("remembered",)


def test_outputs_are_those_of_the_table():
    with pytest.raises(ValueError, match=r"there are stiffness, .* and stick_slip$"):
        fc.Scene(SPHERE, contact_modulus=1.0, outputs=["conductance"])
    of_friction = (
        "stick_area",
        "tangential_stiffness",
        "tangential_stiffness_stuck",
        "traction",
        "slip",
        "stick_slip",
    )
    for name in fc.Bem3d().supports["outputs"]:
        if name in of_friction:
            with pytest.raises(fc.Unsupported, match="needs friction"):
                fc.Scene(SPHERE, contact_modulus=1.0, outputs=[name])
        elif name not in ("conductance", "mean_gap", "plastic_depth"):
            assert fc.Scene(SPHERE, contact_modulus=1.0, outputs=[name]).outputs == (name,)


def test_compiled_and_public_tables_are_the_same():
    assert fc.quantities() == _core.quantities() and fc.models() == _core.models()
