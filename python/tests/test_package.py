"""What is shipped."""

import doctest
import importlib
import importlib.metadata
import inspect
import pkgutil
import re
import tomllib
from pathlib import Path

import pytest

import fractal_contact as fc

PYTHON = Path(__file__).resolve().parents[1]
MODULES = [fc.__name__] + [f"{fc.__name__}.{m.name}" for m in pkgutil.iter_modules(fc.__path__) if m.name != "_core"]


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_the_documentation(name):
    result = doctest.testmod(importlib.import_module(name))
    assert result.failed == 0


def test_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (PYTHON / "README.md").read_text()
    for block in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        exec(block, {})


def test_what_is_public_is_documented():
    for name in fc.__all__:
        value = getattr(fc, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(value), name
        if inspect.isclass(value):
            for method, member in vars(value).items():
                if not method.startswith("_") and (callable(member) or isinstance(member, property)):
                    assert inspect.getdoc(getattr(value, method)), f"{name}.{method}"


# Sections that not every docstring needs; the form of properties, "type: what it is", which fits no summary; quotes of
# compiled docstrings; and summaries in the third person, as everywhere in this project.
NOT_ASKED = {"ES01", "EX01", "SA01", "SS02", "SS05", "GL01", "GL02"}


def public():
    """The names of all classes, methods, properties and functions."""
    for module in (fc, fc.statistics, fc.surface_gen):
        for name in getattr(module, "__all__", [name for name in vars(module) if name[0] != "_"]):
            value = getattr(module, name)
            if not callable(value) or not value.__module__.startswith(fc.__name__):
                continue
            if module is not fc and value.__module__ != module.__name__:
                continue  # Imported.
            yield f"{module.__name__}.{name}"
            for member, what in vars(value).items() if inspect.isclass(value) else ():
                # Not the default of a field.
                if member[0] != "_" and (callable(what) or hasattr(what, "__get__")):
                    yield f"{module.__name__}.{name}.{member}"


def test_docstrings_pass_the_checks_of_numpydoc():
    validate = pytest.importorskip("numpydoc.validate")
    names, found = list(public()), []
    assert {"fractal_contact.press", "fractal_contact.HeightMap.scaled", "fractal_contact.statistics.slope"} <= set(
        names
    )
    for name in names:
        checked = validate.validate(name)
        of_property = checked["type"] in ("property", "getset_descriptor", "member_descriptor")
        for code, message in checked["errors"]:
            if code not in NOT_ASKED and not (code == "SS06" and of_property):
                found.append((name, code, message))
    assert found == []


def test_the_version_is_that_of_the_workspace():
    workspace = PYTHON.parent / "Cargo.toml"
    if workspace.exists():
        assert tomllib.loads(workspace.read_text())["workspace"]["package"]["version"] == fc.__version__
    assert importlib.metadata.version("fractal-contact") == fc.__version__


def test_licences_are_in_the_wheel():
    names = {Path(file).name for file in importlib.metadata.files("fractal-contact") or []}
    assert {"LICENSE-MIT", "LICENSE-APACHE", "py.typed", "_core.pyi"} <= names


def test_numpy_is_the_only_dependency():
    required = [r for r in importlib.metadata.requires("fractal-contact") or [] if "extra" not in r]
    assert [re.split(r"[<>=]", r)[0] for r in required] == ["numpy"]
